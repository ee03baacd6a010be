"""Join sector columns into one image: ABDC1M..ABDC16M, GRAS0M..7M, GRIM[1].., GRIM:1.., GRIM1.. -> (n, K).

    stem  number  suffix            joined if there are at least four columns, numbered one by one from 0 or 1, with
    ABDC    16      M               one unit, and measured by one tool around the hole

These series stay single columns, with a remark: a series with a gap, or whose numbers fall; the pads of a dip meter and
the probes of a production tool, by their names; and four to seven columns without stated angles whose unit is neither a
length nor one of gamma or density, because the pads of a dip meter look the same. A series that holds neither 0 nor 1
stays single columns without a remark.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from itertools import chain, count

import numpy as np

from helibore.base import units
from helibore.base.arrays import Array
from helibore.files.delimited import FEWEST_SECTORS
from helibore.files.raw_set import Channel, SectorAxis

NAMELESS = "column"
"""Start of the names given to nameless columns: ``column 1``, ``column 2`` ... These numbers do not count sectors."""

SURE = 8
"""At least this many numbered columns are an image even if their angles are not stated."""

IMAGE_UNITS = frozenset(["gapi", "api", "aapi", "g/cc", "g/cm3", "g/c3", "kg/m3", "k/m3", "cps", "b/e"])
"""Units, in lower case, of gamma and density images; dip meters measure neither."""

ANGLE_NAME = re.compile(r"(?P<angle>\d{1,3}(?:\.\d+)?) ?(?:deg|°)")
"""Name of a column that is the angle at which its sector starts, as WellCAD writes images."""

NOT_AROUND = re.compile(
    r"(p|pad|fc|dip|db|sb|button|elec(trode)?|probe|cat|rat|sat|cap|dfh|dfb|ghh|ghost|spin(ner)?|hold_?up)[\W_]*",
    re.IGNORECASE,
)
"""Stems of the pads and buttons of dip meters, and of the probes and spinners of production tools."""
NOT_AROUND_TEXT = re.compile(r"\b(dip ?meter|pad|probe|spinner|hold-?up|capacitance)\b", re.IGNORECASE)
NO_SECTORS_TEXT = re.compile(
    r"\b(bins?|t[12] (distribution|spectr\w+)|gates?|windows?|waveforms?|spectr(um|a|al)|receivers?|transmitters?)\b",
    re.IGNORECASE,
)
"""Words in the descriptions of series that count something else than sectors around the hole."""

# The last run of digits is the number of the sector: GRIM[12], GRIM_12, GRIM:12, GRIM(12), ABDC12M.
NUMBERED = re.compile(r"^(?P<stem>.*?\D)[\[_:(. -]?(?P<number>\d{1,4})[\])]?(?P<suffix>\D{0,8})$")


def join_sectors(channels: Sequence[Channel], index: str | None) -> tuple[list[Channel], list[str]]:
    """Return the channels with every series of sector columns joined, and remarks on series left as single columns.

    ``index`` is the name of the index channel, which is never a sector.
    """
    series: dict[tuple[str, str, str], list[tuple[int, Channel]]] = {}
    for channel in channels:
        match = NUMBERED.match(channel.name)
        if match and len(channel.shape) == 1 and channel.name != index and not channel.is_text:
            stem = match["stem"].rstrip("[_:(. -")
            series.setdefault((stem, match["suffix"], channel.unit), []).append((int(match["number"]), channel))
    images: dict[str, Channel] = {}
    inside: set[str] = set()
    remarks: list[str] = []
    taken = {channel.name for channel in channels}
    _join_angles(channels, images, remarks)
    inside.update(member.name for image in images.values() for member in image.members)
    for (stem, suffix, _), found in series.items():
        numbers = [number for number, _ in found]
        if len(found) < FEWEST_SECTORS or min(numbers) not in (0, 1) or stem == NAMELESS:
            continue
        if numbers != list(range(min(numbers), min(numbers) + len(numbers))):
            remarks.append(f"{stem}{numbers[0]}{suffix} ...: {_gap(numbers)}; left as single columns")
            continue
        members = [channel for _, channel in found]
        doubt = _doubt(stem, members)
        if doubt:
            remarks.append(f"{stem}{numbers[0]}{suffix} ...: {doubt}; left as single columns")
            continue
        marked = (f"{stem}{'#' * marks}{suffix}" for marks in count())
        name = next(each for each in chain([stem], marked) if each not in taken)
        taken.add(name)
        images[members[0].name] = _image(name, members)
        inside.update(member.name for member in members)
    joined = [
        images.get(channel.name, channel)
        for channel in channels
        if channel.name in images or channel.name not in inside
    ]
    return joined, remarks


def _join_angles(channels: Sequence[Channel], images: dict[str, Channel], remarks: list[str]) -> None:
    """Join the columns that are named by angles which part the turn evenly, 0.00 deg, 5.00 deg ..., into one image."""
    named = [(ANGLE_NAME.fullmatch(channel.name), channel) for channel in channels]
    at_angles = [
        (float(match["angle"]), channel)
        for match, channel in named
        if match and len(channel.shape) == 1 and not channel.is_text
    ]
    starts, members = [start for start, _ in at_angles], [channel for _, channel in at_angles]
    sectors, units_of = len(members), {member.unit for member in members}
    if sectors < FEWEST_SECTORS or len(units_of) > 1:
        return
    step = 360.0 / sectors
    if not np.allclose(np.diff(starts), step, rtol=0, atol=0.02) or starts[0] >= step:
        return
    image = _image("IMAGE", members)
    image.axis = SectorAxis(starts[0] + step / 2, step, "deg")
    images[members[0].name] = image
    remarks.append(
        f"IMAGE: {sectors} columns named by angles, {members[0].name} ...: a sector starts at its angle, so that the "
        f"centre of the first lies at {starts[0] + step / 2:g} deg"
    )


def _gap(numbers: list[int]) -> str:
    first, last = min(numbers), max(numbers)
    lacking = sorted(set(range(first, last + 1)) - set(numbers))
    if lacking:
        return f"number {lacking[0]} of {first}..{last} is not in the file"
    return "the numbers do not rise one by one"


def _doubt(stem: str, members: list[Channel]) -> str:
    """Return why numbered columns may not lie around the hole; "" if there is no doubt."""
    if units.measures(members[0].unit) == units.LENGTH or _axis(members) is not None:
        return ""
    if NOT_AROUND.fullmatch(stem) or NOT_AROUND_TEXT.search(members[0].description):
        return "named or described as the pads of a dip meter or the probes of a production tool"
    if NO_SECTORS_TEXT.search(members[0].description):
        return f'described as "{members[0].description}", not as sectors around the hole'
    known = members[0].unit.lower() in IMAGE_UNITS or stem.lower().startswith("gr")
    if len(members) < SURE and not known:
        unit = members[0].unit or "no unit"
        return f"{len(members)} columns of {unit} without stated angles may be the pads of a dip meter"
    return ""


def _image(name: str, members: list[Channel]) -> Channel:
    first = members[0]
    described = next((member.description for member in members if member.description), "")

    def stack() -> Array:
        return np.stack([member.values for member in members], axis=1)

    shape = (first.shape[0], len(members))
    return Channel(name, first.unit, described, stack, axis=_axis(members), shape=shape, members=members)


def _axis(members: list[Channel]) -> SectorAxis | None:
    """Return the members' angles as an axis, with step NaN if the angles are uneven; None if a member has no angle."""
    angles = [member.axis.first for member in members if member.axis is not None]
    units = {member.axis.unit for member in members if member.axis is not None}
    if len(angles) < len(members) or len(units) != 1:
        return None
    return SectorAxis.of_angles(angles, units.pop())
