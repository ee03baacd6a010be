"""Read a log file of any format; its content decides the format, its name does not."""

from __future__ import annotations

from importlib import import_module
from pathlib import Path

from helibore.base.errors import InputError, require_library
from helibore.files.input_file import InputFile, ReadOptions, find_format
from helibore.files.raw_set import Loss, RawFile

READERS = {
    "csv": ("delimited", "read"), "xlsx": ("spreadsheet", "read"), "las": ("las", "read"), "dlis": ("dlis", "read"),
    "lis": ("lis", "read"), "json": ("json_log", "read"), "witsml": ("witsml_log", "read"),
    "parquet": ("columnar", "read_parquet"), "npz": ("columnar", "read_npz"),
}  # fmt: skip
"""For each format, the module of this folder and its function that read it. A module is imported at its first use."""

STATED_OF = {"header_line": ("csv", "xlsx"), "encoding": ("csv", "las", "json"), "decimal": ("csv", "las", "xlsx")}
"""For each of the `ReadOptions` that only some formats take, these formats."""

LIBRARIES = {".las": "lasio", ".dlis": "dlisio", ".lis": "dlisio", ".xlsx": "python_calamine", ".parquet": "pyarrow"}
"""The library that reads a format, by the usual ending of the format's files. Other formats need no library."""


def ending_of(address: str) -> str:
    """Return the ending of a file's name or address in lower case; ``.gz`` at the end is ignored."""
    return Path(address.lower().removesuffix(".gz")).suffix


def check_library(ending: str) -> None:
    """Refuse an ending (from `ending_of`) if the library that its files need is not installed."""
    if ending in LIBRARIES:
        require_library(LIBRARIES[ending], "dlis" if ending == ".lis" else ending[1:])


def read_file(path: Path, options: ReadOptions, of_many: bool = False) -> RawFile:
    """Read a file of any format. Only tables may have a stated header line, and only texts the other options.

    With ``of_many``, the options are those of several files: an encoding or a decimal mark that the format cannot have
    is no error.
    """
    if path.is_dir():
        raise IsADirectoryError(f"{path}: is a directory")
    source = InputFile(path, options)
    name = find_format(source)
    for stated, formats in STATED_OF.items():
        value = getattr(options, stated)
        if value is not None and name not in formats and not (of_many and stated != "header_line"):
            raise InputError(
                f"{path.name}: {stated}", f"is for {', '.join(formats)}, but the file is {name}", str(value)
            )
    module, reader = READERS[name]
    file: RawFile = getattr(import_module(f"helibore.files.{module}"), reader)(source)
    for each in file.sets:
        each.remarks.extend(map(Loss, sorted(source.lost)))
    if not file.sets:
        raise source.error(f"{file.format}: holds no channels")
    losses = [remark for each in file.sets for remark in each.remarks if isinstance(remark, Loss)]
    if options.strict and losses:
        file.close()
        raise InputError(path.name, f"only a part can be read: {losses[0]}", setting="reading.strict")
    return file
