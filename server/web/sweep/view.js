// A sweep: its state with what can be done to it, and its points as maps, clouds, sensitivities, a table and failures.

import { follow, get, isFinal, send } from "../data/api.js";
import { Biases } from "../data/biases.js";
import { Depths } from "../data/depths.js";
import { choice, fill, h } from "../ui/dom.js";
import { lines } from "../ui/snippets.js";
import { attend, reported, notice } from "../ui/notices.js";
import { Pace } from "../data/pace.js";
import { go, keep, link } from "../ui/router.js";
import { MAY_NOT, maySubmit } from "../ui/session.js";
import { progressPart, when } from "../ui/progress.js";
import { sweepLines } from "./snippets.js";
import { SweepTable, sweptBy } from "../data/sweep-table.js";
import { label, say } from "../data/units.js";

/** @typedef {import("./part.js").Context} Context */

/**
 * The views: name in the link, what it is called, and what makes it.
 * @type {[string, string, () => Promise<(context: Context) => import("./part.js").Part>][]}
 */
const PARTS = [
  ["map", "Map", async () => (await import("./map.js")).map],
  ["scatter", "Scatter", async () => (await import("./scatter.js")).scatter],
  ["parallel", "Parallel coordinates", async () => (await import("./parallel.js")).parallel],
  ["effects", "Sensitivities", async () => (await import("./sensitivities.js")).effects],
  ["difference", "Difference", async () => (await import("./difference.js")).difference],
  ["table", "Table", async () => (await import("./table.js")).table],
  ["failures", "Failures", async () => (await import("./failures.js")).failures],
];

/** Where the table stands among them: what is shown of a sweep that varies nothing. */
const TABLE = PARTS.findIndex(([name]) => name === "table");

/** The least time between two readings of a table that is still growing. */
const REDRAW_MS = 4000;

/** @type {import("../ui/router.js").View} */
export async function show(main, route, signal) {
  const id = route.path[1];
  const asked = PARTS.find(([name]) => name === route.query.get("view"));
  let sweep = await get(`/v1/sweeps/${encodeURIComponent(id)}`, {}, signal);
  const data = new SweepTable(sweep, signal);
  const biases = new Biases();
  const depths = new Depths();
  // Names do without depths until these have come.
  const deepened = depths.load(sweep, signal);
  await Promise.all([data.load(), biases.load(sweep, signal)]);
  const { axes, spans, paths } = sweptBy(sweep, data.names);
  const [view, , making] = asked ?? PARTS[axes.length ? 0 : TABLE];
  const make = await making();

  const query = new URLSearchParams(route.query);
  const taken = lines(() => {
    const own = { id, path: data.path, fields: part.fields() };
    const others = part.others?.() ?? [];
    return sweepLines([own, ...others]);
  });
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
      taken.dispatchEvent(new Event("redraw"));
    },
    drawn: () => taken.dispatchEvent(new Event("redraw")),
    changed: (changed) => update(changed),
    open: (ordinal) => go(link(["sweeps", id, "points", String(ordinal)])),
    signal,
  };
  const part = make(context);

  const tabs = PARTS.map(([name]) =>
    h("a", { href: link(["sweeps", id], { view: name }), "aria-current": name === view && "page" }),
  );
  const drawTabs = () =>
    PARTS.forEach(
      ([name, text], index) =>
        (tabs[index].textContent =
          name === "failures" && sweep.counts.failed ? `${text} (${sweep.counts.failed})` : text),
    );
  const head = h("div", {});
  const pace = new Pace();
  pace.note(sweep);
  const drawHead = () => fill(head, ...headPart(sweep, pace, act, change));
  /** Learns what a point takes, once one is complete, for the time left before the page has seen how fast the sweep goes. */
  async function learnPace() {
    if (isFinal(sweep) || !sweep.counts.succeeded || hasAsked) return;
    hasAsked = true;
    pace.pointSeconds = await secondsOfPoint(id, signal);
    if (!signal.aborted) drawHead();
  }
  let hasAsked = false;

  /** @param {string} verb */
  async function act(verb) {
    const changed = await reported(send("POST", `/v1/sweeps/${encodeURIComponent(id)}/${verb}`));
    if (changed) update(changed);
  }

  /** @param {any} changes */
  async function change(changes) {
    const changed = await reported(send("PATCH", `/v1/sweeps/${encodeURIComponent(id)}`, changes));
    if (changed) update(changed);
    if (changed) notice("The sweep is changed.");
  }

  let drawnAt = Date.now();
  /** @type {ReturnType<typeof setTimeout> | undefined} */
  let waiting;

  /** @param {any} changed */
  function update(changed) {
    const hasResults =
      changed.counts.succeeded !== sweep.counts.succeeded || changed.counts.failed !== sweep.counts.failed;
    const wasFinal = isFinal(sweep);
    // What is absent is not so any more.
    sweep = { ...sweep, waiting_for: undefined, ...changed };
    context.sweep = sweep;
    pace.note(sweep);
    drawHead();
    drawTabs();
    attend(learnPace(), signal);
    if (hasResults && waiting === undefined)
      waiting = setTimeout(redraw, Math.max(0, drawnAt + REDRAW_MS - Date.now()));
    if (wasFinal && !isFinal(sweep)) follow(id, { sweep: update }, signal);
  }

  async function redraw() {
    waiting = undefined;
    drawnAt = Date.now();
    try {
      await Promise.all([data.load(), biases.load(sweep, signal), depths.load(sweep, signal)]);
      await part.draw();
    } catch {
      // A later result, or the server's return, draws again.
    }
  }
  signal.addEventListener("abort", () => clearTimeout(waiting));

  drawHead();
  drawTabs();
  fill(
    main,
    h("nav", { class: "crumbs", "aria-label": "Breadcrumb" }, h("a", { href: "#/sweeps" }, "Sweeps"), " / "),
    head,
    h("nav", { class: "tabs", "aria-label": "Views of the sweep" }, tabs),
    h(
      "section",
      { class: "panel", "aria-label": PARTS.find(([name]) => name === view)?.[1] ?? "" },
      part.element,
    ),
    taken,
  );
  await part.draw();
  attend(
    deepened.then(() => (depths.isMissed && !signal.aborted ? part.draw() : undefined)),
    signal,
  );
  attend(learnPace(), signal);
  if (!isFinal(sweep)) follow(id, { sweep: update }, signal);
  return sweep.name ?? `Sweep ${id.slice(-8)}`;
}

/**
 * What verifying warns of: the first of it, and the rest where it is asked for.
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
 * How long the first of a sweep's complete points was computed [s]; null where its result does not say.
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
 * @param {Pace} pace
 * @param {(verb: string) => void} act
 * @param {(changes: any) => void} change
 */
function headPart(sweep, pace, act, change) {
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
        h("a", { class: "button", href: sweep.links.export, download: "" }, "Download all"),
      ),
    ),
    h("div", { "aria-live": "off" }, progressPart(sweep, pace)),
    worst &&
      h(
        "p",
        { class: "small" },
        `Verified against reference runs: worst bias of orbit size ${say("bias_x", 100 * worst.bias, 2)} % at point ${worst.ordinal}`,
        worst.promised ? ` (promised: ${say("bias_x", 100 * worst.promised, 2)} %).` : ".",
      ),
    warningsPart(warnings),
    sweep.waiting_for && h("p", { class: "wrong" }, `${sweep.waiting_for.reason}.`),
    h("div", { style: "height:.8rem" }),
  ];
}
