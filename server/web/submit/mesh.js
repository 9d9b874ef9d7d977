// The mesh of a new sweep: lengths by a rule, with a factor of their own, or by kind of pipe.

import { inputUnit } from "../data/units.js";
import { choice, h } from "../ui/dom.js";
import { group, numberBox } from "./fields.js";
import { read } from "./values.js";

/** Path of the mesh. */
export const MESH = "mesh";
/** Kinds of pipe with the element lengths that are proposed, in the middle of the usual ones [m]. @type {[kind: string, proposed: number, usual: [number, number]][]} */
const KINDS = [
  ["drillpipe", 1, [0.5, 3]],
  ["tool_joint", 0.1, [0.03, 0.3]],
  ["collar", 0.5, [0.25, 1]],
  ["stabilizer", 0.5, [0.25, 1]],
  ["bit", 0.3, [0.2, 0.5]],
];
/** Factor that is proposed, and the usual ones. */
const FACTOR = 0.7,
  FACTORS = [0.25, 1.4];

/** Ways to give a mesh. @type {[string, string][]} */
const WAYS = [
  ["auto", "by the string, its wall and the accuracy"],
  ["factor", "by the string and its wall, times a factor"],
  ["lengths", "by kind of pipe"],
];

/** Way in which a mesh is given; undefined for any other value. @param {any} mesh */
export function wayOf(mesh) {
  if (mesh === "auto") return "auto";
  if (typeof mesh?.auto === "number") return "factor";
  return KINDS.every(([kind]) => typeof mesh?.[kind] === "number") ? "lengths" : undefined;
}

/** True of a change that this part of the form can show. @param {import("./rows.js").Row} row */
export function isMesh({ name, values }) {
  return name === MESH && wayOf(read(values)) !== undefined;
}

/**
 * Mesh of a way, with usual numbers unless the scenario has it.
 * @param {string} way
 * @param {any} given mesh of the scenario
 */
export function proposedMesh(way, given) {
  if (wayOf(given) === way) return given;
  if (way === "auto") return "auto";
  if (way === "factor") return { auto: FACTOR };
  return Object.fromEntries(KINDS.map(([kind, proposed]) => [kind, proposed]));
}

/**
 * @param {import("./fields.js").Edited} edited
 * @returns {HTMLElement[]}
 */
export function meshFields(edited) {
  const mesh = edited.value(MESH);
  const way = wayOf(mesh) ?? "auto";
  const ways = choice("Element lengths", WAYS, way, (chosen) =>
    edited.set(MESH, proposedMesh(chosen, edited.given(MESH))),
  );
  const put = (/** @type {string} */ name, /** @type {number | undefined} */ value) =>
    edited.setMember(MESH, `.${name}`, value);
  return [group("Mesh", MESH, edited, [ways, ...numbersOf(way, mesh, put)])];
}

/** @param {string} way @param {any} mesh @param {(name: string, value: number | undefined) => void} put */
function numbersOf(way, mesh, put) {
  if (way === "factor") {
    const box = numberBox("Factor on the element lengths", "mesh.auto", mesh.auto, (value) =>
      put("auto", value),
    );
    return [
      h("div", { class: "line" }, h("label", { class: "field" }, h("span", {}, "Factor"), box)),
      h(
        "p",
        { class: "small soft" },
        `Usual ${FACTORS.join(" to ")}: 0.5 makes every element half as long. The accuracy's own are 1.4 at draft, 1 at standard and 0.4 at reference.`,
      ),
    ];
  }
  if (way !== "lengths")
    return [
      h(
        "p",
        { class: "small soft" },
        "Shorter at a higher accuracy. The plan has the number of elements at each.",
      ),
    ];
  return [h("div", { class: "line" }, lengthBoxes(mesh, put)), usualLengths()];
}

/** @param {any} mesh @param {(name: string, value: number | undefined) => void} put */
function lengthBoxes(mesh, put) {
  return KINDS.map(([kind]) => {
    const name = `mesh.${kind}`;
    const text = `${wordOf(kind)} [${inputUnit(name).symbol}]`;
    return h(
      "label",
      { class: "field" },
      h("span", {}, text),
      numberBox(`Elements of ${wordOf(kind).toLowerCase()}`, name, mesh[kind], (value) => put(kind, value)),
    );
  });
}

function usualLengths() {
  const { symbol, size } = inputUnit("mesh.drillpipe");
  const bound = (/** @type {number} */ value) => Number((value / size).toPrecision(2));
  const usual = KINDS.map(
    ([kind, , [least, most]]) => `${wordOf(kind).toLowerCase()} ${bound(least)} to ${bound(most)}`,
  );
  return h("p", { class: "small soft" }, `Longest elements; usual [${symbol}]: ${usual.join(", ")}.`);
}

/** @param {string} kind */
function wordOf(kind) {
  return `${kind[0].toUpperCase()}${kind.slice(1).replaceAll("_", " ")}`;
}
