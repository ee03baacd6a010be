// A turn of the wall as a caliper sees it: sectors radii around the hole.
//
//   diameter(j) = r(j) + r(j + K/2)          smallest and largest over j: Cmin, Cmax, and where they point
//   area        = (1/2) sum r^2 2 pi / K     exact in the angle; a polygon through the points would be too small
//
// A turn with a missing radius has no area and no pair there; nothing is filled in.

import { FIRST, RADIUS, TEXEL } from './protocol.js';

const TAU = 2 * Math.PI;

// Of radii (NaN missing), evenly spaced: {min, max, minAt, maxAt, area, radiusMin, radiusMax, share}; at = index.
export function measure(radii) {
  const K = radii.length;
  const half = K / 2;
  const out = { min: NaN, max: NaN, minAt: 0, maxAt: 0, area: NaN, radiusMin: NaN, radiusMax: NaN, share: 0 };
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
    if (!(r + across >= out.min)) [out.min, out.minAt] = [r + across, j];
    if (!(r + across <= out.max)) [out.max, out.maxAt] = [r + across, j];
  }
  out.share = known / K;
  if (known === K) out.area = (square / 2) * (TAU / K);
  return out;
}

// With an odd number of sectors the opposite wall lies between two of them.
function opposite(radii, j, half) {
  const K = radii.length;
  if (Number.isInteger(half)) return radii[(j + half) % K];
  return (radii[(j + Math.floor(half)) % K] + radii[(j + Math.ceil(half)) % K]) / 2;
}

// Radii of the turn that begins at vertex k.
export function turn(store, level, k, column = RADIUS) {
  const radii = new Float64Array(level.sectors).fill(NaN);
  for (let j = 0; j < level.sectors; j++) {
    const { tile, at } = level.locate(k + j);
    const steps = tile && k + j < level.shown ? tile.texels[TEXEL * at + column] : 0;
    if (steps) radii[j] = steps * store.radiusUnit;
  }
  return radii;
}

// Cmin, Cmax, area and share measured of every turn of a tile, kept with the tile until it changes.
export function tileTurns(store, tile, first = false) {
  const key = first ? 'turnsFirst' : 'turns';
  if (tile[key]?.version === tile.version) return tile[key];
  const { sectors, rows } = tile.level;
  const [min, max, area, share] = [0, 1, 2, 3].map(() => new Float64Array(rows).fill(NaN));
  const radii = new Float64Array(sectors);
  const column = first ? FIRST : RADIUS;
  for (let row = 0; row < rows; row++) {
    for (let j = 0; j < sectors; j++) {
      radii[j] = (tile.texels[TEXEL * (row * sectors + j) + column] || NaN) * store.radiusUnit;
    }
    const turnOf = measure(radii);
    min[row] = turnOf.min;
    max[row] = turnOf.max;
    area[row] = turnOf.area;
    share[row] = turnOf.share;
  }
  return (tile[key] = { version: tile.version, min, max, area, share });
}

export const WASHOUT = 0.0127; // metres over bit size, half an inch: the industry's usual threshold

// Volume and washout of the whole turns of a section that are here, `length` metres of them; and the share of the
// vertices drilled there, whole turn or not, that no sample supports.
export function sectionVolume(store, pieces, first = false) {
  const bit = 2 * store.bitRadius;
  let [volume, gauge, washed, length, drilled, known] = [0, 0, 0, 0, 0, 0];
  for (const { tile, top: a, bottom: b } of pieces) {
    const { area, share } = tileTurns(store, tile, first);
    const pitch = Math.abs(tile.level.pitch);
    const last = (tile.level.shown - tile.index * tile.level.tileSize) / tile.level.sectors;
    for (let row = 0; row < area.length; row++) {
      const depth = tile.startDepth + (row + 0.5) * tile.level.pitch;
      if (depth < a || depth >= b || row + 1 > last) continue;
      drilled += pitch;
      known += share[row] * pitch;
      if (Number.isNaN(area[row])) continue;
      length += pitch;
      volume += area[row] * pitch;
      gauge += (Math.PI / 4) * bit * bit * pitch;
      if (2 * Math.sqrt(area[row] / Math.PI) > bit + WASHOUT) washed += pitch;
    }
  }
  return { volume, length, excess: gauge ? volume / gauge - 1 : NaN, washed: length ? washed / length : NaN, unsupported: drilled ? 1 - known / drilled : NaN };
}

// Arcs of a turn that stand at least `least` beyond the bit: [first, last] indices, last may exceed K over the start.
export function arcs(radii, bitRadius, least) {
  const K = radii.length;
  const out = [...radii].map((r) => r > bitRadius + least);
  const start = out.indexOf(false);
  if (start < 0) return [[0, K - 1]];
  const found = [];
  for (let i = 1; i <= K; i++) {
    const j = (start + i) % K;
    if (!out[j]) continue;
    const last = found.at(-1);
    if (last && last[1] === start + i - 1) last[1] = start + i;
    else found.push([start + i, start + i]);
  }
  return found;
}
