"""Logs of a wall: the measures of every full turn of its helix, or of every step of depth.

    area = 1/2 int r^2 dtoolface = pi mean(r^2)        equivalent diameter = 2 sqrt(mean(r^2))

    logs = wall.logs()                      one row a turn
    metre = logs.by_step(1.0)               one row a metre
    logs.table(), logs.save("well.las")     with mnemonics, units, and facts on how the logs were made

The mean over evenly spaced toolfaces is the periodic trapezoid rule: for a smooth hole its error falls faster than any
power of the number of sectors, while the area of the polygon is 2.5 % too small at 16 sectors. A turn with a missing
radius has no area, since the missing part may differ from the measured one; `coverage` is the part that is measured.
The last turn counts only if it is full. Other files have casing and cement (``annulus``), the kinds of hole (``zones``)
and the formats of files (``log_writing``).
"""

from __future__ import annotations

import math
import os
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, fields, replace
from functools import partial
from typing import Any, Literal

import numpy as np
import numpy.typing as npt

from helibore import _core
from helibore.base.arrays import Floats, Integers, Mask, column
from helibore.base.cached import cached_property
from helibore.base.errors import InputError, check_not_negative
from helibore.base.notebook import card, curve_picture
from helibore.base.tables import LogColumn, LogImage, LogTable, Tabular
from helibore.base.thread_count import thread_count
from helibore.logs.annulus import Annulus, annulus
from helibore.logs.cement_sheet import CementSheet, MeasuredHole, cement_sheet
from helibore.logs.depth_steps import ALIKE_ALONG, by_step
from helibore.logs.kept_samples import columns_of_kept_samples, columns_of_samples
from helibore.logs.late_columns import LateColumns
from helibore.logs.likely_kinds import PARTS, Along, kinds_along
from helibore.logs.log_columns import COLUMNS, SHAPE_SIGMA, WORN
from helibore.logs.rounding import rounding_sigma
from helibore.logs.shape_sigma import shape_sigma
from helibore.samples.caliper import Basis, Caliper
from helibore.samples.helix import WallLike, basis_of, basis_text_of, whole_helix
from helibore.settings.cement_settings import CementJob
from helibore.settings.zone_settings import Criteria
from helibore.trajectory.references import reference_assumed, reference_of
from helibore.trajectory.survey import Path
from helibore.trajectory.true_depth import true_depth

Shape = Literal["wall", "arms"]
SHAPE_TEXT: dict[Shape, str] = {
    "wall": "C1, C2, DMIN, ovality and class of hole come from the wall",
    "arms": "C1, C2, DMIN, ovality and class of hole come from the tool's arms; the wall between arms is interpolated",
}
SEES_ALL_AROUND = 0.9
"""Least mean share of the turns with a sample near at which the wall shows the shape better than the arms alone."""
COVERED = 0.9
"""If the mean coverage is less, a warning says that the wall is interpolated."""
ARM_MEAN = "mean over the row and of all passes"
NO_UNCERTAINTY = (
    "of mean diameter, volume, annulus and cement the uncertainty is not known where the wall is interpolated, "
    "not measured"
)
"""What terminal, files, reports and prints state on a wall that is partly interpolated."""
RANGED = (
    "mean diameters, volumes and excess are ranges with a probability of 95 % where turns have few samples: the hole "
    "there is that of known sections which fit the samples of many turns"
)
"""What terminal and report state where `Logs.diameter_range` is a range."""
LARGE = 1.85
"""If the median diameter is more than this multiple of bit size, bit size or units are probably wrong."""
SMALL = 0.1
"""If the median diameter is less than bit size by more than this share, bit size or units are probably wrong."""
SHAPE_KEPT = 0.7
"""If the wall has a smaller share of the arms' out-of-roundness, a warning says that it is rounder than the hole."""
VERTICAL = 1e-6
"""Sine of the inclination, 0.00006 degrees, up to which a hole has no azimuth."""
ALIKE_AROUND = 30.0
"""Degrees around the hole over which the errors of a wall are alike (``python -m bench.accuracy.amounts``)."""
LEAST_SAMPLED = 0.9
"""Least share of a turn's vertices with a sigma at which its mean diameter has one."""
SIZE_ROUGH = 1.8e-3
"""Metres; standard deviation of the equivalent diameter of a hole from that of its likely section."""
SIZE_APART = 0.07
"""The same as a share of its difference from the bit: known sections lie the farther apart, the larger they are."""
MOSTLY = 0.4
"""Least share of rows with a range of the diameter at which it has columns: a gap needs none."""
RUGOSITY_WINDOW = 1.0
"""Metres of hole that rugosity is measured over by default."""


def _worn(name: str) -> cached_property[Floats]:
    return cached_property(lambda logs: logs.worn[name])


def _uncertain(name: str) -> cached_property[Floats]:
    return cached_property(lambda logs: np.full(len(logs), np.nan) if logs.uncertain is None else logs.uncertain[name])


@dataclass(frozen=True, eq=False)
class Logs(Tabular):
    """Columns with one row per turn or step, each (rows,) float64, owned; made by `turn_logs`.

    Lengths are metres. In the names of attributes 0 and 90 are toolfaces, so `diameter_0` is the vertical diameter if
    toolfaces count from the high side. Diameters go through the axis of the hole. Missing values are NaN: unless stated
    otherwise, a value is missing if any vertex of its row has no radius.

    Attributes
    ----------
    depth
        Mean depth of the turn's vertices, or middle of the step.
    mean, smallest, largest
        Mean, smallest and largest radius; the latter two ignore missing radii.
    equivalent_diameter
        Diameter of the circle of the same area; the area is the integral, not that of the polygon.
    c1, c1_toolface, c2
        Largest diameter, its toolface (degrees in [0, 180)), and the diameter at right angles to it.
    least_diameter
        Smallest diameter.
    diameter_0, diameter_90
        The diameters from toolface 0 to 180 and from 90 to 270.
    ovality_api, ovality_dnv
        (max - min) / (max + min) of the diameters (API RP 1111, 17B), and twice that (DNV-ST-F101, ISO 13623).
    out_of_roundness
        Largest less smallest diameter (API 5L, 7-1).
    wall_out_of_roundness
        Largest less smallest diameter of the wall, whatever `shape` is.
    uneven
        With ``shape = "arms"``: difference of the radii at the two ends of the largest diameter; 0 if diameters were
        measured. With ``shape = "wall"``: NaN.
    centre_0, centre_90
        Distances of the centre of the area from the axis, towards toolfaces 0 and 90.
    inscribed_diameter, inscribed_0, inscribed_90
        Diameter and centre of the largest circle with no vertex inside; no small move makes the circle larger.
        With ``shape = "arms"`` it is at most the least diameter of the arms, since the wall between arms is rounder
        than the hole.
    enclosing_diameter
        Diameter of the smallest circle around all vertices; with ``shape = "arms"`` at least the largest diameter of
        the arms.
    worn
        The following columns by name; they are measured when one of them is first read.
    unworn_diameter, unworn_0, unworn_90
        Diameter and centre of the unworn circle, which the bit left: a robust fit to the measured vertices of the
        turn, in which worn rock hardly counts. NaN if less than a quarter of the turn is measured.
    lobe1_toolface, lobe1_width, lobe1_height, lobe1_pipe
        The highest lobe, a run of vertices more than 3 mm (in 8.5 in hole) outside the unworn circle: its toolface seen
        from the circle's centre, degrees in [0, 360); degrees above a quarter of its height; greatest height; diameter
        of the circle through the part above 0.35 of the height, which in a key seat is the pipe's. NaN without a lobe.
    lobe2_toolface, lobe2_width, lobe2_height, lobe2_pipe
        The next lobe of the turn.
    sections
        The following column by its name; it is measured when it is first read.
    section
        (turns, 32) mean radius of the samples in each of 32 parts of the turn, metres; part p is around the toolface
        p 360 / 32. NaN: no sample. If the wall has no samples: of its vertices. A step has none. Kinds are compared
        with it.
    rugosity
        Root mean square of the radii over `rugosity_window` metres around the turn, after a straight line along the
        hole is subtracted in each sector. Also NaN within half a window of an end or a missing radius.
    volume
        Volume of the hole over one pitch or step, cubic metres.
    excess
        Ratio of `volume` to the volume at bit size, less 1: 0.1 is ten percent; negative where the hole is under gauge.
    coverage
        Share of the turn that is measured, 0 to 1: the share of its vertices in `Wall.measured`. If the wall has no
        samples: that of vertices with a radius. NaN if the wall is round by assumption (`Wall.basis`).
    arm_diameter
        The diameters that each arm of a tool with few arms measured, one array per arm; () for other tools. A value is
        the mean of the arm's readings, linear between them, over the turn or step, and of all passes. If a peak is
        shorter than the turn or step, or only one pass has it, then this value and `c1` are lower than its largest
        reading. NaN if all readings of the arm are farther away than `Settings.max_distance`.
    sampled
        Share of the turn that is measured but for the limit of the wall's change, 0 to 1: samples lie near, also where
        the wall between them is steep. Kinds, lobes and the correlation of errors read it.
    nearest
        Largest distance from a vertex to the nearest sample used; NaN if no vertex has such a sample or the wall does
        not hold the distances.
    diameter_sigma
        Standard uncertainty of `equivalent_diameter`, from that of the radii. Errors of a wall are alike over 30
        degrees and 0.22 m, or the part of both that holds as many samples as a vertex has neighbours, and independent
        beyond, so they mostly cancel in a mean; between samples that are farther apart they are alike as well, and
        along the hole they do not cancel where less than 0.9 of a turn is measured. The errors of ``caliper_accuracy``
        and ``shared_sigma`` never cancel. NaN without ``sigma=True``, and where more than a tenth of the vertices of a
        turn is not sampled.
    alike
        Share of 30 degrees and 0.22 m over which the errors of the wall are alike.
    shared_sigma
        Standard uncertainty that the radii of a turn share, metres: by that of the velocity in the mud (`Echo`), and,
        with near and far neighbours and ``sigma=True``, by the biases of the tool's arms.
    age
        Seconds (or ticks of the caliper's clock) from the newest sample at this depth to the newest sample of the wall;
        NaN if there is no sample at this depth, or samples have no times.
    bit_diameter, sectors
        Bit size, metres; number of vertices per turn.
    pitch
        Metres along the hole per turn; below 0 if the turns go up the hole.
    step
        Height of a row, metres; None: each row is one turn.
    rugosity_window
        Length of hole that `rugosity` is measured over, metres.
    basis, basis_text
        What the wall is made from, as in `Caliper`: as a short name, and in words.
    shape
        Source of `c1`, `c1_toolface`, `c2`, `least_diameter`, ovality, `out_of_roundness` and zones: ``"wall"``, or
        ``"arms"`` for a tool with few arms, which measures less than 0.9 of the turns; but by near and far neighbours
        it is the wall's, if the arms passed every 30 degrees within the length over which radii are alike.
    reference
        What toolface 0 is, by the path or the first image of the wall: ``"high-side"``, ``"north"`` or
        ``"parallel-transport"``; "": the wall has neither path nor image.
    reference_assumed
        Whether toolfaces are only assumed to count from ``reference``, because no file states it.
    caliper_accuracy
        Standard uncertainty that all radii share, metres.
    with_sigma
        Whether `table` has the columns DEQ_SIGMA, VOL_SIGMA, C1_SIGMA and so on, also where no turn has a value.
    uncertain
        The following columns by name; they are measured when one of them is first read. None without ``sigma=True``.
    c1_sigma, c2_sigma, c1_c2_sigma, ovality_sigma
        Standard uncertainty of `c1`, `c2`, their difference and `ovality_api`, by draws of the radii (`shape_sigma`);
        that of a step is the mean of its turns', as if their errors were one. NaN where a radius of the turn has no
        uncertainty.
    turns
        Logs of the turns that steps are made from; None: the rows are turns.
    path
        Path of the wall: `table` has TVD, INCL and AZIM along it.
    """

    depth: Floats
    mean: Floats
    smallest: Floats
    largest: Floats
    equivalent_diameter: Floats
    c1: Floats
    c1_toolface: Floats
    c2: Floats
    least_diameter: Floats
    diameter_0: Floats
    diameter_90: Floats
    ovality_api: Floats
    ovality_dnv: Floats
    out_of_roundness: Floats
    wall_out_of_roundness: Floats
    uneven: Floats
    centre_0: Floats
    centre_90: Floats
    inscribed_diameter: Floats
    inscribed_0: Floats
    inscribed_90: Floats
    enclosing_diameter: Floats
    rugosity: Floats
    volume: Floats
    excess: Floats
    coverage: Floats
    sampled: Floats
    nearest: Floats
    diameter_sigma: Floats
    alike: Floats
    shared_sigma: Floats
    age: Floats
    worn: LateColumns = field(repr=False)
    sections: LateColumns = field(repr=False)
    bit_diameter: float
    sectors: int
    pitch: float
    rugosity_window: float
    basis: Basis
    basis_text: str
    step: float | None = None
    reference: str = ""
    reference_assumed: bool = False
    shape: Shape = "wall"
    arm_diameter: tuple[Floats, ...] = ()
    with_sigma: bool = False
    uncertain: LateColumns | None = field(default=None, repr=False)
    caliper_accuracy: float = 0.0
    path: Path | None = None
    turns: Logs | None = None

    c1_sigma = _uncertain("c1_sigma")
    c2_sigma = _uncertain("c2_sigma")
    c1_c2_sigma = _uncertain("c1_c2_sigma")
    ovality_sigma = _uncertain("ovality_sigma")
    unworn_diameter = _worn("unworn_diameter")
    unworn_0 = _worn("unworn_0")
    unworn_90 = _worn("unworn_90")
    lobe1_toolface = _worn("lobe1_toolface")
    lobe1_width = _worn("lobe1_width")
    lobe1_height = _worn("lobe1_height")
    lobe1_pipe = _worn("lobe1_pipe")
    lobe2_toolface = _worn("lobe2_toolface")
    lobe2_width = _worn("lobe2_width")
    lobe2_height = _worn("lobe2_height")
    lobe2_pipe = _worn("lobe2_pipe")

    @cached_property
    def section(self) -> Floats:
        return self.sections["section"]

    def __len__(self) -> int:
        """Return the number of rows."""
        return int(self.depth.size)

    @property
    def volume_sigma(self) -> Floats:
        """Standard uncertainty of `volume`, (rows,) float64, m3, as `diameter_sigma`."""
        uncertain: Floats = 0.5 * np.pi * self.height * self.equivalent_diameter * self.diameter_sigma
        return uncertain

    @cached_property
    def sparse(self) -> Mask:
        """(turns,) bool: whether fewer than half of the `section` has a sample, over 0.3 m of hole or more."""
        few: Mask = _core.sparse_turns(column("section", self.section.ravel()), self.height) == 1
        return few

    def along(self, criteria: Criteria | None = None) -> Along | None:
        """Return what the samples of all turns make likely where turns are `sparse`; None if no turn is.

        Parameters
        ----------
        criteria
            They say of which kind each section of the library is; None: the defaults.
        """
        if self.basis != "azimuthal" or not self.sparse.any():
            return None
        own = criteria is None or criteria == Criteria()
        return self._along if own else self._chained(criteria or Criteria())

    @cached_property
    def _along(self) -> Along:
        return self._chained(Criteria())

    def _chained(self, criteria: Criteria) -> Along:
        even = self.shape == "arms" and not np.any(self.uneven > 0)
        sections = self.section - self.bit_diameter / 2
        return kinds_along(sections, self.height, self.bit_diameter, criteria, even, self.sparse, thread_count(None))

    @cached_property
    def diameter_range(self) -> tuple[Floats, Floats]:
        """Least and greatest likely equivalent diameter, (rows,) float64 each, metres, with a probability of 95 %.

        Where turns have few samples (`sparse`), the sections that fit the samples of many turns give it, since the
        interpolated wall may be far too wide there or too narrow. Elsewhere both are `equivalent_diameter`.
        """
        if self.turns is not None:
            return self._range_of_steps(self.turns)
        found = self.along()
        if found is None:
            return self.equivalent_diameter, self.equivalent_diameter
        size = 2 * np.sqrt(found.square)
        rough = np.hypot(SIZE_ROUGH, SIZE_APART * (size - self.bit_diameter))
        spread = 1.96 * np.hypot(2 * found.square_sigma / size, rough)
        known = self.sparse & np.isfinite(size)  # in a hole unlike all known sections nothing is likely
        low, high = (np.where(known, end, self.equivalent_diameter) for end in (size - spread, size + spread))
        return low, high

    def _range_columns(self) -> list[LogColumn]:
        """Return the ends of `diameter_range` as columns if it is a range in most rows; missing where it is none."""
        low, high = self.diameter_range
        ranged = low < high
        mostly = np.count_nonzero(ranged) >= MOSTLY * len(self)
        ends = (("DEQ_LOW", "Least", low), ("DEQ_HIGH", "Greatest", high)) if mostly else ()
        text = "likely DEQ, with a probability of 95 %, where turns have few samples"
        return [LogColumn(name, "m", f"{end} {text}", np.where(ranged, values, np.nan)) for name, end, values in ends]

    def _range_of_steps(self, turns: Logs) -> tuple[Floats, Floats]:
        """Return `diameter_range` of steps: the errors of a step's turns are alike."""
        order = np.argsort(turns.depth, kind="stable")
        at = turns.depth[order]
        ends = [np.searchsorted(at, self.depth + side * self.height / 2) for side in (-1, 1)]
        found = []
        for of_turns in turns.diameter_range:
            total = np.append(0.0, np.cumsum(of_turns[order] ** 2))
            found.append(np.sqrt((total[ends[1]] - total[ends[0]]) / np.maximum(ends[1] - ends[0], 1)))
        return found[0], found[1]

    @property
    def integrated_volume(self) -> Floats:
        """Sum of `volume` from the deepest row up to each row, included, (rows,) float64, m3 (IHV).

        Rows without a volume count as 0.
        """
        return self._from_bottom(np.nan_to_num(self.volume))

    def _from_bottom(self, values: Floats) -> Floats:
        upwards = np.argsort(self.depth, kind="stable")[::-1]
        summed = np.empty_like(values)
        summed[upwards] = np.cumsum(values[upwards])
        return summed

    def integrated_columns(self) -> list[LogColumn]:
        """Return volume of the hole from the deepest row up, its measured share and upper limit of sigma as columns."""
        rows = self._from_bottom(np.ones(len(self)))
        up = "from the deepest row up to this one"
        share = self._from_bottom(np.nan_to_num(self.coverage)) / rows
        found = [
            LogColumn("IHV", "m3", f"Volume of the hole {up}", self.integrated_volume),
            LogColumn("IHV_COVER", "", f"Share of the hole {up} that is measured", share),
        ]
        if self.with_sigma:
            text = f"Upper limit of the standard uncertainty of IHV, {up}"
            sigma = np.where(np.isfinite(self.volume), self.volume_sigma, 0.0)  # NaN stays: a volume of unknown sigma
            found.append(LogColumn("IHV_SIGMA", "m3", text, self._from_bottom(sigma)))
        return found

    @property
    def height(self) -> float:
        """Height of a row, metres."""
        return abs(self.pitch) if self.step is None else self.step

    def by_step(self, step: float) -> Logs:
        """Return logs with one row per step of depth, from the turns whose middle lies in the step (see `depth_steps`).

        Parameters
        ----------
        step
            Height of a step, metres, at least the pitch. Steps begin at whole multiples of this height.

        Raises
        ------
        InputError
            ``step = 0.01: must be at least the pitch, 0.1 m``; if these logs already have steps.
        """
        if self.step is not None:
            raise InputError(
                "step", f"these logs already have steps of {self.step:g} m; start from the logs with one row per turn"
            )
        columns = by_step(vars(self), self.pitch, self.bit_diameter, step)
        none = sections_of(lambda: np.empty((0, PARTS)))
        return replace(self, step=float(step), sections=none, turns=self, **columns)

    def between(self, top: float | None, bottom: float | None) -> Logs:
        """Return the rows whose depth lies in [top, bottom], metres, without copying them; None: no limit."""
        kept = np.flatnonzero(self.rows_between(top, bottom))
        inside = slice(kept[0], kept[-1] + 1) if kept.size else slice(0)  # rows are in depth order: no copy
        columns: dict[str, Any] = {name: getattr(self, name)[inside] for name in COLUMN_NAMES}
        arms = tuple(of[inside] for of in self.arm_diameter)
        worn, sections = self.worn.between(inside), self.sections.between(inside)
        uncertain = None if self.uncertain is None else self.uncertain.between(inside)
        part = replace(self, arm_diameter=arms, worn=worn, uncertain=uncertain, sections=sections, **columns)
        if self.turns is None:  # turns beside the part decide as well
            vars(part)["diameter_range"] = tuple(end[inside] for end in self.diameter_range)
        return part

    def annulus(self, casing: float) -> Annulus:
        """Return the annulus around a casing: volume, cement, clearance, as `helibore logs` writes them.

        ``logs.annulus(0.2445).cement(top=2000, excess=0.1)`` is the cement below 2,000 m, with an excess of ten
        percent.

        Parameters
        ----------
        casing
            Outer diameter, metres.

        Raises
        ------
        InputError
            ``casing = 0: must be finite and above 0``.
        """
        return annulus(self.depth, self.equivalent_diameter, self.inscribed_diameter, self.height, casing)

    def cement_sheet(self, job: CementJob) -> CementSheet:
        """Return what a casing takes: rat hole, shoe track, open hole with excess, and lap.

        ``wall.logs().cement_sheet(hb.CementJob(casing=0.2445, shoe=1500, top=900, excess=0.1)).total`` is in cubic
        metres. An open hole that was measured in part takes the mean of that part; each section states the share.

        Parameters
        ----------
        job
            The casing, its shoe, the previous casing, the tops of the slurries, the excess.

        Raises
        ------
        InputError
            If the shoe or the open hole lies outside the logs, an interval has no measured row, or the hole has less
            area than the casing.
        """
        sizes = self.equivalent_diameter, self.volume_sigma, self.height, self.bit_diameter
        return cement_sheet(MeasuredHole(self.depth, self.coverage, *sizes), job)

    @property
    def shape_kept(self) -> float:
        """Ratio of the wall's mean out-of-roundness to that of the arms.

        NaN if ``shape`` is ``"wall"``, and if the arms measured a round hole.
        """
        both = np.isfinite(self.wall_out_of_roundness) & np.isfinite(self.out_of_roundness)
        if self.shape == "wall" or not self.out_of_roundness[both].any():
            return math.nan
        return float(self.wall_out_of_roundness[both].mean() / self.out_of_roundness[both].mean())

    @property
    def unmeasured_shape(self) -> bool:
        """Whether files must say that the wall is interpolated.

        True if the tool has few arms, or if the mean coverage of an azimuthal caliper is below `COVERED`.
        """
        sparse = self.basis == "azimuthal" and len(self) > 0 and float(self.coverage.mean()) < COVERED
        return self.shape == "arms" or sparse

    @property
    def _has_sigma(self) -> bool:
        return bool(np.isfinite(self.diameter_sigma).mean() >= COVERED)

    def warnings(self) -> list[str]:
        """Return a sentence for each restriction that a reader of the numbers must know."""
        return self._warnings_of_shape() + self._warnings_of_path()

    def _warnings_of_path(self) -> list[str]:
        if self.path is None or true_depth(self.path, None) is not None:
            return []
        return [f"TVD is missing: the true depth of the survey's first station, at {self.path.start_depth:g} m, is not "
                "known; state it in the path's head (north, east and true depth of that station)"]  # fmt: skip

    def _warnings_of_shape(self) -> list[str]:
        if not len(self):
            return []
        size = self.equivalent_diameter[np.isfinite(self.equivalent_diameter)]
        median = float(np.median(size)) if size.size else self.bit_diameter
        small = 1.0 - median / self.bit_diameter
        found = []
        if median > LARGE * self.bit_diameter:
            times = f"half of the turns are at least {median / self.bit_diameter:.1f} times as large as the bit"
            found.append(f"{times}: are bit size and units right?")
        if small > SMALL:
            found.append(f"half of the turns are at least {100 * small:.0f} % smaller than the bit: are bit size and "
                         "units right?")  # fmt: skip
        seen = float(self.coverage.mean())
        if self.shape == "wall":
            if self.unmeasured_shape and not found:
                found.append(f"{100 * seen:.0f} % of the turns is measured; the wall between is interpolated")
                found += [] if self._has_sigma else [NO_UNCERTAINTY]
            return found
        few = f"a tool with few arms measured {100 * seen:.0f} % of the turns"
        found.append(f"{few}; the wall between its arms is interpolated, and C1, C2, ovality and zones are the arms'")
        found.append(NO_UNCERTAINTY)
        if self.shape_kept < SHAPE_KEPT:
            share = f"{self.shape_kept:.2f} of the out-of-roundness that the arms measured"
            found.append(f"the wall has {share}: its sections are rounder than the hole")
        return found

    def rows_between(self, top: float | None, bottom: float | None) -> Mask:
        """Return which rows lie from ``top`` to ``bottom``, metres, as `between` keeps them, (rows,) bool."""
        least, most = (-math.inf if top is None else top), (math.inf if bottom is None else bottom)
        inside: Mask = (self.depth >= least) & (self.depth <= most)
        return inside

    def facts(self) -> dict[str, str]:
        """Return the settings and sources of the logs as texts; every file states them."""
        return {
            "basis": self.basis_text,
            "bit diameter": f"{self.bit_diameter:.6g} m",
            "sectors": str(self.sectors),
            "pitch": f"{self.pitch:.6g} m",
            "toolface 0": TOOLFACE_0[self.reference] + ", assumed" * self.reference_assumed,
            "row": "one full turn" if self.step is None else f"{self.step:.6g} m of depth",
            "rugosity window": f"{self.rugosity_window:.6g} m",
            **self._facts_of_shape(),
            "ovality": "OVAL_API = (max - min)/(max + min); OVAL_DNV = twice that",
            "missing": "a value is missing if a radius of its turn or step is missing",
        }

    def _facts_of_shape(self) -> dict[str, str]:
        found = {"shape": SHAPE_TEXT[self.shape]}
        if self.shape == "arms":
            found["arms"] = f"ARM_DIAMETER, C1, C2 and DMIN: {ARM_MEAN}; single readings are larger and smaller"
        if self.unmeasured_shape and not self._has_sigma:
            found["uncertainty"] = NO_UNCERTAINTY
        return found

    def table(
        self,
        more: Iterable[LogColumn] = (),
        facts: Mapping[str, str] | None = None,
        images: Sequence[LogImage] = (),
    ) -> LogTable:
        """Return the logs with mnemonics, units and descriptions, followed by ``more`` columns; ``facts`` are added.

        ``images`` have one row for each row of the logs; files hold them.
        """
        if not len(self):
            rule = "the wall has no full turn" if self.step is None else f"the wall has no full step of {self.step:g} m"
            raise InputError("logs", rule)
        more = list(more)
        for number, one in enumerate(more):
            if not isinstance(one, LogColumn):
                rule = "must be a hb.LogColumn(mnemonic, unit, description, values)"
                raise InputError(f"more[{number}]", rule, type(one).__name__)
        skipped = [] if self.arm_diameter else ["wall_out_of_roundness", "uneven"]
        skipped += [] if self.with_sigma else ["diameter_sigma"]
        own = [
            LogColumn(of.mnemonic, of.unit, of.description, getattr(self, of.name))
            for of in COLUMNS
            if of.name not in skipped
        ]
        if self.with_sigma:
            own.append(LogColumn("VOL_SIGMA", "m3", "Standard uncertainty of VOL", self.volume_sigma))
            own += [
                LogColumn(of.mnemonic, of.unit, of.description, getattr(self, of.name)) for of in SHAPE_SIGMA.values()
            ]
        own += self._range_columns()
        own += [
            LogColumn(f"ARM_DIAMETER_{number}", "m", f"Diameter that arm {number} measured, {ARM_MEAN}", values)
            for number, values in enumerate(self.arm_diameter, 1)
        ]
        own += _along(self.path, self.depth) if self.path is not None else []
        return LogTable([*own, *more], {**self.facts(), **(facts or {})}, images)

    def save(
        self,
        filename: str | os.PathLike[str],
        more: Iterable[LogColumn] = (),
        facts: Mapping[str, str] | None = None,
    ) -> None:
        """Write `table` with ``more`` and ``facts`` to ``filename``: .las, .csv, .parquet or .dlis."""
        self.table(more, facts).save(filename)

    def _repr_html_(self) -> str:
        picture = curve_picture(self.equivalent_diameter, self.depth, "equivalent diameter by depth")
        return card(repr(self), self.facts(), picture)

    def __repr__(self) -> str:
        if not len(self):
            return "Logs(empty)"
        row = "turns" if self.step is None else f"steps of {self.step:g} m"
        return f"Logs({len(self)} {row}, {self.depth[0]:g} to {self.depth[-1]:g} m, {self.basis_text})"


TOOLFACE_0 = {
    "high-side": "high side of the hole",
    "north": "north",
    "parallel-transport": "north at the top of the path, carried down it without twist",
    "": "that of the samples; neither a path nor an image of the wall says what it is",
}
"""What toolfaces count from, by reference, as files state it."""

COLUMN_NAMES = tuple(field.name for field in fields(Logs) if field.type == "Floats")


def turn_logs(
    wall: WallLike,
    bit_diameter: float | None = None,
    rugosity_window: float = RUGOSITY_WINDOW,
    threads: int | None = None,
    sigma: npt.ArrayLike | None = None,
    reference: float = math.nan,
    newest: float | None = None,
    caliper_accuracy: float = 0.0,
    arm_sigma: float = 0.0,
) -> Logs:
    """Return the logs of every full turn of a wall, as `Wall.logs` does.

    Parameters
    ----------
    wall
        Radii on a helix; it is not changed.
    bit_diameter
        Bit size for `Logs.excess`, metres; None: the wall's own.
    rugosity_window
        Metres; rounded to an odd number of turns, at least 3: 1 m at a pitch of 0.1 m is 9 turns.
        `Logs.rugosity_window` is then the length used, 0.9 m.
    threads
        None: all cores. The result does not depend on it.
    sigma
        (n,) standard uncertainty of each radius, metres: `Wall.sigma`; None: not known.
    reference
        Radius that `Logs.rugosity` subtracts from all radii, metres; NaN: the first radius. The rows of a
        part of a wall equal those of the whole wall exactly, except within half a window of the ends of the part, if
        the part starts a multiple of 256 turns after the whole wall and has the ``reference`` of the whole wall.
    newest
        Time of the newest sample of the whole wall, if ``wall`` is a part of it; None: the newest time in ``wall``.
    caliper_accuracy
        Standard uncertainty that all radii share, metres: that of the tool's calibration, and for an ultrasonic caliper
        that of the sound velocity in the mud. `Logs.diameter_sigma` counts it in full.
    arm_sigma
        The same by the biases of the tool's arms, if the samples show them.

    Raises
    ------
    InputError
        ``bit_diameter = 0: must be finite and above 0``; ``rugosity_window`` has the same rule;
        ``caliper_accuracy = -1: must be finite and not negative``.
    """
    bit = float(getattr(wall.settings, "bit_diameter", math.nan) if bit_diameter is None else bit_diameter)
    for name, value in (("bit_diameter", bit), ("rugosity_window", rugosity_window)):
        if not (math.isfinite(value) and value > 0):
            raise InputError(name, "must be finite and above 0", str(value))
    check_not_negative({"caliper_accuracy": caliper_accuracy})
    K, pitch = wall.settings.sectors, wall.settings.pitch
    window = window_turns(rugosity_window, pitch)
    radius = column("radius", wall.radius)
    helix, around = whole_helix(wall), (K, wall.settings.start_toolface)
    first = helix.first // K
    threads = getattr(wall, "threads", None) if threads is None else threads
    found: dict[str, Any] = _core.turn_columns(radius, *around, window, thread_count(threads), first, reference)
    square, turns = found.pop("mean_square"), radius.size // K
    depth = helix.turn_depths(turns)
    path: Path | None = getattr(wall, "path", None)
    with_radius = found["coverage"]
    found["coverage"] = _share(wall, "measured", with_radius)
    found["sampled"] = _share(wall, "sampled", with_radius) if hasattr(wall, "sampled") else found["coverage"].copy()
    found["wall_out_of_roundness"] = found["c1"] - found["least_diameter"]
    found |= {"uneven": np.full(turns, np.nan), "shape": "wall", "arm_diameter": ()}
    few = turns and getattr(wall, "arms", None) is not None and found["sampled"].mean() < SEES_ALL_AROUND
    if few and not getattr(wall, "has_shape", False):
        found |= _from_arms(wall, depth, found)
    counts = _counts(wall)
    worn = LateColumns(WORN, lambda: _core.unworn_columns(radius, *around, bit, counts, thread_count(threads)))
    alike = _alike(wall, depth)
    shared = np.hypot(_echo_sigma(wall, depth, np.sqrt(square)), arm_sigma)
    most, least = found["c1"], found["least_diameter"]
    ovality = (most - least) / (most + least)
    around_alike = alike if sigma is None else _alike_around(wall, alike)
    uncertain = None
    if sigma is not None:
        measured = columns_of_samples(wall)
        if measured:
            rounded = rounding_sigma(radius[: turns * K].reshape(turns, K), measured[2], wall.settings)
            shared = np.hypot(shared, rounded)
        radii, sigmas = (of[: turns * K].reshape(turns, K) for of in (radius, column("sigma", sigma)))
        stated = {"c1": most, "c2": found["c2"], "ovality_api": ovality}
        accuracy = np.hypot(caliper_accuracy, shared)
        measure = partial(shape_sigma, radii, sigmas, around_alike, stated, accuracy)
        uncertain = LateColumns(tuple(SHAPE_SIGMA), measure)
    return Logs(
        depth=depth,
        equivalent_diameter=2 * np.sqrt(square),
        ovality_api=ovality,
        ovality_dnv=2 * ovality,
        out_of_roundness=most - least,
        volume=np.pi * square * abs(pitch),
        excess=square / (bit / 2) ** 2 - 1,
        nearest=_nearest(wall, turns),
        diameter_sigma=_diameter_sigma(wall, sigma, around_alike, np.hypot(caliper_accuracy, shared)),
        alike=alike,
        shared_sigma=shared,
        caliper_accuracy=caliper_accuracy,
        age=_ages(getattr(wall, "samples", None), depth, abs(pitch), newest),
        worn=worn,
        bit_diameter=bit,
        sectors=K,
        pitch=pitch,
        rugosity_window=window * abs(pitch),
        basis=basis_of(wall),
        basis_text=basis_text_of(wall),
        reference=reference_of(wall) or "",
        reference_assumed=reference_assumed(wall),
        with_sigma=sigma is not None,
        uncertain=uncertain,
        sections=_sections(wall, turns),
        path=path,
        **found,
    )


ALONG = ("TVD", "INCL", "AZIM")
"""Mnemonics of the columns that the path gives."""


def _along(path: Path, depth: Floats) -> list[LogColumn]:
    """Return columns of the path at depths; NaN beyond its ends, and where true depth or azimuth are not known."""
    inside = (depth >= path.start_depth) & (depth <= path.stop_depth)
    down, east, north = (np.full(depth.size, np.nan) for _ in range(3))
    north[inside], east[inside], down[inside] = path.tangent(depth[inside]).T
    level, known = np.hypot(north, east), true_depth(path, None)
    azimuth = np.where(level > VERTICAL, np.degrees(np.arctan2(east, north)) % 360, np.nan)
    tvd = np.full(depth.size, np.nan) if known is None else known.at(depth)
    return [
        LogColumn(ALONG[0], "m", "True vertical depth; missing unless the survey or its head says what it is", tvd),
        LogColumn(ALONG[1], "deg", "Inclination of the hole", np.degrees(np.arctan2(level, down))),
        LogColumn(ALONG[2], "deg", "Azimuth of the hole, from north; missing where the hole is vertical", azimuth),
    ]


def window_turns(length: float, pitch: float) -> int:
    """Return the number of turns in a window of this length, metres: odd, at least 3."""
    return max(3, 2 * round((length / abs(pitch) - 1) / 2) + 1)


def _share(wall: WallLike, mask: str, with_radius: Floats) -> Floats:
    """Return the share of each turn that a mask of the wall has, or, if the wall has no mask, a radius.

    It is NaN for a wall that is round by assumption, because nothing measured its turns around the hole.
    """
    if getattr(wall, "basis", "azimuthal") != "azimuthal":
        return np.full(with_radius.shape, np.nan)
    vertices: Mask | None = getattr(wall, mask, None)
    if vertices is None or not with_radius.size:
        return with_radius
    K = wall.settings.sectors
    share: Floats = vertices[: with_radius.size * K].reshape(-1, K).mean(axis=1)
    return share


def _counts(wall: WallLike) -> Floats:
    """Return 1 for each vertex with samples near, 0 for the others; without entries if the wall does not state it."""
    sampled: Mask | None = getattr(wall, "sampled", getattr(wall, "measured", None))
    if sampled is None or getattr(wall, "basis", "azimuthal") != "azimuthal":
        return np.empty(0)
    return sampled.astype(np.float64)


def _from_arms(wall: Any, depth: Floats, of_wall: dict[str, Any]) -> dict[str, Any]:
    """Return the columns that come from a tool's few arms, and circles limited by them; {} if there are no diameters.

    ``of_wall`` are the columns of the wall.
    """
    reach = wall.settings.max_distance
    sizes: dict[str, Any] | None = _core.arm_diameters(
        columns_of_arms(wall.arms), depth, abs(wall.settings.pitch), math.inf if reach is None else reach
    )
    if sizes is None:
        return {}
    diameters = sizes.pop("diameter").reshape(-1, depth.size)
    inside = np.fmin(of_wall["inscribed_diameter"], sizes["least_diameter"])
    around = np.fmax(of_wall["enclosing_diameter"], sizes["c1"])
    circles = {"inscribed_diameter": inside, "enclosing_diameter": around}
    return {**sizes, **circles, "shape": "arms", "arm_diameter": tuple(diameters)}


def _alike(wall: WallLike, depth: Floats) -> Floats:
    """Return the share of `ALIKE_AROUND` and `ALIKE_ALONG` over which the errors of each turn are alike.

    Vertices that share their neighbours share their errors: dense samples make that part smaller.
    """
    columns = columns_of_samples(wall)
    if not columns:
        return np.ones(depth.size)
    settings = wall.settings
    height = abs(settings.pitch)
    before = settings.pitch * (settings.sectors - 1) / (2 * settings.sectors)  # from the first vertex to the middle
    edges = np.array([depth - before, depth - before + settings.pitch])
    samples = np.diff(np.searchsorted(column("depth", columns[0]), np.sort(edges, axis=0)), axis=0)[0]
    patch = np.maximum(samples * (ALIKE_AROUND / 360 * ALIKE_ALONG / height), settings.neighbors)
    share: Floats = np.sqrt(settings.neighbors / patch)
    return share


def _alike_around(wall: WallLike, share: Floats) -> Floats:
    """Return the degrees around each turn over which errors are alike; ``share`` is that of `_alike`.

    Between the samples of a turn that are farther apart, the errors are alike as well.
    """
    turns, K = share.size, wall.settings.sectors
    gap: Floats | None = getattr(wall, "angular_gap", None)
    alike = np.maximum(ALIKE_AROUND * share, 360 / K)
    return alike if gap is None else np.maximum(alike, gap[: turns * K].reshape(turns, K).mean(axis=1))


def _diameter_sigma(wall: WallLike, sigma: npt.ArrayLike | None, alike: Floats, accuracy: Floats) -> Floats:
    """Return the standard uncertainty of twice the mean radius of each turn, from that of each radius.

    ``alike`` is that of `_alike_around`, ``accuracy`` what all radii of a turn share.
    """
    turns = alike.size
    found = np.full(turns, np.nan)
    if sigma is None:
        return found
    K = wall.settings.sectors
    of_turns = column("sigma", sigma)[: turns * K].reshape(turns, K)
    sampled = np.isfinite(of_turns).mean(axis=1) >= LEAST_SAMPLED
    square = np.nanmean(of_turns[sampled] ** 2, axis=1)
    found[sampled] = 2 * np.sqrt(square * alike[sampled] / 360 + accuracy[sampled] ** 2)
    return found


def _echo_sigma(wall: WallLike, depth: Floats, radius: Floats) -> Floats:
    """Return the uncertainty of the mean radius of each turn by that of the velocity in the mud, metres."""
    kept: dict[str, Any] | None = getattr(wall, "made_from", {}).get("echo")
    if kept is None:
        return np.zeros(depth.size)
    share = np.interp(depth, kept["depth"], kept["share"])
    found: Floats = share * np.maximum(np.nan_to_num(radius) - kept["tool_radius"], 0.0)
    return found


def sections_of(measure: Callable[[], Floats]) -> LateColumns:
    """Return `Logs.sections`; ``measure`` returns `Logs.section`, and what it reads must not change."""
    return LateColumns(("section",), lambda: {"section": measure()})


def columns_of_arms(arms: Caliper) -> tuple[Floats, Floats, Floats, Integers, Floats]:
    """Return depth, toolface, radius, arm and time of samples whose arms are known; without times the last is empty."""
    assert arms.arm is not None
    time = np.empty(0) if arms.time is None else column("time", arms.time)
    return column("depth", arms.depth), column("toolface", arms.toolface), column("radius", arms.radius), arms.arm, time


def _sections(wall: WallLike, turns: int) -> LateColumns:
    """Return `Logs.sections`; the columns of ``wall`` are taken now, so that a later append does not change them."""
    helix, K = whole_helix(wall), wall.settings.sectors
    columns = columns_of_kept_samples(wall)
    if not columns:
        radius = column("radius", wall.radius)[: turns * K]
        measure = partial(_core.vertex_sections, helix, radius)
    else:
        measure = partial(_core.turn_sections, helix, turns * K, *columns)
    return sections_of(lambda: measure().reshape(turns, PARTS))


def _nearest(wall: WallLike, turns: int) -> Floats:
    nearest: Floats | None = getattr(wall, "nearest", None)
    if nearest is None:
        return np.full(turns, np.nan)
    K = wall.settings.sectors
    most: Floats = np.fmax.reduce(nearest[: turns * K].reshape(turns, K), axis=1)
    return most


def _ages(samples: Caliper | None, depth: Floats, height: float, last: float | None) -> Floats:
    """Return the seconds from the newest sample within half a ``height`` of each depth to ``last``; NaN if unknown.

    ``last`` is the time of the newest sample of the whole wall; None: that of ``samples``.
    """
    ages = np.full(depth.size, np.nan)
    if samples is None or samples.time is None or not depth.size:
        return ages
    middles = np.sort(depth)  # samples are sorted by depth
    bounds = np.searchsorted(samples.depth, np.append(middles - height / 2, middles[-1] + height / 2))
    some = bounds[1:] > bounds[:-1]
    starts = bounds[:-1][some]
    if starts.size:
        newest = np.maximum.reduceat(samples.time[: bounds[-1]], starts)
        ages[some] = (samples.time.max() if last is None else last) - newest
    return ages if depth[0] <= depth[-1] else ages[::-1].copy()
