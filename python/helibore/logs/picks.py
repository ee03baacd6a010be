"""Features picked on a wall, each with a class: planes (beds, fractures, faults), breakouts and notes.

    wall.picks.append(Pick(kind="bed", depth=2054.2, apparent_dip=21.0, toolface=140.0))
    wall.picks[0].dip(wall.path)                      # true dip and its azimuth, degrees
    wall.picks.save("f12.wall.picks.csv", wall.path)  # `hb.load("f12.wall")` reads it again

A plane crosses the axis of the hole at ``depth``. From that point x counts towards toolface 0, y towards toolface 90
and z along the hole. The equation of the plane is

    z = tan(apparent_dip) (cos(toolface) x + sin(toolface) y)

so on a hole of radius R it is a sinusoid of height 2 R tan(apparent_dip), deepest at ``toolface``. A breakout is a box
``height`` metres high and ``opening`` degrees wide on each of two opposite sides of the hole. A note is a
text at a depth.
"""

from __future__ import annotations

import csv
import hashlib
import io
import math
import os
import re
import secrets
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, fields, replace
from pathlib import Path as FilePath
from typing import Any

import numpy as np

from helibore.base.atomic_file import write_whole
from helibore.base.errors import InputError, check_choice
from helibore.base.harmless import HIDDEN, cell, printable, text_of
from helibore.base.regular_file import check_regular
from helibore.trajectory.survey import Path

ENDING = ".picks.csv"
PLANES = ("bed", "fracture", "healed fracture", "induced fracture", "fault")
BREAKOUT = "breakout"
NOTE = "note"
CLASSES = (*PLANES, BREAKOUT, NOTE)
ALIASES = {
    "bedding": "bed", "open fracture": "fracture", "partly open fracture": "fracture",
    "partially open fracture": "fracture", "closed fracture": "healed fracture", "sealed fracture": "healed fracture",
    "filled fracture": "healed fracture", "vein": "healed fracture",
}  # fmt: skip
"""Classes of other programs, and the class that a pick of a table then gets; its note, if empty, keeps the word."""
NUMBERS = (int, float, np.integer, np.floating)
MOST = 5000
LONGEST_NOTE = 80
LIMITS: dict[str, tuple[float, float]] = {
    "depth": (-1e6, 1e6), "toolface": (0.0, 360.0), "apparent_dip": (0.0, 89.9), "radius": (0.001, 10.0),
    "misfit": (0.0, 10.0), "height": (0.0, 1000.0), "opening": (0.0, 180.0), "tilt": (-90.0, 90.0),
    "dip_sigma": (0.0, 90.0), "toolface_sigma": (0.0, 180.0), "aperture": (0.0, 10.0),
}  # fmt: skip
COLUMNS = {
    "class": "kind", "DEPT (m)": "depth", "TOOLFACE (deg)": "toolface", "APPARENT_DIP (deg)": "apparent_dip",
    "RADIUS (m)": "radius", "MISFIT (m)": "misfit", "POINTS": "points", "HEIGHT (m)": "height",
    "OPENING (deg)": "opening", "TILT (deg)": "tilt", "APPARENT_DIP_SIGMA (deg)": "dip_sigma",
    "TOOLFACE_SIGMA (deg)": "toolface_sigma", "APERTURE (m)": "aperture", "note": "note", "image": "image",
    "key": "key",
}  # fmt: skip
"""Columns of the table, as in logs and zones, and the field of `Pick` in each; `DIP` and `DERIVED` have more."""
DIP = ("DIP (deg)", "DIP_AZIMUTH (deg)")
AXIS = "AXIS_AZIMUTH (deg)"
DERIVED = (*DIP, "DIP_SIGMA (deg)", "DIP_AZIMUTH_SIGMA (deg)", AXIS)
"""Columns that follow from a pick and the path; sigmas are half the intervals of `Pick.dip_interval`, over 1.96."""
APPARENT = ("TOOLFACE (deg)", "APPARENT_DIP (deg)")
TEXTS = ("kind", "note", "image", "key")
OPTIONAL = ("radius", "dip_sigma", "toolface_sigma", "aperture")
"""Numbers that may be None."""
SURE = 1.96
"""Standard deviations of an interval of 95 %."""
FAR = 0.6
"""Radians: a dip that is no surer shows no direction."""
PLACE = ("kind", "depth", "toolface", "apparent_dip", "height", "opening", "tilt")
"""Fields by which two picks with different keys are recognised as one feature."""


@dataclass(frozen=True, kw_only=True)
class Pick:
    """A plane, a breakout or a note on the wall. Lengths in metres, angles in degrees.

    Attributes
    ----------
    kind
        One of `CLASSES`.
    depth
        Measured depth at which a plane crosses the axis, of the middle of a breakout, or of a note.
    toolface
        Toolface at which a plane is deepest, or of the middle of one side of a breakout. 0 for a note.
    apparent_dip
        Angle between a plane and the plane at right angles to the hole. 0 for a breakout or a note.
    radius
        Radius of the hole where the plane was picked; None: the radius of the bit.
    misfit, points
        Root mean square misfit, along the hole, of the points that the plane was fitted to, and the number of points.
    height, opening, tilt
        Of a breakout: its length along the hole, its width around the hole, and the angle by which it leans from the
        axis; if the angle is above 0, the deeper part of the breakout lies at greater toolfaces.
    dip_sigma, toolface_sigma
        Standard uncertainties of ``apparent_dip`` and of the ``toolface`` of a plane, by how far a hand is off on the
        screen and by the misfit; None: not known.
    aperture
        How far the wall shows a fracture or fault open across its plane; None: not open, or not known.
    note
        At most 80 characters.
    image
        Name of the image on which the pick was made; "": not known.
    key
        Random identifier of the pick. It stays the same when the pick is edited, or its table is saved and reopened.
    """

    kind: str
    depth: float
    toolface: float
    apparent_dip: float = 0.0
    radius: float | None = None
    misfit: float = 0.0
    points: int = 0
    height: float = 0.0
    opening: float = 0.0
    tilt: float = 0.0
    dip_sigma: float | None = None
    toolface_sigma: float | None = None
    aperture: float | None = None
    note: str = ""
    image: str = ""
    key: str = field(default_factory=lambda: secrets.token_hex(6), compare=False)

    def __post_init__(self) -> None:
        check_choice("class", self.kind, CLASSES)
        for name, (low, high) in LIMITS.items():
            value = getattr(self, name)
            if value is None and name in OPTIONAL:
                continue
            if isinstance(value, bool) or not (isinstance(value, NUMBERS) and low <= value <= high):
                raise InputError(name, f"must be {low:g} to {high:g}", str(value))
            vars(self)[name] = float(value)
        if self.kind == BREAKOUT and not (self.height > 0 and self.opening > 0):
            raise InputError("breakout", "height and opening must be above 0")
        if isinstance(self.points, bool) or not (isinstance(self.points, (int, np.integer)) and self.points >= 0):
            raise InputError("points", "must be a whole number, 0 or more", str(self.points))
        vars(self)["points"] = int(self.points)
        for name, most in (("note", LONGEST_NOTE), ("image", LONGEST_NOTE), ("key", 32)):
            text = getattr(self, name)
            if not isinstance(text, str) or len(text) > most:
                raise InputError(name, f"must be a text of at most {most} characters")
            if HIDDEN.search(text):  # the page shows it and sends it back as it is
                rule = "must not hold control characters, marks that turn text around or halves of surrogate pairs"
                raise InputError(name, rule, printable(text))

    @property
    def slopes(self) -> tuple[float, float]:
        """Slopes of the plane: metres along the hole per metre towards toolface 0, and per metre towards 90."""
        slope, toolface = math.tan(math.radians(self.apparent_dip)), math.radians(self.toolface)
        return slope * math.cos(toolface), slope * math.sin(toolface)

    def ends(self, bit_diameter: float) -> tuple[float, float]:
        """Return the depths between which the pick's sinusoid or box lies, metres.

        If a plane has no radius, its sinusoid is computed with the radius of the bit, from ``bit_diameter``, metres.
        """
        radius = 0.5 * bit_diameter if self.radius is None else self.radius
        tall = 0.5 * self.height if self.kind == BREAKOUT else radius * math.tan(math.radians(self.apparent_dip))
        return self.depth - tall, self.depth + tall

    def reaches(self, top: float, bottom: float, bit_diameter: float) -> bool:
        """Return whether a part of the pick's sinusoid or box lies between ``top`` and ``bottom``, metres.

        ``bit_diameter`` is as in `ends`.
        """
        start, stop = self.ends(bit_diameter)
        return start <= bottom and stop >= top

    def dip(self, path: Path | None) -> tuple[float, float]:
        """Return true dip and dip azimuth of a plane, degrees.

        Both are NaN for a breakout or a note, without a path, beyond its ends, and where toolface 0 is undefined
        (`Path.frame`). The azimuth of a level plane is NaN.
        """
        if path is None or self.kind not in PLANES or not path.start_depth <= self.depth <= path.stop_depth:
            return math.nan, math.nan
        try:
            zero, right, along = path.frame(np.array([self.depth]))[0]
        except InputError:  # toolface 0 is undefined
            return math.nan, math.nan
        normal = along - self.slopes[0] * zero - self.slopes[1] * right
        north, east, down = normal if normal[2] <= 0 else -normal
        dip = math.degrees(math.atan2(math.hypot(north, east), -down))
        return dip, math.degrees(math.atan2(east, north)) % 360 if dip > 1e-3 else math.nan

    def dip_interval(self, path: Path | None) -> tuple[float, float]:
        """Return half the 95 % intervals of true dip and dip azimuth on a path, degrees.

        Without a true dip they are those of apparent dip and toolface. Both are NaN where it is
        not known how sure the pick is. An azimuth of which nothing is known has 180.
        """
        if self.dip_sigma is None or self.toolface_sigma is None:
            return math.nan, math.nan
        dip, azimuth = self.dip(path)
        if path is None or math.isnan(dip):
            return SURE * self.dip_sigma, min(180.0, SURE * self.toolface_sigma)
        slope, deepest = math.tan(math.radians(self.apparent_dip)), math.radians(self.toolface)
        steeper = math.radians(self.dip_sigma) * (1 + slope**2)
        aside = math.radians(self.toolface_sigma) * slope if self.toolface_sigma < 180.0 else steeper
        zero, right, along = path.frame(np.array([self.depth]))[0]
        towards = math.radians(0.0 if math.isnan(azimuth) else azimuth)

        def tilted(more: float, across: float) -> tuple[float, float, float]:
            """Return the normal of the plane if it were steeper or turned: towards its dip, across it, and up."""
            a = (slope + more) * math.cos(deepest) - across * math.sin(deepest)
            b = (slope + more) * math.sin(deepest) + across * math.cos(deepest)
            normal = along - a * zero - b * right
            north, east, down = (normal if normal[2] <= 0 else -normal) / np.linalg.norm(normal)
            c, s = math.cos(towards), math.sin(towards)
            return north * c + east * s, east * c - north * s, -down

        level, _, up = tilted(0.0, 0.0)
        squares = [0.0, 0.0]
        for more, across in ((steeper, 0.0), (0.0, aside)):
            ends = []
            for times in (-SURE, SURE):
                to, beside, high = tilted(times * more, times * across)
                side = (
                    -1 if to * level + high * up < 0 else 1
                )  # a normal turned past level is the other one of its plane
                ends.append((abs(math.atan2(side * to, side * high) - math.atan2(level, up)), abs(beside)))
            for at in (0, 1):
                squares[at] += max(end[at] for end in ends) ** 2
        dipped, turned = math.sqrt(squares[0]), math.sqrt(squares[1])
        likely = math.sqrt(max(0.0, level**2 - squares[1] / 2))  # errors make a dip look steeper
        known = turned < likely and dipped < FAR
        return min(90.0, math.degrees(dipped)), math.degrees(math.asin(turned / likely)) if known else 180.0

    def dip_sigmas(self, path: Path | None) -> tuple[float, float]:
        """Return the standard uncertainties of true dip and dip azimuth on a path, degrees; NaN where `dip` is."""
        dip = self.dip(path)[0]
        first, second = (half / SURE if math.isfinite(dip) else math.nan for half in self.dip_interval(path))
        return first, second

    def axis(self, path: Path | None) -> float:
        """Return the azimuth of a breakout's axis on a path, degrees in [0, 180); else NaN (`Path.azimuth`)."""
        return math.nan if path is None or self.kind != BREAKOUT else path.azimuth(self.depth, self.toolface) % 180


def plane(kind: str, depth: float, dip: float, azimuth: float, path: Path) -> Pick:
    """Return the pick of a plane that crosses the path at a depth with a true dip and a dip azimuth, degrees."""
    if not (math.isfinite(dip) and math.isfinite(azimuth)):
        raise InputError(f"plane at {depth:g} m", f"dip {dip:g} and azimuth {azimuth:g} must be finite")
    steep, towards = math.radians(dip), math.radians(azimuth)
    normal = np.array([math.sin(steep) * math.cos(towards), math.sin(steep) * math.sin(towards), -math.cos(steep)])
    zero, right, along = path.frame(np.array([depth]))[0] @ normal
    if abs(along) < 1e-6:
        raise InputError(f"plane at {depth:g} m", "is parallel to the hole")
    slopes = -zero / along, -right / along
    return Pick(
        kind=kind, depth=depth, apparent_dip=math.degrees(math.atan(math.hypot(*slopes))),
        toolface=math.degrees(math.atan2(slopes[1], slopes[0])) % 360,
    )  # fmt: skip


def can_save(filename: str | os.PathLike[str]) -> bool:
    """Return whether the folder of a file can be written: `Picks.save` makes a new file there, then renames it."""
    return os.access(FilePath(filename).parent, os.W_OK | os.X_OK)


class Picks(list[Pick]):
    """The picks of a wall: a list that is saved as a table; ``iterable`` gives the first ones."""

    def put(self, pick: Pick) -> None:
        """Add a pick, or replace the pick that has the same key."""
        for at, old in enumerate(self):
            if old.key == pick.key:
                self[at] = pick
                return
        if len(self) >= MOST:
            raise InputError(f"{len(self)} picks", f"no more can be added, because a wall has at most {MOST}")
        self.append(pick)

    def merge(self, others: Iterable[Pick]) -> tuple[list[Pick], list[Pick]]:
        """Add the picks of ``others``; return the picks added, and the picks that replaced a pick with the same key.

        A pick is left out if this list has a pick with the same key and the same values. It is also left out if this
        list does not have its key, but has a pick with the same values of the fields in `PLACE`.
        """
        places, index = {_cells(pick, PLACE) for pick in self}, {pick.key: at for at, pick in enumerate(self)}
        added, replaced = [], []
        for pick in others:
            at, place = index.get(pick.key), _cells(pick, PLACE)
            if at is None and place not in places:
                index[pick.key] = len(self)
                self.put(pick)
                added.append(pick)
            elif at is not None and _cells(pick) != _cells(self[at]):
                self[at] = pick
                replaced.append(pick)
            places.add(place)
        return added, replaced

    def remove_key(self, key: str) -> None:
        """Remove the pick with this key, if it is there."""
        self[:] = [pick for pick in self if pick.key != key]

    def table(self, path: Path | None = None) -> str:
        """Return the picks as CSV, sorted by depth; with a path, with true dips, sigmas and axes of breakouts."""
        text = io.StringIO()
        writer = csv.writer(text)
        writer.writerow([*COLUMNS, *DERIVED])
        for pick in sorted(self, key=lambda one: one.depth):
            derived = (*pick.dip(path), *pick.dip_sigmas(path), pick.axis(path))
            writer.writerow(
                [*map(cell, _cells(pick)), *("" if math.isnan(angle) else _cell(angle) for angle in derived)]
            )
        return text.getvalue()

    def save(self, filename: str | os.PathLike[str], path: Path | None = None) -> None:
        """Write `table`, with the true dips of a ``path``, to the file ``filename``, whole or not at all."""
        content = self.table(path).encode()
        write_whole(filename, lambda file: file.write(content))

    @classmethod
    def load(cls, filename: str | os.PathLike[str], path: Path | None = None) -> Picks:
        """Read the table ``filename`` as `save` writes it; unknown columns are ignored.

        If a table has no column ``APPARENT_DIP (deg)``, apparent dips are computed from its true dips and ``path``, the
        wall's. Names may also be written in small letters, with the unit after an underscore: ``depth_m``.
        Classes of other programs, such as ``closed fracture``, are read as those of `ALIASES`.
        A row without a key gets a key made from its text, the same at every reading. If two rows have the same key, the
        second row gets another key.
        """
        check_regular(FilePath(filename))
        try:
            return cls.parse(FilePath(filename).read_text("utf-8-sig"), path)
        except InputError as error:
            raise error.within(str(filename)) from error
        except UnicodeDecodeError as error:
            raise InputError(str(filename), "must be UTF-8 text") from error

    @classmethod
    def parse(cls, text: str, path: Path | None = None) -> Picks:
        """Return the picks of a table given as ``text``, as `load` does; ``path`` as there."""
        reader = csv.DictReader(io.StringIO(text, newline=""))
        names = [_column_of(name) for name in reader.fieldnames or []]
        reader.fieldnames = names
        apparent = APPARENT[1] in names or (path is None and not set(DIP) <= set(names))
        needed = ("class", "DEPT (m)", *(APPARENT if apparent else DIP))
        if missing := [name for name in needed if name not in names]:
            raise InputError("line 1", f"must have the columns {', '.join(missing)}")
        picks, keys = cls(), set[str]()
        try:
            for row in reader:
                pick = _parsed(row, path, apparent, f"line {reader.line_num}")
                picks.put(replace(pick, key=secrets.token_hex(6)) if pick.key in keys else pick)
                keys.add(picks[-1].key)
        except csv.Error as error:
            raise InputError(f"line {reader.line_num}", str(error)) from error
        return picks


def _plain(name: str) -> str:
    """Return how a column is compared: ``DEPT (m)`` and ``depth_m`` are one."""
    words = re.sub(r"[^a-z]+", "_", name.lower()).strip("_")
    return re.sub(r"^depth?(?=_)", "depth", words)


COLUMN_OF = {_plain(name): name for name in (*COLUMNS, *DIP)}


def _column_of(name: str) -> str:
    """Return the name in `COLUMNS` or `DIP` of a column of a table; an unknown name as it is."""
    return COLUMN_OF.get(_plain(name), name)


def _parsed(row: Mapping[str, Any], path: Path | None, apparent: bool, line: str) -> Pick:
    """Return the pick that a row of a table describes, from its apparent dip if ``apparent``, else its true dip."""

    def number(column: str) -> float:
        try:
            return float(row[column])
        except (TypeError, ValueError):
            raise InputError(f"{line}, {column}", "must be a number", repr(row[column])) from None

    texts: dict[str, Any] = {
        name: text_of(row[column]) for column, name in COLUMNS.items() if name in TEXTS and row.get(column)
    }
    if (other := texts.get("kind", "").lower()) in ALIASES:
        texts = {"note": texts["kind"], **texts, "kind": ALIASES[other]}
    texts.setdefault("key", hashlib.blake2s(repr(sorted(row.items(), key=str)).encode(), digest_size=6).hexdigest())
    numbers: dict[str, Any] = {
        name: number(column) for column, name in COLUMNS.items() if name not in TEXTS and row.get(column)
    }
    points = numbers.get("points", 0.0)
    numbers["points"] = int(points) if points.is_integer() else points
    true_dip = None if apparent or texts.get("kind") in (BREAKOUT, NOTE) else (number(DIP[0]), number(DIP[1]))
    try:
        if true_dip is not None:
            if path is None:
                rule = f"a true dip needs the path of the wall: give a survey, or {' and '.join(APPARENT)}"
                raise InputError(DIP[0], rule)
            found = plane(texts["kind"], numbers["depth"], *true_dip, path)
            numbers |= {"apparent_dip": found.apparent_dip, "toolface": found.toolface}
        return Pick(**texts, **numbers)
    except InputError as error:
        raise error.within(line) from error
    except (TypeError, KeyError) as error:
        raise InputError(line, "class, depth and toolface must not be empty") from error


def _cells(pick: Pick, names: Iterable[str] = COLUMNS.values()) -> tuple[str, ...]:
    return tuple(_cell(getattr(pick, name)) for name in names)


def _cell(value: Any) -> str:
    return f"{value:.10g}" if isinstance(value, float) else "" if value is None else str(value)


def pick_of(values: Any) -> Pick:
    """Return the pick that a page sends as a JSON object."""
    known = {each.name for each in fields(Pick)}
    if not isinstance(values, dict) or not values.keys() <= known:
        raise InputError("pick", f"must be an object with fields among {', '.join(sorted(known))}")
    try:
        return Pick(**values)
    except TypeError as error:
        raise InputError("pick", "must have class, depth and toolface") from error
