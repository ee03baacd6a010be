"""Logs as LAS, CSV, Parquet and DLIS: read back by the readers of others, whole or not at all, and by name of extra."""

from __future__ import annotations

import builtins
import errno
import importlib
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from golden_texts import Golden

import helibore as hb
from helibore.base import atomic_file
from helibore.base.tables import LogColumn, LogTable
from helibore.channels.header_entries import log_header
from helibore.files.facts import read_facts
from helibore.files.log_writing import save_table
from helibore.logs.turn_logs import Logs

TOLERANCE = {"m": 5.1e-7, "m3": 5.1e-8, "deg": 5.1e-3, "s": 5.1e-3, "": 5.1e-6}  # half of the last decimal written


@pytest.fixture(scope="module")
def logs() -> Logs:
    """An oval hole with a gap of a metre and a half, timed."""
    depth = np.r_[np.arange(2000, 2004, 0.002), np.arange(2007, 2010, 0.002)]
    toolface = np.arange(depth.size) * 37.0 % 360
    radius = 0.11 + 0.005 * np.cos(np.radians(2 * toolface)) + 0.0005 * np.sin(depth * 40)
    caliper = hb.Caliper(depth, toolface, radius, np.arange(depth.size) / 20)
    return hb.reconstruct(caliper, bit_diameter=0.2159, sectors=32).logs()


def check(read: np.ndarray, column: LogColumn, exact: bool = False) -> None:
    np.testing.assert_array_equal(np.isnan(read), np.isnan(column.values), err_msg=column.mnemonic)
    np.testing.assert_allclose(read, column.values, rtol=0, atol=0 if exact else TOLERANCE[column.unit])


def test_the_logs_have_gaps_to_write(logs: Logs) -> None:
    assert 0 < np.isnan(logs.mean).sum() < len(logs)
    assert len(logs.table()) == 28


def test_lasio_reads_the_las_back(logs: Logs, tmp_path: Path, golden: Golden) -> None:
    lasio = pytest.importorskip("lasio")
    logs.save(tmp_path / "well.las")
    assert max(map(len, (tmp_path / "well.las").read_text().splitlines())) <= 256
    las = lasio.read(tmp_path / "well.las")
    assert las.version.VERS.value == 2.0
    assert las.well.STEP.value == 0.1
    assert las.well.STRT.value == pytest.approx(logs.depth[0], abs=1e-6)
    for column in logs.table():
        check(las[column.mnemonic], column)
        assert las.curves[column.mnemonic].unit == column.unit.upper()
        assert las.curves[column.mnemonic].descr == column.description
    assert las.params.BIT_DIAMETER.value == 0.2159
    assert las.params.BIT_DIAMETER.unit == "M"
    assert (las.well.BS.value, las.well.BS.unit) == (0.2159, "M")
    save_table(logs.table(), tmp_path / "well.las", header={"bit": "8.5 in"})
    bit = lasio.read(tmp_path / "well.las").well.BS
    assert (bit.value, bit.unit) == (8.5, "IN")
    save_table(logs.table(), tmp_path / "well.las", header={"bit": "8.5 in, PDC"})
    assert lasio.read(tmp_path / "well.las").well.BS.value == "8.5 in, PDC"
    golden(las.params.BASIS.value)
    assert "twice" in las.params.OVALITY.value


def test_a_long_row_is_one_line(logs: Logs, tmp_path: Path) -> None:
    lasio = pytest.importorskip("lasio")
    more = [of for size in (0.1, 0.12, 0.14) for of in logs.annulus(size).columns()]
    logs.save(tmp_path / "well.las", more)
    lines = (tmp_path / "well.las").read_text().splitlines()
    assert len(lines) - next(row for row, line in enumerate(lines) if line.startswith("~A")) == len(logs) + 1
    las = lasio.read(tmp_path / "well.las")
    assert las.version.WRAP.value == "NO"
    for column in logs.table(more):
        check(las[column.mnemonic], column) if column.decimals is None else None
        assert las[column.mnemonic].size == len(logs)


@pytest.mark.parametrize("ending", ["csv", "parquet", "dlis", "las"])
def test_helibore_reads_its_own_files_back(logs: Logs, tmp_path: Path, ending: str) -> None:
    pytest.importorskip({"csv": "numpy", "parquet": "pyarrow", "dlis": "dliswriter", "las": "lasio"}[ending])
    logs.save(tmp_path / f"well.{ending}")
    with hb.open(tmp_path / f"well.{ending}") as file:
        one = file.set()
        assert one.rows == len(logs)
        for column, channel in zip(logs.table(), one, strict=True):
            assert channel.name.split()[0] == column.mnemonic
            check(channel.values, column, exact=ending in ("parquet", "dlis"))


def test_parquet_has_nulls_units_and_facts(logs: Logs, tmp_path: Path) -> None:
    parquet = pytest.importorskip("pyarrow.parquet")
    save_table(logs.table(), tmp_path / "well.parquet", well="A-1")
    table = parquet.read_table(tmp_path / "well.parquet")
    assert table["RMEAN"].null_count == np.isnan(logs.mean).sum()
    assert table.schema.field("VOL").metadata == {b"unit": b"m3", b"description": b"Volume of the hole in this row"}
    assert table.schema.metadata[b"bit diameter"] == b"0.2159 m"
    assert table.schema.metadata[b"well"] == b"A-1"


def test_dlisio_reads_the_dlis_back_and_nothing_is_printed(
    logs: Logs, tmp_path: Path, capfd: pytest.CaptureFixture[str], golden: Golden
) -> None:
    dlis = pytest.importorskip("dlisio").dlis
    pytest.importorskip("dliswriter")
    save_table(logs.table(), tmp_path / "well.dlis", well="A-1")
    assert capfd.readouterr() == ("", "")
    with dlis.load(str(tmp_path / "well.dlis")) as (file, *_):
        frame = file.frames[0]
        assert (frame.index, frame.index_type) == ("DEPT", "BOREHOLE-DEPTH")
        curves = frame.curves()
        for column in logs.table():
            np.testing.assert_array_equal(
                curves[column.mnemonic], np.where(np.isnan(column.values), -999.25, column.values)
            )
        channel = next(of for of in frame.channels if of.name == "VOL")
        golden((channel.units, channel.long_name))
        assert file.origins[0].well_name == "A-1"
        assert {of.name: of.values[0] for of in file.parameters}["BIT_DIAMETER"] == "0.2159 m"


@pytest.mark.parametrize("ending", ["las", "dlis"])
def test_letters_beyond_ascii_become_question_marks(tmp_path: Path, ending: str) -> None:
    pytest.importorskip("dliswriter")
    table = LogTable([LogColumn("DEPT", "m", "Depth", np.array([1.0, 2.0]))], {"basis": "målt"})
    save_table(table, tmp_path / f"w.{ending}", header={"well": "Ødegård", "mud": "Ø", "country": "Norge"})
    with hb.open(tmp_path / f"w.{ending}") as file:
        header = log_header([file.set().header])
        assert (header["well"], header["mud"]) == ("?deg?rd", "?")
        assert file.set().header["BASIS"] == "m?lt"


def test_csv_states_the_facts_and_leaves_missing_cells_empty(logs: Logs, tmp_path: Path, golden: Golden) -> None:
    logs.save(tmp_path / "well.csv")
    lines = (tmp_path / "well.csv").read_text().splitlines()
    assert lines[0].startswith("DEPT (m),RMEAN (m),RMIN (m)")
    broken = int(np.flatnonzero(np.isnan(logs.mean))[5])
    assert lines[1 + broken].split(",")[1] == ""
    golden(read_facts(tmp_path / "well.csv")[0]["basis"])
    with hb.open(tmp_path / "well.csv") as file:
        assert file.set().header == read_facts(tmp_path / "well.csv")[0]


def test_a_csv_table_opens_by_the_plain_call_of_others(logs: Logs, tmp_path: Path) -> None:
    pd, pl = pytest.importorskip("pandas"), pytest.importorskip("polars")
    logs.save(tmp_path / "well.csv")
    for frame in (pd.read_csv(tmp_path / "well.csv"), pl.read_csv(tmp_path / "well.csv", infer_schema_length=None)):
        assert len(frame) == len(logs.depth)
        np.testing.assert_allclose(np.array(frame["DEPT (m)"]), logs.depth, atol=1e-5)
        assert next(iter(frame.columns)) == "DEPT (m)"


def test_facts_do_not_count_for_another_table_of_the_name(logs: Logs, tmp_path: Path) -> None:
    path = tmp_path / "well.csv"
    save_table(logs.table(), path, well="A-1")
    written = path.read_bytes()
    path.write_text("md_m,x\n1,2\n2,3\n")
    one = hb.open(path).set()
    assert one.header == {}
    assert [remark for remark in one.remarks if remark.startswith("well.csv.facts.json: ")] != []
    path.write_bytes(written)
    assert hb.open(path).set().header["well"] == "A-1"
    (tmp_path / "well.csv.facts.json").write_text('{"well": "B-2"}')  # by hand
    assert hb.open(path).set().header == {"well": "B-2"}


@pytest.mark.parametrize("content", [b"[1]", b"{", b"\xff", b"[" * 100_000, b" " * (2 << 20)])
def test_facts_that_cannot_be_read_are_a_remark(tmp_path: Path, content: bytes) -> None:
    (tmp_path / "a.csv").write_text("md_m,x\n1,2\n2,3\n")
    (tmp_path / "a.csv.facts.json").write_bytes(content)
    one = hb.open(tmp_path / "a.csv").set()
    assert one.header == {}
    assert [remark for remark in one.remarks if remark.startswith("a.csv.facts.json: ")] != []


@pytest.mark.parametrize("ending", ["las", "csv", "parquet", "dlis"])
def test_a_full_disk_leaves_the_old_file(
    logs: Logs, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, ending: str
) -> None:
    path = tmp_path / f"well.{ending}"
    path.write_bytes(b"old")

    def full(_: int) -> None:
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(atomic_file.os, "fsync", full)
    with pytest.raises(OSError, match="No space left"):
        logs.save(path)
    assert path.read_bytes() == b"old"
    assert [of.name for of in tmp_path.iterdir()] == [path.name]


@pytest.mark.parametrize(
    ("ending", "module", "extra"), [("parquet", "pyarrow", "parquet"), ("dlis", "dliswriter", "dlis")]
)
def test_a_missing_library_is_named_with_its_extra(
    logs: Logs, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, ending: str, module: str, extra: str
) -> None:
    really = builtins.__import__

    def without(name: str, *rest: Any) -> Any:
        if name.split(".")[0] == module:
            raise ImportError(name)
        return really(name, *rest)

    monkeypatch.setattr(builtins, "__import__", without)
    with pytest.raises(ImportError, match=rf'{module}: pip install "helibore\[{extra}\]"'):
        logs.save(tmp_path / f"well.{ending}")
    assert not list(tmp_path.iterdir())


def test_what_cannot_be_written_is_refused(logs: Logs, tmp_path: Path, golden: Golden) -> None:
    with golden.raises():
        logs.save(tmp_path / "well.xls")
    with golden.raises():
        hb.Wall(bit_diameter=0.2).logs().save(tmp_path / "well.las")
    depth = LogColumn("DEPT", "m", "Depth", np.arange(3.0))
    with golden.raises():
        LogTable([depth, LogColumn("GR", "", "Gamma", np.zeros(2))], {})
    with golden.raises():
        LogTable([depth, depth], {})
    with golden.raises():
        LogColumn("c 1", "", "", np.zeros(2))


def test_an_own_column_stands_beside_those_of_the_logs(logs: Logs, tmp_path: Path, golden: Golden) -> None:
    logs.save(tmp_path / "well.csv", more=[hb.LogColumn("GR", "gAPI", "Gamma ray", list(range(len(logs))))])
    assert hb.open(tmp_path / "well.csv").set().numbers("GR (gAPI)").tolist() == [*range(len(logs))]
    with golden.raises():
        logs.save(tmp_path / "well.csv", more=[("GR", logs.depth)])
    with pytest.raises(hb.InputError, match=r"^GR: must be numbers$"):
        hb.LogColumn("GR", "gAPI", "Gamma ray", ["a"])


def test_an_uneven_depth_has_step_0(tmp_path: Path) -> None:
    lasio = pytest.importorskip("lasio")
    save_table(LogTable([LogColumn("DEPT", "m", "Depth", np.array([1.0, 2.0, 4.0]))], {}), tmp_path / "w.las")
    assert lasio.read(tmp_path / "w.las").well.STEP.value == 0


@pytest.mark.parametrize("ending", [".las", ".csv", ".parquet", ".dlis"])
def test_a_table_without_rows_is_written(ending: str, tmp_path: Path) -> None:
    table = LogTable(
        [LogColumn("DEPT", "m", "Depth", np.empty(0)), LogColumn("C1", "m", "Size", np.empty(0))], {"a": "b"}
    )
    save_table(table, tmp_path / f"none{ending}")
    if ending == ".las":
        read = importlib.import_module("lasio").read(tmp_path / "none.las")
        assert [curve.mnemonic for curve in read.curves] == ["DEPT", "C1"]
    elif ending == ".parquet":
        assert importlib.import_module("pyarrow.parquet").read_table(tmp_path / "none.parquet").num_rows == 0
    elif ending == ".csv":
        assert (tmp_path / "none.csv").read_text().splitlines()[-1].startswith("DEPT")
    else:
        with importlib.import_module("dlisio").dlis.load(str(tmp_path / "none.dlis")) as (file, *_):
            assert file.frames[0].curves()["C1"].tolist() == [-999.25]
