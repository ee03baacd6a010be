// The image track without WebGL 2: the same quads, colours and hatching, pixel by pixel on a 2-D canvas.

import { dynamicRange, lookup, Q_ATTRIBUTE, scaling, themed, valueAt } from './color.js';
import { depthAt } from './layout.js';
import { CUTS } from './path.js';
import { wrap360 } from './helix.js';
import { INTERPOLATED, STATE, TEXEL } from './protocol.js';

export class PlainImage {
  constructor() {
    this.canvas = document.createElement('canvas');
  }

  /** @param {Ink} ink @param {Look} look */
  draw(ink, look) {
    const { left, top, width, height } = look.rects.image;
    const [w, h] = [Math.round(width), Math.round(height)];
    Object.assign(this.canvas, { width: w, height: h });
    const target = /** @type {CanvasRenderingContext2D} */ (this.canvas.getContext('2d'));
    const picture = target.createImageData(w, h);
    for (const piece of look.imagePieces) this.piece(picture, look, piece);
    target.putImageData(picture, 0, 0);
    ink.drawImage(this.canvas, left, top, width, height);
  }

  /** @param {ImageData} picture @param {Look} look @param {Piece} piece */
  piece(picture, look, { tile, top, bottom }) {
    const { view, rects, store, quantity } = look;
    const { level } = tile;
    const table = lookup(themed(quantity.map, look.dark));
    const ranges = quantity.dynamic ? dynamicRange(store, quantity, tile, view.pass) : null;
    const rect = { ...rects.image, top: 0 };
    const beyond = Math.abs(level.pitch) + (quantity.rows?.[1] ?? 0);
    for (let y = 0; y < picture.height; y++) {
      const depth = depthAt(view, rect, y + 0.5);
      if (depth < top - beyond || depth > bottom + beyond) continue;
      const edge = this.edge(look, depth);
      for (let x = 0; x < picture.width; x++) {
        const toolface = wrap360(edge + (360 * (x + 0.5)) / picture.width);
        const k = level.quadAt(depth, toolface, quantity.rows);
        const at = k - tile.index * level.tileSize;
        if (at < 0 || at >= level.tileSize || k + (level.rings ? 0 : level.sectors + 1) >= level.shown) continue;
        const own = quantity.mode === Q_ATTRIBUTE ? at : at + level.vertexAt(depth, toolface) - k;
        const row = Math.floor(at / level.sectors);
        const ends = ranges ? [ranges[2 * row], ranges[2 * row + 1]] : [quantity.low, quantity.high];
        const value = quantity.mode === Q_ATTRIBUTE || store.quad(k, level) ? valueAt(store, quantity, tile, own, view.pass) : NaN;
        const pixel = this.colour(value, ends, quantity.log, table, x + y, look.dark);
        picture.data.set(between(quantity, tile, own) ? sparse(pixel, x - y, look.dark) : pixel, 4 * (y * picture.width + x));
      }
    }
  }

  /** @param {Look} look @param {number} depth */
  edge({ path, view }, depth) {
    const { reference, offset } = CUTS[view.cut];
    return (path.dial(depth)[reference] ?? 0) + offset;
  }

  /** @type {(value: number, ends: number[], log: boolean, table: Uint8Array, diagonal: number, dark: boolean) => Uint8Array} */
  colour(value, [low, high], log, table, diagonal, dark) {
    if (!Number.isFinite(value) || (log && value <= 0)) {
      const shade = diagonal % 7 < 2 ? (dark ? 92 : 158) : dark ? 61 : 204;
      return Uint8Array.of(shade, shade, shade, 255);
    }
    const f = scaling(log);
    const share = Math.min(1, Math.max(0, (f(value) - f(low)) / (f(high) - f(low)))) || 0;
    const at = 4 * Math.round(255 * share);
    return table.subarray(at, at + 4);
  }
}

/** @param {Quantity} quantity @param {Tile} tile @param {number} at */
const between = (quantity, tile, at) => quantity.mode !== Q_ATTRIBUTE && (tile.texels[TEXEL * at + STATE] & INTERPOLATED) > 0;

/** @type {(pixel: Uint8Array, diagonal: number, dark: boolean) => Uint8Array} */
function sparse([red, green, blue], diagonal, dark) {
  if (diagonal % 10 === 0) return dark ? Uint8Array.of(117, 117, 117, 255) : Uint8Array.of(140, 140, 140, 255);
  return Uint8Array.of(...[red, green, blue].map((c) => Math.round(0.45 * c + 0.55 * (dark ? 38 : 245))), 255);
}

const drawn = new PlainImage();

/** @param {Ink} ink @param {Look} look */
export const plainImage = (ink, look) => drawn.draw(ink, look);
