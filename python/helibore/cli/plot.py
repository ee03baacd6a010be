"""``helibore plot SOURCE -o log.pdf``: the log of a wall on paper, at a true scale.

Options become a `Drawing` here; what is drawn, and where, is ``helibore.plot``'s business.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from helibore.cli.quantities import LENGTH
from helibore.cli.reading import FILE
from helibore.cli.terminal import Terminal
from helibore.cli.wall_source import Sourced, takes_a_wall, wall_from

if TYPE_CHECKING:
    from helibore.plot import Look

DRAWING = (
    click.option("--well", help="Title.  [name of the file]"),
    click.option("--scale", metavar="N", help="Depth scale, 200 or 1:200.  [the finest usual one that fits]"),
    click.option("--unit", type=click.Choice(["in", "mm"]), default="in", show_default=True, help="Of diameters."),
    click.option(
        "--curve", "curves", type=click.Choice(["C1", "C2", "D0", "D90", "none"]), multiple=True,
        help="Of the caliper track: largest, across it, across 0 and 90; repeatable.  [C1, C2]",
    ),
    click.option(
        "--left", type=click.Choice(["0", "90", "180", "270"]), default="0", show_default=True,
        help="Toolface at the left edge of images; 180 puts up in the middle.",
    ),
    click.option(
        "--elevation", type=LENGTH, help="From sea level up to the zero of depths: true depths are TVDSS.  [TVD]"
    ),
    click.option("--limits", metavar="NAME=LOW,HIGH", multiple=True, help="Ends of an image's colours, in its unit."),
    click.option("--color-map", "color_maps", metavar="NAME=MAP", multiple=True, help="Colour map of an image."),
    click.option("--log", "logs", metavar="NAME", multiple=True, help="Colours of this image follow the logarithm."),
    click.option("--linear", metavar="NAME", multiple=True, help="They do not, though it is a resistivity."),
    click.option("--dynamic", metavar="NAME=LENGTH", multiple=True, help="Normalise an image in a sliding window."),
    click.option("--polar", type=LENGTH, multiple=True, help="Depth of a cross section; repeatable.  [up to four]"),
    click.option("--no-polar", is_flag=True, help="No cross sections."),
    click.option("--body", type=LENGTH, nargs=2, help="Stretch of the 3-D view.  [the 12 m with most relief]"),
    click.option("--no-body", is_flag=True, help="No 3-D view."),
    click.option("--dpi", type=click.IntRange(30, 1200), default=150, show_default=True, help="Pixels an inch."),
    click.option("-q", "--quiet", is_flag=True, help="Print nothing but errors."),
)  # fmt: skip


def takes_a_drawing(command: Callable[..., Any]) -> Callable[..., Any]:
    """Give a command the options that say how a wall is drawn."""
    for option in reversed(DRAWING):
        command = option(command)
    return command


@click.command(short_help="A log on paper: PNG, SVG or PDF at a true scale.")
@takes_a_wall
@click.option("-o", "--output", type=FILE, required=True, help="Picture to write: .png, .svg or .pdf.")
@click.option(
    "--paper", type=click.Choice(["a4", "a3", "roll"]), default="a4", show_default=True,
    help="Of a PDF: pages, or a roll as long as the interval. PNG and SVG are rolls.",
)  # fmt: skip
@takes_a_drawing
def plot(output: Path, paper: str, quiet: bool, **options: Any) -> None:
    """Draw the log of a wall: caliper, radius and images, cross sections, 3-D view.

    SOURCE is an archive of a wall (.wall), a caliper file with the columns that `reconstruct` takes, or the settings
    it wrote beside a mesh (wall.glb.toml), which repeat its conditioning, too.

    \b
    helibore plot well.wall -o well.pdf --scale 1:500
    helibore plot xy.csv.gz --diameter x_in@0 --diameter y_in@90 --bit-diameter 6.2in -o xy.png
    helibore plot --gauge --bit-diameter 8.5in --image mem.las:ABDC:centre -o images.pdf
    """
    check_output(output)
    terminal = Terminal(quiet)
    found = wall_from(options, terminal)
    from helibore import plot as drawn
    from helibore.plot.paper import MM

    settings = drawing_options(options, found)
    with terminal.stage("draw", "Drawing"):
        roll = paper == "roll" or output.suffix.lower() != ".pdf"
        figures = [drawn.log(found.wall, **settings)] if roll else drawn.pages(found.wall, paper, **settings)
    with terminal.stage("save", f"Writing {output.name}"):
        drawn.save(figures, output)
    width, height = figures[0].get_size_inches() * MM
    pages = f"{len(figures)} pages of " if len(figures) > 1 else ""
    terminal.summary([
        *found.told,
        ("paper", f"{pages}{width:,.0f} x {height:,.0f} mm"),
        ("time", terminal.times()),
        ("wrote", f"{output} ({output.stat().st_size / 1e6:,.1f} MB)"),
    ])  # fmt: skip


def check_output(output: Path) -> None:
    """Refuse before the work what would fail after it."""
    from helibore.plot.paper import require_matplotlib
    from helibore.plot.save import check_ending

    check_ending(output)
    check_folder(output)
    require_matplotlib()


def check_folder(output: Path) -> None:
    """Refuse a file in a folder that is not there, and a folder in a file's place."""
    if not output.parent.is_dir():
        raise ValueError(f"{output}: the folder {output.parent} must be there")
    if output.is_dir():
        raise ValueError(f"{output}: is a folder")


def drawing_options(options: dict[str, Any], found: Sourced) -> dict[str, Any]:
    """Return the options of a `Drawing`."""
    polar: tuple[float, ...] | None = options["polar"] or None
    body: tuple[float, ...] | None = options["body"]
    return {
        "title": options["well"] or found.name,
        "subtitle": found.told[0][1],
        "start": options["start_depth"],
        "stop": options["stop_depth"],
        "scale": _scale(options["scale"]),
        "looks": _looks(options),
        "reference": options["reference"],
        "left": float(options["left"]),
        "unit": options["unit"],
        "curves": tuple(name for name in options["curves"] or ("C1", "C2") if name != "none"),
        "polar": () if options["no_polar"] else polar,
        "body": () if options["no_body"] else body,
        "dpi": options["dpi"],
        "elevation": options["elevation"],
    }


def _scale(text: str | None) -> int | None:
    if text is None:
        return None
    number = text.removeprefix("1:")
    if not (number.isascii() and number.isdigit() and int(number)):
        raise click.UsageError(f"--scale {text}: must be a whole number, as 200 or 1:200")
    return int(number)


def _looks(options: dict[str, Any]) -> dict[str, Look]:
    """Colours by name of an image."""
    from helibore.base import units
    from helibore.plot import Look

    looks: dict[str, dict[str, Any]] = {}

    def split(option: str, text: str) -> tuple[dict[str, Any], str]:
        name, equals, value = text.rpartition("=")
        if not (name and equals):
            raise click.UsageError(f"--{option} {text}: must be NAME=...")
        return looks.setdefault(name, {}), value

    for text in options["limits"]:
        look, value = split("limits", text)
        try:
            low, high = (float(part) for part in value.split(","))
        except ValueError:
            raise click.UsageError(f"--limits {text}: must be NAME=LOW,HIGH") from None
        if not (math.isfinite(low) and math.isfinite(high) and low < high):
            raise click.UsageError(f"--limits {text}: LOW must be below HIGH")
        look["limits"] = (low, high)
    for text in options["color_maps"]:
        look, value = split("color-map", text)
        look["color_map"] = value
    for text in options["dynamic"]:
        look, value = split("dynamic", text)
        look["window"] = units.quantity(value, units.LENGTH)
    for name in options["logs"]:
        looks.setdefault(name, {})["log"] = True
    for name in options["linear"]:
        looks.setdefault(name, {})["log"] = False
    return {name: Look(**look) for name, look in looks.items()}
