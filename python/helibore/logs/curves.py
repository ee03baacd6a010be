"""Curves along the hole: gamma ray, rate of penetration, and the logs of `Wall.logs`.

The viewer's page and prints draw a curve on the same scale: its limits, or round numbers around its values.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from helibore.base.arrays import Floats, Mask
from helibore.base.errors import InputError
from helibore.logs.turn_logs import Logs

NEARLY_ALL = (0.2, 99.8)
"""An axis shows all values between these percentiles."""
MOST = (1.0, 99.0)
"""A logarithmic axis shows all values between these percentiles, and ends at whole decades."""


@dataclass(frozen=True, eq=False)
class ScalarCurve:
    """A curve along the hole, such as a gamma ray.

    Attributes
    ----------
    name, unit
        As in the file that the curve comes from.
    depth
        (n,) metres; no depth is less than the depth before it.
    values
        (n,), NaN where missing.
    limits
        Values at the left and the right edge of its track, in either order; None: round numbers around its values.
    log
        Whether the track is logarithmic.

    Raises
    ------
    InputError
        ``curve 'GR': depth must be finite and must not fall``; if limits are equal or not finite, or if the number of
        values is not the number of depths.
    """

    name: str
    unit: str
    depth: Floats
    values: Floats
    limits: tuple[float, float] | None = None
    log: bool = False

    def __post_init__(self) -> None:
        place = f"curve {self.name!r}"
        if self.depth.shape != self.values.shape:
            raise InputError(f"{place}: {self.values.size} values, {self.depth.size} depths", "must be equal")
        if not (np.isfinite(self.depth).all() and (np.diff(self.depth) >= 0).all()):
            raise InputError(place, "depth must be finite and must not fall")
        if self.limits is not None and not (all(map(math.isfinite, self.limits)) and len({*self.limits}) == 2):
            raise InputError(f"{place}: limits", "must be two different finite numbers", str(self.limits))

    def there(self, top: float, bottom: float) -> Mask:
        """Return which rows from depth ``top`` to ``bottom`` have a value, (n,) bool."""
        inside: Mask = (self.depth >= top) & (self.depth <= bottom) & np.isfinite(self.values)
        return inside

    def ends(self) -> tuple[float, float]:
        """Return the values at the left and the right edge of the curve's track."""
        if self.limits is not None:
            if self.log and not min(self.limits) > 0:
                raise InputError(f"curve {self.name!r}", "a logarithmic scale needs limits above 0")
            return self.limits
        values = self.values[np.isfinite(self.values) & ((self.values > 0) | (not self.log))]
        if self.log and values.size:
            least, most = np.percentile(values, MOST).tolist()
            return 10.0 ** math.floor(math.log10(least)), 10.0 ** math.ceil(math.log10(most) + 1e-9)
        if self.log:
            raise InputError(f"curve {self.name!r}", "a logarithmic scale needs values above 0")
        return nice_limits(values, float(np.median(values)) if values.size else 0.0, 0.0)


def nice_limits(values: Floats, always: float, least: float) -> tuple[float, float]:
    """Return round ends of an axis that holds nearly all values and ``always``, and is at least ``least`` long.

    At each end 0.2 % of the values may lie beyond the axis; NaN are ignored.
    """
    there = values[np.isfinite(values)]
    low, high = (always, always) if not there.size else np.percentile(there, NEARLY_ALL).tolist()
    low, high = min(low, always), max(high, always)
    if high == low:
        least = least or 0.01 * max(abs(low), 0.001)
    if high - low < least:
        low, high = low - 0.5 * (least - high + low), high + 0.5 * (least - high + low)
    power = math.floor(math.log10((high - low) / 4))
    step = next(10.0**power * mantissa for mantissa in (1, 2, 5, 10) if 10.0**power * mantissa >= (high - low) / 5)
    first, last = math.floor(low / step), math.ceil(high / step)
    first -= always <= first * step + 0.05 * (high - low)
    last += always >= last * step - 0.05 * (high - low)
    return round(first * step, -power), round(last * step, -power)


def curves_of(logs: Logs) -> list[ScalarCurve]:
    """Return a curve for each log that has any value, named by its mnemonic, from the shallow end down."""
    depth, *columns = logs.table()
    order = np.argsort(depth.values, kind="stable")
    rising = depth.values[order]
    return [
        ScalarCurve(one.mnemonic, one.unit, rising, one.values[order])
        for one in columns
        if np.isfinite(one.values).any()
    ]
