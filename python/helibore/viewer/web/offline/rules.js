// The rules for names, units and missing values: the data that the package reads, too (offline_rules.py puts it into the page).

/**
 * @typedef {{ role: string, names?: string[], pattern?: string, described?: string, never?: string, reference?: string, north?: string, angle?: number, arm?: string, reason?: string, unit_stated?: boolean, needs_toolface?: boolean }} NameRule
 * @typedef {{ columns: Record<string, string>, dips: string[], texts: string[], limits: Record<string, [number, number]>, classes: string[], aliases: Record<string, string>, place: string[], most: number, longest: number, formula: string, defaults: Record<string, any> }} PickRules
 * @typedef {{ names: { endings: string[], single: NameRule[], wall: NameRule[], sets: { names: string[][], step: number }[] }, units: Record<string, [string, number]>, roles: Record<string, string>, spellings: string[], ambiguous: string[], nulls: number[], null_texts: string[], small_bits: number[], large_bits: number[], likely_nulls: number[], sizes: [string, number][], measured: number[], left_out: { random: [string, string], targets: number, fewest: number, boxes: number, comparisons: number, normal: number, unmeasured: number }, columns: [name: string, mnemonic: string, unit: string, description: string][], decimals: Record<string, number>, picks: PickRules, bases: Record<string, string> }} Rules
 */

// A reason why a file is refused, with what to do.
export class Refusal extends Error {}

/** @type {Rules} */
export let rules;
/** @param {Rules} given */
export const setRules = (given) => {
  rules = given;
};

// Return what a unit measures (length, angle, time ...) and the factor to metres, degrees or seconds; null: not known.
/** @param {string} unit @returns {[string, number] | null} */
export const unitOf = (unit) => rules.units[unit.toLowerCase().replace(/[ _]/g, '')] ?? null;

// Round halves to even, as NumPy does.
/** @param {number} value */
export function rint(value) {
  const low = Math.floor(value);
  const over = value - low;
  return over < 0.5 || (over === 0.5 && low % 2 === 0) ? low : low + 1;
}

// Return twelve random letters; `crypto.randomUUID` is missing in a file that is opened from disk.
export const randomKey = () => Array.from(crypto.getRandomValues(new Uint8Array(6)), (byte) => byte.toString(16).padStart(2, '0')).join('');

const BRACKETED = /[[(]\s*([^[\]()]+?)\s*[\])]\s*$/;
const NUMBER = /^[+-]?([0-9]+\.?[0-9]*|\.[0-9]+)([eE][+-]?[0-9]+)?$/;

/** @param {string} cell */
export const isNumber = (cell) => NUMBER.test(cell.trim());

// Return the unit at the end of a column name, or ''.
/** @param {string} name */
export function unitInName(name) {
  const bracketed = BRACKETED.exec(name);
  if (bracketed && !/^\d+$/.test(bracketed[1])) return bracketed[1];
  const parts = name.split('_');
  for (let at = 1; at < parts.length; at++) {
    if (!parts.slice(0, at).some(Boolean)) continue;
    const ending = parts.slice(at).join('_');
    if (rules.spellings.includes(ending.toLowerCase()) && !rules.ambiguous.includes(ending.toLowerCase())) return ending;
  }
  const camel = /[a-z](Deg|Rad)$/.exec(name);
  return camel ? camel[1].toLowerCase() : '';
}

// Return whether each cell of a row is a known unit, a dash or blank, and at least one is a unit.
/** @param {string[]} cells */
export function isUnitsRow(cells) {
  const found = cells.map((cell) => cell.replace(/^[()[\] -]+|[()[\] -]+$/g, '').toLowerCase());
  return found.some(Boolean) && found.every((cell) => !cell || rules.spellings.includes(cell));
}
