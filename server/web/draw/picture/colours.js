// Colours of values on scales, of states and of classes.

import { classes } from "../../data/judgement.js";

/** Viridis at equal steps (van der Walt and Smith 2015). */
const STOPS = [
  [68, 1, 84],
  [72, 40, 120],
  [62, 73, 137],
  [49, 104, 142],
  [38, 130, 142],
  [31, 158, 137],
  [53, 183, 121],
  [110, 206, 88],
  [181, 222, 43],
  [253, 231, 37],
];
const STEPS = 128;

/** Colours from the least to the largest value. */
const MIXED = Array.from({ length: STEPS }, (_, step) => {
  const place = (step / (STEPS - 1)) * (STOPS.length - 1);
  const below = Math.min(Math.floor(place), STOPS.length - 2);
  return STOPS[below].map((value, part) =>
    Math.round(value + (STOPS[below + 1][part] - value) * (place - below)),
  );
});
const COLOURS = MIXED.map((mixed) => `rgb(${mixed.join(",")})`);
/** Relative luminance at which black and white contrast equally (WCAG 2). */
const MIDDLE = 0.179;

/**
 * @param {number} value
 * @param {[number, number]} range of the scale; what lies beyond has the colour of its end
 */
export function colourOf(value, range) {
  return COLOURS[stepOf(value, range)];
}

/**
 * Black or white, whichever contrasts more with the colour of a value.
 * @param {number} value
 * @param {[number, number]} range of the scale
 */
export function inkOn(value, range) {
  return inkOver(MIXED[stepOf(value, range)]);
}

/** @param {number[]} mixed red, green and blue up to 255 */
function inkOver(mixed) {
  const [red, green, blue] = mixed.map((part) => {
    const share = part / 255;
    return share <= 0.04045 ? share / 12.92 : ((share + 0.055) / 1.055) ** 2.4;
  });
  return 0.2126 * red + 0.7152 * green + 0.0722 * blue > MIDDLE ? BLACK : WHITE;
}
/** Inks of what is printed on colours, in either theme. */
export const [BLACK, WHITE] = ["#000000", "#ffffff"];

/** @param {number} value @param {[number, number]} range */
function stepOf(value, [least, largest]) {
  const part = largest > least ? (value - least) / (largest - least) : 0.5;
  return Math.max(0, Math.min(STEPS - 1, Math.round(part * (STEPS - 1))));
}

/** Variables of the style sheet that colour the states of points. @type {Record<string, string>} */
const STATES = {
  succeeded: "--good",
  running: "--accent",
  queued: "--wait",
  failed: "--bad",
  cancelled: "--stop",
};

/**
 * Colour of a state in pictures, which is the one of its mark on the page.
 * @param {string} word
 * @returns {string | undefined} undefined of another word
 */
export function stateColour(word) {
  if (!STATES[word]) return undefined;
  return getComputedStyle(document.documentElement).getPropertyValue(STATES[word]).trim();
}

/** Colour of an unknown class. */
const UNKNOWN = "#757575";

/** Colour of a class of points, in both themes. @param {string} name */
export function classColour(name) {
  return classes().find(({ word }) => word === name)?.colour ?? UNKNOWN;
}

/** Black or white, whichever contrasts more with the colour of a class. @param {string} name */
export function inkOnClass(name) {
  return inkOver([1, 3, 5].map((start) => Number.parseInt(classColour(name).slice(start, start + 2), 16)));
}

/** The scale as a gradient of CSS, from left to right. */
export const GRADIENT = `linear-gradient(to right, ${Array.from({ length: 11 }, (_, step) => COLOURS[Math.round((step / 10) * (STEPS - 1))]).join(", ")})`;

/** Blue below and red above grey, apart by lightness as well for those who cannot tell the two. @type {[number, string][]} */
export const DIVERGING = [
  [0, "rgb(5,10,172)"],
  [0.35, "rgb(106,137,247)"],
  [0.5, "rgb(190,190,190)"],
  [0.6, "rgb(220,170,132)"],
  [0.7, "rgb(230,145,90)"],
  [1, "rgb(178,10,28)"],
];

/** Colours of a scale in its table. */
const TABLED = 256;

/**
 * Scale of colours: `undefined` is the usual one, others are parts with their colours, between which it is mixed.
 * @typedef {[part: number, colour: string][] | undefined} Scale
 */

/**
 * Colours along a scale, as red, green and blue up to 255 one after the other.
 * @param {Scale} scale
 * @returns {Uint8Array}
 */
export function colourTable(scale) {
  const table = new Uint8Array(3 * TABLED);
  const stops = scale
    ? scale.map(([part, colour]) => ({ part, mixed: mixedOf(colour) }))
    : STOPS.map((mixed, order) => ({ part: order / (STOPS.length - 1), mixed }));
  for (let step = 0; step < TABLED; step += 1) {
    const part = step / (TABLED - 1);
    const at = Math.max(
      0,
      stops.findLastIndex((stop) => stop.part <= part),
    );
    const [below, above] = [stops[at], stops[at + 1] ?? stops[at]];
    const share = above.part > below.part ? (part - below.part) / (above.part - below.part) : 0;
    below.mixed.forEach((value, of) => {
      table[3 * step + of] = Math.round(value + share * (above.mixed[of] - value));
    });
  }
  return table;
}

/**
 * Colours along a scale as pixels of an image, one after the other.
 * @param {Scale} scale
 * @returns {Uint32Array}
 */
export function pixelTable(scale) {
  const table = colourTable(scale);
  return Uint32Array.from({ length: TABLED }, (_, step) => pixelOf(table.subarray(3 * step, 3 * step + 3)));
}

/** Opaque pixel of an image, whose bytes are red, green, blue and opacity. @param {ArrayLike<number>} mixed red, green and blue */
export function pixelOf(mixed) {
  return new Uint32Array(Uint8Array.of(mixed[0], mixed[1], mixed[2], 255).buffer)[0];
}

/** Red, green and blue of a colour. @param {string} colour as `#rgb`, `#rrggbb` or `rgb(r, g, b)` */
export function mixedOf(colour) {
  if (!colour.startsWith("#")) return (colour.match(/[\d.]+/g) ?? ["0", "0", "0"]).slice(0, 3).map(Number);
  const wide = colour.length === 4 ? colour.replace(/[\da-f]/gi, "$&$&") : colour;
  return [1, 3, 5].map((start) => Number.parseInt(wide.slice(start, start + 2), 16));
}

/**
 * Place of a value in the table of a scale.
 * @param {number} value
 * @param {number} least @param {number} largest
 */
export function tabled(value, least, largest) {
  const part = largest > least ? (value - least) / (largest - least) : 0.5;
  return Math.max(0, Math.min(TABLED - 1, Math.round(part * (TABLED - 1))));
}

/**
 * Colours of values by a scale.
 * @param {Scale} scale
 * @param {number} least @param {number} largest
 * @returns {(value: number) => string}
 */
export function colourScale(scale, least, largest) {
  const table = colourTable(scale);
  const words = Array.from(
    { length: TABLED },
    (_, step) => `rgb(${table[3 * step]},${table[3 * step + 1]},${table[3 * step + 2]})`,
  );
  return (value) => words[tabled(value, least, largest)];
}
