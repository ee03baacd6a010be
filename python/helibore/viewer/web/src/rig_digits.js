// The digits of rig mode, which are read from three metres. Four questions have a place each, which never changes its meaning:
// where the bit is, whether data come, the place to know first and how sure it is, and the clearance of each body of the string.

import { shortOf } from './alarms.js';
import { byId, hide, say } from './dom.js';
import { ageOf, doubtOf, isDry, isServed, isStale, lampWords, LIFTED, NEVER_BIT, NO_BIT, SIGNS, silenceOf } from './lamp.js';
import { RECENT, recent } from './rig.js';
import { BY, HOLDS, holds, isPassed, LATE, leftTo, NOW, placesAhead, reach, shareSeen, stabilisers, tightBeyond, tightOn, TRUENESS, UNSEEN, unseenAhead, WAYS, widest } from './rig_places.js';
import { doesNotPass } from './string.js';
import { depthNumber, depthUnit, LENGTHS, showAge, showDepth, showSize, showSpan } from './units.js';
import { byConsequence, IN_WORDS, percent } from './zones.js';

const NEAR = 0.5; // metres from a zone to the place that an alarm about it names
// Return on which side of the bit a tight place lies: a body above the bit may run into one that is above the bit, too.
/** @param {FirstPlace} place @param {number | null} bit */
const sideOf = ({ start, stop }, bit) => ((start + stop) / 2 < (bit ?? NaN) ? SIDES.up : SIDES.down);
/** @type {Record<Way, string>} */
const SIDES = { up: 'above', down: 'below' };
const WIDE = 0.05; // metres: a bound on the clearance that is wider says nothing
// Why nothing is said that counts from the bit.
/** @param {App} app */
const noBit = (app) => doubtOf(app) || NO_BIT;
const MAY = 'may stick';
const NAMED = 3; // tight places of one text
const A_LINE = 12; // letters of a name in a line
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
  for (const one of [at, byId(`${id}Head`), byId(`${id}More`)]) fit(one);
}

// Make a text that is wider than its cell narrower.
/** @param {HTMLElement} one @param {number} [margin] */
function fit(one, margin = MARGIN) {
  const room = /** @type {HTMLElement} */ (one.parentElement).clientWidth - margin;
  one.style.transform = one.scrollWidth > room ? `scaleX(${room / one.scrollWidth})` : '';
}

/** @param {App} app */
export function writeDigits(app) {
  const { view: { units, theme }, store, path, bit, holeDepth: hole, ahead } = app;
  const ends = recent(store);
  const tvd = path.tvd(bit ?? NaN);
  const whyNot = path.whyNoTvd(bit ?? NaN);
  const trueDepth = Number.isFinite(tvd) ? `TVD ${showDepth(tvd, units, 1)}` : whyNot ? `TVD: ${whyNot}` : '';
  const off = bit === null || hole === null ? NaN : hole - bit;
  const lifted = off > LIFTED && `${showDepth(off, units, 1)} off bottom, hole ${showDepth(hole ?? NaN, units, 1)}`;
  const moves = isStale(app) ? '' : ahead?.moving ? `, going ${ahead.moving}` : off <= LIFTED ? ', on bottom' : lifted && ahead?.hangs ? ', at rest' : '';
  const same = moves && ahead?.same ? `, same for ${ahead.same} min` : ''; // a depth that does not change any more may be stuck
  cell('rigBit', `Bit depth${moves}${same}`, ...parts(showDepth(bit ?? NaN, units, 1)), bit === null ? NEVER_BIT : lifted || trueDepth);
  writeData(app);
  writeWorst(app);
  hide(!app.string, 'rigBodies');
  hide(Boolean(app.string), 'rigHoleCell');
  if (app.string) writeBodies(app);
  else cell('rigHole', `Hole size, last ${showDepth(ends[1] - ends[0], units, 0)}`, ...holeSize(app));
  const strip = /** @type {HTMLImageElement} */ (byId('rigChannels')); // the server draws it
  strip.hidden = !app.channels;
  const source = `api/channels.svg${location.search || '?'}&theme=${theme}&version=${app.channels}`;
  if (app.channels && strip.getAttribute('src') !== source) strip.src = source;
}

// Write how old the data are and where they end. What counts from an old bit depth is pale, and all of the page if the server is away.
/** @param {App} app */
function writeData(app) {
  const { view: { units }, store, bit } = app;
  const [colour, text, word] = lampWords(app);
  const [age, ageUnit = ''] = showAge(isDry(app) ? ageOf(app) : silenceOf(app)).split(' ');
  const stale = isStale(app);
  if (document.body.classList.contains('stale') !== stale) app.redraw(); // the picture shows it, too
  document.body.classList.toggle('stale', stale);
  document.body.classList.toggle('away', !isServed(app));
  byId('rigAgeCell').className = stale ? 'new' : /late|lost/.test(colour) ? 'zone' : '';
  const lag = bit === null ? NaN : (bit - store.end) * Math.sign(store.levels[0].pitch);
  const behind = lag > LIFTED ? `, ${showDepth(lag, units, 1)} behind bit` : '';
  cell('rigAge', 'Data age', age, ageUnit, colour === 'live' && (word === 'live' || !word) ? `data to ${showDepth(store.end, units, 1)}${behind}` : word ?? text.split(' · ')[0]);
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

// Write the worst place ahead, how sure it is and where; and what the string meets next, which may be the same place.
/** @param {App} app */
function writeWorst(app) {
  const { view: { units }, store, bit, ahead, zonesTo, string } = app;
  const { hanging = [] } = string ?? {};
  const found = placesAhead(app);
  const stale = isStale(app);
  const stuck = stale ? -1 : hanging.findIndex((_, i) => sticksNow(app, i));
  const { name, depth: here = NaN } = hanging[stuck] ?? {};
  /** @param {string} worst @param {string} coming */
  const mark = (worst, coming) => [byId('rigWorstCell').className, byId('rigWhereCell').className] = [worst, coming];
  /** @param {FirstPlace} [other] */
  const and = (other) => (other ? `; ${other.first} ${other.way} in ${showDepth(Math.max(0, other.left), units, 1)}` : '');
  /** @param {FirstPlace} [other] */
  const now = (other) => cell('rigWhere', 'Next: sticks', 'now', '', `${name}, at ${showDepth(here ?? NaN, units, 1)}${and(other)}`);
  if (!found) {
    const [top, bottom] = reach(app);
    const end = Math.min(store.span[1], bottom);
    const hidden = unseenAhead(app);
    const unseen = hidden.find(({ fresh }) => !fresh) ?? hidden[0];
    const last = name ? ['not sure', `tight at ${name}`] : stale ? ['not known', noBit(app)] : unseen && !unseen.fresh ? ['not known', `too little seen in ${showSpan(unseen.start, unseen.stop, units)}`] : top < end ? ['none', `${percent(shareSeen(app, top, end))} seen of ${showSpan(top, end, units)}`] : ['not known', 'too little seen'];
    const [digits, more] = store.basis === 'gauge' ? ['–', 'not measured'] : zonesTo === null ? ['looking', 'for zones'] : end - zonesTo > LATE ? ['looking', `none to ${showDepth(zonesTo, units, 1)}`] : last;
    const far = stale || digits === 'looking' ? undefined : tightBeyond(app);
    const coming = (/^no/.test(digits) && !stale && unseen) || far;
    mark(digits === 'none' && !unseen ? '' : 'unknown', name ? 'new' : coming && coming === unseen ? 'unknown' : '');
    cell('rigWorst', `Worst ${ahead?.moving ? `going ${ahead.moving}` : 'place'}${digits === 'none' ? limitOf(app) : ''}`, digits, '', far ? `${more}; ${kindOf(far)} ${showSize(far.measure, units)} at ${showDepth(far.start, units, 1)}` : more);
    if (name) return now();
    if (!coming) return cell('rigWhere', 'Hole size', ...holeSize(app));
    return cell('rigWhere', nextHead(coming), ...distance(coming.left, units), coming.first);
  }
  const { worst, next, sticks, tight, most } = found;
  const isFast = name || (!stale && ((sticks && !sticks.may) || next.zone?.kind === 'key seat') && ahead?.moving);
  mark(holds(worst) ? 'new' : worst.may ? 'unknown' : '', isFast ? 'new' : !stale && (next.may || kindOf(next) === UNSEEN) ? 'unknown' : '');
  /** @param {FirstPlace} of */
  const size = ({ measure }) => showSize(measure, units);
  /** @param {FirstPlace} of */
  const isHere = ({ start, stop }) => (here ?? NaN) > start - NEAR && (here ?? NaN) < stop + NEAR;
  const [digits, unit] = parts(size(worst));
  const bound = most ? '≤' : '';
  const isAt = isHere(worst);
  const distant = stale || next === worst || isAt ? '' : worst.left <= NOW ? `, ${beside(worst)}` : `, in ${worst === sticks ? bound : ''}${showDepth(worst.left, units, 1)}`;
  const { sure, within, zone, way } = worst;
  const count = tight.filter((of) => of.way === way).length;
  const sureness = Number.isNaN(sure) ? '' : `, ${percent(sure)} sure`;
  cell('rigWorst', `Worst${count > 1 ? ` of ${count}` : way && !isAt ? '' : ' place'}${way && !isAt ? ` going ${way}` : ''}: ${kindOf(worst)}${sureness}`, digits, `${unit} ${worst.most ? 'or tighter' : intervalOf(within, units)}`, `${showSpan(worst.start, worst.stop, units)}${worst.tight && worst.stop - worst.start > RECENT ? ': check caliper, bit' : distant || worst.tight ? distant : `, ${IN_WORDS[zone?.kind ?? 'washout']}`}`);
  if (stale) return cell('rigWhere', 'Next: not known', '–', '', noBit(app));
  if (name) return now(tight.find((of) => !isHere(of)));
  const { first } = next;
  /** @param {FirstPlace} of */
  const may = (of) => of.tight && hanging.some((one, i) => one.name === of.first && isUnsure(app, i));
  /** @param {FirstPlace} of */
  const left = (of) => distance(bit === null ? NaN : of.left, units, may(of));
  const [far, farUnit] = left(next);
  const where = next.tight ? `, ${size(next)} at ${showDepth(next.way === 'up' ? next.stop : next.start, units, 1)}` : `, ${showSpan(next.start, next.stop, units)}`;
  const what = next === worst ? ', the worst place' : next.tight || !sticks ? where : `; ${sticks.first === first ? '' : `${sticks.first} `}${sticks.may ? MAY : 'sticks'}${sticks.way === next.way ? '' : ` going ${sticks.way}`} in ${bound}${left(sticks).join(' ').trim()}`;
  return cell('rigWhere', nextHead(next, may(next)), farUnit ? `${next.tight ? bound : ''}${far}` : far === 'now' ? beside(next) : far, farUnit, `${first}${what}${and(next.tight ? tight.find((of) => of.way !== next.way) : undefined)}`);
}

// Return what is said of a place beside which the string is.
/** @param {FirstPlace} place */
const beside = (place) => (place.zone && !holds(place) ? 'here' : 'now');

// Return the limit of "none": hole that is under bit size by more would be named, with what the size is sure to at least.
/** @param {App} app */
function limitOf({ view: { units }, limits, ahead, string }) {
  const least = ahead ? TRUENESS : limits[2];
  const halves = (string?.hanging ?? []).map(({ low, high }) => (high ?? NaN) / 2 - (low ?? NaN) / 2).filter((half) => half >= 0);
  return ` beyond ${intervalOf(least + (halves.length ? Math.min(...halves) : 0), units).replace('±', '−')} ${LENGTHS[units].unit}`;
}

/** @param {FirstPlace} of */
const kindOf = ({ tight, zone }) => (tight ? 'tight' : zone?.kind ?? UNSEEN);

// Return the line above the distance of the next place.
/** @param {FirstPlace} of @param {boolean} [may] */
const nextHead = (of, may = false) => `Next${of.way && ` going ${of.way}`}: ${of.tight ? (of.may ? MAY : 'sticks') : kindOf(of)}${of.left <= NOW && !may ? '' : ' in'}`;

// Whether a body is as wide as the bit, so that hole of bit size is not tight for it.
/** @param {RigidBody} body @param {Store} store */
const isBit = ([diameter], { bitRadius }) => diameter >= 2 * bitRadius;

// Return the string as it hangs, with the body that sticks or, if none does, has the least room; the bit has none in its own hole.
/** @param {App} app @param {number} bottom @returns {Hung | null} */
export function hungInRig(app, bottom) {
  const { string, view: { units } } = app;
  if (!string) return null;
  const unknown = { ...string, bottom, clearance: NaN, low: NaN, high: NaN, tightest: NaN };
  if (isStale(app)) return unknown;
  const known = (string.hanging ?? []).map((one, body) => ({ ...one, body, sticks: sticksNow(app, body), position: string.bodies[body][2], room: roomOf(one) })).filter(({ room, short, sticks, position }) => room <= WIDE && !(Number(short) > NOW) && (sticks || position > 0));
  const [least] = known.sort((a, b) => Number(b.sticks) - Number(a.sticks) || a.room - b.room || a.position - b.position);
  return least ? { ...unknown, high: least.sticks ? -1 : NaN, tightest: least.depth ?? NaN, body: least.body, text: `${least.at_most ? '≤' : ''}${showSize(least.room, units)}` } : unknown;
}

// Return what a body clears or, if that is a bound, clears at most.
/** @param {Hanging} of */
const roomOf = ({ clearance = NaN, high, at_most: most }) => (most ? high : null) ?? clearance;

// Whether a body of the string sticks where it hangs now, and where it touches; hole that no sensor has passed is not known.
/** @param {App} app @param {number} i */
function sticksNow(app, i) {
  const { clearance = NaN, high, short = 0 } = app.string?.hanging?.[i] ?? {};
  return isFound(app) && !(short > NOW) && (high ?? clearance) < -TRUENESS;
}

// Whether the server has found what the bodies clear where they hang now.
/** @param {App} app */
const isFound = ({ bit, string }) => Math.abs((bit ?? NaN) - (string?.bit ?? bit ?? NaN)) <= NOW;

// Whether a body may stick where it hangs, and may not: then no digits say "now".
/** @param {App} app @param {number} i */
function isUnsure(app, i) {
  const { high, short = 0 } = app.string?.hanging?.[i] ?? {};
  return !(short > NOW) && (high ?? NaN) >= -TRUENESS;
}

// Return half the interval of a size, behind the number; no less than it is.
/** @param {number | undefined} half @param {Units} units */
function intervalOf(half = NaN, units) {
  const { scale, unit } = LENGTHS[units];
  const step = unit === 'mm' ? 1 : 100;
  return Number.isNaN(half) ? '± not known' : `±${(Math.ceil(half * scale * step) / step).toFixed(unit === 'mm' ? 0 : 2)}`;
}

// Return a distance to move as digits and unit.
/** @param {number} metres @param {Units} units @param {boolean} [unsure] @returns {[string, string]} */
const distance = (metres, units, unsure = false) => (metres > NOW || (unsure && metres <= NOW) ? parts(showDepth(Math.max(0, metres), units, 1)) : Number.isNaN(metres) ? ['–', ''] : ['now', '']);

// Return how far the bit moves on one way until a body sticks, or before that meets a key seat: digits, unit and note. Hole that no
// sensor saw and that it enters before, or alone, is named.
/** @type {(app: App, i: number, side: number) => string[]} */
function wayOf(app, i, side) {
  const { view: { units }, string, ahead, bit, zones } = app;
  const { bodies } = /** @type {RigidString} */ (string);
  const [at, missed] = [ahead?.bodies[i]?.[side], ahead?.unseen?.[i]?.[side]];
  /** @param {Pair} ends */
  const left = (ends) => leftTo(bit, bodies[i], WAYS[side], ends);
  const sticks = typeof at === 'number' ? ((bit ?? NaN) - at) * (side ? -1 : 1) : Infinity;
  const may = tightOn(app, WAYS[side]).some(({ start, stop, may: unsure }) => unsure && leftTo(at ?? NaN, bodies[i], WAYS[side], [start, stop]) < BY);
  const seat = Math.min(...zones.filter(({ kind }) => kind === 'key seat').map(({ start, stop }) => left([start, stop])).filter((far) => far < RECENT));
  const far = Math.min(sticks, seat);
  const isHidden = missed && !(left(missed) > far);
  if (far === Infinity) return missed ? ['–', '', `not known ${[...new Set(missed.map((end) => depthNumber(end, units, 0)))].join('–')}`] : ['none', '', ''];
  const [digits, unit] = distance(far, units, sticks <= seat && isUnsure(app, i));
  return [`${isHidden && unit ? '≤' : ''}${digits}`, unit, seat < sticks ? 'key seat' : may ? MAY : ''];
}

// Return the number of the stabiliser next above the bit; -1 if there is none.
/** @param {RigidBody[]} bodies @param {Store} store */
const nextToBit = (bodies, store) => stabilisers(bodies, store).filter((i) => bodies[i][2] > 0).at(-1) ?? -1;

// Return the row of a body: its name, what it clears now, and how far it moves up and down until it sticks.
/** @param {App} app @param {number} i */
function rowOf(app, i) {
  const { view: { units }, store, string, ahead, bit, holeDepth: hole } = app;
  const { bodies = [], hanging = [] } = string ?? {};
  const { name = '', low = null, high = null, at_most: most } = hanging[i] ?? {};
  const bound = roomOf(hanging[i] ?? {});
  const known = isFound(app); // else the server looks for what the body clears here
  const clearance = !known || (most && bound > WIDE) ? NaN : bound;
  const own = isBit(bodies[i], store); // a bit always touches the hole that it drilled
  const isStuck = sticksNow(app, i);
  const note = !known ? 'looking' : Number.isNaN(clearance) ? 'not measured' : most ? 'at most' : intervalOf((high ?? NaN) / 2 - (low ?? NaN) / 2, units);
  const ways = [0, 1].map((side) => {
    if (!ahead || (side && own && hole !== null && bit !== null && hole - bit < LIFTED)) return ['–', '', ''];
    return isStuck ? ['now', '', ''] : wayOf(app, i, side); // what lies ahead is looked for less often than what hangs here
  });
  const state = isStuck || ways.some(([digits], side) => digits === 'now' && ahead?.moving === WAYS[side]) ? 'new' : known && !own && doesNotPass({ clearance: bound, high }) ? 'zone' : '';
  const [digits, unit] = parts(showSize(clearance, units));
  return { state, name, values: [[note === 'at most' ? `≤${digits}` : digits, unit, note], ...ways] };
}

// Write a row for each of the widest bodies beside measured hole, for the stabiliser next above the bit, for that with the least room, and for the body that sticks next on each way, in the order in which they
// hang: what it clears now, and how far it moves up or down until it sticks. If none of them is there, the widest that is has a row. Below them: those of which the hole is not measured.
/** @param {App} app */
function writeBodies(app) {
  const { view: { units }, store, string, ahead, bit } = app;
  const { bodies = [], hanging = [] } = string ?? {};
  const stale = isStale(app);
  const tight = WAYS.flatMap((way) => tightOn(app, way).slice(0, 1));
  const near = nextToBit(bodies, store);
  const own = stabilisers(bodies, store);
  const least = hungInRig(app, NaN)?.body; // the picture names it
  const wide = bodies.map((_, i) => i).filter((i) => own.includes(i) || i === least || widest(bodies).includes(i) || tight.some(({ first }) => hanging[i]?.name === first) || sticksNow(app, i)).sort((a, b) => bodies[b][2] - bodies[a][2]);
  /** @param {number} i */
  const isMeasured = (i) => !hanging.length || (typeof hanging[i]?.clearance === 'number' && !((hanging[i].short ?? 0) > NOW));
  const blind = wide.filter((i) => !isMeasured(i));
  /** @param {number} i */
  const whereIs = (i) => `${depthNumber((bit ?? NaN) - bodies[i][2] - bodies[i][1] / 2, units, 0)} ${depthUnit(units)} (${hanging[i]?.name ?? 'string'})`;
  const others = bodies.map((_, i) => i).filter(isMeasured).sort((a, b) => bodies[b][0] - bodies[a][0]).slice(0, 1);
  const shown = blind.length < wide.length ? wide.filter(isMeasured) : others;
  const rows = stale ? [] : shown.map((i) => ({ ...rowOf(app, i), tag: i === near ? 'at bit' : '' }));
  const lacks = stale ? `Clearances not known: ${noBit(app)}` : blind.length ? `Hole not measured at ${blind.map(whereIs).join(', ')}` : '';
  const text = JSON.stringify([rows, lacks, ahead?.moving]);
  const at = byId('rigBodies');
  if (at.dataset.text === text) return;
  at.dataset.text = text;
  at.style.setProperty('--rows', String(rows.length || 1));
  const longest = Math.max(0, ...rows.map(({ name, tag }) => name.length + tag.length));
  at.style.setProperty('--lines', String(Math.min(3, Math.ceil(longest / A_LINE) || 1))); // of a name
  /** @param {string} tag @param {string} textContent @param {string} [className] */
  const make = (tag, textContent, className = '') => Object.assign(document.createElement(tag), { textContent, className });
  const heads = ['', 'Clearance now', ...WAYS.map((way) => `${way}: sticks in`)].map((one) => make('h2', one, WAYS.some((way) => one.startsWith(way) && (ahead?.moving || way) === way) ? 'on' : '')); // at rest, both ways
  at.replaceChildren(...(rows.length ? heads : []), ...rows.flatMap(({ state, name, tag, values }) => {
    const [first, whole] = [make('p', '', `${state} name`), make('span', name)];
    if (tag) whole.append(make('small', tag, 'note'));
    first.append(whole);
    return [first, ...values.map(([digits, unit, note]) => {
      const value = make('p', '', `${state} size${('none –'.includes(digits) && !note) || note === MAY || digits.startsWith('≤') ? ' soft' : ''}`);
      const number = make('span', digits); // it stays with its unit
      if (unit) number.append(make('small', ` ${unit}`));
      value.append(number);
      if (note) value.append(make('small', note, 'note'));
      return value;
    })];
  }), make('p', lacks, 'lacks'));
  for (const one of at.querySelectorAll('.name span, .lacks')) fit(/** @type {HTMLElement} */ (one), 8); // their padding
}

// Return the places above and below the bit in which the string surely sticks, each once, the tightest first.
/** @param {App} app @returns {FirstPlace[]} */
export const tightNow = (app) => (app.store ? WAYS.flatMap((way) => tightOn(app, way)) : []).filter(({ may }) => !may).sort((a, b) => a.measure - b.measure).filter((of, i, all) => !all.slice(0, i).some((other) => other.start < of.stop && of.start < other.stop));

// Whether the user has silenced a place: what was there then is kept.
/** @param {Alarms} alarms @param {{ start: number, stop: number }} of */
const isQuiet = ({ quiet }, { start, stop }) => quiet.some((one) => start < one[1] && one[0] < stop);

// Return the zones that are new, and those within reach in which the string may stick that were found before the page began and are not silenced.
/** @param {App} app */
function alarmed(app) {
  const { alarms, zones, store } = app;
  const [top, bottom] = store ? reach(app) : [NaN, NaN];
  const held = zones.filter((zone) => HOLDS.includes(zone.kind) && zone.stop > top && zone.start < bottom && !isQuiet(alarms, zone));
  return [...new Set([...alarms.zones, ...held])].filter((zone) => !isPassed(app, zone));
}

// Whether a zone is undergauge hole of a tight place, which may have several.
/** @param {FirstPlace} place @param {Zone} zone */
const isPartOf = ({ start, stop }, zone) => zone.kind === 'undergauge' && zone.start < stop && start < zone.stop;

// Return the zones that the picture names: where the string sticks, what passes there counts, as in the digits; what it passes is none.
/** @param {App} app @returns {Zone[]} */
export function zonesInRig(app) {
  const tight = tightNow(app);
  /** @param {FirstPlace} of @returns {Zone} */
  const asZone = ({ start, stop, measure, zone, sure }) => ({ kind: 'undergauge', severity: 1, confidence: sure, measured: null, ...zone, start, stop, measure, name: 'tight' });
  const others = app.zones.filter((zone) => !isPassed(app, zone) && !tight.some((of) => isPartOf(of, zone)));
  return [...others, ...tight.map(asZone)].sort((a, b) => a.start - b.start);
}

// Return the texts of the alarms: one for each place, with the numbers that stand beside it, and one for each alarm about data.
// That nothing comes is first, then what is too tight, the tightest first. If `whole` is true, the texts say how sure a place is, and
// why data are missing; else several tight places are one text, so that the banner has them all.
/** @param {App} app @param {boolean} whole */
export function placesOf(app, whole) {
  const { alarms, view: { units }, zones } = app;
  const tight = tightNow(app);
  /** @typedef {{ name: string, measure: number, start: number, stop: number, sure: number }} Named */
  /** @param {FirstPlace} of @returns {Named} */
  const tightOne = (of) => ({ ...of, name: `tight ${sideOf(of, app.bit)}` });
  /** @param {Zone} zone @returns {Named} */
  const zoneOne = (zone) => {
    const own = tight.find((of) => isPartOf(of, zone));
    return own ? tightOne(own) : { ...zone, name: zone.kind, sure: zone.confidence };
  };
  const feed = alarms.said().map((alarm) => {
    const [name] = /^(tight|washout)/.exec(alarm) ?? [];
    const at = Number(/(?:at|from) ([\d.]+)(?: to [\d.]+)? m(?! *:)/.exec(alarm)?.[1]);
    /** @param {{ start: number, stop: number }} of */
    const isAt = ({ start, stop }) => at > start - NEAR && at < stop + NEAR;
    const own = name === 'tight' && tight.find(isAt);
    const zone = zones.find((of) => of.kind === (name === 'tight' ? 'undergauge' : name) && isAt(of));
    return own ? tightOne(own) : zone ? zoneOne(zone) : whole ? alarm : shortOf(alarm);
  });
  const all = [...feed, ...tight.filter((of) => !isQuiet(alarms, of)).map(tightOne), ...byConsequence(alarmed(app)).map(zoneOne)];
  /** @param {Named} of */
  const size = ({ measure }) => showSize(measure, units);
  /** @param {Named | string} of */
  const line = (of) => (typeof of === 'string' ? of : `${of.name} ${size(of)}, ${showSpan(of.start, of.stop, units)}${whole && !Number.isNaN(of.sure) ? `, ${percent(of.sure)} sure` : ''}`);
  const places = new Map(all.flatMap((of) => (typeof of === 'object' && of.measure < 0 ? [[line(of), of]] : [])));
  const narrow = [...places.values()].sort((a, b) => a.measure - b.measure);
  const others = [...new Set(all.map(line))].filter((text) => !places.has(text));
  const several = `tight ${narrow.slice(0, NAMED).map((of) => `${size(of)} at ${depthNumber(of.start, units, 0)}`).join(', ')} ${depthUnit(units)}${narrow.length > NAMED ? `, ${narrow.length - NAMED} more` : ''}`;
  const isDead = others.filter((text) => text.startsWith('no data'));
  return [...isDead, ...(whole || narrow.length < 2 ? narrow.map(line) : [several]), ...others.filter((text) => !isDead.includes(text))];
}
