// Converts a template, which page, print and report read, to the arrangement of the tracks; template_text.js writes one.

export const RADIUS = 'Radius'; // the name in templates of the wall over bit size

// Return the changes of the view that show the tracks of a template; images that the wall does not have are left out, as are tracks of intervals.
/** @param {Template} template @param {Quantity[]} quantities @param {string[]} columns */
export function fromTemplate({ unit, track: tracks }, quantities, columns = []) {
  /** @type {{ units: Units, beside: string[], curves: string[], order: string[], widths: Record<string, number>, quantity?: string }} */
  const changes = { units: unit, beside: [], curves: [], order: [], widths: {} };
  let images = 0;
  for (const { kind, name, names, width } of tracks) {
    let track = kind;
    if (kind === 'image') {
      const id = name === RADIUS ? 'over' : name;
      if (!quantities.some((one) => one.id === id)) continue;
      track = images ? `beside${images - 1}` : 'image';
      if (images++) changes.beside.push(id);
      else changes.quantity = id;
    }
    if (kind === 'intervals') {
      if (!columns.includes(name)) continue;
      track = `column${columns.indexOf(name)}`;
      changes.curves.push(name);
    }
    changes.curves.push(...names);
    changes.order.push(track);
    if (width !== null) changes.widths[track] = width;
  }
  return changes;
}
