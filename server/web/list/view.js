// The list of sweeps, with the queue, the workers and the latest failures next to it.

import { debounced, fill, h } from "../ui/dom.js";
import { attend } from "../ui/notices.js";
import { go, keep } from "../ui/router.js";
import { requestLines, shell, snippets } from "../ui/snippets.js";
import { Filters } from "./filters.js";
import { Service } from "./service.js";
import { Sweeps } from "./sweeps.js";

/** Interval at which list and service are requested again. */
const POLL_MS = 4000;
/** Rest of typing before the list is loaded. */
const REST_MS = 250;

/** @type {import("../ui/router.js").View} */
export async function show(main, route, signal) {
  const rested = debounced(() => attend(sweeps.load(), signal), REST_MS, signal);
  const filtered = () => {
    keep(filters.values);
    taken.dispatchEvent(new Event("redraw"));
    rested();
  };
  const filters = new Filters(route.query, filtered);
  const service = new Service(signal);
  const sweeps = new Sweeps(filters, signal);
  const taken = snippets(() => listLines(filters.values));
  addEventListener("keydown", (event) => pressed(event, filters, sweeps.rows), { signal });
  fill(
    main,
    h(
      "div",
      { class: "head" },
      h("h1", {}, "Sweeps"),
      h(
        "p",
        { class: "soft small wide-only" },
        h("kbd", {}, "j"),
        " ",
        h("kbd", {}, "k"),
        " move, ",
        h("kbd", {}, "Enter"),
        " opens, ",
        h("kbd", {}, "/"),
        " searches, ",
        h("kbd", {}, "n"),
        " new",
      ),
    ),
    h(
      "div",
      { class: "columns" },
      h(
        "div",
        {},
        filters.element,
        h("div", { class: "panel scroll" }, sweeps.rows.element, sweeps.end),
        taken,
      ),
      service.element,
    ),
  );
  await sweeps.load();
  main.addEventListener("shown", () => attend(service.draw(), signal), { once: true });
  poll(sweeps, service, signal);
  return "Sweeps";
}

/** Requests list and service again at intervals while the page is visible. @param {Sweeps} sweeps @param {Service} service @param {AbortSignal} signal */
function poll(sweeps, service, signal) {
  const refresh = () => {
    if (document.hidden) return;
    void sweeps.refresh().catch(() => {});
    void service.draw().catch(() => {});
  };
  const timer = setInterval(refresh, POLL_MS);
  document.addEventListener("visibilitychange", refresh, { signal });
  signal.addEventListener("abort", () => clearInterval(timer));
}

/** Acts on a key, unless a reader types in a field. @param {KeyboardEvent} event @param {Filters} filters @param {import("./rows.js").Rows} rows */
function pressed(event, filters, rows) {
  if (event.ctrlKey || event.metaKey || event.altKey || document.querySelector("dialog[open]")) return;
  if (event.target instanceof HTMLElement && event.target.matches("input, select, textarea")) {
    if (event.key === "Escape") event.target.blur();
    return;
  }
  if (event.key === "/") {
    event.preventDefault();
    filters.focus();
  } else if (event.key === "j") rows.move(1);
  else if (event.key === "k") rows.move(-1);
  else if (event.key === "n") go("#/new");
}

/** Snippets that read the list. @param {Filters["values"]} filters @returns {import("../ui/snippets.js").Lines} */
function listLines(filters) {
  const chosen = Object.entries(filters).filter(([, value]) => value);
  const given = chosen.map(([name, value]) => `${name}=${JSON.stringify(value)}`).join(", ");
  return {
    ...requestLines(
      [{ path: "/v1/sweeps", query: filters, name: "list", isDocument: true }],
      `from drillsweep import Client\n\nfor sweep in Client("${location.origin}").sweeps(${given}):\n    print(sweep.id, sweep.name, sweep.state, sweep.progress)`,
    ),
    cli: `drillsweep list --server ${location.origin}${chosen.map(([name, value]) => ` --${name} ${shell(value)}`).join("")}`,
  };
}
