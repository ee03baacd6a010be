// Downloads: what the page has itself, and what the server writes. If the server refuses, the page shows why.

import { messageOf } from './errors.js';
import { sharpen } from './device.js';
import { byId } from './dom.js';
import { toggleFlight } from './inside.js';
import { whenLate } from './late.js';
import { showSpan } from './units.js';

/** @param {Blob} blob @param {string} name */
export function save(blob, name) {
  const link = document.createElement('a');
  link.href = URL.createObjectURL(blob);
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 1000);
}

/** @param {App} app */
export function bindSaving(app) {
  for (const kind of /** @type {const} */ (['png', 'svg', 'slide'])) {
    byId(kind).addEventListener('click', (event) => {
      event.preventDefault();
      if (app.store) whenLate(app, ({ saveStage }) => saveStage(app, kind, sharpen, (blob) => save(blob, fileName(app.view, kind === 'slide' ? 'slide.png' : kind))));
    });
  }
  byId('film').addEventListener('click', () => whenLate(app, ({ film }) => film(app, toggleFlight, (blob, ending) => save(blob, fileName(app.view, ending)))));
  for (const id of /** @type {const} */ (['csv', 'export', 'glb', 'las', 'print', 'printAll'])) {
    byId(id).addEventListener('click', (event) => {
      event.preventDefault();
      const { view, store } = app;
      const part = id === 'print' && view.length < store.span[1] - store.span[0];
      const said = part ? `${showSpan(view.top, view.bottom, view.units)} is saved as a PDF. Print well, below the log, prints it all.` : '';
      const what = id === 'printAll' ? 'The well was' : 'The section was';
      if (!id.startsWith('print')) return download(app, byId(id).href, what, said);
      return whenLate(app, async ({ paneOf, toTemplate }) => {
        const arranged = view.order.length + Object.keys(view.widths).length; // as the user has arranged the tracks
        const pane = id === 'print' ? await paneOf(app, sharpen) : null; // printed below the tracks
        download(app, byId(id).href + (arranged ? `&template=${encodeURIComponent(toTemplate(app))}` : ''), what, said, pane);
      });
    });
  }
}

const wellName = () => byId('well').title || 'helibore';
/** @param {View} view @param {string} ending */
const fileName = (view, ending) => `${wellName()}-${view.top.toFixed(1)}-${view.bottom.toFixed(1)}${{ straight: '', outside: '-path', down: '-inside', up: '-inside' }[view.camera]}.${ending}`;

// `what` begins the message of a failure: "The section was"; `said` is shown after a success; `body` is sent. Until the file is
// here, the notice counts the seconds.
/** @param {App} app @param {string} address @param {string} what @param {string} [said] @param {Blob | null} [body] */
export async function download(app, address, what, said = '', body = null) {
  const began = performance.now();
  const say = () => app.notice(`Writing … ${Math.round((performance.now() - began) / 1000)} s`);
  say();
  const timer = setInterval(say, 1000);
  try {
    const answer = await fetch(address, body ? { method: 'POST', body } : {});
    if (!answer.ok) return app.notice(`${what} not written: ${(await answer.text()).trim().slice(0, 300)}.`, 10);
    const name = /filename=([^;]+)/.exec(answer.headers.get('content-disposition') ?? '')?.[1] ?? 'helibore';
    save(await answer.blob(), name);
    return app.notice(said || `Saved: ${name}`, 10);
  } catch (error) {
    return app.notice(`${what} not written: ${messageOf(error)}.`, 10);
  } finally {
    clearInterval(timer);
  }
}
