"""The angular gap of each vertex: the angle around the hole between the nearest samples on its two sides.

              x  sample clockwise           gap = clockwise angle + counter-clockwise angle, degrees,
    vertex  o                                     to the nearest samples within ``reach`` metres of its depth;
              x  sample counter-clockwise         0 at a sample's toolface, 360 where there are none, or one elsewhere

A small gap means that the tool measured this part of the turn. Between few arms the gap is large: the wall there is
interpolated, even if samples of the arms are near.
"""

from __future__ import annotations

from helibore import _core
from helibore.base.arrays import Floats
from helibore.base.threads import thread_count
from helibore.samples.helix import Helix


def angular_gap(helix: Helix, count: int, depth: Floats, toolface: Floats, reach: float) -> Floats:
    """Return the gap at vertices 0 to ``count`` of a helix, (count,) degrees.

    Parameters
    ----------
    helix, count
        The positions of the vertices, and their number.
    depth, toolface
        Depth and toolface of the samples, metres and degrees, in order of rising depth.
    reach
        Metres of depth, above and below a vertex, whose samples count; both ends included.
    """
    return _core.angular_gaps(helix, count, depth, toolface, reach, thread_count(None))
