import assert from 'node:assert/strict';
import { test } from 'node:test';
import { momentAt } from '../src/replay.js';
import { showClock } from '../src/units.js';
import { coverage, Store } from '../src/tiles.js';

const POINTS = { time: [100, 110, 140], vertices: [50, 90, 400], bit_depth: [null, 12, 15.5] };

test('a moment shows what was certain then', () => {
  assert.deepEqual(momentAt(POINTS, 100), { vertices: 50, bitDepth: null });
  assert.deepEqual(momentAt(POINTS, 139.9), { vertices: 90, bitDepth: 12 });
  assert.deepEqual(momentAt(POINTS, 140), { vertices: 400, bitDepth: 15.5 });
  assert.deepEqual(momentAt(POINTS, 0), { vertices: 50, bitDepth: null });
});

test('a limited wall ends where it did, and its later vertices are not there', () => {
  for (const pitch of [0.5, -0.5]) {
    const store = new Store({
      session: 's', start_depth: 100, start_toolface: 0, vertices: 96, bit_diameter: 0.2, radius_unit: 1e-5, nearest_unit: 1e-4,
      levels: [{ sectors: 8, rows: 4, pitch }, { sectors: 8, rows: 1024, pitch: 16 * pitch, rings: true }], attributes: [],
    });
    for (const tile of [0, 1, 2]) {
      const texels = new Uint16Array(4 * 32).fill(10000);
      store.apply({ level: 0, tile, first: 0, total: 96, texels, columns: [] });
    }
    const [top, bottom] = [80, 120];
    assert.equal(coverage(store, top, bottom, true).length, 3);
    store.limit(41);
    assert.equal(store.end, 100 + (40 / 8) * pitch);
    const pieces = coverage(store, top, bottom, true);
    assert.deepEqual(pieces.map(({ tile }) => tile.index).sort(), [0, 1]);
    assert.equal(Math.max(...pieces.map((piece) => Math.abs((pitch > 0 ? piece.bottom : piece.top) - 100))), Math.abs(store.end - 100));
    assert.equal(store.vertex(40).k, 40);
    assert.equal(store.vertex(41), null);
    store.limit(Infinity);
    assert.equal(store.vertex(95).k, 95);
  }
});

test('a clock says the day and its distance from UTC', () => {
  const at = new Date(2026, 10, 21, 2, 14, 5);
  const east = -at.getTimezoneOffset();
  const [day, clock, zone] = showClock(at.getTime() / 1000).split(' ');
  assert.deepEqual([day, clock], ['2026-11-21', '02:14:05']);
  if (east) assert.equal(new Date(`${day}T${clock}${zone.replace('−', '-')}`).getTime(), at.getTime());
  else assert.equal(zone, 'UTC');
});
