// The page: joins connection, store, view and panels, and draws on demand.
//
//   message -> Store/Path -> redraw        user -> View -> redraw, and tiles asked for where the section needs them
//
// Nothing is drawn unless something changed; a page at rest costs nothing.

import { Alarms } from './alarms.js';
import { fromAddress, looked, toAddress } from './address.js';
import { Connection, LOST, STOPPED } from './connection.js';
import { fitRange, Q_ATTRIBUTE, quantities, quantityOf, takeRanges, valuesInView } from './color.js';
import { drawCaliper } from './caliper.js';
import { Curves } from './curves.js';
import { drawColumn } from './column.js';
import { messageOf } from './errors.js';
import { Exported, exportedContents } from './exported.js';
import { Glow } from './glow.js';
import { ageOf, lamp, spokenText } from './lamp.js';
import { Gpu } from './gpu.js';
import { whenHosted } from './host.js';
import { bindControls, bindKeys, bindOrbit, bindTracks } from './input.js';
import { FONT, HEAD, imageRects, layout, PALETTES } from './layout.js';
import { drawDips, drawLegend, drawNext, drawPoints } from './dip_ink.js';
import { DepthMap } from './map.js';
import { drawNet } from './net.js';
import { drawNotes, Notes } from './notes.js';
import { applyTheme, byId, disableControls, fillSelects, Histogram, links, listZones, nameCuts, options, paperScale, readout, reflect, sectionText, showBasis, write, writeBrief } from './panel.js';
import { leftEdge, Path } from './path.js';
import { Picking } from './picking.js';
import { PlainImage } from './plain_image.js';
import { Replay } from './replay.js';
import { RECENT, recent, writeRig } from './rig.js';
import { bindSaving } from './saving.js';
import { edges, sharp } from './strokes.js';
import { drawPolar, sized, turnAt, turnText } from './polar.js';
import { fromTemplate } from './template.js';
import { coverage, Store } from './tiles.js';
import { drawAxis, drawAxisLabels, drawCursor, drawImageHead, drawOutside, scaleLength } from './tracks.js';
import { LENGTHS, scaleOf, showDepth, showLength, showSpan } from './units.js';
import { View } from './view.js';
import { drawWallInk } from './wall_ink.js';
import { bySeverity, jump, turnTowards } from './zones.js';

const NARROW = window.matchMedia('(max-width: 999px)');
const PHONE = window.matchMedia('(max-width: 599px)');
const DARK = window.matchMedia('(prefers-color-scheme: dark)');
const FINE_TILES = 64; // a longer section is drawn from the overview
const MEMORY = 256 * 2 ** 20; // bytes of tiles, textures included
const UNSEEN = 250; // milliseconds that a change outside the section may wait for a frame
const SLOW = 40; // milliseconds: a picture that takes longer is drawn coarse while it moves
const MOVING = 200; // milliseconds: a picture moves if the next one follows within this and twice the time to draw it
const USUAL_SCALE = 200; // of paper, at first
const ROOM_FOR_CURVES = 800; // pixels: in a narrower stage, a track of curves would make the other tracks narrower
const SUMMARY_WAIT = 250; // milliseconds that the section rests before its figures are requested
const START = ['Pick dips (D), then drag along a bed on the image. Help (?) has the steps.', 'Pick dips (D); Help (?) has the steps'];
const seconds = () => performance.now() / 1000;
// A name that may be broken into lines behind its underscores, as it may behind hyphens.
/** @param {string} name */
const breakable = (name) => name.split(/(?<=_)/).flatMap((part) => [part, document.createElement('wbr')]);

export class App {
  // The wall and its path, once the server has begun it; null before.
  store = /** @type {Store} */ (/** @type {unknown} */ (null));
  path = /** @type {Path} */ (/** @type {unknown} */ (null));
  /** @type {Quantity[]} */
  quantities = [];
  /** @type {number | null} */
  bitDepth = null;
  /** @type {number | null} */
  holeDepth = null;
  /** @type {number | null} */
  newest = null;
  ended = false;
  shape = 'wall'; // whose diameters the zones are judged by: the wall's, or those of a tool with few arms
  channels = 0; // version of the picture of the rig's channels; 0: there are none
  /** @type {TightAhead | null} */
  ahead = null; // tight hole ahead of a bit that is tripped
  prints = false; // whether the server prints sections
  /** @type {number | null} */
  opened = null; // the top of the section that a saved wall began with
  sources = '';
  /** @type {string[]} */
  lost = []; // names of the sources that are not connected
  /** @type {number | null} */
  lastWrite = null;
  /** @type {Zone[]} */
  zones = [];
  /** @type {Zone[] | null} */
  zonesBefore = null; // the zones of the previous state of the same wall
  /** @type {Summary | null} */
  summary = null;
  summarized = '';
  summaryOf = false; // whether the figures are of the last metres, as in rig mode
  summaryPending = false;
  status = 'connecting';
  words = '';
  frames = 0;
  /** @type {number | null} */
  firstPicture = null;
  scheduled = false;
  fitted = false;
  painted = ''; // what the WebGL canvas shows
  paintedAt = 0;
  arranged = '';
  /** @type {Colours | null} */
  colours = null; // the colours of the address, until the quantities are known
  /** @type {Quad | null} */
  quad = null; // under the cursor
  /** @type {string[][]} */
  read = []; // the read-out: pairs of name and text
  rects = /** @type {Rects} */ (/** @type {unknown} */ (null));
  /** @type {Host | null} */
  notebook = null; // the notebook that shows the page
  /** @type {Contents | null} */
  contents = null; // of an exported file
  /** @type {Gpu | null} */
  gpu = null; // null without WebGL 2
  /** @type {import('./camera.js').Orbit | null} */
  controls = null;
  toSay = false; // say the values at the cursor when they have arrived
  // Timers.
  /** @type {Record<'noticed' | 'unseen' | 'sharpening' | 'glowing' | 'addressing' | 'speaking', number | undefined>} */
  timers = { noticed: undefined, unseen: undefined, sharpening: undefined, glowing: undefined, addressing: undefined, speaking: undefined };

  constructor() {
    this.redraw = () => this.schedule();
    this.view = new View(this.redraw);
    this.glow = new Glow();
    this.map = new DepthMap();
    this.histogram = new Histogram(byId('histogram'), this.redraw);
    fillSelects();
    disableControls(true);
    this.openGpu();
    bindTracks(this);
    bindControls(this);
    bindKeys(this);
    bindSaving(this);
    /** @type {Replay} */
    this.replay = new Replay(this);
    byId('zoneBefore').addEventListener('click', () => this.jump(-1));
    byId('zoneNext').addEventListener('click', () => this.jump(1));
    /** @type {Curves} */
    this.curves = new Curves(this);
    /** @type {Picking} */
    this.picking = new Picking(this);
    /** @type {Notes} */
    this.notes = new Notes(this);
    /** @type {Alarms} */
    this.alarms = new Alarms(this);
    // The figures of the section stand below the log, or on a narrow screen in the tab of the section.
    const placeFigures = () => document.querySelector(NARROW.matches ? 'aside' : 'footer')?.prepend(byId('foot'));
    NARROW.addEventListener('change', placeFigures);
    placeFigures();
    new ResizeObserver(() => this.resize()).observe(byId('stage'));
    this.resize();
    this.contents = exportedContents();
    this.colours = fromAddress(this, location.hash || (this.contents?.address ?? ''));
    this.view.followTheme(DARK.matches);
    DARK.addEventListener('change', ({ matches }) => this.view.followTheme(matches));
    window.addEventListener('hashchange', () => this.readdress());
    window.addEventListener('beforeunload', (event) => this.picking.waits && event.preventDefault());
    setInterval(() => (lamp(this), this.view.rig && this.store && writeRig(this)), 1000);
    const { protocol, host, search } = location;
    /** @type {Handlers} */
    const on = {
      handshake: (handshake) => this.begin(handshake),
      state: (state) => this.takeState(state),
      picks: (picks) => this.picking.receive(picks),
      write: (message) => this.write(message),
      frames: (message) => this.takeFrames(message),
      status: (status, words) => this.say(status, words),
    };
    this.connection = this.contents ? new Exported(this.contents, on) : new Connection(`${protocol === 'https:' ? 'wss' : 'ws'}://${host}/ws${search}`, on);
    if (this.contents?.hosted) {
      whenHosted((notebook) => {
        Object.assign(this, { contents: null, notebook, connection: new Connection('', on, notebook) });
        notebook.show = (top, bottom) => this.store && this.view.show(top, bottom - top, this.store);
      });
    }
  }

  openGpu() {
    try {
      this.gpu = new Gpu(byId('gl'));
      this.controls = bindOrbit(this, this.gpu);
      byId('gl').addEventListener('webglcontextrestored', () => {
        this.painted = '';
        this.redraw();
      });
    } catch (error) {
      this.plain = new PlainImage();
      this.notice(`This browser offers no WebGL 2, so there is no 3-D view and the image is drawn without it. (${messageOf(error)})`);
    }
  }

  /** @param {string} text @param {number} [shownFor] */
  notice(text, shownFor = 0) {
    byId('notice').textContent = text;
    byId('notice').hidden = !text;
    clearTimeout(this.timers.noticed);
    if (shownFor) this.timers.noticed = setTimeout(() => (byId('notice').hidden = true), 1000 * shownFor);
  }

  /** @param {Handshake} handshake */
  begin(handshake) {
    this.replay.close();
    if (this.store) this.forget();
    this.store = new Store(handshake);
    this.curves.offered = [];
    disableControls(false);
    byId('gl').hidden = false;
    showBasis(handshake);
    this.picking.begin(handshake);
    this.alarms.begin(handshake.session);
    this.path = new Path(handshake.start_depth, handshake.frame_step, handshake.reference, handshake.assumed);
    this.glow.rows = this.store.levels[0].rows;
    const kept = this.quantities;
    this.quantities = quantities(this.store).map((q) => {
      const old = kept.find(({ id, mode, attribute }) => id === q.id && mode === q.mode && attribute === q.attribute);
      return old ? { ...q, ...old } : q;
    });
    options('quantity', this.quantities.map(({ id, name }) => [id, name]));
    const { tab } = this.view;
    this.view.tab = 'log'; // the height of this tab gives the section its length, also if the page begins in another tab
    if (handshake.template) this.arrange(handshake.template);
    else this.view.usual(...this.usualTracks(handshake.curves ?? []));
    if (this.colours) Object.assign(this.quantity, this.colours);
    this.colours = null;
    byId('well').replaceChildren(...breakable(handshake.well || 'helibore'));
    byId('well').title = handshake.well;
    document.title = handshake.well ? `${handshake.well} – helibore` : 'helibore';
    this.resize();
    if (!this.view.sized && !handshake.template?.scale && !this.view.rig) {
      this.setLength(`1:${USUAL_SCALE}`);
      this.view.keepLength();
    }
    this.view.tab = tab;
    if (this.view.follow) this.view.followEnd(this.store);
    this.ask();
    this.redraw();
  }

  // Show the tracks of a template, unless the address has chosen some.
  /** @param {Template} template */
  arrange(template) {
    if (this.view.order.length) return;
    this.view.showTracks(fromTemplate(template, this.quantities));
    this.resize();
    if (template.scale) this.setLength(`1:${template.scale}`);
  }

  forget() {
    for (const level of this.store.levels) for (const tile of level.tiles.values()) tile.textures?.dispose();
    this.fitted = this.view.follow ? this.fitted : true;
    this.zonesBefore = null;
  }

  /** @param {State} state */
  takeState({ begun, sources, bit_depth: bit, hole_depth: hole, newest, now, ended, true_depth: trueDepth, ranges, zones, curves = [], curves_version: version = 0, alarms = [], lost = [], prints = false, shape = 'wall', channels = 0, ahead = null }) {
    Object.assign(this, { sources, lost, shape, channels, ahead });
    if (!begun) this.alarms.feed = [...alarms].reverse();
    if (!begun) return this.say('waiting', `${this.store ? 'The server was started again; this is the picture from before. ' : ''}Waiting for the first samples.${sources ? `\n${sources}` : ''}`);
    this.alarms.take(this.zonesBefore, zones, !this.contents && !ended && (newest !== null || (this.lastWrite !== null && this.zones.length > 0)), alarms);
    this.zones = this.zonesBefore = zones;
    document.body.classList.toggle('saved', ended && newest === null);
    this.curves.offer(curves, version);
    this.path.trueDepth = trueDepth;
    takeRanges(this.quantities, ranges);
    this.prints = prints;
    this.bitDepth = bit;
    this.holeDepth = hole;
    this.newest = newest === null ? null : newest + (Date.now() / 1000 - now); // from the server's clock to the clock of this machine
    this.ended = ended;
    this.openSaved();
    if (this.view.follow && this.store) this.view.followEnd(this.store, this.bit);
    lamp(this);
    return this.redraw();
  }

  // A saved wall does not grow. Until the user moves or picks, show the worst zone; if there is no zone, the middle pick; if
  // there is no pick either, the middle of the wall.
  openSaved() {
    const { view, store, zones, picking } = this;
    if (!this.ended || this.newest !== null || !store || picking.on || !(view.follow || view.top === this.opened)) return;
    const [worst] = bySeverity(zones);
    const { span } = store;
    const picked = picking.kept.map(({ depth }) => depth).filter((depth) => depth >= span[0] && depth <= span[1]).sort((a, b) => a - b);
    const [top, bottom] = worst ? [worst.start, worst.stop] : picked.length ? Array(2).fill(picked[picked.length >> 1]) : span;
    view.show((top + bottom - view.length) / 2, view.length, store);
    this.opened = view.top;
  }

  /** @param {Write} message */
  write(message) {
    const { store } = this;
    const level = store.levels[message.level];
    const before = level.size;
    const filled = level.tiles.get(message.tile)?.filled ?? 0;
    const tile = store.apply(message);
    if (message.level === 0 && message.live) {
      const start = tile.index * level.tileSize + message.first;
      this.glow.add(start, start + message.count, message.first + message.count <= filled, seconds());
      this.lastWrite = performance.now();
    }
    if (level.size !== before && message.level === 0) {
      if (this.view.follow) this.view.followEnd(store, this.bit);
      this.ask();
    }
    if (this.rects && this.look().imagePieces.some((piece) => piece.tile === tile)) this.redraw();
    else this.timers.unseen ??= setTimeout(this.redraw, UNSEEN); // mostly the map: every write changes the overview
  }

  /** @param {Frames} message */
  takeFrames(message) {
    const { count, surveyed } = this.path;
    this.path.apply(message);
    this.view.choose({ cut: nameCuts(this.path, this.view.cut) });
    if (count && this.path.surveyed !== surveyed) this.fitted = false; // the hole has another direction: look at it anew
    this.redraw();
  }

  /** @param {string} status @param {string} words */
  say(status, words) {
    this.status = status;
    this.words = words;
    const box = byId('connection'); // longer texts than the lamp has room for
    box.textContent = words;
    box.hidden = !words || words === LOST || words === STOPPED;
    lamp(this);
    this.redraw();
  }

  // Subscribe to the tiles around the section and to the growing tile; keep the other tiles that fit in memory.
  ask() {
    const { store, view } = this;
    if (!store) return;
    const wall = store.levels[0];
    const near = wall.tilesBetween(view.top - view.length / 2, view.bottom + view.length / 2);
    const growing = Math.floor(Math.max(0, wall.size - 1) / wall.tileSize);
    const seen = wall.tilesBetween(view.top, view.bottom);
    const wanted = new Set([...(seen.length > FINE_TILES ? [] : near.length > FINE_TILES ? seen : near), growing, growing + 1]);
    if (view.cursor) wanted.add(Math.min(wall.tileAtDepth(view.cursor.depth), growing));
    for (const index of seen) store.touch(wall.tiles.get(index));
    for (const tile of store.surplus(MEMORY, wanted)) {
      tile.textures?.dispose();
      wall.tiles.delete(tile.index);
    }
    const held = new Set([...wall.tiles.keys(), ...wanted]);
    const mask = (1 << store.attributes.length) - 1;
    const focus = Math.min(view.follow ? growing : wall.tileAtDepth(view.middle), growing);
    this.connection.subscribe([...held].sort((a, b) => a - b), focus, mask);
  }

  // The depth of the bit, or in a replay its depth at that moment.
  /** @returns {number | null} */
  get bit() {
    return this.replay.past ? this.replay.past.bitDepth : this.bitDepth;
  }

  // The quantities of the images beside the first image.
  get besides() {
    return this.view.beside.filter((id) => id !== this.quantity?.id).map((id) => this.quantities.find((one) => one.id === id)).filter((one) => one !== undefined);
  }

  // Return the images beside the first image, and the curves, with which the page begins: as many images of the wall as have room
  // beside the panel, which rig mode hides; and the curves of files (`given`), if a track of curves has room. An exported file
  // holds only the curves that it was made with. A phone has room for one image: if no shape was measured, one that was.
  /** @param {string[]} given @returns {[beside: string[], curves: string[], first?: string]} */
  usualTracks(given) {
    const { contents } = this;
    document.body.classList.remove('rig');
    const width = byId('stage').clientWidth;
    document.body.classList.toggle('rig', this.view.rig);
    const room = NARROW.matches ? 1 : Math.floor((width - 600) / 400);
    const curves = NARROW.matches || width < ROOM_FOR_CURVES ? [] : given.filter((name) => !contents || name in contents.curves);
    const images = this.quantities.filter(({ mode, length }) => mode === Q_ATTRIBUTE && !length).map(({ id }) => id);
    const beside = images.filter((id) => id !== this.quantity.id).slice(0, Math.max(0, room));
    return [beside, curves, PHONE.matches && this.store.basis === 'average' ? images[0] : undefined];
  }

  // Keep the first image beside the others, or drop it.
  keepBeside() {
    const { view, quantity } = this;
    if (view.beside.includes(quantity.id)) return view.showImages(quantity.id, view.beside.filter((id) => id !== quantity.id));
    const next = this.quantities.find(({ id }) => id !== quantity.id && !view.beside.includes(id));
    return view.showImages(next?.id ?? quantity.id, [quantity.id, ...view.beside]);
  }

  // What the places of the panels depend on, besides the size of the stage.
  /** @returns {Arrangement} */
  get arrangement() {
    const { view, store, straight, picking } = this;
    const dips = picking.shown && (picking.on || !PHONE.matches || store.basis === 'gauge'); // a phone has room for the caliper or the dips
    return { dips, measured: store?.basis !== 'gauge', rig: view.rig, straight, outside: Boolean(this.gpu) && !straight, curves: this.curves.shown.length, chosen: view.widths, order: view.order, beside: PHONE.matches || view.rig ? 0 : this.besides.length, tab: NARROW.matches && !view.rig ? view.tab : null };
  }

  // The text of the list of zones if there is no zone. It is empty where the banner of a wall without a caliper says enough.
  get noZone() {
    const { view, newest, store: { basis } } = this;
    if (basis !== 'azimuthal' && NARROW.matches && view.tab !== 'zones') return '';
    if (basis === 'gauge') return NARROW.matches ? 'Zones need a caliper' : '';
    return `No zone${newest === null ? '' : ' so far'}, by the criteria`;
  }

  // Whether the wall still grows, or is replayed as it grew.
  get growing() {
    return Boolean(this.replay.past) || (!this.ended && !this.contents && (this.bitDepth !== null || Number.isFinite(ageOf(this))));
  }

  // Whether the hole is drawn straightened, with the same depth axis as the tracks.
  get straight() {
    return this.view.camera === 'straight' && Boolean(this.gpu);
  }

  // The scale of paper of the tracks, if it is one of those offered.
  get paper() {
    return paperScale(this.view, this.rects.image);
  }

  get quantity() {
    return quantityOf(this.quantities, this.view.quantity);
  }

  // Everything that one frame shows; drawing does not change it.
  /** @returns {Looks} */
  look() {
    const { store, view, path, rects, bit: bitDepth, quantity } = this;
    const { top, bottom } = view;
    const turns = (bottom - top) / Math.abs(store.levels[0].pitch);
    const tiles = turns / store.levels[0].rows;
    const pieces = coverage(store, top, bottom, tiles <= FINE_TILES && turns <= 16 * rects.image.height);
    const now = seconds();
    /** @type {Look} */
    const made = {
      store, view, path, rects, bitDepth, asked: quantity, quantity,
      imagePieces: pieces,
      wallPieces: pieces,
      imageRect: rects.image,
      wallRect: rects.wall,
      background: PALETTES[view.theme].background,
      dark: view.theme === 'dark',
      notes: this.notes.kept,
      zones: this.zones,
      growing: this.growing,
      arms: this.curves.arms,
      over: quantityOf(this.quantities, 'over'),
      glow: (tile) => (this.replay.past ? [] : this.glow.on(tile, now)),
    };
    /** @type {Look[]} */
    const beside = this.besides.map((one, i) => ({ ...made, asked: one, quantity: one, imageRect: rects[`beside${i}`], rects: { ...rects, image: rects[`beside${i}`], caliper: { ...rects.caliper, width: 0 } } }));
    const images = [made, ...beside.filter(({ imageRect }) => imageRect)].map((one) => (one.asked.inView ? { ...one, quantity: { ...one.asked, ...fitRange(one.asked, valuesInView(one, one.asked)) } } : one));
    return { ...images[0], images };
  }

  schedule() {
    if (this.scheduled) return;
    this.scheduled = true;
    requestAnimationFrame(() => {
      this.scheduled = false;
      this.draw();
    });
  }

  draw() {
    applyTheme(this.view);
    if (!this.store || !this.path.count || !this.rects) return writeRig(this);
    const began = performance.now();
    clearTimeout(this.timers.unseen);
    this.timers.unseen = undefined;
    this.ask();
    if (this.controls) this.controls.enabled = this.view.camera === 'outside';
    if (JSON.stringify(this.arrangement) !== this.arranged) this.resize();
    const look = this.look();
    if (!this.fitted && this.gpu) this.fit();
    if (this.gpu) this.paint(this.gpu, look);
    this.drawInk(look);
    this.drawPanels(look);
    this.frames++;
    if (this.firstPicture === null && look.imagePieces.length) this.firstPicture = performance.now();
    if (this.glow.fade(seconds())) this.glowOn(began);
    clearTimeout(this.timers.addressing);
    this.timers.addressing = setTimeout(() => (this.notebook ? this.notebook.look(looked(this)) : history.replaceState(null, '', toAddress(this))), 400);
  }

  // Draw the WebGL canvas if it would look different; the cursor is drawn on the other canvas. On a slow machine the picture is
  // coarse while it moves.
  /** @param {Gpu} gpu @param {Looks} look */
  paint(gpu, look) {
    const { view } = this;
    const { cursor, pinned, pins, redraw, ...rest } = view;
    const key = JSON.stringify([rest, look.images.map(({ quantity }) => quantity), look.rects, look.bitDepth, this.path.version, this.store.session, this.store.levels[0].limit, this.glow.ranges.length && performance.now(),
      look.imagePieces.map(({ tile, top, bottom }) => [tile.level.rings, tile.index, tile.version, top, bottom]), gpu.outside.position, gpu.outside.axes, gpu.head]);
    if (key === this.painted) return;
    const began = performance.now();
    const coarse = gpu.cost > SLOW && began - this.paintedAt < MOVING + 2 * gpu.cost && !this.glow.ranges.length && gpu.stats.pictures > 2;
    Object.assign(this, { painted: key, paintedAt: began });
    clearTimeout(this.timers.sharpening);
    this.timers.sharpening = coarse ? setTimeout(() => this.sharpen(), MOVING + Math.min(gpu.cost, 1000)) : undefined;
    gpu.draw(look, coarse);
    if (!coarse) gpu.whenDrawn(() => (gpu.cost = performance.now() - began));
  }

  sharpen() {
    Object.assign(this, { painted: '', paintedAt: 0 });
    this.timers.sharpening = undefined;
    this.redraw();
  }

  // Fading takes at most a quarter of the time, so that new values need not wait for it.
  /** @param {number} began */
  glowOn(began) {
    clearTimeout(this.timers.glowing);
    const later = () => {
      clearTimeout(this.timers.glowing);
      this.timers.glowing = setTimeout(this.redraw, Math.max(200, 4 * (performance.now() - began)));
    };
    if (this.gpu) this.gpu.whenDrawn(later);
    else later();
  }

  /** @param {Looks} look */
  drawInk(look) {
    const { ink, width, height } = sized(byId('ink'));
    ink.clearRect(0, 0, width, height);
    ink.font = FONT;
    if (this.rects.image.width) for (const one of look.images) this.plain?.draw(ink, one);
    drawAxis(ink, look);
    if (this.rects.image.width) for (const one of look.images) drawImageHead(ink, one);
    const calipers = drawCaliper(ink, look);
    if (this.rects.curves) this.curves.draw(ink, look);
    drawOutside(ink, look);
    this.map.draw(ink, look, this.picking.kept);
    const planes = this.picking.planes();
    drawDips(ink, look, planes, this.gpu);
    drawLegend(ink, look, planes, this.picking.on ? [] : NARROW.matches ? ['☰ has Pick dips and Help'] : START);
    if (this.rects.image.width) drawNotes(ink, look);
    if (this.picking.on) for (const one of look.images) drawPoints(ink, one, this.picking.points);
    this.picking.write(planes);
    byId('netSection').hidden = !this.picking.kept.length;
    if (byId('net').clientHeight) byId('netText').textContent = drawNet(byId('net'), look, planes);
    drawCursor(ink, look);
    if (this.picking.on && !this.picking.selected) drawNext(ink, look, this.picking.kind);
    drawAxisLabels(ink, look);
    if (this.straight && this.rects.wall.width) drawColumn(ink, look);
    else if (this.gpu && this.rects.wall.width && !this.straight) drawWallInk(ink, look, this.gpu, calipers);
    for (const one of imageRects(this.rects)) if (one.width) edges(ink, sharp(one, -1), PALETTES[this.view.theme].line);
  }

  /** @param {Look} look */
  drawPanels(look) {
    const { view, store, path } = this;
    const { cursor } = view;
    const wall = store.levels[0];
    const k = cursor && cursor.toolface !== null ? wall.quadAt(cursor.depth, cursor.toolface) : -1;
    const covered = cursor !== null && cursor.toolface !== null;
    this.quad = covered ? store.quad(k) : null;
    this.read = readout({ store, view, path, quad: this.quad });
    this.read.push(...this.curves.readout(cursor?.depth ?? view.middle));
    write('readout', cursor || !NARROW.matches ? this.read : this.read.filter(([, text]) => !/^[–/ ]*$/.test(text))); // on a touch screen nothing hovers: empty values are left out
    if (this.toSay && (!covered || wall.locate(k).tile)) {
      this.toSay = false;
      byId('spoken').textContent = spokenText(this);
    }
    byId('follow').hidden = !look.growing;
    byId('readTitle').textContent = view.pinned ? 'Cursor (held)' : cursor ? 'Cursor' : 'Middle of the log';
    const turned = turnAt(store, view, cursor?.depth ?? view.middle, look.arms);
    const figures = turnText(look, turned, (m, digits) => showLength(m, view.units, digits ?? (view.units === 'mm' ? 1 : 3)));
    byId('crossTitle').textContent = `Cross-section at ${showDepth(cursor?.depth ?? view.middle, view.units)}`;
    if (byId('polar').clientHeight) drawPolar(byId('polar'), look, turned, quantityOf(this.quantities, 'over'));
    write('turn', figures);
    if (NARROW.matches) writeBrief(look, this.read, store.basis === 'azimuthal' ? figures : []);
    this.summarize();
    this.writeSummary();
    this.alarms.write(view);
    listZones(this.zones, view, this.alarms, (zone) => this.showZone(zone), this.noZone);
    if (byId('histogram').clientHeight) this.histogram.draw(look);
    reflect(view, look.quantity, this.rects.image);
    links(this, toAddress(this));
    lamp(this);
  }

  // Lay the tracks out anew. If the size of the window changed, they keep a scale of paper; a change of tab keeps the section.
  resize() {
    const { tab } = this.arrangement;
    const sameTab = document.body.dataset.tab === (tab ?? '');
    const paper = this.store && this.rects && !this.view.rig && sameTab && tab !== 'section' && tab !== 'zones' ? this.paper : undefined;
    document.body.dataset.tab = tab ?? '';
    const { clientWidth: width, clientHeight: height } = byId('stage');
    this.arranged = JSON.stringify(this.arrangement);
    this.rects = layout(width, height, this.arrangement);
    this.gpu?.resize(width, height);
    this.painted = '';
    const { pane: wall } = this.rects;
    byId('orbit').hidden = this.straight;
    Object.assign(byId('orbit').style, { left: `${wall.left}px`, top: `${HEAD - 24}px`, width: `${wall.width}px`, height: `${height - HEAD + 24}px` });
    Object.assign(byId('wallHead').style, { left: `${wall.left}px`, width: `${wall.width}px` });
    Object.assign(byId('replay').style, { left: `${wall.left + 90}px`, width: `${wall.width - 100}px` });
    Object.assign(byId('notice').style, { left: `${wall.left + 10}px`, maxWidth: `${wall.width - 20}px` });
    if (paper && paper !== this.paper) this.setLength(`1:${paper}`); // a scale of paper stays
    this.redraw();
  }

  // Look at the whole section from the side, a little from above, in whatever direction the hole runs.
  fit() {
    if (!this.path?.count || !this.gpu || !this.controls) return;
    this.gpu.lookAtSection(this.view.length, this.path.at(this.view.middle), this.view.tubeFactor(this.store) * this.store.bitRadius, this.rects.wall);
    Object.assign(this.gpu.head, { left: 0, raised: 0 });
    this.controls.target = [0, 0, 0];
    this.fitted = true;
    this.redraw();
  }

  /** @param {number} x @param {number} y @param {boolean} [hold] */
  pickAt(x, y, hold = false) {
    const found = this.gpu?.pick(this.look(), x, y + HEAD - 24);
    if (!found) return this.view.point(null, false);
    const { level } = found.tile;
    const k = found.tile.index * level.tileSize + found.at + 0.5 * (level.sectors + 1);
    return this.view.point({ depth: level.depth(k), toolface: level.toolface(found.at + 0.5) }, hold);
  }

  /** @param {boolean} [on] */
  rig(on) {
    if (byId('rigOpen').hidden) return this.notice('Rig mode is for a well that is being drilled: helibore live has it.', 6);
    this.view.toggleRig(RECENT * 1.15, on);
    if (this.store) this.follow(this.view.follow);
    writeRig(this);
    this.resize();
    return this.fit();
  }

  /** @param {boolean} on */
  follow(on) {
    this.view.choose({ follow: on });
    if (on) this.view.followEnd(this.store, this.bit);
  }

  /** @param {string} text */
  setLength(text) {
    const [top, bottom] = this.store.span;
    if (text === 'all') this.view.show(top - (bottom - top) * 0.02, (bottom - top) * 1.04, this.store);
    else if (text.startsWith('1:')) this.view.zoom(scaleLength(this.rects.image, Number(text.slice(2))) / this.view.length, this.view.middle, this.store);
    else if (text) this.view.zoom(Number(text) / this.view.length, this.view.middle, this.store);
    if (this.view.follow && text !== 'all') this.view.followEnd(this.store, this.bit);
    this.fit();
  }

  /** @param {string} id */
  setQuantity(id) {
    const { quantity, view, quantities: all } = this;
    if (all.some((q) => q.id === id)) view.showImages(id, view.beside.map((one) => (one === id ? quantity.id : one))); // the two images change places
  }

  /** @param {Colours} changes */
  setColours(changes) {
    Object.assign(this.quantity, changes, { chosen: true });
    this.redraw();
  }

  /** @param {End} end @param {number} shown */
  setEnd(end, shown) {
    const { quantity, view } = this;
    const value = shown / scaleOf(quantity, view.units);
    const other = quantity[end === 'low' ? 'high' : 'low'];
    if (Number.isFinite(value) && (end === 'low' ? value < other : value > other)) this.setColours({ [end]: value });
    else this.redraw();
  }

  // Write the figures below the log, with the depths between which they were measured: a growing wall may be longer by now.
  writeSummary() {
    const { store, view, summary } = this;
    const [start, stop] = summary ? [summary.start, summary.stop] : [Math.max(view.top, store.span[0]), Math.min(view.bottom, store.span[1])];
    byId('sectionTitle').textContent = stop > start ? showSpan(start, stop, view.units) : '';
    write('section', stop > start ? sectionText(store, summary, view.units, this.zones, view.bottom) : [['Section', 'no data']]);
    writeRig(this);
  }

  // Ask the server for the figures of the section, or in rig mode of the last metres, once the section rests, and repeatedly
  // while the wall grows. The figures of one mode are not shown in the other mode. An exported file holds the figures of
  // its own section.
  summarize() {
    const { view, store, contents } = this;
    if (contents) this.summary = contents.summary;
    if (contents || store.basis === 'gauge') return;
    const { rig } = view;
    const asked = () => (rig ? recent(this.store) : [view.top, view.bottom]);
    const keyOf = (/** @type {number[]} */ ends) => [...ends.map((end) => end.toFixed(2)), this.store.levels[0].size, this.store.session].join();
    if (this.summaryOf !== rig) Object.assign(this, { summary: null, summaryOf: rig, summarized: '', summaryPending: false });
    if (this.summaryPending || keyOf(asked()) === this.summarized) return;
    this.summaryPending = true;
    const wait = rig && !this.summary ? 0 : SUMMARY_WAIT;
    setTimeout(async () => {
      const [from, to] = asked();
      this.summarized = keyOf([from, to]);
      const query = new URLSearchParams(location.search);
      query.set('start', String(from));
      query.set('stop', String(to));
      const began = performance.now();
      const answer = await fetch(`api/summary?${query}`).catch(() => null);
      const summary = answer?.ok ? await answer.json() : null;
      if (rig !== this.summaryOf) return; // the mode has changed since this was asked, and another request is under way
      this.summary = summary;
      const { span: [top, bottom], levels: [{ pitch }] } = this.store;
      const lacking = summary ? Math.min(to, bottom) - Math.max(from, top) - (summary.stop - summary.start) : 0;
      if (lacking > 2 * Math.abs(pitch)) this.summarized = ''; // the server is behind: ask again, also if nothing more arrives
      this.writeSummary();
      setTimeout(() => {
        this.summaryPending = false;
        this.summarize();
      }, 4 * (performance.now() - began));
    }, wait);
  }

  // Go to the next (1) or previous (-1) zone by severity.
  /** @param {number} step */
  jump(step) {
    const zone = jump(this.zones, this.view.cursor?.depth ?? NaN, step);
    if (zone) this.showZone(zone);
  }

  /** @param {Zone} zone */
  showZone(zone) {
    const { view, store, path } = this;
    const { start, stop } = zone;
    const depth = (start + stop) / 2;
    if (start < view.top || stop > view.bottom) view.centre(depth, store);
    view.choose({ follow: false });
    view.turnTo(turnTowards(zone, leftEdge(path, view.cut, depth).toolface, view.turn), false);
    view.point({ depth, toolface: null }, true);
  }

  // Go to a depth in the unit of the page, and mark it.
  /** @param {number} shown */
  goTo(shown) {
    const { view, store } = this;
    const depth = shown / LENGTHS[view.units].depth.scale;
    this.redraw(); // so that a refused depth does not stay in the field
    if (!Number.isFinite(depth)) return undefined;
    const [top, bottom] = store.span;
    if (depth < top || depth > bottom) return this.notice(`${showDepth(depth, view.units)} is outside the wall, ${showSpan(top, bottom, view.units)}`, 10);
    view.centre(depth, store);
    view.choose({ follow: false });
    return view.point({ depth, toolface: null }, true);
  }

  keepSection() {
    this.view.keepSection(this.view.cursor?.depth ?? this.view.middle);
  }

  // Move the cursor by metres and degrees, and the section with it; say where it is.
  /** @param {number} metres @param {number} degrees */
  step(metres, degrees) {
    const { view, store } = this;
    const { depth, toolface } = view.cursor ?? { depth: view.middle, toolface: null };
    const [top, bottom] = store.span;
    const to = Math.min(bottom, Math.max(top, depth + metres));
    if (to < view.top || to > view.bottom) view.show(view.top + to - depth, view.length, store);
    view.point({ depth: to, toolface: degrees ? ((toolface ?? 0) + degrees + 360) % 360 : toolface }, true);
    clearTimeout(this.timers.speaking);
    this.timers.speaking = setTimeout(() => {
      this.toSay = true;
      this.redraw();
    }, 400);
  }

  copy() {
    navigator.clipboard?.writeText(this.read.map((pair) => pair.join('\t')).join('\n'));
  }

  readdress() {
    if (location.hash === toAddress(this) || !this.store) return;
    Object.assign(this.quantity, fromAddress(this, location.hash));
    this.resize();
  }
}

const app = new App();
// For tests: what is loaded, and what the page can do.
Object.assign(window, { __wall: {
  app,
  get ready() {
    return app.firstPicture !== null;
  },
  get stats() {
    const { connection, store, gpu, frames, firstPicture } = app;
    return { ...connection.stats, ...(gpu?.stats ?? {}), frames, firstPicture, size: store?.levels[0].size ?? 0, held: store?.levels[0].tiles.size ?? 0 };
  },
  addressed: () => location.hash === toAddress(app),
  fit: () => app.fit(),
  pick: (/** @type {number} */ x, /** @type {number} */ y) => app.gpu?.pick(app.look(), x, y),
} });
