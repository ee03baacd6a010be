"""Write tables of logs to files: LAS 2.0 (``las_writing``), CSV, Parquet (through pyarrow), DLIS (through dliswriter).

    save_table(wall.logs().table(), "well.las")          the ending of the name decides the format

            missing values  facts (bit size ...)           images
    .las    -999.25         ~Parameter                     columns NAME[1] ..., their angles as {AF;5.625deg}
    .csv    empty           a file beside it (``facts``)   columns NAME[1] ...
    .parquet  null          metadata of the schema         columns NAME[1] ...
    .dlis   -999.25         parameters                     channels of K values with an axis of toolfaces

Files are written whole or not at all. ``hb.open`` reads them back. LAS and DLIS are ASCII: any other character of a
header or fact becomes "?". ``helibore.channels.header_entries`` reads the entries of a header from other files.
"""

from __future__ import annotations

import contextlib
import importlib
import io
import os
import tempfile
import warnings
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np

from helibore.base.atomic_file import write_whole
from helibore.base.errors import check_ending, require_library
from helibore.base.tables import LogTable
from helibore.files.facts import write_facts
from helibore.files.las_writing import LAS_WELL, NULL, every_column, las_text, mnemonic_of, one_line

ENDINGS = (".las", ".csv", ".parquet", ".dlis")


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
        Texts for the header of the file, by the names of `LAS_WELL`: company, field, location, date ...

    Raises
    ------
    InputError
        If the file has another ending: ``well.xls: the ending must be one of .las, .csv, .parquet, .dlis``.
    MissingExtraError
        If pyarrow (for ``.parquet``) or dliswriter (for ``.dlis``) is not installed.
    OSError
        If the file cannot be written; an existing file then does not change.
    """
    writer = {".las": _las, ".csv": _csv, ".parquet": _parquet, ".dlis": _dlis}[check_format(filename)]
    known = {name: one_line(text) for name, text in (header or {}).items()} | ({"well": one_line(well)} if well else {})
    write_whole(Path(filename), writer(table, known))
    if writer is _csv:
        write_facts(Path(filename), known | {name: " ".join(text.split()) for name, text in table.facts.items()})


def check_format(filename: str | os.PathLike[str]) -> str:
    """Return the ending of a file name; refuse an unknown ending, and an ending whose library is not installed."""
    ending = check_ending(filename, ENDINGS)
    if library := {".parquet": "pyarrow", ".dlis": "dliswriter"}.get(ending):
        require_library(library, ending[1:])
    return ending


def _las(table: LogTable, header: Mapping[str, str]) -> Callable[[BinaryIO], object]:
    content = _ascii(las_text(table, header)).encode()
    return lambda file: file.write(content)


def _csv(table: LogTable, _header: Mapping[str, str]) -> Callable[[BinaryIO], object]:
    columns = every_column(table)
    lines = [",".join(f"{column.mnemonic} ({column.unit})" if column.unit else column.mnemonic for column in columns)]
    lines += map(",".join, zip(*(column.texts("") for column in columns), strict=True))
    content = ("\n".join(lines) + "\n").encode()
    return lambda file: file.write(content)


def _parquet(table: LogTable, header: Mapping[str, str]) -> Callable[[BinaryIO], object]:
    import pyarrow

    columns = every_column(table)
    arrays = [pyarrow.array(column.values, from_pandas=True) for column in columns]  # NaN becomes null
    fields = [
        pyarrow.field(of.mnemonic, pyarrow.float64(), metadata={"unit": of.unit, "description": of.description})
        for of in columns
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
        # dliswriter takes the name of a file, not an open file.
        with tempfile.TemporaryDirectory() as folder, _silent():
            path = Path(folder) / "logs.dlis"
            _dlis_file(dliswriter, table, header).write(path, output_chunk_size=2**24)
            file.write(path.read_bytes())

    return write


@contextlib.contextmanager
def _silent() -> Iterator[None]:
    """Silence dliswriter's progress bar and its warnings.

    dliswriter warns about the unit m3, although RP66 V1 (appendix B) allows it. It also warns that a frame of one row
    has no spacing; a table without rows is written as one row of nulls.
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
    header = {name: _ascii(text) for name, text in header.items()}
    file = dliswriter.DLISFile()
    logical = file.add_logical_file()
    known = {"well_name": header.get("well"), "company": header.get("company"), "field_name": header.get("field")}
    logical.add_origin("ORIGIN", file_set_number=1, creation_time=None, product="helibore", **known)
    others = [name for name in LAS_WELL if name in header and name not in ("well", "company", "field")]
    facts = {LAS_WELL[name]: (name, header[name]) for name in others}
    facts |= {mnemonic_of(name): (_ascii(name), _ascii(text)) for name, text in table.facts.items()}
    for mnemonic, (name, text) in facts.items():
        logical.add_parameter(mnemonic, long_name=name, values=[text])
    channels = []
    for of in table:
        values = np.where(np.isnan(of.values), NULL, of.values) if table.rows else np.array([NULL])
        channel = logical.add_channel(of.mnemonic, data=values, units=of.unit or None, long_name=of.description)
        channels.append(channel)
    for image in table.images:
        step = 360.0 / image.values.shape[1]
        centres = (image.first + step * np.arange(image.values.shape[1])).tolist()
        axis = logical.add_axis(
            f"TOOLFACE_{image.mnemonic}",
            axis_id="TOOLFACE",
            coordinates=dliswriter.AttrSetup(centres, units="deg"),
            spacing=dliswriter.AttrSetup(step, units="deg"),
        )
        values = np.where(np.isnan(image.values), NULL, image.values)
        name, unit, text = image.mnemonic, image.unit or None, _ascii(image.description)
        channels.append(logical.add_channel(name, data=values, units=unit, long_name=text, axis=axis))
    logical.add_frame("LOGS", channels=channels, index_type="BOREHOLE-DEPTH")
    return file


def _ascii(text: str) -> str:
    return text.encode("ascii", "replace").decode()
