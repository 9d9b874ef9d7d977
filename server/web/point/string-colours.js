// Values that colour a string in motion.

import { covered, largestShown, sampled } from "../data/decimation.js";
import { frames, valueAt } from "../data/snapshots.js";
import { amplitudes } from "../data/statistics.js";
import { onNodes } from "../data/well-frames.js";

/** @typedef {{value: (node: number) => number, range: [number, number], isMarked?: (node: number) => boolean}} Colours */

/**
 * @param {import("./player-choices.js").Strings[number] & {motion: import("../data/snapshots.js").Frames | null}} actor whose snapshots are loaded
 * @param {[name: string, source: string]} colour
 * @param {{span: {from: number, to: number}, now: () => number}} clock window of the snapshots, and the present time [s]
 * @returns {Promise<Colours>}
 */
export async function coloursOf({ context, statics, there, motion }, [name, source], { span, now }) {
  if (!motion) throw new Error("colours need the snapshots");
  if (source === "profile") {
    const values = onNodes((await context.table("profile", { fields: name })).columns, name, there.nodes);
    return { value: (node) => values[node] ?? 0, range: covered(values.flatMap((value) => value ?? [])) };
  }
  if (source === "snapshots" && !motion.columns[name]) {
    Object.assign(motion.columns, (await frames(context, [name], span, there.nodes)).columns);
  }
  if (name === "orbit_radius_rms") {
    const amplitude = amplitudes(motion);
    return { value: (node) => amplitude[node], range: [0, Math.max(...amplitude)] };
  }
  if (name === "radius") {
    const value = (/** @type {number} */ node) =>
      Math.hypot(valueAt(motion, "u", node, now()), valueAt(motion, "v", node, now()));
    return { value, range: [0, Math.max(...statics.clearance)] };
  }
  const value = (/** @type {number} */ node) => valueAt(motion, name, node, now());
  if (name !== "normal_force") return { value, range: covered(sampled(motion.columns[name])) };
  // Contacts are as short as a tool joint: they are marked.
  return { value, range: [0, largestShown(motion.columns[name])], isMarked: (node) => value(node) > 0 };
}
