// The page of several wells: in one scene at their true places, or side by side with their tops joined.
//
//   message -> Well -> draw       user -> Wells -> draw
//
// What is drawn: wells_scene.js (3-D), wells_section.js (side by side).

import definition from '../../../base/color_maps.json' with { type: 'json' };
import { drawColourBar } from './color_bar.js';
import { pen, pixelRatio, sharpen, sized } from './device.js';
import { drawLegend } from './dip_ink.js';
import { byId, hide, oncePerFrame, options, write } from './dom.js';
import { messageOf } from './errors.js';
import { FLAT } from './flat.js';
import { Context } from './gl.js';
import { Gpu, PROGRAMS } from './gpu.js';
import { BOLD, FONT, label, PALETTES, SMALL } from './layout.js';
import { FINE_TILES, MOST_TILES, niceStep } from './lod.js';
import { cutFor, CUTS, cutsOf } from './path.js';
import { applyTheme } from './panel.js';
import { save } from './saving.js';
import { BAND, SLIDE } from './slide.js';
import { marksOf } from './sureness.js';
import { recorder, svgFile } from './svg.js';
import { hatched } from './strokes.js';
import { normalised } from './vectors.js';
import { numbers, View } from './view.js';
import { Well } from './well.js';
import { Scene } from './wells_scene.js';
import { farApart, Section, TRUE } from './wells_section.js';
import { unpicked } from './unpicked.js';

const TUBES = [0, 1, 2, 5, 10, 20, 50, 100, 200, 500];
const HEIGHTS = [1, 2, 5, 10, 20];
const SLOW = 40; // milliseconds: a picture that takes longer is drawn coarse while it moves
const MOVING = 250; // milliseconds until a picture that has moved is drawn in full
const WIDE = 3840; // pixels of a saved picture
const BAR = 24; // pixels below the picture, for its colours
const WAIT = 15_000; // milliseconds that a saved picture waits at most
const DARK = window.matchMedia('(prefers-color-scheme: dark)');
const SHOWN = /** @type {const} */ (['fence', 'discs', 'planes', 'box']);

const AGAIN = 2000; // milliseconds from asking which wells have begun to asking again

export class Wells {
  /** @type {Well[]} */
  wells = [];
  note = ''; // how wells without a place were placed
  mode = 'scene';
  cut = /** @type {Cut} */ ('top'); // that is asked for
  datumChosen = false; // by the address or the user
  datum = ''; // '': measured depths; TRUE: true depths; else the name of the top that stands at one height
  /** @type {Record<'fence' | 'discs' | 'planes' | 'box', boolean>} */
  shown = { fence: true, discs: true, planes: true, box: true };
  /** @type {Set<string>} */
  hidden = new Set(); // names of tops
  quantityId = '';
  pictured = 0; // wells of the last picture
  movedAt = 0;
  cost = 0;
  listed = '';
  /** @type {number | undefined} */
  sharpening = undefined;
  waits = ''; // how many wells have no data yet, in words

  constructor() {
    this.redraw = oncePerFrame(() => this.draw());
    this.view = new View(this.redraw);
    this.view.choose({ camera: 'outside', follow: false });
    this.view.followTheme(DARK.matches);
    DARK.addEventListener('change', ({ matches }) => this.view.followTheme(matches));
    this.gpu = new Gpu(byId('gl'));
    const restore = () => (this.gpu.context = new Context(this.gpu.gl, { ...PROGRAMS, flat: FLAT }));
    restore();
    byId('gl').addEventListener('webglcontextrestored', () => {
      restore();
      this.redraw();
    });
    this.scene = new Scene(this);
    this.section = new Section(this);
    this.fromAddress();
    this.bind();
    this.load();
  }

  // Read which wells there are; while some wait for their first data, ask again, and begin anew when another has come.
  async load() {
    try {
      const answer = await fetch(`api/wells${location.search}`);
      if (!answer.ok) throw new Error(await answer.text());
      /** @type {(ListedWell | null)[]} */
      const all = await answer.json();
      const listed = all.filter((one) => one !== null);
      const waits = all.length - listed.length;
      byId('lampText').textContent = this.waits = waits ? `${waits} of ${all.length} wells ${waits === 1 ? 'waits for its' : 'wait for their'} first data` : '';
      if (waits) setTimeout(() => this.load(), AGAIN);
      if (this.wells.length) return listed.length > this.wells.length ? location.reload() : undefined;
      const places = placed(listed);
      this.note = places.note;
      this.wells = listed.map((one, i) => Object.assign(new Well(one, () => this.changed()), { east: places.east[i] }));
      byId('well').textContent = `${all.length} wells`;
      document.title = `${listed.map(({ name }) => name).join(', ')} – helibore`;
    } catch (error) {
      byId('notice').textContent = `The wells were not read: ${messageOf(error)}`;
      hide(false, 'notice');
    }
  }

  changed() {
    this.scene.changed = true;
    this.redraw();
  }

  // The wells that are shown and have something to draw.
  get drawn() {
    return this.wells.filter((well) => well.ready && !well.hidden);
  }

  // The quantity by which all wells are coloured, its ends those of all wells: one colour is one value.
  /** @returns {Quantity | undefined} */
  get quantity() {
    const found = this.wells.flatMap(({ quantities }) => quantities.filter(({ id }) => id === this.quantityId)).filter(({ low }) => Number.isFinite(low));
    return found.length ? { ...found[0], low: Math.min(...found.map(({ low }) => low)), high: Math.max(...found.map(({ high }) => high)) } : undefined;
  }

  // The names of the tops of all wells, from the top of the first well down, and their colours.
  get tops() {
    /** @type {string[]} */
    const names = [];
    for (const { store } of this.wells) {
      let at = 0;
      for (const [name] of store?.intervals ?? []) {
        const known = names.indexOf(name);
        if (known < 0) names.splice(at, 0, name);
        at = (known < 0 ? at : known) + 1;
      }
    }
    const { formations } = definition;
    return names.map((name, i) => ({ name, colour: `#${formations[i % formations.length]}` }));
  }

  // Return a view of one well between two depths.
  /** @param {number} top @param {number} length @returns {View} */
  viewOf(top, length) {
    return Object.create(this.view, { top: { value: top }, length: { value: length } });
  }

  // Return what one well is drawn from.
  /** @param {Well} well @param {View} view @param {Rects} rects @returns {Look} */
  look(well, view, rects) {
    const { store, path } = well;
    const quantity = well.quantity(this.quantity);
    const pieces = well.pieces(view.top, view.bottom);
    return {
      store, view, path, rects, bitDepth: well.bitDepth, oldBit: false, asked: quantity, quantity, imagePieces: pieces, wallPieces: pieces,
      imageRect: rects.image, wallRect: rects.wall, background: PALETTES[view.theme].background, dark: view.theme === 'dark',
      notes: [], intervals: store.intervals.filter(([name]) => !this.hidden.has(name)), zones: unpicked(well.zones, well.picks, store.bitRadius), growing: false, arms: null, string: null, over: well.quantities[0], glow: () => [],
    };
  }

  get tube() {
    return this.view.tube || this.scene.usualTube;
  }

  draw() {
    const { gpu, view } = this;
    applyTheme(view);
    const { clientWidth: width, clientHeight: height } = byId('stage');
    const datum = this.datumChosen ? this.datum : farApart(this.drawn) ? TRUE : '';
    const paths = this.drawn.map(({ path }) => path);
    view.cut = cutFor(paths, this.cut);
    if (datum !== this.datum) Object.assign(this, { datum }).section.fitted = false;
    this.lists();
    const began = performance.now();
    const coarse = this.cost > SLOW && began - this.movedAt < MOVING;
    clearTimeout(this.sharpening);
    this.sharpening = coarse ? setTimeout(this.redraw, MOVING) : undefined;
    gpu.resize(width, height);
    gpu.setRatio(pixelRatio(gpu.canvas) * (coarse ? 0.5 : 1));
    gpu.begin({ left: 0, top: 0, width, height }, PALETTES[view.theme].background);
    const ink = sized(byId('ink')).ink;
    ink.clearRect(0, 0, width, height);
    ink.font = FONT;
    const rect = { left: 0, top: 0, width, height: height - (this.mode === 'scene' ? BAR : 0) };
    this.pictured = this.drawn.length;
    if (this.pictured) {
      const looks = this.mode === 'scene' ? this.scene.draw(ink, rect) : this.section.draw(ink, rect);
      const asked = this.quantity;
      const shown = looks.find(({ quantity }) => quantity.id === asked?.id);
      if (shown && this.mode === 'scene') {
        drawColourBar(ink, { ...shown, wallRect: { ...rect, left: 8, width: rect.width - 98 }, imagePieces: [] }, height - BAR / 2); // and beside it room for 'no data'
        const after = ink.canvas.labels[ink.canvas.labels.length - 1].right + 16;
        hatched(ink, after, height - BAR / 2 - 5, 12, 10, PALETTES[view.theme]);
        label(ink, 'no data', after + 16, height - BAR / 2, { colour: PALETTES[view.theme].ink, font: SMALL });
      }
      if (looks[0] && this.mode === 'scene' && this.shown.planes) {
        const rects = { ...looks[0].rects, axis: { ...rect, height: height - BAR / 2 - 10 }, image: { ...rect, width: 0 }, pane: rect };
        drawLegend(ink, { ...looks[0], view: this.viewOf(-1e6, 2e6), rects }, { kept: this.drawn.flatMap((well) => this.scene.picksOf(well, this.scene.topsOf(well))), boxes: [], selected: null, current: null, open: false }, []);
      }
    }
    if (!coarse) gpu.whenDrawn(() => (this.cost = performance.now() - began));
    clearTimeout(this.addressing);
    this.addressing = setTimeout(() => history.replaceState(null, '', this.toAddress()), 400);
  }

  /** @type {number | undefined} */
  addressing = undefined;

  // A picture that the user moves may be coarse.
  moved() {
    this.movedAt = performance.now();
    this.redraw();
  }

  // Fill the lists beside the picture, if what they list has changed.
  lists() {
    const { wells, tops } = this;
    const quantities = wells.flatMap((well) => well.quantities);
    const names = [...new Map(quantities.map(({ id, name }) => [id, name]))];
    if (!names.some(([id]) => id === this.quantityId)) this.quantityId = names.find(([id]) => quantities.find((one) => one.id === id)?.mode === 5)?.[0] ?? names[0]?.[0] ?? '';
    const cuts = cutsOf(this.drawn.map(({ path }) => path));
    const key = JSON.stringify([names, cuts, tops, wells.map(({ name, words, hidden, ready, store }) => [name, words, hidden, ready, store?.session]), [...this.hidden]]);
    byId('placed').textContent = this.mode === 'scene' ? this.note : ''; // side by side no place is needed
    byId('lampText').textContent = wells.find(({ words }) => words)?.words ?? this.waits;
    for (const id of /** @type {const} */ (['mode', 'units', 'tube'])) byId(id).value = String(id === 'mode' ? this.mode : this.view[id]);
    hide(this.mode === 'scene', 'datum', 'cut');
    hide(this.mode !== 'scene', 'tube', 'tall');
    byId('theme').textContent = this.view.theme === 'dark' ? 'Light' : 'Dark';
    if (key !== this.listed) {
      this.listed = key;
      options('quantity', names);
      options('datum', [['', 'measured depth'], [TRUE, 'true vertical depth'], ...tops.map(({ name }) => /** @type {Choice} */ ([name, `hang on ${name}`]))]);
      options('cut', cuts.map((cut) => [cut, `${CUTS[cut].letters.join('-')}: ${CUTS[cut].label}`]));
      options('tall', HEIGHTS.map((v) => [v, `heights × ${v}`]));
      options('tube', TUBES.map((v) => [v, v ? `tube × ${v}` : 'tube auto']));
      byId('wells').replaceChildren(...wells.map((well) => this.wellRow(well)));
      hide(!tops.length, 'topsSection');
      byId('tops').replaceChildren(...tops.map((top) => this.topRow(top)));
    }
    byId('quantity').value = this.quantityId;
    byId('datum').value = this.datum;
    byId('tube').value = String(this.view.tube);
    byId('tall').value = String(this.scene.tall);
    byId('cut').value = this.view.cut;
  }

  /** @param {Well} well */
  wellRow(well) {
    const row = document.createElement('div');
    const [seen, name, link, pick] = [document.createElement('input'), document.createElement('button'), ...['open', 'pick dips'].map((text) => Object.assign(document.createElement('a'), { textContent: text, target: well.name }))];
    Object.assign(seen, { type: 'checkbox', checked: !well.hidden, title: `Show ${well.name}`, onchange: () => {
      well.hidden = !seen.checked;
      this.changed();
    } });
    Object.assign(name, { textContent: well.name, title: 'Look at this well', onclick: () => this.show(well) });
    Object.assign(link, { href: this.addressOf(well), title: `The page of ${well.name}: image, picks, print` });
    Object.assign(pick, { href: `${this.addressOf(well)}&picking=1`, title: `Pick beds and fractures on the page of ${well.name}; they show here at once` });
    row.append(seen, name, link, pick);
    return row;
  }

  /** @param {{ name: string, colour: string }} top */
  topRow({ name, colour }) {
    const [row, seen, text, swatch] = ['div', 'input', 'span', 'i'].map((tag) => document.createElement(tag));
    const found = this.wells.filter(({ store }) => store?.intervals.some(([one]) => one === name)).length;
    Object.assign(seen, { type: 'checkbox', checked: !this.hidden.has(name), onchange: () => {
      if (!this.hidden.delete(name)) this.hidden.add(name);
      this.changed();
    } });
    swatch.style.background = colour;
    text.textContent = `${name}${found < this.wells.length ? ` (${found} of ${this.wells.length} wells)` : ''}`;
    const line = document.createElement('label');
    line.append(seen, text);
    row.append(swatch, line);
    return row;
  }

  // The address of a well's own page, which begins with what is chosen here.
  /** @param {Well} well @param {number} [depth] */
  addressOf(well, depth) {
    const parts = new URLSearchParams({ quantity: this.quantityId, cut: this.view.cut, units: this.view.units, theme: this.view.theme, ...(depth === undefined ? {} : { md: depth.toFixed(2), sec: '20' }) });
    return `${well.address}${location.search}#${parts}`;
  }

  /** @param {Well} well @param {number} [depth] */
  show(well, depth) {
    if (well.hidden || !well.ready) return;
    if (this.mode === 'scene') this.scene.lookAt(well, depth);
    else if (depth !== undefined) this.section.centre(well, depth);
    this.redraw();
  }

  bind() {
    const { view } = this;
    /** @template {string} Id @param {Id} id @param {string} event @param {(element: ElementOf<Id>) => unknown} act */
    const on = (id, event, act) => byId(id).addEventListener(event, () => {
      act(byId(id));
      this.changed();
    });
    on('mode', 'change', ({ value }) => (this.mode = value));
    on('datum', 'change', ({ value }) => {
      Object.assign(this, { datum: value, datumChosen: true });
      this.section.fitted = false;
    });
    on('quantity', 'change', ({ value }) => (this.quantityId = value));
    on('tube', 'change', ({ value }) => view.choose({ tube: Number(value) }));
    on('tall', 'change', ({ value }) => Object.assign(this.scene, { tall: Number(value), fitted: false }));
    on('cut', 'change', ({ value }) => (this.cut = /** @type {Cut} */ (value)));
    on('units', 'change', ({ value }) => view.choose({ units: /** @type {Units} */ (value) }));
    on('theme', 'click', () => view.toggleTheme());
    on('fit', 'click', () => this.fit());
    for (const kind of /** @type {const} */ (['png', 'svg', 'slide'])) on(kind, 'click', () => this.savePicture(kind));
    for (const id of SHOWN) on(id, 'change', ({ checked }) => (this.shown[id] = checked));
    new ResizeObserver(this.redraw).observe(byId('stage'));
    const ink = byId('ink');
    /** @param {MouseEvent} event @returns {Pair} */
    const at = ({ offsetX, offsetY }) => [offsetX, offsetY];
    /** @type {Pair | null} */
    let pressed = null;
    ink.addEventListener('pointerdown', (event) => (pressed = at(event)));
    ink.addEventListener('pointermove', (event) => {
      if (!event.buttons) this.point(...at(event));
      else if (this.mode !== 'scene') this.section.drag(event.movementY);
    });
    ink.addEventListener('pointerup', (event) => {
      const [x, y] = at(event);
      const found = pressed && event.button === 0 && Math.hypot(x - pressed[0], y - pressed[1]) < 5 ? this.found(x, y) : null;
      if (!found) return;
      if (this.mode === 'scene') this.show(found.well, found.depth);
      else window.open(`${this.addressOf(found.well, found.depth)}&picking=1`, found.well.name);
    });
    ink.addEventListener('dblclick', (event) => {
      const found = this.mode === 'scene' ? this.found(...at(event)) : null;
      if (found) window.open(this.addressOf(found.well, found.depth), found.well.name);
    });
    ink.addEventListener('wheel', (event) => {
      if (this.mode === 'scene') return;
      event.preventDefault();
      this.section.wheel(event.deltaY / (event.deltaMode === 1 ? 3 : 100), event.ctrlKey || event.metaKey, event.offsetY);
    }, { passive: false });
    window.addEventListener('keydown', (event) => {
      if (/^(INPUT|SELECT|TEXTAREA)$/.test(/** @type {HTMLElement} */ (event.target).tagName) || event.ctrlKey || event.metaKey || event.altKey) return;
      if (event.key === 'h') this.fit();
      else if (event.key === 't') view.toggleTheme();
      else if (event.key === 's') this.mode = this.mode === 'scene' ? 'section' : 'scene';
      else return;
      this.changed();
    });
  }

  fit() {
    this.scene.fitted = this.section.fitted = false;
    this.scene.all = true;
    this.redraw();
  }

  // Return the well, and the depth in it, under a place of the picture.
  /** @param {number} x @param {number} y */
  found(x, y) {
    return this.mode === 'scene' ? this.scene.found(x, y) : this.section.found(x, y);
  }

  /** @param {number} x @param {number} y */
  point(x, y) {
    const found = this.found(x, y);
    byId('ink').style.cursor = found ? 'pointer' : this.mode === 'scene' ? 'grab' : '';
    write('readout', found ? this.section.rows(found.well, found.depth) : []);
  }

  // Save the picture under a line with the names of the wells; a slide is drawn in fewer pixels, so that its texts are larger.
  // It waits for what has not arrived, at most WAIT.
  /** @param {'png' | 'svg' | 'slide'} kind @param {number} [began] @returns {void} */
  savePicture(kind, began = performance.now()) {
    for (const well of this.drawn) well.mostTiles = MOST_TILES;
    this.draw();
    if (this.drawn.some(({ lacks }) => lacks) && performance.now() - began < WAIT) return void setTimeout(() => this.savePicture(kind, began), 50);
    const vector = kind === 'svg';
    const file = `wells-${this.mode}.${kind === 'slide' ? 'slide.png' : kind}`; // of the picture, though the mode changes before it is made
    const inks = byId('ink');
    const { scene } = this;
    const eye = { from: scene.from, target: scene.orbit.target };
    const whole = kind === 'slide' && this.mode === 'scene' && scene.whole; // then it fills the slide, too
    if (kind === 'slide') Object.assign(byId('stage').style, { flex: 'none', width: `${SLIDE.width}px`, height: `${SLIDE.height - BAND}px` });
    const [width, height] = [inks.clientWidth, inks.clientHeight + BAND];
    const ratio = Math.max(vector ? 2 : Math.min(4, WIDE / width), pixelRatio(inks));
    const canvas = Object.assign(document.createElement('canvas'), { width: width * ratio, height: height * ratio });
    /** @type {string[]} */
    const parts = [];
    const ink = vector ? recorder(pen(canvas), parts, () => ratio) : pen(canvas);
    const palette = PALETTES[this.view.theme];
    ink.scale(ratio, ratio);
    ink.fillStyle = palette.paper;
    ink.fillRect(0, 0, width, height);
    ink.font = BOLD;
    ink.fillStyle = palette.ink;
    ink.fillText([this.drawn.map((well) => well.name).join(', '), this.mode === 'scene' ? '' : this.section.depthsInWords, this.mode === 'scene' ? this.note.replace(' (path.head)', '') : ''].filter(Boolean).join('   '), 8, 17);
    if (kind === 'slide') inks.slide = {};
    if (whole) {
      scene.rect = { left: 0, top: 0, width: SLIDE.width, height: SLIDE.height - BAND - BAR };
      scene.fit(normalised(eye.from));
    }
    sharpen(ratio);
    this.movedAt = 0;
    /** @type {string[]} */
    const strokes = [];
    if (vector) inks.recorder = recorder(pen(inks), strokes, () => ratio);
    this.draw();
    delete inks.recorder;
    delete inks.slide;
    ink.drawImage(this.gpu.canvas, 0, BAND, width, height - BAND);
    if (!vector) ink.drawImage(inks, 0, BAND, width, height - BAND);
    sharpen(0);
    byId('stage').removeAttribute('style');
    for (const well of this.drawn) well.mostTiles = FINE_TILES;
    if (whole) scene.restore(eye.from, eye.target);
    this.redraw();
    /** @param {Blob | null} blob */
    const keep = (blob) => blob && save(blob, file);
    if (vector) keep(svgFile(width, height, [...parts, `<g transform="translate(0 ${BAND})">`, ...strokes, '</g>']));
    else canvas.toBlob(keep);
  }

  toAddress() {
    const { view, scene, section } = this;
    const parts = new URLSearchParams({ mode: this.mode, quantity: this.quantityId, cut: this.cut, units: view.units, theme: view.theme, ...(view.tube ? { tube: String(view.tube) } : {}), ...(scene.tall > 1 ? { tall: String(scene.tall) } : {}), ...(this.datumChosen ? { datum: this.datum } : {}) });
    if (scene.fitted) parts.set('eye', [...scene.from, ...scene.orbit.target].map((x) => x.toFixed(2)).join('_'));
    if (section.fitted) parts.set('between', [section.top, section.length].map((x) => x.toFixed(3)).join('_'));
    const off = SHOWN.filter((id) => !this.shown[id]);
    if (off.length) parts.set('off', off.join('_'));
    return `#${parts}`;
  }

  fromAddress() {
    const parts = new URLSearchParams(location.hash.slice(1));
    this.mode = parts.get('mode') === 'section' ? 'section' : 'scene';
    this.quantityId = parts.get('quantity') ?? '';
    this.datumChosen = parts.has('datum');
    this.datum = parts.get('datum') ?? '';
    const [theme, units, cut] = ['theme', 'units', 'cut'].map((name) => parts.get(name));
    if (theme === 'light' || theme === 'dark') this.view.choose({ theme });
    if (cut && cut in CUTS) this.cut = /** @type {Cut} */ (cut);
    if (units === 'mm' || units === 'in' || units === 'ft') this.view.choose({ units });
    this.scene.tall = HEIGHTS.find((tall) => String(tall) === parts.get('tall')) ?? 1;
    this.view.choose({ tube: TUBES.find((tube) => String(tube) === parts.get('tube')) ?? 0 });
    const [eye, between] = ['eye', 'between'].map((name) => numbers(parts.get(name)));
    if (eye.length === 6) this.scene.restore(eye.slice(0, 3), eye.slice(3));
    if (between.length === 2 && between[1] > 0) Object.assign(this.section, { top: between[0], length: between[1], fitted: true });
    for (const id of SHOWN) {
      this.shown[id] = !(parts.get('off') ?? '').split('_').includes(id);
      byId(id).checked = this.shown[id];
    }
  }
}

// Return how far to the east of its path each well is drawn. Wells without a stated place stand side by side.
/** @param {ListedWell[]} wells */
export function placed(wells) {
  /** @param {ListedWell} of */
  const unknown = ({ head }) => !head || head.every((x) => x === 0);
  const lost = wells.filter(unknown);
  if (lost.length < 2) return { east: wells.map(() => 0), note: '' };
  const apart = niceStep(Math.max(...wells.map(({ length }) => length)) / 5);
  return {
    east: wells.map((well) => (unknown(well) ? apart * lost.indexOf(well) : 0)),
    note: `No place is stated for ${lost.length === wells.length ? 'the wells' : lost.map(({ name }) => name).join(', ')} (path.head): their heads are drawn ${apart} m apart.`,
  };
}

Object.assign(globalThis, { more: { marksOf } }); // what dips.js looks for (late.js)
const wells = new Wells();
// For tests: what is loaded, and what the page can do.
Object.assign(window, { __wall: {
  wells,
  get ready() {
    return wells.wells.length > 0 && wells.wells.every(({ ready }) => ready) && wells.pictured === wells.drawn.length;
  },
} });
