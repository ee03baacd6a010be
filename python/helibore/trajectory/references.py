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

The azimuth of a pad (P1AZ) is another kind of angle: it lies in the horizontal plane, not across the hole. For a hole
inclined by 30 degrees the two differ by up to 4 degrees, for 60 degrees by up to 20 (RB: relative bearing, from the
high side; P: the azimuth)::

    RB = atan2(sin(P - A) cos I, cos(P - A))            P = A + atan2(sin RB, cos RB cos I)         (for I below 90)

An azimuth also has a north: true, magnetic or grid (`Norths`)::

    true = magnetic + declination                       grid = true - convergence

Not supported: toolfaces measured from the dipping magnetic field itself.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal, Protocol, get_args

import numpy as np
import numpy.typing as npt

from helibore.base.angles import wrapped
from helibore.base.arrays import Floats, Mask, finite_column
from helibore.base.errors import InputError, check_choice
from helibore.settings.path_settings import North, Reference

__all__ = [
    "ASSUMED", "NORTHS", "REFERENCES", "AngleReference", "North", "Norths", "Plane", "Reference", "defined",
    "from_high_side", "horizontal_to_north", "onto_path", "reference_assumed", "reference_of", "to_high_side",
]  # fmt: skip

ASSUMED = "assumed"
"""What toolface 0 of a path, a wall or an image points to."""

REFERENCES: tuple[Reference, ...] = get_args(Reference)

NORTHS: tuple[North, ...] = get_args(North)

Plane = Literal["section", "horizontal"]
"""The plane an angle lies in: across the hole, or horizontal."""

_LEAST_ANGLE = 1e-6  # radians between reference and tangent, the same limit as in all of helibore


@dataclass(frozen=True)
class AngleReference:
    """What a toolface counts from: its zero, the plane that it lies in, and which north.

    Attributes
    ----------
    zero
        "high-side" or "north".
    plane
        "section", across the hole, or "horizontal", as the azimuth of a pad.
    north
        "true", "magnetic" or "grid"; "" if it is not stated, or for the high side.
    """

    zero: Literal["high-side", "north"]
    plane: Plane = "section"
    north: str = ""

    def __post_init__(self) -> None:
        check_choice("zero", self.zero, ("high-side", "north"))
        check_choice("plane", self.plane, get_args(Plane))
        check_choice("north", self.north, ("", *NORTHS))
        if self.zero == "high-side" and (self.plane != "section" or self.north):
            raise InputError("zero", "an angle from the high side lies across the hole and has no north", "high-side")

    @classmethod
    def named(cls, name: str, north: str = "") -> AngleReference:
        """Return the reference of a name that files and settings use: high-side, north or horizontal-north."""
        check_choice("reference", name, ("high-side", "north", "horizontal-north"))
        if name == "high-side":
            return cls("high-side")
        return cls("north", "horizontal" if name == "horizontal-north" else "section", north)

    def __str__(self) -> str:
        if self.zero == "high-side":
            return "the high side"
        plane = "in the horizontal plane" if self.plane == "horizontal" else "across the hole"
        return f"{self.north} north, {plane}".lstrip()


@dataclass(frozen=True)
class Norths:
    """The angles between true, magnetic and grid north at a well, degrees; None where it is not known.

    Attributes
    ----------
    declination
        Azimuth of magnetic north from true north, positive to the east: true = magnetic + declination.
    convergence
        Azimuth of grid north from true north, positive to the east: grid = true - convergence.
    """

    declination: float | None = None
    convergence: float | None = None

    def __post_init__(self) -> None:
        for name, value in vars(self).items():
            if value is not None and not -180.0 <= value <= 180.0:
                raise InputError(name, "must lie within -180 and 180 degrees", f"{value:g}")

    def turn(self, source: str, target: str) -> float:
        """Return the degrees to add to an azimuth from the north ``source`` so that it counts from ``target``.

        A north that is not stated ("") is the other one. Raises InputError if an angle is needed that is not known.
        """
        if not source or not target or source == target:
            return 0.0
        return self._to_true(source, source, target) - self._to_true(target, source, target)

    def _to_true(self, north: str, source: str, target: str) -> float:
        if north == "true":
            return 0.0
        name = "declination" if north == "magnetic" else "convergence"
        value: float | None = getattr(self, name)
        if value is None:
            raise InputError(name, f"must be given: it turns azimuths from {source} north to {target} north")
        return value


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


def to_high_side(
    angle: npt.ArrayLike, inclination: npt.ArrayLike, azimuth: npt.ArrayLike, plane: Plane = "horizontal"
) -> Floats:
    """Turn angles from north into toolfaces from the high side, by the hole's direction at each; new, (n,) in [0, 360).

    Parameters
    ----------
    angle
        Degrees from north, (n,): in the horizontal plane, as the azimuth of a pad, or across the hole.
    inclination, azimuth
        Of the hole at each angle, degrees from the same north, (n,).
    plane
        The plane that the angles lie in.

    Notes
    -----
    NaN give NaN. At inclination 90 the horizontal plane does not show a toolface, and the result is NaN.
    """
    cosine = np.cos(np.radians(inclination))
    if plane == "section":
        away = np.radians(azimuth)
        return wrapped(np.add(angle, np.degrees(np.arctan2(-np.sin(away), cosine * np.cos(away)))))
    off = np.radians(np.subtract(angle, azimuth))
    cosine = np.where(np.abs(cosine) > _LEAST_ANGLE, cosine, np.nan)
    # Beyond 90 degrees the hole points up, and its high side points the other way over the ground.
    return wrapped(np.degrees(np.arctan2(np.sin(off) * np.abs(cosine), np.cos(off) * np.sign(cosine))))


def horizontal_to_north(angle: npt.ArrayLike, inclination: npt.ArrayLike, azimuth: npt.ArrayLike) -> Floats:
    """Turn azimuths of a pad into toolfaces from north across the hole; new, (n,) in [0, 360).

    The arguments are those of `to_high_side`. Unlike the high side, this is also well defined where the hole is nearly
    vertical: there the azimuth of the hole hardly matters.
    """
    origin = to_high_side(0.0, inclination, azimuth, "section")
    return wrapped(to_high_side(angle, inclination, azimuth) - origin)


def onto_path(
    toolface: npt.ArrayLike,
    depth: npt.ArrayLike,
    path: FramedPath,
    high_side: Mask | bool,
    *,
    horizontal: Mask | bool = False,
    north: npt.ArrayLike = 0.0,
) -> Floats:
    """Turn toolfaces measured from north or from the high side into the reference of the path; new, (n,) in [0, 360).

    Parameters
    ----------
    toolface, depth
        Degrees and metres, (n,), finite.
    path
        The path; its reference is that of the result.
    high_side
        True where a sample counts from the high side, and False where it counts from north; (n,) bool, or one bool.
    horizontal
        True where the angle of a sample from north lies in the horizontal plane; (n,) bool, or one bool.
    north
        Azimuth of the toolfaces' north, degrees from the path's north (`Norths.turn`); (n,), or one number.

    Raises
    ------
    InputError
        If lengths differ, a value is not finite, the path does not reach a depth, or a reference is undefined there.
    """
    angle = finite_column("toolface", toolface)
    where = finite_column("depth", depth, angle.size, "toolface")
    for name, mask in (("high_side", high_side), ("horizontal", horizontal)):
        if np.ndim(mask) and np.shape(mask) != angle.shape:
            raise InputError(f"{name} has shape {np.shape(mask)}, toolface has {angle.shape}", "must be equal")
    frame = path.frame(where)
    tangent = frame[:, 2]
    up, flat = np.broadcast_to(high_side, angle.shape), np.broadcast_to(horizontal, angle.shape)
    # The direction of the tag, up = (0, 0, -1) or north, less its part along the hole. The length of the difference,
    # which is the sine of the angle between tag and hole, cancels in atan2.
    bearing = np.radians(np.where(flat, angle, 0.0) + north)
    pole = np.where(up, [[0.0], [0.0], [-1.0]], [np.cos(bearing), np.sin(bearing), np.zeros(angle.size)]).T
    square = pole - (pole * tangent).sum(axis=1, keepdims=True) * tangent
    # A pad over the ground in direction p looks along w = p + z down, square to the tangent t: z = -(p t) / t_z.
    if flat.any():
        fall = tangent[:, 2:]
        level = np.sign(fall) * (fall * pole - (pole * tangent).sum(axis=1, keepdims=True) * [0.0, 0.0, 1.0])
        square = np.where(flat[:, None], level, square)
    undefined = np.where(flat, np.abs(tangent[:, 2]), np.linalg.norm(square, axis=1)) < _LEAST_ANGLE
    if undefined.any():
        at = int(np.argmax(undefined))
        tag, rule = "north", "horizontal and points north or south"
        if flat[at]:
            tag, rule = "a toolface in the horizontal plane", "horizontal"
        elif up[at]:
            tag, rule = "the high side", "vertical"
        raise InputError(f"toolface[{at}] at depth {where[at]:g}", f"{tag} is undefined where the hole is {rule}")
    ahead, aside = (square * frame[:, 0]).sum(axis=1), (square * frame[:, 1]).sum(axis=1)
    return wrapped(np.where(flat, 0.0, angle) + np.degrees(np.arctan2(aside, ahead)))
