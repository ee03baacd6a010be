"""The command line: what it writes, what it prints, its exit codes, one-line errors, and nothing half-written."""

from __future__ import annotations

import csv
import filecmp
import gzip
import hashlib
import json
import re
import shlex
import subprocess
import sys
from pathlib import Path

import click
import numpy as np
import pytest
from command import run
from golden_texts import Golden
from late_imports import trimesh
from locations import SHARED
from patience import PATIENCE

import helibore
from helibore.cli import VERBS, cli
from helibore.cli.mesh_command import ENDINGS
from helibore.simulation.tool import Hole, simulate

F12 = SHARED / "calipers/volve_F-12_2010_pfcs_xy_caliper.csv.gz"


def real(*arguments: object, timeout: float = PATIENCE) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-m", "helibore", *(str(argument) for argument in arguments)]
    return subprocess.run(command, capture_output=True, text=True, timeout=timeout, check=False)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A simulated hole of 3 m, written by the command line."""
    folder = tmp_path_factory.mktemp("hole")
    result = run("simulate", folder, "--to", "2003m", "--samples", 9000, "--seed", 5, "--lift", "2002:1", "-q")
    assert (result.exit_code, result.output) == (0, "")
    return folder


def test_simulate_writes_what_the_library_gives(folder: Path) -> None:
    caliper = helibore.open(folder / "caliper.csv").caliper()
    assert len(caliper) == 9000
    assert caliper.time is not None
    assert (np.diff(caliper.depth) < 0).sum() == 1  # the lift
    survey = helibore.open(folder / "survey.csv").survey()
    assert survey.depth[0] < 2000
    assert survey.depth[-1] > 2003
    kept = json.loads((folder / "hole.json").read_text())
    assert (kept["seed"], kept["hole"]["stop"], kept["tool"]["lifts"]) == (5, 2003.0, [{"depth": 2002, "length": 1}])
    hole = Hole.example(2000.0, 2003.0, seed=5)
    truth = np.loadtxt(folder / "truth.csv", delimiter=",", skiprows=1)
    np.testing.assert_allclose(truth[:, 2], hole.radius(truth[:, 0], truth[:, 1]), atol=2e-7)
    assert len(truth) == 64 * 30 + 1
    with (folder / "gamma.csv").open() as file:
        rows = list(csv.reader(file))
    assert rows[0] == ["depth_m", *(f"GR{j}_gAPI" for j in range(1, 17))]
    assert len(rows) == 32


def test_simulate_formats_hold_the_same(tmp_path: Path) -> None:
    for ending in ("csv", "csv.gz", "npz"):
        assert run("simulate", tmp_path, "--to", "2001m", "--samples", 500, "--format", ending, "-q").exit_code == 0
    plain = helibore.open(tmp_path / "caliper.csv").caliper()
    assert gzip.decompress((tmp_path / "caliper.csv.gz").read_bytes()) == (tmp_path / "caliper.csv").read_bytes()
    exact = helibore.open(tmp_path / "caliper.npz").caliper()
    expected = simulate(Hole.example(2000.0, 2001.0), samples=500)
    assert np.array_equal(exact.radius, expected.radius)
    np.testing.assert_allclose(plain.radius, exact.radius, rtol=0, atol=5.1e-7)
    np.testing.assert_allclose(plain.depth, exact.depth, rtol=0, atol=5.1e-6)


def test_reconstruct_is_the_library(folder: Path, tmp_path: Path) -> None:
    mesh = tmp_path / "wall.ply"
    result = run("reconstruct", folder / "caliper.csv", "--survey", folder / "survey.csv", "-o", mesh,
                 "--bit-diameter", "216mm", "--sectors", 32, "--pitch", "5cm", "-s", "wall.neighbors=6")  # fmt: skip
    assert result.exit_code == 0, result.output
    caliper, survey = helibore.open(folder / "caliper.csv").caliper(), helibore.open(folder / "survey.csv").survey()
    wall = helibore.reconstruct(caliper, bit_diameter=0.216, sectors=32, pitch=0.05, neighbors=6)
    expected = tmp_path / "expected.ply"
    blake2b = hashlib.blake2b((folder / "caliper.csv").read_bytes(), digest_size=32).hexdigest()
    wall.made_from = {"files": [{"name": "caliper.csv", "blake2b": blake2b}], "toolface": "assumed",
                      "survey": {"name": "survey.csv", "north": ""}}  # fmt: skip
    wall.surface(survey.path()).save(expected)
    assert filecmp.cmp(mesh, expected, shallow=False)
    found = wall.summary()
    for line in (
        "caliper   caliper.csv: csv, 9,000 rows",
        "          radius_m is radius in m at 0 deg: named radius_m",
        "dropped   nothing",
        f"wall      2000.00 to 2003.00 m, 32 sectors, pitch 0.05 m: {len(wall):,} vertices, {len(wall) - 33:,} quads, "
        "from 9,000 samples",
        "bit       8.504 in (216.0 mm)",
        "support   0.00 % of the vertices have no sample in reach",
    ):
        assert line in [printed.rstrip() for printed in result.output.splitlines()]
    assert f"diameter  mean      {found.mean_diameter / 0.0254:7.3f} in" in result.output
    assert f"least     {found.least_diameter.value / 0.0254:7.3f} in" in result.output
    assert f"greatest  {found.greatest_diameter.value / 0.0254:7.3f} in" in result.output
    assert re.search(r"time      import .* read .* rebuild .* place .* save .* compare [\s\S]* in all", result.output)


@pytest.mark.parametrize("ending", ENDINGS)
def test_every_ending_is_saved(folder: Path, tmp_path: Path, ending: str) -> None:
    mesh = tmp_path / f"wall{ending}"
    result = run("reconstruct", folder / "caliper.csv", "-o", mesh, "--bit-diameter", "8.5in", "-q")
    assert (result.exit_code, result.output) == (0, "")
    assert sorted(path.name for path in tmp_path.iterdir()) == [mesh.name, f"{mesh.name}.toml"]
    quads = 64 * 30 + 1 - 65
    if ending == ".wall":
        wall = helibore.load(mesh)
        assert len(wall.surface().quads) == quads
        assert wall.made_from["files"][0]["name"] == "caliper.csv"
    elif ending in (".vtu", ".vtp", ".vtkhdf"):
        pyvista = pytest.importorskip("pyvista", reason="PyVista reads it back", exc_type=ImportError)
        assert pyvista.read(mesh).n_cells == quads
    else:
        assert len(trimesh().load_mesh(mesh).faces) == 2 * quads


def test_interval_and_dropped_rows(folder: Path, tmp_path: Path) -> None:
    lines = (folder / "caliper.csv").read_text().splitlines()
    lines[5] = lines[5].rsplit(",", 1)[0] + ",-999.25"
    lines[6] = lines[6].rsplit(",", 1)[0] + ","
    path = tmp_path / "c.csv"
    path.write_text("\n".join(lines))
    result = run(
        "reconstruct", path, "-o", tmp_path / "w.glb", "--bit-diameter", "216mm", "--from", "2001", "--to", "2002m"
    )
    assert result.exit_code == 0, result.output
    assert "missing   2 values of radius_m" in result.output
    assert "dropped   2 samples of c.csv without a radius" in result.output
    assert "wall      2001.00 to 2002.00 m, 64 sectors, pitch 0.1 m: 641 vertices, 576 quads" in result.output


def test_upwards(folder: Path, tmp_path: Path) -> None:
    result = run("reconstruct", folder / "caliper.csv", "-o", tmp_path / "w.glb", "--bit-diameter", "216mm",
                 "--from", "2001", "--to", "2002m", "--pitch=-100mm")  # fmt: skip
    assert result.exit_code == 0, result.output
    assert "wall      2001.00 to 2002.00 m, 64 sectors, pitch -0.1 m: 641 vertices, 576 quads" in result.output


@pytest.mark.parametrize(
    ("text", "options"),
    [
        ("md_m,rb_deg\n1,2\n", []),
        ("md_m,rb_deg,r\n1,2,0.1\n", []),
        ("md_m,rb_deg,r\n1,2,0.1\n", ["--column", "radius=r:parsec"]),
        ("md_m,rb_deg,r\n1,2,0.1\n1,2,big\n", ["--column", "radius=r:m"]),
        ("md_m,rb_deg,r\n1,2,0.1\nnan,2,1\n", ["--column", "radius=r:m"]),
        ("md_m,rb_deg,r\n1,2,0.1\ninf,2,1\n", ["--column", "radius=r:m"]),
        ("md_m,rb_deg,r\n1,2,0.1\n1,2,0\n1,2,0.1\n", ["--column", "radius=r:m"]),
        ("md_m,rb_deg,r\n1,2,8.5\n", ["--column", "radius=r:m"]),
        ("md_m,rb_deg,r\n", ["--column", "radius=r:m"]),
        ("md_m,rb_deg,r\n1,2,-9999\n", ["--column", "radius=r:m"]),
        ("", []),
        ("md_m,rb_deg,r\n1,2,0.1\n2,2,0.1\n", ["--column", "radius=r:m", "--from", "5"]),
        ("md_m,rb_deg,r\n1,2,0.1\n2,2,0.1\n", ["--column", "radius=r:m", "--to", "0.5"]),
    ],
)  # fmt: skip
def test_bad_caliper(tmp_path: Path, text: str, options: list[str], golden: Golden) -> None:
    (tmp_path / "c.csv").write_text(text)
    radius = ["--column", "radius=r"] if not any("radius=" in each for each in options) else []
    result = run("reconstruct", tmp_path / "c.csv", "--column", "depth=md_m", "--column", "toolface=rb_deg",
        *radius, *options,
                 "-o", tmp_path / "w.glb", "--bit-diameter", "8.5in")  # fmt: skip
    assert (result.exit_code, result.stdout) == (2, "")
    golden(result.stderr)
    assert [path.name for path in tmp_path.iterdir()] == ["c.csv"]


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (["--sectors", "2"], r"Invalid value for '--sectors': '2': must lie in 3 to 1000000 \(see .*"),
        (["--pitch", "0"], r"Invalid value for '--pitch': '0': must be .*not 0 .*"),
        (
            ["--pitch", "5lightyears"],
            r"Invalid value for '--pitch': '5lightyears': unit 'lightyears': not known; known are m, .*",
        ),
        (["-s", "wall.neighbors=0"], r"Invalid value for '-s wall.neighbors': '0': must lie in 1 to 256 .*"),
        (["--bit-diameter", "0"], r"Invalid value for '--bit-diameter': '0': must be finite and above 0 .*"),
        (
            ["--bit-diameter", "8.5"],
            r"Invalid value for '--bit-diameter': '8.5': must be at most 4 m; a number without "
            r"a unit is metres; did you mean 8.5in\? \(see .*",
        ),
        (["--bit-diameter", "216"], r".*did you mean 216mm\? \(see .*"),
        (["--bit-diameter", "18ft"], r"Invalid value for '--bit-diameter': '18ft': must be at most 4 m \(see .*"),
        (["--from", "2003", "--to", "2001"], r"--to 2001 m: must be deeper than --from 2003 m"),
        (["--survey", "none.csv"], r"none.csv: No such file or directory"),
        (["-o", "wall.xyz"], r"wall.xyz: the ending must be one of .glb, .ply, .obj, .stl, .vtu, .vtp, .vtkhdf, .wall"),
        (["-o", "no/such/wall.glb"], r"no/such/wall.glb: the folder no/such must exist"),
        (["--frobnicate"], r"No such option '?--frobnicate.*"),
    ],
)
def test_bad_option(folder: Path, tmp_path: Path, options: list[str], message: str) -> None:
    before = sorted(tmp_path.iterdir())
    result = run("reconstruct", folder / "caliper.csv", "-o", tmp_path / "w.glb", "--bit-diameter", "8.5in", *options)
    assert (result.exit_code, result.stdout) == (2, "")
    assert re.fullmatch(f"helibore: {message}\n", result.stderr), result.stderr
    assert sorted(tmp_path.iterdir()) == before


@pytest.mark.parametrize(
    "survey",
    [
        "1990,5,0\n1990,6,0\n",
        "1990,5,0\n2010,190,0\n",
    ],
)
def test_bad_survey(folder: Path, tmp_path: Path, survey: str, golden: Golden) -> None:
    (tmp_path / "s.csv").write_text(f"md_m,incl_deg,azim_deg\n{survey}")
    result = run("reconstruct", folder / "caliper.csv", "--survey", tmp_path / "s.csv", "-o", tmp_path / "w.glb",
                 "--bit-diameter", "8.5in")  # fmt: skip
    assert result.exit_code == 2
    golden(result.stderr)


def test_header_lines_are_options_and_settings(folder: Path, tmp_path: Path) -> None:
    caliper, survey = (
        "1,2\n" + (folder / "caliper.csv").read_text(),
        "by,me\n3,4\n" + (folder / "survey.csv").read_text(),
    )
    (tmp_path / "c.csv").write_text(caliper)
    (tmp_path / "s.csv").write_text(survey)
    options = ["-s", "header_line=2", "--survey", tmp_path / "s.csv", "-s", f"header_line={tmp_path / 's.csv'}=3",
               "--bit-diameter", "216mm"]  # fmt: skip
    made, again = tmp_path / "w.vtu", tmp_path / "again.vtu"
    assert run("reconstruct", tmp_path / "c.csv", *options, "-o", made).exit_code == 0
    assert run("reconstruct", f"{made}.toml", "-o", again).exit_code == 0
    assert again.read_bytes() == made.read_bytes()
    shown = run("inspect", tmp_path / "c.csv", "--header-line", "2")
    assert (shown.exit_code, "toolface" in shown.stdout) == (0, True)
    refused = run("inspect", tmp_path / "c.csv", "--header-line", "999")
    rule = "must be the line of the column names, within the first 500"
    assert (refused.exit_code, refused.stderr) == (2, f"helibore: c.csv: header_line = 999: {rule}\n")


@pytest.mark.parametrize(
    "given",
    [
        "x",
        "s.csv=x",
        "other.csv=3",
        "0",
    ],
)
def test_header_lines_that_are_refused(folder: Path, tmp_path: Path, given: str, golden: Golden) -> None:
    result = run("reconstruct", folder / "caliper.csv", "-s", f"header_line={given}", "--bit-diameter", "216mm", "-o",
                 tmp_path / "w.vtu")  # fmt: skip
    assert result.exit_code == 2
    golden(" ".join(result.stderr.split()).removeprefix("helibore: ").partition(" (see ")[0])


def test_header_lines_of_a_track_and_an_image(tmp_path: Path) -> None:
    seconds = range(40)
    (tmp_path / "c.csv").write_text("time_s,r_m\n" + "".join(f"{k},0.108\n" for k in seconds))
    track = "".join(f"{k},{1000 + 0.1 * k},{30 * k % 360}\n" for k in seconds)
    (tmp_path / "t.csv").write_text("run 1,by me,\n1,2,3\ntime_s,md_m,tf_deg\n" + track)
    cells = "".join(f"{1000 + 0.1 * k},1,2,3,4\n" for k in seconds)
    (tmp_path / "i.csv").write_text("run 1,,,,\n1,2,3,4,5\nmd_m,GR1_gapi,GR2_gapi,GR3_gapi,GR4_gapi\n" + cells)
    options = ["--track", tmp_path / "t.csv", "-s", f"header_line={tmp_path / 't.csv'}=3", "--bit-diameter", "216mm"]
    options += ["--image", f"{tmp_path / 'i.csv'}:GR:edge", "-s", f"header_line={tmp_path / 'i.csv'}=3"]
    made, again = tmp_path / "w.vtu", tmp_path / "again.vtu"
    result = run("reconstruct", tmp_path / "c.csv", *options, "-o", made)
    assert result.exit_code == 0, result.output
    assert (tmp_path / "w.vtu.toml").read_text().count("header_line = 3") == 2
    assert run("reconstruct", f"{made}.toml", "-o", again).exit_code == 0
    assert again.read_bytes() == made.read_bytes()
    gauge = ["--gauge", "--bit-diameter", "216mm", *options[-4:], "-s", "header_line=3", "-o", tmp_path / "g.vtu"]
    refused = run("reconstruct", *gauge)
    rule = "helibore: -s header_line=3: must be FILE=LINE, as no SOURCE is a table"
    assert (refused.exit_code, " ".join(refused.stderr.split()).partition(" (see ")[0]) == (2, rule)


def test_path_must_cover_the_wall(folder: Path, tmp_path: Path) -> None:
    (tmp_path / "s.csv").write_text("md_m,incl_deg,azim_deg\n1990,5,0\n2001,5,0\n")
    old = tmp_path / "w.glb"
    old.write_bytes(b"the old file")
    options = ["--survey", tmp_path / "s.csv", "-o", old, "--bit-diameter", "8.5in"]
    result = run("reconstruct", folder / "caliper.csv", *options)
    assert (result.exit_code, result.stdout) == (2, "")
    lines = re.fullmatch(r"helibore: s\.csv: vertex \d+ at depth ([\d.]+): must not lie below the last station of the "
                         r"survey, at 2001 m, plus extend = 0 m\n", result.stderr)  # fmt: skip
    assert lines
    assert float(lines[1]) > 2001
    assert old.read_bytes() == b"the old file"
    assert run("reconstruct", folder / "caliper.csv", *options, "-s", "path.extend=10m").exit_code == 0
    assert sorted(path.name for path in tmp_path.iterdir()) == ["s.csv", "w.glb", "w.glb.toml"]


@pytest.mark.parametrize("verb", ["demo", "reconstruct", "simulate", "mesh", "logs", "plot", "report", "view"])
def test_help_has_an_example(verb: str) -> None:
    result = run(verb, "--help")
    assert result.exit_code == 0
    assert f"helibore {verb}" in result.output.partition("Options:")[0].split("\n\n", 1)[1]
    assert max(map(len, result.output.splitlines())) <= 120


def test_version() -> None:
    assert run("--version").output == f"helibore {helibore.__version__}\n"


def test_real_process(folder: Path, tmp_path: Path, golden: Golden) -> None:
    good = real("reconstruct", folder / "caliper.csv", "-o", tmp_path / "w.glb", "--bit-diameter", "8 1/2in")
    assert (good.returncode, good.stderr) == (0, "")
    assert "vertices" in good.stdout
    quiet = real("reconstruct", folder / "caliper.csv", "-o", tmp_path / "w.glb", "--bit-diameter", "8 1/2in", "-q")
    assert (quiet.returncode, quiet.stderr, quiet.stdout) == (0, "", "")
    bad = real("reconstruct", tmp_path / "none.csv", "-o", tmp_path / "x.glb", "--bit-diameter", "8.5in")
    assert (bad.returncode, bad.stdout) == (2, "")
    assert bad.stderr == f"helibore: {tmp_path}/none.csv: No such file or directory\n"
    golden(real("dig").stderr)


def test_our_own_fault_is_exit_code_1(folder: Path, tmp_path: Path) -> None:
    program = (
        "import sys, helibore.cli, helibore.runs.wall_of_samples\n"
        "def broken(*_, **__): raise RuntimeError('lost a vertex; this is a bug in helibore')\n"
        "helibore.runs.wall_of_samples.wall_of_samples = broken\n"
        f"sys.argv = ['helibore', 'reconstruct', {str(folder / 'caliper.csv')!r}, '-o', {str(tmp_path / 'w.glb')!r}, "
        "'--bit-diameter', '8.5in']\n"
        "helibore.cli.main()\n"
    )
    result = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, timeout=PATIENCE, check=False
    )
    assert result.returncode == 1
    assert "this is a bug in helibore" in result.stderr
    assert not list(tmp_path.iterdir())


def test_the_help_of_every_command_loads_neither_numpy_nor_the_core() -> None:
    program = (
        "import sys, click, helibore.cli as of\n"
        "for verb in of.VERBS:\n"
        "    command = of.cli.get_command(None, verb)\n"
        "    command.get_help(click.Context(command))\n"
        "heavy = {'numpy', 'helibore._core', 'rich', 'matplotlib', 'scipy', 'pyarrow'} & set(sys.modules)\n"
        "sys.exit(f'loaded {heavy}' if heavy else 0)\n"
    )
    result = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, timeout=PATIENCE, check=False
    )
    assert (result.returncode, result.stderr) == (0, "")


def test_f12(tmp_path: Path) -> None:
    if not F12.exists():
        pytest.skip("shared data not beside the project: no Volve F-12 caliper")
    mesh = tmp_path / "f12.glb"
    result = run("reconstruct", F12, "--column", "diameter=pfc1_x_in@0", "--column", "diameter=pfc2_y_in@90",
        "--from", "3080",
                 "--to", "3240", "-o", mesh, "--bit-diameter", "6.2in")  # fmt: skip
    assert result.exit_code == 0, result.output
    with gzip.open(F12, "rt") as file:
        rows = [row for row in csv.DictReader(file) if 3080 <= float(row["md_m"]) <= 3240]
    of_the_file = np.mean([[float(row["pfc1_x_in"]), float(row["pfc2_y_in"])] for row in rows])
    printed = re.search(r"mean +([\d.]+) to ([\d.]+) in", result.output)  # turns have few samples
    assert printed is not None
    assert float(printed[1]) < of_the_file < float(printed[2]) < float(printed[1]) + 0.2
    scene = trimesh().load_scene(mesh)
    points = scene.to_geometry().vertices  # east, up, -north of a straight vertical hole
    assert abs(2 * np.hypot(points[:, 0], points[:, 2]).mean() / 0.0254 - of_the_file) < 0.05
    assert np.ptp(points[:, 1]) == pytest.approx(160.0, abs=0.01)
    spot = (
        "up to 12.2 mm less in radius than the merged wall, from 3165.50 to 3166.26 m in 6 rows; "
        "preparation.passes=26 shows it"
    )
    assert f"passes pass 26 (pfc2_y_in) reads {spot}" in " ".join(result.output.split())
    others = run("reconstruct", F12, "--column", "diameter=pfc1_x_in@0", "--column", "diameter=pfc2_y_in@90",
        "--from", "3080",
                 "--to", "3240", "-o", tmp_path / "others.wall", "--bit-diameter", "6.2in",
                 "--passes", "12,15,27,28,29,30,38,40,41")  # fmt: skip
    assert others.exit_code == 0, others.output
    assert "than the merged wall" not in others.output


def test_helibore_alone_shows_its_help() -> None:
    result = real()
    shown = result.stdout + result.stderr  # the latter, with exit code 2, from click 8.2 on
    assert shown.strip() == run("--help").output.replace("Usage: cli", "Usage: helibore").strip()


@pytest.mark.parametrize("verb", sorted(VERBS))
def test_the_help_of_every_verb_has_an_example_and_one_line_that_fits(verb: str) -> None:
    text = run(verb, "--help").output
    assert re.search(rf"^  helibore {verb}\b", text, re.MULTILINE)
    (line,) = re.findall(rf"^  {verb} +(.+)$", run("--help").output, re.MULTILINE)
    assert line.endswith("."), "not cut short"
    assert "..." not in line


@pytest.mark.parametrize("verb", sorted(VERBS))
def test_every_example_of_the_help_has_options_of_its_verb_with_their_values(verb: str) -> None:
    before_options = re.sub(r" *\\\n +", " ", run(verb, "--help").output.partition("\nOptions:")[0])
    examples = re.findall(rf"^  helibore ({verb}\b.*)$", before_options, re.MULTILINE)
    assert examples
    for example in examples:
        command, words = cli, shlex.split(example, comments=True)
        while isinstance(command, click.Group):
            name, *words = words
            found = command.get_command(click.Context(command), name)
            assert found, example
            command = found
        command.make_parser(click.Context(command)).parse_args(words)  # raises for another verb's option, or no value


def test_tune_builds_the_wall_with_the_settings_it_finds(folder: Path, tmp_path: Path) -> None:
    """The settings beside the output hold them, so the run is repeated without tuning."""
    mesh, again = tmp_path / "tuned.ply", tmp_path / "again.ply"
    result = run("reconstruct", folder / "caliper.csv", "-o", mesh, "--bit-diameter", "216mm", "--tune")
    assert result.exit_code == 0, result.output
    found = helibore.tune(helibore.open(folder / "caliper.csv").caliper(), bit_diameter=0.216)
    assert f"tuned {found.sentence}" in " ".join(result.output.split())
    assert found.best is not found.candidates[0]
    assert f'estimator = "{found.settings.estimator}"' in mesh.with_name("tuned.ply.toml").read_text()
    repeated = run("reconstruct", mesh.with_name("tuned.ply.toml"), "-o", again, "-q")
    assert repeated.exit_code == 0, repeated.output
    assert again.read_bytes() == mesh.read_bytes()


def test_reconstruct_takes_the_estimator_that_suits_the_samples(folder: Path, tmp_path: Path) -> None:
    """Without an option; the settings beside the output repeat the wall, and inverse distance has its own by name."""
    caliper, size = folder / "caliper.csv", ("--bit-diameter", "216mm")
    result = real("reconstruct", caliper, "-o", tmp_path / "wall.ply", *size)
    found = re.search(r"^estimator +(.*)$", result.stdout, re.MULTILINE)
    assert found
    assert "inverse distance" in found[1]
    stated = (tmp_path / "wall.ply.toml").read_text()
    assert re.search(r'^estimator = "(kriging|near-and-far)"', stated, re.MULTILINE)
    again = run("reconstruct", tmp_path / "wall.ply.toml", "-o", tmp_path / "again.ply", "-q")
    assert again.exit_code == 0, again.output
    assert (tmp_path / "again.ply").read_bytes() == (tmp_path / "wall.ply").read_bytes()


def test_tune_does_not_go_with_what_it_finds(folder: Path) -> None:
    result = run(
        "reconstruct", folder / "caliper.csv", "-o", "w.ply", "--bit-diameter", "216mm", "--tune", "-s", "wall.nugget=1"
    )
    assert result.exit_code == 2
    assert "-s wall.nugget: does not go with --tune, which finds it" in result.output


def test_sigma_is_an_attribute_of_archives_and_meshes(folder: Path, tmp_path: Path) -> None:
    archive = tmp_path / "w.wall"
    made = run(
        "reconstruct", folder / "caliper.csv", "-o", archive, "--bit-diameter", "216mm", "-s", "mesh.sigma=true", "-q"
    )
    assert made.exit_code == 0, made.output
    wall = helibore.load(archive)
    assert wall.attributes.units["sigma"] == "m"
    corners = wall.sigma[[0, 1, 65, 64]]
    assert wall.attributes["sigma"][0] == pytest.approx(corners.mean(), rel=1e-12)
    colored = run("mesh", archive, "-o", tmp_path / "w.glb", "--color-by", "sigma")
    assert colored.exit_code == 0, colored.output
    assert "of the wall has no sigma" not in made.output
    few = tmp_path / "few.csv"
    few.write_text("\n".join((folder / "caliper.csv").read_text().splitlines()[:40]))
    result = run("reconstruct", few, "-o", archive, "--bit-diameter", "216mm", "-s", "mesh.sigma=true")
    assert result.exit_code == 2
    assert "too few samples for an uncertainty: must be at least 100" in " ".join(result.output.split())


def test_nearest_is_an_attribute_of_meshes(folder: Path, tmp_path: Path) -> None:
    mesh = tmp_path / "w.vtu"
    made = run("reconstruct", folder / "caliper.csv", "-o", mesh, "--bit-diameter", "216mm", "-s", "mesh.nearest=true")
    assert made.exit_code == 0, made.output
    archive = run("reconstruct", f"{mesh}.toml", "-o", tmp_path / "w.wall", "-q")
    assert archive.exit_code == 0, archive.output
    wall = helibore.load(tmp_path / "w.wall")
    assert wall.attributes["nearest"][0] == pytest.approx(wall.nearest[[0, 1, 65, 64]].mean(), rel=1e-12)
    assert wall.attributes.units["nearest"] == "m"
    colored = run("mesh", tmp_path / "w.wall", "-o", tmp_path / "w.glb", "--color-by", "nearest")
    assert colored.exit_code == 0, colored.output
    volume = run("mesh", tmp_path / "w.wall", "-o", tmp_path / "v.vtu", "--shell", "2cm", "--measured")
    assert volume.exit_code == 0, volume.output
    text = (tmp_path / "v.vtu").read_bytes()
    assert b'Name="nearest"' in text
    assert b'Name="measured"' in text
    quads = f"{np.count_nonzero(np.isfinite(wall.attributes['nearest'])):,}"
    words = " ".join(volume.output.split())
    K = wall.settings.sectors
    first = np.flatnonzero(np.isfinite(wall.attributes["nearest"]))
    sure = np.count_nonzero(wall.measured[first[:, None] + [0, 1, K, K + 1]].all(axis=1))
    assert sure > 0.9 * first.size
    assert f"measured {sure:,} of {quads} cells are measured at each corner" in words
    gauge = ("--gauge", "--bit-diameter", "216mm", "--from", "10m", "--to", "12m", "--measured")
    refused = run("mesh", *gauge, "-o", tmp_path / "g.glb")
    rule = "--measured: needs a shape that was measured; this wall: gauge hole at bit size: not measured"
    assert (refused.exit_code, rule in " ".join(refused.output.split())) == (2, True)
