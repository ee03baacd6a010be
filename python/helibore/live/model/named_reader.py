"""Convert rows of named values to columns in core units: what a source sends by name instead of by item code."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

import numpy as np

from helibore.live.model.events import Event, EventBook
from helibore.live.model.mapping import INVALID, NULL, VALUE, Reading, SourceReader
from helibore.live.rules.depth_limits import DepthLimits
from helibore.live.rules.sources import NamedSource

MOST_NAMES = 200
"""The most names that are remembered of values that no setting maps."""


class NamedReader(SourceReader):
    """Reads a source whose values have names: curves, channels, keys."""

    STATE = (*SourceReader.STATE, "_unmapped")
    message, word, nothing = "message", "channel", "bytes come, and nothing among them can be read"

    def __init__(self, source: NamedSource, events: EventBook, limits: DepthLimits) -> None:
        super().__init__(source, events, limits)
        self._named = source
        self._known = {curve.name for curve in source.curves}
        self._unmapped: dict[str, None] = {}

    def go_on_from(self, before: SourceReader) -> None:
        """As `SourceReader.go_on_from`; the names that no setting maps are remembered, too."""
        super().go_on_from(before)
        if isinstance(before, NamedReader):
            self._note(before._unmapped)

    def unmapped(self) -> list[str]:
        return list(self._unmapped)

    def _note(self, names: Iterable[str]) -> None:
        """Remember the names that no setting maps, so that an alarm can list them."""
        for name in names:
            if name not in self._known and len(self._unmapped) < MOST_NAMES:
                self._unmapped[name[:60]] = None

    def _read_named(self, rows: Sequence[Mapping[str, object]], reading: Reading, scales: Mapping[str, float]) -> None:
        """Fill ``reading``, which has the frame of each row, with the values of rows; None is a null.

        ``scales`` has the factor to core units of each name whose unit the source sends.
        """
        values = np.full((len(rows), len(self._column)), np.nan)
        states = np.zeros(values.shape, np.uint8)
        for curve in self._named.curves:
            column, name, bad = self._column[curve.name], curve.name, dict[int, object]()
            for place, row in enumerate(rows):
                if name not in row:
                    continue
                value = row[name]
                self._seen.add(name)
                if value is None or value == "" or value in self.source.nulls:
                    states[place, column] = NULL
                elif isinstance(value, bool) or not isinstance(value, (int, float)) or not np.isfinite(value):
                    states[place, column], bad[place] = INVALID, value
                else:
                    states[place, column] = VALUE
                    values[place, column] = value * scales.get(name, 1.0)
            self._report_bad(name, bad, reading)
        for row in rows:
            self._note(row)
        for name, state in (("items", VALUE), ("nulls", NULL), ("not_numbers", INVALID)):
            self.counts[name] += int(np.count_nonzero(states == state))
        self._events.report_rows(self._wrong_numbers(values), lambda row: self._wrong_number(row, reading, values))
        self._fill(reading, values, states, np.zeros(len(rows), np.int64))

    def _report_bad(self, name: str, bad: dict[int, object], reading: Reading) -> None:
        def describe(row: int) -> Event:
            text = f"{name} = {str(bad[row])[:60]!r}: is not a number"
            return self._of_frame(reading, row, "invalid", text)

        self._events.report_rows(list(bad), describe)
