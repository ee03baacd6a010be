"""Roles: guesses with reasons, and the samples, surveys and images that follow. Maps are in test_role_maps.py."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest
from golden_texts import Golden
from wall_samples import wall_samples

import helibore as hb
from helibore.channels.depth_remarks import depth_remarks
from helibore.channels.log_set import LogSet
from helibore.channels.role_map import overlay
from helibore.channels.roles import ROLES, guess
from helibore.channels.sectors import join_sectors
from helibore.files.headings import unit_in_name
from helibore.files.raw_set import Channel, SectorAxis


def channel(
    name: str, unit: str = "", values: object = (1.0, 2.0, 3.0), described: str = "", **more: object
) -> Channel:
    array = np.array(values)
    return Channel(name, unit, described, array, **more)  # type: ignore[arg-type]


def log_set(*channels: Channel, index: str | None = None) -> LogSet:
    return LogSet(Path("f.las"), "s", list(channels), channels[0].shape[0], index)


@pytest.mark.parametrize(
    ("name", "unit", "described", "role"),
    [
        ("DEPT", "m", "", "depth"),
        ("Measured Depth", "ft", "", "depth"),
        ("md_m", "m", "", "depth"),
        ("TDEP", "0.1 in", "", "depth"),
        ("XYZ", "m", "Measured depth", "depth"),
        ("DEPT", "deg", "", "none"),
        ("TIME", "s", "", "time"),
        ("etim_s", "s", "", "time"),
        ("RPTHM", "min", "Resistivity Time Since Drilled", "none"),
        ("RB", "deg", "", "toolface"),
        ("toolface_rad", "rad", "", "toolface"),
        ("AT2GTFM", "deg", "", "toolface"),
        ("X", "deg", "Relative Bearing", "toolface"),
        ("INC", "deg", "", "inclination"),
        ("DEVI", "deg", "", "inclination"),
        ("BITSIZE", "in", "", "bit-diameter"),
        ("BS", "in", "Bit Size", "bit-diameter"),
        ("TVD", "m", "", "tvd"),
        ("radius", "mm", "", "radius"),
        ("R", "ohm.m", "", "none"),
        ("CALI", "in", "", "mean-diameter"),
        ("CALCM", "in", "Acoustic Caliper - Corrected", "mean-diameter"),
        ("cal_ave_diameter_mm", "mm", "", "mean-diameter"),
        ("cal_max_diameter_mm", "mm", "", "none"),
        ("DIAMETER_MIN", "in", "Caliper, smallest", "none"),
        ("CMAX", "in", "", "none"),
        ("DCAL", "MM", "16 Caliper-Differential", "none"),
        ("DCAL", "in", "", "none"),
        ("DCAL", "in", "Density Caliper", "mean-diameter"),
        ("CALD", "in", "Caliper, difference to bit size", "none"),
        ("GR", "gAPI", "", "none"),
        ("NPCLFM", "", "Neutron Porosity Caliper Filtered", "none"),
        ("pass", "", "", "pass"),
        ("AZI", "deg", "", "none"),
        ("UCHO", "IN", "Ultrasonic Caliper, Horizontal Diameter", "diameter"),
        ("diameter", "in", "", "mean-diameter"),
    ],
)
def test_single_channels(name: str, unit: str, described: str, role: str) -> None:
    found = guess(log_set(channel(name, unit, described=described)))[name]
    assert found.role == role
    assert found.reason


def test_reasons_are_sentences_about_this_channel(golden: Golden) -> None:
    roles = guess(
        log_set(channel("DEPTH", "m"), channel("MD", "m"), channel("INC", "m"), channel("AZ", "deg"), index="MD")
    )
    assert {role.channel: role.reason for role in roles} == {
        "DEPTH": "named DEPTH, like depth; MD has this role",
        "MD": "named MD and it is the index",
        "INC": "named INC, like inclination, but 'm' is no known unit of angle",
        "AZ": "named AZ, but a survey also needs an inclination (an angle around the hole is a toolface)",
    }
    roles = guess(log_set(channel("IDX", "m"), channel("GR", "gAPI"), index="IDX"))
    golden((roles["IDX"].role, roles["IDX"].reason))


@pytest.mark.parametrize(
    ("name", "described", "reference", "north"),
    [
        ("P1NO", "", "north", ""), ("P1NO_FBST_S", "", "north", ""), ("MTF", "", "north", "magnetic"),
        ("SMTF", "", "north", "magnetic"), ("AT2MTFM", "", "north", "magnetic"),
        ("TF", "Tool face from true north", "north", "true"), ("TF", "Magnetic toolface", "north", "magnetic"),
        ("RB", "", "high-side", ""), ("RB_FBST", "", "high-side", ""), ("HSRB", "", "high-side", ""),
        ("GTF", "", "high-side", ""), ("IRBR", "", "high-side", ""), ("X", "Relative bearing", "high-side", ""),
    ],
)  # fmt: skip
def test_a_toolface_states_what_it_counts_from(name: str, described: str, reference: str, north: str) -> None:
    one = log_set(DEPTH, channel(name, "deg", np.arange(40.0) * 9.0, described), radius(0.1))
    role = guess(one)[name]
    assert (role.role, role.reference, role.north) == ("toolface", reference, north)
    assert (one.readings().reference, one.readings().north) == (reference, north)
    confirmed = overlay(guess(one), one, {name: {"unit": "deg"}})
    assert (confirmed[name].reference, confirmed[name].north) == (reference, north)
    assert overlay(guess(one), one, {name: {"reference": "high-side"}})[name].reference == "high-side"
    assert overlay(guess(one), one, {name: {"role": "none"}})[name].reference == ""
    path = hb.Survey([0.0, 50.0], [30.0, 30.0], [70.0, 70.0]).path()  # counts from the high side
    turned = hb.prepare(one.readings(), path=path).caliper
    off = np.degrees(np.arctan2(-np.sin(np.radians(70.0)), np.cos(np.radians(30.0)) * np.cos(np.radians(70.0))))
    off = 0.0 if reference == "high-side" else off
    np.testing.assert_allclose((turned.toolface - np.arange(40.0) * 9.0 - off + 180) % 360 - 180, 0, atol=1e-9)


@pytest.mark.parametrize("name", ["TF", "TFO", "toolface_deg", "ROT"])
def test_other_toolfaces_count_from_what_the_wall_counts_from(name: str) -> None:
    role = guess(log_set(DEPTH, channel(name, "deg", np.arange(40.0)), radius(0.1)))[name]
    assert (role.role, role.reference) == ("toolface", "")


SETS_OF_NAMES = [
    # toolface, its reference, inclination, azimuth, other channels without a role of their own; by vendor and tool
    ("RB", "high-side", "DEVI", "HAZI", ("P1AZ",)),
    ("P1AZ", "horizontal-north", "DEVI", "HAZI", ()),
    ("RB_FBST", "high-side", "DEVIM", "HAZIM", ("P1NO_FBST",)),
    ("P1NO_OBMT", "north", "DEVI", "HAZI", ("P1AZ_OBMT",)),
    ("RB_NGI_UPPER", "high-side", "DEVI", "HAZI", ()),
    ("RBR", "high-side", "DEV", "HAZ", ("AZI1",)),
    ("IRBR", "high-side", "ITLT", "IAZI", ("IAP1",)),
    ("AZI1", "horizontal-north", "SDEV", "HAZIM", ()),
    ("IAP1", "horizontal-north", "DHAV", "DAZ", ()),
    ("UAZI", "horizontal-north", "INC", "AZM", ()),
    ("RBCB", "high-side", "DEVCB", "DAZCB", ()),
    ("RBGX", "high-side", "DEVGX", "DAZGX", ()),
    ("HSRB", "high-side", "SINCL", "SAZIMC", ()),
    ("4RB", "high-side", "4DVI", "4UHA", ()),
    ("P1NO", "north", "HDEVI", "AZIM", ()),
]


@pytest.mark.parametrize(("toolface", "reference", "inclination", "azimuth", "others"), SETS_OF_NAMES)
@pytest.mark.parametrize("described", [False, True])
@pytest.mark.parametrize("turned", [False, True])
def test_vendors_names(
    toolface: str,
    reference: str,
    inclination: str,
    azimuth: str,
    others: tuple[str, ...],
    described: bool,
    turned: bool,
) -> None:
    words = {toolface: "Pad 1 azimuth" if "north" in reference else "Relative bearing", azimuth: "Hole azimuth"}
    words |= {inclination: "Hole deviation"} | dict.fromkeys(others, "Azimuth of the reference pad")
    names = [toolface, inclination, azimuth, *others]
    channels = [channel(name, "deg", described=words[name] if described else "") for name in names]
    roles = guess(log_set(channel("DEPT", "m"), *(channels[::-1] if turned else channels)))
    assert [roles[name].role for name in names[1:]] == ["inclination", "azimuth", *("none" for _ in others)]
    # An azimuth in the horizontal plane may stand before or after the toolface; the toolface has the role.
    assert (roles[toolface].role, roles[toolface].reference) == ("toolface", reference)


def test_three_calipers_are_no_pair() -> None:
    turn = channel("RB", "deg")
    found = guess(log_set(turn, *(channel(f"CAL{n}", "in") for n in (1, 2, 3))))
    assert [(found[f"CAL{n}"].role, found[f"CAL{n}"].angle) for n in (1, 2, 3)] == [
        ("diameter", 0.0), ("diameter", 60.0), ("diameter", 120.0),
    ]  # fmt: skip
    pair = guess(log_set(turn, *(channel(f"CAL{n}", "in") for n in (1, 2))))
    assert [pair[f"CAL{n}"].angle for n in (1, 2)] == [0.0, 90.0]
    arms = guess(log_set(turn, *(channel(f"CAL{n}", "in", described=f"Caliper arm {n}") for n in (1, 2, 3))))
    assert {arms[f"CAL{n}"].role for n in (1, 2, 3)} == {"none"}
    assert "three radii 120 deg apart" in arms["CAL1"].reason


def test_means_and_extremes_have_no_direction() -> None:
    names = ("UCAV", "DCAV", "ADIA", "HDAR", "HDIA", "LCAL", "IDAV", "IRAV", "ERAV", "HDMX", "HDMN", "CMAX", "CALMAX")
    found = guess(log_set(channel("RB", "deg"), *(channel(name, "in") for name in names)))
    assert [found[name].role for name in names] == ["mean-diameter"] * 7 + ["none"] * 6


def test_arm_pairs_are_known_by_the_numbers_of_their_arms() -> None:
    roles = guess(log_set(DEPTH, TURN, *(channel(name, "in", np.full(40, 8.5)) for name in ("C13 (IN)", "C24 (IN)"))))
    assert [(roles[name].role, roles[name].angle) for name in ("C13 (IN)", "C24 (IN)")] == [
        ("diameter", 0.0), ("diameter", 90.0),
    ]  # fmt: skip


def columns_of(stem: str, count: int, unit: str, described: str = "", **more: object) -> list[Channel]:
    return [channel(f"{stem}{n}", unit, described=described, **more) for n in range(1, count + 1)]


@pytest.mark.parametrize(
    ("columns", "said"),
    [
        (columns_of("P", 4, "ohmm"), "P1 ...: named or described as the pads of a dip meter or the probes of"),
        (columns_of("PAD", 8, "mmho"), "PAD1 ...: named or described as the pads of a dip meter"),
        (columns_of("FC", 4, ""), "FC1 ...: named or described as the pads of a dip meter"),
        (columns_of("RAT", 12, ""), "RAT1 ...: named or described as the pads of a dip meter or the probes of"),
        (columns_of("SPIN", 6, "rps"), "SPIN1 ...: named or described as"),
        (columns_of("H", 8, "", "Water hold-up, probe"), "H1 ...: named or described as"),
        (columns_of("XY", 4, "ohmm"), "XY1 ...: 4 columns of ohmm without stated angles may be the pads of a dip"),
        (columns_of("XY", 6, ""), "XY1 ...: 6 columns of no unit without stated angles may be the pads of a dip meter"),
    ],
)
def test_pads_and_probes_are_no_image(columns: list[Channel], said: str) -> None:
    joined, remarks = join_sectors(columns, None)
    assert joined == columns
    assert len(remarks) == 1
    assert remarks[0].startswith(said)
    assert remarks[0].endswith("; left as single columns")


@pytest.mark.parametrize(
    "columns",
    [
        columns_of("ABDC", 16, "g/cc"), columns_of("GRAS", 4, ""), columns_of("X", 4, "gAPI"),
        columns_of("X", 8, "ohm.m"), columns_of("R", 6, "in"), columns_of("P", 4, "mm"),
        [channel(f"P{n}", "ohmm", axis=SectorAxis(90.0 * n, np.nan, "deg")) for n in range(4)],
    ],
)  # fmt: skip
def test_columns_around_the_hole_are_an_image(columns: list[Channel]) -> None:
    (image,), remarks = join_sectors(columns, None)
    assert (image.shape, image.member_names, remarks) == ((3, len(columns)), tuple(c.name for c in columns), [])


def test_a_series_of_sectors_has_a_name_of_its_own(golden: Golden) -> None:
    brackets = [("", ""), ("[", "]"), ("(", ")"), ("_", ""), (".", "")]
    pairs = zip(brackets, ["gapi", "g/cc", "cps", "b/e", "kg/m3"], strict=True)
    columns = [channel(f"GR{a}{n}{b}", unit, [1.0]) for (a, b), unit in pairs for n in range(1, 5)]
    joined, remarks = join_sectors(columns, None)
    assert [each.name for each in joined] == ["GR", "GR#", "GR##", "GR###", "GR####"]
    assert remarks == []
    joined, remarks = join_sectors([channel(f"GR{n}", "gapi", [1.0]) for n in (4, 3, 2, 1)], None)
    assert len(joined) == 4
    golden(remarks)


def test_arms_go_in_pairs() -> None:
    both = guess(log_set(channel("cal_x", "in"), channel("cal_y", "in"), channel("RB", "deg")))
    assert (both["cal_x"].role, both["cal_x"].angle, both["cal_y"].angle) == ("diameter", 0.0, 90.0)
    alone = guess(log_set(channel("cal_x", "in"), channel("RB", "deg")))
    assert (alone["cal_x"].role, alone["cal_x"].angle) == ("none", None)
    assert "its partner at right angles is missing" in alone["cal_x"].reason


def test_images_say_what_they_are(golden: Golden) -> None:
    grid = np.ones((3, 8))
    axis = SectorAxis(0.5, 0.25, "rad")
    roles = guess(log_set(channel("A", "mm", grid, axis=axis), channel("B", "gAPI", grid)))
    assert (roles["A"].role, roles["B"].role) == ("radius-image", "image")
    assert roles["A"].first == pytest.approx(np.degrees(0.5))
    assert roles["A"].step == pytest.approx(np.degrees(0.25))
    golden(roles["B"].reason)


def samples_of(*channels: Channel, **more: object) -> object:
    return log_set(*channels).caliper(**more)  # type: ignore[arg-type]


DEPTH = channel("MD", "m", np.arange(40.0))
TURN = channel("TF", "deg", np.arange(40.0) * 9.0)


def radius(metres: float) -> Channel:
    return channel("radius", "m", np.full(40, metres))


@pytest.mark.parametrize(
    "channels",
    [
        (DEPTH, TURN, radius(0.2159)),
        (DEPTH, TURN, radius(108.0)),
        (DEPTH, TURN, channel("radius", "", np.full(40, 0.1))),
        (DEPTH, TURN, radius(np.nan)),
        (DEPTH, channel("TF", "deg", np.linspace(0, 6.28, 40)), radius(0.1)),
        (DEPTH, channel("TF", "", np.linspace(0, 6.28, 40)), radius(0.1)),
        (DEPTH, channel("TF", "deg", np.full(40, 1e4)), radius(0.1)),
        (DEPTH, radius(0.1)),
        (TURN, radius(0.1)),
        (DEPTH, TURN),
        (DEPTH, channel("CALI", "in", np.full(40, 8.5))),
        (DEPTH, channel("GR", "API", np.ones((40, 8)))),
        (DEPTH, channel("INC", "deg", np.zeros(40)), channel("AZI", "deg", np.zeros(40))),
        (DEPTH, channel("cal_x", "in", np.full(40, 8.5)), channel("cal_y", "in", np.full(40, 8.5))),
        (channel("MD", "m", np.full(40, np.nan)), TURN, radius(0.1)),
        (DEPTH, TURN, channel("radius", "mm", np.full(40, 216.0)), channel("BS", "in", np.full(40, 8.5))),
        (channel("Z", "m", -2000.0 - np.arange(40.0), "measured depth"), TURN, radius(0.1)),
        (DEPTH, TURN, channel("diameter", "mm", np.full(40, 8.5))),
    ],
)
def test_samples_that_cannot_be(channels: tuple[Channel, ...], golden: Golden) -> None:
    with golden.raises() as caught:
        samples_of(*channels)
    assert str(caught.value).startswith("f.las")


def test_a_caliper_holds_no_impossible_radius() -> None:
    for metres in (0.0, -0.1, 2.5):
        one = log_set(DEPTH, TURN, channel("radius", "m", np.where(np.arange(40) == 7, metres, 0.1)))
        assert wall_samples(one).radius[7] == metres  # for conditioning to judge
        rule = rf"^f.las, row 7, column radius: radius {metres:g} m: must be above 0 and at most 2 m; prep"
        with pytest.raises(ValueError, match=rule):
            one.caliper()


def test_a_caliper_holds_the_samples() -> None:
    one = log_set(DEPTH, TURN, channel("diameter", "in", np.full(40, 8.5)))
    caliper, found = one.caliper(), wall_samples(one)
    assert isinstance(caliper, hb.Caliper)
    np.testing.assert_array_equal(caliper.depth, found.depth)
    np.testing.assert_array_equal(caliper.toolface, found.toolface)
    np.testing.assert_array_equal(caliper.radius, found.radius)
    assert caliper.time is None


def test_a_survey_of_one_station_names_the_file() -> None:
    one = log_set(channel("MD", "m", [1.0]), channel("INC", "deg", [1.0]), channel("AZI", "deg", [1.0]))
    with pytest.raises(ValueError, match=r"^f.las: survey has 1 station"):
        one.survey()


def test_a_survey_of_two_norths_says_which_azimuth_counts_and_by_how_much_the_other_differs() -> None:
    angles = [channel("INC", "deg", [30.0, 31.0, 32.0]), channel("AZIM_MAG", "deg", [358.0, 359.0, 0.5])]
    one = log_set(channel("MD", "m", [1.0, 2.0, 3.0]), *angles, channel("AZIM_TRUE", "deg", [1.0, 2.0, 3.5]))
    assert one.survey().north == "magnetic"
    rule = "AZIM_MAG is used, and columns.azimuth=AZIM_TRUE uses the other"
    said = f"survey: AZIM_TRUE differs from AZIM_MAG by +3.00 deg (median), maybe by another north: {rule}"
    assert said in one.remarks
    same = log_set(channel("MD", "m", [1.0, 2.0, 3.0]), *angles, channel("AZIM_TRUE", "deg", [358.0, 359.0, 0.5]))
    same.survey()
    assert not same.remarks


def test_suspicions_yield_to_a_map_and_to_the_bit() -> None:
    one = log_set(DEPTH, TURN, radius(0.2159))
    confirmed = overlay(guess(one), one, {"radius": {"role": "radius", "unit": "m"}})
    assert wall_samples(one, confirmed).radius[0] == 0.2159
    assert wall_samples(one, bit_diameter=0.4064).radius[0] == 0.2159  # a 16 in hole
    as_diameter = overlay(guess(one), one, {"radius": {"role": "diameter", "angle": 0.0}})
    assert wall_samples(one, as_diameter).radius[0] == pytest.approx(0.10795)
    with pytest.raises(ValueError, match="looks like a diameter"):
        wall_samples(one, confirmed, bit_diameter=0.2159)
    above = log_set(channel("MD", "m", np.arange(-40.0, 0.0)), TURN, radius(0.1))
    assert wall_samples(above, overlay(guess(above), above, {"MD": {"role": "depth"}})).depth[0] == -40
    assert wall_samples(log_set(channel("MD", "m", np.arange(-39.0, 1.0)), TURN, radius(0.1))).depth[0] == -39
    slow = log_set(DEPTH, channel("TF", "deg", np.linspace(0, 6.28, 40)), channel("radius", "m", np.full(40, 0.1)))
    mapped = overlay(guess(slow), slow, {"TF": {"unit": "rad"}})
    assert wall_samples(slow, mapped).toolface.max() == pytest.approx(np.degrees(6.28))


def test_what_an_unstated_unit_is_taken_for_is_reported() -> None:
    found = log_set(DEPTH, channel("TF", "", np.arange(40.0)), radius(0.1), channel("TIME", "", np.arange(40.0)))
    notes = found.readings().notes
    assert any(
        note.startswith("TF is toolface in deg, since a value is beyond 2 pi (no unit stated):") for note in notes
    )
    assert any(note.startswith("TIME is time in s, as no unit is stated:") for note in notes)


@pytest.mark.parametrize("inches", [6.0, 8.5, 12.25, 17.5])
def test_gauge_holes_are_not_suspected(inches: float) -> None:
    assert wall_samples(log_set(DEPTH, TURN, radius(inches * 0.0127 * 1.005))).rows == 40


def test_missing_values_are_left_out_and_counted(golden: Golden) -> None:
    depth = channel("MD", "ft", [1.0, -999.25, 3.0, 4.0, 5.0, 6.0])
    turn = channel("RB", "deg", [-10.0, 20.0, np.nan, 350.0, 400.0, 0.0])
    x = channel("C1", "in", [8.0, 8.0, 8.0, -9999.0, 8.0, 8.0])
    y = channel("C2", "in", [9.0, 9.0, 9.0, 9.0, np.inf, 9.0])
    found = wall_samples(log_set(depth, turn, x, y, channel("TIME", "min", [0, 1, 2, 3, 4, 5.0])))
    assert found.dropped == {"MD": 1, "RB": 1, "C1": 1, "C2": 1}
    assert found.row.tolist() == [0] * 4 + [3] * 2 + [4] * 2 + [5] * 4
    np.testing.assert_allclose(found.toolface, [350, 170, 80, 260, 80, 260, 40, 220, 0, 180, 90, 270])
    np.testing.assert_allclose(found.radius[:4], [0.1016, 0.1016, 0.1143, 0.1143])
    np.testing.assert_allclose(found.depth[4:6], 4 * 0.3048)
    assert found.time is not None
    assert found.time.tolist() == [0.0] * 4 + [180.0] * 2 + [240.0] * 2 + [300.0] * 4
    golden(found.notes[0])


def test_dates_become_seconds(golden: Golden) -> None:
    when = channel("TIME", "", ["1970-01-01T01:00:10+01:00", "", "1970-01-02T00:00:00.5Z"])
    one = log_set(channel("MD", "m"), channel("TF", "deg", [0, 90, 180]), channel("radius", "mm", [100.0] * 3), when)
    found = wall_samples(one)
    assert found.time is not None
    assert found.time.tolist() == [10.0, 86400.5]
    assert found.dropped == {"TIME": 1}
    bad = channel("TIME", "", ["1970-01-01T00:00:10Z", "noon", ""])
    one = log_set(channel("MD", "m"), channel("TF", "deg", [0, 90, 180]), channel("radius", "mm", [100.0] * 3), bad)
    with golden.raises():
        wall_samples(one)


def test_radius_image_turns_with_the_tool() -> None:
    grid = np.full((2, 4), 110.0)
    grid[1, 2] = np.nan
    one = log_set(channel("MD", "m", [1.0, 2.0]), channel("RB", "deg", [350.0, 10.0]), channel("FING", "mm", grid))
    mapped = overlay(guess(one), one, {"FING": {"first": 45, "step": 90.0}})
    found = wall_samples(one, mapped)
    assert found.toolface.tolist() == [35.0, 125.0, 215.0, 305.0, 55.0, 145.0, 325.0]
    assert found.dropped == {"FING": 1}


def test_image_depth_must_run_one_way(golden: Golden) -> None:
    grid = np.arange(12.0).reshape(3, 4)
    up = log_set(channel("MD", "m", [3.0, 2.0, 1.0]), channel("I", "", grid)).image("I")
    assert up.depth.tolist() == [3.0, 2.0, 1.0]
    holes = log_set(channel("MD", "m", [1.0, np.nan, 2.0]), channel("I", "", grid)).image("I")
    assert (holes.values[:, 0].tolist(), holes.dropped) == ([0.0, 8.0], 1)
    for depth, rule in (
        ([1.0, 1.0, 2.0], "row 1, column MD: depth 1 m after 1 m"),
        ([1.0, 3.0, 2.0], "row 2, column MD"),
    ):
        with pytest.raises(ValueError, match=re.escape(rule)):
            log_set(channel("MD", "m", depth), channel("I", "", grid)).image("I")
    with golden.raises():
        log_set(channel("MD", "m"), channel("I", "", grid)).image("MD")


def test_an_image_of_a_file_becomes_one_for_walls_in_one_line(golden: Golden) -> None:
    grid = np.arange(12.0).reshape(3, 4)
    one = log_set(channel("MD", "m", [1.0, 2.0, 3.0]), channel("I", "gAPI", grid))
    plain = one.image("I").sector_image(origin="edge", reference="north")
    assert (plain.name, plain.unit, plain.direction, plain.offset) == ("I", "gAPI", "clockwise", 0.0)
    assert plain.values.tolist() == grid.tolist()
    mapped = one.image("I", overlay(guess(one), one, {"I": {"first": 30.0, "step": -90.0}}))
    turned = mapped.sector_image(origin="centre", reference="high-side", name="GR", reach=2.0)
    assert (turned.name, turned.direction, turned.offset, turned.reach) == ("GR", "counterclockwise", 30.0, 2.0)
    assert turned.toolface.tolist() == [30.0, 300.0, 210.0, 120.0]
    stated = mapped.sector_image(origin="centre", reference="north", direction="clockwise", offset=5.0)
    assert (stated.direction, stated.offset) == ("clockwise", 5.0)
    wrong = one.image("I", overlay(guess(one), one, {"I": {"first": 0.0, "step": 45.0}}))
    with golden.raises():
        wrong.sector_image(origin="edge", reference="north")
    empty = log_set(channel("MD", "m", [1.0, 2.0, 3.0]), channel("I", "", np.full((3, 4), np.nan))).image("I")
    with pytest.raises(ValueError, match=r"^I: values: all 12 are missing$"):
        empty.sector_image(origin="edge", reference="north")


def test_depth_remarks(golden: Golden) -> None:
    from helibore.channels.depth_remarks import depth_remarks

    one = log_set(channel("MD", "m", [1, 2, 3, 9, 8, 8.0]))
    golden(depth_remarks(one, guess(one)))


def test_every_role_is_documented() -> None:
    assert {"depth", "toolface", "radius", "diameter", "image", "none"} <= set(ROLES)


def test_depths_in_other_units_are_told_in_metres_too() -> None:
    one = log_set(channel("DEPT", "0.1 in", (1023720.0, 1023780.0, 1023840.0)), index="DEPT")
    assert depth_remarks(one, guess(one)) == ["DEPT: 2600.25 to 2600.55 m", "DEPT: median step 60 x 0.1 in"]
    metric = log_set(channel("DEPT", "m", (1.0, 2.0, 3.0)), index="DEPT")
    assert depth_remarks(metric, guess(metric)) == ["DEPT: median step 1 m"]


@pytest.mark.parametrize(
    ("value", "text"), [(1023720.0, "1023720"), (60467.76, "60468"), (2.55541, "2.5554"), (0.0, "0"), (1e30, "1e+30")]
)
def test_ranges_are_short(value: float, text: str) -> None:
    from helibore.cli.inspect_page import short

    assert short(value) == text


def test_an_amplitude_in_decibels_has_its_unit() -> None:
    assert [unit_in_name(name) for name in ("AMP12_dB", "AMP [dB]", "AMP")] == ["dB", "dB", ""]
