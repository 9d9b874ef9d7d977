// Contacts over depth and time: the normal force of the wall on every node, from the snapshots.

import { largestShown, maxima } from "../data/decimation.js";
import { number, shown, title, unit } from "../data/units.js";
import { canvas, colourBar, draw } from "../draw/plots.js";
import { TimeLine } from "../draw/time-line.js";
import { h } from "../ui/dom.js";

/** Columns of the map; of more snapshots each column shows the largest force of several. */
const COLUMNS = 500;

/**
 * @param {import("./part.js").PointContext} context
 * @param {{heading: string, key: string}} [named] where there are several
 */
export function contactMap(context, named) {
  const place = canvas(
    `Contact force over depth and time${named ? `, point ${named.heading}` : ""}`,
    named?.key ?? "contacts",
  );
  const caption = h("figcaption", {});
  new TimeLine(place, context.time, context.signal);
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
      const { time, rows } = maxima(frames, "normal_force", every);
      const size = unit("normal_force").size;
      caption.textContent = `Dark: off the wall. ${every > 1 ? `Each column is the largest of ${every} snapshots. ` : ""}${BEYOND}${named ? "" : " Select a place to see the string at that time."}`;
      await draw(
        place,
        [
          {
            type: "heatmap",
            x: time,
            y: shown("measured_depth", statics.measured_depth),
            z: rows.map((row) => row.map((value) => value / size)),
            zmin: 0,
            zmax: most / size,
            colorbar: colourBar(title("normal_force")),
            describe: (/** @type {{x: number, y: number, z: number}} */ { x, y, z }) =>
              `${number(x)} s, ${number(y)} ${unit("measured_depth").symbol}: ${number(z)} ${unit("normal_force").symbol}`,
          },
        ],
        {
          xaxis: { title: "time [s]" },
          yaxis: { title: title("measured_depth"), quantity: "measured_depth", autorange: "reversed" },
        },
        context.signal,
      );
    },
  };
}

/** Sentence about the end of the scale. */
export const BEYOND = "The largest tenth of the forces has the colour at the end of the scale.";
