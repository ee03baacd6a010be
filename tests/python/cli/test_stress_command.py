"""``helibore stress``: the record and the picture of the zones and of the picks of a wall."""

from __future__ import annotations

import csv
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from click.testing import CliRunner, Result

import helibore as hb
from helibore.cli import cli
from helibore.logs.picks import Pick

BIT = 0.2159
AXIS = 40.0


@pytest.fixture(scope="module")
def wall(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A vertical hole with breakouts along 40 degrees from north, 3 m long in every 6 m."""
    k = np.arange(64 * 300)
    depth, toolface = 1000 + k * 0.1 / 64, k * 360 / 64 % 360
    away = (toolface - AXIS + 90) % 180 - 90
    radius = BIT / 2 + 0.03 * (np.abs(away) < 20) * ((depth - 1000) % 6 < 3)
    survey = hb.Survey([0, 2000], [0, 0], [0, 0])
    made = hb.reconstruct(hb.Caliper(depth, toolface, radius), bit_diameter=BIT, path=survey.path(reference="north"))
    made.picks.append(Pick(kind="breakout", depth=1001.5, toolface=130.0, height=2.0, opening=30.0))
    file = tmp_path_factory.mktemp("stress") / "w.wall"
    made.save(file)
    made.picks.save(f"{file}.picks.csv", made.path)
    return file


def run(*words: Any) -> Result:
    return CliRunner().invoke(cli, ["stress", *map(str, words)])


def record(file: Path) -> dict[str, str]:
    with file.open() as rows:
        return next(csv.DictReader(rows))


def test_the_record_of_zones_and_its_picture(wall: Path, tmp_path: Path) -> None:
    file, rose = tmp_path / "s.csv", tmp_path / "rose.svg"
    place = ("--latitude", 58.5, "--longitude", -2.25, "--regime", "SS")
    done = run(wall, "-o", file, "--of-zones", "--rose", rose, *place)
    assert done.exit_code == 0, done.output
    found = record(file)
    assert abs(float(found["AZI"]) - (AXIS + 90)) <= 1
    assert (found["TYPE"], found["NUMBER"], found["LAT"], found["LON"]) == ("BO", "5", "58.50000", "-2.25000")
    assert (found["QUALITY"], found["REGIME"]) == ("D", "SS")
    assert "C needs 30 m" in " ".join(done.output.split())
    assert rose.read_text().startswith("<?xml")


def test_the_record_of_picks(wall: Path, tmp_path: Path) -> None:
    done = run(wall, "-o", tmp_path / "s.csv")
    assert done.exit_code == 0, done.output
    found = record(tmp_path / "s.csv")
    assert (found["AZI"], found["TYPE"], found["NUMBER"], found["LAT"]) == ("40", "BOT", "1", "")
    assert "LAT and LON are empty" in " ".join(done.output.split())
    done = run(wall, "-o", tmp_path / "s.csv", "--feature", "induced fracture")
    assert record(tmp_path / "s.csv")["AZI"] == "999"
    assert "no pick of this class" in " ".join(done.output.split())


def test_refused(wall: Path, tmp_path: Path) -> None:
    for words, message in (
        (("-o", tmp_path / "s.las"), "must be one of .csv"),
        (("-o", tmp_path / "s.csv", "--latitude", 91), "latitude = 91"),
        (("-o", tmp_path / "s.csv", "--of-zones", "--feature", "induced fracture"), "zones are breakouts"),
        (("-o", tmp_path / "s.csv", "--rose", tmp_path / "r.txt"), ".png"),
    ):
        done = run(wall, *words)
        assert done.exit_code == 2, done.output
        assert message in " ".join(done.output.split())
