"""Classify each turn and join turns of one kind into zones: gauge, washout, breakout, key seat, undergauge.

`helibore.logs.zone_criteria` defines the kinds; every output states the criteria. The core finds the zones
(``zones.hpp``): a run of turns of one kind becomes a zone if it is long enough. A turn is of no kind if it lacks a
radius or if less than half of it has samples near; but few arms that turn slowly show hazards together, and the kinds
of the diameters that they measured, however few.

Then the sections of a few of its turns, as the samples show them, are compared with a library of sections
(``kinds.hpp``). The zone states the probability of its kind as ``confidence``: from `SURE` on outputs draw it
filled, else hollow. A run of turns whose kind is less likely than `LIKELY` and that may be gauge is no zone. A run that
is certainly not gauge but resembles no section of the library, or several kinds alike, has the confidence `LIKELY`: the
criteria alone say its kind.

A zone states the extremes of its turns, so that ENLARGE is the value that the logs have at the depth PEAK. Its severity
is the extreme of the length that the criterion limits, divided by this limit. Lists are sorted by severity times
confidence.

A washout at an open fracture that was picked is that fracture, not a zone: its turns are of no zone, and outputs say
how many were left out.

Stress is not computed here.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from helibore import _core
from helibore.base.arrays import Floats, Integers8, column
from helibore.base.axial import Axes, BreakoutLobe, axial_mean
from helibore.base.errors import InputError, check_choice
from helibore.base.notebook import card, curve_picture
from helibore.base.tables import LogColumn, LogTable, Tabular, columns_of
from helibore.base.thread_count import thread_count
from helibore.logs.kept_logs import KeptLogs
from helibore.logs.kept_samples import columns_of_kept_samples
from helibore.logs.likely_kinds import section_libraries
from helibore.logs.picks import Pick
from helibore.logs.turn_logs import RUGOSITY_WINDOW, Logs, columns_of_arms, turn_logs
from helibore.logs.zone_criteria import MEASURES, Criteria
from helibore.samples.caliper import Caliper
from helibore.samples.helix import WallLike

KINDS = ("gauge", "washout", "breakout", "key seat", "undergauge")
"""Kinds by their code in files, from 0."""
CLASSES = ", ".join(f"{code} {kind}" for code, kind in enumerate(KINDS))

SIZES = {
    "measure": f"extreme of {', '.join(f'{measure} ({kind})' for kind, measure in MEASURES.items())}",
    "severity": "measure divided by its limit; the greatest is the worst",
    "enlargement": "the greatest C1 - bit; of undergauge hole the lowest least diameter - bit",
    "elongation": "the greatest C1 - C2",
    "peak": "depth of the enlargement",
}
"""What the numbers of a zone mean, as files and reports state it."""
COLUMNS_OF_SIZES = {"enlargement": "enlarge", "elongation": "elong"}
"""Columns whose names are shorter than the names in `SIZES`."""

WORST = 5
"""Most zones that a notebook card lists."""

WASHOUT, BREAKOUT, KEY_SEAT = 1, 2, 3
ASIDE = 0.1
"""Metres that a washout reaches beyond the trace of the open fracture that it is."""
SURE, LIKELY = 0.8, 0.5
"""Least `Zone.confidence` of a zone whose kind is sure, and of any zone."""
READ = (
    "depth", "coverage", "sampled", "mean", "c1", "c1_toolface", "c2", "least_diameter", "unworn_diameter", "unworn_0",
    "unworn_90", "lobe1_toolface", "lobe1_width", "lobe1_height", "lobe2_toolface", "lobe2_width", "lobe2_height",
)  # fmt: skip
"""Columns of logs that the core finds zones from, in its order."""
NUMBERS = (
    "start", "stop", "measure", "median", "severity", "enlargement", "elongation", "peak", "coverage", "pipe_diameter",
    "toolface", "deviation",
)  # fmt: skip
"""Numbers of a zone, in the order of the core."""
LIMITS = (
    "elongation", "washout", "key_seat", "undergauge", "symmetry", "opening_level", "least_length", "join",
)  # fmt: skip
"""Criteria in the order of the core."""
ONE_AXIS = 1e-3
"""Degrees; if the axes of the arms deviate by less than this from their mean, the arms did not turn."""
NO_LOBE = BreakoutLobe(math.nan, math.nan, math.nan)


@dataclass(frozen=True)
class Zone:
    """An interval of hole of one kind. Its measures come from the turns that meet the criterion, not from others.

    A breakout or washout has its ends where the hole has less than 0.65 of its median, also below the limit.

    Attributes
    ----------
    kind
        One of `KINDS`, never ``"gauge"``.
    start, stop
        Measured depths, metres, start above stop.
    measure
        The length that the criteria compare with a limit, metres: the greatest C2 - bit of a washout, C1 - C2 of a
        breakout or height of a key seat; if undergauge, the lowest least diameter - bit.
    median
        Median, over the turns, of the length of which ``measure`` is the extreme, metres.
    severity
        Ratio of ``measure`` to the limit in the criteria; infinite if the limit is 0. It says which zone is worse.
    enlargement
        The greatest C1 - bit, metres; if undergauge, the lowest least diameter - bit.
    elongation
        The greatest C1 - C2, metres.
    peak
        Measured depth of ``enlargement``, metres.
    coverage
        Mean share of the zone's turns, also in its gaps, that is measured, not interpolated, 0 to 1.
    confidence
        Probability that the zone is of this kind, 0.5 to 0.99, since no kind is certain: from 0.8 on it is `sure`. A
        run of turns whose kind is less likely and that may be gauge is no zone. 0.5 if the hole is certainly not gauge
        but resembles no section of a known kind, or those of several kinds alike: then only the criteria say its kind.
    pipe_diameter
        Of a key seat: diameter of the pipe that fits the samples in its bottom, metres. NaN where they do not show it
        to within 2 mm (standard deviation, in a hole of 8.5 in), as with few samples a turn; NaN for other kinds.
    toolface
        Axis of a breakout, [0, 180), or direction of a key seat, [0, 360), degrees; NaN for other kinds.
    deviation
        Standard deviation of the turns' axes about ``toolface``, degrees (axial, Mardia); NaN for fewer than two turns.
    lobes
        The two lobes of a breakout or the one lobe of a key seat; see `BreakoutLobe`.
    """

    kind: str
    start: float
    stop: float
    measure: float
    median: float
    severity: float
    enlargement: float
    elongation: float
    peak: float
    coverage: float
    pipe_diameter: float
    toolface: float
    deviation: float
    lobes: tuple[BreakoutLobe, ...]
    confidence: float = 1.0

    @property
    def length(self) -> float:
        """Length of hole, metres."""
        return self.stop - self.start

    @property
    def sure(self) -> bool:
        """Whether `confidence` is at least 0.8. Outputs draw such zones filled, the others hollow."""
        return self.confidence >= SURE

    @property
    def confidence_text(self) -> str:
        """`confidence` in percent, for lists."""
        return f"{100 * self.confidence:.0f} %"


class Classification(Tabular):
    """Kinds of all turns and the zones they make; made by `classify`.

    Attributes
    ----------
    logs
        Logs of the turns.
    kind
        (turns,) int8 index in `KINDS` of the zone whose criterion the turn meets; 0 (gauge) outside zones and in the
        gaps that a zone joins, -1 if a radius is missing or the samples near do not show the kind of the turn.
    zones
        In order of depth.
    criteria
        The criteria used.
    fractures
        Washouts that are open fractures which were picked; they are not among the ``zones``.
    """

    def __init__(
        self, logs: Logs, kind: Integers8, zones: tuple[Zone, ...], criteria: Criteria,
        fractures: tuple[Zone, ...] = (),
    ) -> None:  # fmt: skip
        self.logs, self.kind, self.zones, self.criteria, self.fractures = logs, kind, zones, criteria, fractures

    def without(self, picks: Iterable[Pick]) -> Classification:
        """Return these zones without the washouts that lie within `ASIDE` of an open fracture among ``picks``."""
        traces = [pick.ends(self.logs.bit_diameter) for pick in picks if pick.aperture]
        fractures = tuple(
            zone
            for zone in self.of("washout")
            if any(top - ASIDE < zone.start and zone.stop < bottom + ASIDE for top, bottom in traces)
        )
        if not fractures:
            return self
        kind, depth, half = self.kind.copy(), self.logs.depth, self.logs.height / 2
        for zone in fractures:
            kind[(kind == WASHOUT) & (depth + half > zone.start) & (depth - half < zone.stop)] = 0
        zones = tuple(zone for zone in self.zones if zone not in fractures)
        return Classification(self.logs, kind, zones, self.criteria, self.fractures + fractures)

    def left_out(self) -> str:
        """Return as text how many washouts are picked fractures; "" if none is."""
        count = len(self.fractures)
        are = "washouts are open fractures that were" if count > 1 else "washout is an open fracture that was"
        return f"{count} {are} picked" if count else ""

    def of(self, kind: str) -> tuple[Zone, ...]:
        """Return the zones of a kind.

        Raises
        ------
        InputError
            ``kind = 'cave': must be one of gauge, washout, ...``.
        """
        check_choice("kind", kind, KINDS)
        return tuple(zone for zone in self.zones if zone.kind == kind)

    def by_severity(self, start: float = -math.inf, stop: float = math.inf) -> list[Zone]:
        """Return the zones between ``start`` and ``stop``, metres, by severity times confidence, the greatest first.

        Equal ones are in the order of depth.
        """
        inside = (zone for zone in self.zones if zone.stop > start and zone.start < stop)
        return sorted(inside, key=lambda zone: (-zone.severity * zone.confidence, zone.start))

    def breakout_axis(self) -> Axes:
        """Return mean axis and spread of all breakouts, weighted by length; NaN if there are no breakouts."""
        found = self.of("breakout")
        axes = axial_mean(np.array([zone.toolface for zone in found]), np.array([zone.length for zone in found]))
        turned = self.logs.shape == "wall" or axes.deviation >= ONE_AXIS
        return axes if turned else replace(axes, deviation=math.nan)  # it would say nothing about the lobes

    def azimuths(self) -> Floats:
        """Return azimuths of the axes of breakouts at their middles, (n,) of all zones, [0, 180) degrees; else NaN."""
        path = self.logs.path
        return np.array([
            path.azimuth((of.start + of.stop) / 2, of.toolface) % 180 if path and of.kind == "breakout" else math.nan
            for of in self.zones
        ])  # fmt: skip

    def breakout_azimuth(self) -> Axes:
        """Return mean azimuth and spread of all breakouts from north, weighted by length; NaN if none is known."""
        known = np.isfinite(self.azimuths())
        axes = axial_mean(self.azimuths()[known], np.array([zone.length for zone in self.zones])[known])
        return replace(axes, deviation=axes.deviation if math.isfinite(self.breakout_axis().deviation) else math.nan)

    def column(self) -> LogColumn:
        """Return the kinds as the log ``CLASS``, to be given to `Logs.table` or `Logs.save` in ``more``."""
        meaning = f"Kind of the zone whose criterion the turn meets, {CLASSES}"
        return LogColumn("CLASS", "", meaning, np.where(self.kind < 0, np.nan, self.kind), 0)

    def facts(self) -> dict[str, str]:
        """Return the facts of the logs, the criteria, and the meaning of the numbers of ``CLASS``."""
        return {**self.logs.facts(), **self.criteria.facts(), "class": CLASSES, **self._said()}

    def _said(self) -> dict[str, str]:
        return {"left out": self.left_out()} if self.fractures else {}

    def table(self) -> LogTable:
        """Return the zones, one per row, with the criteria among the facts; without zones the table has no row."""
        zones = self.zones
        codes = ", ".join(f"{code} {kind}" for code, kind in enumerate(KINDS) if code)
        sizes = {name: f"{text[0].upper()}{text[1:]}" for name, text in SIZES.items()}
        severity = [of.severity if math.isfinite(of.severity) else math.nan for of in zones]
        rows: list[Any] = [
            ("DEPT", "m", "Middle of the zone", [(of.start + of.stop) / 2 for of in zones]),
            ("TOP", "m", "Top of the zone", [of.start for of in zones]),
            ("BOTTOM", "m", "Bottom of the zone", [of.stop for of in zones]),
            ("CLASS", "", f"Class of hole, {codes}", [KINDS.index(of.kind) for of in zones], 0),
            ("MEASURE", "m", sizes["measure"], [of.measure for of in zones]),
            ("MEDIAN", "m", "Median of the length of which MEASURE is the extreme", [of.median for of in zones]),
            ("SEVERITY", "", sizes["severity"], severity),
            ("ENLARGE", "m", sizes["enlargement"], [of.enlargement for of in zones]),
            ("ELONG", "m", sizes["elongation"], [of.elongation for of in zones]),
            ("PEAK", "m", sizes["peak"], [of.peak for of in zones]),
            ("COVER", "", "Share of the zone that is measured, not interpolated", [of.coverage for of in zones]),
            ("CONF", "", "Probability that the zone is of this class", [of.confidence for of in zones]),
            ("PIPE", "m", "Diameter of the pipe that fits a key seat", [of.pipe_diameter for of in zones]),
            ("AXIS", "deg", "Axis of a breakout, toolface of a key seat", [of.toolface for of in zones]),
            ("AXISDEV", "deg", "Axial standard deviation in the zone", [of.deviation for of in zones]),
            ("AXISAZI", "deg", "Azimuth of the axis of a breakout, from north", self.azimuths()),
        ]
        for number in (1, 2):
            lobes = [of.lobes[number - 1] if number <= len(of.lobes) else NO_LOBE for of in zones]
            rows += [
                (f"LOBE{number}", "deg", "Toolface of the lobe", [of.toolface for of in lobes]),
                (f"OPEN{number}", "deg", "Opening of the lobe", [of.opening for of in lobes]),
                (f"HIGH{number}", "m", "Typical height of the lobe over the circle", [of.height for of in lobes]),
            ]
        meanings = {COLUMNS_OF_SIZES.get(name, name): text for name, text in SIZES.items()}
        return LogTable(columns_of(*rows), {**self.facts(), **meanings})

    def _repr_html_(self) -> str:
        counts = {kind: len(self.of(kind)) for kind in KINDS[1:]}
        numbers = {
            kind: f"{count} zone{'s' * (count != 1)}, {(self.kind == KINDS.index(kind)).sum() * self.logs.height:.1f} m"
            for kind, count in counts.items()
            if count
        }
        for number, zone in enumerate(self.by_severity()[:WORST], 1):
            size = f"{MEASURES[zone.kind]} {1000 * zone.measure:.1f} mm, {zone.severity:.1f} times its limit"
            text = f"{zone.kind} ({zone.confidence_text}) {zone.start:.2f} to {zone.stop:.2f} m: {size}"
            numbers[f"worst {number}"] = text
        axis = self.breakout_axis()
        if math.isfinite(axis.mean):
            numbers["breakout axis"] = f"{axis.mean:.0f}° and {axis.mean + 180:.0f}°, {axis.spread('zone', '°', 0)}"
        picture = curve_picture(
            np.where(self.kind < 0, np.nan, self.kind), self.logs.depth, f"class by depth: {CLASSES}"
        )
        return card(repr(self), numbers | self._said() | self.criteria.facts(), picture)

    def __repr__(self) -> str:
        counts = ", ".join(f"{len(self.of(kind))} {kind}" for kind in KINDS[1:] if self.of(kind))
        return f"Classification({len(self.kind)} turns: {counts or 'no zones'})"


def classify(
    wall: WallLike, criteria: Criteria | None = None, logs: Logs | None = None, picks: Iterable[Pick] | None = None
) -> Classification:
    """Classify the turns of a wall as gauge, washout, breakout, key seat or undergauge, as `Wall.zones` does.

    Parameters
    ----------
    wall
        Radii on a helix.
    criteria
        None: the defaults.
    logs
        Result of `turn_logs` for this wall; None: those that `Wall.logs` returned, if somebody holds them and the wall
        is the same, or it is computed here.
    picks
        A washout at an open fracture among these is no zone (`Classification.without`); None: the picks of the wall.

    Raises
    ------
    InputError
        If ``logs`` have one row per step, or belong to another wall.
    """
    criteria = Criteria() if criteria is None else criteria
    wall = getattr(wall, "_state", lambda: wall)()  # one copy for all that is read of it
    logs = _logs_of(wall) if logs is None else logs
    K, radius = wall.settings.sectors, column("radius", wall.radius[:])
    if logs.step is not None or len(logs) > radius.size // K or logs.sectors != K:
        raise InputError("logs", "must be the logs of the turns of the same wall")
    along, has_arms = logs.along(criteria), logs.shape == "arms"
    arms: Caliper | None = getattr(wall, "arms", None)
    kind, rows = _core.find_zones(
        [column(name, getattr(logs, name)) for name in READ],
        column("section", logs.section.ravel()),
        column("uneven", logs.uneven) if has_arms else np.empty(0),
        (radius, K, float(wall.settings.start_toolface), logs.pitch),
        logs.bit_diameter,
        tuple(getattr(criteria, name) for name in LIMITS),
        None if along is None else (along.kinds.ravel(), along.seen),
        _samples_of(wall),
        None if arms is None else columns_of_arms(arms),
        getattr(wall, "made_from", {}).get("measures") == "diameter",
        section_libraries(logs.bit_diameter, criteria),
        thread_count(getattr(wall, "threads", None)),
    )
    found = Classification(logs, kind, tuple(_zone(*row) for row in rows), criteria)
    return found.without(getattr(wall, "picks", ()) if picks is None else picks)


def _samples_of(wall: WallLike) -> tuple[Floats, Floats, Floats]:
    depth, toolface, radius = columns_of_kept_samples(wall) or (np.empty(0),) * 3
    return depth, toolface, radius


def _logs_of(wall: WallLike) -> Logs:
    kept: KeptLogs | None = getattr(wall, "kept", None)
    if kept is None:
        return turn_logs(wall)
    how = (RUGOSITY_WINDOW, False, 0.0)
    found = kept.find(wall, how)
    return kept.keep(turn_logs(wall), how) if found is None else found


def _zone(code: int, *row: Any) -> Zone:
    *sizes, confidence, first, second = row
    numbers = dict(zip(NUMBERS, sizes, strict=True))
    count = {BREAKOUT: 2, KEY_SEAT: 1}.get(code, 0)
    lobes = tuple(BreakoutLobe(*lobe) for lobe in (first, second)[:count])
    return Zone(kind=KINDS[code], **numbers, lobes=lobes, confidence=confidence)
