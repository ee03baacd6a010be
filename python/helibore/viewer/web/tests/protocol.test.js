import assert from 'node:assert/strict';
import { test } from 'node:test';
import { decode, encodeAck, FRAMES, HEAD, LIVE, NO_FIRST, toRanges, WRITE } from '../src/protocol.js';

function message({ type, level = 0, mask = 0, tile = 0, first = 0, count = 0, total = 0, sequence = 0, time = 0 }, payload = []) {
  const bytes = payload.reduce((sum, part) => sum + part.byteLength, HEAD);
  const buffer = new ArrayBuffer(bytes);
  const view = new DataView(buffer);
  view.setUint8(0, type);
  view.setUint8(1, level);
  view.setUint16(2, mask, true);
  [tile, first, count, total, sequence].forEach((value, i) => view.setUint32(4 + 4 * i, value, true));
  view.setFloat64(24, time, true);
  let at = HEAD;
  for (const part of payload) {
    new Uint8Array(buffer).set(new Uint8Array(part.buffer), at);
    at += part.byteLength;
  }
  return buffer;
}

test('a write is taken apart without copying', () => {
  const texels = Uint16Array.from([10800, 10700, 35, 8, 0, 0, 65535, 0]);
  const buffer = message({ type: WRITE | LIVE, mask: 0b101, tile: 3, first: 7, count: 2, total: 99, sequence: 41, time: 1.5 }, [
    texels,
    Float32Array.from([1, 2]),
    Float32Array.from([NaN, 4]),
  ]);
  const write = decode(buffer);
  assert.equal(write.live, true);
  assert.deepEqual([write.tile, write.first, write.count, write.total, write.sequence, write.time], [3, 7, 2, 99, 41, 1.5]);
  assert.deepEqual([...write.texels], [...texels]);
  assert.deepEqual(write.columns.map(({ attribute }) => attribute), [0, 2]);
  assert.deepEqual([...write.columns[1].values], [NaN, 4]);
  assert.equal(write.texels.buffer, buffer);
});

test('first radii that are left out are the radii', () => {
  const texels = Uint16Array.from([10800, 35, 8, 10700, 36, 7, 0, 65535, 0, 0]); // three of three numbers, then two bytes more
  const write = decode(message({ type: WRITE, level: 1 | NO_FIRST, mask: 1, count: 3 }, [texels, Float32Array.from([1, 2, 3])]));
  assert.equal(write.level, 1);
  assert.deepEqual([...write.texels], [10800, 10800, 35, 8, 10700, 10700, 36, 7, 0, 0, 65535, 0]);
  assert.deepEqual([...write.columns[0].values], [1, 2, 3]);
});

test('frames are taken apart', () => {
  const frames = decode(message({ type: FRAMES, count: 1 }, [Float64Array.from([1, 2, 3]), Float32Array.from([1, 0, 0, 0, 1, 0])]));
  assert.deepEqual([...frames.centre], [1, 2, 3]);
  assert.deepEqual([...frames.directions], [1, 0, 0, 0, 1, 0]);
});

test('what is not a message is refused', () => {
  assert.throws(() => decode(new ArrayBuffer(3)), /message of 3 bytes: a head has 32/);
  assert.throws(() => decode(message({ type: WRITE, count: 2 })), /message of 32 bytes: its head says 48/);
  assert.throws(() => decode(message({ type: 9 })), /message type 9: unknown/);
});

test('an acknowledgement names its wall', () => {
  assert.deepEqual(JSON.parse(encodeAck('ab', 5)), { session: 'ab', ack: 5 });
});

test('tiles become ranges, and too many ranges the fewest extra tiles', () => {
  assert.deepEqual(toRanges([1, 2, 3, 7, 9, 10]), [[1, 4], [7, 8], [9, 11]]);
  assert.deepEqual(toRanges([]), []);
  assert.deepEqual(toRanges([1, 10, 12, 30], 2), [[1, 13], [30, 31]]);
});
