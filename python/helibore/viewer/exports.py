"""Values as text: one vertex for the page's pinned read-out, a section as CSV for a spreadsheet."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from typing import Any

from helibore.viewer import messages
from helibore.viewer.scene import Scene

MOST_ROWS = 2_000_000
FARTHEST = 1e6  # metres: depths beyond are beyond any wall, and their vertices have numbers
ROWS_A_PIECE = 256


def vertex(scene: Scene, k: int) -> dict[str, Any]:
    """Return all that the scene holds about vertex `k`: metres, degrees, attributes in their units; None is missing."""
    helix, level = scene.helix, scene.levels[0]
    texel = level.texels[k]
    radius = float(messages.radius_of(texel, helix.radius_unit))
    first = float(messages.radius_of(texel, helix.radius_unit, messages.FIRST))
    state = int(texel[messages.STATE])
    return {
        "vertex": k,
        "depth": helix.start_depth + k * helix.pitch / helix.sectors,
        "toolface": (helix.start_toolface + k % helix.sectors * 360 / helix.sectors) % 360,
        "radius": _or_none(radius),
        "first_radius": _or_none(first),
        "nearest": int(texel[messages.NEAREST]) * messages.NEAREST_UNIT if math.isfinite(radius) else None,
        "support": state & messages.SUPPORT_MASK,
        "rescanned": bool(state & messages.RESCANNED),
        "provisional": bool(state & messages.PROVISIONAL),
        "attributes": {
            attribute.name: _or_none(float(column[k]))
            for attribute, column in zip(helix.attributes, level.columns, strict=True)
        },
    }


def ends(query: Mapping[str, str]) -> tuple[float, float]:
    """Return the depths of a section that a request asks for."""
    found = []
    for name in ("start", "stop"):
        if name not in query:
            raise ValueError(f"{name}: missing; ask for ?start=DEPTH&stop=DEPTH in metres")
        found.append(float(query[name]))
    return found[0], found[1]


def section(scene: Scene, start: float, stop: float) -> Iterator[str]:
    """Return the vertices between two depths as lines of CSV, in pieces, all as they are now.

    Raises
    ------
    ValueError
        If the depths are not finite, or hold more than `MOST_ROWS` vertices.
    """
    if not (math.isfinite(start) and math.isfinite(stop)):
        raise ValueError(f"start = {start}, stop = {stop}: must be finite")
    start, stop = (max(-FARTHEST, min(depth, FARTHEST)) for depth in (start, stop))
    with scene.lock:
        helix = scene.helix
        ends = [(depth - helix.start_depth) / helix.pitch * helix.sectors for depth in (start, stop)]
        first = max(0, math.ceil(min(ends)))
        last = max(first, min(scene.levels[0].size, math.floor(max(ends)) + 1))
        if last - first > MOST_ROWS:
            raise ValueError(f"{last - first} vertices: a section holds at most {MOST_ROWS}; ask for less depth")
        return _lines(scene.still(first, last), first, last)


def _lines(scene: Scene, first: int, last: int) -> Iterator[str]:
    attributes = scene.helix.attributes
    names = "".join(f',"{a.name} [{a.unit}]"'.replace("\n", " ") for a in attributes)
    yield f"vertex,depth [m],toolface [deg],radius [m],first radius [m],nearest [m],support{names}\r\n"
    for start in range(first, last, ROWS_A_PIECE):
        yield "".join(_line(vertex(scene, k)) for k in range(start, min(start + ROWS_A_PIECE, last)))


def _line(row: dict[str, Any]) -> str:
    lengths = [_text(row[name], ".5f") for name in ("radius", "first_radius")]
    values = [_text(value, ".9g") for value in row["attributes"].values()]
    nearest = _text(row["nearest"], ".4f")
    cells = [
        str(row["vertex"]),
        f"{row['depth']:.5f}",
        f"{row['toolface']:.4f}",
        *lengths,
        nearest,
        str(row["support"]),
    ]
    return ",".join(cells + values) + "\r\n"


def _text(value: float | None, form: str) -> str:
    return "" if value is None else format(value, form)


def _or_none(value: float) -> float | None:
    return value if math.isfinite(value) else None
