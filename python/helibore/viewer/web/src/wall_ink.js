// The ink over the 3-D view: the hole's axis in gaps, zones and depths beside the hole, the compass, the exaggerations in words.

import { Q_ATTRIBUTE, themed } from './color.js';
import { BAR, drawColourBar } from './color_bar.js';
import { anglesInWords, wallPoint } from './dips.js';
import { inLines } from './columns.js';
import { drawInsideInk } from './inside_ink.js';
import { BOLD, FONT, HEAD, label, PALETTES, SMALL } from './layout.js';
import { CUTS, leftEdge } from './path.js';
import { scaleBar } from './scale_bar.js';
import { line } from './strokes.js';
import { discsInWords, drawDiscs } from './plane_rings.js';
import { drawMaps } from './path_maps.js';
import { drawPlan, planInWords } from './planned.js';
import { turn } from './turns.js';
import { LENGTHS, showDepth } from './units.js';
import { dot, eastNorthUp, minus, scaled } from './vectors.js';
import { CAMERAS, ticks } from './view.js';
import { isSure } from './zones.js';

const GAP = '   ';
const NEEDLE = 30; // pixels from the middle of the compass to its rim

/** @param {Ink} ink @param {Looks} look @param {Gpu} gpu @param {Profile} calipers @param {Planes} planes */
export function drawWallInk(ink, look, gpu, calipers, planes) {
  const { view, path, rects } = look;
  const palette = PALETTES[view.theme];
  const rect = { ...rects.wall, height: rects.wall.height - (rects.image.width ? 0 : BAR) };
  const outside = view.camera === 'outside';
  ink.save();
  ink.beginPath();
  ink.rect(rect.left, 0, rect.width, rect.height);
  ink.clip();
  const lines = view.rig || (outside && ink.canvas.slide) ? [] : captionOf(ink, look, planes, rect.width - (outside ? 200 : path.surveyed ? 110 : 20));
  const { labels } = ink.canvas; // texts keep off the compass and off the words
  const foot = { text: '', left: rect.left, right: rect.left + (path.surveyed ? 88 : 0), top: rect.height - 88, bottom: rect.height };
  const wide = outside ? Math.max(0, ...lines.map((text) => ink.measureText(text).width)) + 10 : rect.width;
  const words = { ...foot, left: rect.left + rect.width - wide, right: rect.left + rect.width, top: rect.height - 6 - 16 * lines.length };
  const at = labels.push(foot, words) - 2;
  if (outside) outsideInk(ink, look, gpu, calipers, planes, palette, words);
  else drawInsideInk(ink, look, gpu, planes, (rect.width > 500 ? 16 * lines.length : 88) + rects.wall.height - rect.height); // 88: the compass
  if (path.surveyed && outside && rect.width > 300) drawMaps(ink, look, gpu, planes);
  labels.splice(at, 2);
  if (path.surveyed) compass(ink, gpu, rect, palette);
  ink.restore();
  ink.font = FONT;
  if (outside) {
    ink.fillStyle = `${palette.paper}cc`; // the planned path runs below the words
    ink.fillRect(words.left, words.top, wide, 16 * lines.length);
  }
  lines.forEach((text, i) => label(ink, text, rect.left + rect.width - 10, rect.height - 14 - 16 * (lines.length - 1 - i), { colour: palette.ink, halo: palette.paper, align: 'right' }));
  if (!rects.image.width) drawColourBar(ink, look, rect.height + BAR / 2);
}

// Return in lines of a width how the hole is drawn and what else is seen. On a slide of the path they stand above the picture.
/** @param {Ink} ink @param {Looks} look @param {Planes} planes @param {number} width @param {boolean} [slide] */
export const captionOf = (ink, look, planes, width, slide = false) => captionLines(ink, inWords(look, planes, look.view.tubeFactor(look.store), slide), width);

/** @param {Looks} look @param {Planes} planes @param {number} tube @param {boolean} slide */
function inWords(look, planes, tube, slide) {
  const { view, path, store, rects } = look;
  const outside = view.camera === 'outside';
  /** @param {number} depth */
  const inView = (depth) => depth > view.top && depth < view.bottom;
  const picked = planes.kept.some(({ depth }) => inView(depth));
  const toScale = !outside && (view.shape || 1) === 1;
  const words = toScale ? ['true to scale'] : picked || (outside && look.intervals.some(([, start]) => inView(start))) ? discsInWords(tube, outside) : [`hole × ${tube} wide`];
  if (!toScale && (!outside || view.shape > 1)) words.push(`shape × ${view.shape || 1} (departures from bit size)`);
  if (outside && store.basis === 'azimuthal') words.push('faded where the radius is uncertain');
  if (slide && rects.image.width && leftEdge(path, view.cut, view.middle).known) words.push(`image ${CUTS[view.cut].label}`); // its head has no room
  if (picked && !(outside && rects.image.width)) words.push(anglesInWords(path, planes.kept)); // else the legend below the tracks says it
  if (view.median > 1) words.push(`median of ${view.median} turns`);
  if (outside && store.plan.length) words.push(...planInWords(look));
  if (!path.surveyed) words.unshift('no survey: drawn vertical');
  if (!outside) words.unshift(CAMERAS[view.camera], ...(path.surveyed && path.dial(view.middle).up !== null ? ['high side up'] : []), ...(look.dark && rects.image.width && themed(look.quantity.map, true) !== look.quantity.map ? ['colours of the light page'] : []));
  if (!outside && (look.light || look.quantity.mode === Q_ATTRIBUTE)) words.push(look.light ? `dark and light by ${look.light.name}` : 'clefts grey');
  return words;
}

// Return the words in as few lines as the width allows.
/** @param {Ink} ink @param {string[]} words @param {number} width */
export function captionLines(ink, words, width) {
  ink.font = FONT;
  return inLines(ink, words.join(GAP), width, GAP);
}

/** @param {Ink} ink @param {Looks} look @param {Gpu} gpu @param {Profile} calipers @param {Planes} planes @param {Palette} palette @param {Box} words those at the foot */
function outsideInk(ink, look, gpu, calipers, planes, palette, words) {
  const { view, path, store, rects } = look;
  const rect = rects.wall;
  const tube = view.tubeFactor(store);
  unmeasured(ink, look, gpu, calipers, palette);
  const writeAngles = drawDiscs(ink, look, planes, gpu);
  zonesBeside(ink, look, gpu, palette);
  const writePlan = store.plan.length ? drawPlan(ink, look, gpu) : () => {};
  const { cursor } = view;
  if (cursor && cursor.depth >= view.top && cursor.depth <= view.bottom) cursorRing(ink, look, cursor.depth, gpu, palette); // below the words
  const { values, digits } = ticks(view.top, view.bottom, rect.height, 76, LENGTHS[view.units].depth.scale);
  const beside = store.bitRadius * tube * 1.3;
  /** @type {Pair[]} */
  const used = [];
  const [shallow, deep] = store.span;
  for (const depth of values.filter((value) => value >= shallow && value <= deep)) {
    const frame = path.at(depth);
    const [at, axis] = [gpu.project(frame, rect, gpu.aside(frame, beside)), gpu.project(frame, rect)];
    if (!at || !axis || at[1] < HEAD + 8 || used.some(([x, y]) => Math.abs(y - at[1]) < 16 && Math.abs(x - at[0]) < 70)) continue;
    used.push(at);
    const level = Math.abs(at[0] - axis[0]) < Math.abs(at[1] - axis[1]); // the label stands over the hole, not beside it
    const text = showDepth(depth, view.units, digits);
    ink.font = SMALL;
    label(ink, text, level ? at[0] : Math.min(at[0] + 8, rect.left + rect.width - ink.measureText(text).width - 4), at[1] - (level ? 12 : 0), { colour: palette.ink, halo: palette.paper, font: SMALL, align: level ? 'center' : 'left' });
    if (level) line(ink, at[0], at[1] - 6, at[0], at[1] + 2, palette.soft);
    else line(ink, at[0] - 2, at[1], at[0] + 6, at[1], palette.soft);
  }
  writeAngles();
  writePlan();
  barBeside(ink, look, gpu, palette, words);
  cursorLabel(ink, look, gpu, beside, palette);
}

// Draw the bar of the scale in the middle of the section, beside the compass or above the words.
/** @param {Ink} ink @param {Look} look @param {Gpu} gpu @param {Palette} palette @param {Box} words */
function barBeside(ink, { view, path, rects: { wall: rect } }, gpu, palette, words) {
  const frame = path.at(view.middle);
  const [a, b] = [0, 1].map((metres) => gpu.project(frame, rect, scaled(gpu.camera.axes[0], metres)));
  const left = rect.left + 104;
  if (a && b) scaleBar(ink, left, Math.min(rect.height - 46, words.left < left + LONGEST_BAR ? words.top - 10 : Infinity), b[0] - a[0], view, palette);
}

const LONGEST_BAR = 100; // pixels

// Draw a stroke beside the hole along every zone in view.
/** @param {Ink} ink @param {Look} look @param {Gpu} gpu @param {Palette} palette */
function zonesBeside(ink, { view, path, store, rects, zones }, gpu, palette) {
  const beside = -1.25 * store.bitRadius * view.tubeFactor(store);
  for (const zone of zones) {
    const { kind, start, stop } = zone;
    const depths = [Math.max(start, view.top), Math.min(stop, view.bottom)];
    if (depths[1] <= depths[0]) continue;
    const ends = depths.map((depth) => path.at(depth)).map((frame) => gpu.project(frame, rects.wall, gpu.aside(frame, beside)));
    if (!ends[0] || !ends[1]) continue;
    line(ink, ...ends[0], ...ends[1], palette.zones[kind], [], isSure(zone) ? 5 : 2);
  }
}

// Draw the axis of the hole, dashed, through every gap of the wall in view and from the end of the wall to the bit.
/** @param {Ink} ink @param {Look} look @param {Gpu} gpu @param {Profile} profile @param {Palette} palette */
function unmeasured(ink, { view, path, store, rects, bitDepth }, gpu, { min, seen }, palette) {
  /** @param {number} y */
  const depthOf = (y) => view.top + (y / min.length) * view.length;
  const ahead = bitDepth === null ? [] : [store.end, bitDepth].sort((a, b) => a - b);
  /** @type {Pair | null} */
  let before = null;
  for (let y = 0; y < min.length; y += 4) {
    const depth = depthOf(y);
    const open = (seen[y] && Number.isNaN(min[y])) || (depth > ahead[0] && depth < ahead[1]);
    const frame = open ? path.at(depth) : null;
    const at = frame && gpu.project(frame, rects.wall);
    if (at && before && (y / 4) % 2) line(ink, ...before, ...at, palette.soft);
    before = at;
  }
}

/** @param {Ink} ink @param {Look} look @param {Gpu} gpu @param {number} beside @param {Palette} palette */
function cursorLabel(ink, look, gpu, beside, palette) {
  const { view, path, rects } = look;
  if (!view.cursor || view.cursor.depth < view.top || view.cursor.depth > view.bottom) return;
  const frame = path.at(view.cursor.depth);
  const at = gpu.project(frame, rects.wall, gpu.aside(frame, -beside));
  if (at) label(ink, showDepth(view.cursor.depth, view.units), at[0] - 6, at[1] + 4, { colour: palette.cursor, halo: palette.paper, align: 'right', font: BOLD, near: [[0, 0], [0, -16], [0, 16], [0, -32], [0, 32]] });
}

// Draw a needle on a level disc, as the camera sees them, with the letter of north.
/** @param {Ink} ink @param {Gpu} gpu @param {Rect} rect @param {Palette} palette */
export function compass(ink, gpu, rect, palette) {
  const [x, y] = [rect.left + 52, rect.height - 46]; // room for the letter at either side
  /** @param {number} azimuth @param {number} share @returns {Pair} */
  const at = (azimuth, share) => {
    const [dx, dy] = gpu.facing([Math.sin(azimuth), Math.cos(azimuth), 0]);
    return [x + NEEDLE * share * dx, y - NEEDLE * share * dy];
  };
  const east = Math.PI / 2;
  /** @type {[Pair[], string][]} */
  const parts = [
    [Array.from({ length: 25 }, (_, i) => at((i * Math.PI) / 12, 1)), `${palette.paper}dd`],
    [[at(0, 0.95), at(east, 0.3), at(-east, 0.3)], palette.ink],
    [[at(2 * east, 0.95), at(east, 0.3), at(-east, 0.3)], palette.paper],
  ];
  for (const [corners, fill] of parts) {
    ink.beginPath();
    for (const corner of corners) ink.lineTo(...corner);
    ink.closePath();
    ink.fillStyle = fill;
    ink.fill();
    ink.strokeStyle = palette.ink;
    ink.lineWidth = 1.2;
    ink.stroke();
  }
  const [dx, dy] = at(0, 1).map((tip, i) => tip - [x, y][i]);
  const far = 1 + 10 / (Math.hypot(dx, dy) || 1); // ten pixels past the tip, however short the needle is seen
  label(ink, 'N', x + far * dx, y + far * (dy || -1), { colour: palette.ink, halo: palette.paper, align: 'center', font: BOLD });
}

// Draw a line at the cursor's depth around the visible side of the wall.
/** @param {Ink} ink @param {Look} look @param {number} depth @param {Gpu} gpu @param {Palette} palette */
function cursorRing(ink, { view, path, store, rects }, depth, gpu, palette) {
  const { centre } = path.at(depth);
  const level = store.levels[0];
  const k = Math.max(0, level.turnAt(depth));
  const radii = turn(store, level, k);
  const tube = view.tubeFactor(store);
  /** @type {Pair | null} */
  let before = null;
  for (let j = 0; j <= radii.length; j++) {
    const r = radii[j % radii.length];
    const R = (store.bitRadius + ((Number.isNaN(r) ? store.bitRadius : r) - store.bitRadius) * (view.shape || 1)) * tube;
    const point = wallPoint(path, { depth, toolface: level.toolface(k + j), radius: 1.01 * R });
    const outwards = eastNorthUp(minus(point, centre));
    const seen = dot(outwards, minus(gpu.camera.position, gpu.position({ centre: point }))) > 0;
    const at = seen ? gpu.project({ centre: point }, rects.wall) : null;
    if (at && before) line(ink, ...before, ...at, palette.cursor, [], 2.4);
    before = at;
  }
}
