// Shown in place of a string in motion if a point has no snapshots.

import { h } from "../ui/dom.js";
import { link } from "../ui/router.js";

/** The rate that is proposed [Hz]. */
const PROPOSED_HZ = 25;

/**
 * Change of a request that adds snapshots.
 * @param {import("./part.js").PointContext} context
 */
export function withoutSnapshots({ point, path }) {
  const recorded = point.scenario.recording.rate_hz;
  const rate = Number((recorded / Math.max(1, Math.round(recorded / PROPOSED_HZ))).toFixed(6));
  const asked = JSON.stringify({ rate_hz: rate });
  const scenario = {
    ...point.scenario,
    recording: { ...point.scenario.recording, snapshots: { rate_hz: rate } },
  };
  const [, , sweep] = path.split("/").filter(Boolean);
  return h(
    "div",
    { class: "panel empty" },
    h(
      "p",
      {},
      "This point recorded no snapshots of the whole string: its motion and the map of its contacts over depth and time need them.",
    ),
    h(
      "p",
      {},
      "Add to the changes of a request: ",
      h("code", {}, `"recording.snapshots": ${asked}`),
      "; on the command line: ",
      h("code", {}, `--set recording.snapshots='${asked}'`),
      ".",
    ),
    h(
      "p",
      {},
      h(
        "a",
        {
          class: "button",
          href: link(["new"], {
            request: JSON.stringify({
              name: `Snapshots of ${sweep.slice(-8)}, point ${point.ordinal}`,
              scenario,
              axes: {},
            }),
          }),
        },
        "Compute this point with snapshots",
      ),
    ),
  );
}
