"""Kriging with near and far neighbours: against a brute-force reference, its laws, and few or equal samples."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import pytest
from reference import Floats, exactly, random_hole

import helibore as hb

BIT = 0.216
TWO = (0.11, 1e-7, 4e-7, 0.05, 0.06, 9e-6, 0.1, 1.5)
THREE = (0.11, 1e-6, 1e-6, 0.2, 0.1, 4e-6, 0.05, 0.3, 1e-6, 0.01, 0.02)
ONE = (0.1, 1e-8, 4e-6, 0.08, 0.2)
TURNING = (*TWO, 12.5)
NOISY = (0.11, 8e-6, 2e-6, 0.02, 0.08, 9e-7, 0.1, 0.4)
NOISY_TURNING = (0.11, 8e-6, 2e-6, 0.03, 0.06, 1e-5, 0.1, 3.0, 40.0)
REPEATING = (0.11, 1e-7, 4e-7, 0.05, 0.06, 9e-6, -0.1, 1.5)
SMOOTH = (0.11, 8e-6, 2e-6, -0.03, 0.1, 9e-7, 0.1, 0.4)
STRETCHES = (
    *(1000.5, 0.108, 1e-7, 4e-7, 0.05, 0.06, 9e-6, 0.1, 1.5, 0.0, 1.0, 1.0, 0.0),
    *(1001.2, 0.13, 4e-7, 3e-6, -0.03, 0.05, 4e-5, -0.1, 0.6, 0.0, 1.0, 1.0, 12.5),
    *(1001.3, 0.115, 8e-6, 2e-6, 0.02, 0.08, 9e-7, 0.1, 0.4, 1e-6, 0.01, 0.02, 0.0),
)
"""Of random holes, which begin at 1000 m; the second is shorter than a turn."""
OTHERS = (0.3, *TURNING, 0.2, *REPEATING, -20.0, 0.1, *NOISY, 0.0)


def near_and_far(columns: tuple[Floats, ...], **settings: Any) -> hb.Wall:
    settings = {"covariance": TWO, "sectors": 20, "pitch": 0.25} | settings
    return hb.reconstruct(hb.Caliper(*columns), bit_diameter=BIT, estimator="near-and-far", **settings)


def arcs(toolface: Floats, at: Floats, radius: float) -> Floats:
    return np.asarray(np.radians(np.abs((toolface - at + 180.0) % 360.0 - 180.0)) * radius)


def cells_of(depth: Floats, toolface: Floats, radius: float, size: tuple[float, float], turn: float) -> list[list[int]]:
    """The samples of each cell of a size around and along, sample by sample."""
    columns = int(np.ceil(2.0 * np.pi * radius / size[0]))
    cells: dict[tuple[int, int], list[int]] = {}
    for row, (at, angle) in enumerate(zip(depth, (toolface - turn * depth) % 360.0, strict=True)):
        cell = int(np.floor(at / size[1])), min(int(angle * (columns / 360.0)), columns - 1)
        cells.setdefault(cell, []).append(row)
    return list(cells.values())


def reference(columns: tuple[Floats, ...], wall: hb.Wall) -> tuple[Floats, Floats, Floats, Floats]:
    """Radius, variance, scatter and number of neighbours of each vertex, by its stretch or all likely covariances."""
    assert wall.settings.covariance is not None
    if wall.settings.stretches:
        above = (-np.inf, *wall.settings.covariance, 0.0, 1.0, 1.0, 0.0)
        stretches = np.reshape((*above, *wall.settings.stretches), (-1, 13))
        starts, levels = stretches[:, 0], stretches[:, [2, 3, 6, 9]].sum(axis=1)
        found = [np.zeros(len(wall)) for _ in range(4)]
        for number, (_, at, *values) in enumerate(stretches.tolist()):
            more = np.maximum(levels - levels[number], 0.0) + (stretches[:, 1] - at) ** 2
            drift = np.maximum(levels, levels[number]) / 0.04
            ends = np.append(starts, np.inf)[number : number + 2]
            kept = (at, *(values[:10] if values[7] else values[:7]), values[10])
            there = np.searchsorted(starts, wall.depth, side="right") - 1 == number
            for to, of in zip(found, by_one(columns, wall, kept, (starts, more, drift, ends)), strict=True):
                to[there] = of[there]
        return found[0], found[1], found[2], found[3]
    others = np.reshape(wall.settings.other_turns or (), (-1, 10)).tolist()
    shares = np.array([1.0 - sum(share for share, *_ in others), *(share for share, *_ in others)])
    each = [by_one(columns, wall, of) for of in (wall.settings.covariance, *(values for _, *values in others))]
    radius = sum(share * of[0] for share, of in zip(shares, each, strict=True))
    variance = sum(share * (of[1] + (of[0] - radius) ** 2) for share, of in zip(shares, each, strict=True))
    scatter = sum(share * of[2] for share, of in zip(shares, each, strict=True))
    return np.asarray(radius), np.asarray(variance), np.asarray(scatter), each[0][3]


def by_one(
    columns: tuple[Floats, ...], wall: hb.Wall, given: Sequence[float], more: tuple[Floats, ...] | None = None
) -> tuple[Floats, ...]:
    """Radius, variance, scatter and number of neighbours of each vertex, from all samples, by the bordered system."""
    depth, toolface, radius = (column[np.lexsort(columns[1::-1])] for column in columns)
    settings = wall.settings
    at, noise, *values = given
    turns = values.pop() if len(values) % 3 else 0.0
    repeats = len(values) > 3 and values[4] < 0.0
    smooth = values[1] < 0.0
    terms = [(values[i], abs(values[i + 1]), values[i + 2]) for i in range(0, len(values), 3)]
    limit = settings.max_distance or np.inf

    def covariance(turn: Floats, along: Floats) -> Floats:
        turned = np.radians(turn - turns * along)
        chords = [2.0 * at * np.sin(turned / 2.0)] * len(terms)
        if repeats:
            chords[1] = at * np.sin(turned)
        squares = zip(chords, terms, strict=True)
        a = [np.sqrt(3.0 * ((chord / term[1]) ** 2 + (along / term[2]) ** 2)) for chord, term in squares]
        shapes = [(1.0 + x) * np.exp(-x) for x in a]
        if smooth:
            shapes[0] = np.exp(-(a[0] ** 2) / 6.0)
        return np.asarray(sum(term[0] * shape for term, shape in zip(terms, shapes, strict=True)))

    def differing(first: Floats, angles: Floats, down: Floats, value: Floats, single: Floats) -> Floats:
        added, alone = np.zeros(value.size), np.flatnonzero(single)
        for row in alone:
            others = alone[np.abs(first[alone] - first[row]) > 8]
            along = down[others] - down[row]
            across = arcs(angles[others] - turns * along, angles[row], at) * terms[0][2] / terms[0][1]
            beside = value[others[np.lexsort((others, across**2 + along**2))[:8]]]
            if beside.size < 8:
                continue
            low, high = np.sort(beside)[[1, -2]]
            if max(value[row] - high, low - value[row]) > 2.5 * np.sqrt(noise):
                added[row] = (value[row] - (low + high) / 2) ** 2
        return added

    def kriged(
        near: list[int], means: list[list[int]], middle_of: Floats, place: float, angle: float
    ) -> tuple[float, float, float, int]:
        if not (np.hypot(arcs(toolface[near], angle, at), depth[near] - place) <= limit).any():
            return np.nan, np.nan, np.nan, 0
        members = sorted([[row] for row in near] + means)
        count, n = np.array([len(of) for of in members]), len(members)
        down = np.array([depth[of].mean() for of in members])
        value = np.array([radius[of].mean() for of in members])
        turned = [
            (toolface[of] - toolface[of[0]] - turns * (depth[of] - depth[of[0]]) + 180) % 360 - 180 for of in members
        ]
        angles = np.array(
            [
                toolface[of[0]] + off.mean() + turns * (middle - depth[of[0]])
                for of, off, middle in zip(members, turned, down, strict=True)
            ]
        )
        matrix = np.ones((n + 1, n + 1))
        matrix[n, n] = 0.0
        first = np.array([of[0] for of in members])
        added = differing(first, angles, down, value, count == 1) if settings.robust else np.zeros(n)
        if more:
            where = np.searchsorted(more[0], depth[first], side="right") - 1
            away = np.maximum(np.maximum(more[3][0] - depth[first], depth[first] - more[3][1]), 0.0)
            added += more[1][where] + more[2][where] * away**2
        matrix[:n, :n] = covariance(angles[:, None] - angles, down[:, None] - down) + np.diag(noise / count + added)
        toward = np.append(covariance(angles - angle, down - place), 1.0)
        weights = np.linalg.solve(matrix, toward)
        variance = sum(term[0] for term in terms) - weights @ toward
        low, half = value.min(), 0.5 * np.ptp(value)
        root = np.linalg.cholesky(matrix[:n, :n])
        one, of_value = np.linalg.solve(root, np.ones(n)), np.linalg.solve(root, value)
        off = of_value - (one @ of_value) / (one @ one) * one
        apart = np.hypot(arcs(angles, middle_of[1], at), down - middle_of[0])
        shares = 0.09 / (0.09 + apart**2)
        scatter = (3.0 + shares @ off**2) / (3.0 + shares.sum())
        return np.clip(weights[:n] @ value, low - half, low + 3.0 * half), variance, scatter, n

    long = terms[min(1, len(terms) - 1)]
    noisy = noise > 0.25 * long[0]
    share, averaged, wanted = (0.25, 32, (3 * settings.neighbors + 1) // 2) if noisy else (0.35, 1, settings.neighbors)
    cells = cells_of(depth, toolface, at, (share * long[1], share * long[2]), turns)
    near = (3 * settings.neighbors + 7) // 8
    places = np.column_stack([wall.depth, wall.toolface])
    assert len(places) % 8 == 0

    def nearest(across: Floats, along: Floats, term: tuple[float, ...], of: Floats, count: int) -> set[int]:
        within = of & (np.hypot(across, along) <= limit)
        square = np.where(within, (across / term[1]) ** 2 + (along / term[2]) ** 2, np.inf)
        return set(np.argsort(square, kind="stable")[: min(count, within.sum())].tolist())

    found = []
    for group in places.reshape(-1, 8, 2):
        rows: set[int] = set()
        for place, angle in group:
            away = arcs(toolface, angle, at), np.abs(depth - place)
            every = np.full(depth.size, True)
            rows |= nearest(*away, terms[0], every, near)
            rows |= nearest(*away, long, every, (near + 1) // 2 if repeats else near)
            if repeats:
                found_opposite = nearest(arcs(toolface, angle + 180.0, at), away[1], long, every, (near + 1) // 2)
                rows |= {row for row in found_opposite if np.hypot(away[0][row], away[1][row]) <= limit}
        center = group[0, 1] + 3.5 * 360.0 / settings.sectors
        turned = toolface - turns * (depth - group[:, 0].mean())
        across = np.maximum(arcs(turned, center, at) - np.radians(3.5 * 360.0 / settings.sectors) * at, 0.0)
        along = np.maximum(np.abs(depth - group[:, 0].mean()) - np.ptp(group[:, 0]) / 2, 0.0)
        left = [[row for row in cell if row not in rows] for cell in cells]
        of_first = {cell[0]: cell[:averaged] for cell in left if cell}
        leads = np.isin(np.arange(depth.size), list(of_first)) & (np.hypot(across, along) <= limit)
        if repeats:
            turn = np.minimum(arcs(turned, center, at), arcs(turned, center + 180.0, at))
            across = np.maximum(turn - np.radians(3.5 * 360.0 / settings.sectors) * at, 0.0)
        far = nearest(across, along, long, leads, wanted)
        means = [of_first[row] for row in sorted(far)]
        found += [kriged(sorted(rows), means, group[4], place, angle) for place, angle in group]
    return tuple(np.array(found).T)


CASES: list[dict[str, Any]] = [
    {"shape": "round", "n": 900, "length": 3.0},
    {"shape": "oval", "n": 1500, "length": 6.0, "covariance": THREE},
    {"shape": "spiral", "n": 700, "length": 9.0, "covariance": ONE, "neighbors": 21},
    {"shape": "broken", "n": 120, "length": 30.0, "max_distance": 0.3, "neighbors": 12},
    {"shape": "washed", "n": 60, "length": 12.0, "max_distance": None},
    {"shape": "washed", "n": 400, "length": 4.0, "neighbors": 1, "max_distance": 5.0},
    {"shape": "spiral", "n": 900, "length": 30.0, "covariance": TURNING, "max_distance": 10.0},
    {"shape": "oval", "n": 300, "length": 5.0, "covariance": (*ONE, -300.0)},
    {"shape": "spiral", "n": 6000, "length": 3.0, "covariance": NOISY},
    {"shape": "oval", "n": 9000, "length": 6.0, "covariance": NOISY_TURNING, "neighbors": 21, "max_distance": 2.0},
    {"shape": "broken", "n": 500, "length": 8.0, "covariance": (0.1, 1e-5, 4e-6, 0.08, 0.4), "max_distance": None},
    {"shape": "oval", "n": 900, "length": 9.0, "covariance": REPEATING, "max_distance": 5.0},
    {"shape": "broken", "n": 500, "length": 5.0, "covariance": (*REPEATING, 12.5), "max_distance": 0.3},
    {"shape": "oval", "n": 300, "length": 5.0, "covariance": (*REPEATING, 1e-6, 0.01, 0.02), "neighbors": 21},
    {"shape": "broken", "n": 900, "length": 6.0, "other_turns": OTHERS, "max_distance": 2.0},
    {"shape": "oval", "n": 5000, "length": 4.0, "covariance": (*THREE, 3.0), "other_turns": OTHERS[:10]},
    {"shape": "spiral", "n": 6000, "length": 3.0, "covariance": SMOOTH},
    {"shape": "oval", "n": 900, "length": 4.0, "covariance": (0.11, 1e-6, 3e-6, -0.05, 0.2)},
    {"shape": "broken", "n": 900, "length": 4.0, "covariance": (*SMOOTH, 12.5), "max_distance": 2.0},
    {"shape": "broken", "n": 900, "length": 4.0, "robust": True},
    {"shape": "oval", "n": 900, "length": 30.0, "covariance": TURNING, "max_distance": 10.0, "robust": True},
    {"shape": "spiral", "n": 3000, "length": 3.0, "covariance": NOISY, "robust": True},
    {"shape": "washed", "n": 40, "length": 9.0, "neighbors": 1, "robust": True},
    {"shape": "broken", "n": 900, "length": 4.0, "stretches": STRETCHES, "max_distance": 2.0},
    {"shape": "oval", "n": 6000, "length": 3.0, "stretches": STRETCHES, "robust": True},
]


@pytest.mark.parametrize("case", CASES, ids=lambda case: f"{case['shape']}-{CASES.index(case)}")
def test_agrees_with_the_reference(case: dict[str, Any]) -> None:
    settings = {name: value for name, value in case.items() if name not in ("shape", "n", "length")}
    columns = random_hole(40 + CASES.index(case), case["shape"], case["n"], case["length"])
    wall = near_and_far(columns, sigma=True, **settings)
    wall = near_and_far(
        columns, sigma=True, **settings, start_depth=wall.start_depth, stop_vertex=len(wall) // 8 * 8,
    )  # fmt: skip
    radius, variance, scatter, support = reference(columns, wall)
    np.testing.assert_array_equal(wall.support, support)
    np.testing.assert_allclose(wall.radius, radius, rtol=0, atol=1e-8)
    np.testing.assert_allclose(wall._core.sums()[0] ** 0.5, variance**0.5, rtol=0, atol=1e-7)
    np.testing.assert_allclose(wall._core.sums()[1], scatter, rtol=1e-6)


SPLITS = [{}, {"covariance": THREE}, {"max_distance": 4.0, "neighbors": 5}, {"max_distance": None}, {"pitch": -0.25}]
SPLITS += [{"covariance": TURNING, "max_distance": 3.0}, {"covariance": REPEATING, "max_distance": 3.0}]
SPLITS += [
    {"covariance": NOISY},
    {"covariance": SMOOTH},
    {"covariance": NOISY_TURNING},
    {"other_turns": OTHERS, "max_distance": 2.0},
    {"robust": True, "max_distance": 3.0},
    {"stretches": STRETCHES, "max_distance": 3.0},
]


@pytest.mark.parametrize("settings", SPLITS, ids=str)
def test_any_split_threads_and_instructions_give_the_same_bits(settings: dict[str, Any]) -> None:
    rng = np.random.default_rng(7)
    depth, toolface, radius = random_hole(8, "spiral", 6000 if "covariance" in settings else 1200, 8.0)
    time = rng.random(depth.size)
    given = {"bit_diameter": BIT, "estimator": "near-and-far", "covariance": TWO, "sectors": 20, "pitch": 0.25}
    given |= {"start_depth": float(depth.max() if settings.get("pitch") else depth.min())} | settings
    whole = hb.Wall(**given, threads=1, instruction_set="plain")
    whole.append(depth, toolface, radius, time)
    parts = hb.Wall(**given, threads=3)
    before = np.empty(0)
    for rows in np.array_split(rng.permutation(depth.size), 6):
        change = parts.append(depth[rows], toolface[rows], radius[rows], time[rows])
        changed = np.ones(len(parts), dtype=bool)
        same = min(before.size, len(parts))
        now = parts.radius
        changed[:same] = ~((now[:same] == before[:same]) | (np.isnan(now[:same]) & np.isnan(before[:same])))
        told = np.zeros(len(parts), dtype=bool)
        for start, stop in change.ranges:
            told[start:stop] = True
        assert not np.any(changed & ~told)
        before = now
    for name in ("radius", "nearest", "support", "sigma"):
        np.testing.assert_array_equal(getattr(parts, name), getattr(whole, name))


LONG = (0.11, 1e-7, 4e-7, 0.05, 0.06, 9e-6, 0.15, 8.0)
LONG_NOISY = (0.11, 8e-6, 2e-6, 0.02, 0.08, 9e-7, 0.3, 24.0)
DEEPER = [
    {"covariance": TWO},
    {"covariance": LONG},
    {"covariance": NOISY},
    {"covariance": LONG_NOISY, "robust": True},
    {"covariance": LONG, "other_turns": (0.3, *LONG, 12.5)},
    {"covariance": LONG, "stretches": STRETCHES},
    {"covariance": LONG, "pitch": -0.25},
]


@pytest.mark.parametrize("settings", DEEPER, ids=str)
def test_a_few_samples_at_a_time_while_the_hole_gets_deeper_give_the_same_bits(settings: dict[str, Any]) -> None:
    """Vertices far above change only where a sample is among the first of its cell."""
    draw = np.random.default_rng(11)
    columns = np.column_stack([*random_hole(11, "spiral", 700, 8.0), np.zeros(700)])
    columns[:, 0] = np.round(columns[:, 0], 2)  # several at one depth, some of them in one append
    columns[:, 3] = np.arange(700)
    columns = columns[np.argsort(columns[:, 0], kind="stable")]
    start = float(columns[:, 0].max() if settings.get("pitch") else columns[:, 0].min())
    given = {"bit_diameter": BIT, "estimator": "near-and-far", "sectors": 20, "pitch": 0.25, "start_depth": start}
    given |= {"max_distance": 20.0} | settings
    whole, parts = hb.Wall(**given), hb.Wall(**given)
    whole.append(*columns.T)
    for rows in np.split(columns, np.cumsum(draw.choice([1, 2, 5], 400))):
        parts.append(*rows.T)
    for name in ("radius", "nearest", "support", "sigma"):
        np.testing.assert_array_equal(getattr(parts, name), getattr(whole, name))


def test_nothing_above_settled_changes_while_the_hole_gets_deeper() -> None:
    depth, toolface, radius = random_hole(9, "oval", 2000, 10.0)
    order = np.argsort(depth, kind="stable")
    wall = near_and_far(
        tuple(column[:0] for column in (depth, toolface, radius)), start_depth=float(depth.min()), max_distance=1.5
    )
    kept, settled = np.empty(0), 0
    for rows in np.array_split(order, 8):
        change = wall.append(depth[rows], toolface[rows], radius[rows])
        np.testing.assert_array_equal(wall.radius[:settled], kept[:settled])
        kept, settled = wall.radius, change.settled
    assert settled > len(wall) / 2


@pytest.mark.parametrize("given", [{}, {"other_turns": OTHERS}, {"stretches": STRETCHES}], ids=str)
def test_samples_within_reach_decide_a_part(given: dict[str, Any]) -> None:
    columns = random_hole(10, "round", 1500, 12.0)
    start = float(columns[0].min())
    wall = near_and_far(columns, start_depth=start, max_distance=2.0, **given)
    first, stop = 420, 600  # 420: within a group of eight
    shallow, deep = wall.reach(first, stop)
    some = (columns[0] >= shallow) & (columns[0] <= deep)
    assert some.mean() < 0.9
    part = near_and_far(
        tuple(column[some] for column in columns), start_depth=start, max_distance=2.0, first_vertex=first,
        stop_vertex=stop, **given,
    )  # fmt: skip
    np.testing.assert_array_equal(part.radius, wall.radius[first:stop])


DEGENERATE = {
    "one sample": ([1.0], [0.0], [0.1]),
    "equal positions": ([1.0] * 40, [10.0] * 40, [0.1, 0.12] * 20),
    "one line along the hole": (np.linspace(0, 2, 40), [10.0] * 40, np.linspace(0.1, 0.12, 40)),
    "one depth": ([1.0] * 600, np.arange(600) * 0.6, [0.1, 0.12] * 300),
}


@pytest.mark.parametrize("covariance", [TWO, NOISY], ids=["samples", "means"])
@pytest.mark.parametrize("name", DEGENERATE)
def test_degenerate_neighbourhoods_have_a_radius_and_a_constant_stays(name: str, covariance: tuple[float, ...]) -> None:
    columns = tuple(np.asarray(of, dtype=float) for of in DEGENERATE[name])
    wall = near_and_far(columns, sectors=8, start_depth=0.5, stop_depth=1.5, covariance=covariance)
    assert np.isfinite(wall.radius).any()
    half = np.ptp(columns[2]) / 2
    reached = wall.support > 0
    assert np.all((wall.radius >= columns[2].min() - half)[reached])
    assert np.all((wall.radius <= columns[2].max() + half)[reached])
    constant = near_and_far((*columns[:2], np.full(columns[0].size, 0.1234567)), sectors=8, covariance=covariance)
    assert np.all(constant.radius == 0.1234567)


@pytest.mark.parametrize(
    "settings",
    [{}, {"covariance": NOISY}, {"other_turns": OTHERS}, {"robust": True}, {"stretches": STRETCHES}],
    ids=["samples", "means", "likely", "robust", "stretches"],
)
def test_values_carried_with_the_samples_are_kriged_like_the_radius(settings: dict[str, Any]) -> None:
    columns = random_hole(11, "oval", 3000, 4.0)
    wall = near_and_far(columns, **settings)
    again = wall.interpolate_samples(wall.samples.radius, on="vertices")
    np.testing.assert_allclose(again, wall.radius, rtol=0, atol=1e-12)
    values = wall.samples.radius.copy()
    values[::7] = np.nan
    assert np.isfinite(wall.interpolate_samples(values, on="vertices")[wall.support > 0]).all()


def test_a_robust_wall_hardly_follows_a_spike_and_stays_as_it_is_without_one() -> None:
    depth, toolface, radius = random_hole(13, "round", 4000, 2.0)
    radius = 0.11 + 1e-4 * np.random.default_rng(1).normal(size=radius.size)
    spiked = radius.copy()
    spiked[::40] += 0.02
    walls = [near_and_far((depth, toolface, of), robust=robust) for of in (radius, spiked) for robust in (False, True)]
    off = [np.abs(wall.radius - 0.11) for wall in walls]
    assert off[2].max() > 2e-3
    assert off[3].max() < 4e-4
    assert np.sqrt(np.mean(off[1] ** 2)) < 1.05 * np.sqrt(np.mean(off[0] ** 2))


def test_a_robust_wall_hardly_follows_eight_bad_samples_in_a_row() -> None:
    depth, toolface = np.arange(3200) * (0.02 / 32), np.arange(3200) * 11.25 % 360.0
    radius = 0.11 + 1e-4 * np.random.default_rng(1).normal(size=depth.size)
    for first in range(100, 3100, 170):
        radius[first : first + 8] += 0.01
    off = [np.abs(near_and_far((depth, toolface, radius), robust=robust).radius - 0.11) for robust in (False, True)]
    assert off[0].max() > 5e-3
    assert off[1].max() < 5e-4


def test_samples_of_a_cell_lower_the_kriging_variance_where_noise_is_large() -> None:
    variances = []
    for count in (400, 4000):
        wall = near_and_far(random_hole(12, "round", count, 1.0), covariance=NOISY, neighbors=16, sigma=True)
        variances.append(np.nanmean(wall._core.sums()[0]))
    assert variances[1] < 0.6 * variances[0]


BAD = [
    ({"covariance": (0.1, 1e-7)}, "covariance = [0.1, 1e-07]: must have 5, 8 or 11 values, or a turn as one more"),
    ({"covariance": (0.1, 1e-7, 1e-6, 0.0, 0.1)}, "covariance[3] = 0: must lie in 0.0001 to 1000000"),
    ({"covariance": (0.1, 1e-7, 1e-6, 0.1, -0.1)}, "covariance[4] = -0.1: must lie in 0.0001 to 1000000"),
    ({"covariance": (0.1, np.nan, 1e-6, 0.1, 0.1)}, "covariance[1] = nan: must lie in 1e-14 to 100"),
    ({"covariance": (*ONE, -4000.0)}, "covariance[5] = -4000: must lie in -3600 to 3600 degrees a metre"),
    ({"covariance": ONE, "neighbors": 22}, "neighbors = 22: must lie in 1 to 21"),
    ({"covariance": ONE, "window": 5}, "window = 5: must not be given with near-and-far"),
    (
        {"covariance": TWO, "other_turns": (0.5, *TURNING, 0.5, *TURNING)},
        "other_turns[10] = 0.5: must be above 0, and the sum of shares below 1",
    ),
    (
        {"covariance": ONE, "other_turns": (0.5, *TURNING)},
        "other_turns[1] = 0.11: must be the radius of the covariance",
    ),
    (
        {"covariance": TWO, "other_turns": (0.2, *TURNING, 0.2, *TWO[:5], -1.0, *TURNING[6:])},
        "other_turns[16] = -1: must lie in 1e-14 to 100",
    ),
    (
        {"covariance": TWO, "stretches": STRETCHES, "other_turns": OTHERS},
        "stretches = 39: must not be given with other_turns",
    ),
    (
        {"covariance": TWO, "stretches": (*STRETCHES[13:26], *STRETCHES[:13])},
        "stretches[13] = 1000.5: must be below the stretch before",
    ),
    (
        {"covariance": TWO, "stretches": (*STRETCHES[:6], 0.0, *STRETCHES[7:])},
        "stretches[6] = 0: must lie in 1e-14 to 100",
    ),
    ({}, "covariance = 0: must have 5, 8 or 11 values, or a turn as one more"),
]


@pytest.mark.parametrize(("settings", "text"), BAD, ids=[text for _, text in BAD])
def test_bad_settings(settings: dict[str, Any], text: str) -> None:
    with pytest.raises(hb.InputError, match=exactly(text)):
        hb.Wall(bit_diameter=BIT, estimator="near-and-far", **settings)
