"""Templates of a log: read as they are written, and refused with the place of what is wrong."""

from __future__ import annotations

from pathlib import Path

import pytest

from helibore.base.errors import InputError
from helibore.logs.template import Template, TemplateTrack

TEXT = """
units = "ft"
scale = 200
[[track]]
kind = "image"
name = "Radius"
width = 192
[[track]]
kind = "curves"
names = ["GR", "DEQ"]
"""


def test_a_template_has_tracks_in_order_with_their_widths(tmp_path: Path) -> None:
    file = tmp_path / "a.toml"
    file.write_text(TEXT)
    read = Template.load(file)
    assert (read.units, read.scale) == ("ft", 200)
    assert read.tracks == (TemplateTrack("image", "Radius", (), 192), TemplateTrack("curves", "", ("GR", "DEQ")))
    assert read.tracks[0].millimetres == pytest.approx(50.8)
    assert Template.load(file) == read
    file.write_text("")
    assert Template.load(file) == Template()


@pytest.mark.parametrize(
    ("text", "error"),
    [
        ("units = 1", "units = 1: must be one of mm, in, ft"),
        ("scale = 0.5", "scale = 0.5: must be a whole number, 200 for 1:200"),
        ("track = 3", "track: must be tables, [[track]]"),
        ("colour = 1", "colour: must be one of units, scale, track"),
        ('[[track]]\nkind = "map"', "track 1: kind = 'map': must be one of caliper, image, curves, dips"),
        (
            '[[track]]\nkind = "image"',
            "track 1: name = '': must name the image if kind is image; leave it out for other kinds",
        ),
        (
            '[[track]]\nkind = "dips"\nnames = ["a"]',
            "track 1: names = ['a']: must list the curves if kind is curves; leave it out for other kinds",
        ),
        ('[[track]]\nkind = "dips"\nwidth = 5', "track 1: width = 5: must be 20 to 4000 pixels"),
        ('[[track]]\nkind = "dips"\nheight = 5', "track 1: height: must be one of kind, name, names, width"),
        ("units =", "not TOML: Invalid value (at end of document)"),
    ],
)
def test_what_breaks_a_rule_is_named(tmp_path: Path, text: str, error: str) -> None:
    file = tmp_path / "a.toml"
    file.write_text(text)
    with pytest.raises(InputError) as raised:
        Template.load(file)
    assert str(raised.value) == f"{file}: {error}"
