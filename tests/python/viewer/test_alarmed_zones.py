"""The page of a live wall lists what an alarm names, also where it is too short or too oval to be a zone."""

from __future__ import annotations

import numpy as np
import pytest

import helibore as hb
from helibore.live.rules.configuration import AlarmLimits
from helibore.viewer.feed import Feed

BIT, SECTORS, PITCH = 0.216, 16, 0.1


def zones(radius_of_turn: dict[int, np.ndarray], **limits: float) -> list[dict[str, object]]:
    """The page's zones of a wall of 100 turns of bit size, but for some turns, with these limits of alarms."""
    k = np.arange(100 * SECTORS)
    radius = np.full(len(k), BIT / 2)
    for turn, values in radius_of_turn.items():
        radius[turn * SECTORS : (turn + 1) * SECTORS] = values
    caliper = hb.Caliper(1000 + k * PITCH / SECTORS, k * 360 / SECTORS % 360, radius)
    wall = hb.reconstruct(caliper, bit_diameter=BIT, sectors=SECTORS, pitch=PITCH, start_depth=1000.0, neighbors=1)
    feed = Feed(wall, path=None, attributes={}, well="", alarmed=AlarmLimits(**limits).by_kind)
    feed.find_zones()
    return [dict(zone) for zone in feed.scene.state.zones]


WIDE, TIGHT = np.full(SECTORS, BIT / 2 + 0.02), np.full(SECTORS, BIT / 2 - 0.005)
OVAL = BIT / 2 + 0.012 * (1 + np.cos(np.linspace(0, 4 * np.pi, SECTORS, endpoint=False)))


@pytest.mark.parametrize(
    ("turns", "limits", "kind", "place", "measure"),
    [
        ({40: WIDE}, {"washout": 0.03}, "washout", (1004.0, 1004.1), 0.04),
        ({40: WIDE, 41: WIDE}, {"washout": 0.03}, "washout", (1004.0, 1004.2), 0.04),
        ({60: TIGHT}, {"tight": 0.006}, "undergauge", (1006.0, 1006.1), -0.01),
        (dict.fromkeys([*range(20, 25), *range(27, 30)], OVAL), {"washout": 0.02}, "washout", (1002.0, 1003.0), 0.024),
    ],
)
def test_turns_that_an_alarm_names_are_in_the_list(turns, limits, kind, place, measure) -> None:
    assert kind not in [zone["kind"] for zone in zones(turns)]
    (found,) = [zone for zone in zones(turns, **limits) if zone["kind"] == kind]
    assert (found["start"], found["stop"]) == pytest.approx(place)
    assert found["measure"] == pytest.approx(measure, abs=2e-3)
    (limit,) = limits.values()
    assert found["confidence"] > 0.99, "that it is beyond the limit"
    assert found["measured"] == pytest.approx(1, abs=0.5)
    assert found["severity"] == pytest.approx(abs(measure) / limit, abs=0.1)


def test_a_washout_that_is_a_zone_is_listed_once_and_one_within_the_limit_is_not() -> None:
    long = dict.fromkeys(range(40, 50), WIDE)
    assert zones(long, washout=0.03) == zones(long)
    assert zones({40: WIDE}, washout=0.05) == []
