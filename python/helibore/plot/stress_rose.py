"""The direction of the greatest horizontal stress as a picture: a rose, and the features by depth.

rose     each feature's SHmax, both ends, weighted as in the mean; the line is the mean, the shade one s.d.
depth    a vertical bar for each feature, as long as the feature, at its SHmax from 0 to 180 degrees
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from helibore.base.errors import needs

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from helibore.logs.stress import HorizontalStress

BINS = 36
"""Sectors of the rose; 10 degrees each."""
BAR, MEAN = "#3b6ea5", "#b3261e"


def stress_rose(found: HorizontalStress, title: str = "") -> Figure:
    """Return a rose of SHmax and its features by depth, as a matplotlib figure.

    Parameters
    ----------
    found
        From `helibore.stress_of_picks`, `helibore.stress_of_zones` or `helibore.horizontal_stress`.
    title
        Printed above, such as the name of the well.

    Raises
    ------
    MissingExtraError
        If matplotlib is not installed.
    """
    with needs("matplotlib", "plot"):
        from matplotlib.figure import Figure
    azimuths = np.array([each.azimuth for each in found.features])
    lengths = np.array([each.length for each in found.features])
    depths = np.array([each.depth for each in found.features])
    figure = Figure(figsize=(7.5, 5.0), dpi=150)
    figure.suptitle("\n".join(filter(None, (title, str(found)))), fontsize=8, wrap=True)
    rose = figure.add_axes((0.07, 0.1, 0.42, 0.68), projection="polar")
    rose.set_theta_zero_location("N")  # type: ignore[attr-defined]
    rose.set_theta_direction(-1)  # type: ignore[attr-defined]
    rose.set_yticklabels([])
    rose.tick_params(labelsize=8)
    weight = lengths if found.weighting == "length" else np.ones(lengths.size)
    both = np.concatenate([azimuths, azimuths + 180])
    counts, edges = np.histogram(both % 360, BINS, (0.0, 360.0), weights=np.concatenate([weight, weight]))
    middle = np.radians(edges[:-1] + 180 / BINS)
    rose.bar(middle, counts, width=2 * math.pi / BINS, color=BAR, edgecolor="white", linewidth=0.4)
    track = figure.add_axes((0.66, 0.12, 0.31, 0.7))
    track.vlines(azimuths, depths - lengths / 2, depths + lengths / 2, color=BAR, linewidth=3)
    track.plot(azimuths, depths, ".", color=BAR, markersize=3)
    track.set(xlim=(0, 180), xticks=range(0, 181, 45), xlabel="SHmax, deg from true north", ylabel="Measured depth, m")
    track.tick_params(labelsize=8)
    track.invert_yaxis()
    track.grid(visible=True, linewidth=0.3)
    if found.count:
        top, mean = max(float(counts.max()), 1e-9), math.radians(found.azimuth)
        for end in (mean, mean + math.pi):
            rose.plot([end, end], [0, top], color=MEAN)
            if not math.isnan(found.deviation):
                spread = 2 * math.radians(min(found.deviation, 90.0))
                rose.bar(end, top, width=spread, color=MEAN, alpha=0.12)
        track.axvline(found.azimuth, color=MEAN)
    return figure
