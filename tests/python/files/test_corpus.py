"""Files as people have them: each opens by default, or with the option that its error or its remark names.

An entry is a text, what is asked of it, and the truth: values of the named columns, which are known because the entry
states them. Kinds of files that are refused stand in test_refused_files.py.
"""

from __future__ import annotations

import gzip
import re
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from golden_texts import Golden

import helibore as hb

WELL = "~V\nVERS. 2.0:\nWRAP. NO:\n~W\nSTRT.M 10:\nSTOP.M 11:\nSTEP.M 1:\nNULL. -999.25:\n"
CURVES = "~C\nDEPT.M:\nC1.IN:\nC2.IN:\n"
ROWS = "10 9.5 8.5\n11 9.25 8.25\n"
TRUTH = {"DEPT": [10, 11], "C1": [9.5, 9.25], "C2": [8.5, 8.25]}


@dataclass
class Entry:
    """A file of the corpus: its content, options of `helibore.open`, its columns, and a part of a remark."""

    content: str | bytes
    columns: dict[str, Any] = field(default_factory=lambda: TRUTH)
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
LAS |= {
    "CR LF": Entry((WELL + CURVES + "~A\n" + ROWS).replace("\n", "\r\n")),
    "CR": Entry((WELL + CURVES + "~A\n" + ROWS).replace("\n", "\r")),
    "UTF-8 with its mark": Entry((WELL + CURVES + "~A\n" + ROWS).encode("utf-8-sig")),
    "control-Z at the end": Entry(WELL + CURVES + "~A\n" + ROWS + "\x1a"),
    "blanks before ~": Entry((WELL + CURVES + "~A\n" + ROWS).replace("~", "  ~")),
    "small letters": Entry(WELL.replace("~V", "~v").replace("~W", "~w") + CURVES.replace("~C", "~c") + "~a\n" + ROWS),
    "no ~Version": Entry(WELL[WELL.index("~W") :] + CURVES + "~A\n" + ROWS, remark="no ~Version"),
    "no ~Well": Entry("~V\nVERS. 2.0:\nWRAP. NO:\n" + CURVES + "~A\n" + ROWS),
    "no ~Curve": Entry(WELL + "~A DEPT C1 C2\n" + ROWS, remark="no ~Curve"),
    "names below ~A": Entry(WELL + CURVES + "~A\nDEPT C1 C2\n" + ROWS, remark="repeats the header"),
    "names and units below ~A": Entry(WELL + CURVES + "~A\nDEPT C1 C2\nM IN IN\n" + ROWS, remark="repeats the header"),
    "1.2": Entry((WELL + CURVES + "~A\n" + ROWS).replace("VERS. 2.0", "VERS. 1.2"), remark="LAS 1.2"),
    "wrapped": Entry((WELL + CURVES + "~A\n10\n9.5 8.5\n11\n9.25 8.25\n").replace("WRAP. NO", "WRAP. YES")),
    "wrapped, although WRAP NO": Entry(WELL + CURVES + "~A\n10\n9.5 8.5\n11\n9.25 8.25\n", remark="over several lines"),
    "commas that no header states": Entry(WELL + CURVES + "~A\n" + ROWS.replace(" ", ",")),
    "tabs": Entry(WELL + CURVES + "~A\n" + ROWS.replace(" ", "\t")),
    "decimal commas": Entry(WELL + CURVES + "~A\n" + ROWS.replace(".", ","), remark="decimal commas"),
    "decimal commas by option": Entry(WELL + CURVES + "~A\n" + ROWS.replace(".", ","), options={"decimal": ","}),
    "comments among the rows": Entry(WELL + CURVES + "~A\n# start\n10 9.5 8.5\n# more\n11 9.25 8.25\n"),
    "a section below the rows": Entry(WELL + CURVES + "~A\n" + ROWS + "~Other\nnote\n", remark="~OTHER follows"),
    "NULL ****": Entry(
        (WELL + CURVES + "~A\n10 9.5 8.5\n11 ****** 8.25\n").replace("-999.25", "****"),
        {"DEPT": [10, 11], "C1": [9.5, np.nan]},
    ),
    "numbers without a blank": Entry(
        WELL + CURVES + "~A\n10 9.5 8.5\n11 9.25-999.25\n", {"C1": [9.5, 9.25], "C2": [8.5, np.nan]}, "without a blank"
    ),
    "1.#QNAN": Entry(WELL + CURVES + "~A\n10 9.5 8.5\n11 1.#QNAN 8.25\n", {"C1": [9.5, np.nan], "C2": [8.5, 8.25]}),
    "exponents": Entry(WELL + CURVES + "~A\n1.0E+01 9.5D0 85e-1\n11 9.25 8.25\n".replace("D0", "e0")),
    "two curves of one name": Entry(
        WELL + CURVES.replace("C2.IN", "C1.IN") + "~A\n" + ROWS, {"C1:1": TRUTH["C1"], "C1:2": TRUTH["C2"]}
    ),
    "a curve without a name": Entry(
        WELL + CURVES.replace("C2.IN", ".IN") + "~A\n" + ROWS, {"C1": TRUTH["C1"], "column 3": TRUTH["C2"]}
    ),
    "Cyrillic names by option": Entry(
        (WELL + CURVES.replace("C1.IN", "ДС1.мм") + "~A\n" + ROWS).encode("cp1251"),
        {"ДС1": TRUTH["C1"]},
        options={"encoding": "cp1251"},
    ),
    "Windows-1252": Entry(
        (WELL + CURVES.replace("C1.IN:", "C1.IN: Kaliber, größter") + "~A\n" + ROWS).encode("cp1252"),
        remark="encoding",
    ),
    "Cyrillic names without the option": Entry(
        (WELL + CURVES.replace("C1.IN", "ДС1.мм : диаметр скважины") + "~A\n" + ROWS).encode("cp1251"),
        {"C2": TRUTH["C2"]},
        "cp1251 reads диаметр",
    ),
    "German names in Windows-1252": Entry(
        (WELL + CURVES.replace("C1.IN:", "C1.IN: größter Kaliberdurchmesser, Öffnung") + "~A\n" + ROWS).encode(
            "cp1252"
        ),
        remark="the option encoding names another",
    ),
    "cut in a row": Entry(WELL + CURVES + "~A\n" + ROWS + "12 9.0", options={"salvage": True}, remark="salvaged"),
    "LAS 3, commas": Entry(
        (WELL + CURVES).replace("VERS. 2.0", "VERS. 3.0").replace("~W", "DLM. COMMA:\n~W")
        + "~ASCII\n"
        + ROWS.replace(" ", ",")
    ),
    "LAS 3, tabs": Entry(
        (WELL + CURVES).replace("VERS. 2.0", "VERS. 3.0").replace("~W", "DLM. TAB:\n~W")
        + "~A\n"
        + ROWS.replace(" ", "\t")
    ),
    "LAS 3, its own section names": Entry(
        (WELL + CURVES).replace("VERS. 2.0", "VERS. 3.0").replace("~C\n", "~Caliper_Parts\n")
        + "~Caliper | Caliper_Parts\n"
        + ROWS
    ),
    "VERS not stated": Entry((WELL + CURVES + "~A\n" + ROWS).replace("VERS. 2.0:\n", ""), remark="no VERS"),
    "a table below the curves": Entry(
        WELL + CURVES + "-----------\n  DEPT  C1  C2\n~A\n" + ROWS, remark="the header is damaged"
    ),
    "columns that only ~A names": Entry(
        WELL + CURVES + "~A DEPT C1 C2 GR\n" + ROWS.replace("8.5\n", "8.5 60\n").replace("8.25\n", "8.25 61\n"),
        TRUTH | {"GR": [60, 61]},
        "~Curve does not define GR",
    ),
    "more columns than curves": Entry(
        WELL + CURVES + "~A\n" + ROWS.replace("8.5\n", "8.5 60\n").replace("8.25\n", "8.25 61\n"),
        TRUTH | {"column 4": [60, 61]},
        "called by number",
        {"salvage": True},
    ),
    "more curves than columns": Entry(
        WELL + CURVES + "ROP.M/H:\n~A\n" + ROWS, TRUTH, "ROP has none", {"salvage": True}
    ),
    "fixed decimals without a blank": Entry(
        WELL + CURVES + "GR.GAPI:\n~A\n10.000 9.500 8.500101130.188\n11.000 9.250-19508.961 1.000\n",
        {"DEPT": [10, 11], "C2": [8.5, -19508.961], "GR": [101130.188, 1]},
        "after the decimals",
    ),
    "two overflowed fields": Entry(
        WELL + CURVES + "~A\n10 9.5 8.5\n11 ****************\n", {"C1": [9.5, np.nan], "C2": [8.5, np.nan]}
    ),
    "texts in quotes of both kinds": Entry(
        WELL + CURVES + "ZONE.:\n~A\n10 9.5 8.5 'top of it'\n11 9.25 8.25 \"below it\"\n"
    ),
    "gzipped": Entry(gzip.compress((WELL + CURVES + "~A\n" + ROWS).encode())),
}
"""Files of lasio's own tests have most of these flaws, here with values that are known."""

HEADER = ("MD (m)", "C1 (in)", "RB (deg)")
NUMBERS = ((1500.25, 9.5, 0.0), (1500.75, 9.25, 120.5), (1501.5, 10.125, 359.0))
"""Depth, a caliper and an angle of three rows; no cell of them has a mark of thousands."""
WANTED = {name: [row[at] for row in NUMBERS] for at, name in enumerate(HEADER)}


def rows_of(mark: str, decimal: str, thousands: str = "", quote: bool = False) -> str:
    """Return the three rows with a delimiter, a decimal mark and a mark of thousands."""

    def cell(value: float) -> str:
        text = f"{value:,.3f}".replace(",", "!").replace(".", decimal).replace("!", thousands)
        return f'"{text}"' if quote or mark in text else text

    return "".join(mark.join(map(cell, row)) + "\n" for row in NUMBERS)


def table(mark: str = ",", decimal: str = ".", thousands: str = "", start: str = "", quote: bool = False) -> str:
    return start + mark.join(HEADER) + "\n" + rows_of(mark, decimal, thousands, quote)


LOCALES = {"en": (",", ".", ","), "de": (";", ",", "."), "fr": (";", ",", "\u202f"), "ch": (";", ".", "’")}
"""For each locale of Excel: delimiter, decimal mark and mark of thousands."""
MARKS = {"comma": ",", "semicolon": ";", "tab": "\t", "bar": "|"}
ENCODINGS = ("utf-8", "utf-8-sig", "utf-16", "utf-16-le")
NEWLINES = {"LF": "\n", "CR LF": "\r\n", "CR": "\r"}
TABLES = {
    "points and thousands": Entry(
        'md_m,C1\n"1,000.5",9.5\n"950.5",9.25\n', {"md_m": [1000.5, 950.5], "C1": [9.5, 9.25]}
    ),
    "units in a row": Entry(
        "MD,C1,RB\nm,in,deg\n" + rows_of(",", "."), {"MD": WANTED["MD (m)"], "RB": WANTED["RB (deg)"]}
    ),
    "comments above": Entry(table(start="# Well: A-1\n# Datum: KB\n"), WANTED, "comment: Well"),
    "the header is a comment": Entry("# " + table(), WANTED),
    "blank lines": Entry(table().replace("\n", "\n\n"), WANTED),
    "every cell quoted": Entry(table(quote=True), WANTED),
    "blanks after commas": Entry(table().replace(",", ", "), WANTED),
    "a delimiter at the end": Entry(table().replace("\n", ",\n"), WANTED, "end in a delimiter"),
    "empty cells": Entry("MD (m),C1 (in)\n1,\n2,9.5\n", {"C1 (in)": [np.nan, 9.5]}),
    "null texts": Entry("MD (m),C1 (in)\n1,NULL\n2,n/a\n3,9.5\n", {"C1 (in)": [np.nan, np.nan, 9.5]}),
    "-999.25": Entry("MD (m),C1 (in)\n1,-999.25\n2,9.5\n", {"C1 (in)": [np.nan, 9.5]}),
    "no header": Entry(rows_of(",", "."), {"column 1": WANTED["MD (m)"]}, "so there is no header"),
    "a header line by option": Entry("a,b\nx\n" + table(), WANTED, options={"header_line": 3}),
    "columns between blanks": Entry(
        "MD C1 RB\n" + rows_of(" ", "."), {"MD": WANTED["MD (m)"], "C1": WANTED["C1 (in)"]}
    ),
    "names with units between blanks": Entry("MD (m)  C1 (in)  RB (deg)\n" + rows_of(" ", "."), WANTED),
    "Petrel trace": Entry(
        "# WELL TRACE FROM PETREL\n#====\n MD AZIM INCL\n#====\n 0.0 0.0 0.0\n 100.0 45.0 10.5\n",
        {"MD": [0, 100], "AZIM": [0, 45], "INCL": [0, 10.5]},
    ),
    "degrees and minutes": Entry("MD (m),INC\n0,0°30'\n9,12°15'\n", {"INC": [0.5, 12.25]}, "minutes"),
    "errors of Excel": Entry("MD (m),C1 (in)\n1,#DIV/0!\n2,#WERT!\n3,9.5\n", {"C1 (in)": [np.nan, np.nan, 9.5]}),
    "bearings below a zero": Entry(
        "MD (m),AZI\n0,0\n9,N 20 W\n", {"AZI": [0.0, 340.0]}, "bearings in quadrants (N 20 W)"
    ),
    "bearings": Entry("MD (m),AZI\n0,N 45 E\n9,S 30.5 W\n", {"AZI": [45.0, 210.5]}, "bearings"),
    "gzipped": Entry(gzip.compress(table().encode()), WANTED),
    "gzip that is cut": Entry(
        gzip.compress(("MD (m),C1 (in)\n" + "".join(f"{at},9.5\n" for at in range(3000))).encode())[:-12],
        {},
        "gzip stream ends early",
        {"salvage": True},
    ),
    "Windows-1252": Entry(
        table().replace("RB (deg)", "RB (°)").encode("cp1252"), {"RB (°)": WANTED["RB (deg)"]}, "encoding"
    ),
    "cp1251 by option": Entry(
        table().replace("C1 (in)", "ДС (мм)").encode("cp1251"),
        {"ДС (мм)": WANTED["C1 (in)"]},
        "",
        {"encoding": "cp1251"},
    ),
}
MIXED = {"MD": [1500.25, 1500.75, 1501.5], "C1": [9.5, 9.25, 10.125], "RB": [0.0, 120.5, 359.0]}
TABLES |= {
    "Techlog": Entry("#Techlog export\n#WELL\tA-1\nMD\tC1\tRB\nm\tin\tdeg\n" + rows_of("\t", "."), MIXED),
    "Techlog with the well in a column": Entry(
        "WELL\tMD\tC1\tRB\nunitless\tm\tin\tdeg\n" + rows_of("\t", ".").replace("150", "A-1\t150"),
        MIXED,
    ),
    "Landmark": Entry(
        "! OpenWorks\n! WELL: A-1, 8.5 in\n    MD      C1     RB\n   (M)    (IN)   (DEG)\n" + rows_of("  ", "."), MIXED
    ),
    "Compass": Entry(
        "Company:  ACME\nWell:     A-1\nSite: 1,5\n\nMD      Inc     Azi     TVD   +N/-S\n"
        "(usft)  (°)     (°)     (usft)   (usft)\n"
        "0.00  0.00  0.00  0.00  0.00\n1,500.00  5.00  45.30  1,499.40  2.10\n",
        {"MD": [0, 1500], "Inc": [0, 5], "Azi": [0, 45.3], "TVD": [0, 1499.4], "+N/-S": [0, 2.1]},
        "1,500.00 is read as 1500",
    ),
    "Compass in metres": Entry(
        "Company:  ACME\nMD Inc Azi\n(m) (deg) (deg)\n0.0 0.0 0.0\n500.0 5.0 45.3\n",
        {"MD": [0, 500], "Inc": [0, 5], "Azi": [0, 45.3]},
        "comment: Company",
    ),
    "WellCAD curves": Entry("MD,C1,RB\nm,in,deg\n" + rows_of(",", "."), MIXED),
    "WellCAD image": Entry(
        "Depth,0.00 deg,90.00 deg,180.00 deg,270.00 deg\nm,mm,mm,mm,mm\n10.00,110,111,112,113\n10.05,110,-999.25,1,2\n",
        {"IMAGE": [[110, 111, 112, 113], [110, np.nan, 1, 2]]},
        "the centre of the first lies at 45 deg",
    ),
    "WellCAD, German": Entry(
        "Depth;Caliper\nm;mm\n10,00;220,5\n10,05;220,4\n", {"Depth": [10, 10.05], "Caliper": [220.5, 220.4]}
    ),
}
TABLES |= {
    f"{mark_name}, {encoding}, {newline_name}": Entry(table(mark).replace("\n", newline).encode(encoding), WANTED)
    for mark_name, mark in MARKS.items()
    for encoding in ENCODINGS
    for newline_name, newline in NEWLINES.items()
}
TABLES |= {
    f"Excel {locale}, {kind}": Entry(content, WANTED)
    for locale, (mark, decimal, thousands) in LOCALES.items()
    for kind, content in {
        "plain": table(mark, decimal),
        "thousands": table(mark, decimal, thousands),
        "sep=": table(mark, decimal, start=f"sep={mark}\n"),
        "tabs, UTF-16": table("\t", decimal).encode("utf-16"),
    }.items()
}
CORPUS = {f"{name}.{ending}": entry for ending, of in (("las", LAS), ("csv", TABLES)) for name, entry in of.items()}


def test_the_corpus_is_large() -> None:
    assert len(CORPUS) >= 120


@pytest.mark.parametrize("name", CORPUS)
def test_a_file_of_the_corpus_has_its_values(tmp_path: Path, name: str) -> None:
    entry = CORPUS[name]
    path = tmp_path / re.sub(r"[^\w.]", "_", name)
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


def test_a_petrel_trace_is_a_survey_without_options(tmp_path: Path) -> None:
    (tmp_path / "w.dev").write_text(
        "# WELL TRACE FROM PETREL\n# WELL KB: 54.9 (ft)\n# ANGLES ARE GIVEN IN DEGREES\n#====\n"
        " MD AZIM_TN INCL AZIM_GN\n#====\n 0.0 0.0 0.0 1.0\n 1000.0 45.0 1.5 44.0\n 2000.0 45.0 3.5 44.0\n"
    )
    survey = hb.open(tmp_path / "w.dev").survey()
    np.testing.assert_allclose(survey.depth, [0, 304.8, 609.6])
    np.testing.assert_array_equal(survey.inclination, [0, 1.5, 3.5])
    assert (survey.azimuth[1], survey.north) == (45.0, "true")


@pytest.mark.parametrize(
    ("name", "north"), [("AZIM_MAG", "magnetic"), ("AZI_GRID", "grid"), ("AZIM_GN", "grid"), ("Azimut", "")]
)
def test_the_north_of_a_survey_by_its_name(tmp_path: Path, name: str, north: str) -> None:
    (tmp_path / "s.csv").write_text(f"MD (m),INC (deg),{name} (deg)\n0,0,0\n900,5,10\n")
    assert hb.open(tmp_path / "s.csv").survey().north == north


@pytest.mark.parametrize(
    "start", ["Teufe [m];Kaliber X [mm];Kaliber Y [mm];RB [deg]", "Profundidad (m);C1 (mm);C2 (mm);RB (deg)"]
)
def test_names_in_other_languages(tmp_path: Path, start: str) -> None:
    rows = "".join(f"{10 + at},5;220,5;210,5;{at},5\n" for at in range(9))
    (tmp_path / "w.csv").write_text(f"{start}\n{rows}")
    found = hb.open(tmp_path / "w.csv").readings()
    np.testing.assert_allclose([column[0] for column in found.radii], [0.11025, 0.11025, 0.10525, 0.10525])


@pytest.mark.parametrize("fingers", [24, 40])
def test_a_multi_finger_caliper_with_the_angle_of_its_first_finger(tmp_path: Path, fingers: int) -> None:
    """A pipe of 80 mm with a groove of 2 mm at toolface 90; the tool turns, and finger 1 is mounted at 30 degrees."""
    depth = np.arange(100.0, 103.0, 0.02)
    turn = depth * 11 % 360
    toolface = (turn[:, None] + 30 + np.arange(fingers) * 360 / fingers) % 360
    radius = 80 + 2 * (np.abs(toolface - 90) < 30)
    curves = "".join(f"FING{number:02d}.MM:\n" for number in range(1, fingers + 1))
    rows = "\n".join(" ".join(f"{cell:.3f}" for cell in row) for row in np.column_stack([depth, turn, radius]))
    (tmp_path / "m.las").write_text(f"{WELL}~C\nDEPT.M:\nROT.DEG:\n{curves}~A\n{rows}\n")
    with pytest.raises(hb.InputError, match=r"columns\.radius=FING@ANGLE"):
        hb.open(tmp_path / "m.las").readings()
    text = "caliper = 'm.las'\n[columns]\nradius = ['FING@30']\n[wall]\nbit_diameter = 0.16\nmax_distance = 0.1\n"
    (tmp_path / "well.toml").write_text(text)
    wall = hb.reconstruct(tmp_path / "well.toml")
    away = np.abs(wall.toolface - 90)
    assert wall.radius[away < 4] == pytest.approx(0.082, abs=3e-4)
    assert wall.radius[away > 60] == pytest.approx(0.08, abs=1e-9)


def test_a_repeated_name_takes_an_angle(tmp_path: Path, golden: Golden) -> None:
    rows = "".join(f"{at} 9.5 8.5 {at}\n" for at in range(100, 120))
    (tmp_path / "w.las").write_text(WELL + "~C\nDEPT.M:\nCALI.IN:\nCALI.IN:\nRB.DEG:\n~A\n" + rows)
    (tmp_path / "well.toml").write_text(
        "caliper = 'w.las'\n[columns]\ndiameter = ['CALI:1@0', 'CALI:2@90:mm']\n[wall]\nbit_diameter = '8.5in'\n"
    )
    with golden.raises():
        hb.reconstruct(tmp_path / "well.toml")


def test_settings_of_reading_in_a_project(tmp_path: Path, golden: Golden) -> None:
    rows = "".join(f"{10 + at},0 200,0 200,0 {(at * 40) % 360},0\n" for at in range(60))
    (tmp_path / "w.las").write_bytes((CYRILLIC + rows).encode("cp1251"))
    (tmp_path / "well.toml").write_text(
        "caliper = 'w.las'\n[reading]\nencoding = 'cp1251'\ndecimal = ','\n[wall]\nbit_diameter = '200mm'\n"
        "[columns]\ntoolface = 'АПС'\ndiameter = ['ДС1@0', 'ДС2@90']\n"
    )
    wall = hb.reconstruct(tmp_path / "well.toml")
    np.testing.assert_allclose(wall.radius, 0.1, atol=1e-12)
    (tmp_path / "well.toml").write_text("caliper = 'w.las'\n[reading]\nencoding = 'latin'\nbit = 1\n")
    with golden.raises():
        hb.reconstruct(tmp_path / "well.toml")
