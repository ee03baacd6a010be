"""From samples or readings to a wall: one append to an empty `Wall`, and what preparation left out and corrected."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Unpack

from helibore.base.errors import InputError
from helibore.base.tables import refuse_table
from helibore.logs.log_columns import DIFFERENCE
from helibore.samples.caliper import Caliper
from helibore.wall.interpolation import on_quads
from helibore.wall.wall import Wall, wall_of

if TYPE_CHECKING:
    from helibore.channels.log_set import LogFile, LogSet
    from helibore.preparation.prepare import Preparation, Prepared, Track
    from helibore.preparation.readings import Readings
    from helibore.settings.keywords import WallSettings
    from helibore.trajectory.survey import Path


def wall_of_samples(
    samples: Caliper | Prepared | Readings | Sequence[Readings] | LogFile | LogSet,
    bit_diameter: float,
    preparation: Preparation | None = None,
    path: Path | None = None,
    track: Track | None = None,
    threads: int | None = None,
    **settings: Unpack[WallSettings],
) -> Wall:
    """Return the wall of samples or readings, as `helibore.reconstruct` describes."""
    prepared = None
    if isinstance(samples, Caliper):
        caliper = samples
    else:
        refuse_table(samples, "samples")
        from helibore.channels.log_set import LogFile, LogSet
        from helibore.preparation.prepare import Prepared, prepare

        if isinstance(samples, LogFile | LogSet):
            samples = samples.readings(bit_diameter=bit_diameter if bit_diameter > 0 else None)
        if not isinstance(samples, Prepared):
            samples = prepare(samples, preparation, path, track, bit_diameter if bit_diameter > 0 else None)
            preparation = track = None
        caliper, prepared = samples.caliper, samples
    for name, given in (("preparation", preparation), ("track", track)):
        if given is not None:
            raise InputError(name, f"applies only to readings; a {type(samples).__name__} is already prepared")
    wall = wall_of(caliper, bit_diameter=bit_diameter, path=path, threads=threads, **settings)
    if prepared is None:
        return wall
    if prepared.earlier is not None:
        alike = vars(wall.settings) | {"arm_biases": None}  # the tool of the earlier pass is another one
        compare(wall, wall_of(prepared.earlier, threads=threads, **alike))
    if lines := [*map(list, prepared.report), *(["passes", sentence] for sentence in _odd_passes(wall, prepared))]:
        wall.made_from["preparation"] = lines
    if prepared.echo_accuracy is not None:
        wall.made_from["echo"] = prepared.echo_accuracy
    return wall


def _odd_passes(wall: Wall, prepared: Prepared) -> list[str]:
    from helibore.preparation.passes import odd_passes

    number = prepared.pass_number
    return [] if number is None else odd_passes(wall, prepared.caliper, number, prepared.arm_names)


def compare(wall: Wall, earlier: Wall) -> None:
    """Set the attribute "difference" of ``wall``: its radius minus the radius of ``earlier``, metres."""
    from helibore.preparation.passes import difference

    wall.attributes[DIFFERENCE] = on_quads(difference(earlier, wall), wall.settings.sectors)
    wall.attributes.units[DIFFERENCE] = "m"
