// What the page without a server reads from files:  node offline_reads.mjs WASM RULES.json BIT FILE ...
// Prints one JSON line a file: the SHA-256 of the radii and of the nearest distances, the number of samples, figures of the whole
// and of a part, curves, zones, and the ends of the colours; or why the file is refused.
import { createHash } from 'node:crypto';
import { readFileSync } from 'node:fs';
import { Core } from '../offline/core.js';
import { setRules } from '../offline/rules.js';
import { glbOf } from '../offline/glb.js';
import { curveBytes, summaryOf } from '../offline/figures.js';
import { historyOf } from '../offline/history.js';
import { sceneOf } from '../offline/scene.js';
import { measure, read, rebuild, reopen, sigmaOf } from '../offline/worker.js';
import { logsText } from '../offline/las_writing.js';

const [wasm, rules, bit, ...files] = process.argv.slice(2);
setRules(JSON.parse(readFileSync(rules, 'utf8')));
const core = await Core.open(readFileSync(wasm));
/** @param {NodeJS.ArrayBufferView} values */
const sum = (values) => createHash('sha256').update(values).digest('hex');
// The binary part of a section as GLB: from the upper third on, or the last 50 m.
/** @param {any} rebuilt @param {number} low @param {number} high */
async function glbSum(rebuilt, low, high) {
  const whole = await glbOf(core, rebuilt, '', Math.max(low + (high - low) / 3, high - 50), high).bytes();
  const text = new DataView(whole.buffer).getUint32(12, true);
  return sum(whole.slice(20 + text));
}
for (const file of files) {
  try {
    const bytes = readFileSync(file);
    const { roles } = read(bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.byteLength), file, core);
    const rebuilt = roles.length ? rebuild(core, roles, Number(bit)) : reopen(core);
    const { vertices, kept, found } = rebuilt;
    const { figures, zones, shape } = measure(core, rebuilt);
    const sigma = sigmaOf(core, rebuilt);
    const [low, high] = figures.ends;
    const summaries = [[-Infinity, Infinity], [low + 0.31 * (high - low), low + 0.77 * (high - low)]].map((ends) => summaryOf(figures, ...ends));
    const curves = Object.fromEntries(figures.curves.map(({ name, low: from, high: to }) => [name, [from, to, sum(new Uint8Array(curveBytes(figures, name)))]]));
    console.log(JSON.stringify({ radius: sum(vertices.radius), nearest: sum(vertices.nearest), measured: sum(vertices.marks.map((mark) => Number(mark === 1))), samples: kept, found, summaries, curves, zones, shape, ranges: sceneOf({ ...rebuilt.helix, bit: rebuilt.bit }, vertices).state.ranges, history: historyOf(rebuilt.samples.depth, rebuilt.samples.time, rebuilt.helix, vertices.radius.length), glb: await glbSum(rebuilt, low, high), las: logsText(figures, low, low + 0.6 * (high - low)), sigma: sigma && sum(sigma), kinds: figures.kinds && sum(figures.kinds), roles: roles.map(({ channel, role }) => [channel, role]) }));
  } catch (error) {
    console.log(JSON.stringify({ refused: error.message, kind: error.constructor.name }));
  }
}
