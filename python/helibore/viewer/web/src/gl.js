// The part of WebGL 2 that the page needs: textures and index buffers, which are uploaded again after the browser has lost
// the context, and programs, whose uniforms are set by name.

/** @type {Record<'texels' | 'value' | 'pair' | 'frames' | 'colours', (keyof WebGL2RenderingContext)[]>} */
const FORMATS = {
  texels: ['RGBA16UI', 'RGBA_INTEGER', 'UNSIGNED_SHORT'],
  value: ['R32F', 'RED', 'FLOAT'],
  pair: ['RG32F', 'RG', 'FLOAT'],
  frames: ['RGBA32F', 'RGBA', 'FLOAT'],
  colours: ['RGBA8', 'RGBA', 'UNSIGNED_BYTE'],
};
const SAMPLERS = ['texels', 'column', 'frames', 'colours', 'dynamicRange']; // each has its own texture unit

// An array as a texture; it is uploaded when it is first used, after `change`, and in a new context.
export class Texture {
  /** @type {Context | null} */
  context = null;
  /** @type {WebGLTexture | null} */
  texture = null;
  changed = true;

  /** @param {ArrayBufferView} array @param {number} width @param {number} height @param {keyof typeof FORMATS} format */
  constructor(array, width, height, format) {
    this.array = array;
    this.width = width;
    this.height = height;
    this.format = FORMATS[format];
  }

  change() {
    this.changed = true;
  }

  /** @param {Context} context @param {number} unit */
  bind(context, unit) {
    const { gl } = context;
    gl.activeTexture(gl.TEXTURE0 + unit);
    if (this.context !== context) {
      this.context = context;
      this.texture = gl.createTexture();
      this.changed = true;
      gl.bindTexture(gl.TEXTURE_2D, this.texture);
      for (const side of [gl.TEXTURE_WRAP_S, gl.TEXTURE_WRAP_T]) gl.texParameteri(gl.TEXTURE_2D, side, gl.CLAMP_TO_EDGE);
      for (const way of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER]) gl.texParameteri(gl.TEXTURE_2D, way, gl.NEAREST);
    } else gl.bindTexture(gl.TEXTURE_2D, this.texture);
    if (!this.changed) return;
    this.changed = false;
    const [internal, format, type] = this.format.map((name) => Number(gl[name]));
    gl.texImage2D(gl.TEXTURE_2D, 0, internal, this.width, this.height, 0, format, type, this.array);
  }

  dispose() {
    this.context?.gl.deleteTexture(this.texture);
    this.context = null;
  }
}

class Program {
  /** @param {Context} context @param {string} vertex @param {string} fragment */
  constructor(context, vertex, fragment) {
    const { gl } = context;
    this.context = context;
    this.program = gl.createProgram();
    const shaders = [this.compiled(gl.VERTEX_SHADER, vertex), this.compiled(gl.FRAGMENT_SHADER, fragment)];
    gl.linkProgram(this.program);
    const problems = shaders.map((shader) => gl.getShaderInfoLog(shader)).join('');
    if (!gl.getProgramParameter(this.program, gl.LINK_STATUS) && !gl.isContextLost()) throw new Error(problems || String(gl.getProgramInfoLog(this.program)));
    const count = gl.getProgramParameter(this.program, gl.ACTIVE_UNIFORMS) ?? 0;
    this.uniforms = Array.from({ length: count }, (_, i) => this.uniform(i));
  }

  /** @param {number} type @param {string} source */
  compiled(type, source) {
    const { gl } = this.context;
    const shader = /** @type {WebGLShader} */ (gl.createShader(type));
    gl.shaderSource(shader, `#version 300 es\n${source}`);
    gl.compileShader(shader);
    gl.attachShader(this.program, shader);
    return shader;
  }

  /** @param {number} i */
  uniform(i) {
    const { gl } = this.context;
    const { name, type } = /** @type {WebGLActiveInfo} */ (gl.getActiveUniform(this.program, i));
    /** @type {unknown} */
    const held = undefined;
    return { name: name.replace('[0]', ''), type, at: gl.getUniformLocation(this.program, name), unit: SAMPLERS.indexOf(name), held };
  }

  // Make this the current program, and set its uniforms by name; values without a uniform are not used. A number that a uniform
  // has already is not set again.
  /** @param {Record<string, any>} values */
  use(values) {
    const { gl } = this.context;
    gl.useProgram(this.program);
    for (const uniform of this.uniforms) {
      const { name, type, at, unit } = uniform;
      if (unit >= 0) values[name].bind(this.context, unit);
      const value = unit >= 0 ? unit : values[name];
      if (uniform.held === value) continue;
      if (typeof value !== 'object') uniform.held = value;
      if (type === gl.FLOAT) gl.uniform1f(at, value);
      else if (typeof value !== 'object') gl.uniform1i(at, Number(value));
      else if (type === gl.FLOAT_VEC2) gl.uniform2fv(at, value);
      else if (type === gl.FLOAT_VEC4) gl.uniform4fv(at, value);
      else gl.uniformMatrix4fv(at, false, value);
    }
  }
}

// The objects of one context; they are lost if the context is lost.
export class Context {
  /** @type {WebGLFramebuffer | null} */
  spot = null; // framebuffer of one pixel

  /** @param {WebGL2RenderingContext} gl @param {Record<string, [string, string]>} shaders */
  constructor(gl, shaders) {
    this.gl = gl;
    /** @type {Record<string, Program>} */
    this.programs = {};
    for (const [name, pair] of Object.entries(shaders)) this.add(name, pair);
    /** @type {Map<string, WebGLBuffer>} */
    this.grids = new Map();
    gl.enable(gl.DEPTH_TEST);
    gl.depthFunc(gl.LEQUAL);
    gl.enable(gl.SCISSOR_TEST);
  }

  // Add a program, unless it is there already.
  /** @param {string} name @param {[string, string]} pair */
  add(name, pair) {
    this.programs[name] ??= new Program(this, ...pair);
  }

  // Draw `count` indices, from number `first` on, of the index buffer `key`; if it is new, `make` returns its indices.
  /** @param {string} key @param {() => Uint16Array} make @param {number} first @param {number} count */
  drawGrid(key, make, first, count) {
    const { gl } = this;
    const known = this.grids.get(key);
    const grid = known ?? gl.createBuffer();
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, grid);
    if (!known) {
      this.grids.set(key, grid);
      gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, make(), gl.STATIC_DRAW);
    }
    gl.drawElements(gl.TRIANGLES, count, gl.UNSIGNED_SHORT, 2 * first);
  }

  // Return red, green, blue and alpha of a picture of one pixel, which `draw` draws.
  /** @param {() => void} draw */
  onePixel(draw) {
    const { gl } = this;
    this.spot ??= this.makeSpot();
    gl.bindFramebuffer(gl.FRAMEBUFFER, this.spot);
    gl.viewport(0, 0, 1, 1);
    gl.scissor(0, 0, 1, 1);
    gl.clearColor(0, 0, 0, 0);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    draw();
    const pixel = new Uint8Array(4);
    gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, pixel);
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
    return pixel;
  }

  makeSpot() {
    const { gl } = this;
    const spot = gl.createFramebuffer();
    gl.bindFramebuffer(gl.FRAMEBUFFER, spot);
    for (const [format, place] of [[gl.RGBA8, gl.COLOR_ATTACHMENT0], [gl.DEPTH_COMPONENT16, gl.DEPTH_ATTACHMENT]]) {
      gl.bindRenderbuffer(gl.RENDERBUFFER, gl.createRenderbuffer());
      gl.renderbufferStorage(gl.RENDERBUFFER, format, 1, 1);
      gl.framebufferRenderbuffer(gl.FRAMEBUFFER, place, gl.RENDERBUFFER, gl.getParameter(gl.RENDERBUFFER_BINDING));
    }
    return spot;
  }
}
