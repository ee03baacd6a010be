"""Fits of live walls whose estimator is 'automatic': when one is due, and what the journal records of it.

    samples --> 2 m of hole have some --> due --> `LayerFits.fit` --> record FITTED --> drawn again

A wall begins with inverse distance. It is fitted to the samples up to the one with which each of `LENGTHS` is reached.
At any time it is the wall of the settings recorded last, so one batch of all its samples with these settings has the
same bits, and a replay computes no fit.
"""

from __future__ import annotations

import json
from dataclasses import fields
from typing import Any

import numpy as np

from helibore.base.arrays import Floats, Integers
from helibore.base.errors import InputError
from helibore.samples.caliper import Basis, Caliper
from helibore.settings.wall_settings import Settings
from helibore.wall.append_result import Change
from helibore.wall.automatic import LABELS, choose
from helibore.wall.wall import Wall

LENGTHS = (2.0, 5.0, 10.0, 20.0, 40.0)
"""Metres of hole with samples at which a wall is fitted. In three trials a fit of 5 to 10 m gave 0.96 to 1.03 of the
error of a fit of the whole hole. One of 2 m gave up to 1.92, but down to 5 m 0.1 to 1.04 of that of inverse distance in
24 holes, and it leaves out spikes. To draw 40 m again takes up to a second, 400 m ten."""
PART = 0.5
"""Metres of hole that count as soon as one sample lies in them: a gap does not count, nor does a jump of the depth. A
length is reached when more than so many metres count."""
Due = tuple[float, tuple[Floats, ...]]
"""The length that was reached, and the columns of the samples up to then."""


class LayerFits:
    """The fits of one layer.

    Attributes
    ----------
    found
        The settings that the last fit found, as far as they differ from the configuration's; {} before the first one.
    due
        The fit that is due; None if none is.
    """

    STATE = ("found", "due", "_parts")

    def __init__(self, configured: Settings, before: LayerFits | None = None) -> None:
        self._configured = configured
        self.found: dict[str, Any] = dict(before.found) if before else {}
        self.due: Due | None = None
        self._parts: set[int] = set()

    @property
    def settings(self) -> Settings:
        """The settings of the wall at present."""
        return self._with(self.found)

    def _with(self, found: dict[str, Any]) -> Settings:
        return Settings(**(vars(self._configured) | {"estimator": "inverse-distance"} | found))

    def reached(self, depth: Floats) -> tuple[float, int]:
        """Return the last of `LENGTHS` that these samples reach, and the number of samples with which they reach it.

        (0, 0) if they reach none.
        """
        parts, first = np.unique(_parts_of(depth), return_index=True)
        first = np.sort(first[~np.isin(parts, list(self._parts))])
        before = len(self._parts)
        for length in reversed(LENGTHS):
            if before < (needed := round(length / PART) + 1) <= before + first.size:
                return length, int(first[needed - before - 1]) + 1
        return 0.0, 0

    def count(self, depth: Floats) -> None:
        """Count the hole in which these samples lie, until the last of `LENGTHS` is reached."""
        if len(self._parts) * PART <= LENGTHS[-1]:
            self._parts |= set(_parts_of(depth).tolist())

    def fit(self, layer: str, due: Due, basis: Basis) -> bytes:
        """Fit the samples of a fit that is due, which takes a second or two; return the payload of its record."""
        length, columns = due
        try:
            choice = choose(Caliper(*columns, basis=basis), self._configured)
            found, text = vars(choice.settings), choice.sentence
        except (ValueError, ArithmeticError, MemoryError) as error:
            reason = str(error) or type(error).__name__
            found, text = vars(self.settings), f"it stays with {LABELS[self.settings.estimator]}: {reason}"
        own = vars(self._configured)
        found = {name: value for name, value in found.items() if value != own[name]}
        return json.dumps({"layer": layer, "length": length, "settings": found, "text": text}).encode()

    def use(self, length: float, found: dict[str, Any], wall: Wall) -> Change | None:
        """Draw the wall again with what a fit of this length found; None if these are its settings already.

        If a setting breaks a rule, or memory is short, the wall stays as it is, and this fit is not due any more.
        """
        if self.due and self.due[0] <= length:
            self.due = None
        settings = self._with(found)
        change = None if settings == wall.settings else wall._redraw(settings)
        self.found = found
        return change


def _parts_of(depth: Floats) -> Integers:
    return np.floor(depth / PART).astype(np.int64)


def read_fit(payload: bytes) -> tuple[str, float, dict[str, Any], str]:
    """Return layer, length, settings found and sentence of a record FITTED; raise ValueError if it is another text."""
    fit = json.loads(payload)
    try:
        return str(fit["layer"]), float(fit["length"]), dict(fit["settings"]), str(fit["text"])
    except (TypeError, KeyError) as error:
        raise InputError("fit", "must have layer, length, settings and text", repr(fit)[:100]) from error


def fits_of(wall: dict[str, Any], before: LayerFits | None = None) -> LayerFits | None:
    """Return the fits of a layer by the table ``wall`` of the configuration; None if its estimator is not automatic.

    A layer of another hole begins with what was found in the hole ``before``.
    """
    if wall.get("estimator") != "automatic":
        return None
    names = {each.name for each in fields(Settings)}
    return LayerFits(Settings(**{name: value for name, value in wall.items() if name in names}), before)
