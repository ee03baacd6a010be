"""Write surfaces and volumes to files; the ending chooses the format. trimesh writes OBJ and STL, h5py writes VTKHDF.

GLB, PLY and VTK's XML are written without a library, because trimesh takes three times as long for GLB, and its PLY
holds neither quads nor float64 (``vtk_xml`` gives the reason for VTK).

Files have their own axes. From (north, east, down):

    GLB                 (east, up, -north)     Y up, as glTF requires
    all others          (east, north, up)      Z up, as maps are

Both are rotations; changing only the sign of down would mirror the hole. `Surface.save` lists what a file holds.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np

from helibore.base.arrays import Floats, Rows
from helibore.base.atomic_file import write_whole
from helibore.base.colors import Colors, ColorScale, check_map, check_positive, colors_of
from helibore.base.errors import InputError, check_choice, check_ending
from helibore.base.file_endings import SURFACE_ENDINGS, VOLUME_ENDINGS
from helibore.mesh.glb_file import check_size, write_glb
from helibore.mesh.mesh import Mesh, quad_radius, triangles
from helibore.mesh.vtk_mesh import AXES, check_origin, vtk_mesh, z_up
from helibore.mesh.vtk_xml import write_vtk_xml
from helibore.mesh.vtkhdf import save_vtkhdf

Paint = Callable[[Floats], Colors]
Writer = Callable[[BinaryIO], object]

_PLY_CORNERS = ("corner_count", "vertex_indices")
_STL_TOLERANCE = 1e-3  # metres that float32 may move a vertex


def save_surface(
    mesh: Mesh, path: Path, color_by: str | None, limits: tuple[float, float] | None,
    origin: tuple[float, float, float], color_map: str, log: bool,
) -> None:  # fmt: skip
    """Write quads to ``path``; `Surface.save` describes the arguments."""
    ending = _checked_ending(mesh, path, SURFACE_ENDINGS, "")
    if ending == ".glb":
        check_size(path, len(mesh.cells), len(mesh.attributes))
    check_origin(origin)
    check_map(color_map)
    if limits is not None:
        if len(limits) != 2:
            raise InputError("limits", "must be two finite numbers, the first below the second", str(limits))
        ColorScale(*limits, color_map=color_map, log=log)
    if color_by is not None:
        check_choice("color_by", color_by, ["radius", *mesh.attributes])
    if ending not in _PAINTED:
        _write_vtk(mesh, path, origin, color_by)
        return
    if log and ending in (".glb", ".ply"):  # check quads: a mean at a vertex can hide a wrong value
        try:
            check_positive(_quad_values(mesh, color_by))
        except InputError as error:
            raise error.within(f"attribute {color_by or 'radius'!r}") from error
    paint = partial(colors_of, limits=limits, color_map=color_map, log=log)
    positions = mesh.vertices - np.array(origin, dtype=np.float64) if any(origin) else mesh.vertices
    write_whole(path, _PAINTED[ending](mesh, positions, color_by, paint))


def save_volume(mesh: Mesh, path: Path, origin: tuple[float, float, float]) -> None:
    """Write hexahedra to ``path``; `Volume.save` describes the arguments."""
    _checked_ending(mesh, path, VOLUME_ENDINGS, "; other formats hold no hexahedra")
    check_origin(origin)
    _write_vtk(mesh, path, origin, None)


def _checked_ending(mesh: Mesh, path: Path, known: tuple[str, ...], reason: str) -> str:
    ending = check_ending(path, known, reason)
    if not len(mesh.cells):
        empty = "the surface has no quads to save" if mesh.layer is None else "the volume has no hexahedra to save"
        raise InputError(str(path), empty)
    return ending


def _write_vtk(mesh: Mesh, path: Path, origin: tuple[float, float, float], active: str | None) -> None:
    content = vtk_mesh(mesh, origin, active)
    if path.suffix.lower() == ".vtkhdf":
        save_vtkhdf(path, content)
    else:
        write_whole(path, lambda file: write_vtk_xml(file, content, path.suffix.lower() == ".vtp"))


def _quad_values(mesh: Mesh, color_by: str | None) -> Floats:
    """Return the values that colour a mesh, one for each quad: those of ``color_by``; if it is None, the radius."""
    if color_by is None or (color_by == "radius" and "radius" not in mesh.attributes):
        return quad_radius(mesh)
    return mesh.attributes[color_by]


def _at_vertices(mesh: Mesh, values: Floats) -> Floats:
    """Return the mean, at each vertex, of the values of the quads around it; NaN if none of these quads has a value."""
    there = np.isfinite(values)
    corners = mesh.cells[there].reshape(-1)
    total = np.bincount(corners, np.repeat(values[there], 4), len(mesh.vertices))
    count = np.bincount(corners, minlength=len(mesh.vertices))
    mean: Floats = np.divide(total, count, out=np.full(len(total), np.nan), where=count > 0)
    return mean


def _glb(mesh: Mesh, positions: Floats, color_by: str | None, paint: Paint) -> Writer:
    colors = paint(_quad_values(mesh, color_by))
    extras = {"basis": mesh.basis, "units": mesh.attributes.units, "metadata": mesh.metadata}
    return lambda file: write_glb(file, positions, mesh.cells, colors, mesh.attributes, extras)


def _lines(mesh: Mesh) -> list[str]:
    """Return the metadata as ASCII lines for the comments of PLY and OBJ."""
    metadata = {"axes": f"{AXES}, metres", **mesh.described()}
    return [f"helibore: {ascii(name)[1:-1]}: {ascii(text)[1:-1]}" for name, text in metadata.items()]


def _ply(mesh: Mesh, positions: Floats, color_by: str | None, paint: Paint) -> Writer:
    """Write a binary PLY: float64 vertices with colours, and faces of four corners with radius and attributes.

    A vertex has the colour of the mean value of the quads around it. Several readers know only colours at vertices, and
    trimesh fails if faces of four corners have colours.
    """
    values = {"radius": quad_radius(mesh), **mesh.attributes}
    for name in values:
        if not re.fullmatch(r"[!-~]+", name) or name in _PLY_CORNERS:
            rule = f"must be ASCII without blanks in a PLY file, and none of {', '.join(_PLY_CORNERS)}"
            raise InputError(f"attributes[{name!r}]", rule)
    colors = paint(_at_vertices(mesh, _quad_values(mesh, color_by)))
    axes = [(axis, "<f8", of) for axis, of in zip("xyz", z_up(positions).T, strict=True)]
    channels = [(name, "u1", of) for name, of in zip(("red", "green", "blue"), colors.T[:3], strict=True)]
    vertices = _records([*axes, *channels])
    corners = [(_PLY_CORNERS[0], "u1", np.uint8(4)), (_PLY_CORNERS[1], "4<i4", mesh.cells)]
    faces = _records([*corners, *((name, "<f8", of) for name, of in values.items())])
    header = [
        "ply",
        "format binary_little_endian 1.0",
        *[f"comment {line}" for line in _lines(mesh)],
        f"element vertex {len(vertices)}",
        *[f"property double {name}" for name, _, _ in axes],
        *[f"property uchar {name}" for name, _, _ in channels],
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


def _records(columns: list[tuple[str, str, Any]]) -> Rows:
    """Return columns (name, dtype, values) as records of a PLY file."""
    length = max(len(values) for _, _, values in columns if np.ndim(values))
    records: Rows = np.empty(length, dtype=[(name, dtype) for name, dtype, _ in columns])
    for name, _, values in columns:
        records[name] = values
    return records


def _obj(mesh: Mesh, positions: Floats, _color_by: str | None, _paint: Paint) -> Writer:
    import trimesh

    exported: Any = trimesh.Trimesh(z_up(positions), triangles(mesh), process=False)
    content = exported.export(file_type="obj", include_normals=False, header="\n".join(_lines(mesh)))
    return lambda file: file.write(content.encode("ascii"))


def _stl(mesh: Mesh, positions: Floats, _color_by: str | None, _paint: Paint) -> Writer:
    import trimesh

    moved = np.abs(positions.astype(np.float32) - positions).max()
    if moved > _STL_TOLERANCE:
        rule = "save .glb or .ply, or give origin=(north, east, down), a point near the wall to count from"
        raise InputError(f"STL holds float32, which would move vertices by up to {moved:.3g} m", rule)
    exported: Any = trimesh.Trimesh(z_up(positions), triangles(mesh), process=False)
    content = exported.export(file_type="stl")
    basis = mesh.metadata.get("basis", mesh.basis)
    header = f"helibore: {basis}".encode("ascii", "replace")[:80].ljust(80)
    return lambda file: file.write(header + content[80:])


_PAINTED = {".glb": _glb, ".ply": _ply, ".obj": _obj, ".stl": _stl}
