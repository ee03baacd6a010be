// What the user has chosen to see: the quantities and their colours, the places that a key or a click goes to. The section and the
// cursor themselves are the view's (view.js).

import { Q_ATTRIBUTE, quantityOf } from './color.js';
import { LENGTHS, scaleOf, showDepth, showSpan } from './units.js';
import { leftEdge } from './path.js';
import { byId } from './dom.js';
import { RECENT, writeRig } from './rig.js';
import { scaleLength } from './tracks.js';
import { jump, turnTowards } from './zones.js';

/** @param {View} view @returns {Pass} */
export const otherPass = ({ pass }) => (pass === 'first' ? 'latest' : 'first');
export const NARROW = window.matchMedia('(max-width: 999px)');
export const PHONE = window.matchMedia('(max-width: 599px)');
const BLINK = 700; // milliseconds that each image is seen
const USUAL_CURVES = 2;
const ROOM_FOR_CURVES = 800; // pixels: in a narrower stage, a track of curves would make the other tracks narrower

export class Selection {
  /** @type {Quantity[]} */
  quantities = [];
  /** @type {string[][]} */
  read = []; // the read-out: pairs of name and text
  toSay = false; // say the values at the cursor when they have arrived
  /** @type {number | undefined} */
  speaking = undefined;
  /** @type {number | undefined} */
  blinking = undefined;

  /** @param {App} app */
  constructor(app) {
    this.app = app;
    this.view = app.view;
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
    const { app, view, quantities } = this;
    const { contents, store } = app;
    document.body.classList.remove('rig');
    const width = byId('stage').clientWidth;
    document.body.classList.toggle('rig', view.rig);
    const room = NARROW.matches ? 1 : Math.floor((width - 600) / 400);
    const curves = NARROW.matches || width < ROOM_FOR_CURVES ? [] : [...store.columns.slice(0, Math.max(0, Math.floor((width - 800) / 200))), ...given.filter((name) => !contents || name in contents.curves).slice(0, USUAL_CURVES)];
    const images = quantities.filter(({ mode, length }) => mode === Q_ATTRIBUTE && !length).map(({ id }) => id);
    const beside = images.filter((id) => id !== this.quantity.id).slice(0, Math.max(0, room));
    return [beside, curves, PHONE.matches && store.basis === 'average' ? images[0] : undefined];
  }

  // Keep the first image beside the others, or drop it.
  keepBeside() {
    const { view, quantity } = this;
    if (view.beside.includes(quantity.id)) return view.showImages(quantity.id, view.beside.filter((id) => id !== quantity.id));
    const next = this.quantities.find(({ id }) => id !== quantity.id && !view.beside.includes(id));
    return view.showImages(next?.id ?? quantity.id, [quantity.id, ...view.beside]);
  }

  // Show the first image and those beside it in turn, so that the eye sees what differs; without any, the first and the latest
  // pass, also in 3-D. Called again, it ends.
  blink() {
    if (this.blinking) this.blinking = clearInterval(this.blinking) ?? undefined;
    else this.blinking = setInterval(() => this.next(), BLINK);
  }

  next() {
    const { view, quantity, besides: [next, ...others] } = this;
    if (next) view.showImages(next.id, [...others.map(({ id }) => id), quantity.id]);
    else view.choose({ pass: otherPass(view) });
  }

  get quantity() {
    return quantityOf(this.quantities, this.view.quantity);
  }

  /** @param {boolean} [on] */
  rig(on) {
    if (byId('rigOpen').hidden) return this.app.notice('Rig mode is for a well that is being drilled: helibore live has it.', 6);
    this.view.toggleRig(RECENT, on);
    if (this.app.store) this.follow(this.view.follow);
    writeRig(this.app);
    this.app.renderer.arrange();
    return this.app.renderer.fit();
  }

  /** @param {boolean} on */
  follow(on) {
    this.view.choose({ follow: on });
    if (on) this.app.follow();
  }

  /** @param {string} text */
  setLength(text) {
    const { view, app: { store, renderer } } = this;
    const [top, bottom] = store.span;
    if (text === 'all') view.show(top - (bottom - top) * 0.02, (bottom - top) * 1.04, store);
    else if (text) view.zoom((text.startsWith('1:') ? scaleLength(renderer.rects.image, Number(text.slice(2))) : Number(text)) / view.length, view.middle, store);
    if (view.follow && text !== 'all') this.app.follow();
    renderer.fit();
  }

  /** @param {string} id */
  setQuantity(id) {
    const { quantity, view, quantities: all } = this;
    if (!all.some((q) => q.id === id)) return;
    const place = `beside${this.besides.findIndex((one) => one.id === id)}`;
    const { image = NaN, [place]: other = NaN, ...widths } = view.widths;
    const swapped = place === 'beside-1' ? view.widths : { ...widths, ...(other && { image: other }), ...(image && { [place]: image }) };
    view.showImages(id, view.beside.map((one) => (one === id ? quantity.id : one)), swapped); // the two images change places, with the widths that they were given
  }

  // Show the difference to the earlier pass that the wall was built beside; without one, what later samples of the run changed.
  showChange() {
    this.setQuantity(this.quantities.find(({ map }) => map === 'difference')?.id ?? '');
  }

  /** @param {Colours} changes */
  setColours(changes) {
    Object.assign(this.quantity, changes, { chosen: true });
    this.app.repaint();
  }

  /** @param {End} end @param {number} shown */
  setEnd(end, shown) {
    const { quantity, view } = this;
    const value = shown / scaleOf(quantity, view.units);
    const other = quantity[end === 'low' ? 'high' : 'low'];
    if (Number.isFinite(value) && (end === 'low' ? value < other : value > other)) this.setColours({ [end]: value });
    else this.app.redraw();
  }

  // Go to the next (1) or previous (-1) zone by severity.
  /** @param {number} step */
  jump(step) {
    const zone = jump(this.app.renderer.zones, this.view.cursor?.depth ?? NaN, step);
    if (zone) this.showZone(zone);
  }

  /** @param {Zone} zone */
  showZone(zone) {
    const { view, app: { store, path } } = this;
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
    const { view, app } = this;
    const depth = shown / LENGTHS[view.units].depth.scale;
    app.redraw(); // so that a refused depth does not stay in the field
    if (!Number.isFinite(depth)) return undefined;
    const [top, bottom] = app.store.span;
    if (depth < top || depth > bottom) return app.notice(`${showDepth(depth, view.units)} is outside the wall, ${showSpan(top, bottom, view.units)}`, 10);
    view.centre(depth, app.store);
    view.choose({ follow: false });
    return view.point({ depth, toolface: null }, true);
  }

  keepSection() {
    this.view.keepSection(this.view.cursor?.depth ?? this.view.middle);
  }

  // Move the cursor by metres and degrees, and the section with it; say where it is.
  /** @param {number} metres @param {number} degrees */
  step(metres, degrees) {
    const { view, app: { store } } = this;
    const { depth, toolface } = view.cursor ?? { depth: view.middle, toolface: null };
    const [top, bottom] = store.span;
    const to = Math.min(bottom, Math.max(top, depth + metres));
    if (to < view.top || to > view.bottom) view.show(view.top + to - depth, view.length, store);
    view.point({ depth: to, toolface: degrees ? ((toolface ?? 0) + degrees + 360) % 360 : toolface }, true);
    clearTimeout(this.speaking);
    this.speaking = setTimeout(() => {
      this.toSay = true;
      this.app.redraw();
    }, 400);
  }

  copy() {
    navigator.clipboard?.writeText(this.read.map((pair) => pair.join('\t')).join('\n'));
  }
}
