// What is coloured and how: the quantities, their colour maps and the ends of their colours, which the server chooses once
// from the whole wall. A user may fit these ends to the values in view.
//
//   colour = map[(value - low) / (high - low)], of their logarithms on a logarithmic scale      no value: hatched grey
//
// Static: one range everywhere, so a colour is a value. Dynamic: the range at each depth is the mean plus and minus two
// standard deviations of a window around it, which brings out layers; then a colour is NOT a value. In view: one range for the
// section that is shown, from the values of this section; the range changes with the section.

import definition from '../../../base/color_maps.json' with { type: 'json' };
import { FIRST, NEAREST, RADIUS, RESCANNED, STATE, SUPPORT_MASK, TEXEL } from './protocol.js';

/** @param {string} text */
const hex = (text) => text.split(' ').map((c) => [0, 2, 4].map((i) => parseInt(c.slice(i, i + 2), 16)));

// The colour maps by name, from the file that meshes and pictures also use. No map contains the grey of missing values.
export const MAPS = Object.fromEntries(
  Object.entries(definition.maps).map(([name, { label, stops }]) => [name, { label, anchors: hex(stops) }]),
);

const NEAR_BIT = 0.008; // metres

// Return a quantity with the ends of its colours in rig mode, unless the user chose ends: a few millimetres are seen from afar, and
// hole of bit size is pale in every wall.
/** @param {Quantity} of @returns {Quantity} */
export const nearBit = (of) => (of.id === 'over' && !of.chosen ? { ...of, low: -NEAR_BIT, high: NEAR_BIT } : of);

// In dark mode, a map whose neutral colour is the colour of the page is replaced by its dark version.
/** @param {string} map @param {boolean} dark */
export const themed = (map, dark) => (dark && MAPS[`${map}-dark`] ? `${map}-dark` : map);

/** @param {string} name @param {number} [count] */
export function lookup(name, count = 256) {
  const { anchors } = MAPS[name] ?? MAPS.viridis;
  const table = new Uint8Array(4 * count);
  for (let i = 0; i < count; i++) {
    const place = (i / (count - 1)) * (anchors.length - 1);
    const a = Math.min(Math.floor(place), anchors.length - 2);
    const t = place - a;
    for (let c = 0; c < 3; c++) table[4 * i + c] = Math.round(anchors[a][c] + t * (anchors[a + 1][c] - anchors[a][c]));
    table[4 * i + 3] = 255;
  }
  return table;
}

export const [Q_RADIUS, Q_OVER, Q_NEAREST, Q_SUPPORT, Q_CHANGE, Q_ATTRIBUTE] = [0, 1, 2, 3, 4, 5];

// Return the quantities of a wall, attributes last. Lengths are in metres; `length` marks lengths, for the units on screen. In a
// gauge hole only the attributes are measured.
/** @param {Pick<Store, 'attributes' | 'basis'>} store @returns {Quantity[]} */
export function quantities(store) {
  const [low, high] = [NaN, NaN];
  const own = store.attributes.map(({ name, unit, log, color_map: map, rows, thin }, attribute) => (
    { id: name, name: name === 'difference' ? 'Change since earlier passes' : name, mode: Q_ATTRIBUTE, attribute, unit, log, low, high, map, length: unit === 'm', rows, thin }
  ));
  const wall = [
    { id: 'over', name: 'Over bit radius', mode: Q_OVER, length: true, low, high, map: 'over-bit' },
    { id: 'radius', name: 'Radius', mode: Q_RADIUS, length: true, low, high, map: 'over-bit' },
    { id: 'nearest', name: 'Nearest sample', mode: Q_NEAREST, length: true, low, high, map: 'cividis' },
    { id: 'support', name: 'Samples used', mode: Q_SUPPORT, unit: '', low: 0, high: 8, map: 'cividis' },
    { id: 'change', name: 'Change since first pass', mode: Q_CHANGE, length: true, low: -0.01, high: 0.01, map: 'difference' },
  ];
  const measured = own.some(({ map }) => map === 'difference') ? wall.slice(0, -1) : wall; // the difference to an earlier pass is the change
  const kept = store.basis !== 'gauge' ? measured : own.length ? [] : [{ ...wall[0], name: 'Not measured' }];
  return [...kept, ...own].map((quantity) => ({ dynamic: false, inView: false, log: false, chosen: false, ...quantity }));
}

// Return the quantity with this id; if there is none, the first quantity.
/** @param {Quantity[]} all @param {string} id */
export const quantityOf = (all, id) => all.find((quantity) => quantity.id === id) ?? all[0];

// Take the ends of the colours that the server chose, unless the user or the address chose other ends. Return whether an end changed.
/** @param {Quantity[]} all @param {Record<string, Pair>} ranges */
export function takeRanges(all, ranges) {
  let changed = false;
  for (const quantity of all) {
    const ends = quantity.chosen ? null : ranges[quantity.id];
    if (!ends || (ends[0] === quantity.low && ends[1] === quantity.high)) continue;
    [quantity.low, quantity.high] = ends;
    changed = true;
  }
  return changed;
}

// Return a quantity's value at the vertex with place `at` in a tile; NaN if there is none. `pass` 'first' reads the first pass.
/** @param {Store} store @param {Quantity} quantity @param {Tile} tile @param {number} at @param {Pass} [pass] */
export function valueAt(store, quantity, tile, at, pass = 'latest') {
  const t = TEXEL * at;
  const { texels } = tile;
  if (quantity.mode === Q_ATTRIBUTE) return tile.columns[quantity.attribute ?? -1]?.[at] ?? NaN; // also where the wall has no radius
  if (texels[t + RADIUS] === 0) return NaN;
  const radius = texels[t + (pass === 'first' ? FIRST : RADIUS)];
  switch (quantity.mode) {
    case Q_RADIUS:
      return radius ? radius * store.radiusUnit : NaN;
    case Q_OVER:
      return radius ? radius * store.radiusUnit - store.bitRadius : NaN;
    case Q_NEAREST:
      return texels[t + NEAREST] * store.nearestUnit;
    case Q_SUPPORT:
      return texels[t + STATE] & SUPPORT_MASK;
    default:
      return texels[t + STATE] & RESCANNED ? (texels[t + RADIUS] - texels[t + FIRST]) * store.radiusUnit : NaN;
  }
}

// Return at most `most` values of the pieces in view, evenly picked and sorted: for the histogram and for percentiles.
/** @param {Store} store @param {Quantity} quantity @param {Piece[]} pieces @param {Pass} pass @param {number} [most] */
export function sampleOf(store, quantity, pieces, pass, most = 8000) {
  const total = pieces.reduce((sum, { tile }) => sum + tile.level.tileSize, 0);
  const stride = Math.max(1, Math.floor(total / most)) | 1;
  const values = [];
  for (const { tile, top, bottom } of pieces) {
    for (let at = 0; at < tile.level.tileSize; at += stride) {
      const depth = tile.startDepth + (at * tile.level.pitch) / tile.level.sectors;
      if (depth < top || depth > bottom) continue;
      const value = valueAt(store, quantity, tile, at, pass);
      if (Number.isFinite(value) && !(quantity.log && value <= 0)) values.push(value);
    }
  }
  return Float64Array.from(values).sort();
}

/** @type {WeakMap<Quantity, { key: string, sorted: Float64Array }>} */
const seen = new WeakMap();

// Return the values of the section in view, sorted; they are kept until the section or one of its tiles changes.
/** @param {Pick<Look, 'store' | 'view' | 'imagePieces'>} look @param {Quantity} quantity */
export function valuesInView({ store, view, imagePieces }, quantity) {
  const versions = imagePieces.reduce((sum, { tile }) => sum + tile.version * (tile.index + 1), 0);
  const key = [store.session, quantity.log, view.pass, view.top.toFixed(2), view.length.toFixed(2), versions, imagePieces.length].join();
  const kept = seen.get(quantity);
  if (kept?.key === key) return kept.sorted;
  const sorted = sampleOf(store, quantity, imagePieces, view.pass);
  seen.set(quantity, { key, sorted });
  return sorted;
}

// Return the function that places values on a scale: the logarithm if `log` is true, else the value itself.
/** @type {(log: boolean) => (value: number) => number} */
export const scaling = (log) => (log ? Math.log : (value) => value);

/** @param {Float64Array} sorted @param {number} share */
export function percentile(sorted, share) {
  if (sorted.length === 0) return NaN;
  const place = share * (sorted.length - 1);
  const a = Math.floor(place);
  return sorted[a] + (place - a) * ((sorted[a + 1] ?? sorted[a]) - sorted[a]);
}

// Return the range between the 2nd and 98th percentile, never empty; the range of a change is centred on zero.
/** @param {Quantity} quantity @param {Float64Array} sorted */
export function fitRange(quantity, sorted) {
  if (sorted.length === 0) return { low: quantity.low, high: quantity.high };
  let [low, high] = [percentile(sorted, 0.02), percentile(sorted, 0.98)];
  if (quantity.mode === Q_CHANGE) [low, high] = [-1, 1].map((s) => s * Math.max(-low, high));
  const least = quantity.length ? 1e-4 : Math.max(1e-6, Math.abs(high) * 1e-4);
  if (high - low < least) [low, high] = quantity.log ? [low / 1.01, high * 1.01] : [low - least, high + least];
  return { low, high };
}

/** @param {Iterable<number>} sorted @param {number} low @param {number} high @param {boolean} log @param {number} [bins] */
export function histogram(sorted, low, high, log, bins = 64) {
  const counts = new Uint32Array(bins);
  const f = scaling(log);
  const [a, b] = [f(low), f(high)];
  for (const value of sorted) {
    const bin = Math.floor(((f(value) - a) / (b - a)) * bins);
    if (bin >= 0 && bin < bins) counts[bin]++;
  }
  return counts;
}

const WINDOW = 1.0; // metres of hole whose values give the dynamic range

// Return the ends of the dynamic range for each row of a tile, as a Float32Array [low, high] x rows. The window of a row may
// reach into the neighbouring tiles.
/** @param {Store} store @param {Quantity} quantity @param {Tile} tile @param {Pass} pass */
export function dynamicRange(store, quantity, tile, pass) {
  const { level } = tile;
  const reach = Math.max(1, Math.round(WINDOW / 2 / Math.abs(level.pitch)));
  const sums = [-1, 0, 1].map((step) => rowFigures(store, quantity, level.tiles.get(tile.index + step), pass));
  /** @type {(row: number) => [Float64Array | null, number]} */
  const at = (row) => (row < 0 ? [sums[0], row + level.rows] : row < level.rows ? [sums[1], row] : [sums[2], row - level.rows]);
  const total = [0, 0, 0];
  /** @param {number} row @param {number} sign */
  const add = (row, sign) => {
    const [from, i] = at(row);
    if (from && i >= 0 && i < level.rows) for (let c = 0; c < 3; c++) total[c] += sign * from[FIGURES * i + c];
  };
  for (let row = -reach; row < reach; row++) add(row, 1);
  const out = new Float32Array(2 * level.rows);
  for (let row = 0; row < level.rows; row++) {
    add(row + reach, 1);
    const [n, sum, square] = total;
    const mean = sum / n;
    const spread = 2 * Math.sqrt(Math.max(0, square / n - mean * mean)) || 1e-6;
    const ends = [mean - spread, mean + spread].map((v) => (quantity.log ? Math.exp(v) : v));
    out.set(n > 1 ? ends : [quantity.low, quantity.high], 2 * row);
    add(row - reach, -1);
  }
  return out;
}

// Return whether values of the section lie beyond the low end and beyond the high end of the colours, by at least a step.
/** @param {Pick<Look, 'store' | 'view' | 'imagePieces'>} look @param {Quantity} quantity @returns {[boolean, boolean]} */
export function beyondEnds({ store, view, imagePieces }, quantity) {
  const [a, b] = [quantity.low, quantity.high].map(scaling(quantity.log));
  let [least, most] = [a, b];
  for (const { tile, top, bottom } of imagePieces) {
    const figures = rowFigures(store, quantity, tile, view.pass) ?? [];
    const { pitch, rows } = tile.level;
    const ends = [Math.max(top, view.top), Math.min(bottom, view.bottom)].map((depth) => (depth - tile.startDepth) / pitch);
    const last = Math.min(rows, Math.max(...ends));
    for (let row = Math.max(0, Math.floor(Math.min(...ends))); row < last; row++) {
      least = Math.min(least, figures[FIGURES * row + 3]);
      most = Math.max(most, figures[FIGURES * row + 4]);
    }
  }
  return [least < a - (b - a) / 256, most > b + (b - a) / 256];
}

const FIGURES = 5;

// Return, for each row, count, sum, sum of squares, least and greatest value (of logarithms for a logarithmic quantity); they
// are kept until the tile changes.
/** @param {Store} store @param {Quantity} quantity @param {Tile | undefined} tile @param {Pass} pass */
function rowFigures(store, quantity, tile, pass) {
  if (!tile) return null;
  const key = `${quantity.id}/${pass}/${quantity.log}`;
  const kept = tile.figures[key];
  if (kept?.version === tile.version) return kept.values;
  const { rows, sectors } = tile.level;
  const values = new Float64Array(FIGURES * rows);
  for (let row = 0; row < rows; row++) {
    let [count, sum, squares, least, most] = [0, 0, 0, Infinity, -Infinity];
    for (let col = 0; col < sectors; col++) {
      let value = valueAt(store, quantity, tile, row * sectors + col, pass);
      if (quantity.log) value = Math.log(value);
      if (!Number.isFinite(value)) continue;
      count++;
      sum += value;
      squares += value * value;
      if (value < least) least = value;
      if (value > most) most = value;
    }
    values.set([count, sum, squares, least, most], FIGURES * row);
  }
  tile.figures[key] = { version: tile.version, values };
  return values;
}
