// Small maps beside the hole on its path: the plan, north up, and the side, a vertical section along the hole. Both show the section
// and the cursor on the whole hole, what of the planned path is there and, from the side, the tops where they cross the hole.

import { HEAD, label, PALETTES, SMALL, touch, within } from './layout.js';
import { topPlanes } from './plane_rings.js';
import { scaleBar } from './scale_bar.js';
import { edges, line } from './strokes.js';
import { depthNumber } from './units.js';

const LEAST = 92; // pixels of a side
const FOOT = 24; // pixels below a map, for the bar of its scale
const STEPS = 60; // of the hole and of the section
const POINTS = ['N', 'NNE', 'NE', 'ENE', 'E', 'ESE', 'SE', 'SSE', 'S', 'SSW', 'SW', 'WSW', 'W', 'WNW', 'NW', 'NNW'];

// Return the name of the nearest of sixteen directions.
/** @param {number} azimuth radians */
export const nameOf = (azimuth) => POINTS[((Math.round((azimuth * 8) / Math.PI) % 16) + 16) % 16];

// Draw the plan at the left of the pane, or at the right where the hole or a name is there, and the side where it has room.
/** @param {Ink} ink @param {Looks} look @param {Gpu} gpu @param {Planes} planes */
export function drawMaps(ink, look, gpu, planes) {
  const { view, path, store, rects: { wall } } = look;
  const ends = [view.top, view.bottom].map((depth) => Math.min(store.span[1], Math.max(store.span[0], depth)));
  /** @type {(from: number, to: number) => number[]} */
  const along = (from, to) => Array.from({ length: STEPS + 1 }, (_, i) => from + ((to - from) * i) / STEPS);
  const [whole, part] = [along(store.span[0], store.span[1]), along(ends[0], ends[1])];
  const [a, b] = ends.map((depth) => path.at(depth).centre);
  const towards = Math.atan2(b[1] - a[1], b[0] - a[0]);
  const size = Math.round(Math.max(LEAST, Math.min(0.4 * wall.height, 0.21 * wall.width)));
  const radius = store.bitRadius * view.tubeFactor(store);
  const hole = part.map((depth) => path.at(depth)).flatMap((frame) => [-1, 0, 1].map((side) => gpu.project(frame, wall, gpu.aside(frame, side * radius)))).filter((at) => at !== null);
  /** @param {Pair} corner */
  const boxOf = ([left, top]) => ({ text: '', left, right: left + size, top: top - 16, bottom: top + size + FOOT });
  /** @type {Box[]} */
  const taken = [];
  /** @type {(place: Pair, margin?: number) => boolean} */
  const free = ([left, top]) => {
    const box = boxOf([left, top]);
    return !taken.some((one) => touch(one, box)) && !hole.some(([x, y]) => x > left - 10 && x < left + size + 10 && y > top - 20 && y < box.bottom + 6) && !ink.canvas.labels.some((one) => touch(one, box));
  };
  const first = (ink.canvas.slide ? 0 : HEAD) + 26; // a slide has no controls above the hole
  /** @type {(from: number, to: number) => number[]} */
  const steps = (from, to) => Array.from({ length: Math.max(0, Math.floor((to - from) / 10)) + 1 }, (_, i) => from + 10 * i);
  const columns = steps(wall.left + 10, wall.left + wall.width - size - 10);
  /** @type {Pair[]} */
  const places = [columns[0], columns[columns.length - 1]].map((left) => [left, first]);
  const plan = places.find(free) ?? places[1];
  if (!drawMap(plan, 'plan, N up', ([north, east]) => [east, north], [])) return; // vertical
  taken.push(boxOf(plan));
  const rows = steps(first, wall.height - size - FOOT);
  const beside = [plan[0], ...places.map(([left]) => left), ...columns].flatMap((left) => rows.map((top) => /** @type {Pair} */ ([left, top]))).find(free);
  if (beside) drawMap(beside, `side, ${nameOf(towards + Math.PI)}–${nameOf(towards)}`, ([north, east, down]) => [(north - a[0]) * Math.cos(towards) + (east - a[1]) * Math.sin(towards), -down], topPlanes(look, planes.kept).filter(({ start }) => start > ends[0] && start < ends[1]));

  // Draw one map; `flat` is how many metres to the right and up a place is. Return whether the hole has any extent on it.
  /** @param {Pair} corner @param {string} title @param {(centre: number[]) => Pair} flat @param {Top[]} tops */
  function drawMap([left, top], title, flat, tops) {
    const palette = PALETTES[view.theme];
    const all = whole.map((depth) => flat(path.at(depth).centre));
    const [[x0, x1], [y0, y1]] = [0, 1].map((axis) => [Math.min(...all.map((at) => at[axis])), Math.max(...all.map((at) => at[axis]))]);
    const extent = Math.max(x1 - x0, y1 - y0);
    if (extent < 1) return false;
    const perMetre = (size - 36) / extent; // the depths of its ends have room
    /** @param {number[]} centre @returns {Pair} */
    const spot = (centre) => {
      const [x, y] = flat(centre);
      return [left + size / 2 + (x - (x0 + x1) / 2) * perMetre, top + size / 2 - (y - (y0 + y1) / 2) * perMetre];
    };
    /** @param {number} depth */
    const at = (depth) => spot(path.at(depth).centre);
    ink.fillStyle = `${palette.paper}cc`;
    ink.fillRect(left, top - 16, size, size + 40);
    edges(ink, { left, top, width: size, height: size }, palette.line);
    label(ink, title, left, top - 8, { colour: palette.soft, halo: palette.paper, font: SMALL });
    scaleBar(ink, left + 8, top + size + 18, perMetre, view, palette);
    within(ink, { left, top, width: size, height: size }, () => {
      for (const [points, colour, width, dash] of /** @type {[Pair[], string, number, number[]][]} */ ([[whole.map(at), palette.soft, 1.4, []], [part.map(at), palette.ink, 4, []], [store.plan.map(spot), palette.max, 2, [7, 4]]])) {
        ink.beginPath();
        for (const point of points) ink.lineTo(...point);
        ink.strokeStyle = colour;
        ink.lineWidth = width;
        ink.setLineDash(dash);
        ink.stroke();
      }
      ink.setLineDash([]);
      for (const { start, picked } of tops) { // at the dip that is seen in this section, if it is known
        const [x, y] = at(start);
        const dip = picked ? Math.atan(Math.tan((picked.dip * Math.PI) / 180) * Math.cos((picked.azimuth * Math.PI) / 180 - towards)) : 0;
        const [dx, dy] = [Math.cos(dip), Math.sin(dip)].map((one) => (picked ? 16 : 6) * one);
        line(ink, x - dx, y - dy, x + dx, y + dy, palette.top, [], 2);
      }
    });
    ink.canvas.strokes.push([...at(ends[0]), ...at(ends[1])]);
    for (const depth of ends) {
      const [x, y] = at(depth);
      label(ink, depthNumber(depth, view.units, 0), Math.min(left + size - 16, Math.max(left + 16, x)), y, { colour: palette.ink, halo: palette.paper, align: 'center', font: SMALL, near: [[0, 12], [0, -12], [0, 22], [0, -22]], yields: true });
    }
    for (const { name, start } of size > 1.5 * LEAST ? tops : []) {
      const [x, y] = at(start);
      const right = x < left + size / 2;
      label(ink, name, x + (right ? 20 : -20), y, { colour: palette.top, halo: palette.paper, align: right ? 'left' : 'right', font: SMALL, near: [[0, -3], [0, 9], [0, -14]], yields: true });
    }
    if (view.cursor) {
      ink.fillStyle = palette.cursor;
      ink.beginPath();
      ink.arc(...at(view.cursor.depth), 4, 0, 7);
      ink.fill();
    }
    return true;
  }
}
