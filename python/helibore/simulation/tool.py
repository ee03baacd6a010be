"""Simulate an imaging-while-drilling tool in a known hole: samples, survey and gamma image, with their truth.

A :class:`Tool` turns with stick-slip, advances unevenly, may be lifted to scan an interval again, and adds noise;
:func:`simulate` runs it through a :class:`~helibore.simulation.hole.Hole`::

    speed of turning  = rotation (1 + stick_slip cos(2 pi t / period + phase) + a slow variation by 4 %)
    speed of advance  = advance (1 + swings with periods of 8 s, 47 s and 391 s)

All random numbers are seeded: the same arguments give exactly the same numbers. ``rig.py`` simulates the telemetry
and its losses. The tool is always on the axis of the hole.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from helibore.base.arrays import Floats
from helibore.base.errors import InputError
from helibore.simulation.hole import Bed, Breakout, Hole, Section, Washout

__all__ = ["Bed", "Breakout", "Hole", "Lift", "Section", "Simulation", "Tool", "Washout", "simulate"]


@dataclass(frozen=True)
class Lift:
    """When the bit is at ``depth`` (m), the tool is raised by ``length`` (m), and then scans these metres again."""

    depth: float
    length: float


@dataclass(frozen=True)
class Tool:
    """How the tool turns, advances and measures.

    Attributes
    ----------
    rotation
        Mean speed, turns a minute.
    stick_slip, stick_slip_period
        Amplitude of the swing of the speed as a share of the mean (1: turning stops in each period), and its period, s.
    advance, advance_variation
        Mean rate of penetration, metres an hour, and the sum of the amplitudes of all swings as a share of it, below 1.
    sample_rate
        Samples a second.
    noise, toolface_noise
        Standard deviations of the radius, metres, and of the toolface, degrees.
    missing
        Share of the samples that never arrive, [0, 1).
    lifts
        When the tool is lifted, sorted by depth.
    sectors, image_step, gamma_noise
        Sectors of the gamma image, metres between two of its rows, and the standard deviation of its noise, gAPI.
    """

    rotation: float = 117.0
    stick_slip: float = 0.7
    stick_slip_period: float = 3.7
    advance: float = 20.0
    advance_variation: float = 0.6
    sample_rate: float = 20.0
    noise: float = 0.0005
    toolface_noise: float = 0.0
    missing: float = 0.0
    lifts: tuple[Lift, ...] = ()
    sectors: int = 16
    image_step: float = 0.1
    gamma_noise: float = 2.0

    def __post_init__(self) -> None:
        for name in ("rotation", "stick_slip_period", "advance", "sample_rate", "image_step"):
            if not getattr(self, name) > 0:
                raise InputError(name, "must be above 0", f"{getattr(self, name):g}")
        for name in ("stick_slip", "noise", "toolface_noise", "gamma_noise"):
            if not getattr(self, name) >= 0:
                raise InputError(name, "must not be negative", f"{getattr(self, name):g}")
        for name in ("advance_variation", "missing"):
            if not 0 <= getattr(self, name) < 1:
                raise InputError(name, "must be in [0, 1)", f"{getattr(self, name):g}")
        if self.sectors < 1:
            raise InputError("sectors", "must be at least 1", f"{self.sectors}")


@dataclass(frozen=True)
class Simulation:
    """The measurements of the tool, in the order in which it made them, and the hole.

    Attributes
    ----------
    time, depth, toolface, radius
        The samples, (n,) float64: seconds from the start, metres, degrees in [0, 360), metres.
    station_depth, inclination, azimuth
        The survey, metres and degrees.
    gamma_depth, gamma
        The gamma image: rows (r,) in metres, values (r, sectors) in gAPI. Sector j spans the toolfaces
        [j, j + 1) 360 / sectors, so the first sector starts at the high side.
    hole, tool
        The true hole, of which ``hole.radius(depth, toolface)`` returns the true radius; the tool.
    """

    time: Floats
    depth: Floats
    toolface: Floats
    radius: Floats
    station_depth: Floats
    inclination: Floats
    azimuth: Floats
    gamma_depth: Floats
    gamma: Floats
    hole: Hole
    tool: Tool


def simulate(
    hole: Hole | None = None, tool: Tool | None = None, *, samples: int | None = None, seed: int = 0
) -> Simulation:
    """Measure a hole (None: ``Hole.example(seed=seed)``) with an imaging-while-drilling tool (None: ``Tool()``).

    ``samples`` is the number of samples of the whole run, at least 2, before the share ``tool.missing`` is removed; it
    replaces ``tool.sample_rate``. With None, the number follows from ``tool.sample_rate``. ``seed`` is the seed of
    phases, noise and missing samples. The first sample is at ``hole.start`` and the last sample is at ``hole.stop``,
    unless they are missing.
    Raises InputError if a lift leaves the hole, if lifts are not in order of depth, if there are fewer than two
    samples, or if all of them are missing.
    """
    hole = Hole.example(seed=seed) if hole is None else hole
    tool = Tool() if tool is None else tool
    _check_lifts(hole, tool)
    travel = hole.stop - hole.start + sum(lift.length for lift in tool.lifts)
    duration = travel / (tool.advance / 3600.0)
    count = int(duration * tool.sample_rate) + 1 if samples is None else samples
    if count < 2:
        raise InputError("samples", "must be at least 2", f"{count}")

    rng = np.random.default_rng([seed, 3])
    time = np.linspace(0.0, duration, count)
    toolface = _rotate(tool, time, rng)
    depth = hole.start + travel * _progress(tool, time, rng)
    time, depth = _lift(hole, tool, time, depth)
    if tool.missing:
        kept = rng.random(count) >= tool.missing
        if not kept.any():
            raise InputError("missing", f"leaves none of {count} samples", f"{tool.missing:g}")
        time, depth, toolface = time[kept], depth[kept], toolface[kept]
    radius = hole.radius(depth, toolface)
    if tool.noise:
        radius += rng.normal(0.0, tool.noise, radius.size)
    if tool.toolface_noise:
        toolface = (toolface + rng.normal(0.0, tool.toolface_noise, toolface.size)) % 360.0

    rows = np.arange(hole.start, hole.stop + 0.5 * tool.image_step, tool.image_step)
    centres = (np.arange(tool.sectors) + 0.5) * (360.0 / tool.sectors)
    gamma = hole.gamma(rows[:, None], centres[None, :])
    gamma = np.maximum(gamma + rng.normal(0.0, tool.gamma_noise, gamma.shape), 0.0)
    return Simulation(time, depth, toolface, radius, *hole.stations(), rows, gamma, hole, tool)


def _check_lifts(hole: Hole, tool: Tool) -> None:
    deepest = hole.start
    for index, lift in enumerate(tool.lifts):
        if not (deepest <= lift.depth <= hole.stop):
            raise InputError(f"lifts[{index}].depth", f"must be in [{deepest:g}, {hole.stop:g}]", f"{lift.depth:g}")
        if not (0 < lift.length <= lift.depth - hole.start):
            rule = f"must be above 0 and at most {lift.depth - hole.start:g}, so that the tool stays in the hole"
            raise InputError(f"lifts[{index}].length", rule, f"{lift.length:g}")
        deepest = lift.depth


def _rotate(tool: Tool, time: Floats, rng: np.random.Generator) -> Floats:
    """Return the toolface at each time: the integral of a speed that swings (stick-slip) and varies slowly."""
    start, fast, slow = rng.random(3)
    turns = time + start
    for amplitude, period, phase in ((tool.stick_slip, tool.stick_slip_period, fast), (0.04, 61.8, slow)):
        turns += amplitude * period / (2.0 * np.pi) * np.sin(2.0 * np.pi * (time / period + phase))
    turns *= tool.rotation / 60.0
    turns -= np.floor(turns)
    turns *= 360.0
    return np.where(turns < 360.0, turns, 0.0)


def _progress(tool: Tool, time: Floats, rng: np.random.Generator) -> Floats:
    """Return the share of the whole distance that the tool has advanced at each time, from 0 to 1.

    The share never falls, because the amplitudes of all swings of the speed sum to less than the mean speed.
    """
    progress = time.copy()
    for share, period in ((0.5, 8.3), (0.3, 47.0), (0.2, 391.0)):
        swing = share * tool.advance_variation * period / (2.0 * np.pi)
        progress += swing * np.sin(2.0 * np.pi * (time / period + rng.random()))
    progress -= progress[0]
    progress /= progress[-1]
    return progress


def _lift(hole: Hole, tool: Tool, time: Floats, depth: Floats) -> tuple[Floats, Floats]:
    """Return time and depth with lifts: at each lift the depth steps back; no sample is made while the tool rises."""
    raising_speed = 0.2  # m/s
    for lift in tool.lifts:
        first = int(np.argmax(depth > lift.depth))
        depth[first:] -= lift.length
        time[first:] += lift.length / raising_speed
    return time, np.clip(depth, hole.start, hole.stop)
