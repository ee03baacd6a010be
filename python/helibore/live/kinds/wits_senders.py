"""WITS level 0 over TCP, serial lines and files, or pushed by the program."""

from __future__ import annotations

from collections.abc import Iterator

from helibore.live.model.mapping import SourceReader
from helibore.live.rules.kinds import Cells, Items, Position, Report, SourceKind
from helibore.live.rules.source_tables import WitsTable
from helibore.live.rules.sources import WitsSource
from helibore.live.wire import wits
from helibore.live.wire.transport import Opener, opener


class WitsSenders(SourceKind[WitsSource, SourceReader]):
    """Senders of WITS level 0."""

    schemes = "tcp", "listen", "serial", "file", "host"
    table = WitsTable
    source = WitsSource
    reader = SourceReader
    of_start = "allow", "mode", "every", "replace_after"

    def open(self, source: WitsSource, position: Position, report: Report) -> Opener:  # noqa: ARG002
        return opener(source, report)

    def items(self, source: WitsSource) -> Items:
        parsers: dict[int, wits.Parser] = {}

        def rows(connection: int, payload: bytes, closes: bool) -> Iterator[Cells]:
            for last in [each for each in parsers if each != connection]:  # its end is not in the journal
                yield from _cells(last, parsers.pop(last).finish())
            parser = parsers.setdefault(connection, wits.Parser(source.nulls, *source.limits))
            yield from _cells(connection, parser.finish() if closes else parser.feed(payload))

        return rows


def _cells(connection: int, batch: wits.Batch) -> Iterator[Cells]:
    """Yield connection, line, item code and text of the value for each item in a batch."""
    for number, frame in enumerate(batch.frames):
        for row in range(int(frame["first"]), int(frame["first"] + frame["items"])):
            text = batch.text_of(row).decode("ascii", "backslashreplace")
            yield connection, batch.line_of(row, number), f"{batch.items['code'][row]:04d}", text


KIND = WitsSenders()
