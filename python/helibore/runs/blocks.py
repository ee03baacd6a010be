"""Rebuild a well larger than a worker's memory in blocks of the helix, with exactly the same results as in one piece.

    samples, batch by batch --> bins by depth    plan: ends of the helix, blocks of 256 turns or multiples, first radius
    bins of a block, and what its vertices reach --> stretch of the wall --> archive, rows of logs      one task a block
    rows and radii of all blocks --> logs, zones, overview, record                                      the merge

Samples keep their order of arrival in a bin, so that ties are resolved as for a well in one piece. A block reads more
bins until `Wall.reach` shows that no other sample can change its vertices. Samples that fit in memory are prepared as
for any well. Otherwise the samples are read from Parquet as a stream, and steps that need all samples (finding shifts,
biases, flat tops, closed arms) are refused. In both cases a kriging range that must be found, images, earlier
passes to compare with, walls that are not measured around the hole, and tools of two to seven arms are refused.
"""

from __future__ import annotations

import math
import secrets
import zlib
from bisect import bisect_right
from collections import Counter
from collections.abc import Callable, Iterable, Iterator
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np

from helibore.base.arrays import Floats
from helibore.base.atomic_file import write_whole
from helibore.base.errors import InputError
from helibore.channels.channel_readings import readings
from helibore.channels.log_set import LogSet
from helibore.files.columnar import parquet_values
from helibore.files.raw_set import Channel
from helibore.logs.late_columns import LateColumns
from helibore.logs.likely_kinds import PARTS
from helibore.logs.log_columns import WORN
from helibore.logs.turn_logs import COLUMN_NAMES, RUGOSITY_WINDOW, Logs, sections_of, turn_logs, window_turns
from helibore.preparation.conditioning import in_range
from helibore.preparation.prepare import Prepared
from helibore.preparation.sensors import observe_by_depth
from helibore.runs.output_store import Json, Store
from helibore.runs.project import Input
from helibore.runs.run import Run, interval, no_samples, tables_to_keep
from helibore.samples.caliper import LARGEST_RADIUS, Basis, Caliper, basis_text
from helibore.settings.wall_settings import Settings
from helibore.trajectory.survey import Path as WellPath
from helibore.wall.wall import Wall

UNIT = 256
"""Turns; each block begins at a multiple of this number, as do the blocks in which the core computes logs."""
BIN_TURNS = 64
"""Height of a bin, turns."""
CROWDED = 4
"""A block of `UNIT` turns, the smallest block, may have this many times `block_samples` samples, 100 bytes each."""
VERTICES = 2
"""A well in one piece may have this many times `block_samples` vertices, 160 bytes each."""
TURNS = 2_000_000
"""Most turns of a well in blocks; the merge holds the logs of all turns, 300 bytes a turn."""
BATCH = 1 << 18
"""Rows read at a time."""
AS_STREAM: dict[str, Any] = {"pre_buffer": False, "buffer_size": 1 << 20, "page_checksum_verification": True}
"""Options with which a Parquet file needs little memory, even with large row groups; a pre-buffer keeps all rows."""
BY_ROW = ("shallowest", "deepest", "least_radius", "greatest_radius", "sensor_offset", "saturated", "drop_closed")
"""Settings of a preparation that a well read as a stream may change; the last two must be changed to false."""


Batches = Iterable[tuple[Floats, ...]]
"""Depth, toolface, radius and, if it is known, time of samples, part by part, in the order of the samples."""


def needs_stream(run: Run, most_samples: int) -> bool:
    """Return whether the caliper files of a run have more than ``most_samples`` rows, and are read as a stream."""
    return sum(run.files.log_set(each).rows for each in run.settings.caliper) > most_samples


def prepared_batches(run: Run, samples: tuple[str, Caliper | Prepared] | None, most_samples: int) -> Batches | None:
    """Return the prepared samples of a well that has too many vertices for one piece, as one batch.

    Return None if the well fits in one piece, or if it is an archive, which has no ``samples`` to prepare. Raise
    InputError if the run has a setting that a well in blocks cannot have; the error names the first such setting.
    """
    if samples is None:
        return None
    name, made = samples
    caliper = made if isinstance(made, Caliper) else made.caliper
    vertices = _helix(_settings(run), (float(caliper.depth.min()), float(caliper.depth.max())))["vertices"]
    if vertices <= VERTICES * most_samples:
        return None
    blocks = f"a well of {vertices:,} vertices is made in blocks; raise block_samples or the pitch"
    why = f"needs the whole well, but {blocks}"
    _check_settings(run, why)
    if caliper.basis != "azimuthal":
        raise InputError(name, f"a wall that no azimuthal caliper measured {why}")
    if caliper.arm is not None:
        raise InputError(name, f"a tool of two to seven arms {why}")
    if not isinstance(made, Caliper) and made.earlier is not None:
        raise InputError("preparation", f"comparing with earlier passes {why}")
    columns = (caliper.depth, caliper.toolface, caliper.radius)
    return [columns if caliper.time is None else (*columns, caliper.time)]


def _check_settings(run: Run, why: str) -> None:
    if run.settings.image:
        raise InputError("image", why)
    wall = _settings(run)
    if wall.estimator == "automatic":
        rule = f"must be another one, because choosing it {why}"
        raise InputError("wall.estimator", rule, "'automatic'", "wall.estimator")
    if wall.estimator == "kriging" and wall.kriging_range is None:
        rule = f"must be a number, because finding it {why}"
        raise InputError("wall.kriging_range", rule, setting="wall.kriging_range")


def stream(run: Run, most_samples: int) -> Batches:
    """Return the samples of a well with more rows than fit in memory, as batches that are read when needed.

    Raise InputError if the run has a setting that such a well cannot have; the error names the first such setting.
    """
    why = f"needs the whole well, but a well of more than {most_samples:,} samples is made in blocks"
    settings, preparation = run.settings, run.settings.preparation
    only, *others = settings.caliper
    if others or run.files.log(only.file).format != "parquet":
        raise InputError("caliper", f"blocks are read from one Parquet file; anything else {why}")
    if settings.track:
        raise InputError("track", why)
    odd = [name for name in preparation.changed() if name not in BY_ROW]
    odd += [name for name in ("saturated", "drop_closed") if getattr(preparation, name)]
    if odd:
        rule = f"{why}; it must be false" if odd[0] in BY_ROW else why
        place = f"preparation.{odd[0]}"
        raise InputError(place, rule, str(getattr(preparation, odd[0])), place)
    if settings.echo is not None and (settings.echo.casing or settings.echo.velocity_sigma):
        place = "echo.casing" if settings.echo.casing else "echo.velocity_sigma"
        raise InputError(place, why, setting=place)
    _check_settings(run, why)
    turning = only.roles.one("toolface")
    if turning is not None and turning.reference not in ("", run.path.reference if run.path else ""):
        raise InputError("toolface", f"turning toolfaces into the reference of the path {why}")
    return sample_batches(run, only)


def plan_well(run: Run, store: Store, folder: str, made_from: Json, most_samples: int, batches: Batches) -> Json:
    """Sort the samples of a well into bins by depth and plan its blocks; store bins, then plan; return the plan.

    If the store already has a plan that was made from the same files and settings, return that plan.
    """
    name = f"{folder}/plan.json"
    before: Json | None = store.read_checked(name)
    if before is not None and before["made_from"] == made_from:
        return before
    store.delete(list(store.sizes(folder)))
    wall = _settings(run)
    height = BIN_TURNS * abs(wall.pitch)
    counts: Counter[int] = Counter()
    sums: dict[int, int] = {}
    ends, newest, width = [math.inf, -math.inf], -math.inf, 3
    bins = f"{folder}/bins-{secrets.token_hex(4)}"
    with store.writing_folder(bins) as into:
        for depth, *others in batches:
            rows = np.stack([depth, *others], axis=1)
            ends = [min(ends[0], float(depth.min())), max(ends[1], float(depth.max()))]
            width = rows.shape[1]
            if width > 3:
                newest = max(newest, float(others[-1].max()))
            number = np.floor(depth / height).astype(np.int64)
            order = np.argsort(number, kind="stable")  # samples of a bin keep their order
            for part in np.split(order, np.flatnonzero(np.diff(number[order])) + 1):
                at = int(number[part[0]])
                counts[at] += part.size
                content = rows[part].tobytes()
                sums[at] = zlib.crc32(content, sums.get(at, 0))
                with (into / str(at)).open("ab") as file:
                    file.write(content)
    if not counts:
        raise InputError(run.settings.caliper[0].file.name, "no row has depth, toolface and a radius")
    top, bottom = interval(wall)
    if ends[1] < top or ends[0] > bottom:
        raise no_samples(run.settings.caliper[0].file.name, (ends[0], ends[1]), wall)
    plan = _helix(wall, (ends[0], ends[1]))
    vertices, turns = plan["vertices"], plan["vertices"] // wall.sectors
    span = "the wall from {start_depth:g} m to {stop_depth:g} m would have".format_map(plan)
    if not 0 < vertices <= wall.most_vertices:
        rule = f"{span} {vertices:,} vertices; it may have 1 to {wall.most_vertices:,}"
        raise InputError("most_vertices", rule, setting="wall.most_vertices")
    if turns > TURNS:
        rule = f"{span} {turns:,} turns, of which {TURNS:,} fit in memory"
        raise InputError("pitch", rule, f"{wall.pitch:g}", "wall.pitch")
    plan |= {"made_from": made_from, "bins": bins, "height": height, "width": width, "ends": ends}
    plan |= {"counts": {str(at): counts[at] for at in sorted(counts)}, "newest": newest if width > 3 else 0.0}
    plan["checksums"] = {str(at): sums[at] for at in sorted(counts)}
    plan["blocks"] = _blocks(wall, plan, most_samples)
    plan["reference"] = _first_radius(store, plan, wall)
    store.write_checked(name, plan)
    return plan


def read_plan(store: Store, folder: str) -> Json:
    """Return the plan that `plan_well` stored; raise InputError if the plan is missing or damaged."""
    plan: Json | None = store.read_checked(f"{folder}/plan.json")
    if plan is None:
        raise InputError(f"{folder}/plan.json", "is missing or damaged: start again")
    return plan


def sample_batches(run: Run, only: Input) -> Iterator[tuple[Floats, ...]]:
    """Yield depth, toolface, radius and, if known, time of a Parquet file's samples, batch by batch, in file order."""
    from pyarrow import parquet

    preparation = run.settings.preparation
    bit = run.settings.wall.bit_diameter if run.settings.wall else None
    log, names = run.files.log_set(only), [role.channel for role in only.channel if role.role != "none"]
    with parquet.ParquetFile(only.file, **AS_STREAM) as file:
        for batch in _undamaged(only.file.name, file.iter_batches(BATCH, columns=names)):
            channels = []
            for name in batch.schema.names:
                values, of = parquet_values(batch.column(name)), log[name]
                made = Channel(name, of.unit, "", values, run.settings.nulls, None, values.shape, of.is_text)
                made.nan_is_missing = False
                channels.append(made)
            found = readings(LogSet(only.file, "table", channels, batch.num_rows), only.roles, bit, run.settings.echo)
            if (len(found.sensors) > 1 and not found.is_image) or any(of.latency for of in found.sensors):
                raise InputError(only.file.name, "a tool of two to seven arms, or a latency, needs the whole well")
            sensors = [replace(of, offset=of.offset + preparation.sensor_offset) for of in found.sensors]
            samples = observe_by_depth(sensors, found.depth, found.toolface, found.radii)
            keep = _between(samples.depth, preparation.shallowest, preparation.deepest)
            keep &= _between(samples.radius, preparation.least_radius, preparation.greatest_radius)
            columns = [samples.depth, samples.toolface, samples.radius]
            if found.time is not None:
                columns.append(found.time[samples.row])
                keep &= ~np.isnan(columns[-1])
            if not keep.any():
                continue
            odd = keep & ~((samples.radius > 0) & (samples.radius <= LARGEST_RADIUS))
            if odd.any():
                rule = f"must be above 0 and at most {LARGEST_RADIUS:g} m; a radius range drops such radii"
                raise InputError(f"{only.file.name}: radius", rule, f"{samples.radius[odd][0]:g}")
            yield tuple(column[keep] for column in columns)


def _undamaged(name: str, batches: Iterator[Any]) -> Iterator[Any]:
    """Yield the batches of a Parquet file; if it is damaged, raise an InputError that names the file."""
    from pyarrow import ArrowException

    try:
        yield from batches
    except (ArrowException, OSError) as error:
        raise InputError(name, f"truncated or damaged Parquet ({str(error).splitlines()[0]})") from error


def _between(values: Floats, low: float | None, high: float | None) -> Any:
    if low is None and high is None:
        return np.ones(values.size, dtype=bool)
    return in_range(values, -math.inf if low is None else low, math.inf if high is None else high).kept


def _settings(run: Run) -> Settings:
    if run.settings.wall is None:
        raise RuntimeError("a well in blocks without settings; this is a bug in helibore")
    return run.settings.wall.resolved(later=True)


def _helix(wall: Settings, ends: tuple[float, float]) -> Json:
    """Return start, stop, number of vertices and last depth of the helix of a well.

    ``ends`` are the least and the greatest depth of its samples; they apply where the settings state no end.
    """
    start, stop = ends if wall.pitch > 0 else ends[::-1]
    start = start if wall.start_depth is None else wall.start_depth
    stop = stop if wall.stop_depth is None else wall.stop_depth
    plan: Json = {"start_depth": start, "stop_depth": stop}
    vertices = _vertex_count(wall, plan)
    return plan | {"vertices": vertices, "last_depth": start + (vertices - 1) * wall.pitch / wall.sectors}


def _vertex_count(settings: Settings, plan: Json) -> int:
    """Return the number of vertices of the whole well, as the core counts them."""
    turns: float = settings.sectors * (plan["stop_depth"] - plan["start_depth"]) / settings.pitch
    return max(0, math.floor(turns) + 1)


def _blocks(wall: Settings, plan: Json, most_samples: int) -> list[list[int]]:
    """Return the turns [start, stop) of the blocks: multiples of `UNIT` turns with about ``most_samples`` samples."""
    turns = -(-plan["vertices"] // wall.sectors)
    found: list[list[int]] = []
    for first in range(0, turns, UNIT):
        stop = min(first + UNIT, turns)
        if found and _sample_count(wall, plan, found[-1][0], stop) <= most_samples:
            found[-1][1] = stop
        else:
            found.append([first, stop])
            counted = _sample_count(wall, plan, first, stop)
            if counted > CROWDED * most_samples:
                rule = f"{UNIT} turns from {plan['start_depth'] + first * wall.pitch:.6g} m on have {counted:,}"
                raise InputError(
                    "block_samples",
                    f"{rule} samples or vertices; must be at least 1/{CROWDED} of this number",
                    f"{most_samples}",
                )
    return found


def _sample_count(wall: Settings, plan: Json, first: int, stop: int) -> int:
    """Return how many samples the bins of turns [first, stop) have, or how many vertices if these are more."""
    ends = sorted(plan["start_depth"] + turn * wall.pitch for turn in (first, stop))
    low, high = (math.floor(end / plan["height"]) for end in ends)
    counted: int = sum(plan["counts"].get(str(at), 0) for at in range(low, high + 1))
    return max(counted, (stop - first) * wall.sectors)


def _samples_between(store: Store, plan: Json, low: float, high: float) -> list[Floats]:
    """Return depth, toolface, radius and any time of the samples between two depths; each bin keeps its order."""
    first, last = (math.floor(end / plan["height"]) for end in (max(low, plan["ends"][0]), min(high, plan["ends"][1])))
    parts = [np.empty((0, plan["width"]))]
    for at in range(first, last + 1):
        if str(at) in plan["counts"]:
            try:
                rows = store.read_array(f"{plan['bins']}/{at}", plan["checksums"][str(at)])
            except InputError as error:
                store.delete([f"{plan['bins'].rpartition('/')[0]}/plan.json"])
                raise InputError(error.place, f"{error.rule}: start again, and the samples are sorted again") from error
            rows = rows.reshape(-1, plan["width"])
            parts.append(rows[(rows[:, 0] >= low) & (rows[:, 0] <= high)])
    return list(np.concatenate(parts).T.copy())


def stretch(store: Store, plan: Json, settings: Settings, first: int, stop: int) -> Wall:
    """Return a wall of the vertices [first, stop), exactly as in the whole well; empty if no samples are near."""
    own = {"start_depth": plan["start_depth"], "stop_depth": None, "first_vertex": first, "stop_vertex": stop}
    step = settings.pitch / settings.sectors
    shallow, deep = sorted((plan["start_depth"] + first * step, plan["start_depth"] + stop * step))
    up = down = max(1.001 * (settings.max_distance or 1.0), settings.gap_reach)
    limited = settings.max_distance is not None and settings.window is None and settings.estimator != "near-and-far"
    low, high = shallow - up, deep + down
    while True:
        wall = Wall(threads=1, **vars(settings) | own)
        columns = _samples_between(store, plan, low, high)
        if columns[0].size:
            wall.append(*columns)
        if limited:
            return wall
        least, most = wall.reach(first, stop) if len(wall) else (-math.inf, math.inf)
        is_low, is_high = least >= low or low <= plan["ends"][0], most <= high or high >= plan["ends"][1]
        if is_low and is_high:
            return wall
        if not is_low:
            low, up = max(least, -_beyond_gap(plan, -low, -1) - up), 2 * up
        if not is_high:
            high, down = min(most, _beyond_gap(plan, high, 1) + down), 2 * down


def _beyond_gap(plan: Json, along: float, sign: int) -> float:
    """Return ``along`` (a depth times ``sign``), or where the next bin with samples begins, if that is farther on."""
    edges = (min(sign * at * plan["height"], sign * (at + 1) * plan["height"]) for at in map(int, plan["counts"]))
    reached = along - plan["height"]  # the bin that contains ``along`` may have samples farther on
    return max(along, min((edge for edge in edges if edge >= reached), default=along))


def radii(wall: Wall, count: int) -> tuple[Floats, Floats]:
    """Return radius and nearest of the ``count`` vertices of a stretch; all are NaN if the stretch has no samples."""
    nothing = np.full(count, np.nan)
    return (wall.radius, wall.nearest) if len(wall) else (nothing, nothing)


def _first_radius(store: Store, plan: Json, settings: Settings) -> float:
    """Return the first radius that is not missing; it is the reference of `turn_logs`. Return 0 if all are missing."""
    for first, last in plan["blocks"]:
        for turn in range(first, last, UNIT):
            ends = turn * settings.sectors, min((turn + UNIT) * settings.sectors, plan["vertices"])
            radius = stretch(store, plan, settings, *ends).radius
            there = radius[np.isfinite(radius)]
            if there.size:
                return float(there[0])
    return 0.0


def make_block(run: Run, store: Store, folder: str, number: int, archive: str | None) -> None:
    """Write the archive of a block, if ``archive`` names its file, then its part for the merge: logs, radii, overview.

    If these files exist, nothing is done. A block without samples has no archive.
    """
    plan, part = read_plan(store, folder), _part_file(folder, number)
    if part in store.sizes(folder) and (archive is None or store.has(archive)):
        return
    settings, (first, stop) = _settings(run), plan["blocks"][number]
    K, last = settings.sectors, number + 1 == len(plan["blocks"])
    margin = window_turns(RUGOSITY_WINDOW, settings.pitch) // 2
    begin, end = max(0, first - margin) * K, min((stop + margin) * K, plan["vertices"])
    wall = stretch(store, plan, settings, begin, end)
    wall.path, wall.made_from = run.path, {"files": plan["made_from"]["inputs"]}
    if tables := tables_to_keep(run.settings):
        wall.made_from["project"] = tables
    radius, nearest = radii(wall, end - begin)
    state = replace(wall._state(), start_depth=plan["start_depth"], radius=radius, nearest=nearest)
    logs = turn_logs(state, None, threads=1, reference=plan["reference"], newest=plan["newest"])
    rows = slice(first - begin // K, min(stop, plan["vertices"] // K) - begin // K)
    own = slice(first * K - begin, min(stop * K, plan["vertices"]) - begin)
    ends = [-math.inf if not number else _turn_depth(settings, plan, first)]
    ends.append(math.inf if last else _turn_depth(settings, plan, stop))
    along = math.copysign(1.0, settings.pitch) * state.sample_columns[0]
    inside = (along >= ends[0]) & (along < ends[1])
    coarse = overview_settings(settings)
    coarse_first = first * OVERVIEW_SECTORS // COARSER
    coarse_stop = _vertex_count(coarse, plan) if last else stop * OVERVIEW_SECTORS // COARSER
    made: dict[str, Any] = {name: getattr(logs, name)[rows] for name in COLUMN_NAMES} | {**logs.worn.between(rows)}
    made |= {"vertex_radius": radius[own], "vertex_nearest": nearest[own], "samples": np.count_nonzero(inside)}
    made["section"] = logs.section[rows]
    made["overview"] = radii(stretch(store, plan, coarse, coarse_first, coarse_stop), coarse_stop - coarse_first)[0]
    if archive is not None and len(wall):
        with store.writing(archive) as path:
            wall.save(path)
    with store.writing(part) as path:
        write_whole(path, lambda file: np.savez(file, **made))


def _turn_depth(settings: Settings, plan: Json, turn: int) -> float:
    """Return the depth of the first vertex of a turn, negated if the helix goes up, so that it grows with the turn."""
    return float(plan["start_depth"] + turn * settings.pitch) * math.copysign(1.0, settings.pitch)


class PartColumn:
    """A value for each vertex of a well, sliced like an array; beside the slice, one block's values are in memory."""

    def __init__(self, read: Callable[[int], Floats], stops: list[int]) -> None:
        """``read`` returns the values of a block; ``stops`` holds the vertex before which each block ends."""
        self._read, self._stops, self.size = read, stops, stops[-1]
        self._number, self._values = -1, np.empty(0)

    def __getitem__(self, span: slice) -> Floats:
        first, stop, _ = span.indices(self.size)
        found = np.empty(max(stop - first, 0))
        for number in range(bisect_right(self._stops, first), len(self._stops)):
            begin = self._stops[number - 1] if number else 0
            if begin >= stop:
                break
            if number != self._number:
                self._number, self._values = number, self._read(number)
            part = self._values[max(first - begin, 0) : stop - begin]
            at = max(begin - first, 0)
            found[at : at + part.size] = part
        return found


class Merged(NamedTuple):
    """A well of which all blocks are made. It has no samples; logs, zones, summary and overview do not need them."""

    settings: Settings
    start_depth: float
    radius: Any  # as an array, or in parts: `PartColumn`
    nearest: Any
    sample_count: int
    path: WellPath | None
    basis: Basis = "azimuthal"


def merged(run: Run, store: Store, folder: str) -> tuple[Merged, Logs, Merged]:
    """Return a well, its logs and its overview, read from the parts that its blocks left in ``folder``."""
    plan, settings = read_plan(store, folder), _settings(run)
    coarse, blocks = overview_settings(settings), range(len(plan["blocks"]))

    def of_vertices(name: str) -> PartColumn:
        stops = [min(stop * settings.sectors, plan["vertices"]) for _, stop in plan["blocks"]]
        return PartColumn(lambda number: store.read_arrays(_part_file(folder, number), name)[0], stops)

    rooms = {"overview": _vertex_count(coarse, plan), "samples": len(blocks)}
    rooms |= dict.fromkeys((*COLUMN_NAMES, *WORN), plan["vertices"] // settings.sectors)
    rooms["section"] = plan["vertices"] // settings.sectors * PARTS
    columns: dict[str, Any] = {name: np.empty(room) for name, room in rooms.items()}
    filled = Counter[str]()
    for number in blocks:
        part = _part_file(folder, number)
        for (name, column), values in zip(columns.items(), store.read_arrays(part, *columns), strict=True):
            column[filled[name] : filled[name] + values.size] = values.ravel()
            filled[name] += values.size
    overview, count = columns.pop("overview"), int(columns.pop("samples").sum())
    section = columns.pop("section").reshape(-1, PARTS)
    worn = {name: columns.pop(name) for name in WORN}
    radius, nearest = of_vertices("vertex_radius"), of_vertices("vertex_nearest")
    wall = Merged(settings, plan["start_depth"], radius, nearest, count, run.path)
    over = Merged(coarse, plan["start_depth"], overview, None, count, run.path)
    logs = Logs(
        bit_diameter=settings.bit_diameter, sectors=settings.sectors, pitch=settings.pitch, basis=wall.basis,
        basis_text=basis_text(wall.basis),
        rugosity_window=window_turns(RUGOSITY_WINDOW, settings.pitch) * abs(settings.pitch),
        reference=run.path.reference if run.path is not None else "", path=run.path,
        worn=LateColumns(WORN, lambda: worn), sections=sections_of(lambda: section),
        **columns,
    )  # fmt: skip
    return wall, logs, over


def _part_file(folder: str, number: int) -> str:
    """Return the name of the file that a block leaves for the merge."""
    return f"{folder}/part-{number:05}.npz"


COARSER = 16
"""Turns of a wall in one turn of its overview, which has `OVERVIEW_SECTORS` sectors."""
OVERVIEW_SECTORS = 16


def overview_settings(settings: Settings) -> Settings:
    """Return the settings of an overview of a wall; the overview has 1/64 of the vertices of a wall of 64 sectors."""
    return replace(settings, pitch=COARSER * settings.pitch, sectors=OVERVIEW_SECTORS)
