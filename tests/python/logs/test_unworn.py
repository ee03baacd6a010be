"""The unworn circle and the pipe of ideal key seats, as an offset tool sees them; heights do not depend on the tool."""

from __future__ import annotations

import math
import pickle
from types import SimpleNamespace

import numpy as np
import pytest
from golden_texts import Golden
from hypothesis import given, settings
from hypothesis import strategies as st

import helibore as hb
from helibore._core import unworn_columns
from helibore.base.arrays import Floats
from helibore.base.errors import InputError
from helibore.base.units import INCH
from helibore.logs.log_columns import LOBES
from helibore.logs.turn_logs import turn_logs

K, BIT = 64, 8.5 * INCH
TOOLFACE = np.arange(K) * 360 / K


def seen(circles: list[tuple[float, float, float]], tool: complex = 0j) -> Floats:
    """Return the radii of a section, the union of circles (toolface, distance, radius), from a tool off its centre."""
    ray = np.exp(1j * np.radians(TOOLFACE))
    far = []
    for toolface, distance, radius in circles:
        to = distance * np.exp(1j * math.radians(toolface)) - tool
        along, aside = (ray.conj() * to).real, (ray.conj() * to).imag
        inside = radius**2 - aside**2
        far.append(np.where(inside > 0, along + np.sqrt(np.maximum(inside, 0)), 0))
    return np.max(far, axis=0)


def key_seat(pipe: float, height: float, toolface: float, radius: float = BIT / 2) -> list[tuple[float, float, float]]:
    return [(0.0, 0.0, radius), (toolface, radius + height - pipe / 2, pipe / 2)]


def measured(*turns: Floats, counts: Floats | None = None, bit: float = BIT) -> dict[str, Floats]:
    around = np.empty(0) if counts is None else counts
    return unworn_columns(np.concatenate(turns), K, 0.0, bit, around, 1)


@settings(max_examples=60, deadline=None)
@given(
    pipe=st.floats(3.5 * INCH, 6.5 * INCH),
    height=st.floats(0.01, 0.04),
    toolface=st.floats(0, 359),
    tool=st.tuples(st.floats(0, 0.01), st.floats(0, 360)),
    over=st.floats(-0.001, 0.003),
)
def test_an_ideal_key_seat_gives_its_circle_its_height_and_its_pipe(
    pipe: float, height: float, toolface: float, tool: tuple[float, float], over: float
) -> None:
    place = tool[0] * np.exp(1j * math.radians(tool[1]))
    found = measured(seen(key_seat(pipe, height, toolface, BIT / 2 + over), place))
    assert found["unworn_diameter"][0] == pytest.approx(BIT + 2 * over, abs=5e-4)
    centre = complex(found["unworn_0"][0], found["unworn_90"][0])
    assert abs(centre + place) < 5e-4
    assert found["lobe1_height"][0] == pytest.approx(height, abs=0.001)
    assert abs((found["lobe1_toolface"][0] - toolface + 180) % 360 - 180) < 2
    assert found["lobe1_pipe"][0] == pytest.approx(pipe, abs=0.002)
    assert np.isnan(found["lobe2_height"][0])


def test_two_lobes_are_in_the_order_of_their_height() -> None:
    circles = key_seat(5 * INCH, 0.012, 40) + key_seat(5 * INCH, 0.02, 215)
    found = measured(seen(circles))
    assert [found[f"lobe{n}_toolface"][0] for n in (1, 2)] == pytest.approx([215, 40], abs=2)
    assert [found[f"lobe{n}_height"][0] for n in (1, 2)] == pytest.approx([0.02, 0.012], abs=5e-4)


def test_what_does_not_count_holds_no_circle_and_tops_no_lobe() -> None:
    section = seen(key_seat(5 * INCH, 0.02, 90))
    off = np.abs((TOOLFACE - 90 + 180) % 360 - 180)
    found = measured(section, counts=(off > 45).astype(np.float64))
    assert found["unworn_diameter"][0] == pytest.approx(BIT, abs=1e-4)
    assert np.isnan(found["lobe1_height"][0])
    assert np.isnan(measured(section, counts=(off < 40).astype(np.float64))["unworn_diameter"][0]), "under a quarter"


def test_a_turn_stands_alone_and_lengths_scale_with_the_bit() -> None:
    first, second = seen(key_seat(5 * INCH, 0.02, 90), 0.004j), seen(key_seat(4 * INCH, 0.03, 300))
    hole = np.full(K, np.nan)
    both, alone = measured(first, hole, second), measured(second)
    threads = unworn_columns(np.tile(first, 300), K, 0.0, BIT, np.empty(0), 2)
    twice = measured(2 * second, bit=2 * BIT)
    for name in both:
        assert both[name][2] == alone[name][0] or np.isnan(alone[name][0])
        assert np.isnan(both[name][1])
        assert (threads[name] == both[name][0]).all() or np.isnan(both[name][0])
        angle = name.endswith(("toolface", "width"))
        assert twice[name][0] == pytest.approx(alone[name][0] * (1 if angle else 2), abs=1e-9, nan_ok=True)


def test_what_the_core_refuses(golden: Golden) -> None:
    with pytest.raises(InputError, match=r"^bit_diameter = 0"):
        measured(np.full(K, 0.1), bit=0.0)
    with golden.raises():
        measured(np.full(K, 0.1), counts=np.ones(3))


def test_a_step_has_the_highest_lobe_of_its_turns() -> None:
    rows = [seen(key_seat(5 * INCH, height, 90 + 100 * height)) for height in (0.01, 0.03, 0.02)] + [
        np.full(K, BIT / 2)
    ] * 3
    shape = SimpleNamespace(sectors=K, pitch=0.1, start_toolface=0.0, bit_diameter=BIT)
    turns = turn_logs(SimpleNamespace(settings=shape, start_depth=12.0, radius=np.concatenate(rows)))
    steps = turns.by_step(0.3)
    for name in LOBES:
        np.testing.assert_array_equal(getattr(steps, name), getattr(turns, name)[[1, 3]])
    means = [turns.unworn_0[:3].mean(), turns.unworn_0[3:].mean()]
    np.testing.assert_allclose(steps.unworn_0, means, rtol=1e-14)


def test_circles_lobes_and_sections_are_those_of_the_wall_that_the_logs_were_made_from() -> None:
    depth = np.arange(1000.0, 1002.0, 0.002)
    toolface, radius = (depth * 3571.0) % 360, 0.108 + 0.006 * (depth > 1001.0)
    live = hb.Wall(bit_diameter=0.216, sectors=16)
    live.append(depth, toolface, radius)
    early, late = live.logs(), live.logs(0.5)
    before, sections = early.unworn_diameter.copy(), early.section.copy()
    live.append(depth, toolface + 1e-3, radius + 0.01)
    for of in (late, pickle.loads(pickle.dumps(late)), late.between(None, None)):
        np.testing.assert_array_equal(of.unworn_diameter, before)
        np.testing.assert_array_equal(of.section, sections)
    assert live.logs().unworn_diameter[2] > before[2] + 0.005
    with pytest.raises(ValueError, match="read-only"):
        late.lobe1_height[0] = 1.0
