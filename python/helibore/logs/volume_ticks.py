"""Ticks of integrated volume: where the volume from the deepest row up passes each multiple of a step.

|- 0.2 m3        IHV, volume of the hole, and ICV, volume of the annulus around a casing that is still to be run
|- 0.1
|_ deepest row
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from helibore.base.arrays import Floats
from helibore.logs.turn_logs import Logs


@dataclass(frozen=True)
class VolumeTicks:
    """The ticks of a volume, and how sure its total is.

    Attributes
    ----------
    depth
        Depth of each tick, the deepest first, metres.
    every
        Volume between two ticks, m3.
    total
        Volume of all rows, m3; rows without a volume count as 0.
    sigma
        Upper limit of its standard uncertainty, m3: the sum of those of the rows. NaN if not known.
    coverage
        Share of the rows' wall that is measured, 0 to 1.
    missing
        Metres of rows without a volume.
    """

    depth: Floats
    every: float
    total: float
    sigma: float
    coverage: float
    missing: float


def volume_ticks(logs: Logs, every: float, casing: float | None = None) -> VolumeTicks:
    """Return the ticks of the volume of the hole, or of the annulus around a casing.

    Parameters
    ----------
    logs
        One row or more.
    every
        Volume between two ticks, m3.
    casing
        Outer diameter, metres; None: the hole.
    """
    volume = logs.volume if casing is None else logs.annulus(casing).volume
    upwards = np.argsort(logs.depth, kind="stable")[::-1]
    summed = np.concatenate([[0.0], np.nancumsum(volume[upwards])])
    edges = np.concatenate([[logs.depth.max() + 0.5 * logs.height], logs.depth[upwards] - 0.5 * logs.height])
    rising = np.concatenate([[True], np.diff(summed) > 0])
    multiples = every * np.arange(1, int(summed[-1] / every + 1e-9) + 1)
    depth = np.interp(multiples, summed[rising], edges[rising])
    known = np.isfinite(volume)
    sigma = float(logs.volume_sigma[known].sum()) if known.any() else float("nan")
    return VolumeTicks(
        depth, every, float(summed[-1]), sigma, float(np.nanmean(logs.coverage)) if known.any() else float("nan"),
        float((~known).sum() * logs.height),
    )  # fmt: skip
