"""The archive of a wall: `Wall.save` writes it, and `hb.load` reopens the wall from it.

The archive is a zip file, in which each array is a member:

    helibore.json               format, version, settings, basis, start_depth, path, images, made_from
    samples/depth ...           toolface, radius, and time if samples have times; in canonical order
    arms/depth ...              toolface, radius, time, arm        samples of a tool with few arms, as appended
    vertices/radius ...         nearest, support, iterations
    survey/depth ...            inclination, azimuth               if the wall has a path
    images/0/depth              images/0/values ...                if the wall has images
    attributes/0 ...            one value for each quad of the whole wall

A member is the header of a NumPy array, then its values as 64-bit words, compressed as ``helibore/compression.hpp`` of
the core describes. If all samples of the wall have arms, they are stored once, as ``arms``. Archives of version 1 hold
``NAME.npy`` instead, NumPy arrays without compression, and always the samples.

A zip file needs no extra library, every member has a CRC-32, and a truncated file lacks the directory at its end.
``helibore.wall.load`` appends the samples to an empty wall and compares the result with the stored vertices. This file
reads and writes a `WallColumns`, and does not import `Wall`.
"""

from __future__ import annotations

import json
import math
import os
import zipfile
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import asdict
from pathlib import Path
from tokenize import TokenError
from typing import IO, Any, BinaryIO

import numpy as np

from helibore import _core
from helibore.base.arrays import Array, Floats, Unsigned64
from helibore.base.atomic_file import write_whole
from helibore.base.errors import InputError
from helibore.base.file_endings import ARCHIVE_ENDING
from helibore.base.limits import check_unpacked
from helibore.base.regular_file import check_regular
from helibore.base.zip_errors import DAMAGED_ZIP
from helibore.settings.wall_settings import Settings
from helibore.wall.wall_columns import WallColumns

FORMAT, VERSION = "helibore wall", 2
UNITS = (
    "metres and degrees; depth along the hole, positive down; toolface clockwise looking downhole; radius from the axis"
)

_CONTENTS = "helibore.json"
_LARGEST_CONTENTS = 1 << 26  # bytes of JSON
_CHUNK = 1 << 20  # bytes; stays in the cache between checksum and copy
_WORD = 8  # bytes of a word
SAMPLES = ("depth", "toolface", "radius", "time")
ARMS = {**dict.fromkeys(SAMPLES, "<f8"), "arm": "<i8"}
VERTICES = {"radius": "<f8", "nearest": "<f8", "support": "<i4", "iterations": "<i4"}
STATIONS = ("depth", "inclination", "azimuth")
_IMAGE = ("name", "unit", "origin", "reference", "direction", "offset", "reach")

Arrays = dict[str, Array]


def save(wall: WallColumns, filename: str | os.PathLike[str]) -> None:
    """Write ``wall`` to ``filename``, as `Wall.save` describes."""
    path = Path(filename)
    if path.suffix.lower() != ARCHIVE_ENDING:
        rule = f"the archive of a wall ends in {ARCHIVE_ENDING}; wall.surface().save() writes meshes"
        raise InputError(str(path), rule)
    arrays, contents = _contents(wall)
    text = json.dumps(contents, indent=1).encode()

    def write(file: BinaryIO) -> None:
        with zipfile.ZipFile(file, "w", zipfile.ZIP_STORED) as archive:
            archive.writestr(zipfile.ZipInfo(_CONTENTS), text)  # dated 1980, so that the same wall gives the same bytes
            for name, values in arrays.items():
                array = np.require(values, requirements="C")
                with archive.open(zipfile.ZipInfo(name), "w", force_zip64=True) as member:
                    np.lib.format.write_array_header_1_0(member, np.lib.format.header_data_from_array_1_0(array))
                    member.write(_core.compress(_words(array)).data)

    write_whole(path, write)


@contextmanager
def opened(filename: str | os.PathLike[str]) -> Iterator[Members]:
    """Open an archive and yield its `Members`; if it is damaged, raise an `InputError` that names the file."""
    path = Path(filename)
    check_regular(path)
    with path.open("rb") as file:
        try:
            with zipfile.ZipFile(file) as archive:
                yield Members(archive, path.stat().st_size)
        except DAMAGED_ZIP as error:
            raise InputError(str(path), _reason(path, error)) from error
        except (AttributeError, KeyError, OverflowError, TypeError) as error:
            raise InputError(str(path), f"not the archive of a wall: {error!r} in {_CONTENTS}") from error
        except InputError as error:
            raise error.within(str(path)) from error
        except ValueError as error:
            raise InputError(str(path), str(error)) from error


# ------------------------------------------------------------------ writing


def _contents(wall: WallColumns) -> tuple[Arrays, dict[str, Any]]:
    """Return the arrays of a wall by name, and everything else as JSON values."""
    try:
        same = json.loads(json.dumps(wall.made_from, allow_nan=False)) == wall.made_from
    except (TypeError, ValueError) as error:
        raise InputError("made_from", f"must be what JSON can hold: {error}") from error
    if not same:
        raise InputError("made_from", "must be what JSON can hold: lists, not tuples, and texts as keys")
    arms = {} if wall.arms is None else {name: getattr(wall.arms, name) for name in ARMS}
    arms = {name: of for name, of in arms.items() if of is not None}
    once = bool(arms) and _same_rows(wall.sample_columns, tuple(arms[name] for name in SAMPLES if name in arms))
    samples = {} if once else dict(zip(SAMPLES, wall.sample_columns, strict=False))
    arrays: Arrays = {f"samples/{name}": of for name, of in samples.items()}
    arrays |= {f"vertices/{name}": getattr(wall, name) for name in VERTICES}
    arrays |= {f"arms/{name}": of for name, of in arms.items()}
    placing: dict[str, Any] | None = None
    if wall.path is not None:
        path = wall.path
        arrays |= {f"survey/{name}": getattr(path.survey, name) for name in STATIONS}
        placing = {"method": path.method, "reference": path.reference, "head": path.head, "extend": path.extend}
        placing |= {"north": path.survey.north} if path.survey.north else {}
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
        "settings": _settings(wall.settings),
        "basis": wall.basis,
        "start_depth": _or_null(wall.start_depth),
        "samples": list(samples),
        "arms": list(arms),
        "path": placing,
        "images": images,
        "attributes": attributes,
        "made_from": wall.made_from,
        **_intervals(wall),
    }


def _settings(settings: Settings) -> dict[str, Any]:
    """Return the settings by name, without later ones that are not set: an archive older than they keeps its bytes."""
    later = {"covariance": None, "other_turns": None, "stretches": None, "arm_biases": None, "robust": False}
    return {name: value for name, value in asdict(settings).items() if name not in later or value != later[name]}


def _intervals(wall: WallColumns) -> dict[str, Any]:
    """Return the named intervals; {} without any: an archive older than they are keeps its bytes."""
    named = [one.as_row() for one in wall.intervals]
    return {"intervals": named} if named else {}


def _or_null(number: float) -> float | None:
    return None if math.isnan(number) else number


def _words(array: Array) -> Unsigned64:
    """Return numbers as 64-bit words, (n,): a view of floats and of whole numbers of 64 bits, else a copy."""
    whole = array if array.itemsize == _WORD else array.astype(np.int64)
    return whole.reshape(-1).view(np.uint64)


def _same_rows(one: tuple[Floats, ...], other: tuple[Floats, ...]) -> bool:
    """Return whether two sets of columns have the same rows, in whatever order, by the sums of hashes of the rows."""
    same = len(one) == len(other) and one[0].size == other[0].size
    return same and _core.sum_of_rows(one) == _core.sum_of_rows(other)


# ------------------------------------------------------------------ reading


class Members:
    """Read and check the members of an archive, each as a whole."""

    def __init__(self, archive: zipfile.ZipFile, size: int) -> None:
        self._archive, self._size, self._version = archive, size, VERSION

    def _open(self, name: str, at_most: int) -> IO[bytes]:
        try:
            member = self._archive.getinfo(name)
        except KeyError:
            raise InputError("damaged", f"{name} is missing") from None
        stored = member.compress_type == zipfile.ZIP_STORED and member.file_size == member.compress_size <= at_most
        if not stored or not 0 <= member.header_offset < self._size:
            raise InputError("damaged", f"the directory gives {name} a size or a place that it cannot have")
        return self._archive.open(member)

    def contents(self) -> dict[str, Any]:
        """Return the JSON contents of the archive; refuse a version that this helibore does not know."""
        if _CONTENTS not in self._archive.namelist():
            raise ValueError(f"a zip file, but not the archive of a wall (it lacks {_CONTENTS})")
        with self._open(_CONTENTS, min(_LARGEST_CONTENTS, self._size)) as member:
            contents = json.loads(member.read())
        if not isinstance(contents, dict) or contents.get("format") != FORMAT:
            raise ValueError("not the archive of a wall")
        if contents["version"] > VERSION:
            own = f"this is helibore {_core.__version__}, which reads versions up to {VERSION}"
            written = f"an archive of version {contents['version']}, written by helibore {contents['helibore']}"
            raise ValueError(f"{written}; {own}")
        self._version = contents["version"]
        return contents

    def array(self, name: str, dtype: str = "<f8", dimensions: int = 1) -> Array:
        """Return an array by its name, from an archive of any version; refuse another dtype or number of dimensions."""
        plain = self._version == 1
        with self._open(f"{name}.npy" if plain else name, self._size) as member:
            try:
                np.lib.format.read_magic(member)
                shape, by_columns, stored = np.lib.format.read_array_header_1_0(member)
            except (SyntaxError, TokenError) as error:  # NumPy reads the header as Python
                raise InputError("damaged", f"the header of {name}") from error
            if stored != np.dtype(dtype) or by_columns or len(shape) != dimensions:
                raise InputError("damaged", f"{name} is {stored} {shape}")
            if plain and math.prod(shape) * stored.itemsize > self._size:
                raise InputError("damaged", f"{name} {shape} is larger than the file")
            check_unpacked(name, _WORD * math.prod(shape), self._size)
            read = _plain if plain else _compressed
            return read(member, name, shape, stored).astype(stored.newbyteorder("="), copy=False)


def _compressed(member: IO[bytes], name: str, shape: tuple[int, ...], stored: np.dtype[Any]) -> Array:
    words = np.empty(math.prod(shape), np.uint64)
    try:
        _core.decompress(np.frombuffer(member.read(), np.uint8), words)
    except InputError as error:
        raise InputError("damaged", f"{name} {shape}: {error}") from error
    same: Array = words.view(stored) if stored.itemsize == _WORD else words.view(np.int64).astype(stored)
    return same.reshape(shape)


def _plain(member: IO[bytes], name: str, shape: tuple[int, ...], stored: np.dtype[Any]) -> Array:
    """Read an array of version 1."""
    array: Array = np.empty(shape, stored)
    content = array.reshape(-1).view(np.uint8).data
    for start in range(0, len(content), _CHUNK):
        chunk = content[start : start + _CHUNK]
        read = member.read(len(chunk))
        if len(read) < len(chunk):
            raise InputError("damaged", f"{name} is shorter than {shape}")
        chunk[:] = read
    if member.read(1):  # reading to the end checks the CRC-32 of empty members, too
        raise InputError("damaged", f"{name} is longer than {shape}")
    return array


def _reason(path: Path, error: Exception) -> str:
    with path.open("rb") as file:
        begins = file.read(4)
    if not begins:
        return "an empty file, not the archive of a wall"
    if begins != b"PK\x03\x04":
        return f"not the archive of a wall (it begins with {begins!r})"
    return f"truncated or damaged: {error}"
