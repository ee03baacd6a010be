"""What turns channels into readings, surveys and images refuses, one case a rule: the whole text of each error."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from golden_texts import Golden

import helibore as hb
from helibore.channels.log_set import LogFile, LogSet
from helibore.channels.role_map import overlay, read_map
from helibore.channels.roles import ROLES, guess
from helibore.files.raw_set import Channel

N = 8
GOOD: dict[str, Any] = {"MD__m": 100 + np.arange(N), "TF__deg": 80.0 * np.arange(N) % 360, "radius__m": np.full(N, 0.1)}
ARMS = "set first and step (degrees) in a map"
NAME_ONE = "name one by an option or in a map"


def log(**columns: Any) -> LogSet:
    channels = []
    for key, values in columns.items():
        name, _, unit = key.partition("__")
        channels.append(Channel(name, unit, "", np.array(values)))
    return LogSet(Path("f.las"), "s", channels, channels[0].shape[0])


def made(columns: dict[str, Any]) -> LogSet:
    return log(**{name: values for name, values in (GOOD | columns).items() if values is not None})


@pytest.mark.parametrize(
    ("columns", "entries", "text"),
    [
        ({"MD__m": None}, {}, f'f.las: no channel has the role depth: {NAME_ONE} ([channels."..."] role = "depth"); '
                              "the channels are TF, radius"),
        ({"MD__m": np.arange(N) - 2000.0}, {},
         "f.las, column MD: -2000 to -1993 m: negative throughout (elevations?), and depth counts positive down the "
         'hole; change the signs, or confirm role = "depth" in a map'),
        ({"MD__m": np.where(np.arange(N) % 4, 1000 + np.arange(N), -999.0)}, {},
         "f.las, row 0, column MD: -999 m in 2 rows, other depths lie between 1001 and 1007 m: a number that "
         "means no value? nulls=-999 says so"),
        ({"MD__m": None, "MD": 100 + np.arange(N)}, {},
         "f.las, column MD: unit missing: state it in the name of the column (MD [ft]), in a map "
         '([channels."MD"] unit = ...), or by columns.depth=MD:ft; depth is length'),
        ({"MD__m": None, "MD": 100 + np.arange(N), "radius__m": None, "RAD": np.full(N, 4.3)}, {},
         f"f.las: no channel has the role radius, diameter or radius-image: {NAME_ONE}, such as columns.radius=RAD:in "
         "and columns.depth=MD:ft, since MD states no unit; the channels are TF, MD, RAD"),
        ({"TF__deg": np.full(N, np.nan)}, {}, "f.las, column TF: every value is missing"),
        ({"TF__deg": np.full(N, 1e4)}, {}, "f.las, row 0, column TF: 10000 deg: an angle lies within -720 and 720; if "
                                           "the number means no value, nulls=10000 says so"),
        ({"TF__deg": np.arange(N) + 1e4}, {}, "f.las, row 0, column TF: 10000 deg: an angle lies within -720 and 720"),
        ({"TF__deg": np.linspace(0, 6.28, N)}, {"radius": {"unit": "m"}}, None),
        ({"radius__m": np.full(N, np.nan)}, {}, "f.las, column radius: every value is missing"),
        ({"radius__m": np.full(N, 0.216)}, {},
         'f.las, column radius: median 0.216: looks like a diameter, where a radius is expected; state role = '
         '"diameter" in a map, or give the bit diameter or confirm role = "radius" there'),
        ({"radius__m": None, "DIAM__m": np.full(N, 0.108)}, {}, "bit 0.216",),
        ({"radius__m": None}, {}, "f.las: no channel has the role radius, diameter or radius-image: "
                                  f"{NAME_ONE}, such as columns.radius=NAME:in; the channels are MD, TF"),
        ({"radius__m": np.full((N, 4), 0.1)}, {"radius": {"role": "radius"}},
         "f.las, column radius: a radius has one value a row, this has 4: its role is radius-image"),
        ({"radius__m": np.full((N, 4), 0.1)}, {},
         f"f.las, column radius: the angles of its sectors are not stated: {ARMS}, or, if they are even around the "
         "tool, columns.radius=radius@ANGLE, that of the first"),
        ({"radius__m": None, "TT__us": np.full(N, 90.0)}, {},
         "f.las, column TT: a travel time needs the velocity in the mud and the tool's radius"),
        ({"TF__deg": None, "radius__m": None, "cal_x__in": np.full(N, 8.5), "cal_y__in": np.full(N, 8.6)}, {},
         "f.las, column cal_x: an arm pair that turns with the tool needs a toolface: name its channel in a map; of "
         "a tool that does not turn, state the angle of each pair: columns.diameter=cal_x@0"),
        ({"TF__deg": None}, {},
         "f.las, column radius: no toolface: name the toolface channel, or the angle of this channel, by an option or "
         "in a map"),
        ({"pass": np.arange(N) + 0.5}, {}, "f.las, row 0, column pass: 0.5: a pass is a whole number"),
        ({"time": np.array(["2020-01-01T00:00:00"] * 7 + ["2020-01-01T00:00:00-0330"])}, {},
         "f.las, row 7, column time: '2020-01-01T00:00:00-0330' has a time zone, unlike the dates above: all dates "
         "must have one, or none"),
        ({"time": np.array(["2020-01-01T00:00:00"] * 7 + ["noon"])}, {},
         "f.las, row 7, column time: 'noon' is no ISO 8601 date and time"),
        ({"tf_type": np.array(["N"] * 7 + ["up"])}, {},
         "f.las, row 7, column tf_type: 'up': must be one of n, north, m, mtf, magnetic, 0 (north) or h, hs, high "
         "side, high-side, g, gtf, gravity, top, 1 (high side)"),
        ({}, {"radius": {"angles": 3}}, "map: channels.radius.angles: not known; did you mean angle?"),
        ({}, {"radius": 3}, "map: channels.radius = 3: must be a table"),
        ({}, {"radius": {"angle": "x"}},
         "map: channels.radius.angle = 'x': must be a number with a unit of angle, such as 90deg or 1.57rad"),
        ({}, {"radius": {"angle": 10**400}}, f"map: channels.radius.angle = {10**400}: must be a number"),
        ({}, {"radius": {"unit": 3}}, "map: channels.radius.unit = 3: must be text"),
        ({}, {"radius": {"role": "size"}}, f"map: channels.radius.role = 'size': must be one of {', '.join(ROLES)}"),
        ({}, {"radius": {"unit": "deg"}}, "map: channels.radius.unit = 'deg': must be a unit of length for a radius"),
        ({}, {"radius": {"reference": "north"}},
         "map: channels.radius.reference = 'north': belongs to a role of toolface"),
        ({}, {"TF": {"reference": "south"}},
         "map: channels.TF.reference = 'south': must be one of north, horizontal-north, high-side, automatic"),
        ({}, {"radius": {"north": "true"}},
         "map: channels.radius.north = 'true': belongs to a role of toolface or azimuth"),
        ({}, {"radius": {"offset": float("inf")}}, "map: channels.radius.offset = inf: must be finite"),
        ({}, {"TF": {"offset": 1.0}},
         "map: channels.TF.offset = 1: belongs to a sensor: a role of radius, diameter, radius-image, travel-time"),
        ({}, {"nope": {}}, "map: channels.nope: no channel of this name; the set holds MD, TF, radius"),
        ({"TF2__deg": np.zeros(N)}, {"TF": {"role": "toolface"}, "TF2": {"role": "toolface"}},
         "map: channels.TF2: TF is the toolface already"),
    ],
)  # fmt: skip
def test_readings(columns: dict[str, Any], entries: dict[str, Any], text: str | None) -> None:
    one, bit = made(columns), None
    if text == "bit 0.216":
        bit, text = 0.216, (
            "f.las, column DIAM: median 0.108: looks like a radius, where a diameter is expected: the bit's diameter "
            'is 0.216 m; state role = "radius" in a map, or columns.radius=DIAM'
        )  # fmt: skip
    if text is None:  # fewer than twenty angles may well lie within two pi
        assert one.readings(overlay(guess(one), one, entries)).rows == N
        return
    with pytest.raises(hb.InputError) as caught:
        one.readings(overlay(guess(one), one, entries), bit)
    assert str(caught.value) == text


@pytest.mark.parametrize(
    ("columns", "place"),
    [
        ({"INCL__deg": np.full(N, 1.2), "AZIM__deg": np.linspace(0, 6, N)},
         "f.las, column AZIM"),
        ({"INCL__deg": np.full(N, 190.0), "AZIM__deg": np.zeros(N)},
         "f.las, row 0, column INCL"),
        ({"INCL__deg": np.zeros(N), "AZIM__deg": np.full(N, 400.0)},
         "f.las, row 0, column AZIM"),
        ({"MD__m": np.r_[np.arange(7), 6.0], "INCL__deg": np.arange(N), "AZIM__deg": np.zeros(N)},
         "f.las, row 7, column MD"),
        ({"MD__m": np.r_[1.0, np.full(7, np.nan)], "INCL__deg": np.zeros(N), "AZIM__deg": np.zeros(N)},
         "f.las"),
    ],
)  # fmt: skip
def test_surveys(columns: dict[str, Any], place: str, golden: Golden) -> None:
    one = log(**(({} if "MD__m" in columns else {"MD__m": np.arange(N)}) | columns))
    with golden.raises(place):
        one.survey()


@pytest.mark.parametrize(
    ("depth", "name", "place"),
    [
        (np.arange(N), "GR", "f.las, column GR"),
        (np.arange(N), "RES", "f.las"),
        (np.full(N, np.nan), "I", "f.las, column MD"),
        (np.r_[np.arange(7), 3.0], "I",
         "f.las, row 7, column MD"),
    ],
)  # fmt: skip
def test_images(depth: Any, name: str, place: str, golden: Golden) -> None:
    one = log(MD__m=depth, GR__gapi=np.ones(N), I__gapi=np.ones((N, 8)))
    with golden.raises(place):
        one.image(name)


@pytest.mark.parametrize(
    "text",
    [
        "[",
        "set = 3",
        "channels = 3",
        "roles = 3",
        'set = "t"',
    ],
)
def test_maps(tmp_path: Path, text: str, golden: Golden) -> None:
    (tmp_path / "m.toml").write_text(text)
    with golden.raises():
        read_map(tmp_path / "m.toml", LogFile(Path("f.las"), "LAS", [made({})]))


def test_radians_among_many_angles() -> None:
    one = log(MD__m=np.arange(40), TF__deg=np.linspace(0, 6.28, 40), radius__m=np.full(40, 0.1))
    with pytest.raises(hb.InputError) as caught:
        one.readings()
    rule = "values between 0 and 6.28 deg: looks like radians; state the unit in a map or as TF:rad"
    assert str(caught.value) == f"f.las, column TF: {rule}"


def test_several_sets_and_an_unknown_unit(golden: Golden) -> None:
    file = LogFile(Path("f.las"), "LAS", [made({}), LogSet(Path("f.las"), "t", [], 0)])
    with golden.raises():
        file.readings()
    one = made({})
    roles = guess(one)
    object.__setattr__(roles["radius"], "unit", "furlong")
    with pytest.raises(hb.InputError) as caught:
        one.readings(roles)
    assert str(caught.value).startswith("f.las, column radius: ")
