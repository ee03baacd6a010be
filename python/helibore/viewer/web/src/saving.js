// Downloads: what the page has itself, and what the server writes. If the server refuses, the page shows why.

import { messageOf } from './errors.js';
import { byId } from './panel.js';

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
  for (const id of /** @type {const} */ (['csv', 'export', 'print'])) {
    byId(id).addEventListener('click', (event) => {
      event.preventDefault();
      download(app, byId(id).href, 'The section was');
    });
  }
}

// `what` begins the message of a failure: "The section was".
/** @param {App} app @param {string} address @param {string} what */
export async function download(app, address, what) {
  app.notice('Writing …');
  try {
    const answer = await fetch(address);
    if (!answer.ok) return app.notice(`${what} not written: ${(await answer.text()).trim().slice(0, 300)}.`, 10);
    const name = /filename=([^;]+)/.exec(answer.headers.get('content-disposition') ?? '')?.[1] ?? 'helibore';
    save(await answer.blob(), name);
    return app.notice('');
  } catch (error) {
    return app.notice(`${what} not written: ${messageOf(error)}.`, 10);
  }
}
