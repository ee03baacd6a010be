"""``helibore demo``: simulate a hole, rebuild its wall, write a mesh and a picture, and print the error of the wall."""

from __future__ import annotations

from pathlib import Path

import click

from helibore.base.errors import InputError, MissingExtraError, needs
from helibore.cli.lines import summary_lines
from helibore.cli.outputs import QUIET
from helibore.cli.quantities import FOLDER
from helibore.cli.sections import opt, section
from helibore.cli.terminal import Terminal

DEPTH_SCALE, DPI = 250, 120
"""Depth scale of the picture, 1:250 (50 m of hole are 200 mm on paper), and its resolution, pixels per inch."""


@click.command(short_help="Simulate a hole and write its wall as a mesh and a picture.")
@section(
    "Options",
    opt("-o --output", "Folder to write to.", type=FOLDER, default="."),
    opt("--seed", "Seed of the simulated hole.", type=click.IntRange(0), default=0),
    QUIET,
)
def demo(output: Path, seed: int, quiet: bool) -> None:
    """Simulate a hole, rebuild its wall, write helibore-demo.glb and, with matplotlib, helibore-demo.png.

    \b
    helibore demo
    """
    import helibore.plot as plot
    from helibore.simulation.demonstration import drill, error, rebuild

    if not output.is_dir():
        raise InputError(str(output), "the folder must exist")
    terminal = Terminal(quiet, lines=True)
    with terminal.stage("simulate", "Drilling the simulated hole"):
        simulation = drill(seed)
    with terminal.stage("rebuild", f"Rebuilding the wall from {simulation.depth.size:,} samples"):
        demonstration = rebuild(simulation)
    wall, off = demonstration.wall, error(demonstration)
    with terminal.stage("mesh", "Writing helibore-demo.glb"):
        surface = wall.surface(demonstration.path)
        surface.save(output / "helibore-demo.glb")
    length, noise = simulation.hole.stop - simulation.hole.start, f"{simulation.tool.noise * 1e3:g} mm noise"
    title = f"{length:g} m of borehole wall from {simulation.depth.size:,} samples"
    about = f"Simulated drilling with stick-slip and {noise}; rms error of the wall {off.rms * 1e3:.2f} mm"
    picture = str(output / "helibore-demo.png")
    try:
        loading = "Loading matplotlib; the first time, it lists the fonts of the machine"
        with terminal.stage("picture", loading), needs("matplotlib", "plot"):
            import matplotlib.font_manager as _  # noqa: F401
        with terminal.stage("picture", "Drawing helibore-demo.png"):
            figure = plot.overview(wall, title=title, subtitle=about, scale=DEPTH_SCALE, dpi=DPI)
        with terminal.stage("picture", "Writing helibore-demo.png"):
            plot.save(figure, picture)
    except MissingExtraError as missing:
        picture = f"no picture: it {missing}"
    lines = summary_lines(wall.summary(), f", {len(surface.quads):,} quads")
    lines += [
        ("truth", f"rebuilt minus true radius: rms {off.rms * 1e3:.2f} mm, mean {off.mean * 1e3:+.2f} mm"),
        ("", f"half of the vertices within {off.median * 1e3:.2f} mm, 99 % within {off.most * 1e3:.2f} mm; "
             f"noise of one sample {simulation.tool.noise * 1e3:.2f} mm"),
        ("time", terminal.times()),
        ("wrote", f"{output / 'helibore-demo.glb'}, {picture}"),
    ]  # fmt: skip
    terminal.summary(lines)
