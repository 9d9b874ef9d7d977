// Effects with reasons, accuracy, cost, and files to download.

import { address, get } from "../data/api.js";
import { bytes, duration, label, meaning, moment, number, say } from "../data/units.js";
import { fill, h } from "../ui/dom.js";
import { AccuracyCost } from "./accuracy-cost.js";

/** Files that are tables, which are served as CSV, too. */
const TABLES = ["profile", "statics", "history", "lines", "contacts", "loads", "energy", "snapshots"];

/**
 * @param {import("./part.js").PointContext} context
 * @returns {import("./part.js").PointPart}
 */
export function about(context) {
  const { point, path, signal } = context;
  const effects = loadingPanel("Effects");
  const files = loadingPanel("Downloads");
  const cost = new AccuracyCost(context);

  async function drawEffects() {
    let plan;
    try {
      plan = await get(`${path}/plan`, {}, signal);
      fill(effects, h("h2", {}, "Effects"), effectsTable(plan));
    } catch (error) {
      if (signal.aborted) return;
      fill(
        effects,
        h("h2", {}, "Effects"),
        h("p", { class: "soft" }, String(error instanceof Error ? error.message : error)),
      );
    }
    if (plan) await cost.draw(plan);
  }

  async function drawFiles() {
    const { artifacts } = await get(`${path}/artifacts`, {}, signal);
    fill(
      files,
      h("h2", {}, "Downloads"),
      artifacts.length
        ? filesTable(path, artifacts)
        : h("p", { class: "soft" }, "Of this point only its row of the table is stored."),
    );
  }

  return {
    element: h(
      "div",
      { class: "half" },
      accuracyPart(context),
      cost.element,
      factsPart("What it cost", costFacts(point)),
      effects,
      files,
      summaryPart(context),
      provenancePart(point),
    ),
    draw: async () => {
      await Promise.all([cost.draw(), drawEffects(), drawFiles()]);
    },
    request: () => ({
      asked: [
        { table: "", isDocument: true },
        { table: "plan", isDocument: true },
        { table: "artifacts", isDocument: true },
      ],
      python:
        'summary, provenance = point.summary, point.provenance\nplan = point.plan()\nprint(summary, provenance, plan["effects"], sep="\\n")',
    }),
  };
}

/** @param {string} heading */
function loadingPanel(heading) {
  return h(
    "section",
    { class: "panel", "aria-label": heading },
    h("h2", {}, heading),
    h("p", { class: "soft" }, "Loading…"),
  );
}

/** @param {any} plan of the point */
function effectsTable({ effects }) {
  const rows = effects.map((/** @type {any} */ effect) =>
    h(
      "tr",
      {},
      h("td", {}, effect.effect.replaceAll("_", " ")),
      h(
        "td",
        {},
        h(
          "span",
          { class: `state ${effect.active ? "succeeded" : "cancelled"}` },
          effect.active ? "on" : "off",
        ),
      ),
      h("td", {}, effect.reason),
      h("td", { class: "soft" }, effect.switch === "auto" ? "" : `set ${effect.switch}`),
    ),
  );
  const heads = ["Effect", "Is", "Why", "Switch"].map((text) => h("th", {}, text));
  return h(
    "div",
    { class: "scroll" },
    h("table", {}, h("thead", {}, h("tr", {}, heads)), h("tbody", {}, rows)),
  );
}

/** @param {string} path of the point @param {any[]} artifacts */
function filesTable(path, artifacts) {
  const rows = artifacts.map((file) => {
    const name = file.expired
      ? `${file.name} (expired)`
      : h(
          "a",
          { href: file.link, download: "" },
          `${file.name}${file.link.slice(file.link.lastIndexOf("."))}`,
        );
    const csv =
      TABLES.includes(file.name) &&
      !file.expired &&
      h(
        "a",
        { href: address(`${path}/${file.name}`, { format: "csv" }), download: `${file.name}.csv` },
        "CSV",
      );
    return h(
      "tr",
      {},
      h("td", {}, name),
      h("td", { class: "number" }, file.rows),
      h("td", { class: "number" }, bytes(file.bytes)),
      h("td", {}, csv),
    );
  });
  const heads = [
    h("th", {}, "File"),
    h("th", { class: "number" }, "Rows"),
    h("th", { class: "number" }, "Size"),
    h("th", {}, "As"),
  ];
  return h("table", {}, h("thead", {}, h("tr", {}, heads)), h("tbody", {}, rows));
}

/** @param {string} heading @param {[string, string][]} facts @param {any[]} [more] */
function factsPart(heading, facts, more = []) {
  return h(
    "section",
    { class: "panel", "aria-label": heading },
    h("h2", {}, heading),
    h(
      "dl",
      { class: "facts" },
      facts.flatMap(([name, value]) => [h("dt", {}, name), h("dd", {}, value)]),
    ),
    more,
  );
}

/**
 * Errors of a point's numbers.
 * @param {any} point
 * @returns {[string, string][]}
 */
export function accuracyFacts({ summary }) {
  const percent = (/** @type {any} */ value) =>
    typeof value === "number" ? `${number(100 * value, 2)} %` : "not known";
  return [
    ["Error of orbit size, promised", percent(summary.promised_error)],
    ["Error of orbit size, stated", percent(summary.whole_error)],
    ["by time steps", percent(summary.time_error)],
    ["by the mesh", percent(summary.mesh_error)],
    ["by sampling", percent(summary.sampling_error)],
    ["Mesh: error of the mean radius at rest", percent(summary.mesh_error_mean_radius)],
    ["Spread of an ensemble", percent(summary.relative_spread)],
    [
      "Error of a displacement at the end",
      say("error_estimate_displacement", summary.error_estimate_displacement, 2),
    ],
    ["Resolved up to", say("resolved_hz", summary.resolved_hz)],
    ["Unresolved steps", String(summary.unresolved_steps ?? "–")],
    ["Energy that the ledger misses", say("energy_residual_ratio", summary.energy_residual_ratio, 2)],
  ];
}

/**
 * On what condition the estimates of errors hold, and why some are not known.
 * @param {any} point
 * @returns {[string, string][]}
 */
export function accuracyReasons({ provenance = {} }) {
  const { time, mesh, sampling, spread } = provenance.errors ?? {};
  const reasons = [
    ["Steps", time?.condition ?? time?.reason],
    ["Mesh", mesh?.reason],
    ["Sampling", sampling?.reason],
    ["Spread", spread?.reason],
  ];
  return /** @type {[string, string][]} */ (reasons.filter(([, text]) => text));
}

/** @param {import("./part.js").PointContext} context */
function accuracyPart({ point, bias }) {
  const { summary } = point;
  const biased = Object.keys(summary).filter((name) => name.startsWith("orbit_radius_rms") && bias(name));
  return factsPart("How far to trust it", accuracyFacts(point), [
    accuracyReasons(point).map(([of, text]) => h("p", { class: "small soft" }, `${of}: ${text}`)),
    biased.length
      ? h(
          "p",
          { class: "small" },
          "Verified against reference runs: ",
          biased.map((name) => `${label(name)}${bias(name)}`).join(", "),
          ".",
        )
      : null,
  ]);
}

/**
 * Time that a run took, and its method.
 * @param {any} point
 * @returns {[string, string][]}
 */
export function costFacts(point) {
  const { provenance = {} } = point;
  /** @type {[string, string][]} */
  const facts = [];
  const add = (
    /** @type {string} */ name,
    /** @type {any} */ value,
    /** @type {(value: any) => string} */ write = String,
  ) => value !== undefined && value !== null && facts.push([name, write(value)]);
  add("Simulated time", point.summary?.simulated_time ?? point.scenario.duration, (value) =>
    say("time", value),
  );
  add("Processor time of the run", provenance.transient_cpu_time, duration);
  add("Processor time of the equilibrium", provenance.statics_cpu_time, duration);
  add("Wall time of the run", provenance.transient_wall_time, duration);
  add("Elements", provenance.elements);
  add("Method", provenance.integrator);
  add("Steps", provenance.steps);
  add(
    "Steps from",
    provenance.shortest_step,
    (value) => `${duration(value)} to ${duration(provenance.longest_step ?? value)}`,
  );
  add("Rejected steps", provenance.rejected_steps);
  return facts;
}

/** @param {import("./part.js").PointContext} context */
function summaryPart({ point, bias }) {
  const rows = Object.entries(point.summary)
    .filter(([, value]) => value !== null)
    .map(([name, value]) =>
      h(
        "tr",
        { title: meaning(name) },
        h("td", {}, label(name)),
        h("td", { class: "number" }, say(name, value), h("span", { class: "soft small" }, bias(name))),
      ),
    );
  return h(
    "section",
    { class: "panel", "aria-label": "Summary" },
    h("h2", {}, "Summary"),
    h(
      "div",
      {
        class: "scroll",
        style: "max-height:26rem",
        tabindex: "0",
        role: "region",
        "aria-label": "Summary, scrollable",
      },
      h("table", {}, h("tbody", {}, rows)),
    ),
  );
}

/** @param {any} point */
function provenancePart(point) {
  const { provenance = {} } = point;
  /** @type {[string, string][]} */
  const facts = [
    ["Key", point.key],
    ["Version", `${provenance.version ?? "–"}, physics ${provenance.physics_version ?? "–"}`],
    ["Computed by", `${provenance.worker ?? "–"} on ${provenance.host ?? "–"}`],
    ["Begun", provenance.started ? moment(provenance.started, "second") : "–"],
    ["Ended", provenance.ended ? moment(provenance.ended, "second") : "–"],
    ["Attempts", String(point.attempts)],
  ];
  return factsPart("Where it comes from", facts, [
    h(
      "details",
      {},
      h("summary", {}, "Scenario as simulated"),
      h("pre", { tabindex: "0", style: "max-height:24rem" }, JSON.stringify(point.scenario, null, 2)),
    ),
  ]);
}
