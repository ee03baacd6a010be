// The strokes that every panel draws with: a line, dashed or not, the edges of a rectangle, and the hatching of what is not
// measured. The canvas keeps lines and edges until the next frame, so that texts keep clear of them; the pale lines of a grid
// (their colours have an opacity) may pass below a text.

/** @param {Ink} ink @param {number} x0 @param {number} y0 @param {number} x1 @param {number} y1 @param {string} colour @param {number[]} [dash] @param {number} [width] */
export function line(ink, x0, y0, x1, y1, colour, dash = [], width = 1.2) {
  if (colour.length < 9) ink.canvas.strokes.push([x0, y0, x1, y1]);
  ink.strokeStyle = colour;
  ink.lineWidth = width;
  ink.setLineDash(dash);
  ink.beginPath();
  ink.moveTo(x0, y0);
  ink.lineTo(x1, y1);
  ink.stroke();
  ink.setLineDash([]);
}

/** @param {Ink} ink @param {Rect} rect @param {string} colour @param {number} [width] */
export function edges(ink, { left, top, width: wide, height }, colour, width = 1) {
  const [right, bottom] = [left + wide, top + height];
  ink.canvas.strokes.push([left, top, right, top], [right, top, right, bottom], [left, bottom, right, bottom], [left, top, left, bottom]);
  ink.strokeStyle = colour;
  ink.lineWidth = width;
  ink.strokeRect(left, top, wide, height);
}

// Return the edge that is drawn half a pixel inside a track, so that it is sharp; `side` -1: half a pixel outside the track.
/** @param {Rect} rect @param {number} [side] */
export const sharp = ({ left, top, width, height }, side = 1) => ({ left: left + side / 2, top: top + side / 2, width: width - side, height: height - side });

// Draw a triangle with its tip at (x, y), `length` pixels long to the right, or to the left if `length` is negative.
/** @param {Ink} ink @param {number} x @param {number} y @param {number} length @param {string} colour */
export function pointer(ink, x, y, length, colour) {
  ink.fillStyle = colour;
  ink.beginPath();
  for (const [dx, dy] of [[length, -5], [0, 0], [length, 5]]) ink.lineTo(x + dx, y + dy);
  ink.fill();
}

// Return whether a stroke passes through a box: it reaches into it across and down, and has corners of it on both sides.
/** @param {Box} box @param {Stroke} stroke */
export function strikes({ left, right, top, bottom }, [x0, y0, x1, y1]) {
  if (Math.max(x0, x1) <= left || Math.min(x0, x1) >= right || Math.max(y0, y1) <= top || Math.min(y0, y1) >= bottom) return false;
  /** @type {(x: number, y: number) => number} */
  const side = (x, y) => (x - x0) * (y1 - y0) - (y - y0) * (x1 - x0);
  const sides = [side(left, top), side(right, top), side(left, bottom), side(right, bottom)];
  return Math.min(...sides) < 0 && Math.max(...sides) > 0;
}

export const DENSE = { step: 5, fill: 0.35, rising: true }; // no data
export const OUTSIDE = { step: 7, fill: 0.1, rising: true }; // above and below the wall
export const SPARSE = { step: 10, fill: 0, rising: false }; // interpolated between arms

/** @param {Ink} ink @param {number} x @param {number} y @param {number} width @param {number} height @param {Palette} palette @param {Hatching} [hatching] */
export function hatched(ink, x, y, width, height, palette, { step, fill, rising } = DENSE) {
  ink.save();
  ink.beginPath();
  ink.rect(x, y, width, height);
  ink.clip();
  ink.globalAlpha = fill;
  ink.fillStyle = palette.hatch;
  ink.fillRect(x, y, width, height);
  ink.globalAlpha = 1;
  ink.strokeStyle = palette.hatch;
  ink.lineWidth = 1.2;
  ink.beginPath();
  for (let d = -height; d < width; d += step) {
    ink.moveTo(x + d, rising ? y + height : y);
    ink.lineTo(x + d + height, rising ? y : y + height);
  }
  ink.stroke();
  ink.restore();
}
