"""The messages between server and page: JSON as text, values as bytes. ``protocol.js`` and ``connection.js`` read them.

    handshake    what a page must know before it receives values        to the page, JSON
    state        the `RunState`: bit depth, curves, zones ...
    picks        all picks
    WRITE        vertices of a tile                                     to the page, bytes
    FRAMES       frames of the path
    subscribe    the tiles and attributes that the page wants           to the server, JSON
    ack          the page has applied a message

The bytes are little endian; every array starts at a multiple of its item size.

    head, 32 bytes                                              payload of WRITE
    +------+-------+----------+------+-------+-------+          +-------------------------+--------------+----
    | type | level | mask u16 | tile | first | count |  u32 ..  | texels u16 x 4 x count  | f32 x count  | ..
    | u8   | u8    |          | u32  | u32   | u32   |          +-------------------------+--------------+----
    +------+-------+----------+------+-------+-------+           one f32 column per bit of the mask, lowest first
    | total u32    | sequence u32    | time f64      |
    +--------------+-----------------+---------------+

If all radii of a WRITE equal the radii of the first pass, the WRITE leaves out the radii of the first pass. Its `level`
then has the bit NO_FIRST, a texel is radius, nearest distance, state, and two zero bytes follow an odd number of
texels.

A WRITE sets `count` vertices of a tile from `first` on; `first` counts from the start of the tile. A tile includes its
halo, the first sectors + 1 vertices of the next tile. A WRITE can be repeated: the message is the same for a new
quad, a changed quad and a quad that is sent again. `mask` says which attributes follow. The highest bit of the type,
LIVE, marks values that are new; a WRITE without LIVE belongs to a tile that the page requested. FRAMES carries frames
of the path: f64 x 3 x count centres, then f32 x 6 x count directions. Its `mask` is SURVEYED if a survey places them;
without a survey the hole is drawn straight down, and north is not known.
"""

from __future__ import annotations

import math
import struct
import time
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np

from helibore.base.harmless import printable_texts
from helibore.viewer.levels import TURNS
from helibore.viewer.scene import FRAME_STEP, FRAMES_LEVEL, Scene
from helibore.viewer.texels import FIRST, NEAREST_UNIT, RADIUS

HEAD = struct.Struct("<BBHIIIIId")
WRITE, FRAMES = 1, 3
LIVE = 0x80
NO_FIRST = 0x80
SURVEYED = 1
MOST_RANGES = 64  # ranges of tiles in one subscription


class BadMessageError(ValueError):
    """Error for a message from a page that breaks the protocol; its text names the rule."""


@dataclass(frozen=True)
class Subscription:
    """What a page asks for: ranges of tiles of the wall, the tile in its view, a bit for each attribute it draws."""

    ranges: tuple[tuple[int, int], ...]
    focus: int
    mask: int


def write_message(scene: Scene, level: int, tile: int, first: int, stop: int, mask: int, live: bool) -> bytearray:
    """Return a WRITE of the vertices [first, stop) of a tile, with the attributes whose bits ``mask`` has."""
    store = scene.levels[level]
    part = slice(tile * store.tile_size + first, tile * store.tile_size + stop)
    texels = store.texels[part].astype("<u2", copy=False)
    if first_pass := bool((texels[:, FIRST] == texels[:, RADIUS]).all()):
        level, texels = level | NO_FIRST, np.delete(texels, FIRST, axis=1)
    message = _head(WRITE | (LIVE if live else 0), level, mask, tile, first, stop - first, store.size)
    message += texels.tobytes() + bytes(2 * (first_pass and (stop - first) % 2))
    for bit, column in enumerate(store.columns):
        if mask >> bit & 1:
            message += column[part].astype("<f4", copy=False).tobytes()
    return message


def frames_message(scene: Scene, first: int, stop: int) -> bytearray:
    """Return a FRAMES message with the frames [first, stop) of the path."""
    frames = scene.frames
    mask, total = SURVEYED if frames.surveyed else 0, len(frames.centre)
    message = _head(FRAMES, FRAMES_LEVEL, mask, 0, first, stop - first, total)
    message += frames.centre[first:stop].astype("<f8", copy=False).tobytes()
    message += np.hstack([frames.high[first:stop], frames.right[first:stop]]).astype("<f4").tobytes()
    return message


def _head(kind: int, level: int, mask: int, tile: int, first: int, count: int, total: int) -> bytearray:
    """Return a message's head; `number` sets the sequence number when the message is sent."""
    return bytearray(HEAD.pack(kind, level, mask, tile, first, count, total, 0, time.time()))


def number(message: bytearray, sequence: int) -> bytes:
    """Return the message with its sequence number."""
    struct.pack_into("<I", message, 20, sequence)
    return bytes(message)


def handshake(scene: Scene) -> dict[str, Any]:
    """Return what a page must know before it receives values; its texts are `printable`, as the page shows them."""
    shape = scene.shape
    wall, over = scene.levels
    said = {
        "type": "handshake",
        "version": 2,
        "session": scene.session,
        "well": shape.well,
        "basis": shape.basis,
        "basis_text": shape.basis_text,
        "reference": shape.reference,
        "assumed": shape.assumed,
        "north": scene.frames.north,
        "bit_diameter": shape.bit_diameter,
        "start_depth": shape.start_depth,
        "start_toolface": shape.start_toolface,
        "vertices": wall.size,
        "radius_unit": shape.radius_unit,
        "nearest_unit": NEAREST_UNIT,
        "levels": [
            {"sectors": wall.sectors, "rows": wall.rows, "pitch": shape.pitch, "rings": False},
            {"sectors": over.sectors, "rows": over.rows, "pitch": shape.pitch * TURNS, "rings": True},
        ],
        "frame_step": math.copysign(FRAME_STEP, shape.pitch),
        "template": None if scene.template is None else asdict(scene.template),
        "attributes": [asdict(attribute) for attribute in shape.attributes],
        "picks_file": None if scene.picks_file is None else Path(scene.picks_file).name,
        "saves_picks": scene.saves_picks,
        "intervals": [one.as_row() for one in scene.intervals],
        "plan": np.round(scene.plan, 2).tolist(),
        "curves": [row["name"] for row in scene.state.curves if row["version"] == 0],  # the curves that a caller gave
    }
    found: dict[str, Any] = printable_texts(said)
    return found


def state_message(scene: Scene) -> dict[str, Any]:
    """Return the `RunState` for a page, with the server's clock; its texts are `printable`."""
    state = {name: None if value != value else value for name, value in vars(scene.state).items()}  # NaN is not JSON
    now = None if state["newest"] is None and state["received"] is None else round(time.time(), 1)
    rows = [list(row.values()) for row in scene.state.curves]  # name, unit, low, high, log, version
    curves = {"curves": [row[:-1] for row in rows], "curves_version": sum(row[-1] for row in rows)}
    found: dict[str, Any] = printable_texts({"type": "state", "begun": scene.begun, **state, **curves, "now": now})
    return found


def picks_message(scene: Scene) -> dict[str, Any]:
    """Return the picks for a page."""
    return {"type": "picks", "picks": [asdict(pick) for pick in scene.picks]}


def read_subscription(wanted: Any, attributes: int) -> Subscription:
    """Return the subscription of a message ``{"tiles": [[start, stop], ...], "focus": tile, "mask": bits}``.

    Raises BadMessageError for a part that is missing, of another type or out of bounds; a mask has ``attributes`` bits.
    """
    if not isinstance(wanted, dict):
        raise BadMessageError("subscribe: must be an object")
    ranges, focus, mask = wanted.get("tiles"), wanted.get("focus"), wanted.get("mask")
    if not isinstance(ranges, list) or len(ranges) > MOST_RANGES:
        raise BadMessageError(f"subscribe.tiles: must be a list of at most {MOST_RANGES} ranges")
    for part in ranges:
        whole = isinstance(part, list) and len(part) == 2 and all(type(number) is int for number in part)
        if not whole or not 0 <= part[0] < part[1] <= 1 << 31:
            raise BadMessageError(f"subscribe.tiles: {str(part)[:40]} is not a range [start, stop) of tiles")
    if type(focus) is not int or not 0 <= focus <= 1 << 31:
        raise BadMessageError(f"subscribe.focus = {str(focus)[:40]}: must be a tile's number")
    if type(mask) is not int or not 0 <= mask < 1 << attributes:
        raise BadMessageError(f"subscribe.mask = {str(mask)[:40]}: there are {attributes} attributes")
    return Subscription(tuple((start, stop) for start, stop in ranges), focus, mask)
