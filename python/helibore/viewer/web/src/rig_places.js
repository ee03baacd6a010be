// The places that rig mode names: the worst hole ahead of the string, and what it meets next. Ahead is where the bit moves; if it rests,
// either way.

import { longest } from './view.js';
import { RECENT, recent } from './rig.js';
import { byConsequence } from './zones.js';

export const ROWS = 3; // bodies of the string that rig mode lists: the widest
const BEYOND = 3; // metres in view beyond the bit and the worst place
const STEP = 5; // metres by which the section becomes longer
/** @type {Way[]} */
export const WAYS = ['up', 'down'];
export const UNSEEN = 'unseen hole';
const HOLDS = [UNSEEN, 'undergauge', 'key seat']; // hole in which the string may stick

// Return the numbers of the widest bodies, in the order in which they hang.
/** @param {RigidBody[]} bodies */
export const widest = (bodies) => bodies.map((_, i) => i).sort((a, b) => bodies[b][0] - bodies[a][0]).slice(0, ROWS).sort((a, b) => bodies[b][2] - bodies[a][2]);

/** @type {(zones: Zone[], ends: number[]) => Zone | null} */
export function worstOf(zones, [top, bottom]) {
  return byConsequence(zones.filter(({ start, stop }) => stop > top && start < bottom))[0] ?? null;
}

// Return the ways that the bit may take: that in which it moves, or both.
/** @param {App} app */
const waysOf = ({ ahead }) => (ahead?.moving ? [ahead.moving] : WAYS);

// Return the ends of the measured hole that the string enters within RECENT on the ways that the bit may take.
/** @param {App} app @returns {Pair} */
export function reach(app) {
  const { store: { span }, bit, holeDepth, string } = app;
  if (bit === null) return /** @type {Pair} */ (recent(app.store));
  const ways = waysOf(app);
  const length = Math.max(0, ...(string?.bodies ?? []).map(([, long, position]) => long + position));
  const bottom = ways.includes('down') ? Math.min(bit + RECENT, Math.max(bit, holeDepth ?? Infinity)) : bit;
  return [Math.max(span[0], bit - length - (ways.includes('up') ? RECENT : 0)), Math.min(span[1], bottom)];
}

// Return what the string meets a stretch of hole with first, and how far the bit moves until then, on the shorter of the ways it may
// take; null if all bodies that matter are past it. Where the string may stick, the widest matter; else the bit.
/** @param {App} app @param {{ kind: string, start: number, stop: number }} stretch @returns {Meeting | null} */
export function meeting(app, { kind, start, stop }) {
  const { string, bit } = app;
  const { bodies = [], hanging = [] } = string ?? {};
  const own = HOLDS.includes(kind) ? widest(bodies) : [];
  const all = own.length ? own.map((i) => /** @type {const} */ ([...bodies[i], hanging[i]?.name ?? 'string'])) : [/** @type {const} */ ([0, 0, 0, 'bit'])];
  const met = waysOf(app).flatMap((way) => all.flatMap(([, length, position, first]) => {
    const lower = (bit ?? NaN) - position;
    const [left, passed] = way === 'up' ? [lower - length - stop, start - lower] : [start - lower, lower - length - stop];
    return passed < 0 ? [{ left: Math.max(0, left), first, way }] : [];
  }));
  return met.sort((a, b) => a.left - b.left)[0] ?? null;
}

// Return the tight places of one way, the nearest first: that at which the string sticks next, and the tightest.
/** @param {App} app @param {Way} way @returns {FirstPlace[]} */
export function tightOn({ zones, ahead, aheadSure, store, bit }, way) {
  const { nearest, worst } = ahead?.[way] ?? {};
  return [nearest, worst && worst[3] !== nearest?.[3] ? worst : undefined].flatMap((place) => {
    if (!place) return [];
    const [top, bottom, passes, sticksAt, first] = place;
    const zone = worstOf(zones.filter(({ kind }) => kind === 'undergauge'), [top, bottom]);
    const chance = aheadSure.find((one) => one && one[1] <= bottom && one[2] >= top);
    const left = ((bit ?? NaN) - sticksAt) * (way === 'up' ? 1 : -1);
    return { start: zone?.start ?? top, stop: zone?.stop ?? bottom, measure: zone?.measure ?? passes - 2 * store.bitRadius, zone, sure: chance?.[0] ?? NaN, way, left, first, tight: true };
  });
}

// Return the worst place ahead, the next one that may hold the string, or else the worst again, and how many tight places lie on the way of the worst; null if nothing is ahead. Tight
// hole comes before the zones, and of them that which counts most. `sure`: the probability that the string sticks there, or that the zone is of its kind.
/** @param {App} app @returns {{ worst: FirstPlace, next: FirstPlace, count: number } | null} */
export function placesAhead(app) {
  const { bit, zones } = app;
  const ends = reach(app);
  const ways = waysOf(app);
  const tight = ways.flatMap((way) => tightOn(app, way));
  const others = byConsequence(zones.filter(({ start, stop }) => stop > ends[0] && start < ends[1] && !tight.some((of) => of.start < stop && start < of.stop))).flatMap((zone) => {
    const met = meeting(app, zone);
    const { start, stop, measure, confidence: sure } = zone;
    return met || bit === null ? [/** @type {FirstPlace} */ ({ start, stop, measure, zone, sure, tight: false, ...(met ?? { left: NaN, first: 'bit', way: '' }) })] : [];
  });
  const [worst] = [...tight.sort((a, b) => a.measure - b.measure), ...others];
  if (!worst) return null;
  const holds = [...tight, ...others.filter(({ zone }) => zone && HOLDS.includes(zone.kind))].sort((a, b) => a.left - b.left);
  return { worst, next: holds[0] ?? worst, count: worst.tight && worst.way ? (app.ahead?.[worst.way]?.places ?? 1) : 1 };
}

// Return top and length of the section that rig mode shows: the last metres with the bit, and the places ahead. If the bit has
// been lifted far, what is below it does not count.
/** @param {App} app @returns {[top: number, length: number]} */
export function rigSection(app) {
  const { store, bit } = app;
  const down = store.levels[0].pitch > 0;
  const found = placesAhead(app);
  const places = found ? [found.worst, found.next] : [];
  const depth = bit ?? store.end;
  const [shallow, deep] = store.span;
  const lead = Math.abs(depth - store.end) > RECENT && (depth < shallow || depth > deep) ? store.end : depth; // the bit may be far from the wall
  const far = down ? (store.end - lead > RECENT / 2 ? lead : Math.max(store.end, lead)) : Math.min(store.end, lead);
  const top = Math.min(...places.map(({ start }) => start), down ? far - RECENT : far) - BEYOND;
  const bottom = Math.max(...places.map(({ stop }) => stop), down ? far : far + RECENT) + BEYOND;
  const length = Math.min(Math.ceil((bottom - top) / STEP) * STEP, longest(store));
  return [down ? bottom - length : top, length];
}
