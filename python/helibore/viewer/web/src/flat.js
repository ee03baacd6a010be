// Flat shapes in the scene of several wells: triangles and lines in colours of their own, without light.

import { Texture } from './gl.js';

const WIDE = 1024; // texels of a row

const PLACE = /* glsl */ `
precision highp float;
precision highp int;
`;

/** @type {[string, string]} */
export const FLAT = [/* glsl */ `${PLACE}
uniform sampler2D frames, colours;
uniform mat4 modelViewMatrix, projectionMatrix;
out vec4 tint;
void main() {
  ivec2 at = ivec2(gl_VertexID % ${WIDE}, gl_VertexID / ${WIDE});
  tint = texelFetch(colours, at, 0);
  gl_Position = projectionMatrix * modelViewMatrix * vec4(texelFetch(frames, at, 0).xyz, 1.0);
}
`, /* glsl */ `${PLACE}
in vec4 tint;
out vec4 colour;
void main() { colour = tint; }
`];

export class Flat {
  /** @type {number[]} */
  places = [];
  /** @type {number[]} */
  tints = [];
  /** @type {{ count: number, frames: Texture, colours: Texture } | null} */
  made = null;

  // Add points, each a vector in the axes of the scene; `colour` is #rrggbb.
  /** @param {Vector[]} points @param {string} colour @param {number} [opacity] */
  add(points, colour, opacity = 1) {
    const tint = [1, 3, 5].map((i) => parseInt(colour.slice(i, i + 2), 16));
    for (const point of points) {
      this.places.push(point[0], point[1], point[2], 0);
      this.tints.push(...tint, Math.round(255 * opacity));
    }
    this.dispose();
  }

  // Add a strip between two rows of points.
  /** @param {Vector[]} a @param {Vector[]} b @param {string} colour @param {number} [opacity] */
  strip(a, b, colour, opacity) {
    for (let i = 0; i + 1 < a.length; i++) this.add([a[i], b[i], a[i + 1], a[i + 1], b[i], b[i + 1]], colour, opacity);
  }

  // Add a convex area, as triangles from its middle to its edge.
  /** @param {Vector} middle @param {Vector[]} edge @param {string} colour @param {number} [opacity] */
  fan(middle, edge, colour, opacity) {
    edge.forEach((point, i) => this.add([middle, point, edge[(i + 1) % edge.length]], colour, opacity));
  }

  clear() {
    [this.places, this.tints] = [[], []];
    this.dispose();
  }

  dispose() {
    this.made?.frames.dispose();
    this.made?.colours.dispose();
    this.made = null;
  }

  // Draw the points three by three as triangles, or two by two as lines.
  /** @param {Context} context @param {Camera} camera @param {boolean} lines */
  draw(context, camera, lines) {
    const { gl } = context;
    const count = this.places.length / 4;
    if (!count) return;
    if (!this.made) {
      const rows = Math.ceil(count / WIDE);
      const places = new Float32Array(4 * WIDE * rows);
      const tints = new Uint8Array(4 * WIDE * rows);
      places.set(this.places);
      tints.set(this.tints);
      this.made = { count, frames: new Texture(places, WIDE, rows, 'frames'), colours: new Texture(tints, WIDE, rows, 'colours') };
    }
    const { frames, colours } = this.made;
    gl.enable(gl.BLEND);
    gl.blendFuncSeparate(gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA, gl.ONE, gl.ONE);
    gl.depthMask(false);
    context.programs.flat.use({ frames, colours, modelViewMatrix: camera.modelView(), projectionMatrix: camera.projection });
    gl.drawArrays(lines ? gl.LINES : gl.TRIANGLES, 0, count);
    gl.depthMask(true);
    gl.disable(gl.BLEND);
  }
}
