"""The viewer's server and feed: handshake, values over the websocket, the guard, bad input, and a real port."""

from __future__ import annotations

import json
import re
import struct
import urllib.error
import urllib.request
from pathlib import Path
from types import SimpleNamespace
from typing import Any
from urllib.parse import quote, urlencode, urlsplit

import numpy as np
import pytest
from golden_texts import Golden

starlette = pytest.importorskip("starlette", reason='the viewer needs the extra: pip install "helibore[view]"')
pytest.importorskip("uvicorn", reason='the viewer needs the extra: pip install "helibore[view]"')
pytest.importorskip("httpx2", reason="starlette's test client needs httpx2")

from live_servers import until  # noqa: E402
from made_wall import MadeWall, curved_path, gamma  # noqa: E402
from page_protocol import Message, unpack  # noqa: E402
from starlette.testclient import TestClient  # noqa: E402
from starlette.websockets import WebSocketDisconnect  # noqa: E402

import helibore as hb  # noqa: E402
from helibore.base.identity import NO_TOKEN, Access  # noqa: E402
from helibore.logs.picks import Pick, Picks  # noqa: E402
from helibore.viewer import Attribute, protocol  # noqa: E402
from helibore.viewer.feed import Feed  # noqa: E402
from helibore.viewer.page_files import page  # noqa: E402
from helibore.viewer.protocol import handshake  # noqa: E402
from helibore.viewer.scene import Scene  # noqa: E402
from helibore.viewer.texels import PROVISIONAL, RESCANNED, STATE, radius_of  # noqa: E402
from helibore.viewer.web_app import application  # noqa: E402

HOST = "127.0.0.1"
ACCESS = Access(token="s3cret")
WITH_TOKEN = {"authorization": "Bearer s3cret"}


@pytest.fixture
def feed() -> Any:
    wall = MadeWall(40_000)
    feed = Feed(wall, path=curved_path(), attributes={"GR": gamma(wall.depth, wall.toolface)}, well="A-1")
    feed.start()
    yield SimpleNamespace(wall=wall, feed=feed, scene=feed.scene)
    feed.close()


@pytest.fixture
def client(feed: Any) -> Any:
    with TestClient(application(feed.scene, ACCESS), base_url=f"http://{HOST}", headers=WITH_TOKEN) as client:
        yield client


def next_bytes(socket: Any) -> bytes:
    """The next binary message; the state, which may come between two, is left out."""
    while (message := socket.receive()).get("bytes") is None:
        socket._raise_on_close(message)
    found: bytes = message["bytes"]
    return found


def test_figures_of_a_section_end_where_the_turns_were_measured() -> None:
    wall = MadeWall(64 * 20)
    feed = Feed(wall, path=None, attributes={}, well="")
    found = feed.scene.summarize
    assert found is not None
    parts = {(999, 1005): (1000, 1002), (1001, 1001.55): (1001, 1001.55), (1003, 1004): (1002, 1002)}
    for section, ends in parts.items():
        for _ in range(2):  # the second time it has grown since
            summary = found(*section)
            assert (summary["start"], summary["stop"]) == pytest.approx(ends, abs=0.01)
            metres = summary["whole_turns"] + summary["incomplete_turns"]
            assert metres == pytest.approx(ends[1] - ends[0], abs=0.01)
            wall.grow(64)


class Talk:
    """A page's half of the conversation: acknowledges every binary message."""

    def __init__(self, socket: Any) -> None:
        self.socket = socket
        self.hello: dict[str, Any] = json.loads(socket.receive_text())
        self.state: dict[str, Any] = json.loads(socket.receive_text())

    def say(self, **words: Any) -> None:
        self.socket.send_text(json.dumps({"session": self.hello["session"], **words}))

    def message(self) -> Message:
        message = unpack(next_bytes(self.socket))
        self.say(ack=message.sequence)
        return message

    def listen(self) -> None:
        while True:
            next_bytes(self.socket)

    def until(self, wanted: Any, most: int = 50) -> Message:
        for _ in range(most):
            if wanted(message := self.message()):
                return message
        raise AssertionError("the message never came")


def test_a_page_is_greeted_and_gets_what_it_asks_for(client: TestClient, feed: Any) -> None:
    with client.websocket_connect(f"ws://{HOST}/ws") as socket:
        talk = Talk(socket)
        assert talk.hello["well"] == "A-1"
        assert talk.hello["levels"][0] == {"sectors": 64, "rows": 256, "pitch": 0.1, "rings": False}
        assert talk.hello["levels"][1] == {"sectors": 8, "rows": 1024, "pitch": 1.6, "rings": True}
        assert talk.hello["attributes"][0]["name"] == "GR"
        talk.say(subscribe={"tiles": [[1, 2]], "focus": 1, "mask": 1})
        write = talk.until(lambda m: m.kind == protocol.WRITE and m.level == 0)
        assert (write.tile, write.first, write.count, write.live) == (1, 0, 16384 + 65, False)
        radius = radius_of(write.texels, talk.hello["radius_unit"])
        part = slice(16384, 16384 + write.count)
        np.testing.assert_allclose(radius, feed.wall.radius[part], atol=5.1e-6)
        np.testing.assert_array_equal(
            write.columns[0], gamma(feed.wall.depth, feed.wall.toolface)[part].astype(np.float32)
        )
        change = feed.wall.grow(1000)
        feed.feed.update(change)
        talk.say(subscribe={"tiles": [[1, 4]], "focus": 1, "mask": 1})
        update = talk.until(lambda m: m.level == 0 and m.total == 41_000 and m.tile == 2)
        assert update.first + update.count == 41_000 - 2 * 16384


def test_a_page_before_the_wall_is_told_what_the_sources_do_and_greeted_when_it_begins() -> None:
    scene = Scene()
    scene.update_state(sources="mwd: listening", bit_depth=990.0)
    with TestClient(application(scene, ACCESS), base_url=f"http://{HOST}", headers=WITH_TOKEN) as client:
        for asked in ("vertex/0", "section.csv?start=1&stop=2", "history", "export.html?start=1&stop=2"):
            answer = client.get(f"/api/{asked}")
            assert (answer.status_code, answer.text) == (503, "no sample has come yet: there is no wall to show\n")
        assert client.get("/healthz").json()["vertices"] == 0
        with client.websocket_connect(f"ws://{HOST}/ws") as socket:
            state = json.loads(socket.receive_text())
            assert (state["begun"], state["sources"], state["bit_depth"]) == (False, "mwd: listening", 990.0)
            feed = Feed(MadeWall(500), path=None, attributes={}, well="A-2", scene=scene)
            hello = json.loads(socket.receive_text())
            assert (hello["type"], hello["well"]) == ("handshake", "A-2")
            assert json.loads(socket.receive_text())["begun"]
            frames = unpack(next_bytes(socket))
            assert (frames.kind, frames.mask) == (protocol.FRAMES, 0)
            socket.send_text(json.dumps({"session": hello["session"], "ack": frames.sequence}))
            feed.start()
            feed.set_path(curved_path())
            while (frames := unpack(next_bytes(socket))).kind != protocol.FRAMES:
                pass  # the overview may come between
            assert frames.mask == protocol.SURVEYED
            feed.close()


def test_a_new_wall_greets_again(client: TestClient, feed: Any) -> None:
    with client.websocket_connect(f"ws://{HOST}/ws") as socket:
        talk = Talk(socket)
        feed.scene.begin(feed.scene.shape)
        while True:
            frame = socket.receive()
            if frame.get("text") and json.loads(frame["text"])["type"] == "handshake":
                break
        assert json.loads(frame["text"])["session"] != talk.hello["session"]


@pytest.mark.parametrize(
    ("said", "reason"),
    [
        ("{", "not JSON"),
        ("[" * 5000, "not JSON"),
        ("7", "a message must be an object, sent after the handshake"),
        ('{"session": "%s"}', "a message must be ack or subscribe"),
        ('{"session": "%s", "ack": 99}', "ack 99: no message with this number waits for an ack"),
        ('{"session": "%s", "subscribe": {"tiles": 3}}', "subscribe.tiles: must be a list of at most 64 ranges"),
        ("x" * 9000, "a page sends text of at most 8192 bytes"),
    ],
)
def test_a_malformed_message_ends_that_page_only(client: TestClient, said: str, reason: str) -> None:
    with client.websocket_connect(f"ws://{HOST}/ws") as socket:
        talk = Talk(socket)
        socket.send_text(said % talk.hello["session"] if "%s" in said else said)
        with pytest.raises(WebSocketDisconnect) as closed:
            talk.listen()
        assert (closed.value.code, closed.value.reason) == (4400, reason)
    assert client.get("/healthz").status_code == 200


def test_a_page_of_another_server_is_turned_away(client: TestClient) -> None:
    """Also with the token: a browser says which page asks."""
    for name, value, rule in (
        ("origin", "http://evil.example", "only the page of this server may connect"),
        ("origin", "http://[::1", "only the page of this server may connect"),
        ("sec-fetch-site", "cross-site", "only the page of this server may ask for this"),
        ("sec-fetch-site", "same-site", "only the page of this server may ask for this"),
    ):
        answer = client.get("/api/vertex/1", headers={name: value})
        assert (answer.status_code, answer.text) == (403, f"{name} {value!r}: {rule}\n")
        with pytest.raises(WebSocketDisconnect) as closed, client.websocket_connect("/ws", headers={name: value}):
            pass
        assert closed.value.code == 4403
    for site in ("same-origin", "none"):
        assert client.get("/api/vertex/1", headers={"sec-fetch-site": site}).status_code == 200
    assert client.get("/", headers={"sec-fetch-site": "cross-site"}).status_code != 403, "a link, or a notebook's frame"
    with client.websocket_connect(f"ws://{HOST}/ws", headers={"origin": f"http://{HOST}"}) as socket:
        assert Talk(socket).hello["type"] == "handshake"


def test_every_path_asks_for_the_token(feed: Any) -> None:
    with TestClient(application(feed.scene, ACCESS), base_url="http://rig") as client:
        for path in ("/", "/app.js", "/app.css", "/healthz", "/api/vertex/1", "/api/picks.csv", "/else"):
            for method in ("GET", "PUT", "POST", "DELETE", "OPTIONS", "HEAD"):
                assert client.request(method, path).status_code == 403
        assert client.get("/api/vertex/1?token=s3cre").text == f"{NO_TOKEN}\n"
        assert client.get("/api/vertex/1?token=s3cret").status_code == 200
        for query in ("", "?token=s3cre"):
            with (
                client.websocket_connect(f"ws://rig/ws{query}") as socket,
                pytest.raises(WebSocketDisconnect) as closed,
            ):
                socket.receive_text()
            assert (closed.value.code, closed.value.reason) == (4403, NO_TOKEN)
        with client.websocket_connect("ws://rig/ws?token=s3cret") as socket:
            assert Talk(socket).hello["type"] == "handshake"


def test_headers_keep_the_page_to_itself(client: TestClient) -> None:
    headers = client.get("/healthz").headers
    assert headers["content-security-policy"].startswith("default-src 'self';")
    assert "unsafe" not in headers["content-security-policy"]
    assert headers["x-content-type-options"] == "nosniff"


def test_one_vertex_and_a_section_as_text(client: TestClient, feed: Any, golden: Golden) -> None:
    k = 12_345
    got = client.get(f"/api/vertex/{k}").json()
    assert got["depth"] == pytest.approx(feed.wall.depth[k], abs=1e-9)
    assert got["toolface"] == pytest.approx(feed.wall.toolface[k])
    assert got["radius"] == pytest.approx(feed.wall.radius[k], abs=5.1e-6)
    golden(client.get("/api/vertex/40000").text)
    lines = client.get("/api/section.csv?start=1011.9&stop=1012.1").text.splitlines()
    golden(lines[0])
    assert len(lines) == 1 + 129
    assert lines[-1].split(",")[3:6] == ["", "", ""], "a vertex without a sample has no radius, not zero"
    assert client.get("/api/section.csv?start=1").text.startswith("stop: missing;")
    assert client.get("/api/section.csv?start=1e308&stop=9e307").text.count("\n") == 1, "beyond the wall: no vertex"
    golden(client.get("/api/section.csv?start=nan&stop=2").text)


def test_a_corrected_path_sends_frames_only(client: TestClient, feed: Any) -> None:
    with client.websocket_connect(f"ws://{HOST}/ws") as socket:
        talk = Talk(socket)
        talk.say(subscribe={"tiles": [[0, 3]], "focus": 0, "mask": 1})
        seen = 0
        while seen < 5:  # frames, three tiles, the overview
            talk.message()
            seen += 1
        feed.feed.set_path(hb.Survey([970, 12000], [20, 20], [90, 90]).path())
        message = talk.message()
        assert message.kind == protocol.FRAMES
        np.testing.assert_allclose(message.centre, feed.scene.frames.centre[: message.count])


def test_view_serves_a_wall_on_a_real_port() -> None:
    wall = MadeWall(5000)
    with hb.view(wall, well="B") as viewer:
        with urllib.request.urlopen(viewer.url.replace("/?", "/healthz?")) as answer:
            assert json.load(answer)["vertices"] == 5000
        viewer.update(wall.grow(500))
        until(lambda: viewer.scene.levels[0].size == 5500)
        assert viewer._repr_html_() == (
            f'<iframe src="{viewer.url}" style="width: 100%; height: 720px; border: 0" title="helibore"></iframe>'
        )
        port = urlsplit(viewer.url).port
        with pytest.raises(
            OSError, match=rf"^\[Errno \d+\] 127\.0\.0\.1 port {port}: Address already in use; give another port"
        ):
            hb.view(wall, port=port)
    with pytest.raises(urllib.error.URLError):
        urllib.request.urlopen(viewer.url, timeout=2)
    viewer.close()


def follows(scene: Scene, wall: hb.Wall) -> bool:
    """Whether the scene shows the wall to its last radius."""
    texels = scene.levels[0].texels[: scene.levels[0].size]
    shown = radius_of(texels, scene.shape.radius_unit)
    return len(shown) == len(wall) and np.allclose(shown, wall.radius, rtol=0, atol=5.1e-6, equal_nan=True)


def test_a_live_wall_is_followed_append_by_append() -> None:
    rng = np.random.default_rng(5)
    depth = 1000 + np.sort(rng.uniform(0, 30, 30_000))
    toolface, radius = rng.uniform(0, 360, 30_000), 0.11 + 0.004 * rng.random(30_000)
    wall = hb.Wall(bit_diameter=0.216, start_depth=1000.0)
    wall.append(depth[:5000], toolface[:5000], radius[:5000])
    with hb.view(wall) as viewer:
        for first in range(5000, 30_000, 2500):
            part = slice(first, first + 2500)
            viewer.update(wall.append(depth[part], toolface[part], radius[part]))
        until(lambda: viewer.scene.settled == wall.settled and follows(viewer.scene, wall))
        viewer.update(wall.append([1010.0, 1010.01], [40.0, 41.0], [0.15, 0.15]))
        until(lambda: follows(viewer.scene, wall))
        again = viewer.scene.levels[0].texels[:, STATE] & RESCANNED
        touched = wall.depth[np.flatnonzero(again)]
        assert len(touched)
        assert abs(touched - 1010).max() < 1.0, "only what the late samples reach is a re-scan"


def test_a_part_of_a_helix_is_followed_append_by_append() -> None:
    """Its vertices and changes count from `first_vertex`, those of the page from 0."""
    rng = np.random.default_rng(7)
    depth, toolface = np.sort(rng.uniform(0, 20, 12_000)), rng.uniform(0, 360, 12_000)
    radius = 0.11 + 0.004 * rng.random(12_000)
    wall = hb.Wall(bit_diameter=0.216, sectors=16, start_depth=0.0, first_vertex=800, stop_vertex=2900)
    wall.append(depth[:6000], toolface[:6000], radius[:6000])
    with hb.view(wall, beside={"same": wall}) as viewer:
        assert viewer.scene.shape.start_depth == pytest.approx(5.0)
        assert follows(viewer.scene, wall)
        viewer.update(wall.append(depth[6000:9000], toolface[6000:9000], radius[6000:9000]))
        until(lambda: follows(viewer.scene, wall))
        wall.append(depth[9000:], toolface[9000:], radius[9000:])
        viewer.update()
        until(lambda: follows(viewer.scene, wall) and viewer.scene.settled == wall.settled - 800)


def test_a_zone_has_the_interval_of_its_size() -> None:
    rng = np.random.default_rng(12)
    depth = np.arange(2000.0, 2024.0, 0.002)
    radius = np.where(abs(depth - 2018) < 0.5, 0.104, 0.1085) + rng.normal(0, 2e-4, depth.size)
    wall = hb.reconstruct(hb.Caliper(depth, depth * 9000 % 360, radius), bit_diameter=0.216)
    with hb.view(wall) as viewer:
        until(lambda: len(viewer.scene.state.zones) == 1)
        (zone,) = viewer.scene.state.zones
        assert 0.0002 < zone["within"] < 0.002, "by 0.2 mm noise"


def test_values_of_new_quads_come_with_the_change_and_provisional_vertices_settle(golden: Golden) -> None:
    rng = np.random.default_rng(6)
    depth = 1000 + np.sort(rng.uniform(0, 4, 4000))
    toolface, radius = rng.uniform(0, 360, 4000), 0.11 + 0.004 * rng.random(4000)
    wall = hb.Wall(bit_diameter=0.216, start_depth=1000.0, direct=True)
    wall.append(depth[:400], toolface[:400], radius[:400])

    def quads() -> np.ndarray:
        return np.sin(np.arange(max(0, len(wall) - wall.settings.sectors - 1)))

    def shown() -> bool:
        level, want = viewer.scene.levels[0], np.full(len(wall), np.nan, np.float32)
        want[: len(quads())] = quads()
        with viewer.scene.lock:
            marked = (level.texels[: level.size, STATE] & PROVISIONAL) > 0
            values = level.columns[0][: level.size].copy()
            there = follows(viewer.scene, wall)
        return there and np.array_equal(values, want, equal_nan=True) and np.array_equal(marked, wall.provisional)

    seen = 0
    with hb.view(wall, attributes={"GR": quads()}) as viewer:
        for first in range(400, 4000, 150):
            part = slice(first, first + 150)
            viewer.update(wall.append(depth[part], toolface[part], radius[part]), {"GR": quads()})
            until(shown)
            seen += int(wall.provisional.sum())
        assert seen > 0, "direct connection was at work"
        with golden.raises():
            viewer.update(None, {"XX": quads()})
        with golden.raises():
            viewer.update(None, {"GR": [1.0]})


def test_a_message_too_long_ends_that_page_and_the_server_lives() -> None:
    from websockets.exceptions import ConnectionClosed
    from websockets.sync.client import connect

    with hb.view(MadeWall(5000)) as viewer:
        address = viewer.url.replace("http", "ws", 1).replace("/?", "/ws?")
        for said, code, reason in (
            ("x" * 20_000, 1009, ""),
            ("x" * 9000, 4400, "a page sends text of at most 8192 bytes"),
            (b"1234", 4400, "a page sends text of at most 8192 bytes"),
        ):
            with connect(address) as socket, pytest.raises(ConnectionClosed) as closed:
                answers(socket, said)
            assert closed.value.rcvd is not None
            assert (closed.value.rcvd.code, closed.value.rcvd.reason[: len(reason)]) == (code, reason)
        with connect(address) as socket, pytest.raises(ConnectionClosed):
            answers(socket, "x" * (1 << 24))  # the server need not read all of it to close, so the code may get lost
        with connect(address) as socket:
            assert json.loads(socket.recv(20))["vertices"] == 5000


def answers(socket: Any, said: str | bytes) -> None:
    """Say it, then read everything until the other side closes."""
    socket.send(said)
    while True:
        socket.recv(20)


def test_what_cannot_be_viewed_is_said(golden: Golden) -> None:
    wall = MadeWall(5000)
    with golden.raises():
        hb.view(wall, token="")
    with golden.raises():
        hb.view(wall, attributes={"GR": [1, 2, 3]})
    for values, rule in (
        (np.ma.masked_equal(np.arange(5000.0), 3), "masked arrays are not taken; drop the masked rows or use"),
        (["a"] * 5000, "must be numbers"),
        (np.ones((5000, 1)), "must be one-dimensional, not 2-dimensional"),
    ):
        with pytest.raises(hb.InputError, match=f"^attribute GR: {rule}"):
            hb.view(wall, attributes={"GR": values})
    measured = Feed(wall, path=None, attributes={"measured": np.ones(5000, bool)}, well="").scene
    assert (measured.levels[0].columns[0][:5000] == 1).all()
    with golden.raises():
        hb.view(wall, port=70_000)
    short = hb.Survey([990, 1002], [1, 1], [0, 0]).path()
    with golden.raises():
        hb.view(wall, path=short)
    depth = np.arange(1000.0, 1005.0, 0.01)
    beyond = hb.reconstruct(hb.Caliper(depth, depth * 900 % 360, 0.108 + 0 * depth), bit_diameter=0.216)
    beyond.path = short
    with golden.raises():
        hb.view(beyond)
    with golden.raises():
        hb.view(MadeWall(0))
    viewer = hb.view(wall, attributes={Attribute("GR", "gAPI"): np.ones(4935)})
    try:
        with golden.raises():
            viewer.set_attribute("XX", np.ones(5000))
    finally:
        viewer.close()


def test_a_constant_value_on_a_log_scale_lies_between_two_values_above_0() -> None:
    attribute = Attribute("RES", "ohm.m", log=True)
    scene = Feed(MadeWall(5000), path=None, attributes={attribute: np.full(5000, 2e-4)}, well="").scene
    low, high = scene.state.ranges["RES"]
    assert 0 < low < 2e-4 < high


def test_picks_of_a_page_are_saved_and_shown_on_every_page(client: TestClient, feed: Any, tmp_path: Any) -> None:
    file = tmp_path / "a.wall.picks.csv"
    feed.scene.picks_file = file
    pick = {"key": "one", "kind": "bed", "depth": 1010.0, "toolface": 20.0, "apparent_dip": 30.0}
    with client.websocket_connect(f"ws://{HOST}/ws") as socket:
        Talk(socket)

        def shown() -> list[tuple[str, str, float]]:
            while True:
                message = json.loads(socket.receive().get("text") or '{"type": "values"}')
                if message["type"] == "picks":
                    return [(one["key"], one["kind"], one["depth"]) for one in message["picks"]]

        assert shown() == [], "a page also gets an empty list: it may still hold picks of an earlier server"
        assert client.put("/api/pick", json=pick).status_code == 200
        assert shown() == [("one", "bed", 1010.0)]
        assert client.put("/api/pick", json=pick | {"kind": "fault"}).status_code == 200
        assert shown() == [("one", "fault", 1010.0)]
        table = client.get("/api/picks.csv").text
        assert file.read_bytes().decode() == table
        assert table.splitlines()[1].startswith("fault,1010,20,30,")
        assert client.post("/api/picks.csv", content=table).json() == {"added": [], "replaced": [], "unchanged": 1}
        other = table.replace("fault,1010,", "fault,1011,")
        row = other.splitlines()[1].replace(",one,", ",two,").replace("fault,1011,", "fault,1012,")
        answer = client.post("/api/picks.csv", content=f"{other}{row}\n").json()
        assert answer == {"added": ["two"], "replaced": ["one"], "unchanged": 0}
        assert shown() == [("one", "fault", 1011.0), ("two", "fault", 1012.0)]
        assert client.delete("/api/pick?key=one").status_code == 200
        assert shown() == [("two", "fault", 1012.0)]
        assert [pick.key for pick in Picks.load(file)] == ["two"]


def test_picks_of_a_folder_that_cannot_be_written_stay_in_the_wall(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Any
) -> None:
    file = tmp_path / "a.wall.picks.csv"
    # Root can write everywhere.
    monkeypatch.setattr("helibore.logs.picks.os.access", lambda folder, _: folder != tmp_path)
    viewer = hb.view(MadeWall(5000), picks_file=file)
    viewer.close()
    scene = viewer.scene
    said = handshake(scene)
    assert (said["picks_file"], said["saves_picks"]) == ("a.wall.picks.csv", False)
    scene.change_picks(lambda picks: picks.append(Pick(kind="bed", depth=1010.0, toolface=20.0)))
    assert (len(scene.picks), file.exists()) == (1, False)


def test_a_pick_that_breaks_a_rule_or_cannot_be_saved_changes_nothing(
    client: TestClient, feed: Any, golden: Golden
) -> None:
    pick = {"kind": "bed", "depth": 1010.0, "toolface": 20.0}
    refused = client.put("/api/pick", json=pick | {"toolface": 400})
    assert (refused.status_code, refused.text) == (400, "toolface = 400: must be 0 to 360\n")
    assert client.put("/api/pick", content="{").status_code == 400
    assert client.put("/api/pick", content="[" * 8000).status_code == 400
    golden(client.put("/api/pick", content="x" * 9000).text)
    assert client.post("/api/picks.csv", content="a,b\n").status_code == 400
    feed.scene.picks_file = "/nowhere/a.picks.csv"
    refused = client.put("/api/pick", json=pick)
    assert refused.status_code == 500
    assert refused.text.startswith("the picks were not saved: [Errno 2]")
    assert feed.scene.picks == []
    other = client.put("/api/pick", json=pick, headers={"Origin": "http://elsewhere.example"})
    assert other.status_code == 403, "another page may not pick"


def test_a_print_has_the_scale_that_the_page_asks_for(client: TestClient, feed: Any) -> None:
    asked: list[Any] = []
    feed.scene.draw_pages = lambda *wanted: asked.append(wanted) or b"%PDF"
    assert client.get("/api/print.pdf?start=1004&stop=1001&scale=200&units=ft").content == b"%PDF"
    assert client.get("/api/print.pdf?start=1001&stop=1004").status_code == 200
    assert asked == [(1001.0, 1004.0, "ft", 200), (1001.0, 1004.0, "mm", None)]
    for scale in ("0", "-200", "1e3", "20001"):
        refused = client.get(f"/api/print.pdf?start=1001&stop=1004&scale={scale}")
        rule = f"scale = {scale}: must be a whole number from 10 to 10000, 200 for 1:200\n"
        assert (refused.status_code, refused.text) == (400, rule)


def test_a_print_takes_the_arrangement_of_the_tracks(client: TestClient, feed: Any) -> None:
    asked: list[Any] = []
    feed.scene.draw_pages = lambda *_, **more: asked.append(more) or b"%PDF"
    text = quote('[[track]]\nkind = "caliper"\nwidth = 200\n')
    assert client.get(f"/api/print.pdf?start=1001&stop=1004&template={text}").content == b"%PDF"
    assert [(one.kind, one.width) for one in asked[0]["template"].track] == [("caliper", 200)]
    refused = client.get(f"/api/print.pdf?start=1001&stop=1004&template={text.replace('width', 'wide')}")
    assert refused.status_code == 400
    assert refused.text.startswith("template, line 3: track 1.wide")
    assert client.get("/api/print.pdf?start=1001&stop=1004&picks=off").content == b"%PDF"
    assert client.get("/api/print.pdf?start=1001&stop=1004&picks=on").content == b"%PDF"
    assert asked[1:] == [{"with_picks": False}, {}]


def test_a_print_takes_a_picture_of_the_page(client: TestClient, feed: Any) -> None:
    asked: list[Any] = []
    feed.scene.draw_pages = lambda *wanted: asked.append(wanted) or b"%PDF"
    address = "/api/print.pdf?start=1001&stop=1004"
    picture = b"\x89PNG\r\n\x1a\n" + bytes(8) + struct.pack(">II", 640, 480) + bytes(9)
    assert client.post(address, content=picture).content == b"%PDF"
    assert asked == [(1001.0, 1004.0, "mm", None, picture)]
    wide = picture[:16] + struct.pack(">II", 8193, 480)
    for body, rule in (
        (b"GIF89a", "picture: must be a PNG"),
        (wide, "picture = 8193 x 480: must have 1 to 8192 pixels"),
    ):
        refused = client.post(address, content=body)
        assert refused.status_code == 400
        assert refused.text.startswith(rule)
    assert client.post(address, content=bytes((1 << 24) + 1)).status_code == 400
    assert len(asked) == 1


@pytest.mark.parametrize("path", ["summary", "section.csv", "export.html", "print.pdf"])
def test_an_end_of_a_section_that_is_no_depth_is_refused(
    monkeypatch: pytest.MonkeyPatch, client: TestClient, feed: Any, path: str
) -> None:
    for module in ("web_app", "page_files"):
        monkeypatch.setattr(f"helibore.viewer.{module}.page", lambda _: b"")  # the build may be without the page
    feed.scene.draw_pages = lambda *_: b"%PDF"
    for end in ("nan", "-inf", "x"):
        refused = client.get(f"/api/{path}?start=1001&stop={end}")
        assert (refused.status_code, refused.text) == (400, f"stop = {end}: must be a finite number of metres\n")


def enclosed_address(answer: str) -> str:
    found = re.search(r'id="enclosed">(.*?)</script>', answer)
    assert found is not None
    return str(json.loads(found[1])["address"])


def test_a_snapshot_holds_every_note_that_a_page_keeps(monkeypatch: pytest.MonkeyPatch) -> None:
    """As the page writes them (notes.js, panel.js), over a real port: its own limits count."""
    page = {
        "index.html": '<meta charset="utf-8"><link rel="stylesheet" href="app.css">'
        '<script type="module" src="app.js"></script>',
    }
    for module in ("web_app", "page_files"):
        monkeypatch.setattr(f"helibore.viewer.{module}.page", lambda name: page.get(name, "").encode())
    notes = "~".join(f"12345.678_{quote('字' * 80)}" for _ in range(50))
    address = f"#{urlencode({'md': '12345.678', 'notes': notes})}"
    with hb.view(MadeWall(4000)) as viewer:
        asked = f"{viewer.url.replace('/?', '/api/export.html?')}&start=1000&stop=1003&address="
        with urllib.request.urlopen(asked + quote(address, safe="")) as answer:
            assert enclosed_address(answer.read().decode()) == address
        with pytest.raises(urllib.error.HTTPError) as refused:
            urllib.request.urlopen(asked + "a" * 131_073)
        assert refused.value.code == 400
        rule = "address: 131073 characters, must be at most 131072\n"
        assert refused.value.read().decode() == rule


@pytest.mark.skipif(page("app.js") is None, reason="the page is not built: Node.js 18 was not there")
def test_the_page_is_small_on_the_wire_and_sent_again_only_if_it_changed() -> None:
    with TestClient(application(Scene(), ACCESS), base_url=f"http://{HOST}", headers=WITH_TOKEN) as client:
        sent = 0
        for name in ("", "app.js", "app.css"):
            answer = client.get(f"/{name}")
            assert answer.content == page(name or "index.html")
            assert answer.headers["content-encoding"] == "gzip"
            sent += int(answer.headers["content-length"])
            again = client.get(f"/{name}", headers={"If-None-Match": answer.headers["etag"]})
            assert (again.status_code, again.content) == (304, b"")
            plain = client.get(f"/{name}", headers={"Accept-Encoding": "identity"})
            assert "content-encoding" not in plain.headers
            assert plain.content == answer.content
        assert sent <= 80_000


@pytest.mark.parametrize(("east", "names"), [(3.0, ["Over bit B", "B less this"]), (30.0, ["Over bit B"])])
def test_the_difference_to_another_well_is_not_offered(east: float, names: list[str]) -> None:
    depth = np.arange(2000.0, 2010.0, 0.01)
    survey = hb.Survey([1900.0, 2100.0], [20.0, 20.0], [40.0, 40.0])
    walls = []
    for head in ((0.0, 0.0, 0.0), (0.0, east, 0.0)):
        walls.append(hb.reconstruct(hb.Caliper(depth, depth * 900 % 360, 0.108 + 0 * depth), bit_diameter=0.216))
        walls[-1].path = survey.path(head=head)
    with hb.view(walls[0], beside={"B": walls[1]}) as viewer:
        assert viewer.scene.path is walls[0].path, "that of the wall, unless another is given"
        assert [one.name for one in viewer.scene.shape.attributes] == names


def test_other_walls_stand_beside_in_the_colours_of_the_first() -> None:
    depth = np.arange(2000.0, 2010.0, 0.01)
    walls = [
        hb.reconstruct(
            hb.Caliper(depth[here], depth[here] * 900 % 360, 0.108 + over + 0 * depth[here]), bit_diameter=0.216
        )
        for over, here in ((0.012, depth > 0), (0.004, depth > 2005))
    ]
    with hb.view(walls[0], beside={"pass 2": walls[1]}) as viewer:
        attribute, difference = viewer.scene.shape.attributes
        assert (difference.name, difference.unit, difference.color_map) == ("pass 2 less this", "m", "difference")
        assert (attribute.name, attribute.unit, attribute.color_map) == ("Over bit pass 2", "m", "over-bit")
        assert (attribute.low, attribute.high) == (-0.02, 0.02), "those of the first wall"
        shown = viewer.scene.levels[0].columns[0][: len(walls[0]) - 65]
        deep = walls[0].depth[: shown.size] > 2005.2
        np.testing.assert_allclose(shown[deep], 0.004, atol=1e-5)
        less = viewer.scene.levels[0].columns[1][: shown.size]
        np.testing.assert_allclose(less[deep], -0.008, atol=1e-5)
        assert np.isnan(shown[walls[0].depth[: shown.size] < 2004.8]).all(), "nothing where it does not reach"
        template = viewer.scene.template
        assert template is not None
        assert [track.name for track in template.track] == ["Radius", "Over bit pass 2", ""]
        assert {"C1 pass 2", "C2 pass 2"} <= set(viewer.scene.curves)


def test_the_logs_of_a_section_are_saved_as_las(tmp_path: Path) -> None:
    depth = np.arange(2000.0, 2010.0, 0.01)
    wall = hb.reconstruct(hb.Caliper(depth, depth * 900 % 360, 0.108 + 0 * depth), bit_diameter=0.216)
    with hb.view(wall) as viewer:
        root, _, token = viewer.url.partition("?")
        with urllib.request.urlopen(f"{root}api/section.las?{token}&start=2002&stop=2004") as answer:
            assert "section-2002.0-2004.0.las" in answer.headers["content-disposition"]
            (tmp_path / "page.las").write_bytes(answer.read())
        wall.logs().between(2002, 2004).save(tmp_path / "own.las")
        assert (tmp_path / "page.las").read_bytes() == (tmp_path / "own.las").read_bytes()
        with pytest.raises(urllib.error.HTTPError) as refused:
            urllib.request.urlopen(f"{root}api/section.las?{token}&start=2002.01&stop=2002.02")
        with refused.value as answer:
            assert answer.code == 400


def test_a_section_is_a_mesh_and_one_that_is_too_long_is_refused(
    monkeypatch: pytest.MonkeyPatch, golden: Golden
) -> None:
    depth = np.arange(2000.0, 2010.0, 0.01)
    wall = hb.reconstruct(hb.Caliper(depth, depth * 900 % 360, 0.108 + 0 * depth), bit_diameter=0.216)
    with hb.view(wall) as viewer:
        assert viewer.scene.state.meshes
        root, _, token = viewer.url.partition("?")
        address = f"{root}api/section.glb?{token}&start=2002&stop=2004"
        with urllib.request.urlopen(address) as answer:
            assert answer.headers["content-type"] == "model/gltf-binary"
            assert "section-2002.0-2004.0.glb" in answer.headers["content-disposition"]
            body = answer.read()
        assert body[:4] == b"glTF"
        made = json.loads(body[20 : 20 + int.from_bytes(body[12:16], "little")])
        quads = len(wall.surface(None, 2002.0, 2004.0).quads)
        assert max(accessor["count"] for accessor in made["accessors"]) >= quads
        monkeypatch.setattr("helibore.viewer.feed.MOST_MESHED", 1000)
        with pytest.raises(urllib.error.HTTPError) as refused:
            urllib.request.urlopen(address)
        assert refused.value.code == 400
        golden(refused.value.read().decode())
