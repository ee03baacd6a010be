"""``helibore simulate FOLDER``: a known hole and what an imaging-while-drilling tool reports of it, as files.

caliper.csv   time_s, depth_m, toolface_deg, radius_m       (or .csv.gz, .npz)
survey.csv    depth_m, inclination_deg, azimuth_deg
gamma.csv     depth_m, GR1_gAPI .. GR16_gAPI                sector 1 begins at toolface 0
truth.csv     depth_m, toolface_deg, radius_m               the true wall on the helix of ``reconstruct``
hole.json     every parameter of the hole and the tool, and the seed
"""

from __future__ import annotations

import json
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click
import numpy as np
from click.core import ParameterSource

from helibore.cli.quantities import BIT, LENGTH, Parameter
from helibore.cli.terminal import Terminal

if TYPE_CHECKING:
    from helibore.base.arrays import Floats
    from helibore.simulation.hole import Hole
    from helibore.simulation.tool import Simulation


PLAYED = ("start", "stop", "lifts", "seed", "wits", "telemetry", "speed", "faults", "quiet")
"""The options that a played rig heeds."""


class LiftParameter(Parameter[tuple[float, float]]):
    """``DEPTH:LENGTH`` in metres."""

    name = "depth:length"

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> tuple[float, float]:
        """Read the text of an option."""
        try:
            depth, length = str(value).split(":")
            return float(depth), float(length)
        except ValueError:
            self.fail(f"'{value}': must be DEPTH:LENGTH in metres, such as 2030:5", param, ctx)


@click.command(short_help="A known hole and its samples, as files.")
@click.argument("folder", type=click.Path(path_type=Path, file_okay=False), required=False)
@click.option("--from", "start", type=LENGTH, default="2000m", show_default=True, help="Depth to start at.")
@click.option("--to", "stop", type=LENGTH, default="2050m", show_default=True, help="Depth to stop at.")
@click.option("--bit-diameter", type=BIT, default="0.216m", show_default=True)
@click.option("--plain", is_flag=True, help="A smooth round hole in one rock: no relief but noise.")
@click.option("--samples", type=int, help="How many.  [as many as --sample-rate gives]")
@click.option("--sample-rate", type=float, default=20.0, show_default=True, help="Samples a second.")
@click.option("--rotation", type=float, default=117.0, show_default=True, help="Turns a minute.")
@click.option("--stick-slip", type=float, default=0.7, show_default=True, help="Swing of the speed; 1: it stops.")
@click.option("--advance", type=float, default=20.0, show_default=True, help="Metres an hour.")
@click.option("--noise", type=LENGTH, default="0.5mm", show_default=True, help="Standard deviation of the radius.")
@click.option("--missing", type=float, default=0.0, show_default=True, help="Share of samples that never arrive.")
@click.option("--lift", "lifts", type=LiftParameter(), multiple=True, help="Lift and scan again; repeatable.")
@click.option("--seed", type=int, default=0, show_default=True)
@click.option("--wits", metavar="ADDRESS", help="Play a rig over WITS to tcp://HOST:PORT or listen://HOST:PORT.")
@click.option(
    "--telemetry",
    type=click.Choice(["mud-pulse", "em", "wired-pipe", "memory"]),
    default="wired-pipe",
    show_default=True,
    help="Rate and delay, with --wits.",
)
@click.option("--speed", type=float, default=1.0, show_default=True, help="Of playing, with --wits; 0: at once.")
@click.option(
    "--faults",
    nargs=3,
    type=float,
    default=(0.0, 0.0, 0.0),
    show_default=True,
    help="Shares of frames dropped, sent twice, sent late, with --wits.",
)
@click.option("--format", "ending", type=click.Choice(["csv", "csv.gz", "npz"]), default="csv", show_default=True)
@click.option("-q", "--quiet", is_flag=True, help="Print nothing but errors.")
def simulate(folder: Path | None, samples: int | None, seed: int, ending: str, quiet: bool, **options: Any) -> None:
    """Measure a known, seeded hole and write what the tool reports, and the truth, to FOLDER.

    \b
    helibore simulate hole
    helibore simulate hole --to 2400m --samples 2400000 --format npz --lift 2030:5
    helibore simulate --wits tcp://127.0.0.1:9872 --speed 60 --lift 2030:5      # beside: helibore live rig.toml
    helibore reconstruct hole/caliper.csv --survey hole/survey.csv -o wall.glb --bit-diameter 0.216m
    """
    if options["wits"]:
        _play(options, seed, quiet)
        return
    if folder is None:
        raise click.UsageError("no FOLDER to write to, and no --wits ADDRESS to play to")
    from helibore.simulation.tool import Lift, Tool
    from helibore.simulation.tool import simulate as run

    terminal = Terminal(quiet)
    hole = _hole(options["start"], options["stop"], options["bit_diameter"], options["plain"], seed)
    names = ("sample_rate", "rotation", "stick_slip", "advance", "noise", "missing")
    tool = Tool(**{name: options[name] for name in names}, lifts=tuple(Lift(*lift) for lift in options["lifts"]))
    with terminal.stage("simulate", "Drilling the simulated hole"):
        simulation = run(hole, tool, samples=samples, seed=seed)
    with terminal.stage("write", f"Writing {simulation.depth.size:,} samples"):
        folder.mkdir(parents=True, exist_ok=True)
        _write(folder, simulation, ending, seed)
    terminal.summary(
        [
            ("hole", f"{hole.start:g} to {hole.stop:g} m, bit {hole.bit_diameter * 1e3:g} mm, "
             f"{len(hole.washouts)} washouts, {len(hole.breakouts)} breakouts, {len(hole.beds)} beds"),
            ("tool", f"{simulation.depth.size:,} samples in {simulation.time[-1] / 3600:.1f} h"),
            ("time", terminal.times()),
            ("wrote", f"{folder}: caliper.{ending}, survey.csv, gamma.csv, truth.csv, hole.json"),
        ]
    )  # fmt: skip


def _play(options: dict[str, Any], seed: int, quiet: bool) -> None:
    """Play a rig; its configuration for the listening side goes to stdout first, before anything takes time."""
    from helibore.simulation.rig import Faults, Rig, configuration, connect, play, scheme_of
    from helibore.simulation.tool import Lift

    context = click.get_current_context()
    for parameter in context.command.params:
        name = str(parameter.name)
        if name not in PLAYED and context.get_parameter_source(name) is ParameterSource.COMMANDLINE:
            raise click.UsageError(f"{parameter.opts[0].replace('folder', 'FOLDER')}: has no say with --wits")
    address, start, stop = str(options["wits"]), options["start"], options["stop"]
    here = "listen" if scheme_of(address) == "tcp" else "tcp"
    faults, lifts = Faults(*options["faults"]), tuple(Lift(*lift) for lift in options["lifts"])
    if not quiet:
        click.echo(configuration(here + address[address.index(":") :], options["telemetry"], start))
        click.echo(f"# simulating {stop - start:g} m of drilling", err=True)
    rig = Rig(options["telemetry"], start, stop, lifts, faults, seed)
    with connect(address) as link:
        if not quiet:
            click.echo(f"# connected; {len(rig.triples):,} triples to send", err=True)
        sent = play(rig, link, options["speed"])
    if not quiet:
        click.echo(f"# {sent:,} bytes, {len(rig.triples):,} triples sent", err=True)


def _hole(start: float, stop: float, bit_diameter: float, plain: bool, seed: int) -> Hole:
    from helibore.simulation.tool import Hole

    if plain:
        return Hole(start=start, stop=stop, bit_diameter=bit_diameter, seed=seed)
    return Hole.example(start, stop, bit_diameter=bit_diameter, seed=seed)


def _write(folder: Path, simulation: Simulation, ending: str, seed: int) -> None:
    from helibore.base.atomic_file import write_whole
    from helibore.files.table_writing import write_table

    write_table(
        folder / f"caliper.{ending}",
        {
            "time_s": (simulation.time, 3),
            "depth_m": (simulation.depth, 5),
            "toolface_deg": (simulation.toolface, 4),
            "radius_m": (simulation.radius, 6),
        },
    )
    write_table(
        folder / "survey.csv",
        {
            "depth_m": (simulation.station_depth, 2),
            "inclination_deg": (simulation.inclination, 4),
            "azimuth_deg": (simulation.azimuth, 4),
        },
    )
    sectors = {f"GR{j + 1}_gAPI": (simulation.gamma[:, j], 2) for j in range(simulation.gamma.shape[1])}
    write_table(folder / "gamma.csv", {"depth_m": (simulation.gamma_depth, 3)} | sectors)

    hole, vertices_a_turn, pitch = simulation.hole, 64, 0.1
    k: Floats = np.arange(int(vertices_a_turn * (hole.stop - hole.start) / pitch) + 1, dtype=np.float64)
    depth, toolface = hole.start + k * (pitch / vertices_a_turn), k * (360.0 / vertices_a_turn) % 360.0
    truth = hole.radius(depth, toolface)
    write_table(folder / "truth.csv", {"depth_m": (depth, 6), "toolface_deg": (toolface, 4), "radius_m": (truth, 7)})
    shape = asdict(hole)
    del shape["_modes"]  # follow from the seed
    parameters = {"hole": shape, "tool": asdict(simulation.tool), "seed": seed}
    write_whole(folder / "hole.json", lambda file: file.write(json.dumps(parameters, indent=1).encode()))
