// Downloads: what the page has itself, and what the server writes. If the server refuses, the page shows why.

import { byId } from './panel.js';

export function save(blob, name) {
  const link = document.createElement('a');
  link.href = URL.createObjectURL(blob);
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 1000);
}

export function bindSaving(app) {
  for (const id of ['csv', 'export']) {
    byId(id).addEventListener('click', (event) => {
      event.preventDefault();
      download(app, event.currentTarget.href, 'The section was');
    });
  }
}

// `what` begins the message of a failure: "The section was".
export async function download(app, address, what) {
  app.notice('Writing …');
  try {
    const answer = await fetch(address);
    if (!answer.ok) return app.notice(`${what} not written: ${(await answer.text()).trim().slice(0, 300)}.`, 10);
    const name = /filename=([^;]+)/.exec(answer.headers.get('content-disposition') ?? '')?.[1] ?? 'helibore';
    save(await answer.blob(), name);
    return app.notice('');
  } catch (error) {
    return app.notice(`${what} not written: ${error.message}.`, 10);
  }
}
