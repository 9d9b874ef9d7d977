// Quantities over depth, side by side with one depth cursor.

import { roomyRange } from "../data/columns.js";
import { nodeTables } from "../data/motion-requests.js";
import { signRules } from "../data/signs.js";
import { partsOf } from "../data/string-parts.js";
import { label, meaning, number, say, shown, title, unit } from "../data/units.js";
import { DepthCursor, nearest } from "../draw/depth-cursor.js";
import { canvas, draw, laidOut, LINES } from "../draw/plots.js";
import { AXIS, recordedAt, sayTrack, TRACK, trackAxis, trackTraces } from "../draw/string-track.js";
import { fill, h } from "../ui/dom.js";
import { generations } from "../ui/generations.js";
import { attend } from "../ui/notices.js";
import { python } from "../ui/snippets.js";

/** Quantities over depth, and the table that has each. @type {[string, string][]} */
export const QUANTITIES = [
  ["friction_coefficient", "profile"],
  ["rotation_damping", "profile"],
  ["eccentricity", "profile"],
  ["effective_tension", "profile"],
  ["torque", "profile"],
  ["normal_force", "statics"],
  ["largest_normal_force", "contacts"],
  ["contact_time", "contacts"],
  ["stick_time", "contacts"],
  ["largest_radius", "contacts"],
  ["orbit_radius_rms", "loads"],
  ["lateral_acceleration_rms", "loads"],
  ["lateral_acceleration_peak", "loads"],
  ["tangential_acceleration_peak", "loads"],
  ["stick_slip_severity", "loads"],
  ["side_force", "loads"],
  ["bending_moment_peak", "loads"],
  ["equivalent_stress_peak", "loads"],
  ["buckling_ratio", "profile"],
  ["annulus_speed", "profile"],
  ["reynolds_number", "profile"],
  ["annulus_pressure", "profile"],
  ["bore_pressure", "profile"],
  ["friction_gradient", "profile"],
  ["radius", "statics"],
];

const USUAL = [
  "friction_coefficient",
  "rotation_damping",
  "eccentricity",
  "effective_tension",
  "torque",
  "largest_normal_force",
];

/**
 * A quantity over measured depth: of elements as steps over their ends, of nodes as they are.
 * @param {string} name
 * @param {any} table
 * @returns {{value: (number | null)[], depth: (number | null)[]}} in the units in which they are shown
 */
export function overDepth(name, table) {
  const { columns } = table;
  const value = shown(name, columns[name]);
  if (columns.measured_depth) return { value, depth: shown("measured_depth", columns.measured_depth) };
  const [top, bottom] = [
    shown("measured_depth", columns.measured_depth_top),
    shown("measured_depth", columns.measured_depth_bottom),
  ];
  return {
    value: value.flatMap((entry) => [entry, entry]),
    depth: top.flatMap((entry, index) => [entry, bottom[index]]),
  };
}

/** Room of an axis beyond its values on either side, as a part of their range, so that no curve lies on the frame. */
const ROOM = 0.04;
/** Width that a profile needs for its name and its ticks [pixels]. */
const LEAST_WIDTH = 150;

/**
 * A place of profiles that is as wide as they need: where a screen is narrower, it is scrolled sideways.
 * @param {HTMLElement} place
 */
export function scrolled(place) {
  return h(
    "div",
    { class: "scroll", tabindex: "0", role: "region", "aria-label": "Profiles, scrollable" },
    place,
  );
}

/** A string to be drawn next to profiles, and depths of recorded nodes [m]. @typedef {{parts: import("../data/string-parts.js").Part[], nodes: number[]}} Track */

/**
 * Several quantities side by side over one depth axis that grows downwards.
 * @param {HTMLElement} place
 * @param {string[]} names
 * @param {{table: (name: string) => any, colour: string, dash: string, name: string}[]} points tables by quantity
 * @param {Track | null} track the string at the left, on the same axis
 * @param {AbortSignal} signal
 */
export async function drawProfiles(place, names, points, track, signal) {
  const [room, margins] = [track ? TRACK : 0, { l: 64, r: 12 }];
  place.style.minWidth = `${room + names.length * LEAST_WIDTH}px`;
  await laidOut(place, signal);
  const start = room / Math.max(1, place.clientWidth - margins.l - margins.r);
  const traces = names.flatMap((name, column) =>
    points.flatMap((point, order) => {
      const table = point.table(name);
      if (!table?.columns[name]) return [];
      const { value, depth } = overDepth(name, table);
      return [
        {
          type: "scatter",
          mode: "lines",
          x: value,
          y: depth,
          xaxis: `x${column ? column + 1 : ""}`,
          yaxis: "y",
          name: point.name,
          meta: name,
          legendgroup: String(order),
          showlegend: column === 0 && points.length > 1,
          line: { color: point.colour, dash: point.dash, width: 1.4 },
          describe: (/** @type {{x: number}} */ { x }) => number(x),
        },
      ];
    }),
  );
  const rangeOfAxis = (/** @type {string} */ axis) =>
    roomyRange(
      traces.flatMap((trace) => (trace.xaxis === axis ? trace.x : [])),
      ROOM,
    );
  const depths = roomyRange(
    traces.flatMap(({ y }) => y),
    ROOM,
  );
  const width = (1 - start) / names.length;
  const gap = Math.min(0.03, width / 6);
  const margin = { ...margins, t: points.length > 1 ? 40 : 12, b: 60 };
  const [shallowest, deepest] = depths ?? [0, 1];
  const height = place.clientHeight - margin.t - margin.b;
  const perMetre = height / ((deepest - shallowest) * unit("measured_depth").size);
  const layout = {
    hovermode: "y",
    margin,
    ...(track ? trackAxis(start) : {}),
    yaxis: {
      title: title("measured_depth"),
      quantity: "measured_depth",
      ...(depths ? { range: depths.toReversed() } : { autorange: "reversed" }),
      zeroline: false,
      ...(track ? { anchor: AXIS } : {}),
    },
    ...Object.fromEntries(
      names.map((name, column) => [
        `xaxis${column ? column + 1 : ""}`,
        {
          title: wrapped(title(name)),
          quantity: name,
          domain: [
            start + column * width + (column ? gap : 0),
            start + (column + 1) * width - (column === names.length - 1 ? 0 : gap / 2),
          ],
          anchor: "y",
          nticks: 5,
          range: rangeOfAxis(`x${column ? column + 1 : ""}`),
        },
      ]),
    ),
  };
  const string = track ? trackTraces(track.parts, track.nodes, perMetre) : [];
  return draw(place, [...traces, ...string], layout, signal);
}

/** @param {string} text */
function wrapped(text) {
  const middle = text.indexOf(" [");
  if (text.length < 18) return text;
  // Before the unit, or else before the symbol.
  const at = middle > 0 ? middle : text.lastIndexOf(" ");
  return at > 0 ? `${text.slice(0, at)}<br>${text.slice(at + 1)}` : text;
}

/**
 * Ticks by which quantities are chosen; the choice stands in the link.
 * @param {string} chosen from the link
 * @param {(names: string[]) => void} onChange
 */
export function quantityTicks(chosen, onChange) {
  const asked = chosen.split(",").filter((name) => QUANTITIES.some(([entry]) => entry === name));
  const names = new Set(asked.length ? asked : USUAL);
  const inOrder = () => QUANTITIES.map(([name]) => name).filter((name) => names.has(name));
  const ticks = QUANTITIES.map(([name]) => {
    const box = h("input", {
      type: "checkbox",
      checked: names.has(name),
      onchange: () => {
        if (box.checked) names.add(name);
        else names.delete(name);
        if (names.size) onChange(inOrder());
      },
    });
    return h("label", { class: "tick small", title: meaning(name) }, box, label(name));
  });
  return {
    element: h("details", {}, h("summary", {}, "Quantities"), h("div", { class: "controls" }, ticks)),
    names: inOrder,
  };
}

/**
 * @param {import("./part.js").PointContext} context
 * @returns {import("./part.js").PointPart}
 */
export function profiles(context) {
  const place = canvas("Profiles over measured depth", "profiles", "tall");
  const ticks = quantityTicks(context.query.get("profiles") ?? "", (names) => {
    context.keep({ profiles: names.join(",") });
    attend(redraw(), context.signal);
  });
  /** @type {Record<string, any>} */
  const tables = {};
  const cursor = new DepthCursor(place, context, (depth, points) =>
    reading(ticks.names(), (name) => tables[tableOf(name)], depth, points),
  );
  const begin = generations();
  const caption = h("figcaption", {});
  const { scenario } = context.point;
  const parts = partsOf(scenario.string);

  async function redraw() {
    const isNewest = begin();
    const names = ticks.names();
    const needed = new Set(names.map(tableOf));
    const [statics] = await Promise.all([
      // The overview reads the same.
      context.table(...nodeTables(scenario, context.query)[0]),
      ...[...needed].map(async (table) => (tables[table] ??= await context.table(table))),
    ]);
    if (!isNewest()) return;
    fill(caption, `${sayTrack(parts)} Dots: recorded nodes. ${signRules(names)}`);
    await drawProfiles(
      place,
      names,
      [{ table: (name) => tables[tableOf(name)], colour: LINES[0], dash: "solid", name: "" }],
      { parts, nodes: recordedAt(scenario, statics.columns) },
      context.signal,
    );
    cursor.follow(nodeDepths(names, (name) => tables[tableOf(name)]));
  }

  return {
    element: h("div", {}, ticks.element, h("figure", {}, scrolled(place), caption), cursor.element),
    draw: redraw,
    request: () => {
      const asked = profileTables(ticks.names()).map(({ table, fields }) => ({
        table,
        query: { fields: fields.join(",") },
      }));
      const drawn = ticks.names().find((name) => tableOf(name) === "profile");
      return {
        asked,
        python: [
          ...asked.map((one) => pythonColumns(one.table, one.query.fields.split(","))),
          ...(drawn ? [`plot.profile(point, "${drawn}")`] : []),
        ].join("\n"),
      };
    },
  };
}

/**
 * Depths of the nodes downwards, of the first quantity that is there, in the unit in which they are shown.
 * @param {string[]} names
 * @param {(name: string) => any} table of a quantity
 */
export function nodeDepths(names, table) {
  const first = names.find((name) => table(name)?.columns[name]);
  return first ? [...new Set(overDepth(first, table(first)).depth)].map(Number) : [];
}

/**
 * Says in a line what the picture says at a depth; at the end of an element that is the same of both.
 * @param {string[]} names
 * @param {(name: string) => any} table of a quantity
 * @param {number} depth in the unit in which it is shown
 * @param {any[]} points what the mouse is at in the picture; elsewhere the values are those of the nearest depth
 */
export function reading(names, table, depth, points) {
  const words = names
    .filter((name) => table(name)?.columns[name])
    .map((name) => {
      const { value, depth: own } = overDepth(name, table(name));
      const seen = points.find((point) => point.trace.meta === name)?.x ?? value[nearest(own, depth)];
      return `${label(name)} ${say(name, seen === null ? null : Number(seen) * unit(name).size)}`;
    });
  return words.join(" · ");
}

/**
 * The tables that have some quantities, each with these and the depths that they are over.
 * @param {string[]} names
 */
export function profileTables(names) {
  return [...new Set(names.map(tableOf))].map((table) => ({
    table,
    fields: [
      ...(table === "profile" ? ["measured_depth_top", "measured_depth_bottom"] : ["measured_depth"]),
      ...names.filter((name) => tableOf(name) === table),
    ],
  }));
}

/**
 * A line of Python that takes columns of a table of `point`.
 * @param {string} table
 * @param {string[]} columns
 */
export function pythonColumns(table, columns) {
  return `${table} = point.${table}().to_pandas()[${python(columns)}]`;
}

/** @param {string} name */
export function tableOf(name) {
  return QUANTITIES.find(([entry]) => entry === name)?.[1] ?? "profile";
}
