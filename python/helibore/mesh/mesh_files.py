"""Surfaces and volumes as files: which ending means what. OBJ and STL go through trimesh, VTKHDF through h5py; GLB, PLY
and VTK's XML are written here, for trimesh's GLB is slow and its PLY holds neither quads nor float64 (and vtk_xml.py).

Files have their own axes. From (north, east, down):

    GLB                 (east, up, -north)     Y up, as glTF requires
    all others          (east, north, up)      Z up, as maps are

Both are rotations; swapping only the sign of down would mirror the hole. What a file holds is in `Surface.save`.
"""

from __future__ import annotations

import os
import re
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np
import numpy.typing as npt

from helibore.base.arrays import Floats
from helibore.base.atomic_file import write_whole
from helibore.base.colors import Colors, ColorScale, check_map, check_positive, colors_of
from helibore.mesh.glb_file import check_size, write_glb
from helibore.mesh.metadata import with_units
from helibore.mesh.surface import SURFACE_ENDINGS, Surface
from helibore.mesh.volume import VOLUME_ENDINGS, Volume
from helibore.mesh.vtk_mesh import AXES, VtkMesh, check_origin, vtk_mesh, z_up
from helibore.mesh.vtk_xml import write_vtp, write_vtu
from helibore.mesh.vtkhdf import save_vtkhdf
from helibore.samples.caliper import BASIS_TEXT

Paint = Callable[[Floats], Colors]

_PLY_CORNERS = ("corner_count", "vertex_indices")
_STL_TOLERANCE = 1e-3  # metres a vertex may move


def save_surface(
    surface: Surface,
    filename: str | os.PathLike[str],
    color_by: str | None,
    limits: tuple[float, float] | None,
    origin: tuple[float, float, float],
    color_map: str,
    log: bool,
) -> None:
    """Write ``surface`` to ``filename``: `Surface.save`."""
    path = Path(filename)
    painted: dict[str, Callable[[Surface, Floats, str | None, Paint], Callable[[BinaryIO], object]]] = {
        ".glb": _glb,
        ".ply": _ply,
        ".obj": _obj,
        ".stl": _stl,
    }
    ending = path.suffix.lower()
    if ending not in SURFACE_ENDINGS:
        raise ValueError(f"{path}: the ending must be one of {', '.join(SURFACE_ENDINGS)}")
    if len(surface.quads) == 0:
        raise ValueError(f"{path}: the surface has no quads to save")
    if ending == ".glb":
        check_size(path, len(surface.quads), len(surface.attributes))
    check_origin(origin)
    check_map(color_map)
    if limits is not None:
        if len(limits) != 2:
            raise ValueError(f"limits = {limits}: must be two finite numbers, the first below the second")
        ColorScale(*limits, color_map=color_map, log=log)
    if ending not in painted:
        _check_known(surface, color_by)
        _write_vtk(path, vtk_mesh(surface, origin, color_by))
        return
    if log and ending in (".glb", ".ply"):  # of the quads, before vertices take means of them
        name = color_by or "radius"
        try:
            check_positive(_quad_values(surface, color_by))
        except ValueError as error:
            raise ValueError(f"attribute {name!r}: {error}") from error
    paint = partial(colors_of, limits=limits, color_map=color_map, log=log)
    positions = surface.vertices - np.array(origin, dtype=np.float64)
    write_whole(path, painted[ending](surface, positions, color_by, paint))


def save_volume(volume: Volume, filename: str | os.PathLike[str], origin: tuple[float, float, float]) -> None:
    """Write ``volume`` to ``filename``: `Volume.save`."""
    path = Path(filename)
    if path.suffix.lower() not in VOLUME_ENDINGS:
        raise ValueError(f"{path}: the ending must be one of {', '.join(VOLUME_ENDINGS)}; the others hold no hexahedra")
    if len(volume.hexes) == 0:
        raise ValueError(f"{path}: the volume has no hexahedra to save")
    check_origin(origin)
    _write_vtk(path, vtk_mesh(volume, origin))


def _write_vtk(path: Path, mesh: VtkMesh) -> None:
    ending = path.suffix.lower()
    if ending == ".vtkhdf":
        save_vtkhdf(path, mesh)
    else:
        write = write_vtu if ending == ".vtu" else write_vtp
        write_whole(path, lambda file: write(file, mesh))


def _check_known(surface: Surface, color_by: str | None) -> None:
    if color_by not in (None, "radius", *surface.attributes):
        known = ", ".join(["radius", *surface.attributes])
        raise ValueError(f"color_by = {color_by!r}: must be one of {known}")


def _quad_values(surface: Surface, color_by: str | None) -> Floats:
    """The values that colour the quads."""
    _check_known(surface, color_by)
    if color_by is None or (color_by == "radius" and "radius" not in surface.attributes):
        return surface.quad_radius()
    return surface.attributes[color_by]


def _at_vertices(surface: Surface, values: Floats) -> Floats:
    """The mean, at each vertex, of the values of the quads around it; NaN where none has one."""
    there = np.isfinite(values)
    corners = surface.quads[there].reshape(-1)
    total = np.bincount(corners, np.repeat(values[there], 4), len(surface.vertices))
    count = np.bincount(corners, minlength=len(surface.vertices))
    mean: Floats = np.divide(total, count, out=np.full(len(total), np.nan), where=count > 0)
    return mean


def _glb(surface: Surface, positions: Floats, color_by: str | None, paint: Paint) -> Callable[[BinaryIO], object]:
    colors = paint(_quad_values(surface, color_by))
    return lambda file: write_glb(file, positions, surface.quads, colors, surface.attributes, _extras(surface))


def _extras(surface: Surface) -> dict[str, Any]:
    return {"basis": surface.basis, "units": surface.attributes.units, "notes": surface.notes}


def _z_up(positions: Floats) -> Floats:
    return z_up(positions, (0.0, 0.0, 0.0))


def _lines(surface: Surface) -> list[str]:
    """What the surface says of itself, in ASCII lines, as PLY and OBJ have comments."""
    notes = {"axes": f"{AXES}, metres", **with_units(surface.notes, surface.attributes.units)}
    return [f"helibore: {name}: {ascii(text)[1:-1]}" for name, text in notes.items()]


def _ply(surface: Surface, positions: Floats, color_by: str | None, paint: Paint) -> Callable[[BinaryIO], object]:
    """A binary PLY: float64 vertices with colours, and faces of four corners with radius and attributes.

    Colours sit at vertices, the mean of the quads around: several readers know no others, and trimesh fails at faces of
    four corners that have colours of their own.
    """
    values = {"radius": surface.quad_radius(), **surface.attributes}
    for name in values:
        if not re.fullmatch(r"[!-~]+", name) or name in _PLY_CORNERS:
            taken = ", ".join(_PLY_CORNERS)
            raise ValueError(f"attributes[{name!r}]: must be ASCII without blanks in a PLY file, and none of {taken}")
    colors = paint(_at_vertices(surface, _quad_values(surface, color_by)))
    east_north_up = zip("xyz", _z_up(positions).T, strict=True)
    red_green_blue = zip(("red", "green", "blue"), colors.T[:3], strict=True)
    vertices = _records(
        [*((axis, "<f8", of) for axis, of in east_north_up), *((c, "u1", of) for c, of in red_green_blue)]
    )
    corners = [(_PLY_CORNERS[0], "u1", np.uint8(4)), (_PLY_CORNERS[1], "4<i4", surface.quads)]
    faces = _records([*corners, *((name, "<f8", of) for name, of in values.items())])
    header = [
        "ply",
        "format binary_little_endian 1.0",
        *[f"comment {line}" for line in _lines(surface)],
        f"element vertex {len(vertices)}",
        *[f"property double {axis}" for axis in "xyz"],
        *[f"property uchar {channel}" for channel in ("red", "green", "blue")],
        f"element face {len(faces)}",
        "property list uchar int vertex_indices",
        *[f"property double {name}" for name in values],
        "end_header\n",
    ]

    def write(file: BinaryIO) -> None:
        file.write("\n".join(header).encode("ascii"))
        file.write(vertices.tobytes())
        file.write(faces.tobytes())

    return write


def _records(columns: list[tuple[str, str, Any]]) -> npt.NDArray[np.void]:
    """Columns (name, dtype, values) side by side, as PLY holds them."""
    length = max(len(values) for _, _, values in columns if np.ndim(values))
    records: npt.NDArray[np.void] = np.empty(length, dtype=[(name, dtype) for name, dtype, _ in columns])
    for name, _, values in columns:
        records[name] = values
    return records


def _obj(surface: Surface, positions: Floats, _color_by: str | None, _paint: Paint) -> Callable[[BinaryIO], object]:
    import trimesh

    mesh: Any = trimesh.Trimesh(_z_up(positions), surface.triangles(), process=False)
    content = mesh.export(file_type="obj", include_normals=False, header="\n".join(_lines(surface)))
    return lambda file: file.write(content.encode("ascii"))


def _stl(surface: Surface, positions: Floats, _color_by: str | None, _paint: Paint) -> Callable[[BinaryIO], object]:
    import trimesh

    moved = np.abs(positions.astype(np.float32) - positions).max()
    if moved > _STL_TOLERANCE:
        raise ValueError(
            f"STL holds float32, which would move vertices by up to {moved:.3g} m: save .glb or .ply, or give origin= "
            "(north, east, down), a point near the wall to count from"
        )
    mesh: Any = trimesh.Trimesh(_z_up(positions), surface.triangles(), process=False)
    content = mesh.export(file_type="stl")
    header = f"helibore: {BASIS_TEXT[surface.basis]}".encode("ascii").ljust(80)
    return lambda file: file.write(header + content[80:])
