"""Streams that are well formed and wrong alarm; operations of a rig do not; a replay reports the same."""

from __future__ import annotations

import re
from dataclasses import replace

import numpy as np
import pytest
from live_wires import WALL, Clock
from watched_rig import BIT, Operations, changed, watched, with_samples

from helibore import Live
from helibore.live.alarms import MOMENTARY, Alarms
from helibore.live.rules.configuration import parse
from helibore.live.wire import wits

WIRED = Operations(every=1.0, sample_every=1.0, trips=False)
FOUR = replace(WIRED, sensors=4)
AFTER = 7200.0


def stuck(one, value):
    return lambda sensor, toolface, radius: (sensor, toolface, value if sensor == one else radius)


WRONG = {
    "the tool dies": (Operations(trips=False), lambda m: replace(m, samples=[]), 0, "no_samples", 1300),
    "a wired tool dies": (WIRED, lambda m: replace(m, samples=[]), 0, "no_samples", 1300),
    "the depth slips down": (Operations(trips=False), lambda m: replace(m, bit=m.bit + 9.3, hole=m.hole + 9.3), 0,
                             "depth_step", 30),
    "the depth slips up": (Operations(trips=False), lambda m: replace(m, bit=m.bit - 9.3), 0, "depth_step", 30),
    "the depth slips far": (Operations(trips=False), lambda m: replace(m, bit=m.bit + 60, hole=m.hole + 60), 0,
                            "depth_step", 30),
    "another hole": (Operations(trips=False), lambda m: replace(m, bit=m.bit - 20, hole=m.hole - 20), 0,
                     "hole_falls", 30),
    "a sensor sticks": (FOUR, lambda m: with_samples(m, stuck(2, 0.131)), 4, "sensors", 400),
    "a sensor sticks at its last value": (FOUR, lambda m: with_samples(m, stuck(1, 0.1093)), 4, "stays", 1200),
    "a sensor is worn": (FOUR, lambda m: with_samples(m, lambda s, t, r: (s, t, r - 0.0035 * (s == 1))), 4,
                         "sensors", 400),
    "the radius sticks": (Operations(trips=False), lambda m: with_samples(m, stuck(0, 0.1093)), 0, "stays", 2400),
    "the toolface sticks": (Operations(trips=False), lambda m: with_samples(m, lambda s, _, r: (s, 77.0, r)), 0,
                            "toolface_stays", 6000),
    "the toolface is in tens of degrees": (Operations(trips=False),
                                           lambda m: with_samples(m, lambda s, t, r: (s, t / 10, r)), 0,
                                           "toolface_stays", 6000),
}  # fmt: skip


IN_WORDS = {
    "stays": r"(caliper|radius 2) constant since \d+ m",
    "depth_step": r"bit depth jumped by [+-]\d+\.\d m",
    "hole_falls": r"hole depth fell from \d+\.\d m to \d+\.\d m",
}


@pytest.mark.parametrize("name", WRONG)
def test_a_wrong_stream_alarms(name):
    operations, change, sensors, rule, delay = WRONG[name]
    operations = replace(operations, seed=31)
    found, watch = watched(changed(operations.run((AFTER + delay + 60) / 3600), AFTER, change), sensors)
    assert min(time for time, *_ in found) >= AFTER, "a right stream alarms"
    times = [time for time, of, _ in found if of == rule]
    assert times, f"nothing but {found} was reported"
    assert AFTER <= times[0] <= AFTER + delay
    said = [text.split(": ")[0] for _, of, text in found if of == rule]
    first = re.compile(IN_WORDS.get(rule, ".+"))
    assert all(first.fullmatch(one) for one in said), f"rig mode shows {said}"
    assert rule in MOMENTARY or ("mwd" in str(watch.active) and (rule, "mwd") in watch.active)


@pytest.mark.parametrize("ratio", [2.0, 0.5, 1 / 25.4, 2 / 25.4])
def test_radii_of_another_scale_alarm(ratio):
    moments = Operations(seed=5, trips=False).run(9)
    found, _ = watched(changed(moments, 0, lambda m: with_samples(m, lambda s, t, r: (s, t, r * ratio))))
    assert [rule for _, rule, _ in found] == ["radius_scale"]
    assert f"{1e3 * (BIT + 0.001) * ratio:.1f}"[:3] in found[0][2]


def test_a_casing_does_not_alarm_as_another_scale():
    """The tool logs casing of twice the bit above the hole; no sample is of hole that this bit drilled."""
    found, _ = watched(
        replace(moment, bit=1500.0, samples=[(0, t, 2 * BIT) for _, t, _ in moment.samples])
        for moment in Operations(seed=6, trips=False).run(3)
    )
    assert "radius_scale" not in {rule for _, rule, _ in found}


OPERATIONS = {
    "telemetry": (Operations(), 0),
    "wired": (WIRED, 0),
    "four sensors": (FOUR, 4),
    "rounded to 1 mm": (Operations(rounding=0.001), 0),
    "wired, rounded": (replace(WIRED, rounding=0.001), 0),
    "exact rpm": (replace(WIRED, exact_rpm=True), 0),
    "quick telemetry": (Operations(sample_every=8.0), 0),
    "slow telemetry": (Operations(sample_every=60.0), 0),
}


@pytest.mark.parametrize("name", OPERATIONS)
def test_operations_do_not_alarm(name):
    operations, sensors = OPERATIONS[name]
    hours = 48.0 if operations.every > 1 else 5.0
    found, watch = watched(replace(operations, seed=71).run(hours), sensors)
    assert (found, watch.active) == ([], {})


def test_sensors_of_which_each_sees_its_own_side_are_not_compared():
    """Sampled once a turn; one sensor sees a key seat each time."""
    own_side = changed(
        replace(FOUR, seed=72).run(0.5),
        0,
        lambda m: with_samples(m, lambda s, _, r: (s, 90.0 * s, r + 0.02 * (s == 2))),
    )
    assert "sensors" not in {rule for _, rule, _ in watched(own_side, 4)[0]}


def test_windows_of_any_size_give_the_same_events():
    def moments():
        return changed(
            Operations(seed=3, trips=False).run(6),
            AFTER,
            lambda m: replace(m, bit=m.bit - 9.3, hole=m.hole - 9.3, samples=[]),
        )

    one, watch = watched(moments())
    for window in (7, 1000):
        found, again = watched(moments(), window=window)
        assert found == one
        assert again.active == watch.active
    assert len(one) > 1


SENT = (
    WALL
    + '[source.mwd]\naddress = "host"\nunits = "metric"\n'
    + 'items = { bit_depth = "0108", hole_depth = "0110", rotation = "0120" }\n'
    + 'caliper = { toolface = ["5010"], radius = ["5012"], offset = 12.0 }\n'
)


def _send(live, clock, moment):
    clock.step(5.0)
    items = [(108, f"{moment.bit - 1890:.2f}"), (110, f"{moment.hole - 1890:.2f}"), (120, f"{moment.rpm:.0f}")]
    for _, toolface, radius in moment.samples[:1]:
        items += [(5010, f"{toolface:.1f}"), (5012, f"{1000 * radius:.2f}")]
    live.receive("mwd", wits.frame(items))


def test_the_alarm_begins_ends_and_a_replay_says_the_same(tmp_path):
    clock = Clock()
    with Live(parse(SENT), tmp_path, clock=clock) as live:
        alarms = Alarms(live, {"mwd": "connected"})
        begun = set()
        operations = Operations(seed=8, trips=False)
        for moment in operations.run(4):
            dead = 3600 < moment.time < 9000
            _send(live, clock, replace(moment, samples=[]) if dead else moment)
            alarms.check()
            begun |= {alarm.rule for alarm in alarms.active}
        assert begun - {"missing", "sync"} == {"no_samples"}  # the tool begins late; no thread syncs
        assert "no_samples" not in {alarm.rule for alarm in alarms.active}, "the alarm did not end"
        assert live.model.events.counts["mwd", "no_samples"] == 1
        checkpoint = live.checkpoint()
        assert checkpoint is not None
        counts = {key: n for key, n in live.model.events.counts.items() if not key[1].startswith("alarm_")}
    assert Live.replay(tmp_path).model.events.counts == counts
    with Live(parse(SENT), tmp_path, clock=clock) as again:
        assert again.model.watch.active == {}
        assert again.model.events.counts["mwd", "no_samples"] == 1
        for step in range(400):
            depth = moment.hole + 0.01 * step
            _send(again, clock, replace(moment, samples=[], bit=depth, hole=depth))
        assert ("no_samples", "mwd") in again.model.watch.active
        assert again.checkpoint() is not None
    with Live(parse(SENT), tmp_path, clock=clock) as restarted:
        assert restarted.model.events.counts["", "checkpoint"] == 0
        assert ("no_samples", "mwd") in restarted.model.watch.active


def test_toolfaces_in_tenths_alarm():
    live = Live(parse(SENT), clock=Clock())
    draw = np.random.default_rng(4)
    for toolface in draw.uniform(0, 3600, 100):
        live.receive("mwd", wits.frame([(5010, f"{toolface:.0f}"), (5012, "110")]))
    assert "tenths" in live.model.readers[1].seems_radians


def test_toolfaces_that_count_turns_do_not_alarm():
    live = Live(parse(SENT), clock=Clock())
    for toolface in np.arange(100) * 31.0:
        live.receive("mwd", wits.frame([(5010, f"{toolface:.0f}"), (5012, "110")]))
    assert live.model.readers[1].seems_radians == ""
