"""The one layout of rows in the model: a frame, a sample, a row of an image, from the reader until it is drawn.

    record of the journal -> frames -> samples and image rows -> depth, pass -> drawn

A reader makes a row for each frame, and copies it for each sample or image row of the frame.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from helibore.base.arrays import Integers, Rows
from helibore.base.utc_time import SECOND
from helibore.live.rules.pass_rules import NO_NUMBER

ROW = np.dtype(
    [("time", "i8"), ("order", "i8"), ("received", "i8"), ("depth", "f8"), ("offset", "f8"), ("toolface", "f8"),
     ("radius", "f8"), ("flags", "i8"), ("image", "i8"), ("row", "i8"), ("wall", "i8"),
     ("source", "i4"), ("number", "i4"), ("connection", "i4"), ("line", "i8")]
)  # fmt: skip
"""A row.

time, order         when it was measured, ns of the model's clock; its place in the journal, -1 if it has a latency
received            the place in the journal of what brought it
depth, offset       metres; the depth is NaN if it follows from the bit depth, less the offset
toolface, radius    degrees, metres
flags               see `Flag`
image, row          of an image row the image and its own number; of a sample -1 and its place in the caliper's lists
wall                receive time, ns since 1970
source, number      numbers of the source (0: the host, or an image) and of the pass (NO_NUMBER: none)
connection, line    where it stands in the stream of its source; the line counts from 1
"""


def frame_rows(time: npt.ArrayLike, order: Integers, wall: npt.ArrayLike, line: npt.ArrayLike, connection: int) -> Rows:
    """Return a row for each frame; arguments are the columns of this name."""
    rows = np.zeros(len(order), ROW)
    rows["time"], rows["order"], rows["received"], rows["wall"], rows["line"] = time, order, order, wall, line
    rows["connection"], rows["image"], rows["number"] = connection, -1, NO_NUMBER
    return rows


def measured(frames: Rows, latency: float, offset: float) -> Rows:
    """Return a copy of rows of frames, at the time at which a sensor measured what the frames bring.

    ``latency`` is in seconds, ``offset``, from bit to sensor, in metres.
    """
    rows = frames.copy()
    rows["time"] -= int(latency * SECOND)
    if latency:
        rows["order"] = -1
    rows["offset"] = offset
    return rows
