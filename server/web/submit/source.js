// The scenario of a new sweep: a preset, or a scenario of the reader's own from a file or as JSON, with its fields.

import { get, Problem, send } from "../data/api.js";
import { fill, h } from "../ui/dom.js";
import { attend } from "../ui/notices.js";
import { field } from "./problems.js";
import { ScenarioForm } from "./scenario-form.js";
import { object, parsed } from "./values.js";

/** Groups of presets by the beginning of their names, in order; other folders are groups of their own. @type {[RegExp, string][]} */
const GROUPS = [
  [/^[^/]+$/, "The paper's string"],
  [/^wells\//, "Wells"],
  [/^closed\//, "Accuracy"],
  [/^hard\//, "Hard cases"],
];

/**
 * Presets in groups.
 * @param {{name: string}[]} scenarios
 * @returns {[group: string, names: string[]][]}
 */
export function grouped(scenarios) {
  /** @type {Map<string, string[]>} */
  const groups = new Map(GROUPS.map(([, group]) => [group, []]));
  for (const { name } of scenarios) {
    const group = GROUPS.find(([pattern]) => pattern.test(name))?.[1] ?? name.slice(0, name.indexOf("/"));
    groups.set(group, [...(groups.get(group) ?? []), name]);
  }
  return [...groups].filter(([, names]) => names.length);
}

export class Source {
  #scenarios;
  #on;
  #signal;
  #text;
  #file;
  #fields;
  /** Name of the preset; empty for a scenario of the reader's own. */
  #preset;
  /** Source of the scenario whose fields are shown. */
  #fieldsOf = "";
  element = h("div", { "data-pointer": "/scenario" });

  /**
   * @param {any[]} scenarios the presets
   * @param {any} start the request that the form begins with
   * @param {{changed: () => void, refused: (problems: import("./problems.js").Found[]) => void, took: (set: Record<string, unknown>) => void, shown: (scenario: any) => void, changes: import("./scenario-form.js").Changes}} on
   *   `took` gets the changes of a file, `shown` the scenario or `null` if it cannot be read
   * @param {AbortSignal} signal
   */
  constructor(scenarios, start, on, signal) {
    this.#scenarios = scenarios;
    this.#on = on;
    this.#signal = signal;
    this.#preset = start.preset ?? (start.scenario ? "" : preload.PROPOSED.preset);
    this.#text = h("textarea", {
      class: "code",
      "aria-label": "Scenario as JSON",
      spellcheck: "false",
      oninput: on.changed,
      value: start.scenario ? JSON.stringify(start.scenario, null, 2) : "",
    });
    this.#file = h("input", {
      type: "file",
      accept: ".toml,.json",
      "aria-label": "Scenario file",
      onchange: () => attend(this.#take(), signal),
    });
    this.#fields = new ScenarioForm(on.changes, signal);
    this.fields = this.#fields.element;
    this.#draw();
  }

  /** Member of the request. */
  get request() {
    return this.#preset ? { preset: this.#preset } : { scenario: parsed(this.#text.value, "/scenario") };
  }

  #draw() {
    const select = h(
      "select",
      { "aria-label": "Scenario", onchange: () => attend(this.#choose(select.value), this.#signal) },
      h("option", { value: "" }, "— my own, from a file or pasted as JSON"),
      grouped(this.#scenarios).map(([group, names]) =>
        h(
          "optgroup",
          { label: group },
          names.map((name) => h("option", { value: name }, name.slice(name.indexOf("/") + 1))),
        ),
      ),
    );
    select.value = this.#preset;
    fill(
      this.element,
      h("label", { class: "field" }, h("span", {}, "Scenario"), select),
      h(
        "p",
        { class: "small soft" },
        this.#scenarios.find(({ name }) => name === this.#preset)?.description ??
          "A scenario file's JSON; its fields are in SI units.",
      ),
      field("A scenario file, TOML or JSON", this.#file, "/file"),
      !this.#preset && this.#text,
    );
    attend(this.drawFields(), this.#signal);
  }

  /** @param {string} preset @returns {Promise<any>} */
  async #scenarioOf(preset) {
    return (await get(`/v1/scenarios/${encodeURIComponent(preset)}`, {}, this.#signal)).scenario;
  }

  /** @param {string} preset empty for a scenario of the reader's own, which begins as the preset that was chosen before */
  async #choose(preset) {
    if (!preset && !this.#text.value && this.#preset)
      this.#text.value = JSON.stringify(await this.#scenarioOf(this.#preset), null, 2);
    this.#preset = preset;
    this.#draw();
    this.#on.changed();
  }

  /** Takes the scenario of the chosen file. */
  async #take() {
    const chosen = this.#file.files?.[0];
    if (!chosen) return;
    const format = chosen.name.toLowerCase().endsWith(".json") ? "json" : "toml";
    let answer;
    try {
      answer = await send("POST", "/v1/scenarios", { format, text: await chosen.text() }, this.#signal);
    } catch (error) {
      if (!(error instanceof Problem)) throw error;
      const errors = error.errors.length ? error.errors : [{ detail: error.message }];
      this.#on.refused(errors.map(({ detail }) => ({ pointer: "/file", detail })));
      return;
    }
    this.#on.took(answer.set ?? {});
    if (answer.scenario) this.#text.value = JSON.stringify(answer.scenario, null, 2);
    await this.#choose(answer.preset ?? "");
  }

  /** Draws the fields of the scenario, unless they are shown. */
  async drawFields() {
    const source = this.#preset || this.#text.value;
    this.#fields.mark();
    if (source === this.#fieldsOf) return;
    this.#fieldsOf = source;
    const scenario = this.#preset ? await this.#scenarioOf(this.#preset) : object(source);
    if (source !== this.#fieldsOf) return;
    this.#fields.show(scenario);
    this.#on.shown(scenario);
  }
}
