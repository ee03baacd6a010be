import assert from 'node:assert/strict';
import { test } from 'node:test';
import { Helix } from '../src/helix.js';
import { coverage, Store } from '../src/tiles.js';
import { beyondEnds, quantities, takeRanges, valueAt, fitRange, percentile, dynamicRange, histogram, lookup, MAPS } from '../src/color.js';
import { measure, tileTurns, uncertainties } from '../src/turns.js';

const K = 8;
const ROWS = 4;

function store({ pitch = 0.5, size = 3 * K * ROWS + 5, attributes = [] } = {}) {
  return new Store({
    session: 's',
    start_depth: 100,
    start_toolface: 30,
    vertices: size,
    bit_diameter: 0.2,
    radius_unit: 1e-5,
    nearest_unit: 1e-4,
    levels: [
      { sectors: K, rows: ROWS, pitch },
      { sectors: K, rows: 1024, pitch: 16 * pitch, rings: true },
    ],
    attributes,
  });
}

// Fill a tile from a function of the vertex number: radius in 10 um steps.
function fill(made, tile, radius, level = 0, columns = []) {
  const { sectors, rows, size } = made.levels[level];
  const start = tile * sectors * rows;
  const count = Math.min(sectors * rows + sectors + 1, size - start);
  const texels = new Uint16Array(4 * count);
  for (let i = 0; i < count; i++) texels.set([radius(start + i), radius(start + i), 20, 8], 4 * i);
  made.apply({ level, tile, first: 0, total: size, texels, columns: columns.map((f, attribute) => ({ attribute, values: Float32Array.from({ length: count }, (_, i) => f(start + i)) })) });
}

test('the quad under a point is the quad that holds it', () => {
  for (const pitch of [0.1, -0.1]) {
    const helix = new Helix({ sectors: 64, pitch, startDepth: 1000, startToolface: 17 });
    for (let k = 0; k < 5000; k += 7) {
      const depth = helix.depth(k) + 0.4 * pitch + (0.5 * pitch) / 64;
      const toolface = helix.toolface(k) + 0.5 * (360 / 64);
      assert.equal(helix.quadAt(depth, toolface), k);
    }
  }
});

test('the vertex near a point is the nearest one, also across the seam, and needs the quad there', () => {
  for (const pitch of [0.1, -0.1]) {
    const helix = new Helix({ sectors: 64, pitch, startDepth: 1000, startToolface: 17 });
    for (let k = 0; k < 5000; k += 7) {
      for (const [along, across] of [[0, 0], [0.4, 0.4], [-0.4, 0.4], [0.4, -0.4], [-0.4, -0.4]]) {
        assert.equal(helix.vertexAt(helix.depth(k) + (along + across / 64) * pitch, helix.toolface(k) + (across * 360) / 64), k);
      }
    }
  }
  const made = store();
  fill(made, 0, (k) => (k === 5 + K ? 0 : 10000 + k));
  const wall = made.levels[0];
  /** @type {(k: number, along: number, across: number) => any} */
  const near = (k, along, across) => made.near(wall.depth(k) + (along + across / K) * wall.pitch, wall.toolface(k) + (across * 360) / K);
  assert.equal(near(2 + K, -0.4, 0.4).k, 2 + K);
  assert.equal(near(5, -0.1, 0.1), null, 'above the wall');
  assert.equal(near(5, 0.1, 0.1), null, 'the quad there touches the missing vertex');
  assert.equal(near(6, 0.1, 0.1).radius, 10006 * 1e-5);
});

test('a read-out is the wall’s own value, and needs all four corners', () => {
  const made = store();
  fill(made, 0, (k) => 10000 + k);
  assert.equal(made.quad(5).radius, 10005 * 1e-5);
  assert.equal(made.quad(5).depth, made.levels[0].depth(5));
  assert.equal(made.quad(40), null, 'its tile is not here');
  fill(made, 0, (k) => (k === 5 + K ? 0 : 10000 + k));
  for (const k of [5, 4, 5 + K, 4 + K]) assert.equal(made.quad(k), null, `quad ${k} touches the missing vertex`);
  assert.notEqual(made.quad(6), null);
});

test('a turn has its uncertainty from sigma, else from the levels of its vertices, and none where its tile is not here', () => {
  const made = store({ attributes: [{ name: 'GR' }, { name: 'sigma' }] });
  fill(made, 0, () => 10000, 0, [(k) => k, (k) => (k === 3 ? NaN : k / 1024)]);
  const wall = made.levels[0];
  assert.deepEqual([...uncertainties(made, wall, 1)], [1, 2, NaN, 4, 5, 6, 7, 8].map((k) => 1.96 * (k / 1024)));
  assert.ok(uncertainties(made, wall, K * ROWS).every(Number.isNaN), 'its tile is not here');
  const plain = store();
  fill(plain, 0, () => 10000);
  assert.ok(uncertainties(plain, plain.levels[0], 1).every(Number.isNaN), 'level 0: not known');
  plain.levels[0].tiles.get(0).texels.fill(4 << 12);
  assert.ok(uncertainties(plain, plain.levels[0], 1).every((half) => half === 0.001));
});

test('the last quads of a tile read the halo, not the next tile', () => {
  const made = store();
  fill(made, 0, (k) => 10000 + k);
  assert.notEqual(made.quad(K * ROWS - 1), null);
});

test('coverage has no hole and no overlap, and takes the overview where a tile is missing', () => {
  for (const pitch of [0.5, -0.5]) {
    const made = store({ pitch });
    made.levels[1].size = K * 2;
    fill(made, 0, () => 10000, 1);
    fill(made, 0, () => 10000);
    fill(made, 2, () => 10000);
    const [top, bottom] = made.span;
    const pieces = coverage(made, top, bottom, true).sort((a, b) => a.top - b.top);
    assert.equal(pieces[0].top, top);
    assert.equal(pieces.at(-1).bottom, bottom);
    for (let i = 1; i < pieces.length; i++) assert.ok(Math.abs(pieces[i].top - pieces[i - 1].bottom) < 1e-9);
    assert.ok(pieces.some(({ tile }) => tile.level === made.levels[1]));
    assert.ok(coverage(made, top, bottom, false).every(({ tile }) => tile.level === made.levels[1]));
  }
});

test('the least recently used tiles go first, wanted ones never', () => {
  const made = store();
  for (const t of [0, 1, 2]) fill(made, t, () => 10000);
  const [a, b, c] = [0, 1, 2].map((t) => made.levels[0].tiles.get(t));
  [b, c, a].forEach((tile) => made.touch(tile));
  assert.deepEqual(made.surplus(2 * made.tileBytes, new Set([1])).map((t) => t.index), [2]);
  assert.deepEqual(made.surplus(1e9, new Set()), []);
});

test('a turn is measured as a caliper would', () => {
  const ellipse = Float64Array.from({ length: 64 }, (_, j) => {
    const angle = (2 * Math.PI * j) / 64;
    return 1 / Math.hypot(Math.cos(angle) / 0.12, Math.sin(angle) / 0.1);
  });
  const found = measure(ellipse);
  assert.ok(Math.abs(found.max - 0.24) < 1e-12 && found.maxAt === 0);
  assert.ok(Math.abs(found.min - 0.2) < 1e-12);
  assert.ok(Math.abs(found.c1 - 0.24) < 1e-12 && Math.abs(found.c2 - 0.2) < 1e-12);
  assert.ok(Math.abs(found.area - Math.PI * 0.12 * 0.1) < 1e-9);
  ellipse[3] = NaN;
  assert.ok(Number.isNaN(measure(ellipse).area), 'a turn with a gap has no area');
  assert.equal(measure(ellipse).share, 63 / 64);
  assert.ok(Number.isNaN(measure(ellipse).c1) && Number.isNaN(measure(ellipse).c2) && measure(ellipse).max > 0.23);
});

test('turns of a tile follow its version', () => {
  const made = store();
  fill(made, 0, () => 10000);
  const tile = made.levels[0].tiles.get(0);
  assert.ok(Math.abs(tileTurns(made, tile).max[0] - 0.2) < 1e-6);
  fill(made, 0, () => 11000);
  assert.ok(Math.abs(tileTurns(made, tile).max[0] - 0.22) < 1e-6);
});

test('values, missing ones included', () => {
  const made = store({ attributes: [{ name: 'GR', unit: 'gAPI', low: null, high: null, log: false, color_map: 'gamma' }] });
  fill(made, 0, (k) => (k === 3 ? 0 : 10000 + k), 0, [(k) => (k === 4 ? NaN : k)]);
  const tile = made.levels[0].tiles.get(0);
  const find = (id) => quantities(made).find((q) => q.id === id);
  assert.ok(Math.abs(valueAt(made, find('over'), tile, 10) - 10e-5) < 1e-12);
  assert.ok(Number.isNaN(valueAt(made, find('over'), tile, 3)));
  assert.equal(valueAt(made, find('GR'), tile, 7), 7);
  assert.ok(Number.isNaN(valueAt(made, find('GR'), tile, 4)));
  assert.equal(find('GR').map, 'gamma');
  assert.equal(valueAt(made, find('nearest'), tile, 7), 20 * 1e-4);
});

test('what a wall differs by from earlier passes, or from its own first pass, is called a change', () => {
  const names = (attributes) => quantities(store({ attributes })).map(({ name }) => name).filter((name) => /change/i.test(name));
  assert.deepEqual(names([]), ['Change since first pass']);
  assert.deepEqual(names([{ name: 'difference', unit: 'm', log: false, color_map: 'difference' }]), ['Change since earlier passes']);
});

test('the ends of the colours are the server’s, until a user or an address chooses others', () => {
  const made = quantities(store({ attributes: [{ name: 'GR', unit: 'gAPI', log: false, color_map: 'gamma' }] }));
  const find = (id) => made.find((q) => q.id === id);
  Object.assign(find('radius'), { low: 1, high: 2, chosen: true });
  takeRanges(made, { over: [-0.03, 0.03], radius: [5, 6] });
  assert.deepEqual([find('over').low, find('over').high, find('radius').low], [-0.03, 0.03, 1]);
  takeRanges(made, { over: [-0.1, 0.1], GR: [20, 140] });
  assert.deepEqual([find('over').low, find('GR').high, find('radius').high], [-0.1, 140, 2]);
});

test('a gauge hole offers its attributes only', () => {
  const attributes = [{ name: 'GR', unit: 'gAPI', log: false, color_map: 'gamma' }];
  const gauge = store({ attributes });
  gauge.basis = 'gauge';
  assert.deepEqual(quantities(gauge).map(({ id }) => id), ['GR']);
});

test('a cell of a ring needs its own vertex, and its row is level', () => {
  const made = store();
  made.levels[1].size = 2 * K;
  fill(made, 0, (k) => (k === 3 ? 0 : 10000 + k), 1);
  const over = made.levels[1];
  assert.deepEqual([0, K - 1, K].map((k) => over.depth(k)), [100, 100, 108]);
  for (const toolface of [31, 200, 29]) assert.equal(Math.floor(over.quadAt(107.9, toolface) / K), 0);
  assert.equal(made.quad(3, over), null);
  assert.notEqual(made.quad(2 * K - 1, over), null);
});

test('a range is never empty and a difference is centred', () => {
  const over = { mode: 1, length: true, low: 0, high: 1 };
  const same = fitRange(over, Float64Array.from([0.1, 0.1]));
  assert.ok(same.high > same.low);
  const change = fitRange({ mode: 4, length: true }, Float64Array.from([-0.001, 0, 0.004]));
  assert.equal(change.low, -change.high);
  assert.equal(percentile(Float64Array.from([1, 2, 3]), 0.5), 2);
  assert.deepEqual([...histogram([1, 2, 2, 9], 0, 10, false, 10)], [0, 1, 2, 0, 0, 0, 0, 0, 0, 1]);
});

test('the dynamic range follows the layers, across tiles', () => {
  const made = store();
  const layered = (k) => (k < K * ROWS ? 10000 : 12000) + (k % 2) * 10;
  for (const t of [0, 1]) fill(made, t, layered);
  const radius = quantities(made).find((q) => q.id === 'radius');
  const range = dynamicRange(made, radius, made.levels[0].tiles.get(0), 'latest');
  assert.ok(range[0] > 0.0995 && range[1] < 0.1005, 'far from the seam: the first layer alone');
  assert.ok(range[2 * (ROWS - 1) + 1] > 0.115, 'beside it: both');
});

test('values beyond the ends of the colours are found wherever one is in view, and none is claimed', () => {
  const made = store({ pitch: -0.5 }); // tile 1 reaches from 98 to 96 m
  for (const tile of [0, 1, 2]) fill(made, tile, (k) => (k === K * ROWS + 2 * K + 3 ? 11500 : k === 5 ? 0 : 10000));
  const over = { ...quantities(made)[0], low: -0.01, high: 0.01 };
  const at = (top, bottom, quantity = over) => beyondEnds({ store: made, view: { top, bottom, pass: 'latest' }, imagePieces: coverage(made, top, bottom, true) }, quantity);
  assert.deepEqual(at(95, 100), [false, true], 'one vertex of 96');
  assert.deepEqual(at(97.6, 100), [false, false], 'its turn is not in view');
  assert.deepEqual(at(95, 100, { ...over, low: 0.001, high: 0.015 }), [true, false], 'an end itself is not beyond');
  assert.deepEqual(at(95, 100, { ...over, id: 'radius', mode: 0, low: 0.05, high: 0.11, log: true }), [false, true]);
  fill(made, 1, () => 10000);
  assert.deepEqual(at(95, 100), [false, false], 'follows the tile');
});

test('no colour map holds the grey of missing values', () => {
  for (const name of Object.keys(MAPS)) {
    const table = lookup(name);
    if (/cividis|difference|over-bit/.test(name)) continue; // these pass a grey; hatching shows what is missing
    for (let i = 0; i < 256; i++) {
      const [r, g, b] = table.subarray(4 * i, 4 * i + 3);
      assert.ok(Math.max(r, g, b) - Math.min(r, g, b) > 6, `${name} ${i}`);
    }
  }
});

test('the turn at any depth is one that logs and report count: it holds the depth and begins where a turn begins', () => {
  for (const pitch of [0.1, -0.1]) {
    const helix = new Helix({ sectors: 64, pitch, startDepth: 1000, startToolface: 17 });
    for (const turns of [0.01, 0.4, 0.6, 7.99, 8.01]) {
      const k = helix.turnAt(1000 + turns * pitch);
      assert.deepEqual([k % 64, k / 64], [0, Math.floor(turns)]);
    }
  }
});
