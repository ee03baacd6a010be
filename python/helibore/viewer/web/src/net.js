// The picks in view as a stereonet (poles of planes on the lower hemisphere, equal area, north up) and as a rose (dip
// azimuths of planes; both ends of breakout axes, from north). Without a survey the angles of both count from toolface 0.

import { symbol } from './dip_ink.js';
import { wrap360 } from './helix.js';
import { label, PALETTES, SMALL } from './layout.js';
import { northInWords, northOf } from './dips.js';

const RAD = Math.PI / 180;
const SECTOR = 15; // degrees of the rose

// Return where the pole of a plane is on a net of radius 1: to the right, and up. The pole of a level plane is in the middle.
/** @param {number} dip @param {number} azimuth */
export function pole(dip, azimuth) {
  const far = Math.SQRT2 * Math.sin((dip / 2) * RAD);
  return [-far * Math.sin(azimuth * RAD), -far * Math.cos(azimuth * RAD)];
}

// Return how many directions lie in each sector.
/** @param {number[]} directions */
export function rose(directions) {
  const counts = new Array(360 / SECTOR).fill(0);
  for (const direction of directions) counts[Math.floor(wrap360(direction) / SECTOR) % counts.length]++;
  return counts;
}

// Return the letters at the top of the stereonet and the rose and, clockwise, at their other sides.
/** @param {Path} path */
const sidesOf = ({ surveyed, reference }) => {
  if (surveyed || reference === 'north') return ['N', 'E', 'S', 'W'];
  return reference === 'high-side' ? ['U', 'R', 'D', 'L'] : ['0°', '', '', ''];
};

/** @type {(plane: Plane, path: Path) => Pair} */
const attitude = ({ dip, azimuth, apparent, deepest }, { surveyed }) => (surveyed ? [dip, azimuth] : [apparent, deepest]);

// Draw the stereonet and the rose, and return in words what they show.
/** @param {{ ink: Ink, width: number, height: number }} canvas @param {Look} look @param {Planes} planes @param {boolean} [alone] on its canvas */
export function drawNet({ ink, width, height }, { view, path }, { kept, boxes }, alone = true) {
  const palette = PALETTES[view.theme];
  if (alone) ink.clearRect(0, 0, width, height);
  /** @param {{ depth: number }} of */
  const inView = ({ depth }) => depth >= view.top && depth <= view.bottom;
  const planes = kept.filter(inView);
  const breakouts = boxes.filter(inView);
  const tall = height > width; // one below the other
  const half = tall ? [width / 2, height / 4] : [width / 4, height / 2];
  const radius = Math.min(half[0] - 22, half[1] - 18);
  const [net, flower] = [1, 3].map((i) => ({ x: half[0] * (tall ? 1 : i), y: half[1] * (tall ? i : 1), radius }));
  for (const place of [net, flower]) circle(ink, place, palette, sidesOf(path));
  for (const plane of planes) {
    const [dip, azimuth] = attitude(plane, path);
    const [x, y] = pole(dip || 0, azimuth || 0);
    symbol(ink, net.x + radius * x, net.y - radius * y, plane.kind, palette.picks[plane.kind], palette.panel);
  }
  const north = sidesOf(path)[0] === 'N';
  const axes = breakouts.map(({ depth, toolface }) => (north ? path.azimuth(depth, toolface) : toolface)).filter(Number.isFinite).flatMap((axis) => [axis, axis + 180]);
  const dips = planes.map((plane) => attitude(plane, path)[1]).filter(Number.isFinite);
  petals(ink, flower, rose(dips), palette.soft);
  petals(ink, flower, rose(axes), palette.picks.breakout);
  return `${planes.length} pole${planes.length === 1 ? '' : 's'}, ${path.surveyed ? 'lower hemisphere' : 'seen downhole'}; rose: ${[dips.length ? (north ? `dip azimuths from ${(alone ? northInWords : northOf)(path)}` : 'dip toolfaces') : '', axes.length ? 'breakout axes' : ''].filter(Boolean).join(', ') || 'nothing'}`;
}

/** @param {Ink} ink @param {{ x: number, y: number, radius: number }} of @param {Palette} palette @param {string[]} names */
function circle(ink, { x, y, radius }, palette, names) {
  ink.strokeStyle = palette.line;
  ink.lineWidth = 1;
  for (const share of [Math.SQRT2 * Math.sin(15 * RAD), Math.SQRT2 * Math.sin(30 * RAD), 1]) {
    ink.beginPath();
    ink.arc(x, y, share * radius, 0, 2 * Math.PI);
    ink.stroke();
  }
  names.forEach((name, i) => label(ink, name, x + (radius + 12) * Math.sin(i * 90 * RAD), y - (radius + 12) * Math.cos(i * 90 * RAD), { colour: palette.soft, align: 'center', font: SMALL }));
}

/** @param {Ink} ink @param {{ x: number, y: number, radius: number }} of @param {number[]} counts @param {string} colour */
function petals(ink, { x, y, radius }, counts, colour) {
  const most = Math.max(...counts);
  ink.fillStyle = colour;
  counts.forEach((count, i) => {
    if (!count) return;
    ink.beginPath();
    ink.moveTo(x, y);
    ink.arc(x, y, radius * Math.sqrt(count / most), (i * SECTOR - 90) * RAD, ((i + 1) * SECTOR - 90) * RAD);
    ink.globalAlpha = 0.75;
    ink.fill();
    ink.globalAlpha = 1;
  });
}
