// Colours of values on a scale, for what is not drawn by plotly; the same scale as there.

import { classes } from "../data/judgement.js";

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

/**
 * Colours of values by a scale as the drawing library takes it.
 * @param {any} scale the name of the usual one, or parts of it with their colours
 * @param {number} least @param {number} largest
 * @returns {(value: number) => string}
 */
export function colourScale(scale, least, largest) {
  if (!Array.isArray(scale)) return (value) => colourOf(value, [least, largest]);
  return (value) => {
    const part = (value - least) / (largest - least || 1);
    return scale.findLast(([from]) => from <= part)?.[1] ?? scale[0][1];
  };
}
