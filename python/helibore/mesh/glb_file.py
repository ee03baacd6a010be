"""Write a surface as binary glTF 2.0, directly from arrays.

    12 bytes  "glTF", version 2, length of the file
    chunk     "JSON": the scene (one node, one mesh, and where each array lies in the next chunk)
    chunk     "BIN": positions (4 q, 3) float32 | colours (4 q, 4) uint8 | attributes | corners (6 q) uint32

No library is used: trimesh takes three times as long for the same mesh, since it hashes each array (bench/speed).
Numbers such as 3.6.2.2 are sections of the glTF 2.0 specification. The file has no textures, normals or animation.
"""

from __future__ import annotations

import json
import struct
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np

from helibore.base.arrays import Array, Bytes, Floats, Integers
from helibore.base.errors import InputError

MISSING = -999.25  # the usual null value of well logs, exact in float32

BLOCK = 1 << 16
"""Number of quads written at a time, so that their corners take little memory and stay in the processor's cache."""

LARGEST = (1 << 32) - 1
"""Largest size of a GLB in bytes, which its header states in 32 bits (4.4.2)."""

_FLOAT, _UNSIGNED_BYTE, _UNSIGNED_INT = 5126, 5121, 5125  # 3.6.2.2
_ARRAY_BUFFER, _ELEMENT_ARRAY_BUFFER = 34962, 34963  # 3.6.2.1


def check_size(file: Path, quads: int, attributes: int) -> None:
    """Raise an InputError for a mesh too large for a GLB.

    A quad takes 4 corners, each with position, colour and attributes, and 6 indices.
    """
    size = quads * (4 * (12 + 4 + 4 * attributes) + 24) + (1 << 20)
    if size > LARGEST:
        limit = f"{quads:,} quads take {size / 1e9:.1f} GB, and a GLB holds at most {LARGEST / 1e9:.1f}"
        advice = "save .vtkhdf, or make fewer quads by fewer sectors, a larger pitch or a shorter interval"
        raise InputError(str(file), f"{limit}; {advice}")


def write_glb(
    file: BinaryIO,
    positions: Floats,
    quads: Integers,
    colors: Bytes,
    attributes: Mapping[str, Floats],
    extras: Mapping[str, Any],
) -> None:
    """Write quads, each in one colour.

    ``quads`` are (q, 4) int64 row numbers of ``positions``, q above 0; ``colors`` are (q, 4) uint8 sRGB with alpha.

    Positions, (n, 3) north, east, down in metres, are written as (east, up, -north): glTF is Y up and right-handed
    (3.4). Quads share no vertices, because glTF has colours at vertices only, and a shared vertex would mix the colours
    of its quads. Without normals, viewers shade each quad flat (3.7.2.1). The middle of the mesh goes into the node's
    translation, which is JSON and so float64; float32 vertices are then exact to half a millimetre within 8 km of the
    middle. There is no material, because with a material trimesh takes the colours for part of a texture.

    Attributes, (q,) float64 each, become float32 vertex attributes of the application, ``_GR`` for ``GR`` (3.7.2.1).
    Missing values, and values that float32 cannot hold, become -999.25, because glTF forbids NaN (3.6.2.2); the mesh's
    extras state this number. ``extras`` are further JSON values of the mesh's extras.
    """
    middle, local = np.empty(3), np.empty((len(positions), 3), dtype="<f4")
    for axis, (of, sign) in enumerate(((1, 1.0), (2, -1.0), (0, -1.0))):
        along = sign * positions[:, of]
        middle[axis] = (along.min() + along.max()) / 2
        np.subtract(along, middle[axis], out=local[:, axis], casting="same_kind")
    count = len(quads)
    blocks = [slice(first, min(first + BLOCK, count)) for first in range(0, count, BLOCK)]

    def corners(block: slice) -> Array:
        return local.take(quads[block].reshape(-1), axis=0)

    def color(block: slice) -> Array:
        return _at_corners(_linear(colors[block]).view("<u4"))

    def without_nan(of: Floats, block: slice) -> Array:
        there = np.abs(of[block]) <= np.finfo(np.float32).max
        return _at_corners(np.where(there, of[block], MISSING).astype("<f4"))

    def triangles(block: slice) -> Array:
        first = np.arange(4 * block.start, 4 * block.stop, 4, dtype="<u4")[:, None]  # a quad has its own corners
        corner: Array = first + np.array([0, 1, 2, 0, 2, 3], dtype="<u4")
        return corner

    axes = (corners(block).T.copy() for block in blocks)  # along rows NumPy is ten times as fast
    ends = [(of.min(axis=1), of.max(axis=1)) for of in axes]
    least, most = (pick([end[side] for end in ends], axis=0) for side, pick in enumerate((np.min, np.max)))
    views = [
        _View("POSITION", corners, 48, "VEC3", _FLOAT, {"min": least.tolist(), "max": most.tolist()}),
        _View("COLOR_0", color, 16, "VEC4", _UNSIGNED_BYTE, {"normalized": True}),
        *(_View(f"_{name}", partial(without_nan, of), 16, "SCALAR", _FLOAT, {}) for name, of in attributes.items()),
        _View("", triangles, 24, "SCALAR", _UNSIGNED_INT, {}),
    ]
    scene = _scene(views, count, middle, extras)
    text = json.dumps(scene, separators=(",", ":"), allow_nan=False).encode("ascii")
    text += b" " * (-len(text) % 4)
    size = sum(view.bytes for view in views) * count
    file.write(struct.pack("<4sII", b"glTF", 2, 12 + 8 + len(text) + 8 + size))
    file.write(struct.pack("<I4s", len(text), b"JSON") + text)
    file.write(struct.pack("<I4s", size, b"BIN\0"))
    for view in views:
        for block in blocks:
            file.write(view.of(block).data)


@dataclass(frozen=True)
class _View:
    """An array of the file: an attribute of the vertices, or, without a name, the corners of the triangles."""

    name: str
    of: Callable[[slice], Array]  # returns the values of this array for a block of quads
    bytes: int  # number of bytes for each quad
    shape: str
    number: int  # the number that glTF gives to the type of the components
    more: dict[str, Any]  # further entries of this array's accessor


def _at_corners(values: Array) -> Array:
    return np.repeat(values.reshape(-1), 4)


def _linear(colors: Bytes) -> Bytes:
    """Convert sRGB to linear light, as vertex colours require (3.7.2.1); alpha is already linear."""
    share = np.arange(256) / 255
    linear = np.where(share <= 0.04045, share / 12.92, ((share + 0.055) / 1.055) ** 2.4)
    table = np.rint(255 * linear).astype(np.uint8)
    result: Bytes = table[colors]
    result[:, 3] = colors[:, 3]
    return result


def _scene(views: list[_View], quads: int, middle: Floats, extras: Mapping[str, Any]) -> dict[str, Any]:
    accessors: list[dict[str, Any]] = []
    buffer_views: list[dict[str, Any]] = []
    length = 0
    for number, view in enumerate(views):
        count, size = (4 if view.name else 6) * quads, view.bytes * quads
        accessor = {"bufferView": number, "componentType": view.number, "count": count, "type": view.shape}
        accessors.append(accessor | view.more)
        target = _ARRAY_BUFFER if view.name else _ELEMENT_ARRAY_BUFFER
        place = {"buffer": 0, "byteOffset": length, "byteLength": size, "target": target}
        buffer_views.append(place)
        length += size
    attributes = {view.name: number for number, view in enumerate(views) if view.name}
    primitive = {"attributes": attributes, "indices": len(views) - 1}
    return {
        "asset": {"version": "2.0", "generator": "helibore"},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{"name": "wall", "mesh": 0, "translation": middle.tolist()}],
        "meshes": [{"name": "wall", "primitives": [primitive], "extras": {"missing": MISSING, **extras}}],
        "accessors": accessors,
        "bufferViews": buffer_views,
        "buffers": [{"byteLength": length}],
    }
