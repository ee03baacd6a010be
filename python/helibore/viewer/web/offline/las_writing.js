// LAS 2 (las_writing.py): the logs of the turns of a section.
// @ts-check
import { Refusal, rules } from './rules.js';

const MISSING = '-999.25';
const STEP_DECIMALS = 5;
const LONGEST_LINE = 256; // characters

/** @param {string} mnemonic @param {string} unit @param {string} value @param {string} description */
const line = (mnemonic, unit, value, description) => `${mnemonic.padEnd(9)}.${unit.toUpperCase().padEnd(5)} ${value.padStart(14)} : ${description}`;

/** @param {number[]} depth */
function stepOf(depth) {
  const step = Number(((depth[depth.length - 1] - depth[0]) / (depth.length - 1)).toFixed(STEP_DECIMALS));
  return depth.length > 1 && depth.every((at, row) => Math.abs(at - depth[0] - step * row) < 10 ** -STEP_DECIMALS) ? step.toFixed(STEP_DECIMALS) : '0';
}

// Return the logs of the turns whose middle lies between two depths.
/** @param {import('./figures.js').Figures} figures @param {number} start @param {number} stop */
export function logsText({ depth, curves, bit, sectors, pitch }, start, stop) {
  const rows = Array.from(depth.keys()).filter((row) => depth[row] >= start && depth[row] <= stop);
  if (!rows.length) throw new Refusal('logs: the wall has no full turn here; show more of it');
  const described = Object.fromEntries(rules.columns.map(([, mnemonic, , description]) => [mnemonic, description]));
  const columns = [{ name: 'DEPT', unit: 'm', values: depth }, ...curves].map(({ name, unit, values }) => {
    const decimals = rules.decimals[unit] ?? rules.decimals.other;
    return { name, unit, texts: rows.map((row) => (Number.isNaN(values[row]) ? MISSING : values[row].toFixed(decimals))) };
  });
  const widths = () => columns.map(({ texts }) => Math.max(...texts.map((text) => text.length)));
  if (widths().reduce((sum, width) => sum + width + 1, -1) > LONGEST_LINE) for (const column of columns) column.texts = column.texts.map((text) => text.replace(/^(-?)0\./, '$1.'));
  const wide = widths();
  const [{ texts: [first], texts }] = columns;
  return [
    '~Version Information', line('VERS', '', '2.0', 'CWLS LOG ASCII STANDARD - VERSION 2.0'), line('WRAP', '', 'NO', 'One line a depth'),
    '~Well Information', line('STRT', 'm', first, 'First depth'), line('STOP', 'm', texts[texts.length - 1], 'Last depth'),
    line('STEP', 'm', stepOf(rows.map((row) => depth[row])), 'Step; 0 if the steps are uneven'), line('NULL', '', MISSING, 'Missing'), line('PROG', '', 'helibore', 'Made by'),
    '~Curve Information', ...columns.map(({ name, unit }) => line(name, unit, '', described[name] ?? '')),
    '~Parameter Information', line('BIT_DIAMETER', 'm', bit.toPrecision(6), 'bit diameter'), line('SECTORS', '', `${sectors}`, 'sectors'), line('PITCH', 'm', `${pitch}`, 'pitch'),
    `~A  ${columns.map(({ name }) => name).join(' ')}`,
    ...rows.map((_, at) => columns.map(({ texts: of }, column) => of[at].padStart(wide[column])).join(' ')), '',
  ].join('\n');
}
