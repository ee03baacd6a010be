"""Bring angles into one turn: [0, 360) degrees, or [0, 180) for axes, where a and a + 180 are the same.

    -10 -> 350      360 -> 0      -1e-20 -> 0: its remainder is 360 - 1e-20, which rounds to 360

This file does not wrap differences of angles; the core wraps them to [-180, 180).
"""

from __future__ import annotations

import numpy as np

from helibore.base.arrays import Floats


def azimuth_text(degrees: float) -> str:
    """Return a direction in whole degrees with three digits, as strikes and dip azimuths are written: 035."""
    return f"{round(degrees) % 360:03d}"


def wrapped(angle: Floats, period: float = 360.0) -> Floats:
    """Return angles in [0, ``period``), degrees; NaN stays NaN. If no angle must change, return ``angle`` itself."""
    if angle.size and angle.min() >= 0.0 and angle.max() < period:
        return angle
    turned = angle % period
    return np.where(turned == period, 0.0, turned)
