"""Where a wall to be drawn comes from: an archive, a caliper file, an average caliper, gauge hole; and its images.

well.wall                                   as `Wall.save` wrote it, images and all
caliper.csv --bit-diameter 8.5in            rebuilt from its samples
--average log.las:CALI --bit-diameter ...   size measured, shape assumed round
--gauge --bit-diameter ... --image ...      not measured: it only carries images
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click
import numpy as np

from helibore.cli.quantities import LENGTH, LENGTH_OR_NONE

if TYPE_CHECKING:
    from helibore.caliper import Caliper
    from helibore.cli.terminal import Terminal
    from helibore.sector_image import SectorImage
    from helibore.wall import Wall

FILE = click.Path(path_type=Path)
ARCHIVE = ".wall"

OPTIONS = (
    click.argument("source", type=FILE, required=False),
    click.option("--bit-diameter", type=LENGTH, help="Bit size, as 8.5in or '8 1/2in'; an archive has its own."),
    click.option("--average", metavar="FILE:CHANNEL", help="Average caliper instead of SOURCE: shape assumed round."),
    click.option("--gauge", is_flag=True, help="Gauge hole instead of SOURCE: not measured, carries images only."),
    click.option(
        "--image", "images", metavar="FILE:CHANNEL:ORIGIN", multiple=True,
        help="An image; ORIGIN says what of sector 1 lies at toolface 0: its centre or its edge. Repeatable.",
    ),
    click.option("--depth", metavar="COLUMN", help="NAME[:UNIT] of the depth."),
    click.option("--toolface", metavar="COLUMN", help="NAME[:UNIT] of the toolface or relative bearing."),
    click.option("--radius", metavar="COLUMN", multiple=True, help="NAME[@ANGLE][:UNIT] of a radius; repeatable."),
    click.option("--diameter", metavar="COLUMN", multiple=True, help="NAME[@ANGLE][:UNIT] of a diameter; repeatable."),
    click.option("--time", metavar="COLUMN", help="NAME[:UNIT] of the time."),
    click.option("--absent", type=float, multiple=True, help="A number that means no value.  [-999.25 and -9999]"),
    click.option("--from", "start_depth", type=LENGTH, help="Depth to start at.  [top of the wall]"),
    click.option("--to", "stop_depth", type=LENGTH, help="Depth to stop at.  [bottom of the wall]"),
    click.option("--sectors", type=int, default=64, show_default=True, help="Vertices a turn."),
    click.option("--pitch", type=LENGTH, default="100mm", show_default=True, help="Of the helix."),
    click.option("--max-distance", type=LENGTH_OR_NONE, default="1m", show_default=True, help="Reach of a sample."),
    click.option(
        "--reference", type=click.Choice(["high-side", "north"]), default="high-side", show_default=True,
        help="What toolface 0 is.",
    ),
)  # fmt: skip


def takes_a_wall(command: Callable[..., Any]) -> Callable[..., Any]:
    """Give a command SOURCE and the options that say how a wall is made of it."""
    for option in reversed(OPTIONS):
        command = option(command)
    return command


@dataclass(frozen=True)
class Sourced:
    """A wall with its images, where it came from, and what was left out on the way: (what, how many)."""

    wall: Wall
    name: str
    origins: list[str]
    dropped: list[tuple[str, int]] = field(default_factory=list)


def wall_from(options: dict[str, Any], terminal: Terminal) -> Sourced:
    """Take the options of `takes_a_wall` and return the wall they stand for."""
    source, average, gauge = options["source"], options["average"], options["gauge"]
    if (source is not None) + (average is not None) + gauge != 1:
        raise click.UsageError("one of SOURCE, --average and --gauge must say what the wall is made from")
    if source is not None and source.suffix.lower() == ARCHIVE:
        with terminal.stage("read", f"Reopening {source.name}"):
            import helibore

            found = Sourced(helibore.load(source), source.stem, [f"{source.name}: archive of a wall"])
    else:
        if options["bit_diameter"] is None:
            raise click.UsageError("--bit-diameter must be given: only an archive (.wall) has its own")
        found = _rebuilt(options, terminal)
    with terminal.stage("images", "Reading images"):
        for spelling in options["images"]:
            image = _image(spelling, options["reference"])
            found.wall.images[image.name] = image
            found.origins.append(f"{Path(spelling).name}: {image.depth.size:,} rows x {image.sectors} sectors")
    return found


def _rebuilt(options: dict[str, Any], terminal: Terminal) -> Sourced:
    source, average = options["source"], options["average"]
    with terminal.stage("read", "Reading the caliper"):
        if source is not None:
            caliper, origins, dropped = _azimuthal(source, options)
            name = source.name.split(".")[0]
        elif average is not None:
            caliper, origins, dropped = _average(average)
            name = Path(average.rpartition(":")[0]).name.split(".")[0]
        else:
            caliper = _gauge(options)
            name, origins, dropped = "Gauge hole", ["gauge hole: not measured"], []
    names = ("bit_diameter", "sectors", "pitch", "max_distance", "start_depth", "stop_depth")
    settings = {name: options[name] for name in names}
    if settings["pitch"] < 0:
        settings["start_depth"], settings["stop_depth"] = settings["stop_depth"], settings["start_depth"]
    with terminal.stage("rebuild", f"Rebuilding the wall from {len(caliper):,} samples"):
        import helibore

        wall = helibore.reconstruct(caliper, **settings)
    return Sourced(wall, name, origins, dropped)


def _azimuthal(source: Path, options: dict[str, Any]) -> tuple[Caliper, list[str], list[tuple[str, int]]]:
    from helibore.caliper_file import read_caliper
    from helibore.table_file import ABSENT

    columns = {name: options[name] for name in ("depth", "toolface", "radius", "diameter", "time")}
    reading = read_caliper(source, **columns, absent=options["absent"] or ABSENT)
    origins = [f"{source.name}: {reading.rows:,} rows", *reading.notes]
    return reading.caliper, origins, [(f"no value of {name}", count) for name, count in reading.dropped.items()]


def _average(spelling: str) -> tuple[Caliper, list[str], list[tuple[str, int]]]:
    """The mean diameters of a channel; what no caliper holds is missing, and counted."""
    import helibore
    from helibore import units
    from helibore.caliper import LARGEST_RADIUS
    from helibore.files.columns import column
    from helibore.roles import guess

    file, _, name = spelling.rpartition(":")
    if not file:
        raise click.UsageError(f"--average {spelling}: must be FILE:CHANNEL")
    with helibore.open(file) as opened:
        one = opened.set()
        role = guess(one).one("depth")
        if role is None:
            raise ValueError(f"{file}: no channel is a depth")
        depth, values = column(one, role), one.numbers(name)
        unit = one[name].unit
        size = values * units.factor(unit, units.LENGTH)
    there = np.isfinite(depth) & np.isfinite(size)
    usable = there & (size > 0) & (size <= 2 * LARGEST_RADIUS)
    dropped = [("no depth or diameter", int((~there).sum())), ("no diameter of a hole", int((there & ~usable).sum()))]
    caliper = helibore.Caliper.from_average(depth[usable], size[usable])
    origins = [f"{Path(file).name}: {one.rows:,} rows", f"diameter: {name}, unit {unit}; depth: {role.channel}"]
    return caliper, origins, [one for one in dropped if one[1]]


def _gauge(options: dict[str, Any]) -> Caliper:
    """Gauge hole between --from and --to, or as far as the images reach."""
    import helibore

    ends = [options["start_depth"], options["stop_depth"]]
    if None in ends:
        depths = [_image(one, options["reference"]).depth for one in options["images"]]
        if not depths:
            raise click.UsageError("--gauge needs --from and --to, or an --image whose depths it takes")
        ends[0] = min(float(depth[0]) for depth in depths) if ends[0] is None else ends[0]
        ends[1] = max(float(depth[-1]) for depth in depths) if ends[1] is None else ends[1]
    return helibore.Caliper.gauge(ends[0], ends[1], options["bit_diameter"])


def _image(spelling: str, reference: str) -> SectorImage:
    """An image spelled FILE:CHANNEL:ORIGIN."""
    import helibore

    parts = spelling.rsplit(":", 2)
    if len(parts) != 3 or parts[2] not in ("centre", "edge"):
        raise click.UsageError(f"--image {spelling}: must be FILE:CHANNEL:ORIGIN, ORIGIN centre or edge")
    file, name, origin = parts
    with helibore.open(file) as opened:
        found = opened.image(name)
    order = "counterclockwise" if found.step is not None and found.step < 0 else "clockwise"
    try:
        return helibore.SectorImage(
            found.depth, found.values, found.name, found.unit,
            origin=origin, reference=reference, direction=order, offset=found.first or 0.0,  # type: ignore[arg-type]
        )  # fmt: skip
    except ValueError as error:
        raise ValueError(f"{file}: {name}: {error}") from error
