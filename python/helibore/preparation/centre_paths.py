r"""Find the path of a tool's centre along many turns: a part that rests, and one that goes round with the tool.

    radius(toolface, position) = wall(toolface) - Re(c exp(i (rate position - toolface))) + noise

In windows of twelve turns the wall is free: it takes one radius, and one slope along the window, at each of its knots
around the hole. What is left in a turn and not in the next at the same toolface is the motion of the tool, a wave with
one rate. Without that motion, the wall is a curve about the resting part of the centre.

The resting part is found only by the size of the bit: the rock that is not worn lies on a circle of this size, of which
breakouts and key seats hide a part. The centre of the circle is that of the bit if half of the curve lies on it and no
gap in it is wider than 125 degrees; else the resting part is refused. Without a bit size a washout on one side is an
off-centre circle, so the resting part is not found at all.

Windows overlap by half; the centre at a sample is interpolated between those of its two windows.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from helibore.base.arrays import Complexes, Floats, Integers, Mask
from helibore.preparation.eccentering import Centres

WINDOW = 12
"""Turns in a window; the next begins half a window later."""
LEAST_SAMPLES = 8
"""Least number of samples in a turn, in the median, for which a window is judged."""

_KNOTS = 32  # most knots of the wall
_SLOWEST, _FASTEST, _RATE_STEP = 12.0, 348.0, 8.0  # degrees a turn: rates of the motion that are tried
_ROUNDS = 4
_HUBER = 2.0
_SHOWN = 0.75  # least share of what moves in the window that a motion explains
_MOVES = 30.0  # least gain of a motion, in variances of the noise
_LEAST_NOISE = 1e-4  # m
_UNEXPLAINED = 0.0015  # m: rms of what neither wall nor noise explains, from which no motion counts as known
_FITS = 0.0015  # m: unworn rock lies so close to its circle, if the noise of the knots is not larger
_ROUND_STEPS = (0.008, 0.005, 0.003, 0.002, 0.0012)  # m: deviations of unworn rock, step by step
_INWARD = 2.5  # a point inside the circle counts this much less far off
_OFF_BIT = 0.002  # m: most difference of the unworn radius from the bit's
_AROUND = 9  # windows; a resting part is refused if half of those around it are
_SIZE_PRIOR, _CENTRE_PRIOR = 0.003, 0.015  # m
_WIDEST_GAP = 125.0  # degrees
_ALIKE = 3.0  # knots, beside which the shape of unworn rock is alike
_FINEST = 5e-5  # m: least deviation of a resting part
# Wear on one side (60 to 360 degrees wide, up to 10 mm deep) that passes for unworn puts the centre off by up to 1.8
# times the growth of the circle; a third of that is its deviation. A crescent of wear leaves a perfect circle. So a
# round hole that is larger than the bit looks the same, and its deviation is that large, too.
_ONE_SIDED = 0.6


@dataclass(frozen=True)
class CentrePath:
    """The centre of a tool in w windows; metres from the hole's axis towards toolface 0 (real) and 90 (imaginary)."""

    middle: Floats  # position of each window along the turns, (w,), rising
    rest: Complexes  # the part that rests; NaN where it is not known, (w,)
    rest_sigma: Floats  # its deviation in each of two directions, (w,) m
    moving: Complexes  # the part that goes round, at the middle of the window, (w,)
    change: Complexes  # how it changes along the window beside its turning, a turn, (w,)
    rate: Floats  # radians a turn, (w,)
    moving_sigma: Floats  # its deviation in each of two directions; NaN where it is not known, (w,) m
    radius: Floats  # of the unworn hole, or of the mean wall, (w,) m
    noise: Floats  # of the samples about the fitted wall, (w,) m
    inliers: Floats  # share of the samples within three times the noise, (w,)

    def moving_at(self, window: Integers, position: Floats) -> Complexes:
        """Return where the moving part of a window puts the centre at positions, (n,)."""
        away = position - self.middle[window]
        moved: Complexes = (self.moving[window] + self.change[window] * away) * np.exp(1j * self.rate[window] * away)
        return moved

    def at(self, position: Floats, significance: float = 3.0) -> tuple[Complexes, Mask, Mask]:
        """Return the centre to correct at each position, (n,), and whether its resting and moving parts are known."""
        left, part = self._between(position)
        total = np.zeros(position.size, dtype=np.complex128)
        rests, moves = np.zeros((2, position.size), dtype=bool)
        share_rest = _share(self.rest, self.rest_sigma, significance)
        share_moving = _share(self.moving, self.moving_sigma, significance)
        weights = np.zeros((2, position.size))
        values = np.zeros((2, position.size), dtype=np.complex128)
        for window, weight in ((left, 1.0 - part), (np.minimum(left + 1, self.middle.size - 1), part)):
            known = np.isfinite(self.rest[window])
            values[0] += np.where(known, weight * np.nan_to_num(share_rest * self.rest)[window], 0.0)
            weights[0] += np.where(known, weight, 0.0)
            known = np.isfinite(self.moving_sigma[window])
            moved = share_moving[window] * self.moving_at(window, position)
            values[1] += np.where(known, weight * moved, 0.0)
            weights[1] += np.where(known, weight, 0.0)
        rests, moves = weights[0] >= 0.5, weights[1] >= 0.5
        total += np.where(rests, values[0] / np.maximum(weights[0], 1e-9), 0.0)
        total += np.where(moves, values[1] / np.maximum(weights[1], 1e-9), 0.0)
        return total, rests, moves

    def centres(self, turn: Integers, samples: Integers) -> Centres:
        """Return the centre in the middle of each turn, (t,), NaN where its resting or moving part is not known."""
        position = turn.astype(np.float64) + 0.5
        centre, rests, moves = self.at(position, 0.0)
        x, y = (np.where(rests & moves, each, np.nan) for each in (centre.real, centre.imag))
        near = np.clip(np.searchsorted(self.middle, position), 0, self.middle.size - 1)
        near -= (near > 0) & (np.abs(self.middle[near - 1] - position) < np.abs(self.middle[near] - position))
        variance = np.square(self.rest_sigma[near]) + np.square(self.moving_sigma[near])
        known = np.isfinite(variance)
        covariance = np.where(known & np.isfinite(x), variance, np.nan)[:, None, None] * np.eye(2)
        none = np.full(turn.size, np.nan)
        size, noise, inliers = (
            np.where(samples > 0, each[near], none) for each in (self.radius, self.noise, self.inliers)
        )
        x, y = np.where(known, x, np.nan), np.where(known, y, np.nan)
        return Centres(turn, x, y, covariance, size, noise, inliers, samples, 0.0 * x, covariance)

    def _between(self, position: Floats) -> tuple[Integers, Floats]:
        last = max(self.middle.size - 2, 0)
        left = np.clip(np.searchsorted(self.middle, position, side="right") - 1, 0, last)
        if self.middle.size < 2:
            return left, np.zeros(position.size)
        gap = self.middle[left + 1] - self.middle[left]
        return left, np.clip((position - self.middle[left]) / gap, 0.0, 1.0)


def _share(centre: Complexes, sigma: Floats, significance: float) -> Floats:
    """Return the share of each centre to correct: 0 up to ``significance`` deviations, and soon 1."""
    ratio = np.square(np.abs(np.nan_to_num(centre)) / np.where(np.isfinite(sigma), np.maximum(sigma, 1e-9), np.inf))
    least = significance**2
    return np.where(ratio > least, 1.0 - np.square(least / np.maximum(ratio, max(least, 1e-9))), 0.0)


def find_centre_path(
    toolface: Floats, radius: Floats, position: Floats, bit_diameter: float | None = None
) -> CentrePath | None:
    """Return the path of a tool's centre, or None if its turns are too few, or have too few samples.

    ``toolface``, ``radius`` and ``position`` are degrees, metres and turns, (n,), with ``position`` as
    `eccentering.turn_positions` returns it; NaN radii are left out.
    """
    known = np.flatnonzero(np.isfinite(radius))
    if not known.size:
        return None
    order = known[np.argsort(position[known], kind="stable")]
    where, angle, distance = position[order], np.radians(toolface[order]), radius[order]
    count = np.bincount(np.floor(where - where[0]).astype(np.int64))
    if where[-1] - where[0] < 0.5 * WINDOW or np.median(count) < LEAST_SAMPLES:
        return None
    knots = int(min(_KNOTS, np.median(count)))
    half = 0.5 * WINDOW
    middles = np.arange(where[0] + half, max(where[-1] - half, where[0] + half) + 0.5 * half, half)
    columns: list[_Row] = []
    for middle in middles:
        first, last = np.searchsorted(where, (middle - half, middle + half))
        some = slice(first, last)
        columns.append(_window(where[some] - middle, angle[some], distance[some], knots, bit_diameter))
    table = np.array(columns, dtype=np.complex128).T
    rest, moving, change = table[0], table[2], table[3]
    rest_sigma, rate, moving_sigma, size, noise, inliers = (table[column].real for column in (1, 4, 5, 6, 7, 8))
    path = CentrePath(middles, rest, rest_sigma, moving, change, rate, moving_sigma, size, noise, inliers)
    return _checked(path)


_Row = tuple[complex, float, complex, complex, float, float, float, float, float]
_NOTHING: _Row = (complex(np.nan, np.nan), np.nan, 0j, 0j, 0.0, np.nan, np.nan, np.nan, np.nan)


def _window(place: Floats, angle: Floats, distance: Floats, knots: int, bit: float | None) -> _Row:
    """Return a window's row of the path; ``place`` is the position from the middle of the window."""
    if place.size < 4 * knots:
        return _NOTHING
    seen = distance * np.exp(1j * angle)
    motion = _motion(seen, place, knots)
    if motion is None:
        return _NOTHING
    moving, change, rate = motion
    moved = seen + (moving + change * place) * np.exp(1j * rate * place)
    values, design, weight = np.abs(moved), _wall_design(np.angle(moved), place, knots), np.ones(place.size)
    wall, off, scale = np.zeros(2 * knots), values, _LEAST_NOISE
    for _ in range(_ROUNDS):
        wall = np.linalg.lstsq(design * weight[:, None], values * weight, rcond=None)[0]
        off = values - design @ wall
        scale = max(_scale(off), _LEAST_NOISE)
        weight = np.sqrt(np.minimum(1.0, _HUBER * scale / np.maximum(np.abs(off), 1e-9)))
    rms = max(float(np.sqrt(np.mean(np.square(weight * off)))), _LEAST_NOISE)
    inliers = float(np.mean(np.abs(off) <= 3 * scale))
    moving_sigma = 2.0 * rms * float(np.sqrt(2.0 / (place.size - 2 * knots)))
    rest, rest_sigma, radius = complex(np.nan, np.nan), np.nan, float(np.mean(wall[:knots]))
    if bit is not None:
        curve = values - design[:, knots:] @ wall[knots:]
        rest, rest_sigma, radius = _unworn(np.angle(moved), curve, 0.5 * bit, rms, _ALIKE * place.size / knots)
    return rest, rest_sigma, moving, change, rate, moving_sigma, radius, rms, inliers


def _motion(seen: Complexes, place: Floats, knots: int) -> tuple[complex, complex, float] | None:
    """Return the moving part of the centre, its change a turn, and its rate in radians a turn; 0: there is no motion.

    ``seen`` are the points of the wall from the tool. None: something moves in the window that no motion explains.
    """
    moving, change, rate = 0j, 0j, 0.0
    weight, value, scale = np.ones(place.size), np.zeros(place.size), _LEAST_NOISE
    for turn in range(_ROUNDS):
        moved = seen + (moving + change * place) * np.exp(1j * rate * place)
        basis = np.linalg.qr(_wall_design(np.angle(moved), place, knots) * weight[:, None])[0]
        value = np.abs(moved) * weight
        value -= basis @ (basis.T @ value)
        if turn == 0:
            clip = 3.0 * max(_scale(value), _LEAST_NOISE)
            weight = np.where(np.abs(value) > clip, 0.3, 1.0)
            value = np.clip(value, -2 * clip, 2 * clip)
            rate, gain = _rate(value, basis, np.angle(moved), place, weight)
            if gain < _MOVES * np.square(max(_scale(value), _LEAST_NOISE)):
                break
        else:
            weight = np.minimum(1.0, _HUBER * scale / np.maximum(np.abs(value) / np.maximum(weight, 0.1), 1e-9))
        wave = -np.exp(1j * (rate * place - np.angle(moved)))
        waves = np.stack([wave.real, -wave.imag, place * wave.real, -place * wave.imag], axis=1) * weight[:, None]
        waves -= basis @ (basis.T @ waves)
        solved = np.linalg.lstsq(waves, value, rcond=None)[0]
        value = value - waves @ solved
        scale = max(_scale(value), _LEAST_NOISE)
        moving += complex(solved[0], solved[1])
        change += complex(solved[2], solved[3])
        turned = (change / moving).imag if abs(moving) > 1e-6 else 0.0  # what the rate lacks
        if abs(turned) < 0.5:
            rate, change = rate + turned, change - 1j * turned * moving
        if not _RATES[-1] >= abs(rate) >= np.radians(_SLOWEST) - 1e-9:
            moving, change, rate = 0j, 0j, 0.0  # so slow a motion is that of the resting part
            break
    size = place.size - 2 * knots
    noise = float(np.sqrt(float(value @ value) / size))
    unexplained = max(noise**2 - _near_noise(seen) ** 2, 0.0)
    power = 0.5 * abs(moving) ** 2
    shown = power * size > _MOVES * noise**2
    if shown and power > _SHOWN * (power + unexplained):
        return moving, change, rate
    return None if shown or unexplained > _UNEXPLAINED**2 else (0j, 0j, 0.0)


def _scale(off: Floats) -> float:
    return 1.4826 * float(np.median(np.abs(off)))


def _near_noise(seen: Complexes) -> float:
    """Return the deviation of samples by their third differences along the turn, metres."""
    third = np.diff(np.abs(seen), 3)
    return _scale(third) / float(np.sqrt(20.0))


def _wall_design(angle: Floats, place: Floats, knots: int) -> Floats:
    """Return the terms of a wall that is linear between knots around the hole, and linear along the window."""
    at = angle * (knots / (2 * np.pi)) % knots
    left = np.floor(at).astype(np.int64) % knots
    part = at - np.floor(at)
    design = np.zeros((angle.size, 2 * knots))
    row = np.arange(angle.size)
    right = (left + 1) % knots
    along = place / (0.5 * WINDOW)
    design[row, left], design[row, right] = 1 - part, part
    design[row, knots + left], design[row, knots + right] = (1 - part) * along, part * along
    return design


_RATES = np.radians(np.concatenate([
    np.arange(-_FASTEST, -_SLOWEST + 1, _RATE_STEP), np.arange(_SLOWEST, _FASTEST + 1, _RATE_STEP)
]))  # fmt: skip


def _rate(value: Floats, basis: Floats, angle: Floats, place: Floats, weight: Floats) -> tuple[float, float]:
    """Return the rate of the wave that explains most of ``value``, radians a turn, and how much of its square."""
    rates, best, most = _RATES, 0.0, 0.0
    for fine in (False, True):
        if fine:
            rates = best + np.radians(np.arange(-6.0, 6.1, 1.5))
        wave = -np.exp(1j * (rates * place[:, None] - angle[:, None])) * weight[:, None]
        both = np.concatenate([wave.real, -wave.imag], axis=1)
        both -= basis @ (basis.T @ both)
        one, two = both[:, : rates.size], both[:, rates.size :]
        aa, bb, ab = np.square(one).sum(axis=0), np.square(two).sum(axis=0), (one * two).sum(axis=0)
        av, bv = value @ one, value @ two
        gain = (bb * av**2 - 2 * ab * av * bv + aa * bv**2) / np.maximum(aa * bb - ab**2, 1e-12)
        gain[aa * bb - ab**2 < 0.05 * (0.5 * place.size) ** 2] = 0.0  # the wall explains such a wave
        at = int(np.argmax(gain))
        best, most = float(rates[at]), float(gain[at])
    return best, most


def _unworn(at: Floats, curve: Floats, bit: float, noise: float, alike: float) -> tuple[complex, float, float]:
    """Return the tool's centre in the unworn circle of a wall about the tool, its deviation, and the circle's radius.

    ``curve`` has a radius at each angle ``at``; ``noise`` is its deviation, and as many radii as ``alike`` are off
    together by the shape of the wall. NaN: there is no such circle.
    """
    points = curve * np.exp(1j * at)
    mean = points.mean()
    best: tuple[float, complex, float, Floats, Floats] | None = None
    for centre in (0j, -mean, mean, -2 * mean):
        size = bit
        for deviation in np.repeat(_ROUND_STEPS, 2):
            place = points + centre
            off = np.abs(place) - size
            weight = np.exp(-0.5 * np.square(off / np.where(off > 0, deviation, _INWARD * deviation)))
            unit = place / np.abs(place)
            slope = np.stack([unit.real, unit.imag, -np.ones(at.size)], axis=1)
            matrix = (slope * weight[:, None]).T @ slope
            side = -(slope * weight[:, None]).T @ off
            ridge = np.square(deviation) * np.array([_CENTRE_PRIOR**-2, _CENTRE_PRIOR**-2, _SIZE_PRIOR**-2])
            matrix[range(3), range(3)] += ridge
            side -= ridge * np.array([centre.real, centre.imag, size - bit])
            step = np.linalg.solve(matrix, side)
            centre, size = centre + complex(step[0], step[1]), size + float(step[2])
        off = np.abs(points + centre) - size
        score = float(np.exp(-0.5 * np.square(off / 0.0015)).sum() - 0.5 * np.count_nonzero(off < -0.003))
        score -= at.size * 0.2 * min(abs(size - bit) / 0.005, 1.0)
        if best is None or score > best[0]:
            best = (score, centre, size, off, weight)
    assert best is not None
    _, centre, size, off, weight = best
    fits = np.abs(off) <= max(_FITS, 3 * noise)
    gap = _widest_gap(at[fits])
    if fits.mean() < 0.5 or gap > _WIDEST_GAP or abs(size - bit) > _OFF_BIT or np.mean(off < -0.003) > 0.1:
        return complex(np.nan, np.nan), np.nan, float(curve.mean())
    left = float(np.sqrt(np.mean(np.square(off[fits]))))
    unit = (points + centre)[fits] / np.abs((points + centre)[fits])
    slope = np.stack([unit.real, unit.imag, -np.ones(unit.size)], axis=1)
    matrix = slope.T @ slope
    matrix[2, 2] += np.square(left / _SIZE_PRIOR)
    inverse = np.linalg.inv(matrix)
    shape = float(np.sqrt(max(left**2 - noise**2, 0.0)))
    sigma = float(np.sqrt((noise**2 + alike * shape**2) * 0.5 * (inverse[0, 0] + inverse[1, 1])))
    worn = _ONE_SIDED * max(size - bit, 0.0)
    return centre, float(np.sqrt(sigma**2 + worn**2 + _FINEST**2)), size


def _widest_gap(at: Floats) -> float:
    if at.size < 2:
        return 360.0
    turned = np.sort(at)
    return float(np.degrees(np.diff(np.append(turned, turned[0] + 2 * np.pi)).max()))


def _checked(path: CentrePath) -> CentrePath:
    """Return the path without resting parts where those around it are refused, and with deviations of the moving part
    that contain how far neighbouring windows differ in the middle between them."""
    known = np.isfinite(path.rest)
    first = np.maximum(np.arange(known.size) - _AROUND // 2, 0)
    stop = np.minimum(np.arange(known.size) + _AROUND // 2 + 1, known.size)
    total = np.append(0, np.cumsum(known))
    around = (total[stop] - total[first]) / (stop - first)
    lost = known & (around < 0.5)
    rest, rest_sigma = np.where(lost, complex(np.nan, np.nan), path.rest), np.where(lost, np.nan, path.rest_sigma)
    left = np.arange(path.middle.size - 1)
    between = 0.5 * (path.middle[left] + path.middle[left + 1])
    apart = np.nan_to_num(np.abs(path.moving_at(left, between) - path.moving_at(left + 1, between)))
    apart[~np.isfinite(path.moving_sigma[left] + path.moving_sigma[left + 1])] = 0.0
    most = np.maximum(np.append(0.0, apart), np.append(apart, 0.0))
    # A motion goes on: one that neither neighbour shares is a step of the hole.
    least = np.minimum(np.append(np.inf, apart), np.append(apart, np.inf))
    alone = (path.moving != 0) & (least > 0.5 * np.abs(path.moving)) & (path.middle.size > 1)
    moving, change = np.where(alone, 0.0, path.moving), np.where(alone, 0.0, path.change)
    moving_sigma = np.where(alone, np.nan, np.hypot(path.moving_sigma, 0.25 * most))
    return replace(path, rest=rest, rest_sigma=rest_sigma, moving=moving, change=change, moving_sigma=moving_sigma)
