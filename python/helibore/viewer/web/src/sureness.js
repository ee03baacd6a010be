// How sure the attitude of a picked plane is. By hand a point is off by some pixels of the screen, along the hole and around it; the
// misfit of many points may show more, and their order how many of them are off together. For an error v of each point, the slopes
// x of a least-squares fit have the covariance (X'X)^-1 X' v X (X'X)^-1.

import { normalOf, planeDepth } from './dips.js';

const RAD = Math.PI / 180;
const HAND = 1.6; // pixels that a point is off in each direction, standard deviation
const AROUND = [0, 120, 240]; // where a plane that was drawn without points is held, as if it had been marked there
const ALONE = 6; // so few points are off each by itself
const MOST = { dip: 90, toolface: 180 };
const FAR = 0.6; // radians: a dip that is no surer shows no direction
export const SURE = 1.96; // standard deviations of an interval of 95 %

// Return the standard uncertainties, degrees, of the apparent dip and of the toolface where the plane is deepest; a pixel is so many
// metres along the hole and degrees around it. Without points the plane was drawn by hand.
/** @param {Path} path @param {Plane} plane @param {WallPoint[]} points @param {[number, number]} pixel */
export function surenessOf(path, plane, points, [along, around]) {
  const { radius, deepest, apparent } = plane;
  const slope = Math.tan(apparent * RAD);
  const angles = points.length ? points.map(({ toolface }) => (toolface - deepest) * RAD) : AROUND.map((angle) => angle * RAD);
  const rows = angles.map((angle) => [1, radius * Math.cos(angle), radius * Math.sin(angle)]);
  const each = angles.map((angle) => (HAND * along) ** 2 + (HAND * around * RAD * radius * slope * Math.sin(angle)) ** 2);
  /** @type {(weights: number[]) => number[][]} */
  const product = (weights) => [0, 1, 2].map((i) => [0, 1, 2].map((j) => rows.reduce((sum, row, n) => sum + weights[n] * row[i] * row[j], 0)));
  const inverse = inverted(product(rows.map(() => 1)));
  const middle = product(each);
  /** @param {number} i */
  const variance = (i) => inverse[i].reduce((sum, one, j) => sum + one * middle[j].reduce((of, two, k) => of + two * inverse[k][i], 0), 0);
  const times = points.length > 3 ? worse(path, plane, points, each) : 1;
  const [steeper, aside] = [1, 2].map((i) => Math.sqrt(times * variance(i)));
  return {
    dip_sigma: Math.min(MOST.dip, steeper / (1 + slope * slope) / RAD),
    toolface_sigma: Math.min(MOST.toolface, aside / Math.max(slope, 1e-9) / RAD),
  };
}

// Return how many times greater the variance is than by `each` point alone: by their misfit, and because neighbours are off together.
/** @param {Path} path @param {Plane} plane @param {WallPoint[]} points @param {number[]} each */
function worse(path, plane, points, each) {
  const off = points.map(({ toolface, depth }) => ({ toolface: ((toolface % 360) + 360) % 360, away: depth - planeDepth(path, plane, toolface) })).sort((a, b) => a.toolface - b.toolface).map(({ away }) => away);
  const n = off.length;
  const squares = off.reduce((sum, one) => sum + one * one, 0);
  const misfit = (squares / (each.reduce((sum, one) => sum + one, 0) / n) + ALONE) / (n - 3 + ALONE); // that of few points shows little
  if (n <= ALONE) return Math.max(1, misfit);
  let together = 1;
  for (let step = 1; step < n / 3; step++) {
    const alike = off.reduce((sum, one, i) => sum + one * off[(i + step) % n], 0) / squares;
    if (!(alike >= 0.05)) break; // nor where all points lie in the plane
    together += 3 * alike; // not 2: the fit takes a part of what they have in common
  }
  return Math.max(1, misfit) * Math.min(n / 3, together);
}

/** @param {number[][]} of symmetric, three by three */
function inverted([[a, b, c], [, d, e], [, , f]]) {
  const [A, B, C, D, E, F] = [d * f - e * e, c * e - b * f, b * e - c * d, a * f - c * c, b * c - a * e, a * d - b * b];
  const by = 1 / (a * A + b * B + c * C);
  return [[A, B, C], [B, D, E], [C, E, F]].map((row) => row.map((one) => one * by));
}

// Return half an interval of 95 % of the true dip and of its azimuth, degrees; without a survey of the apparent dip and the toolface.
// null where it is not known how sure the pick is.
/** @param {Plane} plane @param {boolean} surveyed @returns {Pair | null} */
export function intervalsOf(plane, surveyed) {
  const { dip_sigma: dip, toolface_sigma: toolface } = plane.pick ?? plane;
  if (dip === undefined || dip === null || toolface === undefined || toolface === null) return null;
  if (!surveyed) return [SURE * dip, Math.min(MOST.toolface, SURE * toolface)];
  const { apparent, deepest, frame, azimuth } = plane;
  const slope = Math.tan(apparent * RAD);
  const steeper = dip * RAD * (1 + slope * slope);
  const aside = toolface < MOST.toolface ? toolface * RAD * slope : steeper;
  const [north, east] = [Math.cos((azimuth || 0) * RAD), Math.sin((azimuth || 0) * RAD)];
  const [c, s] = [Math.cos(deepest * RAD), Math.sin(deepest * RAD)];
  /** @param {number} more @param {number} across */
  const tilt = (more, across) => {
    const [n, e, d] = normalOf({ a: (slope + more) * c - across * s, b: (slope + more) * s + across * c, frame });
    return [n * north + e * east, e * north - n * east, -d];
  };
  const [level, , up] = tilt(0, 0);
  const ends = [[steeper, 0], [0, aside]].map((way) => [-SURE, SURE].map((times) => {
    const [along, across, high] = tilt(times * way[0], times * way[1]);
    const side = along * level + high * up < 0 ? -1 : 1; // a normal that was turned past level is the other one of its plane
    return [Math.abs(Math.atan2(side * along, side * high) - Math.atan2(level, up)), Math.abs(across)];
  }));
  const [dipped, turned] = [0, 1].map((i) => Math.hypot(...ends.map((way) => Math.max(...way.map((end) => end[i])))));
  const likely = Math.sqrt(Math.max(0, level * level - turned * turned / 2)); // errors make a dip look steeper
  return [Math.min(MOST.dip, dipped / RAD), turned < likely && dipped < FAR ? Math.asin(turned / likely) / RAD : MOST.toolface];
}

// Return what follows a dip and its direction in a text: their intervals, '' where these are not known.
/** @param {Plane} plane @param {Path} path @returns {[string, string]} */
export function marksOf(plane, { surveyed }) {
  const [steep, towards] = intervalsOf(plane, surveyed) ?? [];
  return steep === undefined || towards === undefined ? ['', ''] : [` ± ${Math.ceil(steep)}`, towards > 90 ? ' or any' : ` ± ${Math.ceil(towards)}`];
}
