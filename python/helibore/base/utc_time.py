"""Times in nanoseconds since 1970, and their texts in UTC."""

from __future__ import annotations

import datetime

SECOND = 1_000_000_000
"""Nanoseconds."""


def utc(nanoseconds: int) -> str:
    """Return a time since 1970 as text, to the millisecond: ``2023-11-14T22:13:20.000Z``."""
    seconds, rest = divmod(nanoseconds // 1_000_000, 1000)
    return f"{datetime.datetime.fromtimestamp(seconds, datetime.UTC):%Y-%m-%dT%H:%M:%S}.{rest:03d}Z"
