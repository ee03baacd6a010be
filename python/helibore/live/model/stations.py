"""Survey stations in order of arrival; the C++ `Stations` sorts them and computes the path only where it changes."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from helibore import _core
from helibore.base.arrays import Floats
from helibore.live.rules.configuration import PathTable
from helibore.live.rules.depth_limits import DepthLimits
from helibore.trajectory.survey import Path, Survey


class Stations:
    """The stations of a growing survey; a new station replaces an earlier station at the same depth.

    Raises
    ------
    ValueError
        If a station in the table ``path`` is wrong.
    """

    STATE = ("columns",)

    def __init__(self, path: PathTable, limits: DepthLimits) -> None:
        self._limits = limits
        self._settings: dict[str, Any] = {
            name: getattr(path, name) for name in ("method", "reference", "head", "extend")
        }
        self._north = path.north or ""
        self._core = _core.Stations(**self._settings)
        self._survey: Survey | None = None
        self._path: Path | None = None
        for row in path.stations:
            _, bad = self.take(*row)
            if bad:
                raise ValueError(f"path.stations: {bad}")

    def __len__(self) -> int:
        return len(self._core)

    def take(self, depth: float, inclination: float, azimuth: float) -> tuple[float | None, str]:
        """Add one station; return the depth below which the path changed, and the reason for which it was refused.

        The depth is None if the path did not change, for example because the station is already in the survey. The
        reason is "" if the station was not refused.
        """
        least, most = self._limits.depth_range
        if math.isfinite(depth) and not least <= depth <= most:
            return None, f"station at {depth:g} m: {self._limits.rule()}"
        moved, refused = self._core.take(*np.array([[depth], [inclination], [azimuth]]))
        if moved is not None:
            self._survey = self._path = None
        return moved, "".join(refused)

    @property
    def columns(self) -> tuple[Floats, ...]:
        """Depth m, inclination and azimuth deg, shallowest first."""
        return self._core.columns()

    @columns.setter
    def columns(self, columns: tuple[Floats, ...]) -> None:
        self._core = _core.Stations(**self._settings)
        self._core.take(*columns)
        self._survey = self._path = None

    @property
    def survey(self) -> Survey | None:
        """The survey of all stations that have come; None while there are fewer than two stations."""
        if self._survey is None and len(self) > 1:
            self._survey = Survey(*self.columns, north=self._north)
        return self._survey

    @property
    def path(self) -> Path | None:
        """The path through the survey; None while there is no survey."""
        if self._path is None and (survey := self.survey) is not None:
            self._path = Path(survey, **self._settings, core=self._core.path())
        return self._path

    def reaching(self, depth: float) -> Path | None:
        """Return the path, extended straight to ``depth`` if it is shorter; None while there is no survey."""
        path = self.path
        if path is None or path.stop_depth >= depth:
            return path
        return path.survey.path(**{**self._settings, "extend": depth - path.survey_depth})

    def rows(self) -> Floats:
        """Return (n, 3): depth m, inclination and azimuth deg, shallowest first."""
        return np.column_stack(self.columns)
