"""Pictures as files: PNG, SVG and PDF, whole or not at all; PDF holds all pages, the others one.

The same figure gives the same bytes: no date is written, and SVG names are seeded.
"""

from __future__ import annotations

import io
import os
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from helibore.base.atomic_file import write_whole
from helibore.plot.paper import MM

if TYPE_CHECKING:
    from matplotlib.figure import Figure

ENDINGS = (".png", ".svg", ".pdf")
MOST_PIXELS = 65_000
"""Along one side of a PNG: matplotlib draws no more."""
LONGEST_PDF = 5_080.0
"""Millimetres a side of a PDF page may have (200 inches)."""


def check_ending(path: str | os.PathLike[str]) -> str:
    """Return the ending, in lower case; a ValueError lists those that are known."""
    ending = Path(path).suffix.lower()
    if ending not in ENDINGS:
        raise ValueError(f"{path}: the ending must be one of {', '.join(ENDINGS)}")
    return ending


def save(figures: Figure | Sequence[Figure], path: str | os.PathLike[str]) -> None:
    """Write figures to a file; its ending is the format.

    Parameters
    ----------
    figures
        One, or for .pdf any number: a page each.
    path
        Replaced if it is there.

    Raises
    ------
    ValueError
        On another ending, on several figures for one picture, and on paper too long for the format.
    OSError
        If the file cannot be written; the old one is then as it was.
    """
    ending = check_ending(path)
    each = list(figures) if isinstance(figures, Sequence) else [figures]
    if len(each) != 1 and ending != ".pdf":
        raise ValueError(f"{path}: {len(each)} pages: only .pdf holds more than one")
    for figure in each:
        _check_size(figure, path, ending)
    content = rendered(each, ending)
    write_whole(path, lambda file: file.write(content))


def rendered(figures: Sequence[Figure], ending: str) -> bytes:
    """Return the bytes of a picture, or of the pages of a PDF."""
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
    width, height = figure.get_size_inches() * MM
    pixels = round(max(width, height) / MM * figure.dpi)
    if ending == ".png" and pixels > MOST_PIXELS:
        raise ValueError(
            f"{path}: {height:,.0f} mm of paper at {figure.dpi:g} dpi are {pixels:,} pixels: must be at most "
            f"{MOST_PIXELS:,}; take a coarser scale, fewer dpi, or .pdf"
        )
    if ending == ".pdf" and max(width, height) > LONGEST_PDF:
        raise ValueError(
            f"{path}: a page of {height:,.0f} mm: PDF allows {LONGEST_PDF:,.0f}; take pages or a coarser scale"
        )
