// The card of picks: what to do next, the plane being picked in words, or the selected pick and its numbers to change.

import { axisOf, northOf } from './dips.js';
import { byId, hide, say } from './dom.js';
import { openingOf } from './opening.js';
import { BREAKOUT, counted, FIELDS, isDepth, unitOfField } from './pick_fields.js';
import { intervalsOf, marksOf } from './sureness.js';
import { depthUnit, showAngle, showAzimuth, showDepth, showLength } from './units.js';

const COARSE = 10; // degrees: a plane that is no surer was picked at too coarse a scale

/** @param {import('./picking.js').Picking} picking @param {Planes} planes */
export function writeCard(picking, { kept, boxes, current, open }) {
  const { app } = picking;
  const { units } = app.view;
  const { pick } = picking;
  picking.writeSaved();
  byId('pickClass').value = pick?.kind ?? picking.kind;
  byId('dipKeep').disabled = open || !current;
  hide(!pick, 'dipRemove');
  byId('dipUndo').disabled = !picking.points.length && !picking.changes.length;
  byId('dipRedo').disabled = !picking.undone.length;
  hide(!picking.points.length, 'dipKeep'); // Keep, Delete and Open are shown one at a time, so that the buttons have room in one row
  const saved = Boolean(app.contents);
  hide(saved, 'dipSave');
  hide(saved || Boolean(pick) || picking.points.length > 0, 'dipLoad');
  const plane = pick && pick.kind !== BREAKOUT ? picking.plane(pick) : current;
  const lines = [];
  if (pick) lines.push(`Selected ${pick.kind}: drag it${plane ? ' or its crest' : ''}; 1 to 6 change its class. A new pick begins off it.`);
  else if (picking.kind === BREAKOUT) lines.push('Drag a box over a breakout. Press on a pick to select it.');
  else if (!current) lines.push([`Next ${picking.kind} (1 to 6): drag along it, over a quarter turn or more, or mark three points around the hole.`, 'Two more points.', 'One more, round the hole.'][picking.points.length] ?? 'These lie on one side: add a point round the hole.');
  else if (!open) lines.push('Enter keeps it; another point improves the fit.');
  if (plane) {
    const assumed = pick ? pick.radius === null : picking.points.some(({ measured }) => !measured);
    const count = pick ? /** @type {PlanePick} */ (pick).points ?? 0 : picking.points.length + Number(open);
    const fit = count > 3 ? `misfit ${showLength(plane.misfit, units, units === 'mm' ? 1 : 2)} of ${count} points` : count === 3 ? '3 points, no misfit' : 'drawn by hand, not fitted';
    const slot = plane.kind === 'bed' ? null : openingOf(app.store, plane);
    const size = (/** @type {number} */ metres) => showLength(metres, units, units === 'mm' ? 0 : 2);
    if (slot) lines.unshift(`aperture about ${size(slot.opening)}, at least ${size(slot.deep)} deep`);
    const shown = pick || open ? plane : { ...plane, ...picking.sureness(plane, picking.points) };
    if ((intervalsOf(shown, app.path.surveyed)?.[0] ?? 0) > COARSE) lines.push('Picked at a coarse scale: where [ shows less depth, a pick is surer.');
    lines.unshift(`${showDepth(plane.depth, units)}   ${inWords(shown, app.path)}`, `${fit}${assumed ? '; at bit size' : ''}`);
  }
  else if (pick && axisOf(app.path, pick.depth, pick.toolface)) lines.unshift(`azimuth ${axisOf(app.path, pick.depth, pick.toolface)} from ${northOf(app.path)}`);
  lines.push(`${counted(kept.length, 'plane')}, ${counted(boxes.length, 'breakout')}.`);
  const text = lines.join('\n');
  say('dipText', text);
  writeFields(pick, units);
}

// Show the numbers of the selected pick in fields; a field in which the user types is left as it is.
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
  const input = (/** @type {string} */ name) => /** @type {HTMLInputElement | null} */ (box.querySelector(`[name=${name}]:not([data-typing])`));
  for (const [name, , digits] of fields) {
    const field = input(name);
    if (field) field.value = String(Number((Number(values[name] ?? 0) * unitOfField(name, units)).toFixed(digits)));
  }
  const note = input('note');
  if (note) note.value = pick.note ?? '';
}

// Return the dip and its direction in words, with intervals of 95 % where they are known.
/** @param {Plane} plane @param {Path} path */
export function inWords(plane, path) {
  const { dip, azimuth, apparent, deepest } = plane;
  const [steep, towards] = marksOf(plane, path);
  const [angle, direction] = [`${showAngle(Number.isNaN(dip) ? apparent : dip)}${steep}`, `${showAzimuth(Number.isNaN(dip) ? deepest : azimuth)}°${towards}`];
  return Number.isNaN(dip) ? `apparent dip ${angle}, deepest at ${direction}` : `true dip ${angle}${Number.isNaN(azimuth) ? ', level' : ` toward ${direction}`}   (apparent ${showAngle(apparent)})`;
}
