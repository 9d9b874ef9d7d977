// Sweeps of the list: loaded page by page, and kept up to date by polling.

import { get } from "../data/api.js";
import { fill, h } from "../ui/dom.js";
import { Rows } from "./rows.js";

/** Largest number of sweeps that are kept up to date: the longest page of the service. */
const LARGEST_PAGE = 500;

export class Sweeps {
  #filters;
  #signal;
  #observer;
  rows = new Rows();
  /** Line below the list. */
  end = h("p", { class: "soft small", role: "status" });
  /** Cursor of the next page. @type {string | null} */
  #next = null;
  #isLoading = false;
  /** Numbers the loads, so that the answer to an older filter is dropped. */
  #generation = 0;
  #isRefreshing = false;

  /** @param {import("./filters.js").Filters} filters @param {AbortSignal} signal */
  constructor(filters, signal) {
    this.#filters = filters;
    this.#signal = signal;
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

  /** Requests the newest sweeps again, as many as are shown. */
  async refresh() {
    if (this.#isRefreshing) return;
    this.#isRefreshing = true;
    const mine = this.#generation;
    try {
      const { firstPage } = this.#filters;
      const limit = Math.min(Math.max(firstPage.limit, this.rows.size), LARGEST_PAGE);
      const page = await get("/v1/sweeps", { ...firstPage, limit }, this.#signal);
      if (mine === this.#generation) this.#merge(page);
    } finally {
      this.#isRefreshing = false;
    }
  }

  /** Updates the rows by a page that begins with the newest sweep. @param {{sweeps: any[], next?: string}} page */
  #merge({ sweeps, next }) {
    // Identifiers grow with time: a shown sweep that belongs on this page and is not on it was deleted, or does not pass the filters any more.
    const listed = new Set(sweeps.map((sweep) => sweep.id));
    const last = next ? sweeps[sweeps.length - 1].id : "";
    for (const id of this.rows.ids) if (id > last && !listed.has(id)) this.rows.remove(id);
    for (const sweep of sweeps) {
      if (this.rows.has(sweep.id)) this.rows.update(sweep);
      else this.rows.insert(sweep);
    }
    this.#sayEnd();
  }
}
