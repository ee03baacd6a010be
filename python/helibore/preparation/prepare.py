"""Prepare readings for a wall: the steps are optional, have a fixed order, and report and count what they drop.

    readings --closed, flat tops, stuck--> rows --sensors--> one frame --velocity by casing--> --range, repeated,
             spikes--> --passes, shifts--> --reference--> the wall's toolface --recentre--> the hole's axis --bias-->
             --latest pass only--> Caliper

``Preparation()`` only drops closed arms and flat tops (an arm at its widest), and brings the sensors into one frame.
The steps themselves are in ``conditioning``, ``observe``, ``mud_velocity``, ``passes``, ``shifts``, ``centre_paths``,
``eccentering`` and ``biases`` beside this file, and in ``trajectory.references``; this file calls them in their order.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from helibore import _core
from helibore.base.angles import wrapped
from helibore.base.arrays import Floats, Integers, Mask, Number, Typed, distinct
from helibore.base.arrays import column as contiguous
from helibore.base.errors import InputError
from helibore.base.nulls import say_so
from helibore.base.tables import refuse_table
from helibore.base.units import INCH
from helibore.preparation import conditioning
from helibore.preparation.biases import Bias, arm_sides, find_bias
from helibore.preparation.centre_paths import find_centre_path
from helibore.preparation.eccentering import Centres, find_centres, recentre, turn_positions
from helibore.preparation.mud_velocity import MudVelocity, echo_accuracy, find_velocity
from helibore.preparation.observe import Track, observe, placed
from helibore.preparation.passes import choose, number_passes
from helibore.preparation.readings import Readings
from helibore.preparation.sensors import REASONS
from helibore.samples.caliper import LARGEST_RADIUS, Caliper
from helibore.settings.preparation_settings import Preparation
from helibore.trajectory.references import Norths, from_high_side, horizontal_to_north, onto_path

if TYPE_CHECKING:
    from helibore.preparation.conditioning import Step
    from helibore.preparation.sensors import Samples
    from helibore.preparation.shifts import Shifts
    from helibore.trajectory.survey import Path

__all__ = ["Preparation", "Prepared", "Track", "prepare"]


SIDES = 8
"""Number of sides of the hole; with ``bias = "side"``, an arm has a bias of its own on each side."""

JUDGED = 20_000
"""Largest number of samples used to compare passes and arms if ``bias`` is "none"."""

CAUSES = {
    "arms": ("disagreement",),
    "closed": ("closed", "ramp"),
    "saturated": ("saturated",),
    "stuck": ("stuck",),
    "spikes": ("burst", "jump"),
}
"""For each step of the report, the causes of the suspect rows that it names."""

APART = 0.0025
"""Metres; two calipers that look in the same direction must not differ by more than this in half of the rows."""
MOST_PASSES = 50
"""If the depths of a file turn back more often than this, its rows are in no order and have no runs to compare."""


@dataclass(frozen=True)
class Prepared:
    """Samples ready for a wall, and a record of the preparation; fields of steps that were not chosen are None.

    Attributes
    ----------
    caliper
        The samples.
    report
        (step, sentence) for what was dropped, corrected or assumed, in order.
    counts
        Number of rows, readings or samples dropped, by step or reason; "kept": samples left.
    pass_number
        The pass of each sample, -1: not numbered; None: one file without passes.
    centres, centre_depth
        The tool's centre in each of t turns, and the mean depth of these turns, (t,) m.
    shifts
        The depth function of each pass.
    bias
        The bias of each arm or pass.
    earlier
        The samples of the earlier passes.
    arm_names
        The channel of each number in ``caliper.arm``.
    echo_accuracy
        How sure the velocity of sound in the mud is: ``depth`` (m), ``share`` of the velocity, ``tool_radius`` (m).
    """

    caliper: Caliper
    report: tuple[tuple[str, str], ...]
    counts: dict[str, int]
    pass_number: Integers | None = None
    centres: Centres | None = None
    centre_depth: Floats | None = None
    shifts: Shifts | None = None
    bias: Bias | None = None
    earlier: Caliper | None = None
    arm_names: tuple[str, ...] = ()
    echo_accuracy: dict[str, Any] | None = None


def prepare(
    readings: Readings | Sequence[Readings],
    settings: Preparation | None = None,
    path: Path | None = None,
    track: Track | None = None,
    bit_diameter: float | None = None,
) -> Prepared:
    """Condition readings, bring them into one frame and correct them.

    Parameters
    ----------
    readings
        Readings of one file, or of several files of one hole, earliest first. A file is one pass unless it numbers its
        passes.
    settings
        The steps to take; None: ``Preparation()``.
    path
        The wall's path, which is needed if toolfaces count from another reference than the wall's.
    track
        Depth by time, and toolface by time if the track has one. They replace the depth and the toolface of all
        readings, which then need times.
    bit_diameter
        Metres; needed for ``drop_closed``, and widens the deviation of a centre if a washout on one side may look like
        an offset of the tool (`find_centres`).

    Returns
    -------
    Prepared

    Raises
    ------
    InputError
        If no sample is left, a radius is impossible, or a step lacks an input that it needs. The error names the file,
        and the line where there is one.
    """
    refuse_table(readings, "readings")
    every = list(readings) if isinstance(readings, Sequence) else [readings]
    if not every:
        raise InputError("readings", "must be those of at least one file")
    return _Pipeline(every, settings or Preparation(), path, bit_diameter).run(track)


class _Pipeline:
    """The samples between the steps, and the record of the steps done so far."""

    def __init__(
        self, readings: list[Readings], settings: Preparation, path: Path | None, bit_diameter: float | None
    ) -> None:
        self.readings, self.settings, self.path, self.bit_diameter = readings, settings, path, bit_diameter
        self.names = ", ".join(one.name for one in readings)
        self.references = [settings.toolface_from or one.reference for one in readings]  # of the toolfaces of each file
        self.report: list[tuple[str, str]] = []
        self.counts: dict[str, int] = {}
        self.centres: Centres | None = None
        self.centre_depth: Floats | None = None
        self.shifts: Shifts | None = None
        self.bias: Bias | None = None
        self.velocity: tuple[MudVelocity, ...] = ()
        self.samples: Samples

    def run(self, track: Track | None) -> Prepared:
        """Run all steps in their order, and return the samples and the record."""
        settings = self.settings
        turned = track is not None and track.toolface is not None
        self.readings = [
            self._conditioned(_tracked(one if turned else self._across(number), track))
            for number, one in enumerate(self.readings)
        ]
        self.samples = observe(
            self.readings, track, self.report, offset=settings.sensor_offset, latency=settings.latency,
            dropped=self.counts,
        )  # fmt: skip
        self.counts |= {reason: count for reason, count in self.samples.counts.items() if reason in REASONS}
        self._fill_rows()
        self._calibrate_velocity()
        self._drop_single_samples()
        if settings.by_pass or settings.reversal is not None:
            self._number_passes()
            self._choose_passes()
            self._shift()
        self._refer_to_path()
        if settings.recentre:
            self._recentre()
        if settings.bias != "none":
            self._subtract_bias()
        else:
            self._warn_of_bias()
        return self._finished()

    def _fill_rows(self) -> None:
        """Fill in a row's missing depth or toolface from the samples of that row, which were interpolated by time."""
        samples = self.samples
        for number, one in enumerate(self.readings):
            if not (np.isnan(one.depth).any() or np.isnan(one.toolface).any()):
                continue
            mine = np.flatnonzero(samples.file == number)
            offsets = np.array([each.offset + self.settings.sensor_offset for each in one.sensors])
            mountings = np.array([each.mounting for each in one.sensors])
            depth, toolface = one.depth.copy(), one.toolface.copy()
            for column, seen, moved in ((depth, samples.depth, offsets), (toolface, samples.toolface, -mountings)):
                lost = mine[np.isnan(column)[samples.row[mine]]]
                column[samples.row[lost]] = seen[lost] + moved[samples.sensor[lost]]
            self.readings[number] = replace(one, depth=depth, toolface=toolface)

    def _calibrate_velocity(self) -> None:
        """Correct radii of travel times by the velocity that casing shows; keep how sure it is."""
        samples, radius, turn = self.samples, self.samples.radius, None
        for number, one in enumerate(self.readings):
            echo = one.echo
            if echo is None or (not echo.casing and not echo.velocity_sigma):
                continue
            mine = np.flatnonzero(samples.file == number)
            turn = self._turns()[0] if turn is None and echo.casing else turn
            if turn is None:
                found = MudVelocity(echo, ())
            else:
                with placed(one.name):
                    columns = samples.depth[mine], samples.toolface[mine], samples.radius[mine], turn[mine]
                    found = find_velocity(echo, *columns)
                velocity, _ = found.at(samples.depth[mine])
                radius = radius.copy() if radius is samples.radius else radius
                radius[mine] = echo.tool_radius + (radius[mine] - echo.tool_radius) * velocity / echo.velocity
                self.report += [("velocity", f"{one.name}: {line}") for line in found.lines()]
            self.velocity = (*self.velocity, found)
        self.samples = replace(samples, radius=radius)

    def _drop(self, step: Step) -> None:
        """Remove the samples that a step dropped, and report them."""
        self._report_step(step, "samples")
        if step.dropped.any():
            self.samples = self.samples.select(step.kept)
        if not self.samples.depth.size:
            raise InputError(self.readings[0].name, f"no samples are left after the step {step.name}")

    def _report_step(self, step: Step, what: str) -> None:
        count = int(np.count_nonzero(step.dropped))
        self.counts[step.name] = self.counts.get(step.name, 0) + count
        reasons = ", ".join(f"{number:,} {reason}" for reason, number in step.counts.items() if number)
        unjudged = f"; {step.unjudged:,} could not be judged" if step.unjudged else ""
        share = f"{count:,} of {step.dropped.size:,} {what}"
        self.report.append((step.name, f"dropped {share}{f' ({reasons})' if reasons else ''}{unjudged}"))

    def _conditioned(self, one: Readings) -> Readings:
        """Return the readings without those of saturated, closed and stuck arms; report calipers that disagree.

        Raises InputError if two calipers that look in the same direction differ in half of the rows, or if ``stuck`` is
        set for a tool of one arm.
        """
        if not one.is_image:
            one = self._judged(one)
        if self.settings.closed is None and self.settings.stuck is None:
            return one
        radii = np.stack(one.radii)
        if self.settings.closed is not None:
            step = conditioning.closed(list(radii), self.settings.closed)
            self._report_step(step, "rows")
            radii = np.where(step.dropped, np.nan, radii)
        if self.settings.stuck is not None:
            reading = np.array([column for _, _, column in one.places])
            if reading[-1] == 0:
                raise InputError(one.name, "has one arm; a stuck arm is recognised only while other arms move")
            shown = np.unique(reading, return_index=True)[1]
            step = conditioning.stuck(list(radii[shown]), rows=self.settings.stuck)
            self._report_step(step, "readings")
            radii = np.where(step.dropped[reading], np.nan, radii)
        return replace(one, radii=tuple(radii))

    def _judged(self, one: Readings) -> Readings:
        """Return the readings of a tool with arms without those that the default steps drop; report what they find."""
        settings, arms = self.settings, _Arms(one)
        found = [conditioning.SuspectRows(*each) for each in _core.judge_rows(
            arms.depth, arms.toolface, arms.radii, one.places, self.bit_diameter,
            settings.drop_closed and settings.closed is None, settings.saturated, settings.spikes is not None,
            settings.spikes or 6.0,
        )]  # fmt: skip
        of = {cause: [each for each in found if each.cause in causes] for cause, causes in CAUSES.items()}
        self.report += [("arms", line) for line in arms.disagreements(of["arms"])]
        if settings.closed is None and of["closed"]:
            self._report_closed(one, of["closed"])
        if settings.saturated:
            self._report_saturated(one, arms, of["saturated"])
        if settings.stuck is None:
            self._warn_of_stuck(one, arms, of["stuck"])
        arms.drop(of["closed"] + of["saturated"])
        if of["spikes"]:
            self._report_spikes(one, arms, of["spikes"])
        arms.drop(of["spikes"])
        return replace(one, radii=tuple(arms.radii[column] for _, _, column in one.places))

    def _report_closed(self, one: Readings, found: Sequence[conditioning.SuspectRows]) -> None:
        """Report the rows in which all arms are closed, and the rows in which they close before and open after."""
        dropped = np.zeros(one.rows, dtype=bool)
        for at, each in enumerate(found):
            if each.cause != "closed":
                continue
            depth = one.depth[each.first : each.stop]
            depth = depth[np.isfinite(depth)]
            where = f"from {depth.min():.1f} to {depth.max():.1f} m" if depth.size else "in rows without a depth"
            before = [ramp.first for ramp in found[max(at - 1, 0) : at] if ramp.stop == each.first]
            after = [ramp.stop for ramp in found[at + 1 : at + 2] if ramp.first == each.stop]
            ramps, begin, end = "", (*before, each.first)[0], (*after, each.stop)[0]
            if before and np.isfinite(one.depth[begin]):
                ramps += f", close from {one.depth[begin]:.1f} m"
            if after and np.isfinite(one.depth[end - 1]):
                ramps += f", open until {one.depth[end - 1]:.1f} m"
            done = f"{end - begin:,} rows dropped"
            if not each.dropped:
                done = "kept, although the arms may be closed" + (
                    "" if self.bit_diameter else "; without a bit size, this may be casing"
                )
            dropped[begin:end] |= each.dropped
            self.report.append((
                "closed", f"{one.name}: all arms stay within 2 mm of a radius of {1e3 * each.radius:.1f} mm {where}"
                f"{ramps}: {done}"
            ))  # fmt: skip
        if dropped.any():
            self.counts["closed"] = self.counts.get("closed", 0) + int(np.count_nonzero(dropped))

    def _report_saturated(self, one: Readings, arms: _Arms, found: Sequence[conditioning.SuspectRows]) -> None:
        """Report the rows in which an arm has opened as far as it can."""
        for column, name in enumerate(arms.names):
            mine = [each for each in found if each.column == column]
            if mine:
                limit = mine[0].radius * (2.0 if arms.across[column] else 1.0)
                where = np.concatenate([one.depth[each.first : each.stop] for each in mine])
                kind = "diameter" if arms.across[column] else "radius"
                self.counts["saturated"] = self.counts.get("saturated", 0) + where.size
                self.report.append((
                    "saturated", f"{one.name}: {name} stays at its limit, a {kind} of {1e3 * limit:.1f} mm "
                    f"({limit / INCH:.2f} in): {where.size:,} rows between {where.min():.1f} and "
                    f"{where.max():.1f} m dropped"
                ))  # fmt: skip

    def _warn_of_stuck(self, one: Readings, arms: _Arms, found: Sequence[conditioning.SuspectRows]) -> None:
        """Report arms that stay at one value over many rows while the others move; nothing is dropped."""
        for column, name in enumerate(arms.names):
            mine = [each for each in found if each.column == column and np.isfinite(each.radius)]
            depth = np.concatenate([np.empty(0), *(one.depth[each.first : each.stop] for each in mine)])
            depth = depth[np.isfinite(depth)]
            if depth.size:
                self.report.append((
                    "stuck", f"{one.name}: {name} does not move in {depth.size:,} rows "
                    f"between {depth.min():.1f} and {depth.max():.1f} m while the other arms do: kept; "
                    f"preparation.stuck=ROWS drops them"
                ))  # fmt: skip

    def _report_spikes(self, one: Readings, arms: _Arms, found: Sequence[conditioning.SuspectRows]) -> None:
        """Report the spikes of a tool with few arms: dropped if the settings ask for it, else kept."""
        burst = sum(each.rows for each in found if each.cause == "burst")
        jump = sum(
            int(np.count_nonzero(np.isfinite(radius[each.first : each.stop])))
            for each in found if each.cause == "jump" for radius in arms.radii
        )  # fmt: skip
        if self.settings.spikes is None:
            self.report.append((
                "spikes", f"{one.name}: {burst + jump:,} readings look like spikes ({burst:,} of one arm, "
                f"{jump:,} in rows of all arms), the first at {one.depth[min(each.first for each in found)]:.2f} m: "
                "kept; preparation.spikes=6 drops them"
            ))  # fmt: skip
            return
        name, reasons = "spikes of arms", {"burst": burst, "row": jump}
        self.counts[name] = self.counts.get(name, 0) + burst + jump
        said = ", ".join(f"{count:,} {reason}" for reason, count in reasons.items() if count)
        self.report.append((name, f"dropped {burst + jump:,} of {one.rows * len(arms.radii):,} readings ({said})"))

    def _drop_single_samples(self) -> None:
        """Drop samples outside the interval or the range of radii, repeated samples and spikes."""
        settings = self.settings
        for name, of, low, high in (
            ("interval", "depth", settings.shallowest, settings.deepest),
            ("range", "radius", settings.least_radius, settings.greatest_radius),
        ):
            if low is not None or high is not None:
                low, high = -np.inf if low is None else low, np.inf if high is None else high
                self._drop(replace(conditioning.in_range(getattr(self.samples, of), low, high), name=name))
        samples = self.samples
        if settings.repeated:
            times = [] if samples.time is None else [samples.time]
            self._drop(conditioning.repeated_rows(samples.depth, samples.toolface, samples.radius, *times))
        elif samples.time is None:  # equal rows with times count only once in a wall
            share = conditioning.share_of_repeats(samples.depth, samples.toolface, samples.radius)
            if share > 0.01:
                text = (
                    f"{100 * share:.0f} % of the samples have the depth, toolface and radius of an earlier sample, and "
                    "count again"
                )
                self.report.append(("repeated", f"{text}; preparation.repeated=true drops them"))
        samples = self.samples
        for threshold, of_arms in ((settings.turn_spikes, False), (settings.spikes, True)):
            if threshold is not None:
                self._drop_spikes(threshold, of_arms)

    def _drop_spikes(self, threshold: float, of_arms: bool) -> None:
        """Drop samples that disagree with the turns beside theirs: of tools that turn, or of tools with few arms.

        Each row of a tool with few arms, which moves more than a metre in a rotation or does not turn, is a turn.
        One arm that does not turn has no turns.
        """
        samples, first = self.samples, 0
        turn = np.full(samples.depth.size, -1)
        for number, one in enumerate(self.readings):
            mine = np.flatnonzero(samples.file == number)
            own: Integers | None = None
            if not mine.size or (not (one.is_image or one.turning or self.settings.turn_height) and not of_arms):
                continue
            alone = not one.turning and len(one.sensors) == 1
            if one.is_image or alone or self.settings.turn_height:
                own = self._turns_of(one, mine)[0].astype(np.int64)
            elif one.turning:
                own = _core.turns_by_rotation(one.toolface, samples.row[mine], samples.depth[mine])
            if (own is None) is not of_arms:
                continue
            own = samples.row[mine] if own is None else own
            turn[mine] = own + (first - own.min())
            first = int(turn[mine].max()) + 4  # the turns of one file are not beside those of the next
        possible = (turn >= 0) & (samples.radius > 0.0) & (samples.radius <= LARGEST_RADIUS)  # others are errors
        judged = np.where(possible, samples.radius, np.nan)
        found = conditioning.spikes(samples.toolface, judged, turn, samples.depth, threshold=threshold)
        if found.dropped.any():
            self._drop(found)

    def _turns(self) -> tuple[Integers, Floats | None]:
        """Return the turn of each sample, and its position along the turns (None if not all turns are rotations).

        The samples of one turn are taken to be measured around the hole from one place.
        """
        turn = np.empty(self.samples.depth.size, dtype=np.int64)
        position = np.empty(turn.size)
        first, kinds = 0, set()
        for number, one in enumerate(self.readings):
            mine = np.flatnonzero(self.samples.file == number)
            position[mine], kind = self._turns_of(one, mine)
            turn[mine] = np.floor(position[mine])
            if mine.size:
                moved = first - turn[mine].min()
                turn[mine] += moved
                position[mine] += moved
                first = int(turn[mine].max()) + 2  # the centre is not interpolated from one file to the next
            kinds.add(kind)
        count = np.unique(turn, return_counts=True)[1]
        line = ("turns", f"{count.size:,}, by {' and '.join(sorted(kinds))}; samples in a turn: {np.median(count):g}")
        if line not in self.report:
            self.report.append(line)
        return turn, position if kinds == {"rotation"} else None

    def _turns_of(self, one: Readings, mine: Integers) -> tuple[Integers | Floats, str]:
        """Return the positions of one file's samples along its turns, and the report's words for what a turn is."""
        samples, height = self.samples, self.settings.turn_height
        if height is not None:
            depth = samples.depth[mine]
            offsets = np.array([sensor.offset for sensor in one.sensors])
            tool = depth + offsets[samples.sensor[mine]]
            passes = samples.pass_number[mine] if samples.pass_number.size else number_passes(tool)
            cells = np.floor((depth - depth.min(initial=0.0)) / height).astype(np.int64)
            return cells + passes * (int(cells.max(initial=0)) + 1), f"depth, {height:g} m each"
        if one.is_image:
            return samples.row[mine], "rows of an image"
        if not one.turning and samples.toolface.size:
            raise InputError(one.name, "no toolface shows the turns of the tool: give the height of a turn")
        rows = distinct(samples.row[mine])
        turned = np.zeros(one.rows)
        turned[rows] = turn_positions(one.toolface[rows])
        return turned[samples.row[mine]], "rotation"

    def _of_row(self, columns: Sequence[Typed[Number]]) -> Typed[Number]:
        """Return for each sample the value of its file's column at its row."""
        return self._at(columns, self.samples.row)

    def _at(self, columns: Sequence[Typed[Number]], place: Integers) -> Typed[Number]:
        """Return for each sample the value of its file's column at the index ``place``."""
        if len(columns) == 1:
            return columns[0][place]
        starts = np.cumsum([0, *(column.size for column in columns[:-1])])
        return np.concatenate(columns)[starts[self.samples.file] + place]

    def _arm_names(self) -> list[str]:
        return sorted({name for one in self.readings for name in one.channels})

    def _arm(self) -> Integers:
        """Return the number of each sample's wall channel; channels with one name have one number in all files."""
        names = self._arm_names()
        columns = [np.array([names.index(name) for name in one.channels])[one.arm] for one in self.readings]
        return self._at(columns, self.samples.sensor).astype(np.int64)

    def _number_passes(self) -> None:
        """Number the passes of the samples and report how: as the files do, one a file, or split at each reversal."""
        columns = self._pass_columns()
        again = _repeated_pass(columns)
        if again:
            file, number = again
            rule = f"pass {number} is in another file too; number the passes anew"
            raise InputError(self.readings[file].name, rule)
        passes = self._of_row(columns)
        self.samples = replace(self.samples, pass_number=passes)
        counted = ", ".join(f"{n} ({count:,})" for n, count in zip(*np.unique(passes, return_counts=True), strict=True))
        reversal = self.settings.reversal
        numbered = [one.pass_number is not None for one in self.readings]
        how = "as the files number them" if any(numbered) else "one for each file"
        if any(numbered) and not all(numbered):
            how += ", one for each file that numbers none"
        if reversal:
            how = f"split where the tool went back by {reversal:g} m"
        self.report.append(("passes", f"{how}; samples of each: {counted}"))

    def _pass_columns(self) -> list[Integers]:
        """Return for each file the pass of each of its rows; -1 for a row without a pass."""
        columns, first, reversal = [], 0, self.settings.reversal
        for one in self.readings:
            if reversal is not None:
                found = np.full(one.rows, -1, dtype=np.int64)
                known = np.flatnonzero(np.isfinite(one.depth))
                found[known] = number_passes(one.depth[known], reversal) + 1 + first
                first = int(found.max(initial=first))
            elif one.pass_number is not None:
                found = one.pass_number
                first = max(first, int(found.max(initial=0)))
            else:
                first += 1
                found = np.full(one.rows, first, dtype=np.int64)
            columns.append(found)
        return columns

    def _choose_passes(self) -> None:
        settings, number = self.settings, self.samples.pass_number
        strange = sorted({*(settings.passes or ()), *settings.earlier} - set(number.tolist()))
        if strange:
            there = ", ".join(map(str, distinct(number)))
            raise InputError(f"{self.names}: pass {strange[0]}", f"is not among the passes of the samples: {there}")
        if settings.passes is not None:
            self._drop(choose(number, self.samples.depth, sorted({*settings.passes, *settings.earlier})))

    def _shift(self) -> None:
        depth, toolface, number = self.samples.depth, self.samples.toolface, self.samples.pass_number
        rule = "is not among the passes of the samples"
        for one, shift in self.settings.shifts:
            if not (number == one).any():
                raise InputError(f"{self.names}: shift {one}={shift:g} m", rule)
            depth = np.where(number == one, depth + shift, depth)
            self.report.append(("shift", f"pass {one}: {shift:+.3f} m, as given"))
        for one, turn in self.settings.toolface_shifts:
            if not (number == one).any():
                raise InputError(f"{self.names}: toolface shift {one}={turn:g} deg", rule)
            toolface = np.where(number == one, wrapped(toolface + turn), toolface)
            self.report.append(("shift", f"pass {one}: toolfaces {turn:+.1f} degrees, as given"))
        if self.settings.find_shifts:
            from helibore.preparation.shifts import find_shifts

            held = [one for one, _ in self.settings.shifts]
            found = self.shifts = find_shifts(depth, toolface, self.samples.radius, number, held=held)
            depth = depth + found.at(number, depth)
            self.report += [("shift", line) for line in found.lines()]
        self.samples = replace(self.samples, depth=depth, toolface=toolface)

    def _across(self, number: int) -> Readings:
        """Return the readings of a file with toolfaces across the hole: those in the horizontal plane are projected.

        The direction of the hole at each row turns them, if the log has it.
        """
        one = self.readings[number]
        if self.references[number] != "horizontal-north" or one.hole is None or one.high_side is not None:
            return one
        with placed(one.name):
            turn = self._norths().turn(one.hole.north, one.north)
        known = np.isfinite(one.hole.inclination) & np.isfinite(one.hole.azimuth)
        near = np.maximum.accumulate(np.where(known, np.arange(one.rows), int(np.argmax(known))))
        inclination, azimuth = one.hole.inclination[near], one.hole.azimuth[near] + turn
        toolface = horizontal_to_north(one.toolface, inclination, azimuth)
        steepest = float(inclination.max())
        self.report.append((
            "toolface", f"{one.name}: angles in the horizontal plane turned across the hole, by the inclination (up to "
            f"{steepest:.1f} deg) and azimuth in the file"
        ))  # fmt: skip
        self.references[number] = "north"
        return replace(one, toolface=toolface)

    def _norths(self) -> Norths:
        return Norths(self.settings.declination, self.settings.convergence)

    def _refer_to_path(self) -> None:
        """Convert the toolfaces of the samples so that they count from the reference of the path."""
        path, settings = self.path, self.settings
        stated = self.references
        tagged = [settings.toolface_from is None and one.high_side is not None for one in self.readings]
        target = path.reference if path is not None else ""
        if target == "parallel-transport" and not all(t or s for t, s in zip(tagged, stated, strict=True)):
            rule = (
                "the wall's toolfaces count from a parallel-transport reference, but those of a tool never do; say "
                "whether its toolfaces count from north, from the high side, or automatically"
            )
            raise InputError(self.readings[0].name, rule)
        turns = [0.0] * len(self.readings)
        if path is not None:
            for number, one in enumerate(self.readings):
                with placed(one.name):
                    turns[number] = self._norths().turn(one.north, path.survey.north)
        kept = [s in ("", target) and not t and not (turn and s == "north")
                for t, s, turn in zip(tagged, stated, turns, strict=True)]  # fmt: skip
        if all(kept):
            return
        if path is None and set(stated) in ({"north"}, {"high-side"}, {"horizontal-north"}) and not any(tagged):
            norths = sorted({one.north for one in self.readings} - {""})
            if len(norths) > 1:
                rule = f"toolfaces count from {' and '.join(norths)} north: a survey and the declination turn them"
                raise InputError(self.names, rule)
            source = f"{''.join(norths)} {stated[0].removeprefix('horizontal-').replace('-', ' ')}".lstrip()
            self.report.append(("toolface", f"no survey: the wall's toolfaces count from {source}, as the samples do"))
            if stated[0] == "horizontal-north":
                self.report.append((
                    "toolface", "these angles lie in the horizontal plane, and nothing states the inclination: around "
                    "the hole they are wrong by up to 0.4 deg where it is 10 deg, 4 where it is 30, 20 where it is 60"
                ))  # fmt: skip
            return
        if path is None:
            source = {"north": "north", "high-side": "the high side"}.get(stated[0], "north and the high side")
            rule = f"toolfaces that count from {source} need a survey to be converted to the wall's reference"
            raise InputError(self.readings[0].name, rule)
        depth = self.samples.depth
        inside = (depth >= path.start_depth) & (depth <= path.stop_depth)
        if not inside.any():
            raise InputError(self.readings[0].name, "every sample lies beyond the survey")
        if not inside.all():
            beyond = self.counts["beyond the survey"] = int(np.count_nonzero(~inside))
            text = f"{beyond:,} samples beyond the survey: their toolface has no reference there"
            self.report.append(("dropped", text))
            self.samples = self.samples.select(inside)
        samples = self.samples
        high, flat, keep = np.zeros((3, samples.depth.size), dtype=bool)
        north, mounting = np.zeros((2, samples.depth.size))
        for number, one in enumerate(self.readings):
            mine, source = np.flatnonzero(samples.file == number), stated[number]
            if tagged[number] and one.high_side is not None:
                high[mine], source = one.high_side[samples.row[mine]], "by the file's tags"
            elif source == "automatic":
                down = np.clip(path.tangent(samples.depth[mine])[:, 2], -1.0, 1.0)
                high[mine] = from_high_side(np.degrees(np.arccos(down)), settings.steep, settings.level)
            elif kept[number]:
                keep[mine] = True
            elif source == "horizontal-north":
                flat[mine] = True
                mounting[mine] = np.array([each.mounting for each in one.sensors])[samples.sensor[mine]]
            else:
                high[mine] = source == "high-side"
            north[mine] = turns[number]
            share = f"{np.count_nonzero(high[mine]):,} of {mine.size:,} samples count from the high side"
            self.report.append(("toolface", f"{one.name}: reference {source or 'of the wall'}, {share}"))
        if not keep.all():
            with placed(self.names):
                # Across the hole an arm looks ``mounting`` beside the toolface, but not in the horizontal plane.
                tool = np.where(flat, samples.toolface - mounting, samples.toolface)
                turned = onto_path(tool, samples.depth, path, high, horizontal=flat, north=north)
            turned = np.where(flat, wrapped(turned + mounting), turned)
            self.samples = replace(samples, toolface=np.where(keep, samples.toolface, turned))

    def _recentre(self) -> None:
        samples = self.samples
        for one in self.readings:
            if any(one.across):
                name = one.channels[int(one.arm[one.across.index(True)])]
                rule = f"recentring needs radii: half a diameter ({name}) does not show the tool's offset"
                raise InputError(one.name, rule)
        self._require_possible_radii()
        turn, position = self._turns()
        files = [np.flatnonzero(samples.file == number) for number in range(len(self.readings))]
        columns = [self._centred(turn, position, mine) for mine in files if mine.size]
        found = self.centres = _joined_centres([each.centres for each in columns])
        row = np.searchsorted(found.turn, turn)
        self.centre_depth = np.bincount(row, samples.depth) / np.bincount(row)
        toolface, radius = samples.toolface.copy(), samples.radius.copy()
        for each in columns:
            toolface[each.mine], radius[each.mine] = each.toolface, each.radius
        self.samples = replace(samples, toolface=toolface, radius=radius)
        corrected = np.concatenate([each.corrected for each in columns])
        moved = distinct(turn[np.concatenate([each.mine for each in columns])[corrected]])
        lines = [f"{moved.size:,} of {found.turn.size:,} turns corrected"]
        known = np.isfinite(found.x)
        if known.any():
            far, sigma = found.eccentering[known], np.hypot(found.sigma_x, found.sigma_y)[known]
            lines[0] += (
                f"; offset of the tool {1e3 * np.median(far):.1f} mm (median), {1e3 * far.max():.1f} mm at most; "
                f"deviation of a centre {1e3 * np.median(sigma):.2f} mm (median)"
            )
        lines += [line for each in columns for line in each.lines]
        lost = ~known & (found.samples > 0)
        if lost.any() and self.bit_diameter is not None:
            depth = self.centre_depth[lost]
            lines.append(
                f"the centre is not known in {np.count_nonzero(lost):,} of {found.turn.size:,} turns, between "
                f"{depth.min():.1f} and {depth.max():.1f} m: the tool moves too far to be followed, the hole changes "
                "too much from turn to turn, or less than half of it is unworn"
            )
        self.report += [("recentre", line) for line in lines]

    def _centred(self, turn: Integers, position: Floats | None, mine: Integers) -> _Centred:
        """Return the samples of one file as seen from the axis, by the path of the centre or by each turn alone."""
        samples, bit = self.samples, self.bit_diameter
        toolface, radius, turns = samples.toolface[mine], samples.radius[mine], turn[mine]
        place = None if position is None else position[mine]
        path = None if place is None else find_centre_path(toolface, radius, place, bit)
        if path is not None and place is not None:
            numbers, row = np.unique(turns, return_inverse=True)
            count = np.bincount(row[np.isfinite(radius)], minlength=numbers.size)
            away, _, moves = path.at(place)
            moved = np.isfinite(radius) & (away != 0)
            wall = away + radius * np.exp(1j * np.radians(toolface))
            lines = []
            if not moves.all():
                lost = samples.depth[mine[~moves]]
                lines.append(
                    f"the tool's motion is not known in {100 * np.mean(~moves):.0f} % of the samples, between "
                    f"{lost.min():.1f} and {lost.max():.1f} m: not corrected there"
                )
            if bit is None:
                lines.append(
                    "no bit size: only the motion of the tool is corrected; where it rests off the axis looks like a "
                    "washout on one side"
                )
            return _Centred(
                mine, path.centres(numbers, count), wrapped(np.where(moved, np.degrees(np.angle(wall)), toolface)),
                np.where(moved, np.abs(wall), radius), moved, tuple(lines),
            )  # fmt: skip
        found = find_centres(toolface, radius, turns, bit_diameter=bit, position=place)
        if bit is None:
            line = "no bit size: not corrected, since an offset of the tool looks like a washout on one side"
            return _Centred(mine, found, wrapped(toolface), radius, np.zeros(mine.size, dtype=bool), (line,))
        at, distance = recentre(toolface, radius, turns, found, position=place)
        corrected = (found.share() > 0)[np.searchsorted(found.turn, turns)]
        return _Centred(mine, found, at, distance, corrected, ())

    def _subtract_bias(self) -> None:
        samples, arms, names = self.samples, self._arm(), self._arm_names()
        sides = self.settings.bias == "side"
        if sides:
            arms = arm_sides(arms, self._of_row([one.toolface for one in self.readings]), SIDES)
            names = [f"{name} at {360 // SIDES * side} deg" for name in names for side in range(SIDES)]
        columns = samples.depth, samples.toolface, samples.radius, samples.pass_number, arms
        found = self.bias = find_bias(*columns, sides=SIDES if sides else 1)
        self.samples = replace(samples, radius=samples.radius - found.at(samples.pass_number, arms))
        self.report.append(("bias", f"subtracted; noise of the corrected samples {1e3 * found.noise:.2f} mm"))
        shown = [names[number] for number in found.arms]
        self.report += [("bias", line) for line in (found.warnings(shown) if sides else found.lines(shown))]
        doubtful = found.doubtful()
        if doubtful.any():
            self._leave_out(found, doubtful, arms, shown)

    def _leave_out(self, found: Bias, doubtful: Mask, arms: Integers, names: list[str]) -> None:
        """Leave out the arms, in the passes, whose bias is not known; ``doubtful`` is (passes, arms) of ``found``."""
        samples = self.samples
        place = np.searchsorted(found.passes, samples.pass_number), np.searchsorted(found.arms, arms)
        out = doubtful[place]
        left = [f"{names[arm]} of pass {found.passes[row]}" for row, arm in np.argwhere(doubtful).tolist()]
        few = left if len(left) <= 6 else [*left[:5], f"{len(left) - 5} more"]
        self.counts["bias"] = int(np.count_nonzero(out))
        self.report.append((
            "bias", f"left out {self.counts['bias']:,} samples of {', '.join(few)}: the bias may exceed 1 mm and is "
            "not known"
        ))  # fmt: skip
        self.samples = samples.select(~out)

    def _stated_passes(self) -> Integers | None:
        """Return the pass number of each sample; if files repeat numbers, each file counts as one pass.

        Return None if there is one file and it numbers no passes.
        """
        samples = self.samples
        if samples.pass_number.size:
            return samples.pass_number
        if len(self.readings) == 1 and self.readings[0].pass_number is None:
            return None
        columns = self._pass_columns()
        return samples.file + 1 if _repeated_pass(columns) else self._of_row(columns)

    def _warn_of_bias(self) -> None:
        """Report if passes or arms disagree by more than their noise, judged by at most ``JUDGED`` samples."""
        samples, arms, number = self.samples, self._arm(), self._stated_passes()
        unsplit = number is None
        if number is None:
            number = _runs(self.readings[0].depth)[samples.row]
        if np.ptp(arms) == 0 and np.ptp(number) == 0:
            return
        some = np.arange(arms.size)
        if arms.size > JUDGED:
            some = distinct(np.random.default_rng(0).integers(0, arms.size, JUDGED))
        found = find_bias(
            samples.depth[some], samples.toolface[some], samples.radius[some], number[some], arms[some], rounds=3
        )
        names = self._arm_names()
        lines = found.disagreements([names[number] for number in found.arms])
        if lines:
            passes = "preparation.reversal=5m " if unsplit and np.ptp(number) else ""
            self.report.append(("bias", f"{lines[0]}; {passes}preparation.bias=arm subtracts it"))

    def _finished(self) -> Prepared:
        settings, earlier = self.settings, None
        used = settings.passes or distinct(self.samples.pass_number).tolist()
        chosen = [number for number in used if number not in settings.earlier]
        if settings.earlier:
            everything = self.samples
            self.samples = self._of_passes(everything, settings.earlier)
            earlier = self._caliper()
            if not chosen:
                rule = "all passes in use are earlier ones: no pass is left to make the wall from"
                raise InputError(f"{self.names}: earlier {_named(settings.earlier)}", rule)
            self.samples = self._of_passes(everything, chosen)
            compared = f"{_named(chosen)} beside earlier {_named(settings.earlier)}"
            ends = [(float(of.min()), float(of.max())) for of in (self.samples.depth, earlier.depth)]
            if max(top for top, _ in ends) > min(bottom for _, bottom in ends):
                mine, theirs = (f"{top:.1f} to {bottom:.1f} m" for top, bottom in ends)
                compared += f", which they do not overlap ({mine}, and {theirs}): no place has a difference"
            self.report.append(("compared", compared))
        if settings.latest:
            number, depth = self.samples.pass_number, self.samples.depth
            self._drop(choose(number, depth, chosen, latest=True))
        caliper = self._caliper()
        self.counts["kept"] = len(caliper)
        return Prepared(
            caliper, tuple(self.report), self.counts, self._stated_passes(), self.centres, self.centre_depth,
            self.shifts, self.bias, earlier, tuple(self._arm_names()), self._echo_accuracy(),
        )  # fmt: skip

    def _echo_accuracy(self) -> dict[str, Any] | None:
        if not self.velocity:
            return None
        depth = self.samples.depth
        return echo_accuracy(self.velocity, float(depth.min()), float(depth.max()))

    @staticmethod
    def _of_passes(samples: Samples, passes: Sequence[int]) -> Samples:
        return samples.select(choose(samples.pass_number, samples.depth, passes).kept)

    def _require_possible_radii(self) -> None:
        samples = self.samples
        valid = (samples.radius > 0.0) & (samples.radius <= LARGEST_RADIUS)
        if not valid.all():
            at = int(np.argmin(valid))
            one = self.readings[int(samples.file[at])]
            channel = one.channels[int(one.arm[int(samples.sensor[at])])]
            place = f"{one.name}, {one.place(int(samples.row[at]))}, column {channel}"
            limit = "greatest_radius" if samples.radius[at] > LARGEST_RADIUS else "least_radius"
            rule = f"must be above 0 and at most {LARGEST_RADIUS:g} m; preparation.{limit} drops such radii; "
            rule += f"if the number of the file means no value, {say_so()}"
            raise InputError(f"{place}: radius {samples.radius[at]:g} m", rule, setting=f"preparation.{limit}")

    def _caliper(self) -> Caliper:
        self._require_possible_radii()
        samples = self.samples
        few = all(len(one.sensors) > 1 and not one.is_image for one in self.readings) and not self.settings.recentre
        return Caliper(samples.depth, samples.toolface, samples.radius, samples.time, arm=self._arm() if few else None)


@dataclass(frozen=True)
class _Centred:
    """The samples of one file as seen from the hole's axis."""

    mine: Integers  # which samples these are, (n,)
    centres: Centres
    toolface: Floats  # degrees, (n,)
    radius: Floats  # m, (n,)
    corrected: Mask  # (n,)
    lines: tuple[str, ...]  # of the report


def _joined_centres(parts: Sequence[Centres]) -> Centres:
    if len(parts) == 1:
        return parts[0]
    return Centres(*(np.concatenate([getattr(each, of.name) for each in parts]) for of in fields(Centres)))


class _Arms:
    """The columns of readings of a tool with arms: one for each radius or diameter."""

    def __init__(self, one: Readings) -> None:
        places = [column for _, _, column in one.places]
        shown = [places.index(column) for column in range(places[-1] + 1)]
        self.one = one
        self.depth, self.toolface = contiguous("depth", one.depth), contiguous("toolface", one.toolface)
        self.radii = [contiguous(f"radii[{sensor}]", one.radii[sensor], one.rows, "depth") for sensor in shown]
        self.names = [one.channels[int(one.arm[sensor])] for sensor in shown]
        self.across = [one.across[sensor] for sensor in shown]

    def drop(self, found: Sequence[conditioning.SuspectRows]) -> None:
        """Blank the readings of suspect rows that are dropped; the columns of the host do not change."""
        dropped = [each for each in found if each.dropped]
        for column, radius in enumerate(self.radii):
            mine = [each for each in dropped if each.column in (-1, column)]
            if mine:
                left = radius.copy()
                for each in mine:
                    left[each.first : each.stop] = np.nan
                self.radii[column] = left

    def disagreements(self, found: Sequence[conditioning.SuspectRows]) -> list[str]:
        """Return a sentence for each two columns that look in the same direction and differ.

        Raises an InputError if a pair differs in at least half of the rows in which both have a radius.
        """
        lines, depth = [], self.one.depth
        for pair in dict.fromkeys((each.column, each.other) for each in found):
            mine = [each for each in found if (each.column, each.other) == pair]
            place = f"{self.one.name}: {' and '.join(self.names[column] for column in pair)}"
            if mine[0].radius > APART:
                apart_by = f"{1e3 * mine[0].radius:.1f} mm of radius in half of the rows"
                rule = f"look in the same direction and differ by {apart_by}: name the caliper to use"
                raise InputError(place, rule)
            longest = max(mine, key=lambda each: each.rows)
            lines.append(
                f"{place} look in the same direction and differ by more than {1e3 * APART:.1f} mm of radius in "
                f"{sum(each.rows for each in mine):,} rows, the longest stretch from {depth[longest.first]:.2f} to "
                f"{depth[longest.stop - 1]:.2f} m: name the caliper to use"
            )
        return lines


def _tracked(one: Readings, track: Track | None) -> Readings:
    """Return the readings with the depth and the toolface that a track has at the time of each row."""
    if track is None or one.time is None:
        return one
    placed_by_time = replace(one, depth=track.depth.at(one.time))
    if track.toolface is None:
        return placed_by_time
    return replace(placed_by_time, toolface=track.toolface.at(one.time), turning=True)


def _repeated_pass(columns: Sequence[Integers]) -> tuple[int, int] | None:
    """Return the index of the first file that repeats a pass number of an earlier file, and the number; or None."""
    seen: set[int] = set()
    for file, column in enumerate(columns):
        numbers = set(distinct(column).tolist()) - {-1}
        if again := numbers & seen:
            return file, min(again)
        seen |= numbers
    return None


def _named(passes: Sequence[int]) -> str:
    return f"pass{'es' * (len(passes) > 1)} {', '.join(map(str, passes))}"


def _runs(depth: Floats) -> Integers:
    """Return the number of the run, up or down the hole, of each row of a file without passes, counted from 1.

    If the tool turns back too often, all rows are run 1.
    """
    numbers = np.ones(depth.size, dtype=np.int64)
    known = np.flatnonzero(np.isfinite(depth))
    run = number_passes(depth[known])
    if not run.size or run[-1] == 0:
        return numbers
    count = np.bincount(run)
    long = count >= 0.01 * known.size  # shorter runs are single rows that turn back
    if 2 <= np.count_nonzero(long) <= MOST_PASSES and count[~long].sum() <= 0.01 * known.size:
        numbers[known] = np.maximum(np.cumsum(long), 1)[run]
    return numbers
