"""Many appends one after another: what they must not change or cost, also in a forked process."""

from __future__ import annotations

import os
import signal
import threading
from pathlib import Path

import numpy as np
import pytest

import helibore as hb


def _rows(count: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    depth = np.arange(count) * 0.001
    return depth, depth * 3000.0 % 360.0, np.full(count, 0.108)


def _streamed(count: int, batch: int, threads: int = 2) -> hb.Wall:
    depth, toolface, radius = _rows(count)
    wall = hb.Wall(bit_diameter=0.216, start_depth=0.0, threads=threads)
    for first in range(0, count, batch):
        part = slice(first, first + batch)
        wall.append(depth[part], toolface[part], radius[part])
    return wall


@pytest.mark.skipif(not hasattr(os, "fork"), reason="this system cannot fork")
@pytest.mark.filterwarnings("ignore:.*fork:DeprecationWarning")
def test_a_forked_process_with_threads_of_its_own_may_use_and_drop_a_wall() -> None:
    depth, toolface, radius = _rows(160_000)
    for further in (100_000, 1_000):  # one batch that starts threads, and a short one
        wall = _streamed(1_000, 50)
        wall.append(depth[1_000:60_000], toolface[1_000:60_000], radius[1_000:60_000])
        child = os.fork()
        if child == 0:
            signal.alarm(60)  # it must not wait for ever
            threading.Thread(target=threading.Event().wait, daemon=True).start()
            wall.append(depth[60_000:][:further], toolface[60_000:][:further], radius[60_000:][:further])
            del wall
            os._exit(0)
        assert os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == 0


@pytest.mark.skipif(not Path("/proc/self/statm").exists(), reason="needs /proc to know the memory held")
@pytest.mark.parametrize("batch", [600, 4_096, 5_000, 6_145])
def test_a_streamed_wall_holds_little_more_than_its_samples(batch: int) -> None:
    def held() -> int:
        return int(Path("/proc/self/statm").read_text().split()[1]) * os.sysconf("SC_PAGESIZE")

    count = 100 * batch
    rows = _rows(count)
    before = held()
    wall = hb.Wall(bit_diameter=0.216, start_depth=0.0, sectors=3, pitch=1.0, threads=2)
    for first in range(0, count, batch):
        wall.append(*(column[first : first + batch] for column in rows))
    assert held() - before < 48 * count + (8 << 20)


def test_a_toolface_of_minus_zero_is_zero_however_the_rows_are_shared_out() -> None:
    for count, threads in ((1_024, 1), (1_024, 2), (70_000, 2)):
        depth, toolface, radius = _rows(count)
        toolface[3], toolface[-1] = -0.0, -10.0
        wall = _streamed(2_000, 100, threads)
        wall.append(depth + 3.0, toolface, radius)
        assert not np.signbit(wall.samples.toolface).any()


def test_streamed_appends_end_with_the_bits_of_one() -> None:
    whole = hb.Wall(bit_diameter=0.216, start_depth=0.0, threads=1)
    whole.append(*_rows(40_000))
    for threads in (1, 2, 5):
        for batch in (100, 512, 1_000):
            wall = _streamed(40_000, batch, threads)
            assert wall.radius.tobytes() == whole.radius.tobytes()
            assert wall.nearest.tobytes() == whole.nearest.tobytes()
