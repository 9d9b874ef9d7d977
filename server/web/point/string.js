// The string moving in its hole, played from the snapshots of a run; below it the contacts over depth and time, rotation and torque.

import { equilibrium } from "../data/equilibrium.js";
import { snapshotsOf } from "../data/snapshots.js";
import { fill, h } from "../ui/dom.js";
import { python } from "../ui/snippets.js";
import { contactMap } from "./contacts.js";
import { withoutSnapshots } from "./no-snapshots.js";
import { endsRequest, RECORD_ENDS, rotation } from "./rotation.js";
import { StringPlayer } from "./string-player.js";

/**
 * @param {import("./part.js").PointContext} context
 * @returns {import("./part.js").PointPart}
 */
export function string(context) {
  const { duration } = context.point.scenario;
  const element = h("div", {});
  const turning = rotation(context);
  /** @type {StringPlayer | null} */
  let player = null;
  /** Rotation and torque at bit and top. @type {import("./rotation.js").EndLine[]} */
  let ends = [];
  /** @type {string[]} */
  let names = [];

  async function redraw() {
    if (!context.point.scenario.recording.snapshots) return drawWithout();
    const placing = equilibrium(context.table);
    // Files expire: the table is then missing as well.
    placing.catch(() => {});
    const there = await snapshotsOf(context);
    if (!there) return drawWithout();
    const statics = await placing;
    const map = contactMap(context);
    names = ["time", "node", "u", "v", "normal_force", "rotation_speed", "torque"].filter((name) =>
      there.names.includes(name),
    );
    const hasForce = there.names.includes("normal_force");
    player = new StringPlayer([{ context, heading: "", there, statics }], async ([{ motion }], span) => {
      await Promise.all([hasForce && motion && map.draw(motion, statics), turn(span)]);
    });
    fill(
      element,
      player.element,
      h("div", { style: "height:1rem" }),
      h("div", { class: "half" }, hasForce && map.element, turning.element),
    );
    await player.load();
  }

  /** Without snapshots there is what to record, and rotation and torque where the history has the bit. */
  async function drawWithout() {
    const place = h("div", {});
    fill(element, withoutSnapshots(context), h("div", { style: "height:1rem" }), place);
    fill(place, turning.element);
    await turn({ from: 0, to: duration });
    if (!ends.length) fill(place, h("p", { class: "panel soft" }, RECORD_ENDS));
  }

  /** Draws rotation and torque at the ends. @param {{from: number, to: number}} span [s] */
  async function turn(span) {
    const drawn = await turning.draw(span);
    if (!drawn) return;
    ends = drawn;
    context.drawn();
  }

  return {
    element,
    draw: redraw,
    request: () => {
      if (!player) return ends.length ? endsRequest(ends) : null;
      const { from, to } = player.span;
      const turned = endsRequest(ends, { from, to });
      const forces = names.includes("normal_force")
        ? ['forces = snapshots.pivot(index="node", columns="time", values="normal_force")']
        : [];
      return {
        asked: [{ table: "snapshots", query: { from, to, fields: names.join(",") } }, ...turned.asked],
        python: [
          `snapshots = point.snapshots(time=(${from}, ${to}), fields=${python(names)}).to_pandas()`,
          ...forces,
          turned.python,
        ]
          .filter(Boolean)
          .join("\n"),
      };
    },
  };
}
