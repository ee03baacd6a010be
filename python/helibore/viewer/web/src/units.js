// Numbers as text. Lengths come in metres and are shown as the user chose; a missing value is a dash, never a zero.

const [METRES, FEET] = [{ unit: 'm', scale: 1 }, { unit: 'ft', scale: 1 / 0.3048 }];
const INCHES = { unit: 'in', scale: 1 / 0.0254, digits: 3 };

// The units that a user chooses: of sizes, and of depths.
/** @type {Record<Units, { unit: string, scale: number, digits: number, depth: { unit: string, scale: number } }>} */
export const LENGTHS = { mm: { unit: 'mm', scale: 1000, digits: 2, depth: METRES }, in: { ...INCHES, depth: METRES }, ft: { ...INCHES, depth: FEET } };

/** @param {number} metres @param {Units} units @param {number} [digits] */
export const showLength = (metres, units, digits = LENGTHS[units].digits) =>
  Number.isFinite(metres) ? `${(metres * LENGTHS[units].scale).toFixed(digits).replace('-', '−')} ${LENGTHS[units].unit}` : '–';

// Return a length with its sign; the minus is a true minus sign.
/** @type {(metres: number, units: Units, digits?: number) => string} */
export const showSigned = (metres, units, digits) => {
  if (!Number.isFinite(metres)) return '–';
  const text = showLength(Math.abs(metres), units, digits);
  return parseFloat(text) ? `${metres < 0 ? '−' : '+'}${text}` : text; // what rounds to nothing has no sign
};

// Return a size against the bit as it is read on the rig.
/** @param {number} metres @param {Units} units */
export const showSize = (metres, units) => showSigned(metres, units, units === 'mm' ? 0 : 2);

/** @param {Units} units */
export const depthUnit = (units) => LENGTHS[units].depth.unit;
/** @param {number} metres @param {Units} units @param {number} [digits] */
export const depthNumber = (metres, units, digits = 2) => (metres * LENGTHS[units].depth.scale).toFixed(digits).replace('-', '−');
/** @param {number | undefined} metres @param {Units} units @param {number} [digits] */
export const showDepth = (metres = NaN, units, digits = 2) => (Number.isFinite(metres) ? `${depthNumber(metres, units, digits)} ${depthUnit(units)}` : '–');
/** @param {number} start @param {number} stop @param {Units} units */
export const showSpan = (start, stop, units) => `${[...new Set([start, stop].map((end) => depthNumber(end, units, 1)))].join('–')} ${depthUnit(units)}`;
/** @param {number} degrees @param {number} [digits] */
export const showAngle = (degrees, digits = 1) => {
  if (!Number.isFinite(degrees)) return '–';
  const text = degrees.toFixed(digits);
  return `${text === (360).toFixed(digits) ? (0).toFixed(digits) : text}°`; // 359.96 is 0.0
};

// Return a direction in three digits, as strikes and dip azimuths are written: 035.
/** @param {number} degrees */
export const showAzimuth = (degrees) => (Number.isFinite(degrees) ? String(Math.round(degrees) % 360).padStart(3, '0') : '–');

// Return a value with five significant digits, because a float32 holds no more with certainty.
/** @param {number} value @param {string} [unit] */
export const showValue = (value, unit = '') => {
  if (!Number.isFinite(value)) return '–';
  const text = (Math.abs(value) >= 1e5 || (value !== 0 && Math.abs(value) < 1e-3) ? value.toExponential(3) : String(Number(value.toPrecision(5)))).replaceAll('-', '−');
  return unit ? `${text} ${unit}` : text;
};

// Return a value of a quantity of color.js as text, in its own unit or as a length.
/** @param {Pick<Quantity, 'unit' | 'length'>} quantity @param {number} value @param {Units} units */
export const showQuantity = (quantity, value, units) =>
  quantity.length ? showLength(value, units) : showValue(value, quantity.unit);

// Return the factor from a value (lengths: metres) to the number that is shown; `unitOf` returns the unit of this number.
/** @param {Pick<Quantity, 'unit' | 'length'>} quantity @param {Units} units */
export const scaleOf = (quantity, units) => (quantity.length ? LENGTHS[units].scale : 1);
/** @param {Pick<Quantity, 'unit' | 'length'>} quantity @param {Units} units */
export const unitOf = (quantity, units) => (quantity.length ? LENGTHS[units].unit : (quantity.unit ?? ''));

// Return a share as per cent, one decimal; a negative share that rounds to 0.0 has no sign.
/** @param {number} share */
export const showPercent = (share) => {
  if (!Number.isFinite(share)) return '–';
  const text = (100 * Math.abs(share)).toFixed(1);
  return `${share < 0 && Number(text) ? '−' : ''}${text} %`;
};

// Return a share as whole per cent; only all of it is 100 %, only nothing is 0 %.
/** @param {number} share */
export const showShare = (share) => `${share >= 1 ? 100 : share > 0 ? Math.min(99, Math.max(1, Math.round(100 * share))) : 0} %`;

/** @param {number} seconds */
export const showAge = (seconds) => {
  if (!Number.isFinite(seconds)) return '–';
  if (seconds < 90) return `${Math.max(0, Math.round(seconds))} s`;
  if (seconds < 5400) return `${Math.round(seconds / 60)} min`;
  if (seconds < 172800) return `${Math.round(seconds / 3600)} h`;
  return `${Math.round(seconds / 86400)} d`;
};

// Return seconds since 1970 as date, local time of this machine and its distance from UTC: 2026-11-21 02:14:05 +01:00.
/** @param {number} seconds */
export const showClock = (seconds) => {
  const at = new Date(1000 * seconds);
  const east = -at.getTimezoneOffset();
  /** @param {number} n */
  const two = (n) => String(n).padStart(2, '0');
  const [day, clock] = new Date(at.getTime() + 60000 * east).toISOString().split(/[T.]/);
  return `${day} ${clock} ${east ? `${east < 0 ? '−' : '+'}${two(Math.floor(Math.abs(east) / 60))}:${two(Math.abs(east) % 60)}` : 'UTC'}`;
};

/** @param {number} count */
export const showCount = (count) => count.toLocaleString('en').replaceAll(',', '\u2009');

/** @param {number} m */
export const inMetres = (m) => `${Number(m.toPrecision(4))} m`;
