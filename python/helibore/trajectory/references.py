"""What toolfaces are measured from: samples tagged north or high side, turned into the reference of the wall's path.

Looking downhole, with t the tangent, every reference is a direction z square to t, and a toolface is the angle from z,
clockwise. From one reference to another, at one depth, is therefore one angle::

    z_from = cos(a) z_to + sin(a) (t x z_to)            toolface_to = toolface_from + a

    north to high side:  a = atan2(-sin A, cos I cos A);   the usual "less the azimuth" holds at I = 0 alone

A wall has one reference from top to bottom. The high side has no meaning where the hole is vertical and swings about
close to it; north has none where the hole runs level north or south. So a well from vertical to horizontal wants the
**parallel-transport** reference (``survey.path(reference="parallel-transport")``): it starts as north, and goes down
the hole turning with the tangent but never about it (the rotation-minimising frame; Bishop, Am. Math. Monthly 82 (1975)
246). A straight line drawn along the wall keeps its angle, whatever the tool called it, and in a well that builds at
one azimuth A the high side lies at toolface A of this reference all the way down.

This angle depends on the path above it and on nothing below. Not here: magnetic declination and grid convergence
(north is the north of the survey), and toolfaces measured against the dipping magnetic field itself.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from helibore.base.angles import wrapped
from helibore.base.arrays import Floats, column
from helibore.trajectory.survey import Path

__all__ = ["defined", "from_high_side", "north_to_high_side", "onto_path"]

_LEAST_ANGLE = 1e-6  # radians between reference and tangent, as everywhere in helibore


def north_to_high_side(inclination: npt.ArrayLike, azimuth: npt.ArrayLike) -> Floats:
    """Degrees to add to a toolface from north to get it from the high side: atan2(-sin A, cos I cos A), exact.

    Parameters
    ----------
    inclination, azimuth
        Of the hole there, degrees, (n,), finite.

    Returns
    -------
    ndarray
        (n,) in [0, 360), new. At inclination 0 it is -azimuth: the limit along that azimuth. At I = 48, A = 248 it is
        105.13, where "less the azimuth" gives 112.

    Raises
    ------
    ValueError
        If lengths differ, a value is not finite, or north is undefined: the hole runs level north or south.
    """
    inclined = np.radians(_finite("inclination", column("inclination", inclination)))
    heading = np.radians(_finite("azimuth", column("azimuth", azimuth, inclined.size, "inclination")))
    right, up = -np.sin(heading), np.cos(inclined) * np.cos(heading)
    undefined = np.hypot(right, up) < _LEAST_ANGLE
    if undefined.any():
        at = int(np.argmax(undefined))
        raise ValueError(
            f"inclination[{at}] = {np.degrees(inclined[at]):g}, azimuth[{at}] = {np.degrees(heading[at]):g}: "
            "north is undefined where the hole runs level north or south"
        )
    return wrapped(np.degrees(np.arctan2(right, up)))


def from_high_side(inclination: npt.ArrayLike, low: float = 4.0, high: float = 6.0) -> npt.NDArray[np.bool_]:
    """Which samples count from the high side, where the tool changes over by inclination and the file does not say.

    A tool counts from north until the inclination reaches ``high``, and from the high side until it is down to ``low``:
    between the two it stays with what it did. A series that starts between them starts with the nearer one.

    Parameters
    ----------
    inclination
        At each sample, degrees, in order of time, (n,), finite.
    low, high
        Degrees, low <= high.

    Returns
    -------
    ndarray
        (n,) bool, new: True for the high side, False for north. Made for :func:`onto_path`.
    """
    inclined = _finite("inclination", column("inclination", inclination))
    if not 0 <= low <= high:
        raise ValueError(f"low = {low:g}, high = {high:g}: must be 0 <= low <= high")
    if inclined.size == 0:
        return np.empty(0, dtype=bool)
    decided = (inclined >= high) | (inclined <= low)
    steep = np.where(decided, inclined >= high, inclined >= 0.5 * (low + high))
    decided[0] = True
    last = np.maximum.accumulate(np.where(decided, np.arange(inclined.size), 0))
    return steep[last]


def defined(path: Path, depth: npt.ArrayLike, high_side: bool) -> npt.NDArray[np.bool_]:
    """Where both references are defined: that of the path, and the high side, or north.

    Parameters
    ----------
    path
        A path.
    depth
        Metres on the path, (n,), finite.
    high_side
        True for the high side, False for north.

    Returns
    -------
    ndarray
        (n,) bool, new.
    """
    north, east, down = path.tangent(_finite("depth", column("depth", depth))).T
    level = {
        "high-side": np.hypot(north, east),
        "north": np.hypot(east, down),
        "parallel-transport": np.ones(north.size),
    }
    own = level["high-side" if high_side else "north"]
    sure: npt.NDArray[np.bool_] = np.minimum(own, level[path.reference]) > 2.0 * _LEAST_ANGLE
    return sure


def onto_path(
    toolface: npt.ArrayLike, depth: npt.ArrayLike, path: Path, high_side: npt.NDArray[np.bool_] | bool
) -> Floats:
    """Turn toolfaces measured from north or from the high side into the path's reference, whatever that is.

    Parameters
    ----------
    toolface, depth
        Degrees and metres, (n,), finite; depths on the path.
    path
        Its ``reference`` is what the result counts from.
    high_side
        True where a sample counts from the high side, False where from north: (n,) bool, or one for all.

    Returns
    -------
    ndarray
        Degrees in [0, 360), (n,), new.

    Raises
    ------
    ValueError
        If lengths differ, a value is not finite, the path does not reach a depth, or a reference is undefined there.
    """
    angle = _finite("toolface", column("toolface", toolface))
    where = _finite("depth", column("depth", depth, angle.size, "toolface"))
    if np.ndim(high_side) and np.shape(high_side) != angle.shape:
        raise ValueError(f"high_side has shape {np.shape(high_side)}, toolface has {angle.shape}: must be equal")
    frame = path.frame(where)
    tangent = frame[:, 2]
    # The tag's own direction, up = (0, 0, -1) or north = (1, 0, 0), less its part along the hole. Its length, the sine
    # of the angle between them, drops out of atan2.
    pole = np.where(np.reshape(high_side, (-1, 1)), np.array([0.0, 0.0, -1.0]), np.array([1.0, 0.0, 0.0]))
    square = pole - (pole * tangent).sum(axis=1, keepdims=True) * tangent
    undefined = np.linalg.norm(square, axis=1) < _LEAST_ANGLE
    if undefined.any():
        at = int(np.argmax(undefined))
        tag = "the high side" if np.broadcast_to(high_side, angle.shape)[at] else "north"
        rule = "vertical" if tag == "the high side" else "level north or south"
        raise ValueError(f"toolface[{at}] at depth {where[at]:g}: {tag} is undefined where the hole runs {rule}")
    ahead, aside = (square * frame[:, 0]).sum(axis=1), (square * frame[:, 1]).sum(axis=1)
    return wrapped(angle + np.degrees(np.arctan2(aside, ahead)))


def _finite(name: str, values: Floats) -> Floats:
    bad = ~np.isfinite(values)
    if bad.any():
        at = int(np.argmax(bad))
        raise ValueError(f"{name}[{at}] = {values[at]:g}: must be finite")
    return values
