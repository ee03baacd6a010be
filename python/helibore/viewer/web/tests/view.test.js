import assert from 'node:assert/strict';
import { test } from 'node:test';
import { Glow } from '../src/glow.js';
import { depthAt, layout, yOf } from '../src/layout.js';
import { gridIndices, niceStep, pickStride, rowsShown, tubeFor } from '../src/lod.js';
import { printScale } from '../src/panel.js';
import { leftEdge, Path } from '../src/path.js';
import { lampWords, Pace } from '../src/lamp.js';
import { showLength, showSigned, showValue } from '../src/units.js';
import { outside, scaleLength } from '../src/tracks.js';
import { ticks, View } from '../src/view.js';

// A path of constant inclination and azimuth, degrees.
function straight(inclination, azimuth, count = 20) {
  const [I, A] = [inclination, azimuth].map((x) => (x * Math.PI) / 180);
  const tangent = [Math.sin(I) * Math.cos(A), Math.sin(I) * Math.sin(A), Math.cos(I)];
  const high = [Math.cos(I) * Math.cos(A), Math.cos(I) * Math.sin(A), -Math.sin(I)];
  const right = [-Math.sin(A), Math.cos(A), 0];
  const path = new Path(1000, 2);
  const centre = new Float64Array(3 * count);
  const directions = new Float32Array(6 * count);
  for (let i = 0; i < count; i++) {
    centre.set(tangent.map((x) => 2 * i * x), 3 * i);
    directions.set([...high, ...right], 6 * i);
  }
  path.apply({ first: 0, count, total: count, centre, directions, surveyed: true });
  return path;
}

test('north on the dial is the exact conversion, not minus the azimuth', () => {
  const { up, north } = straight(48, 248).dial(1010);
  assert.ok(Math.abs(up) < 1e-4, 'toolface 0 is the high side');
  assert.ok(Math.abs(((north + 360) % 360) - 105.13) < 0.01, `${north}`);
});

test('where a reference is undefined it is said', () => {
  assert.equal(straight(0, 0).dial(1010).up, null);
  assert.equal(leftEdge(straight(0, 0), 'top', 1010).known, false);
  assert.equal(straight(90, 0).dial(1010).north, null);
  assert.deepEqual(leftEdge(straight(30, 90), 'bottom', 1010), { toolface: 180, known: true });
});

test('frames between stations are on the path', () => {
  const frame = straight(30, 90).at(1011);
  assert.ok(Math.abs(frame.centre[2] - 11 * Math.cos(Math.PI / 6)) < 1e-9);
  assert.ok(Math.abs(frame.tangent[1] - 0.5) < 1e-6);
});

test('true depth is known where the server says so, and nowhere else', () => {
  const path = straight(60, 90, 11);
  assert.ok(Number.isNaN(path.tvd(1010)), 'a survey that begins in the hole gives none');
  path.trueDepth = [1000, 1020, -700];
  assert.ok(Math.abs(path.tvd(1020) - 710) < 1e-4, 'the last frame');
  assert.equal(path.tvd(1000), 700);
  for (const depth of [999.9, 1020.1]) assert.ok(Number.isNaN(path.tvd(depth)), `${depth}`);
  path.trueDepth = [1000, 1010, -700];
  assert.equal(path.whyNoTvd(1015), 'beyond the survey');
  assert.equal(path.whyNoTvd(999.9), 'above the wall');
  assert.equal(path.whyNoTvd(1e4), 'below the wall');
  path.trueDepth = null;
  assert.equal(path.whyNoTvd(1e4), '');
});

test('the lamp says how far behind the bit the wall is, or how far the bit was lifted, and why nothing comes', () => {
  const words = (bitDepth, pitch, more = {}) => lampWords({
    status: 'live', words: '', bitDepth, newest: Date.now() / 1000 - 5, received: null, ended: false, alarms: { feed: [] }, lost: [], sources: 'mwd: waiting to connect', lastWrite: null, replay: {}, contents: null, view: { units: 'mm' }, pace: new Pace(),
    store: { end: 1050, span: [1000, 1050], levels: [{ pitch }] }, ...more,
  });
  assert.deepEqual(words(1052.5, 0.1), ['live', '5 s old · 2.5 m behind bit', 'live']);
  assert.equal(words(1047.5, 0.1)[1].split(' · ')[1], 'bit 2.5 m above the end of data');
  assert.equal(words(1047.5, -0.1)[1].split(' · ')[1], '2.5 m behind bit', 'logging up');
  assert.equal(words(1049.99, 0.1)[1].split(' · ')[1], '0.0 m behind bit');
  assert.deepEqual(words(1050, 0.1, { newest: Date.now() / 1000 - 180 }), ['late', '3 min old · 0.0 m behind bit · mwd: waiting to connect', 'no new bit depth']);
  assert.deepEqual(words(1050, 0.1, { newest: Date.now() / 1000 - 180, received: Date.now() / 1000 - 2 }), ['live', 'last radius 3 min old · 0.0 m behind bit', 'last radius 3 min old'], 'the bit depth comes on');
  const pace = new Pace();
  for (const at of [100, 101, 102, 104, 105, 105]) pace.note(at);
  const [long, short] = [9, 2].map((age) => words(1050, 0.1, { received: Date.now() / 1000 - age, newest: 0, pace })[0]);
  assert.deepEqual([long, short], ['late', 'live'], 'a source that sends every second is late after 9 s');
  const radii = new Pace();
  for (const at of [100, 101, 102]) radii.note(at);
  /** @param {number} age @param {number} bitDepth @param {number} holeDepth */
  const without = (age, bitDepth, holeDepth) => words(bitDepth, 0.1, { radii, holeDepth, seenHole: 1050, newest: Date.now() / 1000 - age, received: Date.now() / 1000 - 1 });
  assert.deepEqual([without(12, 1051, 1051)[0], without(12, 1051, 1051)[2]], ['late', 'no radius for 12 s, 1.0 m drilled'], 'hole is drilled, and the caliper is dead');
  assert.deepEqual([without(9, 1051, 1051), without(12, 1040, 1051), without(12, 1050, 1050)].map(([colour]) => colour), ['live', 'live', 'live'], 'soon, off bottom, no new hole');
  assert.equal(without(12, 1040, 1053)[2], 'no radius for 12 s, 3.0 m drilled', 'off bottom, after hole that the string may meet unseen');
  assert.deepEqual(words(1057, 0.1, { radii, holeDepth: 1057, seenHole: 1050, newest: null, received: Date.now() / 1000 - 1 }).filter((_, i) => i !== 1), ['late', 'no radius since the start, 7.0 m drilled'], 'a server that was started again');
  radii.usual = 50;
  assert.equal(without(59, 1051, 1051)[0], 'live', 'a tool that sends every 50 s');
  assert.deepEqual(words(1050, 0.1, { newest: null, received: Date.now() / 1000 - 2 }).slice(0, 2), ['live', 'no radius since the start · 0.0 m behind bit · wall 1000.0–1050.0 m'], 'a server that was started again');
  assert.deepEqual(words(null, 0.1, { newest: null, ended: true }), ['', 'not live · wall 1000.0–1050.0 m', 'not live'], 'whether it was saved is not known');
  assert.deepEqual(words(1050, 0.1, { status: 'waiting', store: null }), ['', 'waiting']);
  assert.deepEqual(words(1050, 0.1, { status: 'lost', words: 'Connection lost, trying again' }), ['lost', 'Connection lost, trying again']);
});

test('an alarm that lasts, silenced or not, and a source that is not connected turn the lamp at once', () => {
  const words = (more) => lampWords({
    status: 'live', words: '', bitDepth: 1058, newest: Date.now() / 1000 - 1, received: null, ended: false, alarms: { feed: [] }, lost: [], sources: '', lastWrite: null, replay: {}, contents: null, view: { units: 'mm' },
    store: { end: 1050, levels: [{ size: 12345, pitch: 0.1 }] }, ...more,
  });
  const refused = 'refused mwd: no sample was usable for 120 s: 40 no value';
  assert.deepEqual(words({ alarms: { feed: [refused], silenced: [refused] } }), ['late', 'no sample was usable for 120 s · 1 s old · 8.0 m behind bit · 1 silenced', 'no sample was usable for 120 s']);
  assert.equal(words({ alarms: { feed: [refused, 'no data rig: nothing'], silenced: [] } })[2], 'no sample was usable for 120 s +1 more');
  assert.equal(words({ alarms: { feed: ['depth jump rig: bit depth jumped from 2000 to 2300 m', 'high rig: WOB'], silenced: [] } })[0], 'live', 'data come');
  for (const one of ['depth step: bit depth jumped by -9.5 m', 'stays: caliper constant since 2533 m']) {
    assert.deepEqual(words({ alarms: { feed: [`${one}: 0.5 s`], silenced: [] } })[2], one.split(': ')[1], 'what comes cannot be trusted');
  }
  assert.deepEqual(words({ lost: ['rig'] }), ['lost', 'rig not connected · 1 s old · 8.0 m behind bit', 'rig not connected']);
  assert.equal(words({ lost: ['rig'], ended: true })[0], '', 'a run that has ended needs no source');
});

test('a coarse grid uses the fine grid’s corners and covers all of it', () => {
  for (const [K, rows, a, b] of [[64, 256, 4, 16], [36, 64, 8, 64], [8, 1024, 1, 4]]) {
    const indices = gridIndices(K, rows, a, b);
    assert.ok(indices.every((i) => i < (K + 1) * (rows + 1)));
    let area = 0;
    for (let i = 0; i < indices.length; i += 3) {
      const [p, q, r] = [0, 1, 2].map((j) => [indices[i + j] % (K + 1), Math.floor(indices[i + j] / (K + 1))]);
      const twice = (q[0] - p[0]) * (r[1] - p[1]) - (r[0] - p[0]) * (q[1] - p[1]);
      assert.ok(twice > 0, 'every triangle has the same sense');
      area += twice / 2;
    }
    assert.equal(area, K * rows);
  }
});

test('strides grow with distance and stop at the limit', () => {
  assert.equal(pickStride([1, 4, 16, 64], 5, 64), 1);
  assert.equal(pickStride([1, 4, 16, 64], 0.1, 64), 16);
  assert.equal(pickStride([1, 4, 16, 64], 0.001, 16), 16);
});

test('of a tile only the rows in the section are drawn, and all of those', () => {
  for (const pitch of [0.1, -0.1]) {
    const level = { columns: 64, rows: 256, pitch };
    const tile = { startDepth: 1000 };
    const ends = [1000, 1000 + 256 * pitch].sort((a, b) => a - b);
    const all = rowsShown({ tile, top: ends[0], bottom: ends[1] }, { top: 0, bottom: 9999 }, level, { cols: 1, rows: 4 });
    assert.deepEqual(all, [0, 6 * 64 * 64]);
    const [a, b] = [1000 + 40 * pitch, 1000 + 60 * pitch].sort((x, y) => x - y);
    const [first, count] = rowsShown({ tile, top: ends[0], bottom: ends[1] }, { top: a, bottom: b }, level, { cols: 1, rows: 1 });
    assert.ok(first <= 39 * 6 * 64 && first + count >= 61 * 6 * 64 && count <= 24 * 6 * 64);
  }
});

test('steps a person would choose', () => {
  assert.deepEqual([0.7, 1, 1.1, 3, 7, 60].map(niceStep), [1, 1, 2, 5, 10, 100]);
  assert.equal(tubeFor(2, 0.108), 1);
  assert.equal(tubeFor(30, 0.108), 10);
  assert.deepEqual(ticks(1000, 1010, 500, 60).values, [1000, 1002, 1004, 1006, 1008, 1010]);
  assert.equal(ticks(1000, 1001, 500, 60).digits, 1);
});

test('depth and pixel are each other’s inverse in every track', () => {
  const rects = layout(1078, 724);
  const view = { top: 1000, bottom: 1030 };
  for (const rect of [rects.axis, rects.image, rects.caliper]) {
    assert.equal(rect.top, rects.axis.top);
    assert.equal(rect.height, rects.axis.height);
    assert.ok(Math.abs(depthAt(view, rect, yOf(view, rect, 1012.3)) - 1012.3) < 1e-9);
  }
  const order = ['map', 'axis', 'image', 'caliper', 'wall'].map((name) => rects[name]);
  for (let i = 1; i < order.length; i++) assert.ok(order[i].left >= order[i - 1].left + order[i - 1].width, 'tracks do not overlap');
});

const wall = { span: [1000, 1100], end: 1100, levels: [{ pitch: 0.1 }], bitRadius: 0.1 };

test('the section stays with the wall, and zoom holds its depth', () => {
  const view = new View(() => {});
  view.show(5000, 30, wall);
  assert.ok(view.top <= 1100 && view.follow === false);
  view.show(1040, 20, wall);
  view.zoom(0.5, 1045, wall);
  assert.ok(Math.abs((1045 - view.top) / view.length - 0.25) < 1e-9);
});

test('following keeps the newest quad near the bottom, or near the top when logging up', () => {
  const view = new View(() => {});
  view.followEnd(wall);
  assert.ok(view.follow && view.bottom > 1100 && view.bottom - 1100 < 0.2 * view.length);
  const up = { ...wall, end: 1000, levels: [{ pitch: -0.1 }] };
  view.followEnd(up);
  assert.ok(view.top < 1000 && 1000 - view.top < 0.2 * view.length);
  view.followEnd(wall, 1100 + 0.59 * view.length);
  assert.ok(view.bottom > 1100 + 0.6 * view.length, 'the bit is in view');
  view.followEnd(up, 1000 - 0.59 * view.length);
  assert.ok(view.top < 1000 - 0.6 * view.length);
});

test('an address says what is seen, and a wrong one nothing', () => {
  const view = new View(() => {});
  view.show(1040, 20, wall);
  view.choose({ quantity: 'GR', cut: 'north', shape: 5 });
  const other = new View(() => {});
  assert.equal(other.fromAddress(view.toAddress()), true);
  assert.deepEqual([other.top, other.length, other.quantity, other.cut, other.shape, other.follow], [1040, 20, 'GR', 'north', 5, false]);
  const third = new View(() => {});
  assert.equal(third.fromAddress('#md=abc&sec=-4&cut=<b>&shape=1e9'), false);
  assert.deepEqual([third.length, third.cut, third.shape], [30, 'top', 0]);
});

test('missing is a dash, never a number', () => {
  assert.equal(showLength(NaN, 'mm'), '–');
  assert.equal(showLength(0.10801, 'mm'), '108.01 mm');
  assert.equal(showLength(0.10801, 'in'), '4.252 in');
  assert.equal(showSigned(-0.0015, 'mm'), '−1.50 mm');
  assert.equal(showValue(87.3049, 'gAPI'), '87.305 gAPI');
  assert.equal(showValue(NaN, 'gAPI'), '–');
});

test('new quads glow and fade, joined where they continue', () => {
  const glow = new Glow();
  const tile = { index: 1, level: { rows: 4, tileSize: 32 } };
  glow.rows = 4;
  glow.add(30, 40, false, 10);
  glow.add(40, 50, false, 10.1);
  assert.deepEqual(glow.on(tile, 10)[0].slice(0, 2), [-2, 18]);
  assert.equal(glow.on(tile, 10).length, 1);
  assert.equal(glow.fade(20), false);
  for (let i = 0; i < 50; i++) glow.add(i * 100, i * 100 + 1, true, 30 + i);
  assert.ok(glow.ranges.length <= 8);
});

test('a print has the scale of the screen, else the usual one nearest to it', () => {
  const image = { height: 604 };
  const at = (scale) => printScale({ length: scaleLength(image, scale) }, image);
  for (const scale of [20, 200, 240, 1000]) assert.equal(at(scale), scale);
  assert.deepEqual([3.2, 139.5, 143.5, 199.4, 70000.5].map(at), [20, 100, 200, 200, 1000]);
});

test('the usual curves are shown until the address or the user chooses others, or none', () => {
  const view = new View(() => {});
  view.usual([], ['GR', 'ROP']);
  assert.deepEqual(view.curves, ['GR', 'ROP']);
  const other = new View(() => {});
  other.fromAddress(view.toAddress());
  assert.deepEqual(other.curves, ['GR', 'ROP']);
  for (const name of ['GR', 'ROP']) other.toggleCurve(name);
  other.usual([], ['GR']);
  assert.deepEqual(other.curves, []);
  const third = new View(() => {});
  third.fromAddress(other.toAddress());
  third.usual([], ['GR']);
  assert.deepEqual(third.curves, [], 'hidden for the one who gets the address, too');
});

test('the theme is that of the machine until someone chooses one, which the address then says', () => {
  const view = new View(() => {});
  view.followTheme(true);
  assert.equal(view.theme, 'dark');
  assert.doesNotMatch(view.toAddress(), /theme/, 'a colleague has their own');
  view.toggleTheme();
  view.followTheme(true);
  assert.equal(view.theme, 'light');
  const other = new View(() => {});
  other.fromAddress(view.toAddress());
  other.followTheme(true);
  assert.equal(other.theme, 'light');
});

test('on a phone tadpoles stand beside the image, in place of the caliper', () => {
  const widths = (dips) => Object.entries(layout(390, 700, { tab: 'log', dips })).map(([name, { width }]) => [name, width]);
  const [without, withThem] = [false, true].map((dips) => Object.fromEntries(widths(dips)));
  assert.deepEqual([without.caliper > 0, without.dips, withThem.caliper, withThem.dips], [true, undefined, 0, 70]);
  assert.ok(withThem.image >= without.image);
});

test('above and below the wall the tracks say why nothing is there', () => {
  const rect = { left: 0, top: 80, width: 100, height: 200 };
  const at = (top, growing, pitch = 0.1) => outside({ view: { top, bottom: top + 20, units: 'mm' }, store: { span: [1000, 1030], levels: [{ pitch }] }, growing }, rect)
    .map(({ from, to, words }) => [Math.round(from), Math.round(to), words[0]]);
  assert.deepEqual(at(1005, true), []);
  assert.deepEqual(at(995, true), [[80, 130, 'start of data, 1000.0 m']]);
  assert.deepEqual(at(1015, true), [[230, 280, 'data to 1030.0 m, not measured yet']]);
  assert.deepEqual(at(1015, false), [[230, 280, 'end of data, 1030.0 m']]);
  assert.deepEqual(at(995, true, -0.1), [[80, 130, 'data to 1000.0 m, not measured yet']], 'a wall that grows upwards');
  assert.deepEqual(at(1015, true, -0.1), [[230, 280, 'end of data, 1030.0 m']]);
  assert.deepEqual(at(1040, false), [[80, 280, 'end of data, 1030.0 m']], 'past the wall');
});

test('a section that is longer than the wall allows keeps its middle', () => {
  const view = new View(() => {}, () => {});
  view.show(1002 - 16, 32, /** @type {any} */ ({ span: [1000, 1004] }));
  assert.deepEqual([view.top, view.length], [992, 20]);
});

test('from inside, the hole is as wide as it is, whatever width was chosen; the picks are off by a word of the address', () => {
  const view = new View(() => {});
  Object.assign(view, { length: 30, tube: 5 });
  for (const [camera, tube] of [['outside', 5], ['down', 1], ['up', 1]]) assert.equal(Object.assign(view, { camera }).tubeFactor({ bitRadius: 0.108 }), tube);
  view.fromAddress('#picks=off');
  assert.equal(view.picks, 'off');
  assert.match(view.toAddress(), /picks=off/);
  view.fromAddress('#picks=none');
  assert.equal(view.picks, 'off', 'another word changes nothing');
});
