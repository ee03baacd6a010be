// What the browser remembers of this page: for the tab (`sessionStorage`) or for good (`localStorage`). If it blocks
// cookies, it refuses both with an error; then nothing is remembered.

/** @typedef {'localStorage' | 'sessionStorage'} Place */

/** @param {Place} place @param {string} key */
export function recall(place, key) {
  try {
    return window[place].getItem(key);
  } catch {
    return null;
  }
}

/** @param {Place} place @param {string} key @param {string} value */
export function remember(place, key, value) {
  try {
    window[place].setItem(key, value);
  } catch {
    // blocked, or full
  }
}
