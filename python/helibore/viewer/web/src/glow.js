// Highlights new values: ranges of vertices that arrived lately, brightest at first, not highlighted any more after a few seconds.

export const SECONDS = 3;
const MOST = 8;

export class Glow {
  /** @type {{ start: number, stop: number, again: boolean, at: number }[]} */
  ranges = [];
  rows = 0; // turns in a tile of the wall

  // Note that values of the vertices [start, stop) arrived; `again`: the wall had these vertices before. A range that
  // touches the latest range extends it, if the latest range is of the same kind and less than 0.3 s old.
  /** @param {number} start @param {number} stop @param {boolean} again @param {number} now */
  add(start, stop, again, now) {
    const last = this.ranges.at(-1);
    if (last && last.again === again && now - last.at < 0.3 && start <= last.stop && stop >= last.start) {
      [last.start, last.stop] = [Math.min(start, last.start), Math.max(stop, last.stop)];
    } else this.ranges.push({ start, stop, again, at: now });
    if (this.ranges.length > MOST) this.ranges.shift();
  }

  /** @param {number} now */
  fade(now) {
    this.ranges = this.ranges.filter(({ at }) => now - at < SECONDS);
    return this.ranges.length > 0;
  }

  // Return the ranges that touch a tile: [start, stop, strength, 1 for a re-scan]; numbers count from the tile's first vertex.
  /** @param {Tile} tile @param {number} now */
  on(tile, now) {
    if (tile.level.rows !== this.rows) return [];
    const origin = tile.index * tile.level.tileSize;
    const size = tile.level.tileSize;
    return this.ranges
      .filter(({ start, stop }) => stop > origin && start < origin + size)
      .map(({ start, stop, again, at }) => [start - origin, stop - origin, 0.85 * Math.max(0, 1 - (now - at) / SECONDS), again ? 1 : 0]);
  }
}
