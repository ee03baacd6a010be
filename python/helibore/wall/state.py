"""A wall at one moment: what archives hold, and what meshes and logs are made of while the wall itself grows on."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NamedTuple

from helibore.base.arrays import Floats, Integers32
from helibore.base.settings import Settings
from helibore.images.sector_image import SectorImage
from helibore.mesh.attributes import WallAttributes
from helibore.samples.angular_gap import angular_gap
from helibore.samples.caliper import Basis, Caliper
from helibore.samples.helix import helix_of, quad_room
from helibore.trajectory.survey import Path


class WallState(NamedTuple):
    """Owned arrays of one moment, named as in `Wall`; ``sample_columns`` are depth, toolface, radius and any time."""

    settings: Settings
    basis: Basis
    start_depth: float
    radius: Floats
    nearest: Floats
    support: Integers32
    iterations: Integers32
    sample_columns: tuple[Floats, ...]
    path: Path | None
    images: Mapping[str, SectorImage]
    attributes: WallAttributes
    made_from: dict[str, Any]
    arms: Caliper | None = None

    @property
    def angular_gap(self) -> Floats:
        """As `Wall.angular_gap`."""
        depth, toolface, *_ = self.sample_columns
        return angular_gap(helix_of(self), self.radius.size, depth, toolface, self.settings.gap_reach)

    @property
    def samples(self) -> Caliper:
        """As `Wall.samples`."""
        return Caliper(*self.sample_columns, basis=self.basis)

    @property
    def sample_count(self) -> int:
        """As `Wall.sample_count`."""
        return self.sample_columns[0].size

    @property
    def quads(self) -> int:
        """Quads that the vertices have room for."""
        return quad_room(self.radius.size, self.settings.sectors)
