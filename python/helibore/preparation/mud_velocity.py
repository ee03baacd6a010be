"""Find the velocity of sound in the mud by depth, from travel times in casing of known inner diameter.

    travel times in each casing --circle of known size, centre of the tool free--> a velocity and its deviation
    velocities --Gaussian process along the depth--> velocity and deviation at every depth

In a pipe, radius = R - (x cos + y sin of the toolface) - (offset across the beam)^2 / 2 R, and the radius is the tool's
plus standoff x velocity: velocity, x and y follow by least squares. Tukey's weights leave collars out.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from helibore.base.arrays import Floats, Integers, distinct
from helibore.base.errors import InputError
from helibore.settings.preparation_settings import Echo, EchoCasing

TURNS = 6
"""A tool that turns is taken to rest at one place for so many turns, and an image for so many rows."""
FEWEST = 4
"""Least number of such places in a casing."""
LONG = 60.0
"""Metres; a longer casing shows the velocity in several parts."""
UNEVEN = 0.0015
"""Metres; if the radius differs more from place to place (robust deviation), the interval is no pipe."""
UNCALIBRATED = 0.06
"""Greatest share by which a casing may contradict a velocity whose deviation is not stated."""
DOUBT = 3.0
"""Deviations beyond which a casing contradicts a velocity."""

SIZES = (0.002, 0.005, 0.01, 0.02)
"""Deviations of the velocity along a well, as shares of it, among which the casings choose."""
RANGES = (300.0, 1000.0, 3000.0)
"""Metres along which the velocity is alike, among which the casings choose."""
STEP = 5.0
"""Metres between the depths at which a wall keeps how sure the velocity is."""
MOST = 400
"""Most such depths."""
STATED_SIGMA = 0.02
"""Deviation of a velocity, as a share of it, where casing is to show it and none is stated."""


class Calibrated(NamedTuple):
    """The velocity that a casing, or a part of a long one, shows."""

    casing: EchoCasing
    depth: float  # of the middle of its readings, m
    velocity: float  # m/s
    random: float  # standard deviation of its own, m/s
    shared: float  # standard deviation that all parts of a casing share, by its diameter, m/s

    @property
    def sigma(self) -> float:
        return float(np.hypot(self.random, self.shared))


@dataclass(frozen=True)
class MudVelocity:
    """The velocity along a well: a Gaussian process through the velocities of casings, its size and range averaged."""

    echo: Echo
    found: tuple[Calibrated, ...]

    def at(self, depth: Floats) -> tuple[Floats, Floats]:
        """Return the velocity at depths (m), and its standard deviation, both m/s."""
        stated = self.echo.velocity
        own = self.echo.velocity_sigma
        if not self.found:
            return np.full(depth.size, stated), np.full(depth.size, own or 0.0)
        place = np.array([each.depth for each in self.found])
        off = np.array([each.velocity for each in self.found]) / stated - 1.0
        noise = np.diag([(each.random / stated) ** 2 for each in self.found])
        noise += [[(a.casing is b.casing) * a.shared * b.shared / stated**2 for a in self.found] for b in self.found]
        level = (STATED_SIGMA if own is None else max(own / stated, np.sqrt(noise.diagonal().min()))) ** 2
        rows = []
        for size in SIZES:
            for reach in RANGES:
                known = level + size**2 * _alike(place[:, None] - place, reach) + noise
                factor = np.linalg.cholesky(known)
                white = np.linalg.solve(factor, off)
                gain = np.linalg.solve(factor, (level + size**2 * _alike(depth - place[:, None], reach)))
                left = np.maximum(level + size**2 - np.square(gain).sum(axis=0), 0.0)
                rows.append((-0.5 * white @ white - np.log(np.diag(factor)).sum(), white @ gain, left))
        evidence = np.array([row[0] for row in rows])
        weight = np.exp(evidence - evidence.max())
        weight /= weight.sum()
        means, lefts = np.stack([row[1] for row in rows]), np.stack([row[2] for row in rows])
        mean = weight @ means
        spread = weight @ (lefts + np.square(means - mean))
        return stated * (1.0 + mean), stated * np.sqrt(spread)

    def lines(self) -> list[str]:
        """Return a sentence for each casing."""
        lines = []
        for casing in self.echo.casing:
            parts = [each for each in self.found if each.casing is casing]
            ends = (parts[0], parts[-1]) if len(parts) > 1 else parts
            shown = [f"{each.velocity:.0f} m/s at {each.depth:.0f} m" for each in ends]
            lines.append(f"{_name(casing)}: {', '.join(shown)}; deviation {max(each.sigma for each in parts):.0f} m/s")
        return lines


def find_velocity(echo: Echo, depth: Floats, toolface: Floats, radius: Floats, turn: Integers) -> MudVelocity:
    """Return the velocity by depth from samples whose radii have the stated velocity.

    ``turn`` numbers the turns, or rows of an image. Raises an InputError if an interval of casing holds too few turns
    or is no pipe, or if it contradicts the stated velocity; the error has both numbers.
    """
    return MudVelocity(echo, tuple(
        _calibrated(echo, casing, depth[part], toolface[part], radius[part], turn[part])
        for casing in echo.casing for part in _parts(casing, depth, turn)
    ))  # fmt: skip


def _name(casing: EchoCasing) -> str:
    return f"casing from {casing.top:g} to {casing.bottom:g} m"


def _parts(casing: EchoCasing, depth: Floats, turn: Integers) -> list[Integers]:
    """Return the indices of the samples in each part of a casing; all parts have enough turns if the casing has."""
    inside = np.flatnonzero((depth >= casing.top) & (depth <= casing.bottom))
    number = np.floor((depth[inside] - casing.top) / LONG)
    parts = [inside[number == each] for each in distinct(number)] or [inside]
    for at in range(len(parts) - 1, 0, -1):
        if distinct(turn[parts[at]]).size < TURNS * FEWEST:
            parts[at - 1] = np.sort(np.concatenate([parts[at - 1], parts.pop(at)]))
    if len(parts) > 1 and distinct(turn[parts[0]]).size < TURNS * FEWEST:
        parts[1] = np.sort(np.concatenate([parts.pop(0), parts[0]]))
    return parts


def _calibrated(
    echo: Echo, casing: EchoCasing, depth: Floats, toolface: Floats, radius: Floats, turn: Integers
) -> Calibrated:
    name, size = _name(casing), 0.5 * casing.inner_diameter
    if size <= echo.tool_radius:
        raise InputError(name, f"its inner diameter must be above that of the tool, {2e3 * echo.tool_radius:.1f} mm")
    turns, row = np.unique(turn, return_inverse=True)
    place = row // TURNS
    if place.size == 0 or (whole := turns.size // TURNS) < FEWEST:
        rule = f"{turns.size} turns of samples lie in it: must be at least {TURNS * FEWEST}"
        raise InputError(name, rule, setting="echo.casing")
    kept = place < whole
    factor, off = _fit(radius[kept] - echo.tool_radius, toolface[kept], place[kept], size - echo.tool_radius, size)
    factor, off = factor[np.isfinite(factor)], off[np.isfinite(factor)]
    if factor.size < FEWEST:
        rule = "the tool looks at one side of it: the centre of the tool is not known, and the velocity is not either"
        raise InputError(name, rule, setting="echo.casing")
    middle = float(np.median(factor))
    standoff = size - echo.tool_radius
    uneven = 1.4826 * float(np.median(np.abs(factor - middle))) / middle * standoff
    if uneven > UNEVEN:
        rule = (
            f"no pipe: the radius there differs by {1e3 * uneven:.1f} mm from place to place (robust deviation), and "
            f"may by {1e3 * UNEVEN:.1f} mm"
        )
        raise InputError(name, rule, setting="echo.casing")
    parts = np.array([np.median(part) for part in np.array_split(factor, min(8, factor.size))])
    random = 1.25 * float(np.std(parts, ddof=1)) / np.sqrt(parts.size) / middle
    motion = float(np.median(off)) ** 2 / (2 * size)  # of the tool within a place: a mean of radii is too short by it
    velocity = echo.velocity * middle
    random = float(velocity * np.hypot(random, motion / standoff))
    found = Calibrated(casing, float(np.median(depth)), velocity, random, velocity * 0.5 * echo.casing_sigma / standoff)
    _require_agreement(echo, found, name)
    return found


def _require_agreement(echo: Echo, found: Calibrated, name: str) -> None:
    """Refuse a casing that contradicts the stated velocity."""
    apart, stated = abs(found.velocity - echo.velocity), echo.velocity_sigma
    most = UNCALIBRATED * echo.velocity if stated is None else DOUBT * float(np.hypot(stated, found.sigma))
    if apart <= most:
        return
    own = f"{echo.velocity:g} m/s" + ("" if stated is None else f" with a deviation of {stated:g} m/s")
    rule = (
        f"its inner diameter of {1e3 * found.casing.inner_diameter:.1f} mm needs a velocity of {found.velocity:.0f} "
        f"m/s, {100 * (found.velocity / echo.velocity - 1):+.1f} % from echo.velocity = {own}: check diameter, depths, "
        "velocity, tool_radius and window"
    )
    raise InputError(name, rule, setting="echo.casing")


def _fit(standoff: Floats, toolface: Floats, place: Integers, wanted: float, size: float) -> tuple[Floats, Floats]:
    """Return by what the standoffs of each place must be multiplied to lie in a pipe, and the rms of what is left.

    NaN where the directions of a place do not show its centre.
    """
    angle, count = np.radians(toolface), int(place.max()) + 1
    columns = standoff, np.cos(angle), np.sin(angle)
    weight, target = np.ones(standoff.size), np.full(standoff.size, wanted)
    factor, left = np.full(count, np.nan), np.full(count, np.nan)
    for _ in range(4):
        sums = [np.bincount(place, weight * columns[a] * columns[b], count) for a in range(3) for b in range(3)]
        right = np.stack([np.bincount(place, weight * column * target, count) for column in columns], axis=-1)
        normal = np.stack(sums, axis=-1).reshape(count, 3, 3)
        scale = np.sqrt(np.maximum(np.einsum("kii->ki", normal), 1e-300))
        normal = normal / (scale[:, :, None] * scale[:, None, :])
        known = np.linalg.eigvalsh(normal)[:, 0] > 0.02
        solved = np.full((count, 3), np.nan)
        solved[known] = np.linalg.solve(normal[known], (right / scale)[known][..., None])[..., 0]
        factor, x, y = (solved / scale).T
        across = x[place] * columns[2] - y[place] * columns[1]
        target = wanted - across**2 / (2 * size)
        residual = factor[place] * standoff + x[place] * columns[1] + y[place] * columns[2] - target
        away = np.abs(np.where(np.isfinite(residual), residual, 0.0))
        robust = 1.4826 * float(np.median(away)) + 1e-6
        weight = np.square(np.maximum(1.0 - np.square(away / (5.0 * robust)), 0.0))
        total = np.maximum(np.bincount(place, weight, count), 1e-300)
        left = np.sqrt(np.bincount(place, weight * away**2, count) / total)
        target = np.where(np.isfinite(target), target, wanted)
    return factor, left


def _alike(apart: Floats, reach: float) -> Floats:
    """Return Matern's correlation (3/2) at distances."""
    far = np.sqrt(3.0) * np.abs(apart) / reach
    found: Floats = (1.0 + far) * np.exp(-far)
    return found


def echo_accuracy(velocities: Sequence[MudVelocity], start: float, stop: float) -> dict[str, Any]:
    """Return the deviation of the velocity, as a share of it, along a well, for the record of its wall.

    Of several files, the largest at each depth counts.
    """
    depth = np.linspace(start, stop, int(np.clip((stop - start) / STEP, 2, MOST)))
    share = np.max([sigma / velocity for velocity, sigma in (each.at(depth) for each in velocities)], axis=0)
    tool = min(each.echo.tool_radius for each in velocities)
    return {"tool_radius": tool, "depth": depth.tolist(), "share": share.tolist()}
