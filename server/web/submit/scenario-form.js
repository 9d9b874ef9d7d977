// The fields of a scenario as a form, made from its schema: with units, limits and help. What differs from the scenario is a change.

import { get } from "../data/api.js";
import { fill, h } from "../ui/dom.js";
import { attend } from "../ui/notices.js";
import { unitSystem } from "../data/settings.js";
import { number, say, servedUnit } from "../data/units.js";

/** Fields that the form for new sweeps has elsewhere. */
const ELSEWHERE = ["name", "accuracy", "well.survey"];
const REFERENCE = "#/components/schemas/";

/**
 * @typedef {object} Changes
 * @property {(path: string) => unknown} get the changed value of a field; undefined where it is not changed
 * @property {(path: string, value: unknown) => void} set changes a field; undefined takes the change back
 */

/**
 * @param {Changes} changes
 * @param {AbortSignal} signal of the view
 * @returns {{element: HTMLElement, show: (scenario: any) => void}} `show` draws the fields of another scenario, or none
 */
export function scenarioForm(changes, signal) {
  const body = h("div", {});
  /** @type {any} */
  let shownScenario = null;
  /** @type {Record<string, any> | undefined} */
  let schemas;

  async function draw() {
    if (!element.open) return;
    if (!shownScenario) {
      fill(body, h("p", { class: "soft small" }, "The fields appear here once the scenario can be read."));
      return;
    }
    if (!schemas) {
      fill(body, h("p", { class: "soft small", role: "status" }, "Loading…"));
      schemas = /** @type {Record<string, any>} */ (
        (await get("/openapi.json", {}, signal)).components.schemas
      );
    }
    fill(body, section(schemas.Scenario, shownScenario, ""));
  }

  /** @param {any} schema @returns {any} what a reference, or one beside `null`, leads to, with the description nearest to the field */
  function resolved(schema) {
    const choices = (schema.oneOf ?? schema.anyOf)?.filter((/** @type {any} */ one) => one.type !== "null");
    const inner = schema.$ref
      ? schemas?.[schema.$ref.slice(REFERENCE.length)]
      : choices?.length === 1
        ? choices[0]
        : undefined;
    return inner
      ? {
          ...resolved(inner),
          ...(schema.description && { description: schema.description }),
          ...(schema["x-unit"] && { "x-unit": schema["x-unit"] }),
        }
      : schema;
  }

  /** The fields of an object, sections within it folded. @param {any} schema @param {any} value @param {string} path */
  function section(schema, value, path) {
    return Object.entries(schema.properties ?? {}).flatMap(([name, given]) => {
      const at = path ? `${path}.${name}` : name;
      // A section that a scenario leaves out has its defaults, unless it may be none.
      const absent = isOptional(given) ? undefined : {};
      const field = resolved(given);
      return ELSEWHERE.includes(at)
        ? []
        : [part(field, value?.[name] ?? (field.properties ? absent : undefined), at)];
    });
  }

  /** @param {any} schema @param {any} value @param {string} path @returns {HTMLElement} */
  function part(schema, value, path) {
    const isObject = schema.properties && value !== null && value !== undefined;
    if (isObject) return folded(path, schema.description, () => section(schema, value, path));
    const item = schema.items && resolved(schema.items);
    if (item?.properties && Array.isArray(value) && value.length) {
      return folded(path, schema.description, () =>
        value.map((entry, index) =>
          folded(
            `${path}[${index}]`,
            [entry.kind, entry.measured_depth !== undefined && say("measured_depth", entry.measured_depth)]
              .filter(Boolean)
              .join(", "),
            () => section(item, entry, `${path}[${index}]`),
          ),
        ),
      );
    }
    return field(schema, value, path);
  }

  /** @param {string} path @param {string} help @param {() => (HTMLElement | HTMLElement[])[]} make when it is opened first */
  function folded(path, help, make) {
    const inner = h("div", {});
    const details = h(
      "details",
      {
        class: "section",
        ontoggle: (/** @type {Event} */ event) => {
          if (event.target === details && details.open && !inner.childElementCount)
            fill(inner, help && h("p", { class: "small soft" }, plain(help)), make().flat());
        },
      },
      h("summary", {}, last(path)),
      inner,
    );
    return details;
  }

  /** @param {any} schema @param {any} value @param {string} path */
  function field(schema, value, path) {
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
        limits(schema),
        unitSystem() === "field" && typeof now() === "number" && servedUnit(path)
          ? ` = ${say(path, now())}`
          : "",
        isChanged ? ` The scenario has ${written(value)}.` : "",
      );
    };
    /** @param {unknown} entered */
    const set = (entered) => {
      changes.set(
        path,
        JSON.stringify(entered) === JSON.stringify(value) || entered === undefined ? undefined : entered,
      );
      mark();
    };
    const help = `help-${path}`;
    const described = { "aria-describedby": help };
    const words = wordsOf(schema);
    const made = () => {
      /** @type {HTMLElement} */
      let input;
      if (schema.type === "boolean" || words) {
        const options = words ?? ["true", "false"];
        const given = now();
        const select = h(
          "select",
          { ...described, onchange: () => set(words ? select.value : select.value === "true") },
          !options.includes(String(given)) && h("option", { value: "" }, written(given)),
          options.map((word) =>
            h("option", { value: word, selected: word === String(given) }, word.replaceAll("_", " ")),
          ),
        );
        input = select;
      } else if (isNumber(schema)) {
        const box = h("input", {
          ...described,
          type: "number",
          step: schema.type === "integer" ? 1 : "any",
          min: schema.minimum,
          max: schema.maximum,
          value: now() ?? "",
          oninput: () => set(box.value === "" ? undefined : Number(box.value)),
        });
        input = box;
      } else {
        const box = h("input", {
          ...described,
          value: written(now()),
          spellcheck: "false",
          oninput: () => set(read(box.value)),
        });
        input = box;
      }
      mark();
      const unit = servedUnit(path);
      return [
        h("label", { class: "field" }, h("span", {}, `${last(path)}${unit ? ` [${unit}]` : ""}`), input),
        hint,
        back,
        h("p", { class: "small soft", id: help }, plain(schema.description ?? "")),
      ];
    };
    fill(row, ...made());
    return row;
  }

  const element = h(
    "details",
    {
      class: "schema",
      ontoggle: (/** @type {Event} */ event) => event.target === element && attend(draw(), signal),
    },
    h("summary", {}, "All fields, with units, limits and help"),
    body,
  );
  return {
    element,
    show: (scenario) => {
      shownScenario = scenario;
      attend(draw(), signal);
    },
  };
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

/** Bounds that the schema itself states. @param {any} schema */
function limits({ minimum, maximum, exclusiveMinimum }) {
  // Every count has 0 as its least in a schema; what is less than that no text says otherwise.
  return [
    exclusiveMinimum !== undefined && `above ${number(exclusiveMinimum)}`,
    minimum > 0 && `${number(minimum)} or more`,
    maximum !== undefined && `at most ${number(maximum)}`,
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
