// The map: the whole well from the overview, in the colours of the current quantity, with the enlargement beside it, the
// section as a window to drag, the cursor and the bit.

import { MAPS, valueAt } from './colour.js';
import { pen } from './device.js';
import { label, PALETTES, SMALL } from './layout.js';
import { RADIUS, TEXEL } from './protocol.js';
import { line } from './tracks.js';

const WIDE = 24; // pixels of colour; the rest of the track is the enlargement
const FULL = 0.03; // metres over bit radius that fill the enlargement's width

export class DepthMap {
  constructor() {
    this.canvas = document.createElement('canvas');
    this.key = '';
  }

  // Depths at the two ends of the map: the wall, and the bit where it is ahead.
  ends({ store, bitDepth }) {
    const [top, bottom] = store.span;
    const reach = bitDepth === null ? [top, bottom] : [Math.min(top, bitDepth), Math.max(bottom, bitDepth)];
    return reach[1] - reach[0] < 1 ? [reach[0] - 0.5, reach[1] + 0.5] : reach;
  }

  depthAt(look, y) {
    const { top, height } = look.rects.map;
    const [a, b] = this.ends(look);
    return a + ((y - top) / height) * (b - a);
  }

  draw(ink, look) {
    const { view, rects, bitDepth } = look;
    const palette = PALETTES[view.theme];
    const rect = rects.map;
    const [a, b] = this.ends(look);
    const y = (depth) => rect.top + ((depth - a) / (b - a)) * rect.height;
    this.refresh(look, a, b);
    ink.drawImage(this.canvas, rect.left + 2, rect.top, rect.width - 4, rect.height);
    ink.strokeStyle = palette.line;
    ink.lineWidth = 1;
    ink.strokeRect(rect.left + 2.5, rect.top + 0.5, rect.width - 5, rect.height - 1);
    label(ink, 'well', rect.left + 3, 11, { colour: palette.soft, font: SMALL });
    label(ink, 'MD m', rect.left + 3, 29, { colour: palette.soft, font: SMALL });
    label(ink, a.toFixed(0), rect.left + rect.width / 2, rect.top - 9, { colour: palette.soft, align: 'center', font: SMALL });
    const size = Math.max(6, y(view.bottom) - y(view.top));
    const middle = (y(view.top) + y(view.bottom)) / 2;
    const upper = Math.max(rect.top + 1, middle - size / 2);
    const tall = Math.max(4, Math.min(rect.top + rect.height - 1, middle + size / 2) - upper);
    ink.fillStyle = palette.grid;
    ink.fillRect(rect.left, upper, rect.width, tall);
    ink.strokeStyle = palette.ink;
    ink.lineWidth = 2;
    ink.strokeRect(rect.left + 1, upper, rect.width - 2, tall);
    if (view.cursor) line(ink, rect.left, y(view.cursor.depth), rect.left + rect.width, y(view.cursor.depth), palette.cursor);
    if (bitDepth !== null) label(ink, '◀', rect.left + rect.width, y(bitDepth), { colour: palette.ink, align: 'right', font: SMALL });
    label(ink, b.toFixed(0), rect.left + rect.width / 2, rect.top + rect.height - 8, { colour: palette.ink, halo: palette.paper, align: 'center', font: SMALL });
  }

  // Redraw the picture of the well only when the overview, the colours or the ends changed.
  refresh({ store, view, quantity, rects }, a, b) {
    const over = store.levels[1];
    const versions = [...over.tiles.values()].reduce((sum, tile) => sum + tile.version, 0);
    const { id, low, high, map, log } = quantity;
    const key = [store.session, versions, id, low, high, map, log, view.pass, view.theme, a, b, rects.map.height].join();
    if (key === this.key) return;
    this.key = key;
    const { width, height } = rects.map;
    this.canvas.width = width - 4;
    this.canvas.height = Math.ceil(height);
    const ink = pen(this.canvas);
    const { anchors } = MAPS[map];
    const palette = PALETTES[view.theme];
    for (let y = 0; y < height; y++) this.row(ink, store, over, quantity, view, a + ((y + 0.5) / height) * (b - a), y, anchors, palette);
  }

  row(ink, store, over, quantity, view, depth, y, anchors, palette) {
    const C = over.sectors;
    const row = Math.round((depth - over.startDepth) / over.pitch);
    let most = 0;
    for (let c = 0; c < C; c++) {
      const k = row * C + c;
      const { tile, at } = over.locate(k);
      if (!tile || k < 0 || k >= over.shown) continue;
      const value = valueAt(store, quantity, tile, at, view.pass);
      ink.fillStyle = Number.isFinite(value) ? colourFor(quantity, value, anchors) : palette.hatch;
      ink.fillRect((c * WIDE) / C, y, WIDE / C + 0.5, 1);
      const steps = tile.texels[TEXEL * at + RADIUS];
      if (steps) most = Math.max(most, steps * store.radiusUnit - store.bitRadius);
    }
    ink.fillStyle = palette.max;
    ink.fillRect(WIDE + 2, y, Math.min(1, most / FULL) * (this.canvas.width - WIDE - 2), 1);
  }
}

export function colourFor({ low, high, log }, value, anchors) {
  const f = log ? Math.log : (x) => x;
  const share = Math.min(1, Math.max(0, (f(value) - f(low)) / (f(high) - f(low)))) || 0;
  const place = share * (anchors.length - 1);
  const i = Math.min(Math.floor(place), anchors.length - 2);
  const mixed = anchors[i].map((c, j) => Math.round(c + (place - i) * (anchors[i + 1][j] - c)));
  return `rgb(${mixed.join(' ')})`;
}
