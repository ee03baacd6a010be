"""Decide what a picture of a wall shows: interval, scale, tracks, cross sections, shaded body; the same on all papers.

    Drawing (options, checked)  +  Wall  ->  Content (tracks with their colours, limits shared by every page)

The colour scale of an image is that of the whole image, as on the viewer's page: percentiles 2 to 98, logarithms for
resistivity, or a sliding window (dynamic). The colour scale of the radius is that of the whole wall, centred on bit
size.
"""

from __future__ import annotations

import io
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from string import ascii_uppercase
from typing import TYPE_CHECKING, Annotated

import numpy as np

from helibore.base.arrays import Array, Floats
from helibore.base.cached import cached_property
from helibore.base.color_limits import over_bit, wall_limit
from helibore.base.colors import ColorScale, customary_map
from helibore.base.errors import InputError
from helibore.base.units import MILLIMETRE, size_text
from helibore.images.normalization import above_zero, image_scale, sliding_window
from helibore.images.sector_image import SectorImage
from helibore.logs.curves import ScalarCurve, curves_of, nice_limits
from helibore.logs.intervals import tracks_of
from helibore.logs.picks import PLANES, Pick
from helibore.logs.summary import WallSummary, summarize
from helibore.logs.turn_logs import Logs, turn_logs
from helibore.logs.volume_ticks import VolumeTicks, volume_ticks
from helibore.logs.zones import classify
from helibore.plot.cross_sections import CrossSection, sections_at, telling_depths
from helibore.plot.depth_scales import FEET, METRES, DepthUnit, Lines, usual_depth_scale
from helibore.plot.diameters import diameters
from helibore.plot.hatching import mostly_interpolated
from helibore.plot.interval_tracks import IntervalTrack
from helibore.plot.picked import DipTrack, draw_picks
from helibore.plot.raster import at_points
from helibore.plot.solid import Stretched, most_relief, turns_between
from helibore.plot.tracks import (
    LENGTHS,
    SIDES,
    CaliperTrack,
    DepthTrack,
    ImageTrack,
    PlacedTrack,
    ScalarTrack,
    Shown,
)
from helibore.samples.helix import helix_of
from helibore.settings.declared import METRES as IN_METRES
from helibore.settings.print_settings import Look, PrintSettings
from helibore.settings.template import Template
from helibore.settings.zone_settings import Criteria
from helibore.trajectory.references import Reference, reference_of
from helibore.trajectory.true_depth import true_depth
from helibore.wall.uncertainty import NORMAL_95
from helibore.wall.wall import Wall

if TYPE_CHECKING:
    from helibore.logs.zones import Classification
    from helibore.plot.diameters import Diameters
    from helibore.trajectory.survey import Path
    from helibore.wall.state import WallState

RADIUS = "Radius"
RADIUS_TITLE = "Over bit radius"
REFERENCES = tuple(reference for reference in SIDES if reference)
ROOM = 192.0
"""Width of A4 that is free for the tracks and the gap of 2 after each of them, millimetres."""
NARROW_CURVE, NARROW_IMAGE = 15.0, 24.0
"""Least widths of the track of a curve and of an image, millimetres, unless a template states a width."""


@dataclass(frozen=True, kw_only=True)
class Drawing(PrintSettings):
    """The options of a drawing."""

    title: Annotated[str, "Title of the header, the well."] = ""
    subtitle: Annotated[str, "The line below the title."] = ""
    header: Annotated[Mapping[str, str], "Further entries of the header: company, field, date, mud ..."] = field(
        default_factory=dict
    )
    scalars: Annotated[Sequence[ScalarCurve], "Curves along the hole, each a track of its own."] = ()
    start: Annotated[float | None, IN_METRES, "Where the drawing starts. None: the top of the wall."] = None
    stop: Annotated[float | None, IN_METRES, "Where the drawing stops. None: the bottom of the wall."] = None
    looks: Annotated[Mapping[str, Look],
        '`Look` by name of an image; "Radius" is that of the radius.',
    ] = field(default_factory=dict)  # fmt: skip
    reference: Annotated[Reference | None,
        "What toolface 0 is. None: as the wall's path states or, without a path, its images; without both, the picture "
        "says that toolface 0 is not known.",
    ] = None  # fmt: skip
    template: Annotated[Template | None,
        "Tracks, their order and widths; the unit and scale of the template are not used here. None: all tracks.",
    ] = None  # fmt: skip
    beside: Annotated[Mapping[str, Wall],
        "Other walls by name (wells, or passes of the same well), drawn at the same depths to the right of the tracks. "
        "Their calipers have the scale of the first wall, and their radii have its colours. If ``start`` and ``stop`` "
        "are None, the interval holds all walls.",
    ] = field(default_factory=dict)  # fmt: skip
    picture: Annotated[bytes, "PNG of the wall as the page shows it in 3-D, drawn below the tracks."] = b""
    with_picks: Annotated[bool, "Whether the picks of the wall are drawn."] = True
    criteria: Annotated[Criteria | None,
        "Criteria of the zones of the wall. None: the defaults. Zones of the walls in ``beside`` are not drawn.",
    ] = None  # fmt: skip

    @property
    def size_unit(self) -> str:
        """Unit of diameters: ``"in"`` or ``"mm"``."""
        return "mm" if self.unit == "mm" else "in"

    @property
    def depth_unit(self) -> DepthUnit:
        """Unit of depths."""
        return FEET if self.unit == "ft" else METRES


@dataclass(frozen=True)
class Body:
    """Colours of the shaded body: a scale, the values (one for each vertex of the body), and the name of the values."""

    scale: ColorScale
    values: Floats
    name: str


@dataclass(frozen=True)
class Content:
    """All that is drawn of a wall; made by `content_of`."""

    wall: Wall
    drawing: Drawing
    top: float
    bottom: float
    scale: int
    lines: Lines
    tracks: list[PlacedTrack]
    turns: Diameters
    zones: Classification
    sections: list[CrossSection]
    stretched: Stretched | None
    bodies: list[Body]
    reference: str
    interpolated: Floats | None

    def summary(self, start: float | None = None, stop: float | None = None) -> WallSummary:
        """Return the summary of the interval, or of a part of it."""
        ends = (self.top if start is None else start, self.bottom if stop is None else stop)
        return summarize(self.state, *ends, zones=self.zones)

    @property
    def picks(self) -> Sequence[Pick]:
        """The picks that are drawn."""
        return _picks(self.wall, self.drawing)

    @cached_property
    def state(self) -> WallState:
        """The wall as `WallState`, whose samples are thus copied only once."""
        return self.wall._state()

    @cached_property
    def picture(self) -> Array:
        """The pixels of `Drawing.picture`."""
        from matplotlib.image import imread

        return imread(io.BytesIO(self.drawing.picture), format="png")

    @property
    def hatching(self) -> str:
        """The words for what the hatching means; "" if nothing is hatched."""
        between = " between arms" if self.zones.logs.shape == "arms" else ""
        return "" if self.interpolated is None else f"interpolated{between}"

    @property
    def ticks_text(self) -> str:
        """The words for the ticks of volume: totals, uncertainty, measured share; "" without ticks."""
        texts = []
        for track in self.tracks:
            for ticks, right in track.ticks if isinstance(track, CaliperTrack) else ():
                name = f"annulus of {size_text(self.drawing.casing or 0.0)}, right" if right else "hole, left"
                sigma = f" ± {ticks.sigma:.3f}" if math.isfinite(ticks.sigma) else ""
                lost = f", without {ticks.missing:.1f} m" if ticks.missing else ""
                texts.append(f"{name}: {ticks.total:,.3f}{sigma} m³{lost}")
                share = f"{100 * ticks.coverage:.1f} % measured"
        if not texts:
            return ""
        logs = self.zones.logs
        deepest = self.drawing.depth_unit.text(float(logs.depth.max()) + 0.5 * logs.height)
        unsure = " (± at most one standard uncertainty)" if " ± " in texts[0] else ""
        up = f"each {self.drawing.ticks:g} m³ from {deepest} {self.drawing.depth_unit.name} up"
        return f"Ticks {up}; {'; '.join(texts)}{unsure}; {share}"

    @property
    def letters(self) -> str:
        """A letter for each cross section, from A."""
        return ascii_uppercase[: len(self.sections)]

    def paper_length(self) -> float:
        """Return the length of paper, in millimetres, that the interval takes."""
        return (self.bottom - self.top) * 1000.0 / self.scale


def _picks(wall: Wall, drawing: Drawing) -> Sequence[Pick]:
    return wall.picks if drawing.with_picks else ()


def content_of(wall: Wall, drawing: Drawing) -> Content:
    """Return what a picture of a wall shows, from the options of the drawing."""
    if len(wall) < wall.settings.sectors:
        raise InputError("a picture needs a full turn of the wall", f"it has {len(wall)} vertices")
    top, bottom = _interval(wall, drawing)
    scale = drawing.scale or usual_depth_scale(bottom - top)
    logs = turn_logs(state := wall._state(), sigma=_sigma(wall, last_turn=True))
    zones = classify(state, drawing.criteria, logs, _picks(wall, drawing))
    turns = diameters(wall, zones.logs)
    reference = _reference(wall, drawing)
    images = _images(wall, drawing, reference)
    shown = [_shown(image, drawing.looks.get(image.name, Look()), top, bottom) for image in images]
    turned = [_turned(image, values, wall.path, reference) for image, (_, values) in zip(images, shown, strict=True)]
    pairs = [(image, (how, image.values)) for image, (how, _) in zip(turned, shown, strict=True)]
    tracks: list[PlacedTrack] = [
        DepthTrack(scale, true_depth(wall.path, drawing.elevation), zones.zones, drawing.depth_unit)
    ]
    tracks += [
        IntervalTrack(name, intervals, top, bottom, drawing.size_unit)
        for name, intervals in sorted(tracks_of(wall.intervals).items(), key=lambda track: track[0] != "")
    ]
    others = [_Other.of(name, one) for name, one in drawing.beside.items()]
    limits = _diameter_limits([(wall, turns), *((one.wall, one.turns) for one in others)], top, bottom, drawing)
    if wall.basis != "gauge":
        caliper = _caliper(wall, turns, limits, drawing, reference)
        caliper.ticks = _ticks(zones.logs, drawing)
        tracks.append(caliper)
    scalars = [ScalarTrack(curve, top, bottom) for curve in drawing.scalars]
    picks = [pick for pick in _picks(wall, drawing) if top <= pick.depth <= bottom]
    dips: list[PlacedTrack] = (
        [DipTrack(picks, wall.path, reference)] if any(pick.kind in PLANES for pick in picks) else []
    )
    bit_diameter = wall.settings.bit_diameter
    seen = [pick for pick in _picks(wall, drawing) if pick.reaches(top, bottom, bit_diameter)]
    ink = partial(draw_picks, picks=seen, left=drawing.left, bit_diameter=bit_diameter)
    calipers = [one.caliper(limits, drawing) for one in others]
    sure = _uncertainty(wall, top, bottom, drawing.size_unit)
    count = len(images) + (sure is not None) + sum(one.basis == "azimuthal" for one in (wall, *drawing.beside.values()))
    room = ROOM - sum(track.width + 2.0 for track in [*tracks, *dips, *calipers]) - 2.0 * count
    for track in scalars:  # curves get narrower first, then images; pages then narrow all tracks, rolls are wider
        track.width = min(track.width, max(NARROW_CURVE, (room - NARROW_IMAGE * count) / len(scalars) - 2.0))
    tracks += scalars
    room -= sum(track.width + 2.0 for track in scalars)
    width = min(130.0, max(NARROW_IMAGE, room / max(count, 1)))
    radius = _radius(wall, drawing.looks.get(RADIUS, Look()), top, bottom, drawing.size_unit)
    helix = (wall.settings, wall.start_depth)
    interpolated = None
    if wall.basis == "azimuthal":
        between = np.isfinite(wall.radius) & ~wall.measured
        interpolated = between.astype(np.float64) if between.any() else None
        if interpolated is not None:
            mostly = mostly_interpolated(interpolated, wall.settings.sectors)[: turns.depth.size]
            caliper.between = mostly if wall.settings.pitch > 0 else mostly[::-1]
        tracks.append(ImageTrack(radius[0], (helix, radius[1]), reference, drawing.left, width, interpolated, ink))
        if sure is not None:
            tracks.append(ImageTrack(sure[0], (helix, sure[1]), reference, drawing.left, width))
    for image, (how, values) in pairs:
        tracks.append(ImageTrack(how, (image, values), reference, drawing.left, width, ink=ink))
    tracks += dips
    if drawing.template is not None:
        tracks = _arranged(drawing.template, tracks, [*drawing.scalars, *_logged(zones.logs)], top, bottom)
    for one, caliper in zip(others, calipers, strict=True):
        tracks += [caliper, *one.image(radius[0].scale, drawing, width, top, bottom)]
    stretched = _stretched(wall, drawing, top, bottom)
    bodies = []
    if stretched is not None:
        bodies = _bodies(wall, stretched, radius, pairs)
    polar = drawing.polar
    if polar is None:
        polar = tuple(telling_depths(turns, top, bottom, zones.zones)) if wall.basis == "azimuthal" else ()
    sections = sections_at(wall, sorted(polar), interpolated) if polar else []
    lines = Lines.of(scale, drawing.depth_unit)
    return Content(
        wall, drawing, top, bottom, scale, lines, tracks, turns, zones, sections, stretched, bodies, reference,
        interpolated,
    )  # fmt: skip


def _logged(logs: Logs) -> list[ScalarCurve]:
    return curves_of(logs) if len(logs) else []


def _arranged(
    template: Template, tracks: list[PlacedTrack], curves: Sequence[ScalarCurve], top: float, bottom: float
) -> list[PlacedTrack]:
    """Return the tracks of depths and intervals, then the tracks of a template for which the wall has values.

    A track of intervals that the template has stands where the template has it.
    """
    images = {track.shown.name: track for track in tracks if isinstance(track, ImageTrack)}
    by_name = {curve.name: curve for curve in reversed(curves)}
    named = {track.name: track for track in tracks if isinstance(track, IntervalTrack) and track.name}
    placed = [named.get(wanted.name) for wanted in template.track if wanted.kind == "intervals"]
    arranged: list[PlacedTrack] = [
        track for track in tracks if isinstance(track, DepthTrack | IntervalTrack) and track not in placed
    ]
    for wanted in template.track:
        found: list[PlacedTrack] = []
        if wanted.kind == "image":
            found = [
                images[name] for name in (RADIUS_TITLE if wanted.name == RADIUS else wanted.name,) if name in images
            ]
        elif wanted.kind == "intervals":
            found = [named[wanted.name]] if wanted.name in named else []
        elif wanted.kind == "curves":
            curves = [by_name[name] for name in wanted.names if name in by_name]
            found = [ScalarTrack(curve, top, bottom) for curve in curves if curve.there(top, bottom).any()]
        else:
            kind = CaliperTrack if wanted.kind == "caliper" else DipTrack
            found = [track for track in tracks if isinstance(track, kind)]
        for track in found:
            if wanted.millimetres is not None:
                track.width = max(wanted.millimetres / len(found), track.least)
        arranged += found
    return arranged


@dataclass(frozen=True)
class _Other:
    """A wall that is drawn beside the first: its name, and the diameters of its turns."""

    name: str
    wall: Wall
    turns: Diameters

    @classmethod
    def of(cls, name: str, wall: Wall) -> _Other:
        if wall.basis == "gauge" or len(wall) < wall.settings.sectors:
            raise InputError(f"beside {name!r}", "must have a full turn that was measured")
        return cls(name, wall, diameters(wall, wall.logs()))

    def caliper(self, limits: tuple[float, float], drawing: Drawing) -> CaliperTrack:
        return _caliper(self.wall, self.turns, limits, drawing, _reference(self.wall, Drawing()), f"{self.name}: ")

    def image(self, scale: ColorScale, drawing: Drawing, width: float, top: float, bottom: float) -> list[PlacedTrack]:
        """Return a track of the radius in the colours of the first wall; [] if this wall was not measured around."""
        if self.wall.basis != "azimuthal":
            return []
        look = Look(limits=(scale.low, scale.high), color_map=scale.color_map)
        shown, over = _radius(self.wall, look, top, bottom, drawing.size_unit)
        shown = replace(shown, name=f"{self.name}: over bit")
        between = np.isfinite(self.wall.radius) & ~self.wall.measured
        helix = (self.wall.settings, self.wall.start_depth)
        reference = _reference(self.wall, Drawing())
        return [ImageTrack(shown, (helix, over), reference, drawing.left, width, between.astype(np.float64))]


def _interval(wall: Wall, drawing: Drawing) -> tuple[float, float]:
    every = [helix_of(one).ends(len(one)) for one in (wall, *drawing.beside.values())]
    ends = min(first for first, _ in every), max(last for _, last in every)
    top = ends[0] if drawing.start is None else float(drawing.start)
    bottom = ends[1] if drawing.stop is None else float(drawing.stop)
    if not (math.isfinite(top) and math.isfinite(bottom) and top < bottom):
        raise InputError(f"interval {top:g} to {bottom:g} m", "the end must be deeper than the start")
    if bottom <= ends[0] or top >= ends[1]:
        raise InputError(f"interval {top:g} to {bottom:g} m", f"the wall reaches from {ends[0]:g} to {ends[1]:g} m")
    return top, bottom


def _reference(wall: Wall, drawing: Drawing) -> str:
    """Return what toolface 0 of the picture is; "" if neither the drawing nor the wall states it."""
    own = wall.path.reference if wall.path is not None else None
    if drawing.reference is None:
        return reference_of(wall) or ""
    if own not in (None, drawing.reference):
        raise InputError("reference", f"the wall's path counts toolfaces from {own}", repr(drawing.reference))
    return drawing.reference


def _images(wall: Wall, drawing: Drawing, reference: str) -> list[SectorImage]:
    names = list(wall.images) if drawing.images is None else list(drawing.images)
    for name in [*names, *drawing.looks]:
        if name not in wall.images and name != RADIUS:
            there = ", ".join(wall.images) or "none"
            raise InputError(f"image {name!r}", f"the wall has no image of this name; it has {there}")
    found = [wall.images[name] for name in names if name != RADIUS]
    for image in found:
        if image.reference != reference and wall.path is None:
            raise InputError(
                f"image {image.name!r} counts toolfaces from {image.reference}, the picture from {reference}",
                "must be the same where the wall has no path",
            )
    return found


def _turned(image: SectorImage, values: Floats, path: Path | None, reference: str) -> SectorImage:
    """Return the image with ``values`` (its own, or normalised), in the reference of the picture."""
    drawn = SectorImage(
        image.depth, values, image.name, image.unit, origin=image.origin, reference=image.reference,
        direction=image.direction, offset=image.offset, reach=image.reach,
    )  # fmt: skip
    return drawn if path is None or image.reference == reference else drawn.onto(path)


def _shown(image: SectorImage, look: Look, top: float, bottom: float) -> tuple[Shown, Floats]:
    """Return how an image is shown between two depths, and its values, normalised if ``look`` has a window."""
    rows = (image.depth >= top - image.reach) & (image.depth <= bottom + image.reach)
    if not rows.any():
        ends = f"{image.depth[0]:g} to {image.depth[-1]:g} m"
        raise InputError(f"image {image.name!r} reaches from {ends}", f"outside the interval, {top:g} to {bottom:g} m")
    color_map = look.color_map or customary_map(image.name, image.unit)
    log = color_map == "resistivity" if look.log is None else look.log
    kind = f"{image.sectors} sectors"
    own = above_zero(image.values) if log else image.values
    dropped = int((np.isfinite(image.values) & ~np.isfinite(own))[rows].sum())
    try:
        if look.window is not None:
            scale = ColorScale(0.0, 1.0, color_map)
            values = sliding_window(image.depth, own, look.window, log)
            remark = f"{kind}, dynamic {look.window:g} m"
            cut = _count_beyond(values[rows], math.nextafter(0.0, 1.0), math.nextafter(1.0, 0.0))
            return Shown(image.name, image.unit, scale, remark, True, *cut, dropped), values
        values = own[rows]
        if not np.isfinite(values).any():
            raise InputError("values", f"all {values.size} are missing")
        scale = image_scale(image, color_map, log, look.limits)
        scale.share(values)
    except ValueError as error:
        raise InputError(f"image {image.name!r}, {top:g} to {bottom:g} m", str(error)) from error
    cut = _count_beyond(values, scale.low, scale.high)
    return Shown(image.name, image.unit, scale, f"{kind}, static", False, *cut, dropped), own


def _count_beyond(values: Floats, low: float, high: float) -> tuple[int, int]:
    """Return the number of values beyond the ends of a scale, and the number of values that are not missing."""
    return int(((values < low) | (values > high)).sum()), int(np.isfinite(values).sum())


def _radius(wall: Wall, look: Look, top: float, bottom: float, unit: str) -> tuple[Shown, Floats]:
    """Return how the radius is shown, in colours around bit size, and radius less half the bit size by vertex.

    The colours are those of the whole wall; the values are in ``unit``.
    """
    if look.log or look.window is not None:
        raise InputError("Radius", "is drawn over bit size, on a plain scale; log and window do not apply")
    of = wall.settings
    over, scale = over_bit(
        wall.radius, of.bit_diameter, of.sectors, of.pitch, look.color_map, look.limits, LENGTHS[unit]
    )
    remark = f"wall, {wall.settings.sectors} sectors"
    inside = (wall.depth >= top) & (wall.depth <= bottom)
    return Shown(RADIUS_TITLE, unit, scale, remark, False, *_count_beyond(over[inside], scale.low, scale.high)), over


def _sigma(wall: Wall, last_turn: bool = False) -> Floats | None:
    """Return the standard uncertainty of each radius, by its quad; None: not known.

    The last turn has no quads: its values are NaN, or, for sums, those of the turn before.
    """
    if "sigma" not in wall.attributes:
        return None
    sigma = np.full(len(wall), np.nan)
    of_quads = wall.attributes.whole("sigma", wall.start_depth, max(len(wall) - wall.settings.sectors - 1, 0))
    sigma[: of_quads.size] = of_quads
    if last_turn and of_quads.size:
        before = of_quads[-wall.settings.sectors :]
        sigma[of_quads.size :] = np.resize(before, len(wall) - of_quads.size)
    return sigma


def _ticks(logs: Logs, drawing: Drawing) -> list[tuple[VolumeTicks, bool]]:
    """Return the ticks of the volumes of hole and annulus, from the deepest turn of the wall up."""
    if drawing.ticks is None or not len(logs):
        return []
    both = [(volume_ticks(logs, drawing.ticks), False)]
    return [*both, (volume_ticks(logs, drawing.ticks, drawing.casing), True)] if drawing.casing else both


def _uncertainty(wall: Wall, top: float, bottom: float, unit: str) -> tuple[Shown, Floats] | None:
    """Return how the uncertainty is shown, and half the 95 % interval of each radius by vertex, in ``unit``.

    Return None if the wall has no attribute ``sigma``, or if ``sigma`` has no value.
    """
    sigma = _sigma(wall)
    if sigma is None:
        return None
    half = NORMAL_95 / LENGTHS[unit] * sigma
    if not np.isfinite(half).any():
        return None
    part = 10 if unit == "mm" else 100
    scale = ColorScale(0.0, max(math.ceil(part * np.nanpercentile(half, 98)) / part, 1 / part), "viridis")
    cut = _count_beyond(half[(wall.depth >= top) & (wall.depth <= bottom)], 0.0, scale.high)
    return Shown("Radius, 95 %", unit, scale, "half the interval", False, *cut), half


def _diameter_limits(
    walls: Sequence[tuple[Wall, Diameters]], top: float, bottom: float, drawing: Drawing
) -> tuple[float, float]:
    """Return the diameters at the edges of the caliper tracks, in the drawing's unit, the same for all ``walls``.

    What the colours of the radius do not reach, such as an open fracture, does not widen the tracks.
    """
    length = LENGTHS[drawing.size_unit]
    drawn = []
    for wall, turns in walls:
        of = wall.settings
        reach = 2 * wall_limit(wall.radius - 0.5 * of.bit_diameter, of.sectors, of.pitch, MILLIMETRE)
        inside = (turns.depth >= top) & (turns.depth <= bottom)
        columns = [turns.area, turns.least, turns.greatest] if wall.basis == "azimuthal" else [turns.area]
        drawn += [np.clip(column[inside], of.bit_diameter - reach, of.bit_diameter + reach) for column in columns]
        drawn.append(np.array([of.bit_diameter]))
    return nice_limits(np.concatenate(drawn) / length, walls[0][0].settings.bit_diameter / length, 0.01 / length)


def _caliper(
    wall: Wall, turns: Diameters, limits: tuple[float, float], drawing: Drawing, reference: str, name: str = ""
) -> CaliperTrack:
    bit, unit, curves = wall.settings.bit_diameter, drawing.size_unit, tuple(dict.fromkeys(drawing.curves))
    return CaliperTrack(turns, wall.basis, bit, unit, limits, curves, reference, name)


def _stretched(wall: Wall, drawing: Drawing, top: float, bottom: float) -> Stretched | None:
    if drawing.body is not None:
        return turns_between(wall, drawing.body[0], drawing.body[1]) if drawing.body else None
    found = most_relief(wall, top, bottom) if wall.basis == "azimuthal" else None
    return None if found is None else turns_between(wall, *found)


def _bodies(
    wall: Wall, one: Stretched, radius: tuple[Shown, Floats], images: list[tuple[SectorImage, tuple[Shown, Floats]]]
) -> list[Body]:
    """Return at most two colourings of the body: by the radius, if measured, and by the images with most values."""
    part = slice(one.first, one.first + one.radius.size)
    bodies = []
    if wall.basis == "azimuthal":
        bodies.append(Body(radius[0].scale, radius[1][part], "radius"))
    depth, toolface = wall.depth[part], wall.toolface[part]
    colored = []
    for image, (how, values) in images:
        colored.append(Body(how.scale, at_points(image, values, depth, toolface), image.name))
    colored.sort(key=lambda body: int(np.isnan(body.values).sum()))
    telling = [body for body in colored if np.isfinite(body.values).mean() >= 0.5]
    return [*bodies, *(telling or colored[:1])][:2]
