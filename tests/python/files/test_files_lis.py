"""LIS79 files, written here byte by byte from the format's description, and damaged ones."""

from __future__ import annotations

import math
import struct
from pathlib import Path

import numpy as np
import pytest
from golden_texts import Golden

import helibore as hb
from helibore.channels.header_entries import log_header

pytest.importorskip("dlisio")

FLOAT, ROWS = 68, 7


def lis_float(value: float) -> bytes:
    """Representation code 68: sign, exponent + 128, fraction; a negative number is the two's complement."""
    fraction, exponent = math.frexp(abs(value))
    word = ((exponent + 128) << 23 | round(fraction * 2**23)) if value else 0x40000000
    return struct.pack(">I", word if value >= 0 else -word & 0xFFFFFFFF)


def record(kind: int, body: bytes) -> bytes:
    """One logical record in one physical record."""
    return struct.pack(">HHBB", len(body) + 6, 0, kind, 0) + body


def file_name(kind: int) -> bytes:
    fields = ("helib.001 ", "  ", "sub   ", "version ", "26/11/22", " ", " 8192", "  ", "LO", "  ", " " * 10)
    return record(kind, "".join(fields).encode())


def channel(name: str, unit: str, samples: int = 1, code: int = FLOAT) -> bytes:
    """A datum specification block."""
    head = f"{name:<4}{'':<6}{'':<8}{unit:<4}".encode()
    return head + bytes(4) + struct.pack(">hh", 1, 4 * samples) + bytes(3) + bytes([samples, code]) + bytes(5)


def specification(*channels: bytes) -> bytes:
    absent = bytes([12, 4, FLOAT]) + lis_float(-777.0)
    return record(64, absent + bytes([0, 0, 66]) + b"".join(channels))


def log(rows: list[list[float]], *channels: bytes) -> bytes:
    """A format specification and its rows."""
    data = record(0, b"".join(lis_float(value) for row in rows for value in row)) if rows else b""
    return specification(*channels) + data


def written(path: Path, *logs: bytes) -> Path:
    path.write_bytes(file_name(128) + b"".join(logs) + file_name(129))
    return path


CALIPER = (channel("DEPT", "FT"), channel("C1", "IN"), channel("C2", "IN"), channel("RB", "DEG"))
TABLE = [[4000.0 + row / 2, 8.5, 8.625, 10.0 * row] for row in range(ROWS)]


def test_channels_units_and_absent_values(tmp_path: Path) -> None:
    rows = [list(row) for row in TABLE]
    rows[2][1] = -777.0
    with hb.open(written(tmp_path / "run.1", log(rows, *CALIPER))) as file:
        one = file.set()
        assert (file.format, one.name, one.rows, one.index) == ("LIS", "0/0", ROWS, "DEPT")
        assert [(c.name, c.unit) for c in one] == [("DEPT", "FT"), ("C1", "IN"), ("C2", "IN"), ("RB", "DEG")]
        expected = np.array(rows)
        expected[2, 1] = np.nan
        np.testing.assert_array_equal(np.stack([c.values for c in one], axis=1), expected)
        assert one["C1"].missing == 1
        caliper = one.caliper()
        np.testing.assert_allclose(np.unique(caliper.depth), expected[:, 0] * 0.3048)


def block(kind: int, name: str, value: str) -> bytes:
    """A component block that holds text: 73 names a table, 0 begins a row, 69 goes on with it."""
    return bytes([kind, 65, len(value), 0]) + f"{name:<4}{'':<4}{value}".encode()


@pytest.mark.parametrize("as_table", [True, False])
def test_company_well_and_field_of_the_well_site_data(tmp_path: Path, as_table: bool) -> None:
    stated = {"CN": "ACME OIL", "WN": "A-1", "FN": "NORTH", "RUN": " "}
    rows = [block(0, "MNEM", name) + block(69, "VALU", text) for name, text in stated.items()]
    lines = [block(0, name, text) for name, text in stated.items()]
    site = block(73, "TYPE", "CONS") + b"".join(rows) if as_table else b"".join(lines)
    with hb.open(written(tmp_path / "run.1", record(34, site), log(TABLE, *CALIPER))) as file:
        header = file.set().header
        assert header == {"CN": "ACME OIL", "WN": "A-1", "FN": "NORTH"}
        assert log_header([header]) == {"company": "ACME OIL", "well": "A-1", "field": "NORTH"}


def test_damaged_well_site_data_do_not_block_the_log(tmp_path: Path) -> None:
    site = record(34, block(0, "MNEM", "CN")[:-1])
    with hb.open(written(tmp_path / "run.1", site, log(TABLE, *CALIPER))) as file:
        assert (file.set().rows, file.set().header) == (ROWS, {})


def test_a_log_without_rows_does_not_block_the_others(tmp_path: Path, golden: Golden) -> None:
    file = hb.open(written(tmp_path / "x", log([], *CALIPER), log(TABLE, *CALIPER)))
    assert [one.rows for one in file.sets] == [ROWS]
    golden(file.set().remarks)
    with pytest.raises(ValueError, match=r"^x, log 0/0: no rows$"):
        hb.open(written(tmp_path / "x", log([], *CALIPER)))
    with pytest.raises(ValueError, match=r"^x: LIS without a log$"):
        hb.open(written(tmp_path / "x"))


def test_faster_channels_are_left_out_and_named(tmp_path: Path, golden: Golden) -> None:
    rows = [[4000.0 + row, 50.0, 1.0, 2.0, 3.0] for row in range(ROWS)]
    channels = (channel("DEPT", "M"), channel("GR", "GAPI"), channel("DIP1", "MMHO", samples=3))
    one = hb.open(written(tmp_path / "x", log(rows, *channels))).set()
    assert (one.names, one.rows) == (("DEPT", "GR"), ROWS)
    golden(one.remarks)


@pytest.mark.parametrize("code", [77, 128, 234])
def test_a_channel_of_an_unknown_code_is_left_out_and_named(tmp_path: Path, code: int) -> None:
    blocks = (channel("DEPT", "FT"), channel("C1", "IN"), channel("WHAT", "", code=code), channel("RB", "DEG"))
    file = written(tmp_path / "w.lis", log(TABLE, *blocks))
    with pytest.raises(hb.InputError, match="only a part can be read: WHAT: not read"):
        hb.open(file, strict=True)
    one = hb.open(file).set()
    assert one.names == ("DEPT", "C1", "RB")
    np.testing.assert_array_equal(one.numbers("C1"), [row[1] for row in TABLE])
    np.testing.assert_array_equal(one.numbers("RB"), [row[3] for row in TABLE])
    assert any(f"WHAT: not read, because no reader knows its code {code}" in remark for remark in one.remarks)


def test_damage_is_read_or_refused(tmp_path: Path) -> None:
    from test_files_fuzz import damaged, opened_or_refused

    whole = written(tmp_path / "w", log(TABLE, *CALIPER)).read_bytes()
    spoiled = tmp_path / "spoiled"
    for size in range(0, len(whole), 7):
        spoiled.write_bytes(whole[:size])
        opened_or_refused(spoiled)
    opened = 0
    for seed in range(150):
        spoiled.write_bytes(damaged(whole, seed))
        opened += opened_or_refused(spoiled)
    assert opened > 0
