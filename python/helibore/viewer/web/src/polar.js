// The cross-section at the cursor: one turn of the wall, looking down the hole, high side (or north) up.
// Bit circle dashed, smallest and largest diameter with their directions, filled beyond the bit; dotted where it is
// interpolated between arms; a band of 95 % if the wall has its uncertainty; kept sections behind. The view sets the shape's
// exaggeration, and the picture states it.

import { pen, pixelRatio } from './device.js';
import { BOLD, FONT, label, PALETTES, SMALL } from './layout.js';
import { CUTS, leftEdge } from './path.js';
import { attributeOf, measure, turn, unmeasured } from './turns.js';
import { niceStep } from './lod.js';
import { wrap360 } from './helix.js';
import { LENGTHS } from './units.js';
import { FIRST, RADIUS } from './protocol.js';
import { zoneAt, zoneText } from './zones.js';

const CERTAIN = 1.96; // standard deviations that enclose 95 %

// The turn at a depth: {k, radii, sigma, between, measured, level}, from the wall; without radii where the page has not
// received that part of the wall.
/** @param {Store} store @param {View} view @param {number} depth */
export function turnAt(store, view, depth) {
  const level = store.levels[0];
  const k = Math.max(0, level.turnAt(depth));
  const radii = turn(store, level, k, view.pass === 'first' ? FIRST : RADIUS);
  return { k, radii, sigma: attributeOf(store, level, k, 'sigma'), between: unmeasured(level, k), measured: measure(radii), level };
}

// Direction on the dial, clockwise from the top of the picture, of the j-th vertex of a turn.
/** @param {Look} look @param {number} depth @param {Turn} found @param {number} j */
const dial = (look, depth, found, j) => wrap360(found.level.toolface(found.k + j) - zero(look, depth));
/** @param {Look} look @param {number} depth */
const zero = ({ path, view }, depth) => leftEdge(path, view.cut, depth).toolface - CUTS[view.cut].offset;

// Pixels across that the picture has: a text of angles at its sides needs more than a letter.
/** @param {number} width @param {number} height */
const across = (width, height) => Math.min(width - 24, height);

/** @param {Canvas} canvas @param {Look} look @param {Turn} found */
export function drawPolar(canvas, look, found) {
  const { store, view } = look;
  const palette = PALETTES[view.theme];
  const { ink, width, height } = sized(canvas);
  ink.clearRect(0, 0, width, height);
  const depth = view.cursor?.depth ?? view.middle;
  const R = store.bitRadius;
  /** @param {number} r */
  const exaggerated = (r) => Math.max(0.1 * R, R + (r - R) * (view.shape || 1));
  const kept = view.pins.map((pin) => turnAt(store, view, pin));
  const widest = Math.max(R, ...[found, ...kept].map(({ measured }) => exaggerated(measured.radiusMax || R)));
  const scale = (across(width, height) / 2 - 20) / (widest * 1.04);
  /** @type {(turnFound: Turn, at: number) => Placing} */
  const placeOn = (turnFound, at) => {
    const up = zero(look, at);
    return (r, j) => {
      const angle = ((turnFound.level.toolface(turnFound.k + j) - up) * Math.PI) / 180;
      return [width / 2 + exaggerated(r) * scale * Math.sin(angle), height / 2 - exaggerated(r) * scale * Math.cos(angle)];
    };
  };
  const place = placeOn(found, depth);
  outline(ink, found, (r, j) => place(Math.max(r, R), j), 'transparent', palette.fills.over);
  disc(ink, width / 2, height / 2, R * scale, found.measured.share === 1 ? palette.fills.under : palette.panel);
  outline(ink, found, (r, j) => place(Math.min(r, R), j), 'transparent', palette.panel);
  rings(ink, look, width, height, scale, palette);
  kept.forEach((pin, i) => outline(ink, pin, placeOn(pin, view.pins[i]), palette.pin, null));
  outline(ink, found, place, palette.ink, 'transparent');
  band(ink, found, place, palette.cursor);
  diameters(ink, found, place, palette);
  const { cursor } = view;
  if (cursor && cursor.toolface !== null) hand(ink, look, /** @type {Aim} */ (cursor), found, scale, exaggerated, width, height, palette);
  letters(ink, look, depth, width, height, palette);
  if (view.shape > 1) label(ink, `shape × ${view.shape}`, width - 2, height - 7, { colour: palette.ink, align: 'right', font: SMALL });
}

// Where around the hole the cursor is.
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

/** @param {Ink} ink @param {Look} look @param {number} width @param {number} height @param {number} scale @param {Palette} palette */
function rings(ink, { store, view }, width, height, scale, palette) {
  const R = store.bitRadius;
  ink.strokeStyle = palette.ink;
  ink.lineWidth = 1.2;
  ink.setLineDash([5, 4]);
  ink.beginPath();
  ink.arc(width / 2, height / 2, R * scale, 0, 2 * Math.PI);
  ink.stroke();
  ink.setLineDash([]);
  const { scale: per, unit } = LENGTHS[view.units];
  const length = niceStep((R / 3) * per) / per;
  const y = height - 7;
  ink.beginPath();
  ink.moveTo(4, y);
  ink.lineTo(4 + length * scale, y);
  ink.stroke();
  const digits = unit === 'in' && length * per < 1 ? 1 : 0;
  label(ink, `${(length * per).toFixed(digits)} ${unit}`, 4, y - 9, { colour: palette.soft, font: SMALL });
  label(ink, 'bit', width / 2 + R * scale * 0.7 - 14, height / 2 + R * scale * 0.7 - 14, { colour: palette.soft, align: 'center', font: SMALL });
}

/** @param {Ink} ink @param {number} x @param {number} y @param {number} radius @param {string} colour */
function disc(ink, x, y, radius, colour) {
  ink.fillStyle = colour;
  ink.beginPath();
  ink.arc(x, y, radius, 0, 2 * Math.PI);
  ink.fill();
}

/** @param {Ink} ink @param {Turn} found @param {Placing} place @param {string} colour @param {string | null} fill */
function outline(ink, found, place, colour, fill) {
  const K = found.radii.length;
  const [filled, measured, dotted] = [new Path2D(), new Path2D(), new Path2D()];
  for (let j = 0; j < K; j++) {
    const [a, b] = [j, (j + 1) % K].map((i) => (Number.isNaN(found.radii[i]) ? null : place(found.radii[i], i)));
    if (!a || !b) continue;
    filled[j ? 'lineTo' : 'moveTo'](a[0], a[1]);
    const edge = found.between[j] || found.between[(j + 1) % K] ? dotted : measured;
    edge.moveTo(a[0], a[1]);
    edge.lineTo(b[0], b[1]);
  }
  if (fill && found.measured.share === 1) {
    ink.fillStyle = fill;
    ink.fill(filled);
  }
  ink.strokeStyle = colour;
  ink.lineWidth = fill ? 1.8 : 1.1;
  ink.stroke(measured);
  ink.globalAlpha = 0.6;
  ink.setLineDash([1.5, 3]);
  ink.stroke(dotted);
  ink.setLineDash([]);
  ink.globalAlpha = 1;
}

// Where the wall is with a probability of 95 %: one piece a sector, so that a gap stays a gap.
/** @param {Ink} ink @param {Turn} turn @param {Placing} place @param {string} colour */
function band(ink, { radii, sigma }, place, colour) {
  ink.fillStyle = colour;
  ink.globalAlpha = 0.3;
  ink.beginPath();
  radii.forEach((_, a) => {
    const b = (a + 1) % radii.length;
    const ends = [a, b].map((i) => [radii[i] - CERTAIN * sigma[i], radii[i] + CERTAIN * sigma[i]]);
    if (ends.flat().some(Number.isNaN)) return;
    ink.moveTo(...place(ends[0][0], a));
    ink.lineTo(...place(ends[0][1], a));
    ink.lineTo(...place(ends[1][1], b));
    ink.lineTo(...place(ends[1][0], b));
  });
  ink.fill();
  ink.globalAlpha = 1;
}

/** @param {Ink} ink @param {Turn} turn @param {Placing} place @param {Palette} palette */
function diameters(ink, { radii, measured }, place, palette) {
  const K = radii.length;
  /** @type {[number, string][]} */
  const both = [[measured.maxAt, palette.max], [measured.minAt, palette.min]];
  for (const [at, colour] of both) {
    const far = (at + Math.floor(K / 2)) % K;
    if (Number.isNaN(radii[at]) || Number.isNaN(radii[far])) continue;
    ink.beginPath();
    ink.moveTo(...place(radii[at], at));
    ink.lineTo(...place(radii[far], far));
    ink.strokeStyle = colour;
    ink.lineWidth = 1.4;
    ink.stroke();
  }
}

/** @param {Ink} ink @param {Look} look @param {number} depth @param {number} width @param {number} height @param {Palette} palette */
function letters(ink, look, depth, width, height, palette) {
  const { reference } = CUTS[look.view.cut];
  const known = leftEdge(look.path, look.view.cut, depth).known;
  const names = !known ? ['0°', '90°', '180°', '270°'] : reference === 'up' ? ['U', 'R', 'D', 'L'] : ['N', 'E', 'S', 'W'];
  const side = across(width, height) / 2 - 8;
  names.forEach((name, i) => {
    const [dx, dy] = [[0, -1], [1, 0], [0, 1], [-1, 0]][i];
    label(ink, name, width / 2 + dx * side, height / 2 + dy * side, { colour: palette.ink, align: 'center', font: known ? BOLD : SMALL, halo: palette.panel });
  });
  label(ink, 'down hole', 2, 7, { colour: palette.soft, font: SMALL });
}

// What is written beside the picture: pairs of name and text.
/** @param {Look} look @param {Turn} found @param {(metres: number, digits?: number) => string} show */
export function turnText(look, found, show) {
  const depth = look.view.cursor?.depth ?? look.view.middle;
  const { measured } = found;
  /** @param {number} j */
  const axis = (j) => `${(dial(look, depth, found, j) % 180).toFixed(0)}°`;
  const equivalent = 2 * Math.sqrt(measured.area / Math.PI);
  const known = !Number.isNaN(measured.min);
  return [
    ['Cmin', known ? `${show(measured.min)} @ ${axis(measured.minAt)}` : '–'],
    ['Cmax', known ? `${show(measured.max)} @ ${axis(measured.maxAt)}` : '–'],
    ['Area diameter', show(equivalent)],
    ...certainty(found.sigma, show),
    ['Turn measured', `${(100 * (1 - found.between.reduce((sum, one) => sum + one, 0) / found.between.length)).toFixed(0)} %`],
    ['Zone', zoneText(zoneAt(look.zones, depth), look.view.units)],
  ];
}

// How sure the radii of the turn are, in the mean, if that is known.
/** @param {Float64Array} sigma @param {(metres: number, digits?: number) => string} show */
function certainty(sigma, show) {
  const known = sigma.filter((one) => !Number.isNaN(one));
  return known.length ? [['Radius, 95 %', `± ${show((CERTAIN * known.reduce((sum, one) => sum + one, 0)) / known.length)}`]] : [];
}

/** @param {Canvas} canvas */
export function sized(canvas) {
  const ratio = pixelRatio(canvas);
  const { clientWidth: width, clientHeight: height } = canvas;
  const [w, h] = [Math.round(width * ratio), Math.round(height * ratio)];
  if (canvas.width !== w || canvas.height !== h) [canvas.width, canvas.height] = [w, h];
  const ink = pen(canvas);
  canvas.labels = [];
  ink.setTransform(ratio, 0, 0, ratio, 0, 0);
  ink.font = FONT;
  return { ink, width, height };
}
