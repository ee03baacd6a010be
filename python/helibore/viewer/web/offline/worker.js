// The worker: bytes of a file in, columns with roles out; then samples, wall and the messages of the page.

import { Core } from './core.js';
import { isLas, readLas } from './las.js';
import { guess, sectorsOf } from './roles.js';
import { Refusal, rules, setRules } from './rules.js';
import { guessBit, samplesOf } from './samples.js';
import { sceneOf } from './scene.js';
import { decodeText, readTable } from './table.js';

const LARGEST = 512 * 2 ** 20; // bytes of a file
const MOST_VERTICES = 8_000_000;

/** @type {Promise<Core>} */
let core;
/** @type {import('./table.js').LogSet | null} */
let set = null;
let name = '';

// Read a file: what it is, its columns, and their roles with reasons.
/** @param {ArrayBuffer} bytes @param {string} fileName */
export function read(bytes, fileName) {
  set = null;
  name = fileName;
  if (bytes.byteLength > LARGEST) throw new Refusal(`${(bytes.byteLength / 2 ** 20).toFixed(0)} MB: this page reads files of up to ${LARGEST / 2 ** 20} MB; helibore reads larger ones on the command line`);
  const head = new Uint8Array(bytes.slice(0, 4));
  if (head[0] === 0x1f && head[1] === 0x8b) throw new Refusal('the file is gzipped: unpack it first');
  if (head[0] === 0x50 && head[1] === 0x4b) throw new Refusal('an archive or a workbook: save the sheet as CSV');
  const text = decodeText(bytes);
  if (!text.trim()) throw new Refusal('the file is empty');
  const found = isLas(text) ? readLas(text) : readTable(text);
  const image = sectorsOf(found);
  if (image) throw new Refusal(`${image} has numbered columns, an image of sectors, which this page does not read; helibore view FILE does`);
  set = found;
  const roles = guess(found);
  return {
    format: found.format, rows: found.rows, remarks: found.remarks, roles, missing: Object.fromEntries(found.channels.map((channel) => [channel.name, channel.missing])),
    bit: bitOf(roles), well: found.header.WELL ?? '',
  };
}

/** @param {import('./roles.js').Role[]} roles */
export function bitOf(roles) {
  try {
    return set && guessBit(set, roles);
  } catch {
    return null; // a unit is missing: the wall will say it
  }
}

// Rebuild the wall from the columns with these roles.
/** @param {Core} engine @param {import('./roles.js').Role[]} roles @param {number} bit */
export function rebuild(engine, roles, bit) {
  if (!set) throw new Refusal('no file is open');
  if (!(bit >= 0.01 && bit <= 4)) throw new Refusal('the bit size must be a number between 0.01 and 4 m');
  const samples = samplesOf(set, roles, bit);
  const wall = engine.wall({ bit_diameter: bit, most_vertices: MOST_VERTICES });
  try {
    const change = wall.append(samples.depth, samples.toolface, samples.radius, samples.time);
    const { settings, state } = wall;
    const vertices = { radius: wall.column('radius'), nearest: wall.column('nearest'), support: wall.column('support'), measured: wall.measured(rules.measured) };
    return { samples, change, state, settings, vertices };
  } finally {
    wall.close();
  }
}

/** @param {Core} engine @param {import('./roles.js').Role[]} roles @param {number} bit @param {string} well */
function show(engine, roles, bit, well) {
  const { samples, change, state, settings, vertices } = rebuild(engine, roles, bit);
  const basisText = samples.arms > 1 ? 'radius measured by the arms of a caliper' : 'radius measured by an azimuthal caliper';
  const shape = { well: well || name.replace(/\.[^.]*$/, ''), basisText, reference: samples.reference, bit, startDepth: state.start_depth, startToolface: settings.start_toolface, pitch: settings.pitch, sectors: settings.sectors };
  const scene = sceneOf(shape, vertices);
  let [there, sure] = [0, 0];
  for (let k = 0; k < vertices.radius.length; k++) if (Number.isFinite(vertices.radius[k])) [there, sure] = [there + 1, sure + vertices.measured[k]];
  return { ...scene, left: samples.left, kept: samples.radius.length, redundant: change.redundant, arms: samples.arms, between: there ? 1 - sure / there : 0 };
}

/** @param {MessageEvent} event */
async function answer({ data: { id, ask, ...given } }) {
  try {
    let found;
    /** @type {ArrayBuffer[]} */
    let bytes = [];
    if (ask === 'open') {
      setRules(given.rules);
      core = Core.open(given.wasm);
      found = (await core).version;
    } else if (ask === 'read') found = read(given.bytes, given.name);
    else if (ask === 'bit') found = bitOf(given.roles);
    else {
      found = show(await core, given.roles, given.bit, given.well);
      bytes = found.messages;
    }
    postMessage({ id, found }, { transfer: bytes });
  } catch (error) {
    const known = error instanceof Refusal || /** @type {any} */ (error)?.constructor?.name === 'CoreError';
    const message = /** @type {Error} */ (error)?.message ?? String(error);
    postMessage({ id, refused: known ? message : `this page failed on the file (${message}); helibore may read it on the command line` });
  }
}

if (typeof document === 'undefined' && typeof self !== 'undefined') self.onmessage = answer; // in a worker, not in Node.js
