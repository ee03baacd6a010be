"""``helibore logs``: files of every ending hold what the library measures; the summary; errors are one line, exit 2."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner, Result
from golden_texts import Golden
from locations import SHARED

import helibore as hb
from helibore.cli import cli
from helibore.files.facts import read_facts
from helibore.logs.zone_criteria import Criteria

CALIPERS = SHARED / "calipers"


def run(*arguments: object) -> Result:
    return CliRunner().invoke(cli, ["logs", *(str(argument) for argument in arguments)])


def column(file: Path, name: str) -> np.ndarray:
    """A column of a file; CSV names it with its unit."""
    with hb.open(file) as opened:
        one = opened.set()
        return one.numbers(next(channel for channel in one.names if channel.partition(" (")[0] == name))


def names(file: Path) -> list[str]:
    with hb.open(file) as opened:
        return opened.set().names


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A wall of 20 m with two breakouts and a washout, and an image that is dark along toolface 60."""
    folder = tmp_path_factory.mktemp("logs")
    k = np.arange(40_000)
    depth, toolface = 2000 + k * 0.0005, k * 37.0 % 360
    lobes = np.maximum(np.cos(np.radians(2 * (toolface - 60))) - 0.4, 0) / 0.6
    broken = ((depth > 2004) & (depth < 2007)) | ((depth > 2014) & (depth < 2016))
    radius = 0.108 + 0.02 * lobes * broken + 0.015 * ((depth > 2010) & (depth < 2012))
    wall = hb.reconstruct(hb.Caliper(depth, toolface, radius), bit_diameter=0.216)
    rows = 2000 + np.arange(200) * 0.1
    dark = np.where(np.isin(np.arange(36), [5, 6, 7, 23, 24, 25]), 10.0, 50.0)
    values = np.where(((rows > 2004) & (rows < 2007))[:, None], dark, 50.0)
    wall.images["AMP"] = hb.SectorImage(rows, values, "AMP", origin="centre", reference="high-side")
    wall.save(folder / "w.wall")
    return folder


@pytest.mark.parametrize("ending", ["las", "csv", "parquet", "dlis"])
@pytest.mark.parametrize("step", [None, "0.5m"])
def test_every_ending_holds_the_logs_of_the_library(
    folder: Path, tmp_path: Path, ending: str, step: str | None
) -> None:
    pytest.importorskip({"csv": "numpy", "parquet": "pyarrow", "dlis": "dlisio", "las": "lasio"}[ending])
    if ending == "dlis":
        pytest.importorskip("dliswriter")
    wall, output = hb.load(folder / "w.wall"), tmp_path / f"w.{ending}"
    done = run(folder / "w.wall", "-o", output, *(("--step", step) if step else ()), "--from", "2003", "--to", "2015")
    assert done.exit_code == 0, done.output
    turns = wall.logs().between(2003, 2015)
    expected = turns if step is None else turns.by_step(0.5)
    for name, values in (("DEPT", expected.depth), ("C1", expected.c1), ("VOL", expected.volume)):
        assert column(output, name) == pytest.approx(values, abs=2e-6)
    assert ("CLASS" in names(output)) == (step is None)
    label = f"{len(expected)} rows, " + ("one a turn" if step is None else "one each 0.5 m")
    assert label in done.output


def test_zones_breakouts_of_images_casings_and_criteria(folder: Path, tmp_path: Path) -> None:
    zones, dark, output = tmp_path / "zones.csv", tmp_path / "dark.csv", tmp_path / "w.csv"
    done = run(folder / "w.wall", "-o", output, "--zones", zones, "--breakouts", f"AMP={dark}", "--casing", "7in",
               "-s", "zones.elongation=0.5in", "-s", "zones.least-length=0.2", "-s", "zones.symmetry=0.4",
               "-s", "logs.rugosity_window=0.5m", "--well", "15/9-X")  # fmt: skip
    assert done.exit_code == 0, done.output
    wall = hb.load(folder / "w.wall")
    found = wall.zones(Criteria(elongation=0.0127, least_length=0.2, symmetry=0.4))
    assert column(zones, "AXIS")[[0, 2]] == pytest.approx([60, 60], abs=1)
    assert column(zones, "TOP") == pytest.approx([zone.start for zone in found.zones], abs=1e-5)
    assert column(dark, "AXIS") == pytest.approx([60], abs=0.01)
    assert read_facts(output)[0].items() >= {
        "well": "15/9-X", "criterion elongation": "0.0127 m", "rugosity window": "0.5 m",
        "class": "0 gauge, 1 washout, 2 breakout, 3 key seat, 4 undergauge",
    }.items()  # fmt: skip
    (written,) = re.findall(r"^wrote (.+?)^\S", done.output, re.DOTALL | re.MULTILINE)
    assert re.findall(r"\w[\w.]*\.(?:json|toml)", "".join(written.split())) == [
        "w.csv.facts.json", "zones.csv.facts.json", "dark.csv.facts.json", "w.csv.toml",
    ]  # fmt: skip
    space = wall.logs(0.5).annulus(0.1778)
    assert column(output, "AVOL_178") == pytest.approx(space.volume, abs=2e-7)
    assert set(np.unique(column(output, "CLASS"))) == {0, 1, 2}
    assert "2 breakout" in done.output
    assert "1 washout" in done.output
    assert f"annulus {space.total:.3f} m³" in done.output
    assert "AMP: 1 breakout," in done.output


def test_the_summary_says_what_a_driller_asks(folder: Path, tmp_path: Path) -> None:
    done = run(folder / "w.wall", "-o", tmp_path / "w.las", "--step", "1m")
    logs = hb.load(folder / "w.wall").logs()
    words = " ".join(done.output.split())
    size = np.nanmax(logs.c1)
    assert (
        f"greatest {size / 0.0254:.3f} in ({size * 1e3:6.1f} mm), {(size - 0.216) / 0.0254:+.3f} in against the bit, "
        f"at {logs.depth[np.nanargmax(logs.c1)]:.2f} m" in words
    )
    volume = np.nansum(logs.volume)
    assert (
        f"{volume:.3f} m³ ({volume / 0.158987294928:.2f} bbl) over {np.isfinite(logs.volume).sum() * 0.1:.1f} m"
        in words
    )
    assert "breakouts along 60 and 240 deg" in words
    assert "rugosity over 0.9 m, an odd number of turns (9): mean" in words
    assert "elongation 0.0254 m; washout 0.0127 m" in words
    assert run(folder / "w.wall", "-o", tmp_path / "w.las", "-q").output == ""


@pytest.fixture(scope="module")
def two_arms(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """An X-Y caliper that hardly turns: no turn is measured all around. 8.5 in, and 6.9 in from 1010 to 1010.4 m."""
    file = tmp_path_factory.mktemp("arms") / "xy.csv"
    k = np.arange(1000)
    depth, size = 1000 + k * 0.02, 8.5 + 0.02 * np.sin(k)
    size[(depth > 1010) & (depth < 1010.4)] = 6.9
    rows = np.column_stack([depth, k * 0.1, size, size])
    np.savetxt(file, rows, delimiter=",", header="md_m,rb_deg,cal_x_in,cal_y_in", comments="")
    return file


def test_sigma_that_no_turn_has_is_written_as_missing(two_arms: Path, tmp_path: Path) -> None:
    output = tmp_path / "w.csv"
    done = run(two_arms, "--bit-diameter", "8in", "--sigma", "-o", output)
    assert done.exit_code == 0, done.output
    sigma = column(output, "DEQ_SIGMA")
    assert np.isnan(sigma).all()
    assert np.isnan(column(output, "VOL_SIGMA")).all()
    assert (
        f"missing {sigma.size} of {sigma.size} rows have no sigma: the hole between the arms is not sampled"
        in " ".join(done.output.split())
    )


def test_a_casing_that_does_not_pass_one_place(two_arms: Path, tmp_path: Path) -> None:
    output = tmp_path / "w.csv"
    done = run(two_arms, "--bit-diameter", "8in", "--casing", "7in", "-o", output)
    assert done.exit_code == 0, done.output
    volume, depth = column(output, "AVOL_178"), column(output, "DEPT")
    narrow = column(output, "DEQ") < 0.1778
    assert 1 <= narrow.sum() <= 5
    np.testing.assert_array_equal(np.isnan(volume), narrow)
    at = depth[np.argmin(column(output, "DEQ"))]
    words = " ".join(done.output.split())
    assert (
        f"the casing does not pass {0.1 * narrow.sum():.1f} m, which have no annulus; narrowest at {at:.2f} m, 6.9"
        in words
    )


@pytest.mark.parametrize(("unit", "metres"), [("in", 0.0254), ("mm", 0.001), ("m", 1.0)])
def test_sizes_in_another_unit(folder: Path, tmp_path: Path, unit: str, metres: float) -> None:
    output, zones = tmp_path / "w.csv", tmp_path / "z.csv"
    done = run(folder / "w.wall", "-o", output, "--unit", unit, "--zones", zones, "--casing", "7in")
    assert done.exit_code == 0, done.output
    wall = hb.load(folder / "w.wall")
    assert column(output, "C1") * metres == pytest.approx(wall.logs().c1, abs=2e-6)
    assert column(output, "DEPT") == pytest.approx(wall.logs().depth, abs=2e-6)
    assert column(output, "VOL") == pytest.approx(wall.logs().volume, abs=2e-7)
    found = wall.zones().zones
    assert column(zones, "TOP") == pytest.approx([zone.start for zone in found], abs=2e-6)
    assert column(zones, "ENLARGE") * metres == pytest.approx([zone.enlargement for zone in found], abs=2e-6)
    assert f"C1 ({unit})" in output.read_text()
    elongation = f"{0.0254 / metres:.6g} {unit}"
    assert f"elongation {elongation}; washout" in done.output
    las = tmp_path / "w.las"
    assert run(folder / "w.wall", "-o", las, "--unit", unit, "-q").exit_code == 0
    assert f"BS       .{unit.upper():<5} {0.216 / metres:>14.6g} : Bit\n" in las.read_text()
    for facts in (read_facts(output)[0], read_facts(zones)[0]):
        assert facts["criterion elongation"] == elongation
        assert facts["criterion least length"] == "0.3 m"  # along the hole
        assert facts["criterion symmetry"] == "0.5"


def test_feet_are_of_depths_and_inches_of_sizes(folder: Path, tmp_path: Path) -> None:
    lasio = pytest.importorskip("lasio")
    output, zones = tmp_path / "w.las", tmp_path / "z.csv"
    done = run(folder / "w.wall", "-o", output, "--unit", "ft", "--zones", zones, "--step", "1ft")
    assert done.exit_code == 0, done.output
    expected, las = hb.load(folder / "w.wall").logs().by_step(0.3048), lasio.read(output)
    assert las["DEPT"] * 0.3048 == pytest.approx(expected.depth, abs=2e-6)
    assert las["C1"] * 0.0254 == pytest.approx(expected.c1, abs=2e-6)
    assert (las.curves.DEPT.unit, las.curves.C1.unit, las.curves.VOL.unit) == ("FT", "IN", "M3")
    assert {las.well[name].unit for name in ("STRT", "STOP", "STEP")} == {"FT"}
    assert (las.well.STRT.value, las.well.STEP.value) == (las["DEPT"][0], 1.0)
    assert hb.open(output).set()["DEPT"].unit.lower() == "ft"
    assert "TOP (ft)" in zones.read_text()
    assert "ENLARGE (in)" in zones.read_text()
    assert read_facts(zones)[0]["criterion washout"] == "0.5 in"
    assert read_facts(zones)[0]["criterion join"] == "3.28084 ft"


def test_zones_without_zones_are_an_empty_table(folder: Path, tmp_path: Path) -> None:
    zones = tmp_path / "zones.csv"
    zones.write_text("old")
    none = ("--zones", zones, "-s", "zones.elongation=1m", "-s", "zones.washout=1m", "-s", "zones.key-seat=1m")
    done = run(folder / "w.wall", "-o", tmp_path / "w.csv", *none)
    assert done.exit_code == 0
    assert "none by the criteria" in done.output
    lines = zones.read_text().splitlines()
    assert [line.split(",")[0].split(" ")[0] for line in lines] == ["DEPT"]


def test_a_wall_without_a_shape_has_logs_and_no_zones(tmp_path: Path) -> None:
    wall = hb.reconstruct(hb.Caliper.from_average([100.0, 105.0], [0.22, 0.23]), bit_diameter=0.216, max_distance=9)
    wall.save(tmp_path / "a.wall")
    done = run(tmp_path / "a.wall", "-o", tmp_path / "a.csv")
    assert done.exit_code == 0
    assert "shape assumed round" in done.output
    assert "zones" not in done.output
    done = run(tmp_path / "a.wall", "-o", tmp_path / "b.csv", "--zones", tmp_path / "z.csv")
    assert done.exit_code == 2
    assert "zones: need a shape that was measured" in done.output


@pytest.mark.parametrize(
    "options",
    [
        ["-o", "w.xls"],
        ["-o", "gone/w.las"],
        ["-o", "w.csv", "--zones", "w.csv"],
        ["-o", "w.csv", "--step", "0.01"],
        ["-o", "w.csv", "--from", "2003.2", "--to", "2003.9", "--step", "5"],
        ["-o", "w.csv", "--from", "3000"],
        ["-o", "w.csv", "-s", "logs.rugosity_window=-1"],
        ["-o", "w.csv", "--casing", "0in"],
        ["-o", "w.csv", "-s", "zones.depth=1"],
        ["-o", "w.csv", "-s", "zones.washout=0.2"],
        ["-o", "w.csv", "-s", "zones.washout=1kg"],
        ["-o", "w.csv", "-s", "zones.symmetry=2"],
        ["-o", "w.csv", "--breakouts", "AMP"],
        ["-o", "w.csv", "--breakouts", "GR=g.csv"],
    ],
)  # fmt: skip
def test_bad_options_are_one_line_and_write_nothing(
    folder: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, options: list[str], golden: Golden
) -> None:
    monkeypatch.chdir(tmp_path)
    done = run(folder / "w.wall", *options)
    assert done.exit_code == 2
    golden(done.output)
    assert done.output.count("\n") == 1
    assert list(tmp_path.iterdir()) == []


@pytest.mark.skipif(not CALIPERS.is_dir(), reason="needs ../shared/data/calipers")
def test_a_real_caliper_becomes_logs_in_one_command(tmp_path: Path) -> None:
    f12 = CALIPERS / "volve_F-12_2010_pfcs_xy_caliper.csv.gz"
    done = run(f12, "--column", "diameter=pfc1_x_in@0", "--column", "diameter=pfc2_y_in@90", "--bit-diameter", "6.2in",
               "--from", "3080", "--to", "3240", "--step", "1m", "-o", tmp_path / "f12.csv")  # fmt: skip
    assert done.exit_code == 0, done.output
    size = column(tmp_path / "f12.csv", "DEQ") / 0.0254
    assert size.size == 160
    assert abs(size.mean() - 6.211) < 0.05
    assert "none by the criteria" in done.output


@pytest.mark.parametrize("ending", ["csv", "dip"])
def test_the_true_dips_of_picks(tmp_path: Path, ending: str) -> None:
    """A bed across a hole inclined by 40 degrees; its dip is that of the library."""
    k = np.arange(64 * 50)
    caliper = hb.Caliper(1000 + k * 0.1 / 64, k * 360 / 64 % 360, np.full(k.size, 0.108))
    wall = hb.reconstruct(caliper, bit_diameter=0.216, path=hb.Survey([0, 2000], [40, 40], [120, 120]).path())
    wall.save(tmp_path / "w.wall")
    bed = hb.Pick(kind="bed", depth=1002.5, toolface=0.0, apparent_dip=20.0)
    hb.Picks([bed]).save(tmp_path / "mine.csv", wall.path)
    dips = tmp_path / f"d.{ending}"
    done = run(tmp_path / "w.wall", "-o", tmp_path / "l.csv", "--dips", dips, "--picks", tmp_path / "mine.csv")
    assert done.exit_code == 0, done.output
    text = "1 planes with a true dip, of 1 picks; azimuths from a north that the survey does not state"
    assert f"{text}; path.north states it" in " ".join(done.output.split())
    with hb.open(dips) as opened:
        one = opened.set()
        dip, azimuth = bed.dip(wall.path)
        assert one.numbers("MD") == pytest.approx(1002.5)
        assert one.numbers("DIP") == pytest.approx(dip, abs=0.005)
        assert one.numbers("DIP_AZIMUTH") == pytest.approx(azimuth, abs=0.005)


@pytest.mark.parametrize("verb", ["logs", "zones"])
def test_an_open_fracture_that_was_picked_is_no_washout(tmp_path: Path, verb: str) -> None:
    """As the print draws it. The criteria of the run are those of the metres of each kind."""
    depth = np.repeat(np.arange(1000.0, 1010.0, 0.05), 36)
    radius = 0.108 + 0.03 * (np.abs(depth - 1003) < 0.4) + 0.02 * (np.abs(depth - 1007) < 0.5)
    caliper = hb.Caliper(depth, np.tile(np.arange(0.0, 360.0, 10.0), depth.size // 36), radius)
    hb.reconstruct(caliper, bit_diameter=0.216, sectors=36, pitch=0.05).save(tmp_path / "w.wall")
    asked = [verb, f"{tmp_path / 'w.wall'}", "-o", f"{tmp_path / 'l.csv'}"]
    before, done = CliRunner().invoke(cli, asked), None
    pick = hb.Pick(kind="fracture", depth=1003.0, toolface=0.0, apparent_dip=75.0, aperture=0.1)
    hb.Picks([pick]).save(tmp_path / "w.wall.picks.csv")
    done = CliRunner().invoke(cli, asked)
    strict = CliRunner().invoke(cli, [*asked, "-s", "zones.washout=50mm"])
    assert "2 washout" in before.output
    assert "1 washout, 1." in done.output
    assert "1 washout is an open fracture that was picked" in done.output
    assert "none by the criteria" in strict.output
