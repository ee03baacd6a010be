"""From samples to a wall in one call: an empty wall and one append, with the preparation of readings before it.

    caliper                              -->  wall          hb.reconstruct(caliper, bit_diameter=0.216)
    readings --preparation--> caliper    -->  wall          hb.reconstruct(file.readings(), bit_diameter=..., ...)

Not here: what the preparation does (``preparation``), and runs that are written down to be repeated (``run``).
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from helibore.samples.caliper import Caliper
from helibore.wall.interpolation import on_quads
from helibore.wall.wall import Wall

if TYPE_CHECKING:
    from helibore.preparation.prepare import Preparation, Prepared, Track
    from helibore.preparation.readings import Readings
    from helibore.trajectory.survey import Path

DIFFERENCE = "difference"
"""The attribute that tells how much larger the wall is than that of the earlier passes, metres."""


def reconstruct(
    samples: Caliper | Prepared | Readings | Sequence[Readings],
    *,
    bit_diameter: float,
    preparation: Preparation | None = None,
    path: Path | None = None,
    track: Track | None = None,
    threads: int | None = None,
    **settings: Any,
) -> Wall:
    """Rebuild the wall of a hole from its samples: an empty `Wall` and one append.

    Parameters
    ----------
    samples
        A caliper, whose basis the wall takes over; what `helibore.prepare` made; or the readings of one file or of
        several over one hole, earliest first (``hb.open("caliper.las").readings()``), which are prepared here.
    preparation, track
        As in `helibore.prepare`, for readings.
    path
        What the wall's `Wall.path` becomes; readings are turned into its reference.
    bit_diameter, threads, **settings
        As in `Wall` and `Settings`.

    Returns
    -------
    Wall
        Which takes more samples by `Wall.append`. With earlier passes to compare with, its attribute ``"difference"``
        is how much larger it is than theirs, metres.

    Raises
    ------
    ValueError
        On a setting that breaks its rule, a preparation of samples that are prepared, and as `helibore.prepare`.

    Examples
    --------
    >>> wall = reconstruct(Caliper([0.0, 0.1], [0.0, 180.0], [0.1, 0.1]), bit_diameter=0.2, sectors=4)
    >>> wall.radius
    array([0.1, 0.1, 0.1, 0.1, 0.1])
    """
    caliper, earlier = _prepared(samples, preparation, path, track)
    wall = _built(caliper, bit_diameter, threads, settings)
    wall.path = path
    if earlier is not None:
        compare(wall, _built(earlier, bit_diameter, threads, settings))
    return wall


def _prepared(
    samples: Caliper | Prepared | Readings | Sequence[Readings],
    preparation: Preparation | None,
    path: Path | None,
    track: Track | None,
) -> tuple[Caliper, Caliper | None]:
    """The samples of the wall, and those of the earlier passes."""
    found: Caliper | Prepared
    if isinstance(samples, Caliper):
        found = samples
    else:
        from helibore.preparation.prepare import Prepared, prepare

        if not isinstance(samples, Prepared):
            made = prepare(samples, preparation, path, track)
            return made.caliper, made.earlier
        found = samples
    for name, given in (("preparation", preparation), ("track", track)):
        if given is not None:
            raise ValueError(f"{name}: is for readings; a {type(found).__name__} is prepared")
    return (found, None) if isinstance(found, Caliper) else (found.caliper, found.earlier)


def _built(caliper: Caliper, bit_diameter: float, threads: int | None, settings: dict[str, Any]) -> Wall:
    wall = Wall(bit_diameter=bit_diameter, threads=threads, basis=caliper.basis, **settings)
    wall.append(caliper.depth, caliper.toolface, caliper.radius, caliper.time)
    return wall


def compare(wall: Wall, earlier: Wall) -> None:
    """Give a wall the attribute that tells how much larger it is than an earlier one."""
    from helibore.preparation.passes import difference

    wall.attributes[DIFFERENCE] = on_quads(difference(earlier, wall), wall.settings.sectors)
    wall.attributes.units[DIFFERENCE] = "m"
