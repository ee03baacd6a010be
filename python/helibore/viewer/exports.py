"""Values that the page requests: a vertex for its cursor, a curve, a section of the wall as CSV."""

from __future__ import annotations

import contextlib
import math
import struct
from collections.abc import Iterable, Iterator, Mapping
from typing import Any

import numpy as np

from helibore.base.errors import InputError
from helibore.logs.curves import ScalarCurve
from helibore.viewer.scene import Scene
from helibore.viewer.texels import (
    FIRST,
    INTERPOLATED,
    NEAREST,
    NEAREST_UNIT,
    PROVISIONAL,
    RADIUS,
    RESCANNED,
    STATE,
    SUPPORT_MASK,
    radius_of,
)

MOST_ROWS = 2_000_000
FARTHEST = 1e6  # metres: beyond any wall, but vertex numbers stay finite
ROWS_A_CHUNK = 256
PNG, PNG_SIZE = b"\x89PNG\r\n\x1a\n", slice(16, 24)
MOST_PIXELS = 8192
SCALES = 10, 10_000
"""Least and greatest N of a scale 1:N. A scale such as 1:1 would need a roll of paper, 1:100000 would show nothing."""


def vertex(scene: Scene, k: int) -> dict[str, Any]:
    """Return the values of vertex ``k`` in metres, degrees and the units of the attributes; a missing value is None.

    Radii and distances are rounded and limited as `pack_vertices` packs them. In a gauge hole nothing is measured, so
    its vertices have no radius, no distance and no support.
    """
    shape, level = scene.shape, scene.levels[0]
    texel = level.texels[k]
    radius, first = (float(radius_of(texel, shape.radius_unit, i)) for i in (RADIUS, FIRST))
    state = int(texel[STATE])
    if shape.basis == "gauge":
        radius = first = math.nan
    return {
        "vertex": k,
        "depth": shape.start_depth + k * shape.pitch / shape.sectors,
        "toolface": (shape.start_toolface + k % shape.sectors * 360 / shape.sectors) % 360,
        "radius": _or_none(radius),
        "first_radius": _or_none(first),
        "nearest": int(texel[NEAREST]) * NEAREST_UNIT if math.isfinite(radius) else None,
        "support": None if shape.basis == "gauge" else state & SUPPORT_MASK,
        "rescanned": bool(state & RESCANNED),
        "provisional": bool(state & PROVISIONAL),
        "interpolated": bool(state & INTERPOLATED),
        "attributes": {
            attribute.name: _or_none(float(column[k]))
            for attribute, column in zip(shape.attributes, level.columns, strict=True)
        },
    }


def curve_bytes(curve: ScalarCurve) -> bytes:
    """Return a curve for the page: its first depth as f64, n depths relative to it as f32, n values as f32."""
    first = curve.depth[:1] if curve.depth.size else np.zeros(1)
    columns = (curve.depth - first, curve.values)
    return first.astype("<f8").tobytes() + b"".join(column.astype("<f4").tobytes() for column in columns)


def section_ends(query: Mapping[str, str]) -> tuple[float, float]:
    """Return the depths ``start`` and ``stop`` that a request states, metres; ``start`` may be deeper than ``stop``."""
    start, stop = (_end(query, name) for name in ("start", "stop"))
    return start, stop


def _end(query: Mapping[str, str], name: str) -> float:
    if name not in query:
        raise InputError(name, "missing; ask for ?start=DEPTH&stop=DEPTH in metres")
    with contextlib.suppress(ValueError):
        if math.isfinite(depth := float(query[name])):
            return depth
    raise InputError(name, "must be a finite number of metres", query[name][:20])


def print_scale(query: Mapping[str, str]) -> int | None:
    """Return the scale of a print that a request states, 200 for 1:200; None if it states no scale."""
    text = query.get("scale")
    if text is None:
        return None
    if not (text.isdecimal() and SCALES[0] <= int(text) <= SCALES[1]):
        raise InputError("scale", f"must be a whole number from {SCALES[0]} to {SCALES[1]}, 200 for 1:200", text[:20])
    return int(text)


def checked_picture(body: bytes) -> bytes:
    """Return a PNG that a page sends; raise InputError if it is none, or wider or higher than `MOST_PIXELS`."""
    if not body.startswith(PNG) or len(body) < PNG_SIZE.stop:
        raise InputError("picture", "must be a PNG")
    size = struct.unpack(">II", body[PNG_SIZE])
    if not 1 <= min(size) <= max(size) <= MOST_PIXELS:
        raise InputError("picture", f"must have 1 to {MOST_PIXELS} pixels in each direction", f"{size[0]} x {size[1]}")
    return body


def vertices_between(scene: Scene, start: float, stop: float) -> tuple[float, float]:
    """Return the places on the helix, in vertices, of two depths in either order; the smaller place is first."""
    shape = scene.shape
    depths = (max(-FARTHEST, min(depth, FARTHEST)) for depth in (start, stop))
    first, last = sorted((depth - shape.start_depth) / shape.pitch * shape.sectors for depth in depths)
    return first, last


def section_csv(scene: Scene, start: float, stop: float) -> Iterator[str]:
    """Return the vertices between two depths as chunks of CSV, with the values at the time of this call.

    Raises InputError if there are more than `MOST_ROWS` vertices.
    """
    ends = vertices_between(scene, start, stop)
    with scene.lock:
        first = max(0, math.ceil(ends[0]))
        last = max(first, min(scene.levels[0].size, math.floor(ends[1]) + 1))
        if last - first > MOST_ROWS:
            raise InputError(f"{last - first} vertices", f"a section holds at most {MOST_ROWS}; take a shorter section")
        return _chunks(scene.frozen_copy(first, last), first, last)


def _chunks(scene: Scene, first: int, last: int) -> Iterator[str]:
    titles = (f"{a.name} [{a.unit}]".replace("\n", " ").replace('"', '""') for a in scene.shape.attributes)
    names = "".join(f',"{title}"' for title in titles)
    yield f"vertex,depth [m],toolface [deg],radius [m],first radius [m],nearest [m],support{names}\r\n"
    for start in range(first, last, ROWS_A_CHUNK):
        rows = (vertex(scene, k) for k in range(start, min(start + ROWS_A_CHUNK, last)))
        yield "".join(_line(row, row["attributes"].values()) for row in rows)


CSV_FORMS = {
    "vertex": "d", "depth": ".5f", "toolface": ".4f", "radius": ".5f", "first_radius": ".5f", "nearest": ".4f",
    "support": "d",
}  # fmt: skip


def _line(row: dict[str, Any], attributes: Iterable[float | None]) -> str:
    cells = [(row[name], form) for name, form in CSV_FORMS.items()] + [(value, ".9g") for value in attributes]
    return ",".join("" if value is None else format(value, form) for value, form in cells) + "\r\n"


def _or_none(value: float) -> float | None:
    return value if math.isfinite(value) else None
