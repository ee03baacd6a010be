"""``helibore reconstruct CALIPER -o wall.glb --bit-diameter 8.5in``: caliper files and a survey become a mesh.

Reads, prepares, rebuilds, places, saves, and says what was read and dropped and why, what was corrected, how large the
hole is, and what to trust. Beside the mesh it writes the settings that repeat it.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click
import numpy as np

from helibore.cli.quantities import ANGLE, BIT, LENGTH, LENGTH_OR_NONE, TIME, Parameter
from helibore.cli.reading import (
    COLUMNS,
    FILE,
    SURVEY,
    nulls,
    open_calipers,
    open_survey,
    open_track,
    refuse_beside_settings,
    taking,
    wall_settings,
)
from helibore.cli.sections import Sectioned
from helibore.cli.terminal import Terminal
from helibore.cli.wall_lines import wall_lines, written_lines
from helibore.mesh.mesh_files import SURFACE_ENDINGS
from helibore.wall.archive import ENDING as ARCHIVE

if TYPE_CHECKING:
    from helibore.base.arrays import Floats
    from helibore.runs.run import Run
    from helibore.runs.run_settings import RunSettings

ENDINGS = (*SURFACE_ENDINGS, ARCHIVE)
REPEATABLE = ("output", "quiet", "threads", "from_settings")
"""What may stand beside --from-settings: nothing that changes the mesh."""


class Numbers(Parameter[tuple[int, ...]]):
    """``2,3,5``."""

    name = "numbers"

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> tuple[int, ...]:
        """Read the text of an option."""
        if isinstance(value, tuple):
            return value
        try:
            return tuple(int(one) for one in str(value).split(","))
        except ValueError:
            self.fail(f"'{value}': must be pass numbers, such as 2,3", param, ctx)


class Shift(Parameter[tuple[int, float]]):
    """``PASS=LENGTH``."""

    name = "pass=length"

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> tuple[int, float]:
        """Read the text of an option."""
        number, mark, length = str(value).partition("=")
        try:
            found = LENGTH.convert(length, param, ctx)
            if not mark or found is None:
                raise ValueError
            return int(number), found
        except ValueError:
            self.fail(f"'{value}': must be PASS=LENGTH, such as 3=-0.2m", param, ctx)


class Reconstruct(Sectioned):
    """The verb, its many options in sections."""

    sections = {  # noqa: RUF012
        "--map": "Columns", "--track": "Sensors", "--samples-from": "Conditioning", "--recentre": "Eccentering",
        "--split-passes": "Passes", "--survey": "Path and toolface", "--from": "Wall",
    }  # fmt: skip


@click.command(cls=Reconstruct, short_help="Caliper files and a survey to a mesh.")
@click.argument("caliper", type=FILE, nargs=-1)
@click.option(
    "-o", "--output", type=FILE, help="To write: .glb, .vtu, .vtp, .vtkhdf, .ply, .obj, .stl, or .wall, which reopens."
)
@click.option("--bit-diameter", type=BIT, help="Bit size, as 8.5in or '8 1/2in' or 0.216m.")
@click.option("--from-settings", type=FILE, help="Repeat the run of a wall.glb.toml, to the last bit.")
@click.option("-q", "--quiet", is_flag=True, help="Print nothing but errors.")
@taking(*COLUMNS)
@click.option("--travel-time", metavar="COLUMN", multiple=True, help="NAME[@ANGLE][:UNIT] of an echo's travel time.")
@click.option("--track", type=FILE, help="File with depth (and toolface) by time, for a caliper that has only a time.")
@click.option("--track-map", type=FILE, help="Roles of that file as TOML (see inspect).")
@click.option("--sensor-offset", type=LENGTH, default="0m", show_default=True, help="From the depth up to all sensors.")
@click.option("--latency", type=TIME, default="0s", show_default=True, help="Of all sensors: measurement to stamp.")
@click.option("--mud-velocity", type=float, help="Of sound, m/s, for travel times.")
@click.option("--tool-radius", type=LENGTH, help="From its axis to the transducer, for travel times.")
@click.option("--echo-window", type=TIME, default="0s", show_default=True, help="Time of the echo inside the tool.")
@click.option("--samples-from", type=LENGTH, help="Leave out shallower samples.")
@click.option("--samples-to", type=LENGTH, help="Leave out deeper samples.")
@click.option("--drop-closed", type=LENGTH, metavar="RADIUS", help="Rows where no arm reads more than the closed tool.")
@click.option("--drop-stuck", type=int, metavar="ROWS", help="Arms that stand still so long while others move.")
@click.option("--radius-range", type=LENGTH, nargs=2, metavar="LEAST MOST", help="Leave out radii beyond.")
@click.option("--drop-repeated", is_flag=True, help="Samples equal to an earlier one.")
@click.option("--drop-spikes", type=float, metavar="DEVIATIONS", help="That neighbouring turns contradict; 6 is usual.")
@click.option("--turn-height", type=LENGTH, help="A turn of a tool that does not turn.  [rotation, image row]")
@click.option("--recentre", is_flag=True, help="Take the tool's offset out of every turn.")
@click.option("--centres", type=FILE, help="Write centre, deviation and inliers of each turn: .csv, .csv.gz or .npz.")
@click.option("--split-passes", type=LENGTH, metavar="REVERSAL", help="A pass begins where the tool went back so far.")
@click.option("--passes", type=Numbers(), help="Passes to use, as 2,3.  [all]")
@click.option("--latest", is_flag=True, help="In each 0.5 m, only the last pass that was there.  [merged]")
@click.option("--shift", "shifts", type=Shift(), multiple=True, help="Added to a pass's depths: 3=-0.2m; repeatable.")
@click.option("--find-shifts", is_flag=True, help="Find each pass's depth shift from the overlap.")
@click.option(
    "--bias",
    type=click.Choice(["none", "arm", "side"]),
    default="none",
    show_default=True,
    help="Take off what each pass and arm reads too much; side: by the side it lies on.",
)
@click.option("--compare-with", type=Numbers(), help="Earlier passes: how much larger is the wall? An attribute.")
@taking(*SURVEY)
@click.option("--method", type=click.Choice(["minimum-curvature", "radius-of-curvature"]), default="minimum-curvature")
@click.option(
    "--toolface-from",
    type=click.Choice(["north", "high-side", "automatic"]),
    help="What the samples' toolface counts from; automatic: by inclination.  [the file's map, or the wall's]",
)
@click.option(
    "--switch", type=ANGLE, nargs=2, default=("4deg", "6deg"), help="Automatic: high side from 6 deg, north to 4."
)
@click.option("--from", "start_depth", type=LENGTH, help="Depth to start at.  [shallowest sample]")
@click.option("--to", "stop_depth", type=LENGTH, help="Depth to stop at.  [deepest sample]")
@click.option("--sectors", type=int, default=64, show_default=True, help="Vertices a turn.")
@click.option("--pitch", type=LENGTH, default="100mm", show_default=True, help="Of the helix; negative: upwards.")
@click.option("--start-toolface", type=ANGLE, default="0deg", show_default=True, help="Of the first vertex.")
@click.option("--neighbors", type=int, default=8, show_default=True, help="Nearest samples a vertex is made from.")
@click.option("--window", type=int, help="Search only so many samples around a vertex, as published.  [all]")
@click.option("--power", type=float, default=1.0, show_default=True, help="Weights are distance^-power.")
@click.option(
    "--max-distance", type=LENGTH_OR_NONE, default="1m", show_default=True, help="Reach of a sample, or none."
)
@click.option("--max-iterations", type=int, default=4, show_default=True)
@click.option("--tolerance", type=LENGTH, default="0.001mm", show_default=True, help="Move that ends the iteration.")
@click.option(
    "--angular-scale",
    type=float,
    default=1.0,
    show_default=True,
    help="1: true arc; 2: as published; 4: neighbours from above and below first.",
)
@click.option("--color-by", type=click.Choice(["radius", "difference"]), default="radius", show_default=True)
@click.option("--threads", type=int, help="[all cores]")
@click.pass_context
def reconstruct(
    ctx: click.Context, /, caliper: tuple[Path, ...], output: Path | None, from_settings: Path | None, quiet: bool,
    **options: Any,
) -> None:  # fmt: skip
    """Turn the samples in CALIPER into a mesh of the wall: CSV, Parquet, LAS, DLIS, JSON, WITSML or NPZ.

    \b
    helibore reconstruct caliper.csv --survey survey.csv -o wall.glb --bit-diameter 8.5in
    helibore reconstruct xy.csv.gz --diameter x_in@0 --diameter y_in@90 --from 3080 --to 3240m \\
                         -o wall.glb --bit-diameter 6.2in
    helibore reconstruct run1.las run2.las --map map.toml --drop-spikes 6 --find-shifts --compare-with 1 \\
                         -o wall.glb --bit-diameter 216mm
    helibore reconstruct --from-settings wall.glb.toml -o again.glb

    What each column is gets guessed from names and units, and printed; `helibore inspect` prints the map to change it.
    @ANGLE is where an arm is mounted; a diameter counts for both sides. Several files are passes over one hole,
    earliest first. Beside wall.glb stands wall.glb.toml, with which the run can be repeated. A .wall keeps samples,
    settings and path, and reopens (hb.load).
    """
    if output is None:
        raise click.UsageError("Missing option '-o' / '--output'.")
    _check_output(output, options)
    terminal = Terminal(quiet)
    run = _repeat(ctx, from_settings, terminal) if from_settings is not None else _read(caliper, options, terminal)
    _work(run, terminal, options["threads"])
    with terminal.stage("save", f"Writing {output.name}"):
        from helibore.runs.run import save

        expected = run.settings.output_blake2b
        settings = save(run, output)
        if options["centres"] is not None:
            _write_centres(run, options["centres"])
    if not quiet:
        terminal.summary(
            [*_lines(run), *written_lines(output, settings.output_blake2b, expected), ("time", terminal.times())]
        )


def _read(caliper: tuple[Path, ...], options: dict[str, Any], terminal: Terminal) -> Run:
    """Open and read everything the options name."""
    if not caliper:
        raise click.UsageError("Missing argument 'CALIPER...'.")
    if options["bit_diameter"] is None:
        raise click.UsageError("Missing option '--bit-diameter'.")
    start, stop = options["start_depth"], options["stop_depth"]
    if start is not None and stop is not None and not start < stop:
        raise ValueError(f"--to {stop:g} m: must be deeper than --from {start:g} m")
    if options["reference"] == "parallel-transport" and options["survey"] is None:
        raise click.UsageError("--reference parallel-transport: needs --survey")
    with terminal.stage("import", "Loading helibore"):
        from helibore.runs.run import read
    with terminal.stage("read", f"Reading {', '.join(file.name for file in caliper)}"):
        track = open_track(options)
        found = open_calipers(caliper, options, track is not None)
        settings = _settings(options)
        return read(settings, found, open_survey(options), track)


def _repeat(ctx: click.Context, from_settings: Path, terminal: Terminal) -> Run:
    """Open and read what the settings of an earlier run name."""
    refuse_beside_settings(ctx, REPEATABLE)
    with terminal.stage("import", "Loading helibore"):
        from helibore.runs.run import read, reopened
        from helibore.runs.run_settings import read_settings
    with terminal.stage("read", f"Reading what {from_settings.name} names"):
        settings = read_settings(from_settings)
        return read(settings, *reopened(settings))


def _work(run: Run, terminal: Terminal, threads: int | None) -> None:
    from helibore.runs.run import place, rebuild

    with terminal.stage("rebuild", "Rebuilding the wall"):
        rebuild(run, threads)
    with terminal.stage("place", f"Placing {len(run.wall or ()):,} vertices"):
        place(run)


def _check_output(output: Path, options: dict[str, Any]) -> None:
    """Refuse before the work what would fail after it."""
    if output.suffix.lower() not in ENDINGS:
        raise ValueError(f"{output}: the ending must be one of {', '.join(ENDINGS)}")
    centres = options["centres"]
    if centres is not None and not centres.name.endswith((".csv", ".csv.gz", ".npz")):
        raise ValueError(f"{centres}: the ending must be one of .csv, .csv.gz, .npz")
    if centres is not None and not options["recentre"]:
        raise click.UsageError("--centres: needs --recentre")
    if options["color_by"] == "difference" and not options["compare_with"]:
        raise click.UsageError("--color-by difference: needs --compare-with")
    for file in (output, *([centres] if centres is not None else [])):
        if not file.parent.is_dir():
            raise ValueError(f"{file}: the folder {file.parent} must be there")


def _settings(options: dict[str, Any]) -> RunSettings:
    """The options as the settings of a run; files are added when they have been read."""
    from helibore.preparation.conditioning import Echo
    from helibore.preparation.prepare import Preparation
    from helibore.runs.run_settings import PathSettings, RunSettings

    echo = None
    if options["mud_velocity"] is not None or options["tool_radius"] is not None:
        if options["mud_velocity"] is None or options["tool_radius"] is None:
            raise click.UsageError("--mud-velocity and --tool-radius: travel times need both")
        echo = Echo(options["mud_velocity"], options["tool_radius"], options["echo_window"])
    least, most = options["radius_range"] or (None, None)
    steep, level = options["switch"]
    preparation = Preparation(
        shallowest=options["samples_from"], deepest=options["samples_to"], closed=options["drop_closed"],
        stuck=options["drop_stuck"], least_radius=least, greatest_radius=most, repeated=options["drop_repeated"],
        spikes=options["drop_spikes"], turn_height=options["turn_height"], sensor_offset=options["sensor_offset"],
        latency=options["latency"], toolface_from=options["toolface_from"], steep=steep, level=level,
        recentre=options["recentre"], reversal=options["split_passes"], passes=options["passes"],
        latest=options["latest"], shifts=tuple(options["shifts"]), find_shifts=options["find_shifts"],
        bias=options["bias"], earlier=options["compare_with"] or (),
    )  # fmt: skip
    way = PathSettings(
        **{name: options[name] for name in ("method", "reference", "extend")},
        head=tuple(float(one) for one in options["head"]),
    )
    color_by = None if options["color_by"] == "radius" else options["color_by"]
    return RunSettings(
        caliper=(), wall=wall_settings(options), echo=echo, preparation=preparation, path=way, nulls=nulls(options),
        color_by=color_by,
    )  # fmt: skip


def _write_centres(run: Run, file: Path) -> None:
    """Publish the tool's centre in each turn as columns of a table."""
    from helibore.files.table_writing import write_table

    if run.prepared is None or run.prepared.centres is None or run.prepared.centre_depth is None:
        return
    found = run.prepared.centres
    columns: dict[str, tuple[Floats, int]] = {
        "depth_m": (run.prepared.centre_depth, 4),
        "turn": (found.turn.astype(np.float64), 0),
        **{f"{name}_m": (getattr(found, name), 7) for name in ("x", "y", "sigma_x", "sigma_y", "eccentering")},
        "direction_deg": (found.direction, 2),
        **{f"{name}_m": (getattr(found, name), 7) for name in ("mean_radius", "noise")},
        "inliers": (found.inliers, 4),
        "one_sided": (found.one_sided, 4),
        "samples": (found.samples.astype(np.float64), 0),
    }
    write_table(file, columns)


def _lines(run: Run) -> Iterator[tuple[str, str]]:
    """Yield what was read, what was done to it, and the wall, as labels and texts."""
    from helibore.runs.run import told

    if run.prepared is None or run.wall is None or run.surface is None:
        return
    yield from told(run)
    inside = _inside(run)
    if not run.prepared.report and not any(found.missing for found in run.readings):
        yield "dropped", "nothing"
    yield from run.prepared.report
    yield "samples", f"{len(run.prepared.caliper):,}, {inside.size:,} of them in the interval"
    yield from wall_lines(run.wall, len(run.surface.quads), 2.0 * float(inside.mean()))
    if run.earlier is not None:
        values = 1e3 * run.surface.attributes["difference"]
        known = values[np.isfinite(values)]
        middle = (
            f"{np.median(known):+.2f} mm in the median, {known.min():+.2f} to {known.max():+.2f}"
            if known.size
            else "none"
        )
        yield "difference", f"wall less that of the earlier passes: {middle}; {known.size:,} of {values.size:,} quads"


def _inside(run: Run) -> Floats:
    """The radii of the samples in the wall's interval."""
    from helibore.runs.run import interval

    if run.prepared is None:
        raise RuntimeError("no samples are prepared; this is a bug in helibore")
    samples, (top, bottom) = run.prepared.caliper, interval(run.settings.wall)
    if top == -np.inf and bottom == np.inf:
        return samples.radius
    return samples.radius[(samples.depth >= top) & (samples.depth <= bottom)]
