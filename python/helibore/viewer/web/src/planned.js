// The planned path beside the hole, dashed, with how far the hole is off it.

import { BOLD, HEAD, inside, label, PALETTES } from './layout.js';
import { showDepth } from './units.js';
import { cross, dot, length, minus, normalised, plus, scaled } from './vectors.js';

const STEPS = 60; // of the section, between which path and hole are straight
const DASHES = [7, 4];

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

// Return how far the hole is off its plan at a depth, metres, and to which sides, as one sees them who looks down the hole; null where
// that is not known.
/** @param {Pick<Look, 'path'> & { store: Pick<Store, 'plan'> }} look @param {number} depth */
export function offPlan({ path, store: { plan } }, depth) {
  const { centre, tangent } = path.at(depth);
  const away = fromPlan(plan, centre);
  if (!away) return null;
  const up = minus([0, 0, -1], scaled(tangent, -tangent[2]));
  if (length(up) < 0.02) return { away: length(away), sides: [] }; // vertical: no side is the upper one
  const above = dot(away, normalised(up));
  const right = dot(away, cross(tangent, normalised(up)));
  const sides = /** @type {[number, string][]} */ ([[above, above > 0 ? 'to the high side' : 'to the low side'], [right, right > 0 ? 'right' : 'left']]);
  return { away: length(away), sides: sides.map(([far, side]) => /** @type {[number, string]} */ ([Math.abs(far), side])) };
}

// Return how far the hole is off its plan along the whole wall, where that is known.
/** @param {Pick<Look, 'path' | 'store'>} look */
const offAlong = (look) => {
  const [top, bottom] = look.store.span;
  return Array.from({ length: STEPS + 1 }, (_, i) => top + ((bottom - top) * i) / STEPS).flatMap((depth) => {
    const off = offPlan(look, depth);
    return off ? [{ ...off, depth }] : [];
  });
};

// Return in words how far the hole is off its plan where the wall ends, and where it is farthest.
/** @param {Look} look */
export function planInWords(look) {
  const { units } = look.view;
  const all = offAlong(look);
  if (!all.length) return [];
  const [end, most] = [all[all.length - 1], all.reduce((far, one) => (one.away > far.away ? one : far))];
  /** @param {typeof end} of */
  const away = ({ depth, away: far }) => `${showDepth(far, units, 1)} from the planned path at ${showDepth(depth, units, 0)}`;
  const parts = end.sides.filter(([far]) => far >= 0.05).map(([far, side]) => `${showDepth(far, units, 1)} ${side}`).join(', ');
  return [away(end), ...(parts ? [`there ${parts}, looking downhole`] : []), ...(most.away - end.away < 0.05 ? [] : [`at most ${away(most)}`])];
}

// Draw what of the planned path is beside the section, between the points that are nearest to its ends: over the hole, which is drawn
// too wide and would hide it. Where the hole is farthest from it in the section, a line across shows how far.
/** @param {Ink} ink @param {Look} look @param {Gpu} gpu */
export function drawPlan(ink, look, gpu) {
  const { view, path, store: { plan: points, span }, rects: { wall: rect } } = look;
  const [top, bottom] = [Math.max(view.top, span[0]), Math.min(view.bottom, span[1])];
  const palette = PALETTES[view.theme];
  const [a, b] = [top, bottom].map((depth) => {
    const { centre } = path.at(depth);
    const away = points.map((point) => length(minus(point, centre)));
    return away.indexOf(Math.min(...away));
  });
  const beside = points.slice(Math.max(0, Math.min(a, b) - 1), Math.max(a, b) + 2);
  const seen = beside.slice(1).flatMap((point, i) => {
    const along = minus(point, beside[i]);
    const steps = Math.max(1, Math.ceil((STEPS * length(along)) / view.length));
    return Array.from({ length: steps + (i === beside.length - 2 ? 1 : 0) }, (_, n) => gpu.project({ centre: plus(beside[i], along, n / steps) }, rect));
  });
  const far = offAlong(look).filter(({ depth }) => depth >= top && depth <= bottom).reduce((/** @type {{ away: number, depth: number } | null} */ most, one) => (one.away > (most?.away ?? 0) ? one : most), null);
  const centre = far && path.at(far.depth).centre;
  const across = centre ? [centre, minus(centre, fromPlan(points, centre) ?? [0, 0, 0])].map((place) => gpu.project({ centre: place }, rect)) : [];
  for (const [colour, wide] of /** @type {[string, number][]} */ ([[palette.paper, 2], [palette.max, 0]])) {
    ink.strokeStyle = colour;
    ink.setLineDash(DASHES);
    ink.lineWidth = 2.4 + wide;
    ink.beginPath();
    seen.forEach((at, i) => at && ink[seen[i - 1] ? 'lineTo' : 'moveTo'](...at));
    ink.stroke();
    ink.setLineDash([]);
    ink.beginPath();
    for (const at of across) if (at) ink.lineTo(...at);
    ink.stroke();
  }
  const [, plan] = across;
  const whole = { left: rect.left + 110, top: HEAD, width: rect.width - 110, height: rect.height - HEAD - 40 }; // where a name at the left is not cut
  const last = seen.filter((at) => at !== null).findLast((at) => inside(whole, ...at));
  return () => {
    const lettering = { colour: palette.max, halo: palette.paper, font: BOLD };
    if (far && plan && inside(whole, ...plan)) label(ink, showDepth(far.away, view.units, 1), plan[0] - 8, plan[1] + 2, { ...lettering, align: 'right', near: [[0, 0], [0, 12], [0, -12], [0, 24]], yields: true, margin: 1 });
    if (last) label(ink, 'planned path', last[0] - 10, last[1], { ...lettering, align: 'right', near: [[0, 0], [0, 12], [0, -12]], yields: true });
  };
}
