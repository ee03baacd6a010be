"""Compare writing meshes and archives with the libraries that write the same arrays.

    python -m bench.speed.mesh_writing

Meshes are 1 M quads with three attributes, as VTU and VTKHDF; PyVista saves the same points, cells and values, by
default (compressed) and uncompressed. A wall's archive is compared with ``np.save`` and ``np.load`` of as many bytes.
Every peer flushes to disk as helibore does, and every file is read back and compared before it is timed. The bar of a
mesh is 2 x PyVista's time.
"""

from __future__ import annotations

import json
import os
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

import helibore as hb
from bench.measure import in_turn, ratio
from helibore.mesh.vtk_mesh import vtk_mesh

SECTORS = 64


def _wall(samples: int, vertices: int) -> hb.Wall:
    rng = np.random.default_rng(4)
    length = 0.1 * vertices / SECTORS
    columns = (np.sort(rng.uniform(0, length, samples)), rng.uniform(0, 360, samples), rng.uniform(0.1, 0.12, samples))
    return hb.reconstruct(
        hb.Caliper(*columns), bit_diameter=0.216, start_depth=0.0, sectors=SECTORS, estimator="inverse-distance"
    )


def _surface(quads: int) -> hb.Surface:
    surface = _wall(200_000, quads + SECTORS + 1).surface()
    for number, name in enumerate(("GR", "RT")):
        surface.attributes[name] = np.cos(np.arange(len(surface.quads)) * 0.01 * (number + 1))
    return surface


def _flushed(path: Path, write: Callable[[str], object]) -> Callable[[], None]:
    def work() -> None:
        write(str(path))
        descriptor = os.open(path, os.O_RDONLY)
        os.fsync(descriptor)
        os.close(descriptor)

    return work


def mesh(ending: str, quads: int = 1_000_000, rounds: int = 3) -> dict[str, Any]:
    """Compare saving a surface with PyVista's save of the finished arrays."""
    import pyvista as pv

    surface = _surface(quads)
    ready = vtk_mesh(surface, (0.0, 0.0, 0.0))
    cells = np.column_stack([np.full(len(ready.corners), 4), ready.corners])
    grid = pv.UnstructuredGrid(cells.ravel(), np.full(len(cells), ready.cell_type, "u1"), ready.points)
    for name, of in ready.point_values.items():
        grid.point_data[name] = of
    for name, of in ready.cell_values.items():
        grid.cell_data[name] = of
    with tempfile.TemporaryDirectory() as folder:
        ours, theirs = Path(folder) / f"ours{ending}", Path(folder) / f"theirs{ending}"
        surface.save(ours)
        found = pv.read(ours)
        assert found.points.tobytes() == grid.points.tobytes()
        assert (found.cells == grid.cells).all()
        assert all((found.cell_data[name] == grid.cell_data[name]).all() for name in ready.cell_values)
        works = {"ours": lambda: surface.save(ours), "pyvista": _flushed(theirs, grid.save)}
        if ending == ".vtu":
            plain = Path(folder) / "plain.vtu"
            works["pyvista, uncompressed"] = _flushed(plain, lambda name: grid.save(name, compression=None))
        seconds = in_turn(works, rounds)
        size = {path.stem: path.stat().st_size / 1e6 for path in Path(folder).iterdir()}
    ratios = {f"beside {name}": ratio(seconds["ours"], of) for name, of in seconds.items() if name != "ours"}
    return {
        "case": f"{ending} of {len(surface.quads)} quads",
        **ratios,
        "bar": 2.0,
        "seconds": _median(seconds),
        "MB": size,
    }


def archive(samples: int = 2_400_000, vertices: int = 256_000, rounds: int = 5) -> dict[str, Any]:
    """Compare saving and loading a wall with np.save and np.load of as many bytes.

    Loading is also compared with np.load of the wall's arrays from an .npz file, and with rebuilding the wall.
    """
    wall = _wall(samples, vertices)
    with tempfile.TemporaryDirectory() as folder:
        ours, theirs, zipped = (Path(folder) / name for name in ("ours.wall", "theirs.npy", "theirs.npz"))
        wall.save(ours)
        state = wall._state()
        np.savez(zipped, *state.sample_columns, state.radius, state.nearest, state.support, state.iterations)
        assert hb.load(ours).radius.tobytes() == wall.radius.tobytes()
        same = np.zeros(ours.stat().st_size // 8)
        works: dict[str, Callable[[], object]] = {
            "save": lambda: wall.save(ours),
            "np.save": _flushed(theirs, lambda name: np.save(name, same)),
            "load": lambda: hb.load(ours),
            "np.load": lambda: np.load(theirs),
            "np.load of .npz": lambda: _whole(zipped),
            "rebuild": lambda: hb.reconstruct(
                wall.samples, bit_diameter=0.216, start_depth=0.0, sectors=SECTORS, estimator="inverse-distance"
            ),
        }
        works["np.save"]()
        seconds = in_turn(works, rounds)
    return {
        "case": f"archive of {samples} samples and {vertices} vertices, {same.nbytes / 1e6:.0f} MB",
        "save beside np.save": ratio(seconds["save"], seconds["np.save"]),
        "load beside np.load": ratio(seconds["load"], seconds["np.load"]),
        "load beside np.load of .npz": ratio(seconds["load"], seconds["np.load of .npz"]),
        "load beside rebuilding from memory": ratio(seconds["load"], seconds["rebuild"]),
        "seconds": _median(seconds),
    }


def _whole(path: Path) -> list[np.ndarray]:
    """Return every array of an .npz file. np.load verifies its checksums, as hb.load verifies those of an archive."""
    with np.load(path) as arrays:
        return [arrays[name] for name in arrays]


def _median(seconds: dict[str, list[float]]) -> dict[str, float]:
    return {name: float(np.median(of)) for name, of in seconds.items()}


def cases() -> list[dict[str, Any]]:
    """Return the results of both formats and of the archive."""
    return [mesh(".vtu"), mesh(".vtkhdf"), archive()]


if __name__ == "__main__":
    for case in cases():
        print(json.dumps(case))
