"""A run: from files to a wall, stage by stage, and the settings that repeat it. Commands and `hb.reprocess` use it.

    run = make_wall(open_run(read_project("well.toml")))     # also "wall.glb.toml": the same to the last bit
    run.wall.surface().save("again.glb")

    caliper files --readings--> --prepare--> samples --> wall     (or an average caliper, a gauge hole, an archive)
    survey --> wall.path        images --> wall.images

A `Project` decides every byte of the output. ``helibore.cli`` reads options and prints.
"""

from __future__ import annotations

import hashlib
import json
import os
from collections.abc import Callable, Collection, Iterator, Mapping
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import AbstractContextManager, contextmanager, nullcontext
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from helibore._core import __version__
from helibore.base.errors import InputError
from helibore.base.regular_file import check_regular
from helibore.base.toml_file import read_toml
from helibore.channels.channel_readings import note, readings
from helibore.channels.columns import column, depths, needed
from helibore.channels.depth_remarks import depth_remarks
from helibore.channels.header_entries import log_header
from helibore.channels.log_set import LogFile, LogSet
from helibore.channels.opening import open_file
from helibore.channels.role_map import parse_options, read_map
from helibore.channels.roles import RoleMap, guess
from helibore.files.input_file import ReadOptions
from helibore.images.sector_image import SectorImage
from helibore.logs.intervals import Interval, outside_text
from helibore.preparation.prepare import Preparation, Prepared, Track, prepare
from helibore.preparation.readings import Readings
from helibore.preparation.sensors import TimeSeries
from helibore.runs.project import (
    FILES,
    SHOWN,
    ImageInput,
    Input,
    Output,
    Project,
    project_file,
    shown_tables,
    write_project,
)
from helibore.runs.wall_of_samples import wall_of_samples
from helibore.samples.caliper import LARGEST_RADIUS, Caliper
from helibore.samples.helix import WallLike, helix_of
from helibore.settings.column_settings import Columns
from helibore.settings.declared import Declared
from helibore.settings.path_settings import North
from helibore.settings.reading_settings import ReadingSettings
from helibore.settings.wall_settings import Settings
from helibore.settings.zone_settings import Criteria
from helibore.trajectory.references import ASSUMED
from helibore.trajectory.survey import Path as WellPath
from helibore.trajectory.survey import Survey
from helibore.wall.archive import opened
from helibore.wall.load import load
from helibore.wall.wall import Wall

MOST_CARRYING = 4_000_000
"""Vertices that a wall may have to show each row of its images."""
NEARLY_VERTICAL = 5.0
"""Degrees: tools in holes that are inclined less mostly count toolfaces from north."""
Stage = Callable[[str, str], AbstractContextManager[None]]
"""A function that takes a stage's name and a text on what it does, and returns the context in which it runs."""


def checksum(path: str | os.PathLike[str]) -> str:
    """Return the BLAKE2b of a file, 256 bits, as ``b2sum -l 256`` prints it; it takes half the time of SHA-256."""
    check_regular(Path(path))
    with Path(path).open("rb") as file:
        return hashlib.file_digest(file, lambda: hashlib.blake2b(digest_size=32)).hexdigest()


class OpenFiles:
    """The log files of a run. Each is parsed once; meanwhile a thread computes its checksum, once.

    The thread reads the bytes that the parser brings into memory (the page cache), so that the disk is read once.
    ``header_lines`` holds, by file, the line of a table's column names, if the user stated this line.
    """

    def __init__(
        self,
        nulls: tuple[float, ...],
        header_lines: Mapping[Path, int] | None = None,
        reading: ReadingSettings | None = None,
    ) -> None:
        self._nulls, self.header_lines, self._reading = nulls, dict(header_lines or {}), reading or ReadingSettings()
        self._pool = ThreadPoolExecutor(1, "checksums")
        self._sums: dict[Path, Future[str]] = {}
        self._logs: dict[Path, LogFile] = {}

    def checksum(self, file: Path) -> Future[str]:
        """Return the checksum of a file as a `Future`; after the first call, a thread computes the checksum."""
        if file not in self._sums:
            self._sums[file] = self._pool.submit(checksum, file)
        return self._sums[file]

    def log(self, file: Path) -> LogFile:
        """Return a file as `hb.open` does; it is opened at the first call only."""
        if file not in self._logs:
            self.checksum(file)
            how = ReadOptions(self._nulls, self.header_lines.get(file), **vars(self._reading))
            self._logs[file] = open_file(file, how, of_many=True)
        return self._logs[file]

    def input(
        self, file: Path, set_name: str | None = None, map_file: Path | None = None,
        change: Callable[[LogSet, RoleMap], RoleMap] = lambda _, roles: roles,
    ) -> Input:  # fmt: skip
        """Return a set of a file with its roles, from the map or else guessed, and then changed by ``change``."""
        log = self.log(file)
        alone = log if set_name is None else LogFile(log.path, log.format, [log.set(set_name)])
        roles = read_map(map_file, alone) if map_file is not None else guess(alone.set())
        log_set = log.set(roles.set_name)
        return Input(file, "", log_set.name, tuple(change(log_set, roles)))

    def log_set(self, one: Input) -> LogSet:
        """Return the set of a file that ``one`` names."""
        return self.log(one.file).set(one.set)

    def headers(self) -> list[dict[str, str]]:
        """Return the headers of the sets of all files that are open, in the order they were opened."""
        return [each.header for log in self._logs.values() for each in log.sets]

    def description(self, one: Input) -> str:
        """Return a text on what was read from a file: its format, set and number of rows."""
        log = self.log_set(one)
        named = f"set {log.name!r}, " if log.name not in ("table", "arrays") else ""
        return f"{one.file.name}: {self.log(one.file).format}, {named}{log.rows:,} rows"


@dataclass
class Run:
    """A run: its settings, its files, and the wall."""

    settings: Project  # ``save_project`` fills in the checksums
    files: OpenFiles
    changed: bool = False  # whether the settings are not those of the output that helibore wrote
    tune: bool = False  # whether `make_wall` replaces the settings of the wall by those that `helibore.tune` finds
    # (label, sentence) for what was read, left out and corrected, in order
    messages: list[tuple[str, str]] = field(default_factory=list)
    readings: tuple[Readings, ...] = ()  # of the caliper files
    prepared: Prepared | None = None  # the samples that preparation makes of the readings
    survey: Survey | None = None
    path: WellPath | None = None
    built: Wall | None = None

    @property
    def wall(self) -> Wall:
        """The wall, once it is built."""
        if self.built is None:
            raise RuntimeError("the wall is not built yet; this is a bug in helibore")
        return self.built

    @property
    def reference(self) -> str | None:
        """The direction of toolface 0 of the wall, as the settings, or else the path, or else all samples state it.

        None if none of these states a direction.
        """
        return self.stated or (self.path.reference if self.path is not None else None)

    @property
    def stated(self) -> str | None:
        """The direction of toolface 0 of the wall, as the settings state it.

        If the settings state none and there is no path, this is the direction that all samples state. None if samples
        state none.
        """
        if self.settings.path.reference or self.path is not None:
            return self.settings.path.reference
        stated = {self.settings.preparation.toolface_from or one.reference for one in self.readings}
        stated = {one.removeprefix("horizontal-") for one in stated}  # without a survey, such angles stay as they are
        tagged = any(one.high_side is not None for one in self.readings)
        return stated.pop() if stated in ({"north"}, {"high-side"}) and not tagged else None

    @property
    def assumed(self) -> bool:
        """Whether toolfaces of readings or images are only assumed to count from the reference of the wall."""
        known = self.stated or self.settings.preparation.toolface_from
        silent = [one for one in self.readings if not (known or one.reference or one.high_side is not None)]
        images = [one for one in self.settings.image if not (self.stated or one.reference)]
        return bool(images or (self.path is not None and silent))

    @property
    def name(self) -> str:
        """The name of the first source file without its ending (``.csv.gz`` counts as one), or "Gauge hole"."""
        source = self.settings.archive or self.settings.average or next(iter(self.settings.caliper), None)
        if source is None:
            return "Gauge hole"
        name = source.file.name
        return Path(name[:-3] if name.lower().endswith(".gz") else name).stem


def open_run(project: Project, files: OpenFiles | None = None, keys: Collection[str] = FILES) -> Run:
    """Return the run of a project with its files, and with the roles of all channels: stated, mapped or guessed.

    ``files`` may be open already; only those of ``keys`` are opened. Raise InputError if a file has another checksum
    than the project states, or lacks a channel. What an archive keeps counts where the project states nothing.
    """
    files = files or OpenFiles(project.nulls, reading=project.reading)
    lines = {one.file: line for one in project.inputs if (line := getattr(one, "header_line", None))}
    files.header_lines = lines | files.header_lines
    _check_sums(project, files, keys)
    if project.archive is not None and "archive" in keys:
        tables = kept_tables(project.archive.file)
        project = replace(project, **{name: tables.get(name, {}) | getattr(project, name) for name in tables})
    return Run(_with_roles(project, files, keys), files)


def _check_sums(project: Project, files: OpenFiles, keys: Collection[str]) -> None:
    """Raise InputError if a file has another checksum than the project states."""
    inputs = [each for key in keys for each in project.files(key)]
    for each in inputs:
        files.checksum(each.file)
    for each in inputs:
        if each.blake2b and (now := files.checksum(each.file).result()) != each.blake2b:
            rule = f"its BLAKE2b is {now}, the settings have {each.blake2b}; only the same file repeats the run"
            raise InputError(str(each.file), f"has changed since the run: {rule}")


def _with_roles(project: Project, files: OpenFiles, keys: Collection[str]) -> Project:
    """Return a project in which every file has the roles of its channels; those that are not stated are guessed."""
    columns = project.columns
    single: dict[str, Any] = {"depth": columns.depth, "toolface": columns.toolface, "time": columns.time}
    arms: dict[str, Any] = {"radius": columns.radius, "diameter": columns.diameter, "travel-time": columns.travel_time}
    stations: dict[str, Any] = {
        "depth": columns.survey_depth,
        "inclination": columns.inclination,
        "azimuth": columns.azimuth,
    }

    def known(one: Input, columns: Any, arms: Any) -> Input:
        stated = [text for text in columns.values() if text is not None] + [text for of in arms.values() for text in of]
        if not one.channel:
            found = files.input(one.file, one.set, one.map, partial(parse_options, columns=columns, arms=arms))
            return replace(one, set=found.set, channel=found.channel, map=None)
        for role in one.channel:
            files.log_set(one).channel(role.channel)
        if not stated:
            return one
        return replace(one, channel=tuple(parse_options(files.log_set(one), one.roles, columns, arms)))

    none: dict[str, Any] = {}
    made: dict[str, Any] = {"columns": Columns()}
    for key, columns_of, arms_of in (
        ("caliper", single, arms), ("average", none, none), ("survey", stations, none), ("track", none, none),
    ):  # fmt: skip
        if key in keys:
            found = tuple(known(one, columns_of, arms_of) for one in project.files(key) if isinstance(one, Input))
            made[key] = found if key == "caliper" else next(iter(found), None)
    return replace(project, **made)


def stated_criteria(project: Project, wall: WallLike) -> Criteria:
    """Return the criteria of zones that a project states for a wall, and default values of the other criteria."""
    stated = dict(project.zones)
    scaled = stated.pop("scaled", False)
    return Criteria.scaled(wall.settings.bit_diameter, **stated) if scaled else Criteria(**stated)


def tables_to_keep(project: Project) -> dict[str, dict[str, Any]]:
    """Return the tables of a project that the archive of its wall keeps, as JSON can hold them.

    They hold the template itself, not its name; the names of other files are left out.
    """
    tables = {}
    for name in SHOWN:
        table = dict(getattr(project, name))
        if isinstance(template := table.get("template"), Path):
            table["template"] = read_toml(template, template.name)
        table = {key: value for key, value in table.items() if not _files_in(value)}
        if table:
            tables[name] = json.loads(json.dumps(table, default=Declared.changed))
    return tables


def _files_in(value: Any) -> bool:
    return isinstance(value, Path) or (isinstance(value, list | tuple) and any(map(_files_in, value)))


def kept_tables(filename: Path) -> dict[str, dict[str, Any]]:
    """Return the tables of the project that an archive keeps; {} for an archive that was made without a project."""
    with opened(filename) as members:
        made_from = members.contents()["made_from"]
        tables = made_from.get("project", {}) if isinstance(made_from, dict) else {}
        return shown_tables(tables, "its project") if tables else {}


def make_wall(run: Run, threads: int | None = None, stage: Stage = lambda *_: nullcontext()) -> Run:
    """Read the files of a run and build its wall, with its path and its images."""
    return build_wall(run, *read_run(run, stage), threads, stage)


def read_run(
    run: Run, stage: Stage = lambda *_: nullcontext()
) -> tuple[list[SectorImage], tuple[str, Caliper | Prepared] | None]:
    """Read the files of a run and set its path; return its images, and the name and the prepared samples of its wall.

    For an archive, which has no samples to prepare, return None in place of name and samples.
    """
    settings, wall = run.settings, run.settings.wall
    for each in settings.inputs:
        run.files.checksum(each.file)
    with stage("read", f"Reading {', '.join(one.file.name for one in settings.inputs) or 'nothing'}"):
        read_path(run)
        if settings.archive is not None:
            run.built = load(settings.archive.file)
            if run.path is not None and run.built.path is not None:
                raise InputError("survey", f"must not be given: {settings.archive.file.name} already has a path")
            if run.built.path is not None:
                run.path = _with_north(run.built.path, settings.path.north)
            files = run.built.made_from.get("files")
            known = [one for one in files if isinstance(one, dict) and "name" in one] if isinstance(files, list) else []
            named = ", ".join(dict.fromkeys(str(one["name"]) for one in known))
            origin = f", made from {named}" if named else ""
            run.messages.append(("wall", f"{settings.archive.file.name}: archive of a wall{origin}"))
            run.messages += preparation_lines(run.built)
        bit = wall.bit_diameter if wall and wall.bit_diameter > 0 else None
        track = _track(run.files.log_set(settings.track), settings.track.roles) if settings.track else None
        run.readings = tuple(
            readings(run.files.log_set(each), each.roles, bit, settings.echo, track is not None)
            for each in settings.caliper
        )
        run.messages += [*_read_lines(run), *_survey_lines(run)]
        images = [_read_image(run, one) for one in settings.image]
        unshaped = _read_round(run, wall, images) if wall and not settings.caliper else None
    if wall is None:
        return images, None
    if unshaped is not None:
        _check_interval(*unshaped, wall)
        return images, unshaped
    with stage("prepare", "Preparing the samples"):
        made = run.prepared = prepare(list(run.readings), settings.preparation, run.path, track, bit)
        complete = not any(found.missing for found in run.readings)
        run.messages += made.report or ([("dropped", "nothing")] if complete else [])
        name = run.readings[0].name
        _check_interval(name, made.caliper, wall)
    return images, (name, made)


def suit_images(
    run: Run, images: list[SectorImage], samples: tuple[str, Caliper | Prepared] | None, chosen: bool
) -> None:
    """Give a wall a turn for each row of its finest image, if the caliper has at least a sample for two such vertices.

    A wall whose shape is not measured only carries images, and needs no samples. If pitch or sectors are ``chosen``, or
    the wall would have more than `MOST_CARRYING` vertices, a message says that its turns are coarser than the rows.
    """
    wall = run.settings.wall or run.wall.settings
    rows = [(float(np.median(np.diff(one.depth))), one) for one in images if one.depth.size > 1]
    step, image = min(rows, key=lambda row: row[0], default=(np.inf, None))
    if image is None or step >= abs(wall.pitch) * (1 - 1e-6):
        return
    pitch, sectors = round(step, 9), max(wall.sectors, image.sectors)
    each = f"{image.name} has a row each {step:.4g} m"
    if not chosen and samples is not None:
        depth = (samples[1] if isinstance(samples[1], Caliper) else samples[1].caliper).depth
        vertices = (depth.max() - depth.min()) / pitch * sectors
        if vertices <= (min(MOST_CARRYING, 2 * depth.size) if run.settings.caliper else MOST_CARRYING):
            run.settings = replace(
                run.settings, wall=replace(wall, pitch=np.copysign(pitch, wall.pitch), sectors=sectors)
            )
            run.messages.append(("helix", f"{each}, and so has the wall a turn, of {sectors} sectors"))
            return
    rule = f"the wall has a turn each {abs(wall.pitch):g} m, and the page shows no more of the image"
    run.messages.append(("image", f"{each}, {rule}; wall.pitch={pitch:.10g}m shows every row"))


def build_wall(
    run: Run, images: list[SectorImage], samples: tuple[str, Caliper | Prepared] | None,
    threads: int | None = None, stage: Stage = lambda *_: nullcontext(),
) -> Run:  # fmt: skip
    """Build the wall of a run from what `read_run` returned."""
    settings, wall = run.settings, run.settings.wall
    with stage("rebuild", "Rebuilding the wall"):
        if wall is not None and samples is not None:
            _, made = samples
            caliper = made if isinstance(made, Caliper) else made.caliper
            wall = wall.resolved()
            if run.tune:
                wall = _tune(run, wall, caliper, threads)
            elif wall.estimator == "automatic":
                wall = _choose(run, wall, caliper, threads)
            run.built = wall_of_samples(made, threads=threads, **vars(wall))
            made_from = [one.file for one in (*settings.caliper, settings.average) if one is not None]
            if made_from:
                sums = [{"name": file.name, "blake2b": run.files.checksum(file).result()} for file in made_from]
                run.built.made_from = {"files": sums} | run.built.made_from
            if isinstance(made, Prepared):
                run.messages += preparation_lines(run.built)[len(made.report) :]  # messages on the passes of the wall
            header = log_header(run.files.headers())
            if header:
                run.built.made_from["header"] = header
    if tables := tables_to_keep(run.settings):
        run.wall.made_from["project"] = tables
    if run.assumed:
        run.wall.made_from["toolface"] = ASSUMED
    if (survey := run.settings.survey) is not None and run.path is not None:
        north = {"name": survey.file.name, "north": run.path.survey.north}
        run.wall.made_from["survey"] = north | _norths(settings.preparation)
    run.wall.path = run.path
    run.messages += _add_intervals(run)
    run.messages += add_images(run.wall, images)
    return run


def _add_intervals(run: Run) -> list[tuple[str, str]]:
    """Give the wall the intervals of the run's files, if it has any; return lines on what was read."""
    if not run.settings.intervals:
        return []
    from helibore.files.well_tops import read_tops

    intervals: list[Interval] = []
    lines: list[tuple[str, str]] = []
    for one in run.settings.intervals:
        found = read_tops(one.file, one.well, one.unit, stated_header(run).get("well", run.name))
        intervals += found.intervals
        outside = outside_text(found.intervals, *helix_of(run.wall).ends(len(run.wall))) if len(run.wall) else ""
        said = ", ".join([*found.remarks, *([outside] if outside else [])])
        lines.append(("" if lines else "intervals", f"{len(found.intervals)} of {one.file.name}: {said}"))
    run.wall.intervals = tuple(intervals)
    return lines


def _norths(preparation: Preparation) -> dict[str, float]:
    """Return the declination and the convergence that were used, for the record of a wall."""
    angles = {"declination": preparation.declination, "convergence": preparation.convergence}
    return {name: angle for name, angle in angles.items() if angle is not None}


def preparation_lines(wall: Wall) -> list[tuple[str, str]]:
    """Return the lines, kept in ``wall.made_from``, on what preparation left out and corrected."""
    kept = wall.made_from.get("preparation")
    lines = kept if isinstance(kept, list) else []
    return [(str(line[0]), str(line[1])) for line in lines if isinstance(line, list) and len(line) == 2]


def stated_header(run: Run) -> dict[str, str]:
    """Return header entries (well, field ...): of the project, else of the run's files, else those of a saved wall."""
    kept = run.wall.made_from.get("header") if run.built is not None else None
    earlier = {str(name): str(text) for name, text in kept.items()} if isinstance(kept, dict) else {}
    return earlier | log_header(run.files.headers()) | run.settings.header


def read_path(run: Run) -> None:
    """Read the survey of a run, if it has one, and set the path of the run."""
    survey = run.settings.survey
    if survey is not None:
        how = run.settings.path
        read = run.files.log_set(survey).survey(survey.roles)
        path = _with_north(read.path(how.method, how.reference or "high-side", how.head, how.extend), how.north)
        run.path, run.survey = path, path.survey


def _with_north(path: WellPath, north: North | None) -> WellPath:
    """Return the path with the north that the settings state for a survey which states none."""
    survey = path.survey
    if north is None or north == survey.north:
        return path
    if survey.north:
        raise InputError("path.north", f"must be left out: the survey states {survey.north} north", north)
    stated = Survey(survey.depth, survey.inclination, survey.azimuth, north=north)
    return stated.path(path.method, path.reference, path.head, path.extend)


def _tune(run: Run, wall: Settings, caliper: Caliper, threads: int | None) -> Settings:
    """Return the settings of the wall that `helibore.tune` finds, and give them to the run."""
    from helibore.wall.tune import tune
    from helibore.wall.tuning import TUNED

    usual = {"max_distance": Settings.max_distance}  # a default, not chosen by the user
    fixed = {name: of for name, of in vars(wall).items() if name not in TUNED and usual.get(name) != of}
    tuning = tune(caliper, threads=threads, **fixed)
    run.messages.append(("tuned", tuning.sentence))
    run.settings = replace(run.settings, wall=tuning.settings)
    return tuning.settings


def _choose(run: Run, wall: Settings, caliper: Caliper, threads: int | None) -> Settings:
    """Return the settings of the wall with the estimator that suits its samples, and give them to the run."""
    from helibore.wall.automatic import choose

    choice = choose(caliper, wall, threads)
    run.messages.append(("estimator", choice.sentence))
    run.settings = replace(run.settings, wall=choice.settings)
    return choice.settings


def add_images(wall: Wall, images: list[SectorImage]) -> list[tuple[str, str]]:
    """Give images to a wall; an image whose name is taken gets a number. Return a message on each such image."""
    messages = []
    for image in images:
        own, number = image.name, 1
        while image.name in wall.images:
            number += 1
            image.name = f"{own}:{number}"
        if number > 1:
            messages.append(("image", f"{image.name} is the image {own} of another file"))
        wall.images[image.name] = image
    return messages


def _track(log: LogSet, roles: RoleMap) -> Track:
    """Return the track, depth and toolface by time, that a log with these roles holds."""
    when, depth = (column(log, needed(log, roles, name)) for name in ("time", "depth"))
    role = roles.one("toolface")
    known = np.isfinite(when)
    turning = TimeSeries(when[known], column(log, role)[known], angle=True) if role else None
    return Track(TimeSeries(when[known], depth[known]), turning)


def _read_image(run: Run, one: ImageInput) -> SectorImage:
    """Return a sector image; its toolfaces count from the reference that is stated for it, or else from the wall's."""
    stated = one.reference or run.stated
    reference: Any = stated or run.reference or "high-side"
    if reference not in ("north", "high-side"):
        rule = f"the wall counts toolfaces from {reference}, but no image does; state the image's reference, north or "
        rule += "high-side"
        raise InputError(f"image {one.name}", rule)
    log = run.files.log(one.file).set()
    log.channel(one.name)
    image = log.image(one.name).sector_image(one.origin, reference)
    size = f"{image.depth.size:,} rows x {image.sectors} sectors, {image.missing:,} values missing"
    assumed = "" if stated else ", since no reference is stated (path.reference=north states one)"
    run.messages.append(("image", f"{one.file.name}:{one.name}: {size}, from {reference}{assumed}"))
    return image


def _read_round(run: Run, wall: Settings, images: list[SectorImage]) -> tuple[str, Caliper]:
    """Return name and samples of an average caliper or a gauge hole, which has no measurement around the hole."""
    if run.settings.average is not None:
        return _read_average(run, run.settings.average)
    run.messages.insert(0, ("wall", "gauge hole: not measured"))
    top, bottom = interval(wall)
    if not np.isfinite([top, bottom]).all() and not images:
        raise InputError("gauge", "needs start_depth and stop_depth, or an image, which has depths")
    top = top if np.isfinite(top) else min(float(image.depth[0]) for image in images)
    bottom = bottom if np.isfinite(bottom) else max(float(image.depth[-1]) for image in images)
    return "gauge hole", Caliper.gauge(top, bottom, wall.bit_diameter)


def _read_average(run: Run, one: Input) -> tuple[str, Caliper]:
    """Return the name and samples of an average caliper; rows without a diameter are left out and counted."""
    log = run.files.log_set(one)
    role, (at, depth) = needed(log, one.roles, "mean-diameter"), depths(log, one.roles)
    size = column(log, role)
    there = np.isfinite(depth) & np.isfinite(size)
    preparation = run.settings.preparation
    least, greatest = preparation.least_radius or 0.0, preparation.greatest_radius or np.inf
    hole = there & (size > 0) & (size <= 2 * LARGEST_RADIUS)
    usable = hole & (size >= 2 * least) & (size <= 2 * greatest)
    if not usable.any():
        place = f"{one.file.name}, column {role.channel}"
        raise InputError(place, f"no row has a depth and the diameter of a hole, in {role.unit}")
    text = f"{role.channel} is the diameter, in {role.unit}; {at.channel} is the depth"
    lines = [("caliper", f"{one.file.name}: {log.rows:,} rows; {text}")]
    for rows, what in (
        (~there, "without a depth or diameter"),
        (there & ~hole, "with a diameter that no hole has"),
        (hole & ~usable, "outside the range of radii"),
    ):
        if count := np.count_nonzero(rows):
            lines.append(("dropped", f"{count:,} rows: {what}"))
    run.messages[:0] = lines
    return f"{one.file.name}:{role.channel}", Caliper.from_average(depth[usable], size[usable])


def _check_interval(name: str, caliper: Caliper, settings: Settings) -> None:
    """Raise an InputError if no sample of the file ``name`` lies in the interval of depths that the wall shall have."""
    depth, (top, bottom) = caliper.depth, interval(settings)
    if not ((depth >= top) & (depth <= bottom)).any():
        raise no_samples(name, (float(depth.min()), float(depth.max())), settings)


def no_samples(name: str, ends: tuple[float, float], settings: Settings) -> InputError:
    """Return the error of a file whose samples, between the depths ``ends``, all lie outside the wall's interval."""
    top, bottom = interval(settings)
    asked = f"between {top:g} and {bottom:g} m"
    if np.isinf(top) or np.isinf(bottom):
        asked = f"below {top:g} m" if np.isfinite(top) else f"above {bottom:g} m"
    return InputError(name, f"no samples {asked}; the file has {ends[0]:g} to {ends[1]:g} m")


def interval(settings: Settings) -> tuple[float, float]:
    """Return the shallow and the deep end of the wall that the settings state, metres; infinite if not stated."""
    ends = (settings.start_depth, settings.stop_depth)
    top, bottom = ends[::-1] if settings.pitch < 0 else ends
    return -np.inf if top is None else top, np.inf if bottom is None else bottom


@contextmanager
def placing(run: Run, options: str = "") -> Iterator[None]:
    """If the block fails because the path misses a part of the wall, add survey file and ``options`` to its error."""
    try:
        yield
    except ValueError as error:
        path, depth, survey = run.wall.path, run.wall.depth, run.settings.survey
        if survey is None or path is None or not depth.size:
            raise
        if path.start_depth <= depth.min() and depth.max() <= path.stop_depth:
            raise
        raise InputError(survey.file.name, f"{error}{options}") from error


def check_path(run: Run, *ends: float) -> None:
    """Raise an InputError that names the survey's file if the path of a run does not reach the depths ``ends``."""
    if run.path is None:
        return
    try:
        run.path.tangent(ends)
    except InputError as error:
        survey = run.settings.survey
        raise (error if survey is None else error.within(survey.file.name)) from None


def save_project(run: Run, output: Path, verb: str, more: Mapping[str, Any]) -> Project:
    """Write the project that repeats ``output`` beside it, with the checksums of the inputs and of the output.

    ``more`` are the tables and keys with which the command made the output.
    """

    def known(one: Any) -> Any:
        blake2b, line = run.files.checksum(one.file).result(), run.files.header_lines.get(one.file)
        return replace(one, blake2b=blake2b, header_line=line)

    def used(one: Input | None) -> Any:
        return one and replace(known(one), channel=tuple(role for role in one.channel if role.role != "none"))

    settings = run.settings
    run.settings = replace(
        settings, helibore=settings.helibore or __version__, verb=verb, output=Output(output, checksum(output)),
        caliper=tuple(map(used, settings.caliper)), image=tuple(map(known, settings.image)),
        scalar=tuple(map(known, settings.scalar)), **more,
        **{name: used(getattr(settings, name)) for name in ("average", "archive", "track", "survey")},
    )  # fmt: skip
    write_project(project_file(output), run.settings)
    return run.settings


def _read_lines(run: Run) -> Iterator[tuple[str, str]]:
    """Yield lines on the caliper files and the roles of their channels; roles as in the previous file are left out."""
    before: tuple[str, ...] = ()
    for each, found in zip(run.settings.caliper, run.readings, strict=True):
        yield "caliper", run.files.description(each)
        log, notes = run.files.log_set(each), found.notes if found.notes != before else ()
        for sentence in (*log.remarks, *notes, *depth_remarks(log, each.roles)):
            yield "", sentence
        before = found.notes
        for name, count in found.missing.items():
            yield "missing", f"{count:,} values of {name}"


def _survey_lines(run: Run) -> Iterator[tuple[str, str]]:
    """Yield lines on the survey and the track, and on the roles of their channels."""
    for label, one, roles in (
        ("survey", run.settings.survey, ("depth", "inclination", "azimuth")),
        ("track", run.settings.track, ("time", "depth", "toolface")),
    ):
        if one is None:
            continue
        log = run.files.log_set(one)
        yield label, run.files.description(one)
        for sentence in (*log.remarks, *(note(role) for role in one.roles.all(*roles))):
            yield "", sentence
        if label == "survey" and run.survey is not None:
            if not run.survey.north:
                yield "", "azimuths: north not stated; path.north=true, magnetic or grid states it"
            yield from _first_station(log, one.roles, run.survey, run.settings.path.head)
            steepest = float(run.survey.inclination.max())
            if run.assumed and run.reference == "high-side" and steepest < NEARLY_VERTICAL:
                rule = (
                    f"no reference is stated, so toolfaces count from the high side of a hole of {steepest:.2g} degrees"
                )
                rule += "; tools in such holes mostly count from north: path.reference=north, or high-side, states it"
                yield "warning", rule


def _first_station(log: LogSet, roles: RoleMap, survey: Survey, head: tuple[float, ...]) -> Iterator[tuple[str, str]]:
    """Yield a line on the origin of positions, if no head is given and the first station seems not to be the origin."""
    top = float(survey.depth[0])
    row = int(np.flatnonzero(column(log, needed(log, roles, "depth")) == top)[0])
    found = [roles.one(name) for name in ("north", "east", "tvd")]
    stated = [float(column(log, role)[row]) for role in found if role is not None and role.unit]
    known = len(stated) == 3 and bool(np.isfinite(stated).all())
    if any(head) or (np.abs(stated).max() if known else top) <= 0.001:
        return
    place = "path.head says where it lies"
    if known:
        north, east, down = (f"{value:.10g}" for value in stated)
        place = f"the file states north {north}, east {east}, down {down} m; path.head={north},{east},{down} sets these"
    yield "", f"positions count from the first station, at {top:g} m, as if it were (0, 0, 0); {place}"
