// A cursor over the points of a picture, for readers without a mouse: arrows move it, Enter opens the point.

import { h } from "../ui/dom.js";
import { adjust } from "./plots.js";

/**
 * @typedef {object} Place
 * @property {any} x where the point is drawn
 * @property {any} y
 * @property {number} column its place among the values across
 * @property {number} row its place among the values up
 * @property {number} ordinal
 * @property {string} text what is said of it, its lines apart by `<br>`
 */

/** Weight of a step aside relative to one ahead. */
const ASIDE = 3;
/** @type {Record<string, [number, number]>} */
const STEPS = { ArrowRight: [1, 0], ArrowLeft: [-1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };

/**
 * @param {HTMLElement} picture
 * @param {(ordinal: number) => void} open
 * @returns {{element: HTMLElement, over: (places: Place[]) => {annotations: object[]}}} its status text; `over` takes
 *   the points of a drawing and returns the layout of the label, which stays at its point when a picture is drawn again
 */
export function keyboard(picture, open) {
  const element = h("p", { class: "visually-hidden", role: "status" });
  /** @type {Place[]} */
  let places = [];
  /** @type {Place | undefined} */
  let now;
  picture.tabIndex = 0;

  /** @param {[number, number]} step */
  function next([across, up]) {
    if (!now)
      return places.reduce(
        (/** @type {Place | undefined} */ first, place) =>
          first && (first.row < place.row || (first.row === place.row && first.column <= place.column))
            ? first
            : place,
        undefined,
      );
    const { column, row } = now;
    let [best, least] = [now, Infinity];
    for (const place of places) {
      const [right, above] = [place.column - column, place.row - row];
      const [ahead, aside] = across ? [right * across, Math.abs(above)] : [above * up, Math.abs(right)];
      if (ahead > 0 && ahead + ASIDE * aside < least) [best, least] = [place, ahead + ASIDE * aside];
    }
    return best;
  }

  picture.addEventListener("keydown", (event) => {
    if (event.target !== picture || event.ctrlKey || event.metaKey || event.altKey) return;
    if (event.key === "Enter" && now) open(now.ordinal);
    const step = STEPS[event.key];
    if (!step || !places.length) return;
    event.preventDefault();
    now = next(step);
    if (!now) return;
    element.textContent = now.text.replaceAll("<br>", ", ");
    adjust(picture, label());
  });

  function label() {
    return { annotations: now ? [{ x: now.x, y: now.y, text: now.text, showarrow: true }] : [] };
  }

  return {
    element,
    over: (drawn) => {
      places = drawn;
      now = drawn.find(({ ordinal }) => ordinal === now?.ordinal);
      if (!now) element.textContent = "";
      return label();
    },
  };
}
