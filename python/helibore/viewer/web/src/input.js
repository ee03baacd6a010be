// Pointer, wheel, touch and keyboard. A drag along the tracks moves the section, a click holds the cursor, the wheel
// moves and, with Ctrl, zooms; a drag on the 3-D view turns it. Moving by hand stops following the bit; F resumes.

import { Orbit } from './camera.js';
import { fitRange } from './colour.js';
import { depthAt, HEAD, imageRects, inside, movable, tracksEnd } from './layout.js';
import { leftEdge } from './path.js';
import { turnHead } from './inside.js';
import { byId } from './panel.js';
import { CAMERAS } from './view.js';

const EDGE = 5; // pixels at the right edge of a head
const CURVE = 6; // pixels from a curve that still hit it
const CLICK = 4; // pixels a pointer may move and still click

// Where a pointer is on the element that listens, in the element's own pixels: a page on 4K is enlarged.
function placeOf({ currentTarget, clientX, clientY }) {
  const { left, top } = currentTarget.getBoundingClientRect();
  const zoom = currentTarget.currentCSSZoom ?? 1;
  return [(clientX - left) / zoom, (clientY - top) / zoom];
}

export function bindTracks(app) {
  const ink = byId('ink');
  const pointers = new Map();
  let drag = null;
  const at = placeOf;
  ink.addEventListener('pointerdown', (event) => {
    const [x, y] = at(event);
    pointers.set(event.pointerId, [x, y]);
    ink.setPointerCapture(event.pointerId);
    const head = headAt(app.rects, x, y);
    const cursor = app.picking.on && imageRects(app.rects).some((rect) => inside(rect, x, y)) ? cursorAt(app, x, y) : null;
    drag = { head, width: head && app.rects[head.name].width, pick: cursor && app.picking.grab(cursor, reachOf(app)), x, y, top: app.view.top, moved: false, onMap: inside(app.rects.map, x, y), turn: app.straight && inside(app.rects.wall, x, y) ? app.view.turn : null };
    if (drag.onMap && app.store) app.view.centre(app.map.depthAt(app.look(), y), app.store);
  });
  ink.addEventListener('pointermove', (event) => {
    if (!app.store) return;
    const [x, y] = at(event);
    if (pointers.size === 2 && pointers.has(event.pointerId)) return pinch(app, pointers, event.pointerId, [x, y]);
    if (!drag || event.buttons === 0) {
      const head = headAt(app.rects, x, y);
      ink.style.cursor = head?.edge ? 'col-resize' : head ? 'grab' : '';
      return hover(app, x, y);
    }
    drag.moved ||= Math.hypot(x - drag.x, y - drag.y) > CLICK;
    if (!drag.moved) return undefined;
    if (drag.head) return drag.head.edge ? app.view.set({ widths: { ...app.view.widths, [drag.head.name]: Math.max(64, Math.round(drag.width + x - drag.x)) } }) : undefined;
    if (drag.onMap) return app.view.centre(app.map.depthAt(app.look(), y), app.store);
    const perPixel = app.view.length / app.rects.image.height;
    if (drag.pick) {
      const cursor = cursorAt(app, x, y);
      return cursor && app.picking.drag(drag.pick, cursor);
    }
    if (drag.turn !== null && Math.abs(x - drag.x) > Math.abs(y - drag.y)) return app.view.set({ turn: (((drag.turn - Math.round((x - drag.x) / 2)) % 360) + 360) % 360 });
    return app.view.show(drag.top - (y - drag.y) * perPixel, app.view.length, app.store);
  });
  const up = (event) => {
    pointers.delete(event.pointerId);
    app.picking.drop();
    if (drag?.head && drag.moved && !drag.head.edge) reorder(app, drag.head.name, at(event)[0]);
    if (drag && !drag.moved && !drag.onMap && event.type === 'pointerup') clickAt(app, ...at(event));
    drag = null;
  };
  ink.addEventListener('pointerup', up);
  ink.addEventListener('pointercancel', up);
  ink.addEventListener('pointerleave', () => {
    if (!app.view.pinned && !drag) app.view.set({ cursor: null });
  });
  ink.addEventListener('wheel', (event) => wheel(app, event), { passive: false });
}

// The head of a track under the pointer, and whether it is at its right edge: a drag there changes the width, else the order.
function headAt(rects, x, y) {
  if (y >= HEAD) return null;
  const name = movable(rects).find((one) => x >= rects[one].left && x < rects[one].left + rects[one].width + EDGE);
  return name ? { name, edge: x > rects[name].left + rects[name].width - EDGE } : null;
}

function reorder({ view, rects }, name, x) {
  const others = movable(rects).filter((one) => one !== name);
  const at = others.filter((one) => rects[one].left + rects[one].width / 2 < x).length;
  view.set({ order: [...others.slice(0, at), name, ...others.slice(at)] });
}

const reachOf = ({ view, rects }) => (CURVE * view.length) / rects.image.height; // metres within which a curve is hit

function hover(app, x, y) {
  if (app.view.pinned) return;
  app.view.set({ cursor: cursorAt(app, x, y) });
}

export function cursorAt({ view, rects, path }, x, y) {
  const tracks = { ...rects.axis, width: tracksEnd(rects) - rects.axis.left };
  if (!inside(tracks, x, y)) return null;
  const depth = depthAt(view, rects.axis, y);
  const image = imageRects(rects).find((rect) => inside(rect, x, y));
  if (!image) return { depth, toolface: view.cursor?.toolface ?? null };
  const turn = (x - image.left) / image.width;
  return { depth, toolface: (((leftEdge(path, view.cut, depth).toolface + 360 * turn) % 360) + 360) % 360 };
}

function clickAt(app, x, y) {
  const head = app.besides.findIndex((_, i) => y < HEAD && inside({ ...app.rects[`beside${i}`], top: 0 }, x, y));
  if (head >= 0) return swap(app, app.besides[head].id);
  const cursor = cursorAt(app, x, y);
  if (!cursor) return;
  if (app.picking.on && imageRects(app.rects).some((rect) => inside(rect, x, y))) app.picking.click(cursor, reachOf(app));
  else app.view.set({ cursor, pinned: !app.view.pinned });
}

// A click on the head of an image beside makes it the first; that one takes its place.
function swap({ view, quantity }, id) {
  view.set({ quantity: id, beside: view.beside.map((one) => (one === id ? quantity.id : one)) });
}

function wheel(app, event) {
  if (!app.store) return;
  event.preventDefault();
  const { view, store, rects } = app;
  const steps = event.deltaY / (event.deltaMode === 1 ? 3 : 100);
  if (event.ctrlKey || event.metaKey) view.zoom(1.25 ** steps, depthAt(view, rects.image, placeOf(event)[1]), store);
  else view.show(view.top + steps * view.length * 0.1, view.length, store);
}

function pinch(app, pointers, id, now) {
  const apart = () => {
    const [a, b] = [...pointers.values()];
    return [Math.abs(a[1] - b[1]) + 40, (a[1] + b[1]) / 2];
  };
  const [before] = apart();
  pointers.set(id, now);
  const [after, middle] = apart();
  app.view.zoom(before / after, depthAt(app.view, app.rects.image, middle), app.store);
}

export function bindOrbit(app) {
  const pane = byId('orbit');
  const controls = new Orbit(pane, app.gpu.outside, app.redraw);
  let waiting = null;
  pane.addEventListener('wheel', (event) => app.view.camera !== 'outside' && wheel(app, event), { passive: false });
  pane.addEventListener('pointermove', (event) => {
    if (event.buttons && app.view.camera !== 'outside') {
      turnHead(app.gpu.head, event.movementX, event.movementY);
      app.redraw();
    }
    if (event.buttons || app.view.pinned || !app.store) return;
    const place = placeOf(event);
    if (!waiting) {
      setTimeout(() => {
        app.pickAt(...waiting);
        waiting = null;
      }, 60);
    }
    waiting = place;
  });
  let pressed = null;
  pane.addEventListener('pointerdown', (event) => (pressed = placeOf(event)));
  pane.addEventListener('pointerup', (event) => {
    const [x, y] = placeOf(event);
    const clicked = pressed && Math.hypot(x - pressed[0], y - pressed[1]) <= CLICK;
    if (!clicked || event.button !== 0) return;
    app.view.pinned = false;
    app.pickAt(...pressed);
    app.view.set({ pinned: app.view.cursor !== null });
  });
  return controls;
}

export function bindControls(app) {
  const { view } = app;
  const on = (id, event, act) => byId(id).addEventListener(event, act);
  for (const id of ['cut', 'pass', 'units', 'camera']) on(id, 'change', ({ target }) => view.set({ [id]: target.value }));
  for (const id of ['tube', 'shape', 'median']) on(id, 'change', ({ target }) => view.set({ [id]: Number(target.value) }));
  on('pass', 'change', ({ target }) => target.value === 'change' && app.setQuantity('change'));
  on('sectionLength', 'change', ({ target }) => app.setLength(target.value));
  on('follow', 'click', () => app.follow(!view.follow));
  on('rigOpen', 'click', () => app.rig());
  on('menu', 'click', ({ currentTarget }) => currentTarget.setAttribute('aria-expanded', String(byId('bar').classList.toggle('open'))));
  for (const tab of byId('tabs').children) tab.addEventListener('click', () => view.set({ tab: tab.value }));
  on('theme', 'click', () => view.set({ theme: view.theme === 'dark' ? 'light' : 'dark' }));
  on('fit', 'click', () => app.fit());
  on('keys', 'click', () => byId('help').showModal());
  on('copy', 'click', () => app.copy());
  on('pin', 'click', () => app.keepSection());
  on('quantity', 'change', ({ target }) => app.setQuantity(target.value));
  on('map', 'change', ({ target }) => app.setColours({ map: target.value }));
  on('log', 'change', ({ target }) => app.setColours({ log: target.checked }));
  on('dynamic', 'change', ({ target }) => app.setColours({ dynamic: target.checked }));
  on('beside', 'click', () => app.keepBeside());
  on('percentile', 'click', () => app.setColours(fitRange(app.quantity, app.histogram.sorted)));
  for (const end of ['low', 'high']) on(end, 'change', ({ target }) => app.setEnd(end, Number(target.value)));
  bindHistogram(app);
}

function bindHistogram(app) {
  const canvas = app.histogram.canvas;
  let end = null;
  canvas.addEventListener('pointerdown', (event) => {
    const { quantity, histogram } = app;
    if (!app.store || quantity.dynamic) return;
    const away = (name) => Math.abs(histogram.x(quantity[name], quantity) - placeOf(event)[0]);
    end = away('low') < away('high') ? 'low' : 'high';
    canvas.setPointerCapture(event.pointerId);
  });
  canvas.addEventListener('pointermove', (event) => {
    if (!end) return;
    const value = app.histogram.value(placeOf(event)[0], app.quantity);
    const { low, high } = app.quantity;
    if (end === 'low' ? value < high : value > low) app.setColours({ [end]: value });
  });
  canvas.addEventListener('pointerup', () => (end = null));
}

export function bindKeys(app) {
  window.addEventListener('keydown', (event) => {
    const { tagName } = /** @type {HTMLElement} */ (event.target);
    const typing = /^(INPUT|SELECT|TEXTAREA)$/.test(tagName) || byId('help').open || byId('note').open;
    if (typing || event.ctrlKey || event.metaKey || event.altKey || !app.store) return;
    const act = KEYS[event.key] ?? (/^[1-9]$/.test(event.key) ? () => app.setQuantity(app.quantities[Number(event.key) - 1]?.id) : null);
    if (!act || (/^(Enter| )$/.test(event.key) && tagName === 'BUTTON')) return;
    event.preventDefault();
    act(app);
  });
}

const next = (names, name) => names[(names.indexOf(name) + 1) % names.length];
const along = (share) => ({ view, store }) => view.show(view.top + share * view.length, view.length, store);
const KEYS = {
  f: (app) => app.follow(true),
  ' ': (app) => app.follow(!app.view.follow),
  '[': ({ view, store }) => view.zoom(1 / 1.5, view.middle, store),
  ']': ({ view, store }) => view.zoom(1.5, view.middle, store),
  ArrowUp: (app) => app.step(-app.view.length / 200, 0),
  ArrowDown: (app) => app.step(app.view.length / 200, 0),
  ArrowLeft: (app) => app.step(0, -360 / app.store.levels[0].sectors),
  ArrowRight: (app) => app.step(0, 360 / app.store.levels[0].sectors),
  Home: ({ view, store }) => view.show(store.span[0], view.length, store),
  End: ({ view, store }) => view.show(store.span[1] - view.length, view.length, store),
  '+': ({ view, store }) => view.zoom(1 / 1.5, view.cursor?.depth ?? view.middle, store),
  '-': ({ view, store }) => view.zoom(1.5, view.cursor?.depth ?? view.middle, store),
  PageUp: along(-0.9),
  PageDown: along(0.9),
  h: (app) => app.fit(),
  i: ({ view }) => view.set({ camera: next(Object.keys(CAMERAS), view.camera) }),
  t: ({ view }) => view.set({ theme: view.theme === 'dark' ? 'light' : 'dark' }),
  c: (app) => app.copy(),
  p: (app) => app.keepSection(),
  r: (app) => app.replay.toggle(),
  d: (app) => app.picking.toggle(),
  b: (app) => app.notes.open(),
  e: (app) => app.keepBeside(),
  k: (app) => app.rig(),
  a: (app) => app.alarms.silence(),
  n: (app) => app.jump(1),
  N: (app) => app.jump(-1),
  Enter: (app) => app.picking.keep(),
  Backspace: (app) => (app.picking.selected ? app.picking.remove() : app.picking.undo()),
  Delete: (app) => app.picking.remove(),
  Escape: ({ view, picking }) => (picking.on ? picking.toggle(false) : view.set({ cursor: null, pinned: false })),
  '?': () => byId('help').showModal(),
};
