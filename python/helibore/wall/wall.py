"""The wall: the radius of the hole at every vertex of a uniform helix. Samples come in one batch, or live.

    wall = hb.reconstruct(caliper, bit_diameter=0.216)     # an empty Wall and one append
    change = wall.append(depth, toolface, radius)          # more samples, anywhere in the hole

Vertex k lies at toolface (start_toolface + k 360/K) mod 360 and depth start_depth + k pitch/K, K = sectors.
"""

from __future__ import annotations

import os
import threading
from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
import numpy.typing as npt

from helibore import _core
from helibore.base.arrays import Floats, Mask, sample_columns
from helibore.base.colors import over_bit
from helibore.base.errors import InputError, needs
from helibore.base.notebook import card, map_picture
from helibore.base.settings import Settings
from helibore.base.thread_count import thread_count
from helibore.images.sector_image import SectorImage, SectorImages
from helibore.logs.picks import ENDING as PICKS
from helibore.logs.picks import Picks
from helibore.mesh.attributes import WallAttributes
from helibore.mesh.surface import Surface, surface_of
from helibore.mesh.volume import Volume, volume_of
from helibore.samples.caliper import Basis, Caliper, basis_text, check_basis
from helibore.samples.helix import helix_of, quad_room
from helibore.trajectory.survey import Path, checked_path
from helibore.wall import archive
from helibore.wall.append_result import Change, VertexColumns
from helibore.wall.estimates import find_kriging_range, in_depth_order
from helibore.wall.interpolation import in_canonical_order, measured_quads, on_quads
from helibore.wall.points import PointValues, values_at
from helibore.wall.state import MEASURED, WallState
from helibore.wall.uncertainty import wall_sigma

if TYPE_CHECKING:
    from xarray import Dataset

    from helibore.logs.summary import WallSummary
    from helibore.logs.turn_logs import Logs
    from helibore.logs.zone_criteria import Criteria
    from helibore.logs.zones import Classification


class Wall:
    """The wall of a hole. It is empty at first and grows with its samples.

    Parameters
    ----------
    bit_diameter, **settings
        As in `Settings`.
    threads
        None: all cores. The result does not depend on it.
    instruction_set
        'automatic', or one of 'plain', 'avx2' and 'avx512' to force it (for tests: all give equal results).
    basis
        What the radii of the samples are, as in `Caliper`; surfaces, files and pictures of the wall state it.

    Attributes
    ----------
    path
        The `Path` of the hole, or None. Surfaces and volumes follow it unless they are given another path, or None.
    images
        `SectorImage` by name. Every surface has them as attributes. If an image counts its angles from another
        reference than the wall's path, the surface has the turned image.
    attributes
        `WallAttributes`: other values, one for each quad of the wall. Every surface also has them.
    made_from
        Further facts on the origin of the wall (files, runs, shifts), as JSON values: texts, numbers, lists, dicts.
        Archives and meshes carry them. Reports and logs of an archive read only ``"preparation"``: the messages on
        readings that were left out or corrected.
    picks
        `Picks`: beds, fractures, faults and breakouts that were picked on the wall.

    Raises
    ------
    InputError
        On a setting that breaks its rule (``pitch = 0: must be finite and not 0``), and on the estimator 'kriging'
        without a ``kriging_range``.

    Notes
    -----
    A wall has vertices as soon as a sample lies at or beyond the start of its helix. It may be used from several
    threads; calls take effect one after another. Every array it returns is a copy. A wall can be copied and pickled;
    the copy equals the wall in every bit, also after further appends.
    """

    def __init__(
        self,
        *,
        bit_diameter: float,
        threads: int | None = None,
        instruction_set: str = "automatic",
        basis: Basis = "azimuthal",
        **settings: Any,
    ) -> None:
        check_basis(basis)
        self._basis = basis
        self._settings = Settings(bit_diameter=bit_diameter, **settings)
        if self._settings.estimator == "kriging" and self._settings.kriging_range is None:
            raise InputError("kriging_range", "must be given where samples arrive later; reconstruct() finds it")
        self._threads = thread_count(threads)
        self._core = _core.Wall(vars(self._settings), self._threads, instruction_set)
        self._growing = threading.Lock()  # held by an append, and while all columns are read together
        self._arms: list[Caliper] = []
        self._path: Path | None = None
        self.images: dict[str, SectorImage] = SectorImages()
        # The function holds the core, not self: a reference cycle would keep the memory until garbage is collected.
        core, sectors = self._core, self._settings.sectors
        self.attributes = WallAttributes(lambda: (core.start_depth, quad_room(len(core), sectors)))
        self.made_from: dict[str, Any] = {}
        self.picks = Picks()

    @property
    def settings(self) -> Settings:
        """The settings of the wall."""
        return self._settings

    @property
    def basis(self) -> Basis:
        """What the wall is made from: ``"azimuthal"``, ``"average"`` or ``"gauge"``."""
        return self._basis

    @property
    def basis_text(self) -> str:
        """The basis in words, which mention the arms of the caliper if samples were appended with arm numbers."""
        return basis_text(self._basis, bool(self._arms))

    def append(
        self,
        depth: npt.ArrayLike,
        toolface: npt.ArrayLike,
        radius: npt.ArrayLike,
        time: npt.ArrayLike | None = None,
        *,
        arm: npt.ArrayLike | None = None,
    ) -> Change:
        """Add samples from anywhere in the hole and recompute the vertices that they can change.

        Parameters
        ----------
        depth, toolface, radius, time, arm
            As in `Caliper`. Either all samples of a wall carry a time or none does.

        Returns
        -------
        Change
            The vertices that are new or have other values.

        Raises
        ------
        InputError
            As `Caliper`; if only the new samples or only the earlier ones have times; if the wall would have more
            vertices than ``most_vertices``. The wall then keeps its state, bit for bit.
        """
        columns = sample_columns(depth, toolface, radius, time)
        arms = None
        if arm is not None:
            copies: list[Any] = [None if of is None else of.copy() for of in columns]
            arms = Caliper(*copies, arm=arm)
        with self._growing:
            change = Change(*self._core.append(*columns))
            if arms is not None:
                self._arms.append(arms)
        return change

    def __len__(self) -> int:
        return len(self._core)

    @property
    def sample_count(self) -> int:
        """Number of samples kept."""
        return self._core.sample_count

    @property
    def settled(self) -> int:
        """Vertices before this number no longer change while the hole only gets deeper."""
        return self._core.settled

    @property
    def start_depth(self) -> float:
        """Depth of the first vertex, metres; NaN while neither the settings nor a sample give it."""
        return self._core.start_depth

    @property
    def depth(self) -> Floats:
        """(n,) float64 measured depth of each vertex, metres; a copy."""
        return self._core.depth()

    @property
    def toolface(self) -> Floats:
        """(n,) float64 toolface of each vertex, degrees in [0, 360); a copy."""
        return self._core.toolface()

    @property
    def threads(self) -> int:
        """Number of threads that compute the wall."""
        return self._threads

    @property
    def radius(self) -> Floats:
        """(n,) float64 radius at each vertex, metres; NaN if no sample is within ``max_distance``; a copy."""
        return self._core.radius()

    @property
    def nearest(self) -> Floats:
        """(n,) float64 distance from each vertex to the nearest sample used, metres; NaN if none was used; a copy."""
        return self._core.nearest()

    @property
    def support(self) -> npt.NDArray[np.int32]:
        """(n,) int32 number of samples each vertex is estimated from; a copy."""
        return self._core.support()

    @property
    def iterations(self) -> npt.NDArray[np.int32]:
        """(n,) int32 number of estimates made for each vertex; a copy."""
        return self._core.iterations()

    @property
    def provisional(self) -> npt.NDArray[np.bool_]:
        """(n,) bool: whether the radius is that of one sample until the vertex is settled (``direct`` only); a copy."""
        return self._core.provisional()

    @property
    def sigma(self) -> Floats:
        """(n,) float64 standard uncertainty of each radius, metres; `wall_sigma` computes it at each access.

        With 95 % probability the true radius is within 1.96 sigma. NaN if the vertex is farther from samples than the
        calibration covers, or in a gap of the turn larger than `Settings.largest_gap`; and everywhere if the shape is
        assumed round (`basis`). For other walls, raises InputError if there are fewer than 100 samples, if no sample
        has another sample within ``max_distance``, or if ``window`` is set.
        """
        return wall_sigma(self._with_sums(self._state()), self._threads)

    def _with_sums(self, state: WallState) -> WallState:
        """Return the state with the sums that sigma needs; if it lacks them, compute the wall again."""
        if state.sums or not state.radius.size:
            return state
        settings = vars(self._settings) | {"sigma": True, "direct": False}
        again = _core.Wall(settings, self._threads, "automatic")
        again.append(*state.sample_columns)
        return replace(state, sums=again.sums())

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

        A vertex is measured if it has a radius and its `angular_gap` is at most `Settings.largest_gap`. `Logs.coverage`
        is the share of such vertices.
        """
        return self._state().measured

    @property
    def arms(self) -> Caliper | None:
        """The samples that were appended with an arm number, in the order of appending; None if there are none."""
        if len(self._arms) < 2:
            return self._arms[0] if self._arms else None
        names = ("depth", "toolface", "radius", "time", "arm")
        columns = {name: [getattr(each, name) for each in self._arms] for name in names}
        joined: dict[str, Any] = {name: None if of[0] is None else np.concatenate(of) for name, of in columns.items()}
        return Caliper(**joined)

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

    def vertices(self, start: int | None = None, stop: int | None = None) -> VertexColumns:
        """Return the values of the vertices [start, stop), for example of a range of a `Change`.

        Parameters
        ----------
        start, stop
            Numbers of vertices, 0 <= start <= stop <= len(wall). If the wall is a part of a helix, they count from
            `Settings.first_vertex`, as in `Change`. None: the ends of the wall.

        Returns
        -------
        VertexColumns
            Arrays of stop - start values: copies, all taken between the same two appends.

        Raises
        ------
        InputError
            If the range reaches beyond the wall: ``range = [0, 12): must lie within the wall's 10 vertices``.
        """
        first = self._settings.first_vertex
        ends = first if start is None else start, first + len(self._core) if stop is None else stop
        return VertexColumns(*self._core.vertices(*ends))

    def reach(self, start: int, stop: int) -> tuple[float, float]:
        """Return the two depths, metres, between which samples affect the values of the vertices [start, stop).

        A wall made from only the samples between these depths has equal values, in every bit, at these vertices. A
        depth is infinite if a vertex has too few samples and `Settings.max_distance` is None, or if its
        `Settings.window` is cut short by the end of the samples. An empty range gives (inf, -inf). Raises InputError as
        `vertices` does.

        Examples
        --------
        >>> wall = reconstruct(Caliper([0, 0.1, 0.2], [0, 90, 180], [0.1] * 3), bit_diameter=0.2, sectors=4)
        >>> wall.reach(0, 4)[1] > 1.0
        True
        """
        return self._core.reach(start, stop)

    @property
    def samples(self) -> Caliper:
        """The samples kept, in canonical order: depth, time or arrival, toolface, radius; a copy."""
        return Caliper(*self._core.samples(), basis=self._basis)

    def interpolate_samples(
        self, values: npt.ArrayLike, caliper: Caliper | None = None, *, on: str = "quads"
    ) -> Floats:
        """Interpolate values that were measured with the samples, with the neighbours and weights of the radius.

        Parameters
        ----------
        values
            (m,) one value for each sample; NaN where it is missing.
        caliper
            The samples in the order of ``values``, as they were appended. None: the values are in the order of
            `samples`.
        on
            'quads': one value for each quad, the mean of its four corners, as `attributes` takes them; 'vertices': one
            value for each vertex.

        Returns
        -------
        array
            (q,) or (n,) float64. A vertex is NaN if none of its neighbours has a value, and a quad is NaN if any of
            its corners is NaN.

        Raises
        ------
        InputError
            If lengths differ, ``caliper`` does not hold the samples of this wall, or ``on`` is another word.

        Examples
        --------
        >>> wall = reconstruct(Caliper([0, 0.1, 0.2], [0, 90, 180], [0.1] * 3), bit_diameter=0.2, sectors=4)
        >>> wall.attributes["GR"] = wall.interpolate_samples([40.0, 40.0, 40.0])
        """
        if on not in ("quads", "vertices"):
            raise InputError("on", "must be 'quads' or 'vertices'", repr(on))
        rows = in_canonical_order(self.samples, values, caliper)
        (interpolated,) = self._core.interpolate_samples([rows], self._threads)
        return on_quads(interpolated, self._settings.sectors) if on == "quads" else interpolated

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
        state = self._state(samples=bool(self._arms))
        surface = surface_of(state, self._resolve_path(path), start, stop, self._threads)
        if state.arms is not None:
            surface.attributes[MEASURED] = measured_quads(state)
        for name, image in self.images.items():
            surface.attributes[name] = image.on(state)
            surface.attributes.units[name] = image.unit
        for name in self.attributes:
            surface.attributes[name] = self.attributes.whole(name, state.start_depth, state.quads)
        surface.attributes.units.update(self.attributes.units)
        return surface

    def volume(
        self,
        path: Path | Literal["own"] | None = "own",
        shells: Sequence[float | npt.ArrayLike | Wall] = (0.05, 0.20),
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
        state = self._state(samples=bool(self._arms))
        volume = volume_of(state, self._resolve_path(path), shells, start, stop, self._threads)
        if state.arms is not None:
            volume.hang(MEASURED, [measured_quads(state)] * len(shells))
        return volume

    def __reduce__(self) -> tuple[Any, ...]:
        state = self._state()
        values = {name: (self.attributes.start_depth(name), of) for name, of in state.attributes.items()}
        own = (state.made_from, list(self.picks))
        placing = (state.path, dict(state.images), values, dict(state.attributes.units), *own)
        empty = partial(Wall, threads=self._threads, basis=self._basis, **vars(self._settings))
        return empty, (), (state.sample_columns, state.arms, *placing)

    def __setstate__(self, state: tuple[Any, ...]) -> None:
        """Restore a wall from an archive or a pickle: compute the vertices again from the samples."""
        samples, arms, self.path, images, attributes, units, self.made_from, picks = state
        if samples:
            self.append(*samples)
        if arms is not None:
            self._arms.append(arms)
        self.images.update(images)
        for name, (start_depth, values) in attributes.items():
            self.attributes.restore(name, start_depth, values)
        self.attributes.units.update(units)
        self.picks.extend(picks)

    def _resolve_path(self, path: Path | Literal["own"] | None) -> Path | None:
        if isinstance(path, str):
            if path != "own":
                raise InputError("path", "must be a Path, None or 'own'", repr(path))
            return self.path
        return path

    @property
    def path(self) -> Path | None:
        """The path that surfaces, logs and pictures follow; None: straight down. Set it to a `Path` or None."""
        return self._path

    @path.setter
    def path(self, path: Path | None) -> None:
        self._path = checked_path(path)

    def save(self, filename: str | os.PathLike[str]) -> None:
        """Write the wall to an archive, whole or not at all; `helibore.load` reopens it.

        The archive holds settings, samples, vertices, `path`, `images`, `attributes` and `made_from`. The reopened wall
        equals this wall in every bit, also after further appends. `helibore.wall.archive` describes the file. `picks`,
        if there are any, are written to FILENAME.picks.csv, which `helibore.load` also reads; a wall without picks does
        not change such a file.

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
        archive.save(self._state(), filename)
        if self.picks:
            self.picks.save(f"{os.fspath(filename)}{PICKS}", self.path)

    def _state(self, samples: bool = True) -> WallState:
        """Return a frozen copy of the wall; it has the samples only if ``samples`` is True."""
        core = self._core
        with self._growing:
            vertices = (core.radius(), core.nearest(), core.support(), core.iterations())
            columns = core.samples() if samples else ()
            sums = core.sums() if samples and self._settings.sigma else ()
            start_depth, arms, text = core.start_depth, self.arms if samples else None, self.basis_text
        placing = (self.path, self.images, self.attributes, self.made_from)
        return WallState(
            self._settings, self._basis, text, start_depth, *vertices, columns, *placing, arms, sums, self._threads
        )

    def logs(self, rugosity_window: float = 1.0, threads: int | None = None, *, sigma: bool = False) -> Logs:
        """Measure every full turn with `helibore.logs.turn_logs.turn_logs`, for this wall and its bit diameter.

        ``rugosity_window`` is the metres of hole over which rugosity is computed; it is rounded to an odd number of
        turns, for example to 9 turns for 1 m at a pitch of 0.1 m. If ``threads`` is None, the wall's threads are
        used. If ``sigma`` is True, the logs have the uncertainty of diameters and volumes, and this raises an
        InputError as `sigma` does.
        """
        from helibore.logs.turn_logs import turn_logs

        state = self._state()
        if not sigma:
            return turn_logs(state, None, rugosity_window, threads)
        known = wall_sigma(self._with_sums(state), self._threads)
        return turn_logs(state, None, rugosity_window, threads, known)

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
        state, sectors = self._state(), self._settings.sectors
        helix, radius = helix_of(state), state.radius
        turns = -(-radius.size // sectors)
        k = np.arange(turns * sectors)

        def by_turn(values: npt.NDArray[Any], missing: float = np.nan) -> tuple[tuple[str, str], npt.NDArray[Any]]:
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
            {"basis": self._basis, "bit_diameter": self._settings.bit_diameter},
        )

    def _repr_html_(self) -> str:
        sectors = self._settings.sectors
        if len(self) < sectors:
            return card(repr(self), {}, "")
        over, scale = over_bit(self.radius, self._settings.bit_diameter)
        turns = over[: len(self) // sectors * sectors].reshape(-1, sectors)
        picture = map_picture(turns, scale, "radius over bit size by depth and toolface")
        return card("Wall", self.summary().numbers(), picture)

    def __repr__(self) -> str:
        if not len(self):
            return "Wall(empty)"
        last = self.start_depth + (len(self) - 1) * self._settings.pitch / self._settings.sectors
        return f"Wall({len(self)} vertices, {self.start_depth:g} to {last:g} m, {self.sample_count} samples)"


def wall_of(
    caliper: Caliper, *, bit_diameter: float, path: Path | None = None, threads: int | None = None, **settings: Any
) -> Wall:
    """Return a wall made from the samples of ``caliper``; the parameters are those of `helibore.reconstruct`."""
    if settings.get("estimator") == "kriging" and settings.get("kriging_range") is None:
        checked = Settings(bit_diameter=bit_diameter, **settings)
        Wall(**vars(checked) | {"kriging_range": 1.0})  # the core checks the other settings
        settings["kriging_range"] = find_kriging_range(in_depth_order(caliper), checked)
    wall = Wall(bit_diameter=bit_diameter, threads=threads, basis=caliper.basis, **settings)
    wall.append(caliper.depth, caliper.toolface, caliper.radius, caliper.time, arm=caliper.arm)
    wall.path = path
    return wall
