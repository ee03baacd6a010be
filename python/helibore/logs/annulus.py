"""The annulus between the hole and a casing: what cement has to fill, and whether the casing passes.

    area = pi/4 (equivalent diameter^2 - outer diameter^2)        volume = area x height, turn by turn

    space = annulus(wall.logs(), outer_diameter=0.2445)       9 5/8 in casing in a measured hole
    space.total, space.unmeasured, space.cement(top=2000, excess=0.1)

Volumes add up from the deepest row upwards, as cement rises. A row without a measured area adds nothing and is counted
as unmeasured, never filled with gauge.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from helibore.base.arrays import Floats
from helibore.base.errors import InputError
from helibore.base.tables import LogColumn
from helibore.base.units import INCH
from helibore.logs.turn_logs import Logs


@dataclass(frozen=True, eq=False)
class Annulus:
    """Columns of one row a turn or a step, each (rows,) float64, owned; made by `annulus`.

    Attributes
    ----------
    depth
        As in the logs, metres.
    volume
        Between the hole and the casing in this row, cubic metres; NaN where the hole's area is missing.
    from_bottom
        Volume from the deepest row up to and with this one, cubic metres, of the rows that have one.
    clearance
        Largest inscribed circle less the casing, metres; negative where it does not pass; NaN where missing.
    outer_diameter
        Of the casing, metres.
    height
        Metres of hole in a row.
    """

    depth: Floats
    volume: Floats
    from_bottom: Floats
    clearance: Floats
    outer_diameter: float
    height: float

    @property
    def total(self) -> float:
        """Volume of all rows that have one, cubic metres."""
        return float(np.nansum(self.volume))

    @property
    def unmeasured(self) -> float:
        """Metres of hole without a volume: `total` leaves them out."""
        return float(np.isnan(self.volume).sum() * self.height)

    def cement(self, top: float | None = None, bottom: float | None = None, excess: float = 0.0) -> float:
        """Return the cement for an interval, cubic metres.

        Parameters
        ----------
        top, bottom
            Depths, metres; None: the ends of the logs. Rows count whose depth lies in [top, bottom].
        excess
            To pump on top, as a fraction: 0.1 is ten percent.

        Raises
        ------
        InputError
            ``cement: 12.4 m between 2000 and 2100 m are unmeasured ...``, since any number would be a guess; if no row
            lies in the interval; on a negative excess.
        """
        if not (math.isfinite(excess) and excess >= 0):
            raise InputError("excess", "must be finite and not negative", str(excess))
        top = -math.inf if top is None else top
        bottom = math.inf if bottom is None else bottom
        inside = self.volume[(self.depth >= top) & (self.depth <= bottom)]
        if not inside.size:
            raise InputError("cement", f"no row between {top:g} and {bottom:g} m")
        missing = np.isnan(inside).sum()
        if missing:
            advice = "choose an interval without gaps, or take `total` for what is measured"
            length = f"{missing * self.height:g} m between {top:g} and {bottom:g} m are unmeasured"
            raise InputError("cement", f"{length}; {advice}")
        return float(inside.sum() * (1 + excess))

    def columns(self) -> list[LogColumn]:
        """Return volume, volume from the bottom and clearance as columns for `Logs.table`, named by the size in mm."""
        size = f"{self.outer_diameter * 1e3:.0f}"
        casing = f"casing of {self.outer_diameter:.4g} m"
        return [
            LogColumn(f"AVOL_{size}", "m3", f"Annular volume around {casing} in this row", self.volume),
            LogColumn(f"ASUM_{size}", "m3", f"Annular volume around {casing} from the bottom", self.from_bottom, 4),
            LogColumn(f"CLEAR_{size}", "m", f"Inscribed circle less {casing}", self.clearance),
        ]


def annulus(logs: Logs, outer_diameter: float) -> Annulus:
    """Measure the annulus around a casing.

    Parameters
    ----------
    logs
        Of turns or steps.
    outer_diameter
        Of the casing, metres.

    Raises
    ------
    InputError
        ``outer_diameter = 0: must be finite and above 0``; ``outer_diameter = 0.34: a casing of 13.39 in is larger than
        the hole at 2010.4 m, 12.25 in`` where its area is more than the hole's.
    """
    if not (math.isfinite(outer_diameter) and outer_diameter > 0):
        raise InputError("outer_diameter", "must be finite and above 0", f"{outer_diameter:g}")
    area = np.pi / 4 * (logs.equivalent_diameter**2 - outer_diameter**2)
    smaller = np.flatnonzero(area < 0)
    if smaller.size:
        first = smaller[0]
        hole = f"the hole at {logs.depth[first]:g} m, {logs.equivalent_diameter[first] / INCH:.4g} in"
        rule = f"a casing of {outer_diameter / INCH:.4g} in is larger than {hole}"
        raise InputError("outer_diameter", rule, f"{outer_diameter:g}")
    volume = area * logs.height
    upwards = np.argsort(logs.depth, kind="stable")[::-1]
    from_bottom = np.empty_like(volume)
    from_bottom[upwards] = np.nancumsum(volume[upwards])
    return Annulus(
        depth=logs.depth,
        volume=volume,
        from_bottom=from_bottom,
        clearance=logs.inscribed_diameter - outer_diameter,
        outer_diameter=float(outer_diameter),
        height=logs.height,
    )
