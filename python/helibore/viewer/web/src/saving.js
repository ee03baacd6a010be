// Downloads: what the page has itself, and what the server writes. If the server refuses, the page shows why.

import { messageOf } from './errors.js';
import { byId } from './panel.js';
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
  for (const id of /** @type {const} */ (['csv', 'export', 'print', 'printAll'])) {
    byId(id).addEventListener('click', (event) => {
      event.preventDefault();
      const { view, store } = app;
      const part = id === 'print' && view.length < store.span[1] - store.span[0];
      const said = part ? `${showSpan(view.top, view.bottom, view.units)} is saved as a PDF. Print well, below the log, prints it all.` : '';
      download(app, byId(id).href, id === 'printAll' ? 'The well was' : 'The section was', said);
    });
  }
}

// `what` begins the message of a failure: "The section was"; `said` is shown after a success.
/** @param {App} app @param {string} address @param {string} what @param {string} [said] */
export async function download(app, address, what, said = '') {
  app.notice('Writing …');
  try {
    const answer = await fetch(address);
    if (!answer.ok) return app.notice(`${what} not written: ${(await answer.text()).trim().slice(0, 300)}.`, 10);
    const name = /filename=([^;]+)/.exec(answer.headers.get('content-disposition') ?? '')?.[1] ?? 'helibore';
    save(await answer.blob(), name);
    return app.notice(said, 10);
  } catch (error) {
    return app.notice(`${what} not written: ${messageOf(error)}.`, 10);
  }
}
