// The wall as the page holds it: two levels of tiles, each an image of `rows` turns by `sectors`, two rows more for
// the halo (the first sectors + 1 vertices of the next tile, so tiles join without cracks).
//
//   Store.levels[0]  the wall, tiles near the section shown, least recently used dropped first
//   Store.levels[1]  the overview (rings of 8 sectors, 16 turns each), always whole
//
// A tile's typed arrays are the only copy on the CPU; the textures are made from them.

import { Helix } from './helix.js';
import { FIRST, NEAREST, RADIUS, STATE, TEXEL } from './protocol.js';

const ROUND = 4; // columns of the grid to a cell of the overview, as in shaders.js

export class Tile {
  /** @param {Level} level @param {number} index @param {number} attributes */
  constructor(level, index, attributes) {
    this.level = level;
    this.index = index;
    this.texels = new Uint16Array(TEXEL * level.sectors * (level.rows + 2));
    /** @type {(Float32Array | null)[]} */
    this.columns = Array.from({ length: attributes }, () => null);
    // What was derived from the tile, kept until it changes.
    /** @type {Record<string, RowFigures>} */
    this.figures = {};
    /** @type {Strip | undefined} */
    this.strip = undefined;
    /** @type {{ latest?: TileTurns, first?: TileTurns }} */
    this.turns = {};
    /** @type {import('./textures.js').TileTextures | undefined} */
    this.textures = undefined;
    this.version = 0; // counts writes; whatever is derived from the tile keeps the version that it was made from
    this.used = 0;
    this.filled = 0; // how many vertices, from the tile's first on, have arrived: a new value for one of them is a re-scan
  }

  // Values of one attribute, NaN where none has arrived.
  /** @param {number} attribute */
  column(attribute) {
    this.columns[attribute] ??= new Float32Array(this.texels.length / TEXEL).fill(NaN);
    return this.columns[attribute];
  }

  get startDepth() {
    return this.level.startDepth + this.index * this.level.rows * this.level.pitch;
  }

  // The depths of the shallow end and of the deep end.
  get span() {
    const ends = [this.startDepth, this.startDepth + this.level.rows * this.level.pitch];
    return this.level.pitch > 0 ? ends : ends.reverse();
  }
}

export class Level extends Helix {
  /** @param {Shape} shape */
  constructor(shape) {
    super(shape);
    this.rows = shape.rows;
    this.size = 0;
    this.limit = Infinity; // vertices to show, fewer than there are while an earlier state is replayed
    /** @type {Map<number, Tile>} */
    this.tiles = new Map();
  }

  get shown() {
    return Math.min(this.size, this.limit);
  }

  get tileSize() {
    return this.rows * this.sectors;
  }

  // The columns of its grid in 3-D: a ring of a few cells is drawn round.
  get columns() {
    return this.rings ? ROUND * this.sectors : this.sectors;
  }

  /** @param {number} depth */
  tileAtDepth(depth) {
    return Math.max(0, Math.floor((depth - this.startDepth) / (this.pitch * this.rows)));
  }

  // Return the numbers of the tiles that lie between two depths, within the wall.
  /** @param {number} top @param {number} bottom */
  tilesBetween(top, bottom) {
    if (this.shown === 0) return [];
    const [a, b] = [this.tileAtDepth(top), this.tileAtDepth(bottom)];
    const last = Math.floor((this.shown - 1) / this.tileSize);
    const numbers = [];
    for (let t = Math.min(a, b); t <= Math.min(Math.max(a, b), last); t++) numbers.push(t);
    return numbers;
  }

  // Return the tile that has vertex k, and the place of the vertex in this tile.
  /** @param {number} k */
  locate(k) {
    const index = Math.floor(k / this.tileSize);
    return { tile: k < 0 ? undefined : this.tiles.get(index), at: k - index * this.tileSize };
  }
}

export class Store {
  /** @param {Handshake} handshake */
  constructor(handshake) {
    this.session = handshake.session;
    this.basis = handshake.basis;
    const intervals = handshake.intervals ?? [];
    this.intervals = intervals.filter(([, , , track]) => !track); // formations, whose tops cross all tracks
    this.placed = intervals.filter(([, , , track]) => track); // casings, mud log: in tracks of their own
    this.columns = [...new Set(this.placed.map(([, , , track]) => track ?? ''))]; // the names of these tracks
    this.plan = handshake.plan ?? [];
    this.radiusUnit = handshake.radius_unit;
    this.nearestUnit = handshake.nearest_unit;
    this.bitRadius = handshake.bit_diameter / 2;
    const { start_depth: startDepth, start_toolface: startToolface } = handshake;
    this.levels = handshake.levels.map((shape) => new Level({ ...shape, startDepth, startToolface }));
    this.levels[0].size = handshake.vertices;
    const pitch = Math.abs(this.levels[0].pitch) * (1 - 1e-6);
    this.attributes = handshake.attributes.map((one) => (one.rows && one.rows[1] < pitch ? { ...one, rows: null, thin: one.rows[1] } : one));
    this.clock = 0;
  }

  // Depths between which the wall lies, shallow end first.
  get span() {
    return this.levels[0].span(this.levels[0].shown);
  }

  get end() {
    const wall = this.levels[0];
    return wall.depth(Math.max(0, wall.shown - 1));
  }

  // Show only the first `vertices` vertices of the wall, as at an earlier moment; Infinity: all.
  /** @param {number} vertices */
  limit(vertices) {
    const [wall, over] = this.levels;
    wall.limit = vertices;
    over.limit = Math.ceil((vertices * wall.pitch) / (wall.sectors * over.pitch)) * over.sectors;
  }

  /** @param {Write} write */
  apply(write) {
    const level = this.levels[write.level];
    level.size = write.total;
    let tile = level.tiles.get(write.tile);
    if (!tile) {
      tile = new Tile(level, write.tile, this.attributes.length);
      level.tiles.set(write.tile, tile);
    }
    tile.texels.set(write.texels, TEXEL * write.first);
    for (const { attribute, values } of write.columns) tile.column(attribute).set(values, write.first);
    tile.version++;
    tile.filled = Math.max(tile.filled, write.first + write.count);
    return tile;
  }

  /** @param {Tile | undefined} tile */
  touch(tile) {
    if (tile) tile.used = ++this.clock;
  }

  get tileBytes() {
    const wall = this.levels[0];
    return wall.sectors * (wall.rows + 2) * (2 * TEXEL + 4 * this.attributes.length) * 2; // CPU and GPU
  }

  // Return the wall tiles to drop so that at most `bytes` are held, least recently used first, never one of `wanted`.
  /** @param {number} bytes @param {Set<number>} wanted */
  surplus(bytes, wanted) {
    const room = Math.max(1, Math.floor(bytes / this.tileBytes));
    const held = [...this.levels[0].tiles.values()];
    const spare = held.filter((tile) => !wanted.has(tile.index)).sort((a, b) => a.used - b.used);
    return spare.slice(0, Math.max(0, held.length - room));
  }

  // Return everything known of a quad, in metres; null if the page does not have its tile, or if one of its vertices has no radius.
  /** @param {number} k @param {Level} [level] */
  quad(k, level = this.levels[0]) {
    const { tile, at } = level.locate(k);
    if (!tile || k < 0) return null;
    const K = level.sectors;
    const corners = level.rings ? [at] : [at, at + 1, at + K, at + K + 1];
    return corners.every((corner) => tile.texels[TEXEL * corner + RADIUS]) ? this.vertex(k, level) : null;
  }

  // Return everything known of the vertex nearest to a place; null if there is no quad.
  /** @param {number} depth @param {number} toolface */
  near(depth, toolface) {
    const [wall] = this.levels;
    return this.quad(wall.quadAt(depth, toolface)) && this.vertex(wall.vertexAt(depth, toolface));
  }

  // Return the value of an attribute at a place, as the picture shows it there.
  /** @param {number} index @param {Cursor | null} at */
  attributeAt(index, at) {
    if (!at || at.toolface === null) return NaN;
    const [wall] = this.levels;
    const k = wall.quadAt(at.depth, at.toolface, this.attributes[index].rows);
    const found = wall.locate(k);
    return k + wall.sectors + 1 < wall.shown ? (found.tile?.columns[index]?.[found.at] ?? NaN) : NaN;
  }

  /** @param {number} k @param {Level} [level] */
  vertex(k, level = this.levels[0]) {
    const { tile, at } = level.locate(k);
    if (!tile || k < 0 || k >= level.shown) return null;
    const [radius, first, nearest, state] = [RADIUS, FIRST, NEAREST, STATE].map((i) => tile.texels[TEXEL * at + i]);
    if (radius === 0) return null;
    return {
      k,
      depth: level.depth(k),
      toolface: level.toolface(k),
      radius: radius * this.radiusUnit,
      first: first === 0 ? NaN : first * this.radiusUnit,
      nearest: nearest === 0xffff ? Infinity : nearest * this.nearestUnit,
      state,
      attributes: tile.columns.map((column) => (column ? column[at] : NaN)),
    };
  }
}

// Return what to draw between two depths: wall tiles where the page has them, the overview elsewhere. If `fine` is
// false, return the overview alone. Each piece says which depths of its tile to show; pieces never overlap; the pieces
// of the overview come first.
/** @param {Store} store @param {number} top @param {number} bottom @param {boolean} fine */
export function coverage(store, top, bottom, fine) {
  const [wall, over] = store.levels;
  /** @type {Piece[]} */
  const pieces = [];
  /** @type {Pair | null} */
  let missing = null;
  const flush = () => {
    if (missing) for (const index of over.tilesBetween(...missing)) cover(index, missing);
    missing = null;
  };
  /** @param {number} index @param {Pair} pair */
  const cover = (index, [a, b]) => {
    const tile = over.tiles.get(index);
    if (!tile) return;
    const [low, high] = tile.span;
    if (Math.min(b, high) > Math.max(a, low)) pieces.push({ tile, top: Math.max(a, low), bottom: Math.min(b, high) });
  };
  const numbers = wall.tilesBetween(top, bottom).sort((a, b) => (wall.pitch > 0 ? a - b : b - a));
  for (const index of numbers) {
    const tile = fine ? wall.tiles.get(index) : undefined;
    const start = wall.startDepth + index * wall.rows * wall.pitch;
    const ends = [start, start + wall.rows * wall.pitch].sort((a, b) => a - b);
    const [a, b] = [Math.max(top, ends[0], store.span[0]), Math.min(bottom, ends[1], store.span[1])];
    if (b <= a) continue;
    if (tile) {
      flush();
      pieces.push({ tile, top: a, bottom: b });
    } else if (missing) missing[1] = b;
    else missing = [a, b];
  }
  flush();
  return pieces.sort((a, b) => Number(b.tile.level === over) - Number(a.tile.level === over));
}
