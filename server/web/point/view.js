// A point: what it is, and its profiles, motion, energy, well, and what it cost.

import { get, Problem } from "../data/api.js";
import { Biases } from "../data/biases.js";
import { waysToCompare } from "../ui/last-comparison.js";
import { fill, h } from "../ui/dom.js";
import { lines, requestLines } from "../ui/snippets.js";
import { keep, link } from "../ui/router.js";
import { isUnsettled } from "../data/statistics.js";
import { say, sayParameters } from "../data/units.js";
import { askedOf } from "./part.js";

/** @typedef {import("./part.js").PointContext} PointContext */

/**
 * The views: name in the link, what it is called, and what makes it.
 * @type {[string, string, () => Promise<(context: PointContext) => import("./part.js").PointPart>][]}
 */
const PARTS = [
  ["profiles", "Profiles", async () => (await import("./profiles.js")).profiles],
  ["motion", "Orbit, history, spectrum", async () => (await import("./motion.js")).motion],
  ["spectrogram", "Spectrogram", async () => (await import("./spectrogram.js")).spectrogram],
  ["string", "String in motion", async () => (await import("./string.js")).string],
  ["well", "Well", async () => (await import("./well.js")).well],
  ["energy", "Energy", async () => (await import("./energy.js")).energy],
  ["about", "Effects, accuracy, downloads", async () => (await import("./about.js")).about],
];

/** How often a point that is not final yet is looked at. */
const POLL_MS = 3000;

/** @type {import("../ui/router.js").View} */
export async function show(main, route, signal) {
  const [, id, , ordinal] = route.path;
  const path = `/v1/sweeps/${encodeURIComponent(id)}/points/${encodeURIComponent(ordinal)}`;
  const asked = route.query.get("view");
  const [view, name, making] = PARTS.find(([entry]) => entry === asked) ?? PARTS[0];
  const [point, sweep, make] = await Promise.all([
    get(path, {}, signal),
    get(`/v1/sweeps/${encodeURIComponent(id)}`, {}, signal),
    making(),
  ]);
  const biases = new Biases();
  await biases.load(sweep, signal);
  const here = ["sweeps", id, "points", ordinal];
  const heading = h("div", {});
  const neighbour = (/** @type {number} */ step, /** @type {string} */ text) => {
    const to = Number(ordinal) + step;
    return (
      to >= 1 &&
      to <= sweep.counts.total &&
      h(
        "a",
        {
          class: "button",
          href: link(["sweeps", id, "points", String(to)], Object.fromEntries(route.query)),
        },
        text,
      )
    );
  };
  const drawHeading = (/** @type {any} */ current) =>
    fill(
      heading,
      h(
        "nav",
        { class: "crumbs", "aria-label": "Breadcrumb" },
        h("a", { href: "#/sweeps" }, "Sweeps"),
        " / ",
        h("a", { href: link(["sweeps", id]) }, sweep.name ?? `Sweep ${id.slice(-8)}`),
        " / ",
      ),
      h(
        "div",
        { class: "head" },
        h(
          "div",
          {},
          h("h1", {}, `Point ${ordinal}`),
          h("p", {}, sayParameters(current.parameters)),
          h(
            "p",
            {},
            h("span", { class: `state ${current.state}` }, current.state),
            current.state === "running" ? ` ${Math.floor(100 * current.progress)} %` : "",
            isUnsettled(current.summary?.motion_regime, current.summary?.growing_mode_hz) &&
              h("span", { class: "wrong" }, " not settled: its statistics may be those of the start"),
          ),
        ),
        h(
          "div",
          { class: "controls" },
          neighbour(-1, "← Previous"),
          neighbour(1, "Next →"),
          waysToCompare(`${id}:${ordinal}`).map(({ text, href }) => h("a", { class: "button", href }, text)),
        ),
      ),
      current.error &&
        h(
          "div",
          { class: "panel", role: "alert" },
          h("h2", { class: "wrong" }, `Failed: ${current.error.class}`),
          h("p", {}, current.error.reason),
          h(
            "p",
            { class: "soft" },
            [
              typeof current.error.time === "number" && `at ${say("time", current.error.time)}`,
              current.error.node && `node ${current.error.node}`,
            ]
              .filter(Boolean)
              .join(", "),
          ),
        ),
    );
  drawHeading(point);

  if (!point.summary) {
    const isWaiting = point.state === "queued" || point.state === "running";
    fill(
      main,
      heading,
      h(
        "p",
        { class: "empty", role: "status" },
        isWaiting ? "Results appear here when the point is complete." : "This point has no result.",
      ),
    );
    const timer = setInterval(async () => {
      const current = await get(path, {}, signal).catch(() => null);
      if (!current) return;
      drawHeading(current);
      if (current.state !== "queued" && current.state !== "running") {
        clearInterval(timer);
        dispatchEvent(new HashChangeEvent("hashchange"));
      }
    }, POLL_MS);
    if (!isWaiting) clearInterval(timer);
    signal.addEventListener("abort", () => clearInterval(timer));
    return `Point ${ordinal}`;
  }

  const query = new URLSearchParams(route.query);
  const taken = lines(() => {
    const request = part.request();
    if (!request) return {};
    const start = `from drillsweep import Client, plot\n\npoint = Client("${location.origin}").sweep("${id}").point(${ordinal})\n`;
    return requestLines(askedOf(path, request), start + request.python);
  });
  /** @type {PointContext} */
  const context = {
    point,
    path,
    query,
    keep: (changes) => {
      for (const [key, value] of Object.entries(changes)) {
        if (value === null) query.delete(key);
        else query.set(key, value);
      }
      keep(changes);
      taken.dispatchEvent(new Event("redraw"));
    },
    bias: (name) => biases.beside(name, Number(ordinal)),
    table: (table, asks = {}) => get(`${path}/${table}`, { format: "json", ...asks }, signal),
    drawn: () => taken.dispatchEvent(new Event("redraw")),
    signal,
  };
  const part = make(context);
  fill(
    main,
    heading,
    h(
      "nav",
      { class: "tabs", "aria-label": "Views of the point" },
      PARTS.map(([entry, text]) =>
        h("a", { href: link(here, { view: entry }), "aria-current": entry === view && "page" }, text),
      ),
    ),
    h(
      "section",
      {
        class: view === "profiles" || view === "well" || view === "energy" ? "panel" : "",
        "aria-label": name,
      },
      part.element,
    ),
    taken,
  );
  // Pictures wait for their place in the page, which the view takes when it is complete.
  part.draw().catch((error) => {
    if (signal.aborted) return;
    if (!(error instanceof Problem)) console.error(error);
    fill(
      part.element,
      h("p", { class: "empty", role: "alert" }, error instanceof Error ? error.message : String(error)),
    );
  });
  return `Point ${ordinal}`;
}
