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
  for (const [name, top] of look.intervals) { // a top is a ring with its name at one side, away from the depths
    if (top <= view.top || top >= view.bottom || Math.abs(top - eye) <= near) continue;
    ring(ink, (toolface) => at(top, toolface), palette.top, 2);
    const beside = at(top, (path.dial(top).up ?? 0) + 90, 0.96);
    if (beside) label(ink, name, Math.min(beside[0], rects.wall.left + rects.wall.width - 6), beside[1], { colour: palette.top, halo: palette.paper, align: 'right', font: BOLD, yields: true, margin: 2 });
  }
  let lettered = false; // on the nearest ring that is seen whole
  for (const depth of ahead) {
    const top = at(depth, path.dial(depth).up ?? 0, 0.94);
    if (top && top[1] > HEAD + 8) { // else its depth would be hidden
      ring(ink, (toolface) => at(depth, toolface), palette.paper);
      label(ink, showDepth(depth, view.units, digits), top[0], top[1], { colour: palette.ink, halo: palette.paper, align: 'center', font: SMALL, yields: true, margin: 9 });
    }
    lettered ||= letters(ink, look, depth, at, palette);
  }
}

/** @param {Ink} ink @param {(toolface: number) => Pair | null} at @param {string} colour @param {number} [wide] */
function ring(ink, at, colour, wide = 1) {
  ink.beginPath();
  let drawing = false;
  for (let toolface = 0; toolface <= 360; toolface += 6) {
    const point = at(toolface);
    if (point && point[1] > HEAD) ink[drawing ? 'lineTo' : 'moveTo'](...point);
    drawing = Boolean(point && point[1] > HEAD);
  }
  ink.strokeStyle = colour;
  ink.globalAlpha = wide > 1 ? 1 : 0.55;
  ink.lineWidth = wide;
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
