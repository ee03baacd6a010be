"""Paper measured in millimetres from its upper left corner, and figures on it.

    +-- 0 ----- x ->                    sheet.axes(x, y, width, height)      a track at its true size
    |   +--------+                      sheet.text(x, y, "...")              as wide as it may be, never wider
    y   | track  |
    v   +--------+

Printed at 100 % a sheet is as large as it says, so a depth scale of 1:200 is one. Not here: what is drawn.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from helibore.base.units import INCH, MILLIMETRE

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from matplotlib.text import Text

INK, FAINT, RULE = "#22303c", "#5d6b77", "#8a97a3"
MM = INCH / MILLIMETRE
"""Millimetres an inch."""
LEAST, SMALL, USUAL, LARGE = 5.0, 6.0, 7.0, 14.0
"""Points."""
FONT = "DejaVu Sans"
"""Comes with matplotlib: the same picture everywhere."""


def require_matplotlib() -> None:
    """Raise an ImportError that names the extra, where matplotlib is not installed."""
    try:
        import matplotlib as _  # noqa: F401
    except ImportError as error:
        raise ImportError('a picture needs matplotlib: pip install "helibore[plot]"') from error


class Sheet:
    """A figure of a size in millimetres.

    Parameters
    ----------
    width, height
        Millimetres.
    dpi
        Pixels an inch of everything that is pixels: images, and the whole figure as PNG.
    """

    def __init__(self, width: float, height: float, dpi: int) -> None:
        require_matplotlib()
        from matplotlib.figure import Figure

        self.width, self.height, self.dpi = width, height, dpi
        self.figure: Figure = Figure(figsize=(width / MM, height / MM), dpi=dpi, facecolor="white")

    def axes(self, x: float, y: float, width: float, height: float, **extra: Any) -> Axes:
        """Return axes whose upper left corner is at (x, y)."""
        box = (x / self.width, 1.0 - (y + height) / self.height, width / self.width, height / self.height)
        return self.figure.add_axes(box, **extra)

    def pixels(self, millimetres: float) -> int:
        """Pixels of a length, at least 1."""
        return max(round(millimetres / MM * self.dpi), 1)

    def text(
        self, x: float, y: float, text: str, size: float = USUAL, within: float | None = None, **extra: Any
    ) -> Text:
        """Write text whose middle line is at y; ``within`` millimetres: smaller, then shortened, until it fits."""
        look: dict[str, Any] = {"color": INK, "va": "center", "ha": "left", "fontsize": size, "family": FONT} | extra
        shown = self.figure.text(x / self.width, 1.0 - y / self.height, text, parse_math=False, **look)
        if within is not None:
            self._fit(shown, within)
        return shown

    def _fit(self, shown: Text, within: float) -> None:
        room = within / MM * self.dpi
        words, size = shown.get_text(), float(shown.get_fontsize())
        while shown.get_window_extent().width > room and size > LEAST:
            size = max(size - 0.5, LEAST)
            shown.set_fontsize(size)
        while shown.get_window_extent().width > room and len(words) > 1:
            words = words[:-1]
            shown.set_text(words.rstrip() + "…")

    def line(self, x: tuple[float, float], y: tuple[float, float], **extra: Any) -> None:
        """Draw a line from (x0, y0) to (x1, y1)."""
        from matplotlib.lines import Line2D

        ends = ([at / self.width for at in x], [1.0 - at / self.height for at in y])
        look: dict[str, Any] = {"color": RULE, "linewidth": 0.6} | extra
        self.figure.add_artist(Line2D(*ends, **look))

    def box(self, x: float, y: float, width: float, height: float, **extra: Any) -> None:
        """Draw a rectangle whose upper left corner is at (x, y)."""
        from matplotlib.patches import Rectangle

        corner = (x / self.width, 1.0 - (y + height) / self.height)
        size = (width / self.width, height / self.height)
        look: dict[str, Any] = {"facecolor": "none", "edgecolor": RULE, "linewidth": 0.6} | extra
        self.figure.add_artist(Rectangle(corner, *size, transform=self.figure.transFigure, **look))
