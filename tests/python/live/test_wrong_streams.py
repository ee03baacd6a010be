"""Streams that are well formed and wrong alarm in time, by page, metrics and stderr.

``python -m bench.live.wrong`` plays all of them.
"""

from __future__ import annotations

import pytest

pytest.importorskip("fastavro", reason="streams of ETP need fastavro")
pytest.importorskip("uvicorn", reason="the page is served by the extra 'view'")
pytest.importorskip("prometheus_client", reason="the metrics need the extra 'live'")

from alarm_outputs import AlarmOutputs
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


@pytest.fixture(scope="module")
def outputs():
    from helibore.viewer.page_files import page

    if page("app.js") is None:
        pytest.skip("the page was not built: Node.js 18 is missing")
    with AlarmOutputs() as made:
        yield made


@pytest.mark.parametrize("name", SHORT)
def test_a_wrong_stream_alarms_in_time_on_page_metrics_and_stderr(outputs, name):
    delay, text, false, lacking = played(name, outputs.lacking)
    assert lacking == [], text
    assert false == [], "a right stream alarms"
    assert delay <= STREAMS[name].within, text
    assert all(word in text for word in STREAMS[name].words)


def test_there_are_thirty_streams_by_four_ways():
    assert len(STREAMS) >= 30
    assert {one.wire.__name__ for one in STREAMS.values()} == {"Wits", "Mqtt", "Etp", "Stored"}
