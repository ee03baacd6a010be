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
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Annotated

import numpy as np

from helibore.base.arrays import Integers, Mask
from helibore.base.cached import cached_property
from helibore.base.errors import InputError
from helibore.live.rules.file_names import RULE, can_be_file
from helibore.settings.declared import FINITE, METRES, NOT_NEGATIVE, SECONDS, Declared, Rule, at_least, within

PASSES = ("drill", "ream", "rescan", "trip", "unknown")
DRILL, REAM, RESCAN, TRIP, UNKNOWN = range(len(PASSES))
NO_NUMBER = -1
LARGEST = 32767
"""The largest pass number; WITS sends it in two bytes (type S)."""

TABLES = ("passes", "events", "survey")
"""Tables of the snapshot that belong to no layer and no image; a layer must not have such a name."""

NUMBERS = Rule(f"must be whole numbers from 0 to {LARGEST}", lambda many: all(0 <= one <= LARGEST for one in many))
NUMBERED = re.compile(r"pass (0|[1-9]\d{0,4})")


@dataclass(frozen=True, kw_only=True)
class PassRules(Declared):
    """Limits by which the string's motion decides the pass, ``[passes]``."""

    on_bottom: Annotated[float, METRES, NOT_NEGATIVE,
        "The bit is on bottom up to this height above the bottom of the hole.",
    ] = 0.3  # fmt: skip
    rotating: Annotated[float, NOT_NEGATIVE, "The string turns from this many revolutions a minute on."] = 5.0
    max_depth_gap: Annotated[float, SECONDS, within(0.001, 3600, "s"),
        "Longest time between the two bit depths from which a depth is interpolated.",
    ] = 60.0  # fmt: skip
    stale: Annotated[float, SECONDS, FINITE, at_least(0.001, "s"),
        "Values of rotation and activity that are older are not used.",
    ] = 60.0  # fmt: skip


@dataclass(frozen=True, kw_only=True)
class PassNumbers(Declared):
    """What the pass numbers of a source mean, ``[source.NAME.pass_numbers]``; without any, 1 is drill, more is rescan.

    A number stands in one list at most.
    """

    drill: Annotated[tuple[int, ...], NUMBERS, "Numbers that mean drilling."] = ()
    ream: Annotated[tuple[int, ...], NUMBERS, "Numbers that mean reaming."] = ()
    rescan: Annotated[tuple[int, ...], NUMBERS, "Numbers that mean a scan of hole that was scanned before."] = ()
    trip: Annotated[tuple[int, ...], NUMBERS, "Numbers that mean a trip."] = ()
    unknown: Annotated[tuple[int, ...], NUMBERS, "Numbers whose pass is not known."] = ()

    def _check(self) -> None:
        earlier: dict[int, str] = {}
        for name in PASSES:
            for number in getattr(self, name):
                if number in earlier:
                    raise InputError(name, f"is already listed under {earlier[number]}", str(number))
                earlier[number] = name

    @cached_property
    def listed(self) -> dict[int, int]:
        """For each number in the table, sorted, the index of its pass in PASSES."""
        return dict(sorted((number, at) for at, name in enumerate(PASSES) for number in getattr(self, name)))

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


def layer_of(names: Sequence[str]) -> Layer:
    """Return the layer that takes the passes ``names`` ("ream", "pass 2")."""
    found = [NUMBERED.fullmatch(name) for name in names]
    return Layer(
        tuple(PASSES.index(name) for name, match in zip(names, found, strict=True) if match is None),
        tuple(int(match[1]) for match in found if match is not None),
    )


def check_layers(layers: Mapping[str, Sequence[str]]) -> None:
    """Raise InputError if a name or a pass of the table ``layers`` breaks a rule."""
    for name, kinds in layers.items():
        if not can_be_file(name):
            raise InputError(f"layers.{name}", f"its name {RULE}", repr(list(kinds)))
        if name.casefold() in TABLES or name.casefold().startswith("image-"):
            rule = f"must differ from the tables of the snapshot: {', '.join(TABLES)}, image-*"
            raise InputError(f"layers.{name}", rule, repr(list(kinds)))
        for kind in kinds:
            if kind not in PASSES and not NUMBERED.fullmatch(kind):
                rule = f'must be one of {", ".join(PASSES)}, or "pass N" for the pass number N'
                raise InputError(f"layers.{name}", rule, repr(kind))
