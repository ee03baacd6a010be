"""The viewer's scene and bytes: packing, halo, pending ranges, the overview, and that a page always ends up equal."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from golden_texts import Golden
from hypothesis import given, settings
from hypothesis import strategies as st
from page_protocol import Message, unpack

import helibore as hb
from helibore.viewer import Attribute, attributes_of, protocol
from helibore.viewer.client import MOST_PENDING, Client
from helibore.viewer.feed import Feed
from helibore.viewer.levels import TURNS
from helibore.viewer.protocol import BadMessageError, Subscription, read_subscription
from helibore.viewer.scene import PathFrames, Scene, WallShape
from helibore.viewer.texels import (
    CLIPPED,
    FIRST,
    INTERPOLATED,
    MOST_UNCERTAIN,
    NEAREST,
    NORMAL_95,
    PROVISIONAL,
    RADIUS,
    RESCANNED,
    STATE,
    SUPPORT_MASK,
    TEXEL,
    UNCERTAINTY,
    Vertices,
    pack_trust,
    pack_vertices,
    radius_of,
)
from helibore.wall.latest_pass import latest_pass

K = 8
SHAPE = WallShape(
    sectors=K, pitch=0.1, start_depth=100.0, bit_diameter=0.2, attributes=(Attribute("GR"), Attribute("RES"))
)


def begun(shape: WallShape = SHAPE) -> Scene:
    scene = Scene()
    scene.begin(shape)
    return scene


class Page:
    """What the page does with messages, in Python: the texels and columns of every tile it was sent."""

    def __init__(self, scene: Scene) -> None:
        self.scene, self.client = scene, Client(scene)
        scene.listeners.append(self.client.mark)
        self.tiles: dict[tuple[int, int], tuple[np.ndarray, np.ndarray]] = {}

    def drain(self) -> list[Message]:
        got = []
        while (raw := self.client.next_message()) is not None:
            message = unpack(raw)
            got.append(message)
            self.client.acknowledge(message.sequence)
            if message.kind == protocol.WRITE:
                self.apply(message)
        return got

    def apply(self, message: Message) -> None:
        level = self.scene.levels[message.level]
        size = level.tile_size + level.halo
        empty = np.zeros((size, TEXEL), np.uint16), np.full((2, size), np.nan, np.float32)
        texels, columns = self.tiles.setdefault((message.level, message.tile), empty)
        part = slice(message.first, message.first + message.count)
        texels[part] = message.texels
        for i, values in enumerate(message.columns):
            columns[i, part] = values

    def expected(self, level: int, tile: int) -> tuple[np.ndarray, np.ndarray]:
        store = self.scene.levels[level]
        start, size = tile * store.tile_size, store.tile_size + store.halo
        texels, columns = np.zeros((size, TEXEL), np.uint16), np.full((2, size), np.nan, np.float32)
        stop = min(start + size, store.size)
        texels[: stop - start] = store.texels[start:stop]
        columns[:, : stop - start] = [column[start:stop] for column in store.columns]
        return texels, columns


def test_a_radius_survives_packing_to_ten_micrometres() -> None:
    radius = np.array([0.1, 0.10801, np.nan, 0.65535, 0.7, 1e-9])
    nearest = np.array([0.0, 0.0123, np.nan, 5.0, 9.0, 0.00004])
    support = np.array([8, 300, 0, 1, 2, 3])
    texels = pack_vertices(Vertices(radius, nearest, support, np.array([0, 1, 0, 0, 0, 0], bool)), 1e-5)
    assert texels[:, RADIUS].tolist() == [10000, 10801, 0, 65535, 65535, 1]
    assert texels[:, NEAREST].tolist() == [0, 123, 65535, 50000, 65535, 0]
    assert (texels[:, STATE] & SUPPORT_MASK).tolist() == [8, 255, 0, 1, 2, 3]
    assert [bool(s & CLIPPED) for s in texels[:, STATE]] == [False, False, False, False, True, False]
    assert [bool(s & PROVISIONAL) for s in texels[:, STATE]] == [False, True, *[False] * 4]
    back = radius_of(texels, 1e-5)
    np.testing.assert_allclose(back[:2], radius[:2], atol=5e-6)
    assert np.isnan(back[2])


def test_every_array_of_a_message_is_aligned() -> None:
    for count in (1, 2, 3):
        assert protocol.HEAD.size % 8 == 0
        assert (protocol.HEAD.size + count * 2 * TEXEL) % 4 == 0


def test_a_write_across_a_seam_reaches_the_halo_of_the_tile_above() -> None:
    scene = begun()
    tile = scene.levels[0].tile_size
    scene.write(0, Vertices(np.full(2 * tile, 0.1)), {})
    page = Page(scene)
    page.client.subscribe(Subscription(((0, 2),), 0, 0b11))
    page.drain()
    scene.write(tile, Vertices(np.full(3, 0.12)), {})
    got = [m for m in page.drain() if m.level == 0]
    assert [(m.tile, m.first, m.count) for m in sorted(got, key=lambda m: m.tile)] == [(0, tile, 3), (1, 0, 3)]
    assert all(m.live for m in got)
    scene.write(tile + K + 1, Vertices(np.full(3, 0.12)), {})
    assert [m.tile for m in page.drain() if m.level == 0] == [1], "beyond the halo the tile above gets no message"


def test_new_quads_cost_sixteen_bytes_each_with_two_attributes() -> None:
    shape = WallShape(
        sectors=64, pitch=0.1, start_depth=0, bit_diameter=0.2, attributes=(Attribute("GR"), Attribute("RES"))
    )
    scene = begun(shape)
    scene.write(0, Vertices(np.full(100_000, 0.1)), {})
    page = Page(scene)
    page.client.subscribe(Subscription(((0, 10),), 6, 0b11))
    page.drain()
    scene.write(100_000, Vertices(np.full(1000, 0.1)), {})
    sent = []
    while (raw := page.client.next_message()) is not None:
        sent.append(len(raw))
    assert sum(sent) <= 17_500


def test_the_first_pass_is_kept_and_a_rescan_marked() -> None:
    scene = begun()
    scene.write(0, Vertices(np.array([0.1, 0.1, np.nan, 0.1])), {})
    scene.write(1, Vertices(np.array([0.11])), {})  # not settled yet: the first pass follows
    scene.settle(3)
    scene.write(0, Vertices(np.array([0.1, 0.12, 0.13, 0.14])), {})
    texels = scene.levels[0].texels[:4]
    assert texels[:, FIRST].tolist() == [10000, 11000, 13000, 14000]
    assert [bool(s & RESCANNED) for s in texels[:, STATE]] == [False, True, False, False]


def test_what_is_already_so_is_not_sent_again() -> None:
    scene = begun()
    rng = np.random.default_rng(4)
    radius, gamma = rng.uniform(0.09, 0.12, 3000), np.where(rng.random(3000) < 0.3, np.nan, rng.uniform(0, 150, 3000))
    radius[500:600] = np.nan
    scene.write(0, Vertices(radius), {"GR": gamma})
    page = Page(scene)
    page.client.subscribe(Subscription(((0, 10),), 0, 0b11))
    page.drain()
    woken = []
    scene.on_change = lambda: woken.append(1)
    scene.write(0, Vertices(radius), {"GR": gamma})
    assert page.drain() == []
    assert woken == []
    radius[[1200, 1210]] += 0.001
    gamma[1220] = 151.0
    scene.write(0, Vertices(radius), {"GR": gamma})
    assert [(m.tile, m.first, m.count) for m in page.drain() if m.level == 0] == [(0, 1200, 21)]
    assert woken == [1]
    scene.write(2990, Vertices(np.full(20, np.nan)), {})
    new = [(m.first, m.count, m.total) for m in page.drain() if m.level == 0]
    assert new == [(2990, 20, 3010)], "a vertex without a radius is new where there was no vertex"


@settings(max_examples=25, deadline=None)
@given(st.lists(st.tuples(st.floats(0, 1), st.integers(1, 4000), st.booleans(), st.integers(0, 2)), max_size=8))
def test_a_page_ends_up_equal_to_the_scene(steps: list[tuple[float, int, bool, int]]) -> None:
    """Whatever is written where, and whenever the page reads, in the end every tile it holds is the scene's."""
    scene, rng = begun(), np.random.default_rng(1)
    scene.write(0, Vertices(rng.uniform(0.09, 0.12, 500)), {"GR": rng.uniform(0, 150, 500)})
    page = Page(scene)
    held = ((0, 2), (3, 5))
    page.client.subscribe(Subscription(held, 0, 0b11))
    for share, count, reads, focus in steps:
        first = int(share * scene.levels[0].size)
        radius = np.where(rng.random(count) < 0.1, np.nan, rng.uniform(0.09, 0.12, count))
        scene.write(first, Vertices(radius), {"GR": rng.uniform(0, 150, count)})
        page.client.subscribe(Subscription(held, focus, 0b11))
        if reads:
            page.drain()
    page.drain()
    for (level, tile), (texels, columns) in page.tiles.items():
        want_texels, want_columns = page.expected(level, tile)
        np.testing.assert_array_equal(texels, want_texels)
        np.testing.assert_array_equal(columns, want_columns)
    last = -(-scene.levels[0].size // scene.levels[0].tile_size)
    assert {t for level, t in page.tiles if level == 0} >= {t for t in (0, 1, 3, 4) if t < last}


def test_a_stalled_page_costs_intervals_not_messages() -> None:
    scene = begun()
    page = Page(scene)
    page.client.subscribe(Subscription(((0, 1000),), 0, 0b11))
    for first in range(0, 200_000, 400):
        scene.write(first, Vertices(np.full(400, 0.1)), {})
    kept = sum(len(intervals) for intervals in page.client.pending.values())
    assert kept <= MOST_PENDING * len(page.client.pending)
    assert len(page.client.pending) <= 200_000 // scene.levels[0].tile_size + 3
    sent = 0
    while (raw := page.client.next_message()) is not None:
        sent += len(raw)
    assert sent < 2 * (1 << 20), "without acknowledgements nothing beyond the room is sent"


def test_the_tile_looked_at_comes_first_and_the_overview_before_the_far_ones() -> None:
    scene = begun()
    tile = scene.levels[0].tile_size
    scene.write(0, Vertices(np.full(20 * tile, 0.1)), {})
    page = Page(scene)
    page.client.subscribe(Subscription(((0, 20),), 12, 0b11))
    order = [(m.level, m.tile) for m in page.drain()]
    assert order[0] == (0, 12)
    assert {t for level, t in order[:9] if level == 0} == set(range(8, 17))
    assert order[9][0] == 1
    assert list(page.drain()) == []


def test_frames_are_sent_whole_and_then_only_what_changed(golden: Golden) -> None:
    scene = begun()
    rng = np.random.default_rng(3)
    scene.set_frames(0, PathFrames(*rng.normal(size=(3, 9000, 3))))
    page = Page(scene)
    assert [(m.first, m.count) for m in page.drain()] == [(0, 4096), (4096, 4096), (8192, 808)]
    scene.set_frames(8990, PathFrames(*rng.normal(size=(3, 20, 3))))
    (message,) = page.drain()
    assert (message.first, message.count, message.total) == (8990, 20, 9010)
    np.testing.assert_array_equal(message.centre, scene.frames.centre[8990:])
    np.testing.assert_array_equal(message.directions[:, 3:], scene.frames.right[8990:].astype(np.float32))
    with golden.raises():
        scene.set_frames(9011, PathFrames(*rng.normal(size=(3, 1, 3))))


def slow_cell(scene: Scene, R: int, C: int) -> tuple[float, float, int, int]:
    """Mean radius, mean attribute, largest distance, smallest support of overview cell (R, C), vertex by vertex."""
    level, over = scene.levels
    radii, values, nearest, support = [], [], [0], [255]
    for k in range(R * TURNS * level.sectors, min((R + 1) * TURNS * level.sectors, level.size)):
        if k % level.sectors * over.sectors // level.sectors != C:
            continue
        texel = level.texels[k]
        nearest.append(int(texel[NEAREST]))
        support.append(int(texel[STATE]) & 255)
        if texel[RADIUS]:
            radii.append(int(texel[RADIUS]))
        if np.isfinite(level.columns[0][k]):
            values.append(float(level.columns[0][k]))
    return np.mean(radii) if radii else 0.0, np.mean(values) if values else np.nan, max(nearest), min(support)


@pytest.mark.parametrize("sectors", [5, 8, 16, 36, 64])
def test_the_overview_is_the_mean_of_its_blocks(sectors: int) -> None:
    scene = begun(
        WallShape(sectors=sectors, pitch=-0.1, start_depth=0, bit_diameter=0.2, attributes=(Attribute("GR"),))
    )
    rng = np.random.default_rng(sectors)
    n = sectors * 70 + 3
    radius = np.where(rng.random(n) < 0.2, np.nan, rng.uniform(0.09, 0.13, n))
    radius[sectors * 30 : sectors * 55] = np.nan
    values = {"GR": np.where(rng.random(n) < 0.1, np.nan, rng.uniform(0, 150, n))}
    for first in range(0, n, 777):  # in pieces: what a write can change must be recomputed
        part = slice(first, first + 777)
        scene.write(first, Vertices(radius[part], rng.uniform(0, 1, len(radius[part]))), {"GR": values["GR"][part]})
    over = scene.levels[1]
    assert over.size == 5 * min(8, sectors)  # 70 turns and a part of the next are five rings
    for j in range(over.size):
        mean, value, nearest, support = slow_cell(scene, j // over.sectors, j % over.sectors)
        texel = over.texels[j]
        assert abs(int(texel[RADIUS]) - mean) <= 1, j
        np.testing.assert_allclose(over.columns[0][j], value, rtol=1e-6, equal_nan=True)
        assert (int(texel[NEAREST]), int(texel[STATE])) == (nearest, support), j


def test_a_washout_all_around_the_hole_is_level_in_the_overview() -> None:
    scene = begun(WallShape(sectors=64, pitch=0.1, start_depth=0, bit_diameter=0.2))
    depth = np.arange(64 * 320) * 0.1 / 64
    scene.write(0, Vertices(np.where((depth > 16.2) & (depth < 17.4), 0.12, 0.1)), {})
    rings = scene.levels[1].texels[:, RADIUS].reshape(-1, 8)[:20]
    assert np.flatnonzero((rings > 10_100).any(axis=1)).tolist() == [10]
    assert np.ptp(rings[10]) < 200, "every sector of the ring has the same share of it, but for the helix's own slope"


@pytest.mark.parametrize(
    "wrong",
    [
        {"sectors": 2},
        {"pitch": 0.0},
        {"bit_diameter": -1.0},
        {"attributes": (Attribute("GR"), Attribute("GR"))},
        {"attributes": tuple(Attribute(str(i)) for i in range(17))},
    ],
)
def test_a_helix_that_cannot_be_drawn_is_refused(wrong: dict[str, object], golden: Golden) -> None:
    good: dict[str, object] = {"sectors": 64, "pitch": 0.1, "start_depth": 0.0, "bit_diameter": 0.2}
    with golden.raises():
        WallShape(**(good | wrong))  # type: ignore[arg-type]


@pytest.mark.parametrize("ends", [(np.nan, 1.0), (None, np.inf), (2.0, 1.0), (1.0, 1.0), (0.0, 1.0)])
def test_colours_between_no_two_values_are_refused(ends: tuple[float | None, float]) -> None:
    rule = "must be finite, low below high, and above 0 if log"
    with pytest.raises(ValueError, match=rf"^attribute RES: \(low, high\) = \({ends[0]}, {ends[1]}\): {rule}$"):
        Attribute("RES", "ohm.m", *ends, log=True)


def test_a_colour_map_of_the_viewer_must_be_known(golden: Golden) -> None:
    with golden.raises():
        Attribute("GR", color_map="jet")


def test_writes_that_make_no_sense_are_refused(golden: Golden) -> None:
    scene = begun()
    with golden.raises():
        scene.write(-1, Vertices(np.ones(1)), {})
    with golden.raises():
        scene.write(0, Vertices(np.ones(1)), {"XX": np.ones(1)})


@pytest.mark.parametrize(
    "said",
    [
        7,
        {"tiles": [[0, 1]] * 65},
        {"tiles": [[3, 2]]},
        {"tiles": [[0, True]]},
        {"tiles": [], "focus": -1},
        {"tiles": [], "focus": 0, "mask": 4},
    ],
)
def test_a_bad_subscription_is_named(said: object, golden: Golden) -> None:
    with pytest.raises(BadMessageError) as caught:
        read_subscription(said, 2)
    golden(str(caught.value))


def test_only_vertices_whose_mark_changes_are_sent_again_as_interpolated() -> None:
    scene = begun()
    rows = 4 * TURNS
    scene.write(0, Vertices(np.full(rows * K, 0.1)), {})
    page = Page(scene)
    page.client.subscribe(Subscription(((0, 1),), 0, 0))
    page.drain()
    marks = np.zeros(rows * K, bool)
    marks[3 * K : 30 * K] = True  # most of ring 0 (13 of 16 turns), 14 of 16 of ring 1
    marks[31 * K] = True
    scene.set_trust(marks)
    sent = [message for message in page.drain() if message.level == 0]
    assert [(message.first, message.count) for message in sent] == [(3 * K, 28 * K + 1)]
    assert not any(message.live for message in sent), "no data came"
    wall, over = scene.levels
    np.testing.assert_array_equal((wall.texels[: wall.size, STATE] & INTERPOLATED) > 0, marks)
    rings = (over.texels[: over.size, STATE] & INTERPOLATED > 0).reshape(4, -1)
    assert rings.all(axis=1).tolist() == [True, True, False, False]
    assert not rings[2:].any()
    scene.set_trust(marks)
    assert page.drain() == []
    scene.write(4 * K, Vertices(np.full(K, 0.11)), {})
    assert (wall.texels[4 * K : 5 * K, STATE] & INTERPOLATED).all(), "a new radius keeps the mark"
    assert [message.live for message in page.drain() if message.level == 0] == [True]


def test_the_uncertainty_of_a_radius_is_a_level_that_keeps_still_while_it_hardly_changes() -> None:
    half_width = np.array([0.1, 0.5, 1.0, 4.0, 16.0, 200.0, np.nan]) / 1000
    levels = pack_trust(np.zeros(7, bool), half_width / NORMAL_95) >> UNCERTAINTY
    assert levels.tolist() == [1, 2, 4, 8, 12, MOST_UNCERTAIN, 0]
    scene = begun()
    rows = 2 * TURNS
    scene.write(0, Vertices(np.full(rows * K, 0.1)), {})
    page = Page(scene)
    page.client.subscribe(Subscription(((0, 1),), 0, 0))
    page.drain()
    sigma = np.full(rows * K, 0.001 / NORMAL_95)
    none = np.zeros(rows * K, bool)
    scene.set_trust(none, sigma)
    assert page.drain()
    wall, over = scene.levels
    assert set((wall.texels[: wall.size, STATE] >> UNCERTAINTY).tolist()) == {4}
    scene.set_trust(none, 1.4 * sigma)
    assert page.drain() == [], "one level"
    sigma[K] *= 4
    scene.set_trust(none, sigma)
    assert [(message.first, message.count) for message in page.drain() if message.level == 0] == [(K, 1)]
    assert int(over.texels[: over.size, STATE].max()) >> UNCERTAINTY == 8, "the largest of its vertices"


def test_a_wall_that_is_drawn_again_with_other_settings_keeps_its_page_and_is_not_rescanned() -> None:
    depth = np.arange(2000.0, 2004.0, 0.01)
    radius = 0.108 + 0.004 * np.sin(depth * 900)
    wall = hb.Wall(bit_diameter=0.216, start_depth=2000.0, sectors=8)
    wall.append(depth, depth * 9000 % 360, radius)
    feed = Feed(wall, path=None, attributes={}, well="")
    scene, session = feed.scene, feed.scene.session
    before = scene.levels[0].texels[: len(wall), RADIUS].copy()
    wall._redraw(replace(wall.settings, estimator="kriging", kriging_range=0.2))
    feed._read([(0, 1)], wall.settled)
    texels = scene.levels[0].texels[: len(wall)]
    assert (texels[:, RADIUS] != before).mean() > 0.5
    np.testing.assert_allclose(radius_of(texels, scene.shape.radius_unit), wall.radius, atol=scene.shape.radius_unit)
    assert not (texels[:, STATE] & RESCANNED).any()
    assert scene.session == session
    wall.append(depth + 0.001, depth * 9000 % 360, radius + 0.002)
    feed._read([(0, len(wall))], wall.settled)
    assert (scene.levels[0].texels[: len(wall), STATE] & RESCANNED).any(), "a later pass is one"


def test_a_live_page_shows_reamed_hole_by_its_last_scan() -> None:
    depth = np.arange(2000.0, 2012.0, 0.004)
    narrow = abs(depth - 2006) < 1
    wall = hb.Wall(bit_diameter=0.216, start_depth=2000.0, max_distance=0.5)
    wall.append(depth, depth * 9000 % 360, np.where(narrow, 0.103, 0.1085), depth - 2000)
    feed = Feed(wall, path=None, attributes={}, well="", last_scan=latest_pass)
    feed._find_zones()
    assert feed._ranges == [], "nothing was scanned again"
    again = abs(depth - 2006) < 2
    wall.append(depth[again] + 1e-3, depth[again] * 9000 % 360, np.where(narrow, 0.107, 0.1085)[again], depth[again])
    feed._read([(0, len(wall))], wall.settled)
    feed._find_zones()
    feed._read(feed._ranges, wall.settled)
    scene, place = feed.scene, abs(wall.depth - 2006) < 0.7
    shown = radius_of(scene.levels[0].texels[: len(wall)], scene.shape.radius_unit)
    np.testing.assert_allclose(shown[place], 0.107, atol=scene.shape.radius_unit)
    assert np.median(wall.radius[place]) < 0.106
    np.testing.assert_allclose(shown[wall.depth < 2003], 0.1085, atol=scene.shape.radius_unit)
    assert feed._summarize(2005.3, 2006.7)["least_diameter"] == pytest.approx(0.214, abs=1e-4)
    feed._ranges = []
    feed._find_zones()
    assert feed._ranges == [], "what is shown is not read again and again"


def test_the_interval_of_a_key_seat_reaches_what_its_samples_show() -> None:
    """Four arms each 0.2 m in a slot of 30 mm that is narrower than the gaps between them: the wall has half of it."""
    draw = np.random.default_rng(0)
    depth = np.repeat(np.arange(2000.0, 2012.0, 0.2), 4)
    toolface = (np.repeat(draw.uniform(0, 360, depth.size // 4), 4) + 90 * np.arange(depth.size)) % 360
    across = np.clip(1 - (((toolface + 90) % 360 - 180) / 20) ** 2, 0, None)
    slot = np.where(abs(depth - 2006) < 3, 0.03 * np.sqrt(across), 0.0)
    radius = 0.1085 + slot + draw.normal(0, 0.0005, depth.size)
    wall = hb.reconstruct(hb.Caliper(depth, toolface, radius), bit_diameter=0.216, estimator="inverse-distance")
    feed = Feed(wall, path=None, attributes={}, well="")
    feed.find_zones()
    zone = max(feed.scene.state.zones, key=lambda of: float(of["stop"]) - float(of["start"]))
    assert zone["kind"] == "key seat"
    assert zone["measure"] < 0.02
    assert zone["measure"] + zone["within"] == pytest.approx(0.03, abs=0.002)


def test_a_wall_says_how_sure_its_radii_and_its_zones_are() -> None:
    depth = np.arange(2000.0, 2012.0, 0.002)
    radius = np.where(abs(depth - 2006) < 1, 0.128, 0.108)
    wall = hb.reconstruct(hb.Caliper(depth, depth * 9000 % 360, radius), bit_diameter=0.216)
    feed = Feed(wall, path=None, attributes={}, well="")
    feed.find_zones()
    scene = feed.scene
    (zone,), (own,) = scene.state.zones, wall.zones().zones
    assert (zone["confidence"], zone["measured"]) == (round(own.confidence, 6), round(own.coverage, 3))
    levels = scene.levels[0].texels[: len(wall), STATE] >> UNCERTAINTY
    known = np.isfinite(wall.sigma)
    assert known.mean() > 0.9
    assert ((levels > 0) == known).all()


def test_a_string_has_its_clearance_at_each_depth_of_its_lower_end() -> None:
    depth = np.arange(2000.0, 2012.0, 0.002)
    radius = np.where(abs(depth - 2006) < 0.5, 0.104, 0.108)
    wall = hb.reconstruct(hb.Caliper(depth, depth * 9000 % 360, radius), bit_diameter=0.216)
    string = (hb.RigidBody(0.2, 1.0), hb.RigidBody(0.17, 2.0, 1.0))
    feed = Feed(wall, path=None, attributes={}, well="", string=string)
    feed.find_zones()
    scene = feed.scene
    assert scene.state.string == {"bodies": [[0.2, 1.0, 0.0], [0.17, 2.0, 1.0]], "why": ""}
    own = wall.passage(string, sigma=True)
    lower = own.depth + 1.5
    for name, values in (("Clearance", own.clearance), ("Clearance low", own.low), ("Clearance high", own.high)):
        inside = np.isfinite(own.clearance) | (lower < 2005)
        np.testing.assert_array_equal(scene.curves[name].depth[: inside.sum()], lower[inside])
        np.testing.assert_array_equal(scene.curves[name].values[: inside.sum()], values[inside])
        end = wall.depth[-1]
        assert lower[inside][-1] < end - 0.1, "the last turns of the library lack a place of the string"
        assert scene.curves[name].depth[-1] == end
        last = scene.curves[name].values[-1]
        assert last == pytest.approx(values[inside][-1], abs=1e-4), "the page has it to the end of the wall"
    at = int(np.nanargmin(own.clearance))
    assert own.clearance[at] == pytest.approx(0.008, abs=1e-3)
    tightest = lower[at] - scene.curves["Tightest above bit"].values[at]
    assert tightest == own.contact_depth[at, 0]
    assert abs(tightest - 2006) < 0.7


def test_a_string_has_its_clearance_beside_a_last_turn_that_is_not_whole() -> None:
    depth = np.arange(2000.0, 2012.06, 0.0005)
    radius = np.where(depth > 2011.94, 0.099, 0.108)
    wall = hb.reconstruct(hb.Caliper(depth, depth * 9000 % 360, radius), bit_diameter=0.216, sectors=64, pitch=0.1)
    assert wall.radius.size % 64
    feed = Feed(wall, path=None, attributes={}, well="", string=(hb.RigidBody(0.2, 0.3),))
    feed.find_zones()
    assert feed.scene.curves["Clearance"].depth[-1] == wall.depth[-1]
    assert feed.scene.curves["Clearance"].values[-1] == pytest.approx(-0.002, abs=2e-4)


def test_each_body_of_the_string_clears_what_the_wall_says_as_far_as_it_is_measured() -> None:
    depth = np.arange(2000.0, 2030.0, 0.002)
    radius = 0.108 + 0.001 * np.sin(depth) - 0.004 * (abs(depth - 2012) < 0.5)
    wall = hb.reconstruct(hb.Caliper(depth, depth * 9000 % 360, radius), bit_diameter=0.216)
    bodies = hb.RigidBody(0.216, 0.3), hb.RigidBody(0.2, 1.0, 4.0, "stabiliser"), hb.RigidBody(0.17, 8.0, 1.0, "collar")
    feed = Feed(wall, path=None, attributes={}, well="", string=bodies)

    def hanging(bit: float) -> list[dict[str, Any]]:
        feed.scene.update_state(bit_depth=bit)
        feed.find_clearance_of_bodies()
        state = feed.scene.state.string
        assert state is not None
        return state["hanging"]

    feed.find_zones()
    stabiliser = wall.passage([hb.RigidBody(0.2, 1.0)], sigma=True)
    row = int(np.nanargmin(stabiliser.clearance))
    found = hanging(float(stabiliser.depth[row]) + 4.5)
    assert [of["name"] for of in found] == ["bit", "stabiliser", "collar"]
    assert (found[1]["at_most"], found[1]["short"]) == (False, 0)
    assert found[1]["clearance"] == pytest.approx(stabiliser.clearance[row], abs=1e-5)
    assert found[1]["depth"] == pytest.approx(stabiliser.contact_depth[row, 0], abs=0.1), "within a turn: without noise"
    assert [found[1]["low"], found[1]["high"]] == pytest.approx([stabiliser.low[row], stabiliser.high[row]], abs=3e-4)
    bit = wall.drift(0.3)  # in wider hole below, where the stabiliser does not hide it
    row = int(np.argmin(abs(bit.depth - stabiliser.depth[row] - 4.35)))
    assert found[0]["clearance"] == pytest.approx(bit.diameter[row] - 0.216, abs=2e-4)
    end = float(wall.depth[-1])
    found = hanging(end + 6.5)
    assert [of["short"] for of in found] == pytest.approx([6.5, 2.5, 5.5], abs=0.01)
    assert found[1]["clearance"] == hanging(end + 4.0)[1]["clearance"]
    assert hanging(1995.0) == [{"name": "bit"}, {"name": "stabiliser"}, {"name": "collar"}]


@pytest.mark.parametrize("noise", [0.0005, 0.0015, 0.003])
def test_noise_does_not_narrow_the_clearance_of_a_body(noise: float) -> None:
    """A stabiliser clears 5.3 mm of a hole of 218 mm, and sticks by 2.7 mm in a meter of 210 mm."""
    draw = np.random.default_rng(5)
    depth = np.arange(2000.0, 2030.0, 1 / 640)
    radius = 0.109 - 0.004 * (abs(depth - 2022) < 1) + draw.normal(0, noise, depth.size)
    wall = hb.reconstruct(hb.Caliper(depth, np.arange(depth.size) * 22.2 % 360, radius), bit_diameter=0.2159)
    feed = Feed(wall, path=None, attributes={}, well="", string=[hb.RigidBody(0.2127, 1.0, name="stabiliser")])
    feed.find_zones()
    missed = []
    for bit in np.arange(2002.0, 2020.0, 0.5):
        found = feed._hanging(0, float(bit))
        missed.append(not found["low"] < 0.0053 < found["high"])
        assert found["clearance"] > -0.0005
    assert np.mean(missed) < 0.12
    inside = feed._hanging(0, 2022.6)
    assert inside["low"] < -0.0027 < inside["high"]
    assert inside["clearance"] < -0.001


def test_a_string_longer_than_the_wall_is_drawn_and_says_why_it_has_no_clearance() -> None:
    depth = np.arange(2000.0, 2004.0, 0.002)
    wall = hb.reconstruct(hb.Caliper(depth, depth * 9000 % 360, 0.108 + 0 * depth), bit_diameter=0.216)
    feed = Feed(wall, path=None, attributes={}, well="", string=[hb.RigidBody(0.2, 30.0)])
    feed.find_zones()
    state = feed.scene.state.string
    assert state is not None
    assert state["bodies"] == [[0.2, 30.0, 0.0]]
    assert state["why"].startswith("length of the string = 30: must be shorter than the wall, ")
    assert "Clearance" not in feed.scene.curves
    assert "C1" in feed.scene.curves, "the rest is there"


def test_sigma_has_the_colours_of_the_print() -> None:
    depth = np.arange(2000.0, 2004.0, 0.004)
    wall = hb.reconstruct(
        hb.Caliper(depth, depth * 9000 % 360, 0.108 + 0.0004 * np.sin(7e3 * depth)), bit_diameter=0.216, sectors=16
    )
    wall.attributes["sigma"], wall.attributes.units["sigma"] = np.linspace(0.0001, 0.0042, len(wall) - 17), "m"
    (sigma,) = [of for of in attributes_of(wall) if isinstance(of, Attribute)]
    assert (sigma.name, sigma.low, sigma.color_map) == ("sigma", 0.0, "viridis")
    assert sigma.high == pytest.approx(0.0042, abs=1e-4)
