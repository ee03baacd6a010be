"""Types of settings as keyword arguments. `./develop settings` writes this file; do not edit it."""

from __future__ import annotations

from typing import Literal, TypedDict


class WallSettings(TypedDict, total=False):
    """The settings of `Settings` as keyword arguments; a setting that is left out has its default."""

    sectors: int
    pitch: float
    start_depth: float | None
    stop_depth: float | None
    start_toolface: float
    neighbors: int
    window: int | None
    power: float
    max_distance: float | None
    max_iterations: int
    tolerance: float
    angular_scale: float
    estimator: Literal["inverse-distance", "kriging", "near-and-far", "automatic"]
    kriging_range: float | None
    nugget: float
    covariance: tuple[float, ...] | None
    other_turns: tuple[float, ...] | None
    stretches: tuple[float, ...] | None
    robust: bool
    arm_biases: tuple[float, ...] | None
    sigma: bool
    direct: bool
    first_vertex: int
    stop_vertex: int | None
    gap_reach: float
    largest_gap: float
    most_vertices: int
