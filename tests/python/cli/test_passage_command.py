"""``helibore passage``: the table and the lines of a drift and of a string."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from click.testing import CliRunner, Result
from golden_texts import Golden

import helibore as hb
from helibore.cli import cli

BIT = 0.2159


@pytest.fixture(scope="module")
def wall(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A round hole that is 6 mm narrower from 1003 to 1004 m."""
    k = np.arange(64 * 80)
    depth = 1000 + k * 0.1 / 64
    radius = BIT / 2 - 0.003 * ((depth > 1003) & (depth < 1004))
    file = tmp_path_factory.mktemp("passage") / "w.wall"
    hb.reconstruct(hb.Caliper(depth, k * 360 / 64 % 360, radius), bit_diameter=BIT).save(file)
    return file


def run(*words: Any) -> Result:
    return CliRunner().invoke(cli, ["passage", *map(str, words)])


def test_the_drift_of_a_narrow_hole(wall: Path, tmp_path: Path) -> None:
    output = tmp_path / "drift.csv"
    done = run(wall, "-o", output, "--length", "api-large-casing", "--unit", "mm")
    assert done.exit_code == 0, done.output
    rows = np.genfromtxt(output, delimiter=",", comments="#", skip_header=0, names=None)
    found = hb.load(wall).drift(0.305)
    sizes = rows[np.isfinite(rows[:, 0])]
    assert sizes[:, 1] == pytest.approx(1e3 * found.diameter, abs=1e-3, nan_ok=True)
    words = " ".join(done.output.split())
    assert "least diameter 8.264 in (209.9 mm)" in words
    assert "tight 1 interval with a diameter below 8.500 in (215.9 mm)" in words
    assert "unknown" in words


def test_a_string_that_does_not_pass(wall: Path, tmp_path: Path) -> None:
    done = run(wall, "-o", tmp_path / "c.csv", "--body", "213mm,0.3m", "--body", "8in,2m,0.3m", "--sigma")
    assert done.exit_code == 0, done.output
    words = " ".join(done.output.split())
    assert "string 2.3 m long, rigid" in words
    assert "(-3.1 mm)" in words
    assert "body 1" in words


@pytest.mark.parametrize(
    "words",
    [
        ("--length", "9m"),
        ("--length", "1m", "--body", "8in,1m"),
        ("--body", "8in"),
        ("--length", "api-rod"),
    ],
)
def test_refused(wall: Path, tmp_path: Path, words: tuple[str, ...], golden: Golden) -> None:
    done = run(wall, "-o", tmp_path / "c.csv", *words)
    assert done.exit_code == 2
    golden(done.output)


def test_the_column_of_a_drift_in_the_logs(wall: Path, tmp_path: Path) -> None:
    output = tmp_path / "w.csv"
    done = CliRunner().invoke(cli, ["logs", str(wall), "-o", str(output), "--drift", "1.5m", "--drift", "api-casing"])
    assert done.exit_code == 0, done.output
    lines = [line for line in output.read_text().splitlines() if not line.startswith("#")]
    names = lines[0].split(",")
    column = [name.partition(" ")[0] for name in names].index("DRIFT_1_5M")
    values = [row.split(",")[column] for row in lines[1:]]
    found = np.array([float(value) if value else np.nan for value in values])
    assert found == pytest.approx(hb.load(wall).drift(1.5).diameter, abs=1e-6, nan_ok=True)
    assert any(name.startswith("DRIFT_0_152M") for name in names)
