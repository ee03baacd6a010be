"""Rows of a live image: with a step, later rows replace earlier ones, whatever pieces they come in."""

from __future__ import annotations

import numpy as np
import pytest
from live_wires import SENT, Clock

from helibore import Live
from helibore.live.model.image_rows import ImageRows, sorted_rows
from helibore.live.rules.configuration import parse


@pytest.mark.parametrize("pieces", [1, 7, 500])
def test_the_latest_row_of_each_step_is_kept_whatever_the_pieces(pieces):
    draw = np.random.default_rng(2)
    depth, values = draw.uniform(100, 110, 5000).round(3), draw.normal(size=(5000, 3))
    rows = ImageRows(3, "gAPI", 0.05)
    for at in range(0, 5000, pieces):
        assert rows.append(depth[at : at + pieces], values[at : at + pieces])[0] == at
    slow = {int(one / 0.05): number for number, one in enumerate(depth.tolist())}
    expected = [slow[step] for step in sorted(slow)]
    found = rows.arrays()
    assert found[0].tolist() == depth[expected].tolist()
    assert found[1].tolist() == values[expected].tolist()
    assert np.array_equal(found[0], sorted_rows(depth, values, 0.05)[0])
    assert len(rows) == 5000
    assert len(rows.so_far()[0]) <= 2 * (len(slow) + pieces)
    newest = rows.rows(4990, 5000)
    last = [number for number in expected if number >= 4990]
    assert set(depth[last].tolist()) <= set(newest[0].tolist())


def test_without_a_step_all_rows_are_kept():
    rows = ImageRows(2, "gAPI")
    for number in range(300):
        rows.append(np.array([100.0]), np.full((1, 2), float(number)))
    assert rows.rows(0, 300)[1][:, 0].tolist() == list(range(300))
    assert rows.arrays()[1].tolist() == [[299.0, 299.0]]


def test_a_step_that_changes_does_not_depend_on_the_pieces():
    draw = np.random.default_rng(3)
    depth, values = draw.uniform(100, 101, 400), draw.normal(size=(400, 2))
    found = []
    for pieces in (1, 200):
        rows = ImageRows(2, "gAPI", 0.1)
        for at in range(0, 400, pieces):
            if at == 200:
                rows.set_step(0.0)
            rows.append(depth[at : at + pieces], values[at : at + pieces])
        found.append(rows.arrays())
    assert np.array_equal(found[0][0], found[1][0])
    assert np.array_equal(found[0][1], found[1][1])


def test_a_tool_that_images_at_one_depth_does_not_fill_the_memory_and_a_restart_has_the_same_rows(tmp_path):
    text, clock = SENT + "[samples]\nmost = 64\nimage_step = 0.01\n", Clock()
    with Live(parse(text), tmp_path, clock=clock) as live:
        for number in range(200):
            clock.step(1)
            live.append_image("X", [101.0 + number % 7 * 0.001], np.full((1, 4), float(number)))
            live.append_samples([101.0 + number % 3 * 0.001], [number % 5], [0.11])
        assert len(live.images["X"]) == 200
        assert len(live.images["X"].so_far()[0]) < 10
        assert live.wall.sample_count == 8  # of one part of a cell
        live.checkpoint()
    with Live(parse(text), tmp_path, clock=clock) as again:
        assert again.append_image("X", [103.0], np.zeros((1, 4))).images == {"X": (200, 201)}
        assert again.images["X"].arrays()[1].tolist() == [[199.0] * 4, [0.0] * 4]
        assert again.wall.sample_count == live.wall.sample_count
    assert Live.replay(tmp_path).images["X"].arrays()[1].tolist() == [[199.0] * 4, [0.0] * 4]
