// What the user looks at: the section, the cursor, the colours, the exaggerations. Every panel shows the same section and
// cursor. A change redraws; only the tiles of a new section are requested. The address after # holds all of it.

import { CUTS } from './path.js';
import { niceStep, tubeFor } from './lod.js';

const SHORTEST = 0.5; // metres of section
export const MOST_BESIDE = 3;
const AHEAD = 0.08; // of the section left free beyond the newest quad while following

// From where the 3-D view is seen.
export const CAMERAS = { straight: 'straight', outside: 'on its path', down: 'inside, down', up: 'inside, up' };

const DEFAULTS = {
  quantity: 'over',
  cut: 'top',
  units: 'mm',
  pass: 'latest',
  theme: 'light',
  tube: 0, // 0: chosen from the section
  shape: 0, // 0: 3 in the column, true elsewhere
  median: 1,
  follow: true,
  camera: 'straight',
  turn: 0, // degrees that the straightened hole is turned, so that more of it is at the right
  tab: 'log', // of a narrow screen
  rig: false, // large digits; follows the bit, whatever the user does
};

export class View {
  constructor(redraw) {
    Object.assign(this, DEFAULTS);
    this.redraw = redraw;
    this.length = 30;
    this.top = 0;
    this.cursor = null; // {depth, toolface}
    this.pinned = false;
    this.pins = []; // depths of sections kept beside the polar plot
    this.beside = []; // ids of the quantities whose images stand beside the first
    this.listeners = [];
  }

  get bottom() {
    return this.top + this.length;
  }

  get middle() {
    return this.top + this.length / 2;
  }

  set(changes) {
    Object.assign(this, changes, this.rig && changes.rig !== false ? { follow: true } : {});
    for (const listener of this.listeners) listener(changes);
    this.redraw();
  }

  // Show `length` metres from `top`, kept near the wall; by the user's hand it stops following.
  show(top, length, store, byHand = true) {
    if (this.rig && byHand) return;
    const [shallow, deep] = store.span;
    const longest = Math.max(20, (deep - shallow) * 1.1);
    const size = Math.min(Math.max(length, SHORTEST), longest);
    const clamped = Math.min(Math.max(top, shallow - size * 0.5), Math.max(deep - size * 0.5, shallow - size * 0.5));
    this.set({ top: clamped, length: size, ...(byHand ? { follow: false } : {}) });
  }

  centre(depth, store, byHand = true) {
    this.show(depth - this.length / 2, this.length, store, byHand);
  }

  // Change the length, holding `depth` where it is on screen; while following, the newest quad stays in place.
  zoom(factor, depth, store) {
    const share = (depth - this.top) / this.length;
    const length = this.length * factor;
    if (this.follow) {
      this.length = Math.max(SHORTEST, length);
      this.followEnd(store);
    } else this.show(depth - share * length, length, store);
  }

  // Put the growing end of the wall, or the bit ahead of it, near the edge of the section.
  followEnd(store, bitDepth = null) {
    const down = store.levels[0].pitch > 0;
    const end = store.end;
    const beyond = bitDepth === null || Math.abs(bitDepth - end) > this.length * 0.6 ? end : bitDepth;
    const lead = down ? Math.max(end, beyond) : Math.min(end, beyond);
    const top = down ? lead - this.length * (1 - AHEAD) : lead - this.length * AHEAD;
    this.show(top, this.length, store, false);
  }

  tubeFactor(store) {
    return this.tube || tubeFor(this.length, store.bitRadius);
  }

  toAddress() {
    const parts = { md: this.middle.toFixed(2), sec: this.length.toFixed(2) };
    for (const key of ['quantity', 'cut', 'units', 'pass', 'theme', 'tube', 'shape', 'median', 'camera', 'turn', 'tab']) {
      if (this[key] !== DEFAULTS[key]) parts[key] = this[key];
    }
    if (this.beside.length) parts.beside = this.beside.join('~');
    for (const key of ['follow', 'rig']) if (this[key]) parts[key] = 1;
    return `#${new URLSearchParams(parts)}`;
  }

  // Take what is valid of an address; anything else is left as it was. True when it names a depth.
  fromAddress(hash) {
    const parts = new URLSearchParams(hash.replace(/^#/, ''));
    const number = (key, low, high) => {
      const value = parts.has(key) ? Number(parts.get(key)) : NaN;
      return value >= low && value <= high ? value : null;
    };
    const among = (key, values) => (values.includes(parts.get(key)) ? parts.get(key) : null);
    const taken = {
      length: number('sec', SHORTEST, 1e5),
      tube: number('tube', 0, 1000),
      shape: number('shape', 0, 100),
      turn: number('turn', 0, 360),
      median: [1, 3, 5].includes(number('median', 1, 5)) ? number('median', 1, 5) : null,
      cut: among('cut', Object.keys(CUTS)),
      units: among('units', ['mm', 'in']),
      pass: among('pass', ['latest', 'first', 'change']),
      theme: among('theme', ['light', 'dark']),
      tab: among('tab', ['log', '3d', 'section', 'zones']),
      camera: among('camera', Object.keys(CAMERAS)),
      quantity: parts.get('quantity')?.slice(0, 80) ?? null,
    };
    for (const [key, value] of Object.entries(taken)) if (value !== null) this[key] = value;
    this.beside = parts.get('beside')?.split('~').slice(0, MOST_BESIDE) ?? [];
    this.rig = parts.get('rig') === '1';
    if (this.rig) this.follow = true;
    const depth = number('md', -1e5, 1e6);
    if (depth === null) return false;
    this.follow = this.rig || parts.get('follow') === '1';
    this.top = depth - this.length / 2;
    return true;
  }
}

// Depths of the ticks between two depths so that labels are at least `apart` pixels from each other.
export function ticks(top, bottom, pixels, apart) {
  const step = niceStep(((bottom - top) / pixels) * apart);
  const out = [];
  for (let i = Math.ceil(top / step - 1e-9); i * step <= bottom + 1e-9; i++) out.push(i * step);
  return { step, values: out, digits: Math.max(0, -Math.floor(Math.log10(step) + 1e-9)) };
}
