"""The simulated hole and tool: shapes where they should be, seeded bits, the promised first and last sample."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from golden_texts import Golden
from hypothesis import given, settings
from hypothesis import strategies as st

from helibore.simulation.tool import Bed, Breakout, Hole, Lift, Section, Tool, Washout, simulate

PLAIN = Hole(start=100.0, stop=110.0, bit_diameter=0.2, overgauge=0.0)
EXACT = Tool(noise=0.0, gamma_noise=0.0)


def test_plain_hole_is_the_bit() -> None:
    assert np.array_equal(PLAIN.radius([100.0, 105.0], [0.0, 359.0]), [0.1, 0.1])


def test_radius_broadcasts_and_is_periodic() -> None:
    hole = Hole.example(seed=3)
    depth = np.linspace(2000, 2050, 40)[:, None]
    toolface = np.linspace(0, 345, 24)[None, :]
    assert hole.radius(depth, toolface).shape == (40, 24)
    np.testing.assert_allclose(hole.radius(depth, toolface), hole.radius(depth, toolface + 360), rtol=0, atol=1e-12)


def test_ovality_has_its_long_axis_at_its_toolface() -> None:
    hole = dataclasses.replace(PLAIN, ovality=0.01, ovality_toolface=30.0)
    np.testing.assert_allclose(hole.radius(105.0, [30, 120, 210, 300]), [0.11, 0.09, 0.11, 0.09], atol=1e-15)


def test_washout_is_round_and_stays_in_its_stretch() -> None:
    hole = dataclasses.replace(PLAIN, washouts=(Washout(102.0, 106.0, 0.02),))
    np.testing.assert_allclose(hole.radius([101.999, 102.0, 104.0, 106.0], 17.0), [0.1, 0.1, 0.12, 0.1])


def test_breakout_has_two_opposite_lobes() -> None:
    hole = dataclasses.replace(PLAIN, breakouts=(Breakout(102.0, 106.0, 350.0, 60.0, 0.02),))
    np.testing.assert_allclose(hole.radius(104.0, [350, 170, 20, 80, 260]), [0.12, 0.12, 0.1, 0.1, 0.1], atol=1e-12)
    assert hole.radius(104.0, 10.0) > 0.1


def test_spiral_hole_is_a_displaced_circle() -> None:
    hole = dataclasses.replace(PLAIN, spiral=0.004, spiral_length=2.0)
    toolface = np.radians(np.arange(0, 360, 5.0))
    for depth in (100.0, 100.5, 101.3):
        radius = hole.radius(depth, np.degrees(toolface))
        at = np.pi * depth
        x = radius * np.cos(toolface) - 0.004 * np.cos(at)
        y = radius * np.sin(toolface) - 0.004 * np.sin(at)
        np.testing.assert_allclose(np.hypot(x, y), 0.1, atol=1e-12)


def test_roughness_has_its_root_mean_square() -> None:
    hole = dataclasses.replace(PLAIN, stop=600.0, rugosity=0.001)
    rng = np.random.default_rng(0)
    radius = hole.radius(rng.uniform(100, 600, 100_000), rng.uniform(0, 360, 100_000))
    assert np.std(radius) == pytest.approx(0.001, rel=0.02)


def test_dipping_bed_is_a_sinusoid() -> None:
    hole = dataclasses.replace(PLAIN, beds=(Bed(105.0, 120.0, dip=60.0, direction=90.0),), top_gamma=20.0)
    reach = 0.1 * np.tan(np.radians(60.0))
    for toolface, top in ((90.0, 105.0 + reach), (270.0, 105.0 - reach), (0.0, 105.0)):
        np.testing.assert_allclose(hole.gamma([top - 0.2, top, top + 0.2], toolface), [20.0, 70.0, 120.0])


def test_stations_build_hold_and_turn() -> None:
    hole = Hole(
        0.0, 90.0, inclination=10.0, azimuth=350.0, sections=(Section(30, build=3), Section(30), Section(9, turn=15))
    )
    depth, inclination, azimuth = hole.stations(interval=30.0, margin=30.0)
    assert depth.tolist() == [-30, 0, 30, 60, 90, 120]
    assert inclination.tolist() == [10, 10, 13, 13, 13, 13]
    assert azimuth.tolist() == [350, 350, 350, 350, 5, 20]


@settings(deadline=None)
@given(seed=st.integers(0, 2**32), samples=st.integers(2, 3000))
def test_same_seed_same_bits(seed: int, samples: int) -> None:
    one, two = (simulate(samples=samples, seed=seed) for _ in range(2))
    for name in ("time", "depth", "toolface", "radius", "gamma", "inclination"):
        assert np.array_equal(getattr(one, name), getattr(two, name))


@given(
    seed=st.integers(0, 1000),
    samples=st.integers(2, 3000),
    stick_slip=st.floats(0, 1),
    advance_variation=st.floats(0, 0.99),
)
def test_samples_span_the_interval(seed: int, samples: int, stick_slip: float, advance_variation: float) -> None:
    tool = dataclasses.replace(EXACT, stick_slip=stick_slip, advance_variation=advance_variation)
    run = simulate(PLAIN, tool, samples=samples, seed=seed)
    assert (run.depth[0], run.depth[-1], run.depth.size) == (100.0, 110.0, samples)
    assert (np.diff(run.depth) >= 0).all()
    assert (np.diff(run.time) > 0).all()
    assert (run.toolface >= 0).all()
    assert (run.toolface < 360).all()
    assert np.array_equal(run.radius, PLAIN.radius(run.depth, run.toolface))


def test_noise_is_what_was_asked() -> None:
    run = simulate(PLAIN, Tool(noise=0.002), samples=100_000)
    assert np.std(run.radius - 0.1) == pytest.approx(0.002, rel=0.02)


def test_missing_samples_leave_the_others_as_they_were() -> None:
    every = simulate(PLAIN, EXACT, samples=20_000)
    some = simulate(PLAIN, dataclasses.replace(EXACT, missing=0.5), samples=20_000)
    assert 0.45 < some.depth.size / every.depth.size < 0.55
    assert np.isin(some.time, every.time).all()


def test_lift_scans_a_stretch_again() -> None:
    tool = dataclasses.replace(EXACT, lifts=(Lift(104.0, 3.0), Lift(110.0, 2.0)))
    run = simulate(PLAIN, tool, samples=50_000)
    back = np.flatnonzero(np.diff(run.depth) < 0)
    assert back.size == 2
    np.testing.assert_allclose(run.depth[back], [104.0, 110.0], atol=1e-3)
    np.testing.assert_allclose(run.depth[back + 1], [101.0, 108.0], atol=1e-3)
    assert (np.diff(run.time) > 0).all()
    assert run.depth[-1] == 110.0


def test_gamma_image_samples_the_truth_at_sector_centres() -> None:
    run = simulate(Hole.example(100.0, 110.0), EXACT, samples=10)
    assert run.gamma.shape == (run.gamma_depth.size, 16) == (101, 16)
    assert run.gamma[37, 5] == run.hole.gamma(run.gamma_depth[37], 5.5 * 22.5)


def test_example_hole_has_everything_in_it() -> None:
    hole = Hole.example()
    assert hole.washouts
    assert hole.breakouts
    assert len(hole.beds) > 10
    assert min(hole.ovality, hole.spiral, hole.rugosity) > 0
    wide = hole.radius(np.linspace(2000, 2050, 5000)[:, None], np.arange(0, 360, 5.0))
    assert 0.1 < wide.min() < wide.max() < 0.17


@pytest.mark.parametrize(
    "make",
    [
        lambda: Hole(start=10, stop=10),
        lambda: Hole(bit_diameter=0),
        lambda: Hole(rugosity=1e-3, rugosity_length=0),
        lambda: Hole(spiral=1e-3, spiral_length=0),
        lambda: Hole(spiral=0.2),
        lambda: Washout(30, 20, 0.01),
        lambda: Breakout(20, 20, 0, 60, 0.01),
        lambda: Breakout(20, 30, 0, 0, 0.01),
        lambda: Hole(beds=(Bed(2010, 60), Bed(2005, 90))),
        lambda: Tool(advance=0),
        lambda: Tool(noise=-1),
        lambda: Tool(missing=1),
        lambda: Tool(sectors=0),
        lambda: simulate(samples=1),
        lambda: simulate(PLAIN, Tool(missing=0.999), samples=2),
        lambda: simulate(PLAIN, Tool(lifts=(Lift(111, 1),))),
        lambda: simulate(PLAIN, Tool(lifts=(Lift(105, 6),))),
    ],
)
def test_bad_input(make: object, golden: Golden) -> None:
    with pytest.raises(ValueError) as caught:  # noqa: PT011 - the whole text is compared
        make()  # type: ignore[operator]
    golden(str(caught.value))


def test_whole_numbers_are_taken_as_the_numbers_they_are() -> None:
    whole = {
        "start": 100,
        "stop": 130,
        "bit_diameter": 1,
        "overgauge": 0,
        "top_gamma": 60,
        "inclination": 5,
        "azimuth": 0,
    }
    shapes = {
        "washouts": (Washout(104, 110, 1),),
        "breakouts": (Breakout(112, 120, 90, 60, 1),),
        "beds": (Bed(110, 100),),
    }
    path = {"sections": (Section(30, build=3),)}
    hole, same = (Hole(**{name: of(value) for name, value in whole.items()}, **shapes, **path) for of in (int, float))
    lengths = {"rotation": 60, "advance": 36, "sample_rate": 1, "image_step": 1, "noise": 0, "stick_slip": 0}
    for a, b in zip(hole.stations(30, 30), same.stations(30.0, 30.0), strict=True):
        assert a.dtype == np.float64
        np.testing.assert_array_equal(a, b)
    made, wanted = (
        simulate(hole, Tool(**lengths)),
        simulate(same, Tool(**{name: float(of) for name, of in lengths.items()})),
    )
    for name in ("depth", "toolface", "radius", "gamma_depth", "gamma", "inclination"):
        np.testing.assert_array_equal(getattr(made, name), getattr(wanted, name))
