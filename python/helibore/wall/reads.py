"""What can be read from a wall: the same methods for a `Wall` that grows and for a `WallState`, which never changes."""

from __future__ import annotations

import os
from collections.abc import Iterable, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Literal

import numpy as np
import numpy.typing as npt

from helibore import _core
from helibore.base.arrays import Array, Floats, Mask
from helibore.base.color_limits import over_bit
from helibore.base.errors import InputError, needs
from helibore.base.notebook import card, map_picture
from helibore.base.thread_count import thread_count
from helibore.logs.picks import ENDING as PICKS
from helibore.mesh.surface import Surface, surface_of
from helibore.mesh.volume import Volume, volume_of
from helibore.samples.helix import helix_of, whole_helix
from helibore.trajectory.survey import Path
from helibore.wall import archive
from helibore.wall.interpolation import measured_quads
from helibore.wall.points import PointValues, values_at
from helibore.wall.uncertainty import arm_sigma, wall_sigma
from helibore.wall.wall_columns import MEASURED, WallColumns

if TYPE_CHECKING:
    from xarray import Dataset

    from helibore.logs.intervals import IntervalTable
    from helibore.logs.passage import Drift, Passage
    from helibore.logs.summary import WallSummary
    from helibore.logs.turn_logs import Logs
    from helibore.logs.zone_criteria import Criteria
    from helibore.logs.zones import Classification
    from helibore.settings.output_settings import RigidBody
    from helibore.settings.wall_settings import Settings


class WallReads:
    """The methods that read a wall. Each reads one copy of the wall, so other threads may change the wall meanwhile."""

    if TYPE_CHECKING:  # a subclass holds these; properties here would hide the fields of a dataclass

        @property
        def settings(self) -> Settings: ...
        @property
        def start_depth(self) -> float: ...
        @property
        def radius(self) -> Floats: ...
        @property
        def sample_count(self) -> int: ...
        @property
        def threads(self) -> int | None: ...

    def _state(self, samples: bool | None = True) -> WallColumns:
        """Return a copy of the wall; ``samples`` says whether it holds them. None: if they have arm numbers."""
        raise NotImplementedError

    def __len__(self) -> int:
        return len(self.radius)

    @property
    def depth(self) -> Floats:
        """(n,) float64 measured depth of each vertex, metres; a copy."""
        return whole_helix(self).depth(np.arange(len(self)))

    @property
    def toolface(self) -> Floats:
        """(n,) float64 toolface of each vertex, degrees in [0, 360); a copy."""
        return whole_helix(self).toolface(np.arange(len(self)))

    @property
    def sigma(self) -> Floats:
        """(n,) float64 standard uncertainty of each radius, metres; `wall_sigma` computes it at each access.

        With 95 % probability the true radius is within 1.96 sigma. NaN if the vertex is farther from samples than the
        calibration covers, or in a gap of the turn larger than `Settings.largest_gap`; and everywhere if the shape is
        assumed round (`basis`). For other walls, raises InputError if there are fewer than 100 samples, if no sample
        has another sample within ``max_distance``, or if ``window`` is set.
        """
        return self._sigma_of(self._state())

    def _sigma_of(self, state: WallColumns) -> Floats:
        """Return the uncertainty of a state's radii; if it lacks the sums for that, compute the wall again."""
        threads = thread_count(state.threads)
        if not state.sums and state.radius.size:
            settings = vars(state.settings) | {"sigma": True, "direct": False}
            again = _core.Wall(settings, threads, "automatic")
            again.append(*state.sample_columns)
            state = replace(state, sums=again.sums())
        return wall_sigma(state, threads)

    @property
    def angular_gap(self) -> Floats:
        """(n,) float64 degrees around the hole between the nearest samples on the two sides of each vertex.

        Samples within `Settings.gap_reach` metres of the vertex's depth count. The gap is 0 at a sample's toolface; it
        is 360 if there is no sample, or only one at another toolface. A small gap means that the tool measured this
        part of the turn. Between the arms of a tool with few arms the gap is large, and the wall is interpolated, even
        if samples of the arms are near.
        """
        return self._state().angular_gap

    @property
    def measured(self) -> Mask:
        """(n,) bool: whether the wall is measured at each vertex; otherwise it is interpolated, or has no radius.

        A vertex is measured if it has a radius, a sample lies within 0.15 m of its depth and 15 degrees of its
        toolface, the wall changes by at most 1.1 mm between the vertex and its samples, and its `angular_gap` is at
        most `Settings.largest_gap`. The change is hypot(m, s d / 2), of the differences between the vertex and its
        four nearest samples: m is their mean, weighted by the inverse distance, s their rms, and d the distance to
        the nearest as a share of 0.15 m and 15 degrees; where d is below 0.3, m counts (d / 0.3)² times. So 95 % of
        the errors of measured vertices are below 1.6 mm, in rough rock 1.9 mm. `Logs.coverage` is the share of such
        vertices. Zones, hatching, meshes and reports read this mask; `drift` and `passage` read it without the limit
        of the change.
        """
        return self._state().measured

    @property
    def sampled(self) -> Mask:
        """(n,) bool: whether each vertex is `measured` but for the limit of the wall's change.

        Samples lie near, also where the wall between them is steep. Kinds, lobes, `drift` and `passage` read this mask.
        """
        return self._state().sampled

    def at(self, depth: npt.ArrayLike, toolface: npt.ArrayLike) -> PointValues:
        """Return radius, nearest distance, support and angular gap at points, as `helibore.wall.points.PointValues`.

        Parameters
        ----------
        depth, toolface
            Metres and degrees, finite: two numbers, or two arrays of m values.

        Raises
        ------
        InputError
            If a value is not finite or the lengths differ.

        Examples
        --------
        >>> wall = reconstruct(Caliper([0, 0.1, 0.2], [0, 90, 180], [0.1] * 3), bit_diameter=0.2, sectors=4)
        >>> wall.at(0.1, 45).radius
        array([0.1])
        """
        return values_at(self._state(), depth, toolface)

    def surface(
        self, path: Path | Literal["own"] | None = "own", start: float | None = None, stop: float | None = None
    ) -> Surface:
        """Place the wall along a path and join neighbouring turns into quads, with its images and attributes.

        The surface of a tool with few arms (`arms`) has the attribute ``measured``: 1 for a quad whose four corners are
        `measured`, 0 for one that is interpolated.

        Parameters
        ----------
        path
            Path of the hole; ``"own"`` means the wall's own `path`. Without a path the surface goes straight down from
            (0, 0, 0), with toolface 0 to the north.
        start, stop
            Depths, metres; None: the ends of the wall. The surface holds the quads of the vertices with depths in
            [start, stop), so that surfaces of neighbouring intervals meet without overlap or gap. These quads reach one
            turn beyond the end towards which the helix grows: ``stop``, or ``start`` if the pitch is negative.

        Raises
        ------
        InputError
            If the path does not reach a vertex, if the path's reference is undefined there (``vertex 7 at depth 12:
            ...``), if no vertex lies between ``start`` and ``stop``, or if JSON cannot hold `made_from`; and as
            `SectorImage.on` and `WallAttributes`.
        """
        state = self._state(samples=None)
        surface = surface_of(state, _resolve_path(state, path), start, stop, thread_count(state.threads))
        if state.arms is not None:
            surface.attributes[MEASURED] = measured_quads(state)
        for name, image in state.images.items():
            surface.attributes[name] = image.on(state)
            surface.attributes.units[name] = image.unit
        for name in state.attributes:
            surface.attributes[name] = state.attributes.whole(name, state.start_depth, state.quads)
        surface.attributes.units.update(state.attributes.units)
        return surface

    def volume(
        self,
        path: Path | Literal["own"] | None = "own",
        shells: Sequence[float | npt.ArrayLike | WallReads] = (0.05, 0.20),
        start: float | None = None,
        stop: float | None = None,
    ) -> Volume:
        """Thicken the wall outwards, shell by shell, into hexahedra; ``measured`` is as in `surface`.

        Parameters
        ----------
        path, start, stop
            As for `surface`.
        shells
            One or more shells, from the wall outwards. Each is a thickness in metres; or thicknesses, one for every
            vertex of the wall (NaN: no shell there); or a second wall on the same helix. All thicknesses count from the
            wall itself, not from the previous shell: ``[0.05, 0.20]`` gives layers of 0.05 and 0.15 m.

        Raises
        ------
        InputError
            As `surface`; if a second wall has another helix; if a shell does not lie beyond the previous one, or the
            path bends so sharply that a shell folds over itself. The error names shell, vertex and depth.
        """
        state = self._state(samples=None)
        volume = volume_of(state, _resolve_path(state, path), shells, start, stop, thread_count(state.threads))
        if state.arms is not None:
            volume.hang(MEASURED, [measured_quads(state)] * len(shells))
        return volume

    def save(self, filename: str | os.PathLike[str]) -> None:
        """Write the wall to an archive, whole or not at all; `helibore.load` reopens it.

        The archive holds settings, samples, vertices, `path`, `images`, `attributes`, `intervals` and `made_from`. The
        reopened wall equals this wall in every bit, also after further appends. `helibore.wall.archive` describes the
        file. `picks`, if there are any, are written to FILENAME.picks.csv, which `helibore.load` also reads; a wall
        without picks does not change such a file.

        Parameters
        ----------
        filename
            Ends in .wall; an existing file is replaced.

        Raises
        ------
        InputError
            If the name has another ending, or JSON cannot hold `made_from`.
        OSError
            If the file cannot be written; an existing file then does not change.
        """
        state = self._state()
        archive.save(state, filename)
        if state.picks:
            state.picks.save(f"{os.fspath(filename)}{PICKS}", state.path)

    def logs(
        self,
        rugosity_window: float = 1.0,
        threads: int | None = None,
        *,
        sigma: bool = False,
        caliper_accuracy: float = 0.0,
    ) -> Logs:
        """Measure every full turn with `helibore.logs.turn_logs.turn_logs`, for this wall and its bit diameter.

        ``rugosity_window`` is the metres of hole over which rugosity is computed; it is rounded to an odd number of
        turns, for example to 9 turns for 1 m at a pitch of 0.1 m. If ``threads`` is None, the wall's threads are
        used. If ``sigma`` is True, the logs have the uncertainty of diameters and volumes, and this raises an
        InputError as `sigma` does. ``caliper_accuracy`` is the standard uncertainty that all radii share, metres.

        The arrays of the logs cannot be written. While the logs are held and the wall stays the same, this method and
        `zones` give the same logs again, without measuring the turns once more.
        """
        from helibore.logs.turn_logs import turn_logs

        state, how = self._state(), (rugosity_window, sigma, caliper_accuracy)
        if (found := state.kept.find(state, how)) is not None:
            return found
        known = self._sigma_of(state) if sigma else None
        of_arms = arm_sigma(state) if sigma else 0.0
        found = turn_logs(
            state, None, rugosity_window, threads, known, caliper_accuracy=caliper_accuracy, arm_sigma=of_arms
        )
        return state.kept.keep(found, how)

    def interval_table(self, criteria: Criteria | None = None, *, sigma: bool = False) -> IntervalTable:
        """Return diameters, volume, measured share and metres by kind in each of `intervals` that is a formation.

        Parameters
        ----------
        criteria
            Criteria of the kinds of hole; None: the defaults.
        sigma
            Whether the volumes have an uncertainty; this raises an InputError as `sigma` does.
        """
        from helibore.logs.intervals import interval_table
        from helibore.logs.turn_logs import turn_logs
        from helibore.logs.zones import classify

        state = self._state()
        known, of_arms = (self._sigma_of(state), arm_sigma(state)) if sigma else (None, 0.0)
        logs = turn_logs(state, sigma=known, arm_sigma=of_arms)
        return interval_table(state, state.intervals, classify(state, criteria, logs))

    def drift(self, length: float | str, *, sigma: bool = False) -> Drift:
        """Return the greatest diameter of a rigid cylinder at each turn, in three dimensions along `path`.

        Parameters
        ----------
        length
            Metres, from 0.001 m to the length of the wall; or the name of a drift mandrel of API 5CT: ``"api-casing"``
            (0.152 m, up to 8 5/8 in), ``"api-large-casing"`` (0.305 m), ``"api-tubing"`` (1.067 m). The cylinder is
            rigid: in a curved hole a long one is thin. `Drift.curvature` is what the path alone costs.
        sigma
            Whether to compute the 95 % interval, from the uncertainty of the wall (`sigma`).

        Returns
        -------
        Drift
            Diameter, interval, places of contact. Unknown (NaN) where a vertex beside the cylinder is not `measured`.

        Raises
        ------
        InputError
            ``length of the string = 900: must be shorter than the wall, 812.3 m of whole turns``; if the wall's shape
            was not measured; if the path does not reach the wall, or has no frame there; with ``sigma`` as `sigma`.

        Examples
        --------
        >>> k = np.arange(64 * 40)
        >>> wall = reconstruct(Caliper(k * 0.1 / 64, k * 360 / 64, np.full(k.size, 0.1)), bit_diameter=0.2)
        >>> round(wall.drift(1.0).least, 6)
        0.2
        """
        from helibore.logs.passage import drift_of

        state = self._state()
        return drift_of(state, length, self._sigma_of(state) if sigma else None)

    def passage(self, string: Iterable[RigidBody], *, sigma: bool = False) -> Passage:
        """Return the clearance of a rigid string of bodies at each turn, in three dimensions along `path`.

        Parameters
        ----------
        string
            One `RigidBody` or more: outer diameter, length, position above the lower end of the string. The bodies have
            one straight axis.
        sigma
            As in `drift`.

        Returns
        -------
        Passage
            Clearance, as a diameter, below 0 where the string does not pass; places of contact, with the body. Unknown
            (NaN) where a vertex beside a body is not `measured`.

        Raises
        ------
        InputError
            As `drift`; ``string: must have a body``; ``string[1] = str: must be a RigidBody(diameter, length,
            position)``.
        """
        from helibore.logs.passage import passage_of

        state = self._state()
        return passage_of(state, string, self._sigma_of(state) if sigma else None)

    def zones(self, criteria: Criteria | None = None) -> Classification:
        """Find washouts, breakouts, key seats and undergauge hole with `helibore.logs.zones.classify`.

        ``criteria`` holds the limits in metres; None: the usual limits of the industry.
        """
        from helibore.logs.zones import classify

        return classify(self._state(), criteria)

    def summary(
        self, start: float | None = None, stop: float | None = None, criteria: Criteria | None = None
    ) -> WallSummary:
        """Summarize the wall, or an interval of the wall, with `helibore.logs.summary.summarize`.

        ``start`` and ``stop`` are measured depths, metres, finite; None: the ends of the wall. ``criteria`` is as in
        `zones`.
        """
        from helibore.logs.summary import summarize

        return summarize(self._state(), start, stop, criteria)

    def to_xarray(self) -> Dataset:
        """Return the vertices as an ``xarray.Dataset`` by turn and sector, in metres and degrees.

        Returns
        -------
        Dataset
            ``radius``, ``nearest``, ``support``, ``angular_gap`` and the coordinate ``depth``, each (turn, sector), and
            the coordinate ``toolface`` (sector). Missing values are NaN, also in an incomplete last turn, where
            ``support`` is 0.

        Raises
        ------
        MissingExtraError
            If xarray is not installed.
        """
        with needs("xarray", "tables"):
            from xarray import Dataset
        state, sectors = self._state(), self.settings.sectors
        helix, radius = helix_of(state), state.radius
        turns = -(-radius.size // sectors)
        k = np.arange(turns * sectors)

        def by_turn(values: Array, missing: float = np.nan) -> tuple[tuple[str, str], Array]:
            filled = np.full(k.size, missing, values.dtype)
            filled[: values.size] = values
            return ("turn", "sector"), filled.reshape(turns, sectors)

        return Dataset(
            {
                "radius": (*by_turn(radius), {"units": "m"}),
                "nearest": (*by_turn(state.nearest), {"units": "m"}),
                "support": by_turn(state.support, 0),
                "angular_gap": (*by_turn(state.angular_gap), {"units": "deg"}),
            },
            {
                "depth": (*by_turn(helix.depth(k)), {"units": "m"}),
                "toolface": ("sector", helix.toolface(np.arange(sectors))),
            },
            {"basis": state.basis, "bit_diameter": self.settings.bit_diameter},
        )

    def _repr_html_(self) -> str:
        sectors, radius = self.settings.sectors, self.radius
        if len(radius) < sectors:
            return card(repr(self), {}, "")
        over, scale = over_bit(radius, self.settings.bit_diameter, sectors, self.settings.pitch)
        turns = over[: len(over) // sectors * sectors].reshape(-1, sectors)
        picture = map_picture(turns, scale, "radius over bit size by depth and toolface")
        return card("Wall", self.summary().numbers(), picture)

    def __repr__(self) -> str:
        if not len(self):
            return "Wall(empty)"
        last = self.start_depth + (len(self) - 1) * self.settings.pitch / self.settings.sectors
        return f"Wall({len(self)} vertices, {self.start_depth:g} to {last:g} m, {self.sample_count} samples)"


def _resolve_path(state: WallColumns, path: Path | Literal["own"] | None) -> Path | None:
    if isinstance(path, str):
        if path != "own":
            raise InputError("path", "must be a Path, None or 'own'", repr(path))
        return state.path
    return path
