// Up to six points in one picture, of whatever a point has pictures of.

import { get, Problem } from "../data/api.js";
import { dragWindow } from "../draw/brush.js";
import { endOf, rangeOf } from "./side-by-side.js";
import { comparedRange, comparedRate, energyAccount, VIEWS, wellColour, wellFactor } from "./views.js";
import { comparedIn, MOST, rememberComparison } from "../ui/last-comparison.js";
import { DepthCursor } from "../draw/depth-cursor.js";
import { choice, debounced, fill, h } from "../ui/dom.js";
import { python, pythonNode, requestLines, snippets } from "../ui/snippets.js";
import { rangesOf } from "../data/motion-requests.js";
import { attend } from "../ui/notices.js";
import { canvas, DASHES, LINES } from "../draw/plots.js";
import { ACCOUNTS } from "../point/energy.js";
import { profileTables, QUANTITIES, quantityTicks, scrolled, tableOf } from "../point/profiles.js";
import { RANGES } from "../point/spectrogram.js";
import { exaggerationChoice } from "../point/well.js";
import { go, keep, link, route as currentRoute } from "../ui/router.js";
import { label, say, sayParameters } from "../data/units.js";

/** How long typing must rest before sweeps are looked for. */
const REST_MS = 200;
/** Part of the shortest run below which a window that is dragged was a click. */
const LEAST = 1e-3;
/** Sweeps that are offered at once. */
const OFFERED = 100;
/** Changes of a scenario at most that tell points of the same words apart. */
const MOST_CHANGES = 3;
/** Depths that differ by less are one [m]. */
const SAME_DEPTH = 1e-3;

/** @typedef {import("./comparison.js").Compared} Compared */

/** @type {import("../ui/router.js").View} */
export async function show(main, route, signal) {
  const { query } = route;
  const keys = comparedIn(query);
  rememberComparison(query);
  const view = Object.keys(VIEWS).find((name) => name === query.get("view")) ?? "profiles";
  const { isWindowed, isOfNode, kind, isDocument, hasTime } = VIEWS[view];
  const [listed, ...asked] = await Promise.all([
    get("/v1/sweeps", { limit: OFFERED }, signal),
    ...keys.map((key, order) => pointOf(key, order, signal)),
  ]);
  const { sweeps } = listed;
  const unknown = asked.flatMap(({ problem }) => (problem ? [problem] : []));
  const to = (/** @type {string[]} */ chosen, shownView = view) =>
    link(["compare"], {
      ...Object.fromEntries(currentRoute().query),
      points: chosen.join(","),
      view: shownView,
    });
  const nameOf = (/** @type {string} */ id) =>
    sweeps.find((/** @type {any} */ sweep) => sweep.id === id)?.name ?? `Sweep ${id.slice(-8)}`;
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

  const list = h(
    "table",
    { "aria-label": "Points compared" },
    h(
      "tbody",
      {},
      points.map((point) =>
        h(
          "tr",
          {},
          h(
            "td",
            {},
            h("span", { style: `color:${point.colour};font-weight:700`, "aria-hidden": "true" }, "━━ "),
            String(point.number),
          ),
          h(
            "td",
            {},
            h(
              "a",
              { href: link(["sweeps", point.id, "points", String(point.ordinal)]) },
              `${nameOf(point.id)}, point ${point.ordinal}`,
            ),
          ),
          h("td", {}, sayParameters(point.detail.parameters)),
          h("td", {}, takeOut(`${point.id}:${point.ordinal}`, `point ${point.number}`)),
        ),
      ),
    ),
  );

  let chosenSweep = points.at(-1)?.id ?? sweeps[0]?.id ?? "";
  const ordinal = h("input", {
    type: "number",
    min: 1,
    value: (points.at(-1)?.ordinal ?? 0) + 1,
    style: "width:6rem",
  });
  const offer = h("span", { style: "display:contents" });
  const found = h("span", { class: "small soft", role: "status" });
  /** Offers sweeps to take a point of. @param {{sweeps: any[], next?: string | null}} page @param {string} name that was looked for */
  const offerSweeps = ({ sweeps: answered, next }, name) => {
    // Those of the points here are at hand, however old they are.
    const own = name
      ? []
      : [...new Set(points.map((point) => point.id))]
          .filter((id) => !answered.some((sweep) => sweep.id === id))
          .map((id) => ({ id, name: null }));
    const offered = [...answered, ...own];
    if (!offered.some((sweep) => sweep.id === chosenSweep)) chosenSweep = offered[0]?.id ?? "";
    fill(
      offer,
      choice(
        "Sweep",
        offered.map((sweep) => [sweep.id, sweep.name ?? nameOf(sweep.id)]),
        chosenSweep,
        (value) => (chosenSweep = value),
      ),
    );
    found.textContent =
      offered.length === 0
        ? name
          ? `No sweep has ${name} in its name.`
          : "There are no sweeps yet."
        : next
          ? `The newest ${answered.length} are offered; search for others.`
          : "";
  };
  let searches = 0;
  const look = async () => {
    const mine = ++searches;
    const name = search.value.trim();
    const page = await get("/v1/sweeps", { limit: OFFERED, name }, signal);
    if (mine === searches) offerSweeps(page, name);
  };
  const search = h("input", {
    type: "search",
    oninput: debounced(() => attend(look(), signal), REST_MS, signal),
    style: "width:12rem",
  });
  const adding = h(
    "form",
    {
      class: "controls",
      onsubmit: (/** @type {Event} */ event) => {
        event.preventDefault();
        if (chosenSweep && Number(ordinal.value) >= 1) go(to([...keys, `${chosenSweep}:${ordinal.value}`]));
      },
    },
    h("label", { class: "field" }, h("span", {}, "Search sweeps"), search),
    offer,
    h("label", { class: "field" }, h("span", {}, "Point"), ordinal),
    h(
      "button",
      { type: "submit", disabled: keys.length >= MOST },
      keys.length >= MOST ? `At most ${MOST}` : "Add",
    ),
    found,
  );
  offerSweeps(listed, "");

  const place =
    kind === "several"
      ? h("div", {})
      : kind === "table"
        ? h("div", {
            class: "scroll",
            tabindex: "0",
            role: "region",
            "aria-label": `${VIEWS[view].name}, scrollable`,
          })
        : canvas(VIEWS[view].name, view, "tall", VIEWS[view].build);
  const controls = h("div", { class: "controls" });
  const lacking = h("div", { class: "lacking", role: "status", "aria-label": "What is missing" });
  const caption = h("figcaption", {});
  const tabs = h("nav", { class: "tabs", "aria-label": "What is compared" });
  const ticks = quantityTicks(
    query.get("profiles") ?? "friction_coefficient,eccentricity,effective_tension,largest_normal_force",
    (names) => change({ profiles: names.join(",") }),
  );
  const depths = isOfNode ? await recordedDepths(points, signal) : [];
  const depth = () => {
    const asked = Number(query.get("depth") ?? depths[Number(query.get("node") ?? 0)] ?? depths[0]);
    return Number.isFinite(asked) ? asked : depths[0];
  };
  const node = () => ({ depth: depth(), nearest: true });
  /** The end of the shortest run [s]. */
  const shortest = () => Math.min(...points.map((point) => point.detail.scenario.duration));
  const window_ = () => {
    const last = shortest();
    const [from, to] = [
      Number(query.get("from") ?? last / 3),
      Math.min(last, Number(query.get("to") ?? last)),
    ];
    return from >= 0 && to > from ? { from, to } : { from: last / 3, to: last };
  };

  /** Keeps choices in the link; an empty one is none. @param {Record<string, string | null>} choices */
  function remember(choices) {
    for (const [name, value] of Object.entries(choices)) {
      if (value) query.set(name, value);
      else query.delete(name);
    }
    keep(choices);
    rememberComparison(currentRoute().query);
    drawTabs();
    taken.dispatchEvent(new Event("redraw"));
  }

  /** Keeps choices in the link and shows what they ask for. @param {Record<string, string>} choices */
  function change(choices) {
    remember(choices);
    drawControls();
    attend(redraw(), signal);
  }

  function drawTabs() {
    fill(
      tabs,
      Object.entries(VIEWS).map(([name, entry]) =>
        h("a", { href: to(keys, name), "aria-current": name === view && "page" }, entry.name),
      ),
    );
  }

  function drawControls() {
    const set = (/** @type {string} */ name) => (/** @type {string} */ value) => change({ [name]: value });
    if (view === "profiles") return fill(controls, ticks.element);
    if (view === "well")
      return fill(
        controls,
        exaggerationChoice(wellFactor(query), set("exaggerate")),
        choice(
          "Colour",
          [
            ["", "of each point"],
            ...QUANTITIES.map(([name]) => /** @type {[string, string]} */ ([name, label(name)])),
          ],
          wellColour(query) ?? "",
          set("colour"),
        ),
      );
    if (view === "energy")
      return fill(
        controls,
        choice(
          "Shows",
          [
            ["", "what all accounts changed"],
            ...ACCOUNTS.map((name) => /** @type {[string, string]} */ ([name, `${label(name)} over time`])),
          ],
          energyAccount(query),
          set("account"),
        ),
      );
    if (!isWindowed) return fill(controls);
    const { from, to } = window_();
    const time = (/** @type {string} */ name, /** @type {number} */ value) => {
      const box = h("input", {
        type: "number",
        min: 0,
        step: "any",
        style: "width:7rem",
        value: Number(value.toFixed(3)),
        onchange: () => set(name)(box.value),
      });
      return h("label", { class: "field" }, h("span", {}, `${name === "from" ? "From" : "To"} [s]`), box);
    };
    const nearest = depths.reduce(
      (best, entry) => (Math.abs(entry - depth()) < Math.abs(best - depth()) ? entry : best),
      depths[0],
    );
    fill(
      controls,
      isOfNode &&
        choice(
          "Node nearest to",
          depths.map((entry) => [String(entry), say("measured_depth", entry)]),
          String(nearest),
          set("depth"),
        ),
      time("from", from),
      time("to", to),
      h("button", { onclick: () => change({ from: "0", to: String(shortest()) }) }, "Whole run"),
      view === "orbit" &&
        choice(
          "Shows",
          [
            ["motion", "the motion"],
            ["hole", "the whole hole"],
          ],
          query.get("zoom") ?? "motion",
          set("zoom"),
        ),
      view === "bit" &&
        choice(
          "End of the string",
          [
            ["bit", "the bit"],
            ["top", "the top"],
          ],
          endOf({ query }),
          set("end"),
        ),
      view === "spectrum" &&
        choice(
          "Frequencies up to",
          rangesOf(comparedRate(points)).map((text) => [text, `${text} Hz`]),
          String(comparedRange({ query, points })),
          set("range"),
        ),
      view === "spectrum" &&
        choice(
          "Amplitude",
          [
            ["linear", "linear"],
            ["log", "logarithmic"],
          ],
          query.get("amplitude") ?? "linear",
          set("amplitude"),
        ),
      view === "spectrogram" &&
        choice(
          "Frequencies up to",
          RANGES.map((text) => [text, `${text} Hz`]),
          String(rangeOf({ query })),
          set("range"),
        ),
      view === "spectrogram" &&
        choice(
          "Amplitude",
          [
            ["log", "logarithmic"],
            ["linear", "linear"],
          ],
          query.get("amplitude") === "linear" ? "linear" : "log",
          set("amplitude"),
        ),
      view === "history" &&
        choice(
          "Shows",
          [
            ["up", "from the low side up"],
            ["across", "across the hole"],
            ["radius", "distance from the axis"],
          ],
          query.get("direction") ?? "up",
          set("direction"),
        ),
      view === "rotation" &&
        choice(
          "Shows",
          [
            ["rotation_speed", "rotation speed"],
            ["torque", "torque"],
          ],
          query.get("quantity") ?? "rotation_speed",
          set("quantity"),
        ),
    );
  }

  /** Ends when what is shown is asked for anew. */
  let latest = new AbortController();
  const loading = h("p", { class: "soft", role: "status" }, "Loading…");
  let isDraggable = false;
  /** Tables that points are drawn from, by their numbers, where the view has a choice. @type {Map<number, string>} */
  let sources = new Map();

  /** What the points' profiles are at a depth. @type {NonNullable<import("./comparison.js").Comparison["profiled"]>["read"]} */
  let readAt = () => [];
  const cursor = new DepthCursor(place, { query, keep: remember }, (depth, told) => readAt(depth, told));

  async function redraw() {
    latest.abort();
    latest = new AbortController();
    const drawing = AbortSignal.any([signal, latest.signal]);
    /** @type {import("./comparison.js").Comparison} */
    const comparison = {
      points,
      query,
      profiles: ticks.names(),
      node: node(),
      window: window_(),
      keep: remember,
      table: (point, name, asks = {}) => get(`${point.path}/${name}`, { format: "json", ...asks }, drawing),
      lacking: [],
      sources: new Map(),
      says: [],
      nodes: new Map(),
      signal,
      drawing,
    };
    const isRecorded = !isOfNode || depths.length > 0;
    if (!isRecorded) comparison.lacking.push("No point here has a recorded node.");
    place.hidden = !isRecorded;
    // Of modes and effects the service computes for seconds.
    if (kind && isRecorded && !place.hasChildNodes()) fill(place, loading);
    try {
      const shape = isRecorded && (await VIEWS[view].draw(place, comparison));
      if (!drawing.aborted && comparison.profiled) {
        readAt = comparison.profiled.read;
        cursor.follow(shape, comparison.profiled.depths);
      }
    } catch (error) {
      if (!drawing.aborted) throw error;
    } finally {
      if (!drawing.aborted) loading.remove();
    }
    if (drawing.aborted) return;
    sources = comparison.sources;
    taken.dispatchEvent(new Event("redraw"));
    if (hasTime && isRecorded && !isDraggable) {
      isDraggable = true;
      dragWindow(
        place,
        () => {},
        (range) =>
          range &&
          range[1] - range[0] > LEAST * shortest() &&
          change({ from: range[0].toFixed(4), to: range[1].toFixed(4) }),
        signal,
      );
    }
    fill(
      lacking,
      comparison.lacking.map((sentence) => h("p", {}, sentence)),
    );
    const shownNodes = [...comparison.nodes.entries()].sort(([a], [b]) => a - b).map(([, text]) => text);
    fill(
      caption,
      view === "orbit" && "Looking downhole, the low side down. ",
      comparison.says.map((sentence) => `${sentence} `),
      shownNodes.length > 0 &&
        `The recorded node of each point that is nearest to ${say("measured_depth", depth())}: ${shownNodes.join("; ")}.`,
      hasTime && " Drag across the picture to choose a window; the other views follow.",
    );
  }

  const { table: shownTable } = VIEWS[view];

  /** The requests behind the view for one point: tables with what is asked of each. @param {Compared} point @returns {{table: string, query: Record<string, any>}[]} */
  function requestsOf(point) {
    if (view === "profiles")
      return profileTables(ticks.names()).map(({ table, fields }) => ({
        table,
        query: { fields: fields.join(",") },
      }));
    if (view === "well") return wellTables().map((table) => ({ table, query: {} }));
    const table = sources.get(point.number) ?? shownTable;
    return [
      {
        table,
        query: {
          ...(isOfNode ? { depth: depth(), nearest: true } : {}),
          ...(isWindowed ? window_() : {}),
          ...(hasRange ? { range_hz: range() } : {}),
        },
      },
    ];
  }
  const hasRange = view === "spectrum" || view === "spectrogram";
  const range = () => (view === "spectrum" ? comparedRange({ query, points }) : rangeOf({ query }));

  /** The tables behind the wells: the equilibrium, and what has the quantity that colours them. */
  function wellTables() {
    const colour = wellColour(query);
    return [...new Set(["statics", ...(colour ? [tableOf(colour)] : [])])];
  }

  function pythonLines() {
    const cut = isOfNode
      ? pythonNode(node(), window_())
      : isWindowed
        ? `time=(${window_().from}, ${window_().to})`
        : "";
    const window = hasRange ? `${cut}, range_hz=${range()}` : cut;
    if (view === "profiles")
      return profileTables(ticks.names())
        .map(
          ({ table, fields }) =>
            `${table} = [point.${table}().to_pandas()[${python(fields)}] for point in points]`,
        )
        .join("\n");
    if (view === "well")
      return wellTables()
        .map((table) => `${table} = [point.${table}().to_pandas() for point in points]`)
        .join("\n");
    if (isDocument)
      return shownTable
        ? `documents = [point.${shownTable}() for point in points]`
        : `documents = [point.${view === "accuracy" ? "summary" : "provenance"} for point in points]`;
    if (view === "orbit" || view === "spectrum")
      return `for point in points:\n    plot.${view}(point, ${window})`;
    if (view === "bit")
      return points
        .map(
          (point) =>
            `point${point.number} = client.sweep("${point.id}").point(${point.ordinal}).${requestsOf(point)[0].table}(${window}).to_pandas()`,
        )
        .join("\n");
    return `tables = [point.${shownTable}(${window}).to_pandas() for point in points]`;
  }
  const taken = snippets(() => {
    const asked = points.flatMap((point) =>
      requestsOf(point).map(({ table, query: asks }, _, { length }) => ({
        path: table ? `${point.path}/${table}` : point.path,
        query: asks,
        name: `point${point.number}${view === "profiles" || length > 1 ? `_${table}` : ""}`,
        isDocument,
      })),
    );
    const start = `from drillsweep import Client, plot\n\nclient = Client("${location.origin}")\npoints = [${points.map((point) => `client.sweep("${point.id}").point(${point.ordinal})`).join(", ")}]\n`;
    return requestLines(asked, start + pythonLines());
  });
  drawTabs();
  fill(
    main,
    h("div", { class: "head" }, h("h1", {}, "Compare points")),
    h(
      "div",
      { class: "panel" },
      points.length
        ? h("div", { class: "scroll" }, list)
        : h("p", { class: "soft" }, "Add up to six points, of one sweep or of several. The link holds them."),
      unknown.map(({ key, text }) => h("p", { class: "wrong" }, `${text} `, takeOut(key, "it"))),
      adding,
    ),
    points.length > 0 && [
      h("div", { style: "height:1rem" }),
      tabs,
      h(
        "section",
        { class: "panel", "aria-label": "Picture" },
        controls,
        lacking,
        h("figure", {}, view === "profiles" ? scrolled(place) : place, caption),
        view === "profiles" && cursor.element,
      ),
      taken,
    ],
  );
  if (points.length) {
    drawControls();
    attend(redraw(), signal);
  }
  return "Compare";
}

/**
 * A point of the link, or what the service says where it has none.
 * @param {string} key such as `SWEEP:3`
 * @param {number} order
 * @param {AbortSignal} signal
 * @returns {Promise<{point?: Compared, problem?: {key: string, text: string}}>}
 */
async function pointOf(key, order, signal) {
  const [id, ordinal] = key.split(":");
  const path = `/v1/sweeps/${encodeURIComponent(id)}/points/${ordinal}`;
  try {
    const detail = await get(path, {}, signal);
    const number = order + 1;
    return {
      point: {
        number,
        id,
        ordinal: Number(ordinal),
        path,
        detail,
        name: String(number),
        colour: LINES[order],
        dash: DASHES[order],
      },
    };
  } catch (error) {
    if (!(error instanceof Problem) || error.status !== 404) throw error;
    return { problem: { key, text: `Point ${order + 1} of the link was not found: ${error.message}.` } };
  }
}

/**
 * The points, each told from the others by as few words as do: its parameters, what differs in a few numbers or choices of their
 * scenarios, its sweep, its ordinal.
 * @param {Compared[]} points
 * @param {(id: string) => string} nameOf a sweep
 * @returns {Compared[]}
 */
function toldApart(points, nameOf) {
  /** What tells a point from those that are alike so far. @type {((point: Compared, alike: Compared[]) => string)[]} */
  const tells = [
    ({ detail }) => sayParameters(detail.parameters),
    changesAmong,
    ({ id }) => nameOf(id),
    ({ ordinal }) => `point ${ordinal}`,
  ];
  return points.map((point) => {
    let alike = points;
    /** @type {string[]} */
    const words = [];
    for (const tell of tells) {
      const own = tell(point, alike);
      const rest = alike.filter((other) => tell(other, alike) === own);
      if (!words.length || rest.length < alike.length) words.push(own);
      alike = rest;
      if (alike.length === 1) break;
    }
    return {
      ...point,
      name: `${point.number}: ${words.filter(Boolean).join(", ") || `point ${point.ordinal}`}`,
    };
  });
}

/**
 * In what a point's scenario differs from those of others; empty where that is much.
 * @param {Compared} point
 * @param {Compared[]} alike it and the others
 */
function changesAmong(point, alike) {
  const scenarios = alike.map(({ detail }) => leaves(detail.scenario));
  const own = leaves(point.detail.scenario);
  // A name and what was recorded make no other motion.
  const paths = [...new Set(scenarios.flatMap((one) => [...one.keys()]))].filter(
    (path) =>
      path !== "name" &&
      !path.startsWith("recording.") &&
      scenarios.some((one) => one.get(path) !== own.get(path)),
  );
  return paths.length <= MOST_CHANGES
    ? sayParameters(Object.fromEntries(paths.map((path) => [path, own.get(path)])))
    : "";
}

/**
 * Numbers, words and truths of a document, by their paths; what stands in lists is left out.
 * @param {any} document
 * @param {string} [path]
 * @returns {Map<string, any>}
 */
function leaves(document, path = "") {
  const entries = Object.entries(document).flatMap(([name, value]) => {
    if (value === null || Array.isArray(value)) return [];
    return typeof value === "object"
      ? [...leaves(value, `${path}${name}.`)]
      : [/** @type {[string, any]} */ ([path + name, value])];
  });
  return new Map(entries);
}

/**
 * Measured depths at which any of the points recorded a node, from the top [m].
 * @param {Compared[]} points
 * @param {AbortSignal} signal
 * @returns {Promise<number[]>}
 */
async function recordedDepths(points, signal) {
  const found = await Promise.all(
    points.map(async ({ detail, path }) => {
      /** @type {any[]} */
      const nodes = detail.summary ? detail.scenario.recording.nodes : [];
      if (!nodes.some((entry) => entry.node !== undefined)) return nodes.map((entry) => entry.depth);
      try {
        const { columns } = await get(
          `${path}/statics`,
          { format: "json", fields: "node,measured_depth" },
          signal,
        );
        return nodes.map((entry) => entry.depth ?? columns.measured_depth[columns.node.indexOf(entry.node)]);
      } catch (error) {
        // Without its equilibrium it has no motion either.
        if (!(error instanceof Problem) || error.status === 401) throw error;
        return [];
      }
    }),
  );
  const inOrder = found
    .flat()
    .filter(Number.isFinite)
    .sort((a, b) => a - b);
  return inOrder.filter((depth, index) => index === 0 || depth - inOrder[index - 1] > SAME_DEPTH);
}
