// Alarms: zones that are new since the page last received them, and the alarms of the live feed. They stay until the user
// silences them (A), also over a reload.

import { byId } from './panel.js';
import { showSigned, showSpan } from './units.js';

const KEPT = 'helibore.alarms';
/** @param {Zone} a @param {Zone} b */
const overlap = (a, b) => a.kind === b.kind && a.start < b.stop && b.start < a.stop;
/** @param {Zone[]} before @param {Zone[]} now */
export const newZones = (before, now) => now.filter((zone) => !before.some((old) => overlap(old, zone)));

export class Alarms {
  /** @type {Zone[]} */
  zones = [];
  /** @type {string[]} */
  feed = [];
  session = '';
  /** @type {string[]} */
  silenced = [];

  /** @param {App} app */
  constructor(app) {
    this.app = app;
    byId('silence').addEventListener('click', () => this.silence());
  }

  // A wall begins; the alarms of the same wall that a reload interrupted come back.
  /** @param {string} session */
  begin(session) {
    const kept = JSON.parse(sessionStorage.getItem(KEPT) ?? 'null');
    Object.assign(this, { zones: [], silenced: [], ...(kept?.session === session ? kept : {}), session });
  }

  // Zones of a state that follows another one of the same wall; of a wall that is finished none is new.
  /** @param {Zone[] | null} before @param {Zone[]} now @param {boolean} live @param {string[]} feed */
  take(before, now, live, feed) {
    const fresh = live && before ? newZones(before, now) : [];
    this.zones = [...this.zones.map((zone) => now.find((other) => overlap(zone, other)) ?? zone).filter((zone) => now.includes(zone)), ...fresh];
    this.feed = feed;
    this.keep();
  }

  silence() {
    this.silenced = this.feed;
    this.zones = [];
    this.keep();
    this.app.redraw();
  }

  keep() {
    const { session, zones, silenced } = this;
    sessionStorage.setItem(KEPT, JSON.stringify({ session, zones, silenced }));
  }

  /** @param {Zone} zone */
  isNew(zone) {
    return this.zones.some((other) => overlap(other, zone));
  }

  // The worst new zone in words, how many others, and what the feed says.
  /** @param {Units} units */
  text(units) {
    const [worst, ...others] = [...this.zones].sort((a, b) => b.severity - a.severity);
    const more = others.length ? ` and ${others.length} more` : '';
    const zone = worst ? [`New ${worst.kind}${more}: ${showSigned(worst.measure, units, units === 'mm' ? 0 : 1)} at ${showSpan(worst.start, worst.stop, units)}`] : [];
    return [...zone, ...this.feed.filter((one) => !this.silenced.includes(one))].join(' · ');
  }

  /** @param {Units} units */
  write(units) {
    const text = this.text(units);
    byId('alarm').hidden = !text;
    if (byId('alarmText').textContent !== text) byId('alarmText').textContent = text;
  }
}
