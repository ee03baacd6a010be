"""TOML files as editors write them."""

from __future__ import annotations

import pytest

from helibore.base.errors import InputError
from helibore.base.toml_file import read_toml


@pytest.mark.parametrize("start", [b"", b"\xef\xbb\xbf"], ids=["plain", "byte order mark"])
@pytest.mark.parametrize("end", [b"\n", b"\r\n"], ids=["unix", "windows"])
def test_a_byte_order_mark_and_ends_of_lines_change_nothing(tmp_path, start, end):
    path = tmp_path / "well.toml"
    path.write_bytes(start + end.join([b"[well]", b"name = 'A\xc3\xa9'", b""]))
    assert read_toml(path, "well.toml") == {"well": {"name": "A\u00e9"}}


def test_other_encodings_are_refused_at_their_place(tmp_path):
    path = tmp_path / "well.toml"
    path.write_bytes("name = 'A'".encode("utf-16"))
    with pytest.raises(InputError, match=r"^well.toml: not TOML: "):
        read_toml(path, "well.toml")
