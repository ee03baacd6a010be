"""Open any log file: ``hb.open(path)`` tells the format by content and gives channels by name.

    delimited.py  CSV, TSV, ; and | tables      las.py       LAS 2.0, LAS 3.0        json_log.py  JSON Well Log Format
    columnar.py   Parquet, NPZ                  dlis.py      DLIS (RP66 V1)          witsml.py    WITSML 1.4.1.1

What a channel *means* is guessed, with reasons, in ``helibore.channels.roles``; ``helibore.channels.columns`` turns
channels and meanings into a Caliper, a Survey or an image.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from os import PathLike
from pathlib import Path

from helibore.files.channel import CUSTOMARY_NULLS, Channel, LogFile, LogSet, SectorAxis
from helibore.files.source import Source, tell_format

__all__ = ["CUSTOMARY_NULLS", "Channel", "LogFile", "LogSet", "SectorAxis", "open"]


def open(path: str | PathLike[str], nulls: Iterable[float] = CUSTOMARY_NULLS) -> LogFile:  # noqa: A001
    """Open a log file of any format read; the format is told by content, not by the file's name.

    Parameters
    ----------
    path
        CSV, TSV, Parquet, LAS 2.0 or 3.0, DLIS, JSON Well Log Format, WITSML 1.4.1.1 log or trajectory, or NPZ. The
        text formats may be gzipped.
    nulls
        Values that mean "no measurement", beside the one the file declares. Compared as numbers.

    Returns
    -------
    LogFile
        Channels by name, in one or more sets. Values are loaded when first asked; a text format is read at once.

    Raises
    ------
    ValueError
        If the content is none of the formats, or breaks its rules; names file, line or column, and rule.
    ImportError
        If the format needs a library that is not installed; names the extra that brings it.
    OSError
        If the file cannot be read.

    Examples
    --------
    >>> file = hb.open("well.las")                      # doctest: +SKIP
    >>> file["GR"].values, file["GR"].unit              # doctest: +SKIP
    >>> file.image("ABDC").values.shape                 # doctest: +SKIP
    """
    path = Path(path)
    if path.is_dir():
        raise IsADirectoryError(f"{path}: is a directory")
    source = Source(path)
    return _reader(tell_format(source))(source, tuple(float(null) for null in nulls))


def _reader(name: str) -> Callable[[Source, tuple[float, ...]], LogFile]:
    """The reader of a format, imported when it is needed."""
    if name == "las":
        from helibore.files.las import read
    elif name == "dlis":
        from helibore.files.dlis import read
    elif name == "json":
        from helibore.files.json_log import read
    elif name == "witsml":
        from helibore.files.witsml import read
    elif name == "parquet":
        from helibore.files.columnar import read_parquet as read
    elif name == "npz":
        from helibore.files.columnar import read_npz as read
    else:
        from helibore.files.delimited import read
    return read
