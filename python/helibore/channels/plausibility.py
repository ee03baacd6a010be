"""Check the values of a channel against its role; each error names the channel, the wrong number and the rule.

    median radius 0.216 m                          an 8.5 in bit: looks like a diameter
    toolface between 0 and 6.28, stated in deg     looks like radians
    median radius 108 m                            the unit looks like mm

If a map confirms a role, or if there are fewer than `FEW` values, the checks for likely mistakes are skipped (a radius
is still compared with the bit if its diameter is known). An impossible value is always an error.
"""

from __future__ import annotations

import numpy as np

from helibore.base import units
from helibore.base.arrays import Floats, distinct
from helibore.base.nulls import say_so
from helibore.channels.roles import Role
from helibore.files.raw_set import RawSet
from helibore.samples.bit_sizes import FEW, looks_like_diameter

RADIUS_RANGE = (0.02, 1.0)
"""Metres: no borehole has a median radius outside this range, so the unit is wrong."""

LIKELY_NULLS = (-999.0, -9999.0, -99999.0, -999999.0, -32768.0, -32767.0, 9999.0, 99999.0, 999999.0, 999.25, 9999.25)
"""Numbers that often mean no value in files that do not declare a null value."""

MANY = 1 << 16
"""If there are more values than this, the median is that of a part of the values, taken at even steps."""


def present(values: Floats) -> Floats:
    """Return the values that are not NaN, as an (n,) array; the result is a copy only if a value is NaN."""
    flat = values.reshape(-1)
    return flat[np.isfinite(flat)] if np.isnan(flat.min(initial=0.0)) else flat


def lengths(log_set: RawSet, role: Role, values: Floats, bit_diameter: float | None) -> None:
    """Check radii or diameters, in metres, for a wrong unit, and for a diameter in place of a radius or the reverse.

    The radii of travel times are checked too; for them, a wrong velocity or tool radius is the likely mistake.
    """
    found = present(values)
    if not found.size:
        raise log_set.input_error("every value is missing", column=role.channel)
    median = float(np.median(found if found.size <= MANY else found[:: found.size // MANY]))
    scale = 2.0 if role.role == "diameter" else 1.0
    low, high = (scale * bound for bound in RADIUS_RANGE)
    echo = f"median radius {median:.3g} m from its travel times" if role.role == "travel-time" else ""
    if echo and not low <= median <= high:
        how = f"check the unit {role.unit}, the velocity in the mud and the tool's radius"
        raise log_set.input_error(f"{echo}: no radius of a borehole; {how}", column=role.channel)
    if not low <= median <= high:
        raw = median / units.factor(role.unit, units.LENGTH)
        fits = [name for name in ("m", "cm", "mm", "in", "ft") if low <= raw * units.factor(name, units.LENGTH) <= high]
        likely = f" (would fit {' or '.join(fits)})" if fits else ""
        rule = f"median {median:.3g} m if the unit is {role.unit}: no {role.role} of a borehole{likely}"
        raise log_set.input_error(rule, column=role.channel)
    if role.role == "diameter":
        if bit_diameter is not None and not role.confirmed and abs(2.0 * median / bit_diameter - 1.0) < 0.25:
            rule = f"median {median:.3g}: looks like a radius, where a diameter is expected: the bit's diameter is"
            how = f'{bit_diameter:.3g} m; state role = "radius" in a map, or columns.radius={role.channel}'
            raise log_set.input_error(f"{rule} {how}", column=role.channel)
        return
    if bit_diameter is None and (role.confirmed or found.size < FEW):
        return
    if not looks_like_diameter(median, bit_diameter):
        return
    if echo:
        known = "" if bit_diameter is None else f" (the bit's diameter is {bit_diameter:.3g} m)"
        rule = f"{echo}: looks like a diameter{known}; check the velocity in the mud and the tool's radius"
    else:
        how = f', or give the bit diameter or confirm role = "{role.role}" there'
        if bit_diameter is not None:
            how = f", or columns.diameter={role.channel}: the bit's diameter is {bit_diameter:.3g} m"
        rule = (
            f'median {median:.3g}: looks like a diameter, where a radius is expected; state role = "diameter" in a map'
        )
        rule += how
    raise log_set.input_error(rule, column=role.channel)


def depths(log_set: RawSet, role: Role, values: Floats) -> None:
    """Check measured depths, in metres, for numbers that mean no value and for elevations.

    A depth of `LIKELY_NULLS` is refused if it is far from all other depths. Depths that are all negative are refused,
    because they would make a mirror image of the hole; but not if they are few, or if a map confirms their role.
    """
    found = present(values)
    raw = log_set.numbers(role.channel)
    for odd in (np.nanmin(raw), np.nanmax(raw)) if found.size else ():
        others = raw[np.isfinite(raw) & (raw != odd)]
        if odd not in LIKELY_NULLS or not others.size:
            continue
        low, high = others.min(), others.max()
        if not 2.0 * low - high - 100.0 <= odd <= 2.0 * high - low + 100.0:
            count = np.count_nonzero(raw == odd)
            rule = (
                f"{odd:g} {role.unit} in {count:,} rows, other depths lie between {low:g} and {high:g} {role.unit}: "
                f"a number that means no value? {say_so(f'{odd:g}')}"
            )
            raise log_set.input_error(rule, int(np.argmax(raw == odd)), role.channel)
    if found.size < FEW or role.confirmed or not float(found.max()) < 0.0:
        return
    rule = (
        f"{found.min():g} to {found.max():g} m: negative throughout (elevations?), and depth counts positive down the"
    )
    raise log_set.input_error(f'{rule} hole; change the signs, or confirm role = "depth" in a map', column=role.channel)


def angles(log_set: RawSet, role: Role, values: Floats) -> None:
    """Check that toolfaces, in degrees, are within two turns of 0 and do not look like radians read as degrees."""
    found = present(values)
    if not found.size:
        raise log_set.input_error("every value is missing", column=role.channel)
    low, high = float(found.min()), float(found.max())
    if low < -720.0 or high > 720.0:
        beyond = np.abs(values) > 720.0
        row = int(np.argmax(beyond))
        rule = f"{values[row]:g} deg: an angle lies within -720 and 720"
        if distinct(values[beyond]).size == 1:
            rule += f"; if the number means no value, {say_so(f'{values[row]:.10g}')}"
        raise log_set.input_error(rule, row, role.channel)
    within = -np.pi - 1e-3 <= low and high <= 2.0 * np.pi + 1e-3 and high - low > 3.0
    if within and not role.confirmed and found.size >= 4 * FEW:
        rule = f"values between {low:.3g} and {high:.3g} {role.unit}: looks like radians; state the unit in a map"
        raise log_set.input_error(f"{rule} or as {role.channel}:rad", column=role.channel)


def survey_angles(log_set: RawSet, inclined: Role, turned: Role, inclination: Floats, azimuth: Floats) -> None:
    """Check that inclinations and azimuths, in degrees, are in range and do not look like radians read as degrees."""
    for role, values, low, high in ((inclined, inclination, 0.0, 180.0), (turned, azimuth, -360.0, 360.0)):
        wrong = np.flatnonzero(np.isfinite(values) & ((values < low - 1e-6) | (values > high + 1e-6)))
        if wrong.size:
            row = int(wrong[0])
            rule = f"{values[row]:g} deg: {role.role} lies within {low:g} and {high:g}"
            raise log_set.input_error(rule, row, role.channel)
    both = np.isfinite(inclination) & np.isfinite(azimuth)
    if (inclined.confirmed and turned.confirmed) or np.count_nonzero(both) < FEW:
        return
    spread = float(np.ptp(azimuth[both]))
    steepest, largest = float(inclination[both].max()), float(np.abs(azimuth[both]).max())
    # A vertical hole has small inclinations, but its azimuths wander over the whole circle.
    if 0.0 < steepest <= np.pi and largest <= 2.0 * np.pi + 1e-3 and spread > 0.0:
        rule = f"no azimuth is beyond {largest:.3g} and no inclination beyond {steepest:.3g}: looks like radians"
        raise log_set.input_error(rule + "; state the units in a map", column=turned.channel)
