"""One section of the wall with the page that shows it, as one HTML file: for the office, opened from disk.

    index.html with app.css and app.js in it  +  greeting, state, history and the binary messages a page would have got

The page plays the enclosed messages instead of opening a websocket, so that it draws what it drew at the rig, overview
of the whole well included. The file asks nothing of any network: its content-security policy forbids it.
"""

from __future__ import annotations

import base64
import html
import itertools
import json
import math
import time
from collections.abc import Iterable, Iterator
from typing import Any

from helibore.viewer.client import Client, Subscription
from helibore.viewer.exports import FARTHEST
from helibore.viewer.greeting import greeting, state
from helibore.viewer.scene import Scene

MOST_VERTICES = 1_000_000
MOST_ADDRESS = 128 * 1024  # characters: 200 dips of twelve points and 50 notes of 80 letters of any script
CLOSING = '<form method="dialog"><button>Close</button></form>'
SCRIPT = '<script type="module" src="app.js"></script>'
POLICY = "default-src 'none'; style-src 'unsafe-inline'; script-src 'unsafe-inline'; img-src data: blob:"


def snapshot(scene: Scene, files: dict[str, str], start: float, stop: float, address: str = "") -> Iterator[str]:
    """Return the file, in pieces, as the scene is now: it is copied here, and written as the pieces are asked for.

    Parameters
    ----------
    scene
        What is shown.
    files
        The built page: name to text.
    start, stop
        Depths of the section, metres, in either order.
    address
        What the page looks at, as after the # of its address.

    Raises
    ------
    ValueError
        If the depths are not finite or not of this wall, or hold more than `MOST_VERTICES` vertices;
        if the address has more than `MOST_ADDRESS` characters.
    """
    if len(address) > MOST_ADDRESS:
        raise ValueError(
            f"address: {len(address)} characters, must be at most {MOST_ADDRESS}; keep fewer dips or notes"
        )
    with scene.lock:
        tiles = tiles_between(scene, start, stop)
        level = scene.levels[0]
        still = scene.still(tiles[0] * level.tile_size, tiles[1] * level.tile_size + level.halo)
    told = {
        "hello": greeting(still),
        "state": state(still),
        "made": round(time.time(), 1),
        "address": address,
        "history": still.history.as_columns(),
    }
    before, after = _page(files)
    return itertools.chain([before], _scripts(told, messages_of(still, tiles), files["app.js"]), [after])


def _page(files: dict[str, str]) -> tuple[str, str]:
    """Return what stands before and after the page's script, with all it needs in it."""
    licences = f"<pre hidden>{html.escape(files['licences.txt'])}</pre>"
    policy = f'<meta http-equiv="Content-Security-Policy" content="{POLICY}">'
    page = files["index.html"]
    for old, new in (
        ('<meta charset="utf-8">', f'<meta charset="utf-8">\n{policy}'),
        ('<link rel="stylesheet" href="app.css">', f"<style>\n{files['app.css']}</style>"),
        ('<a href="licences.txt" target="_blank" rel="noopener">', "<a>"),
        (CLOSING, f"{licences}\n  {CLOSING}"),
        (SCRIPT, SCRIPT),
    ):
        if page.count(old) != 1:
            raise RuntimeError(f"the page has no {old}: this is a bug in helibore")
        page = page.replace(old, new)
    before, after = page.split(SCRIPT)
    return before, after


def tiles_between(scene: Scene, start: float, stop: float) -> tuple[int, int]:
    """Return the range of the wall's tiles that show two depths and what lies between."""
    if not (math.isfinite(start) and math.isfinite(stop)):
        raise ValueError(f"start = {start}, stop = {stop}: must be finite")
    start, stop = (max(-FARTHEST, min(depth, FARTHEST)) for depth in (start, stop))
    helix, level = scene.helix, scene.levels[0]
    at = sorted((depth - helix.start_depth) / helix.pitch * helix.sectors for depth in (start, stop))
    first, last = max(0, math.floor(at[0])), min(level.size - 1, math.ceil(at[1]))
    if first > last:
        raise ValueError(f"start = {start:g}, stop = {stop:g}: the wall does not reach there")
    tiles = first // level.tile_size, last // level.tile_size + 1
    vertices = (tiles[1] - tiles[0]) * level.tile_size
    if vertices > MOST_VERTICES:
        raise ValueError(f"{vertices} vertices: a snapshot holds at most {MOST_VERTICES}; take a shorter section")
    return tiles


def messages_of(scene: Scene, tiles: tuple[int, int]) -> Iterator[bytes]:
    """Yield what a page that asks for these tiles would be sent."""
    client = Client(scene)
    client.subscribe(Subscription((tiles,), tiles[0], (1 << len(scene.helix.attributes)) - 1))
    while (message := client.take()) is not None:
        client.acknowledge(client.sequence)
        yield message


def _scripts(told: dict[str, Any], messages: Iterable[bytes], app: str) -> Iterator[str]:
    """Yield two scripts; nothing in them may end them early. Base64 has no character that a script or JSON minds."""
    opened = json.dumps(told, separators=(",", ":")).replace("<", "\\u003c").removesuffix("}")
    yield f'<script type="application/json" id="enclosed">{opened},"messages":['
    for i, message in enumerate(messages):
        yield f'{"," if i else ""}"{base64.b64encode(message).decode()}"'
    code = app.replace("</script", "<\\/script").replace("<!--", "<\\!--")
    yield f']}}</script>\n<script type="module">\n{code}</script>'
