"""Write a table of logs as LAS 2.0: the sections of the header, then one line for each depth. ``las.py`` reads LAS.

~Version     VERS, WRAP
~Well        STRT, STOP, STEP, NULL, the entries of the header (LAS_WELL; empty if not known), PROG
~Curve       mnemonic, unit and description of every log
~Parameter   the facts of the table: bit size, basis, windows ...
~A           the logs; -999.25 where a value is missing
"""

from __future__ import annotations

import re
from collections.abc import Mapping

import numpy as np

from helibore.base.arrays import Floats
from helibore.base.tables import LogColumn, LogTable

NULL = -999.25
LAS_WELL = {"company": "COMP", "well": "WELL", "field": "FLD", "location": "LOC", "service": "SRVC", "run": "RUN",
            "date": "DATE", "datum": "DATUM", "kb": "EKB", "gl": "EGL", "bit": "BS", "mud": "MUD",
            "remarks": "REM"}  # fmt: skip
"""For each entry of `helibore.channels.header_entries`, its mnemonic in LAS (~Well) and DLIS (parameters)."""

_STEP_DECIMALS = 5
LONGEST_LINE = 256
"""Characters of a line that is not wrapped, by the rules of LAS 2.0. Longer rows are written without zeros before the
point (.228950); the columns of images by sector are longer still."""

_LEADING_ZERO = re.compile(r"^( *-?)0\.")


def every_column(table: LogTable) -> list[LogColumn]:
    """Return the columns of a table, and those of its images by sector."""
    return [*table, *(column for image in table.images for column in image.columns())]


def las_text(table: LogTable, header: Mapping[str, str]) -> str:
    """Return a LAS 2.0 file as text. Entries of the header that are not in `LAS_WELL` are left out."""
    columns = every_column(table)
    texts = [column.texts(f"{NULL:.2f}") for column in columns]
    widths = [max(map(len, column), default=0) for column in texts]
    if sum(widths) + len(widths) - 1 > LONGEST_LINE and not table.images:
        texts = [[_LEADING_ZERO.sub(r"\1.", text) for text in column] for column in texts]
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
        _las_line("STEP", table.depth.unit.upper(), _las_step(depth), "Step; 0 if the steps are uneven"),
        _las_line("NULL", "", f"{NULL:.2f}", "Missing"),
        *(_las_line(LAS_WELL[name], *_unit_and_value(known.get(name, "")), name.capitalize()) for name in LAS_WELL),
        _las_line("PROG", "", "helibore", "Made by"),
        "~Curve Information",
        *(_las_line(column.mnemonic, column.unit.upper(), "", one_line(column.description)) for column in columns),
        "~Parameter Information",
        *(_las_line(mnemonic_of(name), *_unit_and_value(text), one_line(name)) for name, text in table.facts.items()),
        "~A  " + " ".join(column.mnemonic for column in columns),
    ]  # fmt: skip
    cells = [[text.rjust(width) for text in column] for column, width in zip(texts, widths, strict=True)]
    for row in zip(*cells, strict=True):
        lines.append(" ".join(row))
    return "\n".join(lines) + "\n"


def _las_line(mnemonic: str, unit: str, value: str, description: str) -> str:
    return f"{mnemonic:<9}.{unit:<5} {value:>14} : {description}"


def _unit_and_value(text: str) -> tuple[str, str]:
    """Return unit and value of a fact such as "0.216 m". Any other text is a value on one line, with the unit ""."""
    quantity = re.fullmatch(r"([-+.\deE]+) (m|mm|in|ft|m3|deg|s)", text)
    return (quantity[2].upper(), quantity[1]) if quantity else ("", one_line(text))


def _las_step(depth: Floats) -> str:
    if depth.size < 2:
        return "0"
    step = round(float(depth[-1] - depth[0]) / (depth.size - 1), _STEP_DECIMALS)
    even = np.abs(depth - (depth[0] + step * np.arange(depth.size))).max() < 10.0**-_STEP_DECIMALS
    return f"{step:.{_STEP_DECIMALS}f}" if even else "0"


def mnemonic_of(name: str) -> str:
    return re.sub(r"[^A-Z0-9]+", "_", name.upper()).strip("_")


def one_line(text: str) -> str:
    """Return the text on one line, with ; in place of each colon, because a colon ends the value of a LAS line."""
    return " ".join(text.replace(":", ";").split())
