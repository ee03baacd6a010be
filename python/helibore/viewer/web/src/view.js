// What the user looks at: the section, the cursor, the colours, the exaggerations. Every panel shows the same section and
// cursor. A change redraws; only the tiles of a new section are requested. The address after # holds all of it.

import { isInside } from './inside.js';
import { CUTS } from './path.js';
import { niceStep, tubeFor } from './lod.js';
import { LENGTHS } from './units.js';

const SHORTEST = 0.5; // metres of section
const MOST_BESIDE = 3;
const MOST_CURVES = 8; // and columns of intervals
const AHEAD = 0.08; // of the section left free beyond the newest quad while following

const NARROWEST = 64; // pixels of a track

// From where the 3-D view is seen.
export const CAMERAS = { straight: 'straight', outside: 'on its path', down: 'inside, down', up: 'inside, up' };

// What the user can choose, with the initial values.
class Settings {
  quantity = 'over';
  cut = /** @type {Cut} */ ('top');
  units = /** @type {Units} */ ('mm');
  pass = /** @type {Pass} */ ('latest');
  theme = /** @type {Theme} */ ('light');
  picks = /** @type {'on' | 'off'} */ ('on'); // whether they are drawn
  tube = 0; // 0: chosen from the section
  shape = 0; // 0: × 3 in the column, the true shape elsewhere
  median = 1;
  follow = true;
  camera = /** @type {keyof typeof CAMERAS} */ ('straight');
  turn = 0; // degrees that the straightened hole is turned, so that more of it is at the right
  turned = false; // whether the user turned the hole by hand
  tab = 'log'; // the open tab of a narrow screen
  curtain = /** @type {number | null} */ (null); // share of the first image, from which on another one lies over it
  string = /** @type {number | null} */ (null); // depth to which the string was dragged; null: it hangs with the bit
  rig = false; // large digits; follows the bit, whatever the user does
}
const DEFAULTS = new Settings();
const CHOICES = /** @type {const} */ (['quantity', 'cut', 'pass', 'picks', 'tube', 'shape', 'median', 'camera', 'turn', 'tab', 'string', 'curtain']);
const LISTS = /** @type {const} */ (['beside', 'curves', 'order']);
const SWITCHES = /** @type {const} */ (['follow', 'rig']);

const INK = ['cursor', 'pins', 'follow', 'string']; // what the WebGL picture does not show

// Numbers of an address.
/** @param {string | null} text */
export const numbers = (text) => (text ? text.split('_').map(Number).filter(Number.isFinite) : []);

// Return the most metres that are in view.
/** @param {Store} store */
export const longest = ({ span: [shallow, deep] }) => Math.max(20, (deep - shallow) * 1.1);

export class View extends Settings {
  /** @type {Bend | undefined} */
  bent = undefined; // an axis of true depth (wells_section.js)
  length = 30;
  top = 0;
  /** @type {Cursor | null} */
  cursor = null;
  pinned = false;
  ahead = 0; // metres from the end of the section to the eye inside, after a cursor was held there
  /** @type {number[]} */
  eye = []; // on the path: places of the eye and of what it looks at, metres from the middle of the section; empty: all of it is in view
  /** @type {Pair} */
  head = [0, 0]; // viewing direction of the eye inside: radians to the left of along the hole, and above it
  /** @type {Pick<View, 'top' | 'length' | 'follow'> | null} */
  desk = null; // the section before rig mode
  /** @type {number[]} */
  pins = []; // depths of sections kept beside the polar plot
  /** @type {string[]} */
  beside = []; // ids of the quantities whose images stand beside the first
  imagesChosen = false; // by the address or the user
  sized = false; // whether the address, or the first wall of the page, has set how long the section is
  themeChosen = false; // by the address or the user; if not, the theme is that of the machine
  unitsChosen = false; // by the address, a template or the user; if not, the units are those of the source
  /** @type {string[]} */
  curves = []; // names of the curves along the hole that are shown
  curvesChosen = false; // by the address or the user
  /** @type {Record<string, number>} */
  widths = {}; // pixels of the tracks that the user made wider or narrower
  /** @type {string[]} */
  order = []; // of the tracks, where the user changed it

  // `redraw` is called when the cursor changes, `repaint` when the picture does.
  /** @param {() => void} redraw @param {() => void} repaint */
  constructor(redraw, repaint = redraw) {
    super();
    this.redraw = redraw;
    this.repaint = repaint;
  }

  get bottom() {
    return this.top + this.length;
  }

  get middle() {
    return this.top + this.length / 2;
  }

  // The only way to change a view; the actions below use it. In rig mode the view follows, whatever the user does.
  /** @param {Partial<View>} changes */
  #change(changes) {
    const names = /** @type {(keyof View)[]} */ (Object.keys(changes)).filter((name) => this[name] !== changes[name]);
    this.unitsChosen ||= 'units' in changes;
    Object.assign(this, changes, this.rig && changes.rig !== false ? { follow: true } : {});
    if (changes.camera === 'straight') this.head = [0, 0];
    if (names.every((name) => INK.includes(name))) this.redraw();
    else this.repaint();
  }

  // Choose settings: units, theme, what is coloured, exaggerations ...
  /** @param {Partial<Settings>} settings */
  choose(settings) {
    this.#change({ ...settings, ...(settings.theme ? { themeChosen: true } : {}) });
  }

  toggleTheme() {
    this.choose({ theme: this.theme === 'dark' ? 'light' : 'dark' });
  }

  // Take the theme of the machine, unless one was chosen.
  /** @param {boolean} dark */
  followTheme(dark) {
    if (!this.themeChosen) this.#change({ theme: dark ? 'dark' : 'light' });
  }

  // Take the units of the source, unless some were chosen.
  /** @param {Units} units */
  followUnits(units) {
    if (this.unitsChosen || units === this.units) return;
    this.#change({ units });
    this.unitsChosen = false;
  }

  // Turn the straightened hole. Once the user has turned it by hand, nothing else turns it.
  /** @param {number} turn @param {boolean} byHand */
  turnTo(turn, byHand) {
    if (byHand || !this.turned) this.#change({ turn: ((turn % 360) + 360) % 360, turned: byHand });
  }

  // Show the hole over the full width, or beside the tracks; on a narrow screen these are tabs.
  toggleWhole() {
    this.#change({ tab: this.tab === '3d' ? 'log' : '3d' });
  }

  // Put the cursor somewhere, or remove it; `pinned`: it stays there when the pointer moves.
  /** @param {Cursor | null} cursor @param {boolean} [pinned] */
  point(cursor, pinned = this.pinned) {
    this.#change({ cursor, pinned });
  }

  release() {
    this.#change({ pinned: false });
  }

  // Look at the hole on its path from a place.
  /** @param {number[]} eye */
  lookFrom(eye) {
    this.#change({ eye });
  }

  // Keep the section at a depth beside the cross-section, or remove it; only the last three sections are kept.
  /** @param {number} depth */
  keepSection(depth) {
    const others = this.pins.filter((pin) => Math.abs(pin - depth) > 1e-3);
    this.#change({ pins: others.length < this.pins.length ? others : [...others, depth].slice(-3) });
  }

  // Colour the first image by a quantity, and show images of the quantities `beside` next to it.
  /** @param {string} quantity @param {string[]} beside @param {Record<string, number>} [widths] */
  showImages(quantity, beside, widths = this.widths) {
    this.#change({ quantity, widths, beside: beside.slice(0, MOST_BESIDE), imagesChosen: true });
  }

  // Show these images beside the first image, or `first` alone, and these curves, unless the user or the address chose.
  /** @param {string[]} beside @param {string[]} curves @param {string} [first] */
  usual(beside, curves, first) {
    if (!this.imagesChosen) this.#change(first ? { quantity: first, beside: [] } : { beside: beside.slice(0, MOST_BESIDE) });
    if (!this.curvesChosen) this.#change({ curves });
  }

  // Keep the section's length when the page connects again.
  keepLength() {
    this.sized = true;
  }

  // Show or hide a curve.
  /** @param {string} name */
  toggleCurve(name) {
    this.#change({ curvesChosen: true, curves: this.curves.includes(name) ? this.curves.filter((one) => one !== name) : [...this.curves, name].slice(-MOST_CURVES) });
  }

  /** @param {string} track @param {number} width */
  widen(track, width) {
    this.#change({ widths: { ...this.widths, [track]: Math.max(NARROWEST, Math.round(width)) } });
  }

  /** @param {string[]} order */
  arrange(order) {
    this.#change({ order });
  }

  // Show the tracks of a template.
  /** @param {Pick<View, 'units' | 'beside' | 'curves' | 'order' | 'widths'> & { quantity?: string }} tracks */
  showTracks(tracks) {
    this.#change(tracks);
  }

  // Rig mode: large digits, following the bit along the last `length` metres. When it ends, the earlier section returns.
  /** @param {number} length @param {boolean} [on] */
  toggleRig(length, on = !this.rig) {
    const { top, length: before, follow } = this;
    this.#change(on ? { rig: true, follow: true, desk: { top, length: before, follow }, length, cursor: null, pinned: false } : { rig: false, ...this.desk });
  }

  // Show `length` metres from `top`, kept near the wall. A move by the user stops following the bit.
  /** @param {number} top @param {number} length @param {Store} store @param {boolean} [byHand] */
  show(top, length, store, byHand = true) {
    if (this.rig && byHand) return;
    const [shallow, deep] = store.span;
    const size = Math.min(Math.max(length, SHORTEST), longest(store));
    const beyond = size * (byHand ? 0.5 : 0.7); // the bit that is followed may be so far ahead
    const clamped = Math.min(Math.max(top + (length - size) / 2, shallow - beyond), Math.max(deep - size + beyond, shallow - beyond));
    this.#change({ top: clamped, length: size, ...(byHand ? { follow: false } : {}) });
  }

  /** @param {number} depth @param {Store} store @param {boolean} [byHand] */
  centre(depth, store, byHand = true) {
    this.ahead = 0;
    this.show(depth - this.length / 2, this.length, store, byHand);
  }

  // Change the length, holding `depth` where it is on screen; while following, the newest quad stays in place.
  /** @param {number} factor @param {number} depth @param {Store} store */
  zoom(factor, depth, store) {
    const share = (depth - this.top) / this.length;
    const length = this.length * factor;
    if (this.follow) {
      this.length = Math.max(SHORTEST, length);
      this.followEnd(store);
    } else this.show(depth - share * length, length, store);
  }

  // Move the section so that its last part, in drilling direction, shows the growing end of the wall; the bit instead, if it is
  // ahead of the wall by at most 0.6 of the section.
  /** @param {Store} store @param {number | null} [bitDepth] */
  followEnd(store, bitDepth = null) {
    const down = store.levels[0].pitch > 0;
    const end = store.end;
    const beyond = bitDepth === null || Math.abs(bitDepth - end) > this.length * 0.6 ? end : bitDepth;
    const lead = down ? Math.max(end, beyond) : Math.min(end, beyond);
    const top = down ? lead - this.length * (1 - AHEAD) : lead - this.length * AHEAD;
    this.show(top, this.length, store, false);
  }

  /** @param {Store} store */
  tubeFactor(store) {
    return isInside(this) ? 1 : this.tube || tubeFor(this.length, store.bitRadius); // from inside the hole is as it is
  }

  toAddress() {
    /** @type {Record<string, string>} */
    const parts = { md: this.middle.toFixed(2), sec: String(Number(this.length.toFixed(6))) };
    for (const key of CHOICES) {
      if (this[key] !== DEFAULTS[key]) parts[key] = String(this[key]);
    }
    if (this.themeChosen) parts.theme = this.theme;
    if (this.unitsChosen) parts.units = this.units;
    const chosen = { beside: this.imagesChosen, curves: this.curvesChosen, order: false };
    for (const key of LISTS) if (this[key].length || chosen[key]) parts[key] = this[key].join('~');
    if (Object.keys(this.widths).length) parts.widths = Object.entries(this.widths).flat().join('~');
    for (const key of SWITCHES) if (this[key]) parts[key] = '1';
    const { cursor, pinned, pins, ahead, eye, head } = this;
    if (ahead) parts.ahead = ahead.toFixed(3);
    for (const [name, values] of Object.entries({ eye, head })) if (values.some(Boolean)) parts[name] = values.map((one) => one.toFixed(3)).join('_');
    if (pinned && cursor) parts.at = [cursor.depth.toFixed(3), ...(cursor.toolface === null ? [] : [cursor.toolface.toFixed(1)])].join('_');
    if (pins.length) parts.sections = pins.map((depth) => depth.toFixed(3)).join('_');
    return `#${new URLSearchParams(parts)}`;
  }

  // Apply the valid parts of an address; the rest stays as it was. Returns whether the address names a depth.
  /** @param {string} hash */
  fromAddress(hash) {
    const parts = new URLSearchParams(hash.replace(/^#/, ''));
    /** @param {string} key @param {number} low @param {number} high */
    const number = (key, low, high) => {
      const value = parts.has(key) ? Number(parts.get(key)) : NaN;
      return value >= low && value <= high ? value : null;
    };
    /** @template {string} T @param {string} key @param {T[]} values @returns {T | null} */
    const among = (key, values) => values.find((value) => value === parts.get(key)) ?? null;
    const [at, toolface] = numbers(parts.get('at'));
    if (at !== undefined) [this.cursor, this.pinned] = [{ depth: at, toolface: toolface ?? null }, true];
    this.pins = numbers(parts.get('sections')).slice(0, 3);
    const [eye, [left = 0, raised = 0]] = ['eye', 'head'].map((name) => numbers(parts.get(name)));
    this.eye = eye.length === 6 && eye.some((x, i) => i < 3 && x !== eye[i + 3]) ? eye : [];
    this.head = [left, raised];
    const taken = {
      length: number('sec', SHORTEST, 1e5),
      tube: number('tube', 0, 1000),
      shape: number('shape', 0, 100),
      turn: number('turn', 0, 360),
      string: number('string', -1e5, 1e6),
      ahead: number('ahead', -1e5, 1e5),
      curtain: number('curtain', 0, 1),
      median: [1, 3, 5].includes(number('median', 1, 5) ?? 0) ? number('median', 1, 5) : null,
      cut: among('cut', /** @type {Cut[]} */ (Object.keys(CUTS))),
      units: among('units', /** @type {Units[]} */ (Object.keys(LENGTHS))),
      pass: among('pass', ['latest', 'first', 'change']),
      picks: among('picks', ['on', 'off']),
      theme: among('theme', ['light', 'dark']),
      tab: among('tab', ['log', '3d', 'section', 'zones']),
      camera: among('camera', /** @type {(keyof typeof CAMERAS)[]} */ (Object.keys(CAMERAS))),
      quantity: parts.get('quantity')?.slice(0, 80) ?? null,
    };
    this.themeChosen ||= taken.theme !== null;
    this.unitsChosen ||= taken.units !== null;
    Object.assign(this, Object.fromEntries(Object.entries(taken).filter(([, value]) => value !== null)));
    /** @param {string} key @param {number} most */
    const listed = (key, most) => parts.get(key)?.split('~').slice(0, most) ?? [];
    this.imagesChosen = parts.has('beside') || parts.has('quantity');
    this.sized = parts.has('sec');
    this.beside = listed('beside', MOST_BESIDE).filter(Boolean);
    this.curvesChosen = parts.has('curves');
    this.curves = listed('curves', MOST_CURVES).filter(Boolean);
    this.order = listed('order', 20);
    const widths = listed('widths', 40);
    this.widths = Object.fromEntries(widths.flatMap((name, i) => (i % 2 === 0 && Number(widths[i + 1]) > 0 ? [[name, Number(widths[i + 1])]] : [])));
    this.rig = parts.get('rig') === '1';
    if (this.rig) this.follow = true;
    const depth = number('md', -1e5, 1e6);
    if (depth === null) return false;
    this.follow = this.rig || parts.get('follow') === '1';
    this.top = depth - this.length / 2;
    return true;
  }
}

// Return the depths of the ticks between two depths, so that labels are at least `apart` pixels from each other.
// `scale`: labels are round numbers of a unit of which `scale` make a metre.
/** @param {number} top @param {number} bottom @param {number} pixels @param {number} apart @param {number} [scale] */
export function ticks(top, bottom, pixels, apart, scale = 1) {
  const step = niceStep(((bottom - top) / pixels) * apart * scale);
  const out = [];
  for (let i = Math.ceil((top * scale) / step - 1e-9); i * step <= bottom * scale + 1e-9; i++) out.push((i * step) / scale);
  return { step: step / scale, values: out, digits: Math.max(0, -Math.floor(Math.log10(step) + 1e-9)) };
}
