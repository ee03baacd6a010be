"""The summary of a wall: prints, report and viewer take all their numbers for a whole interval from here.

    summary = wall.summary()                    summary.volume, summary.excess, summary.washed_out
    wall.summary(start=2000, stop=2100)         of an interval

Diameters, volume and excess come from whole turns, in which every vertex has a radius, measured or interpolated. The
mean diameter is that of the cylinder with the same volume. The length of a kind of hole is that of the turns in its
zones that meet the criterion (``zones``). If an end of the interval cuts a turn, only the part inside counts for
length, volume and coverage.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from helibore.base.arrays import Floats
from helibore.base.axial import Axes
from helibore.base.errors import InputError
from helibore.base.notebook import card
from helibore.base.percentiles import percentiles
from helibore.base.ranges import pieces
from helibore.base.units import INCH, MILLIMETRE, size_text
from helibore.logs.turn_logs import Logs, Shape
from helibore.logs.zone_criteria import Criteria
from helibore.logs.zones import KINDS, Classification, classify
from helibore.samples.caliper import Basis
from helibore.samples.helix import Helix, WallLike, helix_of


class Extreme(NamedTuple):
    """The least or greatest value of a log and its depth, both metres; both are NaN if no turn has a value."""

    value: float
    depth: float

    def text(self) -> str:
        """Return value and depth as text."""
        return f"{size_text(self.value)} at {self.depth:.2f} m"


@dataclass(frozen=True, kw_only=True)
class WallSummary:
    """The measures of an interval of a wall; made by `Wall.summary`. Lengths are metres, missing numbers NaN.

    Attributes
    ----------
    start, stop
        Ends of the interval, measured depth.
    basis, basis_text, bit_diameter, sectors, pitch
        The attributes of the wall with these names.
    vertices, samples
        Numbers of vertices and samples in the interval. If the depths of the samples are not known, ``samples`` is the
        number of all samples of the wall.
        Samples beyond the last vertex count if they lie within the distance to the next vertex.
    mean_diameter
        Diameter of the cylinder with the same volume.
    mean_diameter_range
        The least and the greatest value that it likely has, by `Logs.diameter_range`. Both equal ``mean_diameter`` if
        no turn of the wall has few samples.
    least_diameter, greatest_diameter
        Diameters through the axis of the hole; each is an `Extreme` with its depth. Those of a tool with few arms are
        the extremes of turns, not of single readings: `Logs.arm_diameter`.
    inscribed_diameter
        Diameter of the largest circle that passes through the interval, the smallest of the turns' inscribed circles;
        an `Extreme` with its depth.
    volume, excess
        Volume of the whole turns, cubic metres; and the ratio of this volume to that at bit size, less 1.
    whole_turns, incomplete_turns
        Metres of hole in turns whose vertices all have a radius, measured or interpolated; and in the other turns.
    ovality, rugosity
        Mean and greatest value of the turns: ovality by API, rugosity in metres over ``rugosity_window``.
    washed_out
        Metres of washout by `classify`; NaN where it classifies less than half of the whole turns: for a gauge hole,
        which no tool measured, and where samples see less than half of most turns.
    kinds
        Metres of hole by kind, for the kinds that occur, without gauge hole. They are metres of the turns in zones that
        meet the criterion: gaps that a zone joins count for its length only.
    breakout_axis, breakout_azimuth
        Mean axis of the whole wall's breakouts, weighted by length: as a toolface, and from north by the path.
    shape, arms
        Source of ovality, least and greatest diameter and kinds (`Logs.shape`); number of diameters that arms measured.
    coverage
        Mean share of the turns that is measured, not interpolated, 0 to 1. NaN if the wall is round by assumption.
    shape_kept
        Ratio of the wall's out-of-roundness to that of the arms; NaN for tools that measure all around.
    warnings
        One sentence for each restriction that a reader of these numbers must know.
    without_radius
        Share of the vertices that no sample reaches, 0 to 1.
    nearest_half, nearest_most
        The 50 % and the 99 % quantile of the vertices' distance to the nearest sample.
    """

    start: float
    stop: float
    basis: Basis
    basis_text: str
    bit_diameter: float
    sectors: int
    pitch: float
    vertices: int
    samples: int
    mean_diameter: float
    mean_diameter_range: tuple[float, float]
    least_diameter: Extreme
    greatest_diameter: Extreme
    inscribed_diameter: Extreme
    volume: float
    excess: float
    whole_turns: float
    incomplete_turns: float
    ovality: tuple[float, float]
    rugosity: tuple[float, float]
    rugosity_window: float
    washed_out: float
    kinds: Mapping[str, float]
    breakout_axis: Axes
    breakout_azimuth: Axes
    shape: Shape
    arms: int
    coverage: float
    shape_kept: float
    warnings: tuple[str, ...]
    without_radius: float
    nearest_half: float
    nearest_most: float

    @property
    def ranged(self) -> bool:
        """Whether amounts are ranges, because the wall is interpolated where turns have few samples."""
        return self.mean_diameter_range[1] > self.mean_diameter_range[0]

    @property
    def volume_range(self) -> tuple[float, float]:
        """The least and the greatest likely `volume`, cubic metres."""
        low, high = (self.volume * (size / self.mean_diameter) ** 2 for size in self.mean_diameter_range)
        return low, high

    @property
    def excess_range(self) -> tuple[float, float]:
        """The least and the greatest likely `excess`."""
        low, high = ((size / self.bit_diameter) ** 2 - 1 for size in self.mean_diameter_range)
        return low, high

    def excess_text(self) -> str:
        """Return the excess in percent as text: a range where amounts are ranges."""
        if not self.ranged:
            return f"{100 * self.excess:+.1f} %"
        return f"{_span(f'{round(100 * end):+d}' for end in self.excess_range)} %"

    def volume_text(self) -> str:
        """Return the volume in cubic metres as text: a range where amounts are ranges."""
        return f"{self.volume_span()} m³" if self.ranged else f"{self.volume:,.3f} m³"

    def volume_span(self) -> str:
        """Return the ends of `volume_range` as text, with so many decimals that they differ."""
        low, high = self.volume_range
        decimals = max(2, -math.floor(math.log10(high - low))) if high > low else 2
        return _span(f"{end:,.{decimals}f}" for end in (low, high))

    def mean_text(self, unit: str = "") -> str:
        """Return the mean diameter as text, a range where amounts are ranges; ``unit`` is in, mm, or "" for both."""
        sizes = self.mean_diameter_range if self.ranged else (self.mean_diameter,)
        inches, millimetres = (
            f"{_span(f'{size / length:.{digits}f}' for size in sizes)} {name}"
            for name, length, digits in (("in", INCH, 3 - self.ranged), ("mm", MILLIMETRE, 1 - self.ranged))
        )
        return {"in": inches, "mm": millimetres}.get(unit, f"{inches} ({millimetres})")

    def numbers(self) -> dict[str, str]:
        """Return the numbers for a notebook card, as texts by name; missing numbers are left out."""
        volume = f"{self.volume_text()} over {self.whole_turns:.1f} m of whole turns"
        numbers = {
            "depth": f"{self.start:.2f} to {self.stop:.2f} m",
            "basis": self.basis_text,
            "bit": size_text(self.bit_diameter),
            "mean diameter": self.mean_text(),
            "least diameter": self.least_diameter.text(),
            "greatest diameter": self.greatest_diameter.text(),
            "volume": f"{volume}, {self.excess_text()} against the bit",
            "washed out": f"{self.washed_out:.1f} m",
            "measured": f"{100 * self.coverage:.0f} % of the turns",
            "vertices, samples": f"{self.vertices}, {self.samples}",
            **{f"warning {number}": text for number, text in enumerate(self.warnings, 1)},
        }
        return {name: text for name, text in numbers.items() if "nan" not in text}

    def _repr_html_(self) -> str:
        return card("Wall summary", self.numbers(), "")


def _span(ends: Iterable[str]) -> str:
    """Return both ends of a range as one text, or the one that they are where they are written alike."""
    return " to ".join(dict.fromkeys(ends))


def summarize(
    wall: WallLike,
    start: float | None = None,
    stop: float | None = None,
    criteria: Criteria | None = None,
    zones: Classification | None = None,
) -> WallSummary:
    """Return the summary of an interval of a wall, as `Wall.summary` does.

    Parameters
    ----------
    wall
        Radii on a helix.
    start, stop
        Measured depths, metres; None: the ends of the wall. Volume, mean diameter, lengths and coverage are those of
        the hole in [start, stop]; the other numbers are those of the turns whose middle lies in it.
    criteria
        Criteria of the kinds of hole; None: the defaults.
    zones
        Result of `classify` for this wall with these criteria; None: it is computed here.

    Raises
    ------
    InputError
        ``stop = 1500 m: must not be above start = 1510 m``; ``stop = inf: must be finite``.
    """
    for name, end in (("start", start), ("stop", stop)):
        if end is not None and not math.isfinite(end):
            raise InputError(name, "must be finite", f"{end:g}")
    zones = classify(wall, criteria) if zones is None else zones
    turns = zones.logs
    radius, helix = wall.radius, helix_of(wall)
    ends = helix.ends(radius.size) if radius.size else (math.nan, math.nan)
    start, stop = ends[0] if start is None else float(start), ends[1] if stop is None else float(stop)
    if stop < start:
        raise InputError("stop", f"must not be above start = {start:g} m", f"{stop:g} m")
    inside = helix.between(start, stop, radius.size)
    vertices = inside.stop - inside.start
    without = sum(int(np.isnan(radius[piece]).sum()) for piece in pieces(inside))
    logs, height = turns.between(start, stop), turns.height
    share = _share_inside(turns, -math.inf if start <= ends[0] else start, math.inf if stop >= ends[1] else stop)
    full = np.isfinite(turns.equivalent_diameter)
    counted = float(share[full].sum())
    mean_square = float((share * turns.equivalent_diameter**2)[full].sum()) / counted if counted else math.nan
    ends_of_mean = [
        math.sqrt(float((share * end**2)[full].sum()) / counted) if counted else math.nan
        for end in turns.diameter_range
    ]
    metres = {kind: float(share[zones.kind == code].sum()) * height for code, kind in enumerate(KINDS) if code}
    classified = float(share[zones.kind >= 0].sum())
    nearest: Floats | None = getattr(wall, "nearest", None)

    def distances() -> Iterator[Floats]:
        for part in () if nearest is None else map(nearest.__getitem__, pieces(inside)):
            yield part[np.isfinite(part)]

    half, most = percentiles(distances, (50, 99))
    return WallSummary(
        start=start,
        stop=stop,
        basis=turns.basis,
        basis_text=turns.basis_text,
        bit_diameter=turns.bit_diameter,
        sectors=helix.sectors,
        pitch=helix.pitch,
        vertices=vertices,
        samples=_sample_count(wall, *_sample_interval(helix, ends, start, stop)),
        mean_diameter=math.sqrt(mean_square),
        mean_diameter_range=(ends_of_mean[0], ends_of_mean[1]),
        least_diameter=_extreme(logs, logs.least_diameter, np.nanargmin),
        greatest_diameter=_extreme(logs, logs.c1, np.nanargmax),
        inscribed_diameter=_extreme(logs, logs.inscribed_diameter, np.nanargmin),
        volume=float((share * turns.volume)[full].sum()),
        excess=mean_square / turns.bit_diameter**2 - 1,
        whole_turns=counted * height,
        incomplete_turns=float(share[~full].sum()) * height,
        ovality=_mean_and_greatest(logs.ovality_api),
        rugosity=_mean_and_greatest(logs.rugosity),
        rugosity_window=turns.rugosity_window,
        washed_out=metres["washout"] if turns.basis != "gauge" and 2 * classified >= counted else math.nan,
        kinds={kind: length for kind, length in metres.items() if length},
        breakout_axis=zones.breakout_axis(),
        breakout_azimuth=zones.breakout_azimuth(),
        shape=turns.shape,
        arms=len(turns.arm_diameter),
        coverage=float((share * turns.coverage).sum() / share.sum()) if share.any() else math.nan,
        shape_kept=logs.shape_kept,
        warnings=tuple(logs.warnings()) if len(logs) else () if len(turns) else (_no_turns(ends, height),),
        without_radius=without / vertices if vertices else math.nan,
        nearest_half=half,
        nearest_most=most,
    )


def _no_turns(ends: tuple[float, float], height: float) -> str:
    length = 0.0 if math.isnan(ends[0]) else ends[1] - ends[0]
    return f"the wall has no full turn: it is {length:g} m long, and a turn is {height:g} m"


def _sample_count(wall: WallLike, start: float, stop: float) -> int:
    columns: tuple[Floats, ...] | None = getattr(wall, "sample_columns", None)
    if columns is None:
        return int(getattr(wall, "sample_count", 0))
    return int(np.count_nonzero((columns[0] >= start) & (columns[0] <= stop))) if columns else 0


def _sample_interval(helix: Helix, ends: tuple[float, float], start: float, stop: float) -> tuple[float, float]:
    """Return the depths between which samples count: ``start`` and ``stop``.

    If one of them is at or beyond an end of the wall, it is moved outwards by the distance of two vertices in depth.
    """
    height = abs(helix.pitch) / helix.sectors
    return start - height * (start <= ends[0]), stop + height * (stop >= ends[1])


def _share_inside(turns: Logs, start: float, stop: float) -> Floats:
    """Return the share of each turn that lies in [start, stop], (rows,); a turn ends where the next turn begins."""
    first = turns.depth - turns.pitch * (turns.sectors - 1) / (2 * turns.sectors)
    top, bottom = np.minimum(first, first + turns.pitch), np.maximum(first, first + turns.pitch)
    inside = np.minimum(bottom, stop) - np.maximum(top, start)
    shares: Floats = np.clip(np.round(inside / turns.height, 9), 0.0, 1.0)  # rounded: a cut between turns cuts none
    return shares


def _extreme(logs: Logs, values: Floats, where: Any) -> Extreme:
    if not np.isfinite(values).any():
        return Extreme(math.nan, math.nan)
    row = int(where(values))
    return Extreme(float(values[row]), float(logs.depth[row]))


def _mean_and_greatest(values: Floats) -> tuple[float, float]:
    there = values[np.isfinite(values)]
    return (float(there.mean()), float(there.max())) if there.size else (math.nan, math.nan)
