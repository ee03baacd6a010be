// Converts the arrangement of the tracks to a template (TOML), which page, print and report read.

import { movable } from './layout.js';
import { RADIUS } from './template.js';

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
