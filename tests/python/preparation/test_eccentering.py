"""Eccentering against a simulated tool in a known hole (rays cut with the wall by bisection), and its laws."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import helibore as hb
from helibore.preparation.eccentering import Centres, Shape, find_centres, recentre, turn_positions
from helibore.preparation.turn_fits import evaluate, leverage, normal_equations, powers

TURNS = 70


def lobe(phi, at, width, depth, edge):
    off = np.abs((phi - at + np.pi) % (2 * np.pi) - np.pi) / (np.radians(width) / 2)
    inside = off < 1
    profile = {"bell": np.cos(0.5 * np.pi * off) ** 2, "bowl": 1 - off**2, "box": np.ones_like(off)}[edge]
    return depth * np.where(inside, profile, 0.0)


class Simulated:
    """Turns of an eccentred tool: 10 mm by default, ovality 3 mm, two opposite lobes, 0.5 mm noise, half missing."""

    def __init__(
        self, seed, samples=64, eccentering=0.010, ovality=0.003, lobes=0.012, width=60, edge="bell", noise=0.0005,
        missing="random", washout=0.0, washout_width=120, three=0.0, steady=False,
    ):  # fmt: skip
        rng = np.random.default_rng(seed)
        angle = rng.random((TURNS, samples)) * 2 * np.pi
        to, oval, low, wash, third = 2 * np.pi * rng.random((5, TURNS, 1))
        if steady:  # one shape all the way down, sampled at a steady rate; the tool still wanders
            angle = (np.arange(samples) + 0.6 * rng.random(angle.shape)) * 2 * np.pi / samples
            oval, low, wash, third = (each[:1] for each in (oval, low, wash, third))
        self.x, self.y = (eccentering * np.cos(to))[:, 0], (eccentering * np.sin(to))[:, 0]
        centre = eccentering * np.exp(1j * to)

        def wall(phi):
            r = 0.108 + ovality * np.cos(2 * (phi - oval)) + three * np.cos(3 * (phi - third))
            for at in (low, low + np.pi):
                r = r + lobe(phi, at, width, lobes, edge)
            return r + lobe(phi, wash, washout_width, washout, edge)

        near, far = np.full(angle.shape, 0.02), np.full(angle.shape, 0.3)
        for _ in range(30):
            middle = 0.5 * (near + far)
            point = centre + middle * np.exp(1j * angle)
            inside = np.abs(point) < wall(np.angle(point))
            near, far = np.where(inside, middle, near), np.where(inside, far, middle)
        if missing == "random":
            kept = rng.permuted(np.tile(np.arange(samples) < samples // 2, (TURNS, 1)), axis=1)
        elif missing == "half circle":
            kept = (angle - 2 * np.pi * rng.random((TURNS, 1))) % (2 * np.pi) < np.pi
        else:
            kept = np.ones(angle.shape, dtype=bool)
        self.noise = rng.normal(0.0, noise, kept.sum())
        self.toolface = np.degrees(angle[kept])
        self.radius = near[kept] + self.noise
        self.turn = np.broadcast_to(np.arange(TURNS)[:, None], kept.shape)[kept]
        self.shape = wall
        self.wall = np.abs(centre + near * np.exp(1j * angle))[kept]

    def centres(self, **known):
        return find_centres(self.toolface, self.radius, self.turn, **known)

    def inside(self, centres, sigmas=3.0):
        """Share of turns whose true centre lies within so many standard deviations on both axes."""
        x = np.abs(centres.x - self.x) <= sigmas * centres.sigma_x
        y = np.abs(centres.y - self.y) <= sigmas * centres.sigma_y
        return np.mean(x & y)

    def error(self, centres):
        """rms over the samples of corrected radius minus true radius, less the sample's own noise."""
        _, radius = recentre(self.toolface, self.radius, self.turn, centres)
        return np.sqrt(np.mean((radius - self.noise - self.wall) ** 2))


# The bar: 10 mm off, oval, two opposite lobes of 60 deg, 0.5 mm noise, a random half of the samples missing.
@pytest.mark.parametrize("edge", ["bell", "bowl", "box"])
@pytest.mark.parametrize("samples", [64, 128])
def test_bar_radius_and_centre(samples, edge):
    tool = Simulated(1, samples=samples, edge=edge)
    centres = tool.centres()
    assert tool.error(centres) < 0.4e-3
    assert tool.inside(centres) >= 0.99
    np.testing.assert_array_less(0.0, centres.inliers)
    assert np.all(centres.samples == samples // 2)


# At 64 a turn true arcs interpolate a lobe's flank from beside it (0.8 mm); its shape is known from above and below.
@pytest.mark.parametrize(("samples", "scale"), [(128, 1.0), (64, 4.0)])
def test_bar_wall_comes_back(samples, scale):
    tool = Simulated(10, samples=samples, steady=True)
    depth = 0.02 * (tool.turn + tool.toolface / 360)
    errors = []
    for toolface, radius in (
        (tool.toolface, tool.radius),
        recentre(tool.toolface, tool.radius, tool.turn, tool.centres()),
    ):
        caliper = hb.Caliper(depth, toolface, radius)
        wall = hb.reconstruct(caliper, bit_diameter=0.216, sectors=samples, pitch=0.02, angular_scale=scale)
        truth = tool.shape(np.radians(wall.toolface)).ravel()
        errors.append(np.sqrt(np.mean((wall.radius - truth) ** 2)))
    assert errors[0] > 3e-3  # as measured
    assert errors[1] < 0.5e-3


@pytest.mark.parametrize(
    "shape", [{"lobes": 0.0, "ovality": 0.0}, {"ovality": 0.008}, {"three": 0.001}, {"lobes": 0.02}]
)
def test_other_shapes_are_told_from_offset(shape):
    tool = Simulated(3, **shape)
    centres = tool.centres()
    assert tool.inside(centres) >= 0.99
    # Chance leaves a quarter of the circle empty in some turn: those say so and are left as they are.
    sure = centres.one_sided[tool.turn] == 0.0
    assert np.mean(centres.one_sided == 0.0) >= 0.99
    _, radius = recentre(tool.toolface, tool.radius, tool.turn, centres)
    assert np.sqrt(np.mean((radius - tool.noise - tool.wall)[sure] ** 2)) < 0.3e-3


WASHOUT = {"lobes": 0.0, "washout": 0.03, "washout_width": 150, "edge": "box"}
BELL_WASHOUT = {"lobes": 0.0, "washout": 0.02, "washout_width": 120}


@pytest.mark.parametrize(
    "shape",
    [{}, {"edge": "bowl"}, {"edge": "box"}, WASHOUT, BELL_WASHOUT, {"lobes": 0.0, "washout": 0.01, "washout_width": 90},
     {"washout": 0.015, "edge": "bowl"}],
)  # fmt: skip
def test_half_circle_missing_sigma_covers(shape):
    tool = Simulated(4, missing="half circle", **shape)
    centres = tool.centres()
    assert tool.inside(centres) >= 0.99
    assert np.median(np.hypot(centres.sigma_x, centres.sigma_y)) > 4e-3  # and it says how little half a circle shows


def test_one_sided_washout_with_half_of_the_samples_missing():
    tool = Simulated(11, **WASHOUT)
    centres = tool.centres()
    assert tool.inside(centres) >= 0.99
    assert np.median(np.hypot(centres.sigma_x, centres.sigma_y)) < 1.5e-3
    assert tool.error(centres) < 2e-3


def test_one_sided_washout_without_edges_is_shown_by_sigma_and_left():
    tool = Simulated(11, **BELL_WASHOUT)
    centres = tool.centres()
    assert tool.inside(centres) >= 0.97
    assert np.median(np.hypot(centres.sigma_x, centres.sigma_y)) > 8e-3
    assert np.median(centres.share()) < 0.5


def test_a_well_covered_circle_leaves_no_doubt():
    centres = Simulated(12, samples=128).centres()
    assert np.mean(centres.one_sided == 0.0) > 0.99
    np.testing.assert_array_equal(centres.covariance[centres.one_sided == 0], centres.within[centres.one_sided == 0])


def test_upright_edges_sigma_covers():
    tool = Simulated(5, edge="box")
    assert tool.inside(tool.centres()) >= 0.99


def test_sigma_is_not_merely_wide():
    tool = Simulated(6, samples=512, missing="none")
    centres = tool.centres()
    off = np.hypot(centres.x - tool.x, centres.y - tool.y)
    assert np.sqrt(np.mean(off**2)) < 0.08e-3
    assert np.median(centres.sigma_x) < 0.1e-3


def test_one_sided_washout_is_shown_by_sigma():
    tool = Simulated(7, samples=128, missing="none", lobes=0.0, washout=0.03, washout_width=150, edge="box")
    assert tool.inside(tool.centres()) >= 0.99


ONE_SIDED = {"lobes": 0.0, "missing": "none"}


@pytest.mark.parametrize("eccentering", [0.0, 0.01])
@pytest.mark.parametrize(
    "shape",
    [
        ONE_SIDED | {"washout": 0.02, "washout_width": 120},
        ONE_SIDED | {"washout": 0.02, "washout_width": 200},  # the second and third harmonic say nothing of it
        ONE_SIDED | {"washout": 0.02, "washout_width": 120, "edge": "bowl"},
        {"washout": 0.010, "washout_width": 60},  # breakouts, one of them deeper or both askew
        {"washout": 0.010, "washout_width": 60, "edge": "box"},
        {"lobes": 0.0, "washout": 0.025, "washout_width": 80, "edge": "bowl"},  # a key seat
    ],
)
def test_with_the_bit_size_sigma_covers_what_a_wall_on_one_side_hides(shape, eccentering):
    tool = Simulated(21, eccentering=eccentering, **shape)
    assert tool.inside(tool.centres(bit_diameter=0.216)) >= 0.99


def test_without_the_bit_size_a_smooth_washout_goes_unnoticed():
    tool = Simulated(21, eccentering=0.0, **ONE_SIDED, washout=0.02, washout_width=200)
    assert tool.inside(tool.centres()) < 0.1
    sized = tool.centres(bit_diameter=0.216)
    assert np.median(sized.share()) < np.median(tool.centres().share())


def test_a_hole_of_bit_size_needs_no_wider_sigma():
    tool = Simulated(6, samples=512, missing="none", lobes=0.0, ovality=0.001)
    centres = tool.centres(bit_diameter=0.216)
    assert tool.inside(centres) >= 0.99
    assert np.median(centres.sigma_x) < 0.2e-3


def whirling(seed, a_turn, samples=64, eccentering=0.010, turns=200, lobes=0.012, washout=0.0):
    """A tool whose centre goes around the axis by so many degrees a turn, in an oval hole with lobes."""
    rng = np.random.default_rng(seed)
    position = (np.arange(turns * samples) + 0.8 * rng.random(turns * samples)) / samples
    angle = 2 * np.pi * (position % 1)

    def centre(at):
        return eccentering * np.exp(1j * np.radians(a_turn * at + 60))

    def wall(phi):
        enlarged = sum(lobe(phi, at, 60, lobes, "bell") for at in (1.2, 1.2 + np.pi))
        return 0.108 + 0.003 * np.cos(2 * (phi - 0.4)) + enlarged + lobe(phi, 1.2, 200, washout, "bell")

    near, far = np.full(angle.size, 0.02), np.full(angle.size, 0.3)
    for _ in range(30):
        middle = 0.5 * (near + far)
        point = centre(position) + middle * np.exp(1j * angle)
        inside = np.abs(point) < wall(np.angle(point))
        near, far = np.where(inside, middle, near), np.where(inside, far, middle)
    noise = rng.normal(0, 0.0005, angle.size)
    true = np.abs(centre(position) + near * np.exp(1j * angle))
    return np.degrees(angle), near + noise, position, centre, true + noise


@pytest.mark.parametrize("a_turn", [84.0, -84.0, 30.0])
def test_centres_are_interpolated_between_turns(a_turn):
    toolface, radius, position, centre, true = whirling(31, a_turn, turns=84)
    turn = np.floor(position)
    np.testing.assert_allclose(turn_positions(toolface), position, atol=1e-9)
    resting = find_centres(toolface, radius, turn)
    _, still = recentre(toolface, radius, turn, resting)
    moving = find_centres(toolface, radius, turn, position=position, bit_diameter=0.216)
    _, followed = recentre(toolface, radius, turn, moving, position=position)
    rms = [np.sqrt(np.mean((found - true) ** 2)) for found in (still, followed)]
    assert rms[1] < 0.2 * rms[0]
    assert rms[1] < 0.5e-3
    truth = centre(moving.turn + 0.5)
    x = np.abs(moving.x - truth.real) <= 3 * moving.sigma_x
    assert np.mean(x & (np.abs(moving.y - truth.imag) <= 3 * moving.sigma_y)) >= 0.99


@pytest.mark.parametrize("a_turn", [110.0, -150.0, 180.0, 230.0, 270.0, 330.0, -270.0])
def test_a_whirl_that_is_too_fast_is_refused_even_where_it_looks_slow(a_turn):
    toolface, radius, position, _, _ = whirling(31, a_turn, turns=63)
    turn = np.floor(position)
    centres = find_centres(toolface, radius, turn, position=position)
    assert np.isnan(centres.x).all()
    assert np.isnan(centres.sigma_x).all()
    assert not centres.share().any()
    seen, distance = recentre(toolface, radius, turn, centres, position=position)
    np.testing.assert_array_equal(distance, radius)
    np.testing.assert_allclose(seen, toolface % 360)


def test_a_small_whirl_nearly_as_fast_as_the_tool_turns_is_owned_by_sigma():
    toolface, radius, position, centre, _ = whirling(31, 330.0, eccentering=0.001, turns=63)
    found = find_centres(toolface, radius, np.floor(position), position=position)
    truth = centre(found.turn + 0.5)
    x, y = np.abs(found.x - truth.real) <= 3 * found.sigma_x, np.abs(found.y - truth.imag) <= 3 * found.sigma_y
    assert np.mean(np.isnan(found.x) | (x & y)) >= 0.95


@pytest.mark.parametrize("a_turn", [310.0, 330.0])
def test_a_whirl_nearly_as_fast_as_the_tool_turns_is_owned_in_a_washout_on_one_side(a_turn):
    """The mean radius rises and falls by the offset as in a hole that grows and shrinks; the washout hides the rest."""
    toolface, radius, position, centre, _ = whirling(33, a_turn, turns=63, lobes=0.0, washout=0.020)
    found = find_centres(toolface, radius, np.floor(position), position=position, bit_diameter=0.216)
    truth = centre(found.turn + 0.5)
    x, y = np.abs(found.x - truth.real) <= 3 * found.sigma_x, np.abs(found.y - truth.imag) <= 3 * found.sigma_y
    assert np.mean(np.isnan(found.x) | (x & y)) >= 0.99


def test_a_hole_that_steadily_grows_does_not_widen_sigma():
    """Sixty turns of a hole that grows by 0.2 mm a turn: no whirl rises for so long."""
    angle = np.arange(60 * 64) * 2 * np.pi / 64
    position = angle / (2 * np.pi)
    noise = np.random.default_rng(34).normal(0, 0.0005, angle.size)
    found = find_centres(np.degrees(angle), 0.108 + 0.0002 * position + noise, np.floor(position), position=position)
    assert np.isfinite(found.x).all()
    assert np.max(found.sigma_x) < 0.3e-3


def test_a_tool_that_does_not_whirl_is_found_with_positions_too():
    tool = Simulated(32, samples=64, missing="none", eccentering=0.0)
    position = tool.turn + tool.toolface / 360
    x, y = 0.004, -0.006  # one centre for all turns: move the samples to where such a tool would see them
    wall = tool.radius * np.exp(1j * np.radians(tool.toolface)) - (x + 1j * y)
    seen = np.degrees(np.angle(wall)) % 360
    centres = find_centres(seen, np.abs(wall), tool.turn, position=tool.turn + seen / 360)
    assert np.sqrt(np.mean((centres.x - x) ** 2 + (centres.y - y) ** 2)) < 0.3e-3
    assert position.size == seen.size


@pytest.mark.parametrize("shape", [{"lobes": 0.0, "ovality": 0.0}, {}])
def test_without_eccentering_nothing_changes(shape):
    tool = Simulated(8, eccentering=0.0, **shape)
    toolface, radius = recentre(tool.toolface, tool.radius, tool.turn, tool.centres())
    assert np.sqrt(np.mean((radius - tool.radius) ** 2)) < 0.1e-3
    assert np.mean(toolface == tool.toolface % 360) > 0.95


def test_exact_circle_without_noise():
    """r = e cos psi + sqrt(R^2 - e^2 sin^2 psi), psi from the direction in which the axis lies."""
    a = np.arange(0.0, 360.0, 5.0)
    e, towards, big = 0.03, 130.0, 0.1
    psi = np.radians(a - towards - 180.0)
    r = e * np.cos(psi) + np.sqrt(big**2 - (e * np.sin(psi)) ** 2)
    centres = find_centres(a, r, np.zeros(a.size), Shape(reach=10.0))
    assert centres.eccentering[0] == pytest.approx(e, abs=1e-6)
    assert centres.direction[0] == pytest.approx(towards, abs=1e-3)
    assert centres.mean_radius[0] == pytest.approx(big, abs=1e-6)
    toolface, radius = recentre(a, r, np.zeros(a.size), centres, significance=0.0)
    np.testing.assert_allclose(radius, big, atol=1e-6)
    assert np.all((toolface >= 0) & (toolface < 360))


def test_spikes_do_not_move_the_centre():
    tool = Simulated(9, samples=128)
    rng = np.random.default_rng(9)
    hit = rng.random(tool.radius.size) < 0.04
    tool.radius[hit] += rng.uniform(-0.04, 0.06, hit.sum())
    centres = tool.centres()
    assert np.quantile(np.hypot(centres.x - tool.x, centres.y - tool.y), 0.95) < 1e-3
    assert tool.inside(centres) >= 0.99


@settings(max_examples=8, deadline=None)
@given(st.floats(0, 360), st.integers(0, 1000), st.integers(-5, 5))
def test_laws_rotation_order_and_turns_apart(angle, seed, shift):
    rng = np.random.default_rng(seed)
    a, r, turn = rng.random(200) * 360, 0.1 + 0.01 * rng.random(200), rng.integers(0, 5, 200)
    plain = find_centres(a, r, turn)
    turned = find_centres(a + angle, r, turn)
    spin = np.exp(1j * np.radians(angle))
    np.testing.assert_allclose(turned.x + 1j * turned.y, (plain.x + 1j * plain.y) * spin, atol=3e-6)
    order = rng.permutation(200)
    mixed = find_centres(a[order], r[order], turn[order] + shift)
    np.testing.assert_array_equal(mixed.turn, plain.turn + shift)
    np.testing.assert_allclose(mixed.x, plain.x, atol=3e-6)
    for number in plain.turn:
        alone = find_centres(a[turn == number], r[turn == number], turn[turn == number])
        np.testing.assert_allclose(alone.x[0], plain.x[plain.turn == number][0], atol=3e-6)


def test_inputs_are_left_alone_and_missing_radii_stay():
    a, r, turn = np.arange(0.0, 720.0, 10.0) % 360, np.full(72, 0.1), np.repeat([4, 9], 36)
    r[3] = np.nan
    r[36:] = np.nan
    copies = a.copy(), r.copy(), turn.copy()
    centres = find_centres(a, r, turn)
    toolface, radius = recentre(a, r, turn, centres)
    for mine, copy in zip((a, r, turn), copies, strict=True):
        np.testing.assert_array_equal(mine, copy)
    np.testing.assert_array_equal(centres.samples, [35, 0])
    assert np.isnan(centres.x[1])
    assert centres.share().tolist()[1] == 0.0
    np.testing.assert_array_equal(np.isnan(radius), np.isnan(r))
    np.testing.assert_array_equal(toolface[np.isnan(r)], a[np.isnan(r)])


@pytest.mark.parametrize("count", [1, 2, 3])
def test_few_samples_say_so(count):
    centres = find_centres(np.arange(count) * 120.0, np.full(count, 0.1), np.zeros(count))
    assert centres.samples[0] == count
    assert centres.sigma_x[0] > 1e-3
    assert centres.share()[0] == 0.0


def test_no_samples():
    empty = find_centres([], [], [])
    assert empty.turn.size == 0
    assert isinstance(empty, Centres)
    assert recentre([], [], [], empty)[0].size == 0


def test_turns_follow_the_short_way():
    position = turn_positions([10, 170, 300, 20, 350, 20, 180, 340, 100])
    np.testing.assert_array_equal(np.floor(position), [0, 0, 0, 1, 0, 1, 1, 1, 2])
    assert turn_positions([]).size == 0


@pytest.mark.parametrize(
    ("change", "place"),
    [
        ({"toolface": [0, np.nan]}, "toolface[1]"),
        ({"radius": [0.1, -0.1]}, "radius[1]"),
        ({"radius": [0.1, np.inf]}, "radius[1]"),
        ({"radius": [0.1]}, "radius has 1 values, toolface has 2"),
        ({"turn": [0.0, 0.5]}, "turn[1]"),
        ({"turn": [0]}, "turn has 1 values, toolface has 2"),
        ({"bit_diameter": 0.0}, "bit_diameter"),
        ({"position": [0.5]}, "position has 1 values, toolface has 2"),
        ({"position": [0.5, np.nan]}, "position[1]"),
    ],
)
def test_errors(change, place, golden):
    good = {"toolface": [0, 90], "radius": [0.1, 0.1], "turn": [0, 0]}
    with golden.raises(place):
        find_centres(**(good | change))


def test_errors_of_settings_and_foreign_turns(golden):
    with golden.raises():
        Shape(even=0.0)
    with golden.raises():
        Shape(harmonics=1)
    centres = find_centres([0, 90, 180], [0.1] * 3, [0, 0, 0])
    with golden.raises():
        recentre([0, 90], [0.1, 0.1], [0, 7], centres)


def test_harmonics_against_design_matrices():
    rng = np.random.default_rng(0)
    count, order = np.array([40, 7, 90]), 4
    turn = np.repeat(np.arange(3), count)
    starts = np.cumsum(count) - count
    angle, weight, value = rng.random((3, turn.size))
    table = powers(np.exp(2j * np.pi * angle), 2 * order)
    k = np.arange(1, order + 1)
    waves = 2 * np.pi * angle[:, None] * k
    design = np.concatenate([np.ones((turn.size, 1)), np.stack([np.cos(waves), np.sin(waves)], 2).reshape(-1, 8)], 1)
    matrix, side = normal_equations(weight, value, table, starts)
    square = rng.random((3, 9, 9))
    square = square + square.transpose(0, 2, 1)
    terms = rng.random((3, 9))
    for t in range(3):
        x, w = design[turn == t], weight[turn == t]
        np.testing.assert_allclose(matrix[t], (x.T * w) @ x, atol=1e-12)
        np.testing.assert_allclose(side[t], (x.T * w) @ value[turn == t], atol=1e-12)
        np.testing.assert_allclose(evaluate(terms, table, turn)[turn == t], x @ terms[t], atol=1e-12)
        slow = np.einsum("np,pq,nq->n", x, square[t], x)
        np.testing.assert_allclose(leverage(square, table, turn)[turn == t], slow, atol=1e-12)


def test_no_samples_have_no_turns_also_with_positions():
    centres = find_centres([], [], [], position=[])
    assert (centres.turn.size, centres.x.size) == (0, 0)
    toolface, radius = recentre([], [], [], centres, position=[])
    assert (toolface.size, radius.size) == (0, 0)
