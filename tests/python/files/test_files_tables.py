"""Delimited tables, Parquet and NPZ."""

from __future__ import annotations

import gzip
import re
import threading
import zipfile
from pathlib import Path

import numpy as np
import pytest
from golden_texts import Golden
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp
from refused_files import refused

import helibore as hb
from helibore.base.nulls import NULLS
from helibore.files.input_file import Gunzip
from helibore.files.raw_set import SectorAxis

pa = pytest.importorskip("pyarrow")
from pyarrow import parquet  # noqa: E402


def write(folder: Path, text: str | bytes, name: str = "t.csv") -> Path:
    path = folder / name
    path.write_bytes(text.encode() if isinstance(text, str) else text)
    return path


@pytest.mark.parametrize("mark", [",", "\t", ";", "|"])
def test_delimiters(tmp_path: Path, mark: str) -> None:
    path = write(tmp_path, f"md_m{mark}tf_deg\n1.5{mark}10\n2.5{mark}20\n", "any.name")
    file = hb.open(path)
    assert [(channel.name, channel.unit) for channel in file] == [("md_m", "m"), ("tf_deg", "deg")]
    np.testing.assert_array_equal(file["md_m"].values, [1.5, 2.5])


def test_header_units_comments_nulls(tmp_path: Path) -> None:
    path = write(
        tmp_path,
        "# run 2\n\nDepth [ft],RB (deg),cal_in,radius_min,note\n1,2,-999.25,5,a\n\n2,,NaN,-9999,\n3,inf,8.5,1,b\n",
    )
    one = hb.open(path).set()
    assert [channel.unit for channel in one] == ["ft", "deg", "in", "", ""]
    assert one.remarks == ["comment: run 2"]
    assert [channel.missing for channel in one] == [0, 2, 2, 1, 1]
    assert one["note"].values.tolist() == ["a", "", "b"]
    assert [one.place(row) for row in range(3)] == ["line 4", "line 6", "line 7"]


def test_units_row_and_savetxt_header(tmp_path: Path, golden: Golden) -> None:
    one = hb.open(write(tmp_path, "MD,TF,R\nm,(deg),mm\n1,2,3\n")).set()
    assert [channel.unit for channel in one] == ["m", "deg", "mm"]
    assert one.rows == 1
    one = hb.open(write(tmp_path, "# md_m,tf_deg\n1,2\n3,4\n")).set()
    assert one.names == ("md_m", "tf_deg")
    golden(one.remarks)
    one = hb.open(write(tmp_path, "1,2\n3,4\n")).set()
    assert one.names == ("column 1", "column 2")
    assert one["column 2"].values.tolist() == [2.0, 4.0]
    assert "no header" in one.remarks[0]


def test_columns_without_names_are_no_image_and_the_errors_say_why_they_have_no_role(tmp_path: Path) -> None:
    rows = "".join(f"{k},{2000 + k},{9 * k},0.11\n" for k in range(40))
    one = hb.open(write(tmp_path, rows)).set()
    assert one.names == ("column 1", "column 2", "column 3", "column 4")
    said = "; line 1: numbers, so there is no header: columns are named by their number"
    with pytest.raises(ValueError, match=f"the channels are column 1, column 2, column 3, column 4{said}$"):
        one.readings()
    with pytest.raises(ValueError, match=f"no channel has the role depth: .*{said}$"):
        one.survey()


def test_columns_with_a_blank_name_are_numbered(tmp_path: Path) -> None:
    one = hb.open(write(tmp_path, "md_m,,r_mm\n1,2,3\n4,5,6\n")).set()
    assert (one.names, one.remarks) == (("md_m", "column 2", "r_mm"), [])
    assert one["column 2"].values.tolist() == [2, 5]
    one = hb.open(write(tmp_path, "md_m,r_mm,\n1,2,\n4,5,\n")).set()
    said = "the header and the rows end in a delimiter: the last column has no name"
    assert (one.names, one.remarks) == (("md_m", "r_mm", "column 3"), [said])
    assert one["r_mm"].values.tolist() == [2, 5]


def test_repeated_names_keep_their_unit_and_are_reported(tmp_path: Path) -> None:
    rows = "".join(f"{2000 + k},{9 * k},0.11,0.12\n" for k in range(40))
    one = hb.open(write(tmp_path, "depth_m,tf_deg,radius_m,radius_m\n" + rows)).set()
    assert [(channel.name, channel.unit) for channel in one][2:] == [("radius_m:1", "m"), ("radius_m:2", "m")]
    said = "2 columns are named radius_m: they are called radius_m:1, radius_m:2 ..."
    assert one.remarks == [said]
    with pytest.raises(ValueError, match=f"; {said}$"):
        one.readings()


def test_walls_and_meshes_are_sent_to_where_they_are_read(tmp_path: Path) -> None:
    k = np.arange(400.0)
    wall = hb.reconstruct(hb.Caliper(2000 + k / 1000, k * 37, np.full(400, 0.11)), bit_diameter=0.216, sectors=16)
    wall.save(tmp_path / "well.wall")
    wall.surface().save(tmp_path / "well.glb")
    refused(
        tmp_path / "well.wall",
        "a saved wall: helibore plot, report, logs, mesh and view read it, and hb.load in Python",
    )
    refused(tmp_path / "well.glb", "a mesh (GLB) holds no samples: take the settings beside it")


def test_the_header_line_may_be_given(tmp_path: Path, golden: Golden) -> None:
    path = write(tmp_path, "run,7\nby,me\n1,2\n\n2016,2017\nm,in\n3,4\n5,\n")
    one = hb.open(path, header_line=5).set()
    assert [(channel.name, channel.unit) for channel in one] == [("2016", "m"), ("2017", "in")]
    np.testing.assert_array_equal(one["2017"].values, [4, np.nan])
    assert one.place(1) == "line 8"
    rule = "must be the line of the column names, within the first 500"
    for line in (0, 4, 9, 501):
        with pytest.raises(hb.InputError, match=rf"^t.csv: header_line = {line}: {rule}$"):
            hb.open(path, header_line=line)
    with golden.raises():
        hb.open(path, header_line=8)
    (tmp_path / "t.json").write_text("[]")
    with golden.raises():
        hb.open(tmp_path / "t.json", header_line=2)


def test_missing_first_cells_are_no_units_row(tmp_path: Path) -> None:
    one = hb.open(write(tmp_path, "a,b\n-,-\n1,2\n")).set()
    assert one["a"].missing == 1
    assert one.rows == 2


def test_repeated_and_sector_columns(tmp_path: Path, golden: Golden) -> None:
    head = "depth_m," + ",".join(["GR"] * 4) + "," + ",".join(f"R{n}" for n in (1, 2, 4, 5))
    one = hb.open(write(tmp_path, head + "\n" + ",".join(map(str, range(9))) + "\n")).set()
    assert one["GR"].member_names == ("GR:1", "GR:2", "GR:3", "GR:4")
    assert one["GR"].values.tolist() == [[1.0, 2.0, 3.0, 4.0]]
    golden(one.remarks)


def test_integers_beyond_float64_stay_integers(tmp_path: Path) -> None:
    one = hb.open(write(tmp_path, "t_ns,a\n1700000000000000001,1\n1700000000000000002,2\n")).set()
    assert one["t_ns"].values.tolist() == [1700000000000000001, 1700000000000000002]
    assert one["a"].values.dtype == np.float64


def test_integers_then_fractions_across_blocks(tmp_path: Path) -> None:
    # The first 2 MiB hold only whole numbers and an empty column; both go on otherwise.
    rows = "".join(f"{row},\n" for row in range(400_000)) + "0.5,7.25\n"
    one = hb.open(write(tmp_path, "a,b\n" + rows)).set()
    assert one["a"].values[-1] == 0.5
    assert (one["b"].missing, one["b"].values[-1]) == (400_000, 7.25)


def test_a_word_far_down_is_named_with_its_line(tmp_path: Path) -> None:
    path = write(tmp_path, "a,b\n" + "1.000000000000,2.000000000000\n" * 80_000 + "1,oops\n1,2\n")
    refused(path, "t.csv, line 80002, column b = 'oops': is not a number")


@pytest.mark.parametrize(
    ("text", "rule"),
    [
        ("", "empty: 0 bytes"),
        (" \n\n", "empty: nothing but blanks"),
        ("md,r\n", "line 1: no rows below the header"),
        ("md,r\n1,2\n3\n", "line 3: truncated: 1 values where 2 columns are defined"),
        (
            "md,r\n1,2\n3;4\n",
            "line 3: truncated: 1 values where 2 columns are defined (it has 2 when cut at ';': another delimiter?)",
        ),
        ("md r s\n1 2\n3 4\n", "line 1: blanks separate the columns"),
        ("md,r\n1,2\n3,x\n", "line 3, column r = 'x': is not a number"),
        ('md,r\n1,"2\n3,4\n', "line 2: a quote is opened and not closed"),
        ('md,note\n1,a\n2,"b\n3,c\n', "line 3: a quote is opened and not closed"),
        ("md;r\n1,5;2.5\n", "line 2, column md = '1,5': is not a number: a decimal comma?"),
        ("hello\nworld\n", "line 1: not a table: no comma, tab, semicolon or | separates columns"),
        (b"md,r\n1,2\n\x00\x00\x00\n", "binary, and no format that helibore reads"),
        (b"\xff\xfem\x00d", "is not utf-16 text throughout"),
        (b"md,\xc3\xa9\n1,2\n3,\xe9\n", "line 3: encodings are mixed: line 1 is UTF-8, byte 0xe9 here is not"),
        ("md,r\n" + "1" * (1 << 21) + ",2\n", "a line is longer than 1,048,576 bytes"),
        ("<html><body></body></html>", "a page of HTML"),
        ("{}", "not JSON Well Log Format"),
        (b"PK\x03\x04rest", "truncated or damaged zip archive"),
        (b"%PDF-1.4", "a PDF"),
    ],
)
def test_bad_tables(tmp_path: Path, text: str | bytes, rule: str) -> None:
    refused(write(tmp_path, text), rule)


def test_windows_encoding_is_remarked(tmp_path: Path, golden: Golden) -> None:
    one = hb.open(write(tmp_path, b"md_m,tf_\xb0\n1,2\n")).set()
    assert one.names == ("md_m", "tf_°")
    golden([each.partition(";")[0] for each in one.remarks])


def test_gzip(tmp_path: Path, golden: Golden) -> None:
    packed = gzip.compress(b"md_m,r_mm\n1,2\n" * 1 + b"3,4\n" * 1000)
    assert hb.open(write(tmp_path, packed, "renamed.txt")).set().rows == 1001
    for cut in (15, len(packed) // 2, len(packed) - 1):
        with golden.raises():
            hb.open(write(tmp_path, packed[:cut], "x.gz"))
    damaged = bytearray(packed)
    damaged[12] ^= 0xFF
    with pytest.raises(ValueError, match=r"^x.gz: damaged gzip stream"):
        hb.open(write(tmp_path, bytes(damaged), "x.gz"))


def long_table(line_end: str = "\n") -> str:
    """Some 1.5 MiB, of which pyarrow takes most, with missing cells, words and blank lines."""
    rows = [f"{number},{number / 7 if number % 5 else ''},\u00b5 {number % 13}" for number in range(60_000)]
    rows[28_000] = rows[56_000] = ""
    return line_end.join(["# from the attic", "depth_m,radius_mm,remark", *rows, ""])


@pytest.mark.parametrize(
    ("encoding", "line_end", "piece"),
    [("utf-8", "\n", 100_003), ("utf-8", "\r\n", 1 << 24), ("cp1252", "\r\n", 100_003), ("cp1252", "\n", 1 << 24)],
)
def test_packed_and_translated_as_plain(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, piece: int, line_end: str, encoding: str
) -> None:
    monkeypatch.setattr("helibore.files.input_file.PIECE", piece)
    callers = set()
    readinto = Gunzip.readinto
    monkeypatch.setattr(Gunzip, "readinto", lambda *given: callers.add(threading.get_ident()) or readinto(*given))
    text = long_table(line_end)
    plain = hb.open(write(tmp_path, text)).set()
    other = text.encode(encoding)
    for path in (write(tmp_path, other, "other.csv"), write(tmp_path, gzip.compress(other, 1), "other.gz")):
        one = hb.open(path).set()
        for name in ("depth_m", "radius_mm", "remark"):
            np.testing.assert_array_equal(one[name].values, plain[name].values, strict=True)
            assert one[name].missing == plain[name].missing
        assert len(one["remark"].values) == 59_998
    assert callers == {threading.get_ident()}, "a thread of pyarrow calls Python, also when we no longer listen"


def test_what_is_wrong_far_down_in_packed_and_translated_tables(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("helibore.files.input_file.PIECE", 1 << 20)
    text = long_table()
    line = text.count("\n") + 1
    for end, rule in {
        "1,x,3\n": f"line {line}, column radius_mm = 'x': is not a number",
        "1,2\n": f"line {line}: truncated: 2 values where 3 columns are defined",
        "1,2," + "7" * (3 << 20) + "\n": f"line {line}: a line is longer than 1,048,576 bytes",
        "1,2," + "7" * (10 << 20): f"line {line}: a line is longer than 1,048,576 bytes",
    }.items():
        for encoding in ("utf-8", "cp1252"):
            refused(write(tmp_path, gzip.compress((text + end).encode(encoding), 1), "x.gz"), f"x.gz, {rule}")
        refused(write(tmp_path, (text + end).encode("cp1252"), "x.csv"), f"x.csv, {rule}")
    mixed = text.encode("cp1252") + b"1,2,\x81\n"
    refused(
        write(tmp_path, mixed, "x.csv"),
        f"x.csv, line {line}: byte 0x81 is neither UTF-8 nor Windows-1252",
    )
    packed = gzip.compress(text.encode(), 1)
    refused(write(tmp_path, packed[:-100], "x.gz"), "x.gz: truncated: the gzip stream ends early")


def columns() -> st.SearchStrategy[dict[str, np.ndarray]]:
    floats = hnp.arrays(np.float64, 5, elements=st.floats(-1e6, 1e6).filter(lambda x: x not in NULLS))
    return st.dictionaries(st.sampled_from("abcdefgh"), floats, min_size=2)


@settings(max_examples=40, deadline=None)
@given(table=columns())
def test_csv_and_parquet_return_what_was_written(
    tmp_path_factory: pytest.TempPathFactory, table: dict[str, np.ndarray]
) -> None:
    folder = tmp_path_factory.mktemp("t")
    rows = "\n".join(",".join(repr(float(cell)) for cell in row) for row in zip(*table.values(), strict=True))
    written = write(folder, ",".join(table) + "\n" + rows + "\n")
    parquet.write_table(pa.table(table), folder / "t.parquet")
    for path in (written, folder / "t.parquet"):
        file = hb.open(path)
        for name, values in table.items():
            np.testing.assert_array_equal(file[name].values, values)


def parquet_table() -> pa.Table:
    fields = [
        pa.field("depth", pa.float64(), metadata={"unit": "ft"}),
        pa.field("img", pa.list_(pa.float32(), 8), metadata={"uom": "mm"}),
        pa.field("loose", pa.list_(pa.float64())),
        pa.field("gr_gAPI", pa.int16()),
        pa.field("note", pa.string()),
        pa.field("odd", pa.struct([("x", pa.int8())])),
    ]
    image = np.arange(24, dtype=np.float32).reshape(3, 8)
    values = [
        [1.0, None, -999.25], image.tolist(), [[1.0, 2.0]] * 3, [1, 2, None], ["a", None, "c"], [{"x": 1}] * 3,
    ]  # fmt: skip
    return pa.table([pa.array(v, f.type) for v, f in zip(values, fields, strict=True)], pa.schema(fields))


def test_parquet(tmp_path: Path, golden: Golden) -> None:
    parquet.write_table(parquet_table(), tmp_path / "renamed.csv")
    with hb.open(tmp_path / "renamed.csv") as file:
        one = file.set()
        assert file.format == "parquet"
        assert [(c.name, c.unit, c.shape) for c in one] == [
            ("depth", "ft", (3,)), ("img", "mm", (3, 8)), ("loose", "", (3, 2)), ("gr_gAPI", "gAPI", (3,)),
            ("note", "", (3,)),
        ]  # fmt: skip
        assert one["depth"].missing == 2
        assert one["img"].values.dtype == np.float32
        np.testing.assert_array_equal(one["img"].values, np.arange(24).reshape(3, 8))
        assert one["gr_gAPI"].values[:2].tolist() == [1.0, 2.0]
        assert one["note"].values.tolist() == ["a", "", "c"]
        golden(one.remarks)


def test_bad_parquet(tmp_path: Path) -> None:
    parquet.write_table(parquet_table(), tmp_path / "good")
    good = (tmp_path / "good").read_bytes()
    refused(write(tmp_path, good[: len(good) // 2], "cut.parquet"), "cut.parquet: truncated or damaged Parquet")
    parquet.write_table(pa.table({"a": pa.array([], pa.float64())}), tmp_path / "none.parquet")
    refused(tmp_path / "none.parquet", "Parquet without rows")
    ragged = pa.table({"a": pa.array([[1.0], [1.0, 2.0]])})
    parquet.write_table(ragged, tmp_path / "ragged.parquet")
    refused(tmp_path / "ragged.parquet", "column a: lists have 2 different lengths: all must have one length")
    for kind in (pa.list_(pa.float64()), pa.list_(pa.float64(), 1)):
        parquet.write_table(pa.table({"a": pa.array([[1.0], None], kind)}), tmp_path / "empty.parquet")
        refused(tmp_path / "empty.parquet", "column a: 1 rows have no list: every row must have one")


def test_dates_of_an_archive_of_arrays_are_times(tmp_path: Path) -> None:
    when = np.array(["2024-01-01T00:00:00", "NaT", "2024-01-01T00:00:01.5"], "M8[ms]")
    np.savez(tmp_path / "a", time=when, depth_m=[1.0, 2, 3], toolface_deg=[0.0, 1, 2], radius_m=[0.1] * 3)
    one = hb.open(tmp_path / "a.npz")
    np.testing.assert_array_equal(one.readings().time, [1704067200.0, np.nan, 1704067201.5])
    assert one.set().remarks == []


def test_parquet_columns_of_one_name_keep_their_own_values(tmp_path: Path) -> None:
    arrays = [pa.array([value, value]) for value in (1.0, 2.0, 3.0)]
    parquet.write_table(pa.Table.from_arrays(arrays, names=["a", "b", "a"]), tmp_path / "t.parquet")
    one = hb.open(tmp_path / "t.parquet").set()
    assert {channel.name: channel.values.tolist() for channel in one} == {"a:1": [1, 1], "b": [2, 2], "a:2": [3, 3]}


def test_parquet_decimals_and_booleans_are_numbers(tmp_path: Path) -> None:
    columns = {
        "depth_m": pa.array(["1.5", None, "2.5"]).cast(pa.decimal128(9, 3)), "on": [True, None, False],
        "none": pa.nulls(3), "flags": [[True, None], [False, True], [True, True]],
    }  # fmt: skip
    parquet.write_table(pa.table(columns), tmp_path / "t.parquet")
    one = hb.open(tmp_path / "t.parquet").set()
    np.testing.assert_array_equal(one["depth_m"].values, [1.5, np.nan, 2.5])
    np.testing.assert_array_equal(one["on"].values, [1, np.nan, 0])
    np.testing.assert_array_equal(one["flags"].values, [[1, np.nan], [0, 1], [1, 1]])
    assert [(channel.missing, channel.is_text, channel.odd_row) for channel in one] == [
        (1, False, None), (1, False, None), (3, False, None), (1, False, None),
    ]  # fmt: skip


def test_bytes_are_text_and_dates_without_a_value_are_missing(tmp_path: Path) -> None:
    when = np.array(["2024-01-01", "NaT"], "M8[s]")
    np.savez(tmp_path / "a.npz", depth_m=[1.0, 2], note=np.array(["µ".encode(), b""]), when=when)
    table = pa.table({"depth_m": [1.0, 2], "note": ["µ".encode(), None], "when": when})
    parquet.write_table(table, tmp_path / "a.parquet")
    for ending in ("npz", "parquet"):
        one = hb.open(tmp_path / f"a.{ending}").set()
        assert one["note"].values.tolist() == ["µ", ""]
        assert one["when"].values[0].startswith("2024-01-01T00:00:00")
        assert [channel.missing for channel in one] == [0, 1, 1]


@pytest.mark.parametrize("sectors", [72, 100, 128])
def test_rounded_angles_beside_an_image_are_even(tmp_path: Path, sectors: int) -> None:
    angles = (np.arange(sectors) * (360 / sectors)).astype(np.float32)
    np.savez(tmp_path / "a", depth_m=[1.0, 2], image=np.ones((2, sectors)), angle_deg=angles)
    axis = hb.open(tmp_path / "a.npz")["image"].axis
    assert axis is not None
    assert axis.step == pytest.approx(360 / sectors, rel=1e-6)
    angles[3] += 1.0
    np.savez(tmp_path / "a", depth_m=[1.0, 2], image=np.ones((2, sectors)), angle_deg=angles)
    axis = hb.open(tmp_path / "a.npz")["image"].axis
    assert axis is not None
    assert np.isnan(axis.step)


def test_a_member_of_an_archive_that_is_no_array_is_refused(tmp_path: Path) -> None:
    with zipfile.ZipFile(tmp_path / "a.npz", "w") as archive:
        archive.writestr("x.npy", "hello")
    refused(tmp_path / "a.npz", "a.npz: damaged archive of arrays (x is not an array)")


@pytest.mark.parametrize("cell", [" NULL", "n/a ", "1.#QNAN", " 7.5 ", "-"])
def test_a_large_table_has_the_numbers_of_a_small_one(tmp_path: Path, cell: str) -> None:
    text = "a,b\n" + f"1,{cell}\n1,2\n" * 3
    small = hb.open(write(tmp_path, text))["b"]
    large = hb.open(write(tmp_path, text + "1.000000000000,2.000000000000\n" * 80_000))["b"]
    assert not large.is_text
    np.testing.assert_array_equal(large.values[:6], small.values)
    assert (large.missing, large.odd_row) == (small.missing, small.odd_row)


def test_windows_encoding_far_down_is_remarked(tmp_path: Path, golden: Golden) -> None:
    one = hb.open(write(tmp_path, b"a,note\n" + (b"1," + 26 * b"x" + b"\n") * 80_000 + b"2,\xb0\n")).set()
    assert one["note"].values[-1] == "°"
    golden([each.partition(";")[0] for each in one.remarks])


def test_npz(tmp_path: Path, golden: Golden) -> None:
    image = np.arange(12.0).reshape(3, 4)
    np.savez(
        tmp_path / "a", depth_ft=[1, 2, 3], image=image, angle_deg=[0.0, 90.0, 180.0, 270.0], cube=np.ones((2, 2, 2))
    )
    one = hb.open(tmp_path / "a.npz").set()
    assert one.names == ("depth_ft", "image", "angle_deg")
    assert one["image"].axis == SectorAxis(0.0, 90.0, "deg")
    golden(one.remarks)
    np.savez_compressed(tmp_path / "bomb", a=np.zeros(1 << 24))
    with golden.raises():
        hb.open(tmp_path / "bomb.npz")
    np.savez(tmp_path / "pickled", a=np.array([{}, 1], dtype=object))
    with golden.raises():
        hb.open(tmp_path / "pickled.npz")


def test_missing_library_names_the_extra(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    import sys

    for library, content, message in (
        ("pyarrow", b"PAR1 and more", 'needs pyarrow: pip install "helibore[parquet]"'),
        ("lasio", b"~V\nVERS. 2.0:\n~W\n~C\nDEPT.M:\n~A\n1\n", 'needs lasio: pip install "helibore[las]"'),
        ("dlisio", b"\0" * 4 + b"V1.00RECORD" + b" " * 90, 'needs dlisio: pip install "helibore[dlis]"'),
    ):
        monkeypatch.setitem(sys.modules, library, None)
        with pytest.raises(ImportError, match=re.escape(message)):
            hb.open(write(tmp_path, content))


def test_unknown_channel_and_folder(tmp_path: Path) -> None:
    file = hb.open(write(tmp_path, "a,b\n1,2\n"))
    with pytest.raises(KeyError, match="no channel 'c'; it holds a, b"):
        file["c"]
    with pytest.raises(IsADirectoryError):
        hb.open(tmp_path)
    with pytest.raises(FileNotFoundError):
        hb.open(tmp_path / "none.csv")
    values = file["a"].values
    with pytest.raises(ValueError, match="read-only"):
        values[0] = 3.0


@pytest.mark.parametrize("title", ["Well: A-7", "Well,A-7", "Caliper log of A-7, run 2", "WELL A-7\n\nRun;2"])
def test_titles_above_the_names_are_kept_as_remarks(tmp_path: Path, title: str) -> None:
    file = hb.open(write(tmp_path, f"{title}\nMD,TF,CAL\nFT,DEG,IN\n1,2,3\n2,3,4\n3,4,5\n"))
    assert [(channel.name, channel.unit) for channel in file] == [("MD", "FT"), ("TF", "DEG"), ("CAL", "IN")]
    assert file["CAL"].values.tolist() == [3.0, 4.0, 5.0]
    assert f"comment: {title.splitlines()[0]}" in file.set().remarks
    assert file.set().line_of(0) == title.count("\n") + 4


def test_a_row_of_numbers_is_no_title(tmp_path: Path) -> None:
    with pytest.raises(hb.InputError):  # a name is missing: not the first row is the header
        hb.open(write(tmp_path, "MD,TF\n1,2,3\n2,3,4\n3,4,5\n"))
