// A point: what it is, and its profiles, motion, well, energy, hydraulics, torque and drag, forced response, and what it cost.

import { get, Problem } from "../data/api.js";
import { Biases } from "../data/biases.js";
import { latest } from "../data/latest.js";
import { isUnsettled } from "../data/statistics.js";
import { say, sayParameters } from "../data/units.js";
import { Overview } from "../draw/overview.js";
import { TimeCursor } from "../draw/time-cursor.js";
import { fill, h } from "../ui/dom.js";
import { waysToCompare } from "../ui/last-comparison.js";
import { attend } from "../ui/notices.js";
import { reportLink } from "../ui/report-link.js";
import { keep, link } from "../ui/router.js";
import { requestLines, snippets } from "../ui/snippets.js";
import { headline } from "./headline.js";
import { askedOf, carried } from "./part.js";

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
  ["hydraulics", "Hydraulics", async () => (await import("./hydraulics.js")).hydraulics],
  ["drag", "Torque and drag", async () => (await import("./drag.js")).drag],
  ["forced", "Forced response", async () => (await import("./forced.js")).forced],
  ["about", "Effects, accuracy, downloads", async () => (await import("./about.js")).about],
];

/** Interval of looks at a point that is not final yet. */
const POLL_MS = 3000;

/** Views whose element is not made of panels. */
const IN_PANEL = ["profiles", "well", "energy", "hydraulics", "drag", "forced"];

/** Sweep, number and path of a point. @typedef {{sweep: any, ordinal: string, path: string, query: URLSearchParams}} Place */

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
  const place = { sweep, ordinal, path, query: route.query };
  const title = `Point ${ordinal} of ${sweep.name ?? `Sweep ${id.slice(-8)}`}`;
  const heading = h("div", {});
  if (!point.summary) {
    fill(heading, headingPart(place, point));
    showWaiting(main, heading, place, point, signal);
    return title;
  }

  const taken = snippets(() => {
    const request = part.request();
    if (!request) return {};
    const start = `from drillsweep import Client, plot\n\npoint = Client("${location.origin}").sweep("${id}").point(${ordinal})\n`;
    return requestLines(askedOf(path, request), start + request.python);
  });
  const drawn = () => taken.dispatchEvent(new Event("redraw"));
  const offered = PARTS.filter(([entry]) => entry !== "hydraulics" || point.scenario.mud);
  const tabs = offered.map(([entry, text]) =>
    h("a", { "data-view": entry, "aria-current": entry === view && "page" }, text),
  );
  const follow = (/** @type {URLSearchParams} */ query) => {
    for (const tab of tabs)
      tab.setAttribute(
        "href",
        link(["sweeps", id, "points", ordinal], { view: tab.dataset.view, ...carried(query) }),
      );
    fill(heading, headingPart({ ...place, query }, point));
    overview.follow(carried(query));
  };
  const context = contextOf(place, point, biases, { drawn, follow }, signal);
  const judgement = headline(point, biases.orbitSize(Number(ordinal)), context.diagnosis(), signal);
  const overview = new Overview(context, ["sweeps", id, "points", ordinal]);
  follow(route.query);
  const part = make(context);
  fill(
    main,
    heading,
    judgement,
    overview.element,
    h("nav", { class: "tabs", "aria-label": "Views of the point" }, tabs),
    h("section", { class: IN_PANEL.includes(view) ? "panel" : "", "aria-label": name }, part.element),
    taken,
  );
  attend(overview.draw(), signal);
  // Pictures wait for their place in the page, which the view takes when it is complete.
  part.draw().catch((error) => {
    if (signal.aborted) return;
    if (!(error instanceof Problem)) console.error(error);
    fill(
      part.element,
      h("p", { class: "empty", role: "alert" }, error instanceof Error ? error.message : String(error)),
    );
  });
  return `${title}, ${name}`;
}

/**
 * @param {Place} place
 * @param {any} point
 * @param {Biases} biases
 * @param {{drawn: () => void, follow: (query: URLSearchParams) => void}} page called for other requests, and for other choices in the link
 * @param {AbortSignal} signal
 * @returns {PointContext}
 */
function contextOf({ ordinal, path, query: asked }, point, biases, { drawn, follow }, signal) {
  const query = new URLSearchParams(asked);
  /** @type {Promise<any> | undefined} */
  let diagnosis;
  const keepChoices = (/** @type {Record<string, string | null>} */ changes) => {
    for (const [key, value] of Object.entries(changes)) {
      if (value === null) query.delete(key);
      else query.set(key, value);
    }
    keep(changes);
    follow(query);
    drawn();
  };
  return {
    point,
    path,
    query,
    keep: keepChoices,
    time: new TimeCursor({ query, keep: keepChoices }, signal),
    bias: (name) => biases.beside(name, Number(ordinal)),
    measured: (number) => biases.orbitSize(number),
    verified: biases.verified,
    diagnosis: () => (diagnosis ??= get(`${path}/diagnosis`, {}, signal)),
    // The overview shows tables of the views.
    table: latest((table, asks) => get(`${path}/${table}`, { format: "json", ...asks }, signal)),
    drawn,
    signal,
  };
}

/** Shows a point without a result, and loads the view again once the point is final. @param {HTMLElement} main @param {HTMLElement} heading @param {Place} place @param {any} point @param {AbortSignal} signal */
function showWaiting(main, heading, place, point, signal) {
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
  if (!isWaiting) return;
  const timer = setInterval(async () => {
    const current = await get(place.path, {}, signal).catch(() => null);
    if (!current) return;
    fill(heading, headingPart(place, current));
    if (current.state !== "queued" && current.state !== "running") {
      clearInterval(timer);
      dispatchEvent(new HashChangeEvent("hashchange"));
    }
  }, POLL_MS);
  signal.addEventListener("abort", () => clearInterval(timer));
}

/** @param {Place} place @param {any} point as it is now */
function headingPart({ sweep, ordinal, query }, point) {
  const neighbour = (/** @type {number} */ step, /** @type {string} */ text) => {
    const to = Number(ordinal) + step;
    return (
      to >= 1 &&
      to <= sweep.counts.total &&
      h(
        "a",
        {
          class: "button",
          href: link(["sweeps", sweep.id, "points", String(to)], Object.fromEntries(query)),
        },
        text,
      )
    );
  };
  const compare = waysToCompare(`${sweep.id}:${ordinal}`, carried(query)).map(({ text, href }) =>
    h("a", { class: "button", href }, text),
  );
  return [
    h(
      "nav",
      { class: "crumbs", "aria-label": "Breadcrumb" },
      h("a", { href: "#/sweeps" }, "Sweeps"),
      " / ",
      h("a", { href: link(["sweeps", sweep.id]) }, sweep.name ?? `Sweep ${sweep.id.slice(-8)}`),
      " / ",
    ),
    h(
      "div",
      { class: "head" },
      h(
        "div",
        {},
        h("h1", {}, `Point ${ordinal}`),
        h("p", {}, sayParameters(point.parameters)),
        statePart(point),
      ),
      h(
        "div",
        { class: "controls" },
        neighbour(-1, "← Previous"),
        neighbour(1, "Next →"),
        compare,
        reportLink(point.links.self),
      ),
    ),
    point.error && errorPart(point.error, point.error_place),
  ];
}

/** @param {any} point */
function statePart({ state, progress, summary }) {
  const isUncertain = isUnsettled(summary?.motion_regime, summary?.growing_mode_hz);
  return h(
    "p",
    {},
    h("span", { class: `state ${state}` }, state),
    state === "running" ? ` ${Math.floor(100 * progress)} %` : "",
    isUncertain && h("span", { class: "wrong" }, " not settled: its statistics may be those of the start"),
  );
}

/**
 * @param {any} error of a point
 * @param {{measured_depth: number, component: string} | undefined} at place of its node
 */
function errorPart(error, at) {
  const place = [
    typeof error.time === "number" && `at ${say("time", error.time)}`,
    at?.component,
    at && say("measured_depth", at.measured_depth),
    error.node && `node ${error.node}`,
  ];
  return h(
    "div",
    { class: "panel", role: "alert" },
    h("h2", { class: "wrong" }, `Failed: ${error.class}`),
    h("p", {}, error.reason),
    h("p", { class: "soft" }, place.filter(Boolean).join(", ")),
  );
}
