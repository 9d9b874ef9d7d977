// The accuracy of a new sweep: a name, an allowed error, or integrator and step.

import { inputUnit } from "../data/units.js";
import { choice, fill, h } from "../ui/dom.js";
import { numberBox, wordBox } from "./fields.js";

/** Ways to give an accuracy in addition to its names. @type {[string, string][]} */
const WAYS = [
  ["", "the scenario's"],
  ["draft", "draft"],
  ["standard", "standard"],
  ["reference", "reference"],
  ["statistics", "an error of the statistics"],
  ["trajectory", "an error of the history"],
  ["steps", "integrator and step"],
];
const INTEGRATORS = ["esdirk4", "generalized_alpha", "rk4"];
/** Errors and steps that are proposed. @type {Record<string, any>} */
const PROPOSED = {
  statistics: { statistics: 0.01 },
  trajectory: { trajectory: 0.01 },
  steps: { integrator: "esdirk4", step: 0.001 },
};
/** Numbers of a method that may be left out. @type {[string, string][]} */
const OPTIONAL = [
  ["tolerance", "Tolerance"],
  ["contact_sweeps", "Contact iterations"],
  ["spectral_radius", "Spectral radius"],
];

/** Way in which an accuracy is given; undefined for any other value. @param {any} accuracy */
export function accuracyWay(accuracy) {
  if (accuracy === undefined) return "";
  if (typeof accuracy === "string")
    return accuracy && WAYS.some(([way]) => way === accuracy) && !(accuracy in PROPOSED)
      ? accuracy
      : undefined;
  if (typeof accuracy?.statistics === "number") return "statistics";
  if (typeof accuracy?.trajectory === "number") return "trajectory";
  return typeof accuracy?.integrator === "string" ? "steps" : undefined;
}

export class Accuracy {
  #changed;
  #way;
  /** Members of an accuracy that has no name. @type {any} */
  #given;
  #fields = h("div", { class: "line", "data-pointer": "/set/accuracy" });
  element = h("div", {});

  /** @param {any} accuracy of the request that the form begins with, of a known way @param {() => void} changed */
  constructor(accuracy, changed) {
    this.#changed = changed;
    this.#way = accuracyWay(accuracy) ?? "";
    this.#given = typeof accuracy === "object" ? accuracy : {};
    const ways = choice("Accuracy", WAYS, this.#way, (way) => {
      this.#way = way;
      this.#given = PROPOSED[way] ?? {};
      this.#draw();
      changed();
    });
    fill(this.element, ways, this.#fields);
    this.#draw();
  }

  /** Value of the request; undefined for the scenario's. */
  get value() {
    return this.#way in PROPOSED ? this.#given : this.#way || undefined;
  }

  /** @param {string} name @param {unknown} value */
  #set(name, value) {
    const { [name]: _, ...others } = this.#given;
    this.#given = value === undefined ? others : { ...others, [name]: value };
    this.#changed();
  }

  #draw() {
    fill(
      this.#fields,
      this.#way === "steps"
        ? this.#steps()
        : this.#way in PROPOSED && this.#number(this.#way, "Allowed error, relative"),
    );
  }

  /** @param {string} name @param {string} text */
  #number(name, text, isOptional = false) {
    const path = `accuracy.${name}`;
    const { symbol } = inputUnit(path);
    const box = numberBox(text, path, this.#given[name], (value) => this.#set(name, value), { isOptional });
    return h("label", { class: "field" }, h("span", {}, symbol ? `${text} [${symbol}]` : text), box);
  }

  #steps() {
    const integrator = wordBox(
      "Integrator",
      INTEGRATORS.map((word) => [word, word.replaceAll("_", "-")]),
      this.#given.integrator,
      (word) => this.#set("integrator", word),
    );
    return [
      h("label", { class: "field" }, h("span", {}, "Integrator"), integrator),
      this.#number("step", "Step"),
      OPTIONAL.map(([name, text]) => this.#number(name, text, true)),
    ].flat();
  }
}
