"""The mean of an image around the hole, as a column of the logs: a gamma image becomes a gamma curve.

image rows   |----a----|----b----|          |----c----|   an image row covers the depths of `SectorImage.cover`
log rows         |-------|-------|-------|-------|
mean of            a, b      b    missing    c            a and b are weighted by the length that each covers
"""

from __future__ import annotations

import re
from collections.abc import Mapping

import numpy as np

from helibore.base.arrays import Floats
from helibore.base.tables import LogColumn
from helibore.images.sector_image import SectorImage
from helibore.logs.difference_columns import MNEMONICS
from helibore.logs.log_columns import COLUMNS
from helibore.logs.turn_logs import ALONG, Logs

OWN = {of.mnemonic for of in COLUMNS} | {"VOL_SIGMA", "IHV", "CLASS", *ALONG, *MNEMONICS}
NUMBERED = ("ARM_DIAMETER_", "AVOL_", "ASUM_", "CLEAR_")


def image_means(logs: Logs, images: Mapping[str, SectorImage]) -> list[LogColumn]:
    """Return a column for each image: the mean of its values over each row of `logs`.

    The mnemonic is the name of the image in capital letters, with ``_`` for each character that a mnemonic cannot have.
    If it does not begin with a letter, or is the name of a log, ``IMAGE_`` is put before it. If another image has the
    same mnemonic, ``_`` is added. Each character of a unit that is not ASCII is replaced by ``?``.
    """
    found: dict[str, LogColumn] = {}
    for name, image in images.items():
        mnemonic = re.sub(r"[^A-Z0-9_]", "_", name.upper())
        if not mnemonic[:1].isalpha() or mnemonic in OWN or mnemonic.startswith(NUMBERED):
            mnemonic = f"IMAGE_{mnemonic}"
        while mnemonic in found:
            mnemonic += "_"
        unit = image.unit.encode("ascii", "replace").decode()
        text = "Mean of the image around the hole"
        found[mnemonic] = LogColumn(mnemonic, unit, text, _means(logs.depth, logs.height, image))
    return list(found.values())


def _means(depth: Floats, height: float, image: SectorImage) -> Floats:
    """Return the mean of the image over each row of the logs; NaN if no image row with a value covers a part of it."""
    there = np.isfinite(image.values)
    count = there.sum(axis=1)
    rows = count > 0
    mean = np.where(there, image.values, 0.0).sum(axis=1)[rows] / count[rows]
    edges = np.column_stack([end[rows] for end in image.cover()])
    # The length covered above each edge of an image row: 0, a, a, a + b, a + b, ...; and the integral of the means
    # over this length.
    covered = np.cumsum(np.diff(edges, axis=1, prepend=edges[:, :1]), axis=None)
    summed = np.cumsum(np.diff(edges, axis=1, prepend=edges[:, :1]) * mean[:, None], axis=None)
    top, bottom = depth - height / 2, depth + height / 2
    length, total = (
        np.interp(bottom, edges.ravel(), values) - np.interp(top, edges.ravel(), values) for values in (covered, summed)
    )
    means: Floats = np.full(depth.shape, np.nan)
    np.divide(total, length, out=means, where=length > 1e-6 * height)
    return means
