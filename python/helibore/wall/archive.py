"""The archive of a wall, to reopen it: `Wall.save` and `hb.load`.

A zip file of uncompressed NumPy arrays, so ``np.load`` and any zip program open it without helibore:

    helibore.json               format, version, settings, basis, start_depth, path, images, made_from
    samples/depth.npy ...       toolface, radius, and time where samples carry one: canonical order
    vertices/radius.npy ...     nearest, support, iterations
    survey/depth.npy ...        inclination, azimuth               where the wall has a path
    images/0/depth.npy          images/0/values.npy ...            where it has images
    attributes/0.npy ...        one value a quad of the whole wall

Zip was chosen because the standard library and NumPy write it at the speed of memory, it gives every member a CRC-32,
its directory at the end tells a truncated file, and it needs no extra; HDF5 would need one for the most basic thing a
wall can do. A wall is a pure function of its settings and samples: loading appends the samples, in canonical order, in
one go, and by the law of splits that wall goes on with the bits of one never saved. The vertices are kept for other
readers, and to prove that this helibore still makes the same of the same samples.

Making them anew costs about as much as reading and checking the file: 44 beside 50 ms for 2.4 M samples as a tool
records them and 256 k vertices, on two cores, where ``np.load`` of the same arrays as .npz takes 47; up to twice that
for samples all over the hole. Part of it, putting the samples into their index, any load must do; the rest could be
saved by filing the reach of every group of vertices too, a detail of the core that would then have to be kept for ever.
It would also take the proof away.
"""

from __future__ import annotations

import json
import math
import os
import struct
import zipfile
import zlib
from dataclasses import asdict, fields
from pathlib import Path
from tokenize import TokenError
from typing import IO, Any, BinaryIO

import numpy as np
import numpy.typing as npt

from helibore import _core
from helibore.base.arrays import Floats
from helibore.base.atomic_file import write_whole
from helibore.base.settings import Settings
from helibore.images.sector_image import SectorImage
from helibore.trajectory.survey import Survey
from helibore.wall.wall import Wall

ENDING = ".wall"
FORMAT, VERSION = "helibore wall", 1
UNITS = (
    "metres and degrees; depth along the hole, positive down; toolface clockwise looking downhole; radius from the axis"
)

_CONTENTS = "helibore.json"
_LARGEST_CONTENTS = 1 << 26  # bytes of JSON
_PIECE = 1 << 20  # bytes; stays in the cache between checksum and copy
_SAMPLES = ("depth", "toolface", "radius", "time")
_VERTICES = {"radius": "<f8", "nearest": "<f8", "support": "<i4", "iterations": "<i4"}
_STATIONS = ("depth", "inclination", "azimuth")
_IMAGE = ("name", "unit", "origin", "reference", "direction", "offset", "reach")

Arrays = dict[str, npt.NDArray[Any]]


def save(wall: Wall, filename: str | os.PathLike[str]) -> None:
    """Write ``wall`` to ``filename``: `Wall.save`."""
    path = Path(filename)
    if path.suffix.lower() != ENDING:
        raise ValueError(f"{path}: the archive of a wall ends in {ENDING}; wall.surface().save() writes meshes")
    arrays, contents = _contents(wall)
    text = json.dumps(contents, indent=1).encode()

    def write(file: BinaryIO) -> None:
        with zipfile.ZipFile(file, "w", zipfile.ZIP_STORED) as archive:
            archive.writestr(zipfile.ZipInfo(_CONTENTS), text)  # of 1980: the same wall gives the same bytes
            for name, array in arrays.items():
                with archive.open(zipfile.ZipInfo(f"{name}.npy"), "w", force_zip64=True) as member:
                    _write_array(member, array)

    write_whole(path, write)


def load(filename: str | os.PathLike[str], threads: int | None = None, recompute: bool = False) -> Wall:
    """Reopen a wall that `Wall.save` wrote: the same bits, ready for further appends.

    Parameters
    ----------
    filename
        An archive, whatever its name.
    threads
        As in `Wall`.
    recompute
        Take the values that this helibore makes of the samples, even where another version made others.

    Returns
    -------
    Wall
        With the settings, basis, samples, vertices, ``path``, ``images``, ``attributes`` and ``made_from`` of the saved
        one. Further appends give the bits they would have given to that.

    Raises
    ------
    ValueError
        Naming the file and why it is none, or not a whole one: foreign, truncated, damaged, or of a newer version; and
        where this version makes other values of the samples than the one that saved them.
    OSError
        If the file cannot be read.
    """
    path = Path(filename)
    with path.open("rb") as file:
        try:
            with zipfile.ZipFile(file) as archive:
                return _wall(_Members(archive, path.stat().st_size), threads, recompute)
        except (zipfile.BadZipFile, EOFError, NotImplementedError, RuntimeError, struct.error, zlib.error) as error:
            raise ValueError(f"{path}: {_ailment(path, error)}") from error
        except (KeyError, TypeError) as error:
            raise ValueError(f"{path}: not the archive of a wall: {error!r} in {_CONTENTS}") from error
        except ValueError as error:
            raise ValueError(f"{path}: {error}") from error


# ------------------------------------------------------------------ writing


def _contents(wall: Wall) -> tuple[Arrays, dict[str, Any]]:
    """The arrays of a wall by name, of one instant, and all that is not an array."""
    samples, vertices, start_depth = wall._state()
    arrays: Arrays = {f"samples/{name}": of for name, of in zip(_SAMPLES, samples, strict=False)}
    arrays |= {f"vertices/{name}": of for name, of in zip(_VERTICES, vertices, strict=True)}
    placing: dict[str, Any] | None = None
    if wall.path is not None:
        path = wall.path
        arrays |= {f"survey/{name}": getattr(path.survey, name) for name in _STATIONS}
        placing = {"method": path.method, "reference": path.reference, "head": path.head, "extend": path.extend}
    images = []
    for number, (key, image) in enumerate(wall.images.items()):
        arrays |= {f"images/{number}/{name}": getattr(image, name) for name in ("depth", "values")}
        images.append({"key": key} | {name: getattr(image, name) for name in _IMAGE})
    attributes = []
    for number, (name, values) in enumerate(wall.attributes.items()):
        arrays[f"attributes/{number}"] = values
        start = wall.attributes.start_depth(name)
        attributes.append({"name": name, "start_depth": _or_null(start), "unit": wall.attributes.units.get(name)})
    return arrays, {
        "format": FORMAT,
        "version": VERSION,
        "helibore": _core.__version__,
        "units": UNITS,
        "settings": asdict(wall.settings),
        "basis": wall.basis,
        "start_depth": _or_null(start_depth),
        "samples": [name for name in _SAMPLES if f"samples/{name}" in arrays],
        "path": placing,
        "images": images,
        "attributes": attributes,
        "made_from": _checked_origin(wall.made_from),
    }


def _or_null(number: float) -> float | None:
    return None if math.isnan(number) else number


def _checked_origin(made_from: dict[str, Any]) -> dict[str, Any]:
    try:
        same = json.loads(json.dumps(made_from, allow_nan=False)) == made_from
    except (TypeError, ValueError) as error:
        raise ValueError(f"made_from: must be what JSON can hold: {error}") from error
    if not same:
        raise ValueError("made_from: must be what JSON can hold: lists, not tuples, and texts as keys")
    return made_from


def _write_array(member: IO[bytes], array: npt.NDArray[Any]) -> None:
    """As ``np.save`` does, in pieces that are in the cache when their checksum has been made."""
    array = np.require(array, array.dtype.newbyteorder("<"), "C")
    np.lib.format.write_array_header_1_0(member, np.lib.format.header_data_from_array_1_0(array))
    content = _bytes_of(array)
    for start in range(0, len(content), _PIECE):
        member.write(content[start : start + _PIECE])


def _bytes_of(array: npt.NDArray[Any]) -> memoryview:
    return array.reshape(-1).view(np.uint8).data


# ------------------------------------------------------------------ reading


class _Members:
    """The members of an archive, each read whole and checked."""

    def __init__(self, archive: zipfile.ZipFile, size: int) -> None:
        self._archive, self._size = archive, size

    def _open(self, name: str, at_most: int) -> IO[bytes]:
        try:
            member = self._archive.getinfo(name)
        except KeyError:
            raise ValueError(f"damaged: {name} is missing") from None
        stored = member.compress_type == zipfile.ZIP_STORED and member.file_size == member.compress_size <= at_most
        if not stored or not 0 <= member.header_offset < self._size:
            raise ValueError(f"damaged: the directory gives {name} a size or a place that it cannot have")
        return self._archive.open(member)

    def contents(self) -> dict[str, Any]:
        """All that is not an array, of a version that this helibore knows."""
        if _CONTENTS not in self._archive.namelist():
            raise ValueError(f"a zip file, but not the archive of a wall (it lacks {_CONTENTS})")
        with self._open(_CONTENTS, min(_LARGEST_CONTENTS, self._size)) as member:
            contents = json.loads(member.read())
        if not isinstance(contents, dict) or contents.get("format") != FORMAT:
            raise ValueError("not the archive of a wall")
        if contents["version"] > VERSION:
            raise ValueError(
                f"an archive of version {contents['version']}, written by helibore "
                f"{contents['helibore']}; this is helibore {_core.__version__}, which reads versions up to {VERSION}"
            )
        return contents

    def array(self, name: str, dtype: str = "<f8", dimensions: int = 1) -> npt.NDArray[Any]:
        """Read one array."""
        with self._open(f"{name}.npy", self._size) as member:
            try:
                np.lib.format.read_magic(member)
                shape, by_columns, stored = np.lib.format.read_array_header_1_0(member)
            except (SyntaxError, TokenError) as error:  # NumPy reads the header as Python
                raise ValueError(f"damaged: the header of {name}") from error
            if stored != np.dtype(dtype) or by_columns or len(shape) != dimensions:
                raise ValueError(f"damaged: {name} is {stored} {shape}")
            if math.prod(shape) * stored.itemsize > self._size:
                raise ValueError(f"damaged: {name} {shape} is larger than the file")
            array: npt.NDArray[Any] = np.empty(shape, stored)
            content = _bytes_of(array)
            for start in range(0, len(content), _PIECE):
                piece = content[start : start + _PIECE]
                piece[:] = member.read(len(piece))
            if member.read(1):  # also makes the checksum of empty members
                raise ValueError(f"damaged: {name} is longer than {shape}")
        return array.astype(stored.newbyteorder("="), copy=False)


def _ailment(path: Path, error: Exception) -> str:
    with path.open("rb") as file:
        begins = file.read(4)
    if not begins:
        return "an empty file, not the archive of a wall"
    if begins != b"PK\x03\x04":
        return f"not the archive of a wall (it begins with {begins!r})"
    return f"truncated or damaged: {error}"


def _wall(members: _Members, threads: int | None, recompute: bool) -> Wall:
    contents = members.contents()
    unknown = sorted(set(contents["settings"]) - {field.name for field in fields(Settings)})
    if unknown:
        raise ValueError(
            f"written by helibore {contents['helibore']} with settings that this helibore "
            f"{_core.__version__} does not have: {', '.join(unknown)}"
        )
    wall = Wall(threads=threads, basis=contents["basis"], **contents["settings"])
    samples = {name: members.array(f"samples/{name}") for name in contents["samples"]}
    if samples:
        wall.append(**samples)
    saved = {name: members.array(f"vertices/{name}", dtype) for name, dtype in _VERTICES.items()}
    if not recompute:
        _require_same(wall, saved, contents)
    if contents["path"] is not None:
        placing = contents["path"] | {"head": tuple(contents["path"]["head"])}
        wall.path = Survey(*(members.array(f"survey/{name}") for name in _STATIONS)).path(**placing)
    for number, image in enumerate(contents["images"]):
        key = image.pop("key")
        depth, values = members.array(f"images/{number}/depth"), members.array(f"images/{number}/values", "<f8", 2)
        wall.images[key] = SectorImage(depth, values, **image)
    for number, row in enumerate(contents["attributes"]):
        start = math.nan if row["start_depth"] is None else row["start_depth"]
        wall.attributes.restore(row["name"], start, members.array(f"attributes/{number}"))
        if row["unit"] is not None:
            wall.attributes.units[row["name"]] = row["unit"]
    wall.made_from = contents["made_from"]
    return wall


def _require_same(wall: Wall, saved: Arrays, contents: dict[str, Any]) -> None:
    """Refuse, unless the samples still make the vertices that were saved."""
    versions = f"helibore {contents['helibore']}, and this helibore {_core.__version__}"
    advice = "hb.load(..., recompute=True) takes what this version makes"
    for name, before in saved.items():
        now: Floats = getattr(wall, name)
        if now.size != before.size:
            raise ValueError(f"{before.size} vertices made by {versions} makes {now.size}; {advice}")
        differ = np.flatnonzero(now.view(f"u{now.itemsize}") != before.view(f"u{before.itemsize}"))
        if differ.size:
            k = differ[0]
            raise ValueError(f"{name}[{k}] = {before[k]} made by {versions} makes {now[k]}; {advice}")
