// The bytes between server and page; protocol.py draws the same format for the server's side.
//
//   u8 type | u8 level | u16 mask | u32 tile, first, count, total, sequence | f64 time | payload       little endian
//
// Arrays are views into the message, and the tile store copies them to where they stay. Only texels without the radii of the
// first pass are copied here, too.

export const HEAD = 32;
export const WRITE = 1;
export const FRAMES = 3;
export const LIVE = 0x80;
export const NO_FIRST = 0x80; // in `level`: the radii of the first pass are left out, because they equal the radii
export const SURVEYED = 1; // in `mask` of FRAMES
export const TEXEL = 4;
export const [RADIUS, FIRST, NEAREST, STATE] = [0, 1, 2, 3];
export const SUPPORT_MASK = 0x00ff;
export const [RESCANNED, PROVISIONAL, CLIPPED, INTERPOLATED] = [0x0100, 0x0200, 0x0400, 0x0800];
// Return the half-width of the 95 % interval of a radius, metres, from its state; NaN if it is not known (texels.py).
/** @param {number} state */
export const uncertaintyOf = (state) => (state >> 12 ? 0.00025 * 2 ** ((state >> 12) / 2) : NaN);

/** @param {number} mask */
export const attributesIn = (mask) => {
  const bits = [];
  for (let bit = 0; bit < 16; bit++) if ((mask >> bit) & 1) bits.push(bit);
  return bits;
};

/** @param {ArrayBuffer} buffer @returns {Write | Frames} */
export function decode(buffer) {
  if (buffer.byteLength < HEAD) throw new Error(`message of ${buffer.byteLength} bytes: a head has ${HEAD}`);
  const head = new DataView(buffer, 0, HEAD);
  const message = {
    type: head.getUint8(0) & ~LIVE,
    live: (head.getUint8(0) & LIVE) !== 0,
    level: head.getUint8(1) & ~NO_FIRST,
    mask: head.getUint16(2, true),
    tile: head.getUint32(4, true),
    first: head.getUint32(8, true),
    count: head.getUint32(12, true),
    total: head.getUint32(16, true),
    sequence: head.getUint32(20, true),
    time: head.getFloat64(24, true),
  };
  const attributes = attributesIn(message.mask);
  const { type, count } = message;
  if (type !== WRITE && type !== FRAMES) throw new Error(`message type ${type}: unknown`);
  const words = TEXEL - (type === WRITE && head.getUint8(1) & NO_FIRST ? 1 : 0);
  const texelBytes = 2 * (words * count + ((words * count) % 2)); // what follows is at a multiple of 4
  const size = HEAD + (type === FRAMES ? 48 * count : texelBytes + 4 * count * attributes.length);
  if (buffer.byteLength !== size) throw new Error(`message of ${buffer.byteLength} bytes: its head says ${size}`);
  if (type === FRAMES) {
    return {
      ...message,
      type,
      surveyed: (message.mask & SURVEYED) !== 0,
      centre: new Float64Array(buffer, HEAD, 3 * count),
      directions: new Float32Array(buffer, HEAD + 24 * count, 6 * count),
    };
  }
  const sent = new Uint16Array(buffer, HEAD, words * count);
  const at = HEAD + texelBytes;
  return {
    ...message,
    type,
    texels: words === TEXEL ? sent : withFirst(sent),
    columns: attributes.map((attribute, i) => ({ attribute, values: new Float32Array(buffer, at + 4 * count * i, count) })),
  };
}

/** @param {Uint16Array} sent */
function withFirst(sent) {
  const texels = new Uint16Array((sent.length / (TEXEL - 1)) * TEXEL);
  for (let from = 0, to = 0; from < sent.length; from += TEXEL - 1, to += TEXEL) {
    texels[to + RADIUS] = texels[to + FIRST] = sent[from];
    texels[to + NEAREST] = sent[from + 1];
    texels[to + STATE] = sent[from + 2];
  }
  return texels;
}

/** @param {string | null} session @param {number} sequence */
export const encodeAck = (session, sequence) => JSON.stringify({ session, ack: sequence });
/** @param {string | null} session @param {number[][]} tiles @param {number} focus @param {number} mask */
export const encodeSubscribe = (session, tiles, focus, mask) =>
  JSON.stringify({ session, subscribe: { tiles, focus, mask } });

// Return sorted tile numbers as half-open ranges, at most `most` ranges: if there are more, the nearest ranges are joined.
/** @param {number[]} numbers @param {number} [most] */
export function toRanges(numbers, most = 64) {
  /** @type {Pair[]} */
  const ranges = [];
  for (const number of numbers) {
    const last = ranges.at(-1);
    if (last && last[1] === number) last[1] = number + 1;
    else ranges.push([number, number + 1]);
  }
  while (ranges.length > most) {
    let best = 1;
    for (let i = 2; i < ranges.length; i++) {
      if (ranges[i][0] - ranges[i - 1][1] < ranges[best][0] - ranges[best - 1][1]) best = i;
    }
    ranges[best - 1][1] = ranges[best][1];
    ranges.splice(best, 1);
  }
  return ranges;
}
