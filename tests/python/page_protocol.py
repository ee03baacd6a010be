"""The viewer's binary messages read back, as the page reads them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from helibore.viewer.protocol import FRAMES, HEAD, LIVE, NO_FIRST, WRITE
from helibore.viewer.texels import FIRST, RADIUS, TEXEL


@dataclass(frozen=True)
class Message:
    """A WRITE or FRAMES message by its parts."""

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
    texels: np.ndarray
    columns: list[np.ndarray]
    centre: np.ndarray
    directions: np.ndarray


def unpack(message: bytes) -> Message:
    """Read a binary message; its length must be what its head says."""
    kind, level, mask, tile, first, count, total, sequence, time = HEAD.unpack_from(message)
    live, kind = bool(kind & LIVE), kind & ~LIVE
    columns = mask.bit_count() if kind == WRITE else 0
    words = TEXEL - bool(kind == WRITE and level & NO_FIRST)
    texel_bytes = 2 * (words * count + words * count % 2)
    assert len(message) == HEAD.size + {WRITE: texel_bytes + 4 * columns * count, FRAMES: count * 48}[kind]
    at = HEAD.size
    texels, centre, directions = np.zeros((0, TEXEL), np.uint16), np.zeros((0, 3)), np.zeros((0, 6), np.float32)
    if kind == WRITE:
        texels = np.frombuffer(message, "<u2", words * count, at).reshape(-1, words)
        if words < TEXEL:
            texels, level = np.insert(texels, FIRST, texels[:, RADIUS], axis=1), level & ~NO_FIRST
        at += texel_bytes
    else:
        centre = np.frombuffer(message, "<f8", 3 * count, at).reshape(-1, 3)
        directions = np.frombuffer(message, "<f4", 6 * count, at + centre.nbytes).reshape(-1, 6)
    values = [np.frombuffer(message, "<f4", count, at + 4 * count * i) for i in range(columns)]
    return Message(
        kind, live, level, mask, tile, first, count, total, sequence, time, texels, values, centre, directions
    )
