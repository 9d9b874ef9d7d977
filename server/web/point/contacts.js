// Contacts over depth and time: the normal force of the wall on every node, from the snapshots.

import { h } from "../ui/dom.js";
import { canvas, colourBar, draw, SCALE } from "../draw/plots.js";
import { shown, title, unit } from "../data/units.js";

/** Columns of the map; of more snapshots each column shows the largest force of several. */
const COLUMNS = 500;
/** Part of the forces that touch, from the smallest on, that the scale of colours covers: stabilizers would dwarf all others. */
const COVERED = 0.9;
/** Values from which that is estimated. */
const SAMPLED = 50_000;

/**
 * @param {import("./part.js").PointContext} context
 * @param {((time: number) => void) | null} onTime where the reader points on the map
 * @param {{heading: string, key: string}} [named] where there are several
 */
export function contactMap(context, onTime, named) {
  const place = canvas(
    `Contact force over depth and time${named ? `, point ${named.heading}` : ""}`,
    named?.key ?? "contacts",
  );
  const caption = h("figcaption", {});
  return {
    element: h(
      "div",
      { class: "panel" },
      h("h2", {}, named?.heading ?? "Contacts"),
      h("figure", {}, place, caption),
    ),
    /**
     * @param {import("../data/snapshots.js").Frames} frames with the normal force
     * @param {any} statics columns of the table
     * @param {number} [most] the force at the end of the scale of colours [N]
     */
    async draw(frames, statics, most = largestShown(frames.columns.normal_force)) {
      const every = Math.ceil(frames.count / COLUMNS);
      const { time, force } = largest(frames, every);
      const size = unit("normal_force").size;
      caption.textContent = `Dark: off the wall. ${every > 1 ? `Each column is the largest of ${every} snapshots. ` : ""}${BEYOND}${onTime ? " Select a place to see the string at that time." : ""}`;
      const shape = await draw(
        place,
        [
          {
            type: "heatmap",
            x: time,
            y: shown("measured_depth", statics.measured_depth),
            z: force.map((row) => row.map((value) => value / size)),
            zmin: 0,
            zmax: most / size,
            colorscale: SCALE,
            colorbar: colourBar(title("normal_force")),
            hovertemplate: `%{x:.2f} s, %{y:.1f} ${unit("measured_depth").symbol}: %{z:.4~g} ${unit("normal_force").symbol}<extra></extra>`,
          },
        ],
        {
          xaxis: { title: "time [s]" },
          yaxis: { title: title("measured_depth"), quantity: "measured_depth", autorange: "reversed" },
        },
        context.signal,
      );
      shape.removeAllListeners?.("plotly_click");
      if (onTime) shape.on?.("plotly_click", (/** @type {any} */ event) => onTime(Number(event.points[0].x)));
    },
  };
}

/** What a picture says of the scale's end. */
export const BEYOND = "The largest tenth of the forces has the colour at the end of the scale.";

/**
 * The force at the end of the scale of colours [N].
 * @param {Float32Array} forces
 */
export function largestShown(forces) {
  const every = Math.max(1, Math.floor(forces.length / SAMPLED));
  const touching = forces.filter((value, index) => index % every === 0 && value > 0).sort();
  return touching.length ? touching[Math.round(COVERED * (touching.length - 1))] : 1;
}

/**
 * The largest force of each node in every few snapshots.
 * @param {import("../data/snapshots.js").Frames} frames @param {number} every
 */
function largest({ nodes, count, first, interval, columns: { normal_force } }, every) {
  const length = Math.ceil(count / every);
  const force = Array.from({ length: nodes }, (_, node) =>
    Array.from({ length }, (_, column) => {
      let most = -Infinity;
      for (let frame = column * every; frame < Math.min(count, (column + 1) * every); frame += 1)
        most = Math.max(most, normal_force[frame * nodes + node]);
      return most;
    }),
  );
  const time = Array.from(
    { length },
    (_, column) => first + (column * every + (Math.min(every, count - column * every) - 1) / 2) * interval,
  );
  return { time, force };
}
