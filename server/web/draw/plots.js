// Pictures in the page's theme, with PNG and SVG to take away: sketched at once, and drawn by plotly as soon as that is compiled.

import { isWaiting } from "../data/api.js";
import { settings, theme } from "../data/settings.js";
import { THOUSANDS } from "../data/units.js";
import { h } from "../ui/dom.js";
import { Cloud, spanned } from "./cloud.js";
import { colourOf } from "./colours.js";
import { fetchAhead, library } from "./library.js";
import { sketch } from "./sketch.js";
import { forgetZoom, keepZoom, wholeOf, zoomed } from "./zoom.js";

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
/** The scale of every coloured quantity. */
export const SCALE = "Viridis";

/** Part of it that is too dark on the dark theme. */
const DARK_END = 0.3;

/** The scale of lines and marks: on the dark theme without its dark end, which would not be seen there. @returns {string | [number, string][]} */
export function lineScale() {
  return theme() === "dark" ? BRIGHT : SCALE;
}
/** Colour of a part of the scale without its dark end. @param {number} part */
const bright = (part) => colourOf(DARK_END + (1 - DARK_END) * part, [0, 1]);
/** @type {[number, string][]} */
const BRIGHT = Array.from({ length: 11 }, (_, step) => [step / 10, bright(step / 10)]);

/** Colours by parts of that scale, for what the page draws itself. @returns {(part: number) => string} */
export function inkedScale() {
  return theme() === "dark" ? bright : (part) => colourOf(part, [0, 1]);
}

/** @returns {{text: string, soft: string, line: string, panel: string}} colours of the theme */
export function inks() {
  return theme() === "dark"
    ? { text: "#e4e9ee", soft: "#9ca9b6", line: "#323c47", panel: "#1a2129" }
    : { text: "#1b232c", soft: "#56626f", line: "#d8dde3", panel: "#ffffff" };
}

/**
 * A place for a picture. It is a figure and no image to screen readers: it has buttons.
 * @param {string} name what screen readers say and files are called
 * @param {string} key what the link calls it, where it holds how the picture is zoomed
 * @param {string} [size] `low` or `tall`
 */
export function canvas(name, key, size = "") {
  const place = h("div", { class: `plot ${size}`, role: "figure", "aria-label": name, "data-zoom": key });
  // While the data come.
  fetchAhead(place);
  return place;
}

/** The first picture of a view is drawn once none was sketched and nothing awaited for a while, or after the longest wait. */
const REST_MS = 10,
  LONGEST_MS = 500,
  STEP_MS = 10;

/**
 * Pictures that are drawn: layout, quantities of the axes, and the layout without a zoom.
 * @type {WeakMap<HTMLElement, {layout: any, axes: string, whole: Record<string, any>}>}
 */
const drawn = new WeakMap();
/** Dots of pictures. @type {WeakMap<HTMLElement, Cloud>} */
const clouds = new WeakMap();
/** Requested drawings of each place: all but the newest are dropped. @type {WeakMap<HTMLElement, number>} */
const asked = new WeakMap();
/** Pictures whose layout the page changes itself. @type {WeakSet<HTMLElement>} */
const adjusted = new WeakSet();

/**
 * Draws, or redraws, a picture; zoomed as the link says, unless its axes are others than when it was drawn last.
 * @param {HTMLElement} place made by `canvas`
 * @param {any[]} traces as plotly takes them, and those of `Cloud`
 * @param {any} layout what differs from the common layout; the `quantity` of an axis is what it shows, where that has a unit, its
 *   `size` the number of served units in one that is shown, where that is not the usual one, and `shows` is what a change of takes the zoom back, beside that of the axes
 * @param {AbortSignal} signal of the view: the picture is taken down with it
 * @returns {Promise<any>} the picture, which has plotly's events
 */
export async function draw(place, traces, layout, signal) {
  const mine = (asked.get(place) ?? 0) + 1;
  asked.set(place, mine);
  await laidOut(place, signal);
  if (signal.aborted) return place;
  const spanning = spanned(traces);
  const complete = merged(common(), layout, spanning);
  const isFirst = !drawn.has(place);
  if (isFirst) await sketched(place, traces, complete, signal);
  const Plotly = await library();
  // A newer drawing takes the place of this one.
  if (signal.aborted || asked.get(place) !== mine) return place;
  await Plotly.react(place, spanning, complete, config(Plotly, place, layout));
  for (const rough of place.querySelectorAll(".sketch")) rough.remove();
  await zoom(place, layout);
  await paintCloud(place, traces);
  if (isFirst) {
    followZoom(place);
    attach(Plotly, place, signal);
  }
  return place;
}

/** Paints the dots of a picture, where it has or had some. @param {HTMLElement} place @param {any[]} traces */
async function paintCloud(place, traces) {
  if (!clouds.has(place) && !traces.some(({ type }) => type === "dots")) return;
  const cloud = clouds.get(place) ?? new Cloud(place);
  if (!clouds.has(place))
    /** @type {any} */ (place).on("plotly_relayout", () => {
      if (!adjusted.has(place)) void cloudAdjusted(place);
    });
  clouds.set(place, cloud);
  cloud.show(traces);
  await cloudAdjusted(place);
}

/** Paints dots by the axes as they are. @param {HTMLElement} place */
async function cloudAdjusted(place) {
  const cloud = clouds.get(place);
  if (cloud && place.isConnected) await adjust(place, { images: cloud.paint(inks().soft) });
}

/**
 * Shows roughly what will be drawn. To compile the drawing library, and to draw a picture, each hold up whatever else a view is to show.
 * @param {HTMLElement} place
 * @param {any[]} traces
 * @param {any} layout complete
 * @param {AbortSignal} signal of the view
 */
async function sketched(place, traces, layout, signal) {
  const ranges = Object.entries(zoomed(keyOf(place), layout)).filter(([path]) => path.endsWith(".range"));
  const zoomedAxes = ranges.map(([path, range]) => [path.split(".")[0], range]);
  const axes = Object.fromEntries(
    zoomedAxes.map(([name, range]) => [name, { ...layout[name], range, autorange: undefined }]),
  );
  const older = place.querySelectorAll(".sketch");
  const isSketched = sketch(place, traces, { ...layout, ...axes }, inks()) !== null;
  for (const rough of older) rough.remove();
  await painted();
  if (!isSketched) return;
  const now = performance.now();
  const times = sketches.get(signal) ?? { first: now, last: now };
  sketches.set(signal, times);
  times.last = now;
  // The view's other pictures are sketched before.
  while (
    performance.now() < Math.min(times.first + LONGEST_MS, isWaiting() ? Infinity : times.last + REST_MS)
  )
    await new Promise((resolve) => setTimeout(resolve, STEP_MS));
}
/** Times of the first and the last sketch of a view [ms]. @type {WeakMap<AbortSignal, {first: number, last: number}>} */
const sketches = new WeakMap();

/** Waits until the browser has painted what there is; compiling the drawing library would hold that up. @returns {Promise<void>} */
function painted() {
  return new Promise((resolve) => void requestAnimationFrame(() => setTimeout(resolve)));
}

/** Keeps in the link how the reader zooms a picture. @param {HTMLElement} place */
function followZoom(place) {
  /** @type {any} */ (place).on("plotly_relayout", (/** @type {any} */ event) => {
    if (adjusted.has(place) || !Object.keys(event).some((name) => /^[xy]axis/.test(name))) return;
    const known = drawn.get(place);
    if (known && place.isConnected) keepZoom(keyOf(place), place, known.layout, known.whole);
  });
}

/**
 * Has a picture follow the size of its place, and takes it down with its view.
 * @param {any} Plotly
 * @param {HTMLElement} place
 * @param {AbortSignal} signal
 */
function attach(Plotly, place, signal) {
  const observer = new ResizeObserver(
    () => place.isConnected && place.clientWidth > 0 && Plotly.Plots.resize(place),
  );
  observer.observe(place);
  signal.addEventListener(
    "abort",
    () => {
      observer.disconnect();
      // After the next view has taken the place of this one.
      setTimeout(() => Plotly.purge(place), 1000);
    },
    { once: true },
  );
}

/**
 * Zooms a picture that has just been drawn as a whole.
 * @param {HTMLElement} place
 * @param {any} layout
 */
async function zoom(place, layout) {
  const axes = JSON.stringify([
    layout.shows,
    ...Object.keys(layout)
      .filter((name) => /^[xy]axis/.test(name))
      .map((name) => layout[name].quantity ?? layout[name].title),
  ]);
  const before = drawn.get(place);
  drawn.set(place, { layout, axes, whole: wholeOf(place, layout) });
  if (before && before.axes !== axes) return forgetZoom(keyOf(place));
  const changes = zoomed(keyOf(place), layout);
  if (Object.keys(changes).length) await adjust(place, changes);
}

/** @param {HTMLElement} place */
function keyOf(place) {
  return place.dataset.zoom ?? "";
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
 * Changes the layout of a picture that is drawn.
 * @param {HTMLElement} place
 * @param {any} changes by path, as plotly's `relayout` takes them
 */
export async function adjust(place, changes) {
  if (!place.classList.contains("js-plotly-plot")) return;
  const Plotly = await library();
  adjusted.add(place);
  await Plotly.relayout(place, changes);
  adjusted.delete(place);
}

function common() {
  const { text, soft, line } = inks();
  const axis = {
    gridcolor: line,
    zerolinecolor: line,
    linecolor: soft,
    ticks: "outside",
    tickcolor: line,
    automargin: true,
    title: { standoff: 8, font: { size: 13 } },
  };
  return {
    paper_bgcolor: "rgba(0,0,0,0)",
    plot_bgcolor: "rgba(0,0,0,0)",
    font: { color: text, family: 'system-ui, "Segoe UI", "Noto Sans", sans-serif', size: 12 },
    margin: { l: 60, r: 16, t: 16, b: 50 },
    colorway: LINES,
    separators: `.${THOUSANDS}`,
    hovermode: "closest",
    modebar: { bgcolor: "rgba(0,0,0,0)", color: soft, activecolor: text },
    legend: { orientation: "h", y: 1.02, yanchor: "bottom", x: 0, font: { size: 12 } },
    xaxis: axis,
    yaxis: axis,
  };
}

/**
 * The common layout with a picture's own; every axis that it names has the common axis below it.
 * @param {any} base
 * @param {any} own
 * @param {any[]} traces
 */
function merged(base, own, traces) {
  const { shows, ...layout } = own;
  const result = { ...base, ...layout };
  for (const name of new Set([
    "xaxis",
    "yaxis",
    ...Object.keys(layout).filter((key) => /^[xy]axis\d*$/.test(key)),
  ])) {
    const { quantity, size, ...given } = layout[name] ?? {};
    const title = typeof given.title === "string" ? { text: given.title } : given.title;
    result[name] = {
      ...base.xaxis,
      exponentformat: exponentsOf(name, given, traces),
      ...given,
      title: { ...base.xaxis.title, ...title },
    };
  }
  return result;
}

/** Least value that is written without a power of ten. */
const WRITTEN = 1e-3;

/**
 * Form of an axis' numbers: powers of ten on a logarithmic axis and of tiny values, otherwise all digits.
 * @param {string} name such as `xaxis2`
 * @param {any} axis
 * @param {any[]} traces
 */
export function exponentsOf(name, axis, traces) {
  const [letter, key] = [name[0], name.replace("axis", "")];
  const isWritten = (/** @type {any} */ value) =>
    typeof value === "number" ? Math.abs(value) >= WRITTEN : Boolean(value);
  const mine = traces.filter((trace) => (trace[`${letter}axis`] ?? letter) === key);
  const isTiny =
    mine.length > 0 && mine.every((trace) => !Array.prototype.some.call(trace[letter] ?? [], isWritten));
  return axis.type === "log" || isTiny ? "power" : "none";
}

/** @param {any} Plotly @param {HTMLElement} place @param {any} layout */
function config(Plotly, place, layout) {
  const filename = (place.getAttribute("aria-label") ?? "picture")
    .replace(/[^\p{L}\p{N}]+/gu, "-")
    .toLowerCase();
  const save = (/** @type {string} */ format) => ({
    name: `save-${format}`,
    title: `Save as ${format.toUpperCase()}`,
    icon: ICONS[format],
    click: () =>
      Plotly.downloadImage(place, {
        format,
        filename,
        width: place.clientWidth,
        height: place.clientHeight,
        scale: format === "png" ? 2 : 1,
      }),
  });
  // plotly would offer to send what is shown to a service of its own.
  const nowhereElse = { showSendToCloud: false, plotlyServerURL: "" };
  // A reader who has zoomed in to a picture in which a window is chosen can choose one again.
  const unused = ["toImage", "lasso2d", "autoScale2d", ...(layout.dragmode === "select" ? [] : ["select2d"])];
  return {
    ...nowhereElse,
    displaylogo: false,
    modeBarButtonsToRemove: unused,
    modeBarButtonsToAdd: [save("png"), save("svg")],
  };
}

/** Letters in a frame: `P` for PNG, `S` for SVG. */
/** @type {Record<string, any>} */
const ICONS = {
  png: {
    width: 24,
    height: 24,
    path: "M2 2h20v20H2zM4 4v16h16V4zM8 6h5a4 4 0 0 1 0 8h-3v4H8zm2 2v4h3a2 2 0 0 0 0-4z",
  },
  svg: {
    width: 24,
    height: 24,
    path: "M2 2h20v20H2zM4 4v16h16V4zM15 9V7H9.500a1.500 1.500 0 0 0-1.500 1.500v3A1.500 1.500 0 0 0 9.500 13H14v3H8v2h6.500a1.500 1.500 0 0 0 1.500-1.500v-4a1.500 1.500 0 0 0-1.500-1.500H10V9z",
  },
};

/**
 * The bar beside coloured values.
 * @param {string} title
 */
export function colourBar(title) {
  const { text } = inks();
  return {
    title: { text: title, side: "right", font: { size: 12 } },
    thickness: 14,
    outlinewidth: 0,
    tickfont: { color: text },
    exponentformat: "none",
  };
}

/** Parts that ticks leave a range in, about: of steps of 1, 2 and 5 at least two fall in any range. */
const PARTS = 6;

/** Ticks of a colour that is shown by its decimal logarithm. @param {number} least @param {number} largest logarithms */
export function logTicks(least, largest) {
  const every = Math.max(1, Math.ceil((largest - least) / (2 * PARTS)));
  const at = [];
  for (let power = Math.floor(least / every) * every; power <= Math.ceil(largest); power += every) {
    for (const digit of largest - least > 2.5 ? [1] : [1, 2, 5]) at.push(Math.log10(digit) + power);
  }
  const within = at.filter((value) => value >= least - 1e-9 && value <= largest + 1e-9);
  if (within.length < 2) return evenTicks(10 ** least, 10 ** largest);
  return { tickvals: within, ticktext: within.map((value) => String(Number((10 ** value).toPrecision(3)))) };
}

/** The same of a range within which there are no two round numbers. @param {number} from @param {number} to the values themselves */
function evenTicks(from, to) {
  if (from === to) return { tickvals: [Math.log10(from)], ticktext: [String(Number(from.toPrecision(3)))] };
  const size = 10 ** Math.floor(Math.log10((to - from) / PARTS));
  const step = size * ([1, 2, 5].find((digit) => digit * size * PARTS >= to - from) ?? 10);
  const first = Math.ceil(from / step);
  const values = Array.from(
    { length: Math.floor(to / step) - first + 1 },
    (_, index) => (first + index) * step,
  );
  const digits = Math.ceil(Math.log10(to / step)) + 1;
  return {
    tickvals: values.map(Math.log10),
    ticktext: values.map((value) => String(Number(value.toPrecision(Math.min(15, digits))))),
  };
}
