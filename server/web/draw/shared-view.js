// One viewpoint of several strings in space, which the link holds.

import { debounced, h } from "../ui/dom.js";
import { StringScene } from "./string-scene.js";
import { freeView, planView, readView, roundedView, sayView, sectionView } from "./viewpoint.js";

/** Rest of the view before the link holds it. */
const REST_MS = 200;

/** @typedef {import("./viewpoint.js").View} View */

export class SharedView {
  #section;
  #view;
  #keep;
  #signal;
  /** @type {StringScene[]} */
  #scenes = [];

  /**
   * @param {import("../data/well-frames.js").Vector[]} axis of the hole whose vertical section is the usual view
   * @param {{query: URLSearchParams, keep: (changes: Record<string, string | null>) => void, signal: AbortSignal}} link
   */
  constructor(axis, { query, keep, signal }) {
    this.#section = roundedView(sectionView(axis));
    this.#view = readView(query.get("turn") ?? "", this.#section);
    this.#keep = debounced(() => keep({ turn: sayView(this.#view, this.#section) || null }), REST_MS, signal);
    this.#signal = signal;
  }

  /** A picture that turns with the others. @param {string} name */
  scene(name) {
    const scene = new StringScene(name, this.#view, this.#section, () => this.#turned(), this.#signal);
    this.#scenes.push(scene);
    return scene;
  }

  /** Buttons for viewpoints. */
  buttons() {
    /** @type {[string, View][]} */
    const views = [
      ["Section", this.#section],
      ["Plan", roundedView(planView())],
      ["Free view", freeView()],
    ];
    const turnTo = (/** @type {View} */ to) => {
      Object.assign(this.#view, to);
      this.#turned();
    };
    return h(
      "span",
      { role: "group", "aria-label": "Viewpoint", style: "display:flex;gap:.3rem" },
      views.map(([text, view]) => h("button", { onclick: () => turnTo(view) }, text)),
    );
  }

  #turned() {
    for (const scene of this.#scenes) scene.turned();
    this.#keep();
  }
}
