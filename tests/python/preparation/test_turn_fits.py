"""Lobes with upright edges: sectors against trying each one by dense least squares, fits against design matrices."""

from __future__ import annotations

import numpy as np
import pytest

from helibore.preparation.eccentering import find_centres
from helibore.preparation.turn_fits import Shape, TurnFits, best_sectors, cell_sums, fit_steps


def turns(opposite, seed=0, count=(48, 33), depth=0.015):
    """A centred tool in an oval hole with steps of 66 degrees; the first sector of each turn."""
    rng = np.random.default_rng(seed)
    row = np.repeat(np.arange(len(count)), count)
    phi = 360 * rng.random(row.size)
    first = 360 * rng.random(len(count))
    off = (phi - first[row]) % (180 if opposite else 360)
    radius = 0.108 + 0.002 * np.cos(2 * np.radians(phi)) + depth * (off < 66) + rng.normal(0, 5e-4, row.size)
    return phi, radius, np.asarray(count), off < 66


def smooth(phi, radius, count):
    fits = TurnFits(radius * np.exp(1j * np.radians(phi)), count, Shape())
    fits.solve()
    return fits


@pytest.mark.parametrize("opposite", [True, False])
def test_the_sector_is_found(opposite):
    phi, radius, count, inside = turns(opposite)
    fits, added = fit_steps(smooth(phi, radius, count), opposite)
    np.testing.assert_array_equal(fits.steps[0], inside)
    depth = fits.terms[:, fits.waves]
    np.testing.assert_allclose(depth, 0.015, atol=1e-3)
    np.testing.assert_allclose(added, depth * (2 if opposite else 1) * 66 / 360, atol=8e-4)
    if opposite:
        np.testing.assert_array_equal(np.abs(fits.steps[1]), inside)
        np.testing.assert_allclose(fits.terms[:, -1], 0.0, atol=2e-3)


def test_gain_of_every_sector_against_dense_least_squares():
    phi, radius, count, _ = turns(False, seed=3, count=(40,))
    fits = smooth(phi, radius, count)
    where = np.angle(fits.centre[fits.turn] + fits.reach)
    cells, harmonics, noise = 36, 4, Shape().noise
    cell = np.minimum((where % (2 * np.pi) / (2 * np.pi) * cells).astype(int), cells - 1)
    least = (noise / 0.03) ** 2
    first, width, widest = best_sectors(cell_sums(fits, where, cell, cells), range(3, 12), least)
    waves = [np.ones_like(where)] + [f(k * where) for k in range(1, harmonics + 1) for f in (np.cos, np.sin)]
    shape = Shape()
    deviations = np.concatenate([[10.0, 0.02, 0.02], np.repeat(shape.plain().deviations(harmonics), 2)])
    distance = np.abs(fits.centre[fits.turn] + fits.reach)

    def loss(columns, ridge):
        design = np.concatenate([np.array(columns).T, np.diag(ridge)])
        side = np.concatenate([distance, np.zeros(len(ridge))])
        return np.linalg.lstsq(design, side, rcond=None)[1][0]

    ridge = noise / deviations
    losses = {}
    for wide in range(3, 12):
        for at in range(cells):
            sector = ((cell - at) % cells < wide).astype(float)
            losses[at, wide] = loss([*waves, sector], [*ridge, np.sqrt(least)])
    assert widest[0] >= width[0]
    assert losses[first[0], width[0]] <= min(losses.values()) * (1 + 1e-9)
    assert min(losses.values()) < 0.2 * loss(waves, ridge)


def test_leverage_and_normal_equations_with_steps():
    phi, radius, count, _ = turns(True, seed=5)
    fits, _ = fit_steps(smooth(phi, radius, count), opposite=True)
    angle = np.angle(fits.centre[fits.turn] + fits.reach)
    waves = [np.ones_like(angle)]
    waves += [f(k * angle) for k in range(1, fits.shape.harmonics + 1) for f in (np.cos, np.sin)]
    design = np.concatenate([np.array(waves), fits.steps]).T
    fits.look()
    matrix, side = fits.normal_equations()
    hat = fits.leverage()
    for t in range(count.size):
        x, w = design[fits.turn == t], fits.weight[fits.turn == t]
        np.testing.assert_allclose(matrix[t], (x.T * w) @ x, atol=1e-4)
        np.testing.assert_allclose(side[t], (x.T * w) @ fits.distance[fits.turn == t], atol=1e-4)
        slow = np.einsum("np,pq,nq->n", x, fits.inverse[t], x)
        np.testing.assert_allclose(hat[fits.turn == t], slow, atol=1e-4)


def test_turned_samples_give_turned_lobes_and_the_same_centre():
    phi, radius, count, _ = turns(True, seed=7)
    row = np.repeat(np.arange(count.size), count)
    plain, turned = (find_centres(phi + angle, radius, row) for angle in (0.0, 77.7))
    spin = np.exp(1j * np.radians(77.7))
    np.testing.assert_allclose(turned.x + 1j * turned.y, (plain.x + 1j * plain.y) * spin, atol=5e-6)


def test_lobes_that_are_not_there_change_next_to_nothing():
    phi, radius, count, _ = turns(True, seed=9, depth=0.0)
    fits = smooth(phi, radius, count)
    row = np.repeat(np.arange(count.size), count)
    np.testing.assert_allclose(find_centres(phi, radius, row).x, fits.centre.real, atol=2e-5)


def test_mean_radius_takes_in_the_lobes():
    phi, radius, count, _ = turns(True, seed=11)
    row = np.repeat(np.arange(count.size), count)
    found = find_centres(phi, radius, row)
    np.testing.assert_allclose(found.mean_radius, 0.108 + 0.015 * 132 / 360, atol=8e-4)


def test_two_harmonics_are_enough():
    phi, radius, count, _ = turns(opposite=False)
    found = find_centres(phi, radius, np.repeat([0, 1], count), Shape(harmonics=2))
    assert (found.eccentering < 4 * np.hypot(found.sigma_x, found.sigma_y)).all()
