// Numbers of the form in the reader's units, and the same in the units of a request.

import { inputUnit, unitsOf } from "../data/units.js";

/** Digits of a product of two numbers without the rounding of its last bits. */
const DIGITS = 15;
/** Digits of a number that is shown in other units than those of the request. */
const SHOWN = 6;
/** A number and what follows it. */
const ENTRY = /^([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)\s*(.*)$/;

/** @param {number} value @param {number} digits */
function rounded(value, digits) {
  return Number(value.toPrecision(digits));
}

/**
 * An entry in the served unit. It may have the symbol of a unit of its name, and is in the reader's unit otherwise.
 * @param {string} name
 * @param {string} text such as `158.5` or `600 gpm`
 * @returns {string} the text itself if it is no number of a known unit
 */
export function servedEntry(name, text) {
  const [, number, symbol] = ENTRY.exec(text.trim()) ?? [];
  if (number === undefined) return text;
  const unit = symbol ? unitsOf(name).find((known) => known.symbol === symbol) : inputUnit(name);
  if (!unit) return text;
  return unit.size === 1 ? number : String(rounded(Number(number) * unit.size, DIGITS));
}

/** A served number in the reader's unit. @param {string} name @param {number} value */
export function readersNumber(name, value) {
  const { size } = inputUnit(name);
  return size === 1 ? value : rounded(value / size, SHOWN);
}

/**
 * Values of an axis or of a change with each of their numbers replaced; a count and words stay.
 * @param {string} text
 * @param {(number: string) => string} replaced
 */
function each(text, replaced) {
  if (/^\s*[[{"]/.test(text)) return text;
  if (!text.includes(":"))
    return text
      .split(",")
      .map((word) => replaced(word.trim()))
      .join(", ");
  const parts = text.split(":").map((part) => part.trim());
  return parts.map((part, at) => (at < 2 ? replaced(part) : part)).join(":");
}

/** Text of a row in served units. @param {string} name @param {string} text in the reader's units */
export function servedText(name, text) {
  return unitsOf(name).length ? each(text, (word) => servedEntry(name, word)) : text;
}

/** Text of a row in the reader's units; words stay. @param {string} name @param {string} text in served units */
export function readersText(name, text) {
  if (inputUnit(name).size === 1) return text;
  return each(text, (word) =>
    word === "" || Number.isNaN(Number(word)) ? word : String(readersNumber(name, Number(word))),
  );
}
