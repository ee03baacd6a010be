// Tracks of named intervals: casings to scale with their shoes, and the columns of a mud log as text. Casings are in the
// straightened hole, on its path and inside it, too.

import { wallPoint } from './dips.js';
import { columnScale } from './gpu.js';
import { BOLD, fitting, label, PALETTES, SMALL, SMALL_BOLD, within, yOf } from './layout.js';
import { drawRock, rockColour, rockOf } from './rocks.js';
import { edges, line, sharp } from './strokes.js';
import { depthNumber, LENGTHS, showDepth, showLength, showSpan } from './units.js';

const LINE = 13; // pixels
const ROOM = 1.3; // half a track of casings, in outer radii of the widest
const STEEL = 3; // pixels of the wall of a casing

/** @param {number} diameter @param {Units} units */
const sizeText = (diameter, units) => showLength(diameter, units, units === 'mm' ? 0 : 3);
/** @param {NamedInterval} of @returns {[number, number]} */
const ends = ([, start, stop]) => [start, stop ?? Infinity];
/** @type {(of: NamedInterval, top: number, bottom: number) => boolean} */
const reaches = (of, top, bottom) => ends(of)[0] < bottom && ends(of)[1] > top;

// Return the casings that reach into the measured hole.
/** @param {Store} store */
export const casingsIn = ({ placed, span: [top, bottom] }) => placed.filter((one) => one[4] && reaches(one, top, bottom));
/** @param {NamedInterval} of @param {Units} units */
export const shoeInWords = ([name, , , , diameter = 0], units) => `shoe ${name}, ${sizeText(diameter, units)}`;

/** @type {Map<string, string[]>} */
const wrapped = new Map();

// Return a text in lines that are at most `width` pixels wide, broken at its gaps.
/** @param {Ink} ink @param {string} text @param {number} width @param {string} [gap] */
export function inLines(ink, text, width, gap = ' ') {
  const key = `${width} ${ink.font} ${text}`;
  let lines = wrapped.get(key);
  if (lines) return lines;
  lines = [];
  for (const word of text.split(gap === ' ' ? /\s+/ : gap)) {
    const longer = [...lines.slice(-1), word].join(gap);
    if (lines.length && ink.measureText(longer).width <= width) lines[lines.length - 1] = longer;
    else lines.push(word);
  }
  if (wrapped.size > 4000) wrapped.clear();
  wrapped.set(key, lines);
  return lines;
}

// Return in words how many intervals lie outside the wall.
/** @param {NamedInterval[]} all @param {Store} store @param {Units} units */
function outsideText(all, { span: [top, bottom] }, units) {
  const outside = all.filter((one) => !reaches(one, top, bottom)).length;
  if (!outside) return [];
  return outside < all.length ? [`${outside} of ${all.length} outside the wall`, `${outside} outside`] : [`none of ${all.length} within ${showSpan(top, bottom, units)}: is the unit right?`];
}

/** @param {Ink} ink @param {Look} look */
export function drawColumns(ink, look) {
  const { view, store, rects } = look;
  const palette = PALETTES[view.theme];
  store.columns.forEach((name, i) => {
    const rect = rects[`column${i}`];
    if (!rect?.width) return;
    const all = store.placed.filter(([, , , track]) => track === name);
    const pipes = all.filter(([, , , , diameter]) => diameter);
    ink.fillStyle = palette.panel;
    ink.fillRect(rect.left, rect.top, rect.width, rect.height);
    ink.font = BOLD;
    const unit = LENGTHS[view.units].unit;
    label(ink, fitting(ink, pipes.length ? [`${name} [${unit}]`, name] : [name], rect.width - 2), rect.left + rect.width / 2, 11, { colour: palette.ink, align: 'center', font: BOLD });
    ink.font = SMALL;
    const outside = outsideText(all, store, view.units);
    const said = outside.find((text) => ink.measureText(text).width < rect.width) ?? outside[0] ?? '';
    inLines(ink, said, rect.width - 2).slice(0, 4).forEach((text, row) => label(ink, text, rect.left + 1, 27 + LINE * row, { colour: outside.length > 1 ? palette.soft : palette.ink, font: SMALL }));
    within(ink, rect, () => {
      for (const one of all) if (!one[4] && reaches(one, view.top, view.bottom)) cell(ink, look, rect, one, palette);
      casings(ink, look, rect, pipes.filter((one) => reaches(one, store.span[0], store.span[1])), palette);
    });
    edges(ink, sharp(rect), palette.line);
  });
}

// Write a text from the top of its interval down, as much of it as has room.
/** @param {Ink} ink @param {Look} look @param {Rect} rect @param {NamedInterval} interval @param {Palette} palette */
function cell(ink, { view }, rect, interval, palette) {
  const [a, b] = ends(interval).map((depth) => Math.round(yOf(view, rect, depth)));
  const [top, bottom] = [Math.max(a, rect.top), Math.min(b, rect.top + rect.height)];
  const rock = rockOf(interval[3] ?? '', interval[0]);
  if (rock) drawRock(ink, rock, { ...rect, top, height: bottom - top }, a, palette, view.theme);
  if (a > rect.top) line(ink, rect.left, a + 0.5, rect.left + rect.width, a + 0.5, palette.line);
  if (b < rect.top + rect.height) line(ink, rect.left, b + 0.5, rect.left + rect.width, b + 0.5, palette.line);
  const most = Math.floor((bottom - top - 2) / LINE);
  if (most < 1) return;
  ink.font = SMALL;
  const width = rect.width - 8;
  const lines = inLines(ink, interval[0], width);
  if (rock) { // no stroke of the pattern behind the words
    const wide = Math.max(...lines.slice(0, most).map((text) => ink.measureText(text).width));
    ink.fillStyle = rockColour(rock, view.theme);
    ink.fillRect(rect.left + 1, top + 1, Math.min(width, wide) + 7, LINE * Math.min(most, lines.length) + 2);
  }
  lines.slice(0, most).forEach((text, i) => {
    const shown = i === most - 1 && lines.length > most ? `${lines.slice(i).join(' ')}…` : text;
    label(ink, fitting(ink, [shown], width), rect.left + 4, top + 8 + LINE * i, { colour: palette.ink, font: SMALL });
  });
}

// Draw casings to scale, the widest first; a triangle at each side is the shoe, with name and size below it.
/** @param {Ink} ink @param {Look} look @param {Rect} rect @param {NamedInterval[]} pipes @param {Palette} palette */
function casings(ink, { view }, rect, pipes, palette) {
  const shown = pipes.filter((one) => reaches(one, view.top, view.bottom)).sort((a, b) => (b[4] ?? 0) - (a[4] ?? 0));
  const middle = rect.left + rect.width / 2;
  const scale = rect.width / (ROOM * Math.max(...pipes.map(([, , , , diameter]) => diameter ?? 0)));
  const bottom = rect.top + rect.height;
  for (const one of shown) pipe(ink, one, middle, ((one[4] ?? 0) / 2) * scale, (depth) => yOf(view, rect, depth), [rect.top, bottom], palette);
  for (const [name, start, stop, , diameter = 0] of shown) {
    const [a, b] = [Math.max(rect.top, yOf(view, rect, start)), Math.min(bottom, yOf(view, rect, stop ?? Infinity))];
    const y = b < bottom - 2 * LINE ? b + 9 : (a + b) / 2;
    ink.font = SMALL_BOLD;
    const lines = inLines(ink, name, rect.width - 4).slice(0, 2);
    /** @type {Pair[]} */
    const near = [0, 1, 2, 3, 4].map((row) => [0, (lines.length + 1) * LINE * row]);
    lines.forEach((text, row) => label(ink, fitting(ink, [text], rect.width - 4), middle, y + LINE * row, { colour: palette.ink, halo: palette.panel, align: 'center', font: SMALL_BOLD, near, yields: true }));
    label(ink, sizeText(diameter, view.units).split(' ')[0], middle, y + LINE * lines.length, { colour: palette.soft, halo: palette.panel, align: 'center', font: SMALL, near, yields: true });
  }
}

// Draw both walls of a pipe and its shoe between two heights.
/** @param {Ink} ink @param {NamedInterval} of @param {number} middle @param {number} half @param {(depth: number) => number} y @param {number[]} room @param {Palette} palette */
export function pipe(ink, of, middle, half, y, [top, bottom], palette) {
  const [start, stop] = ends(of);
  const [a, b] = [Math.max(top, y(start)), Math.min(bottom, y(stop))];
  if (b <= a) return;
  for (const side of [-1, 1]) {
    const x = middle + side * half;
    line(ink, x, a, x, b, palette.soft, [], STEEL);
    if (y(stop) > bottom) continue;
    ink.fillStyle = palette.ink;
    ink.beginPath();
    for (const [dx, dy] of [[0, -9], [0, 0], [side * 8, 0]]) ink.lineTo(x + dx, b + dy);
    ink.fill();
  }
}

// Draw the casings of the section in the hole.
/** @param {Ink} ink @param {Look} look @param {Gpu} gpu */
export const drawPipes = (ink, look, gpu) => (look.view.camera === 'straight' ? straightPipes(ink, look) : drawShoes(ink, look, gpu));

// Draw the casings of the section in the straightened hole, exaggerated as the hole is.
/** @param {Ink} ink @param {Look} look */
function straightPipes(ink, look) {
  const { view, store, wallRect: rect } = look;
  const palette = PALETTES[view.theme];
  const { perMetre, shape } = columnScale(look);
  const middle = rect.left + rect.width / 2;
  within(ink, rect, () => {
    for (const one of store.placed) {
      if (!one[4] || !reaches(one, view.top, view.bottom)) continue;
      const half = Math.max(2, (store.bitRadius + (one[4] / 2 - store.bitRadius) * shape) * perMetre);
      pipe(ink, one, middle, half, (depth) => yOf(view, rect, depth), [rect.top, rect.top + rect.height], palette);
      const shoe = yOf(view, rect, ends(one)[1]);
      const words = `shoe ${one[0]}`;
      ink.font = SMALL_BOLD;
      if (shoe < rect.top + rect.height && !view.rig) label(ink, fitting(ink, [`${words}, ${depthNumber(ends(one)[1], view.units, 1)}`, words], rect.width - 12), rect.left + 6, shoe + 9, { colour: palette.ink, halo: palette.paper, font: SMALL_BOLD, yields: true });
    }
  });
}

// Draw the casings of the section along the path: both edges, and a ring at the shoe with its name. From inside the hole only the
// ring is seen.
/** @param {Ink} ink @param {Look} look @param {Gpu} gpu */
function drawShoes(ink, look, gpu) {
  const { view, store, path, rects: { wall: rect } } = look;
  const palette = PALETTES[view.theme];
  const tube = view.tubeFactor(store);
  for (const one of store.placed) {
    if (!one[4] || !reaches(one, view.top, view.bottom)) continue;
    const radius = (store.bitRadius + (one[4] / 2 - store.bitRadius) * (view.shape || 1)) * tube;
    const [start, stop] = ends(one);
    const [a, b] = [Math.max(start, view.top), Math.min(stop, view.bottom)];
    if (view.camera === 'outside') {
      for (const side of [-1, 1]) {
        stroke(ink, Array.from({ length: 25 }, (_, i) => path.at(a + ((b - a) * i) / 24)).map((frame) => gpu.project(frame, rect, gpu.aside(frame, side * radius))), palette.soft, STEEL);
      }
    }
    if (stop > view.bottom) continue;
    const ring = Array.from({ length: 49 }, (_, i) => gpu.project({ centre: wallPoint(path, { depth: stop, toolface: 7.5 * i, radius }) }, rect));
    stroke(ink, ring, palette.ink, 3);
    const axis = view.camera === 'outside' ? 0 : 1; // the name stands at the right of the ring or, from inside, below it
    const at = ring.reduce((far, point) => (point && (!far || point[axis] > far[axis]) ? point : far), null);
    const text = shoeInWords(one, view.units);
    ink.font = SMALL_BOLD;
    if (axis && at && at[1] < rect.top + rect.height - 4 * LINE) label(ink, text, at[0], at[1] + LINE, { colour: palette.ink, halo: palette.paper, font: SMALL_BOLD, align: 'center', near: [[0, 0], [0, LINE], [0, 2 * LINE]], yields: true });
    else if (!axis && at) label(ink, text, Math.min(at[0] + 8, rect.left + rect.width - ink.measureText(text).width - 4), at[1], { colour: palette.ink, halo: palette.paper, font: SMALL_BOLD, near: [0, 1, -1, 2, -2].map((row) => [0, LINE * row]), yields: true });
  }
}

/** @param {Ink} ink @param {(Pair | number[] | null)[]} points @param {string} colour @param {number} width */
function stroke(ink, points, colour, width) {
  ink.beginPath();
  for (const point of points) if (point) ink.lineTo(point[0], point[1]);
  ink.strokeStyle = colour;
  ink.lineWidth = width;
  ink.stroke();
}

// Return what the tracks hold at a depth: the text, or the narrowest casing with its shoe.
/** @param {Look} look @param {number} depth */
export function columnRows({ store, view, rects }, depth) {
  return store.columns.flatMap((name, i) => {
    const here = store.placed.filter((one) => one[3] === name && ends(one)[0] <= depth && depth < ends(one)[1]);
    if (!here.length || !rects[`column${i}`]?.width) return [];
    const narrowest = here.reduce((least, one) => ((one[4] ?? Infinity) < (least[4] ?? Infinity) ? one : least));
    const [text, , stop, , diameter] = narrowest;
    return [[name, diameter ? `${text}, ${sizeText(diameter, view.units)}${stop === null ? '' : `, shoe at ${showDepth(stop, view.units, 1)}`}` : here.map(([words]) => words).join('; ')]];
  });
}

