// Picks on the picture. A plane is a curve on the image, a disc around the hole in 3-D (plane_rings.js), and a tadpole: the head is the
// symbol of its class and stands at the true dip; the tail points to where the plane dips, north up. Without a survey the dip
// is apparent (relative to the hole), and the direction of the tail counts from the tool's zero. A breakout is two boxes on the
// image.

import definition from '../../../base/color_maps.json' with { type: 'json' };
import { columnCurve } from './column.js';
import { anglesInWords, anglesOf, planeDepth, riseOf } from './dips.js';
import { BOLD, fitting, HEAD, inside, label, PALETTES, SMALL, SMALL_BOLD, within, yOf } from './layout.js';
import { leftEdge } from './path.js';
import { edges, line, sharp } from './strokes.js';

const GLOWS = [['#ff00d9', 'new'], ['#00d9ff', 'changed']]; // as in shaders.js
const TAIL = 12; // pixels from the middle of a tadpole's head to the end of its tail, and from the edges of the track to its outer lines
const THIN = 1.3; // pixels of a trace: a fracture is seen beside it
const BESIDE = 10; // pixels from outside to outside of the two lines of the selected pick
/** @type {Record<PlaneKind, number[]>} */
const DASHES = { bed: [], fracture: [8, 4], 'healed fracture': [2, 4], 'induced fracture': [12, 3, 2, 3], fault: [] };

// Return the planes whose curve may be in view, each with its colour and a function that strokes a path as its line.
/** @param {Ink} ink @param {Looks} look @param {Planes} planes @returns {{ plane: Plane, colour: string, stroke: (wide?: number) => void }[]} */
export function linesOf(ink, { view }, { kept, current, selected, open }) {
  const palette = PALETTES[view.theme];
  return (current ? [...kept, current] : kept)
    .filter((plane) => Math.abs(plane.depth - view.middle) <= view.length / 2 + 1.5 * riseOf(plane) + 0.1) // a bent hole lengthens the curve
    .map((plane) => {
      const chosen = plane.pick && plane.pick === selected;
      const colour = plane === current || chosen ? palette.cursor : palette.picks[plane.kind];
      return { plane, colour, stroke: (wide = THIN) => {
        ink.setLineDash(open && plane === current ? [5, 4] : chosen ? [] : DASHES[plane.kind]);
        outlined(ink, colour, palette, chosen ? BESIDE : wide);
        ink.setLineDash([]);
        if (!chosen) return;
        ink.globalCompositeOperation = 'destination-out'; // two lines: between them is seen what they mark
        ink.lineWidth = BESIDE - 3;
        ink.stroke();
        ink.globalCompositeOperation = 'source-over';
      } };
    });
}

// Draw the picks; the angles of a plane stand at the right end of its curve on the first image.
/** @param {Ink} ink @param {Looks} look @param {Planes} planes @param {boolean} straight */
export function drawDips(ink, look, planes, straight) {
  const { view, path, rects: { image } } = look;
  const palette = PALETTES[view.theme];
  const lines = linesOf(ink, look, planes);
  for (const { plane, stroke } of lines) {
    for (const one of look.images) curve(ink, one, plane, stroke);
    if (straight) columnCurve(ink, look, plane, stroke);
  }
  for (const { plane, colour } of view.rig ? [] : lines) {
    ink.font = SMALL_BOLD;
    const text = fitting(ink, [anglesOf(plane, path), anglesOf(plane, path, false), anglesOf({ ...plane, pick: undefined }, path)], image.width - 8);
    const right = plane.curve?.depths.slice(-Math.ceil(ink.measureText(text).width / 3) - 2) ?? []; // points of the curve, 3 pixels apart, above or below which the angles stand
    const [upper, lower] = [Math.min, Math.max].map((end) => yOf(view, image, end(...right)));
    const x = image.left + image.width - 4;
    if (inside(image, x, upper - 14) && !text.endsWith('…')) label(ink, text, x, upper - 9, { colour, halo: palette.paper, align: 'right', font: SMALL_BOLD, near: [[0, 0], [0, lower - upper + 20]], yields: true });
  }
  for (const pick of planes.boxes) for (const one of look.images) box(ink, one, pick, pick === planes.selected ? palette.cursor : palette.picks[pick.kind], palette);
  if (look.rects.dips) dipTrack(ink, look, look.rects.dips, palette);
}

// The legend below the tracks: symbol, colour and name of each class of pick in view, as many as there is room for. Before the
// first pick, the first of the texts `start` that has room says how to pick. While the wall grows, the meaning of the glowing
// colours comes first.
/** @param {Ink} ink @param {Look} look @param {Planes} planes @param {string[]} start */
export function drawLegend(ink, { view, path, growing, rects: { axis, image, pane } }, { kept, boxes }, start) {
  if (view.rig) return;
  const y = axis.top + axis.height + 10;
  const colours = image.width ? [] : ink.canvas.labels.filter(({ top, bottom }) => top < y && bottom > y).map(({ right }) => right); // below the hole
  const [from, end] = image.width ? [axis.left, pane.left] : [Math.max(pane.left, ...colours) + 14, pane.left + pane.width];
  const palette = PALETTES[view.theme];
  const shown = new Set([...kept, ...boxes].filter(({ depth }) => depth >= view.top && depth <= view.bottom).map(({ kind }) => kind));
  let [x, words] = [from + 8, ''];
  ink.font = SMALL;
  const glows = growing && x + 120 < end ? GLOWS : [];
  for (const [colour, name] of glows) {
    ink.fillStyle = colour;
    ink.fillRect(x - 4, y - 4, 9, 8);
    label(ink, name, x + 9, y, { colour: palette.ink, font: SMALL });
    x += 25 + ink.measureText(name).width;
  }
  const first = kept.length + boxes.length ? undefined : start.find((text) => x + ink.measureText(text).width < end);
  if (first) label(ink, first, x, y, { colour: palette.soft });
  for (const kind of /** @type {(keyof Palette['picks'])[]} */ (Object.keys(palette.picks))) {
    if (!shown.has(kind)) continue;
    const right = x + 9 + ink.measureText(kind).width;
    if (right > end) return;
    if (kind === 'breakout') {
      ink.strokeStyle = palette.picks[kind];
      ink.lineWidth = 2;
      ink.strokeRect(x - 4, y - 4, 8, 8);
    } else {
      symbol(ink, x, y, kind, palette.picks[kind], palette.panel);
      words = anglesInWords(path, kept);
    }
    label(ink, kind, x + 9, y, { colour: palette.ink, font: SMALL });
    x = right + 16;
  }
  if (image.width && words && x + ink.measureText(words).width < end) label(ink, words, x - 4, y, { colour: palette.soft, font: SMALL });
}

/** @param {Ink} ink @param {Look} look @param {Plane} plane @param {() => void} stroke */
function curve(ink, { view, path, rects }, plane, stroke) {
  const { image } = rects;
  const key = `${path.version}/${view.cut}/${image.width}`;
  if (plane.curve?.key !== key) { // a frame that only moves computes no curve anew
    let { depth } = plane;
    plane.curve = { key, depths: [] };
    for (let x = 0; x <= image.width; x += 3) {
      for (let i = 0; i < 3; i++) depth = planeDepth(path, plane, leftEdge(path, view.cut, depth).toolface + (360 * x) / image.width);
      plane.curve.depths.push(depth);
    }
  }
  const { depths } = plane.curve;
  within(ink, image, () => {
    ink.beginPath();
    depths.forEach((depth, i) => ink.lineTo(image.left + 3 * i, yOf(view, image, depth)));
    stroke();
  });
}

// Stroke a path so that it is seen on any colour.
/** @param {Ink} ink @param {string} colour @param {Palette} palette @param {number} [wide] */
export function outlined(ink, colour, palette, wide = 2) {
  ink.lineWidth = wide + 1.6;
  ink.strokeStyle = `${palette.paper}a0`;
  ink.stroke();
  ink.lineWidth = wide;
  ink.strokeStyle = colour;
  ink.stroke();
}

// Draw both sides of a breakout; a side that crosses an edge of the image is drawn at both edges.
/** @param {Ink} ink @param {Look} look @param {BreakoutPick} pick @param {string} colour @param {Palette} palette */
function box(ink, { view, path, rects: { image } }, pick, colour, palette) {
  const radius = pick.radius ?? 0.1;
  const left = leftEdge(path, view.cut, pick.depth).toolface;
  /** @param {number} degrees */
  const x = (degrees) => image.left + (degrees / 360) * image.width;
  const lean = (Math.tan(((pick.tilt ?? 0) * Math.PI) / 180) * pick.height * 90) / Math.PI / radius;
  const middle = (((pick.toolface - left) % 360) + 360) % 360;
  const [top, bottom] = [-1, 1].map((side) => yOf(view, image, pick.depth + (side * pick.height) / 2));
  within(ink, image, () => {
    for (const turn of [-360, -180, 0, 180, 360]) {
      const [a, b] = [-1, 1].map((side) => middle + turn + (side * pick.opening) / 2);
      ink.beginPath();
      for (const [degrees, y] of [[a - lean, top], [b - lean, top], [b + lean, bottom], [a + lean, bottom]]) ink.lineTo(x(degrees), y);
      ink.closePath();
      outlined(ink, colour, palette);
    }
  });
}

const { dips } = definition;
/** @param {Rect} rect @param {number} degrees */
const dipAt = ({ left, width }, degrees) => left + TAIL + (degrees / dips.lines[dips.lines.length - 1]) * (width - 2 * TAIL);

/** @param {Ink} ink @param {Look} look @param {Rect} rect @param {Palette} palette */
function dipTrack(ink, { path }, rect, palette) {
  const { left, top, width, height } = rect;
  ink.fillStyle = palette.panel;
  ink.fillRect(left, top, width, height);
  for (const degrees of dips.lines) line(ink, dipAt(rect, degrees), top, dipAt(rect, degrees), top + height, palette.grid);
  edges(ink, sharp(rect), palette.line);
  const title = (path.surveyed ? dips.true : dips.apparent).split(/ (?=dip)/); // in two lines: the track is narrow
  title.forEach((words, i) => label(ink, words, left + 2, 11 + 16 * i, { colour: palette.ink, font: BOLD }));
  for (const degrees of dips.lines) if (width > 75 || degrees % 90 === 0) label(ink, String(degrees), dipAt(rect, degrees), HEAD - 9, { colour: palette.soft, align: 'center', font: SMALL, yields: true, margin: 2 });
}

/** @param {Ink} ink @param {Look} look @param {Rect} rect @param {Planes} planes */
export function tadpoles(ink, { view, path }, rect, { kept, current, selected }) {
  const palette = PALETTES[view.theme];
  within(ink, rect, () => {
    for (const plane of current ? [...kept, current] : kept) {
      const [angle, towards] = path.surveyed ? [plane.dip, plane.azimuth] : [plane.apparent, plane.deepest];
      const colour = plane === current || plane.pick === selected ? palette.cursor : palette.picks[plane.kind];
      tadpole(ink, dipAt(rect, angle), yOf(view, rect, plane.depth), towards, plane.kind, colour, palette);
    }
  });
}

/** @param {Ink} ink @param {number} x @param {number} y @param {number} towards @param {PlaneKind} kind @param {string} colour @param {Palette} palette */
function tadpole(ink, x, y, towards, kind, colour, palette) {
  ink.strokeStyle = colour;
  ink.lineWidth = 2;
  if (Number.isFinite(towards)) {
    const [dx, dy] = [Math.sin((towards * Math.PI) / 180), -Math.cos((towards * Math.PI) / 180)];
    ink.beginPath();
    ink.moveTo(x, y);
    ink.lineTo(x + TAIL * dx, y + TAIL * dy);
    ink.stroke();
  }
  symbol(ink, x, y, kind, colour, palette.panel);
}

// Draw the symbol of a class: circle, squares, diamond, triangle; open symbols are filled with the colour of the ground.
/** @param {Ink} ink @param {number} x @param {number} y @param {PlaneKind} kind @param {string} colour @param {string} ground */
export function symbol(ink, x, y, kind, colour, ground) {
  const corners = kind === 'fault' ? 3 : kind === 'bed' ? 24 : 4;
  const from = kind === 'fault' || kind === 'induced fracture' ? 0 : Math.PI / corners;
  ink.beginPath();
  for (let i = 0; i < corners; i++) {
    const angle = from + (2 * Math.PI * i) / corners;
    ink.lineTo(x + 5 * Math.sin(angle), y - 5 * Math.cos(angle));
  }
  ink.closePath();
  ink.fillStyle = kind === 'fracture' || kind === 'induced fracture' ? ground : colour;
  ink.fill();
  ink.strokeStyle = colour;
  ink.lineWidth = 1.6;
  ink.stroke();
}
