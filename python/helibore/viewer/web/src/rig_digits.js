// The digits of rig mode, which are read from three metres. Four questions have a place each, which never changes its meaning:
// where the bit is, whether data come, the place to know first and how sure it is, and the clearance of each body of the string.

import { overlap, shortOf } from './alarms.js';
import { byId, say } from './dom.js';
import { ageOf, isDry, isStale, lampWords, LIFTED, SIGNS, silenceOf } from './lamp.js';
import { firstPlace, placeOn, recent, waysOf } from './rig.js';
import { turn } from './turns.js';
import { depthNumber, LENGTHS, showAge, showDepth, showSigned, showSpan } from './units.js';
import { byConsequence, IN_WORDS, percent } from './zones.js';

const ZONES_LATE = 2; // metres of wall whose zones may still be unknown
const NEAR = 0.5; // metres from a zone to the place that an alarm about it names
const NOW = 0.05; // metres: so near is here
const MOVED = 0.3; // metres that the bit may have moved on since the clearances were found
const ROWS = 3; // bodies of the string that rig mode lists
// Return on which side of the bit a tight place lies: a body above the bit may run into one that is above the bit, too.
/** @param {FirstPlace} place @param {number | null} bit */
const sideOf = ({ start, stop }, bit) => ((start + stop) / 2 < (bit ?? NaN) ? SIDES.up : SIDES.down);
/** @type {Record<Way, string>} */
const SIDES = { up: 'above', down: 'below' };
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
  const { view: { units, theme }, store, path, bit, holeDepth: hole } = app;
  const ends = recent(store);
  const tvd = path.tvd(bit ?? NaN);
  const whyNot = path.whyNoTvd(bit ?? NaN);
  const trueDepth = Number.isFinite(tvd) ? `TVD ${showDepth(tvd, units, 1)}` : whyNot ? `TVD: ${whyNot}` : '';
  const off = bit === null || hole === null ? NaN : hole - bit;
  const place = off > LIFTED ? `${showDepth(off, units, 1)} off bottom, hole ${showDepth(hole ?? NaN, units, 1)}` : Number.isFinite(off) ? 'on bottom' : '';
  cell('rigBit', 'Bit depth', ...parts(showDepth(bit ?? NaN, units, 1)), bit === null ? 'no bit depth received' : place || trueDepth);
  writeData(app);
  writeWorst(app, ends);
  byId('rigBodies').hidden = !app.string;
  byId('rigHoleCell').hidden = Boolean(app.string);
  if (app.string) writeBodies(app);
  else cell('rigHole', `Hole size, last ${showDepth(ends[1] - ends[0], units, 0)}`, ...holeSize(app));
  const strip = /** @type {HTMLImageElement} */ (byId('rigChannels')); // the server draws it
  strip.hidden = !app.channels;
  const source = `api/channels.svg${location.search || '?'}&theme=${theme}&version=${app.channels}`;
  if (app.channels && strip.getAttribute('src') !== source) strip.src = source;
}

// Write how old the data are and where they end. The picture and the digits of an old state are pale.
/** @param {App} app */
function writeData(app) {
  const { view: { units }, store, bit } = app;
  const [colour, text, word] = lampWords(app);
  const [age, ageUnit = ''] = showAge(isDry(app) ? ageOf(app) : silenceOf(app)).split(' ');
  const stale = isStale(app);
  document.body.classList.toggle('stale', stale);
  byId('rigAgeCell').className = stale ? 'new' : '';
  const lag = bit === null ? NaN : (bit - store.end) * Math.sign(store.levels[0].pitch);
  const apart = app.apart && `, ${app.apart} pass not shown`;
  const behind = !apart && lag > LIFTED ? `, ${showDepth(lag, units, 1)} behind bit` : '';
  cell('rigAge', 'Data age', age, ageUnit, (colour === 'live' && (word === 'live' || !word) ? `data to ${showDepth(store.end, units, 1)}${behind}` : word ?? text.split(' · ')[0]) + apart);
  byId('rigLamp').className = colour;
  byId('rigLamp').textContent = SIGNS[colour] ?? '–';
}

// Return digits, unit and line below of the hole size of the last metres.
/** @param {App} app @returns {[string, string, string]} */
function holeSize({ view: { units }, store, figures: { summary } }) {
  const { scale, unit } = LENGTHS[units];
  /** @param {number | null | undefined} metres */
  const size = (metres) => (typeof metres === 'number' && Number.isFinite(metres) ? (metres * scale).toFixed(unit === 'mm' ? 0 : 2) : '–');
  const bitSize = `bit ${size(2 * store.bitRadius)}`;
  if (store.basis !== 'gauge' && summary?.mean_diameter) return [size(summary.mean_diameter), unit, `${size(summary.least_diameter)} to ${size(summary.greatest_diameter)}, ${bitSize}`];
  return ['–', '', `${store.basis === 'gauge' ? 'not measured' : 'looking'}, ${bitSize} ${unit}`];
}

// Return digits and unit of a text such as "2048.8 m".
/** @param {string} text @returns {[string, string]} */
function parts(text) {
  const [digits, ...unit] = text.split(' ');
  return [digits, unit.join(' ')];
}

const LEAST_UNSEEN = 0.5; // metres
const BY = 0.25; // metres from one turn that is looked at to the next

// Return the ends of the first stretch of hole between two depths that no sensor saw; null if there is none.
/** @param {Store} store @param {number[]} ends @returns {Pair | null} */
function unseenIn(store, [top, bottom]) {
  const [level] = store.levels;
  let from = bottom;
  for (let depth = top; depth < bottom; depth += BY) {
    const row = Math.floor((depth - level.startDepth) / level.pitch);
    const first = row * level.sectors;
    const isSeen = !level.locate(first).tile || turn(store, level, first).some((radius) => radius > 0); // what the page has not loaded yet is no gap
    if (!isSeen) from = Math.min(from, depth);
    else if (depth - from >= LEAST_UNSEEN) return [from, depth];
    else from = bottom;
  }
  return null;
}

// Write the place to know first: how tight or wide it is and how sure that is, and where it is.
/** @param {App} app @param {number[]} ends */
function writeWorst(app, ends) {
  const { view: { units }, store, bit, alarms, ahead, zonesTo } = app;
  const place = firstPlace(app, ends);
  const moves = place?.way && ahead?.moving === place.way;
  byId('rigWorstCell').className = !place ? '' : place.way || !place.zone || !alarms.isNew(place.zone) ? 'zone' : 'new';
  if (!place) {
    byId('rigWhereCell').className = '';
    const unseen = unseenIn(store, ends);
    const last = unseen ? ['not known', `nobody saw ${showSpan(unseen[0], unseen[1], units)}`] : ['none', `seen in ${showSpan(ends[0], ends[1], units)}`];
    const [digits, more] = store.basis === 'gauge' ? ['–', 'not measured'] : zonesTo === null ? ['looking', 'for zones'] : store.span[1] - zonesTo > ZONES_LATE ? ['looking', `none to ${showDepth(zonesTo, units, 1)}`] : last;
    cell('rigWorst', 'Worst place', digits, '', more);
    return cell('rigWhere', 'Hole size', ...holeSize(app));
  }
  const { start, stop, measure, zone, sure, way, places, sticksAt, worst } = place;
  const { hanging = [] } = app.string ?? {};
  const stuck = way ? stuckIn(app, start, stop) : '';
  const first = stuck || place.first;
  byId('rigWhereCell').className = stuck || moves ? 'new' : '';
  const [head, what] = way ? [`${places > 1 ? `Next of ${places} tight places` : 'Tight place'} ${sideOf(place, bit)}`, `${first} sticks`] : [`Worst place: ${zone?.kind}`, IN_WORDS[zone?.kind ?? 'washout']];
  const [digits, unit] = parts(showSigned(measure, units, units === 'mm' ? 0 : 1));
  cell('rigWorst', head, digits, `${unit}${Number.isNaN(sure) ? '' : `, ${percent(sure)} sure`}`, `${what}${Number.isNaN(sure) ? ', uncertainty not known' : ''}`);
  const left = bit === null ? NaN : way ? (stuck ? 0 : (bit - sticksAt) * (way === 'up' ? 1 : -1)) : Math.max(0, bit - stop, start - bit);
  const i = hanging.findIndex(({ name }) => name === first);
  const unsure = way !== '' && i >= 0 && isUnsure(app, i);
  const isNow = way && left <= NOW && !unsure;
  const from = way ? `${first} sticks ${isNow ? '' : 'in'}` : left > NOW ? `${(bit ?? NaN) > stop ? 'Above' : 'Below'} bit` : 'Bit is in it';
  const other = worst && worst[3] !== sticksAt ? `; worst ${showSigned(worst[2] - 2 * store.bitRadius, units, units === 'mm' ? 0 : 1)} at ${showDepth(worst[0], units, 1)}` : '';
  const here = isNow ? hanging[i]?.depth : null; // where the body stands
  cell('rigWhere', from, ...distance(left, units, unsure), (typeof here === 'number' ? `at ${showDepth(here, units, 1)}` : showSpan(start, stop, units)) + other);
}

// Whether a body is as wide as the bit, so that hole of bit size is not tight for it.
/** @param {RigidBody} body @param {Store} store */
const isBit = ([diameter], { bitRadius }) => diameter >= 2 * bitRadius;

const ONE_IN_FOUR = 0.344; // twice the normal quantile of 25 %, as a share of a 95 % interval
// Whether a body sticks with a probability of one in four or more.
/** @param {{ low?: number | null, high?: number | null }} of */
const mayStick = ({ low, high }) => (low ?? NaN) + (high ?? NaN) < ONE_IN_FOUR * ((high ?? NaN) - (low ?? NaN));

// Return by how much a body may be too thick for the hole and not count as tight there.
/** @param {{ string: RigidString, store: Store, ahead: Outlook | null }} of @param {number} i */
const spareOf = ({ string, store, ahead }, i) => (ahead ? string.bodies[i][0] - ahead.touching[i] : isBit(string.bodies[i], store) ? Infinity : 0);

// Return the string as it hangs, with the body that has the least room and where; a bit in hole of its size has room.
/** @param {App} app @param {number} bottom @returns {Hung | null} */
export function hungInRig({ string, store, ahead }, bottom) {
  if (!string) return null;
  const known = (string.hanging ?? []).map((one, i) => ({ ...one, spare: spareOf({ string, store, ahead }, i), own: isBit(string.bodies[i], store) })).filter(({ clearance, short }) => clearance !== undefined && !short);
  const [least] = known.filter(({ clearance, spare, own }) => !own || (clearance ?? 0) + spare < 0).sort((a, b) => (a.clearance ?? 0) + a.spare - (b.clearance ?? 0) - b.spare);
  const clearance = (least?.clearance ?? NaN) + (least?.spare ?? 0);
  return { ...string, bottom, clearance, low: least && mayStick(least) ? -Infinity : clearance, high: NaN, tightest: least?.depth ?? NaN };
}

// Whether a body of the string sticks where it hangs now, and where it touches; hole that no sensor has passed is not known.
/** @param {App} app @param {number} i */
function sticksNow({ string, store, ahead }, i) {
  const { clearance = NaN, high, short = 0 } = string?.hanging?.[i] ?? {};
  const spare = string ? spareOf({ string, store, ahead }, i) : 0; // by which it may be too thick and not count as tight
  return !(short > NOW) && clearance + spare < 0 && !((high ?? NaN) + spare >= 0);
}

// Whether a body may stick where it hangs, and may not: then no digits say "now".
/** @param {App} app @param {number} i */
function isUnsure(app, i) {
  const { high, short = 0 } = app.string?.hanging?.[i] ?? {};
  return !(short > NOW) && (high ?? NaN) + spareOf(/** @type {any} */ (app), i) >= 0;
}

// Return the name of the body that sticks now between two depths; '' if none does.
/** @param {App} app @param {number} start @param {number} stop */
function stuckIn(app, start, stop) {
  const { hanging = [] } = app.string ?? {};
  return hanging.find(({ depth }, i) => (depth ?? NaN) > start - NEAR && (depth ?? NaN) < stop + NEAR && sticksNow(app, i))?.name ?? '';
}

// Return half the interval of a size, behind the number; no less than it is.
/** @param {{ low?: number | null, high?: number | null }} of @param {Units} units */
function withIn({ low, high }, units) {
  const { scale, unit } = LENGTHS[units];
  const step = unit === 'mm' ? 1 : 100;
  return `±${(Math.ceil((((high ?? NaN) - (low ?? NaN)) / 2) * scale * step) / step).toFixed(unit === 'mm' ? 0 : 2)}`;
}

// Return a distance to move as digits and unit.
/** @param {number} metres @param {Units} units @param {boolean} [unsure] @returns {[string, string]} */
const distance = (metres, units, unsure = false) => (metres > NOW || (unsure && metres <= NOW) ? parts(showDepth(Math.max(0, metres), units, 1)) : Number.isNaN(metres) ? ['–', ''] : ['now', '']);

// Write a row for each of the widest bodies, in the order in which they hang: what it clears now, and how far it moves up or
// down until it sticks.
/** @param {App} app */
function writeBodies(app) {
  const { view: { units }, store, string, ahead, bit, holeDepth: hole } = app;
  const { bodies = [], hanging = [] } = string ?? {};
  const shown = bodies.map((_, i) => i).sort((a, b) => bodies[b][0] - bodies[a][0]).slice(0, ROWS).sort((a, b) => bodies[b][2] - bodies[a][2]);
  /** @type {string[][]} */
  const rows = shown.map((i) => {
    const { name = '', clearance = NaN, low = null, high = null, short = 0, at_most: most } = hanging[i] ?? {};
    const own = isBit(bodies[i], store); // a bit always touches the hole that it drilled
    const isOld = Math.abs((bit ?? NaN) - (string?.bit ?? NaN)) > MOVED;
    const isStuck = !isOld && sticksNow(app, i);
    const unsure = !own && mayStick({ low, high });
    const note = Number.isNaN(clearance) || short > NOW ? 'not measured' : most ? 'at most' : low === null ? 'uncertainty not known' : withIn({ low, high }, units);
    const ways = [0, 1].map((side) => {
      const at = ahead?.bodies[i]?.[side];
      if (!ahead || (side && own && hole !== null && bit !== null && hole - bit < LIFTED)) return '–';
      if (isStuck) return 'now'; // what lies ahead is looked for less often than what hangs here
      const missed = ahead.unseen?.[i]?.[side];
      const to = at === null || at === undefined || bit === null ? '' : distance((bit - at) * (side ? -1 : 1), units, isUnsure(app, i)).join(' ');
      return missed ? (to ? `≤${to}` : `– not known ${missed.map((end) => depthNumber(end, units, 0)).join('–')}`) : to || 'none';
    });
    const moving = ahead?.moving ? ways[ahead.moving === 'up' ? 0 : 1] : '';
    const state = short > NOW || isOld ? 'old' : isStuck ? 'new' : unsure || moving === 'now' ? 'zone' : '';
    return [state, note, name, showSigned(short > NOW ? NaN : clearance, units, units === 'mm' ? 0 : 2), ...ways];
  });
  const text = JSON.stringify([rows, ahead?.moving]);
  const at = byId('rigBodies');
  if (at.dataset.text === text) return;
  at.dataset.text = text;
  at.style.setProperty('--rows', String(rows.length));
  /** @param {string} tag @param {string} textContent @param {string} [className] */
  const make = (tag, textContent, className = '') => Object.assign(document.createElement(tag), { textContent, className });
  const heads = ['', 'Clearance now', 'up: sticks in', 'down: sticks in'].map((one, i) => make('h2', one, ['', '', 'up', 'down'][i] === (ahead?.moving || '-') ? 'on' : ''));
  at.replaceChildren(...heads, ...rows.flatMap(([state, note, name, ...values]) => [make('p', name, `${state} name`), ...values.map((one, i) => {
    const [digits, unit] = parts(one);
    const value = make('p', digits, `${i && state === 'old' ? '' : state} size${'none –'.includes(one) ? ' soft' : ''}`);
    value.append(make('small', unit && ` ${unit}`, digits === '–' ? 'note' : ''), ...(i ? [] : [make('small', note, 'note')]));
    return value;
  })]));
}

// Return the texts of the alarms: one for each place, with the numbers that stand beside it, and one for each alarm about data.
// If `whole` is true, the texts say how sure a place is, and why data are missing.
/** @param {App} app @param {boolean} whole */
export function placesOf(app, whole) {
  const { alarms, view: { units }, zones } = app;
  const tight = app.store ? waysOf(app).flatMap((way) => placeOn(app, way) ?? []) : [];
  /** @param {string} name @param {FirstPlace | Zone} of @param {number} sure */
  const line = (name, { measure, start, stop }, sure) => `${name} ${showSigned(measure, units, units === 'mm' ? 0 : 1)}, ${showSpan(start, stop, units)}${whole && !Number.isNaN(sure) ? `, ${percent(sure)} sure` : ''}`;
  /** @param {FirstPlace} of */
  const tightLine = (of) => line(`tight ${sideOf(of, app.bit)}`, of, of.sure);
  /** @param {Zone} zone */
  const zoneLine = (zone) => {
    const own = tight.find((of) => of.zone && overlap(of.zone, zone));
    return own ? tightLine(own) : line(zone.kind, zone, zone.confidence);
  };
  const feed = alarms.said().map((alarm) => {
    const [, name, rest] = /^(tight|washout)( ahead)?/.exec(alarm) ?? [];
    const way = rest && tight.find(({ way: one }) => one && alarm.includes(SIDES[one]));
    if (way) return tightLine(way);
    const at = Number(/(?:at|from) ([\d.]+)(?: to [\d.]+)? m(?! *:)/.exec(alarm)?.[1]);
    const zone = zones.find(({ kind, start, stop }) => kind === (name === 'tight' ? 'undergauge' : name) && at > start - NEAR && at < stop + NEAR);
    return zone ? zoneLine(zone) : whole ? alarm : shortOf(alarm);
  });
  const fresh = byConsequence(alarms.zones).map(zoneLine);
  return [...new Set([...feed, ...fresh.filter((one) => one.startsWith('tight')), ...fresh])];
}
