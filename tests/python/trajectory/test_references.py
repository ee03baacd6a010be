"""References against a frame transported step by step, a hysteresis loop, and a simulated well without a seam."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import helibore as hb
from helibore.trajectory.references import from_high_side, onto_path


def apart(a, b):
    return (np.asarray(a) - np.asarray(b) + 180) % 360 - 180


@pytest.mark.parametrize(("method", "tolerance"), [("minimum-curvature", 1e-8), ("radius-of-curvature", 1e-4)])
def test_transported_frame_against_double_reflection(method, tolerance):
    """Wang, Juettler, Zheng and Liu, ACM Trans. Graph. 27 (2008) 2: two mirrors a step, error of fourth order.

    The first mirror stands half-way between two points of the path, the second mends the tangent.
    """
    depths = [0, 200, 500, 800, 1100, 1400, 1700]
    survey = hb.Survey(depths, [0, 3, 40, 92, 88, 130, 60], [0, 200, 250, 310, 20, 40, 300])
    path = survey.path(method, reference="parallel-transport", extend=50)
    depth = np.arange(0.0, 1750.5, 0.5)
    position, tangent, frame = path.position(depth), path.tangent(depth), path.frame(depth)
    zero = np.array([1.0, 0.0, 0.0])
    for k in range(depth.size - 1):
        np.testing.assert_allclose(frame[k, 0], zero, atol=tolerance)
        v = position[k + 1] - position[k]
        mirrored = zero - 2 / (v @ v) * (v @ zero) * v
        left = tangent[k] - 2 / (v @ v) * (v @ tangent[k]) * v
        v = tangent[k + 1] - left
        zero = mirrored - 2 / (v @ v) * (v @ mirrored) * v
    np.testing.assert_allclose(frame[:, 1], np.cross(tangent, frame[:, 0]), atol=1e-12)


def test_transported_is_exact_where_it_is_known():
    """A build at one azimuth: the high side lies at toolface = azimuth; a turn in the horizontal keeps up."""
    build = hb.Survey([0, 100, 600], [0, 0, 90], [0, 0, 70]).path(reference="parallel-transport")
    depth = np.linspace(101, 600, 50)
    np.testing.assert_allclose(apart(onto_path(np.zeros(50), depth, build, True), 70), 0, atol=1e-9)
    level = hb.Survey([0, 400], [90, 90], [10, 100]).path(reference="parallel-transport")
    np.testing.assert_allclose(level.frame([0, 123, 400])[:, 0], [[0, 0, -1]] * 3, atol=1e-12)
    down = hb.Survey([0, 400], [0, 0], [0, 0]).path(reference="parallel-transport")
    np.testing.assert_allclose(down.frame([0, 300])[:, 0], [[1, 0, 0]] * 2, atol=1e-15)


def test_transported_has_the_same_bits_when_the_survey_grows():
    depth, inclination, azimuth = [0, 100, 200, 300, 400], [0, 10, 30, 60, 89], [0, 20, 50, 40, 90]
    short = hb.Survey(depth[:4], inclination[:4], azimuth[:4]).path(reference="parallel-transport")
    grown = hb.Survey(depth, inclination, azimuth).path(reference="parallel-transport")
    where = np.linspace(0, 300, 1001)
    np.testing.assert_array_equal(short.frame(where), grown.frame(where))


@settings(deadline=None, max_examples=30)
@given(st.integers(0, 10_000), st.sampled_from(["high-side", "north", "parallel-transport"]))
def test_onto_path_keeps_the_point_in_space(seed, reference):
    rng = np.random.default_rng(seed)
    survey = hb.Survey([0, 100, 250, 400], rng.uniform(10, 80, 4), rng.uniform(0, 360, 4))
    depth, toolface, tag = rng.uniform(0, 400, 60), rng.uniform(0, 360, 60), rng.random(60) < 0.5
    path = survey.path(reference=reference)
    turned = onto_path(toolface, depth, path, tag)
    frames = {name: survey.path(reference=name).frame(depth) for name in ("high-side", "north")}
    source = np.where(tag[:, None, None], frames["high-side"], frames["north"])

    def direction(angle, frame):
        a = np.radians(angle)[:, None]
        return np.cos(a) * frame[:, 0] + np.sin(a) * frame[:, 1]

    np.testing.assert_allclose(direction(turned, path.frame(depth)), direction(toolface, source), atol=1e-9)
    assert np.all((turned >= 0) & (turned < 360))
    if reference != "parallel-transport":
        own = onto_path(toolface, depth, path, reference == "high-side")
        np.testing.assert_allclose(apart(own, toolface), 0, atol=1e-9)  # from itself to itself


@given(st.lists(st.floats(0, 10), max_size=50))
def test_hysteresis_against_loop(inclination):
    state, slow = None, []
    for value in inclination:
        if value >= 6:
            state = True
        elif value <= 4:
            state = False
        elif state is None:
            state = value >= 5
        slow.append(state)
    np.testing.assert_array_equal(from_high_side(inclination), np.array(slow, dtype=bool))


def test_no_seam_in_a_well_from_vertical_to_horizontal():
    """The tool counts from north, then from the high side. The truth is a groove that runs down the wall untwisted."""
    survey = hb.Survey([0, 20, 35, 50, 100, 200], [0, 0, 3, 9, 40, 90], [0, 0, 215, 225, 230, 231])
    path = survey.path(reference="parallel-transport")
    depth = np.linspace(0, 200, 120_000)
    transported = 360 * (np.arange(depth.size) * 0.6180339887498949 % 1)  # golden section: even cover

    def truth(toolface):
        return 0.108 + 0.006 * np.exp(2.0 * (np.cos(np.radians(toolface - 140)) - 1))

    inclination = np.degrees(np.arccos(np.clip(path.tangent(depth)[:, 2], -1, 1)))
    high_side = from_high_side(inclination)
    change = int(np.argmax(high_side))
    assert 30 < depth[change] < 50
    measured = transported.copy()
    for name, tag in (("north", False), ("high-side", True)):  # what the tool says: the same direction in its reference
        rows = high_side == tag
        zero = path.frame(depth[rows])[:, 0]
        frame = survey.path(reference=name).frame(depth[rows])
        measured[rows] += np.degrees(np.arctan2((zero * frame[:, 1]).sum(1), (zero * frame[:, 0]).sum(1)))
    toolface = onto_path(measured % 360, depth, path, high_side)
    np.testing.assert_allclose(apart(toolface, transported), 0, atol=1e-9)

    def error(angle):
        wall = hb.reconstruct(
            hb.Caliper(depth, angle % 360, truth(transported)), bit_diameter=0.216, sectors=64, pitch=0.1
        )
        miss = np.abs(wall.radius - truth(wall.toolface))
        near = np.abs(wall.depth - depth[change]) < 1.0
        return np.nanmax(miss[near]), np.nanmax(miss[~near])

    at_change, elsewhere = error(toolface)
    assert at_change <= elsewhere < 1e-3
    assert error(measured)[0] > 3e-3  # and with the tool's own two references there is one
    surface = hb.reconstruct(
        hb.Caliper(depth, toolface, truth(transported)), bit_diameter=0.216, sectors=64, pitch=0.1, stop_depth=199.9
    ).surface(path)
    assert np.isfinite(surface.vertices).all()


@pytest.mark.parametrize("method", ["minimum-curvature", "radius-of-curvature"])
def test_surface_places_a_transported_wall_as_the_frames_say(method):
    path = hb.Survey([0, 60, 120], [0, 50, 90], [30, 80, 60]).path(method, reference="parallel-transport")
    rng = np.random.default_rng(6)
    wall = hb.reconstruct(
        hb.Caliper(rng.uniform(0, 120, 9000), rng.uniform(0, 360, 9000), rng.uniform(0.1, 0.12, 9000)),
        bit_diameter=0.2, start_depth=0.5, stop_depth=119.0,
    )  # fmt: skip
    frame, a = path.frame(wall.depth), np.radians(wall.toolface)[:, None]
    expected = path.position(wall.depth) + wall.radius[:, None] * (np.cos(a) * frame[:, 0] + np.sin(a) * frame[:, 1])
    np.testing.assert_allclose(wall.surface(path).vertices, expected, atol=1e-9)


@pytest.mark.parametrize(
    "call",
    [
        lambda _: from_high_side([1], 6, 4),
        lambda _: from_high_side([1, np.nan]),
        lambda p: onto_path([0, 1], [200, 20], p, True),
        lambda p: onto_path([0], [300], p, False),
        lambda p: onto_path([0], [200, 3], p, True),
        lambda p: onto_path([0], [200], p, np.array([True, False])),
    ],
)  # fmt: skip
def test_errors(call, golden):
    path = hb.Survey([0, 100, 300], [0, 0, 90], [0, 0, 0]).path(reference="parallel-transport")
    with pytest.raises(ValueError) as caught:  # noqa: PT011 - the whole text is compared
        call(path)
    golden(str(caught.value))
