// Notes at a depth: the key B writes a note at the cursor, or opens the note that is there. The address and exports
// hold the notes; the server does not.

import { BOLD, fitting, label, PALETTES, yOf } from './layout.js';
import { byId } from './dom.js';
import { line } from './strokes.js';
import { showDepth } from './units.js';

const MOST = 50;
const LONGEST = 80; // characters
const HIDDEN = /[\p{Cc}\p{Bidi_Control}\u2028\u2029\ufeff]/gu; // an address may come from a stranger
const NEAR = 8; // pixels: a note within this distance of the cursor is opened

export class Notes {
  /** @type {Note[]} */
  kept = [];
  at = /** @type {Note} */ ({ depth: NaN, text: '' });

  /** @param {App} app */
  constructor(app) {
    this.app = app;
    const card = byId('note');
    card.addEventListener('close', () => this.close(card.returnValue));
  }

  open() {
    const { view, renderer: { rects } } = this.app;
    const depth = view.cursor?.depth ?? view.middle;
    const near = (NEAR / rects.image.height) * view.length;
    this.at = this.kept.find((note) => Math.abs(note.depth - depth) < near) ?? { depth, text: '' };
    byId('noteTitle').textContent = `Note at ${showDepth(this.at.depth, view.units)}`;
    byId('noteText').value = this.at.text;
    const card = byId('note');
    card.returnValue = '';
    card.showModal();
  }

  /** @param {string} choice */
  close(choice) {
    const text = byId('noteText').value.trim().slice(0, LONGEST);
    const others = this.kept.filter((note) => note !== this.at);
    if (choice === 'keep' && text && others.length >= MOST) this.app.notice(`There are ${MOST} notes, as many as are kept: remove one first. This one was not kept: ${text}`, 10);
    else if (choice === 'keep' && text) this.kept = [...others, { depth: this.at.depth, text }].sort((a, b) => a.depth - b.depth);
    else if (choice) this.kept = others; // removed, or kept without a text
    this.app.redraw();
  }

  toAddress() {
    return this.kept.map(({ depth, text }) => `${depth.toFixed(3)}_${encodeURIComponent(text).replaceAll('~', '%7E')}`).join('~');
  }

  /** @param {string | null} text */
  fromAddress(text) {
    const found = (text ?? '').split('~').map(noteFrom).filter((note) => note !== null);
    if (found.length > MOST) this.app.notice(`The address holds ${found.length} notes: the first ${MOST} are kept, the others are not.`, 10);
    this.kept = found.slice(0, MOST);
  }
}

/** @param {string} part */
function noteFrom(part) {
  const at = part.indexOf('_');
  const depth = at > 0 ? Number(part.slice(0, at)) : NaN;
  try {
    const text = decodeURIComponent(part.slice(at + 1)).replace(HIDDEN, '').trim().slice(0, LONGEST);
    return Number.isFinite(depth) && text ? { depth, text } : null;
  } catch {
    return null; // not an address that this page wrote
  }
}

// Draw the notes on the image: a line at the depth and, above the line, as much of the text as the track has room for.
/** @param {Ink} ink @param {Look} look */
export function drawNotes(ink, { view, rects, notes }) {
  const palette = PALETTES[view.theme];
  const { left, width } = rects.image;
  for (const { depth, text } of notes) {
    if (depth < view.top || depth > view.bottom) continue;
    const y = Math.round(yOf(view, rects.image, depth)) + 0.5;
    line(ink, left, y, left + width, y, palette.pin);
    ink.font = BOLD;
    label(ink, fitting(ink, [text], width - 12), left + 6, y - 9, { colour: palette.pin, halo: palette.paper, font: BOLD, yields: true });
  }
}
