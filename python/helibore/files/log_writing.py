"""Write tables of logs to files: LAS 2.0 and CSV as text, Parquet through pyarrow, DLIS through dliswriter.

    save_table(wall.logs().table(), "well.las")          the ending decides the format

            missing values           facts (bit size, basis, windows ...)
    .las    -999.25                  ~Parameter
    .csv    empty                    comment lines above the header
    .parquet  null                   metadata of the schema
    .dlis   -999.25                  parameters; channels have units and long names

Files are written whole or not at all. ``hb.open`` reads them back.
"""

from __future__ import annotations

import contextlib
import importlib
import io
import os
import re
import tempfile
import warnings
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np

from helibore.base.arrays import Floats
from helibore.base.atomic_file import write_whole
from helibore.base.errors import check_ending, require_library
from helibore.base.tables import LogColumn, LogTable

ENDINGS = (".las", ".csv", ".parquet", ".dlis")
NULL = -999.25
LAS_WELL = {"company": "COMP", "well": "WELL", "field": "FLD", "location": "LOC", "service": "SRVC", "run": "RUN",
            "date": "DATE", "datum": "DATUM", "kb": "EKB", "gl": "EGL", "bit": "BS", "mud": "MUD",
            "remarks": "REM"}  # fmt: skip
"""Mnemonics of what is known of the hole."""

_DECIMALS = {"m": 6, "m3": 7, "deg": 2, "s": 2, "": 5}
_STEP_DECIMALS = 5


def save_table(
    table: LogTable, filename: str | os.PathLike[str], well: str = "", header: Mapping[str, str] | None = None
) -> None:
    """Write a table of logs; the ending of the name decides the format.

    Parameters
    ----------
    table
        The logs; their order is kept.
    filename
        Ends in .las, .csv, .parquet or .dlis; an existing file is replaced.
    well
        Name of the well, for the formats that have a place for it.
    header
        What else is known of the hole, by name: company, field, location, date ... (`helibore.channels.log_header`).

    Raises
    ------
    InputError
        ``well.xls: the ending must be one of .las, .csv, .parquet, .dlis``.
    MissingExtraError
        ``.parquet`` needs pyarrow and ``.dlis`` dliswriter.
    OSError
        If the file cannot be written; an existing file then does not change.
    """
    writer = {".las": _las, ".csv": _csv, ".parquet": _parquet, ".dlis": _dlis}[check_format(filename)]
    known = {name: _one_line(text) for name, text in (header or {}).items()} | (
        {"well": _one_line(well)} if well else {}
    )
    write_whole(Path(filename), writer(table, known))


def check_format(filename: str | os.PathLike[str]) -> str:
    """Return the ending; refuse an ending that `save_table` does not know, or whose library is not installed."""
    ending = check_ending(filename, ENDINGS)
    if library := {".parquet": "pyarrow", ".dlis": "dliswriter"}.get(ending):
        require_library(library, ending[1:])
    return ending


def _texts(column: LogColumn, missing: str) -> list[str]:
    """Write values with the decimals of the column or, if it states none, of its unit (6 for lengths)."""
    decimals = _DECIMALS.get(column.unit, 6) if column.decimals is None else column.decimals
    return [f"{value:.{decimals}f}" if value == value else missing for value in column.values.tolist()]


def _las(table: LogTable, header: Mapping[str, str]) -> Callable[[BinaryIO], object]:
    """Write LAS 2.0 (CWLS): version, well, curve, parameter, ascii. Texts go in the value field, before the colon."""
    texts = [_texts(column, f"{NULL:.2f}") for column in table]
    widths = [max(map(len, column), default=0) for column in texts]
    first, last = (texts[0][0], texts[0][-1]) if table.rows else (f"{NULL:.2f}",) * 2
    depth = table.depth.values
    known = {"bit": table.facts.get("bit diameter", ""), **header}
    lines = [
        "~Version Information",
        _las_line("VERS", "", "2.0", "CWLS LOG ASCII STANDARD - VERSION 2.0"),
        _las_line("WRAP", "", "NO", "One line a depth"),
        "~Well Information",
        _las_line("STRT", table.depth.unit.upper(), first, "First depth"),
        _las_line("STOP", table.depth.unit.upper(), last, "Last depth"),
        _las_line("STEP", table.depth.unit.upper(), _las_step(depth), "Step; 0 where no even step fits the decimals"),
        _las_line("NULL", "", f"{NULL:.2f}", "Missing"),
        *(_las_line(LAS_WELL[name], *_unit_and_value(known.get(name, "")), name.capitalize()) for name in LAS_WELL),
        _las_line("PROG", "", "helibore", "Made by"),
        "~Curve Information",
        *(_las_line(column.mnemonic, column.unit.upper(), "", _one_line(column.description)) for column in table),
        "~Parameter Information",
        *(_las_line(_mnemonic(name), *_unit_and_value(text), _one_line(name)) for name, text in table.facts.items()),
        "~A  " + " ".join(column.mnemonic for column in table),
    ]  # fmt: skip
    columns = [[text.rjust(width) for text in column] for column, width in zip(texts, widths, strict=True)]
    for row in zip(*columns, strict=True):
        lines.append(" ".join(row))
    content = ("\n".join(lines) + "\n").encode("ascii", "replace")
    return lambda file: file.write(content)


def _las_line(mnemonic: str, unit: str, value: str, description: str) -> str:
    return f"{mnemonic:<9}.{unit:<5} {value:>14} : {description}"


def _unit_and_value(text: str) -> tuple[str, str]:
    """Return the unit and the value of a fact as LAS writes them; a fact that is no quantity has the unit ""."""
    quantity = re.fullmatch(r"([-+.\deE]+) (m|mm|in|ft|m3|deg|s)", text)
    return (quantity[2].upper(), quantity[1]) if quantity else ("", _one_line(text))


def _las_step(depth: Floats) -> str:
    if depth.size < 2:
        return "0"
    step = round(float(depth[-1] - depth[0]) / (depth.size - 1), _STEP_DECIMALS)
    even = np.abs(depth - (depth[0] + step * np.arange(depth.size))).max() < 10.0**-_STEP_DECIMALS
    return f"{step:.{_STEP_DECIMALS}f}" if even else "0"


def _mnemonic(name: str) -> str:
    return re.sub(r"[^A-Z0-9]+", "_", name.upper()).strip("_")


def _one_line(text: str) -> str:
    """Return the text without colons and line breaks, which separate fields in LAS."""
    return " ".join(text.replace(":", ";").split())


def _csv(table: LogTable, header: Mapping[str, str]) -> Callable[[BinaryIO], object]:
    facts = {**header, **table.facts}
    lines = [f"# {name}: {' '.join(text.split())}" for name, text in facts.items()]
    lines.append(",".join(f"{column.mnemonic} ({column.unit})" if column.unit else column.mnemonic for column in table))
    lines += map(",".join, zip(*(_texts(column, "") for column in table), strict=True))
    content = ("\n".join(lines) + "\n").encode()
    return lambda file: file.write(content)


def _parquet(table: LogTable, header: Mapping[str, str]) -> Callable[[BinaryIO], object]:
    import pyarrow

    arrays = [pyarrow.array(column.values, from_pandas=True) for column in table]  # NaN becomes null
    fields = [
        pyarrow.field(of.mnemonic, pyarrow.float64(), metadata={"unit": of.unit, "description": of.description})
        for of in table
    ]
    schema = pyarrow.schema(fields, metadata={**header, **table.facts})
    rows = pyarrow.Table.from_arrays(arrays, schema=schema)
    return lambda file: write_parquet(rows, file)


def write_parquet(table: Any, file: BinaryIO) -> None:
    """Write a ``pyarrow.Table`` with a checksum for each page, so that a flipped bit is an error, not a wrong value."""
    from pyarrow import parquet

    parquet.write_table(table, file, write_page_checksum=True)


def _dlis(table: LogTable, header: Mapping[str, str]) -> Callable[[BinaryIO], object]:
    import dliswriter

    def write(file: BinaryIO) -> None:
        """Write to a temporary file first: dliswriter takes a file's name, not an open file."""
        with tempfile.TemporaryDirectory() as folder, _silent():
            path = Path(folder) / "logs.dlis"
            _dlis_file(dliswriter, table, header).write(path, output_chunk_size=2**24)
            file.write(path.read_bytes())

    return write


@contextlib.contextmanager
def _silent() -> Iterator[None]:
    """Silence dliswriter's progress bar and its warning about the unit m3 (allowed by RP66 V1, appendix B).

    dliswriter also warns that a frame of one row has no spacing; a table without rows is written as one row of nulls.
    """
    module: Any = importlib.import_module("dliswriter.file.writer")
    bar = module.progressbar
    module.progressbar = lambda records, **_: records
    try:
        with contextlib.redirect_stderr(io.StringIO()), warnings.catch_warnings(action="ignore"):
            yield
    finally:
        module.progressbar = bar


def _dlis_file(dliswriter: Any, table: LogTable, header: Mapping[str, str]) -> Any:
    file = dliswriter.DLISFile()
    logical = file.add_logical_file()
    known = {"well_name": header.get("well"), "company": header.get("company"), "field_name": header.get("field")}
    logical.add_origin("ORIGIN", file_set_number=1, creation_time=None, product="helibore", **known)
    facts = {LAS_WELL[name]: (name, text) for name, text in header.items() if name not in ("well", "company", "field")}
    facts |= {_mnemonic(name): (name, text) for name, text in table.facts.items()}
    for mnemonic, (name, text) in facts.items():
        logical.add_parameter(mnemonic, long_name=name, values=[text])
    channels = []
    for of in table:
        values = np.where(np.isnan(of.values), NULL, of.values) if table.rows else np.array([NULL])
        channel = logical.add_channel(of.mnemonic, data=values, units=of.unit or None, long_name=of.description)
        channels.append(channel)
    logical.add_frame("LOGS", channels=channels, index_type="BOREHOLE-DEPTH")
    return file
