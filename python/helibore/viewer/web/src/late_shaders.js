// Shaders of the hole on its path and from inside, which the page loads late.

// The wall seen from inside, lit by a lamp beside the eye. Where a quad is not much smaller than a pixel, radii and values are joined
// smoothly (quadratic B-splines over three by three vertices), so that neither facets nor bricks are seen.

export const INSIDE_FRAGMENT = /* glsl */ `
uniform vec2 steep;
uniform float range; // of the image whose contrast is seen under the colours of radii; 0: none
uniform bool imageLog;
out vec4 colour;
// Weights of three vertices for a place, in vertices from the middle one; and how they change along the way.
vec3 spline(float f) { return vec3(0.5 * (0.5 - f) * (0.5 - f), 0.75 - f * f, 0.5 * (0.5 + f) * (0.5 + f)); }
vec3 change(float f) { return vec3(f - 0.5, -2.0 * f, f + 0.5); }
// Returns where the texel of a vertex is. The rows beyond those of the tile are not here: they mirror those before, so that tiles join
// without a seam.
ivec2 at(int col, int row) {
  int wrap = col < 0 ? -1 : col < K ? 0 : 1;
  row = abs(row + wrap);
  return ivec2(col - wrap * K, min(row, 2 * rows - row));
}
// Returns a radius, or a value of the image, over c; 0 where it is missing.
float above(ivec2 place, float c, bool image) {
  float v;
  if (image) {
    v = texelFetch(column, place, 0).r;
    if (!known(v)) return 0.0;
    if (logarithmic || imageLog) v = log(max(v, 1e-6));
  } else {
    uvec4 t = texelFetch(texels, place, 0);
    v = float(firstPass ? t.y : t.x) * radiusUnit;
    if (v == 0.0) return 0.0;
  }
  return v - c;
}
// Returns how radii or values change around a place of the grid, for a column and for a row, and their mean there over c.
vec3 smoothed(vec2 where, float c, bool image) {
  ivec2 cell = ivec2(floor(where + 0.5));
  vec2 f = where - vec2(cell);
  vec3 across = spline(f.x), along = spline(f.y), acrossChange = change(f.x), alongChange = change(f.y), sum = vec3(0.0);
  for (int j = 0; j < 3; j++) {
    int x = cell.x, y = cell.y + j - 1;
    vec3 r = vec3(above(at(x - 1, y), c, image), above(at(x, y), c, image), above(at(x + 1, y), c, image));
    vec2 w = j == 0 ? vec2(along.x, alongChange.x) : j == 1 ? vec2(along.y, alongChange.y) : vec2(along.z, alongChange.z);
    sum += w.xyx * vec3(dot(acrossChange, r), vec2(dot(across, r)));
  }
  return sum;
}
void main() {
  if (depthHere < top || depthHere > bottom) discard;
  int k = quad(depthHere);
  bool gap = missing(k);
  if (gap && k + (rings ? 0 : K + 1) >= size) discard;
  int cell = k;
  k = ownOf(k, grid);
  vec2 under = fwidth(grid); // columns and rows under a pixel
  float small = max(1.0, max(under.x, under.y)); // quads under a pixel
  bool near = fine && !rings && small < 2.0;
  float v = value(k);
  float c = float(firstPass ? texel(k).y : texel(k).x) * radiusUnit;
  vec3 radii = near ? smoothed(grid, c, false) : vec3(0.0);
  if (near && mode < 2 && known(v)) v = c + radii.z - (mode == 1 ? bitRadius : 0.0);
  else if (near && mode == 5 && known(v)) {
    if (logarithmic) v = log(v);
    v += smoothed(grid - 0.5, v, true).z;
    if (logarithmic) v = exp(v);
  }
  else if (known(v)) { // rows under one pixel, far along the hole: show their mean
    float sum = v, count = 1.0;
    for (int i = 1; i < min(int(under.y), 8); i++) {
      int other = k + K * (i % 2 == 0 ? i / 2 : -i / 2 - 1);
      float w = other < 0 || other >= K * rows ? notANumber() : value(other);
      if (known(w)) { sum += w; count += 1.0; }
    }
    v = sum / count;
  }
  vec3 flat1 = normalize(outwards), from = normalize(seen), bent = normal;
  if (near) {
    vec2 slant = clamp(sure(steep * shape / small * radii.xy * vec2(float(K) / 6.2832 / exaggerated(c), 1.0 / pitch), texel(k).w, steep.x / small), -1.5, 1.5);
    bent = flat1 - slant.x * cross(axis, flat1) - slant.y * axis;
  }
  float relief = abs(dot(normalize(bent), from)) / max(abs(dot(flat1, from)), 0.04); // compared with a smooth hole, so that the relief is seen as far as the light reaches
  float far = length(seen) / (14.0 * bitRadius); // the lamp lights some metres
  float deep = wall > 0.0 ? max(0.0, c + radii.z - wall) : 0.0; // so far behind the wall around it
  float cleft = min(pow(20.0 * shape * deep / bitRadius, 2.0), 3.0); // of the light that enters a narrow cleft a quarter leaves it, so that its ground is seen; a breakout is wider than deep
  float open = min(deep / 0.003, 1.0); // in a cleft its relief is seen, not the image: neither pads nor echoes reach its ground
  float mark = 1.0; // a closed fracture has no relief: where the image differs from what is around, the wall is darker or lighter
  if (range > 0.0 && !rings) {
    ivec2 here = place(cell);
    float own = texelFetch(column, here, 0).r;
    if (known(own)) {
      if (imageLog) own = log(max(own, 1e-6));
      if (near) own += smoothed(grid - 0.5, own, true).z;
      int across = max(K / 24, 1), along = min(max(int(0.5 * bitRadius / abs(pitch)), 2), min(here.y, rows - here.y)); // no farther than the tile: beyond it a fracture would be mirrored
      vec2 darker = vec2(0.0), lighter = vec2(0.0); // than on both sides, in two of four directions: an edge is so in none, and the inner side of a bend of a line in one
      for (int i = 0; i < 4; i++) {
        ivec2 aside = ivec2(i == 1 ? 0 : across, i == 0 ? 0 : i == 3 ? -along : along);
        vec2 sides = vec2(above(at(here.x + aside.x, here.y + aside.y), own, true), above(at(here.x - aside.x, here.y - aside.y), own, true));
        float less = min(sides.x, sides.y), more = -max(sides.x, sides.y);
        darker = vec2(max(darker.x, less), max(darker.y, min(darker.x, less)));
        lighter = vec2(max(lighter.x, more), max(lighter.y, min(lighter.x, more)));
      }
      float contrast = (lighter.y - darker.y) / range / small;
      mark = mix(clamp(1.0 + 2.0 * contrast * contrast * contrast / (contrast * contrast + 0.4), 0.25, 1.3), 1.0, open); // noise and lamination are faint
    }
  }
  vec3 stone = rock(k, v, gap);
  stone = mix(stone, vec3(0.7), mode == 5 ? open : 0.6 * open); // the colours of radii end at their darkest there
  vec3 base = mark * stone * vec3(1.0, 0.97, 0.91) * clamp(0.8 * pow(relief, 0.75), 0.25, 0.95) / (1.0 + cleft) * (1.08 / (1.0 + 1.4 * far * far));
  colour = vec4(glowing(dotted(base, k), k), 1.0);
}
`;

// The bit: steel, lit as the wall is; an outline of radius 1 turned around the hole, its nose at the bit's depth.
export const BIT_CORNERS = 6 * 6 * 24;
const BIT_VERTEX = /* glsl */ `
uniform mat4 modelViewMatrix, projectionMatrix;
out vec3 seen;
const vec2 OUTLINE[7] = vec2[](vec2(0, 0), vec2(0.6, -0.2), vec2(1, -0.7), vec2(1, -1.3), vec2(0.5, -1.6), vec2(0.5, -2.4), vec2(0, -2.4));
void main() {
  int corner = gl_VertexID % 6;
  int cell = gl_VertexID / 6;
  vec2 edge = OUTLINE[cell / 24 + (corner == 1 || corner == 2 || corner == 4 ? 1 : 0)];
  float around = 6.283185307179586 * float(cell % 24 + (corner == 2 || corner > 3 ? 1 : 0)) / 24.0;
  vec4 at = modelViewMatrix * vec4(edge.x * sin(around), edge.y, edge.x * cos(around), 1.0);
  seen = at.xyz;
  gl_Position = projectionMatrix * at;
}
`;
const BIT_FRAGMENT = /* glsl */ `
precision highp float;
in vec3 seen;
out vec4 colour;
void main() {
  float facing = abs(normalize(cross(dFdx(seen), dFdy(seen))).z);
  colour = vec4(vec3(0.42, 0.46, 0.50) * (0.45 + 0.75 * facing), 1.0);
}
`;
/** @type {[string, string]} */
export const BIT = [BIT_VERTEX, BIT_FRAGMENT];
