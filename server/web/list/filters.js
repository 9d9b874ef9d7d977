// Filters of the list of sweeps: state, name, owner and tag, which the link holds.

import { choice, h } from "../ui/dom.js";

/** @type {[string, string][]} */
const STATES = [
  ["", "all"],
  ["running", "running"],
  ["paused", "paused"],
  ["completed", "completed"],
  ["cancelled", "cancelled"],
];

export class Filters {
  #state;
  #owner;
  #tag;
  #name;

  /** @param {URLSearchParams} query of the link @param {() => void} changed */
  constructor(query, changed) {
    this.#state = query.get("state") ?? "";
    const input = (
      /** @type {string} */ label,
      /** @type {string} */ name,
      /** @type {string} */ type = "text",
    ) =>
      h("input", {
        type,
        value: query.get(name) ?? "",
        oninput: changed,
        "aria-label": label,
        placeholder: label,
        size: 12,
      });
    this.#name = input("Search names", "name", "search");
    this.#name.size = 24;
    this.#name.title = "Press / to search";
    this.#owner = input("Owner", "owner");
    this.#tag = input("Tag", "tag");
    const states = choice("State", STATES, this.#state, (value) => {
      this.#state = value;
      changed();
    });
    const field = (/** @type {string} */ text, /** @type {HTMLElement} */ element) =>
      h("label", { class: "field" }, h("span", {}, text), element);
    this.element = h(
      "div",
      { class: "controls", role: "search" },
      field("Name", this.#name),
      states,
      field("Owner", this.#owner),
      field("Tag", this.#tag),
    );
  }

  /** The query of the first page. */
  get firstPage() {
    return preload.firstPage({
      state: this.#state,
      name: this.#name.value,
      owner: this.#owner.value,
      tag: this.#tag.value,
    });
  }

  /** The filters by name; a filter that is not set is empty. */
  get values() {
    const { state, name, owner, tag } = this.firstPage;
    return { state, name, owner, tag };
  }

  /** Gives the search the focus. */
  focus() {
    this.#name.focus();
  }
}
