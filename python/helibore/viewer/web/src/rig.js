// Rig mode (K): what rig_digits.js writes, beside a picture of the last metres and the worst place. The view follows the bit
// until the mode is left; the address holds the mode, so a reload keeps it.

import { byId } from './dom.js';
import { LIFTED } from './lamp.js';
import { late } from './late.js';
import { longest } from './view.js';
import { byConsequence } from './zones.js';

export const RECENT = 30; // metres of hole that "last" means, if the wall is that long
const BEYOND = 3; // metres in view beyond the bit and the worst place
const STEP = 5; // metres by which the section becomes longer

// Return the depths of the last metres of a wall, shallow first.
/** @param {Store} store */
export const recent = ({ span: [shallow, deep], levels: [{ pitch }] }) => (pitch > 0 ? [Math.max(shallow, deep - RECENT), deep] : [shallow, Math.min(deep, shallow + RECENT)]);

/** @type {(zones: Zone[], ends: number[]) => Zone | null} */
export function worstOf(zones, [top, bottom]) {
  return byConsequence(zones.filter(({ start, stop }) => stop > top && start < bottom))[0] ?? null;
}

/** @type {Way[]} */
const WAYS = ['up', 'down'];

// Return the ways that the bit may take, the one that counts most first: that in which it moves; if it hangs, the one on which the
// string sticks sooner; on bottom, its way out.
/** @param {App} app @returns {Way[]} */
export function waysOf({ ahead, bit, holeDepth }) {
  const [up, down] = WAYS.map((way) => Math.abs((bit ?? NaN) - (ahead?.[way]?.nearest[3] ?? Infinity)));
  const isDownFirst = ahead?.moving ? ahead.moving === 'down' : (holeDepth ?? NaN) - (bit ?? NaN) > LIFTED && down < up;
  return isDownFirst ? ['down', 'up'] : WAYS;
}

// Return the tight place at which the string sticks next on one way; null if there is none.
/** @param {App} app @param {Way} way @returns {FirstPlace | null} */
export function placeOn({ zones, ahead, aheadSure, store }, way) {
  const tight = ahead?.[way];
  if (!tight) return null;
  const [top, bottom, passes, sticksAt, first] = tight.nearest;
  const zone = worstOf(zones.filter(({ kind }) => kind === 'undergauge'), [top, bottom]);
  const chance = aheadSure.find((one) => one && one[1] <= bottom && one[2] >= top);
  return { start: zone?.start ?? top, stop: zone?.stop ?? bottom, measure: zone?.measure ?? passes - 2 * store.bitRadius, zone, sure: chance?.[0] ?? NaN, way, sticksAt, first, places: tight.places, worst: tight.worst };
}

// Return the place to know first: the tight place at which the string sticks next, or else the worst of the zones of the last
// metres. `sure`: the probability that the string sticks there, or that the zone is of its kind.
/** @param {App} app @param {number[]} [ends] @returns {FirstPlace | null} */
export function firstPlace(app, ends = recent(app.store)) {
  const [tight] = waysOf(app).slice(0, app.ahead?.moving ? 1 : 2).flatMap((way) => placeOn(app, way) ?? []); // what lies behind is not next
  if (tight) return tight;
  const zone = worstOf(app.zones, ends);
  return zone && { ...zone, zone, sure: zone.confidence, way: '', sticksAt: NaN, first: '', places: 0, worst: null };
}

// Return top and length of the section that rig mode shows: the last metres with the bit, and the worst place. If the bit has
// been lifted far, what is below it does not count.
/** @param {App} app @returns {[top: number, length: number]} */
export function rigSection(app) {
  const { store, bit } = app;
  const ends = recent(store);
  const down = store.levels[0].pitch > 0;
  const worst = firstPlace(app, ends);
  const depth = bit ?? store.end;
  const [shallow, deep] = store.span;
  const lead = Math.abs(depth - store.end) > RECENT && (depth < shallow || depth > deep) ? store.end : depth; // the bit may be far from the wall
  const far = down ? (store.end - lead > RECENT / 2 ? lead : Math.max(store.end, lead)) : Math.min(store.end, lead);
  const top = Math.min(worst?.start ?? Infinity, down ? far - RECENT : far) - BEYOND;
  const bottom = Math.max(worst?.stop ?? -Infinity, down ? far : far + RECENT) + BEYOND;
  const length = Math.min(Math.ceil((bottom - top) / STEP) * STEP, longest(store));
  return [down ? bottom - length : top, length];
}

// Show rig mode, or hide it; its digits are in more.js.
/** @param {App} app */
export function writeRig(app) {
  const { view, store } = app;
  byId('rig').hidden = !view.rig || !store;
  document.body.classList.toggle('rig', view.rig);
  byId('rigOpen').textContent = view.rig ? 'Desk' : 'Rig';
  if (view.rig && store) late(app)?.writeDigits(app);
}
