// The page: what the server says (the wall, its path, the state of the run), and what shows it.
//
//   message -> App: Store, Path, state -> repaint       user -> View, Selection -> redraw or repaint; tiles asked for where needed
//
// `Connection` receives, `Selection` and `View` hold what the user chose, `Renderer` draws.

import { Alarms } from './alarms.js';
import { fromAddress, toAddress } from './address.js';
import { quantities, takeRanges } from './color.js';
import { Connection, LOST, socketAddress, STOPPED } from './connection.js';
import { Curves } from './curves.js';
import { byId, hide, options, say } from './dom.js';
import { Exported, exportedContents } from './exported.js';
import { Figures } from './figures.js';
import { Glow } from './glow.js';
import { whenHosted } from './host.js';
import { bindControls, bindKeys, bindTracks } from './input.js';
import { ageOf, lamp, LIFTED, Pace } from './lamp.js';
import { late } from './late.js';
import { Notes } from './notes.js';
import { disableControls, fillSelects, nameCuts, showBasis } from './panel.js';
import { cutFor, Path } from './path.js';
import { Picking } from './picking.js';
import { Renderer, seconds } from './renderer.js';
import { Replay } from './replay.js';
import { writeRig } from './rig.js';
import { bindSaving } from './saving.js';
import { NARROW, Selection } from './selection.js';
import { fromTemplate } from './template.js';
import { Store } from './tiles.js';
import { LENGTHS, showLength } from './units.js';
import { View } from './view.js';
import { bySeverity } from './zones.js';

const DARK = window.matchMedia('(prefers-color-scheme: dark)');
const MEMORY = 256 * 2 ** 20; // bytes of tiles, textures included
const USUAL_SCALE = 200; // of paper, at first
const SHORT = 2.5; // sections of that scale; a saved wall no longer than this is shown whole at first, at up to 1:500
const LIMITS = [0.5, 1, 0.25].map((inches) => inches / LENGTHS.in.scale); // of washouts, breakouts and undergauge hole, metres, by default
// A name that may be broken into lines behind its underscores, as it may behind hyphens.
/** @param {string} name */
const breakable = (name) => name.split(/(?<=_)/).flatMap((part) => [part, document.createElement('wbr')]);

export class App {
  // The wall and its path, once the server has begun it; null before.
  store = /** @type {Store} */ (/** @type {unknown} */ (null));
  path = /** @type {Path} */ (/** @type {unknown} */ (null));
  /** @type {number | null} */
  bitDepth = null;
  /** @type {number | null} */
  holeDepth = null;
  /** @type {number | null} */
  seenHole = null; // the hole depth when the sensor was at the end of the wall
  tripped = false; // since hole was drilled
  /** @type {number | null} */
  newest = null;
  /** @type {number | null} */
  received = null; // the last bytes from a source, by this machine's clock
  pace = new Pace();
  radii = new Pace(); // of the radii alone
  ended = false;
  unused = ''; // why radii that come are not used
  shape = 'wall'; // whose diameters the zones are judged by: the wall's, or those of a tool with few arms
  /** @type {RigidString | null} */
  string = null;
  channels = 0; // version of the picture of the rig's channels; 0: there are none
  /** @type {Outlook | null} */
  ahead = null; // what is tight above and below the bit
  prints = false; // whether the server prints sections
  meshes = false; // whether it writes meshes
  /** @type {number | null} */
  opened = null; // the top of the section that a saved wall began with
  most = 1; // sections that a saved wall is long, at most, to be shown whole
  sources = '';
  /** @type {string[]} */
  lost = []; // names of the sources that are not connected
  /** @type {number | null} */
  lastWrite = null;
  /** @type {Zone[]} */
  zones = [];
  limits = LIMITS;
  /** @type {Zone[] | null} */
  zonesBefore = null; // the zones of the previous state of the same wall
  /** @type {number | null} */
  zonesTo = null; // the end of the wall when these zones were found
  status = 'connecting';
  words = '';
  /** @type {Colours | null} */
  colours = null; // the colours of the address, until the quantities are known
  /** @type {Host | null} */
  notebook = null; // the notebook that shows the page
  /** @type {Contents | null} */
  contents = null; // of an exported file
  /** @type {number | undefined} */
  noticed = undefined; // timer of the notice

  constructor() {
    /** @type {Renderer} */
    this.renderer = new Renderer(this);
    this.redraw = this.renderer.redraw;
    this.repaint = this.renderer.repaint;
    this.view = new View(this.redraw, this.repaint);
    /** @type {Selection} */
    this.selection = new Selection(this);
    /** @type {Figures} */
    this.figures = new Figures(this);
    this.glow = new Glow();
    fillSelects();
    disableControls(true);
    this.renderer.openGpu();
    bindTracks(this);
    bindControls(this);
    bindKeys(this);
    bindSaving(this);
    /** @type {Replay} */
    this.replay = new Replay(this);
    byId('zoneBefore').addEventListener('click', () => this.selection.jump(-1));
    byId('zoneNext').addEventListener('click', () => this.selection.jump(1));
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
    new ResizeObserver(this.repaint).observe(byId('stage'));
    this.renderer.arrange();
    this.contents = exportedContents();
    this.colours = fromAddress(this, location.hash || (this.contents?.address ?? ''));
    this.view.rig &&= !byId('rigOpen').hidden;
    this.view.followTheme(DARK.matches);
    DARK.addEventListener('change', ({ matches }) => this.view.followTheme(matches));
    window.addEventListener('hashchange', () => this.readdress());
    window.addEventListener('beforeunload', (event) => this.picking.waits && event.preventDefault());
    setInterval(() => (lamp(this), this.view.rig && this.store && writeRig(this)), 1000);
    /** @type {Handlers} */
    const on = {
      handshake: (handshake) => this.begin(handshake),
      state: (state) => this.takeState(state),
      picks: (picks) => {
        this.figures.asked = ''; // a washout may be a fracture now
        this.picking.receive(picks);
      },
      write: (message) => this.write(message),
      frames: (message) => this.takeFrames(message),
      status: (status, words) => this.say(status, words),
    };
    this.connection = this.contents ? new Exported(this.contents, on) : new Connection(socketAddress(''), on);
    if (this.contents?.hosted) {
      whenHosted((notebook) => {
        Object.assign(this, { contents: null, notebook, connection: new Connection('', on, notebook) });
        notebook.show = (top, bottom) => this.store && this.view.show(top, bottom - top, this.store);
      });
    }
  }

  /** @param {string} text @param {number} [shownFor] */
  notice(text, shownFor = 0) {
    say('notice', text);
    hide(!text, 'notice');
    clearTimeout(this.noticed);
    if (shownFor) this.noticed = setTimeout(() => hide(true, 'notice'), 1000 * shownFor);
  }

  /** @param {Handshake} handshake */
  begin(handshake) {
    this.replay.close();
    if (this.store) this.forget();
    this.store = new Store(handshake);
    this.curves.offered = [];
    disableControls(false);
    hide(false, 'gl');
    showBasis(handshake);
    this.picking.begin(handshake);
    this.alarms.begin(handshake.session);
    this.path = new Path(handshake.start_depth, handshake.frame_step, handshake.reference, handshake.assumed, handshake.north);
    this.glow.rows = this.store.levels[0].rows;
    const kept = this.selection.quantities;
    this.selection.quantities = quantities(this.store).map((q) => {
      const old = kept.find(({ id, mode, attribute }) => id === q.id && mode === q.mode && attribute === q.attribute);
      return old ? { ...q, ...old } : q;
    });
    options('quantity', this.selection.quantities.map(({ id, name }) => [id, name]));
    const { tab } = this.view;
    this.view.tab = 'log'; // the height of this tab gives the section its length, also if the page begins in another tab
    if (handshake.template) this.arrange(handshake.template);
    else this.view.usual(...this.selection.usualTracks(handshake.curves ?? []));
    if (this.colours) Object.assign(this.selection.quantity, this.colours);
    this.colours = null;
    byId('well').replaceChildren(...breakable(handshake.well || 'helibore'));
    byId('well').title = handshake.well;
    document.title = handshake.well ? `${handshake.well} – helibore` : 'helibore';
    this.renderer.arrange();
    if (!this.view.sized && !handshake.template?.scale && !this.view.rig) {
      this.selection.setLength(`1:${USUAL_SCALE}`);
      this.view.keepLength();
      this.most = SHORT;
    }
    this.view.tab = tab;
    if (this.view.follow) this.follow();
    this.ask();
    this.pickIfAsked();
    this.repaint();
  }

  // Show the tracks of a template, unless the address has chosen some.
  /** @param {Template} template */
  arrange(template) {
    if (this.view.order.length) return;
    this.view.showTracks(fromTemplate(template, this.selection.quantities, this.store.columns));
    this.renderer.arrange();
    if (template.scale) this.selection.setLength(`1:${template.scale}`);
  }

  forget() {
    for (const level of this.store.levels) for (const tile of level.tiles.values()) tile.textures?.dispose();
    this.renderer.fitted = this.view.follow ? this.renderer.fitted : true;
    this.zonesBefore = null;
  }

  /** @param {State} state */
  takeState({ begun, sources, bit_depth: bit, hole_depth: hole, seen_hole: seenHole = null, tripped = false, newest, received = null, now, ended, true_depth: trueDepth, ranges, zones, curves = [], curves_version: version = 0, alarms = [], lost = [], prints = false, meshes = false, shape = 'wall', string = null, channels = 0, ahead = null, zones_to: zonesTo = null, limits = LIMITS, unused = '', units = 'mm' }) {
    Object.assign(this, { sources, lost, shape, string, meshes, channels, ahead, zonesTo, limits, unused, seenHole, tripped });
    if (!begun) this.alarms.feed = [...alarms].reverse();
    if (!begun) return this.say('waiting', `${this.store ? 'The server was started again; this is the picture from before. ' : ''}Waiting for the first samples.${sources ? `\n${sources}` : ''}`);
    const found = JSON.stringify(zones) === JSON.stringify(this.zones) ? this.zones : zones; // the same zones are not listed anew
    this.alarms.take(this.zonesBefore, found, !this.contents && !ended && (newest !== null || (this.lastWrite !== null && this.zones.length > 0)), alarms);
    this.zones = found;
    this.zonesBefore = zonesTo === null ? null : found; // zones that are found for the first time are not new
    document.body.classList.toggle('saved', ended && newest === null);
    this.curves.offer(curves, version);
    this.path.trueDepth = trueDepth;
    const hung = string?.bit; // the clearances are found a moment later than the bit's depth
    const at = bit !== null && hung && Math.abs(hung - bit) < LIFTED ? hung : bit;
    if (takeRanges(this.selection.quantities, ranges) || this.bitDepth !== at) this.repaint();
    this.prints = prints;
    this.bitDepth = at;
    this.holeDepth = hole;
    this.view.followUnits(units);
    this.pace.note(received);
    this.radii.note(newest);
    [this.newest, this.received] = [newest, received].map((of) => (of === null ? null : of + (Date.now() / 1000 - now))); // from the server's clock to the clock of this machine
    this.ended = ended;
    this.openSaved();
    if (this.view.follow && this.store) this.follow();
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
    const whole = span[1] - span[0];
    const length = whole > this.most * view.length ? view.length : whole; // a short well fills the height
    this.most = 1;
    view.show(Math.max(span[0], Math.min((top + bottom - length) / 2, span[1] - length)), length, store);
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
      if (!this.view.rig) this.glow.add(start, start + message.count, message.first + message.count <= filled, seconds());
      this.lastWrite = performance.now();
    }
    if (level.size !== before && message.level === 0) {
      if (this.view.follow) this.follow();
      this.ask();
    }
    this.renderer.changed(tile);
  }

  /** @param {Frames} message */
  takeFrames(message) {
    const { count, surveyed } = this.path;
    this.path.apply(message);
    nameCuts(this.path);
    this.view.choose({ cut: cutFor([this.path], this.view.cut) });
    if (count && this.path.surveyed !== surveyed) this.renderer.fitted = false; // the hole has another direction: look at it anew
    this.repaint();
  }

  /** @param {string} status @param {string} words */
  say(status, words) {
    this.status = status;
    this.words = words;
    say('connection', words); // longer texts than the lamp has room for
    hide(!words || words === LOST || words === STOPPED, 'connection');
    lamp(this);
    this.redraw();
  }

  // Subscribe to the tiles around the section and to the growing tile; keep the other tiles that fit in memory.
  ask() {
    const { store, view, renderer: { mostTiles } } = this;
    if (!store) return;
    const wall = store.levels[0];
    const near = wall.tilesBetween(view.top - view.length / 2, view.bottom + view.length / 2);
    const growing = Math.floor(Math.max(0, wall.size - 1) / wall.tileSize);
    const seen = wall.tilesBetween(view.top, view.bottom);
    const wanted = new Set([...(seen.length > mostTiles ? [] : near.length > mostTiles ? seen : near), growing, growing + 1]);
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

  // Move the section with the bit; in rig mode the section also has the worst place.
  follow() {
    const { view, store, bit } = this;
    if (!view.rig) return view.followEnd(store, bit);
    const section = late(this)?.rigSection(this);
    if (section) view.show(...section, store, false);
  }

  // The text of the list of zones if there is no zone. It is empty where the banner of a wall without a caliper says enough.
  get noZone() {
    const { view, newest, limits, store: { basis, bitRadius } } = this;
    if (basis !== 'azimuthal' && NARROW.matches && view.tab !== 'zones') return '';
    if (basis === 'gauge') return NARROW.matches ? 'Zones need a caliper' : '';
    const [washout, elongation] = limits.map((limit) => showLength(limit, view.units, view.units === 'mm' ? 1 : 2));
    const slim = bitRadius < 0.09 && limits[1] > 0.99 * LIMITS[1] ? '; zones.scaled lowers both' : '';
    return `No zone${newest === null ? '' : ' so far'}: washout from ${washout}, breakout from ${elongation}${slim}`;
  }

  // Whether the wall still grows, or is replayed as it grew.
  get growing() {
    return Boolean(this.replay.past) || (!this.ended && !this.contents && (this.bitDepth !== null || Number.isFinite(ageOf(this))));
  }

  readdress() {
    if (location.hash === toAddress(this) || !this.store) return;
    Object.assign(this.selection.quantity, fromAddress(this, location.hash));
    this.curves.list();
    this.pickIfAsked();
    this.renderer.fitted = false;
    this.repaint();
  }

  // The page of several wells opens a well's page to pick on it.
  pickIfAsked() {
    if (/\bpicking=1/.test(location.hash)) this.picking.toggle(true);
  }
}

const app = new App();
// For tests: what is loaded, and what the page can do.
Object.assign(window, { __wall: {
  app,
  get ready() {
    return app.renderer.firstPicture !== null;
  },
  get stats() {
    const { connection, store, renderer: { gpu, frames, firstPicture } } = app;
    return { ...connection.stats, ...(gpu?.stats ?? {}), frames, firstPicture, size: store?.levels[0].size ?? 0, held: store?.levels[0].tiles.size ?? 0 };
  },
  addressed: () => location.hash === toAddress(app),
  fit: () => app.renderer.fit(),
  pick: (/** @type {number} */ x, /** @type {number} */ y) => app.renderer.gpu?.pick(app.renderer.look(), x, y),
} });
