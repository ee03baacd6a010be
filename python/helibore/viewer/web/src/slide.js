// The sizes of a saved picture.

export const BAND = 26; // pixels above the picture, for its words
export const SLIDE = { width: 960, height: 540 }; // pixels: on a slide of 13.33 by 7.5 inches one pixel is one point
