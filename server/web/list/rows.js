// Rows of the list of sweeps, one of which the keyboard selects.

import { Pace } from "../data/pace.js";
import { label, number } from "../data/units.js";
import { fill, h } from "../ui/dom.js";
import { progressPart, when } from "../ui/progress.js";
import { link } from "../ui/router.js";

/** @typedef {{sweep: any, row: HTMLTableRowElement, pace: Pace}} Entry */

/** Sweeps by their identifiers, each with a row. */
export class Rows {
  #body = h("tbody", {});
  /** @type {Map<string, Entry>} */
  #known = new Map();
  /** The sweep that the keyboard has selected. @type {string | null} */
  #selected = null;

  constructor() {
    const heads = [
      h("th", {}, "Sweep"),
      h("th", {}, "State"),
      h("th", { class: "wide-only" }, "Owner"),
      h("th", { class: "wide-only" }, "Submitted"),
    ];
    this.element = h("table", { "aria-label": "Sweeps" }, h("thead", {}, h("tr", {}, heads)), this.#body);
  }

  get size() {
    return this.#known.size;
  }

  get ids() {
    return [...this.#known.keys()];
  }

  /** @param {string} id */
  has(id) {
    return this.#known.has(id);
  }

  clear() {
    this.#known.clear();
    this.#selected = null;
    fill(this.#body);
  }

  /** Adds a sweep at the end. @param {any} sweep */
  append(sweep) {
    this.#enter(sweep, null);
  }

  /** Adds a sweep at its place: identifiers grow with time, and the newest stands first. @param {any} sweep */
  insert(sweep) {
    this.#enter(sweep, [...this.#body.rows].find((row) => (row.dataset.sweep ?? "") < sweep.id) ?? null);
  }

  /** @param {any} sweep @param {HTMLTableRowElement | null} below the row below it */
  #enter(sweep, below) {
    const entry = { sweep, row: h("tr", { "data-sweep": sweep.id }), pace: new Pace() };
    entry.pace.note(sweep);
    this.#known.set(sweep.id, entry);
    drawRow(entry);
    this.#body.insertBefore(entry.row, below);
  }

  /** Redraws the row of a sweep if that has changed. @param {any} sweep */
  update(sweep) {
    const entry = this.#known.get(sweep.id);
    if (!entry) return;
    const isChanged = JSON.stringify(sweep) !== JSON.stringify(entry.sweep);
    entry.sweep = sweep;
    entry.pace.note(sweep);
    if (!isChanged) return;
    const isFocused = entry.row.contains(document.activeElement);
    drawRow(entry);
    if (isFocused) entry.row.querySelector("a")?.focus({ preventScroll: true });
  }

  /** Removes a sweep. @param {string} id @returns {boolean} whether it had a row */
  remove(id) {
    const row = this.#known.get(id)?.row;
    if (!row) return false;
    const { rows } = this.#body;
    // The neighbour of a removed selection is selected; a reader who types in a field keeps the focus there.
    if (id === this.#selected && rows.length > 1)
      this.move(row === rows[rows.length - 1] ? -1 : 1, row.contains(document.activeElement));
    row.remove();
    this.#known.delete(id);
    return true;
  }

  /** Moves the selection by a number of rows. @param {number} by @param {boolean} [isFocused] whether the row gets the focus */
  move(by, isFocused = true) {
    const rows = [...this.#body.rows];
    if (!rows.length) return;
    const before = this.#known.get(this.#selected ?? "")?.row;
    const next = rows[before ? Math.max(0, Math.min(rows.length - 1, rows.indexOf(before) + by)) : 0];
    before?.removeAttribute("aria-selected");
    this.#selected = next.dataset.sweep ?? null;
    next.setAttribute("aria-selected", "true");
    if (!isFocused) return;
    next.querySelector("a")?.focus({ preventScroll: true });
    next.scrollIntoView({ block: "nearest" });
  }
}

/**
 * Varied parameters of a sweep in words, such as `Flow rate × mud density`; empty if the service names none.
 * @param {{varied?: string[] | null}} sweep
 */
export function variedWords({ varied }) {
  const words = (varied ?? []).map(label).join(" × ");
  return words && `${words[0].toUpperCase()}${words.slice(1)}`;
}

/** @param {Entry} entry */
function drawRow({ row, sweep, pace }) {
  const title = sweep.name ?? `Sweep ${sweep.id.slice(-8)}`;
  const tags = (sweep.tags ?? []).map((/** @type {string} */ tag) =>
    h("a", { class: "tag", href: link(["sweeps"], { tag }) }, tag),
  );
  fill(
    row,
    h(
      "td",
      {},
      h("a", { class: "name", href: link(["sweeps", sweep.id]) }, title),
      variedWords(sweep) && h("div", { class: "varied" }, variedWords(sweep)),
      h(
        "div",
        { class: "small soft" },
        `${number(sweep.counts.total)} ${sweep.counts.total === 1 ? "point" : "points"} `,
        tags,
      ),
    ),
    h("td", {}, progressPart(sweep, pace)),
    h("td", { class: "wide-only" }, sweep.owner),
    h("td", { class: "wide-only" }, when(sweep.created)),
  );
}
