"""A template of a log: its tracks, their order and widths. Viewer, prints and report read the same file.

    units = "mm"               # of diameters: "mm" or "in"; "ft": inches, and feet for depths
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
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

from helibore.base.errors import InputError, check_choice, check_names
from helibore.base.toml_file import read_toml
from helibore.base.units import INCH, MILLIMETRE

KINDS = ("caliper", "image", "curves", "dips")
UNITS = ("mm", "in", "ft")
WIDTHS = (20.0, 4000.0)
PIXEL = INCH / MILLIMETRE / 96  # size of a pixel, millimetres


@dataclass(frozen=True)
class TemplateTrack:
    """One track: kind, name of its image or names of its curves, and width in pixels (None: default)."""

    kind: str
    name: str = ""
    names: tuple[str, ...] = ()
    width: float | None = None

    @property
    def millimetres(self) -> float | None:
        """Width on paper, millimetres."""
        return None if self.width is None else self.width * PIXEL


@dataclass(frozen=True)
class Template:
    """Unit of diameters, depth scale (200 for 1:200; None: not chosen), and tracks from left to right."""

    units: Literal["mm", "in", "ft"] = "mm"
    scale: int | None = None
    tracks: tuple[TemplateTrack, ...] = ()

    @classmethod
    def load(cls, filename: str | os.PathLike[str]) -> Template:
        """Read a template. Raise InputError if it breaks a rule; the error names the file and the place."""
        tree = read_toml(Path(filename), str(filename))
        try:
            return template_of(tree)
        except InputError as error:
            raise error.within(str(filename)) from error


def template_of(content: dict[str, Any]) -> Template:
    """Return the template that parsed TOML describes; raise InputError, which names the place, if it breaks a rule."""
    check_names("", content, ("units", "scale", "track"))
    units, scale, rows = content.get("units", "mm"), content.get("scale"), content.get("track", [])
    check_choice("units", units, UNITS)
    if scale is not None and not (type(scale) is int and scale >= 1):
        raise InputError("scale", "must be a whole number, 200 for 1:200", repr(scale))
    if not isinstance(rows, list) or not all(isinstance(row, dict) for row in rows):
        raise InputError("track", "must be tables, [[track]]")
    return Template(units, scale, tuple(_track(f"track {number}", row) for number, row in enumerate(rows, 1)))


def _track(place: str, row: dict[str, Any]) -> TemplateTrack:
    check_names(f"{place}: ", row, ("kind", "name", "names", "width"))
    kind, name, names, width = row.get("kind", ""), row.get("name", ""), row.get("names", []), row.get("width")
    check_choice(f"{place}: kind", kind, KINDS)
    if not isinstance(name, str) or (kind == "image") != bool(name):
        rule = "must name the image if kind is image; leave it out for other kinds"
        raise InputError(f"{place}: name", rule, repr(name))
    if not (isinstance(names, list) and all(isinstance(one, str) for one in names)) or (kind == "curves") != bool(
        names
    ):
        raise InputError(
            f"{place}: names", "must list the curves if kind is curves; leave it out for other kinds", repr(names)
        )
    if width is not None and not (isinstance(width, (int, float)) and WIDTHS[0] <= width <= WIDTHS[1]):
        raise InputError(f"{place}: width", f"must be {WIDTHS[0]:g} to {WIDTHS[1]:g} pixels", repr(width))
    return TemplateTrack(kind, name, tuple(names), width)
