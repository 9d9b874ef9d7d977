// The drawing library, plotly. Compiling it takes the page a part of a second in which nothing else happens, so that it waits until a picture needs it.

const FILE = new URL("../vendor/plotly-cartesian.min.js", import.meta.url).href;

/** Data that take longer come while the library is compiled. */
const LONG_MS = 900;

/** @type {Promise<any> | undefined} */
let loading;
let isFetched = false;

/**
 * Has the library's file come while data do. It is compiled only for a picture, or if the data take long.
 * @param {HTMLElement} place of the picture: once its view is left nothing is compiled for it
 */
export function fetchAhead(place) {
  if (loading) return;
  // A preload that is not used, since its view was left, would be complained of.
  // It is read to its end: the browser keeps no more of a file than was read of it.
  if (!isFetched)
    void fetch(FILE)
      .then((answer) => answer.blob())
      .catch(() => {});
  isFetched = true;
  setTimeout(() => place.isConnected && library().catch(() => {}), LONG_MS);
}

/** @returns {Promise<any>} the library */
export function library() {
  loading ??= new Promise((resolve, reject) => {
    const script = document.createElement("script");
    script.src = FILE;
    script.onload = () => resolve(/** @type {any} */ (globalThis).Plotly);
    script.onerror = () => {
      loading = undefined;
      reject(new Error("the drawing library could not be loaded"));
    };
    document.head.append(script);
  });
  return loading;
}
