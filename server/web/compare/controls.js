// Controls of a comparison's views.

import { rangesOf } from "../data/motion-requests.js";
import { label, say } from "../data/units.js";
import { ACCOUNTS } from "../point/energy.js";
import { QUANTITIES } from "../point/profiles.js";
import { RANGES } from "../point/spectrogram.js";
import { exaggerationChoice } from "../point/well.js";
import { choice, h } from "../ui/dom.js";
import { endOf, rangeOf } from "./side-by-side.js";
import { comparedRange, comparedRate, energyAccount } from "./views.js";
import { wellColour, wellFactor } from "./wells.js";

/** @typedef {import("./choices.js").Choices} Choices */
/** @typedef {(name: string) => (value: string) => void} Set */

/** @type {[string, string][]} */
const AMPLITUDES = [
  ["linear", "linear"],
  ["log", "logarithmic"],
];

/**
 * Choices that a view has in addition to node and window.
 * @type {Record<string, (choices: Choices, set: Set) => HTMLElement[]>}
 */
const OWN = {
  well: ({ query }, set) => [
    exaggerationChoice(wellFactor(query), set("exaggerate")),
    choice(
      "Colour",
      [
        ["", "of each point"],
        ...QUANTITIES.map(([name]) => /** @type {[string, string]} */ ([name, label(name)])),
      ],
      wellColour(query) ?? "",
      set("colour"),
    ),
  ],
  energy: ({ query }, set) => [
    choice(
      "Shows",
      [
        ["", "what all accounts changed"],
        ...ACCOUNTS.map((name) => /** @type {[string, string]} */ ([name, `${label(name)} over time`])),
      ],
      energyAccount(query),
      set("account"),
    ),
  ],
  orbit: ({ query }, set) => [
    choice(
      "Shows",
      [
        ["motion", "the motion"],
        ["hole", "the whole hole"],
      ],
      query.get("zoom") ?? "motion",
      set("zoom"),
    ),
  ],
  bit: ({ query }, set) => [
    choice(
      "End of the string",
      [
        ["bit", "the bit"],
        ["top", "the top"],
      ],
      endOf({ query }),
      set("end"),
    ),
  ],
  spectrum: ({ query, points }, set) => [
    choice(
      "Frequencies up to",
      rangesOf(comparedRate(points)).map((text) => [text, `${text} Hz`]),
      String(comparedRange({ query, points })),
      set("range"),
    ),
    choice("Amplitude", AMPLITUDES, query.get("amplitude") ?? "linear", set("amplitude")),
  ],
  spectrogram: ({ query }, set) => [
    choice(
      "Frequencies up to",
      RANGES.map((text) => [text, `${text} Hz`]),
      String(rangeOf({ query })),
      set("range"),
    ),
    choice(
      "Amplitude",
      AMPLITUDES.toReversed(),
      query.get("amplitude") === "linear" ? "linear" : "log",
      set("amplitude"),
    ),
  ],
  history: ({ query }, set) => [
    choice(
      "Shows",
      [
        ["up", "from the low side up"],
        ["across", "across the hole"],
        ["radius", "distance from the axis"],
      ],
      query.get("direction") ?? "up",
      set("direction"),
    ),
  ],
  rotation: ({ query }, set) => [
    choice(
      "Shows",
      [
        ["rotation_speed", "rotation speed"],
        ["torque", "torque"],
      ],
      query.get("quantity") ?? "rotation_speed",
      set("quantity"),
    ),
  ],
};

/**
 * Controls of the chosen view.
 * @param {Choices} choices
 * @param {HTMLElement} ticks of the profiles
 * @param {(choices: Record<string, string>) => void} change
 */
export function controlsPart(choices, ticks, change) {
  if (choices.view === "profiles") return [ticks];
  const set = (/** @type {string} */ name) => (/** @type {string} */ value) => change({ [name]: value });
  return [
    ...(choices.isWindowed ? windowPart(choices, set, change) : []),
    ...(OWN[choices.view]?.(choices, set) ?? []),
  ];
}

/** Node and window. @param {Choices} choices @param {Set} set @param {(choices: Record<string, string>) => void} change */
function windowPart({ isOfNode, depths, depth, window, shortest }, set, change) {
  const time = (/** @type {"from" | "to"} */ name) => {
    const box = h("input", {
      type: "number",
      min: 0,
      step: "any",
      style: "width:7rem",
      value: Number(window[name].toFixed(3)),
      onchange: () => set(name)(box.value),
    });
    return h("label", { class: "field" }, h("span", {}, `${name === "from" ? "From" : "To"} [s]`), box);
  };
  const nearest = depths.reduce(
    (best, entry) => (Math.abs(entry - depth) < Math.abs(best - depth) ? entry : best),
    depths[0],
  );
  return [
    ...(isOfNode
      ? [
          choice(
            "Node nearest to",
            depths.map((entry) => [String(entry), say("measured_depth", entry)]),
            String(nearest),
            set("depth"),
          ),
        ]
      : []),
    time("from"),
    time("to"),
    h("button", { onclick: () => change({ from: "0", to: String(shortest) }) }, "Whole run"),
  ];
}
