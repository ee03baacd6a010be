"""A wrong configuration never starts, and says what is wrong where."""

from __future__ import annotations

import json
import re

import pytest
from live_wires import refused
from locations import ROOT

from helibore.base.errors import InputError
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
    assert (rig.table.mode, rig.message, [str(one) for one in rig.allow]) == (
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
    "address",
    [
        "http://store/x?token=s3cret",
        "HTTPS://store/x?token=s3cret",
        "https://store/x?token=a@s3cret",
        "https://rig:s3cret?@store/x",
        "tcp://10.0.0.7:1?token=s3cret",
        "tcp://rig:s3cret@10.0.0.7",
        "https://store/x#s3cret@store",
    ],
)
def test_the_error_of_an_address_shows_no_secret(address, golden):
    with golden.raises() as error:
        parse(WALL + SOURCE.replace("tcp://127.0.0.1:9872", address))
    golden(str(error.value))
    assert "s3cret" not in str(error.value)


@pytest.mark.parametrize(
    "address", ["file:///x?speed=-1", "file:///x?speed=nan", "file:///a@b?speed=x", "serial:///dev/ttyS0?baud=0"]
)
def test_a_speed_that_no_line_has_is_refused(address, golden):
    with golden.raises() as error:
        parse(WALL + SOURCE.replace("tcp://127.0.0.1:9872", address))
    assert f"source.rig.address = '{address}': " in str(error.value)


def test_a_journal_records_the_numbers_of_the_wall_as_the_file_has_them():
    """Journals of before hold ``2`` for ``power = 2``; a size with a unit is recorded in metres."""
    text = '[wall]\nbit_diameter = "8 1/2in"\nstart_depth = 10\npower = 2\ncovariance = "none"\n' + SOURCE
    found = parse(text + 'silence = "3min"\n')
    wall = json.loads(found.meaning())["wall"]
    assert wall == {"bit_diameter": 8.5 * 0.0254, "covariance": None, "power": 2, "start_depth": 10.0}
    assert [type(wall[name]) for name in ("power", "start_depth")] == [int, float]
    assert found.sources["rig"].silence == 180.0


def test_what_is_only_transport_does_not_change_the_meaning():
    one = parse(WALL + SOURCE)
    other = parse(WALL + '[source.rig]\naddress = "host"\nunits = "metric"\nmode = "heartbeat"\nallow = []\n')
    assert one.meaning() == other.meaning()
    assert parse(WALL + SOURCE.replace("metric", "fps")).meaning() != one.meaning()


@pytest.mark.parametrize(
    ("text", "place", "rule", "value"),
    [
        ("", "wall.bit_diameter", "is missing", None),
        ("[wall]\nbit_diameter = 0.2\n", "line 1: wall.start_depth", "is missing", None),
        (WALL, "source", "is missing: at least one table [source.NAME]", None),
        (WALL + "x = 1\n" + SOURCE, "line 4: wall.x", "must be one of bit_diameter, sectors", None),
        (WALL + "pitch = 0\n" + SOURCE, "line 4: wall.pitch", "must be finite and not 0", "0"),
        (
            WALL + "arm_biases = [1e-4, 0.0]\n" + SOURCE,
            "line 4: wall.arm_biases",
            "must be left out: live samples have no arm numbers",
            None,
        ),
        (
            WALL + '[source.rig]\naddress = "host"\n',
            "line 4: source.rig.units",
            "is missing; it must be one of metric, fps",
            None,
        ),
        (WALL + SOURCE.replace("metric", "SI"), "line 6: source.rig.units", "must be one of metric, fps", "'SI'"),
        (
            WALL + SOURCE.replace("tcp", "udp"),
            "line 5: source.rig.address",
            "must be tcp://HOST:PORT, listen://HOST:PORT, serial:///DEVICE?baud=N, file:///PATH?speed=",
            "'udp://127.0.0.1:9872'",
        ),
        (WALL + SOURCE + "speed = 3\n", "line 7: source.rig.speed", "must be one of address, silence, nulls", None),
        (
            WALL + SOURCE + 'items = { bit_depth = "108" }\n',
            "line 7: source.rig.items.bit_depth.item",
            "must be four digits RRII, 01 to 99 each",
            "'108'",
        ),
        (
            WALL + SOURCE + 'items = { depth = "0108" }\n',
            "line 7: source.rig.items.depth",
            "not known; did you mean bit_depth?",
            None,
        ),
        (
            WALL + SOURCE + 'items = { bit_depth = { item = "0108", unit = "fathom" } }\n',
            "line 7: source.rig.items.bit_depth.unit",
            "must be a unit of length, such as m, mm, ft or in",
            "'fathom'",
        ),
        (
            WALL + SOURCE + CALIPER,
            "line 7: source.rig.caliper.toolface",
            "must be given: a list of items, one for each triple",
            None,
        ),
        (
            WALL + SOURCE + CALIPER + 'toolface = ["5010", "5013"]\nradius = ["5011", "5012", "5014"]\n',
            "line 7: source.rig.caliper",
            "toolface, radius and depth must have equally many items, not {'toolface': 2, 'radius': 3}",
            None,
        ),
        (
            WALL + SOURCE + CALIPER + 'toolface = ["5010"]\nradius = ["5011", "5012"]\n',
            "line 7: source.rig.caliper.toolface_offset",
            "several radii have one toolface: must be a list with the angle of each sensor, such as [0, 90, 180, 270]",
            "0.0",
        ),
        (
            WALL
            + SOURCE
            + CALIPER
            + 'toolface = ["5010"]\nradius = ["5011", "5012"]\ntoolface_offset = [0, 90, 180]\n',
            "line 10: source.rig.caliper.toolface_offset",
            "must be a number, or a list of 2",
            "[0.0, 90.0, 180.0]",
        ),
        (
            WALL + SOURCE + CALIPER + 'toolface = ["5010"]\nradius = ["5011"]\ntoolface_offset = ["x"]\n',
            "line 10: source.rig.caliper.toolface_offset",
            "must be a number from -360 to 360, or a list of such numbers",
            "['x']",
        ),
        (
            WALL + SOURCE + CALIPER + 'toolface = ["5010"]\nradius = ["50x1"]\n',
            "line 9: source.rig.caliper.radius",
            "must be a list of items of four digits RRII, 01 to 99 each",
            "['50x1']",
        ),
        (
            WALL + SOURCE + CALIPER + 'first = "5010"\ngroups = 31\n',
            "line 9: source.rig.caliper.groups",
            "items 5010 and 92 more must not pass item 99",
            "31",
        ),
        (
            WALL + SOURCE + CALIPER + 'first = "5010"\ngroups = 3\norder = ["radius"]\n',
            "line 10: source.rig.caliper.order",
            'must name "toolface" and "radius" once each, "depth" at most once, and nothing else',
            "['radius']",
        ),
        (
            WALL + SOURCE + CALIPER + 'toolface = ["5010"]\nradius = ["5011"]\n',
            "line 7: source.rig.caliper",
            "has no depth items, and no source maps bit_depth",
            None,
        ),
        (
            WALL + SOURCE + IMAGE,
            "line 7: source.rig.image.GR.origin",
            "is missing; it must be one of centre, edge",
            None,
        ),
        (
            WALL + SOURCE + IMAGE + 'origin = "center"\n',
            "line 11: source.rig.image.GR.origin",
            "must be one of centre, edge",
            "'center'",
        ),
        (
            WALL + SOURCE + IMAGE + 'origin = "edge"\n',
            "line 7: source.rig.image.GR.reference",
            "is missing; it must be one of high-side, north",
            None,
        ),
        (
            WALL + SOURCE + IMAGE + 'origin = "edge"\nreference = "north"\n',
            "line 12: source.rig.image.GR.reference",
            'must be the path\'s reference, "high-side": live images are not converted to it',
            "'north'",
        ),
        (
            WALL + SOURCE + IMAGE.replace("count = 4", "count = 0") + 'origin = "edge"\nreference = "high-side"\n',
            "line 9: source.rig.image.GR.count",
            "must lie in 1 to 99",
            "0",
        ),
        (
            WALL + SOURCE + IMAGE + 'origin = "edge"\nreference = "high-side"\n',
            "line 7: source.rig.image.GR",
            "has no depth item, and no source maps bit_depth",
            None,
        ),
        (
            WALL
            + SOURCE
            + 'items = { bit_depth = "0108" }\n'
            + SOURCE.replace("rig", "b")
            + 'items = { bit_depth = "0108" }\n',
            "line 11: source.b.items.bit_depth",
            "is mapped by source.rig already",
            None,
        ),
        (WALL + SOURCE + 'nulls = ["x"]\n', "line 7: source.rig.nulls 1", "must be a number", "'x'"),
        (WALL + SOURCE + "line_limit = 3\n", "line 7: source.rig.line_limit", "must lie in 16 to 16777216 bytes", "3"),
        (WALL + SOURCE + "every = 0\n", "line 7: source.rig.every", "must lie in 0.05 to 3600 s", "0"),
        (
            WALL + SOURCE + '[layers]\nPasses = ["ream"]\n',
            "line 8: layers.Passes",
            "must differ from the tables of the snapshot: passes, events, survey, image-*",
            "['ream']",
        ),
        (
            WALL + SOURCE + '[layers]\nimage-GR = ["ream"]\n',
            "line 8: layers.image-GR",
            "must differ from the tables of the snapshot: passes, events, survey, image-*",
            "['ream']",
        ),
        (
            WALL + SOURCE + '[layers]\n"a\\u0000" = ["ream"]\n',
            "line 8: layers.a\x00",
            "its name must be printable and at most 200 bytes, because files are named after it",
            "['ream']",
        ),
        (
            WALL + SOURCE + IMAGE.replace("GR", '"G\\u0000"') + 'origin = "edge"\nreference = "high-side"\n',
            "line 7: source.rig.image.'G\\x00'",
            "its name must be printable and at most 200 bytes, because files are named after it",
            None,
        ),
        (
            WALL + SOURCE + '[layers]\na = ["swim"]\n',
            "line 8: layers.a",
            'must be one of drill, ream, rescan, trip, unknown, or "pass N" for the pass number N',
            "'swim'",
        ),
        (WALL + SOURCE + "[path]\nhead = [1]\n", "line 8: path.head", "must be a list of 3", "[1]"),
        (WALL + SOURCE + "[path]\nstations = [[1, 2]]\n", "line 8: path.stations 1", "must be a list of 3", "[1, 2]"),
        (
            WALL + SOURCE + "[passes]\nmax_depth_gap = -1\n",
            "line 8: passes.max_depth_gap",
            "must lie in 0.001 to 3600 s",
            "-1",
        ),
        (WALL + SOURCE + "[other]\n", "line 7: other", "must be one of wall, path, source", None),
        ("wall = 3", "line 1: wall", "must be a table", "3"),
        (WALL + SOURCE + "items = { bit_depth = 0108 }\n", "line 7", 'an item must be in quotes: "0108"', "0108"),
        (
            WALL + SOURCE + "items = { bit_depth = 1108 }\n",
            "line 7: source.rig.items.bit_depth.item",
            "must be text",
            "1108",
        ),
        (WALL + SOURCE + "silense = 60\n", "line 7: source.rig.silense", "not known; did you mean silence?", None),
        ("source = 3\n" + WALL, "line 1: source", "must be a table", "3"),
        (WALL + SOURCE + "image = 3\n", "line 7: source.rig.image", "must be a table", "3"),
    ],
)
def test_what_is_wrong_is_named(text, place, rule, value):
    with pytest.raises(InputError) as raised:
        parse(text)
    error = raised.value
    assert (error.place.removeprefix("configuration").lstrip(",: "), error.value) == (place, value)
    assert rule in error.rule


def test_a_file_is_named_in_its_errors(tmp_path, golden):
    file = tmp_path / "rig.toml"
    file.write_text("[wall\n")
    with pytest.raises(ValueError, match=r"rig\.toml: not TOML: "):
        load(file)
    file.write_bytes("# Größe\n".encode("latin-1") + (WALL + SOURCE).encode())
    with golden.raises():
        load(file)
    file.write_text(WALL + SOURCE)
    assert load(file).sources["rig"].table.mode == "listen"


def test_a_file_may_begin_with_a_byte_order_mark(tmp_path):
    file = tmp_path / "rig.toml"
    file.write_text(WALL + SOURCE, encoding="utf-8-sig")
    assert load(file).text == WALL + SOURCE


def test_every_setting_of_the_page_is_read():
    page = (ROOT / "docs/live.md").read_text()
    text, values, store, broker, server = re.findall(r"```toml\n(.*?)```", page, re.DOTALL)
    polled = parse(WALL + store).sources["store"]
    assert (len(polled.caliper.radius), len(polled.images[0].sectors), polled.address.port) == (2, 4, 443)
    assert list(parse(WALL + values).sources["rig"].rig) == ["bit_depth", "hole_depth", "rotation"]
    sent = parse(WALL + broker).sources["broker"]
    assert (sent.address.kind, len(sent.caliper.depth), list(sent.rig)) == ("mqtts", 1, ["bit_depth", "rotation"])
    streamed = parse(WALL + server).sources["server"]
    assert (streamed.address.kind, streamed.table.index, list(streamed.rig)) == (
        "wss",
        "depth",
        ["bit_depth", "rotation"],
    )
    c = parse(text)
    assert set(c.sources) == {"rig", "mwd"}
    assert len(c.sources["mwd"].caliper.radius) == 30
    assert set(c.layers) == {"main", "ream", "again"}


BROKER = (
    '[source.rig]\naddress = "mqtt://127.0.0.1:1883"\nunits = "metric"\nclient = "well-7"\ntopics = ["rig7/#"]\n'
    'caliper = { toolface = ["tf"], radius = ["rad"], depth = ["md"] }\n'
)
CHANNELS = (
    '[source.rig]\naddress = "ws://127.0.0.1:1883"\nordered_by = "depth"\nuris = ["eml:///c"]\n'
    'caliper = { toolface = ["TF"], radius = ["RAD"] }\n'
)


@pytest.mark.parametrize(
    ("source", "old", "new", "place"),
    [
        (BROKER, "127.0.0.1", "u:secret@h", "address"),
        (BROKER, "127.0.0.1:1883", "", "address"),
        (BROKER, '127.0.0.1:1883"', 'far:1883"\nuser = "u"\npassword_env = "P"', "address"),
        (BROKER, 'topics = ["rig7/#"]', "topics = []", "topics"),
        (BROKER, 'client = "well-7"\n', "", "client"),
        (BROKER, 'units = "metric"\n', "", "units"),
        (BROKER, "units", 'user = "u"\nunits', ""),
        (CHANNELS, "127.0.0.1", "u:secret@h", "address"),
        (CHANNELS, "127.0.0.1:1883", "", "address"),
        (CHANNELS, "1883", "1/?token=secret", "address"),
        (CHANNELS, '127.0.0.1:1883"', 'far:1"\ntoken_env = "T"', "address"),
        (CHANNELS, "uris = [", "uris = []\nothers = [", "others"),
        (CHANNELS, 'ordered_by = "depth"\n', "", "ordered_by"),
        (CHANNELS, "uris", 'user = "u"\nuris', ""),
    ],
)
def test_a_wrong_setting_of_a_broker_or_an_etp_server_has_its_place(source, old, new, place):
    parse(WALL + source)
    found, rule, value = refused(WALL + source.replace(old, new, 1))
    assert found == f"source.rig.{place}".rstrip(".")
    assert "secret" not in f"{rule} {value}"
