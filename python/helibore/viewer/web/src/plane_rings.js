// Planes in 3-D: those that were picked, and the tops of intervals. From outside each is a disc; what the hole hides of it is left out.
// Its edge has the true dip however wide the hole is drawn, and it meets the hole at its trace, where the wall shows the plane. A top
// that was picked is the disc of its pick; one without a dip is a dashed level ring. From inside a plane is its line on the wall, so
// that nothing is veiled.

import { linesOf, outlined } from './dip_ink.js';
import { anglesOf, levelPlane, planeDepth, wallPoint } from './dips.js';
import { BOLD, fitting, label, PALETTES } from './layout.js';
import { line } from './strokes.js';
import { cross, dot, eastNorthUp, minus, normalised, plus, scaled } from './vectors.js';

const SIZE = 2.6; // of a disc, in radii of the drawn hole: all are alike
const SAME = 0.2; // metres: a bed that was picked so near to a top is the top
/** @type {Pair[]} */
const ROWS = [0, 15, -15, 30, -30, 45, -45, 60, -60].map((y) => [0, y]); // places of a name: beside its bed, else in a row above or below it
const LEAST_NAME = 60; // pixels of a name that stands in narrow room
const ANGLES = /^.*?(?=\d\S*( ± \S+)? \/ )/; // what stands before the angles of a pick
const HOLE_STEPS = 40;
const RIM = 2; // pixels
const STEP = 5; // degrees between two points of an edge
const NO_DIP = [3, 3]; // dashes of a level ring

// Return north, east and down of the edge of a disc around a hole that is drawn with so many metres radius, one point every STEP degrees
// of the disc, each with its toolface in radians and whether it is outside that hole: a disc along the hole is inside it at its ends.
/** @param {Plane} plane @param {number} radius @param {number} [size] radii of the drawn hole */
export function discOf({ a, b, c, frame: { centre, high, right, tangent } }, radius, size = SIZE) {
  const slope = Math.hypot(a, b);
  const deepest = Math.atan2(b, a);
  return Array.from({ length: 360 / STEP + 1 }, (_, i) => {
    const angle = (STEP * i * Math.PI) / 180;
    const [down, aside] = [(size * Math.cos(angle)) / Math.hypot(1, slope), size * Math.sin(angle)]; // across the hole
    const toolface = deepest + Math.atan2(aside, down);
    const out = Math.hypot(down, aside);
    const edge = centre.map((place, j) => place + radius * out * (Math.cos(toolface) * high[j] + Math.sin(toolface) * right[j]) + (c + radius * down * slope) * tangent[j]);
    return { edge, toolface, wide: out > 1 };
  });
}

// Return north, east and down of the trace of a plane on that hole, where the wall shows the plane, between two toolfaces.
/** @param {Plane} plane @param {number} radius @param {[number, number]} [ends] */
export const traceOf = ({ a, b, c, radius: own, frame: { centre, high, right, tangent } }, radius, [from, to] = [0, 360]) => Array.from({ length: Math.round((to - from) / STEP) + 1 }, (_, i) => {
  const [x, y] = [Math.cos, Math.sin].map((part) => part(((from + STEP * i) * Math.PI) / 180));
  return centre.map((place, j) => place + radius * (x * high[j] + y * right[j]) + (c + own * (a * x + b * y)) * tangent[j]);
});

// Return the nearest bed that was picked within SAME of the top of an interval.
/** @param {Plane[]} kept @param {number} start */
function bedAt(kept, start) {
  const away = (/** @type {Plane} */ { depth }) => Math.abs(depth - start);
  return kept.filter((plane) => plane.kind === 'bed' && away(plane) <= SAME).sort((one, other) => away(one) - away(other))[0];
}

// Return the planes that are tops of intervals, with the names of these.
/** @param {Look} look @param {Planes} planes @returns {Map<Plane, string>} */
export const topsOf = ({ intervals }, { kept }) => new Map(intervals.flatMap(([name, start]) => {
  const picked = bedAt(kept, start);
  return picked ? [[picked, name]] : [];
}));

// Return the tops of intervals as planes: each the bed that was picked there, else a level one, null in a hole that is nearly level itself.
/** @param {Pick<Look, 'intervals' | 'path' | 'store'>} look @param {Plane[]} kept @returns {Top[]} */
export const topPlanes = ({ intervals, path, store }, kept) => intervals.map(([name, start]) => {
  const picked = bedAt(kept, start);
  return { name, start, picked, plane: picked ?? levelPlane(path, start, store.bitRadius) };
});

// Return the name of a top, with its dip and azimuth if a bed was picked there.
/** @param {Top} top @param {Path} path */
export const topInWords = ({ name, picked }, path) => (picked ? `${name}   ${anglesOf(picked, path)}` : name);

// Return in words what traces, and discs if there are some, show on a hole that is drawn so many times too wide.
/** @param {number} tube @param {boolean} discs */
export const discsInWords = (tube, discs) => (tube > 1 ? [`hole × ${tube} wide: traces on it look flatter`, ...(discs ? ['discs have their true dip'] : [])] : [`hole × ${tube} wide`]);

// Stroke the level line of a top without a dip.
/** @param {Ink} ink @param {Palette} palette */
export function levelStroke(ink, palette) {
  ink.setLineDash(NO_DIP);
  outlined(ink, palette.top, palette);
  ink.setLineDash([]);
}

// Draw the discs; return a function that writes the names of tops and the angles beside them.
/** @param {Ink} ink @param {Looks} look @param {Planes} planes @param {Gpu} gpu */
export function drawDiscs(ink, look, planes, gpu) {
  const { view, path, store, rects: { wall: rect } } = look;
  const palette = PALETTES[view.theme];
  const radius = store.bitRadius * view.tubeFactor(store);
  /** @param {{ depth: number }} of */
  const inView = ({ depth }) => depth >= view.top && depth <= view.bottom;
  const tops = topPlanes(look, planes.kept).filter(({ start }) => inView({ depth: start }));
  const rings = tops.flatMap(({ plane, picked }) => (picked || !plane ? [] : [{ plane, colour: palette.top, level: true, stroke: () => levelStroke(ink, palette) }]));
  const discs = [...linesOf(ink, look, planes).filter(({ plane }) => inView(plane)).map((one) => ({ ...one, level: false })), ...rings].map((disc) => {
    const { centre, high, right, tangent } = disc.plane.frame;
    const towards = minus(gpu.camera.position, gpu.position({ centre }));
    return { ...disc, towards, along: eastNorthUp(tangent), front: (Math.atan2(dot(eastNorthUp(right), towards), dot(eastNorthUp(high), towards)) * 180) / Math.PI };
  }).sort((one, other) => dot(other.towards, other.towards) - dot(one.towards, one.towards)); // the nearest last
  const beside = discs.map(({ plane, colour, stroke, level, towards, along, front }) => {
    const side = scaled(normalised(cross(along, towards)), radius);
    const hole = [[1, 1], [1, -1], [-1, -1], [-1, 1]].map(([x, y]) => gpu.project(plane.frame, rect, plus(scaled(side, x), along, y * SIZE * radius)));
    /** @param {number[]} centre */
    const seen = (centre) => gpu.project({ centre }, rect);
    const trace = traceOf(plane, radius, [front - 90, front + 90]).map(seen);
    const disc = level ? [] : discOf(plane, radius).map(({ edge, toolface, wide }) => ({ at: seen(edge), wide, facing: Math.cos(toolface - (front * Math.PI) / 180) > 0 }));
    const rim = (level ? traceOf(plane, radius).map(seen) : disc.map(({ at, wide }) => (wide ? at : null))).filter((at) => at !== null);
    /** @param {(Pair | null)[]} points @param {number} [wide] */
    const row = (points, wide = RIM) => {
      ink.beginPath();
      points.forEach((at, i) => at && ink[points[i - 1] ? 'lineTo' : 'moveTo'](...at));
      stroke(wide);
    };
    ink.save();
    ink.beginPath();
    ink.rect(rect.left, rect.top, rect.width, rect.height);
    hole.forEach((at, i) => at && ink[i ? 'lineTo' : 'moveTo'](...at));
    ink.clip('evenodd'); // the hole hides what is behind it, and no disc veils the hole
    ink.beginPath();
    for (const { at } of disc) if (at) ink.lineTo(...at);
    ink.globalAlpha = 0.4;
    ink.fillStyle = colour;
    ink.fill();
    ink.globalAlpha = 1;
    row(disc.map(({ at, wide, facing }, i) => (wide && !(facing && disc[i - 1]?.facing) ? at : null)));
    ink.restore();
    row(disc.map(({ at, wide, facing }) => (wide && facing ? at : null)));
    row(trace, level ? RIM : undefined);
    const [x, y] = gpu.project(plane.frame, rect) ?? [0, 0];
    const [left, low] = gpu.project(plane.frame, rect, gpu.aside(plane.frame, -radius)) ?? [x - 1, y];
    const away = Math.hypot(left - x, low - y);
    const [dx, dy] = [(left - x) / away, (low - y) / away]; // to the side of the hole where no depths stand
    /** @param {Pair} at */
    const far = (at) => at[0] * dx + at[1] * dy;
    const edge = /** @type {Stroke[]} */ (rim.slice(1).map((point, i) => [...rim[i], ...point]));
    const [at] = [...rim].sort((one, other) => far(other) - far(one));
    return { plane, colour, at, dx, dy, edge };
  });
  return () => {
    const { strokes } = ink.canvas;
    const before = strokes.length;
    strokes.push(...beside.flatMap(({ edge }) => edge), ...holeEdges(look, gpu, radius)); // a name keeps off discs and the hole
    /** @type {(parts: string[], place: { colour: string, at: Pair, dx: number, dy: number }, yields: boolean) => void} */
    const write = (parts, { colour, at, dx, dy }, yields) => {
      const whole = parts.join('   ');
      ink.font = BOLD;
      const end = at[0] + 6 * dx - rect.left - 6; // of the room at the left of the disc
      const room = Math.max(LEAST_NAME, dx < -0.3 ? end : dx > 0.3 ? rect.width - end - 12 : rect.width - 12);
      const lines = (dx < -0.3 && ink.measureText(whole).width > end ? parts : [whole]).map((text) => { // in two lines it need not stand on the hole
        const angles = ANGLES.test(text) ? text.replace(ANGLES, '') : '';
        return fitting(ink, [text, angles || text], Math.max(room, ink.measureText(angles).width)); // no number is cut: it has room in another row
      });
      const wide = Math.max(...lines.map((text) => ink.measureText(text).width));
      const [ahead, behind] = dx < -0.3 ? [wide, 0] : dx > 0.3 ? [0, wide] : [wide / 2, wide / 2];
      const x = Math.max(ahead, Math.min(end, rect.width - 12 - behind)) + rect.left + 6;
      let moved = 0;
      for (const [i, text] of lines.entries()) {
        const place = label(ink, text, x, at[1] + 12 * dy + 15 * (i - (lines.length - 1) / 2), { colour, halo: palette.paper, align: dx > 0.3 ? 'left' : dx < -0.3 ? 'right' : 'center', font: BOLD, near: ROWS, yields, margin: 1 });
        moved = place?.[1] ?? 0;
      }
      if (moved && Math.abs(dx) > 0.3) line(ink, x + 3 * Math.sign(-dx), at[1] + 12 * dy + moved, ...at, colour, [], 1); // it stands in another row
    };
    for (const top of tops) {
      const place = beside.find(({ plane }) => plane === top.plane) ?? besideHole(look, gpu, top.start, radius);
      if (place?.at) write(topInWords(top, path).split('   '), { ...place, colour: palette.top }, false);
    }
    for (const place of beside) if (place.at && !tops.some(({ plane }) => plane === place.plane)) write([anglesOf(place.plane, path)], place, true);
    strokes.length = before;
  };
}

// Return the axis and both edges of the hole in view, as strokes.
/** @param {Looks} look @param {Gpu} gpu @param {number} radius @returns {Stroke[]} */
function holeEdges({ view, path, store: { span }, rects: { wall } }, gpu, radius) {
  const [top, bottom] = [Math.max(view.top, span[0]), Math.min(view.bottom, span[1])];
  const frames = Array.from({ length: HOLE_STEPS + 1 }, (_, i) => path.at(top + ((bottom - top) * i) / HOLE_STEPS));
  return [-1, 0, 1].flatMap((side) => {
    const points = frames.map((frame) => gpu.project(frame, wall, gpu.aside(frame, side * radius)));
    return points.flatMap((point, i) => (point && points[i - 1] ? [/** @type {Stroke} */ ([.../** @type {Pair} */ (points[i - 1]), ...point])] : []));
  });
}

// Return where a name stands beside the hole.
/** @param {Looks} look @param {Gpu} gpu @param {number} depth @param {number} radius */
function besideHole({ path, rects: { wall } }, gpu, depth, radius) {
  const frame = path.at(depth);
  const [axis, at] = [gpu.project(frame, wall), gpu.project(frame, wall, gpu.aside(frame, -1.3 * radius))];
  if (!axis || !at) return undefined;
  const away = Math.hypot(at[0] - axis[0], at[1] - axis[1]) || 1;
  return { at, dx: (at[0] - axis[0]) / away, dy: (at[1] - axis[1]) / away };
}

// Draw the line of a plane from inside, on the wall and thin, so that the cleft that it marks is seen under it. Return its
// points on the picture, one every STEP degrees of toolface.
/** @param {Ink} ink @param {Look} look @param {Pick<ReturnType<typeof linesOf>[0], 'plane' | 'stroke'>} line @param {Gpu} gpu */
export function drawLine(ink, { view, path, rects }, { plane, stroke }, gpu) {
  const { radius } = plane;
  const points = Array.from({ length: 360 / STEP + 1 }, (_, i) => {
    const at = { depth: planeDepth(path, plane, STEP * i), toolface: STEP * i, radius };
    return at.depth < view.top || at.depth > view.bottom ? null : gpu.project({ centre: wallPoint(path, at) }, rects.wall);
  });
  ink.beginPath();
  points.forEach((point, i) => point && ink[points[i - 1] ? 'lineTo' : 'moveTo'](...point));
  stroke();
  return points;
}
