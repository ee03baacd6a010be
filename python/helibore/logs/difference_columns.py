"""How much larger the hole is than it was, as columns of the logs: of a wall that was compared with earlier passes.

    row of the logs    the quads of the wall whose centres lie in it    mean, least and greatest difference of radius

The attribute ``difference`` of a wall holds the differences by quad; a mean hides a lobe, so the extremes stand beside.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from helibore.base.tables import LogColumn
from helibore.logs.log_columns import DIFFERENCE
from helibore.logs.turn_logs import Logs

MNEMONICS = ("DIFF_MEAN", "DIFF_MIN", "DIFF_MAX")


def difference_columns(logs: Logs, wall: Any) -> list[LogColumn]:
    """Return mean, least and greatest difference of radius in each row of ``logs``, metres; none without an attribute.

    Parameters
    ----------
    logs
        Of the wall, by turns or by steps.
    wall
        A `helibore.Wall`. Its attribute ``difference`` is NaN where one of the two walls has no radius; a row without
        any difference is NaN.
    """
    if DIFFERENCE not in wall.attributes:
        return []
    values = np.ravel(wall.attributes[DIFFERENCE])
    sectors, pitch = wall.settings.sectors, wall.settings.pitch
    depth = wall.start_depth + (np.arange(values.size) + 0.5 * (sectors + 1)) * pitch / sectors
    order = np.argsort(logs.depth)
    row = np.searchsorted(logs.depth[order] - 0.5 * logs.height, depth, side="right") - 1
    inside = (row >= 0) & np.isfinite(values)
    inside[inside] = depth[inside] < logs.depth[order][row[inside]] + 0.5 * logs.height
    row, values = order[row[inside]], values[inside]
    count = np.bincount(row, minlength=logs.depth.size)
    mean, least, greatest = (np.full(logs.depth.size, np.nan) for _ in MNEMONICS)
    np.divide(np.bincount(row, values, logs.depth.size), count, out=mean, where=count > 0)
    np.fmin.at(least, row, values)
    np.fmax.at(greatest, row, values)
    texts = ("Mean", "Least", "Greatest")
    what = "difference of radius from the earlier passes"
    return [
        LogColumn(mnemonic, "m", f"{text} {what}", found)
        for mnemonic, text, found in zip(MNEMONICS, texts, (mean, least, greatest), strict=True)
    ]
