// Draws the page on demand. Two events lead to a frame: `redraw`, after which the tracks' ink and the panels differ (the cursor
// moved), and `repaint`, after which the WebGL picture and the places of the tracks may differ, too. A page at rest draws nothing.

import { looked, toAddress } from './address.js';
import { drawCaliper } from './caliper.js';
import { fitRange, nearBit, Q_ATTRIBUTE, Q_NEAREST, quantityOf, valuesInView } from './color.js';
import { drawColumn } from './column.js';
import { pixelRatio, sized } from './device.js';
import { drawDips, drawLegend, tadpoles } from './dip_ink.js';
import { heldPlane } from './dips.js';
import { byId, hide, oncePerFrame, say, write } from './dom.js';
import { messageOf } from './errors.js';
import { Gpu } from './gpu.js';
import { bindOrbit } from './input.js';
import { isStale, lamp, spokenText } from './lamp.js';
import { late } from './late.js';
import { FONT, HEAD, imageRects, layout, PALETTES } from './layout.js';
import { FINE_TILES } from './lod.js';
import { DepthMap } from './map.js';
import { drawNotes } from './notes.js';
import { applyTheme, Histogram, links, listZones, paperScale, readout, reflect, writeBrief } from './panel.js';
import { drawPolar, turnAt, turnText } from './polar.js';
import { writeRig } from './rig.js';
import { NARROW, otherPass, PHONE } from './selection.js';
import { hung, stringRows } from './string.js';
import { edges, sharp } from './strokes.js';
import { coverage } from './tiles.js';
import { drawTops, intervalAt } from './tops.js';
import { drawAxis, drawAxisLabels, drawCursor, drawImageHead, drawOutside } from './tracks.js';
import { inMetres, showDepth, showLength } from './units.js';

const UNSEEN = 250; // milliseconds that a change outside the section may wait for a frame
const SLOW = 40; // milliseconds: a picture that takes longer is drawn coarse while it moves
const AIM = 35; // milliseconds
const MOVING = 200; // milliseconds: a picture moves if the next one follows within this and twice the time to draw it
const START = ['Pick dips (D), then drag along a bed on the image. Help (?) has the steps.', 'Pick dips (D); Help (?) has the steps'];
export const seconds = () => performance.now() / 1000;

// Return the share of the pixels in each direction that a coarse picture has, in tenths: so many as are drawn in `AIM`.
/** @param {number} cost */
export const coarseness = (cost) => Math.min(0.6, Math.max(0.3, Math.round(10 * Math.sqrt(AIM / cost)) / 10));

export class Renderer {
  frames = 0;
  /** @type {number | null} */
  firstPicture = null;
  fitted = false;
  mostTiles = FINE_TILES; // of the wall at once: a longer section is drawn from the overview
  loading = false; // more.js
  stale = true; // the WebGL canvas shows something else
  paintedAt = 0;
  rects = /** @type {Rects} */ (/** @type {unknown} */ (null));
  /** @type {Vertex | null} */
  vertex = null; // nearest to the cursor
  /** @type {Gpu | null} */
  gpu = null; // null without WebGL 2
  /** @type {import('./camera.js').Orbit | null} */
  controls = null;
  /** @type {((look: Looks, drawn: boolean) => void) | null} */
  filmed = null; // takes each frame
  /** @type {number | undefined} */
  sharpening = undefined; // timer of a sharp picture after a coarse one
  /** @type {Record<'unseen' | 'glowing' | 'addressing', number | undefined>} */
  timers = { unseen: undefined, glowing: undefined, addressing: undefined };

  /** @param {App} app */
  constructor(app) {
    this.app = app;
    this.redraw = oncePerFrame(() => this.draw());
    this.repaint = () => {
      this.stale = true;
      this.redraw();
    };
    this.map = new DepthMap();
    this.histogram = new Histogram(byId('histogram'), this.redraw);
  }

  // A tile has changed.
  /** @param {Tile} tile */
  changed(tile) {
    if (this.rects && this.look().imagePieces.some((piece) => piece.tile === tile)) this.repaint();
    else this.timers.unseen ??= setTimeout(this.redraw, UNSEEN); // mostly the map: every write changes the overview
  }

  openGpu() {
    try {
      this.gpu = new Gpu(byId('gl'));
      this.controls = bindOrbit(this.app, this.gpu);
      byId('gl').addEventListener('webglcontextrestored', this.repaint);
    } catch (error) {
      this.plain = true;
      this.app.notice(`This browser offers no WebGL 2, so there is no 3-D view and the image is drawn without it. (${messageOf(error)})`);
    }
  }

  // What the places of the panels depend on, besides the size of the stage.
  /** @returns {Arrangement} */
  get arrangement() {
    const { app: { view, store, picking, curves, selection }, straight } = this;
    const dips = picking.shown && (picking.on || !PHONE.matches || store.basis === 'gauge'); // a phone has room for the caliper or the dips
    /** @type {[string, number][]} */
    const columns = (store?.columns ?? []).flatMap((name, i) => {
      const pipes = store.placed.filter((one) => one[3] === name && one[4]);
      /** @param {number[]} ends */
      const within = ([top, bottom]) => pipes.some(([, start, stop]) => start < bottom && (stop ?? Infinity) > top);
      const empty = within(store.span) && !within([view.top, view.bottom]); // casings have a track where one is in view
      return view.curves.includes(name) && !empty ? [[`column${i}`, pipes.length ? 100 : 132]] : [];
    });
    return { dips, measured: store?.basis !== 'gauge', rig: view.rig, straight, outside: Boolean(this.gpu) && !straight, curves: curves.shown.length, columns, chosen: view.widths, order: view.order, beside: PHONE.matches || view.rig ? 0 : selection.besides.length, tab: view.rig ? null : NARROW.matches ? view.tab : straight || view.tab !== '3d' ? null : '3d' };
  }

  // Whether the hole is drawn straightened, with the same depth axis as the tracks.
  get straight() {
    return this.app.view.camera === 'straight' && Boolean(this.gpu);
  }

  // The scale of paper of the tracks, if it is one of those offered.
  get paper() {
    return paperScale(this.app.view, this.rects.image);
  }

  // The zones without those that are picks.
  get zones() {
    const { app } = this;
    const { zones, store, picking: { kept } } = app;
    return (zones.length && kept.length && late(app)?.unpicked(zones, kept, store.bitRadius)) || zones;
  }

  // Everything that one frame shows; drawing does not change it.
  /** @returns {Looks} */
  look() {
    const { app, rects } = this;
    const { store, view, path, selection, bit: bitDepth } = app;
    const quantity = view.rig ? nearBit(selection.quantity) : selection.quantity;
    const { top, bottom } = view;
    const turns = (bottom - top) / Math.abs(store.levels[0].pitch);
    const fine = turns / store.levels[0].rows <= this.mostTiles;
    const wallPieces = coverage(store, top, bottom, fine);
    const imagePieces = turns <= 16 * rects.image.height * pixelRatio(byId('ink')) ? wallPieces : coverage(store, top, bottom, false); // a pixel shows at most the mean of 16 turns
    const now = seconds();
    /** @type {Look} */
    const made = {
      store, view, path, rects, bitDepth, oldBit: view.rig && isStale(app), asked: quantity, quantity,
      imagePieces,
      wallPieces,
      imageRect: rects.image,
      wallRect: rects.wall,
      background: PALETTES[view.theme].background,
      dark: view.theme === 'dark',
      notes: app.picking.notes,
      intervals: store.intervals,
      zones: (view.rig && late(app)?.zonesInRig(app)) || this.zones,
      held: view.pinned ? heldPlane(app.picking.planesOfAll(), view) : undefined,
      light: quantity.mode < Q_NEAREST ? [...selection.besides, ...selection.quantities].find(({ mode, length }) => mode === Q_ATTRIBUTE && !length) : undefined,
      growing: app.growing,
      arms: app.curves.arms,
      string: hung(app),
      over: quantityOf(selection.quantities, 'over'),
      glow: (tile) => (app.replay.past ? [] : app.glow.on(tile, now)),
    };
    /** @type {Look[]} */
    const beside = selection.besides.map((one, i) => ({ ...made, asked: one, quantity: one, imageRect: rects[`beside${i}`], rects: { ...rects, image: rects[`beside${i}`], caliper: { ...rects.caliper, width: 0 } } }));
    const images = [made, ...beside.filter(({ imageRect }) => imageRect)].map((one) => (one.asked.inView ? { ...one, quantity: { ...one.asked, ...fitRange(one.asked, valuesInView(one, one.asked)) } } : one));
    const curtain = view.curtain === null ? null : { ...(images[1] ?? { ...made, view: Object.create(view, { pass: { value: otherPass(view) } }) }), imageRect: rects.image, from: view.curtain };
    return { ...images[0], images, curtain };
  }

  draw() {
    const { app, gpu, timers } = this;
    applyTheme(app.view);
    if (!app.store || !app.path.count || !this.rects) return writeRig(app);
    const began = performance.now();
    clearTimeout(timers.unseen);
    timers.unseen = undefined;
    app.ask();
    if (this.controls) this.controls.enabled = app.view.camera === 'outside';
    if (this.stale) this.arrange();
    if (!this.fitted) this.aim();
    const look = this.look();
    const painted = this.stale;
    if (gpu && painted) this.paint(gpu, look);
    this.stale = false;
    this.drawInk(look);
    this.filmed?.(look, painted);
    this.drawPanels(look);
    this.frames++;
    if (this.firstPicture === null && look.imagePieces.length) this.firstPicture = performance.now();
    if (app.glow.fade(seconds())) this.glowOn(began);
    clearTimeout(timers.addressing);
    timers.addressing = setTimeout(() => (app.notebook ? app.notebook.look(looked(app)) : history.replaceState(null, '', toAddress(app))), 400);
    return undefined;
  }

  // Draw the WebGL canvas. On a slow machine the picture is coarse while it moves.
  /** @param {Gpu} gpu @param {Looks} look */
  paint(gpu, look) {
    const began = performance.now();
    const coarse = gpu.cost > SLOW && began - this.paintedAt < MOVING + 2 * gpu.cost && !this.app.glow.ranges.length && gpu.stats.pictures > 2;
    this.paintedAt = began;
    clearTimeout(this.sharpening);
    this.sharpening = coarse ? setTimeout(() => this.sharpen(), MOVING + Math.min(gpu.cost, 1000)) : undefined;
    gpu.draw(look, coarse ? coarseness(gpu.cost) : 1);
    if (!coarse) gpu.whenDrawn(() => (gpu.cost = performance.now() - began));
  }

  sharpen() {
    this.paintedAt = 0;
    this.sharpening = undefined;
    this.repaint();
  }

  // Fading takes at most a quarter of the time, so that new values need not wait for it.
  /** @param {number} began */
  glowOn(began) {
    clearTimeout(this.timers.glowing);
    const later = () => {
      clearTimeout(this.timers.glowing);
      this.timers.glowing = setTimeout(this.repaint, Math.max(200, 4 * (performance.now() - began)));
    };
    if (this.gpu) this.gpu.whenDrawn(later);
    else later();
  }

  /** @param {Looks} look */
  drawInk(look) {
    const { app, rects, gpu, straight } = this;
    const { picking, curves, view } = app;
    const { ink, width, height } = sized(byId('ink'));
    ink.clearRect(0, 0, width, height);
    ink.font = FONT;
    if (rects.image.width && this.plain) for (const one of look.images) late(app)?.plainImage(ink, one);
    if (rects.axis.width) drawAxis(ink, look);
    if (rects.image.width) for (const one of look.images) drawImageHead(ink, one);
    const calipers = drawCaliper(ink, look);
    if (rects.curves) curves.draw(ink, look);
    const more = look.store.columns.length ? late(app) : undefined;
    more?.drawColumns(ink, look);
    drawOutside(ink, look);
    if (look.curtain && gpu) late(app)?.drawCurtain(ink, look, look.curtain);
    this.map.draw(ink, look, picking.drawn);
    const planes = picking.planes();
    drawDips(ink, look, planes, straight);
    drawTops(ink, look);
    if (rects.image.width) drawNotes(ink, look);
    if (picking.on) for (const one of look.images) late(app)?.drawPoints(ink, one, picking.points);
    if (picking.on) late(app)?.writeCard(picking, planes);
    hide(!picking.drawn.length, 'netSection');
    if (byId('net').clientHeight) byId('netText').textContent = late(app)?.drawNet(sized(byId('net')), look, planes) ?? '';
    if (rects.axis.width) drawCursor(ink, look);
    if (rects.dips) tadpoles(ink, look, rects.dips, planes); // above the line of the cursor
    if (picking.on && !picking.selected) late(app)?.drawNext(ink, look, picking.kind);
    if (rects.axis.width) drawAxisLabels(ink, look);
    if (straight && rects.wall.width) drawColumn(ink, look);
    else if (gpu && rects.wall.width) late(app)?.drawWallInk(ink, look, gpu, calipers, planes);
    if (rects.wall.width && gpu) more?.drawPipes(ink, look, gpu);
    drawLegend(ink, look, planes, picking.on || ink.canvas.slide || look.view.picks === 'off' ? [] : NARROW.matches ? ['☰ has Pick dips and Help'] : START);
    for (const one of imageRects(rects)) if (one.width) edges(ink, sharp(one, -1), PALETTES[view.theme].line);
  }

  /** @param {Look} look */
  drawPanels(look) {
    const { app } = this;
    const { view, store, path, selection, figures: section, alarms } = app;
    const { cursor } = view;
    const wall = store.levels[0];
    const k = cursor && cursor.toolface !== null ? wall.quadAt(cursor.depth, cursor.toolface) : -1;
    const covered = cursor !== null && cursor.toolface !== null;
    const turned = turnAt(store, view, cursor?.depth ?? view.middle, look.arms);
    // The browser lays the page out anew when a size is read after a text was written, so what needs sizes comes first.
    if (byId('polar').clientHeight) drawPolar(byId('polar'), look, turned, look.over);
    if (byId('histogram').clientHeight) this.histogram.draw(look);
    this.vertex = cursor && cursor.toolface !== null ? store.near(cursor.depth, cursor.toolface) : null;
    selection.read = readout({ store, view, path, vertex: this.vertex });
    const { name, thin } = look.quantity;
    if (thin) selection.read.push([`Rows of ${name}`, `each ${inMetres(thin)}, turns each ${inMetres(Math.abs(wall.pitch))}: wall.pitch=${inMetres(thin).replace(' ', '')} shows all`]);
    const interval = intervalAt(store.intervals, cursor?.depth ?? view.middle);
    if (interval) selection.read.push(['Interval', interval]);
    if (store.columns.length) selection.read.push(...(late(app)?.columnRows(look, cursor?.depth ?? view.middle) ?? []));
    selection.read.push(...app.curves.readout(cursor?.depth ?? view.middle), ...stringRows(look.string, view.units));
    write('readout', cursor || !NARROW.matches ? selection.read : selection.read.filter(([, text]) => !/^[–/ ]*$/.test(text))); // on a touch screen nothing hovers: empty values are left out
    if (selection.toSay && (!covered || wall.locate(k).tile)) {
      selection.toSay = false;
      byId('spoken').textContent = spokenText(app);
    }
    hide(!look.growing, 'follow');
    say('readTitle', view.pinned ? 'Cursor (held)' : cursor ? 'Cursor' : 'Middle of the log');
    const figures = turnText(look, turned, (m, digits) => showLength(m, view.units, digits ?? (view.units === 'mm' ? 1 : 3)));
    say('crossTitle', `Cross-section at ${showDepth(cursor?.depth ?? view.middle, view.units)}`);
    write('turn', figures);
    if (NARROW.matches) writeBrief(look, selection.read, store.basis === 'azimuthal' ? figures : []);
    if (app.replay.past) late(app)?.drawRun(sized(byId('run')), app);
    section.ask();
    section.write();
    alarms.write(view);
    listZones(this.zones, view, alarms, (zone) => selection.showZone(zone), app.noZone);
    reflect(view, look.quantity, this.rects.image);
    links(app, toAddress(app));
    lamp(app);
  }

  // Lay the tracks out anew. If the size of the window changed, they keep a scale of paper; a change of tab keeps the section.
  arrange() {
    const { app: { store, view, selection }, arrangement } = this;
    const { tab } = arrangement;
    const sameTab = document.body.dataset.tab === (tab ?? '');
    const paper = store && this.rects && !view.rig && sameTab && tab !== 'section' && tab !== 'zones' ? this.paper : undefined;
    if (!sameTab) document.body.dataset.tab = tab ?? ''; // writing it lays the page out anew
    const { clientWidth: width, clientHeight: height } = byId('stage');
    const before = this.rects?.wall.width;
    this.rects = layout(width, height, arrangement);
    if (before !== this.rects.wall.width && !view.eye.length) this.fitted = false;
    this.gpu?.resize(width, height);
    const { pane: wall } = this.rects;
    hide(this.straight, 'orbit');
    Object.assign(byId('orbit').style, { left: `${wall.left}px`, top: `${HEAD - 24}px`, width: `${wall.width}px`, height: `${height - HEAD + 24}px` });
    Object.assign(byId('wallHead').style, { left: `${wall.left}px`, width: `${wall.width}px` });
    const below = wall.width ? { left: wall.left + 90, width: wall.width - 100 } : { left: 8, width: width - 16 }; // a tab without the hole
    Object.assign(byId('replay').style, { left: `${below.left}px`, width: `${below.width}px` });
    Object.assign(byId('notice').style, { left: `${wall.left + 10}px`, maxWidth: `${wall.width - 20}px` });
    if (paper && paper !== this.paper) selection.setLength(`1:${paper}`); // a scale of paper stays
  }

  // Look at the whole section from the side, a little from above, in whatever direction the hole runs.
  fit() {
    Object.assign(this.app.view, { eye: [], head: [0, 0] });
    this.aim();
  }

  // Look at the section from where the eye was put, else from where all of it is seen.
  /** @param {number} [clear] pixels above and below it */
  aim(clear) {
    const { gpu, controls, app: { path, view, store } } = this;
    if (!path?.count || !gpu || !controls) return;
    gpu.lookAtSection(view.length, path.at(view.middle), view.tubeFactor(store) * store.bitRadius, this.rects.wall, clear);
    controls.target = [0, 0, 0];
    if (view.eye.length) {
      gpu.outside.position = view.eye.slice(0, 3);
      controls.target = view.eye.slice(3);
      gpu.outside.lookAt(controls.target);
    }
    this.fitted = true;
    this.repaint();
  }

  /** @param {number} x @param {number} y @param {boolean} [hold] */
  pickAt(x, y, hold = false) {
    const { view, selection } = this.app;
    const found = this.gpu?.pick(this.look(), x, y + HEAD - 24);
    if (!found) return view.point(null, false);
    const { level } = found.tile;
    const half = level.rings || selection.quantity.mode === Q_ATTRIBUTE ? 0.5 : 0; // the middle of a quad, or a vertex
    const k = found.tile.index * level.tileSize + found.at + half * (level.sectors + 1);
    return view.point({ depth: level.depth(k), toolface: level.toolface(found.at + half) }, hold);
  }
}
