// Save what the stage shows as a picture, PNG or SVG, under a line with the well and the section; beside it the stereonet and the
// rose of the picks in view. A slide has the stage alone, laid out anew in fewer pixels: its texts are larger in proportion.

import { inLines } from './columns.js';
import { pen, pixelRatio } from './device.js';
import { symbol } from './dip_ink.js';
import { anglesOf } from './dips.js';
import { byId } from './dom.js';
import { BOLD, FONT, label, layout, PALETTES, SMALL } from './layout.js';
import { endOf, eyeDepth, isInside } from './inside.js';
import { FINE_TILES, MOST_TILES } from './lod.js';
import { drawNet } from './net.js';
import { BAND, SLIDE } from './slide.js';
import { marksOf } from './sureness.js';
import { recorder, svgFile } from './svg.js';
import { showDepth, showSpan } from './units.js';
import { captionOf } from './wall_ink.js';

const WIDE = 3840; // pixels of a saved picture, as a slide has at most
export const FINE = 2; // pixels of drawings in an SVG for each CSS pixel
const SLIDE_CLEAR = 28; // pixels above and below the section: a slide has no controls
const WAIT = 15_000; // milliseconds
const ROW = 17; // pixels of a pick in the list below
const WORDS = 66; // pixels of the words between them
const SIDE = { least: 210, most: 420, share: 16 / 9 }; // pixels across of stereonet, rose and list at the right, which make the picture 16 to 9

// Return whether a part of the wall that the picture shows has not arrived: the overview would be drawn there. An exported file
// has all that ever comes.
/** @param {App} app */
function lacks({ view: { top, bottom }, store: { levels: [level] }, contents }) {
  const tiles = level.tilesBetween(top, bottom);
  return !contents && tiles.length <= MOST_TILES && tiles.some((index) => !level.tiles.has(index));
}

// `sharpen` is that of the page, `save` takes the picture. It waits for what has not arrived, at most WAIT.
/** @param {App} app @param {'png' | 'svg' | 'slide'} kind @param {(ratio: number) => void} sharpen @param {(blob: Blob) => void} save @param {number} [began] @returns {void} */
export function saveStage(app, kind, sharpen, save, began = performance.now()) {
  const { renderer, view, store, picking } = app;
  renderer.mostTiles = MOST_TILES;
  if (lacks(app) && performance.now() - began < WAIT) {
    app.ask();
    return void setTimeout(saveStage, 50, app, kind, sharpen, save, began);
  }
  if (lacks(app)) app.notice('Parts of the wall have not arrived: they are drawn coarsely.', 10);
  const inks = byId('ink');
  const vector = kind === 'svg';
  const slide = kind === 'slide';
  const planes = picking.planes();
  const side = slide ? 0 : sideOf(view, planes, inks.clientWidth, inks.clientHeight + BAND);
  const caption = slide && view.camera === 'outside' && renderer.rects.wall.width ? captionOf(pen(inks), renderer.look(), planes, SLIDE.width - 16, true) : [];
  const band = BAND + 16 * caption.length;
  if (slide) {
    inks.slide = {};
    Object.assign(byId('stage').style, { flex: 'none', width: `${SLIDE.width}px`, height: `${SLIDE.height - band}px` });
    renderer.rects = layout(SLIDE.width, SLIDE.height - band, renderer.arrangement);
    const { map, pane } = renderer.rects;
    if (view.tab === '3d' && pane.width) Object.assign(pane, { left: 0, width: SLIDE.width }, (map.width = 0)); // the hole alone
    renderer.gpu?.resize(SLIDE.width, SLIDE.height - band);
    if (!view.eye.length) renderer.aim(SLIDE_CLEAR); // all of the section is seen on the slide, too
  }
  const [width, height] = [inks.clientWidth + side, inks.clientHeight + band];
  const ratio = Math.max(vector ? FINE : Math.min(4, WIDE / width), pixelRatio(inks));
  sharpen(ratio);
  const canvas = Object.assign(/** @type {Canvas} */ (document.createElement('canvas')), { width: Math.round(width * ratio), height: Math.round(height * ratio), labels: [], strokes: [] });
  /** @type {string[]} */
  const parts = [];
  const ink = vector ? recorder(pen(canvas), parts, () => ratio) : pen(canvas);
  const look = renderer.look();
  const { cursor, pinned, ahead } = view;
  const { selected } = picking;
  if (isInside(view)) view.ahead = eyeDepth(look) - endOf(view); // where the held cursor has placed it
  Object.assign(view, { cursor: null, pinned: false }); // a picture has no cursor, and no pick in its colour
  picking.selected = null;
  const palette = PALETTES[view.theme];
  ink.setTransform(ratio, 0, 0, ratio, 0, 0);
  ink.fillStyle = palette.paper;
  ink.fillRect(0, 0, width, height);
  ink.fillStyle = palette.ink;
  ink.font = slide ? BOLD.replace('12px', '16px') : BOLD;
  ink.textBaseline = 'alphabetic';
  ink.fillText(`${byId('well').title || 'helibore'}   MD ${showSpan(Math.max(view.top, store.span[0]), Math.min(view.bottom, store.span[1]), view.units)}`, 8, 17);
  ink.font = FONT;
  caption.forEach((text, i) => ink.fillText(text, 8, 35 + 16 * i));
  ink.translate(0, band);
  if (vector) {
    draw(ink);
    parts.push(`<g transform="translate(0 ${band})">`);
    inks.recorder = recorder(pen(inks), parts, () => ratio);
    renderer.drawInk(look);
    delete inks.recorder;
    parts.push('</g>');
  } else {
    draw(ink); // and with it the camera is placed
    renderer.drawInk(look);
    ink.drawImage(inks, 0, 0, inks.clientWidth, inks.clientHeight);
  }
  ink.translate(inks.clientWidth, 0);
  if (side) drawSide(ink, look, planes, side, height - band);
  delete inks.slide;
  Object.assign(view, { cursor, pinned, ahead });
  picking.selected = selected;
  renderer.mostTiles = FINE_TILES;
  sharpen(0);
  byId('stage').removeAttribute('style');
  if (slide) renderer.fitted = false;
  app.repaint();
  if (vector) save(svgFile(width, height, parts));
  else canvas.toBlob((blob) => blob && save(blob));

  // Draw WebGL now: the browser has its picture until the end of this turn of the loop.
  /** @param {Ink} on */
  function draw(on) {
    if (!renderer.gpu) return;
    renderer.gpu.draw(look);
    on.drawImage(renderer.gpu.canvas, 0, 0, inks.clientWidth, inks.clientHeight);
  }
}

/** @param {View} view @param {Planes} planes */
const inView = (view, { kept, boxes }) => [...kept, ...boxes].filter(({ depth }) => depth >= view.top && depth <= view.bottom).sort((a, b) => a.depth - b.depth);

// Return how wide the part with the picks is beside a picture; 0 without any in view.
/** @param {View} view @param {Planes} planes @param {number} width @param {number} height */
export const sideOf = (view, planes, width, height) => (inView(view, planes).length ? Math.round(Math.min(SIDE.most, Math.max(SIDE.least, SIDE.share * height - width))) : 0);

// Draw the stereonet, the rose and the picks in view, which together fill the height: symbol, depth, class, dip and azimuth of as many
// as there is room for.
/** @param {Ink} ink @param {Looks} look @param {Planes} planes @param {number} width @param {number} height */
export function drawSide(ink, look, planes, width, height) {
  const { view, path } = look;
  const palette = PALETTES[view.theme];
  const shown = inView(view, planes);
  const dials = Math.round(Math.min(2 * width, Math.max(0.55 * height, height - ROW * shown.length - WORDS)));
  const net = drawNet({ ink, width, height: dials }, look, planes, false);
  const words = inLines(ink, shown.some((one) => 'apparent' in one && marksOf(one, path)[0]) ? `${net}; ± 95 %` : net, width - 16);
  words.forEach((text, i) => label(ink, text, width / 2, dials + 10 + 14 * i, { colour: palette.soft, align: 'center', font: SMALL }));
  const first = dials + 24 + 14 * words.length;
  const room = Math.max(0, Math.floor((height - first - 10) / ROW));
  const wide = width >= 360; // the class has room
  shown.slice(0, shown.length > room ? room - 1 : room).forEach((one, i) => {
    const y = first + ROW * i;
    if ('apparent' in one) symbol(ink, 10, y, one.kind, palette.picks[one.kind], palette.paper);
    ink.font = SMALL;
    const angles = 'apparent' in one ? anglesOf({ ...one, pick: one.pick && { ...one.pick, note: '' } }, path) : `${one.opening.toFixed(0)}° wide`;
    const row = /** @type {[string, number, CanvasTextAlign][]} */ ([[showDepth(one.depth, view.units), 84, 'right'], [wide ? one.kind : '', 100, 'left'], [angles, width - 10, 'right']]);
    for (const [text, x, align] of row) if (text) label(ink, text, x, y, { colour: palette.ink, align, font: SMALL });
  });
  if (shown.length > room) label(ink, `and ${shown.length - room + 1} more`, 36, first + ROW * (room - 1), { colour: palette.soft, font: SMALL });
}
