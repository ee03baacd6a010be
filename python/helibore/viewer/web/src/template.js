// Converts the arrangement of the tracks to a template (TOML), which page, print and report read, and back.

import { movable } from './layout.js';

const RADIUS = 'Radius'; // the name in templates of the wall over bit size
/** @param {string} name */
const text = (name) => JSON.stringify(name); // a TOML string has the escapes of JSON

// Return the tracks of the page as TOML.
/** @param {App} app */
export function toTemplate({ view, store, renderer: { rects, paper }, selection: { quantity, besides }, curves }) {
  const images = [quantity, ...besides];
  const lines = [`unit = "${view.units}"`, ...(paper ? [`scale = ${paper}`] : [])];
  for (const name of movable(rects)) {
    lines.push('', '[[track]]');
    const image = name === 'image' ? images[0] : images[Number(name.slice('beside'.length)) + 1];
    if (name === 'caliper' || name === 'dips') lines.push(`kind = "${name}"`);
    else if (name.startsWith('column')) lines.push('kind = "intervals"', `name = ${text(store.columns[Number(name.slice('column'.length))])}`);
    else if (name === 'curves') lines.push('kind = "curves"', `names = [${curves.shown.map((one) => text(one.name)).join(', ')}]`);
    else lines.push('kind = "image"', `name = ${text(image.id === 'over' ? RADIUS : image.id)}`);
    lines.push(`width = ${Math.round(rects[name].width)}`);
  }
  return `${lines.join('\n')}\n`;
}

// Return the changes of the view that show the tracks of a template; images that the wall does not have are left out, as are tracks of intervals.
/** @param {Template} template @param {Quantity[]} quantities @param {string[]} columns */
export function fromTemplate({ unit, track: tracks }, quantities, columns = []) {
  /** @type {{ units: Units, beside: string[], curves: string[], order: string[], widths: Record<string, number>, quantity?: string }} */
  const changes = { units: unit, beside: [], curves: [], order: [], widths: {} };
  let images = 0;
  for (const { kind, name, names, width } of tracks) {
    let track = kind;
    if (kind === 'image') {
      const id = name === RADIUS ? 'over' : name;
      if (!quantities.some((one) => one.id === id)) continue;
      track = images ? `beside${images - 1}` : 'image';
      if (images++) changes.beside.push(id);
      else changes.quantity = id;
    }
    if (kind === 'intervals') {
      if (!columns.includes(name)) continue;
      track = `column${columns.indexOf(name)}`;
      changes.curves.push(name);
    }
    changes.curves.push(...names);
    changes.order.push(track);
    if (width !== null) changes.widths[track] = width;
  }
  return changes;
}
