"""``helibore plot``: pictures of archives and of real wells, and what it refuses."""

from __future__ import annotations

import io
import re
import tomllib
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from click.testing import CliRunner, Result
from golden_texts import Golden
from locations import SHARED
from plotted_wall import plotted_wall

import helibore as hb
from helibore.cli import cli
from helibore.plot.paper import MM


def run_cli(*arguments: object) -> Result:
    return CliRunner().invoke(cli, ["plot", *map(str, arguments)])


@pytest.fixture(scope="module")
def wall() -> hb.Wall:
    return plotted_wall()


@pytest.fixture
def archive(tmp_path: Path, wall: hb.Wall) -> Path:
    wall.save(tmp_path / "well.wall")
    return tmp_path / "well.wall"


CURVES = """~Version
VERS. 2.0 :
WRAP. NO :
~Well
STRT.M 2000 :
STOP.M 2022 :
STEP.M 0 :
NULL. -999.25 :
COMP. Acme Oil : Company
WELL. A-1 T2 : Well
FLD. North : Field
DATE. 2026-11-22 : Date
~Curve
DEPT.M :
GR.GAPI :
RT.OHMM :
CALI.IN :
~ASCII
"""


def test_scalar_tracks_and_a_header_from_the_file_and_the_command_line(tmp_path: Path) -> None:
    rows = "".join(
        f"{2000 + 0.2 * k:.1f} {60 + 20 * (k % 7):d} {10.0 ** (k % 3):g} {8.5 + 0.01 * k:.2f}\n" for k in range(110)
    )
    las, survey = tmp_path / "mem.las", tmp_path / "survey.csv"
    las.write_text(CURVES + rows)
    survey.write_text("md_m,inc_deg,azi_deg\n1990,10,20\n2030,30,20\n")
    arguments = ["--average", f"{las}:CALI", "--bit-diameter", "8.5in", "--survey", survey, "--no-body", "--dpi", 50,
                 "--scalar", f"{las}:GR", "--scalar", f"{las}:RT", "--look", "RT=log", "--look", "GR=0,200",
                 "--scalar", "inclination", "--header", "company=Acme Offshore", "--header", "mud=OBM 1.2"]  # fmt: skip
    picks = tmp_path / "dips.csv"
    picks.write_text("class,depth_m,toolface_deg,apparent_dip_deg\nbed,2010,30,40\n")
    result = run_cli(*arguments, "--picks", picks, "-o", tmp_path / "log.svg")
    assert result.exit_code == 0, result.output
    assert "1 of dips.csv" in result.output
    page = tmp_path / "well.html"
    written = CliRunner().invoke(cli, [str(word) for word in ("report", *arguments, "-o", page)])
    assert written.exit_code == 0, written.output
    text = page.read_text()
    assert "<h1>A-1 T2</h1>" in text
    for label, said in (("Company", "Acme Offshore"), ("Field", "North"), ("Date", "2026-11-22"), ("Mud", "OBM 1.2")):
        assert f"<tr><th>{label}</th><td>{said}</td></tr>" in text
    again = run_cli(tmp_path / "log.svg.toml", "-o", tmp_path / "again.svg")
    assert again.exit_code == 0, again.output
    assert "to the last bit" in again.output
    assert "1 of dips.csv" in again.output
    settings = tomllib.loads((tmp_path / "log.svg.toml").read_text())
    assert [(one["file"], one["name"]) for one in settings["scalar"]] == [(las.name, "GR"), (las.name, "RT")]
    assert settings["print"]["scalar"] == ["inclination"]
    las.write_text(las.read_text().replace("70", "71"))
    changed = run_cli(tmp_path / "log.svg.toml", "-o", tmp_path / "again.svg")
    assert changed.exit_code == 2
    assert "has changed since the run" in changed.output
    source = ["--average", f"{las}:CALI", "--bit-diameter", "8.5in"]
    saved, out = tmp_path / "saved.wall", tmp_path / "out.las"
    for words in (["logs", *source, "-o", out], ["reconstruct", *source, "-o", saved], ["logs", saved, "-o", out]):
        written = CliRunner().invoke(cli, [str(word) for word in words])
        assert written.exit_code == 0, written.output
        if words[0] == "logs":  # of the file, and of the archive, which keeps the header
            header = hb.open(out).set().header
            assert [header[name] for name in ("COMP", "WELL", "FLD", "DATE")] == [
                "Acme Oil", "A-1 T2", "North", "2026-11-22",
            ]  # fmt: skip
    assert "NO : One line a depth" in (tmp_path / "out.las").read_text()


def test_criteria_are_those_of_the_command_line_and_of_the_settings_of_another_command(
    tmp_path: Path, archive: Path
) -> None:
    def run(verb: str, *words: object) -> str:
        done = CliRunner().invoke(cli, [verb, *map(str, words)])
        assert done.exit_code == 0, done.output
        return " ".join(done.output.split())

    page, look = tmp_path / "a.html", ("--unit", "in", "--no-body", "--no-polar", "--dpi", 40, "--to", 2003)
    usual = "washout C2 − bit at least 0.5 in, breakout C1 − C2 at least 1 in"
    run("report", archive, "-o", page, *look)
    assert usual in page.read_text()
    run("report", archive, "-o", page, *look, "-s", "zones.washout=0.3in", "-s", "zones.least-length=0.5")
    assert "washout C2 − bit at least 0.3 in" in page.read_text()
    assert "over at least 0.5 m of hole" in page.read_text()
    las = tmp_path / "a.las"
    run("logs", archive, "-o", las, "-s", "zones.washout=0.2in", "-s", "zones.scaled=true", "--step", "1m")
    run("report", f"{las}.toml", "-o", page, *look)
    assert "washout C2 − bit at least 0.2 in, breakout C1 − C2 at least 1 in" in page.read_text()
    zones = tomllib.loads((tmp_path / "a.html.toml").read_text())["zones"]
    assert zones == {"washout": pytest.approx(0.2 * 0.0254), "scaled": True}
    assert "to the last bit" in run("report", f"{page}.toml", "-o", tmp_path / "again.html")
    run("report", f"{las}.toml", "-o", page, *look, "-s", "zones.washout=0.4in")
    assert "washout C2 − bit at least 0.4 in" in page.read_text()
    assert "elongation 0.02" in run("logs", f"{page}.toml", "-o", las)
    assert "washout 0.01016 m" in run("logs", f"{page}.toml", "-o", las)
    svg = tmp_path / "a.svg"
    run("plot", f"{las}.toml", "-o", svg, *look)
    assert "washout C2 − bit at least 0.4 in" in svg.read_text()
    refused = run_cli("--average", "x.las:CALI", "--bit-diameter", "8.5in", "-s", "zones.depth=1", "-o", svg)
    assert refused.exit_code == 2


def test_an_archive_keeps_the_header_of_its_files(tmp_path: Path) -> None:
    las, archive, page = (tmp_path / name for name in ("mem.las", "well.wall", "well.html"))
    las.write_text(CURVES + "".join(f"{2000 + 0.2 * k:.1f} 60 1 8.5\n" for k in range(50)))
    for words in (
        ("reconstruct", "--average", f"{las}:CALI", "--bit-diameter", "8.5in", "-o", archive),
        ("report", archive, "-o", page, "--no-body", "--dpi", "30", "--header", "run=2"),
    ):
        written = CliRunner().invoke(cli, [str(word) for word in words])
        assert written.exit_code == 0, written.output
    text = page.read_text()
    assert "<h1>A-1 T2</h1>" in text
    for label, said in (("Company", "Acme Oil"), ("Field", "North"), ("Run", "2")):
        assert f"<tr><th>{label}</th><td>{said}</td></tr>" in text
    assert "made from: header" not in text
    assert "well.wall: archive of a wall, made from mem.las" in text


@pytest.mark.parametrize(("verb", "drawn_by"), [("plot", "plot.log"), ("report", "plot.html_report.report")])
def test_scalar_tracks_have_the_values_of_the_file_and_the_inclination_of_the_survey(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, verb: str, drawn_by: str
) -> None:
    las, survey, seen = tmp_path / "mem.las", tmp_path / "survey.csv", {}
    las.write_text(CURVES + "2000 60 1 8.5\n2010 -999.25 10 8.5\n2022 80 100 8.5\n")
    survey.write_text("md_m,inc_deg,azi_deg\n1990,10,20\n2030,30,20\n")

    def draw(*_: object, **drawing: Any) -> None:
        seen.update(drawing)
        raise hb.InputError("drawing", "not drawn")

    monkeypatch.setattr(f"helibore.{drawn_by}", draw)
    arguments = [verb, "--gauge", "--from", 2000, "--to", 2022, "--bit-diameter", "8.5in", "--survey", survey]
    scalars = ["--scalar", f"{las}:GR", "--scalar", f"{las}:RT", "--look", "RT=log", "--scalar", "inclination"]
    output = tmp_path / ("well.svg" if verb == "plot" else "well.html")
    result = CliRunner().invoke(cli, [str(word) for word in (*arguments, *scalars, "-o", output)])
    assert result.stderr == "helibore: drawing: not drawn\n"
    gamma, resistivity, inclination = seen["scalars"]
    assert [(one.name, one.unit, one.log) for one in seen["scalars"]] == [
        ("GR", "GAPI", False), ("RT", "OHMM", True), ("Inclination", "deg", False),
    ]  # fmt: skip
    assert gamma.depth.tolist() == resistivity.depth.tolist() == [2000, 2010, 2022]
    np.testing.assert_array_equal(gamma.values, [60, np.nan, 80])
    assert resistivity.values.tolist() == [1, 10, 100]
    straight = 10 + 20 * (inclination.depth - 1990) / 40  # one arc in a vertical plane
    np.testing.assert_allclose(inclination.values, straight, atol=1e-9)


def test_the_header_line_of_an_average_caliper(tmp_path: Path) -> None:
    rows = "".join(f"{2000 + 0.2 * k:.1f},{8.5 + 0.01 * k:.2f}\n" for k in range(60))
    (tmp_path / "c.csv").write_text(f"Well A-1,logged 2026\nby,nobody\ndepth_m,cali_in\n{rows}")
    arguments = [
        "--average",
        f"{tmp_path / 'c.csv'}:cali_in",
        "-s",
        "header_line=3",
        "--bit-diameter",
        "8.5in",
        "--dpi",
        30,
        "--no-body",
        "--no-polar",
    ]
    result = run_cli(*arguments, "-o", tmp_path / "log.png")
    assert result.exit_code == 0, result.output
    again = run_cli(tmp_path / "log.png.toml", "-o", tmp_path / "again.png")
    assert "to the last bit" in again.output
    ranged = run_cli(
        *arguments, "-s", "preparation.least_radius=4.255in", "-o", tmp_path / "log.png"
    )  # from 8.51 in on
    assert "dropped 1 rows: outside the range of radii" in " ".join(ranged.output.split())
    assert "to the last bit" in run_cli(tmp_path / "log.png.toml", "-o", tmp_path / "again.png").output


@pytest.mark.parametrize(
    "options",
    [
        ("--scalar", "GR"),
        ("--scalar", "inclination"),
        ("--scalar", "x.csv:GR"),
        ("--scalar", "i.csv:GR"),
        ("--scalar", "mem.las:XX"),
        ("--scalar", "mem.las:GR", "--from", "2010m"),
        ("--scalar", "mem.las:GR", "--look", "GR=log", "--look", "GR=0,9"),
        ("--header", "colour=red"),
    ],
)  # fmt: skip
def test_what_is_refused_of_scalar_tracks_and_headers(
    tmp_path: Path, archive: Path, monkeypatch: pytest.MonkeyPatch, options: tuple[str, ...], golden: Golden
) -> None:
    (tmp_path / "mem.las").write_text(CURVES + "2000 60 1 8.5\n2001 70 1 8.5\n")
    (tmp_path / "x.csv").write_text("md,GR\n2000,1\n2001,2\n")
    (tmp_path / "i.csv").write_text("md_m,GR1_gapi,GR2_gapi,GR3_gapi,GR4_gapi\n2000,1,2,3,4\n2001,1,2,3,4\n")
    monkeypatch.chdir(tmp_path)
    result = run_cli(archive, *options, "-o", tmp_path / "log.png", "--dpi", 30)
    assert result.exit_code == 2
    golden(result.output)


@pytest.mark.parametrize("ending", ["png", "svg", "pdf"])
def test_plot_writes_an_archive_as_a_picture(tmp_path: Path, archive: Path, ending: str) -> None:
    output, body = tmp_path / f"log.{ending}", () if ending == "png" else ("--no-body",)
    result = run_cli(archive, "-o", output, "--dpi", 50, "--header", "well=Well & <one>", "--scale", "1:200", *body)
    assert result.exit_code == 0, result.output
    content = output.read_bytes()
    assert content.startswith({"png": b"\x89PNG", "svg": b"<?xml", "pdf": b"%PDF"}[ending])
    assert sorted(path.name for path in tmp_path.iterdir()) == [f"log.{ending}", f"log.{ending}.toml", "well.wall"]
    again = tmp_path / f"again.{ending}"
    assert (
        run_cli(archive, "-o", again, "--dpi", 50, "--header", "well=Well & <one>", "--scale", 200, *body).exit_code
        == 0
    )
    assert again.read_bytes() == content


def test_pages_wider_than_their_paper_are_named(tmp_path: Path, archive: Path) -> None:
    template = tmp_path / "wide.toml"
    template.write_text('[[track]]\nkind = "caliper"\nwidth = 1000\n')
    near = tmp_path / "near.toml"
    near.write_text(template.read_text().replace("1000", "473"))  # 210.3 mm
    many = tmp_path / "many.toml"
    curve = '[[track]]\nkind = "caliper"\n[[track]]\nkind = "image"\nname = "Radius"\n'
    many.write_text(curve * 9)
    wide = ("--template", many)
    for more, said in (
        ((), "297 mm"),
        (("--template", near), "210 x 297 mm"),
        (("--template", template), "210 x 297 mm"),
        (wide, "210 mm, wider than A4: if the page"),
    ):
        result = run_cli(archive, "-o", tmp_path / "log.pdf", "--dpi", 50, "--no-body", *more)
        assert result.exit_code == 0, result.output
        output = " ".join(result.output.split())
        assert said in output
        assert ("wider than" in output) == (more == wide)


@pytest.mark.parametrize(
    "arguments",
    [
        ["-o", "log.jpg"],
        ["-o", "no/log.png"],
        ["-o", "log.png", "--scale", "1:x"],
        ["-o", "log.png", "--look", "GR=9,1"],
        ["-o", "log.png", "--look", "9,1"],
        ["-o", "log.png", "--look", "GR=map:jet"],
        ["-o", "log.png", "--picks", "no.csv"],
        ["-o", "log.png", "--gauge"],
        ["-o", "log.png", "--image", "x.las"],
        ["-o", "log.png", "--image", "x.las:GR:edge:None"],
        ["-o", "log.png", "--image", "x.las:GR:edge"],
        ["-o", "log.png", "--from", "9000", "--to", "9001"],
    ],
)
def test_plot_refuses(archive: Path, monkeypatch: pytest.MonkeyPatch, arguments: list[str], golden: Golden) -> None:
    monkeypatch.chdir(archive.parent)
    (archive.parent / "log.png").write_bytes(b"old")
    result = run_cli("well.wall", *arguments)
    assert result.exit_code == 2
    golden(result.stderr)
    assert result.stderr.count("\n") == 1
    assert (archive.parent / "log.png").read_bytes() == b"old"
    assert sorted(path.name for path in archive.parent.iterdir()) == ["log.png", "well.wall"]


@pytest.mark.parametrize("word", ["window:1m", "map:viridis"])
def test_what_only_an_image_has_is_refused_for_a_curve(archive: Path, word: str) -> None:
    table = archive.parent / "log.csv"
    table.write_text("depth_m,CAL_in\n" + "".join(f"{2000 + row},8.5\n" for row in range(9)))
    given = ("--scalar", f"{table}:CAL_in", "--look", f"CAL_in={word}", "-o", archive.parent / "log.png")
    result = run_cli(archive, *given)
    assert result.exit_code == 2
    assert f"helibore: --look CAL_in={word.partition(':')[0]}: goes with an image, not with a curve" in result.stderr


@pytest.mark.parametrize("option", ["--image=log.csv:GR:edge", "--average=log.csv:GR"])
def test_a_channel_that_is_not_there_is_named(tmp_path: Path, option: str) -> None:
    table = tmp_path / "log.csv"
    table.write_text("depth_m,CAL_in\n" + "".join(f"{1000 + row},8.5\n" for row in range(9)))
    gauge = [] if option.startswith("--average") else ["--gauge"]
    result = run_cli(*gauge, option.replace("log.csv", str(table)), "--bit-diameter", "8.5in", "-o", tmp_path / "l.png")
    assert (result.exit_code, result.stderr) == (2, "helibore: log.csv: no channel 'GR'; it holds depth_m, CAL_in\n")


@pytest.mark.parametrize(
    ("size", "options"),
    [
        ("8.5", ("--to", "900")),
        ("8.5", ("--from", "2000", "--to", "2010")),
        ("-999.25", ()),
        ("850", ()),
        ("8.5\n-999,8.5", ()),
    ],
)
def test_an_average_caliper_of_another_interval_or_without_values_is_named(
    tmp_path: Path, size: str, options: tuple[str, ...], golden: Golden
) -> None:
    table = tmp_path / "log.csv"
    table.write_text("depth_m,CAL_in\n" + "".join(f"{1000 + row},{size}\n" for row in range(9)))
    result = run_cli("--average", f"{table}:CAL_in", *options, "--bit-diameter", "8.5in", "-o", tmp_path / "l.png")
    assert result.exit_code == 2
    golden(result.stderr)


@pytest.mark.parametrize(
    ("azimuth", "said"),
    [
        ("azimuth_deg", "north not stated (path.north states it)"),
        ("azimuth grid north_deg", "azimuths from grid north"),
    ],
)
def test_a_print_names_its_survey_and_the_north_that_the_file_states(tmp_path: Path, azimuth: str, said: str) -> None:
    survey = tmp_path / "survey.csv"
    survey.write_text(f"depth_m,inclination_deg,{azimuth}\n900,30,40\n1100,30,40\n")
    made = ("--gauge", "--bit-diameter", "8.5in", "--from", 1000, "--to", 1005, "--survey", survey)
    result = run_cli(*made, "--column", f"azimuth={azimuth}", "-o", tmp_path / "log.svg", "--no-body")
    assert result.exit_code == 0, result.output
    assert f"<!-- survey.csv: {said} -->" in (tmp_path / "log.svg").read_text()
    stated = (*made, "--column", f"azimuth={azimuth}", "-o", tmp_path / "log.svg", "--no-body", "-s", "path.north=true")
    result = run_cli(*stated)
    if "grid" in azimuth:
        assert "path.north = true: must be left out: the survey states grid north" in result.output
    else:
        assert "<!-- survey.csv: azimuths from true north -->" in (tmp_path / "log.svg").read_text()


ASSUMED = "from high-side, since no reference is stated (path.reference=north states one)"


@pytest.mark.parametrize(
    ("suffix", "options", "surveyed", "said", "printed"),
    [
        ("", (), False, ASSUMED, "assumed from the high side"),
        ("", (), True, ASSUMED, "assumed from the high side"),
        ("", ("-s", "path.reference=high-side"), True, "from high-side", "from the high side"),
        (":high-side", (), True, "from high-side", "from the high side"),
        (":north", (), False, "from north", "from north"),
        (":high-side", (), False, "from high-side", "from the high side"),
        ("", ("-s", "path.reference=north"), False, "from north", "from north"),
    ],
)
def test_what_an_image_counts_from_is_told_and_whether_anything_says_so(
    tmp_path: Path, suffix: str, options: tuple[str, ...], surveyed: bool, said: str, printed: str
) -> None:
    if surveyed:
        survey = tmp_path / "survey.csv"
        survey.write_text("depth_m,inclination_deg,azimuth_deg\n900,30,40\n1100,30,40\n")
        options = (*options, "--survey", str(survey))
    table = tmp_path / "log.csv"
    names = ",".join(f"GR{sector}_gAPI" for sector in range(1, 9))
    table.write_text(f"depth_m,{names}\n" + "".join(f"{1000 + row}{f',{row}' * 8}\n" for row in range(9)))
    made = ("--gauge", "--bit-diameter", "8.5in", "--image", f"{table}:GR:edge{suffix}", *options)
    result = run_cli(*made, "-o", tmp_path / "log.svg", "--no-body", "--no-polar")
    assert result.exit_code == 0, result.output
    words = " ".join(result.output.split())
    assert re.search(rf"9 rows x 8 sectors, 0 values missing, {re.escape(said)} (paper|warning) ", words)
    assert f"<!-- {printed}, clockwise looking downhole -->" in (tmp_path / "log.svg").read_text()


@pytest.mark.parametrize(
    ("inclination", "options", "warned"),
    [(1.5, (), True), (6, (), False), (1.5, ("-s", "path.reference=north"), False),
     (1.5, ("-s", "path.reference=high-side"), False)],
)  # fmt: skip
def test_the_high_side_of_a_hole_that_is_nearly_vertical_is_not_taken_in_silence(
    tmp_path: Path, inclination: float, options: tuple[str, ...], warned: bool
) -> None:
    survey, table = tmp_path / "survey.csv", tmp_path / "log.csv"
    names = ",".join(f"GR{sector}_gAPI" for sector in range(1, 9))
    survey.write_text(f"depth_m,inclination_deg,azimuth_deg\n900,1,40\n1100,{inclination},40\n")
    table.write_text(f"depth_m,{names}\n" + "".join(f"{1000 + row}{f',{row}' * 8}\n" for row in range(9)))
    made = ("--gauge", "--bit-diameter", "8.5in", "--image", f"{table}:GR:edge", "--survey", survey, *options)
    result = run_cli(*made, "-o", tmp_path / "log.svg", "--no-body", "--no-polar")
    assert result.exit_code == 0, result.output
    words = " ".join(result.output.split())
    assert ("the high side of a hole of 1.5 degrees" in words) == warned


def test_a_full_disk_leaves_the_old_picture(archive: Path, monkeypatch: pytest.MonkeyPatch, golden: Golden) -> None:
    import os

    output = archive.with_name("log.png")
    output.write_bytes(b"old")

    def full(_: int) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "fsync", full)
    result = run_cli(archive, "-o", output, "--dpi", 40, "--no-body", "--no-polar")
    assert (result.exit_code, output.read_bytes()) == (2, b"old")
    golden(result.stderr)
    assert sorted(path.name for path in output.parent.iterdir()) == ["log.png", "well.wall"]


@pytest.mark.skipif(not SHARED.is_dir(), reason="the public data is not there")
@pytest.mark.parametrize(
    "arguments",
    [
        ["calipers/volve_F-12_2010_pfcs_xy_caliper.csv.gz", "--column", "diameter=pfc1_x_in@0", "--column",
            "diameter=pfc2_y_in@90",
         "--from", 3080, "--to", 3110, "--bit-diameter", "6.2in"],
        ["--gauge", "--bit-diameter", "8.5in", "--image", "lwd-images/P11-A-02_Composite_MEM_Image_NF.las:ABDC:centre",
         "--image", "lwd-images/P11-A-02_Composite_MEM_Image_NF.las:GRAS:edge", "--from", 2020, "--to", 2060],
        ["--average", "lwd-images/15_9-F-15_D__WL_RAW_BHPR-CAL-DEN-GR-MECH-NEU-REMP_MWD_2.json:CALCM", "--bit-diameter",
         "8.5in", "--image", "lwd-images/15_9-F-15_D__WL_RAW_BHPR-CAL-DEN-GR-MECH-NEU-REMP_MWD_2.json:APRA:centre",
         "--look", "APRA=log", "--look", "APRA=map:resistivity", "--from", 4320, "--to", 4340],
    ],
)  # fmt: skip
def test_real_wells(arguments: list[Any], tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(SHARED)
    output = tmp_path / "well.png"
    result = run_cli(*arguments, "-o", output, "--dpi", 60, "-q")
    assert (result.exit_code, result.output) == (0, "")
    from PIL import Image

    with Image.open(io.BytesIO(output.read_bytes())) as picture:
        assert picture.size[0] == pytest.approx(210 / MM * 60, abs=1)
