"""What the viewer shows, as arrays that are ready to send: wall, overview, frames of the path, state of the run.

The scene uses no network: `protocol.py` makes the messages, `client.py` notes what a page has not received yet.
"""

from __future__ import annotations

import math
import os
import secrets
import threading
import time
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
import numpy.typing as npt

from helibore.base.arrays import Array, Floats, Mask, Unsigned16, numbers
from helibore.base.colors import check_map, customary_map
from helibore.base.errors import InputError
from helibore.base.harmless import printable
from helibore.logs.curves import ScalarCurve
from helibore.logs.intervals import Interval
from helibore.logs.picks import Picks
from helibore.logs.turn_logs import Shape
from helibore.logs.zone_criteria import Criteria
from helibore.samples.caliper import BASIS_TEXT, Basis
from helibore.settings.template import Template
from helibore.trajectory.references import Reference
from helibore.trajectory.survey import Path
from helibore.viewer.channel_strip import ShownChannel
from helibore.viewer.levels import Level, overview_of, refresh_overview
from helibore.viewer.texels import (
    FIRST,
    INTERPOLATED,
    RADIUS,
    RESCANNED,
    STATE,
    TRUST,
    UNCERTAINTY,
    Vertices,
    pack_trust,
    pack_vertices,
)

MOST_POINTS = 4096  # most points of a history
MAX_SECTORS = 2048  # the texture width that every WebGL 2 device offers
MAX_ATTRIBUTES = 16  # the bits of the attribute mask in a message's head
TILE_VERTICES = 16384  # a grid of (sectors + 1)(rows + 1) vertices then fits 16-bit indices
FRAMES_LEVEL = 255  # in messages, this stands for the path's frames in place of a level
FRAME_STEP = 2.0  # metres of depth between frames; in one step, a dogleg of 10 deg/30 m deviates 3 mm from straight


@dataclass(frozen=True)
class Attribute:
    """Describes one value for each quad that the page draws as a colour.

    Attributes
    ----------
    name, unit
        Texts for the page.
    low, high
        Values at the two ends of the colours, finite. If one is None, both follow from the values: their percentiles 2
        and 98, or, for the map "difference", ends at the same distance from 0.
    log
        Whether the colours follow the logarithm; the ends must then be above 0.
    color_map
        One of `helibore.plot.COLOR_MAPS`; "": the default map for name and unit.
    rows
        For an image that was measured in even rows: the upper edge of one row and the height of every row, metres. The
        page then draws the image in these rows; if they are thinner than a turn of the wall, it draws the quads and
        says so. None: it draws the quads.

    Raises
    ------
    InputError
        If an end is not finite, the ends are not in order, ``log`` is True and an end is not above 0, or the colour map
        is not known.
    """

    name: str
    unit: str = ""
    low: float | None = None
    high: float | None = None
    log: bool = False
    color_map: str = ""
    rows: tuple[float, float] | None = None

    def __post_init__(self) -> None:
        if self.color_map:
            check_map(self.color_map)
        ends = [of for of in (self.low, self.high) if of is not None]
        ordered = len(ends) < 2 or ends[0] < ends[1]
        if not (ordered and all(math.isfinite(end) and (end > 0 or not self.log) for end in ends)):
            rule = "must be finite, low below high, and above 0 if log"
            raise InputError(f"attribute {self.name}: (low, high)", rule, str((self.low, self.high)))

    @classmethod
    def usual(cls, name: str, unit: str = "") -> Attribute:
        """Return an attribute with the colours in which `helibore.plot` draws an image of this name and unit."""
        color_map = customary_map(name, unit)
        return cls(name, unit, log=color_map == "resistivity", color_map=color_map)


@dataclass(frozen=True)
class WallShape:
    """What the page must know of a wall besides its values, in metres and degrees. ``pitch`` may be negative."""

    sectors: int
    pitch: float
    start_depth: float
    bit_diameter: float
    start_toolface: float = 0.0
    well: str = ""
    attributes: tuple[Attribute, ...] = ()
    basis: Basis = "azimuthal"
    basis_text: str = BASIS_TEXT["azimuthal"]
    reference: Reference | None = None  # the direction of toolface 0; None: not known
    assumed: bool = False  # whether the reference is assumed, because nothing states it

    def __post_init__(self) -> None:
        if not 3 <= self.sectors <= MAX_SECTORS:
            raise InputError("sectors", f"the viewer draws 3 to {MAX_SECTORS} sectors", str(self.sectors))
        if not (math.isfinite(self.pitch) and self.pitch != 0):
            raise InputError("pitch", "must be finite and not 0", str(self.pitch))
        if not (math.isfinite(self.bit_diameter) and self.bit_diameter > 0):
            raise InputError("bit_diameter", "must be finite and above 0", str(self.bit_diameter))
        names = [attribute.name for attribute in self.attributes]
        if len(names) > MAX_ATTRIBUTES:
            raise InputError(f"{len(names)} attributes", f"the viewer takes at most {MAX_ATTRIBUTES}")
        if len(set(names)) != len(names):
            raise InputError(f"attributes {names}", "each name may appear once")

    @property
    def tile_rows(self) -> int:
        """Turns in a tile of the wall: the largest power of two that fits in `TILE_VERTICES`, at most 1024."""
        return 1 << max(2, min(10, int(math.log2(TILE_VERTICES / self.sectors))))

    @property
    def radius_unit(self) -> float:
        """Metres per step of a packed radius: 10 um up to 655 mm, coarser for wider holes."""
        return 1e-5 if self.bit_diameter <= 0.8 else 1e-4


@dataclass(frozen=True)
class PathFrames:
    """The path of the hole: one frame every `FRAME_STEP` metres of depth, from start_depth on.

    centre (n, 3) is north, east, down in metres; high and right (n, 3) are the directions of toolface 0 and 90. If not
    `surveyed`, there is no path, and the hole is drawn straight down.
    """

    centre: Floats
    high: Floats
    right: Floats
    surveyed: bool = True
    north: str = ""  # that the survey counts from: true, magnetic or grid; "": not stated


@dataclass(frozen=True)
class RunState:
    """What changes while a wall is shown, apart from the wall's values; every page receives each change."""

    bit_depth: float = math.nan  # metres; NaN: not known
    hole_depth: float = math.nan  # metres; NaN: not known
    seen_hole: float = math.nan  # the hole depth when the sensor was at the end of the wall, metres; NaN: not known
    tripped: bool = (
        False  # whether the bit may have been farther off bottom than for a connection since hole was drilled
    )
    newest: float = math.nan  # time of the newest sample, seconds since 1970; NaN for a saved wall
    received: float = math.nan  # time of the last bit depth, without one of the last bytes; NaN: not known
    ended: bool = False
    sources: str = ""  # what the sources are doing, in words
    units: str = "mm"  # with which a page begins: "mm" (depths in m), "in" or "ft" (sizes in inches)
    # The two measured depths between which the true vertical depth is known, and the "down" at which it is 0.
    true_depth: tuple[float, float, float] | None = None
    curves: tuple[
        Mapping[str, Any], ...
    ] = ()  # name, unit, low, high, log, version of each curve that a page may ask for
    # Ends of the colours by quantity, metres or the attribute's unit, from the whole wall; final once the wall is long.
    ranges: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    zones: tuple[Mapping[str, Any], ...] = ()  # JSON objects, in order of depth
    # Of washouts, breakouts and undergauge hole, metres.
    limits: tuple[float, float, float] = (Criteria.washout, Criteria.elongation, Criteria.undergauge)
    zones_to: float = math.nan  # depth of the wall's end when its zones were found, metres; NaN: not yet
    shape: Shape = "wall"  # what gives the diameters from which zones follow: `helibore.logs.turn_logs.Logs.shape`
    prints: bool = False  # whether `Scene.draw_pages` is set
    meshes: bool = False  # whether `Scene.write_mesh` is set
    # A rigid string: its "bodies" (diameter, length, position, metres), and "why" its clearance is not known. If
    # the bit's depth is known, "hanging": what each of them clears with the bit at "bit" (`Feed._hanging`).
    string: Mapping[str, Any] | None = None
    # Warnings of the live feed, "rule source: cause"; a page shows each until its user silences it.
    alarms: tuple[str, ...] = ()
    unused: str = ""  # why radii that come are not used, in words
    lost: tuple[str, ...] = ()  # names of the sources that are not connected
    channels: int = 0  # version of the picture of the rig's channels; 0: there are none
    # What is tight above and below the bit, a `helibore.live.ahead.Outlook`; None: it is not looked for.
    ahead: Mapping[str, Any] | None = None


class History:
    """The length of the wall over time: points (time, vertices, bit depth), rising in time and in vertices.

    The page's replay needs these points to show the wall as it was at 02:14, for example. Points are at least a second
    apart at first. When there are more than `MOST_POINTS`, every second one is dropped and the spacing at least
    doubles, so a month of drilling is a few thousand evenly spaced points. Earlier radii are not kept; a replay shows
    the first pass.
    """

    def __init__(self) -> None:
        self._points: list[tuple[float, int, float]] = []
        self._spacing = 1.0

    def note(self, time: float, vertices: int, bit_depth: float) -> None:
        """Add a point if the wall has grown and the clock was not set back."""
        points = self._points
        if points and (vertices <= points[-1][1] or time < points[-1][0]):
            return
        if len(points) > 1 and time - points[-2][0] < self._spacing:
            points.pop()
        points.append((time, vertices, bit_depth))
        if len(points) > MOST_POINTS:
            self._points = points = [*points[:-1:2], points[-1]]
            self._spacing = max(2 * self._spacing, (points[-1][0] - points[0][0]) / len(points))

    def frozen_copy(self) -> History:
        """Return a copy that later points do not change."""
        copy = History()
        copy._points, copy._spacing = list(self._points), self._spacing
        return copy

    def as_columns(self) -> dict[str, list[Any]]:
        """Return the points as columns for JSON: seconds since 1970, counts, metres or None."""
        return {
            "time": [round(time, 3) for time, _, _ in self._points],
            "vertices": [count for _, count, _ in self._points],
            "bit_depth": [depth if math.isfinite(depth) else None for _, _, depth in self._points],
        }


class Scene:
    """The wall as the server holds it. Every method may be called from any thread.

    Attributes
    ----------
    picks
        The picks of the wall; `change_picks` changes them for a page.
    intervals
        Named intervals of the hole, such as formations; a page gets them when it connects.
    plan
        Points of the planned path, (n, 3): north, east, down, metres; (0, 3): there is none.
    picks_file
        File to which `change_picks` saves the picks; None: they are not saved.
    saves_picks
        Whether ``picks_file`` could be written when the viewer started; if not, picks are kept in the wall only.
    path
        The path of the wall, for the dips in ``picks_file``.
    read_channels
        A function that returns the channels of the rig.
    draw_pages
        A function that returns a section as a PDF. It takes the two depths, the units of the page and the scale (None:
        a scale that the function chooses), if the page shows the wall in 3-D, a PNG of that, and as ``template`` the
        arrangement of its tracks, if the user has changed it. None: a page cannot print.
    write_mesh
        A function that returns a section, between two depths, as a GLB file. None: a page offers no mesh.
    write_logs
        A function that returns the logs of a section, between two depths, as a LAS file.
    """

    def __init__(self) -> None:
        self.lock = threading.RLock()
        self.on_change: Callable[[], None] = lambda: None
        self.listeners: list[Callable[[int, int, int, bool], None]] = []
        self.summarize: Callable[[float, float], dict[str, Any]] | None = None
        self.read_channels: Callable[[], list[ShownChannel]] = list
        self.draw_pages: Callable[..., bytes] | None = None
        self.write_mesh: Callable[[float, float], bytes] | None = None
        self.write_logs: Callable[[float, float], bytes] | None = None
        self.begun = False
        self.state = RunState()
        self.template: Template | None = None
        self.curves: dict[str, ScalarCurve] = {}
        self.picks = Picks()
        self.intervals: tuple[Interval, ...] = ()
        self.plan: Floats = np.zeros((0, 3))
        self.picks_file: str | os.PathLike[str] | None = None
        self.saves_picks = True
        self.path: Path | None = None

    def begin(self, shape: WallShape) -> None:
        """Delete everything and start a wall of this shape."""
        with self.lock:
            self.shape = shape
            self.session = secrets.token_hex(8)
            wall = Level(shape.sectors, shape.tile_rows, len(shape.attributes))
            self.levels = wall, overview_of(wall)
            self.frames = PathFrames(np.zeros((0, 3)), np.zeros((0, 3)), np.zeros((0, 3)), surveyed=False)
            self.settled = 0
            self.history = History()
            self.curves = {}
            self.state = replace(self.state, true_depth=None, ranges={}, shape="wall", curves=(), string=None)
            self.state = replace(self.state, zones=(), zones_to=math.nan)
            self.begun = True
        self.on_change()

    def write(self, first: int, vertices: Vertices, attributes: Mapping[str, npt.ArrayLike]) -> None:
        """Set the vertices from ``first`` on and the values of the quads with the same numbers.

        Pages receive the range from the first vertex that differs to the last one. Raises InputError if ``first`` is
        negative, or for an attribute that the shape does not name.
        """
        if first < 0:
            raise InputError("first", "must not be negative", str(first))
        unknown = sorted(set(attributes) - {attribute.name for attribute in self.shape.attributes})
        if unknown:
            raise InputError(f"attribute {unknown[0]}", "was not named when the scene began")
        texels = pack_vertices(vertices, self.shape.radius_unit)
        stop = first + len(texels)
        if stop == first:
            return
        with self.lock:
            level = self.levels[0]
            before = level.size
            level.reserve(stop)
            self._keep_first_pass(level.texels[first:stop], texels, first)
            texels[:, STATE] |= level.texels[first:stop, STATE] & TRUST
            differs = _replace(level.texels[first:stop], texels, np.uint64)
            for column, attribute in zip(level.columns, self.shape.attributes, strict=True):
                if attribute.name in attributes:
                    values = numbers(attributes[attribute.name], np.float32)[: stop - first]
                    differs[: len(values)] |= _replace(column[first : first + len(values)], values, np.uint32)
            changed = np.flatnonzero(differs)
            if stop <= before and not len(changed):
                return
            start = first + int(changed[0]) if len(changed) else first
            start, stop = (min(before, start), stop) if stop > before else (start, first + int(changed[-1]) + 1)
            self.history.note(time.time(), level.size, self.state.bit_depth)
            self._notify(0, start, stop)
            self._notify(1, *refresh_overview(self.levels[1], level, start, stop))
        self.on_change()

    def set_trust(self, interpolated: Mask, sigma: Floats | None = None) -> None:
        """Set for the first n vertices of the wall, (n,), whether they are interpolated, and their uncertainty, metres.

        The uncertainty of every vertex changes a little with every sample of a growing wall; a step of one level is
        left out. Of each tile, pages receive the range from the first vertex that differs to the last one.
        """
        with self.lock:
            level = self.levels[0]
            marks = pack_trust(interpolated, sigma)[: level.size]
            state = level.texels[: len(marks), STATE]
            before, after = ((bits >> UNCERTAINTY).astype(np.int8) for bits in (state, marks))
            near = (abs(after - before) <= 1) & (before > 0) & (after > 0)
            changed = np.flatnonzero(((state ^ marks) & INTERPOLATED > 0) | (before != after) & ~near)
            if not len(changed):
                return
            state[changed] = (state[changed] & ~np.uint16(TRUST)) | marks[changed]
            for part in np.split(changed, np.flatnonzero(np.diff(changed // level.tile_size)) + 1):
                self._notify(0, int(part[0]), int(part[-1]) + 1, measured=False)
            over = self.levels[1]
            self._notify(1, *refresh_overview(over, level, int(changed[0]), int(changed[-1]) + 1))
        self.on_change()

    def set_frames(self, first: int, frames: PathFrames) -> None:
        """Set the frames of the path from number ``first`` on; later frames stay. No frame may be left out."""
        with self.lock:
            old = self.frames
            if first > len(old.centre):
                rule = f"the scene holds {len(old.centre)} frames, none may be left out"
                raise InputError("first", rule, str(first))
            pairs = ((old.centre, frames.centre), (old.high, frames.high), (old.right, frames.right))
            joined = [np.concatenate([before[:first], new, before[first + len(new) :]]) for before, new in pairs]
            self.frames = PathFrames(joined[0], joined[1], joined[2], frames.surveyed, frames.north)
            self._notify(FRAMES_LEVEL, first, first + len(frames.centre))
        self.on_change()

    def update_state(self, **changes: Any) -> None:
        """Change fields of `RunState`. May be called before `begin`: open pages show the state from then on."""
        with self.lock:
            self.state = replace(self.state, **changes)
        self.on_change()

    def set_curves(self, curves: Iterable[ScalarCurve], version: int = 0) -> None:
        """Add or replace curves along the hole; a page then requests the curves that it shows, if they are new."""
        with self.lock:
            rows = {row["name"]: row for row in self.state.curves}
            for one in curves:
                name = printable(one.name)  # the page shows it, and asks for the curve by it
                low, high = one.ends()
                values = {"unit": one.unit, "low": low, "high": high, "log": one.log, "version": version}
                rows[name] = {"name": name} | values
                self.curves[name] = one
            self.state = replace(self.state, curves=tuple(rows.values()))
        self.on_change()

    def change_picks(self, change: Callable[[Picks], object]) -> None:
        """Change the picks, and save them if they have a file that can be written; if this fails, nothing changes."""
        with self.lock:
            picks = Picks(self.picks)
            change(picks)
            if self.picks_file is not None and self.saves_picks:
                picks.save(self.picks_file, self.path)
            self.picks[:] = picks
        self.on_change()

    def settle(self, below: int) -> None:
        """Note that vertices before ``below`` do not change while the hole only deepens: later changes are re-scans."""
        with self.lock:
            self.settled = max(self.settled, min(below, self.levels[0].size))

    def redraw(self) -> None:
        """Note that the wall was drawn again with other settings: what is written next is no re-scan."""
        with self.lock:
            self.settled = 0

    def frozen_copy(self, start: int, stop: int) -> Scene:
        """Return a copy that later changes do not reach: the vertices [start, stop) and the whole overview.

        A long download reads the copy, so this scene is locked only while the section is copied.
        """
        copy = Scene()
        with self.lock:
            wall, over = self.levels
            copy.levels = wall.frozen_copy(start, stop), over.frozen_copy(0, over.size)
            copy.shape, copy.session, copy.frames, copy.settled = self.shape, self.session, self.frames, self.settled
            copy.history, copy.state, copy.summarize = self.history.frozen_copy(), self.state, self.summarize
            copy.picks, copy.curves, copy.template = Picks(self.picks), dict(self.curves), self.template
            copy.intervals, copy.plan = self.intervals, self.plan
        copy.begun = True
        return copy

    def _keep_first_pass(self, old: Unsigned16, new: Unsigned16, first: int) -> None:
        """Keep the first pass of settled vertices, and mark the vertices that changed later as re-scanned."""
        known = max(0, min(self.settled - first, len(new)))
        was, now = old[:known], new[:known]
        scanned = was[:, FIRST] != 0
        now[:, FIRST] = np.where(scanned, was[:, FIRST], now[:, FIRST])
        changed = scanned & (now[:, RADIUS] != was[:, RADIUS])
        now[:, STATE] |= was[:, STATE] & RESCANNED
        now[:, STATE] |= np.where(changed, RESCANNED, 0).astype(np.uint16)

    def _notify(self, level: int, start: int, stop: int, measured: bool = True) -> None:
        for listener in self.listeners:
            listener(level, start, stop, measured)


def _replace(target: Array, values: Array, word: npt.DTypeLike) -> Mask:
    """Set ``target`` to ``values``, whose rows are one ``word`` each; return which rows have changed."""
    new = np.require(values, requirements="C")
    differs: Mask = target.view(word).ravel() != new.view(word).ravel()
    target[...] = new
    return differs
