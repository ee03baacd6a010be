"""Make the command that shows the images of a file without a caliper; errors and `helibore inspect` print it."""

from __future__ import annotations

import shlex
from collections.abc import Sequence
from pathlib import Path

from helibore.base import units
from helibore.channels.channel_readings import bit_of_channel
from helibore.channels.header_entries import log_header
from helibore.channels.log_set import LogFile
from helibore.channels.roles import WALL, RoleMap

USUAL_BIT = 8.5 * units.INCH
LARGEST_BIT = 4.0


def without_caliper(
    file: Path, log: LogFile, roles: RoleMap, verb: str = "view", bit: float | None = None, more: Sequence[str] = ()
) -> tuple[str, str]:
    """Return a text on what a file with images and no caliper lacks, and the command that shows the images.

    Return two empty texts if the file has a caliper, has no images, or has several sets, which ``--image`` cannot read.
    ``more`` are words to add to the command.
    """
    if len(log.sets) != 1 or roles.all(*WALL):
        return "", ""
    images = [role.channel for role in roles.all("image") if len(log.set()[role.channel].shape) == 2]
    if not images:
        return "", ""
    means = [role.channel for role in roles.all("mean-diameter")]
    stated = bit or _stated_bit(log, roles)
    source = ["--average", f"{file}:{means[0]}"] if means else ["--gauge"]
    words = ["helibore", verb, *source]
    for name in images:
        words += ["--image", f"{file}:{name}:edge"]
    words += ["--bit-diameter", f"{(stated or USUAL_BIT) / units.INCH:.6g}in", *more]
    hole = f"a round hole as large as {means[0]}" if means else "a gauge hole"
    sectors = log.set()[images[0]].shape[1]
    lacks = (
        f"has images ({', '.join(images)}) and no known caliper around the hole (--column radius=NAME or "
        f"diameter=NAME states one). "
        f"This command puts the images on {hole}. With edge, sector 1 starts at toolface 0; with centre, it is centred "
        f"there. Only the tool's manual says which is right; the other word turns {images[0]} by {180 / sectors:g} deg"
    )
    return lacks + ("" if stated else ". No bit size is stated: replace 8.5in with yours"), shlex.join(words)


def _stated_bit(log: LogFile, roles: RoleMap) -> float | None:
    """Return the bit size, in metres, that a channel or else the header states; None if no possible size is stated."""
    only = log.set()
    try:
        header = log_header([only.header]).get("bit", "")
        size = bit_of_channel(only, roles) or units.quantity(header, units.LENGTH)
    except ValueError:
        return None
    return size if 0 < size <= LARGEST_BIT else None
