import test from 'node:test';
import assert from 'node:assert/strict';
import { sectionText } from '../src/panel.js';

/** @type {Summary} */
const SUMMARY = {
  start: 2000, stop: 2010, volume: 0.41234, excess: 0.1372, coverage: 0.9, whole_turns: 10, incomplete_turns: 0, washed_out: 0, without_radius: 0, mean_diameter: 0.22, least_diameter: 0.21,
  greatest_diameter: 0.24, unmeasured_shape: false,
};
const store = /** @type {Store} */ (/** @type {unknown} */ ({ basis: 'azimuthal' }));
/** @param {Partial<Summary>} summary @param {Zone[]} [zones] @param {number} [bottom] */
const figures = (summary, zones = [], bottom = 2012) => Object.fromEntries(sectionText(store, { ...SUMMARY, ...summary }, 'mm', zones, bottom));

test('amounts of a wall that is mostly interpolated have two digits and say that their uncertainty is not known', () => {
  assert.deepEqual([figures({}).Volume, figures({})['Against the bit']], ['0.412 m³ over 10.0 m of whole turns', '+13.7 %']);
  const unsure = figures({ unmeasured_shape: true });
  assert.deepEqual([unsure.Volume, unsure['Against the bit']], ['about 0.41 m³ over 10.0 m, uncertainty not known', 'about 14 %']);
});

test('a washout that the figures do not reach yet is not counted as none', () => {
  /** @param {number} start @param {number} stop @returns {Zone} */
  const washout = (start, stop) => ({ kind: 'washout', start, stop, measure: 0.02, severity: 1.5 });
  assert.equal(figures({}, [washout(2009, 2011)])['Washed out'], '…');
  assert.equal(figures({}, [washout(2013, 2014)])['Washed out'], '0.0 m of 10.0 m, 0.0 %', 'below the section');
  assert.equal(figures({}, [washout(1990, 1995)])['Washed out'], '0.0 m of 10.0 m, 0.0 %', 'above it');
  assert.equal(figures({}, [washout(2009, 2011)], 2010)['Washed out'], '0.0 m of 10.0 m, 0.0 %', 'the rest of it is not in view');
});
