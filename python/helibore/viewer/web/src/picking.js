// Picking on the image. A plane: drag along a bed or fracture, or click three points or more and press Enter; the plane is fitted
// to them. A breakout: drag a box. A new pick is selected; a click selects another. A digit sets the class of the selected pick and
// of the next one. A drag on the selected pick moves it; at the crest or trough of a sine, a drag changes the dip. The server holds the picks of the wall, and saves them beside the wall; every page shows them.
// A change stays here until the server has taken it, and is sent again until then. An exported file holds its own picks.

import definition from '../../../base/color_maps.json' with { type: 'json' };
import { messageOf } from './errors.js';
import { fitPlane, planeDepth, planeOf } from './dips.js';
import { late } from './late.js';
import { byId, hide, options } from './dom.js';
import { BREAKOUT, counted, FIELDS, unitOfField } from './pick_fields.js';
import { download } from './saving.js';
import { showDepth, showSpan } from './units.js';

export const NOTE = 'note';
export const CLASSES = /** @type {(PlaneKind | 'breakout')[]} */ (Object.keys(definition.picks));
const MOST = 5000;
const HANDLE = 20; // degrees around the crest or the trough of a sine in which a drag changes its dip
const LEAST = { opening: 5, height: 0.02, turn: 90 }; // of a box that is dragged; degrees that a trace is dragged along
const TRACE = 3; // degrees between two points of a trace
const PATIENCE = { answer: 15_000, again: 5000 }; // milliseconds: for an answer of the server, before a change is sent again
const AROUND = Array.from({ length: 12 }, (_, i) => 30 * i);
const BESIDE = 0.25; // metres along the hole, above and below a place: grooves are narrower
// The image of a pick, as the server takes it: at most 80 characters.
/** @param {string} [image] */
const onImage = (image) => (image ? { image: image.slice(0, 80) } : {});
const WORDS = Object.fromEntries([...FIELDS.plane, ...FIELDS.breakout]);
/** @param {number} degrees */
const turned = (degrees) => ((degrees % 360) + 360) % 360;
// Return over how many degrees points reach: all around, less the widest gap.
/** @param {WallPoint[]} points */
function spanOf(points) {
  const angles = points.map(({ toolface }) => turned(toolface)).sort((a, b) => a - b);
  return 360 - Math.max(...angles.map((angle, i) => (i ? angle - angles[i - 1] : 360 + angle - angles[angles.length - 1])));
}
/** @param {number} a @param {number} b */
const apart = (a, b) => Math.abs(turned(a - b + 180) - 180);

// Return the radius at which a plane through a place is seen. A line of sight from the axis enters a groove at the wall beside it,
// not at its ground, and the edge of a washout at its narrower side: so it is the lower quartile of the radii above and below.
/** @param {Store} store @param {number} k */
function rimOf(store, k) {
  const { sectors, pitch } = store.levels[0];
  const most = Math.floor(BESIDE / Math.abs(pitch));
  const radii = Array.from({ length: 2 * most + 1 }, (_, i) => store.vertex(k + (i - most) * sectors)?.radius ?? NaN).filter(Number.isFinite).sort((a, b) => a - b);
  return radii[Math.floor(radii.length / 4)];
}

export class Picking {
  on = false;
  kind = CLASSES[0]; // of the next pick
  /** @type {WallPoint[]} */
  points = []; // of the plane that is being picked
  /** @type {WallPick[]} */
  kept = []; // the picks of the wall, without notes
  /** @type {Note[]} */
  notes = [];
  /** @type {Map<string, SavedPick>} */
  served = new Map(); // as the server has them
  /** @type {Map<string, SavedPick>} */
  saved = new Map(); // the server's picks with the changes that the server has not taken yet; a dragged pick is in it as before the drag
  /** @type {Unsaved} */
  unsaved = new Map(); // what the server has not taken yet: a pick, or null where it is deleted
  /** @type {Map<string, Unsaved>} */
  ofWalls = new Map(); // the unsaved changes of every wall that this page has shown
  wall = ''; // well and file of the picks
  file = '';
  saves = true; // false: the folder of the file cannot be written
  sending = false;
  trouble = ''; // why the last change was not taken
  /** @type {PickChange[][]} */
  changes = []; // made here, for undo
  /** @type {PickChange[][]} */
  undone = []; // taken back, for redo; a new change empties it
  /** @type {PickChange[] | null} */
  opened = null; // the step that removes the picks of the table opened last, or adds them again
  /** @type {string | null} */
  selected = null; // key of the selected pick
  /** @type {WallPick | null} */
  dragged = null;
  /** @type {WeakMap<WallPick, { version: number, plane: Plane }>} */
  planesOf = new WeakMap();

  /** @param {App} app */
  constructor(app) {
    this.app = app;
    options('pickClass', CLASSES.map((name, i) => [name, `${i + 1} ${name}${['', ', open', ', closed'][i] ?? ''}`]));
    /** @type {(id: string, act: (event: Event) => void) => void} */
    const click = (id, act) => byId(id).addEventListener('click', act);
    click('dipOpen', () => this.toggle());
    click('dipKeep', () => this.keep());
    click('dipUndo', () => this.undo());
    click('dipRedo', () => this.redo());
    click('dipRemove', () => this.remove());
    click('dipClose', () => this.toggle(false));
    click('dipSave', () => download(app, this.address('picks.csv'), 'The picks were'));
    click('dipPrint', () => byId('print').click());
    click('dipLoad', () => byId('dipFile').click());
    byId('dipFile').addEventListener('change', () => this.load(byId('dipFile')));
    byId('pickClass').addEventListener('change', () => this.setClass(/** @type {PlaneKind | 'breakout'} */ (byId('pickClass').value)));
    byId('pickFields').addEventListener('input', ({ target }) => (/** @type {HTMLInputElement} */ (target).dataset.typing = ''));
    for (const event of ['change', 'focusout']) {
      byId('pickFields').addEventListener(event, ({ target }) => {
        const field = /** @type {HTMLInputElement} */ (target);
        delete field.dataset.typing;
        if (event === 'change') this.setField(field);
      });
    }
  }

  // Begin a wall. Changes that wait belong to the wall on which they were made, and are kept for that wall.
  /** @param {{ well: string, picks_file?: string | null, saves_picks?: boolean }} handshake */
  begin({ well, picks_file: file, saves_picks: saves = true }) {
    const wall = JSON.stringify([well, file]);
    Object.assign(this, { file: file ?? '', saves });
    if (wall === this.wall) return;
    if (this.unsaved.size) this.app.notice(`${counted(this.unsaved.size, 'change')} of ${JSON.parse(this.wall)[0] || 'another wall'} not saved: this is another wall. They are sent when theirs is back.`, 10);
    const unsaved = this.ofWalls.get(wall) ?? new Map();
    this.ofWalls.set(wall, unsaved);
    Object.assign(this, { wall, unsaved, served: new Map(), changes: [], undone: [] });
  }

  // Take the picks of the server, or of an exported file.
  /** @param {SavedPick[]} picks */
  receive(picks) {
    this.served = new Map(picks.map((pick) => [pick.key, pick]));
    this.show();
    this.app.repaint();
    this.app.openSaved();
    this.sendUnsaved();
  }

  // Show the picks of the server with the changes that the server has not taken yet, and the pick that is dragged.
  show() {
    const { dragged } = this;
    this.saved = new Map(this.served);
    for (const [key, pick] of this.unsaved) {
      if (pick) this.saved.set(key, pick);
      else this.saved.delete(key);
    }
    const all = [...this.saved.values()];
    this.notes = /** @type {Note[]} */ (all.filter(({ kind }) => kind === NOTE));
    this.kept = /** @type {WallPick[]} */ (all.filter(({ kind }) => kind !== NOTE)).map((pick) => (pick.key === dragged?.key ? dragged : pick));
    if (!this.pick) this.selected = null;
    this.app.redraw();
  }

  // Whether a change of any wall waits for its server.
  get waits() {
    return [...this.ofWalls.values()].some(({ size }) => size > 0);
  }

  // The selected pick.
  get pick() {
    return this.kept.find(({ key }) => key === this.selected) ?? null;
  }

  // The picks that are drawn: all, or none where they are switched off.
  get drawn() {
    return this.on || this.app.view.picks === 'on' ? this.kept : [];
  }

  get boxes() {
    return this.drawn.filter((pick) => pick.kind === BREAKOUT);
  }

  get shown() {
    return this.on || this.drawn.some(({ kind }) => kind !== BREAKOUT);
  }

  toggle(on = !this.on) {
    this.on = on;
    if (!on) Object.assign(this, { points: [], selected: null });
    byId('dipOpen').classList.toggle('on', on);
    hide(!on, 'dips');
    this.writeSaved();
    document.body.classList.toggle('picking', on);
    if (on) {
      if (!this.saves) this.app.notice(this.notSaved, 15);
      this.app.view.release();
      this.app.view.choose({ follow: false, tab: 'log', picks: 'on' });
    }
    this.app.repaint();
  }

  // Deselect the pick, or drop the points of the next pick; if there is neither, end picking.
  leave() {
    if (!this.selected && !this.points.length) {
      this.app.notice('Picking ended: D picks again, digits choose the colours', 8);
      return this.toggle(false);
    }
    Object.assign(this, { points: [], selected: null });
    return this.app.redraw();
  }

  // Return a point of the wall with the radius of the wall around it; where no radius is measured, with bit radius, and the card says so.
  // `seen` is whether anything was measured there.
  /** @param {Aim} aim @returns {WallPoint} */
  point({ depth, toolface, image }) {
    const { store } = this.app;
    const vertex = store.basis === 'gauge' ? null : store.near(depth, toolface);
    const has = (/** @type {number} */ i) => Number.isFinite(store.attributeAt(i, { depth, toolface }));
    const own = store.attributes.findIndex(({ name }) => name === image);
    const seen = own >= 0 ? has(own) : vertex !== null || store.attributes.some((_, i) => has(i));
    return { depth, toolface, radius: vertex ? rimOf(store, vertex.k) : store.bitRadius, measured: vertex !== null, seen, ...onImage(image) };
  }

  // Return the plane of a kept pick on the present path.
  /** @param {PlanePick} pick */
  plane(pick) {
    const { path, store } = this.app;
    let known = this.planesOf.get(pick);
    if (known?.version !== path.version) {
      known = { version: path.version, plane: planeOf(path, pick, store.bitRadius) };
      this.planesOf.set(pick, known);
    }
    return known.plane;
  }

  // Return the kept pick whose curve passes within `reach` metres of the cursor, or whose box holds the cursor; of several, the
  // selected pick. Return null if there is none.
  /** @param {Aim} aim @param {number} reach */
  near({ depth, toolface }, reach) {
    /** @param {WallPick} pick */
    const hit = (pick) => (pick.kind === BREAKOUT
      ? Math.abs(depth - pick.depth) < pick.height / 2 && apart(2 * toolface, 2 * pick.toolface) < pick.opening
      : Math.abs(planeDepth(this.app.path, this.plane(pick), toolface) - depth) < reach);
    const found = this.kept.filter(hit);
    return found.find(({ key }) => key === this.selected) ?? found[0] ?? null;
  }

  // Handle a click on the image: on a pick it selects the pick; elsewhere it deselects and adds a point.
  /** @param {Aim} cursor @param {number} reach */
  click(cursor, reach) {
    const found = this.points.length ? null : this.near(cursor, reach);
    this.selected = found?.key ?? null;
    if (!found && this.kind !== BREAKOUT) Object.assign(this, { points: [...this.points, this.point(cursor)], undone: [] });
    this.app.redraw();
  }

  // Begin a drag on the image: it moves a pick, draws a sine or a box, or is not for picking (null). `handle` is how many
  // degrees around the crest or the trough of a sine a drag changes its dip. Only the selected pick is moved.
  /** @param {Aim} from @param {number} reach @param {number} [handle] @returns {Drag | null} */
  grab(from, reach, handle = 0) {
    if (this.points.length) return null;
    const pick = this.near(from, reach);
    if (!pick || pick.key !== this.selected) return this.kind === BREAKOUT ? { act: 'box', from } : { act: 'sine', from, trace: new Map([[NaN, this.point(from)]]) };
    const crest = [0, 180].find((turn) => apart(from.toolface, pick.toolface + turn) < Math.max(HANDLE, handle));
    return pick.kind === BREAKOUT || crest === undefined ? { act: 'move', from, pick } : { act: 'dip', from, pick, crest };
  }

  // Continue a drag to a place on the image; `drag.pick` is the pick as it was when the drag began.
  /** @param {Drag} drag @param {Aim} aim */
  drag(drag, { depth, toolface }) {
    const { from } = drag;
    if (drag.act === 'sine') return this.drawSine(drag.trace, { ...from, depth, toolface });
    if (drag.act === 'box') {
      const opening = apart(toolface, from.toolface);
      const middle = turned(from.toolface + (turned(toolface - from.toolface + 180) - 180) / 2);
      this.dragged = { key: this.dragged?.key ?? newKey(), kind: BREAKOUT, depth: (depth + from.depth) / 2, toolface: middle, height: Math.abs(depth - from.depth), opening: Math.min(180, opening), ...onImage(from.image) };
    } else if (drag.act === 'dip') {
      const { pick, crest } = drag;
      const slope = Math.tan((pick.apparent_dip * Math.PI) / 180) + ((crest ? from.depth - depth : depth - from.depth) / (pick.radius ?? this.app.store.bitRadius));
      this.dragged = { ...pick, toolface: turned(pick.toolface + toolface - from.toolface), apparent_dip: (Math.atan(Math.max(0, slope)) * 180) / Math.PI };
    } else {
      const { pick } = drag;
      const [top, bottom] = this.app.store.span;
      this.dragged = { ...pick, depth: Math.min(bottom, Math.max(top, pick.depth + depth - from.depth)), ...(pick.kind === BREAKOUT && { toolface: turned(pick.toolface + toolface - from.toolface) }) };
    }
    this.selected = this.dragged.key;
    return this.replace(this.dragged);
  }

  // Fit the plane to the trace of a drag: one point every TRACE degrees, the last one drawn there.
  /** @param {Map<number, WallPoint>} trace @param {Aim} to */
  drawSine(trace, to) {
    trace.set(Math.round(to.toolface / TRACE) % (360 / TRACE), this.point(to));
    const points = [...trace.values()];
    const plane = spanOf(points) < LEAST.turn ? null : fitPlane(this.app.path, points);
    if (!plane) return this.cancel();
    this.dragged = { ...this.made(plane, points), key: this.dragged?.key ?? newKey() };
    this.selected = this.dragged.key;
    return this.replace(this.dragged);
  }

  // End a drag, and save what it made or changed.
  drop() {
    const made = this.dragged;
    if (!made) return;
    if (made.kind === BREAKOUT && (made.opening < LEAST.opening || made.height < LEAST.height)) return this.cancel();
    this.dragged = null;
    const before = this.saved.get(made.key);
    if (this.put(made) && before) this.report(before.depth === made.depth ? 'changed' : `moved by ${showDepth(Math.abs(made.depth - before.depth), this.app.view.units)}`, made);
  }

  // Say what a gesture or a key did to a pick that was there before.
  /** @param {string} what @param {WallPick} pick */
  report(what, { kind, depth }) {
    this.app.notice(`${kind} at ${showDepth(depth, this.app.view.units)}: ${what}. Ctrl Z takes it back.`, 6);
  }

  // End a drag without effect.
  cancel() {
    const { dragged } = this;
    this.dragged = null;
    if (!dragged) return;
    const before = /** @type {WallPick | undefined} */ (this.saved.get(dragged.key));
    this.replace(before ?? dragged, !before);
    if (!before) this.selected = null;
  }

  // Show a pick in place of the pick with the same key; `gone`: remove it.
  /** @param {WallPick} pick @param {boolean} [gone] */
  replace(pick, gone = false) {
    const known = this.kept.some(({ key }) => key === pick.key);
    if (gone) this.kept = this.kept.filter(({ key }) => key !== pick.key);
    else this.kept = known ? this.kept.map((one) => (one.key === pick.key ? pick : one)) : [...this.kept, pick];
    this.app.redraw();
  }

  // Save a new or changed pick, and select it; return false if it lies outside the wall, or if there are too many picks.
  /** @param {WallPick} given */
  put(given) {
    const { span } = this.app.store;
    const { units } = this.app.view;
    const before = this.saved.get(given.key);
    const pick = given.kind === BREAKOUT ? given : { ...given, ...this.measured(given, before) };
    const outside = pick.depth !== before?.depth && (pick.depth < span[0] || pick.depth > span[1]);
    const tooMany = !before && this.saved.size >= MOST;
    if (outside || tooMany) {
      this.show();
      this.app.notice(outside ? `${showDepth(pick.depth, units)} is outside the wall, ${showSpan(span[0], span[1], units)}` : `There are ${MOST} picks, as many as a wall has. This one was not kept: ${showDepth(pick.depth, units)}`, 10);
      return false;
    }
    this.selected = pick.key;
    if (!before && this.seen(pick)) this.report(pick.kind === BREAKOUT ? 'kept' : late(this.app)?.inWords(this.plane(pick), this.app.path) ?? 'kept', pick);
    else if (!before) this.app.notice(`${pick.image ? `${pick.image}: nothing` : 'Nothing'} was measured where this was picked, ${showDepth(pick.depth, units)}`, 10);
    this.change([{ key: pick.key, pick }]);
    return true;
  }

  // Return of a plane what is not by its fit: how sure it is where it was changed by hand, and how far a fracture is open.
  /** @param {PlanePick} pick @param {SavedPick} [before] @returns {Partial<PlanePick>} */
  measured(pick, before) {
    const plane = this.plane(pick);
    const old = /** @type {PlanePick} */ (before ?? pick);
    const tilted = old.toolface !== pick.toolface || old.apparent_dip !== pick.apparent_dip;
    return {
      ...((tilted || old.depth !== pick.depth) && { misfit: 0, points: 0 }),
      ...(tilted && this.sureness(plane)),
      aperture: (pick.kind !== 'bed' && late(this.app)?.openingOf(this.app.store, plane)?.opening) || null,
    };
  }

  // Return whether anything was measured along a pick.
  /** @param {WallPick} pick */
  seen(pick) {
    const along = pick.kind === BREAKOUT ? [pick] : AROUND.map((toolface) => ({ depth: planeDepth(this.app.path, this.plane(pick), toolface), toolface }));
    const { image } = pick;
    return along.some((place) => this.point({ ...place, image }).seen);
  }

  remove(pick = this.pick) {
    if (pick) this.change([{ key: pick.key, pick: null }]);
  }

  // Change picks here and at the server, as one step; null deletes a pick. Undo takes the step back.
  /** @param {PickChange[]} step @param {PickChange[][]} [to] */
  change(step, to) {
    const before = step.map(({ key }) => ({ key, pick: this.saved.get(key) ?? null }));
    if (!to) this.undone = [];
    (to ?? this.changes).push(before);
    for (const { key, pick } of step) {
      if (!this.app.contents) this.unsaved.set(key, pick);
      else if (pick) this.served.set(key, pick);
      else this.served.delete(key);
    }
    this.show();
    this.sendUnsaved();
    this.app.repaint();
  }

  // Take back the last point, or the last change of a pick.
  undo() {
    if (this.points.pop()) this.app.redraw();
    else this.restore(this.changes, this.undone);
  }

  // Make again the last change that was taken back.
  redo() {
    this.restore(this.undone, this.changes);
  }

  // Apply the last step of one list (undo or redo); the other list gets the reverse step.
  /** @param {PickChange[][]} from @param {PickChange[][]} to */
  restore(from, to) {
    const step = from.pop();
    if (!step) return;
    this.change(step, to);
    if (step !== this.opened) return;
    this.opened = to[to.length - 1];
    this.app.notice(`${to === this.undone ? 'Undone' : 'Redone'}: ${counted(step.length)} of the opened table`, 5);
  }

  keep() {
    const plane = fitPlane(this.app.path, this.points);
    if (!plane || this.kind === BREAKOUT) return;
    const pick = this.made(plane, this.points);
    if (this.put(pick)) this.points = [];
  }

  // Return a new pick of a plane through points of the wall.
  /** @param {Plane} plane @param {WallPoint[]} points @returns {PlanePick} */
  made(plane, points) {
    const { depth, deepest, apparent, radius, misfit } = plane;
    const measured = points.some((point) => point.measured);
    return { key: newKey(), kind: /** @type {PlaneKind} */ (this.kind), depth, toolface: deepest, apparent_dip: apparent, radius: measured ? radius : null, misfit, points: points.length, ...onImage(points[0].image), ...this.sureness(plane, points) };
  }

  // Return how sure a plane is that was drawn on the image as it is shown.
  /** @param {Plane} plane @param {WallPoint[]} [points] */
  sureness(plane, points = []) {
    const { path, view, renderer: { rects: { image } } } = this.app;
    return late(this.app)?.surenessOf(path, plane, points, [view.length / image.height, 360 / image.width]);
  }

  // Set the class of the selected pick and of the next one; a plane cannot become a breakout, nor the other way: only the next one is.
  /** @param {PlaneKind | 'breakout'} kind */
  setClass(kind) {
    const { pick, app: { view } } = this;
    if (!kind) return;
    this.kind = kind;
    if (pick && (pick.depth < view.top || pick.depth > view.bottom || (pick.kind === BREAKOUT) !== (kind === BREAKOUT))) this.selected = null; // what is out of view does not change
    else if (pick && pick.kind !== kind && kind !== BREAKOUT && pick.kind !== BREAKOUT && this.put({ ...pick, kind })) this.report(`it was a ${pick.kind}`, { ...pick, kind });
    this.points = kind === BREAKOUT ? [] : this.points;
    this.app.redraw();
  }

  // Move the selected pick by rows of the wall, and turn it by degrees; return whether there is one.
  /** @param {number} rows @param {number} angle */
  nudge(rows, angle) {
    const { pick, app } = this;
    if (pick) this.put({ ...pick, depth: pick.depth + rows * Math.abs(app.store.levels[0].pitch), toolface: turned(pick.toolface + angle) });
    return pick !== null;
  }

  /** @param {HTMLInputElement} hTMLInputElement */
  setField({ name, value, valueAsNumber }) {
    const { app, pick } = this;
    const { units } = app.view;
    if (!pick) return;
    if (name !== 'note' && !Number.isFinite(valueAsNumber)) return void app.redraw();
    if (name === 'note') this.put({ ...pick, note: value });
    else this.put({ ...pick, [name]: name === 'toolface' ? turned(valueAsNumber) : valueAsNumber / unitOfField(name, units) });
  }

  /** @param {string} name @param {Record<string, string>} [more] */
  address(name, more = {}) {
    const query = new URLSearchParams(location.search); // the token
    for (const [key, value] of Object.entries(more)) query.set(key, value);
    return `api/${name}?${query}`;
  }

  // Return the server's answer to a request; status 0: there was no answer.
  /** @param {string} name @param {RequestInit} request @param {Record<string, string>} [more] */
  ask(name, request, more) {
    return fetch(this.address(name, more), { ...request, signal: AbortSignal.timeout(PATIENCE.answer) }).catch((error) => ({ status: 0, text: async () => messageOf(error) }));
  }

  // Send the server what it has not taken yet, one change after the other. A change that breaks a rule (400) is dropped, and the
  // page says why; after any other failure, the change stays and is sent again.
  async sendUnsaved() {
    const { unsaved, app } = this;
    const waiting = unsaved.size;
    if (!waiting || this.sending) return;
    if (app.status !== 'live') return void this.wait('the server is not connected');
    this.sending = true;
    const before = this.trouble;
    let failed = '';
    while (unsaved.size && unsaved === this.unsaved && !failed) {
      const [[key, pick]] = unsaved;
      const answer = await (pick ? this.ask('pick', { method: 'PUT', body: JSON.stringify(pick) }) : this.ask('pick', { method: 'DELETE' }, { key }));
      const text = answer.status === 200 ? '' : (await answer.text()).trim().slice(0, 300);
      if (answer.status !== 200 && answer.status !== 400) failed = text || `status ${answer.status}`;
      else if (unsaved.get(key) === pick) this.taken(unsaved, key, pick, text);
    }
    this.sending = false;
    if (failed) {
      setTimeout(() => this.sendUnsaved(), PATIENCE.again);
      return void this.wait(failed);
    }
    this.trouble = '';
    if (before && unsaved === this.unsaved) app.notice(`${counted(waiting, 'change')} saved that waited for the server`, 5);
    return void (unsaved === this.unsaved ? app.redraw() : this.sendUnsaved());
  }

  // Remove from the unsaved changes a change that the server has taken, or has refused with a text.
  /** @param {Unsaved} unsaved @param {string} key @param {SavedPick | null} pick @param {string} refusal */
  taken(unsaved, key, pick, refusal) {
    unsaved.delete(key);
    if (unsaved !== this.unsaved) return;
    if (refusal) {
      const at = this.changes.findLastIndex((step) => step.some((one) => one.key === key));
      if (at >= 0) this.changes.splice(at, 1);
      this.app.notice(`Not saved: ${refusal.replace(/^\w+/, (name) => WORDS[name] ?? name)}`, 10);
    } else if (pick) this.served.set(key, pick);
    else this.served.delete(key);
    this.show();
  }

  /** @param {string} trouble */
  wait(trouble) {
    if (!this.trouble) this.app.notice(`Not saved yet: ${trouble}. This page keeps the change and sends it again.`, 10);
    this.trouble = trouble;
    this.app.redraw();
  }

  // Add the picks of a table; they replace picks with the same keys. Undo takes the whole table back in one step.
  /** @param {HTMLInputElement} input */
  async load(input) {
    const [file] = input.files ?? [];
    const body = await file?.text();
    input.value = '';
    if (!body) return;
    const before = this.saved;
    const answer = await this.ask('picks.csv', { method: 'POST', body });
    if (answer.status !== 200) return this.app.notice(`Not added: ${(await answer.text()).trim().slice(0, 300)}`, 10);
    const { added, replaced, unchanged } = JSON.parse(await answer.text());
    if (added.length + replaced.length) {
      this.opened = [...added, ...replaced].map((/** @type {string} */ key) => ({ key, pick: before.get(key) ?? null }));
      this.changes.push(this.opened);
      this.undone = [];
    }
    return this.app.notice(`${counted(added.length)} added, ${replaced.length} replaced, ${unchanged} unchanged`, 10);
  }

  planesOfAll(picks = this.kept) {
    return picks.filter((pick) => pick.kind !== BREAKOUT).map((pick) => this.plane(pick));
  }

  // Return the planes and boxes to draw: those of kept picks, and the plane being picked; `open`: the cursor is one of its points.
  /** @returns {Planes} */
  planes() {
    const { app, kind } = this;
    const selected = this.pick;
    const { boxes } = this;
    const kept = this.planesOfAll(this.drawn).sort((a, b) => Number(a.pick === selected) - Number(b.pick === selected)); // the selected pick last, above the other picks
    if (!this.on || selected || kind === BREAKOUT) return { kept, boxes, selected, current: null, open: false };
    const { cursor } = app.view;
    const more = this.points.length && cursor && cursor.toolface !== null ? [this.point(/** @type {Aim} */ (cursor))] : [];
    const done = fitPlane(app.path, this.points, kind);
    return { kept, boxes, selected, current: done ?? fitPlane(app.path, [...this.points, ...more], kind), open: !done };
  }

  get notSaved() {
    return `Picks are not saved in ${this.file}: its folder cannot be written. Download keeps them.`;
  }

  // Where picks and notes are saved.
  get where() {
    const { file, saves } = this;
    return !saves ? 'not saved: Download' : file ? `saved in ${file}` : 'not saved in a file';
  }

  // Write in which file the server saves the picks, or how many changes it has not saved.
  writeSaved() {
    const { unsaved: { size }, trouble, saves } = this;
    const text = size ? (trouble ? `${counted(size, 'change')} not saved` : 'saving …') : this.where;
    const title = size && trouble ? `${trouble}: this page keeps the changes and sends them again. Keep it open.` : !size && !saves ? this.notSaved : text;
    Object.assign(byId('dipSaved'), { textContent: text, title });
    byId('dipSaved').classList.toggle('bad', Boolean(size && trouble) || !saves);
  }
}

export const newKey = () => Array.from(crypto.getRandomValues(new Uint8Array(6)), (byte) => byte.toString(16).padStart(2, '0')).join('');
