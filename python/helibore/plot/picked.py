"""Draw the picks of a wall on paper: curves and boxes on the images, tadpoles on a separate track.

A tadpole has the colour of its class. Its head stands at the true dip, 0 to 90 degrees across the track; its tail
points in the direction of dip, north up. Without a survey, dips are apparent (relative to the hole), and the tail
counts from toolface 0; the head of the track states which of the two is drawn.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from helibore.base.angles import azimuth_text
from helibore.base.arrays import Floats
from helibore.base.colors import DIP_LINES, DIP_TITLES, PICK_COLORS
from helibore.logs.picks import BREAKOUT, NOTE, PLANES, Pick
from helibore.plot.paper import FONT, INK, LEAST, SMALL, Sheet
from helibore.plot.tracks import HEAD, ON_PAPER, SIDES, Stretch, bare_axes, depth_lines

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from helibore.trajectory.survey import Path

MARKERS = {"bed": "o", "fracture": "s", "healed fracture": "s", "induced fracture": "D", "fault": "^"}
HOLLOW = ("fracture", "induced fracture")
DASHES: dict[str, tuple[float, ...]] = {
    "fracture": (4, 2),
    "healed fracture": (1.5, 2),
    "induced fracture": (7, 2, 1, 2),
}
NOTE_COLOR = "#8a3ffc"
"""Colour of notes, that of the page."""
TAIL = 3.0
"""Length of a tadpole's tail from the middle of its head, and distance of 0 and 90 degrees from the edges, mm."""


def tadpole(kind: str, size: float) -> dict[str, Any]:
    """Return matplotlib's options for the head of a tadpole of a class, ``size`` points wide."""
    color = PICK_COLORS[kind]
    face = "white" if kind in HOLLOW else color
    return {"marker": MARKERS[kind], "markerfacecolor": face, "markeredgecolor": color, "markersize": size}


class DipTrack:
    """The track with a tadpole for each plane that was picked."""

    width, least = 24.0, 20.0

    def __init__(self, picks: Sequence[Pick], path: Path | None, reference: str = "") -> None:
        self.planes = [(pick, *attitude(pick, path)) for pick in picks if pick.kind in PLANES]
        self.known = path is not None
        self.tail = "dip azimuth, N up" if self.known else f"toolface, {SIDES[reference][0]} up"

    def head(self, sheet: Sheet, x: float, y: float) -> None:
        """Write the title, the symbols of the classes, what tails mean, and the numbers of the degrees."""
        title = DIP_TITLES["true" if self.known else "apparent"]
        sheet.text(x + 0.5 * self.width, y + 2.5, title, ha="center", weight="bold", within=self.width - 1)
        for row, kind in enumerate(kind for kind in PLANES if any(pick.kind == kind for pick, *_ in self.planes)):
            at = y + 5.9 + 2.7 * row
            sheet.line((x + 2.0, x + 2.0), (at, at), markeredgewidth=0.7, **tadpole(kind, 3.2))
            sheet.text(x + 4.2, at, kind, 5.2, within=self.width - 4.6)
        sheet.text(x + 0.5 * self.width, y + 19.6, f"tail: {self.tail}", LEAST, within=self.width - 0.6, ha="center")
        for degrees in DIP_LINES:
            at = x + TAIL + degrees / DIP_LINES[-1] * (self.width - 2 * TAIL)
            sheet.text(at, y + HEAD - 2.0, f"{degrees}", SMALL, ha="center")

    def draw(self, sheet: Sheet, x: float, stretch: Stretch) -> Axes:
        """Draw one tadpole for each plane in a stretch."""
        axes = bare_axes(sheet, x, self.width, stretch)
        across = DIP_LINES[-1] / (self.width - 2 * TAIL)  # degrees a millimetre of paper
        axes.set_xlim(-TAIL * across, DIP_LINES[-1] + TAIL * across)
        for degrees in DIP_LINES:
            axes.axvline(degrees, color=INK, linewidth=0.2, alpha=0.22)
        depth_lines(axes, stretch)
        along = (stretch.bottom - stretch.top) / stretch.height
        for pick, angle, towards in self.planes:
            if not stretch.top <= pick.depth <= stretch.bottom:
                continue
            if math.isfinite(towards):
                turn = math.radians(towards)
                ends = (
                    (angle, angle + TAIL * across * math.sin(turn)),
                    (pick.depth, pick.depth - TAIL * along * math.cos(turn)),
                )
                axes.plot(*ends, color=PICK_COLORS[pick.kind], linewidth=0.8, zorder=6)
            look = tadpole(pick.kind, 3.4) | {"linestyle": "none", "markeredgewidth": 0.8, "zorder": 7}
            axes.plot([angle], [pick.depth], clip_on=False, **look)  # not cut at the ends of a page
        return axes


def attitude(pick: Pick, path: Path | None) -> tuple[float, float]:
    """Return true dip and its azimuth; without a path, apparent dip and the toolface at which the plane is deepest."""
    return (pick.apparent_dip, pick.toolface) if path is None else pick.dip(path)


def interval_marks(pick: Pick, path: Path | None) -> tuple[str, str]:
    """Return the intervals of both angles of `attitude` as text, "" where they are not known."""
    steep, aside = pick.dip_interval(path)
    if math.isnan(steep):
        return "", ""
    return f" ± {math.ceil(steep)}", " or any" if aside > 90 else f" ± {math.ceil(aside)}"


def angles_text(pick: Pick, path: Path | None) -> str:
    """Return both angles of `attitude` as text, as the viewer's page has them: 68 ± 1 / 035 ± 2."""
    dip, towards = attitude(pick, path)
    steep, aside = interval_marks(pick, path)
    return f"{dip:.0f}{steep} / {'–' if math.isnan(towards) else azimuth_text(towards)}{aside}"


def radius_of(pick: Pick, bit_diameter: float) -> float:
    """Return the radius of the hole where a pick was made; of the bit if it is not known."""
    return 0.5 * bit_diameter if pick.radius is None else pick.radius


def plane_depth(pick: Pick, radius: float, toolface: Floats) -> Floats:
    """Return the depths at which a plane cuts a round hole, at some toolfaces."""
    height = radius * math.tan(math.radians(pick.apparent_dip))
    depth: Floats = pick.depth + height * np.cos(np.radians(toolface - pick.toolface))
    return depth


def draw_picks(axes: Axes, picks: Sequence[Pick], left: float, bit_diameter: float) -> None:
    """Draw curves of planes, boxes of breakouts and notes on an image whose left edge is toolface ``left``."""
    toolface = np.linspace(0.0, 360.0, 181)
    look: dict[str, Any] = {"va": "bottom", "size": LEAST, "family": FONT, "color": NOTE_COLOR, "clip_on": True}
    for note in (pick for pick in picks if pick.kind == NOTE):
        axes.axhline(note.depth, color=NOTE_COLOR, linewidth=0.6, zorder=6)
        axes.text(4.0, note.depth, note.note, **look, zorder=7, bbox=ON_PAPER["bbox"])
    for pick in (pick for pick in picks if pick.kind != NOTE):
        radius = radius_of(pick, bit_diameter)
        color = PICK_COLORS[pick.kind]
        if pick.kind == BREAKOUT:
            side = 0.5 * pick.height * np.array([-1, -1, 1, 1, -1])
            lean = np.degrees(side * math.tan(math.radians(pick.tilt)) / radius)
            edge = 0.5 * pick.opening * np.array([-1, 1, 1, -1, -1]) + lean + (pick.toolface - left) % 360
            lines = [(edge + turn, pick.depth + side) for turn in (-360, -180, 0, 180, 360)]
        else:
            lines = [(toolface, plane_depth(pick, radius, toolface + left))]
        for across, depth in lines:
            axes.plot(across, depth, color="white", linewidth=1.8, zorder=5)
            axes.plot(across, depth, color=color, linewidth=0.9, dashes=DASHES.get(pick.kind, (None, None)), zorder=6)
