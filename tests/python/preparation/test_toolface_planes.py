"""Angles with their plane and their north: made from a direction in space, read from a file, and turned onto a path."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import helibore as hb
from helibore.channels.role_map import overlay, read_map
from helibore.channels.roles import guess
from helibore.preparation.prepare import Preparation
from helibore.trajectory.references import AngleReference, Norths, horizontal_to_north, onto_path, to_high_side

ROWS = 60


def apart(a, b):
    return (np.asarray(a) - np.asarray(b) + 180) % 360 - 180


def angles_of(relative_bearing, inclination, azimuth):
    """Return P1AZ and P1NO of a pad, by its direction in space; no formula of the package is used."""
    rb, steep, away = (np.radians(each) for each in (relative_bearing, inclination, azimuth))
    tangent = np.array([np.sin(steep) * np.cos(away), np.sin(steep) * np.sin(away), np.cos(steep)])
    high = np.array([np.cos(steep) * np.cos(away), np.cos(steep) * np.sin(away), -np.sin(steep)])
    right = np.cross(tangent, high)
    pad = np.cos(rb)[:, None] * high + np.sin(rb)[:, None] * right
    north = np.array([1.0, 0.0, 0.0]) - tangent[0] * tangent
    horizontal = np.degrees(np.arctan2(pad[:, 1], pad[:, 0])) % 360
    section = np.degrees(np.arctan2(pad @ np.cross(tangent, north), pad @ north)) % 360
    return horizontal, section


def las(path: Path, columns: dict[str, np.ndarray | float], described: dict[str, str] | None = None) -> Path:
    columns = {"DEPT": 100.0 + 0.1 * np.arange(ROWS)} | columns | {"C1": 8.5, "C2": 8.9}
    units = {"DEPT": "M", "C1": "IN", "C2": "IN"}
    text = "~V\nVERS. 2.0:\nWRAP. NO:\n~W\nNULL. -999.25:\n~C\n"
    text += "".join(f"{name}.{units.get(name, 'DEG')} : {(described or {}).get(name, '')}\n" for name in columns)
    rows = np.stack([np.broadcast_to(values, ROWS) for values in columns.values()], axis=1)
    path.write_text(text + "~A\n" + "\n".join(" ".join(f"{value:.6f}" for value in row) for row in rows) + "\n")
    return path


def path_of(inclination: float, azimuth: float, reference="high-side", north=""):
    return hb.Survey([0.0, 500.0], [inclination] * 2, [azimuth] * 2, north=north).path(reference=reference)


@settings(deadline=None, max_examples=60)
@given(st.integers(0, 10**6), st.floats(0.5, 179.0).filter(lambda x: abs(x - 90) > 0.5), st.floats(0, 359))
def test_angles_in_both_planes_are_those_of_one_direction(seed, inclination, azimuth):
    rb = np.random.default_rng(seed).uniform(0, 360, 20)
    horizontal, section = angles_of(rb, inclination, azimuth)
    np.testing.assert_allclose(apart(to_high_side(horizontal, inclination, azimuth), rb), 0, atol=1e-6)
    np.testing.assert_allclose(apart(to_high_side(section, inclination, azimuth, "section"), rb), 0, atol=1e-9)
    there = np.full(20, inclination), np.full(20, azimuth)
    np.testing.assert_allclose(apart(horizontal_to_north(horizontal, *there), section), 0, atol=1e-6)
    for reference in ("high-side", "north", "parallel-transport"):
        path, depth = path_of(inclination, azimuth, reference), np.full(20, 250.0)
        want = onto_path(rb, depth, path, True)
        got = onto_path(horizontal - 7.0, depth, path, False, horizontal=True, north=7.0)
        np.testing.assert_allclose(apart(got, want), 0, atol=1e-6)


@pytest.mark.parametrize("inclination", [0.5, 10.0, 30.0, 60.0, 80.0])
@pytest.mark.parametrize(
    ("names", "kind"),
    [
        (("RB", "DEVI", "HAZI"), "rb"), (("P1AZ", "DEVI", "HAZI"), "az"), (("P1NO", "DEVI", "HAZI"), "no"),
        (("AZI1", "SDEV", "HAZIM"), "az"), (("IAP1", "ITLT", "IAZI"), "az"), (("P1NO_FBST", "DEVIM", "AZIM"), "no"),
        (("HSRB", "INC", "AZM"), "rb"), (("P1AZ_OBMT", "DHAV", "DAZ"), "az"),
    ],
)  # fmt: skip
def test_four_angles_in_one_file(tmp_path, names, kind, inclination):
    rb = np.random.default_rng(int(inclination)).uniform(0, 360, ROWS)
    azimuth = 223.0
    horizontal, section = angles_of(rb, inclination, azimuth)
    toolface = {"rb": rb, "az": horizontal, "no": section}[kind]
    file = hb.open(las(tmp_path / "f.las", dict(zip(names, (toolface, inclination, azimuth), strict=True))))
    for own in (True, False):  # by the directions in the file, or by those of the path
        readings = file.readings() if own else file.readings(without(file.set(), names[2]))
        made = hb.prepare(readings, hb.Preparation(turn_spikes=None), path=path_of(inclination, azimuth)).caliper
        first = made.toolface.reshape(ROWS, 4)[:, [0, 2]]  # C1 looks along the pad, C2 90 degrees beside it
        order = np.argsort(made.depth.reshape(ROWS, 4)[:, 0])
        np.testing.assert_allclose(apart(first[:, 0], rb[order]), 0, atol=0.001)
        np.testing.assert_allclose(apart(first[:, 1], rb[order] + 90), 0, atol=0.001)


def without(log_set, name):
    return overlay(guess(log_set), log_set, {name: {"role": "none"}})


def test_angles_of_one_file_are_checked_against_each_other(tmp_path, golden):
    rb = np.random.default_rng(3).uniform(0, 360, ROWS)
    horizontal, section = angles_of(rb, 35.0, 80.0)
    columns = {"RB": rb, "P1AZ": horizontal, "P1NO": section, "DEVI": 35.0, "HAZI": 80.0}
    notes = hb.open(las(tmp_path / "a.las", columns)).readings().notes
    golden([note.split(":")[0] for note in notes if "agree" in note])  # fmt: skip
    assert not any("disagree" in note for note in notes)
    wrong = columns | {"P1AZ": (horizontal - 6.5) % 360}
    described = {"P1AZ": "Pad 1 azimuth from magnetic north", "HAZI": "Hole azimuth, true north"}
    (note,) = (n for n in hb.open(las(tmp_path / "b.las", wrong, described)).readings().notes if "disagree" in n)
    assert note.startswith("RB and P1AZ, by HAZI: disagree by -")
    assert "P1AZ magnetic north, the hole true north" in note


def test_repeated_angles_have_their_roles_and_are_checked_too(tmp_path):
    """helibore numbers repeated names; the first of equal angles is used."""
    rb = np.random.default_rng(3).uniform(0, 360, ROWS)
    horizontal, _ = angles_of(rb, 35.0, 80.0)
    columns = {"P1AZ:1": horizontal, "P1AZ:2": (horizontal + 3) % 360, "DHAV": 35.0, "SAZIMC": 80.0}
    (note,) = (one for one in hb.open(las(tmp_path / "a.las", columns)).readings().notes if "agree" in one)
    assert note.startswith("P1AZ:1 and P1AZ:2, by SAZIMC: disagree by +")
    notes = hb.open(las(tmp_path / "b.las", {"IRHS": rb} | columns)).readings().notes
    said = [note.partition(" deg (median)")[0] for note in notes if "agree" in note]
    assert said[0] == "IRHS and P1AZ:1, by SAZIMC: agree, to +0.00"
    assert said[1].startswith("IRHS and P1AZ:2, by SAZIMC: disagree by +")


def test_north_needs_its_declination(tmp_path, golden):
    rb = np.random.default_rng(5).uniform(0, 360, ROWS)
    horizontal, section = angles_of(rb, 40.0, 130.0)
    for name, true in (("P1AZ", horizontal), ("P1NO", section)):
        described = {name: "Pad 1 north, from magnetic north" if name == "P1NO" else "Pad 1 azimuth, magnetic"}
        magnetic = (horizontal - 12.0) % 360
        if name == "P1NO":  # from the direction of magnetic north across the hole: the azimuth is 12 degrees less
            magnetic = angles_of(rb, 40.0, 118.0)[1]
        readings = hb.open(las(tmp_path / "m.las", {name: magnetic}, described)).readings()
        assert readings.north == "magnetic"
        path = path_of(40.0, 130.0, north="true")
        with pytest.raises(hb.InputError) as caught:
            hb.prepare(readings, path=path)
        golden(caught.value.rule)
        assert caught.value.place == "m.las: declination"
        made = hb.prepare(readings, Preparation(declination=12.0), path).caliper
        np.testing.assert_allclose(apart(made.toolface[::4], rb), 0, atol=0.001)
        plain = hb.prepare(readings, path=path_of(40.0, 118.0)).caliper  # a survey without a stated north
        np.testing.assert_allclose(apart(plain.toolface[::4], rb), 0, atol=0.001)
        assert true.size == ROWS


def test_two_norths_in_one_file(tmp_path, golden):
    horizontal, _ = angles_of(np.arange(ROWS) * 5.0, 40.0, 130.0)
    described = {"P1AZ": "Pad 1 azimuth, magnetic", "HAZI": "Hole azimuth, true north"}
    columns = {"P1AZ": (horizontal - 12.0) % 360, "DEVI": 40.0, "HAZI": 130.0}
    readings = hb.open(las(tmp_path / "two.las", columns, described)).readings()
    with pytest.raises(hb.InputError) as caught:
        hb.prepare(readings)
    golden((caught.value.place, caught.value.rule))
    made = hb.prepare(readings, Preparation(declination=12.0), path_of(40.0, 130.0, north="true")).caliper
    np.testing.assert_allclose(apart(made.toolface[::4], np.arange(ROWS) * 5.0), 0, atol=0.001)


def test_norths_turn_into_each_other():
    norths = Norths(declination=-4.0, convergence=1.5)
    assert norths.turn("magnetic", "true") == -4.0
    assert norths.turn("true", "grid") == -1.5
    assert norths.turn("magnetic", "grid") == -5.5
    assert norths.turn("", "grid") == norths.turn("grid", "grid") == 0.0
    with pytest.raises(hb.InputError) as caught:
        Norths(declination=3.0).turn("magnetic", "grid")
    assert caught.value.place == "convergence"
    with pytest.raises(hb.InputError) as caught:
        Norths(declination=float("nan"))
    assert caught.value.place == "declination"


def test_a_reference_is_a_plane_a_zero_and_a_north(golden):
    assert AngleReference.named("horizontal-north", "grid") == AngleReference("north", "horizontal", "grid")
    golden(str(AngleReference("north", "horizontal", "magnetic")))
    for wrong in ({"zero": "high-side", "north": "true"}, {"zero": "high-side", "plane": "horizontal"}):
        with pytest.raises(hb.InputError):
            AngleReference(**wrong)


def test_the_horizontal_plane_shows_no_toolface_in_a_horizontal_hole(golden):
    with pytest.raises(hb.InputError) as caught:
        onto_path([10.0], [100.0], path_of(90.0, 30.0), False, horizontal=True)
    golden(caught.value.rule)
    assert np.isnan(to_high_side(10.0, 90.0, 30.0))


def test_a_map_adds_names(tmp_path):
    rb = np.arange(ROWS) * 6.0 % 360
    file = hb.open(las(tmp_path / "f.las", {"XTURN": rb}))
    assert guess(file.set()).one("toolface") is None
    names = tmp_path / "names.toml"
    names.write_text('[[names]]\nnames = ["XTURN", "YTURN"]\nrole = "toolface"\nreference = "high-side"\n')
    role = read_map(names, file)["XTURN"]
    assert (role.role, role.reference, role.confirmed) == ("toolface", "high-side", False)
    for text, place in (
        ('[[names]]\nnames = []\nrole = "toolface"', "names.toml, line 2: names 1.names"),
        ('[[names]]\nnames = ["A"]\nrole = "tool"', "names.toml, line 3: names 1.role"),
        ('[[names]]\nnames = ["A"]\nrole = "radius"\nangle = true', "names.toml, line 4: names 1.angle"),
        ('[[names]]\nnames = ["A"]\nrole = "toolface"\nnorth = "up"', "names.toml, line 4: names 1.north"),
    ):
        names.write_text(text)
        with pytest.raises(hb.InputError) as caught:
            read_map(names, file)
        assert caught.value.place == place
