"""Channels of the rig: latest values, curves by time and depth, alarms low and high; a replay and a restart agree."""

from __future__ import annotations

import numpy as np
import pytest
from live_wires import WALL, Clock, refused

from helibore import Live
from helibore.live.alarms import Alarms
from helibore.live.rules.configuration import parse
from helibore.live.wire import wits

RIG = WALL + '[source.rig]\naddress = "host"\nunits = "metric"\nitems = { bit_depth = "0108", hole_depth = "0110" }\n'
SHOWN = RIG + '[source.rig.show.WOB]\nitem = "0117"\nunit = "kN"\nlow = 2.0\nhigh = 90.0\n'


def drill(live: Live, clock: Clock, weights: list[float], start: float = 100.0, seconds: float = 5.0) -> None:
    """Drill 2 cm a frame with these weights on bit."""
    for number, weight in enumerate(weights):
        clock.step(seconds)
        depth = f"{start + 0.02 * number:.2f}"
        live.receive("rig", wits.frame([(108, depth), (110, depth), (117, f"{weight:.1f}")]))


def test_a_channel_has_means_by_time_and_by_depth(tmp_path):
    clock = Clock()
    with Live(parse(SHOWN), tmp_path, clock=clock) as live:
        drill(live, clock, [10.0 + number for number in range(40)])
        channel = live.model.channels.by_name["WOB"]
        depth, values = channel.by_depth()
        assert depth == pytest.approx(100.05 + 0.1 * np.arange(len(depth)))
        assert values[:2] == pytest.approx([12.0, 17.0])
        times, means = channel.by_time()
        assert np.diff(times) == pytest.approx(10.0)
        assert np.diff(means)[1:] == pytest.approx(2.0)  # the first mean has one value
        assert (channel.value, channel.unit) == (49.0, "kN")
        live.checkpoint()
        drill(live, clock, [60.0, 61.0])
    restarted = Live(parse(SHOWN), tmp_path, clock=clock)
    restarted.close()
    for one in (restarted, Live.replay(tmp_path)):
        again = one.model.channels.by_name["WOB"]
        for mine, other in zip((*channel.by_depth(), *channel.by_time()), (*again.by_depth(), *again.by_time()),
                               strict=True):  # fmt: skip
            assert mine.tobytes() == other.tobytes()


def test_only_new_hole_is_on_the_curve_by_depth():
    clock, live = Clock(), Live(parse(SHOWN))
    drill(live, clock, [10.0] * 20)
    for _ in range(10):
        live.receive("rig", wits.frame([(108, "95.00"), (110, "100.38"), (117, "70.0")]))
    drill(live, clock, [20.0] * 20, 100.4)
    assert set(live.model.channels.by_name["WOB"].by_depth()[1].tolist()) == {10.0, 20.0}


def test_a_value_beyond_a_limit_is_an_alarm_until_it_is_back_for_a_minute():
    clock = Clock()
    live = Live(parse(SHOWN), clock=clock)
    alarms = Alarms(live, {"rig": "connected"})

    def named() -> list[str]:
        alarms.check()
        return [f"{one.rule} {one.source}: {one.text}" for one in alarms.active if one.rule in ("low", "high")]

    drill(live, clock, [50.0, 50.0])
    assert named() == []
    drill(live, clock, [95.0, 50.0])
    assert named() == ["high rig WOB: WOB is 95 kN, above high = 90 kN"]
    drill(live, clock, [50.0] * 13)
    assert named() == []
    drill(live, clock, [1.0])
    assert named() == ["low rig WOB: WOB is 1 kN, below low = 2 kN"]
    assert [key[1] for key in live.model.events.recorded] == ["high", "low"]


@pytest.mark.parametrize(
    ("line", "place"),
    [
        ('item = "9"', "source.rig.show.WOB.item"),
        ('item = "0117"\nlimits = [1.0]', "source.rig.show.WOB.limits"),
        ('item = "0117"\nlow = 3.0\nhigh = 2.0', "source.rig.show.WOB.low"),
        ('unit = "kN"', "source.rig.show.WOB.item"),
    ],
)
def test_a_wrong_channel_is_refused(line, place):
    assert refused(f"{RIG}[source.rig.show.WOB]\n{line}\n")[0] == place


def test_two_sources_cannot_show_one_channel():
    other = '[source.other]\naddress = "host"\nunits = "metric"\nshow.WOB = { item = "0117" }\n'
    place, rule, _ = refused(SHOWN + other)
    assert (place, rule) == ("source.other.show.WOB", "is mapped by source.rig already")


def test_a_store_channel_of_another_unit_is_not_read():
    """A channel of named values takes its unit from the settings, as the sectors of an image do."""
    text = WALL + (
        '[source.store]\naddress = "https://store.example/w"\nitems = { bit_depth = "BIT" }\n'
        'log = { well = "w", wellbore = "b", log = "l", index = "time" }\nshow.WOB = { name = "WOB", unit = "kN" }\n'
    )
    source = parse(text).sources["store"]
    assert [(one.name, one.unit) for one in source.curves] == [("BIT", ""), ("WOB", "kN")]
