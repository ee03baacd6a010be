"""``helibore reconstruct`` and ``helibore mesh``: write a wall as a mesh, a volume of hexahedra, or an archive.

Both commands have the same options and write the same files: `reconstruct` is the usual name for caliper files, `mesh`
for an archive, an average caliper or a gauge hole. `reconstruct` prints what error to expect.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import click

from helibore.base.errors import InputError, require_library
from helibore.base.file_endings import ARCHIVE_ENDING, SURFACE_ENDINGS, VOLUME_ENDINGS
from helibore.cli.declared_options import options_of
from helibore.cli.outputs import (
    OUTPUT,
    QUIET,
    add_measured,
    add_nearest,
    add_sigma,
    check_file,
    own_options,
    save_lines,
)
from helibore.cli.quantities import FILE
from helibore.cli.sections import Sectioned, opt, section
from helibore.cli.terminal import Terminal
from helibore.cli.wall_options import MADE, SHOWN, open_run, takes_a_wall
from helibore.settings.output_settings import MeshSettings

if TYPE_CHECKING:
    from helibore.runs.run import Run

ENDINGS = (*SURFACE_ENDINGS, ARCHIVE_ENDING)
TABLES = (".csv", ".csv.gz", ".npz")
COLORLESS = (ARCHIVE_ENDING, ".obj", ".stl")

WRITTEN = section(
    "Options",
    OUTPUT("What to write: .wall, an archive that keeps everything; or a mesh: .glb, .vtu, .vtp, .vtkhdf, .ply, .obj, "
           ".stl."),
    QUIET,
)  # fmt: skip
takes_a_mesh = section(
    "Mesh",
    *options_of(MeshSettings),
    opt("--centres", "With --recentre: table of centre, deviation and inliers of each turn: .csv, .csv.gz or .npz.",
        type=FILE),
)  # fmt: skip


@click.command(cls=Sectioned, common=(*MADE, "centres"))
@WRITTEN
@takes_a_mesh
@takes_a_wall
def reconstruct(**options: Any) -> None:
    """Build the wall of a borehole from caliper files and a survey.

    \b
    helibore reconstruct caliper.csv --survey survey.csv --bit-diameter 8.5in -o w.wall
    helibore reconstruct xy.csv.gz --column diameter=x_in@0 --column diameter=y_in@90 \\
                         --from 3080 --to 3240m --bit-diameter 6.2in -o w.glb
    helibore reconstruct run1.las run2.las --spikes 6 --find-shifts --bit-diameter 216mm -o w.wall
    helibore reconstruct well.toml -o w.wall               a project: files, header, settings
    helibore reconstruct w.wall.toml -o again.wall         a run repeated, to the last bit

    Several SOURCE files are passes over one hole, earliest first. Roles of columns are guessed and printed. plot,
    report, view, logs, mesh and zones read w.wall.
    """
    _write("reconstruct", options)


@click.command(cls=Sectioned, common=(*SHOWN, "shell", "sigma", "nearest", "measured", "color_by"))
@WRITTEN
@takes_a_mesh
@takes_a_wall
def mesh(**options: Any) -> None:
    """Build a mesh or a volume of a wall with its images, also of a hole without a caliper.

    \b
    helibore mesh --gauge --bit-diameter 8.5in --image mem.las:ABDC:edge --survey survey.csv -o well.glb
    helibore mesh --average log.json:CALCM --bit-diameter 8.5in --image log.json:GRCS:edge -o well.vtu
    helibore mesh well.wall --shell 5cm --shell 20cm -o volume.vtkhdf
    helibore mesh volume.vtkhdf.toml -o again.vtkhdf

    SOURCE is an archive (.wall), caliper files, or a project (.toml), by hand or as it stands beside an output.
    Every shell has the values of the images. The file well.glb.toml beside well.glb repeats the run.
    """
    _write("mesh", options)


def _write(verb: str, options: dict[str, Any]) -> None:
    output, centres = options["output"], options["centres"]
    terminal = Terminal(options["quiet"])
    check_file(output, ENDINGS)
    if centres is not None:
        check_file(centres, TABLES)
    run = open_run(options, terminal, (output, *([centres] if centres else [])))
    options = own_options(run, verb, options)
    ends, built = (options["start_depth"], options["stop_depth"]), run.settings.wall
    if built is not None and set(ends) == {built.start_depth, built.stop_depth}:
        ends = (None, None)  # the whole wall, which is built for this interval
    _check(run, options, ends)
    import numpy as np

    from helibore.cli.mesh_output import error_lines, made_lines, save_mesh, write_centres
    from helibore.mesh.surface import Surface
    from helibore.mesh.volume import Volume
    from helibore.runs.run import build_wall, placing, read_run, suit_images

    images, samples = read_run(run, terminal.stage)
    if verb == "reconstruct":
        suit_images(run, images, samples, chosen=True)
    build_wall(run, images, samples, options["threads"], terminal.stage)
    wall, shells = run.wall, list(options["shell"])
    if options["sigma"]:
        run.messages += add_sigma(wall, terminal)
    if options["nearest"]:
        add_nearest(wall)
    if options["measured"]:
        add_measured(wall)
    made: Surface | Volume
    with terminal.stage("place", f"Placing {len(wall):,} vertices"), placing(run):
        made = wall.volume("own", shells, *ends) if shells else wall.surface("own", *ends)
        if isinstance(made, Volume):
            for name, image in wall.images.items():
                made.hang(name, [image.on(wall)] * len(shells), image.unit)
            for name, values in wall.attributes.items():
                made.hang(name, [values] * len(shells), wall.attributes.units.get(name, ""))
    if not len(made.hexes if isinstance(made, Volume) else made.quads):
        low, high = wall.depth.min(initial=np.inf), wall.depth.max(initial=-np.inf)
        where = f"between {low:g} and {high:g} m, at {abs(wall.settings.pitch):g} m a turn"
        name = run.readings[0].name if run.readings else run.name
        raise InputError(name, f"no quads: no two turns of the wall lie side by side {where}")
    with terminal.stage("save", f"Writing {output.name}"):
        save_mesh(wall, made, output, options["color_by"])
        if centres is not None and run.prepared is not None and run.prepared.centres is not None:
            write_centres(run.prepared.centres, run.prepared.centre_depth, centres)
        saved = save_lines(run, output, verb, options, [centres] if centres else [])
    if not options["quiet"]:
        sure = []
        if verb == "reconstruct":
            sure = error_lines(run, options["threads"], terminal.stage)
        end = [*sure, *saved, ("time", terminal.times())]
        terminal.summary([*run.messages, *made_lines(run, made, ends), *end])


def _check(run: Run, options: dict[str, Any], ends: tuple[float | None, float | None]) -> None:
    """Refuse options that do not go with the output, such as colours in a format without any, or with the run."""
    output, ending, preparation = options["output"], options["output"].suffix.lower(), run.settings.preparation
    if options["shell"]:
        check_file(output, VOLUME_ENDINGS, " with --shell")
    else:
        check_file(output, ENDINGS)
    if ending == ".vtkhdf":
        require_library("h5py", "vtkhdf")
    if options["color_by"] is not None and (options["shell"] or ending in COLORLESS):
        kind = "a volume" if options["shell"] else ending
        raise click.UsageError(f"--color-by: does not go with {kind}, which has no colours")
    if options["color_by"] == "difference" and not preparation.earlier and run.settings.archive is None:
        raise click.UsageError("--color-by difference: needs --earlier")
    if options["centres"] is not None and not preparation.recentre:
        raise click.UsageError("--centres: needs --recentre")
    for name, end in zip(("--from", "--to"), ends, strict=True):
        if end is not None and ending == ARCHIVE_ENDING:
            raise click.UsageError(f"{name}: does not go with {ending}, which holds the whole wall")
