// A 2-D canvas whose strokes are kept as SVG. Drawings (WebGL, maps) are pictures in it; text stays text.

/** @param {string} text */
const escaped = (text) => text.replace(/[&<>"]/g, (letter) => `&#${letter.charCodeAt(0)};`);
/** @param {number} x */
const short = (x) => String(Number(x.toFixed(2)));

// Return a pen that draws as `real` does, and adds each stroke to `parts` in CSS pixels, of which one has `ratio` pixels.
/** @param {Ink} real @param {string[]} parts @param {() => number} ratio @returns {Ink} */
export function recorder(real, parts, ratio) {
  let path = '';
  let clips = 0;
  /** @type {number[]} */
  const open = []; // groups that each `save` opened
  /** @type {{ real: CanvasGradient, ends: number[], stops: string[] } | null} */
  let gradient = null;
  /** @param {number} x @param {number} y */
  const at = (x, y) => {
    const { a, d, e, f } = real.getTransform();
    return `${short((a * x + e) / ratio())} ${short((d * y + f) / ratio())}`;
  };
  /** @param {number} x @param {number} y */
  const move = (x, y) => (path += `M${at(x, y)}`);
  /** @param {number} x @param {number} y */
  const go = (x, y) => (path += `${path ? 'L' : 'M'}${at(x, y)}`);
  /** @param {number} x @param {number} y @param {number} w @param {number} h */
  const box = (x, y, w, h) => `M${at(x, y)}L${at(x + w, y)}L${at(x + w, y + h)}L${at(x, y + h)}Z`;
  const opacity = () => (real.globalAlpha < 1 ? ` opacity="${short(real.globalAlpha)}"` : '');
  const paint = () => {
    if (!gradient) return String(real.fillStyle);
    const id = `g${parts.length}`;
    const [[x1, y1], [x2, y2]] = [gradient.ends.slice(0, 2), gradient.ends.slice(2)].map(([x, y]) => at(x, y).split(' '));
    parts.push(`<linearGradient id="${id}" gradientUnits="userSpaceOnUse" x1="${x1}" y1="${y1}" x2="${x2}" y2="${y2}">${gradient.stops.join('')}</linearGradient>`);
    return `url(#${id})`;
  };
  /** @param {string} d */
  const filled = (d) => {
    const colour = paint();
    parts.push(`<path d="${d}" fill="${colour}"${opacity()}/>`);
  };
  const lined = () => {
    const dash = real.getLineDash();
    return `stroke="${real.strokeStyle}" stroke-width="${short(real.lineWidth)}"${dash.length ? ` stroke-dasharray="${dash}"` : ''}${real.lineJoin === 'round' ? ' stroke-linejoin="round"' : ''}${opacity()}`;
  };
  /** @param {string} text @param {number} x @param {number} y @param {string} look */
  const written = (text, x, y, look) => {
    const baseline = real.textBaseline;
    const above = real.measureText('H').actualBoundingBoxAscent;
    real.textBaseline = 'alphabetic';
    const [left, top] = at(x, y + real.measureText('H').actualBoundingBoxAscent - above).split(' ');
    real.textBaseline = baseline;
    const anchor = /** @type {Record<string, string>} */ ({ center: 'middle', right: 'end', end: 'end' })[real.textAlign] ?? 'start';
    parts.push(`<text x="${left}" y="${top}" text-anchor="${anchor}" style="font:${escaped(real.font)};white-space:pre" ${look}>${escaped(text)}</text>`);
  };
  /** @type {Record<string, (...of: any[]) => unknown>} */
  const own = {
    beginPath: () => (path = ''),
    moveTo: move,
    lineTo: go,
    closePath: () => (path += 'Z'),
    rect: (x, y, w, h) => (path += box(x, y, w, h)),
    arc: (x, y, r, from, to) => {
      const steps = Math.max(2, Math.ceil(Math.abs(to - from) / 0.1));
      for (let i = 0; i <= steps; i++) {
        const angle = from + ((to - from) * i) / steps;
        go(x + r * Math.cos(angle), y + r * Math.sin(angle));
      }
    },
    fill: () => filled(path),
    stroke: () => parts.push(`<path d="${path}" fill="none" ${lined()}/>`),
    fillRect: (x, y, w, h) => filled(box(x, y, w, h)),
    strokeRect: (x, y, w, h) => parts.push(`<path d="${box(x, y, w, h)}" fill="none" ${lined()}/>`),
    clearRect: () => {},
    fillText: (text, x, y) => written(text, x, y, `fill="${real.fillStyle}"${opacity()}`),
    strokeText: (text, x, y) => written(text, x, y, `fill="none" ${lined()}`),
    drawImage: (picture, x, y, w = picture.width, h = picture.height) => {
      const [[left, top], [right, bottom]] = [at(x, y), at(x + w, y + h)].map((place) => place.split(' ').map(Number));
      if (picture.width && picture.height) parts.push(`<image x="${left}" y="${top}" width="${short(right - left)}" height="${short(bottom - top)}" preserveAspectRatio="none" href="${picture.toDataURL()}"/>`);
    },
    save: () => {
      real.save();
      open.push(0);
    },
    restore: () => {
      real.restore();
      parts.push('</g>'.repeat(open.pop() ?? 0));
    },
    clip: () => {
      const id = `c${++clips}`;
      parts.push(`<clipPath id="${id}"><path d="${path}"/></clipPath><g clip-path="url(#${id})">`);
      if (open.length) open[open.length - 1]++;
    },
    createLinearGradient: (...ends) => {
      const made = { real: real.createLinearGradient(...(/** @type {[number, number, number, number]} */ (ends))), ends, stops: /** @type {string[]} */ ([]) };
      return { made, addColorStop: (/** @type {number} */ share, /** @type {string} */ colour) => made.stops.push(`<stop offset="${short(share)}" stop-color="${colour}"/>`) };
    },
  };
  return new Proxy(real, {
    get: (_, name) => {
      const value = own[String(name)] ?? /** @type {any} */ (real)[name];
      return typeof value === 'function' && !own[String(name)] ? value.bind(real) : value;
    },
    set: (_, name, value) => {
      if (name === 'fillStyle') gradient = value?.made ?? null;
      /** @type {any} */ (real)[name] = value?.made?.real ?? value;
      return true;
    },
  });
}

// Return an SVG file of parts.
/** @param {number} width @param {number} height @param {string[]} parts */
export const svgFile = (width, height, parts) => new Blob([`<svg xmlns="http://www.w3.org/2000/svg" width="${width}" height="${height}" viewBox="0 0 ${width} ${height}">\n${parts.join('\n')}\n</svg>\n`], { type: 'image/svg+xml' });
