// The 3-D view as a picture that the server prints below the tracks.

import { pen } from './device.js';
import { byId } from './dom.js';
import { HEAD, PALETTES } from './layout.js';
import { drawSide, FINE, sideOf } from './stage_picture.js';

// Return the 3-D view with the picks beside it as a PNG, to be printed; null without one.
/** @param {App} app @param {(ratio: number) => void} sharpen @returns {Promise<Blob | null>} */
export function paneOf({ renderer, view, picking, repaint }, sharpen) {
  const { gpu, straight, rects: { wall: rect } } = renderer;
  if (!gpu || straight || !rect.width) return Promise.resolve(null);
  const inks = byId('ink');
  const planes = picking.planes();
  const look = renderer.look();
  const top = HEAD; // the controls stand above
  const side = sideOf(view, planes, rect.width, rect.height - top);
  const canvas = Object.assign(/** @type {Canvas} */ (document.createElement('canvas')), { width: FINE * (rect.width + side), height: FINE * (rect.height - top), labels: [], strokes: [] });
  const ink = pen(canvas);
  sharpen(FINE);
  renderer.drawInk(look);
  gpu.draw(look);
  ink.scale(FINE, FINE);
  for (const layer of [gpu.canvas, inks]) ink.drawImage(layer, -rect.left, -top, inks.clientWidth, inks.clientHeight);
  ink.translate(rect.width, 0);
  ink.fillStyle = PALETTES[view.theme].paper;
  ink.fillRect(0, 0, side, rect.height);
  if (side) drawSide(ink, look, planes, side, rect.height - top);
  sharpen(0);
  repaint();
  return new Promise((done) => canvas.toBlob(done));
}
