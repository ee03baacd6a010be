"""The bytes that the server sends to a page. Little endian; every array starts at a multiple of its item size.

The JSON messages are in ``client.py``; the page reads them in ``connection.js``.

    head, 32 bytes                                              payload of WRITE
    +------+-------+----------+------+-------+-------+          +-------------------------+--------------+----
    | type | level | mask u16 | tile | first | count |  u32 ..  | texels u16 x 4 x count  | f32 x count  | ..
    | u8   | u8    |          | u32  | u32   | u32   |          +-------------------------+--------------+----
    +------+-------+----------+------+-------+-------+           one f32 column per bit of the mask, lowest first
    | total u32    | sequence u32    | time f64      |
    +--------------+-----------------+---------------+

The radii of the first pass are left out of a WRITE where all equal the radii: then `level` has the bit NO_FIRST, and a
texel is radius, nearest distance, state; two zero bytes follow an odd number of them.

A WRITE sets `count` vertices of a tile from `first` on. `first` is 0 at the start of the tile, whose halo (the first
sectors + 1 vertices of the next tile) belongs to it. A WRITE can be repeated: a new quad, a changed one and a resent
one are the same message. `mask` says which attributes follow. The type's highest bit LIVE marks new values, as opposed
to a tile that the page requested. FRAMES carries frames of the path: f64 x 3 x count centres, then f32 x 6 x count
directions. Its `mask` is SURVEYED if a survey places them; without one the hole is drawn straight down, and north is
not known.
"""

from __future__ import annotations

import struct
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from helibore.base.arrays import Floats, numbers

Texels = npt.NDArray[np.uint16]

HEAD = struct.Struct("<BBHIIIIId")
WRITE, FRAMES = 1, 3
LIVE = 0x80
NO_FIRST = 0x80
SURVEYED = 1
FRAMES_LEVEL = 255  # the "level" of the path's frames
FRAME_STEP = 2.0  # metres of depth between frames; a 10 deg/30 m dogleg bows 3 mm between them

TEXEL = 4
RADIUS, FIRST, NEAREST, STATE = range(TEXEL)
NEAREST_UNIT = 1e-4  # metres per step of a packed distance, 6.55 m at most
SUPPORT_MASK = 0x00FF
RESCANNED, PROVISIONAL, CLIPPED, INTERPOLATED = 0x0100, 0x0200, 0x0400, 0x0800
TOP = 0xFFFF


@dataclass(frozen=True)
class Vertices:
    """Values of consecutive vertices, all (n,): radius in metres (NaN: no sample in reach), distance to the nearest
    sample in metres, samples used, and whether the radius came by direct connection."""

    radius: npt.ArrayLike
    nearest: npt.ArrayLike | None = None
    support: npt.ArrayLike | None = None
    provisional: npt.ArrayLike | None = None


def pack_vertices(vertices: Vertices, radius_unit: float) -> Texels:
    """Return the texels (n, 4) of vertices: radius, first-pass radius, nearest distance, state. 0: no radius."""
    radius = numbers(vertices.radius)
    texels = np.zeros((radius.size, TEXEL), np.uint16)
    there = np.isfinite(radius)
    steps = np.rint(np.where(there, radius, 0.0) / radius_unit)
    texels[:, RADIUS] = texels[:, FIRST] = np.where(there, np.clip(steps, 1, TOP), 0)
    if vertices.nearest is not None:
        nearest = numbers(vertices.nearest)
        distance = np.where(np.isfinite(nearest), np.rint(nearest / NEAREST_UNIT), TOP)
        texels[:, NEAREST] = np.clip(distance, 0, TOP)
    support = there.astype(np.int64) if vertices.support is None else numbers(vertices.support, np.int64)
    state = np.clip(support, 0, SUPPORT_MASK).astype(np.uint16)
    state[steps > TOP] |= CLIPPED
    if vertices.provisional is not None:
        state[numbers(vertices.provisional, np.bool_)] |= PROVISIONAL
    texels[:, STATE] = state
    return texels


def radius_of(texels: Texels, radius_unit: float, column: int = RADIUS) -> Floats:
    """Return the packed radii in metres, NaN where there is none."""
    steps = texels[..., column].astype(np.float64)
    return np.where(steps == 0, np.nan, steps * radius_unit)


def head(kind: int, level: int, mask: int, tile: int, first: int, count: int, total: int, time: float) -> bytearray:
    """Return a message's head; `number` sets the sequence number when the message is sent."""
    return bytearray(HEAD.pack(kind, level, mask, tile, first, count, total, 0, time))


def number(message: bytearray, sequence: int) -> bytes:
    """Return the message with its sequence number."""
    struct.pack_into("<I", message, 20, sequence & 0xFFFFFFFF)
    return bytes(message)
