// The link holds the whole view: path and query stand after `#`.

/**
 * @typedef {object} Route
 * @property {string[]} path decoded segments
 * @property {URLSearchParams} query
 */

/**
 * A view fills `main` until `signal` is aborted, and returns its title.
 * @typedef {(main: HTMLElement, route: Route, signal: AbortSignal) => Promise<string>} View
 */

/** @returns {Route} */
export const route = preload.route;

/**
 * The link to a view.
 * @param {string[]} path
 * @param {Record<string, any>} [query] what is absent or empty is left out
 */
export function link(path, query = {}) {
  const pairs = Object.entries(query).filter(
    ([, value]) => value !== null && value !== undefined && value !== "",
  );
  const text = new URLSearchParams(pairs.map(([name, value]) => [name, String(value)])).toString();
  return `#/${path.map(encodeURIComponent).join("/")}${text ? `?${text}` : ""}`;
}

/** Digits of a number in a link. */
const DIGITS = 7;

/** @param {number} value @returns {number} as a link holds it */
export function rounded(value) {
  return Number(value.toPrecision(DIGITS));
}

/** @param {string} target a link as `link` makes it */
export function go(target) {
  location.hash = target;
}

/** The link of the view that is shown, without its query. */
let place = "";

/**
 * Notes which view is shown from now on; the link no longer takes choices of the one before.
 * @param {string[]} path
 * @returns {boolean} whether it is another one than before
 */
export function arrive(path) {
  const before = place;
  place = link(path);
  return place !== before;
}

/** Whether the link still names the view that is shown: the link changes at once, and the view follows. */
function isHere() {
  return link(route().path) === place;
}

/**
 * Changes the query of the link without leaving the view; `null` or an empty text takes an entry away.
 * @param {Record<string, string | number | null | undefined>} changes
 */
export function keep(changes) {
  if (!isHere()) return;
  const { path, query } = route();
  for (const [name, value] of Object.entries(changes)) {
    if (value === null || value === undefined || value === "") query.delete(name);
    else query.set(name, String(value));
  }
  history.replaceState(history.state, "", link(path, Object.fromEntries(query)));
}

/**
 * Holds next to the link what is too long for it: in this tab it is there again where the page is loaded anew, and after going back or forward.
 * @param {string | null} text
 */
export function hold(text) {
  if (!isHere()) return;
  history.replaceState(text === null ? null : { held: text }, "");
}

/** @returns {string | null} what is held next to the link */
export function held() {
  return history.state?.held ?? null;
}
