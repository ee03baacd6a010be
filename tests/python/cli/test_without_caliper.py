"""The command that a file with images and no caliper around the hole gets: it is whole, and it works."""

from __future__ import annotations

import shlex
from pathlib import Path

import pytest
from click.testing import CliRunner

from helibore.cli import cli
from helibore.wall.load import load

ROWS = 6


def memory(path: Path, curves: str, values: str, stated: str = "") -> None:
    """Write a LAS file with eight sectors of gamma and more columns."""
    sectors = "".join(f"GRAS{sector}M.API :\n" for sector in range(8))
    rows = "".join(f"{500 + row} {values} {' '.join(['40'] * 8)}\n" for row in range(ROWS))
    head = "~Version\nVERS. 2.0 :\nWRAP. NO :\n~Well\nSTRT.m 500 :\nSTOP.m 505 :\nSTEP.m 1 :\nNULL. -999.25 :\n"
    path.write_text(f"{head}{stated}~Curve\nDEPTH.m :\n{curves}{sectors}~A\n{rows}")


@pytest.mark.parametrize(
    ("curves", "values", "stated", "source", "bit", "basis"),
    [
        ("", "", "BS.IN 6 : Bit size\n", "--gauge", "6in", "gauge"),
        ("BITSIZE.in : Bit size\n", "12.25", "", "--gauge", "12.25in", "gauge"),
        ("CALI.in : Caliper\n", "9", "BS. 6 : Bit size\n", "--average 'a b.las:CALI'", "8.5in", "average"),
    ],
)
def test_it_builds_the_wall_that_was_refused(
    curves: str, values: str, stated: str, source: str, bit: str, basis: str, tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:  # fmt: skip
    monkeypatch.chdir(tmp_path)
    memory(Path("a b.las"), curves, values, stated)
    refused = CliRunner().invoke(cli, ["reconstruct", "a b.las", "-o", "w.wall"])
    assert refused.exit_code == 2
    command = refused.stderr.partition("Run: ")[2].strip()
    assert command == f"helibore reconstruct {source} --image 'a b.las:GRAS:edge' --bit-diameter {bit} --output w.wall"
    assert ("No bit size is stated: replace 8.5in with yours" in refused.stderr) == (bit == "8.5in")
    done = CliRunner().invoke(cli, shlex.split(command)[1:])
    assert done.exit_code == 0, done.output
    assert load("w.wall").basis == basis
    inspected = CliRunner().invoke(cli, ["inspect", "a b.las"]).stdout
    wanted = f"helibore view {source} --image 'a b.las:GRAS:edge' --bit-diameter {bit}"
    assert wanted in inspected.splitlines()


def test_a_file_with_a_caliper_or_without_images_gets_none(tmp_path: Path) -> None:
    file = tmp_path / "c.las"
    memory(file, "RB.deg : Relative bearing\nRADIUS.in : Radius\n", "30 4.3")
    assert "--gauge" not in CliRunner().invoke(cli, ["inspect", str(file)]).stdout
    file.write_text("depth_m,gr\n1,2\n3,4\n")
    assert "--gauge" not in CliRunner().invoke(cli, ["inspect", str(file)]).stdout
    map_file = tmp_path / "m.toml"
    map_file.write_text('[channels.depth_m]\nrole = "depth"\nunit = "m"\n[channels.gr]\nrole = "image"\nunit = ""\n')
    mapped = CliRunner().invoke(cli, ["inspect", str(file), "--map", str(map_file)])
    assert (mapped.exit_code, "--gauge" in mapped.stdout) == (0, False)  # one value a row is no image
