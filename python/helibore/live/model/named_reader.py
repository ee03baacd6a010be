"""Convert rows of named values to columns in core units: what a source sends by name instead of by item code."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence

import numpy as np

from helibore.base import units
from helibore.base.arrays import Bytes, Floats
from helibore.live.model.events import Event, EventBook
from helibore.live.model.mapping import ABSENT, INVALID, NULL, VALUE, Reading, SourceReader
from helibore.live.rules.depth_limits import DepthLimits
from helibore.live.rules.sources import INDEX, Item, NamedSource

MOST_NAMES = 200
"""The most names that are remembered of values that no setting maps."""
MOST_UNITS = 1000
"""The most pairs of a name and a wrong unit that are remembered."""


class NamedReader(SourceReader):
    """Reads a source whose values have names: curves, channels, keys."""

    STATE = (*SourceReader.STATE, "_unmapped", "_bad_units")
    message, word, nothing = "message", "channel", "bytes come, and nothing among them can be read"

    def __init__(self, source: NamedSource, events: EventBook, limits: DepthLimits) -> None:
        super().__init__(source, events, limits)
        self._named = source
        self._known = {curve.name for curve in source.curves}
        self._unmapped: dict[str, None] = {}
        self._bad_units: set[tuple[str, str]] = set()

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

    def _read_named(
        self, rows: Sequence[Mapping[str, object]], reading: Reading, scales: Mapping[str, float | None],
        index: Floats | None = None,
    ) -> None:  # fmt: skip
        """Fill ``reading``, which has the frame of each row, with the values of rows; None is a null.

        ``scales`` has the factor to core units of each name whose unit the source sends; None: its unit is wrong.
        ``index`` has the depth of each row, of a source whose rows are ordered by depth.
        """
        values = np.full((len(rows), len(self._column)), np.nan)
        states = np.zeros(values.shape, np.uint8)
        for curve in self._named.curves:
            column, name, bad = self._column[curve.name], curve.name, dict[int, object]()
            for place, row in enumerate(rows):
                if name not in row:
                    continue
                value, scale = row[name], scales.get(name, 1.0)
                self._seen.add(name)
                if scale is None:
                    states[place, column] = INVALID
                elif value is None or value == "" or value in self.source.nulls:
                    states[place, column] = NULL
                elif isinstance(value, bool) or not isinstance(value, (int, float)) or not math.isfinite(value):
                    states[place, column], bad[place] = INVALID, value
                else:
                    states[place, column] = VALUE
                    values[place, column] = value * scale
            self._report_bad(name, bad, reading)
        for row in rows:
            if not row.keys() <= self._known:
                self._note(row)
        if index is not None and INDEX in self._column:
            values[:, self._column[INDEX]], states[:, self._column[INDEX]] = index, VALUE
            self._unmeasured(states)
        for name, state in (("items", VALUE), ("nulls", NULL), ("not_numbers", INVALID)):
            self.counts[name] += int(np.count_nonzero(states == state))
        self._events.report_rows(self._wrong_numbers(values), lambda row: self._wrong_number(row, reading, values))
        self._fill(reading, values, states, np.zeros(len(rows), np.int64))

    def _report_bad(self, name: str, bad: dict[int, object], reading: Reading) -> None:
        def describe(row: int) -> Event:
            text = f"{name} = {str(bad[row])[:60]!r}: is not a number"
            return self._of_frame(reading, row, "invalid", text)

        self._events.report_rows(list(bad), describe)

    def _unmeasured(self, states: Bytes) -> None:
        """Mark the index, if it is the depth, as absent in rows without a caliper value: these rows give no triple."""
        caliper, place = self.source.caliper, self._column.get(INDEX)
        if caliper and place is not None:
            spoken = self._places([*caliper.toolface, *caliper.radius])[0]
            states[(states[:, spoken] == ABSENT).all(axis=1), place] = ABSENT

    def _scale(self, curve: Item, unit: str, wall: int) -> float | None:
        """Return the scale of a curve; None if its unit is wrong. An event reports each wrong unit of a curve once."""
        try:
            if curve.unit and unit.strip() and unit.strip().casefold() != curve.unit.casefold():
                raise ValueError(f"unit '{unit}': the configuration says '{curve.unit}'")
            return units.factor(unit, curve.kind) if curve.kind else 1.0
        except ValueError as error:
            if (curve.name, unit) not in self._bad_units and len(self._bad_units) < MOST_UNITS:
                self._bad_units.add((curve.name, unit))
                self._report(wall, "unit", f"{self.word} {curve.name}: {error}: not read")
            return None
