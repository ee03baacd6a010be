"""``helibore stress``: the record and the picture of the zones and of the picks of a wall."""

from __future__ import annotations

import csv
import re
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

QUICK = ("--no-body", "--no-polar", "--dpi", "30")
"""Pictures that these tests do not look at."""


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


def test_a_report_with_the_stress_and_the_cement_of_a_project(wall: Path, tmp_path: Path) -> None:
    """Between the lobes the hole is of bit size; the lobes are 40 degrees wide, 30 mm deep, in half of each 6 m."""
    project, page = tmp_path / "well.toml", tmp_path / "r.html"
    tables = (
        "[stress]\nof_zones = true\n[cement]\ncasing = '7in'\nshoe = 1024.0\nprevious_shoe = 1012.0\n"
        "previous_inner = '8.8in'\ntop = 1006.0\nexcess = 0.2\ninner_diameter = '6.3in'\n"
    )
    project.write_text(f"archive = '{wall}'\n{tables}")
    done = CliRunner().invoke(cli, ["report", str(project), "-o", str(page), *QUICK])
    assert done.exit_code == 0, done.output
    text = page.read_text()
    assert re.search("SHmax</th><td>(129|130|131)° from true north", text)
    assert "Rose of SHmax and 5 features" in text
    radius = BIT / 2
    area = np.pi * radius**2 + 0.5 * (80 / 360) * np.pi * ((radius + 0.03) ** 2 - radius**2)
    volumes = {name: float(value) for name, value in re.findall(r"<td>([a-z ]+)</td>(?:<td[^>]*>[^<]*</td>){3}"
                                                                r"<td[^>]*>([\d.]+)</td>", text)}  # fmt: skip
    assert volumes["open hole"] == pytest.approx(1.2 * 12 * (area - np.pi / 4 * 0.1778**2), abs=0.01)
    assert volumes["lap"] == pytest.approx(6 * np.pi / 4 * (0.22352**2 - 0.1778**2), abs=0.006)
    assert volumes["total"] == pytest.approx(sum(volumes[name] for name in ("rat hole", "open hole", "lap")), abs=0.02)
    assert volumes["displacement"] == pytest.approx(np.pi / 4 * 0.16002**2 * 1024, abs=0.006)
    again = tmp_path / "again.html"
    assert CliRunner().invoke(cli, ["report", f"{page}.toml", "-o", str(again), *QUICK]).exit_code == 0
    assert re.findall(r'<section id="cement">.*?</section>', again.read_text(), re.DOTALL) == re.findall(
        r'<section id="cement">.*?</section>', text, re.DOTALL
    )
    project.write_text(f"archive = '{wall}'\n[cement]\ncasing = '7in'\n")
    done = CliRunner().invoke(cli, ["report", str(project), "-o", str(page), *QUICK])
    assert done.exit_code != 0
    assert "shoe: must be stated in [cement]" in done.output


def test_without_cement_and_stress_the_report_has_no_such_sections(wall: Path, tmp_path: Path) -> None:
    assert CliRunner().invoke(cli, ["report", str(wall), "-o", str(tmp_path / "r.html"), *QUICK]).exit_code == 0
    text = (tmp_path / "r.html").read_text()
    assert 'id="cement"' not in text
    assert 'id="stress"' not in text


@pytest.mark.parametrize(("north", "word"), [("magnetic", "declination"), ("grid", "convergence")])
def test_azimuths_of_another_north_are_refused_or_turned(tmp_path: Path, north: str, word: str) -> None:
    """The archive keeps the north of the survey; a breakout along 40 degrees gives SHmax 130, and 127.5 after -2.5."""
    survey = hb.Survey([0, 2000], [0, 0], [0, 0], north=north)
    k = np.arange(64 * 40)
    caliper = hb.Caliper(1000 + k * 0.1 / 64, k * 360 / 64 % 360, np.full(k.size, BIT / 2))
    made = hb.reconstruct(caliper, bit_diameter=BIT, path=survey.path(reference="north"))
    made.picks.append(Pick(kind="breakout", depth=1001.5, toolface=AXIS, height=2.0, opening=30.0))
    made.save(tmp_path / "w.wall")
    made.picks.save(tmp_path / "w.wall.picks.csv", made.path)
    path = hb.load(tmp_path / "w.wall").path
    assert path is not None
    assert path.survey.north == north
    done = run(tmp_path / "w.wall", "-o", tmp_path / "s.csv")
    assert done.exit_code != 0
    assert f"count from {north} north: state the {word}" in done.output
    done = run(tmp_path / "w.wall", "-o", tmp_path / "s.csv", "--to-true", "-2.5")
    assert done.exit_code == 0, done.output
    assert record(tmp_path / "s.csv")["AZI"] == "128"
    found = hb.stress_of_picks(made.picks, path, to_true=-2.5)
    assert found.azimuth == pytest.approx(127.5)
