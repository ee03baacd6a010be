"""A wall that is nearer, another hole and a slipped depth alarm; growth is a notice; a good log is silent."""

from __future__ import annotations

import copy

import numpy as np
import pytest
from live_wires import WALL, Clock

from helibore import Live
from helibore.live.model.wall_watch import WallMemory
from helibore.live.rules.configuration import parse
from helibore.live.wire import wits

BEGAN = 1_700_000_000.0
BIT = 0.108


def relief(seed: int, rows: int = 3000) -> np.ndarray:
    """A value for each 0.1 m of a hole from 1900 m on: smooth over 1.5 m, 3 mm, hardly below gauge."""
    noise = np.random.default_rng(seed).standard_normal(rows + 100)
    smooth = np.convolve(noise, np.exp(-0.5 * (np.arange(-50, 51) / 15) ** 2), "valid")
    return np.clip(0.003 * smooth / smooth.std(), -0.001, None)


HOLE, OTHER = relief(11), relief(12)


def radius(depth, toolface, *, hole=HOLE, moved=0.0, slipped=0.0, eccentric=0.0):
    """The radius that a tool measures in an oval hole."""
    along = hole[np.floor((depth + slipped - 1900) / 0.1).astype(int)]
    angle = np.radians(toolface)
    return BIT + 0.001 + along + moved + 0.002 * np.cos(2 * angle) - eccentric * np.cos(angle)


def log(memory, seed, since, top, bottom, speed, every, *, window=5000, fell=(), **hole):
    """Let a tool pass from one depth to another; return the time of its end, and (sample, rule, text, lasts)."""
    draw = np.random.default_rng(seed)
    count = int(abs(bottom - top) / speed / every)
    time = since + every * np.arange(count)
    depth, toolface = np.linspace(top, bottom, count), draw.uniform(0, 360, count)
    values = radius(depth, toolface, **hole) + 0.001 * draw.standard_normal(count)
    columns = np.arange(count), (time * 1e9).astype(np.int64), depth, toolface, values
    found = []
    for start in range(0, count, window):
        part = tuple(column[start : start + window] for column in columns)
        memory.take(part, list(fell), lambda *one: found.append(one))
    return float(time[-1]), found


@pytest.fixture(scope="module")
def drilled():
    memory = WallMemory()
    end, found = log(memory, 1, BEGAN, 2000, 2036, 20 / 3600, 10.0)
    assert found == []
    return memory, end


@pytest.mark.parametrize(
    ("hole", "rules"),
    [
        ({}, set()),
        ({"moved": 0.004}, set()),
        ({"moved": -0.003}, set()),
        ({"slipped": 0.3}, set()),
        ({"eccentric": 0.008}, set()),
        ({"moved": 0.012}, {"wall_farther"}),
        ({"moved": -0.008}, {"wall_nearer"}),
        ({"slipped": 9.3}, {"depth_slipped"}),
        ({"slipped": -4.0}, {"depth_slipped"}),
    ],
)
def test_a_second_log_of_the_hole(drilled, hole, rules):
    memory, end = copy.deepcopy(drilled[0]), drilled[1]
    _, found = log(memory, 2, end + 3600, 2030, 2006, 0.05, 1.0, **hole)
    said = {rule for _, rule, text, _ in found if text}
    assert rules <= said
    assert rules or said == set()
    assert all(lasts == (rule != "wall_farther") for _, rule, text, lasts in found if text)
    if "depth_slipped" in rules:
        text = next(text for _, rule, text, _ in found if rule == "depth_slipped")
        lag = float(text.split("before ")[1].split(" m")[0])
        assert lag == pytest.approx(hole["slipped"], abs=0.4)


def test_a_sidetrack_of_another_size_is_another_hole(drilled):
    memory, end = copy.deepcopy(drilled[0]), drilled[1]
    fell = [int((end + 60) * 1e9)]
    _, found = log(memory, 3, end + 3600, 2020, 2034, 20 / 3600, 10.0, fell=fell, hole=OTHER, moved=0.012)
    sample, rule, text, lasts = found[0]
    assert (rule, lasts) == ("another_hole", True)
    assert sample * 10 * 20 / 3600 < 5, "more than 5 m were drawn as one hole"
    assert "hole.name" in text


def test_the_alarm_ends_when_the_wall_is_where_it_was(drilled):
    memory, end = copy.deepcopy(drilled[0]), drilled[1]
    end, found = log(memory, 4, end + 3600, 2030, 2018, 0.05, 1.0, moved=-0.008)
    assert [rule for _, rule, *_ in found] == ["wall_nearer"]
    _, found = log(memory, 5, end, 2018, 2006, 0.05, 1.0)
    assert [(rule, text) for _, rule, text, _ in found] == [("wall_nearer", "")]


def test_windows_of_any_size_give_the_same(drilled):
    results = []
    for window in (1, 7, 5000):
        memory = copy.deepcopy(drilled[0])
        end, first = log(memory, 6, drilled[1] + 3600, 2030, 2022, 0.05, 1.0, window=window, moved=-0.008)
        _, second = log(memory, 7, end, 2022, 2012, 0.05, 1.0, window=window, slipped=9.3)
        results.append((first, second, list(memory.passed), memory._sum))
    assert results[0] == results[1] == results[2]
    assert results[0][0]


SENT = (
    WALL.replace("0.216", "0.216\nmax_distance = 0.5")
    + '[source.mwd]\naddress = "host"\nunits = "metric"\n'
    + 'caliper = { depth = ["5009"], toolface = ["5010"], radius = ["5012"] }\n'
)


def test_a_replay_and_a_checkpoint_say_the_same(tmp_path):
    clock = Clock()

    def send(live, top, bottom, moved):
        depth, toolface = np.linspace(top, bottom, 600), np.arange(600) * 137.5 % 360
        values = 1000 * (0.11 + moved + 0.0005 * np.sin(np.arange(600)))
        for start in range(0, 600, 60):
            clock.step(150.0)
            part = slice(start, start + 60)
            rows = zip(depth[part], toolface[part], values[part], strict=True)
            frames = [wits.frame([(5009, f"{d:.3f}"), (5010, f"{t:.1f}"), (5012, f"{r:.2f}")]) for d, t, r in rows]
            live.receive("mwd", b"".join(frames))

    with Live(parse(SENT), tmp_path, clock=clock) as live:
        send(live, 101, 113, 0.0)
        clock.step(3600)
        assert live.checkpoint() is not None
        assert live.model.watch.active == {}
    with Live(parse(SENT), tmp_path, clock=clock) as live:
        assert live.model.events.counts["", "checkpoint"] == 0
        send(live, 112, 104, -0.006)
        assert list(live.model.watch.active) == [("wall_nearer", "mwd")]
        counts = live.model.events.counts
    again = Live.replay(tmp_path).model
    assert again.watch.active == live.model.watch.active
    assert again.events.counts["mwd", "wall_nearer"] == counts["mwd", "wall_nearer"] == 1
