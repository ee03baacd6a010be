// The colours of a quantity with their values: in the head of its image, or in one line below the hole if no image is shown.

import { beyondEnds, MAPS, themed } from './color.js';
import { isInside } from './inside.js';
import { fitting, label, PALETTES, SMALL } from './layout.js';
import { scaleOf, unitOf } from './units.js';

export const BAR = 20; // height of the line below the hole, pixels
export const POINT = 7; // length of a pointed end of the colours, pixels
const WIDEST = 240;
const LEAST = 60;

// Draw the colours, 8 pixels high. An end is pointed if values of the section lie beyond it; such values have the colour of this
// end.
/** @param {Ink} ink @param {Look} look @param {number} left @param {number} top @param {number} width @param {boolean} [dark] */
export function drawColours(ink, look, left, top, width, dark = look.view.theme === 'dark') {
  const { view, quantity } = look;
  const colours = ink.createLinearGradient(left, 0, left + width, 0);
  const { anchors } = MAPS[themed(quantity.map, dark)];
  anchors.forEach((c, i) => colours.addColorStop(i / (anchors.length - 1), `rgb(${c.map(Math.round).join(' ')})`));
  const [under, over] = quantity.dynamic ? [false, false] : beyondEnds(look, quantity);
  ink.beginPath();
  ink.moveTo(left, top);
  ink.lineTo(left + width, top);
  if (over) ink.lineTo(left + width + POINT, top + 4);
  ink.lineTo(left + width, top + 8);
  ink.lineTo(left, top + 8);
  if (under) ink.lineTo(left - POINT, top + 4);
  ink.closePath();
  ink.fillStyle = colours;
  ink.fill();
  ink.strokeStyle = PALETTES[view.theme].soft;
  ink.lineWidth = 1;
  ink.stroke();
}

// Return, as text, the value at a share of the colours: 0 at the low end, 1 at the high end.
/** @param {Look} look @param {number} share */
export function valueText({ view, quantity }, share) {
  const { low, high, log, dynamic } = quantity;
  if (dynamic) return { 0: '−2σ', 0.5: 'mean', 1: '+2σ' }[share] ?? '';
  const value = log ? low * (high / low) ** share : low + share * (high - low);
  return String(Number((value * scaleOf(quantity, view.units)).toPrecision(3))).replace('-', '−');
}

/** @param {Ink} ink @param {Look} look @param {number} y its middle */
export function drawColourBar(ink, look, y) {
  const { view, quantity, wallRect: { left, width } } = look;
  const palette = PALETTES[view.theme];
  const unit = unitOf(quantity, view.units);
  const ends = [valueText(look, 0), valueText(look, 1)];
  ink.fillStyle = palette.paper;
  ink.fillRect(left, y - BAR / 2, width, BAR);
  ink.font = SMALL;
  const [low, high] = ends.map((end) => ink.measureText(end).width + POINT + 5);
  const name = fitting(ink, [`${quantity.name}${unit ? ` [${unit}]` : ''}${quantity.inView ? ', range in view' : ''}`, quantity.name], width - 14 - low - high - LEAST);
  const start = left + 2 + ink.measureText(name).width + 8 + low;
  const stop = Math.min(start + WIDEST, left + width - 2 - high);
  label(ink, name, left + 2, y, { colour: palette.ink, font: SMALL });
  label(ink, ends[0], start - POINT - 4, y, { colour: palette.ink, align: 'right', font: SMALL });
  label(ink, ends[1], stop + POINT + 4, y, { colour: palette.ink, font: SMALL });
  drawColours(ink, look, start, y - 4, stop - start, view.theme === 'dark' && !isInside(view)); // inside are the colours of the light page
}
