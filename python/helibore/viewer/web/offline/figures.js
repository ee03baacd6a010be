// Figures of the turns of a wall: what the page reads of `Wall.summary` and `Wall.logs`, from the core's logs.

import { Refusal, rint, rules } from './rules.js';
import { unpicked } from '../src/unpicked.js';
import { NEAREST, RADIUS, STATE, SUPPORT_MASK, TEXEL } from '../src/protocol.js';

const MOST_ROWS = 2_000_000;
const COVERED = 0.9;
const MOSTLY = 0.4;
const NEARLY_ALL = [0.2, 99.8];
const LINES_A_CHUNK = 4096;
const SIZE_ROUGH = 1.8e-3; // metres
const SIZE_APART = 0.07; // of the difference from the bit
const KINDS = ['gauge', 'washout', 'breakout', 'key seat', 'undergauge'];
const WASHOUT = 1;

/**
 * @typedef {{ name: string, unit: string, low: number, high: number, values: Float64Array }} Curve
 * @typedef {{ depth: Float64Array, pitch: number, sectors: number, bit: number, ends: [number, number], start: number, radius: Float64Array, kinds: Int32Array | null, unmeasuredShape: boolean, columns: Record<string, Float64Array>, curves: Curve[] }} Figures
 */

// Return the number of turns in a window of this length, metres: odd, at least 3 (turn_logs.py).
/** @param {number} length @param {number} pitch */
export const windowTurns = (length, pitch) => Math.max(3, 2 * rint((length / Math.abs(pitch) - 1) / 2) + 1);

// Return the figures of the turns from the core's logs and zones (turn_logs.py). `found`: null, where the shape is assumed.
/** @param {Record<string, Float64Array>} logs @param {import('./core.js').Found | null} found @param {Pick<import('./worker.js').Rebuilt, 'vertices' | 'helix' | 'bit' | 'basis'>} wall @param {(depth: Float64Array) => { name: string, unit: string, values: Float64Array }[]} more @param {(depth: Float64Array) => Float64Array} ages @returns {Figures} */
export function figuresOf(logs, found, { vertices: { radius, nearest, marks }, helix: { sectors, pitch, startDepth: start }, bit, basis }, more, ages) {
  const turns = logs.mean.length;
  const each = (/** @type {(turn: number) => number} */ of) => Float64Array.from({ length: turns }, (_, turn) => of(turn));
  const coverage = each((turn) => {
    let count = 0;
    for (let k = turn * sectors; k < (turn + 1) * sectors; k++) if (marks[k] === 1 && Number.isFinite(radius[k])) count++;
    return basis === 'azimuthal' ? count / sectors : NaN;
  });
  const depth = each((turn) => start + (turn * sectors + (sectors - 1) / 2) * (pitch / sectors));
  const byArms = Boolean(found?.arms.length);
  const { arms_c1: c1, arms_c1_toolface: axis, arms_c2: c2, arms_least: least, arms_uneven: uneven, ...others } = found?.columns ?? /** @type {any} */ ({});
  const most = (/** @type {number} */ a, /** @type {number} */ b) => (Number.isNaN(a) ? b : Number.isNaN(b) ? a : Math.max(a, b));
  /** @type {Record<string, Float64Array>} */
  const ofArms = byArms ? {
    c1, c1_toolface: axis, c2, least_diameter: least, uneven, wall_out_of_roundness: each((turn) => logs.c1[turn] - logs.least_diameter[turn]),
    inscribed_diameter: each((turn) => -most(-logs.inscribed_diameter[turn], -least[turn])), enclosing_diameter: each((turn) => most(logs.enclosing_diameter[turn], c1[turn])),
  } : {};
  /** @type {Record<string, Float64Array>} */
  const columns = { ...logs, ...others, ...ofArms, depth, coverage };
  const [greatest, smallest] = [columns.c1, columns.least_diameter];
  const size = logs.mean_square.map((square) => 2 * Math.sqrt(square));
  Object.assign(columns, {
    equivalent_diameter: size,
    ovality_api: each((turn) => (greatest[turn] - smallest[turn]) / (greatest[turn] + smallest[turn])),
    ovality_dnv: each((turn) => (2 * (greatest[turn] - smallest[turn])) / (greatest[turn] + smallest[turn])),
    out_of_roundness: each((turn) => greatest[turn] - smallest[turn]),
    volume: logs.mean_square.map((square) => Math.PI * square * Math.abs(pitch)),
    excess: logs.mean_square.map((square) => square / (bit / 2) ** 2 - 1),
    nearest: each((turn) => {
      let far = NaN;
      for (let k = turn * sectors; k < (turn + 1) * sectors; k++) far = most(far, nearest[k]);
      return far;
    }),
    age: ages(depth),
    ...rangeOf(size, bit, others.likely_square, others.likely_sigma),
  });
  const named = rules.columns.flatMap(([name, mnemonic, unit]) => (name === 'depth' ? [] : [{ name: mnemonic, unit, values: columns[name] }]));
  const { low_diameter: low, high_diameter: high } = columns;
  const ranged = low.filter((end, turn) => end < high[turn]).length;
  const likely = ranged >= MOSTLY * depth.length ? [['DEQ_LOW', low], ['DEQ_HIGH', high]].map(([name, ends]) => ({ name: /** @type {string} */ (name), unit: 'm', values: each((turn) => (low[turn] < high[turn] ? Number(ends[turn]) : NaN)) })) : [];
  const arms = (found?.arms ?? []).map((values, at) => ({ name: `ARM_DIAMETER_${at + 1}`, unit: 'm', values }));
  const curves = [...named, ...likely, ...arms, ...more(depth)].flatMap((one) => (one.values?.some(Number.isFinite) ? [{ ...one, ...limitsOf(one.values) }] : []));
  const last = start + ((radius.length - 1) * pitch) / sectors;
  return {
    depth, pitch, sectors, bit, start, radius, columns, curves, ends: [Math.min(start, last), Math.max(start, last)], kinds: found?.kinds ?? null,
    unmeasuredShape: byArms || mean(coverage) < COVERED,
  };
}

// Return the ends of the diameters that turns likely have (Logs.diameter_range).
/** @param {Float64Array} size @param {number} bit @param {Float64Array} [square] @param {Float64Array} [sigma] */
function rangeOf(size, bit, square, sigma) {
  const end = (/** @type {number} */ side) => size.map((whole, turn) => {
    if (!square || !sigma || Number.isNaN(square[turn])) return whole;
    const likely = 2 * Math.sqrt(square[turn]);
    return likely + side * 1.96 * Math.hypot((2 * sigma[turn]) / likely, SIZE_ROUGH, SIZE_APART * (likely - bit));
  });
  return { low_diameter: end(-1), high_diameter: end(1) };
}

// Return the zones as the page draws them (feed.py).
/** @param {import('./core.js').Found} found @returns {any[]} */
export const zonesOf = ({ zones }) => zones.map(({ kind, start, stop, measure, severity, confidence, coverage, toolface }) => {
  const rounded = (/** @type {number} */ value, /** @type {number} */ decimals) => (Number.isFinite(value) ? Number(value.toFixed(decimals)) : null);
  return {
    kind: KINDS[kind], start: rounded(start, 3), stop: rounded(stop, 3), measure: rounded(measure, 5), severity: rounded(severity, 3),
    confidence: rounded(confidence, 6), measured: rounded(coverage, 3), ...(Number.isNaN(toolface) ? {} : { toolface: rounded(toolface, 1) }),
  };
});

/** @param {Float64Array} values */
const mean = (values) => values.reduce((sum, value) => sum + value, 0) / values.length;

// Return round ends of an axis for nearly all values (curves.py).
/** @param {Float64Array} values */
function limitsOf(values) {
  const there = values.filter(Number.isFinite).sort();
  const at = (/** @type {number} */ percent) => {
    const place = (percent / 100) * (there.length - 1);
    const below = there[Math.floor(place)];
    return below + (place - Math.floor(place)) * ((there[Math.floor(place) + 1] ?? below) - below);
  };
  const [always, ...ends] = [50, ...NEARLY_ALL].map(at);
  let [low, high] = ends;
  if (low === high) [low, high] = [low, high].map((end, side) => end + (side - 0.5) * 0.01 * Math.max(Math.abs(end), 0.001));
  const power = Math.floor(Math.log10((high - low) / 4));
  const step = 10 ** power * /** @type {number} */ ([1, 2, 5, 10].find((mantissa) => 10 ** power * mantissa >= (high - low) / 5));
  let [first, last] = [Math.floor(low / step), Math.ceil(high / step)];
  if (always <= first * step + 0.05 * (high - low)) first--;
  if (always >= last * step - 0.05 * (high - low)) last++;
  return { low: Number((first * step).toPrecision(12)), high: Number((last * step).toPrecision(12)) };
}

// Return the share of each turn that lies between two depths; a turn ends where the next begins (summary.py).
/** @param {Figures} figures @param {number} start @param {number} stop */
function sharesInside({ depth, pitch, sectors, ends }, start, stop) {
  const [from, to] = [start <= ends[0] ? -Infinity : start, stop >= ends[1] ? Infinity : stop];
  return depth.map((middle) => {
    const first = middle - (pitch * (sectors - 1)) / (2 * sectors);
    const inside = (Math.min(Math.max(first, first + pitch), to) - Math.max(Math.min(first, first + pitch), from)) / Math.abs(pitch);
    return Math.min(1, Math.max(0, Math.round(inside * 1e9) / 1e9));
  });
}

// Return the figures as if there were no washout at an open fracture that was picked (Classification.without).
/** @param {Figures} figures @param {any[]} zones @param {any[]} picks @returns {Figures} */
export function withoutPicked(figures, zones, picks) {
  const { kinds, depth, pitch, bit } = figures;
  const left = unpicked(zones, picks, bit / 2);
  const gone = zones.filter((zone) => !left.includes(zone));
  const half = Math.abs(pitch) / 2;
  return { ...figures, kinds: kinds && kinds.map((kind, turn) => (kind === WASHOUT && gone.some(({ start, stop }) => depth[turn] + half > start && depth[turn] - half < stop) ? 0 : kind)) };
}

// Return the figures of a section as the page shows them; a missing number is null (summary.py).
/** @param {Figures} figures @param {number} from @param {number} to */
export function summaryOf(figures, from, to) {
  const { columns, depth, pitch, sectors, bit, ends, radius, kinds, unmeasuredShape, start: startDepth } = figures;
  const [start, stop] = [from, to].map((end) => Math.min(Math.max(end, ends[0]), ends[1]));
  const shares = sharesInside(figures, start, stop);
  let [all, counted, square, volume, measured, washed, classified, low, high] = [0, 0, 0, 0, 0, 0, 0, 0, 0];
  shares.forEach((share, turn) => {
    all += share;
    measured += share * columns.coverage[turn];
    if (kinds?.[turn] === WASHOUT) washed += share;
    if (kinds && kinds[turn] >= 0) classified += share;
    if (!Number.isFinite(columns.equivalent_diameter[turn])) return;
    counted += share;
    square += share * columns.equivalent_diameter[turn] ** 2;
    volume += share * columns.volume[turn];
    low += share * columns.low_diameter[turn] ** 2;
    high += share * columns.high_diameter[turn] ** 2;
  });
  const middles = Array.from(depth.keys()).filter((turn) => depth[turn] >= start && depth[turn] <= stop);
  const extreme = (/** @type {string} */ name, /** @type {(...values: number[]) => number} */ which) => middles.reduce((found, turn) => (Number.isNaN(columns[name][turn]) ? found : Number.isNaN(found) ? columns[name][turn] : which(found, columns[name][turn])), NaN);
  const [first, last] = placesBetween(startDepth, pitch, sectors, radius.length, start, stop);
  let without = 0;
  for (let k = first; k < last; k++) if (Number.isNaN(radius[k])) without++;
  const found = {
    start, stop, volume, excess: square / counted / bit ** 2 - 1, whole_turns: counted * Math.abs(pitch), incomplete_turns: (all - counted) * Math.abs(pitch),
    washed_out: kinds && 2 * classified >= counted ? washed * Math.abs(pitch) : NaN, without_radius: without / (last - first), coverage: measured / all, mean_diameter: Math.sqrt(square / counted), least_diameter: extreme('least_diameter', Math.min), greatest_diameter: extreme('c1', Math.max),
  };
  return { ...Object.fromEntries(Object.entries(found).map(([name, value]) => [name, Number.isFinite(value) ? value : null])), ...(high > low ? ranges([low, high], square, volume, counted * bit ** 2) : {}), unmeasured_shape: unmeasuredShape };
}

// Return volume and excess as ranges, in words. `ends`, `square`, `gauge`: sums of squared diameters: likely ones, of the wall, of the bit.
/** @param {number[]} ends @param {number} square @param {number} volume @param {number} gauge */
function ranges(ends, square, volume, gauge) {
  const span = (/** @type {string[]} */ texts) => [...new Set(texts)].join(' to ');
  const percent = (/** @type {number} */ end) => Math.round(100 * (end / gauge - 1)) || 0;
  const volumes = ends.map((end) => (volume * end) / square);
  const digits = Math.max(2, -Math.floor(Math.log10(volumes[1] - volumes[0]))); // so many that the ends differ
  return {
    volume_text: `${span(volumes.map((end) => end.toLocaleString('en', { minimumFractionDigits: digits, maximumFractionDigits: digits })))} m³`,
    excess_text: `${span(ends.map((end) => `${percent(end) < 0 ? '' : '+'}${percent(end)}`))} %`,
  };
}

// Return the first vertex and the one after the last whose depths lie between two depths.
/** @param {number} startDepth @param {number} pitch @param {number} sectors @param {number} size @param {number} start @param {number} stop @returns {[number, number]} */
function placesBetween(startDepth, pitch, sectors, size, start, stop) {
  const [low, high] = [start, stop].map((depth) => ((depth - startDepth) / pitch) * sectors).sort((a, b) => a - b);
  const first = Math.max(0, Math.ceil(low - 1e-6));
  return [first, Math.max(first, Math.min(size, Math.floor(high + 1e-6) + 1))];
}

// Return a curve for the page: its first depth, then depths relative to it, then values (exports.py).
/** @param {Figures} figures @param {string} name */
export function curveBytes({ curves, depth, pitch }, name) {
  const curve = curves.find((one) => one.name === name);
  if (!curve) throw new Refusal(`curve ${name.slice(0, 80)}: no curve has this name`);
  const count = depth.length;
  const bytes = new ArrayBuffer(8 + 8 * count);
  const [rising, values] = pitch > 0 ? [depth, curve.values] : [depth.toReversed(), curve.values.toReversed()];
  new Float64Array(bytes, 0, 1)[0] = rising[0] ?? 0;
  new Float32Array(bytes, 8, count).set(rising.map((one) => one - rising[0]));
  new Float32Array(bytes, 8 + 4 * count, count).set(values);
  return bytes;
}

// Return the vertices between two depths as CSV (exports.py).
/** @param {import('./scene.js').Scene} scene @param {number} start @param {number} stop */
export function sectionCsv({ wall: { texels, sectors, size }, hello }, start, stop) {
  const { start_depth: startDepth, start_toolface: startToolface, radius_unit: unit, nearest_unit: far, levels: [{ pitch }] } = hello;
  const [first, last] = placesBetween(startDepth, pitch, sectors, size, start, stop);
  if (last - first > MOST_ROWS) throw new Refusal(`${last - first} vertices: a section holds at most ${MOST_ROWS}; take a shorter section`);
  const chunks = ['vertex,depth [m],toolface [deg],radius [m],first radius [m],nearest [m],support\r\n'];
  /** @type {string[]} */
  let lines = [];
  for (let k = first; k < last; k++) {
    const at = TEXEL * k;
    const steps = texels[at + RADIUS];
    const radius = steps ? (steps * unit).toFixed(5) : '';
    const toolface = (startToolface + ((k % sectors) * 360) / sectors) % 360;
    lines.push(`${k},${(startDepth + (k * pitch) / sectors).toFixed(5)},${toolface.toFixed(4)},${radius},${radius},${steps ? (texels[at + NEAREST] * far).toFixed(4) : ''},${texels[at + STATE] & SUPPORT_MASK}\r\n`);
    if (lines.length === LINES_A_CHUNK || k === last - 1) {
      chunks.push(lines.join(''));
      lines = [];
    }
  }
  return new Blob(chunks, { type: 'text/csv' });
}
