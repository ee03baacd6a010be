"""Cards for notebooks: a small picture of an object beside its key numbers, as self-contained HTML.

All styles are inline, and text and lines have the colours of the page around them, so that a card can be read in a
light and in a dark notebook. A card has less than 30 kB.
"""

from __future__ import annotations

import base64
import contextlib
import struct
import zlib
from collections.abc import Mapping

import numpy as np

from helibore.base.arrays import Floats
from helibore.base.color_limits import usual_scale
from helibore.base.colors import ColorScale, colors_of
from helibore.base.errors import InputError
from helibore.base.harmless import in_html

_WIDTH, _HEIGHT = 72, 120
"""The most cells of a map, across and down. Every picture has two pixels for each cell: it is 144 wide, 240 high."""
_TABLE = "border-collapse:collapse;margin:.3em 0 0;background:none;color:inherit;font-size:inherit"


def card(title: str, numbers: Mapping[str, str], picture: str) -> str:
    """Return a card as HTML: a picture, and to its right the title above a table of the numbers by name."""
    cell = 'style="text-align:left;padding:0 .8em 0 0;border:0;background:none'
    rows = "".join(
        f'<tr style="background:none"><td {cell};opacity:.7">{in_html(name)}</td><td {cell}">{in_html(text)}</td></tr>'
        for name, text in numbers.items()
    )
    return (
        f'<div style="display:flex;gap:1em;align-items:flex-start;font-size:13px">{picture}'
        f'<div><b>{in_html(title)}</b><table style="{_TABLE}">{rows}</table></div></div>'
    )


def map_picture(values: Floats, scale: ColorScale | None, label: str) -> str:
    """Return a picture of values, (rows, columns), as HTML, with the first row on top; missing values are grey.

    Without a scale, colours run from the least value to the greatest.

    Every cell shows one of the values at its place, not a mean, so that missing values stay visible.
    """
    rows, columns = (np.linspace(0, size - 1, min(size, most)).astype(int) for size, most in
                     zip(values.shape, (_HEIGHT, _WIDTH), strict=True))  # fmt: skip
    cells = values[np.ix_(rows, columns)]
    pixels = (scale.colors(cells) if scale else colors_of(cells))[..., :3]
    height, width = pixels.shape[:2]
    lines = np.zeros((height, 1 + 3 * width), np.uint8)  # a line of a PNG begins with the number of its filter; 0: none
    lines[:, 1:] = pixels.reshape(height, -1)
    parts = (b"IHDR", struct.pack(">2I5B", width, height, 8, 2, 0, 0, 0)), (b"IDAT", zlib.compress(lines.tobytes()))
    png = b"\x89PNG\r\n\x1a\n" + b"".join(
        struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data))
        for name, data in (*parts, (b"IEND", b""))
    )
    source = base64.b64encode(png).decode()
    style = f"width:{2 * _WIDTH}px;height:{2 * _HEIGHT}px;image-rendering:pixelated"
    return f'<img alt="{in_html(label)}" title="{in_html(label)}" style="{style}" src="data:image/png;base64,{source}">'


def usual_picture(values: Floats, name: str, unit: str, label: str) -> str:
    """Return a picture of a quantity in its usual colours; a constant quantity has one colour."""
    scale = None
    with contextlib.suppress(InputError):
        scale = usual_scale(values, name, unit)
    return map_picture(values, scale, label)


def curve_picture(across: Floats, down: Floats, label: str, equal: bool = False) -> str:
    """Return a picture of a curve as HTML; ``across`` grows to the right and ``down`` grows downwards.

    The curve is interrupted where a value is missing; if all are missing, the picture is "". If ``equal``, both
    directions have the same scale, as the picture of a path needs.
    """
    rows = np.linspace(0, max(across.size - 1, 0), min(across.size, 4 * _HEIGHT)).astype(int)
    points = np.column_stack([across[rows], down[rows]])
    there = np.isfinite(points[:, 0]) & np.isfinite(points[:, 1])
    if not there.any():
        return ""
    least, span = points[there].min(axis=0), np.ptp(points[there], axis=0)
    span = np.maximum(np.full(2, span.max()) if equal else span, 1e-12)
    size = np.array([2 * _WIDTH, 2 * _HEIGHT]) - 8
    scaled = 4 + (points - least) / span * (size.min() if equal else size)
    moves = ["M" if not before else "L" for before in np.concatenate([[False], there[:-1]])]
    path = "".join(f"{move}{x:.1f} {y:.1f}" for move, (x, y), one in zip(moves, scaled, there, strict=True) if one)
    return (
        f'<svg width="{2 * _WIDTH}" height="{2 * _HEIGHT}" role="img" aria-label="{in_html(label)}">'
        f'<title>{in_html(label)}</title><rect width="100%" height="100%" fill="none" stroke="currentColor" '
        f'stroke-opacity=".3"/><path d="{path}" fill="none" stroke="currentColor"/></svg>'
    )
