"""`hb.reconstruct`: from samples or readings to a wall in one call.

    caliper                              -->  wall          hb.reconstruct(caliper, bit_diameter=0.216)
    readings --preparation--> caliper    -->  wall          hb.reconstruct(hb.open("caliper.las"), bit_diameter=...)
    well.toml                            -->  wall          hb.reconstruct("well.toml")

``helibore.preparation`` describes the preparation; ``helibore.runs.run`` repeats runs from settings files.
"""

from __future__ import annotations

import os
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, Unpack

from helibore.base.errors import InputError
from helibore.runs.wall_of_samples import wall_of_samples
from helibore.samples.caliper import Caliper
from helibore.settings.declared import members
from helibore.settings.wall_settings import Settings
from helibore.wall.wall import Wall

if TYPE_CHECKING:
    from helibore.channels.log_set import LogFile, LogSet
    from helibore.preparation.prepare import Preparation, Prepared, Track
    from helibore.preparation.readings import Readings
    from helibore.settings.keywords import WallSettings
    from helibore.trajectory.survey import Path


def reconstruct(
    samples: Caliper | Prepared | Readings | Sequence[Readings] | LogFile | LogSet | str | os.PathLike[str],
    *,
    bit_diameter: float | None = None,
    preparation: Preparation | None = None,
    path: Path | None = None,
    track: Track | None = None,
    threads: int | None = None,
    **settings: Unpack[WallSettings],
) -> Wall:
    """Rebuild the wall of a hole from its samples, by one append to an empty `Wall`.

    Parameters
    ----------
    samples
        A caliper, whose basis becomes the basis of the wall; the result of `helibore.prepare`; what `helibore.open`
        returns of a file or a data frame; its readings (``hb.open("caliper.las").readings()``), or those of several
        files of one hole, earliest first, which are prepared here; or the name of a project (``well.toml``, also
        ``wall.glb.toml`` that helibore wrote beside an output), which states everything that is not given here.
    preparation, track
        As in `helibore.prepare`, for readings.
    path
        The path of the wall, `Wall.path`; toolfaces of readings are turned into the path's reference.
    bit_diameter, threads, **settings
        As in `Wall` and `Settings`. A project, an archive, and a file with one bit size have a bit diameter of their
        own.

    Returns
    -------
    Wall
        More samples can be added by `Wall.append`. If the preparation has earlier passes, the attribute
        ``"difference"`` is the wall's radius minus the radius of the wall from these passes, metres. For readings,
        ``made_from["preparation"]`` lists what was left out and corrected, and the worst places where one pass differs
        from the merged wall.

    Raises
    ------
    InputError
        If a setting breaks its rule, if a preparation is given for samples that are already prepared, and for the
        reasons of `helibore.prepare`.

    Examples
    --------
    >>> wall = reconstruct(Caliper([0.0, 0.1], [0.0, 180.0], [0.1, 0.1]), bit_diameter=0.2, sectors=4)
    >>> wall.radius
    array([0.1, 0.1, 0.1, 0.1, 0.1])
    """
    if isinstance(samples, str | os.PathLike):
        return _of_project(samples, preparation, path, track, threads, {"bit_diameter": bit_diameter, **settings})
    if bit_diameter is None:
        bit_diameter = _bit_of(samples)
    if bit_diameter is None:
        rule = "must be given; only a project and some files state it"
        raise InputError("bit_diameter", rule, setting="wall.bit_diameter")
    bit_diameter = members(Settings)["bit_diameter"].checked(bit_diameter)
    return wall_of_samples(samples, bit_diameter, preparation, path, track, threads, **settings)


def _bit_of(samples: Any) -> float | None:
    """Return the bit diameter that an opened file states, metres; None if it states none, and for other samples."""
    from helibore.channels.channel_readings import stated_bit
    from helibore.channels.log_set import LogFile, LogSet
    from helibore.channels.roles import guess

    log_set = samples.set() if isinstance(samples, LogFile) else samples
    found = stated_bit(log_set, guess(log_set)) if isinstance(log_set, LogSet) else None
    return None if found is None else found[0]


def _of_project(
    project: str | os.PathLike[str], preparation: Preparation | None, path: Path | None, track: Track | None,
    threads: int | None, settings: dict[str, Any],
) -> Wall:  # fmt: skip
    """Return the wall of a project, with what is given here in place of what the project states."""
    from helibore.runs.project import read_project
    from helibore.runs.run import make_wall, open_run

    for name, given in (("path", path), ("track", track)):
        if given is not None:
            raise InputError(name, "applies only to readings; a project names the file")
    known = members(Settings)
    stated = {
        name: known[name].checked(value) if name in known else value
        for name, value in settings.items()
        if name != "bit_diameter" or value is not None
    }
    over: dict[str, Any] = {"wall": stated} if stated else {}
    if preparation is not None:
        over["preparation"] = preparation
    return make_wall(open_run(read_project(project, over)), threads).wall
