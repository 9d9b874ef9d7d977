// Round numbers along linear and logarithmic axes, and their words.

import { number } from "../../data/units.js";

/** Sizes of numbers outside which ticks are powers of ten. */
const [WRITTEN, HUGE] = [1e-3, 1e9];
/** Largest number that a logarithmic axis writes in full. */
const FULL = 1e5;
/** Parts that ticks leave a logarithmic range in, about: of steps of 1, 2 and 5 at least two fall in any range. */
const PARTS = 6;
const SUPERSCRIPTS = "⁰¹²³⁴⁵⁶⁷⁸⁹";

/**
 * Round values between two.
 * @param {number} low
 * @param {number} high
 * @param {number} count of values at most, about
 */
export function roundValues(low, high, count) {
  const rough = (high - low) / count;
  const power = 10 ** Math.floor(Math.log10(rough));
  const step = power * ([1, 2, 5].find((digit) => digit * power >= rough) ?? 10);
  const first = Math.ceil(low / step - 1e-9);
  return Array.from(
    { length: Math.max(0, Math.floor(high / step + 1e-9) - first + 1) },
    (_, index) => (first + index) * step,
  );
}

/** A number at an axis: in full, or as a power of ten where it is tiny or huge. @param {number} value */
export function tickText(value) {
  const size = Math.abs(value);
  if (size !== 0 && (size < WRITTEN || size >= HUGE)) return powerText(value);
  return number(Number(value.toPrecision(6)), 6);
}

/** A number as a multiple of a power of ten, such as `2×10⁻⁵`. @param {number} value */
export function powerText(value) {
  const [digits, exponent] = Math.abs(value).toExponential(2).split("e");
  const power = [...exponent.replace("+", "")].map((sign) =>
    sign === "-" ? "⁻" : SUPERSCRIPTS[Number(sign)],
  );
  const times = Number(digits) === 1 ? "" : `${Number(digits)}×`;
  return `${value < 0 ? "−" : ""}${times}10${power.join("")}`;
}

/**
 * Ticks of a colour that is shown by its decimal logarithm.
 * @param {number} least
 * @param {number} largest logarithms
 * @returns {{tickvals: number[], ticktext: string[]}} logarithms, and the numbers that they are of
 */
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

/**
 * Ticks of a logarithmic axis, in powers of ten where some are tiny or large.
 * @param {number} low
 * @param {number} high the values at its ends
 * @returns {{value: number, text: string}[]}
 */
export function logAxisTicks(low, high) {
  const values = logTicks(Math.log10(low), Math.log10(high)).ticktext.map(Number);
  const isLong = values.some((value) => value < WRITTEN || value > FULL);
  return values.map((value) => ({ value, text: isLong ? powerText(value) : tickText(value) }));
}
