"""What images, volumes, logs and pictures refuse: the whole text, the old file kept, nothing beside it.

An image outside the wall, with the wrong sectors, without a value, or constant; a resistivity that is negative on a log
scale; shells that cross or are thinner than zero; a folder that cannot be written to and a disk that is full, for every
kind of file that is written.
"""

from __future__ import annotations

import os
import subprocess
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from golden_texts import Golden

import helibore as hb
from helibore import plot
from helibore.channels.columns import RawSectorImage
from helibore.plot.html_report import report

BIT = 0.216
DEPTH = np.arange(1000.0, 1006.0, 0.1)


def image_of(values: Any, depth: Any = DEPTH, unit: str = "gAPI") -> hb.SectorImage:
    return hb.SectorImage(depth, values, "GR", unit, origin="edge", reference="high-side")


def wall_of(image: hb.SectorImage | None = None, samples: int = 4_000) -> hb.Wall:
    k = np.arange(samples)
    depth, radius = 1000 + k * (6 / samples), 0.108 + 0.004 * np.cos(np.radians(k * 74.0))
    wall = hb.reconstruct(hb.Caliper(depth, k * 37.0 % 360, radius), bit_diameter=BIT, sectors=16)
    if image is not None:
        wall.images["GR"] = image
    return wall


def layered() -> np.ndarray:
    return np.add.outer(50 + 10 * np.sin(DEPTH), np.arange(8.0))


def refused(work: Callable[[], object]) -> str:
    with pytest.raises(ValueError) as raised:  # noqa: PT011
        work()
    return str(raised.value)


def test_an_image_outside_the_wall(golden: Golden) -> None:
    wall = wall_of(image_of(layered(), DEPTH + 500))
    text = "image 'GR' reaches from 1499.92 to 1505.98 m: "
    expected = text + "no quad of the wall, 1000.05 to 1005.94 m, has its centre there"
    assert refused(lambda: wall.images["GR"].on(wall)) == expected
    assert refused(wall.surface) == expected
    golden(refused(lambda: plot.log(wall)))


def test_the_wrong_number_of_sectors(golden: Golden) -> None:
    columns = RawSectorImage("GRAS", "API", DEPTH, layered(), 0.0, 22.5, (), 0)
    golden(refused(lambda: columns.sector_image(origin="edge", reference="north")))
    uneven = RawSectorImage("GRAS", "API", DEPTH, layered(), 0.0, float("nan"), (), 0)
    golden(refused(lambda: uneven.sector_image(origin="edge", reference="north")))
    rule = "values: must be of shape (60, sectors), one row a depth and 1 sector or more: "
    assert refused(lambda: image_of(layered()[:, :0])) == rule + "(60, 0)"
    assert refused(lambda: image_of(layered()[:-1])) == rule + "(59, 8)"


def test_an_image_without_a_value_and_a_constant_one(golden: Golden) -> None:
    assert refused(lambda: image_of(np.full((60, 8), np.nan))) == "values: all 480 are missing"
    same = wall_of(image_of(np.full((60, 8), 7.0)))
    golden(refused(lambda: plot.log(same)))
    empty = layered()
    empty[20:] = np.nan
    golden(refused(lambda: plot.log(wall_of(image_of(empty)), start=1004.0, stop=1005.0)))


def test_negative_resistivity_on_a_log_scale(tmp_path: Path) -> None:
    values = layered()
    values[3, 2] = -0.5
    wall = wall_of(image_of(values, unit="ohm.m"))
    surface = wall.surface()
    seen = np.flatnonzero(surface.attributes["GR"] < 0)
    share = f"{seen.size} of {len(surface.quads)} are not"
    text = f"attribute 'GR': values[{seen[0]}] = -0.5: must be above 0 on a log scale ({share}); make them NaN to show "
    for ending in (".glb", ".ply"):
        path = tmp_path / f"well{ending}"
        path.write_bytes(b"old")
        found = refused(lambda path=path: surface.save(path, color_by="GR", log=True))
        assert found == text + "them as missing"
        assert path.read_bytes() == b"old"


def test_shells_that_cross_or_are_thinner_than_zero() -> None:
    wall = wall_of()
    r = wall.radius

    def crossing(outer: float, inner: str, k: int, depth: str, number: int = 0) -> str:
        return f"shells[{number}][{k}] = {outer} at depth {depth}: must lie beyond {inner}"

    first = crossing(r[0] + 0.1, f"shells[0][0] = {r[0] + 0.2}", 0, "1000", 1)
    assert refused(lambda: wall.volume(shells=[0.2, 0.1])) == first
    assert refused(lambda: wall.volume(shells=[0.0])) == crossing(r[0], f"radius[0] = {r[0]}", 0, "1000")
    thin = np.full(len(wall), 0.05)
    thin[70] = -1e-9
    assert refused(lambda: wall.volume(shells=[thin])) == crossing(
        r[70] - 1e-9, f"radius[70] = {r[70]}", 70, "1000.4375"
    )


def writers() -> dict[str, Callable[[hb.Wall, Path], object]]:
    """Everything that this part of helibore writes, by its ending."""
    meshes = (".glb", ".ply", ".obj", ".stl", ".vtu", ".vtp", ".vtkhdf")
    found: dict[str, Callable[[hb.Wall, Path], object]] = {
        ending: lambda wall, path: wall.surface().save(path) for ending in meshes
    }
    found |= {ending: lambda wall, path: wall.logs().save(path) for ending in (".las", ".csv", ".parquet", ".dlis")}
    figures = (".png", ".svg", ".pdf")
    found |= {
        ending: lambda wall, path: plot.save(plot.log(wall, dpi=40, polar=(), body=()), path) for ending in figures
    }
    found |= {".wall": lambda wall, path: wall.save(path), ".html": lambda wall, path: report(wall, path, dpi=40)}
    return found


ENDINGS = tuple(writers())
NEEDS = {".parquet": "pyarrow", ".dlis": "dliswriter", ".vtkhdf": "h5py", ".glb": "trimesh", ".png": "matplotlib"}


@pytest.fixture(scope="module")
def wall() -> hb.Wall:
    return wall_of(image_of(layered()))


@pytest.fixture
def small_disk(tmp_path: Path) -> Iterator[Path]:
    """A disk of 64 kB, nearly full."""
    disk = tmp_path / "disk"
    disk.mkdir()
    mount = ["mount", "-t", "tmpfs", "-o", "size=64k", "tmpfs", disk]
    if os.geteuid() != 0 or subprocess.run(mount, capture_output=True, check=False).returncode:
        pytest.skip("this system does not let tests mount a disk")
    try:
        (disk / "ballast").write_bytes(bytes(56_000))
        yield disk
    finally:
        subprocess.run(["umount", disk], check=True)


@pytest.mark.parametrize("ending", ENDINGS)
def test_a_full_disk_keeps_the_old_file_and_leaves_nothing_beside_it(
    wall: hb.Wall, small_disk: Path, ending: str
) -> None:
    if ending in NEEDS:
        pytest.importorskip(NEEDS[ending])
    path = small_disk / f"well{ending}"
    path.write_bytes(b"old")
    with pytest.raises(OSError, match="No space left on device") as raised:
        writers()[ending](wall, path)
    assert raised.value.filename == str(path)
    assert path.read_bytes() == b"old"
    assert sorted(one.name for one in small_disk.iterdir()) == ["ballast", path.name]


@pytest.fixture
def closed_folder(tmp_path: Path) -> Iterator[Path]:
    """A folder that cannot be written to, with an old file of every kind in it."""
    folder = tmp_path / "closed"
    folder.mkdir()
    root = os.geteuid() == 0  # whom permissions do not hold
    if root and subprocess.run(["mount", "-t", "tmpfs", "tmpfs", folder], capture_output=True, check=False).returncode:
        pytest.skip("this system does not let tests mount a disk")
    try:
        for ending in ENDINGS:
            (folder / f"well{ending}").write_bytes(b"old")
        if root:
            subprocess.run(["mount", "-o", "remount,ro", folder], check=True)
        else:
            folder.chmod(0o555)
        yield folder
    finally:
        if root:
            subprocess.run(["umount", folder], check=True)
        else:
            folder.chmod(0o755)


def test_a_folder_that_cannot_be_written_to_keeps_the_old_files(wall: hb.Wall, closed_folder: Path) -> None:
    before = sorted(one.name for one in closed_folder.iterdir())
    for ending, write in writers().items():
        if ending in NEEDS:
            pytest.importorskip(NEEDS[ending])
        path = closed_folder / f"well{ending}"
        with pytest.raises(OSError, match=r"Read-only file system|Permission denied") as raised:
            write(wall, path)
        assert raised.value.filename == str(path)
        assert path.read_bytes() == b"old"
    assert sorted(one.name for one in closed_folder.iterdir()) == before


@pytest.mark.parametrize("ending", ENDINGS)
def test_a_folder_that_is_not_there_is_named(wall: hb.Wall, tmp_path: Path, ending: str) -> None:
    if ending in NEEDS:
        pytest.importorskip(NEEDS[ending])
    path = tmp_path / "nowhere" / f"well{ending}"
    with pytest.raises(FileNotFoundError) as raised:
        writers()[ending](wall, path)
    assert raised.value.filename == str(path)
