// Rig mode (K): bit depth, hole size, worst zone, lag and age of the data in digits that are read from three metres. The
// view follows the bit until the mode is left; the address holds the mode, so a reload keeps it.

import { isSilent, lampWords, LIFTED, SIGNS, silenceOf } from './lamp.js';
import { byId } from './dom.js';
import { hung, shortText } from './string.js';
import { depthNumber, depthUnit, LENGTHS, showAge, showDepth, showSigned, showSpan } from './units.js';
import { bySeverity, IN_WORDS, sureText } from './zones.js';

export const RECENT = 30; // metres of hole that "last" means, if the wall is that long

// Return the depths of the last metres of a wall, shallow first.
/** @param {Store} store */
export const recent = ({ span: [shallow, deep], levels: [{ pitch }] }) => (pitch > 0 ? [Math.max(shallow, deep - RECENT), deep] : [shallow, Math.min(deep, shallow + RECENT)]);

/** @type {(zones: Zone[], ends: number[]) => Zone | null} */
export function worstOf(zones, [top, bottom]) {
  return bySeverity(zones.filter(({ start, stop }) => stop > top && start < bottom))[0] ?? null;
}

// Write text in a cell: the digits, their unit, the line below. Digits that are too wide become narrower, but keep their height.
/** @type {(id: string, digits: string, unit: string, more: string) => void} */
function cell(id, digits, unit, more) {
  const at = byId(id);
  const text = `${digits}${unit && ` ${unit}`}`;
  if (at.dataset.text !== text) {
    at.dataset.text = text;
    const [number, small] = ['span', 'small'].map((name) => document.createElement(name));
    number.textContent = digits;
    small.textContent = ` ${unit}`;
    at.replaceChildren(number, small);
  }
  const room = /** @type {HTMLElement} */ (at.parentElement).clientWidth - 40;
  at.style.transform = at.scrollWidth > room ? `scaleX(${room / at.scrollWidth})` : '';
  if (byId(`${id}More`).textContent !== more) byId(`${id}More`).textContent = more;
}

/** @param {App} app */
export function writeRig(app) {
  const { view, store, path, bit, figures: { summary } } = app;
  byId('rig').hidden = !view.rig || !store;
  document.body.classList.toggle('rig', view.rig);
  byId('rigOpen').textContent = view.rig ? 'Desk' : 'Rig';
  if (!view.rig || !store) return;
  const [top, bottom] = recent(store);
  const { scale, unit } = LENGTHS[view.units];
  /** @param {number | null | undefined} metres */
  const size = (metres) => (typeof metres === 'number' && Number.isFinite(metres) ? (metres * scale).toFixed(unit === 'mm' ? 0 : 2) : '–');
  const string = hung(app);
  const tvd = path.tvd(bit ?? NaN);
  const whyNot = path.whyNoTvd(bit ?? NaN);
  cell('rigBit', bit === null ? '–' : depthNumber(bit, view.units, 1), bit === null ? '' : depthUnit(view.units), bit === null ? 'no bit depth received' : string ? `string ${shortText(string, view.units)}` : Number.isFinite(tvd) ? `TVD ${showDepth(tvd, view.units, 1)}` : whyNot ? `TVD: ${whyNot}` : 'MD');
  const { holeDepth: hole } = app;
  cell('rigHole', hole === null ? '–' : depthNumber(hole, view.units, 1), hole === null ? '' : depthUnit(view.units), hole === null ? 'no hole depth received' : 'MD');
  const { ahead } = app;
  const worse = ahead?.worst;
  const measured = store.basis !== 'gauge' && summary?.mean_diameter;
  const bitSize = `bit ${size(2 * store.bitRadius)}`;
  byId('rigSizeHead').textContent = worse ? `Worst of ${ahead?.places} ${ahead?.above ? 'above' : 'below'}` : `Hole size, last ${showDepth(bottom - top, view.units, 0)}`;
  if (worse) cell('rigSize', `−${size(worse[2])}`, `${unit}${sureOf(app, worse[0], worse[1])}`, showSpan(worse[0], worse[1], view.units));
  else if (measured) cell('rigSize', size(summary.mean_diameter), unit, `${size(summary.least_diameter)} to ${size(summary.greatest_diameter)}, ${bitSize}`);
  else cell('rigSize', '–', '', `${store.basis === 'gauge' || summary ? 'not measured' : '…'}, ${bitSize} ${unit}`);
  if (ahead) {
    const left = bit === null ? NaN : (bit - ahead.sticks_at) * (ahead.above ? 1 : -1); // from the bit depth of now
    const [digits, inUnit] = left > 0.05 ? [depthNumber(left, view.units, 1), depthUnit(view.units)] : ['now', ''];
    cell('rigWorst', digits, inUnit, `${size(ahead.diameter)} of ${size(ahead.needed)} ${unit} at ${showDepth(ahead.above ? ahead.bottom : ahead.top, view.units, 1)}`);
    byId('rigWorstHead').textContent = `Tight ${ahead.above ? 'above' : 'below'}, ${ahead.body} sticks${inUnit && ' in'}`;
    byId('rigWorstCell').className = 'new';
  } else writeWorst(app, [top, bottom]);
  const lag = bit === null ? NaN : (bit - store.end) * Math.sign(store.levels[0].pitch);
  byId('rigLagHead').textContent = lag < -LIFTED ? 'Bit back in the hole' : 'Data end behind bit';
  cell('rigLag', Number.isFinite(lag) ? depthNumber(lag < -LIFTED ? -lag : Math.max(0, lag), view.units, 1) : '–', Number.isFinite(lag) ? depthUnit(view.units) : '', `data end at ${showDepth(store.end, view.units, 1)}`);
  const [colour, text, word] = lampWords(app);
  const [age, ageUnit = ''] = showAge(silenceOf(app)).split(' ');
  byId('rig').classList.toggle('stale', colour === 'lost' || isSilent(app));
  cell('rigAge', age, ageUnit, word ?? text.split(' · ')[0]);
  byId('rigLamp').className = colour;
  byId('rigLamp').textContent = SIGNS[colour] ?? '–';
  const strip = /** @type {HTMLImageElement} */ (byId('rigChannels')); // the server draws it
  strip.hidden = !app.channels;
  const source = `api/channels.svg${location.search || '?'}&theme=${view.theme}&version=${app.channels}`;
  if (app.channels && strip.getAttribute('src') !== source) strip.src = source;
}

// Return how sure it is that hole between two depths is tight, if a zone says so.
/** @param {App} app @param {number} top @param {number} bottom */
function sureOf({ zones }, top, bottom) {
  const zone = bySeverity(zones.filter(({ kind, start, stop }) => kind === 'undergauge' && start < bottom && stop > top))[0];
  return zone ? `, ${sureText(zone)} sure` : '';
}

// Write the worst zone between two depths.
/** @param {App} app @param {number[]} ends */
function writeWorst({ view, store, zones, alarms }, [top, bottom]) {
  const { unit } = LENGTHS[view.units];
  const worst = worstOf(zones, [top, bottom]);
  /** @type {string[]} */
  const [number, inUnit = ''] = worst ? showSigned(worst.measure, view.units, unit === 'mm' ? 0 : 1).split(' ') : [store.basis === 'gauge' ? '–' : 'none', ''];
  cell('rigWorst', number, inUnit, worst ? `${worst.kind} ${showSpan(worst.start, worst.stop, view.units)}` : store.basis === 'gauge' ? 'not measured' : 'no zone');
  byId('rigWorstHead').textContent = worst ? `Worst, ${IN_WORDS[worst.kind]}, ${sureText(worst)} sure` : `Worst, last ${showDepth(bottom - top, view.units, 0)}`;
  byId('rigWorstCell').className = worst ? (alarms.isNew(worst) ? 'new' : 'zone') : '';
}
