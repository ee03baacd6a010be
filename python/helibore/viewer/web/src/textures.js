// A tile's arrays as textures. Each texture is made once, and uploaded again when its values have another version. A tile is
// uploaded whole: 132 kB take a tenth of a millisecond, a hundredth of drawing the frame.

import { dynamicRange, lookup } from './color.js';
import { Texture } from './gl.js';
import { eastNorthUp } from './vectors.js';

export class TileTextures {
  /** @type {FramesTexture | null} */
  frames = null;
  /** @type {{ key: string, version: number, texture: Texture } | null} */
  range = null;

  /** @param {Tile} tile */
  constructor(tile) {
    this.tile = tile;
    const { sectors, rows } = tile.level;
    this.texels = new Texture(tile.texels, sectors, rows + 2, 'texels');
    this.version = tile.version;
    /** @type {Map<number, { texture: Texture, version: number }>} */
    this.columns = new Map();
  }

  vertices() {
    if (this.version !== this.tile.version) {
      this.version = this.tile.version;
      this.texels.change();
    }
    return this.texels;
  }

  /** @param {number} index */
  attribute(index) {
    const { sectors, rows } = this.tile.level;
    let kept = this.columns.get(index);
    if (!kept) {
      kept = { texture: new Texture(this.tile.column(index), sectors, rows + 2, 'value'), version: this.tile.version };
      this.columns.set(index, kept);
    }
    if (kept.version !== this.tile.version) {
      kept.version = this.tile.version;
      kept.texture.change();
    }
    return kept.texture;
  }

  // Return {texture, first, origin}: the frames around the tile, with centres (east, north, up) relative to `origin`, which is
  // subtracted in float64; `first` is the place of the tile's start among these frames.
  /** @param {Path} path */
  path(path) {
    if (this.frames?.version === path.version && this.frames.path === path) return this.frames;
    this.frames?.texture.dispose();
    const { level } = this.tile;
    const start = (this.tile.startDepth - path.startDepth) / path.step;
    const first = Math.max(0, Math.floor(start));
    const span = Math.abs((level.rows + 1 + 1 / level.sectors) * level.pitch);
    const count = Math.max(2, Math.min(path.count - first, Math.ceil(span / Math.abs(path.step)) + 2));
    const array = new Float32Array(4 * 3 * count);
    const origin = eastNorthUp(path.centre.subarray(3 * first, 3 * first + 3));
    const angles = { up: 0, north: 0 };
    for (let i = 0; i < count; i++) {
      const j = Math.min(first + i, path.count - 1);
      const centre = eastNorthUp(path.centre.subarray(3 * j, 3 * j + 3));
      const dial = path.dial(path.startDepth + j * path.step);
      for (const name of /** @type {const} */ (['up', 'north'])) {
        const angle = dial[name];
        if (angle !== null) angles[name] = nearTo(angles[name], (angle * Math.PI) / 180, i);
      }
      array.set(centre.map((x, c) => x - origin[c]), 4 * i);
      array[4 * i + 3] = angles.up;
      array.set(eastNorthUp(path.directions.subarray(6 * j, 6 * j + 3)), 4 * (count + i));
      array[4 * (count + i) + 3] = angles.north;
      array.set(eastNorthUp(path.directions.subarray(6 * j + 3, 6 * j + 6)), 4 * (2 * count + i));
    }
    this.frames = {
      texture: new Texture(array, count, 3, 'frames'),
      first: start - first,
      origin,
      version: path.version,
      path,
    };
    return this.frames;
  }

  /** @param {Store} store @param {Quantity} quantity @param {Pass} pass */
  dynamic(store, quantity, pass) {
    const key = `${quantity.id}/${pass}/${quantity.log}`;
    if (this.range?.key !== key || this.range.version !== this.tile.version) {
      this.range?.texture.dispose();
      const array = dynamicRange(store, quantity, this.tile, pass);
      this.range = { key, version: this.tile.version, texture: new Texture(array, this.tile.level.rows, 1, 'pair') };
    }
    return this.range.texture;
  }

  dispose() {
    this.texels.dispose();
    for (const { texture: one } of this.columns.values()) one.dispose();
    this.frames?.texture.dispose();
    this.range?.texture.dispose();
  }
}

/** @param {number} before @param {number} angle @param {number} i */
const nearTo = (before, angle, i) => (i === 0 ? angle : angle + 2 * Math.PI * Math.round((before - angle) / (2 * Math.PI)));

/** @type {Map<string, Texture>} */
const tables = new Map();
/** @param {string} name */
export function colourTexture(name) {
  if (!tables.has(name)) tables.set(name, new Texture(lookup(name), 256, 1, 'colours'));
  return tables.get(name);
}

export const NO_COLUMN = new Texture(new Float32Array([NaN]), 1, 1, 'value');
export const NO_RANGE = new Texture(new Float32Array([0, 1]), 1, 1, 'pair');
