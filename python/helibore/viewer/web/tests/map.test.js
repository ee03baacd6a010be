// The map's rows, from an overview whose values are known: means, the largest enlargement, gaps that no mean hides.

import assert from 'node:assert/strict';
import { test } from 'node:test';
import { rowOf } from '../src/map_rows.js';
import { quantities } from '../src/color.js';
import { RADIUS, STATE, TEXEL } from '../src/protocol.js';
import { Store } from '../src/tiles.js';

const C = 8;

function store(turns, radius, support = () => 8) {
  const made = new Store({
    session: 's', attributes: [], radius_unit: 1e-5, nearest_unit: 1e-4, bit_diameter: 0.2, start_depth: 1000, start_toolface: 0, vertices: turns * 16 * 64,
    levels: [{ sectors: 64, rows: 256, pitch: 0.1 }, { sectors: C, rows: 1024, pitch: 1.6, rings: true }],
  });
  const count = turns * C;
  const texels = new Uint16Array(TEXEL * count);
  for (let k = 0; k < count; k++) {
    texels[TEXEL * k + RADIUS] = Math.round(radius(Math.floor(k / C), k % C) * 1e5);
    texels[TEXEL * k + STATE] = support(Math.floor(k / C), k % C);
  }
  made.apply({ level: 1, tile: 0, first: 0, total: count, texels, columns: [] });
  return made;
}

const over = (made) => quantities(made).find(({ id }) => id === 'over');

test('a row is the mean of its turns and the largest of their enlargements', () => {
  const made = store(100, (row, col) => 0.1 + (row === 42 ? 0.02 : 0) + 0.001 * col);
  const row = rowOf(made, over(made), 'latest', 40, 44);
  row.means.forEach((mean, c) => assert.ok(Math.abs(mean - (0.005 + 0.001 * c)) < 1e-6, `${c}: ${mean}`));
  assert.ok(Math.abs(row.most - 0.027) < 1e-6);
  assert.equal(row.lacks, false);
  assert.ok(rowOf(made, over(made), 'latest', 10, 10.2).means.every((mean, c) => Math.abs(mean - 0.001 * c) < 1e-6), 'finer than a turn');
});

test('a gap is in the row, however many turns are in it', () => {
  const made = store(100, (row, col) => (row === 30 && col === 3 ? 0 : 0.1));
  const row = rowOf(made, over(made), 'latest', 0, 90);
  assert.deepEqual(row.means.map(Number.isNaN), [false, false, false, true, false, false, false, false]);
  const doubtful = store(100, () => 0.1, (r, col) => (r === 30 && col === 3 ? 0 : 8));
  assert.equal(rowOf(doubtful, over(doubtful), 'latest', 0, 90).lacks, true);
  assert.equal(rowOf(doubtful, over(doubtful), 'latest', 40, 90).lacks, false);
});

test('beyond the wall there is nothing', () => {
  const made = store(100, () => 0.1);
  assert.deepEqual(rowOf(made, over(made), 'latest', 120, 125).means, Array(C).fill(undefined));
  assert.equal(rowOf(made, over(made), 'latest', 95, 100).lacks, false);
  made.limit(50 * 16 * 64);
  assert.deepEqual(rowOf(made, over(made), 'latest', 70, 72).means, Array(C).fill(undefined), 'while replaying too');
});
