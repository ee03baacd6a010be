// Notes at a depth: the key B writes a note at the cursor, or opens the note that is there. A note is a pick of the class note, and
// is saved as picks are.

import { BOLD, fitting, label, PALETTES, yOf } from './layout.js';
import { byId } from './dom.js';
import { newKey, NOTE } from './picking.js';
import { line } from './strokes.js';
import { showDepth } from './units.js';

const HIDDEN = /[\p{Cc}\p{Bidi_Control}\u2028\u2029\ufeff]/gu; // the server refuses them
const NEAR = 8; // pixels: a note within this distance of the cursor is opened

export class Notes {
  at = /** @type {Note} */ ({ key: '', kind: NOTE, depth: NaN, toolface: 0, note: '' });

  /** @param {App} app */
  constructor(app) {
    this.app = app;
    const card = byId('note');
    card.addEventListener('close', () => this.close(card.returnValue));
  }

  open() {
    const { picking, view, renderer: { rects } } = this.app;
    const depth = view.cursor?.depth ?? view.middle;
    const near = (NEAR / rects.image.height) * view.length;
    this.at = picking.notes.find((note) => Math.abs(note.depth - depth) < near) ?? { ...this.at, key: newKey(), depth, note: '' };
    byId('noteTitle').textContent = `Note at ${showDepth(this.at.depth, view.units)}, ${picking.where}`;
    byId('noteText').value = this.at.note;
    const card = byId('note');
    card.returnValue = '';
    card.showModal();
  }

  /** @param {string} choice */
  close(choice) {
    const note = byId('noteText').value.replace(HIDDEN, '').trim();
    if (choice) this.app.picking.change([{ key: this.at.key, pick: choice === 'keep' && note ? { ...this.at, note } : null }]);
  }
}

// Draw the notes on the image: a line at the depth and, above the line or, where other words stand, below it, as much of the text
// as the track has room for.
/** @param {Ink} ink @param {Look} look */
export function drawNotes(ink, { view, rects, notes }) {
  const palette = PALETTES[view.theme];
  const { left, width } = rects.image;
  for (const { depth, note } of notes) {
    if (depth < view.top || depth > view.bottom) continue;
    const y = Math.round(yOf(view, rects.image, depth)) + 0.5;
    line(ink, left, y, left + width, y, palette.pin);
    ink.font = BOLD;
    label(ink, fitting(ink, [note], width - 12), left + 6, y - 9, { colour: palette.pin, halo: palette.paper, font: BOLD, near: [[0, 0], [0, 18]], yields: true });
  }
}
