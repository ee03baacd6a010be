"""A mesh for VTK's formats: points, cells of one kind, named values on both, and texts.

    points   (east, north, up), float64            Z is up, as in maps; the change of axes is a rotation, no mirror
    cells    quads (type 9) or hexahedra (type 12), corners in helibore's own order, which is VTK's

vtk_xml.py and vtkhdf.py write the same mesh in two formats.
"""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from helibore.base.arrays import Array, Floats
from helibore.base.errors import InputError
from helibore.mesh.mesh import Mesh, quad_radius

QUAD, HEXAHEDRON = 9, 12  # VTK File Formats, "Cell types"
AXES = "x east, y north, z up"
_NOT_IN_A_NAME = re.compile("[\x00-\x1f\ud800-\udfff\ufffe\uffff]")  # XML cannot hold these


@dataclass(frozen=True)
class VtkMesh:
    """The content of a VTK file; ``active`` names the cell values that programs show first."""

    points: Floats
    corners: Array
    cell_type: int
    point_values: Mapping[str, Array]
    cell_values: Mapping[str, Array]
    active: str
    metadata: Mapping[str, str]


def check_origin(origin: tuple[float, float, float]) -> None:
    """Raise an InputError unless the origin is three finite numbers."""
    if len(origin) != 3 or not all(map(math.isfinite, origin)):
        raise InputError("origin", "must be three finite numbers (north, east, down)", str(origin))


def z_up(vertices: Floats, origin: tuple[float, float, float] = (0.0, 0.0, 0.0)) -> Floats:
    """Return points (north, east, down) as (east, north, up) from ``origin``, which is (north, east, down)."""
    north, east, down = origin
    points = np.empty_like(vertices)
    np.subtract(vertices[:, 1], east, out=points[:, 0])
    np.subtract(vertices[:, 0], north, out=points[:, 1])
    np.subtract(down, vertices[:, 2], out=points[:, 2])
    return points


def vtk_mesh(mesh: Mesh, origin: tuple[float, float, float], active: str | None = None) -> VtkMesh:
    """Return a mesh with its attributes in VTK's layout. Raises InputError on a name that XML cannot hold.

    ``active`` names the cell values that programs show first; None: the radius of a surface, the layer of a volume.
    """
    own: dict[str, Array]
    own = {"radius": quad_radius(mesh)} if mesh.layer is None else {"layer": mesh.layer.astype(np.int32)}
    metadata = {**mesh.described(), "axes": AXES}
    for name, unit in (("radius", "m"), ("depth", "m"), ("toolface", "deg")):
        metadata.setdefault(f"unit of {name}", unit)
    if any(origin):
        metadata["origin"] = "north {!r}, east {!r}, down {!r} m".format(*map(float, origin))
    for place, names in (("attributes", mesh.attributes), ("metadata", metadata)):
        for name in names:
            if not name or _NOT_IN_A_NAME.search(name):
                rule = "a name in a VTK file must not be empty or contain characters that XML forbids"
                raise InputError(f"{place}[{name!r}]", rule)
    k = mesh.vertex_index
    return VtkMesh(
        points=z_up(mesh.vertices, origin),
        corners=mesh.cells,
        cell_type=QUAD if mesh.layer is None else HEXAHEDRON,
        point_values={"radius": mesh.radius, "depth": mesh.helix.depth(k), "toolface": mesh.helix.toolface(k)},
        cell_values={**own, **mesh.attributes},
        active=active or next(iter(own)),
        metadata={name: text.encode(errors="backslashreplace").decode() for name, text in metadata.items()},
    )
