"""Pass numbers from the wire: they decide, differences are reported, layers and runs follow them, in a replay too."""

from __future__ import annotations

import json

import numpy as np
import pytest
from live_wires import FROM_BIT, Clock, refused, rig, same_bits, sample

from helibore import Live
from helibore.live import live as live_module
from helibore.live.model.pass_log import KEPT, PassLog
from helibore.live.rules.configuration import parse
from helibore.live.rules.pass_rules import PassNumbers
from helibore.live.snapshot_files import snapshot
from helibore.live.wire import wits

CALIPER = 'caliper = { toolface = ["5010"], radius = ["5012"]'
PLAIN = FROM_BIT.replace("LATENCY", "0.0")
NUMBERED = PLAIN.replace(CALIPER, 'items = { pass_number = "0812" }\n' + CALIPER)
LISTED = NUMBERED + "pass_numbers = { drill = [4], rescan = [5, 6], ream = [0] }\n"
PASSES = ("drill", "ream", "rescan", "trip", "unknown")


def numbered(live, number, toolface=30.0, sequence=None):
    """A triple whose frame says a pass number (None: says none)."""
    items = [(804, str(sequence))] if sequence is not None else []
    items += [(812, str(number))] if number is not None else []
    return live.receive("mwd", wits.frame([*items, (5010, f"{toolface:.2f}"), (5012, "110.00")]))


def names(live):
    return [(run.source, run.name, run.number, run.samples) for run in live.passes]


def reported(live):
    return [event.text for event in live.poll().events if event.rule == "pass"]


def test_without_a_number_the_string_says_the_pass():
    live = Live(parse(PLAIN), clock=Clock())
    for depth, activity in ((150, 2), (148, 2), (148, 4), (149, 8), (150, 2)):
        rig(live, depth, 150, activity=activity)
        sample(live)
    assert names(live) == [("mwd", name, None, 1) for name in ("drill", "rescan", "ream", "trip", "drill")]
    assert not reported(live)


def test_the_number_of_the_wire_decides_until_the_next_one_and_what_differs_is_told():
    clock = Clock()
    live = Live(parse(NUMBERED), clock=clock)
    for number in (None, 1, None, None, 2, None, -9999, None, 0, 1):
        clock.step(1)
        rig(live, 150)
        numbered(live, number)
    assert names(live) == [
        ("mwd", "drill", None, 1),
        ("mwd", "drill", 1, 3),
        ("mwd", "rescan", 2, 2),
        ("mwd", "drill", None, 2),  # a null takes the number back
        ("mwd", "drill", 0, 1),  # 0 is no pass
        ("mwd", "drill", 1, 1),
    ]
    assert reported(live) == ["pass number 2 means rescan, but the string's motion means drill; the number counts"] * 2
    assert live.model.events.counts["mwd", "pass"] == 2
    assert live.model.counts["pass rescan"] == 2
    start = live.model.clock.began
    assert [(run.start - start, run.stop - start) for run in live.passes][1] == (2 * 10**9, 4 * 10**9)
    assert {(run.top, run.bottom) for run in live.passes} == {(140.0, 140.0)}


def test_numbers_mean_what_the_configuration_says_and_others_are_unknown(golden):
    live = Live(parse(LISTED), clock=Clock())
    rig(live, 150)
    for number in (4, 5, 6, 0, 1):
        numbered(live, number)
    assert [(name, number) for _, name, number, _ in names(live)] == [
        ("drill", 4), ("rescan", 5), ("rescan", 6), ("ream", 0), ("unknown", 1)
    ]  # fmt: skip
    golden(reported(live)[-1])


def test_a_number_that_is_none_is_told_and_says_nothing():
    live = Live(parse(NUMBERED), clock=Clock())
    rig(live, 150)
    for number in ("1.5", "-3", "40000", "two"):
        numbered(live, number)
    assert names(live) == [("mwd", "drill", None, 4)]
    assert live.model.events.counts["mwd", "invalid"] == 4
    assert "pass number 1.5: must be a whole number from 0 to 32767" in live.model.events.latest[0].text


def test_what_a_late_or_repeated_frame_says_counts_for_it_alone():
    live = Live(parse(NUMBERED.replace("radius = [", 'depth = ["5011"], radius = [')), clock=Clock())

    def deep(number, sequence, depth):
        items = [(804, str(sequence)), *([(812, str(number))] if number else []), (5010, "1"), (5011, str(depth))]
        live.receive("mwd", wits.frame([*items, (5012, "110")]))

    rig(live, 150)
    for number, sequence, depth in ((1, 1, 140), (2, 3, 141), (None, 4, 142), (1, 2, 143), (None, 5, 144)):
        deep(number, sequence, depth)
    assert [(number, samples) for _, _, number, samples in names(live)] == [(1, 1), (2, 2), (1, 1), (2, 1)]
    deep(None, 5, 144)  # word for word as before: a duplicate, not drawn
    assert sum(run.samples for run in live.passes) == 5


def test_layers_take_passes_by_their_numbers():
    layers = '[layers]\nmain = ["drill", "unknown"]\nsecond = ["pass 2"]\nboth = ["pass 2", "pass 3"]\n'
    live = Live(parse(NUMBERED + layers), clock=Clock())
    rig(live, 150)
    for number, toolface in ((1, 10), (2, 20), (3, 30), (4, 40), (None, 50), (-9999, 60)):
        numbered(live, number, toolface)
    drawn = {name: wall.samples.toolface.tolist() for name, wall in live.layers.items()}
    assert drawn == {"main": [10, 60], "second": [20], "both": [20, 30]}
    assert live.model.counts["kept apart"] == 2


def test_each_source_counts_its_own_passes():
    other = NUMBERED + NUMBERED[NUMBERED.index("[source.mwd]") :].replace("mwd", "fe").replace("0812", "0710")
    live = Live(parse(other), clock=Clock())
    rig(live, 150)
    numbered(live, 2)
    live.receive("fe", wits.frame([(710, "1"), (5010, "10"), (5012, "110")]))
    numbered(live, None)
    live.append_samples([120.0], [10.0], [0.11])
    assert sorted(names(live)) == [("", "drill", None, 1), ("fe", "drill", 1, 1), ("mwd", "rescan", 2, 2)]


def test_replay_has_the_same_passes_whatever_the_window_and_the_slow_reader_agrees(tmp_path, monkeypatch, golden):
    clock, draw = Clock(), np.random.default_rng(8)
    expected, number, last = [], None, None  # the slow reader: (number, pass of the string) of each drawn sample
    with Live(parse(NUMBERED), tmp_path, clock=clock) as live:
        for i in range(300):
            clock.step(float(draw.choice([0.0, 0.4])))
            if i % 4 == 0:
                lifted, activity = bool(draw.random() < 0.5), int(draw.choice([2, 4]))
                rig(live, 120 + 0.01 * i - 3 * lifted, 120 + 0.01 * i, 60, activity)
                last = "ream" if activity == 4 else "rescan" if lifted else "drill"
                rig_order = len(expected)
            else:
                said = draw.choice([None, None, None, 1, 2, -9999])
                number = number if said is None else None if said == -9999 else int(said)
                numbered(live, said, float(draw.uniform(0, 360)))
                expected.append((number, {None: last, 1: "drill", 2: "rescan"}[number]))
    settled = expected[:rig_order]
    found = [(run.number, run.name) for run in live.passes for _ in range(run.samples)]
    assert found == settled + expected[len(settled) : len(found)]
    assert len(found) >= len(settled) > 150
    for records in (1, 5, 8192):
        monkeypatch.setattr(live_module, "WINDOW_RECORDS", records)
        again = Live.replay(tmp_path)
        assert same_bits(again.wall, live.wall)
        assert again.passes == live.passes
        assert again.model.counts == live.model.counts
        assert again.model.events.counts == live.model.events.counts
    snapshot(live, tmp_path / "now")
    table = (tmp_path / "now" / "passes.csv").read_text().splitlines()
    golden(table[0])
    assert len(table) == 1 + len(live.passes)
    first = live.passes[0]
    assert table[1].startswith(f"mwd,{first.name},{first.number or ''},2023-11-14T22:13:")
    assert table[1].endswith(f",{first.top!r},{first.bottom!r},{first.samples}")


def test_the_runs_that_are_kept_are_bounded():
    log = PassLog({1: ("a", PassNumbers())}, None)
    for number in range(KEPT + 50):
        log.add(np.array([1]), np.array([number]), np.array([0]), np.array([number]), np.array([1.0]))
    assert len(log.runs) == KEPT + 1
    assert log.runs[-1].number == KEPT + 49


def test_a_journal_of_before_goes_on_whether_a_number_is_mapped_or_not(tmp_path):
    Live(parse(PLAIN), tmp_path).close()
    Live(parse(PLAIN + "[layers]\n"), tmp_path).close()
    assert "pass_number" not in json.dumps(json.loads(parse(PLAIN).meaning())["sources"])
    with Live(parse(NUMBERED), tmp_path) as live:
        numbered(live, 4)
        assert 'pass_number = "0812"' in live.model.stretches[-1]["configuration"]
    assert parse(NUMBERED).meaning() != parse(LISTED).meaning()


@pytest.mark.parametrize(
    ("change", "place", "rule", "value"),
    [
        (("0812", "08x2"), "items.pass_number", "four digits RRII", "'08x2'"),
        (("drill = [4]", "drill = [5]"), "pass_numbers.rescan", "already listed under drill", "5"),
        (("[4]", "[-1]"), "pass_numbers.drill", "whole numbers from 0 to 32767", "[-1]"),
        (("[4]", '["4"]'), "pass_numbers.drill 1", "must be an integer", "'4'"),
        (("drill =", "drilling ="), "pass_numbers.drilling", "did you mean drill?", None),
        (('items = { pass_number = "0812" }\n', ""), "pass_numbers", "items.pass_number must also be set", None),
    ],
)
def test_what_is_wrong_is_named(change, place, rule, value):
    found = refused(LISTED.replace(*change))
    assert (found[0], found[2]) == (f"source.mwd.{place}", value)
    assert rule in found[1]


def test_a_pass_number_that_numbers_nothing_or_that_nobody_sends_is_refused(golden):
    place, rule, _ = refused(LISTED.replace('hole_depth = "0110"', 'pass_number = "0812"'))
    golden(place)
    assert "needs a caliper in this source" in rule
    place, rule, value = refused(PLAIN + '[layers]\na = ["pass 2"]\n')
    assert (place, rule, value) == ("layers.a", "no source maps pass_number", "'pass 2'")
