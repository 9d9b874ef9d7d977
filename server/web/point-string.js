// The string moving in its hole, played from the snapshots of a run; below it the contacts over depth and time, rotation and torque.

import { GRADIENT } from "./colours.js";
import { choice, fill, h } from "./dom.js";
import { attend } from "./notices.js";
import { BEYOND, contactMap, largestShown } from "./point-contacts.js";
import { rotation } from "./point-rotation.js";
import { onNodes } from "./point-well.js";
import { frames, snapshotsOf, withoutSnapshots } from "./snapshots.js";
import { stringScene } from "./string-scene.js";
import { label, say, shown, unit } from "./units.js";
import { nodeFrames } from "./well-frames.js";

/** How many times the string's distance from the axis of the hole is drawn. */
const EXAGGERATIONS = ["1", "20", "50", "100", "300", "1000"];
/** Simulated seconds in a second. */
const SPEEDS = ["2", "1", "0.5", "0.25", "0.1", "0.02"];
/** What colours the string: a name of the vocabulary, and where its values come from. @type {[string, "snapshots" | "motion" | "profile"][]} */
const COLOURS = [
  ["normal_force", "snapshots"],
  ["orbit_radius_rms", "motion"],
  ["radius", "motion"],
  ["friction_coefficient", "profile"],
  ["effective_tension", "profile"],
  ["rotation_speed", "snapshots"],
  ["torque", "snapshots"],
];
/** What the page calls them where the vocabulary has another word. @type {Record<string, string>} */
const CALLED = { normal_force: "contact force", orbit_radius_rms: "whirl amplitude", radius: "distance from the axis" };
/** Part of the values that the scale of colours covers. */
const COVERED = 0.995;
/** Values from which that is estimated. */
const SAMPLED = 20_000;

/** @typedef {import("./snapshots.js").Frames} Frames */

/**
 * @param {import("./point.js").PointContext} context
 * @returns {import("./point.js").PointPart}
 */
export function string(context) {
  const { point, query, signal } = context;
  const { duration, recording } = point.scenario;
  const element = h("div", {});
  const controls = h("div", { class: "controls" });
  const wrong = h("p", { class: "wrong", role: "alert" });
  const legend = h("div", { class: "scale" });
  const caption = h("figcaption", {});
  const scene = stringScene("The string moving in its hole; arrow keys turn it, + and - change its size, space plays", signal);
  const play = h("button", { class: "main", onclick: () => setPlaying(!isPlaying) }, "Play");
  const clock = h("output", { class: "number" });
  const slider = h("input", { type: "range", "aria-label": "Time", min: 0, max: 1, step: "any", value: 0, style: "flex:1;min-width:8rem", oninput: () => {
    setPlaying(false);
    go(Number(slider.value));
  } });
  const map = contactMap(context, (time) => {
    setPlaying(false);
    go(time);
  });
  const turning = rotation(context);

  /** @type {any} */
  let statics;
  /** @type {Awaited<ReturnType<typeof snapshotsOf>>} */
  let there = null;
  /** @type {Frames} */
  let motion;
  /** @type {{value: (node: number) => number, range: [number, number], isMarked?: (node: number) => boolean}} */
  let colours = { value: () => 0, range: [0, 1] };
  /** @type {ReturnType<typeof nodeFrames>} */
  let geometry;
  let isPlaying = false;
  let time = 0;
  let last = 0;
  let generation = 0;

  const named = (/** @type {string} */ name) => CALLED[name] ?? label(name);
  const has = (/** @type {string} */ name) => there?.names.includes(name) ?? false;
  const offered = () => COLOURS.filter(([name, source]) => source !== "snapshots" || has(name));
  const colour = () => offered().find(([name]) => name === query.get("colour")) ?? offered()[0];
  const factor = () => (EXAGGERATIONS.includes(query.get("exaggerate") ?? "") ? Number(query.get("exaggerate")) : 100);
  const speed = () => (SPEEDS.includes(query.get("speed") ?? "") ? Number(query.get("speed")) : 1);
  const kept = () => recording.snapshots.window ?? { from: 0, to: duration };
  const span = () => ordered("from", "to", kept().from, kept().to);
  const depths = () => ordered("top", "bottom", 0, statics.measured_depth.at(-1));

  /** Two numbers of the link in their order, or the whole. @param {string} first @param {string} second @param {number} least @param {number} largest */
  function ordered(first, second, least, largest) {
    const read = (/** @type {string} */ name, /** @type {number} */ usual) => (query.has(name) && Number.isFinite(Number(query.get(name))) ? Number(query.get(name)) : usual);
    const [from, to] = [Math.max(least, read(first, least)), Math.min(largest, read(second, largest))];
    return from < to ? { from, to } : { from: least, to: largest };
  }

  function drawControls() {
    const set = (/** @type {string} */ name, /** @type {() => void} */ then) => (/** @type {string} */ value) => {
      context.keep({ [name]: value });
      then();
    };
    const entry = (/** @type {string} */ text, /** @type {string} */ name, /** @type {number} */ value, /** @type {string} */ quantity, /** @type {() => void} */ then) => {
      const { symbol, size } = unit(quantity);
      const box = h("input", { type: "number", step: "any", value: Number((value / size).toFixed(3)), style: "width:7rem", onchange: () => {
        context.keep({ [name]: box.value === "" ? null : String(Number(box.value) * size) });
        then();
      } });
      return h("label", { class: "field" }, h("span", {}, `${text} [${symbol}]`), box);
    };
    fill(
      controls,
      choice("Colour", offered().map(([name]) => [name, named(name)]), colour()[0], set("colour", () => attend(recolour(), signal))),
      choice("Distance from the axis", EXAGGERATIONS.map((text) => [text, text === "1" ? "to scale" : `${text} times`]), String(factor()), set("exaggerate", show)),
      choice("Speed", SPEEDS.map((text) => [text, text === "1" ? "as it happens" : Number(text) > 1 ? `${text} times` : `1/${Math.round(1 / Number(text))}`]), String(speed()), set("speed", () => {})),
      entry("From depth", "top", depths().from, "measured_depth", show),
      entry("to depth", "bottom", depths().to, "measured_depth", show),
      entry("From", "from", span().from, "time", () => attend(load(), signal)),
      entry("to", "to", span().to, "time", () => attend(load(), signal)),
    );
  }

  async function redraw() {
    there = await snapshotsOf(context);
    if (!there) {
      fill(element, withoutSnapshots(context));
      return;
    }
    statics = (await context.table("statics")).columns;
    geometry = nodeFrames(statics);
    fill(
      element,
      controls,
      wrong,
      h("div", { class: "panel" }, h("figure", {}, scene.element, h("div", { class: "controls player" }, play, slider, clock), legend, caption)),
      h("div", { style: "height:1rem" }),
      h("div", { class: "half" }, has("normal_force") && map.element, has("torque") && turning.element),
    );
    scene.element.addEventListener("keydown", (event) => {
      if (event.key !== " ") return;
      event.preventDefault();
      setPlaying(!isPlaying);
    });
    signal.addEventListener("abort", () => setPlaying(false), { once: true });
    await load();
  }

  /** Takes the snapshots of the window that the link says. */
  async function load() {
    if (!there) return;
    const mine = ++generation;
    wrong.textContent = "";
    drawControls();
    setPlaying(false);
    const names = ["u", "v", ...(has("normal_force") ? ["normal_force"] : [])];
    const taken = await frames(context, names, span(), there.nodes);
    if (mine !== generation) return;
    if (taken.count < 2) {
      wrong.textContent = `There are no two snapshots in this window; the next are ${say("time", there.interval)} apart.`;
      return;
    }
    motion = taken;
    slider.min = String(motion.first);
    slider.max = String(end());
    await recolour();
    go(motion.first);
    await Promise.all([has("normal_force") && map.draw(motion, statics), has("torque") && turning.draw(span(), there.nodes)]);
  }

  const end = () => motion.first + (motion.count - 1) * motion.interval;

  async function recolour() {
    if (!motion || !there) return;
    const mine = generation;
    const [name, source] = colour();
    if (source === "snapshots" && !motion.columns[name]) {
      const further = await frames(context, [name], span(), there.nodes);
      if (mine !== generation) return;
      Object.assign(motion.columns, further.columns);
    }
    const values = source === "profile" ? onNodes((await context.table("profile", { fields: name })).columns, name, there.nodes) : null;
    if (mine !== generation) return;
    if (values) {
      colours = { value: (node) => values[node] ?? 0, range: covered(values.map(Number)) };
    } else if (name === "orbit_radius_rms") {
      const amplitude = amplitudes(motion);
      colours = { value: (node) => amplitude[node], range: [0, Math.max(...amplitude)] };
    } else if (name === "radius") {
      colours = { value: (node) => Math.hypot(...placeOf(node)), range: [0, Math.max(...statics.clearance)] };
    } else {
      const column = motion.columns[name];
      const isForce = name === "normal_force";
      const value = (/** @type {number} */ node) => between(column, node);
      // What touches is as short as a tool joint: it is marked.
      colours = { value, range: isForce ? [0, largestShown(column)] : covered(sampled(column)), isMarked: isForce ? (node) => value(node) > 0 : undefined };
    }
    drawLegend(name);
    show();
  }

  /** @param {string} name */
  function drawLegend(name) {
    const { symbol } = unit(name);
    const [least, largest] = shown(name, colours.range).map((value) => Number(Number(value).toPrecision(3)));
    fill(legend, h("span", { class: "small" }, `${named(name)}${symbol ? ` [${symbol}]` : ""}`), h("span", { class: "small number" }, String(least)), h("span", { class: "gradient", style: `background:${GRADIENT}`, "aria-hidden": "true" }), h("span", { class: "small number" }, String(largest)));
    const all = there && motion.interval > 1.5 * there.interval ? `, every ${Math.round(motion.interval / there.interval)}th of them` : "";
    fill(caption, `${motion.count} snapshots, ${say("time", motion.interval)} apart${all}; between them the motion is drawn straight. The grey line is the string at rest, rings are where it touches the wall; distances from the axis are drawn ${factor() === 1 ? "to scale" : `${factor()} times as large`}.${name === "normal_force" ? ` Dots touch the wall. ${BEYOND}` : ""} Drag to turn, with Shift to shift, scroll to come nearer.`);
  }

  /** A value of a node at the present time, between two snapshots. @param {Float32Array} column @param {number} node */
  function between(column, node) {
    const at = Math.max(0, Math.min(motion.count - 1, (time - motion.first) / motion.interval));
    const frame = Math.min(Math.floor(at), motion.count - 2);
    const [a, b] = [column[frame * motion.nodes + node], column[(frame + 1) * motion.nodes + node]];
    return a + (b - a) * (at - frame);
  }

  /** @param {number} node @returns {[number, number]} */
  function placeOf(node) {
    return [between(motion.columns.u, node), between(motion.columns.v, node)];
  }

  /** Gives the picture what the link says. */
  function show() {
    if (!motion) return;
    const { from, to } = depths();
    const depth = statics.measured_depth;
    const first = Math.max(0, depth.findLastIndex((/** @type {number} */ value) => value <= from));
    const last = depth.findIndex((/** @type {number} */ value) => value >= to);
    scene.show({
      frames: geometry,
      clearance: statics.clearance,
      stretch: [Math.min(first, depth.length - 2), last < 0 ? depth.length - 1 : Math.max(last, first + 1)],
      factor: factor(),
      place: placeOf,
      rest: (node) => [statics.u[node], statics.v[node]],
      ...colours,
    });
    drawLegend(colour()[0]);
  }

  /** @param {number} to [s] */
  function go(to) {
    if (!motion) return;
    time = Math.max(motion.first, Math.min(end(), to));
    slider.value = String(time);
    slider.setAttribute("aria-valuetext", say("time", time));
    clock.textContent = `${time.toFixed(2)} s`;
    scene.paint();
  }

  /** @param {boolean} will */
  function setPlaying(will) {
    if (will === isPlaying || (will && !motion)) return;
    isPlaying = will;
    play.textContent = isPlaying ? "Pause" : "Play";
    if (!isPlaying) return;
    if (time >= end() - 1e-9) time = motion.first;
    last = performance.now();
    requestAnimationFrame(step);
  }

  /** @param {number} now */
  function step(now) {
    if (!isPlaying || signal.aborted) return;
    const next = time + ((now - last) / 1000) * speed();
    last = now;
    go(next);
    if (next >= end()) setPlaying(false);
    else requestAnimationFrame(step);
  }

  return {
    element,
    draw: redraw,
    request: () => {
      const { from, to } = recording.snapshots ? span() : { from: 0, to: duration };
      return { asked: [{ table: "snapshots", query: { from, to, fields: "time,node,u,v,normal_force" } }], python: `snapshots = point.snapshots(time=(${from}, ${to})).to_pandas()\nsnapshots.pivot(index="node", columns="time", values="normal_force")` };
    },
  };
}

/**
 * Root mean square distance of each node from its mean position.
 * @param {Frames} motion
 */
function amplitudes({ nodes, count, columns: { u, v } }) {
  return Array.from({ length: nodes }, (_, node) => {
    const [sums, squares] = [[0, 0], [0, 0]];
    [u, v].forEach((column, part) => {
      // About the first value, so that nothing cancels.
      const start = column[node];
      for (let frame = 0; frame < count; frame += 1) {
        const value = column[frame * nodes + node] - start;
        sums[part] += value;
        squares[part] += value * value;
      }
    });
    return Math.sqrt(Math.max(0, [0, 1].reduce((sum, part) => sum + squares[part] / count - (sums[part] / count) ** 2, 0)));
  });
}

/** @param {Float32Array} values */
function sampled(values) {
  const every = Math.max(1, Math.floor(values.length / SAMPLED));
  return Array.from({ length: Math.ceil(values.length / every) }, (_, index) => values[index * every]);
}

/** The range of all values but the outermost. @param {number[]} values @returns {[number, number]} */
function covered(values) {
  const inOrder = values.filter(Number.isFinite).sort((a, b) => a - b);
  if (!inOrder.length) return [0, 1];
  const at = (/** @type {number} */ part) => inOrder[Math.round(part * (inOrder.length - 1))];
  return [at(1 - COVERED), at(COVERED)];
}
