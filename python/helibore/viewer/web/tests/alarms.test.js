import assert from 'node:assert/strict';
import test from 'node:test';
import { few, newZones, shortOf } from '../src/alarms.js';
import { recent } from '../src/rig.js';
import { worstOf } from '../src/rig_places.js';

const zone = (kind, start, stop, severity = 1) => ({ kind, start, stop, severity, measure: 0.01, confidence: 0.9 });

test('a zone is new if none of its kind lay there before; one that grows is not', () => {
  const before = [zone('washout', 10, 12), zone('breakout', 20, 25)];
  const now = [zone('washout', 10, 14), zone('breakout', 11, 13), zone('breakout', 26, 28)];
  assert.deepEqual(newZones(before, now), now.slice(1));
  assert.deepEqual(newZones(before, before), []);
});

test('rig mode says an alarm in short words, in two lines at most', () => {
  const since = ', since 12:00:02 UTC, 14:00:02 here';
  const words = {
    [`depth jump mwd: bit depth refused, 8382 m: the last used was 2555 m${since}`]: 'bit depth refused, 8382 m',
    [`stays mwd: caliper constant since 2533 m: 107.9 mm, 50 times in a row${since}`]: 'caliper constant since 2533 m',
    [`failure: thread draw died${since}`]: 'thread draw died',
    [`no depth: it sends${since}`]: 'no bit depth',
    [`no data rig: nothing for 20 s${since}`]: 'no data from rig',
    [`lost: connecting${since}`]: 'not connected',
    [`lost rig: connecting${since}`]: 'rig not connected',
    [`tight ahead: tight hole above the bit${since}`]: 'tight ahead',
  };
  assert.deepEqual(Object.keys(words).map(shortOf), Object.values(words));
  assert.deepEqual(few(['a', 'b']), ['a', 'b']);
  assert.deepEqual(few(['a', 'b', 'c', 'd']), ['a', 'b, +2 more']);
});

test('the worst zone of the last 30 m reaches into them, drilling down or up', () => {
  const zones = [zone('washout', 10, 20, 9), zone('breakout', 60, 71, 3), zone('washout', 80, 82, 2)];
  const wall = (pitch, ...span) => ({ span, levels: [{ pitch }] });
  assert.deepEqual(recent(wall(0.1, 10, 100)), [70, 100]);
  assert.deepEqual(recent(wall(-0.1, 100, 190)), [100, 130]);
  assert.deepEqual(recent(wall(0.1, 88, 100)), [88, 100], 'all of a shorter wall');
  assert.equal(worstOf(zones, [70, 100]), zones[1]);
  assert.equal(worstOf(zones, [71, 100]), zones[2]);
  assert.equal(worstOf(zones, [90, 100]), null);
});
