"""Paper measured in millimetres from its upper left corner, and figures on it.

    +-- 0 ----- x ->                    sheet.axes(x, y, width, height)      a track at its true size
    |   +--------+                      sheet.text(x, y, "...", within=30)   smaller or shorter where too wide
    y   | track  |
    v   +--------+

Printed at 100 % a sheet has the size that it says, so a depth scale of 1:200 is true. Files are written whole or not at
all; PDF holds all pages, PNG and SVG one. The same figure gives the same bytes: files hold no date, and SVG names are
seeded.
"""

from __future__ import annotations

import io
import os
from bisect import bisect_left
from collections.abc import Sequence
from functools import partial
from textwrap import wrap
from typing import TYPE_CHECKING, Any

from helibore.base.atomic_file import write_whole
from helibore.base.errors import InputError, check_ending, needs
from helibore.base.harmless import printable
from helibore.base.units import INCH, MILLIMETRE

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from matplotlib.text import Text

INK, FAINT, RULE = "#22303c", "#5d6b77", "#8a97a3"
MM = INCH / MILLIMETRE
"""Number of millimetres in an inch."""
LEAST, SMALL, USUAL, LARGE = 5.0, 6.0, 7.0, 14.0
"""Sizes of letters, points."""
LINE = 2.1
"""Millimetres between lines of the least size."""
FONT = "DejaVu Sans"
"""matplotlib brings this font, so that pictures are the same everywhere."""


def require_matplotlib() -> None:
    """Raise `MissingExtraError` if matplotlib is not installed."""
    with needs("matplotlib", "plot"):
        import matplotlib as _  # noqa: F401


def screen_picture(figure: Figure) -> bytes:
    """Return a figure as a small PNG for notebooks: 72 dots an inch, 64 colours."""
    from PIL import Image

    drawn, file = io.BytesIO(), io.BytesIO()
    figure.savefig(drawn, format="png", dpi=72)
    Image.open(drawn).convert("RGB").quantize(64).save(file, "png", optimize=True)
    return file.getvalue()


class Sheet:
    """A figure of a size in millimetres; ``dpi`` is the resolution of images, and of the whole figure as PNG."""

    def __init__(self, width: float, height: float, dpi: int) -> None:
        require_matplotlib()
        from matplotlib.backends.backend_agg import RendererAgg
        from matplotlib.figure import Figure

        self.width, self.height, self.dpi = width, height, dpi
        self.figure: Figure = Figure(figsize=(width / MM, height / MM), dpi=dpi, facecolor="white")
        vars(self.figure)["_repr_png_"] = partial(screen_picture, self.figure)  # notebooks show it without pyplot
        # This small renderer measures texts. matplotlib would make one as large as the page for every text.
        self._measure = RendererAgg(1, 1, self.figure.dpi)  # type: ignore[no-untyped-call]

    def axes(self, x: float, y: float, width: float, height: float, **extra: Any) -> Axes:
        """Return axes whose upper left corner is at (x, y)."""
        box = (x / self.width, 1.0 - (y + height) / self.height, width / self.width, height / self.height)
        return self.figure.add_axes(box, **extra)

    def pixels(self, millimetres: float) -> int:
        """Return the number of pixels in a length on paper, given in millimetres; at least 1."""
        return max(round(millimetres / MM * self.dpi), 1)

    def text(
        self, x: float, y: float, text: str, size: float = USUAL, within: float | None = None, **extra: Any
    ) -> Text:
        """Write text centred on y, and return it; if it is wider than ``within`` millimetres, make it smaller, then
        shorten it.
        """
        text = printable(text)
        look: dict[str, Any] = {"color": INK, "va": "center", "ha": "left", "fontsize": size, "family": FONT} | extra
        shown = self.figure.text(x / self.width, 1.0 - y / self.height, text, parse_math=False, **look)
        if within is None:
            return shown
        while self.text_width(shown) > within and size > LEAST:
            size = max(size - 0.5, LEAST)
            shown.set_fontsize(size)
        if self.text_width(shown) > within and len(text) > 1:

            def too_wide(letters: int) -> bool:
                shown.set_text(text[:letters].rstrip() + "…")
                return self.text_width(shown) > within

            letters = bisect_left(range(1, len(text)), True, key=too_wide)  # as many letters as fit
            shown.set_text(text[: max(letters, 1)].rstrip() + "…")
        return shown

    def lines_of_text(self, x: float, y: float, text: str, size: float, within: float, most: int, **extra: Any) -> None:
        """Write text in as few lines as are at most ``within`` millimetres wide, centred on y.

        If these are more than ``most`` lines, the last of the ``most`` lines holds the rest, shortened.
        """
        lines = self.wrapped(text, LEAST, within, **extra)
        if len(lines) > most:
            lines = [*lines[: most - 1], " ".join(lines[most - 1 :])]
        for row, line in enumerate(lines):
            at = y + (row - 0.5 * (len(lines) - 1)) * LINE
            self.text(x, at, line, size if len(lines) == 1 else LEAST, within, **extra)

    def wrapped(self, text: str, size: float, within: float, **extra: Any) -> list[str]:
        """Return text in as few lines as are at most ``within`` millimetres wide."""
        text = printable(text)
        trial = self.text(0.0, 0.0, text, size, **extra)
        room, lines = len(text), [text]
        while self._too_wide(trial, lines, within) and room > 1:
            room -= 1
            lines = wrap(text, room)
        trial.remove()
        return lines

    def _too_wide(self, trial: Text, lines: Sequence[str], within: float) -> bool:
        for line in lines:
            trial.set_text(line)
            if self.text_width(trial) > within:
                return True
        return False

    def text_width(self, shown: Text) -> float:
        """Return the width of a text, millimetres, at this figure's dpi, as letters are wider at a low dpi."""
        return float(shown.get_window_extent(self._measure).width) / self.dpi * MM

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


ENDINGS = (".png", ".svg", ".pdf")
MOST_PIXELS = 65_000
"""The most pixels along a side of a PNG that matplotlib draws."""
LONGEST_PDF = 5_080.0
"""Longest side of a PDF page, millimetres (200 inches)."""


def save(figures: Figure | Sequence[Figure], path: str | os.PathLike[str]) -> None:
    """Write figures to a file; the ending of its name gives the format: .png, .svg or .pdf.

    Parameters
    ----------
    figures
        One figure, or for .pdf any number: one per page.
    path
        An existing file is replaced.

    Raises
    ------
    InputError
        If the ending is not known, there is no figure, a picture has several, or the paper is too long for the format.
    OSError
        If the file cannot be written; an existing file then does not change.
    """
    ending = check_ending(path, ENDINGS)
    each = list(figures) if isinstance(figures, Sequence) else [figures]
    if not each:
        raise InputError(f"{path}: no figure", "a file needs at least one figure")
    if len(each) != 1 and ending != ".pdf":
        raise InputError(f"{path}: {len(each)} pages", "only a .pdf file holds more than one page")
    for figure in each:
        _check_size(figure, path, ending)
    content = rendered(each, ending)
    write_whole(path, lambda file: file.write(content))


def rendered(figures: Sequence[Figure], ending: str) -> bytes:
    """Return the bytes of ``figures``: a picture, or the pages of a PDF; ``ending`` is .png, .svg or .pdf."""
    from matplotlib import rc_context
    from matplotlib.backends.backend_pdf import PdfPages

    content = io.BytesIO()
    with rc_context({"svg.hashsalt": "helibore", "pdf.fonttype": 42, "svg.fonttype": "path"}):
        if ending == ".pdf":
            with PdfPages(content, metadata={"CreationDate": None, "Creator": "helibore"}) as pdf:
                for figure in figures:
                    pdf.savefig(figure, dpi=figure.dpi)
        elif ending == ".svg":
            figures[0].savefig(content, format="svg", dpi=figures[0].dpi, metadata={"Date": None})
        else:
            figures[0].savefig(content, format="png", dpi=figures[0].dpi)
    return content.getvalue()


def _check_size(figure: Figure, path: str | os.PathLike[str], ending: str) -> None:
    longest = max(figure.get_size_inches()) * MM
    pixels = round(longest / MM * figure.dpi)
    if ending == ".png" and pixels > MOST_PIXELS:
        place = f"{path}: {longest:,.0f} mm of paper at {figure.dpi:g} dpi are {pixels:,} pixels"
        raise InputError(place, f"must be at most {MOST_PIXELS:,}; take a coarser scale, fewer dpi, or .pdf")
    if ending == ".pdf" and longest > LONGEST_PDF:
        rule = f"PDF allows {LONGEST_PDF:,.0f}; take pages or a coarser scale"
        raise InputError(f"{path}: a page of {longest:,.0f} mm", rule)
