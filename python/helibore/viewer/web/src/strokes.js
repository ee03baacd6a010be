// The two strokes that every panel draws with: a line, dashed or not, and the hatching of what is not measured.

/** @param {Ink} ink @param {number} x0 @param {number} y0 @param {number} x1 @param {number} y1 @param {string} colour @param {number[]} [dash] @param {number} [width] */
export function line(ink, x0, y0, x1, y1, colour, dash = [], width = 1.2) {
  ink.strokeStyle = colour;
  ink.lineWidth = width;
  ink.setLineDash(dash);
  ink.beginPath();
  ink.moveTo(x0, y0);
  ink.lineTo(x1, y1);
  ink.stroke();
  ink.setLineDash([]);
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
