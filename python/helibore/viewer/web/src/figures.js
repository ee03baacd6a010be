// The figures of the section in view, or in rig mode of the last metres, as the server measures them.

import { say, write } from './dom.js';
import { sectionText } from './panel.js';
import { recent, writeRig } from './rig.js';
import { showSpan } from './units.js';

const WAIT = 250; // milliseconds that the section rests before its figures are requested

export class Figures {
  /** @type {Summary | null} */
  summary = null;
  asked = ''; // for what the last figures were requested
  ofRig = false; // whether the figures are of the last metres, as in rig mode
  pending = false;

  /** @param {App} app */
  constructor(app) {
    this.app = app;
  }

  // Write the figures below the log, with the depths between which they were measured: a growing wall may be longer by now, and an
  // exported file shows other depths than its own.
  write() {
    const { summary, app } = this;
    const { store, view, zones, contents } = app;
    const inView = [Math.max(view.top, store.span[0]), Math.min(view.bottom, store.span[1])];
    const [start, stop] = summary ? [summary.start, summary.stop] : inView;
    const [text, shown] = [[start, stop], inView].map(([from, to]) => showSpan(from, to, view.units));
    say('sectionTitle', stop > start ? `${contents && text !== shown ? 'exported ' : ''}${text}` : '');
    write('section', stop > start ? sectionText(store, summary, view.units, zones, view.bottom) : [['Section', 'no data']]);
    writeRig(app);
  }

  // Ask the server for the figures of the section, or in rig mode of the last metres, once the section rests, and repeatedly
  // while the wall grows. The figures of one mode are not shown in the other mode. An exported file holds the figures of
  // its own section.
  ask() {
    const { app } = this;
    const { view, store, contents } = app;
    if (contents) this.summary = contents.summary;
    if (contents || store.basis === 'gauge') return;
    const { rig } = view;
    const ends = () => (rig ? recent(app.store) : [view.top, view.bottom]);
    const keyOf = (/** @type {number[]} */ of) => [...of.map((end) => end.toFixed(2)), app.store.levels[0].size, app.store.session].join();
    if (this.ofRig !== rig) Object.assign(this, { summary: null, ofRig: rig, asked: '', pending: false });
    if (this.pending || keyOf(ends()) === this.asked) return;
    this.pending = true;
    const wait = rig && !this.summary ? 0 : WAIT;
    setTimeout(async () => {
      const [from, to] = ends();
      this.asked = keyOf([from, to]);
      const query = new URLSearchParams(location.search);
      query.set('start', String(from));
      query.set('stop', String(to));
      const began = performance.now();
      const answer = await fetch(`api/summary?${query}`).catch(() => null);
      const summary = answer?.ok ? await answer.json() : null;
      if (rig !== this.ofRig) return; // the mode has changed since this was asked, and another request is under way
      this.summary = summary;
      const { span: [top, bottom], levels: [{ pitch }] } = app.store;
      const lacking = summary ? Math.min(to, bottom) - Math.max(from, top) - (summary.stop - summary.start) : 0;
      if (lacking > 2 * Math.abs(pitch)) this.asked = ''; // the server is behind: ask again, also if nothing more arrives
      this.write();
      setTimeout(() => {
        this.pending = false;
        this.ask();
      }, 4 * (performance.now() - began));
    }, wait);
  }
}
