// The drawing library, plotly, in two builds: a small one for flat pictures, and the whole one for those that WebGL draws. Compiling either
// takes the page a part of a second in which nothing else happens, so that it waits until a picture needs it.

/** Types of traces that the small build draws. */
const FLAT = new Set(["scatter", "bar", "heatmap", "contour"]);
/** @typedef {"flat" | "whole"} Build */
/** @type {Record<Build, string>} */
const FILES = { flat: "../vendor/plotly-cartesian.min.js", whole: "../vendor/plotly-strict.min.js" };

/** Data that take longer come while the library is compiled. */
const LONG_MS = 900;

/** @type {Map<Build, Promise<any>>} */
const loading = new Map();
/** @type {Map<Build, any>} */
const loaded = new Map();

/** @param {Build} build */
function addressOf(build) {
  return new URL(FILES[build], import.meta.url).href;
}

/** Builds whose files were sent for. @type {Set<Build>} */
const fetched = new Set();

/**
 * Has the file of a build come while data do. It is compiled only for a picture, or where the data take long.
 * @param {Build} build
 * @param {HTMLElement} place of the picture: once its view is left nothing is compiled for it
 */
export function fetchAhead(build, place) {
  if (loaded.has("whole") || loading.has(build)) return;
  // A preload that is not used, since its view was left or another build is there, would be complained of.
  // It is read to its end: the browser keeps no more of a file than was read of it.
  if (!fetched.has(build))
    void fetch(addressOf(build))
      .then((answer) => answer.blob())
      .catch(() => {});
  fetched.add(build);
  setTimeout(() => place.isConnected && !loaded.has("whole") && load(build).catch(() => {}), LONG_MS);
}

/**
 * The library that draws what is given, if it is there.
 * @param {any[]} traces
 */
export function libraryAtHand(traces) {
  return (isFlat(traces) && loaded.get("flat")) || loaded.get("whole");
}

/**
 * @param {any[]} traces
 * @returns {Promise<any>} the library that draws them
 */
export async function library(traces) {
  return libraryAtHand(traces) ?? load(isFlat(traces) ? "flat" : "whole");
}

/** Whether the small build draws it. @param {any[]} traces */
export function isFlat(traces) {
  return traces.every(({ type }) => FLAT.has(type));
}

/** @param {Build} build @returns {Promise<any>} */
function load(build) {
  const known = loading.get(build);
  if (known) return known;
  const work = new Promise((resolve, reject) => {
    const script = document.createElement("script");
    script.src = addressOf(build);
    script.onload = () => {
      // Either build calls itself so.
      loaded.set(build, /** @type {any} */ (globalThis).Plotly);
      resolve(loaded.get(build));
    };
    script.onerror = () => {
      loading.delete(build);
      reject(new Error("the drawing library could not be loaded"));
    };
    document.head.append(script);
  });
  loading.set(build, work);
  return work;
}
