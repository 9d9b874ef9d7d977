// The line of parallel coordinates next to the mouse: the drawing library reports only the very pixels of a line.

const SPACE = "http://www.w3.org/2000/svg";
/** Greatest distance of the mouse from a line [pixels]. */
const NEAR = 6;

/**
 * @typedef {{name: string, values: number[], constraintrange?: number[] | number[][]}} Dimension
 */

/**
 * Tells of the line that the mouse comes near, and marks it.
 * @param {HTMLElement} place the picture
 * @param {(line: number) => void} told of its number
 * @param {AbortSignal} signal
 */
export function followLines(place, told, signal) {
  const mark = document.createElementNS(SPACE, "svg");
  mark.setAttribute("class", "mark");
  mark.setAttribute("aria-hidden", "true");
  const stroke = mark.appendChild(document.createElementNS(SPACE, "polyline"));
  let isAsked = false;
  place.addEventListener(
    "pointermove",
    ({ clientX, clientY }) => {
      if (isAsked) return;
      isAsked = true;
      requestAnimationFrame(() => {
        isAsked = false;
        const axes = axesOf(place);
        const line = nearest(axes, clientX, clientY);
        if (line === null) return mark.remove();
        const { left, top } = place.getBoundingClientRect();
        stroke.setAttribute(
          "points",
          axes.map((axis) => `${axis.x - left},${heightOf(axis, line) - top}`).join(" "),
        );
        place.append(mark);
        told(line);
      });
    },
    { signal },
  );
  place.addEventListener("pointerleave", () => mark.remove(), { signal });
}

/** @typedef {{dimension: Dimension, x: number, top: number, bottom: number, least: number, largest: number}} Axis */

/** The axes as they stand beside each other, which is not always the order of the dimensions. @param {HTMLElement} place @returns {Axis[]} */
function axesOf(place) {
  /** @type {Dimension[]} */
  const dimensions = /** @type {any} */ (place).data?.[0]?.dimensions ?? [];
  const drawn = [...place.querySelectorAll(".axis-brush")].map((element, index) => {
    const box = element.getBoundingClientRect();
    const { values } = dimensions[index];
    const [least, largest] = [
      values.reduce((a, b) => Math.min(a, b), Infinity),
      values.reduce((a, b) => Math.max(a, b), -Infinity),
    ];
    // An axis of a single value reaches a little beyond it.
    const spare = largest > least ? 0 : Math.abs(least) / 10 || 1;
    return {
      dimension: dimensions[index],
      x: box.left + box.width / 2,
      top: box.top,
      bottom: box.bottom,
      least: least - spare,
      largest: largest + spare,
    };
  });
  return drawn.sort((a, b) => a.x - b.x);
}

/** @param {Axis} axis @param {number} line */
function heightOf({ dimension, top, bottom, least, largest }, line) {
  return bottom - ((dimension.values[line] - least) / (largest - least)) * (bottom - top);
}

/**
 * @param {Axis[]} axes @param {number} x @param {number} y
 * @returns {number | null} the nearest line of those that are kept, if one is near
 */
function nearest(axes, x, y) {
  const right = axes.findIndex((axis) => axis.x >= x);
  if (right < 1) return null;
  const [before, after] = [axes[right - 1], axes[right]];
  const part = (x - before.x) / (after.x - before.x);
  const filters = axes.filter(({ dimension }) => dimension.constraintrange?.length);
  let [best, least] = [/** @type {number | null} */ (null), NEAR];
  for (let line = 0; line < before.dimension.values.length; line += 1) {
    const apart = Math.abs(
      heightOf(before, line) + part * (heightOf(after, line) - heightOf(before, line)) - y,
    );
    if (apart < least && filters.every(({ dimension }) => isKept(dimension, line)))
      [best, least] = [line, apart];
  }
  return best;
}

/** @param {Dimension} dimension @param {number} line */
export function isKept(dimension, line) {
  return rangesOf(dimension).some(
    ([from, to]) => dimension.values[line] >= from && dimension.values[line] <= to,
  );
}

/** Filters of an axis; the drawing library has no list for a single one. @param {Dimension} dimension @returns {number[][]} */
export function rangesOf({ constraintrange = [] }) {
  return /** @type {number[][]} */ (
    constraintrange.length && !Array.isArray(constraintrange[0]) ? [constraintrange] : constraintrange
  );
}
