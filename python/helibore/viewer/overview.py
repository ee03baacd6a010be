"""The wall seen from afar: a helix of eight sectors whose pitch is sixteen turns, 1/128 of the vertices.

Overview vertex (R, C) lies at depth start + (R + C / 8) 16 pitch and toolface start + C 45 deg. Its values are means
over the wall's vertices around that point: eight turns up and down, half an overview sector to either side. Missing
radii do not take part; where all are missing the overview is missing too. The nearest-sample distance is the largest
of its window and the support the smallest, so that doubt is never averaged away.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from helibore.viewer import messages

if TYPE_CHECKING:
    from helibore.viewer.scene import Level

Floats = npt.NDArray[np.float64]

TURNS = 16  # turns of the wall in one overview turn
TILE_ROWS = 1024


def sectors(wall_sectors: int) -> int:
    """Sectors of the overview of a wall with `wall_sectors`."""
    return min(8, wall_sectors)


def size_of(wall_size: int, wall_sectors: int) -> int:
    """Overview vertices whose depth the wall has reached."""
    if wall_size == 0:
        return 0
    return (wall_size - 1) * sectors(wall_sectors) // (wall_sectors * TURNS) + 1


def refresh(over: Level, wall: Level, start: int, stop: int) -> tuple[int, int]:
    """Recompute what the wall's vertices [start, stop) can change; return the overview range [start, stop)."""
    K, C = wall.sectors, over.sectors
    before = over.size
    over.reserve(size_of(wall.size, K))
    # A vertex counts in windows that begin up to 2 overview turns above it.
    low = max(0, start // K // TURNS - 1)
    high = min(-(-over.size // C), (stop - 1) // K // TURNS + 2)
    if high <= low:
        return before, over.size
    top = max(0, low * TURNS - TURNS // 2)
    bottom = min(-(-wall.size // K), (high + 1) * TURNS)
    part = slice(top * K, min(bottom * K, len(wall.texels)))
    texels = wall.texels[part].copy()
    texels[max(0, wall.size - part.start) :] = 0
    texels = _whole_turns(texels, K, 0)
    window = _Window(low, high, top, K, C)
    there = texels[..., messages.RADIUS] > 0
    count = window.sums(there)
    packed = np.zeros(((high - low) * C, messages.TEXEL), np.uint16)
    for column in (messages.RADIUS, messages.FIRST):
        packed[:, column] = _mean(window.sums(texels[..., column] * there), count, 0.0).ravel()
    packed[:, messages.NEAREST] = window.extreme(np.maximum, texels[..., messages.NEAREST], 0).ravel()
    support = (texels[..., messages.STATE] & messages.SUPPORT_MASK).astype(np.int64)
    packed[:, messages.STATE] = window.extreme(np.minimum, support, messages.SUPPORT_MASK).ravel()
    end = min(high * C, over.size)
    over.texels[low * C : end] = packed[: end - low * C]
    for target, values in zip(over.columns, wall.columns, strict=True):
        column_part = _whole_turns(values[part].astype(np.float64), K, np.nan)
        known = np.isfinite(column_part)
        mean = _mean(window.sums(np.where(known, column_part, 0.0)), window.sums(known), np.nan)
        target[low * C : end] = mean.ravel()[: end - low * C]
    return min(low * C, before), end


def _whole_turns(values: npt.NDArray[Any], K: int, missing: float) -> npt.NDArray[Any]:
    """Return values as (turns, K, ...), the last turn filled up with `missing`."""
    short = -len(values) % K
    if short:
        values = np.concatenate([values, np.full((short, *values.shape[1:]), missing, values.dtype)])
    return values.reshape(-1, K, *values.shape[1:])


def _mean(total: Floats, count: Floats, missing: float) -> Floats:
    return np.where(count > 0, total / np.maximum(count, 1), missing)


class _Window:
    """The windows of overview turns [low, high) over wall turns that begin at `top`."""

    def __init__(self, low: int, high: int, top: int, K: int, C: int) -> None:
        turn, sector = np.mgrid[low:high, 0:C]
        centre = turn * TURNS + sector * TURNS // C - top
        self.first, self.last = centre - TURNS // 2, centre + TURNS // 2
        self.sector = sector
        away = (np.arange(K)[:, None] * C - np.arange(C)[None, :] * K + K * C // 2) % (K * C) - K * C // 2
        self.members = [np.flatnonzero(row) for row in (np.abs(away) * 2 <= K).T]  # the wall's sectors in each window

    def sums(self, values: npt.NDArray[np.generic]) -> Floats:
        """Sum (turns, K) values over every window, as (high - low, C).

        By rows of whole sectors, not as a product of matrices: a BLAS would start threads of its own for it, which
        wait for each other on a busy machine.
        """
        by_turn = values.T.astype(np.float64, order="C")
        running = np.zeros((len(self.members), by_turn.shape[1] + 1))
        for c, sectors in enumerate(self.members):
            np.cumsum(by_turn[sectors].sum(axis=0), out=running[c, 1:])
        top = by_turn.shape[1]
        first, last = np.clip(self.first, 0, top), np.clip(self.last, 0, top)
        total: Floats = running[self.sector, last] - running[self.sector, first]
        return total

    def extreme(self, pick: np.ufunc, values: npt.NDArray[np.generic], neutral: int) -> npt.NDArray[np.int64]:
        """Largest or smallest (turns, K) value of every window; `neutral` where a window is empty."""
        by_turn = values.T.astype(np.int64, order="C")
        by_sector = np.stack([pick.reduce(by_turn[sectors], axis=0) for sectors in self.members], axis=1)
        rest = np.full((TURNS, by_sector.shape[1]), neutral, np.int64)  # windows may reach over either end
        padded = np.concatenate([rest, by_sector, rest])
        rows = np.clip(self.first + TURNS, 0, len(padded) - TURNS)[..., None] + np.arange(TURNS)
        out: npt.NDArray[np.int64] = pick.reduce(padded[rows, self.sector[..., None]], axis=-1)
        return out
