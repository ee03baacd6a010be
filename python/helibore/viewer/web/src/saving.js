// Downloads: what the page has itself, and what the server writes. If the server refuses, the page shows why.

import { messageOf } from './errors.js';
import { pen, pixelRatio, sharpen } from './device.js';
import { byId } from './dom.js';
import { toggleFlight } from './inside.js';
import { late } from './late.js';
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
  for (const kind of /** @type {const} */ (['png', 'svg', 'slide'])) {
    byId(kind).addEventListener('click', (event) => {
      event.preventDefault();
      if (app.store) savePicture(app, kind);
    });
  }
  byId('film').addEventListener('click', () => film(app));
  for (const id of /** @type {const} */ (['csv', 'export', 'glb', 'las', 'print', 'printAll'])) {
    byId(id).addEventListener('click', (event) => {
      event.preventDefault();
      const { view, store } = app;
      const part = id === 'print' && view.length < store.span[1] - store.span[0];
      const said = part ? `${showSpan(view.top, view.bottom, view.units)} is saved as a PDF. Print well, below the log, prints it all.` : '';
      const pane = id === 'print' ? late(app)?.paneOf(app, sharpen) : null; // printed below the tracks
      Promise.resolve(pane).then((body) => download(app, byId(id).href, id === 'printAll' ? 'The well was' : 'The section was', said, body));
    });
  }
}

const BAND = 26; // pixels above a film, for its words

// Draw what the stage shows, in its own pixels, under a line with the well and the section. `drawn`: WebGL was drawn in this
// turn of the loop, until the end of which the browser has the picture.
/** @param {App} app @param {HTMLCanvasElement} canvas @param {Looks} look @param {boolean} drawn */
function copyStage({ renderer: { gpu }, view, store }, canvas, look, drawn) {
  const inks = byId('ink');
  const ratio = pixelRatio(inks);
  const height = inks.height + BAND * ratio;
  if (canvas.width !== inks.width || canvas.height !== height) Object.assign(canvas, { width: inks.width, height });
  const ink = pen(canvas);
  const palette = PALETTES[view.theme];
  ink.resetTransform();
  ink.fillStyle = palette.paper;
  ink.fillRect(0, 0, canvas.width, height);
  if (!drawn) gpu?.draw(look);
  if (gpu) ink.drawImage(gpu.canvas, 0, BAND * ratio, inks.width, inks.height);
  ink.drawImage(inks, 0, BAND * ratio);
  ink.scale(ratio, ratio);
  ink.font = BOLD;
  ink.fillStyle = palette.ink;
  ink.fillText(`${wellName()}   MD ${showSpan(Math.max(view.top, store.span[0]), Math.min(view.bottom, store.span[1]), view.units)}`, 8, 17);
}

const wellName = () => byId('well').title || 'helibore';
/** @param {View} view @param {string} ending */
const fileName = (view, ending) => `${wellName()}-${view.top.toFixed(1)}-${view.bottom.toFixed(1)}${{ straight: '', outside: '-path', down: '-inside', up: '-inside' }[view.camera]}.${ending}`;

// Save what the stage shows, once the part of the page that does it is here.
/** @param {App} app @param {'png' | 'svg' | 'slide'} kind */
function savePicture(app, kind) {
  const more = late(app);
  if (more) more.saveStage(app, kind, sharpen, (blob) => save(blob, fileName(app.view, kind === 'slide' ? 'slide.png' : kind)));
  else if (app.renderer.loading) setTimeout(() => savePicture(app, kind), 50);
}

// Film what the stage shows, frame by frame, until the flight ends; then save the video.
/** @param {App} app */
export function film(app) {
  const { renderer, view } = app;
  if (byId('fly').classList.contains('on')) return toggleFlight(app); // and with it the film
  const canvas = document.createElement('canvas');
  copyStage(app, canvas, renderer.look(), false);
  const recorder = new window.MediaRecorder(canvas.captureStream());
  recorder.ondataavailable = ({ data }) => save(data, fileName(view, /mp4/.test(data.type) ? 'mp4' : 'webm'));
  recorder.start();
  const began = performance.now();
  renderer.filmed = (look, drawn) => {
    copyStage(app, canvas, look, drawn);
    app.notice(`Filming, ${Math.round((performance.now() - began) / 1000)} s. It ends with the hole, or by Stop, and is then saved.`);
  };
  return toggleFlight(app, () => {
    renderer.filmed = null;
    app.notice('');
    recorder.stop();
  });
}

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
