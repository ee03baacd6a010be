// The one WebGL canvas: the image track and the 3-D view are two scissored parts of it and share every texture.
//
// Positions are kept small for the GPU's float32: a tile's centres are relative to the tile, a tile relative to the
// middle of the section, both subtracted in float64 here. The camera circles that middle.

import * as THREE from 'three';
import { Q_ATTRIBUTE, themed } from './colour.js';
import { pixelRatio, SOFTWARE } from './device.js';
import { COL_STRIDES, ROW_STRIDES, gridIndices, pickStride, rowsShown } from './lod.js';
import { placeInside, WIDE } from './inside.js';
import { CUTS } from './path.js';
import * as shaders from './shaders.js';
import { colourTexture, eastNorthUp, NO_COLUMN, NO_RANGE, TileTextures } from './textures.js';

THREE.ColorManagement.enabled = false; // colours are what the maps say, byte for byte
const FIELD_OF_VIEW = 34;
const NO_WALL = 0x9aa3aa;
const MOST_PICKED = 254; // tiles told apart by the picking picture's alpha

export class Gpu {
  constructor(canvas) {
    this.renderer = new THREE.WebGLRenderer({ canvas, antialias: !SOFTWARE, powerPreference: 'high-performance' });
    this.renderer.outputColorSpace = THREE.LinearSRGBColorSpace;
    this.renderer.autoClear = false;
    this.outside = new THREE.PerspectiveCamera(FIELD_OF_VIEW, 1, 0.1, 1e5);
    this.outside.up.set(0, 0, 1);
    this.inside = new THREE.PerspectiveCamera(WIDE, 1, 0.1, 1e5);
    this.head = { left: 0, raised: 0 }; // where the eye inside looks, radians from along the hole
    this.camera = this.outside;
    this.wallScene = new THREE.Scene();
    this.imageScene = new THREE.Scene();
    this.grids = new Map();
    this.flat = new THREE.BufferGeometry();
    this.flat.setIndex([0, 1, 2, 2, 1, 3]);
    this.materials = {
      wall: material(shaders.WALL_VERTEX, shaders.WALL_FRAGMENT),
      pick: material(shaders.WALL_VERTEX, shaders.PICK_FRAGMENT),
      image: material(shaders.IMAGE_VERTEX, shaders.IMAGE_FRAGMENT),
    };
    this.materials.image.depthTest = false;
    this.bit = bitGlyph();
    this.wallScene.add(this.bit);
    this.spot = new THREE.WebGLRenderTarget(1, 1);
    this.stats = { triangles: 0, tiles: 0 };
    this.origin = [0, 0, 0];
  }

  get canvas() {
    return this.renderer.domElement;
  }

  resize(width, height) {
    this.height = height;
    this.renderer.setPixelRatio(pixelRatio(this.canvas));
    this.renderer.setSize(width, height, false);
  }

  // `look` is one frame's picture: store, path, view, quantity, pieces and rectangles; main.js makes it.
  draw(look) {
    const { renderer } = this;
    renderer.setScissorTest(false);
    renderer.setClearColor(look.background, 1);
    renderer.clear();
    renderer.setScissorTest(true);
    this.stats = { triangles: 0, tiles: look.wallPieces.length };
    this.image(look);
    this.wall(look);
  }

  // Call back when what was asked for is drawn; in software that is long after draw() has returned.
  whenDrawn(done) {
    const gl = this.renderer.getContext();
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

  image(look) {
    const { top, bottom } = look.view;
    const { height } = look.imageRect;
    this.begin(look.imageRect);
    const y = (depth) => 1 - (2 * (depth - top)) / (bottom - top);
    fill(this.imageScene, look.imagePieces, (piece) => {
      const { level } = piece.tile;
      const pixel = (bottom - top) / height; // antialiasing would show an edge: overlap, the shader knows its rows
      const [a, b] = slanted(piece).map((end, i) => end + (i ? pixel : -pixel));
      return this.mesh(this.flat, this.materials.image, piece, look, (uniforms) => {
        const { reference, offset } = CUTS[look.view.cut];
        uniforms.screenEnds.value.set(y(a), y(b));
        uniforms.depthEnds.value.set(a - piece.tile.startDepth, b - piece.tile.startDepth);
        uniforms.reference.value = reference === 'up' ? 0 : 1;
        uniforms.offset.value = (offset * Math.PI) / 180;
        uniforms.perPixel.value = (bottom - top) / height / Math.abs(level.pitch);
      });
    });
    this.renderer.render(this.imageScene, this.camera);
  }

  wall(look) {
    this.place(look);
    this.begin(look.wallRect);
    if (look.view.camera !== 'outside') {
      this.renderer.setClearColor(NO_WALL, 1); // a gap around the eye has the grey of no data
      this.renderer.clear();
    }
    this.fillWall(look, this.materials.wall);
    this.drawBit(look);
    this.renderer.render(this.wallScene, this.camera);
    this.stats.triangles = this.renderer.info.render.triangles;
  }

  // Put the middle of the section at the origin of the scene.
  place(look) {
    const { path, view, wallRect } = look;
    const frame = path.at(view.middle);
    if (frame) this.origin = eastNorthUp(frame.centre);
    this.camera = view.camera === 'outside' ? this.outside : this.inside;
    if (this.camera === this.inside) {
      placeInside(this.inside, this, look, this.head);
      return;
    }
    this.camera.aspect = wallRect.width / Math.max(1, wallRect.height);
    const far = this.camera.position.length();
    this.camera.near = Math.max(0.01, far / 500);
    this.camera.far = far + 4 * view.length + 100;
    this.camera.updateProjectionMatrix();
    this.camera.updateMatrixWorld();
  }

  fillWall(look, used) {
    const { store, path, view } = look;
    const tube = view.tubeFactor(store);
    const pixel = look.wallRect.height / (2 * Math.tan((this.camera.fov * Math.PI) / 360));
    const picked = used === this.materials.pick;
    this.drawn = look.wallPieces.filter(({ tile }) => path.count > (tile.startDepth - path.startDepth) / path.step);
    if (picked) this.drawn = this.drawn.slice(0, MOST_PICKED);
    fill(this.wallScene, this.drawn, (piece, index) => {
      const { tile } = piece;
      const frames = this.textures(tile).path(path);
      const away = Math.max(this.distance(piece, look), 0.2);
      const strides = {
        cols: pickStride(COL_STRIDES, ((2 * Math.PI * store.bitRadius * tube) / tile.level.sectors / away) * pixel, tile.level.sectors / 8),
        rows: pickStride(ROW_STRIDES, (Math.abs(tile.level.pitch) / away) * pixel, tile.level.rows / 4),
      };
      const geometry = this.grid(tile.level, strides);
      const mesh = this.mesh(geometry, used, piece, look, (uniforms) => {
        geometry.setDrawRange(...rowsShown(piece, view, tile.level, strides));
        uniforms.tube.value = tube;
        uniforms.shape.value = view.shape;
        uniforms.median.value = view.median;
        const [a, b] = slanted(piece);
        uniforms.top.value = Math.max(a, view.top) - tile.startDepth;
        uniforms.bottom.value = Math.min(b, view.bottom) - tile.startDepth;
        uniforms.cursor.value = view.cursor ? view.cursor.depth - tile.startDepth : 1e9;
        uniforms.lamp.value = view.camera === 'outside' ? 0 : view.length;
        uniforms.number.value = index + 1;
      });
      mesh.position.set(...frames.origin.map((x, c) => x - this.origin[c]));
      return mesh;
    });
  }

  // From the camera to the nearest point of a piece's axis.
  distance({ top, bottom }, { path }) {
    const [a, b] = [top, bottom].map((depth) => new THREE.Vector3(...this.position(path.at(depth))));
    const near = new THREE.Line3(a, b).closestPointToPoint(this.camera.position, true, new THREE.Vector3());
    return near.distanceTo(this.camera.position);
  }

  position(frame) {
    return eastNorthUp(frame.centre).map((x, c) => x - this.origin[c]);
  }

  mesh(geometry, used, piece, look, own) {
    const mesh = new THREE.Mesh(geometry, used);
    mesh.frustumCulled = false;
    mesh.onBeforeRender = () => {
      this.common(used.uniforms, piece.tile, look);
      own(used.uniforms);
      used.uniformsNeedUpdate = true;
    };
    return mesh;
  }

  common(uniforms, tile, { store, path, view, quantity, glow, dark }) {
    const textures = this.textures(tile);
    const { level } = tile;
    const frames = textures.path(path);
    const values = {
      texels: textures.vertices(),
      column: quantity.mode === Q_ATTRIBUTE ? textures.attribute(quantity.attribute) : NO_COLUMN,
      frames: frames.texture,
      colours: colourTexture(themed(quantity.map, dark)),
      dynamicRange: quantity.dynamic ? textures.dynamic(store, quantity, view.pass) : NO_RANGE,
      K: level.sectors,
      rings: level.rings,
      rows: level.rows,
      size: level.shown - tile.index * level.tileSize,
      pitch: level.pitch,
      startToolface: (level.startToolface * Math.PI) / 180,
      radiusUnit: store.radiusUnit,
      nearestUnit: store.nearestUnit,
      bitRadius: store.bitRadius,
      firstFrame: frames.first,
      frameStep: path.step,
      firstPass: view.pass === 'first',
      mode: quantity.mode,
      low: quantity.low,
      high: quantity.high,
      logarithmic: quantity.log,
      isDynamic: quantity.dynamic,
      dark,
    };
    for (const [name, value] of Object.entries(values)) uniforms[name].value = value;
    const here = glow(tile);
    uniforms.glowCount.value = here.length;
    here.forEach((part, i) => uniforms.glow.value[i].set(...part));
  }

  textures(tile) {
    tile.textures ??= new TileTextures(tile);
    return tile.textures;
  }

  grid(level, { cols, rows }) {
    const key = `${level.sectors}/${level.rows}/${cols}/${rows}`;
    if (!this.grids.has(key)) {
      const geometry = new THREE.BufferGeometry();
      geometry.setIndex(new THREE.BufferAttribute(gridIndices(level.sectors, level.rows, cols, rows), 1));
      this.grids.set(key, geometry);
    }
    return this.grids.get(key);
  }

  drawBit({ store, path, view, bitDepth }) {
    const frame = bitDepth === null ? null : path.at(bitDepth);
    this.bit.visible = frame !== null && bitDepth >= view.top && bitDepth <= view.bottom;
    if (!this.bit.visible) return;
    const size = store.bitRadius * view.tubeFactor(store);
    this.bit.position.set(...this.position(frame));
    this.bit.scale.setScalar(size);
    this.bit.quaternion.setFromUnitVectors(new THREE.Vector3(0, 1, 0), new THREE.Vector3(...eastNorthUp(frame.tangent)));
  }

  // Stand beside the section so that all of it is in view.
  lookAtSection(length, frame, radius, { width, height }) {
    const along = new THREE.Vector3(...eastNorthUp(frame.tangent));
    const level = new THREE.Vector3(along.y, -along.x, 0); // to the side of the hole, level
    if (level.length() < 0.05) level.set(0.5, -1, 0);
    const up = new THREE.Vector3(0, 0, 1).projectOnPlane(along);
    const from = level.normalize().addScaledVector(up, 0.25).normalize();
    const half = Math.tan((FIELD_OF_VIEW * Math.PI) / 360);
    const tall = Math.abs(along.z) * length + 2.6 * radius;
    const wide = Math.hypot(along.x, along.y) * length + 2.6 * radius;
    const away = Math.max(tall / 2 / half, wide / 2 / half / Math.max(0.2, width / height));
    this.outside.position.copy(from.multiplyScalar(1.16 * away + radius));
    this.outside.lookAt(0, 0, 0);
  }

  // The quad under a point of the 3-D view: {tile, at} or null.
  pick(look, x, y) {
    const { width, height } = look.wallRect;
    this.place(look);
    this.fillWall(look, this.materials.pick);
    this.bit.visible = false;
    const { renderer, camera } = this;
    camera.setViewOffset(width, height, x, y, 1, 1);
    renderer.setScissorTest(false);
    renderer.setRenderTarget(this.spot);
    renderer.setClearColor(0, 0);
    renderer.clear();
    renderer.render(this.wallScene, camera);
    const pixel = new Uint8Array(4);
    renderer.readRenderTargetPixels(this.spot, 0, 0, 1, 1, pixel);
    renderer.setRenderTarget(null);
    camera.clearViewOffset();
    if (pixel[3] === 0) return null;
    return { tile: this.drawn[pixel[3] - 1].tile, at: pixel[0] + 256 * pixel[1] + 65536 * pixel[2] };
  }

  // A place of the hole on the 3-D view in pixels, or null behind the camera.
  project(frame, rect, aside = [0, 0, 0]) {
    const v = new THREE.Vector3(...this.position(frame).map((x, c) => x + aside[c])).project(this.camera);
    if (v.z > 1 || v.z < -1) return null;
    return [rect.left + ((v.x + 1) / 2) * rect.width, rect.top + ((1 - v.y) / 2) * rect.height];
  }

  // A step of some metres to the side of the hole as seen on screen: to the right, or up where it lies level.
  aside(frame, metres) {
    const towards = this.camera.getWorldDirection(new THREE.Vector3());
    const side = new THREE.Vector3(...eastNorthUp(frame.tangent)).cross(towards);
    if (side.length() < 1e-3) side.set(...this.camera.matrixWorld.elements.slice(0, 3));
    const e = this.camera.matrixWorld.elements;
    const [right, up] = [0, 4].map((i) => side.x * e[i] + side.y * e[i + 1] + side.z * e[i + 2]);
    const sign = Math.abs(right) > 0.5 * Math.abs(up) ? Math.sign(right) : Math.sign(up);
    side.setLength(metres * sign);
    return [side.x, side.y, side.z];
  }

  // A direction as seen: right, up, towards the eye.
  facing(direction) {
    const v = new THREE.Vector3(...direction).transformDirection(this.camera.matrixWorldInverse);
    return [v.x, v.y, v.z];
  }

  begin({ left, top, width, height }) {
    const y = this.height - top - height;
    this.renderer.setViewport(left, y, width, height);
    this.renderer.setScissor(left, y, width, height);
  }
}

// A helix ends on a slant: a tile's last turn reaches one pitch beyond the depth at which the next tile begins.
const slanted = ({ tile: { level }, top, bottom }) => {
  if (level.rings) return [top, bottom];
  return level.pitch > 0 ? [top, bottom + level.pitch] : [top + level.pitch, bottom];
};

// Show exactly these pieces in a scene; meshes are light, geometries and materials shared.
function fill(scene, pieces, make) {
  for (const child of [...scene.children]) if (child.userData.piece) scene.remove(child);
  pieces.forEach((piece, index) => {
    const mesh = make(piece, index);
    mesh.userData.piece = true;
    mesh.renderOrder = index; // the overview comes first in the list and lies under the wall
    scene.add(mesh);
  });
}

const UNIFORMS = [
  'texels', 'column', 'frames', 'colours', 'dynamicRange', 'K', 'rings', 'rows', 'pitch', 'startToolface', 'radiusUnit', 'nearestUnit',
  'bitRadius', 'firstFrame', 'frameStep', 'firstPass', 'mode', 'low', 'high', 'logarithmic', 'isDynamic', 'dark', 'glowCount',
  'tube', 'shape', 'median', 'top', 'bottom', 'cursor', 'number', 'reference', 'offset', 'perPixel', 'size', 'lamp',
];

function material(vertexShader, fragmentShader) {
  const uniforms = Object.fromEntries(UNIFORMS.map((name) => [name, { value: 0 }]));
  uniforms.glow = { value: Array.from({ length: 8 }, () => new THREE.Vector4()) };
  uniforms.screenEnds = { value: new THREE.Vector2() };
  uniforms.depthEnds = { value: new THREE.Vector2() };
  return new THREE.RawShaderMaterial({ glslVersion: THREE.GLSL3, vertexShader, fragmentShader, uniforms, side: THREE.DoubleSide });
}

// A drill bit of radius 1, turned from its outline: nose at the bit's depth, gauge, shank.
function bitGlyph() {
  const outline = [[0, 0], [0.6, -0.2], [1, -0.7], [1, -1.3], [0.5, -1.6], [0.5, -2.4], [0, -2.4]];
  const shape = new THREE.LatheGeometry(outline.map(([x, y]) => new THREE.Vector2(x, y)), 24);
  const glyph = new THREE.Mesh(shape, new THREE.RawShaderMaterial({
    glslVersion: THREE.GLSL3, vertexShader: shaders.BIT_VERTEX, fragmentShader: shaders.BIT_FRAGMENT, side: THREE.DoubleSide,
  }));
  glyph.visible = false;
  return glyph;
}
