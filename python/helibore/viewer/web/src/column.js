// Ink on the straightened hole: the bit's outline, zones with their measures, picked planes. It matches the column's
// shader: the left edge of the image is at the left, the last quarter of the image in front; the right half is cut away.

import { BAR, drawColourBar } from './color_bar.js';
import { planeDepth } from './dips.js';
import { columnScale } from './gpu.js';
import { BOLD, fitting, HEAD, label, laneOf, PALETTES, SMALL, within, yOf } from './layout.js';
import { byId } from './dom.js';
import { CUTS, leftEdge } from './path.js';
import { drawString } from './string.js';
import { edges, hatched, line, OUTSIDE, sharp } from './strokes.js';
import { outside } from './tracks.js';
import { showSigned, unitOf } from './units.js';
import { bySeverity, FRONT, LETTERS, mark } from './zones.js';

/** @param {Ink} ink @param {Look} look */
export function drawColumn(ink, look) {
  const { view, store, wallRect: rect, rects, zones, bitDepth, oldBit } = look;
  const palette = PALETTES[view.theme];
  const { perMetre, times, shape } = columnScale(look);
  const middle = rect.left + rect.width / 2;
  const bit = store.bitRadius * perMetre;
  const bottom = rect.top + rect.height;
  const right = rect.left + rect.width + laneOf(store.basis !== 'gauge', view.rig);
  for (const { from, to } of outside(look, rect)) hatched(ink, middle - bit, from, 2 * bit, to - from, palette, OUTSIDE);
  for (const x of [middle - bit, middle + bit]) line(ink, x, rect.top, x, bottom, palette.ink, DASHES);
  if (bitDepth !== null && !oldBit && bitDepth > view.top && bitDepth < view.bottom) bitGlyph(ink, middle, yOf(view, rect, bitDepth), bit, Math.sign(store.levels[0].pitch), palette);
  const cursor = view.cursor ? yOf(view, rect, view.cursor.depth) : NaN;
  for (const zone of bySeverity(zones)) { // where sizes have no room, the worst has its own
    const { kind, start, stop, measure } = zone;
    const [a, b] = [Math.max(rect.top, yOf(view, rect, start)), Math.min(bottom, yOf(view, rect, stop))];
    if (b <= a) continue;
    mark(ink, zone, right - 7, a, 5, Math.max(2, b - a), palette);
    const middleY = (a + b) / 2;
    const y = Math.abs(middleY - cursor) < 9 ? cursor - 10 : middleY; // a jump puts the cursor's line there
    if (!view.rig && y > rect.top + 8 && y < bottom - 8) label(ink, `${LETTERS[kind]} ${showSigned(measure, view.units, view.units === 'mm' ? 0 : 1).split(' ')[0]}`, right - 11, y, { colour: palette.ink, halo: palette.paper, align: 'right', font: BOLD, yields: true, margin: 3 });
  }
  drawString(ink, look);
  edges(ink, sharp({ ...rect, width: right - rect.left }), palette.line);
  if (view.rig) return;
  heads(ink, look, middle, bit, palette);
  const y = HEAD - 9;
  const clear = middle - bit > rect.left + 68; // room for words at the left of the letters
  if (clear) {
    line(ink, rect.left + 2, y, rect.left + 23, y, palette.ink, DASHES);
    label(ink, 'bit', rect.left + 28, y, { colour: palette.soft, font: SMALL });
  }
  const unit = unitOf({ length: true }, view.units);
  if (zones.length) label(ink, clear ? `zones, ${unit}` : unit, right - 2, y, { colour: palette.soft, align: 'right', font: SMALL });
  const across = `× ${times < 10 ? times.toPrecision(2) : times.toFixed(0)}`;
  /** @param {string} about @param {string} turns */
  const factors = (about, turns) => [across, store.basis === 'gauge' ? '' : `shape × ${shape}${about}`, view.median > 1 ? `median ${turns.replace('%', String(view.median))}` : ''].filter(Boolean).join(', ');
  const made = store.basis === 'gauge' ? ['not measured, drawn at bit size, across ', 'not measured, across ', 'not measured, '] : ['across ', 'across ', ''];
  const seen = `seen from ${facing(look)}`;
  const scales = [made[0] + factors(' about bit', 'of % turns'), made[1] + factors('', 'of %'), made[2] + factors('', '%')];
  const name = ['Hole, straightened', 'Hole'];
  const ways = [[name, [`${seen}, right half cut away`], scales], [name, [seen], ['right half cut away'], scales], [name, ['right half cut away', 'right half cut'], scales]];
  const rows = headRows({ ...rect, width: right - rect.left });
  /** @type {ReturnType<typeof inRows>} */
  let written = [];
  for (const lines of ways) if (!written.length || !written.every(Boolean)) written = inRows(ink, [...rows], lines);
  written.forEach((one, i) => one && label(ink, one.text, rect.left + 2, one.y, i ? { colour: palette.soft, font: SMALL } : { colour: palette.ink, font: BOLD }));
  ink.font = SMALL;
  if (!written.some((one) => one?.text.includes('cut away'))) { // beside the key of the bit, where the controls leave no row
    const from = rect.left + (clear ? 52 : 2);
    const room = right - from - (zones.length ? 66 : 8);
    const text = [`${seen}, right half cut away`, 'right half cut away'].find((one) => ink.measureText(one).width <= room);
    if (text) label(ink, text, from, y, { colour: palette.soft, font: SMALL, yields: true });
  }
  if (!rects.image.width) drawColourBar(ink, look, bottom + BAR / 2);
  else if (!written[written.length - 1]) label(ink, fitting(ink, scales, right - rect.left - 4), rect.left + 2, bottom + 11, { colour: palette.soft });
}

const DASHES = [8, 3, 2, 3]; // of the lines at bit radius
const ROWS = [11, 27, 42, 57]; // y of the rows of words in the head, above the letters

// Return the rows beside and below the controls of the hole, with their widths.
/** @param {Rect} rect */
function headRows(rect) {
  const controls = byId('wallHead');
  const shown = /** @type {HTMLElement[]} */ ([...controls.children]).filter((one) => one.offsetWidth).map(({ offsetTop: top, offsetHeight: tall, offsetLeft: left }) => ({ top, bottom: top + tall, left }));
  return ROWS.map((y) => ({ y, room: Math.min(rect.width + 6, ...shown.filter(({ top, bottom }) => y + 7 > top && y - 7 < bottom).map(({ left }) => left)) - 10 }));
}

// Place lines of words in rows. Each line has several texts: the first one that fits, and leaves rows for the later lines, is
// taken. The result is null for a line without room.
/** @param {Ink} ink @param {ReturnType<typeof headRows>} rows @param {string[][]} lines */
function inRows(ink, rows, lines) {
  return lines.map((texts, i) => {
    ink.font = i ? SMALL : BOLD;
    for (const text of texts) {
      const { width } = ink.measureText(text);
      const at = rows.findIndex(({ room }, row) => width <= room && rows.length - row >= lines.length - i);
      if (at >= 0) return { text, y: rows.splice(0, at + 1)[at].y };
    }
    return null;
  });
}

// Return the name of the side of the hole that is in front.
/** @param {Look} look */
function facing({ view, path }) {
  const { letters, offset } = CUTS[view.cut];
  const quarter = ((((FRONT - view.turn) % 360) + 360) % 360) / 90; // from the left edge
  if (!leftEdge(path, view.cut, view.middle).known) return `toolface ${Math.round(90 * quarter + offset) % 360}°`;
  const sides = Math.abs(quarter - Math.round(quarter)) < 0.2 ? letters[Math.round(quarter)] : `${letters[Math.floor(quarter)]}–${letters[Math.ceil(quarter)]}`;
  return sides + (path.assumed ? ' (assumed)' : '');
}

// Draw the letters of the visible sides: the left half of the picture shows the front of the hole, the right half its back.
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
  ink.strokeStyle = palette.ink;
  ink.lineWidth = 2;
  ink.stroke(); // an outline only: the newest wall stays visible
}

// Draw the curve of a picked plane on the visible wall: the front of the hole is in the left half, its back in the right half.
/** @param {Ink} ink @param {Look} look @param {Plane} plane @param {() => void} stroke */
export function columnCurve(ink, look, plane, stroke) {
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
      stroke();
    }
  });
}
