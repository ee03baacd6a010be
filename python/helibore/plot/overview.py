"""An overview for a screen: the tracks of a log, and beside them the stretch with most relief as a shaded body.

    | Depth | Diameter | Radius | Gamma |   --- body
    |       |          |        |       |-/     of the stretch
    |       |          |        |       |-\\     that the bar marks
    |       |          |        |       |   ---

The same tracks, colours and body as in ``log``, at the same true scale; cross sections are not drawn here.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from helibore.plot.content import Drawing, content_of
from helibore.plot.header import HEADER, draw_footer, draw_header
from helibore.plot.log import FOOTER, MARGIN, draw_tracks, tracks_width
from helibore.plot.paper import FAINT, Sheet
from helibore.plot.solid import draw_solid
from helibore.plot.tracks import HEAD

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from helibore.wall.wall import Wall

BODY = 96.0
"""Millimetres of width of the shaded body."""
LEAST = 130.0
"""Millimetres of height that a body needs."""
TIES = 10.0
"""Millimetres between the tracks and the body, where lines tie its ends to their depths."""


def overview(wall: Wall, **options: Any) -> Figure:
    """Draw the tracks of a wall and, at their right, a shaded body coloured by the image that says most of it.

    Parameters
    ----------
    wall
        At least one full turn; its ``images`` are drawn.
    **options
        As in `Drawing`; ``polar`` is of no use.

    Returns
    -------
    matplotlib.figure.Figure
        As large as the paper; its resolution is ``dpi``.

    Raises
    ------
    ValueError, ImportError
        As `log`.
    """
    content = content_of(wall, Drawing(**{**options, "polar": ()}))
    length = content.paper_length()
    body = content.bodies[-1] if content.bodies else None
    right = MARGIN + tracks_width(content)
    width = right + (TIES + BODY if body else 0.0) + MARGIN
    height = MARGIN + HEADER + HEAD + (max(length, LEAST) if body else length) + FOOTER + MARGIN
    sheet = Sheet(width, height, content.drawing.dpi)
    draw_header(sheet, content, MARGIN, MARGIN, width - 2 * MARGIN)
    top = MARGIN + HEADER
    draw_tracks(sheet, content, content.top, content.bottom, top)
    if body is not None and content.stretched is not None:
        box = (right + TIES, top + HEAD - 10.0, BODY, max(length, LEAST) + 10.0)
        axes = draw_solid(sheet, box, wall, content.stretched, body.scale, body.values, body.name)
        for depth in content.stretched.depth:
            beside = top + HEAD + (depth - content.top) / (content.bottom - content.top) * length
            at = _down(sheet, axes, depth)
            sheet.line((right + 1.8, right + TIES + 1.0), (beside, at), color=FAINT, linewidth=0.5)
    draw_footer(sheet, content, MARGIN, height - MARGIN - 4.0)
    return sheet.figure


def _down(sheet: Sheet, axes: Axes, depth: float) -> float:
    """Millimetres from the top of the sheet to a depth on the body's axis."""
    box, (low, high) = axes.get_position(), axes.get_ylim()
    return float(sheet.height * (1.0 - (box.y0 + (depth - low) / (high - low) * box.height)))
