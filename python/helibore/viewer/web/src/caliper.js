// The caliper track: the diameters by which zones are judged. C1 is a solid line, C2 a dashed
// line, bit size black dashes. Orange fills from bit size to C2, pale orange from C2 to C1, blue from the least diameter to bit
// size. Turns without a diameter are
// hatched; turns interpolated between arms are hatched sparsely. What lies beyond the scale is written at its edge.

import { rowAt } from './curves.js';
import { BOLD, depthAt, fitting, HEAD, label, PALETTES, SMALL, yOf } from './layout.js';
import { niceStep } from './lod.js';
import { edges, hatched, line, sharp, SPARSE } from './strokes.js';
import { tileTurns } from './turns.js';
import { LENGTHS } from './units.js';

const LASTING = 0.25; // metres that are seen in the scale in any case

// Returns the least diameter and the greatest C1 and C2 of the turns under each pixel row, as {min, max, c2, seen, between};
// of a turn with a missing radius, the least and the greatest diameter that are known. `seen` is 0 beyond the wall; `between`
// is 1 where a turn is mostly interpolated between arms. If `arms` is given, the diameters are those of the arms.
/** @param {Look} look */
export function profile({ store, view, imagePieces, rects, arms }) {
  const rect = { top: 0, height: rects.image.height };
  const rows = Math.ceil(rect.height);
  const [min, max, c2] = [0, 1, 2].map(() => new Float32Array(rows).fill(NaN));
  const [seen, between] = [0, 1].map(() => new Uint8Array(rows));
  const found = { min, max, c2, seen, between, rows: Math.ceil((rows * LASTING) / (view.bottom - view.top)) + 1 };
  for (const { tile, top, bottom } of imagePieces) {
    const turns = tileTurns(store, tile, view.pass === 'first');
    const { pitch } = tile.level;
    const last = (tile.level.shown - 1 - tile.index * tile.level.tileSize) / tile.level.sectors;
    const [from, stop] = [top, bottom].map((depth) => yOf(view, rect, depth));
    for (let y = Math.max(0, Math.floor(from)); y < Math.min(rows, stop); y++) {
      const upper = depthAt(view, rect, y);
      const lower = depthAt(view, rect, y + 1);
      const a = (upper - tile.startDepth) / pitch;
      const b = (lower - tile.startDepth) / pitch;
      const end = Math.min(Math.max(a, b), tile.level.rows - 1, last - 1);
      for (let row = Math.max(0, Math.floor(Math.min(a, b))); row <= end; row++) {
        seen[y] = 1;
        between[y] |= turns.between[row];
        if (!arms) widen(found, y, turns, row);
      }
      if (!arms || !seen[y]) continue;
      const below = rowAt(arms.depth, lower + Math.abs(pitch) / 2);
      for (let row = rowAt(arms.depth, upper - Math.abs(pitch) / 2); row < below; row++) widen(found, y, arms, row);
    }
  }
  return found;
}

// Extend the ranges of pixel row y so that they include a turn; missing diameters are ignored.
/** @param {Profile} found @param {number} y @param {Pick<TileTurns | Arms, 'min' | 'max' | 'c2'>} turns @param {number} row */
function widen({ min, max, c2 }, y, turns, row) {
  if (!(min[y] <= turns.min[row]) && !Number.isNaN(turns.min[row])) min[y] = turns.min[row];
  if (!(max[y] >= turns.max[row]) && !Number.isNaN(turns.max[row])) max[y] = turns.max[row];
  if (!(c2[y] >= turns.c2[row]) && !Number.isNaN(turns.c2[row])) c2[y] = turns.c2[row];
}

// Return the lines of the scale, from its low to its high end: round numbers of a unit of which `per` make a metre. The scale
// covers the diameters that the colours of the radius cover (`low` to `high` over bit radius), so that a hole of bit size looks
// as smooth as its image, and what lasts in view: the widest C2 and the tightest diameter that `rows` pixel rows together have.
/** @param {number} bit @param {Profile} of @param {{ low: number, high: number }} colours @param {number} [per] */
export function scaleFor(bit, { min, c2, rows }, { low, high }, per = 1000) {
  const lasting = (/** @type {Float32Array} */ values, /** @type {'min' | 'max'} */ end) => values.map((_, y) => Math[end](...values.subarray(y, y + rows))).filter(Number.isFinite);
  const widest = Math.max(bit + 2 * Math.max(high, 0.02 * bit), ...lasting(c2, 'min'));
  const tightest = Math.min(bit + 2 * Math.min(low, -0.02 * bit), ...lasting(min, 'max'));
  return linesOf(tightest, widest, per);
}

// Return the lines of a scale from one diameter to another, in a unit of which `per` make a metre.
/** @param {number} low @param {number} high @param {number} per */
export function linesOf(low, high, per) {
  const step = niceStep(((high - low) / 6) * per);
  const first = Math.floor((low * per) / step + 1e-9);
  const last = Math.ceil((high * per) / step - 1e-9);
  return Array.from({ length: last - first + 1 }, (_, i) => ((first + i) * step) / per);
}

// Draw the track; `scale` are the lines of its scale, else those of the wall alone.
/** @param {Ink} ink @param {Look} look @param {number[]} [scale] */
export function drawCaliper(ink, look, scale) {
  const { store, view, rects } = look;
  const palette = PALETTES[view.theme];
  const rect = rects.caliper;
  const bit = 2 * store.bitRadius;
  const found = profile(look);
  if (!rect.width) return found; // the track is not shown
  const { min, max, c2, seen, between } = found;
  const grid = scale ?? scaleFor(bit, found, look.over, LENGTHS[view.units].scale);
  const [low, high] = [grid[0], grid[grid.length - 1]];
  /** @param {number} diameter */
  const x = (diameter) => rect.left + ((diameter - low) / (high - low)) * rect.width;
  for (const diameter of grid.slice(1, -1)) line(ink, x(diameter), rect.top, x(diameter), rect.top + rect.height, palette.grid);
  ink.save();
  ink.beginPath();
  ink.rect(rect.left, rect.top, rect.width, rect.height);
  ink.clip();
  runs(seen, (y) => seen[y] && Number.isNaN(min[y]), (start, tall) => hatched(ink, rect.left, rect.top + start, rect.width, tall, palette));
  const middle = () => x(bit);
  fill(ink, rect.top, min, x, middle, palette.fills.under);
  fill(ink, rect.top, max, middle, x, palette.fills['partly over']);
  fill(ink, rect.top, c2, middle, x, palette.fills.over);
  runs(between, (y) => between[y], (start, tall) => hatched(ink, rect.left, rect.top + start, rect.width, tall, palette, SPARSE));
  curve(ink, rect, c2, x, palette.max, ACROSS);
  curve(ink, rect, max.map((value, y) => (Number.isNaN(c2[y]) ? NaN : value)), x, palette.max);
  line(ink, x(bit), rect.top, x(bit), rect.top + rect.height, palette.ink, [5, 4]);
  beyond(ink, rect, max, high, 1, view, palette);
  beyond(ink, rect, min, low, -1, view, palette);
  ink.restore();
  edges(ink, sharp(rect), palette.line);
  head(ink, look, rect, [low, bit, high], x, palette);
  return found;
}

// Fill each pixel row from one place to another, which its size gives, all rows at once, so that no seam is seen between them.
/** @param {Ink} ink @param {number} top @param {Float32Array} sizes @param {(size: number) => number} from @param {(size: number) => number} to @param {string} colour */
function fill(ink, top, sizes, from, to, colour) {
  ink.beginPath();
  sizes.forEach((size, y) => {
    const left = from(size);
    const width = to(size) - left;
    if (width > 0) ink.rect(left, top + y, width, 1);
  });
  ink.fillStyle = colour;
  ink.fill();
}

/** @param {{ length: number }} rows @param {(y: number) => unknown} isIn @param {(start: number, tall: number) => void} draw */
function runs({ length }, isIn, draw) {
  for (let y = 0; y < length; y++) {
    const start = y;
    while (y < length && isIn(y)) y++;
    if (y > start) draw(start, y - start);
  }
}

const APART = 14; // pixels from one number to the next

// Write at an edge of the track the farthest size of each stretch of rows beyond that end of the scale; `side` is -1 at the left.
/** @param {Ink} ink @param {Rect} rect @param {Float32Array} sizes @param {number} end @param {1 | -1} side @param {Look['view']} view @param {Palette} palette */
function beyond(ink, { left, top, width }, sizes, end, side, view, palette) {
  runs(sizes, (y) => sizes.subarray(y, y + APART).some((size) => side * size > side * end), (start, tall) => {
    const far = side * Math.max(...sizes.subarray(start, start + tall + APART).map((size) => side * size || -Infinity));
    const text = sizeIn(view)(far);
    label(ink, side > 0 ? `${text} →` : `← ${text}`, left + (side > 0 ? width - 2 : 2), top + sizes.indexOf(far, start), { colour: palette.ink, halo: palette.paper, align: side > 0 ? 'right' : 'left', font: SMALL });
  });
}

// Return a function that writes a diameter in the units of the view: 216, 157.5; 8.5, 12.25.
/** @param {Look['view']} view @returns {(size: number) => string} */
const sizeIn = ({ units }) => (size) => String(Number((size * LENGTHS[units].scale).toFixed(units === 'mm' ? 1 : 3)));

export const ACROSS = [3, 2]; // dashes of C2, as in print

/** @param {Ink} ink @param {Rect} rect @param {Float32Array} values @param {(value: number) => number} x @param {string} colour @param {number[]} [dash] */
function curve(ink, rect, values, x, colour, dash = []) {
  ink.strokeStyle = colour;
  ink.lineWidth = 1.4;
  ink.setLineDash(dash);
  ink.beginPath();
  let drawing = false;
  for (let y = 0; y < values.length; y++) {
    if (Number.isNaN(values[y])) drawing = false;
    else {
      ink[drawing ? 'lineTo' : 'moveTo'](x(values[y]), rect.top + y + 0.5);
      drawing = true;
    }
  }
  ink.stroke();
  ink.setLineDash([]);
}

/** @param {Ink} ink @param {Look} look @param {Rect} rect @param {number[]} ends @param {(value: number) => number} x @param {Palette} palette */
function head(ink, { view, store }, { left, width }, [low, bit, high], x, palette) {
  const { unit } = LENGTHS[view.units];
  const show = sizeIn(view);
  ink.font = BOLD;
  const title = fitting(ink, [`Caliper [${unit}]`, `Cal. ${unit}`, 'Cal.'], width - 4);
  label(ink, title, left + 2, 11, { colour: palette.ink, font: BOLD });
  ink.font = SMALL;
  if (store.basis === 'average') label(ink, fitting(ink, ['mean, shape not measured', 'mean, no shape', 'mean'], width - 4), left + 2, 29, { colour: palette.max, font: SMALL });
  else {
    const from = ['C1', 'C2'].map((name, i) => {
      const at = left + 2 + (i * width) / 2;
      label(ink, name, at, 28, { colour: palette.max, font: BOLD });
      const start = at + ink.measureText(name).width + 3;
      line(ink, start, 28, Math.min(start + 24, left + ((i + 1) * width) / 2 - 3), 28, palette.max, i ? ACROSS : [], 1.4);
      return at;
    });
    ink.fillStyle = palette.fills.under;
    ink.fillRect(from[0], 38, 12, 8);
    label(ink, fitting(ink, ['least, under bit', 'least'], width - 20), from[0] + 16, 42, { colour: palette.soft, font: SMALL });
  }
  label(ink, show(low), left + 2, HEAD - 25, { colour: palette.soft, font: SMALL });
  label(ink, show(high), left + width - 2, HEAD - 25, { colour: palette.soft, align: 'right', font: SMALL });
  const text = `bit ${show(bit)}`;
  label(ink, text, Math.max(x(bit), left + ink.measureText(text).width / 2), HEAD - 9, { colour: palette.ink, align: 'center', font: SMALL });
}

