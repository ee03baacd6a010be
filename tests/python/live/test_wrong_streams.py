"""Streams that are well formed and wrong alarm in time; ``python -m bench.live.wrong`` plays all of them."""

from __future__ import annotations

import pytest

pytest.importorskip("fastavro", reason="streams of ETP need fastavro")

from wrong_streams import STREAMS, played

SHORT = (
    "WITS: toolfaces in radians",
    "WITS: the depth slips down",
    "WITS: nothing but keep-alives",
    "MQTT: the radius sticks",
    "store: mnemonics in another case",
    "store: the clock is set back",
    "ETP: the clock is set back",
    "ETP: a unit that is none of length",
)


@pytest.mark.parametrize("name", SHORT)
def test_a_wrong_stream_alarms_in_time(name):
    delay, text, false = played(name)
    assert false == [], "a right stream alarms"
    assert delay <= STREAMS[name].within, text
    assert all(word in text for word in STREAMS[name].words)


def test_there_are_thirty_streams_by_four_ways():
    assert len(STREAMS) >= 30
    assert {one.wire.__name__ for one in STREAMS.values()} == {"Wits", "Mqtt", "Etp", "Stored"}
