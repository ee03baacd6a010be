"""XLSX workbooks, written here as the smallest packages that the format allows, and bad ones."""

from __future__ import annotations

import zipfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any
from xml.sax.saxutils import escape

import numpy as np
import pytest
from golden_texts import Golden

import helibore as hb
from helibore.files import spreadsheet
from helibore.files.input_file import zip_pieces

pytest.importorskip("python_calamine")

MAIN = "http://schemas.openxmlformats.org/spreadsheetml/2006/main"
OFFICE = "http://schemas.openxmlformats.org/officeDocument/2006/relationships"
PACKAGE = "http://schemas.openxmlformats.org/package/2006"


def sheet(rows: list[list[Any]]) -> str:
    lines = []
    for number, row in enumerate(rows, 1):
        cells = []
        for column, value in enumerate(row):
            at = f'r="{chr(65 + column)}{number}"'
            if isinstance(value, str) and value:
                cells.append(f'<c {at} t="inlineStr"><is><t>{escape(value)}</t></is></c>')
            elif value is not None and value != "":
                cells.append(f"<c {at}><v>{value!r}</v></c>")
        lines.append(f'<row r="{number}">{"".join(cells)}</row>')
    return f'<worksheet xmlns="{MAIN}"><sheetData>{"".join(lines)}</sheetData></worksheet>'


def workbook(path: Path, **sheets: list[list[Any]]) -> Path:
    types = f"{PACKAGE}/content-types"
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as book:
        book.writestr("[Content_Types].xml", f'<Types xmlns="{types}"/>')
        root = f'<Relationship Id="r1" Type="{OFFICE}/officeDocument" Target="xl/workbook.xml"/>'
        book.writestr("_rels/.rels", f'<Relationships xmlns="{PACKAGE}/relationships">{root}</Relationships>')
        names = enumerate(sheets, 1)
        entries = "".join(f'<sheet name="{name}" sheetId="{n}" r:id="r{n}"/>' for n, name in names)
        book.writestr(
            "xl/workbook.xml", f'<workbook xmlns="{MAIN}" xmlns:r="{OFFICE}"><sheets>{entries}</sheets></workbook>'
        )
        links = "".join(
            f'<Relationship Id="r{n}" Type="{OFFICE}/worksheet" Target="worksheets/sheet{n}.xml"/>'
            for n in range(1, len(sheets) + 1)
        )
        book.writestr(
            "xl/_rels/workbook.xml.rels", f'<Relationships xmlns="{PACKAGE}/relationships">{links}</Relationships>'
        )
        for number, rows in enumerate(sheets.values(), 1):
            book.writestr(f"xl/worksheets/sheet{number}.xml", sheet(rows))
    return path


STATIONS = [[0, 0.0, 0.0], [100.5, 1.25, 31.0], [200.0, 2.5, 31.5]]
SURVEY = [["Well", "15/9-F-12"], [], ["MD (m)", "Incl (deg)", "Azim (deg)"], *STATIONS]


def test_rows_below_an_empty_line_are_refused_with_strict(tmp_path: Path) -> None:
    file = workbook(tmp_path / "s.xlsx", Survey=[*SURVEY, [], ["checked by", "A. B."]])
    assert hb.open(file).set().rows == 3
    with pytest.raises(hb.InputError, match="only a part can be read: sheet Survey: line 7 is empty"):
        hb.open(file, strict=True)


def test_a_survey_below_other_lines(tmp_path: Path) -> None:
    file = hb.open(workbook(tmp_path / "s.xlsx", Survey=SURVEY))
    survey = file.survey()
    assert (file.format, file.set().name) == ("xlsx", "Survey")
    np.testing.assert_array_equal(np.column_stack([survey.depth, survey.inclination, survey.azimuth]), STATIONS)
    assert file.set().place(1) == "line 5"


def test_units_row_empty_cells_text_and_a_note_below(tmp_path: Path, golden: Golden) -> None:
    rows = [["MD", "INC", "AZI", "Tool"], ["ft", "deg", "deg", ""], [100, 1.5, 20, "MWD"], [200, "", 21, ""]]
    one = hb.open(workbook(tmp_path / "s.xlsx", S=[*rows, [], ["Surveyed by X"]])).set()
    assert [(c.name, c.unit) for c in one] == [("MD", "ft"), ("INC", "deg"), ("AZI", "deg"), ("Tool", "")]
    np.testing.assert_array_equal(one["INC"].values, [1.5, np.nan])
    assert (one["INC"].missing, one["Tool"].values.tolist()) == (1, ["MWD", ""])
    golden(one.remarks)


def test_a_sheet_that_is_no_table_does_not_block_the_others(tmp_path: Path) -> None:
    file = hb.open(workbook(tmp_path / "s.xlsx", Notes=[["hello"], ["world"]], Survey=SURVEY))
    assert [one.name for one in file.sets] == ["Survey"]
    rule = "no row of column names with numbers below it within 500 rows"
    assert file.set().remarks == [f"another set is left out: s.xlsx, sheet Notes: {rule}"]
    with pytest.raises(ValueError, match=rf"^s.xlsx, sheet Notes: {rule}$"):
        hb.open(workbook(tmp_path / "s.xlsx", Notes=[["hello"], ["world"]]))


def test_the_header_line_may_be_given(tmp_path: Path, golden: Golden) -> None:
    rows = [["a", "b"], [1, 2], ["MD (m)", "Incl (deg)", "Azim (deg)"], *STATIONS]
    path = workbook(tmp_path / "s.xlsx", S=rows)
    assert hb.open(path).set().names == ("a", "b")
    assert hb.open(path, header_line=3).survey().depth.tolist() == [0.0, 100.5, 200.0]
    for line in (0, 99):
        with pytest.raises(hb.InputError, match=rf"^s.xlsx: sheet S: header_line = {line}: the row holds no names$"):
            hb.open(path, header_line=line)
    with golden.raises():
        hb.open(path, header_line=6)


def test_a_word_among_numbers_is_named_with_its_row(tmp_path: Path, golden: Golden) -> None:
    one = hb.open(workbook(tmp_path / "s.xlsx", S=[*SURVEY, [300.0, "n.a.", 30.0]])).set()
    with golden.raises():
        one.survey()


def test_a_number_too_large_for_a_float_is_missing(tmp_path: Path) -> None:
    book = workbook(tmp_path / "w.xlsx", S=[["MD (m)", "Incl (deg)"], [1, 2], [2.5, 1e308]])
    with zipfile.ZipFile(book) as old:
        members = {name: old.read(name).replace(b"1e+308", b"1E999") for name in old.namelist()}
    with zipfile.ZipFile(book, "w") as new:
        for name, content in members.items():
            new.writestr(name, content)
    one = hb.open(book).set()
    assert one["MD (m)"].values.tolist() == [1, 2.5]
    assert (one["Incl (deg)"].missing, one["Incl (deg)"].odd_row) == (1, 1)


def test_damaged_packages_are_refused(tmp_path: Path, golden: Golden) -> None:
    path = workbook(tmp_path / "s.xlsx", S=SURVEY)
    whole = path.read_bytes()
    path.write_bytes(whole[: len(whole) // 2])
    with golden.raises():
        hb.open(path)
    with zipfile.ZipFile(path, "w") as book:
        book.writestr("xl/workbook.xml", "<workbook")
    with golden.raises():
        hb.open(path)
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as book:
        book.writestr("xl/workbook.xml", b" " * (40 << 20))
    with golden.raises():
        hb.open(path)


def test_a_bomb_is_refused_before_the_rest_of_it_is_unpacked(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """No tag divides the text, so nothing of it could be searched before its end."""
    path, read = tmp_path / "s.xlsx", []

    def pieces(*given: Any) -> Iterator[bytes]:
        for piece in zip_pieces(*given):
            read.append(len(piece))
            yield piece

    monkeypatch.setattr(spreadsheet, "zip_pieces", pieces)
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as book:
        book.writestr("xl/workbook.xml", b" " * (40 << 20))
    with pytest.raises(hb.InputError, match="refused as a bomb"):
        hb.open(path)
    assert sum(read) <= (33 << 20)


@pytest.mark.parametrize("part", [b'<c t="s" ', b' t="s"', b"<row ", b' r="', b" t='s'> "])
def test_tags_that_never_end_are_searched_once(tmp_path: Path, part: bytes) -> None:
    """If each start were searched to the end of the text, this would take minutes."""
    path = tmp_path / "s.xlsx"
    with zipfile.ZipFile(path, "w") as book:
        book.writestr("xl/workbook.xml", b"<c" + part * (2_000_000 // len(part)))
    with pytest.raises(hb.InputError, match="truncated or damaged workbook"):
        hb.open(path)


def replaced(path: Path, old: bytes, new: bytes) -> Path:
    """Replace bytes in the parts of a workbook."""
    with zipfile.ZipFile(path) as book:
        members = {name: book.read(name).replace(old, new) for name in book.namelist()}
    with zipfile.ZipFile(path, "w") as book:
        for name, content in members.items():
            book.writestr(name, content)
    return path


@pytest.mark.parametrize("cell", [b'r="XFD1048576"', b"r = 'xfd1048576'", b'\n r="XFD1048576"'])
def test_a_sheet_that_reaches_too_far_is_refused_before_it_is_read(tmp_path: Path, cell: bytes) -> None:
    """Calamine would ask for 550 GB, and end this process."""
    path = replaced(workbook(tmp_path / "s.xlsx", S=SURVEY), b'r="C6"', cell)
    with pytest.raises(hb.InputError, match="cells") as refused:
        hb.open(path)
    assert refused.value.place == "s.xlsx, xl/worksheets/sheet1.xml"
    assert "HELIBORE_LIMIT_CELLS" in refused.value.rule


def test_cells_of_all_sheets_count_and_the_limit_can_be_raised(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = workbook(tmp_path / "s.xlsx", A=SURVEY, B=SURVEY)  # 18 cells each
    for cells, sheets, good in ((36, 2, True), (35, 2, False), (17, 2, False), (36, 1, False)):
        monkeypatch.setenv("HELIBORE_LIMIT_CELLS", str(cells))
        monkeypatch.setenv("HELIBORE_LIMIT_SHEETS", str(sheets))
        if good:
            assert len(hb.open(path).sets) == 2
        else:
            with pytest.raises(hb.InputError, match=r"HELIBORE_LIMIT_(CELLS|SHEETS)"):
                hb.open(path)
    monkeypatch.setenv("HELIBORE_LIMIT_CELLS", "many")
    with pytest.raises(hb.InputError) as refused:
        hb.open(path)
    assert (refused.value.place, refused.value.value) == ("HELIBORE_LIMIT_CELLS", "'many'")


def test_a_missing_library_is_named_with_its_extra(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, golden: Golden
) -> None:
    import sys

    path = workbook(tmp_path / "s.xlsx", S=SURVEY)
    monkeypatch.setitem(sys.modules, "python_calamine", None)
    with golden.raises(kind=hb.MissingExtraError):
        hb.open(path)


def test_damage_is_read_or_refused(tmp_path: Path) -> None:
    from test_files_fuzz import damaged, opened_or_refused

    whole = workbook(tmp_path / "s.xlsx", Survey=SURVEY, Other=[["a", "b"], ["m", "in"], [1, 2], [3, "x"]]).read_bytes()
    spoiled = tmp_path / "spoiled"
    opened = 0
    for seed in range(300):
        spoiled.write_bytes(damaged(whole, seed))
        opened += opened_or_refused(spoiled)
    assert opened > 0


@pytest.mark.parametrize(
    "rows",
    [
        [["Survey of A-7"], ["Measured", "Hole", "Hole"], ["Depth", "Deviation", "Azimuth"], ["m", "deg", "deg"]],
        [["Measured", "Hole", "Hole"], ["Depth (m)", "Deviation (deg)", "Azimuth (deg)"]],
        [["MD", "INC", "AZI"], ["m", "deg", "deg"], ["Measured depth", "Inclination", "Azimuth"]],
        [["Well", "A-7", ""], ["MD", "INC", "AZI"], ["m", "deg", "deg"]],
    ],
)
def test_heads_of_several_rows_and_a_footer(tmp_path: Path, rows: list[list[Any]]) -> None:
    numbers = [[0.0, 0.0, 0.0], [100.5, 5.25, 45.5], ["Average", 2.625, 22.75]]
    opened = hb.open(workbook(tmp_path / "s.xlsx", S=[*rows, *numbers]))
    survey = opened.survey()
    np.testing.assert_array_equal(survey.depth, [0, 100.5])
    np.testing.assert_array_equal(survey.inclination, [0, 5.25])
    np.testing.assert_array_equal(survey.azimuth, [0, 45.5])
    assert any("is no row: Average" in remark for remark in opened.set().remarks)


def test_the_upper_line_of_a_name_counts(tmp_path: Path) -> None:
    """Read by its lower line alone, the vertical depth would be the measured one."""
    head = [["Vertical", "Hole", "Hole"], ["Depth", "Deviation", "Azimuth"], ["m", "deg", "deg"]]
    opened = hb.open(workbook(tmp_path / "s.xlsx", S=[*head, [0.0, 0.0, 0.0], [99.5, 5.25, 45.5]]))
    assert opened.set().names[0] == "Vertical Depth"
    with pytest.raises(hb.InputError, match="no channel has the role depth"):
        opened.survey()


def test_texts_of_another_locale_in_a_sheet(tmp_path: Path) -> None:
    rows = [["MD (m)", "INC (deg)"], ["1.000,5", "0,5"], ["1.100,5", "12,25"]]
    one = hb.open(workbook(tmp_path / "s.xlsx", S=rows), decimal=",").set()
    assert one.numbers("MD (m)").tolist() == [1000.5, 1100.5]
    assert one.numbers("INC (deg)").tolist() == [0.5, 12.25]
