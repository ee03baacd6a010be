// The string in the hole: rigid bodies, drawn to scale in the straightened hole with the bit or where the user drags them. The
// server gives their clearance, its 95 % interval and the tightest place for each depth of the lower end, as curves.

import { curveAt } from './curves.js';
import { BOLD, fitting, label, PALETTES, within, yOf } from './layout.js';
import { columnScale } from './gpu.js';
import { late } from './late.js';
import { edges, line } from './strokes.js';
import { showDepth, showLength, showSigned } from './units.js';

const ROUNDING = 0.05; // metres: so far below the wall, its end has the same text
const VALUES = ['Clearance', 'Clearance low', 'Clearance high', 'Tightest above bit'];

// Return where the string is, and what is known of it there; null if there is none.
/** @param {App} app @returns {Hung | null} */
export function hung(app) {
  const { string, view, bit, store, curves } = app;
  if (!string) return null;
  const bottom = view.string ?? bit ?? Math.min(store.span[1], view.bottom);
  if (view.rig && string.hanging) return late(app)?.hungInRig(app, bottom) ?? null;
  const [clearance, low, high, above] = VALUES.map((name) => {
    const held = string.why ? null : curves.need(name);
    return held ? curveAt(held, bottom < store.span[1] + ROUNDING ? Math.min(bottom, held.depth[held.depth.length - 1]) : bottom) : NaN;
  });
  return { ...string, bottom, clearance, low, high, tightest: bottom - above };
}

// Whether a body surely does not pass, as far as the uncertainty is known; only then the colour is that of an alarm.
/** @param {{ clearance?: number, high?: number | null }} of */
export const doesNotPass = ({ clearance = NaN, high }) => (Number.isNaN(high ?? NaN) ? clearance : Number(high)) < 0;

// Return the clearance in words.
/** @param {Hung} of @param {Units} units */
export function clearanceText({ why, clearance, low, high }, units) {
  const digits = units === 'mm' ? 1 : 2;
  if (why) return why;
  if (Number.isNaN(clearance)) return 'not measured';
  const sure = Number.isNaN(low) ? 'uncertainty not known' : `${showSigned(low, units, digits).split(' ')[0]} to ${showSigned(high, units, digits)}, 95\u00a0%`;
  const passes = clearance < 0 ? `${doesNotPass({ clearance, high }) ? 'does' : 'may'} not pass: ` : '';
  return `${passes}${showSigned(clearance, units, digits)} (${sure})`;
}

// Return the clearance in a few words, for a narrow hole.
/** @param {Hung} of @param {Units} units */
export function shortText({ clearance, low, high }, units) {
  const [own, least, most] = [clearance, low, high].map((one) => showSigned(one, units, units === 'mm' ? 0 : 1));
  return Number.isNaN(clearance) ? 'not measured' : `${doesNotPass({ clearance, high }) ? 'sticks' : clearance < 0 ? 'may stick' : 'clears'} ${own}${Number.isNaN(low) ? '' : `, ${least.split(' ')[0]} to ${most.split(' ')[0]}`}`;
}

// Return the colour of the clearance: it is too small, may be too small, or is large enough.
/** @param {Hung} of @param {Palette} palette */
const colourOf = ({ clearance, low, high }, palette) => (doesNotPass({ clearance, high }) ? palette.cursor : Math.min(clearance, low) < 0 ? palette.picks['induced fracture'] : Number.isNaN(clearance) ? palette.soft : palette.min);

// Whether a place of the straightened hole is on the string.
/** @param {Look} look @param {number} x @param {number} depth */
export function onString(look, x, depth) {
  const { string, wallRect: { left, width } } = look;
  return Boolean(string?.bodies.some(([diameter, length, position]) => depth < string.bottom - position && depth > string.bottom - position - length && Math.abs(x - left - width / 2) < halfWidth(look, diameter)));
}

// Half the width of a body in pixels, exaggerated as the hole is.
/** @param {Look} look @param {number} diameter */
function halfWidth(look, diameter) {
  const { perMetre, shape } = columnScale(look);
  const bit = look.store.bitRadius;
  return Math.max(2, (bit + (diameter / 2 - bit) * shape) * perMetre);
}

/** @param {Ink} ink @param {Look} look */
export function drawString(ink, look) {
  const { string, view, oldBit, wallRect: rect } = look;
  if (!string) return;
  const palette = PALETTES[view.theme];
  const middle = rect.left + rect.width / 2;
  const colour = colourOf(string, palette); // in rig mode never green: that would say "go"
  within(ink, rect, () => {
    for (const [diameter, length, position] of string.bodies) {
      const half = halfWidth(look, diameter);
      const [a, b] = [string.bottom - position - length, string.bottom - position].map((depth) => yOf(view, rect, depth));
      ink.globalAlpha = oldBit ? 0.1 : 0.35;
      ink.fillStyle = palette.soft;
      ink.fillRect(middle - half, a, 2 * half, b - a);
      ink.globalAlpha = oldBit ? 0.3 : 1;
      edges(ink, { left: middle - half, top: a, width: 2 * half, height: b - a }, palette.ink, 1.4);
    }
    ink.globalAlpha = 1;
    const y = yOf(view, rect, string.tightest);
    const reach = Math.max(...string.bodies.map(([diameter]) => halfWidth(look, diameter)));
    if (!Number.isNaN(y)) line(ink, middle - reach - 8, y, middle + reach + 8, y, colour, [], 5);
    const at = Number.isNaN(y) || y < rect.top + 12 || y > rect.top + rect.height - 12 ? Math.min(rect.top + rect.height - 10, Math.max(rect.top + 12, yOf(view, rect, string.bottom) + 12)) : y - 12;
    ink.font = BOLD;
    if (view.rig) label(ink, string.text ?? '', middle + reach + 8, y - 9, { colour: palette.ink, halo: palette.paper, align: 'right', font: BOLD });
    else label(ink, fitting(ink, [clearanceText(string, view.units), shortText(string, view.units), shortText(string, view.units).split(',')[0]], rect.width - 8), rect.left + 6, at, { colour, halo: palette.paper, font: BOLD });
  });
}

// Return the rows of the read-out.
/** @param {Hung | null} of @param {Units} units */
export function stringRows(of, units) {
  if (!of) return [];
  const where = Number.isNaN(of.tightest) ? [] : [['Tightest at', showDepth(of.tightest, units)]];
  return [[`String to ${showDepth(of.bottom, units, 1)}`, clearanceText(of, units)], ...where, ['Widest body', showLength(Math.max(...of.bodies.map(([diameter]) => diameter)), units, units === 'mm' ? 0 : 2)]];
}
