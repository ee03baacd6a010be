"""``helibore view``: from a caliper file to a page that answers, and what it says when it cannot."""

from __future__ import annotations

import json
import re
import signal
import subprocess
import sys
import urllib.error
import urllib.request
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from click.testing import CliRunner, Result
from golden_texts import Golden
from patience import PATIENCE

pytest.importorskip("uvicorn", reason='the viewer needs the extra: pip install "helibore[view]"')

from helibore.cli import cli
from helibore.viewer.page_files import page

BIT = ("--bit-diameter", "8.5in")
MEMORY = """~Version
VERS. 2.0 :
WRAP. NO :
~Well
STRT.m 500 :
STOP.m 504 :
STEP.m 1 :
NULL. -999.25 :
COMP. Deep Rock : Company
DATE.DD/MM/YYYY21/05/2007 : Date
~Curve
DEPTH.m :
INNM.deg : Inclination
{curves}~A
{rows}""".format(
    curves="".join(f"GRAS{sector}M.API :\n" for sector in range(8)),
    rows="".join(f"{500 + row} 60 {' '.join(str(20 + row + sector) for sector in range(8))}\n" for row in range(5)),
).encode()
IMAGES_ONLY = (
    "has images (GRAS) and no known caliper around the hole (--column radius=NAME or diameter=NAME states one). "
    "This command puts the "
    "images on a gauge hole. With edge, sector 1 starts at toolface 0; with centre, it is centred there. Only the "
    "tool's manual says which is right; the other word turns GRAS by 22.5 deg"
)
"""A file with images, an inclination and no caliper, as a logging company writes it."""
INTERRUPTIBLE = "import signal; signal.signal(signal.SIGINT, signal.default_int_handler)"  # a background job ignores it
HELIBORE = [sys.executable, "-c", f"{INTERRUPTIBLE}; from helibore.cli import main; main()"]


@pytest.fixture
def caliper(tmp_path: Path) -> Path:
    rng = np.random.default_rng(2)
    depth = 500 + np.sort(rng.uniform(0, 5, 4000))
    rows = np.column_stack([depth, rng.uniform(0, 360, 4000), rng.uniform(0.108, 0.115, 4000)])
    path = tmp_path / "caliper.csv"
    np.savetxt(path, rows, delimiter=",", header="depth_m,toolface_deg,radius_m", comments="", fmt="%.6f")
    return path


def run(*arguments: str) -> Result:
    """Run the command in this process: it must fail before it serves."""
    return CliRunner().invoke(cli, ["view", *arguments])


@pytest.mark.skipif(page("app.js") is None, reason="the page is not built: Node.js 18 was not there")
def test_the_page_of_the_whole_wall_as_one_file(caliper: Path, tmp_path: Path) -> None:
    written = tmp_path / "well.html"
    said = run(str(caliper), *BIT, "--html", str(written))
    assert said.exit_code == 0, said.output
    assert re.search(r"wrote +\S*well.html, \d", said.output)
    found = re.search(r'id="enclosed">(.*?)</script>', written.read_text())
    assert found is not None
    enclosed = json.loads(found[1])
    assert enclosed["state"]["ended"]
    assert (enclosed["summary"]["start"], enclosed["summary"]["stop"]) == pytest.approx((500, 505), abs=0.2)
    assert len(enclosed["messages"]) > 1


def test_a_hole_that_only_carries_images_has_a_turn_for_each_of_their_rows(
    caliper: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    walls = []

    def seen(wall: Any, **_: object) -> None:
        walls.append(wall)
        raise ValueError("seen")

    monkeypatch.setattr("helibore.viewer.view", seen)
    monkeypatch.setattr("helibore.cli.view_command.check_page", lambda: None)  # the page may be not built
    depth = 500 + 0.02 * np.arange(200)
    file = tmp_path / "image.npz"
    np.savez(file, depth_m=depth, amplitude=np.arange(200.0 * 90).reshape(200, 90))
    image = ("--image", f"{file}:amplitude:centre", *BIT)
    run("--gauge", *image)
    fine = walls.pop()
    assert (fine.settings.sectors, fine.settings.pitch) == (90, 0.02)
    shown = fine.images["amplitude"].on(fine)
    assert np.unique(shown).size == shown.size == 198 * 90, "no value twice: of all rows but the first"
    for more in (("--gauge", "-s", "wall.sectors=32"), (str(caliper),)):
        said = " ".join(run(*more, *image).output.split())
        assert walls.pop().settings.pitch == 0.1
        assert "wall.pitch=0.02m shows every row" in said, said
    turn, along = np.meshgrid(np.arange(0.0, 360.0, 6.0), depth)
    dense = tmp_path / "dense.csv"
    columns = along.ravel(), turn.ravel(), np.full(turn.size, 108.0)
    np.savetxt(dense, np.transpose(columns), delimiter=",", header="depth_m,toolface_deg,radius_mm", comments="")
    said = " ".join(run(str(dense), *image).output.split())
    assert (walls[-1].settings.sectors, walls.pop().settings.pitch) == (90, 0.02), "60 samples a row are enough"
    assert "has a row each 0.02 m, and so has the wall a turn, of 90 sectors" in said


@pytest.mark.skipif(page("app.js") is None, reason="the page is not built: Node.js 18 was not there")
def test_it_serves_until_interrupted(caliper: Path) -> None:
    command = [*HELIBORE, "view", str(caliper), "--bit-diameter", "216mm", "--no-browser", "-q"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
        try:
            assert process.stdout is not None
            url = process.stdout.readline().split()[0]
            with urllib.request.urlopen(url.replace("/?", "/healthz?")) as answer:
                said = json.load(answer)
            assert said["page_built"]
            assert 3000 < said["vertices"] < 3300
            with urllib.request.urlopen(url) as answer:
                assert "<canvas" in answer.read().decode()
        finally:
            process.send_signal(signal.SIGINT)
        assert process.wait(PATIENCE) == 0


@pytest.mark.skipif(page("app.js") is None, reason="the page is not built: Node.js 18 was not there")
def test_what_it_cannot_do_is_one_line_and_exit_code_two(
    caliper: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    for name, held in {
        "picture.png": b"\x89PNG\r\n\x1a\n" + bytes(100),
        "empty.csv": b"",
        "nocaliper.csv": b"depth,gr\n1,2\n3,4\n",
        "empty.wall": b"",
        "foreign.wall": b"%PDF-1.7" + bytes(3000),
        "notes.toml": b"not toml [",
        "hole.glb": b"glTF",
        "survey.csv": b"md_m,incl_deg,azim_deg\n502,8,10\n600,9,10\n",
        "short.csv": b"md_m,incl_deg,azim_deg\n400,8,10\n504,9,10\n",
        "memory.las": MEMORY,
    }.items():
        (tmp_path / name).write_bytes(held)
    for arguments, text in (
        (
            ("picture.png", *BIT),
            "picture.png: binary, and no format that helibore reads (DLIS, LIS, Parquet, NPZ, XLSX)",
        ),
        (("empty.csv", *BIT), "empty.csv: empty: 0 bytes"),
        (
            ("nocaliper.csv", *BIT),
            "nocaliper.csv: no channel has the role radius, diameter or radius-image: name one by an option or in a "
            "map, such as columns.radius=NAME:in and columns.depth=depth:ft, since depth states no unit; the "
            "channels are depth, gr",
        ),
        ((".", *BIT), ".: is a directory"),
        (("none.csv", *BIT), "none.csv: No such file or directory"),
        (("empty.wall",), "empty.wall: an empty file, not the archive of a wall"),
        (("foreign.wall",), "foreign.wall: not the archive of a wall (it begins with b'%PDF')"),
        (
            ("notes.toml",),
            "notes.toml: not TOML: Expected '=' after a key in a key/value pair (at line 1, column 5)",
        ),
        (
            ("hole.glb",),
            "hole.glb: a mesh has no samples; use its settings, hole.glb.toml, a saved .wall, or the caliper file",
        ),
        (
            (str(caliper), *BIT, "--survey", "survey.csv"),
            "survey.csv: the wall lies from 500.00 to 505.00 m, the path from 502.00 to 600.00 m: the survey needs a "
            "station at 500.00 m or above, or the wall must start deeper (--from 502m)",
        ),
        (
            (str(caliper), *BIT, "--survey", "short.csv"),
            "short.csv: the wall lies from 500.00 to 505.00 m, the path from 400.00 to 504.00 m: extend the path, or "
            "give a longer survey (-s path.extend=1m)",
        ),
        (
            ("memory.las",),
            f"memory.las: {IMAGES_ONLY}. No bit size is stated: replace 8.5in with yours. Run: helibore view --gauge "
            "--image memory.las:GRAS:edge --bit-diameter 8.5in",
        ),
        (
            ("memory.las", "--bit-diameter", "6in", "--survey", "short.csv"),
            f"memory.las: {IMAGES_ONLY}. Run: helibore view --gauge --image memory.las:GRAS:edge --bit-diameter 6in "
            "--survey short.csv",
        ),
        (
            ("--gauge", "--image", "memory.las:GRAS:edge", *BIT, "--survey", "memory.las"),
            "memory.las: a survey needs the azimuth beside the inclination INNM: the path and true dips follow from "
            "both. Name the azimuth by columns.azimuth=NAME or in a map; without a survey, dips count from the hole, "
            "and toolfaces count from the high side",
        ),
        ((str(caliper), *BIT, "--token", ""), "token: must not be empty"),
    ):
        done = run(*arguments, "--no-browser")
        assert (done.exit_code, done.stderr) == (2, f"helibore: {text}\n")


def test_the_head_says_where_the_first_station_lies(
    caliper: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    import helibore as hb
    from helibore import viewer

    def seen(_: hb.Wall, path: hb.Path, **__: object) -> None:
        raise ValueError(f"first station at {path.position([500.0]).tolist()}")

    monkeypatch.setattr(viewer, "view", seen)
    monkeypatch.setattr("helibore.cli.view_command.check_page", lambda: None)  # the page may be not built
    survey = tmp_path / "survey.csv"
    survey.write_text("md_m,incl_deg,azim_deg\n500,8,10\n600,9,10\n")
    given = ["view", str(caliper), "--bit-diameter", "216mm", "--survey", str(survey)]
    result = CliRunner().invoke(cli, [*given, "-s", "path.head=-10m,20m,430m"])
    assert "first station at [[-10.0, 20.0, 430.0]]" in result.stderr


def test_picks_are_those_of_the_first_file_shown_and_the_print_has_its_header(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, golden: Golden
) -> None:
    import helibore as hb
    from helibore import plot, viewer

    seen: list[Any] = []

    class Stopped:
        scene = SimpleNamespace(update_state=lambda **_: None)
        url = "http://here/"
        wait = close = staticmethod(lambda: None)

    def view(_: object, **settings: Any) -> type[Stopped]:
        seen.append(settings["picks_file"])
        return Stopped

    def pages(*_: object, **drawing: Any) -> None:
        seen.append(drawing["title"])
        seen.append(drawing["header"])
        seen.append([drawing[name] for name in ("start", "stop", "scale")])

    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(viewer, "view", view)
    monkeypatch.setattr(plot, "pages", pages)
    monkeypatch.setattr(plot, "rendered", lambda *_: b"")
    monkeypatch.setattr("helibore.cli.view_command.check_page", lambda: None)  # the page may be not built
    (tmp_path / "memory.las").write_bytes(MEMORY)
    (tmp_path / "s.csv").write_text("md_m,incl_deg,azim_deg\n400,8,10\n600,9,10\n")
    images, survey = ("--image", "memory.las:GRAS:edge"), ("--survey", "s.csv")
    for more in ((), survey, ("--scalar", "memory.las:INNM", *survey)):
        shown = run("--gauge", *images, *BIT, *more)
        assert shown.exit_code == 0, shown.output
        assert seen.pop() == Path("memory.las.picks.csv")
        assert "picks saved in memory.las.picks.csv" in " ".join(shown.stdout.split())
    with monkeypatch.context() as patch:  # root can write everywhere
        patch.setattr("helibore.logs.picks.os.access", lambda *_: False)
        shown = run("--gauge", *images, *BIT)
    assert seen.pop() == Path("memory.las.picks.csv")
    assert (
        "picks not saved in memory.las.picks.csv: its folder cannot be written; click Download on the "
        "page to keep the picks" in " ".join(shown.stdout.split())
    )
    shown = run("--gauge", *images, *BIT, "--picks", "mine.csv")
    assert seen.pop() == Path("mine.csv")
    assert "picks saved in mine.csv" in " ".join(shown.stdout.split())
    assert "does not exist yet" not in shown.stdout, "no archive has picks"
    wall = hb.reconstruct(hb.Caliper.gauge(500.0, 501.0, 0.2159), bit_diameter=0.2159)
    wall.picks.append(hb.Pick(kind="bed", depth=500.5, toolface=130.0))
    wall.save("A.wall")
    shown = run("A.wall", "--picks", "new.csv")
    assert seen.pop() == Path("new.csv")
    assert "picks 1 of A.wall.picks.csv, as new.csv does not exist yet picks saved in new.csv" in " ".join(
        shown.stdout.split()
    )
    shown = run("--gauge", *BIT, *survey, "--from", "500m", "--to", "501m")
    assert seen.pop() is None
    assert "picks not saved: only a survey was given" in " ".join(shown.stdout.split())
    run("--gauge", *images, *BIT, "--header", "mud=OBM")
    Stopped.scene.draw_pages(490.0, 502.0, "in", 200)  # cut to the wall
    assert seen[1:3] == ["Gauge hole", {"company": "Deep Rock", "date": "21/05/2007", "mud": "OBM"}]
    assert seen[3] == [pytest.approx(500.0), 502.0, 200]
    with golden.raises():
        Stopped.scene.draw_pages(3080.0, 3110.0, "in", 200)


@pytest.mark.skipif(page("app.js") is None, reason="the page is not built: Node.js 18 was not there")
def test_a_saved_wall_is_shown_with_its_values(tmp_path: Path, golden: Golden) -> None:
    import helibore as hb

    rng = np.random.default_rng(3)
    depth = 700 + np.sort(rng.uniform(0, 3, 3000))
    samples = hb.Caliper(depth, rng.uniform(0, 360, 3000), rng.uniform(0.108, 0.115, 3000))
    wall = hb.reconstruct(samples, bit_diameter=0.216)
    wall.attributes["GR"] = np.linspace(20, 140, len(wall) - 65)
    wall.attributes.units["GR"] = "gAPI"
    file = tmp_path / "hole.wall"
    wall.save(file)
    command = [*HELIBORE, "view", str(file), "--no-browser", "-q"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as shown:
        try:
            assert shown.stdout is not None
            url = shown.stdout.readline().split()[0]
            with urllib.request.urlopen(url.replace("/?", "/api/vertex/500?")) as answer:
                said = json.load(answer)
            assert said["radius"] == pytest.approx(wall.radius[500], abs=5.1e-6)
            assert said["attributes"] == {"GR": pytest.approx(wall.attributes["GR"][500], rel=1e-6)}
        finally:
            shown.send_signal(signal.SIGINT)
        assert shown.wait(PATIENCE) == 0
    done = run(str(file), "-s", "wall.sectors=32")
    assert done.exit_code == 2
    golden(done.stderr)
    torn = tmp_path / "torn.wall"
    torn.write_bytes(file.read_bytes()[:2000])
    done = run(str(torn))
    assert (done.exit_code, done.stderr.count("\n")) == (2, 1), done.stderr
    assert "torn.wall" in done.stderr


@pytest.mark.skipif(page("app.js") is None, reason="the page is not built: Node.js 18 was not there")
def test_the_settings_of_a_run_show_its_wall(caliper: Path, tmp_path: Path) -> None:
    mesh = tmp_path / "hole.glb"
    made = ["reconstruct", str(caliper), "--bit-diameter", "216mm", "--sectors", "32", "--earlier", "1", "-q"]
    later = tmp_path / "later.csv"
    rows = np.loadtxt(caliper, delimiter=",", skiprows=1)
    rows[:, 2] += 0.004
    np.savetxt(later, rows, delimiter=",", header="depth_m,toolface_deg,radius_m", comments="", fmt="%.6f")
    made.insert(2, str(later))
    subprocess.run([*HELIBORE, *made, "-o", str(mesh)], check=True, timeout=PATIENCE)
    settings = tmp_path / "hole.glb.toml"
    command = [*HELIBORE, "view", str(settings), "--no-browser", "-q", "--token", "a&b #1"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as shown:
        try:
            assert shown.stdout is not None
            url, query = shown.stdout.readline().split()[0].split("?")
            assert query == "token=a%26b%20%231"
            with urllib.request.urlopen(f"{url}api/vertex/500?{query}") as answer:
                said = json.load(answer)
            assert said["attributes"]["difference"] == pytest.approx(0.004, abs=0.002)
            with pytest.raises(urllib.error.HTTPError, match="403"):
                urllib.request.urlopen(f"{url}api/vertex/500?token=a")
            taken = run(str(settings), "--no-browser", "--port", url.strip("/").rsplit(":", 1)[1])
            assert (taken.exit_code, taken.stderr.count("\n")) == (2, 1), taken.stderr
            port = url.strip("/").rsplit(":", 1)[1]
            rule = "Address already in use; give another port, or 0"
            assert taken.stderr == f"helibore: 127.0.0.1 port {port}: {rule}\n"
        finally:
            shown.send_signal(signal.SIGINT)
        assert shown.wait(PATIENCE) == 0
    for arguments, text in (
        ((str(mesh),), "hole.glb: a mesh has no samples; use the settings beside it, hole.glb.toml"),
    ):
        done = run(*arguments)
        assert done.exit_code == 2
        assert text in done.stderr
    later.write_text(later.read_text() + "501.0,10.0,0.11\n")
    done = run(str(settings))
    assert (done.exit_code, done.stderr.count("\n")) == (2, 1), done.stderr
    assert "later.csv: has changed since the run" in done.stderr
    settings.write_text('title = "my notes"\n')
    done = run(str(settings))
    assert (done.exit_code, done.stderr.count("\n")) == (2, 1), done.stderr
    assert "hole.glb.toml, line 1: title: must be one of helibore, verb" in done.stderr


def test_without_the_page_it_says_how_to_get_it(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, golden: Golden
) -> None:
    from helibore.cli import view_command as command
    from helibore.viewer import page_files, web_app

    monkeypatch.setattr(web_app, "page", lambda _: None)
    monkeypatch.setattr(page_files.resources, "files", lambda _: tmp_path)
    with golden.raises():
        command.check_page()
    (tmp_path / "no-page.txt").write_text("Node.js 18 or newer and npm were not there\n")
    with golden.raises():
        command.check_page()


@pytest.mark.skipif(page("app.js") is None, reason="the page is not built: Node.js 18 was not there")
def test_a_planned_path_begins_where_the_survey_begins(caliper: Path, tmp_path: Path) -> None:
    for name, first in (("survey", 400), ("plan", 400), ("other", 390)):
        (tmp_path / f"{name}.csv").write_text(
            f"depth_m,inclination_deg,azimuth_deg\n{first},10,20\n600,14,{len(name)}\n"
        )
    made = (str(caliper), *BIT, "--survey", str(tmp_path / "survey.csv"), "--html", str(tmp_path / "w.html"))
    found = run(*made, "--plan", str(tmp_path / "plan.csv"))
    assert found.exit_code == 0, found.output
    points = json.loads(re.search(r'"plan": ?(\[\[.*?\]\])', (tmp_path / "w.html").read_text())[1])  # type: ignore[index]
    assert points[0] == [0, 0, 0]
    assert points[-1][2] == pytest.approx(200 * np.cos(np.radians(12)), abs=0.5)
    found = run(*made, "--plan", str(tmp_path / "other.csv"))
    assert (found.exit_code, "first station = 390 m" in found.output, "400 m" in found.output) == (2, True, True)
