"""Values as text: one vertex for the page's cursor, and a section of the wall as CSV."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from typing import Any

from helibore.base.errors import InputError
from helibore.viewer import messages
from helibore.viewer.scene import Scene

MOST_ROWS = 2_000_000
FARTHEST = 1e6  # metres: beyond any wall, but vertex numbers stay finite
ROWS_A_CHUNK = 256


def vertex(scene: Scene, k: int) -> dict[str, Any]:
    """Return all that the scene holds about vertex ``k``: metres, degrees, the attributes' units; None is missing."""
    shape, level = scene.shape, scene.levels[0]
    texel = level.texels[k]
    radius, first = (float(messages.radius_of(texel, shape.radius_unit, i)) for i in (messages.RADIUS, messages.FIRST))
    state = int(texel[messages.STATE])
    return {
        "vertex": k,
        "depth": shape.start_depth + k * shape.pitch / shape.sectors,
        "toolface": (shape.start_toolface + k % shape.sectors * 360 / shape.sectors) % 360,
        "radius": _or_none(radius),
        "first_radius": _or_none(first),
        "nearest": int(texel[messages.NEAREST]) * messages.NEAREST_UNIT if math.isfinite(radius) else None,
        "support": state & messages.SUPPORT_MASK,
        "rescanned": bool(state & messages.RESCANNED),
        "provisional": bool(state & messages.PROVISIONAL),
        "interpolated": bool(state & messages.INTERPOLATED),
        "attributes": {
            attribute.name: _or_none(float(column[k]))
            for attribute, column in zip(shape.attributes, level.columns, strict=True)
        },
    }


def section_ends(query: Mapping[str, str]) -> tuple[float, float]:
    """Return the two depths of the section that a request asks for."""
    for name in ("start", "stop"):
        if name not in query:
            raise InputError(name, "missing; ask for ?start=DEPTH&stop=DEPTH in metres")
    return float(query["start"]), float(query["stop"])


def vertices_between(scene: Scene, start: float, stop: float) -> tuple[float, float]:
    """Return the places on the helix, in vertices, of two depths in either order; the first is the lower."""
    if not (math.isfinite(start) and math.isfinite(stop)):
        raise InputError(f"start = {start}, stop", "must be finite", str(stop))
    shape = scene.shape
    depths = (max(-FARTHEST, min(depth, FARTHEST)) for depth in (start, stop))
    first, last = sorted((depth - shape.start_depth) / shape.pitch * shape.sectors for depth in depths)
    return first, last


def section_csv(scene: Scene, start: float, stop: float) -> Iterator[str]:
    """Return the vertices between two depths as chunks of CSV, as they are now.

    Raises
    ------
    InputError
        If the depths are not finite, or hold more than `MOST_ROWS` vertices.
    """
    ends = vertices_between(scene, start, stop)
    with scene.lock:
        first = max(0, math.ceil(ends[0]))
        last = max(first, min(scene.levels[0].size, math.floor(ends[1]) + 1))
        if last - first > MOST_ROWS:
            raise InputError(f"{last - first} vertices", f"a section holds at most {MOST_ROWS}; ask for less depth")
        return _chunks(scene.frozen_copy(first, last), first, last)


def _chunks(scene: Scene, first: int, last: int) -> Iterator[str]:
    names = "".join(f',"{a.name} [{a.unit}]"'.replace("\n", " ") for a in scene.shape.attributes)
    yield f"vertex,depth [m],toolface [deg],radius [m],first radius [m],nearest [m],support{names}\r\n"
    for start in range(first, last, ROWS_A_CHUNK):
        yield "".join(_line(vertex(scene, k)) for k in range(start, min(start + ROWS_A_CHUNK, last)))


def _line(row: dict[str, Any]) -> str:
    cells = [str(row["vertex"]), f"{row['depth']:.5f}", f"{row['toolface']:.4f}"]
    cells += [_text(row[name], ".5f") for name in ("radius", "first_radius")]
    cells += [_text(row["nearest"], ".4f"), str(row["support"])]
    return ",".join([*cells, *(_text(value, ".9g") for value in row["attributes"].values())]) + "\r\n"


def _text(value: float | None, form: str) -> str:
    return "" if value is None else format(value, form)


def _or_none(value: float) -> float | None:
    return value if math.isfinite(value) else None
