"""Bombs and endless lines are refused in little memory; lazy formats load only what is asked."""

from __future__ import annotations

import gzip
import re
import tracemalloc
import zlib
from pathlib import Path

import pytest

import helibore as hb

MIB = 1 << 20


def bomb(path: Path, head: bytes, body: bytes, times: int) -> Path:
    """A gzip file of ``head`` and ``body`` repeated, written piece by piece."""
    with gzip.open(path, "wb", compresslevel=9) as stream:
        stream.write(head)
        for _ in range(times):
            stream.write(body)
    return path


def peak_of_refusal(path: Path, rule: str) -> int:
    tracemalloc.start()
    try:
        with pytest.raises(ValueError, match=re.escape(rule)) as caught:
            hb.open(path)
        assert str(caught.value).startswith(path.name)
        return tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()


HEADS = {
    "csv": b"a,b\n1,2\n",
    "las": b"~V\nVERS. 2.0:\n~W\n~C\nDEPT.M:\n~A\n1\n",
    "xml": b"<logs><log><name>",
    "json": b'[{"x": "',
}


@pytest.mark.parametrize("name", ["csv", "las", "xml"])
def test_one_endless_line(tmp_path: Path, name: str) -> None:
    pytest.importorskip("pyarrow")
    path = tmp_path / "x"
    with path.open("wb") as file:
        file.write(HEADS[name])
        for _ in range(100):
            file.write(b"7" * MIB)
    rule = "1,048,576 bytes without a tag" if name == "xml" else "a line is longer than 1,048,576 bytes"
    assert peak_of_refusal(path, rule) < 16 * MIB


def test_an_endless_line_far_down_a_table(tmp_path: Path) -> None:
    pytest.importorskip("pyarrow")
    path = tmp_path / "x.csv"
    with path.open("wb") as file:
        file.write(b"a,b\n" + (b"1,2" + b" " * 4000 + b"\n") * 600)
        for _ in range(40):
            file.write(b"7" * MIB)
    assert peak_of_refusal(path, "x.csv, line 602: a line is longer than 1,048,576 bytes") < 24 * MIB


@pytest.mark.parametrize("name", ["las", "xml", "json"])
def test_gzip_bombs(tmp_path: Path, name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("HELIBORE_LIMIT_UNPACKED", str(2 * MIB))
    line = b"1\n" * (MIB // 2)
    body = {"las": line, "xml": b"<a/>" + b" " * 1020, "json": b" " * MIB}[name]
    path = bomb(tmp_path / "x.gz", HEADS[name], body, 60 * MIB // len(body))
    assert path.stat().st_size < MIB
    assert peak_of_refusal(path, "unpacks to more than 200 times its size") < 40 * MIB


def test_xml_is_freed_as_it_is_read(tmp_path: Path) -> None:
    path = tmp_path / "x.xml"
    path.write_bytes(b"<logs><log>" + b"<a/>" * 100_000 + b"</log></logs>")
    assert peak_of_refusal(path, "log 'log': no curves") < 4 * MIB  # kept, they would take nearly 10
    path.write_bytes(b"<trajectorys><trajectory><trajectoryStation>" + b"<a/>" * 20_000)
    peak_of_refusal(path, "more than 10,000 elements in one trajectoryStation")


def test_gzip_bomb_of_a_table(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("pyarrow")
    monkeypatch.setenv("HELIBORE_LIMIT_UNPACKED", str(4 * MIB))
    path = bomb(tmp_path / "x.gz", HEADS["csv"], b"1,2\n" * (MIB // 4), 60)
    peak_of_refusal(path, "unpacks to more than 200 times its size")


def test_a_log_of_nulls_is_no_bomb(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("lasio")
    monkeypatch.setenv("HELIBORE_LIMIT_UNPACKED", str(1))
    curves = "".join(f"C{number:02d}.M :\n" for number in range(40))
    rows = "".join(f"{1000 + row / 10:.4f}" + " -999.2500" * 40 + "\n" for row in range(5000))
    text = f"~V\nVERS. 2.0:\n~W\nNULL. -999.25:\n~C\nDEPT.M:\n{curves}~A\n{rows}"
    path = tmp_path / "x.las.gz"
    path.write_bytes(gzip.compress(text.encode()))
    assert len(zlib.compress(text.encode())) * 40 < len(text)
    assert hb.open(path).set()["C"].missing == 5000 * 40


def test_parquet_and_dlis_load_only_what_is_asked(tmp_path: Path) -> None:
    pa = pytest.importorskip("pyarrow")
    from pyarrow import parquet

    parquet.write_table(pa.table({"a": [1.0, 2.0], "b": [3.0, 4.0]}), tmp_path / "t")
    with hb.open(tmp_path / "t") as file:
        assert ["_cleaned" in vars(channel) for channel in file] == [False, False]
        assert file["b"].values.tolist() == [3.0, 4.0]
        assert ["_cleaned" in vars(channel) for channel in file] == [False, True]


def test_text_read_whole_is_bounded(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("helibore.files.input_file.TEXT_LIMIT", 2 * MIB)
    path = tmp_path / "x.las"
    path.write_bytes(HEADS["las"] + b"1\n" * (2 * MIB))
    peak_of_refusal(path, "more than 2 MiB of text, which is read whole; split the file")
