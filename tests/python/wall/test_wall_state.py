"""A wall at one moment never changes, and reading a wall while another thread changes it never fails."""

from __future__ import annotations

import copy
import pickle
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import FrozenInstanceError
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import helibore as hb
from helibore import _core
from helibore.logs.picks import Pick
from helibore.wall.state import WallState

OLD = Path(__file__).parent / "data/archive_56ff07e9.wall"
IMAGE = hb.SectorImage(np.arange(0, 12, 0.5), np.ones((24, 8)), "GR", origin="edge", reference="north")


def fracture(number: int) -> Pick:
    return Pick(kind="fracture", depth=3.0 + number, toolface=1.0, apparent_dip=40.0, key=f"{number:012}")


def whole(arms: bool = False) -> hb.Wall:
    rng = np.random.default_rng(0)
    wall = hb.Wall(bit_diameter=0.2, sectors=16, threads=1, sigma=True)
    depth = np.sort(rng.random(600) * 10)
    arm = np.arange(600) % 4 if arms else None
    wall.append(depth, rng.random(600) * 360, 0.1 + 0.01 * rng.random(600), arm=arm)
    wall.path = hb.Survey([0, 100], [0, 0], [0, 0]).path(extend=10, reference="north")
    wall.images.update({f"a{number}": IMAGE for number in range(5)})
    wall.attributes["RT"] = np.arange(len(wall) - 17.0)
    wall.attributes.units["RT"] = "ohm.m"
    wall.picks = [fracture(0)]
    wall.made_from = {"files": [{"name": "a.las"}]}
    return wall


# ------------------------------------------------------------------ races


@contextmanager
def changing(change: Callable[[int], None]) -> Iterator[None]:
    """Call ``change`` with 0, 1, 2 ... in another thread, and switch threads as often as Python can."""
    stop, failed, interval = threading.Event(), list[BaseException](), sys.getswitchinterval()

    def run() -> None:
        number = 0
        try:
            while not stop.is_set():
                change(number)
                number += 1
        except BaseException as error:
            failed.append(error)

    thread = threading.Thread(target=run)
    sys.setswitchinterval(1e-6)
    thread.start()
    try:
        yield
    finally:
        stop.set()
        thread.join()
        sys.setswitchinterval(interval)
    assert not failed


def images(wall: hb.Wall, number: int) -> None:
    wall.images[f"x{number % 9}"] = IMAGE
    wall.images.pop(f"x{(number + 4) % 9}", None)


def all_images(wall: hb.Wall, number: int) -> None:
    wall.images = {f"x{number + more}": IMAGE for more in range(number % 5)}


def attributes(wall: hb.Wall, number: int) -> None:
    name = f"x{number % 9}"
    wall.attributes[name] = np.ones(len(wall) - 17)
    wall.attributes.units[name] = "m"
    if number >= 4:
        wall.attributes.pop(f"x{(number + 4) % 9}", None)


def all_attributes(wall: hb.Wall, number: int) -> None:
    wall.attributes = {f"x{more}": np.ones(len(wall) - 17) for more in range(number % 5)}


def picks(wall: hb.Wall, number: int) -> None:
    wall.picks.append(fracture(number % 5))
    del wall.picks[: len(wall.picks) - 4]


def made_from(wall: hb.Wall, number: int) -> None:
    wall.made_from[f"x{number % 50}"] = {"n": number}
    wall.made_from.pop(f"x{(number + 25) % 50}", None)


def nested(wall: hb.Wall, number: int) -> None:
    files = wall.made_from["files"]
    files.append({"name": str(number)})
    files[0][f"x{number % 50}"] = number
    files[0].pop(f"x{(number + 25) % 50}", None)
    del files[1 : len(files) - 20]


def samples(wall: hb.Wall, number: int) -> None:
    if number < 100:
        wall.append([9.0 + 0.001 * number], [number], [0.1])


def armed(wall: hb.Wall, number: int) -> None:
    if number < 100:
        wall.append([9.0 + 0.001 * number], [number], [0.1], arm=[number % 4])


def saved(wall: hb.Wall, folder: Path) -> None:
    wall.save(folder / "a.wall")
    assert len(hb.load(folder / "a.wall")) > 0


def surfaced(wall: hb.Wall, _: Path) -> None:
    wall.surface()


def pickled(wall: hb.Wall, _: Path) -> None:
    assert len(pickle.loads(pickle.dumps(wall))) > 0


def state_pickled(wall: hb.Wall, _: Path) -> None:
    pickle.dumps(wall._state())


RACES: list[tuple[Callable[[hb.Wall, int], None], Callable[[hb.Wall, Path], Any]]] = [
    (images, surfaced), (images, saved), (images, pickled), (images, state_pickled), (all_images, surfaced),
    (all_images, saved), (attributes, surfaced), (attributes, saved), (attributes, pickled), (all_attributes, surfaced),
    (all_attributes, saved), (picks, saved), (picks, pickled), (made_from, saved), (made_from, surfaced),
    (made_from, state_pickled), (nested, saved), (nested, pickled), (samples, surfaced), (samples, state_pickled),
    (samples, lambda wall, _: wall.logs(sigma=True)), (armed, lambda wall, _: wall.volume(shells=[0.02])),
    (armed, lambda wall, _: wall.arms), (armed, surfaced), (samples, lambda wall, _: wall.to_xarray()),
]  # fmt: skip


@pytest.mark.parametrize(("change", "read"), RACES)
def test_a_reading_while_another_thread_changes_the_wall_does_not_fail(
    change: Callable[[hb.Wall, int], None], read: Callable[[hb.Wall, Path], Any], tmp_path: Path
) -> None:
    wall = whole(arms=change is armed)
    with changing(lambda number: change(wall, number)):
        for _ in range(10):
            read(wall, tmp_path)


# ------------------------------------------------------------------ frozen


def test_a_state_does_not_change_with_its_wall() -> None:
    wall = whole(arms=True)
    state = wall._state()
    surface = state.surface()  # the state then also holds its angular gaps
    before = pickle.dumps(state)
    for change in (images, all_images, attributes, all_attributes, picks, nested, made_from, armed):
        change(wall, 7)
    wall.path = None
    assert pickle.dumps(state._state()) == before
    again = state.surface()
    assert again.vertices.tobytes() == surface.vertices.tobytes()
    assert again.attributes.keys() == surface.attributes.keys()


def test_a_state_refuses_every_change() -> None:
    state = whole()._state()
    for name in ("radius", "path", "images", "attributes", "made_from", "picks"):
        with pytest.raises(FrozenInstanceError):
            setattr(state, name, None)
    with pytest.raises(ValueError, match="read-only"):
        state.radius[0] = 1.0
    with pytest.raises(hb.InputError, match=r"attributes\['RT'\]"):
        state.attributes["RT"] = np.ones(len(state) - 17)
    with pytest.raises(hb.InputError, match=r"attributes\['RT'\]"):
        del state.attributes["RT"]


READS: dict[str, Callable[[Any], Any]] = {
    "depth": lambda wall: wall.depth,
    "toolface": lambda wall: wall.toolface,
    "sigma": lambda wall: wall.sigma,
    "angular gap": lambda wall: wall.angular_gap,
    "measured": lambda wall: wall.measured,
    "sampled": lambda wall: wall.sampled,
    "a point": lambda wall: wall.at(4.0, 30.0).radius,
    "surface": lambda wall: wall.surface().vertices,
    "volume": lambda wall: wall.volume(shells=[0.02]).vertices,
    "logs": lambda wall: wall.logs(sigma=True).equivalent_diameter,
    "zones": lambda wall: np.frombuffer(repr(list(wall.zones().zones)).encode(), np.uint8),
    "summary": lambda wall: np.frombuffer(repr(wall.summary()).encode(), np.uint8),
    "xarray": lambda wall: wall.to_xarray()["radius"].values,
    "text": lambda wall: np.frombuffer(repr(wall).encode() + wall._repr_html_().encode(), np.uint8),
    "length": lambda wall: np.array([len(wall), wall.sample_count]),
    "samples": lambda wall: wall.samples.radius,
}


@pytest.mark.parametrize("read", READS.values(), ids=READS)
@pytest.mark.parametrize("arms", [False, True])
def test_a_state_reads_as_its_wall(read: Callable[[Any], Any], arms: bool) -> None:
    wall = whole(arms)
    assert read(wall._state()).tobytes() == read(wall).tobytes()


def test_a_state_is_pickled_copied_and_made_without_a_wall_of_the_core(monkeypatch: pytest.MonkeyPatch) -> None:
    wall = whole(arms=True)
    expected = wall.surface()

    def refuse(*_: Any) -> None:
        raise AssertionError("a wall of the core was made")

    monkeypatch.setattr(_core, "Wall", refuse)
    state = wall._state()
    for again in (state, pickle.loads(pickle.dumps(state)), copy.deepcopy(state), copy.copy(state)):
        assert isinstance(again, WallState)
        surface = again.surface()
        assert surface.vertices.tobytes() == expected.vertices.tobytes()
        assert surface.attributes.units == expected.attributes.units
        for name, values in expected.attributes.items():
            assert surface.attributes[name].tobytes() == values.tobytes()
        assert (list(again.picks), again.made_from) == (list(wall.picks), wall.made_from)


def test_a_state_is_saved_as_its_wall(tmp_path: Path) -> None:
    wall = whole(arms=True)
    wall.save(tmp_path / "a.wall")
    wall._state().save(tmp_path / "b.wall")
    for ending in ("wall", "wall.picks.csv"):
        assert (tmp_path / f"a.{ending}").read_bytes() == (tmp_path / f"b.{ending}").read_bytes()


# ------------------------------------------------------------------ checked


@pytest.mark.parametrize(
    ("name", "value", "place"),
    [
        ("images", 3, "images"),
        ("images", {"GR": np.ones(3)}, r"images\['GR'\]"),
        ("images", {3: IMAGE}, "images = 3"),
        ("attributes", None, "attributes"),
        ("attributes", {"RT": [1.0]}, r"attributes\['RT'\]"),
        ("made_from", ["a.las"], "made_from"),
        ("made_from", {1: "a.las"}, "made_from = 1"),
        ("picks", 3, "picks"),
        ("picks", "fracture", "picks"),
        ("picks", [fracture(0), (1, 2)], r"picks\[1\]"),
    ],
)
def test_a_value_of_another_kind_is_refused_and_changes_nothing(name: str, value: Any, place: str) -> None:
    wall = whole()
    before = pickle.dumps(wall._state())
    with pytest.raises(hb.InputError, match=f"^{place}"):
        setattr(wall, name, value)
    assert pickle.dumps(wall._state()) == before


def test_what_is_assigned_is_copied() -> None:
    wall = whole()
    assigned: dict[str, Any] = {"GR": IMAGE}
    wall.images = assigned
    wall.attributes = {"X": np.ones(len(wall) - 17)}
    assigned["RT"] = IMAGE
    assert list(wall.images) == ["GR"]
    assert list(wall.surface().attributes) == ["GR", "X"]
    with pytest.raises(hb.InputError, match=r"images\['RT'\]"):
        wall.images.update({"RT": np.ones(3)})  # type: ignore[dict-item]


# ------------------------------------------------------------------ archives of before


def test_an_archive_of_56ff07e9_opens_and_its_bits_stay_when_it_is_written(tmp_path: Path) -> None:
    """The file and its picks were written by commit 56ff07e9; `load` compares its vertices with those of today."""
    wall = hb.load(OLD)
    assert (len(wall.images), list(wall.attributes), len(wall.picks), wall.arms is None) == (1, ["RT"], 2, False)
    wall.save(tmp_path / OLD.name)
    again = hb.load(tmp_path / OLD.name)
    with np.load(OLD) as stored:
        for name in ("radius", "nearest", "support", "iterations"):
            assert getattr(again, name).tobytes() == stored[f"vertices/{name}"].tobytes()
        for name in ("depth", "toolface", "radius"):
            assert getattr(again.samples, name).tobytes() == stored[f"samples/{name}"].tobytes()
            assert getattr(again.arms, name).tobytes() == stored[f"arms/{name}"].tobytes()
        assert again.images[next(iter(again.images))].values.tobytes() == stored["images/0/values"].tobytes()
        assert again.attributes["RT"].tobytes() == stored["attributes/0"].tobytes()
    again.save(tmp_path / "again.wall")
    assert (tmp_path / "again.wall").read_bytes() == (tmp_path / OLD.name).read_bytes()
    old, new = (Path(f"{path}.picks.csv").read_text().partition("\n") for path in (OLD, tmp_path / OLD.name))
    rows = [[line.split(",") for line in text[2].splitlines()] for text in (old, new)]
    lacked = {"APPARENT_DIP_SIGMA (deg)", "TOOLFACE_SIGMA (deg)", "APERTURE (m)", "AXIS_AZIMUTH (deg)"}
    lacked |= {"DIP_SIGMA (deg)", "DIP_AZIMUTH_SIGMA (deg)"}
    names = new[0].rstrip("\r").split(",")
    assert lacked <= set(names)
    kept = [[one for one, name in zip(row, names, strict=True) if name not in lacked] for row in rows[1]]
    assert kept == rows[0], "the picks; the names of their columns are now those of logs"
