// Strings moving in their holes, played from snapshots on one clock: that of a point, or of several side by side.

import { colourOf, GRADIENT } from "../draw/colours.js";
import { choice, debounced, fill, h } from "../ui/dom.js";
import { attend } from "../ui/notices.js";
import { inks } from "../draw/plots.js";
import { BEYOND, largestShown } from "./contacts.js";
import { onNodes } from "./well.js";
import { frames } from "../data/snapshots.js";
import { readView, sayView, stringScene } from "../draw/string-scene.js";
import { SvgPen } from "../draw/svg-pen.js";
import { label, say, shown, unit } from "../data/units.js";
import { nodeFrames } from "../data/well-frames.js";

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
const CALLED = {
  normal_force: "contact force",
  orbit_radius_rms: "whirl amplitude",
  radius: "distance from the axis",
};
/** Part of the values that the scale of colours covers. */
const COVERED = 0.995;
/** Values from which that is estimated. */
const SAMPLED = 20_000;
/** How long the view and the time rest before the link holds them. */
const REST_MS = 200;
/** Height of the scale below a picture that is saved, and cells of its colours. */
const [SCALE_HEIGHT, CELLS] = [44, 120];

/** @typedef {import("../data/snapshots.js").Frames} Frames */
/** @typedef {import("./part.js").PointContext} PointContext */
/** @typedef {NonNullable<Awaited<ReturnType<typeof import("../data/snapshots.js").snapshotsOf>>>} There */
/** @typedef {{value: (node: number) => number, range: [number, number], isMarked?: (node: number) => boolean}} Colours */

/**
 * One string.
 * @typedef {object} Actor
 * @property {PointContext} context
 * @property {string} heading empty of one alone
 * @property {There} there
 * @property {any} statics columns of the table
 * @property {ReturnType<typeof nodeFrames>} geometry
 * @property {Frames | null} motion
 * @property {Colours} colours
 * @property {ReturnType<typeof stringScene>} scene
 */

/**
 * @param {{context: PointContext, heading: string, there: There, statics: any}[]} strings of one clock, link and choice of colours
 * @param {(actors: Actor[], span: {from: number, to: number}) => Promise<unknown>} onLoad once the snapshots of a window are there
 */
export function stringPlayer(strings, onLoad) {
  const { query, keep, signal } = strings[0].context;
  const controls = h("div", { class: "controls" });
  const wrong = h("p", { class: "wrong", role: "alert" });
  const legend = h("div", { class: "scale" });
  const caption = h("figcaption", {});
  const play = h("button", { class: "main", onclick: () => setPlaying(!isPlaying) }, "Play");
  const clock = h("output", { class: "number" });
  const slider = h("input", {
    type: "range",
    "aria-label": "Time",
    min: 0,
    max: 1,
    step: "any",
    value: 0,
    style: "flex:1;min-width:8rem",
    oninput: () => {
      setPlaying(false);
      go(Number(slider.value));
    },
  });
  const view = readView(query.get("turn") ?? "");
  const keepView = debounced(() => keep({ turn: sayView(view) || null }), REST_MS, signal);
  const keepTime = debounced(
    () => isPlaying || keep({ time: time > first() ? String(Number(time.toFixed(4))) : null }),
    REST_MS,
    signal,
  );
  /** @type {Actor[]} */
  const actors = strings.map((one) => ({
    ...one,
    geometry: nodeFrames(one.statics),
    motion: null,
    colours: { value: () => 0, range: [0, 1] },
    scene: stringScene(
      `The string moving in its hole${one.heading && `, ${one.heading}`}; arrow keys turn it, + and - change its size, space plays`,
      view,
      () => {
        actors.forEach((actor) => actor.scene.turned());
        keepView();
      },
      signal,
    ),
  }));
  let isPlaying = false;
  let time = 0;
  let last = 0;
  let generation = 0;

  const named = (/** @type {string} */ name) => CALLED[name] ?? label(name);
  const has = (/** @type {string} */ name) => actors.every(({ there }) => there.names.includes(name));
  const offered = () => COLOURS.filter(([name, source]) => source !== "snapshots" || has(name));
  const colour = () => offered().find(([name]) => name === query.get("colour")) ?? offered()[0];
  const factor = () =>
    EXAGGERATIONS.includes(query.get("exaggerate") ?? "") ? Number(query.get("exaggerate")) : 100;
  const speed = () => (SPEEDS.includes(query.get("speed") ?? "") ? Number(query.get("speed")) : 1);
  const kept = () => {
    const windows = actors.map(
      ({ context: { point } }) =>
        point.scenario.recording.snapshots.window ?? { from: 0, to: point.scenario.duration },
    );
    return {
      from: Math.min(...windows.map(({ from }) => from)),
      to: Math.max(...windows.map(({ to }) => to)),
    };
  };
  const span = () => ordered("from", "to", kept().from, kept().to);
  const depths = () =>
    ordered("top", "bottom", 0, Math.max(...actors.map(({ statics }) => statics.measured_depth.at(-1))));
  const moving = () => actors.flatMap(({ motion }) => (motion ? [motion] : []));
  const first = () => Math.min(...moving().map((motion) => motion.first));
  const end = () =>
    Math.max(...moving().map((motion) => motion.first + (motion.count - 1) * motion.interval));

  /** Two numbers of the link in their order, or the whole. @param {string} lower @param {string} upper @param {number} least @param {number} largest */
  function ordered(lower, upper, least, largest) {
    const read = (/** @type {string} */ name, /** @type {number} */ usual) =>
      query.has(name) && Number.isFinite(Number(query.get(name))) ? Number(query.get(name)) : usual;
    const [from, to] = [Math.max(least, read(lower, least)), Math.min(largest, read(upper, largest))];
    return from < to ? { from, to } : { from: least, to: largest };
  }

  function drawControls() {
    const set =
      (/** @type {string} */ name, /** @type {() => void} */ then) => (/** @type {string} */ value) => {
        keep({ [name]: value });
        then();
      };
    const entry = (
      /** @type {string} */ text,
      /** @type {string} */ name,
      /** @type {number} */ value,
      /** @type {string} */ quantity,
      /** @type {() => void} */ then,
    ) => {
      const { symbol, size } = unit(quantity);
      const box = h("input", {
        type: "number",
        step: "any",
        value: Number((value / size).toFixed(3)),
        style: "width:7rem",
        onchange: () => {
          keep({ [name]: box.value === "" ? null : String(Number(box.value) * size) });
          then();
        },
      });
      return h("label", { class: "field" }, h("span", {}, `${text} [${symbol}]`), box);
    };
    fill(
      controls,
      choice(
        "Colour",
        offered().map(([name]) => [name, named(name)]),
        colour()[0],
        set("colour", () => attend(recolour(), signal)),
      ),
      choice(
        "Distance from the axis",
        EXAGGERATIONS.map((text) => [text, text === "1" ? "to scale" : `${text} times`]),
        String(factor()),
        set("exaggerate", show),
      ),
      choice(
        "Speed",
        SPEEDS.map((text) => [
          text,
          text === "1"
            ? "as it happens"
            : Number(text) > 1
              ? `${text} times`
              : `1/${Math.round(1 / Number(text))}`,
        ]),
        String(speed()),
        set("speed", () => {}),
      ),
      entry("From depth", "top", depths().from, "measured_depth", show),
      entry("to depth", "bottom", depths().to, "measured_depth", show),
      entry("From", "from", span().from, "time", () => attend(load(), signal)),
      entry("to", "to", span().to, "time", () => attend(load(), signal)),
      h("button", { onclick: () => save("png"), "aria-label": "Save the string as PNG" }, "Save as PNG"),
      h("button", { onclick: () => save("svg"), "aria-label": "Save the string as SVG" }, "Save as SVG"),
    );
  }

  /** Takes the snapshots of the window that the link says. */
  async function load() {
    const mine = ++generation;
    wrong.textContent = "";
    drawControls();
    setPlaying(false);
    const names = ["u", "v", ...(has("normal_force") ? ["normal_force"] : [])];
    const taken = await Promise.all(
      actors.map(({ context, there }) => frames(context, names, span(), there.nodes)),
    );
    if (mine !== generation) return;
    const still = actors.find((_, order) => taken[order].count < 2);
    if (still) {
      wrong.textContent = `There are no two snapshots${still.heading && ` of ${still.heading}`} in this window; the next are ${say("time", still.there.interval)} apart.`;
      return;
    }
    actors.forEach((actor, order) => (actor.motion = taken[order]));
    slider.min = String(first());
    slider.max = String(end());
    await recolour();
    const asked = Number(query.get("time") ?? NaN);
    go(Number.isFinite(asked) ? asked : first());
    await onLoad(actors, span());
  }

  async function recolour() {
    if (!moving().length) return;
    const mine = generation;
    const [name, source] = colour();
    const found = await Promise.all(actors.map((actor) => coloursOf(actor, name, source)));
    if (mine !== generation || name !== colour()[0]) return;
    /** @type {[number, number]} */
    const range = [
      Math.min(...found.map((one) => one.range[0])),
      Math.max(...found.map((one) => one.range[1])),
    ];
    actors.forEach((actor, order) => (actor.colours = { ...found[order], range }));
    show();
  }

  /**
   * @param {Actor} actor @param {string} name @param {string} source
   * @returns {Promise<Colours>}
   */
  async function coloursOf(actor, name, source) {
    const { context, statics, there } = actor;
    const motion = /** @type {Frames} */ (actor.motion);
    if (source === "profile") {
      const values = onNodes((await context.table("profile", { fields: name })).columns, name, there.nodes);
      return { value: (node) => values[node] ?? 0, range: covered(values.flatMap((value) => value ?? [])) };
    }
    if (source === "snapshots" && !motion.columns[name])
      Object.assign(motion.columns, (await frames(context, [name], span(), there.nodes)).columns);
    if (name === "orbit_radius_rms") {
      const amplitude = amplitudes(motion);
      return { value: (node) => amplitude[node], range: [0, Math.max(...amplitude)] };
    }
    if (name === "radius")
      return {
        value: (node) => Math.hypot(...placeOf(motion, node)),
        range: [0, Math.max(...statics.clearance)],
      };
    const column = motion.columns[name];
    const isForce = name === "normal_force";
    const value = (/** @type {number} */ node) => between(motion, column, node);
    // What touches is as short as a tool joint: it is marked.
    return {
      value,
      range: isForce ? [0, largestShown(column)] : covered(sampled(column)),
      isMarked: isForce ? (node) => value(node) > 0 : undefined,
    };
  }

  /** The name of what colours, and the ends of its scale, in words. */
  function scaleWords() {
    const [name] = colour();
    const { symbol } = unit(name);
    const [least, largest] = shown(name, actors[0].colours.range).map((value) =>
      String(Number(Number(value).toPrecision(3))),
    );
    return { text: `${named(name)}${symbol ? ` [${symbol}]` : ""}`, least, largest };
  }

  function drawLegend() {
    const { text, least, largest } = scaleWords();
    fill(
      legend,
      h("span", { class: "small" }, text),
      h("span", { class: "small number" }, least),
      h("span", { class: "gradient", style: `background:${GRADIENT}`, "aria-hidden": "true" }),
      h("span", { class: "small number" }, largest),
    );
    const counts = actors.map(({ motion, there, heading }) => {
      if (!motion) return "";
      const all =
        motion.interval > 1.5 * there.interval
          ? `, every ${Math.round(motion.interval / there.interval)}th of them`
          : "";
      return `${heading && `${heading}: `}${motion.count} snapshots, ${say("time", motion.interval)} apart${all}`;
    });
    fill(
      caption,
      `${counts.join("; ")}; between them the motion is drawn straight. The grey line is the string at rest, the dashed one the axis of the hole with marks of measured depth beside it, rings are where the string touches the wall; distances from the axis are drawn ${factor() === 1 ? "to scale" : `${factor()} times as large`}.${colour()[0] === "normal_force" ? ` Dots touch the wall. ${BEYOND}` : ""} Drag to turn, with Shift to shift, scroll to come nearer.`,
    );
  }

  /** A value of a node at the present time, between two snapshots. @param {Frames} motion @param {Float32Array} column @param {number} node */
  function between(motion, column, node) {
    const at = Math.max(0, Math.min(motion.count - 1, (time - motion.first) / motion.interval));
    const frame = Math.min(Math.floor(at), motion.count - 2);
    const [a, b] = [column[frame * motion.nodes + node], column[(frame + 1) * motion.nodes + node]];
    return a + (b - a) * (at - frame);
  }

  /** @param {Frames} motion @param {number} node @returns {[number, number]} */
  function placeOf(motion, node) {
    return [between(motion, motion.columns.u, node), between(motion, motion.columns.v, node)];
  }

  /** Gives the pictures what the link says. */
  function show() {
    const { from, to } = depths();
    for (const { motion, statics, scene, geometry, colours } of actors) {
      if (!motion) continue;
      const depth = statics.measured_depth;
      const upper = Math.max(
        0,
        depth.findLastIndex((/** @type {number} */ value) => value <= from),
      );
      const lower = depth.findIndex((/** @type {number} */ value) => value >= to);
      scene.show({
        frames: geometry,
        clearance: statics.clearance,
        depth: { values: shown("measured_depth", depth).map(Number), symbol: unit("measured_depth").symbol },
        stretch: [
          Math.min(upper, depth.length - 2),
          lower < 0 ? depth.length - 1 : Math.max(lower, upper + 1),
        ],
        factor: factor(),
        place: (node) => placeOf(motion, node),
        rest: (node) => [statics.u[node], statics.v[node]],
        ...colours,
      });
    }
    drawLegend();
  }

  /** @param {number} to [s] */
  function go(to) {
    if (!moving().length) return;
    time = Math.max(first(), Math.min(end(), to));
    slider.value = String(time);
    slider.setAttribute("aria-valuetext", say("time", time));
    clock.textContent = `${time.toFixed(2)} s`;
    actors.forEach(({ scene }) => scene.paint());
    keepTime();
  }

  /** @param {boolean} will */
  function setPlaying(will) {
    if (will === isPlaying || (will && !moving().length)) return;
    isPlaying = will;
    play.textContent = isPlaying ? "Pause" : "Play";
    if (!isPlaying) return keepTime();
    if (time >= end() - 1e-9) time = first();
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

  /**
   * All that is shown, one string below the other, with its scale and the time.
   * @param {import("../draw/svg-pen.js").Pen} pen @param {number} width @param {number} height
   */
  function drawFile(pen, width, height) {
    const { panel, text } = inks();
    pen.fillStyle = panel;
    pen.fillRect(0, 0, width, height);
    for (const { scene, heading } of actors) {
      scene.drawWith(pen);
      pen.fillStyle = text;
      pen.font = "14px system-ui, sans-serif";
      pen.textAlign = "left";
      pen.fillText(heading, 12, 20);
      pen.translate(0, scene.element.clientHeight);
    }
    const words = scaleWords();
    pen.font = "13px system-ui, sans-serif";
    pen.textBaseline = "middle";
    pen.fillStyle = text;
    pen.textAlign = "left";
    const middle = SCALE_HEIGHT / 2;
    pen.fillText(`${clock.textContent}   ${words.text}`, 12, middle);
    const [left, right] = [width * 0.45, width * 0.85];
    pen.textAlign = "right";
    pen.fillText(words.least, left - 8, middle);
    pen.textAlign = "left";
    pen.fillText(words.largest, right + 8, middle);
    for (let cell = 0; cell < CELLS; cell += 1) {
      pen.fillStyle = colourOf(cell, [0, CELLS - 1]);
      pen.fillRect(left + ((right - left) * cell) / CELLS, middle - 6, (right - left) / CELLS + 0.5, 12);
    }
  }

  /** @param {"png" | "svg"} format */
  function save(format) {
    const width = Math.max(...actors.map(({ scene }) => scene.element.clientWidth));
    const height = actors.reduce((sum, { scene }) => sum + scene.element.clientHeight, SCALE_HEIGHT);
    const name = `string-in-motion-${clock.textContent?.replace(/[^\d.]+/g, "")}-s`;
    if (format === "svg") {
      const pen = new SvgPen(width, height);
      drawFile(pen, width, height);
      return download(new Blob([String(pen)], { type: "image/svg+xml" }), `${name}.svg`);
    }
    const canvas = h("canvas", { width: 2 * width, height: 2 * height });
    const pen = /** @type {CanvasRenderingContext2D} */ (canvas.getContext("2d"));
    pen.scale(2, 2);
    drawFile(pen, width, height);
    canvas.toBlob((blob) => blob && download(blob, `${name}.png`), "image/png");
  }

  const panels = actors.map(({ scene, heading }) => {
    scene.element.addEventListener("keydown", (event) => {
      if (event.key !== " ") return;
      event.preventDefault();
      setPlaying(!isPlaying);
    });
    return h("figure", {}, heading && h("h2", {}, heading), scene.element);
  });
  signal.addEventListener("abort", () => setPlaying(false), { once: true });

  return {
    element: h(
      "div",
      {},
      controls,
      wrong,
      h(
        "div",
        { class: "panel" },
        h("div", { class: actors.length > 1 ? "half" : "" }, panels),
        h("div", { class: "controls player" }, play, slider, clock),
        legend,
        caption,
      ),
    ),
    load,
    span,
    /** Stops at a time. @param {number} to [s] */
    stopAt(to) {
      setPlaying(false);
      go(to);
    },
  };
}

/**
 * Gives the reader a file.
 * @param {Blob} blob
 * @param {string} name
 */
function download(blob, name) {
  const url = URL.createObjectURL(blob);
  h("a", { href: url, download: name }).click();
  setTimeout(() => URL.revokeObjectURL(url), 10_000);
}

/**
 * Root mean square distance of each node from its mean position.
 * @param {Frames} motion
 */
function amplitudes({ nodes, count, columns: { u, v } }) {
  return Array.from({ length: nodes }, (_, node) => {
    const [sums, squares] = [
      [0, 0],
      [0, 0],
    ];
    [u, v].forEach((column, part) => {
      // About the first value, so that nothing cancels.
      const start = column[node];
      for (let frame = 0; frame < count; frame += 1) {
        const value = column[frame * nodes + node] - start;
        sums[part] += value;
        squares[part] += value * value;
      }
    });
    return Math.sqrt(
      Math.max(
        0,
        [0, 1].reduce((sum, part) => sum + squares[part] / count - (sums[part] / count) ** 2, 0),
      ),
    );
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
