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
      download(app, event.currentTarget.href);
    });
  }
}

async function download(app, address) {
  app.notice('Writing the section …');
  try {
    const answer = await fetch(address);
    if (!answer.ok) return app.notice(`The section was not written: ${(await answer.text()).trim().slice(0, 300)}.`, 10);
    const name = /filename=([^;]+)/.exec(answer.headers.get('content-disposition') ?? '')?.[1] ?? 'section';
    save(await answer.blob(), name);
    return app.notice('');
  } catch (error) {
    return app.notice(`The section was not written: ${error.message}.`, 10);
  }
}
