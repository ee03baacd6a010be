"""Walls saved and reopened: the same bits, the same future; damaged and foreign files refused; whole or not at all."""

from __future__ import annotations

import contextlib
import errno
import inspect
import io
import json
import math
import re
import resource
import threading
import zipfile
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from golden_texts import Golden
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from reference import bits, random_hole
from test_laws import Columns, samples, wall_settings, whole

import helibore as hb
from helibore import _core
from helibore.base.atomic_file import write_whole
from helibore.base.file_endings import ARCHIVE_ENDING

BIT = 0.216


def oval(n: int = 4_000, seed: int = 1, timed: bool = False) -> hb.Wall:
    columns = random_hole(seed, "oval", n, n / 2000)
    return whole((*columns, np.arange(float(n))) if timed else columns, {"bit_diameter": BIT, "sectors": 16})


def dressed(wall: hb.Wall) -> hb.Wall:
    """A wall with all that a wall can have."""
    top = wall.start_depth
    wall.path = hb.Survey([0, top, 2 * top], [1, 30.1, 44.7], [350, 10, 33.3]).path(
        method="radius-of-curvature", reference="parallel-transport", head=(6.5e6, 0.1, -31.7), extend=0.3
    )
    rng = np.random.default_rng(5)
    values = rng.normal(70, 20, (30, 8))
    values[3, 2] = np.nan
    wall.images["GR"] = hb.SectorImage(
        top + 0.1 * np.arange(30), values, "GR", "gAPI", origin="edge", reference="north", direction="counterclockwise"
    )
    wall.images["coarse"] = hb.SectorImage([top], values[:1], "RT", origin="centre", reference="north", reach=2.0)
    room = len(wall) - wall.settings.sectors - 1
    wall.attributes["difference"] = np.where(np.arange(room) % 7, rng.normal(size=room), np.nan)
    wall.attributes.units["difference"] = "m"
    wall.made_from = {"radius": "azimuthal caliper", "files": ["run 1.las", "run ä.las"], "shift": [0.1, None]}
    return wall


def reopened(wall: hb.Wall, folder: Path) -> hb.Wall:
    wall.save(folder / "a.wall")
    return hb.load(folder / "a.wall")


# ------------------------------------------------------------------ the same bits, the same future


@settings(deadline=None, max_examples=60, suppress_health_check=list(HealthCheck))
@given(samples(), wall_settings)
def test_a_wall_saved_and_loaded_between_two_appends_is_the_wall_of_one(
    tmp_path: Path, columns: Columns, chosen: dict[str, Any]
) -> None:
    half = columns[0].size // 2
    wall = whole(tuple(column[:half] for column in columns), chosen)
    again = reopened(wall, tmp_path)
    assert bits(again) == bits(wall)
    assert again.settings == wall.settings
    assert [column.tobytes() for column in again._core.samples()] == [c.tobytes() for c in wall._core.samples()]
    rest = tuple(column[half:] for column in columns)
    old, new = wall.append(*rest), again.append(*rest)
    assert (old.ranges == new.ranges).all()
    assert (old.settled, old.accepted, old.redundant) == (new.settled, new.accepted, new.redundant)
    assert bits(again) == bits(wall) == bits(whole(columns, chosen))


@pytest.mark.parametrize("timed", [False, True])
def test_everything_a_wall_has_comes_back(tmp_path: Path, timed: bool) -> None:
    wall = dressed(oval(timed=timed))
    again = reopened(wall, tmp_path)
    assert bits(again) == bits(wall)
    assert again.path is not None
    assert wall.path is not None
    for name in ("method", "reference", "head", "extend", "stop_depth"):
        assert getattr(again.path, name) == getattr(wall.path, name)
    assert list(again.images) == ["GR", "coarse"]
    for key, image in wall.images.items():
        for name in inspect.signature(hb.SectorImage).parameters:  # all of them, those of later versions, too
            assert np.array_equal(getattr(again.images[key], name), getattr(image, name), equal_nan=name == "values")
    assert np.array_equal(again.attributes["difference"], wall.attributes["difference"], equal_nan=True)
    assert again.attributes.units == {"difference": "m"}
    assert again.made_from == wall.made_from
    one, two = wall.surface(), again.surface()
    assert one.vertices.tobytes() == two.vertices.tobytes()
    assert {name: of.tobytes() for name, of in one.attributes.items()} == {
        name: of.tobytes() for name, of in two.attributes.items()
    }
    first = (tmp_path / "a.wall").read_bytes()
    again.save(tmp_path / "b.wall")
    assert (tmp_path / "b.wall").read_bytes() == first


def test_an_empty_wall_and_one_with_open_limits_come_back(tmp_path: Path) -> None:
    empty = reopened(hb.Wall(bit_diameter=BIT, max_distance=None), tmp_path)
    assert len(empty) == empty.sample_count == 0
    assert math.isnan(empty.start_depth)
    assert empty.path is None
    assert reopened(hb.reconstruct(hb.Caliper.gauge(10, 11, BIT), bit_diameter=BIT), tmp_path).basis == "gauge"
    wall = whole(random_hole(1, "broken", 500, 5.0), {"bit_diameter": BIT, "max_distance": math.inf})
    assert bits(reopened(wall, tmp_path)) == bits(wall)


def decompressed(content: bytes) -> Any:
    """Read a member as ``helibore/compression.hpp`` describes it, number by number."""
    file = io.BytesIO(content)
    np.lib.format.read_magic(file)
    shape, _, dtype = np.lib.format.read_array_header_1_0(file)

    def number(size: int) -> int:
        return int.from_bytes(file.read(size), "little")

    form, shift, mask = number(1), number(1), 2**64 - 1
    table = [number(8) for _ in range(number(8))] if form & 2 else []
    words, last = list[int](), 0
    while len(words) < math.prod(shape):
        count = min(1024, math.prod(shape) - len(words))
        least, width = number(8), number(1)
        bits = number(8 * ((count * width + 63) // 64))
        for at in range(count):
            value = (least + (bits >> at * width & ((1 << width) - 1))) & mask
            value = table[value] if form & 2 else value << shift & mask
            last = (last + value) & mask if form & 1 else value
            words.append(last)
    assert file.read() == b""
    whole = np.array(words, np.uint64).view(np.float64 if dtype.kind == "f" else np.int64)
    return whole.astype(dtype).reshape(shape)


def test_numpy_and_zip_read_an_archive_without_helibore(tmp_path: Path) -> None:
    wall = dressed(oval())
    wall.save(tmp_path / "a.wall")
    with zipfile.ZipFile(tmp_path / "a.wall") as members:
        assert members.testzip() is None
        contents = json.loads(members.read("helibore.json"))
        for name, values in {
            "vertices/radius": wall.radius, "vertices/support": wall.support, "samples/depth": wall.samples.depth,
            "samples/toolface": wall.samples.toolface, "images/0/values": wall.images["GR"].values,
        }.items():  # fmt: skip
            assert decompressed(members.read(name)).tobytes() == values.tobytes()
    assert (contents["format"], contents["version"]) == ("helibore wall", 2)
    assert contents["settings"]["bit_diameter"] == BIT
    assert contents["units"].startswith("metres and degrees")


def few_decimals(n: int, steps: bool) -> hb.Wall:
    """A wall of a tool with two arms that writes depth to 0.1 mm, toolface to 0.01 degree, diameters to 0.01 inch."""
    rng = np.random.default_rng(4)
    row = np.arange(n // 2)
    depth = np.round(1000 + (row * 0.0004 if steps else np.sort(rng.uniform(0, 0.0004 * n, row.size))), 4)
    toolface = np.round(row * 36.7 % 360, 2)
    radius = np.round(8.5 + rng.normal(0, 0.1, n), 2) * 0.0127
    wall = hb.Wall(bit_diameter=BIT, sectors=16, pitch=0.1)
    columns = np.repeat(depth, 2), np.ravel(np.stack([toolface, (toolface + 90) % 360], 1)), radius
    wall.append(*columns, arm=np.tile([0, 1], n // 2))
    return wall


@pytest.mark.parametrize("steps", [False, True])
def test_samples_of_few_decimals_take_less_than_a_third_of_their_bytes_and_are_stored_once(
    tmp_path: Path, steps: bool
) -> None:
    wall = few_decimals(40_000, steps)
    again = reopened(wall, tmp_path)
    assert bits(again) == bits(wall)
    assert [column.tobytes() for column in again._core.samples()] == [c.tobytes() for c in wall._core.samples()]
    for one, other in zip(again._arms, wall._arms, strict=True):
        for name in ("depth", "toolface", "radius", "arm"):
            assert getattr(one, name).tobytes() == getattr(other, name).tobytes()
    assert (tmp_path / "a.wall").stat().st_size < 40_000 * 24 / 3
    wall.append([1000.5], [3.0], [0.11])  # a sample without an arm
    assert bits(reopened(wall, tmp_path)) == bits(wall)


@given(st.integers(0, 3), st.integers(0, 70), st.integers(0, 2**32), st.sampled_from([1, 30, 1023, 1025, 2600]))
@settings(deadline=None, max_examples=60)
def test_any_words_come_back_from_compression_and_damaged_bytes_stay_inside(
    kind: int, spread: int, seed: int, count: int
) -> None:
    rng = np.random.default_rng(seed)
    words = rng.integers(0, 2 ** min(spread, 63), count, dtype=np.uint64, endpoint=True)
    if kind & 1:
        words = np.cumsum(words, dtype=np.uint64)
    if kind & 2:
        words = words << np.uint64(spread % 64)
    content = _core.compress(words)
    back = np.empty_like(words)
    _core.decompress(content, back)
    assert back.tobytes() == words.tobytes()
    for _ in range(20):
        flipped = content.copy()
        flipped[rng.integers(content.size)] ^= 1 << rng.integers(8)
        with contextlib.suppress(hb.InputError):
            _core.decompress(flipped, back)
    for other in (content[:-1], np.append(content, np.uint8(0))):
        with pytest.raises(hb.InputError, match="compressed column: is damaged"):
            _core.decompress(other, back)


def test_a_wall_saved_while_it_grows_is_one_of_its_moments(tmp_path: Path) -> None:
    """Samples and vertices of an archive belong together: loading would find vertices of another moment."""
    columns = random_hole(2, "spiral", 30_000, 30.0)
    wall = hb.Wall(bit_diameter=BIT, sectors=8, start_depth=1000.0)
    wall.append(*(column[:100] for column in columns))

    def grow() -> None:
        for start in range(100, 30_000, 50):
            wall.append(*(column[start : start + 50] for column in columns))

    writer = threading.Thread(target=grow)
    writer.start()
    counts = {reopened(wall, tmp_path).sample_count}  # the writer may end before this thread is next to run
    while writer.is_alive():
        counts.add(reopened(wall, tmp_path).sample_count)
    writer.join()
    assert {(count - 100) % 50 for count in counts} == {0}
    assert bits(reopened(wall, tmp_path)) == bits(wall)


def test_surfaces_have_the_images_and_attributes_of_their_wall(golden: Golden) -> None:
    wall = dressed(oval())
    del wall.images["coarse"]
    surface = wall.surface(start=1000.5, stop=1001.0)
    assert np.array_equal(surface.attributes["GR"], wall.images["GR"].on(wall)[surface.quad_index], equal_nan=True)
    assert surface.attributes.units == {"GR": "gAPI", "difference": "m"}
    assert np.array_equal(
        surface.attributes["difference"], wall.attributes["difference"][surface.quad_index], equal_nan=True
    )
    before = len(wall.attributes["difference"])
    wall.append([1002.4], [0.0], [0.1])
    values = wall.surface().attributes["difference"]
    assert np.array_equal(values[:before], wall.attributes["difference"], equal_nan=True)
    assert np.isnan(values[before:]).all()
    assert values.size > before
    wall.append([999.0], [0.0], [0.1])
    with golden.raises():
        wall.surface()
    with golden.raises():
        wall.attributes["x"] = [1, 2, 3]


# ------------------------------------------------------------------ what is refused


def refused(path: Path, text: str) -> None:
    with pytest.raises(ValueError, match=f"^{re.escape(str(path))}: {text}"):
        hb.load(path)


def test_foreign_files_are_refused(tmp_path: Path) -> None:
    path = tmp_path / "x.wall"
    path.write_bytes(b"")
    refused(path, "an empty file, not the archive of a wall$")
    path.write_bytes(b"DEPTH,CAL\n1,2\n")
    refused(path, r"not the archive of a wall \(it begins with b'DEPT'\)$")
    np.savez(path.with_suffix(".npz"), depth=[1.0])
    refused(path.with_suffix(".npz"), r"a zip file, but not the archive of a wall \(it lacks helibore\.json\)$")
    with pytest.raises(FileNotFoundError):
        hb.load(tmp_path / "none.wall")


def rewritten(path: Path, member: str, content: bytes | None) -> None:
    """Replace a member, or leave it out."""
    with zipfile.ZipFile(path) as old:
        members = {name: old.read(name) for name in old.namelist() if name != member}
    with zipfile.ZipFile(path, "w") as new:
        for name, old_content in members.items():
            new.writestr(name, old_content)
        if content is not None:
            new.writestr(member, content)


def altered(path: Path, **entries: Any) -> None:
    with zipfile.ZipFile(path) as old:
        contents = json.loads(old.read("helibore.json"))
    rewritten(path, "helibore.json", json.dumps(contents | entries).encode())


def npy(array: Any) -> bytes:
    out = io.BytesIO()
    np.save(out, array, allow_pickle=True)
    return out.getvalue()


def save_version_1(wall: hb.Wall, path: Path) -> None:
    """Write an archive as helibore did before it compressed arrays."""
    wall.save(path)
    with zipfile.ZipFile(path) as old:
        members = {name: old.read(name) for name in old.namelist()}
    contents = json.loads(members.pop("helibore.json"))
    with zipfile.ZipFile(path, "w") as new:
        new.writestr("helibore.json", json.dumps(contents | {"version": 1}))
        for name, content in members.items():
            new.writestr(f"{name}.npy", npy(decompressed(content)))


def test_newer_and_incomplete_archives_are_refused(tmp_path: Path) -> None:
    path = tmp_path / "a.wall"
    wall = oval()
    wall.save(path)
    altered(path, version=3, helibore="9.1")
    refused(path, rf"an archive of version 3, written by helibore 9\.1; this is helibore {hb.__version__}, which reads")
    wall.save(path)
    altered(path, settings={"bit_diameter": BIT, "magic": 3})
    refused(path, r"settings magic: written by helibore .*; helibore .* lacks these settings$")
    altered(path, settings={"bit_diameter": -1.0})
    refused(path, "bit_diameter = -1: must be finite and above 0$")
    altered(path, settings={})
    refused(path, "not the archive of a wall: TypeError")
    wall.save(path)
    rewritten(path, "vertices/nearest", None)
    refused(path, r"damaged: vertices/nearest is missing$")
    wall.save(path)
    head = npy(wall.samples.depth)[: -8 * 4000]
    rewritten(path, "samples/depth", head + _core.compress(wall.samples.depth.view(np.uint64)).tobytes()[:-1])
    refused(path, r"damaged: samples/depth \(4000,\): compressed column: is damaged$")
    rewritten(path, "samples/depth", head.replace(b"(4000,), }         ", b"(90000000000000,), "[:-1] + b"}"))
    refused(path, r"samples/depth: unpacks to more than 200 times its size, and to more than")


def test_incomplete_archives_of_version_1_are_refused(tmp_path: Path) -> None:
    path = tmp_path / "a.wall"
    wall = oval()
    save_version_1(wall, path)
    assert bits(hb.load(path)) == bits(wall)
    rewritten(path, "vertices/nearest.npy", None)
    refused(path, r"damaged: vertices/nearest\.npy is missing$")
    save_version_1(wall, path)
    rewritten(path, "samples/depth.npy", npy(wall.samples.depth.astype(np.float32)))
    refused(path, r"damaged: samples/depth is float32 \(4000,\)$")
    rewritten(path, "samples/depth.npy", npy(wall.samples.depth)[:-8])
    refused(path, r"damaged: samples/depth is shorter than \(4000,\)$")
    rewritten(path, "samples/depth.npy", npy(wall.samples.depth) + b"x")
    refused(path, r"damaged: samples/depth is longer than \(4000,\)$")
    rewritten(path, "samples/depth.npy", npy(np.array([{}], dtype=object)))
    refused(path, "damaged: samples/depth is object")


@pytest.mark.parametrize("entries", [{"images": [1]}, {"attributes": 5}, {"basis": []}])
def test_contents_of_the_wrong_kind_are_refused(tmp_path: Path, entries: dict[str, Any]) -> None:
    path = tmp_path / "a.wall"
    oval(300).save(path)
    altered(path, **entries)
    refused(path, r"not the archive of a wall: \w+Error\(.* in helibore\.json$")


def test_a_setting_too_large_for_a_number_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "a.wall"
    oval(300).save(path)
    altered(path, settings={"bit_diameter": 10**400})
    refused(path, r"bit_diameter = 10+: must be a number$")


def test_values_that_this_version_would_not_make_are_refused_unless_asked_for(tmp_path: Path) -> None:
    path = tmp_path / "a.wall"
    wall = oval()
    wall.save(path)
    radius = wall.radius
    radius[17] += 1e-9
    content = npy(radius)[: -radius.nbytes] + _core.compress(radius.view(np.uint64)).tobytes()
    rewritten(path, "vertices/radius", content)
    advice = r"hb\.load\(\.\.\., recompute=True\) accepts"
    refused(path, rf"radius\[17\] = 0\.\d+: saved by helibore .* computes 0\.\d+; {advice}")
    assert bits(hb.load(path, recompute=True)) == bits(wall)


def test_truncated_and_flipped_archives_are_refused_or_give_the_same_wall(tmp_path: Path) -> None:
    path = tmp_path / "a.wall"
    wall = dressed(oval(300))
    wall.save(path)
    content = path.read_bytes()
    rng = np.random.default_rng(7)
    for length in [*rng.integers(0, len(content), 100).tolist(), 1, 4, len(content) - 1]:
        path.write_bytes(content[:length])
        with pytest.raises(ValueError, match=r"truncated|empty|not the archive"):
            hb.load(path)
    directory = content.index(b"PK\x01\x02")
    places = [*rng.integers(0, len(content), 300).tolist(), *range(0, 60), *range(directory, len(content))]
    harmless = 0
    for place in places:
        flipped = bytearray(content)
        flipped[place] ^= 1 << int(rng.integers(8))
        path.write_bytes(flipped)
        try:
            again = hb.load(path)
        except ValueError:
            continue
        harmless += 1  # a date, or the copy of a size that nobody reads
        assert bits(again) == bits(wall)
        assert again.made_from == wall.made_from
        assert np.array_equal(again.images["GR"].values, wall.images["GR"].values, equal_nan=True)
    assert harmless < len(places) / 2


def test_a_damaged_header_of_an_array_is_refused_whatever_it_has_become(tmp_path: Path) -> None:
    path = tmp_path / "a.wall"
    oval(2000).save(path)  # members longer than a block: their checksum comes after the header has been read
    content = path.read_bytes()
    start = content.index(b"{'descr'")
    for place in (start, start + 1, content.index(b"}", start), content.index(b"(", start)):
        for bit in range(8):
            flipped = bytearray(content)
            flipped[place] ^= 1 << bit
            path.write_bytes(flipped)
            with pytest.raises(ValueError, match=f"^{re.escape(str(path))}: "):
                hb.load(path)


# ------------------------------------------------------------------ whole or not at all


def test_what_cannot_be_saved_says_so(tmp_path: Path, golden: Golden) -> None:
    wall = oval(100)
    with golden.raises():
        wall.save(tmp_path / "well.glb")
    wall.made_from = {"files": (1, 2)}
    with golden.raises():
        wall.save(tmp_path / "a.wall")
    wall.made_from = {"when": {1, 2}}
    with golden.raises():
        wall.save(tmp_path / "a.wall")
    assert not list(tmp_path.iterdir())


def test_a_full_disk_keeps_the_old_archive_and_leaves_nothing_beside_it(tmp_path: Path) -> None:
    path = tmp_path / "a.wall"
    oval(100).save(path)
    before = path.read_bytes()
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (50_000, hard))  # stands for the disk's end
    try:
        with pytest.raises(OSError, match=re.escape(str(path))) as raised:
            oval(4_000).save(path)
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))
    assert raised.value.errno == errno.EFBIG
    assert path.read_bytes() == before
    assert list(tmp_path.iterdir()) == [path]
    assert len(hb.load(path)) > 0


def test_errors_of_the_disk_name_the_file_that_was_asked_for(tmp_path: Path, golden: Golden) -> None:
    target = tmp_path / "nowhere" / "a.wall"
    with pytest.raises(FileNotFoundError) as raised:
        oval(100).save(target)
    assert raised.value.filename == str(target)

    def full(_: Any) -> None:
        raise OSError(errno.ENOSPC, "No space left on device")

    with golden.raises(kind=OSError):
        write_whole(tmp_path / "b.wall", full)
    assert ARCHIVE_ENDING == ".wall"
