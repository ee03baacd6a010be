"""Declared settings: one declaration gives check, TOML key, option, row of the table and keyword."""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, Literal

import click
import numpy as np
import pytest
from click.testing import CliRunner
from golden_texts import Golden
from hypothesis import given
from hypothesis import strategies as st
from locations import ROOT

import helibore as hb
from helibore.cli.declared_options import option_of, options_of, stated
from helibore.cli.setting_groups import every_group
from helibore.cli.wall_options import section
from helibore.settings import listing
from helibore.settings.declared import (
    DEGREES,
    INCHES,
    METRES,
    POSITIVE,
    Declared,
    Formerly,
    Option,
    at_least,
    members,
)
from helibore.settings.groups import GROUPS
from helibore.settings.toml_reading import TomlSource, parse_setting, read_table


@dataclass(frozen=True, kw_only=True)
class Toy(Declared):
    """Settings of a toy."""

    reach: Annotated[float, METRES, POSITIVE, Option(), "How far it reaches. It reaches all around."] = 0.5
    limit: Annotated[float | None, INCHES, POSITIVE, Formerly("most"), "Largest size."] = None
    turns: Annotated[int, at_least(2, "turns"), Option(), "Number of turns."] = 4
    kind: Annotated[Literal["red", "blue"], Option(), "Colour."] = "red"
    round: Annotated[bool, Option(), "Take corners off."] = True
    passes: Annotated[tuple[int, ...] | None, Option(metavar="NUMBERS"), "Passes."] = None
    shift: Annotated[tuple[tuple[int, float], ...], METRES, "Shifts."] = ()
    angle: Annotated[float, DEGREES, "Angle."] = 4.0
    name: Annotated[str, "Name."] = ""
    file: Annotated[Path | None, "File."] = None


def read(text: str, kind: type[Any] = Toy, recorded: bool = False) -> Any:
    import tomllib

    return read_table(kind, tomllib.loads(text)["toy"], TomlSource("a.toml", Path("b"), text, recorded), ("toy",))


def command(seen: list[dict[str, Any]]) -> click.Command:
    @click.command()
    @section("Toy", *options_of(Toy))
    def run(**options: Any) -> None:
        seen.append(stated(Toy, options))

    return run


FAULTS = [
    ("reach", -1.0, "-1", "must be finite and above 0"),
    ("reach", float("nan"), "nan", "must be finite and above 0"),
    ("turns", 1, "1", "must be at least 2 turns"),
    ("turns", 2.5, "2.5", "must be an integer"),
    ("kind", "green", "green", "must be one of red, blue"),
    ("passes", (1.5,), "1.5", "must be an integer"),
]


@pytest.mark.parametrize(("name", "value", "text", "rule"), FAULTS)
def test_a_broken_rule_has_the_same_words_from_python_a_file_and_the_command_line(
    name: str, value: Any, text: str, rule: str
) -> None:
    with pytest.raises(hb.InputError) as from_python:
        Toy(**{name: value})
    assert (from_python.value.place, from_python.value.rule) == (name, rule)
    written = f"[{text}]" if isinstance(value, tuple) else f"'{text}'" if isinstance(value, str) else text
    with pytest.raises(hb.InputError) as from_file:
        read(f"\n[toy]\n{name} = {written}\n")
    assert (from_file.value.place.split(" ")[:3], from_file.value.rule) == (["a.toml,", "line", "3:"], rule)
    with pytest.raises(hb.InputError) as from_setting:
        parse_setting(members(Toy)[name], text, f"toy.{name}")
    assert (from_setting.value.place, from_setting.value.rule.split("; a")[0]) == (f"toy.{name}", rule)
    said = CliRunner().invoke(command([]), [f"--{name}", text])
    assert said.exit_code == 2
    assert re.search(rf"--{name}'.*{re.escape(rule)}", said.output.replace("\n", " "))


def test_units_stand_in_files_as_on_the_command_line() -> None:
    toy = read("[toy]\nreach = '8 1/2in'\nlimit = 0.25\nangle = '0.5rad'\nshift = [[3, -0.2]]\nfile = 'x.las'")
    assert (toy.reach, toy.limit) == (8.5 * 0.0254, 0.25)
    assert toy.angle == pytest.approx(28.6478897565)
    assert (toy.shift, toy.file) == (((3, -0.2),), Path("b/x.las"))
    seen: list[dict[str, Any]] = []
    done = CliRunner().invoke(command(seen), ["--reach", "8 1/2in", "--no-round", "--passes", "2,3"])
    assert done.exit_code == 0, done.output
    assert seen == [{"reach": 8.5 * 0.0254, "round": False, "passes": (2, 3)}]
    assert parse_setting(members(Toy)["limit"], "1/2in") == 0.0127
    assert parse_setting(members(Toy)["limit"], "none") is None
    assert parse_setting(members(Toy)["name"], "12") == "12"


@given(st.floats(1e-6, 1e6), st.integers(2, 1000), st.sampled_from(["red", "blue"]), st.booleans())
def test_every_way_in_gives_the_same_settings(reach: float, turns: int, kind: Any, is_round: bool) -> None:
    toy = Toy(reach=reach, turns=turns, kind=kind, round=is_round)
    written = {"reach": repr(reach), "turns": str(turns), "kind": kind, "round": str(is_round).lower()}
    assert read(f"[toy]\nreach={reach!r}\nturns={turns}\nkind='{kind}'\nround={written['round']}") == toy
    assert Toy(**{name: parse_setting(members(Toy)[name], text) for name, text in written.items()}) == toy
    assert Toy(reach=np.float64(reach), turns=np.int32(turns), kind=kind, round=np.bool_(is_round)) == toy  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("text", "place", "rule"),
    [
        ("[toy]\n\nreech = 1", "a.toml, line 3: toy.reech", "not known; did you mean reach?"),
        ("[toy]\nzzz = 1", "a.toml, line 2: toy.zzz", "must be one of reach, limit"),
        ("[toy]\nmost = 1", "a.toml, line 2: toy.most", "is now called limit"),
        ("[toy]\nshift = [\n[1, 2.0],\n[3, 'x']]", "a.toml, line 2: toy.shift 2 2", "must be a number with a unit"),
        ("[toy]\nangle = '3in'", "a.toml, line 2: toy.angle", "unit 'in': measures length, must be a unit of angle"),
        ("[other]\nx = 1\n[toy]\npasses = 3", "a.toml, line 4: toy.passes", "must be a list"),
    ],
)
def test_an_error_in_a_file_names_its_line_and_the_nearest_key(text: str, place: str, rule: str) -> None:
    with pytest.raises(hb.InputError) as caught:
        read(text)
    assert caught.value.place == place
    assert rule in caught.value.rule


LONG = (
    """[toy] # ]
name = '''[
"# { " '''
shift = [  # [
"""
    + "[3, 0.25], # ] '\n" * 3000
    + """]

kind = "red" # \"
file = "a\\"[b"
"""
)


def test_the_line_of_a_key_is_found_beside_long_values_brackets_in_texts_and_comments() -> None:
    with pytest.raises(hb.InputError) as caught:
        read(LONG + "passes = [\n1,\n'x']\n")
    assert caught.value.place == f"a.toml, line {LONG.count(chr(10)) + 1}: toy.passes 2"
    with pytest.raises(hb.InputError) as caught:
        read(LONG.replace("[3, 0.25], # ] '\n]", "['x', 0.25], # ] '\n]"))
    assert caught.value.place == "a.toml, line 4: toy.shift 3000 1"
    assert read(LONG).file == Path('b/a"[b')


def test_a_recorded_file_may_have_the_names_of_its_version() -> None:
    assert read("[toy]\nmost = 0.3", recorded=True).limit == 0.3


def test_a_size_without_its_unit_is_refused_where_it_must_be_stated(golden: Golden) -> None:
    with golden.raises():
        parse_setting(members(Toy)["limit"], "0.3")


def test_the_docstring_lists_every_setting() -> None:
    assert "reach\n    How far it reaches. It reaches all around. (metres; finite and above 0)" in str(Toy.__doc__)


# ------------------------------------------------------------------ all settings of helibore

EVERY = every_group()
ALL = [(group, member) for group, kind in EVERY.items() for member in members(kind).values()]


@pytest.mark.parametrize(("group", "member"), ALL, ids=[f"{group}.{member.name}" for group, member in ALL])
def test_every_setting_has_one_name_one_rule_and_one_text(group: str, member: Any) -> None:
    assert re.fullmatch("[a-z][a-z0-9_]*", member.name)
    assert member.text.endswith(".")
    page = (ROOT / "docs/reference/settings.md").read_text()
    row = next(
        line for line in page.partition(f"## `[{group}]`")[2].splitlines() if line.startswith(f"| `{member.name}`")
    )
    assert member.text.replace("|", "\\|") in row
    assert member.rule_text.replace("|", "\\|") in row
    assert member.text in str(EVERY[group].__doc__)
    if member.option is not None:
        names, settings = option_of(member)
        assert names.split()[0] in (f"--{member.name.replace('_', '-')}", f"--no-{member.name.replace('_', '-')}")
        assert member.text.startswith(settings["help"].partition("  [")[0])


def test_the_page_and_the_keywords_are_those_of_the_declarations() -> None:
    """If this fails: ./develop settings."""
    assert (ROOT / "docs/reference/settings.md").read_text() == listing.page(EVERY)
    assert (ROOT / "python/helibore/settings/keywords.py").read_text() == listing.keywords()


def test_a_new_setting_appears_everywhere() -> None:
    @dataclass(frozen=True, kw_only=True)
    class Longer(GROUPS["wall"]):  # type: ignore[misc]
        """Settings of a wall, and one more."""

        warp: Annotated[float, METRES, POSITIVE, Option(), "How warped it is."] = 0.25

    Longer.__annotations__["warp"] = Annotated[float, METRES, POSITIVE, Option(), "How warped it is."]
    groups = {**GROUPS, "wall": Longer}
    assert ("wall.warp", "metres", "0.25m", "finite and above 0", "How warped it is.") in list(listing.rows(groups))
    assert "| `warp` | metres | 0.25m | finite and above 0 | How warped it is. |" in listing.page(groups)
    assert "    warp: float\n" in listing.keywords(groups)
    assert parse_setting(members(Longer)["warp"], "3in") == pytest.approx(0.0762)
    assert read("[toy]\nbit_diameter='8.5in'\nwarp = '3in'", Longer).warp == pytest.approx(0.0762)
    assert ("--warp", "How warped it is.  [default: 0.25m]") in [(n, s["help"]) for n, s in options_of(Longer)]
    assert "warp\n    How warped it is." in str(Longer.__doc__)
