"""Convert units. Only this file knows them: all other code uses metres, degrees, seconds and rpm.

    value in metres = value as written x factor(unit)          8.5 in -> 8.5 x 0.0254 m = 0.2159 m

The table holds unit names as real files write them (``M``, ``FT``, ``INCHES``, ``0.1 in``, ``DEGA`` ...), in upper or
lower case. Other units are refused; nothing is guessed from the size of a number.
"""

from __future__ import annotations

import math
import re
from fractions import Fraction

from helibore.base.errors import InputError

LENGTH, ANGLE, TIME, ROTATION = "length", "angle", "time", "rotation"
INCH = 0.0254
"""In metres: bits and casings are sold in inches."""
FOOT = 0.3048
"""In metres."""
MILLIMETRE = 0.001
"""In metres."""
BARREL = 0.158987294928
"""Cubic metres in an oilfield barrel, 42 US gallons."""

_TABLE: dict[str, tuple[str, float, str]] = {
    "m": (LENGTH, 1.0, "metre metres meter meters м"),
    "cm": (LENGTH, 0.01, "centimetre centimetres centimeter centimeters см"),
    "mm": (LENGTH, MILLIMETRE, "millimetre millimetres millimeter millimeters мм"),
    "ft": (LENGTH, FOOT, "f foot feet '"),
    "ftUS": (LENGTH, 1200.0 / 3937.0, "ftus ft[us] usft us-ft usfoot"),
    "in": (LENGTH, INCH, 'inch inches ins "'),
    "0.1in": (LENGTH, 0.00254, ".1in 0.1inch 0.1inches 1/10in"),
    "deg": (ANGLE, 1.0, "dega degree degrees ° º dgr град"),
    "gon": (ANGLE, 0.9, ""),
    "rad": (ANGLE, 180.0 / math.pi, "rada radian radians"),
    "s": (TIME, 1.0, "sec secs second seconds"),
    "ms": (TIME, 0.001, "msec millisecond milliseconds"),
    "us": (TIME, 1e-6, "usec µs μs microsecond microseconds"),
    "min": (TIME, 60.0, "mins minute minutes"),
    "h": (TIME, 3600.0, "hr hrs hour hours"),
    "rpm": (ROTATION, 1.0, "rev/min c/min"),
    "c/s": (ROTATION, 60.0, "rev/s hz"),
    "rad/s": (ROTATION, 30.0 / math.pi, ""),
}
_NAMES = {name.lower(): unit for unit, (_, _, others) in _TABLE.items() for name in (unit, *others.split())}

_QUANTITY = re.compile(
    r"""\s*(?:(?P<plain>[-+]?\d+/[1-9]\d*)
        |(?P<number>[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)
         (?:[\s-]+(?P<fraction>\d+/[1-9]\d*))?)
        \s*(?P<unit>[^,]*?)\s*""",  # no unit has a comma: 1,5m
    re.VERBOSE | re.DOTALL,
)
_SUFFIXES = (
    re.compile(r"(?P<stem>.*\S)\s*\((?P<unit>[^()]+)\)\s*"),
    re.compile(r"(?P<stem>.*\S)\s*\[(?P<unit>[^\[\]]+)\]\s*"),
    re.compile(r"(?P<stem>.*[^_\s])_(?P<unit>\d[^_]*_[^_]+)"),  # tdep_0.1_in
    re.compile(r"(?P<stem>.*[^_\s])_(?P<unit>[^_]+)"),
)
_BLANKS = str.maketrans("", "", " _")


def canonical(unit: str) -> str:
    """Return the name that the table uses for ``unit``: ``canonical("INCHES") == "in"``.

    Raises an InputError if the table does not have the unit.
    """
    found = _NAMES.get(unit.lower().translate(_BLANKS))
    if found is None:
        raise InputError(f"unit '{unit}'", f"not known; known are {', '.join(_TABLE)}")
    return found


def factor(unit: str, kind: str) -> float:
    """Return the factor by which a value in ``unit`` becomes a value in metres, degrees, seconds or rpm.

    ``kind`` is what the unit must measure: length, angle, time or rotation. Raises an InputError if the table does not
    have the unit, or if the unit measures something else.
    """
    unit = canonical(unit)
    measures, value, _ = _TABLE[unit]
    if measures != kind:
        fitting = ", ".join(name for name, (other, _, _) in _TABLE.items() if other == kind)
        raise InputError(f"unit '{unit}'", f"measures {measures}, must be a unit of {kind}: {fitting}")
    return value


def measures(unit: str) -> str:
    """Return what a unit measures: length, angle, time or rotation; ``""`` for a unit that is not in the table."""
    known = _NAMES.get(unit.lower().translate(_BLANKS))
    return _TABLE[known][0] if known else ""


def table() -> dict[str, tuple[str, float]]:
    """Return for every spelling of a unit, in lower case and without blanks, what it measures and its factor."""
    return {name: _TABLE[unit][:2] for name, unit in _NAMES.items()}


def split(name: str, kind: str) -> tuple[str, str | None]:
    """Return a column's name without the unit at its end, and this unit: ``md_m`` gives ``("md", "m")``.

    ``Depth (ft)`` and ``CAL[in]`` are split in the same way. The unit is a guess, so a caller that uses it must report
    it. If the name does not end in a unit of this ``kind``, the result is the whole name and None.
    """
    for pattern in _SUFFIXES:
        match = pattern.fullmatch(name)
        unit = _NAMES.get(match["unit"].lower().translate(_BLANKS)) if match else None
        if match and unit is not None and _TABLE[unit][0] == kind:
            return match["stem"], unit
    return name, None


def quantity(text: str, kind: str) -> float:
    """Convert a text such as ``8.5in``, ``12 1/4 in`` or ``1/16in`` to metres, degrees or seconds.

    ``kind`` is what a unit must measure: length, angle or time. A number without a unit does not change.
    """
    match = _QUANTITY.fullmatch(text)
    if match is None:
        raise InputError(f"'{text}'", f"must be a number with a unit of {kind}, such as {_EXAMPLES[kind]}")
    number = float(Fraction(match["plain"]) if match["plain"] else match["number"])
    if match["fraction"]:
        number += math.copysign(float(Fraction(match["fraction"])), number)
    return number * factor(match["unit"], kind) if match["unit"] else number


def size_text(metres: float) -> str:
    """Write a diameter as drillers read it: ``8.500 in (215.9 mm)``."""
    return f"{metres / INCH:.3f} in ({metres / MILLIMETRE:.1f} mm)"


_EXAMPLES = {LENGTH: "8.5in, 0.216m or 216mm", ANGLE: "90deg or 1.57rad", TIME: "10s or 5min"}
