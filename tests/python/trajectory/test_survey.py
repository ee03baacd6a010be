"""Survey and Path: published vectors and files, a slow independent reference, frames, edges, growth, error texts."""

from __future__ import annotations

import csv
import json
import math
import re
import xml.etree.ElementTree as ElementTree

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from locations import SHARED

import helibore as hb

METHODS = ["minimum-curvature", "radius-of-curvature"]
SURVEYS = SHARED / "surveys"


def published(name):
    path = SURVEYS / name
    if not path.is_file():
        pytest.skip(f"shared/data/surveys/{name} is not beside the project")
    return path


def direction(inclination, azimuth):
    i, a = np.radians(inclination), np.radians(azimuth)
    return np.stack([np.sin(i) * np.cos(a), np.sin(i) * np.sin(a), np.cos(i)], axis=-1)


# ------------------------------------------------------------------ published numbers


def test_published_course_of_one_hundred_feet():
    survey = hb.Survey([0, 100], [15, 25], [20, 45])
    assert survey.dogleg() == pytest.approx([12.951651], abs=5e-7)
    assert survey.path().position(100) == pytest.approx([27.21833, 19.45077, 94.01234], abs=5e-6)
    curved = survey.path(method="radius-of-curvature")
    assert curved.position(100) == pytest.approx([28.5811, 18.2082, 93.8500], abs=5e-5)


def test_radius_of_curvature_where_the_quotients_are_0_over_0_or_pass_north():
    hold = hb.Survey([0, 100], [48, 48], [248, 248]).path(method="radius-of-curvature")
    assert hold.position(100) == pytest.approx([-27.84, -68.90, 66.91], abs=5e-3)
    past_north = hb.Survey([0, 100], [48, 48.5], [359, 1]).path(method="radius-of-curvature")
    assert past_north.position(100)[0] == pytest.approx(74.60, abs=5e-3)
    assert past_north.position(100)[1] == pytest.approx(0, abs=1e-12)


def test_iscwsa_wells_to_their_rounding():
    wells = json.loads(published("iscwsa_reference_and_01-05.json").read_text())["wells"]
    assert len(wells) > 3
    for name, well in wells.items():
        head = (well["N"][0], well["E"][0], well["TVD"][0])
        path = hb.Survey(well["MD"], well["IncDeg"], well["AziDeg"]).path(head=head)
        expected = np.column_stack([well["N"], well["E"], well["TVD"]])
        assert np.abs(path.position(well["MD"]) - expected).max() <= 0.0051, name


def test_well_1515_to_its_rounding():
    with published("Well_1515_directional.csv").open() as file:
        file.readline()
        rows = list(csv.DictReader(file))
    columns = {
        name: np.array([float(row[name]) for row in rows]) for name in ("MD", "Incl", "Azim", "N/S", "E/W", "TVD")
    }
    path = hb.Survey(columns["MD"], columns["Incl"], columns["Azim"]).path()
    expected = np.column_stack([columns["N/S"], columns["E/W"], columns["TVD"]])
    assert np.abs(path.position(columns["MD"]) - expected).max() <= 0.0051


@pytest.mark.parametrize(
    ("name", "tolerance"), [("komle_witsml_1411_trajectory.xml", 0.002), ("volve_F-7_witsml_1411_trajectory.xml", 1e-3)]
)
def test_witsml_trajectories_to_their_rounding(name, tolerance):
    space = {"w": "http://www.witsml.org/schemas/1series"}
    rows = []
    for station in ElementTree.parse(published(name)).iterfind(".//w:trajectoryStation", space):
        row = {}
        for tag in ("md", "incl", "azi", "dispNs", "dispEw", "tvd"):
            element = station.find(f"w:{tag}", space)
            row[tag] = float(element.text) * (180 / math.pi if element.get("uom") == "rad" else 1)
        rows.append(row)
    rows.sort(key=lambda row: row["md"])
    columns = {tag: np.array([row[tag] for row in rows]) for tag in rows[0]}
    expected = np.column_stack([columns["dispNs"], columns["dispEw"], columns["tvd"]])
    path = hb.Survey(columns["md"], columns["incl"], columns["azi"]).path(head=tuple(expected[0]))
    assert np.abs(path.position(columns["md"]) - expected).max() <= tolerance


# ------------------------------------------------------------------ an independent reference: quadrature of tangents


def reference_tangent(method, upper, lower, share):
    """Tangents at shares of a course, by slerp or by the cylinder curve's own definition."""
    (i1, a1), (i2, a2) = upper, lower
    share = np.asarray(share)[:, None]
    if method == "minimum-curvature":
        t1, t2 = direction(i1, a1), direction(i2, a2)
        bend = 2 * math.atan2(np.linalg.norm(t2 - t1), np.linalg.norm(t2 + t1))
        if bend < 1e-6:
            return (1 - share) * t1 + share * t2
        return (np.sin((1 - share) * bend) * t1 + np.sin(share * bend) * t2) / math.sin(bend)
    turn = (a2 - a1 + 180) % 360 - 180
    inclination = i1 + (i2 - i1) * share[:, 0]
    if i1 == i2:
        covered = share[:, 0]
    else:  # the integral of sin I, as a share of the whole
        covered = (np.cos(np.radians(i1)) - np.cos(np.radians(inclination))) / (
            math.cos(math.radians(i1)) - math.cos(math.radians(i2))
        )
    return direction(inclination, a1 + turn * covered)


def reference_step(method, upper, lower, length, share=1.0):
    nodes, weights = np.polynomial.legendre.leggauss(80)
    tangents = reference_tangent(method, upper, lower, share * (nodes + 1) / 2)
    return length * share * (weights / 2) @ tangents


@pytest.mark.parametrize("method", METHODS)
def test_positions_and_tangents_follow_the_curve_everywhere(method):
    random = np.random.default_rng(1)
    depth = 1000 + np.cumsum(random.uniform(5, 40, 40))
    inclination = np.clip(np.cumsum(random.uniform(-9, 12, 40)) + 20, 1, 178)
    azimuth = (350 + np.cumsum(random.uniform(-30, 30, 40))) % 360
    head = (6.5e6, 4.5e5, -31.0)
    path = hb.Survey(depth, inclination, azimuth).path(method=method, head=head)
    position = np.array(head)
    for i in range(39):
        upper, lower = (inclination[i], azimuth[i]), (inclination[i + 1], azimuth[i + 1])
        length = depth[i + 1] - depth[i]
        for share in (0.0, 0.1, 0.5, 0.93):
            there = depth[i] + share * length
            expected = position + reference_step(method, upper, lower, length, share)
            assert np.abs(path.position(there) - expected).max() <= 1e-12 * 6.5e6
            tangent = reference_tangent(method, upper, lower, [share])[0]
            assert np.abs(path.tangent(there) - tangent).max() <= 2e-12
        position = position + reference_step(method, upper, lower, length)
    assert np.abs(path.position(depth[-1]) - position).max() <= 1e-12 * 6.5e6


angles = st.tuples(st.floats(0, 180), st.floats(0, 360))


@given(upper=angles, lower=angles, length=st.floats(0.1, 100), method=st.sampled_from(METHODS))
def test_any_single_course(upper, lower, length, method):
    t1, t2 = direction(*upper), direction(*lower)
    if method == "minimum-curvature" and np.linalg.norm(t1 + t2) < 0.05:
        return  # nearly opposite: the reference itself loses its digits
    survey = hb.Survey([0, length], [upper[0], lower[0]], [upper[1], lower[1]])
    path = survey.path(method=method)
    if method == "minimum-curvature" or max(upper[0], lower[0]) - min(upper[0], lower[0]) > 1e-3:
        expected = reference_step(method, upper, lower, length)
        assert np.abs(path.position(length) - expected).max() <= 1e-9 * length
    depth = np.linspace(0, length, 41)
    position, tangent = path.position(depth), path.tangent(depth)
    assert np.abs(np.linalg.norm(tangent, axis=1) - 1).max() <= 1e-14
    assert np.abs(tangent[0] - t1).max() <= 1e-12
    assert np.abs(tangent[-1] - t2).max() <= 1e-9
    assert (np.linalg.norm(np.diff(position, axis=0), axis=1) <= length / 40 * (1 + 1e-12)).all()


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("bend", [0.0, 1e-300, 1e-15, 1e-9, 1e-6, 1e-3])
def test_hardly_bent_courses_are_as_good_as_straight(method, bend):
    path = hb.Survey([0, 30], [48, 48 + bend], [248, 248]).path(method=method)
    middle = 48 + bend / 2
    assert np.abs(path.position(30) - 30 * direction(middle, 248)).max() <= 30 * math.radians(bend) ** 2 + 1e-14
    assert hb.Survey([0, 30], [48, 48 + bend], [248, 248]).dogleg()[0] == pytest.approx((48 + bend) - 48, rel=1e-9)


def test_dogleg_keeps_its_digits_when_only_the_azimuth_moves_by_a_billionth():
    azimuth = 1e-9
    dogleg = hb.Survey([0, 30], [30, 30], [0, azimuth]).dogleg()[0]
    assert dogleg == pytest.approx(azimuth / 2, rel=1e-12)


def test_half_a_circle_less_a_little():
    path = hb.Survey([0, 100], [0.001, 179.999], [0, 0]).path()
    radius = 100 / math.radians(179.998)
    assert path.position(100) == pytest.approx([2 * radius, 0, 0], abs=1e-3)
    assert path.position(50)[2] == pytest.approx(radius, abs=1e-3)


def test_azimuth_has_no_say_where_the_hole_is_vertical():
    reported_zero = hb.Survey([0, 100, 130], [0, 0, 5], [0, 0, 120]).path()
    reported_else = hb.Survey([0, 100, 130], [0, 0, 5], [77, 300, 120]).path()
    depth = np.linspace(0, 130, 27)
    assert np.abs(reported_zero.position(depth) - reported_else.position(depth)).max() <= 1e-12


# ------------------------------------------------------------------ frames


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("reference", ["high-side", "north", "parallel-transport"])
def test_frames_are_orthonormal_right_handed_and_continuous(method, reference):
    random = np.random.default_rng(2)
    depth = np.cumsum(random.uniform(20, 40, 30))
    inclination = np.clip(30 + np.cumsum(random.uniform(-6, 6, 30)), 10, 80)
    azimuth = (350 + np.cumsum(random.uniform(-20, 20, 30))) % 360
    path = hb.Survey(depth, inclination, azimuth).path(method=method, reference=reference, extend=5)
    fine = np.linspace(depth[0], depth[-1] + 5, 20_001)
    frame = path.frame(fine)
    assert np.abs(frame @ frame.transpose(0, 2, 1) - np.eye(3)).max() <= 1e-14
    assert np.abs(np.cross(frame[:, 2], frame[:, 0]) - frame[:, 1]).max() <= 1e-14  # right = t x h
    step = fine[1] - fine[0]
    assert np.abs(np.diff(frame, axis=0)).max() <= 0.2 * step  # a frame that flips moves by 1 or more
    across = depth[1:-1]
    assert np.abs(path.frame(across) - path.frame(np.nextafter(across, 0))).max() <= 1e-11
    assert np.abs(path.position(across) - path.position(np.nextafter(across, 0))).max() <= 1e-11


def test_high_side_and_right_by_the_conventions():
    inclination, azimuth = 48.0, 248.0
    i, a = math.radians(inclination), math.radians(azimuth)
    frame = hb.Survey([0, 100], [inclination] * 2, [azimuth] * 2).path().frame(40)
    high_side = [math.cos(i) * math.cos(a), math.cos(i) * math.sin(a), -math.sin(i)]
    assert frame == pytest.approx(np.array([high_side, [-math.sin(a), math.cos(a), 0], direction(48, 248)]), abs=1e-15)
    assert frame[0, 2] < 0  # up


def test_north_reference_in_a_vertical_hole_reads_the_compass():
    frame = hb.Survey([0, 100], [0, 0], [0, 0]).path(reference="north").frame(10)
    assert frame.tolist() == [[1, 0, 0], [0, 1, 0], [0, 0, 1]]


@given(inclination=st.floats(0.01, 89), azimuth=st.floats(0, 360), toolface=st.floats(0, 360))
def test_north_to_high_side_is_exact(inclination, azimuth, toolface):
    survey = hb.Survey([0, 10], [inclination] * 2, [azimuth] * 2)
    by_north, by_high_side = survey.path(reference="north"), survey.path(reference="high-side")
    offset = by_high_side.north_to_high_side(5.0)
    assert offset == by_north.north_to_high_side(5.0)
    assert 0 <= offset < 360
    # The two frames share a plane, but "north" is the projection of north into it, so the published angle is the angle
    # of that projection: atan2(-sin A, cos I cos A).
    i, a = math.radians(inclination), math.radians(azimuth)
    assert math.isclose(
        (offset - math.degrees(math.atan2(-math.sin(a), math.cos(i) * math.cos(a))) + 180) % 360, 180, abs_tol=1e-9
    )

    def pointing(frame, degrees):
        return math.cos(math.radians(degrees)) * frame[0] + math.sin(math.radians(degrees)) * frame[1]

    from_north = pointing(by_north.frame(5.0), toolface)
    from_high_side = pointing(by_high_side.frame(5.0), toolface + offset)
    assert np.abs(from_north - from_high_side).max() <= 1e-9


def test_published_offset_of_north_to_high_side():
    path = hb.Survey([0, 10], [48, 48], [248, 248]).path()
    assert path.north_to_high_side([2.0, 7.0]) == pytest.approx([105.13] * 2, abs=0.005)


def test_references_are_refused_where_they_are_undefined_and_only_there(golden):
    kicked = hb.Survey([0, 100, 130], [0, 0, 3], [0, 0, 60])
    with golden.raises():
        kicked.path().frame([101, 99])
    just_below = kicked.path().frame(100.001)
    assert just_below[0] == pytest.approx([math.cos(math.radians(60)), math.sin(math.radians(60)), 0], abs=1e-5)
    level = hb.Survey([0, 100], [90, 90], [180, 180])
    with golden.raises():
        level.path(reference="north").frame(5)
    assert level.path().frame(5)[0].tolist() == [0, 0, -1]
    assert np.isfinite(level.path(reference="north").position(5)).all()  # only frames need a reference
    with golden.raises():
        kicked.path(reference="north").north_to_high_side(50)


# ------------------------------------------------------------------ growth (law 5) and reach


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("reference", ["high-side", "north", "parallel-transport"])
def test_a_new_station_moves_only_what_lies_below_the_previous_last_one(method, reference):
    random = np.random.default_rng(3)
    depth = np.cumsum(random.uniform(10, 30, 50))
    inclination = np.clip(20 + np.cumsum(random.uniform(-3, 4, 50)), 5, 120)
    azimuth = (np.cumsum(random.uniform(-40, 40, 50))) % 360
    for stations in (2, 3, 17, 49):
        old = hb.Survey(depth[:stations], inclination[:stations], azimuth[:stations])
        new = hb.Survey(depth[: stations + 1], inclination[: stations + 1], azimuth[: stations + 1])
        before = old.path(method, reference, extend=8)
        after = new.path(method, reference, extend=3)
        last = depth[stations - 1]
        kept = np.append(np.linspace(depth[0], last, 2_000), depth[:stations])
        assert (before.position(kept) == after.position(kept)).all()
        assert (before.frame(kept) == after.frame(kept)).all()
        assert (before.position(last + 7) != after.position(last + 7)).any()


def test_the_provisional_part_goes_straight_on():
    path = hb.Survey([0, 50, 100], [10, 20, 30], [40, 50, 60]).path(extend=20)
    expected = path.position(100) + np.outer([0, 7.5, 20], path.tangent(100))
    assert path.position([100, 107.5, 120]) == pytest.approx(expected, abs=1e-13)
    assert path.tangent(120).tolist() == path.tangent(100).tolist()
    assert (path.start_depth, path.survey_depth, path.stop_depth) == (0, 100, 120)


def test_depths_the_path_does_not_reach(golden):
    path = hb.Survey([50, 100], [10, 20], [40, 50]).path(extend=20)
    with golden.raises():
        path.position([60, 49.5])
    with golden.raises():
        path.tangent(120.5)
    with golden.raises():
        path.frame(math.nan)


# ------------------------------------------------------------------ forms and errors


def test_arrays_of_any_form_and_single_numbers():
    survey = hb.Survey(np.array([200, 100, 0], dtype=np.float32)[::-1], [0, 4, 9], np.asfortranarray([1, 2, 3]))
    path = survey.path()
    assert path.position([]).shape == (0, 3)
    assert path.frame(np.zeros(0)).shape == (0, 3, 3)
    assert path.position(150).shape == (3,)
    assert path.frame(150).shape == (3, 3)
    assert path.position([150, 20]).shape == (2, 3)
    assert path.position([150])[0].tolist() == path.position(150).tolist()
    assert not survey.depth.flags.writeable
    assert len(survey) == 3


@pytest.mark.parametrize(
    "stations",
    [
        ([0, 100], [0, 0, 0], [0, 0]),
        ([0, 100], [0, 0], [0]),
        ([], [], []),
        ([5], [0], [0]),
        ([0, math.nan], [0, 0], [0, 0]),
        ([0, math.inf], [0, 0], [0, 0]),
        ([0, 100, 100], [0] * 3, [0] * 3),
        ([0, 100, 90.5], [0] * 3, [0] * 3),
        ([0, 100], [0, math.nan], [0, 0]),
        ([0, 100], [-0.1, 0], [0, 0]),
        ([0, 100], [0, 180.5], [0, 0]),
        ([0, 100], [0, 0], [0, -999.25]),
        ([0, 100], [0, 0], ["a", "b"]),
    ],
)
def test_bad_stations(stations, golden):
    with golden.raises():
        hb.Survey(*stations)


@pytest.mark.parametrize(
    "settings",
    [
        {"method": "tangential"},
        {"reference": "up"},
        {"extend": -1},
        {"extend": math.nan},
        {"extend": 2e7},
        {"head": (0, math.inf, 0)},
        {"head": (0, 1)},
        {"head": "abc"},
        {"head": (0, 2e9, 0)},
    ],
)
def test_bad_settings(settings, golden):
    with golden.raises():
        hb.Survey([0, 100], [1, 2], [3, 4]).path(**settings)


def test_opposite_directions_have_no_arc():
    survey = hb.Survey([0, 30, 60], [0, 90, 90], [0, 0, 180])
    assert survey.dogleg() == pytest.approx([90, 180])
    rule = "the hole turns by 180 deg since depth[1] = 30, so the arc between them is not known: must be less than 180"
    with pytest.raises(ValueError, match=f"^{re.escape(f'depth[2] = 60: {rule}')}$"):
        survey.path()
    assert np.isfinite(survey.path(method="radius-of-curvature").position([0, 45, 60])).all()
