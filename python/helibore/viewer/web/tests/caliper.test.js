import test from 'node:test';
import assert from 'node:assert/strict';
import { scaleFor } from '../src/caliper.js';

test('the lines of the caliper track are round, and hole under bit has room', () => {
  const none = { min: new Float32Array([NaN]), max: new Float32Array([NaN]) };
  /** @param {number} min @param {number} max @param {number} [per] */
  const lines = (min, max, per = 1000) => scaleFor(0.216, { min: new Float32Array([min]), max: new Float32Array([max]) }, per).map((one) => Number((one * per).toFixed(6)));
  assert.deepEqual(lines(0.21, 0.297), [180, 200, 220, 240, 260, 280, 300]);
  assert.deepEqual(lines(0.12, 0.2), [100, 120, 140, 160, 180, 200, 220, 240]);
  assert.deepEqual(lines(0.216, 0.22, 1 / 0.0254), [8, 8.2, 8.4, 8.6, 8.8, 9, 9.2]);
  assert.deepEqual(scaleFor(0.216, none), scaleFor(0.216, { min: new Float32Array([0.216]), max: new Float32Array([0.216]) }));
});
