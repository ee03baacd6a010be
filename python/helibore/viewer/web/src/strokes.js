// The two strokes that every panel draws with: a line, dashed or not, and the hatching of what is not measured.

export function line(ink, x0, y0, x1, y1, colour, dash = []) {
  ink.strokeStyle = colour;
  ink.lineWidth = 1.2;
  ink.setLineDash(dash);
  ink.beginPath();
  ink.moveTo(x0, y0);
  ink.lineTo(x1, y1);
  ink.stroke();
  ink.setLineDash([]);
}

export function hatched(ink, x, y, width, height, palette) {
  ink.save();
  ink.beginPath();
  ink.rect(x, y, width, height);
  ink.clip();
  ink.globalAlpha = 0.35;
  ink.fillStyle = palette.hatch;
  ink.fillRect(x, y, width, height);
  ink.globalAlpha = 1;
  ink.strokeStyle = palette.hatch;
  ink.lineWidth = 1.2;
  ink.beginPath();
  for (let d = -height; d < width; d += 5) {
    ink.moveTo(x + d, y + height);
    ink.lineTo(x + d + height, y);
  }
  ink.stroke();
  ink.restore();
}

