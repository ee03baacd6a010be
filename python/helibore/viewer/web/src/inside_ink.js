// The ink inside the hole: rings at round depths, and the letters of its sides.

import { wallPoint } from './dips.js';
import { eyeDepth } from './inside.js';
import { BOLD, HEAD, inside, label, PALETTES, SMALL } from './layout.js';
import { CUTS, leftEdge } from './path.js';
import { LENGTHS, showDepth } from './units.js';
import { ticks } from './view.js';

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
    if (top) label(ink, showDepth(depth, view.units, digits), top[0], top[1], { colour: palette.ink, halo: palette.paper, align: 'center', font: SMALL, yields: true, margin: 9 });
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
