// Rows of the form: parameters with their values, and changes of the scenario.

import { inputUnit, label, meaning } from "../data/units.js";
import { fill, h } from "../ui/dom.js";
import { readersText, servedText } from "./entries.js";
import { read } from "./values.js";

/** A name with the text of its values in served units, and the text as it was typed. @typedef {{name: string, values: string, typed?: string}} Row */

export class Rows {
  #kind;
  #rows;
  #changed;
  #isElsewhere;
  element = h("div", {});

  /**
   * @param {"axes" | "set"} kind member of the request
   * @param {Row[]} rows
   * @param {() => void} changed
   * @param {(row: Row) => boolean} [isElsewhere] true of rows that another part of the form shows
   */
  constructor(kind, rows, changed, isElsewhere = () => false) {
    this.#kind = kind;
    this.#rows = rows;
    this.#changed = changed;
    this.#isElsewhere = isElsewhere;
    this.#draw();
  }

  /** Rows that have a name. */
  get named() {
    return this.#rows.filter((row) => row.name);
  }

  /** @param {(row: Row) => boolean} isKept */
  keep(isKept) {
    this.replace(this.#rows.filter(isKept));
  }

  /** @param {Row[]} rows */
  replace(rows) {
    this.#rows = rows;
    this.#draw();
  }

  /** The value of a name; undefined if it has no row. @param {string} name */
  get(name) {
    const row = this.#rows.find((entry) => entry.name === name);
    return row && read(row.values);
  }

  /** Sets a name to a value; undefined removes its row. @param {string} name @param {unknown} value */
  set(name, value) {
    const at = this.#rows.findIndex((entry) => entry.name === name);
    if (value === undefined) {
      if (at >= 0) this.#rows.splice(at, 1);
    } else if (at >= 0) this.#rows[at] = { name, values: JSON.stringify(value) };
    else this.#rows.push({ name, values: JSON.stringify(value) });
    this.#draw();
    this.#changed();
  }

  /** Names of the changes within a field, such as `string.sections[0].length` within `string.sections`. @param {string} path */
  within(path) {
    return this.named
      .map(({ name }) => name)
      .filter((name) => name.startsWith(`${path}.`) || name.startsWith(`${path}[`));
  }

  /** Sets a field in whole, in place of the changes within it. @param {string} path @param {unknown} value undefined removes its row */
  put(path, value) {
    const within = this.within(path);
    this.#rows = this.#rows.filter(({ name }) => !within.includes(name));
    this.set(path, value);
  }

  /** Shows the values in the units that now hold. */
  convert() {
    for (const row of this.#rows) delete row.typed;
    this.#draw();
  }

  #draw() {
    const add = h(
      "button",
      {
        type: "button",
        onclick: () => {
          this.#rows.push({ name: "", values: "" });
          this.#draw();
        },
      },
      this.#kind === "axes" ? "Add a parameter" : "Add a change",
    );
    fill(
      this.element,
      this.#rows.filter((row) => !this.#isElsewhere(row)).map((row) => this.#line(row)),
      add,
    );
  }

  /** @param {Row} row */
  #line(row) {
    const isAxis = this.#kind === "axes";
    const hint = h("span", { class: "small soft" });
    const path = h("input", {
      value: row.name,
      list: "paths",
      "aria-label": isAxis ? "Parameter" : "Field",
      size: 26,
      oninput: () => {
        row.name = path.value.trim();
        take();
        name();
        this.#changed();
      },
    });
    const values = h("input", {
      value: row.typed ?? readersText(row.name, row.values),
      "aria-label": isAxis ? "Values" : "Value",
      size: 22,
      class: "values",
      placeholder: isAxis ? "0.01, 0.02 or 0.01:0.06:6" : "value",
      oninput: () => {
        take();
        this.#changed();
      },
    });
    const take = () => {
      row.typed = values.value;
      row.values = servedText(row.name, values.value);
    };
    const remove = h(
      "button",
      {
        type: "button",
        onclick: () => {
          this.#rows.splice(this.#rows.indexOf(row), 1);
          this.#draw();
          this.#changed();
        },
      },
      "✕",
    );
    const line = h("div", { class: "controls", style: "margin-bottom:.35rem" }, path, values, remove, hint);
    const name = () => {
      line.dataset.pointer = `/${this.#kind}/${row.name}`;
      remove.setAttribute("aria-label", `Remove ${row.name}`);
      path.title = meaning(row.name);
      fill(hint, hintOf(row.name));
    };
    name();
    return line;
  }
}

/** Label and unit of a name, if the vocabulary has more than the name. @param {string} name */
function hintOf(name) {
  const unit = inputUnit(name).symbol;
  return [label(name) !== name.replaceAll("_", " ") && label(name), unit && `in ${unit}`]
    .filter(Boolean)
    .join(", ");
}
