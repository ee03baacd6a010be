// Ink on the straightened hole: the bit's outline, zones with their measures, picked planes. It matches the column's
// shader: the left edge of the image at the left, its last quarter in front, the right half cut away.

import { planeDepth } from './dips.js';
import { columnScale } from './gpu.js';
import { BOLD, fitting, HEAD, label, PALETTES, SMALL, within, yOf } from './layout.js';
import { CUTS, leftEdge } from './path.js';
import { hatched, line, OUTSIDE } from './strokes.js';
import { outside } from './tracks.js';
import { showSigned, unitOf } from './units.js';
import { LETTERS } from './zones.js';

/** @param {Ink} ink @param {Look} look */
export function drawColumn(ink, look) {
  const { view, store, wallRect: rect, zones, bitDepth } = look;
  const palette = PALETTES[view.theme];
  const { perMetre, times, shape } = columnScale(look);
  const middle = rect.left + rect.width / 2;
  const bit = store.bitRadius * perMetre;
  const bottom = rect.top + rect.height;
  for (const { from, to } of outside(look, rect)) hatched(ink, middle - bit, from, 2 * bit, to - from, palette, OUTSIDE);
  for (const x of [middle - bit, middle + bit]) line(ink, x, rect.top, x, bottom, palette.ink, [8, 3, 2, 3]);
  if (bitDepth !== null && bitDepth > view.top && bitDepth < view.bottom) bitGlyph(ink, middle, yOf(view, rect, bitDepth), bit, Math.sign(store.levels[0].pitch), palette);
  for (const { kind, start, stop, measure } of zones) {
    const [a, b] = [Math.max(rect.top, yOf(view, rect, start)), Math.min(bottom, yOf(view, rect, stop))];
    if (b <= a) continue;
    ink.fillStyle = palette.zones[kind];
    ink.fillRect(rect.left + rect.width - 7, a, 5, Math.max(2, b - a));
    const y = (a + b) / 2;
    if (y > rect.top + 8 && y < bottom - 8) label(ink, `${LETTERS[kind]} ${showSigned(measure, view.units, view.units === 'mm' ? 0 : 1).split(' ')[0]}`, rect.left + rect.width - 11, y, { colour: palette.ink, halo: palette.paper, align: 'right', font: BOLD, yields: true, margin: 3 });
  }
  ink.strokeStyle = palette.line;
  ink.lineWidth = 1;
  ink.strokeRect(rect.left + 0.5, rect.top + 0.5, rect.width - 1, rect.height - 1);
  if (view.rig) return;
  heads(ink, look, middle, bit, palette);
  const across = `× ${times < 10 ? times.toPrecision(2) : times.toFixed(0)}`;
  /** @param {string} unmeasured @param {string} first @param {string} about @param {string} turns */
  const words = (unmeasured, first, about, turns) => [store.basis === 'gauge' ? unmeasured : '', `${first}${across}`, `shape × ${shape}${about}`, view.median > 1 ? `median ${turns.replace('%', String(view.median))}` : ''].filter(Boolean).join('   ');
  ink.font = SMALL;
  const texts = [words('not measured, drawn at bit size', 'across ', ' about bit', 'of % turns'), words('not measured', 'across ', '', 'of %'), words('not measured', '', '', '%')];
  label(ink, fitting(ink, texts, rect.width - 4), rect.left + 2, bottom + 11, { colour: palette.soft });
  label(ink, unitOf({ length: true }, view.units), rect.left + rect.width - 2, HEAD - 9, { colour: palette.soft, align: 'right', font: SMALL });
}

// The letters of the sides that are seen: in front on the left half, behind on the right one.
/** @param {Ink} ink @param {Look} look @param {number} middle @param {number} bit @param {Palette} palette */
function heads(ink, { view, path }, middle, bit, palette) {
  const { letters } = CUTS[view.cut];
  if (!leftEdge(path, view.cut, view.middle).known) return;
  letters.slice(0, 4).forEach((name, i) => {
    const turn = ((90 * i + view.turn) * Math.PI) / 180;
    const [x, front] = [-Math.cos(turn), -Math.sin(turn)];
    if (x * front < 1e-9) label(ink, name, middle + bit * x + (Math.abs(x) < 0.2 ? -7 * Math.sign(front) : 0), HEAD - 9, { colour: palette.ink, align: 'center', font: BOLD, yields: true });
  });
}

/** @param {Ink} ink @param {number} x @param {number} y @param {number} bit @param {number} down @param {Palette} palette */
function bitGlyph(ink, x, y, bit, down, palette) {
  ink.beginPath();
  for (const [across, along] of [[-1, -0.22], [1, -0.22], [0.7, 0], [-0.7, 0]]) ink.lineTo(x + across * bit, y + along * bit * down);
  ink.closePath();
  ink.fillStyle = palette.ink;
  ink.fill();
}

// The curve of a picked plane on the visible wall: its front in the left half, its back in the right one.
/** @param {Ink} ink @param {Look} look @param {Plane} plane @param {string} colour */
export function columnCurve(ink, look, plane, colour) {
  const { view, path, wallRect: rect } = look;
  const { perMetre } = columnScale(look);
  within(ink, rect, () => {
    for (const from of [270, 90]) {
      ink.beginPath();
      for (let i = 0; i <= 24; i++) {
        const turn = from + (90 * i) / 24;
        const depth = planeDepth(path, plane, leftEdge(path, view.cut, plane.depth).toolface + turn - view.turn);
        ink.lineTo(rect.left + rect.width / 2 - plane.radius * perMetre * Math.cos((turn * Math.PI) / 180), yOf(view, rect, depth));
      }
      ink.strokeStyle = colour;
      ink.lineWidth = 2;
      ink.stroke();
    }
  });
}
