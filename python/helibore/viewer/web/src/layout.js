// Where the panels of the stage are, in CSS pixels. All tracks share one depth axis: the same y is the same depth.
//
//   | map | depth | image | images beside it | caliper | curves | dips, where some are picked |  3-D  |
//   heads above, bodies below         on a narrow screen a tab shows the tracks or the 3-D view with its depths
//
// A user changes width and order of the tracks after the depth.

import definition from '../../../base/color_maps.json' with { type: 'json' };
import { strikes } from './strokes.js';

export const HEAD = 80;
const FOOT = 20;

export const DIPS = { desk: 84, phone: 70 }; // on a phone no wider than the caliper
const NARROWEST = 64; // pixels of a track
const PANE = { straight: 212, path: 330 }; // pixels that the hole has at least, so that its controls fit in two lines above it
const SHARE = 0.42; // of the stage that the hole has on its path and from inside, until the user widens a track
const COLUMN = 1100; // pixels that the straightened hole is wide at most
const LANE = 58; // pixels beside the straightened hole for the sizes of the zones, so that no size stands on the hole
/** @param {boolean} measured @param {boolean} rig */
export const laneOf = (measured, rig) => (measured && !rig ? LANE : 0);
const PHONE = 600; // a narrower stage has room for the image and the caliper alone

/** @param {number} value @param {number} least @param {number} most */
const bounded = (value, least, most) => Math.round(Math.min(most, Math.max(least, value)));

/** @type {(width: number, height: number, arrangement?: Arrangement) => Rects} */
export function layout(width, height, { dips = false, measured = true, rig = false, straight = false, outside = false, tab = null, beside = 0, curves = 0, columns = [], chosen = {}, order = [] } = {}) {
  const body = { top: HEAD, height: Math.max(40, height - HEAD - FOOT) };
  const slim = tab !== null && width < PHONE;
  const widths = rig ? { map: 0, axis: 66, image: Math.round(width * 0.36), caliper: 0 }
    : tab === '3d' ? { ...(outside ? { map: width < PHONE ? 38 : 52, axis: 0 } : { map: 0, axis: width < PHONE ? 66 : 72 }), image: 0, caliper: 0 } // no axis stands beside what is seen in perspective
      : slim ? phone(width, measured, dips) : desk(width, { dips, measured, beside, curves, columns });
  /** @type {Rects} */
  const rects = {};
  let left = 4;
  for (const [name, w] of slim || tab === '3d' || rig ? Object.entries(widths) : arranged(widths, chosen, order, width, tab ? 0 : outside ? Math.max(PANE.path, Object.keys(chosen).length ? 0 : SHARE * width) : PANE.straight)) {
    rects[name] = { left, width: w, ...body };
    left += w + (name === 'axis' || !w ? 0 : 6);
  }
  rects.pane = { left: left + 4, width: tab && tab !== '3d' ? 0 : Math.max(60, width - left - 4), top: 0, height };
  rects.wall = straight ? { ...body, left: left + 4, width: Math.max(0, Math.min(COLUMN, rects.pane.width - 4 - laneOf(measured, rig))) } : rects.pane;
  return rects;
}

// On a phone tadpoles replace the caliper track while dips are picked; the diameters at the cursor stand above the log.
/** @param {number} width @param {boolean} measured @param {boolean} dips @returns {Record<string, number>} */
function phone(width, measured, dips) {
  const caliper = measured && !dips ? Math.round(width * 0.19) : 0;
  const last = dips ? DIPS.phone : caliper;
  return { map: 38, axis: 70, image: width - 126 - (last ? last + 6 : 0), caliper, ...(dips ? { dips: DIPS.phone } : {}) };
}

/** @param {number} width @param {{ dips: boolean, measured: boolean, beside: number, curves: number, columns: [string, number][] }} of @returns {Record<string, number>} */
function desk(width, { dips, measured, beside, curves, columns }) {
  const image = beside ? bounded((0.375 * width) / (beside + 1), 130, 480) : bounded(width * (measured ? 0.25 : 0.4), 190, measured ? 480 : 760);
  const besides = Object.fromEntries(Array.from({ length: beside }, (_, i) => [`beside${i}`, image]));
  const caliper = measured ? bounded(width * (beside ? 0.11 : 0.15) - (dips ? 10 : 0), 110, 280) : 0;
  return { map: 52, axis: 72, ...Object.fromEntries(columns), image, ...besides, caliper, ...(curves ? { curves: curves > 2 ? 176 : 112 } : {}), ...(dips ? { dips: DIPS.desk } : {}) };
}

// Return names and widths of the tracks as the user arranged them. All tracks become narrower if the hole would get fewer than
// `pane` pixels. If the hole has no pane, all tracks together are as wide as the screen.
/** @param {Record<string, number>} widths @param {Record<string, number>} chosen @param {string[]} order @param {number} width @param {number} pane @returns {[string, number][]} */
function arranged(widths, chosen, order, width, pane) {
  /** @param {string} name */
  const place = (name) => (order.includes(name) ? order.indexOf(name) : order.length + Object.keys(widths).indexOf(name));
  const { map, axis, ...tracks } = widths;
  const names = Object.keys(tracks).sort((a, b) => place(a) - place(b));
  const wide = names.map((name) => (tracks[name] ? Math.max(NARROWEST, chosen[name] ?? tracks[name]) : 0));
  const room = width - map - axis - pane - 6 * (wide.filter(Boolean).length + 2);
  const share = Math.min(pane ? 1 : Infinity, room / wide.reduce((sum, one) => sum + one, 0));
  return Object.entries({ map, axis, ...Object.fromEntries(names.map((name, i) => [name, Math.floor(wide[i] * share)])) });
}

// Return the names of the tracks that a user can move, from left to right.
/** @param {Rects} rects */
export const movable = (rects) => Object.keys(rects).filter((name) => !['map', 'axis', 'pane', 'wall'].includes(name) && rects[name].width);

// Return the right end of the last track; the straightened hole counts as a track.
/** @param {Rects} rects */
export const tracksEnd = (rects) => (rects.wall?.top && rects.wall.width ? rects.wall.left + rects.wall.width : Math.max(...['axis', ...movable(rects)].map((name) => rects[name].left + rects[name].width)));
/** @param {Rects} rects */
export const imageRects = (rects) => Object.keys(rects).filter((name) => /^(image|beside)/.test(name)).map((name) => rects[name]);
/** @param {Rect} rect @param {number} x @param {number} y */
export const inside = ({ left, top, width, height }, x, y) => x >= left && x < left + width && y >= top && y < top + height;
/** @param {Pick<View, 'top' | 'bottom' | 'bent'>} view @param {Pick<Rect, 'top' | 'height'>} rect @param {number} y */
export const depthAt = ({ top, bottom, bent }, rect, y) => (bent ? bent.depth((y - rect.top) / rect.height) : top + ((y - rect.top) / rect.height) * (bottom - top));
/** @param {Pick<View, 'top' | 'bottom' | 'bent'>} view @param {Pick<Rect, 'top' | 'height'>} rect @param {number} depth */
export const yOf = ({ top, bottom, bent }, rect, depth) => rect.top + (bent ? bent.share(depth) : (depth - top) / (bottom - top)) * rect.height;

/** @type {(dark: 0 | 1) => Pick<Palette, 'zones' | 'fills' | 'picks' | 'top'>} */
const colours = (dark) => {
  /** @template {string} Kind @param {Record<Kind, string[]>} kinds @returns {Record<Kind, string>} */
  const of = (kinds) => /** @type {Record<Kind, string>} */ (Object.fromEntries(Object.keys(kinds).map((kind) => [kind, `#${kinds[/** @type {Kind} */ (kind)][dark]}`])));
  return { zones: of(definition.zones), fills: of(definition.fills), picks: of(definition.picks), top: `#${definition.tops[dark]}` };
};

/** @type {Record<Theme, Palette>} */
export const PALETTES = {
  light: {
    background: 0xf4f5f6, paper: '#f4f5f6', panel: '#ffffff', ink: '#1b2126', soft: '#5c6770', line: '#cfd5da', grid: '#0000001a',
    cursor: '#e8410d', pin: '#8a3ffc', min: '#14833b', max: '#1557b0', hatch: '#9aa3aa', ...colours(0),
  },
  dark: {
    background: 0x14181c, paper: '#14181c', panel: '#1d2328', ink: '#e6eaed', soft: '#98a4ad', line: '#36404a', grid: '#ffffff20',
    cursor: '#ff7043', pin: '#b388ff', min: '#5fd08a', max: '#72aef7', hatch: '#6b757d', ...colours(1),
  },
};

// Return black or white, whichever is seen better on a colour (#rrggbb), by the contrast of WCAG 2.
/** @param {string} colour */
export function inkOn(colour) {
  const [r, g, b] = [1, 3, 5].map((at) => parseInt(colour.slice(at, at + 2), 16) / 255).map((c) => (c <= 0.04045 ? c / 12.92 : ((c + 0.055) / 1.055) ** 2.4));
  return 0.2126 * r + 0.7152 * g + 0.0722 * b > 0.179 ? '#000000' : '#ffffff';
}

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

// Draw a text, on a halo if a colour for the halo is given. The canvas keeps the box of every text until the next frame (`sized`
// deletes the boxes). `near` holds places, relative to (left, top): the text is drawn at the first of them where it touches no
// text and no line that was drawn before. Without `near` the place is (left, top), and lines do not count. If `yields` is set, a
// text that has no free place is not drawn. `margin` is how many pixels a text keeps clear of other texts. Return the place, if
// there is one.
/**
 * @typedef {{ colour: string, halo?: string, align?: CanvasTextAlign, baseline?: CanvasTextBaseline, font?: string | null, near?: Pair[], yields?: boolean, margin?: number }} Lettering
 * @param {Ink} ink
 * @param {string} text
 * @param {number} left
 * @param {number} top
 * @param {Lettering} lettering
 * @returns {Pair | undefined}
 */
export function label(ink, text, left, top, { colour, halo, align = 'left', baseline = 'middle', font = null, near = [], yields = false, margin = 0 }) {
  if (font) ink.font = font;
  ink.textAlign = align;
  ink.textBaseline = baseline;
  const { labels, strokes } = ink.canvas;
  const at = boxOf(ink, text, left, top, `${font ?? ink.font}|${align}|${baseline}|${text}`);
  /** @type {(of: Pair, margin: number) => Box} */
  const box = ([dx, dy], wide) => ({ text, left: at.left + dx - wide, right: at.right + dx + wide, top: at.top + dy - wide, bottom: at.bottom + dy + wide });
  /** @type {(of: Pair) => boolean} */
  const alone = (place) => !labels.some(touch.bind(null, box(place, margin)));
  /** @type {(of: Pair) => boolean} */
  const clear = (place) => !strokes.some(strikes.bind(null, box(place, 1)));
  const place = near.find((one) => alone(one) && clear(one)) ?? (near.length ? [] : [HERE]).find(alone);
  if (yields && !place) return undefined;
  const [dx, dy] = place ?? near[0] ?? HERE;
  const [x, y] = [left + dx, top + dy];
  labels.push(box([dx, dy], 0));
  if (halo) {
    ink.lineJoin = 'round';
    ink.lineWidth = 3;
    ink.strokeStyle = halo;
    ink.strokeText(text, x, y, ink.canvas.slide?.[text]);
  }
  ink.fillStyle = colour;
  ink.fillText(text, x, y, ink.canvas.slide?.[text]);
  return [dx, dy];
}

// Return the first text that fits the width; if none fits, as much of the last text as fits, on a slide all of it, to be drawn narrower.
/** @param {Ink} ink @param {string[]} texts @param {number} width */
export function fitting(ink, texts, width) {
  /** @param {string} text */
  const fits = (text) => ink.measureText(text).width <= width;
  let text = texts.find(fits) ?? texts[texts.length - 1];
  if (ink.canvas.slide && !fits(text)) ink.canvas.slide[text] = width;
  else while (text.length > 1 && !fits(text)) text = `${text.replace(/…$/, '').slice(0, -1)}…`;
  return text;
}

/** @type {Pair} */
const HERE = [0, 0];

/** @type {Map<string, TextMetrics>} */
const measured = new Map(); // most texts of a picture are those of the last one

/** @param {Ink} ink @param {string} text @param {number} x @param {number} y @param {string} key */
function boxOf(ink, text, x, y, key) {
  if (measured.size > 2000) measured.clear();
  const metrics = measured.get(key) ?? ink.measureText(text);
  measured.set(key, metrics);
  const { actualBoundingBoxLeft: left, actualBoundingBoxRight: right, actualBoundingBoxAscent: up, actualBoundingBoxDescent: down } = metrics;
  return { left: x - left, right: x + right, top: y - up, bottom: y + down };
}

/** @param {Box} a @param {Box} b */
export const touch = (a, b) => a.left < b.right && b.left < a.right && a.top < b.bottom && b.top < a.bottom;

export const FONT = '12px "DejaVu Sans", "Segoe UI", system-ui, sans-serif';
export const SMALL = '11px "DejaVu Sans", "Segoe UI", system-ui, sans-serif';
export const SMALL_BOLD = `600 ${SMALL}`;
export const BOLD = '600 12px "DejaVu Sans", "Segoe UI", system-ui, sans-serif';
