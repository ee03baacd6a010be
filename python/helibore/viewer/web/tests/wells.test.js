import assert from 'node:assert/strict';
import { test } from 'node:test';
import { bed, drilled } from '../src/wells_scene.js';
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
