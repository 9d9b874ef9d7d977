// A form that adds a point to a comparison.

import { get } from "../data/api.js";
import { choice, debounced, fill, h } from "../ui/dom.js";
import { MOST } from "../ui/last-comparison.js";
import { attend } from "../ui/notices.js";

/** Rest of typing before sweeps are searched. */
const REST_MS = 200;
/** Sweeps that are offered at once. */
export const OFFERED = preload.PAGE;

/** @typedef {import("./comparison.js").Compared} Compared */

export class AddingForm {
  #points;
  #nameOf;
  #signal;
  #chosen;
  #offer = h("span", { style: "display:contents" });
  #found = h("span", { class: "small soft", role: "status" });
  #search;
  #searches = 0;

  /**
   * @param {Compared[]} points that are compared
   * @param {any} listed the newest sweeps
   * @param {{count: number, nameOf: (id: string) => string, add: (key: string) => void}} comparison
   * @param {AbortSignal} signal
   */
  constructor(points, listed, { count, nameOf, add }, signal) {
    this.#points = points;
    this.#nameOf = nameOf;
    this.#signal = signal;
    this.#chosen = points.at(-1)?.id ?? listed.sweeps[0]?.id ?? "";
    const ordinal = h("input", {
      type: "number",
      min: 1,
      value: (points.at(-1)?.ordinal ?? 0) + 1,
      style: "width:6rem",
    });
    this.#search = h("input", {
      type: "search",
      oninput: debounced(() => attend(this.#look(), signal), REST_MS, signal),
      style: "width:12rem",
    });
    const submit = (/** @type {Event} */ event) => {
      event.preventDefault();
      if (this.#chosen && Number(ordinal.value) >= 1) add(`${this.#chosen}:${ordinal.value}`);
    };
    const isFull = count >= MOST;
    this.element = h(
      "form",
      { class: "controls", onsubmit: submit },
      h("label", { class: "field" }, h("span", {}, "Search sweeps"), this.#search),
      this.#offer,
      h("label", { class: "field" }, h("span", {}, "Point"), ordinal),
      h("button", { type: "submit", disabled: isFull }, isFull ? `At most ${MOST}` : "Add"),
      this.#found,
    );
    this.#offerSweeps(listed, "");
  }

  /** Searches sweeps by their names. */
  async #look() {
    const mine = ++this.#searches;
    const name = this.#search.value.trim();
    const page = await get("/v1/sweeps", { limit: OFFERED, name }, this.#signal);
    if (mine === this.#searches) this.#offerSweeps(page, name);
  }

  /** Offers sweeps to take a point of. @param {{sweeps: any[], next?: string | null}} page @param {string} name that was searched */
  #offerSweeps({ sweeps, next }, name) {
    // Sweeps of the points here are at hand, however old they are.
    const own = name
      ? []
      : [...new Set(this.#points.map((point) => point.id))]
          .filter((id) => !sweeps.some((sweep) => sweep.id === id))
          .map((id) => ({ id, name: null }));
    const offered = [...sweeps, ...own];
    if (!offered.some((sweep) => sweep.id === this.#chosen)) this.#chosen = offered[0]?.id ?? "";
    fill(
      this.#offer,
      choice(
        "Sweep",
        offered.map((sweep) => [sweep.id, sweep.name ?? this.#nameOf(sweep.id)]),
        this.#chosen,
        (value) => (this.#chosen = value),
      ),
    );
    const none = name ? `No sweep has ${name} in its name.` : "There are no sweeps yet.";
    this.#found.textContent =
      offered.length === 0 ? none : next ? `The newest ${sweeps.length} are offered; search for others.` : "";
  }
}
