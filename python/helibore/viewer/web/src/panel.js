// The controls and read-outs around the stage: what the HTML shows and what the user sets in it.

import { MAPS, fitRange, histogram, sampleOf } from './colour.js';
import { PALETTES } from './layout.js';
import { CUTS } from './path.js';
import { sized } from './polar.js';
import { RESCANNED, PROVISIONAL, CLIPPED, SUPPORT_MASK } from './protocol.js';
import { scaleOf, showAge, showAngle, showClock, showCount, showDepth, showLength, showPercent, showQuantity, showSigned, unitOf } from './units.js';
import { sectionVolume } from './turns.js';
import { CAMERAS } from './view.js';

export const byId = (id) => document.getElementById(id);
const LENGTHS = [2, 5, 10, 20, 30, 50, 100, 200, 500, 1000, 2000, 5000, 10000];
const TUBES = [0, 1, 2, 5, 10, 20, 50, 100, 200];
const SHAPES = [1, 2, 3, 5, 10, 20];
const LATE = 60; // seconds without a sample

export function fillSelects() {
  options('cut', Object.entries(CUTS).map(([value, { label, letters }]) => [value, `${letters.join('-')}: ${label}`]));
  options('camera', Object.entries(CAMERAS));
  options('sectionLength', [['', 'custom'], ...LENGTHS.map((v) => [v, `${v} m`]), ['all', 'whole well']]);
  options('tube', TUBES.map((v) => [v, v ? `× ${v}` : 'auto']));
  options('shape', SHAPES.map((v) => [v, `× ${v}`]));
  options('map', Object.entries(MAPS).map(([value, { label }]) => [value, label.replace(/ \(.*/, '')]));
  for (const option of byId('map').options) option.title = MAPS[option.value].label;
}

// Without a survey nothing is up or north: the wall is cut by the tool's own angles, and two of the four ways remain.
export function nameCuts(surveyed) {
  for (const option of byId('cut').options) {
    const { letters, label, offset, reference } = CUTS[option.value];
    option.text = surveyed ? `${letters.join('-')}: ${label}` : `cut at ${offset}° of the tool`;
    option.hidden = !surveyed && reference === 'north';
  }
}

export function options(id, pairs) {
  byId(id).replaceChildren(...pairs.map(([value, text]) => new Option(text, value)));
}

export function write(id, pairs) {
  const list = byId(id);
  const flat = pairs.flat();
  if (list.children.length !== flat.length) {
    list.replaceChildren(...flat.map((_, i) => document.createElement(i % 2 ? 'dd' : 'dt')));
  }
  flat.forEach((text, i) => {
    if (list.children[i].textContent !== text) list.children[i].textContent = text;
  });
}

// Light or dark, before there is anything to see too.
export function dress({ theme }) {
  byId('theme').textContent = theme === 'dark' ? 'Light' : 'Dark';
  document.documentElement.classList.toggle('dark', theme === 'dark');
}

// Controls that say how the wall is seen wait until there is one.
export function rest(on) {
  for (const part of document.querySelectorAll('aside, #wallHead, #follow, #bar label')) part.inert = on;
}

// Show the view's own settings in the controls, whoever changed them.
export function reflect(view, quantity) {
  for (const id of ['cut', 'pass', 'units', 'median', 'camera']) byId(id).value = String(view[id]);
  for (const id of ['tube', 'shape']) byId(id).value = String(view[id]);
  byId('sectionLength').value = String(LENGTHS.find((length) => Math.abs(length - view.length) < 1e-6 * length) ?? '');
  byId('follow').classList.toggle('on', view.follow);
  byId('follow').textContent = view.follow ? 'Following' : 'Follow bit';
  byId('quantity').value = quantity.id;
  byId('map').value = quantity.map;
  byId('log').checked = quantity.log;
  byId('dynamic').checked = quantity.dynamic;
  const scale = scaleOf(quantity, view.units);
  for (const end of ['low', 'high']) {
    const input = byId(end);
    const value = quantity[end] * scale;
    if (document.activeElement !== input) input.value = Number.isFinite(value) ? String(Number(value.toPrecision(4))) : '';
    input.disabled = quantity.dynamic;
  }
  byId('rangeUnit').textContent = unitOf(quantity, view.units);
}

// How old the picture is and how far behind the bit: the lamp's colour and its words.
export function lamp(app) {
  const [colour, text] = lampWords(app);
  const at = byId('lamp');
  at.className = `lamp ${colour}`;
  at.title = text;
  if (byId('lampText').textContent !== text) byId('lampText').textContent = text;
}

export function lampWords({ status, words, store, bitDepth, newest, ended, feed, lastWrite, replay, contents }) {
  if (status === 'waiting') return ['late', store ? 'waiting for the new run, picture from before' : 'waiting for the first samples'];
  if (status !== 'live' || !store) return ['lost', words || 'connecting'];
  if (replay.past) return ['late', `replay, first pass, as at ${showClock(replay.past.moment)} · ${showCount(replay.past.vertices)} vertices`];
  if (contents) return ['', `snapshot of ${showClock(contents.made)} · ${showCount(store.levels[0].size)} vertices in the well`];
  const seconds = newest !== null ? Date.now() / 1000 - newest : lastWrite === null ? NaN : (performance.now() - lastWrite) / 1000;
  const parts = [];
  if (ended) parts.push('run ended');
  if (Number.isFinite(seconds)) parts.push(`newest sample ${showAge(seconds)} ago`);
  else parts.push('saved wall');
  if (bitDepth !== null) parts.push(behind(store, bitDepth));
  const late = !ended && seconds > LATE;
  parts.push(late && feed ? feed : `${showCount(store.levels[0].size)} vertices`); // why nothing comes matters more then
  return [ended || !Number.isFinite(seconds) ? '' : late ? 'late' : 'live', parts.join(' · ')];
}

// A bit that was lifted is not ahead of the wall, but in it.
function behind(store, bitDepth) {
  const ahead = (bitDepth - store.end) * Math.sign(store.levels[0].pitch);
  return ahead > -0.05 ? `${Math.max(0, ahead).toFixed(1)} m behind bit` : `bit back ${(-ahead).toFixed(1)} m in the wall`;
}

// The read-out of a quad: name and text in pairs; what is not known is a dash.
export function readout({ store, view, path, quad }) {
  const { cursor, units } = view;
  const tvd = cursor ? path.tvd(cursor.depth) : NaN;
  const dial = cursor ? path.dial(cursor.depth) : { up: null, north: null };
  const around = (zero) => (zero === null || !cursor || !Number.isFinite(cursor.toolface) ? '–' : showAngle((((cursor.toolface - zero) % 360) + 360) % 360));
  const { state = 0 } = quad ?? {};
  const marks = [[RESCANNED, 're-scanned'], [PROVISIONAL, 'provisional'], [CLIPPED, 'off scale']].filter(([bit]) => state & bit).map(([, word]) => word);
  return [
    ['MD', showDepth(cursor?.depth)],
    ['TVD', showDepth(tvd)],
    ['Toolface', showAngle(cursor?.toolface ?? NaN)],
    ['From high side / north', `${around(dial.up)} / ${around(dial.north)}`],
    ['Radius', quad ? showLength(quad.radius, units) : cursor ? 'no data' : '–'],
    ['Over bit radius', showSigned(quad ? quad.radius - store.bitRadius : NaN, units)],
    ['Since first pass', quad && state & RESCANNED ? showSigned(quad.radius - quad.first, units) : '–'],
    ['Nearest sample', showLength(quad?.nearest ?? NaN, units, units === 'mm' ? 1 : 3)],
    ['Samples used', quad ? `${state & SUPPORT_MASK}${marks.length ? ` (${marks.join(', ')})` : ''}` : '–'],
    ...store.attributes.map(({ name, unit }, i) => [name, showQuantity({ unit, length: unit === 'm' }, quad?.attributes[i] ?? NaN, units)]),
  ];
}

export function sectionText({ store, view, imagePieces }) {
  const { volume, length, excess, washed, unsupported } = sectionVolume(store, imagePieces, view.pass === 'first');
  return [
    ['Vertices without support', showPercent(unsupported)],
    [`Volume of ${length.toFixed(1)} m measured`, volume ? `${volume.toFixed(3)} m³` : '–'],
    ['Over bit volume', showPercent(excess)],
    ['Washed out (> ½ in)', showPercent(washed)],
  ];
}

// What can be saved of the section; a snapshot has nothing to ask.
export function links({ view, contents }, address) {
  byId('csv').hidden = byId('snapshot').hidden = contents !== null;
  const said = new URLSearchParams(location.search); // the token
  said.set('start', view.top.toFixed(3));
  said.set('stop', view.bottom.toFixed(3));
  byId('csv').href = `api/section.csv?${said}`;
  said.set('address', address);
  byId('snapshot').href = `api/snapshot.html?${said}`;
}

// The histogram of the section with the ends of the range; `ends` maps between values and pixels for the drag.
export class Histogram {
  constructor(canvas) {
    this.canvas = canvas;
    this.sorted = new Float64Array(0);
    this.key = '';
  }

  // Sampling reads thousands of values: only when the section, its tiles or the quantity changed.
  refresh({ store, view, quantity, imagePieces }) {
    const versions = imagePieces.reduce((sum, { tile }) => sum + tile.version * (tile.index + 1), 0);
    const key = [quantity.id, quantity.log, view.pass, view.top.toFixed(2), view.length.toFixed(2), versions, imagePieces.length].join();
    if (key === this.key) return;
    this.key = key;
    this.sorted = sampleOf(store, quantity, imagePieces, view.pass);
  }

  ends(quantity) {
    const fitted = fitRange(quantity, this.sorted);
    const low = Math.min(fitted.low, quantity.low);
    const high = Math.max(fitted.high, quantity.high);
    if (quantity.log && low > 0) return [low / (high / low) ** 0.1, high * (high / low) ** 0.1];
    const margin = (high - low) * 0.1 || 1;
    return [low - margin, high + margin];
  }

  draw(look) {
    const { quantity, view } = look;
    const palette = PALETTES[view.theme];
    this.refresh(look);
    const { ink, width, height } = sized(this.canvas);
    ink.clearRect(0, 0, width, height);
    const [low, high] = (this.scale = this.ends(quantity));
    const log = quantity.log && low > 0;
    const counts = histogram(this.sorted, low, high, log);
    const most = Math.max(1, ...counts);
    ink.fillStyle = palette.soft;
    counts.forEach((count, i) => {
      const tall = (count / most) * (height - 6);
      ink.fillRect((i / counts.length) * width, height - tall, width / counts.length - 0.5, tall);
    });
    if (quantity.dynamic) return;
    ink.fillStyle = palette.cursor;
    for (const end of ['low', 'high']) {
      const x = this.x(quantity[end], quantity);
      ink.fillRect(x - 1, 0, 2, height);
      ink.fillRect(x - 4, 0, 8, 8);
    }
  }

  x(value, { log }) {
    const f = log && this.scale[0] > 0 ? Math.log : (v) => v;
    const [a, b] = this.scale.map(f);
    return ((f(value) - a) / (b - a)) * this.canvas.clientWidth;
  }

  value(x, { log }) {
    const way = log && this.scale[0] > 0;
    const [a, b] = way ? this.scale.map(Math.log) : this.scale;
    const v = a + (x / this.canvas.clientWidth) * (b - a);
    return way ? Math.exp(v) : v;
  }
}
