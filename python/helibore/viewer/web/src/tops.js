// Named intervals of the hole, such as formations: a line across all tracks at each end, and the name under each top.

import { fitting, label, PALETTES, SMALL_BOLD, tracksEnd, yOf } from './layout.js';
import { line } from './strokes.js';

// Return the name of the interval at a depth; of several, that which begins deepest.
/** @param {NamedInterval[]} intervals @param {number} depth */
export const intervalAt = (intervals, depth) => intervals.findLast(([, start, stop]) => start <= depth && depth < (stop ?? Infinity))?.[0];

/** @param {Ink} ink @param {Look} look */
export function drawTops(ink, { view, rects, intervals }) {
  const { axis, image } = rects;
  const bottom = axis.top + axis.height;
  const palette = PALETTES[view.theme];
  /** @param {number | null} depth */
  const y = (depth) => (depth === null ? Infinity : Math.round(yOf(view, axis, depth)) + 0.5);
  for (const end of new Set(intervals.flatMap(([, start, stop]) => [y(start), y(stop)]))) {
    if (end > axis.top && end < bottom) line(ink, axis.left + axis.width, end, tracksEnd(rects), end, palette.top);
  }
  ink.font = SMALL_BOLD;
  for (const [name, start, stop] of intervals) {
    const top = Math.max(axis.top, y(start));
    if (image.width && Math.min(bottom, y(stop)) - top > 15) label(ink, fitting(ink, [name], image.width - 10), image.left + 5, top + 9, { colour: palette.top, halo: palette.paper, font: SMALL_BOLD, yields: true });
  }
}
