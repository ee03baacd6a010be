"""Templates of a log: read as they are written, and refused with the place of what is wrong."""

from __future__ import annotations

from pathlib import Path

import pytest

from helibore.base.errors import InputError
from helibore.settings.template import Template, TemplateTrack

TEXT = """
unit = "ft"
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
    assert (read.unit, read.scale) == ("ft", 200)
    assert read.track == (TemplateTrack("image", "Radius", (), 192), TemplateTrack("curves", "", ("GR", "DEQ")))
    assert read.track[0].millimetres == pytest.approx(50.8)
    assert Template.load(file) == read
    file.write_text("")
    assert Template.load(file) == Template()


@pytest.mark.parametrize(
    ("text", "place", "rule", "value"),
    [
        ("unit = 1", "line 1: unit", "must be one of in, mm, ft", "1"),
        ("\nunits = 1", "line 2: units", "must be one of in, mm, ft", "1"),
        ("scale = 0.5", "line 1: scale", "must be an integer", "0.5"),
        ("scale = 0", "line 1: scale", "must be at least 1", "0"),
        ("track = 3", "line 1: track", "must be tables, [[track]]", "3"),
        ("colour = 1", "line 1: colour", "must be one of unit, scale, track", None),
        ('[[track]]\nkind = "map"', "line 2: track 1.kind", "must be one of caliper, image, curves, dips", "'map'"),
        ("[[track]]\nwidth = 50", "line 1: track 1.kind", "is missing", None),
        (
            '[[track]]\nkind = "image"',
            "line 1: track 1.name",
            "must be given if kind is image or intervals, and left out for other kinds",
            "''",
        ),
        (
            '[[track]]\nkind = "dips"\nnames = ["a"]',
            "line 3: track 1.names",
            "must be given if kind is curves, and left out for other kinds",
            "['a']",
        ),
        ('[[track]]\nkind = "dips"\nwidth = 5', "line 3: track 1.width", "must lie in 20 to 4000 pixels", "5"),
        ('[[track]]\nkind = "dips"\nheight = 5', "line 3: track 1.height", "must be one of kind, name", None),
    ],
)
def test_what_breaks_a_rule_is_named(tmp_path: Path, text: str, place: str, rule: str, value: str | None) -> None:
    file = tmp_path / "a.toml"
    file.write_text(text)
    with pytest.raises(InputError) as raised:
        Template.load(file)
    assert (raised.value.place, raised.value.value) == (f"a.toml, {place}", value)
    assert raised.value.rule.startswith(rule)


def test_a_template_of_an_earlier_page_has_units(tmp_path: Path) -> None:
    (tmp_path / "a.toml").write_text(TEXT.replace("unit =", "units ="))
    (tmp_path / "b.toml").write_text(TEXT)
    assert Template.load(tmp_path / "a.toml") == Template.load(tmp_path / "b.toml")
