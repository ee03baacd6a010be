"""Runs: settings beside the mesh, repeated to the last bit; a changed input is refused; every format in, one path."""

from __future__ import annotations

import html
import re
import tomllib
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from command import run
from golden_texts import Golden

import helibore as hb
from helibore.files.facts import read_facts
from helibore.files.table_writing import write_table
from helibore.preparation.passes import difference
from helibore.runs.project import Input, Output, Project, project_file, read_project, write_project
from helibore.runs.run import OpenFiles, Run, add_images, checksum, make_wall, open_run, preparation_lines
from helibore.simulation.tool import Hole, Lift, Tool, simulate


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Samples of 3 m of hole with a lift, by time, and a survey."""
    folder = tmp_path_factory.mktemp("run")
    simulation = simulate(Hole.example(2000.0, 2003.0, seed=5), Tool(lifts=(Lift(2002.0, 1.0),)), samples=3000, seed=5)
    columns = {name: getattr(simulation, name) for name in ("time", "depth", "toolface", "radius")}
    units = {"time": "s", "depth": "m", "toolface": "deg", "radius": "m"}
    write_table(folder / "c.csv", {f"{name}_{units[name]}": (values, 9) for name, values in columns.items()})
    np.savez(folder / "c.npz", **columns)
    (folder / "s.csv").write_text("md_m,incl_deg,azim_deg\n1990,5,40\n2010,7,50\n")
    return folder


@pytest.mark.parametrize(
    ("file", "name"),
    [("a.csv.gz", "a"), ("run.1.csv", "run.1"), ("15.9-F-12.LAS.GZ", "15.9-F-12"), ("a", "a"), (".a.wall", ".a")],
)
def test_a_run_has_the_name_of_its_file_without_the_ending(file: str, name: str) -> None:
    settings = Project(archive=Input(Path("folder.1") / file))
    assert Run(settings, OpenFiles(())).name == name


def test_two_images_of_one_name_are_both_kept(golden: Golden) -> None:
    wall = hb.reconstruct(hb.Caliper([1.0, 2.0], [0.0, 90.0], [0.1, 0.1]), bit_diameter=0.2, sectors=4)
    images = [
        hb.SectorImage([1.0, 2.0], [[value] * 4] * 2, "GR", origin="edge", reference="north")
        for value in (1.0, 2.0, 3.0)
    ]
    golden(add_images(wall, images))
    assert {name: image.values[0, 0] for name, image in wall.images.items()} == {"GR": 1.0, "GR:2": 2.0, "GR:3": 3.0}


def test_a_run_is_repeated_to_the_last_bit(folder: Path, tmp_path: Path) -> None:
    mesh, again = tmp_path / "w.glb", tmp_path / "again.glb"
    first = run(
        "reconstruct", folder / "c.csv", "--survey", folder / "s.csv", "-o", mesh, "--bit-diameter", "216mm",
        "--sectors", 32, "-s", "preparation.least_radius=50mm", "-s",
        "preparation.greatest_radius=300mm", "--recentre",
        "-s", "preparation.reversal=0.5m",
        "--find-shifts", "--bias", "arm", "--earlier", 1, "-s", "mesh.color_by=difference",
        "-s", "path.reference=parallel-transport",
        "-s", "preparation.toolface_from=automatic", "-s", "wall.max_distance=none", "--centres",
            tmp_path / "centres.csv",
    )  # fmt: skip
    assert first.exit_code == 0, first.output
    second = run("reconstruct", project_file(mesh), "-o", again)
    assert second.exit_code == 0, second.output
    assert again.read_bytes() == mesh.read_bytes()
    assert re.search(r"repeated +to the last bit", second.output)
    for label in ("range", "turns", "passes", "shift", "toolface", "recentre", "bias", "difference"):
        assert f"\n{label} " in first.output, label
    settings = read_project(project_file(mesh))
    third = make_wall(open_run(settings))
    surface = third.wall.surface()
    surface.save(tmp_path / "third.glb", color_by="difference")
    assert (tmp_path / "third.glb").read_bytes() == mesh.read_bytes()
    assert settings.output == Output(mesh, checksum(mesh))
    assert settings.wall is not None
    assert (settings.wall.max_distance, settings.wall.sectors) == (None, 32)
    assert settings.preparation.earlier == (1,)
    centres = hb.open(tmp_path / "centres.csv").set()
    assert third.prepared is not None
    assert third.prepared.centres is not None
    np.testing.assert_allclose(centres["x_m"].values, third.prepared.centres.x, atol=1e-7)
    assert {"sigma_x_m", "inliers", "samples"} <= set(centres.names)
    assert third.prepared.earlier is not None
    earlier = hb.reconstruct(third.prepared.earlier, **vars(settings.wall))
    larger, k = difference(earlier, third.wall), np.arange(len(surface.quads))
    expected = np.mean([larger[k], larger[k + 1], larger[k + 32], larger[k + 33]], axis=0)
    np.testing.assert_allclose(surface.attributes["difference"], expected, rtol=0, atol=1e-15)


def test_settings_survive_and_stay_beside_their_files(folder: Path, tmp_path: Path) -> None:
    for name in ("c.csv", "s.csv"):
        (tmp_path / name).write_bytes((folder / name).read_bytes())
    mesh = tmp_path / "w.ply"
    result = run(
        "reconstruct", tmp_path / "c.csv", "--survey", tmp_path / "s.csv", "-o", mesh, "--bit-diameter", "216mm", "-q"
    )
    assert (result.exit_code, result.output) == (0, "")
    settings = read_project(project_file(mesh))
    assert [one.file for one in settings.inputs] == [tmp_path / "c.csv", tmp_path / "s.csv"]
    write_project(tmp_path / "other.toml", settings)
    assert read_project(tmp_path / "other.toml") == settings
    moved = tmp_path.with_name(f"{tmp_path.name}-moved")
    tmp_path.rename(moved)
    again = run("reconstruct", moved / "w.ply.toml", "-o", moved / "again.ply")
    assert again.exit_code == 0, again.output
    assert (moved / "again.ply").read_bytes() == (moved / "w.ply").read_bytes()
    roles = tomllib.loads((moved / "w.ply.toml").read_text())["caliper"][0]["channel"]
    assert [role["role"] for role in roles] == ["time", "depth", "toolface", "radius"]


def test_a_changed_input_is_refused(folder: Path, tmp_path: Path) -> None:
    (tmp_path / "c.csv").write_bytes((folder / "c.csv").read_bytes())
    assert (
        run("reconstruct", tmp_path / "c.csv", "-o", tmp_path / "w.stl", "--bit-diameter", "216mm", "-q").exit_code == 0
    )
    before = checksum(tmp_path / "c.csv")
    with (tmp_path / "c.csv").open("a") as file:
        file.write("1,2001,3,0.1\n")
    again = run("reconstruct", tmp_path / "w.stl.toml", "-o", tmp_path / "again.stl")
    assert (again.exit_code, again.stdout) == (2, "")
    assert again.stderr == (
        f"helibore: {tmp_path}/c.csv: has changed since the run: its BLAKE2b is {checksum(tmp_path / 'c.csv')}, the "
        f"settings have {before}; only the same file repeats the run\n"
    )
    assert not (tmp_path / "again.stl").exists()
    (tmp_path / "c.csv").unlink()
    gone = run("reconstruct", tmp_path / "w.stl.toml", "-o", tmp_path / "again.stl")
    assert (gone.exit_code, gone.stderr) == (2, f"helibore: {tmp_path}/c.csv: No such file or directory\n")


def test_the_command_line_counts_over_what_helibore_wrote(folder: Path, tmp_path: Path, golden: Golden) -> None:
    """Such a run is another one: no bytes are compared. Options that change no byte leave the run as it was."""
    assert (
        run("reconstruct", folder / "c.npz", "-o", tmp_path / "w.glb", "--bit-diameter", "216mm", "-q").exit_code == 0
    )
    again = ("reconstruct", tmp_path / "w.glb.toml", "-o", tmp_path / "x.glb")
    changed = run(*again, "--sectors", "8", "-s", "preparation.recentre=true")
    assert changed.exit_code == 0, changed.output
    assert "not compared" in changed.output
    project = read_project(tmp_path / "x.glb.toml")
    assert project.wall is not None
    assert (project.wall.sectors, project.wall.bit_diameter, project.preparation.recentre) == (8, 0.216, True)
    refused = run(*again, "--gauge")
    golden(refused.stderr)
    assert run(*again, "--threads", 1, "-q").exit_code == 0
    assert (tmp_path / "x.glb").read_bytes() == (tmp_path / "w.glb").read_bytes()


@pytest.mark.parametrize(
    ("old", "new", "rule"),
    [
        ("sectors = 64", "sectors = 6.5", "wall.sectors = 6.5: must be an integer"),
        ("sectors = 64", "sektors = 64", "wall.sektors: not known; did you mean sectors?"),
        ("recentre = false", "recentre = 0", "preparation.recentre = 0: must be true or false"),
        ('bias = "none"', 'bias = "tool"', "preparation.bias = 'tool': must be one of none, arm, side"),
        ("head = [\n    0.0,\n    0.0,\n    0.0,\n]", "head = 3", "path.head = 3: must be a list"),
        ("head = [\n    0.0,\n    0.0,\n    0.0,\n]", "head = [1.0]", "path.head = [1.0]: must be a list of 3"),
        ("minimum-curvature", "x", "path.method = 'x': must be one of minimum-curvature, radius-of-curvature"),
        ("[path]", '[path]\nreference = "up"', "path.reference = 'up': must be one of high-side, north, parallel-tr"),
        ("[wall]", "[wail]", "wail: not known; did you mean wall?"),
        ('role = "toolface"', 'role = "tf"', "caliper 1: channel toolface: role = 'tf': must be one of depth, time"),
        ('role = "radius"', 'roll = "radius"', "caliper 1.channel 4.roll: not known; did you mean role?"),
        ("bit_diameter = 0.216", "", "wall.bit_diameter: is missing"),
        ("nulls", "nulls = [1", "not TOML"),
    ],
)
def test_bad_settings(folder: Path, tmp_path: Path, old: str, new: str, rule: str) -> None:
    assert (
        run("reconstruct", folder / "c.npz", "-o", tmp_path / "w.glb", "--bit-diameter", "216mm", "-q").exit_code == 0
    )
    text = (tmp_path / "w.glb.toml").read_text()
    assert old in text
    (tmp_path / "bad.toml").write_text(text.replace(old, new, 1))
    result = run("reconstruct", tmp_path / "bad.toml", "-o", tmp_path / "x.glb")
    assert result.exit_code == 2, result.exception
    assert re.match(rf"helibore: bad\.toml(, line \d+)?: {re.escape(rule)}", result.stderr), result.stderr
    assert not (tmp_path / "x.glb").exists()


def loaded(folder: Path) -> dict[str, np.ndarray]:
    with np.load(folder / "c.npz") as arrays:
        return dict(arrays)


def written(folder: Path, tmp_path: Path, kind: str) -> tuple[Path, list[object]]:
    """The same samples in another format, and the options it takes to read them."""
    arrays = loaded(folder)
    columns = {name: arrays[name] for name in ("depth", "toolface", "radius")}
    path = tmp_path / f"c.{kind}"
    if kind == "parquet":
        pa = pytest.importorskip("pyarrow")
        from pyarrow import parquet

        parquet.write_table(pa.table(columns), path)
        return path, []
    table = np.column_stack(list(columns.values()))
    curves = "DEPT.M : depth\nTF.DEG : toolface\nRADIUS.M : radius\n"
    if kind == "las":
        pytest.importorskip("lasio")
        head = "~V\nVERS. 2.0 :\nWRAP. NO :\n~W\nSTRT.M 0 :\nSTOP.M 0 :\nSTEP.M 0 :\nNULL. -999.25 :\n~C\n"
        rows = "".join(" ".join(repr(float(cell)) for cell in row) + "\n" for row in table)
        path.write_text(f"{head}{curves}~A\n{rows}")
        return path, []
    if kind == "las3":
        head = "~Version\nVERS. 3.0 :\nWRAP. NO :\nDLM. COMMA :\n~Well\nNULL. -999.25 :\n~Log_Definition\n"
        rows = "".join(",".join(repr(float(cell)) for cell in row) + "\n" for row in table)
        path.write_text(f"{head}{curves}~Log_Data | Log_Definition\n{rows}")
        return path, []
    if kind == "json":
        import json

        curves_of = [{"name": n, "unit": u, "valueType": "float", "dimensions": 1}
                     for n, u in (("MD", "m"), ("TF", "deg"), ("radius", "m"))]  # fmt: skip
        path.write_text(json.dumps([{"header": {"name": "w"}, "curves": curves_of, "data": table.tolist()}]))
        return path, []
    rows = "".join(f"<data>{','.join(repr(float(cell)) for cell in row)}</data>" for row in table)
    path.write_text(
        '<logs xmlns="http://www.witsml.org/schemas/1series" version="1.4.1.1"><log><name>x</name>'
        "<indexCurve>MD</indexCurve><logData><mnemonicList>MD,TF,RADIUS</mnemonicList><unitList>m,deg,m</unitList>"
        f"{rows}</logData></log></logs>"
    )
    return path, []


def test_an_archive_keeps_what_preparation_left_out_and_corrected(folder: Path, tmp_path: Path) -> None:
    archive, page, logs = (tmp_path / name for name in ("w.wall", "w.html", "w.csv"))
    first = run("reconstruct", folder / "c.csv", "-o", archive, "--bit-diameter", "216mm", "--recentre")
    assert first.exit_code == 0, first.output
    lines = preparation_lines(hb.load(archive))
    assert "recentre" in dict(lines)
    for command, *given in (("report", "-o", page, "--dpi", 40, "--no-body", "--no-polar"), ("logs", "-o", logs)):
        done = run(command, archive, *given)
        assert done.exit_code == 0, done.output
        assert "archive of a wall" in done.output
        assert "\nrecentre " in done.output
    for number, (label, text) in enumerate(lines, 1):
        assert f"<tr><th>{label}</th><td>{html.escape(text)}</td></tr>" in page.read_text()
        assert read_facts(logs)[0][f"prepared {number}"] == f"{label} {text}"
    assert "made from: preparation" not in page.read_text()
    foreign = hb.Wall(bit_diameter=0.216)
    for kept in ({}, {"preparation": "none"}, {"preparation": [1, ["a"]]}):
        foreign.made_from = kept
        assert preparation_lines(foreign) == []


def without_origin(mesh: Path) -> bytes:
    """A PLY file but for the line that names the files it was made from."""
    before, found, after = mesh.read_bytes().partition(b"comment helibore: made_from: ")
    assert found
    return before + after.partition(b"\n")[2]


@pytest.mark.parametrize("kind", ["parquet", "las", "las3", "json", "xml"])
def test_every_format_is_one_path(folder: Path, tmp_path: Path, kind: str) -> None:
    path, options = written(folder, tmp_path, kind)
    result = run("reconstruct", path, *options, "-o", tmp_path / "w.ply", "--bit-diameter", "216mm")
    assert result.exit_code == 0, result.output
    arrays = loaded(folder)
    wall = hb.reconstruct(hb.Caliper(arrays["depth"], arrays["toolface"], arrays["radius"]), bit_diameter=0.216)
    wall.surface().save(tmp_path / "expected.ply")
    assert without_origin(tmp_path / "w.ply") == (tmp_path / "expected.ply").read_bytes()


def test_dlis_is_on_the_path_too(folder: Path, tmp_path: Path) -> None:
    pytest.importorskip("dlisio")
    dliswriter = pytest.importorskip("dliswriter")
    arrays = loaded(folder)
    file = dliswriter.DLISFile()
    logical = file.add_logical_file()
    logical.add_origin("O", file_set_number=1)
    units = {"depth": "m", "toolface": "deg", "radius": "m"}
    channels = [logical.add_channel(n.upper(), data=arrays[n].astype(np.float64), units=u) for n, u in units.items()]
    logical.add_frame("MAIN", channels=channels)
    file.write(str(tmp_path / "c.dlis"), output_chunk_size=2**20)  # the default zeroes 4 GiB
    result = run("reconstruct", tmp_path / "c.dlis", "-o", tmp_path / "w.ply", "--bit-diameter", "216mm")
    assert result.exit_code == 0, result.output
    wall = hb.reconstruct(hb.Caliper(*(arrays[n] for n in units)), bit_diameter=0.216)
    wall.surface().save(tmp_path / "expected.ply")
    assert without_origin(tmp_path / "w.ply") == (tmp_path / "expected.ply").read_bytes()


def test_a_map_overrules_and_several_files_are_passes(folder: Path, tmp_path: Path, golden: Golden) -> None:
    rows = (folder / "c.csv").read_text().splitlines()
    half = len(rows) // 2
    (tmp_path / "a.csv").write_text("\n".join(["t,odd,b,c", *rows[1:half]]))
    (tmp_path / "b.csv").write_text("\n".join(["t,odd,b,c", *rows[half:]]))
    (tmp_path / "m.toml").write_text(
        '[channels.t]\nrole = "time"\nunit = "s"\n[channels.odd]\nrole = "depth"\nunit = "m"\n'
        '[channels.b]\nrole = "toolface"\nunit = "deg"\n[channels.c]\nrole = "radius"\nunit = "m"\n'
    )
    files = (tmp_path / "a.csv", tmp_path / "b.csv", "--map", tmp_path / "m.toml", "--bit-diameter", "216mm")
    assert run("reconstruct", *files, "-o", tmp_path / "w.ply", "-q").exit_code == 0
    assert (
        run("reconstruct", folder / "c.csv", "--bit-diameter", "216mm", "-o", tmp_path / "one.ply", "-q").exit_code == 0
    )
    assert without_origin(tmp_path / "w.ply") == without_origin(tmp_path / "one.ply")
    result = run("reconstruct", *files, "-o", tmp_path / "l.ply", "--earlier", 1)
    assert result.exit_code == 0, result.output
    assert "difference  this wall minus the wall of the earlier passes: " in result.output
    again = run("reconstruct", tmp_path / "l.ply.toml", "-o", tmp_path / "l2.ply", "-q")
    assert again.exit_code == 0, again.output
    assert (tmp_path / "l2.ply").read_bytes() == (tmp_path / "l.ply").read_bytes()
    wrong = run(
        "reconstruct", *files, "--map", tmp_path / "m.toml", "--map", tmp_path / "m.toml", "-o", tmp_path / "x.ply"
    )
    assert wrong.exit_code == 2
    golden(wrong.stderr)


def test_track_and_travel_times_on_the_command_line(tmp_path: Path, golden: Golden) -> None:
    time = np.arange(3000) * 0.1
    depth, turn = 100 + 0.002 * time, time * 77.0 % 360
    np.savez(tmp_path / "track.npz", time=time, depth=depth, toolface=turn)
    echo = 2 * (0.108 - 0.045) / 1500.0 * 1e6
    rows = "".join(f"{t:.3f},{echo + 0.5 * np.sin(t):.4f}\n" for t in time[50:-50])
    (tmp_path / "c.csv").write_text(f"time_s,tt_us\n{rows}")
    base = ("reconstruct", tmp_path / "c.csv", "--track", tmp_path / "track.npz", "--bit-diameter", "216mm")
    result = run(
        *base,
        "-s",
        "echo.velocity=1500",
        "-s",
        "echo.tool_radius=45mm",
        "-s",
        "preparation.latency=0.2s",
        "-o",
        tmp_path / "w.ply",
    )
    assert result.exit_code == 0, result.output
    assert "tt_us is travel-time in us" in result.output
    again = run("reconstruct", tmp_path / "w.ply.toml", "-o", tmp_path / "again.ply")
    assert again.exit_code == 0, again.output
    assert (tmp_path / "again.ply").read_bytes() == (tmp_path / "w.ply").read_bytes()
    lacking = run(*base, "-o", tmp_path / "x.ply")
    assert (lacking.exit_code, lacking.stdout) == (2, "")
    golden(lacking.stderr)
    half = run(*base, "-s", "echo.velocity=1500", "-o", tmp_path / "x.ply")
    golden(half.stderr)


def test_maps_of_survey_and_track(folder: Path, tmp_path: Path) -> None:
    with np.load(folder / "c.npz") as archive:
        samples = dict(archive)
    np.savetxt(tmp_path / "c.csv", np.column_stack([samples["time"], samples["radius"]]), delimiter=",",
               header="time_s,radius_m", comments="")  # fmt: skip
    np.savetxt(tmp_path / "t.csv", np.column_stack([samples[n] for n in ("time", "depth", "toolface")]), delimiter=",",
               header="when,how deep,which way", comments="")  # fmt: skip
    (tmp_path / "s.csv").write_text("at,tilt,heading\n6500,5,40\n6700,7,50\n")
    maps = {
        "s": {"at": ("depth", "ft"), "tilt": ("inclination", "deg"), "heading": ("azimuth", "deg")},
        "t": {"when": ("time", "s"), "how deep": ("depth", "m"), "which way": ("toolface", "deg")},
    }
    for name, roles in maps.items():
        entries = [f'[channels."{key}"]\nrole = "{role}"\nunit = "{unit}"\n' for key, (role, unit) in roles.items()]
        (tmp_path / f"{name}.toml").write_text("\n".join(entries))
    base = ("reconstruct", tmp_path / "c.csv", "--track", tmp_path / "t.csv", "--survey", tmp_path / "s.csv")
    maps_of = (
        "-s",
        f"track.map={tmp_path / 't.toml'}",
        "-s",
        f"survey.map={tmp_path / 's.toml'}",
        "--bit-diameter",
        "216mm",
    )
    result = run(*base, *maps_of, "-o", tmp_path / "w.vtu")
    assert result.exit_code == 0, result.output
    assert "at is depth in ft: the map" in result.output
    assert "how deep is depth in m: the map" in result.output
    again = run("reconstruct", tmp_path / "w.vtu.toml", "-o", tmp_path / "again.vtu", "-q")
    assert again.exit_code == 0, again.output
    assert (tmp_path / "again.vtu").read_bytes() == (tmp_path / "w.vtu").read_bytes()


def test_the_settings_of_another_version_are_read(folder: Path, tmp_path: Path) -> None:
    assert (
        run("reconstruct", folder / "c.npz", "-o", tmp_path / "w.glb", "--bit-diameter", "216mm", "-q").exit_code == 0
    )
    settings = read_project(tmp_path / "w.glb.toml")
    settings = replace(settings, helibore="99.0", output=Output(tmp_path / "w.glb", "0" * 64))
    write_project(tmp_path / "old.toml", settings)
    result = run("reconstruct", tmp_path / "old.toml", "-o", tmp_path / "x.glb")
    assert result.exit_code == 0
    assert re.search(r"repeated +with other bytes: another version or machine wrote it", result.output)


SPOILED = {
    "tf_deg": (lambda text: re.sub(r",(\d+\.\d+),", lambda m: f",{float(m[1]) / 57.2957795:.6f},", text),
               "values between 0 and 6.23 deg: looks like radians; state the unit in a map or as tf_deg:rad"),
    "everywhere": (lambda text: re.sub(r"(?m)^\d+\.\d+", "1000.0", text),
                   "no quads: no two turns of the wall lie side by side between 1000 and 1000 m, at 0.1 m a turn"),
    "furlong": (lambda text: text.replace("md_m", "md [furlong]"), "'furlong' is no known unit of length"),
    "cut": (lambda text: text[:-12], "line 201: truncated: 2 values where 3 columns are defined"),
}  # fmt: skip


def plain() -> str:
    rows = "".join(f"{1000 + n * 0.01:.3f},{n * 33.0 % 360:.4f},0.108\n" for n in range(200))
    return f"md_m,tf_deg,radius_m\n{rows}"


@pytest.mark.parametrize("what", SPOILED)
def test_spoiled_files_say_what_is_wrong(tmp_path: Path, what: str) -> None:
    spoil, rule = SPOILED[what]
    (tmp_path / "c.csv").write_text(spoil(plain()))
    columns = ("--column", "depth=md_m", "--column", "toolface=tf_deg") if what in ("tf_deg", "everywhere") else ()
    result = run("reconstruct", tmp_path / "c.csv", *columns, "-o", tmp_path / "w.glb", "--bit-diameter", "216mm")
    assert (result.exit_code, result.stdout) == (2, "")
    assert rule in result.stderr
    assert result.stderr.startswith("helibore: c.csv")
    assert [path.name for path in tmp_path.iterdir()] == ["c.csv"]


def test_depths_that_fall_or_repeat_are_reported(tmp_path: Path, golden: Golden) -> None:
    rows = plain().splitlines()
    (tmp_path / "c.csv").write_text("\n".join([rows[0], *rows[:0:-1], rows[1], rows[1].replace("0.108", "0.109")]))
    result = run("reconstruct", tmp_path / "c.csv", "-o", tmp_path / "w.glb", "--bit-diameter", "216mm")
    assert result.exit_code == 0
    assert "md_m: falls: logged upwards" in result.output
    assert "md_m: 2 rows repeat the depth of the row before" in result.output
    lacking = run(
        "reconstruct",
        tmp_path / "c.csv",
        "-o",
        tmp_path / "x.glb",
        "--bit-diameter",
        "1m",
        "-s",
        "path.reference=parallel-transport",
    )
    golden(lacking.stderr)


@pytest.mark.parametrize(
    ("head", "first", "options", "said"),
    [
        (
            "md_m,inc_deg,azi_deg", "990,3,20", (),
            "at 990 m, as if it were (0, 0, 0); path.head says where it lies",
        ),
        ("md_m,inc_deg,azi_deg", "990,3,20", ("-s", "path.head=0m,0m,900m"), ""),
        ("md_m,inc_deg,azi_deg", "0,3,20", (), ""),
        ("md_m,inc_deg,azi_deg,n_m,e_m,tvd_m", "0,3,20,0,0,0", (), ""),
        (
            "md_m,inc_deg,azi_deg,n_m,e_m,tvd_m", "0,3,20,29.293,2.087,0", (),
            "at 0 m, as if it were (0, 0, 0); the file states north 29.293, east 2.087, down 0 m; "
            "path.head=29.293,2.087,0 sets these",
        ),
        (
            "md_ft,inc_deg,azi_deg,n_ft,e_ft,tvd_ft", "100,3,20,10,20,99", (),
            "at 30.48 m, as if it were (0, 0, 0); the file states north 3.048, east 6.096, down 30.1752 m; "
            "path.head=3.048,6.096,30.1752 sets these",
        ),
    ],
)  # fmt: skip
def test_where_a_survey_counts_from_is_reported(
    tmp_path: Path, head: str, first: str, options: tuple[str, ...], said: str
) -> None:
    """TVD of a survey that begins at 990 m MD is not from the surface, unless the head says where that is."""
    (tmp_path / "c.csv").write_text(plain())
    last = ",".join(["9000", "4", "30", *["5"] * (len(head.split(",")) - 3)])
    (tmp_path / "s.csv").write_text(f"{head}\n{first}\n{last}\n")
    result = run(
        "reconstruct", tmp_path / "c.csv", "--survey", tmp_path / "s.csv", *options, "-o", tmp_path / "w.glb",
        "--bit-diameter", "216mm",
    )  # fmt: skip
    assert result.exit_code == 0, result.output
    words = " ".join(result.output.split())
    assert ("positions count from the first station" in words) == bool(said)
    assert said in words
