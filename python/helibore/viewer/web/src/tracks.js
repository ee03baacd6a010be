// The ink over the picture: depth axis, heads with scales and letters, the cursor's line through every track. (caliper.js,
// map.js, column.js and wall_ink.js draw their own.) Everything here is drawn anew for each frame.

import { Q_ATTRIBUTE } from './color.js';
import { drawColours, POINT, valueText } from './color_bar.js';
import { BOLD, fitting, FONT, HEAD, imageRects, label, PALETTES, SMALL, tracksEnd, yOf } from './layout.js';
import { CUTS, leftEdge } from './path.js';
import { DENSE, hatched, line, OUTSIDE, pointer, SPARSE } from './strokes.js';
import { depthNumber, depthUnit, inMetres, LENGTHS, showDepth, unitOf } from './units.js';
import { ticks } from './view.js';
import { drawZones, letterZones, nameZones, STRIP } from './zones.js';

const APART = 58; // pixels between two depths that are labelled
const APART_ACROSS = 12; // pixels between two values below the colours

// Return the depths at the ends of the axis, measured or true, and how a measured depth follows from them.
/** @param {View} view */
function axisOf({ top, bottom, bent }) {
  return bent ? { top: bent.top, bottom: bent.top + bent.length, at: (/** @type {number} */ tvd) => bent.depth((tvd - bent.top) / bent.length) } : { top, bottom, at: (/** @type {number} */ depth) => depth };
}

/** @param {Ink} ink @param {Look} look */
export function drawAxis(ink, { view, rects, zones }) {
  const palette = PALETTES[view.theme];
  const rect = rects.axis;
  const right = tracksEnd(rects);
  const { top, bottom, at } = axisOf(view);
  const { values, step } = ticks(top, bottom, rect.height, APART, LENGTHS[view.units].depth.scale);
  ink.fillStyle = palette.panel;
  for (const ground of [rects.caliper, rects.curves]) if (ground) ink.fillRect(ground.left, ground.top, ground.width, ground.height);
  drawZones(ink, zones, (depth) => yOf(view, rect, depth), rect.left, STRIP, [rect.top, rect.top + rect.height], palette);
  ink.lineWidth = 1;
  for (let depth = Math.ceil(top / (step / 5)) * (step / 5); depth <= bottom; depth += step / 5) {
    const y = Math.round(yOf(view, rect, at(depth))) + 0.5;
    line(ink, rect.left + rect.width - 4, y, rect.left + rect.width, y, palette.soft);
  }
  for (const depth of values) {
    const y = Math.round(yOf(view, rect, at(depth))) + 0.5;
    line(ink, rect.left + rect.width - 8, y, right, y, palette.grid);
    line(ink, rect.left + rect.width - 9, y, rect.left + rect.width, y, palette.ink);
  }
}

const PIXEL = 1 / LENGTHS.in.scale / 96; // metres of paper
/** @param {{ height: number }} of @param {number} scale */
export const scaleLength = ({ height }, scale) => height * PIXEL * scale; // metres of hole in a track at 1:scale

// Draw measured depth over true depth (on an axis of true depth the other way round) at every tick, and the letters of the zones. Texts that would touch the cursor's tag, which
// is drawn first, are left out.
/** @param {Ink} ink @param {Look} look */
export function drawAxisLabels(ink, look) {
  const { view, path, rects, store, zones } = look;
  const palette = PALETTES[view.theme];
  const rect = rects.axis;
  if (view.rig) nameZones(ink, look);
  else letterZones(ink, zones, (depth) => yOf(view, rect, depth), rect.left, [rect.top, rect.top + rect.height], palette);
  const end = rect.left + rect.width - 12;
  const unit = depthUnit(view.units);
  const { top, bottom, at } = axisOf(view);
  label(ink, `${view.rig ? 'depth' : view.bent ? 'TVD' : 'MD'} ${unit}`, end, 11, { colour: palette.ink, align: 'right', font: BOLD });
  if (path.trueDepth || !view.rig) label(ink, path.trueDepth ? `${view.bent ? 'MD' : 'TVD'} ${unit}` : path.surveyed ? 'no TVD' : 'no survey', end, 27, { colour: palette.soft, align: 'right', font: SMALL });
  const beside = rects.image.width && rects.image.left - end < 24; // whether the letters of the sides stand beside this
  if (beside && path.assumed && leftEdge(path, view.cut, view.middle).known) label(ink, 'assumed', end + 2, HEAD - 11, { colour: palette.soft, align: 'right', font: SMALL, yields: true });
  if (!view.rig && rects.image.width && !ink.canvas.slide) label(ink, `1:${Number(((bottom - top) / scaleLength(rect, 1)).toPrecision(3))}`, end, 43, { colour: palette.soft, align: 'right', font: SMALL });
  const { values, digits } = ticks(top, bottom, rect.height, APART, LENGTHS[view.units].depth.scale);
  for (const value of values) {
    const depth = at(value);
    const y = Math.round(yOf(view, rect, depth)) + 0.5;
    const high = y < rect.top + 12; // no room above the tick
    const alone = view.rig && !path.trueDepth; // at its tick
    label(ink, depthNumber(value, view.units, digits), end, alone ? y : high ? y + 1 : y - 1, { colour: palette.ink, halo: palette.paper, align: 'right', baseline: alone ? 'middle' : high ? 'top' : 'bottom', font: alone ? BOLD : FONT, yields: true });
    const other = !view.bent ? path.tvd(depth) : depth >= store.span[0] && depth <= store.span[1] ? depth : NaN;
    if (Number.isNaN(other) || high || y > rect.top + rect.height - 14) continue;
    label(ink, depthNumber(other, view.units, Math.max(digits, 1)), end, y + 1, { colour: palette.soft, halo: palette.paper, align: 'right', baseline: 'top', font: SMALL, yields: true });
  }
}

/** @param {Ink} ink @param {Look} look */
export function drawImageHead(ink, look) {
  const { view, quantity, path, rects } = look;
  const palette = PALETTES[view.theme];
  const { left, width } = rects.image;
  const known = leftEdge(path, view.cut, view.middle).known;
  const units = unitOf(quantity, view.units);
  if (!view.rig) {
    const mode = quantity.dynamic ? (width < 240 ? 'dynamic' : 'dynamic, 1 m') : quantity.inView ? (width < 240 ? 'in view' : 'range in view') : 'static';
    ink.font = SMALL;
    const usual = mode === 'static';
    const room = width - ink.measureText(mode).width - 10;
    ink.font = BOLD;
    const names = [quantity.name, quantity.name.replace(/(?<=bit) radius/, '')].map((name) => name + (units ? ` [${units}]` : ''));
    const whole = usual && ink.measureText(names[0]).width > room; // a long name takes the place of what is usual
    label(ink, fitting(ink, [...names, quantity.name], whole ? width - 4 : room), left + 2, 11, { colour: palette.ink, font: BOLD });
    if (!whole) label(ink, mode, left + width - 2, 11, { colour: usual ? palette.soft : palette.cursor, align: 'right', font: SMALL });
  }
  if (quantity.id) bar(ink, look, left + POINT, width - 2 * POINT, palette); // else the well has no such image
  letters(ink, look, known, legend(ink, look, left, palette), palette);
}

// Draw the colours with their values: at the ends, in the middle and halfway between, as far as there is room.
/** @param {Ink} ink @param {Look} look @param {number} left @param {number} width @param {Palette} palette */
function bar(ink, look, left, width, palette) {
  drawColours(ink, look, left, 20, width);
  ink.font = SMALL;
  /** @param {number} share */
  const at = (share) => {
    const text = valueText(look, share);
    const wide = ink.measureText(text).width;
    const start = share === 0 ? 0 : share === 1 ? width - wide : share * width - wide / 2;
    return { share, text, start, end: start + wide };
  };
  const ways = [[0, 0.25, 0.5, 0.75, 1], [0, 0.5, 1], [0, 1]].map((shares) => shares.map(at).filter(({ text }) => text));
  const shown = ways.find((values) => values.every(({ start }, i) => !i || start - values[i - 1].end >= APART_ACROSS)) ?? ways[2];
  for (const { share, text } of shown) label(ink, text, left + share * width, 37, { colour: palette.ink, align: share === 0 ? 'left' : share === 1 ? 'right' : 'center', font: SMALL });
}

// Return where the signs end.
/** @param {Ink} ink @param {Look} look @param {number} left @param {Palette} palette */
function legend(ink, { view, quantity, store: { basis, levels }, rects: { image } }, left, palette) {
  if (view.rig) {
    label(ink, quantity.length ? `${unitOf(quantity, view.units)} ${quantity.name.toLowerCase()}` : quantity.name, left, 52, { colour: palette.ink, font: SMALL });
    return left;
  }
  /** @type {[string, typeof DENSE][]} */
  const signs = [['no data', DENSE]];
  if (quantity.mode !== Q_ATTRIBUTE && basis === 'azimuthal') signs.push(['interpolated', SPARSE]);
  const end = signs.reduce((x, [text, hatching]) => {
    if (x + 16 + ink.measureText(text).width > image.left + image.width) return x;
    hatched(ink, x, 47, 12, 10, palette, hatching);
    ink.strokeStyle = palette.hatch;
    ink.strokeRect(x + 0.5, 47.5, 11, 9);
    label(ink, text, x + 16, 52, { colour: palette.soft, font: SMALL });
    return x + 28 + ink.measureText(text).width;
  }, left);
  if (!quantity.thin) return end;
  const each = `drawn each ${inMetres(Math.abs(levels[0].pitch))}`;
  label(ink, fitting(ink, [`rows of ${inMetres(quantity.thin)}, ${each}`, each], image.left + image.width - end), end, 52, { colour: palette.soft, font: SMALL });
  return Infinity;
}

/** @type {Record<string, string>} */
const SIDES = { U: 'up', D: 'down' }; // of rig mode

// Name the sides of the hole above the image; where they are not known, the tool's own angles, and why.
/** @param {Ink} ink @param {Look} look @param {boolean} known @param {number} end of the signs above them @param {Palette} palette */
function letters(ink, { view, path, rects }, known, end, palette) {
  const { left, width } = rects.image;
  const { letters: sides, reference, label: cut } = CUTS[view.cut];
  const edge = leftEdge(path, view.cut, view.middle).toolface;
  const names = known ? sides.map((side) => (view.rig && width > 130 && SIDES[side]) || side) : sides.map((_, i) => `${Math.round(edge + 90 * i) % 360}°`);
  names.forEach((name, i) => {
    const x = left + (i / 4) * width;
    line(ink, x, HEAD - 3, x, HEAD, palette.ink);
    if (i % 2 && (known ? view.rig : width < 125)) return; // no room
    label(ink, name, x + (i === 0 ? 1 : i === 4 ? -1 : 0), HEAD - 11, { colour: palette.ink, align: i === 0 ? 'left' : i === 4 ? 'right' : 'center', font: known ? BOLD : SMALL });
  });
  if (view.rig) return;
  const why = { up: 'vertical here', north: 'runs north', none: 'no survey' }[path.surveyed ? reference : 'none'];
  ink.font = SMALL;
  const text = (known ? [cut, cut.replace('cut at ', 'at ')] : [`${why}: the tool’s angles`, 'tool’s angles']).find((one) => end + ink.measureText(one).width < left + width);
  if (text) label(ink, text, left + width - 2, 52, { colour: palette.soft, align: 'right', font: SMALL });
}

// Return the stretches of the section above and below the wall, in pixels, each with its words: the start or the end of the data.
// At the end where the wall still grows, the words say that nothing is measured there yet.
/** @param {Look} look @param {Rect} rect */
export function outside({ view, store, growing }, rect) {
  const [shallow, deep] = store.span;
  const down = store.levels[0].pitch > 0;
  const bottom = rect.top + rect.height;
  /** @param {number} depth @param {boolean} drilled @param {string} end @param {string} edge */
  const words = (depth, drilled, end, edge) => {
    const at = showDepth(depth, view.units, 1) + (view.bent ? ' MD' : '');
    return growing && drilled ? [`data to ${at}, not measured yet`, `data to ${at}`, `to ${at}`, at] : [`${end} of data, ${at}`, `${end} of data`, `${edge} ${at}`, at];
  };
  return [
    { from: rect.top, to: Math.min(bottom, yOf(view, rect, shallow)), edge: 1, words: words(shallow, !down, 'start', 'from') },
    { from: Math.max(rect.top, yOf(view, rect, deep)), to: bottom, edge: 0, words: words(deep, down, 'end', 'to') },
  ].filter(({ from, to }) => to - from >= 2);
}

// Hatch the images and the caliper above and below the wall; the first image has the words, near the end of the wall.
/** @param {Ink} ink @param {Look} look */
export function drawOutside(ink, look) {
  const { view, rects } = look;
  const palette = PALETTES[view.theme];
  for (const { from, to, edge, words } of outside(look, rects.axis)) {
    for (const { left, width } of [...imageRects(rects), rects.caliper]) if (width) hatched(ink, left, from, width, to - from, palette, OUTSIDE);
    const away = Math.min((to - from) / 2, 16);
    ink.font = BOLD;
    const text = fitting(ink, words, rects.image.width - 4);
    const y = edge ? to - away : from + away;
    const onBit = look.bitDepth !== null && Math.abs(yOf(view, rects.axis, look.bitDepth) - 8 - y) < 14; // where the bit has its name
    if (rects.image.width && away > 9 && !onBit && !text.endsWith('…')) label(ink, text, rects.image.left + rects.image.width / 2, y, { colour: palette.ink, halo: palette.paper, align: 'center', font: BOLD });
  }
}

// Draws what marks one depth in all tracks: the bit, the pinned depths, the cursor's line with its depth, and its
// toolface on the images.
/** @param {Ink} ink @param {Look} look */
export function drawCursor(ink, look) {
  const { view, rects, bitDepth, oldBit } = look;
  const palette = PALETTES[view.theme];
  const rect = rects.axis;
  const right = tracksEnd(rects);
  if (bitDepth !== null && bitDepth >= view.top && bitDepth <= view.bottom) {
    const y = yOf(view, rect, bitDepth);
    const colour = oldBit ? palette.soft : palette.ink;
    line(ink, rect.left + rect.width, y, right, y, colour, [6, 4]);
    ink.font = BOLD;
    label(ink, fitting(ink, oldBit ? ['▼ bit was here', '▼ bit was'] : ['▼ bit'], (rects.image.width || right - rects.image.left) - 8), rects.image.left + (rects.image.width ? 4 : 12), y - 8, { colour, halo: palette.paper, font: BOLD });
  }
  for (const depth of view.pins) {
    if (depth < view.top || depth > view.bottom) continue;
    const y = Math.round(yOf(view, rect, depth)) + 0.5;
    line(ink, rects.image.left, y, right, y, palette.pin, [3, 3]);
  }
  if (!view.cursor && !view.rig && !ink.canvas.slide) pointer(ink, rect.left + rect.width, Math.round(yOf(view, rect, view.middle)) + 0.5, -9, palette.ink); // marks the middle of the section
  if (!view.cursor || view.cursor.depth < view.top || view.cursor.depth > view.bottom) return;
  const y = Math.round(yOf(view, rect, view.cursor.depth)) + 0.5;
  lineOnHalo(ink, rect.left + rect.width, y, right, y, palette);
  flag(ink, look, rect, y, palette);
  if (view.cursor.toolface === null || view.cursor.toolface === undefined) return;
  const edge = leftEdge(look.path, view.cut, view.cursor.depth).toolface;
  for (const { left, width } of imageRects(rects)) {
    const x = left + ((((view.cursor.toolface - edge) % 360) + 360) % 360) / 360 * width;
    lineOnHalo(ink, x, y - 7, x, y + 7, palette);
  }
}

// Draw a line that is seen on all colours.
/** @param {Ink} ink @param {number} x0 @param {number} y0 @param {number} x1 @param {number} y1 @param {Palette} palette */
function lineOnHalo(ink, x0, y0, x1, y1, palette) {
  line(ink, x0, y0, x1, y1, palette.panel, [], 3.6);
  line(ink, x0, y0, x1, y1, palette.ink);
}

// Draw the depth of the cursor, and the true depth under it if that is known, on a flag that points to the cursor's line.
/** @param {Ink} ink @param {Look} look @param {Rect} rect @param {number} y @param {Palette} palette */
function flag(ink, { view, path }, { left, top, width, height }, y, palette) {
  const depths = [view.cursor?.depth ?? NaN, path.tvd(view.cursor?.depth ?? NaN)].filter((depth) => !Number.isNaN(depth));
  const texts = depths.map((depth) => depthNumber(depth, view.units));
  ink.font = BOLD;
  const right = left + width;
  const from = right - 13 - Math.max(...texts.map((text) => ink.measureText(text).width));
  const tall = 1 + 15 * texts.length;
  const upper = Math.min(Math.max(y - tall / 2, top), top + height - tall);
  ink.fillStyle = palette.ink;
  ink.beginPath();
  for (const [px, py] of [[from, upper], [right - 6, upper], [right, y], [right - 6, upper + tall], [from, upper + tall]]) ink.lineTo(px, py);
  ink.fill();
  ink.fillStyle = palette.paper;
  ink.textAlign = 'right';
  ink.textBaseline = 'middle';
  texts.forEach((text, i) => {
    ink.font = i ? SMALL : BOLD;
    ink.fillText(text, right - 8, upper + 8 + 15 * i);
  });
  ink.canvas.labels.push({ text: texts.join(' '), left: from, right, top: upper - 2, bottom: upper + tall + 2, ground: true });
}
