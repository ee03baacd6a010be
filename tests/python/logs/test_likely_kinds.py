"""The chain along a hole against matrices of transition; the library and the kind of a zone against NumPy.

Each section is compared by least squares.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import helibore as hb
from helibore import _core
from helibore.base.arrays import Floats, Integers
from helibore.base.errors import InputError
from helibore.base.units import INCH
from helibore.logs.likely_kinds import PARTS
from helibore.settings.zone_settings import CRITERIA_BIT, Criteria

# The numbers of cpp/include/helibore/kinds.hpp.
ROUGH, OFFSET, EFFECTIVE, TEMPER, CENTRE_STAYS = 1.6e-3, 7e-3, 24.0, 0.7, 20.0
SCALES = {1.0: 0.5, 1.6: 0.3, 2.6: 0.15, 4.2: 0.05}
PRIOR, ALONG_PRIOR = (0.4, 0.15, 0.15, 0.15, 0.15), (0.68, 0.1, 0.1, 0.06, 0.06)
EXPLAINED, RESEMBLES = 2.6, 0.35
LOBED = 0.01  # chance of a lobed section that is gauge; section_library.cpp
HEIGHT = 1.6  # metres; such a turn is a window of its own
FINE = 6 * PARTS  # toolfaces at which a section of the library is drawn
BIT = 0.2159


def limits_of(criteria: Criteria) -> tuple[float, float, float, float, float]:
    return criteria.elongation, criteria.washout, criteria.key_seat, criteria.undergauge, criteria.symmetry


def kind_probabilities(sections: Floats, bit: float, criteria: Criteria, even: bool) -> tuple[Floats, bool]:
    kinds, sound = _core.likely_kind(sections.ravel(), _core.section_library(bit, limits_of(criteria), even))
    return np.array(kinds), sound


class Belief(NamedTuple):
    """What the windows on one side say: probability of each section, the tool's centre then, and its covariance."""

    likely: Floats
    centre: Floats
    spread: Floats


def compared(window: Floats, sections: Floats, before: Belief) -> tuple[Floats, Belief]:
    """Return the logs of the evidence of a window for each section, and the belief without it.

    The centre is found by least squares, from the parts that are seen and from where it was before.
    """
    seen = np.flatnonzero(np.isfinite(window))
    if not seen.size:
        return np.zeros(len(sections)), before
    count = min(seen.size, EFFECTIVE)
    root = np.sqrt(count / seen.size) / ROUGH
    angle = seen * 2 * np.pi / PARTS
    own = np.linalg.cholesky(np.linalg.inv(before.spread)).T
    rows = np.vstack([root * np.column_stack([np.cos(angle), np.sin(angle)]), own])
    off = np.column_stack([root * (window - sections)[:, seen], before.centre @ own.T])
    centre = np.linalg.lstsq(rows, off.T, rcond=None)[0].T
    square = ((off - centre @ rows.T) ** 2).sum(axis=1)
    logs = [np.log(share) - count * np.log(scale) - square / (2 * scale**2) for scale, share in SCALES.items()]
    return np.max(logs, axis=0), Belief(before.likely, centre, np.linalg.inv(rows.T @ rows))


def tempered(likely: Floats, logs: Floats) -> Floats:
    found = likely * np.exp(np.maximum(TEMPER * (logs - logs.max()), -60))
    return np.asarray(found / found.sum())


def beliefs(
    windows: Floats, sections: Floats, kind: Integers, length: float, chance: Floats
) -> Iterator[tuple[Belief, Belief]]:
    """Yield the beliefs before and with each window, by matrices of transition."""
    stays = 0.8**length
    changes = 0.1 * (1 - stays)
    share = chance / np.bincount(kind, chance, 5)[kind]
    prior = np.array(ALONG_PRIOR)[kind] * share
    moves = changes * (kind[:, None] == kind) * share + (1 - stays - changes) * prior
    keeps = np.exp(-length / CENTRE_STAYS)
    before = Belief(prior, np.zeros((len(kind), 2)), OFFSET**2 * np.eye(2))
    for window in windows:
        logs, now = compared(window, sections, before)
        now = now._replace(likely=tempered(now.likely, logs))
        yield before, now
        stayed, moved = stays * now.likely, now.likely @ moves
        mean = now.likely @ now.centre
        centre = (stayed[:, None] * now.centre + moved[:, None] * mean) / (stayed + moved)[:, None]
        before = Belief(stayed + moved, keeps * centre, keeps**2 * now.spread + (1 - keeps**2) * OFFSET**2 * np.eye(2))


def reference(
    windows: Floats, sections: Floats, kind: Integers, size: Floats, length: float = HEIGHT,
    chance: Floats | None = None,
) -> tuple[Floats, Floats, Floats]:  # fmt: skip
    """Return the probabilities of the kinds, mean and standard deviation of the size, which do not know of chances.

    Where the chains from both sides have the centre of a section apart, it is less likely: by the integral over the
    centre of both normal densities, divided by that of the prior.
    """
    chance = np.ones(kind.size) if chance is None else chance
    without = np.bincount(kind, chance, 5)[kind] / np.bincount(kind, minlength=5)[kind] / chance
    prior = np.array(ALONG_PRIOR)[kind] * chance / np.bincount(kind, chance, 5)[kind]
    down = [with_it for _, with_it in beliefs(windows, sections, kind, length, chance)]
    up = [before for before, _ in beliefs(windows[::-1], sections, kind, length, chance)][::-1]
    both = []
    for above, below in zip(down, up, strict=True):
        a, b = np.linalg.inv(above.spread), np.linalg.inv(below.spread)
        toward = above.centre @ a + below.centre @ b
        joint = np.linalg.inv(a + b - np.eye(2) / OFFSET**2)
        apart = sum(((x @ m) * x).sum(axis=1) for x, m in ((above.centre, a), (below.centre, b), (toward, -joint)))
        both.append(tempered(above.likely * below.likely / prior, -0.5 * apart))
    likely = np.array(both)
    sized = likely * without / (likely @ without)[:, None]
    mean = sized @ size
    sigma = np.sqrt((sized * (size - mean[:, None]) ** 2).sum(axis=1))
    return np.array([likely[:, kind == code].sum(axis=1) for code in range(5)]).T, mean, sigma


def core(
    windows: Floats, sections: Floats, kind: Integers, size: Floats, threads: int = 1, height: float = HEIGHT,
    chance: Floats | None = None,
) -> tuple[Floats, ...]:  # fmt: skip
    a, b, c, d, e = np.bincount(kind, minlength=5).tolist()
    library = (sections.ravel(), (a, b, c, d, e), size, np.ones(size.size), np.empty(0) if chance is None else chance)
    kinds, _, mean, sigma = _core.kinds_along(windows.ravel(), height, np.ones(len(windows)), library, threads)
    return kinds.reshape(-1, 5), mean, sigma


def made(seed: int, counts: tuple[int, ...], steps: int, seen: float) -> tuple[Floats, Floats, Integers, Floats]:
    rng = np.random.default_rng(seed)
    kind = np.repeat(np.arange(5), counts)
    sections = rng.normal(0, 4e-3, (kind.size, PARTS))
    windows = sections[rng.integers(0, kind.size, steps)] + rng.normal(0, 2e-3, (steps, PARTS))
    windows[rng.random(windows.shape) > seen] = np.nan
    return windows, sections, kind, rng.normal(0, 1e-3, kind.size)


def library(bit: float, criteria: Criteria, even: bool) -> tuple[Floats, Integers, Floats]:
    """Return all sections in all directions, their kinds and mean squared radii."""
    fine, lower, higher = drawn(bit)
    diameter = bit + fine[:, : FINE // 2] + fine[:, FINE // 2 :]
    row, largest = np.arange(len(fine)), diameter.argmax(axis=1)
    c1, c2 = diameter[row, largest], diameter[row, (largest + FINE // 4) % (FINE // 2)]
    if even:  # a diameter does not show on which side a hole is wide
        lower = higher = (lower + higher) / 2
    both = (lower > 0) & (2 * lower >= criteria.symmetry * (lower + higher))
    kind = np.zeros(len(fine), dtype=np.int64)
    kind[both & (c1 - c2 >= criteria.elongation)] = 2
    kind[~both & (higher >= criteria.key_seat)] = 3
    kind[c2 - bit >= criteria.washout] = 1
    kind[diameter.min(axis=1) < bit - criteria.undergauge] = 4
    first = len(kind) % PARTS  # after the round ones, each section comes in all directions
    kind[first:] = np.repeat(kind[first::PARTS], PARTS)
    part = (np.arange(FINE) * PARTS + FINE // 2) // FINE % PARTS
    into = (part[:, None] == np.arange(PARTS)).astype(np.float64)
    shapes = fine @ (into / into.sum(axis=0))
    size = np.mean((bit / 2 + fine) ** 2, axis=1)
    return (shapes + np.roll(shapes, PARTS // 2, axis=1)) / 2 if even else shapes, kind, size


def drawn(bit_diameter: float) -> tuple[Floats, Floats, Floats]:
    """Return radii less half the bit diameter, (m, FINE), and the heights of the lower and the higher lobe, metres."""
    mm = 1e-3 * bit_diameter / CRITERIA_BIT
    degrees = np.arange(FINE) * 360 / FINE
    angle = np.radians(degrees)
    away = np.abs((degrees + 180) % 360 - 180)
    rounded = [(np.full(FINE, size), 0.0, 0.0) for size in
               (-11, -8, -6, -4.5, -2.5, -1.2, 0, 1.2, 2.5, 4, 8, 11, 15, 20, 27, 36, 48)]  # fmt: skip
    turned = [(size + half * np.cos(2 * angle), 0.0, 0.0) for size in (0, 2) for half in (1.5, 3, 4.5)]
    turned += [(size + 2 * np.cos(2 * angle), 0.0, 0.0) for size in (-8, -5)]
    turned += [
        (size * (1 + share * np.cos(waves * angle)), 0.0, 0.0)
        for size in (9, 14, 21, 30) for waves in (2, 3) for share in (0.15, 0.3)
    ]  # fmt: skip
    for wide in (30, 45, 65):
        smooth = np.cos(np.radians(np.minimum(90 * away / wide, 90))) ** 2
        for lobe in (smooth, np.clip(2.2 * (1 - away / wide), 0, 1)):
            for base in (0, 1.5):
                for high in (5, 9, 14, 19, 26, 35):
                    turned += [
                        (base + high * (lobe + share * np.roll(lobe, FINE // 2)), share * high, high)
                        for share in (0.65, 1)
                    ]
                turned += [(base + high * lobe, 0.0, high) for high in (3.5, 5, 8, 12, 18, 26, 36, 47, 58, 70)]
    bit = 500 * CRITERIA_BIT
    for pipe in (1750 * INCH, 2500 * INCH, 3250 * INCH):  # radius, mm
        for deep in (5, 9, 14, 20, 28, 38, 48, 58, 70):
            centre = bit + deep - pipe
            left = np.maximum(pipe**2 - (centre * np.sin(angle)) ** 2, 0)
            reach = np.where((left > 0) & (np.cos(angle) > 0), centre * np.cos(angle) + np.sqrt(left), 0)
            turned.append((np.maximum(reach - bit, 0), 0.0, deep))
    turns = (np.arange(FINE) - np.arange(0, FINE, FINE // PARTS)[:, None]) % FINE
    shapes, lower, higher = (np.array(column) for column in zip(*rounded, *turned, strict=True))
    every = np.concatenate([shapes[: len(rounded)], shapes[len(rounded) :, turns].reshape(-1, FINE)])
    times = np.repeat([1, len(turns)], [len(rounded), len(turned)])
    return mm * every, mm * np.repeat(lower, times), mm * np.repeat(higher, times)


def squares_of(sections: Floats, shapes: Floats) -> tuple[Floats, Floats]:
    """Return chi^2 of all sections and shapes, what least squares leave, by a matrix that projects, and their parts."""
    squares, counts = np.empty((len(sections), len(shapes))), np.empty(len(sections))
    for row, section in enumerate(sections):
        seen = np.flatnonzero(np.isfinite(section))
        counts[row] = min(seen.size, EFFECTIVE)
        root = np.sqrt(counts[row] / seen.size) / ROUGH
        angle = seen * 2 * np.pi / PARTS
        offsets = np.vstack([root * np.column_stack([np.cos(angle), np.sin(angle)]), np.eye(2) / OFFSET])
        off = np.column_stack([root * (section - shapes)[:, seen], np.zeros((len(shapes), 2))])
        left = off - off @ offsets @ np.linalg.pinv(offsets)
        squares[row] = (left * left).sum(axis=1)
    return squares, counts


@pytest.mark.parametrize("even", [False, True])
@pytest.mark.parametrize("bit", [BIT, 0.104])
@pytest.mark.parametrize("limits", [{}, {"elongation": 0.01, "washout": 0.03, "key_seat": 0.02, "undergauge": 0.001}])
def test_the_library_is_the_one_drawn_with_numpy(bit, limits, even):
    criteria = Criteria(**limits)
    sections, counts, size, weight, chance = _core.section_library(bit, limits_of(criteria), even)
    sections, kind = sections.reshape(-1, PARTS), np.repeat(np.arange(5), counts)
    opposite = np.roll(sections[weight == 2], PARTS // 2, axis=1)
    np.testing.assert_array_equal(opposite, sections[weight == 2])
    assert not even or ((weight == 2) | (np.ptp(sections, axis=1) == 0)).all()
    every, kinds, sizes = library(bit, criteria, even)
    lobed, is_round = (kinds == 0) & (drawn(bit)[2] > 0), np.arange(len(kinds)) < len(kinds) % PARTS
    chances = np.where(is_round, PARTS, np.where(lobed, LOBED, 1.0))
    np.testing.assert_allclose(np.bincount(kind, weight * chance, 5), np.bincount(kinds, chances, 5), rtol=1e-12)
    assert np.bincount(kind, weight, 5).tolist() == np.bincount(kinds, minlength=5).tolist()
    for code in range(5):  # the same sections, in an order of their own
        found, wanted = (
            np.unique(np.column_stack([of, of_size]).round(9), axis=0)
            for of, of_size in (
                (sections[kind == code], size[kind == code]), (every[kinds == code], sizes[kinds == code]),
            )
        )  # fmt: skip
        assert abs(len(found) - len(wanted)) <= 0.02 * len(wanted)  # rounding may part two equal sections
        for a, b in ((found, wanted), (wanted, found)):
            nearest = [np.abs(b - row).max(axis=1).min() for row in a[:: max(len(a) // 60, 1)]]
            assert max(nearest, default=0.0) < 2e-9


@pytest.mark.parametrize("even", [False, True])
@pytest.mark.parametrize("seed", range(6))
def test_the_kind_of_a_zone_is_that_of_numpy(even, seed):
    criteria = Criteria()
    every, kinds, _ = library(BIT, criteria, even)
    rng = np.random.default_rng(seed)
    sections = every[rng.integers(len(every))] + rng.normal(0, 0.002 * (1 + 3 * (seed == 5)), (3, PARTS))
    sections[rng.random(sections.shape) > (0.2, 0.5, 1.0)[seed % 3]] = np.nan
    squares, counts = squares_of(sections, every)
    terms = np.array([np.log(share) - counts * np.log(scale) - squares.min(axis=1) / (2 * scale**2)
                      for scale, share in SCALES.items()])  # fmt: skip
    likely = sum(
        np.exp(term - terms.max(axis=0))[:, None] * np.exp((squares.min(axis=1)[:, None] - squares) / (2 * scale**2))
        for term, scale in zip(terms, SCALES, strict=True)
    )
    of_kinds = np.array([likely[:, kinds == code].sum(axis=1) / max((kinds == code).sum(), 1) for code in range(5)])
    total = np.log(PRIOR) + np.log(np.maximum(of_kinds, 1e-300)).mean(axis=1)
    misfit = squares / counts[:, None]
    if misfit[:, kinds == 0].min(axis=1).mean() > EXPLAINED**2:
        total[0] = -np.inf
    odds = np.exp(total - total.max())
    found, sound = kind_probabilities(sections, BIT, criteria, even)
    np.testing.assert_allclose(found, odds / odds.sum(), atol=1e-9)
    own = np.nanmean(sections**2) / ROUGH**2
    assert sound == (misfit.min(axis=1).mean() <= max(EXPLAINED**2, RESEMBLES**2 * own))


def test_a_zone_that_nothing_resembles_has_no_sound_kind():
    far = np.where(np.arange(PARTS) % 2, 0.06, -0.06)[None, :]
    assert not kind_probabilities(far, BIT, Criteria(), False)[1]
    assert kind_probabilities(np.full((1, PARTS), 0.001), BIT, Criteria(), False)[1]


@settings(max_examples=40)
@given(
    st.integers(0, 2**32), st.tuples(*[st.integers(0, 11)] * 5).filter(any), st.integers(1, 40), st.floats(0, 1)
)  # fmt: skip
def test_the_chain_equals_matrices_of_transition(seed, counts, steps, seen):
    windows, sections, kind, size = made(seed, counts, steps, seen)
    chance = np.random.default_rng(seed).choice([1.0, 0.1, 3.0], kind.size)
    kinds, mean, sigma = core(windows, sections, kind, size, chance=chance)
    prior, sized, spread = reference(windows, sections, kind, size, chance=chance)
    absent = np.array(counts) == 0
    np.testing.assert_allclose(kinds, prior, atol=1e-4)
    assert not kinds[:, absent].any()
    np.testing.assert_allclose(mean, sized, atol=1e-6)
    np.testing.assert_allclose(sigma, spread, atol=1e-5)


@pytest.mark.parametrize(("seen", "together"), [(0.6, 1), (0.25, 3), (0.02, 5)])
def test_turns_that_see_few_parts_are_taken_together(seen, together):
    turns, sections, kind, size = made(4, (4, 3, 2, 3, 2), 47, seen)
    windows = np.full((-(-47 // together), PARTS), np.nan)
    for row in range(len(windows)):
        for part in range(PARTS):
            values = turns[row * together : (row + 1) * together, part]
            if np.isfinite(values).any():
                windows[row, part] = values[np.isfinite(values)].mean()
    kinds, mean, _ = core(turns, sections, kind, size, height=0.1)
    prior, sized, _ = reference(windows, sections, kind, size, together * 0.1)
    np.testing.assert_allclose(kinds, np.repeat(prior, together, axis=0)[:47], atol=1e-4)
    np.testing.assert_allclose(mean, np.repeat(sized, together)[:47], atol=1e-6)


def test_the_result_does_not_depend_on_threads():
    windows, sections, kind, size = made(1, (9, 5, 8, 7, 3), 300, 0.4)
    one = core(windows, sections, kind, size)
    for threads in (2, 3):
        for a, b in zip(one, core(windows, sections, kind, size, threads), strict=True):
            np.testing.assert_array_equal(a, b)


@pytest.mark.parametrize("even", [False, True])
def test_libraries_that_are_kept_give_what_a_library_gives(even):
    criteria = Criteria(washout=0.01)
    windows, *_ = made(3, (9, 5, 8, 7, 3), 60, 0.5)
    kept = _core.SectionLibraries(BIT, limits_of(criteria))
    wanted = (np.arange(60) < 40).astype(np.float64)
    library = _core.section_library(BIT, limits_of(criteria), even)
    for _ in range(2):
        for a, b in zip(
            kept.kinds_along(windows.ravel(), 0.2, wanted, even, 2),
            _core.kinds_along(windows.ravel(), 0.2, wanted, library, 1),
            strict=True,
        ):
            np.testing.assert_array_equal(a, b)


def test_what_cannot_be_compared_is_refused():
    windows, sections, kind, size = made(2, (2, 2, 2, 2, 2), 3, 1)
    sections[3, 4] = np.nan
    with pytest.raises(InputError) as error:
        core(windows, sections, kind, size)
    assert (error.value.place, error.value.rule) == (f"sections[{3 * PARTS + 4}]", "must be finite")
    with pytest.raises(InputError) as error:
        core(windows, np.zeros((0, PARTS)), kind[:0], size[:0])
    assert error.value.place == "counts"
    with pytest.raises(InputError):
        core(windows[:, :-1], sections[:3], kind[:3], size[:3])


@settings(max_examples=10, deadline=None)
@given(turn=st.integers(0, 31), seed=st.integers(0, 9))
def test_probabilities_sum_to_one_and_do_not_depend_on_the_direction(turn: int, seed: int) -> None:
    section = np.random.default_rng(seed).normal(0.004, 0.004, (2, 32))
    section[:, 3:9] = np.nan
    likely, turned = (
        kind_probabilities(of, BIT, Criteria(), False)[0] for of in (section, np.roll(section, turn, axis=1))
    )
    assert likely.sum() == pytest.approx(1)
    np.testing.assert_allclose(turned, likely, atol=1e-6)


@pytest.mark.parametrize("share", [0.6, 0.74, 0.85, 0.95, 1.0, 1.16, 1.22, 1.3, 1.38, 1.4, 1.5, 2.0])
def test_a_likely_range_holds_the_diameter_of_a_round_hole_of_any_size_or_there_is_none(share: float) -> None:
    """Two arms see little of each turn, and the library has no section far from the bit: nothing is likely there."""
    depth = np.repeat(np.arange(1000.0, 1012.0, 0.1), 4)
    depth = depth[(depth < 1004) | (depth > 1006)]  # turns without a sample, too
    arm = np.tile([0, 1, 0, 1], depth.size // 4)
    toolface = (np.tile([0.0, 90.0, 180.0, 270.0], depth.size // 4) + 4 * (depth - 1000)) % 360
    caliper = hb.Caliper(depth, toolface, np.full(depth.size, share * BIT / 2), arm=arm)
    logs = hb.reconstruct(caliper, bit_diameter=BIT).logs()
    low, high = logs.diameter_range
    assert logs.sparse.any()
    assert np.all((low <= share * BIT + 1e-9) & (high >= share * BIT - 1e-9) | np.isnan(low))
    assert np.any(low < high) == (0.9 < share < 1.44)
