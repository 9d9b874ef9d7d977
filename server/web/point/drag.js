// Torque and drag over bit depth: hook load and surface torque by motion and friction factor, of the soft or the stiff string.

import { Problem } from "../data/api.js";
import { aligner } from "../data/columns.js";
import { placedSections } from "../data/string-parts.js";
import { inputUnit, label, number, say, shown, title } from "../data/units.js";
import { canvas, DASHES, draw, LINES } from "../draw/plots.js";
import { choice, fill, h } from "../ui/dom.js";
import { generations } from "../ui/generations.js";
import { attend } from "../ui/notices.js";
import { python } from "../ui/snippets.js";
import { scrolled } from "./profiles.js";

/** Motions of the string; those of the usual broomstick first. */
const MOTIONS = ["pick_up", "slack_off", "rotate", "drill", "slide", "ream"];
const USUAL_MOTIONS = MOTIONS.slice(0, 3);
/** Bit depths of a soft and of a stiff string: a case of the stiff one is an equilibrium of finite elements. */
const USUAL_COUNT = { soft: 40, stiff: 4 };
/** Columns over bit depth, side by side. */
const DRAWN = ["hook_load", "surface_torque"];
/** Columns of the table at the deepest bit, with the depths at which margins are least. */
const TABLED = [
  ...DRAWN,
  "largest_yield_ratio",
  "overpull_margin",
  "largest_make_up_ratio",
  "largest_buckling_ratio",
];
/** Width that a picture needs for its ticks and its name [pixels]. */
const LEAST_WIDTH = 280;
/** Points of a line up to which they are marked. */
const MARKED = 12;
/** Significant digits of the table. */
const DIGITS = 4;

/** Bit depths of equal steps [m]. @typedef {{from: number, to: number, count: number}} Depths */
/** Choices of the view. @typedef {{motions: string[], friction: number[], depths: Depths, string: "soft" | "stiff", travelling: number, ream: number | null}} Choices */
/** A motion with a friction factor, null for those of the hole sections, over bit depth. @typedef {{motion: string, friction: number | null, rows: number[]}} DragLine */

/**
 * Choices of a link; those that are none are the usual ones.
 * @param {URLSearchParams} query of the link
 * @param {number} bit depth of the bit [m]
 * @returns {Choices}
 */
export function choicesOf(query, bit) {
  const given = (query.get("motions") ?? "").split(",");
  const motions = MOTIONS.filter((motion) => given.includes(motion));
  const string = query.get("string") === "stiff" ? "stiff" : "soft";
  const count = USUAL_COUNT[string];
  const ream = parseFloat(query.get("ream") ?? "");
  return {
    motions: motions.length ? motions : USUAL_MOTIONS,
    friction: frictionOf(query.get("friction") ?? "") ?? [],
    depths: depthsOf(query.get("bit") ?? "") ?? { from: bit / count, to: bit, count },
    string,
    travelling: Math.max(0, Number(query.get("travelling"))) || 0,
    ream: Number.isFinite(ream) ? ream : null,
  };
}

/** Friction factors that a text lists; null if it lists anything else. @param {string} text @returns {number[] | null} */
export function frictionOf(text) {
  const factors = text.split(/[\s,;]+/).filter(Boolean);
  const numbers = factors.map(Number);
  return numbers.every((factor) => Number.isFinite(factor) && factor >= 0) ? numbers : null;
}

/** Depths of `FROM:TO:COUNT`; null of another text. @param {string} text @returns {Depths | null} */
export function depthsOf(text) {
  const [from, to, count, ...others] = text.split(":").map(Number);
  const isValid = from > 0 && from <= to && count >= 1 && Number.isInteger(count) && !others.length;
  return isValid && Number.isFinite(to) ? { from, to, count } : null;
}

/**
 * Query of the service for some choices.
 * @param {Choices} choices
 * @returns {Record<string, string>}
 */
export function requested({ motions, friction, depths: { from, to, count }, string, travelling, ream }) {
  return {
    modes: motions.join(","),
    depths: count === 1 ? String(to) : `${from}:${to}:${count}`,
    ...(friction.length ? { friction: friction.join(",") } : {}),
    ...(travelling ? { travelling_weight: String(travelling) } : {}),
    ...(motions.includes("ream") && ream !== null ? { axial_speed: String(ream) } : {}),
    ...(string === "stiff" ? { stiff: "true" } : {}),
  };
}

/**
 * Lines of a table, whose rows are in the order of motions, friction factors and bit depths.
 * @param {Record<string, any[]>} columns
 * @returns {DragLine[]}
 */
export function linesOf(columns) {
  /** @type {DragLine[]} */
  const lines = [];
  columns.drag_mode.forEach((/** @type {string} */ motion, row) => {
    const friction = columns.friction_factor[row];
    const last = lines.at(-1);
    if (last?.motion === motion && last.friction === friction) last.rows.push(row);
    else lines.push({ motion, friction, rows: [row] });
  });
  return lines;
}

/** @param {DragLine} line */
function nameOf({ motion, friction }) {
  return friction === null ? words(motion) : `${words(motion)}, ${number(friction)}`;
}

/** @param {string} motion */
function words(motion) {
  return motion.replaceAll("_", " ");
}

/**
 * @param {import("./part.js").PointContext} context
 * @returns {import("./part.js").PointPart}
 */
export function drag(context) {
  const place = canvas("Hook load and surface torque over bit depth", "drag", "tall");
  const caption = h("figcaption", { "aria-live": "polite" });
  const wrong = h("p", { class: "wrong", role: "alert" });
  const controls = h("div", {});
  const table = h("div", {});
  const begin = generations();
  const { query } = context;
  const { string } = context.point.scenario;
  const bit = placedSections(string).reduce((deepest, { bottom }) => Math.max(deepest, bottom), 0);
  const choices = () => choicesOf(query, bit);
  const change = (/** @type {Record<string, string | null>} */ changes) => {
    wrong.textContent = "";
    context.keep(changes);
    fill(
      controls,
      controlsOf(choices(), change, (text) => (wrong.textContent = text)),
    );
    attend(redraw(), context.signal);
  };
  fill(
    controls,
    controlsOf(choices(), change, (text) => (wrong.textContent = text)),
  );

  async function redraw() {
    const isNewest = begin();
    const chosen = choices();
    let columns;
    try {
      if (chosen.motions.includes("ream") && chosen.ream === null) {
        wrong.textContent = "Reaming requires an axial speed, negative upwards.";
        return;
      }
      fill(caption, chosen.string === "stiff" ? "The service computes equilibria of the stiff string…" : "");
      ({ columns } = await context.table("torque_drag", requested(chosen)));
    } catch (error) {
      if (!(error instanceof Problem)) throw error;
      if (!isNewest()) return;
      fill(caption);
      wrong.textContent = error.errors[0]?.detail ?? error.message;
      return;
    }
    if (!isNewest()) return;
    wrong.textContent = "";
    const lines = linesOf(columns);
    fill(caption, sentences(chosen));
    fill(table, tableOf(columns, lines));
    await drawLines(place, columns, lines, context.signal);
  }

  return {
    element: h(
      "div",
      {},
      h("h2", {}, "Torque and drag"),
      controls,
      wrong,
      h("figure", {}, scrolled(place), caption),
      table,
    ),
    draw: redraw,
    request: () => ({
      asked: [{ table: "torque_drag", query: requested(choices()) }],
      python: pythonOf(choices()),
    }),
  };
}

/** @param {Choices} choices */
function sentences({ friction, string }) {
  const model =
    string === "stiff"
      ? "Stiff string: equilibria of the finite elements, with bending stiffness, clearance and the flow of the mud."
      : "Soft string: without bending stiffness, on the axis of the hole, in still mud.";
  const factors = friction.length
    ? "Each friction factor is that of the whole hole."
    : "Friction factors are the dynamic ones of the hole sections.";
  return `${model} ${factors} For a bit above the end of the string pipe is missing at the top.`;
}

/** Keeps changes of the choices in the link. @typedef {(changes: Record<string, string | null>) => void} Change */
/** Shows why a choice is refused. @typedef {(text: string) => void} Refuse */

/** @param {Choices} choices @param {Change} change @param {Refuse} refuse */
function controlsOf(choices, change, refuse) {
  const { motions, friction, string, travelling, ream } = choices;
  const factors = h("input", {
    type: "text",
    value: friction.join(", "),
    placeholder: "of the hole sections",
    "aria-label": "Friction factors",
    onchange: () => {
      const numbers = frictionOf(factors.value);
      if (numbers) change({ friction: numbers.join(",") || null });
      else refuse("Friction factors must be numbers of 0 or greater, separated by commas.");
    },
  });
  const strings = /** @type {[string, string][]} */ ([
    ["soft", "soft"],
    ["stiff", "stiff"],
  ]);
  const weight = quantityBox("Travelling weight", "hook_load", travelling, (value) =>
    value >= 0
      ? change({ travelling: value ? String(value) : null })
      : refuse("The travelling weight must be 0 or greater."),
  );
  const speed = quantityBox("Axial speed of reaming", "annulus_speed", ream, (value) =>
    change({ ream: String(value) }),
  );
  return [
    h("div", { class: "controls", role: "group", "aria-label": "Motions" }, motionTicks(motions, change)),
    h(
      "div",
      { class: "controls" },
      h("label", { class: "field" }, h("span", {}, "Friction factors"), factors),
      depthBoxes(choices, change, refuse),
      choice("String", strings, string, (value) => change({ string: value === "stiff" ? value : null })),
      weight,
      motions.includes("ream") && speed,
    ),
  ];
}

/** @param {string[]} motions @param {Change} change */
function motionTicks(motions, change) {
  return MOTIONS.map((motion) => {
    const box = h("input", {
      type: "checkbox",
      checked: motions.includes(motion),
      onchange: () => {
        const chosen = MOTIONS.filter((one) => (one === motion ? box.checked : motions.includes(one)));
        change({ motions: chosen.join(",") || null });
      },
    });
    return h("label", { class: "tick" }, box, words(motion));
  });
}

/** @param {Choices} choices @param {Change} change @param {Refuse} refuse */
function depthBoxes({ depths }, change, refuse) {
  const { symbol, size } = inputUnit("bit_depth");
  // A field that is not edited keeps its depth, of which it shows millimetres.
  const edited = { ...depths };
  const box = (/** @type {string} */ text, /** @type {keyof Depths} */ name) => {
    const scale = name === "count" ? 1 : size;
    const input = h("input", {
      type: "number",
      step: "any",
      min: 0,
      value: Number((depths[name] / scale).toFixed(3)),
      onchange: () => {
        edited[name] = Number(input.value) * scale;
        const bit = `${edited.from}:${edited.to}:${edited.count}`;
        if (depthsOf(bit)) change({ bit });
        else refuse("Bit depths must be above 0, the shallowest first, and one or more.");
      },
    });
    return h("label", { class: "field" }, h("span", {}, text), input);
  };
  return [
    box(`Shallowest bit depth [${symbol}]`, "from"),
    box(`Deepest bit depth [${symbol}]`, "to"),
    box("Number of bit depths", "count"),
  ];
}

/**
 * A number in the unit in which its quantity is entered.
 * @param {string} text
 * @param {string} quantity
 * @param {number | null} value as it is served
 * @param {(value: number) => void} onChange
 */
function quantityBox(text, quantity, value, onChange) {
  const { symbol, size } = inputUnit(quantity);
  const box = h("input", {
    type: "number",
    step: "any",
    value: value === null ? "" : Number((value / size).toPrecision(12)),
    onchange: () => onChange(Number(box.value) * size),
  });
  return h("label", { class: "field" }, h("span", {}, `${text} [${symbol}]`), box);
}

/**
 * Forces and margins at the deepest bit, a row for each line; margins that the string has no numbers of are left out.
 * @param {Record<string, any[]>} columns
 * @param {DragLine[]} lines
 */
function tableOf(columns, lines) {
  const deepest = lines.map(({ rows }) =>
    rows.reduce((most, row) => (columns.bit_depth[row] > columns.bit_depth[most] ? row : most)),
  );
  const names = TABLED.filter((name) => deepest.some((row) => columns[name][row] !== null));
  const cells = names.map((name) => {
    const values = shown(
      name,
      deepest.map((row) => columns[name][row]),
    );
    const written = aligner(
      values.filter((value) => value !== null),
      DIGITS,
    );
    return values.map((value) => (value === null ? "–" : written(value)));
  });
  return [
    h("h2", {}, `Bit at ${say("bit_depth", columns.bit_depth[deepest[0]])}`),
    h(
      "div",
      { class: "scroll", tabindex: "0", role: "region", "aria-label": "Forces and margins, scrollable" },
      h(
        "table",
        { "aria-label": "Forces and margins at the deepest bit" },
        h(
          "thead",
          {},
          h(
            "tr",
            {},
            h("th", { scope: "col" }, "motion, friction factor"),
            names.map((name) => h("th", { class: "number", scope: "col" }, title(name))),
          ),
        ),
        h(
          "tbody",
          {},
          lines.map((line, row) =>
            h(
              "tr",
              {},
              h("th", { scope: "row" }, nameOf(line)),
              cells.map((column) => h("td", { class: "number" }, column[row])),
            ),
          ),
        ),
      ),
    ),
  ];
}

/**
 * Draws both columns side by side over bit depth, which grows downwards: a colour for each motion, a dash for each friction factor.
 * @param {HTMLElement} place
 * @param {Record<string, any[]>} columns
 * @param {DragLine[]} lines
 * @param {AbortSignal} signal
 */
function drawLines(place, columns, lines, signal) {
  place.style.minWidth = `${DRAWN.length * LEAST_WIDTH}px`;
  const motions = [...new Set(lines.map(({ motion }) => motion))];
  const factors = [...new Set(lines.map(({ friction }) => friction))];
  const traces = DRAWN.flatMap((name, panel) =>
    lines.map((line) => {
      const pick = (/** @type {string} */ column) =>
        shown(
          column,
          line.rows.map((row) => columns[column][row]),
        );
      const colour = LINES[motions.indexOf(line.motion) % LINES.length];
      return {
        type: "scatter",
        mode: line.rows.length > MARKED ? "lines" : "lines+markers",
        name: nameOf(line),
        legendgroup: nameOf(line),
        x: pick(name),
        y: pick("bit_depth"),
        xaxis: panel ? "x2" : "x",
        yaxis: "y",
        line: { color: colour, dash: DASHES[factors.indexOf(line.friction) % DASHES.length], width: 1.4 },
        marker: { color: colour, size: 6 },
        showlegend: panel === 0,
        describe: (/** @type {{x: number, y: number}} */ { x, y }) =>
          `${nameOf(line)}, bit at ${number(y)}: ${label(name)} ${number(x)}`,
      };
    }),
  );
  const layout = {
    showlegend: true,
    yaxis: { title: title("bit_depth"), quantity: "bit_depth", autorange: "reversed", zeroline: false },
    xaxis: { title: title(DRAWN[0]), quantity: DRAWN[0], domain: [0, 0.48], anchor: "y" },
    xaxis2: { title: title(DRAWN[1]), quantity: DRAWN[1], domain: [0.52, 1], anchor: "y" },
  };
  return draw(place, traces, layout, signal);
}

/** Line of the Python client. @param {Choices} choices */
function pythonOf({ motions, friction, depths: { from, to, count }, string, travelling, ream }) {
  const step = (to - from) / Math.max(1, count - 1);
  const given = [
    `modes=${python(motions)}`,
    `depths=${count === 1 ? `[${to}]` : `[${from} + ${step} * i for i in range(${count - 1})] + [${to}]`}`,
    ...(friction.length ? [`friction=${python(friction)}`] : []),
    ...(travelling ? [`travelling_weight=${travelling}`] : []),
    ...(motions.includes("ream") && ream !== null ? [`axial_speed=${ream}`] : []),
    ...(string === "stiff" ? ["stiff=True"] : []),
  ];
  return `drag = point.torque_drag(${given.join(", ")}).to_pandas()`;
}
