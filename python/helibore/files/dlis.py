"""DLIS (RP66 V1) through dlisio: one LogSet for each frame of each logical file.

    frame row = [FRAMENO, index, channel (scalar), channel (K sectors), ...]      DIMENSION, AXIS, UNITS per channel

The rows of a frame are read once, whole, when the first value is asked: one channel at a time would read the file
again and again (18 minutes against 0.6, dlisio issue 436). dlisio already reverses DIMENSION and AXIS into C order.
Channels of more than one axis become (n, all elements), remarked on.
"""

from __future__ import annotations

import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

import numpy as np

from helibore.files.channel import Array, Channel, LogFile, LogSet, SectorAxis, unique
from helibore.files.source import Source, complaint, missing_library


def read(source: Source, nulls: tuple[float, ...]) -> LogFile:
    """Open a DLIS file; the rows of a frame are read when first asked."""
    try:
        from dlisio import dlis
    except ImportError as error:
        raise missing_library("dlisio", "dlis") from error
    try:
        with _decoding():
            logical_files = dlis.load(str(source.path))
    except Exception as error:  # the C++ core throws RuntimeError, ValueError, OSError, EOFError alike
        raise complaint(source.path, f"truncated or damaged DLIS ({_first_line(error)})") from error
    try:
        sets = []
        with _decoding() as undecoded:
            for number, logical in enumerate(logical_files):
                label = f"{number}/" if len(logical_files) > 1 else ""
                frames = list(logical.frames)
                names = unique([_text(frame.name) for frame in frames])
                found = [_frame(source, label + name, frame, nulls) for name, frame in zip(names, frames, strict=True)]
                sets += [one for one in found if one.rows]
        for one in sets:
            one.remarks.extend(sorted(undecoded))
    except Exception as error:
        logical_files.close()
        if isinstance(error, ValueError) and str(error).startswith(source.path.name):
            raise
        raise complaint(source.path, f"truncated or damaged DLIS ({_first_line(error)})") from error
    if not sets:
        logical_files.close()
        raise complaint(source.path, "DLIS without a frame that has rows")
    return LogFile(source.path, "DLIS", sets, logical_files.close)


@contextmanager
def _decoding() -> Iterator[set[str]]:
    """Collect what dlisio warns of (text that is not UTF-8 comes back as bytes) as remarks."""
    remarks: set[str] = set()
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        yield remarks
    remarks.update(str(warning.message) for warning in caught)


def _text(value: Any) -> str:
    """A text attribute; what dlisio could not decode is read as Windows-1252."""
    if isinstance(value, bytes):
        return value.decode("cp1252", "replace")
    return "" if value is None else str(value)


def _first_line(error: Exception) -> str:
    return (str(error).strip().splitlines() or [type(error).__name__])[0]


def _frame(source: Source, name: str, frame: Any, nulls: tuple[float, ...]) -> LogSet:
    """One frame: its channels now, its rows when first asked."""
    rows = _Rows(source, name, frame)
    dtype = frame.dtype()
    labels = [label for label in dtype.names if label != "FRAMENO"]
    if len(labels) != len(frame.channels):
        rule = f"frame {name}: {len(labels)} columns for {len(frame.channels)} channels"
        raise complaint(source.path, rule)
    channels = []
    remarks = []
    count = rows.count()
    for label, channel in zip(labels, frame.channels, strict=True):
        dimension = tuple(int(size) for size in channel.dimension or [1])
        if len(dimension) > 1:
            remarks.append(f"{label}: {' x '.join(map(str, dimension))} elements a row, laid out as one axis")
        size = int(np.prod(dimension))
        shape = (count,) if size == 1 else (count, size)
        text = dtype.fields[label][0].base.kind in "OSU"
        load = _loader(rows, label, shape)
        described = _text(channel.long_name)
        channels.append(Channel(label, _text(channel.units), described, shape, load, nulls, _axis(channel), text))
    index = labels[0] if frame.index_type else None
    header = {key: _text(value) for key, value in _header(frame).items() if value not in (None, "")}
    if frame.index_type is None:
        remarks.append("the frame states no index type: rows are only numbered")
    return LogSet(source.path, name, channels, count, index, header, remarks)


class _Rows:
    """The rows of one frame, read once."""

    def __init__(self, source: Source, name: str, frame: Any) -> None:
        self._source = source
        self._name = name
        self._frame = frame
        self._table: Array | None = None

    def table(self) -> Array:
        if self._table is None:
            try:
                with _decoding():
                    self._table = self._frame.curves()
            except Exception as error:
                rule = f"frame {self._name}: truncated or damaged rows ({_first_line(error)})"
                raise complaint(self._source.path, rule) from error
            if len(self._table) != self.count():
                rule = f"frame {self._name}: {len(self._table)} of {self.count()} rows are there: truncated or damaged"
                raise complaint(self._source.path, rule)
        return self._table

    def count(self) -> int:
        """How many rows, counted in the file's index: no value is read."""
        indices = self._frame.logicalfile.fdata_index.get(self._frame.fingerprint, [])
        return len(indices)


def _loader(rows: _Rows, label: str, shape: tuple[int, ...]) -> Callable[[], Array]:
    return lambda: rows.table()[label].reshape(shape)


def _header(frame: Any) -> dict[str, Any]:
    logical = frame.logicalfile
    header = {"index_type": frame.index_type, "direction": frame.direction, "spacing": frame.spacing}
    for origin in logical.origins[:1]:
        header |= {"well": origin.well_name, "field": origin.field_name, "company": origin.company}
    return header


def _axis(channel: Any) -> SectorAxis | None:
    """First coordinate and spacing of a channel's only axis, where the file states an axis."""
    axes = channel.axis
    if len(axes) != 1:
        return None
    coordinates, spacing = axes[0].coordinates, axes[0].spacing
    unit = _text(axes[0].attic["COORDINATES"].units) if coordinates else ""
    try:
        first = float(coordinates[0]) if coordinates else float("nan")
        step = float(spacing) if spacing is not None else float("nan")
        if spacing is None and len(coordinates) > 1:
            step = float(coordinates[1]) - float(coordinates[0])
    except (TypeError, ValueError):
        return None
    return SectorAxis(first, step, unit)
