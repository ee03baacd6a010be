"""Hatch, coverage, zones, summary, volumes, meshes, print, report and page read one mask of measured vertices."""

from __future__ import annotations

import numpy as np
import pytest
from made_wall import BIT

import helibore as hb
from helibore.logs.volume_ticks import volume_ticks
from helibore.plot.content import Drawing, ImageTrack, content_of
from helibore.plot.print_header import measured_text
from helibore.viewer.feed import Feed
from helibore.viewer.scene import INTERPOLATED, STATE
from helibore.wall.interpolation import measured_quads

SECTORS = 32
SAMPLED = 2


def washed_out() -> hb.Wall:
    depth = np.arange(1000.0, 1008.0, 0.1 / 48)
    toolface = depth * 3600 % 360
    radius = BIT / 2 + 0.02 * (np.abs(depth - 1004) < 1.5)
    return hb.reconstruct(hb.Caliper(depth, toolface, radius), bit_diameter=BIT, sectors=SECTORS)


def test_every_output_reads_the_mask_of_the_wall() -> None:
    wall = washed_out()
    turns = len(wall) // SECTORS
    rng = np.random.default_rng(5)
    chance = np.repeat(rng.uniform(0.5, 1, turns + 1), SECTORS)[: len(wall)]  # each turn has a share of its own
    marks = np.where(rng.random(len(wall)) < chance, 1, SAMPLED).astype(np.uint8)
    wall._state().kept.marks = marks
    share = (marks == 1)[: turns * SECTORS].reshape(turns, SECTORS).mean(axis=1)

    np.testing.assert_array_equal(wall.measured, marks == 1)
    logs, found = wall.logs(), wall.zones()
    np.testing.assert_allclose(logs.coverage, share)
    np.testing.assert_allclose(found.logs.coverage, share)
    (zone,) = found.zones
    inside = (logs.depth > zone.start) & (logs.depth < zone.stop)
    assert zone.coverage == pytest.approx(share[inside].mean())
    assert wall.summary().coverage == pytest.approx(share.mean())
    assert logs.by_step(2.0).coverage[1] == pytest.approx(share[(logs.depth > 1002) & (logs.depth < 1004)].mean())
    assert volume_ticks(logs, 0.1).coverage == pytest.approx(share.mean())

    quads = measured_quads(wall._state())
    corners = [(marks == 1)[first : first + quads.size] for first in (0, 1, SECTORS, SECTORS + 1)]
    np.testing.assert_array_equal(quads, np.all(corners, axis=0))

    content = content_of(wall, Drawing())
    (hatch,) = (track.interpolated for track in content.tracks if isinstance(track, ImageTrack))
    np.testing.assert_array_equal(hatch, marks != 1)
    assert f"{100 * share.mean():.0f}" in measured_text(content)

    feed = Feed(wall, path=None, attributes={}, well="")
    feed.find_zones()
    level = feed.scene.levels[0]
    on_page = (level.texels[: level.size, STATE] & INTERPOLATED) > 0
    np.testing.assert_array_equal(on_page, (marks != 1)[: level.size])
