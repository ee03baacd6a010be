"""Files as people have them: each opens by default, or with the option that its error or its remark names.

An entry is a text, what is asked of it, and the truth: values of the named columns, which are known because the entry
states them. Kinds of files that are refused stand in test_refused_files.py.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import helibore as hb

WELL = "~V\nVERS. 2.0:\nWRAP. NO:\n~W\nSTRT.M 10:\nSTOP.M 11:\nSTEP.M 1:\nNULL. -999.25:\n"
CURVES = "~C\nDEPT.M:\nC1.IN:\nC2.IN:\n"
ROWS = "10 9.5 8.5\n11 9.25 8.25\n"
TRUTH = {"DEPT": [10, 11], "C1": [9.5, 9.25], "C2": [8.5, 8.25]}


@dataclass
class Entry:
    """A file of the corpus: its content, options of `helibore.open`, its columns, and a part of a remark."""

    content: str | bytes
    columns: dict[str, list[float]] = field(default_factory=lambda: TRUTH)
    remark: str = ""
    options: dict[str, Any] = field(default_factory=dict)


LAS = {
    "plain": Entry(WELL + CURVES + "~A\n" + ROWS),
    "UTF-16, no mark, little-endian": Entry((WELL + CURVES + "~A\n" + ROWS).encode("utf-16-le")),
    "UTF-16, no mark, big-endian": Entry((WELL + CURVES + "~A\n" + ROWS).encode("utf-16-be")),
    "UTF-16 with its mark": Entry((WELL + CURVES + "~A\n" + ROWS).encode("utf-16")),
    "rows only, names after ~A": Entry("~A DEPT C1 C2\n" + ROWS, remark="the names stand after ~A"),
    "~ without a letter above the rows": Entry(WELL + CURVES + "~  DEPT  C1  C2\n" + ROWS),
    "a line of ~Parameter that is none": Entry(
        WELL + CURVES + "~P\n DEPTH  C1  C2\n~A\n" + ROWS, remark="line 14: the header is damaged"
    ),
    "more curves than columns, names after ~A": Entry(
        WELL + CURVES + "ROP.M/H:\n~A DEPT C1 C2\n" + ROWS, remark="~Curve also defines ROP"
    ),
    "a comma among points": Entry(
        WELL + CURVES + "GR.GAPI:\n~A\n10 9.5 8.5 123.450\n11 9.25 8.25 123,420\n12 9 8 123.450\n",
        {"DEPT": [10, 11, 12], "C1": [9.5, 9.25, 9]},
    ),
}
TABLES = {
    "points and thousands": Entry(
        'md_m,C1\n"1,000.5",9.5\n"950.5",9.25\n', {"md_m": [1000.5, 950.5], "C1": [9.5, 9.25]}
    ),
}
CORPUS = {f"{name}.{ending}": entry for ending, of in (("las", LAS), ("csv", TABLES)) for name, entry in of.items()}


@pytest.mark.parametrize("name", CORPUS)
def test_a_file_of_the_corpus_has_its_values(tmp_path: Path, name: str) -> None:
    entry = CORPUS[name]
    path = tmp_path / name
    path.write_bytes(entry.content if isinstance(entry.content, bytes) else entry.content.encode())
    opened = hb.open(path, **entry.options).set()
    for column, values in entry.columns.items():
        np.testing.assert_array_equal(opened.numbers(column), values, err_msg=column)
    assert any(entry.remark in remark for remark in opened.remarks) or not entry.remark


def test_a_number_with_another_mark_than_its_column_is_named(tmp_path: Path) -> None:
    path = tmp_path / "w.las"
    path.write_text(str(LAS["a comma among points"].content))
    with pytest.raises(hb.InputError, match=r"line 16, column GR = '123,420': is not a number"):
        hb.open(path).set().numbers("GR")


@pytest.mark.parametrize(
    ("columns", "cells", "seconds", "remark"),
    [
        ("DATE.:\nTIME.:\n", ("2021-03-04 12:00:00", "2021-03-05 00:00:30"), [0.0, 43230.0], ""),
        ("TIME.:\n", ("12:00:00", "12:00:01"), None, "TIME is not used: '12:00:00'"),
        ("DATE.:\nTIME.:\n", ("04/03/2021 12:00:00", "04/03/2021 12:00:01"), None, "TIME is not used: '04/03/2021T"),
    ],
)
def test_dates_and_times_of_day_beside_a_caliper(
    tmp_path: Path, columns: str, cells: tuple[str, str], seconds: list[float] | None, remark: str
) -> None:
    path = tmp_path / "w.las"
    rows = "".join(f"{1000 + at} 9.5 8.5 {20 * at} {cell}\n" for at, cell in enumerate(cells))
    path.write_text(WELL + CURVES + "RB.DEG:\n" + columns + "~A\n" + rows)
    opened = hb.open(path).set()
    found = opened.readings().time
    if seconds is None:
        assert found is None
        assert any(remark in each for each in opened.remarks)
    else:
        assert found is not None
        np.testing.assert_array_equal(found - found[0], seconds)


CYRILLIC = WELL + "~C\nDEPT.M:\nДС1.мм:\nДС2.мм:\nАПС.град:\n~A\n"
"""Two diameters and the toolface of a well from 10 m on; a round hole of 200 mm."""


def test_settings_of_reading_in_a_project(tmp_path: Path) -> None:
    rows = "".join(f"{10 + at},0 200,0 200,0 {(at * 40) % 360},0\n" for at in range(60))
    (tmp_path / "w.las").write_bytes((CYRILLIC + rows).encode("cp1251"))
    (tmp_path / "well.toml").write_text(
        "caliper = 'w.las'\n[reading]\nencoding = 'cp1251'\ndecimal = ','\n[wall]\nbit_diameter = '200mm'\n"
        "[columns]\ntoolface = 'АПС'\ndiameter = ['ДС1@0', 'ДС2@90']\n"
    )
    wall = hb.reconstruct(tmp_path / "well.toml")
    np.testing.assert_allclose(wall.radius, 0.1, atol=1e-12)
    (tmp_path / "well.toml").write_text("caliper = 'w.las'\n[reading]\nencoding = 'latin'\nbit = 1\n")
    with pytest.raises(hb.InputError, match=r"line 4: reading.bit: must be one of encoding"):
        hb.reconstruct(tmp_path / "well.toml")
