// Alarms: zones that are new since the page last received them, and the alarms of the live feed. They stay until the user
// silences them with the key Q, also after a reload. Rig mode has room for two short lines; there A shows the full texts and
// hides them, and Q silences the alarms once they are shown.

import { recall, remember } from './memory.js';
import { byId, fill, hide, say } from './dom.js';
import { late } from './late.js';
import { showSize, showSpan } from './units.js';
import { byConsequence, IN_WORDS, sureText } from './zones.js';

const KEPT = 'helibore.alarms';
const LINES = 2; // in rig mode
const READ = 10; // seconds for which rig mode shows the full texts, which cover its digits
const FIRST = [/^no data/, /^tight ahead/, /^tight/]; // of the alarms of the feed
/** @param {string} alarm */
const rank = (alarm) => (FIRST.findIndex((one) => one.test(alarm)) + 4) % 4; // that of another alarm: 3
const PLAIN = /^(no|lost|tight|washout)\b/; // rules whose names say what is wrong
// What is wrong by an alarm of the feed, in words: its rule and source or, of most rules, the first words of its text.
/** @param {string} alarm */
export const shortOf = (alarm) => {
  const [rule, text = rule] = alarm.split(/: |, since \d/);
  return PLAIN.test(rule) ? rule.replace(/^no depth/, 'no bit depth').replace(/^(no (data|bit depth|samples)) (?=.)/, '$1 from ').replace(/^lost ?(.*)/, '$1 not connected').trim() : text;
};
// Return at most `LINES` texts; the last text says how many more there are.
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
  /** @type {Pair[]} */
  quiet = []; // ends of the places that were known when the user silenced the alarms
  whole = false; // rig mode shows the whole text
  /** @type {number | undefined} */
  closes = undefined; // timer of the whole text

  /** @param {App} app */
  constructor(app) {
    this.app = app;
    byId('silence').addEventListener('click', () => this.silence());
    byId('alarmText').addEventListener('click', () => this.read(!this.whole));
  }

  // Begin a wall. After a reload of the page, the alarms of the same wall come back.
  /** @param {string} session */
  begin(session) {
    const kept = JSON.parse(recall('sessionStorage', KEPT) ?? 'null');
    Object.assign(this, { zones: [], silenced: [], quiet: [], ...(kept?.session === session ? kept : {}), session });
  }

  // Take the zones (`now`) and the alarms (`feed`) of the next state of the same wall. A zone is new if the wall is `live` and no
  // zone of the same kind in the previous state (`before`) overlaps it. New zones remain alarms until they are silenced or no
  // longer found.
  /** @param {Zone[] | null} before @param {Zone[]} now @param {boolean} live @param {string[]} feed */
  take(before, now, live, feed) {
    const fresh = live && before ? newZones(before, now) : [];
    const zones = [...this.zones.map((zone) => now.find((other) => overlap(zone, other)) ?? zone).filter((zone) => now.includes(zone)), ...fresh];
    if (zones.length !== this.zones.length || zones.some((zone, i) => zone !== this.zones[i])) this.zones = zones;
    this.feed = [...feed].reverse();
    this.keep();
  }

  /** @param {boolean} whole */
  read(whole) {
    this.whole = whole;
    clearTimeout(this.closes);
    if (whole) this.closes = setTimeout(() => this.read(false), 1000 * READ);
    this.app.redraw();
  }

  // Silence the alarms. In rig mode, if their full texts are not on the page yet, show these texts instead.
  silence() {
    if (this.app.view.rig && !this.whole) return this.read(true);
    this.whole = false;
    this.silenced = this.feed;
    this.quiet = [...this.app.zones, ...(late(this.app)?.tightNow(this.app) ?? [])].map(({ start, stop }) => [start, stop]);
    this.zones = [];
    this.keep();
    this.app.redraw();
  }

  keep() {
    const { session, zones, silenced, quiet } = this;
    remember('sessionStorage', KEPT, JSON.stringify({ session, zones, silenced, quiet }));
  }

  /** @param {Zone} zone */
  isNew(zone) {
    return this.zones.some((other) => overlap(other, zone));
  }

  // Return the alarms of the feed that are not silenced: that nothing comes, since all else is old then; tight hole ahead, other tight hole; the newest.
  said() {
    return this.feed.filter((one) => !this.silenced.includes(one)).sort((a, b) => rank(a) - rank(b));
  }

  // Return the texts of the alarms: those of the feed, the worst new zone, and the number of the other new zones.
  /** @param {Units} units @returns {string[]} */
  texts(units) {
    const [worst, ...others] = byConsequence(this.zones);
    const more = others.length ? ` and ${others.length} more` : '';
    return [...this.said(), ...(worst ? [`New ${worst.kind}${more}: ${showSize(worst.measure, units)} ${IN_WORDS[worst.kind]} at ${showSpan(worst.start, worst.stop, units)}, ${sureText(worst)} sure`] : [])];
  }

  /** @param {View} view */
  write({ units, rig }) {
    const places = rig && late(this.app)?.placesOf;
    const texts = places ? places(this.app, true) : this.texts(units);
    this.whole &&= texts.length > 0;
    const whole = rig && this.whole;
    hide(!texts.length, 'alarm');
    hide(!whole, 'alarmWhole');
    byId('alarm').classList.toggle('calm', rig && texts.every((text) => /^(washout|breakout)/.test(text)));
    say('silence', whole ? 'Close (A), silence (Q)' : rig ? 'Read (A)' : 'Silence (Q)');
    lines('alarmText', places ? few(places(this.app, false)) : [texts.join(' · ')]);
    lines('alarmWhole', whole ? texts : []);
  }
}

// Show each text in a line of its own.
/** @param {'alarmText' | 'alarmWhole'} id @param {string[]} texts */
function lines(id, texts) {
  if (byId(id).textContent === texts.join('')) return;
  byId(id).replaceChildren(...texts.map((text) => {
    const span = document.createElement('span');
    fill(span, text);
    return span;
  }));
}
