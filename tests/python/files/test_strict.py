"""A file of which only a part can be read: its part with a remark, and with strict an error that names the rest."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from command import run

import helibore as hb


def parts(folder: Path) -> dict[str, tuple[Path, str]]:
    """Files of which a part can be read, by kind, and what their remark says."""
    arrays, las, cut = folder / "a.npz", folder / "a.las", folder / "cut.csv"
    np.savez(arrays, depth_m=np.arange(5.0), gr=np.arange(5.0), other=np.arange(3.0))
    head = (
        "~V\nVERS. 2.0 :\nWRAP. NO :\n~W\nSTRT.M 1 :\nSTOP.M 2 :\nSTEP.M 1 :\nNULL. -999.25 :\n~C\nDEPT.M :\nGR.API :\n"
    )
    las.write_text(f"{head}~P\n no item of a section\n~A\n1 2\n2 3\n")
    cut.write_text("depth_m,gr\n1,2\n2,3\n3")
    return {"npz": (arrays, "other"), "las": (las, "no item of ~P"), "csv": (cut, "is cut and left out")}


@pytest.mark.parametrize("kind", ["npz", "las", "csv"])
def test_a_part_is_read_with_a_remark_and_strict_refuses_it(tmp_path: Path, kind: str) -> None:
    file, words = parts(tmp_path)[kind]
    salvage = kind == "csv"
    with hb.open(file, salvage=salvage) as opened:
        assert opened.set().rows in (2, 5)
        assert words in " ".join(opened.set().remarks)
    with pytest.raises(hb.InputError, match="only a part can be read") as error:
        hb.open(file, salvage=salvage, strict=True)
    assert words in str(error.value)
    assert error.value.setting == "reading.strict"


def test_a_whole_file_opens_with_strict(tmp_path: Path) -> None:
    whole = tmp_path / "a.csv"
    whole.write_text("# comment\ndepth_m,gr\n1,2\n2,3\n")
    with hb.open(whole, strict=True) as opened:
        assert opened.set().rows == 2


def test_strict_is_a_setting_of_every_run_and_an_option_of_inspect(tmp_path: Path) -> None:
    file, words = parts(tmp_path)["las"]
    done = run("reconstruct", file, "--bit-diameter", "8.5in", "-o", tmp_path / "w.wall", "-s", "reading.strict=true")
    assert done.exit_code != 0
    assert words in " ".join(done.output.split())
    assert run("inspect", file, "--strict").exit_code != 0
    assert run("inspect", file).exit_code == 0
