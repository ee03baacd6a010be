// Tables as text: cells between commas, tabs, semicolons, bars or blanks. What this reader does not read as the package does
// is refused, with the reason.

import { isNumber, isUnitsRow, Refusal, rules, unitInName } from './rules.js';

/**
 * @typedef {{ name: string, unit: string, description: string, values: Float64Array | null, texts: string[] | null, missing: number, odd: boolean }} Channel
 * @typedef {{ format: string, channels: Channel[], rows: number, index: string | null, remarks: string[], header: Record<string, string> }} LogSet
 */

const DELIMITERS = [',', '\t', ';', '|'];
const HEADING_LINES = 500;
const MOST_TITLES = 20;
const EXACT = 2 ** 53;

/** @param {string} line @param {string | null} delimiter @returns {string[]} */
export function splitCells(line, delimiter) {
  if (delimiter === null) {
    if (line.includes('"')) throw new Refusal('cells in quotes between blanks: helibore reads this table on the command line');
    return line.trim().split(/\s+/).filter(Boolean);
  }
  return line.includes('"') ? quotedCells(line, delimiter) : line.split(delimiter);
}

// Cells between quotes may hold the delimiter; two quotes stand for one.
/** @param {string} line @param {string} delimiter */
export function quotedCells(line, delimiter) {
  if ((line.split('"').length - 1) % 2) throw new Refusal(`a quote is opened and not closed: ${line.slice(0, 40)}`);
  const cells = [];
  let [cell, quoted, fresh] = ['', false, true];
  for (let at = 0; at < line.length; at++) {
    const letter = line[at];
    if (quoted) {
      if (letter !== '"') cell += letter;
      else if (line[at + 1] === '"') cell += line[at++];
      else quoted = false;
    } else if (letter === '"' && fresh) [quoted, fresh] = [true, false];
    else if (letter === delimiter) {
      cells.push(cell);
      [cell, fresh] = ['', true];
    } else if (!(fresh && letter === ' ' && line.includes(`${delimiter} "`))) [cell, fresh] = [cell + letter, false];
  }
  return [...cells, cell];
}

// Return a text as UTF-8, else as Windows-1252, without the marks at its ends.
/** @param {ArrayBuffer} bytes */
export function decodeText(bytes) {
  const head = new Uint8Array(bytes, 0, Math.min(4, bytes.byteLength));
  const utf16 = (head[0] === 0xff && head[1] === 0xfe) || (head[0] === 0xfe && head[1] === 0xff);
  let text;
  try {
    text = new TextDecoder(utf16 ? (head[0] === 0xff ? 'utf-16le' : 'utf-16be') : 'utf-8', { fatal: true }).decode(bytes);
  } catch {
    text = new TextDecoder('windows-1252').decode(bytes);
  }
  if (text.slice(0, 1 << 16).includes('\0')) throw new Refusal('this is a binary file: export the log as LAS 2 or CSV; helibore view FILE reads DLIS, LIS and XLSX');
  return `${text.trimEnd()}\n`.split('\u001a\n')[0].replace(/\r\n?/g, '\n'); // Control-Z ended the texts of DOS
}

// Return the lines above the names of the columns: a delimiter cuts only what follows evenly.
/** @param {string[]} lines */
function titlesOf(lines) {
  for (let count = 0; count < Math.min(MOST_TITLES + 1, lines.length - 2); count++) {
    for (const mark of DELIMITERS) {
      const cells = lines.slice(count, count + 20).map((line) => splitCells(line, mark));
      if (cells[0].length > 1 && new Set(cells.map((row) => row.length)).size === 1) {
        return cells[0].some((cell) => isNumber(cell) || !cell.trim()) ? [] : lines.slice(0, count);
      }
    }
  }
  return [];
}

// Return the names of a header whose columns blanks separate; a name may hold a blank: MD (m).
/** @param {string} header @param {number} width */
function namesBetweenBlanks(header, width) {
  const cuts = [header.trim().split(/\s+/), header.match(/\S+(?: [[(][^\])]*[\])])?/g) ?? [], header.trim().split(/\s{2,}|\t/)];
  return cuts.find((names) => names.length === width) ?? cuts[0];
}

/** @param {string[]} rows @returns {string | null} */
function delimiterOf(rows) {
  const sample = rows.slice(0, 20);
  const widths = new Map(DELIMITERS.map((mark) => [mark, sample.map((row) => splitCells(row, mark).length)]));
  /** @param {string} mark */
  const of = (mark) => widths.get(mark) ?? [];
  let even = DELIMITERS.filter((mark) => of(mark)[0] > 1 && new Set(of(mark)).size === 1);
  if (even.length > 1) {
    even = even.filter((mark) => !(mark === ',' && even.includes(';')));
    even.sort((a, b) => of(b)[0] - of(a)[0]);
  }
  if (even.length) return even[0];
  const blanks = new Set(sample.slice(1).map((row) => row.trim().split(/\s+/).length));
  const [width] = blanks;
  if (blanks.size === 1 && width > 1 && namesBetweenBlanks(sample[0], width).length === width) return null;
  const likely = DELIMITERS.reduce((best, mark) => (of(mark)[0] > of(best)[0] ? mark : best));
  if (of(likely)[0] > 1) return likely;
  throw new Refusal('not a table: no comma, tab, semicolon or | separates columns; export the log as CSV or LAS 2');
}

// Find delimiter, names, units and the line of the first row.
/** @param {string} text */
function layoutOf(text) {
  const lines = text.split('\n', HEADING_LINES);
  /** @type {string[]} */
  const remarks = [];
  const stated = /^\s*sep=([,;|\t])\s*$/i.exec(lines[0]);
  let start = stated ? 1 : 0;
  while (start < lines.length && (!lines[start].trim() || lines[start].trimStart().startsWith('#'))) start++;
  let filled = lines.slice(start).filter((line) => line.trim());
  if (!filled.length) throw new Refusal(`no header and no rows within ${HEADING_LINES} lines`);
  const titles = stated ? [] : titlesOf(filled);
  filled = filled.slice(titles.length);
  start = lines.indexOf(filled[0], start);
  const rest = filled.slice(1);
  while (rest.length && rest[0].startsWith('#')) rest.shift();
  const rows = [filled[0], ...rest];
  const delimiter = stated ? stated[1] : delimiterOf(rows);
  const header = rows[0].replace(/^#+/, '');
  const first = delimiter === null ? namesBetweenBlanks(header, rows[rows.length - 1].trim().split(/\s+/).length) : splitCells(header, delimiter).map((cell) => cell.trim());
  const second = rows.length > 1 ? splitCells(rows[1], delimiter).map((cell) => cell.trim()) : [];
  if (first.every(isNumber)) throw new Refusal('the table has no line of names: add one above the numbers, such as depth_m,toolface_deg,radius_mm');
  const names = first.map((cell, at) => cell || `column ${at + 1}`);
  let skip = rows.length > 1 ? lines.indexOf(rows[1], start + 1) : start + 1;
  /** @type {string[] | null} */
  let units = null;
  if (second.length === names.length && isUnitsRow(second)) {
    units = second.map((cell) => cell.replace(/^[()[\] ]+|[()[\] ]+$/g, ''));
    skip = lines.indexOf(rows[1], skip) + 1;
  }
  if (lines.slice(0, start).some((line) => /WELL (KB|DATUM)\b.*:|ANGLES ARE GIVEN IN/i.test(line))) throw new Refusal('a Petrel trace states units in its comments, which this page does not read');
  return { delimiter, names, units, skip, remarks };
}

// Return the names, each repeated one with its number: NAME:1, NAME:2 ...
/** @param {string[]} names */
export function unique(names) {
  const counts = new Map();
  for (const name of names) counts.set(name, (counts.get(name) ?? 0) + 1);
  const taken = new Set(names.filter((name) => counts.get(name) === 1));
  const seen = new Map();
  return names.map((name) => {
    let made = name;
    while (counts.get(name) > 1 && (made === name || taken.has(made))) {
      seen.set(name, (seen.get(name) ?? 0) + 1);
      made = `${name}:${seen.get(name)}`;
    }
    taken.add(made);
    return made;
  });
}

const COMMAS = /^[+-]?(?:[1-9]\d{0,2}(?:[.'’\u00a0\u202f ]\d{3})+|\d+)?(?:,\d*)?(?:[eE][+-]?\d+)?$/;
const POINTS = /^[+-]?(?:[1-9]\d{0,2}(?:[,'’\u00a0\u202f ]\d{3})+|\d+)?(?:\.\d*)?(?:[eE][+-]?\d+)?$/;
const NOT_FINITE = /^[+-]?(nan|inf(inity)?|1\.#\w+)$/i;
const MARKS = /['’\u00a0\u202f ]/g;

// Read the cells of columns: numbers (NaN where a cell is empty or a null), else texts. A table has one decimal mark.
/** @param {string[][]} columns @param {string[]} names @param {boolean} cutByCommas @param {number[]} nulls @param {string[]} remarks @param {boolean} nanMissing @returns {Pick<Channel, 'values' | 'texts' | 'missing' | 'odd'>[]} */
function readColumns(columns, names, cutByCommas, nulls, remarks, nanMissing) {
  const empties = new Set(rules.null_texts);
  /** @param {string} cell */
  const isEmpty = (cell) => empties.has(cell) || /^\*+$/.test(cell);
  const odds = columns.map(() => false);
  /** @type {(Float64Array | null)[]} */
  const plain = columns.map((cells, at) => {
    const values = new Float64Array(cells.length);
    for (let row = 0; row < cells.length; row++) {
      const cell = cells[row].trim();
      if (isNumber(cell)) values[row] = Number(cell);
      else if (NOT_FINITE.test(cell)) [values[row], odds[at]] = [NaN, odds[at] || !nanMissing || !/nan/i.test(cell)];
      else if (isEmpty(cell)) values[row] = NaN;
      else return null;
      if (Math.abs(values[row]) >= EXACT) throw new Refusal(`column ${names[at]} holds ${cell}, too large to be exact here`);
    }
    return values;
  });
  /** @param {string[]} cells */
  const marksOf = (cells) => {
    const filled = cells.map((cell) => cell.trim()).filter((cell) => !isEmpty(cell));
    if (!filled.length || !/\d/.test(filled[0])) return [];
    if (filled.some((cell) => cell.includes(',') && !cell.includes('.')) && filled.some((cell) => cell.includes('.') && !cell.includes(','))) return [];
    return [['.', POINTS], [',', COMMAS]].filter(([, pattern]) => filled.every((cell) => /** @type {RegExp} */ (pattern).test(cell))).map(([mark]) => String(mark));
  };
  const fits = columns.map((cells, at) => (plain[at] ? null : marksOf(cells)));
  const points = plain.some((values) => values?.some((value) => Number.isFinite(value) && value !== Math.round(value)));
  const stated = [...fits.filter((marks) => marks?.length), ...(points ? [['.']] : [])];
  const sure = new Set(stated.flatMap((marks) => (marks?.length === 1 ? marks : [])));
  const [only] = sure;
  const mark = sure.size > 1 ? '' : only ?? (cutByCommas ? '.' : ',');
  /** @type {string[]} */
  const spelled = [];
  return columns.map((cells, at) => {
    let values = plain[at];
    if (!values && fits[at]?.includes(mark)) {
      spelled.push(names[at]);
      values = Float64Array.from(cells, (cell) => {
        const bare = cell.trim();
        if (isEmpty(bare)) return NaN;
        const digits = bare.replace(MARKS, '');
        return Number(mark === '.' ? digits.replaceAll(',', '') : digits.replaceAll('.', '').replaceAll(',', '.'));
      });
      if (spelled.length === 1) remarks.push(`${mark === ',' ? 'decimal commas' : 'marks of thousands'}: ${cells.find((cell) => !/^-?\d*$/.test(cell.trim()))?.trim()} is read as ${values.find((value) => value !== Math.round(value)) ?? values[0]}`);
    }
    if (!values) {
      const texts = cells.map((cell) => (isEmpty(cell.trim()) ? '' : cell));
      return { values: null, texts, missing: texts.filter((cell) => !cell).length, odd: false };
    }
    return { values, texts: null, missing: dropNulls(values, nulls), odd: odds[at] };
  });
}

// Cut rows of text into columns of cells; blank lines are no rows.
/** @param {string} text @param {number} from @param {string[]} names @param {string | null} delimiter @param {boolean} comments */
function columnsOf(text, from, names, delimiter, comments) {
  /** @type {string[][]} */
  const columns = names.map(() => []);
  let line = from;
  for (const row of text.split('\n')) {
    line++;
    if (!row.trim() || (comments && row.trimStart().startsWith('#'))) continue;
    const cells = splitCells(row, delimiter);
    if (cells.length !== names.length) throw new Refusal(`line ${line}: ${cells.length} values where ${names.length} columns are defined`);
    for (let at = 0; at < cells.length; at++) columns[at].push(cells[at]);
  }
  if (!columns[0]?.length) throw new Refusal('no rows below the header');
  return columns;
}

const [NEW_LINE, TAB, BLANK, HASH, PLUS, MINUS, POINT, ZERO, NINE] = ['\n', '\t', ' ', '#', '+', '-', '.', '0', '9'].map((letter) => letter.charCodeAt(0));
const MOST_DIGITS = 15; // so many digits, divided by a power of ten, give the nearest number
const POWERS = Float64Array.from({ length: MOST_DIGITS + 1 }, (_, power) => 10 ** power);

// Read rows of plain numbers and empty cells, as most tables have, in one pass: the numbers that `readColumns` reads. Return null
// if anything else stands there.
/** @param {string} text @param {number} width @param {string | null} delimiter @param {boolean} comments */
function plainColumns(text, width, delimiter, comments) {
  let lines = 1;
  for (let at = text.indexOf('\n'); at >= 0; at = text.indexOf('\n', at + 1)) lines++;
  const columns = Array.from({ length: width }, () => new Float64Array(lines));
  const mark = delimiter === null ? -1 : delimiter.charCodeAt(0);
  const isBlank = (/** @type {number} */ letter) => letter === BLANK || (letter === TAB && mark !== TAB);
  const end = text.length;
  let [rows, at] = [0, 0];
  while (at < end) {
    while (at < end && isBlank(text.charCodeAt(at))) at++;
    const first = at < end ? text.charCodeAt(at) : NEW_LINE;
    if (comments && first === HASH) at = text.indexOf('\n', at) < 0 ? end : text.indexOf('\n', at);
    if (at >= end || text.charCodeAt(at) === NEW_LINE) {
      at++;
      continue;
    }
    for (let column = 0; ; column++) {
      if (column === width) return null;
      while (at < end && isBlank(text.charCodeAt(at))) at++;
      const sign = at < end ? text.charCodeAt(at) : NEW_LINE;
      if (sign === PLUS || sign === MINUS) at++;
      let [value, digits, decimals] = [0, 0, -1];
      for (; at < end; at++) {
        const letter = text.charCodeAt(at);
        if (letter >= ZERO && letter <= NINE) {
          value = 10 * value + letter - ZERO;
          digits++;
          if (decimals >= 0) decimals++;
        } else if (letter === POINT && decimals < 0) decimals = 0;
        else break;
      }
      if (digits > MOST_DIGITS || (!digits && (decimals >= 0 || sign === PLUS || sign === MINUS))) return null;
      const size = decimals > 0 ? value / POWERS[decimals] : value;
      columns[column][rows] = digits ? (sign === MINUS ? -size : size) : NaN;
      while (at < end && isBlank(text.charCodeAt(at))) at++;
      const after = at < end ? text.charCodeAt(at) : NEW_LINE;
      if (after === NEW_LINE) {
        if (column !== width - 1) return null;
        at++;
        break;
      }
      if (delimiter !== null && after !== mark) return null;
      if (delimiter !== null) at++;
      else if (!digits) return null;
    }
    rows++;
  }
  return rows ? columns.map((values) => values.subarray(0, rows)) : null;
}

// Read the rows below a header: numbers, NaN where a cell is empty or a null, else texts.
/** @param {string} text @param {number} from @param {string[]} names @param {string | null} delimiter @param {boolean} comments @param {number[]} nulls @param {string[]} remarks @returns {Pick<Channel, 'values' | 'texts' | 'missing' | 'odd'>[]} */
export function readRows(text, from, names, delimiter, comments, nulls, remarks) {
  const plain = plainColumns(text, names.length, delimiter, comments);
  if (plain) return plain.map((values) => ({ values, texts: null, missing: dropNulls(values, nulls), odd: false }));
  return readColumns(columnsOf(text, from, names, delimiter, comments), names, delimiter === ',', nulls, remarks, comments);
}

// Set the values that mean no value to NaN, and return how many are missing.
/** @param {Float64Array} values @param {number[]} nulls */
function dropNulls(values, nulls) {
  let missing = 0;
  for (let row = 0; row < values.length; row++) {
    if (nulls.includes(values[row])) values[row] = NaN;
    if (Number.isNaN(values[row])) missing++;
  }
  return missing;
}

/** @param {Pick<Channel, 'values' | 'texts'>[]} channels */
export const rowsOf = ([{ values, texts }]) => (values ?? texts)?.length ?? 0;

// Read a delimited table.
/** @param {string} text @returns {LogSet} */
export function readTable(text) {
  const { delimiter, names: given, units, skip, remarks } = layoutOf(text);
  const names = unique(given);
  let below = 0;
  for (let line = 0; line < skip; line++) below = text.indexOf('\n', below) + 1 || text.length;
  const read = readRows(text.slice(below), skip, names, delimiter, false, rules.nulls, remarks);
  const channels = names.map((name, at) => ({ name, unit: (units ? units[at] : unitInName(given[at])).trim(), description: '', ...read[at] }));
  return { format: 'table', channels, rows: rowsOf(read), index: null, remarks, header: {} };
}
