"""The velocity in the mud by depth, from casing of known inner diameter, against pipes of which all is known."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import helibore as hb
from helibore.base.arrays import Floats
from helibore.preparation.mud_velocity import find_velocity
from helibore.settings.preparation_settings import Echo, EchoCasing

TOOL = 0.045
INNER = 0.2205


def seen(radius: Floats, toolface: Floats, away: float, at: float) -> Floats:
    """Return the distance from a tool off centre to a round wall: the cosine rule, solved for the far side."""
    angle = np.radians(toolface - at)
    return np.asarray(np.sqrt(radius**2 - (away * np.sin(angle)) ** 2) - away * np.cos(angle))


def well(velocity: Floats, seed: int = 0, hole: float = 0.108) -> tuple[Floats, Floats, Floats, Floats]:
    """Return depth, toolface, travel time and true radius: 60 m, casing in the first and the last 15 m."""
    rng = np.random.default_rng(seed)
    depth = np.arange(60 * 240) / 240
    toolface = np.arange(depth.size) * 15.0 % 360
    true = np.where((depth < 15) | (depth > 45), INNER / 2, hole)
    radius = seen(true, toolface, 0.004, 200.0) + rng.normal(0, 0.0002, depth.size)
    return depth, toolface, 2 * (radius - TOOL) / velocity, true


def written(path: Path, depth: Floats, toolface: Floats, time: Floats) -> Path:
    rows = "".join(f"{a:.5f},{b:.2f},{1e6 * c:.5f}\n" for a, b, c in zip(depth, toolface, time, strict=True))
    path.write_text(f"md_m,tf_deg,tt_us\n{rows}")
    return path


CASINGS = (EchoCasing(0.0, 15.0, INNER), EchoCasing(45.0, 60.0, INNER))


@pytest.mark.parametrize("drift", [0.0, 0.004])
def test_diameters_by_the_velocity_that_casing_shows(tmp_path: Path, drift: float) -> None:
    """The stated velocity is 2 % too low, and the true one drifts: the hole has its size within 0.1 %."""
    depth, toolface, time, true = well(1530.0 * (1 + drift * np.linspace(0, 1, 14400)))
    log = hb.open(written(tmp_path / "c.csv", depth, toolface, time)).set()
    echo = Echo(1500.0, TOOL, casing=CASINGS, casing_sigma=0.0001)
    prepared = hb.prepare(log.readings(echo=echo))
    off = prepared.caliper.radius - seen(true, toolface, 0.004, 200.0)
    assert abs(off.mean()) < 0.0001
    assert np.std(off) < 0.0003
    plain = hb.prepare(log.readings(echo=Echo(1500.0, TOOL)))
    assert np.mean(plain.caliper.radius - seen(true, toolface, 0.004, 200.0)) < -0.001
    assert [line for step, line in prepared.report if step == "velocity"]


def test_the_uncertainty_reaches_diameters_and_volumes(tmp_path: Path) -> None:
    depth, toolface, time, _ = well(np.full(14400, 1500.0))
    log = hb.open(written(tmp_path / "c.csv", depth, toolface, time)).set()

    def logs(echo: Echo) -> hb.Logs:
        return hb.reconstruct(log.readings(echo=echo), bit_diameter=0.216, sigma=True).logs(sigma=True)

    plain, stated = logs(Echo(1500.0, TOOL)), logs(Echo(1500.0, TOOL, velocity_sigma=15.0))
    share = 0.01 * (stated.equivalent_diameter / 2 - TOOL)  # of a radius, by 1 % of the velocity
    np.testing.assert_allclose(stated.shared_sigma, share, rtol=1e-9)
    np.testing.assert_allclose(stated.diameter_sigma, np.hypot(plain.diameter_sigma, 2 * share), rtol=1e-9)
    assert (plain.shared_sigma < 1e-9).all(), "the steps of the times of the file alone"
    steps = stated.by_step(1.0)
    assert (steps.diameter_sigma >= 2 * steps.shared_sigma * (1 - 1e-9)).all()  # it does not cancel along the hole
    shown = logs(Echo(1500.0, TOOL, casing=CASINGS))
    middle = np.argmin(np.abs(shown.depth - 30))
    assert 0.0001 < shown.shared_sigma[middle] < stated.shared_sigma[middle]


def test_the_deviation_grows_away_from_casing() -> None:
    depth, toolface, time, _ = well(np.full(14400, 1500.0))
    turn = np.arange(depth.size) // 24
    radius = TOOL + 750.0 * time
    found = find_velocity(Echo(1500.0, TOOL, casing=CASINGS[:1]), depth, toolface, radius, turn)
    velocity, sigma = found.at(np.array([7.5, 300.0, 3000.0]))
    assert np.abs(velocity / 1500.0 - 1).max() < 0.002
    assert sigma[0] < sigma[1] < sigma[2]
    assert 0.01 < sigma[2] / 1500.0 < 0.04


def test_a_long_casing_shows_the_drift_below_it() -> None:
    """600 m of casing, logged in short intervals, with 3 % of drift: 100 m below it the velocity is right."""
    depth = np.concatenate([top + np.arange(30 * 24) / 240 for top in np.arange(0.0, 600.0, 15.0)])
    toolface = np.arange(depth.size) * 15.0 % 360
    velocity = 1500.0 * (1 + 0.03 * depth / 600)
    time = 2 * (seen(np.full(depth.size, INNER / 2), toolface, 0.003, 10.0) - TOOL) / velocity
    echo = Echo(1500.0, TOOL, casing=(EchoCasing(0.0, 600.0, INNER),))
    found = find_velocity(echo, depth, toolface, TOOL + 750.0 * time, np.arange(depth.size) // 24)
    (here,), (sigma,) = found.at(np.array([700.0]))
    assert abs(here - 1500.0 * 1.035) < 1.96 * sigma < 0.03 * 1500


def test_a_casing_that_contradicts_the_velocity_is_refused_with_both_numbers() -> None:
    depth, toolface, time, _ = well(np.full(14400, 1545.0))
    turn = np.arange(depth.size) // 24

    def find(velocity: float, **more: object) -> None:
        echo = Echo(velocity, TOOL, casing=CASINGS, **more)  # type: ignore[arg-type]
        find_velocity(echo, depth, toolface, TOOL + velocity / 2 * time, turn)

    find(1500.0)
    with pytest.raises(hb.InputError) as caught:
        find(1400.0)
    assert "1545 m/s" in str(caught.value)
    assert "1400 m/s" in str(caught.value)
    assert caught.value.setting == "echo.casing"
    with pytest.raises(hb.InputError, match=r"casing from 0 to 15 m: .*deviation of 5 m/s"):
        find(1500.0, velocity_sigma=5.0)
    find(1500.0, velocity_sigma=20.0)


def test_an_interval_that_is_no_pipe_or_holds_too_little_is_refused() -> None:
    depth, toolface, time, _ = well(np.full(14400, 1500.0))
    turn = np.arange(depth.size) // 24
    rough = time + 2 / 1500 * 0.004 * np.sin(2 * depth)
    for casing, times, rule in (
        (EchoCasing(16.0, 44.0, 0.216), rough, "no pipe"),
        (EchoCasing(100.0, 120.0, INNER), time, "0 turns of samples lie in it"),
        (EchoCasing(1.0, 2.0, INNER), time, "must be at least 24"),
        (EchoCasing(0.0, 15.0, 0.08), time, "must be above that of the tool, 90.0 mm"),
    ):
        with pytest.raises(hb.InputError, match=rule):
            find_velocity(Echo(1500.0, TOOL, casing=(casing,)), depth, toolface, TOOL + 750.0 * times, turn)
    with pytest.raises(hb.InputError, match="one side"):
        find_velocity(Echo(1500.0, TOOL, casing=CASINGS), depth, toolface * 0.1, TOOL + 750.0 * time, turn)
