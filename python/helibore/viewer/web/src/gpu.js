// The one WebGL canvas: the image track and the 3-D view are two scissored parts of it and share every texture.
//
// Positions are kept small for the GPU's float32: a tile's centres are relative to the tile, a tile relative to the
// middle of the section, both subtracted in float64 here. The camera circles that middle.

import { Camera } from './camera.js';
import { Q_ATTRIBUTE, themed } from './color.js';
import { pixelRatio, SOFTWARE } from './device.js';
import { Context } from './gl.js';
import { eyeDepth, placeInside, WIDE } from './inside.js';
import { loaded } from './late.js';
import { COL_STRIDES, ROW_STRIDES, gridIndices, pickStride, rowsShown } from './lod.js';
import { CUTS } from './path.js';
import * as shaders from './shaders.js';
import { colourTexture, NO_COLUMN, NO_RANGE, TileTextures } from './textures.js';
import { cross, dot, eastNorthUp, length, minus, normalised, plus, scaled } from './vectors.js';

const FIELD_OF_VIEW = 34;
const UNLIT = 0x08090b; // beyond the reach of the lamp
const MOST_PICKED = 254; // most tiles of a picking picture: alpha is the number of the tile
/** @type {Record<string, [string, string]>} */
export const PROGRAMS = {
  wall: [shaders.WALL_VERTEX, shaders.WALL_FRAGMENT],
  pick: [shaders.WALL_VERTEX, shaders.PICK_FRAGMENT],
  image: [shaders.IMAGE_VERTEX, shaders.IMAGE_FRAGMENT],
  column: [shaders.COLUMN_VERTEX, shaders.COLUMN_FRAGMENT],
};

export class Gpu {
  context = /** @type {Context} */ (/** @type {unknown} */ (null));

  /** @param {Canvas} canvas */
  constructor(canvas) {
    this.canvas = canvas;
    const gl = canvas.getContext('webgl2', { antialias: !SOFTWARE, alpha: false, powerPreference: 'high-performance' });
    if (!gl) throw new Error('no WebGL 2 context');
    this.gl = gl;
    canvas.addEventListener('webglcontextlost', (event) => event.preventDefault());
    canvas.addEventListener('webglcontextrestored', () => this.restore());
    this.outside = new Camera(FIELD_OF_VIEW);
    this.inside = new Camera(WIDE);
    this.camera = this.outside;
    this.width = this.height = this.ratio = 0;
    this.share = 1; // of the pixels in each direction
    /** @type {Piece[]} */
    this.drawn = [];
    this.stats = { triangles: 0, tiles: 0, pictures: 0 };
    this.cost = 0; // milliseconds that the last full picture took
    this.origin = [0, 0, 0];
    this.restore();
  }

  restore() {
    this.context = new Context(this.gl, PROGRAMS);
  }

  /** @param {number} width @param {number} height */
  resize(width, height) {
    if (width !== this.width || height !== this.height) Object.assign(this, { width, height, ratio: 0 });
  }

  // Give the canvas its size in pixels; a coarse picture has a share of these pixels in each direction.
  /** @param {number} ratio */
  setRatio(ratio) {
    if (ratio === this.ratio) return;
    this.ratio = ratio;
    [this.canvas.width, this.canvas.height] = [this.width, this.height].map((side) => Math.floor(side * ratio));
  }

  // `look` is one frame's picture: store, path, view, quantity, pieces and rectangles; main.js makes it.
  /** @param {Looks} look @param {number} [share] of the pixels in each direction */
  draw(look, share = 1) {
    if (this.gl.isContextLost()) return undefined;
    this.share = share;
    this.setRatio(pixelRatio(this.canvas) * share);
    this.stats = { triangles: 0, tiles: look.wallPieces.length, pictures: this.stats.pictures + 1 };
    this.begin({ left: 0, top: 0, width: this.width, height: this.height }, look.background);
    for (const one of look.images) this.image(one);
    if (look.curtain) this.image(look.curtain, look.curtain.from);
    if (look.wallRect.width < 1) return undefined;
    if (look.view.camera === 'straight') return this.column(look);
    this.place(look);
    this.begin(look.wallRect, look.view.camera === 'outside' ? null : UNLIT);
    this.wall(look, 'wall');
    return this.bit(look);
  }

  // Draw the straightened hole, with the same depth axis as the tracks.
  /** @param {Look} look */
  column(look) {
    const { store, view, wallRect, path } = look;
    const { reference, offset } = CUTS[view.cut];
    const scale = columnScale(look);
    this.begin(wallRect);
    for (const piece of look.wallPieces) {
      const { tile } = piece;
      const { level } = tile;
      if (path.count <= (tile.startDepth - path.startDepth) / path.step) continue;
      const [a, b] = slanted(piece);
      this.context.programs.column.use({
        ...this.common(tile, look),
        shape: scale.shape,
        median: view.median,
        across: (2 * scale.perMetre) / wallRect.width,
        relief: 0.15 * scale.times,
        viewTop: view.top - tile.startDepth,
        viewLength: view.length,
        pixelHeight: view.length / Math.round(wallRect.height * this.ratio),
        reference: reference === 'up' ? 0 : 1,
        offset: ((offset - view.turn) * Math.PI) / 180,
        top: Math.max(a, view.top) - tile.startDepth,
        bottom: Math.min(b, view.bottom) - tile.startDepth,
      });
      this.drawRows(piece, view, {
        cols: pickStride(COL_STRIDES, (2 * Math.PI * store.bitRadius * scale.perMetre) / level.columns, level.columns / 8),
        rows: pickStride(ROW_STRIDES, (wallRect.height / view.length) * Math.abs(level.pitch), level.rows / 4),
      });
    }
  }

  // Restrict drawing to a rectangle, from a share of its width on, and clear it to a colour if there is one.
  /** @type {(rect: Rect, colour?: number | null, from?: number) => void} */
  begin({ left, top, width, height }, colour = null, from = 0) {
    const { gl, ratio } = this;
    const [x, y, w, h] = [left, this.height - top - height, width, height].map((side) => Math.round(side * ratio));
    gl.viewport(x, y, w, h);
    const hidden = Math.round(from * w);
    gl.scissor(x + hidden, y, w - hidden, h);
    if (colour === null) return;
    const [red, green, blue] = [16, 8, 0].map((shift) => ((colour >> shift) & 255) / 255);
    gl.clearColor(red, green, blue, 1);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
  }

  // Call `done` when the requested picture is drawn; with software drawing, that is long after draw() has returned.
  /** @param {() => void} done */
  whenDrawn(done) {
    const { gl } = this;
    const fence = gl.fenceSync(gl.SYNC_GPU_COMMANDS_COMPLETE, 0);
    gl.flush();
    const look = () => {
      const waits = fence && !gl.isContextLost() && gl.clientWaitSync(fence, 0, 0) === gl.TIMEOUT_EXPIRED;
      if (waits) setTimeout(look, 10);
      else {
        gl.deleteSync(fence);
        done();
      }
    };
    setTimeout(look, 10);
  }

  /** @param {Look} look @param {number} [from] share of the width */
  image(look, from = 0) {
    const { gl, context } = this;
    const { top, bottom, cut } = look.view;
    const { height } = look.imageRect;
    const { reference, offset } = CUTS[cut];
    this.begin(look.imageRect, from ? look.background : null, from);
    gl.disable(gl.DEPTH_TEST);
    /** @param {number} depth */
    const y = (depth) => 1 - (2 * (depth - top)) / (bottom - top);
    const pixel = (bottom - top) / height;
    const overlap = pixel + (look.quantity.rows?.[1] ?? 0); // antialiasing would show the edge of a piece; the shader discards the rows of other tiles
    for (const piece of look.imagePieces) {
      const { tile } = piece;
      const [a, b] = slanted(piece).map((end, i) => end + (i ? overlap : -overlap));
      context.programs.image.use({
        ...this.common(tile, look),
        screenEnds: [y(a), y(b)],
        depthEnds: [a - tile.startDepth, b - tile.startDepth],
        reference: reference === 'up' ? 0 : 1,
        offset: (offset * Math.PI) / 180,
        perPixel: pixel / Math.abs(tile.level.pitch),
      });
      gl.drawArrays(gl.TRIANGLE_STRIP, 0, 4);
    }
    gl.enable(gl.DEPTH_TEST);
  }

  // Put the middle of the section at the origin of the scene.
  /** @param {Look} look */
  place(look) {
    const { path, view, wallRect } = look;
    this.origin = eastNorthUp(path.at(view.middle).centre);
    this.camera = view.camera === 'outside' ? this.outside : this.inside;
    if (this.camera === this.inside) {
      placeInside(this.inside, this, look);
      return;
    }
    const far = length(this.outside.position);
    Object.assign(this.camera, { aspect: wallRect.width / Math.max(1, wallRect.height), near: Math.max(0.01, far / 500), far: far + 4 * view.length + 100 });
  }

  /** @param {Look} look @param {'wall' | 'pick'} program */
  wall(look, program) {
    const { store, path, view, light } = look;
    const tube = view.tubeFactor(store);
    const inside = view.camera !== 'outside';
    const pixel = (look.wallRect.height * Math.min(1, this.ratio)) / (2 * this.camera.tangent);
    const radius = store.bitRadius * tube;
    this.drawn = (inside ? split(look.wallPieces, eyeDepth(look), radius) : look.wallPieces).filter(({ tile }) => path.count > (tile.startDepth - path.startDepth) / path.step);
    if (program === 'pick') this.drawn = this.drawn.slice(0, MOST_PICKED);
    const projectionMatrix = this.camera.projection;
    const more = inside && program === 'wall' ? loaded() : undefined;
    const fine = this.share === 1;
    const name = more ? `inside, ${fine ? 'fine' : 'coarse'}` : program; // a branch that is not taken costs time in software
    if (more) this.context.add(name, [shaders.WALL_VERTEX, `${shaders.INSIDE}const bool fine=${fine};${more.INSIDE_FRAGMENT}`]);
    this.drawn.forEach((piece, index) => { // the overview comes first in the list and lies under the wall
      const { tile } = piece;
      const { level } = tile;
      const away = Math.max(this.distance(piece, look), 0.2);
      const strides = {
        cols: pickStride(COL_STRIDES, ((2 * Math.PI * radius) / level.columns / away) * pixel, level.columns / 8),
        rows: pickStride(ROW_STRIDES, (Math.abs(level.pitch) / away) * pixel * (inside ? Math.min(1, radius / away) : 1), level.rows / 4), // from inside the wall is seen at a slant
      };
      const [a, b] = slanted(piece);
      this.context.programs[name].use({
        ...this.common(tile, look),
        projectionMatrix,
        modelViewMatrix: this.camera.modelView(minus(this.textures(tile).path(path).origin, this.origin)),
        tube,
        steep: inside ? [2, 2] : [1, tube], // from inside the texture of a wall is seen as it is, however wide the hole is drawn
        shape: view.shape || 1,
        stride: strides.rows,
        median: inside && view.median < 3 ? 0 : view.median,
        top: Math.max(a, view.top) - tile.startDepth,
        bottom: Math.min(b, view.bottom) - tile.startDepth,
        ...(inside ? { dark: false, colours: colourTexture(look.quantity.map), range: 0, ...(light && { column: this.textures(tile).attribute(light.attribute ?? 0), range: light.log ? Math.log(light.high / light.low) : light.high - light.low, imageLog: light.log }) } : {}), // the colour of the light page, as rock under a lamp
        number: index + 1,
        ...(program === 'pick' ? { imageRows: [0, 0] } : {}),
      });
      this.drawRows(piece, view, strides);
    });
  }

  // Draw the rows of a tile's grid that are in view, with every `cols`-th column and every `rows`-th row of its vertices.
  /** @param {Piece} piece @param {View} view @param {{ cols: number, rows: number }} of */
  drawRows(piece, view, { cols, rows }) {
    const { level } = piece.tile;
    const [first, count] = rowsShown(piece, view, level, { cols, rows });
    const made = () => gridIndices(level.columns, level.rows, cols, rows);
    this.context.drawGrid(`${level.columns}/${level.rows}/${cols}/${rows}`, made, first, count);
    this.stats.triangles += count / 3;
  }

  // Return the distance from the camera to the nearest point of a piece's axis.
  /** @param {Piece} piece @param {Look} look */
  distance({ top, bottom }, { path }) {
    const [a, b] = [top, bottom].map((depth) => this.position(path.at(depth)));
    const along = minus(b, a);
    const share = dot(minus(this.camera.position, a), along) / (dot(along, along) || 1);
    return length(minus(plus(a, along, Math.min(1, Math.max(0, share))), this.camera.position));
  }

  /** @param {Pick<Frame, 'centre'>} frame */
  position(frame) {
    return minus(eastNorthUp(frame.centre), this.origin);
  }

  // Return the uniforms that every program needs, from a tile and from the look.
  /** @param {Tile} tile @param {Look} look */
  common(tile, { store, path, view, quantity, glow, dark }) {
    const textures = this.textures(tile);
    const { level } = tile;
    const frames = textures.path(path);
    const here = glow(tile);
    return {
      texels: textures.vertices(),
      column: quantity.mode === Q_ATTRIBUTE ? textures.attribute(quantity.attribute ?? 0) : NO_COLUMN,
      frames: frames.texture,
      colours: colourTexture(themed(quantity.map, dark)),
      dynamicRange: quantity.dynamic ? textures.dynamic(store, quantity, view.pass) : NO_RANGE,
      K: level.sectors,
      rings: level.rings,
      rows: level.rows,
      size: Math.min(level.shown - tile.index * level.tileSize, 2 ** 30),
      pitch: level.pitch,
      startToolface: (level.startToolface * Math.PI) / 180,
      radiusUnit: store.radiusUnit,
      nearestUnit: store.nearestUnit,
      bitRadius: store.bitRadius,
      firstFrame: frames.first,
      frameStep: path.step,
      firstPass: view.pass === 'first',
      imageRows: quantity.rows && !level.rings ? [(quantity.rows[0] - tile.startDepth) % quantity.rows[1], quantity.rows[1]] : [0, 0],
      mode: quantity.mode,
      low: quantity.low,
      high: quantity.high,
      logarithmic: quantity.log,
      isDynamic: quantity.dynamic,
      dark,
      form: quantity.map !== themed(quantity.map, true) ? 1 : dark ? 0 : 0.3,
      glowCount: here.length,
      glow: [...here.flat(), ...Array(32).fill(0)].slice(0, 32),
    };
  }

  /** @param {Tile} tile */
  textures(tile) {
    tile.textures ??= new TileTextures(tile);
    return tile.textures;
  }

  /** @param {Look} look */
  bit({ store, path, view, bitDepth }) {
    const more = loaded();
    if (!more?.BIT || bitDepth === null || bitDepth < view.top || bitDepth > view.bottom) return;
    this.context.add('bit', more.BIT);
    const frame = path.at(bitDepth);
    const size = store.bitRadius * view.tubeFactor(store);
    const axes = [frame.high, frame.tangent, frame.right].map((axis) => scaled(eastNorthUp(axis), size));
    this.context.programs.bit.use({ modelViewMatrix: this.camera.modelView(this.position(frame), axes), projectionMatrix: this.camera.projection });
    this.gl.drawArrays(this.gl.TRIANGLES, 0, more.BIT_CORNERS);
  }

  // Place the camera beside the section so that the whole section is in view.
  /** @param {number} sectionLength @param {Frame} frame @param {number} radius @param {Rect} rect @param {number} [clear] pixels above and below it */
  lookAtSection(sectionLength, frame, radius, { width, height }, clear = CLEAR) {
    const along = eastNorthUp(frame.tangent);
    const aside = [along[1], -along[0], 0]; // to the side of the hole, level
    const level = length(aside) < 0.05 ? [0.5, -1, 0] : aside;
    const up = plus([0, 0, 1], along, -along[2]);
    const from = normalised(plus(normalised(level), up, 0.4));
    const half = this.outside.tangent;
    const tall = Math.abs(along[2]) * sectionLength + 2.6 * radius;
    const wide = Math.hypot(along[0], along[1]) * sectionLength + 2.6 * radius;
    const share = Math.max(0.5, 1 - (2 * clear) / height);
    const away = Math.max(tall / share, wide / Math.max(0.5, 1 - NAMES / width) / Math.max(0.2, width / height)) / 2 / half;
    this.outside.position = scaled(from, away + radius);
    this.outside.lookAt([0, 0, 0]);
  }

  // Return the quad under a point of the 3-D view, as {tile, at}, or null.
  /** @param {Look} look @param {number} x @param {number} y */
  pick(look, x, y) {
    const { width, height } = look.wallRect;
    this.place(look);
    this.camera.pixel = { x, y, width, height };
    const [red, green, blue, alpha] = this.context.onePixel(() => this.wall(look, 'pick'));
    this.camera.pixel = null;
    return alpha === 0 ? null : { tile: this.drawn[alpha - 1].tile, at: red + 256 * green + 65536 * blue };
  }

  // Returns where a place of the hole appears on the 3-D view, in pixels; null if it is behind the camera, too near or too far.
  // `aside` shifts the place.
  /** @param {Pick<Frame, 'centre'>} frame @param {Rect} rect @param {Vector} [aside] @returns {Pair | null} */
  project(frame, rect, aside = [0, 0, 0]) {
    const seen = this.camera.project(plus(this.position(frame), aside));
    return seen && [rect.left + ((seen[0] + 1) / 2) * rect.width, rect.top + ((1 - seen[1]) / 2) * rect.height];
  }

  // Return a step of `metres` to the side of the hole as seen on screen: to the right, or upwards where the hole lies level.
  /** @param {Frame} frame @param {number} metres */
  aside(frame, metres) {
    const [right, up, back] = this.camera.axes;
    const across = cross(eastNorthUp(frame.tangent), scaled(back, -1));
    const side = length(across) < 1e-3 ? right : across;
    const [toRight, upwards] = [dot(side, right), dot(side, up)];
    const sign = Math.abs(toRight) > 0.5 * Math.abs(upwards) ? Math.sign(toRight) : Math.sign(upwards);
    return scaled(normalised(side), metres * sign);
  }

  // Return a direction as the camera sees it: right, up, towards the eye.
  /** @param {Vector} direction */
  facing(direction) {
    return this.camera.facing(direction);
  }
}

const CLEAR = 80; // for controls, compass and words
const NAMES = 200; // pixels across for the names beside the hole
const BIT_SHARE = 0.2; // the bit's radius, as a share of the column's width
const COLUMN_SHAPE = 3; // the exaggeration of the shape in the column, if the user chose none

// Return the scale of the column: pixels a metre across the hole, how many times this is the scale along the hole, and the
// exaggeration of the shape about bit radius.
/** @param {Look} look */
export function columnScale({ store, view, wallRect }) {
  const perMetre = (BIT_SHARE * wallRect.width) / store.bitRadius;
  return { perMetre, times: (perMetre * view.length) / wallRect.height, shape: view.shape || COLUMN_SHAPE };
}

// Divide pieces where they are so many radii from the eye in the hole, so that what is far is drawn coarser.
/** @param {Piece[]} pieces @param {number} eye @param {number} radius */
function split(pieces, eye, radius) {
  const places = [-24, -6, -1.5, 1.5, 3, 6, 12, 24, 48].map((radii) => eye + radii * radius);
  return pieces.flatMap(({ tile, top, bottom }) => {
    const ends = [top, ...places.filter((place) => place > top && place < bottom), bottom];
    return ends.slice(1).map((end, i) => ({ tile, top: ends[i], bottom: end }));
  });
}

// A helix ends on a slant: a tile's last turn reaches one pitch beyond the depth at which the next tile begins.
/** @param {Piece} piece */
const slanted = ({ tile: { level }, top, bottom }) => {
  if (level.rings) return [top, bottom];
  return level.pitch > 0 ? [top, bottom + level.pitch] : [top + level.pitch, bottom];
};
