"""Classify each turn and join turns of one kind into zones: gauge, washout, breakout, key seat, undergauge.

`helibore.logs.zone_criteria` defines the kinds; every output states the criteria. A run of turns of one kind becomes a
zone if it is long enough. A turn is of no kind if it lacks a radius or if less than half of it has samples near; a
tool's arms, however few, show the kinds of the diameters that they measured.

Then the sections of a few of its turns, as the samples show them, are compared with a library of sections
(``likely_kinds``). The zone states the probability of its kind as ``confidence``: from `SURE` on outputs draw it
filled, else hollow. A run of turns whose kind is less likely than `LIKELY` and that may be gauge is no zone. A run that
is certainly not gauge but resembles no section of the library, or several kinds alike, has the confidence `LIKELY`: the
criteria alone say its kind.

A zone states the extremes of its turns, so that ENLARGE is the value that the logs have at the depth PEAK. Its severity
is the extreme of the length that the criterion limits, divided by this limit. Lists are sorted by severity times
confidence.

``breakouts`` finds the azimuth and opening of lobes. Stress is not computed.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from helibore.base.arrays import Floats, Integers, Integers8, Mask, runs_of
from helibore.base.axial import Axes, BreakoutLobe, axial_mean
from helibore.base.errors import InputError, check_choice
from helibore.base.notebook import card, curve_picture
from helibore.base.tables import LogColumn, LogTable, Tabular, columns_of
from helibore.logs.breakouts import axes_of_arms, lobes_of, lobes_of_arms
from helibore.logs.likely_kinds import PARTS, kind_probabilities
from helibore.logs.turn_logs import Logs, turn_logs
from helibore.logs.zone_criteria import MEASURES, Criteria, washed_out
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

GAUGE, WASHOUT, BREAKOUT, KEY_SEAT, UNDERGAUGE = range(5)
NO_KIND = -1
SURE, LIKELY = 0.8, 0.5
"""Least `Zone.confidence` of a zone whose kind is sure, and of any zone."""
NOT_GAUGE = 0.05
"""Probability of gauge below which a run of turns is a zone, whatever its kind."""
LEAST_SAMPLED = 0.5
"""A wall shows no kind where less than this share of a turn has samples near. Arms measure diameters without it."""
LEAST_SEEN = 6
"""Least parts of `PARTS` that samples must see around a turn for it to have a kind, unless arms measure diameters."""
TOGETHER = 0.25
"""Metres along the hole, above and below a turn with few samples, whose samples make its section."""
COMPARED = 6
"""Most turns of a zone that are compared with the library of sections."""
OPPOSITE = 140.0
"""Least degrees between two lobes that are opposite: the lobes of a breakout."""
WIDEST_KEY_SEAT = 150.0
"""Degrees; a wider lobe is no key seat."""
NO_LOBE = BreakoutLobe(math.nan, math.nan, math.nan)


@dataclass(frozen=True)
class Zone:
    """An interval of hole of one kind. Its measures come from the turns that meet the criterion, not from gaps.

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
        Probability that the zone is of this kind, 0.5 to 1: from 0.8 on it is `sure`. A run of turns whose kind is less
        likely and that may be gauge is no zone. 0.5 if the hole is certainly not gauge but resembles no section of a
        known kind, or those of several kinds alike: then only the criteria say its kind.
    pipe_diameter
        Of a key seat that a wall shows: median, over the turns, of the diameter of the pipe that fits its bottom,
        metres. NaN for other kinds.
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
        """`confidence` in percent, for lists; at most 99, since no kind is certain."""
        return f"{min(round(100 * self.confidence), 99)} %"


class Classification(Tabular):
    """Kinds of all turns and the zones they make; made by `classify`.

    Attributes
    ----------
    logs
        Logs of the turns.
    kind
        (turns,) int8 index in `KINDS` of the zone whose criterion the turn meets; 0 (gauge) outside zones and in the
        gaps that a zone joins, -1 if a radius is missing or less than half of the turn has samples near.
    zones
        In order of depth.
    criteria
        The criteria used.
    """

    def __init__(self, logs: Logs, kind: Integers8, zones: tuple[Zone, ...], criteria: Criteria) -> None:
        self.logs, self.kind, self.zones, self.criteria = logs, kind, zones, criteria

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
        return axes_of_arms(axes) if self.logs.shape == "arms" else axes

    def column(self) -> LogColumn:
        """Return the kinds as the log ``CLASS``, to be given to `Logs.table` or `Logs.save` in ``more``."""
        meaning = f"Kind of the zone whose criterion the turn meets, {CLASSES}"
        return LogColumn("CLASS", "", meaning, np.where(self.kind < 0, np.nan, self.kind), 0)

    def facts(self) -> dict[str, str]:
        """Return the facts of the logs, the criteria, and the meaning of the numbers of ``CLASS``."""
        return {**self.logs.facts(), **self.criteria.facts(), "class": CLASSES}

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
        return card(repr(self), numbers | self.criteria.facts(), picture)

    def __repr__(self) -> str:
        counts = ", ".join(f"{len(self.of(kind))} {kind}" for kind in KINDS[1:] if self.of(kind))
        return f"Classification({len(self.kind)} turns: {counts or 'no zones'})"


def classify(wall: WallLike, criteria: Criteria | None = None, logs: Logs | None = None) -> Classification:
    """Classify the turns of a wall as gauge, washout, breakout, key seat or undergauge, as `Wall.zones` does.

    Parameters
    ----------
    wall
        Radii on a helix.
    criteria
        None: the defaults.
    logs
        Result of `turn_logs` for this wall; None: it is computed here.

    Raises
    ------
    InputError
        If ``logs`` have one row per step, or belong to another wall.
    """
    criteria = Criteria() if criteria is None else criteria
    logs = turn_logs(wall) if logs is None else logs
    K = wall.settings.sectors
    radius = wall.radius
    if logs.step is not None or len(logs) > radius.size // K or logs.sectors != K:
        raise InputError("logs", "must be the logs of the turns of the same wall")
    start = float(wall.settings.start_toolface)
    lower, higher = _lobe_heights(logs)
    fits = _kinds(logs, criteria, lower, higher)
    sparse, along = logs.sparse, _along(logs, criteria)
    if len(along):
        fits = np.where(sparse, _likeliest(logs, along), fits)
        higher = np.where(sparse & np.isnan(logs.lobe1_height), logs.c1 - logs.bit_diameter, higher)
    under, elongation = logs.least_diameter - logs.bit_diameter, logs.c1 - logs.c2
    measures = {WASHOUT: logs.c2 - logs.bit_diameter, BREAKOUT: elongation, KEY_SEAT: higher, UNDERGAUGE: under}
    kind = np.where(fits == NO_KIND, NO_KIND, GAUGE).astype(np.int8)
    free = fits != NO_KIND
    zones = []
    # Washouts are found first, so that two breakouts are not joined over a washout between them.
    for code in (WASHOUT, UNDERGAUGE, BREAKOUT, KEY_SEAT):
        for first, stop in _runs(fits == code, free, criteria, abs(logs.pitch)):
            free[first:stop] = False
            inside = first + np.flatnonzero(fits[first:stop] == code)
            sections = _sections(logs, inside[np.unique(np.linspace(0, inside.size - 1, COMPARED).astype(int))])
            even = _measures_diameters(logs, inside)
            likely, sound = kind_probabilities(sections, logs.bit_diameter, criteria, even)
            if len(along) and sparse[inside].mean() > 0.5:
                likely = np.nanmean(along[inside], axis=0)
            if likely[code] < LIKELY and likely[GAUGE] > NOT_GAUGE:
                continue
            confidence = max(float(likely[code]), LIKELY) if sound else LIKELY
            kind[inside] = code
            zone = _zone(code, first, stop, inside, measures[code], logs, radius, start, criteria)
            zones.append(replace(zone, confidence=confidence))
    return Classification(logs, kind, tuple(sorted(zones, key=lambda zone: zone.start)), criteria)


def _measures_diameters(logs: Logs, turns: Integers) -> bool:
    return logs.shape == "arms" and not np.any(logs.uneven[turns] > 0)


def _along(logs: Logs, criteria: Criteria) -> Floats:
    """Return the probabilities of kinds where turns have few samples, (turns, 5), else NaN; (0, 5): no turn is such."""
    along = logs.along(criteria)
    if along is None:
        return np.empty((0, len(KINDS)))
    seen = (along.seen >= LEAST_SEEN)[:, None] | (logs.shape == "arms")
    return np.where(seen, along.kinds, np.nan)


def _likeliest(logs: Logs, along: Floats) -> Integers8:
    """Return the most probable kind of each turn."""
    missing = np.isnan(logs.c1) | np.isnan(logs.c2) | np.isnan(along[:, GAUGE])
    likeliest: Integers8 = np.where(missing, NO_KIND, np.nan_to_num(along).argmax(axis=1)).astype(np.int8)
    return likeliest


def _sections(logs: Logs, turns: Integers) -> Floats:
    """Return the sections of some turns, (turns, PARTS), radius less half the bit diameter, metres.

    A turn of which less than half has samples is taken together with its neighbours within `TOGETHER`.
    """
    found = logs.section[turns] - logs.bit_diameter / 2
    reach = round(TOGETHER / logs.height)
    for row, turn in enumerate(turns):
        if np.isfinite(found[row]).sum() < PARTS / 2:
            near = logs.section[max(turn - reach, 0) : turn + reach + 1]
            known = np.isfinite(near)
            count = known.sum(axis=0)
            total = np.where(known, near, 0.0).sum(axis=0)
            found[row, count > 0] = total[count > 0] / count[count > 0] - logs.bit_diameter / 2
    return found


def _kinds(logs: Logs, criteria: Criteria, lower: Floats, higher: Floats) -> Integers8:
    """Return the kind of each turn without regard to its neighbours; `_lobe_heights` gives ``lower`` and ``higher``."""
    bit = logs.bit_diameter
    elongation = logs.c1 - logs.c2
    missing = np.isnan(logs.c1) if logs.shape == "arms" else np.isnan(logs.mean)
    under = ~missing & (logs.least_diameter < bit - criteria.undergauge)
    total = lower + higher
    both = (lower > 0) & (2 * lower >= criteria.symmetry * total)
    kind = np.full(len(logs), GAUGE, dtype=np.int8)
    kind[both & (elongation >= criteria.elongation)] = BREAKOUT
    narrow = True if logs.shape == "arms" else logs.lobe1_width <= WIDEST_KEY_SEAT
    kind[~both & (higher >= criteria.key_seat) & narrow] = KEY_SEAT
    kind[washed_out(logs.c2, bit, criteria)] = WASHOUT
    kind[under] = UNDERGAUGE
    if logs.shape == "wall":
        missing |= logs.sampled < LEAST_SAMPLED
    kind[missing] = NO_KIND
    return kind


def _lobe_heights(logs: Logs) -> tuple[Floats, Floats]:
    """Return the heights of the lobe opposite to the highest lobe, 0 without one, and of the highest lobe, metres.

    For a tool with few arms they are those of the lower and the higher end of C1.
    """
    if logs.shape == "arms":
        half = (logs.c1 - logs.c2) / 2
        return half - logs.uneven / 2, half + logs.uneven / 2
    apart = np.abs((logs.lobe1_toolface - logs.lobe2_toolface + 180) % 360 - 180)
    return np.where(apart >= OPPOSITE, logs.lobe2_height, 0.0), np.nan_to_num(logs.lobe1_height)


def _runs(fits: Mask, free: Mask, criteria: Criteria, pitch: float) -> Iterator[tuple[int, int]]:
    """Yield the zones of a kind as runs of turns [first, stop), from the turns that fit and are free.

    Runs are joined over short gaps if all turns of the gap are free; a joined run that is too short is no zone.
    """
    joined: list[list[int]] = []
    for first, stop in runs_of(fits & free):
        last = joined[-1][1] if joined else 0
        if joined and (first - last) * pitch <= criteria.join + 1e-9 and free[last:first].all():
            joined[-1][1] = stop
        else:
            joined.append([first, stop])
    for first, stop in joined:
        if (stop - first) * pitch >= criteria.least_length - 1e-9:
            yield first, stop


def _zone(
    code: int,
    first: int,
    stop: int,
    inside: Integers,
    measures: Floats,
    logs: Logs,
    radius: Floats,
    start: float,
    criteria: Criteria,
) -> Zone:
    ends = sorted((float(logs.depth[first]), float(logs.depth[stop - 1])))
    extreme = np.argmin if code == UNDERGAUGE else np.argmax
    size = (logs.least_diameter if code == UNDERGAUGE else logs.c1)[inside] - logs.bit_diameter
    most, measured, limit = int(extreme(size)), measures[inside], criteria.limits()[KINDS[code]]
    measure = float(measured[extreme(measured)])
    toolface = deviation = pipe = math.nan
    lobes: tuple[BreakoutLobe, ...] = ()
    if code in (BREAKOUT, KEY_SEAT) and logs.shape == "arms":
        toolface, deviation, lobes = lobes_of_arms(logs, inside, radius, start, code == BREAKOUT)
    elif code in (BREAKOUT, KEY_SEAT):
        toolface, deviation, lobes = lobes_of(logs, inside, radius, start, criteria.opening_level, code == BREAKOUT)
    fits = logs.lobe1_pipe[inside]
    if code == KEY_SEAT and logs.shape == "wall" and np.isfinite(fits).any():
        pipe = float(np.nanmedian(fits))
    return Zone(
        kind=KINDS[code],
        start=ends[0] - logs.height / 2,
        stop=ends[1] + logs.height / 2,
        measure=measure,
        median=float(np.median(measured)),
        severity=measure / limit if limit else math.inf,
        enlargement=float(size[most]),
        elongation=float((logs.c1 - logs.c2)[inside].max()),
        peak=float(logs.depth[inside[most]]),
        coverage=float(logs.coverage[first:stop].mean()),
        pipe_diameter=pipe,
        toolface=toolface,
        deviation=deviation,
        lobes=lobes,
    )
