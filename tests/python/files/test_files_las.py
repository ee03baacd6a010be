"""LAS 2.0 and LAS 3.0: arrays, sets, delimiters, flaws."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from golden_texts import Golden
from hypothesis import given, settings
from hypothesis import strategies as st
from refused_files import refused
from wall_samples import wall_samples

import helibore as hb
from helibore.base.nulls import NULLS

pytest.importorskip("lasio")

HEAD2 = """~Version
 VERS. 2.0 : CWLS
 WRAP. NO : one line a row
~Well
 STRT.M 1 : start
 STOP.M {stop} : stop
 STEP.M 1 : step
 NULL. -99 : null
 WELL. W-1 : name
~Curve
 DEPT.M : depth
 GR.GAPI : gamma
 CAL.IN : caliper
"""


def las2(folder: Path, rows: str, head: str = HEAD2, stop: int = 3, name: str = "w.las") -> Path:
    path = folder / name
    path.write_text(head.format(stop=stop) + "~ASCII\n" + rows)
    return path


def test_las2(tmp_path: Path) -> None:
    one = hb.open(las2(tmp_path, "1 50 8.5\n# a comment\n2 -99 -999.25\n\n3 NaN 8.75\n", name="w.csv")).set()
    assert (one.index, one.rows, one.header["WELL"], one.header["NULL"]) == ("DEPT", 3, "W-1", "-99")
    assert [(c.name, c.unit, c.description) for c in one] == [
        ("DEPT", "M", "depth"), ("GR", "GAPI", "gamma"), ("CAL", "IN", "caliper"),
    ]  # fmt: skip
    np.testing.assert_array_equal(one["GR"].values, [50, np.nan, np.nan])
    np.testing.assert_array_equal(one["CAL"].values, [8.5, np.nan, 8.75])
    assert [one[name].missing for name in one.names] == [0, 2, 1]
    assert [one.place(row) for row in range(3)] == ["line 15", "line 17", "line 19"]
    assert one.remarks == []


def test_las2_flaws_are_mended_and_reported(tmp_path: Path, golden: Golden) -> None:
    one = hb.open(las2(tmp_path, "1 50-999.25\n2 51.5-99.0\n3 1.#QNAN (null)\n", stop=9)).set()
    np.testing.assert_array_equal(one["GR"].values, [50, 51.5, np.nan])
    assert one["CAL"].missing == 3
    golden(one.remarks)


def test_las2_text_column_and_wrapped(tmp_path: Path, golden: Golden) -> None:
    one = hb.open(las2(tmp_path, "1 ab 8\n2 1,5 9\n")).set()
    assert one["GR"].values.tolist() == ["ab", "1,5"]
    with golden.raises():
        one.numbers("GR")
    wrapped = HEAD2.replace("WRAP. NO", "WRAP. YES")
    one = hb.open(las2(tmp_path, "1\n50 8.5\n2\n51\n9.5\n3\n52 9\n", wrapped)).set()
    np.testing.assert_array_equal(one["CAL"].values, [8.5, 9.5, 9.0])
    assert [one.place(row) for row in range(3)] == ["line 15", "line 17", "line 20"]
    refused(
        las2(tmp_path, "1\n50 8.5\n2\n51\n", wrapped), "line 18: truncated: 5 wrapped values are not a multiple of 3"
    )


def test_las2_sector_columns(tmp_path: Path) -> None:
    for names in ([f"GRIM[{n}]" for n in range(1, 9)], ["GRIM"] * 8, [f"GRIM{n}" for n in range(8)]):
        head = HEAD2.replace(" GR.GAPI : gamma\n", "".join(f" {name}.GAPI : sector\n" for name in names))
        one = hb.open(las2(tmp_path, "1 1 2 3 4 5 6 7 8 9\n2 1 2 3 4 5 6 7 -99 9\n", head, stop=2)).set()
        assert one["GRIM"].shape == (2, 8)
        np.testing.assert_array_equal(one["GRIM"].values[1], [1, 2, 3, 4, 5, 6, 7, np.nan])
        assert one.names == ("DEPT", "GRIM", "CAL")
        assert one["GRIM"].axis is None


@pytest.mark.parametrize(
    ("rows", "rule"),
    [
        ("", "line 14: no rows below the header"),
        ("1 2 3\n4 5\n", "line 16: truncated: 2 values where 3 columns are defined"),
        ("1 2 3\n4 5\n6 7 8\n", "line 16: 2 values where 3 columns are defined"),
        ("1 2 3 4\n", "line 15: 4 values where 3 columns are defined"),
        ("1 2 3\n4 x 5\n", "line 16, column GR = 'x': is not a number"),
        ("1 2 3\n4 1_0 5\n", "line 16, column GR = '1_0': is not a number"),
        ("1 2.5 3\n4 2,5 5\n", "line 16, column GR = '2,5': is not a number: a decimal comma?"),
    ],
)
def test_las2_bad_rows(tmp_path: Path, rows: str, rule: str) -> None:
    refused(las2(tmp_path, rows), rule)


def test_bad_headers(tmp_path: Path) -> None:
    for text, rule in (
        ("~V\nVERS. 2.0:\n", "line 1: truncated: one section"),
        ("~V\nVERS. 2.0:\n~W\nSTRT.M 1:\n", "no ~A(scii) section"),
        ("~V\nVERS. 5:\n~W\n~C\n~A\n1\n", "line 1: VERS = '5': must be 2.0 or 3.0"),
        ("~V\nVERS. x:\n~W\n~C\n~A\n1\n", "line 1: VERS = 'x': must be 2.0 or 3.0"),
        ("~V\nVERS. 2.0:\n~W\n~C\n~A\n1\n", "line 4: the ~Curve section defines no curve"),
        ("~V\nVERS. 3.0:\nDLM. DOT:\n~W\n~A\n1\n", "line 1: DLM = 'DOT': must be SPACE, COMMA or TAB"),
        ("~V\nVERS. 3.0:\n~W\n~Log_Data | Log_Definition\n1\n", "line 4: ~LOG_DATA: no section ~Log_Definition"),
        ("~V\nVERS. 3.0:\n~W\n~Curve\nDEPT.M:\n", "line 4: truncated: no data section"),
        ("~V\nVERS. 3.0:\n~W\n~Curve\nrubbish\n~A\n1\n", "line 5: 'rubbish': must read NAME.UNIT : DESCRIPTION"),
    ):
        (tmp_path / "w.las").write_text(text)
        refused(tmp_path / "w.las", rule)


def test_long_line_and_windows_text(tmp_path: Path) -> None:
    path = las2(tmp_path, "1 2 3\n")
    path.write_bytes(path.read_bytes() + b" " * (3 << 20))
    refused(path, "line 16: a line is longer than 1,048,576 bytes")
    path.write_bytes(HEAD2.replace("gamma", "\xb0 gamma").encode("latin-1") + b"~A\n1 2 3\n3 3 3\n")
    one = hb.open(path).set()
    assert one["GR"].description == "° gamma"
    assert one.remarks[0].startswith("not UTF-8 (line 12): read as Windows-1252")


def las3(image: np.ndarray, delimiter: str, step: float | None = None) -> str:
    """A LAS 3 file with an array of sectors, written after the examples of the CWLS document (pages 25 to 29)."""
    sectors = image.shape[1]
    mark = {"SPACE": " ", "COMMA": ",", "TAB": "\t"}[delimiter]
    step = 360.0 / sectors if step is None else step
    members = "".join(f" RADI[{n + 1}].MM : radius {{AF10.4;{n * step:g}deg}}\n" for n in range(sectors))
    rows = "\n".join(
        mark.join([f"{1000 + row / 4:.2f}", *(repr(float(cell)) for cell in cells), "8.5"])
        for row, cells in enumerate(image)
    )
    return (
        f"~Version\nVERS. 3.0 : LAS\nWRAP. NO :\nDLM. {delimiter} :\n~Well\nNULL. -999.25 :\nWELL. W :\n"
        f"~Log_Definition\n DEPT.M : depth {{F}}\n{members} BS.IN : bit size {{F}}\n"
        f"~Log_Data | Log_Definition\n{rows}\n"
    )


@pytest.mark.parametrize("delimiter", ["SPACE", "COMMA", "TAB"])
@pytest.mark.parametrize("sectors", [4, 36, 128])
def test_las3_arrays_come_back_identical(tmp_path: Path, delimiter: str, sectors: int) -> None:
    image = np.random.default_rng(sectors).normal(110, 3, (50, sectors))
    (tmp_path / "w.las").write_text(las3(image, delimiter))
    file = hb.open(tmp_path / "w.las")
    one = file.set()
    assert one.names == ("DEPT", "RADI", "BS")
    np.testing.assert_array_equal(one["RADI"].values, image)
    axis = one["RADI"].axis
    assert axis is not None
    assert (axis.first, axis.unit) == (0.0, "deg")
    assert axis.step == pytest.approx(360.0 / sectors, rel=1e-5)  # written with six digits
    assert one["RADI"].member_names[-1] == f"RADI[{sectors}]"
    np.testing.assert_array_equal(one["DEPT"].values, 1000 + np.arange(50) / 4)
    found = wall_samples(file)
    np.testing.assert_array_equal(found.radius.reshape(50, sectors), image * 0.001)
    expected = np.arange(sectors) * 360.0 / sectors
    np.testing.assert_allclose(found.toolface.reshape(50, sectors)[3], expected, rtol=1e-5)


def test_las3_uneven_angles_are_not_stated_as_even(tmp_path: Path, golden: Golden) -> None:
    text = las3(np.full((3, 4), 100.0), "COMMA").replace("{AF10.4;180deg}", "{AF10.4;181deg}")
    (tmp_path / "w.las").write_text(text)
    axis = hb.open(tmp_path / "w.las").set()["RADI"].axis
    assert axis is not None
    assert np.isnan(axis.step)
    with golden.raises():
        hb.open(tmp_path / "w.las").readings()


def test_las3_repeated_sections_quotes_and_empty_cells(tmp_path: Path, golden: Golden) -> None:
    text = (
        "~Version\nVERS. 3.0 :\nDLM. COMMA :\n~Well\nNULL. -999.25 :\n"
        "~Log_Definition[1]\nDEPT.M : {F}\nGR.GAPI :{F}\n~Log_Data[1] | Log_Definition[1]\n1,50\n2,\n"
        "~Inclinometry_Definition\nMD.M : {F}\nTIE.DEG : {F}\nNOTE. : {S}\n"
        "~Inclinometry_Data | Inclinometry_Definition\n"
        '0,0.5,"a, b"\n30,1.5,c\n'
        "~Log_Definition[2]\nDEPT.M : {F}\nCAL.IN : {F}\n~Log_Data[2] | Log_Definition[2]\n5,8.5\n"
    )
    (tmp_path / "w.las").write_text(text)
    file = hb.open(tmp_path / "w.las")
    assert [one.name for one in file.sets] == ["Log_Data[1]", "Inclinometry_Data", "Log_Data[2]"]
    np.testing.assert_array_equal(file.set("Log_Data[1]")["GR"].values, [50, np.nan])
    assert file.set("Inclinometry_Data")["NOTE"].values.tolist() == ["a, b", "c"]
    assert file.set("Inclinometry_Data").place(1) == "line 18"
    assert file.set("Log_Data[2]")["CAL"].values.tolist() == [8.5]
    with pytest.raises(ValueError, match="holds 3 sets"):
        file["CAL"]
    with golden.raises():
        file.set("x")


def test_curves_without_a_name_are_numbered(tmp_path: Path) -> None:
    one = hb.open(las2(tmp_path, "1 2 3\n2 3 4\n3 4 5\n", HEAD2.replace(" GR.GAPI", " .GAPI"))).set()
    assert one.names == ("DEPT", "column 2", "CAL")
    assert (one["column 2"].unit, one.remarks) == ("GAPI", ["curve 2 has no name: it is called column 2"])
    text = "~Version\nVERS. 3.0 :\n~Well\nNULL. -1 :\n~Curve\nDEPT.M :\n.IN :\n~A\n1 2\n"
    (tmp_path / "w.las").write_text(text)
    one = hb.open(tmp_path / "w.las").set()
    assert (one.names, one.remarks) == (("DEPT", "column 2"), ["curve 2 has no name: it is called column 2"])


def test_rows_cut_by_commas_that_no_header_states(tmp_path: Path) -> None:
    said = "the rows are cut by commas, not by blanks as the header says"
    one = hb.open(las2(tmp_path, "1,50, 8.5\n2,,-999.25\n3,52,9\n")).set()
    np.testing.assert_array_equal(one["GR"].values, [50, np.nan, 52])
    np.testing.assert_array_equal(one["CAL"].values, [8.5, np.nan, 9])
    assert one.remarks == [said]
    text = las3(np.full((3, 4), 100.0), "COMMA").replace("DLM. COMMA :\n", "")
    (tmp_path / "w.las").write_text(text)
    one = hb.open(tmp_path / "w.las").set()
    assert (one["RADI"].values.tolist(), one.remarks) == ([[100.0] * 4] * 3, [said])
    refused(las2(tmp_path, "1,2,3\n4,5\n"), "w.las, line 16: truncated: 2 values where 3 columns are defined")


def test_the_depths_of_the_header_are_compared_in_the_unit_of_the_rows(tmp_path: Path) -> None:
    rows = "1 2 3\n2 3 4\n3 4 5\n"
    for unit in ("0.1IN", "0.1 in", ".1IN"):
        head = HEAD2.replace("STRT.M 1 ", f"STRT.{unit} 393.7008 ").replace("STOP.M {stop}", f"STOP.{unit} 1181.102")
        assert hb.open(las2(tmp_path, rows, head)).set().remarks == []
        said = "STOP = 393.701 in the header, 3 in the rows: truncated or edited?"
        assert hb.open(las2(tmp_path, rows, head.replace("1181.102", "393.701"))).set().remarks == [said]
    tenths = HEAD2.replace("DEPT.M", "DEPT.0.1 in").replace("STRT.M", "STRT.0.1IN").replace("STOP.M", "STOP.0.1IN")
    one = hb.open(las2(tmp_path, rows, tenths)).set()
    assert (one["DEPT"].unit, one.remarks) == ("0.1 in", [])
    strange = HEAD2.replace("STRT.M", "STRT.FURLONG")
    said = "STRT is in FURLONG, the index DEPT in M"
    assert hb.open(las2(tmp_path, rows, strange)).set().remarks == [said]


SETS = """~Version
VERS. 3.0 :
DLM. COMMA :
~Well
NULL. -999.25 :
~Tops_Definition
TOPN. : name {S}
TOPT.M : top {F}
~Tops_Data | Tops_Definition
10,1500
Upper, 1600
"Lower, x", 1700
~Log_Definition
DEPT.M :
GR.GAPI :
~Log_Data | Log_Definition
~Inclinometry_Definition
MD.M :
INC.DEG :
~Inclinometry_Data | Inclinometry_Definition
1,2
2
"""


def test_a_damaged_or_empty_set_does_not_block_the_others(tmp_path: Path, golden: Golden) -> None:
    (tmp_path / "w.las").write_text(SETS)
    one = hb.open(tmp_path / "w.las").set()
    assert one.name == "Tops_Data"
    assert one["TOPN"].values.tolist() == ["10", "Upper", "Lower, x"]
    assert one["TOPT"].values.tolist() == [1500, 1600, 1700]
    damage = "w.las, line 22: truncated: 1 values where 2 columns are defined"
    damage += "; salvage = true reads what is before the damage"
    empty = "w.las, line 16: no rows below the header"
    assert one.remarks == [f"another set is left out: {empty}", f"another set is left out: {damage}"]
    (tmp_path / "w.las").write_text(SETS.replace("10,1500\n", "1\n"))
    with golden.raises():
        hb.open(tmp_path / "w.las")


@settings(max_examples=60, deadline=None)
@given(
    cells=st.lists(st.lists(st.floats(-1e9, 1e9), min_size=3, max_size=3), min_size=1, max_size=8),
    delimiter=st.sampled_from([" ", "   "]),
)
def test_las2_returns_what_was_written(
    tmp_path_factory: pytest.TempPathFactory, cells: list[list[float]], delimiter: str
) -> None:
    rows = "\n".join(delimiter.join(map(repr, row)) for row in cells) + "\n"
    one = hb.open(las2(tmp_path_factory.mktemp("l"), rows)).set()
    for position, name in enumerate(("DEPT", "GR", "CAL")):
        expected = [np.nan if row[position] in (-99, *NULLS) else row[position] for row in cells]
        np.testing.assert_array_equal(one[name].values, expected)


def test_an_old_version_and_a_section_after_the_rows_are_reported(tmp_path: Path) -> None:
    rows = "1 2 3\n2 3 4\n3 4 5\n"
    one = hb.open(las2(tmp_path, rows, HEAD2.replace("2.0", "1.2"))).set()
    assert "LAS 1.2: read as LAS 2.0; value and description are swapped in its ~Well section" in one.remarks
    one = hb.open(las2(tmp_path, rows + "~Other\n4 5 6\n")).set()
    assert (one.rows, one.remarks) == (3, ["line 18: ~OTHER follows the data section; its lines are not rows"])


def test_only_data_sections_of_las_3_are_sets(tmp_path: Path) -> None:
    path = tmp_path / "w.las"
    path.write_text(
        "~Version\nVERS. 3.0 :\nWRAP. NO :\nDLM. COMMA :\n~Well\nNULL. -999.25 :\n~Analysis_Parameter\nA. 1 : x\n"
        "~Analysis_Definition\nDEPT.M : {F}\nSW.V/V : {F}\n~Analysis_Data | Analysis_Definition\n1,0.5\n"
        "~Curve\nDEPT.M : {F}\nGR.GAPI : {F}\n~ASCII | Curve\n1,50\n"
    )
    file = hb.open(path)
    assert [(one.name, one.names, one.remarks) for one in file.sets] == [
        ("Analysis_Data", ("DEPT", "SW"), []), ("Ascii", ("DEPT", "GR"), []),
    ]  # fmt: skip


def test_very_many_curves_of_a_header_are_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("HELIBORE_LIMIT_COLUMNS", "50")
    for count, good in ((50, True), (51, False)):
        path = tmp_path / f"{count}.las"
        names = "".join(f"C{n}.M :\n" for n in range(count))
        rows = " ".join("1" for _ in range(count))
        path.write_text(f"~V\nVERS. 2.0:\nWRAP. NO:\n~W\nNULL. -999.25:\n~C\n{names}~A\n{rows}\n")
        if good:
            assert hb.open(path).set().names == ("C0", "C")  # C1 to C49 are one image
        else:
            with pytest.raises(hb.InputError, match="HELIBORE_LIMIT_COLUMNS") as refused:
                hb.open(path)
            assert refused.value.place == "51.las, line 6: ~C"


def test_ten_thousand_curves_of_one_name(tmp_path: Path) -> None:
    """The time that lasio's reader of files takes grows with the cube of their number: hours for these."""
    path = tmp_path / "x.las"
    rows = " ".join(str(number) for number in range(10_000))
    path.write_text("~V\nVERS. 2.0:\nWRAP. NO:\n~W\nNULL. -999.25:\n~C\n" + "GR.API:\n" * 10_000 + f"~A\n{rows}\n")
    assert hb.open(path).set()["GR:1235"].values.tolist() == [1234]


def test_a_curve_numbered_in_its_name_keeps_its_unit(tmp_path: Path) -> None:
    """So are the names of repeated curves written; lasio takes their colon for the end of the unit."""
    path = tmp_path / "x.las"
    path.write_text("~V\nVERS. 2.0:\nWRAP. NO:\n~W\nNULL. -999.25:\n~C\nDEPT.M:\nP1AZ:1.DEG : Pad 1\n~A\n1 20\n2 30\n")
    curve = hb.open(path).set()["P1AZ:1"]
    assert (curve.unit, curve.description) == ("DEG", "Pad 1")
