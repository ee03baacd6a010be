"""A surface or volume as VTK's formats hold it: points, cells of one kind, named values on both, texts.

    points   (east, north, up), float64            Z up, as maps are; both ways of turning are rotations
    cells    quads (type 9) or hexahedra (type 12), corners in helibore's own order, which is VTK's

What vtk_xml.py and vtkhdf.py write; the two differ in nothing else.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from helibore.base.arrays import Floats
from helibore.mesh.metadata import with_units

if TYPE_CHECKING:
    from helibore.mesh.surface import Surface
    from helibore.mesh.volume import Volume

QUAD, HEXAHEDRON = 9, 12  # VTK File Formats, "Cell types"
AXES = "x east, y north, z up"
_LARGEST_INT32 = 2**31 - 1


@dataclass(frozen=True)
class VtkMesh:
    """What goes into a file."""

    points: Floats
    corners: npt.NDArray[Any]
    cell_type: int
    point_values: Mapping[str, npt.NDArray[Any]]
    cell_values: Mapping[str, npt.NDArray[Any]]
    active: str  # the cell values that programs show first
    notes: Mapping[str, str]


def check_origin(origin: tuple[float, float, float]) -> None:
    """Raise a ValueError unless the origin is three finite numbers."""
    if len(origin) != 3 or not all(map(math.isfinite, origin)):
        raise ValueError(f"origin = {origin}: must be three finite numbers (north, east, down)")


def z_up(vertices: Floats, origin: tuple[float, float, float]) -> Floats:
    """Return (north, east, down) as (east, north, up) from an origin given as (north, east, down)."""
    north, east, down = origin
    points = np.empty_like(vertices)
    np.subtract(vertices[:, 1], east, out=points[:, 0])
    np.subtract(vertices[:, 0], north, out=points[:, 1])
    np.subtract(down, vertices[:, 2], out=points[:, 2])
    return points


def vtk_mesh(mesh: Surface | Volume, origin: tuple[float, float, float], active: str | None = None) -> VtkMesh:
    """Return a mesh with all its attributes as VTK has it."""
    from helibore.mesh.surface import Surface

    k = mesh.vertex_index
    if isinstance(mesh, Surface):
        corners, cell_type = mesh.quads, QUAD
        cell_values: dict[str, npt.NDArray[Any]] = {"radius": mesh.quad_radius()}
    else:
        corners, cell_type = mesh.hexes, HEXAHEDRON
        cell_values = {"layer": mesh.hex_layer.astype(np.int32)}
    units = {"radius": "m", "depth": "m", "toolface": "deg", **mesh.attributes.units}
    notes = {**with_units(mesh.notes, units), "axes": AXES}
    if any(origin):
        notes["origin"] = "north {!r}, east {!r}, down {!r} m".format(*map(float, origin))
    small = max(len(mesh.vertices), corners.size) <= _LARGEST_INT32
    return VtkMesh(
        points=z_up(mesh.vertices, origin),
        corners=corners.astype("<i4" if small else "<i8", copy=False),
        cell_type=cell_type,
        point_values={"radius": mesh.radius, "depth": mesh.helix.depth(k), "toolface": mesh.helix.toolface(k)},
        cell_values={**cell_values, **mesh.attributes},
        active=active or next(iter(cell_values)),
        notes=notes,
    )
