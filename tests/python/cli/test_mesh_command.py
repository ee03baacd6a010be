"""``helibore mesh``: what it writes is what the library makes, to the last byte; its summary and its refusals."""

from __future__ import annotations

import filecmp
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner, Result
from golden_texts import Golden

import helibore as hb
from helibore.base.color_limits import percentile_limits
from helibore.cli import cli

BIT = 0.216
SURVEY = hb.Survey([990.0, 1020.0], [48.0, 52.0], [248.0, 240.0])


def run(*arguments: object) -> Result:
    return CliRunner().invoke(cli, ["mesh", *(str(argument) for argument in arguments)])


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A survey, an image of gamma from north, an average caliper, and an archive."""
    columns = np.column_stack([SURVEY.depth, SURVEY.inclination, SURVEY.azimuth])
    np.savetxt(tmp_path / "s.csv", columns, fmt="%g", delimiter=",", header="md_m,incl_deg,azim_deg", comments="")
    depth = np.arange(1000.0, 1010.05, 0.1)
    gamma = 50 + 20 * np.random.default_rng(2).random((depth.size, 8))
    head = ",".join(["md_m", *(f"GR{n} [gAPI]" for n in range(1, 9))])
    np.savetxt(tmp_path / "g.csv", np.column_stack([depth, gamma]), fmt="%.3f", delimiter=",", header=head, comments="")
    mean = np.column_stack([depth, 0.22 + 0.001 * np.sin(depth)])
    np.savetxt(tmp_path / "a.csv", mean, fmt="%.5f", delimiter=",", header="md_m,cali_m", comments="")
    k = np.arange(4000)
    hb.reconstruct(hb.Caliper(1000 + k * 0.0025, k * 37.0 % 360, 0.11 + 0.002 * np.cos(np.radians(2 * k * 37.0))),
                   bit_diameter=BIT, sectors=16).save(tmp_path / "w.wall")  # fmt: skip
    return tmp_path


def gamma_of(folder: Path) -> hb.SectorImage:
    return hb.open(folder / "g.csv").image("GR").sector_image("edge", "north")


def test_a_gauge_hole_along_a_survey(folder: Path) -> None:
    image = gamma_of(folder)
    wall = hb.reconstruct(hb.Caliper.gauge(1000.0, 1010.0, BIT), bit_diameter=BIT, start_depth=1000.0,
                          stop_depth=1010.0, path=SURVEY.path())  # fmt: skip
    wall.images["GR"] = image
    wall.made_from = {"survey": {"name": "s.csv", "north": ""}}
    given = ("--gauge", "--from", "1000", "--to", "1010", "--bit-diameter", "216mm", "--survey", folder / "s.csv")
    result = run(*given, "--image", f"{folder}/g.csv:GR:edge:north", "-o", folder / "m.glb")
    assert result.exit_code == 0, result.output
    assert "gauge hole at bit size: not measured" in result.output
    surface = wall.surface("own", 1000.0, 1010.0)
    limits = percentile_limits(surface.attributes["GR"])
    surface.save(folder / "own.glb", color_by="GR", limits=limits, color_map="gamma")
    assert filecmp.cmp(folder / "m.glb", folder / "own.glb", shallow=False)


@pytest.mark.parametrize(("pitch", "warned"), [("0.5m", True), ("0.1m", False)])
def test_a_wall_with_turns_coarser_than_an_image_says_so(folder: Path, pitch: str, warned: bool) -> None:
    given = ("reconstruct", "--average", f"{folder}/a.csv:cali_m", "--bit-diameter", "216mm")
    image = ("--image", f"{folder}/g.csv:GR:edge", "-s", "path.reference=north", "-o", f"{folder}/m.wall")
    result = CliRunner().invoke(cli, [*given, *image, "--pitch", pitch])
    assert result.exit_code == 0, result.output
    assert ("wall.pitch=0.1m shows every row" in " ".join(result.output.split())) == warned


def test_an_average_caliper_and_an_archive_again(folder: Path) -> None:
    given = ("--average", f"{folder}/a.csv:cali_m", "--bit-diameter", "216mm", "--image", f"{folder}/g.csv:GR:edge")
    result = run(*given, "-s", "path.reference=north", "--survey", folder / "s.csv", "-o", folder / "m.wall")
    assert result.exit_code == 0, result.output
    wall = hb.load(folder / "m.wall")
    assert wall.basis == "average"
    assert wall.path is not None
    assert wall.path.reference == wall.images["GR"].reference == "north"
    assert "at 990 m, as if it were (0, 0, 0); path.head says where it lies" in " ".join(result.output.split())
    assert run(folder / "m.wall", "-o", folder / "m.vtu", "-q").exit_code == 0
    wall.surface().save(folder / "own.vtu", color_by="GR")
    assert (folder / "m.vtu").read_bytes() == (folder / "own.vtu").read_bytes()


def test_shells_carry_the_images(folder: Path) -> None:
    given = (folder / "w.wall", "--image", f"{folder}/g.csv:GR:edge", "--shell", "5cm", "--shell", "0.2m")
    result = run(*given, "-s", "path.reference=north", "-o", folder / "v.vtu")
    assert result.exit_code == 0, result.output
    wall = hb.load(folder / "w.wall")
    volume = wall.volume(shells=[0.05, 0.2])
    volume.hang("GR", [gamma_of(folder).on(wall)] * 2, "gAPI")
    volume.save(folder / "own.vtu")
    assert (folder / "v.vtu").read_bytes() == (folder / "own.vtu").read_bytes()
    assert f"{len(volume.hexes):,} hexahedra" in result.output


def test_a_constant_image_and_one_below_zero_keep_their_values(folder: Path, golden: Golden) -> None:
    sevens, resistivities = ",7" * 8, ",-2" + ",3" * 7
    rows = "".join(f"{depth:g}{sevens}{resistivities}\n" for depth in np.arange(1000.0, 1010.0, 0.1))
    heads = [*(f"C{n}" for n in range(1, 9)), *(f"RES{n} [ohm.m]" for n in range(1, 9))]
    (folder / "c.csv").write_text(f"md_m,{','.join(heads)}\n{rows}")
    for name in ("C", "RES"):
        image = ("--image", f"{folder}/c.csv:{name}:edge")
        assert run(folder / "w.wall", *image, "-o", folder / f"{name}.vtu", "-q").exit_code == 0
    assert run(folder / "w.wall", "--image", f"{folder}/c.csv:C:edge", "-o", folder / "c.glb", "-q").exit_code == 0
    refused = run(folder / "w.wall", *image, "-o", folder / "r.glb")
    golden(refused.stderr)


@pytest.mark.parametrize(
    "arguments",
    [
        ["w.wall", "-o", "m.xyz"],
        ["w.wall", "-o", "m.glb", "--shell", "5cm"],
        ["w.wall", "-o", "m.vtu", "--shell", "5cm", "--shell", "4cm"],
        ["w.wall", "-o", "no/m.vtu"],
        ["w.wall", "-o", "m.ply", "--color-by", "RT"],
        ["w.wall", "-o", "m.wall", "--from", "1001"],
        ["w.wall", "-o", "m.wall", "--to", "1005"],
        ["w.wall", "-o", "m.wall", "--color-by", "radius"],
        ["w.wall", "-o", "m.stl", "--color-by", "radius"],
        ["w.wall", "-o", "m.obj", "--color-by", "radius"],
        ["w.wall", "-o", "m.vtu", "--shell", "5cm", "--color-by", "radius"],
        ["w.wall", "-o", "m.glb", "-s", "wall.sectors=64"],
        ["w.wall", "-o", "m.glb", "-s", "wall.pitch=5cm"],
        ["w.toml", "-o", "m.glb"],
        ["w.wall", "-o", "m.glb", "--bit-diameter", "8.5in"],
        ["w.wall", "-o", "m.glb", "--column", "diameter=x@0"],
        ["--gauge", "-o", "m.glb", "--bit-diameter", "8.5in", "--column", "depth=md"],
        ["--average", "a.csv:cali_m", "-o", "m.glb", "--bit-diameter", "8.5in", "--column", "toolface=tf"],
        ["w.wall", "-o", "m.ply", "--image", "g.csv:GR:edge:west"],
    ],
)
def test_refusals(folder: Path, monkeypatch: pytest.MonkeyPatch, arguments: list[str], golden: Golden) -> None:
    monkeypatch.chdir(folder)
    before = sorted(folder.iterdir())
    result = run(*arguments)
    assert (result.exit_code, result.stdout) == (2, "")
    golden(result.stderr)
    assert sorted(folder.iterdir()) == before


@pytest.mark.parametrize("basis", [["--gauge"], ["--average", "a.csv:cali_m"]])
def test_an_interval_of_a_wall_that_is_made_here_is_kept(
    folder: Path, monkeypatch: pytest.MonkeyPatch, basis: list[str]
) -> None:
    monkeypatch.chdir(folder)
    result = run(*basis, "--bit-diameter", "216mm", "--from", "1002", "--to", "1004", "-o", "m.wall", "-q")
    assert result.exit_code == 0, result.output
    depth = hb.load("m.wall").depth
    assert 1002 <= depth[0] < 1002.01
    assert 1003.9 < depth[-1] < 1004.1


@pytest.mark.parametrize("shells", [(), ("--shell", "5cm")])
def test_a_path_that_does_not_cover_the_wall_is_refused_by_its_file(folder: Path, shells: tuple[str, ...]) -> None:
    rows = ("md_m,incl_deg,azim_deg", "1005,48,248", "1020,50,246")
    (folder / "deep.csv").write_text("\n".join(rows))
    result = run(folder / "w.wall", "--survey", folder / "deep.csv", *shells, "-o", folder / "m.vtu")
    rule = "vertex 0 at depth 1000: must not lie above the first station of the survey, at 1005 m"
    assert (result.exit_code, result.stderr) == (2, f"helibore: deep.csv: {rule}\n")
    covered = run(folder / "w.wall", "--survey", folder / "deep.csv", *shells, "-o", folder / "m.vtu", "--from", "1006")
    assert covered.exit_code == 0, covered.output
    crossing = run(folder / "w.wall", "--survey", folder / "s.csv", "--shell", "-1m", "-o", folder / "v.vtu")
    assert crossing.stderr.startswith("helibore: ")
    assert "s.csv" not in crossing.stderr, "the path covers the wall"


def test_a_wall_keeps_its_own_path(folder: Path, golden: Golden) -> None:
    wall = hb.load(folder / "w.wall")
    wall.path = SURVEY.path()
    wall.save(folder / "w.wall")
    result = run(folder / "w.wall", "--survey", folder / "s.csv", "-o", folder / "m.ply")
    golden(result.stderr)


@pytest.mark.parametrize(
    "option",
    [
        ("-s", "mesh.centres=c.csv"),
        ("--color-by", "difference"),
    ],
)
def test_what_needs_a_preparation_is_refused_before_the_work(
    folder: Path, monkeypatch: pytest.MonkeyPatch, option: tuple[str, str], golden: Golden
) -> None:
    monkeypatch.chdir(folder)
    assert run("w.wall", "-o", "m.stl", "-q").exit_code == 0
    refused = run("m.stl.toml", *option, "-o", "n.stl")
    assert refused.exit_code == 2
    golden(refused.stderr)
