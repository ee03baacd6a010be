"""What passes: closed forms in holes of known shape, a slow reference that searches freely, and what is unknown."""

from __future__ import annotations

import itertools
import math
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from golden_texts import Golden

import helibore as hb
from helibore.base.arrays import Floats
from helibore.base.errors import InputError
from helibore.logs.passage import MANDRELS, SURER, Drift, RigidBody, drift_of, hanging_at, passage_of, without_noise
from helibore.settings.wall_settings import Settings

D = 0.2159
Place = tuple[Floats, Floats]


def hole(
    radius: Any, turns: int, pitch: float = 0.1, sectors: int = 64, start: float = 100.0, **more: Any
) -> SimpleNamespace:
    """Return a wall; ``radius`` is a number, or a function of depth below the start, and toolface in degrees."""
    k = np.arange(turns * sectors)
    along, toolface = k * pitch / sectors, (k * 360 / sectors) % 360
    around = radius(along, toolface) if callable(radius) else np.full(k.size, radius)
    return SimpleNamespace(
        settings=Settings(bit_diameter=D, pitch=pitch, sectors=sectors), start_depth=start, radius=around, **more
    )


def circle(x: Any, y: Any, toolface: Floats) -> Floats:
    """Return the radii of a circle of diameter D whose centre lies at x, y from the axis, metres."""
    ray, centre = np.exp(1j * np.radians(toolface)), x + 1j * y
    along, aside = (ray.conj() * centre).real, (ray.conj() * centre).imag
    radius: Floats = along + np.sqrt((D / 2) ** 2 - aside**2)
    return radius


def known(found: Drift) -> Floats:
    return found.diameter[found.known]


def test_a_straight_round_hole_passes_its_diameter() -> None:
    for length in (0.05, 0.3, 3.0):
        found = drift_of(hole(D / 2, 40), length)
        assert known(found) == pytest.approx(D, abs=1e-9)
        top, bottom = 100 + 0.1 * 63 / 64, 100 + 3.9  # where the hole is closed all around
        within = (found.depth - length / 2 >= top) & (found.depth + length / 2 <= bottom)
        np.testing.assert_array_equal(found.known, within)


def test_an_ellipse_passes_its_short_axis() -> None:
    def ellipse(_: Floats, toolface: Floats) -> Floats:
        angle = np.radians(toolface)
        radius: Floats = 1 / np.hypot(np.cos(angle) / 0.13, np.sin(angle) / 0.1)
        return radius

    assert known(drift_of(hole(ellipse, 30), 1.0)) == pytest.approx(0.2, abs=1e-6)


def test_a_slot_in_a_round_hole_passes_the_bit_only() -> None:
    found = drift_of(hole(lambda _, toolface: np.where(abs(toolface - 90) < 30, 0.13, D / 2), 30), 1.0)
    assert known(found) == pytest.approx(D, abs=2e-5)


def test_a_ledge_costs_its_height_and_holds_the_body_at_the_ledge() -> None:
    step = 0.006
    wall = hole(
        lambda along, toolface: circle(np.where(along > 2.1, step, 0.0), 0.0, toolface), 430, pitch=0.01, sectors=16
    )
    found = drift_of(wall, 4.0)
    assert found.least == pytest.approx(D - step, abs=2e-5)
    assert found.at_least is not None
    touches = found.contact_depth[found.at_least]
    assert np.nanmin(abs(touches - 102.1)) < 0.03


@pytest.mark.parametrize(("offset", "period", "length"), [(0.006, 0.8, 2.0), (0.01, 1.1, 1.7)])
def test_a_spiral_costs_a_body_of_a_period_twice_its_offset(offset: float, period: float, length: float) -> None:
    def spiral(along: Floats, toolface: Floats) -> Floats:
        phase = 2 * np.pi * along / period
        return circle(offset * np.cos(phase), offset * np.sin(phase), toolface)

    assert known(drift_of(hole(spiral, 160, pitch=0.02), length)) == pytest.approx(D - 2 * offset, abs=2e-5)


def test_a_body_much_shorter_than_the_spiral_loses_the_height_of_its_arc() -> None:
    offset, period, length = 0.006, 9.0, 0.5

    def spiral(along: Floats, toolface: Floats) -> Floats:
        phase = 2 * np.pi * along / period
        return circle(offset * np.cos(phase), offset * np.sin(phase), toolface)

    loss = offset * (2 * np.pi / period) ** 2 * length**2 / 8
    assert known(drift_of(hole(spiral, 100, pitch=0.02), length)) == pytest.approx(D - loss, abs=2e-5)


@pytest.mark.parametrize(("build", "length"), [(3.0, 9.0), (15.0, 3.0), (15.0, 9.0)])
def test_a_curved_hole_costs_the_height_of_its_arc(build: float, length: float) -> None:
    """The body touches the inside of the bend at its middle, and the outside with its ends: Pythagoras."""
    path = hb.Survey([90, 120], [20, 20 + build], [40, 40]).path()
    bend = 30 / math.radians(build)
    found = drift_of(hole(D / 2, 100, path=path, sectors=256), length)
    assert known(found) == pytest.approx(math.sqrt((bend + D / 2) ** 2 - length**2 / 4) - (bend - D / 2), abs=2e-5)
    assert found.curvature[found.known] == pytest.approx(length**2 / 8 / bend, rel=1e-9)


def test_a_bend_so_sharp_that_nothing_passes_is_zero() -> None:
    path = hb.Survey([90, 120], [20, 50], [40, 40]).path()
    assert known(drift_of(hole(D / 2, 130, path=path), 12.0)) == pytest.approx(0.0)


def reference(wall: SimpleNamespace, bodies: list[tuple[float, float, float]], depth: float) -> float:
    """Return the clearance in a straight hole, by quadratic programmes with all distances as they are."""
    from scipy.optimize import minimize

    K, pitch = wall.settings.sectors, wall.settings.pitch
    k = np.arange(wall.radius.size)
    points = wall.radius * np.exp(2j * np.pi * k / K)
    z = wall.start_depth + k * pitch / K - depth
    x, tau, half = [], [], max(max(abs(top), abs(bottom)) for top, bottom, _ in bodies)
    for top, bottom, diameter in bodies:
        inside = (z >= top) & (z <= bottom)
        x.append(np.column_stack([points[inside].real, points[inside].imag, np.full(inside.sum(), diameter / 2)]))
        tau.append(z[inside] / half)
        for end, j in itertools.product((top, bottom), range(K)):
            at = np.interp(end, z[j::K], np.arange(z[j::K].size))
            low, share = int(at), at - int(at)
            pair = points[j::K][[low, min(low + 1, z[j::K].size - 1)]]
            point = (1 - share) * pair[0] + share * pair[1]
            x.append(np.array([[point.real, point.imag, diameter / 2]]))
            tau.append(np.array([end / half]))
    rows, along = np.concatenate(x), np.concatenate(tau)

    def room(axis: Floats) -> Floats:
        away: Floats = np.hypot(rows[:, 0] - axis[0] - along * axis[2], rows[:, 1] - axis[1] - along * axis[3])
        return away - rows[:, 2] - axis[4]

    inside = [(-0.03, 0.03)] * 4 + [(-0.2, 0.2)]
    found = minimize(
        lambda axis: -axis[4], np.zeros(5), bounds=inside, constraints={"type": "ineq", "fun": room}, method="SLSQP",
        options={"ftol": 1e-10, "maxiter": 300},
    )  # fmt: skip
    return 2 * float(found.x[4] + room(found.x).min())


@pytest.mark.parametrize(("seed", "length", "upwards"), [(1, 0.25, False), (2, 0.7, False), (3, 0.25, True)])
def test_the_clearance_is_that_of_a_free_search(seed: int, length: float, upwards: bool) -> None:
    rng = np.random.default_rng(seed)
    turns, sectors = 14, 12
    rough = np.convolve(rng.normal(0, 0.004, turns * sectors), [0.25, 0.5, 0.25], "same")
    wall = hole(D / 2, turns, sectors=sectors, pitch=-0.1 if upwards else 0.1)
    wall.radius = wall.radius + rough
    string = [RigidBody(0.2, length), RigidBody(0.17, 0.2, length + 0.1)]
    found, half = passage_of(wall, string), (length + 0.3) / 2
    bodies = [(half - body.position - body.length, half - body.position, body.diameter) for body in string]
    row = turns // 2
    if upwards:  # the reference knows helices that grow downwards: turn the hole over
        wall = hole(D / 2, turns, sectors=sectors)
        wall.radius = wall.radius + rough
        bodies = [(-bottom, -top, diameter) for top, bottom, diameter in bodies]
    depth = wall.start_depth + (row * sectors + (sectors - 1) / 2) * 0.1 / sectors
    assert found.clearance[row] == pytest.approx(reference(wall, bodies, depth), abs=2e-5)


def test_a_thin_body_leaves_the_clearance_to_the_thick_one() -> None:
    step = 0.004
    wall = hole(lambda along, toolface: circle(np.where(along > 2.0, step, 0.0), 0.0, toolface), 60)
    bit, collar = RigidBody(0.21, 0.3), RigidBody(0.1, 2.0, 0.3)
    found = passage_of(wall, [bit, collar])
    assert found.length == pytest.approx(2.3)
    assert found.least == pytest.approx(D - 0.21, abs=1e-3), "a short bit follows the step"
    assert set(found.contact_body[found.known][:, 0]) == {0}
    long = passage_of(wall, [RigidBody(0.2135, 2.3)])
    (spot,) = long.tight()
    assert (spot.start, spot.stop) == pytest.approx((101.2 - 0.4, 103.1), abs=0.6)
    assert spot.least < 0 < D - 0.2135
    assert spot.body == 0
    assert long.tight(-1.0) == []


def test_it_is_unknown_where_a_vertex_beside_the_body_is_not_measured_or_missing() -> None:
    wall = hole(D / 2, 100)
    measured = np.ones(wall.radius.size, bool)
    measured[40 * 64 + 5] = False
    wall.measured = measured
    wall.radius[70 * 64] = np.nan
    unknown = np.flatnonzero(~drift_of(wall, 1.0).known)
    inside = unknown[(unknown > 6) & (unknown < 93)]
    assert set(range(36, 45)) | set(range(66, 75)) <= set(inside)
    assert set(inside) <= set(range(34, 47)) | set(range(64, 77))


def test_each_turn_depends_on_the_hole_beside_the_body_only() -> None:
    rng = np.random.default_rng(3)
    whole = hole(D / 2, 60)
    whole.radius = whole.radius + rng.normal(0, 1e-3, whole.radius.size)
    sigma = np.full(whole.radius.size, 3e-4)
    first, K = 16, 64
    part = SimpleNamespace(
        settings=SimpleNamespace(sectors=K, pitch=0.1, start_toolface=0.0, first_vertex=first * K, start_depth=100.0),
        start_depth=100.0 + first * 0.1, radius=whole.radius[first * K :],
    )  # fmt: skip
    for threads in (1, 2):
        found = drift_of(SimpleNamespace(**vars(whole), threads=threads), 1.6, sigma)
        of_part = drift_of(part, 1.6, sigma[first * K :])
        inside = slice(first + 10, 48)
        for name in ("depth", "clearance", "low", "high", "contact_depth", "contact_toolface"):
            at_part = getattr(of_part, name)[inside.start - first : inside.stop - first]
            np.testing.assert_array_equal(getattr(found, name)[inside], at_part)
    assert (found.low < found.high)[found.known].all()


def test_the_names_of_mandrels_are_their_lengths() -> None:
    wall = hole(D / 2, 40)
    for name, length in MANDRELS.items():
        np.testing.assert_array_equal(drift_of(wall, name).diameter, drift_of(wall, length).diameter)


@pytest.mark.parametrize(
    ("length", "place"),
    [
        ("api-rod", "length"),
        (0.0, "length"),
        (math.nan, "length"),
        (4.1, "length of the string"),
    ],
)
def test_refused_lengths(length: float | str, place: str, golden: Golden) -> None:
    with golden.raises(place):
        drift_of(hole(D / 2, 40), length)


def test_refused_strings(golden: Golden) -> None:
    wall = hole(D / 2, 40)
    for string, message in (
        ([], "string: must have a body"),
        ([RigidBody(0.1, 1), 0.2], "string[1] = float: must be a RigidBody"),
    ):
        with pytest.raises(InputError) as error:
            passage_of(wall, string)  # type: ignore[arg-type]
        assert str(error.value).startswith(message)
    with golden.raises():
        RigidBody(-0.1, 1)
    with pytest.raises(InputError) as error:
        drift_of(hole(D / 2, 40, basis="gauge"), 1.0)
    assert str(error.value).startswith("passage: needs a shape that was measured")
    vertical = hb.Survey([0, 200], [0, 0], [0, 0]).path()
    with pytest.raises(InputError, match="high side"):
        drift_of(hole(D / 2, 40, path=vertical), 1.0)


def test_a_wall_gives_drift_with_its_interval_table_and_column() -> None:
    rng = np.random.default_rng(5)
    k = np.arange(64 * 50)
    depth, toolface = k * 0.1 / 64, rng.uniform(0, 360, k.size)
    radius = D / 2 + 0.004 * (np.abs(depth - 3) < 0.5) + rng.normal(0, 3e-4, k.size)
    wall = hb.reconstruct(hb.Caliper(depth, toolface, radius), bit_diameter=D)
    found = wall.drift(0.305, sigma=True)
    kept = np.isfinite(found.low)
    assert kept.sum() > 30
    assert (found.high[kept] - found.low[kept] < 0.004).all()
    table = found.table()
    assert table["DRIFT_0_305M"].values.size == len(wall.logs())
    assert "rigid" in table.facts["passage"]
    steps = wall.logs().by_step(0.5)
    of_steps = found.column(steps).values
    assert of_steps.size == len(steps)
    inside = (found.depth >= steps.depth[4] - 0.25) & (found.depth < steps.depth[4] + 0.25)
    assert of_steps[4] == found.diameter[inside].min()
    assert steps.table([found.column(steps)])["DRIFT_0_305M"].unit == "m"
    clear = wall.passage([RigidBody(0.2, 0.3)], sigma=True)
    assert clear.table()["CLEARANCE"].values == pytest.approx(replace(clear).clearance, nan_ok=True)
    assert "LOW" not in [of.mnemonic for of in wall.drift(0.305).table()]


def test_the_edge_of_a_washout_does_not_make_the_clearance_beside_it_unsure():
    """At the edge a radius may be that of either side; it is not narrower than the gauge hole, which is known well."""
    depth = np.arange(2000.0, 2012.0, 1 / 400)
    draw = np.random.default_rng(3)
    radius = np.where(abs(depth - 2006) < 1, 0.134, 0.1085) + draw.normal(0, 0.0003, depth.size)
    wall = hb.reconstruct(hb.Caliper(depth, np.arange(depth.size) * 47.3 % 360, radius), bit_diameter=0.216)
    found = wall.passage([hb.RigidBody(0.2145, 1.0)], sigma=True)
    wide = found.high - found.low
    beside = (abs(abs(found.depth - 2006) - 1.3) < 0.5) & (found.clearance < 0.01)
    away = abs(found.depth - 2006) > 3
    assert wide[away & found.known].mean() < 0.003
    assert wide[beside].max() < 0.007
    assert (found.low[away & found.known] < 0.0025).all()


@pytest.mark.parametrize("seed", range(4))
def test_what_passes_at_most_has_the_uncertainty_of_the_radii_that_hold_it(seed):
    """A third of the turn is not sampled. The other radii have an error of 1 mm, alike over a turn and two sectors."""
    draw, body = np.random.default_rng(seed), RigidBody(0.2127, 1.0)
    K, turns = 64, 40
    error = draw.normal(0, 1, (turns + 2, K))
    error = error[:-2] + 2 * error[1:-1] + error[2:]
    error = sum(share * np.roll(error, by, axis=1) for by, share in zip(range(-2, 3), (1, 2, 3, 2, 1), strict=True))
    wall, sigma = hole(D / 2, turns), np.full(K * turns, 1e-3)
    wall.radius = without_noise(wall.radius + 1e-3 * (error / error.std()).ravel(), sigma, K)
    sampled = np.tile(np.arange(K) < 44, turns)
    found = hanging_at(wall, [body], 103.0, sampled, SURER * sigma)
    assert found is not None
    assert found.at_most
    assert found.low < D - body.diameter < found.high
    assert found.high > found.clearance + 0.0005
    assert found.at_sigma(1.96) == pytest.approx(found.high, abs=1e-6)
    whole = hanging_at(wall, [body], 103.0, sampled | True, SURER * sigma)
    assert whole is not None
    assert not whole.at_most


def test_a_hanging_body_clears_what_it_does_in_the_passage_of_the_whole_wall():
    """Each turn is solved alone: the one where the body hangs, and no other."""
    draw = np.random.default_rng(5)
    wall, sigma = hole(D / 2, 60), np.full(60 * 64, 3e-4)
    wall.radius = wall.radius + draw.normal(0, 3e-4, wall.radius.size)
    for length in (0.3, 1.2, 3.0):
        body = RigidBody(0.2127, length)
        found = passage_of(wall, [body], sigma)
        row = 30
        hung = hanging_at(wall, [body], float(found.depth[row]) + length / 2, None, sigma)
        assert hung is not None
        assert hung.clearance == found.clearance[row]
        assert hung.depth == found.contact_depth[row, 0]


def test_four_arms_that_do_not_turn_bound_what_passes() -> None:
    """The gaps of 90 degrees are not sampled; the four places that the arms touch hold a body in a ring."""
    depth = np.repeat(np.arange(100.0, 110.0, 0.05), 4)
    radius = np.where(abs(depth - 105.0) < 0.75, 0.1025, 0.1085)
    arms = hb.Caliper(depth, np.tile([20.0, 110.0, 200.0, 290.0], depth.size // 4), radius)
    wall = hb.reconstruct(arms, bit_diameter=D, start_depth=100.0)
    body = RigidBody(0.2127, 1.0)
    assert not wall.sampled.any()
    assert not passage_of(wall, [body]).known.any()
    bound = passage_of(wall, [body], upper_limit=True)
    assert body.diameter + np.nanmin(bound.clearance) == pytest.approx(0.205, abs=5e-4)
    ring = hanging_at(wall, [body], 105.3, wall.sampled)
    beside = hanging_at(wall, [body], 103.0, wall.sampled)
    assert ring is not None
    assert beside is not None
    assert ring.at_most
    assert ring.clearance == pytest.approx(0.205 - 0.2127, abs=5e-4)
    assert beside.clearance == pytest.approx(0.217 - 0.2127, abs=5e-4)
