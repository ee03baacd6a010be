// The range a quantity starts with, where neither the wall's owner nor the address says one.

import { fitRange, Q_NEAREST, Q_OVER, Q_RADIUS, roundRange, sampleOf } from './colour.js';

const FEW_TURNS = 50; // a shorter wall is no measure of the hole to come

// An attribute that came without a range gets one from the first values seen.
export function rangeOnce({ store, quantities }, tile) {
  for (const quantity of quantities) {
    if (Number.isFinite(quantity.low) && Number.isFinite(quantity.high)) continue;
    const [top, bottom] = tile.span;
    const sorted = sampleOf(store, quantity, [{ tile, top, bottom }], 'latest');
    if (sorted.length) Object.assign(quantity, fitRange(quantity, sorted));
  }
}

// A wall that does not grow starts with colours for what it is: in one of gauge, the range for washouts shows nothing.
// True once that is decided.
export function rangeSaved({ store, quantities, newest }, { imagePieces }) {
  const wall = store.levels[0];
  if (!imagePieces.some(({ tile }) => tile.level === wall)) return false;
  if (newest !== null || wall.size < FEW_TURNS * wall.sectors) return true;
  for (const quantity of quantities.filter(({ mode }) => [Q_RADIUS, Q_OVER, Q_NEAREST].includes(mode))) {
    const sorted = sampleOf(store, quantity, imagePieces, 'latest');
    if (sorted.length) Object.assign(quantity, roundRange(quantity, sorted));
  }
  return true;
}
