// Parts of the form that show fields of the scenario in whole: lists, tables and choices in place of JSON.

import { settings } from "../data/settings.js";
import { fill, h } from "../ui/dom.js";
import { readersNumber, servedEntry } from "./entries.js";
import { changedField, memberOf, withMember } from "./members.js";

/**
 * A scenario with the changes of the form.
 * @typedef {object} Edited
 * @property {(path: string) => any} value of a field, as it is changed
 * @property {(path: string) => any} given value of the scenario
 * @property {(path: string) => boolean} isChanged
 * @property {(path: string, value: unknown) => void} set changes a field in whole; undefined takes back all changes of it
 * @property {(path: string, name: string, value: unknown) => void} setMember changes one member of a field, such as `[0].length`
 */

/** A folded part of the form. */
export class FieldsPart {
  #changes;
  #make;
  /** @type {any} */
  #scenario = null;
  #body = h("div", {});
  #changed = h("span", { class: "small" });
  #paths;

  /**
   * @param {string} summary
   * @param {string[]} paths of its fields
   * @param {import("./rows.js").Rows} changes
   * @param {(edited: Edited) => (HTMLElement | HTMLElement[])[]} make
   * @param {AbortSignal} signal of the view
   */
  constructor(summary, paths, changes, make, signal) {
    this.#paths = paths;
    this.#changes = changes;
    this.#make = make;
    this.element = h("details", {}, h("summary", {}, summary, this.#changed), this.#body);
    settings.addEventListener("change", () => this.draw(), { signal });
    this.draw();
  }

  /** Shows the fields of a scenario; `null` stands for one that cannot be read. @param {any} scenario */
  show(scenario) {
    this.#scenario = scenario;
    this.draw();
  }

  /** Shows changes that were made elsewhere in the form, unless somebody is at this part. */
  refresh() {
    if (!this.#body.contains(document.activeElement)) this.draw();
  }

  draw() {
    const parts = this.#scenario
      ? this.#make(edited(this.#scenario, this.#changes, () => this.draw())).flat()
      : [h("p", { class: "small soft" }, "They appear here once the scenario can be read.")];
    fill(this.#body, parts);
    const isChanged = this.#paths.some((path) => isChangedIn(this.#changes, path));
    this.#changed.textContent = isChanged ? " (changed)" : "";
  }
}

/** True if a field is changed in whole, or a member of it. @param {import("./rows.js").Rows} changes @param {string} path */
export function isChangedIn(changes, path) {
  return changes.get(path) !== undefined || changes.within(path).length > 0;
}

/** @param {any} scenario @param {import("./rows.js").Rows} changes @param {() => void} redraw @returns {Edited} */
function edited(scenario, changes, redraw) {
  const given = (/** @type {string} */ path) => memberOf(scenario, path);
  const value = (/** @type {string} */ path) => changedField(changes, path, given(path));
  const set = (/** @type {string} */ path, /** @type {unknown} */ whole) => {
    changes.put(path, otherThan(given(path), whole));
    redraw();
  };
  return {
    value,
    given,
    set,
    isChanged: (path) => isChangedIn(changes, path),
    setMember: (path, name, member) => {
      const before = memberOf(given(path), name);
      // Members of a field that is changed in whole belong to this change.
      if (changes.get(path) !== undefined || before === undefined || member === undefined)
        changes.put(path, otherThan(given(path), withMember(value(path), name, member)));
      else changes.set(`${path}${name}`, otherThan(before, member));
      redraw();
    },
  };
}

/** A value that differs from the scenario's; undefined if it is the same. @param {unknown} given @param {unknown} value */
function otherThan(given, value) {
  return JSON.stringify(value) === JSON.stringify(given) ? undefined : value;
}

/**
 * A group of fields with a button that takes its changes back.
 * @param {string} heading
 * @param {string} path of the field
 * @param {{isChanged: (path: string) => boolean, set: (path: string, value: undefined) => void}} edited
 * @param {(HTMLElement | HTMLElement[])[]} children
 */
export function group(heading, path, { isChanged, set }, children) {
  const back = h(
    "button",
    {
      type: "button",
      class: "plain small",
      "aria-label": `Take back ${heading.toLowerCase()}`,
      onclick: () => set(path, undefined),
    },
    "Take back",
  );
  return h(
    "fieldset",
    { class: "list", "data-pointer": `/set/${path}` },
    h("legend", {}, heading, " ", isChanged(path) && back),
    children.flat(),
  );
}

/** @param {string} text @param {() => void} onclick */
export function button(text, onclick, label = text) {
  return h("button", { type: "button", "aria-label": label, onclick }, text);
}

/**
 * A number in the reader's unit.
 * @param {string} label
 * @param {string} name of the quantity
 * @param {number | string | null | undefined} value served
 * @param {(value: number | undefined) => void} set is called with undefined only if the number may be left out
 * @param {{min?: number | null, isOptional?: boolean, width?: string}} [options] the least is 0 unless `null` is given
 */
export function numberBox(label, name, value, set, { min = 0, isOptional = false, width = "7rem" } = {}) {
  const box = h("input", {
    type: "number",
    step: "any",
    min,
    "aria-label": label,
    style: `width:${width}`,
    // A scenario of the reader's own may have a text with a unit in the place of a number.
    value: typeof value === "number" ? readersNumber(name, value) : "",
    placeholder: typeof value === "string" ? value : null,
    onchange: () => {
      if (box.value !== "") set(Number(servedEntry(name, box.value)));
      else if (isOptional) set(undefined);
    },
  });
  return box;
}

/**
 * A choice of words without a visible label.
 * @param {string} label
 * @param {[value: string, text: string][]} options
 * @param {string} chosen
 * @param {(value: string) => void} set
 */
export function wordBox(label, options, chosen, set) {
  const box = h(
    "select",
    { "aria-label": label, onchange: () => set(box.value) },
    options.map(([value, text]) => h("option", { value, selected: value === chosen }, text)),
  );
  return box;
}

/** A box for the name of a row. @param {string} label @param {string | undefined} value @param {any} _row @param {(value: string) => void} set */
export function nameBox(label, value, _row, set) {
  const box = h("input", {
    "aria-label": label,
    value: value ?? "",
    maxlength: "100",
    onchange: () => set(box.value.trim()),
  });
  return box;
}
