// A turn of the wall as a caliper sees it: one radius for each sector around the hole.
//
//   diameter(j) = r(j) + r(j + K/2)          smallest and largest over j
//   C1, C2      = the largest diameter, and diameter(j + K/4) at a right angle to it: zones are judged by them
//   area        = (1/2) sum r^2 2 pi / K     exact in the angle; a polygon through the points would be too small
//
// A turn with a missing radius has no area, no C1 and no C2, and no diameter at that sector; nothing is filled in. Volumes and
// zones of the wall come from the server.

import { FIRST, INTERPOLATED, RADIUS, STATE, TEXEL, uncertaintyOf } from './protocol.js';

const TAU = 2 * Math.PI;
export const CERTAIN = 1.96; // standard deviations that enclose 95 %

// Return {min, max, c1, c2, maxAt, area, radiusMin, radiusMax, share} of evenly spaced radii (NaN: missing). `maxAt` is the
// index of the largest diameter, `share` the share of the radii that are not missing.
/** @param {Floats} radii */
export function measure(radii) {
  const K = radii.length;
  const half = K / 2;
  const out = { min: NaN, max: NaN, c1: NaN, c2: NaN, maxAt: 0, area: NaN, radiusMin: NaN, radiusMax: NaN, share: 0 };
  let square = 0;
  let known = 0;
  for (let j = 0; j < K; j++) {
    const r = radii[j];
    if (Number.isNaN(r)) continue;
    known++;
    square += r * r;
    if (!(r >= out.radiusMin)) out.radiusMin = r;
    if (!(r <= out.radiusMax)) out.radiusMax = r;
    if (j >= half) continue;
    const across = opposite(radii, j, half);
    if (Number.isNaN(across)) continue;
    if (!(r + across >= out.min)) out.min = r + across;
    if (!(r + across <= out.max)) [out.max, out.maxAt] = [r + across, j];
  }
  out.share = known / K;
  if (known < K) return out;
  out.area = (square / 2) * (TAU / K);
  out.c1 = out.max;
  const quarter = Math.floor(out.maxAt + K / 4);
  const [a, b] = [quarter, quarter + 1].map((j) => radii[j % K] + opposite(radii, j % K, half));
  out.c2 = a + ((K % 4) / 4) * (b - a);
  return out;
}

// Return the radius opposite to the j-th radius. If the number of sectors is odd, it is the mean of two radii.
/** @param {Floats} radii @param {number} j @param {number} half */
function opposite(radii, j, half) {
  const K = radii.length;
  if (Number.isInteger(half)) return radii[(j + half) % K];
  return (radii[(j + Math.floor(half)) % K] + radii[(j + Math.ceil(half)) % K]) / 2;
}

// Return the radii of the turn that begins at vertex k.
/** @param {Store} store @param {Level} level @param {number} k @param {number} [column] */
export function turn(store, level, k, column = RADIUS) {
  const radii = new Float64Array(level.sectors).fill(NaN);
  for (let j = 0; j < level.sectors; j++) {
    const { tile, at } = level.locate(k + j);
    const steps = tile && k + j < level.shown ? tile.texels[TEXEL * at + column] : 0;
    if (steps) radii[j] = steps * store.radiusUnit;
  }
  return radii;
}

// Return the half-widths of the 95 % intervals of the radii of the turn that begins at vertex k: from the wall's attribute sigma, or
// else by their levels; NaN where they are not known.
/** @param {Store} store @param {Level} level @param {number} k */
export function uncertainties(store, level, k) {
  const bit = store.attributes.findIndex((one) => one.name === 'sigma');
  return Float64Array.from({ length: level.sectors }, (_, j) => {
    const { tile, at } = level.locate(k + j);
    const sigma = tile?.columns[bit]?.[at];
    return sigma === undefined ? uncertaintyOf(tile?.texels[TEXEL * at + STATE] ?? 0) : CERTAIN * sigma;
  });
}

// Return, for each vertex of the turn that begins at vertex k, 1 if the vertex is interpolated between arms or has no radius, else
// 0.
/** @param {Level} level @param {number} k */
export function unmeasured(level, k) {
  return Uint8Array.from({ length: level.sectors }, (_, j) => {
    const { tile, at } = level.locate(k + j);
    return !tile || k + j >= level.shown || !tile.texels[TEXEL * at + RADIUS] || tile.texels[TEXEL * at + STATE] & INTERPOLATED ? 1 : 0;
  });
}

// Return, for every turn of a tile, the least and the greatest diameter, C2, and whether most of the turn is interpolated between
// arms. The result is kept with the tile until the tile changes.
/** @param {Store} store @param {Tile} tile @param {boolean} [first] */
export function tileTurns(store, tile, first = false) {
  const pass = first ? 'first' : 'latest';
  const kept = tile.turns[pass];
  if (kept?.version === tile.version) return kept;
  const { sectors, rows } = tile.level;
  const [min, max, c2] = [0, 1, 2].map(() => new Float64Array(rows).fill(NaN));
  const between = new Uint8Array(rows);
  const radii = new Float64Array(sectors);
  const column = first ? FIRST : RADIUS;
  for (let row = 0; row < rows; row++) {
    let interpolated = 0;
    for (let j = 0; j < sectors; j++) {
      const at = TEXEL * (row * sectors + j);
      radii[j] = (tile.texels[at + column] || NaN) * store.radiusUnit;
      if (tile.texels[at + STATE] & INTERPOLATED) interpolated++;
    }
    between[row] = 2 * interpolated > sectors ? 1 : 0;
    ({ min: min[row], max: max[row], c2: c2[row] } = measure(radii));
  }
  return (tile.turns[pass] = { version: tile.version, min, max, c2, between });
}
