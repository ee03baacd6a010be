// The numbers of a pick that are shown in fields, with their names and digits.

import { LENGTHS } from './units.js';

export const BREAKOUT = 'breakout';
/** @type {Record<'plane' | 'breakout', [string, string, number][]>} */
export const FIELDS = {
  plane: [['depth', 'MD', 2], ['apparent_dip', 'apparent dip °', 1], ['toolface', 'deepest °', 0]],
  breakout: [['depth', 'MD', 2], ['height', 'high', 2], ['toolface', 'toolface °', 0], ['opening', 'wide °', 0], ['tilt', 'tilt °', 0]],
};
/** @param {number} count @param {string} [what] */
export const counted = (count, what = 'pick') => `${count} ${what}${count === 1 ? '' : 's'}`;
/** @param {string} name */
export const isDepth = (name) => name === 'depth' || name === 'height';
// Return how many units of the field make a metre, for lengths along the hole; 1 for other fields.
/** @type {(name: string, units: Units) => number} */
export const unitOfField = (name, units) => (isDepth(name) ? LENGTHS[units].depth.scale : 1);
