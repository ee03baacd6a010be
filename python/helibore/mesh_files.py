"""Surfaces as files: GLB, OBJ and STL through trimesh; PLY here, because trimesh's holds neither quads nor float64.

Files have their own axes. From (north, east, down):

    GLB             (east, up, -north)     Y up, as glTF requires
    PLY, OBJ, STL   (east, north, up)      Z up, as maps are

Both are rotations; swapping only the sign of down would mirror the hole. What a file holds is in `Surface.save`.
"""

from __future__ import annotations

import os
import re
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any, BinaryIO

import numpy as np
import numpy.typing as npt

from helibore.arrays import Floats
from helibore.atomic_file import write_whole

if TYPE_CHECKING:
    from helibore.surface import Surface

Colors = npt.NDArray[np.uint8]
Limits = tuple[float, float] | None

# Dark to bright evenly in lightness, safe for colour-blind eyes: nine stops of viridis (van der Walt and Smith, CC0).
_STOPS = np.array(
    [
        (68, 1, 84),
        (71, 44, 122),
        (59, 81, 139),
        (44, 113, 142),
        (33, 144, 141),
        (39, 173, 129),
        (92, 200, 99),
        (170, 220, 50),
        (253, 231, 37),
    ],
    dtype=np.float64,
)
_MISSING = (160, 160, 160)
_PLY_NAMES = ("corners", "vertex_indices", "red", "green", "blue")
_STL_TOLERANCE = 1e-3  # metres a vertex may move


def save_surface(
    surface: Surface,
    filename: str | os.PathLike[str],
    color_by: str | None,
    limits: Limits,
    origin: tuple[float, float, float],
) -> None:
    """Write ``surface`` to ``filename``: `Surface.save`."""
    path = Path(filename)
    writers: dict[str, Callable[[Surface, Floats, str | None, Limits], Callable[[BinaryIO], object]]] = {
        ".glb": _glb,
        ".ply": _ply,
        ".obj": _obj,
        ".stl": _stl,
    }
    writer = writers.get(path.suffix.lower())
    if writer is None:
        raise ValueError(f"{path}: the ending must be one of {', '.join(writers)}")
    if len(surface.quads) == 0:
        raise ValueError(f"{path}: the surface has no quads to save")
    positions = surface.vertices - np.array(origin, dtype=np.float64)
    write_whole(path, writer(surface, positions, color_by, limits))


def colors_of(values: Floats, limits: Limits = None) -> Colors:
    """Colour values from dark (least) to bright (greatest); missing ones grey.

    Parameters
    ----------
    values
        (n,) float64.
    limits
        Values of the darkest and the brightest colour; None: the least and the greatest of ``values``.

    Returns
    -------
    (n, 4) uint8: red, green, blue, 255.
    """
    there = np.isfinite(values)
    low, high = limits if limits is not None else _extremes(values[there])
    span = high - low
    share = np.clip((values - low) / span, 0, 1) if span else np.zeros_like(values)
    steps = np.linspace(0, 1, 1024) * (len(_STOPS) - 1)  # a table: one look-up a value
    table = np.full((1025, 4), 255, dtype=np.uint8)
    for channel in range(3):
        table[:1024, channel] = np.rint(np.interp(steps, np.arange(len(_STOPS)), _STOPS[:, channel]))
    table[1024, :3] = _MISSING
    return table[np.where(there, np.rint(np.where(there, share, 0) * 1023), 1024).astype(np.intp)]


def _extremes(values: Floats) -> tuple[float, float]:
    return (float(values.min()), float(values.max())) if values.size else (0.0, 0.0)


def _quad_colors(surface: Surface, color_by: str | None, limits: Limits) -> Colors:
    if color_by is None or (color_by == "radius" and "radius" not in surface.attributes):
        return colors_of(surface.quad_radius(), limits)
    if color_by not in surface.attributes:
        known = ", ".join(["radius", *surface.attributes])
        raise ValueError(f"color_by = {color_by!r}: must be one of {known}")
    return colors_of(surface.attributes[color_by], limits)


def _glb(surface: Surface, positions: Floats, color_by: str | None, limits: Limits) -> Callable[[BinaryIO], object]:
    """A binary glTF with one mesh under one node.

    Quads do not share vertices: glTF has colours at vertices only, and a shared one would smear neighbouring quads into
    each other. The node's translation, in JSON and thus float64, carries the middle of the wall, so that float32
    vertices are good to half a millimetre as far as 8 km from it.
    """
    import trimesh

    y_up = np.column_stack([positions[:, 1], -positions[:, 2], -positions[:, 0]])
    middle = (y_up.min(axis=0) + y_up.max(axis=0)) / 2
    corners = (y_up - middle).astype(np.float32)[surface.quads.reshape(-1)]
    first = 4 * np.arange(len(surface.quads))[:, None]
    mesh = trimesh.Trimesh(
        vertices=corners,
        faces=(first + np.array([0, 1, 2, 0, 2, 3])).reshape(-1, 3),
        vertex_colors=np.repeat(_quad_colors(surface, color_by, limits), 4, axis=0),
        process=False,
    )
    scene: Any = trimesh.Scene()
    scene.add_geometry(mesh, node_name="wall", geom_name="wall", transform=_translation(middle))
    content = scene.export(file_type="glb")
    return lambda file: file.write(content)


def _translation(offset: Floats) -> Floats:
    transform = np.eye(4)
    transform[:3, 3] = offset
    return transform


def _z_up(positions: Floats) -> Floats:
    return np.column_stack([positions[:, 1], positions[:, 0], -positions[:, 2]])


def _ply(surface: Surface, positions: Floats, color_by: str | None, limits: Limits) -> Callable[[BinaryIO], object]:
    """A binary PLY: float64 vertices, and faces of four corners with colour and attributes."""
    taken = ", ".join(_PLY_NAMES)
    for name in surface.attributes:
        if not re.fullmatch(r"[!-~]+", name) or name in _PLY_NAMES:
            raise ValueError(f"attributes[{name!r}]: must be ASCII without blanks in a PLY file, and none of {taken}")
    values = {"radius": surface.quad_radius(), **surface.attributes}
    faces = np.empty(
        len(surface.quads),
        dtype=[
            ("corners", "u1"),
            ("vertex_indices", "<i4", 4),
            ("red", "u1"),
            ("green", "u1"),
            ("blue", "u1"),
            *[(name, "<f8") for name in values],
        ],
    )
    faces["corners"] = 4
    faces["vertex_indices"] = surface.quads
    colors = _quad_colors(surface, color_by, limits)
    for channel, name in enumerate(("red", "green", "blue")):
        faces[name] = colors[:, channel]
    for name, column in values.items():
        faces[name] = column
    header = [
        "ply",
        "format binary_little_endian 1.0",
        "comment helibore: x east, y north, z up, metres",
        f"element vertex {len(positions)}",
        *[f"property double {axis}" for axis in "xyz"],
        f"element face {len(faces)}",
        "property list uchar int vertex_indices",
        *[f"property uchar {channel}" for channel in ("red", "green", "blue")],
        *[f"property double {name}" for name in values],
        "end_header\n",
    ]

    def write(file: BinaryIO) -> None:
        file.write("\n".join(header).encode("ascii"))
        file.write(_z_up(positions).astype("<f8").tobytes())
        file.write(faces.tobytes())

    return write


def _obj(surface: Surface, positions: Floats, _color_by: str | None, _limits: Limits) -> Callable[[BinaryIO], object]:
    import trimesh

    mesh: Any = trimesh.Trimesh(_z_up(positions), surface.triangles(), process=False)
    content = mesh.export(file_type="obj", include_normals=False, header="helibore: x east, y north, z up, metres")
    return lambda file: file.write(content.encode("ascii"))


def _stl(surface: Surface, positions: Floats, _color_by: str | None, _limits: Limits) -> Callable[[BinaryIO], object]:
    import trimesh

    moved = np.abs(positions.astype(np.float32) - positions).max()
    if moved > _STL_TOLERANCE:
        raise ValueError(
            f"STL holds float32, which would move vertices by up to {moved:.3g} m: save .glb or .ply, or give origin= "
            "(north, east, down), a point near the wall to count from"
        )
    mesh: Any = trimesh.Trimesh(_z_up(positions), surface.triangles(), process=False)
    content = mesh.export(file_type="stl")
    return lambda file: file.write(content)
