import assert from 'node:assert/strict';
import { test } from 'node:test';
import { asTable, Picking } from '../src/picking.js';
import { fitPlane, planeDepth, wallPoint } from '../src/dips.js';
import { Path } from '../src/path.js';

const RAD = Math.PI / 180;
const near = (got, wanted, by, what = '') => assert.ok(Math.abs(got - wanted) <= by, `${what} ${got}, not ${wanted}`);

// A path of constant inclination and azimuth, or one that builds by `build` degrees a metre.
function path(inclination, azimuth, { build = 0, surveyed = true, count = 60 } = {}) {
  const made = new Path(1000, 0.5);
  const centre = new Float64Array(3 * count);
  const directions = new Float32Array(6 * count);
  const at = [0, 0, 0];
  for (let i = 0; i < count; i++) {
    const [I, A] = [(inclination + build * 0.5 * i) * RAD, azimuth * RAD];
    const tangent = [Math.sin(I) * Math.cos(A), Math.sin(I) * Math.sin(A), Math.cos(I)];
    if (i) tangent.forEach((t, c) => (at[c] += 0.5 * t));
    centre.set(at, 3 * i);
    directions.set([Math.cos(I) * Math.cos(A), Math.cos(I) * Math.sin(A), -Math.sin(I), -Math.sin(A), Math.cos(A), 0], 6 * i);
  }
  made.apply({ first: 0, count, total: count, centre, directions, surveyed });
  return made;
}

// Where a plane of this dip and azimuth through the hole's axis at a depth meets the wall, by bisection: a slow reference.
function bed(made, dip, azimuth, depth, toolfaces, radius = () => 0.11) {
  const normal = [Math.sin(dip * RAD) * Math.cos(azimuth * RAD), Math.sin(dip * RAD) * Math.sin(azimuth * RAD), -Math.cos(dip * RAD)];
  const origin = made.at(depth).centre;
  const above = (d, toolface) => {
    const point = wallPoint(made, { depth: d, toolface, radius: radius(toolface) });
    return point.reduce((sum, x, i) => sum + (x - origin[i]) * normal[i], 0);
  };
  return toolfaces.map((toolface) => {
    let [a, b] = [depth - 6, depth + 6];
    const sign = Math.sign(above(a, toolface));
    for (let i = 0; i < 60; i++) {
      const middle = (a + b) / 2;
      if (Math.sign(above(middle, toolface)) === sign) a = middle;
      else b = middle;
    }
    return { depth: (a + b) / 2, toolface, radius: radius(toolface) };
  });
}

test('in a vertical hole a sinusoid of height H dips by atan(H / D) to its deepest point', () => {
  const made = path(0, 0);
  const [R, height, deepest] = [0.15, 0.2, 130];
  const points = [0, 50, 170, 290].map((toolface) => ({ toolface, radius: R, depth: 1010 + (height / 2) * Math.cos((toolface - deepest) * RAD) }));
  const plane = fitPlane(made, points);
  near(plane.apparent, Math.atan(height / (2 * R)) / RAD, 1e-6);
  near(plane.dip, plane.apparent, 1e-4, 'vertical: true is apparent,');
  near(plane.azimuth, 130, 1e-4, 'toolface 0 is north here,');
  near(plane.deepest, 130, 1e-6);
  near(plane.depth, 1010, 1e-6);
  assert.ok(plane.misfit < 1e-9);
});

test('true dip is found from any hole, whatever its shape', () => {
  const oval = (toolface) => 0.11 + 0.02 * Math.cos(2 * (toolface - 30) * RAD);
  for (const [inclination, azimuth] of [[5, 10], [40, 200], [88, 300], [120, 45]]) {
    for (const [dip, towards] of [[12, 75], [35, 340], [60, 180]]) {
      const made = path(inclination, azimuth);
      const plane = fitPlane(made, bed(made, dip, towards, 1015, [10, 95, 140, 260, 310], oval));
      if (plane.apparent > 84) continue; // along the hole: its picks are metres apart
      near(plane.dip, dip, 0.01, `${inclination}/${azimuth} ${dip}/${towards}`);
      near(plane.azimuth, towards, 0.02, `${inclination}/${azimuth} ${dip}/${towards}`);
    }
  }
});

test('a hole that bends between the picks does not bend the bed', () => {
  const made = path(30, 60, { build: 2 });
  const plane = fitPlane(made, bed(made, 45, 250, 1012, [0, 90, 180, 270]));
  near(plane.dip, 45, 0.05);
  near(plane.azimuth, 250, 0.05);
});

test('the curve of a plane goes through its own picks', () => {
  const made = path(50, 120);
  const points = bed(made, 30, 20, 1014, [5, 80, 200, 310]);
  const plane = fitPlane(made, points);
  for (const { depth, toolface } of points) near(planeDepth(made, plane, toolface), depth, 1e-4);
});

test('points that say no plane give none, and no survey no true dip', () => {
  const made = path(20, 0);
  const point = (toolface, depth = 1010) => ({ depth, toolface, radius: 0.1 });
  assert.equal(fitPlane(made, [point(0), point(90)]), null);
  assert.equal(fitPlane(made, [point(40), point(41), point(42, 1010.1)]), null);
  assert.equal(fitPlane(made, [point(0), point(0, 1011), point(180)]), null, 'two sides only: it could turn about them');
  const blind = fitPlane(path(0, 0, { surveyed: false }), [point(0), point(120), point(240, 1010.1)]);
  assert.ok(Number.isNaN(blind.dip) && Number.isNaN(blind.azimuth) && blind.apparent > 10);
  assert.ok(Number.isNaN(fitPlane(path(0, 0), [point(0), point(120), point(240)]).azimuth), 'level beds lean nowhere');
});

test('picks in an address say which radius was measured and which is the bit’s', () => {
  globalThis.document = { getElementById: () => ({ addEventListener() {} }) };
  const picking = new Picking({});
  const text = '1009.300_10.0_108.0~1009.600_130.0_108.0_bit~1008.700_250.0_108.2';
  picking.fromAddress(`${text}!1_2_3~1_2_3~1_2_x!1_2_3~1_2_3~1_2_3_rig!1_2_3_bit_4~1_2_3~1_2_3!1_2_3~1_2_3!1__3~1_2_3~1_2_3`);
  assert.equal(picking.kept.length, 1, 'the rest is not taken');
  assert.deepEqual(picking.kept[0].map(({ measured }) => measured), [true, false, true]);
  assert.equal(picking.toAddress(), text);
  const table = asTable([{ depth: 1, dip: 2, azimuth: 3, apparent: 4, deepest: 5, misfit: 0, points: picking.kept[0] }]);
  assert.match(table, /,points,points_at_bit_size\r\n.*,3,1\r\n$/);
});

test('one dip too many is not kept and says so; its points stay, and so do the other dips', () => {
  globalThis.document = { getElementById: () => ({ addEventListener() {} }) };
  const shown = [];
  const picking = new Picking({ path: path(20, 0), resize() {}, notice: (text) => shown.push(text) });
  const bed = (depth) => [0, 120, 240].map((toolface) => ({ depth, toolface, radius: 0.1, measured: true }));
  const keep = (depth) => {
    picking.points = bed(depth);
    picking.keep();
  };
  for (let i = 0; i < 200; i++) keep(1000 + i / 10);
  assert.deepEqual(shown, []);
  const before = [...picking.kept];
  keep(1030);
  assert.deepEqual(picking.kept, before);
  assert.deepEqual(picking.points, bed(1030));
  const rule = 'There are 200 dips, as many as are kept: save them as a table and undo some first.';
  assert.deepEqual(shown, [`${rule} This one was not kept: 1030.00 m`]);
  picking.points = [];
  picking.undo();
  keep(1030);
  assert.deepEqual(picking.kept.at(-1), bed(1030));
  const address = picking.toAddress();
  picking.fromAddress(address);
  assert.equal(picking.kept.length, 200);
  assert.equal(shown.length, 1);
  picking.fromAddress(`${address}!${address}`);
  assert.equal(picking.kept.length, 200);
  assert.equal(shown[1], 'The address holds 400 dips: the first 200 are kept, the others are not.');
});
