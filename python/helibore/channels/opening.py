"""``hb.open`` reads a log file of any format, or a data frame; its channels are looked up by their names."""

from __future__ import annotations

from collections.abc import Iterable
from os import PathLike
from pathlib import Path
from typing import Any

from helibore.base.nulls import NULLS
from helibore.channels.log_set import LogFile, LogSet
from helibore.channels.sectors import join_sectors
from helibore.files.input_file import ReadOptions
from helibore.files.raw_set import RawFile
from helibore.files.reading import read_file


def open(  # noqa: A001
    path: str | PathLike[str] | Any,
    nulls: Iterable[float] = NULLS,
    header_line: int | None = None,
    encoding: str | None = None,
    decimal: str | None = None,
    salvage: bool = False,
    strict: bool = False,
    layouts: str | PathLike[str] | None = None,
) -> LogFile:
    """Open a log file of any format, or a data frame; the content of a file decides the format, not its name.

    Parameters
    ----------
    path
        CSV, TSV, XLSX, Parquet, LAS 2.0 or 3.0, DLIS, LIS, JSON Well Log Format, WITSML 1.4.1.1 log or trajectory, or
        NPZ. The text formats may be gzipped. Or a data frame of pandas, Polars, Arrow or xarray, or a dict of columns:
        its units, missing values and roles follow the rules for files, so that the frame and the file that it was read
        from give the same samples and the same remarks.
    nulls
        Numbers that mean "no measurement", in addition to a number that the file declares.
    header_line
        For CSV, TSV and XLSX: the line of the column names, counted from 1. None: helibore looks for this line.
    encoding
        For text: its encoding, such as "cp1251". None: UTF-8 (or UTF-16 with its mark), or else Windows-1252.
    decimal
        For CSV, TSV and LAS: the decimal mark, "." or ",". None: the cells decide, and a remark states what was read.
    salvage
        Whether a truncated or damaged DLIS, gzipped, text or table file gives what lies before the damage; a remark
        states what is lost.
    strict
        Whether a file of which only a part can be read is refused. Without it, a remark names the rest.
    layouts
        A TOML file of rules for the layout of texts, which come before those of helibore: which lines are comments,
        footers or names, and where names, units and rows stand.

    Returns
    -------
    LogFile
        Channels by name, in one or more sets. The columns of Parquet, except lists, and the rows of DLIS are read when
        they are first used; other formats are read at once. A damaged or empty set is left out, and the other sets have
        a remark about it.

    Raises
    ------
    InputError
        If the content has none of these formats, or breaks the rules of its format. The error names the file, the line
        or column if it is known, and the rule.
    MissingExtraError
        If the format needs a library that is not installed. The error names the extra that installs the library.
    OSError
        If the file cannot be read.

    Examples
    --------
    >>> file = hb.open("well.las")                      # doctest: +SKIP
    >>> file["GR"].values, file["GR"].unit              # doctest: +SKIP
    >>> file.image("ABDC").values.shape                 # doctest: +SKIP
    """
    nulls = tuple(float(null) for null in nulls)
    if isinstance(path, str | PathLike):
        rules = None if layouts is None else Path(layouts)
        return open_file(Path(path), ReadOptions(nulls, header_line, encoding, decimal, salvage, strict, rules))
    from helibore.files.data_frame import read_frame

    return _with_images(read_frame(path, nulls))


def open_file(path: Path, options: ReadOptions, of_many: bool = False) -> LogFile:
    """Open a file as `open` does; with ``of_many``, an option counts where the format can have it."""
    return _with_images(read_file(path, options, of_many))


def _with_images(raw: RawFile) -> LogFile:
    """Return an opened file in which sector columns are images."""
    path = raw.sets[0].path
    sets = []
    for one in raw.sets:
        channels, gaps = join_sectors(one.channels, one.index)
        remarks = [*one.remarks, *gaps]
        sets.append(LogSet(path, one.name, channels, one.rows, one.index, one.header, remarks, one.line_of))
    return LogFile(path, raw.format, sets, raw.close)
