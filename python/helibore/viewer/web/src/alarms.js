// Alarms: zones that are new since the page last received them, and the alarms of the live feed. They stay until the user
// silences them (A), also over a reload. Rig mode has room for short words in two lines; there A shows the whole text first.

import { recall, remember } from './memory.js';
import { byId } from './panel.js';
import { showSigned, showSpan } from './units.js';
import { MEASURES } from './zones.js';

const KEPT = 'helibore.alarms';
const LINES = 2; // in rig mode
// Rule and source of an alarm of the feed, without the cause that follows them.
/** @param {string} alarm */
export const shortOf = (alarm) => alarm.split(': ')[0];
// At most `LINES` texts; the last one says how many more there are.
/** @param {string[]} texts */
export const few = (texts) => texts.slice(0, LINES).map((text, i) => (i === LINES - 1 && texts.length > LINES ? `${text}, +${texts.length - LINES} more` : text));
/** @param {Zone} a @param {Zone} b */
const overlap = (a, b) => a.kind === b.kind && a.start < b.stop && b.start < a.stop;
/** @param {Zone[]} before @param {Zone[]} now */
export const newZones = (before, now) => now.filter((zone) => !before.some((old) => overlap(old, zone)));

export class Alarms {
  /** @type {Zone[]} */
  zones = [];
  /** @type {string[]} */
  feed = []; // the newest first
  session = '';
  /** @type {string[]} */
  silenced = [];
  whole = false; // rig mode shows the whole text

  /** @param {App} app */
  constructor(app) {
    this.app = app;
    byId('silence').addEventListener('click', () => this.silence());
    byId('alarmText').addEventListener('click', () => this.read(!this.whole));
  }

  // A wall begins; the alarms of the same wall that a reload interrupted come back.
  /** @param {string} session */
  begin(session) {
    const kept = JSON.parse(recall('sessionStorage', KEPT) ?? 'null');
    Object.assign(this, { zones: [], silenced: [], ...(kept?.session === session ? kept : {}), session });
  }

  // Note the zones of the next state of the same wall. In a finished wall no zone is new.
  /** @param {Zone[] | null} before @param {Zone[]} now @param {boolean} live @param {string[]} feed */
  take(before, now, live, feed) {
    const fresh = live && before ? newZones(before, now) : [];
    this.zones = [...this.zones.map((zone) => now.find((other) => overlap(zone, other)) ?? zone).filter((zone) => now.includes(zone)), ...fresh];
    this.feed = [...feed].reverse();
    this.keep();
  }

  /** @param {boolean} whole */
  read(whole) {
    this.whole = whole;
    this.app.redraw();
  }

  // Silence only alarms whose full text was on the page.
  silence() {
    if (this.app.view.rig && !this.whole) return this.read(true);
    this.whole = false;
    this.silenced = this.feed;
    this.zones = [];
    this.keep();
    this.app.redraw();
  }

  keep() {
    const { session, zones, silenced } = this;
    remember('sessionStorage', KEPT, JSON.stringify({ session, zones, silenced }));
  }

  /** @param {Zone} zone */
  isNew(zone) {
    return this.zones.some((other) => overlap(other, zone));
  }

  // What the feed warns of, the newest first, then the worst new zone and how many others; short, or in full.
  /** @param {Units} units @param {boolean} short @returns {string[]} */
  texts(units, short) {
    const [worst, ...others] = [...this.zones].sort((a, b) => b.severity - a.severity);
    const more = others.length ? ` and ${others.length} more` : '';
    const place = worst && showSpan(worst.start, worst.stop, units);
    const zone = !worst ? [] : short ? [`new ${worst.kind}${more}, ${place}`] : [`New ${worst.kind}${more}: ${MEASURES[worst.kind]} ${showSigned(worst.measure, units, units === 'mm' ? 0 : 1)} at ${place}`];
    return [...this.feed.filter((one) => !this.silenced.includes(one)).map((one) => (short ? shortOf(one) : one)), ...zone];
  }

  /** @param {View} view */
  write({ units, rig }) {
    const texts = this.texts(units, false);
    this.whole &&= texts.length > 0;
    const whole = rig && this.whole;
    byId('alarm').hidden = !texts.length;
    byId('alarmWhole').hidden = !whole;
    byId('silence').textContent = rig && !whole ? 'A reads' : 'A silences';
    lines('alarmText', rig ? few(this.texts(units, true)) : [texts.join(' · ')]);
    lines('alarmWhole', whole ? texts : []);
  }
}

// Texts in lines of their own.
/** @param {'alarmText' | 'alarmWhole'} id @param {string[]} texts */
function lines(id, texts) {
  if (byId(id).textContent === texts.join('')) return;
  byId(id).replaceChildren(...texts.map((textContent) => Object.assign(document.createElement('span'), { textContent })));
}
