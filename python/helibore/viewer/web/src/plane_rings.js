// Planes that were picked, in 3-D. From outside each is a disc in its true attitude, however wide the hole is drawn; what the hole
// hides of it is left out. From inside it is its line on the wall, so that nothing is veiled.

import { linesOf } from './dip_ink.js';
import { anglesOf, planeDepth, wallPoint } from './dips.js';
import { BOLD, label, PALETTES } from './layout.js';
import { cross, dot, eastNorthUp, minus, normalised, plus, scaled } from './vectors.js';

const SIZE = { hole: 1.5, most: 3.2 }; // of a disc: wider than the hole where it cuts it, in radii of the drawn hole
const SAME = 0.2; // metres: a plane so near to a top is the top
/** @type {Pair[]} */
export const ROWS = [0, 15, -15, 30, -30, 45, -45, 60, -60].map((y) => [0, y]); // places of a name: beside its bed, else in a row above or below it
const BEFORE = 0.88; // of the hole's radius
const STEP = 5; // degrees between two points of an edge

// Return how far from the axis of a hole of radius 1 the disc of a plane ends, in the direction of a toolface: the disc is round.
/** @param {Plane} plane @param {number} toolface */
function reach({ a, b }, toolface) {
  const [c, s] = [Math.cos((toolface * Math.PI) / 180), Math.sin((toolface * Math.PI) / 180)];
  return Math.min(SIZE.most, SIZE.hole * Math.hypot(1, a, b)) / Math.hypot(1, a * c + b * s);
}

// Return north, east and down of the edge of a disc around a hole of so many metres radius, between two toolfaces, or of the line
// where the plane cuts the hole.
/** @param {Plane} plane @param {number} radius @param {boolean} cut @param {[number, number]} [ends] */
export function edgeOf(plane, radius, cut, [from, to] = [0, 360]) {
  const { a, b, c, frame: { centre, high, right, tangent } } = plane;
  return Array.from({ length: Math.round((to - from) / STEP) + 1 }, (_, i) => {
    const toolface = from + STEP * i;
    const far = radius * (cut ? 1 : Math.max(1, reach(plane, toolface)));
    const [x, y] = [far * Math.cos((toolface * Math.PI) / 180), far * Math.sin((toolface * Math.PI) / 180)];
    return centre.map((at, j) => at + x * high[j] + y * right[j] + (c + a * x + b * y) * tangent[j]);
  });
}

// Return the planes that are tops of intervals, with the names of these.
/** @param {Look} look @param {Planes} planes @returns {Map<Plane, string>} */
export function topsOf({ intervals }, { kept }) {
  /** @type {Map<Plane, string>} */
  const tops = new Map();
  for (const [name, start] of intervals) {
    const [nearest] = kept.filter(({ depth }) => Math.abs(depth - start) <= SAME).sort((one, other) => Math.abs(one.depth - start) - Math.abs(other.depth - start));
    if (nearest) tops.set(nearest, name);
  }
  return tops;
}

// Draw the discs; return a function that writes the angles beside them.
/** @param {Ink} ink @param {Looks} look @param {Planes} planes @param {Gpu} gpu @param {Map<Plane, string>} tops */
export function drawDiscs(ink, look, planes, gpu, tops) {
  const { view, path, store, rects: { wall: rect } } = look;
  const palette = PALETTES[view.theme];
  const radius = store.bitRadius * view.tubeFactor(store);
  const discs = linesOf(ink, look, planes).filter(({ plane: { depth } }) => depth >= view.top && depth <= view.bottom).map((disc) => {
    const { centre, high, right, tangent } = disc.plane.frame;
    const towards = minus(gpu.camera.position, gpu.position({ centre }));
    return { ...disc, towards, along: eastNorthUp(tangent), front: (Math.atan2(dot(eastNorthUp(right), towards), dot(eastNorthUp(high), towards)) * 180) / Math.PI };
  }).sort((one, other) => dot(other.towards, other.towards) - dot(one.towards, one.towards)); // the nearest last
  const beside = discs.map(({ plane, colour, stroke, towards, along, front }) => {
    /** @param {boolean} cut @param {number} from */
    const points = (cut, from) => edgeOf(plane, radius, cut, [from - 90, from + 90]).map((centre) => gpu.project({ centre }, rect)).filter((at) => at !== null);
    const side = scaled(normalised(cross(along, towards)), radius);
    const hole = [[1, 1], [1, -1], [-1, -1], [-1, 1]].map(([x, y]) => gpu.project(plane.frame, rect, plus(scaled(side, x), along, y * SIZE.most * radius)));
    for (const [from, behind] of /** @type {[number, boolean][]} */ ([[front + 180, true], [front, false]])) {
      const edge = points(false, from);
      ink.save();
      if (behind) { // the hole hides it
        ink.beginPath();
        ink.rect(rect.left, rect.top, rect.width, rect.height);
        hole.forEach((at, i) => at && ink[i ? 'lineTo' : 'moveTo'](...at));
        ink.clip('evenodd');
      }
      ink.beginPath();
      for (const at of [...edge, ...points(true, from).reverse()]) ink.lineTo(...at);
      ink.globalAlpha = 0.4;
      ink.fillStyle = colour;
      ink.fill();
      ink.globalAlpha = 1;
      ink.beginPath();
      for (const at of edge) ink.lineTo(...at);
      stroke();
      ink.restore();
    }
    const [x, y] = gpu.project(plane.frame, rect) ?? [0, 0];
    const [left, low] = gpu.project(plane.frame, rect, gpu.aside(plane.frame, -radius)) ?? [x - 1, y];
    const away = Math.hypot(left - x, low - y);
    const [dx, dy] = [(left - x) / away, (low - y) / away]; // to the side of the hole where no depths stand
    /** @param {Pair} at */
    const far = (at) => at[0] * dx + at[1] * dy;
    const [at] = [...points(false, front), ...points(false, front + 180)].sort((one, other) => far(other) - far(one));
    return { plane, colour, at, dx, dy };
  });
  return () => {
    for (const { plane, colour, at, dx, dy } of beside.sort((one, other) => Number(tops.has(other.plane)) - Number(tops.has(one.plane)))) {
      const name = tops.get(plane);
      if (!at) continue;
      const parts = [...(name ? [name] : []), anglesOf(plane, path)];
      const whole = parts.join('   ');
      ink.font = BOLD;
      const end = at[0] + 6 * dx - rect.left - 6; // of the room at the left of the disc
      const lines = dx < -0.3 && ink.measureText(whole).width > end ? parts : [whole]; // in two lines it need not stand on the hole
      const x = Math.max(end, dx < -0.3 ? Math.max(...lines.map((text) => ink.measureText(text).width)) : 0) + rect.left + 6;
      for (const [i, text] of lines.entries()) label(ink, text, x, at[1] + 12 * dy + 15 * (i - (lines.length - 1) / 2), { colour: name ? palette.top : colour, halo: palette.paper, align: dx > 0.3 ? 'left' : dx < -0.3 ? 'right' : 'center', font: BOLD, near: ROWS, yields: !name, margin: 1 });
    }
  };
}

// Draw the line of a plane from inside, thin and a little before the wall, so that the cleft that it marks is seen beside it. Return its
// points on the picture, one every STEP degrees of toolface.
/** @param {Ink} ink @param {Look} look @param {ReturnType<typeof linesOf>[0]} line @param {Gpu} gpu */
export function drawLine(ink, { view, path, rects }, { plane, stroke }, gpu) {
  const radius = BEFORE * plane.radius;
  const points = Array.from({ length: 360 / STEP + 1 }, (_, i) => {
    const at = { depth: planeDepth(path, { ...plane, radius }, STEP * i), toolface: STEP * i, radius };
    return at.depth < view.top || at.depth > view.bottom ? null : gpu.project({ centre: wallPoint(path, at) }, rects.wall);
  });
  ink.beginPath();
  points.forEach((point, i) => point && ink[points[i - 1] ? 'lineTo' : 'moveTo'](...point));
  stroke(1.2);
  return points;
}
