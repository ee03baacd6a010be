"""The fit of a covariance: against the likelihood written out for all samples, instruction sets, bad input."""

from __future__ import annotations

from contextlib import suppress
from typing import Any

import numpy as np
import pytest
from reference import Floats, exactly, random_hole

import helibore as hb
from helibore import _core
from helibore.wall.covariance import (
    Covariance,
    Term,
    choose_blocks,
    content_seed,
    covariance_of,
    fit_covariance,
)


def posterior(found: Covariance, depth: Floats, toolface: Floats, radius: Floats) -> float:
    """The restricted log-likelihood by contrasts between the samples, with the priors of the fit."""
    n = depth.size
    matrix = found.at(toolface[:, None] - toolface, depth[:, None] - depth) + found.noise * np.eye(n)
    contrasts = np.linalg.qr(np.column_stack([np.ones(n), np.eye(n)[:, 1:]]))[0][:, 1:]
    within, values = contrasts.T @ matrix @ contrasts, contrasts.T @ radius
    likelihood = -0.5 * (np.linalg.slogdet(within)[1] + values @ np.linalg.solve(within, values))
    short, long = found.terms[:2]
    prior = 0.02 * np.log(short.around / 0.05) ** 2 + 0.02 * np.log(short.along / 0.06) ** 2
    prior += 0.03 * np.log(long.variance / 4e-6) ** 2 + 0.6 * np.log(long.around / 0.1) ** 2
    prior += 0.02 * np.log(long.along / 0.6) ** 2 + 0.02 * np.log(4.0 * short.variance / found.noise) ** 2
    return float(likelihood - prior)


@pytest.mark.parametrize(("shape", "seed"), [("oval", 1), ("washed", 2), ("spiral", 3)])
def test_no_other_parameters_near_those_found_are_likelier(shape: str, seed: int) -> None:
    depth, toolface, radius = random_hole(seed, shape, 150, 4.0)
    order = np.argsort(depth, kind="stable")
    samples = depth[order], np.mod(toolface[order], 360.0), radius[order]
    found = fit_covariance(samples)
    assert found is not None
    assert found.turn == 0.0 or shape == "spiral"
    best = posterior(found, *samples)
    r = found.radius
    low, high = (1e-12, 1e-12, 0.004, 0.004, 1e-12, 0.35 * r, 0.02), (1e-2, 1e-2, 40 * r, 60.0, 1e-2, 2.5 * r, 200.0)
    values = found.values
    for i in range(1, 8):
        for factor in (0.8, 1.25):
            other = [*values]
            other[i] *= factor
            if low[i - 1] <= abs(other[i]) <= high[i - 1]:
                assert posterior(covariance_of(other), *samples) < best + 0.01, (i, factor)


@pytest.mark.parametrize(("sides", "repeats"), [(2, True), (1, False)])
def test_opposite_sides_are_alike_in_breakouts_not_in_a_key_seat(sides: int, repeats: bool) -> None:
    rng = np.random.default_rng(5)
    depth, toolface = np.arange(0.0, 20.0, 0.12), rng.uniform(0.0, 360.0, 167)
    away = (toolface - 70.0 + 180.0 / sides) % (360.0 / sides) - 180.0 / sides
    radius = 0.109 + 0.015 * np.exp(-((away / 20.0) ** 2)) + rng.normal(0.0, 5e-4, depth.size)
    found = fit_covariance((depth, toolface, radius))
    assert found is not None
    assert found.half_turns == repeats
    assert covariance_of(found.values) == found
    beside, opposite = found.at(np.array([0.0, 180.0]), np.zeros(2))
    assert (opposite > 0.9 * beside) == repeats


@pytest.mark.parametrize("bulges", [2, 3])
@pytest.mark.parametrize(("arms", "rate"), [(5, 0.0), (5, 30.0), (6, 3.0)])
def test_an_odd_number_of_arms_shows_half_turns_only_if_they_pass_the_shape(
    arms: int, rate: float, bulges: int
) -> None:
    depth = np.repeat(np.arange(0.0, 20.0, 0.1), arms)
    toolface = (np.tile(360.0 / arms * np.arange(arms), 200) + rate * depth) % 360.0
    shape = 0.004 * np.cos(np.radians(bulges * (toolface - 20.0))) * (1.0 + 0.3 * np.sin(depth))
    noise = np.random.default_rng(1).normal(0.0, 3e-4, depth.size)
    found = fit_covariance((depth, toolface, 0.11 + shape + noise))
    assert found is not None
    assert found.half_turns == (bulges == 2 and (arms == 6 or rate == 30.0))


@pytest.mark.parametrize(
    ("wave", "noise", "smooth"), [("waves", 2e-3, True), ("waves", 3e-4, True), ("steps", 3e-4, False)]
)
@pytest.mark.parametrize("seed", [1, 2, 3])
def test_a_wall_without_roughness_has_a_smooth_short_term(seed: int, wave: str, noise: float, smooth: bool) -> None:
    rng = np.random.default_rng(seed)
    depth, toolface = np.sort(rng.uniform(0.0, 4.0, 6000)), rng.uniform(0.0, 360.0, 6000)
    phase = 4 * np.radians(toolface) + rng.uniform(0.0, 6.0), 14.0 * depth + rng.uniform(0.0, 6.0)
    shape = np.cos(sum(phase)) + np.cos(phase[0] - phase[1])
    shape = shape if wave == "waves" else np.sign(shape)
    found = fit_covariance((depth, toolface, 0.109 + 1.5e-3 * shape + rng.normal(0.0, noise, depth.size)))
    assert found is not None
    assert found.smooth == smooth
    assert covariance_of(found.values) == found


@pytest.mark.parametrize("seed", [1, 5, 6])
def test_ledges_are_alike_all_around_the_hole(seed: int) -> None:
    rng = np.random.default_rng(seed)
    depth, toolface = np.arange(0.0, 20.0, 0.12), rng.uniform(0.0, 360.0, 167)
    steps, ends = rng.uniform(0.0, 0.015, 60), np.cumsum(rng.uniform(0.3, 1.5, 60))
    radius = 0.109 + steps[np.searchsorted(ends, depth)] + rng.normal(0.0, 5e-4, depth.size)
    found = fit_covariance((depth, toolface, radius))
    assert found is not None
    opposite = found.at(np.array([180.0]), np.array([0.0]))[0]
    assert opposite > 0.9 * found.variance


@pytest.mark.parametrize("seed", [1, 4])
def test_parameters_far_from_those_found_are_not_likelier(seed: int) -> None:
    rng, arms, passes = np.random.default_rng(seed), 4, 6
    depth = np.repeat(np.arange(0.0, 20.0, 0.1), arms * passes)
    first = np.repeat(rng.uniform(0.0, 360.0, passes), arms) + np.tile(90.0 * np.arange(arms), passes)
    toolface = np.mod(np.tile(first, 200) + 3.0 * depth, 360.0)
    breakout = np.exp(-(((np.mod(toolface - 7.0 * depth + 90.0, 180.0) - 90.0) / 22.0) ** 2))
    radius = 0.109 + 0.016 * breakout * (0.8 + 0.2 * np.sin(depth / 2.0)) + rng.normal(0.0, 5e-4, depth.size)
    samples = depth, toolface, radius
    found = fit_covariance(samples)
    assert found is not None
    rows = choose_blocks(depth, toolface, found.radius, np.random.default_rng(content_seed(samples)))

    def mean(covariance: Covariance) -> float:
        return float(np.mean([posterior(covariance, depth[each], toolface[each], radius[each]) for each in rows]))

    slow_and_long = Term(8e-7, 0.06, 2.8), Term(3e-5, 0.077, 140.0)
    assert mean(Covariance(slow_and_long, 2.4e-7, found.radius, found.turn)) < mean(found)


def blocks(count: int, size: int) -> tuple[Floats, Floats, Floats]:
    rng = np.random.default_rng(4)
    depth = np.sort(rng.uniform(0.0, 2.0, (count, size)), axis=1)
    toolface = rng.uniform(0.0, 360.0, (count, size))
    radius = 0.11 + 2e-3 * np.cos(2.0 * np.radians(toolface) - depth) + rng.normal(0.0, 3e-4, (count, size))
    return depth.reshape(-1), toolface.reshape(-1), radius.reshape(-1)


@pytest.mark.parametrize(("count", "size"), [(9, 20), (3, 64), (1, 75)])
def test_all_instruction_sets_find_the_same(count: int, size: int) -> None:
    def found(level: str) -> list[float]:
        with suppress(hb.InputError):  # this processor does not have it
            return _core.fit_covariance(blocks(count, size), size, 0.11, 0.0, 0.0, 1, level)
        return found("plain")

    assert found("plain") == found("avx2") == found("avx512")


def test_noise_stays_above_that_of_quantised_radii() -> None:
    depth, toolface, radius = blocks(1, 200)
    step = 2e-3
    found = fit_covariance((np.sort(depth), toolface, np.round(radius / step) * step))
    assert found is not None
    assert found.noise >= step**2 / 48.0 * (1.0 - 1e-4)


BAD: list[tuple[dict[str, Any], str]] = [
    ({"size": 1}, "block_size = 1: must lie in 2 to 1000"),
    ({"size": 7}, "samples = 60: must be whole blocks"),
    ({"radius": 0.0}, "radius = 0: must be above 0, at most 1000 m"),
    ({"spacing": float("nan")}, "spacing = nan: must lie in 0 to 1000 m"),
    ({"least_turn": -1.0}, "least_turn = -1: must be 0 or above"),
    ({"threads": 0}, "threads = 0: must lie in 1 to 1024"),
    ({"first": float("nan")}, "depth[0] = nan: must be finite"),
]


@pytest.mark.parametrize(("change", "text"), BAD, ids=[text for _, text in BAD])
def test_bad_blocks_are_refused(change: dict[str, Any], text: str) -> None:
    given = {"size": 20, "radius": 0.11, "spacing": 0.0, "least_turn": 0.0, "first": 0.0, "threads": 1} | change
    depth, toolface, radius = blocks(3, 20)
    depth[0] = given["first"]
    rules = (given[name] for name in ("size", "radius", "spacing", "least_turn"))
    with pytest.raises(hb.InputError, match=exactly(text)):
        _core.fit_covariance((depth, toolface, radius), *rules, given["threads"])


@pytest.mark.parametrize(("count", "size"), [(9, 20), (1, 75)])
def test_threads_find_the_same(count: int, size: int) -> None:
    one, three, many = (_core.fit_covariance(blocks(count, size), size, 0.11, 0.0, 0.0, of) for of in (1, 3, 100))
    assert one == three == many
