"""Least squares on Fourier series around the hole, for many turns at once: moments instead of design matrices.

A series of order H has P = 2 H + 1 terms, x = (1, cos a, sin a, ..., cos H a, sin H a). With z = exp(i a) every product
of two terms is a sum of powers of z, as in cos j a cos k a = (cos (j - k) a + cos (j + k) a) / 2, so the P x P normal
matrix sum(w x x') of a turn holds nothing but the 2 H + 1 moments sum(w z^m): 25 sums a sample where the matrix itself
would take 625. The leverage x' B x of a sample is, likewise, a Fourier series of order 2 H in its angle.

Samples lie turn by turn; ``starts`` holds the first sample of each turn and ``turn`` the row of each sample.
Not here: what the series stand for (``eccentering``).
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from helibore.base.arrays import Floats, Integers

Complexes = npt.NDArray[np.complex128]


def powers(z: Complexes, order: int) -> Complexes:
    """z^0 ... z^order, (order + 1, n)."""
    table = np.empty((order + 1, z.size), dtype=np.complex128)
    table[0] = 1.0
    for k in range(1, order + 1):
        np.multiply(table[k - 1], z, out=table[k])
    return table


def normal_equations(weight: Floats, value: Floats, table: Complexes, starts: Integers) -> tuple[Floats, Floats]:
    """sum(w x x'), (t, P, P), and sum(w x v), (t, P), of every turn, from ``powers(z, 2 H)``."""
    order = (len(table) - 1) // 2
    moments = np.add.reduceat(weight * table, starts, axis=1)
    terms = 2 * order + 1
    matrix = np.empty((starts.size, terms, terms))
    matrix[:, 0, 0] = moments[0].real
    for j in range(1, order + 1):
        cos_j, sin_j = 2 * j - 1, 2 * j
        matrix[:, 0, cos_j] = matrix[:, cos_j, 0] = moments[j].real
        matrix[:, 0, sin_j] = matrix[:, sin_j, 0] = moments[j].imag
        for k in range(1, j + 1):
            cos_k, sin_k = 2 * k - 1, 2 * k
            total, difference = 0.5 * moments[j + k], 0.5 * moments[j - k]
            matrix[:, cos_j, cos_k] = matrix[:, cos_k, cos_j] = difference.real + total.real
            matrix[:, sin_j, sin_k] = matrix[:, sin_k, sin_j] = difference.real - total.real
            matrix[:, sin_j, cos_k] = matrix[:, cos_k, sin_j] = total.imag + difference.imag
            matrix[:, cos_j, sin_k] = matrix[:, sin_k, cos_j] = total.imag - difference.imag
    return matrix, projections(weight * value, table[: order + 1], starts)


def projections(value: Floats, table: Complexes, starts: Integers) -> Floats:
    """sum(x v), (t, 2 H + 1), of every turn, from ``powers(z, H)``."""
    sums = np.add.reduceat(value * table, starts, axis=1)
    side = np.empty((starts.size, 2 * len(table) - 1))
    side[:, 0] = sums[0].real
    side[:, 1::2], side[:, 2::2] = sums[1:].real.T, sums[1:].imag.T
    return side


def evaluate(terms: Floats, table: Complexes, turn: Integers) -> Floats:
    """x' terms at every sample, (n,), of one series a turn, (t, P)."""
    values: Floats = terms[turn, 0]
    coefficients = terms[:, 1::2] - 1j * terms[:, 2::2]
    for k in range(coefficients.shape[1]):
        values += (coefficients[turn, k] * table[k + 1]).real
    return values


def leverage(matrix: Floats, table: Complexes, turn: Integers) -> Floats:
    """x' B x at every sample, (n,), of one symmetric matrix B a turn, (t, P, P).

    With v = (z^-H ... z^H) and x = U v it is v' (U' B U) v, and the terms of one power of z lie on one antidiagonal.
    """
    order = (matrix.shape[1] - 1) // 2
    change = np.zeros((2 * order + 1, 2 * order + 1), dtype=np.complex128)
    change[0, order] = 1.0
    for k in range(1, order + 1):
        change[2 * k - 1, [order + k, order - k]] = 0.5
        change[2 * k, [order + k, order - k]] = -0.5j, 0.5j
    mirrored = np.flip(change.T @ matrix @ change, axis=2)
    series = np.empty((len(matrix), 4 * order + 1))
    series[:, 0] = np.trace(mirrored, offset=0, axis1=1, axis2=2).real
    for m in range(1, 2 * order + 1):
        coefficient = 2.0 * np.trace(mirrored, offset=-m, axis1=1, axis2=2)
        series[:, 2 * m - 1], series[:, 2 * m] = coefficient.real, -coefficient.imag
    return evaluate(series, table, turn)
