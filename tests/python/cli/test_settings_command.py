"""Each command has few options; everything else is a setting, with one name, in every command that takes it."""

from __future__ import annotations

import re
import tomllib
from pathlib import Path

import click
import numpy as np
import pytest
from click.testing import CliRunner
from command import run
from golden_texts import Golden

import helibore as hb
from helibore.cli import VERBS, cli
from helibore.cli.declared_options import options_of
from helibore.cli.sections import FAMILIES, SETTING, Sectioned, SectionOption, section
from helibore.cli.setting_groups import every_group
from helibore.cli.settings_command import SHOWN, known_settings
from helibore.settings.declared import members
from helibore.settings.print_settings import PrintSettings


@pytest.fixture
def caliper(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    k = np.arange(600)
    rows = np.column_stack([1000 + k * 0.005, k * 37.0 % 360, 0.11 + 0.01 * np.cos(np.radians(74.0 * k))])
    np.savetxt("c.csv", rows, fmt="%.6f", delimiter=",", header="depth_m,toolface_deg,radius_m", comments="")
    return tmp_path


def command_of(verb: str) -> click.Command:
    found = cli.get_command(click.Context(cli), verb)
    assert found is not None
    return found


@pytest.mark.parametrize("verb", [verb for verb in VERBS if verb not in ("settings", "live", "simulate")])
def test_a_command_has_few_options_and_a_short_help(verb: str) -> None:
    text = CliRunner().invoke(cli, [verb, "--help"], terminal_width=100).output
    assert len(re.findall(r"^  (?:-\w, )?--", text, re.MULTILINE)) <= 30
    assert text.count("\n") < 70


@pytest.mark.parametrize("verb", SHOWN)
def test_every_parameter_has_an_option_or_names_its_setting(verb: str) -> None:
    command = command_of(verb)
    for each in command.params:
        if isinstance(each, SectionOption) and each.rare:
            refused = run(verb, each.opts[-1], "1")
            assert refused.exit_code == 2
            expected = f"helibore: {each.opts[-1]}: no option of {verb}, but a setting: {each.form}"
            assert refused.stderr.startswith(expected)
        elif isinstance(each, SectionOption):
            assert each.get_help_record(click.Context(command)) is not None


def test_the_list_has_every_setting_of_every_command() -> None:
    shown = [CliRunner().invoke(cli, ["settings", *of], terminal_width=100).output for of in ((), ("live",))]
    text = "".join(shown)
    assert "live.journal" not in shown[0]
    listed = set(re.findall(r"^  ([a-z_]+(?:\.\w+)*)(?=  |$)", text, re.MULTILINE))
    assert listed == set(known_settings(every_group()))
    assert {f"{group}.{name}" for group, kind in every_group().items() for name in members(kind)} <= listed
    names = [each.setting for each in command_of("reconstruct").params if isinstance(each, SectionOption)]
    assert len(names) == len(set(names))


def test_one_group_or_one_setting_is_listed() -> None:
    text = run("settings", "wall.power").output
    assert text.startswith("wall:\n  wall.power  ")
    assert "wall.nugget" not in text
    assert "echo.velocity" in run("settings", "echo").output
    unknown = run("settings", "wall.pwer")
    assert unknown.exit_code == 2
    assert unknown.stderr.startswith("helibore: wall.pwer: no setting or group; the nearest is wall.power; ")


@pytest.mark.usefixtures("caliper")
def test_a_setting_reaches_the_wall_in_every_way_it_is_stated() -> None:
    base = ("reconstruct", "c.csv", "--bit-diameter", "216mm", "-q")
    assert run(*base, "--sectors", 24, "-s", "wall.power=2", "-o", "a.wall").exit_code == 0
    assert run(*base, "-s", "wall.sectors=24", "--setting", "wall.power=2", "-o", "b.wall").exit_code == 0
    assert Path("a.wall").read_bytes() == Path("b.wall").read_bytes()
    assert tomllib.loads(Path("a.wall.toml").read_text())["wall"]["power"] == 2.0
    assert run(*base, "--sectors", 24, "-s", "wall.sectors=99", "-o", "c.wall").exit_code == 0
    assert hb.load("c.wall").settings.sectors == 24, "the option counts over the setting"


@pytest.mark.usefixtures("caliper")
@pytest.mark.parametrize(
    "words",
    [
        ("-s", "wall.pwer=2"),
        ("-s", "power=2"),
        ("-s", "zones.washout=1in"),
        ("-s", "wall.power"),
        ("-s", "wall.power=x"),
        ("-s", "wall.power=0"),
        ("--sectors", "2"),
        ("-s", "wall.sectors=2"),
        ("--column", "radiu=x"),
        ("-s", "preparation.saturated=perhaps"),
        ("--from-settings", "a.toml"),
        ("--power", "2"),
        ("--sektors", "2"),
    ],
)
def test_what_is_wrong_names_the_setting_and_the_nearest(words: tuple[str, ...], golden: Golden) -> None:
    result = run("reconstruct", "c.csv", "--bit-diameter", "216mm", "-o", "w.wall", *words)
    assert result.exit_code == 2
    golden(result.stderr)
    assert list(Path().iterdir()) == [Path("c.csv")]


def test_a_setting_of_other_commands_names_them() -> None:
    result = run("reconstruct", "c.csv", "-s", "header.well=X", "-o", "w.wall")
    assert "-s header.well: no setting of this command, but of plot, report, view, " in result.stderr


def test_an_unknown_command_names_the_nearest() -> None:
    result = run("plto")
    assert (result.exit_code, result.stderr[:52]) == (2, "helibore: No such command 'plto'. Did you mean plot?")


@pytest.mark.usefixtures("caliper")
def test_zones_are_written_with_the_criteria_that_are_stated() -> None:
    assert run("reconstruct", "c.csv", "--bit-diameter", "216mm", "-o", "w.wall", "-q").exit_code == 0
    made = run("zones", "w.wall", "-o", "z.csv", "-s", "zones.washout=0.3in", "-s", "zones.least-length=1m")
    assert made.exit_code == 0, made.output
    text = Path("z.csv").read_text()
    assert run("logs", "w.wall", "-o", "l.csv", "--zones", "y.csv", "-s", "zones.washout=0.3in", "-s",
               "zones.least_length=1m", "-q").exit_code == 0  # fmt: skip
    assert Path("y.csv").read_text() == text
    again = run("zones", "z.csv.toml", "-o", "again.csv")
    assert "to the last bit" in again.output
    assert Path("again.csv").read_text() == text
    refused = run("zones", "w.wall", "-o", "n.csv", "--from", "1001")
    assert (refused.exit_code, "--from: does not go with a saved wall" in refused.stderr) == (2, True)


def test_families_are_groups_of_commands() -> None:
    for verb in ("plot", "report", "view", "logs", "zones"):
        taken = {FAMILIES[str(each.name)] for each in command_of(verb).params if each.name in FAMILIES}
        more = {"logs": {"image_zones"}, "plot": {"look"}, "report": {"look"}}
        assert taken == {"zones", "header", *more.get(verb, ())}


def test_a_list_may_be_given_several_times_and_empty() -> None:
    seen: list[object] = []

    @click.command(cls=Sectioned, common=("polar",))
    @section("Print", *options_of(PrintSettings, "polar", "curves"))
    @section("Options", SETTING)
    def draw(**options: object) -> None:
        seen.append((options["polar"], options["curves"]))

    for words in ((), ("--polar", "2030", "--polar", "2031m,6660ft"), ("-s", "print.curves=[]"), ("--polar", "[]")):
        assert CliRunner().invoke(draw, words).exit_code == 0
    assert seen == [(None, None), ((2030.0, 2031.0, pytest.approx(2029.968)), None), (None, ()), ((), None)]


@pytest.mark.usefixtures("caliper")
def test_a_run_of_an_earlier_version_keeps_its_texts_of_numbers(monkeypatch: pytest.MonkeyPatch) -> None:
    seen: dict[str, object] = {}
    assert run("reconstruct", "c.csv", "--bit-diameter", "216mm", "-o", "a.ply", "-q").exit_code == 0
    text = Path("a.ply.toml").read_text().replace('verb = "reconstruct"', 'verb = "plot"')
    options = '[options]\nleft = "90"\nscale = "1:50"\ncurves = ["C1"]\ndpi = 30\nunit = "in"\n'
    Path("b.png.toml").write_text(text + options)

    def log(_: object, **settings: object) -> None:
        seen.update(settings)
        raise hb.InputError("log", "not drawn")

    monkeypatch.setattr("helibore.plot.log", log)
    assert run("plot", "b.png.toml", "-o", "c.png").stderr == "helibore: log: not drawn\n"
    assert {name: seen[name] for name in ("left", "scale", "curves", "dpi", "unit")} == {
        "left": 90.0, "scale": 50, "curves": ("C1",), "dpi": 30, "unit": "in"
    }  # fmt: skip
