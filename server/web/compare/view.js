// The view of a comparison: up to six points in the pictures and tables that a point has.

import { get } from "../data/api.js";
import { say, sayParameters } from "../data/units.js";
import { dragWindow } from "../draw/brush.js";
import { DepthCursor } from "../draw/depth-cursor.js";
import { canvas } from "../draw/plots.js";
import { TimeCursor } from "../draw/time-cursor.js";
import { TimeLine } from "../draw/time-line.js";
import { quantityTicks, scrolled } from "../point/profiles.js";
import { fill, h } from "../ui/dom.js";
import { comparedIn, rememberComparison } from "../ui/last-comparison.js";
import { attend } from "../ui/notices.js";
import { go, keep, link, route as currentRoute } from "../ui/router.js";
import { snippets } from "../ui/snippets.js";
import { AddingForm, OFFERED } from "./adding.js";
import { Choices } from "./choices.js";
import { controlsPart } from "./controls.js";
import { pointOf, recordedDepths, toldApart } from "./points.js";
import { comparisonLines } from "./snippets.js";
import { VIEWS } from "./views.js";

/** Part of the shortest run below which a window that is dragged was a click. */
const LEAST = 1e-3;
/** Profiles that are shown unless the link names others. */
const PROFILES = "friction_coefficient,eccentricity,effective_tension,largest_normal_force";

/** @typedef {import("./comparison.js").Compared} Compared */
/** @typedef {import("./comparison.js").Comparison} Comparison */

/** @type {import("../ui/router.js").View} */
export async function show(main, route, signal) {
  const { query } = route;
  const keys = comparedIn(query);
  rememberComparison(query);
  const view = Object.keys(VIEWS).find((name) => name === query.get("view")) ?? "profiles";
  const [listed, ...asked] = await Promise.all([
    get("/v1/sweeps", { limit: OFFERED }, signal),
    ...keys.map((key, order) => pointOf(key, order, signal)),
  ]);
  const unknown = asked.flatMap(({ problem }) => (problem ? [problem] : []));
  const to = (/** @type {string[]} */ chosen, shownView = view) =>
    link(["compare"], {
      ...Object.fromEntries(currentRoute().query),
      points: chosen.join(","),
      view: shownView,
    });
  const nameOf = (/** @type {string} */ id) =>
    listed.sweeps.find((/** @type {any} */ sweep) => sweep.id === id)?.name ?? `Sweep ${id.slice(-8)}`;
  const points = toldApart(
    asked.flatMap(({ point }) => (point ? [point] : [])),
    nameOf,
  );
  const takeOut = (/** @type {string} */ key, /** @type {string} */ which) =>
    h(
      "button",
      {
        class: "plain",
        "aria-label": `Take ${which} out`,
        onclick: () => go(to(keys.filter((other) => other !== key))),
      },
      "Take out",
    );
  const adding = new AddingForm(
    points,
    listed,
    { count: keys.length, nameOf, add: (key) => go(to([...keys, key])) },
    signal,
  );
  const depths = VIEWS[view].isOfNode
    ? await recordedDepths(points, signal)
    : { depths: [], byNode: new Map() };
  const shown = new ShownComparison(
    new Choices(view, query, points, depths),
    (name) => to(keys, name),
    signal,
  );
  fill(
    main,
    h("div", { class: "head" }, h("h1", {}, "Compare points")),
    h(
      "div",
      { class: "panel" },
      points.length
        ? h("div", { class: "scroll" }, pointsTable(points, nameOf, takeOut))
        : h("p", { class: "soft" }, "Add up to six points, of one sweep or of several. The link holds them."),
      unknown.map(({ key, text }) => h("p", { class: "wrong" }, `${text} `, takeOut(key, "it"))),
      adding.element,
    ),
    points.length > 0 && shown.parts,
  );
  if (points.length) shown.draw();
  return `Compare points, ${VIEWS[view].name}`;
}

/** @param {Compared[]} points @param {(id: string) => string} nameOf a sweep @param {(key: string, which: string) => HTMLElement} takeOut */
function pointsTable(points, nameOf, takeOut) {
  const rows = points.map((point) => {
    const mark = h("span", { style: `color:${point.colour};font-weight:700`, "aria-hidden": "true" }, "━━ ");
    const anchor = h(
      "a",
      { href: link(["sweeps", point.id, "points", String(point.ordinal)]) },
      `${nameOf(point.id)}, point ${point.ordinal}`,
    );
    return h(
      "tr",
      {},
      h("td", {}, mark, String(point.number)),
      h("td", {}, anchor),
      h("td", {}, sayParameters(point.detail.parameters)),
      h("td", {}, takeOut(`${point.id}:${point.ordinal}`, `point ${point.number}`)),
    );
  });
  return h("table", { "aria-label": "Points compared" }, h("tbody", {}, rows));
}

/** @param {string} view @returns {HTMLElement} place of the view's picture, pictures or table */
function placeOf(view) {
  const { kind, name } = VIEWS[view];
  if (kind === "several") return h("div", {});
  if (kind === "table")
    return h("div", { class: "scroll", tabindex: "0", role: "region", "aria-label": `${name}, scrollable` });
  return canvas(name, view, "tall");
}

/** A view of a comparison on the page: tabs, controls, the picture and its snippets. */
class ShownComparison {
  #choices;
  #linkTo;
  #signal;
  #place;
  #ticks;
  #cursor;
  #time;
  /** @type {TimeLine | null} */
  #timeLine = null;
  #controls = h("div", { class: "controls" });
  #lacking = h("div", { class: "lacking", role: "status", "aria-label": "What is missing" });
  #caption = h("figcaption", {});
  #tabs = Object.entries(VIEWS).map(([name, entry]) => h("a", { "data-view": name }, entry.name));
  #loading = h("p", { class: "soft", role: "status" }, "Loading…");
  #taken = snippets(() => comparisonLines(this.#choices, this.#ticks.names(), this.#sources));
  /** Ends when the view is drawn anew. */
  #latest = new AbortController();
  #isDraggable = false;
  /** Tables that points are drawn from, by their numbers, if the view has a choice. @type {Map<number, string>} */
  #sources = new Map();
  /** Values of the points' profiles at a depth. @type {NonNullable<Comparison["profiled"]>["read"]} */
  #readAt = () => [];

  /** @param {Choices} choices @param {(view: string) => string} linkTo another view @param {AbortSignal} signal */
  constructor(choices, linkTo, signal) {
    this.#choices = choices;
    this.#linkTo = linkTo;
    this.#signal = signal;
    const { view, query } = choices;
    this.#tabs.find((tab) => tab.dataset.view === view)?.setAttribute("aria-current", "page");
    this.#place = placeOf(view);
    this.#ticks = quantityTicks(query.get("profiles") ?? PROFILES, (names) =>
      this.#change({ profiles: names.join(",") }),
    );
    this.#cursor = new DepthCursor(
      this.#place,
      { query, keep: (changes) => this.#keep(changes) },
      (depth, points) => this.#readAt(depth, points),
    );
    this.#time = new TimeCursor({ query, keep: (changes) => this.#keep(changes) }, signal);
    if (VIEWS[view].hasTime) this.#timeLine = new TimeLine(this.#place, this.#time, signal);
  }

  get parts() {
    const isProfiles = this.#choices.view === "profiles";
    const figure = h(
      "figure",
      {},
      isProfiles ? scrolled(this.#place) : this.#place,
      this.#caption,
      this.#timeLine?.reading,
    );
    return [
      h("div", { style: "height:1rem" }),
      h("nav", { class: "tabs", "aria-label": "What is compared" }, this.#tabs),
      h(
        "section",
        { class: "panel", "aria-label": "Picture" },
        this.#controls,
        this.#lacking,
        figure,
        isProfiles && this.#cursor.element,
      ),
      this.#taken,
    ];
  }

  /** Draws all parts. */
  draw() {
    this.#linkTabs();
    this.#drawControls();
    attend(this.#redraw(), this.#signal);
  }

  /** Keeps choices in the link; an empty one is removed. @param {Record<string, string | null>} changes */
  #keep(changes) {
    const { query } = this.#choices;
    for (const [name, value] of Object.entries(changes)) {
      if (value) query.set(name, value);
      else query.delete(name);
    }
    keep(changes);
    rememberComparison(currentRoute().query);
    this.#linkTabs();
    this.#taken.dispatchEvent(new Event("redraw"));
  }

  /** Keeps choices in the link and draws by them. @param {Record<string, string>} changes */
  #change(changes) {
    this.#keep(changes);
    this.#drawControls();
    attend(this.#redraw(), this.#signal);
  }

  /** Links the tabs to the other views with the present choices. */
  #linkTabs() {
    for (const tab of this.#tabs) tab.setAttribute("href", this.#linkTo(tab.dataset.view ?? ""));
  }

  #drawControls() {
    fill(
      this.#controls,
      controlsPart(this.#choices, this.#ticks.element, (changes) => this.#change(changes)),
    );
  }

  /** @param {AbortSignal} drawing @returns {Comparison} */
  #comparison(drawing) {
    const { points, query, node, window } = this.#choices;
    return {
      points,
      query,
      profiles: this.#ticks.names(),
      node,
      window,
      keep: (changes) => this.#keep(changes),
      time: this.#time,
      table: (point, name, asks = {}) => get(`${point.path}/${name}`, { format: "json", ...asks }, drawing),
      lacking: [],
      sources: new Map(),
      says: [],
      nodes: new Map(),
      signal: this.#signal,
      drawing,
    };
  }

  async #redraw() {
    this.#latest.abort();
    this.#latest = new AbortController();
    const drawing = AbortSignal.any([this.#signal, this.#latest.signal]);
    const comparison = this.#comparison(drawing);
    const { isRecorded, view } = this.#choices;
    const { kind, hasTime } = VIEWS[view];
    if (!isRecorded) comparison.lacking.push("No point here has a recorded node.");
    this.#place.hidden = !isRecorded;
    // The service computes modes and effects for seconds.
    if (kind && isRecorded && !this.#place.hasChildNodes()) fill(this.#place, this.#loading);
    try {
      if (isRecorded) await VIEWS[view].draw(this.#place, comparison);
      if (!drawing.aborted && comparison.profiled) {
        this.#readAt = comparison.profiled.read;
        this.#cursor.follow(comparison.profiled.depths);
      }
    } catch (error) {
      if (!drawing.aborted) throw error;
    } finally {
      if (!drawing.aborted) this.#loading.remove();
    }
    if (drawing.aborted) return;
    this.#sources = comparison.sources;
    this.#taken.dispatchEvent(new Event("redraw"));
    if (hasTime && isRecorded) this.#letDrag();
    this.#describe(comparison);
  }

  /** Lets a window be dragged across the picture, once it is drawn. */
  #letDrag() {
    if (this.#isDraggable) return;
    this.#isDraggable = true;
    const ended = (/** @type {[number, number] | null} */ range) => {
      if (range && range[1] - range[0] > LEAST * this.#choices.shortest)
        this.#change({ from: range[0].toFixed(4), to: range[1].toFixed(4) });
    };
    dragWindow(this.#place, () => {}, ended, this.#signal);
  }

  /** Writes the caption, and the data that points lack. @param {Comparison} comparison */
  #describe({ lacking, says, nodes }) {
    const { view, depth, isWindowed, windowNote } = this.#choices;
    fill(
      this.#lacking,
      lacking.map((sentence) => h("p", {}, sentence)),
    );
    const shownNodes = [...nodes.entries()].sort(([a], [b]) => a - b).map(([, text]) => text);
    fill(
      this.#caption,
      view === "orbit" && "Looking downhole, the low side down. ",
      isWindowed && windowNote && `${windowNote} `,
      says.map((sentence) => `${sentence} `),
      shownNodes.length > 0 &&
        `The recorded node of each point that is nearest to ${say("measured_depth", depth)}: ${shownNodes.join("; ")}.`,
      VIEWS[view].hasTime &&
        " Drag across the picture to choose a window; the other views follow. Select a place for the time at which all are read.",
    );
  }
}
