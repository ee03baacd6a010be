"""Read a log file of any format; its content decides the format, its name does not."""

from __future__ import annotations

from importlib import import_module
from pathlib import Path

from helibore.base.errors import InputError, require_library
from helibore.files.input_file import InputFile, find_format
from helibore.files.raw_set import RawFile

READERS = {
    "csv": ("delimited", "read"), "xlsx": ("spreadsheet", "read"), "las": ("las", "read"), "dlis": ("dlis", "read"),
    "lis": ("lis", "read"), "json": ("json_log", "read"), "witsml": ("witsml_log", "read"),
    "parquet": ("columnar", "read_parquet"), "npz": ("columnar", "read_npz"),
}  # fmt: skip
"""For each format, the module of this folder and its function that read it. A module is imported at its first use."""

LIBRARIES = {".las": "lasio", ".dlis": "dlisio", ".lis": "dlisio", ".xlsx": "python_calamine", ".parquet": "pyarrow"}
"""The library that reads a format, by the usual ending of the format's files. Other formats need no library."""


def ending_of(address: str) -> str:
    """Return the ending of a file's name or address in lower case; ``.gz`` at the end is ignored."""
    return Path(address.lower().removesuffix(".gz")).suffix


def check_library(ending: str) -> None:
    """Refuse an ending (from `ending_of`) if the library that its files need is not installed."""
    if ending in LIBRARIES:
        require_library(LIBRARIES[ending], "dlis" if ending == ".lis" else ending[1:])


def read_file(path: Path, nulls: tuple[float, ...], header_line: int | None = None) -> RawFile:
    """Read a file of any format. ``nulls`` are numbers that mean no value; only tables may have a ``header_line``."""
    if path.is_dir():
        raise IsADirectoryError(f"{path}: is a directory")
    source = InputFile(path, nulls, header_line)
    name = find_format(source)
    if header_line is not None and name not in ("csv", "xlsx"):
        raise InputError(f"{path.name}: header_line", f"is for tables, but the file is {name}", str(header_line))
    module, reader = READERS[name]
    file: RawFile = getattr(import_module(f"helibore.files.{module}"), reader)(source)
    if not file.sets:
        raise source.error(f"{file.format}: holds no channels")
    return file
