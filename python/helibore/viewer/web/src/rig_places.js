// The places that rig mode names: the worst hole ahead of the string, and what it meets next. Ahead is where the bit moves; if it rests,
// either way.

import { isBlind } from './lamp.js';
import { INTERPOLATED, RADIUS, STATE, TEXEL } from './protocol.js';
import { RECENT, recent } from './rig.js';
import { turn } from './turns.js';
import { longest } from './view.js';
import { byConsequence } from './zones.js';

export const ROWS = 3; // bodies of the string that rig mode lists: the widest
const BEYOND = 3; // metres in view beyond the bit and the worst place
const STEP = 5; // metres by which the section becomes longer
/** @type {Way[]} */
export const WAYS = ['up', 'down'];
export const UNSEEN = 'unseen hole';
export const NOW = 0.05; // metres: so near is here
const LEAST_UNSEEN = 0.5; // metres
export const LATE = 2; // metres of new wall that the server may not have searched yet
export const BY = 0.25; // metres from one turn that is looked at to the next
export const TRUENESS = 0.0015; // metres by which a body sticks at least, as on the server
const SURE = 0.95; // where it is less likely that a body is too thick, it may stick
const STABILISER = 0.9; // of the bit: a body that is wider may be held, and one above the bit counts as a stabiliser
export const HOLDS = ['undergauge', 'key seat']; // hole in which the string may stick
/** @param {FirstPlace} place */
export const holds = ({ tight, may, zone }) => (tight && !may) || Boolean(zone && HOLDS.includes(zone.kind));

// Return the numbers of the widest bodies, in the order in which they hang.
/** @param {RigidBody[]} bodies */
export const widest = (bodies) => bodies.map((_, i) => i).sort((a, b) => bodies[b][0] - bodies[a][0]).slice(0, ROWS).sort((a, b) => bodies[b][2] - bodies[a][2]);

// Return the numbers of the bodies that are nearly as wide as the bit, or else of the widest, in the order in which they hang.
/** @param {RigidBody[]} bodies @param {Store} store */
export function stabilisers(bodies, { bitRadius }) {
  const wide = bodies.map((_, i) => i).filter((i) => bodies[i][0] > STABILISER * 2 * bitRadius);
  return wide.length ? wide.sort((a, b) => bodies[b][2] - bodies[a][2]) : widest(bodies);
}

/** @type {(zones: Zone[], ends: number[]) => Zone | null} */
export function worstOf(zones, [top, bottom]) {
  return byConsequence(zones.filter(({ start, stop }) => stop > top && start < bottom))[0] ?? null;
}

// Return the ways that the bit may take: that in which it moves, or both.
/** @param {App} app */
const waysOf = ({ ahead }) => (ahead?.moving ? [ahead.moving] : WAYS);

// Return the ends of the hole that the string enters within RECENT on the ways that the bit may take: no deeper than the hole is drilled or,
// if that is not known, measured.
/** @param {App} app @returns {Pair} */
export function reach(app) {
  const { store: { span }, bit, holeDepth, string } = app;
  if (bit === null) return /** @type {Pair} */ (recent(app.store));
  const ways = waysOf(app);
  const length = Math.max(0, ...(string?.bodies ?? []).map(([, long, position]) => long + position));
  const bottom = ways.includes('down') ? Math.max(bit, Math.min(bit + RECENT, holeDepth ?? span[1])) : bit;
  return [Math.max(span[0], bit - length - (ways.includes('up') ? RECENT : 0)), bottom];
}

// Return the ends of each stretch of hole within reach that no sensor saw; the last may end beyond, at most at the bottom of the hole.
/** @param {App} app */
function unseenIn(app) {
  const { store, bit, holeDepth } = app;
  const [top, within] = reach(app);
  const end = bit === null || within < bit ? within : Math.max(within, holeDepth ?? within);
  const [level] = store.levels;
  /** @type {Pair[]} */
  const found = [];
  let from = top;
  for (let depth = top; ; depth += BY) {
    const first = level.turnAt(depth);
    if (depth < end && (depth > store.span[1] || (level.locate(first).tile && !turn(store, level, first).some((radius) => radius > 0)))) continue; // what the page has not loaded yet is no gap
    const to = Math.min(depth, end);
    if (to - from >= LEAST_UNSEEN) found.push([from, to]);
    if (depth >= within) return found;
    from = depth + BY;
  }
}

// Return the share of the radii between two depths that are measured, of those that the page has loaded.
/** @param {App} app @param {number} top @param {number} bottom */
export function shareSeen({ store: { levels: [level] } }, top, bottom) {
  let [seen, all] = [0, 0];
  for (let depth = top; depth < bottom; depth += BY) {
    for (let j = 0; j < level.sectors; j++) {
      const { tile, at } = level.locate(level.turnAt(depth) + j);
      if (!tile) continue;
      all++;
      if (tile.texels[TEXEL * at + RADIUS] && !(tile.texels[TEXEL * at + STATE] & INTERPOLATED)) seen++;
    }
  }
  return seen / all;
}

// Return the hole not seen that the bodies of the string enter on the ways that the bit may take, from what is entered first. That above the wall does
// not count. While hole is drilled or the bit is lifted for a connection, that between sensor and bit and what the wall has just got is fresh, unless the sensor is blind; it counts only if the bit moves up through it.
/** @param {App} app @returns {FirstPlace[]} */
export function unseenAhead(app) {
  const { ahead, string, bit, tripped } = app;
  const { bodies = [], hanging = [] } = string ?? {};
  /** @type {(ends: Pair, met: Meeting | null) => FirstPlace[]} */
  const place = ([start, stop], met) => (met ? [{ start, stop, measure: NaN, zone: null, sure: NaN, tight: false, ...met }] : []);
  const { unseen } = ahead ?? {};
  const found = unseen
    ? waysOf(app).flatMap((way) => stabilisers(bodies, app.store).flatMap((i) => {
      const ends = unseen[i]?.[way === 'up' ? 0 : 1];
      return ends ? place(ends, { left: leftTo(bit, bodies[i], way, ends), first: hanging[i]?.name ?? 'string', way }) : [];
    }))
    : unseenIn(app).flatMap(([start, stop]) => place([start, stop], meeting(app, { start, stop })));
  const [first, last] = app.store.span;
  const drilled = tripped || isBlind(app) ? Infinity : last; // below it, hole is fresh
  const end = ahead?.moving === 'up' ? Infinity : drilled;
  return found.map((of) => ({ ...of, start: Math.max(of.start, first), stop: Math.min(of.stop, end), fresh: of.start > drilled - LATE })).filter(({ start, stop }) => start < end - LATE && stop - start > LEAST_UNSEEN / 2).sort((a, b) => a.left - b.left);
}

// Return the zone beyond reach in which the string may stick that it meets next on the ways that the bit may take.
/** @param {App} app @returns {FirstPlace | undefined} */
export function tightBeyond(app) {
  const [top, bottom] = reach(app);
  const found = app.zones.filter(({ kind, start, stop }) => HOLDS.includes(kind) && (start >= bottom || stop <= top)).flatMap((zone) => {
    const met = meeting(app, zone);
    return met ? [/** @type {FirstPlace} */ ({ start: zone.start, stop: zone.stop, measure: zone.measure, zone, sure: zone.confidence, tight: false, ...met })] : [];
  });
  return found.sort((a, b) => a.left - b.left)[0];
}

// Return how far the bit moves until a body meets a stretch of hole, metres; NaN if it is past it.
/** @param {number | null} bit @param {RigidBody} body @param {Way} way @param {Pair} ends */
export function leftTo(bit, [, length, position], way, [start, stop]) {
  const lower = (bit ?? NaN) - position;
  const [left, passed] = way === 'up' ? [lower - length - stop, start - lower] : [start - lower, lower - length - stop];
  return passed < 0 ? Math.max(0, left) : NaN;
}

// Return what the string meets a stretch of hole with first, bit or stabiliser, of undergauge hole one that is too thick for it, and how
// far the bit moves until then, on the shorter of the ways it may take; null if all of them are past it.
/** @param {App} app @param {{ start: number, stop: number } | Zone} stretch @returns {Meeting | null} */
export function meeting(app, stretch) {
  const { string, bit, store } = app;
  const { start, stop } = stretch;
  const { bodies = [], hanging = [] } = string ?? {};
  const own = stabilisers(bodies, store);
  /** @type {[RigidBody, string][]} */
  const all = own.length ? own.filter((i) => !passes(app, bodies[i], stretch)).map((i) => [bodies[i], hanging[i]?.name ?? 'string']) : [[[0, 0, 0], 'bit']];
  const met = waysOf(app).flatMap((way) => all.map(([body, first]) => ({ left: leftTo(bit, body, way, [start, stop]), first, way }))).filter(({ left }) => left >= 0);
  return met.sort((a, b) => a.left - b.left)[0] ?? null;
}

// Return the tight places of one way, the nearest first.
/** @param {App} app @param {Way} way @returns {FirstPlace[]} */
export const tightOn = ({ zones, ahead, store, bit }, way) => (ahead?.[way]?.places ?? []).map(([start, stop, passes, sticksAt, first, , , sure, within, most]) => {
  const zone = worstOf(zones.filter(({ kind }) => kind === 'undergauge'), [start, stop]);
  const left = ((bit ?? NaN) - sticksAt) * (way === 'up' ? 1 : -1);
  return { start, stop, measure: passes - 2 * store.bitRadius + (most ? within ?? 0 : 0), zone, sure: sure ?? NaN, may: (sure ?? 1) < SURE, within: within ?? NaN, most, way, left, first, tight: true };
});

// Whether a stretch is undergauge hole, and wide enough for a body.
/** @param {App} app @param {RigidBody} body @param {{ start: number, stop: number } | Zone} stretch */
const passes = ({ store }, [diameter], stretch) => 'kind' in stretch && stretch.kind === 'undergauge' && diameter < 2 * store.bitRadius + stretch.measure + TRUENESS;

// Whether undergauge hole is no tight place: every body of the string passes it.
/** @param {App} app @param {Zone} zone */
export const isPassed = (app, zone) => Boolean(app.string?.bodies.every((body) => passes(app, body, zone)));

// Return the worst place ahead; the next one, by which body of the string ever: that may hold it, was not seen, or is the worst; and the tight
// place that it meets next; null if nothing is ahead. Tight hole comes before the zones, and of them that which counts most. `most`: that body
// may stick earlier, in hole not seen. `tight`: all tight places, the nearest first. `sure`: the probability that the string sticks there, or that the zone is of its kind.
/** @param {App} app @returns {{ worst: FirstPlace, next: FirstPlace, sticks: FirstPlace | undefined, tight: FirstPlace[], most: boolean } | null} */
export function placesAhead(app) {
  const { bit, zones } = app;
  const ends = reach(app);
  const ways = waysOf(app);
  const tight = ways.flatMap((way) => tightOn(app, way)).sort((a, b) => a.left - b.left);
  const others = byConsequence(zones.filter((zone) => zone.stop > ends[0] && zone.start < ends[1] && !isPassed(app, zone) && !tight.some((of) => of.start < zone.stop && zone.start < of.stop))).flatMap((zone) => {
    const met = meeting(app, zone);
    const { start, stop, measure, within, confidence: sure } = zone;
    return met || bit === null ? [/** @type {FirstPlace} */ ({ start, stop, measure, within, zone, sure, tight: false, ...(met ?? { left: NaN, first: 'bit', way: '' }) })] : [];
  });
  const [worst] = [...tight.toSorted((a, b) => a.measure - b.measure), ...others];
  if (!worst) return null;
  /** @param {FirstPlace[]} of */
  const nearest = (of) => [...of].sort((a, b) => a.left - b.left)[0];
  const [sticks] = tight;
  const unseen = unseenAhead(app);
  const held = [...tight, ...others.filter(holds)];
  const next = nearest([...held, ...unseen.slice(0, 1), ...(held.length ? [] : [worst])]);
  return { worst, next, sticks, most: unseen.some(({ way, left, first }) => way === sticks?.way && first === sticks.first && left < sticks.left), tight };
}

// Return top and length of the section that rig mode shows: the last metres with the bit, and the places ahead that are named. If the bit has
// been lifted far, what is below it does not count.
/** @param {App} app @returns {[top: number, length: number]} */
export function rigSection(app) {
  const { store, bit } = app;
  const down = store.levels[0].pitch > 0;
  const found = placesAhead(app);
  const named = found ? [found.worst, found.next, ...waysOf(app).flatMap((way) => tightOn(app, way))] : unseenAhead(app).slice(0, 1);
  const places = named.map(({ start, stop, tight, zone, way }) => (tight || zone ? { start, stop } : way === 'up' ? { start: stop, stop } : { start, stop: start })); // of unseen hole, where it begins
  const depth = bit ?? store.end;
  const [shallow, deep] = store.span;
  const lead = Math.abs(depth - store.end) > RECENT && (depth < shallow || depth > deep) ? store.end : depth; // the bit may be far from the wall
  const far = down ? (store.end - lead > RECENT / 2 ? lead : Math.max(store.end, lead)) : Math.min(store.end, lead);
  const top = Math.min(...places.map(({ start }) => start), down ? far - RECENT : far) - BEYOND;
  const bottom = Math.max(...places.map(({ stop }) => stop), down ? far : far + RECENT) + BEYOND;
  const length = Math.min(Math.ceil((bottom - top) / STEP) * STEP, longest(store));
  return [down ? bottom - length : top, length];
}
