// The frames of the path: centre, direction of toolface 0 and of toolface 90, one every `step` metres of depth.
// The wall point at (depth, toolface, R) is centre + R (cos(toolface) high + sin(toolface) right), north east down.
//
// In the plane across the hole, up and north are angles on the tool's dial. From the directions of any frame:
//   toolface of up    = atan2(-right.down, -high.down)       undefined where the hole is vertical
//   toolface of north = atan2(right.north, high.north)       undefined where the hole runs north or south

import { wrap360 } from './helix.js';
import { cross, normalised } from './vectors.js';

const DEG = 180 / Math.PI;
const FAINT = Math.sin(1 / DEG); // a direction less than a degree from that of the hole is no reference

export class Path {
  /** @param {number} startDepth @param {number} step @param {string | null} [reference] @param {boolean} [assumed] @param {string} [north] */
  constructor(startDepth, step, reference = null, assumed = false, north = '') {
    this.surveyed = false; // if false, the hole is drawn straight and vertical, and true depth is not known
    this.reference = reference; // the direction of toolface 0, for a hole that is not surveyed
    this.north = north; // that azimuths count from: true, magnetic or grid; '': not stated
    this.assumed = assumed; // nothing states what toolfaces count from
    /** @type {Vector | null} */
    this.trueDepth = null; // [start, stop, down]: where the survey gives true depths, and their zero
    this.startDepth = startDepth;
    this.step = step;
    this.count = 0;
    this.whole = false; // false: more frames are to come
    this.centre = new Float64Array(0);
    this.directions = new Float32Array(0);
    this.version = 0;
  }

  /** @param {Frames} frames */
  apply({ first, count, total, centre, directions, surveyed }) {
    this.surveyed = surveyed;
    if (total * 3 > this.centre.length) {
      const room = Math.max(total, 2 * this.count, 64);
      const [oldCentre, oldDirections] = [this.centre, this.directions];
      this.centre = new Float64Array(3 * room);
      this.directions = new Float32Array(6 * room);
      this.centre.set(oldCentre);
      this.directions.set(oldDirections);
    }
    this.centre.set(centre, 3 * first);
    this.directions.set(directions, 6 * first);
    this.count = Math.max(this.count, first + count);
    this.whole = this.count >= total;
    this.version++;
  }

  // Return the frame at a depth, linear between frames; straight down before any frame has arrived.
  /** @param {number} depth @returns {Frame} */
  at(depth) {
    if (this.count < 2) return { centre: [0, 0, depth], high: [1, 0, 0], right: [0, 1, 0], tangent: [0, 0, 1] };
    const place = Math.min(Math.max((depth - this.startDepth) / this.step, 0), this.count - 1.0001);
    const i = Math.floor(place);
    const t = place - i;
    /** @param {Floats} array @param {number} width @param {number} offset @param {number} n */
    const mix = (array, width, offset, n) =>
      Array.from({ length: n }, (_, j) => {
        const a = array[width * i + offset + j];
        return a + t * (array[width * (i + 1) + offset + j] - a);
      });
    const high = normalised(mix(this.directions, 6, 0, 3));
    const right = normalised(mix(this.directions, 6, 3, 3));
    return { centre: mix(this.centre, 3, 0, 3), high, right, tangent: cross(high, right) };
  }

  // Return the true vertical depth; NaN where the survey does not give one, and above the first and below the last frame.
  /** @param {number} depth */
  tvd(depth) {
    const [start, stop, down] = this.trueDepth ?? [NaN, NaN, NaN];
    const place = (depth - this.startDepth) / this.step;
    const known = depth >= start && depth <= stop && place >= 0 && place <= this.count - 1;
    return known ? this.at(depth).centre[2] - down : NaN;
  }

  // Return why `tvd` is NaN at a depth; '' if no true depth is known at all.
  /** @param {number} depth */
  whyNoTvd(depth) {
    if (!this.trueDepth) return '';
    const place = (depth - this.startDepth) / this.step;
    if (place >= 0 && place <= this.count - 1) return 'beyond the survey';
    return place < 0 === this.step < 0 ? 'below the wall' : 'above the wall';
  }

  // Return the azimuth of the direction at a toolface, of its level part; NaN where it is not known (as Path.azimuth in Python).
  /** @param {number} depth @param {number} toolface */
  azimuth(depth, toolface) {
    if (!this.surveyed) return this.reference === 'north' ? wrap360(toolface) : NaN;
    const { high, right } = this.at(depth);
    const [c, s] = [Math.cos(toolface / DEG), Math.sin(toolface / DEG)];
    const [north, east] = [0, 1].map((i) => c * high[i] + s * right[i]);
    return Math.hypot(north, east) < FAINT ? NaN : wrap360(Math.atan2(east, north) * DEG);
  }

  // Return the toolface of up and that of north at a depth, degrees; null where undefined.
  /** @param {number} depth */
  dial(depth) {
    if (!this.surveyed) return { up: this.reference === 'high-side' ? 0 : null, north: this.reference === 'north' ? 0 : null };
    const frame = this.at(depth);
    /** @param {number} along @param {number} across */
    const angle = (along, across) => (Math.hypot(along, across) < FAINT ? null : Math.atan2(across, along) * DEG);
    return {
      up: angle(-frame.high[2], -frame.right[2]),
      north: angle(frame.high[0], frame.right[0]),
    };
  }
}

// The four ways to cut the wall open: what the left edge is, and the letters along the top from left to right.
/** @type {Record<Cut, { reference: 'up' | 'north', offset: number, letters: string[], label: string }>} */
export const CUTS = {
  top: { reference: 'up', offset: 0, letters: ['U', 'R', 'D', 'L', 'U'], label: 'cut at high side' },
  bottom: { reference: 'up', offset: 180, letters: ['D', 'L', 'U', 'R', 'D'], label: 'cut at low side' },
  north: { reference: 'north', offset: 0, letters: ['N', 'E', 'S', 'W', 'N'], label: 'cut at north' },
  south: { reference: 'north', offset: 180, letters: ['S', 'W', 'N', 'E', 'S'], label: 'cut at south' },
};

const PLACES = Array.from({ length: 21 }, (_, i) => i / 20);

// Return the cuts that are known somewhere along paths: at up and at north with a survey, at north alone where the hole is vertical; without
// a survey, at the reference of toolface 0 or, if that is not known, at the tool's own zero.
/** @param {Path[]} paths @returns {Cut[]} */
export function cutsOf(paths) {
  /** @param {Path} path @returns {('up' | 'north')[]} */
  const known = (path) => {
    if (!path.surveyed) return [path.reference === 'north' ? 'north' : 'up'];
    const leans = !path.whole || PLACES.some((share) => path.dial(path.startDepth + share * (path.count - 1) * path.step).up !== null);
    return leans ? ['up', 'north'] : ['north'];
  };
  const common = /** @type {const} */ (['up', 'north']).filter((one) => paths.every((path) => known(path).includes(one)));
  return /** @type {Cut[]} */ (Object.keys(CUTS)).filter((cut) => (common.length ? common : ['north']).includes(CUTS[cut].reference));
}

// Return the chosen cut, or the first of those that are known.
/** @param {Path[]} paths @param {Cut} chosen */
export function cutFor(paths, chosen) {
  const cuts = cutsOf(paths);
  return cuts.includes(chosen) ? chosen : cuts[0];
}

// Return the toolface at the left edge of the image at a depth, and whether the reference is known there; if it is not, the
// toolface counts from the tool's own zero.
/** @param {Path} path @param {Cut} cut @param {number} depth */
export function leftEdge(path, cut, depth) {
  const { reference, offset } = CUTS[cut];
  const zero = path.dial(depth)[reference];
  return { toolface: (zero ?? 0) + offset, known: zero !== null };
}
