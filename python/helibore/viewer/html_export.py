"""A section of the wall and the page that shows it, as one HTML file that a browser opens from disk.

    index.html with app.css, more.js and app.js in it  +  handshake, state, history and binary messages of the section

The page reads the enclosed messages instead of opening a websocket, so it draws the section as the live page did, and
the overview of the whole wall. Its content-security policy forbids every request.
"""

from __future__ import annotations

import base64
import itertools
import json
import math
import time
from collections.abc import Iterable, Iterator, Mapping
from typing import Any
from urllib.parse import parse_qs

from helibore.base.errors import InputError
from helibore.base.harmless import printable, printable_texts
from helibore.viewer.client import Client
from helibore.viewer.exports import curve_bytes, vertices_between
from helibore.viewer.protocol import Subscription, handshake, picks_message, state_message
from helibore.viewer.scene import Scene

MOST_VERTICES = 1_000_000
MOST_ADDRESS = 128 * 1024  # characters: enough for 50 notes of 80 letters in any script
SCRIPT = '<script type="module" src="app.js"></script>'
POLICY = "default-src 'none'; style-src 'unsafe-inline'; script-src 'unsafe-inline'; img-src data: blob:"


def html_export(
    scene: Scene, files: Mapping[str, str], start: float, stop: float, address: str = "", *, hosted: bool = False
) -> Iterator[str]:
    """Return the file in chunks. This call copies the section; the chunks are written when they are read.

    ``files`` is the built page, texts by name; ``start`` and ``stop`` are depths in metres, in either order;
    ``address`` is the text after the # in the address of the page, which says what the page shows. A ``hosted`` page
    is a frame in a notebook, from which it gets later values. Raises InputError if the address is too long, the section
    has more than `MOST_VERTICES` vertices, or the wall does not reach the section.
    """
    if len(address) > MOST_ADDRESS:
        rule = f"{len(address)} characters, must be at most {MOST_ADDRESS}"
        raise InputError("address", rule)
    with scene.lock:
        tiles = tiles_between(scene, start, stop)
        level = scene.levels[0]
        copy = scene.frozen_copy(tiles[0] * level.tile_size, tiles[1] * level.tile_size + level.halo)
    enclosed = {
        "hello": handshake(copy),
        "state": state_message(copy),
        "curves": {name: base64.b64encode(curve_bytes(copy.curves[name])).decode() for name in _curves(copy, address)},
        "picks": picks_message(copy)["picks"],
        "made": round(time.time(), 1),
        "address": printable(address),
        "hosted": hosted,
        "history": copy.history.as_columns(),
        "summary": printable_texts(copy.summarize(*sorted((start, stop)))) if copy.summarize else None,
    }
    before, after = _page(files)
    app = files["more.js"] + files["app.js"]
    return itertools.chain([before], _scripts(enclosed, messages_of(copy, tiles), app), [after])


def _curves(scene: Scene, address: str) -> list[str]:
    """Return the names of the curves that ``address`` shows, and of those from which the caliper track is drawn."""
    shown = parse_qs(address.removeprefix("#")).get("curves", [""])[0].split("~")
    shown += (
        [] if scene.state.string is None else ["Clearance", "Clearance low", "Clearance high", "Tightest above bit"]
    )
    shown += ["DMIN", "C1", "C2", "C1TF"] if scene.state.shape == "arms" else []
    return [name for name in scene.curves if name in shown]


def _page(files: Mapping[str, str]) -> tuple[str, str]:
    """Return the page's HTML before and after its script; its style and a content-security policy are in the HTML."""
    policy = f'<meta http-equiv="Content-Security-Policy" content="{POLICY}">'
    page = files["index.html"]
    for old, new in (
        ('<meta charset="utf-8">', f'<meta charset="utf-8">\n{policy}'),
        ('<link rel="stylesheet" href="app.css">', f"<style>\n{files['app.css']}</style>"),
        (SCRIPT, SCRIPT),
    ):
        if page.count(old) != 1:
            raise RuntimeError(f"the page has no {old}: this is a bug in helibore")
        page = page.replace(old, new)
    before, after = page.split(SCRIPT)
    return before, after


def tiles_between(scene: Scene, start: float, stop: float) -> tuple[int, int]:
    """Return the half-open range of the wall's tiles that show the hole between two depths."""
    ends, level = vertices_between(scene, start, stop), scene.levels[0]
    first, last = max(0, math.floor(ends[0])), min(level.size - 1, math.ceil(ends[1]))
    if first > last:
        raise InputError(f"start = {start:g}, stop", "the wall does not reach there", f"{stop:g}")
    tiles = first // level.tile_size, last // level.tile_size + 1
    vertices = (tiles[1] - tiles[0]) * level.tile_size
    if vertices > MOST_VERTICES:
        raise InputError(f"{vertices} vertices", f"an export holds at most {MOST_VERTICES}; take a shorter section")
    return tiles


def messages_of(scene: Scene, tiles: tuple[int, int]) -> Iterator[bytes]:
    """Yield the messages that a page with these tiles receives."""
    client = Client(scene)
    client.subscribe(Subscription((tiles,), tiles[0], (1 << len(scene.shape.attributes)) - 1))
    while (message := client.next_message()) is not None:
        client.acknowledge(client.sequence)
        yield message


def _scripts(enclosed: dict[str, Any], messages: Iterable[bytes], app: str) -> Iterator[str]:
    """Yield the two scripts of the page, escaped so that no text in them ends a script. Base64 needs no escapes."""
    opened = json.dumps(enclosed, separators=(",", ":")).replace("<", "\\u003c").removesuffix("}")
    yield f'<script type="application/json" id="enclosed">{opened},"messages":['
    for i, message in enumerate(messages):
        yield f'{"," if i else ""}"{base64.b64encode(message).decode()}"'
    code = app.replace("</script", "<\\/script").replace("<!--", "<\\!--")
    yield f']}}</script>\n<script type="module">\n{code}</script>'
