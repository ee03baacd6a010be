"""The arrays of a wall at one moment, with what is placed on it: archives hold them, and every reading uses them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from helibore import _core
from helibore.base.arrays import Bytes, Floats, Integers32, Mask
from helibore.base.cached import cached_property
from helibore.base.thread_count import thread_count
from helibore.images.sector_image import SectorImage
from helibore.logs.intervals import Interval
from helibore.logs.kept_logs import KeptLogs
from helibore.logs.picks import Picks
from helibore.mesh.attributes import WallAttributes
from helibore.samples.caliper import Basis, Caliper
from helibore.samples.helix import quad_room, whole_helix
from helibore.settings.wall_settings import Settings
from helibore.trajectory.survey import Path
from helibore.wall.covariance import covariance_of

MEASURED = "measured"
"""Attribute of the meshes of a tool with few arms: 1 for a measured quad, 0 for one that is interpolated."""

NEAR_DEPTH, NEAR_TOOLFACE = 0.15, 15.0
"""Metres and degrees from a measured vertex to a sample, at most."""
LARGEST_CHANGE = 0.0011
"""Metres by which the wall changes between a measured vertex and its nearest samples, at most.

The core's ``MeasuredRule`` says how the change follows from the four nearest samples. With this limit 95 % of the
errors of measured vertices are below 1.6 mm, a quarter of the smallest limit of the criteria
(``python -m bench.accuracy.hazards vertices``).
"""

SHAPE_GAP = 30.0
"""Degrees; if the mean gap is at most this, a wall with a covariance has the shape of the hole between its arms."""


@dataclass(frozen=True, eq=False, repr=False)
class WallColumns:
    """Copies of a wall's arrays at one moment, and of its path, images, picks and so on, named as in `Wall`.

    ``sample_columns`` are depth, toolface, radius and, if samples have times, time; () if they were not copied.
    ``sums`` holds for each vertex the sums from which its uncertainty is computed; () without `Settings.sigma`.
    ``kept`` is shared by all copies of a wall with the same samples; what `dataclasses.replace` returns has its own.
    """

    settings: Settings
    basis: Basis
    basis_text: str
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
    sums: tuple[Floats, ...] = ()
    threads: int | None = None
    picks: Picks = field(default_factory=Picks)
    intervals: tuple[Interval, ...] = ()
    kept: KeptLogs = field(default_factory=KeptLogs, init=False)

    @cached_property
    def angular_gap(self) -> Floats:
        depth, toolface, *_ = self.sample_columns
        reach = self.settings.gap_reach
        return _core.angular_gaps(
            whole_helix(self), self.radius.size, depth, toolface, reach, thread_count(self.threads)
        )

    @cached_property
    def along_shape(self) -> WallColumns:
        """This wall, but its `angular_gap` counts samples as far along the hole as the covariance finds radii alike."""
        reach = covariance_of(self.settings.covariance or ()).gap_reach
        return replace(self, settings=replace(self.settings, gap_reach=reach))

    @property
    def has_shape(self) -> bool:
        """Whether near and far neighbours saw the hole all around: its shape is that of the wall, not of arms."""
        if self.settings.estimator != "near-and-far" or not self.radius.size:
            return False
        return bool(self.along_shape.angular_gap.mean() <= SHAPE_GAP)

    @cached_property
    def measured(self) -> Mask:
        measured: Mask = self._measured == 1
        return measured

    @cached_property
    def sampled(self) -> Mask:
        """Whether each vertex is `measured` but for the change of the wall: what a body may meet there is known."""
        sampled: Mask = self._measured > 0
        return sampled

    @property
    def _measured(self) -> Bytes:
        """1: `measured`; 2: `sampled`, but not measured; 0: neither."""
        if self.kept.marks is not None:
            return self.kept.marks
        depth, toolface, radius, *_ = self.sample_columns
        rule = (NEAR_DEPTH, NEAR_TOOLFACE, self.settings.gap_reach, self.settings.largest_gap, LARGEST_CHANGE)
        place = (whole_helix(self), self.radius.size, depth, toolface, radius, self.radius)
        self.kept.marks = _core.measured(*place, rule, thread_count(self.threads)) * np.isfinite(self.radius)
        return self.kept.marks

    @property
    def samples(self) -> Caliper:
        return Caliper(*self.sample_columns, basis=self.basis)

    @property
    def sample_count(self) -> int:
        return self.sample_columns[0].size

    @property
    def quads(self) -> int:
        """Number of quads between the vertices, including those with a missing corner."""
        return quad_room(self.radius.size, self.settings.sectors)
