// Columns of words, such as states and classes: the order of their words, and a colour for each.

import { rankOf } from "../data/judgement.js";
import { distinct } from "../data/sweep-table.js";
import { classColour, stateColour } from "../draw/picture/colours.js";

/** Column with the class of each point. */
export const CLASS = "class";

/**
 * The different words of a column: classes by severity, others in order of the alphabet.
 * @param {string} name of the column
 * @param {import("../data/sweep-table.js").Values} values
 */
export function wordsOf(name, values) {
  const words = distinct(values).map(String);
  return name === CLASS ? words.sort((a, b) => rankOf(a) - rankOf(b)) : words;
}

/**
 * Colour of a word: classes and states have the same everywhere.
 * @param {string} name of the column
 * @param {string} word
 * @param {string} other colour of a word that is neither
 */
export function wordColour(name, word, other) {
  return name === CLASS ? classColour(word) : (stateColour(word) ?? other);
}

/**
 * A column by which rows are sorted: classes by their rank.
 * @param {string} name of the column
 * @param {import("../data/sweep-table.js").Values} values
 * @returns {import("../data/sweep-table.js").Values}
 */
export function sortable(name, values) {
  return name === CLASS ? values.map((value) => (value === null ? null : rankOf(String(value)))) : values;
}
