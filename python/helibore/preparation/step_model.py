"""Lobes with upright edges: the sectors in which a wall steps outwards, found by trying all of them.

No series of a few harmonics follows a step, and what it misses moves the centre. A wall that is smooth but for one step
out and one step back, D (phi in [from, to)), or two opposite ones, is linear in everything but the two edges::

      D .-----.                   .-----.          e       residuals of the smooth fit
        |     |                   |     |          b       1 in the sector, 0 outside; weights W
    ----'     '-------------------'     '----      gain    (b' W e)^2 / (b' W b - b' W X (X' W X + ridge)^-1 X' W b)
      from    to                from+180

The gain of a sector is what the weighted squares of the residuals lose when D is fitted with all else. With sums over
cells of three degrees, added up around the hole, it takes as many steps as the fit has terms: all sectors are tried.
The cells are laid by the second harmonic of the turn, so that turned samples give turned sectors.

Not here: how deep the lobes are and whether there are any (``turn_fits``, ``turn_models``).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from helibore.base.arrays import Floats, Integers
from helibore.preparation.harmonics import evaluate, normal_equations, powers, projections
from helibore.preparation.turn_fits import LOBE_DEPTHS, TurnFits

_CELLS = 240  # around the hole
_PAIR = range(10, 61, 2)  # cells that each of two opposite lobes may take
_SINGLE = range(20, 141, 4)
_HARMONICS = 4
_SAME = 1e-9  # gains that differ by less are those of the same samples


@dataclass(frozen=True)
class Lobed:
    """Turns fitted with lobes.

    Attributes
    ----------
    fits
        The fits: oval and nearly smooth but for the lobes.
    added
        What the lobes add to the mean radius, (t,) m.
    """

    fits: TurnFits
    added: Floats


def lobed(smooth: TurnFits, opposite: bool) -> Lobed:
    """Fit the turns with the best sector of each, and if ``opposite`` with the one across the hole too.

    Opposite lobes have one depth, but for a little that is found as well.
    """
    cells = _CELLS // 2 if opposite else _CELLS
    widths = _PAIR if opposite else _SINGLE
    where = np.angle(smooth.centre[smooth.turn] + smooth.reach)
    laid = 0.5 * np.arctan2(smooth.terms[:, 4], smooth.terms[:, 3])
    around = (where - laid[smooth.turn]) / (2.0 * np.pi) * _CELLS % _CELLS
    cell = np.minimum(around.astype(np.int64), _CELLS - 1)
    least = float(np.square(smooth.shape.noise / LOBE_DEPTHS[0]))
    first, width, widest = _best(_sums(smooth, where, cell % cells, cells), widths, least)
    off = (cell - first[smooth.turn]) % _CELLS
    inside = off % cells < width[smooth.turn]
    columns = [inside.astype(np.float64)]
    if opposite:
        columns.append(np.where(inside, np.where(off >= cells, -1.0, 1.0), 0.0))
    fits = smooth.plain(np.stack(columns))
    return Lobed(fits, fits.terms[:, fits.waves] * 0.5 * (width + widest) / cells)


def _sums(fits: TurnFits, where: Floats, cell: Integers, cells: int) -> Floats:
    """Sums over each cell, (t, cells, P + 2): whitened terms, residuals and weights.

    Whitened by the Cholesky factor of the normal matrix, so that the squares of their sum are what the other terms take
    from b' W b.
    """
    shape, turns = fits.shape.plain(), fits.count.size
    table = powers(np.exp(1j * where), 2 * _HARMONICS)
    distance = np.abs(fits.centre[fits.turn] + fits.reach)
    weights = np.ones(distance.size)
    matrix, side = normal_equations(weights, distance, table, fits.starts)
    deviations = np.concatenate([[10.0, shape.reach, shape.reach], np.repeat(shape.deviations(_HARMONICS), 2)])
    terms = np.arange(deviations.size)
    matrix[:, terms, terms] += np.square(shape.noise / deviations)
    whiten = np.linalg.inv(np.linalg.cholesky(matrix))
    fitted = (np.swapaxes(whiten, 1, 2) @ (whiten @ side[:, :, None]))[:, :, 0]
    at = fits.turn * cells + cell
    residual = distance - evaluate(fitted, table, fits.turn)
    order = np.argsort(at, kind="stable")
    filled, starts = np.unique(at[order], return_index=True)
    sums = np.zeros((turns * cells, deviations.size + 2))
    weight = weights[order]
    sums[filled, :-2] = projections(weight, table[: _HARMONICS + 1, order], starts)
    sums[filled, -2] = np.add.reduceat(weight * residual[order], starts)
    sums[filled, -1] = np.add.reduceat(weight, starts)
    table_of_sums = sums.reshape(turns, cells, -1)
    table_of_sums[:, :, :-2] = table_of_sums[:, :, :-2] @ np.swapaxes(whiten, 1, 2)
    return table_of_sums


def _best(sums: Floats, widths: range, least: float) -> tuple[Integers, Integers, Integers]:
    """First cell and width of the narrowest sector with the greatest gain, and the width of the widest, each (t,)."""
    turns, cells, _ = sums.shape
    around = np.concatenate([np.zeros((turns, 1, sums.shape[2])), sums, sums[:, : widths.stop]], axis=1)
    running = np.cumsum(around, axis=1)
    gain: Floats = np.zeros(turns)
    first, width, widest = np.zeros((3, turns), dtype=np.int64)
    for wide in widths:
        sector = running[:, wide : wide + cells] - running[:, :cells]
        left = sector[:, :, -1] - np.square(sector[:, :, :-2]).sum(axis=2)
        gains = np.square(np.maximum(sector[:, :, -2], 0.0)) / (np.maximum(left, 0.0) + least)
        at = np.argmax(gains, axis=1)
        top = gains[np.arange(turns), at]
        better = top > gain * (1.0 + _SAME)
        gain[better] = top[better]
        first[better], width[better] = at[better], wide
        widest[top >= gain * (1.0 - _SAME)] = wide
    return first, width, widest
