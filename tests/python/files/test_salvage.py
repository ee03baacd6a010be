"""What can be read of a file that is cut: the rows before the damage, and a remark on what is lost."""

from __future__ import annotations

import gzip
from pathlib import Path

import numpy as np
import pytest
from golden_texts import Golden

import helibore as hb

ROWS = "".join(f"{1000 + row / 10},{row},{row * 2}\n" for row in range(20_000))
TABLE = "md_m,a,b\n" + ROWS


def salvaged(path: Path) -> tuple[np.ndarray, str]:
    one = hb.open(path, salvage=True).set()
    return one.numbers(one.names[0]), " | ".join(one.remarks)


@pytest.mark.parametrize("ending", ["t.csv", "t.las"])
def test_a_text_that_is_cut_within_a_row(tmp_path: Path, ending: str, golden: Golden) -> None:
    path = tmp_path / ending
    header = "~V\nVERS. 2.0:\n~W\nNULL. -999.25:\n~C\nMD.M:\na.:\nb.:\n~A\n"
    text = "md_m,a,b\n1,2,3\n2,3,4\n3,4" if ending == "t.csv" else header + "1 2 3\n2 3 4\n3 4"
    path.write_text(text)
    with golden.raises():
        hb.open(path)
    depth, remarks = salvaged(path)
    assert depth.tolist() == [1, 2]
    assert "is cut and left out" in remarks


def test_a_gzip_stream_that_is_cut(tmp_path: Path, golden: Golden) -> None:
    path = tmp_path / "t.csv.gz"
    packed = gzip.compress(TABLE.encode())
    path.write_bytes(packed[: len(packed) * 3 // 4])
    with golden.raises():
        hb.open(path)
    depth, remarks = salvaged(path)
    assert 10_000 < depth.size < 20_000
    np.testing.assert_array_equal(depth, [1000 + row / 10 for row in range(depth.size)])
    assert "gzip stream ends early" in remarks


def test_a_dlis_that_is_cut(tmp_path: Path, golden: Golden) -> None:
    dliswriter = pytest.importorskip("dliswriter")
    pytest.importorskip("dlisio")
    file = dliswriter.DLISFile()
    logical = file.add_logical_file(fh_id="F")
    logical.add_origin("ORIGIN")
    depth = np.arange(0.0, 3000.0, 0.5)
    columns = [
        logical.add_channel("DEPTH", data=depth, units="m"),
        logical.add_channel("C1", data=depth * 2, units="in"),
    ]
    logical.add_frame("MAIN", channels=columns, index_type="BOREHOLE-DEPTH")
    path = tmp_path / "t.dlis"
    file.write(path, output_chunk_size=2**20)
    content = path.read_bytes()
    path.write_bytes(content[: len(content) * 95 // 100 + 14])
    with golden.raises():
        hb.open(path)
    found, remarks = salvaged(path)
    assert 0.9 * depth.size < found.size < depth.size
    np.testing.assert_array_equal(found, depth[: found.size])
    np.testing.assert_array_equal(hb.open(path, salvage=True).set().numbers("C1"), 2 * depth[: found.size])
    with pytest.raises(hb.InputError, match="only a part can be read: salvaged"):
        hb.open(path, salvage=True, strict=True)
    assert "salvaged: " in remarks
