"""The table of a journal has the values from which the wall grew."""

from __future__ import annotations

import csv
import io

from live_wires import SENT, Clock

from helibore import Live
from helibore.live.journal.journal_extracts import export_csv
from helibore.live.journal.session_header import sources_of
from helibore.live.rules.configuration import parse
from helibore.live.wire import wits


def test_a_frame_that_only_the_end_of_its_connection_completes_is_in_the_table(tmp_path):
    """Its last line has no line end. Connection 1 is closed; connection 3 replaces connection 2 without a word."""
    clock = Clock()
    with Live(parse(SENT), tmp_path, clock=clock) as live:
        for connection, closed in ((1, True), (2, False), (3, False)):
            clock.step(1)
            frame = wits.frame([(5010, f"{connection}0"), (5011, "100.5"), (5012, "101.0")])
            live.receive("mwd", frame + frame.replace(b"100.5", b"100.6").rstrip(), connection)
            if closed:
                clock.step(1)
                live.closed("mwd", connection)
        assert live.model.counts["received"] == 5
    file = io.StringIO()
    count = export_csv(tmp_path, sources_of(tmp_path, None), file)
    rows = list(csv.DictReader(file.getvalue().splitlines()))
    assert count == len(rows) == 3 * 5
    assert [(row["connection"], row["line"]) for row in rows if row["name"] == "5010"] == [
        ("1", "2"), ("1", "7"), ("2", "2"), ("2", "7"), ("3", "2"),
    ]  # fmt: skip
    assert [row["value"] for row in rows if row["name"] == "5011"] == ["100.5", "100.6", "100.5", "100.6", "100.5"]
    assert [row["utc"][17:19] for row in rows if row["name"] == "5012"] == ["21", "22", "23", "24", "24"]
