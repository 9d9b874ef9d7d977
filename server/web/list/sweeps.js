// Sweeps of the list: loaded page by page, and kept up to date by a stream of changes.

import { get } from "../data/api.js";
import { debounced, fill, h } from "../ui/dom.js";
import { Rows } from "./rows.js";

/** Time during which new sweeps are collected before the list is requested to find those that pass its filters. */
const COLLECT_MS = 300;

export class Sweeps {
  #filters;
  #service;
  #signal;
  #observer;
  #requestNew;
  rows = new Rows();
  /** Line below the list. */
  end = h("p", { class: "soft small", role: "status" });
  /** Cursor of the next page. @type {string | null} */
  #next = null;
  #isLoading = false;
  /** Numbers the loads, so that the answer to an older filter is dropped. */
  #generation = 0;
  /** Numbers the looks at the first page, so that an answer that a later one has overtaken is dropped. */
  #looks = 0;
  #answered = 0;
  /** Time of the last look. */
  lookedAt = Date.now();
  /** The latest event of each sweep: an answer may be older. @type {Map<string, any>} */
  #events = new Map();
  /** Deleted sweeps, which an older answer may still have. @type {Set<string>} */
  #deleted = new Set();
  /** Sweeps of events that the list does not show. @type {Set<string>} */
  #unknown = new Set();

  /** @param {import("./filters.js").Filters} filters @param {import("./service.js").Service} service @param {AbortSignal} signal */
  constructor(filters, service, signal) {
    this.#filters = filters;
    this.#service = service;
    this.#signal = signal;
    this.#requestNew = debounced(() => this.#lookForNew(), COLLECT_MS, signal);
    const isReached = (/** @type {IntersectionObserverEntry[]} */ entries) =>
      entries.some((entry) => entry.isIntersecting);
    this.#observer = new IntersectionObserver(
      (entries) => isReached(entries) && this.#more().catch(() => {}),
      { rootMargin: "800px" },
    );
    this.#observer.observe(this.end);
    signal.addEventListener("abort", () => this.#observer.disconnect());
  }

  /** Loads the first page in place of all sweeps. */
  async load() {
    const mine = ++this.#generation;
    const page = await get("/v1/sweeps", this.#filters.firstPage, this.#signal);
    if (mine !== this.#generation) return;
    this.rows.clear();
    this.#add(page);
  }

  /** Loads the next page. */
  async #more() {
    if (!this.#next || this.#isLoading) return;
    this.#isLoading = true;
    const mine = this.#generation;
    try {
      const page = await get("/v1/sweeps", { ...this.#filters.firstPage, cursor: this.#next }, this.#signal);
      if (mine === this.#generation) this.#add(page);
    } finally {
      this.#isLoading = false;
    }
    // The observer reports changes only, and a reader who has scrolled to the new end already has not left the end.
    this.#observer.unobserve(this.end);
    this.#observer.observe(this.end);
  }

  /** @param {any} page */
  #add({ sweeps, next }) {
    this.#next = next ?? null;
    for (const sweep of sweeps) if (!this.rows.has(sweep.id)) this.rows.append(sweep);
    this.#sayEnd();
  }

  /** Shows below the list how far it goes. */
  #sayEnd() {
    const { size } = this.rows;
    if (size || this.#next) {
      fill(
        this.end,
        this.#next ? "Further sweeps follow as you scroll." : `${size} ${size === 1 ? "sweep" : "sweeps"}.`,
      );
      return;
    }
    const hasFilter = Object.values(this.#filters.values).some(Boolean);
    fill(
      this.end,
      hasFilter
        ? "No sweep matches these filters."
        : h("span", {}, "There are no sweeps yet. ", h("a", { href: "#/new" }, "Submit the first one"), "."),
    );
  }

  /** Reads the first page again. */
  async look() {
    const mine = this.#generation;
    const look = ++this.#looks;
    this.lookedAt = Date.now();
    const page = await get("/v1/sweeps", this.#filters.firstPage, this.#signal);
    if (mine !== this.#generation || look < this.#answered) return;
    this.#answered = look;
    // Identifiers grow with time: a shown sweep that belongs on that page and is not there does not pass the filters any more.
    const [listed, last] = [
      new Set(page.sweeps.map((/** @type {any} */ sweep) => sweep.id)),
      page.next ? page.sweeps.at(-1).id : "",
    ];
    for (const id of this.rows.ids) if (id > last && !listed.has(id)) this.#remove(id);
    const sweeps = page.sweeps
      .map((/** @type {any} */ sweep) => this.#latest(sweep))
      .filter((/** @type {any} */ sweep) => !this.#deleted.has(sweep.id));
    const fresh = sweeps.filter(
      (/** @type {any} */ sweep) => !this.rows.has(sweep.id) && this.#filters.passes(sweep),
    );
    for (const sweep of sweeps) this.#update(sweep);
    for (const sweep of fresh) this.rows.insert(sweep);
    this.#sayEnd();
  }

  /** The newer of an answer and the latest event. @param {any} sweep of an answer */
  #latest(sweep) {
    const event = this.#events.get(sweep.id);
    return event && isBefore(sweep, event) ? event : sweep;
  }

  /** @param {any} sweep */
  #update(sweep) {
    if (this.#filters.passes(sweep)) this.rows.update(sweep);
    else this.#remove(sweep.id);
  }

  /** @param {string} id */
  #remove(id) {
    if (this.rows.remove(id)) this.#sayEnd();
  }

  /** Takes an event of a sweep. @param {any} sweep */
  hear(sweep) {
    this.#service.changed();
    const before = this.#events.get(sweep.id);
    this.#events.set(sweep.id, sweep);
    if (this.rows.has(sweep.id)) {
      this.#update(sweep);
      return;
    }
    if (before?.revision === sweep.revision && before.state === sweep.state) return;
    this.#unknown.add(sweep.id);
    this.#requestNew();
  }

  /** Takes the event of a deletion. @param {string} id */
  hearDeleted(id) {
    this.#deleted.add(id);
    this.#remove(id);
  }

  #lookForNew() {
    const isNew = [...this.#unknown].some((id) => !this.rows.has(id));
    this.#unknown.clear();
    if (isNew) void this.look().catch(() => {});
  }
}

/**
 * Whether a state of a sweep is older than another: requests raise the revision, and points become final between two revisions.
 * @param {any} sweep
 * @param {any} other the same sweep
 */
function isBefore(sweep, other) {
  const final = (/** @type {any} */ { counts }) => counts.succeeded + counts.failed + counts.cancelled;
  return (
    sweep.revision < other.revision || (sweep.revision === other.revision && final(sweep) < final(other))
  );
}
