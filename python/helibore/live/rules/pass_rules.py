"""Rules for the pass of a sample: the settings of ``[passes]``, and what the pass numbers of a source mean.

    [passes]                      the limits by which the string's motion decides the pass (depth.py)

    [source.mwd.items]
    pass_number = "0812"          the item with the number of the pass: 0710, 0812, 0912 or any other item

    [source.mwd.pass_numbers]     what its numbers mean; without this table 1 is drill and every larger number is rescan
    drill = [1]
    rescan = [2, 3]

If a source sends a number, the number decides the pass of its samples, and an event reports each sample for which the
string's motion means another pass (``pass_log.py``). After a null, a wrong number or a 0 that is not listed, the motion
decides.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import Annotated

import numpy as np

from helibore.base.arrays import Integers, Mask
from helibore.base.errors import InputError
from helibore.live.rules.checks import Derived, Table, within
from helibore.live.rules.file_names import RULE, can_be_file

PASSES = ("drill", "ream", "rescan", "trip", "unknown")
DRILL, REAM, RESCAN, TRIP, UNKNOWN = range(len(PASSES))
NO_NUMBER = -1
LARGEST = 32767
"""The largest pass number; WITS sends it in two bytes (type S)."""

TABLES = ("passes", "events", "survey")
"""Tables of the snapshot that belong to no layer and no image; a layer must not have such a name."""

NUMBERED = re.compile(r"pass (0|[1-9]\d{0,4})")


class PassRules(Table):
    """The table ``passes``: the limits by which the string's motion decides the pass.

    The bit is on bottom up to ``on_bottom`` m above the bottom, and the string turns from ``rotating`` rpm on. A depth
    is not interpolated between bit depths that are more than ``max_depth_gap`` s apart. Values of rotation and activity
    older than ``stale`` s are not used.
    """

    on_bottom: Annotated[float, within(0)] = 0.3
    rotating: Annotated[float, within(0)] = 5.0
    max_depth_gap: Annotated[float, within(0.001, 3600)] = 60.0
    stale: Annotated[float, within(0.001)] = 60.0


class PassNumbers(Table):
    """The table ``source.NAME.pass_numbers``: for each pass the numbers that mean it.

    If the table is empty, 1 means drill and a larger number means rescan.

    Attributes
    ----------
    listed
        For each number in the table, sorted, the index of its pass in PASSES.
    """

    drill: list[int] = []
    ream: list[int] = []
    rescan: list[int] = []
    trip: list[int] = []
    unknown: list[int] = []
    listed: Derived[dict[int, int]] = {}

    def model_post_init(self, _: object) -> None:
        listed: dict[int, int] = {}
        for name in PASSES:
            for number in getattr(self, name):
                if not 0 <= number <= LARGEST:
                    raise InputError(name, f"must be whole numbers from 0 to {LARGEST}", str(number))
                if number in listed:
                    raise InputError(name, f"is already listed under {PASSES[listed[number]]}", str(number))
                listed[number] = PASSES.index(name)
        self._derive(listed=dict(sorted(listed.items())))

    def kind(self, number: int) -> int | None:
        """Return the pass that ``number`` means; None if the string's motion decides.

        The motion decides for NO_NUMBER, and for 0 if it is not listed. Any other number that is not listed means
        UNKNOWN; but if no number at all is listed, 1 means DRILL and a larger number means RESCAN.
        """
        if number == NO_NUMBER:
            return None
        if not self.listed:
            return {0: None, 1: DRILL}.get(number, RESCAN)
        return self.listed.get(number, None if number == 0 else UNKNOWN)


@dataclass(frozen=True)
class Layer:
    """The samples that a wall takes: of the passes ``kinds`` (indices into PASSES), or with the pass ``numbers``."""

    kinds: tuple[int, ...]
    numbers: tuple[int, ...]

    def chosen(self, kind: Integers, number: Integers) -> Mask:
        """Return for each sample whether the layer takes it, given the samples' passes and pass numbers."""
        of_kind = np.zeros(len(PASSES), bool)
        of_kind[list(self.kinds)] = True
        return of_kind[kind] | np.isin(number, self.numbers) if self.numbers else of_kind[kind]


def layer_of(names: list[str]) -> Layer:
    """Return the layer that takes the passes ``names`` ("ream", "pass 2")."""
    found = [NUMBERED.fullmatch(name) for name in names]
    return Layer(
        tuple(PASSES.index(name) for name, match in zip(names, found, strict=True) if match is None),
        tuple(int(match[1]) for match in found if match is not None),
    )


def read_layers(layers: dict[str, list[str]]) -> dict[str, list[str]]:
    """Check the table ``layers`` and return it; the default layer ``main`` is added if the table has none."""
    for name, kinds in layers.items():
        if not can_be_file(name):
            raise InputError(name, f"its name {RULE}", repr(kinds))
        if name.casefold() in TABLES or name.casefold().startswith("image-"):
            rule = f"must differ from the tables of the snapshot: {', '.join(TABLES)}, image-*"
            raise InputError(name, rule, repr(kinds))
        for kind in kinds:
            if kind not in PASSES and not NUMBERED.fullmatch(kind):
                rule = f'must be one of {", ".join(PASSES)}, or "pass N" for the pass number N'
                raise InputError(name, rule, repr(kind))
    return {"main": ["drill", "rescan", "unknown"], **layers}
