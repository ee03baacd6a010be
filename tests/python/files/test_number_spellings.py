"""Numbers as people and programs spell them, in tables and LAS files."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from golden_texts import Golden
from hypothesis import given, settings
from hypothesis import strategies as st

import helibore as hb

NUMBERS = st.lists(
    st.tuples(*[st.integers(-(10**8), 10**8).map(lambda thousandths: thousandths / 1e3)] * 2),
    min_size=2, max_size=30,
)  # fmt: skip


def german(value: float, thousands: str = "") -> str:
    return f"{value:,.3f}".replace(",", "t").replace(".", ",").replace("t", thousands)


def opened(tmp_path: Path, text: str | bytes, name: str = "t.csv", **options: str) -> tuple[list[list[float]], str]:
    path = tmp_path / name
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    one = hb.open(path, **options).set()  # type: ignore[arg-type]
    return [one.numbers(name).tolist() for name in one.names], " | ".join(one.remarks)


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16", "cp1252"])
@pytest.mark.parametrize(("mark", "thousands"), [(";", ""), ("\t", ""), (";", "."), ("\t", "\u00a0"), ("|", " ")])
@settings(max_examples=10)
@given(rows=NUMBERS)
def test_decimal_commas_read_as_written(
    tmp_path_factory: pytest.TempPathFactory, encoding: str, mark: str, thousands: str, rows: list[tuple[float, float]]
) -> None:
    rows = [*rows, (0.25, 0.0)]
    lines = [f"Teufe (m){mark}r", *(mark.join(german(value, thousands) for value in row) for row in rows)]
    table = "\r\n".join(lines) + "\r\n"
    columns, remarks = opened(tmp_path_factory.mktemp("t"), table.encode(encoding))
    np.testing.assert_array_equal(columns, np.transpose(rows))
    assert "decimal commas in Teufe (m), r: " in remarks
    assert "a guess" not in remarks


@given(rows=NUMBERS)
def test_quoted_thousands_read_as_written(
    tmp_path_factory: pytest.TempPathFactory, rows: list[tuple[float, float]]
) -> None:
    lines = ["depth (m),r", *(f'"{row[0]:,.2f}","{row[1]:,.2f}"' for row in [*rows, (1234.5, 2345.25)])]
    columns, remarks = opened(tmp_path_factory.mktemp("t"), "\n".join(lines))
    expected = np.transpose([[float(f"{value:.2f}") for value in row] for row in [*rows, (1234.5, 2345.25)]])
    np.testing.assert_array_equal(columns, expected)
    assert "marks of thousands" in remarks


def test_what_fits_both_readings_is_a_guess_that_can_be_stated(tmp_path: Path) -> None:
    cut_by_semicolons = "md;r\n228,363;100,500\n229,000;100,000\n"
    columns, remarks = opened(tmp_path, cut_by_semicolons)
    assert columns == [[228.363, 229.0], [100.5, 100.0]]
    assert "228,363 is read as 228.363, a guess" in remarks
    assert "decimal = '.' reads it otherwise" in remarks
    assert opened(tmp_path, cut_by_semicolons, decimal=".")[0] == [[228363.0, 229000.0], [100500.0, 100000.0]]
    columns, remarks = opened(tmp_path, 'md,r\n"228,363","100,500"\n"229,000","100,000"\n')
    assert columns == [[228363.0, 229000.0], [100500.0, 100000.0]]
    assert "a guess" in remarks


def test_two_decimal_marks_in_one_table_are_refused(tmp_path: Path, golden: Golden) -> None:
    with golden.raises():
        opened(tmp_path, "md;r\n1,5;2.5\n")
    with pytest.raises(hb.InputError, match=r"^decimal = ';': must be . or ,$"):
        opened(tmp_path, "md;r\n1,5;2.5\n", decimal=";")
    with golden.raises():
        opened(tmp_path, "md;r\n1,5;2.5\n", encoding="runes")


def test_empty_cells_stay_missing(tmp_path: Path) -> None:
    columns, _ = opened(tmp_path, "md;r\n1,25;\n2,5;0,75\n;\n")
    np.testing.assert_array_equal(columns, [[1.25, 2.5, np.nan], [np.nan, 0.75, np.nan]])


def test_angles_of_surveys(tmp_path: Path) -> None:
    columns, remarks = opened(tmp_path, "md_m,inc,azi\n0,5°30',N 45.5 E\n1,10°00'36″,S 44 E\n2,0°0',s10w\n3,1°,N 0 W\n")
    np.testing.assert_allclose(columns[1], [5.5, 10.01, 0.0, 1.0], rtol=0, atol=1e-12)
    np.testing.assert_array_equal(columns[2], [45.5, 136.0, 190.0, 0.0])
    assert remarks.count("are read as degrees") == 2
    survey = hb.open(tmp_path / "t.csv").survey()
    assert survey.azimuth.tolist() == [45.5, 136.0, 190.0, 0.0]


def test_a_stated_delimiter_and_columns_between_blanks(tmp_path: Path) -> None:
    assert opened(tmp_path, "sep=;\na;b\n1,5;2\n2,25;3\n")[0] == [[1.5, 2.25], [2.0, 3.0]]
    assert opened(tmp_path, "# T\n  MD   AZIM TN\n#=====\n 1.5   2\n 2   3\n")[0] == [[1.5, 2.0], [2.0, 3.0]]
    assert opened(tmp_path, "MD (m) INC (deg)\n1.5 2\n2 3\n")[0] == [[1.5, 2.0], [2.0, 3.0]]


def test_a_stated_encoding(tmp_path: Path, golden: Golden) -> None:
    table = "глубина,r\n1,2\n"
    path = tmp_path / "t.csv"
    path.write_bytes(table.encode("cp1251"))
    assert hb.open(path, encoding="cp1251").set().names == ("глубина", "r")
    with golden.raises():
        hb.open(path, encoding="ascii")


HEADER = "~V\nVERS. 2.0:\nWRAP. NO:\n~W\nSTRT.M 1:\nSTOP.M 2:\nNULL. ****:\n"
CURVES = "~C\nDEPT.M:\nC1.IN:\nC2.IN:\n"


@pytest.mark.parametrize(
    ("text", "remark"),
    [
        (HEADER + CURVES + "~A\n1 8.5 8.25\n2 8.75 ****\n\x1a", ""),
        (HEADER + CURVES + "~A\n1,0 8,5 8,25\n2,0 8,75 ****\n", "decimal commas in DEPT"),
        (HEADER + CURVES + "~A\nDEPT C1 C2\nM IN IN\n1 8.5 8.25\n2 8.75 ****\n", "repeats the header"),
        (HEADER + "~A DEPT C1 C2\n1 8.5 8.25\n2 8.75 ****\n", "no ~Curve section"),
        (HEADER.partition("~W")[2].join(["~W", CURVES]) + "~A\n1 8.5 8.25\n2 8.75 ****\n", "no ~Version section"),
        (HEADER + CURVES + "~A\n1\n8.5 8.25\n2\n8.75 ****\n", "rows run over several lines"),
    ],
    ids=["control-z", "decimal-commas", "names-below", "no-curves", "no-version", "wrapped"],
)
def test_las_files_that_bend_the_rules(tmp_path: Path, text: str, remark: str) -> None:
    columns, remarks = opened(tmp_path, text, "w.las")
    np.testing.assert_array_equal(columns, [[1, 2], [8.5, 8.75], [8.25, np.nan]])
    assert remark in remarks


def test_feet_under_a_header_in_metres_are_named(tmp_path: Path) -> None:
    rows = "".join(f"{depth / 0.3048:.4f} 8.5 8.25\n" for depth in (1.0, 1.5, 2.0))
    assert (
        "3.2808 times STRT and STOP: DEPT is in feet" in opened(tmp_path, HEADER + CURVES + "~A\n" + rows, "w.las")[1]
    )


def test_stations_are_sorted_and_repeats_left_out(tmp_path: Path, golden: Golden) -> None:
    path = tmp_path / "s.csv"
    path.write_text("MD (m),INC (deg),AZI (deg)\n1500,10,45\n0,0,0\n1000,5,10\n1000,5,10\n")
    one = hb.open(path).set()
    survey = one.survey()
    assert (survey.depth.tolist(), survey.azimuth.tolist()) == ([0, 1000, 1500], [0, 10, 45])
    assert {"survey: the stations are sorted by depth", "survey: 1 repeated stations left out"} <= set(one.remarks)
    path.write_text("MD (m),INC (deg),AZI (deg)\n0,0,0\n1000,5,10\n1000,5,11\n")
    with golden.raises():
        hb.open(path).survey()
