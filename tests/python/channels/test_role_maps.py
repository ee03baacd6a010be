"""Maps that override guesses, ready to edit, and ``helibore inspect``, which prints them."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from click.testing import CliRunner
from golden_texts import Golden
from wall_samples import wall_samples

import helibore as hb
from helibore.channels.role_map import overlay, quoted, read_map, write_map
from helibore.channels.roles import guess


def xy_file(folder: Path) -> Path:
    path = folder / "xy.csv"
    path.write_text(
        "md_m,rb_deg,cal_x_in,cal_y_in,bs\n" + "".join(f"{n},{n * 9 % 360},8.6,8.7,8.5\n" for n in range(40))
    )
    return path


def test_map_round_trip(tmp_path: Path) -> None:
    pytest.importorskip("pyarrow")
    file = hb.open(xy_file(tmp_path))
    roles = guess(file.set())
    (tmp_path / "m.toml").write_text(write_map(roles))
    again = read_map(tmp_path / "m.toml", file)
    for role in roles:
        assert (again[role.channel].role, again[role.channel].angle, again[role.channel].unit) == (
            role.role, role.angle, role.unit,
        )  # fmt: skip
        assert again[role.channel].confirmed == (role.role != "none")
    (tmp_path / "m.toml").write_text(
        '[channels."bs"]\nrole = "bit-diameter"\nunit = "in"\n[channels.cal_x_in]\nangle = 45\n'
    )
    again = read_map(tmp_path / "m.toml", file)
    assert (again["bs"].unit, again["cal_x_in"].angle, again["cal_x_in"].unit) == ("in", 45.0, "in")
    assert wall_samples(file, again).toolface[0] == 45.0


@pytest.mark.parametrize(
    "text",
    [
        "channels = 3",
        "x = 1",
        "[",
        'set = "other"',
        "[channels.nope]",
        "[channels.bs]\nrole = 'bit'",
        "[channels.bs]\n\nunit = 3",
        "[channels.bs]\nangle = 'x'",
        "[channels.bs]\nangles = 3",
        "[channels.bs]\nrole = 'depth'\nunit = 'deg'",
        "[channels.bs]\nrole = 'depth'\n[channels.md_m]\nrole = 'depth'",
        "[channels]\nbs = 3",
    ],
)
def test_bad_maps(tmp_path: Path, text: str, golden: Golden) -> None:
    pytest.importorskip("pyarrow")
    file = hb.open(xy_file(tmp_path))
    (tmp_path / "m.toml").write_text(text)
    with golden.raises():
        read_map(tmp_path / "m.toml", file)


def test_a_map_of_strange_names_is_ready_to_edit(tmp_path: Path) -> None:
    path = tmp_path / "s.csv"
    path.write_text("at,tilt,heading\n6500,5,40\n6700,7,50\n")
    text = write_map(guess(hb.open(path).set()))
    roles = {"at": ("depth", "ft"), "tilt": ("inclination", "deg"), "heading": ("azimuth", "deg")}
    for name, (role, unit) in roles.items():
        entry = f'# [channels."{name}"]\n# role = ""   # no rule fits\n# unit = ""\n'
        assert entry in text
        text = text.replace(entry, f'[channels."{name}"]\nrole = "{role}"   # no rule fits\nunit = "{unit}"\n')
    (tmp_path / "m.toml").write_text(text)
    found = read_map(tmp_path / "m.toml", hb.open(path))
    assert {name: (found[name].role, found[name].unit) for name in roles} == roles
    assert hb.open(path).survey(found).depth[0] == pytest.approx(6500 * 0.3048)
    whole = write_map(guess(hb.open(xy_file(tmp_path)).set()))
    assert "# Without a role" not in whole
    log = tmp_path / "l.csv"
    log.write_text("md_m,rb_deg,cal_x_in,cal_y_in,x1,x2x\n" + "".join(f"{n},{n * 9 % 360},8,8,1,1\n" for n in range(9)))
    assert write_map(guess(hb.open(log).set())).endswith('# Without a role: "x1", "x2x"\n')


def test_inspect_tells_what_would_be_refused(tmp_path: Path) -> None:
    from helibore.cli.inspect_command import inspect

    path = tmp_path / "r.csv"
    path.write_text("md_m,tf_deg,radius_m\n" + "".join(f"{n},{n % 6}.2,0.108\n" for n in range(40)))
    shown = CliRunner().invoke(inspect, [str(path)], env={"COLUMNS": "240"})
    rule = "r.csv, column tf_deg: values between 0.2 and 5.2 deg: looks like radians; state the unit in a map or as"
    assert f"refused with these roles: {rule}" in shown.output
    assert f"# Refused with these roles: {rule}" in shown.output
    bare = CliRunner().invoke(inspect, [str(path), "--toml"])
    assert bare.output.startswith(f"# Refused with these roles: {rule}")
    fine = CliRunner().invoke(inspect, [str(xy_file(tmp_path))])
    assert "efused" not in fine.output


def test_mapping_a_role_takes_it_from_the_guess(tmp_path: Path, golden: Golden) -> None:
    pytest.importorskip("pyarrow")
    one = hb.open(xy_file(tmp_path)).set()
    roles = overlay(guess(one), one, {"bs": {"role": "depth", "unit": "m"}})
    golden((roles["bs"].role, roles["md_m"].role, roles["md_m"].reason))


def test_quoted_names_survive() -> None:
    import tomllib

    name = 'a"b\\c\n\x7f é [1] \U000f0000'
    assert tomllib.loads(f"x = {quoted(name)}")["x"] == name


def test_a_description_with_control_characters_leaves_the_map_readable(tmp_path: Path) -> None:
    curves = [{"name": "MD", "unit": "m"}, {"name": "HC", "unit": "in", "description": "caliper\r\n\x1b[1m, mean"}]
    (tmp_path / "l.json").write_text(json.dumps([{"header": {}, "curves": curves, "data": [[1.0, 8.5], [2.0, 8.5]]}]))
    file = hb.open(tmp_path / "l.json")
    text = write_map(guess(file.set()), warning="a\rb")
    assert "# named or described as a caliper (caliper   [1m, mean) without a direction" in text
    (tmp_path / "m.toml").write_text(text)
    assert read_map(tmp_path / "m.toml", file)["HC"].role == "mean-diameter"


def test_inspect(tmp_path: Path, golden: Golden) -> None:
    pytest.importorskip("pyarrow")
    from helibore.cli.inspect_command import inspect

    path = xy_file(tmp_path)
    shown = CliRunner().invoke(inspect, [str(path)], env={"COLUMNS": "160"})
    assert shown.exit_code == 0
    for text in (
        "table: 40 rows",
        "cal_x_in",
        "8.6 .. 8.6",
        "md_m: median step 1 m",
        '[channels."cal_y_in"]',
        "angle = 90.0",
    ):
        assert text in shown.output
    bare = CliRunner().invoke(inspect, [str(path), "--toml"])
    (tmp_path / "m.toml").write_text(bare.output)
    assert set(read_map(tmp_path / "m.toml", hb.open(path)).roles) == set(hb.open(path).set().names)
    mapped = CliRunner().invoke(inspect, [str(path), "--map", str(tmp_path / "m.toml")], env={"COLUMNS": "160"})
    assert "the map" in mapped.output
    (tmp_path / "empty").touch()
    bad = CliRunner().invoke(inspect, [str(tmp_path / "empty")])
    assert isinstance(bad.exception, ValueError)  # the group of verbs turns it into one line and exit code 2
    assert str(bad.exception) == "empty: empty: 0 bytes"
    wrong = CliRunner().invoke(inspect, [str(path), "--map", str(tmp_path / "m.toml"), "--set", "x"])
    golden(str(wrong.exception))


def test_inspect_in_a_narrow_terminal_and_in_the_group(tmp_path: Path) -> None:
    pytest.importorskip("pyarrow")
    from helibore.cli import cli

    narrow = CliRunner().invoke(cli, ["inspect", str(xy_file(tmp_path))], env={"COLUMNS": "80"})
    assert narrow.exit_code == 0
    assert "  md_m: depth, named md_m\n" in narrow.output
    assert max(map(len, narrow.output.splitlines())) <= 120
    (tmp_path / "empty").touch()
    bad = CliRunner().invoke(cli, ["inspect", str(tmp_path / "empty")])
    assert (bad.exit_code, bad.stderr) == (2, "helibore: empty: empty: 0 bytes\n")
