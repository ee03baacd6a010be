"""Picks: their dips against a plane in space, their table, and the file beside an archive."""

from __future__ import annotations

import copy
import csv
import pickle
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from golden_texts import Golden

import helibore as hb
from helibore.base.errors import InputError
from helibore.logs.picks import CLASSES, MOST, Pick, Picks, pick_of, plane


def path(inclination: float, azimuth: float) -> hb.Path:
    return hb.Survey([0.0, 100.0], [inclination] * 2, [azimuth] * 2).path()


@pytest.mark.parametrize(("inclination", "azimuth"), [(0.001, 0.0), (40.0, 200.0), (88.0, 300.0), (120.0, 45.0)])
@pytest.mark.parametrize(("dip", "towards"), [(12.0, 75.0), (35.0, 340.0), (60.0, 180.0)])
def test_a_plane_has_the_dip_it_was_made_with_and_lies_in_space(
    inclination: float, azimuth: float, dip: float, towards: float
) -> None:
    hole = path(inclination, azimuth)
    pick = plane("bed", 50.0, dip, towards, hole)
    assert pick.dip(hole) == pytest.approx((dip, towards), abs=1e-9)
    steep, leaning = np.radians([dip, towards])
    normal = np.array([np.sin(steep) * np.cos(leaning), np.sin(steep) * np.sin(leaning), -np.cos(steep)])
    high, right, along = hole.frame(np.array([50.0]))[0]
    for toolface in np.radians([0.0, 77.0, 200.0]):
        outwards = np.cos(toolface) * high + np.sin(toolface) * right
        deeper = np.tan(np.radians(pick.apparent_dip)) * np.cos(toolface - np.radians(pick.toolface))
        assert abs((0.1 * (outwards + deeper * along)) @ normal) < 1e-12


def test_without_a_path_or_beyond_it_a_dip_is_not_known(golden: Golden) -> None:
    pick = Pick(kind="bed", depth=150.0, toolface=10.0, apparent_dip=30.0)
    assert np.isnan(pick.dip(None)).all()
    assert np.isnan(pick.dip(path(10.0, 0.0))).all()
    box = Pick(kind="breakout", depth=50.0, toolface=10.0, height=2.0, opening=30.0)
    assert np.isnan(box.dip(path(10.0, 0.0))).all()
    with golden.raises():
        plane("bed", 50.0, 90.0, 90.0, hb.Survey([0.0, 100.0], [0.0] * 2, [0.0] * 2).path(reference="north"))
    assert np.isnan(Pick(kind="bed", depth=50.0, toolface=1.0).dip(path(0.0, 0.0))).all(), "no high side: no frame"


HIDDEN = "must not hold control characters, marks that turn text around or halves of surrogate pairs"


@pytest.mark.parametrize(
    "values",
    [
        {"kind": "layer"},
        {"depth": float("nan")},
        {"apparent_dip": 90.0},
        {"toolface": "east"},
        {"kind": "breakout"},
        {"points": 1.5},
        {"points": True},
        {"depth": None},
        {"apparent_dip": True},
        {"note": "half an emoji \ud83d"},
        {"note": "\x1b[31m\u202e"},
        {"note": "x" * 81},
        {"key": "x" * 33},
        {"colour": "red"},
    ],
)
def test_what_breaks_a_rule_is_refused(values: dict[str, object], golden: Golden) -> None:
    with golden.raises():
        pick_of({"kind": "bed", "depth": 1.0, "toolface": 0.0} | values)


def test_numbers_of_numpy_are_numbers() -> None:
    pick = Pick(kind="bed", depth=np.int64(2054), toolface=np.float32(140.5), points=np.int32(7))  # type: ignore[arg-type]
    assert Picks.parse(Picks([pick]).table()) == [Pick(kind="bed", depth=2054.0, toolface=140.5, points=7)]


def test_a_pick_without_a_depth_and_one_too_many_are_refused(golden: Golden) -> None:
    with golden.raises():
        pick_of({"kind": "bed", "toolface": 1.0})
    one = Pick(kind="bed", depth=1.0, toolface=0.0)
    picks = Picks([one] * MOST)
    picks.put(one)
    with golden.raises():
        picks.put(Pick(kind="bed", depth=1.0, toolface=0.0))


def test_a_table_that_is_no_text_is_refused(tmp_path: Path) -> None:
    file = tmp_path / "x.picks.csv"
    file.write_bytes(b"class,depth_m\xff")
    with pytest.raises(InputError) as raised:
        Picks.load(file)
    assert str(raised.value) == f"{file}: must be UTF-8 text"


def test_a_table_is_read_as_it_was_written(tmp_path: Path) -> None:
    hole = path(30.0, 60.0)
    picks = Picks(
        [
            Pick(kind="breakout", depth=20.0, toolface=359.5, height=2.0, opening=40.0, tilt=-5.0),
            Pick(
                kind="fracture",
                depth=10.25,
                toolface=12.0,
                apparent_dip=61.5,
                note='open, "wide"\nindeed',
                image="GR",
                dip_sigma=2.5,
                toolface_sigma=4.0,
                aperture=0.017,
            ),
            plane("bed", 15.0, 20.0, 100.0, hole),
        ]
    )
    file = tmp_path / "well.wall.picks.csv"
    picks.save(file, hole)
    again = Picks.load(file)
    assert [one.depth for one in again] == [10.25, 15.0, 20.0]
    for one, before in zip(again, sorted(picks, key=lambda pick: pick.depth), strict=True):
        assert vars(one) == pytest.approx(vars(before))
    rows = file.read_text().splitlines()
    assert rows[0].startswith("class,DEPT (m),TOOLFACE (deg),APPARENT_DIP (deg),RADIUS (m),")
    assert rows[-2].endswith(",20,100,,,"), "the true dip stands in the table"
    (sure,) = [row for row in csv.DictReader(file.read_text().splitlines()) if row["class"] == "fracture"]
    sigmas = [float(sure[name]) for name in ("DIP_SIGMA (deg)", "DIP_AZIMUTH_SIGMA (deg)")]
    assert 1.96 * np.array(sigmas) == pytest.approx(again[0].dip_interval(hole), rel=1e-6)
    with file.open(newline="") as text:
        (fracture, bed, _) = csv.DictReader(text)
    own = ("APPARENT_DIP_SIGMA (deg)", "TOOLFACE_SIGMA (deg)", "APERTURE (m)")
    assert [fracture[name] for name in own] == ["2.5", "4", "0.017"]
    assert bed["APERTURE (m)"] == "", "not known"


def test_a_table_without_keys_gives_the_same_ones_at_every_reading_and_no_key_twice() -> None:
    rows = "class,depth_m,toolface_deg,apparent_dip_deg,key\nbed,1,2,3,\nbed,2,2,3,\nbed,3,2,3,x\nbed,4,2,3,x\n"
    first, again = (Picks.parse(rows) for _ in range(2))
    assert [one.depth for one in first] == [1.0, 2.0, 3.0, 4.0]
    assert [one.key for one in first[:3]] == [one.key for one in again[:3]]
    assert len({one.key for one in first}) == 4


def test_a_table_adds_replaces_and_leaves_picks_by_their_key() -> None:
    thirds = (Pick(kind="bed", depth=at / 3.0, toolface=2.0, apparent_dip=30.0, note="x") for at in (1, 2, 4))
    picks = Picks(thirds)
    older = Picks.parse(picks.table())
    assert picks.merge(older) == ([], []), "equal to the digits of a table"
    picks[1] = replace(picks[1], kind="fault", depth=0.7)
    picks.remove_key(picks[2].key)
    elsewhere = replace(older[0], key="other")
    assert picks.merge([*older, elsewhere]) == ([older[2]], [older[1]])
    assert [vars(one) for one in picks[1:]] == [vars(one) for one in older[1:]]
    assert len(picks) == 3


def test_true_dips_of_others_become_picks_on_a_path(golden: Golden) -> None:
    hole = path(30.0, 60.0)
    text = "well,depth_m,class,dip_deg,dip_azimuth_deg\nA,15,bed,20,100\nA,16,fault,70,280\n"
    bed, fault = Picks.parse(text, hole)
    assert bed.dip(hole) == pytest.approx((20.0, 100.0))
    assert (fault.kind, fault.dip(hole)) == ("fault", pytest.approx((70.0, 280.0)))
    with golden.raises():
        Picks.parse(text)
    with pytest.raises(InputError) as raised:
        Picks.parse("DEPTH,DIP,AZI,TYPE\n", hole)
    golden(raised.value.rule)


def test_a_table_of_true_dips_keeps_its_other_columns_and_its_breakouts() -> None:
    head = "class,depth_m,dip_deg,dip_azimuth_deg,radius_m,misfit_m,points,toolface_deg,height_m,opening_deg\n"
    bed, box = Picks.parse(f"{head}bed,15,20,100,0.11,0.002,9,,,\nbreakout,20,,,,,,75,2,40\n", path(30.0, 60.0))
    assert (bed.radius, bed.misfit, bed.points) == (0.11, 0.002, 9)
    assert box == Pick(kind="breakout", depth=20.0, toolface=75.0, height=2.0, opening=40.0)


@pytest.mark.parametrize(
    ("dip", "azimuth", "place"),
    [
        ("inf", "10", "line 2: plane at 15 m"),
        ("10", "nan", "line 2: plane at 15 m"),
        ("", "10", "line 2, DIP (deg)"),
    ],
)
def test_a_true_dip_is_a_finite_number(dip: str, azimuth: str, place: str, golden: Golden) -> None:
    with golden.raises(place):
        Picks.parse(f"class,depth_m,dip_deg,dip_azimuth_deg\nbed,15,{dip},{azimuth}\n", path(30.0, 60.0))


@pytest.mark.parametrize(
    ("text", "error"),
    [
        ("DEPTH,DIP,AZI,TYPE\n", "line 1: must have the columns class, DEPT (m), TOOLFACE (deg), APPARENT_DIP (deg)"),
        ("class,depth_m,apparent_dip_deg\n", "line 1: must have the columns TOOLFACE (deg)"),
        ("class,depth_m,toolface_deg,apparent_dip_deg\nbed,x,1,2\n", "line 2, DEPT (m) = 'x': must be a number"),
        (
            "class,depth_m,toolface_deg,apparent_dip_deg\nbed,1,,2\n",
            "line 2: class, depth and toolface must not be empty",
        ),
        (
            "class,depth_m,toolface_deg,apparent_dip_deg\nrock,1,1,2\n",
            f"line 2: class = 'rock': must be one of {', '.join(CLASSES)}",
        ),
        *(
            (
                f"class,depth_m,toolface_deg,apparent_dip_deg,points\nbed,1,1,2,{points}\n",
                f"line 2: points = {points}: must be a whole number, 0 or more",
            )
            for points in ("inf", "nan", "2.5")
        ),
    ],
)
def test_a_table_that_breaks_a_rule_names_the_line(tmp_path: Path, text: str, error: str) -> None:
    file = tmp_path / "x.picks.csv"
    file.write_text(text)
    with pytest.raises(InputError) as raised:
        Picks.load(file)
    assert str(raised.value) == f"{file}: {error}"


def test_the_picks_of_a_wall_stand_beside_its_archive_and_go_with_its_copies(tmp_path: Path) -> None:
    wall = hb.reconstruct(hb.Caliper.gauge(0.0, 5.0, 0.2), bit_diameter=0.2, sectors=16)
    file = tmp_path / "a.wall"
    wall.save(file)
    assert not (tmp_path / "a.wall.picks.csv").exists()
    assert hb.load(file).picks == []
    wall.picks.append(Pick(kind="bed", depth=2.0, toolface=10.0, apparent_dip=30.0))
    wall.save(file)
    assert hb.load(file).picks == wall.picks
    for other in (copy.deepcopy(wall), pickle.loads(pickle.dumps(wall))):
        assert other.picks == wall.picks
        other.picks.clear()
        assert len(wall.picks) == 1


@pytest.mark.parametrize(("apparent", "toolface"), [(12.0, 30.0), (40.0, 200.0), (70.0, 310.0)])
def test_intervals_of_dip_and_azimuth_hold_what_hands_draw(apparent: float, toolface: float) -> None:
    """Picks whose apparent dip and toolface scatter around a plane by their sigmas hold its dip and azimuth."""
    hole = path(40.0, 60.0)
    truth = Pick(kind="bed", depth=50.0, apparent_dip=apparent, toolface=toolface).dip(hole)
    rng, held = np.random.default_rng(3), np.zeros(2)
    for _ in range(400):
        drawn = Pick(
            kind="bed", depth=50.0, apparent_dip=apparent + rng.normal(0, 1.0),
            toolface=(toolface + rng.normal(0, 2.0)) % 360, dip_sigma=1.0, toolface_sigma=2.0,
        )  # fmt: skip
        off = np.subtract(drawn.dip(hole), truth)
        off[1] = (off[1] + 180) % 360 - 180
        held += np.abs(off) <= drawn.dip_interval(hole)
    assert np.all(held / 400 > 0.92), held


def test_classes_of_other_programs_are_read_and_kept_in_the_note() -> None:
    head = "class,depth_m,toolface_deg,apparent_dip_deg,note\n"
    rows = "Closed fracture,10,5,30,\nopen fracture,11,5,30,F2\nfracture,12,5,30,\nvein,13,5,30,\n"
    found = [(pick.kind, pick.note) for pick in Picks.parse(head + rows)]
    assert found == [
        ("healed fracture", "Closed fracture"), ("fracture", "F2"), ("fracture", ""), ("healed fracture", "vein"),
    ]  # fmt: skip
    with pytest.raises(InputError, match=r"line 2: class = 'cavern': must be one of bed, fracture"):
        Picks.parse(head + "cavern,10,5,30,\n")


def test_intervals_of_a_pick_without_a_path_are_those_of_its_own_angles() -> None:
    pick = Pick(kind="bed", depth=1000.0, apparent_dip=30.0, toolface=5.0, dip_sigma=2.0, toolface_sigma=120.0)
    assert pick.dip_interval(None) == (3.92, 180.0)
    assert np.isnan(Pick(kind="bed", depth=1000.0, toolface=5.0).dip_interval(None)).all()
