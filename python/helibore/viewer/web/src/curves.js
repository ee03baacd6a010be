// Curves along the hole on a track of their own: curves of files (gamma ray, rate of penetration) and curves that the
// wall's logs measure. The server offers them with the ends of their scales; the page requests the values of the curves
// that it shows, and requests them again when their version changes.

import { scaling } from './color.js';
import { BOLD, fitting, label, PALETTES, SMALL, within, yOf } from './layout.js';
import { byId, options } from './dom.js';
import { whenLate } from './late.js';
import { save } from './saving.js';
import { edges, line, sharp } from './strokes.js';
import { LENGTHS, showValue } from './units.js';

const [PICKS, SAVE] = ['\t', '\n']; // no curve has such a name
const OF_ARMS = ['DMIN', 'C1', 'C2', 'C1TF'];
const AGAIN = 5000; // milliseconds between two requests for a curve that grows
const GAP = 10; // usual steps of depth; a curve has a gap where its rows are farther apart
/** @type {['max' | 'min' | 'pin' | 'ink', number[]][]} */
const STYLES = [['max', []], ['min', [6, 3]], ['pin', [2, 3]], ['ink', [8, 3, 2, 3]]]; // colours of the palette, dashes

// Return the depths and values in the bytes that the server sends: f64 first depth, f32 depths from there, f32 values.
/** @param {ArrayBuffer} buffer */
export function decodeCurve(buffer) {
  const count = (buffer.byteLength - 8) / 8;
  const first = new Float64Array(buffer, 0, 1)[0];
  const depth = Float64Array.from(new Float32Array(buffer, 8, count), (offset) => first + offset);
  const steps = Float64Array.from(depth.subarray(1), (value, i) => value - depth[i]).sort();
  return { depth, values: new Float32Array(buffer, 8 + 4 * count, count), step: steps[steps.length >> 1] ?? Infinity };
}

// Return the first row whose depth is `wanted` or more; the number of rows if there is none.
/** @param {Float64Array} depth @param {number} wanted */
export function rowAt(depth, wanted) {
  let low = 0;
  let high = depth.length;
  while (low < high) {
    const middle = (low + high) >> 1;
    if (depth[middle] < wanted) low = middle + 1;
    else high = middle;
  }
  return low;
}

// Return the value at a depth, linear between rows; NaN above and below the rows, and in gaps.
/** @param {CurveValues} curveValues @param {number} wanted */
export function curveAt({ depth, values, step }, wanted) {
  const i = rowAt(depth, wanted);
  if (depth[i] === wanted) return values[i];
  if (i === 0 || i === depth.length || depth[i] - depth[i - 1] > GAP * step) return NaN;
  const share = (wanted - depth[i - 1]) / (depth[i] - depth[i - 1]);
  return values[i - 1] + share * (values[i] - values[i - 1]);
}

export class Curves {
  /** @type {CurveOffer[]} */
  offered = [];
  /** @type {Map<string, CurveValues & { version: number }>} */
  held = new Map();
  /** @type {Map<string, number>} */
  asked = new Map();
  /** @type {Arms | null} */
  byArms = null;
  /** @type {number | undefined} */
  again = undefined; // timer of a frame that asks for what was just asked for

  /** @param {App} app */
  constructor(app) {
    this.app = app;
    byId('curve').addEventListener('change', () => this.choose(byId('curve').value));
    this.list();
  }

  // Take `rows`, the server's curves that are new or have other ends: name, unit, low, high, log. `version` is the version of
  // the values of all curves.
  /** @param {NonNullable<State['curves']>} rows @param {number} version */
  offer(rows, version) {
    const known = new Map(this.offered.map((one) => [one.name, one]));
    for (const [name, unit, low, high, log] of rows) known.set(name, { name, unit, low, high, log, version });
    const curves = [...known.values()].map((one) => ({ ...one, version }));
    /** @param {CurveOffer[]} list */
    const names = (list) => list.map(({ name }) => name).join('\n');
    const same = names(curves) === names(this.offered);
    this.offered = curves;
    if (!same) {
      this.list();
      this.app.repaint();
    }
    for (const one of this.shown) this.ask(one);
  }

  get shown() {
    return this.app.view.curves.map((name) => this.offered.find((one) => one.name === name)).filter((one) => one !== undefined).slice(-STYLES.length);
  }

  // The diameters by which the server judges a wall of few arms, once they have arrived; null for other walls.
  /** @returns {Arms | null} */
  get arms() {
    if (this.app.shape !== 'arms') return (this.byArms = null);
    for (const one of this.offered) if (OF_ARMS.includes(one.name)) this.ask(one);
    const [min, max, c2, axis] = OF_ARMS.map((name) => this.held.get(name)?.values);
    const depth = this.held.get(OF_ARMS[0])?.depth;
    if (depth && min && max && c2 && axis && [max, c2, axis].every(({ length }) => length === depth.length)) this.byArms = { depth, min, max, c2, axis };
    return this.byArms;
  }

  // Return the values of a curve that the page needs, once they have come.
  /** @param {string} name */
  need(name) {
    const offer = this.offered.find((one) => one.name === name);
    if (offer) this.ask(offer);
    return this.held.get(name);
  }

  list() {
    const { view, store } = this.app;
    /** @type {Choice[]} */
    const offered = [...(store?.columns ?? []), ...this.offered.map(({ name }) => name)].map((name) => [name, `${view.curves.includes(name) ? '✓ ' : ''}${name}`]);
    options('curve', [['', 'Curves'], ...offered, [PICKS, `${view.picks === 'on' ? '✓ ' : ''}picks`], [SAVE, 'template …']]);
  }

  // Show or hide a curve, or the picks.
  /** @param {string} name */
  choose(name) {
    const { view } = this.app;
    if (name === SAVE) {
      whenLate(this.app, ({ toTemplate }) => save(new Blob([toTemplate(this.app)], { type: 'application/toml' }), 'helibore-template.toml'));
      return this.list();
    }
    if (name === PICKS) view.choose({ picks: view.picks === 'on' ? 'off' : 'on' });
    else view.toggleCurve(name);
    return this.list();
  }

  // Ask for the values of a curve, unless the page has them. If it has just asked, it asks again later, also if nothing more
  // arrives by then.
  /** @param {CurveOffer} curveOffer */
  ask({ name, version }) {
    const { contents, redraw } = this.app;
    if (this.held.get(name)?.version === version) return;
    const rest = (this.asked.get(name) ?? -AGAIN) + AGAIN - performance.now();
    if (rest > 0) {
      clearTimeout(this.again);
      this.again = setTimeout(redraw, rest);
      return;
    }
    this.asked.set(name, performance.now());
    const query = new URLSearchParams(location.search);
    query.set('name', name);
    const bytes = contents
      ? Promise.resolve(Uint8Array.from(atob(contents.curves[name] ?? ''), (letter) => letter.charCodeAt(0)).buffer)
      : fetch(`api/curve?${query}`).then((answer) => (answer.ok ? answer.arrayBuffer() : Promise.reject(new Error(answer.statusText))));
    bytes.then((buffer) => {
      this.held.set(name, { version, ...decodeCurve(buffer) });
      this.app.redraw();
    }).catch((error) => this.app.notice(`The curve ${name} did not come: ${error.message}`, 10));
  }

  /** @param {Ink} ink @param {Look} look */
  draw(ink, look) {
    const { view, rects: { curves: rect } } = look;
    const palette = PALETTES[view.theme];
    for (const share of [0.25, 0.5, 0.75]) line(ink, rect.left + share * rect.width, rect.top, rect.left + share * rect.width, rect.top + rect.height, palette.grid);
    this.shown.forEach((one, i) => {
      const [colour, dash] = STYLES[i];
      this.head(ink, one, rect, i, palette, palette[colour], dash, view.units);
      this.ask(one);
      const held = this.held.get(one.name);
      if (held?.depth.length) within(ink, rect, () => trace(ink, one, held, rect, view, palette[colour], dash));
    });
    edges(ink, sharp(rect), palette.line);
  }

  // Draw the name, the line and the two ends of the scale of the i-th curve: below each other for one or two curves, for more
  // in one line, as far as there is room. The name comes first.
  /** @param {Ink} ink @param {CurveOffer} curveOffer @param {Rect} rect @param {number} i @param {Palette} palette @param {string} colour @param {number[]} dash @param {Units} units */
  head(ink, { name, unit, low, high }, { left, width }, i, palette, colour, dash, units) {
    const { scale, unit: length } = unit === 'm' ? LENGTHS[units] : { scale: 1, unit };
    const tall = this.shown.length < 3;
    const y = tall ? 10 + 36 * i : 10 + 18 * i;
    /** @param {number} value */
    const end = (value) => String(Number((value * scale).toPrecision(3))).replace('-', '−');
    ink.font = BOLD;
    const title = fitting(ink, [`${name} ${length}`, name], width - 4);
    label(ink, title, left + width / 2, y, { colour: palette.ink, align: 'center', font: BOLD });
    line(ink, left, y + 8, left + width, y + 8, colour, dash, 1.6);
    const below = tall ? y + 16 : y;
    label(ink, end(low), left, below, { colour: palette.soft, font: SMALL, yields: true, margin: 1 });
    label(ink, end(high), left + width, below, { colour: palette.soft, align: 'right', font: SMALL, yields: true, margin: 1 });
    if (!title.endsWith(length)) label(ink, length, left + width / 2, below, { colour: palette.soft, align: 'center', font: SMALL, yields: true, margin: 2, near: [[0, 0], [0, 10]] });
  }

  // Return name and value of each curve that is shown, at a depth.
  /** @param {number | undefined} depth */
  readout(depth) {
    return this.shown.map(({ name, unit }) => {
      const held = this.held.get(name);
      const value = held && depth !== undefined ? curveAt(held, depth) : NaN;
      const { scale, unit: length } = unit === 'm' ? LENGTHS[this.app.view.units] : { scale: 1, unit };
      return [name, showValue(value * scale, length)];
    });
  }
}

// Draw the line of a curve in view: each row or, if there are many rows for each pixel, the least and the greatest value of several
// rows.
/** @param {Ink} ink @param {CurveOffer} curveOffer @param {CurveValues} curveValues @param {Rect} rect @param {View} view @param {string} colour @param {number[]} dash */
function trace(ink, { low, high, log }, { depth, values, step }, rect, view, colour, dash) {
  const f = scaling(log);
  /** @param {number} value */
  const x = (value) => rect.left + ((f(value) - f(low)) / (f(high) - f(low))) * rect.width;
  const [first, stop] = [Math.max(0, rowAt(depth, view.top) - 1), Math.min(depth.length, rowAt(depth, view.bottom) + 1)];
  const every = Math.max(1, Math.floor((stop - first) / (2 * rect.height)));
  ink.beginPath();
  let drawing = false;
  for (let i = first; i < stop; i += every) {
    let [least, most] = [Infinity, -Infinity];
    for (let j = i; j < Math.min(stop, i + every); j++) {
      if (values[j] < least) least = values[j];
      if (values[j] > most) most = values[j];
    }
    if (least > most || (log && least <= 0) || (i > 0 && depth[i] - depth[Math.max(0, i - every)] > GAP * every * step)) drawing = false;
    if (least > most || (log && least <= 0)) continue;
    const y = yOf(view, rect, depth[i]);
    ink[drawing ? 'lineTo' : 'moveTo'](x(least), y);
    if (most > least) ink.lineTo(x(most), y);
    drawing = true;
  }
  ink.strokeStyle = colour;
  ink.lineWidth = 1.4;
  ink.setLineDash(dash);
  ink.stroke();
  ink.setLineDash([]);
}
