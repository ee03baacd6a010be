"""The base class of surfaces and volumes. The writers of files use only what is defined here.

The metadata of a mesh are texts by name. Every format that holds texts has the same metadata:
{"made by": "helibore 0.1.0", "basis": "radius measured ...", "helix": "64 sectors, pitch 0.1 m, ...", ...}
"""

from __future__ import annotations

import json
from collections.abc import Sequence

import numpy as np

from helibore import _core
from helibore.base.arrays import Floats, Integers
from helibore.base.cached import cached_property
from helibore.base.errors import InputError
from helibore.mesh.attributes import Attributes
from helibore.samples.caliper import Basis
from helibore.samples.helix import Helix, WallLike, basis_text_of, expand_ranges, helix_of
from helibore.trajectory.survey import Path

UNITS = "metres and degrees; depth along the hole, positive down; toolface clockwise looking downhole"


class Mesh:
    """A mesh of one shell (the wall) or of several shells; `Surface` and `Volume` describe the attributes."""

    layer: Integers | None = None
    """(m,) layer of each hexahedron; None for quads."""

    def __init__(
        self, vertices: Floats, cells: Integers, shells: Sequence[Floats], ranges: Sequence[Integers], helix: Helix,
        basis: Basis, attributes: Attributes,
    ) -> None:  # fmt: skip
        """``shells`` holds the radii of each whole shell; ``ranges`` says which vertices of each shell the mesh has."""
        self.vertices, self.helix, self.basis, self.attributes = vertices, helix, basis, attributes
        self.cells = cells  # (m, 4) quads or (m, 8) hexahedra: rows of ``vertices``
        self.metadata: dict[str, str] = {}
        self._shells, self._ranges = shells, ranges

    @cached_property
    def vertex_index(self) -> Integers:
        """For each row of ``vertices``, the number of this vertex, or of the one under it, on the wall, (n,) int64."""
        return np.concatenate([expand_ranges(ranges) for ranges in self._ranges])

    @cached_property
    def radius(self) -> Floats:
        """The radius at each row of ``vertices``, metres, (n,) float64."""
        shells = zip(self._shells, self._ranges, strict=True)
        found = [radius[start:stop] for radius, ranges in shells for start, stop in ranges]
        return np.concatenate(found) if found else np.empty(0)

    def described(self) -> dict[str, str]:
        """Return the metadata and, for each attribute with a unit, a text "unit of NAME"."""
        return {**self.metadata, **{f"unit of {name}": unit for name, unit in self.attributes.units.items() if unit}}

    def __repr__(self) -> str:
        cells = "quads" if self.layer is None else "hexes"
        return f"{type(self).__name__}({len(self.vertices)} vertices, {len(self.cells)} {cells}, {self.attributes!r})"


def quad_radius(mesh: Mesh) -> Floats:
    """Return the mean radius of the corners of each quad, metres, (q,) float64."""
    total: Floats = mesh.radius[mesh.cells[:, 0]]
    for corner in (1, 2, 3):  # one after another, since all four at once would take 32 bytes for each quad
        total += mesh.radius[mesh.cells[:, corner]]
    return total / 4


def triangles(mesh: Mesh) -> Integers:
    """Return two triangles for each quad, (2 q, 3) int64."""
    return mesh.cells[:, [0, 1, 2, 0, 2, 3]].reshape(-1, 3)


def metadata_of(wall: WallLike, path: Path | None) -> dict[str, str]:
    """Return as metadata what a wall is made from, and how it is placed along ``path`` (None: straight down).

    Raises InputError if JSON cannot hold ``made_from``.
    """
    helix = helix_of(wall)
    metadata = {
        "made by": f"helibore {_core.__version__}",
        "units": UNITS,
        "basis": basis_text_of(wall),
        "helix": f"{helix.sectors} sectors, pitch {helix.pitch!r} m, from {helix.start_depth!r} m, "
        f"toolface {helix.start_toolface!r} deg",
        "toolface 0": "north" if path is None else path.reference,
        "path": "straight down from (0, 0, 0)",
    }
    if path is not None:
        north, east, down = path.head
        stations = f"{len(path.survey)} stations from {path.start_depth!r} to {path.survey_depth!r} m"
        head = f"from (north {north!r}, east {east!r}, down {down!r})"
        metadata["path"] = f"{path.method} through {stations}, extended by {path.extend!r} m, {head}"
    bit_diameter = getattr(wall.settings, "bit_diameter", None)
    if bit_diameter is not None:
        metadata["bit_diameter"] = f"{bit_diameter!r} m"
    if made_from := getattr(wall, "made_from", None):
        try:
            metadata["made_from"] = json.dumps(made_from, ensure_ascii=False)
        except (TypeError, ValueError) as error:
            raise InputError("made_from", f"must be what JSON can hold: {error}") from error
    return metadata
