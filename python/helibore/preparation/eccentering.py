"""Find the tool's centre in the hole, turn by turn, and convert samples to radii from the hole's axis.

A sample of radius r at toolface a, taken by a tool whose centre lies at c = (x, y), sees the wall at c + r u(a)::

         toolface 0                 rho = |c + r u|     radius from the hole's axis
             | x                    phi = arg(c + r u)  its toolface
             |   . wall
             |  /r                  rho(phi) = R + sum over n = 2 .. H of (a_n cos n phi + b_n sin n phi) + noise
      axis   +-c---- y (toolface 90)

The hole's axis is the point from which the wall has no first harmonic, so c is the offset that removes it from
rho(phi). This is exact for any shape, without a small-offset expansion; for a circle it equals r = e cos psi + sqrt(R^2
- e^2 sin^2 psi).

Offset is the odd first harmonic; ovality and opposite breakouts are even. So even harmonics may be large (``even``),
odd harmonics are small (``odd``), and all are marginalised with these as Gaussian priors. If a part of the circle is
missing, harmonics become hard to tell from an offset, and the stated covariance grows. It has three parts:

- the posterior covariance at the noise found in the turn (Tukey's biweight keeps spikes out);
- the jackknife of the turn's own residuals ("HC3", MacKinnon and White 1985), for edges that no H harmonics follow;
- the one-sided wall: a washout on one side has a first harmonic, which no fit can separate from an offset, but it also
  has higher harmonics. A box of width b has |a_1 / a_n| = n |sin(b/2) / sin(n b/2)|. Therefore four times the odd
  harmonics beyond their prior is added to the deviation of the centre.

A second fit allows odd harmonics as large as those of a washout. If the samples show such harmonics, or cannot exclude
them because much of the circle is missing, the two models are mixed. Then the wall may have a first harmonic of its
own, which makes the offset smaller. The covariance includes both models and the difference between them, and less of
the offset is corrected (``Centres.one_sided``, ``Centres.share``).

Harmonics do not fit a wall with steps; 32 samples a turn in breakouts with upright edges leave an error of 0.6 mm. So a
rough turn is fitted twice more: as an oval with two opposite steps, and as an oval with one step. All edges are tried,
and the models are mixed by their evidence (``turn_fits``).

One case cannot be detected. A smooth washout on one side, 120 deg wide or more, has hardly a third harmonic, and its
first and second harmonics are those of a tool off centre in an oval hole. The axis found is then that of the washed-out
wall. If the bit size is known, the covariance includes this error, because a wall that lies nowhere inside the bit has
a first harmonic of at most twice the excess of its mean radius. A tool that whirls moves during a turn. If the position
of every sample along the turns is given, the centre is interpolated between turns, and the fit is repeated in the
moving frame.

The caller says by whole numbers which samples form a turn; for a tool that does not rotate, a turn may be any group.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import numpy.typing as npt

from helibore.base.angles import wrapped
from helibore.base.arrays import Complexes, Floats, Integers, Mask, Reals, column, finite_column, require, whole_column
from helibore.base.errors import InputError
from helibore.preparation.turn_fits import Shape, TurnFits, estimate, powers

__all__ = ["Centres", "Shape", "find_centres", "recentre", "turn_positions"]

_SAMPLES_AT_ONCE = 1 << 16
_EXCESS = 0.8  # deviation of the centre / excess of the mean radius over the bit's. With 2/3, the bound of twice the
# excess would be 3 deviations; this is more, because the mean radius about a wrong axis is too small.
_FASTEST_WHIRL = 100.0  # degrees a turn; a centre that goes around the axis faster cannot be followed
_SHAPE_HARMONICS = 8
_SHOWN = 0.7  # if the samples show less than this share of the wave that the centres predict, the centres are wrong
_MOTION_ROUNDS = 2  # number of fits in which the samples follow the centre from turn to turn


@dataclass(frozen=True)
class Centres:
    """The tool's centre in each of t turns, sorted by ``turn``; metres.

    A turn without a radius has 0 ``samples`` and NaN in all other columns. The centre and its covariances are also NaN
    if the tool moves too far from turn to turn to be followed, or if the samples contradict the centre.
    """

    turn: Integers
    x: Floats  # centre of the tool from the hole's axis towards toolface 0
    y: Floats  # centre of the tool from the hole's axis towards toolface 90
    covariance: Floats  # of (x, y), (t, 2, 2) m^2
    mean_radius: Floats  # of the hole about its axis
    noise: Floats  # deviation of the samples from the fitted wall
    inliers: Floats  # share of the samples within three times ``noise`` of the fitted wall
    samples: Integers  # number of samples with a finite radius
    one_sided: Floats  # weight, 0 to 1, of a wall enlarged on one side: 0 if the samples exclude such a wall
    within: Floats  # covariance if the wall is not enlarged on one side, (t, 2, 2) m^2

    def __repr__(self) -> str:
        known = self.eccentering[np.isfinite(self.x)]
        off = f"median offset of the tool {1e3 * np.median(known):.1f} mm" if known.size else "no turn has a centre"
        return f"Centres({self.turn.size} turns, {off})"

    @property
    def sigma_x(self) -> Floats:
        """Standard deviation of x, (t,) m."""
        return np.sqrt(self.covariance[:, 0, 0])

    @property
    def sigma_y(self) -> Floats:
        """Standard deviation of y, (t,) m."""
        return np.sqrt(self.covariance[:, 1, 1])

    @property
    def eccentering(self) -> Floats:
        """Distance of the tool's centre from the hole's axis, (t,) m."""
        return np.hypot(self.x, self.y)

    @property
    def direction(self) -> Floats:
        """Toolface of the tool's centre as seen from the hole's axis, (t,) degrees in [0, 360)."""
        return wrapped(np.degrees(np.arctan2(self.y, self.x)))

    def share(self, significance: float = 3.0) -> Floats:
        """Return the share of each centre to correct: (1 - one_sided) max(0, 1 - (significance / c' within^-1 c)^2).

        c is the centre (x, y). If the tool is centred, c' within^-1 c follows chi-squared with two degrees of freedom,
        or is smaller, since the covariance is rather too large. So it exceeds 3 in at most 22 % of such turns, mostly
        by little, and noise is rarely taken for eccentering. For a centre ten standard deviations off the axis,
        the second factor is 0.999; with ``significance=0`` it is 1. Turns without a centre get 0.
        """
        centre = np.stack([self.x, self.y], axis=1)
        found = np.isfinite(self.x)
        ratio = np.zeros(self.x.size)
        solved = np.linalg.solve(self.within[found], centre[found, :, None])[..., 0]
        ratio[found] = (centre[found] * solved).sum(axis=1)
        if significance <= 0:
            return np.where(found, 1.0 - np.nan_to_num(self.one_sided), 0.0)
        known = ratio > significance
        share = np.zeros(self.x.size)
        share[known] = 1.0 - np.square(significance / ratio[known])
        share[found] *= 1.0 - self.one_sided[found]
        return share


def turn_positions(toolface: npt.ArrayLike) -> Floats:
    """Return the number of turns made at every sample of a rotating tool, from its toolfaces in order of time, (n,).

    Each step between two samples is taken the short way round, which is right if it is less than 180 degrees; the steps
    are summed from toolface 0 of the first turn on. A tool that turns back (stick-slip) returns into its previous turn.
    """
    positions: Floats = np.unwrap(finite_column("toolface", toolface) % 360.0, period=360.0) / 360.0
    return positions


def find_centres(
    toolface: npt.ArrayLike,
    radius: npt.ArrayLike,
    turn: npt.ArrayLike,
    shape: Shape | None = None,
    *,
    bit_diameter: float | None = None,
    position: npt.ArrayLike | None = None,
) -> Centres:
    """Find the tool's centre in every turn, with its covariance.

    Parameters
    ----------
    toolface, radius
        As measured from the tool's centre, degrees and metres, (n,), in any order. Samples with a NaN radius are left
        out.
    turn
        Whole numbers, (n,): samples with the same number share one centre.
    shape
        What to expect of the hole and the tool; None: ``Shape()``.
    bit_diameter
        Metres. The wall lies nowhere inside the bit, so its first harmonic is at most twice the excess of its mean
        radius over the bit's; that bound becomes 2.5 standard deviations of the centre. Without a bit size a smooth
        washout on one side, in which the tool is centred, goes unnoticed.
    position
        Position of each sample along the turns, (n,); turn + 0.5 is the middle of a turn (:func:`turn_positions`). The
        centre then moves from turn to turn while the samples are taken, and the result is the centre in the middle of
        the turn. None: the centre rests during a turn. A centre is NaN if it goes around the axis by more than 100
        degrees a turn, because it cannot be followed, or if the samples within the turns contradict it, for example
        where the hole changes much from turn to turn. A whirl nearly as fast as the tool turns, up to 340 degrees a
        turn, makes the hole seem to grow and shrink along the turns; a hole that really does so increases sigma as
        much. (A centre that turns with the tool, 360 degrees a turn, shows the same radius all the time.)

    Returns
    -------
    Centres
        Sorted by turn. Without ``position`` each turn depends on its own samples only.

    Raises
    ------
    InputError
        If lengths differ, a toolface, turn or position is not finite, a turn is not whole, a radius is infinite or not
        above 0, or the bit diameter is not finite and above 0.
    """
    shape = Shape() if shape is None else shape
    angle, distance, number = _samples(toolface, radius, turn)
    if bit_diameter is not None and not 0 < bit_diameter < np.inf:
        raise InputError("bit_diameter", "must be finite and above 0", f"{bit_diameter:g}")
    place = None if position is None else finite_column("position", position, angle.size, "toolface")
    turns, row = np.unique(number, return_inverse=True)
    known = np.flatnonzero(np.isfinite(distance))
    order = known[np.argsort(row[known], kind="stable")]
    count = np.bincount(row[known], minlength=turns.size)
    x, y, mean_radius, noise, inliers, one_sided = np.full((6, turns.size), np.nan)
    covariance, within = np.full((2, turns.size, 2, 2), np.nan)
    result = Centres(turns, x, y, covariance, mean_radius, noise, inliers, count, one_sided, within)
    seen = np.radians(angle[order])
    reach = distance[order] * (np.cos(seen) + 1j * np.sin(seen))
    smooth_radius = _fit(result, reach, shape)
    size_deviation = np.zeros(turns.size)
    if place is not None and turns.size:
        for _ in range(_MOTION_ROUNDS):
            centre = x + 1j * y
            moved = _moving(turns, centre, place[order], row[order])
            smooth_radius = _fit(result, reach + moved - centre[row[order]], shape)
        spread = noise / np.sqrt(np.maximum(count, 1))
        size_deviation = _size_deviation(mean_radius, spread)
        for deviation in (_motion_deviation(turns, x + 1j * y), size_deviation):
            _widen(covariance, deviation)
            _widen(within, deviation)
        lost = _too_fast(turns, x + 1j * y, spread)
        lost |= _contradicted(result, reach, place[order], row[order])
        x[lost], y[lost], covariance[lost], within[lost] = np.nan, np.nan, np.nan, np.nan
    if bit_diameter is not None:
        for spread_of, size in ((covariance, mean_radius), (within, smooth_radius)):
            _widen(spread_of, _EXCESS * np.maximum(size + size_deviation - 0.5 * bit_diameter, 0.0))
    return result


def _fit(result: Centres, reach: Complexes, shape: Shape) -> Floats:
    """Fit all turns, hundreds or thousands at once, and write the centres into ``result``.

    ``reach`` are the samples as x + i y from the tool's centre, sorted by turn. Returns the mean radius of each turn
    without its steps, (t,) m.
    """
    smooth_radius = np.full(result.turn.size, np.nan)
    filled = np.flatnonzero(result.samples)
    ends = np.cumsum(result.samples[filled])
    first = 0
    while first < filled.size:
        begin = ends[first] - result.samples[filled[first]]
        last = max(first + 1, int(np.searchsorted(ends, begin + _SAMPLES_AT_ONCE, side="right")))
        rows = filled[first:last]
        found = estimate(TurnFits(reach[begin : ends[last - 1]], result.samples[rows], shape))
        result.x[rows], result.y[rows] = found.centre.real, found.centre.imag
        for name in ("covariance", "within", "one_sided", "mean_radius", "noise", "inliers"):
            getattr(result, name)[rows] = getattr(found, name)
        smooth_radius[rows] = found.smooth_radius
        first = last
    return smooth_radius


def _widen(covariance: Floats, deviation: Floats) -> None:
    """Widen the covariances of centres, in place, by a ``deviation``, (t,) metres, equal in all directions."""
    covariance[:, [0, 1], [0, 1]] += np.square(deviation)[:, None]


def _moving(turns: Integers, centre: Complexes, place: Floats, row: Integers) -> Complexes:
    """Return the tool's centre at each sample; ``place`` is the position of the sample along the turns.

    The centre at a sample lies on a cubic through the centres of the two turns before and the two turns after the
    place, each in the middle of its turn; beside a gap, on a line through the two nearest centres. If one of these two
    is missing, the result is the centre of the sample's own turn, ``row``.
    """
    line, bend = _line_and_bend(turns, centre, place)
    curve = np.where(np.isfinite(bend), line + bend, line)
    moved: Complexes = np.where(np.isfinite(curve), curve, centre[row])
    return moved


def _motion_deviation(turns: Integers, centre: Complexes) -> Floats:
    """Return the deviation of the centre due to its motion during the turn, (t,) metres.

    The deviation is half the distance between the cubic and the line (`_moving`) where a turn ends and the next begins.
    The result for a turn is the largest such deviation among the five turns around it.
    """
    bend = np.abs(_line_and_bend(turns, centre, turns + 1.0)[1])
    around = np.pad(np.nan_to_num(0.5 * bend), 2)
    largest: Floats = np.max([around[shift : shift + turns.size] for shift in range(5)], axis=0)
    return largest


def _too_fast(turns: Integers, centre: Complexes, deviation: Floats) -> Mask:
    """Return where the centre moves too far from turn to turn to be followed, (t,), judged by the 21 turns around.

    A whirl of w degrees a turn bends the line through three centres by 2 sin(w/2) times their distance. From 100
    degrees on the cubic does not follow the whirl. The noise of a centre at rest gives such a ratio too, so the centre
    must also move by more than ten times its noise.
    """
    step = np.where(np.diff(turns) == 1, np.diff(centre), np.nan)
    bend = np.abs(np.diff(step, prepend=np.nan, append=np.nan)) ** 2
    moved = 0.5 * (np.abs(np.append(np.nan, step)) ** 2 + np.abs(np.append(step, np.nan)) ** 2)
    known = np.isfinite(bend)
    bends, moves, noise = (_sum_around(np.where(known, of, 0.0)) for of in (bend, moved, np.square(deviation)))
    fast: Mask = (bends > (2.0 * np.sin(np.radians(0.5 * _FASTEST_WHIRL))) ** 2 * moves) & (moves > 100.0 * noise)
    return fast


def _sum_around(values: Floats) -> Floats:
    """Return for each turn the sum over it and ten turns on either side."""
    return np.convolve(values, np.ones(21))[10 : 10 + values.size]  # mode "same" returns 21 values for fewer turns


def _size_deviation(mean_radius: Floats, deviation: Floats) -> Floats:
    """Return the deviation of the centre if the tool whirls nearly as fast as it turns, (t,) metres.

    A whirl of 360 - n degrees a turn shows nearly the same side of the offset all the time. So the mean radius rises
    and falls by the whole offset in 360 / n turns, as in a hole that grows and shrinks along the turns. The samples
    cannot separate the two. So the result is the deviation of the mean radius from a straight line over the 21 turns
    around, less its noise. (A steady growth counts as growth of the hole, so a whirl whose radius rises for longer than
    21 turns is not included.)
    """
    known = np.flatnonzero(np.isfinite(mean_radius))
    if known.size < 3:
        return np.zeros(mean_radius.size)
    rows = np.arange(mean_radius.size)
    size, noise = (np.interp(rows, known, of[known]) for of in (mean_radius, np.square(deviation)))
    wide = min(21, rows.size)
    along = np.linspace(-1.0, 1.0, wide)
    line = np.linalg.qr(np.stack([along**0, along], axis=1))[0]
    around = np.lib.stride_tricks.sliding_window_view(size - size.mean(), wide)
    left = np.square(around).sum(axis=1) - np.square(around @ line).sum(axis=1)
    variance = left / (wide - 2) - np.lib.stride_tricks.sliding_window_view(noise, wide).mean(axis=1)
    nearest = np.clip(rows - wide // 2, 0, rows.size - wide)
    deviations: Floats = np.sqrt(np.maximum(variance, 0.0))[nearest]
    return deviations


def _contradicted(centres: Centres, reach: Complexes, place: Floats, row: Integers) -> Mask:
    """Return where the samples within the turns contradict the centres found, (t,), judged by 21 turns together.

    From turn to turn a whirl of 270 degrees a turn looks like a whirl of -90. But a centre c changes the radius at
    toolface a by -Re(c exp(-i a)) while the tool turns, which is a wave of its own. The radii less one shape of the
    hole are regressed on the wave of the centres found. The coefficient is 1 if the samples show this wave, and about 0
    if they show another wave.
    """
    unit = reach / np.abs(reach)
    wave = -(_moving(centres.turn, centres.x + 1j * centres.y, place, row) * unit.conj()).real
    lost = np.zeros(centres.turn.size, dtype=bool)
    edges = np.linspace(0, lost.size, max(1, round(lost.size / 21)) + 1).astype(np.int64)
    for first, last in pairwise(edges):
        mine = np.arange(*np.searchsorted(row, (first, last)))
        mine = mine[np.isfinite(wave[mine])]
        along = np.linspace(-1.0, 1.0, mine.size)
        series = powers(unit[mine], _SHAPE_HARMONICS)[2:]
        shape = np.concatenate([[along**0, along, along**2], series.real, series.imag]).T
        if mine.size < 4 * shape.shape[1]:
            continue
        basis = np.linalg.qr(shape)[0]
        values = np.stack([wave[mine], np.abs(reach[mine])], axis=1)
        own, radius = (values - basis @ (basis.T @ values)).T
        noise = np.sqrt(np.nanmean(np.square(centres.noise[first:last])))
        lost[first:last] = own @ radius + 3.0 * noise * np.sqrt(own @ own) < _SHOWN * (own @ own)
    return lost


def _line_and_bend(turns: Integers, centre: Complexes, place: Reals) -> tuple[Complexes, Complexes]:
    """Return the centre at each place on the line through the turns before and after, and what the cubic adds.

    Both are NaN where a turn that they need is missing.
    """
    middle = np.floor(place - 0.5).astype(np.int64)
    part = place - 0.5 - middle
    around = []
    for step in (-1, 0, 1, 2):
        at = np.minimum(np.searchsorted(turns, middle + step), turns.size - 1)
        around.append(np.where(turns[at] == middle + step, centre[at], np.nan))
    before, left, right, after = around
    bends = (2.0 - part) * (2.0 * left - before - right) + (1.0 + part) * (2.0 * right - left - after)
    line: Complexes = left + part * (right - left)
    bend: Complexes = part * (1.0 - part) / 6.0 * bends
    return line, bend


def recentre(
    toolface: npt.ArrayLike,
    radius: npt.ArrayLike,
    turn: npt.ArrayLike,
    centres: Centres,
    significance: float = 3.0,
    position: npt.ArrayLike | None = None,
) -> tuple[Floats, Floats]:
    """Return toolface, in [0, 360), and radius of every sample as seen from the hole's axis, (n,), new.

    ``toolface``, ``radius``, ``turn`` and ``position`` are as given to :func:`find_centres`, ``centres`` is its result,
    and ``significance`` is as in :meth:`Centres.share`. If a turn has no significant centre, its samples keep radius
    and toolface; NaN radii stay NaN and keep their toolface. Raises InputError if ``centres`` lacks a turn.
    """
    angle, distance, number = _samples(toolface, radius, turn)
    row = np.minimum(np.searchsorted(centres.turn, number), max(centres.turn.size - 1, 0))
    if number.size and (centres.turn.size == 0 or np.any(centres.turn[row] != number)):
        missing = int(np.argmax(centres.turn[row] != number)) if centres.turn.size else 0
        raise InputError(f"turn[{missing}]", "not among the turns of centres", str(number[missing]))
    share = centres.share(significance)
    known = share > 0
    offset = np.where(known, share, 0.0) * (np.nan_to_num(centres.x) + 1j * np.nan_to_num(centres.y))
    away = offset[row]
    if position is not None and number.size:
        place = finite_column("position", position, angle.size, "toolface")
        away = np.where(known[row], _moving(centres.turn, np.where(known, offset, np.nan), place, row), away)
    seen = np.radians(angle)
    wall = away + distance * (np.cos(seen) + 1j * np.sin(seen))
    moved = np.isfinite(distance) & (away != 0)
    turned = np.where(moved, np.degrees(np.angle(wall)), angle)
    return wrapped(turned), np.where(moved, np.abs(wall), distance)


def _samples(toolface: npt.ArrayLike, radius: npt.ArrayLike, turn: npt.ArrayLike) -> tuple[Floats, Floats, Integers]:
    angle = finite_column("toolface", toolface)
    distance = column("radius", radius, angle.size, "toolface")
    valid = np.isnan(distance) | ((distance > 0) & (distance < np.inf))
    require("radius", distance, valid, "must be finite and above 0, or NaN where missing")
    return angle, distance, whole_column("turn", turn, angle.size, "toolface")
