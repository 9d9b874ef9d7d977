// A sweep: its state with what can be done to it, and its points as maps, clouds, sensitivities, a table and failures.

import { follow, get, isFinal, send } from "../data/api.js";
import { Biases, sayWorst } from "../data/biases.js";
import { Depths } from "../data/depths.js";
import { Pace } from "../data/pace.js";
import { hasNotBegun, sweepsBefore } from "../data/queue.js";
import { SweepTable, sweptBy } from "../data/sweep-table.js";
import { label, nodeOfColumn } from "../data/units.js";
import { choice, fill, h } from "../ui/dom.js";
import { attend, reported, notice } from "../ui/notices.js";
import { progressPart, when } from "../ui/progress.js";
import { reportLink } from "../ui/report-link.js";
import { go, keep, link } from "../ui/router.js";
import { MAY_NOT, maySubmit } from "../ui/session.js";
import { snippets } from "../ui/snippets.js";
import { sweepLines } from "./snippets.js";

/** @typedef {import("./part.js").Context} Context */

/**
 * The views: name in the link, what it is called, and what makes it.
 * @type {[string, string, () => Promise<(context: Context) => import("./part.js").Part>][]}
 */
const PARTS = [
  ["map", "Map", async () => (await import("./map.js")).map],
  ["window", "Window", async () => (await import("./window.js")).operatingWindow],
  ["scatter", "Scatter", async () => (await import("./scatter.js")).scatter],
  ["parallel", "Parallel coordinates", async () => (await import("./parallel.js")).parallel],
  ["effects", "Sensitivities", async () => (await import("./sensitivities.js")).effects],
  ["difference", "Difference", async () => (await import("./difference.js")).difference],
  ["table", "Table", async () => (await import("./table.js")).table],
  ["failures", "Failures", async () => (await import("./failures.js")).failures],
];

/** Place of the table among them: the view of a sweep that varies nothing. */
const TABLE = PARTS.findIndex(([name]) => name === "table");

/** The least time between two readings of a table that is still growing. */
const REDRAW_MS = 4000;
/** Interval of looks at the sweeps before one that has not begun. */
const PLACE_MS = 4000;
/** Sweeps that may run, at most, among which a place is found: the longest page of the service. */
const MOST_LISTED = 500;

/** @type {import("../ui/router.js").View} */
export async function show(main, route, signal) {
  const id = route.path[1];
  const sweep = await get(`/v1/sweeps/${encodeURIComponent(id)}`, {}, signal);
  const data = new SweepTable(sweep, signal);
  const biases = new Biases();
  const depths = new Depths();
  // Names do without depths until these have come.
  const deepened = depths.load(sweep, signal);
  await Promise.all([data.load(), biases.load(sweep, signal)]);
  const { axes, spans, paths } = sweptBy(sweep, data.names);
  const [view, text, making] =
    PARTS.find(([name]) => name === route.query.get("view")) ?? PARTS[axes.length ? 0 : TABLE];
  const make = await making();

  const query = new URLSearchParams(route.query);
  const taken = snippets(
    () =>
      part.lines?.() ??
      sweepLines([{ id, path: data.path, fields: data.served(part.fields()) }, ...(part.others?.() ?? [])]),
  );
  const drawn = () => taken.dispatchEvent(new Event("redraw"));
  /** @type {Context} */
  const context = {
    sweep,
    axes,
    spans,
    paths,
    biases,
    depths,
    table: data,
    query,
    keep: (changes) => {
      for (const [name, value] of Object.entries(changes)) {
        if (value === null) query.delete(name);
        else query.set(name, value);
      }
      keep(changes);
      drawn();
    },
    drawn,
    changed: (changed) => shown.update(changed),
    open: (ordinal, column = "") =>
      go(link(["sweeps", id, "points", String(ordinal)], { node: nodeOfColumn(column) })),
    signal,
  };
  const part = make(context);
  const shown = new ShownSweep(context, part, view);
  fill(
    main,
    h("nav", { class: "crumbs", "aria-label": "Breadcrumb" }, h("a", { href: "#/sweeps" }, "Sweeps"), " / "),
    shown.head,
    h("nav", { class: "tabs", "aria-label": "Views of the sweep" }, shown.tabs),
    h("section", { class: "panel", "aria-label": text }, part.element),
    taken,
  );
  await part.draw();
  attend(
    deepened.then(() => (depths.isMissed && !signal.aborted ? part.draw() : undefined)),
    signal,
  );
  shown.start();
  return `${sweep.name ?? `Sweep ${id.slice(-8)}`}, ${text}`;
}

/** A sweep on the page, which follows its changes: head, tabs, and the part that is drawn. */
class ShownSweep {
  #context;
  #part;
  #pace = new Pace();
  #drawnAt = Date.now();
  /** @type {ReturnType<typeof setTimeout> | undefined} */
  #waiting;
  #hasLearned = false;
  /** Sweeps before one that has not begun. */
  #before = 0;
  head = h("div", {});

  /** @param {Context} context @param {import("./part.js").Part} part @param {string} view that is shown */
  constructor(context, part, view) {
    this.#context = context;
    this.#part = part;
    const { sweep, signal } = context;
    this.tabs = PARTS.map(([name]) =>
      h("a", { href: link(["sweeps", sweep.id], { view: name }), "aria-current": name === view && "page" }),
    );
    this.#pace.note(sweep);
    signal.addEventListener("abort", () => clearTimeout(this.#waiting));
    this.#drawHead();
    this.#drawTabs();
  }

  /** Follows the sweep from now on. */
  start() {
    const { sweep, signal } = this.#context;
    attend(this.#learnPace(), signal);
    if (!isFinal(sweep)) this.#follow();
    const look = () => hasNotBegun(this.#context.sweep) && attend(this.#learnPlace(), signal);
    look();
    const timer = setInterval(look, PLACE_MS);
    signal.addEventListener("abort", () => clearInterval(timer));
  }

  /** Learns how many sweeps are before one that has not begun. */
  async #learnPlace() {
    const { sweep, signal } = this.#context;
    const { sweeps } = await get("/v1/sweeps", { state: "running", limit: MOST_LISTED }, signal);
    const before = sweepsBefore(sweep, sweeps);
    if (before === this.#before || signal.aborted) return;
    this.#before = before;
    this.#drawHead();
  }

  #follow() {
    const { sweep, signal } = this.#context;
    follow(sweep.id, { sweep: (changed) => this.update(changed) }, signal);
  }

  /** Takes the sweep as an answer or an event shows it. @param {any} changed */
  update(changed) {
    const { sweep: before, signal } = this.#context;
    const hasResults =
      changed.counts.succeeded !== before.counts.succeeded || changed.counts.failed !== before.counts.failed;
    // A member that is absent does not hold any more.
    const sweep = { ...before, waiting_for: undefined, ...changed };
    this.#context.sweep = sweep;
    this.#pace.note(sweep);
    this.#drawHead();
    this.#drawTabs();
    attend(this.#learnPace(), signal);
    if (!isFinal(before) && isFinal(sweep)) {
      // Below "completed" stand all results.
      clearTimeout(this.#waiting);
      void this.#redraw();
    } else if (hasResults && this.#waiting === undefined)
      this.#waiting = setTimeout(
        () => void this.#redraw(),
        Math.max(0, this.#drawnAt + REDRAW_MS - Date.now()),
      );
    if (isFinal(before) && !isFinal(sweep)) this.#follow();
  }

  async #redraw() {
    const { sweep, table, biases, depths, signal } = this.#context;
    this.#waiting = undefined;
    this.#drawnAt = Date.now();
    try {
      await Promise.all([table.load(), biases.load(sweep, signal), depths.load(sweep, signal)]);
      await this.#part.draw();
    } catch {
      // A later result, or the server's return, draws again.
    }
  }

  #drawHead() {
    fill(
      this.head,
      ...headPart(
        this.#context.sweep,
        { pace: this.#pace, before: this.#before },
        (verb) => this.#act(verb),
        (changes) => this.#change(changes),
      ),
    );
  }

  #drawTabs() {
    const { failed } = this.#context.sweep.counts;
    PARTS.forEach(
      ([name, text], index) =>
        (this.tabs[index].textContent = name === "failures" && failed ? `${text} (${failed})` : text),
    );
  }

  /** Learns the time of a point, once one is complete: the time left follows from it before the page has seen the pace of the sweep. */
  async #learnPace() {
    const { sweep, signal } = this.#context;
    if (isFinal(sweep) || !sweep.counts.succeeded || this.#hasLearned) return;
    this.#hasLearned = true;
    this.#pace.pointSeconds = await secondsOfPoint(sweep.id, signal);
    if (!signal.aborted) this.#drawHead();
  }

  /** @param {string} verb */
  async #act(verb) {
    const changed = await reported(
      send("POST", `/v1/sweeps/${encodeURIComponent(this.#context.sweep.id)}/${verb}`),
    );
    if (changed) this.update(changed);
  }

  /** @param {any} changes */
  async #change(changes) {
    const changed = await reported(
      send("PATCH", `/v1/sweeps/${encodeURIComponent(this.#context.sweep.id)}`, changes),
    );
    if (changed) this.update(changed);
    if (changed) notice("The sweep is changed.");
  }
}

/**
 * Warnings of verifying: the first, and the others on request.
 * @param {string[]} warnings each begins with the name of what it is of
 */
function warningsPart([first, ...others]) {
  const line = (/** @type {string} */ warning) =>
    h("p", { class: "wrong" }, warning.replace(/^(\w+)(?=: )/, label));
  return [
    first && line(first),
    others.length > 0 &&
      h(
        "details",
        {},
        h("summary", {}, `${others.length} further ${others.length === 1 ? "warning" : "warnings"}`),
        others.map(line),
      ),
  ];
}

/**
 * Computing time of a sweep's first complete point [s]; `null` if its result lacks it.
 * @param {string} id
 * @param {AbortSignal} signal
 */
async function secondsOfPoint(id, signal) {
  const path = `/v1/sweeps/${encodeURIComponent(id)}/points`;
  const { points } = await get(path, { state: "succeeded", limit: 1 }, signal);
  if (!points[0]) return null;
  const { provenance } = await get(`${path}/${points[0].ordinal}`, {}, signal);
  const seconds = (Date.parse(provenance?.ended) - Date.parse(provenance?.started)) / 1000;
  return Number.isFinite(seconds) ? seconds : null;
}

/**
 * @param {any} sweep
 * @param {{pace: Pace, before: number}} progress and the number of sweeps before one that has not begun
 * @param {(verb: string) => void} act
 * @param {(changes: any) => void} change
 */
function headPart(sweep, { pace, before }, act, change) {
  const button = (
    /** @type {string} */ verb,
    /** @type {string} */ text,
    /** @type {boolean} */ isShown,
    kind = "",
  ) =>
    isShown &&
    h(
      "button",
      { class: kind, disabled: !maySubmit(), title: !maySubmit() && MAY_NOT, onclick: () => act(verb) },
      text,
    );
  const canRetry = isFinal(sweep) && sweep.counts.failed + sweep.counts.cancelled > 0;
  const priority = choice(
    "Priority",
    Array.from({ length: 21 }, (_, index) => [String(10 - index), String(10 - index)]),
    String(sweep.priority),
    (value) => change({ priority: Number(value) }),
  );
  const { worst, warnings = [] } = sweep.verification ?? {};
  return [
    h(
      "div",
      { class: "head" },
      h(
        "div",
        {},
        h("h1", {}, sweep.name ?? `Sweep ${sweep.id.slice(-8)}`),
        h(
          "p",
          { class: "soft small" },
          `${sweep.request?.preset ?? sweep.request?.scenario?.name ?? "own scenario"}, of ${sweep.owner}, `,
          when(sweep.created),
          " ",
          (sweep.tags ?? []).map((/** @type {string} */ tag) =>
            h("a", { class: "tag", href: link(["sweeps"], { tag }) }, tag),
          ),
        ),
      ),
      h(
        "div",
        { class: "controls" },
        button("pause", "Pause", sweep.state === "running"),
        button("resume", "Resume", sweep.state === "paused"),
        !isFinal(sweep) &&
          h(
            "button",
            {
              class: "danger",
              disabled: !maySubmit(),
              title: !maySubmit() && MAY_NOT,
              onclick: () =>
                confirm(
                  "Cancel this sweep? Queued points are not started, running ones are stopped. Results so far stay.",
                ) && act("cancel"),
            },
            "Cancel",
          ),
        button("retry", "Retry failed and cancelled", canRetry),
        !isFinal(sweep) && maySubmit() && priority,
        h("a", { class: "button", href: link(["new"], { from: sweep.id }) }, "New sweep like this"),
        reportLink(sweep.links.self),
        h("a", { class: "button", href: sweep.links.export, download: "" }, "Download all"),
      ),
    ),
    h("div", { "aria-live": "off" }, progressPart(sweep, pace, before)),
    worst && h("p", { class: "small" }, sayWorst(worst)),
    warningsPart(warnings),
    sweep.waiting_for && h("p", { class: "wrong" }, `${sweep.waiting_for.reason}.`),
    h("div", { style: "height:.8rem" }),
  ];
}
