// The address after # holds all that a colleague needs to see the same picture: the view (view.js) and the colours of the
// current quantity.

import { MAPS } from './color.js';
import { numbers } from './view.js';

/** @param {number} value */
const short = (value) => String(Number(value.toPrecision(5)));

/** @param {Pick<App, 'view' | 'selection'>} app */
export function toAddress({ view, selection: { quantity } }) {
  const parts = new URLSearchParams(view.toAddress().slice(1));
  if (quantity && Number.isFinite(quantity.low) && Number.isFinite(quantity.high)) {
    parts.set('range', `${short(quantity.low)}_${short(quantity.high)}`);
    parts.set('map', quantity.map);
    for (const name of /** @type {const} */ (['log', 'dynamic', 'inView'])) if (quantity[name]) parts.set(name, '1');
  }
  return `#${parts}`;
}

// Return what the reader looks at, as traits of the widget in a notebook.
/** @param {Pick<App, 'view'>} app */
export function looked({ view: { top, bottom, cursor, pinned } }) {
  return {
    depths: [top, bottom].map((depth) => Number(depth.toFixed(3))),
    cursor: pinned && cursor ? [cursor.depth, cursor.toolface] : null,
  };
}

// Apply the valid parts of an address: the view changes at once; the colours are returned for the wall's quantities.
/** @param {Pick<App, 'view'>} app @param {string} hash @returns {Colours | null} */
export function fromAddress({ view }, hash) {
  const parts = new URLSearchParams(hash.replace(/^#/, ''));
  view.fromAddress(hash);
  const [low, high] = numbers(parts.get('range'));
  const map = parts.get('map') ?? '';
  return low < high ? { low, high, chosen: true, log: parts.get('log') === '1', dynamic: parts.get('dynamic') === '1', inView: parts.get('inView') === '1', ...(MAPS[map] ? { map } : {}) } : null;
}
