// Vectors of three numbers.

/** @param {Vector} u @param {Vector} v @param {number} [times] */
export const plus = (u, v, times = 1) => [u[0] + times * v[0], u[1] + times * v[1], u[2] + times * v[2]];
/** @param {Vector} u @param {Vector} v */
export const minus = (u, v) => plus(u, v, -1);
/** @param {Vector} u @param {number} by */
export const scaled = (u, by) => [by * u[0], by * u[1], by * u[2]];
/** @param {Vector} u @param {Vector} v */
export const dot = (u, v) => u[0] * v[0] + u[1] * v[1] + u[2] * v[2];
/** @param {Vector} a @param {Vector} b */
export const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
/** @param {Vector} u */
export const length = (u) => Math.hypot(...u);
/** @param {Vector} u */
export const normalised = (u) => scaled(u, 1 / (length(u) || 1));

// Turns (north, east, down) into (east, north, up). Both are right-handed; to change only the sign of the last number
// would mirror the hole.
/** @param {Floats} v */
export const eastNorthUp = (v) => [v[1], v[0], -v[2]];
