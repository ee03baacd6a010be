"""From readings to samples a wall can trust: every step optional, in one order, each counted and told.

    readings --closed, stuck--> rows --sensors--> one frame --range, repeated, spikes--> --passes, shifts-->
             --reference--> the wall's toolface --recentre--> the hole's axis --bias--> --latest--> Caliper

``Preparation()`` does nothing but bring the sensors into one frame. The steps themselves are in ``conditioning``,
``sensors``, ``passes``, ``references`` and ``eccentering``; here is their order, and what each needs from the others.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields, replace
from typing import TYPE_CHECKING

import numpy as np

from helibore.base.arrays import Floats, Integers
from helibore.preparation import conditioning
from helibore.preparation.sample_columns import LARGEST_RADIUS, Samples, Track, place_of
from helibore.samples.caliper import Caliper

if TYPE_CHECKING:
    from helibore.preparation.conditioning import Step
    from helibore.preparation.eccentering import Centres
    from helibore.preparation.passes import Bias, Shifts
    from helibore.preparation.readings import Readings
    from helibore.trajectory.survey import Path

__all__ = ["Preparation", "Prepared", "Track", "prepare"]

REFERENCES = ("north", "high-side", "automatic")
BIASES = ("none", "arm", "side")


@dataclass(frozen=True, kw_only=True)
class Preparation:
    """What is done to readings on their way to samples. Metres, degrees, seconds.

    Attributes
    ----------
    shallowest, deepest
        Samples beyond these depths are dropped.
    closed
        Radius that the arms read when the caliper is closed; rows where no arm reads 2 mm more are dropped.
    stuck
        Rows over which an arm must stand still, while others move, to be dropped.
    least_radius, greatest_radius
        Radii beyond them are dropped. Without them a radius that no hole has is an error.
    repeated
        Drop samples equal to an earlier one in depth, toolface, radius and time.
    spikes
        Drop samples that lie so many robust deviations off their neighbours in their turn; 6 is usual.
    turn_height
        A turn is so much of the hole: for tools that do not rotate. None: a rotation, or a row of 8 sensors or more.
    sensor_offset, latency
        Added to those of every sensor.
    toolface_from
        What toolfaces count from: "north", "high-side" or "automatic"; None: what the file's map says.
    steep, level
        Automatic: north until the inclination reaches ``level``, the high side until it is down to ``steep``.
    recentre
        Take the tool's offset out of each turn.
    reversal
        Number the passes anew: one begins where the tool went back by more than this. None: as the file numbers them.
    passes
        Which to use; None: all.
    latest
        In each 0.5 m keep only the last of them that was there.
    shifts
        (pass, metres) to be added to its depths.
    find_shifts
        Find the shift of every pass from the overlap, after those given.
    bias
        What reads too much, found from the overlap and taken off: "none", each pass and "arm", or each pass and arm by
        the "side" it lies on.
    earlier
        Passes that make the wall to compare with.
    """

    shallowest: float | None = None
    deepest: float | None = None
    closed: float | None = None
    stuck: int | None = None
    least_radius: float | None = None
    greatest_radius: float | None = None
    repeated: bool = False
    spikes: float | None = None
    turn_height: float | None = None
    sensor_offset: float = 0.0
    latency: float = 0.0
    toolface_from: str | None = None
    steep: float = 4.0
    level: float = 6.0
    recentre: bool = False
    reversal: float | None = None
    passes: tuple[int, ...] | None = None
    latest: bool = False
    shifts: tuple[tuple[int, float], ...] = ()
    find_shifts: bool = False
    bias: str = "none"
    earlier: tuple[int, ...] = ()

    def __post_init__(self) -> None:
        if self.toolface_from not in (None, *REFERENCES):
            raise ValueError(f"toolface_from = {self.toolface_from!r}: must be one of {', '.join(REFERENCES)}")
        if self.bias not in BIASES:
            raise ValueError(f"bias = {self.bias!r}: must be one of {', '.join(BIASES)}")
        if self.turn_height is not None and not 0 < self.turn_height < np.inf:
            raise ValueError(f"turn_height = {self.turn_height:g}: must be finite and larger than 0")
        for least, most in (("least_radius", "greatest_radius"), ("shallowest", "deepest")):
            low, high = getattr(self, least), getattr(self, most)
            if low is not None and high is not None and not low <= high:
                raise ValueError(f"{least} = {low:g}: must not be larger than {most} = {high:g}")
        twice = [number for number, _ in self.shifts if [one for one, _ in self.shifts].count(number) > 1]
        if twice:
            raise ValueError(f"shifts: pass {twice[0]} is given twice")

    def changed(self) -> dict[str, object]:
        """The settings that are not their defaults, by name."""
        return {one.name: getattr(self, one.name) for one in fields(self) if getattr(self, one.name) != one.default}

    @property
    def by_pass(self) -> bool:
        """Whether a step needs to know the passes apart."""
        return bool(
            self.passes or self.latest or self.shifts or self.find_shifts or self.bias != "none" or self.earlier
        )


@dataclass(frozen=True)
class Prepared:
    """Samples ready for a wall, and what was done to them.

    Attributes
    ----------
    caliper
        The samples.
    told
        (step, sentence) for everything that was dropped, corrected or assumed, in order.
    counts
        Step to samples dropped by it, and "kept".
    pass_number
        Of each sample of ``caliper``, (n,) int64; None where no step asked for passes.
    centres, centre_depth
        The tool's centre in each turn, its covariance, inliers ..., and the mean depth of the turn, (t,) m; None
        without ``recentre``.
    shifts, bias
        What was found; None where it was not asked for.
    earlier
        The samples of the earlier passes; None without.
    """

    caliper: Caliper
    told: tuple[tuple[str, str], ...]
    counts: dict[str, int]
    pass_number: Integers | None = None
    centres: Centres | None = None
    centre_depth: Floats | None = None
    shifts: Shifts | None = None
    bias: Bias | None = None
    earlier: Caliper | None = None


def prepare(
    readings: Readings | Sequence[Readings],
    settings: Preparation | None = None,
    path: Path | None = None,
    track: Track | None = None,
) -> Prepared:
    """Condition readings, bring them into one frame and correct them.

    Parameters
    ----------
    readings
        Of one file or of several over one hole, earliest first; each file is a pass of its own unless it numbers them.
    settings
        What to do; nothing but the frame where None.
    path
        The wall's path: needed where toolfaces count from something else than the wall's.
    track
        Depth and toolface by time, for readings that have only a time.

    Returns
    -------
    Prepared

    Raises
    ------
    ValueError
        Naming file, line and rule: nothing left, an impossible radius, a step that lacks what it needs.
    """
    every = [readings] if not isinstance(readings, Sequence) else list(readings)
    if not every:
        raise ValueError("readings: must have at least one")
    try:
        return _Line(every, settings or Preparation(), path, track).run()
    except ValueError as error:
        if str(error).startswith(tuple(one.name for one in every)):
            raise
        raise ValueError(f"{', '.join(one.name for one in every)}: {error}") from error


class _Line:
    """The samples on their way through the steps."""

    def __init__(self, readings: list[Readings], settings: Preparation, path: Path | None, track: Track | None) -> None:
        self.readings, self.settings, self.path, self.track = readings, settings, path, track
        self.told: list[tuple[str, str]] = []
        self.counts: dict[str, int] = {}
        self.centres: Centres | None = None
        self.centre_depth: Floats | None = None
        self.shifts: Shifts | None = None
        self.bias: Bias | None = None
        self.samples: Samples

    def run(self) -> Prepared:
        """All steps in their order."""
        if self.settings.closed is not None or self.settings.stuck is not None:
            self.readings = [self._conditioned(one) for one in self.readings]
        self.samples = Samples.observed(self.readings, self.settings, self.track, self.told, self.counts)
        self._drop_single_samples()
        if self.settings.by_pass or self.settings.reversal is not None:
            self._number_passes()
            self._shift()
        self._refer()
        if self.settings.recentre:
            self._recentre()
        if self.settings.bias != "none":
            self._take_off_bias()
        return self._finished()

    def _drop(self, step: Step, what: str = "samples") -> None:
        """Leave out what a step dropped, and tell."""
        self._tell(step, what)
        if step.dropped.any():
            self.samples = self.samples.select(step.kept)
        if not self.samples.depth.size:
            raise ValueError(f"{self.readings[0].name}: no samples are left after the step {step.name}")

    def _tell(self, step: Step, what: str) -> None:
        count = int(np.count_nonzero(step.dropped))
        self.counts[step.name] = self.counts.get(step.name, 0) + count
        reasons = ", ".join(f"{number:,} {reason}" for reason, number in step.counts.items() if number)
        unjudged = f"; {step.unjudged:,} could not be judged" if step.unjudged else ""
        share = f"{count:,} of {step.dropped.size:,} {what}"
        self.told.append((step.name, f"dropped {share}{f' ({reasons})' if reasons else ''}{unjudged}"))

    def _conditioned(self, one: Readings) -> Readings:
        """The readings without closed and stuck stretches."""
        radii = np.stack(one.radii)
        if self.settings.closed is not None:
            step = conditioning.closed(list(radii), self.settings.closed)
            self._tell(step, "rows")
            radii = np.where(step.dropped, np.nan, radii)
        if self.settings.stuck is not None:
            # The two ends of a diameter are one reading; the sectors of an image are one each.
            again = [at > 0 and one.across[at] and one.arm[at] == one.arm[at - 1] for at in range(len(radii))]
            reading = np.cumsum(~np.array(again)) - 1
            if reading[-1] == 0:
                raise ValueError(f"{one.name}: one arm alone cannot be told to be stuck: no other moves beside it")
            step = conditioning.stuck(list(radii[~np.array(again)]), rows=self.settings.stuck)
            self._tell(step, "readings")
            radii = np.where(step.dropped[reading], np.nan, radii)
        return replace(one, radii=tuple(radii))

    def _drop_single_samples(self) -> None:
        """Interval, range, repeated and spikes."""
        settings, samples = self.settings, self.samples
        if settings.shallowest is not None or settings.deepest is not None:
            low = -np.inf if settings.shallowest is None else settings.shallowest
            high = np.inf if settings.deepest is None else settings.deepest
            self._drop(replace(conditioning.in_range(samples.depth, low, high), name="interval"))
            samples = self.samples
        if settings.least_radius is not None or settings.greatest_radius is not None:
            low = -np.inf if settings.least_radius is None else settings.least_radius
            high = np.inf if settings.greatest_radius is None else settings.greatest_radius
            self._drop(conditioning.in_range(samples.radius, low, high))
        if settings.repeated:
            samples = self.samples
            times = [] if samples.time is None else [samples.time]
            self._drop(conditioning.repeated_rows(samples.depth, samples.toolface, samples.radius, *times))
        if settings.spikes is not None:
            samples = self.samples
            turn = samples.turns(settings.turn_height, self.told)
            self._drop(conditioning.spikes(samples.toolface, samples.radius, turn, threshold=settings.spikes))

    def _number_passes(self) -> None:
        from helibore.preparation.passes import choose

        settings = self.settings
        self.samples.number_passes(settings.reversal, self.told)
        number = self.samples.pass_number
        if settings.passes is not None or settings.earlier:
            wanted = None if settings.passes is None else sorted({*settings.passes, *settings.earlier})
            strange = sorted({*(settings.passes or ()), *settings.earlier} - set(number.tolist()))
            if strange:
                there = ", ".join(map(str, np.unique(number)))
                raise ValueError(f"pass {strange[0]}: is not among the passes of the samples: {there}")
            if wanted is not None:
                self._drop(choose(number, self.samples.depth, wanted))

    def _shift(self) -> None:
        settings, samples = self.settings, self.samples
        for number, shift in settings.shifts:
            mine = samples.pass_number == number
            if not mine.any():
                raise ValueError(f"shift {number}={shift:g} m: is not among the passes of the samples")
            samples.depth = np.where(mine, samples.depth + shift, samples.depth)
            self.told.append(("shift", f"pass {number}: {shift:+.3f} m, as given"))
        if not settings.find_shifts:
            return
        from helibore.preparation.passes import find_shifts

        found = self.shifts = find_shifts(samples.depth, samples.radius, samples.pass_number)
        samples.depth = samples.depth + found.at(samples.pass_number)
        for number, shift, correlation, before, good in zip(
            found.passes, found.shift, found.correlation, found.before, found.found, strict=True
        ):
            text = f"{shift:+.3f} m found, correlation {before:.2f} before, {correlation:.2f} after"
            self.told.append(("shift", f"pass {number}: {text if good else 'left where it is: no clear match'}"))

    def _refer(self) -> None:
        """Turn toolfaces into the reference of the path."""
        self.samples = self.samples.referred(self.path, self.settings, self.told, self.counts)

    def _recentre(self) -> None:
        from helibore.preparation.eccentering import find_centres, recentre

        samples = self.samples
        if samples.across.any():
            name = self.readings[0].channels[0]
            raise ValueError(
                f"{self.readings[0].name}: recentring needs radii: half a diameter ({name}) holds no offset of the tool"
            )
        turn = samples.turns(self.settings.turn_height, self.told)
        found = self.centres = find_centres(samples.toolface, samples.radius, turn)
        row = np.searchsorted(found.turn, turn)
        self.centre_depth = np.bincount(row, samples.depth) / np.bincount(row)
        moved = found.share() > 0
        samples.toolface, samples.radius = recentre(samples.toolface, samples.radius, turn, found)
        far = found.eccentering[np.isfinite(found.eccentering)]
        sigma = np.hypot(found.sigma_x, found.sigma_y)
        self.told.append((
            "recentre", f"{np.count_nonzero(moved):,} of {found.turn.size:,} turns corrected; tool off by "
            f"{1e3 * np.median(far):.1f} mm in half of them, {1e3 * far.max():.1f} mm at most; "
            f"deviation of a centre {1e3 * np.nanmedian(sigma):.2f} mm in half of them"
        ))  # fmt: skip

    def _take_off_bias(self) -> None:
        from helibore.preparation.passes import arm_sides, find_bias

        samples = self.samples
        arms = samples.arm if self.settings.bias == "arm" else arm_sides(samples.arm, samples.bearing)
        found = find_bias(samples.depth, samples.toolface, samples.radius, samples.pass_number, arms)
        self.bias = found
        samples.radius = samples.radius - found.at(samples.pass_number, arms)
        passes = ", ".join(f"{n}: {1e3 * b:+.2f}" for n, b in zip(found.passes, found.by_pass, strict=True))
        self.told.append(("bias", f"of passes, mm: {passes}; noise after it {1e3 * found.noise:.2f} mm"))
        spread = 1e3 * found.by_arm
        kind = "arms" if self.settings.bias == "arm" else "arms by side"
        self.told.append(("bias", f"of {spread.size} {kind}: {spread.min():+.2f} to {spread.max():+.2f} mm"))

    def _finished(self) -> Prepared:
        settings, earlier = self.settings, None
        if settings.earlier:
            from helibore.preparation.passes import choose

            everything = self.samples
            self.samples = everything.select(choose(everything.pass_number, everything.depth, settings.earlier).kept)
            earlier = self._caliper()
            chosen = settings.passes or sorted(set(everything.pass_number.tolist()) - set(settings.earlier))
            if not chosen:
                raise ValueError("earlier: no pass is left to compare with them")
            self.samples = everything.select(choose(everything.pass_number, everything.depth, chosen).kept)
        if settings.latest:
            from helibore.preparation.passes import choose

            order = settings.passes or None
            self._drop(choose(self.samples.pass_number, self.samples.depth, order, latest=True))
        caliper = self._caliper()
        self.counts["kept"] = len(caliper)
        number = self.samples.pass_number if self.settings.by_pass else None
        return Prepared(
            caliper,
            tuple(self.told),
            self.counts,
            number,
            self.centres,
            self.centre_depth,
            self.shifts,
            self.bias,
            earlier,
        )

    def _caliper(self) -> Caliper:
        samples = self.samples
        if not (samples.radius.min() > 0.0 and samples.radius.max() <= LARGEST_RADIUS):
            at = int(np.argmax(~((samples.radius > 0.0) & (samples.radius <= LARGEST_RADIUS))))
            rule = f"radius {samples.radius[at]:g} m: must be larger than 0 and at most {LARGEST_RADIUS:g} m"
            raise ValueError(f"{place_of(samples, self.readings, at)}: {rule}; a radius range drops such")
        return Caliper(samples.depth, samples.toolface, samples.radius, samples.time)
