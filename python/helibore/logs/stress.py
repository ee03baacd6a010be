"""The direction of the greatest horizontal stress from breakouts and drilling-induced fractures, with its rank.

Looking down a hole that is near vertical:

            SHmax                  Broken rock stands where the stress around the hole is greatest, which is across
              |                    SHmax; fractures that drilling opens stand where it is least, along SHmax:
        .-----+-----.
    ---(             )---          SHmax = azimuth of a breakout + 90 (mod 180)
        '-----+-----'              SHmax = azimuth of a drilling-induced fracture
      breakout|  breakout
              |

Mean and standard deviation are those of axes (Mardia; `helibore.base.axial`). The rank of the World Stress Map says
how near the direction is to SHmax: A within 15 degrees, B 20, C 25, D 40; E is not usable. Number, total length and
standard deviation must each meet the limits of a rank. `SCHEMES` holds these limits (Zoback, Reservoir Geomechanics,
table 6.1; Heidbach and others, Tectonophysics 482, 2010).

The rule needs a hole near a principal stress, which mostly means near vertical. A hole that is more inclined needs a
solution of the whole stress (Peska and Zoback, 1995), which helibore does not have: its features are left out.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from helibore.base.arrays import Floats, finite_column, require
from helibore.base.axial import axial_mean
from helibore.base.errors import InputError, check_choice
from helibore.logs.picks import BREAKOUT, Pick
from helibore.logs.zones import Zone
from helibore.trajectory.survey import Path

INDUCED = "induced fracture"
OFFSETS = {BREAKOUT: 90.0, INDUCED: 0.0}
"""For each class of feature: the angle from its azimuth to SHmax, degrees."""

MOST_INCLINATION = 20.0
"""Degrees from the vertical up to which the azimuth of a feature gives SHmax."""


class Limits(NamedTuple):
    """What a rank needs: least number and total length (metres), greatest standard deviation (degrees)."""

    rank: str
    number: int
    length: float
    deviation: float


SCHEMES: dict[str, tuple[Limits, ...]] = {
    "caliper": (Limits("A", 10, 300.0, 12.0), Limits("B", 6, 100.0, 20.0), Limits("C", 4, 30.0, 25.0)),
    "image": (Limits("A", 10, 100.0, 12.0), Limits("B", 6, 40.0, 20.0), Limits("C", 4, 20.0, 25.0)),
}
"""Limits by the log on which the features were found: breakouts on calipers; breakouts and fractures on images."""

SCATTERED = 40.0
"""Degrees of standard deviation beyond which the rank is E."""

WEIGHTINGS = ("length", "number")
TYPES = {(BREAKOUT, "caliper"): "BO", (BREAKOUT, "image"): "BOT", (INDUCED, "image"): "DIF"}
"""The World Stress Map's name of an indicator, by class of feature and scheme."""


class Feature(NamedTuple):
    """A feature as it counts: measured depth and length in metres, and the azimuth of SHmax that follows, degrees."""

    depth: float
    length: float
    azimuth: float


@dataclass(frozen=True)
class HorizontalStress:
    """The direction of the greatest horizontal stress (SHmax) in one well, from one class of feature.

    Attributes
    ----------
    azimuth
        Of SHmax, degrees from true north in [0, 180); NaN if there is no feature.
    deviation
        Standard deviation of the features' axes, degrees; NaN if there are fewer than two.
    rank
        A to E.
    limit
        The first limit that the next better rank does not meet; "" for A.
    count, length
        Number of features, and their total length in metres.
    depth
        Mean measured depth of the features, metres, weighted as ``weighting``; NaN if there is none.
    kind, scheme, weighting
        Class of the features, log on which they were found, and what weighs a feature.
    left_out
        The number of features left out: the hole is too inclined there, or toolface has no direction.
    features
        Each feature that counts: ``depth``, ``length`` (metres) and ``azimuth`` of SHmax, degrees in [0, 180).
    """

    azimuth: float
    deviation: float
    rank: str
    limit: str
    count: int
    length: float
    depth: float
    kind: str
    scheme: str
    weighting: str
    left_out: int = 0
    features: tuple[Feature, ...] = ()

    def __str__(self) -> str:
        if not self.count:
            return f"SHmax: no {self.kind}, rank E"
        spread = "one feature" if math.isnan(self.deviation) else f"s.d. {self.deviation:.1f} deg"
        missed = f"; {self.limit}" if self.limit else ""
        return (
            f"SHmax {self.azimuth:.1f} deg, {spread}, {self.count} of class {self.kind}, {self.length:.1f} m, rank "
            f"{self.rank} ({self.scheme}, weighted by {self.weighting}{missed})"
        )

    def record(
        self, latitude: float | None, longitude: float | None, regime: str = "U", site: str = ""
    ) -> dict[str, str]:
        """Return the first columns of a record of the World Stress Map (2016), with name and value of each.

        ID is empty, because the World Stress Map gives it.

        Parameters
        ----------
        latitude, longitude
            Decimal degrees; south and west are negative. None: not known; the field is empty.
        regime
            NF, NS, SS, TS, TF or U (not known).
        site
            Name of the well or the place.

        Raises
        ------
        InputError
            If latitude, longitude or regime is out of range.
        """
        for name, value, most in (("latitude", latitude, 90.0), ("longitude", longitude, 180.0)):
            if value is not None and not -most <= value <= most:
                raise InputError(name, f"must be within -{most:g} and {most:g}", str(value))
        check_choice("regime", regime, ("NF", "NS", "SS", "TS", "TF", "U"))
        known = self.count > 0
        return {
            "ID": "", "SITE": site, "LAT": "" if latitude is None else f"{latitude:.5f}",
            "LON": "" if longitude is None else f"{longitude:.5f}",
            "AZI": f"{round(self.azimuth) % 180}" if known else "999",
            "TYPE": TYPES.get((self.kind, self.scheme), "OC"),
            "DEPTH": f"{self.depth / 1000:.3f}" if known else "", "QUALITY": self.rank, "REGIME": regime,
            "NUMBER": str(self.count), "SD": "" if math.isnan(self.deviation) else f"{self.deviation:.1f}",
            "METHOD": f"{self.weighting} weighted", "LENGTH_M": f"{self.length:.1f}",
        }  # fmt: skip


def horizontal_stress(
    azimuth: Sequence[float] | Floats,
    length: Sequence[float] | Floats,
    kind: str = BREAKOUT,
    scheme: str = "image",
    weighting: str = "length",
    depth: Sequence[float] | Floats | None = None,
    left_out: int = 0,
) -> HorizontalStress:
    """Return SHmax and its rank from the azimuths and lengths of features of one class.

    Parameters
    ----------
    azimuth
        (n,) degrees from true north: the long axis of each breakout, or the strike of each induced fracture.
    length
        (n,) metres along the hole, above 0.
    kind
        "breakout" or "induced fracture".
    scheme
        "image" or "caliper": the limits in `SCHEMES`.
    weighting
        What weighs a feature: "length", or "number" if each counts once.
    depth
        (n,) measured depths, metres.
    left_out
        Is kept in the result.

    Raises
    ------
    InputError
        If a value is not finite, a length is not above 0, sizes differ, or a word is unknown.
    """
    check_choice("kind", kind, tuple(OFFSETS))
    check_choice("scheme", scheme, tuple(SCHEMES))
    check_choice("weighting", weighting, WEIGHTINGS)
    axes = finite_column("azimuth", azimuth)
    lengths = finite_column("length", length, axes.size, "azimuth")
    require("length", lengths, lengths > 0, "must be above 0")
    depths = np.full(axes.size, np.nan) if depth is None else finite_column("depth", depth, axes.size, "azimuth")
    weight = lengths if weighting == "length" else np.ones(axes.size)
    along = (axes + OFFSETS[kind]) % 180
    found = axial_mean(along, weight)
    rank, limit = _rank(axes.size, float(lengths.sum()), found.deviation, SCHEMES[scheme])
    middle = float((weight * depths).sum() / weight.sum()) if axes.size else math.nan
    return HorizontalStress(
        found.mean,
        found.deviation,
        rank,
        limit,
        axes.size,
        float(lengths.sum()),
        middle,
        kind,
        scheme,
        weighting,
        left_out,
        tuple(map(Feature._make, zip(depths.tolist(), lengths.tolist(), along.tolist(), strict=True))),
    )


def _rank(count: int, length: float, deviation: float, limits: tuple[Limits, ...]) -> tuple[str, str]:
    """Return the best rank whose limits all hold, and the limit by which the next better one fails."""
    if count == 0:
        return "E", "no feature"
    if deviation > SCATTERED:
        return "E", f"s.d. {deviation:.1f} deg is above {SCATTERED:g}"
    missed = ""
    for needs in limits:
        fails = [
            (count < needs.number, f"{needs.rank} needs {needs.number} features"),
            (length < needs.length, f"{needs.rank} needs {needs.length:g} m"),
            (deviation > needs.deviation, f"{needs.rank} needs s.d. at most {needs.deviation:g} deg"),
        ]
        first = next((rule for failed, rule in fails if failed), "")
        if not first:
            return needs.rank, missed
        missed = first
    return "D", missed


def stress_of_picks(
    picks: Iterable[Pick],
    path: Path,
    kind: str = BREAKOUT,
    scheme: str = "image",
    weighting: str = "length",
    to_true: float | None = None,
) -> HorizontalStress:
    """Return SHmax from the picks of one class on a well path.

    A breakout is as long as its box. An induced fracture is as long as its trace up and down the hole, and its azimuth
    is the strike of its plane. Picks beyond the ends of the path, where the hole is more inclined than
    `MOST_INCLINATION`, and where toolface 0 is undefined are left out; ``left_out`` counts them.

    Parameters
    ----------
    picks
        Of any class; those of ``kind`` count.
    path
        The well path.
    kind, scheme, weighting
        As in `horizontal_stress`.
    to_true
        What is added to the azimuths of the path so that they count from true north, degrees: the declination of
        magnetic azimuths, the convergence of grid azimuths. None: nothing.

    Raises
    ------
    InputError
        If the survey states magnetic or grid north and ``to_true`` is None; and as `horizontal_stress`.
    """
    check_choice("kind", kind, tuple(OFFSETS))
    turn = _turn_to_true(path, to_true)
    azimuths: list[float] = []
    lengths: list[float] = []
    depths: list[float] = []
    left_out = 0
    for pick in picks:
        if pick.kind != kind:
            continue
        azimuth = _azimuth(pick, path)
        if azimuth is None:
            left_out += 1
            continue
        azimuths.append(azimuth + turn)
        lengths.append(pick.height if kind == BREAKOUT else _trace(pick))
        depths.append(pick.depth)
    return horizontal_stress(azimuths, lengths, kind, scheme, weighting, depths, left_out)


def stress_of_zones(
    zones: Iterable[Zone],
    path: Path,
    scheme: str = "caliper",
    weighting: str = "length",
    to_true: float | None = None,
) -> HorizontalStress:
    """Return SHmax from the breakouts among the zones of a wall: ``stress_of_zones(wall.zones().zones, wall.path)``.

    The azimuth of a zone is that of its axis at the middle of the zone. Zones without an axis, or where
    `stress_of_picks` leaves a pick out, are left out; ``left_out`` counts them.

    Parameters
    ----------
    zones
        Of any kind; breakouts count.
    path, scheme, weighting, to_true
        As in `stress_of_picks`.
    """
    turn = _turn_to_true(path, to_true)
    breakouts = [zone for zone in zones if zone.kind == BREAKOUT]
    middles = [0.5 * (zone.start + zone.stop) for zone in breakouts]
    azimuths = [_axis(zone.toolface, middle, path) for zone, middle in zip(breakouts, middles, strict=True)]
    known = [
        (azimuth + turn, zone.length, middle)
        for azimuth, zone, middle in zip(azimuths, breakouts, middles, strict=True)
        if azimuth is not None
    ]
    columns = list(zip(*known, strict=True)) or [(), (), ()]
    return horizontal_stress(
        columns[0], columns[1], BREAKOUT, scheme, weighting, columns[2], len(breakouts) - len(known)
    )


def _turn_to_true(path: Path | None, to_true: float | None) -> float:
    """Return what is added to azimuths of a path for true north, degrees; refuse another north without a statement."""
    if path is None:
        raise InputError("path", "must be a well path: without one, breakouts have no azimuth", "None")
    if to_true is not None:
        return to_true
    north = path.survey.north
    if north in ("magnetic", "grid"):
        added = "declination" if north == "magnetic" else "convergence"
        rule = f"azimuths of the survey count from {north} north: state the {added}, which turns them to true north"
        raise InputError("to_true", rule, setting="stress.to_true")
    return 0.0


def _trace(pick: Pick) -> float:
    """Return how far along the hole the trace of a plane reaches, metres; a plane across the hole has a millimetre."""
    return max(2 * (pick.radius or 0.1) * math.tan(math.radians(pick.apparent_dip)), 1e-3)


def _azimuth(pick: Pick, path: Path) -> float | None:
    """Return the azimuth of a breakout's axis, or the strike of a fracture, degrees; None where it is not known."""
    axis = _axis(pick.toolface, pick.depth, path)
    if axis is None or pick.kind != INDUCED:
        return axis
    towards = pick.dip(path)[1]
    return None if math.isnan(towards) else (towards + 90) % 180


def _axis(toolface: float, depth: float, path: Path) -> float | None:
    """Return the azimuth of the direction at a toolface, mod 180; None where it is not known or says nothing."""
    azimuth = path.azimuth(depth, toolface)
    if math.isnan(azimuth) or math.degrees(math.acos(min(1.0, abs(path.tangent(depth)[2])))) > MOST_INCLINATION:
        return None
    return azimuth % 180
