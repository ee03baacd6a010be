// The address after # holds all that a colleague needs to see the same picture: the view (view.js), the colours of the
// current quantity, the held cursor, the kept sections and the notes.

/** @param {number} value */
const short = (value) => String(Number(value.toPrecision(5)));

/** @param {Pick<App, 'view' | 'quantity' | 'notes'>} app */
export function toAddress({ view, quantity, notes }) {
  const parts = new URLSearchParams(view.toAddress().slice(1));
  if (quantity && Number.isFinite(quantity.low) && Number.isFinite(quantity.high)) {
    parts.set('range', `${short(quantity.low)}_${short(quantity.high)}`);
    parts.set('map', quantity.map);
    for (const name of /** @type {const} */ (['log', 'dynamic'])) if (quantity[name]) parts.set(name, '1');
  }
  if (view.pinned && view.cursor) parts.set('at', [view.cursor.depth.toFixed(3), ...(view.cursor.toolface === null ? [] : [view.cursor.toolface.toFixed(1)])].join('_'));
  if (view.pins.length) parts.set('sections', view.pins.map((depth) => depth.toFixed(3)).join('_'));
  if (notes.kept.length) parts.set('notes', notes.toAddress());
  return `#${parts}`;
}

// What the reader looks at, for a notebook.
/** @param {Pick<App, 'view'>} app */
export function looked({ view: { top, bottom, cursor, pinned } }) {
  return {
    depths: [top, bottom].map((depth) => Number(depth.toFixed(3))),
    cursor: pinned && cursor ? [cursor.depth, cursor.toolface] : null,
  };
}

/** @param {string | null} text */
const numbers = (text) => (text ? text.split('_').map(Number).filter(Number.isFinite) : []);

// Take what is valid; the colours wait in `app.colours` for the wall's quantities. True if a depth is named.
/** @param {App} app @param {string} hash @param {Record<string, unknown>} maps */
export function fromAddress(app, hash, maps) {
  const { view, notes } = app;
  const parts = new URLSearchParams(hash.replace(/^#/, ''));
  const [depth, toolface = null] = numbers(parts.get('at'));
  if (depth !== undefined) view.set({ cursor: { depth, toolface }, pinned: true });
  view.set({ pins: numbers(parts.get('sections')).slice(0, 3) });
  notes.fromAddress(parts.get('notes'));
  const [low, high] = numbers(parts.get('range'));
  const map = parts.get('map') ?? '';
  app.colours = low < high ? { low, high, chosen: true, log: parts.get('log') === '1', dynamic: parts.get('dynamic') === '1', ...(maps[map] ? { map } : {}) } : null;
  return view.fromAddress(hash);
}
