"""Records with values that cannot be true: the program lives, draws every good record, and a replay has the bits."""

from __future__ import annotations

import json

import numpy as np
import pytest
from live_wires import FRAMES, WALL, Clock, same_bits

from helibore import Live, Wall
from helibore.live.journal import journal
from helibore.live.journal.journal import segments
from helibore.live.live import Live as LiveClass
from helibore.live.rules.configuration import parse
from helibore.live.wire import wits, witsml

CONFIGURATION = (
    WALL + '[source.mwd]\naddress = "host"\nunits = "metric"\n'
    'caliper = { first = "5010", groups = 3, order = ["toolface", "depth", "radius"] }\n'
    'survey = {}\nimage.GR = { first = "5110", count = 4, unit = "gAPI", depth = "0821",'
    ' origin = "edge", reference = "high-side" }\n'
    '[source.rig]\naddress = "host"\nunits = "metric"\n'
    'items = { bit_depth = "0108", hole_depth = "0110", rotation = "0120", activity = "0107" }\n'
    '[source.store]\naddress = "https://localhost:1/x"\n'
    'log = { well = "w", wellbore = "b", log = "l", index = "depth" }\n'
    'trajectory = { well = "w", wellbore = "b", trajectory = "t" }\n'
    'caliper = { toolface = ["TF"], radius = ["RAD"] }\n'
)


def mwd(*items):
    return ("mwd", wits.frame([(code, str(text)) for code, text in items]))


def triple(toolface=10, depth=103, radius=110):
    return mwd((5010, toolface), (5011, depth), (5012, radius))


def rig(*items):
    return ("rig", wits.frame([(code, str(text)) for code, text in items]))


def log(*rows, units="m,deg,m"):
    data = "".join(f"<data>{row}</data>" for row in rows)
    document = (f'<logs xmlns="x"><log><logData><mnemonicList>DEPTH,TF,RAD</mnemonicList><unitList>{units}</unitList>'
                f"{data}</logData></log></logs>")  # fmt: skip
    return ("store", witsml.framed("log", "whole", answer(document)))


def trajectory(*stations):
    rows = "".join(
        f'<trajectoryStation><md uom="m">{md}</md><incl uom="deg">{dip}</incl><azi uom="deg">{way}</azi>'
        "</trajectoryStation>" for md, dip, way in stations
    )  # fmt: skip
    return ("store", witsml.framed("trajectory", "whole", answer(f'<trajectorys xmlns="x"><trajectory>{rows}'
                                                                 "</trajectory></trajectorys>")))  # fmt: skip


def answer(document):
    text = document.replace("&", "&amp;").replace("<", "&lt;")
    return f"<e><Result>1</Result><XMLout>{text}</XMLout></e>".encode()


def samples(depth=103.0, toolface=10.0, radius=0.11, time=np.nan):
    return (journal.SAMPLES, np.array([[depth], [toolface], [radius], [time]]).tobytes())


def image(name, sectors, table):
    return (journal.IMAGE, json.dumps([name, sectors, ""]).encode() + b"\n" + np.array(table, float).tobytes())


GOOD = FRAMES[:100]  # of three samples
HUGE = "9" * 300
POISONS = {
    "depth of ten digits": triple(depth=9999999999),
    "depth of two million": triple(depth="2000500"),
    "depth of a hundred thousand": triple(depth=99999),
    "depth of 300 digits": triple(depth=HUGE),
    "depth below zero": triple(depth=-5000),
    "depth that jumps alone": triple(depth=9000),
    "depth below the hole": triple(depth=160),
    "depth of feet read as metres": triple(depth=f"{105 / 0.3048:.2f}"),
    "toolface of 300 digits": triple(toolface=HUGE),
    "toolface of a billion": triple(toolface=1000000000),
    "radius of 300 digits": triple(radius=HUGE),
    "radius of a kilometre": triple(radius=1000000),
    "radius of zero": triple(radius=0),
    "radius below zero": triple(radius=-110),
    "bit of ten digits": rig((108, 9999999999)),
    "bit below zero": rig((108, -9998)),
    "bit that jumps alone": rig((108, 7000)),
    "hole of ten digits": rig((110, 9999999999)),
    "hole that jumps alone": rig((110, 1)),
    "rotation and activity of 300 digits": rig((120, HUGE), (107, HUGE)),
    "station of ten digits": mwd((708, 9999999999), (713, 1), (715, 1)),
    "station below zero": mwd((708, -9998), (713, 1), (715, 1)),
    "station that points up twice": mwd((708, 104), (713, 200), (715, 1)),
    "station of 300 digits": mwd((708, 104), (713, HUGE), (715, HUGE)),
    "image row of ten digits": mwd((821, 9999999999), *((5110 + k, 1) for k in range(4))),
    "image row below zero": mwd((821, -5000), *((5110 + k, 1) for k in range(4))),
    "store index of ten digits, twice": log("9999999998,1,0.11", "9999999999,1,0.11"),
    "store index that jumps alone": log("9000,1,0.11"),
    "store index of 300 digits": log(f"{HUGE},1,0.11", f"{HUGE},1,0.11"),
    "store row with other cells": log("101,1"),
    "store of another unit": log("101,1,0.11", "101.1,1,0.11", units="s,deg,m"),
    "store radius of 300 digits": log(f"100.01,1,{HUGE}", f"100.02,1,{HUGE}"),
    "store trajectory of ten digits": trajectory((9999999999, 1, 1)),
    "store trajectory without numbers": trajectory(("x", "y", "z")),
    "store document of nothing": ("store", witsml.framed("log", "whole", b"\0\0")),
    "sample of a host at ten digits": samples(depth=9999999999.0),
    "sample of a host that is none": samples(depth=np.nan, toolface=np.inf, radius=np.nan),
    "sample of a host in the year 10^290": samples(time=1e300),
    "sample of a host, a kilometre wide": samples(radius=1e3),
    "sample of a host that is cut": (journal.SAMPLES, b"\0" * 23),
    "stations of a host that are cut": (journal.STATIONS, b"\0" * 23),
    "stations of a host at ten digits": (journal.STATIONS, np.array([[9999999999.0], [1.0], [1.0]]).tobytes()),
    "image of a host at ten digits": image("X", 2, [[9999999999.0, 1, 2]]),
    "image of a host that is cut": image("X", 2, [1.0, 2.0]),
    "image of a host without a head": (journal.IMAGE, b"\xff\xfe no JSON"),
    "session without a header": (journal.OPENED, b"not JSON"),
    "session whose header is a list": (journal.OPENED, b"[1]"),
    "session whose meaning is a number": (journal.OPENED, b'{"meaning": 5}'),
    "record of an unknown kind": (77, b"?"),
}


def play(folder, poisons) -> LiveClass:
    """A live wall that takes good frames and, at the same instants, poisoned records between them."""
    clock = Clock()
    live = Live(parse(CONFIGURATION), folder, clock=clock)
    waiting = list(poisons)
    share = -(-len(waiting) // 50)
    for number, frame in enumerate(GOOD):
        depth = 100 + 5 * number / len(FRAMES)
        clock.step(1.0)
        live.receive("rig", wits.frame([(108, f"{depth:.3f}"), (110, "105.000"), (120, "60")]))
        live.receive("mwd", frame)
        if number > 40:
            for source, payload in waiting[:share]:
                if isinstance(source, str):
                    live.receive(source, payload)
                else:
                    live._store(0, 0, payload, source)
            del waiting[:share]
    assert not waiting
    return live


@pytest.fixture(scope="module")
def clean(tmp_path_factory):
    with play(tmp_path_factory.mktemp("clean"), []) as live:
        assert live.wall.sample_count == 3 * len(GOOD)
        return live


def check(folder, clean, poisons):
    with play(folder, poisons) as live:
        assert same_bits(live.wall, clean.wall)
        assert live.wall.sample_count == clean.wall.sample_count
        wrong = sum(count for (_, rule), count in live.model.events.counts.items()
                    if rule in ("range", "aside", "station", "index", "jump", "witsml", "unit", "invalid"))  # fmt: skip
        flagged = live.model.counts["flag RANGE"] + live.model.counts["flag INVALID"]
        counted = {(event.source, event.rule): event.count for event in live.model.events.latest}
    assert same_bits(Live.replay(folder).wall, clean.wall)
    with Live(parse(CONFIGURATION), folder) as again:
        assert same_bits(again.wall, clean.wall)
        events = {(event.source, event.rule): event.count for event in again.model.events.latest}
        assert events == counted
    return wrong, flagged


@pytest.mark.parametrize("name", POISONS)
def test_a_poisoned_record_ends_nothing(tmp_path, clean, name):
    wrong, flagged = check(tmp_path, clean, [POISONS[name]])
    assert wrong + flagged > 0 or name in ("record of an unknown kind", "rotation and activity of 300 digits")


def test_all_poisoned_records_together_end_nothing(tmp_path, clean):
    assert len(POISONS) >= 40
    wrong, flagged = check(tmp_path, clean, POISONS.values())
    assert wrong > 20
    assert flagged > 5


def test_an_append_that_fails_sets_its_record_aside(tmp_path, clean, monkeypatch, golden):
    append = Wall.append

    def refuse(wall, depth, toolface, radius, time=None):
        if (np.asarray(toolface) == 123.0).any():
            raise MemoryError
        return append(wall, depth, toolface, radius, time)

    monkeypatch.setattr(Wall, "append", refuse)
    with play(tmp_path, [triple(toolface=123)]) as live:
        assert same_bits(live.wall, clean.wall)
        (event,) = (event for event in live.model.events.latest if event.rule == "aside")
        golden(event.text)
        counts = live.model.counts
        assert (counts["set aside"], counts["kept apart"]) == (1, 1)
        assert counts["received"] == counts["drawn"] + counts["not drawn"] + counts["kept apart"]
        assert counts["drawn"] == live.wall.sample_count
        assert live.model.out_of_memory
        assert live.checkpoint() is None  # a restart with more memory draws the record
    assert same_bits(Live.replay(tmp_path).wall, clean.wall)  # taken by the thousand, too


def test_a_jump_that_the_next_sample_confirms_is_drawn(tmp_path, golden):
    with Live(parse(CONFIGURATION), tmp_path, clock=Clock()) as live:
        for depth in (400.0, 400.1, 200.0, 200.1, 900.0, 200.2, 600.0):
            live.receive(*triple(toolface=depth % 7, depth=depth))
        assert live.wall.samples.depth.tolist() == [200.0, 200.1, 200.2, 400.0, 400.1]
        live.receive(*triple(toolface=1, depth=600.1))
        assert live.wall.samples.depth.tolist()[-2:] == [600.0, 600.1]
        (event,) = (event for event in live.model.events.latest if event.rule == "range")
        golden(event.text)
    assert same_bits(Live.replay(tmp_path).wall, live.wall)
    assert sum(len(segment.records) for segment in segments(tmp_path)) == 9


def test_feet_read_as_metres_are_named(tmp_path, golden):
    with Live(parse(CONFIGURATION), tmp_path, clock=Clock()) as live:
        live.receive(*rig((108, 2000), (110, 2000)))
        live.receive(*triple(depth=f"{1999 / 0.3048:.1f}"))
        live.receive(*triple(depth=f"{1999 / 0.3048:.1f}", toolface=11))
        live.receive(*triple(depth=2500))
        live.receive(*triple(depth=2500, toolface=11))
        texts = [event.text for event in live.poll().events if event.rule == "range"]
    golden(texts)
