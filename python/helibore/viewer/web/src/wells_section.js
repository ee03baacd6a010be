// Several wells side by side, as in a correlation: each with depths, image and caliper; a bed that two neighbours have is a band
// between them. Depths are measured depths, true depths, or count from a top, which then stands at one height in all wells.

import { drawCaliper, linesOf, profile, scaleFor } from './caliper.js';
import { casingsIn, inLines, pipe, shoeInWords } from './columns.js';
import { drawDips, drawLegend, tadpoles } from './dip_ink.js';
import { BOLD, depthAt, DIPS, fitting, HEAD, inkOn, label, PALETTES, SMALL, SMALL_BOLD, tracksEnd } from './layout.js';
import { edges, line, sharp } from './strokes.js';
import { intervalAt } from './tops.js';
import { drawAxis, drawAxisLabels, drawImageHead, drawOutside } from './tracks.js';
import { LENGTHS, showDepth, showLength, showQuantity } from './units.js';
import { minus } from './vectors.js';
import { joined } from './wells_scene.js';
import { LETTERS, STRIP } from './zones.js';

const NAME = 24; // pixels above the heads, for the names of the wells
const AXIS = 76;
const SLIM = 600; // pixels of a picture in which axes and gaps are narrow, so that images are wide enough to be read
const FOOT = 22; // for the key
const SHORTEST = 0.5; // metres
const SLICE = 16; // pixels of an image between two true depths that are drawn at one scale
const STEPS = 400; // of a table of true depths along a well
export const TRUE = '~tvd'; // the datum of true depths, which no top is called

/** @typedef {{ well: import('./well.js').Well, rects: Rects, datum: number, bent?: Bend }} Column */

export class Section {
  top = 0;
  length = 100;
  fitted = false;
  seen = Infinity; // wells that it was fitted to
  /** @type {Column[]} */
  columns = [];

  /** @param {import('./wells.js').Wells} wells */
  constructor(wells) {
    this.wells = wells;
  }

  // Whether depths here are true depths: where they are asked for, and from a top if all wells have them.
  get byTrue() {
    const { datum, drawn } = this.wells;
    return datum === TRUE || (datum !== '' && drawn.every(hasTrue));
  }

  // Which depths stand at one height, in words.
  get depthsInWords() {
    const { datum } = this.wells;
    if (datum === '' || datum === TRUE) return datum ? 'by true vertical depth' : 'by measured depth';
    return `hung on ${datum}, by ${this.byTrue ? 'true vertical' : 'measured'} depth`;
  }

  // Return the depth in a well from which its depths count here; NaN if the well lacks the top, or true depths.
  /** @param {import('./well.js').Well} well */
  datumOf(well) {
    const { datum } = this.wells;
    if (datum === TRUE) return hasTrue(well) ? 0 : NaN;
    const start = datum ? (well.store.intervals.find(([name]) => name === datum)?.[1] ?? NaN) : 0;
    return this.byTrue ? trueDepths(well).down(start) : start;
  }

  // Return how far down a depth of a well is here.
  /** @param {import('./well.js').Well} well @param {number} depth */
  down(well, depth) {
    return (this.byTrue ? trueDepths(well).down(depth) : depth) - this.datumOf(well);
  }

  fit() {
    const ends = this.wells.drawn.filter((well) => Number.isFinite(this.datumOf(well))).map((well) => well.store.span.map((depth) => this.down(well, depth)));
    if (!ends.length) return;
    const [top, bottom] = [Math.min(...ends.map((one) => one[0])), Math.max(...ends.map((one) => one[1]))];
    Object.assign(this, { top: top - 0.01 * (bottom - top), length: 1.02 * (bottom - top), fitted: true, seen: this.wells.drawn.length });
  }

  /** @param {number} top @param {number} length */
  go(top, length) {
    Object.assign(this, { top, length: Math.max(SHORTEST, length) });
    this.wells.moved();
  }

  /** @param {import('./well.js').Well} well @param {number} depth */
  centre(well, depth) {
    this.go(this.down(well, depth) - this.length / 2, this.length);
  }

  /** @param {number} steps @param {boolean} zooms @param {number} y */
  wheel(steps, zooms, y) {
    const [first] = this.columns;
    if (!first) return;
    const { top, height } = first.rects.axis;
    const share = (y - top) / height;
    const length = this.length * (zooms ? 1.25 ** steps : 1);
    this.go(zooms ? this.top + share * (this.length - length) : this.top + 0.1 * steps * this.length, length);
  }

  /** @param {number} pixels */
  drag(pixels) {
    const [first] = this.columns;
    if (first) this.go(this.top - (pixels * this.length) / first.rects.axis.height, this.length);
  }

  /** @param {Ink} ink @param {Rect} rect @returns {Look[]} */
  draw(ink, rect) {
    const { wells } = this;
    const { gpu, view } = wells;
    wells.scene.orbit.enabled = false;
    if (!this.fitted || wells.drawn.length > this.seen) this.fit();
    const palette = PALETTES[view.theme];
    const drawn = wells.drawn.filter((well) => Number.isFinite(this.datumOf(well)));
    const slim = rect.width < SLIM;
    const depths = slim ? 58 : AXIS;
    const between = slim ? 10 : Math.min(120, Math.max(28, (0.14 * rect.width) / Math.max(1, drawn.length)));
    const each = (rect.width - 12 + between) / Math.max(1, drawn.length); // the last well ends at the right
    const body = { top: NAME + HEAD, height: Math.max(40, rect.height - NAME - HEAD - FOOT) };
    const wide = each - between - depths;
    const shape = wide > 150;
    const dips = wells.shown.planes && wide > 300 && drawn.some(({ planes }) => planes.length) ? DIPS.desk : 0;
    this.columns = drawn.map((well, i) => {
      const left = i * each + 4;
      const room = wide - (dips ? dips + 6 : 0);
      const caliper = shape && well.store.basis !== 'gauge' ? Math.round(0.36 * room) : 0;
      const image = { ...body, left: left + depths, width: room - caliper - (caliper ? 6 : 0) };
      const none = { ...body, left, width: 0 };
      const last = { ...body, left: left + depths + room + 6, width: dips };
      const bent = this.byTrue ? bend(well, this.top + this.datumOf(well), this.length) : undefined;
      return { well, datum: this.datumOf(well), bent, rects: { map: none, axis: { ...body, left, width: depths - 4 }, image, caliper: { ...body, left: image.left + image.width + 6, width: caliper }, ...(dips ? { dips: last } : {}), wall: none, pane: none } };
    });
    const looks = this.columns.map(({ well, datum, bent, rects }) => {
      const [top, bottom] = bent ? [0, 1].map(bent.depth) : [this.top + datum, this.top + datum + this.length];
      const shown = wells.viewOf(top, bottom - top);
      well.ask(top, bottom);
      const look = wells.look(well, Object.create(shown, { camera: { value: 'straight' }, bent: { value: bent } }), rects);
      const { image } = rects;
      for (let y = 0; y < image.height; y += bent ? SLICE : image.height) { // the image of a slice has one scale; a piece ends on a slant
        const slice = { ...image, top: image.top + y, height: Math.min(bent ? SLICE : image.height, image.height - y) };
        const [from, to] = [slice.top, slice.top + slice.height].map((end) => depthAt(look.view, image, end));
        gpu.image({ ...look, view: wells.viewOf(from, to - from), imageRect: slice, imagePieces: look.imagePieces.filter((piece) => piece.bottom > 2 * from - to && piece.top < 2 * to - from) });
      }
      return look;
    });
    if (wells.shown.fence) this.join(ink, body);
    const { scale } = LENGTHS[view.units];
    const ends = looks.filter(({ rects }) => rects.caliper.width).flatMap((look) => scaleFor(2 * look.store.bitRadius, profile(look), look.over, scale));
    const lines = ends.length ? linesOf(Math.min(...ends), Math.max(...ends), scale) : undefined; // one scale for all wells
    looks.forEach((look, i) => this.column(ink, look, this.columns[i], palette, lines));
    const left = wells.drawn.length - drawn.length;
    const level = this.byTrue ? drawn.filter((well) => trueDepths(well).level).map(({ name }) => name) : [];
    const notes = [...(left ? [`${left} well${left === 1 ? '' : 's'} without ${wells.datum === TRUE ? 'true depth (a survey from depth 0, or path.head, gives it)' : wells.datum} not shown`] : []), ...(level.length ? [`where ${level.join(', ')} rises, it is not shown`] : [])];
    if (notes.length) label(ink, notes.join('; '), rect.left + rect.width - 8, rect.height - 4, { colour: palette.soft, align: 'right', font: SMALL });
    if (looks.length) this.key(ink, looks, { ...rect, width: rect.width - (notes.length ? ink.measureText(notes.join('; ')).width + 24 : 0) });
    return looks;
  }

  // Write the key below the wells: the kinds of zones and the classes of picks that are in view.
  /** @param {Ink} ink @param {Look[]} looks @param {Rect} rect */
  key(ink, looks, { left, width, height }) {
    const { wells } = this;
    const inView = looks.flatMap(({ zones, view }) => zones.filter(({ start, stop }) => stop > view.top && start < view.bottom));
    const palette = PALETTES[wells.view.theme];
    const y = height - 8;
    let x = left + 8;
    for (const [kind, letter] of /** @type {[Zone['kind'], string][]} */ (Object.entries(LETTERS)).filter(([name]) => inView.some((zone) => zone.kind === name))) {
      ink.fillStyle = palette.zones[kind];
      ink.fillRect(x, y - 7, STRIP, 14);
      label(ink, letter, x + STRIP / 2, y, { colour: inkOn(palette.zones[kind]), align: 'center', font: SMALL_BOLD });
      label(ink, kind, x + STRIP + 5, y, { colour: palette.ink, font: SMALL });
      x += STRIP + 17 + ink.measureText(kind).width;
    }
    if (!wells.shown.planes) return;
    /** @template {{ depth: number }} One @param {(well: import('./well.js').Well) => One[]} of */
    const seen = (of) => this.columns.flatMap(({ well }, i) => of(well).filter(({ depth }) => depth >= looks[i].view.top && depth <= looks[i].view.bottom));
    const kept = seen(({ planes }) => planes);
    const boxes = seen(({ picks }) => picks.filter((pick) => pick.kind === 'breakout'));
    const none = { left, top: 0, width: 1, height: 1 };
    const rects = { ...looks[0].rects, axis: { ...none, left: x, top: y - 11 }, image: none, pane: { ...none, left: left + width } };
    drawLegend(ink, { ...looks[0], view: wells.viewOf(-1e6, 2e6), rects }, { kept, boxes, selected: null, current: null, open: false }, []);
  }

  /** @param {Ink} ink @param {Look} look @param {{ well: import('./well.js').Well, rects: Rects }} of @param {Palette} palette @param {number[]} [lines] of the scale of the caliper */
  column(ink, look, { well, rects }, palette, lines) {
    const { axis, image } = rects;
    const looks = { ...look, images: [look], curtain: null };
    const right = tracksEnd(rects);
    ink.font = BOLD;
    label(ink, fitting(ink, [well.name], right - axis.left), (axis.left + right) / 2, 11, { colour: palette.ink, align: 'center', font: BOLD });
    ink.save();
    ink.translate(0, NAME);
    const lower = (/** @type {Rect} */ rect) => ({ ...rect, top: rect.top - NAME });
    const moved = { ...looks, rects: Object.fromEntries(Object.entries(rects).map(([name, rect]) => [name, lower(rect)])), imageRect: lower(image) };
    drawAxis(ink, moved);
    drawImageHead(ink, moved);
    drawCaliper(ink, moved, lines);
    drawOutside(ink, moved);
    const { axis: depths, image: picture } = moved.rects;
    /** @param {number} depth */
    const y = (depth) => this.y(this.down(well, depth), moved.rects);
    const [top, bottom] = [depths.top, depths.top + depths.height];
    const colours = new Map(this.wells.tops.map(({ name, colour }) => [name, colour]));
    const tops = look.intervals.filter(([, start]) => y(start) >= top && y(start) <= bottom);
    for (const [name, start] of tops) line(ink, picture.left, y(start), right, y(start), colours.get(name) ?? palette.top, [], name === this.wells.datum ? 4 : 2.5); // before the angles of picks, which keep off them
    const planes = { kept: well.planes, boxes: well.picks.filter((pick) => pick.kind === 'breakout'), selected: null, current: null, open: false };
    if (this.wells.shown.planes) drawDips(ink, { ...moved, images: [moved] }, planes, false);
    if (rects.dips) tadpoles(ink, moved, moved.rects.dips, planes);
    edges(ink, sharp(picture, -1), palette.line);
    for (const [name, start] of tops) label(ink, fitting(ink, [name], picture.width - 8), picture.left + 5, y(start) + 9, { colour: palette.ink, halo: palette.paper, font: SMALL_BOLD, near: [[0, 0]], yields: true });
    for (const casing of casingsIn(look.store)) { // along both edges of the image
      const [name, , stop] = casing;
      pipe(ink, casing, picture.left + picture.width / 2, picture.width / 2 - 1, y, [top, bottom], palette);
      if (stop === null || y(stop) < top || y(stop) > bottom) continue;
      ink.font = SMALL_BOLD;
      label(ink, fitting(ink, [shoeInWords(casing, look.view.units), `shoe ${name}`, 'shoe'], picture.width - 8), picture.left + 5, y(stop) - 8, { colour: palette.ink, halo: palette.paper, font: SMALL_BOLD, near: [[0, 0], [0, 17], [0, -15]], yields: true });
    }
    drawAxisLabels(ink, moved);
    for (const [name, start] of this.columns[0].well === well ? [] : tops) { // from the well at its left, with a gap at a number
      const at = y(start);
      const number = ink.canvas.labels.find((box) => box.right > depths.left && box.left < picture.left && box.top < at + 2 && box.bottom > at - 2);
      for (const [from, to] of number ? [[depths.left, number.left - 3], [number.right + 3, picture.left]] : [[depths.left, picture.left]]) if (to > from) line(ink, from, at, to, at, colours.get(name) ?? palette.top, [], name === this.wells.datum ? 4 : 2.5);
    }
    ink.restore();
  }

  /** @param {number} down @param {Rects} rects */
  y(down, { axis }) {
    return axis.top + ((down - this.top) / this.length) * axis.height;
  }

  // Fill the bands of the beds that two neighbours have.
  /** @param {Ink} ink @param {{ top: number, height: number }} body */
  join(ink, body) {
    this.columns.slice(0, -1).forEach((one, i) => {
      const next = this.columns[i + 1];
      const [a, b] = [one, next].map(({ well: { path, store: { span: [top, bottom] } } }) => path.at((top + bottom) / 2).centre);
      const [left, right] = [tracksEnd(one.rects), next.rects.axis.left];
      const text = `${showDepth(Math.hypot(...minus(a, b).slice(0, 2)), this.wells.view.units, 0)} apart`;
      ink.font = SMALL;
      if (i === 0 && ![TRUE, ''].includes(this.wells.datum)) {
        ink.font = SMALL_BOLD;
        const lines = inLines(ink, `hung on ${this.wells.datum}`, right - left - 8);
        if (lines.length < 5 && lines.every((words) => ink.measureText(words).width < right - left)) lines.forEach((words, row) => label(ink, words, (left + right) / 2, 35 + 14 * row, { colour: PALETTES[this.wells.view.theme].ink, align: 'center', font: SMALL_BOLD }));
      }
      ink.font = SMALL;
      if (this.wells.note || !one.well.path.surveyed || !next.well.path.surveyed || ink.measureText(text).width > right - left) return;
      label(ink, text, (left + right) / 2, 11, { colour: PALETTES[this.wells.view.theme].soft, align: 'center', font: SMALL, yields: true });
    });
    ink.save();
    ink.beginPath();
    ink.rect(0, body.top, 1e5, body.height);
    ink.clip();
    this.columns.slice(0, -1).forEach((one, i) => {
      const next = this.columns[i + 1];
      const [left, right] = [tracksEnd(one.rects) + 2, next.rects.axis.left];
      for (const { name, colour } of this.wells.tops) {
        const { top, base, lacks, ...ends } = joined(one.well, next.well, name);
        const [a, b] = [ends.a, ends.b].map((pair, j) => pair?.map((depth) => this.y(this.down([one, next][j].well, depth), one.rects)));
        if (!a || !b || this.wells.hidden.has(name)) continue;
        if (top && !lacks) line(ink, left, a[0], right, b[0], colour, [], 2.5);
        if (!base) continue;
        ink.beginPath();
        for (const [x, y] of [[left, a[0]], [right, b[0]], [right, b[1]], [left, a[1]]]) ink.lineTo(x, y);
        ink.closePath();
        ink.fillStyle = colour;
        ink.globalAlpha = lacks ? 0.2 : 0.45;
        ink.fill();
        ink.globalAlpha = 1;
        if (!lacks) continue;
        for (const end of [0, 1]) line(ink, left, a[end], right, b[end], colour, [6, 5], 2);
        label(ink, '?', (left + right) / 2, (a[0] + a[1] + b[0] + b[1]) / 4, { colour: PALETTES[this.wells.view.theme].ink, align: 'center', font: BOLD });
      }
    });
    ink.restore();
  }

  /** @param {number} x @param {number} y */
  found(x, y) {
    for (const { well, rects, datum, bent } of this.columns) {
      const { axis } = rects;
      if (x < axis.left || x > tracksEnd(rects) || y < axis.top || y > axis.top + axis.height) continue;
      return { well, depth: depthAt({ top: this.top + datum, bottom: this.top + datum + this.length, bent }, axis, y) };
    }
    return null;
  }

  // Return what is known of a well at a depth, as pairs of name and text.
  /** @param {import('./well.js').Well} well @param {number} depth */
  rows(well, depth) {
    const { store, path } = well;
    const { units } = this.wells.view;
    const tvd = path.tvd(depth);
    const asked = well.quantity(this.wells.quantity);
    const over = store.levels[1];
    const values = Array.from({ length: over.sectors }, (_, i) => store.vertex(over.quadAt(depth, (360 * (i + 0.5)) / over.sectors), over)).filter((one) => one !== null);
    /** @param {number[]} of */
    const mean = (of) => of.reduce((sum, value) => sum + value, 0) / of.length;
    const own = asked.attribute === undefined ? [] : [[asked.name, showQuantity(asked, mean(values.map(({ attributes }) => attributes[asked.attribute ?? 0]).filter(Number.isFinite)), units)]];
    return [
      ['Well', well.name],
      ['MD', showDepth(depth, units)],
      ...(Number.isNaN(tvd) ? [] : [['TVD', showDepth(tvd, units)]]),
      ['Bed', intervalAt(store.intervals, depth) ?? '–'],
      ...(values.length ? [['Mean diameter', showLength(2 * mean(values.map(({ radius }) => radius)), units)]] : []),
      ...own,
    ];
  }
}

// Whether wells that have true depths are measured at such different depths along the hole that side by side little of them is seen.
/** @param {import('./well.js').Well[]} wells */
export function farApart(wells) {
  const spans = wells.map(({ store }) => store.span);
  const all = Math.max(...spans.map(([, bottom]) => bottom)) - Math.min(...spans.map(([top]) => top));
  return all > 2 * Math.max(...spans.map(([top, bottom]) => bottom - top)) && wells.every(hasTrue);
}

// Whether a well has true depths.
/** @param {import('./well.js').Well} well */
const hasTrue = ({ store, path }) => !Number.isNaN(path.tvd(store.span[0]));

/** @type {WeakMap<import('./well.js').Well, { key: string, down(depth: number): number, depth(down: number): number, level: boolean }>} */
const tables = new WeakMap();

// Return how a well's measured depths become true depths, and back. Above and below the hole both grow alike. Where the hole rises
// (`level`), no true depth belongs to one measured depth: it has no height there.
/** @param {import('./well.js').Well} well */
function trueDepths(well) {
  const { path, store: { span: [top, bottom] } } = well;
  const key = [path.version, top, bottom].join();
  const kept = tables.get(well);
  if (kept?.key === key) return kept;
  const step = (bottom - top) / STEPS;
  let level = false;
  /** @type {number[]} */
  const trues = [];
  for (let i = 0; i <= STEPS; i++) {
    const tvd = path.tvd(top + i * step);
    const least = i ? trues[i - 1] + 1e-6 * step : -Infinity;
    level ||= tvd < least;
    trues.push(tvd > least ? tvd : i ? least : tvd);
  }
  const last = trues[STEPS];
  /** @param {number} depth */
  const down = (depth) => {
    if (depth <= top) return trues[0] + depth - top;
    if (depth >= bottom) return last + depth - bottom;
    const i = Math.min(STEPS - 1, Math.floor((depth - top) / step));
    return trues[i] + ((depth - top) / step - i) * (trues[i + 1] - trues[i]);
  };
  /** @param {number} at */
  const depth = (at) => {
    if (at <= trues[0]) return top + at - trues[0];
    if (at >= last) return bottom + at - last;
    const i = trues.findIndex((one) => one > at) - 1;
    return top + (i + (at - trues[i]) / (trues[i + 1] - trues[i])) * step;
  };
  const made = { key, down, depth, level };
  tables.set(well, made);
  return made;
}

/** @param {import('./well.js').Well} well @param {number} top @param {number} length @returns {Bend} */
function bend(well, top, length) {
  const { down, depth } = trueDepths(well);
  return { top, length, share: (md) => (down(md) - top) / length, depth: (share) => depth(top + share * length) };
}
