// What the times of samples say: how long the wall was at a moment (feed.py), and how old each turn is (turn_logs.py).

const FIRST_DATE = 1e8; // seconds: a smaller time counts from the start of the run, not from 1970
const MOST_BACK = 1; // metres that samples may lie above earlier ones
const MOST_POINTS = 4096;
const SPACING = 1; // seconds

/** @typedef {{ time: number[], vertices: number[], bit_depth: number[] }} History */

// Return the moments of a wall that grew downwards; none without dates, or if it was measured again.
/** @param {Float64Array} depth of the samples @param {Float64Array | null} time @param {import('./core.js').Helix} helix @param {number} size @returns {History} */
export function historyOf(depth, time, { startDepth, pitch, sectors }, size) {
  /** @type {History} */
  const found = { time: [], vertices: [], bit_depth: [] };
  if (!time?.length || pitch < 0) return found;
  const order = Uint32Array.from(time.keys()).sort((a, b) => time[a] - time[b]);
  const deepest = new Float64Array(time.length);
  let [most, back] = [-Infinity, 0];
  order.forEach((row, at) => {
    deepest[at] = most = Math.max(most, depth[row]);
    back = Math.max(back, most - depth[row]);
  });
  if (time[order[0]] < FIRST_DATE || back > MOST_BACK) return found;
  /** @type {[number, number, number][]} */
  const points = [];
  const count = Math.min(time.length, MOST_POINTS);
  for (let at = 0; at < count; at++) {
    const row = at === count - 1 ? time.length - 1 : Math.trunc(at * ((time.length - 1) / (count - 1)));
    const [moment, vertices] = [time[order[row]], Math.trunc(Math.min(Math.max(((deepest[row] - startDepth) / pitch) * sectors + 1, 1), size))];
    const last = points.at(-1);
    if (last && (vertices <= last[1] || moment < last[0])) continue;
    if (points.length > 1 && moment - points[points.length - 2][0] < SPACING) points.pop();
    points.push([moment, vertices, deepest[row]]);
  }
  for (const [moment, vertices, bit] of points) {
    found.time.push(Number(moment.toFixed(3)));
    found.vertices.push(vertices);
    found.bit_depth.push(bit);
  }
  return found;
}

// Return the seconds from the newest sample of each turn to the newest of all; NaN if the turn has no sample.
/** @param {Float64Array} depth of the samples, rising @param {Float64Array | null} time @param {Float64Array} middles @param {number} height */
export function agesOf(depth, time, middles, height) {
  const ages = new Float64Array(middles.length).fill(NaN);
  if (!time?.length || !middles.length) return ages;
  const down = middles[0] <= middles[middles.length - 1];
  const rising = down ? middles : middles.toReversed();
  const newest = time.reduce((most, one) => Math.max(most, one), -Infinity);
  let row = 0;
  rising.forEach((middle, turn) => {
    const end = turn + 1 < rising.length ? rising[turn + 1] - height / 2 : middle + height / 2;
    let latest = -Infinity;
    for (; row < depth.length && depth[row] < end; row++) if (depth[row] >= middle - height / 2) latest = Math.max(latest, time[row]);
    if (latest > -Infinity) ages[down ? turn : rising.length - 1 - turn] = newest - latest;
  });
  return ages;
}
