// True depth: known between the first and the last station, as far as the frames of the wall reach. Where an image is cut open.

import assert from 'node:assert/strict';
import { test } from 'node:test';
import { cutFor, cutsOf, Path } from '../src/path.js';

/** @param {number} step */
function slanted(step) {
  const path = new Path(2000, step);
  const [count, down] = [11, step / 2]; // 60 degrees off vertical
  const centre = Float64Array.from({ length: 3 * count }, (_, k) => (k % 3 === 2 ? 1500 + Math.floor(k / 3) * down : 0));
  path.apply({ first: 0, count, total: count, centre, directions: new Float32Array(6 * count), surveyed: true });
  path.trueDepth = [1000, 3000, 0];
  return path;
}

for (const step of [2, -2]) {
  test(`a true depth is not known above and below the frames, ${step} m apart`, () => {
    const path = slanted(step);
    for (const [place, known] of [[0, 1500], [1, 1500 + step / 2], [9.5, 1500 + 4.75 * step], [10, 1500 + 5 * step], [-0.01, NaN], [10.01, NaN], [-200, NaN]]) {
      const found = path.tvd(2000 + place * step);
      assert.ok(Number.isNaN(known) ? Number.isNaN(found) : Math.abs(found - known) < 2e-3, `${place}: ${found}`);
    }
    path.trueDepth = [2000 + 5 * step - 1, 2000 + 5 * step + 1, 0];
    assert.ok(Number.isNaN(path.tvd(2000 + 8 * step)), 'beyond the survey');
    path.trueDepth = null;
    assert.ok(Number.isNaN(path.tvd(2000 + 5 * step)), 'no survey that gives it');
  });
}

test('a path without frames knows no true depth', () => {
  const path = new Path(2000, 2);
  path.trueDepth = [0, 3000, 0];
  assert.ok(Number.isNaN(path.tvd(2000)));
});

/** @param {number} inclination @param {number} [total] @param {{ surveyed?: boolean, reference?: string | null }} [of] */
function straight(inclination, total = 11, { surveyed = true, reference = null } = {}) {
  const path = new Path(2000, 2, reference);
  const [c, s] = [Math.cos(inclination), Math.sin(inclination)].map(Math.fround);
  path.apply({ first: 0, count: 11, total, centre: new Float64Array(33), directions: Float32Array.from({ length: 66 }, (_, k) => [c, 0, -s, 0, 1, 0][k % 6]), surveyed });
  return path;
}

test('an image begins at the high side, at north where the hole is vertical, and alike in all wells of a page', () => {
  const [leaning, vertical] = [straight(0.6), straight(0.001)];
  assert.deepEqual([cutFor([leaning], 'top'), cutFor([leaning], 'north'), cutFor([vertical], 'top'), cutFor([vertical], 'south')], ['top', 'north', 'north', 'south']);
  assert.deepEqual(cutsOf([leaning]), ['top', 'bottom', 'north', 'south']);
  assert.deepEqual(cutsOf([leaning, vertical]), ['north', 'south']);
  assert.deepEqual(cutsOf([straight(0.001, 40)]), ['top', 'bottom', 'north', 'south'], 'more of the path is to come: it may lean');
  const [byHigh, byNorth] = ['high-side', 'north'].map((reference) => straight(0, 11, { surveyed: false, reference }));
  assert.deepEqual([cutsOf([byHigh]), cutsOf([byNorth])], [['top', 'bottom'], ['north', 'south']]);
});
