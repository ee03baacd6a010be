"""The bytes between server and page. Little endian; every array starts at a multiple of its item size.

    head, 32 bytes                                              payload of WRITE
    +------+-------+----------+------+-------+-------+          +-------------------------+--------------+----
    | type | level | mask u16 | tile | first | count |  u32 ..  | texels u16 x 4 x count  | f32 x count  | ..
    | u8   | u8    |          | u32  | u32   | u32   |          +-------------------------+--------------+----
    +------+-------+----------+------+-------+-------+           one f32 column per bit of the mask, lowest first
    | total u32    | sequence u32    | time f64      |
    +--------------+-----------------+---------------+

A WRITE sets `count` vertices of a tile from `first` on, both in the tile's own numbers, the halo (the first
sectors + 1 vertices of the next tile) included. It is idempotent: a new quad, a patched one and a resent one are the
same message. `mask` says which attributes follow; its highest type bit LIVE tells a fresh write from a tile asked for.
FRAMES carries frames of the path: f64 x 3 x count centres, then f32 x 6 x count directions. Its `mask` is SURVEYED
where they lie on a survey's path; without one the hole is drawn straight down, and north and true depth are not known.
"""

from __future__ import annotations

import struct
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from helibore.base.arrays import numbers

Texels = npt.NDArray[np.uint16]

HEAD = struct.Struct("<BBHIIIIId")
WRITE, FRAMES = 1, 3
LIVE = 0x80  # in `type`: the values are news, not a tile the page has just asked for
SURVEYED = 1  # in `mask` of FRAMES
FRAMES_LEVEL = 255  # the "level" under which the path's frames are marked
FRAME_STEP = 2.0  # metres of depth between frames; a 10 deg/30 m dogleg bows 3 mm between them

TEXEL = 4
RADIUS, FIRST, NEAREST, STATE = range(TEXEL)
NEAREST_UNIT = 1e-4  # metres per step of a packed distance, 6.55 m at most
SUPPORT_MASK = 0x00FF
RESCANNED, PROVISIONAL, CLIPPED = 0x0100, 0x0200, 0x0400
TOP = 0xFFFF


@dataclass(frozen=True)
class Vertices:
    """Values of consecutive vertices, all (n,): radius in metres (NaN: nothing in reach), distance to the nearest
    sample in metres, samples used, and whether the radius came by direct connection."""

    radius: npt.ArrayLike
    nearest: npt.ArrayLike | None = None
    support: npt.ArrayLike | None = None
    provisional: npt.ArrayLike | None = None


@dataclass(frozen=True)
class Write:
    """A WRITE or FRAMES message taken apart; what the page does, for tests and for clients in Python."""

    kind: int
    live: bool
    level: int
    mask: int
    tile: int
    first: int
    count: int
    total: int
    sequence: int
    time: float
    texels: Texels
    columns: list[npt.NDArray[np.float32]]
    centre: npt.NDArray[np.float64]
    directions: npt.NDArray[np.float32]


def pack_vertices(vertices: Vertices, radius_unit: float) -> Texels:
    """Return the texels (n, 4) of `vertices`: radius, first-pass radius, nearest distance, state. No radius is 0."""
    radius = numbers(vertices.radius)
    texels = np.zeros((radius.size, TEXEL), np.uint16)
    there = np.isfinite(radius)
    steps = np.rint(np.where(there, radius, 0.0) / radius_unit)
    texels[:, RADIUS] = np.where(there, np.clip(steps, 1, TOP), 0)
    texels[:, FIRST] = texels[:, RADIUS]
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


def radius_of(texels: Texels, radius_unit: float, column: int = RADIUS) -> npt.NDArray[np.float64]:
    """Return the packed radii in metres, NaN where there is none."""
    steps = texels[..., column].astype(np.float64)
    return np.where(steps == 0, np.nan, steps * radius_unit)


def head(kind: int, level: int, mask: int, tile: int, first: int, count: int, total: int, time: float) -> bytearray:
    """Return a message's head; `number` fills the sequence in when it is sent."""
    return bytearray(HEAD.pack(kind, level, mask, tile, first, count, total, 0, time))


def number(message: bytearray, sequence: int) -> bytes:
    """Write the sequence number into a message."""
    struct.pack_into("<I", message, 20, sequence & 0xFFFFFFFF)
    return bytes(message)


def unpack(message: bytes) -> Write:
    """Take a binary message apart.

    Raises
    ------
    ValueError
        If the message is shorter than its head says, or of an unknown type.
    """
    if len(message) < HEAD.size:
        raise ValueError(f"message of {len(message)} bytes: a head has {HEAD.size}")
    kind, level, mask, tile, first, count, total, sequence, time = HEAD.unpack_from(message)
    live, kind = bool(kind & LIVE), kind & ~LIVE
    columns = mask.bit_count()
    size = {WRITE: count * (2 * TEXEL + 4 * columns), FRAMES: count * 48}.get(kind)
    if size is None:
        raise ValueError(f"message type {kind}: must be {WRITE} or {FRAMES}")
    if len(message) != HEAD.size + size:
        raise ValueError(f"message of {len(message)} bytes: its head says {HEAD.size + size}")
    at = HEAD.size
    texels, centre = np.zeros((0, TEXEL), np.uint16), np.zeros((0, 3))
    directions, values = np.zeros((0, 6), np.float32), []
    if kind == WRITE:
        texels = np.frombuffer(message, "<u2", TEXEL * count, at).reshape(-1, TEXEL)
        at += texels.nbytes
        values = [np.frombuffer(message, "<f4", count, at + 4 * count * i) for i in range(columns)]
    else:
        centre = np.frombuffer(message, "<f8", 3 * count, at).reshape(-1, 3)
        directions = np.frombuffer(message, "<f4", 6 * count, at + centre.nbytes).reshape(-1, 6)
    return Write(kind, live, level, mask, tile, first, count, total, sequence, time, texels, values, centre, directions)
