"""Find the two ends of a colour scale: one range everywhere (static), or the range of a sliding window (dynamic).

    static    low, high = percentiles 2 and 98 of all values                 equal colours are equal values
    dynamic   share = 1/2 + (value - mean) / (4 s)  of the window            brings out layers; colours are NOT values

mean and s are mean and standard deviation of all values within half a window above and below, so that the scale spans
mean - 2 s to mean + 2 s, as in the viewer. LWD images of gamma or density are usually shown with a static scale.
"""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from helibore.base.arrays import Floats, Integers, column, finite_column
from helibore.base.color_limits import usual_scale
from helibore.base.colors import ColorScale, check_positive, customary_map
from helibore.base.errors import InputError
from helibore.images.sector_image import SectorImage

WINDOW = 1.0
"""Metres: the usual length of the sliding window."""


def image_scale(
    image: SectorImage,
    color_map: str | None = None,
    log: bool | None = None,
    limits: tuple[float, float] | None = None,
) -> ColorScale:
    """Return the colour scale of a whole image, the same on paper and on the viewer's page.

    On a logarithmic scale, values that are not above 0 are missing (`above_zero`).
    """
    color_map = color_map or customary_map(image.name, image.unit)
    log = color_map == "resistivity" if log is None else log
    values = above_zero(image.values) if log else image.values
    return usual_scale(values, image.name, image.unit, color_map, log, limits)


def above_zero(values: Floats) -> Floats:
    """Return the values with NaN in place of those that are not above 0, which a logarithmic scale does not have."""
    return np.where(values > 0, values, np.nan)


def sliding_window(depth: npt.ArrayLike, values: npt.ArrayLike, window: float = WINDOW, log: bool = False) -> Floats:
    """Normalise each row of values, (n, S) or (n,), by the values in a window around the row (dynamic normalisation).

    ``depth`` is (n,) metres, rising. Half of ``window``, metres, lies above and half below each row; rows at the ends
    of a window belong to it. If ``log``, the logarithms of the values are normalised. The result is 0 to 1 and has the
    shape of ``values``: 0.5 for the mean of the window, 0 and 1 for values two standard deviations or more below and
    above the mean, 0.5 if all values of the window are equal, and NaN where a value is missing.
    """
    depths = finite_column("depth", depth)
    shape = np.shape(values)
    if len(shape) not in (1, 2) or shape[0] != depths.size:
        rule = f"must be of shape ({depths.size},) or ({depths.size}, sectors), one row a depth: {shape}"
        raise InputError("values", rule)
    falls = np.flatnonzero(~(np.diff(depths) > 0))
    if falls.size:
        raise InputError(f"depth[{falls[0] + 1}]", "must rise", f"{depths[falls[0] + 1]:g}")
    if not (math.isfinite(window) and window > 0):
        raise InputError("window", "must be finite and above 0", str(window))
    rows = column("values", np.ravel(values)).reshape(shape if len(shape) == 2 else (-1, 1))
    if not np.isfinite(rows).any():
        raise InputError("values", f"all {rows.size} are missing")
    if log:
        check_positive(rows.reshape(shape))
        rows = np.log(rows)
    first = np.searchsorted(depths, depths - window / 2, side="left")
    stop = np.searchsorted(depths, depths + window / 2, side="right")
    mean, spread = _moments(rows, first, stop)
    off = rows - mean[:, None]
    steady = spread == 0  # there the share would be 0 / 0: all values of the window are equal
    share = np.divide(off, 4 * spread[:, None], out=np.where(np.isnan(off), np.nan, 0.0), where=~steady[:, None])
    result: Floats = np.clip(0.5 + share, 0, 1)
    return result.reshape(shape)


def _moments(rows: Floats, first: Integers, stop: Integers) -> tuple[Floats, Floats]:
    """Return mean and standard deviation of each row's window [first, stop); NaN and 0 where a window has no value.

    Squares are summed about the overall mean, because rounding would spoil a small spread in sums about zero.
    """
    middle = float(np.nanmean(rows))
    there = np.isfinite(rows)
    off = np.where(there, rows - middle, 0.0)
    sums = [np.concatenate([[0.0], np.cumsum(of.sum(axis=1))]) for of in (there.astype(np.float64), off, off * off)]
    count, total, square = (of[stop] - of[first] for of in sums)
    with np.errstate(invalid="ignore", divide="ignore"):
        mean = total / count
        variance = square / count - mean * mean
    # If all values of a window are equal, its variance is only a rounding error of the sums.
    rounding = 1e-12 * max(float(sums[2][-1]) / max(float(sums[0][-1]), 1.0), np.finfo(float).tiny)
    spread: Floats = np.sqrt(np.where(variance > rounding, variance, 0.0))
    return middle + mean, spread
