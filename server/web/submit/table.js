// Tables of objects in the form: a row for each, with rows added, inserted and removed.

import { inputUnit } from "../data/units.js";
import { h } from "../ui/dom.js";
import { button, group, numberBox, wordBox } from "./fields.js";
import { memberOf } from "./members.js";

/**
 * A column: a member of the row, its head, and the words of a choice or the kind of number. `cell` makes any other input, which sets its member or replaces the row.
 * @typedef {{name: string, text: string, words?: string[], isOptional?: boolean, isSigned?: boolean, isList?: boolean, cell?: (label: string, value: any, row: any, set: (entered: unknown) => void, replace: (row: any) => void) => HTMLElement}} Column
 */

/**
 * A table: the path of its field, what one row is, and a row to begin with. `shows` is a further column, of texts.
 * @typedef {{path: string, heading: string, one: string, columns: Column[], proposed: any, shows?: {head: string, texts: (rows: any[]) => string[]}}} Table
 */

/**
 * @param {Table} table
 * @param {import("./fields.js").Edited} edited
 * @param {HTMLElement[]} below parts below the rows
 */
export function tablePart(table, edited, below = []) {
  const { path, heading, one, columns, proposed, shows } = table;
  /** @type {any[]} */
  const rows = edited.value(path) ?? [];
  const shown = shows?.texts(rows);
  const insert = (/** @type {number} */ at) =>
    edited.set(path, rows.toSpliced(at, 0, rows[Math.min(at, rows.length - 1)] ?? proposed));
  const bodies = rows.map((row, at) =>
    h(
      "tr",
      {},
      h("td", { class: "number" }, at + 1),
      columns.map((column) => h("td", {}, cell(table, column, row, at, edited))),
      shown && h("td", { class: "number" }, shown[at]),
      h(
        "td",
        { class: "actions" },
        button("+", () => insert(at), `Insert a ${one} above ${at + 1}`),
        button("✕", () => edited.set(path, rows.toSpliced(at, 1)), `Remove ${one} ${at + 1}`),
      ),
    ),
  );
  const grid = h("table", { class: "tally" }, h("thead", {}, headOf(table)), h("tbody", {}, bodies));
  return group(heading, path, edited, [
    rows.length
      ? h("div", { class: "scroll", tabindex: "0", role: "region", "aria-label": heading }, grid)
      : h("p", { class: "small soft" }, "None."),
    button(`Add a ${one}`, () => insert(rows.length)),
    below,
  ]);
}

/** @param {Table} table */
function headOf({ path, columns, shows }) {
  const heads = columns.map(({ name, text }) => {
    const { symbol } = inputUnit(`${path}.${name}`);
    return h("th", {}, symbol ? `${text} [${symbol}]` : text);
  });
  return h(
    "tr",
    {},
    h("th", {}, h("span", { class: "visually-hidden" }, "Row")),
    heads,
    shows && h("th", { class: "number" }, shows.head),
    h("th", {}, h("span", { class: "visually-hidden" }, "Change rows")),
  );
}

/** @param {Table} table @param {Column} column @param {any} row @param {number} at @param {import("./fields.js").Edited} edited */
function cell({ path, one }, column, row, at, edited) {
  const { name, text, words, isOptional, isSigned, isList } = column;
  const value = memberOf(row, name);
  const label = `${text} of ${one} ${at + 1}`;
  const set = (/** @type {unknown} */ entered) => edited.setMember(path, `[${at}].${name}`, entered);
  const replace = (/** @type {any} */ whole) => edited.set(path, edited.value(path).with(at, whole));
  if (column.cell) return column.cell(label, value, row, set, replace);
  if (words)
    return wordBox(
      label,
      words.map((word) => [word, word.replaceAll("_", " ")]),
      value,
      set,
    );
  if (isList) return numbersBox({ "aria-label": label }, value ?? [], set);
  const options = { isOptional, width: "4.7rem", ...(isSigned && { min: null }) };
  return numberBox(label, `${path}.${name}`, value, set, options);
}

/**
 * Numbers separated by commas.
 * @param {Record<string, any>} attributes
 * @param {number[]} values
 * @param {(values: number[]) => void} set is not called for a text that has anything else
 */
export function numbersBox(attributes, values, set) {
  const box = h("input", {
    ...attributes,
    value: values.join(", "),
    placeholder: "such as 0.5, 1",
    onchange: () => {
      const numbers = numbersOf(box.value);
      box.setAttribute("aria-invalid", String(!numbers));
      if (numbers) set(numbers);
    },
  });
  return box;
}

/** Numbers of a text; null if it has anything else. @param {string} text @returns {number[] | null} */
export function numbersOf(text) {
  const words = text
    .split(",")
    .map((word) => word.trim())
    .filter(Boolean);
  const numbers = words.map(Number);
  return numbers.every(Number.isFinite) ? numbers : null;
}
