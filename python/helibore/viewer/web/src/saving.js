// Files that the page hands to the browser: what it has itself, and what the server writes. A server that cannot says why, and
// the sentence stays on the page instead of replacing it.

import { byId } from './panel.js';

export function save(blob, name) {
  const link = document.createElement('a');
  link.href = URL.createObjectURL(blob);
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 1000);
}

export function bindSaving(app) {
  for (const id of ['csv', 'snapshot']) {
    byId(id).addEventListener('click', (event) => {
      event.preventDefault();
      fetched(app, event.currentTarget.href);
    });
  }
}

async function fetched(app, address) {
  app.notice('Writing the section …');
  try {
    const answer = await fetch(address);
    if (!answer.ok) return app.notice(sentence(await answer.text()), 10);
    const name = /filename=([^;]+)/.exec(answer.headers.get('content-disposition') ?? '')?.[1] ?? 'section';
    save(await answer.blob(), name);
    return app.notice('');
  } catch (error) {
    return app.notice(`The section was not written: ${error.message}.`, 10);
  }
}

const sentence = (text) => `The section was not written: ${text.trim().slice(0, 300)}.`;
