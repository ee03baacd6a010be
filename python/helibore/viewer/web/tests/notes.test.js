// Notes in an address: what was written comes back, whatever its characters; what was not written by a page is left out.

import assert from 'node:assert/strict';
import { test } from 'node:test';
import { Notes } from '../src/notes.js';

globalThis.document = { getElementById: () => ({ addEventListener() {} }) };

test('notes come back from the address as they were written', () => {
  const notes = new Notes({});
  notes.kept = [{ depth: 1012.5, text: 'tight_spot ~ 50 % & <b>“reamed”</b>' }, { depth: 2000, text: 'Schuh 9⅝"' }];
  const parts = new URLSearchParams();
  parts.set('notes', notes.toAddress());
  const other = new Notes({});
  other.fromAddress(new URLSearchParams(parts.toString()).get('notes'));
  assert.deepEqual(other.kept, notes.kept);
});

test('what no page wrote is left out, and there is an end to it', () => {
  const shown = [];
  const notes = new Notes({ notice: (text) => shown.push(text) });
  notes.fromAddress('x_y~_a~5~5_~5_%E0%A4~7_good~nan_a~1e400_a');
  assert.deepEqual(notes.kept, [{ depth: 7, text: 'good' }]);
  notes.fromAddress(Array.from({ length: 90 }, (_, i) => `${i}_${'x'.repeat(200)}`).join('~'));
  assert.equal(notes.kept.length, 50);
  assert.equal(notes.kept[0].text.length, 80);
  assert.deepEqual(shown, ['The address holds 90 notes: the first 50 are kept, the others are not.']);
  notes.fromAddress(null);
  assert.deepEqual(notes.kept, []);
});

test('one note too many is not kept and says so; the others stay, and can be changed', () => {
  const card = { text: '' };
  globalThis.document = { getElementById: () => ({ addEventListener() {}, get value() { return card.text; } }) };
  const shown = [];
  const notes = new Notes({ redraw() {}, notice: (text) => shown.push(text) });
  const write = (depth, text) => {
    notes.at = notes.kept.find((note) => note.depth === depth) ?? { depth, text: '' };
    card.text = text;
    notes.close('keep');
  };
  for (let depth = 50; depth > 0; depth--) write(depth, `at ${depth}`);
  const before = notes.kept;
  assert.deepEqual(before.map(({ depth }) => depth), Array.from({ length: 50 }, (_, i) => i + 1));
  assert.deepEqual(shown, []);
  write(7.5, 'one more');
  assert.deepEqual(notes.kept, before);
  assert.deepEqual(shown, ['There are 50 notes, as many as are kept: remove one first. This one was not kept: one more']);
  write(50, 'changed');
  assert.equal(notes.kept.length, 50);
  assert.equal(notes.kept.at(-1).text, 'changed');
  assert.equal(shown.length, 1);
});
