"""Survey stations as they arrive: late stations are sorted in, corrected ones replace the old, the path is rebuilt."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import numpy.typing as npt

from helibore.live.depth_limits import DepthLimits
from helibore.trajectory.survey import Path, Survey


class Stations:
    """The stations of a growing survey.

    Attributes
    ----------
    survey, path
        Survey and path of all stations so far; None while there are fewer than two.
    """

    def __init__(self, settings: dict[str, Any], limits: DepthLimits) -> None:
        self._limits = limits
        self._settings = {**settings, "head": tuple(settings["head"])}
        first = self._settings.pop("stations")
        self._rows: dict[float, tuple[float, float]] = {}
        self.survey: Survey | None = None
        self.path: Path | None = None
        for row in first:
            _, bad = self.take(*row)
            if bad:
                raise ValueError(f"path.stations: {bad}")

    def __len__(self) -> int:
        return len(self._rows)

    def take(self, depth: float, inclination: float, azimuth: float) -> tuple[float | None, str]:
        """Add one station; return (depth below which the path changed or None, why the station was refused or "").

        A station that is already in the survey changes nothing.
        """
        if not math.isfinite(depth):
            return None, f"station at {depth:g} m: depth must be finite"
        if self._limits.outside(np.array(depth)):
            return None, f"station at {depth:g} m: {self._limits.rule()}"
        row = (inclination, azimuth)
        if self._rows.get(depth) == row:
            return None, ""
        rows = dict(sorted({**self._rows, depth: row}.items()))
        columns = np.array([(key, *value) for key, value in rows.items()]).T
        try:
            if len(rows) > 1:
                survey = Survey(*columns)
                self.path, self.survey = survey.path(**self._settings), survey
            elif not (0 <= inclination <= 180 and -360 <= azimuth <= 360):
                raise ValueError(f"inclination {inclination:g}, azimuth {azimuth:g}: must be in [0, 180], [-360, 360]")
        except ValueError as error:
            return None, f"station at {depth:g} m: {error}"
        self._rows = rows
        above = columns[0][columns[0] < depth]
        return float(above[-1]) if len(above) else float(depth), ""

    def reaching(self, depth: float) -> Path | None:
        """Return the path; if it ends above ``depth``, it is extended straight to there."""
        if self.path is None or self.survey is None or self.path.stop_depth >= depth:
            return self.path
        beyond = depth - max(self._rows)
        return self.survey.path(**{**self._settings, "extend": max(beyond, self._settings["extend"])})

    def rows(self) -> npt.NDArray[np.float64]:
        """Return (n, 3): depth m, inclination and azimuth deg, shallowest first."""
        return np.array([(key, *value) for key, value in self._rows.items()]).reshape(-1, 3)
