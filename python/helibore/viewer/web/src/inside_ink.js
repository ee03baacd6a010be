// The ink inside the hole: lines of planes and tops, rings at round depths, the letters of the hole's sides. What is nearer to the eye
// is labelled first, planes and tops before depths; what has no room for its label, or is too small on the picture, has none.

import { BAR } from './color_bar.js';
import { linesOf } from './dip_ink.js';
import { anglesOf, planeDepth, riseOf, wallPoint } from './dips.js';
import { eyeDepth } from './inside.js';
import { BOLD, fitting, HEAD, inside, label, PALETTES, SMALL } from './layout.js';
import { CUTS, leftEdge } from './path.js';
import { drawLine, levelStroke, topInWords, topPlanes, topsOf } from './plane_rings.js';
import { marksOf } from './sureness.js';
import { turn } from './turns.js';
import { LENGTHS, showAngle, showAzimuth, showDepth, showLength } from './units.js';
import { ticks } from './view.js';

const FAINTEST = 14; // pixels: a smaller ring is not drawn
const BELOW = 1.25; // half heights of a plane's line from its middle to its words, which then stand below the cleft or, without room there, above it
const APART = 2.5; // radii of the hole between two rings, at least
const SMALLEST = 0.03; // of the pane: a smaller ring has no label, and a smaller ring of a top is not drawn
/** @type {Pair[]} */
const UP_OR_DOWN = [14, -14, 28, -28, 42, -42].map((y) => [0, y]);

// `foot` is how high the words at the foot are.
/** @param {Ink} ink @param {Looks} look @param {Gpu} gpu @param {Planes} planes @param {number} foot */
export function drawInsideInk(ink, look, gpu, planes, foot) {
  const { view, path, store, rects: { wall: rect }, held } = look;
  const palette = PALETTES[view.theme];
  const radius = store.bitRadius;
  const eye = eyeDepth(look);
  const near = 0.9 * radius;
  /** @param {number} depth @param {number} toolface @param {number} [out] */
  const at = (depth, toolface, out = 1) => gpu.project({ centre: wallPoint(path, { depth, toolface, radius: out * radius }) }, rect);
  /** @param {number} depth */
  const sizeOf = (depth) => (rect.height * radius) / (2 * gpu.camera.tangent * Math.abs(depth - eye)); // pixels of a ring's radius
  /** @type {{ away: number, isDepth: boolean, write: () => void }[]} */
  const texts = [];
  const smallest = SMALLEST * Math.min(rect.width, rect.height);
  /** @param {number} depth @param {() => void} write @param {boolean} [isDepth] */
  const later = (depth, write, isDepth = false) => sizeOf(depth) > smallest && texts.push({ away: Math.abs(depth - eye), isDepth, write });
  const tops = topsOf(look, planes);
  const lines = linesOf(ink, look, planes).sort((one, other) => Math.abs(other.plane.depth - eye) - Math.abs(one.plane.depth - eye));
  const way = view.camera === 'down' ? 1 : -1;
  const first = lines.findLast(({ plane }) => (held ? plane.pick === held.pick : way * (plane.depth - eye) > riseOf(plane) && sizeOf(plane.depth) > smallest)); // the held plane, or the nearest that is seen whole
  for (const line of lines) {
    const { plane, colour } = line;
    if (sizeOf(plane.depth) < FAINTEST) continue;
    ink.globalAlpha = line === first ? 1 : Math.min(1, sizeOf(plane.depth) / 120);
    const points = drawLine(ink, look, line, gpu);
    ink.globalAlpha = 1;
    const seen = points.filter((point) => point !== null);
    if (!seen.length) continue;
    const name = tops.get(plane);
    const lettering = { colour: name ? palette.top : colour, halo: palette.paper, align: /** @type {const} */ ('center'), font: BOLD };
    const [x, y] = [0, 1].map((axis) => seen.map((point) => point[axis]));
    if (line === first) {
      const azimuth = path.surveyed && Number.isFinite(plane.azimuth);
      const [steep, towards] = marksOf(plane, path);
      const angles = azimuth ? `dip ${showAngle(plane.dip, 0)}${steep} toward ${showAzimuth(plane.azimuth)}°${towards}${path.north && ` from ${path.north} north`}` : `${showAngle(plane.apparent, 0)}${path.surveyed ? '' : steep} apparent dip`;
      const words = [name, plane.pick?.note || undefined, `${plane.kind} at ${showDepth(plane.depth, view.units)}`, angles, plane.pick?.aperture ? `aperture about ${showLength(plane.pick.aperture, view.units, view.units === 'mm' ? 0 : 2)}` : undefined].filter((text) => text !== undefined);
      const middle = (Math.min(...y) + Math.max(...y)) / 2;
      const far = BELOW * (Math.max(...y) - middle);
      const [below, lowest, above] = [middle + far + 16, rect.height - foot - 16 * words.length, middle - far - 16 * words.length];
      const low = below <= lowest || above < (ink.canvas.slide ? 16 : HEAD) ? Math.min(below, lowest) : above;
      texts.push({ away: 0, isDepth: false, write: () => words.forEach((text, i) => label(ink, ...inPane(ink, text, (Math.min(...x) + Math.max(...x)) / 2, rect), low + 16 * i, { ...lettering, colour: text === name ? palette.top : colour })) }); // above the rings, which would strike it through
    } else {
      const deepest = points[Math.round(plane.deepest / 5)] ?? seen[0]; // there, not at the top, where the depths of the rings stand
      later(plane.depth, () => label(ink, [name, anglesOf(plane, path)].filter(Boolean).join('   '), ...deepest, { ...lettering, near: [...UP_OR_DOWN, [44, 0], [-44, 0]], yields: true, margin: 4 }));
    }
  }
  for (const top of topPlanes(look, planes.kept)) { // without a pick: a level line, or a ring in a hole that is level itself; its name at one side, away from the depths
    const { start, picked, plane } = top;
    if (start <= view.top || start >= view.bottom || Math.abs(start - eye) <= near || picked || sizeOf(start) <= smallest) continue;
    const side = (path.dial(start).up ?? 0) + 90;
    if (plane) drawLine(ink, look, { plane, stroke: () => levelStroke(ink, palette) }, gpu);
    else ring(ink, (toolface) => at(start, toolface), palette.top, 2);
    const beside = at(plane ? planeDepth(path, plane, side) : start, side, 0.96);
    if (beside) later(start, () => label(ink, topInWords(top, path), Math.min(beside[0], rect.left + rect.width - 6), beside[1], { colour: palette.top, halo: palette.paper, align: 'right', font: BOLD, near: [[0, 0], ...UP_OR_DOWN], margin: 4 }));
  }
  const reach = (rect.height * radius) / (2 * gpu.camera.tangent * FAINTEST);
  const [from, to] = [Math.max(view.top, eye - reach), Math.min(view.bottom, eye + reach)];
  const { values, digits } = ticks(from, to, to - from, APART * radius, LENGTHS[view.units].depth.scale);
  const ahead = values.filter((depth) => Math.abs(depth - eye) > near).sort((a, b) => Math.abs(a - eye) - Math.abs(b - eye));
  let lettered = false; // on the nearest ring that is seen whole, after the words of the first plane, which they leave room
  for (const depth of ahead) {
    const top = at(depth, path.dial(depth).up ?? 0, 0.94);
    if (top && top[1] > HEAD + 8 && sizeOf(depth) > smallest) { // else its depth would be hidden
      ring(ink, (toolface) => at(depth, toolface), palette.paper);
      later(depth, () => label(ink, showDepth(depth, view.units, digits), top[0], top[1], { colour: palette.ink, halo: palette.paper, align: 'center', font: SMALL, yields: true, margin: 9 }), true);
    }
    lettered ||= letters(ink, look, depth, at, palette, (write) => texts.push({ away: 0, isDepth: false, write }));
  }
  heldMark(ink, look, at, palette);
  for (const { write } of texts.sort((one, other) => Number(one.isDepth) - Number(other.isDepth) || one.away - other.away)) write();
}

// Return as much of a centred text as the pane is wide, and its middle, so that neither side cuts it.
/** @param {Ink} ink @param {string} text @param {number} middle @param {Rect} rect @returns {[string, number]} */
function inPane(ink, text, middle, { left, width }) {
  ink.font = BOLD;
  const shown = fitting(ink, [text], width - 16);
  const half = Math.min(width - 16, ink.measureText(shown).width) / 2 + 8;
  return [shown, Math.max(left + half, Math.min(left + width - half, middle))];
}

// Mark the held cursor on the wall: a small circle, or a ring around the hole if it has no toolface.
/** @param {Ink} ink @param {Look} look @param {(depth: number, toolface: number, out?: number) => Pair | null} at @param {Palette} palette */
function heldMark(ink, { view: { cursor, pinned, shape }, store }, at, palette) {
  if (!pinned || !cursor) return;
  const { depth, toolface } = cursor;
  if (toolface === null) return ring(ink, (angle) => at(depth, angle), palette.cursor, 2);
  const level = store.levels[0];
  const k = Math.max(0, level.turnAt(depth));
  const radii = turn(store, level, k);
  const r = radii[Math.round(((toolface - level.toolface(k) + 720) % 360) * radii.length / 360) % radii.length];
  const spot = at(depth, toolface, 1 + ((r || store.bitRadius) / store.bitRadius - 1) * (shape || 1));
  if (!spot) return;
  const [x, y] = spot;
  ink.canvas.labels.push({ text: '', left: x - 9, right: x + 9, top: y - 9, bottom: y + 9 }); // texts keep clear of it
  for (const [colour, wide] of /** @type {[string, number][]} */ ([[palette.panel, 5], [palette.cursor, 2.4]])) {
    ink.beginPath();
    ink.arc(...spot, 7, 0, 7);
    ink.strokeStyle = colour;
    ink.lineWidth = wide;
    ink.stroke();
  }
}

/** @param {Ink} ink @param {(toolface: number) => Pair | null} at @param {string} colour @param {number} [wide] */
function ring(ink, at, colour, wide = 1) {
  ink.beginPath();
  let drawing = false;
  for (let toolface = 0; toolface <= 360; toolface += 6) {
    const point = at(toolface);
    if (point) ink[drawing ? 'lineTo' : 'moveTo'](...point);
    drawing = point !== null;
  }
  ink.strokeStyle = colour;
  ink.globalAlpha = wide > 1 ? 1 : 0.55;
  ink.lineWidth = wide;
  ink.stroke();
  ink.globalAlpha = 1;
}

/** @param {Ink} ink @param {Look} look @param {number} depth @param {(depth: number, toolface: number, out?: number) => Pair | null} at @param {Palette} palette @param {(write: () => void) => void} then */
function letters(ink, { view, path, rects }, depth, at, palette, then) {
  const { letters: names } = CUTS[view.cut];
  const { toolface, known } = leftEdge(path, view.cut, depth);
  const { left, width, height } = rects.wall;
  const places = known ? names.slice(0, 4).map((_, i) => at(depth, toolface + 90 * i, 0.7)) : [];
  if (!places.length || !places.every((place) => place && inside({ left: left + 12, width: width - 24, top: HEAD + 12, height: height - HEAD - BAR - 24 }, ...place))) return false;
  then(() => places.forEach((place, i) => place && label(ink, names[i], ...place, { colour: palette.ink, halo: palette.paper, align: 'center', font: BOLD, near: [[0, 0], ...UP_OR_DOWN], yields: true })));
  return true;
}
