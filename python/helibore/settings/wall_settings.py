"""The settings of a wall. The radius of every vertex depends only on these settings and on the samples."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Annotated, Any, Literal, cast

from helibore.settings.declared import (
    DEGREES,
    DEPTH,
    FINITE,
    METRES,
    MILLIMETRES,
    NOT_ZERO,
    POSITIVE,
    Declared,
    Option,
    Rule,
    at_least,
    at_most,
    within,
)

DISTANCE = Rule("must be above 0", lambda value: value > 0)
ANGLE = Rule("must be above 0 and at most 360", lambda value: 0 < value <= 360)
FINEST_NUGGET = Rule("must be finite and at least 1e-6", lambda value: 1e-6 <= value < float("inf"))
COVARIANCE = Rule(
    "must have 5, 8 or 11 values, or a turn as one more", lambda values: len(values) in (5, 6, 8, 9, 11, 12)
)
BIASES = Rule(
    "must have 1 to 256 numbers of -0.1 to 0.1 m",
    lambda values: 1 <= len(values) <= 256 and all(-0.1 <= of <= 0.1 for of in values),
)
STRETCHES = Rule(
    "must have thirteen numbers for each stretch", lambda values: len(values) > 0 and len(values) % 13 == 0
)
TURNS = Rule("must have ten numbers for each turn", lambda values: len(values) > 0 and len(values) % 10 == 0)
TOLERANCE = Rule("must be 0 or above", lambda value: value >= 0)

USUAL: Literal["inverse-distance", "automatic"] = "automatic"
"""The estimator where none is stated, live too, but for `Wall` and wells made in blocks."""
CHOSEN = (
    "neighbors", "window", "power", "max_iterations", "tolerance", "angular_scale", "kriging_range", "nugget",
    "covariance", "other_turns", "stretches", "robust", "direct",
)  # fmt: skip
"""Settings that 'automatic' chooses, or cannot have: stating one states that it shall not choose."""


@dataclass(frozen=True, kw_only=True)
class Settings(Declared, group="wall"):
    """Settings of a wall; the method was published in Energies 2021, 14, 291."""

    bit_diameter: Annotated[
        float, METRES, POSITIVE, at_least(0.001, "m"), at_most(4, "m"), Option("as the source states it"),
        "Bit size, such as 8.5in or '8 1/2in'. The first trial radius is half of it.",
    ]  # fmt: skip
    sectors: Annotated[int, within(3, 1_000_000), Option(), "Vertices in a turn, K."] = 64
    pitch: Annotated[float, MILLIMETRES, NOT_ZERO, DEPTH, Option(),
        "Pitch of the helix; negative for a well logged upwards. It is the distance along the hole from one turn to "
        "the next.",
    ] = 0.1  # fmt: skip
    start_depth: Annotated[float | None, METRES, FINITE, DEPTH,
        "Depth at which the helix starts. None: the depth of the first sample along the helix.",
    ] = None  # fmt: skip
    stop_depth: Annotated[float | None, METRES, FINITE, DEPTH,
        "Depth at which the helix stops. None: the depth of the last sample along the helix.",
    ] = None  # fmt: skip
    start_toolface: Annotated[float, DEGREES, FINITE, within(-1e6, 1e6, "degrees"), Option(),
        "Toolface of the first vertex.",
    ] = 0.0  # fmt: skip
    neighbors: Annotated[int, within(1, 256), Option("8; kriging: 16"),
        "Number of nearest samples that make a vertex. With kriging, at most 64. With 'near-and-far', at most 21: "
        "eight vertices share their neighbours: 3/8 of this number near each vertex, in each of two metrics, and this "
        "number of far ones, half more where noise is large. None: 8; with kriging and 'near-and-far' 16. V in the "
        "published method.",
    ] = cast(int, None)  # fmt: skip  # becomes 8 or 16
    window: Annotated[int | None, at_least(1), Option("all"),
        "Search only this many samples around a vertex, as in the published method. They are consecutive in depth (U). "
        "None: search all, exactly.",
    ] = None  # fmt: skip
    power: Annotated[float, POSITIVE, at_most(100), Option(), "Weights are distance^-power."] = 1.0
    max_distance: Annotated[float | None, METRES, DISTANCE, at_least(1e-9, "m"), Option(),
        "A vertex uses no sample farther away than this; none: no limit.",
    ] = 1.0  # fmt: skip
    max_iterations: Annotated[int, within(1, 255), Option(),
        "Greatest number of iterations for a radius. The estimate is repeated with the new radius until the radius "
        "moves by at most ``tolerance``.",
    ] = 4  # fmt: skip
    tolerance: Annotated[float, MILLIMETRES, TOLERANCE, Option(), "Change of radius that ends the iteration."] = 1e-6
    angular_scale: Annotated[float, POSITIVE, within(0.001, 1000), Option(),
        "Factor on distances around the hole; 1: true arcs; 2: as in the published method. Above 1, more neighbours "
        "lie above and below: 4 halves the error of many holes, whose shape changes little with depth "
        "(``bench/accuracy/angular_scale.py``). The published method is its Eq. 4.",
    ] = 1.0  # fmt: skip
    estimator: Annotated[
        Literal["inverse-distance", "kriging", "near-and-far", "automatic"], Option("automatic"),
        "Method that computes a radius from its neighbours. 'inverse-distance' is the published method; 'kriging' is "
        "ordinary kriging of the neighbours that the last estimate by inverse distance used, at its trial radius. "
        "Kriging weighs neighbours by how alike two radii are at their distance, so it averages out noise and follows "
        "slopes. Its radius may lie outside the radii used, by at most half of their range. 'near-and-far' is kriging "
        "by ``covariance``, with neighbours that are near in the metric of its first term, near in that of its second "
        "term, and far on all sides (means of up to 32 samples where noise is large); a larger ``max_distance`` lets "
        "it use a shape that continues along the hole. "
        "'automatic' fits a covariance to the samples and takes that of the three whose error is least, by samples "
        "that are left out or, between arms, by the covariance. In a live configuration its walls begin with inverse "
        "distance, and are fitted at 2, 5, 10, 20 and 40 m; `Wall` must be given one of the three. None: 'automatic', "
        "live too; 'inverse-distance' in `Wall`, in a well that is made in blocks, where a setting is stated that "
        "'automatic' would choose, such as ``neighbors`` or ``angular_scale``, and in a journal that was begun when "
        "it was the live default.",
    ] = cast(Any, None)  # fmt: skip  # becomes one of them by `resolved`
    kriging_range: Annotated[float | None, METRES, POSITIVE, Option("helibore finds it"),
        "Distance from which two radii are not correlated. It counts in the metric of ``angular_scale`` (the "
        "covariance is Wendland's C2 function); a range above half a turn counts as half a turn. None: "
        "`helibore.reconstruct` takes four times the median distance of the 16th nearest sample; a live wall must be "
        "given a range.",
    ] = None  # fmt: skip
    nugget: Annotated[float, FINEST_NUGGET, Option(),
        "Kriging: variance of the noise divided by variance of the shape.",
    ] = 0.1  # fmt: skip
    covariance: Annotated[tuple[float, ...] | None, COVARIANCE,
        "Covariance of the radii, for 'near-and-far'. A radius R (m), the noise variance of a sample (m^2), and for "
        "each of one to three terms its variance (m^2), length around and length along the hole (m); then, if the "
        "shape turns along the hole, by how many degrees a metre. The covariance of two radii is the sum over the "
        "terms of variance (1 + a) exp(-a), with a^2 = 3 ((chord / around)^2 + (depth / along)^2) and chord = 2 R "
        "sin(turned / 2), where turned = toolface difference - turn * depth difference. A second term whose length "
        "around is below 0 repeats after half a turn, as breakouts do: chord = R sin(turned). A first term whose "
        "length around is below 0 is smooth: variance exp(-a^2 / 6). None: not known.",
    ] = None  # fmt: skip
    other_turns: Annotated[tuple[float, ...] | None, TURNS,
        "Other covariances that the samples leave about as likely as ``covariance``, most with other turns: for each "
        "its share of the probability and nine values, with the same R, two terms and the turn. The share of "
        "``covariance`` is the rest. A radius is the mean by all of them, and `Wall.sigma` contains what they differ. "
        "'automatic' finds them.",
    ] = None  # fmt: skip
    stretches: Annotated[tuple[float, ...] | None, STRETCHES,
        "Covariances of the stretches of a hole that changes along it, for 'near-and-far': for each the depth at which "
        "it begins and twelve values as of ``covariance``, of three terms, where the variance of the third may be 0, "
        "and the turn. A vertex has the covariance of its stretch, and ``covariance`` above the first. Samples of "
        "other stretches hardly count, but within 0.2 m of the border. 'automatic' finds them. None: the hole is alike "
        "all along.",
    ] = None  # fmt: skip
    robust: Annotated[bool,
        "'near-and-far': a sample that lies beyond the radii of the eight samples beside it by more than 2.5 "
        "deviations of the noise hardly counts; of the eight, the greatest and the least do not count, and none is one "
        "of the eight samples before and after it in order of depth. 'automatic' sets it where more than three of 500 "
        "samples of a tool that measures all around are spikes.",
    ] = False  # fmt: skip
    arm_biases: Annotated[tuple[float, ...] | None, BIASES,
        "How much the radii of the tool's arms 0, 1, ... are too large (m). `Wall.append` subtracts it from samples "
        "with an arm number; others, live ones too, are taken as they are. 'automatic' finds it.",
    ] = None  # fmt: skip
    sigma: Annotated[bool,
        "Keep for each vertex the sums from which `Wall.sigma` is computed. `Wall.sigma` then need not estimate all "
        "vertices again. Radii do not depend on this setting.",
    ] = False  # fmt: skip
    direct: Annotated[bool,
        "Direct connection (published Eq. 6), for live walls. Where a vertex is not settled and samples lie in its "
        "cell (half a sector to either side, half a pitch up and down), the vertex takes the radius of the last of "
        "these samples in canonical order. Once it is settled, it is interpolated like any other vertex.",
    ] = False  # fmt: skip
    first_vertex: Annotated[int,
        "The wall is a stretch of the helix from this vertex, a multiple of ``sectors``. If it is not 0, "
        "``start_depth`` must be given. The values of the stretch equal those of the whole wall exactly if it gets all "
        "samples within `Wall.reach`.",
    ] = 0  # fmt: skip
    stop_vertex: Annotated[int | None,
        "The stretch ends before this vertex, which replaces ``stop_depth``. None: at the last sample.",
    ] = None  # fmt: skip
    gap_reach: Annotated[float, METRES, POSITIVE,
        "A part of the turn counts as measured by samples within this depth. It counts as measured where the angle "
        "between the nearest samples on its two sides is at most ``largest_gap``. Radii do not depend on these two "
        "settings.",
    ] = 0.5  # fmt: skip
    largest_gap: Annotated[float, DEGREES, ANGLE,
        "The largest angle between samples, within ``gap_reach``, that counts as measured.",
    ] = 60.0  # fmt: skip
    most_vertices: Annotated[int, within(1, 2147483647),
        "An append that would give the wall more vertices is refused. The error names the depth; so one wrong depth "
        "does not fill the memory.",
    ] = 100_000_000  # fmt: skip

    def __post_init__(self) -> None:
        if self.neighbors is None:
            object.__setattr__(self, "neighbors", 16 if self.estimator in ("kriging", "near-and-far") else 8)
        super().__post_init__()

    def resolved(self, *, later: bool = False) -> Settings:
        """Return the settings with an estimator, which may be none yet.

        It is `USUAL`, or inverse distance if one of `CHOSEN` is stated or samples may come ``later`` without a fit.
        """
        if self.estimator is not None:
            return self
        default = Settings(bit_diameter=self.bit_diameter)
        stated = later or any(getattr(self, name) != getattr(default, name) for name in CHOSEN)
        return replace(self, estimator="inverse-distance" if stated else USUAL)
