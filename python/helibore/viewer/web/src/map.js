// The map: the whole well from the overview, in the colours of the current quantity, with zones and enlargement beside it,
// the section as a window to drag, the picks, the cursor and the bit. Grey at the left edge: a vertex there is not measured;
// grey dots: the turn is interpolated between arms.

import { lookup, scaling, themed } from './color.js';
import { pen } from './device.js';
import { label, PALETTES, SMALL } from './layout.js';
import { rowOf } from './map_rows.js';
import { edges, hatched, line, OUTSIDE, pointer } from './strokes.js';
import { depthNumber, depthUnit } from './units.js';
import { drawZones } from './zones.js';

const WIDE = 24; // pixels of colour; the rest of the track is the enlargement
const EDGE = 3; // pixels of grey at the left where something is missing
const FULL = 0.03; // metres over bit radius that fill the enlargement's width

export class DepthMap {
  constructor() {
    this.canvas = document.createElement('canvas');
    /** @type {ImageData | undefined} */
    this.picture = undefined; // of the canvas, made once for its size
    this.key = '';
  }

  // Return the depths at the two ends of the map: those of the wall, or of the bit if the bit is ahead of the wall.
  /** @param {Look} look */
  ends({ store, bitDepth }) {
    const [top, bottom] = store.span;
    const reach = bitDepth === null ? [top, bottom] : [Math.min(top, bitDepth), Math.max(bottom, bitDepth)];
    return reach[1] - reach[0] < 1 ? [reach[0] - 0.5, reach[1] + 0.5] : reach;
  }

  /** @param {Look} look @param {number} y */
  depthAt(look, y) {
    const { top, height } = look.rects.map;
    const [a, b] = this.ends(look);
    return a + ((y - top) / height) * (b - a);
  }

  /** @param {Ink} ink @param {Look} look @param {WallPick[]} picks */
  draw(ink, look, picks) {
    const { store, view, rects, bitDepth, notes, zones } = look;
    const palette = PALETTES[view.theme];
    const rect = rects.map;
    if (!rect.width) return;
    const [a, b] = this.ends(look);
    /** @param {number} depth */
    const y = (depth) => rect.top + ((depth - a) / (b - a)) * rect.height;
    this.refresh(look, a, b);
    ink.drawImage(this.canvas, rect.left + 2, rect.top, rect.width - 4, rect.height);
    drawZones(ink, zones, y, rect.left + 2 + WIDE, 3, [rect.top, rect.top + rect.height], palette);
    const [shallow, deep] = store.span;
    for (const [from, to] of [[a, shallow], [deep, b]]) if (y(to) - y(from) >= 2) hatched(ink, rect.left + 2, y(from), WIDE, y(to) - y(from), palette, OUTSIDE);
    edges(ink, { left: rect.left + 2.5, top: rect.top + 0.5, width: rect.width - 5, height: rect.height - 1 }, palette.line);
    label(ink, 'well', rect.left + 3, 11, { colour: palette.soft, font: SMALL });
    if (rect.width > 50) label(ink, `MD ${depthUnit(view.units)}`, rect.left + 3, 29, { colour: palette.soft, font: SMALL });
    const digits = b - a < 20 ? 1 : 0; // a well of a few metres may end between two metres
    label(ink, depthNumber(a, view.units, digits), rect.left + rect.width / 2, rect.top - 9, { colour: palette.soft, align: 'center', font: SMALL });
    const size = Math.max(6, y(view.bottom) - y(view.top));
    const middle = (y(view.top) + y(view.bottom)) / 2;
    const upper = Math.max(rect.top + 1, middle - size / 2);
    const tall = Math.max(4, Math.min(rect.top + rect.height - 1, middle + size / 2) - upper);
    ink.fillStyle = palette.grid;
    ink.fillRect(rect.left, upper, rect.width, tall);
    edges(ink, { left: rect.left + 1, top: upper, width: rect.width - 2, height: tall }, palette.ink, 2);
    for (const { depth, kind } of picks) if (depth >= a && depth <= b) line(ink, rect.left + rect.width - 7, y(depth), rect.left + rect.width - 2, y(depth), palette.picks[kind], [], 2);
    for (const { depth } of notes) line(ink, rect.left + rect.width - 9, y(depth), rect.left + rect.width, y(depth), palette.pin);
    if (view.cursor) line(ink, rect.left, y(view.cursor.depth), rect.left + rect.width, y(view.cursor.depth), palette.ink);
    if (bitDepth !== null) pointer(ink, rect.left + rect.width - 8, y(bitDepth), 9, palette.ink);
    label(ink, depthNumber(b, view.units, digits), rect.left + rect.width / 2, rect.top + rect.height + 10, { colour: palette.soft, align: 'center', font: SMALL });
  }

  // Make the picture of the well anew only when the overview, the colours or the ends changed.
  /** @param {Look} look @param {number} a @param {number} b */
  refresh({ store, view, quantity, rects }, a, b) {
    const over = store.levels[1];
    const versions = [...over.tiles.values()].reduce((sum, tile) => sum + tile.version, 0);
    const { id, low, high, map, log } = quantity;
    const bars = store.basis !== 'gauge';
    const key = [store.session, versions, over.shown, id, low, high, map, log, view.pass, view.theme, a, b, rects.map.height].join();
    if (key === this.key) return;
    this.key = key;
    const [width, height] = [rects.map.width - 4, Math.ceil(rects.map.height)];
    const ink = pen(this.canvas);
    if (this.picture?.width !== width || this.picture.height !== height) {
      Object.assign(this.canvas, { width, height });
      this.picture = ink.createImageData(width, height);
    }
    const palette = PALETTES[view.theme];
    const paint = {
      pixels: new Uint32Array(this.picture.data.buffer).fill(0),
      width,
      colours: new Uint32Array(lookup(themed(map, view.theme === 'dark')).buffer),
      missing: packed(palette.hatch),
      bar: bars ? packed(palette.fills.over) : 0,
    };
    /** @param {number} y */
    const place = (y) => (a + (y / height) * (b - a) - over.startDepth) / over.pitch; // in turns of the overview
    for (let y = 0; y < height; y++) paintRow(paint, y, rowOf(store, quantity, view.pass, place(y), place(y + 1)), quantity);
    ink.putImageData(this.picture, 0, 0);
  }
}

/** @typedef {{ pixels: Uint32Array, width: number, colours: Uint32Array, missing: number, bar: number }} Paint */
/** @param {Paint} paint @param {number} y @param {MapRow} row @param {Quantity} quantity */
function paintRow({ pixels, width, colours, missing, bar }, y, { means, between, most, lacks }, { low, high, log }) {
  const f = scaling(log);
  const [a, b] = [f(low), f(high)];
  const row = y * width;
  /** @param {number} c */
  const end = (c) => row + Math.round((c * WIDE) / means.length);
  means.forEach((mean, c) => {
    if (mean === undefined) return;
    const share = Math.min(1, Math.max(0, (f(mean) - a) / (b - a)));
    const colour = Number.isNaN(share) ? missing : colours[Math.round(255 * share)];
    pixels.fill(colour, end(c), end(c + 1));
    if (between[c]) for (let x = end(c); x < end(c + 1); x++) if ((x - row - y) % 4 === 0) pixels[x] = missing;
  });
  if (lacks) pixels.fill(missing, row, row + EDGE);
  pixels.fill(bar, row + WIDE + 4, row + WIDE + 4 + Math.round(Math.min(1, most / FULL) * (width - WIDE - 4)));
}

// Return a colour of the palette as one pixel, alpha last in memory.
/** @param {string} hex */
const packed = (hex) => new Uint32Array(Uint8Array.from([1, 3, 5, 7].map((i) => (i < 7 ? parseInt(hex.slice(i, i + 2), 16) : 255))).buffer)[0];
