// LAS 2: the header by sections, the rows between blanks.

import { Refusal, rules, unitOf } from './rules.js';
import { readRows, rowsOf, unique } from './table.js';

// MNEM.UNIT  VALUE : DESCRIPTION
const ITEM = /^\s*([^.:]*?|[^\s.:]+:\d+)\s*\.(\S*)(.*)$/;

/** @typedef {{ name: string, unit: string, value: string, description: string }} Item */

/** @param {string} text */
export const isLas = (text) => /^\s*(#[^\n]*\n\s*)*~/.test(text.slice(0, 1 << 16));

/** @param {string[]} lines @param {string} what @returns {Item[]} */
function itemsOf(lines, what) {
  return lines.filter((line) => line.trim() && !line.trimStart().startsWith('#')).map((line) => {
    const match = ITEM.exec(line);
    if (!match) throw new Refusal(`the header is damaged: "${line.trim().slice(0, 40)}" is no item of ${what}`);
    const [, name, unit, rest] = match;
    const colon = rest.lastIndexOf(':');
    const value = colon < 0 ? rest : rest.slice(0, colon);
    return { name: name.trim(), unit, value: value.trim(), description: colon < 0 ? '' : rest.slice(colon + 1).trim() };
  });
}

// Make a comment of the first row, and of the second, if they repeat the names and the units of the curves.
/** @param {{ line: number, lines: string[] }} data @param {Item[]} curves @param {string[]} remarks */
function skipNames({ line, lines }, curves, remarks) {
  const rows = lines.flatMap((row, at) => (row.trim() && !row.trimStart().startsWith('#') ? [at] : [])).slice(0, 2);
  const stated = [curves.map(({ name }) => name), curves.map(({ unit }) => unit).filter(Boolean)];
  for (const [at, row] of rows.entries()) {
    const cells = lines[row].trim().split(/[\s,;]+/).map((cell) => cell.replace(/^["[\]()]+|["[\]()]+$/g, '').toUpperCase());
    if (cells.join(' ') !== stated[at].map((cell) => cell.toUpperCase()).join(' ')) return;
    remarks.push(`line ${line + row + 1} repeats the header: it is no row`);
    lines[row] = `# ${lines[row]}`;
  }
}

// Read a LAS file of version 2.
/** @param {string} text @returns {import('./table.js').LogSet} */
export function readLas(text) {
  /** @type {{ title: string, line: number, lines: string[] }[]} */
  const sections = [];
  text.split('\n').forEach((line, at) => {
    if (/^~|^\s+~[A-Za-z]/.test(line)) sections.push({ title: line.trim().slice(1), line: at + 1, lines: [] });
    else sections[sections.length - 1]?.lines.push(line);
  });
  /** @param {string} letter */
  const section = (letter) => sections.findLast(({ title }) => title.toUpperCase().startsWith(letter) && !title.split(/[\s|]/)[0].includes('_'));
  const version = itemsOf(section('V')?.lines ?? [], '~Version');
  /** @param {Item[]} items @param {string} name */
  const valueOf = (items, name) => items.find((item) => item.name.toUpperCase() === name)?.value ?? '';
  const number = Number(valueOf(version, 'VERS'));
  if (!(number >= 2 && number < 3)) throw new Refusal(`LAS ${valueOf(version, 'VERS') || 'of no stated version'}: this page reads LAS 2; helibore reads it on the command line`);
  if (/^y/i.test(valueOf(version, 'WRAP'))) throw new Refusal('the rows are wrapped over several lines, which this page does not read; helibore reads it on the command line');
  const data = sections.find(({ title }) => /^A[^_]*$/i.test(title.split(/[\s|]/)[0]));
  const curves = itemsOf(section('C')?.lines ?? [], '~Curve');
  if (!data || !curves.length) throw new Refusal(data ? 'the ~Curve section defines no curve' : 'truncated or damaged: no ~A section with rows');
  if (curves.some(({ name, description }) => !name || description.includes('{'))) throw new Refusal('its curves are arrays or have no name, which this page does not read; helibore reads it on the command line');
  const well = itemsOf(section('W')?.lines ?? [], '~Well');
  const names = unique(curves.map(({ name }) => name));
  const stated = valueOf(well, 'NULL').replace(',', '.');
  const nulls = [...rules.nulls, ...(stated && Number.isFinite(Number(stated)) ? [Number(stated)] : [])];
  /** @type {string[]} */
  const remarks = [];
  skipNames(data, curves, remarks);
  const read = readRows(data.lines.join('\n'), data.line, names, null, true, nulls, remarks);
  const channels = curves.map(({ unit, value, description }, at) => {
    const blank = /^[\d./]+$/.test(unit) && unitOf(`${unit} ${value.split(' ')[0]}`); // a blank in the unit: 0.1 in
    return { name: names[at], unit: blank ? `${unit} ${value.split(' ')[0]}` : unit, description, ...read[at] };
  });
  const header = Object.fromEntries(well.map((item) => [item.name.toUpperCase(), item.value]));
  return { format: `LAS ${number.toFixed(1)}`, channels, rows: rowsOf(read), index: names[0], remarks, header };
}
