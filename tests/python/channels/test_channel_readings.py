"""From columns of a file to wall samples: units, arms, what is missing, where errors stand; two parsers that agree."""

from __future__ import annotations

import gzip
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from golden_texts import Golden
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from wall_samples import WallSamples, wall_samples

import helibore as hb
from helibore.base import units
from helibore.channels.channel_readings import readings
from helibore.channels.log_set import LogSet
from helibore.channels.role_map import overlay, parse_options, read_map
from helibore.channels.roles import RoleMap, guess
from helibore.files import delimited
from helibore.files.input_file import InputFile
from helibore.files.number_rows import read_rows
from helibore.files.raw_set import clean
from helibore.settings.preparation_settings import Echo


def written(folder: Path, text: str, name: str = "c.csv") -> Path:
    path = folder / name
    path.write_text(text, encoding="utf-8")
    return path


def chosen(path: Path, radius: Any = (), diameter: Any = (), **columns: str) -> tuple[LogSet, RoleMap]:
    one = hb.open(path).set()
    return one, parse_options(one, guess(one), columns, {"radius": radius, "diameter": diameter})


def read(path: Path, **columns: Any) -> WallSamples:
    one, roles = chosen(path, **columns)
    return wall_samples(one, roles)


def test_one_radius_a_row(tmp_path: Path, golden: Golden) -> None:
    found = read(written(tmp_path, "time_s,md_m,toolface_deg,radius_mm\n0,10,350,108\n1,10.1,370,109\n"))
    assert found.depth.tolist() == [10.0, 10.1]
    assert found.toolface.tolist() == [350.0, 10.0]
    assert found.radius.tolist() == [0.108, 0.109]
    assert found.time is not None
    assert found.time.tolist() == [0.0, 1.0]
    assert (found.rows, found.dropped) == (2, {})
    golden(found.notes)


def test_a_diameter_counts_for_both_sides(tmp_path: Path) -> None:
    path = written(tmp_path, "md_m,tf_deg,diameter_in\n10,20,8.5\n")
    for found in (read(path), read(path, diameter=["diameter_in"])):
        assert (found.toolface.tolist(), found.radius.tolist()) == ([20.0, 200.0], [0.5 * (8.5 * 0.0254)] * 2)
        assert found.time is None


def test_xy_caliper_is_four_wall_points_a_row(tmp_path: Path, golden: Golden) -> None:
    path = written(tmp_path, "MD\tRB\tX\tY\n1000\t0.5\t8\t9\n1001\t300\t10\t11\n")
    found = read(path, depth="MD:FT", toolface="RB:deg", diameter=["X@0:IN", "Y@90:INCHES"])
    np.testing.assert_allclose(found.depth, np.repeat([304.8, 305.1048], 4), rtol=1e-15)
    assert found.toolface.tolist() == [0.5, 180.5, 90.5, 270.5, 300.0, 120.0, 30.0, 210.0]
    np.testing.assert_allclose(found.radius / 0.0254, [4, 4, 4.5, 4.5, 5, 5, 5.5, 5.5], rtol=1e-15)
    golden(found.notes)


def test_radius_arms_at_angles(tmp_path: Path) -> None:
    path = written(tmp_path, "md_m;rb_deg;A;B;C\n5;300;100;200;300\n")
    found = read(path, radius=["A@0:mm", "B@120:mm", "C@240:mm"])
    assert found.toolface.tolist() == [300.0, 60.0, 180.0]
    np.testing.assert_allclose(found.radius, [0.1, 0.2, 0.3], rtol=1e-15)


def test_named_columns_leave_the_others_out(tmp_path: Path) -> None:
    path = written(tmp_path, "md_m,rb_deg,cal_x_in,cal_y_in,radius_mm\n5,300,8,9,107\n")
    assert read(path).radius.size == 5
    assert read(path, radius=["radius_mm"]).radius.tolist() == [0.107]
    _, roles = chosen(path, radius=["radius_mm"])
    assert (roles["cal_x_in"].role, roles["cal_x_in"].reason) == ("none", "other columns are named")


def test_toolface_in_radians(tmp_path: Path) -> None:
    found = read(written(tmp_path, "md_m,tf,radius_m\n5,-1.5707963267948966,0.1\n"), toolface="tf:RAD")
    assert found.toolface.tolist() == [270.0]


def test_missing_values_are_dropped_and_counted(tmp_path: Path) -> None:
    text = "md_m,rb_deg,x_in,y_in\n1,10,8,9\n-999.25,10,8,9\n2,,8,9\n3,10,-9999,9\n4,10,8,nan\n5,10,,\n6,-999.250,,\n"
    found = read(written(tmp_path, text), diameter=["x_in@0", "y_in@90"])
    assert found.rows == 7
    assert found.dropped == {"md_m": 1, "rb_deg": 2, "x_in": 3, "y_in": 3}
    assert found.depth.tolist() == [1, 1, 1, 1, 3, 3, 4, 4]
    assert found.toolface.tolist() == [10, 190, 100, 280, 100, 280, 10, 190]


def test_other_words_for_missing(tmp_path: Path) -> None:
    one = hb.open(written(tmp_path, "md_m,tf_deg,radius_m\n1,10,0\n2,10,0.1\n"), nulls=[0.0]).set()
    assert (wall_samples(one).dropped, wall_samples(one).depth.tolist()) == ({"radius_m": 1}, [2.0])


def test_comments_blank_lines_quotes_and_gzip(tmp_path: Path) -> None:
    path = tmp_path / "named.any"
    text = '# a comment\n\n"md_m","tf_deg",radius_m,remark\n1,10,"0.1",good\n\n 2 , 20 ,0.1,\n'
    path.write_bytes(gzip.compress(b"\xef\xbb\xbf" + text.encode()))
    assert read(path).depth.tolist() == [1.0, 2.0]


def test_npz_named_as_ours(tmp_path: Path) -> None:
    path = tmp_path / "c.npz"
    np.savez(path, depth=[1.0, 2.0], toolface=[10, 370], radius=np.float32([0.125, np.nan]), time=[0, 1])
    found = read(path)
    assert found.dropped == {"radius": 1}
    assert found.radius.tolist() == [0.125]
    remark = "radius: no unit stated; a binary column of this name is taken as m"
    assert remark in hb.open(path).set().remarks
    np.savez(path, md=[1.0, 2.0], toolface=[10, 370], radius=[0.1, 0.1])
    with pytest.raises(ValueError, match="column md: unit missing"):
        read(path)


@pytest.mark.parametrize(("travel_time", "radius"), [([100.0, 120.0], [0.115, 0.13]), ([5.0, 120.0], [np.nan, 0.13])])
def test_travel_time_becomes_radius(
    tmp_path: Path, travel_time: list[float], radius: list[float], golden: Golden
) -> None:
    rows = "".join(f"{n},{n * 90},{time}\n" for n, time in enumerate(travel_time))
    one = hb.open(written(tmp_path, f"md_m,tf_deg,tt_us\n{rows}")).set()
    assert guess(one)["tt_us"].role == "travel-time"
    found = one.readings(echo=Echo(1500.0, 0.0475, 10e-6))
    np.testing.assert_allclose(found.radii[0], radius, rtol=1e-12)
    with golden.raises():
        one.readings()


def test_travel_times_that_give_no_radius_of_a_borehole(tmp_path: Path) -> None:
    rows = "".join(f"{n},{n * 90},100\n" for n in range(8))
    one = hb.open(written(tmp_path, f"md_m,tf_deg,tt_us\n{rows}")).set()
    for velocity, bit, rule in (
        (1.5e6, None, "median radius 75 m from its travel times: no radius of a borehole; check the unit us, the "
                      "velocity in the mud and the tool's radius"),
        (1500.0, 0.12, "median radius 0.122 m from its travel times: looks like a diameter (the bit's diameter is 0.12 "
                       "m); check the velocity in the mud and the tool's radius"),
    ):  # fmt: skip
        with pytest.raises(hb.InputError) as caught:
            one.readings(bit_diameter=bit, echo=Echo(velocity, 0.0475))
        assert str(caught.value) == f"c.csv, column tt_us: {rule}"


def test_dates_between_blanks_keep_their_time_zone(tmp_path: Path) -> None:
    rows = "1,2,0.1, 1970-01-01T01:00:00+01:00\n2,3,0.1, 1970-01-01T00:00:05Z \n3,4,0.1,nat\n"
    text = f"md_m,tf_deg,radius_m,time\n{rows}"
    np.testing.assert_array_equal(hb.open(written(tmp_path, text)).readings().time, [0.0, 5.0, np.nan])
    for word in ("now", "today"):
        with pytest.raises(hb.InputError, match=f"line 3, column time: '{word}' is no ISO 8601 date and time"):
            hb.open(written(tmp_path, text.replace(" 1970-01-01T00:00:05Z ", word))).readings()


def test_travel_time_image(tmp_path: Path, golden: Golden) -> None:
    sectors = ",".join(f"TT{n}_us" for n in range(1, 9))
    path = written(tmp_path, f"md_m,{sectors}\n1,{','.join(['100'] * 8)}\n2,{','.join(['110'] * 8)}\n")
    one = hb.open(path).set()
    (image,) = (role for role in guess(one) if role.role == "travel-time")
    roles = overlay(guess(one), one, {image.channel: {"first": 0.0, "step": 45.0}})
    found = one.readings(roles, echo=Echo(1500.0, 0.05))
    assert [sensor.mounting for sensor in found.sensors] == [45.0 * n for n in range(8)]
    np.testing.assert_allclose(found.radii[3], [0.125, 0.1325])
    named = parse_options(one, guess(one), {}, {"travel-time": ["TT@30"]})
    assert [sensor.mounting for sensor in one.readings(named, echo=Echo(1500.0, 0.05)).sensors][:3] == [30, 75, 120]
    with golden.raises():
        parse_options(one, guess(one), {}, {"diameter": ["TT@30"]})


LENGTHS = ["m", "cm", "mm", "ft", "ftUS", "in", "0.1in", "0.1_in"]


@settings(max_examples=60, suppress_health_check=[HealthCheck.function_scoped_fixture], deadline=None)
@given(
    rows=st.lists(
        st.tuples(st.floats(-900, 20000).map(lambda depth: depth + 0.125), st.floats(-720, 720), st.floats(0.05, 0.4)),
        min_size=1,
        max_size=20,
    ),
    length=st.sampled_from(LENGTHS),
    size=st.sampled_from(LENGTHS),
    angle=st.sampled_from(["deg", "rad"]),
)
def test_written_in_any_unit_comes_back(
    tmp_path: Path, rows: list[tuple[float, float, float]], length: str, size: str, angle: str
) -> None:
    depth, toolface, radius = np.array(rows).T
    columns = [
        depth / units.factor(length, "length"),
        toolface / units.factor(angle, "angle"),
        radius / units.factor(size, "length"),
    ]
    lines = [
        f"md_{length},tf_{angle},radius_{size}",
        *(f"{d!r},{t!r},{r!r}" for d, t, r in np.array(columns).T.tolist()),
    ]
    one = hb.open(written(tmp_path, "\n".join(lines)), nulls=()).set()
    # a map confirms: hypothesis's holes are no holes, and its angles may look like radians
    entries = {role.channel: {"role": role.role} for role in guess(one)}
    caliper = wall_samples(one, overlay(guess(one), one, entries))
    np.testing.assert_allclose(caliper.depth, depth, rtol=1e-14, atol=1e-300)
    np.testing.assert_allclose(caliper.radius, radius, rtol=1e-14)
    off = (caliper.toolface - toolface + 180) % 360 - 180
    assert np.abs(off).max() < 1e-9
    assert ((caliper.toolface >= 0) & (caliper.toolface < 360)).all()


NUMBERS = st.one_of(
    st.floats(allow_nan=True).map(repr),
    st.integers().map(str),
    st.integers(-(2**63), 2**63 - 1).map(str),
    st.sampled_from(
        ["", " ", " 1.5 ", "+2", ".5", "1e3", "NaN", "-inf", "1_0", "1d3", "one", "1 2", "٣", '"4"', "-", "NULL",
         "-9999", '"a ""b"""', "2020-01-01", "true"]
    ),
)  # fmt: skip


def by(parser: str, path: Path) -> list[tuple[Any, int]] | str | None:
    """Each column's cleaned values and missing count, or the error, by one parser; None where pyarrow refuses."""
    pytest.importorskip("pyarrow")
    source = InputFile(path)
    head, *_ = delimited._head_text(source)
    layout = delimited.find_layout(source, head)
    try:
        if parser == "rows":
            lines = head.split("\n")[layout.skip :]
            arrays = read_rows(path, "\n".join(lines), layout.skip + 1, layout.names, layout.delimiter).columns
        else:
            arrays = delimited._by_pyarrow(source, layout, head, "utf8")
    except ValueError as error:
        return str(error)
    return arrays and [clean(array, (-9999.0,), False)[:2] for array in arrays]


@settings(max_examples=200, suppress_health_check=[HealthCheck.function_scoped_fixture], deadline=None)
@given(cells=st.lists(st.tuples(NUMBERS, NUMBERS), min_size=1, max_size=6), end=st.sampled_from(["\n", "\r\n"]))
def test_both_parsers_of_tables_agree(tmp_path: Path, cells: list[tuple[str, str]], end: str) -> None:
    path = tmp_path / "t.csv"
    path.write_bytes(end.join(["a,b", *(f"{a},{b}" for a, b in cells)]).encode())
    plain, arrow = by("rows", path), by("arrow", path)
    if arrow is None:  # then the other parser reads the table
        return
    assert not isinstance(plain, str)
    assert plain is not None
    for (mine, missing), (theirs, also) in zip(plain, arrow, strict=True):
        assert mine.dtype.kind == theirs.dtype.kind
        assert missing == also
        assert np.array_equal(mine, theirs, equal_nan=mine.dtype.kind == "f")


@pytest.mark.parametrize(
    "text",
    ["a,b\n1,2\n3\n", "a,b\n1,2\n3,4,5\n", 'a,b\n1,"2\n3,4\n', "a,b\n1,2\n3;4\n", "a;b\n1,5;2\n", "a,b\n"],
)
def test_what_one_parser_refuses_pyarrow_does_not_take(tmp_path: Path, text: str) -> None:
    path = written(tmp_path, text)
    plain, arrow = by("rows", path), by("arrow", path)
    assert isinstance(plain, str) or plain[0][0].dtype.kind == "U"
    if isinstance(plain, str):
        assert arrow is None


def test_tables_need_no_pyarrow(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, golden: Golden) -> None:
    import sys

    path = written(tmp_path, "md_m,tf_deg,radius_m\n" + "1.00000000000,2.00000000000,0.1\n" * 80_000 + "2,3,0.2\n")
    expected = read(path)
    monkeypatch.setitem(sys.modules, "pyarrow", None)
    found = read(path)
    assert np.array_equal(found.radius, expected.radius)
    path.write_text(path.read_text() + "1,2,x\n")
    with golden.raises():
        read(path)


HEADER = "md_m,tf_deg,radius_m\n"


@pytest.mark.parametrize(
    ("text", "choice"),
    [
        ("", {}),
        ("# only\n\n", {}),
        (HEADER, {}),
        ("md_m,radius_m\n1,0.1\n", {}),
        (HEADER + "1,2,3\n", {"radius": ["cal:in"]}),
        ("md,tf_deg,radius_m\n1,2,3\n", {}),
        (HEADER + "1,2,3\n", {"radius": ["radius_m:furlong"]}),
        (HEADER + "1,2,3\n", {"toolface": "tf_deg:in"}),
        (HEADER + "1,2,3\n", {"toolface": "tf_deg@90"}),
        (HEADER + "1,2,3\n", {"depth": "tf_deg", "toolface": "tf_deg"}),
        (HEADER + "1,2,0.1\n1,x,0.1\n", {}),
        (HEADER + "1,2,0.1\n\n1,2\n", {}),
        (HEADER + "1,2,0.1\nnan,2,0.1\n", {}),
        (HEADER + "1,2,0.1\n\n-inf,2,0.1\n", {}),
        (HEADER + "1,2,0\n1,2,0.1\n1,2,0.1\n", {}),
        (HEADER + ",2,99\n1,2,0.1\n1,2,8.5\n1,2,0.1\n1,2,0.1\n", {}),
        (HEADER + "1,2,8.5\n", {}),
        (HEADER + "1,2,-999.25\n2,,0.1\n", {}),
    ],
)  # fmt: skip
def test_bad_file(tmp_path: Path, text: str, choice: dict[str, Any], golden: Golden) -> None:
    path = written(tmp_path, text)
    with pytest.raises(ValueError) as caught:  # noqa: PT011, PT012 - the whole text is compared
        one, roles = chosen(path, **choice)
        one.caliper(roles)
    golden(str(caught.value))


def test_bad_npz(tmp_path: Path, golden: Golden) -> None:
    path = tmp_path / "c.npz"
    np.savez(path, depth=[1.0, 2.0, 3.0], toolface=[1.0, 2.0, 3.0], radius=[0.1, 3.0, 0.1])
    with golden.raises():
        hb.open(path).caliper()
    np.savez(path, depth=[1.0, np.nan, 3.0], toolface=[1.0, 2.0, 3.0], radius=[0.1, 0.1, 0.1])
    with golden.raises():
        hb.open(path).caliper()
    np.savez(path, depth=[1.0, 2.0, 3.0], toolface=[1.0], radius=[0.1, 0.1, 0.1])
    with pytest.raises(ValueError, match="no toolface"):
        hb.open(path).caliper()


SURVEY = "md_m,incl_deg,azim_deg\n"


def test_survey_leaves_out_stations_without_a_value(tmp_path: Path, golden: Golden) -> None:
    one = hb.open(written(tmp_path, SURVEY + "0,0,0\n30,,50\n60,3,350\n")).set()
    survey = one.survey()
    assert (survey.depth.tolist(), survey.azimuth.tolist()) == ([0, 60], [0, 350])
    golden(one.remarks)


def test_survey_in_stated_units(tmp_path: Path) -> None:
    one = hb.open(written(tmp_path, "a,b,c\n0,0,0\n100,0.1,1\n")).set()
    roles = parse_options(one, guess(one), {"depth": "a:ft", "inclination": "b:rad", "azimuth": "c:rad"}, {})
    survey = one.survey(roles)
    np.testing.assert_allclose(survey.depth, [0, 30.48], rtol=1e-15)
    np.testing.assert_allclose(survey.inclination, np.degrees([0, 0.1]), rtol=1e-15)
    np.testing.assert_allclose(survey.azimuth, np.degrees([0, 1]), rtol=1e-15)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("0,0,0\n30,1,0\n30,2,0\n", "line 4, column md_m: two stations at 30 m with different angles"),
        ("0,0,0\n30,180.5,0\n", "line 3, column incl_deg: 180.5 deg: inclination lies within 0 and 180"),
        ("0,-1,0\n30,1,0\n", "line 2, column incl_deg: -1 deg: inclination lies within 0 and 180"),
        ("0,1,400\n30,1,0\n", "line 2, column azim_deg: 400 deg: azimuth lies within -360 and 360"),
    ],
)
def test_bad_survey(tmp_path: Path, text: str, message: str) -> None:
    one = hb.open(written(tmp_path, SURVEY + text, "s.csv")).set()
    with pytest.raises(ValueError) as caught:  # noqa: PT011 - the whole text is compared
        one.survey()
    assert str(caught.value) == f"s.csv, {message}"


def test_an_arm_named_without_an_angle_keeps_the_angle_that_is_known(tmp_path: Path, golden: Golden) -> None:
    path = written(tmp_path, "md_m,rb_deg,cal_x_in,cal_y_in\n10,20,8.5,8.6\n")
    found = read(path, diameter=["cal_y_in"])
    assert found.toolface.tolist() == [110.0, 290.0]
    bare = written(tmp_path, "md_m,cal_x_in,cal_y_in\n10,8.5,8.6\n", "bare.csv")
    with golden.raises():  # an arm pair turns with the tool
        read(bare, diameter=["cal_y_in"])


def test_calipers_that_read_in_one_direction_are_reported(tmp_path: Path, golden: Golden) -> None:
    path = written(tmp_path, "md_m,a_in,b_in,c_in\n10,8.5,8.6,8.7\n")
    notes = read(path, diameter=["a_in@90", "b_in@90", "c_in@0"]).notes
    golden(notes[-1])
    assert len(read(path, diameter=["a_in@90", "c_in@0"]).notes) == 3


def test_what_is_long_is_shown_in_short(tmp_path: Path, golden: Golden) -> None:
    """A README's ``print(prepared.centres)`` is a line, not ten arrays of a value a turn."""
    names = ",".join(f"GR{sector}_gAPI" for sector in range(1, 9))
    rows = "".join(f"{1000 + k / 100},{9 * k % 360},{0.11 + 1e-9 * k}{f',{k}' * 8}\n" for k in range(400))
    (tmp_path / "c.csv").write_text(f"depth_m,tf_deg,radius_m,{names}\n{rows}")
    file = hb.open(tmp_path / "c.csv")
    golden(repr(file.readings()))
    golden(repr(file.image("GR")))
    prepared = hb.prepare(file.readings(), hb.Preparation(recentre=True), bit_diameter=0.22)
    golden(repr(prepared.centres))


def test_few_sectors_are_the_arms_of_a_tool(tmp_path: Path, golden: Golden) -> None:
    """Four columns give the same logs, read as an image of four sectors or as four arms; C1 is that of the arms."""
    depth = np.arange(400) * 0.05
    toolface = 60 + 10 * np.sin(depth)
    arms = [0.118 + 0.018 * np.cos(2 * np.radians(toolface + turned - 60)) for turned in (0, 90, 180, 270)]
    rows = np.column_stack([depth, toolface, *arms])
    text = "MD_m,TF_deg,ARM1_m,ARM2_m,ARM3_m,ARM4_m\n" + "\n".join(",".join(map(str, row)) for row in rows)
    path = written(tmp_path, text)
    one = hb.open(path).set()
    guessed = guess(one)
    with golden.raises():
        readings(one, guessed)
    stated = {**guessed.roles, "ARM": replace(guessed["ARM"], first=0.0, step=90.0)}
    of_image = readings(one, replace(guessed, roles=stated))
    of_arms = readings(*chosen(path, radius=[f"ARM{arm}_m@{90 * (arm - 1)}" for arm in (1, 2, 3, 4)]))
    assert of_image.channels == of_arms.channels == ("ARM1_m", "ARM2_m", "ARM3_m", "ARM4_m")
    walls = [hb.reconstruct(hb.prepare(of).caliper, bit_diameter=0.2159) for of in (of_image, of_arms)]
    image, arm = (wall.logs() for wall in walls)
    assert image.shape == arm.shape == "arms"
    assert len(image.arm_diameter) == 2
    assert image.c1.tolist() == arm.c1.tolist()


STANDOFF = (
    "~V\nVERS. 2.0:\nWRAP. NO:\n~W\nSTRT.M 10:\nSTOP.M 12:\nSTEP.M 0.1:\nNULL. -999.25:\n~C\nDEPT.M:\n"
    + "".join(f"USTO{sector:02d}.MM: ultrasonic standoff, sector {sector}\n" for sector in range(1, 17))
    + "~A\n"
    + "".join(f"{10 + row / 10:.1f} " + " ".join(f"{10 + sector}" for sector in range(16)) + "\n" for row in range(21))
)
"""Standoffs of 16 sectors of a tool whose face lies 90 mm from its axis; they grow by 1 mm from one to the next."""


def test_standoffs_count_from_the_face_of_the_tool(tmp_path: Path) -> None:
    (tmp_path / "s.las").write_text(STANDOFF)
    with pytest.raises(hb.InputError, match=r"USTO: a standoff counts .* columns\.radius=USTO@0:in\+3\.25in"):
        hb.open(tmp_path / "s.las").readings()
    text = "caliper = 's.las'\n[columns]\nradius = ['USTO@11.25+90mm']\n[wall]\nbit_diameter = '210mm'\n"
    (tmp_path / "well.toml").write_text(text)
    wall = hb.reconstruct(tmp_path / "well.toml")
    assert wall.radius[np.abs(wall.toolface - 168.75) < 3] == pytest.approx(0.107, abs=4e-4)
    (tmp_path / "map.toml").write_text(
        '[channels."USTO"]\nrole = "radius-image"\nfirst = 0.0\nstep = 22.5\nzero = "9cm"\n'
    )
    with hb.open(tmp_path / "s.las") as file:
        found = file.readings(read_map(tmp_path / "map.toml", file))
    assert [column[0] for column in found.radii] == pytest.approx(np.arange(100, 116) / 1000)


def test_each_transducer_may_have_its_own_zero(tmp_path: Path) -> None:
    """Two transducers, 25 and 26 mm from the axis, see the same radii; at 1500 m/s a us is 0.75 mm."""
    rows = "".join(f"{n},{n * 40 % 360},{100 + n},{100 + n - 4 / 3}\n" for n in range(9))
    (tmp_path / "t.csv").write_text(f"md_m,tf_deg,TT1_us,TT2_us\n{rows}")
    with hb.open(tmp_path / "t.csv") as file:
        one = file.set()
        roles = parse_options(one, guess(one), {}, {"travel-time": ["TT1_us@0", "TT2_us@180+1mm"]})
        found = one.readings(roles, echo=Echo(velocity=1500.0, tool_radius=0.025))
    assert found.radii[0] == pytest.approx(found.radii[1])
    assert found.radii[0][0] == pytest.approx(0.1)
