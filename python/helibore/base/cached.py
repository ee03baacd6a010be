"""Properties that are computed when they are first read."""

from __future__ import annotations

import functools
import sys
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING or sys.version_info >= (3, 12):
    from functools import cached_property
else:

    class cached_property(functools.cached_property):  # noqa: N801
        """That of Python 3.11 without its lock: all objects of a class share it, also with a process that is forked."""

        def __get__(self, of: Any, owner: type | None = None) -> Any:
            if of is None:
                return self
            kept = vars(of)
            if self.attrname not in kept:
                kept.setdefault(self.attrname, self.func(of))
            return kept[self.attrname]


__all__ = ["cached_property"]
