// Up to six points in one picture, of whatever a point has pictures of.

import { get, Problem } from "./api.js";
import { choice, fill, h } from "./dom.js";
import { lines, tableLines } from "./lines.js";
import { attend } from "./notices.js";
import { ledger } from "./point-energy.js";
import { holeTrace, orbitLayout, orbitTrace, seenDownhole, spectrumLayout, spectrumTrace } from "./orbit.js";
import { canvas, DASHES, draw, inks, LINES } from "./plots.js";
import { drawProfiles, quantityTicks, tableOf } from "./point-profiles.js";
import { displaced } from "./point-well.js";
import { go, keep, link } from "./router.js";
import { parameters } from "./sweep-failures.js";
import { label, say, shown, title, unit } from "./units.js";

const MOST = 6;
const SHOWN = 6000;
/** @type {[string, string][]} */
const VIEWS = [["profiles", "Profiles"], ["orbit", "Orbits"], ["history", "Histories"], ["rotation", "Rotation and torque"], ["spectrum", "Full spectra"], ["well", "Well"], ["energy", "Energy"]];
/** The table behind each. @type {Record<string, string>} */
const TABLES = { profiles: "profile", rotation: "history", well: "statics" };
/** Views of a recorded node over a window. */
const WINDOWED = ["orbit", "history", "rotation", "spectrum"];
/** How many times a string's distance from the axis of its hole is drawn. */
const EXAGGERATION = 100;

/** @typedef {{id: string, ordinal: number, path: string, detail: any, name: string, colour: string, dash: string}} Compared */

/** @type {import("./main.js").View} */
export async function show(main, route, signal) {
  const { query } = route;
  const keys = [...new Set((query.get("points") ?? "").split(",").filter((key) => /^[\w-]+:\d+$/.test(key)))].slice(0, MOST);
  const view = VIEWS.some(([name]) => name === query.get("view")) ? (query.get("view") ?? "") : "profiles";
  const { sweeps } = await get("/v1/sweeps", { limit: 100 }, signal);
  /** @type {Compared[]} */
  const points = await Promise.all(
    keys.map(async (key, order) => {
      const [id, ordinal] = key.split(":");
      const path = `/v1/sweeps/${encodeURIComponent(id)}/points/${ordinal}`;
      const detail = await get(path, {}, signal);
      return { id, ordinal: Number(ordinal), path, detail, name: `${order + 1}: ${parameters(detail.parameters) || `point ${ordinal}`}`, colour: LINES[order], dash: DASHES[order] };
    }),
  );
  const to = (/** @type {string[]} */ chosen, shownView = view) => link(["compare"], { ...Object.fromEntries(query), points: chosen.join(","), view: shownView });
  const nameOf = (/** @type {string} */ id) => sweeps.find((/** @type {any} */ sweep) => sweep.id === id)?.name ?? `Sweep ${id.slice(-8)}`;

  const list = h(
    "table",
    { "aria-label": "Points compared" },
    h("tbody", {}, points.map((point, order) => h("tr", {}, h("td", {}, h("span", { style: `color:${point.colour};font-weight:700`, "aria-hidden": "true" }, "━━ "), String(order + 1)), h("td", {}, h("a", { href: link(["sweeps", point.id, "points", String(point.ordinal)]) }, `${nameOf(point.id)}, point ${point.ordinal}`)), h("td", {}, parameters(point.detail.parameters)), h("td", {}, h("button", { class: "plain", "aria-label": `Take point ${order + 1} out`, onclick: () => go(to(keys.filter((key) => key !== `${point.id}:${point.ordinal}`))) }, "Take out"))))),
  );

  let chosenSweep = points.at(-1)?.id ?? sweeps[0]?.id ?? "";
  const ordinal = h("input", { type: "number", min: 1, value: (points.at(-1)?.ordinal ?? 0) + 1, style: "width:6rem" });
  const adding = h(
    "form",
    { class: "controls", onsubmit: (/** @type {Event} */ event) => {
      event.preventDefault();
      if (chosenSweep && Number(ordinal.value) >= 1) go(to([...keys, `${chosenSweep}:${ordinal.value}`]));
    } },
    choice("Sweep", sweeps.map((/** @type {any} */ sweep) => [sweep.id, nameOf(sweep.id)]), chosenSweep, (value) => (chosenSweep = value)),
    h("label", { class: "field" }, h("span", {}, "Point"), ordinal),
    h("button", { type: "submit", disabled: keys.length >= MOST }, keys.length >= MOST ? `At most ${MOST}` : "Add"),
  );

  const place = canvas(VIEWS.find(([name]) => name === view)?.[1] ?? "", view, "tall");
  const controls = h("div", { class: "controls" });
  const wrong = h("p", { class: "wrong", role: "alert" });
  const ticks = quantityTicks(query.get("profiles") ?? "friction_coefficient,eccentricity,effective_tension,largest_normal_force", (names) => {
    query.set("profiles", names.join(","));
    keep({ profiles: names.join(",") });
    attend(redraw(), signal);
  });
  const recorded = points[0]?.detail.scenario.recording.nodes ?? [];
  const window_ = () => {
    const { duration } = points[0].detail.scenario;
    const last = Math.min(...points.map((point) => point.detail.scenario.duration));
    return { from: Number(query.get("from") ?? duration / 3), to: Math.min(last, Number(query.get("to") ?? last)) };
  };
  const selector = () => {
    const node = recorded[Number(query.get("node") ?? 0)] ?? recorded[0];
    return node?.node !== undefined ? { node: node.node } : { depth: node?.depth, nearest: true };
  };

  function drawControls() {
    const set = (/** @type {string} */ name) => (/** @type {string} */ value) => {
      query.set(name, value);
      keep({ [name]: value });
      attend(redraw(), signal);
    };
    const { from, to } = window_();
    const time = (/** @type {string} */ name, /** @type {number} */ value) => {
      const box = h("input", { type: "number", min: 0, step: "any", style: "width:7rem", value: Number(value.toFixed(3)), onchange: () => set(name)(box.value) });
      return h("label", { class: "field" }, h("span", {}, `${name === "from" ? "From" : "To"} [s]`), box);
    };
    const nodes = choice("Node", recorded.map((/** @type {any} */ node, /** @type {number} */ index) => [String(index), node.node !== undefined ? String(node.node) : say("measured_depth", node.depth)]), query.get("node") ?? "0", set("node"));
    if (view === "profiles") fill(controls, ticks.element);
    else if (!WINDOWED.includes(view)) fill(controls);
    else fill(controls, nodes, time("from", from), time("to", to), view === "orbit" && choice("Shows", [["motion", "the motion"], ["hole", "the whole hole"]], query.get("zoom") ?? "motion", set("zoom")), view === "spectrum" && choice("Amplitude", [["linear", "linear"], ["log", "logarithmic"]], query.get("amplitude") ?? "linear", set("amplitude")), view === "history" && choice("Shows", [["up", "from the low side up"], ["across", "across the hole"], ["radius", "distance from the axis"]], query.get("direction") ?? "up", set("direction")), view === "rotation" && choice("Shows", [["rotation_speed", "rotation speed"], ["torque", "torque"]], query.get("quantity") ?? "rotation_speed", set("quantity")));
  }

  /** @param {Compared} point @param {string} name @param {any} asks */
  const table = (point, name, asks = {}) => get(`${point.path}/${name}`, { format: "json", ...asks }, signal);

  async function redraw() {
    wrong.textContent = "";
    const asks = { ...selector(), ...window_() };
    try {
      if (view === "profiles") {
        const names = ticks.names();
        const needed = [...new Set(names.map(tableOf))];
        const tables = await Promise.all(points.map(async (point) => Object.fromEntries(await Promise.all(needed.map(async (name) => [name, await table(point, name)])))));
        await drawProfiles(place, names, points.map((point, order) => ({ ...point, table: (name) => tables[order][tableOf(name)] })), signal);
      } else if (view === "orbit") {
        const found = await Promise.all(points.map((point) => Promise.all([table(point, "orbit", { ...asks, max_points: SHOWN }), table(point, "statics", { fields: "node,low_side_angle,clearance" })])));
        const at = found.map(([orbit, statics]) => Math.max(0, statics.columns.node.indexOf(orbit.attributes.node)));
        const clearance = Math.max(...found.map(([, statics], order) => statics.columns.clearance[at[order]]));
        const traces = found.map(([orbit, statics], order) => orbitTrace(orbit, statics.columns.low_side_angle[at[order]], { color: points[order].colour }, points[order].name));
        await draw(place, [holeTrace(clearance), ...traces], { ...orbitLayout((query.get("zoom") ?? "motion") === "motion", traces, clearance), legend: { orientation: "v" } }, signal);
      } else if (view === "history") {
        const direction = query.get("direction") ?? "up";
        const found = await Promise.all(points.map((point) => Promise.all([table(point, "orbit", { ...asks, max_points: SHOWN }), table(point, "statics", { fields: "node,low_side_angle" })])));
        const traces = found.map(([{ columns, attributes }, statics], order) => {
          const seen = seenDownhole(columns.u, columns.v, statics.columns.low_side_angle[Math.max(0, statics.columns.node.indexOf(attributes.node))]);
          return overTime(points[order], columns.time, shown("radius", direction === "radius" ? columns.radius : direction === "across" ? seen.across : seen.up));
        });
        await draw(place, traces, { xaxis: { title: "time [s]" }, yaxis: { title: `displacement [${unit("radius").symbol}]`, quantity: "radius" } }, signal);
      } else if (view === "rotation") {
        const quantity = query.get("quantity") === "torque" ? "torque" : "rotation_speed";
        const traces = await Promise.all(points.map(async (point) => {
          const name = `${quantity}_${(await table(point, "statistics", { ...selector(), fields: "node" })).columns.node[0]}`;
          const { columns } = await table(point, "history", { ...asks, fields: `time,${name}`, max_points: SHOWN, decimation: "minmax" });
          return overTime(point, columns.time, shown(name, columns[name]));
        }));
        await draw(place, traces, { xaxis: { title: "time [s]" }, yaxis: { title: title(quantity), quantity } }, signal);
      } else if (view === "well") {
        const found = await Promise.all(points.map(async (point) => (await table(point, "statics")).columns));
        const traces = found.map((statics, order) => {
          const path = displaced(statics, { north: statics.north, east: statics.east, down: statics.true_vertical_depth }, EXAGGERATION);
          return { type: "scatter3d", mode: "lines", name: points[order].name, showlegend: true, x: shown("east", path.east), y: shown("north", path.north), z: shown("true_vertical_depth", path.down), line: { color: points[order].colour, width: 5 }, hoverinfo: "name" };
        });
        const { soft, line } = inks();
        const space = (/** @type {string} */ text) => ({ title: { text: `${text} [${unit("north").symbol}]` }, gridcolor: line, zeroline: false, color: soft, backgroundcolor: "rgba(0,0,0,0)" });
        await draw(place, traces, { margin: { l: 0, r: 0, t: 0, b: 0 }, scene: { xaxis: space("east"), yaxis: space("north"), zaxis: { ...space("true vertical depth"), autorange: "reversed" }, aspectmode: "data", camera: { eye: { x: 1.5, y: -1.5, z: 0.7 } } } }, signal);
      } else if (view === "energy") {
        const found = await Promise.all(points.map(async (point) => ledger((await table(point, "energy")).columns)));
        const accounts = [...new Set(found.flatMap((one) => one.accounts))];
        const { symbol } = unit("kinetic");
        const traces = found.map((one, order) => ({ type: "bar", name: points[order].name, showlegend: true, x: accounts.map(label), y: accounts.map((name) => (one.accounts.includes(name) ? shown(name, [one.change(name)])[0] : null)), marker: { color: points[order].colour }, hovertemplate: `%{x}: %{y:.4~g} ${symbol}<extra></extra>` }));
        await draw(place, traces, { barmode: "group", xaxis: { title: "" }, yaxis: { title: `change over the run [${symbol}]`, quantity: "kinetic" } }, signal);
      } else {
        const found = await Promise.all(points.map((point) => table(point, "spectrum", { ...asks, window: "hann" })));
        const layout = spectrumLayout(null, query.get("amplitude") === "log");
        await draw(place, found.map((spectrum, order) => spectrumTrace(spectrum, { color: points[order].colour, dash: points[order].dash }, points[order].name)), layout, signal);
      }
    } catch (error) {
      if (signal.aborted) return;
      if (!(error instanceof Problem)) throw error;
      wrong.textContent = error.message;
    }
  }

  const shownTable = TABLES[view] ?? view;
  const asked = () => (WINDOWED.includes(view) ? Object.fromEntries(Object.entries({ ...selector(), ...window_() }).map(([name, value]) => [name, value === true ? "true" : value])) : {});

  /** @param {Compared} point @param {number} order */
  function matlabOf(point, order) {
    const [options, read] = (tableLines(`${point.path}/${shownTable}`, asked()).matlab ?? "").split("\n");
    const own = read.replace("table =", `point${order + 1} =`);
    return order === 0 ? `${options}\n${own}` : own;
  }

  function pythonLines() {
    const window = `${Object.entries(selector()).map(([name, value]) => `${name}=${value === true ? "True" : value}`).join(", ")}, time=(${window_().from}, ${window_().to})`;
    if (view === "profiles") return `plot.profile(points, "${ticks.names()[0]}")`;
    if (view === "orbit" || view === "spectrum") return `for point in points:\n    plot.${view}(point, ${window})`;
    return `tables = [point.${shownTable}(${WINDOWED.includes(view) ? window : ""}) for point in points]`;
  }
  const taken = lines(() => ({
    matlab: points.map(matlabOf).join("\n"),
    curl: points.map((point) => tableLines(`${point.path}/${shownTable}`, asked()).curl).join("\n"),
    python: `from drillsweep import Client, plot\n\nclient = Client("${location.origin}")\npoints = [${points.map((point) => `client.sweep("${point.id}").point(${point.ordinal})`).join(", ")}]\n${pythonLines()}`,
  }));
  fill(
    main,
    h("div", { class: "head" }, h("h1", {}, "Compare points")),
    h("div", { class: "panel" }, points.length ? h("div", { class: "scroll" }, list) : h("p", { class: "soft" }, "Add up to six points, of one sweep or of several. The link holds them."), adding),
    points.length > 0 && [
      h("div", { style: "height:1rem" }),
      h("nav", { class: "tabs", "aria-label": "What is compared" }, VIEWS.map(([name, text]) => h("a", { href: to(keys, name), "aria-current": name === view && "page" }, text))),
      h("section", { class: "panel", "aria-label": "Picture" }, controls, wrong, h("figure", {}, place, view === "orbit" && h("figcaption", {}, "Looking downhole, the low side down. On the grey circle the node touches the wall."))),
      taken,
    ],
  );
  if (points.length) {
    drawControls();
    redraw().catch((error) => signal.aborted || console.error(error));
  }
  return "Compare";
}

/** @param {Compared} point @param {number[]} time @param {(number | null)[]} values */
function overTime(point, time, values) {
  return { type: "scattergl", mode: "lines", name: point.name, showlegend: true, x: time, y: values, line: { color: point.colour, dash: point.dash, width: 1 }, hovertemplate: "%{x:.3f} s: %{y:.4~g}<extra></extra>" };
}
