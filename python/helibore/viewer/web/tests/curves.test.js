import assert from 'node:assert/strict';
import { test } from 'node:test';
import { curveAt, decodeCurve, rowAt } from '../src/curves.js';
import { fromTemplate } from '../src/template.js';
import { toTemplate } from '../src/template_text.js';
import { showAngle, showDepth, showSpan } from '../src/units.js';
import { ticks } from '../src/view.js';

function bytes(first, offsets, values) {
  const buffer = new ArrayBuffer(8 + 8 * offsets.length);
  new Float64Array(buffer, 0, 1)[0] = first;
  new Float32Array(buffer, 8, offsets.length).set(offsets);
  new Float32Array(buffer, 8 + 4 * offsets.length).set(values);
  return buffer;
}

test('a curve is linear between its rows and has no value in gaps', () => {
  const curve = decodeCurve(bytes(123456.5, [0, 1, 2, 3, 40, 41], [1, 3, NaN, 5, 7, 9]));
  assert.deepEqual([...curve.depth], [0, 1, 2, 3, 40, 41].map((offset) => 123456.5 + offset));
  assert.equal(curve.step, 1);
  assert.deepEqual([0, 1, 3].map((i) => rowAt(curve.depth, 123456.5 + i)), [0, 1, 3]);
  assert.equal(curveAt(curve, 123457), 2);
  assert.equal(curveAt(curve, 123459.5), 5);
  for (const depth of [123456, 123458, 123480, 123500]) assert.ok(Number.isNaN(curveAt(curve, depth)), `${depth}`);
  assert.ok(Number.isNaN(curveAt(decodeCurve(bytes(0, [], [])), 1)), 'an empty curve');
});

test('a template is what the page shows, and gives it back', () => {
  const rect = (left, width) => ({ left, width });
  const page = {
    view: { units: 'ft' }, selection: { quantity: { id: 'GR' }, besides: [{ id: 'over' }, { id: 'a "b"' }] }, curves: { shown: [{ name: 'ROP' }, { name: 'DEQ' }] },
    renderer: { paper: 200, rects: { map: rect(0, 50), axis: rect(50, 70), beside0: rect(130, 100), image: rect(240, 200.4), caliper: rect(0, 0), curves: rect(450, 90), beside1: rect(550, 80), pane: rect(700, 300), wall: rect(700, 200) } },
  };
  const text = toTemplate(page);
  assert.match(text, /^unit = "ft"\nscale = 200\n\n\[\[track\]\]\nkind = "image"\nname = "Radius"\nwidth = 100\n/);
  assert.match(text, /kind = "curves"\nnames = \["ROP", "DEQ"\]\nwidth = 90\n/);
  assert.match(text, /name = "a \\"b\\""/);
  const track = (kind, name, names, width) => ({ kind, name, names, width });
  const tracks = [track('caliper', '', [], 90), track('image', 'Radius', [], 100), track('image', 'none', [], 7), track('curves', '', ['ROP'], null), track('image', 'GR', [], 200)];
  assert.deepEqual(fromTemplate({ unit: 'mm', track: tracks }, [{ id: 'GR' }, { id: 'over' }]), {
    units: 'mm', quantity: 'over', beside: ['GR'], curves: ['ROP'], order: ['caliper', 'image', 'curves', 'beside0'], widths: { caliper: 90, image: 100, beside0: 200 },
  });
});

test('a track of intervals that a template names stands where the template has it, unless the wall lacks it', () => {
  const view = { units: 'mm' };
  const rects = { map: {}, axis: {}, image: { width: 100 }, column1: { width: 130 }, pane: {}, wall: {} };
  const text = toTemplate({ view, store: { columns: ['Casing', 'Lithology'] }, renderer: { rects, paper: null }, selection: { quantity: { id: 'over' }, besides: [] }, curves: { shown: [] } });
  assert.match(text, /kind = "intervals"\nname = "Lithology"\nwidth = 130/);
  const tracks = ['Shows', 'Lithology'].map((name) => ({ kind: 'intervals', name, names: [], width: 130 }));
  assert.deepEqual(fromTemplate({ unit: 'mm', track: tracks }, [], ['Casing', 'Lithology']), {
    units: 'mm', beside: [], curves: ['Lithology'], order: ['column1'], widths: { column1: 130 },
  });
});

test('feet are round numbers of feet at depths in metres', () => {
  const found = ticks(304.8, 335.28, 500, 60, 1 / 0.3048);
  assert.deepEqual(found.values.map((depth) => Math.round(depth / 0.3048)), [1000, 1020, 1040, 1060, 1080, 1100]);
  assert.deepEqual([showAngle(359.96), showAngle(359.7, 0), showAngle(359.94), showAngle(NaN)], ['0.0°', '0°', '359.9°', '–']);
  assert.equal(showDepth(304.8, 'ft'), '1000.00 ft');
  assert.equal(showDepth(304.8, 'in'), '304.80 m');
  assert.equal(showSpan(304.8, 335.28, 'ft'), '1000.0–1100.0 ft');
  assert.equal(showSpan(2553.11, 2553.14, 'mm'), '2553.1 m', 'what is short has one depth');
});
