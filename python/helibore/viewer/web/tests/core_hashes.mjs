// Prints the SHA-256 of a wall that the WebAssembly core rebuilds:  node core_hashes.mjs WASM CASE.json
// The kinds of turns are hashed as well; zones are printed. CASE has columns `depth`, `toolface` and `radius`, `settings`, `rule` of the uncertainty, and
// `measured`: what makes a vertex measured.
import { createHash } from 'node:crypto';
import { readFileSync } from 'node:fs';
import { Core } from '../offline/core.js';

const [wasm, file] = process.argv.slice(2);
const { depth, toolface, radius, settings, rule, measured } = JSON.parse(readFileSync(file, 'utf8'));
const core = await Core.open(readFileSync(wasm));
/** @param {Float64Array | Int32Array} values */
const sum = (values) => createHash('sha256').update(values).digest('hex');
try {
  const wall = core.wall({ ...settings, sigma: 1 });
  wall.append(...[depth, toolface, radius].map((values) => Float64Array.from(values)));
  const samples = { depth: wall.samples('depth'), toolface: wall.samples('toolface'), radius: wall.samples('radius') };
  const { pitch, sectors, start_toolface: startToolface, bit_diameter: bit } = wall.settings;
  const { kinds, zones } = core.zones({ startDepth: wall.state.start_depth, startToolface, pitch, sectors }, bit, samples, wall.column('radius'), measured, null);
  const found = { kinds: sum(kinds), zones: zones.map((zone) => Object.values(zone)) };
  console.log(JSON.stringify({ radius: sum(wall.column('radius')), nearest: sum(wall.column('nearest')), sigma: sum(wall.sigma(rule)), version: core.version, ...found }));
} catch (error) {
  console.log(JSON.stringify({ error: error.message }));
}
