"""Texts of files and wires obey no one where they are shown or written."""

from __future__ import annotations

import os
import re
import stat
import subprocess
import sys
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

import helibore as hb
from helibore.base.atomic_file import write_whole
from helibore.base.errors import InputError
from helibore.base.harmless import cell, printable, text_of
from helibore.logs.picks import Pick, Picks

OBEYED = re.compile(r"[\x00-\x08\x0b-\x1f\x7f-\x9f\u202a-\u202e\u2066-\u2069\ud800-\udfff]")
HOSTILE = "\x1b]0;OWNED\x07\x1b[31m\x9b2J\u202eGR"


@given(st.text(st.characters(codec=None)))
def test_nothing_that_a_terminal_obeys_is_printed(text: str) -> None:
    found = printable(text)
    assert not OBEYED.search(found)
    assert printable(found) == found
    assert (found == text) or OBEYED.search(text) or re.search("[\u061c\u200e\u200f\u2028\u2029\ufeff]", text)


def test_text_of_any_script_stays() -> None:
    assert printable("Ø 8½ in\tБур 井\nzwj 👩\u200d🔧") == "Ø 8½ in\tБур 井\nzwj 👩\u200d🔧"


def test_an_error_shows_escapes_and_keeps_its_attributes() -> None:
    error = InputError(f"{HOSTILE}.las", "must be finite", repr(1.0))
    assert error.place == f"{HOSTILE}.las"
    assert not OBEYED.search(str(error))
    assert str(error).startswith("\\x1b]0;OWNED\\x07\\x1b[31m\\x9b2J\\u202eGR.las = 1.0")
    assert len(str(InputError("a", "must be one of " + "name " * 100_000))) < 5_000


@pytest.mark.parametrize(
    "text",
    [
        "s3://key:S3CRETS@host/a.las is missing", "https://h/a.las?X-Amz-Signature=S3CRETS&X-Amz-Date=1: gone",
        "403 for AWSAccessKeyId=S3CRETS", "AccountKey=S3CRETS;EndpointSuffix=x", "open ('https://h/a?sig=S3CRETS')",
        "az://c/a.las?sv=1&sig=S3CRETS",
    ],
)  # fmt: skip
def test_an_error_shows_no_key(text: str) -> None:
    assert "S3CRETS" not in str(InputError(text, text, text))


FORMULAS = ["=cmd|' /C calc'!A0", "@SUM(1+1)*cmd", "+1+1", "-2+3", "\t=1", "\r=1", "=HYPERLINK(1)", "＝1", "--1"]


@given(st.text() | st.sampled_from(FORMULAS).map(lambda text: "'" + text))
def test_cells_hold_the_text(text: str) -> None:
    assert text_of(cell(text)) == text
    assert cell(text)[:1] not in ("=", "@", "\t", "\r")


@pytest.mark.parametrize("text", FORMULAS)
def test_a_spreadsheet_computes_nothing(text: str) -> None:
    assert cell(text) == "'" + text


def test_numbers_stay_numbers() -> None:
    for text in ("-999.25", "+1", "-1.5e-3", "12", ""):
        assert cell(text) == text


def test_picks_hold_their_notes(tmp_path: Path) -> None:
    notes = FORMULAS[:4]
    picks = Picks(Pick(kind="bed", depth=1.0, toolface=2.0, apparent_dip=3.0, note=note) for note in notes)
    assert not re.search(r"(^|,)\"?[=@+]|(^|,)\"?-\d+\+", picks.table(), re.MULTILINE)
    picks.save(tmp_path / "a.picks.csv")
    assert [pick.note for pick in Picks.load(tmp_path / "a.picks.csv")] == notes


def test_a_private_file_is_of_its_owner(tmp_path: Path) -> None:
    for private in (True, False):
        write_whole(tmp_path / "a", lambda file: file.write(b"x"), private=private)
        assert bool(stat.S_IMODE((tmp_path / "a").stat().st_mode) & 0o077) != private


@pytest.mark.parametrize("read", [hb.open, hb.load, Picks.load])
def test_a_pipe_and_a_device_are_refused(read: object, tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "a.las")
    for path, kind in ((tmp_path / "a.las", "a pipe"), (Path("/dev/zero"), "a device")):
        with pytest.raises(InputError, match=f"is {kind}: must be a file"):
            read(path)  # type: ignore[operator]


def test_no_command_prints_an_escape(tmp_path: Path) -> None:
    name = "\x1b]0;OWNED\x07x\x1b[2J"
    (tmp_path / f"{name}.csv").write_text(f"depth_m,{name}(\x1b[31m),rad\n1,2,3\n2,{name},4\n")
    for arguments in (["inspect", f"{name}.csv"], ["inspect", f"{name}.las"], [name], ["plot", f"--{name}"]):
        command = [sys.executable, "-m", "helibore", *arguments]
        done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)
        assert "OWNED" in done.stdout + done.stderr
        assert not OBEYED.search(done.stdout + done.stderr)
        assert done.returncode == (0 if arguments[-1].endswith("csv") else 2)


def test_all_printing_passes_one_place() -> None:
    package = Path(hb.__file__).parent
    for file in (package / "cli").glob("*.py"):
        if file.name not in ("terminal.py", "__init__.py"):
            assert not re.search(
                r"click\.echo\(|(?<![\w.])print\(|import Console\n(?!\nW)|Console\(\)", file.read_text()
            ), file.name
