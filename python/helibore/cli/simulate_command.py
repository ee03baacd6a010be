"""``helibore simulate FOLDER``: simulate a hole and a tool that images it while drilling; write files.

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
from click.core import ParameterSource

from helibore.cli.outputs import QUIET
from helibore.cli.quantities import BIT, FOLDER, LENGTH, LIFT
from helibore.cli.sections import Sectioned, opt, opts, section
from helibore.cli.terminal import Terminal, echo

if TYPE_CHECKING:
    from helibore.base.arrays import Floats
    from helibore.simulation.tool import Simulation


PLAYED = ("start", "stop", "lifts", "seed", "wits", "telemetry", "speed", "faults", "quiet")
"""Names of the options that may be given together with --wits."""


@click.command(cls=Sectioned)
@click.argument("folder", type=FOLDER, required=False)
@section(
    "Options",
    opt("--from start", "Depth to start at.", type=LENGTH, default="2000m"),
    opt("--to stop", "Depth to stop at.", type=LENGTH, default="2050m"),
    opt("--bit-diameter", "Bit size.", type=BIT, default="0.216m"),
    opt("--plain", "Simulate a smooth round hole in one rock; only noise changes the samples.", is_flag=True),
    opt("--samples", "Number of samples.  [as many as --sample-rate gives]", type=int),
    opt("--sample-rate", "Samples a second.", type=float, default=20.0),
    opt("--rotation", "Turns a minute.", type=float, default=117.0),
    opt(
        "--stick-slip",
        "Amplitude of the swings in rotation speed, as a share of --rotation; at 1 the tool stops once in each swing.",
        type=float,
        default=0.7,
    ),
    opt("--advance", "Rate of penetration, metres an hour.", type=float, default=20.0),
    opt("--noise", "Standard deviation of the radius.", type=LENGTH, default="0.5mm"),
    opt("--missing", "Share of samples that never arrive.", type=float, default=0.0),
    opts("--lift lifts", "At DEPTH, lift the tool by LENGTH and scan again.", type=LIFT),
    opt("--seed", "Seed of the hole; another seed makes another hole.", type=click.IntRange(0), default=0),
    opt("--format ending", "Format of the samples.", type=click.Choice(["csv", "csv.gz", "npz"]), default="csv"),
    QUIET,
)
@section(
    "A rig over WITS",
    opt("--wits", "Send the data of a simulated rig over WITS, to tcp://HOST:PORT or as listen://HOST:PORT.",
        metavar="ADDRESS"),
    opt("--telemetry", "Telemetry of the rig; it decides the rate and the delay of the data.",
        type=click.Choice(["mud-pulse", "em", "wired-pipe", "memory"]), default="wired-pipe"),
    opt("--speed", "Speed of the rig; 1: real time; 0: everything at once.", type=click.FloatRange(0), default=1.0),
    opt("--faults", "Shares of the frames that are dropped, sent twice, and sent late.", nargs=3, type=float,
        default=(0.0, 0.0, 0.0)),
)  # fmt: skip
def simulate(folder: Path | None, samples: int | None, seed: int, ending: str, quiet: bool, **options: Any) -> None:
    """Simulate a hole, measure it with a simulated tool, and write the samples and the true wall to FOLDER.

    \b
    helibore simulate hole
    helibore simulate hole --to 2400m --samples 2400000 --format npz --lift 2030:5
    helibore simulate --wits tcp://127.0.0.1:9872 --speed 60 --lift 2030:5      # other terminal: helibore live rig.toml
    helibore reconstruct hole/caliper.csv --survey hole/survey.csv -o wall.glb --bit-diameter 0.216m
    """
    if options["wits"]:
        _play(options, seed, quiet)
        return
    if folder is None:
        raise click.UsageError("no FOLDER to write to, and no --wits ADDRESS to send to")
    from helibore.simulation.tool import Hole, Lift, Tool
    from helibore.simulation.tool import simulate as run

    terminal = Terminal(quiet)
    ends, shape = (options["start"], options["stop"]), {"bit_diameter": options["bit_diameter"], "seed": seed}
    hole = Hole(*ends, **shape) if options["plain"] else Hole.example(*ends, **shape)
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
    """Send the WITS frames of a rig to an address; first print a configuration that reads them."""
    from helibore.simulation.rig import Faults, Rig, configuration, connect, play, socket_address
    from helibore.simulation.tool import Lift

    context = click.get_current_context()
    for parameter in context.command.params:
        name = str(parameter.name)
        if name not in PLAYED and context.get_parameter_source(name) is ParameterSource.COMMANDLINE:
            raise click.UsageError(f"{parameter.opts[0].replace('folder', 'FOLDER')}: does not go with --wits")
    address, start, stop = str(options["wits"]), options["start"], options["stop"]
    here = "listen" if socket_address(address).kind == "tcp" else "tcp"
    faults, lifts = Faults(*options["faults"]), tuple(Lift(*lift) for lift in options["lifts"])
    if not quiet:
        echo(configuration(here + address[address.index(":") :], options["telemetry"], start))
        echo(f"# simulating {stop - start:g} m of drilling", err=True)
    rig = Rig(options["telemetry"], start, stop, lifts, faults, seed)
    with connect(address) as link:
        if not quiet:
            echo(f"# connected; {len(rig.triples):,} triples to send", err=True)
        sent = play(rig, link, options["speed"])
    if not quiet:
        echo(f"# {sent:,} bytes, {len(rig.triples):,} triples sent", err=True)


def _write(folder: Path, simulation: Simulation, ending: str, seed: int) -> None:
    import numpy as np

    from helibore.base.atomic_file import write_whole
    from helibore.files.table_writing import write_table

    time, depth, toolface, radius = simulation.time, simulation.depth, simulation.toolface, simulation.radius
    samples = {"time_s": (time, 3), "depth_m": (depth, 5), "toolface_deg": (toolface, 4), "radius_m": (radius, 6)}
    angles = {"inclination_deg": (simulation.inclination, 4), "azimuth_deg": (simulation.azimuth, 4)}
    sectors = {f"GR{j + 1}_gAPI": (simulation.gamma[:, j], 2) for j in range(simulation.gamma.shape[1])}
    write_table(folder / f"caliper.{ending}", samples)
    write_table(folder / "survey.csv", {"depth_m": (simulation.station_depth, 2)} | angles)
    write_table(folder / "gamma.csv", {"depth_m": (simulation.gamma_depth, 3)} | sectors)

    hole, vertices_a_turn, pitch = simulation.hole, 64, 0.1
    k: Floats = np.arange(int(vertices_a_turn * (hole.stop - hole.start) / pitch) + 1, dtype=np.float64)
    depth, toolface = hole.start + k * (pitch / vertices_a_turn), k * (360.0 / vertices_a_turn) % 360.0
    truth = hole.radius(depth, toolface)
    write_table(folder / "truth.csv", {"depth_m": (depth, 6), "toolface_deg": (toolface, 4), "radius_m": (truth, 7)})
    shape = asdict(hole)
    del shape["_modes"]  # the seed decides the modes
    parameters = {"hole": shape, "tool": asdict(simulation.tool), "seed": seed}
    write_whole(folder / "hole.json", lambda file: file.write(json.dumps(parameters, indent=1).encode()))
