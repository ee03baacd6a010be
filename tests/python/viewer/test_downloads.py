"""Sections that are written while they are sent: of one moment, a few at a time, and the wall goes on meanwhile."""

from __future__ import annotations

import asyncio
import base64
import csv
import json
import re
import threading
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest

pytest.importorskip("starlette", reason='the viewer needs the extra: pip install "helibore[view]"')

from made_wall import MadeWall, curved_path, gamma
from page_protocol import unpack
from starlette.requests import ClientDisconnect

import helibore as hb
from helibore.viewer import exports, html_export
from helibore.viewer.downloads import Downloads
from helibore.viewer.feed import Feed
from helibore.viewer.scene import Scene
from helibore.viewer.texels import Vertices, radius_of

FILES = {
    "index.html": '<meta charset="utf-8"><link rel="stylesheet" href="app.css">'
    '<script type="module" src="app.js"></script>',
    "app.css": "",
    "app.js": "",
    "more.js": "",
}


@pytest.fixture
def wall() -> MadeWall:
    return MadeWall(40_000)


@pytest.fixture
def scene(wall: MadeWall) -> Scene:
    values = {"GR": gamma(wall.depth, wall.toolface)}
    return Feed(wall, path=curved_path(), attributes=values, well="A-1").scene


def grow_and_patch(scene: Scene) -> None:
    """Change every vertex, add more, and begin anew: all that a section being written must not notice."""
    texels = scene.levels[0].texels
    other = np.full(scene.levels[0].size + 20_000, 0.2)
    scene.write(0, Vertices(other), {"GR": np.zeros(len(other))})
    assert not np.shares_memory(texels, scene.levels[0].texels)
    scene.begin(scene.shape)


def test_a_table_is_of_the_moment_it_was_asked_for(scene: Scene) -> None:
    whole = "".join(exports.section_csv(scene, 1005.0, 1030.0))
    pieces = exports.section_csv(scene, 1005.0, 1030.0)
    first = next(pieces)
    grow_and_patch(scene)
    assert first + "".join(pieces) == whole
    assert whole.count("\n") == 1 + 250 * 64 + 1


def test_a_table_of_a_gauge_hole_has_no_radius_and_no_samples() -> None:
    wall = hb.reconstruct(hb.Caliper.gauge(1000.0, 1003.0, 0.2), bit_diameter=0.2, sectors=16)
    scene = Feed(wall, path=None, attributes={"GR": np.arange(len(wall) - 17.0)}, well="A").scene
    head, *rows = "".join(exports.section_csv(scene, 1001.0, 1002.0)).splitlines()
    assert head.endswith(',radius [m],first radius [m],nearest [m],support,"GR []"')
    assert len(rows) == 161
    for row in rows:
        k, _, _, *measured, gamma_ray = row.split(",")
        assert measured == ["", "", "", ""], "bit size is no measurement"
        assert float(gamma_ray) == int(k)


def test_a_quote_in_the_name_of_an_attribute_does_not_split_its_column(wall: MadeWall) -> None:
    scene = Feed(wall, path=None, attributes={'8" hole, top': np.ones(40_000)}, well="").scene
    rows = list(csv.reader("".join(exports.section_csv(scene, 1001.0, 1001.1)).splitlines()))
    assert rows[0][-1] == '8" hole, top []'
    assert {len(row) for row in rows} == {8}


@pytest.mark.parametrize("ends", [(-5.0, 3.0), (900.0, 999.0), (1100.0, 1200.0), (9e9, 8e9)])
def test_a_table_beside_a_wall_that_grew_has_no_rows(scene: Scene, ends: tuple[float, float]) -> None:
    scene.write(40_000, Vertices(np.full(100, 0.11)), {})
    assert len(scene.levels[0].texels) > scene.levels[0].size, "room for more: not all that is held is wall"
    assert "".join(exports.section_csv(scene, *ends)).count("\n") == 1


@pytest.mark.parametrize(("start", "stop"), [(-9, -5), (-5, 3), (7, 2), (39_999, 50_000), (41_000, 45_000)])
def test_a_frozen_copy_holds_what_the_wall_has_of_a_section(scene: Scene, start: int, stop: int) -> None:
    level = scene.levels[0]
    level.reserve(40_001)
    kept = level.frozen_copy(start, stop)
    inside = list(range(max(0, start), min(stop, 40_001)))
    assert (kept.size, len(kept.texels)) == (40_001, 40_001)
    np.testing.assert_array_equal(kept.texels[inside], level.texels[inside])
    assert not np.delete(kept.texels, inside, axis=0).any()


def test_an_export_is_of_the_moment_it_was_asked_for(scene: Scene, wall: MadeWall) -> None:
    pieces = html_export.html_export(scene, FILES, 1026.0, 1030.0)
    grow_and_patch(scene)
    text = "".join(pieces)
    enclosed = json.loads(re.search(r'id="enclosed">(.*?)</script>', text)[1])  # type: ignore[index]
    assert enclosed["hello"]["vertices"] == 40_000
    found = [unpack(base64.b64decode(one)) for one in enclosed["messages"]]
    assert {(one.kind, one.level, one.tile) for one in found} >= {(1, 0, 1), (1, 1, 0), (3, 255, 0)}
    tile = next(one for one in found if (one.level, one.tile) == (0, 1))
    part = slice(16384, 16384 + 16384 + 65)
    np.testing.assert_allclose(radius_of(tile.texels, 1e-5), wall.radius[part], atol=5.1e-6)
    np.testing.assert_array_equal(tile.columns[0], gamma(wall.depth, wall.toolface)[part].astype(np.float32))


def test_the_scene_is_unlocked_while_an_export_is_written(scene: Scene) -> None:
    pieces = html_export.html_export(scene, FILES, 1000.0, 1060.0)
    next(pieces)
    free = []

    def other_thread() -> None:
        free.append(scene.lock.acquire(timeout=0.0))
        scene.lock.release()

    for _ in pieces:
        thread = threading.Thread(target=other_thread)
        thread.start()
        thread.join()
    assert len(free) >= 5
    assert all(free)


class Reader:
    """A browser's half of an answer: hears the head and the body, or stops reading."""

    def __init__(self, reads: bool) -> None:
        self.reads, self.said = reads, bytearray()
        self.closed = asyncio.Event()

    async def send(self, message: Any) -> None:
        if message["type"] == "http.response.body":
            if not self.reads:
                await self.closed.wait()
            self.said += message["body"]

    async def receive(self) -> Any:
        await self.closed.wait()
        return {"type": "http.disconnect"}


def written(count: int = 3) -> Iterator[str]:
    return (f"piece {i}\n" for i in range(count))


SCOPE = {"type": "http", "asgi": {"spec_version": "2.4"}}


def test_a_few_at_a_time_and_the_next_is_told_to_wait() -> None:
    async def run() -> None:
        downloads = Downloads("downloads", 2, stalled=0.2)
        slow = [await downloads.start(written, "text/csv", "a.csv", whole=way) for way in (False, True)]
        refused = await downloads.start(written, "text/csv", "a.csv")
        assert (refused.status_code, refused.headers["retry-after"]) == (503, "5")
        assert bytes(refused.body) == (
            b"the server already writes 2 downloads: try again when one of them is done; "
            b"HELIBORE_LIMIT_DOWNLOADS raises this number\n"
        )
        reader, stalled = Reader(True), Reader(False)
        await slow[0](SCOPE, reader.receive, reader.send)
        assert reader.said == b"piece 0\npiece 1\npiece 2\n"
        assert downloads.running == 1
        with pytest.raises(ClientDisconnect):  # nobody read for 0.2 s
            await slow[1](SCOPE, stalled.receive, stalled.send)
        assert downloads.running == 0

    asyncio.run(run())


def test_what_cannot_be_written_takes_no_place() -> None:
    def wrong() -> Iterator[str]:
        raise ValueError("start = 1: too shallow")

    def broken() -> Iterator[str]:
        raise RuntimeError("a bug")

    async def run() -> None:
        downloads = Downloads("downloads", 1)
        refused = await downloads.start(wrong, "text/csv", "a.csv")
        assert (refused.status_code, bytes(refused.body)) == (400, b"start = 1: too shallow\n")
        with pytest.raises(RuntimeError):
            await downloads.start(broken, "text/csv", "a.csv")
        assert downloads.running == 0

    asyncio.run(run())
