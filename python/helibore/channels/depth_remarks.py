"""Describe the depths of a set in remarks: range in metres, direction, repeats, step and gaps."""

from __future__ import annotations

import numpy as np

from helibore.base import units
from helibore.channels.roles import RoleMap
from helibore.files.raw_set import RawSet


def depth_remarks(log_set: RawSet, roles: RoleMap) -> list[str]:
    """Return remarks on the depths: direction, repeats, median step, and gaps of more than three median steps.

    If the unit is not metres, there is also a remark on the range in metres. There are no remarks without a channel of
    depths.
    """
    role = roles.one("depth")
    if role is None or log_set[role.channel].is_text:
        return []
    depth = log_set.numbers(role.channel)
    steps = np.diff(depth[np.isfinite(depth)])
    if not steps.size:
        return []
    found = []
    metre = units.factor(role.unit, units.LENGTH) if units.measures(role.unit) == units.LENGTH else 1.0
    if metre != 1.0:
        found.append(f"{role.channel}: {metre * np.nanmin(depth):.2f} to {metre * np.nanmax(depth):.2f} m")
    rising, falling, level = (int(np.count_nonzero(mask)) for mask in (steps > 0, steps < 0, steps == 0))
    if rising and falling:
        found.append(f"{role.channel}: rises {rising:,} and falls {falling:,} times: several passes or unsorted rows")
    elif falling:
        found.append(f"{role.channel}: falls: logged upwards")
    if level:
        found.append(f"{role.channel}: {level:,} rows repeat the depth of the row before")
    sizes = np.abs(steps[steps != 0])
    if sizes.size:
        usual = float(np.median(sizes))
        gaps = sizes[sizes > 3.0 * usual]
        stated = f"{usual:.6g} x {role.unit}" if role.unit[:1].isdigit() else f"{usual:.6g} {role.unit}"
        found.append(f"{role.channel}: median step {stated}".rstrip())
        if gaps.size:
            found.append(f"{role.channel}: {gaps.size:,} gaps, the largest {gaps.max():.6g} {role.unit}".rstrip())
    return found
