"""What a host pushes, and what the journal refuses, loses or was begun with."""

from __future__ import annotations

import json

import numpy as np
import pytest
from live_wires import (
    FRAMES,
    RUN,
    SENT,
    Clock,
    same_bits,
)

import helibore as hb
from helibore import Live, _core
from helibore.live.frozen_copy import frozen_copy
from helibore.live.journal.journal import (
    BYTES,
    HEADER,
    MAGIC,
    OPENED,
    Journal,
    JournalFullError,
    header_of,
    paths,
    segments,
)
from helibore.live.journal.session_header import sources_of
from helibore.live.rules.configuration import parse
from helibore.live.rules.depth_limits import DepthLimits


def test_the_host_pushes_samples_stations_and_images(tmp_path):
    configuration = parse(SENT)
    with Live(configuration, tmp_path) as live:
        change = live.append_samples(RUN.depth, RUN.toolface, RUN.radius, RUN.time).changes["main"]
        assert change.accepted == 600
        live.append_stations([0.0, 130.0], [0.0, 5.0], [0.0, 90.0])
        live.append_image("RES", [101.0, 102.0], np.arange(6.0).reshape(2, 3), "ohm.m")
    expected = hb.reconstruct(
        hb.Caliper(RUN.depth, RUN.toolface, RUN.radius, RUN.time), bit_diameter=0.216, start_depth=100.0, sectors=16
    )
    again = Live.replay(tmp_path)
    for one in (live, again):
        assert same_bits(one.wall, expected)
        assert one.path.survey_depth == 130
        assert one.images["RES"].arrays()[1].tolist() == [[0, 1, 2], [3, 4, 5]]


def test_an_image_larger_than_a_record_is_stored_in_parts(tmp_path):
    depth, values = np.linspace(101.0, 104.0, 9000), np.arange(9000 * 32.0).reshape(9000, 32)
    with Live(parse(SENT), tmp_path) as live:
        assert live.append_image("RES", depth, values, "ohm.m").images == {"RES": (0, 9000)}
    for one in (live, Live.replay(tmp_path)):
        assert np.array_equal(one.images["RES"].arrays()[1], values)


def test_more_stations_than_a_record_holds_are_stored_in_parts(tmp_path):
    depth = np.linspace(130.0, 4000.0, 50_000)
    with Live(parse(SENT), tmp_path) as live:
        live.append_stations(depth, np.full(depth.size, 5.0), np.full(depth.size, 90.0))
    for one in (live, Live.replay(tmp_path)):
        assert np.array_equal(one.path.survey.depth[-50_000:], depth)


def test_no_record_is_no_update():
    update = Live(parse(SENT)).draw([])
    assert (update.changes, update.events) == ({}, [])


@pytest.mark.parametrize(
    "call",
    [
        lambda live: live.receive("x", b""),
        lambda live: live.append_samples([1.0], [np.nan], [0.1]),
        lambda live: live.append_samples([1.0], [1.0], [-0.1]),
        lambda live: live.append_samples([1.0, 2.0], [1.0], [0.1]),
        lambda live: live.append_image("GR", [1.0], np.ones((1, 4))),
        lambda live: live.append_image("X", [1.0], np.ones((2, 4))),
    ],
)
def test_a_refused_push_stores_nothing(tmp_path, call, golden):
    with Live(parse(SENT), tmp_path) as live:
        with pytest.raises(ValueError) as error:  # noqa: PT011 (the text is compared whole below)
            call(live)
        golden(str(error.value))
    assert sum(len(segment.records) for segment in segments(tmp_path)) == 1


def test_what_the_disk_refuses_is_not_read(tmp_path, monkeypatch):
    with Live(parse(SENT), tmp_path) as live:

        def refuse(*_):
            raise JournalFullError(28, "No space left on device", "j")

        with monkeypatch.context() as patch:
            patch.setattr(Journal, "append", refuse)
            with pytest.raises(JournalFullError):
                live.receive("mwd", FRAMES[0])
        assert live.wall.sample_count == 0
        live.receive("mwd", FRAMES[0])
        assert live.wall.sample_count == 3


@pytest.mark.parametrize(
    ("change", "names"),
    [
        (("sectors = 16\n", ""), "wall.sectors = not set, was 16"),
        (("start_depth = 100.0", "start_depth = 101.0"), "wall.start_depth = 101.0, was 100.0"),
        (("toolface_offset = 30.0", "toolface_offset = 31.0"), "images.GR.layout.offset = 31.0, was 30.0"),
        (("count = 4", "count = 5"), "images.GR.sectors = 5, was 4"),
        (("[source.mwd]", "[source.other]"), 'sources.mwd = not set, was {"store": false}'),
        (('[source.mwd]', '[layers]\nmain = ["drill"]\n[source.mwd]'), 'layers.main = ["drill"], was ["drill", '
         '"rescan", "unknown"]'),
        (("[source.mwd]", "[path]\nextend = 5\n[source.mwd]"), "path.extend = 5.0, was 100.0"),
    ],
)  # fmt: skip
def test_a_journal_is_not_continued_with_another_meaning(tmp_path, change, names):
    Live(parse(SENT), tmp_path).close()
    with pytest.raises(ValueError, match="was begun") as error:
        Live(parse(SENT.replace(*change)), tmp_path)
    rule = "give the old configuration, or begin another journal"
    assert str(error.value) == f"{tmp_path}: was begun with another configuration ({names}); {rule}"
    Live(parse(SENT.replace('"host"', '"tcp://127.0.0.1:9"')), tmp_path).close()


CHANGES = [
    ('units = "metric"', 'units = "fps"'),
    ("bit_diameter = 0.216", "bit_diameter = 0.311"),
    ("groups = 3, ", "groups = 3, offset = 4.0, toolface_offset = 90.0, "),
    ("[source.mwd]", '[source.aaa]\naddress = "host"\nunits = "fps"\nitems = { activity = "0107" }\n[source.mwd]'),
    ("[source.mwd]", "[depth]\njump = 50\n[passes]\non_bottom = 1\n[source.mwd]"),
]


@pytest.mark.parametrize("change", CHANGES)
@pytest.mark.parametrize("checkpointed", [False, True])
def test_a_changed_configuration_applies_from_its_session_on_in_the_same_wall(tmp_path, change, checkpointed):
    """Each record is read with the configuration of its session; the wall goes on, also after restart and replay."""
    clock, before, after = Clock(), parse(SENT), parse(SENT.replace(*change))
    frames = [FRAMES[:60], FRAMES[60:130], FRAMES[130:]]
    expected: list[np.ndarray] = []
    for number, configuration in enumerate([before, after, after]):
        with Live(configuration, tmp_path, clock=clock) as live:
            for frame in frames[number]:
                clock.step(1)
                live.receive("mwd", frame, number + 1)
            if checkpointed:
                live.checkpoint()
        with Live(configuration) as alone:
            for frame in frames[number]:
                alone.receive("mwd", frame)
        columns = alone.wall.samples
        expected.append(np.column_stack([columns.depth, columns.toolface, columns.radius]))
        clock.step(60)
    drawn = np.concatenate(expected)
    replayed = Live.replay(tmp_path)
    with Live(after, tmp_path, clock=clock) as again:
        for one in (replayed, again):
            kept = one.wall.samples
            given = np.column_stack([kept.depth, kept.toolface, kept.radius])
            assert np.array_equal(given[np.lexsort(given.T)], drawn[np.lexsort(drawn.T)])
            assert one.model.events.counts["", "configuration"] == 1
            assert [stretch["configuration"] for stretch in one.model.stretches] == [after.text]
        assert same_bits(again.wall, replayed.wall)
        assert again.configuration.meaning() == again.model.configuration.meaning()
        assert frozen_copy(again).walls["main"].made_from == {"configuration": again.model.stretches}
    Live(before, tmp_path, clock=clock).close() if change[0] != "[source.mwd]" else None


def test_a_replay_with_other_sources_reads_the_bytes_of_each_source_as_its_own(tmp_path):
    more = SENT + "".join(f'[source.{name}]\naddress = "host"\nunits = "metric"\n' for name in ("zeta", "alpha"))
    for number, text in enumerate((SENT, more)):
        with Live(parse(text), tmp_path) as live:
            live.receive("mwd", FRAMES[number], number + 1)
            if text == more:
                live.receive("alpha", FRAMES[2])
    assert live.model.numbers == {"mwd": 1, "alpha": 2, "zeta": 3}
    assert {number: one.name for number, one in sources_of(tmp_path, None).items()} == {1: "mwd", 2: "alpha", 3: "zeta"}
    assert Live.replay(tmp_path, parse(more)).wall.sample_count == 6
    assert Live.replay(tmp_path, parse(SENT.replace("source.mwd", "source.alpha"))).wall.sample_count == 3


def test_a_journal_keeps_the_defaults_it_was_written_with(tmp_path, monkeypatch):
    """Defaults change between two versions: the journal goes on with its own, and a replay uses them too."""
    with Live(parse(SENT), tmp_path) as live:
        live.receive("mwd", FRAMES[0])
    meaning = live.configuration.meaning()
    later = {"jump": 7.0, "beyond_hole": 3.0}
    for name, value in later.items():
        monkeypatch.setitem(DepthLimits.__init__.__kwdefaults__, name, value)
    assert parse(SENT).depth.jump == 7.0
    for one in (Live(parse(SENT), tmp_path), Live.replay(tmp_path)):
        assert one.configuration.meaning() == meaning
        assert one.configuration.depth.jump == 100.0
        assert not one.model.stretches
        one.close()


def test_a_journal_from_before_a_setting_existed_goes_on(tmp_path):
    """It has the meaning that the setting had then: every sample is kept."""
    older = json.loads(parse(SENT).meaning())
    del older["samples"], older["depth"]
    opening = {"session": "1", "meaning": json.dumps(older), "configuration": SENT}
    with Journal(tmp_path, json.dumps(opening).encode()) as journal:
        journal.append(1, 1, b"".join(FRAMES))
    with Live(parse(SENT), tmp_path) as live:
        assert live.configuration.samples.most == 0
        assert live.wall.sample_count == 600
        assert not live.model.stretches
    assert same_bits(Live.replay(tmp_path).wall, live.wall)


def test_a_journal_of_format_1_is_read_and_continued(tmp_path):
    """Its second header is at 32 and its records begin at 64; the next segment has format 2."""
    head = HEADER.pack(MAGIC, 1, 1, 0, 77, 0)[:-4]
    header = head + _core.crc32c(head).to_bytes(4, "little")
    older = json.loads(parse(SENT).meaning())
    del older["samples"], older["depth"]
    opening = json.dumps({"session": "1", "meaning": json.dumps(older), "configuration": SENT}).encode()
    records = [(OPENED, 0, opening), *((BYTES, 1, frame) for frame in FRAMES[:100])]
    sealed = [_core.journal_seal(number, 10**18 + number, number, source, source, kind, payload, 77) + payload
              for number, (kind, source, payload) in enumerate(records)]  # fmt: skip
    (tmp_path / "000001.hbj").write_bytes(header * 2 + b"".join(sealed) + sealed[-1][:50])
    assert Live.replay(tmp_path).wall.sample_count == 300
    with Live(parse(SENT), tmp_path) as live:
        assert live.journal is not None
        live.journal._segment_bytes = 20_000
        assert live.journal.recovery.cut_bytes == 50
        for frame in FRAMES[100:]:
            live.receive("mwd", frame)
        live.checkpoint()
    assert [header_of(path).version for path in paths(tmp_path)] == [1, 2, 2]
    with Live(parse(SENT), tmp_path) as again:
        assert again.wall.sample_count == 600
        assert same_bits(again.wall, live.wall)
    assert same_bits(Live.replay(tmp_path).wall, live.wall)


def test_damage_in_the_journal_is_told(tmp_path):
    clock = Clock()
    with Live(parse(SENT), tmp_path, clock=clock) as live:
        for frame in FRAMES[:5]:
            clock.wall += 1
            live.receive("mwd", frame)
    path = tmp_path / "000001.hbj"
    text = bytearray(path.read_bytes())
    text[-200] ^= 1
    path.write_bytes(text)
    again = Live.replay(tmp_path)
    assert again.model.events.latest[0].rule == "journal"
    assert "hold no intact record" in again.model.events.latest[0].text
    assert again.model.events.latest[0].wall == clock.wall - 2, "the time of the record before the damage"
    assert again.wall.sample_count == 12


def test_opening_a_journal_tells_each_damage_once(tmp_path):
    """Two records are hit in the last segment and its end is torn: three events, two when it is opened once more."""
    with Live(parse(SENT), tmp_path) as live:
        for frame in FRAMES[:5]:
            live.receive("mwd", frame)
    path = tmp_path / "000001.hbj"
    text, (segment,) = bytearray(path.read_bytes()), segments(tmp_path)
    for row in (1, 3):
        text[int(segment.records["offset"][row])] ^= 1
    path.write_bytes(text[:-1])
    for torn in (1, 0):
        with Live(parse(SENT), tmp_path) as live:
            assert live.model.events.counts["", "journal"] == 2 + torn
            reported = [event.text for event in live.poll().events if event.rule == "journal"]
            assert live.journal is not None
            assert sorted(reported) == sorted([*live.journal.recovery.notes, *live.journal.recovery.damage])
        assert Live.replay(tmp_path).model.events.counts["", "journal"] == 2


def test_the_opening_record_holds_the_configuration(tmp_path):
    Live(parse(SENT), tmp_path).close()
    (segment,) = segments(tmp_path)
    assert json.loads(segment.payload(0))["configuration"] == SENT
