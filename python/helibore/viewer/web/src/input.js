// Pointer, wheel, touch and keyboard. A drag along the tracks moves the section, a click holds the cursor, the wheel
// moves the section and, with Ctrl, zooms; a drag on the 3-D view turns it. Moving by hand stops following the bit; F resumes it.

import { Orbit } from './camera.js';
import { fitRange } from './color.js';
import { depthAt, HEAD, imageRects, inside, movable, tracksEnd } from './layout.js';
import { leftEdge } from './path.js';
import { fly, isInside, stepOf, toggleFlight, turnHead, unhold } from './inside.js';
import { byId } from './dom.js';
import { whenLate } from './late.js';
import { onString } from './string.js';
import { tabs } from './panel.js';
import { BREAKOUT } from './pick_fields.js';
import { CLASSES } from './picking.js';

const EDGE = 5; // pixels at the right edge of a head
// In pixels. curve: the largest distance from a curve at which a pointer hits it. crest: the largest distance, along a sine,
// from its crest or trough at which a drag changes the dip. click: the largest move of a click.
const MOUSE = { curve: 6, crest: 0, click: 4 };
const FINGER = { curve: 20, crest: 26, click: 10 };
/** @param {PointerEvent} event */
const precision = ({ pointerType }) => (pointerType === 'touch' ? FINGER : MOUSE);

// Return where a pointer is on the element that listens, in the element's own pixels: a page on 4K is enlarged.
/** @param {MouseEvent} event @returns {Pair} */
function placeOf({ currentTarget, clientX, clientY }) {
  const element = /** @type {HTMLElement} */ (currentTarget);
  const { left, top } = element.getBoundingClientRect();
  const zoom = element.currentCSSZoom ?? 1;
  return [(clientX - left) / zoom, (clientY - top) / zoom];
}

/** @param {App} app */
export function bindTracks(app) {
  const ink = byId('ink');
  /** @type {Map<number, Pair>} */
  const pointers = new Map();
  /** @type {{ string: number | null, head: { name: string, edge: boolean } | null, width: number, pick: Drag | null, x: number, y: number, top: number, moved: boolean, onMap: boolean, turn: number | null } | null} */
  let drag = null;
  const at = placeOf;
  ink.addEventListener('pointerdown', (event) => {
    const [x, y] = at(event);
    pointers.set(event.pointerId, [x, y]);
    ink.setPointerCapture(event.pointerId);
    const head = headAt(app.renderer.rects, x, y);
    if (pointers.size > 1) { // two fingers zoom: cancel what the first finger began
      app.picking.cancel();
      drag = null;
      return;
    }
    const { curve, crest } = precision(event);
    const aim = app.picking.on ? aimAt(app, x, y) : null;
  pull(app, x, y);
    const depth = app.store ? depthAt(app.view, app.renderer.rects.axis, y) : NaN;
    const string = app.renderer.straight && app.store && y > HEAD ? app.renderer.look() : null;
    drag = { string: string && onString(string, x, depth) ? (string.string?.bottom ?? NaN) - depth : null, head, width: head ? app.renderer.rects[head.name].width : 0, pick: aim && app.picking.grab(aim, reachOf(app, curve), (360 * crest) / app.renderer.rects.image.width), x, y, top: app.view.top, moved: false, onMap: inside(app.renderer.rects.map, x, y), turn: app.renderer.straight && inside(app.renderer.rects.wall, x, y) ? app.view.turn : null };
    if (drag.onMap && app.store) app.view.centre(app.renderer.map.depthAt(app.renderer.look(), y), app.store);
  });
  ink.addEventListener('pointermove', (event) => {
    if (!app.store) return;
    const [x, y] = at(event);
    if (pointers.size === 2 && pointers.has(event.pointerId)) return pinch(app, pointers, event.pointerId, [x, y]);
    if (!drag || event.buttons === 0) {
      const head = headAt(app.renderer.rects, x, y);
      ink.style.cursor = head?.edge ? 'col-resize' : head ? 'grab' : '';
      return hover(app, x, y);
    }
    drag.moved ||= Math.hypot(x - drag.x, y - drag.y) > precision(event).click;
    if (!drag.moved) return undefined;
    if (drag.head) return drag.head.edge ? app.view.widen(drag.head.name, drag.width + x - drag.x) : undefined;
    if (drag.onMap) return app.view.centre(app.renderer.map.depthAt(app.renderer.look(), y), app.store);
    if (drag.string !== null) return app.view.choose({ string: depthAt(app.view, app.renderer.rects.axis, y) + drag.string });
    const perPixel = app.view.length / app.renderer.rects.image.height;
    if (drag.pick) {
      const cursor = cursorAt(app, x, y);
      return cursor && app.picking.drag(drag.pick, { depth: cursor.depth, toolface: cursor.toolface ?? drag.pick.from.toolface });
    }
    if (drag.turn !== null && Math.abs(x - drag.x) > Math.abs(y - drag.y)) return app.view.turnTo(drag.turn - Math.round((x - drag.x) / 2), true);
    return app.view.show(drag.top - (y - drag.y) * perPixel, app.view.length, app.store);
  });
  /** @param {PointerEvent} event */
  const up = (event) => {
    pointers.delete(event.pointerId);
    app.picking.drop();
    if (drag?.head && drag.moved && !drag.head.edge) reorder(app, drag.head.name, at(event)[0]);
    if (drag && !drag.moved && !drag.onMap && event.type === 'pointerup') clickAt(app, ...at(event), reachOf(app, precision(event).curve));
    drag = null;
  };
  ink.addEventListener('pointerup', up);
  ink.addEventListener('pointercancel', up);
  ink.addEventListener('pointerleave', () => {
    if (!app.view.pinned && !drag) app.view.point(null);
  });
  ink.addEventListener('wheel', (event) => {
    wheel(app, event);
    if (app.store && !drag) hover(app, ...at(event)); // another depth is under the mouse now
  }, { passive: false });
}

// Return the track whose head is under the pointer, and whether the pointer is at the head's right edge: a drag there changes
// the width of the track, a drag elsewhere on the head changes the order of the tracks.
/** @param {Rects} rects @param {number} x @param {number} y */
function headAt(rects, x, y) {
  if (y >= HEAD) return null;
  const name = movable(rects).find((one) => x >= rects[one].left && x < rects[one].left + rects[one].width + EDGE);
  return name ? { name, edge: x > rects[name].left + rects[name].width - EDGE } : null;
}

/** @param {App} app @param {string} name @param {number} x */
function reorder({ view, renderer: { rects } }, name, x) {
  const others = movable(rects).filter((one) => one !== name);
  const at = others.filter((one) => rects[one].left + rects[one].width / 2 < x).length;
  view.arrange([...others.slice(0, at), name, ...others.slice(at)]);
}

/** @param {App} app @param {number} pixels */
const reachOf = ({ view, renderer: { rects } }, pixels) => (pixels * view.length) / rects.image.height; // metres along the hole

/** @param {App} app @param {number} x @param {number} y */
function hover(app, x, y) {
  if (app.view.pinned) return;
  pull(app, x, y);
  app.view.point(cursorAt(app, x, y));
}

/** @param {Pick<App, 'view' | 'path'> & { renderer: { rects: Rects } }} app @param {number} x @param {number} y @returns {Cursor | null} */
export function cursorAt({ view, renderer: { rects }, path }, x, y) {
  const tracks = { ...rects.axis, width: tracksEnd(rects) - rects.axis.left };
  if (!inside(tracks, x, y)) return null;
  const depth = depthAt(view, rects.axis, y);
  const image = imageRects(rects).find((rect) => inside(rect, x, y));
  if (!image) return { depth, toolface: view.cursor?.toolface ?? null };
  const turn = (x - image.left) / image.width;
  return { depth, toolface: (((leftEdge(path, view.cut, depth).toolface + 360 * turn) % 360) + 360) % 360 };
}

// Return the cursor if it is on an image, else null.
/** @param {App} app @param {number} x @param {number} y @returns {Aim | null} */
function aimAt(app, x, y) {
  const track = Object.keys(app.renderer.rects).find((name) => /^(image|beside)/.test(name) && inside(app.renderer.rects[name], x, y));
  const cursor = track ? /** @type {Aim | null} */ (cursorAt(app, x, y)) : null;
  return cursor && { ...cursor, image: (track === 'image' ? app.selection.quantity : app.selection.besides[Number(track?.slice(6))])?.name };
}

/** @param {App} app @param {number} x @param {number} y @param {number} reach */
function clickAt(app, x, y, reach) {
  const head = app.selection.besides.findIndex((_, i) => y < HEAD && inside({ ...app.renderer.rects[`beside${i}`], top: 0 }, x, y));
  if (head >= 0) return app.selection.setQuantity(app.selection.besides[head].id);
  if (app.view.string !== null && app.renderer.straight && onString(app.renderer.look(), x, depthAt(app.view, app.renderer.rects.axis, y))) return app.view.choose({ string: null }); // back to the bit
  const cursor = cursorAt(app, x, y);
  const aim = app.picking.on ? aimAt(app, x, y) : null;
  if (aim) {
    unhold(app, cursor);
    app.picking.click(aim, reach);
    if (isInside(app.view)) lookFrom(app, app.view.camera);
  }
  else if (cursor && app.view.pinned) unhold(app, cursor);
  else if (cursor) app.view.point(cursor, true);
}

// The curtain goes where the pointer is on the first image.
/** @param {App} app @param {number} x @param {number} y */
function pull({ view, renderer: { rects: { image } } }, x, y) {
  if (view.curtain !== null && inside(image, x, y)) view.choose({ curtain: (x - image.left) / image.width });
}

/** @param {App} app @param {WheelEvent} event */
function wheel(app, event) {
  if (!app.store) return;
  event.preventDefault();
  const { view, store, renderer: { rects } } = app;
  const steps = event.deltaY / (event.deltaMode === 1 ? 3 : 100);
  if (event.ctrlKey || event.metaKey) view.zoom(1.25 ** steps, depthAt(view, rects.image, placeOf(event)[1]), store);
  else view.show(view.top + steps * (isInside(view) && event.currentTarget === byId('orbit') ? stepOf(view, store) : 0.1 * view.length), view.length, store);
}

/** @param {App} app @param {Map<number, Pair>} pointers @param {number} id @param {Pair} now */
function pinch(app, pointers, id, now) {
  const apart = () => {
    const [a, b] = [...pointers.values()];
    return [Math.abs(a[1] - b[1]) + 40, (a[1] + b[1]) / 2];
  };
  const { view, store, renderer: { rects } } = app;
  const [before, from] = apart();
  pointers.set(id, now);
  const [after, middle] = apart();
  view.zoom(before / after, depthAt(view, rects.image, middle), store);
  if (!view.follow) view.show(view.top - ((middle - from) * view.length) / rects.image.height, view.length, store);
}

// Choose from where the hole is seen. From inside, the cursor is held on the selected pick, before which the eye then stands.
/** @param {App} app @param {View['camera']} camera */
function lookFrom({ view, store, picking: { pick } }, camera) {
  view.choose({ camera });
  if (!pick || !isInside(view)) return;
  const { depth, toolface } = pick;
  if (depth < view.top || depth > view.bottom) view.centre(depth, store);
  view.point({ depth, toolface: (toolface + (pick.kind === BREAKOUT ? 0 : 90)) % 360 }, true); // a plane is as deep there as in its middle
}

/** @param {App} app @param {Gpu} gpu */
export function bindOrbit(app, gpu) {
  const pane = byId('orbit');
  const controls = new Orbit(pane, gpu.outside, () => app.view.lookFrom([...gpu.outside.position, ...controls.target]));
  /** @type {Pair | null} */
  let waiting = null;
  pane.addEventListener('wheel', (event) => app.view.camera !== 'outside' && wheel(app, event), { passive: false });
  pane.addEventListener('pointermove', (event) => {
    if (event.buttons && app.view.camera !== 'outside') {
      if (controls.fingers.size > 1) fly(app, (20 * event.movementY) / pane.clientHeight);
      else turnHead(app.view.head, event.movementX, event.movementY);
      app.repaint();
    }
    if (event.buttons || app.view.pinned || !app.store) return;
    const place = placeOf(event);
    if (!waiting) {
      setTimeout(() => {
        if (waiting) app.renderer.pickAt(...waiting);
        waiting = null;
      }, 60);
    }
    waiting = place;
  });
  /** @type {Pair | null} */
  let pressed = null;
  pane.addEventListener('pointerdown', (event) => (pressed = placeOf(event)));
  pane.addEventListener('pointerup', (event) => {
    const [x, y] = placeOf(event);
    if (!pressed || Math.hypot(x - pressed[0], y - pressed[1]) > precision(event).click || event.button !== 0) return;
    app.renderer.pickAt(...pressed, true);
  });
  return controls;
}

/** @param {App} app */
export function bindControls(app) {
  const { view } = app;
  /** @template {string} Id @param {Id} id @param {string} event @param {(element: ElementOf<Id>) => unknown} act */
  const on = (id, event, act) => byId(id).addEventListener(event, () => act(byId(id)));
  for (const id of /** @type {const} */ (['cut', 'pass', 'units'])) on(id, 'change', ({ value }) => view.choose({ [id]: value }));
  on('camera', 'change', ({ value }) => lookFrom(app, /** @type {View['camera']} */ (value)));
  for (const id of /** @type {const} */ (['tube', 'shape', 'median'])) on(id, 'change', ({ value }) => view.choose({ [id]: Number(value) }));
  on('pass', 'change', ({ value }) => value === 'change' && app.selection.showChange());
  on('sectionLength', 'change', ({ value }) => app.selection.setLength(value));
  on('goTo', 'change', ({ valueAsNumber }) => app.selection.goTo(valueAsNumber));
  on('follow', 'click', () => app.selection.follow(!view.follow));
  on('rigOpen', 'click', () => app.selection.rig());
  on('menu', 'click', () => openMenu(!byId('bar').classList.contains('open')));
  for (const id of /** @type {const} */ (['dipOpen', 'rigOpen', 'replayOpen', 'theme', 'keys'])) on(id, 'click', () => openMenu(false));
  for (const tab of tabs()) tab.addEventListener('click', () => view.choose({ tab: tab.value }));
  on('theme', 'click', () => view.toggleTheme());
  on('fit', 'click', () => app.renderer.fit());
  on('fly', 'click', () => toggleFlight(app));
  on('whole', 'click', () => view.toggleWhole());
  on('keys', 'click', () => openHelp(app));
  on('copy', 'click', () => app.selection.copy());
  on('pin', 'click', () => app.selection.keepSection());
  on('quantity', 'change', ({ value }) => app.selection.setQuantity(value));
  on('map', 'change', ({ value: map }) => app.selection.setColours({ map }));
  on('log', 'change', ({ checked: log }) => app.selection.setColours({ log }));
  on('dynamic', 'change', ({ checked: dynamic }) => app.selection.setColours({ dynamic, inView: false }));
  on('inView', 'change', ({ checked: inView }) => app.selection.setColours({ inView, dynamic: false }));
  on('beside', 'click', () => app.selection.keepBeside());
  on('percentile', 'click', () => app.selection.setColours({ ...fitRange(app.selection.quantity, app.renderer.histogram.sorted), inView: false }));
  for (const end of /** @type {const} */ (['low', 'high'])) on(end, 'change', ({ value }) => app.selection.setEnd(end, Number(value)));
  bindHistogram(app);
}

/** @param {boolean} open */
function openMenu(open) {
  byId('bar').classList.toggle('open', open);
  byId('menu').setAttribute('aria-expanded', String(open));
}

/** @param {App} app */
function bindHistogram(app) {
  const canvas = app.renderer.histogram.canvas;
  /** @type {End | null} */
  let end = null;
  canvas.addEventListener('pointerdown', (event) => {
    const { selection: { quantity }, renderer: { histogram } } = app;
    if (!app.store || quantity.dynamic || quantity.inView) return;
    /** @param {End} name */
    const away = (name) => Math.abs(histogram.x(quantity[name], quantity) - placeOf(event)[0]);
    end = away('low') < away('high') ? 'low' : 'high';
    canvas.setPointerCapture(event.pointerId);
  });
  canvas.addEventListener('pointermove', (event) => {
    if (!end) return;
    const value = app.renderer.histogram.value(placeOf(event)[0], app.selection.quantity);
    const { low, high } = app.selection.quantity;
    if (end === 'low' ? value < high : value > low) app.selection.setColours({ [end]: value });
  });
  canvas.addEventListener('pointerup', () => (end = null));
}

// The browser scrolls to the dialog's button, at the bottom, to give it the focus: scroll back to the top.
/** @param {App} app */
const openHelp = (app) => whenLate(app, ({ HELP }) => {
  byId('help').innerHTML ||= HELP;
  byId('help').showModal();
  byId('help').scrollTop = 0;
});

/** @param {App} app */
export function bindKeys(app) {
  window.addEventListener('keydown', (event) => {
    const target = /** @type {HTMLElement} */ (event.target);
    const { tagName } = target;
    if (event.key === 'Enter' && tagName === 'INPUT' && !byId('note').open) target.blur(); // so that keys act on the page again
    const typing = /^(INPUT|SELECT|TEXTAREA)$/.test(tagName) || byId('help').open || byId('note').open;
    if (!typing && (event.ctrlKey || event.metaKey) && !event.altKey && /^[zy]$/i.test(event.key) && app.picking.on) {
      event.preventDefault();
      if (event.shiftKey || /y/i.test(event.key)) app.picking.redo();
      else app.picking.undo();
    }
    const name = event.key.length === 1 ? event.key.toLowerCase() : event.key; // caps lock or not
    if (typing || event.ctrlKey || event.metaKey || event.altKey || !(app.store || BEFORE.includes(name))) return;
    const act = KEYS[name] ?? (/^[1-9]$/.test(event.key) ? () => (app.picking.on ? app.picking.setClass(CLASSES[Number(event.key) - 1]) : app.selection.setQuantity(app.selection.quantities[Number(event.key) - 1]?.id)) : null);
    if (!act || (/^(Enter| )$/.test(event.key) && /^(BUTTON|SUMMARY|A)$/.test(tagName))) return;
    event.preventDefault();
    act(app);
  });
}

/** @type {(share: number) => (app: App) => void} */
const along = (share) => ({ view, store }) => view.show(view.top + share * view.length, view.length, store);
const BEFORE = ['k', 't', '?']; // keys that act before there is a wall
/** @type {Record<string, (app: App) => unknown>} */
const KEYS = {
  f: (app) => app.selection.follow(true),
  ' ': (app) => app.selection.follow(!app.view.follow),
  '[': ({ view, store }) => view.zoom(1 / 1.5, view.middle, store),
  ']': ({ view, store }) => view.zoom(1.5, view.middle, store),
  ArrowUp: (app) => app.picking.nudge(-1, 0) || (isInside(app.view) ? fly(app, 1) : app.selection.step(-app.view.length / 200, 0)),
  ArrowDown: (app) => app.picking.nudge(1, 0) || (isInside(app.view) ? fly(app, -1) : app.selection.step(app.view.length / 200, 0)),
  v: (app) => isInside(app.view) && toggleFlight(app),
  ArrowLeft: (app) => app.picking.nudge(0, -1) || app.selection.step(0, -360 / app.store.levels[0].sectors),
  ArrowRight: (app) => app.picking.nudge(0, 1) || app.selection.step(0, 360 / app.store.levels[0].sectors),
  Home: ({ view, store }) => view.show(store.span[0], view.length, store),
  End: ({ view, store }) => view.show(store.span[1] - view.length, view.length, store),
  '+': ({ view, store }) => view.zoom(1 / 1.5, view.cursor?.depth ?? view.middle, store),
  '-': ({ view, store }) => view.zoom(1.5, view.cursor?.depth ?? view.middle, store),
  PageUp: along(-0.9),
  PageDown: along(0.9),
  h: (app) => app.renderer.fit(),
  i: (app) => lookFrom(app, isInside(app.view) ? 'straight' : 'down'),
  o: ({ view }) => view.toggleWhole(),
  t: ({ view }) => view.toggleTheme(),
  c: (app) => app.selection.copy(),
  r: (app) => app.replay.toggle(),
  d: (app) => app.picking.toggle(),
  b: (app) => app.notes.open(),
  e: (app) => app.selection.keepBeside(),
  w: ({ view }) => view.choose({ curtain: view.curtain === null ? 0.5 : null }),
  x: (app) => app.selection.blink(),
  k: (app) => app.selection.rig(),
  a: (app) => app.view.rig && app.alarms.read(!app.alarms.whole),
  q: (app) => app.alarms.silence(),
  g: () => byId('goTo').select(),
  n: (app) => app.selection.jump(1),
  p: (app) => app.selection.jump(-1),
  s: (app) => app.selection.keepSection(),
  Enter: (app) => app.picking.keep(),
  Backspace: (app) => (app.picking.selected ? app.picking.remove() : app.picking.undo()),
  Delete: (app) => app.picking.remove(),
  Escape: (app) => (app.picking.on ? app.picking.leave() : unhold(app, null)),
  '?': openHelp,
};
