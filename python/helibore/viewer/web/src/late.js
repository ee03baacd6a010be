// What few readers need is a file of its own, more.js, which the page loads when it draws the first of it; an exported file
// holds it from the start.

import { messageOf } from './errors.js';

export const loaded = () => /** @type {{ more?: typeof import('./more.js') }} */ (globalThis).more;

// Return what more.js has; undefined until it is here, after which `app` is drawn anew, at the section of rig mode.
/** @param {App} app */
export function late(app) {
  const { renderer } = app;
  const more = loaded();
  if (more || renderer.loading) return more;
  renderer.loading = true;
  import(String(new URL(`more.js${location.search}`, location.href))).then(() => {
    if (app.view.rig && app.store) app.follow();
    app.repaint();
  }, (error) => app.notice(`A part of the page did not come: ${messageOf(error)}`, 10)).finally(() => (renderer.loading = false));
  return undefined;
}

// Call `act` with what more.js has, once it is here.
/** @param {App} app @param {(more: typeof import('./more.js')) => unknown} act */
export function whenLate(app, act) {
  const more = late(app);
  if (more) act(more);
  else if (app.renderer.loading) setTimeout(() => whenLate(app, act), 50);
}
