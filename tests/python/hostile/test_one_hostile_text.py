"""One hostile text as a name, unit, title, note and message: no script, no escape and no formula survives."""

from __future__ import annotations

import html.parser
import io
import json
import xml.etree.ElementTree as ET
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest

pytest.importorskip("matplotlib")

from plotted_wall import image_of, plotted_wall

import helibore as hb
from helibore.base.harmless import HIDDEN
from helibore.logs.curves import ScalarCurve
from helibore.logs.picks import Pick, Picks
from helibore.plot.html_report import page
from helibore.plot.log import log
from helibore.viewer.feed import Feed
from helibore.viewer.html_export import html_export
from helibore.viewer.protocol import handshake, state_message

TAGS = "=x\"'><script>alert(1)</script><img src=x onerror=alert(1)>"
CONTROLS = "=\x1b[31m\x1b]0;A\x07\x9b31m\0\u202eab\u2066c\ufeff"
HOSTILE = CONTROLS + TAGS


class Tags(html.parser.HTMLParser):
    """The tags of a page, and the names of all their attributes."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.tags: set[str] = set()
        self.attributes: set[str] = set()
        self.feed(text)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.add(tag)
        self.attributes |= {name for name, _ in attrs}


def test_no_script_no_escape_and_no_formula_survives() -> None:
    wall = plotted_wall()
    image = wall.images.pop("GR")
    wall.images[HOSTILE] = image_of(image.depth, image.values, HOSTILE, "\x1b[31m")
    wall.picks = Picks([Pick(kind="bed", depth=2005.0, toolface=1.0, apparent_dip=2.0, note=TAGS)])
    report = page(wall, [(HOSTILE, HOSTILE)], title=HOSTILE, subtitle=HOSTILE, dpi=30)
    for text in (report, wall._repr_html_(), wall.images[HOSTILE]._repr_html_()):
        found = Tags(text)
        assert not HIDDEN.search(html.unescape(text))
        assert "script" not in found.tags
        assert not any(name.startswith("on") for name in found.attributes)
    drawn = io.BytesIO()
    log(wall, title=HOSTILE).savefig(drawn, format="svg")
    assert not HIDDEN.search(html.unescape(drawn.getvalue().decode()))
    tree = ET.fromstring(drawn.getvalue())
    names = {element.tag.rpartition("}")[2] for element in tree.iter() if isinstance(element.tag, str)}
    assert not {"script", "foreignObject", "img"} & names
    assert not any(name.startswith("on") for element in tree.iter() for name in element.attrib)
    assert ",'=x" in wall.picks.table().replace('"', "")


def test_no_escape_survives_in_the_texts_of_the_page() -> None:
    wall = hb.reconstruct(hb.Caliper.gauge(1000.0, 1003.0, 0.2), bit_diameter=0.2, sectors=16)
    scene = Feed(wall, path=None, attributes={HOSTILE: np.arange(len(wall) - 17.0)}, well=HOSTILE).scene
    scene.set_curves([ScalarCurve(HOSTILE, HOSTILE, np.array([1000.0, 1002.0]), np.array([1.0, 2.0]))])
    ((name, *_),) = state_message(scene)["curves"]
    assert name in scene.curves, "the page asks for a curve by the name that it was sent"
    messages = handshake(scene), state_message(scene)
    for message in messages:
        assert "31m" in json.dumps(message)
        assert not any(HIDDEN.search(text) for text in texts_of(message))
    files = {"index.html": '<meta charset="utf-8"><link rel="stylesheet" href="app.css">'}
    files["index.html"] += '<script type="module" src="app.js"></script>'
    exported = "".join(html_export(scene, files | {"app.css": "", "app.js": "", "more.js": ""}, 1000.0, 1003.0))
    assert not HIDDEN.search(exported)
    assert exported.count("</script>") == 2


def texts_of(value: Any) -> Iterator[str]:
    """Yield the texts in a message."""
    if isinstance(value, str):
        yield value
    elif isinstance(value, (dict, list, tuple)):
        for one in value.values() if isinstance(value, dict) else value:
            yield from texts_of(one)
