// A section of the wall as binary glTF 2.0, as glb_file.py writes it: quads that share no vertices, each in one colour.

import { lookup } from '../src/color.js';
import { Refusal } from './rules.js';

const MOST_MESHED = 1_000_000; // vertices
const MISSING = -999.25;
const SHADES = 1024;
const CORNERS = [0, 1, 2, 0, 2, 3];
const [JSON_CHUNK, BINARY_CHUNK, GLTF] = [0x4e4f534a, 0x004e4942, 0x46546c67];
const [FLOAT, UNSIGNED_BYTE, UNSIGNED_INT] = [5126, 5121, 5125];
const [ARRAY_BUFFER, ELEMENT_ARRAY_BUFFER] = [34962, 34963];

// Return the vertices whose depths lie in [start, stop): the first, and the one after the last.
/** @param {import('./core.js').Helix} helix @param {number} size @param {number} start @param {number} stop */
function verticesWithin({ startDepth, pitch, sectors }, size, start, stop) {
  const inside = (/** @type {number} */ k) => {
    const depth = startDepth + (k * pitch) / sectors;
    return depth >= start && depth < stop;
  };
  const [low, high] = [start, stop].map((depth) => ((depth - startDepth) / pitch) * sectors).sort((a, b) => a - b);
  let first = Math.max(0, Math.floor(low) - 1);
  let last = Math.min(size, Math.ceil(high) + 2);
  while (first < last && !inside(first)) first++;
  while (last > first && !inside(last - 1)) last--;
  return [first, last];
}

// Return vertex colours, in linear light (glTF 2.0, 3.7.2.1), of values between the least and the greatest.
/** @param {Float64Array} values */
function colours(values) {
  let [low, high] = [Infinity, -Infinity];
  for (const value of values) [low, high] = [Math.min(low, value), Math.max(high, value)];
  if (!(high > low)) high = low + Math.max(Math.abs(low), 1);
  const linear = lookup('viridis', SHADES).map((part, at) => {
    const share = part / 255;
    return at % 4 === 3 ? part : Math.round(255 * (share <= 0.04045 ? share / 12.92 : ((share + 0.055) / 1.055) ** 2.4));
  });
  const shades = new Uint32Array(linear.buffer);
  return Uint32Array.from(values, (value) => shades[Math.round(((value - low) / (high - low)) * (SHADES - 1))]);
}

// Return the wall between two depths as a GLB file.
/** @param {import('./core.js').Core} core @param {import('./worker.js').Rebuilt} rebuilt @param {string} well @param {number} start @param {number} stop */
export function glbOf(core, { helix, vertices: { radius, marks }, survey, basis, bit, arms }, well, start, stop) {
  const { sectors, pitch } = helix;
  if (((stop - start) / Math.abs(pitch)) * sectors > MOST_MESHED) throw new Refusal(`section: has more than ${MOST_MESHED.toLocaleString('en')} vertices: show less, or use helibore mesh`);
  const [first, last] = verticesWithin(helix, radius.length, start, stop);
  const { positions, places, quads } = core.surface(helix, first, radius.slice(first, last + sectors + 1), survey);
  const count = quads.length / 4;
  if (!count) throw new Refusal('the surface has no quads to save');
  // Y is up: east, up, -north.
  const rows = positions.length / 3;
  const local = new Float32Array(positions.length);
  const middle = [[1, 1], [2, -1], [0, -1]].map(([of, sign], axis) => {
    let [least, most] = [Infinity, -Infinity];
    for (let row = 0; row < rows; row++) [least, most] = [Math.min(least, sign * positions[3 * row + of]), Math.max(most, sign * positions[3 * row + of])];
    const half = (least + most) / 2;
    for (let row = 0; row < rows; row++) local[3 * row + axis] = sign * positions[3 * row + of] - half;
    return half;
  });
  const corners = new Float32Array(12 * count);
  const [mean, measured] = [new Float64Array(count), new Float32Array(4 * count)];
  const [least, most] = [[Infinity, Infinity, Infinity], [-Infinity, -Infinity, -Infinity]];
  for (let quad = 0; quad < count; quad++) {
    let sure = true;
    for (let corner = 0; corner < 4; corner++) {
      const row = quads[4 * quad + corner];
      for (let axis = 0; axis < 3; axis++) {
        const value = local[3 * row + axis];
        corners[12 * quad + 3 * corner + axis] = value;
        [least[axis], most[axis]] = [Math.min(least[axis], value), Math.max(most[axis], value)];
      }
      mean[quad] += radius[places[row]];
      sure &&= marks[places[row]] === 1;
    }
    mean[quad] /= 4;
    measured.fill(Number(sure), 4 * quad, 4 * quad + 4);
  }
  const shades = colours(mean);
  const views = [
    { name: 'POSITION', values: corners, type: 'VEC3', component: FLOAT, more: { min: least, max: most } },
    { name: 'COLOR_0', values: Uint32Array.from({ length: 4 * count }, (_, at) => shades[at >> 2]), type: 'VEC4', component: UNSIGNED_BYTE, more: { normalized: true } },
    ...(arms > 1 ? [{ name: '_measured', values: measured, type: 'SCALAR', component: FLOAT, more: {} }] : []),
    { name: '', values: Uint32Array.from({ length: 6 * count }, (_, at) => 4 * Math.floor(at / 6) + CORNERS[at % 6]), type: 'SCALAR', component: UNSIGNED_INT, more: {} },
  ];
  let length = 0;
  const bufferViews = views.map(({ name, values: { byteLength } }) => {
    length += byteLength;
    return { buffer: 0, byteOffset: length - byteLength, byteLength, target: name ? ARRAY_BUFFER : ELEMENT_ARRAY_BUFFER };
  });
  const scene = JSON.stringify({
    asset: { version: '2.0', generator: 'helibore' }, scene: 0, scenes: [{ nodes: [0] }], nodes: [{ name: 'wall', mesh: 0, translation: middle }],
    meshes: [{
      name: 'wall', primitives: [{ attributes: Object.fromEntries(views.flatMap(({ name }, at) => (name ? [[name, at]] : []))), indices: views.length - 1 }],
      extras: { missing: MISSING, basis, units: {}, metadata: { well, bit_diameter: `${bit} m` } },
    }],
    accessors: views.map(({ name, type, component, more }, at) => ({ bufferView: at, componentType: component, count: (name ? 4 : 6) * count, type, ...more })),
    bufferViews, buffers: [{ byteLength: length }],
  });
  const text = new TextEncoder().encode(scene);
  const blanks = -text.length & 3;
  const head = Uint32Array.of(GLTF, 2, 28 + text.length + blanks + length, text.length + blanks, JSON_CHUNK);
  return new Blob([head, text, ' '.repeat(blanks), Uint32Array.of(length, BINARY_CHUNK), ...views.map(({ values }) => /** @type {Uint8Array<ArrayBuffer>} */ (new Uint8Array(values.buffer)))], { type: 'model/gltf-binary' });
}
