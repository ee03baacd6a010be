// The controls and read-outs around the stage: what the HTML shows and what the user sets in it.

import { MAPS, fitRange, histogram, scaling, valuesInView } from './color.js';
import { sized } from './device.js';
import { byId, fill, hide, options, put, say, write } from './dom.js';
import { wrap360 } from './helix.js';
import { isInside } from './inside.js';
import { inkOn, PALETTES } from './layout.js';
import { recall, remember } from './memory.js';
import { CUTS, cutsOf } from './path.js';
import { CLIPPED, INTERPOLATED, PROVISIONAL, RESCANNED, SUPPORT_MASK, uncertaintyOf } from './protocol.js';
import { scaleLength } from './tracks.js';
import { CERTAIN } from './turns.js';
import { LENGTHS, scaleOf, showAngle, showDepth, showLength, showPercent, showQuantity, showShare, showSigned, showSpan, showValue, unitOf } from './units.js';
import { CAMERAS } from './view.js';
import { bySeverity, isSure, LETTERS, MEASURES, sentence, sureText, zoneAt, zoneText } from './zones.js';

const SECTIONS = [2, 5, 10, 20, 30, 50, 100, 200, 500, 1000, 2000, 5000, 10000];
const SCALES = [20, 50, 100, 200, 500, 1000];
const TUBES = [0, 1, 2, 5, 10, 20, 50, 100, 200];
const SHAPES = [0, 1, 2, 3, 5, 10, 20];
const FOLDED = 'helibore.colour';

export function fillSelects() {
  options('cut', Object.entries(CUTS).map(([value, { label, letters }]) => [value, `${letters.join('-')}: ${label}`]));
  sections(LENGTHS.mm.depth);
  options('camera', Object.entries(CAMERAS));
  options('tube', TUBES.map((v) => [v, v ? `tube × ${v}` : 'tube auto']));
  options('shape', SHAPES.map((v) => [v, v ? `shape × ${v}` : 'shape auto']));
  options('map', Object.entries(MAPS).filter(([name]) => !name.endsWith('-dark')).map(([value, { label }]) => [value, label.replace(/ \(.*/, '')]));
  for (const option of byId('map').options) option.title = MAPS[option.value].label;
}

/** @type {(value: string | number, text?: string) => Choice} */
const choice = (value, text = String(value)) => [value, text];

// Return sections of a round length in the unit of depths; values are metres.
/** @param {{ unit: string, scale: number }} of */
function sections({ unit, scale }) {
  const select = byId('sectionLength');
  if (select.dataset.unit === unit) return;
  select.dataset.unit = unit;
  options('sectionLength', [['', 'custom'], ...SCALES.map((one) => choice(`1:${one}`)), ...SECTIONS.map((length) => choice(length / scale, `${length} ${unit}`)), ['all', 'whole well']]);
}

// Name the cuts that are known along the wall.
/** @param {Path} path */
export function nameCuts(path) {
  const { surveyed, reference, assumed } = path;
  const named = cutsOf([path]);
  const known = surveyed || reference === 'north' || reference === 'high-side';
  for (const option of byId('cut').options) {
    const cut = /** @type {Cut} */ (option.value);
    const { letters, label, offset } = CUTS[cut];
    option.text = known ? `${letters.join('-')}: ${label}${assumed ? ' (assumed)' : ''}` : `cut at ${offset}° of the tool`;
    option.hidden = !named.includes(cut);
  }
}

/** @param {View} view */
export function applyTheme({ theme }) {
  say('theme', theme === 'dark' ? 'Light' : 'Dark');
  document.documentElement.classList.toggle('dark', theme === 'dark');
}

// The panels and controls of the wall are hidden until there is one.
/** @param {boolean} on */
export function disableControls(on) {
  document.body.classList.toggle('empty', on);
}

export const tabs = () => /** @type {HTMLCollectionOf<HTMLButtonElement>} */ (byId('tabs').children);

// Show what the wall is made from, as a warning, if it was not measured all around; hide panels of what was not measured.
/** @param {Handshake} handshake */
export function showBasis({ basis, basis_text: text, bit_diameter: size }) {
  const bit = `${showLength(size, 'mm', 1)} (${showLength(size, 'in', 3)})`;
  hide(basis === 'azimuthal', 'basis');
  byId('basis').textContent = basis === 'gauge' ? `No caliper: the hole is drawn at bit size, ${bit}. Nothing measured its diameter, section, volume or washout.` : `${text[0].toUpperCase()}${text.slice(1)}.`;
  hide(basis !== 'azimuthal', 'crossSection');
  hide(basis === 'gauge', 'shape', 'median');
}

// Return the scale of paper that the tracks have, if it is one of those offered.
/** @param {View} view @param {Rect} image */
export const paperScale = (view, image) => SCALES.find((one) => Math.abs(scaleLength(image, one) / view.length - 1) < 1e-6);

// Return the scale of a print of the section: that of the screen if it is a whole number (1:200), else the nearest one offered.
/** @param {Pick<View, 'length'>} view @param {{ height: number }} image */
export function printScale({ length }, image) {
  const shown = length / scaleLength(image, 1);
  const whole = Math.round(shown);
  if (whole && Math.abs(shown - whole) < 1e-6) return whole;
  /** @param {number} one */
  const off = (one) => Math.abs(Math.log(shown / one));
  return SCALES.reduce((best, one) => (off(one) < off(best) ? one : best));
}

/** @param {'cut' | 'pass' | 'units' | 'median' | 'camera' | 'tube' | 'shape' | 'sectionLength' | 'goTo' | 'quantity' | 'map' | End} id @param {string} value */
const set = (id, value) => put(byId(id), { value });

// Show the view's own settings in the controls, whoever changed them.
/** @param {View} view @param {Quantity} quantity @param {Rect} image */
export function reflect(view, quantity, image) {
  for (const id of /** @type {const} */ (['cut', 'pass', 'units', 'median', 'camera', 'tube', 'shape'])) set(id, String(view[id]));
  hide(view.camera !== 'outside', 'tube', 'fit');
  hide(view.camera === 'straight', 'whole');
  byId('whole').classList.toggle('on', view.tab === '3d');
  hide(!isInside(view), 'fly', 'film');
  const paper = paperScale(view, image);
  const { depth } = LENGTHS[view.units];
  sections(depth);
  const length = SECTIONS.find((one) => Math.abs(one / depth.scale - view.length) < 1e-6 * view.length);
  set('sectionLength', paper ? `1:${paper}` : length ? String(length / depth.scale) : '');
  if (document.activeElement !== byId('goTo')) set('goTo', (view.middle * depth.scale).toFixed(1));
  say('beside', view.beside.includes(quantity.id) ? 'Alone' : 'Beside');
  for (const tab of tabs()) put(tab, { ariaSelected: String(tab.value === view.tab) });
  byId('follow').classList.toggle('on', view.follow);
  say('follow', view.follow ? 'Following' : 'Follow bit');
  set('quantity', quantity.id);
  set('map', quantity.map);
  for (const id of /** @type {const} */ (['log', 'dynamic', 'inView'])) byId(id).checked = quantity[id];
  const scale = scaleOf(quantity, view.units);
  for (const end of /** @type {const} */ (['low', 'high'])) {
    const value = quantity[end] * scale;
    if (document.activeElement !== byId(end)) set(end, Number.isFinite(value) ? String(Number(value.toPrecision(5))) : '');
    byId(end).disabled = quantity.dynamic || quantity.inView;
  }
  const unit = unitOf(quantity, view.units);
  say('rangeUnit', unit);
  fill(byId('colourText'), `Colour: ${quantity.name}, ${quantity.dynamic ? 'dynamic' : [quantity.low, quantity.high].map((end) => showValue(end * scale)).join(' to ')} ${quantity.dynamic ? '' : unit}`.trim());
}

// Return the values at the cursor as pairs of name and text; an unknown value is a dash. Without a cursor, return the depths in
// the middle of the section, where the cross-section is.
/** @param {{ store: Store, view: View, path: Path, vertex: Vertex | null }} of */
export function readout({ store, view, path, vertex }) {
  const { cursor, units } = view;
  const depth = cursor?.depth ?? view.middle;
  const tvd = path.tvd(depth);
  const toolface = Number((cursor?.toolface ?? NaN).toFixed(1)); // as it is shown, and as an address keeps it
  const angles = [wrap360(toolface - (path.dial(depth).up ?? NaN)), path.azimuth(depth, toolface)].map((angle) => showAngle(angle));
  const { state = 0 } = vertex ?? {};
  const sigma = store.attributes.findIndex((one) => one.name === 'sigma');
  const half = sigma < 0 ? uncertaintyOf(state) : CERTAIN * store.attributeAt(sigma, cursor);
  /** @type {[number, string][]} */
  const all = [[RESCANNED, 're-scanned'], [PROVISIONAL, 'provisional'], [CLIPPED, 'off scale'], [INTERPOLATED, 'interpolated']];
  const marks = all.filter(([bit]) => state & bit).map(([, word]) => word);
  return [
    ['MD', showDepth(depth, units)],
    ['TVD', (Number.isNaN(tvd) && path.whyNoTvd(depth)) || showDepth(tvd, units)],
    ['Toolface', showAngle(toolface)],
    [`From high side / azimuth${path.assumed ? ', assumed' : ''}`, angles.join(' / ')],
    ...(store.basis === 'gauge' ? [['Radius', 'not measured']] : [
      ['Radius', vertex ? showLength(vertex.radius, units) : cursor && cursor.toolface !== null ? 'no data' : '–'],
      ...(half > 0 ? [['Radius, 95 %', `± ${showLength(half, units, units === 'mm' ? 1 : 2)}`]] : []),
      ['Over bit radius', showSigned(vertex ? vertex.radius - store.bitRadius : NaN, units)],
      ['Change', vertex && state & RESCANNED ? showSigned(vertex.radius - vertex.first, units) : '–'],
      ['Nearest sample', showLength(vertex?.nearest ?? NaN, units, units === 'mm' ? 1 : 3)],
      ['Samples used', vertex ? `${state & SUPPORT_MASK}${marks.length ? ` (${marks.join(', ')})` : ''}` : '–'],
    ]),
    ...store.attributes.map(({ name, unit }, i) => [name, showQuantity({ unit, length: unit === 'm' }, store.attributeAt(i, cursor), units)]),
  ];
}

// On a narrow screen, write the cursor's depth in large digits, its zone and the sizes of its turn.
/** @param {Look} look @param {string[][]} read @param {string[][]} figures */
export function writeBrief({ view, zones, path, store }, read, figures) {
  const depth = view.cursor?.depth ?? view.middle;
  const values = Object.fromEntries([...read, ...figures]);
  byId('briefDepth').textContent = showDepth(depth, view.units);
  const zone = zoneAt(zones, depth);
  const share = figures.flatMap(([name, value]) => (name === 'Turn measured' ? [`${value} of the turn measured`] : [])); // hole that nobody measured has no zone either
  byId('briefZone').textContent = zone ? `${LETTERS[zone.kind]} ${zoneText(zone, view.units)}` : store.basis === 'gauge' ? 'not measured' : ['no zone', ...share].join(', '); // one line, always: the log below keeps its height
  byId('briefZone').style.borderColor = zone ? PALETTES[view.theme].zones[zone.kind] : '';
  const lacks = typeof view.cursor?.toolface === 'number' ? 'no data' : 'tap image'; // a depth alone is on no quad
  const over = store.basis === 'gauge' ? store.attributes.slice(0, 3).map(({ name }) => [name, name]) : [['Over bit', 'Over bit radius']];
  const tvd = path.tvd(depth);
  write('briefMore', [
    ...figures.filter(([name]) => /^C\d(?! −)/.test(name)).map(([name, size]) => [name.slice(0, 2), size === '–' ? 'no data' : size]),
    ...over.map(([name, of]) => [name, values[of] === '–' ? lacks : values[of]]),
    ['TVD', Number.isNaN(tvd) ? path.whyNoTvd(depth) || (path.surveyed ? 'not known' : 'no survey') : showDepth(tvd, view.units)],
  ]);
}

const REST = 0.01; // metres: the figures end so near to the end of the section
const LEAST_SHARE = 0.0005; // of a section: less is not written
// What the figures of a section count, for their tooltips.
const MEANINGS = {
  measured: 'Share of the wall with a sample within 0.15 m and 15°, little change, no gap above largest_gap (Help has more); empty: without a radius',
  volume: 'Of the turns that have a radius all around',
  washed: 'Metres washed out, without the gaps that a zone joins, of all metres of the section that lie in the wall',
};

// Two significant digits: what is mostly interpolated is worth no more.
/** @param {number} value */
const roughly = (value) => String(Number(value.toPrecision(2)));

// Return the figures of a section as text, as `Wall.summary` has them. `zones` are those of the wall; the section ends at `shown`.
/** @param {Store} store @param {Summary | null} summary @param {Units} units @param {Zone[]} zones @param {number} shown */
export function sectionText(store, summary, units, zones, shown) {
  if (store.basis === 'gauge') return [['Hole size, volume, washout', 'not measured']];
  if (!summary) return [['Section', '…']];
  const { stop, volume, excess, coverage, whole_turns: counted, incomplete_turns: others, washed_out: washed, without_radius: without, unmeasured_shape: unsure, volume_text: volumeText, excess_text: excessText } = summary;
  /** @param {number | null} value */
  const number = (value) => value ?? NaN;
  const whole = counted + others;
  // A washout in view that the figures do not reach yet, because the wall has grown since they were made.
  const newer = zones.some((zone) => zone.kind === 'washout' && Math.min(zone.stop, shown) > stop + REST && zone.start < shown);
  /** @type {[number, string][]} */
  const parts = [[number(coverage), ''], [1 - number(coverage) - number(without), ' interpolated'], [number(without), ' empty']];
  /** @type {[string, string, string][]} */
  const washing = washed === undefined ? [] : [['Washed out', washed === null ? '–' : newer ? '…' : `${showDepth(washed, units, 1)} of ${showDepth(whole, units, 1)}, ${showPercent(washed / whole)}`, MEANINGS.washed]];
  return [
    ['Measured', parts.filter(([share], i) => !i || share >= LEAST_SHARE).map(([share, of]) => showPercent(share) + of).join(', '), MEANINGS.measured],
    ['Volume', !counted ? '–' : volumeText ? `${volumeText} over ${showDepth(counted, units, 1)} of whole turns` : unsure ? `about ${roughly(volume)} m³ over ${showDepth(counted, units, 1)}, uncertainty not known` : `${volume.toFixed(3)} m³ over ${showDepth(counted, units, 1)} of whole turns`, MEANINGS.volume],
    ['Against the bit', excessText?.replaceAll('-', '−') ?? (unsure && excess !== null ? `about ${Math.round(100 * excess)} %` : `${number(excess) >= 0 ? '+' : ''}${showPercent(number(excess))}`), MEANINGS.volume],
    ...washing,
  ];
}

// What the list was made from, its zones, and its rows by what stands in them.
let listed = { made: /** @type {unknown[]} */ ([]), sorted: /** @type {Zone[]} */ ([]), rows: /** @type {Map<string, HTMLElement>} */ (new Map()) };

// List the zones, worst first; a click on a zone shows it. The zone at the cursor is marked, depths out of view are grey. Without a
// zone, the title is the text `none`; if that is empty, the card is hidden.
/** @param {Zone[]} zones @param {View} view @param {Alarms} alarms @param {(zone: Zone) => void} show @param {string} none */
export function listZones(zones, view, alarms, show, none) {
  const { units, theme } = view;
  const list = byId('zones');
  const made = [zones, units, theme, alarms.zones, none];
  if (made.some((one, i) => one !== listed.made[i])) {
    const sorted = bySeverity(zones);
    const rows = new Map();
    /** @type {(key: string, make: () => HTMLElement) => unknown} */
    const row = (key, make) => rows.set(key, listed.rows.get(key) ?? make());
    if (zones.length) row(units, () => headOf(units));
    for (const zone of sorted) row(JSON.stringify([zone, units, theme, alarms.isNew(zone)]), () => rowOf(zone, view, alarms.isNew(zone), show));
    place(list, listed.rows, rows);
    listed = { made, sorted, rows };
    hide(!zones.length && !none, 'zonesCard');
    byId('zonesCard').style.setProperty('--rows', String(zones.length));
    byId('zonesTab').textContent = `Zones ${zones.length || ''}`;
    byId('zonesTitle').textContent = !zones.length ? none : `${zones.length} zone${zones.length === 1 ? '' : 's'}, worst first`;
    if (!list.onscroll) new ResizeObserver(countHidden).observe(list);
    list.onscroll = countHidden;
    countHidden();
  }
  const current = zoneAt(zones, view.cursor?.depth);
  listed.sorted.forEach((zone, i) => {
    const row = /** @type {HTMLElement} */ (list.children[i + 1]);
    row.classList.toggle('out', zone.stop < view.top || zone.start > view.bottom);
    if ((row.ariaCurrent === 'true') === (zone === current)) return;
    row.ariaCurrent = zone === current ? 'true' : null;
    if (zone === current) bringIntoView(row, list);
  });
}

// Put rows into a list in place of those of before. A row that was there stays: the browser need not lay it out anew.
/** @param {HTMLElement} list @param {Map<string, HTMLElement>} before @param {Map<string, HTMLElement>} rows */
function place(list, before, rows) {
  for (const [key, row] of before) if (!rows.has(key)) row.remove();
  let at = list.firstChild;
  for (const row of rows.values()) {
    if (row === at) at = at.nextSibling;
    else list.insertBefore(row, at);
  }
}

/** @param {Units} units */
function headOf(units) {
  const head = document.createElement('div');
  head.title = 'The extreme in the zone, and how probable its kind is; worst first, by the extreme over its limit times the probability. Depths out of view are grey';
  head.append(...['', 'kind', `MD ${LENGTHS[units].depth.unit}`, LENGTHS[units].unit, 'sure'].map((text) => Object.assign(document.createElement('span'), { textContent: text })));
  return head;
}

/** @param {Zone} zone @param {View} view @param {boolean} isNew @param {(zone: Zone) => void} show */
function rowOf(zone, { units, theme }, isNew, show) {
  const row = document.createElement('button');
  row.type = 'button';
  row.title = `${sentence(zone)}${zone.measured === null ? '' : `, ${showShare(zone.measured)} of its turns measured`}: the extreme of ${MEASURES[zone.kind]} in the zone, ${zone.severity.toFixed(1)} times its limit`;
  row.classList.toggle('new', isNew);
  const texts = [LETTERS[zone.kind], `${isNew ? 'new ' : ''}${zone.kind}`, showSpan(zone.start, zone.stop, units).replace(/ .*/, ''), showSigned(zone.measure, units, units === 'mm' ? 0 : 1).replace(/ .*/, ''), sureText(zone)];
  row.append(...texts.map((text) => Object.assign(document.createElement('span'), { textContent: text })));
  const colour = PALETTES[theme].zones[zone.kind];
  const style = isSure(zone) ? { background: colour, color: inkOn(colour) } : { outline: `2px solid ${colour}`, outlineOffset: '-2px', color: 'var(--ink)' };
  Object.assign(/** @type {HTMLElement} */ (row.firstChild).style, style);
  row.addEventListener('click', () => show(zone));
  return row;
}

// Scroll the list, and nothing else of the page.
/** @param {HTMLElement} row @param {HTMLElement} list */
function bringIntoView({ offsetTop, offsetHeight }, list) {
  const first = /** @type {HTMLElement} */ (list.firstElementChild).offsetHeight;
  list.scrollTop = Math.max(offsetTop + offsetHeight - list.clientHeight, Math.min(offsetTop - first, list.scrollTop));
}

// Say how many zones the list has no room for.
function countHidden() {
  const { scrollTop, scrollHeight, clientHeight, lastElementChild } = byId('zones');
  const [above, below] = [scrollTop, scrollHeight - clientHeight - scrollTop].map((pixels) => Math.round(pixels / (/** @type {HTMLElement | null} */ (lastElementChild)?.offsetHeight || 1)));
  const text = below > 0 ? `${below} below` : above > 0 ? `${above} above` : '';
  say('zonesMore', text);
}

// Set the links that download the section; they are hidden in an exported file, which has no server.
/** @param {App} app @param {string} address */
export function links({ view, store, contents, prints, meshes, renderer: { rects } }, address) {
  const saved = Boolean(contents);
  hide(saved, 'csv', 'las', 'export');
  hide(saved || !meshes, 'glb');
  hide(saved || !prints, 'print', 'printAll', 'dipPrint');
  /** @param {(string | number)[]} ends */
  const between = ([start, stop]) => new URLSearchParams(`${location.search}&start=${start}&stop=${stop}`); // with the token
  const query = between([view.top, view.bottom].map((end) => end.toFixed(3)));
  for (const kind of /** @type {const} */ (['csv', 'las', 'glb'])) byId(kind).href = `api/section.${kind}?${query}`;
  const scale = printScale(view, rects.image);
  const look = `units=${view.units}&scale=${scale}&picks=${view.picks}`;
  const picks = view.picks === 'on' ? ', with its picks' : '';
  byId('print').href = `api/print.pdf?${query}&${look}`;
  byId('print').title = byId('dipPrint').title = `${showSpan(view.top, view.bottom, view.units)}, in view, on paper at 1:${scale}${picks} (PDF). Print well, below the log, prints it all.`;
  byId('printAll').href = `api/print.pdf?${between(store.span)}&${look}`;
  put(byId('printAll'), { title: `The whole well on paper at 1:${scale}, nearest to the scale in view, ${showDepth((store.span[1] - store.span[0]) / scale, view.units)} long${picks} (PDF)` });
  query.set('address', address);
  byId('export').href = `api/export.html?${query}`;
}

// The controls of the colours are open while the whole panel has room, until the user opens or closes them.
/** @param {() => void} redraw */
function foldColour(redraw) {
  const colour = byId('colour');
  const panel = /** @type {HTMLElement} */ (colour.parentElement);
  const narrow = window.matchMedia('(max-width: 999px)');
  let chosen = recall('localStorage', FOLDED);
  const fold = () => {
    colour.open = true;
    colour.open = chosen ? chosen === 'open' : narrow.matches || panel.scrollHeight <= panel.clientHeight;
  };
  const sizes = new ResizeObserver(fold);
  for (const part of [panel, ...panel.children]) if (part !== colour) sizes.observe(part);
  byId('colourText').addEventListener('click', () => remember('localStorage', FOLDED, (chosen = colour.open ? 'closed' : 'open')));
  colour.addEventListener('toggle', redraw);
}

// The histogram of the section with the ends of the range; `ends` returns the values at the two ends of the histogram; `x` and
// `value` convert between values and pixels for the drag.
export class Histogram {
  scale = [0, 1]; // values at its ends

  /** @param {Canvas} canvas @param {() => void} redraw */
  constructor(canvas, redraw) {
    this.canvas = canvas;
    /** @type {Float64Array} */
    this.sorted = new Float64Array(0);
    foldColour(redraw);
  }

  /** @param {Quantity} quantity */
  ends(quantity) {
    const fitted = fitRange(quantity, this.sorted);
    const low = Math.min(fitted.low, quantity.low);
    const high = Math.max(fitted.high, quantity.high);
    if (quantity.log && low > 0) return [low / (high / low) ** 0.1, high * (high / low) ** 0.1];
    const margin = (high - low) * 0.1 || 1;
    return [low - margin, high + margin];
  }

  /** @param {Look} look */
  draw(look) {
    const { quantity, view } = look;
    const palette = PALETTES[view.theme];
    this.sorted = valuesInView(look, look.asked);
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
    if (quantity.dynamic || quantity.inView) return;
    ink.fillStyle = palette.cursor;
    for (const end of /** @type {const} */ (['low', 'high'])) {
      const x = this.x(quantity[end], quantity);
      ink.fillRect(x - 1, 0, 2, height);
      ink.fillRect(x - 4, 0, 8, 8);
    }
  }

  /** @param {number} value @param {Quantity} quantity */
  x(value, { log }) {
    const f = scaling(log && this.scale[0] > 0);
    const [a, b] = this.scale.map(f);
    return ((f(value) - a) / (b - a)) * this.canvas.clientWidth;
  }

  /** @param {number} x @param {Quantity} quantity */
  value(x, { log }) {
    const asLog = log && this.scale[0] > 0;
    const [a, b] = asLog ? this.scale.map(Math.log) : this.scale;
    const v = a + (x / this.canvas.clientWidth) * (b - a);
    return asLog ? Math.exp(v) : v;
  }
}
