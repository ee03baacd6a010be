import assert from 'node:assert/strict';
import { test } from 'node:test';
import { bed, drilled } from '../src/wells_scene.js';

test('a bed has a top or a base where the well has drilled it, and not where the data end', () => {
  const intervals = [['above', 990, 1005], ['whole', 1005, 1010], ['below', 1010, 1016], ['open', 1012, null]];
  const well = { store: { intervals, span: [1000, 1016], levels: [{ pitch: -0.1 }] } };
  assert.deepEqual(intervals.map(([name]) => drilled(well, name)), [[false, true], [true, true], [true, false], [true, false]]);
  assert.deepEqual(bed(well, 'above'), [1000, 1005]);
  assert.deepEqual(drilled(well, 'not here'), [false, false]);
});
