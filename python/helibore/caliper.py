"""Radius samples of a hole, checked: what a wall is rebuilt from.

A sample is (toolface, depth, radius), with a time where the tool kept one. Units are metres and degrees, toolface is
clockwise looking downhole, and radius is measured from the axis of the hole.
"""

from __future__ import annotations

import numpy.typing as npt

from helibore import _core
from helibore.arrays import Floats, column
from helibore.threads import available_threads


class Caliper:
    """Samples of the radius of a hole, in any order, checked and frozen.

    Parameters
    ----------
    depth
        (n,) measured depth, metres, finite.
    toolface
        (n,) degrees clockwise looking downhole, finite; 370 and -350 mean 10.
    radius
        (n,) metres from the axis of the hole, above 0 and at most 2: never a diameter, never inches.
    time
        (n,) seconds or any other clock, finite; or None. With a time, the order in which samples arrive does not
        matter, and rows equal in all four columns count once.

    Raises
    ------
    ValueError
        Naming column, row, value and rule: ``toolface[17] = nan: must be finite``.

    Notes
    -----
    The attributes ``depth``, ``toolface``, ``radius`` and ``time`` are read-only float64 arrays. Input that already is
    contiguous float64 is not copied: do not change it afterwards.

    Examples
    --------
    >>> caliper = Caliper(depth=[100.0, 100.1], toolface=[0.0, 90.0], radius=[0.108, 0.109])
    >>> len(caliper)
    2
    """

    __slots__ = ("_depth", "_radius", "_time", "_toolface")

    def __init__(
        self,
        depth: npt.ArrayLike,
        toolface: npt.ArrayLike,
        radius: npt.ArrayLike,
        time: npt.ArrayLike | None = None,
    ) -> None:
        self._depth = _frozen(column("depth", depth))
        n = self._depth.size
        self._toolface = _frozen(column("toolface", toolface, n, "depth"))
        self._radius = _frozen(column("radius", radius, n, "depth"))
        self._time = None if time is None else _frozen(column("time", time, n, "depth"))
        _core.check_samples(self._depth, self._toolface, self._radius, self._time, available_threads())

    @property
    def depth(self) -> Floats:
        """(n,) measured depth, metres; read-only."""
        return self._depth

    @property
    def toolface(self) -> Floats:
        """(n,) degrees, as given; read-only."""
        return self._toolface

    @property
    def radius(self) -> Floats:
        """(n,) metres; read-only."""
        return self._radius

    @property
    def time(self) -> Floats | None:
        """(n,) or None; read-only."""
        return self._time

    def __len__(self) -> int:
        return self._depth.size

    def __repr__(self) -> str:
        if not len(self):
            return "Caliper(no samples)"
        return f"Caliper({len(self)} samples, {self._depth.min():g} to {self._depth.max():g} m)"


def _frozen(values: Floats) -> Floats:
    """A read-only view."""
    view = values.view()
    view.flags.writeable = False
    return view
