// The cross-section at the cursor: one turn of the wall, looking down the hole, high side (or north) up.
// The bit is a dashed circle; rings are at round radii; C1 and C2 go across the hole. The area between bit and wall has the
// colours of the image of the radius over the bit; where the wall is interpolated between arms, its line is dotted and the
// area is pale. If the wall has an uncertainty, a band encloses 95 %. Kept sections are drawn in another colour. The view sets
// the shape's exaggeration, and the picture states it.

import { lookup, themed } from './color.js';
import { sized } from './device.js';
import { ACROSS } from './caliper.js';
import { axisOf } from './dips.js';
import { rowAt } from './curves.js';
import { BOLD, fitting, label, PALETTES, SMALL } from './layout.js';
import { CUTS, leftEdge } from './path.js';
import { measure, turn, uncertainties, unmeasured } from './turns.js';
import { niceStep } from './lod.js';
import { wrap360 } from './helix.js';
import { line } from './strokes.js';
import { LENGTHS, showAzimuth, showShare, showSigned } from './units.js';
import { FIRST, RADIUS } from './protocol.js';
import { MEASURES, sentence, zoneAt } from './zones.js';

const EDGE = 16; // pixels around the outer ring, for the letters
const ANGLES = 31; // pixels at the two sides of the outer ring, if angles are there in place of letters
const ROOM = 60; // pixels: a smaller outer ring has no room for the names of the diameters
const CHORDS = 48; // straight pieces of a circle, from which texts keep clear
const PALE = 0.4; // of a colour where the wall is interpolated

// The middle of the picture, the outer ring around it, and the room at its sides, in pixels.
/** @typedef {{ x: number, y: number, reach: number, side: number }} Middle */

// Return the turn at a depth: {k, radii, sure, between, measured, level}, from the wall; without radii if the page has not
// received that part of the wall. If `arms` is given, the diameters are those of the arms.
/** @param {Store} store @param {View} view @param {number} depth @param {Arms | null} arms */
export function turnAt(store, view, depth, arms) {
  const level = store.levels[0];
  const k = Math.max(0, level.turnAt(depth));
  const radii = turn(store, level, k, view.pass === 'first' ? FIRST : RADIUS);
  const measured = measure(radii);
  if (arms && measured.share) {
    const row = rowAt(arms.depth, depth - Math.abs(level.pitch) / 2);
    const maxAt = Math.round((wrap360(arms.axis[row] - level.toolface(k)) / 360) * radii.length) % radii.length || 0;
    Object.assign(measured, { min: arms.min[row], c1: arms.max[row], c2: arms.c2[row], maxAt });
  }
  return { k, radii, sure: uncertainties(store, level, k), between: unmeasured(level, k), measured, level };
}

// Return the direction on the dial, clockwise from the top of the picture, of the j-th vertex of a turn.
/** @param {Look} look @param {number} depth @param {Turn} found @param {number} j */
const dial = (look, depth, found, j) => wrap360(found.level.toolface(found.k + j) - zero(look, depth));
/** @param {Look} look @param {number} depth */
const zero = ({ path, view }, depth) => leftEdge(path, view.cut, depth).toolface - CUTS[view.cut].offset;

/** @param {Canvas} canvas @param {Look} look @param {Turn} found @param {Quantity} over */
export function drawPolar(canvas, look, found, over) {
  const { store, view } = look;
  const palette = PALETTES[view.theme];
  const { ink, width, height } = sized(canvas);
  ink.clearRect(0, 0, width, height);
  const depth = view.cursor?.depth ?? view.middle;
  const R = store.bitRadius;
  const shape = view.shape || 1;
  /** @param {number} r */
  const exaggerated = (r) => Math.max(0.1 * R, R + (r - R) * shape);
  const kept = view.pins.map((pin) => turnAt(store, view, pin, null));
  const widest = Math.max(R, ...[found, ...kept].map(({ measured }) => measured.radiusMax || R));
  const { scale: per } = LENGTHS[view.units];
  const step = niceStep((R / 3 / shape) * per) / per;
  const outer = Math.ceil(widest / step - 1e-9) * step;
  const inner = Math.round((R - R / 2 / shape) / step) * step;
  const side = leftEdge(look.path, view.cut, depth).known || width / 2 - ANGLES < ROOM - 1 ? EDGE : ANGLES;
  const reach = Math.max(10, Math.min(width / 2 - side, height / 2 - EDGE));
  /** @type {Middle} */
  const middle = { x: width / 2, y: height / 2, reach, side };
  const scale = reach / exaggerated(outer);
  /** @type {(turnFound: Turn, at: number) => Placing} */
  const placeOn = (turnFound, at) => {
    const up = zero(look, at);
    return (r, j) => {
      const angle = ((turnFound.level.toolface(turnFound.k + j) - up) * Math.PI) / 180;
      return [width / 2 + exaggerated(r) * scale * Math.sin(angle), height / 2 - exaggerated(r) * scale * Math.cos(angle)];
    };
  };
  const place = placeOn(found, depth);
  colourOver(ink, found, place, R, over, look.dark);
  for (const ring of [inner, outer]) circle(ink, middle, exaggerated(ring) * scale, palette.line, 1);
  ink.setLineDash([5, 4]);
  circle(ink, middle, R * scale, palette.ink, 1.2);
  ink.setLineDash([]);
  kept.forEach((pin, i) => outline(ink, pin, placeOn(pin, view.pins[i]), palette.pin, 1.1));
  outline(ink, found, place, palette.ink, 1.8);
  band(ink, found, place, palette.cursor);
  letters(ink, middle, look, depth, palette);
  diameters(ink, found, place, middle, palette);
  const { cursor } = view;
  if (cursor && cursor.toolface !== null) hand(ink, look, /** @type {Aim} */ (cursor), found, scale, exaggerated, width, height, palette);
  corners(ink, middle, `${Number((outer * per).toFixed(3))} ${LENGTHS[view.units].unit}`, view.shape, palette);
  /** @type {Pair[]} */
  const near = [12, 15, 19].flatMap((out) => [135, 120, 150, 105, 165, 225, 240, 210, 45, 30, 60].map((at) => /** @type {Pair} */ ([(R * scale - out) * Math.sin((at * Math.PI) / 180), -(R * scale - out) * Math.cos((at * Math.PI) / 180)])));
  label(ink, 'bit', middle.x, middle.y, { colour: palette.soft, align: 'center', font: SMALL, halo: palette.panel, near, yields: true });
}

// Colour the area between bit and wall, each sector in the colour that the image has for its radius.
/** @param {Ink} ink @param {Turn} found @param {Placing} place @param {number} R @param {Quantity} over @param {boolean} dark */
function colourOver(ink, { radii, between }, place, R, { map, low, high }, dark) {
  if (!(high > low)) return; // not chosen yet
  const table = lookup(themed(map, dark));
  radii.forEach((r, a) => {
    const b = (a + 1) % radii.length;
    const mean = (r + radii[b]) / 2;
    if (Number.isNaN(mean)) return;
    const at = 4 * Math.round(255 * Math.min(1, Math.max(0, (mean - R - low) / (high - low))));
    ink.beginPath();
    for (const corner of [place(R, a), place(r, a), place(radii[b], b), place(R, b)]) ink.lineTo(...corner);
    ink.closePath();
    ink.fillStyle = ink.strokeStyle = `rgb(${table.subarray(at, at + 3).join()})`;
    ink.lineWidth = 0.8;
    ink.globalAlpha = between[a] ? PALE : 1;
    ink.fill();
    if (!between[a]) ink.stroke(); // no gap to the next
  });
  ink.globalAlpha = 1;
}

// Draw a mark on the wall at the cursor's toolface.
/** @param {Ink} ink @param {Look} look @param {Aim} cursor @param {Turn} turn @param {number} scale @param {(radius: number) => number} exaggerated @param {number} width @param {number} height @param {Palette} palette */
function hand(ink, look, { depth, toolface }, { level, k, radii }, scale, exaggerated, width, height, palette) {
  const angle = ((toolface - zero(look, depth)) * Math.PI) / 180;
  const j = Math.floor((wrap360(toolface - level.toolface(k)) / 360) * radii.length) % radii.length;
  const reach = scale * exaggerated(Number.isNaN(radii[j]) ? look.store.bitRadius : radii[j]);
  ink.beginPath();
  for (const end of [reach - 9, reach + 7]) ink.lineTo(width / 2 + end * Math.sin(angle), height / 2 - end * Math.cos(angle));
  ink.strokeStyle = palette.cursor;
  ink.lineWidth = 2;
  ink.stroke();
}

/** @param {Ink} ink @param {Middle} middle @param {number} radius @param {string} colour @param {number} lineWidth */
function circle(ink, { x, y }, radius, colour, lineWidth) {
  /** @type {Pair[]} */
  const around = Array.from({ length: CHORDS + 1 }, (_, i) => [x + radius * Math.cos((2 * Math.PI * i) / CHORDS), y + radius * Math.sin((2 * Math.PI * i) / CHORDS)]);
  around.slice(1).forEach((end, i) => ink.canvas.strokes.push([...around[i], ...end]));
  ink.beginPath();
  ink.arc(x, y, radius, 0, 2 * Math.PI);
  ink.strokeStyle = colour;
  ink.lineWidth = lineWidth;
  ink.stroke();
}

/** @param {Ink} ink @param {Turn} found @param {Placing} place @param {string} colour @param {number} lineWidth */
function outline(ink, found, place, colour, lineWidth) {
  const K = found.radii.length;
  const [measured, dotted] = [new Path2D(), new Path2D()];
  for (let j = 0; j < K; j++) {
    const [a, b] = [j, (j + 1) % K].map((i) => (Number.isNaN(found.radii[i]) ? null : place(found.radii[i], i)));
    if (!a || !b) continue;
    const edge = found.between[j] || found.between[(j + 1) % K] ? dotted : measured;
    ink.canvas.strokes.push([...a, ...b]);
    edge.moveTo(a[0], a[1]);
    edge.lineTo(b[0], b[1]);
  }
  ink.strokeStyle = colour;
  ink.lineWidth = lineWidth;
  ink.stroke(measured);
  ink.globalAlpha = 0.6;
  ink.setLineDash([1.5, 3]);
  ink.stroke(dotted);
  ink.setLineDash([]);
  ink.globalAlpha = 1;
}

// Draw the band in which the wall lies with a probability of 95 %: one piece for each sector, so that a gap stays a gap.
/** @param {Ink} ink @param {Turn} turn @param {Placing} place @param {string} colour */
function band(ink, { radii, sure }, place, colour) {
  ink.fillStyle = colour;
  ink.globalAlpha = 0.3;
  ink.beginPath();
  radii.forEach((_, a) => {
    const b = (a + 1) % radii.length;
    const ends = [a, b].map((i) => [radii[i] - sure[i], radii[i] + sure[i]]);
    if (ends.flat().some(Number.isNaN)) return;
    ink.moveTo(...place(ends[0][0], a));
    ink.lineTo(...place(ends[0][1], a));
    ink.lineTo(...place(ends[1][1], b));
    ink.lineTo(...place(ends[1][0], b));
  });
  ink.fill();
  ink.globalAlpha = 1;
}

// Draw C1 and C2 across the hole, as in the caliper track, with names at the lines where there is room.
/** @param {Ink} ink @param {Turn} turn @param {Placing} place @param {Middle} middle @param {Palette} palette */
function diameters(ink, { radii, measured }, place, { x, y, reach }, palette) {
  const K = radii.length;
  if (Number.isNaN(measured.c1)) return;
  const both = [measured.maxAt, Math.round(measured.maxAt + K / 4)].map((at) => [at, at + Math.floor(K / 2)].map((j) => place(radii[j % K], j % K)));
  both.forEach(([a, b], i) => line(ink, ...a, ...b, palette.max, i ? ACROSS : [], 1.4));
  if (reach < ROOM) return;
  both.forEach((ends, i) => {
    const [ex, ey] = ends[0][i] > ends[1][i] ? ends[0] : ends[1];
    const [along, far] = [[ex - x, ey - y], Math.hypot(ex - x, ey - y)];
    /** @type {Pair[]} */
    const near = [0.62, 0.45, 0.8, 0.3, 0.95, -0.62, -0.45, -0.8, -0.3].flatMap((share) => [1, -1].map((side) => /** @type {Pair} */ ([share * along[0] - (side * 14 * along[1]) / far, share * along[1] + (side * 14 * along[0]) / far])));
    label(ink, `C${i + 1}`, x, y, { colour: palette.max, align: 'center', font: BOLD, halo: palette.panel, near, yields: true });
  });
}

// Write the letters, or else the angles, of the four sides of the picture.
/** @param {Ink} ink @param {Middle} middle @param {Look} look @param {number} depth @param {Palette} palette */
function letters(ink, { x, y, reach, side }, { view, path }, depth, palette) {
  const known = leftEdge(path, view.cut, depth).known;
  const names = !known ? ['0°', '90°', '180°', '270°'] : CUTS[view.cut].reference === 'up' ? ['U', 'R', 'D', 'L'] : ['N', 'E', 'S', 'W'];
  names.forEach((name, i) => {
    if (!known && side === EDGE && i % 2) return; // no room for angles at the sides
    const [dx, dy] = [[0, -1], [1, 0], [0, 1], [-1, 0]][i];
    const align = /** @type {const} */ (['center', 'right', 'center', 'left'])[i];
    label(ink, name, x + dx * (reach + side - 2), y + dy * (reach + EDGE / 2), { colour: palette.ink, align, font: known ? BOLD : SMALL, halo: palette.panel });
  });
}

// Write what the picture shows: which way it looks, the radius of the outer ring, the exaggeration.
/** @param {Ink} ink @param {Middle} middle @param {string} ring @param {number} shape @param {Palette} palette */
function corners(ink, { x, y, reach, side }, ring, shape, palette) {
  const [half, above] = [reach + side - 2, reach + EDGE / 2 + 1];
  ink.font = SMALL;
  label(ink, fitting(ink, ['down hole', ''], half - 9), x - half, y - above, { colour: palette.soft });
  label(ink, fitting(ink, [`radius ${ring}`, ring], half - 9), x + half, y - above, { colour: palette.soft, align: 'right' });
  if (shape > 1) label(ink, `shape × ${shape}`, x + half, y + above, { colour: palette.ink, align: 'right', yields: true });
}

// Return what is written beside the picture, as pairs of name and text.
/** @param {Look} look @param {Turn} found @param {(metres: number, digits?: number) => string} show */
export function turnText(look, found, show) {
  const { cursor, middle, units } = look.view;
  const depth = cursor?.depth ?? middle;
  const zone = zoneAt(look.zones, depth);
  const { measured } = found;
  const share = showShare(1 - found.between.reduce((sum, one) => sum + one, 0) / found.between.length);
  const azimuth = zone?.kind === 'breakout' ? axisOf(look.path, (zone.start + zone.stop) / 2, zone.toolface) : '';
  /** @param {number} j */
  const axis = (j) => `${(dial(look, depth, found, j) % 180).toFixed(0)}°`;
  const of = look.arms ? ' of arms' : '';
  const equivalent = 2 * Math.sqrt(measured.area / Math.PI);
  return [
    [`C1${of}${Number.isNaN(measured.c1) ? '' : ` at ${axis(measured.maxAt)}`}`, show(measured.c1)],
    [`C2${of}`, show(measured.c2)],
    ['Least', show(Number.isNaN(measured.c1) ? NaN : measured.min)],
    ['Area diameter', show(equivalent)],
    ...certainty(found.sure, show),
    ...(zone ? [['Zone', `${sentence(zone)}, ${share} of the turn measured`.replaceAll(' %', '\u00a0%')], [MEASURES[zone.kind], showSigned(zone.measure, units, units === 'mm' ? 0 : 1)], ...(azimuth ? [['Azimuth', azimuth]] : zone.toolface === undefined ? [] : [['Toolface', `${showAzimuth(zone.toolface)}°`]])] : [['Turn measured', share], ['Zone', 'none']]),
  ];
}

// Return the 95 % uncertainty of a radius, the mean over the turn, as a row of text; no row if it is not known.
/** @param {Float64Array} sure @param {(metres: number, digits?: number) => string} show */
function certainty(sure, show) {
  const known = sure.filter((one) => !Number.isNaN(one));
  return known.length ? [['Radius, 95 %', `± ${show(known.reduce((sum, one) => sum + one, 0) / known.length)}`]] : [];
}
