"""What the viewer keeps of a vertex: four 16-bit numbers, a texel of the page's textures.

radius | radius of the first pass | distance to the nearest sample | state        radius 0: no sample within reach

The highest four bits of the state are a level of the radius's uncertainty: 0 if it is not known, else the half-width of
its 95 % interval is about `LEAST_UNCERTAINTY` 2^(level / 2).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from helibore.base.arrays import Floats, Mask, Unsigned16, numbers

TEXEL = 4
RADIUS, FIRST, NEAREST, STATE = range(TEXEL)
NEAREST_UNIT = 1e-4  # metres per step of a packed distance, 6.55 m at most
SUPPORT_MASK = 0x00FF
RESCANNED, PROVISIONAL, CLIPPED, INTERPOLATED = 0x0100, 0x0200, 0x0400, 0x0800
TOP = 0xFFFF
UNCERTAINTY = 12  # the first bit of the level
MOST_UNCERTAIN = 15  # the highest level
LEAST_UNCERTAINTY = 0.00025  # metres
TRUST = INTERPOLATED | MOST_UNCERTAIN << UNCERTAINTY  # the bits of the state that say how sure a radius is
NORMAL_95 = 1.96  # standard deviations to each side that enclose 95 %


@dataclass(frozen=True)
class Vertices:
    """Values of n consecutive vertices, (n,) each, with names and units as in `Wall`; None: not known."""

    radius: npt.ArrayLike
    nearest: npt.ArrayLike | None = None
    support: npt.ArrayLike | None = None
    provisional: npt.ArrayLike | None = None


def pack_vertices(vertices: Vertices, radius_unit: float) -> Unsigned16:
    """Return the texels (n, 4) of vertices: radius (0 if missing), first-pass radius, nearest distance, state.

    Radii are rounded to ``radius_unit`` metres; a radius above 65535 units becomes 65535 with the mark CLIPPED.
    Distances are rounded to `NEAREST_UNIT`; a larger distance than 6.5535 m, or a missing distance, becomes 6.5535 m.
    At most 255 samples are counted.
    """
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


def pack_trust(interpolated: Mask, sigma: Floats | None) -> Unsigned16:
    """Return the `TRUST` bits of vertices: whether each is interpolated, and its standard uncertainty, metres."""
    bits = np.where(interpolated, INTERPOLATED, 0).astype(np.uint16)
    if sigma is not None:
        known = np.isfinite(sigma)
        half_width = np.maximum(NORMAL_95 * np.where(known, sigma, 0.0), LEAST_UNCERTAINTY)
        level = np.clip(np.rint(2 * np.log2(half_width / LEAST_UNCERTAINTY)), 1, MOST_UNCERTAIN).astype(np.uint16)
        bits |= np.where(known, level << UNCERTAINTY, 0).astype(np.uint16)
    return bits


def radius_of(texels: Unsigned16, radius_unit: float, column: int = RADIUS) -> Floats:
    """Return the packed radii of a column in metres, NaN where there is no radius."""
    steps = texels[..., column].astype(np.float64)
    return np.where(steps == 0, np.nan, steps * radius_unit)
