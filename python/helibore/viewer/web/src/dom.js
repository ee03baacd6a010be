// Elements of the page, and what several modules write into them.

/** @template {string} Id @param {Id} id */
export const byId = (id) => /** @type {ElementOf<Id>} */ (/** @type {unknown} */ (document.getElementById(id)));

/** @param {string} id @param {Choice[]} pairs */
export function options(id, pairs) {
  byId(id).replaceChildren(...pairs.map(([value, text]) => new Option(text, String(value))));
}

// Return a function that calls `draw` with the next frame, once, however often it is called before.
/** @param {() => void} draw */
export function oncePerFrame(draw) {
  let scheduled = false;
  return () => {
    if (scheduled) return;
    scheduled = true;
    requestAnimationFrame(() => {
      scheduled = false;
      draw();
    });
  };
}

// Write a text. One that stands there already is not written: the browser would lay the page out anew.
/** @param {string} id @param {string} text */
export function say(id, text) {
  if (byId(id).textContent !== text) byId(id).textContent = text;
}

// Write pairs of name and text to a list; a third text is the tooltip of both.
/** @param {string} id @param {string[][]} pairs */
export function write(id, pairs) {
  const list = byId(id);
  if (list.children.length !== 2 * pairs.length) {
    list.replaceChildren(...pairs.flatMap(() => ['dt', 'dd'].flatMap((name) => [document.createElement(name), ' ']))); // copied text keeps its words apart
  }
  pairs.forEach(([name, text, title = ''], i) => [name, text].forEach((words, j) => {
    const at = /** @type {HTMLElement} */ (list.children[2 * i + j]);
    if (at.textContent !== words) at.textContent = words;
    if (at.title !== title) at.title = title;
  }));
}
