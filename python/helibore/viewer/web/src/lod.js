// How coarse the 3-D grid may be. A tile is a grid of (sectors + 1)(rows + 1) vertices that the vertex shader places; an
// index buffer that skips columns and rows draws it coarser, from the same textures and with every quad's own colour.
// Strides are chosen from the size of a quad in pixels, separately around and along the hole: a long thin tube is coarse
// around and fine along, or the other way round.

export const COL_STRIDES = [1, 2, 4, 8];
export const ROW_STRIDES = [1, 4, 16, 64];
export const FINE_TILES = 64; // of the wall at once, on the page
export const MOST_TILES = 256; // of a picture: more than on the page, which is drawn while it moves
const TARGET = 4.5; // pixels: a coarse edge may be this long

/** @param {number[]} strides @param {number} pixels @param {number} limit */
export function pickStride(strides, pixels, limit) {
  let best = 1;
  for (const stride of strides) if (stride <= limit && stride * pixels <= TARGET) best = stride;
  return best;
}

// Return the corners of two triangles for each cell, (a0, a1, b1) and (a0, b1, b0): counter-clockwise seen from the formation.
// The last column and the last row of cells may be narrower than their stride.
/** @param {number} sectors @param {number} rows @param {number} colStride @param {number} rowStride */
export function gridIndices(sectors, rows, colStride, rowStride) {
  const indices = new Uint16Array(6 * Math.ceil(sectors / colStride) * Math.ceil(rows / rowStride));
  let at = 0;
  for (let row = 0; row < rows; row += rowStride) {
    for (let col = 0; col < sectors; col += colStride) {
      const a = row * (sectors + 1);
      const b = Math.min(row + rowStride, rows) * (sectors + 1);
      const next = Math.min(col + colStride, sectors);
      indices[at] = indices[at + 3] = a + col;
      indices[at + 1] = a + next;
      indices[at + 2] = indices[at + 4] = b + next;
      indices[at + 5] = b + col;
      at += 6;
    }
  }
  return indices;
}

// Return [first, count] of the grid's indices whose rows lie in the section and in the shown part of the tile.
/** @param {Piece} piece @param {View} view @param {Level} level @param {{ cols: number, rows: number }} strides */
export function rowsShown({ tile, top, bottom }, view, { columns, rows, pitch }, strides) {
  const places = [Math.max(top, view.top), Math.min(bottom, view.bottom)].map((depth) => (depth - tile.startDepth) / pitch);
  /** @param {number} row */
  const line = (row) => Math.min(Math.max(row, 0), Math.ceil(rows / strides.rows));
  const first = line(Math.floor((Math.min(...places) - 1) / strides.rows)); // a turn is one pitch deep
  const last = line(Math.ceil((Math.max(...places) + 1) / strides.rows));
  const aRow = 6 * Math.ceil(columns / strides.cols);
  return [first * aRow, (last - first) * aRow];
}

// Return a length as a person would choose it: 1, 2 or 5 times a power of ten, at least `least`.
/** @param {number} least */
export function niceStep(least) {
  const power = 10 ** Math.floor(Math.log10(least));
  for (const step of [1, 2, 5, 10]) if (step * power >= least * (1 - 1e-9)) return step * power;
  return 10 * power;
}

// Return the tube's exaggeration that makes a section easy to see: the hole is then about a fourteenth as wide as long; rounded.
/** @param {number} length @param {number} radius */
export function tubeFor(length, radius) {
  const wanted = length / 14 / (2 * radius);
  return wanted <= 1 ? 1 : niceStep(wanted * 0.6);
}
