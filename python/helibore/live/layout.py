"""How the sectors of a live image lie around the hole: the words of `helibore.SectorImage`, taken from a configuration.

    image.GR = { first = "5110", count = 8, unit = "gAPI", origin = "edge", reference = "high-side" }

``toolface_offset`` here is ``SectorImage.offset``: beside it ``offset`` is metres from the bit, as for the caliper.
Where rows come from, and at what depth, is not here (``mapping.py``, ``depth.py``).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import cast, get_args

import numpy as np
import numpy.typing as npt

from helibore.images.sector_image import Direction, Origin, Reference, SectorImage
from helibore.live.tables import Table

REFERENCES = ("high-side", "north")
"""What toolface 0 is, on a path that grows with its survey; a carried reference depends on how far it was carried."""


@dataclass(frozen=True)
class Layout:
    """Origin, reference, direction and offset (degrees) of a `SectorImage`."""

    origin: Origin
    reference: Reference
    direction: Direction
    offset: float

    def image(
        self, name: str, unit: str, rows: tuple[npt.NDArray[np.float64], npt.NDArray[np.float64]], reach: float | None
    ) -> SectorImage:
        """Return ``rows``, their depths and values, as an image."""
        return SectorImage(
            *rows, name, unit, origin=self.origin, reference=self.reference, direction=self.direction,
            offset=self.offset, reach=reach,
        )  # fmt: skip


def given_layout(
    origin: str | None, reference: str | None, direction: str, toolface_offset: float, of_path: str
) -> Layout | None:
    """Return the layout a host gives with an image; None where it gives neither origin nor reference."""
    if origin is None and reference is None:
        return None
    table = Table("", {"origin": origin, "reference": reference, "direction": direction,
                       "toolface_offset": toolface_offset})  # fmt: skip
    return read_layout(table, cast("Reference", of_path))


def read_layout(table: Table, reference: Reference) -> Layout:
    """Take the layout out of the table of an image; ``reference`` is what the wall's toolfaces count from."""
    origin = table.choice("origin", get_args(Origin), why=": what of sector 1 lies at toolface_offset; tools differ")
    given = table.choice("reference", REFERENCES, why=": what toolface 0 is")
    if given != reference:
        rule = f'must be the path\'s reference, "{reference}": an image is not turned on its way to the wall'
        raise table.fail("reference", given, rule)
    return Layout(
        origin=cast("Origin", origin),
        reference=reference,
        direction=cast("Direction", table.choice("direction", get_args(Direction), "clockwise")),
        offset=table.number("toolface_offset", 0.0, least=-360, most=360),
    )
