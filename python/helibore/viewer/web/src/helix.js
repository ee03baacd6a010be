// Where a vertex lies, and which quad covers a point. The whole page uses these rules:
//
//   vertex k:  row = floor(k / K), col = k mod K          toolface grows with col, depth with k
//   depth      = startDepth + (row + col / K) pitch       K = sectors of a turn, pitch is signed
//   toolface   = startToolface + 360 col / K
//   quad k     = (k, k+1, k+1+K, k+K): it exists when all four vertices have a radius
//
// The overview is made of level rings instead: all of row R lies at startDepth + R pitch, and cell k exists when its own
// vertex has a radius. Angles in degrees, depths in metres, all in float64. Nothing here knows tiles, bytes or pixels.

/** @param {number} angle */
export const wrap360 = (angle) => ((angle % 360) + 360) % 360;
/** @param {number} angle */
export const wrap180 = (angle) => wrap360(angle + 180) - 180;

export class Helix {
  /** @param {Omit<Shape, 'rows'>} shape */
  constructor({ sectors, pitch, startDepth, startToolface, rings = false }) {
    this.sectors = sectors;
    this.pitch = pitch;
    this.startDepth = startDepth;
    this.startToolface = startToolface;
    this.rings = rings;
  }

  /** @param {number} k */
  depth(k) {
    return this.startDepth + (this.rings ? Math.floor(k / this.sectors) : k / this.sectors) * this.pitch;
  }

  /** @param {number} k */
  toolface(k) {
    return wrap360(this.startToolface + ((k % this.sectors) * 360) / this.sectors);
  }

  // Return a place along the hole, in turns, as columns lie, and around it, in columns.
  /** @param {number} depth @param {number} toolface @returns {Pair} */
  place(depth, toolface) {
    const across = (wrap360(toolface - this.startToolface) / 360) * this.sectors;
    return [(depth - this.startDepth) / this.pitch - (this.rings ? 0 : across / this.sectors), across];
  }

  // Return the quad that covers (depth, toolface); its number is negative or too large if the wall does not reach there. For an
  // image that was measured in `rows` [depth of an edge between two rows, height of a row]: the quad that has the value of the row
  // at `depth`.
  /** @param {number} depth @param {number} toolface @param {Pair | null} [rows] */
  quadAt(depth, toolface, rows = null) {
    const [turn, across] = this.place(depth, toolface);
    const col = Math.min(Math.floor(across), this.sectors - 1);
    const middle = rows && rows[0] + (Math.floor((depth - rows[0]) / rows[1]) + 0.5) * rows[1];
    const row = Math.floor(rows && !this.rings ? (Number(middle) - this.startDepth) / this.pitch - (col + 0.5) / this.sectors : turn);
    return row * this.sectors + col;
  }

  // Return the vertex nearest to (depth, toolface), a corner of the quad there; of rings, whose cells have values, the cell.
  /** @param {number} depth @param {number} toolface */
  vertexAt(depth, toolface) {
    const [turn, across] = this.place(depth, toolface).map(Math.round);
    return this.rings ? this.quadAt(depth, toolface) : turn * this.sectors + across;
  }

  // Return the first vertex of the turn around a depth: one of the turns that logs, zones and report count, so that all have its numbers.
  /** @param {number} depth */
  turnAt(depth) {
    return Math.floor((depth - this.startDepth) / this.pitch) * this.sectors;
  }

  // Return the depths between which `size` vertices lie, shallow end first.
  /** @param {number} size */
  span(size) {
    const ends = [this.startDepth, this.depth(Math.max(0, size - 1))];
    return this.pitch > 0 ? ends : ends.reverse();
  }
}
