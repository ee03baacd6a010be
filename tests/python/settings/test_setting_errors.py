"""Every setting refuses a bad value with the same words from Python, a file and the command line, and names itself."""

from __future__ import annotations

import ast
import json
import re
from pathlib import Path
from typing import Any

import click
import pytest
from click.testing import CliRunner
from locations import ROOT

import helibore as hb
from helibore.cli import Verbs, cli
from helibore.cli.sections import SectionOption, spelled_setting
from helibore.cli.setting_groups import every_group
from helibore.runs.project import Project, read_project
from helibore.settings.column_settings import Columns
from helibore.settings.declared import Member, members
from helibore.settings.groups import GROUPS
from helibore.settings.toml_reading import TomlSource, parse_setting, read_stated

SCALARS = (-1, 0, 2.5, 1e300, [1], "bad")
LISTS = ([-1], [0.5], [[1]], ["bad"], [["bad", "bad"]], [1e300, 1e300])
TEXTS = ("bad", "-1", "")
"""Values of which a setting of a kind refuses one, unless it takes any text or table."""

NEEDED = {
    "wall": {"bit_diameter": 0.2},
    "echo": {"velocity": 1500, "tool_radius": 0.05},
    "cement": {"casing": 0.17, "shoe": 1000},
    "intervals": {"file": "tops.csv"},
}
"""Settings without a default."""


def error_of(call: Any, *arguments: Any) -> hb.InputError | None:
    try:
        call(*arguments)
    except hb.InputError as error:
        return error
    return None


def bad_value(member: Member) -> Any:
    """Return a value that a setting refuses; None if it takes what is tried."""
    tried = LISTS if member.kind is tuple else TEXTS if member.kind in (str, Path) else SCALARS
    return next((value for value in tried if value != member.default and error_of(member.checked, value)), None)


def text_of(member: Member, value: Any) -> str:
    """Return a value as a user writes it on the command line; a size has its unit."""
    is_size = member.kind is float and member.unit is not None and isinstance(value, int | float) and value
    return f"{value}m" if is_size and member.unit.needed else json.dumps(value).strip('"')  # type: ignore[union-attr]


ALL = [(group, member) for group, kind in every_group().items() for member in members(kind).values()]
BAD = [(group, member, value) for group, member in ALL if (value := bad_value(member)) is not None]
IDS = [f"{group}.{member.name}" for group, member, _ in BAD]


def test_most_settings_have_a_bad_value() -> None:
    assert len(BAD) > 0.75 * len(ALL)


@pytest.mark.parametrize(("group", "member", "value"), BAD, ids=IDS)
def test_a_bad_value_has_the_same_words_and_names_its_setting_by_every_way(
    group: str, member: Member, value: Any, tmp_path: Path
) -> None:
    python = error_of(member.checked, value)
    assert python
    needed = {name: of for name, of in NEEDED.get(group, {}).items() if name != member.name} | {member.name: value}
    written = f"[{group}]\n" + "".join(f"{name} = {json.dumps(of)}\n" for name, of in needed.items())
    if group in members(Project):
        text = "gauge = true\n" + ("" if group == "wall" else "[wall]\nbit_diameter = 0.2\n") + written
        (tmp_path / "well.toml").write_text(text)
        file = error_of(read_project, tmp_path / "well.toml")
    else:
        text = written
        kind = GROUPS.get(group) or every_group()[group]
        file = error_of(read_stated, kind, needed, TomlSource("well.toml", text=text), tuple(group.split(".")))
    assert file
    assert file.place.startswith(f"well.toml, line {text.count(chr(10))}: {group}.{member.name}")
    assert file.rule == python.rule
    if group not in GROUPS:  # a live wall has no command line for its settings
        return
    line = error_of(parse_setting, member, text_of(member, value))
    assert line
    assert line.rule.startswith(python.rule)
    assert {python.setting, file.setting, line.setting} == {f"{group}.{member.name}"}


ANY_TEXT = {f"columns.{name}" for name in members(Columns)} | {
    *("wall.start_depth", "wall.stop_depth"), "print.scalar", "view.browser"
}  # fmt: skip
"""Settings whose option takes more (any column, any depth, curves of files), or a switch with words of click."""

VERBS = ("reconstruct", "mesh", "plot", "report", "view", "logs", "zones")


@pytest.mark.parametrize("verb", VERBS)
def test_the_command_line_names_the_option_of_every_setting_that_a_command_has(verb: str) -> None:
    command = Verbs.get_command(cli, click.Context(cli), verb)  # type: ignore[arg-type]
    assert command
    known = {each.setting: each for each in command.params if isinstance(each, SectionOption)}
    output = ("-o", "out") if any("-o" in each.opts for each in command.params) else ()
    for group, member, value in BAD:
        if (name := f"{group}.{member.name}") not in known or group not in GROUPS or name in ANY_TEXT:
            continue
        spelled = spelled_setting(command, name)
        assert spelled in (*known[name].opts, f"-s {name}", f"--column {member.name.replace('_', '-')}")
        with pytest.raises(click.UsageError) as said:
            command.make_context(verb, ["x.csv", *output, "-s", f"{name}={text_of(member, value)}"])
        rule = getattr(error_of(member.checked, value), "rule", "")
        assert f"'{spelled}': " in said.value.format_message()
        assert rule in said.value.format_message()


def test_an_error_from_a_project_names_the_option_beside_it(tmp_path: Path) -> None:
    project = tmp_path / "well.toml"
    for text, option in (
        ("[wall]\nbit_diameter = 0.2\nsectors = 2\n", "-s wall.sectors"),
        ("[wall]\nbit_diameter = 0.2\npower = -2\n", "-s wall.power"),
        ("[wall]\nsectors = 20\n", "--bit-diameter"),
        ("stop_depth = inf\n[wall]\nbit_diameter = 0.2\n", "--to"),
        ("[wall]\nbit_diameter = 0.2\n[zones]\nwashout = -1\n", "-s zones.washout"),
        ("[wall]\nbit_diameter = 0.2\n[look.GR]\nwindow = 0\n", "-s look.NAME.window"),
    ):
        project.write_text(f"gauge = true\n{text}")
        said = CliRunner().invoke(cli, ["plot", str(project), "-o", str(tmp_path / "p.png")]).stderr
        assert said.endswith(f" (option: {option})\n"), said
        other = CliRunner().invoke(cli, ["reprocess", str(project)])
        assert "(option: " not in other.output, "reprocess has no such option"


def test_an_error_names_only_settings_that_are_declared_and_no_option() -> None:
    settings = {f"{group}.{member.name}" for group, member in ALL} | {"insecure_scheduler"}
    below = [file for file in (ROOT / "python/helibore").rglob("*.py") if "cli" not in file.parts]
    for file in below:
        source = file.read_text(encoding="utf-8")
        if not re.search(r"InputError\([^()]*setting|\s--[a-z]", source):
            continue
        tree = ast.parse(source)
        for call in (node for node in ast.walk(tree) if isinstance(node, ast.Call)):
            if getattr(call.func, "id", "") == "InputError":
                given = [*call.args[3:], *(word.value for word in call.keywords if word.arg == "setting")]
                assert {of.value for of in given if isinstance(of, ast.Constant)} <= settings, file
        texts = {of.value for of in ast.walk(tree) if isinstance(of, ast.Constant) and isinstance(of.value, str)}
        for text in texts - {ast.get_docstring(tree, clean=False)} if "settings" not in file.parts else ():
            assert not re.search(r"(?<![\w-])(?<!install )--[a-z][a-z-]+(?!-*>)", text), (file, text)
