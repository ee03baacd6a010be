// Picking on the image. A plane: drag from the crest or the trough of a bed or fracture along it; or click three points or
// more and press Enter, which fits the plane through them. A breakout: drag a box. What was just made is selected, so a
// digit sets its class and Delete removes it; a click selects another one. A drag on a pick moves it, at the crest or trough
// of a sine it changes its dip. The server holds the picks of the wall, and saves them beside it; every page shows them. An
// exported file holds its own.

import definition from '../../../base/color_maps.json' with { type: 'json' };
import { messageOf } from './errors.js';
import { fitPlane, planeDepth, planeOf } from './dips.js';
import { byId, options } from './panel.js';
import { download } from './saving.js';
import { LENGTHS, depthUnit, showAngle, showDepth, showLength, showSpan } from './units.js';

export const BREAKOUT = 'breakout';
export const CLASSES = /** @type {(PlaneKind | 'breakout')[]} */ (Object.keys(definition.picks));
const MOST = 5000;
const HANDLE = 20; // degrees around the crest or the trough of a sine in which a drag changes its dip
const LEAST = { opening: 5, height: 0.02, turn: 45 }; // of a box that is dragged; degrees that a sine is dragged along
const BY_HAND = { misfit: 0, points: 0 }; // of a plane that is fitted to no points
/** @type {Record<'plane' | 'breakout', [string, string, number][]>} */
const FIELDS = {
  plane: [['depth', 'MD', 2], ['apparent_dip', 'to hole °', 1], ['toolface', 'deepest °', 0]],
  breakout: [['depth', 'MD', 2], ['height', 'high', 2], ['toolface', 'toolface °', 0], ['opening', 'wide °', 0], ['tilt', 'tilt °', 0]],
};
/** @param {string} name */
const isDepth = (name) => name === 'depth' || name === 'height';
// How many of the field's unit a metre is, for lengths along the hole; 1 for the others.
/** @type {(name: string, units: Units) => number} */
const unitOfField = (name, units) => (isDepth(name) ? LENGTHS[units].depth.scale : 1);
/** @param {number} degrees */
const turned = (degrees) => ((degrees % 360) + 360) % 360;
/** @param {number} a @param {number} b */
const apart = (a, b) => Math.abs(turned(a - b + 180) - 180);

export class Picking {
  on = false;
  kind = CLASSES[0]; // of the next pick
  /** @type {WallPoint[]} */
  points = []; // of the plane that is being picked
  /** @type {WallPick[]} */
  kept = []; // the picks of the wall
  /** @type {Map<string, WallPick>} */
  saved = new Map(); // as the server has them, while one is dragged, too
  /** @type {{ key: string, before: WallPick | null }[]} */
  changes = []; // made here, for undo
  /** @type {{ key: string, before: WallPick | null }[]} */
  undone = []; // taken back, for redo; a new change ends it
  /** @type {string | null} */
  selected = null; // key of one
  /** @type {WallPick | null} */
  dragged = null;
  /** @type {WeakMap<WallPick, { version: number, plane: Plane }>} */
  planesOf = new WeakMap();

  /** @param {App} app */
  constructor(app) {
    this.app = app;
    options('pickClass', CLASSES.map((name, i) => [name, `${i + 1} ${name}`]));
    /** @type {(id: string, act: (event: Event) => void) => void} */
    const on = (id, act) => byId(id).addEventListener('click', act);
    on('dipOpen', () => this.toggle());
    on('dipKeep', () => this.keep());
    on('dipUndo', () => this.undo());
    on('dipRemove', () => this.remove());
    on('dipClose', () => this.toggle(false));
    on('dipSave', () => download(app, this.address('picks.csv'), 'The picks were'));
    on('dipPrint', () => byId('print').click());
    on('dipLoad', () => byId('dipFile').click());
    byId('dipFile').addEventListener('change', () => this.load(byId('dipFile')));
    byId('pickClass').addEventListener('change', () => this.setClass(/** @type {PlaneKind | 'breakout'} */ (byId('pickClass').value)));
    byId('pickFields').addEventListener('change', ({ target }) => this.setField(/** @type {HTMLInputElement} */ (target)));
  }

  // The picks of the server, or of an exported file.
  /** @param {WallPick[]} picks */
  receive(picks) {
    const { dragged } = this;
    this.saved = new Map(picks.map((pick) => [pick.key, pick]));
    this.kept = picks.map((pick) => (pick.key === dragged?.key ? dragged : pick));
    if (!this.pick) this.selected = null;
    this.app.redraw();
  }

  // Where the server saves every change.
  /** @param {string | null} [file] */
  showFile(file) {
    const text = file ? `saved in ${file}` : 'not saved in a file';
    Object.assign(byId('dipSaved'), { textContent: text, title: text });
  }

  // The selected pick.
  get pick() {
    return this.kept.find(({ key }) => key === this.selected) ?? null;
  }

  get boxes() {
    return this.kept.filter((pick) => pick.kind === BREAKOUT);
  }

  get shown() {
    return this.on || this.kept.some(({ kind }) => kind !== BREAKOUT);
  }

  toggle(on = !this.on) {
    this.on = on;
    if (!on) Object.assign(this, { points: [], selected: null });
    byId('dipOpen').classList.toggle('on', on);
    byId('dips').hidden = !on;
    document.body.classList.toggle('picking', on);
    if (on) {
      this.app.view.release();
      this.app.view.choose({ follow: false, tab: 'log' });
    }
    this.app.resize();
  }

  // Deselect the pick, or drop the points of the next one; without either, end picking.
  leave() {
    if (!this.selected && !this.points.length) return this.toggle(false);
    Object.assign(this, { points: [], selected: null });
    return this.app.redraw();
  }

  // With the wall's radius; where it is not measured, with bit size, which the text says.
  /** @param {Aim} aim @returns {WallPoint} */
  point({ depth, toolface }) {
    const { store } = this.app;
    const quad = store.quad(store.levels[0].quadAt(depth, toolface));
    return { depth, toolface, radius: quad?.radius ?? store.bitRadius, measured: quad !== null };
  }

  // The plane of a kept pick on the path as it is now.
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

  // The kept pick whose curve passes within `reach` metres of the cursor, or whose box holds it, first the selected one; null
  // if there is none.
  /** @param {Aim} aim @param {number} reach */
  near({ depth, toolface }, reach) {
    /** @param {WallPick} pick */
    const hit = (pick) => (pick.kind === BREAKOUT
      ? Math.abs(depth - pick.depth) < pick.height / 2 && apart(2 * toolface, 2 * pick.toolface) < pick.opening
      : Math.abs(planeDepth(this.app.path, this.plane(pick), toolface) - depth) < reach);
    const found = this.kept.filter(hit);
    return found.find(({ key }) => key === this.selected) ?? found[0] ?? null;
  }

  // A click on the image: on a pick it selects it or ends that; elsewhere it adds a point.
  /** @param {Aim} cursor @param {number} reach */
  click(cursor, reach) {
    const found = this.points.length ? null : this.near(cursor, reach);
    this.selected = !found || found.key === this.selected ? null : found.key;
    if (found) this.kind = found.kind;
    if (!found && this.kind !== BREAKOUT) Object.assign(this, { points: [...this.points, this.point(cursor)], undone: [] });
    this.app.redraw();
  }

  // A drag begins on the image: it moves a pick, draws a sine or a box, or is not for picking (null). `handle` is how many
  // degrees around the crest or the trough of a sine a drag changes its dip.
  /** @param {Aim} from @param {number} reach @param {number} [handle] @returns {Drag | null} */
  grab(from, reach, handle = 0) {
    if (this.points.length) return null;
    const pick = this.near(from, reach);
    if (!pick) return { act: this.kind === BREAKOUT ? 'box' : 'sine', from };
    const crest = [0, 180].find((turn) => apart(from.toolface, pick.toolface + turn) < Math.max(HANDLE, handle));
    return pick.kind === BREAKOUT || crest === undefined ? { act: 'move', from, pick } : { act: 'dip', from, pick, crest };
  }

  // The drag goes on, to a place on the image; its pick is as it was when the drag began.
  /** @param {Drag} drag @param {Aim} aim */
  drag(drag, { depth, toolface }) {
    const { from } = drag;
    if (drag.act === 'sine') return this.drawSine(from, { depth, toolface });
    if (drag.act === 'box') {
      const opening = apart(toolface, from.toolface);
      const middle = turned(from.toolface + (turned(toolface - from.toolface + 180) - 180) / 2);
      this.dragged = { key: this.dragged?.key ?? newKey(), kind: BREAKOUT, depth: (depth + from.depth) / 2, toolface: middle, height: Math.abs(depth - from.depth), opening: Math.min(180, opening) };
    } else if (drag.act === 'dip') {
      const { pick, crest } = drag;
      const slope = Math.tan((pick.apparent_dip * Math.PI) / 180) + ((crest ? from.depth - depth : depth - from.depth) / (pick.radius ?? this.app.store.bitRadius));
      this.dragged = { ...pick, ...BY_HAND, toolface: turned(pick.toolface + toolface - from.toolface), apparent_dip: (Math.atan(Math.max(0, slope)) * 180) / Math.PI };
    } else {
      const { pick } = drag;
      this.dragged = { ...pick, depth: pick.depth + depth - from.depth, ...(pick.kind === BREAKOUT ? { toolface: turned(pick.toolface + toolface - from.toolface) } : BY_HAND) };
    }
    this.selected = this.dragged.key;
    return this.replace(this.dragged);
  }

  // The sine that turns where the drag began and passes through where it is now.
  /** @param {Aim} from @param {Aim} to */
  drawSine(from, to) {
    const turn = apart(to.toolface, from.toolface);
    if (turn < LEAST.turn) return this.cancel();
    const ends = [from, to].map((aim) => this.point(aim));
    const radius = (ends[0].radius + ends[1].radius) / 2;
    const height = (to.depth - from.depth) / (1 - Math.cos((turn * Math.PI) / 180)); // half of the sine's
    const plane = fitPlane(this.app.path, [0, 120, 240].map((on) => ({ depth: from.depth + (on ? 1.5 * height : 0), toolface: from.toolface + on, radius })));
    if (!plane) return undefined;
    this.dragged = { ...this.made(plane, ends), ...BY_HAND, key: this.dragged?.key ?? newKey() };
    this.selected = this.dragged.key;
    return this.replace(this.dragged);
  }

  // A drag ends: what it made or changed is saved.
  drop() {
    const made = this.dragged;
    if (!made) return;
    if (made.kind === BREAKOUT && (made.opening < LEAST.opening || made.height < LEAST.height)) return this.cancel();
    this.dragged = null;
    this.put(made);
  }

  // A drag ends without effect.
  cancel() {
    const { dragged } = this;
    this.dragged = null;
    if (!dragged) return;
    const before = this.saved.get(dragged.key);
    this.replace(before ?? dragged, !before);
    if (!before) this.selected = null;
  }

  // Show a pick, in place of the one with its key; `gone`: no longer.
  /** @param {WallPick} pick @param {boolean} [gone] */
  replace(pick, gone = false) {
    const known = this.kept.some(({ key }) => key === pick.key);
    if (gone) this.kept = this.kept.filter(({ key }) => key !== pick.key);
    else this.kept = known ? this.kept.map((one) => (one.key === pick.key ? pick : one)) : [...this.kept, pick];
    this.app.redraw();
  }

  /** @param {string} key */
  remember(key) {
    this.changes.push({ key, before: this.saved.get(key) ?? null });
    this.undone = [];
  }

  // Save a pick, new or changed, and select it; false if there are too many.
  /** @param {WallPick} pick */
  put(pick) {
    if (!this.saved.has(pick.key) && this.saved.size >= MOST) {
      this.replace(pick, true);
      this.app.notice(`There are ${MOST} picks, as many as a wall has. This one was not kept: ${showDepth(pick.depth, this.app.view.units)}`, 10);
      return false;
    }
    this.remember(pick.key);
    this.saved.set(pick.key, pick);
    this.selected = pick.key;
    this.replace(pick);
    this.send('pick', { method: 'PUT', body: JSON.stringify(pick) });
    this.app.resize();
    return true;
  }

  remove(pick = this.pick) {
    if (!pick) return;
    this.remember(pick.key);
    this.saved.delete(pick.key);
    this.replace(pick, true);
    this.selected = null;
    this.send('pick', { method: 'DELETE' }, { key: pick.key });
    this.app.resize();
  }

  // Take back the last point, or the last change of a pick.
  undo() {
    if (this.points.pop()) this.app.redraw();
    else this.restore(this.changes, this.undone);
  }

  // Make the last change again that was taken back.
  redo() {
    this.restore(this.undone, this.changes);
  }

  // Put a pick back to where the last entry of one list has it; the other list gets the way back.
  /** @param {Picking['changes']} from @param {Picking['changes']} to */
  restore(from, to) {
    const last = from.pop();
    if (!last) return;
    const { changes, undone } = this;
    const made = this.kept.find(({ key }) => key === last.key);
    to.push({ key: last.key, before: this.saved.get(last.key) ?? null });
    Object.assign(this, { changes: [], undone: [] }); // what `put` and `remove` remember is no change of the user
    if (last.before) this.put(last.before);
    else if (made) this.remove(made);
    Object.assign(this, { changes, undone });
  }

  keep() {
    const plane = fitPlane(this.app.path, this.points);
    if (!plane || this.kind === BREAKOUT) return;
    const pick = this.made(plane, this.points);
    if (this.put(pick)) this.points = [];
  }

  // A pick of a plane through points of the wall.
  /** @param {Plane} plane @param {WallPoint[]} points @returns {PlanePick} */
  made({ depth, deepest, apparent, radius, misfit }, points) {
    const measured = points.some((point) => point.measured);
    return { key: newKey(), kind: /** @type {PlaneKind} */ (this.kind), depth, toolface: deepest, apparent_dip: apparent, radius: measured ? radius : null, misfit, points: points.length };
  }

  // The class of the selected pick, and of the next one.
  /** @param {PlaneKind | 'breakout'} kind */
  setClass(kind) {
    const { pick } = this;
    if (!kind) return;
    if (pick && pick.kind !== BREAKOUT && kind !== BREAKOUT) this.put({ ...pick, kind });
    else if (pick?.kind !== kind) this.selected = null;
    this.kind = kind;
    this.points = kind === BREAKOUT ? [] : this.points;
    this.app.redraw();
  }

  /** @param {HTMLInputElement} hTMLInputElement */
  setField({ name, value, valueAsNumber }) {
    const { app, pick } = this;
    const { units } = app.view;
    const depth = name === 'depth' ? valueAsNumber / unitOfField(name, units) : NaN;
    if (depth < app.store.span[0] || depth > app.store.span[1]) return void app.notice(`${showDepth(depth, units)} is outside the wall, ${showSpan(app.store.span[0], app.store.span[1], units)}`, 10);
    if (!pick || (name !== 'note' && !Number.isFinite(valueAsNumber))) return;
    if (name === 'note') this.put({ ...pick, note: value });
    else this.put({ ...pick, ...(pick.kind === BREAKOUT ? {} : BY_HAND), [name]: name === 'toolface' ? turned(valueAsNumber) : valueAsNumber / unitOfField(name, units) });
  }

  /** @param {string} name @param {Record<string, string>} [more] */
  address(name, more = {}) {
    const query = new URLSearchParams(location.search); // the token
    for (const [key, value] of Object.entries(more)) query.set(key, value);
    return `api/${name}?${query}`;
  }

  // Tell the server; what it refuses is said, and its own picks come back.
  /** @param {string} name @param {RequestInit} request @param {Record<string, string>} [more] */
  async send(name, request, more) {
    if (this.app.contents) return;
    const answer = await fetch(this.address(name, more), request).catch((error) => ({ ok: false, text: () => messageOf(error) }));
    if (!answer.ok) this.app.notice(`Not saved: ${(await answer.text()).trim().slice(0, 300)}`, 10);
  }

  /** @param {HTMLInputElement} input */
  async load(input) {
    const [file] = input.files ?? [];
    if (file) await this.send('picks.csv', { method: 'POST', body: await file.text() });
    input.value = '';
  }

  // Planes and boxes to draw: the kept ones, and the plane being picked, `open` while the cursor is one of its points.
  /** @returns {Planes} */
  planes() {
    const { app, kind } = this;
    const kept = this.kept.filter((pick) => pick.kind !== BREAKOUT).map((pick) => this.plane(pick));
    const selected = this.pick;
    if (!this.on || selected || kind === BREAKOUT) return { kept, boxes: this.boxes, selected, current: null, open: false };
    const { cursor } = app.view;
    const more = this.points.length && cursor && cursor.toolface !== null ? [this.point(/** @type {Aim} */ (cursor))] : [];
    const done = fitPlane(app.path, this.points, kind);
    return { kept, boxes: this.boxes, selected, current: done ?? fitPlane(app.path, [...this.points, ...more], kind), open: !done };
  }

  // The card: what to do next, the plane being picked in words, or the selected pick and its numbers to change.
  /** @param {Planes} planes */
  write({ kept, boxes, current, open }) {
    if (!this.on) return;
    const { units } = this.app.view;
    const { pick } = this;
    byId('pickClass').value = this.kind;
    byId('dipKeep').disabled = open || !current;
    byId('dipRemove').disabled = !pick;
    byId('dipUndo').disabled = !this.points.length && !this.changes.length;
    byId('dipSave').hidden = byId('dipLoad').hidden = Boolean(this.app.contents);
    const plane = pick && pick.kind !== BREAKOUT ? this.plane(pick) : current;
    const lines = [`${kept.length} plane${kept.length === 1 ? '' : 's'}, ${boxes.length} breakout${boxes.length === 1 ? '' : 's'}.`];
    if (pick) lines.push(`Selected ${pick.kind}: drag it${plane ? ' or its crest' : ''}; its class is in the list above.`);
    else if (this.kind === BREAKOUT) lines.push('Drag a box over a breakout. Press on a pick to select it.');
    else if (!current) lines.push(['Drag from a crest or trough along the bed, or mark three points around the hole.', 'Two more points.', 'One more, round the hole.'][this.points.length] ?? 'These lie on one side: add a point round the hole.');
    if (plane) {
      const assumed = pick ? pick.radius === null : this.points.some(({ measured }) => !measured);
      const count = pick ? /** @type {PlanePick} */ (pick).points ?? 0 : this.points.length + Number(open);
      const fit = count > 3 ? `misfit ${showLength(plane.misfit, units, units === 'mm' ? 0 : 1)} of ${count} points` : count === 3 ? '3 points, no misfit' : 'drawn, no misfit';
      lines.push(`${showDepth(plane.depth, units)}   ${inWords(plane)}`, `${fit}${assumed ? '; at bit size' : ''}`);
    }
    const text = lines.join('\n');
    if (byId('dipText').textContent !== text) byId('dipText').textContent = text;
    writeFields(pick, units);
  }
}

// Numbers of the selected pick as fields, those that nobody is typing in.
/** @param {WallPick | null} pick @param {Units} units */
function writeFields(pick, units) {
  const box = byId('pickFields');
  const fields = pick ? FIELDS[pick.kind === BREAKOUT ? BREAKOUT : 'plane'] : [];
  const wanted = [depthUnit(units), ...fields.map(([name]) => name)].join();
  box.hidden = !pick;
  if (box.dataset.fields !== wanted) {
    box.dataset.fields = wanted;
    box.replaceChildren(...[...fields, ...(pick ? [['note', 'note']] : [])].map(([name, words]) => {
      const [label, input] = ['label', 'input'].map((tag) => document.createElement(tag));
      Object.assign(input, name === 'note' ? { name, type: 'text', maxLength: 80 } : { name, type: 'number', step: 'any' });
      label.append(`${words} ${isDepth(name) ? `${depthUnit(units)} ` : ''}`, input);
      return label;
    }));
  }
  if (!pick) return;
  const values = /** @type {Record<string, unknown>} */ ({ ...pick });
  const input = (/** @type {string} */ name) => /** @type {HTMLInputElement | null} */ (box.querySelector(`[name=${name}]:not(:focus)`));
  for (const [name, , digits] of fields) {
    const field = input(name);
    if (field) field.value = String(Number((Number(values[name] ?? 0) * unitOfField(name, units)).toFixed(digits)));
  }
  const note = input('note');
  if (note) note.value = pick.note ?? '';
}

const newKey = () => Array.from(crypto.getRandomValues(new Uint8Array(6)), (byte) => byte.toString(16).padStart(2, '0')).join('');
/** @param {Plane} plane */
const inWords = ({ dip, azimuth, apparent, deepest }) =>
  Number.isNaN(dip) ? `${showAngle(apparent)} to the hole, deepest at ${showAngle(deepest, 0)}` : `dip ${showAngle(dip)} to ${showAngle(azimuth, 0)}   (${showAngle(apparent)} to the hole)`;
