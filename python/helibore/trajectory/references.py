"""Turn toolfaces measured from north or from the high side into the reference of the wall's path.

Looking downhole, with t the tangent, every reference is a direction z at right angles to t, and a toolface is the angle
from z, clockwise. So at one depth, one angle a turns one reference into another (I: inclination, A: azimuth)::

    z_from = cos(a) z_to + sin(a) (t x z_to)            toolface_to = toolface_from + a

    north to high side:  a = atan2(-sin A, cos I cos A);   the usual "subtract the azimuth" is exact only at I = 0

A wall has one reference from top to bottom. The high side has no meaning where the hole is vertical, and it varies
widely where the hole is nearly vertical; north has no meaning where the hole is horizontal and points north or south.
So a well from vertical to horizontal needs the **parallel-transport** reference. It starts as north, and down the hole
it turns with the tangent but never about it (the rotation-minimising frame; Bishop, Am. Math. Monthly 82 (1975) 246). A
straight line drawn along the wall keeps its angle, whatever angles the tool measured. In a well that builds at one
azimuth A the high side lies at toolface A all the way down. The angle at a depth depends only on the path above it.

Not supported: magnetic declination and grid convergence (north is the north of the survey), and toolfaces measured
from the dipping magnetic field itself.
"""

from __future__ import annotations

from typing import Any, Literal, Protocol, get_args

import numpy as np
import numpy.typing as npt

from helibore.base.angles import wrapped
from helibore.base.arrays import Floats, Mask, finite_column
from helibore.base.errors import InputError

__all__ = [
    "ASSUMED", "REFERENCES", "Reference", "defined", "from_high_side", "onto_path", "reference_assumed", "reference_of",
]  # fmt: skip

ASSUMED = "assumed"
Reference = Literal["high-side", "north", "parallel-transport"]
"""What toolface 0 of a path, a wall or an image points to."""

REFERENCES: tuple[Reference, ...] = get_args(Reference)

_LEAST_ANGLE = 1e-6  # radians between reference and tangent, the same limit as in all of helibore


class FramedPath(Protocol):
    """The part of a path that a change of reference needs; `helibore.Path` has it."""

    @property
    def reference(self) -> Reference: ...
    def tangent(self, depth: npt.ArrayLike) -> Floats: ...
    def frame(self, depth: npt.ArrayLike) -> Floats: ...


def reference_of(wall: Any) -> Reference | None:
    """Return what toolface 0 of a wall is, as its path or else its first image states; None if neither states it."""
    stated = [getattr(wall, "path", None), *getattr(wall, "images", {}).values()]
    return next((one.reference for one in stated if one is not None), None)


def reference_assumed(wall: Any) -> bool:
    """Return whether the reference of a wall's toolfaces is only assumed, because no file states it."""
    return bool(getattr(wall, "made_from", {}).get("toolface") == ASSUMED)


def from_high_side(inclination: npt.ArrayLike, low: float = 4.0, high: float = 6.0) -> Mask:
    """Return which toolfaces count from the high side if the tool switches by inclination: (n,) bool for `onto_path`.

    Such a tool counts from north until the inclination rises to ``high`` degrees, and then from the high side until the
    inclination falls to ``low`` degrees. If the first inclination lies between these limits, the tool starts with the
    reference of the nearer limit. ``inclination`` is that of each sample in order of time, (n,) degrees, finite.
    """
    inclined = finite_column("inclination", inclination)
    if not 0 <= low <= high:
        raise InputError(f"low = {low:g}, high = {high:g}", "must be 0 <= low <= high")
    if inclined.size == 0:
        return np.empty(0, dtype=bool)
    decided = (inclined >= high) | (inclined <= low)
    steep = np.where(decided, inclined >= high, inclined >= 0.5 * (low + high))
    decided[0] = True
    last = np.maximum.accumulate(np.where(decided, np.arange(inclined.size), 0))
    return steep[last]


def defined(path: FramedPath, depth: npt.ArrayLike, high_side: bool) -> Mask:
    """Return at which depths the path's reference and the high side are both defined, (n,) bool.

    If ``high_side`` is False, north takes the place of the high side.
    """
    north, east, down = path.tangent(finite_column("depth", depth)).T
    sine = {"high-side": np.hypot(north, east), "north": np.hypot(east, down)}
    own = sine["high-side" if high_side else "north"]
    sure: Mask = np.minimum(own, sine.get(path.reference, 1.0)) > 2.0 * _LEAST_ANGLE
    return sure


def onto_path(toolface: npt.ArrayLike, depth: npt.ArrayLike, path: FramedPath, high_side: Mask | bool) -> Floats:
    """Turn toolfaces measured from north or from the high side into the reference of the path; new, (n,) in [0, 360).

    Toolfaces in degrees and depths in metres are (n,) and finite. ``high_side`` is True where a sample counts from the
    high side, and False where it counts from north; (n,) bool, or one bool for all samples. Raises InputError if
    lengths differ, a value is not finite, the path does not reach a depth, or a reference is undefined there.
    """
    angle = finite_column("toolface", toolface)
    where = finite_column("depth", depth, angle.size, "toolface")
    if np.ndim(high_side) and np.shape(high_side) != angle.shape:
        raise InputError(f"high_side has shape {np.shape(high_side)}, toolface has {angle.shape}", "must be equal")
    frame = path.frame(where)
    tangent = frame[:, 2]
    # The direction of the tag, up = (0, 0, -1) or north = (1, 0, 0), less its part along the hole. The length of the
    # difference, which is the sine of the angle between tag and hole, cancels in atan2.
    pole = np.where(np.reshape(high_side, (-1, 1)), np.array([0.0, 0.0, -1.0]), np.array([1.0, 0.0, 0.0]))
    square = pole - (pole * tangent).sum(axis=1, keepdims=True) * tangent
    undefined = np.linalg.norm(square, axis=1) < _LEAST_ANGLE
    if undefined.any():
        at = int(np.argmax(undefined))
        tag = "the high side" if np.broadcast_to(high_side, angle.shape)[at] else "north"
        rule = "vertical" if tag == "the high side" else "horizontal and points north or south"
        raise InputError(f"toolface[{at}] at depth {where[at]:g}", f"{tag} is undefined where the hole is {rule}")
    ahead, aside = (square * frame[:, 0]).sum(axis=1), (square * frame[:, 1]).sum(axis=1)
    return wrapped(angle + np.degrees(np.arctan2(aside, ahead)))
