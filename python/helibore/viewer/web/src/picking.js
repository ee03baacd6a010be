// Picking dips on the image: click points of a bed, three or more; the plane through them is shown at once, with the
// cursor as one more point; Enter keeps it. A click on a kept curve selects it: a drag moves it, Delete removes it. Kept planes are curves on the image, discs in 3-D and tadpoles beside the caliper.

import { fitPlane, planeDepth } from './dips.js';
import { byId } from './panel.js';
import { save } from './saving.js';
import { showAngle, showDepth, showLength } from './units.js';

const MOST = 200;

export class Picking {
  constructor(app) {
    Object.assign(this, { app, on: false, points: [], kept: [], selected: null });
    byId('dipOpen').addEventListener('click', () => this.toggle());
    byId('dipKeep').addEventListener('click', () => this.keep());
    byId('dipUndo').addEventListener('click', () => this.undo());
    byId('dipSave').addEventListener('click', () => this.save());
    byId('dipClose').addEventListener('click', () => this.toggle(false));
  }

  get shown() {
    return this.on || this.kept.length > 0;
  }

  toggle(on = !this.on) {
    this.on = on;
    if (!on) Object.assign(this, { points: [], selected: null });
    byId('dipOpen').classList.toggle('on', on);
    byId('dips').hidden = !on;
    if (on) this.app.view.set({ pinned: false });
    this.app.resize();
  }

  // With the wall's radius; where it is not measured, with bit size, which the text says.
  point({ depth, toolface }) {
    const { store } = this.app;
    const quad = store.quad(store.levels[0].quadAt(depth, toolface));
    return { depth, toolface, radius: quad?.radius ?? store.bitRadius, measured: quad !== null };
  }

  add(cursor) {
    if (cursor?.toolface === null || cursor?.toolface === undefined) return;
    this.points.push(this.point(cursor));
    this.app.redraw();
  }

  // The kept pick whose curve passes within `reach` metres of the cursor; null if there is none.
  near({ depth, toolface }, reach) {
    const { path } = this.app;
    return this.kept.find((points) => {
      const plane = fitPlane(path, points);
      return plane && Math.abs(planeDepth(path, plane, toolface) - depth) < reach;
    }) ?? null;
  }

  // A click on the image: on a curve it selects the pick or lets it be; elsewhere it adds a point.
  click(cursor, reach) {
    const found = this.points.length ? null : this.near(cursor, reach);
    if (!found && !this.selected) return this.add(cursor);
    this.selected = found === this.selected ? null : found;
    return this.app.redraw();
  }

  // Move the selected pick along the hole: `from` are its points before.
  shift(from, metres) {
    const moved = from.map((point) => this.point({ depth: point.depth + metres, toolface: point.toolface }));
    this.kept[this.kept.indexOf(this.selected)] = this.selected = moved;
    this.app.redraw();
  }

  remove() {
    this.kept = this.kept.filter((points) => points !== this.selected);
    this.selected = null;
    this.app.resize();
  }

  undo() {
    if (this.points.length) this.points.pop();
    else this.kept.pop();
    this.app.resize();
  }

  keep() {
    const plane = fitPlane(this.app.path, this.points);
    if (!plane) return;
    if (this.kept.length >= MOST) return this.app.notice(`There are ${MOST} dips, as many as are kept: save them as a table and undo some first. This one was not kept: ${showDepth(plane.depth)}`, 10);
    this.kept.push(this.points);
    this.points = [];
    this.app.resize();
  }

  // Planes to draw: the kept ones, and the one being picked, `open` while the cursor is one of its points.
  planes() {
    const { app } = this;
    const kept = this.kept.map((points) => fitPlane(app.path, points)).filter(Boolean);
    const selected = kept.find(({ points }) => points === this.selected);
    if (!this.on || selected) return { kept, selected, current: null };
    const { cursor } = app.view;
    const more = this.points.length && Number.isFinite(cursor?.toolface) ? [this.point(cursor)] : [];
    const done = fitPlane(app.path, this.points);
    return { kept, current: done ?? fitPlane(app.path, [...this.points, ...more]), open: !done };
  }

  // The card beside the picture: the plane being picked in words, then the kept ones.
  write({ kept, selected, current, open }) {
    if (!this.on) return;
    const { units } = this.app.view;
    byId('dipKeep').disabled = open || !current;
    byId('dipSave').disabled = kept.length === 0;
    const lines = (selected ? [selected] : kept).map((plane) => `${showDepth(plane.depth)}   ${inWords(plane)}${assumed(plane)}`);
    if (current) lines.push(`${showDepth(current.depth)}   ${inWords(current)}`, `misfit ${showLength(current.misfit, units, units === 'mm' ? 0 : 1)} along the hole${assumed(current)}`);
    else if (selected) lines.push('Selected: drag it along the hole, Delete removes it, a click beside it ends.');
    else lines.push(['Click three points or more of a bed, all around the hole.', 'Two more points.', 'One more, round the hole.'][this.points.length] ?? 'These lie on one side: add a point round the hole.');
    const text = lines.slice(-9).join('\n');
    if (byId('dipText').textContent !== text) byId('dipText').textContent = text;
  }

  save() {
    const { kept } = this.planes();
    save(new Blob([asTable(kept)], { type: 'text/csv' }), 'dips.csv');
  }

  toAddress() {
    return this.kept.map((points) => points.map((p) => [p.depth.toFixed(3), p.toolface.toFixed(1), (1000 * p.radius).toFixed(1), ...(p.measured ? [] : ['bit'])].join('_')).join('~')).join('!');
  }

  fromAddress(text) {
    const parts = (text ?? '').split('!');
    if (parts.length > MOST) this.app.notice(`The address holds ${parts.length} dips: the first ${MOST} are kept, the others are not.`, 10);
    const planes = parts.slice(0, MOST).map((plane) => plane.split('~').map(pointFrom));
    this.kept = planes.filter((plane) => plane.length >= 3 && plane.every(Boolean));
  }
}

// depth_toolface_radius in metres, degrees, millimetres; `_bit` where the radius is the bit's, for want of a measured one.
function pointFrom(text) {
  const [depth, toolface, radius, bit, ...rest] = text.split('_');
  const numbers = [depth, toolface, radius].map((part) => (part ? Number(part) : NaN));
  if (!numbers.every(Number.isFinite) || rest.length || (bit !== undefined && bit !== 'bit')) return null;
  return { depth: numbers[0], toolface: numbers[1], radius: numbers[2] / 1000, measured: bit === undefined };
}

const assumed = ({ points }) => (points.some(({ measured }) => !measured) ? '; bit size where nothing is measured' : '');
const inWords = ({ dip, azimuth, apparent, deepest }) =>
  Number.isNaN(dip) ? `${showAngle(apparent)} to the hole, deepest at ${showAngle(deepest, 0)}` : `dip ${showAngle(dip)} to ${showAngle(azimuth, 0)}   (${showAngle(apparent)} to the hole)`;

const cell = (value, digits) => (Number.isFinite(value) ? value.toFixed(digits) : '');
export const asTable = (planes) =>
  ['depth_m,dip_deg,dip_azimuth_deg,apparent_dip_deg,toolface_of_deepest_deg,misfit_m,points,points_at_bit_size', ...planes.map((plane) =>
    [[plane.depth, 3], [plane.dip, 2], [plane.azimuth, 2], [plane.apparent, 2], [plane.deepest, 2], [plane.misfit, 4], [plane.points.length, 0], [plane.points.filter(({ measured }) => !measured).length, 0]].map((pair) => cell(...pair)).join(','))].join('\r\n') + '\r\n';
