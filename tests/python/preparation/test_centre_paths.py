"""The path of a tool's centre: with a bit size the unworn rock shows where it rests, without one only its motion."""

from __future__ import annotations

import numpy as np
import pytest

from bench.accuracy import centres as known
from helibore.preparation.centre_paths import find_centre_path

BIT, SAMPLES, TURNS = 0.216, 32, 72


def lobe(angle, at, width):
    away = np.abs((angle - at + np.pi) % (2 * np.pi) - np.pi) / np.radians(width / 2)
    return np.maximum(1 - away**2, 0)


def growth(kind, position, angle):
    """How much larger the hole is than 108.2 mm of radius, by position along the turns and angle."""
    if kind == "crescent":  # a circle of 109.7 mm that touches one of 108.2 mm
        return 0.0015 * np.cos(angle) + np.sqrt(0.1097**2 - (0.0015 * np.sin(angle)) ** 2) - 0.1082
    if kind == "ledges":
        return 0.01 * (np.floor(position / 7) % 2)
    lobes = {
        "round": (), "breakout": ((0.015, 1.0, 60), (0.015, 1.0 + np.pi, 60)), "key seat": ((0.02, 2.0, 60),),
        "uneven": ((0.018, 1.0, 60), (0.007, 4.0, 45)), "washout": ((0.012, 2.0, 250),),
        "shallow washout": ((0.0028, 2.0, 200),), "narrow washout": ((0.003, 2.0, 110),),
    }[kind]  # fmt: skip
    return sum((deep * lobe(angle, at, width) for deep, at, width in lobes), 0 * angle)


def seen(kind, far, rate, seed=5, noise=4e-4):
    """Position, toolface and radius as a tool ``far`` off the axis sees them, and its centre."""
    rng = np.random.default_rng(seed)
    position = (np.arange(TURNS * SAMPLES) + 0.5 * rng.random(TURNS * SAMPLES)) / SAMPLES
    angle = 2 * np.pi * position
    centre = far * np.exp(1j * (np.radians(rate) * position + 0.7))
    inner, outer = np.full(angle.size, 0.02), np.full(angle.size, 0.3)
    for _ in range(35):
        middle = 0.5 * (inner + outer)
        point = centre + middle * np.exp(1j * angle)
        inside = np.abs(point) < 0.1082 + growth(kind, position, np.angle(point))
        inner, outer = np.where(inside, middle, inner), np.where(inside, outer, middle)
    return position, np.degrees(angle) % 360, inner + rng.normal(0, noise, angle.size), centre


def errors(kind, position, toolface, radius, away):
    """The rms errors of radii about the tool, and about the axis that was found."""
    place = away + radius * np.exp(1j * np.radians(toolface))
    pairs = ((radius, np.radians(toolface)), (np.abs(place), np.angle(place)))
    return [np.sqrt(np.mean((r - 0.1082 - growth(kind, position, a)) ** 2)) for r, a in pairs]


@pytest.mark.parametrize("kind", ["shallow washout", "narrow washout", "crescent"])
def test_shallow_wear_looks_like_a_larger_hole_off_centre_within_the_deviation(kind):
    position, toolface, radius, _ = seen(kind, 0.0, 0, noise=5e-5)
    path = find_centre_path(toolface, radius, position, BIT)
    known = np.isfinite(path.rest)
    assert known.any()
    off = path.rest[known]
    farthest = np.maximum(np.abs(off.real), np.abs(off.imag))
    assert np.all(farthest <= 3 * path.rest_sigma[known])
    before, after = errors(kind, position, toolface, radius, path.at(position)[0])
    assert after < 1.01 * before


@pytest.mark.parametrize("kind", ["round", "breakout", "uneven", "key seat"])
@pytest.mark.parametrize(("far", "rate"), [(0.003, 0), (0.015, 0), (0.01, 84), (0.01, 300), (0.006, -150)])
def test_the_centre_is_found_within_its_deviation(kind, far, rate):
    position, toolface, radius, centre = seen(kind, far, rate)
    path = find_centre_path(toolface, radius, position, BIT)
    away, rests, moves = path.at(position)
    assert rests.all()
    assert moves.all()
    assert np.abs(away - centre).max() < 6e-4
    assert errors(kind, position, toolface, radius, away)[1] < 4.8e-4
    turn = np.arange(TURNS)
    found = path.centres(turn, np.full(TURNS, SAMPLES))
    truth = np.interp(turn + 0.5, position, centre.real) + 1j * np.interp(turn + 0.5, position, centre.imag)
    assert (np.abs(found.x - truth.real) <= 3 * found.sigma_x).all()
    assert (np.abs(found.y - truth.imag) <= 3 * found.sigma_y).all()
    assert np.median(found.sigma_x) < 5e-4


@pytest.mark.parametrize("kind", ["washout", "ledges"])
@pytest.mark.parametrize("far", [0.0, 0.004])
def test_a_hole_in_which_no_circle_is_sure_is_left_alone(kind, far):
    position, toolface, radius, _ = seen(kind, far, 0)
    away, rests, _ = find_centre_path(toolface, radius, position, BIT).at(position)
    before, after = errors(kind, position, toolface, radius, away)
    assert after <= 1.001 * before
    assert kind == "ledges" or not rests.any()


@pytest.mark.parametrize("kind", ["round", "breakout", "uneven", "key seat", "washout", "ledges"])
def test_without_a_bit_size_only_the_motion_is_corrected(kind):
    position, toolface, radius, _ = seen(kind, 0.004, 0)
    away, rests, _ = find_centre_path(toolface, radius, position).at(position)
    assert not rests.any()
    assert (away == 0).all()
    position, toolface, radius, centre = seen(kind, 0.004, 120)
    path = find_centre_path(toolface, radius, position)
    away, rests, moves = path.at(position)
    assert not rests.any()
    assert (np.abs(away - centre)[moves] < 6e-4).all()
    assert moves.all() or kind == "ledges"
    assert np.isnan(path.centres(np.arange(TURNS), np.full(TURNS, SAMPLES)).x).all()


def test_few_samples_have_no_path():
    position, toolface, radius, _ = seen("round", 0.003, 0)
    assert find_centre_path(toolface[:100], radius[:100], position[:100], BIT) is None
    assert find_centre_path(toolface[::6], radius[::6], position[::6], BIT) is None
    assert find_centre_path(toolface, np.full(radius.size, np.nan), position, BIT) is None


def test_the_path_turns_with_the_toolface():
    position, toolface, radius, _ = seen("uneven", 0.008, 60)
    first = find_centre_path(toolface, radius, position, BIT).at(position)[0]
    turned = find_centre_path((toolface + 100) % 360, radius, position, BIT).at(position)[0]
    np.testing.assert_allclose(turned * np.exp(-1j * np.radians(100)), first, atol=3e-4)


def test_wear_on_one_side_alone_moves_no_sample():
    """150 degrees of wear leave a circle whose centre is 0.9 mm off; that is within three of its deviations."""
    wall = known.walls(12001)["shallow"]
    position, toolface, radius, _ = known.measured(wall, 0.0, 0.0, 12001)
    path = find_centre_path(toolface, radius, position, known.BIT)
    assert np.abs(path.rest).max() > 1e-3
    away, rests, _ = path.at(position)
    assert rests.all()
    assert np.sqrt(np.mean(np.square(np.abs(away)))) < 1e-4
    assert np.sqrt(np.mean(np.square(np.abs(path.at(position, 2.5)[0])))) > 2e-4
