"""Keep a scene equal to a wall: a thread of the feed reads what changed.

    producer's update() --ranges--> feed's thread --vertices--> scene --messages--> pages

The producer only notes ranges, so ten appends between two reads cost one read and a fast producer never waits. A read
copies what changed, `CHUNK` vertices at a time; then the thread sleeps for `READ_SECONDS`, or for as long as the read
took if that is longer, which leaves half a core to the producer. After a change, another thread measures the turns,
finds the zones of the wall, the vertices interpolated between arms and how sure each radius is. For a long wall that
takes a second, and new vertices must not wait for it. The clearance of a string at all depths takes longer still, so
it waits for its turn; its clearance where it hangs now is found with each look.
"""

from __future__ import annotations

import atexit
import math
import pathlib
import tempfile
import threading
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from statistics import NormalDist
from typing import Any, Protocol

import numpy as np
import numpy.typing as npt

from helibore.base.arrays import Floats, Mask, column, distinct, joined, numbers, runs_of
from helibore.base.color_limits import percentile_limits, symmetric_limit, wall_limit
from helibore.base.colors import customary_map
from helibore.base.errors import InputError
from helibore.base.ranges import Range, union
from helibore.base.units import MILLIMETRE
from helibore.logs.curves import ScalarCurve, curves_of
from helibore.logs.kept_samples import columns_of_kept_samples
from helibore.logs.passage import SURER, Hanging, hanging_at, passage_of, without_noise
from helibore.logs.summary import summarize
from helibore.logs.zone_criteria import Criteria, median_enlargement
from helibore.logs.zones import LIKELY, Classification, Zone, classify
from helibore.samples.helix import basis_of, basis_text_of, helix_of
from helibore.settings.output_settings import RigidBody
from helibore.trajectory.references import Reference, reference_assumed, reference_of
from helibore.trajectory.survey import Path
from helibore.trajectory.true_depth import true_depth
from helibore.viewer.client import MOST_PENDING
from helibore.viewer.scene import FRAME_STEP, MOST_POINTS, Attribute, History, PathFrames, Scene, WallShape
from helibore.viewer.texels import NORMAL_95, Vertices

CHUNK = 1 << 17  # vertices written at a time; in between, the server may send values to pages
READ_SECONDS = 0.1  # least seconds of sleep after a read: a page gets at most ten updates a second of a growing hole
ZONES_SECONDS = 2.0  # least seconds of sleep after a search for zones
SHARE = 20  # the sleep is at least so many times the processor time of the search
STRING_SECONDS = 0.1  # seconds between two looks whether the string has moved
STRING_SHARE = 2  # the rest after its clearance is found is at least so many times the processor time of that
FEW_TURNS = 50  # turns; a shorter wall does not show which colours the whole hole needs
FIRST_DATE = 1e8  # seconds: a smaller time counts from the start of the run, not from 1970
BESIDE = 30.0  # degrees from the toolface of a breakout or key seat in which its height is
MOST_BACK = 1.0  # metres that samples may lie above earlier ones, as those of several sensors do
MOST_MESHED = 1_000_000  # vertices of a mesh that a page asks for
USUAL_LIMIT = 0.02  # metres: with fewer turns, the colours reach at least this far below and above bit radius
AHEAD = 100.0  # metres that a bit may be ahead of the wall and still have its true depth on the page


class ViewedWall(Protocol):
    """What the viewer reads of a wall: its shape and basis, copies of the ranges that changed, and its radii."""

    @property
    def settings(self) -> Any: ...
    @property
    def settled(self) -> int: ...
    @property
    def start_depth(self) -> float: ...
    @property
    def radius(self) -> Floats: ...
    def vertices(self, start: int, stop: int) -> Any: ...
    def __len__(self) -> int: ...


class Feed:
    """Keeps a scene equal to a wall. It reads the whole wall when made; after `start`, it reads what `update` notes.

    Raises InputError if the wall has no vertex or the viewer cannot draw it, if the wall reaches beyond ``path``, or if
    an attribute does not have one value for each vertex or quad.
    """

    def __init__(
        self, wall: ViewedWall, *, path: Path | None, attributes: Mapping[str | Attribute, npt.ArrayLike], well: str,
        scene: Scene | None = None, reference: Reference | None = None, criteria: Criteria | None = None,
        alarmed: Mapping[str, float] | None = None, string: Sequence[RigidBody] = (),
        last_scan: Callable[[Any], Any] | None = None,
    ) -> None:  # fmt: skip
        self.scene = scene or Scene()  # a scene that is served already: its pages wait for the wall to begin
        self.path = path
        self._wall = wall
        self._criteria = criteria  # of zones; None: the defaults of `Wall.zones`
        self._string = tuple(string)  # rigid bodies whose clearance the page shows
        self._last_scan = last_scan  # of a live wall: it by the last scan of each place, as which it is shown
        self._redrawn: tuple[Mask, Any] | None = None  # vertices so shown, and the wall that has their values
        self._alarmed = alarmed or {}  # by kind: the limit of median diameter - bit beyond which turns are zones, too
        if len(wall) == 0:
            raise InputError("the wall has no vertex yet", "append samples first")
        described = map(_attribute, attributes)
        named = {of: _column(of.name, values) for of, values in zip(described, attributes.values(), strict=True)}
        settings, helix = wall.settings, helix_of(wall)
        self._shape = WallShape(
            helix.sectors, helix.pitch, helix.start_depth, float(settings.bit_diameter), helix.start_toolface, well,
            tuple(named), basis_of(wall), basis_text_of(wall), reference or reference_of(wall), reference_assumed(wall),
        )  # fmt: skip
        self._settings = settings  # with which the scene's radii were computed: a live wall may find others
        self._first = first_vertex(wall)  # the wall and its changes count vertices from here, the scene from 0
        self._values = {attribute.name: values for attribute, values in named.items()}
        for name, values in self._values.items():
            self._check(name, values)
        self._check_path(path)
        self._changed = threading.Condition()
        self._ranges: list[Range] = []
        self._settled = 0
        self._new_path = False
        self._closed = threading.Event()
        self._threads: list[threading.Thread] = []
        self._zones: Classification | None = None
        self._ends = (math.nan, math.nan)  # depths of the wall's ends when its zones were found
        self._grown = threading.Event()  # the wall has changed since its zones were found, or they were never found
        self._grown.set()
        self._measured: tuple[Any, Floats | None] | None = None  # the wall whose zones were found last, and its sigma
        self._quiet: tuple[Any, Floats | None] | None = None  # the same without noise
        self._finding = threading.Lock()
        self._chosen: set[str] = set()  # quantities whose colour ranges are final
        self._logged = 0  # how often the logs were measured
        self._young = False  # the wall was short when it was first shown
        self.scene.begin(self._shape)
        limits = criteria or Criteria()
        self.scene.update_state(limits=(limits.washout, limits.elongation, limits.undergauge))
        self.scene.summarize, self.scene.write_logs, self.scene.path = self._summarize, self._write_logs, path
        if hasattr(wall, "surface"):
            self.scene.write_mesh = self._write_mesh
            self.scene.update_state(meshes=True)
        self._extend_path()
        self._choose_ranges()
        self._read([(0, len(wall))], wall.settled - self._first)
        if (grown := history_of(wall)) is not None:
            self.scene.history = grown

    def start(self) -> None:
        """Start the threads that read what `update` notes and find the zones. Both threads end before Python ends."""
        atexit.register(self.close)  # a thread that Python stops inside the core would abort the process
        for name, run in (("helibore-view-feed", self._run), ("helibore-view-zones", self._run_zones)):
            self._threads.append(threading.Thread(target=run, name=name, daemon=True))
            self._threads[-1].start()

    @property
    def alive(self) -> bool:
        """Whether the threads are running."""
        return bool(self._threads) and all(thread.is_alive() for thread in self._threads)

    def update(self, change: Any = None, attributes: Mapping[str, npt.ArrayLike] | None = None) -> None:
        """Note what an append changed; if ``change`` is None, the whole wall is read and compared.

        ``attributes`` are columns of the whole wall, of which only the changed parts are read.
        """
        columns = {name: self._checked(name, values) for name, values in (attributes or {}).items()}
        first = self._first
        whole = (first, first + len(self._wall))
        ranges, settled = ([whole], self._wall.settled) if change is None else (change.ranges, change.settled)
        before = self._shape.sectors + 1 if columns else 0  # vertices from a quad's first corner to its last
        with self._changed:
            self._values |= columns
            for start, stop in ranges:
                part = max(0, int(start) - first - before), int(stop) - first
                self._ranges = union([*self._ranges, part], MOST_PENDING)
            self._settled = int(settled) - first
            self._changed.notify_all()

    def look_again(self) -> None:
        """Find zones and clearances again: ``last_scan`` has other samples, though the wall has not changed."""
        self._grown.set()

    def set_path(self, path: Path | None) -> None:
        """Place the wall along another path; pages receive the frames of the path, but not the wall again."""
        self._check_path(path)
        with self._changed:
            self.path = self.scene.path = path
            self._new_path = True
            self._changed.notify_all()

    def set_attribute(self, name: str, values: npt.ArrayLike) -> None:
        """Replace an attribute's values: one for each quad or vertex.

        There may be fewer values if the wall has grown since they were made; other quads then keep their values.
        """
        array = self._checked(name, values, shorter=True)
        with self._changed:
            self._values[name] = array
            self._ranges = [(0, len(self._wall))]
            self._changed.notify_all()

    def close(self) -> None:
        """Stop the threads."""
        atexit.unregister(self.close)
        self._closed.set()
        self._grown.set()
        with self._changed:
            self._changed.notify_all()
        for thread in self._threads:
            thread.join()
        self._threads = []

    def _run(self) -> None:
        while True:
            with self._changed:
                self._changed.wait_for(lambda: self._ranges or self._new_path or self._closed.is_set())
                if self._closed.is_set():
                    return
                ranges, self._ranges = self._ranges, []
                settled, new_path, self._new_path = self._settled, self._new_path, False
            began = time.monotonic()
            if new_path:
                self._extend_path(again=True)
            if ranges:
                self._extend_path()
                self._read(ranges, settled)
                self._grown.set()
            self._closed.wait(max(READ_SECONDS, time.monotonic() - began))

    def _run_zones(self) -> None:
        zones_due = string_due = hang_due = 0.0
        stale = False  # the clearance of the string at all depths is that of an earlier wall
        hung: object = None  # the wall, and where the string was, when its clearance was found
        while True:
            self._grown.wait(STRING_SECONDS if self._string else None)
            if self._closed.is_set():
                return
            began = time.thread_time()
            if self._grown.is_set() and time.monotonic() >= zones_due:
                self._grown.clear()
                self._find_zones()
                stale = True
                zones_due = time.monotonic() + max(ZONES_SECONDS, SHARE * (time.thread_time() - began))
            began = time.thread_time()
            here = id(self._measured), round(self.scene.state.bit_depth, 2)
            if here != hung and time.monotonic() >= hang_due:
                self.find_clearance_of_bodies()
                hung, hang_due = here, time.monotonic() + STRING_SHARE * (time.thread_time() - began)
            began = time.thread_time()
            if stale and time.monotonic() >= string_due:
                self._find_clearance()
                stale, string_due = False, time.monotonic() + SHARE * (time.thread_time() - began)
            if self._grown.is_set():
                rest = zones_due - time.monotonic()
                self._closed.wait(max(0.0, min(rest, STRING_SECONDS) if self._string else rest))

    def _read(self, ranges: list[Range], settled: int) -> None:
        if (settings := self._wall.settings) != self._settings:
            self._settings, ranges = settings, [(0, len(self._wall))]
            self.scene.redraw()
        for start, stop in ranges:
            for first in range(start, min(stop, len(self._wall)), CHUNK):
                last = min(first + CHUNK, stop, len(self._wall))
                read = self._wall.vertices(self._first + first, self._first + last)
                values = {name: column[first:last] for name, column in self._values.items()}
                radius, nearest, support = self._as_shown(first, read.radius, read.nearest, read.support)
                self.scene.write(first, Vertices(radius, nearest, support, read.provisional), values)
        self.scene.settle(settled)
        self._choose_ranges()

    def _choose_ranges(self) -> None:
        """Choose the ends of the colours from the whole wall.

        The ends for the radius are final once the wall has `FEW_TURNS` turns; the ends for an attribute are final once
        it has as many values as these turns have vertices.
        """
        few, ranges = FEW_TURNS * self._shape.sectors, dict(self.scene.state.ranges)
        if "over" not in self._chosen:
            read = self._wall.vertices(self._first, self._first + len(self._wall))
            bit = self._shape.bit_diameter / 2
            self._young |= len(read.radius) < few
            limit = wall_limit(read.radius - bit, self._shape.sectors, self._shape.pitch, MILLIMETRE)
            limit = max(limit, USUAL_LIMIT if self._young else 0.0)
            nearest = symmetric_limit(numbers(read.nearest), MILLIMETRE)
            ranges |= {"over": (-limit, limit), "radius": (bit - limit, bit + limit), "nearest": (0.0, nearest)}
            self._chosen |= {"over"} if len(read.radius) >= few else set()
        for attribute in self._shape.attributes:
            if attribute.name in self._chosen:
                continue
            values = self._values[attribute.name]
            values = values[np.isfinite(values)]
            if limits := _limits(attribute, values):
                ranges[attribute.name] = limits
                self._chosen |= {attribute.name} if values.size >= few else set()
        if ranges != self.scene.state.ranges:
            self.scene.update_state(ranges=ranges)

    def find_zones(self) -> None:
        """Find zones, interpolated vertices, logs and clearance of the present wall, and set them in the scene."""
        self._find_zones()
        self._find_clearance()

    def _find_zones(self) -> None:
        if self._shape.basis == "gauge" or len(self._wall) < self._shape.sectors:
            return
        wall: Any = getattr(self._wall, "_state", lambda: self._wall)()  # a frozen copy, whose gaps are found only once
        if self._last_scan is not None:
            wall = self._show_last_scan(wall, self._last_scan(wall))
        with self._finding:
            found = self._classify(wall)
        measured = getattr(wall, "measured", None) if self._shape.basis == "azimuthal" else None
        sigma = None if measured is None else _sigma_of(wall)
        if measured is not None:
            self.scene.set_trust(np.isfinite(wall.radius) & ~measured, sigma)
        self._measured = self._quiet = wall, sigma
        if self._string and sigma is not None and hasattr(wall, "sample_columns"):
            self._quiet = replace(wall, radius=without_noise(wall.radius, sigma, self._shape.sectors)), SURER * sigma
        zones: list[dict[str, Any]] = []
        for zone in found.zones:
            place = {"kind": zone.kind, "start": round(zone.start, 3), "stop": round(zone.stop, 3)}
            size = {"measure": round(zone.measure, 5), "severity": round(zone.severity, 3)}
            sure = {"confidence": round(zone.confidence, 6), "measured": _share(zone.coverage)}
            side = {} if math.isnan(zone.toolface) else {"toolface": round(zone.toolface, 1)}
            turn, is_slot = int((zone.peak - self._shape.start_depth) / self._shape.pitch), zone.kind == "key seat"
            error = self._error(sigma, turn, zone.toolface, 360 if is_slot else 180)
            error = error / 2.0 if is_slot else error  # its measure is a height, those of the others are diameters
            reach = NORMAL_95 * error
            if is_slot and math.isfinite(deepest := self._deepest(wall, zone)):
                reach = max(reach, abs(deepest - zone.measure))
            within = {"within": round(reach, 5)} if math.isfinite(error) else {}
            zones.append(place | size | within | sure | side)
        zones = sorted(zones + list(self._alarmed_zones(wall, found, sigma)), key=lambda zone: float(zone["start"]))
        with self.scene.lock:  # zones and curves reach a page in one message
            self.scene.update_state(zones=tuple(zones), zones_to=round(self._ends[1], 2))
            if len(found.logs):
                self._logged += 1
                self.scene.set_curves(curves_of(found.logs), self._logged)
                self.scene.update_state(shape=found.logs.shape)

    def _show_last_scan(self, wall: Any, last: Any) -> Any:
        """Show the vertices that have other values by the last scan of each place; return the wall by it."""
        before = self._redrawn
        differs = _unequal(last.radius, wall.radius)
        self._redrawn = (differs, last) if differs.any() else None
        changed = differs.copy()
        if before is not None:
            known = before[0].size
            same = differs[:known] & before[0] & ~_unequal(last.radius[:known], before[1].radius)
            changed[:known] = (differs[:known] | before[0]) & ~same
        if changed.any():
            with self._changed:
                self._ranges = union([*self._ranges, *((int(a), int(b)) for a, b in runs_of(changed))], MOST_PENDING)
                self._changed.notify_all()
        return last

    def _as_shown(self, first: int, *columns: Any) -> list[Any]:
        """Return columns of vertices from ``first`` on; of those that the last scan shows otherwise, its values."""
        if (redrawn := self._redrawn) is None:
            return list(columns)
        differs, wall = redrawn
        of = np.flatnonzero(differs[first : first + len(columns[0])])
        shown = []
        for values, name in zip(columns, ("radius", "nearest", "support"), strict=True):
            shown.append(values.copy())
            shown[-1][of] = getattr(wall, name)[first + of]
        return shown

    def _error(self, sigma: Floats | None, turn: int, toolface: float = math.nan, period: int = 360) -> float:
        """Return the standard uncertainty of a diameter of a turn, if its radii err together; NaN: not known.

        With a ``toolface``, it is that of the radii beside it, and each ``period`` of degrees from it.
        """
        if sigma is None:
            return math.nan
        K = self._shape.sectors
        errors = sigma[turn * K : (turn + 1) * K]
        if math.isfinite(toolface):
            away = self._shape.start_toolface + np.arange(errors.size) * 360 / K - toolface
            errors = errors[abs((away + period / 2) % period - period / 2) <= BESIDE]
        errors = errors[np.isfinite(errors)]
        return float(2.0 * np.median(errors)) if errors.size else math.nan

    def _deepest(self, wall: Any, zone: Zone) -> float:
        """Return how deep the samples show a key seat to be, metres; NaN: not known.

        A wall is smoother than its samples: a slot as wide as the gaps between them may have half its depth. The second
        largest radius counts, since one may be a spike, over that of the hole beside the slot.
        """
        depth, _, radius = columns_of_kept_samples(wall) or (np.empty(0),) * 3
        radii = np.sort(radius[slice(*np.searchsorted(depth, (zone.start, zone.stop)).tolist())])
        radii = radii[np.isfinite(radii)]
        return float(radii[-2] - radii[radii.size // 4]) if radii.size > 1 else math.nan

    def _alarmed_zones(self, wall: Any, found: Classification, sigma: Floats | None) -> Iterator[dict[str, Any]]:
        """Yield the turns that a live alarm names and no zone of the same kind has, because they are few or oval.

        Their confidence is the probability that the worst of them is beyond the limit of the alarm.
        """
        if not self._alarmed:
            return
        sectors, join = self._shape.sectors, (self._criteria or Criteria()).join
        over = median_enlargement(numbers(wall.radius), sectors, self._shape.bit_diameter)
        for kind, limit in self._alarmed.items():
            beyond = over > limit if kind == "washout" else over < limit
            for first, last in joined(runs_of(beyond), int(join / abs(self._shape.pitch))):
                start, stop = sorted(self._shape.start_depth + turn * self._shape.pitch for turn in (first, last))
                if any(of.kind == kind and of.start < stop and of.stop > start for of in found.zones):
                    continue
                turn = first + int(np.nanargmax(over[first:last] * (1 if kind == "washout" else -1)))
                measure = float(over[turn])
                error = self._error(sigma, turn)
                beyond_by = abs(measure) - abs(limit)
                confidence = round(NormalDist(0, max(error, 1e-6)).cdf(beyond_by), 6) if error >= 0.0 else LIKELY
                size = {"measure": round(measure, 5), "severity": round(measure / limit, 3) if limit else 1.0}
                sure = {"confidence": confidence, "measured": _share(float(found.logs.coverage[first:last].mean()))}
                within = {"within": round(NORMAL_95 * error, 5)} if error >= 0.0 else {}
                yield {"kind": kind, "start": round(start, 3), "stop": round(stop, 3)} | size | within | sure

    def _find_clearance(self) -> None:
        """Set the string's clearance, at each depth of its lower end, in the scene."""
        if not self._string or self._measured is None:
            return
        wall, sigma = self._measured
        try:
            found = passage_of(wall, self._string, sigma)
        except InputError as error:  # longer than the wall, or no shape was measured
            self._hang(why=str(error))
            return
        lower = found.depth + found.length / 2
        columns = {"Clearance": found.clearance, "Clearance low": found.low, "Clearance high": found.high}
        columns |= {"Tightest above bit": lower - found.contact_depth[:, 0]}
        lower, columns = self._to_the_end(wall, sigma, lower, columns)
        order = np.argsort(lower, kind="stable")
        self._logged += 1
        curves = (ScalarCurve(name, "m", lower[order], values[order]) for name, values in columns.items())
        self.scene.set_curves(curves, self._logged)
        self._hang(why="")

    def _to_the_end(
        self, wall: Any, sigma: Floats | None, lower: Floats, columns: dict[str, Floats]
    ) -> tuple[Floats, dict[str, Floats]]:
        """Return depths of the string's lower end and columns at them as far as the wall reaches.

        `passage_of` leaves out what lies beside the last turns, of which one is not whole.
        """
        end = self._ends[1]
        kept = (lower < end - 3 * abs(self._shape.pitch)) | np.isfinite(columns["Clearance"])
        last = [float(each) for each in lower[~kept & (lower < end)]]
        places = [*sorted(last), end]
        sampled = getattr(wall, "sampled", None)
        found = [hanging_at(wall, self._string, place, sampled, sigma) for place in places]
        rows = [
            (one.clearance, one.low, one.high, place - one.depth) if one and not one.at_most else (math.nan,) * 4
            for place, one in zip(places, found, strict=True)
        ]
        more = np.array(rows).T
        joined = {name: np.append(of[kept], new) for (name, of), new in zip(columns.items(), more, strict=True)}
        return np.append(lower[kept], places), joined

    def find_clearance_of_bodies(self) -> None:
        """Set the clearance of each body of the string where it is now, as far as hole is measured beside it.

        While hole is drilled, the sensor is behind the bit. If the end of the measured hole is above a body, its
        clearance is that ``short`` metres higher, where this body was last in measured hole.
        """
        bit = self.scene.state.bit_depth
        if not self._string or self._measured is None or not math.isfinite(bit) or self._shape.basis != "azimuthal":
            return
        self._hang(hanging=[self._hanging(number, bit) for number in range(len(self._string))], bit=round(bit, 2))

    def _hanging(self, number: int, bit: float) -> dict[str, Any]:
        """Return name and clearance of a body where it hangs now, for JSON; without numbers if no hole is measured."""
        body = self._string[number]
        name = {"name": body.name or ("bit" if body.position == 0 else f"body {number + 1}")}
        short = max(0.0, bit - body.position - self._ends[1])
        found = self._clearance(bit - short, body)
        if found is None:
            return name
        size = {"clearance": found.clearance, "low": found.low, "high": found.high, "depth": found.depth}
        numbers = {name: round(value, 5) if math.isfinite(value) else None for name, value in size.items()}
        return {**name, **numbers, "at_most": found.at_most, "short": round(short, 2)}

    def _clearance(self, lower_end: float, body: RigidBody) -> Hanging | None:
        """Return the clearance of a body where the string's lower end is at a depth; None: not known."""
        if self._quiet is None:
            return None
        wall, sigma = self._quiet
        return hanging_at(wall, [body], lower_end, getattr(wall, "sampled", None), sigma)

    def _hang(self, **changes: Any) -> None:
        bodies = [[body.diameter, body.length, body.position] for body in self._string]
        string = {"why": "", **(self.scene.state.string or {}), "bodies": bodies, **changes}
        if string != self.scene.state.string:
            self.scene.update_state(string=string)

    def _classify(self, wall: Any) -> Classification:
        """Measure the turns of a wall and find its zones."""
        self._ends = helix_of(wall).ends(len(wall.radius))
        self._zones = classify(wall, self._criteria, picks=())  # a page leaves out those at its picks, which may change
        return self._zones

    def _summarize(self, start: float, stop: float) -> dict[str, Any]:
        """Return the figures of `Wall.summary` that the page shows of a section; a missing number is None.

        The wall grows on after its turns are measured. So the figures, and ``start`` and ``stop`` among them, are those
        of the part of the section that the wall had when its turns were measured.
        """
        zones, (top, bottom) = self._present_zones()
        with self.scene.lock:
            zones = zones.without(self.scene.picks)
        start, stop = (min(max(end, top), bottom) for end in (start, stop))
        wall = self._wall if self._redrawn is None else self._redrawn[1]
        summary = summarize(wall, start, stop, zones=zones)
        names = ("start", "stop", "volume", "excess", "whole_turns", "incomplete_turns", "washed_out", "without_radius")
        values = {name: float(getattr(summary, name)) for name in (*names, "coverage", "mean_diameter")}
        values |= {name: getattr(summary, name).value for name in ("least_diameter", "greatest_diameter")}
        found: dict[str, Any] = {name: value if math.isfinite(value) else None for name, value in values.items()}
        if summary.ranged:  # numbers would be surer than the samples
            found |= {"volume_text": summary.volume_text(), "excess_text": summary.excess_text()}
        return found | {"unmeasured_shape": zones.logs.unmeasured_shape}

    def _present_zones(self) -> tuple[Classification, tuple[float, float]]:
        """Return the newest zones, and the ends of the wall when they were found."""
        with self._finding:  # waits while the other thread finds zones
            return self._zones or self._classify(self._wall), self._ends

    def _write_logs(self, start: float, stop: float) -> bytes:
        """Return the logs of the turns between two depths as a LAS file; raise InputError if there is no full turn."""
        logs = self._present_zones()[0].logs.between(start, stop)
        with tempfile.TemporaryDirectory() as folder:
            file = pathlib.Path(folder) / "section.las"
            logs.save(file)
            return file.read_bytes()

    def _write_mesh(self, start: float, stop: float) -> bytes:
        """Return the surface between two depths as a GLB file; raise InputError if it is long or not in the wall."""
        if (stop - start) / abs(self._shape.pitch) * self._shape.sectors > MOST_MESHED:
            raise InputError("section", f"has more than {MOST_MESHED:,} vertices: show less, or use helibore mesh")
        wall: Any = self._wall
        with tempfile.TemporaryDirectory() as folder:
            file = pathlib.Path(folder) / "section.glb"
            wall.surface(self.path, start, stop).save(file)
            return file.read_bytes()

    def _extend_path(self, *, again: bool = False) -> None:
        level = self.scene.levels[0]
        have = 0 if again else len(self.scene.frames.centre)
        need = frame_count(self._shape, max(len(self._wall), level.size), level.rows)
        if need > have:
            self.scene.set_frames(have, frames_on_path(self._shape, self.path, have, need))
        depths = true_depth(self.path, None)
        known = None if depths is None else (depths.path.start_depth, depths.path.stop_depth, depths.down)
        if known != self.scene.state.true_depth:
            self.scene.update_state(true_depth=known)

    def _checked(self, name: str, values: npt.ArrayLike, shorter: bool = False) -> Floats:
        if name not in self._values:
            raise InputError(f"attribute {name}", "was not named when the viewer was made")
        array = _column(name, values)
        if not (shorter and len(array) <= len(self._wall)):
            self._check(name, array)
        return array

    def _check(self, name: str, values: Floats) -> None:
        n, K = len(self._wall), self._shape.sectors
        if len(values) not in (n, max(0, n - K - 1)):
            rule = f"must be one value for each of {n} vertices or {max(0, n - K - 1)} quads"
            raise InputError(f"attribute {name} has shape {values.shape}", rule)

    def _check_path(self, path: Path | None) -> None:
        if path is None:
            return
        end = self._shape.start_depth + (len(self._wall) - 1) * self._shape.pitch / self._shape.sectors
        top, bottom = sorted((self._shape.start_depth, end))
        if top < path.start_depth - 1e-9 or bottom > path.stop_depth + 1e-9:
            wall, ends = f"from {top:.2f} to {bottom:.2f} m", f"from {path.start_depth:.2f} to {path.stop_depth:.2f} m"
            how = []
            if top < path.start_depth - 1e-9:
                how.append(f"the survey needs a station at {top:.2f} m or above, or the wall must start deeper")
            if bottom > path.stop_depth + 1e-9:
                how.append("extend the path, or give a longer survey")
            raise InputError(f"the wall lies {wall}, the path {ends}", "; ".join(how))


def first_vertex(wall: ViewedWall) -> int:
    """Return the number of a wall's first vertex: 0, or `Settings.first_vertex` of a part of a helix."""
    return int(getattr(wall.settings, "first_vertex", 0))


def history_of(wall: Any) -> History | None:
    """Return how long a wall was at the times of its samples; None without dates, or if it was measured again.

    Where a later pass measured the hole again, the radii of an earlier moment are not those of the wall.
    """
    samples, helix = getattr(wall, "samples", None), helix_of(wall)
    if samples is None or samples.time is None or not samples.time.size or helix.pitch < 0:
        return None
    order = np.argsort(samples.time, kind="stable")
    time, depth = samples.time[order], samples.depth[order]
    deepest = np.maximum.accumulate(depth)
    if time[0] < FIRST_DATE or (deepest - depth).max() > MOST_BACK:
        return None
    vertices = np.clip((deepest - helix.start_depth) / helix.pitch * helix.sectors + 1, 1, len(wall)).astype(np.int64)
    history = History()
    for row in distinct(np.linspace(0, time.size - 1, min(time.size, MOST_POINTS)).astype(np.int64)).tolist():
        history.note(float(time[row]), int(vertices[row]), float(deepest[row]))
    return history


def _share(value: float) -> float | None:
    """Return a share for JSON; None if it is not known, as of a wall whose shape is assumed."""
    return round(value, 3) if math.isfinite(value) else None


def _sigma_of(wall: Any) -> Floats | None:
    """Return the standard uncertainty of each radius, metres; None for a wall that cannot state it."""
    try:
        sigma: Floats | None = getattr(wall, "sigma", None)
    except InputError:  # too few samples, or the archive has none
        return None
    return sigma


def frame_count(shape: WallShape, vertices: int, rows: int) -> int:
    """Return how many frames a wall needs up to the end of its last tile, and for a bit that is `AHEAD` of it."""
    tile = rows * shape.sectors
    span = (-(-max(vertices, 1) // tile) * tile + shape.sectors + 1) * abs(shape.pitch) / shape.sectors + AHEAD
    return math.ceil(span / FRAME_STEP) + 2


def frames_on_path(shape: WallShape, path: Path | None, first: int, stop: int) -> PathFrames:
    """Return the path frames [first, stop); beyond its ends the path is extended straight.

    The page places a wall point itself: centre + R (cos(toolface) high + sin(toolface) right), linear between frames.
    Without a path the hole is straight and vertical below (0, 0), toolface 0 to the north.
    """
    depth = shape.start_depth + np.arange(first, stop) * np.copysign(FRAME_STEP, shape.pitch)
    count = len(depth)
    if path is None:
        centre = np.column_stack([np.zeros(count), np.zeros(count), depth])
        north, east = (np.tile(axis, (count, 1)) for axis in ([1.0, 0.0, 0.0], [0.0, 1.0, 0.0]))
        return PathFrames(centre, north, east, surveyed=False)
    inside = np.clip(depth, path.start_depth, path.stop_depth)
    frame = path.frame(inside)
    beyond = (depth - inside)[:, None] * frame[:, 2]
    return PathFrames(path.position(inside) + beyond, frame[:, 0], frame[:, 1], north=path.survey.north)


def _attribute(key: str | Attribute) -> Attribute:
    """Return the attribute that ``key`` is or names; if it has no colour map, it gets the default one."""
    attribute = key if isinstance(key, Attribute) else Attribute(key)
    return replace(attribute, color_map=attribute.color_map or customary_map(attribute.name, attribute.unit))


def _column(name: str, values: Any) -> Floats:
    """Return an attribute's values as a column; truth values become 0 and 1."""
    if getattr(values, "dtype", None) == np.bool_:
        values = values.astype(np.float64)
    return column(f"attribute {name}", values)


def _limits(attribute: Attribute, values: Floats) -> tuple[float, float] | None:
    """Return the ends of an attribute's colours; None while it has no value."""
    if attribute.low is not None and attribute.high is not None:
        return attribute.low, attribute.high
    values = values[values > 0] if attribute.log else values
    if not values.size:
        return None
    if attribute.color_map == "difference":
        limit = symmetric_limit(values, MILLIMETRE)
        return -limit, limit
    low, high = float(values.min()), float(values.max())
    if np.percentile(values, 2) < np.percentile(values, 98):
        low, high = percentile_limits(values, log=attribute.log)
    margin = 0.0 if low < high else 1e-3 * (low if attribute.log else max(abs(low), 1.0))  # above 0 on a log scale
    return low - margin, high + margin


def _unequal(one: Floats, other: Floats) -> Mask:
    """Return where two columns differ; two missing values do not."""
    unequal: Mask = (one != other) & ~(np.isnan(one) & np.isnan(other))
    return unequal
