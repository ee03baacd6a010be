// Where the panels of the stage are, in CSS pixels. All tracks share one depth axis: the same y is the same depth.
//
//   | map | depth | image | caliper | curves | dips, where some are picked |  3-D  |
//   heads above, bodies below         on a narrow screen a tab shows the tracks or the 3-D view with its depths
//
// A user changes width and order of the tracks after the depth.

import definition from '../../../base/color_maps.json' with { type: 'json' };

export const HEAD = 80;
const FOOT = 20;

const DIPS = 70;
const CURVES = 112;
const NARROWEST = 64; // pixels of a track
const PANE = 180; // that the hole has at least

const COLUMN = 800; // pixels that the straightened hole is wide at most
/** @param {number} width */
export const listWidth = (width) => (width < 1200 ? 240 : 330); // beside it, the list of zones

/** @type {(width: number, height: number, arrangement?: Arrangement) => Rects} */
export function layout(width, height, { dips = false, measured = true, rig = false, straight = false, tab = null, beside = 0, curves = false, chosen = {}, order = [], list = true } = {}) {
  const body = { top: HEAD, height: Math.max(40, height - HEAD - FOOT) };
  const image = rig ? Math.round(width * 0.36) : Math.round(Math.min(480, Math.max(190, width * 0.25)));
  const caliper = Math.round(Math.min(280, Math.max(120, width * 0.15)));
  const several = Math.round(Math.max(130, (1.5 * image) / (beside + 1))); // each of several images
  const narrow = tab === '3d' ? { map: 0, axis: 66, image: 0, caliper: 0 } : { map: 38, axis: width < 600 ? 62 : 74, image: width - (width < 600 ? 118 : 130) - (measured ? small(width) + 6 : 0), caliper: measured ? small(width) : 0 };
  const widths = tab ? narrow : rig ? { map: 0, axis: 66, image, caliper: 0 } : { map: 52, axis: 72, image: beside ? several : measured ? image : image + caliper, ...Object.fromEntries(Array.from({ length: beside }, (_, i) => [`beside${i}`, several])), caliper: measured ? (beside ? 120 : caliper - (dips ? 10 : 0)) : 0, ...(curves ? { curves: CURVES } : {}), ...(dips ? { dips: DIPS } : {}) };
  /** @type {Rects} */
  const rects = {};
  let left = 4;
  for (const [name, w] of tab || rig ? Object.entries(widths) : arranged(widths, chosen, order, width)) {
    rects[name] = { left, width: w, ...body };
    left += w + (name === 'axis' || !w ? 0 : 6);
  }
  rects.pane = { left: left + 4, width: tab && tab !== '3d' ? 0 : Math.max(60, width - left - 4), top: 0, height };
  const column = Math.max(0, Math.min(COLUMN, rects.pane.width - (list && rects.pane.width >= 380 && !rig && !tab ? listWidth(width) : 4)));
  rects.wall = straight ? { ...body, left: left + 4, width: column } : rects.pane;
  return rects;
}

// Names and widths of the tracks as the user arranged them; all narrower where the hole would have no room.
/** @param {Record<string, number>} widths @param {Record<string, number>} chosen @param {string[]} order @param {number} width @returns {[string, number][]} */
function arranged(widths, chosen, order, width) {
  /** @param {string} name */
  const place = (name) => (order.includes(name) ? order.indexOf(name) : order.length + Object.keys(widths).indexOf(name));
  const { map, axis, ...tracks } = widths;
  const names = Object.keys(tracks).sort((a, b) => place(a) - place(b));
  const wide = names.map((name) => (tracks[name] ? Math.max(NARROWEST, chosen[name] ?? tracks[name]) : 0));
  const room = width - map - axis - PANE - 6 * (names.length + 2);
  const share = Math.min(1, room / wide.reduce((sum, one) => sum + one, 0));
  return Object.entries({ map, axis, ...Object.fromEntries(names.map((name, i) => [name, Math.floor(wide[i] * share)])) });
}

// Names of the tracks that a user can move, from left to right.
/** @param {Rects} rects */
export const movable = (rects) => Object.keys(rects).filter((name) => !['map', 'axis', 'pane', 'wall'].includes(name) && rects[name].width);

/** @param {number} width */
const small = (width) => Math.round(Math.min(200, Math.max(64, width * 0.19))); // the caliper beside tabs

// Where the last track ends; the straightened hole is one.
/** @param {Rects} rects */
export const tracksEnd = (rects) => (rects.wall?.top && rects.wall.width ? rects.wall.left + rects.wall.width : Math.max(...['axis', ...movable(rects)].map((name) => rects[name].left + rects[name].width)));
/** @param {Rects} rects */
export const imageRects = (rects) => Object.keys(rects).filter((name) => /^(image|beside)/.test(name)).map((name) => rects[name]);
/** @param {Rect} rect @param {number} x @param {number} y */
export const inside = ({ left, top, width, height }, x, y) => x >= left && x < left + width && y >= top && y < top + height;
/** @param {Pick<View, 'top' | 'bottom'>} view @param {Pick<Rect, 'top' | 'height'>} rect @param {number} y */
export const depthAt = (view, rect, y) => view.top + ((y - rect.top) / rect.height) * (view.bottom - view.top);
/** @param {Pick<View, 'top' | 'bottom'>} view @param {Pick<Rect, 'top' | 'height'>} rect @param {number} depth */
export const yOf = (view, rect, depth) => rect.top + ((depth - view.top) / (view.bottom - view.top)) * rect.height;

/** @type {(dark: 0 | 1) => Pick<Palette, 'zones' | 'picks'>} */
const colours = (dark) => {
  /** @template {string} Kind @param {Record<Kind, string[]>} kinds @returns {Record<Kind, string>} */
  const of = (kinds) => /** @type {Record<Kind, string>} */ (Object.fromEntries(Object.keys(kinds).map((kind) => [kind, `#${kinds[/** @type {Kind} */ (kind)][dark]}`])));
  return { zones: of(definition.zones), picks: of(definition.picks) };
};

/** @type {Record<Theme, Palette>} */
export const PALETTES = {
  light: {
    background: 0xf4f5f6, paper: '#f4f5f6', panel: '#ffffff', ink: '#1b2126', soft: '#5c6770', line: '#cfd5da', grid: '#0000001a',
    cursor: '#e8410d', pin: '#8a3ffc', min: '#14833b', max: '#1557b0', fill: '#3b7dd81f', over: '#f2a33a66', tight: '#d3222299', hatch: '#9aa3aa', ...colours(0),
  },
  dark: {
    background: 0x14181c, paper: '#14181c', panel: '#1d2328', ink: '#e6eaed', soft: '#98a4ad', line: '#36404a', grid: '#ffffff20',
    cursor: '#ff7043', pin: '#b388ff', min: '#5fd08a', max: '#72aef7', fill: '#6fa8ff26', over: '#e0953a70', tight: '#ff5a52a0', hatch: '#6b757d', ...colours(1),
  },
};

// Draw inside a rectangle only.
/** @param {Ink} ink @param {Rect} rect @param {() => void} draw */
export function within(ink, { left, top, width, height }, draw) {
  ink.save();
  ink.beginPath();
  ink.rect(left, top, width, height);
  ink.clip();
  draw();
  ink.restore();
}

// Draw a text, on a halo if a colour for it is given. The canvas keeps the box of every text until the next frame (`sized`
// deletes the boxes). If `yields` is set, the text is not drawn where its box would touch the box of another text.
/**
 * @typedef {{ colour: string, halo?: string, align?: CanvasTextAlign, baseline?: CanvasTextBaseline, font?: string | null, yields?: boolean, margin?: number }} Lettering
 * @param {Ink} ink
 * @param {string} text
 * @param {number} x
 * @param {number} y
 * @param {Lettering} lettering
 */
export function label(ink, text, x, y, { colour, halo, align = 'left', baseline = 'middle', font = null, yields = false, margin = 0 }) {
  if (font) ink.font = font;
  ink.textAlign = align;
  ink.textBaseline = baseline;
  const box = boxOf(ink, text, x, y, margin);
  if (yields && ink.canvas.labels.some((other) => touch(box, other))) return;
  ink.canvas.labels.push(box);
  if (halo) {
    ink.lineJoin = 'round';
    ink.lineWidth = 3;
    ink.strokeStyle = halo;
    ink.strokeText(text, x, y);
  }
  ink.fillStyle = colour;
  ink.fillText(text, x, y);
}

/** @param {Ink} ink @param {string} text @param {number} x @param {number} y @param {number} margin */
function boxOf(ink, text, x, y, margin) {
  const { actualBoundingBoxLeft: left, actualBoundingBoxRight: right, actualBoundingBoxAscent: up, actualBoundingBoxDescent: down } = ink.measureText(text);
  return { text, left: x - left - margin, right: x + right + margin, top: y - up - margin, bottom: y + down + margin };
}

/** @param {Box} a @param {Box} b */
export const touch = (a, b) => a.left < b.right && b.left < a.right && a.top < b.bottom && b.top < a.bottom;

export const FONT = '12px "DejaVu Sans", "Segoe UI", system-ui, sans-serif';
export const SMALL = '11px "DejaVu Sans", "Segoe UI", system-ui, sans-serif';
export const BOLD = '600 12px "DejaVu Sans", "Segoe UI", system-ui, sans-serif';
