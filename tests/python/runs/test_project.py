"""The project: one file for a well, read by every command, Python and a manifest; archives keep it; old files."""

from __future__ import annotations

import shutil
import tomllib
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from command import run
from golden_texts import Golden

import helibore as hb
from helibore.channels.header_entries import NAMES
from helibore.runs.manifest import read_jobs
from helibore.runs.project import Project, read_project
from helibore.runs.run import checksum
from helibore.settings.declared import members
from helibore.settings.groups import GROUPS
from helibore.settings.header_settings import Header
from helibore.settings.look_texts import look_of_setting
from helibore.settings.print_settings import Look

OLD = Path(__file__).parent / "data/settings_56ff07e9"
"""Files that the code of revision 56ff07e9 wrote beside its outputs, the manifest of that code, and their inputs."""

WELL = """caliper = "c.csv"
survey = "s.csv"
[header]
company = "ACME"
well = "A-1"
[columns]
radius = ["radius_m@0"]
[wall]
bit_diameter = "8 1/2in"
sectors = 16
[zones]
washout = "0.05in"
[print]
scale = 500
template = "t.toml"
[logs]
step = "0.5m"
"""


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The inputs of the old files, and a project, in the current folder."""
    folder = shutil.copytree(OLD, tmp_path / "well")
    (folder / "well.toml").write_text(WELL)
    monkeypatch.chdir(folder)
    return folder


def shown(source: str, *options: str) -> float:
    """The criterion of a washout, metres, with which ``helibore zones`` made its output."""
    done = run("zones", source, "-o", "z.las", "-q", *options)
    assert done.exit_code == 0, done.output
    return float(tomllib.loads(Path("z.las.toml").read_text())["zones"]["washout"])


@pytest.mark.parametrize(("verb", "name"), [("mesh", "old.vtu"), ("mesh", "old.ply")])
def test_what_56ff07e9_wrote_beside_an_output_repeats_it_to_the_last_bit(folder: Path, verb: str, name: str) -> None:
    made = Path(f"again{Path(name).suffix}")
    again = run(verb, f"{name}.toml", "-o", made)
    assert again.exit_code == 0, again.output
    written = tomllib.loads((folder / f"{name}.toml").read_text())
    assert "to the last bit" in again.output
    assert checksum(made) == written["output"]["blake2b"]
    assert "options" not in tomllib.loads(Path(f"again{Path(name).suffix}.toml").read_text())


@pytest.mark.usefixtures("folder")
def test_a_run_of_56ff07e9_that_found_a_depth_shift_repeats_and_says_that_its_bytes_differ() -> None:
    """Depth shifts are functions of depth since."""
    again = run("reconstruct", "old.glb.toml", "-o", "again.glb")
    assert again.exit_code == 0, again.output
    assert "with other bytes" in again.output
    assert tomllib.loads(Path("again.glb.toml").read_text())["preparation"]["find_shifts"] is True


@pytest.mark.usefixtures("folder")
def test_options_that_56ff07e9_recorded_become_tables() -> None:
    assert run("logs", "old.las.toml", "-o", "again.las", "-q").exit_code == 0
    again = tomllib.loads(Path("again.las.toml").read_text())
    assert again["zones"] == {"washout": pytest.approx(0.3 * 0.0254), "scaled": True}
    assert again["header"] == {"company": "ACME"}
    assert (again["logs"]["step"], again["logs"]["casing"]) == (0.5, [pytest.approx(0.1778)])
    assert (again["start_depth"], again["stop_depth"]) == (1000.5, 1002.0)


def test_a_manifest_of_56ff07e9_means_the_same_wells() -> None:
    """The hashes are those of the records that this revision wrote, so its wells are not made again."""
    jobs = read_jobs(OLD / "m.toml")
    assert {job.well: job.settings_hash for job in jobs} == {
        "A 1": "d95224a8ca4b5d827014515364a7ada7", "B": "c28fc26e84c2c620639e8ef98b784d53",
    }  # fmt: skip


def test_one_project_serves_every_command_and_python_and_the_archive_carries_it(folder: Path) -> None:
    assert run("reconstruct", "well.toml", "-o", "w.wall", "-q").exit_code == 0
    (folder / "elsewhere").mkdir()
    shutil.copy("w.wall", "elsewhere/w.wall")
    made = []
    for source in ("well.toml", "w.wall", "elsewhere/w.wall", "w.wall.toml"):
        assert run("logs", source, "-o", "l.las", "-q").exit_code == 0
        made.append(Path("l.las").read_text())
    assert len(set(made)) == 1, "the wall and its project give what the project gives"
    assert "ACME" in made[0]
    assert "A-1" in made[0]
    kept = hb.load("elsewhere/w.wall").made_from["project"]
    assert kept["print"]["template"]["track"], "the template itself, not its name"
    np.testing.assert_array_equal(hb.reconstruct("well.toml").radius, hb.load("w.wall").radius)
    assert hb.reconstruct("well.toml", sectors=8).settings.sectors == 8
    again = run("reconstruct", "w.wall.toml", "-o", "again.wall")
    assert "to the last bit" in again.output


@pytest.mark.usefixtures("folder")
def test_the_command_line_counts_over_setting_project_archive_and_default(golden: Golden) -> None:
    assert run("reconstruct", "c.csv", "--bit-diameter", "8.5in", "-o", "plain.wall", "-q").exit_code == 0
    assert "project" not in hb.load("plain.wall").made_from
    assert run("reconstruct", "well.toml", "-o", "w.wall", "-q").exit_code == 0
    Path("over.toml").write_text('archive = "w.wall"\n[zones]\nwashout = "0.2in"\n[header]\nfield = "F"\n')
    assert shown("w.wall") == pytest.approx(0.05 * 0.0254)
    assert shown("over.toml") == pytest.approx(0.2 * 0.0254)
    assert shown("over.toml", "-s", "zones.washout=0.3in") == pytest.approx(0.3 * 0.0254)
    assert tomllib.loads(Path("z.las.toml").read_text())["header"] == {"company": "ACME", "well": "A-1", "field": "F"}
    for option, sectors in (
        ((), 16),
        (("-s", "wall.sectors=24"), 24),
        (("-s", "wall.sectors=24", "--sectors", "8"), 8),
    ):
        assert run("reconstruct", "well.toml", "-o", "w.glb", "-q", *option).exit_code == 0
        assert tomllib.loads(Path("w.glb.toml").read_text())["wall"]["sectors"] == sectors
    Path("well.toml").write_text(WELL.replace('bit_diameter = "8 1/2in"\n', ""))
    missing = run("reconstruct", "well.toml", "-o", "w.glb")
    golden(missing.stderr)
    assert run("reconstruct", "well.toml", "-o", "w.glb", "-q", "--bit-diameter", "8.5in").exit_code == 0


@pytest.mark.parametrize(
    ("old", "new", "place", "rule"),
    [
        ("sectors = 16", "sektors = 16", "line 10: wall.sektors", "not known; did you mean sectors?"),
        ("sectors = 16", "sectors = 2", "line 10: wall.sectors = 2", "must lie in 3 to 1000000"),
        ("[zones]", "[zone]", "line 11: zone", "not known; did you mean zones?"),
        ('company = "ACME"', "company = 3", "line 4: header.company = 3", "must be text"),
        ("scale = 500", "skale = 500", "line 14: print.skale", "not known; did you mean scale?"),
        ("scale = 500", "scale = 0.5", "line 14: print.scale = 0.5", "must be an integer"),
        ('"0.05in"', '"0.05deg"', "line 12: zones.washout = '0.05deg'", "unit 'deg'"),
        ("[logs]", "[mesh]", "line 17: mesh.step", "must be one of shell, sigma"),
        ('"0.5m"', '"0.5deg"', "line 17: logs.step = '0.5deg'", "unit 'deg'"),
        ("[logs]", "[view]\ntoken = 'x'\n[logs]", "line 17: view.token", "must be one of host"),
        ("[logs]", "[view]\nport = 99999\n[logs]", "line 17: view.port = 99999", "must lie in 0 to 65535"),
        ("[logs]", "[look.GR]\nlimitz = [1, 2]\n[logs]", "line 17: look.GR.limitz", "not known; did you mean limits?"),
        ("[logs]", "[look.GR]\nlimits = [2, 1]\n[logs]", "line 17: look.GR.limits = (2.0, 1.0)", "the first must be"),
        ("[logs]", "[image_zones]\ndark = 2\n[logs]", "line 17: image_zones.dark = 2", "must be in (0, 1)"),
        ("[logs]", "[passage]\nbody = [['8in']]\n[logs]", "line 17: passage.body 1.length", "is missing"),
        ("[logs]", "[logs]\ncasings = [1]", "line 17: logs.casings", "is now called casing"),
        ('caliper = "c.csv"', "gauge = 3", "line 1: gauge = 3", "must be true or false"),
    ],
)
@pytest.mark.usefixtures("folder")
def test_an_error_names_the_line_and_the_nearest_key(old: str, new: str, place: str, rule: str) -> None:
    assert old in WELL
    Path("well.toml").write_text(WELL.replace(old, new))
    refused = run("reconstruct", "well.toml", "-o", "w.glb")
    assert refused.exit_code == 2
    where = f"well.toml, {place}" if place.startswith("line") else place
    assert refused.stderr.startswith(f"helibore: {where}: {rule}"), refused.stderr


def test_a_file_with_a_checksum_is_the_only_one_that_is_taken(folder: Path) -> None:
    stated = f'[[caliper]]\nfile = "c.csv"\nblake2b = "{checksum("c.csv")}"\n[wall]\nbit_diameter = 0.216\n'
    (folder / "w.toml").write_text(stated)
    assert run("reconstruct", "w.toml", "-o", "w.glb", "-q").exit_code == 0
    with (folder / "c.csv").open("a") as file:
        file.write("1003,10,0.11\n")
    refused = run("reconstruct", "w.toml", "-o", "w.glb")
    assert (refused.exit_code, refused.stderr.startswith("helibore: c.csv: has changed since the run")) == (2, True)


STATED = [
    ("logs", "logs.step", "0m", "'0m'"),
    ("logs", "logs.drift", "['9s']", "['9s']"),
    ("logs", "image_zones.dark", "2", "2"),
    ("logs", "header.company", "ACME", None),
    ("mesh", "mesh.shell", "-1m", "['-1m']"),
    ("passage", "passage.limit", "-1m", "'-1m'"),
    ("passage", "passage.body", "8in", "[['8in']]"),
    ("report", "print.left", "45", "45"),
    ("plot", "print.dpi", "3", "3"),
    ("plot", "look.GR.window", "-1m", "'-1m'"),
    ("plot", "look.GR.wndow", "1m", "'1m'"),
]
"""Verb, setting, its value on the command line and in TOML; None: a value that breaks no rule."""


@pytest.mark.parametrize(("verb", "name", "text", "toml"), STATED)
@pytest.mark.usefixtures("folder")
def test_a_table_and_the_command_line_refuse_a_value_with_the_same_words(
    verb: str, name: str, text: str, toml: str | None
) -> None:
    output = ("-o", {"plot": "p.png", "report": "p.html", "mesh": "m.vtu"}.get(verb, "t.csv"))
    stated = run(verb, "well.toml", *output, "-q", "-s", f"{name}={text}")
    if toml is None:
        assert stated.exit_code == 0, stated.output
        return
    group, _, key = name.rpartition(".")
    Path("well.toml").write_text(f"{WELL.partition('[print]')[0]}[{group}]\n{key} = {toml}\n")
    read = run(verb, "well.toml", *output, "-q")
    assert (stated.exit_code, read.exit_code) == (2, 2), (stated.output, read.output)
    rule = read.stderr.partition(" (option: ")[0].rpartition(": ")[2].strip()
    assert read.stderr.startswith(f"helibore: well.toml, line 14: {name}"), read.stderr
    assert rule in stated.stderr, stated.stderr


@pytest.mark.usefixtures("folder")
def test_looks_of_a_project_its_archive_and_the_command_line_are_merged() -> None:
    Path("well.toml").write_text(WELL + "[look.radius_m]\nlimits = [0.09, 0.13]\n")
    assert run("reconstruct", "well.toml", "-o", "w.wall", "-q").exit_code == 0
    stated = ("--scalar", "c.csv:radius_m", "--look", "radius_m=log", "-s", "look.radius_m.limits=0.1,0.12")
    made = run("plot", "w.wall", "-o", "p.png", "-q", *stated, "--no-body", "--no-polar")
    assert made.exit_code == 0, made.output
    kept = tomllib.loads(Path("p.png.toml").read_text())["look"]
    assert kept == {"radius_m": {"limits": [0.1, 0.12], "log": True}}
    assert look_of_setting("A.B.log=false", "") == ("A.B", {"log": False})


@pytest.mark.usefixtures("folder")
def test_the_look_of_an_image_that_a_wall_lacks_is_said_and_kept_unless_the_command_asks_for_it() -> None:
    Path("well.toml").write_text(WELL + '[look.GR]\ncolor_map = "viridis"\n')
    plain = ("plot", "well.toml", "-o", "p.png", "--no-body", "--no-polar")
    made = run(*plain)
    assert made.exit_code == 0, made.output
    assert [line.split()[:3] for line in made.output.splitlines() if "look" in line] == [["look", "of", "GR:"]]
    assert tomllib.loads(Path("p.png.toml").read_text())["look"] == {"GR": {"color_map": "viridis"}}
    asked = run(*plain, "--look", "GR=log")
    assert (asked.exit_code, asked.stderr.startswith("helibore: image 'GR': ")) == (2, True)


def test_options_for_images_that_an_earlier_version_recorded_become_looks(folder: Path) -> None:
    (folder / "p.png.toml").write_text(
        'helibore = "0.1.0"\nverb = "plot"\ngauge = true\n[wall]\nbit_diameter = 0.2\n[options]\nscale = "1:500"\n'
        'limits = ["GR=0.2,150"]\nlogs = ["GR"]\ncolor_maps = ["A=B=viridis"]\ndynamic = ["X=2m"]\nunit = "mm"\n'
        'besides = ["w.wall"]\nheaders = ["company=ACME=B"]\ncriteria = ["key-seat=0.3in"]\nscaled = true\n'
        '[look]\ncolor_map = ["M=viridis"]\n'
    )
    read = read_project("p.png.toml")
    assert read.look["GR"] == Look(limits=(0.2, 150.0), log=True)
    assert (read.look["A=B"], read.look["X"]) == (Look(color_map="viridis"), Look(window=2.0))
    assert read.look["M"] == Look(color_map="viridis")
    assert read.print == {"scale": 500, "unit": "mm", "beside": (Path("w.wall"),)}
    assert (read.header, read.zones) == (
        {"company": "ACME=B"},
        {"key_seat": pytest.approx(0.3 * 0.0254), "scaled": True},
    )


def test_every_group_of_settings_is_a_table_of_a_project() -> None:
    """So a setting that is declared is a key of the project, too."""
    own: dict[str, Any] = members(Project)
    for group, kind in GROUPS.items():
        name, _, part = group.partition(".")
        if name in ("template", "map"):
            continue  # files of their own
        if group in ("passage.body", "echo.casing"):
            own_part: Any = members(own[name].stated or own[name].hint)[part].parts[0]
            assert own_part is kind
            continue
        listed = own[name].kind is tuple and own[name].parts[0]
        table = own[name].parts[1] if part else own[name].stated or listed or own[name].hint
        assert issubclass(table, kind), group
        assert members(kind).keys() <= members(table).keys()
    assert tuple(NAMES) == tuple(members(Header))


def test_short_forms_mean_the_tables(folder: Path) -> None:
    base = "[wall]\nbit_diameter = 0.2\n"
    forms = (
        'caliper = "c.csv"\n',
        'caliper = ["c.csv"]\n',
        '[caliper]\nfile = "c.csv"\n',
        '[[caliper]]\nfile = "c.csv"\n',
    )
    made = []
    for form in forms:
        (folder / "f.toml").write_text(form + base)
        made.append(read_project("f.toml"))
    assert made[1:] == made[:-1]
