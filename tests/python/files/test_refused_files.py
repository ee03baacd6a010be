"""What the readers refuse, one case a rule: the whole text of each error."""

from __future__ import annotations

import gzip
import io
import re
import sys
import zipfile
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from golden_texts import Golden

import helibore as hb
from helibore.files import json_log
from helibore.files.dlis import _frame
from helibore.files.input_file import InputFile
from helibore.files.log_writing import check_format

LAS2 = "~Version\nVERS. 2.0 :\nWRAP. NO :\n~Well\nSTRT.M 1 :\nSTOP.M 2 :\nSTEP.M 1 :\nNULL. -999.25 :\n"
LAS3 = LAS2.replace("2.0", "3.0").replace("WRAP. NO :\n", "WRAP. NO :\nDLM. COMMA :\n")
WRAPPED = LAS2.replace("NO", "YES") + "~Curve\nDEPT.M :\nA.M :\nB.M :\n~A\n1 2\n3\n4 5\n"
XML = '<?xml version="1.0"?>\n'
UNITS = "<mnemonicList>MD,R</mnemonicList><unitList>m</unitList><data>1,2</data>"
HIDDEN = '<?xml version="1.0"' + " " * 70_000 + 'encoding="%s"?>\n<logs/>'  # beyond what is looked at before parsing
CURVES = '[{"header": {}, "curves": [{"name": "A"%s}], "data": [[%s]]}]'


def zipped(name: str = "a.txt", content: bytes = b"x") -> bytes:
    memory = io.BytesIO()
    with zipfile.ZipFile(memory, "w") as archive:
        archive.writestr(name, content)
    return memory.getvalue()


def npz(**arrays: Any) -> bytes:
    memory = io.BytesIO()
    np.savez(memory, **arrays)
    return memory.getvalue()


def encrypted(archive: bytes) -> bytes:
    """Return an archive whose members state that they are encrypted, in the directory and before the member."""
    changed = bytearray(archive)
    for mark, flags in ((b"PK\1\2", 8), (b"PK\3\4", 6)):
        for found in re.finditer(mark, archive):
            changed[found.start() + flags] |= 1
    return bytes(changed)


def parquet(columns: dict[str, Any], damage: slice | None = None, end: int | None = None) -> bytes:
    import pyarrow as pa
    from pyarrow import parquet as files

    memory = io.BytesIO()
    files.write_table(pa.table(columns), memory, compression="gzip")
    content = bytearray(memory.getvalue())
    if damage:
        content[damage] = bytes(damage.stop - damage.start)
    return bytes(content[:end])


NUMBERS = np.random.default_rng(0).random(5000)
# "(...)" stands for the words of a library.
CASES: list[tuple[str, str | bytes, str]] = [
    ("t.csv", "md_m tf_deg r\n1 2\n3 4\n",
     ", line 1: blanks separate the columns: as many names as cells must be there, or a delimiter; a file of rules "
     "(reading.layouts) can state names and rows"),
    ("t.csv", "md_m\n1,2\n3,4\n", ", line 1: the header has one column, the rows have more: another delimiter?"),
    ("t.csv", "a" * (3 << 20), ", line 1: a line is longer than 1,048,576 bytes"),
    ("t.csv", b"a,b\n" + b"1,2\n" * 20_000 + b"1,\0\n", ", line 20002: a zero byte: not text, or damaged"),
    ("t.csv", b"a,b\0\n", ": binary, and no format that helibore reads (DLIS, LIS, Parquet, NPZ, XLSX)"),
    ("t.csv", "  \n \n", ": empty: nothing but blanks"),
    ("t.csv", "", ": empty: 0 bytes"),
    ("t.csv", b"\xff\xfea", ": is not utf-16 text throughout (...)"),
    ("t.zip", zipped(), ": a zip archive: unpack it first"),
    ("t.zip", zipped()[:40], ": truncated or damaged zip archive (...)"),
    ("t.gz", gzip.compress(zipped()), ": a gzipped zip file: unpack it first"),
    ("t.gz", gzip.compress(b"PAR1" + bytes(90)), ": a gzipped parquet file: unpack it first"),
    ("t.gz", gzip.compress(b"md_m,b\n1,2\n" * 50)[:-12] + b"\xff" * 12, ": damaged gzip stream (...)"),
    ("t.json", CURVES.replace('"name"', '"unit"') % ("", "1"), ': log: "curves" must be a list of objects with a name'),
    ("t.json", CURVES % (', "dimensions": 0.5', "[1]"),
     ", column A: dimensions = 0.5: must be a whole number of at least 1"),
    ("t.json", CURVES % (', "dimensions": 2000000', "null"),
     ", column A: dimensions = 2000000: 1 rows hold 0 values, with more than 200 empty cells for each value"),
    ("t.json", CURVES % ("", "1" + "0" * 400 + "], [null"), ", column A: holds a whole number too large for a float"),
    ("t.json", '[{"header": {},\n "curves" [}]', ", line 2: Expecting ':' delimiter (character 11)"),
    ("t.json", '{"wells": {"W": 1}}', ": well 'W': must be an object of columns"),
    ("t.las", LAS2 + "~A\n1 2\n", ": truncated or damaged: no ~Curve section"),
    ("t.las", LAS2 + "~Curve\nDEPT.M :\n", ": truncated or damaged: no ~A(scii) section"),
    ("t.las", LAS2.replace("STRT.M 1 :", "STRT {{") + "~Curve\nDEPT.M :\n~A\n1\n",
        ", line 5: the header is damaged: 'STRT {{' is no item of ~WELL"),
    ("t.las", WRAPPED, ", line 16: truncated: 5 wrapped values are not a multiple of 3 columns"),
    ("t.las", LAS3 + "~Log_Data\n1,2\n", ", line 10: ~LOG_DATA: no section ~Log_Definition defines its columns"),
    ("t.las", LAS3 + "~Curve\nDEPT.M :\n", ", line 10: truncated: no data section (~Log_Data or ~ASCII)"),
    ("t.las", LAS3 + "~Log_Definition\n~Log_Data | Log_Definition\n1,2\n",
     ", line 10: ~LOG_DEFINITION defines no column"),
    ("t.xml", XML + "<logs><x/></logs>", ": WITSML without a log or trajectory"),
    ("t.xml", XML + "<html><x/></html>",
     ": <html> is no WITSML 1.x document of logs or trajectories (<logs> or <trajectorys>)"),
    ("t.xml", XML + f"<logs><log><name>L</name><logData>{UNITS}</logData></log></logs>",
     ": log 'L': 1 units for 2 mnemonics"),
    ("t.xml", XML + "<logs><log><name>L</name></logs>", ", line 2: mismatched tag (character 27)"),
    ("t.xml", XML + "<logs><log><name>L</name>", ", line 2: truncated: no element found (character 25)"),
    ("t.xml", HIDDEN % "no-such", ": not in the encoding it declares (...)"),
    ("t.xml", HIDDEN % "UTF-7", ": not in the encoding it declares (...)"),
    ("t.npz", npz(a=np.zeros(()), b=np.zeros((2, 2, 2))), ": no array of one or two dimensions"),
    ("t.npz", npz(a=np.array([{}], dtype=object)), ": damaged archive of arrays (...)"),
    ("t.npz", encrypted(npz(a=np.zeros(3))), ": damaged archive of arrays (...)"),
    ("t.parquet", parquet({"a": np.empty(0)}), ": Parquet without rows"),
    ("t.parquet", parquet({}), ": Parquet without columns"),
    ("t.parquet", parquet({"a": NUMBERS}, end=-9), ": truncated or damaged Parquet (...)"),
    ("t.parquet", parquet({"a": NUMBERS}, damage=slice(2000, 2400)), ", column a: damaged Parquet (...)"),
    ("t.dlis", b"000001V1.00RECORD 8192" + b" " * 58 + bytes(200),
     ": DLIS: truncated or damaged (...); salvage = true reads what is before the damage"),
    ("t.xlsx", zipped("xl/workbook.xml", b"<"), ": truncated or damaged workbook (...)"),
]  # fmt: skip


@pytest.mark.parametrize(("name", "content", "text"), CASES, ids=[f"{name}{text[:50]}" for name, _, text in CASES])
def test_a_file_is_refused_with_its_place_and_the_rule(
    tmp_path: Path, name: str, content: str | bytes, text: str
) -> None:
    (tmp_path / name).write_bytes(content if isinstance(content, bytes) else content.encode())
    with pytest.raises(hb.InputError) as caught, hb.open(tmp_path / name) as file:
        _ = [channel.values for each in file.sets for channel in each]
    assert re.fullmatch(re.escape(name + text).replace(r"\(\.\.\.\)", r"\(.+\)"), str(caught.value)), str(caught.value)


@pytest.mark.parametrize(
    ("start", "text"),
    [
        (
            b"glTF",
            "a mesh (GLB) holds no samples: take the settings beside it (.glb.toml), a .wall or the caliper file",
        ),
        (b"BZh9", "bzip2: unpack it first"),
        (b"\xfd7zXZ\0", "xz: unpack it first"),
        (b"\x28\xb5\x2f\xfd", "zstandard: unpack it first"),
        (b"7z\xbc\xaf\x27\x1c", "a 7-zip archive: unpack it first"),
        (b"\x89HDF\r\n", "HDF5: not a format that helibore reads"),
        (b"\xd0\xcf\x11\xe0", "an old Excel or a Word file: save the sheet as XLSX or CSV"),
        (b"%PDF-1.7", "a PDF: not a format that helibore reads"),
    ],
)
def test_a_file_of_another_kind_is_refused_with_what_to_do(tmp_path: Path, start: bytes, text: str) -> None:
    (tmp_path / "t.csv").write_bytes(start + bytes(100))
    with pytest.raises(hb.InputError) as caught:
        hb.open(tmp_path / "t.csv")
    assert str(caught.value) == f"t.csv: {text}"


@pytest.mark.parametrize(
    ("name", "content", "library", "extra"),
    [
        ("t.las", LAS2 + "~Curve\nDEPT.M :\n~A\n1\n", "lasio", "las"),
        ("t.dlis", b"000001V1.00RECORD 8192" + bytes(200), "dlisio", "dlis"),
        ("t.lis", b"\0\x80\0\0\x80\0" + bytes(200), "dlisio", "dlis"),
        ("t.parquet", b"PAR1" + bytes(90), "pyarrow", "parquet"),
        ("t.xlsx", zipped("xl/workbook.xml"), "python_calamine", "xlsx"),
    ],
)
def test_a_format_without_its_library_names_the_extra(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, name: str, content: str | bytes, library: str, extra: str
) -> None:
    (tmp_path / name).write_bytes(content if isinstance(content, bytes) else content.encode())
    monkeypatch.setitem(sys.modules, library, None)
    with pytest.raises(hb.MissingExtraError) as caught:
        hb.open(tmp_path / name)
    assert (caught.value.library, caught.value.extra) == (library.replace("_", "-"), extra)


@pytest.mark.parametrize(("ending", "library"), [("parquet", "pyarrow"), ("dlis", "dliswriter")])
def test_a_format_to_write_without_its_library_names_the_extra(
    monkeypatch: pytest.MonkeyPatch, ending: str, library: str, golden: Golden
) -> None:
    monkeypatch.setitem(sys.modules, library, None)
    with pytest.raises(hb.MissingExtraError) as caught:
        check_format(f"well.{ending}")
    assert (caught.value.library, caught.value.extra) == (library, ending)
    with golden.raises():
        check_format("well.xls")


def test_json_that_is_too_large_and_a_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, golden: Golden) -> None:
    monkeypatch.setattr(json_log, "SIZE_LIMIT", 1 << 20)
    (tmp_path / "t.json").write_text("[" + " " * (1 << 20) + "]")
    with golden.raises():
        hb.open(tmp_path / "t.json")
    with pytest.raises(IsADirectoryError) as folder:
        hb.open(tmp_path)
    assert str(folder.value) == f"{tmp_path}: is a directory"
    (tmp_path / "t.csv").write_text("a,b\n1,2\n")
    with pytest.raises(KeyError) as missing:
        hb.open(tmp_path / "t.csv")["c"]
    assert missing.value.args == ("t.csv: no channel 'c'; it holds a, b",)


class Frame:
    """A frame of a DLIS file whose index does not fit its rows and channels."""

    index_type, direction, spacing, fingerprint = "BOREHOLE-DEPTH", None, None, "F"

    def __init__(self, channels: int, rows: int) -> None:
        self.channels = [
            type("Channel", (), {"name": "C", "dimension": [1], "units": "m", "long_name": "", "axis": []})
        ] * channels
        self.rows, self.logicalfile = rows, type("File", (), {"fdata_index": {"F": [0, 1, 2]}, "origins": []})

    def dtype(self, **_: bool) -> np.dtype[Any]:
        return np.dtype([("FRAMENO", "i4"), ("DEPT", "f8"), ("GR", "f8")])

    def fmtstr(self) -> str:
        return "ff"

    def curves(self, **_: bool) -> np.ndarray[Any, Any]:
        return np.zeros(self.rows, self.dtype())


def test_a_frame_whose_index_does_not_fit(tmp_path: Path, golden: Golden) -> None:
    (tmp_path / "t.dlis").write_bytes(b"x")
    source = InputFile(tmp_path / "t.dlis")
    with pytest.raises(hb.InputError) as caught:
        _frame(source, "MAIN", Frame(3, 3), {})
    golden(str(caught.value))
    with pytest.raises(hb.InputError) as caught:
        _ = _frame(source, "MAIN", Frame(2, 2), {})["C:2"].values
    golden(str(caught.value))


def test_an_array_of_two_dimensions_is_one_axis_and_reported(tmp_path: Path, golden: Golden) -> None:
    class Wave(Frame):
        def dtype(self, **_: bool) -> np.dtype[Any]:
            return np.dtype([("FRAMENO", "i4"), ("DEPT", "f8"), ("WAVE", "f8", (2, 3))])

        def curves(self, **_: bool) -> np.ndarray[Any, Any]:
            rows = np.zeros(self.rows, self.dtype())
            rows["WAVE"] = np.arange(18.0).reshape(3, 2, 3)
            return rows

    (tmp_path / "t.dlis").write_bytes(b"x")
    frame = Wave(2, 3)
    frame.channels = [frame.channels[0], type("Image", (frame.channels[0],), {"dimension": [2, 3]})]
    one = _frame(InputFile(tmp_path / "t.dlis"), "MAIN", frame, {})
    golden(one.remarks)
    np.testing.assert_array_equal(one["C:2"].values, np.arange(18.0).reshape(3, 6))
