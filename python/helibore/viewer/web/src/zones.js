// Zones of the wall as the server found them (washout, breakout, key seat, undergauge): strips, list, and jumps by severity.

import { BOLD, fitting, inkOn, label, PALETTES, SMALL_BOLD, yOf } from './layout.js';
import { edges } from './strokes.js';
import { showSigned } from './units.js';

export const LETTERS = { washout: 'W', breakout: 'B', 'key seat': 'K', undergauge: 'U' };
// The quantity whose extreme in a zone is `measure`, in short.
export const MEASURES = { washout: 'C2 − bit', breakout: 'C1 − C2', 'key seat': 'height', undergauge: 'least diameter − bit' };
// The same in a driller's words, in rig mode and in alarms.
export const IN_WORDS = { washout: 'over bit size', breakout: 'out of round', 'key seat': 'slot depth', undergauge: 'under bit size' };
const NEAR = 1e-6;
export const FRONT = 270; // degrees from the left edge of the image to the front of the straightened hole that is not turned

// A zone is drawn solid if its kind is sure, else hollow, as on prints. No kind is certain.
const SURE = 0.8;
/** @param {Zone} zone */
export const isSure = ({ confidence }) => confidence >= SURE;
/** @param {Zone} zone */
export const sureText = ({ confidence }) => percent(confidence);
// Nothing is certain.
/** @param {number} share */
export const percent = (share) => `${Math.min(99, Math.round(100 * share))} %`;
/** @param {Zone} zone */
export const sentence = (zone) => `${zone.kind}, ${sureText(zone)} sure`;

// Return the zones, worst first: by severity times the probability of their kind.
/** @param {Zone[]} zones */
export const bySeverity = (zones) => [...zones].sort((a, b) => b.severity * b.confidence - a.severity * a.confidence || a.start - b.start);

const STICKS = 10; // how much more hole that holds the string counts for a driller than hole that is wide

// Return the zones in the order that counts on the rig: hole in which the string may stick before hole that is too wide.
/** @param {Zone[]} zones */
export function byConsequence(zones) {
  /** @param {Zone} zone */
  const weight = ({ kind, severity, confidence }) => severity * confidence * (kind === 'undergauge' || kind === 'key seat' ? STICKS : 1);
  return [...zones].sort((a, b) => weight(b) - weight(a) || a.start - b.start);
}

// Return a test whether `depth` is the middle of a zone, where a jump to the zone puts the cursor.
/** @param {number} depth @returns {(zone: Zone) => boolean} */
const middleOf = (depth) => ({ start, stop }) => Math.abs((start + stop) / 2 - depth) < NEAR;

// Return the zone at a depth; of several, the zone that a jump went to, else the worst.
/** @param {Zone[]} zones @param {number} [depth] */
export function zoneAt(zones, depth = NaN) {
  const around = bySeverity(zones.filter(({ start, stop }) => depth >= start && depth < stop));
  return around.find(middleOf(depth)) ?? around[0] ?? null;
}

// Return the next or previous zone by severity after the zone in the middle of the view; the worst zone if there is none.
/** @param {Zone[]} zones @param {number} depth @param {number} step */
export function jump(zones, depth, step) {
  const sorted = bySeverity(zones);
  const at = sorted.findIndex(middleOf(depth));
  return sorted[at < 0 ? (step > 0 ? 0 : sorted.length - 1) : (at + step + sorted.length) % sorted.length] ?? null;
}

// Return how far the straightened hole must be turned, degrees, so that the side of a zone is in front. Of the two sides of a
// breakout, the nearer one counts. `left`: toolface at the left edge of the image; `before`: how far the hole is turned now.
/** @param {Zone} zone @param {number} left @param {number} before */
export function turnTowards({ kind, toolface }, left, before) {
  if (toolface === undefined) return before;
  /** @param {number} angle */
  const around = (angle) => ((angle % 360) + 360) % 360;
  const front = FRONT - toolface + left;
  const [near, far] = [front, front + 180].map((turn) => around(Math.round(turn)));
  /** @param {number} turn */
  const away = (turn) => Math.abs(around(turn - before + 180) - 180);
  return kind === 'breakout' && away(far) < away(near) ? far : near;
}

/** @param {Zone | null} zone @param {Units} units */
export const zoneText = (zone, units) => (zone ? `${zone.kind} ${showSigned(zone.measure, units, units === 'mm' ? 0 : 1)}, ${sureText(zone)} sure` : 'none');

export const STRIP = 14; // pixels of the strip beside the depths: as wide as the widest letter

// Draw a strip of all zones, `width` wide from `left`; `y` maps a depth to pixels; the strip lies between the pixels `ends`.
/** @param {Ink} ink @param {Zone[]} zones @param {(depth: number) => number} y @param {number} left @param {number} width @param {Pair} ends @param {Palette} palette @param {typeof mark} [draw] */
export function drawZones(ink, zones, y, left, width, [top, bottom], palette, draw = mark) {
  for (const zone of zones) {
    const a = Math.max(top, y(zone.start));
    const b = Math.min(bottom, Math.max(y(zone.stop), a + 2));
    if (b > a) draw(ink, zone, left, a, width, b - a, palette);
  }
}

// Draw the mark of a zone: solid or hollow.
/** @param {Ink} ink @param {Zone} zone @param {number} left @param {number} top @param {number} width @param {number} height @param {Palette} palette */
export function mark(ink, zone, left, top, width, height, palette) {
  ink.fillStyle = palette.zones[zone.kind];
  if (isSure(zone)) return ink.fillRect(left, top, width, height);
  const thick = Math.min(2, width / 3);
  return edges(ink, { left: left + thick / 2, top: top + thick / 2, width: width - thick, height: Math.max(0, height - thick) }, palette.zones[zone.kind], thick);
}

// Name the zones on the image of rig mode, the worst first; they give way to other texts.
/** @param {Ink} ink @param {Look} look */
export function nameZones(ink, { view, zones, rects: { image } }) {
  const palette = PALETTES[view.theme];
  for (const { kind, name = kind, start, stop, measure } of byConsequence(zones)) {
    const y = yOf(view, image, (Math.max(start, view.top) + Math.min(stop, view.bottom)) / 2);
    const size = showSigned(measure, view.units, view.units === 'mm' ? 0 : 1).split(' ')[0];
    ink.font = BOLD;
    if (stop > view.top && start < view.bottom) label(ink, fitting(ink, [`${name} ${size}`, size], image.width), image.left + image.width / 2, y, { colour: palette.ink, halo: palette.paper, align: 'center', font: BOLD, yields: true });
  }
}

// Draw the letters of the strip beside the depths, if there is room; they give way to other texts.
/** @param {Ink} ink @param {Zone[]} zones @param {(depth: number) => number} y @param {number} left @param {Pair} ends @param {Palette} palette */
export const letterZones = (ink, zones, y, left, ends, palette) => drawZones(ink, zones, y, left, STRIP, ends, palette, (_, zone, x, top, wide, tall) => {
  if (tall > 12) label(ink, LETTERS[zone.kind], x + wide / 2, top + tall / 2, { colour: isSure(zone) ? inkOn(palette.zones[zone.kind]) : palette.ink, align: 'center', font: SMALL_BOLD, yields: true });
});
