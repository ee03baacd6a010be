// Picked planes on the picture: a curve on the image, a disc through the hole in 3-D, and a tadpole: its head at the dip (0
// to 90 degrees across the track), its tail towards where the bed dips, north up. Without a survey the dip is that to the
// hole, its head is hollow and its tail counts from the tool's zero.

import { columnCurve } from './column.js';
import { planeDepth, wallPoint } from './dips.js';
import { BOLD, HEAD, label, PALETTES, SMALL, within, yOf } from './layout.js';
import { leftEdge } from './path.js';
import { line } from './strokes.js';

export function drawDips(ink, look, planes, gpu) {
  const palette = PALETTES[look.view.theme];
  const all = [...planes.kept.map((plane) => [plane, plane === planes.selected ? palette.cursor : palette.pin]), ...(planes.current ? [[planes.current, palette.cursor]] : [])];
  for (const [plane, colour] of all) {
    for (const one of look.images) curve(ink, one, plane, colour, palette, planes.open && plane === planes.current ? [5, 4] : []);
    if (gpu) (look.view.camera === 'straight' ? columnCurve : disc)(ink, look, plane, colour, gpu);
  }
  if (look.rects.dips) tadpoles(ink, look, planes, palette);
}

export function drawPoints(ink, look, points) {
  const { view, rects } = look;
  const palette = PALETTES[view.theme];
  for (const { depth, toolface } of points) {
    if (depth < view.top || depth > view.bottom) continue;
    const turn = ((((toolface - leftEdge(look.path, view.cut, depth).toolface) % 360) + 360) % 360) / 360;
    ink.beginPath();
    ink.arc(rects.image.left + turn * rects.image.width, yOf(view, rects.image, depth), 4, 0, 2 * Math.PI);
    ink.fillStyle = palette.paper;
    ink.fill();
    ink.strokeStyle = palette.cursor;
    ink.lineWidth = 2;
    ink.stroke();
  }
}

function curve(ink, { view, path, rects }, plane, colour, palette, dash) {
  const { image } = rects;
  within(ink, image, () => {
    ink.beginPath();
    let depth = plane.depth;
    for (let x = 0; x <= image.width; x += 3) {
      for (let i = 0; i < 3; i++) depth = planeDepth(path, plane, leftEdge(path, view.cut, depth).toolface + (360 * x) / image.width);
      ink.lineTo(image.left + x, yOf(view, image, depth));
    }
    for (const [width, style] of [[4, palette.paper], [2, colour]]) {
      ink.lineWidth = width;
      ink.strokeStyle = style;
      ink.setLineDash(dash);
      ink.stroke();
    }
    ink.setLineDash([]);
  });
}

function disc(ink, { view, path, rects, store }, plane, colour, gpu) {
  const outside = 1.25 * view.tubeFactor(store);
  const ring = [];
  for (let toolface = 0; toolface < 360; toolface += 10) {
    const at = { depth: planeDepth(path, plane, toolface), toolface, radius: plane.radius * outside };
    if (at.depth < view.top || at.depth > view.bottom) return; // it leaves the section
    const seen = gpu.project({ centre: wallPoint(path, at) }, rects.wall);
    if (!seen) return;
    ring.push(seen);
  }
  within(ink, { ...rects.wall, top: HEAD, height: rects.wall.height - HEAD }, () => {
    ink.beginPath();
    for (const point of ring) ink.lineTo(...point);
    ink.closePath();
    ink.globalAlpha = 0.25;
    ink.fillStyle = colour;
    ink.fill();
    ink.globalAlpha = 1;
    ink.strokeStyle = colour;
    ink.lineWidth = 1.5;
    ink.stroke();
  });
}

function tadpoles(ink, { view, path, rects }, { kept, current, selected }, palette) {
  const { left, top, width, height } = rects.dips;
  const x = (degrees) => left + 6 + (degrees / 90) * (width - 12);
  ink.fillStyle = palette.panel;
  ink.fillRect(left, top, width, height);
  for (const degrees of [0, 30, 60, 90]) line(ink, x(degrees), top, x(degrees), top + height, palette.grid);
  ink.strokeStyle = palette.line;
  ink.strokeRect(left + 0.5, top + 0.5, width - 1, height - 1);
  label(ink, path.surveyed ? 'Dip [°]' : 'To hole [°]', left + 2, 11, { colour: palette.ink, font: path.surveyed ? BOLD : SMALL });
  label(ink, '0', x(0), HEAD - 9, { colour: palette.soft, align: 'center', font: SMALL });
  label(ink, '90', x(90), HEAD - 9, { colour: palette.soft, align: 'center', font: SMALL });
  within(ink, rects.dips, () => {
    for (const plane of current ? [...kept, current] : kept) {
      const [angle, towards] = path.surveyed ? [plane.dip, plane.azimuth] : [plane.apparent, plane.deepest];
      tadpole(ink, x(angle), yOf(view, rects.dips, plane.depth), towards, path.surveyed, plane === current || plane === selected ? palette.cursor : palette.pin);
    }
  });
}

function tadpole(ink, x, y, towards, filled, colour) {
  ink.strokeStyle = ink.fillStyle = colour;
  ink.lineWidth = 2;
  ink.beginPath();
  ink.arc(x, y, 4, 0, 2 * Math.PI);
  if (filled) ink.fill();
  ink.stroke();
  if (!Number.isFinite(towards)) return;
  const [dx, dy] = [Math.sin((towards * Math.PI) / 180), -Math.cos((towards * Math.PI) / 180)];
  ink.beginPath();
  ink.moveTo(x + 4 * dx, y + 4 * dy);
  ink.lineTo(x + 14 * dx, y + 14 * dy);
  ink.stroke();
}
