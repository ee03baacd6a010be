// Zones: which one is at a depth, and the jumps from the worst to the next.

import assert from 'node:assert/strict';
import { test } from 'node:test';
import { bySeverity, isSure, jump, letterZones, turnTowards, zoneAt, zoneText } from '../src/zones.js';
import { withoutPicked } from '../offline/figures.js';
import { unpicked } from '../src/unpicked.js';

const ZONES = [
  { kind: 'breakout', start: 10, stop: 12, measure: 0.03, severity: 1.2, confidence: 1 },
  { kind: 'washout', start: 20, stop: 23, measure: 0.07, severity: 5.5, confidence: 1 },
  { kind: 'undergauge', start: 30, stop: 31, measure: -0.01, severity: 1.6, confidence: 1 },
];

test('the worst zone comes first', () => {
  assert.deepEqual(bySeverity(ZONES).map(({ start }) => start), [20, 30, 10]);
});

test('a washout at an open fracture that was picked is drawn as the fracture', () => {
  const pick = { key: 'f', kind: 'fracture', depth: 21.5, toolface: 0, apparent_dip: 86, radius: 0.11, aperture: 0.02 };
  /** @param {object[]} picks */
  const kinds = (picks) => unpicked(ZONES, picks, 0.1).map(({ kind }) => kind);
  assert.deepEqual(kinds([pick]), ['breakout', 'undergauge'], 'its trace reaches from 19.9 to 23.1');
  for (const other of [{ ...pick, aperture: null }, { ...pick, apparent_dip: 80 }, { ...pick, depth: 25 }, { key: 'b', kind: 'breakout', depth: 21.5, height: 4, opening: 90, toolface: 0 }]) {
    assert.deepEqual(kinds([other]), ['breakout', 'washout', 'undergauge']);
  }
  const figures = { kinds: Int32Array.of(1, 1, 1, 2, -1), depth: Float64Array.of(19.9, 21, 25, 22, 22), pitch: 0.1, bit: 0.22 };
  assert.deepEqual([...(withoutPicked(/** @type {any} */ (figures), ZONES, [pick]).kinds ?? [])], [1, 0, 1, 2, -1], 'nor is it counted without a server');
});

test('a zone counts as much as its kind is probable, and says so', () => {
  const [breakout, washout, tight] = ZONES;
  const unsure = { ...washout, confidence: 0.2 };
  assert.deepEqual(bySeverity([breakout, unsure, tight]).map(({ kind }) => kind), ['undergauge', 'breakout', 'washout']);
  assert.deepEqual([0.8, 0.79].map((confidence) => isSure({ ...washout, confidence })), [true, false]);
  assert.equal(zoneText({ ...washout, confidence: 0.968 }, 'mm'), 'washout +70 mm, 97 % sure');
  assert.equal(zoneText({ ...washout, confidence: 1 }, 'mm'), 'washout +70 mm, 99 % sure', 'no kind is certain');
});

test('a strip names its kind where the letter has room, and only there', () => {
  const canvas = { labels: [], strokes: [] };
  const box = { actualBoundingBoxLeft: 4, actualBoundingBoxRight: 4, actualBoundingBoxAscent: 4, actualBoundingBoxDescent: 4 };
  const ink = { canvas, measureText: () => box, fillText() {} };
  letterZones(ink, ZONES, (depth) => 5 * depth, 0, [0, 400], { ink: '#000000', zones: { breakout: '#ffffff', washout: '#000000', undergauge: '#000000' } });
  assert.deepEqual(canvas.labels.map(({ text }) => text), ['W'], 'of strips 10, 15 and 5 pixels tall');
});

test('next and previous go by severity, from the worst, and around', () => {
  assert.equal(jump(ZONES, NaN, 1).start, 20);
  assert.equal(jump(ZONES, 5, -1).start, 10);
  assert.equal(jump(ZONES, 21.5, 1).start, 30);
  assert.equal(jump(ZONES, 11, 1).start, 20);
  assert.equal(jump(ZONES, 21.5, -1).start, 10);
  assert.equal(jump([], 5, 1), null);
});

test('of several zones at a depth, the one that a jump went to counts, else the worst', () => {
  const both = [...ZONES, { kind: 'breakout', start: 18, stop: 26, measure: 0.02, severity: 1.1, confidence: 1 }];
  assert.equal(zoneAt(both, 22.5).kind, 'washout');
  assert.equal(zoneAt(both, 22).kind, 'breakout');
});

test('a zone has a half-open range of depth, and a text with its sign', () => {
  assert.equal(zoneAt(ZONES, 10).kind, 'breakout');
  assert.equal(zoneAt(ZONES, 12), null);
  assert.equal(zoneText(zoneAt(ZONES, 30.5), 'mm'), 'undergauge −10 mm, 99 % sure');
  assert.equal(zoneText(null, 'in'), 'none');
});

test('the side of a zone comes to the front, of a breakout the nearer one; a zone all around turns nothing', () => {
  const of = (kind, toolface, left, before) => turnTowards({ ...ZONES[0], kind, toolface }, left, before);
  assert.equal(of('key seat', 180, 0, 0), 90);
  assert.equal(of('key seat', 180, 30, 0), 120, 'the image begins at toolface 30');
  assert.equal(of('breakout', 70, 0, 0), 20);
  assert.equal(of('breakout', 70, 0, 180), 200);
  assert.equal(of('breakout', 70, 0, 350), 20, 'around zero');
  assert.equal(of('washout', undefined, 0, 77), 77);
});
