// The run against time, above the slider of the replay: depth of the bit, end of the data, and each zone from the moment at
// which the data had reached its end.

import { label, PALETTES, SMALL } from './layout.js';
import { line } from './strokes.js';
import { showDepth } from './units.js';

/** @param {{ ink: Ink, width: number, height: number }} sheet @param {App} app */
export function drawRun({ ink, width, height }, { replay: { points: { time, vertices, bit_depth: bit }, past }, store, view, zones }) {
  if (!past || !width) return;
  const palette = PALETTES[view.theme];
  const reached = vertices.map((count) => store.levels[0].depth(Math.max(0, count - 1)));
  const depths = [...reached, ...bit.filter((depth) => depth !== null)];
  const [top, bottom] = depths.reduce(([least, most], depth) => [Math.min(least, depth), Math.max(most, depth)], [Infinity, -Infinity]);
  const [from, to] = [time[0], time[time.length - 1]];
  /** @param {number} moment */
  const x = (moment) => (width * (moment - from)) / (to - from);
  /** @param {number} depth */
  const y = (depth) => 8 + ((height - 16) * (depth - top)) / Math.max(bottom - top, 1e-9);
  ink.clearRect(0, 0, width, height);
  const down = store.levels[0].pitch > 0;
  for (const { kind, start, stop } of zones) {
    const since = reached.findIndex((depth) => (down ? depth >= stop - 0.5 : depth <= start + 0.5));
    if (since < 0) continue;
    ink.fillStyle = palette.zones[kind];
    ink.globalAlpha = 0.5;
    ink.fillRect(x(time[since]), y(start), width - x(time[since]), Math.max(2, y(stop) - y(start)));
    ink.globalAlpha = 1;
  }
  /** @param {(number | null)[]} depth @param {string} colour @param {number[]} dash */
  const curve = (depth, colour, dash) => {
    ink.beginPath();
    depth.forEach((one, i) => one !== null && ink[i && depth[i - 1] !== null ? 'lineTo' : 'moveTo'](x(time[i]), y(one)));
    Object.assign(ink, { strokeStyle: colour, lineWidth: 1.6 });
    ink.setLineDash(dash);
    ink.stroke();
    ink.setLineDash([]);
  };
  curve(reached, palette.max, [4, 3]);
  curve(bit, palette.ink, []);
  line(ink, x(past.moment), 0, x(past.moment), height, palette.cursor);
  ink.font = SMALL;
  const names = [bit.some((depth) => depth !== null) ? '— bit' : '', '- - data'].filter(Boolean).join('   ');
  label(ink, showDepth(top, view.units, 1), 2, 6, { colour: palette.ink, halo: palette.paper, font: SMALL });
  label(ink, showDepth(bottom, view.units, 1), 2, height - 7, { colour: palette.ink, halo: palette.paper, font: SMALL });
  label(ink, names, width - 2, 6, { colour: palette.soft, halo: palette.paper, align: 'right', font: SMALL });
}
