// A film of a flight through the hole: frame by frame what the stage shows, under a line with the well and the section.

import { pen, pixelRatio } from './device.js';
import { byId } from './dom.js';
import { BOLD, PALETTES } from './layout.js';
import { showSpan } from './units.js';

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
  ink.fillText(`${byId('well').title || 'helibore'}   MD ${showSpan(Math.max(view.top, store.span[0]), Math.min(view.bottom, store.span[1]), view.units)}`, 8, 17);
}

// Film what the stage shows until the flight ends, which `toggleFlight` starts and ends; `save` takes the video.
/** @param {App} app @param {(app: App, end?: () => void) => void} toggleFlight @param {(video: Blob, ending: string) => void} save */
export function film(app, toggleFlight, save) {
  const { renderer } = app;
  if (byId('fly').classList.contains('on')) return toggleFlight(app); // and with it the film
  const canvas = document.createElement('canvas');
  copyStage(app, canvas, renderer.look(), false);
  const recorder = new window.MediaRecorder(canvas.captureStream());
  recorder.ondataavailable = ({ data }) => save(data, /mp4/.test(data.type) ? 'mp4' : 'webm');
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
