"""One run, from files to a mesh: what ``helibore reconstruct`` does, stage by stage, for Python too.

    settings = read_settings("wall.glb.toml")
    run = repeat(settings)                      # the same samples, wall and surface, to the last bit
    run.surface.save("again.glb")

    files --opened--> channels and roles --readings--> --prepare--> samples --> wall --> surface

What decides the bytes of a mesh is a ``RunSettings``, and nothing else does. Not here: options and printing (``cli``).
"""

from __future__ import annotations

import os
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from helibore.base.arrays import Floats
from helibore.base.settings import Settings
from helibore.channels.depth_remarks import depth_remarks
from helibore.channels.log_set import LogFile, LogSet
from helibore.channels.opening import open as open_file
from helibore.channels.readings import note, readings
from helibore.channels.roles import RoleMap
from helibore.mesh.surface import Surface
from helibore.preparation.prepare import Prepared, Track, prepare
from helibore.preparation.readings import Readings
from helibore.preparation.sensors import TimeSeries
from helibore.runs.reconstruct import compare
from helibore.runs.run_settings import (
    Input,
    RunSettings,
    checksum,
    read_settings,
    require_unchanged,
    settings_file,
    write_settings,
)
from helibore.trajectory.survey import Path as WellPath
from helibore.trajectory.survey import Survey
from helibore.wall.archive import ENDING as ARCHIVE
from helibore.wall.reconstruct import reconstruct
from helibore.wall.wall import Wall

__all__ = ["Opened", "Run", "opened", "place", "placing", "read", "rebuild", "repeat", "save"]


class Checksum(threading.Thread):
    """The checksum of a file, made while it is read."""

    def __init__(self, path: Path) -> None:
        super().__init__(name=f"checksum of {path.name}", daemon=True)
        self._path, self._found = path, ""
        self._error: OSError | None = None
        self.start()

    def run(self) -> None:
        """Read the file once."""
        try:
            self._found = checksum(self._path)
        except OSError as error:
            self._error = error

    def known(self) -> str:
        """Wait for it."""
        self.join()
        if self._error is not None:
            raise self._error
        return self._found


@dataclass(frozen=True)
class Opened:
    """A file that is open: its format, the set that is used, and what its channels are taken for."""

    file: Path
    format: str
    one: LogSet
    roles: RoleMap
    blake2b: Checksum

    def input(self) -> Input:
        """What the settings say of it."""
        return Input(self.file, self.blake2b.known(), replace(self.roles, set_name=self.one.name))


def opened(file: str | os.PathLike[str], nulls: tuple[float, ...], choose: Callable[[LogFile], RoleMap]) -> Opened:
    """Open a file; ``choose`` says which set and roles. Its checksum is made meanwhile, in a thread of its own."""
    path = Path(file)
    blake2b = Checksum(path)
    found = open_file(path, nulls)
    roles = choose(found)
    return Opened(path, found.format, found.set(roles.set_name), roles, blake2b)


@dataclass
class Run:
    """A run under way: what has been read, rebuilt and placed so far.

    Attributes
    ----------
    settings
        What it is made with. Checksums of inputs are filled in by ``save``.
    caliper, survey_file, track_file
        The open files.
    survey, path
        The survey and its path; None without.
    readings
        What the caliper files hold.
    prepared
        Samples, and what was done to them.
    wall, earlier
        The wall, and that of the earlier passes.
    surface
        The wall along the path.
    """

    settings: RunSettings
    caliper: tuple[Opened, ...]
    survey_file: Opened | None
    track_file: Opened | None
    readings: tuple[Readings, ...]
    survey: Survey | None = None
    path: WellPath | None = None
    track: Track | None = None
    prepared: Prepared | None = None
    wall: Wall | None = None
    earlier: Wall | None = None
    surface: Surface | None = None


def read(
    settings: RunSettings, caliper: tuple[Opened, ...], survey_file: Opened | None, track_file: Opened | None
) -> Run:
    """Read what the open files hold."""
    bit = settings.wall.bit_diameter if settings.wall.bit_diameter > 0 else None  # Wall says what is wrong with it
    found = tuple(readings(each.one, each.roles, bit, settings.echo, track_file is not None) for each in caliper)
    run = Run(settings, caliper, survey_file, track_file, found)
    if survey_file is not None:
        run.survey = survey_file.one.survey(survey_file.roles)
        way = settings.path
        north, east, down = way.head
        run.path = run.survey.path(way.method, way.reference, (north, east, down), way.extend)  # type: ignore[arg-type]
    if track_file is not None:
        run.track = _track(track_file)
    return run


def _track(file: Opened) -> Track:
    """Depth and toolface by time."""
    from helibore.channels.columns import column, needed

    when = column(file.one, needed(file.one, file.roles, "time"))
    depth = column(file.one, needed(file.one, file.roles, "depth"))
    role = file.roles.one("toolface")
    known = np.isfinite(when)
    turning = TimeSeries(when[known], column(file.one, role)[known], angle=True) if role else None
    return Track(TimeSeries(when[known], depth[known]), turning)


def rebuild(run: Run, threads: int | None = None) -> Wall:
    """Prepare the readings and rebuild the wall, and the earlier one where there is one."""
    run.prepared = prepare(list(run.readings), run.settings.preparation, run.path, run.track)
    check_some(run.readings[0].name, run.prepared.caliper.depth, run.settings.wall)
    run.wall = reconstruct(run.prepared.caliper, threads=threads, **vars(run.settings.wall))
    if run.prepared.earlier is not None:
        run.earlier = reconstruct(run.prepared.earlier, threads=threads, **vars(run.settings.wall))
    return run.wall


def check_some(name: str, depth: Floats, settings: Settings) -> None:
    """Refuse samples, from a file of this name, of which none lies where the wall is asked for."""
    top, bottom = interval(settings)
    if (depth.min() >= top and depth.max() <= bottom) or ((depth >= top) & (depth <= bottom)).any():
        return
    asked = f"between {top:g} and {bottom:g} m"
    if np.isinf(top) or np.isinf(bottom):
        asked = f"below {top:g} m" if np.isfinite(top) else f"above {bottom:g} m"
    raise ValueError(f"{name}: no samples {asked}; it has {depth.min():g} to {depth.max():g} m")


def interval(settings: Settings) -> tuple[float, float]:
    """Depths the wall is asked for, shallow and deep; infinite where that is left to the samples."""
    ends = (settings.start_depth, settings.stop_depth)
    top, bottom = ends if settings.pitch > 0 else ends[::-1]
    return -np.inf if top is None else top, np.inf if bottom is None else bottom


def place(run: Run) -> Surface:
    """Place the wall along the path, with the difference to the earlier one as an attribute.

    The wall takes over path, attribute and the names and checksums of its files, so that its archive has them, too.
    """
    if run.wall is None:
        raise RuntimeError("place before rebuild; this is a bug in helibore")
    run.wall.path = run.path
    run.wall.made_from = {"files": [{"name": each.file.name, "blake2b": each.blake2b.known()} for each in run.caliper]}
    if run.earlier is not None:
        compare(run.wall, run.earlier)
    with placing(run.wall, run.survey_file.file if run.survey_file else None):
        run.surface = run.wall.surface()
    if not len(run.surface.quads):
        low, high = run.wall.depth.min(initial=np.inf), run.wall.depth.max(initial=-np.inf)
        pitch = abs(run.settings.wall.pitch)
        rule = f"no two turns of the wall lie side by side between {low:g} and {high:g} m, at {pitch:g} m a turn"
        raise ValueError(f"{run.readings[0].name}: no quads: {rule}")
    return run.surface


@contextmanager
def placing(wall: Wall, survey: Path | None) -> Iterator[None]:
    """Name the file of the survey in the error of a path that does not reach all of the wall."""
    try:
        yield
    except ValueError as error:
        path, depth = wall.path, wall.depth
        if survey is None or path is None or not depth.size:
            raise
        if path.start_depth <= depth.min() and depth.max() <= path.stop_depth:
            raise
        raise ValueError(f"{survey.name}: {error}") from error


def save(run: Run, output: str | os.PathLike[str]) -> RunSettings:
    """Write the mesh, or the archive, and beside it the settings that repeat it; each whole or not at all.

    Returns
    -------
    RunSettings
        As written: with the checksums of what was read and of the mesh.
    """
    output = Path(output)
    if run.surface is None or run.wall is None:
        raise RuntimeError("save before place; this is a bug in helibore")
    inputs = [each.input() for each in run.caliper]
    if output.suffix.lower() == ARCHIVE:
        run.wall.save(output)
    else:
        run.surface.save(output, color_by=run.settings.color_by)
    settings = replace(
        run.settings, caliper=tuple(inputs), output=output, output_blake2b=checksum(output),
        survey=run.survey_file.input() if run.survey_file else None,
        track=run.track_file.input() if run.track_file else None,
    )  # fmt: skip
    write_settings(settings_file(output), settings)
    run.settings = settings
    return settings


def reopened(settings: RunSettings) -> tuple[tuple[Opened, ...], Opened | None, Opened | None]:
    """Open the files that settings name, as they were.

    Raises
    ------
    ValueError
        If a file has changed since, naming it and both checksums.
    """

    def again(one: Input | None) -> Opened | None:
        if one is None:
            return None
        require_unchanged(one.file, one.blake2b)
        return opened(one.file, settings.nulls, lambda file: _known(file.set(one.roles.set_name), one.roles))

    calipers = tuple(found for one in settings.caliper if (found := again(one)) is not None)
    return calipers, again(settings.survey), again(settings.track)


def _known(log: LogSet, roles: RoleMap) -> RoleMap:
    for role in roles:
        if role.channel not in log:
            raise ValueError(f"{log.path.name}: no channel {role.channel!r}; it holds {', '.join(log.names)}")
    return roles


def repeat(settings: RunSettings | str | os.PathLike[str], threads: int | None = None) -> Run:
    """Repeat a run from its settings, or from the file they are in, up to the placed surface.

    Raises
    ------
    ValueError
        If an input has changed, and as the run itself.
    """
    if not isinstance(settings, RunSettings):
        settings = read_settings(settings)
    run = read(settings, *reopened(settings))
    rebuild(run, threads)
    place(run)
    return run


def told(run: Run) -> Iterator[tuple[str, str]]:
    """Yield (label, sentence) for every file: what was read, what each channel was taken for, what was left out."""
    for each, found in zip(run.caliper, run.readings, strict=True):
        yield "caliper", f"{each.file.name}: {each.format}, {_set(each)}{found.rows:,} rows"
        for sentence in (*each.one.remarks, *found.notes):
            yield "", sentence
        for sentence in depth_remarks(each.one, each.roles):
            yield "", sentence
        for name, count in found.missing.items():
            yield "missing", f"{count:,} values of {name}"
    for label, file, roles in (
        ("survey", run.survey_file, ("depth", "inclination", "azimuth")),
        ("track", run.track_file, ("time", "depth", "toolface")),
    ):
        if file is not None:
            yield label, f"{file.file.name}: {file.format}, {_set(file)}{file.one.rows:,} rows"
            for sentence in (*file.one.remarks, *(note(role) for role in file.roles.all(*roles))):
                yield "", sentence
            if label == "survey" and run.survey is not None:
                origin = first_station(file, run.survey, run.settings.path.head)
                if origin:
                    yield "", origin


def first_station(file: Opened, survey: Survey, head: tuple[float, ...]) -> str:
    """Say what positions and TVD count from where no head is given; "" where the first station is the origin."""
    from helibore.channels.columns import column, needed

    if any(head):
        return ""
    top = float(survey.depth[0])
    row = int(np.flatnonzero(column(file.one, needed(file.one, file.roles, "depth")) == top)[0])
    found = [file.roles.one(name) for name in ("north", "east", "tvd")]
    stated = [float(column(file.one, role)[row]) for role in found if role is not None and role.unit]
    if len(stated) == 3 and np.isfinite(stated).all():
        if np.abs(stated).max() <= 0.001:
            return ""
        north, east, down = (f"{value:.10g}" for value in stated)
        place = f"the file has it at north {north}, east {east}, down {down} m; --head {north} {east} {down} takes that"
    elif top <= 0.001:
        return ""
    else:
        place = "--head says where it lies"
    return f"positions and TVD count from the first station, at {top:g} m, as from (0, 0, 0); {place}"


def _set(each: Opened) -> str:
    return f"set {each.one.name!r}, " if each.one.name not in ("table", "arrays") else ""
