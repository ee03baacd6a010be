"""``helibore reconstruct CALIPER -o wall.glb --bit-diameter 8.5in``: a caliper file and a survey become a mesh.

Reads, rebuilds, places, saves, and says what was read and dropped, how large the hole is, and what to trust.
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click
import numpy as np

from helibore.cli.quantities import ANGLE, LENGTH, LENGTH_OR_NONE
from helibore.cli.terminal import Terminal

if TYPE_CHECKING:
    import helibore
    from helibore.arrays import Floats
    from helibore.caliper_file import CaliperReading
    from helibore.survey_file import SurveyReading

FILE = click.Path(path_type=Path)
INCH = 0.0254
ENDINGS = (".glb", ".ply", ".obj", ".stl")


@click.command(short_help="A caliper file and a survey to a mesh.")
@click.argument("caliper", type=FILE)
@click.option("-o", "--output", type=FILE, required=True, help="Mesh to write: .glb, .ply, .obj or .stl.")
@click.option("--bit-diameter", type=LENGTH, required=True, help="Bit size, as 8.5in or '8 1/2in' or 0.216m.")
@click.option("--depth", metavar="COLUMN", help="NAME[:UNIT] of the depth.")
@click.option("--toolface", metavar="COLUMN", help="NAME[:UNIT] of the toolface or relative bearing.")
@click.option("--radius", metavar="COLUMN", multiple=True, help="NAME[@ANGLE][:UNIT] of an arm's radius; repeatable.")
@click.option("--diameter", metavar="COLUMN", multiple=True, help="NAME[@ANGLE][:UNIT] of a diameter; repeatable.")
@click.option("--time", metavar="COLUMN", help="NAME[:UNIT] of the time.")
@click.option("--absent", type=float, multiple=True, help="A number that means no value.  [-999.25 and -9999]")
@click.option("--from", "start_depth", type=LENGTH, help="Depth to start at.  [shallowest sample]")
@click.option("--to", "stop_depth", type=LENGTH, help="Depth to stop at.  [deepest sample]")
@click.option("--survey", type=FILE, help="Survey file; without one the hole is straight and vertical.")
@click.option("--survey-depth", metavar="COLUMN", help="NAME[:UNIT] of the stations' depth.")
@click.option("--inclination", metavar="COLUMN", help="NAME[:UNIT] of the inclination.")
@click.option("--azimuth", metavar="COLUMN", help="NAME[:UNIT] of the azimuth.")
@click.option("--method", type=click.Choice(["minimum-curvature", "radius-of-curvature"]), default="minimum-curvature")
@click.option("--reference", type=click.Choice(["high-side", "north"]), default="high-side", help="What toolface 0 is.")
@click.option("--head", type=LENGTH, nargs=3, default=(0, 0, 0), help="North, east, down of the first station.")
@click.option("--extend", type=LENGTH, default="0m", show_default=True, help="Straight on past the last station.")
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
@click.option("--angular-scale", type=float, default=1.0, show_default=True, help="1: true arc; 2: as published.")
@click.option("--threads", type=int, help="[all cores]")
@click.option("-q", "--quiet", is_flag=True, help="Print nothing but errors.")
def reconstruct(caliper: Path, output: Path, survey: Path | None, quiet: bool, **options: Any) -> None:
    """Turn the samples in CALIPER, CSV (.gz) or NPZ, into a mesh of the wall.

    \b
    helibore reconstruct caliper.csv --survey survey.csv -o wall.glb --bit-diameter 8.5in
    helibore reconstruct xy.csv.gz --diameter x_in@0 --diameter y_in@90 --from 3080 --to 3240m \\
                         -o wall.glb --bit-diameter 6.2in
    helibore reconstruct log.csv --depth MD:ft --toolface TF:rad --radius R:mm -o wall.ply --bit-diameter 216mm

    Columns of a usual name (depth or md, toolface or rb, radius, diameter, time) are found by themselves, units by the
    ending of the name (md_m, CAL (in)); what was assumed is printed. @ANGLE is where an arm is mounted: a diameter
    there counts for both sides.
    """
    _check_output(output)
    terminal = Terminal(quiet)
    with terminal.stage("import", "Loading helibore"):
        import helibore
        from helibore.caliper_file import read_caliper
        from helibore.survey_file import read_survey
        from helibore.table_file import ABSENT
    absent = options["absent"] or ABSENT
    with terminal.stage("read", f"Reading {caliper.name}"):
        columns = {name: options[name] for name in ("depth", "toolface", "radius", "diameter", "time")}
        reading = read_caliper(caliper, **columns, absent=absent)
        stations = path = None
        if survey is not None:
            chosen = {"depth": options["survey_depth"]} | {name: options[name] for name in ("inclination", "azimuth")}
            stations = read_survey(survey, **chosen, absent=absent)
            placing = {name: options[name] for name in ("method", "reference", "head", "extend")}
            path = stations.survey.path(**placing)
    inside = _check_interval(caliper, reading, options)
    with terminal.stage("rebuild", f"Rebuilding the wall from {len(reading.caliper):,} samples"):
        wall = helibore.reconstruct(reading.caliper, **_settings(options))
    with terminal.stage("place", f"Placing {len(wall):,} vertices"):
        surface = wall.surface(path)
    with terminal.stage("save", f"Writing {output.name}"):
        surface.save(output)
    if not quiet:
        lines = _read_lines("caliper", caliper, reading, f"{inside.size:,} samples in the interval")
        if survey is not None and stations is not None:
            lines += _read_lines("survey", survey, stations, f"{len(stations.survey)} stations")
        lines += wall_lines(wall, len(surface.quads), 2.0 * float(inside.mean()))
        lines += [("time", terminal.times()), ("wrote", f"{output} ({output.stat().st_size / 1e6:,.1f} MB)")]
        terminal.summary(lines)


def _check_output(output: Path) -> None:
    """Refuse before the work what would fail after it."""
    if output.suffix.lower() not in ENDINGS:
        raise ValueError(f"{output}: the ending must be one of {', '.join(ENDINGS)}")
    if not output.parent.is_dir():
        raise ValueError(f"{output}: the folder {output.parent} must be there")


def _settings(options: dict[str, Any]) -> dict[str, Any]:
    names = (
        "bit_diameter", "sectors", "pitch", "start_depth", "stop_depth", "start_toolface", "neighbors", "window",
        "power", "max_distance", "max_iterations", "tolerance", "angular_scale", "threads",
    )  # fmt: skip
    settings = {name: options[name] for name in names}
    if options["pitch"] < 0:  # the helix starts at its deep end
        settings["start_depth"], settings["stop_depth"] = options["stop_depth"], options["start_depth"]
    return settings


def _check_interval(caliper: Path, reading: CaliperReading, options: dict[str, Any]) -> Floats:
    """Return the radii of the samples between --from and --to; refuse an interval without any."""
    start, stop = options["start_depth"], options["stop_depth"]
    if start is not None and stop is not None and not start < stop:
        raise ValueError(f"--to {stop:g} m: must be deeper than --from {start:g} m")
    samples = reading.caliper
    if start is None and stop is None:
        return samples.radius
    start = -np.inf if start is None else start
    stop = np.inf if stop is None else stop
    inside = samples.radius[(samples.depth >= start) & (samples.depth <= stop)]
    if not inside.size:
        low, high = samples.depth.min(), samples.depth.max()
        raise ValueError(f"{caliper}: no samples between {start:g} and {stop:g} m; it has {low:g} to {high:g} m")
    return inside


def _read_lines(label: str, file: Path, reading: CaliperReading | SurveyReading, found: str) -> list[tuple[str, str]]:
    lines = [(label, f"{file.name}: {reading.notes[0]}, {reading.rows:,} rows, {found}")]
    lines += [("", note) for note in reading.notes[1:]]
    lines += [("dropped", f"{count:,} rows without {name}") for name, count in reading.dropped.items()]
    return lines if reading.dropped else [*lines, ("dropped", "nothing")]


def diameters(wall: helibore.Wall) -> Floats:
    """Return the diameter across each vertex that has one half a turn deeper, metres; NaN where either is missing.

    With an odd number of sectors the far side is the mean of the two vertices next to it.
    """
    radius, sectors = wall.radius, wall.settings.sectors
    near, far = sectors // 2, (sectors + 1) // 2
    count = max(radius.size - far, 0)
    across: Floats = radius[:count] + 0.5 * (radius[near : near + count] + radius[far : far + count])
    return across


def wall_lines(wall: helibore.Wall, quads: int, samples_mean: float) -> list[tuple[str, str]]:
    """Return the summary a driller reads, as labels and texts; ``samples_mean`` is their mean diameter in metres."""
    settings, depth, nearest = wall.settings, wall.depth, wall.nearest
    bit = settings.bit_diameter
    lines = [
        ("wall", f"{depth.min():.2f} to {depth.max():.2f} m, {settings.sectors} sectors, pitch {settings.pitch:g} m: "
         f"{len(wall):,} vertices, {quads:,} quads, from {wall.sample_count:,} samples"),
        ("bit", f"{bit / INCH:.3f} in ({bit * 1e3:.1f} mm)"),
    ]  # fmt: skip
    across = diameters(wall)
    across = across[~np.isnan(across)]
    if across.size:
        sizes = (("mean", across.mean()), ("least", across.min()), ("greatest", across.max()))
        for index, (name, size) in enumerate(sizes):
            text = (
                f"{name:<9}{size / INCH:7.3f} in ({size * 1e3:6.1f} mm), {(size - bit) / INCH:+.3f} in against the bit"
            )
            lines.append(("diameter" if index == 0 else "", text))
        lines.append(("", f"samples  {samples_mean / INCH:7.3f} in ({samples_mean * 1e3:6.1f} mm), their mean"))
    without = float(np.mean(wall.support == 0)) if len(wall) else 1.0
    lines.append(("support", f"{100 * without:.2f} % of the vertices are without support (no sample in reach)"))
    if without < 1:
        middle, most = np.nanpercentile(nearest, [50, 99])
        lines.append(
            ("", f"nearest sample: {middle * 1e3:.0f} mm away for half of the vertices, {most * 1e3:.0f} mm for 99 %")
        )
    return lines
