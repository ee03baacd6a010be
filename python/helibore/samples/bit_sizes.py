"""The usual bit sizes, by which helibore recognises diameters that were given as radii.

For example, a median radius of 0.216 m is the diameter of an 8.5 in bit, so it looks like a diameter.
"""

from __future__ import annotations

from helibore.base.units import INCH

# Common bit diameters, inches. A radius near one of SMALL_BITS is probably a diameter, unless twice the radius is near
# one of LARGE_BITS, which is then the size of the hole.
SMALL_BITS = (7.875, 8.375, 8.5, 8.75, 9.5, 9.875, 10.625, 12.25)
LARGE_BITS = (16.0, 17.5)

FEW = 5
"""Fewer values than this are not checked for likely mistakes."""


def looks_like_diameter(median: float, bit_diameter: float | None = None) -> bool:
    """Return whether a median radius, metres, is near the diameter of the bit or, if that is None, of a usual bit.

    Near means within 25 % of the bit, and from 0.5 % below to 3 % above a usual bit.
    """
    if bit_diameter is not None:
        return abs(median / bit_diameter - 1.0) < 0.25
    inches = median / INCH

    def near(value: float, sizes: tuple[float, ...]) -> bool:
        return any(-0.005 <= value / size - 1.0 <= 0.03 for size in sizes)

    return near(inches, SMALL_BITS) and not near(2.0 * inches, LARGE_BITS)
