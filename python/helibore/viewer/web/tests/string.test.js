// The string in the hole: what is said of its clearance, which may not be sure.

import assert from 'node:assert/strict';
import { test } from 'node:test';
import { clearanceText, doesNotPass, shortText } from '../src/string.js';

const SURE = { clearance: -0.004, low: -0.007, high: -0.001 };
const UNSURE = { clearance: -0.002, low: -0.011, high: 0.007 };
const UNKNOWN = { clearance: -0.002, low: NaN, high: NaN };

test('a body does not pass if its clearance is surely below 0, or has no known uncertainty', () => {
  assert.deepEqual([SURE, UNSURE, UNKNOWN, { clearance: 0.001, high: null }, {}].map(doesNotPass), [true, false, true, false, false]);
});

test('the words say no more than the interval', () => {
  assert.equal(clearanceText({ ...SURE, why: '' }, 'mm'), 'does not pass: −4.0 mm (−7.0 to −1.0 mm, 95\u00a0%)');
  assert.equal(clearanceText({ ...UNSURE, why: '' }, 'mm'), 'may not pass: −2.0 mm (−11.0 to +7.0 mm, 95\u00a0%)');
  assert.equal(clearanceText({ ...UNKNOWN, why: '' }, 'mm'), 'does not pass: −2.0 mm (uncertainty not known)');
  assert.deepEqual([SURE, UNSURE, { clearance: 0.002, low: -0.001, high: 0.005 }].map((of) => shortText(of, 'mm').split(',')[0]), ['sticks −4 mm', 'may stick −2 mm', 'clears +2 mm']);
});
