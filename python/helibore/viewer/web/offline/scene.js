// The wall as the page reads it: handshake, state and the binary messages (protocol.py).

import { randomKey, rint } from './rules.js';
import { FIRST, FRAMES, HEAD, INTERPOLATED, NEAREST, NO_FIRST, RADIUS, STATE, SUPPORT_MASK, SURVEYED, TEXEL, WRITE } from '../src/protocol.js';

const TURNS = 16; // turns of the wall in one ring of the overview
const OVERVIEW_ROWS = 1024;
const TILE_VERTICES = 16384;
const FRAME_STEP = 2; // metres
const FRAMES_A_MESSAGE = 4096;
const NEAREST_UNIT = 1e-4; // metres
const TOP = 0xffff;
const CLIPPED = 0x0400;
const UNCERTAINTY = 12; // the first bit of its level
const [LEAST_UNCERTAINTY, MOST_UNCERTAIN, NORMAL_95] = [0.00025, 15, 1.96]; // metres, level, standard deviations
const FEW_TURNS = 50;
const USUAL_LIMIT = 0.02; // metres

/**
 * @typedef {{ radius: Float64Array, nearest: Float64Array, support: Float64Array, marks: Uint8Array }} Vertices marks: 1 measured, 2 sampled only, 0 neither
 * @typedef {{ well: string, basis: string, basisText: string, reference: string | null, bit: number, startDepth: number, startToolface: number, pitch: number, sectors: number }} Shape
 * @typedef {{ sectors: number, rows: number, texels: Uint16Array, size: number }} Grid
 * @typedef {{ centre: Float64Array, directions: Float32Array, surveyed: boolean }} Frames high and right of each frame
 * @typedef {{ hello: any, state: any, wall: Grid, over: Grid, frames: Frames, ends: number[] }} Scene
 */

// Return the texels of vertices: radius (0 if missing), first-pass radius, nearest distance, state.
/** @param {Vertices} vertices @param {number} unit */
function packed({ radius, nearest, support, marks }, unit) {
  const texels = new Uint16Array(TEXEL * radius.length);
  for (let k = 0; k < radius.length; k++) {
    const at = TEXEL * k;
    const there = Number.isFinite(radius[k]);
    const steps = there ? rint(radius[k] / unit) : 0;
    texels[at + RADIUS] = texels[at + FIRST] = there ? Math.min(Math.max(steps, 1), TOP) : 0;
    texels[at + NEAREST] = Number.isFinite(nearest[k]) ? Math.min(rint(nearest[k] / NEAREST_UNIT), TOP) : TOP;
    texels[at + STATE] = Math.min(support[k], SUPPORT_MASK) | (steps > TOP ? CLIPPED : 0) | (there && marks[k] !== 1 ? INTERPOLATED : 0);
  }
  return texels;
}

// Return the overview: rings of sixteen turns, each cell with the means of an eighth of the circle.
/** @param {Grid} wall @returns {Grid} */
function overviewOf({ sectors, texels, size }) {
  const cells = Math.min(8, sectors);
  const block = TURNS * sectors;
  const rings = Math.ceil(size / block);
  const over = new Uint16Array(TEXEL * rings * cells);
  const firsts = Array.from({ length: cells + 1 }, (_, cell) => Math.ceil((cell * sectors) / cells));
  for (let ring = 0; ring < rings; ring++) {
    for (let cell = 0; cell < cells; cell++) {
      let [sum, count, far, least, between, all, unsure] = [0, 0, 0, SUPPORT_MASK, 0, 0, 0];
      for (let turn = 0; turn < TURNS; turn++) {
        for (let sector = firsts[cell]; sector < firsts[cell + 1]; sector++) {
          all++;
          const k = ring * block + turn * sectors + sector;
          if (k >= size) continue;
          const at = TEXEL * k;
          if (texels[at + RADIUS] > 0) [sum, count] = [sum + texels[at + RADIUS], count + 1];
          far = Math.max(far, texels[at + NEAREST]);
          least = Math.min(least, texels[at + STATE] & SUPPORT_MASK);
          if (texels[at + STATE] & INTERPOLATED) between++;
          unsure = Math.max(unsure, texels[at + STATE] >> UNCERTAINTY);
        }
      }
      const at = TEXEL * (ring * cells + cell);
      over[at + RADIUS] = over[at + FIRST] = count ? sum / count : 0;
      over[at + NEAREST] = far;
      over[at + STATE] = least | (2 * between > all ? INTERPOLATED : 0) | (unsure << UNCERTAINTY);
    }
  }
  return { sectors: cells, rows: OVERVIEW_ROWS, texels: over, size: rings * cells };
}

// Set how sure each radius is, from its standard uncertainty, metres (texels.py).
/** @param {Scene} scene @param {Float64Array} sigma */
export function setTrust(scene, sigma) {
  const { texels } = scene.wall;
  sigma.forEach((value, k) => {
    if (Number.isNaN(value)) return;
    const level = rint(2 * Math.log2(Math.max(NORMAL_95 * value, LEAST_UNCERTAINTY) / LEAST_UNCERTAINTY));
    texels[TEXEL * k + STATE] |= Math.min(Math.max(level, 1), MOST_UNCERTAIN) << UNCERTAINTY;
  });
  scene.over = overviewOf(scene.wall);
}

/** @param {number} bytes @param {number[]} head type, level, mask, tile, first, count, total */
function headed(bytes, [type, level, mask, ...numbers]) {
  const message = new ArrayBuffer(HEAD + bytes);
  const view = new DataView(message);
  view.setUint8(0, type);
  view.setUint8(1, level);
  view.setUint16(2, mask, true);
  numbers.forEach((value, at) => view.setUint32(4 + 4 * at, value, true));
  view.setFloat64(24, Date.now() / 1000, true);
  return message;
}

// Return the depths at which the page wants frames of the path, up to the end of the last tile.
/** @param {Pick<Scene, 'wall' | 'hello'>} scene */
function frameDepths({ wall: { size, sectors, rows }, hello: { start_depth: startDepth, frame_step: step, levels: [{ pitch }] } }) {
  const length = (Math.ceil(size / (rows * sectors)) * rows + 1) * Math.abs(pitch);
  return Float64Array.from({ length: Math.ceil(length / FRAME_STEP) + 2 }, (_, at) => startDepth + at * step);
}

// Return the frames of the path, in messages. A hole without a survey is straight and vertical, toolface 0 to the north.
/** @param {Scene} scene */
export function framesMessages({ frames: { centre, directions, surveyed } }) {
  const total = centre.length / 3;
  /** @type {ArrayBuffer[]} */
  const messages = [];
  for (let first = 0; first < total; first += FRAMES_A_MESSAGE) {
    const count = Math.min(total - first, FRAMES_A_MESSAGE);
    const message = headed(48 * count, [FRAMES, 255, surveyed ? SURVEYED : 0, 0, first, count, total]);
    new Float64Array(message, HEAD, 3 * count).set(centre.subarray(3 * first, 3 * (first + count)));
    new Float32Array(message, HEAD + 24 * count, 6 * count).set(directions.subarray(6 * first, 6 * (first + count)));
    messages.push(message);
  }
  return messages;
}

/** @param {Grid} grid */
export const tilesOf = ({ size, sectors, rows }) => Math.ceil(size / (rows * sectors));

// Return a tile of the wall (level 0) or of its overview (level 1) as a message.
/** @param {Scene} scene @param {number} level @param {number} tile */
export function tileMessage(scene, level, tile) {
  const { texels, size, sectors, rows } = level ? scene.over : scene.wall;
  const begin = tile * rows * sectors;
  const count = Math.min(begin + rows * sectors + sectors + 1, size) - begin;
  const message = headed(6 * count + 2 * (count % 2), [WRITE, level | NO_FIRST, 0, tile, 0, count, size]);
  const sent = new Uint16Array(message, HEAD);
  for (let k = 0; k < count; k++) {
    const at = TEXEL * (begin + k);
    sent[3 * k] = texels[at + RADIUS];
    sent[3 * k + 1] = texels[at + NEAREST];
    sent[3 * k + 2] = texels[at + STATE];
  }
  return message;
}

// Return the message with its sequence number.
/** @param {ArrayBuffer} message @param {number} sequence */
export function numbered(message, sequence) {
  new DataView(message).setUint32(20, sequence, true);
  return message;
}

// Return the value below which a share of sorted values lies; 0 if there is none.
/** @param {Float64Array} sorted @param {number} share */
function percentile(sorted, share) {
  const place = share * (sorted.length - 1);
  const low = Math.floor(place);
  return sorted.length ? sorted[low] + (place - low) * ((sorted[low + 1] ?? sorted[low]) - sorted[low]) : 0;
}

// Return the limit of the scale of a wall: 98 % of the distances from half the bit size lie within, and 99.8 % of the medians of
// each sector in each half metre (color_limits.py).
/** @param {Float64Array} distances @param {number} sectors @param {number} pitch */
function wallLimit(distances, sectors, pitch) {
  const rows = Math.max(Math.round(0.5 / Math.abs(pitch)), 1);
  const parts = Math.floor(distances.length / (rows * sectors));
  const block = new Float64Array(rows);
  const lasting = Float64Array.from({ length: parts * sectors }, (_, at) => {
    const first = Math.floor(at / sectors) * rows * sectors + (at % sectors);
    return block.map((__, row) => distances[first + row * sectors]).sort()[rows >> 1];
  });
  const most = percentile(distances.filter(Number.isFinite).sort(), 0.98);
  return Math.max(symmetricLimit(parts ? lasting : distances, 1e-3), symmetricLimit(new Float64Array([most]), 1e-3));
}

// Return the limit of a scale around 0: `unit` times 1, 2, 3 or 5 times a power of ten; 99.8 % of the values lie within.
/** @param {Float64Array} values @param {number} unit */
function symmetricLimit(values, unit) {
  const there = values.filter(Number.isFinite).map(Math.abs).sort();
  const reach = Math.max(percentile(there, 0.998) / unit, 1);
  const power = 10 ** Math.floor(Math.log10(reach) + 1e-9);
  return unit * power * ([1, 2, 3, 5, 10].find((step) => step * power >= reach * (1 - 1e-9)) ?? 10);
}

/** @param {Float64Array} depths @returns {Frames} */
function straight(depths) {
  const centre = new Float64Array(3 * depths.length);
  const directions = new Float32Array(6 * depths.length);
  depths.forEach((depth, at) => {
    centre[3 * at + 2] = depth;
    directions[6 * at] = directions[6 * at + 4] = 1;
  });
  return { centre, directions, surveyed: false };
}

// Return frames along a path; beyond its ends they go straight on (feed.py).
/** @param {import('./core.js').Core} core @param {import('./worker.js').Survey} survey @returns {(depths: Float64Array) => Frames} */
export const framesAlong = (core, survey) => (depths) => {
  const { settings, stations } = survey;
  const [top, bottom] = [stations.depth[0], stations.depth[stations.depth.length - 1] + settings.extend];
  const inside = depths.map((depth) => Math.min(Math.max(depth, top), bottom));
  const { position, frame } = core.alongPath(survey, inside);
  const directions = new Float32Array(6 * depths.length);
  depths.forEach((depth, at) => {
    for (let axis = 0; axis < 3; axis++) position[3 * at + axis] += (depth - inside[at]) * frame[9 * at + 6 + axis];
    directions.set(frame.subarray(9 * at, 9 * at + 6), 6 * at);
  });
  return { centre: position, directions, surveyed: true };
};

// Return the wall as the page shows it: handshake, state, the wall and its overview in texels.
/** @param {Shape} shape @param {Vertices} vertices @param {(depths: Float64Array) => Frames} [frames] @returns {Scene} */
export function sceneOf(shape, vertices, frames = straight) {
  const { sectors, bit, pitch, startDepth } = shape;
  const unit = bit <= 0.8 ? 1e-5 : 1e-4;
  const rows = 2 ** Math.max(2, Math.min(10, Math.trunc(Math.log2(TILE_VERTICES / sectors))));
  const size = vertices.radius.length;
  const wall = { sectors, rows, texels: packed(vertices, unit), size };
  const over = overviewOf(wall);
  const off = wallLimit(vertices.radius.map((radius) => Math.abs(radius - bit / 2)), sectors, pitch);
  const limit = Math.max(off, size < FEW_TURNS * sectors ? USUAL_LIMIT : 0);
  const hello = {
    type: 'handshake', version: 2, session: randomKey(), well: shape.well, basis: shape.basis, basis_text: shape.basisText, reference: shape.reference, assumed: false,
    bit_diameter: bit, start_depth: startDepth, start_toolface: shape.startToolface, vertices: size, radius_unit: unit, nearest_unit: NEAREST_UNIT,
    levels: [{ sectors, rows, pitch, rings: false }, { sectors: over.sectors, rows: over.rows, pitch: pitch * TURNS, rings: true }],
    frame_step: Math.sign(pitch) * FRAME_STEP, template: null, attributes: [], picks_file: null, saves_picks: true, curves: [],
  };
  const state = {
    type: 'state', begun: true, bit_depth: null, hole_depth: null, newest: null, ended: true, sources: '', true_depth: null,
    ranges: { over: [-limit, limit], radius: [bit / 2 - limit, bit / 2 + limit], nearest: [0, symmetricLimit(vertices.nearest, 1e-3)] },
    zones: [], shape: 'wall', prints: false, meshes: true, alarms: [], lost: [], curves: [], curves_version: 0, now: null,
  };
  return { hello, state, wall, over, frames: frames(frameDepths({ wall, hello })), ends: [startDepth, startDepth + ((size - 1) * pitch) / sectors] };
}
