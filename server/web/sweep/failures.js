// Failed points of a sweep, by cause.

import { get } from "../data/api.js";
import { say, sayParameters } from "../data/units.js";
import { fill, h } from "../ui/dom.js";
import { link } from "../ui/router.js";

const PAGE = 500;

/** Meaning of each class of failure, for readers. @type {Record<string, string>} */
const MEANING = {
  physical: "the scenario has no solution, or the run left what can be simulated",
  infrastructure: "storage or database failed; a retry may help",
  crash: "the worker ended; a retry may help",
  timeout: "the point took longer than it may",
  cancelled: "stopped by somebody",
  outdated: "submitted under another version of the physics; submit it again",
};

/**
 * @param {import("./part.js").Context} context
 * @returns {import("./part.js").Part}
 */
export function failures(context) {
  const { sweep, signal } = context;
  const element = h("div", {});

  async function redraw() {
    const page = await get(
      `/v1/sweeps/${encodeURIComponent(sweep.id)}/points`,
      { state: "failed", limit: PAGE },
      signal,
    );
    if (!page.points.length) {
      fill(element, h("p", { class: "empty" }, "No point of this sweep has failed."));
      return;
    }
    const sections = byCause(page.points).map((points) => causePart(sweep.id, points));
    fill(
      element,
      sections,
      page.next ? h("p", { class: "soft" }, `The first ${PAGE} failures are shown.`) : null,
    );
  }
  return {
    element,
    draw: redraw,
    fields: () => ["ordinal", "state", ...context.axes, "error", "error_time", "error_node"],
  };
}

/**
 * Failed points grouped by class and reason, in which numbers do not count; the largest group first.
 * @param {any[]} points
 * @returns {any[][]}
 */
function byCause(points) {
  /** @type {Map<string, any[]>} */
  const causes = new Map();
  for (const point of points) {
    const key = `${point.error?.class ?? "unknown"}\n${(point.error?.reason ?? "no reason is known").replace(/-?\d+(\.\d+)?([eE][+-]?\d+)?/g, "…")}`;
    causes.set(key, [...(causes.get(key) ?? []), point]);
  }
  return [...causes.values()].sort((a, b) => b.length - a.length);
}

/** @param {string} id of the sweep @param {any[]} points that failed by one cause */
function causePart(id, points) {
  const { error } = points[0];
  const heads = [
    h("th", {}, "Point"),
    h("th", {}, "Parameters"),
    h("th", {}, "At"),
    h("th", { class: "number" }, "Attempts"),
  ];
  return h(
    "section",
    {},
    h(
      "h2",
      {},
      h("span", { class: "state failed" }, error?.class ?? "unknown"),
      ` ${points.length} ${points.length === 1 ? "point" : "points"}`,
    ),
    h("p", { class: "soft small" }, MEANING[error?.class] ?? ""),
    h("p", {}, error?.reason ?? "No reason is known."),
    h(
      "div",
      { class: "scroll" },
      h(
        "table",
        {},
        h("thead", {}, h("tr", {}, heads)),
        h(
          "tbody",
          {},
          points.map((point) => pointRow(id, point)),
        ),
      ),
    ),
  );
}

/** @param {string} id of the sweep @param {any} point */
function pointRow(id, point) {
  const place = [
    typeof point.error?.time === "number" && say("time", point.error.time),
    point.error?.node && `node ${point.error.node}`,
  ];
  return h(
    "tr",
    {},
    h("td", {}, h("a", { href: link(["sweeps", id, "points", String(point.ordinal)]) }, point.ordinal)),
    h("td", {}, sayParameters(point.parameters)),
    h("td", { class: "small" }, place.filter(Boolean).join(", ")),
    h("td", { class: "number" }, point.attempts),
  );
}
