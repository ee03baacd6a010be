"""The annulus between the hole and a casing: the volume that cement has to fill, and whether the casing passes.

    area = pi/4 (equivalent diameter^2 - outer diameter^2)        volume = area x height, turn by turn

    space = wall.logs().annulus(casing=0.2445)                9 5/8 in casing in a measured hole
    space.total, space.unmeasured, space.cement(top=2000, excess=0.1)

Volumes are summed from the deepest row upwards, as cement rises. A row without a measured area adds no volume; its
height counts as unmeasured, and bit size is never assumed for it. A row whose area is less than the casing's adds no
volume either; its height counts as narrower.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from helibore.base.arrays import Floats
from helibore.base.errors import InputError
from helibore.base.tables import LogColumn
from helibore.base.units import size_text


@dataclass(frozen=True, eq=False)
class Annulus:
    """Columns with one row per turn or step, each (rows,) float64, owned; made by `Logs.annulus`.

    Attributes
    ----------
    depth
        Depth of the row, as in the logs, metres.
    volume
        Between the hole and the casing in this row, cubic metres; NaN where the hole's area is missing or less than
        the casing's.
    from_bottom
        Sum of ``volume`` from the deepest row up to this one, included, cubic metres; rows without a volume count as 0.
    clearance
        Diameter of the largest inscribed circle less that of the casing, metres; negative if the casing does not pass;
        NaN where missing.
    hole
        Diameter of the circle with the hole's area, metres.
    casing
        Outer diameter of the casing, metres.
    height
        Height of a row, metres.
    """

    depth: Floats
    volume: Floats
    from_bottom: Floats
    clearance: Floats
    hole: Floats
    casing: float
    height: float

    @property
    def total(self) -> float:
        """Sum of the volumes that are not missing, cubic metres."""
        return float(np.nansum(self.volume))

    @property
    def unmeasured(self) -> float:
        """Metres of hole without a measured area; `total` leaves them out."""
        return float(np.isnan(self.hole).sum() * self.height)

    @property
    def narrower(self) -> float:
        """Metres of hole with less area than the casing, which cannot pass there; `total` leaves them out."""
        return float((self.hole < self.casing).sum() * self.height)

    def cement(self, top: float | None = None, bottom: float | None = None, excess: float = 0.0) -> float:
        """Return the cement for an interval, cubic metres.

        Parameters
        ----------
        top, bottom
            Depths, metres; None: the ends of the logs. A row counts if its depth lies in [top, bottom].
        excess
            Excess to pump, as a fraction: 0.1 is ten percent.

        Raises
        ------
        InputError
            If a row of the interval has no volume (``cement: 12.4 m between 2000 and 2100 m have a missing radius or
            are narrower ...``), since any number would be a guess; if no row lies in the interval; if the excess is
            negative or not finite.
        """
        if not (math.isfinite(excess) and excess >= 0):
            raise InputError("excess", "must be finite and not negative", str(excess))
        if not self.depth.size:
            raise InputError("cement", "the logs have no row")
        top = float(self.depth.min()) if top is None else top
        bottom = float(self.depth.max()) if bottom is None else bottom
        inside = self.volume[(self.depth >= top) & (self.depth <= bottom)]
        if not inside.size:
            raise InputError("cement", f"the logs have no row between {top:g} and {bottom:g} m")
        missing = np.isnan(inside).sum()
        if missing:
            advice = "choose an interval in which every row has a volume"
            length = f"{missing * self.height:g} m between {top:g} and {bottom:g} m"
            raise InputError("cement", f"{length} have a missing radius or are narrower than the casing; {advice}")
        return float(inside.sum() * (1 + excess))

    def columns(self) -> list[LogColumn]:
        """Return volume, volume from the bottom and clearance as columns for `Logs.table`.

        Their names contain the size of the casing in mm.
        """
        size = f"{self.casing * 1e3:.0f}"
        casing = f"a casing of {size_text(self.casing)}; {size} in the name is its size in mm"
        return [
            LogColumn(f"AVOL_{size}", "m3", f"Annular volume in this row around {casing}", self.volume),
            LogColumn(
                f"ASUM_{size}", "m3", f"Annular volume from the bottom (ICV) around {casing}", self.from_bottom, 4
            ),
            LogColumn(f"CLEAR_{size}", "m", f"Inscribed circle less {casing}", self.clearance),
        ]


def annulus(depth: Floats, hole: Floats, inscribed: Floats, height: float, casing: float) -> Annulus:
    """Return the annulus around a casing, from columns of logs, as `Logs.annulus` describes."""
    if not (math.isfinite(casing) and casing > 0):
        raise InputError("casing", "must be finite and above 0", f"{casing:g}")
    volume = np.where(hole < casing, np.nan, np.pi / 4 * (hole**2 - casing**2) * height)
    upwards = np.argsort(depth, kind="stable")[::-1]
    from_bottom = np.empty_like(volume)
    from_bottom[upwards] = np.nancumsum(volume[upwards])
    return Annulus(depth, volume, from_bottom, inscribed - casing, hole, float(casing), height)
