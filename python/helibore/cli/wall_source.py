"""Where a wall to be drawn comes from, and its images.

well.wall                                   as `Wall.save` wrote it, images and all
caliper.csv --bit-diameter 8.5in            rebuilt from its samples
--average log.las:CALI --bit-diameter ...   size measured, shape assumed round
--gauge --bit-diameter ... --image ...      not measured: it only carries images
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click
import numpy as np
from click.core import ParameterSource

from helibore.cli.quantities import BIT, LENGTH, LENGTH_OR_NONE
from helibore.cli.reading import COLUMNS, FILE, Command, nulls, open_calipers, taking, wall_settings
from helibore.wall.archive import ENDING as ARCHIVE

if TYPE_CHECKING:
    from helibore.cli.terminal import Terminal
    from helibore.images.sector_image import SectorImage
    from helibore.runs.run import Run
    from helibore.samples.caliper import Caliper
    from helibore.trajectory.survey import Path as WellPath
    from helibore.wall.wall import Wall

SETTINGS = ".toml"

OPTIONS: tuple[Callable[[Command], Command], ...] = (
    click.argument("source", type=FILE, required=False),
    click.option("--bit-diameter", type=BIT, help="Bit size, as 8.5in or '8 1/2in'; archives and settings have it."),
    click.option("--average", metavar="FILE:CHANNEL", help="Average caliper instead of SOURCE: shape assumed round."),
    click.option("--gauge", is_flag=True, help="Gauge hole instead of SOURCE: not measured, carries images only."),
    click.option(
        "--image", "images", metavar="FILE:CHANNEL:ORIGIN[:REFERENCE]", multiple=True,
        help="An image; ORIGIN says what of sector 1 lies at toolface 0: its centre or its edge; REFERENCE what "
        "toolface 0 of the image is, if it is not the wall's: north or high-side. Repeatable.",
    ),
    *COLUMNS,
    click.option("--from", "start_depth", type=LENGTH, help="Depth to start at.  [top of the wall]"),
    click.option("--to", "stop_depth", type=LENGTH, help="Depth to stop at.  [bottom of the wall]"),
    click.option("--sectors", type=int, default=64, show_default=True, help="Vertices a turn."),
    click.option("--pitch", type=LENGTH, default="100mm", show_default=True, help="Of the helix."),
    click.option("--max-distance", type=LENGTH_OR_NONE, default="1m", show_default=True, help="Reach of a sample."),
    click.option(
        "--reference", type=click.Choice(["high-side", "north"]),
        help="What toolface 0 of a wall without a survey is.  [images: high-side; else not known]",
    ),
)  # fmt: skip


takes_a_wall = taking(*OPTIONS)
"""Give a command SOURCE and the options that say how a wall is made of it."""

COLUMN_OPTIONS: tuple[str, ...] = ("maps", "set_name", "depth", "toolface", "radius", "diameter", "time")
WALL_OPTIONS: tuple[str, ...] = ("bit_diameter", "sectors", "pitch", "max_distance")


@dataclass(frozen=True)
class Sourced:
    """A wall with its images, the name of where it came from, and what was read and left out: (label, sentence)."""

    wall: Wall
    name: str
    told: list[tuple[str, str]]


def wall_from(options: dict[str, Any], terminal: Terminal, path: WellPath | None = None) -> Sourced:
    """Take the options of `takes_a_wall`, and a path for a wall without one; return the wall they stand for."""
    source = options["source"]
    if (source is not None) + (options["average"] is not None) + options["gauge"] != 1:
        raise click.UsageError("one of SOURCE, --average and --gauge must say what the wall is made from")
    ending = source.suffix.lower() if source is not None else ""
    _check_heeded(options)
    if ending not in (ARCHIVE, SETTINGS) and options["bit_diameter"] is None:
        raise click.UsageError("--bit-diameter must be given: only archives (.wall) and settings (.toml) have it")
    if ending == ARCHIVE:
        with terminal.stage("read", f"Reopening {source.name}"):
            import helibore

            found = Sourced(helibore.load(source), source.stem, [("wall", f"{source.name}: archive of a wall")])
    elif ending == SETTINGS:
        with terminal.stage("rebuild", f"Repeating {source.name}"):
            from helibore.runs.run import repeat

            found = _sourced(repeat(source), Path(source.stem).stem)
    elif source is not None:
        found = _azimuthal(source, options, terminal)
    else:
        found = _round(options, terminal)
    if path is not None:
        if found.wall.path is not None:
            raise click.UsageError(f"--survey: {source.name} has a path of its own")
        found.wall.path = path
    with terminal.stage("images", "Reading images"):
        for spelling in options["images"]:
            image = _image(spelling, options, found.wall.path)
            found.wall.images[image.name] = image
            size = f"{image.depth.size:,} rows x {image.sectors} sectors, {image.missing:,} values missing"
            stated = found.wall.path or options["reference"] or spelling.endswith((":north", ":high-side"))
            unsaid = "" if stated else ", as nothing says otherwise (:north or --reference north would)"
            found.told.append(("image", f"{Path(spelling).name}: {size}, from {image.reference}{unsaid}"))
    return found


def idle(options: dict[str, Any]) -> tuple[tuple[str, ...], str]:
    """Return the options that have no say in what the wall is made from, and the words for what that is."""
    if options["source"] is not None and options["source"].suffix.lower() in (ARCHIVE, SETTINGS):
        own = f"{options['source'].name}, which has its own settings"
        return (*WALL_OPTIONS, *COLUMN_OPTIONS), f"the wall of {own}"
    if options["gauge"]:
        return COLUMN_OPTIONS, "--gauge, which reads no caliper"
    if options["average"] is not None:
        return tuple(name for name in COLUMN_OPTIONS if name != "set_name"), "--average, which names its channel"
    return (), ""


def _check_heeded(options: dict[str, Any]) -> None:
    """Refuse options that have no say in what the wall is made from."""
    unheeded, why = idle(options)
    context = click.get_current_context()
    for option in context.command.params:
        given = context.get_parameter_source(option.name or "") is ParameterSource.COMMANDLINE
        if given and option.name in unheeded:
            raise click.UsageError(f"{option.opts[0]}: has no say in {why}")


def _azimuthal(source: Path, options: dict[str, Any], terminal: Terminal) -> Sourced:
    """A caliper file, read as `reconstruct` reads it."""
    from helibore.runs.run import read, rebuild
    from helibore.runs.run_settings import RunSettings

    with terminal.stage("read", f"Reading {source.name}"):
        settings = RunSettings(caliper=(), wall=wall_settings(options), nulls=nulls(options))
        run = read(settings, open_calipers([source], options), None, None)
    with terminal.stage("rebuild", "Rebuilding the wall"):
        rebuild(run)
    return _sourced(run, source.name.split(".")[0])


def _sourced(run: Run, name: str) -> Sourced:
    """What a run made, and what it tells of it."""
    from helibore.runs.run import told

    if run.wall is None or run.prepared is None:
        raise RuntimeError("a run without a wall; this is a bug in helibore")
    return Sourced(run.wall, name, [*told(run), *run.prepared.report])


def _round(options: dict[str, Any], terminal: Terminal) -> Sourced:
    """A wall without directions: of an average caliper, or of bit size."""
    with terminal.stage("read", "Reading the caliper"):
        if options["average"] is not None:
            caliper, told = _average(options["average"], options)
            name = Path(options["average"].rpartition(":")[0]).name.split(".")[0]
        else:
            caliper, told, name = _gauge(options), [("wall", "gauge hole: not measured")], "Gauge hole"
    with terminal.stage("rebuild", f"Rebuilding the wall from {len(caliper):,} samples"):
        import helibore
        from helibore.runs.run import check_some

        settings = wall_settings(options)
        check_some(Path(options["average"] or name).name, caliper.depth, settings)
        return Sourced(helibore.reconstruct(caliper, **vars(settings)), name, told)


def _average(spelling: str, options: dict[str, Any]) -> tuple[Caliper, list[tuple[str, str]]]:
    """The mean diameters of a channel; what no caliper holds is missing, and counted."""
    import helibore
    from helibore.base import units
    from helibore.channels.columns import column
    from helibore.channels.roles import guess
    from helibore.samples.caliper import LARGEST_RADIUS

    file, _, name = spelling.rpartition(":")
    if not file:
        raise click.UsageError(f"--average {spelling}: must be FILE:CHANNEL")
    with helibore.open(file, nulls(options)) as opened, _named():
        one = opened.set(options["set_name"])
        role = guess(one).one("depth")
        if role is None:
            raise ValueError(f"{file}: no channel is a depth")
        depth, size, unit = column(one, role), one.numbers(name), one[name].unit
        try:
            size = size * units.factor(unit, units.LENGTH)
        except ValueError as error:
            raise ValueError(f"{file}, column {name}: {error}") from error
    there = np.isfinite(depth) & np.isfinite(size)
    usable = there & (size > 0) & (size <= 2 * LARGEST_RADIUS)
    if not usable.any():
        raise ValueError(f"{Path(file).name}, column {name}: no row has a depth and the diameter of a hole, in {unit}")
    read = f"{Path(file).name}: {one.rows:,} rows; {name} is the diameter, in {unit}; {role.channel} is the depth"
    told = [("caliper", read)]
    reasons = (((~there).sum(), "without a depth or diameter"), ((there & ~usable).sum(), "no hole is so large"))
    for count, what in reasons:
        if count:
            told.append(("dropped", f"{count:,} rows: {what}"))
    return helibore.Caliper.from_average(depth[usable], size[usable]), told


@contextmanager
def _named() -> Iterator[None]:
    """A channel that a file does not hold is the user's to put right."""
    try:
        yield
    except KeyError as error:
        raise ValueError(error.args[0]) from error


def _gauge(options: dict[str, Any]) -> Caliper:
    """Gauge hole between --from and --to, or as far as the images reach."""
    import helibore

    ends = [options["start_depth"], options["stop_depth"]]
    if None in ends:
        depths = [_image(one, options).depth for one in options["images"]]
        if not depths:
            raise click.UsageError("--gauge needs --from and --to, or an --image whose depths it takes")
        ends[0] = min(float(depth[0]) for depth in depths) if ends[0] is None else ends[0]
        ends[1] = max(float(depth[-1]) for depth in depths) if ends[1] is None else ends[1]
    return helibore.Caliper.gauge(ends[0], ends[1], options["bit_diameter"])


def _image(spelling: str, options: dict[str, Any], path: WellPath | None = None) -> SectorImage:
    """An image spelled FILE:CHANNEL:ORIGIN[:REFERENCE]."""
    import helibore

    reference = options["reference"] or (path.reference if path else "high-side")
    text = spelling
    for word in ("north", "high-side"):
        if spelling.endswith(f":{word}"):
            text, reference = spelling.removesuffix(f":{word}"), word
    parts = text.rsplit(":", 2)
    if len(parts) != 3 or parts[2] not in ("centre", "edge"):
        raise click.UsageError(
            f"--image {spelling}: must be FILE:CHANNEL:ORIGIN, ORIGIN centre or edge, or that and :REFERENCE, north or "
            "high-side"
        )
    if reference == "parallel-transport":
        raise click.UsageError(
            f"--image {spelling}: the wall's toolfaces count from a parallel-transport reference, no image's do: "
            "end it with :north or :high-side"
        )
    file, name, origin = parts
    with helibore.open(file, nulls(options)) as opened, _named():
        found = opened.image(name)
    try:
        return found.sector_image(origin, reference)  # type: ignore[arg-type]
    except ValueError as error:
        raise ValueError(f"{file}: {error}") from error
