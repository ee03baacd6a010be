"""The wall: the radius of the hole at every vertex of a uniform helix. Samples come in one batch, or live.

    wall = hb.reconstruct(caliper, bit_diameter=0.216)     # an empty Wall and one append
    change = wall.append(depth, toolface, radius)          # more samples, anywhere in the hole

Vertex k lies at toolface (start_toolface + k 360/K) mod 360 and depth start_depth + k pitch/K, K = sectors.
"""

from __future__ import annotations

import operator
import pickle
import zlib
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING, Any, SupportsIndex, Unpack

import numpy as np
import numpy.typing as npt

from helibore import _core
from helibore.base.arrays import Array, Floats, Integers32, Mask, sample_columns
from helibore.base.errors import InputError
from helibore.base.thread_count import thread_count
from helibore.images.sector_image import SectorImage, SectorImages
from helibore.logs.intervals import Interval, checked_intervals
from helibore.logs.kept_logs import KeptLogs
from helibore.logs.picks import Pick, Picks
from helibore.mesh.attributes import WallAttributes
from helibore.samples.caliper import Basis, Caliper, basis_text, check_basis
from helibore.samples.helix import quad_room
from helibore.settings.wall_settings import Settings
from helibore.trajectory.survey import Path, checked_path
from helibore.wall.append_result import Change, VertexColumns
from helibore.wall.arm_biases import without_biases
from helibore.wall.estimates import find_kriging_range, in_depth_order
from helibore.wall.interpolation import in_canonical_order, on_quads
from helibore.wall.reads import WallReads
from helibore.wall.state import WallState

if TYPE_CHECKING:
    from helibore.settings.keywords import WallSettings


class Wall(WallReads):
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
        **settings: Unpack[WallSettings],
    ) -> None:
        check_basis(basis)
        self._basis = basis
        self._settings = Settings(bit_diameter=bit_diameter, **settings).resolved(later=True)
        if self._settings.estimator == "automatic":
            rule = "must be another one where samples arrive later"
            raise InputError("estimator", rule, "'automatic'", "wall.estimator")
        if self._settings.estimator == "kriging" and self._settings.kriging_range is None:
            rule = "must be given where samples arrive later; reconstruct() finds it"
            raise InputError("kriging_range", rule, setting="wall.kriging_range")
        self._threads = thread_count(threads)
        self._instruction_set = instruction_set
        self._core = _core.Wall(vars(self._settings), self._threads, instruction_set)
        self._kept = KeptLogs()  # of the present samples
        self._growing = _core.WallLock()  # held by an append, and while all columns are read together
        self._arms: list[Caliper] = []
        self._path: Path | None = None
        self._images, self._picks = SectorImages(), Picks()
        self._intervals: tuple[Interval, ...] = ()
        self._made_from: dict[str, Any] = {}
        self._attributes = self._no_attributes()

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
            As in `Caliper`. Either all samples of a wall carry a time or none does. Of samples with an arm, the wall
            keeps the radius less the bias of the arm, if `Settings.arm_biases` has one.

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
            if self._settings.arm_biases is not None:
                arms = without_biases(arms, self._settings)
                columns = arms.depth, arms.toolface, arms.radius, arms.time
        with self._growing:
            change = Change(*self._core.append(*columns))
            self._kept = KeptLogs()
            if arms is not None:
                self._arms.append(arms)
        return change

    def _redraw(self, settings: Settings) -> Change:
        """Draw the wall again with other settings of the estimator, while no other thread appends.

        Other threads read the wall before until the new one is drawn.
        """
        core = _core.Wall(vars(settings), self._threads, self._instruction_set)
        depth, toolface, radius, *time = self._core.samples()
        change = Change(*core.append(depth, toolface, radius, time[0] if time else None))
        with self._growing:
            self._core, self._settings, self._kept = core, settings, KeptLogs()
            attributes, self._attributes = self._attributes, self._no_attributes()
        for name, values in attributes.items():
            self._attributes.restore(name, attributes.start_depth(name), values)
        self._attributes.units.update(attributes.units)
        return Change(change.ranges, change.settled, 0, 0)

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
    def support(self) -> Integers32:
        """(n,) int32 number of samples each vertex is estimated from; a copy."""
        return self._core.support()

    @property
    def iterations(self) -> Integers32:
        """(n,) int32 number of estimates made for each vertex; a copy."""
        return self._core.iterations()

    @property
    def provisional(self) -> Mask:
        """(n,) bool: whether the radius is that of one sample until the vertex is settled (``direct`` only); a copy."""
        return self._core.provisional()

    @property
    def arms(self) -> Caliper | None:
        """The samples that were appended with an arm number, in the order of appending; None if there are none."""
        appended = list(self._arms)
        if len(appended) < 2:
            return appended[0] if appended else None
        names = ("depth", "toolface", "radius", "time", "arm")
        columns = {name: [getattr(each, name) for each in appended] for name in names}
        joined: dict[str, Any] = {name: None if of[0] is None else np.concatenate(of) for name, of in columns.items()}
        return Caliper(**joined)

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
        with self._growing:
            appended = None if caliper is None else without_biases(caliper, self._settings)
            rows = in_canonical_order(self.samples, values, appended)
            (interpolated,) = self._core.interpolate_samples([rows], self._threads)
        return on_quads(interpolated, self._settings.sectors) if on == "quads" else interpolated

    def __reduce_ex__(self, protocol: SupportsIndex) -> tuple[Any, ...]:
        """Return the wall as a pickle inside the pickle, with a checksum: a wrong bit would give another wall."""
        buffers: list[pickle.PickleBuffer] = []
        inner = pickle.dumps(self._contents(), 5, buffer_callback=buffers.append)
        columns = buffers if operator.index(protocol) >= 5 else [bytes(of.raw()) for of in buffers]
        return _unpickled, (inner, columns, _checksum(inner, buffers))

    def _contents(self) -> tuple[Any, ...]:
        state = self._state()
        attributes = {name: (state.attributes.start_depth(name), of) for name, of in state.attributes.items()}
        placing = (
            state.path,
            state.images,
            attributes,
            state.attributes.units,
            state.made_from,
            list(state.picks),
            state.intervals,
        )
        empty = partial(Wall, threads=self._threads, basis=self._basis, **vars(self._settings))
        return empty, (state.sample_columns, state.arms, *placing)

    def __setstate__(self, state: tuple[Any, ...]) -> None:
        """Restore a wall from an archive or a pickle: compute the vertices again from the samples."""
        samples, arms, self.path, self.images, attributes, units, self.made_from, self.picks, self.intervals = state
        if samples:
            self.append(*samples)
        if arms is not None:
            self._arms.append(arms)
        for name, (start_depth, values) in attributes.items():
            self.attributes.restore(name, start_depth, values)
        self.attributes.units.update(units)

    @property
    def path(self) -> Path | None:
        """The path that surfaces, logs and pictures follow unless they get another; None: straight down."""
        return self._path

    @path.setter
    def path(self, path: Path | None) -> None:
        self._path = checked_path(path)

    @property
    def images(self) -> SectorImages:
        """`SectorImage` by name. Every surface has them as attributes.

        If an image counts its angles from another reference than the wall's path, the surface has the turned image. Set
        one by name, or assign a mapping, which is copied. Raises InputError if a value is not a `SectorImage`.
        """
        return self._images

    @images.setter
    def images(self, images: Mapping[str, SectorImage]) -> None:
        self._images = SectorImages(_mapping("images", images))

    @property
    def attributes(self) -> WallAttributes:
        """`WallAttributes`: other values, one for each quad of the wall. Every surface also has them.

        Set one by name, or assign a mapping, which is copied. Raises InputError as `WallAttributes`.
        """
        return self._attributes

    @attributes.setter
    def attributes(self, attributes: Mapping[str, npt.ArrayLike]) -> None:
        new = self._no_attributes()
        new.update(_mapping("attributes", attributes))
        new.units.update(getattr(attributes, "units", {}))
        self._attributes = new

    def _no_attributes(self) -> WallAttributes:
        # The function holds the core, not self: a reference cycle would keep the memory until garbage is collected.
        core, sectors = self._core, self._settings.sectors
        return WallAttributes(lambda: (core.start_depth, quad_room(len(core), sectors)))

    @property
    def made_from(self) -> dict[str, Any]:
        """Further facts on the origin of the wall (files, runs, shifts), as JSON values: texts, numbers, lists, dicts.

        Archives and meshes carry them. Reports and logs of an archive read ``"preparation"``, the messages on readings
        that were left out or corrected, and ``"echo"``, how sure the velocity of sound in the mud is. Zones read
        ``"measures"``: if it is "diameter", no sample shows on which side of its diameter the hole is wide. Assign a
        mapping with texts as keys, which is copied; whether JSON can hold its values is checked where they are written.
        """
        return self._made_from

    @made_from.setter
    def made_from(self, made_from: Mapping[str, Any]) -> None:
        self._made_from = dict(_mapping("made_from", made_from))

    @property
    def picks(self) -> Picks:
        """`Picks`: beds, fractures, faults and breakouts that were picked on the wall.

        Assign several `Pick`, which are copied; raises InputError on any other value.
        """
        return self._picks

    @picks.setter
    def picks(self, picks: Iterable[Pick]) -> None:
        if isinstance(picks, str | Mapping) or not isinstance(picks, Iterable):
            raise InputError("picks", "must be a list of Pick", type(picks).__name__)
        new = Picks(picks)
        for number, pick in enumerate(new):
            if not isinstance(pick, Pick):
                raise InputError(f"picks[{number}]", "must be a Pick", type(pick).__name__)
        self._picks = new

    @property
    def intervals(self) -> tuple[Interval, ...]:
        """Named intervals of the hole, such as formations, by depth; prints and pages show their tops.

        Assign several `Interval`, as `helibore.read_intervals` returns them; raises InputError on any other value.
        """
        return self._intervals

    @intervals.setter
    def intervals(self, intervals: Iterable[Interval]) -> None:
        self._intervals = checked_intervals(intervals)

    def _state(self, samples: bool | None = True) -> WallState:
        with self._growing:  # other threads may set images meanwhile: each step here copies a whole dict or list
            core = self._core
            with_samples = bool(self._arms) if samples is None else samples
            columns = core.samples() if with_samples else ()
            state = WallState(
                self._settings, self._basis, self.basis_text, core.start_depth,
                core.radius(), core.nearest(), core.support(), core.iterations(), columns,
                self._path, dict(self._images.data), self._attributes.frozen(), _copied(self._made_from),
                self.arms if with_samples else None, core.sums() if with_samples and self._settings.sigma else (),
                self._threads, Picks(self._picks), self._intervals,
            )  # fmt: skip
            vars(state)["kept"] = self._kept
        arrays: tuple[Array, ...] = (state.radius, state.nearest, state.support, state.iterations)
        for array in (*arrays, *columns, *state.sums):
            array.flags.writeable = False
        return state


def _mapping(name: str, values: Any) -> Mapping[str, Any]:
    if not isinstance(values, Mapping):
        raise InputError(name, "must be a mapping with texts as keys", type(values).__name__)
    for key in values:
        if not isinstance(key, str):
            raise InputError(name, "must have texts as keys", repr(key))
    return values


def _copied(value: Any) -> Any:
    """Return a copy of JSON values in which no list or dict is shared."""
    if isinstance(value, dict):
        return {name: _copied(of) for name, of in list(value.items())}
    if isinstance(value, list):
        return [_copied(of) for of in list(value)]
    return value


def wall_of(
    caliper: Caliper,
    *,
    bit_diameter: float,
    path: Path | None = None,
    threads: int | None = None,
    **settings: Unpack[WallSettings],
) -> Wall:
    """Return a wall made from the samples of ``caliper``; the parameters are those of `helibore.reconstruct`."""
    asked = Settings(bit_diameter=bit_diameter, **settings).resolved()
    if asked.estimator == "automatic":
        from helibore.wall.automatic import choose

        asked = choose(caliper, asked, threads).settings
    if asked.estimator == "kriging" and asked.kriging_range is None:
        Wall(**vars(asked) | {"kriging_range": 1.0})  # the core checks the other settings
        asked = replace(asked, kriging_range=find_kriging_range(in_depth_order(caliper), asked))
    wall = Wall(threads=threads, basis=caliper.basis, **vars(asked))
    wall.append(caliper.depth, caliper.toolface, caliper.radius, caliper.time, arm=caliper.arm)
    wall.path = path
    return wall


def _checksum(inner: bytes, buffers: Sequence[pickle.PickleBuffer | bytes | bytearray | memoryview]) -> int:
    found = zlib.crc32(inner)
    for buffer in buffers:
        found = zlib.crc32(pickle.PickleBuffer(buffer).raw(), found)
    return found


def _unpickled(inner: bytes, buffers: list[Any], checksum: int) -> Wall:
    if _checksum(inner, buffers) != checksum:
        raise InputError("pickle of a wall", "is damaged: its checksum differs")
    empty, state = pickle.loads(inner, buffers=buffers)
    wall: Wall = empty()
    wall.__setstate__(state)
    return wall
