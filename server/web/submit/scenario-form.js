// The fields of a scenario as a form, made from its schema: with units, limits and help. What differs from the scenario is a change.

import { get } from "../data/api.js";
import { settings } from "../data/settings.js";
import { inputUnit, number, say, servedUnit } from "../data/units.js";
import { fill, h } from "../ui/dom.js";
import { attend } from "../ui/notices.js";
import { readersNumber, servedEntry } from "./entries.js";

/** Fields that the form for new sweeps has elsewhere. */
const ELSEWHERE = [
  "name",
  "accuracy",
  "well.survey",
  "recording.nodes",
  "recording.spectrum_windows",
  "recording.snapshots",
];
const REFERENCE = "#/components/schemas/";
/** Characters of a line of a text, and the most lines that are shown at once. */
const LINE = 44,
  MOST_LINES = 5;

/**
 * @typedef {object} Changes
 * @property {(path: string) => unknown} get the changed value of a field; undefined where it is not changed
 * @property {(path: string, value: unknown) => void} set changes a field; undefined takes the change back
 */

/** Fields of a scenario, drawn when they are opened. */
export class ScenarioForm {
  #changes;
  #signal;
  #body = h("div", {});
  /** @type {any} */
  #scenario = null;
  /** @type {Record<string, any> | undefined} */
  #schemas;

  /** @param {Changes} changes @param {AbortSignal} signal of the view */
  constructor(changes, signal) {
    this.#changes = changes;
    this.#signal = signal;
    const toggled = (/** @type {Event} */ event) =>
      event.target === this.element && attend(this.#draw(), signal);
    this.element = h(
      "details",
      { class: "schema", ontoggle: toggled },
      h("summary", {}, "All fields, with units, limits and help"),
      this.#body,
    );
  }

  /** Shows the fields of a scenario, or none. @param {any} scenario */
  show(scenario) {
    this.#scenario = scenario;
    attend(this.#draw(), this.#signal);
  }

  async #draw() {
    if (!this.element.open) return;
    if (!this.#scenario) {
      fill(
        this.#body,
        h("p", { class: "soft small" }, "The fields appear here once the scenario can be read."),
      );
      return;
    }
    if (!this.#schemas) {
      fill(this.#body, h("p", { class: "soft small", role: "status" }, "Loading…"));
      this.#schemas = /** @type {Record<string, any>} */ (
        (await get("/openapi.json", {}, this.#signal)).components.schemas
      );
    }
    fill(this.#body, this.#section(this.#schemas.Scenario, this.#scenario, ""));
  }

  /** The schema of a reference, or of one beside `null`, with the description nearest to the field. @param {any} schema @returns {any} */
  #resolved(schema) {
    const choices = (schema.oneOf ?? schema.anyOf)?.filter((/** @type {any} */ one) => one.type !== "null");
    const inner = schema.$ref
      ? this.#schemas?.[schema.$ref.slice(REFERENCE.length)]
      : choices?.length === 1
        ? choices[0]
        : undefined;
    return inner
      ? {
          ...this.#resolved(inner),
          ...(schema.description && { description: schema.description }),
          ...(schema["x-unit"] && { "x-unit": schema["x-unit"] }),
        }
      : schema;
  }

  /** The fields of an object, sections within it folded. @param {any} schema @param {any} value @param {string} path @returns {HTMLElement[]} */
  #section(schema, value, path) {
    return Object.entries(schema.properties ?? {}).flatMap(([name, given]) => {
      const at = path ? `${path}.${name}` : name;
      // A section that a scenario leaves out has its defaults, unless it may be none.
      const absent = isOptional(given) ? undefined : {};
      const resolved = this.#resolved(given);
      return ELSEWHERE.includes(at)
        ? []
        : [this.#part(resolved, value?.[name] ?? (resolved.properties ? absent : undefined), at)];
    });
  }

  /** @param {any} schema @param {any} value @param {string} path @returns {HTMLElement} */
  #part(schema, value, path) {
    const isObject = schema.properties && value !== null && value !== undefined;
    if (isObject) return folded(path, schema.description, () => this.#section(schema, value, path));
    const item = schema.items && this.#resolved(schema.items);
    if (!item?.properties || !Array.isArray(value) || !value.length)
      return field(schema, value, path, this.#changes, this.#signal);
    const entryOf = (/** @type {any} */ entry, /** @type {string} */ at) =>
      folded(
        at,
        [entry.kind, entry.measured_depth !== undefined && say("measured_depth", entry.measured_depth)]
          .filter(Boolean)
          .join(", "),
        () => this.#section(item, entry, at),
      );
    return folded(path, schema.description, () =>
      value.map((entry, index) => entryOf(entry, `${path}[${index}]`)),
    );
  }
}

/** @param {string} path @param {string} help @param {() => (HTMLElement | HTMLElement[])[]} make when it is opened first */
function folded(path, help, make) {
  const inner = h("div", {});
  const toggled = (/** @type {Event} */ event) => {
    if (event.target === details && details.open && !inner.childElementCount)
      fill(inner, help && h("p", { class: "small soft" }, plain(help)), make().flat());
  };
  const details = h("details", { class: "section", ontoggle: toggled }, h("summary", {}, last(path)), inner);
  return details;
}

/** @param {any} schema @param {any} value of the scenario @param {string} path @param {Changes} changes @param {AbortSignal} signal of the view */
function field(schema, value, path, changes, signal) {
  const now = () => {
    const changed = changes.get(path);
    return changed === undefined ? value : changed;
  };
  const hint = h("span", { class: "small soft" });
  const row = h("div", { class: "setting" });
  const back = h(
    "button",
    {
      type: "button",
      class: "plain small",
      onclick: () => {
        changes.set(path, undefined);
        fill(row, ...made());
      },
    },
    "Take back",
  );
  const mark = () => {
    const isChanged = changes.get(path) !== undefined;
    row.classList.toggle("changed", isChanged);
    back.hidden = !isChanged;
    fill(
      hint,
      limits(schema, path),
      inputUnit(path).size !== 1 && typeof now() === "number"
        ? ` = ${number(Number(now()), 6)} ${servedUnit(path)}`
        : "",
      isChanged
        ? ` The scenario has ${typeof value === "number" ? readersNumber(path, value) : written(value)}.`
        : "",
    );
  };
  const set = (/** @type {unknown} */ entered) => {
    changes.set(
      path,
      JSON.stringify(entered) === JSON.stringify(value) || entered === undefined ? undefined : entered,
    );
    mark();
  };
  const help = `help-${path}`;
  const made = () => {
    const input = inputOf(schema, path, now(), { "aria-describedby": help }, set);
    mark();
    const unit = inputUnit(path).symbol;
    return [
      h("label", { class: "field" }, h("span", {}, `${last(path)}${unit ? ` [${unit}]` : ""}`), input),
      hint,
      back,
      h("p", { class: "small soft", id: help }, plain(schema.description ?? "")),
    ];
  };
  fill(row, ...made());
  settings.addEventListener("change", () => fill(row, ...made()), { signal });
  return row;
}

/**
 * An input for a value: a choice of words, a number in the reader's unit, or a text.
 * @param {any} schema
 * @param {string} path
 * @param {unknown} value
 * @param {Record<string, string>} attributes
 * @param {(entered: unknown) => void} set
 * @returns {HTMLElement}
 */
function inputOf(schema, path, value, attributes, set) {
  const words = wordsOf(schema);
  if (schema.type === "boolean" || words) {
    const options = words ?? ["true", "false"];
    const select = h(
      "select",
      { ...attributes, onchange: () => set(words ? select.value : select.value === "true") },
      !options.includes(String(value)) && h("option", { value: "" }, written(value)),
      options.map((word) =>
        h("option", { value: word, selected: word === String(value) }, word.replaceAll("_", " ")),
      ),
    );
    return select;
  }
  if (isNumber(schema)) {
    const box = h("input", {
      ...attributes,
      type: "number",
      step: schema.type === "integer" ? 1 : "any",
      min: schema.minimum && readersNumber(path, schema.minimum),
      max: schema.maximum && readersNumber(path, schema.maximum),
      value: typeof value === "number" ? readersNumber(path, value) : "",
      oninput: () => set(box.value === "" ? undefined : Number(servedEntry(path, box.value))),
    });
    return box;
  }
  const text = written(value);
  const box = h("textarea", {
    ...attributes,
    class: "entry",
    rows: Math.min(MOST_LINES, Math.ceil(text.length / LINE) || 1),
    value: text,
    spellcheck: "false",
    oninput: () => set(read(box.value)),
  });
  return box;
}

/** Whether a field may be `null`. @param {any} schema */
function isOptional(schema) {
  return (
    [schema.type].flat().includes("null") ||
    (schema.oneOf ?? schema.anyOf ?? []).some((/** @type {any} */ one) => one.type === "null")
  );
}

/** @param {any} schema */
function isNumber(schema) {
  return [schema.type].flat().some((type) => type === "number" || type === "integer");
}

/** The words of which a field is one. @param {any} schema @returns {string[] | null} */
function wordsOf(schema) {
  if (schema.type === "string" && schema.enum) return schema.enum;
  const choices = schema.oneOf ?? [];
  return choices.length && choices.every((/** @type {any} */ one) => one.type === "string" && one.enum)
    ? choices.flatMap((/** @type {any} */ one) => one.enum)
    : null;
}

/** Bounds that the schema itself states, in the reader's unit. @param {any} schema @param {string} path */
function limits({ minimum, maximum, exclusiveMinimum }, path) {
  const bound = (/** @type {number} */ value) => number(readersNumber(path, value));
  // Every count has 0 as its least in a schema; what is less than that no text says otherwise.
  return [
    exclusiveMinimum !== undefined && `above ${bound(exclusiveMinimum)}`,
    minimum > 0 && `${bound(minimum)} or more`,
    maximum !== undefined && `at most ${bound(maximum)}`,
  ]
    .filter(Boolean)
    .join(", ");
}

/** @param {string} path */
function last(path) {
  const name = path.slice(path.lastIndexOf(".") + 1);
  return name
    .replace(/\[(\d+)\]$/, (_, index) => ` ${Number(index) + 1}`)
    .replaceAll("_", " ")
    .replace(/ (hz|rpm|deg)$/, "");
}

/** A description without its marks. @param {string} text */
function plain(text) {
  return text.replaceAll("\\[", "[").replaceAll("\\]", "]").replaceAll("`", "").replaceAll("\n", " ");
}

/** @param {unknown} value */
function written(value) {
  if (value === undefined || value === null) return "none";
  return typeof value === "string" ? value : JSON.stringify(value);
}

/** @param {string} text JSON, or else a word */
function read(text) {
  if (text.trim() === "none" || text.trim() === "") return null;
  try {
    return JSON.parse(text);
  } catch {
    return text;
  }
}
