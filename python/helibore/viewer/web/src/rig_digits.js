// The digits of rig mode, which are read from three metres: bit depth, clearance of the string, worst place, tight hole ahead
// or hole size, lag and age of the data.

import { byId, say } from './dom.js';
import { isStale, lampWords, LIFTED, SIGNS, silenceOf } from './lamp.js';
import { recent, worstPlace } from './rig.js';
import { depthNumber, depthUnit, LENGTHS, showAge, showDepth, showSigned, showSpan } from './units.js';
import { IN_WORDS, percent } from './zones.js';

const ZONES_LATE = 2; // metres of wall whose zones may still be unknown
const ONE_IN_FOUR = 0.344; // twice the normal quantile of 25 %, as a share of a 95 % interval
const MARGIN = 40; // pixels of a cell that its texts leave free

// Write text in a cell: the line above the digits, the digits, their unit, the line below. Texts that are too wide become narrower, but keep their height.
/** @type {(id: string, head: string, digits: string, unit: string, more: string) => void} */
function cell(id, head, digits, unit, more) {
  const at = byId(id);
  const text = `${digits}${unit && ` ${unit}`}`;
  if (at.dataset.text !== text) {
    at.dataset.text = text;
    const [number, small] = ['span', 'small'].map((name) => document.createElement(name));
    number.textContent = digits;
    small.textContent = ` ${unit}`;
    at.replaceChildren(number, small);
  }
  say(`${id}Head`, head);
  say(`${id}More`, more);
  const room = /** @type {HTMLElement} */ (at.parentElement).clientWidth - MARGIN;
  for (const one of [at, byId(`${id}Head`), byId(`${id}More`)]) one.style.transform = one.scrollWidth > room ? `scaleX(${room / one.scrollWidth})` : '';
}

/** @param {App} app */
export function writeDigits(app) {
  const { view, store, path, bit, figures: { summary } } = app;
  const [top, bottom] = recent(store);
  const { scale, unit } = LENGTHS[view.units];
  /** @param {number | null | undefined} metres */
  const size = (metres) => (typeof metres === 'number' && Number.isFinite(metres) ? (metres * scale).toFixed(unit === 'mm' ? 0 : 2) : '–');
  const { ahead, holeDepth: hole } = app;
  const depth = { bit: showDepth(bit ?? NaN, view.units, 1), hole: showDepth(hole ?? NaN, view.units, 1) };
  const [tvd, whyNot] = [path.tvd(bit ?? NaN), path.whyNoTvd(bit ?? NaN)];
  const trueDepth = Number.isFinite(tvd) ? `TVD ${showDepth(tvd, view.units, 1)}` : whyNot ? `TVD: ${whyNot}` : '';
  cell('rigBit', 'Bit depth', ...parts(depth.bit), bit === null ? 'no bit depth received' : app.string && hole !== null ? `hole depth ${depth.hole}` : trueDepth);
  if (app.string) writeString(app);
  else {
    byId('rigStringCell').className = '';
    cell('rigString', 'Hole depth', ...parts(depth.hole), hole === null ? 'no hole depth received' : '');
  }
  writeWorst(app, [top, bottom]);
  const measured = store.basis !== 'gauge' && summary?.mean_diameter;
  const bitSize = `bit ${size(2 * store.bitRadius)}`;
  byId('rigNextCell').className = ahead && ahead.moving !== false ? 'new' : '';
  if (ahead) {
    const left = bit === null ? NaN : (bit - ahead.sticks_at) * (ahead.above ? 1 : -1); // from the bit depth of now
    const [digits, inUnit] = left > 0.05 ? parts(showDepth(left, view.units, 1)) : ['now', ''];
    const sure = app.aheadSure[0];
    const where = ahead.moving === false ? 'On the way out' : `Tight ${ahead.above ? 'above' : 'below'}`;
    cell('rigNext', `${where}: ${ahead.body} sticks${inUnit && ' in'}`, digits, inUnit && `${inUnit}${typeof sure === 'number' ? `, ${percent(sure)} sure` : ''}`, `hole ${size(ahead.diameter)} for ${size(ahead.needed)} ${unit}, ${showSpan(ahead.top, ahead.bottom, view.units)}`);
  } else {
    const head = `Hole size, last ${showDepth(bottom - top, view.units, 0)}`;
    if (measured) cell('rigNext', head, size(summary.mean_diameter), unit, `${size(summary.least_diameter)} to ${size(summary.greatest_diameter)}, ${bitSize}`);
    else cell('rigNext', head, '–', '', `${store.basis === 'gauge' ? 'not measured' : 'looking'}, ${bitSize} ${unit}`);
  }
  const lag = bit === null ? NaN : (bit - store.end) * Math.sign(store.levels[0].pitch);
  const off = bit === null || hole === null ? NaN : hole - bit;
  const [head, far] = off > LIFTED ? ['Off bottom', off] : lag < -LIFTED ? ['Bit above end of data', -lag] : ['Data end behind bit', Math.max(0, lag)];
  cell('rigLag', head, Number.isFinite(far) ? depthNumber(far, view.units, 1) : '–', Number.isFinite(far) ? depthUnit(view.units) : '', `data end at ${showDepth(store.end, view.units, 1)}`);
  const [colour, text, word] = lampWords(app);
  const [age, ageUnit = ''] = showAge(silenceOf(app)).split(' ');
  byId('rig').classList.toggle('stale', colour === 'lost' || isStale(app));
  cell('rigAge', 'Data age', age, ageUnit, word ?? text.split(' · ')[0]);
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

// Write the worst place, how sure it is, and how far it is from the bit.
/** @param {App} app @param {number[]} ends */
function writeWorst(app, ends) {
  const { view: { units }, store, bit, alarms, ahead, zonesTo } = app;
  const worst = worstPlace(app, ends);
  const way = ahead?.above ? 'above' : 'below';
  const head = ahead ? `Worst ${(ahead.places ?? 1) > 1 ? `of ${ahead.places} ` : ''}${way}` : worst?.zone ? `Worst: ${worst.zone.kind}, ${IN_WORDS[worst.zone.kind]}` : `Worst, last ${showDepth(ends[1] - ends[0], units, 0)}`;
  byId('rigWorstCell').className = !worst ? '' : !ahead && worst.zone && alarms.isNew(worst.zone) ? 'new' : 'zone';
  if (worst) {
    const [digits, unit] = parts(showSigned(worst.measure, units, units === 'mm' ? 0 : 1));
    const above = bit === null ? NaN : bit - worst.stop;
    const below = bit === null ? NaN : worst.start - bit;
    // Another body meets the place before the bit does, so what is said is where the place is; on the other side, nothing.
    const away = above > 0 && ahead?.above !== false ? `, ${showDepth(above, units, 0)} above bit` : below > 0 && !ahead?.above ? `, ${showDepth(below, units, 0)} below bit` : '';
    return cell('rigWorst', head, digits, `${unit}${Number.isNaN(worst.sure) ? '' : `, ${percent(worst.sure)} sure`}`, `${showSpan(worst.start, worst.stop, units)}${away}`);
  }
  if (store.basis === 'gauge') return cell('rigWorst', head, '–', '', 'not measured');
  if (zonesTo === null) return cell('rigWorst', head, 'looking', '', 'for zones');
  return store.span[1] - zonesTo > ZONES_LATE ? cell('rigWorst', head, 'looking', '', `none to ${showDepth(zonesTo, units, 1)}`) : cell('rigWorst', head, 'none', '', `seen in ${showSpan(ends[0], ends[1], units)}`);
}

// Write what the string above the bit clears where it is now; or, in hole that no sensor has passed, where it last was in
// measured hole.
/** @param {App} app */
function writeString({ view: { units }, string }) {
  const at = string?.above_bit;
  /** @param {number} metres */
  const size = (metres) => parts(showSigned(metres, units, units === 'mm' ? (Math.abs(metres) < 1e-3 ? 1 : 0) : 2));
  const body = at ? at.body[0].toUpperCase() + at.body.slice(1) : 'String';
  const unsure = at && at.low !== null && at.high !== null && at.low + at.high < ONE_IN_FOUR * (at.high - at.low); // to stick
  const does = !at ? 'clearance' : at.clearance < 0 ? 'sticks' : unsure ? 'may stick' : at.at_most ? 'clears at most' : 'clears';
  const short = at && at.short > 0.05 ? showDepth(at.short, units, 1) : '';
  const head = `${body} ${does}`;
  byId('rigStringCell').className = at && at.clearance < 0 ? 'new' : unsure ? 'zone' : '';
  if (!at) return cell('rigString', head, '–', '', at === undefined ? string?.why || 'no bit depth received' : 'no measured hole beside it');
  const range = at.low === null || at.high === null ? '' : `${size(at.low)[0]} to ${size(at.high)[0]}`;
  const sure = range ? `${range}, 95 % sure` : 'no known uncertainty';
  return cell('rigString', head, ...size(at.clearance), short ? `${range && `${range}, `}measured ${short} above it` : sure);
}
