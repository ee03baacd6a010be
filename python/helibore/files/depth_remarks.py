"""What stands out in the depths of a set: direction, repeats, gaps, as sentences. Nothing is changed or refused."""

from __future__ import annotations

import numpy as np

from helibore.roles import RoleMap

from .channel import LogSet


def depth_remarks(one: LogSet, roles: RoleMap) -> list[str]:
    """Direction, repeats and gaps of the depth channel, as sentences; a gap is over three times the median step."""
    role = roles.one("depth")
    if role is None or one[role.channel].is_text:
        return []
    depth = one.numbers(role.channel)
    steps = np.diff(depth[np.isfinite(depth)])
    if not steps.size:
        return []
    found = []
    rising, falling, level = (int(np.count_nonzero(mask)) for mask in (steps > 0, steps < 0, steps == 0))
    if rising and falling:
        found.append(f"{role.channel}: rises {rising:,} and falls {falling:,} times: passes, or samples in no order")
    elif falling:
        found.append(f"{role.channel}: falls: logged upwards")
    if level:
        found.append(f"{role.channel}: {level:,} rows repeat the depth before")
    sizes = np.abs(steps[steps != 0])
    if sizes.size:
        usual = float(np.median(sizes))
        gaps = sizes[sizes > 3.0 * usual]
        found.append(f"{role.channel}: median step {usual:.6g} {role.unit}".rstrip())
        if gaps.size:
            found.append(f"{role.channel}: {gaps.size:,} gaps, the largest {gaps.max():.6g} {role.unit}".rstrip())
    return found
