// What a line of the map shows: all rings of the overview that lie in it.

import { Q_ATTRIBUTE, valueAt } from './color.js';
import { INTERPOLATED, RADIUS, STATE, SUPPORT_MASK, TEXEL } from './protocol.js';

// Return the rings between two places (counted in rings) as one row: the mean of each sector (NaN if a cell of the sector has
// no value, so that no mean hides a gap; undefined beyond the wall), whether a cell of the sector is interpolated between arms,
// the largest enlargement, and whether a vertex lacks support.
/** @param {Store} store @param {Quantity} quantity @param {Pass} pass @param {number} from @param {number} to @returns {MapRow} */
export function rowOf(store, quantity, pass, from, to) {
  const over = store.levels[1];
  const { sectors } = over;
  const first = Math.floor(Math.min(from, to));
  /** @type {number[]} */
  const sums = Array(sectors).fill(0);
  const between = Array(sectors).fill(false);
  let [count, most, lacks] = [0, 0, false];
  for (let r = first; r < Math.max(first + 1, Math.floor(Math.max(from, to))); r++) {
    const { tile, at: start } = over.locate(r * sectors);
    if (!tile || r * sectors >= over.shown) continue; // an overview has whole rings
    const strip = stripOf(store, quantity, pass, tile);
    count++;
    for (let c = 0; c < sectors; c++) {
      const at = start + c;
      sums[c] += strip.values[at];
      most = Math.max(most, strip.enlarged[at]);
      lacks ||= strip.lacks[at] === 1;
      between[c] ||= quantity.mode !== Q_ATTRIBUTE && (tile.texels[TEXEL * at + STATE] & INTERPOLATED) > 0;
    }
  }
  return { means: sums.map((sum) => (count ? sum / count : undefined)), between, most, lacks };
}

// Return what the map needs of an overview tile; it is kept with the tile until the tile changes.
/** @param {Store} store @param {Quantity} quantity @param {Pass} pass @param {Tile} tile */
function stripOf(store, quantity, pass, tile) {
  const { id } = quantity;
  const { strip, version, level } = tile;
  if (strip?.version === version && strip.id === id && strip.pass === pass) return strip;
  const n = level.tileSize;
  const made = { version, id, pass, values: new Float32Array(n), enlarged: new Float32Array(n), lacks: new Uint8Array(n) };
  for (let at = 0; at < n; at++) {
    const steps = tile.texels[TEXEL * at + RADIUS];
    made.values[at] = valueAt(store, quantity, tile, at, pass);
    made.enlarged[at] = steps ? steps * store.radiusUnit - store.bitRadius : 0;
    made.lacks[at] = tile.texels[TEXEL * at + STATE] & SUPPORT_MASK ? 0 : 1;
  }
  return (tile.strip = made);
}
