// Downloads: what the page has itself, and what the server writes. If the server refuses, the page shows why.

import { messageOf } from './errors.js';
import { pen, pixelRatio } from './device.js';
import { byId } from './dom.js';
import { BOLD, PALETTES } from './layout.js';
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
  byId('png').addEventListener('click', (event) => {
    event.preventDefault();
    if (app.store) savePicture(app);
  });
  for (const id of /** @type {const} */ (['csv', 'export', 'glb', 'print', 'printAll'])) {
    byId(id).addEventListener('click', (event) => {
      event.preventDefault();
      const { view, store } = app;
      const part = id === 'print' && view.length < store.span[1] - store.span[0];
      const said = part ? `${showSpan(view.top, view.bottom, view.units)} is saved as a PDF. Print well, below the log, prints it all.` : '';
      download(app, byId(id).href, id === 'printAll' ? 'The well was' : 'The section was', said);
    });
  }
}

const BAND = 26; // pixels above the picture, for its words

// Save what the stage shows, in its own pixels, under a line with the well and the section.
/** @param {App} app */
function savePicture({ renderer, view, store }) {
  const look = renderer.look();
  const inks = byId('ink');
  const ratio = pixelRatio(inks);
  const canvas = document.createElement('canvas');
  Object.assign(canvas, { width: inks.width, height: inks.height + BAND * ratio });
  const ink = pen(canvas);
  const palette = PALETTES[view.theme];
  ink.fillStyle = palette.paper;
  ink.fillRect(0, 0, canvas.width, canvas.height);
  renderer.gpu?.draw(look); // in this turn of the loop: the browser then still has the picture
  if (renderer.gpu) ink.drawImage(renderer.gpu.canvas, 0, BAND * ratio, inks.width, inks.height);
  ink.drawImage(inks, 0, BAND * ratio);
  ink.scale(ratio, ratio);
  ink.font = BOLD;
  ink.fillStyle = palette.ink;
  ink.fillText(`${byId('well').title || 'helibore'}   MD ${showSpan(Math.max(view.top, store.span[0]), Math.min(view.bottom, store.span[1]), view.units)}`, 8, 17);
  canvas.toBlob((blob) => blob && save(blob, `${byId('well').title || 'helibore'}-${view.top.toFixed(1)}-${view.bottom.toFixed(1)}.png`));
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
