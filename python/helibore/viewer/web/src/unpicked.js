// An open fracture that was picked is drawn as picked: a washout found at it is none of the zones that are drawn and listed.

const ASIDE = 0.1; // metres that a zone reaches beyond the trace of a fracture
/** @type {[Zone[], WallPick[], Zone[]]} */
let last = [[], [], []];

// Return the zones without the washouts at open fractures that were picked; as long as zones and picks are the same, the same list.
/** @param {Zone[]} zones @param {WallPick[]} picks @param {number} bitRadius */
export function unpicked(zones, picks, bitRadius) {
  if (last[0] === zones && last[1] === picks) return last[2];
  /** @type {(zone: Zone) => (pick: WallPick) => boolean} */
  const at = ({ start, stop }) => (pick) => {
    if (pick.kind === 'breakout' || !pick.aperture) return false;
    const reach = (pick.radius ?? bitRadius) * Math.tan((pick.apparent_dip * Math.PI) / 180) + ASIDE;
    return start > pick.depth - reach && stop < pick.depth + reach;
  };
  last = [zones, picks, zones.filter((zone) => zone.kind !== 'washout' || !picks.some(at(zone)))];
  return last[2];
}
