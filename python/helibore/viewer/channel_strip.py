"""The channels of the rig in rig mode as one picture (SVG): latest value, and the line of the last two hours, of each.

+------------------+------------------+
| WOB              | SPP, high        |     the page shows it as an image, so that it stays small
| 102.4 kN ~~--/\\~ | 231 bar  --__/~~ |
+------------------+------------------+
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass
from xml.sax.saxutils import escape

from helibore.base.harmless import printable

WIDTH, HEIGHT, GAP = 300, 64, 6
"""Size of a cell and the space between two, in units of the picture."""
LINE = 190, 290, 6, 46
"""Left, right, top and bottom of the line in a cell."""
LONGEST = 60.0
"""Seconds between two values of a line from which on it has a gap."""
OLD, LATE = 15.0, 1.5
"""Seconds from which on a value is old, and its usual distance in time times so much; it is pale, and has its age."""
COLOURS = {
    "dark": {"panel": "#1d2328", "line": "#36404a", "ink": "#e6eaed", "soft": "#98a4ad"},
    "light": {"panel": "#ffffff", "line": "#cfd5da", "ink": "#1b2126", "soft": "#5c6770"},
}
ALARM = {"panel": "#ff8a3c", "line": "#ff8a3c", "ink": "#16202a", "soft": "#16202a"}


@dataclass(frozen=True)
class ShownChannel:
    """A channel: name, unit, latest value (NaN: none) and its age in seconds, alarm ("low", "high" or ""), line.

    ``times`` are seconds, ``values`` the values at these times.
    """

    name: str
    unit: str
    value: float
    age: float
    beyond: str
    times: Sequence[float]
    values: Sequence[float]


def channel_strip(channels: Sequence[ShownChannel], theme: str) -> str:
    """Return the picture of the channels; ``theme`` is "dark" or "light"."""
    ends = [time for one in channels if len(one.times) for time in (one.times[0], one.times[-1] + _silence(one))]
    span = (min(ends), max(ends)) if ends else (0.0, 1.0)
    width = len(channels) * (WIDTH + GAP) - GAP
    cells = "".join(
        f'<g transform="translate({place * (WIDTH + GAP)})">{_cell(one, span, COLOURS.get(theme, COLOURS["dark"]))}</g>'
        for place, one in enumerate(channels)
    )
    font = 'font-family="DejaVu Sans, Segoe UI, sans-serif"'
    return f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {HEIGHT}" {font}>{cells}</svg>'


def _cell(one: ShownChannel, span: tuple[float, float], colours: dict[str, str]) -> str:
    colours = ALARM if one.beyond else colours
    ink, weight = (colours["soft"], 400) if _is_old(one) else (colours["ink"], 700)
    head = ", ".join(part for part in (one.name, one.beyond, _age(one)) if part)
    number = f"{one.value:.{4 if abs(one.value) < 1e3 else 5}g}".replace("-", "−") if math.isfinite(one.value) else "–"
    small = f'<tspan font-size="18" font-weight="400"> {_text(one.unit)}</tspan>'
    return (
        f'<rect width="{WIDTH}" height="{HEIGHT}" fill="{colours["panel"]}" stroke="{colours["line"]}"/>'
        f'<text x="8" y="19" font-size="17" fill="{colours["soft"]}">{_text(head)}</text>'
        f'<text x="8" y="54" font-size="36" font-weight="{weight}" fill="{ink}">{number}{small}</text>'
        f'<path d="{_line(one, span)}" fill="none" stroke="{ink}" stroke-width="1.5"/>'
        f'<path d="{_gaps(one, span)}" fill="none" stroke="{colours["soft"]}" stroke-width="5" stroke-dasharray="2 2"/>'
        f'<text x="{LINE[1]}" y="63" font-size="13" text-anchor="end" fill="{colours["soft"]}">{_length(span)}</text>'
    )


def _line(one: ShownChannel, span: tuple[float, float]) -> str:
    """Return the path of a line, which fills its part of the cell from its least to its greatest value."""
    if not len(one.values):
        return ""
    low, high, (left, right, top, bottom) = min(one.values), max(one.values), LINE
    scale = (bottom - top) / (high - low) if high > low else 0.0
    wide = (right - left) / max(span[1] - span[0], 1.0)
    path, before = [], -math.inf
    for time, value in zip(one.times, one.values, strict=True):
        y = bottom - (value - low) * scale if scale else (top + bottom) / 2
        path.append(f"{'M' if time - before > LONGEST else 'L'}{left + (time - span[0]) * wide:.1f} {y:.1f}")
        before = time
    return "".join(path)


def _gaps(one: ShownChannel, span: tuple[float, float]) -> str:
    """Return the path that marks where a line has no value for longer than `LONGEST`, up to now."""
    if not len(one.times):
        return ""
    left, right, _, bottom = LINE
    wide = (right - left) / max(span[1] - span[0], 1.0)
    times = [*one.times, one.times[-1] + _silence(one)]
    gaps = ((a, b) for a, b in itertools.pairwise(times) if b - a > LONGEST)
    return "".join(f"M{left + (a - span[0]) * wide:.1f} {bottom}H{left + (b - span[0]) * wide:.1f}" for a, b in gaps)


def _silence(one: ShownChannel) -> float:
    return one.age if math.isfinite(one.age) else 0.0


def _length(span: tuple[float, float]) -> str:
    """Return how long a line is in words."""
    seconds = span[1] - span[0]
    if seconds < 90:
        return f"last {seconds:.0f} s"
    return f"last {seconds / 60:.0f} min" if seconds < 5400 else f"last {seconds / 3600:.1f} h"


def _is_old(one: ShownChannel) -> bool:
    """Return whether a value may not be that of now: another was to come since."""
    steps = sorted(after - before for before, after in itertools.pairwise(one.times))
    return one.age > max(OLD, LATE * steps[len(steps) // 2] if steps else OLD)


def _age(one: ShownChannel) -> str:
    if not _is_old(one):
        return ""
    if one.age < 90:
        return f"{one.age:.0f} s old"
    return f"{one.age / 60:.0f} min old" if one.age < 5400 else f"{one.age / 3600:.0f} h old"


def _text(text: str) -> str:
    return escape(printable(text))
