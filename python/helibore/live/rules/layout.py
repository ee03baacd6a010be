"""The layout of a live image's sectors around the hole, in the terms of `helibore.SectorImage`.

    image.GR = { first = "5110", count = 8, unit = "gAPI", origin = "edge", reference = "high-side" }

``toolface_offset`` of the table is ``SectorImage.offset``. The table also has a setting ``offset``, which is another
quantity: the distance of the sensor from the bit in metres, as for the caliper.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Any, Literal

from helibore.base.arrays import Floats
from helibore.base.errors import InputError
from helibore.images.sector_image import Direction, Origin, SectorImage
from helibore.settings.declared import DEGREES, Declared, within
from helibore.trajectory.references import Reference

PathReference = Literal["high-side", "north"]
"""The direction of toolface 0. Parallel transport is not allowed: with it, toolface 0 depends on the first station."""


@dataclass(frozen=True)
class Layout:
    """Origin, reference, direction and offset (degrees) of a `SectorImage`."""

    origin: Origin
    reference: Reference
    direction: Direction
    offset: float

    def image(self, name: str, unit: str, rows: tuple[Floats, Floats], reach: float | None) -> SectorImage:
        """Return ``rows`` (depths and values) as an image; ``reach`` is as in `SectorImage`."""
        return SectorImage(
            *rows, name, unit, origin=self.origin, reference=self.reference, direction=self.direction,
            offset=self.offset, reach=reach,
        )  # fmt: skip


@dataclass(frozen=True, kw_only=True)
class LayoutTable(Declared):
    """How the sectors of an image lie around the hole."""

    origin: Annotated[Origin, "Part of sector 1 that lies at ``toolface_offset``; tools differ."]
    reference: Annotated[PathReference, "Direction of toolface 0. It must be that of the path."]
    direction: Annotated[Direction, "Order of the sectors, looking downhole."] = "clockwise"
    toolface_offset: Annotated[float, DEGREES, within(-360, 360, "degrees"), "Toolface of sector 1."] = 0.0

    def layout(self, path_reference: str) -> Layout:
        """Return the layout; raise InputError if its reference is not that of the path."""
        if self.reference != path_reference:
            rule = f'must be the path\'s reference, "{path_reference}": live images are not converted to it'
            raise InputError("reference", rule, repr(self.reference))
        return Layout(self.origin, self.reference, self.direction, self.toolface_offset)


def given_layout(
    origin: str | None, reference: str | None, direction: str, toolface_offset: float, path_reference: str
) -> Layout | None:
    """Return the layout that a host gives with an image; None if the host gives neither origin nor reference.

    Raises
    ------
    InputError
        If only one of origin and reference is given, or a setting breaks a rule of `LayoutTable`.
    """
    if origin is None and reference is None:
        return None
    given: dict[str, Any] = {
        "origin": origin, "reference": reference, "direction": direction, "toolface_offset": toolface_offset,
    }  # fmt: skip
    return LayoutTable(**given).layout(path_reference)
