"""A surface as binary glTF 2.0, written straight from arrays.

    12 bytes  "glTF", version 2, length of the file
    chunk     "JSON": the scene: one node, one mesh, where each array lies in the next chunk
    chunk     "BIN": positions (4 q, 3) float32 | colours (4 q, 4) uint8 | corners (6 q) uint32

trimesh writes the same mesh some eight times slower (it hashes each array and scans each for bounds) and takes longer
to import than all of this to run; the tests read every file back with trimesh. Sections quoted are those of the glTF
2.0 specification. No textures, normals or animation.
"""

from __future__ import annotations

import json
import struct
from typing import Any, BinaryIO

import numpy as np
import numpy.typing as npt

from helibore.arrays import Floats, Integers

_FLOAT, _UNSIGNED_BYTE, _UNSIGNED_INT = 5126, 5121, 5125  # 3.6.2.2
_ARRAY_BUFFER, _ELEMENT_ARRAY_BUFFER = 34962, 34963  # 3.6.2.1


def write_glb(file: BinaryIO, positions: Floats, quads: Integers, colors: npt.NDArray[np.uint8]) -> None:
    """Write quads, each of one colour.

    Quads share no vertices: glTF has colours at vertices only, and a shared one would smear neighbours into each other.
    Without normals, viewers shade each quad flat (3.7.2.1). The middle of the mesh goes into the node's translation,
    which is JSON and so float64; float32 vertices around it are good to half a millimetre as far as 8 km away.

    Parameters
    ----------
    file
        Open for binary writing.
    positions
        (n, 3) float64: north, east, down, metres. Written as (east, up, -north): glTF is Y up and right-handed (3.4).
    quads
        (q, 4) int64 rows of ``positions``, q > 0.
    colors
        (q, 4) uint8, red, green, blue, alpha as screens show them (sRGB).
    """
    y_up = np.stack([positions[:, 1], -positions[:, 2], -positions[:, 0]])
    middle = (y_up.min(axis=1) + y_up.max(axis=1)) / 2
    local = np.empty((len(positions), 3), dtype="<f4")
    np.subtract(y_up.T, middle, out=local, casting="same_kind")
    corners = local.take(quads.reshape(-1), axis=0)
    arrays = [corners, np.repeat(_linear(colors).view("<u4"), 4, axis=0), _triangles(len(quads))]
    scene = _scene(arrays, middle, corners)
    text = json.dumps(scene, separators=(",", ":"), allow_nan=False).encode("ascii")
    text += b" " * (-len(text) % 4)
    binary = sum(array.nbytes for array in arrays)
    file.write(struct.pack("<4sII", b"glTF", 2, 12 + 8 + len(text) + 8 + binary))
    file.write(struct.pack("<I4s", len(text), b"JSON") + text)
    file.write(struct.pack("<I4s", binary, b"BIN\0"))
    for array in arrays:
        file.write(array.data)


def _triangles(quads: int) -> npt.NDArray[np.uint32]:
    """Two triangles a quad, each quad having four corners of its own: (6 q,) rows of corners."""
    first = np.arange(0, 4 * quads, 4, dtype="<u4")[:, None]
    corners: npt.NDArray[np.uint32] = first + np.array([0, 1, 2, 0, 2, 3], dtype="<u4")
    return corners.reshape(-1)


def _linear(colors: npt.NDArray[np.uint8]) -> npt.NDArray[np.uint8]:
    """From sRGB to linear light, which vertex colours are in (3.7.2.1); alpha is linear as it is."""
    share = np.arange(256) / 255
    linear = np.where(share <= 0.04045, share / 12.92, ((share + 0.055) / 1.055) ** 2.4)
    table = np.rint(255 * linear).astype(np.uint8)
    result: npt.NDArray[np.uint8] = table[colors]
    result[:, 3] = colors[:, 3]
    return result


def _scene(arrays: list[npt.NDArray[Any]], middle: Floats, corners: npt.NDArray[np.float32]) -> dict[str, Any]:
    position, color, index = arrays
    offsets = np.cumsum([0, position.nbytes, color.nbytes]).tolist()
    targets = (_ARRAY_BUFFER, _ARRAY_BUFFER, _ELEMENT_ARRAY_BUFFER)
    bounds = [(float(corners[:, axis].min()), float(corners[:, axis].max())) for axis in range(3)]
    return {
        "asset": {"version": "2.0", "generator": "helibore"},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{"name": "wall", "mesh": 0, "translation": middle.tolist()}],
        "meshes": [
            {
                "name": "wall",
                "primitives": [{"attributes": {"POSITION": 0, "COLOR_0": 1}, "indices": 2, "material": 0}],
            }
        ],
        # Seen from inside, too, and without shine.
        "materials": [{"doubleSided": True, "pbrMetallicRoughness": {"metallicFactor": 0, "roughnessFactor": 1}}],
        "accessors": [
            {
                "bufferView": 0,
                "componentType": _FLOAT,
                "count": len(position),
                "type": "VEC3",
                "min": [low for low, _ in bounds],
                "max": [high for _, high in bounds],
            },
            {
                "bufferView": 1,
                "componentType": _UNSIGNED_BYTE,
                "normalized": True,
                "count": len(position),
                "type": "VEC4",
            },
            {"bufferView": 2, "componentType": _UNSIGNED_INT, "count": index.size, "type": "SCALAR"},
        ],
        "bufferViews": [
            {"buffer": 0, "byteOffset": offset, "byteLength": array.nbytes, "target": target}
            for offset, array, target in zip(offsets, arrays, targets, strict=True)
        ],
        "buffers": [{"byteLength": sum(array.nbytes for array in arrays)}],
    }
