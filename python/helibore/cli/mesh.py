"""``helibore mesh``: a wall with its images as a mesh, or thickened into hexahedra: also of a hole without a caliper.

    SOURCE, --average or --gauge --> wall --images, survey--> surface, or volume by --shell --> file

What samples are made of is the business of ``reconstruct``; this writes what is a wall already, or no measured shape.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click
import numpy as np

from helibore.cli.plot import check_folder
from helibore.cli.quantities import LENGTH
from helibore.cli.reading import FILE, SURVEY_FILE, open_survey, refuse_beside_settings, taking
from helibore.cli.terminal import Terminal
from helibore.cli.wall_lines import written_lines
from helibore.cli.wall_source import SETTINGS, Sourced, takes_a_wall, wall_from
from helibore.mesh.mesh_files import SURFACE_ENDINGS, VOLUME_ENDINGS
from helibore.mesh.surface import Surface
from helibore.mesh.volume import Volume
from helibore.runs.mesh_settings import inputs, read_mesh_settings, write_mesh_settings
from helibore.trajectory.references import Reference
from helibore.trajectory.survey import Path as WellPath
from helibore.wall.archive import ENDING as ARCHIVE
from helibore.wall.wall import Wall

COLORED = (".glb", ".ply")
COLORLESS = (ARCHIVE, ".obj", ".stl")
WHOLE = (ARCHIVE, SETTINGS)  # sources that say themselves from where to where their wall goes


@click.command()
@click.option("-o", "--output", type=FILE, required=True, help=f"To write: {', '.join(SURFACE_ENDINGS)}, or .wall.")
@click.option(
    "--shell", "shells", type=LENGTH, multiple=True,
    help=f"Thickness beyond the wall, rising: a volume of hexahedra ({', '.join(VOLUME_ENDINGS)}); repeatable.",
)  # fmt: skip
@click.option("--color-by", metavar="NAME", help="An image, or radius: of GLB, PLY and VTK.  [the first, else radius]")
@click.option("-q", "--quiet", is_flag=True, help="Print nothing but errors.")
@takes_a_wall
@taking(*SURVEY_FILE)
@click.option("--from-settings", type=FILE, help="Repeat the mesh these settings were written beside; with -o only.")
@click.pass_context
def mesh(ctx: click.Context, /, from_settings: Path | None, **options: Any) -> None:
    """A wall with its images as a mesh.

    \b
    helibore mesh --gauge --bit-diameter 8.5in --image mem.las:ABDC:edge --survey survey.csv -o well.glb
    helibore mesh --average log.json:CALCM --bit-diameter 8.5in --image log.json:GRCS:edge -o well.vtu
    helibore mesh well.wall --shell 5cm --shell 20cm -o volume.vtkhdf
    helibore mesh --from-settings volume.vtkhdf.toml -o again.vtkhdf

    SOURCE and what makes the wall of it are those of `helibore plot`: a hole without a caliper will do. Every shell has
    the values of the images. Beside well.glb stands well.glb.toml, with which it can be repeated.
    """
    if from_settings is None:
        return _make(ctx.command, options, "")
    refuse_beside_settings(ctx, ("output", "quiet", "from_settings"))
    found = read_mesh_settings(from_settings, ctx.command)
    words = [f"--output={options['output']}", *(["--quiet"] if options["quiet"] else []), *found.words]
    with ctx.command.make_context(ctx.info_name, words, parent=ctx.parent) as again:
        return _make(ctx.command, again.params, found.blake2b)


def _make(command: click.Command, options: dict[str, Any], expected: str) -> None:
    """Make a mesh, and its settings beside it; ``expected`` is the checksum it had, where it is repeated."""
    output, shells, color_by = options["output"], options["shells"], options["color_by"]
    endings = (*VOLUME_ENDINGS,) if shells else (*SURFACE_ENDINGS, ARCHIVE)
    if output.suffix.lower() not in endings:
        raise ValueError(f"{output}: the ending must be one of {', '.join(endings)}")
    _check_heeded(output, shells, color_by, options)
    check_folder(output)
    from helibore.runs.run import placing
    from helibore.runs.run_settings import checksum, settings_file

    files = inputs(options)
    for file in files:
        if file.resolve() in (output.resolve(), settings_file(output).resolve()):
            raise ValueError(f"{output}: would be written over {file}, which it is made from")
    terminal = Terminal(options["quiet"])
    path, told = _path(options)
    found = wall_from(options, terminal, path)
    ends = (options["start_depth"], options["stop_depth"])
    with terminal.stage("place", "Placing"), placing(found.wall, options["survey"] or options["source"]):
        made = _volume(found.wall, shells, *ends) if shells else found.wall.surface("own", *ends)
    with terminal.stage("save", f"Writing {output.name}"):
        read = {file: checksum(file) for file in files}
        _save(found.wall, made, output, color_by)
        blake2b = checksum(output)
        write_mesh_settings(command, options, read, blake2b)
    wrote = written_lines(output, blake2b, expected)
    terminal.summary([*told, *found.told, *_lines(found, made), ("time", terminal.times()), *wrote])


def _check_heeded(output: Path, shells: tuple[float, ...], color_by: str | None, options: dict[str, Any]) -> None:
    """Refuse what the output would not heed: colours where it has none, an interval of a wall that is kept whole."""
    ending, source = output.suffix.lower(), options["source"]
    if color_by is not None and (shells or ending in COLORLESS):
        raise click.UsageError(f"--color-by: has no say in {'a volume' if shells else ending}, which has no colours")
    if ending != ARCHIVE or source is None or source.suffix.lower() not in WHOLE:
        return
    for option, name in (("--from", "start_depth"), ("--to", "stop_depth")):
        if options[name] is not None:
            raise click.UsageError(f"{option}: has no say in {ending}, which holds all of {source.name}")


def _path(options: dict[str, Any]) -> tuple[WellPath | None, list[tuple[str, str]]]:
    """The path of the survey, where there is one."""
    from helibore.runs.run import first_station

    file = open_survey(options)
    if file is None:
        return None, []
    survey = file.one.survey(file.roles)
    stations = f"{file.file.name}: {survey.depth.size} stations, {survey.depth[0]:g} to {survey.depth[-1]:g} m"
    reference: Reference = options["reference"] or "high-side"
    path = survey.path(reference=reference, head=options["head"], extend=options["extend"])
    origin = first_station(file, survey, options["head"])
    return path, [("survey", stations), *([("", origin)] if origin else [])]


def _volume(wall: Wall, shells: tuple[float, ...], start: float | None, stop: float | None) -> Volume:
    volume = wall.volume("own", list(shells), start, stop)
    for name, image in wall.images.items():
        volume.hang(name, [image.on(wall)] * len(shells), image.unit)
    return volume


def _save(wall: Wall, made: Surface | Volume, output: Path, color_by: str | None) -> None:
    """Write it; where the file has colours, as is customary for what it is coloured by."""
    if output.suffix.lower() == ARCHIVE:
        wall.save(output)
    elif isinstance(made, Volume):
        made.save(output)
    else:
        name = color_by or next(iter(wall.images), "radius")
        made.save(output, color_by=None if name == "radius" else name, **_colors(wall, made, output, name))


def _colors(wall: Wall, made: Surface, output: Path, name: str) -> dict[str, Any]:
    """The colours of an image: its customary map, between percentiles where it has a range."""
    from helibore.base.colors import customary_map
    from helibore.images.normalization import PERCENTILES

    values = made.attributes[name] if name in wall.images else np.empty(0)
    there = values[np.isfinite(values)]
    if output.suffix.lower() not in COLORED or not there.size:
        return {}
    color_map = customary_map(wall.images[name].name, wall.images[name].unit)
    low, high = np.percentile(there, PERCENTILES)
    limits = (float(low), float(high)) if low < high else None
    return {"limits": limits, "color_map": color_map, "log": color_map == "resistivity"}


def _lines(found: Sourced, made: Surface | Volume) -> list[tuple[str, str]]:
    from helibore.samples.caliper import BASIS_TEXT

    cells = f"{len(made.hexes):,} hexahedra" if isinstance(made, Volume) else f"{len(made.quads):,} quads"
    lines = [("wall", f"{BASIS_TEXT[found.wall.basis]}; {cells}")]
    for name, values in made.attributes.items():
        missing = int(np.count_nonzero(np.isnan(values)))
        lines.append(("missing", f"{missing:,} of {values.size:,} cells have no {name}"))
    return lines
