"""Compare placing vertices and making quads with copying as many bytes, and saving a GLB with trimesh's export.

    python -m bench.speed.emission

Each case checks the result, then times helibore and its peer in turn. The bar of emission is 4 x the copy; the copy is
np.copy of the vertices and of the quads into fresh memory.
"""

from __future__ import annotations

import json
import os
import tempfile
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np

import helibore as hb
from bench.measure import in_turn, milliseconds, ratio
from helibore.mesh.surface import Surface, WallLike, surface_of

SECTORS = 64


def _wall(vertices: int, length: float) -> WallLike:
    settings = SimpleNamespace(sectors=SECTORS, pitch=length * SECTORS / vertices, start_toolface=0.0)
    radius = 0.108 + 0.02 * np.random.default_rng(1).random(vertices)
    return SimpleNamespace(settings=settings, start_depth=0.0, radius=radius)


def _path(method: str = "minimum-curvature") -> hb.Path:
    """Return the path of a curved survey of 101 stations, 30 m apart, with up to 3 degrees of bend at each station."""
    random = np.random.default_rng(2)
    inclination = np.clip(3 + np.cumsum(random.uniform(-1, 2, 101)), 1, 90)
    azimuth = np.cumsum(random.uniform(-4, 4, 101)) % 360
    return hb.Survey(np.arange(101) * 30.0, inclination, azimuth).path(method=method)  # type: ignore[arg-type]


def _check(surface: Surface, wall: WallLike, path: hb.Path) -> None:
    """Check some vertices against the formula for positions, and all quads against the numbers of their vertices."""
    k = np.random.default_rng(3).integers(0, len(surface.vertices), 500)
    depth = wall.start_depth + k * wall.settings.pitch / SECTORS
    toolface = np.radians(k % SECTORS * 360 / SECTORS)
    frame = path.frame(depth)
    outward = np.cos(toolface)[:, None] * frame[:, 0] + np.sin(toolface)[:, None] * frame[:, 1]
    expected = path.position(depth) + wall.radius[k, None] * outward
    assert np.abs(surface.vertices[k] - expected).max() < 1e-11
    first = np.arange(len(surface.vertices) - SECTORS - 1)[:, None]
    assert (surface.quads == first + np.array([0, 1, 1 + SECTORS, SECTORS])).all()


def emission(vertices: int, method: str = "minimum-curvature", rounds: int = 11) -> dict[str, Any]:
    """Compare making vertices and quads of a wall on a curved survey, on all cores and on one, with copying them."""
    wall, path = _wall(vertices, 2990.0), _path(method)
    surface = surface_of(wall, path)
    _check(surface, wall, path)
    works = {
        "helibore": lambda: surface_of(wall, path),
        "one thread": lambda: surface_of(wall, path, threads=1),
        "copy": lambda: (np.copy(surface.vertices), np.copy(surface.quads)),
    }
    seconds = in_turn(works, rounds)
    return {
        "case": f"emission, {vertices} vertices, {method}",
        "milliseconds": {work: milliseconds(times) for work, times in seconds.items()},
        "over a copy": ratio(seconds["helibore"], seconds["copy"]),
        "over a copy at most": 4.0,
        "one thread over a copy": ratio(seconds["one thread"], seconds["copy"]),
    }


def glb(vertices: int = 256_000 + SECTORS + 1, rounds: int = 5) -> dict[str, Any]:
    """Compare saving a surface as GLB with trimesh's export of the same mesh; both are flushed to disk."""
    import trimesh

    surface = surface_of(_wall(vertices, 2990.0), _path())
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "well.glb"
        surface.save(file)
        mesh = next(iter(trimesh.load_scene(file).geometry.values()))
        assert len(mesh.faces) == 2 * len(surface.quads)
        finished = {
            "vertices": np.array(mesh.vertices),
            "faces": np.array(mesh.faces),
            "vertex_colors": np.array(mesh.visual.vertex_colors),
        }

        def peer() -> None:
            scene: Any = trimesh.Scene([trimesh.Trimesh(**finished, process=False)])
            with (Path(folder) / "peer.glb").open("wb") as out:
                out.write(scene.export(file_type="glb"))
                os.fsync(out.fileno())

        seconds = in_turn({"helibore": lambda: surface.save(file), "trimesh": peer}, rounds)
    return {
        "case": f"GLB, {len(surface.quads)} quads",
        "milliseconds": {work: milliseconds(times) for work, times in seconds.items()},
        "over trimesh": ratio(seconds["helibore"], seconds["trimesh"]),
        "over trimesh at most": 1.0,
    }


def cases() -> list[dict[str, Any]]:
    """Return the results for two sizes by two methods, and of a GLB."""
    return [
        emission(256_000),
        emission(2_500_000),
        emission(256_000, "radius-of-curvature"),
        emission(2_500_000, "radius-of-curvature"),
        glb(),
    ]


if __name__ == "__main__":
    for case in cases():
        print(json.dumps(case))
