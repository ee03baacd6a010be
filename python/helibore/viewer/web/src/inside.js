// The borehole camera: the eye is on the hole's axis, before the held cursor or else at one end of the section, and looks along the axis. The top of the
// picture is up or, in a vertical hole, toolface 0. A drag turns the head. The eye moves along the path like a train on rails, and
// the section with it: by wheel, arrow keys or two fingers, or by itself (V).

import { byId } from './dom.js';
import { BOLD, HEAD, inside, label, PALETTES, SMALL } from './layout.js';
import { CUTS, leftEdge } from './path.js';
import { wallPoint } from './dips.js';
import { eastNorthUp, minus, plus } from './vectors.js';
import { LENGTHS, showDepth } from './units.js';
import { ticks } from './view.js';

export const WIDE = 62; // degrees of view
const FARTHEST = 1.2; // radians that the head turns at most

/** @param {Camera} camera @param {Gpu} gpu @param {Look} look @param {{ left: number, raised: number }} head */
export function placeInside(camera, gpu, { path, view, store, wallRect }, head) {
  const down = view.camera === 'down';
  const frame = path.at(eyeDepth({ view, store }));
  const along = eastNorthUp(frame.tangent);
  camera.position = gpu.position(frame);
  camera.lookAt((down ? plus : minus)(camera.position, along), Math.abs(along[2]) > 0.9998 ? eastNorthUp(frame.high) : [0, 0, 1]);
  camera.turn(head.left, head.raised);
  camera.aspect = wallRect.width / Math.max(1, wallRect.height);
  const radius = store.bitRadius * view.tubeFactor(store);
  Object.assign(camera, { near: 0.02 * radius, far: 2 * view.length + 20 * radius });
}

const BEFORE = 2.5; // radii of the drawn hole from the eye to the held cursor

// Return the depth of the eye: before the cursor, if it is held in the section, else at the end of the section.
/** @param {{ view: View, store: Store }} of */
function eyeDepth({ view, store }) {
  const { cursor, pinned, top, bottom } = view;
  const [end, back] = view.camera === 'down' ? [top, -BEFORE] : [bottom, BEFORE];
  if (!pinned || !cursor || cursor.depth < top || cursor.depth > bottom) return end;
  return Math.min(bottom, Math.max(top, cursor.depth + back * store.bitRadius * view.tubeFactor(store)));
}

/** @param {{ left: number, raised: number }} head @param {number} dx @param {number} dy */
export function turnHead(head, dx, dy) {
  /** @param {number} angle */
  const within = (angle) => Math.min(FARTHEST, Math.max(-FARTHEST, angle));
  head.left = within(head.left + 0.004 * dx);
  head.raised = within(head.raised + 0.004 * dy);
}

const SPEED = 0.2; // of the section in a second
export const STEP = 0.025; // of the section, by a key or a notch of the wheel

// Move the eye, and the section with it, by `steps` in its direction of view; return whether it moved. The cursor is let go.
/** @param {App} app @param {number} steps */
export function fly({ view, store }, steps) {
  const top = view.top + eyeDepth({ view, store }) - (view.camera === 'down' ? view.top : view.bottom);
  view.release();
  view.show(top + (view.camera === 'up' ? -1 : 1) * STEP * steps * view.length, view.length, store);
  return view.top !== top;
}

// Fly until the end of the wall, or until this is called again; then call `landed`.
/** @param {App} app @param {() => void} [landed] */
export function toggleFlight(app, landed = () => {}) {
  const button = byId('fly');
  const on = button.classList.toggle('on');
  button.textContent = on ? 'Stop' : 'Fly';
  let before = performance.now();
  const next = () => {
    const now = performance.now();
    const seconds = Math.min(0.25, (now - before) / 1000);
    before = now;
    if (!button.classList.contains('on')) return landed();
    if (isInside(app.view) && (seconds === 0 || fly(app, (SPEED / STEP) * seconds))) return requestAnimationFrame(next);
    toggleFlight(app);
    return landed();
  };
  if (on) requestAnimationFrame(next);
}

/** @param {View} view */
export const isInside = ({ camera }) => camera === 'down' || camera === 'up';

// Draw rings at round depths, each with its depth above it, and on one of them the letters of the sides.
/** @param {Ink} ink @param {Look} look @param {Gpu} gpu */
export function drawInsideInk(ink, look, gpu) {
  const { view, path, store, rects } = look;
  const palette = PALETTES[view.theme];
  const radius = store.bitRadius * view.tubeFactor(store);
  const eye = eyeDepth(look);
  const near = Math.max(0.9 * radius, 0.02 * view.length);
  const { values, digits } = ticks(view.top, view.bottom, rects.wall.height, 76, LENGTHS[view.units].depth.scale);
  const ahead = values.filter((depth) => Math.abs(depth - eye) > near).sort((a, b) => Math.abs(a - eye) - Math.abs(b - eye));
  /** @param {number} depth @param {number} toolface @param {number} [out] */
  const at = (depth, toolface, out = 1) => gpu.project({ centre: wallPoint(path, { depth, toolface, radius: out * radius }) }, rects.wall);
  let lettered = false; // on the nearest ring that is seen whole
  for (const depth of ahead) {
    ring(ink, (toolface) => at(depth, toolface), palette);
    const zero = path.dial(depth).up ?? 0;
    const top = at(depth, zero, 0.94);
    if (top) label(ink, showDepth(depth, view.units, digits), top[0], top[1], { colour: palette.ink, halo: palette.paper, align: 'center', font: SMALL, yields: true, margin: 3 });
    lettered ||= letters(ink, look, depth, at, palette);
  }
}

/** @param {Ink} ink @param {(toolface: number) => Pair | null} at @param {Palette} palette */
function ring(ink, at, palette) {
  ink.beginPath();
  let drawing = false;
  for (let toolface = 0; toolface <= 360; toolface += 6) {
    const point = at(toolface);
    if (point && point[1] > HEAD) ink[drawing ? 'lineTo' : 'moveTo'](...point);
    drawing = Boolean(point && point[1] > HEAD);
  }
  ink.strokeStyle = palette.paper;
  ink.globalAlpha = 0.55;
  ink.lineWidth = 1;
  ink.stroke();
  ink.globalAlpha = 1;
}

/** @param {Ink} ink @param {Look} look @param {number} depth @param {(depth: number, toolface: number, out?: number) => Pair | null} at @param {Palette} palette */
function letters(ink, { view, path, rects }, depth, at, palette) {
  const { letters: names } = CUTS[view.cut];
  const { toolface, known } = leftEdge(path, view.cut, depth);
  const { left, width, top, height } = rects.wall;
  const places = known ? names.slice(0, 4).map((_, i) => at(depth, toolface + 90 * i, 0.8)) : [];
  if (!places.length || !places.every((place) => place && inside({ left: left + 12, width: width - 24, top: top + 12, height: height - 24 }, ...place))) return false;
  places.forEach((place, i) => place && label(ink, names[i], ...place, { colour: palette.ink, halo: palette.paper, align: 'center', font: BOLD, yields: true }));
  return true;
}
