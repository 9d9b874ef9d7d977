// The scenario of a new sweep: a preset, or a scenario of the reader's own from a file or as JSON, with its fields.

import { get, Problem, send } from "../data/api.js";
import { choice, fill, h } from "../ui/dom.js";
import { attend } from "../ui/notices.js";
import { field } from "./problems.js";
import { ScenarioForm } from "./scenario-form.js";
import { object, parsed } from "./values.js";

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
   * @param {{changed: () => void, refused: (problems: import("./problems.js").Found[]) => void, took: (set: Record<string, unknown>) => void, changes: import("./scenario-form.js").Changes}} on
   *   `took` gets the changes of a file
   * @param {AbortSignal} signal
   */
  constructor(scenarios, start, on, signal) {
    this.#scenarios = scenarios;
    this.#on = on;
    this.#signal = signal;
    this.#preset = start.preset ?? (start.scenario ? "" : "paper-200m-damped");
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
    const options = [
      /** @type {[string, string]} */ (["", "— my own, from a file or pasted as JSON"]),
      ...this.#scenarios.map(({ name }) => /** @type {[string, string]} */ ([name, name])),
    ];
    fill(
      this.element,
      choice("Scenario", options, this.#preset, (value) => attend(this.#choose(value), this.#signal)),
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
    if (source === this.#fieldsOf) return;
    this.#fieldsOf = source;
    if (!this.#preset) {
      this.#fields.show(object(source));
      return;
    }
    const scenario = await this.#scenarioOf(this.#preset);
    if (source === this.#fieldsOf) this.#fields.show(scenario);
  }
}
