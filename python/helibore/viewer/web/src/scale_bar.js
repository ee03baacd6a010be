// A bar with its length, by which a picture is measured.

import { label, SMALL } from './layout.js';
import { niceStep } from './lod.js';
import { line } from './strokes.js';
import { LENGTHS } from './units.js';

// Draw a bar of at least 40 pixels, with its length above it.
/** @param {Ink} ink @param {number} x @param {number} y @param {number} perMetre @param {View} view @param {Palette} palette */
export function scaleBar(ink, x, y, perMetre, { units }, palette) {
  const { scale, unit } = LENGTHS[units].depth;
  const perUnit = perMetre / scale; // pixels
  const size = niceStep(40 / perUnit);
  for (const [from, to] of [[[x, y], [x + size * perUnit, y]], ...[x, x + size * perUnit].map((end) => [[end, y - 4], [end, y + 4]])]) line(ink, from[0], from[1], to[0], to[1], palette.ink, [], 2);
  label(ink, `${Number(size.toPrecision(2))} ${unit}`, x, y - 12, { colour: palette.ink, halo: palette.paper, font: SMALL });
  ink.canvas.labels.push({ text: '', left: x, right: x + size * perUnit, top: y - 4, bottom: y + 4 });
}
