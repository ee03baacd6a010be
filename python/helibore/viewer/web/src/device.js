// Whether this machine draws with its processor instead of a graphics card. If so, every sample of a pixel is expensive, and
// so is every canvas that the browser sends through GL: edges are not smoothed, and 2-D canvases are kept off GL.

export const SOFTWARE = typeof document !== 'undefined' && /* @__PURE__ */ drawnInSoftware();

function drawnInSoftware() {
  const probe = document.createElement('canvas').getContext('webgl2');
  const about = probe?.getExtension('WEBGL_debug_renderer_info');
  const name = probe && about ? probe.getParameter(about.UNMASKED_RENDERER_WEBGL) : '';
  probe?.getExtension('WEBGL_lose_context')?.loseContext();
  return /swiftshader|llvmpipe|software/i.test(name);
}

/** @param {HTMLCanvasElement & { recorder?: Ink }} canvas */
export const pen = (canvas) => canvas.recorder ?? /** @type {Ink} */ (canvas.getContext('2d', { willReadFrequently: SOFTWARE }));

let least = 0;

// Draw with at least so many pixels per CSS pixel, for a picture that is saved.
/** @param {number} ratio */
export const sharpen = (ratio) => (least = ratio);

// Pixels of a canvas per CSS pixel of its element: on the screen at most two, because nobody sees more pixels.
/** @param {HTMLElement} element */
export const pixelRatio = (element) => Math.max(least, Math.min(window.devicePixelRatio * (element.currentCSSZoom ?? 1), 2));

// Fit a canvas to its element and forget the texts and strokes of the last picture.
/** @param {Canvas} canvas */
export function sized(canvas) {
  const ratio = pixelRatio(canvas);
  const { clientWidth: width, clientHeight: height } = canvas;
  const [w, h] = [Math.round(width * ratio), Math.round(height * ratio)];
  if (canvas.width !== w || canvas.height !== h) [canvas.width, canvas.height] = [w, h];
  const ink = pen(canvas);
  canvas.labels = [];
  canvas.strokes = [];
  ink.setTransform(ratio, 0, 0, ratio, 0, 0);
  return { ink, width, height };
}
