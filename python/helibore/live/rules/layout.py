"""The layout of a live image's sectors around the hole, in the terms of `helibore.SectorImage`.

    image.GR = { first = "5110", count = 8, unit = "gAPI", origin = "edge", reference = "high-side" }

``toolface_offset`` of the table is ``SectorImage.offset``. The table also has a setting ``offset``, which is another
quantity: the distance of the sensor from the bit in metres, as for the caliper.
"""

from __future__ import annotations

from dataclasses import dataclass
from types import SimpleNamespace
from typing import Annotated, Any, Literal

from pydantic import Field

from helibore.base.arrays import Floats
from helibore.base.errors import InputError
from helibore.images.sector_image import Direction, Origin, SectorImage
from helibore.live.rules.checks import Derived, Table, check, within, without_none
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


class LayoutTable(Table):
    """The settings of an image's table that define the layout of its sectors."""

    origin: Origin = Field(description='"centre" or "edge": the part of sector 1 at toolface_offset; tools differ')
    reference: PathReference = Field(description='"high-side" or "north": the direction of toolface 0')
    direction: Direction = "clockwise"
    toolface_offset: Annotated[float, within(-360, 360)] = 0.0
    layout: Derived[Layout] = Layout("edge", "high-side", "clockwise", 0.0)

    def model_post_init(self, context: Any) -> None:
        if self.reference != context.reference:
            rule = f'must be the path\'s reference, "{context.reference}": live images are not converted to it'
            raise InputError("reference", rule, repr(self.reference))
        self._derive(layout=Layout(self.origin, self.reference, self.direction, self.toolface_offset))


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
    entries = without_none(
        origin=origin, reference=reference, direction=direction, toolface_offset=float(toolface_offset)
    )
    return check(LayoutTable, entries, context=SimpleNamespace(reference=path_reference)).layout
