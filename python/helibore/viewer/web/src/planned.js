// The planned path beside the hole: dashed, and dotted where the hole hides it, with how far the hole is off it.

import { PALETTES } from './layout.js';
import { showDepth } from './units.js';
import { cross, dot, length, minus, normalised, plus, scaled } from './vectors.js';

const STEPS = 60; // of the section, between which path and hole are straight
const [DASHED, DOTTED] = [[7, 4], [1, 4]];

// Return the way from a line through points to a place; null before its first and beyond its last point.
/** @param {number[][]} points @param {number[]} place @returns {Vector | null} */
export function fromPlan(points, place) {
  /** @type {{ away: Vector, beyond: boolean } | undefined} */
  let best;
  points.slice(1).forEach((point, i) => {
    const [along, to] = [minus(point, points[i]), minus(place, points[i])];
    const share = dot(along, to) / dot(along, along);
    const away = minus(to, scaled(along, Math.min(1, Math.max(0, share))));
    if (!best || length(away) < length(best.away)) best = { away, beyond: (i === 0 && share < 0) || (i === points.length - 2 && share > 1) };
  });
  return !best || best.beyond ? null : best.away;
}

// Return how far the hole is off its plan at a depth, metres, and to which sides of it; null where that is not known.
/** @param {Pick<Look, 'path'> & { store: Pick<Store, 'plan'> }} look @param {number} depth */
export function offPlan({ path, store: { plan } }, depth) {
  const { centre, tangent } = path.at(depth);
  const away = fromPlan(plan, centre);
  if (!away) return null;
  const up = minus([0, 0, -1], scaled(tangent, -tangent[2]));
  if (length(up) < 0.02) return { away: length(away), sides: [] }; // vertical: no side is the upper one
  const above = dot(away, normalised(up));
  const right = dot(away, cross(tangent, normalised(up)));
  const sides = /** @type {[number, string][]} */ ([[above, above > 0 ? 'above' : 'below'], [right, right > 0 ? 'right' : 'left']]);
  return { away: length(away), sides: sides.map(([far, side]) => /** @type {[number, string]} */ ([Math.abs(far), side])) };
}

// Return in words how far the hole is off its plan where the wall ends, and where it is farthest.
/** @param {Look} look */
export function planInWords(look) {
  const { view: { units }, store: { span } } = look;
  const all = Array.from({ length: STEPS + 1 }, (_, i) => span[0] + ((span[1] - span[0]) * i) / STEPS).flatMap((depth) => {
    const off = offPlan(look, depth);
    return off ? [{ ...off, depth }] : [];
  });
  const [end, most] = [all[all.length - 1], all.reduce((far, one) => (one.away > far.away ? one : far), all[0])];
  /** @param {typeof end} of */
  const words = ({ depth, away, sides }) => {
    const parts = sides.filter(([far]) => far >= 0.05).map(([far, side]) => `${showDepth(far, units, 1)} ${side}`).join(', ');
    return [`${showDepth(away, units, 1)} off it at ${showDepth(depth, units, 0)}`, ...(parts ? [`there ${parts}`] : [])];
  };
  const [first, ...sides] = end ? words(end) : [];
  return ['dashed: planned path', ...(!end ? [] : most.away - end.away < 0.05 ? [`${first}, the most`, ...sides] : [first, ...sides, `at most ${words(most)[0]}`])];
}

// Draw what of the planned path is beside the section, between the points that are nearest to its ends.
/** @param {Ink} ink @param {Look} look @param {Gpu} gpu */
export function drawPlan(ink, look, gpu) {
  const { view, path, store: { plan: points }, rects: { wall: rect } } = look;
  const [a, b] = [view.top, view.bottom].map((depth) => {
    const { centre } = path.at(depth);
    const away = points.map((point) => length(minus(point, centre)));
    return away.indexOf(Math.min(...away));
  });
  const beside = points.slice(Math.max(0, Math.min(a, b) - 1), Math.max(a, b) + 2);
  const fine = beside.slice(1).flatMap((point, i) => {
    const along = minus(point, beside[i]);
    const steps = Math.max(1, Math.ceil((STEPS * length(along)) / view.length));
    return Array.from({ length: steps + (i === beside.length - 2 ? 1 : 0) }, (_, n) => plus(beside[i], along, n / steps));
  });
  const hides = hiddenBy(look, gpu);
  const seen = fine.map((centre) => ({ at: gpu.project({ centre }, rect), hidden: hides(gpu.position({ centre }), gpu.project({ centre }, rect)) }));
  ink.strokeStyle = PALETTES[view.theme].max;
  for (const hidden of [true, false]) {
    ink.setLineDash(hidden ? DOTTED : DASHED);
    ink.lineWidth = hidden ? 1.5 : 2;
    ink.beginPath();
    seen.forEach((one, i) => {
      const before = seen[i - 1];
      if (!one.at || !before?.at || one.hidden !== hidden) return;
      if (i < 2 || seen[i - 1].hidden !== hidden || !seen[i - 2].at) ink.moveTo(...before.at);
      ink.lineTo(...one.at);
    });
    ink.stroke();
  }
  ink.setLineDash([]);
}

// Return whether the hole, as wide as it is drawn, hides a place of the scene that is seen at `at`: the place is in it or behind it.
/** @param {Look} look @param {Gpu} gpu @returns {(place: Vector, at: Pair | null) => boolean} */
export function hiddenBy({ view, path, store, rects: { wall: rect } }, gpu) {
  const radius = store.bitRadius * view.tubeFactor(store);
  const [top, bottom] = [Math.max(view.top, store.span[0]), Math.min(view.bottom, store.span[1])];
  const axis = Array.from({ length: STEPS + 1 }, (_, i) => path.at(top + ((bottom - top) * i) / STEPS)).flatMap((frame) => {
    const [at, edge] = [gpu.project(frame, rect), gpu.project(frame, rect, gpu.aside(frame, radius))];
    return at && edge ? [{ at, wide: Math.hypot(edge[0] - at[0], edge[1] - at[1]), far: length(minus(gpu.position(frame), gpu.camera.position)) }] : [];
  });
  return (place, at) => {
    if (!at) return false;
    const far = length(minus(place, gpu.camera.position));
    return axis.slice(1).some((next, i) => {
      const one = axis[i];
      const [x, y] = [next.at[0] - one.at[0], next.at[1] - one.at[1]];
      const share = ((at[0] - one.at[0]) * x + (at[1] - one.at[1]) * y) / (x * x + y * y || 1);
      if (share < 0 || share > 1) return false;
      const away = Math.hypot(at[0] - one.at[0] - share * x, at[1] - one.at[1] - share * y) / one.wide;
      return away < 1 && far > one.far + share * (next.far - one.far) - radius * Math.sqrt(1 - away * away);
    });
  };
}
