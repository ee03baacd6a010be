// Rig mode (K): bit depth, clearance of the string, worst place, lag and age of the data in digits that are read from three
// metres. The view follows the bit until the mode is left; the address holds the mode, so a reload keeps it.

import { isSilent, lampWords, LIFTED, SIGNS, silenceOf } from './lamp.js';
import { byId } from './dom.js';
import { depthNumber, depthUnit, LENGTHS, showAge, showDepth, showSigned, showSpan } from './units.js';
import { byConsequence, IN_WORDS, sureText } from './zones.js';

export const RECENT = 30; // metres of hole that "last" means, if the wall is that long
const BEYOND = 3; // metres in view beyond the bit and the worst place
const STEP = 5; // metres by which the section becomes longer
const ZONES_LATE = 2; // metres of wall whose zones may still be unknown

// Return the depths of the last metres of a wall, shallow first.
/** @param {Store} store */
export const recent = ({ span: [shallow, deep], levels: [{ pitch }] }) => (pitch > 0 ? [Math.max(shallow, deep - RECENT), deep] : [shallow, Math.min(deep, shallow + RECENT)]);

/** @type {(zones: Zone[], ends: number[]) => Zone | null} */
export function worstOf(zones, [top, bottom]) {
  return byConsequence(zones.filter(({ start, stop }) => stop > top && start < bottom))[0] ?? null;
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
  const { ahead, holeDepth: hole } = app;
  const depth = { bit: showDepth(bit ?? NaN, view.units, 1), hole: showDepth(hole ?? NaN, view.units, 1) };
  const [tvd, whyNot] = [path.tvd(bit ?? NaN), path.whyNoTvd(bit ?? NaN)];
  const trueDepth = Number.isFinite(tvd) ? `TVD ${showDepth(tvd, view.units, 1)}` : whyNot ? `TVD: ${whyNot}` : '';
  cell('rigBit', ...parts(depth.bit), bit === null ? 'no bit depth received' : app.string && hole !== null ? `hole depth ${depth.hole}` : trueDepth);
  if (app.string) writeString(app);
  else {
    byId('rigStringHead').textContent = 'Hole depth';
    byId('rigStringCell').className = '';
    cell('rigString', ...parts(depth.hole), hole === null ? 'no hole depth received' : '');
  }
  writeWorst(app, [top, bottom]);
  const measured = store.basis !== 'gauge' && summary?.mean_diameter;
  const bitSize = `bit ${size(2 * store.bitRadius)}`;
  byId('rigNextCell').className = ahead ? 'new' : '';
  if (ahead) {
    const left = bit === null ? NaN : (bit - ahead.sticks_at) * (ahead.above ? 1 : -1); // from the bit depth of now
    const [digits, inUnit] = left > 0.05 ? parts(showDepth(left, view.units, 1)) : ['now', ''];
    byId('rigNextHead').textContent = `Tight ${ahead.above ? 'above' : 'below'}, ${ahead.body} sticks${inUnit && ' in'}`;
    cell('rigNext', digits, inUnit, `${size(ahead.diameter)} of ${size(ahead.needed)} ${unit} at ${showDepth(ahead.above ? ahead.bottom : ahead.top, view.units, 1)}`);
  } else {
    byId('rigNextHead').textContent = `Hole size, last ${showDepth(bottom - top, view.units, 0)}`;
    if (measured) cell('rigNext', size(summary.mean_diameter), unit, `${size(summary.least_diameter)} to ${size(summary.greatest_diameter)}, ${bitSize}`);
    else cell('rigNext', '–', '', `${store.basis === 'gauge' ? 'not measured' : 'looking'}, ${bitSize} ${unit}`);
  }
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

// Return digits and unit of a text such as "2048.8 m".
/** @param {string} text @returns {[string, string]} */
function parts(text) {
  const [digits, unit = ''] = text.split(' ');
  return [digits, unit];
}

// Return the worst place: of the tight places ahead of a bit that is tripped, or else of the zones of the last metres.
/** @param {App} app @param {number[]} ends */
function worstPlace({ zones, ahead }, ends) {
  if (!ahead) {
    const zone = worstOf(zones, ends);
    return zone && { ...zone, zone };
  }
  const [start, stop, excess] = ahead.worst ?? [ahead.top, ahead.bottom, ahead.needed - ahead.diameter];
  return { start, stop, measure: -excess, zone: worstOf(zones.filter(({ kind }) => kind === 'undergauge'), [start, stop]) };
}

// Return top and length of the section that rig mode shows: the last metres with the bit, and the worst place. If the bit has
// been lifted far, what is below it does not count.
/** @param {App} app @returns {[top: number, length: number]} */
export function rigSection(app) {
  const { store, bit } = app;
  const ends = recent(store);
  const down = store.levels[0].pitch > 0;
  const worst = worstPlace(app, ends);
  const depth = bit ?? store.end;
  const [shallow, deep] = store.span;
  const lead = Math.abs(depth - store.end) > RECENT && (depth < shallow || depth > deep) ? store.end : depth; // the bit may be far from the wall
  const far = down ? (store.end - lead > RECENT / 2 ? lead : Math.max(store.end, lead)) : Math.min(store.end, lead);
  const top = Math.min(worst?.start ?? Infinity, down ? far - RECENT : far) - BEYOND;
  const bottom = Math.max(worst?.stop ?? -Infinity, down ? far : far + RECENT) + BEYOND;
  const length = Math.ceil((bottom - top) / STEP) * STEP;
  return [down ? bottom - length : top, length];
}

// Write the worst place, how sure it is, and how far it is from the bit.
/** @param {App} app @param {number[]} ends */
function writeWorst(app, ends) {
  const { view: { units }, store, bit, alarms, ahead, zonesTo } = app;
  const worst = worstPlace(app, ends);
  const way = ahead?.above ? 'above' : 'below';
  const head = ahead ? `Worst ${(ahead.places ?? 1) > 1 ? `of ${ahead.places} ` : ''}${way}` : worst?.zone ? `Worst: ${worst.zone.kind}, ${IN_WORDS[worst.zone.kind]}` : `Worst, last ${showDepth(ends[1] - ends[0], units, 0)}`;
  byId('rigWorstHead').textContent = head;
  byId('rigWorstCell').className = !worst ? '' : !ahead && worst.zone && alarms.isNew(worst.zone) ? 'new' : 'zone';
  if (worst) {
    const [digits, unit] = parts(showSigned(worst.measure, units, units === 'mm' ? 0 : 1));
    const above = bit === null ? NaN : bit - worst.stop;
    const below = bit === null ? NaN : worst.start - bit;
    const away = above > 0 ? `, ${showDepth(above, units, 0)} above bit` : below > 0 ? `, ${showDepth(below, units, 0)} below bit` : '';
    return cell('rigWorst', digits, `${unit}${worst.zone ? `, ${sureText(worst.zone)} sure` : ''}`, `${showSpan(worst.start, worst.stop, units)}${away}`);
  }
  if (store.basis === 'gauge') return cell('rigWorst', '–', '', 'not measured');
  if (zonesTo === null) return cell('rigWorst', 'looking', '', 'for zones');
  return store.span[1] - zonesTo > ZONES_LATE ? cell('rigWorst', 'looking', '', `none to ${showDepth(zonesTo, units, 1)}`) : cell('rigWorst', 'none', '', 'no zone');
}

// Write what the string above the bit clears where it is now; or, in hole that no sensor has passed, where it last was in
// measured hole.
/** @param {App} app */
function writeString({ view: { units }, string }) {
  const at = string?.above_bit;
  /** @param {number} metres */
  const size = (metres) => parts(showSigned(metres, units, units === 'mm' ? (Math.abs(metres) < 1e-3 ? 1 : 0) : 2));
  const name = at ? at.body[0].toUpperCase() + at.body.slice(1) : 'String';
  const verb = !at ? 'clearance' : at.clearance < 0 ? 'sticks' : at.at_most ? 'clears at most' : 'clears';
  const short = at && at.short > 0.05 ? showDepth(at.short, units, 1) : '';
  byId('rigStringHead').textContent = `${name} ${verb}`;
  byId('rigStringCell').className = at && at.clearance < 0 ? 'new' : '';
  if (!at) return cell('rigString', '–', '', at === undefined ? string?.why || 'no bit depth received' : 'no measured hole beside it');
  const range = at.low === null || at.high === null ? '' : `${size(at.low)[0]} to ${size(at.high)[0]}`;
  const sure = range ? `${range}, 95 % sure` : 'no known uncertainty';
  return cell('rigString', ...size(at.clearance), short ? `${range && `${range}, `}measured ${short} above it` : sure);
}
