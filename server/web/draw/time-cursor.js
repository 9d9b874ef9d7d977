// One time at which all views of a point are read: the player, a line in each picture over time, and a dot on the orbit move it and follow it.

import { debounced } from "../ui/dom.js";

/** Rest of the cursor before the link holds its time: a browser allows a page about 100 changes of the link in 10 s. */
const REST_MS = 200;
/** Decimals of a time in the link: a tenth of a millisecond is shorter than a step of most runs. */
const DECIMALS = 4;

/** Time of a link [s]; null if it names none. @param {URLSearchParams} query */
export function timeInLink(query) {
  const text = query.get("time");
  const time = text ? Number(text) : NaN;
  return Number.isFinite(time) ? time : null;
}

export class TimeCursor {
  #time;
  /** @type {Set<(time: number | null) => void>} */
  #listeners = new Set();
  #keepSoon;
  /** Whether the link still has another time. */
  #isDue = false;

  /**
   * @param {{query: URLSearchParams, keep: (changes: Record<string, string | null>) => void}} link which holds the time
   * @param {AbortSignal} signal of the view
   */
  constructor({ query, keep }, signal) {
    this.#time = timeInLink(query);
    const keepNow = () => {
      if (!this.#isDue) return;
      this.#isDue = false;
      keep({ time: this.#time === null ? null : String(Number(this.#time.toFixed(DECIMALS))) });
    };
    this.#keepSoon = debounced(keepNow, REST_MS, signal);
    // A view that is opened meanwhile begins at this time.
    for (const event of ["pointerdown", "click"]) addEventListener(event, keepNow, { capture: true, signal });
  }

  /** The time [s]; null until one is chosen. */
  get time() {
    return this.#time;
  }

  /** Moves the cursor: all that follow it are told at once, the link once it rests. @param {number} time [s] */
  move(time) {
    if (time === this.#time || !Number.isFinite(time)) return;
    this.#time = time;
    this.#isDue = true;
    for (const listener of this.#listeners) listener(time);
    this.#keepSoon();
  }

  /**
   * Calls a listener at each move.
   * @param {(time: number | null) => void} listener
   * @param {AbortSignal} signal after which it is not called any more
   */
  follow(listener, signal) {
    this.#listeners.add(listener);
    signal.addEventListener("abort", () => this.#listeners.delete(listener), { once: true });
  }
}
