// Replay: the wall as it was at a moment of the run. For moments of the run, the server keeps
// how many vertices the wall had (scene.py). The page shows that many, with the radii of the first pass, and the bit at
// its depth of that moment. Radii of passes between the first and the latest are not kept.

import { byId, hide } from './dom.js';
import { showClock } from './units.js';

const RUN = 20; // seconds to play all of it
const STEP = 0.25;

// Return vertices and bit depth of the last point that is not later than a moment; before all points, those of the first point.
/** @param {WellHistory} wellHistory @param {number} moment */
export function momentAt({ time, vertices, bit_depth: bit }, moment) {
  let [a, b] = [0, time.length];
  while (b - a > 1) {
    const middle = (a + b) >> 1;
    if (time[middle] <= moment) a = middle;
    else b = middle;
  }
  return { vertices: vertices[a], bitDepth: bit[a] };
}

async function fetchHistory() {
  const answer = await fetch(`api/history${location.search}`).catch(() => null);
  return answer?.ok ? answer.json() : { time: [] };
}

export class Replay {
  /** @param {App} app */
  constructor(app) {
    this.app = app;
    /** @type {Past | null} */
    this.past = null; // while replaying
    /** @type {WellHistory} */
    this.points = { time: [], vertices: [], bit_depth: [] };
    /** @type {Pass} */
    this.pass = 'latest'; // the pass that was shown before the replay
    /** @type {number | undefined} */
    this.playing = undefined;
    byId('replayOpen').addEventListener('click', () => this.toggle());
    byId('live').addEventListener('click', () => this.close());
    byId('play').addEventListener('click', () => this.play(!this.playing));
    byId('moment').addEventListener('input', () => this.show(Number(byId('moment').value)));
  }

  toggle() {
    return this.past ? this.close() : this.open();
  }

  async open() {
    const points = this.app.contents?.history ?? (await fetchHistory());
    if (points.time.length < 2) return this.app.notice('Nothing to replay: this wall has not grown since the viewer started, and its samples do not say when they were measured, or measured the hole again.', 6);
    this.points = points;
    this.pass = this.app.view.pass;
    this.app.view.choose({ pass: 'first' });
    const [from, to] = [points.time[0], points.time.at(-1)];
    Object.assign(byId('moment'), { min: from, max: to, step: 'any', value: to });
    hide(false, 'replay');
    byId('replayOpen').classList.add('on');
    return this.show(to);
  }

  /** @param {number} moment */
  show(moment) {
    const { app, points } = this;
    this.past = { moment, ...momentAt(points, moment) };
    app.store.limit(this.past.vertices);
    byId('moment').value = String(moment);
    byId('momentText').textContent = `as at ${showClock(moment)}`;
    if (app.view.follow) app.follow();
    app.repaint();
  }

  /** @param {boolean} on */
  play(on) {
    clearInterval(this.playing);
    this.playing = undefined;
    byId('play').textContent = on ? 'Pause' : 'Play';
    if (!on) return;
    const { time } = this.points;
    const last = time[time.length - 1];
    const moment = () => this.past?.moment ?? time[0];
    if (moment() >= last) this.show(time[0]);
    this.playing = setInterval(() => {
      this.show(Math.min(last, moment() + ((last - time[0]) * STEP) / RUN));
      if (moment() >= last) this.play(false);
    }, 1000 * STEP);
  }

  // End the replay, and show the present wall.
  close() {
    this.play(false);
    hide(true, 'replay');
    byId('replayOpen').classList.remove('on');
    if (!this.past) return;
    this.past = null;
    this.app.store.limit(Infinity);
    this.app.repaint();
    if (this.app.view.follow) this.app.follow();
    this.app.view.choose(this.app.view.pass === 'first' ? { pass: this.pass } : {});
  }
}
