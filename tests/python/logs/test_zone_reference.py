"""Zones of the core against a slow reference: the rules of zones.hpp, turn by turn, for walls of tools and shapes."""

from __future__ import annotations

import cmath
import math
from collections.abc import Sequence
from functools import cache
from typing import Any

import numpy as np
import pytest
from scipy.optimize import least_squares

import helibore as hb
from helibore import _core
from helibore.base.arrays import Floats
from helibore.logs.turn_logs import Logs
from helibore.logs.zone_criteria import Criteria
from helibore.logs.zones import KINDS, classify

BIT, PARTS = 0.2159, 32
GAUGE, WASHOUT, BREAKOUT, KEY_SEAT, UNDERGAUGE = range(5)
TOOLS = ("rotating", "upwards", "X-Y", "four arms", "telemetry", "turning stops")
SHAPES = ("breakout", "key seat", "washout", "undergauge", "ledge", "fracture")


def radius_of(shape: str, seed: int, depth: Floats, toolface: Floats) -> Floats:
    rng = np.random.default_rng([seed, SHAPES.index(shape)])
    axis, high = rng.uniform(0, 360), rng.uniform(0.014, 0.03)
    middle = rng.uniform(4, 6)
    worn = np.clip(4 * (1.6 - np.abs(depth - middle)), 0, 1)

    def lobe(towards: float, width: float) -> Floats:
        away = (toolface - towards + 180) % 360 - 180
        return np.maximum(1 - (away / width) ** 2, 0)

    over = {
        "breakout": high * lobe(axis, 35) + 0.8 * high * lobe(axis + 175, 40),
        "key seat": high * lobe(axis, 25),
        "washout": np.full(depth.size, high),
        "undergauge": np.full(depth.size, -0.008),
        "ledge": 0.006 * np.cos(np.radians(toolface - axis)),
        "fracture": high * (np.abs(depth - middle - 0.25 * np.cos(np.radians(toolface - axis))) < 0.03),
    }[shape]
    worn = 1.0 if shape == "fracture" else worn
    return BIT / 2 + 0.004 * np.cos(np.radians(toolface - 70)) + worn * over + rng.normal(0, 0.0005, depth.size)


def wall_of(tool: str, shape: str, seed: int) -> hb.Wall:
    rng = np.random.default_rng([seed, TOOLS.index(tool)])
    arm, more = None, {"sectors": int(rng.choice([32, 48])), "start_toolface": float(rng.uniform(-90, 90))}
    if tool in ("X-Y", "four arms"):
        rows = np.arange(0, 10, 0.05)
        turned = rng.uniform(0, 360) + 12 * rows * rng.uniform(0, 1)
        depth, arm = np.repeat(rows, 4), np.tile(np.arange(4), rows.size)
        toolface = np.repeat(turned, 4) + 90 * arm
    else:
        count = 200 if tool == "telemetry" else 6000
        depth, toolface = np.sort(rng.uniform(0, 10, count)), rng.uniform(0, 360, count)
        if tool == "turning stops":
            toolface = np.where(depth > 5, rng.uniform(0, 360) + rng.uniform(-4, 4, count), toolface)
    radius = radius_of(shape, seed, depth, toolface)
    if tool == "X-Y":
        radius = radius.reshape(-1, 2, 2).mean(axis=1)[:, [0, 1, 0, 1]].ravel()
    if tool == "upwards":
        more |= {"pitch": -0.08, "start_depth": 10.0}
    return hb.reconstruct(hb.Caliper(depth, toolface, radius, arm=arm), bit_diameter=BIT, **more)


@cache
def library(criteria: Criteria, even: bool) -> Any:
    limits = (criteria.elongation, criteria.washout, criteria.key_seat, criteria.undergauge, criteria.symmetry)
    return _core.section_library(BIT, limits, even)


class Reference:
    def __init__(self, wall: hb.Wall, logs: Logs, criteria: Criteria, *, diameters: bool) -> None:
        self.logs, self.criteria, self.arms = logs, criteria, logs.shape == "arms"
        self.pitch, self.along = abs(logs.pitch), logs.along(criteria)
        self.diameters = diameters
        self.radius = wall.radius[: len(logs) * logs.sectors].reshape(len(logs), -1)
        self.toolfaces = wall.settings.start_toolface + np.arange(logs.sectors) * 360 / logs.sectors
        self.sparse = self.sparse_turns()
        np.testing.assert_array_equal(self.sparse, logs.sparse)

    def sparse_turns(self) -> list[bool]:
        few = [np.isfinite(row).sum() < PARTS / 2 for row in self.logs.section]
        found = list(few)
        for turn, is_few in enumerate(few):
            first, last = turn, turn
            while is_few and first > 0 and few[first - 1]:
                first -= 1
            while is_few and last + 1 < len(few) and few[last + 1]:
                last += 1
            length = last + 1 - first
            found[turn] = bool(is_few) and (length * self.pitch >= 0.3 - 1e-9 or length == len(few))
        return found

    def heights(self, turn: int) -> tuple[float, float]:
        of = self.logs
        if self.arms:
            half, off = (of.c1[turn] - of.c2[turn]) / 2, of.uneven[turn] / 2
            return half - off, half + off
        apart = abs((of.lobe1_toolface[turn] - of.lobe2_toolface[turn] + 180) % 360 - 180)
        lower = self.long_height(turn, of.lobe2_toolface[turn], of.lobe2_height[turn])
        return (lower if apart >= 140 else 0.0), self.long_height(turn, of.lobe1_toolface[turn], of.lobe1_height[turn])

    def long_height(self, turn: int, toolface: float, high: float) -> float:
        """Return the height of a lobe; 0 unless the wall at its toolface is as high over the least length of a zone."""
        if math.isnan(high):
            return 0.0
        of = self.logs
        centre, radius = of.unworn_0 + 1j * of.unworn_90, of.unworn_diameter / 2
        top = centre[turn] + (radius[turn] + high) * cmath.rect(1, math.radians(toolface))
        away = (self.toolfaces - math.degrees(cmath.phase(top)) + 180) % 360 - 180
        k = int(np.abs(away).argmin())
        place = self.radius[:, k] * cmath.rect(1, math.radians(self.toolfaces[k]))
        height = np.clip(np.nan_to_num(abs(place - centre) - radius), 0, high)
        turns = max(round(self.criteria.least_length / self.pitch), 1)
        starts = range(max(turn - turns + 1, 0), min(turn, len(of) - turns) + 1)
        return float(high) if any(height[i : i + turns].mean() >= 0.65 * high for i in starts) else 0.0

    def height(self, turn: int) -> float:
        """Return the height by which a key seat is measured: no lobe may stand over an interpolated circle."""
        of, sparse = self.logs, self.along is not None and self.sparse[turn]
        if sparse and math.isnan(of.lobe1_height[turn]):
            return of.c1[turn] - BIT
        return of.lobe1_height[turn] if sparse and not self.arms else self.heights(turn)[1]

    def shows_gauge(self, turn: int) -> bool:
        return self.arms or self.along is None or not self.sparse[turn] or bool(self.along.seen[turn] >= 13)

    def kind(self, turn: int) -> int:
        of, criteria = self.logs, self.criteria
        if self.along is not None and self.sparse[turn]:
            row = self.along.kinds[turn]
            unknown = math.isnan(of.c1[turn] + of.c2[turn] + row[0])
            return -1 if unknown or not (self.arms or self.along.seen[turn] >= 8) else int(row.argmax())
        if math.isnan(of.c1[turn] if self.arms else of.mean[turn]) or (not self.arms and of.sampled[turn] < 0.5):
            return -1
        if of.least_diameter[turn] < BIT - criteria.undergauge:
            return UNDERGAUGE
        if of.c2[turn] - BIT >= criteria.washout:
            return WASHOUT
        lower, higher = self.heights(turn)
        if lower > 0 and 2 * lower >= criteria.symmetry * (lower + higher):
            return BREAKOUT if of.c1[turn] - of.c2[turn] >= criteria.elongation else GAUGE
        narrow = self.arms or of.lobe1_width[turn] <= 150
        return KEY_SEAT if higher >= criteria.key_seat and narrow else GAUGE

    def measures(self, code: int, turns: Sequence[int]) -> Floats:
        of = self.logs
        if code == KEY_SEAT:
            return np.array([self.height(turn) for turn in turns])
        return {WASHOUT: of.c2 - BIT, BREAKOUT: of.c1 - of.c2, UNDERGAUGE: of.least_diameter - BIT}[code][list(turns)]

    def runs(self, kinds: list[int]) -> list[tuple[int, range]]:
        free, found = [kind >= 0 for kind in kinds], []
        few = int((self.criteria.join + 1e-9) / self.pitch)
        for code in (WASHOUT, UNDERGAUGE, BREAKOUT, KEY_SEAT):
            of_kind = [turn for turn, kind in enumerate(kinds) if kind == code and free[turn]]
            parts = np.split(of_kind, np.flatnonzero(np.diff(of_kind) > 1) + 1) if of_kind else []
            runs: list[range] = []
            for part in parts:
                before, start, stop = (runs[-1].stop if runs else 0), int(part[0]), int(part[-1]) + 1
                if code in (WASHOUT, BREAKOUT):
                    least = 0.65 * np.median(self.measures(code, part))
                    start = self.end_of(code, kinds, free, range(start - 1, before - 1, -1), least, few, start)
                    stop = max(stop, before)
                    stop = self.end_of(code, kinds, free, range(stop, len(kinds)), least, few, stop - 1) + 1
                if runs and start - before <= few and all(free[before:start]):
                    runs[-1] = range(runs[-1].start, max(stop, before))
                else:
                    runs.append(range(start, stop))
            for run in runs:
                inside = [turn for turn in run if kinds[turn] == code]
                if (inside[-1] + 1 - inside[0]) * self.pitch >= self.criteria.least_length - 1e-9:
                    found.append((code, run))
                    free[run.start : run.stop] = [False] * len(run)
        return found

    def end_of(
        self, code: int, kinds: list[int], free: list[bool], beside: range, least: float, few: int, end: int
    ) -> int:
        """Return the last turn beside a run that has nearly as much; up to ``few`` turns on end may have less."""
        for turn in beside:
            if not free[turn] or abs(turn - end) > few + 1:
                break
            if kinds[turn] in (GAUGE, code) and self.measures(code, [turn])[0] >= least:
                end = turn
        return end

    def section(self, turn: int) -> Floats:
        own = self.logs.section[turn].copy()
        if np.isfinite(own).sum() >= PARTS / 2:
            return own - BIT / 2
        reach = round(0.25 / self.pitch)
        near = self.logs.section[max(turn - reach, 0) : turn + reach + 1]
        for part in range(PARTS):
            values = near[np.isfinite(near[:, part]), part]
            own[part] = values.mean() if values.size else own[part]
        return own - BIT / 2

    def confidence(self, code: int, inside: list[int]) -> float | None:
        """Return the confidence of a run; None: it is no zone."""
        some = sorted({int(i * (len(inside) - 1) / 5) for i in range(5)} | {len(inside) - 1})
        sections = np.array([self.section(inside[i]) for i in some])
        likely, sound = _core.likely_kind(sections.ravel(), library(self.criteria, self.diameters))
        if self.along is not None and np.mean([self.sparse[turn] for turn in inside]) > 0.5:
            known = [
                self.along.kinds[turn]
                for turn in inside
                if not math.isnan(self.along.kinds[turn, 0]) and (self.arms or self.along.seen[turn] >= 8)
            ]
            likely = list(np.mean(known, axis=0))
        if likely[code] < 0.5 and likely[GAUGE] > 0.05:
            return None
        share = 0.625 if self.diameters and code == BREAKOUT else 1.0  # or a key seat, for all that diameters show
        return min(max(share * likely[code], 0.5), 0.99) if sound else 0.5  # no kind is certain

    def lobes(self, code: int, inside: list[int]) -> tuple[float, float, list[tuple[float, float, float]]]:
        of, fold, K = self.logs, 2 if code == BREAKOUT else 1, self.logs.sectors
        total, heights = 0j, np.zeros(K)
        for turn in inside:
            known = not math.isnan(of.unworn_diameter[turn])
            centre = complex(of.unworn_0[turn], of.unworn_90[turn]) if known else 0j
            places = self.radius[turn] * np.exp(1j * np.radians(self.toolfaces)) - centre
            height = abs(places) - (of.unworn_diameter[turn] if known else BIT) / 2
            weight = np.maximum(height - self.criteria.opening_level * height.max(), 0)
            axis = (weight * np.exp(1j * fold * np.angle(places))).sum()
            total += axis / abs(axis)
            heights += height / len(inside)
        toolface = math.degrees(cmath.phase(total)) / fold % (360 / fold)
        spread = math.degrees(math.sqrt(max(-2 * math.log(abs(total) / len(inside)), 0))) / fold
        step, level, found = 360 / K, self.criteria.opening_level, []
        for side in [toolface, toolface + 180][:fold]:
            away = (self.toolfaces - side + 180) % 360 - 180
            order = [k for k in np.argsort(away) if abs(away[k]) <= 90]
            values, angles = heights[order], side + away[order]
            top = int(values.argmax())
            weight = np.maximum(values - level * values[top], 0)
            ends = [fall(values[top::-1], level), fall(values[top:], level)]
            found.append((float((weight * angles).sum() / weight.sum()) % 360, sum(ends) * step, values[top]))
        return toolface, spread, found

    def lobes_of_arms(self, code: int, inside: list[int]) -> tuple[float, float, list[tuple[float, float, float]]]:
        of, K = self.logs, self.logs.sectors
        total = sum(cmath.exp(2j * math.radians(of.c1_toolface[turn])) for turn in inside)
        mean = math.degrees(cmath.phase(total)) / 2 % 180
        spread = math.degrees(math.sqrt(max(-2 * math.log(abs(total) / len(inside)), 0))) / 2
        lower, higher = np.median([self.heights(turn) for turn in inside], axis=0)
        sum_ = 0.0
        for turn in inside:
            axis = of.c1_toolface[turn]
            first = round((axis - self.toolfaces[0]) * K / 360) % K
            off = self.radius[turn, first] - self.radius[turn, (first + K // 2) % K]
            sum_ += 0 if math.isnan(off) else off * (-1 if abs(axis - mean) > 90 else 1)
        near, far = (higher, lower) if sum_ >= 0 else (lower, higher)
        sides = [(mean, math.nan, near), (mean + 180, math.nan, far)]
        if code == BREAKOUT:
            return mean, spread, sides
        side = sides[0] if near >= far else sides[1]
        return side[0], spread, [side]


def fall(values: Floats, level: float) -> float:
    """Return how many steps after the first value the values fall to this share of it."""
    for after, value in enumerate(values):
        if value < level * values[0]:
            return float(after - 1 + (values[after - 1] - level * values[0]) / (values[after - 1] - value))
    return len(values) - 1.0


def pipe_of(wall: hb.Wall, logs: Logs, inside: list[int], toolface: float) -> float:
    """Return the diameter of the circle that fits the samples in a slot; all its numbers are fitted at once."""
    top = np.nanmedian(logs.lobe1_height[inside]) if np.isfinite(logs.lobe1_height[inside]).any() else math.nan
    edge = wall.start_depth + wall.settings.pitch * np.arange(len(logs) + 1)
    points = []
    for turn in inside:
        low, high = sorted(edge[turn : turn + 2])
        here = (wall.samples.depth >= low) & (wall.samples.depth <= high) & (logs.lobe1_height[turn] >= 0.8 * top)
        place = wall.samples.radius[here] * np.exp(1j * np.radians(wall.samples.toolface[here]))
        place = (place - logs.unworn_0[turn] - 1j * logs.unworn_90[turn]) * np.exp(-1j * np.radians(toolface))
        place = place[(abs(place) - logs.unworn_diameter[turn] / 2 >= 0.35 * top) & (place.real > 0)]
        points += [(turn, of) for of in place]
    if not points:
        return math.nan
    of_turn, place = np.array([of[0] for of in points]), np.array([of[1] for of in points])
    turns, number = np.unique(of_turn, return_inverse=True)
    if len(points) < turns.size + 3:
        return math.nan

    def off(numbers: Floats) -> Floats:
        return np.asarray(abs(place - numbers[2:][number] - 1j * numbers[1]) - numbers[0])

    start = [BIT / 4, 0.0, *(place.real[number == k].max() - BIT / 4 for k in range(turns.size))]
    found = least_squares(off, start, method="lm", xtol=1e-14, ftol=1e-14, max_nfev=20000)
    variance = (2 * found.cost + 4e-6) / (len(points) - turns.size - 2 + 4)
    known = found.jac.T @ found.jac + 1e-9 * np.eye(len(start))
    sure = 2 * math.sqrt(variance * np.linalg.inv(known)[0, 0]) <= 0.002 and 0.1 * BIT < found.x[0] < BIT / 2
    return 2 * float(found.x[0]) if sure else math.nan


@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize("tool", TOOLS)
@pytest.mark.parametrize("keen", [False, True])
def test_zones_are_those_of_the_rules_turn_by_turn(tool: str, shape: str, keen: bool) -> None:
    seed = 7 + keen
    wall, logs = wall_of(tool, shape, seed), None
    criteria = (
        Criteria(washout=0.006, key_seat=0.004, symmetry=0.7, opening_level=0.5, join=0.2) if keen else Criteria()
    )
    found = classify(wall, criteria)
    logs = found.logs
    of = Reference(wall, logs, criteria, diameters=tool == "X-Y")
    kinds = [of.kind(turn) for turn in range(len(logs))]
    wanted, expected = [GAUGE if kind >= 0 and of.shows_gauge(turn) else -1 for turn, kind in enumerate(kinds)], []
    for code, run in of.runs(kinds):
        inside = [turn for turn in run if kinds[turn] == code]
        confidence = of.confidence(code, inside)
        if confidence is None:
            continue
        for turn in inside:
            wanted[turn] = code
        expected.append((code, run, inside, confidence))
    assert found.kind.tolist() == wanted
    expected.sort(key=lambda zone: min(logs.depth[zone[1].start], logs.depth[zone[1].stop - 1]))
    assert [zone.kind for zone in found.zones] == [KINDS[code] for code, *_ in expected]
    for zone, (code, run, inside, confidence) in zip(found.zones, expected, strict=True):
        ends = sorted((logs.depth[run.start], logs.depth[run.stop - 1]))
        assert (zone.start, zone.stop) == (ends[0] - of.pitch / 2, ends[1] + of.pitch / 2)
        sizes = (logs.least_diameter if code == UNDERGAUGE else logs.c1)[inside] - BIT
        measures = of.measures(code, inside)
        extreme = np.min if code == UNDERGAUGE else np.max
        assert (zone.measure, zone.median, zone.enlargement) == (extreme(measures), np.median(measures), extreme(sizes))
        assert zone.elongation == (logs.c1 - logs.c2)[inside].max()
        assert zone.peak == logs.depth[inside[int(np.argmax(sizes == extreme(sizes)))]]
        assert zone.severity == zone.measure / criteria.limits()[zone.kind]
        assert zone.coverage == pytest.approx(logs.coverage[run.start : run.stop].mean(), rel=1e-12)
        assert zone.confidence == pytest.approx(confidence, rel=1e-9)
        pipe = pipe_of(wall, logs, inside, zone.toolface) if code == KEY_SEAT and not of.arms else math.nan
        assert zone.pipe_diameter == pytest.approx(pipe, abs=1e-6, nan_ok=True)
        if code not in (BREAKOUT, KEY_SEAT):
            assert math.isnan(zone.toolface)
            assert zone.lobes == ()
            continue
        toolface, spread, lobes = (of.lobes_of_arms if of.arms else of.lobes)(code, inside)
        assert zone.toolface == pytest.approx(toolface, abs=1e-9)
        if of.arms and spread < 1e-3:
            assert math.isnan(zone.deviation)
        elif len(inside) > 1:
            assert zone.deviation == pytest.approx(spread, abs=1e-5)
        assert len(zone.lobes) == len(lobes)
        for lobe, numbers in zip(zone.lobes, lobes, strict=True):
            assert (lobe.toolface, lobe.opening, lobe.height) == pytest.approx(numbers, abs=1e-9, nan_ok=True)


@pytest.mark.parametrize("pitch", [0.1, -0.1])
def test_sections_are_means_of_samples_by_turn_and_part(pitch: float) -> None:
    rng = np.random.default_rng(3)
    depth, toolface = np.sort(rng.uniform(0, 3, 900)), rng.uniform(0, 360, 900)
    radius = rng.uniform(0.1, 0.12, 900)
    wall = hb.reconstruct(hb.Caliper(depth, toolface, radius), bit_diameter=BIT, pitch=pitch)
    section = wall.logs().section
    start = wall.start_depth
    for turn in range(len(section)):
        ends = sorted((start + turn * pitch, start + (turn + 1) * pitch))
        inside = (depth >= ends[0]) & (depth < ends[1]) if pitch > 0 else (depth > ends[0]) & (depth <= ends[1])
        for part in range(PARTS):
            away = np.abs((toolface - part * 360 / PARTS + 180) % 360 - 180)
            values = radius[inside & (away < 180 / PARTS)]
            assert section[turn, part] == pytest.approx(values.mean() if values.size else math.nan, nan_ok=True)


@pytest.mark.parametrize(("per_turn", "pipe", "deep", "known"), [
    (64, 0.0889, 0.010, True), (64, 0.1651, 0.030, True), (24, 0.127, 0.025, True), (24, 0.0889, 0.010, False),
    (8, 0.127, 0.025, False),
])  # fmt: skip
def test_the_pipe_of_a_slot_is_known_where_samples_show_it(
    per_turn: int, pipe: float, deep: float, known: bool
) -> None:
    rng = np.random.default_rng(5)
    turns = np.arange(2 * 10 * per_turn) / per_turn
    toolface = 360 * turns + rng.uniform(-2, 2, turns.size)
    centre = BIT / 2 + deep - pipe / 2
    angle = np.radians(toolface - 130)
    left = np.maximum((pipe / 2) ** 2 - (centre * np.sin(angle)) ** 2, 0)
    radius = np.maximum(BIT / 2, np.where((left > 0) & (np.cos(angle) > 0), centre * np.cos(angle) + np.sqrt(left), 0))
    samples = hb.Caliper(turns / 10, toolface, radius + rng.normal(0, 0.0005, turns.size))
    (zone,) = hb.reconstruct(samples, bit_diameter=BIT).zones().zones
    assert zone.kind == "key seat"
    assert math.isnan(zone.pipe_diameter) == (not known)
    assert not known or zone.pipe_diameter == pytest.approx(pipe, abs=0.004)
