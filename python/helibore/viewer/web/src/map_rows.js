// What a line of the map shows of the overview: all the turns that lie in it, nothing picked and nothing left out.

import { valueAt } from './colour.js';
import { RADIUS, STATE, SUPPORT_MASK, TEXEL } from './protocol.js';

// All overview vertices between two places of its helix as one row: the mean of each sector, NaN where one of them has nothing,
// so that no gap is averaged away; undefined beyond the wall; the largest enlargement, and whether any vertex lacks support.
export function rowOf(store, quantity, pass, from, to) {
  const [wall, over] = store.levels;
  const C = over.sectors;
  const turnsEach = over.pitch / wall.pitch;
  const whole = wall.shown / wall.sectors / turnsEach - 0.5; // beyond it a window is not full yet
  const [x0, x1] = [Math.min(from, to), Math.max(from, to)];
  const row = { means: [], most: 0, lacks: false };
  for (let c = 0; c < C; c++) {
    const first = Math.round(x0 - c / C);
    let [sum, count] = [0, 0];
    for (let r = first; r < Math.max(first + 1, Math.round(x1 - c / C)); r++) {
      const k = r * C + c;
      const { tile, at } = over.locate(k);
      if (!tile || k >= over.shown) continue;
      const strip = stripOf(store, quantity, pass, tile);
      sum += strip.values[at];
      row.most = Math.max(row.most, strip.enlarged[at]);
      row.lacks ||= strip.lacks[at] === 1 && r + c / C + 1 / turnsEach < whole;
      count++;
    }
    row.means.push(count ? sum / count : undefined);
  }
  return row;
}

// What the map needs of an overview tile, kept with it until it changes.
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
