import assert from 'node:assert/strict';
import { test } from 'node:test';
import { bed, drilled, joined } from '../src/wells_scene.js';
import { farApart } from '../src/wells_section.js';

test('a bed has a top or a base where the well has drilled it, and not where the data end', () => {
  const intervals = [['above', 990, 1005], ['whole', 1005, 1010], ['below', 1010, 1016], ['open', 1012, null]];
  const well = { store: { intervals, span: [1000, 1016], levels: [{ pitch: -0.1 }] } };
  assert.deepEqual(intervals.map(([name]) => drilled(well, name)), [[false, true], [true, true], [true, false], [true, false]]);
  assert.deepEqual(bed(well, 'above'), [1000, 1005]);
  assert.deepEqual(drilled(well, 'not here'), [false, false]);
});

test('wells that are measured at very different depths stand side by side by true depth, if all have one', () => {
  const well = (span, tvd) => ({ store: { span }, path: { tvd: () => tvd } });
  assert.equal(farApart([well([2010, 2040], 1883), well([1900, 1930], 1885)]), true);
  assert.equal(farApart([well([2010, 2040], 1883), well([2000, 2030], 1885)]), false);
  assert.equal(farApart([well([2010, 2040], NaN), well([1900, 1930], 1885)]), false);
  assert.equal(farApart([]), false);
});

test('a bed that one well lacks wedges out where the beds above and below it meet there', () => {
  const well = (...intervals) => ({ store: { intervals, span: [1000, 1020], levels: [{ pitch: -0.1 }] } });
  const whole = well(['a', 1002, 1005], ['b', 1005, 1009], ['c', 1009, 1014]);
  assert.deepEqual(joined(whole, well(['a', 1001, 1006], ['c', 1006, 1012]), 'b'), { a: [1005, 1009], b: [1006, 1006], top: true, base: true, lacks: true });
  assert.deepEqual(joined(well(['a', 1001, 1006], ['c', 1006, 1012]), whole, 'b'), { a: [1006, 1006], b: [1005, 1009], top: true, base: true, lacks: true });
  assert.equal(joined(whole, whole, 'b').lacks, false);
  assert.equal(joined(whole, well(['a', 1001, 1006], ['x', 1006, 1008], ['c', 1008, 1012]), 'b').b, null); // another bed lies between them
  assert.equal(joined(whole, well(['a', 990, 995], ['c', 995, 1012]), 'b').b, null); // they meet above the measured hole
  assert.equal(joined(whole, well(['a', 1001, 1006]), 'b').b, null);
  assert.equal(joined(whole, well(['b', 1005, 1030]), 'b').base, false);
});
