import assert from 'node:assert/strict';
import { test } from 'node:test';
import { setImmediate } from 'node:timers';
import { drawDips, drawLegend, tadpoles } from '../src/dip_ink.js';
import { anglesInWords, anglesOf, axisOf, fitPlane, levelPlane, planeDepth, planeOf, wallPoint } from '../src/dips.js';
import { bindKeys, bindTracks } from '../src/input.js';
import { pole, rose } from '../src/net.js';
import { Picking } from '../src/picking.js';
import { discOf, topInWords, topPlanes, topsOf, traceOf } from '../src/plane_rings.js';
import { openingOf } from '../src/opening.js';
import { inWords } from '../src/pick_card.js';
import { fromPlan, offPlan } from '../src/planned.js';
import { intervalsOf, marksOf, surenessOf } from '../src/sureness.js';
import { readout } from '../src/panel.js';
import { Path } from '../src/path.js';
import { compass } from '../src/wall_ink.js';

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

test('a kept pick is the plane that was fitted', () => {
  const made = path(35, 80);
  const fitted = fitPlane(made, bed(made, 25, 310, 1013, [10, 95, 140, 260, 310]));
  const pick = { kind: 'bed', depth: fitted.depth, apparent_dip: fitted.apparent, toolface: fitted.deepest, radius: fitted.radius };
  const plane = planeOf(made, pick, 0.2);
  near(plane.dip, 25, 0.02);
  near(plane.azimuth, 310, 0.02);
  for (const toolface of [0, 77, 200]) near(planeDepth(made, plane, toolface), planeDepth(made, fitted, toolface), 1e-4);
  near(planeOf(made, { ...pick, radius: null }, 0.2).radius, 0.2, 0, 'bit size where none was measured,');
});

for (const [inclination, azimuth] of [[0.5, 30], [60, 70], [88, 250]]) {
  test(`the disc of a plane has its true dip and azimuth however wide a hole of ${inclination} degrees is drawn`, () => {
    const made = path(inclination, azimuth);
    for (const [deepest, apparent] of [[0, 5], [130, 34], [250, 78]]) {
      const plane = planeOf(made, { kind: 'bed', depth: 1010, apparent_dip: apparent, toolface: deepest }, 0.1);
      for (const tube of [1, 20, 500]) {
        const edge = discOf(plane, 0.1 * tube).map((one) => one.edge);
        const [from, ...on] = [0, 20, 50].map((i) => edge[i]);
        const [u, v] = on.map((point) => point.map((x, i) => x - from[i]));
        const normal = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]].map((x, _, all) => (all[2] > 0 ? -x : x));
        near(Math.atan2(Math.hypot(normal[0], normal[1]), -normal[2]) / RAD, plane.dip, 1e-6, `dip at tube x ${tube}:`);
        near((Math.atan2(normal[1], normal[0]) / RAD + 360) % 360, plane.azimuth, 1e-6, `azimuth at tube x ${tube}:`);
        const sides = edge.slice(1).map((point, i) => Math.hypot(...point.map((x, j) => x - edge[i][j])));
        near(Math.max(...sides) / Math.min(...sides), 1, 1e-6, 'its edge is round however steep it is:');
        const far = edge.map((point) => Math.hypot(...point.map((x, i) => x - plane.frame.centre[i])) / (0.1 * tube));
        for (const one of far) near(one, 2.6, 1e-5, 'all discs are alike, as large as the hole is drawn');
      }
    }
  });
}

test('the angles of a plane are two numbers, and a legend says what they are and from which north', () => {
  const made = path(0, 0);
  const plane = { dip: 34.4, azimuth: 44.6, apparent: 12, deepest: 359.7 };
  assert.deepEqual([anglesOf(plane, made), anglesOf({ ...plane, azimuth: NaN }, made), anglesOf(plane, path(0, 0, { surveyed: false }))], ['34 / 045', '34 / –', '12 / 000']);
  made.north = 'grid';
  assert.deepEqual([anglesInWords(made), anglesInWords(path(0, 0)), anglesInWords(path(0, 0, { surveyed: false }))], ['dip / azimuth from grid north', 'dip / azimuth, north not stated', 'apparent dip / toolface of the deepest point']);
});

test('a top is the nearest bed within 0.2 m of it, and no fracture', () => {
  const kept = [1009.9, 1010.15, 1014].map((depth) => ({ depth, kind: 'bed' }));
  const intervals = [['A', 1010.1, 1013], ['B', 1013.7, null]];
  assert.deepEqual([...topsOf({ intervals }, { kept })], [[kept[1], 'A']]);
  kept.push({ depth: 1010.1, kind: 'fracture' }, { depth: 1013.7, kind: 'fault' });
  assert.deepEqual([...topsOf({ intervals }, { kept })], [[kept[1], 'A']]);
});

for (const tube of [1, 10, 200]) {
  test(`a disc meets a hole that is drawn ${tube} times too wide at the trace that the wall shows`, () => {
    const made = path(40, 63);
    const plane = planeOf(made, { kind: 'fracture', depth: 1010, apparent_dip: 62, toolface: 130, radius: 0.13 }, 0.1);
    const { centre, tangent } = made.at(1010);
    for (const [i, line] of traceOf(plane, 0.1 * tube).entries()) {
      const from = line.map((x, j) => x - centre[j]);
      const along = from.reduce((sum, x, j) => sum + x * tangent[j], 0);
      near(1010 + along, planeDepth(made, plane, 5 * i), 1e-4, 'depth of the trace');
      near(Math.hypot(...from.map((x, j) => x - along * tangent[j])), 0.1 * tube, 1e-8 * tube, 'on the wall that is drawn');
    }
    for (const { edge, wide } of discOf(plane, 0.1 * tube)) {
      const out = edge.map((x, j) => x - centre[j]);
      const up = out.reduce((sum, x, j) => sum + x * tangent[j], 0);
      assert.equal(wide, Math.hypot(...out.map((x, j) => x - up * tangent[j])) > 0.1 * tube, 'the edge is outside the hole');
    }
  });
}

test('a top without a picked bed is a level plane without a dip, and none where the hole is nearly level', () => {
  for (const inclination of [0.3, 35, 78]) {
    const made = path(inclination, 63);
    const level = levelPlane(made, 1010, 0.1);
    near(level.dip, 0, 1e-3, `at ${inclination} degrees,`);
    near(level.apparent, inclination, 1e-3);
    for (const { edge } of discOf(level, 1)) near(edge[2], made.at(1010).centre[2], 1e-6, 'all of its edge at one depth:');
  }
  assert.equal(levelPlane(path(81, 63), 1010, 0.1), null);
  const made = path(35, 63);
  const bedAt = (depth) => planeOf(made, { kind: 'bed', depth, apparent_dip: 40, toolface: 20 }, 0.1);
  const tops = topPlanes({ intervals: [['A', 1005, 1010], ['B', 1010, null]], path: made, store: { bitRadius: 0.1 } }, [bedAt(1005.1)]);
  assert.deepEqual(tops.map((top) => topInWords(top, made)), [`A   ${anglesOf(bedAt(1005.1), made)}`, 'B']);
  assert.equal(tops[0].plane, tops[0].picked);
  assert.equal(tops[1].picked, undefined);
});

test('a point in a groove has the radius of the wall beside the groove, and one in a washout that of the washout', () => {
  const { made } = picking();
  const radius = (depth) => (Math.abs(depth - 1010) < 0.08 ? 0.12 : depth > 1015 ? 0.15 : 0.1);
  const [K, pitch] = [4, 0.01];
  const vertex = (k) => (k < 0 ? null : { k, radius: radius(1000 + (k / K) * pitch) });
  Object.assign(made.app.store, { near: (depth) => vertex(Math.round((depth - 1000) / pitch) * K), vertex, levels: [{ sectors: K, pitch }] });
  assert.deepEqual([1010, 1010.05, 1008, 1000, 1017].map((depth) => made.point({ depth, toolface: 0 }).radius), [0.1, 0.1, 0.1, 0.1, 0.15]);
  made.app.store.levels[0].pitch = 1;
  assert.equal(made.point({ depth: 1010, toolface: 0 }).radius, 0.12, 'turns farther apart than the groove is wide: that of the place');
});

test('a tadpole of any dip and azimuth is whole in its track, whose title says which dip it is', () => {
  const rect = { left: 100, top: 80, width: 84, height: 400 };
  const [xs, texts] = [[], []];
  const ink = new Proxy({ canvas: { labels: [], strokes: [] }, measureText: (text) => ({ actualBoundingBoxLeft: 6, actualBoundingBoxRight: 7 * text.length - 6, actualBoundingBoxAscent: 4, actualBoundingBoxDescent: 4 }) }, {
    get: (of, name) => of[name] ?? { lineTo: (x) => xs.push(x), moveTo: (x) => xs.push(x), fillText: (text) => texts.push(text) }[name] ?? (() => {}),
    set: () => true,
  });
  const draw = (surveyed) => {
    const made = path(0, 0, { surveyed });
    const kept = [0, 89.9].flatMap((dip) => [0, 90, 180, 270].map((toolface) => planeOf(made, { kind: 'bed', depth: 1010, apparent_dip: dip, toolface }, 0.1)));
    const look = { view: { theme: 'light', top: 1000, bottom: 1020, middle: 1010, length: 20 }, path: made, images: [], rects: { dips: rect, image: { left: 0, width: 0, top: 80, height: 400 } } };
    const planes = { kept, boxes: [], current: null, selected: null, open: false };
    drawDips(ink, look, planes, false);
    const before = xs.length;
    tadpoles(ink, look, rect, planes);
    assert.ok(xs.length > before + 8 * 4, 'heads and tails');
  };
  draw(false);
  assert.ok(Math.min(...xs) >= 100 && Math.max(...xs) <= 184, `${Math.min(...xs)} to ${Math.max(...xs)}`);
  assert.deepEqual(texts, ['Apparent', 'dip [°]', '0', '30', '60', '90']);
  draw(true);
  assert.equal(texts[6], 'True');
});

test('below the tracks stands how to begin, as far as there is room, until something is picked', () => {
  const said = (width, kept = [], surveyed = true) => {
    const texts = [];
    const ink = new Proxy({ canvas: { labels: [], strokes: [] }, measureText: (text) => ({ width: 7 * text.length }), fillText: (text) => texts.push(text) }, { get: (of, name) => of[name] ?? (() => {}), set: () => true });
    drawLegend(ink, { view: { theme: 'light', top: 0, bottom: 1 }, path: Object.assign(path(20, 0, { surveyed }), { north: 'true' }), rects: { axis: { left: 60, top: 80, height: 400 }, image: { width: 40 }, pane: { left: 60 + width } } }, { kept, boxes: [] }, ['a long text', 'short']);
    return texts;
  };
  assert.deepEqual([said(100), said(60), said(30), said(100, [{ depth: 5, kind: 'bed' }])], [['a long text'], ['short'], [], []]);
  const kept = [{ depth: 0.5, kind: 'bed' }];
  assert.deepEqual([said(400, kept), said(100, kept), said(500, kept, false)], [['bed', 'dip / azimuth from true north'], ['bed'], ['bed', 'apparent dip / toolface of the deepest point']]);
});

test('the angles of a plane stand at the right end of its curve, where it is in view', () => {
  const texts = [];
  const ink = new Proxy({ canvas: { labels: [], strokes: [] }, measureText: () => ({ width: 40, actualBoundingBoxLeft: 40, actualBoundingBoxRight: 0, actualBoundingBoxAscent: 4, actualBoundingBoxDescent: 4 }), fillText: (text, x, y) => texts.push([text, x, Math.round(y)]) }, { get: (of, name) => of[name] ?? (() => {}), set: () => true });
  const made = path(20, 45, { surveyed: true });
  const kept = [1003, 1012].map((depth) => planeOf(made, { kind: 'bed', depth, apparent_dip: 45, toolface: 180 }, 0.1));
  const image = { left: 100, top: 80, width: 200, height: 400 };
  const look = { view: { theme: 'light', cut: 'top', top: 1000, bottom: 1010, middle: 1005, length: 10 }, path: made, rects: { image }, wallRect: image };
  drawDips(ink, { ...look, images: [look] }, { kept, boxes: [], current: null, selected: null, open: false }, false);
  assert.deepEqual(texts, [[anglesOf(kept[0], made), 296, 80 + 40 * 2.9 - 9]]); // a tenth of a metre above its middle
});

function picking(more = {}) {
  globalThis.more = { inWords, marksOf, openingOf, surenessOf };
  globalThis.document = { getElementById: () => ({ addEventListener() {}, replaceChildren() {}, classList: { toggle() {} } }) };
  globalThis.Option = class {};
  const sent = [];
  const app = { path: path(20, 0), store: { span: [1000, 1030], attributes: [], bitRadius: 0.1, near: () => ({ k: 0, radius: 0.1 }), vertex: () => ({ radius: 0.1 }), levels: [{ sectors: 4, pitch: 0.1, quadAt: () => 0 }] }, contents: {}, redraw() {}, repaint() {}, openSaved() {}, renderer: { rects: { image: { width: 360, height: 600 } } }, view: { units: 'mm', length: 6, set() {} }, notice: (text) => sent.push(text), ...more };
  return { made: new Picking(app), sent };
}

// Draw a plane of 45 degrees of apparent dip along its trace, between two toolfaces; `off` moves a point off the trace.
function trace(made, depth, deepest, [from, to] = [deepest - 180, deepest], { image, off = () => 0 } = {}) {
  const at = (toolface) => ({ depth: depth + 0.1 * Math.cos((toolface - deepest) * RAD) + off(toolface), toolface: (toolface + 720) % 360, image });
  const drag = made.grab(at(from), 0.02);
  for (let i = 1; i <= 12; i++) made.drag(drag, at(from + ((to - from) * i) / 12));
  made.drop();
}

test('a drag of the crest changes dip and azimuth, elsewhere the depth', () => {
  const { made } = picking();
  made.receive([{ key: 'a', kind: 'bed', depth: 1010, toolface: 90, apparent_dip: 45, radius: 0.1 }]);
  made.selected = 'a';
  const crest = made.grab({ depth: 1010.1, toolface: 92 }, 0.02);
  made.drag(crest, { depth: 1010.2, toolface: 100 });
  made.drop();
  near(made.pick.apparent_dip, Math.atan(2) / RAD, 1e-9);
  assert.deepEqual([made.pick.toolface, made.pick.depth], [98, 1010]);
  const body = made.grab({ depth: 1010, toolface: 10 }, 0.02);
  assert.equal(body.act, 'move');
  made.drag(body, { depth: 1010.5, toolface: 30 });
  made.drop();
  assert.deepEqual([made.pick.toolface, made.pick.depth, made.pick.points], [98, 1010.5, 0]);
  assert.equal(made.grab({ depth: 1009, toolface: 10 }, 0.02).act, 'sine', 'beside the curve another one begins');
});

test('a pick names the image that it was drawn on, has no radius in a gauge hole, and says where nothing was measured', () => {
  const { made, sent } = picking();
  const store = { ...made.app.store, basis: 'gauge', attributes: [{ name: 'GR' }, { name: 'RHOB' }], attributeAt: (i, { depth }) => (i === 1 || depth < 1020 ? 7 : NaN) };
  Object.assign(made.app, { store });
  trace(made, 1010.1, 210, undefined, { image: 'GR' });
  assert.deepEqual([made.kept[0].image, made.kept[0].radius, sent.splice(0)], ['GR', null, ['bed at 1010.10 m: true dip 62.9° ± 5 toward 203° ± 12   (apparent 45.0°). Ctrl Z takes it back.']]);
  trace(made, 1025.1, 210, undefined, { image: 'GR' });
  assert.deepEqual(sent, ['GR: nothing was measured where this was picked, 1025.10 m']);
});

test('a mouse and a finger move the selected pick and no other: on another, they draw the next one', () => {
  const { made } = picking();
  made.receive([BED]);
  const on = { depth: 1010.1, toolface: 92 };
  assert.equal(made.grab(on, 0.5, 0, true).act, 'sine');
  assert.equal(made.grab(on, 0.5).act, 'sine');
  made.click(on, 0.5);
  assert.equal(made.grab(on, 0.5, 0, true).act, 'dip');
});

test('a plane is fitted to the trace of a drag, wherever on it the drag begins, and keeps its misfit', () => {
  for (const [from, to] of [[30, 210], [120, 300], [75, 175], [350, 200], [0, 355]]) {
    const { made } = picking();
    trace(made, 1010.1, 210, [from, to]);
    const [{ depth, toolface, apparent_dip: dip, misfit, points }] = made.kept;
    near(depth, 1010.1, 1e-6);
    near(toolface, 210, 1e-3);
    near(dip, 45, 1e-3);
    near(misfit, 0, 1e-6);
    assert.equal(points, 13);
  }
  const { made } = picking();
  trace(made, 1010.1, 210, [30, 100]);
  assert.equal(made.kept.length, 0, 'less than a quarter turn says no plane');
  trace(made, 1010.1, 210, [30, 390], { off: (toolface) => 0.003 * Math.cos(5 * toolface * RAD) });
  near(made.kept[0].misfit, 0.003 / Math.SQRT2, 3e-4);
  const again = made.grab({ depth: 1020, toolface: 0 }, 0.02);
  for (const shift of [0.05, 0]) for (let turn = 3; turn <= 180; turn += 3) made.drag(again, { depth: 1020.1 - 0.1 * Math.cos(turn * RAD) + shift, toolface: turn });
  made.drop();
  near(made.kept[1].misfit, 0, 1e-6, 'what is drawn again counts once');
});

test('the angles of a named pick begin with its name', () => {
  const plane = { dip: 68.2, azimuth: 205.6, pick: { note: 'F1 open' } };
  assert.equal(anglesOf(plane, { surveyed: true }), 'F1 open 68 / 206');
  assert.equal(anglesOf({ ...plane, pick: { note: '' } }, { surveyed: true }), '68 / 206');
});

test('a digit classes the pick just made and the next one, and an arrow key moves it', () => {
  const { made } = picking();
  trace(made, 1010.1, 210);
  const [first] = made.kept;
  near(first.depth, 1010.1, 1e-6);
  assert.equal(made.pick, first, 'a new pick is selected');
  made.setClass('fracture');
  assert.deepEqual([made.kept[0].kind, made.kind], ['fracture', 'fracture']);
  const row = Math.abs(made.app.store.levels[0].pitch);
  assert.ok(made.nudge(2, 0) && made.nudge(0, -211));
  near(made.pick.depth, first.depth + 2 * row, 1e-9);
  near(made.pick.toolface, 359, 1e-6);
  made.undo();
  made.undo();
  made.setClass('bed');
  trace(made, 1014, 200);
  made.setClass('fracture');
  assert.deepEqual(made.kept.map(({ kind }) => kind), ['bed', 'fracture'], 'the last one');
  made.click({ depth: made.kept[0].depth - 0.1, toolface: 30 }, 0.02);
  assert.equal(made.pick.key, first.key);
  made.setClass('fault');
  assert.deepEqual([made.kept.map(({ kind }) => kind), made.kind], [['fault', 'fracture'], 'fault']);
  made.remove();
  assert.equal(made.kept.length, 1);
  for (const kinds of [['fracture', 'fault'], ['fracture', 'bed'], ['bed', 'bed'], ['bed'], ['fracture'], ['bed'], []]) {
    made.undo();
    assert.deepEqual(made.kept.map(({ kind }) => kind).sort().reverse(), kinds);
  }
});

test('redo makes again what undo took back, in order; a new change ends it', () => {
  const { made } = picking();
  const kinds = () => made.kept.map(({ kind }) => kind);
  trace(made, 1010.1, 210);
  const [drawn] = made.kept;
  made.selected = drawn.key;
  made.setClass('fault');
  made.remove();
  for (let i = 0; i < 4; i++) made.undo();
  assert.equal(made.kept.length, 0);
  made.redo();
  assert.deepEqual(made.kept, [drawn]);
  made.redo();
  assert.deepEqual(kinds(), ['fault']);
  made.undo();
  assert.deepEqual(kinds(), ['bed']);
  made.redo();
  made.redo();
  assert.equal(made.kept.length, 0);
  made.redo();
  made.undo();
  assert.equal(made.kept.length, 1, 'nothing was left to redo');
  made.selected = drawn.key;
  made.setClass('fracture');
  made.redo();
  assert.deepEqual(kinds(), ['fracture']);
});

test('a plane cannot become a breakout, nor a breakout a plane: the class is that of the next pick', () => {
  const { made, sent } = picking();
  const box = { key: 'b', kind: 'breakout', depth: 1015, toolface: 0, height: 1, opening: 30 };
  made.receive([{ ...BED, kind: 'fault' }, box]);
  Object.assign(made, { selected: 'a', kind: 'fault' });
  made.setClass('breakout');
  assert.deepEqual([made.pick, made.kind], [null, 'breakout']);
  Object.assign(made, { selected: 'b', kind: 'breakout' });
  made.setClass('bed');
  assert.deepEqual([made.pick, made.kind], [null, 'bed']);
  assert.deepEqual([made.kept.map(({ kind }) => kind), sent], [['fault', 'breakout'], []]);
});

test('the wheel moves the log, and the cursor is at the depth that is then under the mouse, unless it is held', () => {
  const listeners = {};
  const canvas = { addEventListener: (name, listener) => (listeners[name] = listener), getBoundingClientRect: () => ({ left: 0, top: 0 }), style: {} };
  globalThis.document = { getElementById: () => canvas };
  const track = (left, width) => ({ left, top: 80, width, height: 400 });
  const view = { top: 1000, length: 20, cut: 'top', pinned: false, curtain: null, cursor: null, get bottom() { return this.top + this.length; }, show(top) { this.top = top; }, point(cursor) { this.cursor = cursor; } };
  bindTracks({ view, store: {}, path: path(20, 0), renderer: { rects: { map: track(4, 50), axis: track(60, 60), image: track(130, 200), pane: track(340, 100), wall: track(340, 100) } }, picking: { on: false } });
  const wheel = () => listeners.wheel({ currentTarget: canvas, clientX: 230, clientY: 280, deltaY: 100, deltaMode: 0, preventDefault() {} });
  wheel();
  assert.deepEqual([view.top, view.cursor.depth], [1002, 1012]);
  view.pinned = true;
  wheel();
  assert.deepEqual([view.top, view.cursor.depth], [1004, 1012]);
});

test('Esc deselects the pick or drops its points, the next one leaves picking and says so', () => {
  const { made, sent } = picking();
  const left = [];
  made.on = true;
  made.toggle = (on) => left.push(on);
  made.receive([{ key: 'a', kind: 'bed', depth: 1010, toolface: 90, apparent_dip: 45, radius: 0.1 }]);
  made.selected = 'a';
  made.leave();
  assert.deepEqual([made.pick, left], [null, []]);
  made.click({ depth: 1015, toolface: 20 }, 0.02);
  made.leave();
  assert.deepEqual([made.points, left, sent], [[], [], []]);
  made.leave();
  assert.deepEqual([left, sent], [[false], ['Picking ended: D picks again, digits choose the colours']]);
});

test('Ctrl Z takes back, Ctrl Shift Z and Ctrl Y make again, while picking and not in a field', () => {
  const done = [];
  let press;
  globalThis.document = { getElementById: () => ({ open: false }) };
  globalThis.window = { addEventListener: (_, listener) => (press = listener) };
  const app = { store: {}, picking: { on: true, undo: () => done.push('undo'), redo: () => done.push('redo') } };
  bindKeys(app);
  const type = (key, more = {}) => press({ key, ctrlKey: true, target: { tagName: 'CANVAS' }, preventDefault: () => done.push(key), ...more });
  type('z');
  type('Z', { shiftKey: true });
  type('y');
  type('z', { ctrlKey: false, metaKey: true });
  type('c');
  type('z', { target: { tagName: 'INPUT' } });
  app.picking.on = false;
  type('y');
  assert.deepEqual(done, ['z', 'undo', 'Z', 'redo', 'y', 'redo', 'z', 'undo']);
});

// A page whose server answers with these statuses, in turn; the last one stays.
function served(statuses, words = '') {
  const asked = [];
  const view = picking({ contents: null, status: 'live' });
  globalThis.location = { search: '' };
  globalThis.fetch = async (address, { method }) => {
    asked.push(`${method} ${address}`);
    const status = statuses.length > 1 ? statuses.shift() : statuses[0];
    if (!status) throw new Error('Failed to fetch');
    return { status, text: async () => words };
  };
  view.made.begin({ well: 'A', picks_file: 'a.picks.csv' });
  return { ...view, asked, statuses };
}
const idle = () => new Promise((done) => setImmediate(done));
const BED = { key: 'a', kind: 'bed', depth: 1010, toolface: 90, apparent_dip: 45 };

test('where the folder of the file cannot be written, the card says that picks are not saved, and what keeps them', () => {
  const { made } = served([200]);
  const page = {};
  globalThis.document.getElementById = () => ({ classList: { toggle: (_, on) => (page.bad = on) }, set textContent(text) { page.text = text; }, set title(text) { page.title = text; } });
  made.begin({ well: 'A', picks_file: 'a.picks.csv', saves_picks: false });
  made.writeSaved();
  assert.deepEqual(page, { text: 'not saved: Download', title: 'Picks are not saved in a.picks.csv: its folder cannot be written. Download keeps them.', bad: true });
  made.begin({ well: 'A', picks_file: 'a.picks.csv', saves_picks: true });
  made.writeSaved();
  assert.deepEqual(page, { text: 'saved in a.picks.csv', title: 'saved in a.picks.csv', bad: false });
});

test('what the server has not taken stays, over what it sends, and is sent again when it is back', async (t) => {
  const later = t.mock.method(globalThis, 'setTimeout', () => {});
  const { made, sent, asked, statuses } = served([200]);
  const page = {};
  globalThis.document.getElementById = () => ({ classList: { toggle: (_, on) => (page.bad = on) }, set textContent(text) { page.text = text; } });
  const card = () => {
    made.writeSaved();
    return page.text;
  };
  made.receive([BED, { ...BED, key: 'b', depth: 1015 }]);
  assert.equal(card(), 'saved in a.picks.csv');
  made.app.status = 'lost';
  made.put({ ...BED, key: 'c', depth: 1020 });
  made.put({ ...BED, apparent_dip: 30 });
  made.remove(made.kept.find(({ key }) => key === 'b'));
  await idle();
  assert.deepEqual([asked, card(), page.bad, made.waits], [[], '3 changes not saved', true, true]);
  assert.deepEqual(sent.slice(1), ['Not saved yet: the server is not connected. This page keeps the change and sends it again.'], 'after the dip of the new pick');
  made.begin({ well: 'B', picks_file: null });
  assert.equal(sent.at(-1), '3 changes of A not saved: this is another wall. They are sent when theirs is back.');
  made.receive([]);
  assert.deepEqual([made.kept, asked, made.waits], [[], [], true], 'never sent to another wall');
  made.app.status = 'live';
  statuses[0] = 500;
  made.begin({ well: 'A', picks_file: 'a.picks.csv' });
  made.receive([BED, { ...BED, key: 'b', depth: 1015 }]);
  assert.deepEqual(made.kept.map(({ key, apparent_dip: dip }) => [key, dip]), [['a', 30], ['c', 45]]);
  await idle();
  assert.deepEqual([card(), made.waits, asked.length, later.mock.callCount()], ['3 changes not saved', true, 1, 1], 'a disk that is full refuses nothing');
  statuses[0] = 200;
  made.receive([BED, { ...BED, key: 'b', depth: 1015 }]);
  await idle();
  assert.deepEqual(asked.slice(1), ['PUT api/pick?', 'PUT api/pick?', 'DELETE api/pick?key=b']);
  assert.deepEqual([card(), made.waits, sent.at(-1)], ['saved in a.picks.csv', false, '3 changes saved that waited for the server']);
});

test('what breaks a rule is said in the words of its field, and the pick is as it was', async () => {
  const { made, sent } = served([400], 'apparent_dip = 95: must be 0 to 89.9\n');
  made.receive([BED]);
  made.selected = 'a';
  made.put({ ...BED, apparent_dip: 95 });
  assert.equal(made.pick.apparent_dip, 95);
  await idle();
  assert.deepEqual([made.kept, made.selected, made.waits, made.changes], [[BED], 'a', false, []]);
  assert.deepEqual(sent, ['Not saved: apparent dip ° = 95: must be 0 to 89.9']);
});

test('a table is added as one step for undo, and says what it added, replaced and left', async () => {
  const { made, sent, asked } = served([200], JSON.stringify({ added: ['x', 'y'], replaced: ['a'], unchanged: 3 }));
  made.receive([BED]);
  const loading = made.load({ files: [{ text: async () => 'class,depth_m' }], value: 'a.csv' });
  await idle();
  made.receive([{ ...BED, depth: 1009 }, { ...BED, key: 'x', depth: 1011 }, { ...BED, key: 'y', depth: 1012 }]);
  await loading;
  assert.deepEqual([asked, sent], [['POST api/picks.csv?'], ['2 picks added, 1 replaced, 3 unchanged']]);
  made.undo();
  assert.deepEqual([made.kept, sent.at(-1)], [[BED], 'Undone: 3 picks of the opened table']);
  made.redo();
  assert.deepEqual([made.kept.map(({ depth }) => depth), sent.at(-1)], [[1009, 1011, 1012], 'Redone: 3 picks of the opened table']);
  made.undo();
  await idle();
  assert.deepEqual(asked.slice(1).sort(), ['DELETE api/pick?key=x', 'DELETE api/pick?key=y', 'PUT api/pick?']);
});

test('a pick stays in the wall, whether it is dragged, drawn or typed', () => {
  const { made, sent } = picking();
  made.receive([BED, { ...BED, key: 'out', depth: 2000 }]);
  made.selected = 'a';
  made.drag(made.grab({ depth: 1010, toolface: 0 }, 0.02), { depth: 1400, toolface: 0 });
  made.drop();
  assert.equal(made.pick.depth, 1030);
  made.setField({ name: 'depth', value: '9999', valueAsNumber: 9999 });
  assert.equal(sent[0], 'bed at 1030.00 m: moved by 20.00 m. Ctrl Z takes it back.');
  assert.deepEqual([made.pick.depth, sent.slice(1)], [1030, ['9999.00 m is outside the wall, 1000.0–1030.0 m']]);
  made.selected = null;
  trace(made, 1030.4, 210);
  assert.deepEqual([made.kept.length, made.pick, sent.at(-1)], [2, null, '1030.40 m is outside the wall, 1000.0–1030.0 m']);
  made.selected = 'out';
  made.setClass('fault');
  assert.equal(made.pick.kind, 'fault', 'one that a table put there can be changed otherwise');
});

test('a box is dragged over a breakout, across the edge of the image as well; a tiny one is none', () => {
  const { made } = picking();
  made.setClass('breakout');
  const began = made.grab({ depth: 1010, toolface: 350 }, 0.02);
  made.drag(began, { depth: 1012, toolface: 20 });
  made.drop();
  const [{ key, ...box }] = made.kept;
  assert.match(key, /^[0-9a-f]{12}$/);
  assert.deepEqual(box, { kind: 'breakout', depth: 1011, toolface: 5, height: 2, opening: 30 });
  assert.equal(made.near({ depth: 1011.5, toolface: 192 }, 0), made.kept[0], 'its other side is part of it');
  assert.equal(made.near({ depth: 1011.5, toolface: 90 }, 0), null);
  made.drag(made.grab({ depth: 1020, toolface: 50 }, 0.02), { depth: 1020, toolface: 51 });
  made.drop();
  assert.equal(made.kept.length, 1);
});

test('one pick too many is not kept and says so; its points stay', () => {
  const { made, sent } = picking();
  made.receive(Array.from({ length: 5000 }, (_, i) => ({ key: String(i), kind: 'bed', depth: i, toolface: 0, apparent_dip: 1 })));
  made.points = [0, 120, 240].map((toolface) => ({ depth: 1003, toolface, radius: 0.1, measured: true }));
  made.keep();
  assert.equal(made.kept.length, 5000);
  assert.equal(made.points.length, 3);
  assert.deepEqual(sent, ['There are 5000 picks, as many as a wall has. This one was not kept: 1003.00 m']);
});

test('poles of level planes are in the middle of the net, of steep ones opposite to their dip', () => {
  assert.deepEqual(pole(0, 70).map((x) => Math.abs(x)), [0, 0]);
  const [x, y] = pole(90, 90);
  near(x, -1, 1e-12);
  near(y, 0, 1e-12);
  assert.deepEqual(rose([0, 14.9, 359, -1, 15]).filter(Boolean), [2, 1, 2]);
});

test('the compass has the letter of north in every attitude, on no part of its needle', () => {
  for (let i = 0; i < 144; i++) {
    const [turned, raised] = [(i % 24) * 15 * RAD, (Math.floor(i / 24) * 36 - 90) * RAD];
    const sides = [[Math.cos(turned), Math.sin(turned), 0], [-Math.sin(turned) * Math.sin(raised), Math.cos(turned) * Math.sin(raised), Math.cos(raised)], [Math.sin(turned) * Math.cos(raised), -Math.cos(turned) * Math.cos(raised), Math.sin(raised)]];
    const canvas = { labels: [], strokes: [] };
    const measureText = (text) => ({ actualBoundingBoxLeft: 3.5 * text.length, actualBoundingBoxRight: 3.5 * text.length, actualBoundingBoxAscent: 4, actualBoundingBoxDescent: 4 });
    const points = [];
    const ink = new Proxy({ canvas, measureText, lineTo: (...at) => points.push(at) }, { get: (of, name) => of[name] ?? (() => {}), set: () => true });
    compass(ink, { facing: (direction) => sides.map((side) => side.reduce((sum, x, j) => sum + x * direction[j], 0)) }, { left: 0, height: 400 }, { ink: '#000000', paper: '#ffffff' });
    const [{ text, left, right, top, bottom }, ...others] = canvas.labels;
    assert.deepEqual([text, others], ['N', []]);
    const needle = points.slice(25); // behind the disc
    assert.equal(needle.length, 6);
    for (const [x, y] of needle) assert.ok(x < left || x > right || y < top || y > bottom, `turned ${turned / RAD}, raised ${raised / RAD}`);
    assert.ok(Math.hypot((left + right) / 2 - 52, (top + bottom) / 2 - 354) < 41, 'beside it');
  }
});

test('the azimuth of a breakout is that of its direction, not its angle from north around the hole', () => {
  const [I, A, t] = [40 * RAD, 63 * RAD, 50 * RAD]; // as in test_stress.py
  const [north, east] = [Math.cos(t) * Math.cos(I) * Math.cos(A) - Math.sin(t) * Math.sin(A), Math.cos(t) * Math.cos(I) * Math.sin(A) + Math.sin(t) * Math.cos(A)];
  const made = path(40, 63);
  near(made.azimuth(1010, 50), Math.atan2(east, north) / RAD, 1e-4);
  assert.equal(axisOf(made, 1010, 230), '120° / 300°');
  assert.ok(95 - made.dial(1010).north - made.azimuth(1010, 95) > 6, 'they differ');
  const row = readout({ store: { basis: 'gauge', attributes: [] }, view: { cursor: { depth: 1010, toolface: 95 }, units: 'mm' }, path: made, vertex: null }).find(([name]) => name === 'From high side / azimuth');
  assert.equal(row[1], `95.0° / ${made.azimuth(1010, 95).toFixed(1)}°`, 'the read-out says the same');
  assert.ok(Number.isNaN(path(90, 63).azimuth(1010, 0)), 'straight up');
  const unsurveyed = new Path(1000, 0.5, 'north');
  assert.deepEqual([axisOf(unsurveyed, 1010, 30), axisOf(new Path(1000, 0.5, 'high-side'), 1010, 30)], ['030° / 210°', '']);
});

test('the distance to a planned path is that to its nearest leg, and not known before its start and beyond its end', () => {
  const plan = [[0, 0, 0], [0, 0, 100], [0, 30, 140]];
  const far = (place) => Math.hypot(...(fromPlan(plan, place) ?? [NaN]));
  near(far([3, 4, 50]), 5, 1e-9);
  near(far([5, 15, 120]), 5, 1e-9);
  near(far([0, -1, 100.5]), Math.hypot(1, 0.5), 1e-9, 'at the bend');
  assert.ok([[0, 0, -1], [0, 60, 180]].every((point) => Number.isNaN(far(point))));
});

test('a hole is so far above and to the right of its plan as it is moved, looking downhole', () => {
  for (const [inclination, azimuth] of [[35, 60], [88, 250]]) {
    const made = path(inclination, azimuth);
    const { high, right } = made.at(1010);
    for (const [above, over] of [[1.2, 0.7], [-0.4, -2]]) {
      const plan = [1000, 1029].map((depth) => made.at(depth).centre.map((x, i) => x - above * high[i] - over * right[i]));
      const { away, sides } = offPlan({ path: made, store: { plan } }, 1010);
      near(away, Math.hypot(above, over), 1e-3);
      assert.deepEqual(sides.map(([, side]) => side), [above > 0 ? 'to the high side' : 'to the low side', over > 0 ? 'right' : 'left']);
      near(sides[0][0], Math.abs(above), 1e-3);
      near(sides[1][0], Math.abs(over), 1e-3);
    }
  }
  const made = path(0, 0);
  assert.deepEqual(offPlan({ path: made, store: { plan: [[3, 4, 0], [3, 4, 20]] } }, 1010).sides, [], 'a vertical hole has no upper side');
});

test('95 % intervals of picks hold the true dip and azimuth of planes drawn with errors of 1 to 2 pixels', () => {
  let state = 45;
  const random = () => { // mulberry32
    state = (state + 0x6d2b79f5) | 0;
    let t = Math.imul(state ^ (state >>> 15), 1 | state);
    t = (t + Math.imul(t ^ (t >>> 7), 61 | t)) ^ t;
    return ((t ^ (t >>> 14)) >>> 0) / 2 ** 32;
  };
  const gauss = () => Math.sqrt(-2 * Math.log(1 - random())) * Math.cos(2 * Math.PI * random());
  for (const [count, length] of [[4, 3], [4, 20], [90, 3], [90, 20]]) {
    const held = [0, 0];
    const pixel = [length / 600, 1.4];
    for (let i = 0; i < 300; i++) {
      const made = path(5 + 60 * random(), 360 * random());
      const truth = planeOf(made, { kind: 'fracture', depth: 1010, apparent_dip: 10 + 65 * random(), toolface: 360 * random(), radius: 0.1 }, 0.1);
      const off = 1 + random();
      const waves = [1, 2, 3, 4].map((k) => [k, gauss(), gauss(), gauss(), gauss()]); // a hand is off at many places together
      const points = Array.from({ length: count }, (_, n) => {
        const angle = (n * 360) / count + 40 * random();
        const wave = (side) => (count < 9 ? gauss() : waves.reduce((sum, [k, ...parts]) => sum + (parts[side] * Math.cos(k * angle * RAD) + parts[side + 2] * Math.sin(k * angle * RAD)) / 2, 0));
        return { toolface: angle + off * pixel[1] * wave(0), depth: planeDepth(made, truth, angle) + off * pixel[0] * wave(1), radius: 0.1 };
      });
      const plane = fitPlane(made, points, 'fracture');
      const [dip, azimuth] = intervalsOf({ ...plane, ...surenessOf(made, plane, points, pixel) }, true);
      held[0] += Math.abs(plane.dip - truth.dip) <= dip;
      held[1] += Math.abs(((plane.azimuth - truth.azimuth + 540) % 360) - 180) <= azimuth;
    }
    for (const share of held.map((one) => one / 300)) assert.ok(share > 0.9 && share <= 0.995, `${count} points, ${length} m in view: ${held}`);
  }
});

test('a pick made at a fine scale is surer than at a coarse one, keeps this where it is moved, and loses it where it is turned by hand', () => {
  const { made } = picking();
  trace(made, 1010, 90);
  const fine = made.kept[0];
  made.app.view.length = 60;
  trace(made, 1020, 90);
  assert.ok(made.kept[1].dip_sigma > 5 * fine.dip_sigma && made.kept[1].toolface_sigma > fine.toolface_sigma);
  made.selected = fine.key;
  made.nudge(2, 0);
  assert.equal(made.pick.dip_sigma, fine.dip_sigma, 'moved along the hole');
  made.nudge(0, 5);
  assert.ok(made.pick.dip_sigma > 5 * fine.dip_sigma, 'turned at the coarse scale');
  assert.match(inWords(made.plane(made.pick), made.app.path), /^true dip \d+\.\d° ± \d+ toward \d+°( ± \d+| or any) {3}\(apparent /);
  assert.match(inWords({ ...made.plane(made.pick), dip: 0, azimuth: NaN }, made.app.path), /^true dip 0\.0°.*, level {3}\(apparent /);
  made.receive([{ key: 'read', kind: 'bed', depth: 1010, toolface: 90, apparent_dip: 45, dip_sigma: null, toolface_sigma: null }]);
  assert.doesNotMatch(inWords(made.plane(made.kept.find(({ key }) => key === 'read')), made.app.path), /±/, 'a pick from elsewhere');
});
