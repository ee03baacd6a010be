"""Another hole from a record on, and a shift of all depths: the journal has them, and a replay gives the same."""

from __future__ import annotations

import json

import numpy as np
import pytest
from live_wires import WALL, Clock, refused

from helibore import Live
from helibore.base.errors import InputError
from helibore.base.utc_time import utc
from helibore.live.alarms import Alarms
from helibore.live.frozen_copy import frozen_copy
from helibore.live.journal.journal_extracts import record_at
from helibore.live.model.wall_watch import OF_WALL
from helibore.live.rules.configuration import parse
from helibore.live.wire import wits

MOTHER = (
    WALL
    + '[layers]\nream = ["ream"]\n'
    + '[source.mwd]\naddress = "host"\nunits = "metric"\nsurvey = {}\n'
    + 'items = { bit_depth = "0108", hole_depth = "0110" }\n'
    + 'caliper = { toolface = ["5010"], depth = ["5011"], radius = ["5012"] }\n'
)
SIDETRACK = MOTHER + '[hole]\nname = "ST1"\nkickoff = 104.0\n'


def sent(live, clock, top, bottom, radius, hole=None):
    """Send a sample each centimetre, one a second, twenty in a packet."""
    frames = []
    for number, depth in enumerate(np.arange(top, bottom, 0.01)):
        items = [(108, f"{depth:.2f}"), (110, f"{hole or depth:.2f}"), (5010, f"{number * 37 % 360}")]
        frames.append(wits.frame([*items, (5011, f"{depth:.2f}"), (5012, f"{radius}")]))
    for start in range(0, len(frames), 20):
        clock.step(20.0)
        live.receive("mwd", b"".join(frames[start : start + 20]))


def stations(live, *rows):
    for depth, inclination, azimuth in rows:
        live.append_stations([depth], [inclination], [azimuth])


@pytest.fixture
def sidetracked(tmp_path):
    clock = Clock()
    live = Live(parse(MOTHER), tmp_path, clock=clock)
    stations(live, (90, 0, 0), (103, 1, 40), (107, 2, 40))
    sent(live, clock, 100.5, 108.0, 108)
    live.reconfigure(parse(SIDETRACK))
    stations(live, (106, 5, 90))
    sent(live, clock, 104.0, 107.0, 120)
    yield live, clock, tmp_path
    live.close()


def test_a_sidetrack_shares_what_is_above_the_kickoff(sidetracked):
    live, _, _ = sidetracked
    mother, wall = live.layers["main"], live.wall
    assert live.wall is live.layers["ST1"]
    assert mother.samples.depth.max() == pytest.approx(107.99)
    assert np.all(mother.samples.radius == 0.108), "a sample of the sidetrack is in the mother's wall"
    below = wall.samples.depth > 104.0
    assert np.all(wall.samples.radius[below] == 0.12)
    assert np.all(wall.samples.radius[wall.samples.depth < 104.0] == 0.108)
    above = np.flatnonzero(wall.depth < 104.0 - wall.settings.max_distance)
    assert np.array_equal(wall.radius[above], mother.radius[above])
    assert live.model.events.counts["", "hole"] == 1


def test_each_hole_has_its_own_path(sidetracked):
    live, _, _ = sidetracked
    assert live.survey.depth.tolist() == [90, 103, 106]
    assert live.model.path_of("main").survey.depth.tolist() == [90, 103, 107]
    copy = frozen_copy(live)
    assert copy.main == "ST1"
    assert copy.walls["main"].path.survey.depth.tolist() == [90, 103, 107]
    assert copy.walls["ST1"].path.survey.depth.tolist() == [90, 103, 106]


def same(one, two):
    return all(
        np.array_equal(one.layers[name].radius, two.layers[name].radius, equal_nan=True) for name in one.layers
    ) and {*one.layers} == {*two.layers}


@pytest.mark.parametrize("checkpoint", [True, False])
def test_a_replay_and_a_restart_have_the_same_holes(sidetracked, checkpoint):
    live, clock, folder = sidetracked
    if checkpoint:
        assert live.checkpoint()
    live.close()
    again = Live.replay(folder)
    assert same(again, live)
    assert {key: n for key, n in again.model.events.counts.items() if key[0]} == {
        key: n for key, n in live.model.events.counts.items() if key[0]
    }
    with Live(parse(SIDETRACK), folder, clock=clock) as restarted:
        assert restarted.model.events.counts["", "checkpoint"] == 0
        assert same(restarted, live)
        assert restarted.survey.depth.tolist() == [90, 103, 106]
        assert restarted.model.path_of("main").survey.depth.tolist() == [90, 103, 107]
        sent(restarted, clock, 107.0, 107.5, 120)
        assert restarted.layers["main"].sample_count == live.layers["main"].sample_count
        assert restarted.wall.sample_count == live.wall.sample_count + 50


def test_a_replay_with_another_configuration_keeps_the_holes(sidetracked):
    live, _, folder = sidetracked
    live.close()
    again = Live.replay(folder, parse(MOTHER.replace("0.216", "0.215")))
    assert {*again.layers} == {"main", "ream", "ST1", "ST1-ream"}
    for name in ("main", "ST1"):
        assert np.array_equal(again.layers[name].samples.depth, live.layers[name].samples.depth)
    one = Live.replay(folder, parse(MOTHER + "[hole]\nshift = 1.0\n"))
    assert {*one.layers} == {"main", "ream"}
    assert one.wall.samples.depth.max() == pytest.approx(108.99)


def test_a_journal_whose_first_hole_has_a_name_is_replayed_with_another_configuration(tmp_path):
    clock = Clock()
    with Live(parse(MOTHER + '[hole]\nname = "A"\n'), tmp_path, clock=clock) as live:
        sent(live, clock, 100.5, 102.0, 108)
        assert {*live.layers} == {"main", "ream"}
    again = Live.replay(tmp_path, parse(MOTHER))
    assert {*again.layers} == {"main", "ream"}
    assert same(again, live)


def test_the_first_hole_can_be_gone_back_to(sidetracked):
    live, clock, folder = sidetracked
    live.reconfigure(parse(MOTHER))
    sent(live, clock, 108.0, 109.0, 108)
    assert live.wall is live.layers["main"]
    assert live.wall.samples.depth.max() == pytest.approx(108.99)
    assert live.survey.depth.tolist() == [90, 103, 107]
    live.close()
    assert same(Live.replay(folder), live)


def test_another_hole_without_kickoff_shares_nothing(tmp_path):
    clock = Clock()
    with Live(parse(MOTHER), tmp_path, clock=clock) as live:
        stations(live, (90, 0, 0), (103, 1, 40))
        sent(live, clock, 100.5, 103.0, 108)
        live.reconfigure(parse(MOTHER + '[hole]\nname = "B"\n'))
        assert len(live.wall) == 0
        assert live.survey is None
        sent(live, clock, 101.0, 102.0, 120)
        assert np.all(live.wall.samples.radius == 0.12)
        assert {*live.layers} == {"main", "ream", "B", "B-ream"}


def test_a_new_hole_ends_the_alarms_of_the_old_wall(tmp_path):
    clock = Clock()
    with Live(parse(MOTHER), tmp_path, clock=clock) as live:
        sent(live, clock, 100.5, 112.0, 120)
        clock.step(3600)
        sent(live, clock, 104.0, 108.0, 108, hole=112.0)
        assert ("wall_nearer", "mwd") in live.model.watch.active
        live.reconfigure(parse(SIDETRACK))
        assert {rule for rule, _ in live.model.watch.active}.isdisjoint(OF_WALL)
        sent(live, clock, 104.0, 108.0, 108)
        assert {rule for rule, _ in live.model.watch.active}.isdisjoint(OF_WALL)
        assert live.model.events.counts["mwd", "hole_falls"] == 0


def test_a_shift_moves_later_depths_and_alarms_nothing(tmp_path):
    clock = Clock()
    with Live(parse(MOTHER), tmp_path, clock=clock) as live:
        sent(live, clock, 100.5, 103.0, 108)
        live.reconfigure(parse(MOTHER + "[hole]\nshift = -9.3\n"))
        sent(live, clock, 112.3, 115.3, 108)
        assert live.wall.samples.depth.max() == pytest.approx(105.99)
        assert live.model.events.counts["mwd", "depth_step"] == 0
        assert live.model.events.counts["", "shift"] == 1
        assert live.model.rig.tracks["bit_depth"].value[-1] == pytest.approx(105.99)
        alarms = Alarms(live, {"mwd": "connected"})
        alarms.check()
        assert {one.rule for one in alarms.active} <= {"sync"}
    assert same(Live.replay(tmp_path), live)


@pytest.mark.parametrize(
    ("table", "place"),
    [
        ('[hole]\nname = "ream"\n', "hole.name"),
        (f'[hole]\nname = "{"x" * 300}"\n', "hole.name"),
        ('[hole]\nname = "passes"\n', "hole.name"),
        ("[hole]\nkickoff = 5.0\n", "hole.kickoff"),
        ('[hole]\nname = "A"\nkickoff = -5.0\n', "hole.kickoff"),
        ("[hole]\nshift = 5000.0\n", "hole.shift"),
    ],
)
def test_a_wrong_hole_has_its_place(table, place):
    found, _, _ = refused(MOTHER + table)
    assert found == place


def test_a_configuration_without_a_hole_means_what_it_meant():
    assert "hole" not in json.loads(parse(MOTHER).meaning())


@pytest.mark.parametrize("way", ["record", "time"])
def test_a_hole_that_is_stated_later_is_read_from_a_record_on(tmp_path, way):
    """The same bytes, once with the change made in time, once with a replay that makes it at the same record."""
    clock, holes = Clock(), []
    for name in ("in time", "late"):
        live = Live(parse(MOTHER), tmp_path / name, clock=clock)
        stations(live, (90, 0, 0), (103, 1, 40))
        sent(live, clock, 100.5, 108.0, 108)
        if name == "in time":
            live.reconfigure(parse(SIDETRACK))
        clock.step(3600)
        first, began = live.model.next_sequence, clock.wall
        sent(live, clock, 104.0, 107.0, 120)
        live.close()
        holes.append(live)
    since = record_at(tmp_path / "late", str(first) if way == "record" else f"{utc(began)}")
    assert since == first
    again = Live.replay(tmp_path / "late", parse(SIDETRACK), since=since)
    assert same(again, holes[0])
    assert again.model.main == "ST1"
    assert again.model.stretches[0]["record"] == str(first)
    assert again.model.events.counts["", "hole"] == 1
    assert {*holes[1].layers} == {"main", "ream"}
    with Live(parse(MOTHER), tmp_path / "late", clock=clock):  # another session of the configuration of before
        pass
    assert same(Live.replay(tmp_path / "late", parse(SIDETRACK), since=since), holes[0])


@pytest.mark.parametrize("text", ["", "0x", "99999", "2026-05-01T10:00:00", "2099-05-01T10:00:00Z", "-1"])
def test_a_record_that_is_not_there_is_refused(sidetracked, text):
    with pytest.raises(InputError) as error:
        record_at(sidetracked[2], text)
    assert error.value.place == "since"
