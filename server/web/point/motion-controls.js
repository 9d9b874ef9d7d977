// Controls of the motion of a node.

import { depthOfRecorded, nodeInLink, rangesOf } from "../data/motion-requests.js";
import { componentAt } from "../data/string-parts.js";
import { choice, fill, h } from "../ui/dom.js";
import { sayPlace } from "./part.js";

/** @typedef {import("./motion-choices.js").MotionChoices} MotionChoices */

export class MotionControls {
  #choices;
  #set;
  #choose;
  #from;
  #to;
  element = h("div", { class: "controls" });

  /**
   * @param {MotionChoices} choices
   * @param {(name: string, value: string) => void} set a choice of the link
   * @param {(from: number, to: number) => void} choose a window [s]
   */
  constructor(choices, set, choose) {
    this.#choices = choices;
    this.#set = set;
    this.#choose = choose;
    // The fields of the window stay, so that they keep the keyboard's focus.
    const { from, to } = choices.kept;
    const box = (/** @type {string} */ name) =>
      h("input", {
        type: "number",
        min: from,
        max: to,
        step: "any",
        style: "width:7rem",
        "aria-label": `${name} [s]`,
        onchange: () => choose(Number(this.#from.value), Number(this.#to.value)),
      });
    this.#from = box("From");
    this.#to = box("To");
  }

  /** Shows the window of the link. */
  fillWindow() {
    const { from, to } = this.#choices.window;
    this.#from.value = String(Number(from.toFixed(3)));
    this.#to.value = String(Number(to.toFixed(3)));
  }

  /** @param {(node: number) => string} depthOf a node, in words */
  draw(depthOf) {
    this.fillWindow();
    const { point, query, kept, isZoomed, isLog, range, weighting } = this.#choices;
    const { nodes, rate_hz, orbit_window } = point.scenario.recording;
    const entry = (/** @type {string} */ name, /** @type {HTMLInputElement} */ box) =>
      h("label", { class: "field" }, h("span", {}, `${name} [s]`), box);
    const set = (/** @type {string} */ name) => (/** @type {string} */ value) => this.#set(name, value);
    const { string } = point.scenario;
    const atPlace = (/** @type {import("../data/motion-requests.js").RecordedNode} */ node) =>
      [sayPlace(node), componentAt(string, depthOfRecorded(node, string) ?? NaN)].filter(Boolean).join(", ");
    const nodeName = (/** @type {any} */ node) =>
      node.node !== undefined ? `${node.node}${depthOf(node.node)}` : atPlace(node);
    fill(
      this.element,
      choice(
        "Node",
        nodes.map((/** @type {any} */ node) => [nodeInLink(node), nodeName(node)]),
        query.get("node") ?? nodeInLink(nodes[0]),
        set("node"),
      ),
      entry("From", this.#from),
      entry("To", this.#to),
      choice(
        "Orbit shows",
        [
          ["motion", "the motion"],
          ["hole", "the whole hole"],
        ],
        isZoomed ? "motion" : "hole",
        set("zoom"),
      ),
      choice(
        "Frequencies up to",
        rangesOf(rate_hz).map((text) => [text, `${text} Hz`]),
        String(range),
        set("range"),
      ),
      choice(
        "Amplitude",
        [
          ["linear", "linear"],
          ["log", "logarithmic"],
        ],
        isLog ? "log" : "linear",
        set("amplitude"),
      ),
      choice(
        "Weighting",
        [
          ["hann", "Hann"],
          ["rectangular", "rectangular"],
        ],
        weighting,
        set("window"),
      ),
      h(
        "button",
        { onclick: () => this.#choose(kept.from, kept.to) },
        orbit_window === "settled" ? "All that is kept" : "Whole run",
      ),
    );
  }
}
