"""A WITSML store polled over HTTPS: it grows, it fails in every way, and the journal has the bits."""

from __future__ import annotations

import base64
import datetime
import html
import json
import logging
import os
import re
import threading
import tracemalloc
import urllib.parse

import numpy as np
import pytest
from live_servers import Running, payloads, until
from live_wires import Clock
from small_store import LOG, LONG_AGO, Store, enveloped

import helibore as hb
from helibore.live import server as server_module
from helibore.live.model import store_reader
from helibore.live.rules.configuration import parse
from helibore.live.wire import witsml
from helibore.live.wire.redaction import Redactor
from helibore.live.wire.transport import Link

pytest.importorskip("httpx2", reason="WITSML stores need httpx2")

CONFIGURATION = """
[wall]
bit_diameter = 0.216
start_depth = 100.0
sectors = 16
threads = 1
[source.store]
address = "URL"
ca = "CA"
every = 0.05
timeout = 60.0
answer_mb = 1
items = { bit_depth = "DBTM" }
log = { well = "w", wellbore = "b", log = "l<1>", index = "depth" }
trajectory = { well = "w", wellbore = "b", trajectory = "t" }
caliper = { toolface = ["TF"], radius = ["RAD"] }
image.GR = { sectors = ["GR1", "GR2"], unit = "gAPI", origin = "edge", reference = "high-side" }
"""


def grown(count, first=0):
    return [
        f"{100 + 0.01 * i:.2f},{i * 37 % 360},{110 + i % 5},{i},{2 * i},{120 + i}" for i in range(first, first + count)
    ]


class Polled(Running):
    """A live wall that polls ``store``."""

    def __init__(self, store, folder, change=lambda text: text):
        super().__init__(change(CONFIGURATION.replace("URL", store.url).replace("CA", str(store.ca))), folder)


def with_user(text):
    return text.replace("every", 'user = "rig7"\npassword_env = "STORE_PASSWORD"\nevery')


@pytest.fixture
def store(tmp_path):
    with Store(tmp_path) as made:
        yield made


@pytest.fixture(autouse=True)
def _soon(monkeypatch):
    monkeypatch.setattr(server_module, "FIRST_WAIT", 0.02)
    monkeypatch.setattr("helibore.live.kinds.witsml_stores.WitsmlStores.longest_wait", 0.05)


def test_a_store_is_connected_once_it_answers(store, tmp_path):
    """An alarm `lost` begins while the store cannot be reached, also between two tries."""
    server, seen = Polled(store, tmp_path / "j").server, []

    class Tried(Link):
        peer = "https://store"

        def read(self, _):
            seen.append(server.states["store"])
            if len(seen) > 1:
                raise OSError("the store is down")
            return b"WITSML log same 0\n"

    server._used = server.live.configuration.sources
    with pytest.raises(OSError, match="down"):
        server._read(server.live.configuration.sources["store"], Tried(), 1)
    assert seen == ["connecting", "connected to https://store"]
    server.live.close()


def test_a_growing_log_and_trajectory_become_wall_path_and_image_and_replay_has_the_bits(store, tmp_path):
    store.rows, store.stations = grown(300), [(0.0, 0.0, 0.0), (90.0, 2.0, 30.0)]
    with Polled(store, tmp_path / "j") as polled:
        until(lambda: polled.live.wall.sample_count == 300 and polled.live.path is not None)
        store.rows += grown(200, 300)
        store.stations.append((130.0, 4.0, 31.0))
        until(lambda: polled.live.wall.sample_count == 500 and len(polled.live.survey) == 3)
        live = polled.live
    rows = np.array([[float(cell) for cell in row.split(",")] for row in store.rows])
    np.testing.assert_allclose(live.survey.depth, [0.0, 90.0, 130.0], atol=1e-9)
    np.testing.assert_allclose(live.survey.inclination, [0.0, 2.0, 4.0], atol=1e-12)
    depth, values = live.images["GR"].arrays()
    assert np.array_equal(depth, rows[:, 0])
    assert np.array_equal(values, rows[:, 3:5])
    batch = hb.Wall(bit_diameter=0.216, start_depth=100.0, sectors=16)
    batch.append(rows[:, 0], rows[:, 1], rows[:, 2] * 0.001, np.repeat([0.0, 1.0], [300, 200]))
    assert np.array_equal(live.wall.radius, batch.radius, equal_nan=True)
    again = hb.Live.replay(tmp_path / "j")
    for name in ("radius", "nearest", "support", "depth"):
        assert np.array_equal(getattr(again.wall, name), getattr(live.wall, name), equal_nan=True)
    assert np.array_equal(again.images["GR"].arrays()[1], values)
    assert np.array_equal(again.survey.depth, live.survey.depth)


def test_polling_resumes_from_the_last_index_also_after_a_restart(store, tmp_path):
    store.rows, store.most = grown(250), 100
    with Polled(store, tmp_path / "j") as polled:
        until(lambda: polled.live.wall.sample_count == 250)
    asked = [q for q in store.questions if "<logs" in q]
    assert "<startIndex" not in asked[0]
    assert "returnElements=all" in asked[0]
    assert any('<startIndex uom="m">100.99</startIndex>' in q and "data-only" in q for q in asked)
    assert 'uid="l&lt;1&gt;"' in asked[0] or 'uid="l<1>"' in asked[0]
    store.questions.clear()
    store.rows += grown(10, 250)
    with Polled(store, tmp_path / "j") as polled:
        until(lambda: polled.live.wall.sample_count == 260)
    assert '<startIndex uom="m">102.49</startIndex>' in next(q for q in store.questions if "<logs" in q)


def test_an_answer_that_says_nothing_new_costs_the_journal_a_line(store, tmp_path):
    store.rows = grown(2)
    with Polled(store, tmp_path / "j") as polled:
        until(lambda: len(store.questions) > 20)
    received = polled.live.model.readers[1].total("bytes")
    assert received < 5 * len(enveloped(store.log(""))) + 40 * len(store.questions)


@pytest.mark.parametrize(
    ("trouble", "reported"),
    [
        ("500", "localhost: answered 500"),
        ("redirect", "localhost: answered 302"),
        ("cut", "the answer ended early, or is not HTTP"),
        ("slow", "the answer took longer than 0.5 s"),
        ("slow headers", "the answer took longer than 0.5 s"),
        ("huge", "an answer of more than 1 MB: refused"),
        ("compressed", "sent a compressed answer, which was not asked for"),
        ("error", "log: error -433"),
        ("entity", "<!DOCTYPE ...>: document types and entities are refused"),
        ("inner entity", "<!DOCTYPE ...>: document types and entities are refused"),
    ],
)
def test_trouble_is_told_and_what_comes_after_it_is_read(store, tmp_path, trouble, reported):
    store.rows, store.trouble = grown(50), [trouble] * 2
    short = "timeout = 0.5" if trouble.startswith("slow") else "timeout = 60.0"
    with Polled(store, tmp_path / "j", lambda text: text.replace("timeout = 60.0", short)) as polled:
        until(lambda: polled.live.wall.sample_count == 50)
        assert any(reported in line for line in polled.reported()), polled.reported()
    assert np.array_equal(hb.Live.replay(tmp_path / "j").wall.radius, polled.live.wall.radius, equal_nan=True)


def test_who_the_store_does_not_take_is_told_without_the_password(store, tmp_path, monkeypatch):
    store.rows, store.user = grown(5), "Basic cmlnNzpzZWNyZXQtNDc="  # rig7:secret-47
    monkeypatch.setenv("STORE_PASSWORD", "wrong-48")
    with Polled(store, tmp_path / "j", with_user) as polled:
        until(lambda: polled.server.states["store"] == "stopped: access denied")
    assert polled.count("access", "store") == 1  # asked once: another wrong password could lock the account
    assert len(store.questions) == 1
    assert any("answered 401" in line for line in polled.reported())
    monkeypatch.setenv("STORE_PASSWORD", "secret-47")
    with Polled(store, tmp_path / "j", with_user) as again:
        until(lambda: again.live.wall.sample_count == 5)
    stored = b"".join(path.read_bytes() for path in (tmp_path / "j").iterdir())
    for secret in ("wrong-48", "secret-47", "cmlnNzp", "d3Jvbmct"):
        assert secret.encode() not in stored
        assert not any(secret in line for line in [*polled.reported(), *again.reported()])
        assert secret not in repr(again.live.configuration)


@pytest.mark.parametrize("what", ["an authority nobody knows", "a certificate that has expired", "another host's name"])
def test_a_certificate_that_cannot_be_trusted_is_refused(tmp_path, what):
    (tmp_path / "other").mkdir()
    with Store(tmp_path, LONG_AGO if "expired" in what else None) as store, Store(tmp_path / "other") as other:
        store.rows = grown(5)
        if "nobody" in what:
            store.ca = other.ca
        if "name" in what:
            store.url = store.url.replace("localhost", "127.0.0.1")
        with Polled(store, tmp_path / "j") as polled:
            until(lambda: any("CERTIFICATE_VERIFY_FAILED" in line for line in polled.reported()))
            assert polled.live.wall.sample_count == 0
        assert not store.questions, "nothing was sent, no password either"


def test_cells_and_units_that_are_wrong_cost_their_rows_and_are_told(store, tmp_path):
    store.rows = grown(10)
    store.rows[2] = "100.02,nan,110,1,1,100"
    store.rows[3] = "100.03,10,-999.25,1,1,100"
    store.rows[4] = "100.04,,,1,1,100"
    store.rows[5] = "1e2_0,10,110,1,1,100"
    store.units = store.units.replace("mm", "in")
    store.rows = [row.replace(",11", ",4.3") for row in store.rows]
    with Polled(store, tmp_path / "j") as polled:
        until(lambda: polled.live.model.counts["drawn"] == 6)
        counts = polled.live.model.counts
        assert (counts["flag INVALID"], counts["flag NULL"], counts["received"]) == (1, 1, 8)
        lines = "\n".join(polled.reported())
    assert "curve TF = 'nan': is not a number" in lines
    assert "index '1e2_0': is not a depth: the row was not read" in lines


def test_a_curve_without_a_length_is_told_once_and_never_drawn(store, tmp_path):
    store.rows, store.units = grown(3), store.units.replace("mm", "furlong")
    with Polled(store, tmp_path / "j") as polled:
        until(lambda: polled.live.model.counts["flag INVALID"] == 3)
        store.rows += grown(3, 3)
        until(lambda: polled.live.model.counts["flag INVALID"] == 6)
        assert sum("curve RAD: unit 'furlong': not known" in line for line in polled.reported()) == 1
        assert polled.live.model.counts["drawn"] == 0


def stored(folder):
    """(kind, state, body) of every answer in a journal."""
    frames, found = witsml.Frames(), []
    for payload in payloads(folder):
        found += frames.feed(payload)[0]
    return found


DEEP = "99999.00,10,110,1,1,100"


@pytest.mark.parametrize("place", ["first", "between", "last", "twice"])
def test_an_index_that_jumps_alone_hides_nothing_and_is_told(store, tmp_path, place):
    store.rows = grown(60)
    if place == "twice":
        store.rows += [DEEP, DEEP]
    else:
        store.rows.insert({"first": 0, "between": 30, "last": 60}[place], DEEP)
    with Polled(store, tmp_path / "j") as polled:
        until(lambda: polled.live.wall.sample_count == 60)
        store.rows = sorted(store.rows + grown(40, 60), key=lambda row: float(row.split(",")[0]))  # as stores do
        until(lambda: polled.live.wall.sample_count == 100)
        until(lambda: '<startIndex uom="m">100.99</startIndex>' in store.questions[-1] + store.questions[-2])
        jumps = [event for event in polled.live.model.events.latest if event.rule == "jump"]
    assert [event.count for event in jumps] == [1]
    far = "the first" if place == "first" else "99898.7 m after the last" if place == "between" else "99898.4 m after"
    assert f"index 99999.00: {far}" in jumps[0].text
    assert jumps[0].text.endswith(", and no row continues from it within 30 m: not read")
    assert polled.live.wall.depth[-1] < 101


def test_a_jump_that_goes_on_is_read_when_its_next_row_comes(store, tmp_path):
    store.rows = grown(20)
    with Polled(store, tmp_path / "j") as polled:
        until(lambda: polled.live.wall.sample_count == 20)
        store.rows += grown(1, 10_000)
        until(lambda: polled.count("jump", "store") == 1)
        assert polled.live.wall.sample_count == 20
        store.rows += grown(1, 10_001)
        until(lambda: polled.live.wall.sample_count == 22)
    again = hb.Live.replay(tmp_path / "j")
    assert np.array_equal(again.wall.radius, polled.live.wall.radius, equal_nan=True)


def test_the_unit_of_an_image_is_the_one_of_the_configuration_or_it_is_not_read(store, tmp_path):
    store.rows, store.units = grown(20), "m,dega,mm,GAPI,ohm.m,m"
    with Polled(store, tmp_path / "j") as polled:
        until(lambda: len(polled.live.images["GR"]) == 20)
        assert any("curve GR2: unit 'ohm.m': the configuration says 'gAPI': not read" in e for e in polled.reported())
    values = polled.live.images["GR"].arrays()[1]
    assert np.isnan(values[:, 1]).all()
    assert values[:, 0].tolist() == list(range(20))


def test_an_index_in_another_unit_is_the_same_depth_and_without_one_nothing_is_read(store, tmp_path):
    store.rows = grown(20)
    with Polled(store, tmp_path / "j") as polled:
        until(lambda: polled.live.wall.sample_count == 20)
        store.units = store.units.replace("m,", "furlong,", 1)
        store.rows += grown(5, 20)
        until(lambda: any("curve DEPT: unit 'furlong'" in line for line in polled.reported()))
        assert polled.live.wall.sample_count == 20
        store.behind = lambda _: store.rows
        store.rows = [f"{float(row.split(',')[0]) / 0.3048:.6f},{row.partition(',')[2]}" for row in grown(25)]
        store.units = store.units.replace("furlong", "ft")
        until(lambda: polled.live.wall.samples.depth.max() > 100.239)
    depth = np.sort(polled.live.wall.samples.depth)
    np.testing.assert_allclose(np.unique(np.round(depth, 4)), 100 + 0.01 * np.arange(25), atol=1e-4)


@pytest.mark.parametrize("trouble", ["500", "huge", "compressed", "redirect"])
def test_what_is_refused_is_in_the_journal_once_and_at_a_replay(store, tmp_path, trouble):
    store.rows, store.trouble = grown(50), [trouble] * 3
    with Polled(store, tmp_path / "j") as polled:
        until(lambda: polled.live.wall.sample_count == 50)
    refused = [body for _, state, body in stored(tmp_path / "j") if state == "refused"]
    whole = enveloped(store.log(""))
    expected = {"500": b"broken", "huge": (whole + b" " * (2 << 20))[: 1 << 20], "compressed": whole, "redirect": b""}
    assert refused == [expected[trouble], b"", b""]
    again = hb.Live.replay(tmp_path / "j")
    assert again.model.events.counts["store", "refused"] == 3
    assert again.wall.sample_count == 50


def test_an_error_page_that_repeats_the_password_is_stored_without_it(store, tmp_path, monkeypatch):
    monkeypatch.setenv("STORE_PASSWORD", "secret&47")
    token = "cmlnNzpzZWNyZXQmNDc="
    store.page = f"who is rig7 with secret&47, secret&amp;47, Basic {token}?".encode()
    store.rows, store.trouble = grown(5), ["500"]
    with Polled(store, tmp_path / "j", with_user) as polled:
        until(lambda: polled.live.wall.sample_count == 5)
    (refused,) = [body for _, state, body in stored(tmp_path / "j") if state == "refused"]
    assert refused == f"who is rig7 with {'*' * 9}, {'*' * 13}, Basic {'*' * len(token)}?".encode()


@pytest.mark.parametrize(
    "written",
    ["a'b\"<&c d", "a'b\"&lt;&amp;c d", "a'b\"&lt;&amp;c d".replace("'", "&apos;").replace('"', "&quot;"),
     "a&#x27;b&quot;&lt;&amp;c d", "a&#39;b&#34;&lt;&amp;c d", "a%27b%22%3C%26c%20d", "a%27b%22%3C%26c+d",
     "cmlnNzphJ2IiPCZjIGQ="],
)  # fmt: skip
def test_a_password_is_blotted_out_as_it_may_be_written_and_where_it_is_cut(written):
    redactor = Redactor(("rig7", "a'b\"<&c d"))
    page = f"<p>{written}</p>{written}".encode()
    stars = "*" * len(written)
    assert redactor.clean(page, cut=True) == f"<p>{stars}</p>{stars}".encode()
    for cut in range(1, len(written)):
        assert redactor.clean(b"<p>" + written[:cut].encode(), cut=True) == b"<p>" + b"*" * cut


PASSWORD = "pä&s<\"w' rd-47"


def written_in_twenty_ways():
    """A page for each way a server can send credentials back, with markers around it."""
    escaped = html.escape(PASSWORD)
    basic = base64.b64encode(f"rig7:{PASSWORD}".encode()).decode()
    percent = urllib.parse.quote(PASSWORD)
    in_json = json.dumps(PASSWORD)
    texts = {
        "plain": PASSWORD,
        "XML": html.escape(PASSWORD, quote=False),
        "HTML": escaped,
        "XML twice": html.escape(escaped),
        "XML thrice": html.escape(html.escape(escaped)),
        "decimal": "".join(f"&#{ord(c)};" for c in PASSWORD),
        "hexadecimal": "".join(f"&#x{ord(c):X};" for c in PASSWORD),
        "padded": "".join(f"&#x00{ord(c):x};" for c in PASSWORD),
        "percent": percent,
        "form": urllib.parse.quote_plus(PASSWORD),
        "percent twice": urllib.parse.quote(percent),
        "JSON": in_json,
        "JSON of HTML": in_json.replace("&", "\\u0026").replace("<", "\\u003c").replace("'", "\\u0027"),
        "JSON twice": json.dumps(in_json),
        "JavaScript": PASSWORD.replace("&", "\\x26").replace("<", "\\x3c"),
        "CDATA": f"<![CDATA[{PASSWORD[:5]}]]>{html.escape(PASSWORD[5:])}",
        "CDATA twice": f"<![CDATA[{PASSWORD[:7]}]]><![CDATA[{PASSWORD[7:]}]]>",
        "Python": repr(PASSWORD.encode())[2:-1],
        "JSON in XML": html.escape(in_json),
        "JSON twice in XML": html.escape(json.dumps(in_json)),
        "UTF-8 read as Latin-1": PASSWORD.encode().decode("latin-1"),
        "UTF-8 read as Windows-1252, in XML": html.escape(PASSWORD.encode().decode("cp1252")),
        "Basic": f"Basic {basic}",
        "Basic in an address": urllib.parse.quote(basic, safe=""),
        "base64": base64.b64encode(PASSWORD.encode()).decode(),
        "Basic over two lines": f"{basic[:9]}\r\n{basic[9:]}",
    }
    pages = {name: f"<<{text}>>".encode() for name, text in texts.items()}
    for encoding in ("latin-1", "utf-16-le", "utf-16-be", "utf-16", "utf-32-le"):
        pages[encoding] = f"<<{PASSWORD}>>".encode(encoding)
    return pages


@pytest.mark.parametrize("way", written_in_twenty_ways())
def test_no_way_to_write_a_password_passes(way):
    page = written_in_twenty_ways()[way]
    clean = Redactor(("rig7", PASSWORD)).clean(page)
    left = (
        clean.replace(b"&quot;", b"")
        .replace(b"\0", b"")
        .replace(b"\xff\xfe", b"")
        .replace(b'"', b"")
        .replace(b"\\", b"")
    )
    assert re.fullmatch(rb"<<(Basic |<!\[CDATA\[)?\*+(\]\]>)?>>", left), clean
    assert len(clean) == len(page)


@pytest.mark.parametrize(
    "body",
    [enveloped("", -1, f"wrong: {html.escape(PASSWORD)}"), enveloped(html.escape(f"<x>{PASSWORD}</x>")),
     f"<s:Envelope xmlns:s='x'><faultstring>{html.escape(PASSWORD)}</faultstring></s:Envelope>".encode(),
     f"<Result>{html.escape(PASSWORD)}</Result>".encode(), PASSWORD.encode("utf-16")],
)  # fmt: skip
def test_no_answer_brings_a_password_to_journal_event_or_log(store, tmp_path, monkeypatch, body, caplog):
    monkeypatch.setenv("STORE_PASSWORD", PASSWORD)
    caplog.set_level(logging.DEBUG)
    store.rows, store.bodies = grown(5), [body] * 2
    with Polled(store, tmp_path / "j", with_user) as polled:
        until(lambda: polled.live.wall.sample_count == 5)
    kept = b"".join(path.read_bytes() for path in (tmp_path / "j").iterdir())
    texts = "".join(
        [*polled.reported(), caplog.text, *(str(e) for e in hb.Live.replay(tmp_path / "j").model.events.latest)]
    )
    assert not [record for record in caplog.records if record.name.startswith("http")]  # they log what is sent back
    for part in (PASSWORD, html.escape(PASSWORD), html.escape(html.escape(PASSWORD)), "rd-47"):
        assert part.encode() not in kept
        assert part.encode("utf-16-le") not in kept
        assert part not in texts


def test_a_password_that_could_be_data_is_refused_at_the_start(store, tmp_path, monkeypatch, golden):
    monkeypatch.setenv("STORE_PASSWORD", "110.25")
    polled = Polled(store, tmp_path / "j", with_user)
    with (
        polled.live,
        golden.raises(),
    ):
        polled.server.start()


def test_a_password_within_its_own_other_forms_leaves_none_of_them():
    assert Redactor(("rig7", "a&b")).clean(b"a&amp;b a&b.") == b"******* ***."
    assert Redactor(("rig7", "amp;")).clean(b"amp;amp;.") == b"********."
    assert Redactor(None).clean(b"rig7") == b"rig7"


@pytest.mark.parametrize("filler", ["\0", "\\", "p\\", "p&", "%25", "p<![CDATA["])
def test_a_long_answer_is_cleaned_in_one_pass(filler):
    """Each of these would take hours if the time grew with the square of the length."""
    body = (b"p" + filler.encode() * 300_000)[:300_000]
    redactor = Redactor(("rig7", PASSWORD))
    assert redactor.clean(body) == body
    assert redactor.clean(body + PASSWORD.encode()) == body + b"*" * len(PASSWORD.encode())


def test_rows_that_jump_are_looked_at_once_however_many():
    class Rows(list):
        looked = 0

        def __reversed__(self):
            for key in super().__reversed__():
                self.looked += 1
                yield key

        def __getitem__(self, place):
            raise AssertionError("rows are copied or looked at again")

    keys = Rows([None, 1.0, None, None, 3.0, 2.0, None] * 1000)
    after = store_reader._following(keys)
    assert keys.looked == 7000
    assert after[:7] == [1.0, 3.0, 3.0, 3.0, 2.0, 1.0, 1.0]
    assert after[-3:] == [2.0, None, None]


def test_the_null_value_of_a_log_holds_when_the_depth_limits_change():
    """A store states its null value in the first answer of a link only, and new limits make no new link."""
    text = CONFIGURATION.replace("URL", "https://store.example/witsml").replace('ca = "CA"\n', "")
    lists = "<mnemonicList>DEPT,TF,RAD</mnemonicList><unitList>m,dega,mm</unitList>"
    live = hb.Live(parse(text))
    rows = ["100.00,10,110", "100.05,20,110", "100.10,-77,110"]
    for header, part in (("<nullValue>-77</nullValue>", rows[:2]), ("", rows[1:])):
        data = "".join(f"<data>{row}</data>" for row in part)
        document = LOG.replace("HEADER", header).replace("ROWS", lists + data)
        live.receive("store", witsml.framed("log", "whole", enveloped(document)))
        live.reconfigure(parse(text + "[depth]\njump = 50.0\n"))
    assert (live.wall.sample_count, live.model.counts["flag NULL"]) == (2, 1)


def log_answer(rows, mnemonics, units):
    lists = f"<mnemonicList>{mnemonics}</mnemonicList><unitList>{units}</unitList>"
    document = LOG.replace("HEADER", "").replace("ROWS", lists + "".join(f"<data>{row}</data>" for row in rows))
    return witsml.framed("log", "whole", enveloped(document))


@pytest.mark.parametrize(
    ("index", "change"),
    [
        ("time", ('log = "l<1>", index = "time"', 'log = "l<1>", index = "depth"')),
        ("depth", ('log = "l<1>"', 'log = "l<2>"')),
    ],
)
def test_another_log_is_read_from_its_first_row(index, change):
    """The last index of the old log says nothing of the new one: a time is later than every depth."""
    text = CONFIGURATION.replace("URL", "https://store.example/witsml").replace('ca = "CA"\n', "")
    text = text.replace('index = "depth"', f'index = "{index}"')
    live = hb.Live(parse(text))
    at = [f"2024-05-01T10:00:{i:02d}Z" if index == "time" else f"{110 + i / 10:.2f}" for i in range(5)]
    rows = [f"{one},{i * 30},110,{110 + i / 10:.2f}" for i, one in enumerate(at)]
    live.receive("store", log_answer(rows, "INDEX,TF,RAD,DBTM", f"{'s' if index == 'time' else 'm'},dega,mm,m"))
    assert (live.wall.sample_count, live.model.readers[1].last[0]) == (5, at[-1])
    live.reconfigure(parse(text.replace(*change)))
    assert live.model.readers[1].last is None
    rows = [f"{101 + i / 10:.2f},{i * 30},110" for i in range(7)]
    assert live.receive("store", log_answer(rows, "DEPT,TF,RAD", "m,dega,mm")).events == []
    assert live.wall.sample_count == 12


def test_another_curve_is_not_compared_with_the_depth_that_the_old_curve_had():
    text = CONFIGURATION.replace("URL", "https://store.example/witsml").replace('ca = "CA"\n', "")
    text = text.replace('index = "depth"', 'index = "time"')
    live = hb.Live(parse(text))
    for second in (0, 2):
        rows = [f"2024-05-01T10:00:{second + i:02d}Z,500,900" for i in range(2)]
        assert live.receive("store", log_answer(rows, "T,DBTM,BITDEP", "s,m,m")).events == []
        live.reconfigure(parse(text.replace("DBTM", "BITDEP")))
    assert live.model.rig.tracks["bit_depth"].value.tolist() == [500.0, 500.0, 900.0, 900.0]


def test_an_empty_list_of_units_or_mnemonics_is_read_from_the_description_of_the_curves():
    curves = "".join(
        f"<logCurveInfo><mnemonic>{name}</mnemonic><unit>{unit}</unit></logCurveInfo>"
        for name, unit in (("A", "m"), ("B", "ft"))
    )
    for lists in ("<mnemonicList>A,B</mnemonicList><unitList/>", "<mnemonicList/><unitList></unitList>"):
        log = witsml.read_log(f"<logs><log>{curves}<logData>{lists}<data>1,2</data></logData></log></logs>")
        assert (log.mnemonics, log.units) == (["A", "B"], ["m", "ft"])


def test_curves_of_witsml_1_3_1_1_are_in_the_columns_that_they_state():
    curves = "".join(
        f"<logCurveInfo><mnemonic>{name}</mnemonic><unit>{unit}</unit><columnIndex>{column}</columnIndex></logCurveInfo>"
        for name, unit, column in (("B", "ft", 10), ("C", "deg", 2), ("A", "m", 1))
    )
    log = witsml.read_log(f"<logs><log>{curves}<logData><data>1,2,3</data></logData></log></logs>")
    assert (log.mnemonics, log.units) == (["A", "C", "B"], ["m", "deg", "ft"])
    stated = f"<logs><log>{curves}<logData><mnemonicList>B,A</mnemonicList><data>1,2</data></logData></log></logs>"
    assert witsml.read_log(stated).mnemonics == ["B", "A"]


def test_an_answer_is_stored_before_anything_looks_into_it(store, tmp_path, monkeypatch):
    store.rows, seen = grown(5), []
    real = witsml.read_answer

    def read_answer(body):
        seen.append(any(body == answer for _, _, answer in stored(tmp_path / "j")))
        return real(body)

    monkeypatch.setattr(witsml, "read_answer", read_answer)
    with Polled(store, tmp_path / "j") as polled:
        until(lambda: polled.live.wall.sample_count == 5 and len(seen) > 5)
    assert all(seen)


def test_a_parsed_answer_takes_a_small_multiple_of_its_size():
    rows = "".join(f"<data>{100 + 0.01 * i:.2f},{i % 360},110.25,60.5,61.5,100.00</data>" for i in range(30_000))
    document = f"<logs><log><logData><mnemonicList>A,B,C,D,E,F</mnemonicList>{rows}</logData></log></logs>"
    tracemalloc.start()
    try:
        log = witsml.read_log(document)
        _, peak = tracemalloc.get_traced_memory()
    finally:
        tracemalloc.stop()
    assert len(log.rows) == 30_000
    assert peak < 4 * len(document)


def test_a_time_log_places_its_rows_by_their_own_bit_depth(store, tmp_path):
    store.rows = [
        f"2024-05-01T10:00:{i:02d}Z,{i * 37 % 360},110,1,1,{110 + 0.1 * i:.1f}" for i in range(20)
    ]  # fmt: skip
    store.behind = lambda _: store.rows  # it sends everything again: rows that are there are not read twice
    timed = lambda text: text.replace('index = "depth"', 'index = "time"').replace(  # noqa: E731
        'radius = ["RAD"]', 'radius = ["RAD"], offset = 10.0'
    )
    with Polled(store, tmp_path / "j", timed) as polled:
        until(lambda: polled.live.wall.sample_count == 20)
        until(lambda: any("<startDateTimeIndex>2024-05-01T10:00:19Z<" in q for q in store.questions))
    assert polled.live.wall.sample_count == 20
    assert polled.live.wall.depth[-1] == pytest.approx(101.9, abs=0.11)


@pytest.mark.parametrize(
    "change",
    [
        ("https://localhost:1/x", "HTTPS://"),
        ("https:", "http:"),
        ("/x", "/x?password=pw"),
        ("https://", "https://rig:pw@"),
        ("every", 'password = "pw"\nevery'),
        ("every", 'user = "rig"\nevery'),
        ('index = "depth"', 'index = "date"'),
        ('["RAD"]', "[]"),
        ("every", 'units = "metric"\nevery'),
        ('bit_depth = "DBTM"', 'bit_depth = "TF"'),
    ],
)
def test_a_wrong_configuration_never_starts(change, golden):
    text = CONFIGURATION.replace("URL", "https://localhost:1/x").replace(*change)
    with pytest.raises(ValueError) as error:  # noqa: PT011 (the text is compared below)
        parse(text)
    golden(str(error.value))
    assert "pw" not in str(error.value).replace("password", "")


def test_a_password_that_is_not_set_is_an_error_at_the_start(store, tmp_path, monkeypatch, golden):
    monkeypatch.delenv("NO_SUCH", raising=False)
    polled = Polled(store, tmp_path, lambda text: text.replace("every", 'user = "u"\npassword_env = "NO_SUCH"\nevery'))
    with polled.live, golden.raises():
        polled.server.start()


def test_a_password_of_other_bytes_than_utf_8_is_an_error_without_the_password(store, tmp_path, monkeypatch, golden):
    monkeypatch.setitem(os.environb, b"STORE_PASSWORD", "geheimwört".encode("latin-1"))
    polled = Polled(store, tmp_path, with_user)
    with polled.live, pytest.raises(ValueError) as error:  # noqa: PT011 (the text is compared whole below)
        polled.server.start()
    golden(str(error.value))


def test_answers_come_out_of_the_journal_as_they_went_in_however_cut_and_damage_costs_its_own():
    parts = [("log", "whole", b"a" * 100), ("trajectory", "same", b""), ("log", "cut", b"WITSML log whole 9\n")]
    stream = b"".join(witsml.framed(*part) for part in parts) * 3
    for step in (1, 7, 1000):
        frames, found = witsml.Frames(), []
        for start in range(0, len(stream), step):
            answers, stray = frames.feed(stream[start : start + step])
            assert stray == 0
            found += answers
        assert found == parts * 3
    answers, stray = witsml.Frames().feed(b"noise" * 20 + stream)
    assert (stray, answers) == (100, parts * 3)


def test_a_store_that_asks_to_wait_is_left_alone(store, tmp_path):
    store.rows, store.trouble = grown(50), ["429"] * 1000
    with Polled(store, tmp_path / "j") as polled:
        until(lambda: "waiting" in polled.server.states["store"])
        threading.Event().wait(1.0)
        assert len(store.questions) == 1
        assert any("asked to wait for 3600 s" in line for line in polled.reported())
        assert "answered 429" in polled.server.states["store"]


@pytest.mark.parametrize("trouble", ["500", "compressed", "huge", "redirect", "error"])
def test_a_refused_answer_is_asked_for_once_in_each_wait(store, tmp_path, monkeypatch, trouble):
    waits = []
    monkeypatch.setattr(server_module, "back_off", lambda failures, _: waits.append(failures) or 0.01)
    store.rows, store.trouble = grown(50), [trouble] * 1000
    with Polled(store, tmp_path / "j") as polled:
        until(lambda: len(waits) >= 5)
        assert trouble == "error" or not polled.server.states["store"].startswith("connected")
    assert waits == list(range(1, len(waits) + 1)), "each longer than the one before"
    assert len(store.questions) <= len(waits) + 1


def test_a_trajectory_that_always_fails_does_not_begin_the_waits_anew(store, tmp_path, monkeypatch):
    waits = []
    monkeypatch.setattr(server_module, "back_off", lambda failures, _: waits.append(failures) or 0.01)
    store.rows, store.trouble = grown(50), ["", "500"] * 1000
    with Polled(store, tmp_path / "j"):
        until(lambda: len(waits) >= 5)
    assert waits == list(range(1, len(waits) + 1))
    assert len(store.questions) <= 2 * len(waits) + 2  # of the last wait it may not have come to


def by_time(rows):
    names, units = ["TIME", "TF", "RAD", "DBTM"], ["s", "dega", "mm", "m"]
    lists = f"<mnemonicList>{','.join(names)}</mnemonicList><unitList>{','.join(units)}</unitList>"
    body = "".join(f"<data>{row}</data>" for row in rows)
    document = LOG.replace("HEADER", "<direction>increasing</direction>").replace("ROWS", lists + body)
    return witsml.framed("log", "whole", enveloped(document))


TIMED = (
    CONFIGURATION.replace('"URL"', '"https://store.example"')
    .replace('index = "depth"', 'index = "time"')
    .replace("image.GR = {", "# {")
)


def timed_rows(first, count=10):
    stamps = [datetime.datetime(2023, 11, 14, 22, 0, first + i) for i in range(count)]
    return [f"{stamp.isoformat()},{i * 37 % 360},110,101.{i}" for i, stamp in enumerate(stamps)]


def test_a_log_whose_clock_was_set_back_is_said():
    live = hb.Live(parse(TIMED), clock=(clock := Clock()))
    live.receive("store", by_time(timed_rows(20)))
    reader = live.model.readers[1]
    for n in range(7):
        assert ("behind" in reader.doubts) == (n >= 6)
        clock.step(10)
        live.receive("store", by_time(timed_rows(n)))
    assert live.model.events.counts["store", "behind"] == 7
    live.receive("store", by_time(timed_rows(30)))
    assert reader.doubts == {}


def test_a_log_by_time_that_answers_and_stands_is_said():
    live = hb.Live(parse(TIMED), clock=(clock := Clock()))
    live.receive("store", by_time(timed_rows(20)))
    for n in range(40):
        clock.step(10)
        live.receive("store", witsml.framed("log", "same", b""))
        assert ("no_rows" in live.model.readers[1].doubts) == (n >= 30)
    assert live.model.events.counts["store", "no_rows"] == 1
    live.receive("store", by_time(timed_rows(31)))
    assert live.model.readers[1].doubts == {}


def test_a_store_without_the_mapped_mnemonics_lacks_them():
    live = hb.Live(parse(TIMED.replace('"TF"', '"tf"')), clock=Clock())
    live.receive("store", by_time(timed_rows(20)))
    reader = live.model.readers[1]
    lacking = reader.lacking()
    assert "toolface (curve tf)" in lacking
    assert lacking.endswith("TF")
