// Numbers of a column: with equal decimals, so that their points are below each other, and their places in its range.

import { number, signed, THOUSANDS } from "./units.js";

/** Decimals by which a column may have more than its largest number needs, so that small ones keep digits. */
const FURTHER = 3;
/** Digits that the smallest number keeps if it can. */
const LEAST_DIGITS = 3;
/** Numbers whose trailing zeros are looked at. */
const LOOKED_AT = 500;
/** Sizes between which numbers are written without powers of ten. */
const PLAIN = [1e-3, 1e9];

/**
 * Writes the numbers of a column with equal decimals; those of a range too wide for that each in its own digits.
 * @param {number[]} values in the unit in which they are shown
 * @param {number} digits significant ones of the largest
 * @returns {(value: number) => string}
 */
export function aligner(values, digits) {
  const each = (/** @type {number} */ value) => number(value, digits);
  const range = rangeOf(values.map(Math.abs).filter((size) => size > 0 && Number.isFinite(size)));
  if (!range) return each;
  const [least, largest] = range;
  if (largest < PLAIN[0] || largest >= PLAIN[1]) return each;
  const ofLargest = Math.max(0, decimalsFor(largest, digits));
  const most = Math.max(ofLargest, Math.min(decimalsFor(least, LEAST_DIGITS), ofLargest + FURTHER));
  // A number that would lose all of its digits is written by itself.
  if (least < 0.5 * 10 ** -most) return each;
  const every = Math.ceil(values.length / LOOKED_AT);
  const needed = values.reduce(
    (decimals, value, index) => (index % every ? decimals : Math.max(decimals, decimalsOf(value, digits))),
    0,
  );
  const decimals = Math.min(needed, most);
  return (value) => grouped(value, decimals, largest);
}

/** Decimals of a number of some significant digits. @param {number} size @param {number} digits */
function decimalsFor(size, digits) {
  return digits - 1 - Math.floor(Math.log10(size));
}

/** Decimals of a number in some significant digits, without zeros at its end. @param {number} value @param {number} digits */
function decimalsOf(value, digits) {
  const text = String(Number(value.toPrecision(digits)));
  const [mantissa, power = "0"] = text.split("e");
  return Math.max(0, (mantissa.split(".")[1]?.length ?? 0) - Number(power));
}

/** @param {number} value @param {number} decimals @param {number} largest of the column */
function grouped(value, decimals, largest) {
  const text = signed(value.toFixed(decimals));
  if (largest < 1e4) return text;
  const [whole, part] = text.split(".");
  const apart = whole.replace(/\B(?=(\d{3})+$)/g, THOUSANDS);
  return part === undefined ? apart : `${apart}.${part}`;
}

/** Least and largest of some values; null if there are none. @param {number[]} values @returns {[number, number] | null} */
export function rangeOf(values) {
  let [least, largest] = [Infinity, -Infinity];
  for (const value of values) {
    if (value < least) least = value;
    if (value > largest) largest = value;
  }
  return least <= largest ? [least, largest] : null;
}

/** Place of a value in a range, 0 to 1; null in a range of one value. @param {[number, number]} range @param {number} value */
export function placeIn([least, largest], value) {
  return largest > least ? (value - least) / (largest - least) : null;
}

/**
 * Range with some room beyond the values on either side.
 * @param {(number | null)[]} values
 * @param {number} room part of the range
 * @returns {[number, number] | undefined} undefined if there are no values
 */
export function roomyRange(values, room) {
  const range = rangeOf(values.filter((value) => value !== null && Number.isFinite(value)).map(Number));
  if (!range) return undefined;
  const [least, largest] = range;
  const spare = (largest - least || Math.abs(least) || 1) * room;
  return [least - spare, largest + spare];
}
