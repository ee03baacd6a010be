// Vectors of three numbers.

export const plus = (u, v, times = 1) => [u[0] + times * v[0], u[1] + times * v[1], u[2] + times * v[2]];
export const minus = (u, v) => plus(u, v, -1);
export const scaled = (u, by) => [by * u[0], by * u[1], by * u[2]];
export const dot = (u, v) => u[0] * v[0] + u[1] * v[1] + u[2] * v[2];
export const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
export const length = (u) => Math.hypot(...u);
export const normalised = (u) => scaled(u, 1 / (length(u) || 1));

// North, east, down to east, north, up: both right-handed. Swapping only the last would mirror the hole.
export const eastNorthUp = (v) => [v[1], v[0], -v[2]];
