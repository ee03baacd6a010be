// The opening of a fracture from the wall: the slot that was made comes back; a bed without a slot has none.

import assert from 'node:assert/strict';
import { test } from 'node:test';
import { openingOf } from '../src/opening.js';

const [SECTORS, PITCH, RADIUS] = [64, 0.005, 0.108];

// A wall with a slot: so many metres across a plane, so deep, and how it is read.
/** @param {number} across @param {number} deep @param {{ a: number, b: number, depth: number }} plane */
function slot(across, deep, { a, b, depth }) {
  const vertex = (k) => {
    const [row, sector] = [Math.floor(k / SECTORS), k % SECTORS];
    const angle = (2 * Math.PI * sector) / SECTORS;
    const away = (row * PITCH - depth - RADIUS * (a * Math.cos(angle) + b * Math.sin(angle))) / Math.hypot(1, a, b);
    return { radius: RADIUS + deep * Math.min(1, Math.max(0, (across / 2 - Math.abs(away)) / 0.002 + 0.5)) };
  };
  return { vertex, levels: [{ sectors: SECTORS, pitch: PITCH, quadAt: (at, toolface) => Math.round(at / PITCH) * SECTORS + Math.round((toolface * SECTORS) / 360) }] };
}

for (const apparent of [0, 42, 68]) {
  test(`a slot of 15 mm has its opening across a plane of ${apparent} degrees`, () => {
    const plane = { a: Math.tan((apparent * Math.PI) / 180), b: 0, depth: 15, radius: RADIUS };
    const found = openingOf(slot(0.015, 0.03, plane), plane);
    assert.ok(Math.abs(found.opening - 0.015) < 0.002, String(found.opening));
    assert.ok(Math.abs(found.deep - 0.03) < 0.002);
  });
}

test('a wall without a slot along the plane has no opening', () => {
  const plane = { a: 0.4, b: 0.1, depth: 15, radius: RADIUS };
  assert.equal(openingOf(slot(0.015, 0, plane), plane), null);
  assert.equal(openingOf(slot(0.015, 0.03, { ...plane, depth: 15.5 }), plane), null);
});
