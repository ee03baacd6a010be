// The colours of the hole in one line: quantity, unit and ends. Images have them in their heads; where the hole stands alone,
// they stand below it.

import { MAPS, themed } from './color.js';
import { fitting, label, PALETTES, SMALL } from './layout.js';
import { scaleOf, unitOf } from './units.js';

export const BAR = 20; // pixels that the line is high
const WIDEST = 240;
const LEAST = 60;

/** @param {Ink} ink @param {Look} look @param {number} y its middle */
export function drawColourBar(ink, { view, quantity, wallRect: { left, width } }, y) {
  const palette = PALETTES[view.theme];
  const unit = unitOf(quantity, view.units);
  const ends = quantity.dynamic ? ['mean − 2σ', 'mean + 2σ'] : [quantity.low, quantity.high].map((end) => String(Number((end * scaleOf(quantity, view.units)).toPrecision(3))).replace('-', '−'));
  ink.fillStyle = palette.paper;
  ink.fillRect(left, y - BAR / 2, width, BAR);
  ink.font = SMALL;
  const [low, high] = ends.map((end) => ink.measureText(end).width + 6);
  const name = fitting(ink, [`${quantity.name}${unit ? ` [${unit}]` : ''}${quantity.inView ? ', range in view' : ''}`, quantity.name], width - 14 - low - high - LEAST);
  const start = left + 2 + ink.measureText(name).width + 8 + low;
  const stop = Math.min(start + WIDEST, left + width - 2 - high);
  label(ink, name, left + 2, y, { colour: palette.ink, font: SMALL });
  label(ink, ends[0], start - 6, y, { colour: palette.ink, align: 'right', font: SMALL });
  label(ink, ends[1], stop + 6, y, { colour: palette.ink, font: SMALL });
  const bar = ink.createLinearGradient(start, 0, stop, 0);
  const { anchors } = MAPS[themed(quantity.map, view.theme === 'dark')];
  anchors.forEach((c, i) => bar.addColorStop(i / (anchors.length - 1), `rgb(${c.map(Math.round).join(' ')})`));
  ink.fillStyle = bar;
  ink.fillRect(start, y - 4, stop - start, 8);
}
