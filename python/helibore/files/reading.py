"""Read a log file of any format; its content tells the format, its name does not."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from helibore.base.errors import InputError
from helibore.files.raw_set import RawFile
from helibore.files.source import Source, file_error, find_format


def read_file(path: Path, nulls: tuple[float, ...], header_line: int | None = None) -> RawFile:
    """Return the sets of a file; ``header_line`` is for tables."""
    if path.is_dir():
        raise IsADirectoryError(f"{path}: is a directory")
    source = Source(path)
    name = find_format(source)
    if name == "csv":
        from helibore.files import delimited

        return delimited.read(source, nulls, header_line)
    if name == "xlsx":
        from helibore.files import spreadsheet

        return spreadsheet.read(source, nulls, header_line)
    if header_line is not None:
        raise InputError(f"{path.name}: header_line", f"is for tables, and this is {name}", str(header_line))
    file = _reader(name)(source, nulls)
    if not file.sets:
        raise file_error(path, f"{file.format}: holds no channels")
    return file


def _reader(name: str) -> Callable[[Source, tuple[float, ...]], RawFile]:
    """The reader of a format, imported when it is needed."""
    if name == "las":
        from helibore.files.las import read
    elif name == "dlis":
        from helibore.files.dlis import read
    elif name == "lis":
        from helibore.files.lis import read
    elif name == "json":
        from helibore.files.json_log import read
    elif name == "witsml":
        from helibore.files.witsml import read
    elif name == "parquet":
        from helibore.files.columnar import read_parquet as read
    else:
        from helibore.files.columnar import read_npz as read
    return read
