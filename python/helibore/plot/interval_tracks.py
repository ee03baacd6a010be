"""Draw the tracks of named intervals: formations, casings to scale with their shoes, the columns of a mud log as text.

    | Intervals |  Casing  |     Lithology      |
    |-----------|  |    |  |--------------------|
    | Draupne   |  |    |  | Claystone, dk gry, |
    |           |  |    |  | blky, sft          |
    |-----------| _|    |_ |--------------------|      the shoe
    | Hugin     |  9.625   | Sandstone          |

Every name stands under the top of its interval, that of a casing under its shoe.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from helibore.base.colors import TOP_COLOR
from helibore.base.rocks import PATTERN, Rock, rock_of
from helibore.logs.intervals import Interval, outside_text
from helibore.plot.depth_scales import length_text
from helibore.plot.paper import FAINT, INK, LEAST, LINE, SMALL, Sheet
from helibore.plot.tracks import HEAD, LENGTHS, Stretch, bare_axes, head_title

if TYPE_CHECKING:
    from matplotlib.axes import Axes

FILLS = ("#f3f6ef", "#ffffff")
"""Colours of every other interval."""
STEEL = "#5b6770"
"""Colour of a casing."""
FINE = 0.32
"""Millimetres of a unit of the patterns of rocks."""
ROOM = 1.15
"""Half a track of casings, in outer radii of the widest one."""


class IntervalTrack:
    """The intervals of one track, each with its name under its top.

    Parameters
    ----------
    name
        Of the track; "": formations, whose tops cross all tracks (`tops_across`).
    intervals
        All intervals of the track.
    top, bottom
        Depths of what is drawn, metres.
    unit
        Of the diameters of casings, ``"in"`` or ``"mm"``.
    """

    def __init__(self, name: str, intervals: Sequence[Interval], top: float, bottom: float, unit: str = "mm") -> None:
        self.name, self.unit = name, unit
        self.intervals = [one for one in intervals if one.start < bottom and one.stop > top and one.stop > one.start]
        self.note = outside_text(intervals, top, bottom)
        self.width, self.least = (26.0, 14.0) if name and not self.pipes else (18.0, 10.0)

    @property
    def pipes(self) -> list[tuple[Interval, float]]:
        """The intervals that are pipes, the widest first, with their outer diameters."""
        found = [(one, one.diameter) for one in self.intervals if one.diameter is not None]
        return sorted(found, key=lambda pipe: -pipe[1])

    def head(self, sheet: Sheet, x: float, y: float) -> None:
        """Write the title, and how many intervals lie outside."""
        unit = f" [{self.unit}]" if self.pipes else ""
        head_title(sheet, x, y + 5.0, self.width, f"{self.name or 'Intervals'}{unit}", 3)
        if self.note:
            middle, look = x + self.width / 2, {"ha": "center", "color": FAINT}
            sheet.lines_of_text(middle, y + 16.5, self.note, LEAST, self.width - 1, 5, **look)
        sheet.line((x, x + self.width), (y + HEAD - 0.2, y + HEAD - 0.2), color=INK)

    def draw(self, sheet: Sheet, x: float, stretch: Stretch) -> Axes:
        """Shade every second interval, and write the names; draw casings to scale, with a triangle at each shoe."""
        axes = bare_axes(sheet, x, self.width, stretch)
        pipes = self.pipes
        half = ROOM / 2 * max((diameter for _, diameter in pipes), default=1.0)
        axes.set_xlim(-half, half)
        along = (stretch.bottom - stretch.top) / stretch.height
        free = stretch.top
        for number, one in enumerate(self.intervals):
            top, bottom = max(one.start, stretch.top), min(one.stop, stretch.bottom)
            if top >= bottom or one.diameter is not None:
                continue
            rock = rock_of(self.name, one.name)
            if rock:
                self._draw_rock(axes, rock, top, bottom, one.start, stretch, half)
            elif not pipes:
                axes.axhspan(top, bottom, color=FILLS[number % 2], linewidth=0)
            if self.name and not pipes:
                axes.axhline(top, color=FAINT, linewidth=0.3)
            place = max(top, free) + 1.7 * along
            if place + 1.3 * along > stretch.bottom:
                continue
            down = stretch.y + (place - stretch.top) / along
            room = max(int(((bottom - place) / along + 0.5) // LINE), 1) if self.name else 1
            free = self._write(sheet, x, down, one.name, room, rock) * along + place
        for one, diameter in pipes:
            self._draw_pipe(axes, one, diameter, stretch, half)
        self._write_pipes(sheet, x, stretch, along)
        return axes

    def _draw_rock(
        self, axes: Axes, rock: Rock, top: float, bottom: float, start: float, stretch: Stretch, half: float
    ) -> None:
        """Fill with the colour and the pattern of a rock; the pattern begins at the rock's top."""
        axes.axhspan(top, bottom, color=rock.color, linewidth=0)
        across, along = FINE * 2 * half / self.width, FINE * (stretch.bottom - stretch.top) / stretch.height
        wide, tall = PATTERN
        rows = range(int((top - start) / (tall * along)), int((bottom - start) / (tall * along)) + 1)
        columns = range(int(2 * half / (wide * across)) + 1)
        strokes = [
            [(-half + (wide * i + x0) * across, start + (tall * j + y0) * along),
             (-half + (wide * i + x1) * across, start + (tall * j + y1) * along)]
            for j in rows for i in columns for x0, y0, x1, y1 in rock.marks
        ]  # fmt: skip
        lines = axes.vlines([], top, bottom, color=FAINT, linewidth=0.3)
        lines.set_segments(strokes)
        lines.set_clip_path(axes.axhspan(top, bottom, facecolor="none", edgecolor="none"))

    def _write(self, sheet: Sheet, x: float, y: float, text: str, most: int, rock: Rock | None) -> float:
        """Write a name in at most ``most`` lines from ``y`` millimetres down, on a ground of the colour of its rock;
        return the millimetres it takes.
        """
        look: dict[str, Any] = {"color": INK if self.name else TOP_COLOR}
        if rock:
            look["bbox"] = {"facecolor": rock.color, "edgecolor": "none", "pad": 0.9}
        if most == 1:
            sheet.text(x + 0.8, y, text, SMALL, within=self.width - 1.6, **look)
            return 1.0
        lines = sheet.wrapped(text, LEAST, self.width - 1.6)
        lines = lines if len(lines) <= most else [*lines[: most - 1], " ".join(lines[most - 1 :])]
        for row, line in enumerate(lines):
            sheet.text(x + 0.8, y + row * LINE, line, LEAST, within=self.width - 1.6, **look)
        return len(lines) * LINE - 1.0

    def _draw_pipe(self, axes: Axes, one: Interval, diameter: float, stretch: Stretch, half: float) -> None:
        """Draw both walls of a pipe, and its shoe if that is in view."""
        top, bottom = max(one.start, stretch.top), min(one.stop, stretch.bottom)
        if top >= bottom:
            return
        for side in (-0.5, 0.5):
            axes.vlines(side * diameter, top, bottom, color=STEEL, linewidth=1.6)
        if one.stop <= stretch.bottom:
            wide, tall = 0.12 * half, 2.4 * (stretch.bottom - stretch.top) / stretch.height
            for side in (-1, 1):
                at = side * diameter / 2
                axes.fill((at, at, at + side * wide), (one.stop - tall, one.stop, one.stop), color=INK, linewidth=0)

    def _write_pipes(self, sheet: Sheet, x: float, stretch: Stretch, along: float) -> None:
        """Write name and size of each pipe below its shoe or, if that is not in view, in the middle of what is."""
        taken: list[float] = []
        for one, diameter in self.pipes:
            top, bottom = max(one.start, stretch.top), min(one.stop, stretch.bottom)
            if top >= bottom:
                continue
            shoe = one.stop <= stretch.bottom - 8.0 * along
            y = stretch.y + ((one.stop if shoe else (top + bottom) / 2) - stretch.top) / along + 1.8
            while any(abs(y - other) < 5.0 for other in taken):
                y += 1.0
            if y + 3.0 > stretch.y + stretch.height:
                continue
            taken.append(y)
            size = length_text(diameter / LENGTHS[self.unit], self.unit)
            for row, text in enumerate((one.name, size if size not in one.name else "")):
                look = {"ha": "center", "color": INK if row == 0 else FAINT}
                sheet.text(x + self.width / 2, y + row * LINE, text, LEAST, self.width - 1.0, **look)


def tops_across(axes: Axes, intervals: Sequence[Interval], stretch: Stretch) -> None:
    """Draw a line at each end of a formation across a track."""
    for depth in {end for one in intervals if not one.track for end in (one.start, one.stop)}:
        if stretch.top < depth < stretch.bottom:
            axes.axhline(depth, color=TOP_COLOR, linewidth=0.9, zorder=6)
