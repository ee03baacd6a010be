// What the page without a server reads from files:  node offline_reads.mjs WASM RULES.json BIT FILE ...
// Prints one JSON line a file: the SHA-256 of the radii and of the nearest distances, and the number of samples; or why the
// file is refused.
import { createHash } from 'node:crypto';
import { readFileSync } from 'node:fs';
import { Core } from '../offline/core.js';
import { setRules } from '../offline/rules.js';
import { read, rebuild } from '../offline/worker.js';

const [wasm, rules, bit, ...files] = process.argv.slice(2);
setRules(JSON.parse(readFileSync(rules, 'utf8')));
const core = await Core.open(readFileSync(wasm));
/** @param {NodeJS.ArrayBufferView} values */
const sum = (values) => createHash('sha256').update(values).digest('hex');
for (const file of files) {
  try {
    const bytes = readFileSync(file);
    const { roles } = read(bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.byteLength), file);
    const { vertices, samples } = rebuild(core, roles, Number(bit));
    console.log(JSON.stringify({ radius: sum(vertices.radius), nearest: sum(vertices.nearest), measured: sum(vertices.measured), samples: samples.radius.length, roles: roles.map(({ channel, role }) => [channel, role]) }));
  } catch (error) {
    console.log(JSON.stringify({ refused: error.message, kind: error.constructor.name }));
  }
}
