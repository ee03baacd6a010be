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
from helibore import Live
from helibore.live.configuration import parse
from helibore.live.journal import Journal, JournalFullError, segments


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


@pytest.mark.parametrize(
    ("call", "text"),
    [
        (lambda live: live.receive("x", b""), "source 'x': is not in the configuration"),
        (lambda live: live.append_samples([1.0], [np.nan], [0.1]), "toolface[0] = nan: must be finite"),
        (lambda live: live.append_samples([1.0], [1.0], [-0.1]), "radius[0] = -0.1: must be larger than 0"),
        (
            lambda live: live.append_samples([1.0, 2.0], [1.0], [0.1]),
            "toolface has 1 values, depth has 2: must be equal",
        ),
        (lambda live: live.append_image("GR", [1.0], np.ones((1, 4))), "image 'GR': a source sends it already"),
        (
            lambda live: live.append_image("X", [1.0], np.ones((2, 4))),
            "values has shape (2, 4): must be (1, sectors), 2 sectors or more",
        ),
    ],
)
def test_a_refused_push_stores_nothing(tmp_path, call, text):
    with Live(parse(SENT), tmp_path) as live:
        with pytest.raises(ValueError) as error:  # noqa: PT011 (the text is compared whole below)
            call(live)
        assert str(error.value) == text
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


def test_a_journal_is_not_continued_with_another_meaning(tmp_path):
    Live(parse(SENT), tmp_path).close()
    for change, names in [
        (("metric", "fps"), r"sources\.mwd\.caliper\.depth\[0\]\.scale = 0\.3048, was 1\.0$"),
        (("bit_diameter = 0.216", "bit_diameter = 0.311"), r"wall\.bit_diameter = 0\.311, was 0\.216$"),
        (("sectors = 16\n", ""), r"wall\.sectors = not set, was 16$"),
        (("toolface_offset = 30.0", "toolface_offset = 31.0"), r"images\[0\]\.layout\.offset = 31\.0, was 30\.0$"),
    ]:
        with pytest.raises(ValueError, match=r"was begun with another configuration: .*: " + f".*{names}"):
            Live(parse(SENT.replace(*change)), tmp_path)
    Live(parse(SENT.replace('"host"', '"tcp://127.0.0.1:9"')), tmp_path).close()


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
