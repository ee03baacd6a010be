// What a line of the map shows: all rings of the overview that lie in it.

import { Q_ATTRIBUTE, valueAt } from './color.js';
import { INTERPOLATED, RADIUS, STATE, SUPPORT_MASK, TEXEL } from './protocol.js';

// Return the rings between two places (counted in rings) as one row: the mean of each sector (NaN if a cell of the sector has
// no value, so that no mean hides a gap; undefined beyond the wall), whether a cell of the sector is interpolated between arms,
// the largest enlargement, and whether a vertex lacks support.
/** @param {Store} store @param {Quantity} quantity @param {Pass} pass @param {number} from @param {number} to */
export function rowOf(store, quantity, pass, from, to) {
  const over = store.levels[1];
  const [x0, x1] = [Math.min(from, to), Math.max(from, to)];
  /** @type {MapRow} */
  const row = { means: [], between: [], most: 0, lacks: false };
  for (let c = 0; c < over.sectors; c++) {
    let [sum, count, between] = [0, 0, false];
    for (let r = Math.floor(x0); r < Math.max(Math.floor(x0) + 1, Math.floor(x1)); r++) {
      const k = r * over.sectors + c;
      const { tile, at } = over.locate(k);
      if (!tile || k >= over.shown) continue;
      const strip = stripOf(store, quantity, pass, tile);
      sum += strip.values[at];
      row.most = Math.max(row.most, strip.enlarged[at]);
      row.lacks ||= strip.lacks[at] === 1;
      between ||= quantity.mode !== Q_ATTRIBUTE && (tile.texels[TEXEL * at + STATE] & INTERPOLATED) > 0;
      count++;
    }
    row.means.push(count ? sum / count : undefined);
    row.between.push(between);
  }
  return row;
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
