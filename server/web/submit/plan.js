// The plan of a request, from the answer to a dry run.

import { bytes, duration, number } from "../data/units.js";
import { h } from "../ui/dom.js";

/** @param {any} answer of a dry run */
export function plannedPart(answer) {
  const { plan } = answer;
  const accuracies = plan?.accuracies ?? [];
  const growing = plan?.undamped_torsion?.growing_modes;
  return [
    h(
      "dl",
      { class: "facts" },
      factsOf(answer).flatMap(([name, value]) => [h("dt", {}, name), h("dd", {}, value)]),
    ),
    accuracies.length ? accuraciesPart(answer, accuracies) : null,
    (plan?.warnings ?? []).map((/** @type {string} */ warning) => h("p", { class: "wrong" }, warning)),
    growing
      ? h(
          "p",
          { class: "small soft" },
          `${growing} torsional ${growing === 1 ? "mode grows" : "modes grow"}, up to ${number(plan.undamped_torsion.highest_hz, 3)} Hz.${plan.undamped_torsion.includes_bit ? "" : " Torque on bit is constant: stick-slip at the bit is not judged."}`,
        )
      : null,
  ];
}

/** @param {any} answer @returns {[string, string][]} */
function factsOf(answer) {
  const { plan, verification } = answer;
  const footprint = plan?.footprint ?? {};
  /** @type {[string, string][]} */
  const facts = [
    ["Points", String(answer.total)],
    ["Known already", `${answer.known}, not computed again`],
  ];
  if (verification)
    facts.push([
      "Verified",
      `${verification.total}, ${verification.known} of the reference runs known already`,
    ]);
  facts.push(["Time", sayTime(answer)]);
  facts.push([
    "Storage",
    answer.table_bytes ? `about ${bytes(answer.table_bytes)} before compression` : "nothing further",
  ]);
  if (!plan) return facts;
  const snapshots = footprint.snapshot_bytes
    ? `, of that ${bytes(footprint.snapshot_bytes)} of snapshots`
    : "";
  facts.push(["Tables of a point", `about ${bytes(footprint.table_bytes)} before compression${snapshots}`]);
  facts.push(["String", `${plan.elements} elements, ${number(plan.simulated_time)} s simulated`]);
  return facts;
}

/** @param {any} answer */
function sayTime({ known, total, wall_time, cpu_time }) {
  if (known === total) return "none: all results are there";
  if (wall_time !== undefined && wall_time !== null)
    return `about ${duration(wall_time)} on the workers there are`;
  return cpu_time ? `${duration(cpu_time)} of processor time; no worker is there now` : "not known";
}

/** @param {any} answer @param {any[]} accuracies */
function accuraciesPart(answer, accuracies) {
  const heads = ["Elements", "Longest step", "A point", "Known points", "To compute, on one core"].map(
    (text) => h("th", { class: "number" }, text),
  );
  const rows = accuracies.map((one, index) => accuracyRow(answer, one, index === 0));
  return h(
    "div",
    { class: "scroll", tabindex: "0", role: "region", "aria-label": "Times at each accuracy" },
    h("table", {}, h("thead", {}, h("tr", {}, h("th", {}, "Accuracy"), heads)), h("tbody", {}, rows)),
  );
}

/** @param {any} answer @param {any} accuracy @param {boolean} isChosen */
function accuracyRow({ known: chosenKnown, known_at, total }, { name, elements, step, cpu_time }, isChosen) {
  const known = isChosen ? chosenKnown : known_at?.[name];
  const points = total - (known ?? 0);
  const rest = `${known === undefined ? "at most " : ""}${points ? duration(cpu_time * points) : "none"}`;
  const cells = [
    String(elements),
    duration(step),
    cpu_time ? duration(cpu_time) : "–",
    known ?? "not looked up",
    cpu_time ? rest : "–",
  ];
  return h(
    "tr",
    {},
    h("td", {}, name, isChosen && h("span", { class: "soft" }, " (chosen)")),
    cells.map((cell) => h("td", { class: "number" }, cell)),
  );
}
