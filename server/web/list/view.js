// The list of sweeps, with the queue, the workers and what failed lately.

import { followAll, get, isFinal } from "../data/api.js";
import { debounced, choice, fill, h } from "../ui/dom.js";
import { requestLines, shell, snippets } from "../ui/snippets.js";
import { attend } from "../ui/notices.js";
import { Pace } from "../data/pace.js";
import { go, keep, link } from "../ui/router.js";
import { duration } from "../data/units.js";
import { progressPart, when } from "../ui/progress.js";

/** How often the list is asked for while no stream tells of changes. */
const POLL_MS = 4000;
/** The least time between two looks at the queue, the workers and the failures while sweeps change. */
const SERVICE_MS = 4000;
/** The longest time between two looks at the list and at the service: the stream does not tell that a sweep is deleted that existed for less than a second. */
const QUIET_MS = 30_000;
/** How long sweeps that are new to the page are collected before the list is asked which of them pass its filters. */
const COLLECT_MS = 300;

/** @type {import("../ui/router.js").View} */
export async function show(main, route, signal) {
  const firstPage = () =>
    preload.firstPage({ state: state(), name: search.value, owner: owner.value, tag: tag.value });
  const filters = () => {
    const { limit: _, ...filters } = firstPage();
    return filters;
  };
  let chosenState = route.query.get("state") ?? "";
  const state = () => chosenState;

  const filtered = debounced(
    () => {
      keep(filters());
      redraw();
      attend(load(), signal);
    },
    250,
    signal,
  );
  const input = (
    /** @type {string} */ label,
    /** @type {string} */ name,
    /** @type {string} */ type = "text",
  ) =>
    h("input", {
      type,
      value: route.query.get(name) ?? "",
      oninput: filtered,
      "aria-label": label,
      placeholder: label,
      size: 12,
    });
  const search = input("Search names", "name", "search");
  search.size = 24;
  search.title = "Press / to search";
  const owner = input("Owner", "owner");
  const tag = input("Tag", "tag");
  const states = choice(
    "State",
    [
      ["", "all"],
      ["running", "running"],
      ["paused", "paused"],
      ["completed", "completed"],
      ["cancelled", "cancelled"],
    ],
    chosenState,
    (value) => {
      chosenState = value;
      filtered();
    },
  );
  const field = (/** @type {string} */ name, /** @type {HTMLElement} */ element) =>
    h("label", { class: "field" }, h("span", {}, name), element);

  const body = h("tbody", {});
  const table = h(
    "table",
    { "aria-label": "Sweeps" },
    h(
      "thead",
      {},
      h(
        "tr",
        {},
        h("th", {}, "Sweep"),
        h("th", {}, "State"),
        h("th", { class: "wide-only" }, "Owner"),
        h("th", { class: "wide-only" }, "Submitted"),
      ),
    ),
    body,
  );
  const end = h("p", { class: "soft small", role: "status" });
  const service = h("section", { class: "panel", "aria-label": "Workers and queue" });
  const failures = h("section", { class: "panel", "aria-label": "What failed lately" });

  /** @type {Map<string, {sweep: any, row: HTMLTableRowElement, pace: Pace}>} */
  const known = new Map();
  /** @type {string | null} */
  let next = null;
  let isLoading = false;
  /** The sweep that the keyboard has selected. @type {string | null} */
  let selected = null;
  /** Numbers the loads, so that the answer to an older filter is dropped. */
  let generation = 0;

  async function load() {
    const mine = ++generation;
    const page = await get("/v1/sweeps", firstPage(), signal);
    if (mine !== generation) return;
    known.clear();
    selected = null;
    fill(body);
    next = page.next ?? null;
    add(page.sweeps);
  }

  async function more() {
    if (!next || isLoading) return;
    isLoading = true;
    const mine = generation;
    try {
      const page = await get("/v1/sweeps", { ...firstPage(), cursor: next }, signal);
      if (mine === generation) {
        next = page.next ?? null;
        add(page.sweeps);
      }
    } finally {
      isLoading = false;
    }
    // The observer tells of changes only, and a reader who has scrolled to the new end already has not left the end for it.
    observer.unobserve(end);
    observer.observe(end);
  }

  /** @param {any[]} sweeps */
  function add(sweeps) {
    for (const sweep of sweeps) {
      if (!known.has(sweep.id)) enter(sweep, null);
    }
    sayEnd();
  }

  /** Gives a sweep a row. @param {any} sweep @param {HTMLTableRowElement | null} below the row below it; none where it is the last */
  function enter(sweep, below) {
    const entry = { sweep, row: h("tr", { "data-sweep": sweep.id }), pace: new Pace() };
    entry.pace.note(sweep);
    known.set(sweep.id, entry);
    drawRow(entry.row, sweep, entry.pace);
    body.insertBefore(entry.row, below);
  }

  /** Says below the list how far it goes. */
  function sayEnd() {
    const hasFilter = Object.values(filters()).some(Boolean);
    if (known.size === 0 && !next) {
      fill(
        end,
        hasFilter
          ? "No sweep matches these filters."
          : h(
              "span",
              {},
              "There are no sweeps yet. ",
              h("a", { href: "#/new" }, "Submit the first one"),
              ".",
            ),
      );
    } else {
      fill(
        end,
        next
          ? "Further sweeps follow as you scroll."
          : `${known.size} ${known.size === 1 ? "sweep" : "sweeps"}.`,
      );
    }
  }

  /** Whether a sweep belongs in the list, as the service decides it. @param {any} sweep */
  function passes(sweep) {
    const { state, name, owner, tag } = filters();
    return (
      (!state || sweep.state === state) &&
      (!owner || sweep.owner === owner) &&
      (!tag || (sweep.tags ?? []).includes(tag)) &&
      (sweep.name ?? "").toLowerCase().includes(name.toLowerCase())
    );
  }

  /** What the stream told last of each sweep: an answer may be older than that. @type {Map<string, any>} */
  const told = new Map();
  /** Sweeps that were deleted, which an older answer may still have. @type {Set<string>} */
  const deleted = new Set();

  /** A sweep as it is known last. @param {any} sweep of an answer */
  function latest(sweep) {
    const other = told.get(sweep.id);
    return other && isBefore(sweep, other) ? other : sweep;
  }

  /** @param {any} sweep */
  function update(sweep) {
    if (!passes(sweep)) return forget(sweep.id);
    const entry = known.get(sweep.id);
    if (!entry) return;
    entry.sweep = sweep;
    entry.pace.note(sweep);
    drawRow(entry.row, sweep, entry.pace);
  }

  let isStreaming = false;
  /** Sweeps that the list does not show, and of which something was told. @type {Set<string>} */
  const unknown = new Set();
  const askForNew = debounced(
    () => {
      const isAsked = [...unknown].some((id) => !known.has(id));
      unknown.clear();
      if (isAsked) void poll().catch(() => {});
    },
    COLLECT_MS,
    signal,
  );

  /** Takes what the stream tells of a sweep. @param {any} sweep */
  function hear(sweep) {
    serviceChanged();
    const before = told.get(sweep.id);
    told.set(sweep.id, sweep);
    if (known.has(sweep.id)) return update(sweep);
    if (before?.revision === sweep.revision && before.state === sweep.state) return;
    unknown.add(sweep.id);
    askForNew();
  }

  /** @param {string} id */
  function forget(id) {
    const row = known.get(id)?.row;
    if (!row) return;
    // Where the selected sweep was, its neighbour is; who types in a field goes on there.
    if (id === selected && body.rows.length > 1)
      move(row === body.rows[body.rows.length - 1] ? -1 : 1, row.contains(document.activeElement));
    row.remove();
    known.delete(id);
    sayEnd();
  }

  /** Numbers the looks at the first page, so that an answer that a later one has overtaken is dropped. */
  let looks = 0;
  let answered = 0;
  let listAt = Date.now();
  /** Reads the first page of the list again. */
  async function poll() {
    const mine = generation;
    const look = ++looks;
    listAt = Date.now();
    const page = await get("/v1/sweeps", firstPage(), signal);
    if (mine !== generation || look < answered) return;
    answered = look;
    // Identifiers grow with time: what that page would have and has not does not pass the filters any more.
    const [listed, last] = [
      new Set(page.sweeps.map((/** @type {any} */ sweep) => sweep.id)),
      page.next ? page.sweeps.at(-1).id : "",
    ];
    for (const id of [...known.keys()]) if (id > last && !listed.has(id)) forget(id);
    const sweeps = page.sweeps.map(latest).filter((/** @type {any} */ sweep) => !deleted.has(sweep.id));
    const fresh = sweeps.filter((/** @type {any} */ sweep) => !known.has(sweep.id) && passes(sweep));
    sweeps.forEach(update);
    for (const sweep of fresh)
      enter(sweep, [...body.rows].find((row) => (row.dataset.sweep ?? "") < sweep.id) ?? null);
    sayEnd();
  }

  let serviceAt = 0;
  /** @type {ReturnType<typeof setTimeout> | undefined} */
  let serviceWaits;

  /** Looks at the service once more, not too often. */
  function serviceChanged() {
    serviceWaits ??= setTimeout(
      () => {
        serviceWaits = undefined;
        if (!document.hidden) void drawService().catch(() => {});
      },
      Math.max(0, serviceAt + SERVICE_MS - Date.now()),
    );
  }

  async function drawService() {
    serviceAt = Date.now();
    const [queue, { workers }, failed] = await Promise.all([
      get("/v1/queue", {}, signal),
      get("/v1/workers", {}, signal),
      get("/v1/failures", { limit: 5 }, signal),
    ]);
    fill(service, ...servicePart(queue, workers));
    fill(failures, ...failuresPart(failed.failures));
  }

  /** Selects the sweep so many rows below the one that is selected. @param {number} by @param {boolean} [isFocused] whether it gets the keyboard */
  function move(by, isFocused = true) {
    const rows = [...body.rows];
    if (!rows.length) return;
    const row = known.get(selected ?? "")?.row;
    const next = rows[row ? Math.max(0, Math.min(rows.length - 1, rows.indexOf(row) + by)) : 0];
    row?.removeAttribute("aria-selected");
    selected = [...known].find(([, entry]) => entry.row === next)?.[0] ?? null;
    next.setAttribute("aria-selected", "true");
    if (!isFocused) return;
    next.querySelector("a")?.focus({ preventScroll: true });
    next.scrollIntoView({ block: "nearest" });
  }

  addEventListener(
    "keydown",
    (event) => {
      if (event.ctrlKey || event.metaKey || event.altKey || document.querySelector("dialog[open]")) return;
      if (event.target instanceof HTMLElement && event.target.matches("input, select, textarea")) {
        if (event.key === "Escape") event.target.blur();
        return;
      }
      if (event.key === "/") {
        event.preventDefault();
        search.focus();
      } else if (event.key === "j") move(1);
      else if (event.key === "k") move(-1);
      else if (event.key === "n") go("#/new");
    },
    { signal },
  );

  const observer = new IntersectionObserver(
    (entries) => entries.some((entry) => entry.isIntersecting) && more().catch(() => {}),
    { rootMargin: "800px" },
  );
  observer.observe(end);
  signal.addEventListener("abort", () => observer.disconnect());
  const timer = setInterval(() => {
    if (document.hidden) return;
    if (!isStreaming || Date.now() - listAt >= QUIET_MS) void poll().catch(() => {});
    if (!isStreaming || Date.now() - serviceAt >= QUIET_MS) serviceChanged();
  }, POLL_MS);
  signal.addEventListener("abort", () => {
    clearInterval(timer);
    clearTimeout(serviceWaits);
  });

  const taken = snippets(() => {
    const chosen = Object.entries(filters()).filter(([, value]) => value);
    return {
      ...requestLines(
        [{ path: "/v1/sweeps", query: filters(), name: "list", isDocument: true }],
        `from drillsweep import Client\n\nfor sweep in Client("${location.origin}").sweeps(${chosen.map(([name, value]) => `${name}=${JSON.stringify(value)}`).join(", ")}):\n    print(sweep.id, sweep.name, sweep.state, sweep.progress)`,
      ),
      cli: `drillsweep list --server ${location.origin}${chosen.map(([name, value]) => ` --${name} ${shell(value)}`).join("")}`,
    };
  });
  const redraw = () => taken.dispatchEvent(new Event("redraw"));

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
        h(
          "div",
          { class: "controls", role: "search" },
          field("Name", search),
          states,
          field("Owner", owner),
          field("Tag", tag),
        ),
        h("div", { class: "panel scroll" }, table, end),
        taken,
      ),
      h("aside", { "aria-label": "Service" }, service, failures),
    ),
  );
  await load();
  main.addEventListener("shown", () => attend(drawService(), signal), { once: true });
  followAll(
    {
      sweep: hear,
      deleted: (id) => {
        deleted.add(id);
        forget(id);
      },
      opened: () => {
        isStreaming = true;
        // What has changed between the list and the stream, or while there was none, it may not tell.
        void poll().catch(() => {});
      },
      broken: () => (isStreaming = false),
    },
    signal,
  );
  return "Sweeps";
}

/**
 * Whether one account of a sweep is older than another: what somebody asks for raises its revision, and between that points become final.
 * @param {any} sweep
 * @param {any} other the same sweep
 */
function isBefore(sweep, other) {
  const final = (/** @type {any} */ { counts }) => counts.succeeded + counts.failed + counts.cancelled;
  return (
    sweep.revision < other.revision || (sweep.revision === other.revision && final(sweep) < final(other))
  );
}

/**
 * @param {HTMLTableRowElement} row
 * @param {any} sweep
 * @param {Pace} pace
 */
function drawRow(row, sweep, pace) {
  const title = sweep.name ?? `Sweep ${sweep.id.slice(-8)}`;
  const anchor = h("a", { class: "name", href: link(["sweeps", sweep.id]) }, title);
  fill(
    row,
    h(
      "td",
      {},
      anchor,
      h(
        "div",
        { class: "small soft" },
        `${sweep.counts.total} ${sweep.counts.total === 1 ? "point" : "points"} `,
        (sweep.tags ?? []).map((/** @type {string} */ tag) =>
          h("a", { class: "tag", href: link(["sweeps"], { tag }) }, tag),
        ),
      ),
    ),
    h("td", {}, progressPart(sweep, pace)),
    h("td", { class: "wide-only" }, sweep.owner),
    h("td", { class: "wide-only" }, when(sweep.created)),
  );
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
        { class: "small soft brief", title: point.error?.reason },
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
