// The lamp: is the data live, late or lost, how old is the newest sample, how far is the wall behind the bit. It shows "late"
// as long as the feed has an alarm that data do not come or are not kept, silenced or not, and "lost" as long as a source is not connected.

import { shortOf } from './alarms.js';
import { byId, put, say } from './dom.js';
import { showAge, showClock, showDepth, showSpan } from './units.js';
import { zoneAt, zoneText } from './zones.js';

const SLACK = 3; // seconds by which what a source sends may be later than usual
const DRY = 10; // seconds without a radius, at least
const [DRILLED, BLIND] = [0.1, 2]; // metres of hole drilled meanwhile: on bottom, and enough for the string to meet what nobody saw
const LATE = 60; // seconds without a sample
export const [NO_BIT, NEVER_BIT] = ['no new bit depth', 'no bit depth received'];
const NOT_COMING = /^(no |lost|refused|missing|behind|disk|sync|journal|memory|descriptors|failure)/; // other alarms are about the hole, the rig's channels, or data that came
const NO_DATA = /^(no data|lost)/; // alarms of a source that sends nothing
const DOUBTS = /^(depth s|hole falls|another hole)|depth refused/; // the alarms after which bit and wall may not lie at one depth
const STUCK = /^stays/; // that of a tool that sends one radius again and again
export const LIFTED = 0.5; // metres: a bit depth that is some seconds old may lie so far within a wall that grows
/** @type {Record<string, string>} */
export const SIGNS = { live: '✓', late: '!', lost: '✕' };

// Show the colour and the text of the lamp: how old the newest sample is, and how far the wall is behind the bit.
/** @param {App} app */
export function lamp(app) {
  const [colour, text] = lampWords(app);
  put(byId('lamp'), { className: `lamp ${colour}`, title: text });
  say('lampSign', SIGNS[colour] ?? '');
  say('lampText', text);
}

// How often a source sends: the mean of the seconds between two arrivals, by the server's clock.
export class Pace {
  /** @type {number | null} */
  last = null;
  usual = NaN;

  /** @param {number | null} received */
  note(received) {
    if (received === this.last) return;
    const gap = Math.abs((received ?? NaN) - (this.last ?? NaN));
    if (Number.isFinite(gap)) this.usual = Number.isNaN(this.usual) ? gap : 0.8 * this.usual + 0.2 * Math.min(gap, 2 * this.usual); // one silence is not usual
    this.last = received;
  }
}

// Whether a source has sent nothing for twice the usual time, or for long on a page that does not know this time yet.
/** @param {Pick<App, 'newest' | 'received' | 'lastWrite' | 'pace'>} of */
const isLate = (of) => of.received !== null && silenceOf(of) > 2 * (of.pace.usual || DRY / 3) + SLACK;

// Return the seconds since the last bit depth or, without one, since a source sent anything; NaN if it is not known.
/** @param {Pick<App, 'newest' | 'received' | 'lastWrite'>} of */
export const silenceOf = (of) => (of.received === null ? ageOf(of) : Date.now() / 1000 - of.received);

// Return how much hole was drilled that the sensor would have seen by now, metres; NaN if it is not known.
/** @param {Pick<App, 'holeDepth' | 'seenHole'>} of */
const missed = ({ holeDepth, seenHole }) => (holeDepth ?? NaN) - (seenHole ?? NaN);

// Whether hole was drilled, and no radius has come since, for three times the usual time or, as far as the server knows, ever.
/** @param {Pick<App, 'newest' | 'lastWrite' | 'radii' | 'bitDepth' | 'holeDepth' | 'seenHole'>} of */
export const isDry = (of) => !(ageOf(of) <= Math.max(DRY, 3 * (of.radii?.usual || 0))) && missed(of) > ((of.holeDepth ?? NaN) - (of.bitDepth ?? NaN) < LIFTED ? DRILLED : BLIND);

// Whether so much hole was drilled without a radius that the string may meet what nobody saw.
/** @param {App} app */
export const isBlind = (app) => missed(app) > BLIND;

/** @param {Pick<App, 'newest' | 'received' | 'lastWrite'>} of */
export const isSilent = (of) => silenceOf(of) > LATE;

// Whether the server is there.
/** @param {Pick<App, 'status'>} of */
export const isServed = ({ status }) => /^(live|waiting)$/.test(status);

// Return the alarm after which bit and wall may not lie at one depth, in few words; '' if there is none. That depths were refused counts
// until one is used again. Nor is it known where a string hangs of whose bit the rig has sent no depth.
/** @param {App} app */
export function doubtOf(app) {
  if (app.string && app.bitDepth === null && app.received !== null) return NEVER_BIT;
  const found = app.alarms.feed.find((one) => DOUBTS.test(one));
  return found && !(/refused/.test(found) && silenceOf(app) < SLACK) ? shortOf(found) : '';
}

// Whether numbers that the rig sends may be old: the server is away, or the rig is silent, by the page's limit, for three times the
// usual time or, if it is late, by the limit of its configuration. A tool is silent while the string is tripped, which makes no number of the rig old.
/** @param {App} app */
export const isStale = (app) => Boolean(doubtOf(app)) || !isServed(app) || isSilent(app) || silenceOf(app) > Math.max(DRY, 3 * (app.pace.usual || 0)) + SLACK || (isLate(app) && (app.lost.length > 0 || app.alarms.feed.some((one) => NO_DATA.test(one))));

// Return the seconds since the newest sample, or since the last new value; NaN if nothing was added to the wall.
/** @param {Pick<App, 'newest' | 'lastWrite'>} of */
export const ageOf = ({ newest, lastWrite }) => (newest !== null ? Date.now() / 1000 - newest : lastWrite === null ? NaN : (performance.now() - lastWrite) / 1000);

// Return what is wrong with the feed, in few words; '' if nothing is wrong. That the bit depth is `late` comes first, unless an alarm says why.
/** @param {Pick<App, 'alarms' | 'lost'>} of */
function troubleOf({ alarms, lost }, late = false) {
  if (lost.length) return `${lost.join(', ')} not connected`;
  const feed = alarms.feed.filter((one) => NOT_COMING.test(one) || DOUBTS.test(one) || STUCK.test(one)).map(shortOf);
  if (late && feed.length) feed.unshift(feed.find((one) => /depth/.test(one)) ?? NO_BIT);
  const all = [...new Set(feed)];
  return all.length ? `${all[0]}${all.length > 1 ? ` +${all.length - 1} more` : ''}` : '';
}

// Return the colour, the text, and the one part of the text that rig mode has room for.
/** @param {App} app */
export function lampWords({ status, unused, words, store, alarms, lost, bitDepth, newest, received, ended, sources, lastWrite, replay, contents, view, pace, radii, holeDepth, seenHole, ahead }) {
  if (status === 'waiting') {
    const trouble = lost.length ? `waiting for ${lost.join(', ')} to connect` : troubleOf({ alarms, lost });
    const text = store ? 'waiting for the new run, picture from before' : 'waiting';
    return [trouble || store ? 'late' : '', trouble || text];
  }
  if (status !== 'live' || !store) return ['lost', words || 'connecting'];
  if (replay.past) return ['late', `replay, first pass, as at ${showClock(replay.past.moment)} · wall to ${showDepth(store.end, view.units, 1)}`];
  if (contents) return ['', `export of ${showClock(contents.made)} · wall ${showSpan(store.span[0], store.span[1], view.units)}`];
  const seconds = ageOf({ newest, lastWrite });
  const fed = received !== null && !ended; // bytes came
  const silent = { received, newest, lastWrite, pace };
  const old = !ended && seconds > LATE;
  const isDead = !ended && !isLate(silent) && isDry({ newest, lastWrite, radii, bitDepth, holeDepth, seenHole });
  const rests = ahead?.hangs && (holeDepth ?? NaN) - (bitDepth ?? NaN) > LIFTED; // then no radius is due
  const drilled = isDead ? `${unused || `no radius ${Number.isFinite(seconds) ? `for ${showAge(seconds)}` : 'since the start'}`}, ${showDepth(missed({ holeDepth, seenHole }), view.units, 1)} drilled` : '';
  const lastRadius = drilled || unused || (old && !isSilent(silent) ? `${rests ? 'at rest, ' : ''}last radius ${showAge(seconds)} old` : '');
  const parts = [];
  if (Number.isFinite(seconds)) parts.push(...(ended ? ['run ended'] : []), lastRadius || `${showAge(seconds)} old`);
  else parts.push(drilled || (fed ? 'no radius since the start' : 'not live'));
  if (bitDepth !== null) parts.push(behind(store, bitDepth, view.units));
  const late = isDead || (!ended && ((old && !lastRadius) || isLate(silent)));
  const trouble = ended ? '' : troubleOf({ alarms, lost }, late && !isDead && bitDepth !== null);
  if (trouble) parts.unshift(trouble);
  else if (late && sources) parts.push(sources);
  if (!Number.isFinite(seconds)) parts.push(`wall ${showSpan(store.span[0], store.span[1], view.units)}`);
  const quiet = alarms.feed.filter((one) => alarms.silenced.includes(one)).length;
  if (quiet) parts.push(`${quiet} silenced`);
  const colour = trouble ? (lost.length ? 'lost' : 'late') : ended || !(fed || Number.isFinite(seconds)) ? '' : late ? 'late' : 'live';
  return [colour, parts.join(' · '), trouble || (late && !isDead ? (bitDepth === null ? 'no new data' : NO_BIT) : lastRadius || (colour === 'live' ? 'live' : parts[0]))];
}

// Return how far the wall is behind the bit or, if the bit was lifted, how far the bit is back in the wall.
/** @param {Store} store @param {number} bitDepth @param {Units} units */
function behind(store, bitDepth, units) {
  const ahead = (bitDepth - store.end) * Math.sign(store.levels[0].pitch);
  return ahead > -LIFTED ? `${showDepth(Math.max(0, ahead), units, 1)} behind bit` : `bit ${showDepth(-ahead, units, 1)} above the end of data`;
}

// Return the values at the cursor in words, for screen readers.
/** @param {App} app */
export function spokenText({ view, selection: { read }, zones }) {
  const values = Object.fromEntries(read);
  const zone = zoneAt(zones, view.cursor?.depth);
  return `${values.MD}, over bit ${values['Over bit radius']}${zone ? `, ${zoneText(zone, view.units)}` : ''}`;
}
