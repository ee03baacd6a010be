// The ink over the 3-D view: the hole's axis in gaps, zones and depths beside the hole, the compass, the exaggerations in words.

import { themed } from './color.js';
import { BAR, drawColourBar } from './color_bar.js';
import { anglesInWords, wallPoint } from './dips.js';
import { drawInsideInk } from './inside_ink.js';
import { BOLD, FONT, HEAD, label, PALETTES, SMALL, SMALL_BOLD, within } from './layout.js';
import { niceStep } from './lod.js';
import { edges, line } from './strokes.js';
import { drawDiscs, ROWS, topsOf } from './plane_rings.js';
import { turn } from './turns.js';
import { LENGTHS, showDepth } from './units.js';
import { dot, eastNorthUp, minus, scaled } from './vectors.js';
import { CAMERAS, ticks } from './view.js';
import { isSure } from './zones.js';

// The arms of the compass: name, and direction (east, north, up).
/** @type {[string, number[]][]} */
const ARROWS = [['N', [0, 1, 0]], ['E', [1, 0, 0]], ['up', [0, 0, 1]]];

/** @param {Ink} ink @param {Looks} look @param {Gpu} gpu @param {Profile} calipers @param {Planes} planes */
export function drawWallInk(ink, look, gpu, calipers, planes) {
  const { view, path, store, rects } = look;
  const palette = PALETTES[view.theme];
  const rect = { ...rects.wall, height: rects.wall.height - (rects.image.width ? 0 : BAR) };
  const tube = view.tubeFactor(store);
  ink.save();
  ink.beginPath();
  const top = view.camera === 'outside' ? HEAD : 0;
  ink.rect(rect.left, top, rect.width, rect.height - top);
  ink.clip();
  const picked = planes.kept.some(({ depth }) => depth > view.top && depth < view.bottom);
  const words = view.camera !== 'outside' && (view.shape || 1) === 1 ? ['true to scale'] : [`tube × ${tube}${picked && tube > 1 ? ': traces on it look flatter' : ''}`, ...(picked && tube > 1 && view.camera === 'outside' ? ['discs of picks have their true dip'] : []), `shape × ${view.shape || 1} about the bit radius`];
  if (view.camera === 'outside' && store.basis === 'azimuthal') words.push('see-through: not sure');
  if (view.camera === 'outside' && store.plan.length) words.push('dashed: planned path', ...offPlan(look));
  if (picked && !(view.camera === 'outside' && rects.image.width)) words.push(anglesInWords(path)); // else the legend below the tracks says it
  if (view.median > 1) words.push(`median of ${view.median} turns`);
  if (!path.surveyed) words.unshift('no survey: drawn vertical');
  if (view.camera !== 'outside') words.unshift(CAMERAS[view.camera], ...(path.surveyed && path.dial(view.middle).up !== null ? ['high side up'] : []), ...(look.dark && themed(look.quantity.map, true) !== look.quantity.map ? ['colours of the light page'] : []));
  ink.font = FONT;
  const lines = view.rig ? [] : inLines(ink, words, rect.width - (view.camera === 'outside' ? 200 : path.surveyed ? 110 : 20)).reverse();
  const { labels } = ink.canvas; // texts keep off the compass and off the words
  const foot = { text: '', left: rect.left, right: rect.left + (path.surveyed ? 88 : 0), top: rect.height - 88, bottom: rect.height };
  const wide = view.camera === 'outside' ? Math.max(0, ...lines.map((text) => ink.measureText(text).width)) + 10 : rect.width;
  const at = labels.push(foot, { ...foot, left: rect.left + rect.width - wide, right: rect.left + rect.width, top: rect.height - 6 - 16 * lines.length }) - 2;
  if (view.camera === 'outside') outsideInk(ink, look, gpu, calipers, planes, palette);
  else drawInsideInk(ink, look, gpu, planes, rect.width > 500 ? 16 * lines.length : 88); // 88: the compass
  labels.splice(at, 2);
  if (path.surveyed) {
    if (view.camera !== 'outside') disc(ink, rect, palette); // the rock is as dark or as bright as the arms
    compass(ink, gpu, rect, palette);
    if (view.camera === 'outside' && rect.width > 300) plan(ink, look, gpu, palette);
  }
  lines.forEach((text, i) => label(ink, text, rect.left + rect.width - 10, rect.height - 14 - 16 * i, { colour: palette.ink, halo: palette.paper, align: 'right' }));
  ink.restore();
  if (!rects.image.width) drawColourBar(ink, look, rect.height + BAR / 2);
}

// Return the words in as few lines as the width allows.
/** @param {Ink} ink @param {string[]} words @param {number} width */
function inLines(ink, words, width) {
  /** @type {string[]} */
  const lines = [];
  for (const word of words) {
    const longer = [...lines.slice(-1), word].join('   ');
    if (lines.length && ink.measureText(longer).width <= width) lines[lines.length - 1] = longer;
    else lines.push(word);
  }
  return lines;
}

/** @param {Ink} ink @param {Looks} look @param {Gpu} gpu @param {Profile} calipers @param {Planes} planes @param {Palette} palette */
function outsideInk(ink, look, gpu, calipers, planes, palette) {
  const { view, path, store, rects } = look;
  const rect = rects.wall;
  const tube = view.tubeFactor(store);
  const tops = topsOf(look, planes);
  unmeasured(ink, look, gpu, calipers, palette);
  const writeAngles = drawDiscs(ink, look, planes, gpu, tops);
  zonesBeside(ink, look, gpu, palette);
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
  const named = [...tops.values()];
  for (const [name, start] of look.intervals.filter(([one]) => !named.includes(one))) {
    const at = start > view.top && start < view.bottom && gpu.project(path.at(start), rect, gpu.aside(path.at(start), -beside));
    ink.font = SMALL_BOLD;
    if (!at) continue;
    const edge = gpu.project(path.at(start), rect, gpu.aside(path.at(start), -store.bitRadius * tube));
    const left = Math.max(at[0] - 4, rect.left + 4 + ink.measureText(name).width);
    const place = label(ink, name, left, at[1], { colour: palette.top, halo: palette.paper, align: 'right', font: SMALL_BOLD, near: ROWS, yields: true });
    if (edge && place) line(ink, left + 2 + place[0], at[1] + place[1], ...edge, palette.top, [], 1.5);
  }
  scaleBar(ink, look, gpu, palette);
  dashed(ink, planAlong(look).map((centre) => gpu.project({ centre }, rect)), palette.max);
  cursorLabel(ink, look, gpu, beside, palette);
}

// Draw a bar with its length, as it is in the middle of the section.
/** @param {Ink} ink @param {Look} look @param {Gpu} gpu @param {Palette} palette */
function scaleBar(ink, { view, path, rects: { wall: rect } }, gpu, palette) {
  const frame = path.at(view.middle);
  const [a, b] = [0, 1].map((metres) => gpu.project(frame, rect, scaled(gpu.camera.axes[0], metres)));
  if (a && b) bar(ink, rect.left + 92, rect.height - 46, b[0] - a[0], view, palette); // beside the compass
}

// Draw a bar of at least 40 pixels, with its length above it.
/** @param {Ink} ink @param {number} x @param {number} y @param {number} perMetre @param {View} view @param {Palette} palette */
function bar(ink, x, y, perMetre, { units }, palette) {
  const { scale, unit } = LENGTHS[units].depth;
  const perUnit = perMetre / scale; // pixels
  const size = niceStep(40 / perUnit);
  for (const [from, to] of [[[x, y], [x + size * perUnit, y]], ...[x, x + size * perUnit].map((end) => [[end, y - 4], [end, y + 4]])]) line(ink, from[0], from[1], to[0], to[1], palette.ink, [], 2);
  label(ink, `${Number(size.toPrecision(2))} ${unit}`, x, y - 12, { colour: palette.ink, halo: palette.paper, font: SMALL });
}

// Return how far a point is from a line through points; NaN before its first and beyond its last point.
/** @param {number[][]} points @param {number[]} centre */
export function farFrom(points, centre) {
  let [least, beyond] = [Infinity, true];
  points.slice(1).forEach((point, i) => {
    const [along, to] = [minus(point, points[i]), minus(centre, points[i])];
    const share = dot(along, to) / dot(along, along);
    const away = Math.hypot(...minus(to, scaled(along, Math.min(1, Math.max(0, share)))));
    if (away < least) [least, beyond] = [away, (i === 0 && share < 0) || (i === points.length - 2 && share > 1)];
  });
  return beyond ? NaN : least;
}

// Return in words how far the hole is from the planned path where the wall ends, and where it is farthest.
/** @param {Look} look */
function offPlan({ view: { units }, path, store: { plan: points, span } }) {
  const all = Array.from({ length: 61 }, (_, i) => span[0] + ((span[1] - span[0]) * i) / 60)
    .map((depth) => ({ depth, away: farFrom(points, path.at(depth).centre) })).filter(({ away }) => !Number.isNaN(away));
  const [end, most] = [all[all.length - 1], all.reduce((far, one) => (one.away > far.away ? one : far), all[0])];
  /** @param {{ depth: number, away: number }} of */
  const words = ({ depth, away }) => `${showDepth(away, units, 1)} off it at ${showDepth(depth, units, 0)}`;
  return !end ? [] : most.away - end.away < 0.05 ? [`${words(end)}, the most`] : [words(end), `at most ${words(most)}`];
}

// Draw the planned path.
/** @param {Ink} ink @param {(number[] | null)[]} points @param {string} colour */
function dashed(ink, points, colour) {
  ink.beginPath();
  for (const point of points) if (point) ink.lineTo(point[0], point[1]);
  ink.strokeStyle = colour;
  ink.lineWidth = 2;
  ink.setLineDash([7, 4]);
  ink.stroke();
  ink.setLineDash([]);
}

// Return the points of the planned path beside the section, and one at each side.
/** @param {Look} look */
function planAlong({ view, path, store: { plan: points } }) {
  const [a, b] = [view.top, view.bottom].map((depth) => {
    const { centre } = path.at(depth);
    const away = points.map((point) => Math.hypot(...minus(point, centre)));
    return away.indexOf(Math.min(...away));
  });
  return points.slice(Math.max(0, Math.min(a, b) - 1), Math.max(a, b) + 2);
}

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
  cursorRing(ink, look, view.cursor.depth, gpu, palette);
  const at = gpu.project(frame, rects.wall, gpu.aside(frame, -beside));
  if (at) label(ink, showDepth(view.cursor.depth, view.units), at[0] - 6, at[1] + 4, { colour: palette.cursor, halo: palette.paper, align: 'right', font: BOLD, near: [[0, 0], [0, -16], [0, 16], [0, -32], [0, 32]] });
}

/** @param {Ink} ink @param {Rect} rect @param {Palette} palette */
function disc(ink, { left, height }, { paper }) {
  ink.beginPath();
  ink.arc(left + 44, height - 46, 42, 0, 7);
  ink.fillStyle = `${paper}cc`;
  ink.fill();
}

/** @param {Ink} ink @param {Gpu} gpu @param {Rect} rect @param {Palette} palette */
export function compass(ink, gpu, rect, palette) {
  const [x, y] = [rect.left + 44, rect.height - 46];
  const arms = ARROWS.map(([name, direction]) => ({ name, at: gpu.facing(direction) }));
  for (const { at: [dx, dy, towards] } of arms) line(ink, x, y, x + 26 * dx, y - 26 * dy, towards > 0 ? palette.ink : palette.soft);
  for (const { name, at: [dx, dy] } of arms) {
    const far = 26 + 10 / (Math.hypot(dx, dy) || 1); // ten pixels past the tip, however short the arm is seen
    label(ink, name, x + far * dx, y - far * dy, { colour: palette.ink, halo: palette.paper, align: 'center', font: SMALL, near: [[0, 0], [10, 0], [-10, 0], [0, 12], [0, -12], [16, 10], [-16, 10]] });
  }
}

const PLAN = 92; // pixels of its side

// Draw the hole seen from above, north up, with the section and the cursor on it, and what of the planned path is there.
/** @param {Ink} ink @param {Look} look @param {Gpu} gpu @param {Palette} palette */
function plan(ink, { view, path, store, rects }, gpu, palette) {
  const [shallow, deep] = store.span;
  const along = Array.from({ length: 61 }, (_, i) => shallow + ((deep - shallow) * i) / 60);
  /** @param {number} depth */
  const place = (depth) => path.at(depth).centre;
  const all = along.map(place);
  const [[n0, n1], [e0, e1]] = [0, 1].map((axis) => [Math.min(...all.map((at) => at[axis])), Math.max(...all.map((at) => at[axis]))]);
  const size = Math.max(n1 - n0, e1 - e0);
  if (size < 1) return; // vertical
  const [near, top] = [rects.wall.left + 10, HEAD + 26];
  const hidden = along.some((_, i) => {
    const [x, y] = gpu.project(path.at(view.top + (view.length * i) / 60), rects.wall) ?? [near + 999, 0];
    return x < near + PLAN + 30 && y < top + PLAN + 30;
  });
  const left = hidden ? rects.wall.left + rects.wall.width - PLAN - 10 : near; // at the side where it hides no hole
  /** @param {number[]} centre @returns {Pair} */
  const spot = ([north, east]) => [left + PLAN / 2 + ((east - (e0 + e1) / 2) / size) * (PLAN - 16), top + PLAN / 2 - ((north - (n0 + n1) / 2) / size) * (PLAN - 16)];
  /** @param {number} depth */
  const at = (depth) => spot(place(depth));
  ink.fillStyle = `${palette.paper}cc`;
  ink.fillRect(left, top - 16, PLAN, PLAN + 40);
  edges(ink, { left, top, width: PLAN, height: PLAN }, palette.line);
  label(ink, 'plan, N up', left, top - 8, { colour: palette.soft, halo: palette.paper, font: SMALL });
  bar(ink, left + 8, top + PLAN + 18, (PLAN - 16) / size, view, palette);
  const shown = along.filter((depth) => depth > view.top && depth < view.bottom);
  const ends = [view.top, view.bottom].map((depth) => Math.min(deep, Math.max(shallow, depth)));
  for (const [depths, colour, width] of /** @type {[number[], string, number][]} */ ([[along, palette.soft, 1.4], [[ends[0], ...shown, ends[1]], palette.ink, 4]])) {
    ink.beginPath();
    for (const depth of depths) ink.lineTo(...at(depth));
    ink.strokeStyle = colour;
    ink.lineWidth = width;
    ink.stroke();
  }
  within(ink, { left, top, width: PLAN, height: PLAN }, () => dashed(ink, store.plan.map(spot), palette.max));
  if (!view.cursor) return;
  ink.fillStyle = palette.cursor;
  ink.beginPath();
  ink.arc(...at(view.cursor.depth), 4, 0, 7);
  ink.fill();
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
