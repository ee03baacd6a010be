// Rig mode (K): what rig_digits.js writes, beside a picture of the last metres and the worst place. The view follows the bit
// until the mode is left; the address holds the mode, so a reload keeps it.

import { hide, say } from './dom.js';
import { late } from './late.js';

export const RECENT = 30; // metres of hole that "last" and "ahead" mean, if the wall is that long

// Return the depths of the last metres of a wall, shallow first.
/** @param {Store} store */
export const recent = ({ span: [shallow, deep], levels: [{ pitch }] }) => (pitch > 0 ? [Math.max(shallow, deep - RECENT), deep] : [shallow, Math.min(deep, shallow + RECENT)]);

// Show rig mode, or hide it; its digits and styles are in more.js.
/** @param {App} app */
export function writeRig(app) {
  const { view, store } = app;
  hide(!view.rig || !store, 'rig');
  document.body.classList.toggle('rig', view.rig);
  say('rigOpen', view.rig ? 'Desk' : 'Rig');
  const more = view.rig && late(app);
  if (!more) return;
  if (!document.adoptedStyleSheets.length) {
    const sheet = new CSSStyleSheet();
    sheet.replaceSync(more.rigStyles);
    document.adoptedStyleSheets = [sheet];
  }
  if (store) more.writeDigits(app);
}
