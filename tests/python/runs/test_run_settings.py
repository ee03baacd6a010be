"""The settings beside every output: they repeat it to the last bit, or say what has changed."""

from __future__ import annotations

import re
import shutil
import tomllib
from pathlib import Path

import numpy as np
import pytest
from command import run

import helibore as hb
from helibore.runs.run import checksum

BIT = ("--bit-diameter", "216mm")


@pytest.fixture(scope="module")
def written(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A survey, an image of gamma, an average and an azimuthal caliper, an archive."""
    folder = tmp_path_factory.mktemp("written")
    k, depth = np.arange(4000), np.arange(1000.0, 1010.05, 0.1)
    gamma = 50 + 20 * np.random.default_rng(2).random((depth.size, 8))
    mean = 0.22 + 0.001 * np.sin(depth)
    around = np.column_stack([1000 + k * 0.0025, k * 37.0 % 360, 0.11 + 0.002 * np.cos(np.radians(2 * k * 37.0))])
    tables = {
        "s.csv": ("md_m,incl_deg,azim_deg", np.array([[990.0, 48.0, 248.0], [1020.0, 52.0, 240.0]])),
        "g.csv": (",".join(["md_m", *(f"GR{n} [gAPI]" for n in range(1, 9))]), np.column_stack([depth, gamma])),
        "a.csv": ("md_m,cali_m", np.column_stack([depth, mean])),
        "c.csv": ("md_m,tf_deg,radius_m", around),
    }
    for name, (head, rows) in tables.items():
        np.savetxt(folder / name, rows, fmt="%.5f", delimiter=",", header=head, comments="")
    hb.reconstruct(hb.Caliper(*around.T), bit_diameter=0.216, sectors=16).save(folder / "w.wall")
    return folder


@pytest.fixture
def folder(written: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A copy of them, in the current folder."""
    folder = shutil.copytree(written, tmp_path / "well")
    monkeypatch.chdir(folder)
    return folder


@pytest.mark.parametrize(
    ("arguments", "output"),
    [
        ((*BIT, "--gauge", "--image", "g.csv:GR:edge", "--survey", "s.csv"), "m.glb"),
        ((*BIT, "--average", "a.csv:cali_m", "--image", "g.csv:GR:edge:north", "--survey", "s.csv"), "m.wall"),
        ((*BIT, "-s", "wall.pitch=-73mm", "-s", "wall.sectors=24", "-s", "wall.max_distance=none", "c.csv"), "m.ply"),
        ((*BIT, "-s", "wall.pitch=0.5m", "-s", "wall.estimator=automatic", "c.csv"), "m.ply"),
        (("w.wall", "--image", "g.csv:GR:centre:high-side", "--shell", "5cm", "--shell", "3.3in"), "m.vtu"),
        (("w.wall", "--from", "1002", "--to", "1004.1", "--survey", "s.csv", "-s", "path.head=-10m,20,900"), "m.obj"),
        (("w.glb.toml", "--color-by", "radius"), "m.vtp"),
    ],
)
def test_a_mesh_is_repeated_to_the_last_bit_wherever_its_folder_is(
    folder: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, arguments: tuple[str, ...], output: str
) -> None:
    assert run("reconstruct", "c.csv", *BIT, "-o", "w.glb", "-q").exit_code == 0
    made = run("mesh", *arguments, "-o", output)
    assert made.exit_code == 0, made.output
    assert f"{output}.toml" in made.output
    settings = tomllib.loads((folder / f"{output}.toml").read_text())
    assert settings["output"] == {"file": output, "blake2b": checksum(output)}
    alone = [settings[key] for key in ("archive", "average", "survey") if key in settings]
    named = {each["file"]: each["blake2b"] for key in ("caliper", "image") for each in settings.get(key, [])}
    named |= {each["file"]: each["blake2b"] for each in alone}
    assert named == {name: checksum(name) for name in named}
    used = {"c.csv" if text == "w.glb.toml" else text.split(":")[0] for text in arguments}
    assert named.keys() == used & {path.name for path in folder.iterdir()}
    before = Path(output).read_bytes()
    monkeypatch.chdir(tmp_path)
    folder.rename(tmp_path / "moved")
    again = run("mesh", f"moved/{output}.toml", "-o", f"again{Path(output).suffix}")
    assert again.exit_code == 0, again.output
    assert "to the last bit" in again.output
    assert (tmp_path / f"again{Path(output).suffix}").read_bytes() == before
    third = run("mesh", f"again{Path(output).suffix}.toml", "-o", f"moved/{output}", "-q")
    assert (third.exit_code, third.output) == (0, "")
    assert tomllib.loads((tmp_path / "moved" / f"{output}.toml").read_text()) == settings


def test_defaults_that_have_an_effect_are_written_and_others_are_not(folder: Path) -> None:
    assert run("mesh", "--gauge", "--from", "1000", "--to", "1002", *BIT, "-o", "g.stl", "-q").exit_code == 0
    gauge = tomllib.loads((folder / "g.stl.toml").read_text())
    assert gauge.keys() == {
        "helibore", "verb", "nulls", "gauge", "output", "preparation", "path", "wall", "start_depth", "stop_depth",
    }  # fmt: skip
    assert (gauge["verb"], gauge["gauge"], gauge["nulls"]) == ("mesh", True, [-999.25, -9999.0, -9999.25])
    assert (gauge["start_depth"], gauge["stop_depth"]) == (1000.0, 1002.0)
    assert gauge["wall"]["max_distance"] == 1.0
    assert gauge["path"] == {"method": "minimum-curvature", "head": [0.0, 0.0, 0.0], "extend": 0.0}
    assert run("mesh", "w.wall", "-o", "w.stl", "-q").exit_code == 0
    archive = tomllib.loads((folder / "w.stl.toml").read_text())
    assert archive["archive"] == {"file": "w.wall", "blake2b": checksum("w.wall")}
    assert "wall" not in archive, "the archive has its own settings"


def test_a_changed_file_is_refused(folder: Path) -> None:
    assert run("mesh", "w.wall", "--image", "g.csv:GR:edge", "-o", "m.glb", "-q").exit_code == 0
    before = checksum("g.csv")
    with (folder / "g.csv").open("a") as file:
        file.write("1011,1,2,3,4,5,6,7,8\n")
    again = run("mesh", "m.glb.toml", "-o", "again.glb")
    assert (again.exit_code, again.stdout) == (2, "")
    assert again.stderr == (
        f"helibore: g.csv: has changed since the run: its BLAKE2b is {checksum('g.csv')}, the settings have {before}; "
        "only the same file repeats the run\n"
    )
    assert not (folder / "again.glb").exists()


@pytest.mark.parametrize("option", ["-s wall.sectors=8", "-s source.set=x", "--bit-diameter 8in"])
@pytest.mark.usefixtures("folder")
def test_no_option_of_the_wall_goes_with_an_archive_that_a_project_names(option: str) -> None:
    assert run("mesh", "w.wall", "-o", "m.stl", "-q").exit_code == 0
    again = run("mesh", "m.stl.toml", "-o", "again.stl", *option.split())
    rule = f"{option.partition('=')[0].removesuffix(' 8in')}: does not go with w.wall, which has its own settings"
    assert (again.exit_code, again.stderr) == (2, f"helibore: {rule} (see cli mesh --help)\n")
    assert run("mesh", "m.stl.toml", "-o", "again.stl", "-s", "path.extend=0m").exit_code == 0


@pytest.mark.parametrize(
    ("old", "new", "rule"),
    [
        ("sectors = 64", "sektors = 64", "wall.sektors: not known; did you mean sectors?"),
        ("sectors = 64", "sectors = 6.5", "wall.sectors = 6.5: must be an integer"),
        ("sectors = 64", "sectors = true", "wall.sectors = True: must be an integer"),
        ("gauge = true", "gauge = false", "caliper, average, archive, gauge: give exactly one of them"),
        ("gauge = true", "gauge = true\narchive = 3", "archive = 3: must be a table"),
        ("[wall]", "[[image]]\nfile = 'g.csv'\n[wall]", "image 1.name: is missing"),
        ("[wall]", "[survey]\nfile = 3\n[wall]", "survey.file = 3: must be the name of a file"),
        ("[wall]", "[archive]\nfile = 'w.wall'\n[wall]", "caliper, average, archive, gauge: give exactly one of them"),
        ("[wall]", "[wal]", "wal: not known; did you mean wall?"),
        ("[wall]", "[options]\nsectors = 3\n[wall]", "options.sectors: must be one of shell, shells, sigma, nearest"),
        ("[wall]", "[options]\nshells = 5.0\n[wall]", "mesh.shell = 5: must be a list"),
        ("[wall]", "[mesh]\nshells = 5.0\n[wall]", "mesh.shells = 5: must be a list"),
        ("[wall]", "[mesh]\nsigma = 1\n[wall]", "mesh.sigma = 1: must be true or false"),
        ("gauge = true", "gauge", "not TOML: "),
    ],
)
def test_bad_settings(folder: Path, old: str, new: str, rule: str) -> None:
    assert run("mesh", "--gauge", "--from", "1000", "--to", "1002", *BIT, "-o", "m.stl", "-q").exit_code == 0
    text = (folder / "m.stl.toml").read_text()
    assert old in text
    (folder / "m.stl.toml").write_text(text.replace(old, new, 1))
    again = run("mesh", "m.stl.toml", "-o", "again.stl")
    assert (again.exit_code, again.stdout) == (2, "")
    said = re.sub(r"m\.stl\.toml, line \d+: ", "m.stl.toml: ", again.stderr)
    assert said.startswith(f"helibore: m.stl.toml: {rule}"), again.stderr
    assert not (folder / "again.stl").exists()


@pytest.mark.parametrize(
    ("arguments", "over"),
    [(("w.wall", "-o", "w.wall"), "w.wall"), (("w.glb.toml", "-o", "w.glb"), "w.glb.toml")],
)
def test_no_file_that_was_given_is_written_over(folder: Path, arguments: tuple[str, ...], over: str) -> None:
    assert run("reconstruct", "c.csv", *BIT, "-o", "w.glb", "-q").exit_code == 0
    before = {path.name: path.read_bytes() for path in folder.iterdir()}
    refused = run("mesh", *arguments)
    assert (refused.exit_code, refused.stdout) == (2, "")
    assert f"{arguments[-1]}: would overwrite {over}, from which it is made" in refused.stderr
    assert {path.name: path.read_bytes() for path in folder.iterdir()} == before


ENDINGS = {"reconstruct": ".glb", "mesh": ".wall", "logs": ".csv", "plot": ".png", "report": ".html"}


@pytest.mark.parametrize("verb", ENDINGS)
@pytest.mark.parametrize("source", [("c.csv", *BIT, "--survey", "s.csv"), ("w.wall",), ("--gauge", *BIT)])
def test_every_command_repeats_its_output_and_builds_the_wall_of_another(
    folder: Path, verb: str, source: tuple[str, ...]
) -> None:
    more = ("--dpi", "40", "--no-body", "--no-polar", "--scale", "500") if verb in ("plot", "report") else ()
    given = (*source, "--image", "g.csv:GR:edge:high-side", "--from", "1002", "--to", "1005")
    made = run("reconstruct", *given, "-o", "m.glb", "-q")
    assert made.exit_code == 0, made.output
    ending = ENDINGS[verb]
    given = given[: -4 if (verb, source) == ("mesh", ("w.wall",)) else None]  # an archive holds the whole wall
    first = run(verb, *given, *more, "-o", f"first{ending}")
    assert first.exit_code == 0, first.output
    again = run(verb, f"first{ending}.toml", "-o", f"again{ending}")
    assert again.exit_code == 0, again.output
    assert "to the last bit" in again.output
    assert (folder / f"again{ending}").read_bytes() == (folder / f"first{ending}").read_bytes()
    written, repeated = (tomllib.loads((folder / f"{name}{ending}.toml").read_text()) for name in ("first", "again"))
    assert repeated == written | {"output": repeated["output"]}
    other = run(verb, "m.glb.toml", *more, "-o", f"other{ending}")
    assert other.exit_code == 0, other.output
    if verb != "reconstruct":
        assert "its bytes are not compared with those of another kind of output" in " ".join(other.output.split())


@pytest.mark.usefixtures("folder")
def test_another_ending_or_option_claims_nothing_about_bytes() -> None:
    assert run("reconstruct", "c.csv", *BIT, "-o", "w.glb", "-q").exit_code == 0
    for given in (("-o", "again.ply"), ("-o", "again.glb", "-s", "mesh.color_by=radius")):
        again = run("reconstruct", "w.glb.toml", *given)
        assert again.exit_code == 0, again.output
        words = " ".join(again.output.split())
        assert "repeated the wall of w.glb; its bytes are not compared with those of another kind of output" in words


@pytest.mark.usefixtures("folder")
def test_an_archive_holds_the_whole_wall_of_settings() -> None:
    assert run("reconstruct", "c.csv", *BIT, "-o", "w.glb", "-q").exit_code == 0
    refused = run("mesh", "w.glb.toml", "-o", "m.wall", "--to", "1005")
    rule = "--to: does not go with .wall, which holds the whole wall (see cli mesh --help)"
    assert (refused.exit_code, refused.stderr) == (2, f"helibore: {rule}\n")


def test_the_old_settings_stay_where_nothing_was_written(folder: Path) -> None:
    assert run("mesh", "w.wall", "-o", "m.glb", "-q").exit_code == 0
    before = (folder / "m.glb.toml").read_bytes(), (folder / "m.glb").read_bytes()
    assert run("mesh", "w.wall", "--color-by", "RT", "-o", "m.glb", "-q").exit_code == 2
    assert ((folder / "m.glb.toml").read_bytes(), (folder / "m.glb").read_bytes()) == before
