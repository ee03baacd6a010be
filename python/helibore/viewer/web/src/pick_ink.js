// The ink of a pick that is being made: its points, and its class beside the cursor.

import { BOLD, imageRects, label, PALETTES, yOf } from './layout.js';
import { leftEdge } from './path.js';

// Draw the class of the next pick beside the cursor.
/** @param {Ink} ink @param {Look} look @param {PlaneKind | 'breakout'} kind */
export function drawNext(ink, { view, path, rects }, kind) {
  const { cursor } = view;
  if (!cursor || cursor.toolface === null || cursor.depth < view.top || cursor.depth > view.bottom) return;
  const palette = PALETTES[view.theme];
  const turn = ((((cursor.toolface - leftEdge(path, view.cut, cursor.depth).toolface) % 360) + 360) % 360) / 360;
  for (const { left, width } of imageRects(rects).filter((rect) => rect.width)) {
    const right = turn > 0.5;
    label(ink, kind, left + turn * width + (right ? -8 : 8), yOf(view, rects.image, cursor.depth) - 12, { colour: palette.picks[kind], halo: palette.paper, align: right ? 'right' : 'left', font: BOLD });
  }
}

/** @param {Ink} ink @param {Look} look @param {WallPoint[]} points */
export function drawPoints(ink, look, points) {
  const { view, rects } = look;
  const palette = PALETTES[view.theme];
  for (const { depth, toolface } of points) {
    if (depth < view.top || depth > view.bottom) continue;
    const turn = ((((toolface - leftEdge(look.path, view.cut, depth).toolface) % 360) + 360) % 360) / 360;
    ink.beginPath();
    ink.arc(rects.image.left + turn * rects.image.width, yOf(view, rects.image, depth), 4, 0, 2 * Math.PI);
    ink.fillStyle = palette.paper;
    ink.fill();
    ink.strokeStyle = palette.cursor;
    ink.lineWidth = 2;
    ink.stroke();
  }
}
