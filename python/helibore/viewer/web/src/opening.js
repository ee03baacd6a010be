// How far a fracture is open, by the wall: where the wall along a plane is deeper than beside it, the height of the slot along the
// hole at half its depth, times the cosine of the apparent dip.

const REACH = 0.15; // metres along the hole, above and below the plane
const NEAR = 0.03; // metres along the hole within which the slot is deepest
const LEAST = 0.003; // metres that the slot is deep
const SHARE = 0.25; // of the turn that the slot has, at least

/** @param {number[]} sorted @param {number} share */
const quantile = (sorted, share) => sorted[Math.round(share * (sorted.length - 1))];

// Return the opening across the plane and the depth of the slot, metres: medians around the hole. The wall is blurred, by rows and by
// samples: a slot of 15 mm came out as 17 and 22 mm, and less deep than it was. Return null where the wall has no slot.
/** @param {Pick<Store, 'vertex' | 'levels'>} store @param {Pick<Plane, 'a' | 'b' | 'depth' | 'radius'>} plane */
export function openingOf(store, { a, b, depth, radius }) {
  const [level] = store.levels;
  const { sectors } = level;
  const pitch = Math.abs(level.pitch);
  const [most, near] = [REACH, NEAR].map((metres) => Math.ceil(metres / pitch));
  /** @type {[number, number][]} */
  const found = [];
  for (let i = 0; i < sectors; i++) {
    const toolface = (360 * i) / sectors;
    const angle = (toolface * Math.PI) / 180;
    const k = level.quadAt(depth + radius * (a * Math.cos(angle) + b * Math.sin(angle)), toolface);
    const radii = Array.from({ length: 2 * most + 1 }, (_, j) => store.vertex(k + (j - most) * sectors)?.radius ?? NaN);
    const rim = quantile(radii.filter(Number.isFinite).sort((one, other) => one - other), 0.25);
    const middle = radii.slice(most - near, most + near + 1);
    const deepest = Math.max(...middle);
    const deep = deepest - rim;
    if (!(deep > LEAST)) continue;
    const half = (/** @type {number} */ step) => {
      let row = most - near + middle.indexOf(deepest);
      while (radii[row] > rim + deep / 2) row += step;
      const before = radii[row - step];
      return row - (step * (rim + deep / 2 - radii[row])) / (before - radii[row]);
    };
    const tall = (half(1) - half(-1)) * pitch;
    if (Number.isFinite(tall)) found.push([tall / Math.hypot(1, a, b), deep]);
  }
  if (found.length < SHARE * sectors) return null;
  const [openings, depths] = [0, 1].map((part) => found.map((one) => one[part]).sort((one, other) => one - other));
  return { opening: quantile(openings, 0.5), deep: quantile(depths, 0.5) };
}
