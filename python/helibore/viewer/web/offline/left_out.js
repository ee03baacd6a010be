// Samples that are left out to calibrate the uncertainty of a wall: the rows and boxes that helibore.wall.estimates chooses.

import { rules } from './rules.js';

const LEVEL = 1e-3; // metres
const MOST_BOX_DEPTH = 1; // metres
const SOME_ROWS = 1000;
const [WORD, LONG] = [64, 128]; // bits
const MULTIPLIER = 0x2360ed051fc65da44385df649fccf645n;
const MOST = 0xffffffffn;

/** @typedef {import('./core.js').Places} Places */

// The generator of numpy.random.default_rng (PCG64, XSL-RR), from the state that the rules state.
class Random {
  constructor() {
    const [state, step] = rules.left_out.random;
    this.state = BigInt(state);
    this.step = BigInt(step);
    /** @type {bigint | null} */
    this.half = null; // 32 bits that the last draw left
  }

  draw() {
    this.state = BigInt.asUintN(LONG, this.state * MULTIPLIER + this.step);
    const [mixed, turn] = [BigInt.asUintN(WORD, (this.state >> 64n) ^ this.state), this.state >> 122n];
    return BigInt.asUintN(WORD, (mixed >> turn) | (mixed << (BigInt.asUintN(6, -turn))));
  }

  drawHalf() {
    if (this.half !== null) {
      const { half } = this;
      this.half = null;
      return half;
    }
    const whole = this.draw();
    this.half = whole >> 32n;
    return whole & MOST;
  }

  // Return a whole number from 0 to `most`, each as likely (Lemire).
  /** @param {number} most */
  upTo(most) {
    if (most === 0) return 0;
    const count = BigInt(most) + 1n;
    let product = this.drawHalf() * count;
    if ((product & MOST) < count) {
      const least = (MOST - BigInt(most)) % count;
      while ((product & MOST) < least) product = this.drawHalf() * count;
    }
    return Number(product >> 32n);
  }

  /** @param {number} low @param {number} high @param {number} count */
  uniform(low, high, count) {
    return Float64Array.from({ length: count }, () => low + (high - low) * (Number(this.draw() >> 11n) * 2 ** -53));
  }

  /** @param {Float64Array | number[]} values @param {number} first */
  shuffle(values, first) {
    for (let at = values.length - 1; at >= first; at--) {
      const other = this.upTo(at);
      [values[at], values[other]] = [values[other], values[at]];
    }
  }

  // Return `count` of the numbers below `all`, rising.
  /** @param {number} all @param {number} count */
  choose(all, count) {
    /** @type {number[]} */
    let chosen = [];
    if (all > 10000 && count > Math.floor(all / 50)) {
      const numbers = Float64Array.from({ length: all }, (_, at) => at);
      this.shuffle(numbers, Math.max(all - count, 1));
      chosen = [...numbers.subarray(all - count)];
    } else {
      const taken = new Set();
      for (let at = all - count; at < all; at++) {
        const number = this.upTo(at);
        chosen.push(taken.has(number) ? at : number);
        taken.add(chosen[chosen.length - 1]);
      }
      this.shuffle(chosen, 1);
    }
    return Float64Array.from(chosen).sort();
  }
}

// Return the first place in rising values whose value is not below a limit.
/** @param {Float64Array} values @param {number} limit */
function place(values, limit) {
  let [low, high] = [0, values.length];
  while (low < high) {
    const middle = (low + high) >> 1;
    if (values[middle] < limit) low = middle + 1;
    else high = middle;
  }
  return low;
}

// Return the mean number of samples within a millimetre of the depth of a sample.
/** @param {Float64Array} depth */
function crowd(depth) {
  const some = Math.min(SOME_ROWS, depth.length);
  const step = (depth.length - 1) / (some - 1);
  const rows = new Set(Array.from({ length: some }, (_, at) => (at === some - 1 ? depth.length - 1 : Math.trunc(at * step))));
  let sum = 0;
  for (const row of rows) sum += place(depth, depth[row] + LEVEL) - place(depth, depth[row] - LEVEL) + 1;
  return sum / rows.size;
}

// Return rows, and half the height (m) and width (degrees) of the box around each; null: there are too few samples.
/** @param {Places} samples in canonical order @param {{ pitch: number, sectors: number }} helix */
export function chooseLeftOut({ depth, toolface }, { pitch, sectors }) {
  const { targets, fewest, boxes, comparisons } = rules.left_out;
  if (depth.length < fewest) return null;
  const most = Math.min(targets, Math.max(Math.trunc(comparisons / crowd(depth)), fewest), depth.length);
  const random = new Random();
  const rows = random.choose(depth.length, most);
  const some = Math.min(most, boxes);
  const [where, angle] = [random.uniform(depth[0], depth[depth.length - 1], some), random.uniform(0, 360, some)];
  const [height, width] = [new Float64Array(some).fill(MOST_BOX_DEPTH), new Float64Array(some).fill(180)];
  const [halfPitch, halfSector] = [Math.abs(pitch) / 2, 180 / sectors];
  for (let box = 0; box < some; box++) {
    for (const reach of [halfPitch, Math.max(halfPitch, MOST_BOX_DEPTH)]) {
      let [least, beside] = [MOST_BOX_DEPTH, 180];
      for (let row = place(depth, where[box] - reach); row < place(depth, where[box] + reach); row++) {
        const apart = Math.abs(toolface[row] - angle[box]);
        const turn = Math.min(apart, 360 - apart);
        if (turn <= halfSector) least = Math.min(least, Math.abs(depth[row] - where[box]));
        beside = Math.min(beside, turn);
      }
      height[box] = least;
      if (reach === halfPitch) width[box] = beside;
      if (height[box] <= reach) break;
    }
  }
  const repeated = (/** @type {Float64Array} */ values) => Float64Array.from(rows, (_, at) => values[at % some]);
  return { rows, height: repeated(height), width: repeated(width) };
}
