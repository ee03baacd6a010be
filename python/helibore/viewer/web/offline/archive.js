// The archive of a wall (archive.py): a zip file without compression, whose arrays the core unpacks.

import { Refusal } from './rules.js';

const NEWEST = 2; // version
const [LOCAL, CENTRAL, END] = [0x04034b50, 0x02014b50, 0x06054b50];
const TAIL = 22; // bytes of the end record, without a comment
const SAMPLES = /** @type {const} */ (['depth', 'toolface', 'radius']);
const WORD = 8;

/**
 * @typedef {Record<string, any>} Contents
 * @typedef {{ contents: Contents, array: (name: string, type?: string) => Float64Array }} Archive
 */

const damaged = (/** @type {string} */ why) => new Refusal(`truncated or damaged: ${why}`);

const CRCS = Uint32Array.from({ length: 256 }, (_, byte) => {
  let crc = byte;
  for (let bit = 0; bit < 8; bit++) crc = crc & 1 ? 0xedb88320 ^ (crc >>> 1) : crc >>> 1;
  return crc;
});

/** @param {Uint8Array} bytes */
function crcOf(bytes) {
  let crc = 0xffffffff;
  for (let at = 0; at < bytes.length; at++) crc = CRCS[(crc ^ bytes[at]) & 255] ^ (crc >>> 8);
  return (crc ^ 0xffffffff) >>> 0;
}

// Return the members of the directory at the end of the file, by name.
/** @param {DataView} view */
function directory(view) {
  const end = view.byteLength - TAIL;
  if (end < 0 || view.getUint32(end, true) !== END) throw damaged('its directory is missing');
  /** @type {Map<string, { at: number, size: number, crc: number, plain: boolean }>} */
  const members = new Map();
  let at = view.getUint32(end + 16, true);
  for (let left = view.getUint16(end + 10, true); left > 0; left--) {
    if (at + 46 > end || view.getUint32(at, true) !== CENTRAL) throw damaged('its directory');
    const [name, extra, comment] = [28, 30, 32].map((place) => view.getUint16(at + place, true));
    const [packed, size] = [20, 24].map((place) => view.getUint32(at + place, true));
    members.set(new TextDecoder().decode(new Uint8Array(view.buffer, at + 46, name)), { at: view.getUint32(at + 42, true), size, crc: view.getUint32(at + 16, true), plain: view.getUint16(at + 10, true) === 0 && packed === size });
    at += 46 + name + extra + comment;
  }
  return members;
}

// Read an archive; its arrays are unpacked when they are asked for. Whole numbers are returned as floats.
/** @param {ArrayBuffer} buffer @param {import('./core.js').Core} core @returns {Archive} */
export function openArchive(buffer, core) {
  try {
    return opened(buffer, core);
  } catch (error) {
    throw error instanceof Refusal ? error : damaged('its directory');
  }
}

/** @param {ArrayBuffer} buffer @param {import('./core.js').Core} core @returns {Archive} */
function opened(buffer, core) {
  const view = new DataView(buffer);
  const members = directory(view);
  /** @param {string} name */
  const bytesOf = (name) => {
    const member = members.get(name);
    if (!member) throw damaged(`${name} is missing`);
    const { at, size, crc, plain: whole } = member;
    if (!whole) throw damaged(`${name} is compressed`);
    if (at + 30 > view.byteLength || view.getUint32(at, true) !== LOCAL) throw damaged(name);
    const from = at + 30 + view.getUint16(at + 26, true) + view.getUint16(at + 28, true);
    if (from + size > view.byteLength) throw damaged(`${name} is cut off`);
    const bytes = new Uint8Array(buffer, from, size);
    if (crcOf(bytes) !== crc) throw damaged(`${name} has another checksum`);
    return bytes;
  };
  if (!members.has('helibore.json')) throw new Refusal('a zip file, but not the archive of a wall; if it is a workbook, save the sheet as CSV');
  const contents = JSON.parse(new TextDecoder().decode(bytesOf('helibore.json')));
  if (contents.format !== 'helibore wall') throw new Refusal('not the archive of a wall');
  if (contents.version > NEWEST) throw new Refusal(`an archive of version ${contents.version}, written by helibore ${contents.helibore}; this page reads versions up to ${NEWEST}`);
  const plain = contents.version === 1;
  /** @param {string} name */
  const array = (name, type = '<f8') => {
    const bytes = bytesOf(plain ? `${name}.npy` : name);
    const head = 10 + new DataView(bytes.buffer, bytes.byteOffset).getUint16(8, true);
    const header = new TextDecoder('latin1').decode(bytes.subarray(10, head));
    const count = Number(/'shape': \((\d+),\)/.exec(header)?.[1] ?? NaN);
    if (!header.includes(`'descr': '${type}'`) || !(count <= 2 ** 28)) throw damaged(`the header of ${name}`);
    const values = bytes.slice(head);
    const whole = plain ? values.buffer : core.decompress(values, count);
    if (whole === null || (plain && values.length !== count * (type === '<i4' ? 4 : WORD))) throw damaged(`${name} (${count})`);
    if (type === '<f8') return new Float64Array(whole);
    return Float64Array.from(plain && type === '<i4' ? new Int32Array(whole) : new BigInt64Array(whole), Number);
  };
  return { contents, array };
}

// Return the samples of an archive, in order of depth, and those with arm numbers; metres, degrees and seconds.
/** @param {Archive} archive */
export function samplesIn({ contents, array }) {
  const of = (/** @type {'samples' | 'arms'} */ folder) => ({
    .../** @type {import('./core.js').Places} */ (Object.fromEntries(SAMPLES.map((name) => [name, array(`${folder}/${name}`)]))),
    time: contents[folder].includes('time') ? array(`${folder}/time`) : null,
  });
  const arms = contents.arms.length ? { ...of('arms'), arm: array('arms/arm', '<i8'), reach: contents.settings.max_distance ?? Infinity } : null;
  if (contents.samples.length || !arms) return { samples: of('samples'), arms };
  const order = Uint32Array.from(arms.depth.keys()).sort((a, b) => arms.depth[a] - arms.depth[b]);
  const sorted = (/** @type {Float64Array} */ values) => Float64Array.from(order, (row) => values[row]);
  return { samples: { depth: sorted(arms.depth), toolface: sorted(arms.toolface), radius: sorted(arms.radius), time: arms.time && sorted(arms.time) }, arms };
}
