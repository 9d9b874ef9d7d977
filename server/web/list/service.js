// The service next to the list of sweeps: queue, workers, and the latest failures.

import { get } from "../data/api.js";
import { duration } from "../data/units.js";
import { fill, h } from "../ui/dom.js";
import { when } from "../ui/progress.js";
import { link } from "../ui/router.js";

export class Service {
  #signal;
  #queue = h("section", { class: "panel", "aria-label": "Workers and queue" });
  #failures = h("section", { class: "panel", "aria-label": "What failed lately" });

  /** @param {AbortSignal} signal of the view */
  constructor(signal) {
    this.#signal = signal;
    this.element = h("aside", { "aria-label": "Service" }, this.#queue, this.#failures);
  }

  async draw() {
    const [queue, { workers }, failed] = await Promise.all([
      get("/v1/queue", {}, this.#signal),
      get("/v1/workers", {}, this.#signal),
      get("/v1/failures", { limit: 5 }, this.#signal),
    ]);
    fill(this.#queue, ...servicePart(queue, workers));
    fill(this.#failures, ...failuresPart(failed.failures));
  }
}

/** @param {any} queue @param {any[]} workers */
function servicePart(queue, workers) {
  const fact = (/** @type {string} */ name, /** @type {any} */ value) => [
    h("dt", {}, name),
    h("dd", { class: "number" }, value),
  ];
  const rows = workers.map((worker) => {
    const silent = (Date.now() - Date.parse(worker.seen)) / 1000;
    return h(
      "tr",
      {},
      h("td", { class: "small" }, `${worker.host}, process ${worker.process}`),
      h("td", { class: "small soft number" }, silent < 20 ? "alive" : `silent for ${duration(silent)}`),
    );
  });
  return [
    h("h2", {}, "Workers and queue"),
    h(
      "dl",
      { class: "facts" },
      fact("Running", queue.running),
      fact("Queued", queue.queued),
      fact("Paused", queue.paused),
      fact("To be retried", queue.waiting_for_retry),
    ),
    workers.length
      ? h("table", { "aria-label": "Workers" }, h("tbody", {}, rows))
      : h("p", { class: "wrong" }, "No worker is there: queued points wait."),
  ];
}

/** @param {any[]} failed */
function failuresPart(failed) {
  const rows = failed.map((point) =>
    h(
      "li",
      {},
      h(
        "a",
        { href: link(["sweeps", point.sweep, "points", String(point.ordinal)]) },
        `${point.sweep_name ?? "Sweep"}, point ${point.ordinal}`,
      ),
      h(
        "div",
        { class: "small soft reason" },
        when(point.at),
        ` ${point.error?.class ?? "failed"}: ${point.error?.reason ?? "no reason is known"}`,
      ),
    ),
  );
  return [
    h("h2", {}, "Failed lately"),
    rows.length ? h("ul", {}, rows) : h("p", { class: "soft" }, "Nothing has failed."),
  ];
}
