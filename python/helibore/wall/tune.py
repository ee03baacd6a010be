"""Find the settings that rebuild a hole best, and measure those of a wall, by leaving samples out (`tuning`)."""

from __future__ import annotations

from typing import Unpack

from helibore.base.tables import refuse_table
from helibore.base.thread_count import thread_count
from helibore.samples.caliper import Caliper
from helibore.settings.keywords import WallSettings
from helibore.settings.wall_settings import Settings
from helibore.wall.estimates import FEW_BOXES, in_depth_order
from helibore.wall.tuning import FEW_TARGETS, Tuning, tuning_with
from helibore.wall.wall import Wall


def tune(
    caliper: Caliper,
    *,
    bit_diameter: float,
    targets: int = 2000,
    threads: int | None = None,
    seed: int = 0,
    **fixed: Unpack[WallSettings],
) -> Tuning:
    """Find the settings that rebuild a hole best, by leaving samples out.

    Parameters
    ----------
    caliper
        The samples of the hole.
    bit_diameter, **fixed
        Settings that all candidates share, as in `Settings`. Of ``estimator``, ``neighbors``, ``angular_scale``,
        ``kriging_range`` and ``nugget``, `tune` chooses those that are not given. With more than 64 neighbours it does
        not try kriging. If ``estimator`` is 'near-and-far' there is nothing to choose: only its error is measured.
    targets
        Number of samples to leave out, 1 or more; all samples if there are fewer.
    threads
        None: all cores. The result does not depend on it.
    seed
        Chooses the targets and their boxes.

    Returns
    -------
    Tuning
        The chosen candidate has the least error in gaps, among those that are better than the settings without tuning
        by more than two standard errors, both alone and in gaps. If there is no such candidate, the settings without
        tuning are chosen. If the tool leaves most of each turn unmeasured and the shape of the hole continues along it,
        the settings for such a hole are chosen instead, unless one of `TUNED_ALONG` is given.

    Raises
    ------
    InputError
        As `Wall`; if ``window`` or ``targets`` breaks its rule; if there are too few samples: ``samples = 37: too few
        samples to tune: must be at least 100``.
    """
    refuse_table(caliper, "caliper")
    settings = Settings(bit_diameter=bit_diameter, **fixed).resolved(later=True)
    Wall(**vars(settings) | {"kriging_range": settings.kriging_range or 1.0})  # the core checks the settings
    return tuning_with(
        in_depth_order(caliper), settings, dict(fixed), targets, thread_count(threads), seed, boxes=targets
    )


def cross_validate(wall: Wall, targets: int = 1000, threads: int | None = None) -> Tuning:
    """Measure how well the settings of a wall predict its own samples, and how much `tune` would gain.

    A wall with near and far neighbours is not compared with others: between arms, left-out samples would mislead, and
    the covariance has decided already (`helibore.wall.automatic`).
    """
    if wall.settings.estimator == "near-and-far":
        targets = min(targets, FEW_TARGETS)  # each takes a millisecond
    return tuning_with(in_depth_order(wall.samples), wall.settings, {}, targets, thread_count(threads), 0, FEW_BOXES)
