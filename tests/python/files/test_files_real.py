"""Every file of the shared data opens with the right channels, units and values (checked by other means of reading)."""

from __future__ import annotations

import csv
import gzip
import json
import math
import xml.etree.ElementTree as ET
from pathlib import Path

import numpy as np
import pytest
from golden_texts import Golden
from locations import SHARED
from wall_samples import wall_samples

import helibore as hb
from helibore.channels.roles import RoleMap, guess

WITSML = "{http://www.witsml.org/schemas/1series}"


def shared(name: str) -> Path:
    path = SHARED / name
    if not path.exists():
        pytest.skip(f"shared/data/{name} is not beside the project")
    return path


def roles_of(path: Path, set_name: str | None = None) -> dict[str, str]:
    with hb.open(path) as file:
        return {role.channel: role.role for role in guess(file.set(set_name)) if role.role != "none"}


def test_las_image_file() -> None:
    path = shared("lwd-images/P11-A-02_Composite_MEM_Image_NF.las")
    rows = [line.split() for line in path.read_text().split("~A ")[1].splitlines()[1:]]
    plain = np.array(rows, dtype=float)
    plain[plain == -999.25] = np.nan
    file = hb.open(path)
    one = file.set()
    assert file.format == "LAS 2.0"
    assert (one.rows, one.index, one.header["WELL"]) == (7361, "DEPTH", "P11-A-02A")
    assert one.names[-4:] == ("ABDC", "ABDCM", "GRAS", "GRASM")
    assert len(one.names) == 52 - 24 + 2
    assert one["ABDC"].member_names == tuple(f"ABDC{sector}M" for sector in range(1, 17))
    assert one["GRAS"].member_names == tuple(f"GRAS{sector}M" for sector in range(8))
    np.testing.assert_array_equal(one["ABDC"].values, plain[:, 26:42])
    np.testing.assert_array_equal(one["GRAS"].values, plain[:, 43:51])
    np.testing.assert_array_equal(one["INNM"].values, plain[:, 18])
    np.testing.assert_array_equal(one["ABDC7M"].values, plain[:, 32])
    assert one["ABDC"].missing == np.isnan(plain[:, 26:42]).sum() == 14690
    assert [one[name].unit for name in ("DEPTH", "ABDC", "GRAS", "INNM", "RACELM")] == [
        "m", "g/cc", "API", "deg", "ohm.m",
    ]  # fmt: skip
    image = file.image("ABDC")
    assert (image.depth[0], image.depth[-1], image.first, image.step) == (1950.0, 2686.0, None, None)
    assert roles_of(path) == {
        "DEPTH": "depth", "TVD": "tvd", "INNM": "inclination", "ABDC": "image", "GRAS": "image",
    }  # fmt: skip


@pytest.mark.parametrize(
    ("name", "rows", "images"),
    [
        (
            "15_9-F-15_D__WL_RAW_BHPR-CAL-DEN-GR-MECH-NEU-REMP_MWD_2.json",
            672,
            {"GRCS": 8, "ABDC": 16, "ABDCQF": 4, "APRA": 16, "NBGRCS": 16},
        ),
        (
            "15_9-F-11_B__WL_RAW_BHPR-CAL-DEN-GR-MECH-NEU-REMP_MWD_2.json",
            821,
            {"GRCS": 8, "ABDC": 16, "APRA": 16, "ABDCQF": 4},
        ),
    ],
)
def test_json_image_files(name: str, rows: int, images: dict[str, int], golden: Golden) -> None:
    path = shared(f"lwd-images/{name}")
    (log,) = json.loads(path.read_text())
    file = hb.open(path)
    one = file.set()
    assert (one.rows, one.index, one.header["well"]) == (rows, "TDEP", log["header"]["well"])
    for position, curve in enumerate(log["curves"]):
        expected = [math.nan if row[position] is None else row[position] for row in log["data"]]
        np.testing.assert_array_equal(one[curve["name"]].values, expected, err_msg=curve["name"])
        assert one[curve["name"]].unit == (curve["unit"] or "")
    assert {channel.name: channel.shape[1] for channel in one if len(channel.shape) == 2} == images
    expected_roles = dict.fromkeys(images, "image") | {
        "TDEP": "depth", "BITSIZE": "bit-diameter", "CALCM": "mean-diameter", "AT2GTFM": "toolface",
        "INNM": "inclination", "TVD": "tvd",
    }  # fmt: skip
    assert roles_of(path) == expected_roles
    np.testing.assert_array_equal(file.image("GRCS").depth, [row[0] for row in log["data"]])
    with golden.raises():
        wall_samples(file)


def test_json_diameters() -> None:
    path = shared("calipers/15_9-F-15_B__WLC_PETROPHYSICAL_COMPOSITE_1.json")
    (log,) = json.loads(path.read_text())
    names = [curve["name"] for curve in log["curves"]]
    roles = roles_of(path)
    assert roles == {
        "DEPT": "depth", "DCAV": "mean-diameter", "UCAV": "mean-diameter", "DCHO": "diameter", "DCVE": "diameter",
        "UCHO": "diameter", "UCVE": "diameter",
    }  # fmt: skip
    found = wall_samples(hb.open(path))
    expected = set()
    for row in log["data"]:
        for name, angle in (("DCHO", 90.0), ("DCVE", 0.0), ("UCHO", 90.0), ("UCVE", 0.0)):
            diameter = row[names.index(name)]
            if diameter is not None:
                for side in (angle, angle + 180.0):
                    expected.add((round(row[0] * 0.00254, 6), side, round(diameter * 0.0254 / 2, 9)))
    got = set(zip(found.depth.round(6), found.toolface, found.radius.round(9), strict=True))
    assert got == expected
    assert found.time is None
    assert 0.1 < np.median(found.radius) < 0.13  # an 8.5 in hole
    for name in ("DCHO", "UCVE"):
        assert found.dropped[name] == sum(row[names.index(name)] is None for row in log["data"])


def test_xy_caliper_without_a_map() -> None:
    path = shared("calipers/volve_F-12_2010_pfcs_xy_caliper.csv.gz")
    with gzip.open(path, "rt") as text:
        rows = list(csv.DictReader(text))
    one = hb.open(path).set()
    assert [(channel.name, channel.unit) for channel in one] == [
        ("pass", ""), ("direction", ""), ("etim_s", "s"), ("tdep_0.1in", "0.1in"), ("md_m", "m"), ("rb_deg", "deg"),
        ("pfc1_x_in", "in"), ("pfc2_y_in", "in"), ("devi_pgms_deg", "deg"),
    ]  # fmt: skip
    for name in ("md_m", "rb_deg", "pfc1_x_in"):
        np.testing.assert_array_equal(one[name].values, [float(row[name]) for row in rows])
    assert one["direction"].values.tolist() == [row["direction"] for row in rows]
    found = wall_samples(one)
    assert found.depth.size == 4 * len(rows)
    row = rows[7000]
    at = slice(4 * 7000, 4 * 7001)
    assert (found.depth[at] == float(row["md_m"])).all()
    assert (found.time[at] == float(row["etim_s"])).all()  # type: ignore[index]
    turn = (float(row["rb_deg"]) + np.array([0.0, 180.0, 90.0, 270.0])) % 360.0
    np.testing.assert_array_equal(found.toolface[at], turn)
    x, y = float(row["pfc1_x_in"]) * 0.0254 / 2, float(row["pfc2_y_in"]) * 0.0254 / 2
    np.testing.assert_allclose(found.radius[at], [x, x, y, y], rtol=1e-15)
    assert not found.dropped


def test_amplitude_archive() -> None:
    path = shared("calipers/atv_amplitude.npz")
    with np.load(path) as archive:
        plain = dict(archive)
    one = hb.open(path).set()
    assert [(channel.name, channel.unit, channel.shape) for channel in one] == [
        ("depth_m", "m", (451,)), ("azimuth_deg", "deg", (144,)), ("amplitude", "", (451, 144)),
    ]  # fmt: skip
    np.testing.assert_array_equal(one["amplitude"].values, plain["amplitude"])
    assert one["amplitude"].values.dtype == np.float32
    image = one.image("amplitude")
    assert (image.first, image.step) == (0.0, 2.5)
    np.testing.assert_array_equal(image.depth, plain["depth_m"])


@pytest.mark.parametrize("name", ["breakout_picks.csv", "caliper_max_ave.csv"])
def test_plain_tables(name: str) -> None:
    path = shared(f"calipers/{name}")
    with path.open() as text:
        rows = list(csv.DictReader(text))
    one = hb.open(path).set()
    assert one.rows == len(rows)
    for channel in one:
        assert channel.unit == {"m": "m", "deg": "deg", "mm": "mm"}.get(channel.name.rpartition("_")[2], "")
        np.testing.assert_array_equal(channel.values, [float(row[channel.name]) for row in rows])
    assert guess(one)["depth_m"].role == "depth"


def test_text_table() -> None:
    path = shared("wits/items.csv")
    with path.open() as text:
        rows = list(csv.DictReader(text))
    one = hb.open(path).set()
    for channel in one:
        plain = [row[channel.name] for row in rows]
        if channel.is_text:
            assert channel.values.tolist() == plain
        else:
            np.testing.assert_array_equal(channel.values, [float(cell) for cell in plain])
    assert [channel.name for channel in one if not channel.is_text] == ["record", "item"]


def test_survey_in_feet_needs_its_unit_stated(golden: Golden) -> None:
    path = shared("surveys/Well_1515_directional.csv")
    with path.open() as text:
        next(text)
        rows = list(csv.DictReader(text))
    file = hb.open(path)
    assert file.set().rows == 83
    assert file.set().remarks == ["comment: Minimum Curvature"]
    np.testing.assert_array_equal(file["E/W"].values, [float(row["E/W"]) for row in rows])
    with golden.raises():
        file.survey()
    from helibore.channels.role_map import overlay

    roles = overlay(guess(file.set()), file.set(), {"MD": {"role": "depth", "unit": "ft"}})
    survey = file.set().survey(roles)
    np.testing.assert_allclose(survey.depth, [float(row["MD"]) * 0.3048 for row in rows], rtol=1e-15)


def test_standard_wells(golden: Golden) -> None:
    path = shared("surveys/iscwsa_reference_and_01-05.json")
    wells = json.loads(path.read_text())["wells"]
    file = hb.open(path)
    assert [one.name for one in file.sets] == list(wells)
    with golden.raises():
        file.survey()
    for name, well in wells.items():
        one = file.set(name)
        for label in ("MD", "IncDeg", "AziDeg", "TVD", "N", "E", "sigmaH"):
            np.testing.assert_array_equal(one[label].values, well[label])
        assert [one[label].unit for label in ("MD", "IncDeg", "N")] == [
            well["header"]["depth_unit"], "deg", well["header"]["surface_unit"],
        ]  # fmt: skip
        left_out = [remark for remark in one.remarks if remark.startswith("SF:")]
        assert bool(left_out) == (len(well.get("SF", well["MD"])) != len(well["MD"]))
        survey = one.survey()
        np.testing.assert_allclose(survey.depth, well["MD"], rtol=1e-15)
        np.testing.assert_array_equal(survey.azimuth, well["AziDeg"])


@pytest.mark.parametrize(
    ("name", "stations", "unit"),
    [("komle_witsml_1411_trajectory.xml", 82, "dega"), ("volve_F-7_witsml_1411_trajectory.xml", 42, "rad")],
)
def test_witsml_trajectories(name: str, stations: int, unit: str) -> None:
    path = shared(f"surveys/{name}")
    plain = ET.parse(path).getroot().iter(f"{WITSML}trajectoryStation")
    columns = [
        [float(one.findtext(f"{WITSML}{tag}", "nan")) for tag in ("md", "incl", "azi", "dispNs")] for one in plain
    ]
    md, incl, azi, north = np.array(columns).T
    file = hb.open(path)
    one = file.set()
    assert (one.rows, one.index, one["incl"].unit, one["md"].unit) == (stations, "md", unit, "m")
    np.testing.assert_array_equal(one["md"].values, md)
    np.testing.assert_array_equal(one["dispNs"].values, north)
    survey = file.survey()
    scale = math.degrees(1.0) if unit == "rad" else 1.0
    np.testing.assert_allclose(survey.inclination, incl * scale, rtol=1e-14)
    np.testing.assert_allclose(survey.azimuth, azi * scale, rtol=1e-14)
    # the published north of the last station follows from depth, inclination and azimuth read
    path_position = survey.path().position(survey.depth[-1:])[0]
    assert path_position[0] + north[0] == pytest.approx(north[-1], abs=0.05)


def test_guesses_need_no_map_in_any_caliper_file() -> None:
    for name in ("calipers/volve_F-12_2010_pfcs_xy_caliper.csv.gz", "lwd-images/P11-A-02_Composite_MEM_Image_NF.las"):
        roles: RoleMap = guess(hb.open(shared(name)).set())
        assert all(role.reason for role in roles)
