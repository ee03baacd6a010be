// Picks as a table, as the package writes and reads it (picks.py).

import { randomKey, Refusal, rules } from './rules.js';
import { quotedCells } from './table.js';

/** @typedef {Record<string, any>} Pick */

/** @param {string} name */
const plain = (name) => name.toLowerCase().replace(/[^a-z]+/g, '_').replace(/^_+|_+$/g, '').replace(/^depth?(?=_)/, 'depth');

/** @param {any} value */
const cell = (value) => (typeof value === 'number' ? String(Number(value.toPrecision(10))) : value ?? '');

// One more apostrophe stands before what a spreadsheet would compute (harmless.py).
/** @param {string} text */
const computed = (text) => new RegExp(`^(?:${rules.picks.formula})`).test(text);

// Return the pick, or raise a Refusal for a value that a pick cannot have.
/** @param {Pick} pick @param {string} place */
export function checked(pick, place) {
  const { limits, classes, texts, longest, defaults } = rules.picks;
  if (!classes.includes(pick.kind)) throw new Refusal(`${place}class = ${String(pick.kind).slice(0, 20)}: must be one of ${classes.join(', ')}`);
  for (const [name, [low, high]] of Object.entries(limits)) {
    if (pick[name] === null && defaults[name] === null) continue;
    if (!(typeof pick[name] === 'number' && pick[name] >= low && pick[name] <= high)) throw new Refusal(`${place}${name} = ${pick[name] ?? ''}: must be ${low} to ${high}`);
  }
  if (pick.kind === 'breakout' && !(pick.height > 0 && pick.opening > 0)) throw new Refusal(`${place}breakout: height and opening must be above 0`);
  if (texts.some((name) => String(pick[name] ?? '').length > longest)) throw new Refusal(`${place}a text must have at most ${longest} characters`);
  return pick;
}

/** @param {string} text */
const harmless = (text) => (computed(text) ? `'${text}` : text);

/** @param {string} text */
const quoted = (text) => (/[",\r\n]/.test(text) ? `"${text.replaceAll('"', '""')}"` : text);

// Return the picks as CSV, sorted by depth. Without a survey no true dip is known.
/** @param {Pick[]} picks */
export function picksTable(picks) {
  const { columns, dips, defaults } = rules.picks;
  const rows = [...picks].sort((a, b) => a.depth - b.depth).map((pick) => [...Object.values(columns).map((name) => quoted(harmless(cell(pick[name] ?? defaults[name])))), ...dips.map(() => '')]);
  return [[...Object.keys(columns), ...dips], ...rows].map((row) => `${row.join(',')}\r\n`).join('');
}

// Return the picks of a table.
/** @param {string} text @returns {Pick[]} */
export function parsePicks(text) {
  const { columns, texts, dips } = rules.picks;
  const known = new Map(Object.entries(columns).map(([name, field]) => [plain(name), field]));
  const [head = '', ...lines] = text.replace(/^\ufeff/, '').split(/\r\n?|\n/);
  const fields = quotedCells(head, ',').map((name) => known.get(plain(name)) ?? '');
  const lacking = ['kind', 'depth', 'toolface', 'apparent_dip'].filter((name) => !fields.includes(name));
  if (lacking.length) throw new Refusal(`line 1: must have the columns ${Object.keys(columns).filter((name) => lacking.includes(columns[name])).join(', ')}${head.includes(dips[0]) ? '; a true dip needs a survey: helibore view --survey FILE' : ''}`);
  /** @type {Pick[]} */
  const picks = [];
  const keys = new Set();
  lines.forEach((line, at) => {
    if (!line.trim()) return;
    const cells = quotedCells(line, ',');
    /** @type {Pick} */
    const pick = { ...rules.picks.defaults };
    fields.forEach((field, column) => {
      const value = cells[column] ?? '';
      if (!field || !value) return;
      if (!texts.includes(field)) pick[field] = Number(value);
      else pick[field] = value.startsWith("'") && computed(value) ? value.slice(1) : value;
    });
    const other = rules.picks.aliases[String(pick.kind).toLowerCase()];
    if (other) Object.assign(pick, { note: pick.note || pick.kind, kind: other });
    checked(pick, `line ${at + 2}: `);
    if (!pick.key || keys.has(pick.key)) pick.key = randomKey();
    keys.add(pick.key);
    picks.push(pick);
  });
  if (picks.length > rules.picks.most) throw new Refusal(`${picks.length} picks: a wall has at most ${rules.picks.most}`);
  return picks;
}

// Return the picks with those of a table: a pick with a known key replaces, one at the place of another is left out.
/** @param {Pick[]} picks @param {Pick[]} others */
export function merged(picks, others) {
  const of = (/** @type {Pick} */ pick, /** @type {string[]} */ names) => JSON.stringify(names.map((name) => cell(pick[name] ?? rules.picks.defaults[name])));
  const all = Object.values(rules.picks.columns);
  const found = new Map(picks.map((pick) => [pick.key, pick]));
  const places = new Set(picks.map((pick) => of(pick, rules.picks.place)));
  /** @type {{ added: string[], replaced: string[] }} */
  const counts = { added: [], replaced: [] };
  for (const pick of others) {
    const old = found.get(pick.key);
    if (old ? of(old, all) !== of(pick, all) : !places.has(of(pick, rules.picks.place))) {
      counts[old ? 'replaced' : 'added'].push(pick.key);
      found.set(pick.key, pick);
    }
    places.add(of(pick, rules.picks.place));
  }
  return { picks: [...found.values()], ...counts, unchanged: others.length - counts.added.length - counts.replaced.length };
}
