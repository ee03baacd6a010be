"""The options that all commands share: sets of a file by name, number or columns; what goes with which source."""

from __future__ import annotations

import json
import re
import tomllib
from pathlib import Path

import numpy as np
import pytest
from command import run
from golden_texts import Golden

import helibore as hb
from helibore.cli.wall_options import SECTIONS
from helibore.logs.zone_criteria import Criteria

WALLS = ("reconstruct", "mesh", "logs", "plot", "report", "view")


@pytest.fixture
def passes(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Five sets: four passes of an X-Y caliper, each 0.1 in wider than the one before, and one of gamma."""
    monkeypatch.chdir(tmp_path)
    sets = []
    depth, bearing = 1000 + np.arange(300) * 0.02, np.arange(300) * 37.0 % 360
    for number in range(5):
        curves = {"MD": ("m", depth), "RB": ("deg", bearing)}
        curves |= dict.fromkeys(("CALX", "CALY"), ("in", 8.5 + 0.1 * number + 0 * depth))
        if number == 2:
            curves = {"MD": ("m", depth), "GR": ("gAPI", 50 + 0 * depth)}
        heads = [{"name": n, "unit": unit, "valueType": "float", "dimensions": 1} for n, (unit, _) in curves.items()]
        rows = np.column_stack([values for _, values in curves.values()]).tolist()
        sets.append({"header": {"name": f"pass {number}"}, "curves": heads, "data": rows})
    (tmp_path / "p.json").write_text(json.dumps(sets))
    return tmp_path / "p.json"


def test_absent_numbers_come_beside_the_usual_ones(tmp_path: Path, golden: Golden) -> None:
    """-999.2 for an angle, -999.25 for a diameter: naming the one must not make the other a radius."""
    rows = [f"{1000 + row / 50},{row * 37 % 360},8.5,8.5" for row in range(99)]
    rows[40], rows[60] = "1000.8,-999.2,8.5,8.5", "1001.2,20,-999.25,8.5"
    (tmp_path / "a.csv").write_text("\n".join(["MD_m,RB_deg,C1_in,C2_in", *rows]))
    given = ("mesh", tmp_path / "a.csv", "--bit-diameter", "8.5in", "-o", tmp_path / "a.ply")
    golden(run(*given).stderr)
    result = run(*given, "-s", "nulls=-999.2")
    assert result.exit_code == 0, result.output
    assert tomllib.loads((tmp_path / "a.ply.toml").read_text())["nulls"] == [-999.25, -9999.0, -9999.25, -999.2]


def test_an_image_added_to_a_repeated_run_is_never_written_over(tmp_path: Path) -> None:
    k, gamma = np.arange(2000), tmp_path / "g.csv"
    around = np.column_stack([1000 + k * 0.001, k * 37.0 % 360, np.full(k.size, 0.11)])
    np.savetxt(tmp_path / "c.csv", around, "%.5f", ",", header="md_m,tf_deg,radius_m", comments="")
    rows = np.column_stack([np.arange(1000, 1002, 0.1), np.full((20, 8), 50.0)])
    np.savetxt(gamma, rows, "%.5f", ",", header=",".join(["md_m", *(f"GR{n}_gAPI" for n in range(8))]), comments="")
    wall, before = tmp_path / "w.wall", gamma.read_bytes()
    assert run("mesh", tmp_path / "c.csv", "--bit-diameter", "8.5in", "-o", wall).exit_code == 0
    for source in (wall, f"{wall}.toml"):
        result = run("logs", source, "--image", f"{gamma}:GR:edge", "-o", gamma)
        text = f"helibore: {gamma}: would overwrite {gamma}, from which it is made\n"
        assert (result.exit_code, result.stderr, gamma.read_bytes()) == (2, text, before)


@pytest.mark.parametrize("image", [":GR:edge", "g.csv::edge", "g.csv:GR", "g.csv:GR:top"])
def test_an_image_needs_file_channel_and_origin(image: str) -> None:
    result = run("mesh", "--gauge", "--bit-diameter", "8.5in", "--image", image, "-o", "w.ply")
    assert f"--image {image}: must be FILE:CHANNEL:ORIGIN" in result.stderr


COLUMNS = ("--column", "diameter=CALX@0", "--column", "diameter=CALY@90", "--bit-diameter", "8.5in")


@pytest.mark.parametrize(
    ("sets", "chosen"),
    [
        (("pass 1",), [1]),
        (("2",), [1]),
        (("1,4-5",), [0, 3, 4]),
        (("4", "pass 0"), [0, 3]),
        (("with=CALX,CALY",), [0, 1, 3, 4]),
    ],
)
@pytest.mark.usefixtures("passes")
def test_sets_are_chosen_by_name_number_or_columns_and_are_passes(sets: tuple[str, ...], chosen: list[int]) -> None:
    given = [word for text in sets for word in ("--set", text)]
    result = run("reconstruct", "p.json", *given, *COLUMNS, "-o", "w.ply")
    assert result.exit_code == 0, result.output
    read = tomllib.loads(Path("w.ply.toml").read_text())["caliper"]
    assert [each["set"] for each in read] == [f"pass {number}" for number in chosen]
    mean = np.mean([8.5 + 0.1 * number for number in chosen]) * 0.0254 / 2
    again = run("reconstruct", "w.ply.toml", "-o", "w.wall")
    assert again.exit_code == 0, again.output
    assert hb.load("w.wall").radius.mean() == pytest.approx(mean, abs=2e-4)
    assert result.output.count("CALX is diameter") == 1, "the roles of several sets are printed once"


def test_the_only_set_with_arms_is_read_and_of_several_one_must_be_named(passes: Path) -> None:
    sets = json.loads(passes.read_text())
    for held, ends in (([sets[2], sets[3]], 0), ([sets[0], sets[3]], 2), ([sets[2], sets[2]], 2)):
        passes.write_text(json.dumps(held))
        result = run("reconstruct", "p.json", *COLUMNS, "-o", "w.ply")
        assert result.exit_code == ends, result.output
        assert ("set 'pass 3', 300 rows" in result.output) == (ends == 0)
        assert ("holds 2 sets" in result.stderr) == (ends == 2)


@pytest.mark.parametrize(
    "sets",
    [
        ("6",),
        ("5-4",),
        ("1-",),
        ("with=CALX,RT",),
        ("pass 9",),
    ],
)
@pytest.mark.usefixtures("passes")
def test_sets_that_are_not_there(sets: tuple[str, ...], golden: Golden) -> None:
    result = run("reconstruct", "p.json", "--set", *sets, *COLUMNS, "-o", "w.ply")
    assert (result.exit_code, result.stdout) == (2, "")
    golden(result.stderr)


@pytest.mark.usefixtures("passes")
def test_inspect_numbers_the_sets_and_takes_the_same_choice() -> None:
    assert "4. pass 3: 300 rows" in run("inspect", "p.json").output
    found = run("inspect", "p.json", "--set", "with=GR").output
    assert "3. pass 2: 300 rows" in found
    assert "pass 1" not in found
    assert 'set = "pass 2"' in run("inspect", "p.json", "--set", "3", "--toml").output


@pytest.mark.usefixtures("passes")
def test_a_map_without_a_set_is_for_every_set_that_is_chosen() -> None:
    roles = {"RB": "toolface", "CALX": "diameter", "CALY": "diameter"}
    units = {"RB": "deg", "CALX": "in", "CALY": "in"}
    more = {"CALX": "angle = 0.0\n", "CALY": "angle = 90.0\n"}
    lines = [f'[channels.{n}]\nrole = "{role}"\nunit = "{units[n]}"\n{more.get(n, "")}' for n, role in roles.items()]
    Path("m.toml").write_text("".join(lines))
    given = ("reconstruct", "p.json", "--set", "1,2", "--map", "m.toml", "--bit-diameter", "8.5in", "-o", "w.ply")
    result = run(*given)
    assert result.exit_code == 0, result.output
    assert "set 'pass 0', 300 rows" in result.output
    assert "set 'pass 1', 300 rows" in result.output


@pytest.mark.parametrize("verb", WALLS)
def test_every_command_has_every_option_of_a_wall_or_names_its_successor(verb: str) -> None:
    text = run(verb, "--help").output
    for option in (names.split()[0] for options in SECTIONS.values() for names, _ in options):
        if not re.search(rf"^  {option} ", text, re.MULTILINE):
            refused = run(verb, option, "1")
            assert refused.exit_code == 2
            assert re.match(
                rf"helibore: {option}: no option of {verb}, but a setting: (-s|--column) [\w.-]+=", refused.stderr
            )


@pytest.mark.parametrize(
    "options",
    [
        (),
        ("p.json", "w.wall"),
        ("p.json", "-s", "source.set=1"),
        ("--gauge", "--bit-diameter", "8in", "--column", "depth=md"),
        ("--average", "p.json:CALX", "--bit-diameter", "8in", "-s", "preparation.stuck=2"),
        ("p.json", "--bit-diameter", "8in", "-s", "echo.tool_radius=4cm"),
    ],
)  # fmt: skip
@pytest.mark.parametrize("verb", ["reconstruct", "logs"])
@pytest.mark.usefixtures("passes")
def test_options_that_do_not_go_together(verb: str, options: tuple[str, ...], golden: Golden) -> None:
    result = run(verb, *options, "-o", "w.glb" if verb == "reconstruct" else "w.csv")
    assert (result.exit_code, result.stdout) == (2, "")
    golden(result.stderr)


FEW = "a tool with few arms measured"


def test_the_page_has_the_criteria_of_the_command_line_or_of_the_output_it_is_given(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    pytest.importorskip("uvicorn", reason='the viewer needs the extra: pip install "helibore[view]"')
    from helibore import viewer
    from helibore.cli import view_command as command
    from helibore.viewer.feed import Feed

    monkeypatch.chdir(tmp_path)
    k = np.arange(6000)
    radius = 0.11 + 0.005 * (np.abs(k - 3000) < 1000)
    hb.reconstruct(hb.Caliper(1000 + k * 0.001, k * 37.0, radius), bit_diameter=0.22).save("w.wall")
    given: list[Criteria] = []

    def shown(wall: hb.Wall, *, criteria: Criteria, **_: object) -> None:
        given.append(criteria)
        feed = Feed(wall, path=None, attributes={}, well="", criteria=criteria)
        feed.find_zones()
        raise hb.InputError("zones", str(len(feed.scene.state.zones)))

    monkeypatch.setattr(viewer, "view", shown)
    monkeypatch.setattr(command, "check_page", lambda: None)

    def zones(*arguments: str) -> str:
        return run("view", *arguments).stderr.split()[-1]

    assert zones("w.wall") == "0"  # 10 mm are less than half an inch
    assert zones("w.wall", "-s", "zones.washout=0.3in") == "1"
    run("logs", "w.wall", "-o", "w.csv", "-s", "zones.washout=0.3in", "-s", "zones.scaled=true")
    assert zones("w.csv.toml") == "1"
    assert given == [Criteria(), Criteria(washout=0.3 * 0.0254), Criteria.scaled(0.22, washout=0.3 * 0.0254)]


@pytest.mark.parametrize(
    ("verb", "output"),
    [("reconstruct", "w.glb"), ("mesh", "w.vtu"), ("logs", "w.csv"), ("plot", "w.png"), ("report", "w.html"),
     ("view", "")],
)  # fmt: skip
def test_every_command_recognises_a_tool_with_few_arms_and_takes_survey_and_preparation(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, verb: str, output: str
) -> None:
    monkeypatch.chdir(tmp_path)
    depth = 1000 + np.arange(200) * 0.05
    rows = np.column_stack([depth, depth * 12 % 360, 8.5 + 0 * depth, 9.0 + 0 * depth])[[0, *range(200)]]
    np.savetxt("xy.csv", rows, fmt="%.4f", delimiter=",", header="md_m,rb_deg,x_in,y_in", comments="")
    columns = ("--column", "diameter=x_in@0", "--column", "diameter=y_in@90", "--bit-diameter", "8.5in")
    if verb == "view":
        pytest.importorskip("uvicorn", reason='the viewer needs the extra: pip install "helibore[view]"')
        from helibore import viewer
        from helibore.cli import view_command as command

        def stop(*_: object, **__: object) -> None:
            raise hb.InputError("view", "not served")

        monkeypatch.setattr(viewer, "view", stop)
        monkeypatch.setattr(command, "check_page", lambda: None)
    Path("s.csv").write_text("md_m,incl_deg,azim_deg\n990,40,90\n1030,41,95\n")
    columns = (*columns, "--survey", "s.csv", "-s", "preparation.repeated=true")
    small = ("--dpi", "40", "--no-body", "--no-polar", "--scale", "500") if verb in ("plot", "report") else ()
    result = run(verb, "xy.csv", *columns, *small, *(("-o", output) if output else ()))
    assert result.exit_code == (2 if verb == "view" else 0), result.output
    words = " ".join(result.output.split())
    assert FEW in words
    assert "dropped 4 of 804 samples (4 repeated)" in words
    assert "survey s.csv" in words


@pytest.mark.usefixtures("passes")
def test_a_mesh_is_no_source_and_its_settings_are_named() -> None:
    assert run("reconstruct", "p.json", "--set", "1", *COLUMNS, "-o", "w.glb", "-q").exit_code == 0
    refused = run("logs", "w.glb", "-o", "w.csv")
    rule = "w.glb: a mesh has no samples; use the settings beside it, w.glb.toml"
    assert (refused.exit_code, refused.stderr) == (2, f"helibore: {rule}\n")


@pytest.mark.usefixtures("passes")
def test_a_gauge_hole_has_no_figures() -> None:
    made = run("mesh", "--gauge", "--from", "1000", "--to", "1003", "--bit-diameter", "8.5in", "-o", "g.ply")
    assert made.exit_code == 0, made.output
    assert "gauge hole at bit size: not measured" in made.output
    assert "diameter" not in made.output
    assert "volume" not in made.output


@pytest.mark.parametrize(("given", "reference"), [((), "north"), (("--survey", "s.csv"), "high-side")])
def test_a_bearing_from_north_is_reported_and_the_sides_of_pictures_follow(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, given: tuple[str, ...], reference: str
) -> None:
    monkeypatch.chdir(tmp_path)
    depth = 1000 + np.arange(200) * 0.05
    rows = np.column_stack([depth, depth * 12 % 360, 8.5 + 0 * depth, 9.0 + 0 * depth])
    np.savetxt("xy.csv", rows, fmt="%.4f", delimiter=",", header="md_m,P1AZ_deg,x_in,y_in", comments="")
    Path("s.csv").write_text("md_m,incl_deg,azim_deg\n990,40,90\n1030,41,95\n")
    source = ("xy.csv", "--column", "diameter=x_in@0", "--column", "diameter=y_in@90", "--column", "toolface=P1AZ_deg")
    seen = {}

    def log(_: hb.Wall, **settings: object) -> None:
        seen.update(settings)
        raise hb.InputError("log", "not drawn")

    monkeypatch.setattr("helibore.plot.log", log)
    result = run("plot", *source, "--bit-diameter", "8.5in", *given, "-o", "w.png")
    assert result.stderr == "helibore: log: not drawn\n"
    assert seen["reference"] == reference
    result = run("logs", *source, "--bit-diameter", "8.5in", *given, "-o", "w.csv")
    assert "P1AZ_deg is toolface in deg from north" in result.output
    assert ("the wall's toolfaces count from north" in result.output) == (not given)


def four_arms(folder: Path, name: str, bits: tuple[float, ...] = (), header: str = "") -> Path:
    """A caliper of 8.6 in; ``bits`` are the sizes in its column BS, each for half of the rows."""
    cells = [f" {bits[row * len(bits) // 40]}" if bits else "" for row in range(40)]
    rows = "".join(f"{1000 + row / 10:.1f} 8.6 8.6 {row * 7 % 360}{cells[row]}\n" for row in range(40))
    curves = "DEPT.M:\nC1.IN:\nC2.IN:\nRB.DEG:\n" + ("BS.IN: Bit size\n" if bits else "")
    (folder / name).write_text(f"~V\nVERS. 2.0:\nWRAP. NO:\n~W\nNULL. -999.25:\n{header}~C\n{curves}~A\n{rows}")
    return folder / name


def test_the_bit_that_the_file_states_is_not_asked_for(tmp_path: Path) -> None:
    column, header = four_arms(tmp_path, "c.las", (8.5,)), four_arms(tmp_path, "h.las", header="BS.IN 8.5: bit\n")
    other, two = four_arms(tmp_path, "o.las", (8.375,)), four_arms(tmp_path, "t.las", (12.25, 8.5))
    for file, where in ((column, "BS of c.las"), (header, "its header of h.las")):
        done = run("reconstruct", file, "-o", tmp_path / "w.wall")
        assert done.exit_code == 0, done.output
        assert f"8.500 in (215.9 mm), as {where} states" in done.output
        assert hb.load(tmp_path / "w.wall").settings.bit_diameter == pytest.approx(0.2159)
        assert hb.reconstruct(hb.open(file)).settings.bit_diameter == pytest.approx(0.2159)
    assert run("reconstruct", tmp_path / "w.wall.toml", "-o", tmp_path / "again.wall").exit_code == 0
    done = run("reconstruct", column, other, "-o", tmp_path / "w.wall")
    assert done.exit_code != 0
    assert "the files state several: 8.500 in (215.9 mm) in c.las, 8.375 in (212.7 mm) in o.las" in done.output
    done = run("reconstruct", two, "-o", tmp_path / "w.wall")
    assert done.exit_code != 0
    assert "column BS: has bits from 8.500 in (215.9 mm) to 12.250 in (311.1 mm)" in done.output
    assert run("reconstruct", two, "--bit-diameter", "8.5in", "-o", tmp_path / "w.wall").exit_code == 0
    with pytest.raises(hb.InputError, match="must be given"):
        hb.reconstruct(hb.open(four_arms(tmp_path, "n.las")))
