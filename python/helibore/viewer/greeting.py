"""What a page is told in text: at first the wall's shape, then, whenever it changed, how the run goes."""

from __future__ import annotations

import math
import time
from typing import Any

from helibore.viewer import messages
from helibore.viewer.scene import Attribute, Scene


def greeting(scene: Scene) -> dict[str, Any]:
    """Return what a page must know before any value."""
    helix = scene.helix
    wall, over = scene.levels
    return {
        "type": "hello",
        "version": 1,
        "session": scene.session,
        "well": helix.well,
        "bit_diameter": helix.bit_diameter,
        "start_depth": helix.start_depth,
        "start_toolface": helix.start_toolface,
        "vertices": wall.size,
        "radius_unit": helix.radius_unit,
        "nearest_unit": messages.NEAREST_UNIT,
        "levels": [
            {"sectors": wall.sectors, "rows": wall.rows, "pitch": helix.pitch},
            {"sectors": over.sectors, "rows": over.rows, "pitch": helix.pitch * 16},
        ],
        "frame_step": math.copysign(messages.FRAME_STEP, helix.pitch),
        "attributes": [_described(attribute) for attribute in helix.attributes],
    }


def _described(attribute: Attribute) -> dict[str, Any]:
    return {
        "name": attribute.name,
        "unit": attribute.unit,
        "low": attribute.low,
        "high": attribute.high,
        "log": attribute.log,
        "colours": attribute.colours,
    }


def state(scene: Scene) -> dict[str, Any]:
    """Return where the bit is, how old the newest sample is by the server's clock, and what the sources are doing."""
    bit, newest = scene.bit_depth, scene.newest
    return {
        "type": "state",
        "begun": scene.begun,
        "feed": scene.feed,
        "bit_depth": bit if math.isfinite(bit) else None,
        "newest": newest if math.isfinite(newest) else None,
        "now": round(time.time(), 1) if math.isfinite(newest) else None,
        "ended": scene.ended,
    }
