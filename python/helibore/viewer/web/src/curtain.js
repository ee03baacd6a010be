// The curtain: from a line on, another image lies over the first one: the image beside it, or the other pass.

import { BOLD, fitting, label, PALETTES } from './layout.js';
import { line } from './strokes.js';

/** @type {Record<Pass, string>} */
const PASSES = { first: 'first pass', latest: 'latest pass', change: 'change' };

/** @param {Ink} ink @param {Look} look @param {Curtain} curtain */
export function drawCurtain(ink, { view, quantity, rects: { image } }, curtain) {
  const palette = PALETTES[view.theme];
  const x = Math.round(image.left + curtain.from * image.width) + 0.5;
  line(ink, x, image.top, x, image.top + image.height, palette.panel, [], 4);
  line(ink, x, image.top, x, image.top + image.height, palette.cursor, [], 2);
  const passes = curtain.quantity === quantity;
  const names = passes ? [PASSES[view.pass], PASSES[curtain.view.pass]] : [quantity.name, curtain.quantity.name];
  ink.font = BOLD;
  names.forEach((name, right) => {
    const text = fitting(ink, [right ? `${name} ▸` : `◂ ${name}`], image.width - 8);
    const width = ink.measureText(text).width;
    const left = Math.min(Math.max(x + (right ? 6 : -6 - width), image.left + 4), image.left + image.width - 4 - width);
    label(ink, text, left, image.top + image.height - 24 + 15 * right, { colour: palette.ink, halo: palette.paper, font: BOLD, yields: true });
  });
}
