"""Options that only set a value: each reaches the setting that it names, in metres, degrees and seconds."""

from __future__ import annotations

import tomllib
from pathlib import Path

import numpy as np
import pytest
from command import run
from golden_texts import Golden

import helibore as hb
from helibore.simulation.tool import Hole, Tool, simulate


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Three metres of hole by time in two passes, and a survey."""
    monkeypatch.chdir(tmp_path)
    k = np.arange(1200)
    depth = 1000 + k % 600 * 0.005
    radius = 0.11 + 0.01 * np.cos(np.radians(2 * k * 37.0)) + 0.001 * (k % 11)
    rows = np.column_stack([k * 0.5, depth, k * 37.0 % 360, radius, 1 + k // 600])
    np.savetxt("c.csv", rows, fmt="%.6f", delimiter=",", header="time_s,depth_m,toolface_deg,radius_m,pass",
               comments="")  # fmt: skip
    stations = "990,10,40,80,50\n1001,20,60,81,52\n1010,30,70,82,54\n"
    Path("s.csv").write_text("md_m,incl_deg,azim_deg,b_deg,c_deg\n" + stations)
    return tmp_path


SOURCE = ("c.csv", "--bit-diameter", "216mm")


@pytest.mark.parametrize(
    ("given", "settings"),
    [
        (("-s", "wall.start_toolface=30deg", "-s", "wall.window=200", "-s", "wall.power=2.5", "-s",
            "wall.max_iterations=6",
          "-s", "wall.tolerance=0.01mm", "-s", "wall.angular_scale=2"),
         {"start_toolface": 30.0, "window": 200, "power": 2.5, "max_iterations": 6, "tolerance": 1e-5,
          "angular_scale": 2.0}),
        (("--estimator", "kriging", "-s", "wall.kriging_range=30cm", "-s", "wall.nugget=0.2"),
         {"estimator": "kriging", "kriging_range": 0.3, "nugget": 0.2}),
    ],
)  # fmt: skip
@pytest.mark.usefixtures("folder")
def test_options_of_the_wall_are_arguments_of_the_library(
    given: tuple[str, ...], settings: dict[str, float | str]
) -> None:
    result = run("reconstruct", *SOURCE, "--sectors", 16, *given, "-o", "w.wall")
    assert result.exit_code == 0, result.output
    rows = np.loadtxt("c.csv", delimiter=",", skiprows=1).T
    wall = hb.reconstruct(hb.Caliper(*rows[1:4]), bit_diameter=0.216, sectors=16, **settings)  # type: ignore[arg-type]
    np.testing.assert_array_equal(hb.load("w.wall").radius, wall.radius)


@pytest.mark.usefixtures("folder")
def test_options_of_the_preparation_are_settings() -> None:
    given = {
        "shallowest": ("1000.1m", 1000.1), "deepest": ("1002.9m", 1002.9), "closed": ("40mm", 0.04),
        "turn_height": ("5cm", 0.05), "sensor_offset": ("1cm", 0.01), "shifts": ("2=5cm", [[2, 0.05]]),
        "saturated": ("false", False), "drop_closed": ("false", False), "latest": ("true", True),
    }  # fmt: skip
    words = [word for name, (text, _) in given.items() for word in ("-s", f"preparation.{name}={text}")]
    result = run("reconstruct", *SOURCE, *words, "-o", "w.wall")
    assert result.exit_code == 0, result.output
    found = tomllib.loads(Path("w.wall.toml").read_text())["preparation"]
    expected = {name: value for name, (_, value) in given.items()}
    assert {name: found.get(name) for name in expected} == expected


@pytest.mark.usefixtures("folder")
def test_columns_of_the_survey_and_the_method_between_its_stations() -> None:
    given = ("--survey", "s.csv", "--column", "survey-depth=md_m", "--column", "inclination=b_deg", "--column",
        "azimuth=c_deg",
             "-s", "path.method=radius-of-curvature")  # fmt: skip
    result = run("reconstruct", *SOURCE, *given, "-o", "w.wall")
    assert result.exit_code == 0, result.output
    path = hb.load("w.wall").path
    expected = hb.Survey([990, 1001, 1010], [80, 81, 82], [50, 52, 54]).path(method="radius-of-curvature")
    depth = np.linspace(1000, 1003, 7)
    assert path is not None
    np.testing.assert_allclose(path.position(depth), expected.position(depth), rtol=0, atol=1e-9)


@pytest.mark.usefixtures("folder")
def test_options_of_a_drawing_are_arguments_of_the_plot(monkeypatch: pytest.MonkeyPatch) -> None:
    seen: dict[str, object] = {}

    def pages(_: hb.Wall, paper: str, **settings: object) -> None:
        seen.update(settings, paper=paper)
        raise hb.InputError("log", "not drawn")

    monkeypatch.setattr("helibore.plot.pages", pages)
    given = ("--paper", "a3", "--curves", "D0", "--curves", "C2", "-s", "print.left=180", "--polar", "1001m", "--polar",
             "1002m", "--body", "1001m,1002m", "--look", "GR=window:2m", "--look", "RES=linear")  # fmt: skip
    result = run("plot", *SOURCE, *given, "-o", "w.pdf")
    assert result.stderr == "helibore: log: not drawn\n"
    looks = seen.pop("looks")
    assert isinstance(looks, dict)
    assert (looks["GR"].window, looks["RES"].log) == (2.0, False)
    expected = {
        "paper": "a3",
        "curves": ("D0", "C2"),
        "left": 180.0,
        "polar": (1001.0, 1002.0),
        "body": (1001.0, 1002.0),
    }
    assert {name: seen[name] for name in expected} == expected


@pytest.mark.parametrize(
    "arguments",
    [
        ("simulate", "s", "--seed", "-1"),
        ("mesh", "--gauge", "--from", "1", "--to", "2", "-s", "wall.pitch=0", "-o", "w.ply"),
        ("plot", "w.wall", "--look", "GR=window:wide", "-o", "w.png"),
        ("plot", "w.wall", "--unit", "ft", "--template", "t.toml", "-o", "w.png"),
        ("logs", "w.wall", "-s", "zones.symmetry=x", "-o", "w.las"),
    ],
)
@pytest.mark.usefixtures("folder")
def test_an_error_names_the_option(arguments: tuple[str, ...], golden: Golden) -> None:
    hb.reconstruct(hb.Caliper([0.0, 1.0], [0.0, 180.0], [0.1, 0.1]), bit_diameter=0.2, sectors=8).save("w.wall")
    Path("t.toml").write_text('units = "mm"\n')
    size = () if arguments[0] != "mesh" else ("--bit-diameter", "8.5in")
    result = run(*arguments, *size)
    assert result.exit_code == 2
    golden(result.stderr)


def test_options_of_a_simulation_are_arguments_of_the_library(tmp_path: Path) -> None:
    values = {"sample_rate": 5.0, "rotation": 90.0, "stick_slip": 0.2, "advance": 30.0, "noise": 1e-3, "missing": 0.1}
    given = [word for name, value in (values | {"noise": "1mm"}).items()
             for word in (f"--{name.replace('_', '-')}", value)]  # fmt: skip
    result = run("simulate", tmp_path, "--plain", "--to", "2003m", *given, "--format", "npz")
    assert result.exit_code == 0, result.output
    expected = simulate(Hole(2000.0, 2003.0, bit_diameter=0.216), Tool(**values))
    with np.load(tmp_path / "caliper.npz") as found:
        for name in ("time_s", "depth_m", "toolface_deg", "radius_m"):
            np.testing.assert_array_equal(found[name], getattr(expected, name.partition("_")[0]))
