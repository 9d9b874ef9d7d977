// Pictures in the page's theme, zoomed as the link says.

import { settings, theme } from "../data/settings.js";
import { h } from "../ui/dom.js";
import { colourOf } from "./picture/colours.js";
import { inks } from "./picture/inks.js";
import { Picture, pictureOf } from "./picture/picture.js";
import { forgetZoom, keepZoom, zoomed } from "./zoom.js";

export { inks };

/** Points beyond which they are dots. */
export const MANY = 3000;

/** Lines that differ, for colour-blind readers too (after Okabe and Ito); lighter on the dark theme. */
const PALETTES = {
  light: ["#0072b2", "#d55e00", "#009e73", "#b5568c", "#b57b00", "#56b4e9"],
  dark: ["#56b4e9", "#ff9d5c", "#33cfa4", "#e09bc4", "#f0d442", "#7a93c8"],
};
/** The lines of the theme that holds. */
export let LINES = PALETTES[theme()];
settings.addEventListener("change", () => (LINES = PALETTES[theme()]));

/** Dashes that go with them, so that colour is not all that tells lines apart. */
export const DASHES = ["solid", "dash", "dot", "dashdot", "longdash", "longdashdot"];
/** Part of the usual scale of colours that is too dark on the dark theme. */
const DARK_END = 0.3;

/** The scale of lines and marks: on the dark theme without its dark end, which would not be seen there. @returns {import("./picture/colours.js").Scale} */
export function lineScale() {
  return theme() === "dark" ? BRIGHT : undefined;
}
/** Colour of a part of the scale without its dark end. @param {number} part */
const bright = (part) => colourOf(DARK_END + (1 - DARK_END) * part, [0, 1]);
/** @type {[number, string][]} */
const BRIGHT = Array.from({ length: 11 }, (_, step) => [step / 10, bright(step / 10)]);

/** Colours by parts of that scale, for what the page draws itself. @returns {(part: number) => string} */
export function inkedScale() {
  return theme() === "dark" ? bright : (part) => colourOf(part, [0, 1]);
}

/**
 * A place for a picture. It is a figure and no image to screen readers: it has buttons.
 * @param {string} name what screen readers say and files are called
 * @param {string} key what the link calls it, where it holds how the picture is zoomed
 * @param {string} [size] `low` or `tall`
 */
export function canvas(name, key, size = "") {
  return h("div", { class: `plot ${size}`, role: "figure", "aria-label": name, "data-zoom": key });
}

/** Subjects of the axes of each picture: where these change, a zoom is taken back. @type {WeakMap<HTMLElement, string>} */
const subjects = new WeakMap();

/**
 * Draws, or redraws, a picture; zoomed as the link says, unless its axes are others than when it was drawn last.
 *
 * A trace is of the type `scatter`, `dots`, `bar`, `heatmap` or `contour` over `x` and `y`, which are values as they are shown; its `describe` says
 * a point in words, or else its `text` does.
 * @param {HTMLElement} place made by `canvas`
 * @param {any[]} traces
 * @param {any} layout what differs from the common layout; the `quantity` of an axis is what it shows, where that has a unit, its
 *   `size` the number of served units in one that is shown, where that is not the usual one, and `shows` is what a change of takes the zoom back, in addition to that of the axes
 * @param {AbortSignal} signal of the view: the picture is taken down with it
 */
export async function draw(place, traces, layout, signal) {
  await laidOut(place, signal);
  if (signal.aborted) return;
  const picture = pictureOf(place) ?? hung(place, signal);
  const complete = merged(layout);
  const key = keyOf(place);
  const subject = subjectOf(layout);
  if ((subjects.get(place) ?? subject) !== subject) forgetZoom(key);
  subjects.set(place, subject);
  picture.show(traces, complete, zoomed(key, complete));
}

/**
 * A new picture in a place, which follows its size until its view ends.
 * @param {HTMLElement} place
 * @param {AbortSignal} signal
 */
function hung(place, signal) {
  const picture = new Picture(place);
  place.addEventListener("zoomed", () => keepZoom(keyOf(place), picture), { signal });
  const observer = new ResizeObserver(() => {
    const { width, height } = picture.frame;
    if (place.clientWidth !== width || place.clientHeight !== height) picture.redraw();
  });
  observer.observe(place);
  signal.addEventListener("abort", () => observer.disconnect(), { once: true });
  return picture;
}

/** Subjects of the axes. @param {any} layout */
function subjectOf(layout) {
  const axes = Object.keys(layout).filter((name) => /^[xy]axis/.test(name));
  return JSON.stringify([layout.shows, ...axes.map((name) => layout[name].quantity ?? layout[name].title)]);
}

/** @param {HTMLElement} place */
function keyOf(place) {
  return place.dataset.zoom ?? "";
}

/**
 * Changes the layout of a picture that is drawn.
 * @param {HTMLElement} place
 * @param {Parameters<Picture["change"]>[0]} changes
 */
export function adjust(place, changes) {
  pictureOf(place)?.change(changes);
}

/**
 * Waits until a place has a size, which a view that is built aside has not.
 * @param {HTMLElement} place
 * @param {AbortSignal} signal
 * @returns {Promise<void>}
 */
export function laidOut(place, signal) {
  return new Promise((resolve) => {
    const look = () =>
      signal.aborted || (place.isConnected && place.clientWidth > 0)
        ? resolve()
        : void requestAnimationFrame(look);
    look();
  });
}

/**
 * The common layout with a picture's own.
 * @param {any} own
 */
function merged(own) {
  const result = {
    margin: { l: 60, r: 16, t: 16, b: 50 },
    hovermode: "closest",
    xaxis: {},
    yaxis: {},
    ...own,
  };
  for (const name of Object.keys(result).filter((key) => /^[xy]axis\d*$/.test(key))) {
    const { title } = result[name];
    result[name] = { ...result[name], title: typeof title === "string" ? { text: title } : title };
  }
  return result;
}

/**
 * The bar next to coloured values.
 * @param {string} title
 */
export function colourBar(title) {
  return { title: { text: title } };
}
