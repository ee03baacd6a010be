// Planes that were picked, in 3-D and from inside the hole.

import { linesOf } from './dip_ink.js';
import { planeDepth, wallPoint } from './dips.js';
import { BOLD, HEAD, label, PALETTES, within } from './layout.js';
import { showAngle, showDepth } from './units.js';

const LEAST = 70; // pixels across a ring that is named

/** @param {Ink} ink @param {Looks} look @param {Planes} planes @param {Gpu} gpu */
export function drawRings(ink, look, planes, gpu) {
  for (const { plane, colour, stroke } of linesOf(ink, look, planes)) ring(ink, look, plane, colour, stroke, gpu);
}

// Draw a plane in 3-D: from outside a disc wider than the hole, from inside its line on the wall with its dip, so that nothing is veiled.
/** @param {Ink} ink @param {Look} look @param {Plane} plane @param {string} colour @param {() => void} stroke @param {Gpu} gpu */
function ring(ink, { view, path, rects, store, held }, plane, colour, stroke, gpu) {
  const outside = view.camera === 'outside';
  const palette = PALETTES[view.theme];
  const points = Array.from({ length: 73 }, (_, i) => {
    const at = { depth: planeDepth(path, plane, 5 * i), toolface: 5 * i, radius: plane.radius * (outside ? 1.25 : 1) * view.tubeFactor(store) };
    return at.depth < view.top || at.depth > view.bottom ? null : gpu.project({ centre: wallPoint(path, at) }, rects.wall);
  });
  if (outside && points.includes(null)) return; // it leaves the section
  within(ink, { ...rects.wall, top: HEAD, height: rects.wall.height - HEAD }, () => {
    ink.beginPath();
    points.forEach((point, i) => point && ink[points[i - 1] ? 'lineTo' : 'moveTo'](...point));
    if (outside) {
      ink.globalAlpha = 0.25;
      ink.fillStyle = colour;
      ink.fill();
      ink.globalAlpha = 1;
    }
    stroke();
    if (outside) return;
    const angles = path.surveyed && Number.isFinite(plane.azimuth) ? `${plane.dip.toFixed(0)}° to ${showAngle(plane.azimuth, 0)}` : `${plane.apparent.toFixed(0)}° apparent`;
    const lettering = { colour, halo: palette.paper, align: /** @type {const} */ ('center'), font: BOLD, yields: true };
    const seen = points.filter((point) => point !== null);
    const [x, y] = [0, 1].map((axis) => seen.map((point) => point[axis]));
    const small = Math.max(...y) - Math.min(...y) < LEAST; // far away, where angles would cover each other
    const deepest = points[Math.round(plane.deepest / 5)]; // there, not at the top, where the depths of the rings stand
    if (!held || plane.pick !== held.pick) return deepest && !small && label(ink, angles, ...deepest, { ...lettering, near: [[0, 18], [0, -18], [40, 0], [-40, 0]] });
    const left = (Math.min(...x) + Math.max(...x)) / 2;
    return [`${plane.kind} at ${showDepth(plane.depth, view.units)}`, angles].forEach((text, i) => label(ink, text, left, Math.min(Math.max(...y) + 16, rects.wall.height - 60) + 16 * i, { ...lettering, yields: false }));
  });
}
