"""Walls, surveys and paths travel: pickled, copied, sent to other processes, with the same bits."""

from __future__ import annotations

import copy
import multiprocessing
import pickle
import warnings

import numpy as np
import pytest

import helibore as hb


def everything():
    """Return a wall that holds all that a wall can hold, and samples to go on with."""
    rng = np.random.default_rng(11)
    depth = 500 + np.sort(rng.integers(0, 400, 3000)) * 0.005  # with ties
    columns = depth, rng.uniform(0, 360, 3000), rng.uniform(0.1, 0.12, 3000), np.arange(3000.0)
    wall = hb.Wall(bit_diameter=0.216, sectors=24, threads=2)
    wall.append(*(of[:2000] for of in columns), arm=np.arange(2000) % 4)
    wall.path = hb.Survey([450, 600], [10, 20], [30, 40]).path(reference="north", head=(1.0, 2.0, 3.0), extend=5.0)
    wall.images["GR"] = hb.SectorImage(
        [500, 501, 502], rng.uniform(0, 99, (3, 8)), "GR", "gAPI", origin="edge", reference="north"
    )
    wall.attributes["RT"] = rng.uniform(1, 9, len(wall) - 25)
    wall.attributes.units["RT"] = "ohm.m"
    wall.made_from = {"files": ["a.las"]}
    return wall, [of[2000:] for of in columns]


def same_bits(a, b):
    return all(np.array_equal(a[name].view(np.uint8), b[name].view(np.uint8)) for name in a) and a.keys() == b.keys()


def content(wall):
    surface = wall.surface()
    arrays = {name: getattr(wall, name) for name in ("radius", "nearest", "support", "iterations", "angular_gap")}
    arrays |= dict(surface.attributes) | {"points": surface.vertices, "samples": wall.samples.time}
    return arrays | {f"arm {name}": getattr(wall.arms, name) for name in ("depth", "arm")}


def grown(wall, more):
    wall.append(*more)
    return wall.radius


@pytest.mark.parametrize("again", [copy.copy, copy.deepcopy, lambda w: pickle.loads(pickle.dumps(w, 5))])
def test_a_copy_has_the_same_bits_and_goes_on_with_them(again):
    wall, more = everything()
    other = again(wall)
    assert same_bits(content(wall), content(other))
    assert (other.settings, other.basis, other.made_from) == (wall.settings, wall.basis, wall.made_from)
    assert other.attributes.units == wall.attributes.units
    other.append(*more)
    assert len(other) > 0
    assert wall.sample_count == 2000
    assert grown(wall, more).tobytes() == other.radius.tobytes()


def test_samples_travel_out_of_band():
    wall, _ = everything()
    buffers = []
    small = pickle.dumps(wall, 5, buffer_callback=buffers.append)
    assert len(small) < 8000
    assert sum(of.raw().nbytes for of in buffers) >= 4 * 8 * 2000
    assert same_bits(content(pickle.loads(small, buffers=buffers)), content(wall))


def test_an_empty_wall_and_one_of_an_average_caliper_travel():
    empty = pickle.loads(pickle.dumps(hb.Wall(bit_diameter=0.2)))
    assert len(empty) == 0
    average = hb.reconstruct(hb.Caliper.from_average([1, 2], [0.2, 0.21]), bit_diameter=0.2)
    assert copy.deepcopy(average).basis == "average"


@pytest.mark.parametrize("method", ["fork", "spawn", "forkserver"])
def test_a_wall_goes_to_another_process_and_back(method):
    wall, more = everything()
    with multiprocessing.get_context(method).Pool(1) as pool:
        back = pool.apply(grown, (wall, more))
    assert back.tobytes() == grown(wall, more).tobytes()


def test_what_a_wall_makes_and_holds_travels():
    wall, _ = everything()
    survey, path = wall.path.survey, wall.path
    depth = np.linspace(450, 605, 40)
    assert pickle.loads(pickle.dumps(path)).frame(depth).tobytes() == path.frame(depth).tobytes()
    assert copy.deepcopy(survey).dogleg().tobytes() == survey.dogleg().tobytes()
    made = [wall.logs(), wall.zones(), wall.surface(), wall.volume(), wall.samples, wall.arms, wall.summary()]
    for one in made:
        assert repr(pickle.loads(pickle.dumps(one))) == repr(one)


def test_dask_sends_arrays_out_of_band_and_without_a_further_copy():
    """Dask's serializer for them is pickle protocol 5 with buffers: the arrays are sent as they lie in memory."""
    protocol = pytest.importorskip("distributed.protocol")
    wall, _ = everything()
    arrays = {
        "Survey": (wall.path.survey, [wall.path.survey.depth]),
        "Path": (wall.path, [wall.path.survey.depth]),
        "Caliper": (wall.arms, [wall.arms.radius]),
        "Logs": (made := wall.logs(), [made.depth, made.c1]),
        "Wall": (wall, []),
    }
    for name, (one, held) in arrays.items():
        header, (pickled, *frames) = protocol.serialize(one)
        assert header["serializer"] == "pickle", name
        assert len(pickled) < 10_000, name
        buffers = [np.frombuffer(frame, np.uint8) for frame in frames if memoryview(frame).nbytes]
        assert all(any(np.shares_memory(array, of) for of in buffers) for array in held), name
        again = protocol.deserialize(header, [pickled, *map(bytearray, frames)])
        assert type(again) is type(one)
        assert pickle.dumps(again) == pickle.dumps(protocol.deserialize(*protocol.serialize(one))), name
    sent = sum(memoryview(frame).nbytes for frame in protocol.serialize(wall)[1])
    assert sent < 1.2 * sum(of.nbytes for of in pickle_buffers(wall))


def pickle_buffers(one):
    buffers = []
    pickle.dumps(one, 5, buffer_callback=lambda of: buffers.append(of.raw()))
    return buffers


@pytest.mark.parametrize("protocol", [2, 5])
def test_a_pickle_with_a_wrong_bit_is_refused_or_gives_the_same_wall(protocol):
    depth, toolface = np.linspace(10, 11, 60), np.arange(60) * 37.0 % 360
    wall = hb.reconstruct(hb.Caliper(depth, toolface, 0.1 + toolface / 1e5), bit_diameter=0.2, sectors=8)
    wall.made_from = {"well": "A"}
    whole = pickle.dumps(wall, protocol)
    random, refused = np.random.default_rng(protocol), 0
    for at in random.integers(8 * len(whole), size=300):
        flipped = bytearray(whole)
        flipped[at // 8] ^= 1 << at % 8
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")
                again = pickle.loads(bytes(flipped))
        except Exception:
            refused += 1
        else:
            assert isinstance(again, hb.Wall)
            assert again.radius.tobytes() == wall.radius.tobytes()
            assert (again.settings, again.made_from, again.basis) == (wall.settings, wall.made_from, wall.basis)
    assert refused > 250


def test_a_damaged_pickle_is_named(golden):
    wall = hb.reconstruct(hb.Caliper([1, 2], [0, 90], [0.1, 0.11]), bit_diameter=0.2)
    buffers = []
    small = pickle.dumps(wall, 5, buffer_callback=buffers.append)
    columns = [bytearray(of.raw()) for of in buffers]
    columns[2][7] ^= 1
    with golden.raises():
        pickle.loads(small, buffers=columns)
