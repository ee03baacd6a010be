// The dip of a bed from points picked on the image. In the frame of the hole at the picks' depth (high side, right, along)
// a plane is  along = c + a high + b right,  fitted to the points on the wall, whose places follow from radius and path:
//
//   apparent dip = atan sqrt(a^2 + b^2)      on a round hole of diameter D a sinusoid of height H:  tan = H / D
//   normal       = along - a high - b right, turned upwards;  true dip = its angle from up,  azimuth = direction in which it leans
//
// Three points or more, not all on one side of the hole. The misfit shows how well the points lie in a plane.

import { wrap360 } from './helix.js';
import { loaded } from './late.js';
import { showAzimuth } from './units.js';
import { dot, minus, normalised, scaled } from './vectors.js';

const DEG = 180 / Math.PI;

// Return north, east and down of a point of the wall, metres.
/** @param {Path} path @param {WallPoint} wallPoint */
export function wallPoint(path, { depth, toolface, radius }) {
  const { centre, high, right } = path.at(depth);
  const [c, s] = [Math.cos(toolface / DEG), Math.sin(toolface / DEG)];
  return centre.map((x, i) => x + radius * (c * high[i] + s * right[i]));
}

// Return the plane through points {depth, toolface, radius}, or null if the points do not define a plane. Angles are in
// degrees, lengths in metres; dip and azimuth are NaN without a survey.
/** @param {Path} path @param {WallPoint[]} points @param {PlaneKind} [kind] @returns {Plane | null} */
export function fitPlane(path, points, kind = 'bed') {
  if (points.length < 3) return null;
  const depth = points.reduce((sum, point) => sum + point.depth, 0) / points.length;
  const frame = path.at(depth);
  const local = points.map((point) => {
    const from = minus(wallPoint(path, point), frame.centre);
    return [dot(from, frame.high), dot(from, frame.right), dot(from, frame.tangent)];
  });
  const radius = points.reduce((sum, point) => sum + point.radius, 0) / points.length;
  const solved = leastSquares(local, 1e-3 * radius * radius);
  if (!solved) return null;
  const [a, b, c] = solved;
  const misfit = Math.sqrt(local.reduce((sum, [x, y, z]) => sum + (z - c - a * x - b * y) ** 2, 0) / local.length);
  const plane = { a, b, c, frame: { ...frame, depth }, depth: depth + c, radius, misfit, kind };
  return { ...plane, ...attitude(plane, path.surveyed), apparent: Math.atan(Math.hypot(a, b)) * DEG, deepest: wrap360(Math.atan2(b, a) * DEG) };
}

// Return the plane of a pick, from its apparent dip, the toolface at which it is deepest, and the depth at which it crosses
// the axis of the hole.
/** @param {Path} path @param {PlanePick} pick @param {number} bitRadius @returns {Plane} */
export function planeOf(path, pick, bitRadius) {
  const { depth, kind, misfit = 0, apparent_dip: apparent, toolface: deepest } = pick;
  const slope = Math.tan(apparent / DEG);
  const plane = { a: slope * Math.cos(deepest / DEG), b: slope * Math.sin(deepest / DEG), c: 0, frame: { ...path.at(depth), depth }, depth, radius: pick.radius ?? bitRadius, misfit, kind, pick };
  return { ...plane, ...attitude(plane, path.surveyed), apparent, deepest };
}

const LEVEL = Math.cos(80 / DEG); // a hole that is less than this steep runs along a level bed rather than through it

// Return the level plane through a depth of the hole, for a top whose dip is not known; null where the hole is nearly level itself.
/** @param {Path} path @param {number} depth @param {number} bitRadius @returns {Plane | null} */
export function levelPlane(path, depth, bitRadius) {
  const { high, right, tangent: [, , down] } = path.at(depth);
  if (Math.abs(down) < LEVEL) return null;
  const [a, b] = [-high[2] / down, -right[2] / down];
  return planeOf(path, { key: '', kind: 'bed', depth, apparent_dip: Math.atan(Math.hypot(a, b)) * DEG, toolface: wrap360(Math.atan2(b, a) * DEG) }, bitRadius);
}

// Return the unit normal of a plane, not downwards: north, east and down.
/** @param {Pick<Plane, 'a' | 'b' | 'frame'>} plane */
export function normalOf({ a, b, frame }) {
  const normal = normalised(frame.tangent.map((t, i) => t - a * frame.high[i] - b * frame.right[i]));
  return normal[2] > 0 ? scaled(normal, -1) : normal;
}

/** @param {Pick<Plane, 'a' | 'b' | 'frame'>} plane @param {boolean} surveyed */
function attitude(plane, surveyed) {
  if (!surveyed) return { dip: NaN, azimuth: NaN };
  const up = normalOf(plane);
  const dip = Math.atan2(Math.hypot(up[0], up[1]), -up[2]) * DEG;
  return { dip, azimuth: dip < 1e-3 ? NaN : wrap360(Math.atan2(up[1], up[0]) * DEG) };
}

// Return (a, b, c) of the plane z = c + a x + b y through `rows` of (x, y, z); null if the points, seen along the hole, lie
// nearly on a line.
/** @param {number[][]} rows @param {number} least */
function leastSquares(rows, least) {
  const n = rows.length;
  const mean = [0, 1, 2].map((i) => rows.reduce((sum, row) => sum + row[i], 0) / n);
  const [xx, xy, yy, xz, yz] = [[0, 0], [0, 1], [1, 1], [0, 2], [1, 2]].map(
    ([i, j]) => rows.reduce((sum, row) => sum + (row[i] - mean[i]) * (row[j] - mean[j]), 0) / n,
  );
  const smallest = (xx + yy) / 2 - Math.hypot((xx - yy) / 2, xy); // spread of the points across the hole, in the direction where it is least
  if (smallest < least) return null;
  const d = xx * yy - xy * xy;
  const [a, b] = [(xz * yy - yz * xy) / d, (yz * xx - xz * xy) / d];
  return [a, b, mean[2] - a * mean[0] - b * mean[1]];
}

// Return the depth, at a toolface, at which a plane cuts a round hole; the hole's radius is the one stored in the plane.
/** @param {Path} path @param {Plane} plane @param {number} toolface */
export function planeDepth(path, { a, b, c, frame, radius }, toolface) {
  let depth = NaN;
  let next = frame.depth;
  for (let i = 0; i < 12 && !(Math.abs(next - depth) < 1e-5); i++) {
    depth = next;
    const from = minus(wallPoint(path, { depth, toolface, radius }), frame.centre);
    next = depth - (dot(from, frame.tangent) - c - a * dot(from, frame.high) - b * dot(from, frame.right));
  }
  return next;
}

// Return the plane that the held cursor is on: of those that cross its depth the one whose middle is nearest.
/** @param {Plane[]} planes @param {View} view */
export function heldPlane(planes, { cursor }) {
  if (!cursor) return undefined;
  /** @param {Plane} plane */
  const away = ({ depth }) => Math.abs(depth - cursor.depth);
  return planes.filter((plane) => away(plane) <= riseOf(plane) + 0.02).sort((one, other) => away(one) - away(other))[0];
}

// Return by how much a plane rises above its middle on the wall.
/** @param {Pick<Plane, 'a' | 'b' | 'radius'>} plane */
export const riseOf = ({ a, b, radius }) => radius * Math.hypot(a, b);

const LONGEST = 24; // characters of a note on a picture

// Return the note of a plane's pick and its angles, if asked with their intervals: F1 open 34 ± 2 / 120 ± 5.
/** @param {Plane} plane @param {Path} path @param {boolean} [sure] */
export function anglesOf(plane, path, sure = true) {
  const { dip, azimuth, apparent, deepest, pick } = plane;
  const [angle, towards] = path.surveyed ? [dip, azimuth] : [apparent, deepest];
  const name = pick?.note ? `${pick.note.slice(0, LONGEST)} ` : '';
  const [steep, aside] = (sure && loaded()?.marksOf(plane, path)) || ['', ''];
  return `${name}${angle.toFixed(0)}${steep} / ${showAzimuth(towards)}${aside}`;
}

// Return both azimuths of a breakout's axis as text, '' where they are not known.
/** @param {Path} path @param {number} depth @param {number} [toolface] */
export function axisOf(path, depth, toolface = NaN) {
  const azimuth = path.azimuth(depth, toolface) % 180;
  return Number.isNaN(azimuth) ? '' : [azimuth, azimuth + 180].map((at) => `${showAzimuth(at)}°`).join(' / ');
}

/** @param {Path} path */
export const northOf = ({ north }) => (north ? `${north} north` : 'a north that is not stated');
/** @param {Path} path */
export const northInWords = (path) => northOf(path) + (path.north ? '' : ' (path.north states it)');

// Return what the two angles of planes are.
/** @param {Path} path @param {Plane[]} [planes] */
export const anglesInWords = (path, planes = []) => `${path.surveyed ? `dip / azimuth${path.north ? ` from ${path.north} north` : ', north not stated'}` : 'apparent dip / toolface of the deepest point'}${planes.some(({ pick }) => pick?.dip_sigma) ? ', ± 95 %' : ''}`;
