"""A wrong configuration never starts, and says what is wrong where."""

from __future__ import annotations

import re

import pytest
from locations import ROOT

from helibore.live.rules.configuration import load, parse
from helibore.live.rules.layout import Layout
from helibore.live.rules.sources import Item
from helibore.live.wire import wits
from helibore.live.wire.address import Address

WALL = "[wall]\nbit_diameter = 0.2\nstart_depth = 10.0\n"
SOURCE = '[source.rig]\naddress = "tcp://127.0.0.1:9872"\nunits = "metric"\n'
CALIPER = "[source.rig.caliper]\n"
IMAGE = '[source.rig.image.GR]\nfirst = "5110"\ncount = 4\nunit = "gAPI"\n'


def test_a_full_configuration_is_read_in_core_units():
    c = parse(
        WALL + 'sectors = 32\n[journal]\nfolder = "j"\nsync_ms = 50\n[layers]\nream = ["ream"]\n'
        '[source.rig]\naddress = "listen://[::1]:9872"\nunits = "fps"\nnulls = [-9999, 9999.5]\n'
        'mode = "poll"\nevery = 2\n'
        'items = { bit_depth = "0108", hole_depth = { item = "0110", unit = "m" }, rotation = "0120" }\n'
        'caliper = { first = "5010", groups = 2, order = ["radius", "toolface"], measures = "diameter",'
        " offset = 12.5 }\n"
        'image.GR = { first = "5110", count = 4, unit = "gAPI", origin = "edge", reference = "high-side",'
        ' direction = "counterclockwise", toolface_offset = 45 }\nsurvey = { azimuth = "0714" }\n'
    )
    rig = c.sources["rig"]
    assert rig.address == Address("listen", "::1", 9872)
    assert rig.rig == {"bit_depth": Item("0108", 0.3048), "hole_depth": Item("0110", 1.0), "rotation": Item("0120")}
    assert rig.nulls == [-9999.0, 9999.5]
    assert (rig.mode, rig.message, [str(one) for one in rig.allow]) == (
        "poll",
        (wits.POLL, 2.0),
        ["127.0.0.1/32", "::1/128"],
    )
    assert [item.name for item in rig.caliper.radius] == ["5010", "5012"]
    assert [item.name for item in rig.caliper.toolface] == ["5011", "5013"]
    assert rig.caliper.radius[0].scale == 0.0254 / 2
    assert rig.caliper.depth == []
    assert [item.name for item in rig.images[0].sectors] == ["5110", "5111", "5112", "5113"]
    assert rig.images[0].layout == Layout("edge", "high-side", "counterclockwise", 45.0)
    assert [(item.name, item.scale) for item in rig.station] == [("0708", 0.3048), ("0713", 1.0), ("0714", 1.0)]
    assert rig.records == [1, 7, 50, 51]
    assert c.layers == {"main": ["drill", "rescan", "unknown"], "ream": ["ream"]}
    assert (c.journal.folder, c.journal.sync_interval, c.wall["sectors"]) == ("j", 0.05, 32)


@pytest.mark.parametrize(
    ("address", "expected"),
    [
        ("tcp://10.0.0.7:5001", Address("tcp", "10.0.0.7", 5001)),
        ("serial:///dev/ttyUSB0?baud=115200", Address("serial", file="/dev/ttyUSB0", baud=115200)),
        ("file:///x/y.wits?speed=960", Address("file", file="/x/y.wits", speed=960.0)),
        ("file:///x/well#7@rig.wits", Address("file", file="/x/well#7@rig.wits")),
        ("host", Address("host")),
    ],
)
def test_addresses(address, expected):
    assert parse(WALL + SOURCE.replace("tcp://127.0.0.1:9872", address)).sources["rig"].address == expected


@pytest.mark.parametrize(
    ("address", "shown"),
    [
        ("http://store/x?token=s3cret", "'http://store/x?...': must be https: "),
        ("HTTPS://store/x?token=s3cret", "'HTTPS://store/x?...': must not hold a query: "),
        ("https://store/x?token=a@s3cret", "'https://...': must not hold a user or password: "),
        ("https://rig:s3cret?@store/x", "'https://...': must not hold a user or password: "),
        ("tcp://10.0.0.7:1?token=s3cret", "'tcp://10.0.0.7:1?...': must be tcp://HOST:PORT, "),
        ("tcp://rig:s3cret@10.0.0.7", "'tcp://...': must not hold a user or password"),
        ("https://store/x#s3cret@store", "'https://...': must not hold a user or password: "),
    ],
)
def test_the_error_of_an_address_shows_no_secret(address, shown):
    with pytest.raises(ValueError, match=r"^source.rig.address = ") as error:
        parse(WALL + SOURCE.replace("tcp://127.0.0.1:9872", address))
    assert shown in str(error.value)
    assert "s3cret" not in str(error.value)


@pytest.mark.parametrize(
    "address", ["file:///x?speed=-1", "file:///x?speed=nan", "file:///a@b?speed=x", "serial:///dev/ttyS0?baud=0"]
)
def test_a_speed_that_no_line_has_is_refused(address):
    with pytest.raises(ValueError, match=r"must be tcp://HOST:PORT, ") as error:
        parse(WALL + SOURCE.replace("tcp://127.0.0.1:9872", address))
    assert f"source.rig.address = '{address}': " in str(error.value)


def test_what_is_only_transport_does_not_change_the_meaning():
    one = parse(WALL + SOURCE)
    other = parse(WALL + '[source.rig]\naddress = "host"\nunits = "metric"\nmode = "heartbeat"\nallow = []\n')
    assert one.meaning() == other.meaning()
    assert parse(WALL + SOURCE.replace("metric", "fps")).meaning() != one.meaning()


@pytest.mark.parametrize(
    ("text", "error"),
    [
        ("", "wall.bit_diameter: must be set: metres"),
        ("[wall]\nbit_diameter = 0.2\n", "wall.start_depth: must be set: metres, the depth of the first vertex"),
        (WALL, "source: must be set: at least one table [source.NAME]"),
        (WALL + "x = 1\n" + SOURCE, "wall.x: is not a setting"),
        (WALL + "pitch = 0\n" + SOURCE, "wall.pitch = 0: must be finite and not 0"),
        (WALL.replace("0.2", '"8 in"') + SOURCE, "wall.bit_diameter = '8 in': must be a finite number"),
        (
            WALL + '[source.rig]\naddress = "host"\n',
            'source.rig.units: must be set: "metric" or "fps", because WITS does not transmit units',
        ),
        (WALL + SOURCE.replace("metric", "SI"), 'source.rig.units = \'SI\': must be "metric" or "fps"'),
        (
            WALL + SOURCE.replace("tcp", "udp"),
            "source.rig.address = 'udp://127.0.0.1:9872': must be tcp://HOST:PORT, "
            "listen://HOST:PORT, serial:///DEVICE?baud=N, file:///PATH?speed=BYTES_A_SECOND, https://STORE or host",
        ),
        (WALL + SOURCE + "speed = 3\n", "source.rig.speed: is not a setting"),
        (
            WALL + SOURCE + 'items = { bit_depth = "108" }\n',
            "source.rig.items.bit_depth = '108': must be four digits RRII, 01 to 99 each",
        ),
        (
            WALL + SOURCE + 'items = { depth = "0108" }\n',
            "source.rig.items.depth: is not a setting; did you mean bit_depth?",
        ),
        (
            WALL + SOURCE + 'items = { bit_depth = { item = "0108", unit = "fathom" } }\n',
            "source.rig.items.bit_depth.unit = 'fathom': not known; known are "
            "m, cm, mm, ft, ftUS, in, 0.1in, deg, rad, s, ms, us, min, h, rpm, c/s, rad/s",
        ),
        (WALL + SOURCE + CALIPER, "source.rig.caliper.toolface: must be set: a list of items, one for each triple"),
        (
            WALL + SOURCE + CALIPER + 'toolface = ["5010", "5013"]\nradius = ["5011", "5012", "5014"]\n',
            "source.rig.caliper: toolface, radius and depth must have equally many items, "
            "not {'toolface': 2, 'radius': 3}",
        ),
        (
            WALL + SOURCE + CALIPER + 'toolface = ["5010"]\nradius = ["5011", "5012"]\n',
            "source.rig.caliper.toolface_offset = 0.0: several radii have one toolface: must be a list with the angle "
            "of each sensor, such as [0, 90, 180, 270]",
        ),
        (
            WALL
            + SOURCE
            + CALIPER
            + 'toolface = ["5010"]\nradius = ["5011", "5012"]\ntoolface_offset = [0, 90, 180]\n',
            "source.rig.caliper.toolface_offset = [0.0, 90.0, 180.0]: must be a number, or a list of 2",
        ),
        (
            WALL + SOURCE + CALIPER + 'toolface = ["5010"]\nradius = ["5011"]\ntoolface_offset = ["x"]\n',
            "source.rig.caliper.toolface_offset = ['x']: must be a number from -360 to 360, or a list of such numbers",
        ),
        (
            WALL + SOURCE + CALIPER + 'toolface = ["5010"]\nradius = ["50x1"]\n',
            "source.rig.caliper.radius[0] = '50x1': must be four digits RRII, 01 to 99 each",
        ),
        (
            WALL + SOURCE + CALIPER + 'first = "5010"\ngroups = 31\n',
            "source.rig.caliper.groups = 31: items 5010 and 92 more must not pass item 99",
        ),
        (
            WALL + SOURCE + CALIPER + 'first = "5010"\ngroups = 3\norder = ["radius"]\n',
            'source.rig.caliper.order = [\'radius\']: must name "toolface" and "radius" once each, '
            '"depth" at most once, and nothing else',
        ),
        (
            WALL + SOURCE + CALIPER + 'toolface = ["5010"]\nradius = ["5011"]\n',
            "source.rig.caliper: has no depth items, and no source maps bit_depth",
        ),
        (
            WALL + SOURCE + IMAGE,
            'source.rig.image.GR.origin: must be set: "centre" or "edge": the part of sector 1 at toolface_offset; '
            "tools differ",
        ),
        (
            WALL + SOURCE + IMAGE + 'origin = "center"\n',
            'source.rig.image.GR.origin = \'center\': must be "centre" or "edge"',
        ),
        (
            WALL + SOURCE + IMAGE + 'origin = "edge"\n',
            'source.rig.image.GR.reference: must be set: "high-side" or "north": the direction of toolface 0',
        ),
        (
            WALL + SOURCE + IMAGE + 'origin = "edge"\nreference = "north"\n',
            "source.rig.image.GR.reference = 'north': must be the path's reference, \"high-side\": "
            "live images are not converted to it",
        ),
        (
            WALL + SOURCE + IMAGE.replace("count = 4", "count = 0") + 'origin = "edge"\nreference = "high-side"\n',
            "source.rig.image.GR.count = 0: must be a whole number from 1 to 99",
        ),
        (
            WALL + SOURCE + IMAGE + 'origin = "edge"\nreference = "high-side"\n',
            "source.rig.image.GR: has no depth item, and no source maps bit_depth",
        ),
        (
            WALL
            + SOURCE
            + 'items = { bit_depth = "0108" }\n'
            + SOURCE.replace("rig", "b")
            + 'items = { bit_depth = "0108" }\n',
            "source.b.items.bit_depth: is mapped by source.rig already",
        ),
        (WALL + SOURCE + 'nulls = ["x"]\n', "source.rig.nulls[0] = 'x': must be a finite number"),
        (WALL + SOURCE + "line_limit = 3\n", "source.rig.line_limit = 3: must be a whole number from 16 to 16777216"),
        (WALL + SOURCE + "every = 0\n", "source.rig.every = 0: must be from 0.05 to 3600"),
        (
            WALL + SOURCE + '[layers]\nPasses = ["ream"]\n',
            "layers.Passes = ['ream']: must differ from the tables of the snapshot: passes, events, survey, image-*",
        ),
        (
            WALL + SOURCE + '[layers]\nimage-GR = ["ream"]\n',
            "layers.image-GR = ['ream']: must differ from the tables of the snapshot: passes, events, survey, image-*",
        ),
        (
            WALL + SOURCE + '[layers]\n"a\\u0000" = ["ream"]\n',
            "layers.a\\x00 = ['ream']: its name must be printable and at most 200 bytes, because files are named after "
            "it",
        ),
        (
            WALL + SOURCE + IMAGE.replace("GR", '"G\\u0000"'),
            "source.rig.image.'G\\x00': its name must be printable and at most 200 bytes, because files are named "
            "after it",
        ),
        (
            WALL + SOURCE + '[layers]\na = ["swim"]\n',
            "layers.a = 'swim': must be one of drill, ream, rescan, trip, unknown, or \"pass N\" for the pass number N",
        ),
        (
            WALL + SOURCE + "[path]\nhead = [1]\n",
            "path.head = [1]: must be three numbers: north, east, down in metres",
        ),
        (
            WALL + SOURCE + "[path]\nstations = [[1, 2]]\n",
            "path.stations[0] = [1, 2]: must be [depth m, inclination deg, azimuth deg]",
        ),
        (WALL + SOURCE + "[passes]\nmax_depth_gap = -1\n", "passes.max_depth_gap = -1: must be from 0.001 to 3600"),
        (WALL + SOURCE + "[other]\n", "other: is not a setting"),
        ("wall = 3", "wall = 3: must be a table"),
        (
            WALL + SOURCE + "items = { bit_depth = 0108 }\n",
            'configuration, line 7 = 0108: an item must be in quotes: "0108"',
        ),
        (
            WALL + SOURCE + "items = { bit_depth = 1108 }\n",
            'source.rig.items.bit_depth = 1108: must be four digits RRII, 01 to 99 each, in quotes: "1108"',
        ),
        (WALL + SOURCE + "silense = 60\n", "source.rig.silense: is not a setting; did you mean silence?"),
        ("source = 3\n" + WALL, "source = 3: must be a table"),
        (WALL + SOURCE + "image = 3\n", "source.rig.image = 3: must be a table"),
    ],
)
def test_what_is_wrong_is_named(text, error):
    with pytest.raises(ValueError) as raised:  # noqa: PT011 (the text is compared whole below)
        parse(text)
    assert str(raised.value) == error


def test_a_file_is_named_in_its_errors(tmp_path):
    file = tmp_path / "rig.toml"
    file.write_text("[wall\n")
    with pytest.raises(ValueError, match=r"rig\.toml: is not TOML: "):
        load(file)
    file.write_bytes("# Größe\n".encode("latin-1") + (WALL + SOURCE).encode())
    with pytest.raises(ValueError, match=r"rig\.toml: must be in UTF-8: .* byte 0xf6 in position 4"):
        load(file)
    file.write_text(WALL + SOURCE)
    assert load(file).sources["rig"].mode == "listen"


def test_a_file_may_begin_with_a_byte_order_mark(tmp_path):
    file = tmp_path / "rig.toml"
    file.write_text(WALL + SOURCE, encoding="utf-8-sig")
    assert load(file).text == WALL + SOURCE


def test_every_setting_of_the_page_is_read():
    page = (ROOT / "docs/live.md").read_text()
    text, store, broker = re.findall(r"```toml\n(.*?)```", page, re.DOTALL)
    polled = parse(WALL + store).sources["store"]
    assert (len(polled.caliper.radius), len(polled.images[0].sectors), polled.address.port) == (2, 4, 443)
    sent = parse(WALL + broker).sources["broker"]
    assert (sent.address.kind, len(sent.caliper.depth), list(sent.rig)) == ("mqtts", 1, ["bit_depth", "rotation"])
    c = parse(text)
    assert set(c.sources) == {"rig", "mwd"}
    assert len(c.sources["mwd"].caliper.radius) == 30
    assert set(c.layers) == {"main", "ream", "again"}
