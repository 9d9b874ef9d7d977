// An axis of a picture: the range of its values, their places, and its ticks.

import { logAxisTicks, roundValues, tickText } from "./ticks.js";

/** Part of a range that stays free beyond its values. */
const SPARE = 0.05;
/** Pixels between two ticks, about. */
const APART = { x: 75, y: 40 };

/** @typedef {[number, number]} Range */
/** @typedef {{value: any, text: string}} Tick */

/** An axis; its ranges are of values on logarithmic axes too, and of the numbers of words where it has words. */
export class Axis {
  /** Pixels from the left or the top of the picture, and along the axis. */
  offset = 0;
  length = 1;

  /**
   * @param {string} name as traces call it, such as `x2`
   * @param {any} own layout of the axis
   * @param {any[]} traces on the axis
   */
  constructor(name, own, traces) {
    this.name = name;
    this.own = own;
    this.isAcross = name[0] === "x";
    this.isLog = own.type === "log";
    this.words = wordsOf(name[0], own, traces);
    /** Range that shows everything. @type {Range} */
    this.whole = own.range ?? spannedRange(this, traces);
    if (own.autorange === "reversed") this.whole = [this.whole[1], this.whole[0]];
    /** @type {Range} */
    this.range = [...this.whole];
  }

  /** Name of the axis in a layout. */
  get key() {
    return `${this.name[0]}axis${this.name.slice(1)}`;
  }

  /** Shows everything again. */
  reset() {
    this.range = [...this.whole];
  }

  /** Place of a value in the picture [pixels]; not a number where it has none. @param {any} value */
  toPixel(value) {
    const [from, to] = this.#ends();
    const part = (this.#along(value) - from) / (to - from);
    return this.offset + (this.isAcross ? part : 1 - part) * this.length;
  }

  /** Places of many values. @param {ArrayLike<any>} values @returns {Float64Array} */
  toPixels(values) {
    const [from, to] = this.#ends();
    const scale = (this.isAcross ? this.length : -this.length) / (to - from);
    const start = this.isAcross ? this.offset : this.offset + this.length;
    return Float64Array.from(values, (value) => start + (this.#along(value) - from) * scale);
  }

  /** Value at a place in the picture; between words a broken number of them. @param {number} pixel */
  toValue(pixel) {
    const [from, to] = this.#ends();
    const part = (pixel - this.offset) / this.length;
    const along = from + (this.isAcross ? part : 1 - part) * (to - from);
    return this.isLog ? 10 ** along : along;
  }

  /** Pixels of a unit of the range: of a decade on a logarithmic axis. */
  get scale() {
    const [from, to] = this.#ends();
    return this.length / Math.abs(to - from);
  }

  /**
   * Range about the middle of the present one.
   * @param {number} factor by which it is as large
   * @returns {Range}
   */
  widened(factor) {
    const half = (this.length * factor) / 2;
    const middle = this.offset + this.length / 2;
    return this.between(middle - half, middle + half);
  }

  /** Range between two places in the picture, in the direction of the axis. @param {number} first @param {number} last @returns {Range} */
  between(first, last) {
    const ends = [Math.min(first, last), Math.max(first, last)].map((pixel) => this.toValue(pixel));
    return this.isAcross ? [ends[0], ends[1]] : [ends[1], ends[0]];
  }

  /** Ticks within the range. @param {number} [length] of the axis [pixels] @returns {Tick[]} */
  ticks(length = this.length) {
    const [low, high] = [Math.min(...this.range), Math.max(...this.range)];
    if (this.words)
      return this.words
        .filter((_, order) => order >= low && order <= high)
        .map((text) => ({ value: text, text }));
    if (this.isLog) return logAxisTicks(low, high);
    const count = this.own.nticks ?? Math.max(3, length / APART[this.isAcross ? "x" : "y"]);
    const values = roundValues(low, high, count);
    // One number is no scale.
    const enough = values.length > 1 ? values : roundValues(low, high, 2 * count);
    return enough.map((value) => ({ value, text: tickText(value) }));
  }

  /** @param {any} value */
  #along(value) {
    if (this.words) return typeof value === "number" ? value : this.#placeOf(value);
    if (typeof value !== "number") return NaN;
    if (!this.isLog) return value;
    return value > 0 ? Math.log10(value) : NaN;
  }

  /** @param {any} word */
  #placeOf(word) {
    const place = /** @type {string[]} */ (this.words).indexOf(word);
    return place < 0 ? NaN : place;
  }

  #ends() {
    return this.isLog ? [Math.log10(this.range[0]), Math.log10(this.range[1])] : this.range;
  }
}

/**
 * Words along an axis, in their order; none where it has numbers.
 * @param {string} letter
 * @param {any} own
 * @param {any[]} traces
 * @returns {string[] | null}
 */
function wordsOf(letter, own, traces) {
  /** @type {Set<string>} */
  const words = new Set(own.categoryarray ?? []);
  for (const trace of traces) {
    const values = trace[letter];
    for (let row = 0; row < values.length; row += 1)
      if (typeof values[row] === "string") words.add(values[row]);
  }
  return words.size ? [...words] : null;
}

/**
 * Range that the values of some traces span, with room beyond marks.
 * @param {Axis} axis
 * @param {any[]} traces
 * @returns {Range}
 */
function spannedRange({ name, own, isAcross, isLog, words }, traces) {
  if (words) return [-0.5, words.length - 0.5];
  let [least, largest] = [Infinity, -Infinity];
  const reach = (/** @type {number} */ value) => {
    if (value < least) least = value;
    if (value > largest) largest = value;
  };
  let isSpared = !isAcross && traces.some((trace) => !trace.z);
  for (const trace of traces) {
    const values = reachedBy(trace, name[0], isLog);
    for (let row = 0; row < values.length; row += 1) {
      const value = values[row];
      if (typeof value === "number") reach(isLog ? (value > 0 ? Math.log10(value) : NaN) : value);
    }
    if (trace.mode?.includes("markers") || trace.type === "bar" || trace.type === "dots") isSpared = true;
  }
  if (traces.some((trace) => trace.z)) isSpared = false;
  if (own.rangemode === "tozero" && !isLog) reach(0);
  if (!(least <= largest)) [least, largest] = isLog ? [-1, 1] : [0, 1];
  const width = largest - least;
  const spare = width > 0 ? width * (isSpared ? SPARE : 0) : isLog ? 0.5 : Math.abs(least) / 10 || 1;
  // Bars and what begins at zero stand on the axis.
  const isOnZero = !isLog && (own.rangemode === "tozero" || traces.some((trace) => isLength(trace, name[0])));
  const low = isOnZero && least === 0 ? 0 : least - spare;
  const high = isOnZero && largest === 0 ? 0 : largest + spare;
  return isLog ? [10 ** low, 10 ** high] : [low, high];
}

/** Values that a trace reaches along an axis. @param {any} trace @param {string} letter @param {boolean} isLog @returns {ArrayLike<any>} */
function reachedBy(trace, letter, isLog) {
  const values = trace[letter];
  if (trace.z && trace.type !== "contour")
    return edgesOf([...values], letter === "x" ? (trace.z[0]?.length ?? 0) : trace.z.length, isLog);
  const error = trace[`error_${letter}`];
  const ends = error
    ? [...values].flatMap((value, row) =>
        typeof value === "number" ? errorEnds(error, row).map((end) => value + end) : [],
      )
    : values;
  return isLength(trace, letter) ? [0, ...ends] : ends;
}

/** Ends of an error bar, from its value. @param {any} error @param {number} row @returns {[number, number]} */
export function errorEnds({ array, arrayminus = array }, row) {
  return [-(arrayminus[row] ?? 0), array[row] ?? 0];
}

/** Whether bars of a trace have their lengths along an axis. @param {any} trace @param {string} letter */
function isLength(trace, letter) {
  return trace.type === "bar" && letter === (trace.orientation === "h" ? "x" : "y");
}

/**
 * Ends of cells: as they are given, or in the middle between the cells' own places.
 * @param {number[]} values ends or middles
 * @param {number} cells how many
 * @param {boolean} [isLog]
 * @returns {number[]}
 */
export function edgesOf(values, cells, isLog = false) {
  if (values.length !== cells) return values;
  const [to, from] = isLog
    ? [Math.log10, (/** @type {number} */ value) => 10 ** value]
    : [(/** @type {number} */ value) => value, (/** @type {number} */ value) => value];
  if (cells === 1) return [from(to(values[0]) - 0.5), from(to(values[0]) + 0.5)];
  const middles = values.map(to);
  const between = middles.slice(1).map((value, index) => (value + middles[index]) / 2);
  return [2 * middles[0] - between[0], ...between, 2 * middles[cells - 1] - between[cells - 2]].map(from);
}
