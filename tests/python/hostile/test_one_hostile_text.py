"""One hostile text as the name of an image, a title, a note and a message: no script and no formula survives."""

from __future__ import annotations

import html.parser
import io
import xml.etree.ElementTree as ET

import pytest

pytest.importorskip("matplotlib")

from plotted_wall import image_of, plotted_wall

from helibore.logs.picks import Pick, Picks
from helibore.plot.html_report import page
from helibore.plot.log import log

HOSTILE = "=x\"'><script>alert(1)</script><img src=x onerror=alert(1)>"


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


def test_no_script_and_no_formula_survives() -> None:
    wall = plotted_wall()
    image = wall.images.pop("GR")
    wall.images[HOSTILE] = image_of(image.depth, image.values, HOSTILE, "gAPI")
    wall.picks = Picks([Pick(kind="bed", depth=2005.0, toolface=1.0, apparent_dip=2.0, note=HOSTILE[:60])])
    report = page(wall, [(HOSTILE, HOSTILE)], title=HOSTILE, subtitle=HOSTILE, dpi=30)
    for text in (report, wall._repr_html_(), wall.images[HOSTILE]._repr_html_()):
        found = Tags(text)
        assert "script" not in found.tags
        assert not any(name.startswith("on") for name in found.attributes)
    drawn = io.BytesIO()
    log(wall, title=HOSTILE).savefig(drawn, format="svg")
    tree = ET.fromstring(drawn.getvalue())
    names = {element.tag.rpartition("}")[2] for element in tree.iter() if isinstance(element.tag, str)}
    assert not {"script", "foreignObject", "img"} & names
    assert not any(name.startswith("on") for element in tree.iter() for name in element.attrib)
    assert ",'=x" in wall.picks.table().replace('"', "")
