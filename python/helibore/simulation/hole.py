"""A known hole: formulas give its wall, its gamma and its path at any point.

The wall has the shapes of real holes::

    r = bit/2 + overgauge + ovality cos 2(toolface - t0) + washouts + breakouts + roughness

In a spiral hole, r is the distance from a centre that runs on a helix of radius e around the axis. At an angle psi from
the direction of this centre, the distance of the wall from the axis is ``R = e cos psi + sqrt(r^2 - e^2 sin^2 psi)``.
``helibore.simulation.tool`` measures this wall.
"""

from __future__ import annotations

import itertools
from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt

from helibore.base.arrays import Floats
from helibore.base.errors import InputError

BLOCK = 1 << 15
"""Number of points that are evaluated together, so few that all temporary arrays stay in the cache."""


@dataclass(frozen=True)
class Washout:
    """A washout over [start, stop) (m).

    In its middle the radius is ``enlargement`` metres larger and the wall is ``roughness`` times rougher.
    """

    start: float
    stop: float
    enlargement: float
    roughness: float = 4.0

    def __post_init__(self) -> None:
        _require_below(self.start, self.stop)


@dataclass(frozen=True)
class Breakout:
    """Two opposite lobes over [start, stop) (m), at ``toolface`` and ``toolface + 180``, each ``opening`` wide (deg).

    In the middle of a lobe the radius is ``enlargement`` metres larger and the wall is ``roughness`` times rougher.
    """

    start: float
    stop: float
    toolface: float
    opening: float
    enlargement: float
    roughness: float = 4.0

    def __post_init__(self) -> None:
        _require_below(self.start, self.stop)
        if not self.opening > 0:
            raise InputError("opening", "must be above 0", f"{self.opening:g}")


@dataclass(frozen=True)
class Bed:
    """A bed of ``gamma`` (gAPI) that begins where its top crosses the axis at ``depth`` (m).

    The top is a plane. In the image it is the sinusoid ``depth + R tan(dip) cos(toolface - direction)``, where R is the
    radius of the bit. ``dip`` is the angle (deg) between the top and the plane across the hole, and ``direction`` is
    the toolface (deg) at which the top is deepest.
    """

    depth: float
    gamma: float
    dip: float = 0.0
    direction: float = 0.0


@dataclass(frozen=True)
class Section:
    """A section of ``length`` m of the well path with constant ``build`` and ``turn``, in deg per 30 m."""

    length: float
    build: float = 0.0
    turn: float = 0.0


@dataclass(frozen=True)
class Hole:
    """The truth: the wall, the gamma and the path of a hole between two measured depths.

    Lengths are metres, angles degrees; toolfaces count clockwise from the high side, looking downhole.

    Attributes
    ----------
    start, stop
        Measured depths of both ends.
    bit_diameter
        Diameter of the bit.
    overgauge
        Radius of the hole minus radius of the bit, without all other shapes.
    ovality, ovality_toolface
        Amplitude of the ellipse in radius, and the toolface of its long axis.
    spiral, spiral_length
        Radius of the helix on which the centre of a spiral hole runs, and the depth of one turn of that helix.
    rugosity, rugosity_length
        Root mean square roughness, and its shortest wavelength along the hole; the longest is 8 times that.
    washouts, breakouts
        Where the hole is larger.
    beds, top_gamma
        The beds in order of depth, and the gamma above the first bed, gAPI.
    inclination, azimuth
        Direction of the path at ``start``.
    sections
        The path below ``start``; the last section continues beyond its length.
    seed
        Chooses the roughness.
    """

    start: float = 2000.0
    stop: float = 2050.0
    bit_diameter: float = 0.216
    overgauge: float = 0.001
    ovality: float = 0.0
    ovality_toolface: float = 0.0
    spiral: float = 0.0
    spiral_length: float = 1.0
    rugosity: float = 0.0
    rugosity_length: float = 0.4
    washouts: tuple[Washout, ...] = ()
    breakouts: tuple[Breakout, ...] = ()
    beds: tuple[Bed, ...] = ()
    top_gamma: float = 60.0
    inclination: float = 25.0
    azimuth: float = 60.0
    sections: tuple[Section, ...] = (Section(30.0, build=3.0), Section(15.0), Section(30.0, turn=3.0))
    seed: int = 0
    _modes: Floats = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        _require_below(self.start, self.stop)
        for name in ("bit_diameter", "spiral_length", "rugosity_length"):
            if not getattr(self, name) > 0:
                raise InputError(name, "must be above 0", f"{getattr(self, name):g}")
        if not abs(self.spiral) < 0.5 * self.bit_diameter:
            raise InputError("spiral", f"must be less than the radius of the bit, {0.5 * self.bit_diameter:g}",
                             f"{self.spiral:g}")  # fmt: skip
        for index, (above, bed) in enumerate(itertools.pairwise(self.beds), 1):
            if not bed.depth >= above.depth:
                raise InputError(f"beds[{index}].depth",
                                 f"must be at least {above.depth:g}, the depth of beds[{index - 1}]",
                                 f"{bed.depth:g}")  # fmt: skip
        object.__setattr__(self, "_modes", self._roughness_modes())

    @classmethod
    def example(
        cls, start: float = 2000.0, stop: float = 2050.0, *, bit_diameter: float = 0.216, seed: int = 0
    ) -> Hole:
        """Return a hole with every feature: oval, spiral and rough, with washouts, breakouts and dipping beds.

        There is about one washout in 20 m, one breakout in 12 m and one bed in 1.6 m, and at least one of each kind.
        Sizes are proportional to ``bit_diameter``.
        """
        rng = np.random.default_rng([seed, 1])
        length = stop - start
        size = bit_diameter / 0.216
        return cls(
            start=start,
            stop=stop,
            bit_diameter=bit_diameter,
            ovality=0.0015 * size,
            ovality_toolface=float(rng.uniform(0, 180)),
            spiral=0.0015 * size,
            spiral_length=1.1,
            rugosity=0.0006 * size,
            washouts=tuple(
                Washout(at, at + rng.uniform(2.0, 4.0), size * rng.uniform(0.012, 0.025))
                for at in _spread(rng, start, length, 20.0)
            ),
            breakouts=tuple(
                Breakout(at, at + rng.uniform(4.0, 8.0), 92.0 + rng.normal(0, 4.0), rng.uniform(55, 80),
                         size * rng.uniform(0.014, 0.024))
                for at in _spread(rng, start, length, 12.0)
            ),
            beds=_example_beds(rng, start, length),
            seed=seed,
        )  # fmt: skip

    def radius(self, depth: npt.ArrayLike, toolface: npt.ArrayLike) -> Floats:
        """Return a new array with the true radius (m) at measured depths (m) and toolfaces (deg), which broadcast."""
        depth, toolface = np.broadcast_arrays(depth, toolface)
        radius = np.empty(depth.shape)
        flat = radius.reshape(-1)
        d, t = depth.reshape(-1), toolface.reshape(-1)
        for start in range(0, flat.size, BLOCK):
            block = slice(start, start + BLOCK)
            flat[block] = self._radius(d[block].astype(np.float64), t[block].astype(np.float64))
        return radius

    def gamma(self, depth: npt.ArrayLike, toolface: npt.ArrayLike, resolution: float = 0.15) -> Floats:
        """Return a new array with the gamma (gAPI) at measured depths (m) and toolfaces (deg), which broadcast.

        From bed to bed the gamma changes over ``resolution`` metres of depth, about as a tool of this length measures.
        """
        depth, toolface = np.broadcast_arrays(depth, toolface)
        gamma = np.full(depth.shape, self.top_gamma, np.float64)
        above = self.top_gamma
        for bed in self.beds:
            reach = 0.5 * self.bit_diameter * np.tan(np.radians(bed.dip))
            top = bed.depth + reach * np.cos(np.radians(toolface - bed.direction))
            gamma += (bed.gamma - above) * _step((depth - top) / resolution + 0.5)
            above = bed.gamma
        return gamma

    def stations(self, interval: float = 30.0, margin: float = 30.0) -> tuple[Floats, Floats, Floats]:
        """Return depths (m), inclinations and azimuths (deg) of survey stations ``interval`` m apart.

        The stations reach from ``margin`` m above the hole to at least ``margin`` m below it.
        """
        depth = np.arange(float(self.start - margin), self.stop + margin + interval, interval)
        along = np.maximum(depth - self.start, 0.0)
        inclination = np.full(depth.size, self.inclination, np.float64)
        azimuth = np.full(depth.size, self.azimuth, np.float64)
        for index, section in enumerate(self.sections):
            last = index == len(self.sections) - 1
            part = along if last else np.minimum(along, section.length)
            inclination += part * section.build / 30.0
            azimuth += part * section.turn / 30.0
            along = along - part
        return depth, np.clip(inclination, 0.0, 180.0), azimuth % 360.0

    def _radius(self, depth: Floats, toolface: Floats) -> Floats:
        phi = np.radians(toolface)
        radius = np.full(depth.size, 0.5 * self.bit_diameter + self.overgauge)
        if self.ovality:
            radius += self.ovality * np.cos(2.0 * (phi - np.radians(self.ovality_toolface)))
        rough = np.zeros(depth.size)
        for around, along, phase, amplitude in self._modes:
            rough += amplitude * np.cos(around * phi + along * depth + phase)
        low, high = (depth.min(), depth.max()) if depth.size else (0.0, 0.0)
        rougher = np.ones(depth.size)
        for washout in self.washouts:
            if washout.start < high and low < washout.stop:
                share = _taper(depth, washout.start, washout.stop)
                radius += washout.enlargement * share
                rougher = np.maximum(rougher, 1.0 + (washout.roughness - 1.0) * share)
        for breakout in self.breakouts:
            if breakout.start < high and low < breakout.stop:
                # 1 on the axis of the breakout, on both sides of the hole; 0 half an opening or more away from it
                off = (toolface - breakout.toolface + 90.0) % 180.0 - 90.0
                share = _taper(depth, breakout.start, breakout.stop)
                share *= np.maximum(1.0 - (2.0 * off / breakout.opening) ** 2, 0.0) ** 2
                radius += breakout.enlargement * share
                rougher = np.maximum(rougher, 1.0 + (breakout.roughness - 1.0) * share)
        radius += rougher * rough
        if self.spiral:
            psi = phi - 2.0 * np.pi / self.spiral_length * depth
            radius = self.spiral * np.cos(psi) + np.sqrt(radius**2 - (self.spiral * np.sin(psi)) ** 2)
        return radius

    def _roughness_modes(self) -> Floats:
        """Return a row for each wave of the roughness: periods around the hole, radians per metre, phase, amplitude."""
        if not self.rugosity:
            return np.empty((0, 4))
        rng = np.random.default_rng([self.seed, 2])
        count = 14
        around = rng.integers(-8, 9, count)
        length = self.rugosity_length * 8.0 ** rng.random(count)
        amplitude = np.full(count, self.rugosity * np.sqrt(2.0 / count))
        return np.column_stack([around, 2.0 * np.pi / length, 2.0 * np.pi * rng.random(count), amplitude])


def _require_below(start: float, stop: float) -> None:
    if not stop > start:
        raise InputError("stop", f"must be deeper than start = {start:g}", f"{stop:g}")


def _step(x: Floats) -> Floats:
    """Return 0 below 0, 1 above 1, and a smooth step between."""
    x = np.clip(x, 0.0, 1.0)
    smooth: Floats = x * x * (3.0 - 2.0 * x)
    return smooth


def _taper(depth: Floats, start: float, stop: float) -> Floats:
    """Return 0 outside [start, stop), 1 in its middle half, and a smooth step between."""
    edge = 0.25 * (stop - start)
    return _step(np.minimum(depth - start, stop - depth) / edge)


def _spread(rng: np.random.Generator, start: float, length: float, spacing: float) -> list[float]:
    """Return sorted random depths, about one in each ``spacing`` metres of an interval and none in its last tenth."""
    count = max(1, round(length / spacing))
    return [start + 0.9 * length * (index + rng.uniform(0.1, 0.7)) / count for index in range(count)]


def _example_beds(rng: np.random.Generator, start: float, length: float) -> tuple[Bed, ...]:
    """Return beds of sand and shale that dip steeply; their dip and direction change slowly with depth."""
    depths = _spread(rng, start, length, 1.6)
    count = len(depths)
    dip = np.linspace(70.0, 80.0, count)
    direction = np.linspace(215.0, 150.0, count) + rng.normal(0, 5.0, count)
    shale = rng.random(count) < np.where(np.arange(count) % 2, 0.85, 0.15)
    gamma = np.where(shale, rng.uniform(85, 140, count), rng.uniform(20, 60, count))
    return tuple(Bed(*bed) for bed in zip(depths, gamma.tolist(), dip.tolist(), direction.tolist(), strict=True))
