// The fields of a scenario as a form, made from its schema: with units, limits and help. What differs from the scenario is a change.

import { get } from "../data/api.js";
import { settings } from "../data/settings.js";
import { inputUnit, number, servedUnit } from "../data/units.js";
import { fill, h } from "../ui/dom.js";
import { attend } from "../ui/notices.js";
import { readersNumber, servedEntry } from "./entries.js";
import { memberOf, withMember } from "./members.js";
import { numbersBox, tablePart } from "./table.js";

/** Fields that the form for new sweeps has elsewhere. */
const ELSEWHERE = [
  "name",
  "accuracy",
  "well.survey",
  "well.section",
  "recording.nodes",
  "recording.spectrum_windows",
  "recording.snapshots",
  "recording.orbit_window",
  "recording.outputs",
  "mesh",
  "string.sections",
  "string.gauges",
  "string.unbalance",
];
const REFERENCE = "#/components/schemas/";
/** Characters of a line of a text, and the most lines that are shown at once. */
const LINE = 44,
  MOST_LINES = 5;

/** Sections and rows that a scenario does without, as they are proposed: usual values in served units. @type {Record<string, any>} */
const PROPOSED = {
  mud: { density: 1200, flow_rate: 0.02, yield_stress: 0.29, consistency: 0.07, flow_index: 0.55 },
  excitation: { above_bit: 300, direction: "axial", force: 10000, frequency_hz: 18 },
  "cost_study.methods": { integrator: "esdirk4", steps: [0.001, 0.0005, 0.00025] },
  "cost_study.reference.methods": { integrator: "esdirk4", step: 0.000125 },
};

/** Sections of a scenario that may be none. */
const SECTIONS = ["mud", "cost_study"];

/** True of a change that gives a section, which the form shows by its fields. @param {import("./rows.js").Row} row */
export function isSection({ name, values }) {
  return SECTIONS.includes(name) && isObject(read(values));
}

/** @param {unknown} value */
function isObject(value) {
  return typeof value === "object" && value !== null && !Array.isArray(value);
}

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
  /** Names of the sections that are given here, of which there is no other row. */
  #given = h("span", { class: "small" });
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
      h("summary", {}, "All fields, with units, limits and help", this.#given),
      this.#body,
    );
    this.mark();
  }

  /** Names in the summary the sections that are given here. */
  mark() {
    const given = SECTIONS.filter((path) => isObject(this.#changes.get(path))).map(last);
    this.#given.textContent = given.length ? ` (${given.join(", ")} given)` : "";
  }

  /** Shows the fields of a scenario, or none. @param {any} scenario */
  show(scenario) {
    this.#scenario = scenario;
    this.mark();
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

  /** The schema of a reference, or of one next to `null`, with the description nearest to the field. @param {any} schema @returns {any} */
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

  /**
   * The fields of an object, sections within it folded.
   * @param {any} schema
   * @param {any} value
   * @param {string} path
   * @param {Changes} changes
   * @returns {HTMLElement[]}
   */
  #section(schema, value, path, changes = this.#changes) {
    return Object.entries(schema.properties ?? {}).flatMap(([name, given]) => {
      const at = path ? `${path}.${name}` : name;
      // A section that a scenario leaves out has its defaults, unless it may be none.
      const absent = isOptional(given) ? undefined : {};
      const resolved = this.#resolved(given);
      return ELSEWHERE.includes(at)
        ? []
        : [this.#part(resolved, value?.[name] ?? (resolved.properties ? absent : undefined), at, changes)];
    });
  }

  /** @param {any} schema @param {any} value @param {string} path @param {Changes} changes @returns {HTMLElement} */
  #part(schema, value, path, changes) {
    if (schema.properties && isObject(value))
      return folded(path, schema.description, () => this.#section(schema, value, path, changes));
    if (schema.properties) return this.#absent(schema, path, changes);
    const item = schema.items && this.#resolved(schema.items);
    if (item?.properties) return this.#rows(item, schema.description, value, path, changes);
    return field(schema, item, value, path, changes, this.#signal);
  }

  /** A section that the scenario does without, with a tick that gives it. @param {any} schema @param {string} path @param {Changes} changes */
  #absent(schema, path, changes) {
    const body = h("div", {});
    const draw = () => {
      const isGiven = isObject(changes.get(path));
      box.checked = isGiven;
      this.mark();
      fill(body, isGiven && this.#section(schema, undefined, path, memberChanges(changes, path)));
    };
    const box = h("input", {
      type: "checkbox",
      onchange: () => {
        changes.set(path, box.checked ? (PROPOSED[path] ?? {}) : undefined);
        draw();
      },
    });
    return folded(path, schema.description, () => {
      draw();
      return [h("label", { class: "tick" }, box, `Give ${last(path)}`), body];
    });
  }

  /** Objects as rows of a table. @param {any} item schema of one @param {string} help @param {any} value @param {string} path @param {Changes} changes */
  #rows(item, help, value, path, changes) {
    const body = h("div", {});
    const now = () => changes.get(path) ?? value ?? [];
    const set = (/** @type {string} */ at, /** @type {unknown} */ rows) => {
      changes.set(at, rows);
      draw();
    };
    const edited = {
      value: now,
      given: () => value,
      isChanged: () => changes.get(path) !== undefined,
      set,
      setMember: (/** @type {string} */ at, /** @type {string} */ name, /** @type {unknown} */ member) =>
        set(at, withMember(now(), name, member)),
    };
    const columns = Object.entries(item.properties).map(([name, given]) =>
      columnOf(name, this.#resolved(given), item.required?.includes(name)),
    );
    const draw = () =>
      fill(
        body,
        tablePart(
          { path, heading: heading(path), one: "row", columns, proposed: PROPOSED[path] ?? {} },
          edited,
        ),
      );
    return folded(path, help, () => {
      draw();
      return [body];
    });
  }
}

/** Changes of the members of a section that is given in whole. @param {Changes} changes @param {string} whole @returns {Changes} */
function memberChanges(changes, whole) {
  return {
    get: (path) => memberOf(changes.get(whole), path.slice(whole.length)),
    set: (path, value) =>
      changes.set(whole, withMember(changes.get(whole) ?? {}, path.slice(whole.length), value)),
  };
}

/** Column of a member of rows. @param {string} name @param {any} schema @param {boolean} isRequired @returns {import("./table.js").Column} */
function columnOf(name, schema, isRequired) {
  return {
    name,
    text: heading(name),
    words: wordsOf(schema) ?? undefined,
    isList: [schema.type].flat().includes("array"),
    isOptional: !isRequired,
  };
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

/**
 * @param {any} schema
 * @param {any} item schema of the entries of a list
 * @param {any} value of the scenario
 * @param {string} path
 * @param {Changes} changes
 * @param {AbortSignal} signal of the view
 */
function field(schema, item, value, path, changes, signal) {
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
    const input = inputOf(schema, item, path, now(), { "aria-describedby": help }, set);
    mark();
    const unit = inputUnit(path).symbol;
    // Ticks have labels of their own.
    const tag = item && wordsOf(item) ? "div" : "label";
    return [
      h(tag, { class: "field" }, h("span", {}, `${last(path)}${unit ? ` [${unit}]` : ""}`), input),
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
 * An input for a value: a choice of words, a number in the reader's unit, a list of either, or a text.
 * @param {any} schema
 * @param {any} item schema of the entries of a list
 * @param {string} path
 * @param {unknown} value
 * @param {Record<string, string>} attributes
 * @param {(entered: unknown) => void} set
 * @returns {HTMLElement}
 */
function inputOf(schema, item, path, value, attributes, set) {
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
  if (item && wordsOf(item))
    return wordTicks({ ...attributes, "aria-label": last(path) }, wordsOf(item) ?? [], value, set);
  if (item && isNumber(item)) return numbersBox(attributes, Array.isArray(value) ? value : [], set);
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

/** Ticks of several words; none chosen stands for the usual ones. @param {Record<string, string>} attributes @param {string[]} words @param {unknown} value @param {(entered: unknown) => void} set */
function wordTicks(attributes, words, value, set) {
  const chosen = new Set(Array.isArray(value) ? value : []);
  const ticks = words.map((word) => {
    const box = h("input", {
      type: "checkbox",
      checked: chosen.has(word),
      onchange: () => {
        if (box.checked) chosen.add(word);
        else chosen.delete(word);
        set(chosen.size ? words.filter((one) => chosen.has(one)) : undefined);
      },
    });
    return h("label", { class: "tick" }, box, word.replaceAll("_", " "));
  });
  return h("span", { ...attributes, role: "group", class: "line" }, ticks);
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

/** @param {string} path */
function heading(path) {
  const words = last(path);
  return `${words[0].toUpperCase()}${words.slice(1)}`;
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
