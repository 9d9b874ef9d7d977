// A window of time that is dragged across a history, and the part of an orbit in it.

/** Share of the picture that the whole motion fills. */
const FILLED = 0.9;

/**
 * Lets a window be dragged across a picture whose `dragmode` is `select`.
 * @param {HTMLElement} place the picture
 * @param {(range: [number, number]) => void} moved told of the window at most once a frame
 * @param {(range: [number, number] | null) => void} ended told of the window at last; of none where the drag was broken off
 * @param {AbortSignal} signal
 */
export function dragWindow(place, moved, ended, signal) {
  const detail = (/** @type {Event} */ event) => /** @type {CustomEvent} */ (event).detail;
  place.addEventListener("choosing", (event) => moved(detail(event).x), { signal });
  place.addEventListener("chosen", (event) => ended(detail(event)?.x ?? null), { signal });
}

/** Parts of an orbit by windows of time. */
export class Brush {
  #trace;
  #time;

  /**
   * @param {any} trace of the whole history
   * @param {number[]} time of its samples, rising
   */
  constructor(trace, time) {
    this.#trace = trace;
    this.#time = time;
  }

  /** Ranges of the axes that show the whole motion, so that no part lies outside. @returns {Record<string, [number, number]>} */
  ranges() {
    const ends = (/** @type {number[]} */ values) => [
      values.reduce((a, b) => Math.min(a, b), Infinity),
      values.reduce((a, b) => Math.max(a, b), -Infinity),
    ];
    const [x, y] = [ends(this.#trace.x), ends(this.#trace.y)];
    const half = Math.max(x[1] - x[0], y[1] - y[0]) / (2 * FILLED) || 1;
    const about = (/** @type {number[]} */ [low, high]) =>
      /** @type {[number, number]} */ ([(low + high) / 2 - half, (low + high) / 2 + half]);
    return { xaxis: about(x), yaxis: about(y) };
  }

  /**
   * @param {[number, number]} range of time, half-open
   * @returns {[number, number]} the rows of the history in it, half-open
   */
  rows([from, to]) {
    return [firstNotBelow(this.#time, from), firstNotBelow(this.#time, to)];
  }

  /** The trace of a window. @param {[number, number]} range of time, half-open */
  part(range) {
    const rows = this.rows(range);
    return { ...this.#trace, x: this.#trace.x.slice(...rows), y: this.#trace.y.slice(...rows) };
  }
}

/** @param {number[]} values rising @param {number} value */
function firstNotBelow(values, value) {
  let [low, high] = [0, values.length];
  while (low < high) {
    const middle = (low + high) >> 1;
    if (values[middle] < value) low = middle + 1;
    else high = middle;
  }
  return low;
}
