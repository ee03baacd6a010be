"""The plain arrays of a surface or volume for the file writers, which do not know these classes."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from helibore.base.arrays import Floats, Integers
from helibore.samples.caliper import Basis
from helibore.samples.helix import Helix


@dataclass(frozen=True, eq=False)
class MeshArrays:
    """Arrays of a mesh.

    Attributes
    ----------
    vertices
        (n, 3) float64, north, east and down, metres.
    cells
        (m, 4) quads or (m, 8) hexahedra: rows of ``vertices``.
    vertex_index, radius
        (n,) the vertex of the wall that each row is, and its radius.
    helix
        Where vertices lie along and around the hole.
    attributes, units
        (m,) values by name, and units by name where they are known.
    basis, metadata
        What the wall is built from; texts by name.
    layer
        (m,) of hexahedra; None for quads.
    """

    vertices: Floats
    cells: Integers
    vertex_index: Integers
    radius: Floats
    helix: Helix
    attributes: Mapping[str, Floats]
    units: Mapping[str, str]
    basis: Basis
    metadata: Mapping[str, str]
    layer: Integers | None = None

    def quad_radius(self) -> Floats:
        """Return the mean radius of the corners of each quad, metres, (m,) float64."""
        corners = self.radius[self.cells]
        return (corners[:, 0] + corners[:, 1] + corners[:, 2] + corners[:, 3]) / 4

    def triangles(self) -> Integers:
        """Return two triangles a quad, (2 m, 3) int64."""
        return self.cells[:, [0, 1, 2, 0, 2, 3]].reshape(-1, 3)

    def described(self) -> dict[str, str]:
        """Return the metadata, and the units of the attributes that have one."""
        return {**self.metadata, **{f"unit of {name}": unit for name, unit in self.units.items() if unit}}
