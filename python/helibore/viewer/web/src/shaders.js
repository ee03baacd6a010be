// A tile's textures are drawn in three ways: wound around the hole (3-D), around a straight axis (the column) and cut open
// (the image track). All find the quad under a pixel as helix.js does and colour it with the same function. `texels` holds
// radius, first-pass radius, nearest distance, state (protocol.py); `frames` has one column for each frame, with three lines:
// centre and toolface of up; high and toolface of north; right.

const COMMON = /* glsl */ `
precision highp float;
precision highp int;
precision highp usampler2D;
uniform usampler2D texels;
uniform sampler2D column, frames, colours, dynamicRange;
uniform int K, rows;
uniform int mode;             // color.js: Q_RADIUS ..
uniform int size;             // vertices of the wall that are shown, from the tile's start on
uniform float pitch;          // signed
uniform bool rings;           // of the overview: rows are level, and a cell is one vertex
uniform float startToolface;  // radians
uniform float radiusUnit, nearestUnit, bitRadius;
uniform float firstFrame, frameStep; // place of the tile's start among its frames; metres between two
uniform bool firstPass;
uniform vec2 imageRows;       // of an image that was measured in rows: an edge between two rows, from the tile's start, and the height of a row; else 0

float slope() { return rings ? 0.0 : 1.0; }
ivec2 place(int k) { return ivec2(k % K, k / K); }
uvec4 texel(int k) { return texelFetch(texels, place(k), 0); }
vec4 frame(int line, float depth) {
  float f = firstFrame + depth / frameStep;
  int last = textureSize(frames, 0).x - 1;
  int i = clamp(int(floor(f)), 0, last - 1);
  return mix(texelFetch(frames, ivec2(i, line), 0), texelFetch(frames, ivec2(i + 1, line), 0), f - float(i));
}
// Returns a place along the hole, in turns from the tile's start; its whole part is the row of the quad to draw. The place is
// that of a depth; across is the place around the hole, in columns. For an image that was measured in rows, the place is the
// middle of the image row, at the middle of the column: the whole image row then has one value in each column.
float turnAt(float depth, float across) {
  if (imageRows.y == 0.0) return depth / pitch - slope() * across / float(K);
  float middle = imageRows.x + (floor((depth - imageRows.x) / imageRows.y) + 0.5) * imageRows.y;
  return middle / pitch - (min(floor(across), float(K - 1)) + 0.5) / float(K);
}
// Returns whose colour a place on quad k has: an image has its values on quads, all else has them at vertices, around which they lie.
int ownOf(int k, vec2 place) {
  vec2 within = place - vec2(k % K, k / K);
  return mode == 5 || rings ? k : k + (within.x < 0.5 ? 0 : 1) + (within.y < 0.5 ? 0 : K);
}
bool missing(int k) {
  if (rings) return k >= size || texel(k).x == 0u;
  return k + K + 1 >= size || texel(k).x == 0u || texel(k + 1).x == 0u || texel(k + K).x == 0u || texel(k + K + 1).x == 0u;
}
`;

const COLOUR = /* glsl */ `
uniform float low, high, form;
uniform bool logarithmic, isDynamic, dark;
uniform int glowCount;
uniform vec4 glow[8];         // first and last vertex in the tile, strength, 1 for a re-scan

float notANumber() { return uintBitsToFloat(0x7fc00000u); }
float value(int k) {
  if (mode == 5) return texelFetch(column, place(k), 0).r;
  uvec4 t = texel(k);
  uint r = firstPass ? t.y : t.x;
  if (mode == 2) return float(t.z) * nearestUnit;
  if (mode == 3) return float(t.w & 0xffu);
  if (mode == 4) return (t.w & 0x100u) == 0u ? notANumber() : (float(t.x) - float(t.y)) * radiusUnit;
  if (r == 0u) return notANumber();
  return float(r) * radiusUnit - (mode == 1 ? bitRadius : 0.0);
}
// An image has values where the wall has no radius, too.
bool lacks(int k) { return mode == 5 ? k + (rings ? 0 : K + 1) >= size : missing(k); }
bool known(float v) { return (floatBitsToUint(v) & 0x7f800000u) != 0x7f800000u && !(logarithmic && v <= 0.0); }
vec3 nothing() {
  bool line = mod(gl_FragCoord.x - gl_FragCoord.y, 7.0) < 1.6;
  return dark ? (line ? vec3(0.36) : vec3(0.24)) : (line ? vec3(0.62) : vec3(0.80));
}
vec3 colourOf(float v, int row) {
  vec2 ends = isDynamic ? texelFetch(dynamicRange, ivec2(min(row, rows - 1), 0), 0).rg : vec2(low, high);
  if (logarithmic) { v = log(v); ends = log(ends); }
  float t = clamp((v - ends.x) / (ends.y - ends.x), 0.0, 1.0);
  return texelFetch(colours, ivec2(int(t * 255.0 + 0.5), 0), 0).rgb;
}
// Returns a colour under light, 0 to 1. Full colours stay nearly as they are on the colour bar. Pale colours show the form and
// keep their hue: on the dark page, light makes them lighter; on the light page, shadow makes them darker. Without this, a wall
// at bit size would not be seen, because it has the colour of the page. form: how strong the effect is; small for maps
// without the colour of the page.
vec3 lit(vec3 colour, float light) {
  float most = max(colour.r, max(colour.g, colour.b)), least = min(colour.r, min(colour.g, colour.b));
  vec3 c = colour * (0.86 + 0.14 * light);
  if (!dark) return c * (1.0 - form * 0.34 * (1.0 - light) * least);
  float pale = form * (1.0 - most) * sqrt(least / max(most, 0.01));
  return c * (1.0 + pale * (0.32 + 0.48 * light)) + pale * (0.08 + 0.13 * light);
}
// A provisional radius is dotted until later samples settle it.
vec3 dotted(vec3 colour, int k) {
  bool dot = (texel(k).w & 0x200u) != 0u && (int(gl_FragCoord.x) & 3) < 2 && (int(gl_FragCoord.y) & 3) < 2;
  return dot ? mix(colour, vec3(dark ? 0.0 : 1.0), 0.7) : colour;
}
// How far a radius is in doubt, 0 to 1: its 95 % interval is within 1 mm to each side, or 16 mm and more.
float doubt(uint state) { return clamp(float(state >> 12) / 8.0 - 0.5, 0.0, 1.0); }
// Colours fade with the doubt. Where the wall is interpolated, sparse lines run across the direction of those of no data, too.
vec3 interpolated(vec3 colour, int k) {
  if (mode == 5) return colour;
  uint state = texel(k).w;
  bool between = (state & 0x800u) != 0u;
  if (between && mod(gl_FragCoord.x + gl_FragCoord.y, 10.0) < 1.3) return vec3(dark ? 0.46 : 0.55);
  return mix(colour, dark ? vec3(0.12, 0.15, 0.18) : vec3(0.96), between ? 0.55 : 0.6 * doubt(state));
}
vec3 glowing(vec3 colour, int k) {
  for (int i = 0; i < 8; i++) {
    if (i >= glowCount) break;
    if (float(k) >= glow[i].x && float(k) < glow[i].y) {
      colour = mix(colour, glow[i].w > 0.5 ? vec3(0.0, 0.85, 1.0) : vec3(1.0, 0.0, 0.85), glow[i].z);
    }
  }
  return colour;
}
`;

const RADII = /* glsl */ `
uniform float shape;
uniform int median, stride; // median 0: rounded; stride: of the rows that are drawn
float radiusAt(int k) {
  if (k < 0 || k > K * (rows + 1)) return -1.0;
  uvec4 t = texel(k);
  uint r = firstPass ? t.y : t.x;
  return r == 0u ? -1.0 : float(r) * radiusUnit;
}
void order(inout float a, inout float b) { float m = min(a, b); b = max(a, b); a = m; }
// Returns the radii before and after a vertex, above and below it, so many columns and vertices away; -1 where there is none.
vec4 around(int k, int across, int along) { return vec4(radiusAt(k - across), radiusAt(k + across), radiusAt(k - along), radiusAt(k + along)); }
float smoothRadius(int k) {
  float c = radiusAt(k);
  if (c < 0.0) return c;
  if (median < 3) return c;
  float a = radiusAt(k - K), e = radiusAt(k + K);
  if (a < 0.0) a = c;
  if (e < 0.0) e = c;
  if (median == 3) return max(min(a, c), min(max(a, c), e));
  float z = radiusAt(k - 2 * K), w = radiusAt(k + 2 * K);
  if (z < 0.0) z = c;
  if (w < 0.0) w = c;
  order(z, a); order(e, w); order(z, e); order(a, w); // drop the least and the greatest, then the middle of three
  return max(min(a, c), min(max(a, c), e));
}
// rows that are left out do not count: else every second row, if interpolated, would look smooth
int stepAlong() { return max(stride, 1) * K; }
// Returns the slopes of the wall around and along the hole between radii around a vertex, on a wall whose shape is exaggerated.
vec2 slopes(vec4 near, float R) {
  return shape * vec2(near.x < 0.0 || near.y < 0.0 ? 0.0 : (near.y - near.x) * float(K) / 12.566 / R, near.z < 0.0 || near.w < 0.0 ? 0.0 : (near.w - near.z) * float(K) / (2.0 * pitch * float(stepAlong())));
}
// Returns a slope as far as it is surer than the uncertainty of the radii makes it: half of one that is as steep as chance makes one of twenty.
vec2 sure(vec2 slant, uint state, float steep) {
  float chance = 0.0002 * exp2(float(state >> 12) / 2.0) * steep * shape / abs(pitch);
  return slant * dot(slant, slant) / (dot(slant, slant) + chance * chance);
}
float exaggerated(float r) { return max(r < 0.0 ? bitRadius : bitRadius + (r - bitRadius) * shape, 0.1 * bitRadius); }
`;

const GRID = /* glsl */ `
// Returns column and row of a vertex of the grid, which has four columns to a cell of the overview.
vec2 gridPlace() {
  int fine = rings ? 4 : 1, wide = fine * K + 1, row = gl_VertexID / wide;
  return vec2(float(gl_VertexID - row * wide) / float(fine), float(row));
}
// Returns the vertex of the texels at a place of the grid.
int vertexAt(vec2 at) { return int(at.y) * K + (rings ? int(at.x) % K : int(at.x)); }
// Returns the radius at a place of the grid. Between the middles of two cells of the overview the hole is round.
float gridRadius(vec2 at) {
  int k = vertexAt(at);
  if (!rings) return smoothRadius(k);
  vec2 r = vec2(0.0);
  float share = fract(at.x + 0.5);
  for (int i = 0; i < 2; i++) {
    int cell = int(at.y) * K + (int(at.x + 0.5) + i + K - 1) % K;
    r[i] = smoothRadius(cell);
    if (r[i] < 0.0) r[i] = radiusAt(cell - K); // the far edge of the last ring
  }
  return r.x < 0.0 ? r.y : r.y < 0.0 ? r.x : mix(r.x, r.y, share);
}
`;

export const WALL_VERTEX = /* glsl */ `${COMMON}${RADII}${GRID}
uniform mat4 modelViewMatrix, projectionMatrix;
uniform float tube;
uniform vec2 steep; // how strongly slopes around and along the hole are shaded
out vec2 grid;
out vec3 seen, normal, outwards, axis; // as the camera sees them; outwards is the normal of a round, smooth hole
out float depthHere, wall; // wall: the radius around a place; 0: not known

void main() {
  grid = gridPlace();
  int at = vertexAt(grid);
  float r = gridRadius(grid);
  vec4 near = around(at, 1, stepAlong());
  wall = 0.0;
  if (median == 0 && r > 0.0) {
    int across = max(K / 24, 1), along = K * max(stride, int(bitRadius / abs(pitch)));
    vec4 far = around(at, across, along), twice = around(at, 2 * across, 2 * along);
    far = mix(twice.yxwz, far, step(0.0, far)); // at the end of a tile, where one side is missing, twice as far on the other
    far = mix(vec4(r), far, step(0.0, far));
    twice = mix(far, twice, step(0.0, twice));
    vec2 beside = max(far.xz, far.yw); // a cleft has narrower wall on two opposite sides, a ledge has it on one
    beside += max(vec2(0.0), beside - max(twice.xz, twice.yw)); // and no narrower twice as far: the ground of a groove is none
    wall = min(beside.x, beside.y);
    if (at > K && at < K * rows) r = 0.5 * r + 0.125 * dot(mix(vec4(r), near, step(0.0, near)), vec4(1.0)); // an edge is seen from near: round off its steps, but not where the next tile has to meet this one
  }
  float R = exaggerated(r);
  float turn = grid.y + slope() * grid.x / float(K);
  float toolface = startToolface + 6.283185307179586 * grid.x / float(K);
  depthHere = turn * pitch;
  vec3 centre = frame(0, depthHere).xyz;
  vec3 high = normalize(frame(1, depthHere).xyz);
  vec3 right = normalize(frame(2, depthHere).xyz);
  vec3 out1 = cos(toolface) * high + sin(toolface) * right;
  vec2 slant = clamp(sure(slopes(near, R) * steep, texel(at).w, max(steep.x, steep.y) / float(max(stride, 1))), -1.5, 1.5);
  mat3 turned = mat3(modelViewMatrix);
  outwards = turned * out1;
  axis = turned * cross(high, right);
  normal = outwards - slant.x * cross(axis, outwards) - slant.y * axis;
  vec4 seenAt = modelViewMatrix * vec4(centre + R * tube * out1, 1.0);
  seen = seenAt.xyz;
  gl_Position = projectionMatrix * seenAt;
}
`;

const CELL = /* glsl */ `
int quad(float depth) {
  int row = clamp(int(floor(grid.y)), 0, rows - 1);
  int level = imageRows.y == 0.0 ? row : int(floor(turnAt(depth, grid.x)));
  if (level >= 0 && level < rows) row = level; // else the quad is in a neighbouring tile
  return row * K + clamp(int(floor(grid.x)), 0, K - 1);
}
`;

const QUAD = /* glsl */ `
in vec2 grid;
in vec3 seen, normal, outwards, axis;
in float depthHere, wall;
uniform float top, bottom;    // ends of the shown part of the tile, metres from its start
${CELL}`;

// The colour of the wall in 3-D, without light. In a gap, and where the wall is interpolated, stripes lie on it.
const ROCK = /* glsl */ `
vec3 rock(int k, float v, bool gap) {
  uint state = texel(k).w;
  bool between = mode != 5 && (state & 0x800u) != 0u;
  vec3 plain = vec3(dark ? 0.24 : 0.80);
  vec3 base = gap || !known(v) ? plain : colourOf(v, k / K);
  base = mix(base, vec3(dot(base, vec3(0.3, 0.6, 0.1))), gap || mode == 5 ? 0.0 : between ? 0.6 : 0.75 * doubt(state)); // as light as it is without doubt: what is deep stays dark
  if (gap || between || !known(v)) {
    bool sparse = between && !gap; // dense where there is no data
    float at = (grid.x / float(K) * 24.0 + (sparse ? 1.0 : -1.0) * depthHere / (0.2618 * bitRadius)) * (sparse ? 1.0 : 2.0);
    float wide = fwidth(at), stripe = smoothstep(0.3 + wide, 0.3, abs(fract(at) - 0.5) + 0.1);
    base = mix(base, plain * 0.6, (sparse ? 0.35 : 0.8) * (1.0 - stripe) * smoothstep(0.7, 0.2, wide));
  }
  return base;
}
`;

export const WALL_FRAGMENT = /* glsl */ `${COMMON}${COLOUR}${QUAD}${ROCK}
out vec4 colour;
void main() {
  int k = quad(depthHere);
  if (depthHere < top || depthHere > bottom || missing(k)) discard;
  k = ownOf(k, grid);
  uint state = texel(k).w;
  bool between = mode != 5 && (state & 0x800u) != 0u;
  ivec2 screen = ivec2(gl_FragCoord.xy); // of two pixels of interpolated wall one is left out; of eight that are in doubt by 4 mm and more one, none beside another
  if (between ? ((screen.x + screen.y) & 1) == 0 : mode != 5 && doubt(state) >= 0.5 && ((screen.x * 3 + screen.y) & 7) == 0) discard;
  float facing = abs(dot(normalize(normal), normalize(seen)));
  vec3 base = lit(rock(k, value(k), false), 0.75 * facing + 0.25 * max(0.0, dot(normalize(normal) * sign(normal.z), normalize(vec3(-0.5, 0.6, 0.6)))));
  colour = vec4(glowing(dotted(base, k), k), 1.0);
}
`;
// What the shader of the wall seen from inside begins with (late_shaders.js).
export const INSIDE = COMMON + COLOUR + RADII + QUAD + ROCK;

// The straightened hole: depth runs down the picture. If the user has not turned it, the left edge of the image is at the
// left, and the last quarter of the image is in front. The right half of the front is cut away.
export const COLUMN_VERTEX = /* glsl */ `${COMMON}${RADII}${GRID}
uniform int reference;        // 0 up, 1 north
uniform float offset;         // radians from the reference to the left side
uniform float across;         // half widths of the picture a metre
uniform float relief;         // how strongly slopes along the hole are shaded
uniform float viewTop, viewLength; // metres, from the tile's start
out vec2 grid, side;          // side: unit vector from the axis to the wall; x to the right, y towards the eye
out float depthHere, light;
void main() {
  grid = gridPlace();
  int at = vertexAt(grid);
  float r = gridRadius(grid);
  float R = exaggerated(r);
  vec2 slant = slopes(around(at, 1, stepAlong()), R) * vec2(1.0, relief);
  depthHere = (grid.y + slope() * grid.x / float(K)) * pitch;
  float turn = startToolface + 6.283185307179586 * grid.x / float(K) - frame(reference, depthHere).w - offset;
  side = -vec2(cos(turn), sin(turn));
  vec3 normal = normalize(vec3(side.x + slant.x * side.y, -slant.y, side.y - slant.x * side.x)); // right, down, towards the eye
  light = max(0.0, dot(side.y < 0.0 ? -0.6 * normal : normal, normalize(vec3(-0.35, -0.5, 0.8)))); // the inside is dimmer
  gl_Position = vec4(side.x * R * across, 1.0 - 2.0 * (depthHere - viewTop) / viewLength, -0.5 * side.y * min(1.0, R * across), 1.0);
}
`;
export const COLUMN_FRAGMENT = /* glsl */ `${COMMON}${COLOUR}
in vec2 grid, side;
in float depthHere, light;
uniform float top, bottom;    // ends of the shown part of the tile, metres from its start
uniform float viewTop, pixelHeight; // metres, viewTop from the tile's start
${CELL}
out vec4 colour;
void main() {
  if (depthHere < top || depthHere > bottom || (side.x > 0.0 && side.y > 0.0)) discard;
  int k = quad(viewTop + (floor((depthHere - viewTop) / pixelHeight) + 0.5) * pixelHeight); // one depth for a row of pixels: an edge of an image row is a line, not dashes
  if (k + (rings ? 0 : K + 1) >= size) discard; // not drilled yet
  bool gap = missing(k);
  k = ownOf(k, grid);
  float v = value(k);
  vec3 base = gap ? nothing() : lit(known(v) ? interpolated(colourOf(v, k / K), k) : nothing(), light);
  colour = vec4(glowing(dotted(base, k), k), 1.0);
}
`;

// Which quad or vertex is under a pixel: alpha is the tile's number, 1 for the first; red, green and blue are its number in the tile.
export const PICK_FRAGMENT = /* glsl */ `${COMMON}${QUAD}
uniform int number;
out vec4 colour;
void main() {
  if (depthHere < top || depthHere > bottom) discard;
  int k = quad(depthHere);
  if (missing(k)) discard;
  k = ownOf(k, grid);
  colour = vec4(float(k & 255), float((k >> 8) & 255), float((k >> 16) & 255), float(number)) / 255.0;
}
`;

// The image: a strip of the screen between two depths. Each pixel finds its own quad; nothing is interpolated.
export const IMAGE_VERTEX = /* glsl */ `
uniform vec2 screenEnds;      // lower and upper edge in clip space
uniform vec2 depthEnds;       // the same edges, metres from the tile's start
out vec2 at;                  // share of the width from the left edge; depth, metres from the tile's start
void main() {
  vec2 corner = vec2(float(gl_VertexID & 1), float(gl_VertexID >> 1));
  at = vec2(corner.x, mix(depthEnds.x, depthEnds.y, corner.y));
  gl_Position = vec4(corner.x * 2.0 - 1.0, mix(screenEnds.x, screenEnds.y, corner.y), 0.0, 1.0);
}
`;

export const IMAGE_FRAGMENT = /* glsl */ `${COMMON}${COLOUR}
uniform int reference;        // 0 up, 1 north
uniform float offset;         // radians from the reference to the left edge
uniform float perPixel;       // turns of the wall a pixel is high: so many quads are averaged
in vec2 at;
out vec4 colour;
void main() {
  float zero = frame(reference, at.y).w; // line 0 carries the toolface of up, line 1 that of north
  float around = fract((at.x * 6.283185307179586 + zero + offset - startToolface) / 6.283185307179586);
  float across = around * float(K);
  int col = min(int(across), K - 1);
  int row = int(floor(turnAt(at.y, across)));
  float slack = (1e-3 + perPixel / 8.0) * pitch; // the GPU rounds corners to parts of a pixel: a pixel on the seam, or on an edge of an image row there, then belongs to at least one tile
  if (row < 0 && turnAt(at.y + slack, across) >= 0.0) row = 0;
  if (row >= rows && turnAt(at.y - slack, across) < float(rows)) row = rows - 1;
  if (row < 0 || row >= rows || row * K + col + (rings ? 0 : K + 1) >= size) discard; // in a neighbouring tile, or not drilled yet
  int many = clamp(int(perPixel + 0.5), 1, 16);
  float sum = 0.0;
  int count = 0;
  int r = max(row - many / 2, 0);
  int last = min(r + many, rows);
  int k = row * K + col, own = ownOf(k, vec2(across, turnAt(at.y, across)));
  do {
    int other = r * K + col;
    float v = lacks(other) ? notANumber() : value(other + own - k);
    if (known(v)) { sum += logarithmic ? log(v) : v; count++; }
  } while (++r < last);
  if (count == 0) {
    colour = vec4(nothing(), 1.0);
    return;
  }
  float mean = sum / float(count);
  vec3 base = interpolated(colourOf(logarithmic ? exp(mean) : mean, row), own);
  colour = vec4(glowing(dotted(base, own), own), 1.0);
}
`;
