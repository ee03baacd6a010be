import test from 'node:test';
import assert from 'node:assert/strict';
import { scaleFor } from '../src/caliper.js';

test('the lines of the caliper track are round, and cover what the colours cover and what lasts in view', () => {
  /** @param {number[]} min @param {number[]} c2 @returns {Profile} */
  const profile = (min, c2) => ({ min: new Float32Array(min), max: new Float32Array(c2), c2: new Float32Array(c2), seen: new Uint8Array(c2.length), between: new Uint8Array(c2.length), rows: 2 });
  const none = profile([NaN], [NaN]);
  const colours = { low: -0.02, high: 0.02 };
  /** @param {number} min @param {number} max @param {number} [per] @param {{ low: number, high: number }} [of] */
  const lines = (min, max, per = 1000, of = colours) => scaleFor(0.216, profile([0.216, min, min], [0.216, max, max, NaN]), of, per).map((one) => Number((one * per).toFixed(6)));
  assert.deepEqual(lines(0.215, 0.217), [160, 180, 200, 220, 240, 260]);
  assert.deepEqual(lines(0.21, 0.297), [150, 200, 250, 300]);
  assert.deepEqual(lines(0.12, 0.2), [100, 150, 200, 250, 300]);
  assert.deepEqual(lines(0.216, 0.22, 1 / 0.0254, { low: -0.004, high: 0.004 }), [8, 8.2, 8.4, 8.6, 8.8, 9]);
  assert.deepEqual(scaleFor(0.216, none, colours), scaleFor(0.216, profile([0.216], [0.216]), colours));
  assert.deepEqual(scaleFor(0.216, profile([0.216, 0.1, 0.216], [0.216, 0.4, 0.216]), colours), scaleFor(0.216, none, colours), 'no single row');
});
