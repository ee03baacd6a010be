// The ink over the picture: depth axis, heads with scales and letters, the cursor's line through every track, labels
// in the 3-D view. (caliper.js and map.js draw their own tracks.) Everything here is drawn anew for each frame.

import { MAPS, Q_ATTRIBUTE, themed } from './colour.js';
import { drawInsideInk } from './inside.js';
import { BOLD, FONT, HEAD, label, PALETTES, SMALL, tracksEnd, yOf } from './layout.js';
import { CUTS, leftEdge } from './path.js';
import { DENSE, hatched, line, SPARSE } from './strokes.js';
import { scaleOf, showDepth, unitOf } from './units.js';
import { CAMERAS, ticks } from './view.js';
import { drawZones } from './zones.js';

const APART = 58; // pixels between two depths that are labelled

export function drawAxis(ink, { view, rects, zones }) {
  const palette = PALETTES[view.theme];
  const rect = rects.axis;
  const right = tracksEnd(rects);
  const { values, step } = ticks(view.top, view.bottom, rect.height, APART);
  drawZones(ink, zones, (depth) => yOf(view, rect, depth), rect.left, 12, [rect.top, rect.top + rect.height], palette);
  ink.lineWidth = 1;
  for (let depth = Math.ceil(view.top / (step / 5)) * (step / 5); depth <= view.bottom; depth += step / 5) {
    const y = Math.round(yOf(view, rect, depth)) + 0.5;
    line(ink, rect.left + rect.width - 4, y, rect.left + rect.width, y, palette.soft);
  }
  for (const depth of values) {
    const y = Math.round(yOf(view, rect, depth)) + 0.5;
    line(ink, rect.left + rect.width - 8, y, right, y, palette.grid);
    line(ink, rect.left + rect.width - 9, y, rect.left + rect.width, y, palette.ink);
  }
}

// Measured depth over true depth at every tick; both give way to the cursor's tag, which is there first.
export function drawAxisLabels(ink, { view, path, rects }) {
  const palette = PALETTES[view.theme];
  const rect = rects.axis;
  const end = rect.left + rect.width - 12;
  label(ink, 'MD m', end, HEAD - 34, { colour: palette.ink, align: 'right', font: BOLD });
  label(ink, path.trueDepth ? 'TVD m' : path.surveyed ? 'no TVD' : 'no survey', end, HEAD - 17, { colour: palette.soft, align: 'right', font: SMALL });
  const { values, digits } = ticks(view.top, view.bottom, rect.height, APART);
  for (const depth of values) {
    const y = Math.round(yOf(view, rect, depth)) + 0.5;
    if (y < rect.top + 12 || y > rect.top + rect.height - 14) continue;
    label(ink, depth.toFixed(digits), end, y - 1, { colour: palette.ink, align: 'right', baseline: 'bottom', font: FONT, yields: true });
    const tvd = path.tvd(depth);
    if (Number.isNaN(tvd)) continue;
    label(ink, tvd.toFixed(Math.max(digits, 1)), end, y + 1, { colour: palette.soft, align: 'right', baseline: 'top', font: SMALL, yields: true });
  }
}

export function drawImageHead(ink, look) {
  const { view, quantity, path, rects } = look;
  const palette = PALETTES[view.theme];
  const { left, width } = rects.image;
  const cut = CUTS[view.cut];
  const known = leftEdge(path, view.cut, view.middle).known;
  const units = unitOf(quantity, view.units);
  if (!view.rig) label(ink, quantity.name + (units ? ` [${units}]` : ''), left + 2, 11, { colour: palette.ink, font: BOLD });
  const mode = quantity.dynamic ? 'dynamic, 1 m' : 'static';
  if (!view.rig) label(ink, mode, left + width - 2, 11, { colour: quantity.dynamic ? palette.cursor : palette.soft, align: 'right', font: SMALL });
  const bar = ink.createLinearGradient(left, 0, left + width, 0);
  const { anchors } = MAPS[themed(quantity.map, view.theme === 'dark')];
  anchors.forEach((c, i) => bar.addColorStop(i / (anchors.length - 1), `rgb(${c.map(Math.round).join(' ')})`));
  ink.fillStyle = bar;
  ink.fillRect(left, 20, width, 8);
  ends(ink, look, left, width, palette);
  letters(ink, cut.letters, known, left, width, palette, path.surveyed ? cut.reference : 'none');
}

function ends(ink, { view, quantity }, left, width, palette) {
  const scale = scaleOf(quantity, view.units);
  const show = (v) => (quantity.dynamic ? (v === quantity.low ? 'mean − 2σ' : 'mean + 2σ') : Number((v * scale).toPrecision(3)).toString().replace('-', '−'));
  label(ink, show(quantity.low), left, 37, { colour: palette.ink, font: SMALL });
  label(ink, show(quantity.high), left + width, 37, { colour: palette.ink, align: 'right', font: SMALL });
  if (view.rig) return;
  const legend = [['no data', DENSE], ...(quantity.mode === Q_ATTRIBUTE ? [] : [[width < 240 ? 'between arms' : 'interpolated between arms', SPARSE]])];
  legend.reduce((x, [text, hatching]) => {
    hatched(ink, x, 47, 12, 10, palette, hatching);
    ink.strokeStyle = palette.hatch;
    ink.strokeRect(x + 0.5, 47.5, 11, 9);
    label(ink, text, x + 16, 52, { colour: palette.soft, font: SMALL });
    return x + 28 + ink.measureText(text).width;
  }, left);
}

function letters(ink, names, known, left, width, palette, reference) {
  if (!known) {
    const why = { up: 'vertical here: angles from the tool’s zero', north: 'runs north: angles from the tool’s zero', none: 'no survey: angles from the tool’s zero' }[reference];
    label(ink, why, left + width / 2, HEAD - 8, { colour: palette.soft, align: 'center', font: SMALL });
    return;
  }
  names.forEach((name, i) => {
    const x = left + (i / 4) * width;
    line(ink, x, HEAD - 3, x, HEAD, palette.ink);
    label(ink, name, x + (i === 0 ? 1 : i === 4 ? -1 : 0), HEAD - 11, { colour: palette.ink, align: i === 0 ? 'left' : i === 4 ? 'right' : 'center', font: BOLD });
  });
}

// Between the newest sample and the bit nothing is measured yet.
export function drawAhead(ink, { view, rects, store, bitDepth }) {
  if (bitDepth === null) return;
  const palette = PALETTES[view.theme];
  const { top, height } = rects.image;
  const [from, to] = [store.end, bitDepth].sort((a, b) => a - b).map((depth) => Math.min(top + height, Math.max(top, yOf(view, rects.image, depth))));
  if ((bitDepth - store.end) * store.levels[0].pitch <= 0 || to - from < 2) return;
  for (const { left, width } of [rects.image, rects.caliper]) if (width) hatched(ink, left, from, width, to - from, palette);
  if (to - from > 24) label(ink, 'not measured yet', rects.image.left + rects.image.width / 2, (from + to) / 2, { colour: palette.ink, halo: palette.paper, align: 'center', font: SMALL });
}

// The same depth through every track: the cursor's line with its depth, and the bit.
export function drawCursor(ink, look) {
  const { view, rects, bitDepth } = look;
  const palette = PALETTES[view.theme];
  const rect = rects.axis;
  const right = tracksEnd(rects);
  if (bitDepth !== null && bitDepth >= view.top && bitDepth <= view.bottom) {
    const y = yOf(view, rect, bitDepth);
    line(ink, rect.left + rect.width, y, right, y, palette.ink, [6, 4]);
    label(ink, '▼ bit', rects.image.left + 4, y - 8, { colour: palette.ink, halo: palette.paper, font: BOLD });
  }
  for (const depth of view.pins) {
    if (depth < view.top || depth > view.bottom) continue;
    const y = Math.round(yOf(view, rect, depth)) + 0.5;
    line(ink, rects.image.left, y, right, y, palette.pin, [3, 3]);
  }
  if (!view.cursor || view.cursor.depth < view.top || view.cursor.depth > view.bottom) return;
  const y = Math.round(yOf(view, rect, view.cursor.depth)) + 0.5;
  line(ink, rect.left, y, right, y, palette.cursor);
  const text = showDepth(view.cursor.depth);
  ink.font = BOLD;
  const wide = ink.measureText(text).width + 10;
  ink.fillStyle = palette.cursor;
  ink.fillRect(rect.left + rect.width - wide, y - 9, wide, 18);
  label(ink, text, rect.left + rect.width - 5, y, { colour: '#ffffff', align: 'right', margin: 5 });
  if (view.cursor.toolface === null || view.cursor.toolface === undefined) return;
  const edge = leftEdge(look.path, view.cut, view.cursor.depth).toolface;
  const x = rects.image.left + ((((view.cursor.toolface - edge) % 360) + 360) % 360) / 360 * rects.image.width;
  line(ink, x, y - 7, x, y + 7, palette.cursor);
}

// In the 3-D view: the hole's axis in gaps, zones and depths beside the hole, the compass, the exaggerations in words.
export function drawWallInk(ink, look, gpu, calipers) {
  const { view, path, store, rects } = look;
  const palette = PALETTES[view.theme];
  const rect = rects.wall;
  const tube = view.tubeFactor(store);
  ink.save();
  ink.beginPath();
  ink.rect(rect.left, HEAD, rect.width, rect.height - HEAD);
  ink.clip();
  if (view.camera === 'outside') outsideInk(ink, look, gpu, calipers, palette);
  else drawInsideInk(ink, look, gpu);
  if (path.surveyed && view.camera === 'outside') compass(ink, gpu, rect, palette);
  const words = [`tube × ${tube}`, `shape × ${view.shape} about the bit radius`];
  if (view.median > 1) words.push(`median of ${view.median} turns`);
  if (!path.surveyed) words.unshift('no survey: drawn vertical');
  if (view.camera !== 'outside') words.unshift(CAMERAS[view.camera]);
  if (!view.rig) label(ink, words.join('   '), rect.left + rect.width - 10, rect.height - 14, { colour: palette.ink, halo: palette.paper, align: 'right', font: FONT });
  ink.restore();
}

function outsideInk(ink, look, gpu, calipers, palette) {
  const { view, path, store, rects } = look;
  const rect = rects.wall;
  const tube = view.tubeFactor(store);
  unmeasured(ink, look, gpu, calipers, palette);
  zonesBeside(ink, look, gpu, palette);
  const { values, digits } = ticks(view.top, view.bottom, rect.height, 76);
  const beside = store.bitRadius * tube * 1.3;
  const used = [];
  const [shallow, deep] = store.span;
  for (const depth of values.filter((value) => value >= shallow && value <= deep)) {
    const frame = path.at(depth);
    const at = frame && gpu.project(frame, rect, gpu.aside(frame, beside));
    if (!at || used.some(([x, y]) => Math.abs(y - at[1]) < 16 && Math.abs(x - at[0]) < 70)) continue;
    used.push(at);
    const axis = gpu.project(frame, rect);
    const level = Math.abs(at[0] - axis[0]) < Math.abs(at[1] - axis[1]); // the label stands over the hole, not beside it
    const text = `${depth.toFixed(digits)} m`;
    label(ink, text, at[0] + (level ? 0 : 8), at[1] - (level ? 12 : 0), { colour: palette.ink, halo: palette.paper, font: SMALL, align: level ? 'center' : 'left' });
    if (level) line(ink, at[0], at[1] - 6, at[0], at[1] + 2, palette.soft);
    else line(ink, at[0] - 2, at[1], at[0] + 6, at[1], palette.soft);
  }
  cursorLabel(ink, look, gpu, beside, palette);
}

// A stroke beside the hole along every zone in view.
function zonesBeside(ink, { view, path, store, rects, zones }, gpu, palette) {
  const beside = -1.25 * store.bitRadius * view.tubeFactor(store);
  for (const { kind, start, stop } of zones) {
    const depths = [Math.max(start, view.top), Math.min(stop, view.bottom)];
    if (depths[1] <= depths[0]) continue;
    const ends = depths.map((depth) => path.at(depth)).map((frame) => frame && gpu.project(frame, rects.wall, gpu.aside(frame, beside)));
    if (!ends[0] || !ends[1]) continue;
    ink.strokeStyle = palette.zones[kind];
    ink.lineWidth = 5;
    ink.beginPath();
    ink.moveTo(...ends[0]);
    ink.lineTo(...ends[1]);
    ink.stroke();
  }
}

// The axis of the hole, dashed, through every gap of the wall in view and from its end to the bit.
function unmeasured(ink, { view, path, store, rects, bitDepth }, gpu, { min, seen }, palette) {
  const depthOf = (y) => view.top + (y / min.length) * view.length;
  const ahead = bitDepth === null ? [] : [store.end, bitDepth].sort((a, b) => a - b);
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

function cursorLabel(ink, { view, path, rects }, gpu, beside, palette) {
  if (!view.cursor || view.cursor.depth < view.top || view.cursor.depth > view.bottom) return;
  const frame = path.at(view.cursor.depth);
  const at = frame && gpu.project(frame, rects.wall, gpu.aside(frame, -beside));
  if (at) label(ink, showDepth(view.cursor.depth), at[0] - 6, at[1] + 4, { colour: palette.cursor, halo: palette.paper, align: 'right', font: BOLD });
}

function compass(ink, gpu, rect, palette) {
  const [x, y] = [rect.left + 44, rect.height - 46];
  const used = [];
  for (const [name, direction] of [['N', [0, 1, 0]], ['E', [1, 0, 0]], ['up', [0, 0, 1]]]) {
    const [dx, dy, towards] = gpu.facing(direction);
    line(ink, x, y, x + 26 * dx, y - 26 * dy, towards > 0 ? palette.ink : palette.soft);
    const clear = used.every(([a, b]) => Math.hypot(dx - a, dy - b) > 0.45);
    used.push([dx, dy]);
    const far = 26 + 10 / Math.hypot(dx, dy); // ten pixels past the tip, however short the arm is seen
    if (Math.hypot(dx, dy) > 0.25 && clear) label(ink, name, x + far * dx, y - far * dy, { colour: palette.ink, halo: palette.paper, align: 'center', font: SMALL });
  }
}
