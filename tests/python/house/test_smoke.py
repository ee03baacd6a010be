"""Seconds: the installed package does what its front page says. Also the test of a wheel:

python -m pytest -p no:cacheprovider test_smoke.py        # from any folder, with nothing but pytest beside it
"""

from __future__ import annotations

import os
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest
from patience import PATIENCE

import helibore as hb

LAW_OF_IMPORT = """
import sys
import numpy
before = set(sys.modules)
import helibore
print(*sorted({name.partition(".")[0] for name in set(sys.modules) - before}))
"""


def run(code: str) -> str:
    return subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout


def test_reconstructs_a_round_hole() -> None:
    k = np.arange(4000)
    caliper = hb.Caliper(depth=1000.0 + k * 0.001, toolface=k * 37.0, radius=np.full(4000, 0.11))
    wall = hb.reconstruct(caliper, bit_diameter=0.216, sectors=32)
    assert len(wall) == 1280
    assert np.all(wall.radius == 0.11)
    change = wall.append([1010.0], [0.0], [0.12])
    assert change.ranges[-1, 1] == len(wall) == 3201
    assert np.isnan(wall.radius[2000])


def test_places_and_saves_it(tmp_path: Path) -> None:
    survey = hb.Survey(depth=[0.0, 900.0, 1100.0], inclination=[0.0, 30.0, 45.0], azimuth=[0.0, 40.0, 60.0])
    k = np.arange(2000)
    wall = hb.reconstruct(hb.Caliper(1000.0 + k * 0.001, k * 37.0, np.full(2000, 0.11)), bit_diameter=0.216)
    surface = wall.surface(path=survey.path())
    assert surface.vertices.shape == (len(wall), 3)
    assert surface.quads.shape == (len(wall) - 65, 4)
    surface.save(tmp_path / "well.glb")
    assert (tmp_path / "well.glb").read_bytes()[:4] == b"glTF"
    assert wall.volume(path=survey.path(), shells=[0.05, 0.2]).vertices.shape == (3 * len(wall), 3)


def test_says_what_is_wrong() -> None:
    with pytest.raises(ValueError, match=r"^toolface\[1\] = nan: must be finite$"):
        hb.Caliper([1.0, 2.0], [0.0, np.nan], [0.1, 0.1])


def test_command_line() -> None:
    done = subprocess.run([sys.executable, "-m", "helibore", "--version"], capture_output=True, text=True, check=True)
    assert hb.__version__ in done.stdout


def test_import_loads_numpy_and_the_core_only() -> None:
    """Names of top-level packages: none but ours and the standard library's."""
    loaded = set(run(LAW_OF_IMPORT).split())
    ours = {"helibore", "lazy_loader", "numpy"}
    assert loaded - sys.stdlib_module_names - ours == set()


def test_every_public_name_is_there_and_explains_itself() -> None:
    for name in hb.__all__:
        thing = getattr(hb, name)
        if name != "__version__":
            assert thing.__doc__, name


def test_a_fork_after_threads_works() -> None:
    """A child process made after a wall with several threads can build its own: nothing is left running."""
    k = np.arange(3000)
    caliper = hb.Caliper(k * 0.001, k * 37.0, np.full(3000, 0.11))
    before = hb.reconstruct(caliper, bit_diameter=0.216, threads=2).radius
    child = os.fork()
    if child == 0:
        same = np.array_equal(hb.reconstruct(caliper, bit_diameter=0.216, threads=2).radius, before)
        os._exit(0 if same else 1)
    give_up = time.monotonic() + PATIENCE
    while time.monotonic() < give_up:
        done, status = os.waitpid(child, os.WNOHANG)
        if done:
            assert status == 0
            return
        time.sleep(0.01)
    os.kill(child, 9)
    os.waitpid(child, 0)
    pytest.fail("the child hangs")
