"""A template of a log: its tracks, their order and widths. Viewer, prints and report read the same file.

    unit = "mm"                # of diameters: "mm" or "in"; "ft": inches, and feet for depths
    scale = 200                # 1:200

    [[track]]                  # the track of depths is always the first
    kind = "caliper"
    width = 136                # pixels of 1/96 in; may be left out

    [[track]]
    kind = "image"
    name = "Radius"            # the wall over bit size, or an image of the wall

    [[track]]
    kind = "curves"
    names = ["GR", "RUGO"]     # curves of files, and mnemonics of `Wall.logs`

On the viewer's page, *Curves*, *template …* saves a template. A curve or an image that a wall lacks is left out, so
that one template serves many wells.
"""

from __future__ import annotations

import os
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Annotated, Literal

from helibore.base.errors import InputError
from helibore.base.toml_file import parse_toml
from helibore.base.units import INCH, MILLIMETRE
from helibore.settings.declared import Declared, Formerly, at_least, within
from helibore.settings.toml_reading import TomlSource, read_table

SizeUnit = Literal["in", "mm", "ft"]
"""The unit of diameters; ft: inches, and feet for depths."""
PIXEL = INCH / MILLIMETRE / 96  # size of a pixel, millimetres


@dataclass(frozen=True)
class TemplateTrack(Declared, group="template.track"):
    """One track of a template, ``[[track]]``."""

    kind: Annotated[Literal["caliper", "image", "curves", "dips", "intervals"], "What the track shows."]
    name: Annotated[str, 'Name of the image, or "Radius"; or of the track of intervals, as "Casing".'] = ""
    names: Annotated[tuple[str, ...], "Names of the curves, or mnemonics of logs; only for curves."] = ()
    width: Annotated[float | None, within(20, 4000, "pixels"), "Width, in pixels of 1/96 in."] = None

    def _check(self) -> None:
        named = ("name", self.name, ("image", "intervals")), ("names", list(self.names), ("curves",))
        for name, value, kinds in named:
            if (self.kind in kinds) != bool(value):
                listed = " or ".join(kinds)
                raise InputError(name, f"must be given if kind is {listed}, and left out for other kinds", repr(value))

    @property
    def millimetres(self) -> float | None:
        """Width on paper, millimetres."""
        return None if self.width is None else self.width * PIXEL


@dataclass(frozen=True)
class Template(Declared, group="template"):
    """A template of a log, a file of its own, without ``template.`` in the names of its tables."""

    unit: Annotated[SizeUnit, Formerly("units"), "Unit of diameters; ft: inches, and feet for depths."] = "mm"
    scale: Annotated[int | None, at_least(1), "Depth scale, 200 for 1:200. None: not chosen."] = None
    track: Annotated[tuple[TemplateTrack, ...], "Tracks from left to right, after that of the depths."] = ()

    @classmethod
    def load(cls, filename: str | os.PathLike[str]) -> Template:
        """Read a template. Raise InputError if it breaks a rule; the error names file, line and place."""
        source, tree = TomlSource.load(Path(filename))
        return read_table(cls, tree, replace(source, recorded=True))  # pages of earlier versions saved "units"

    @classmethod
    def parse(cls, text: str) -> Template:
        """Return the template of a text, such as that of a page; raise InputError if it breaks a rule."""
        return read_table(cls, parse_toml(text, "template"), TomlSource("template", text=text))
