// Judgement of a point above its views: its class, the finding that decides it, the numbers that it is judged by, and their error.

import { accuracyOf, advice, placeOf, sayError } from "../data/accuracy.js";
import { headlineNumbers } from "../data/judgement.js";
import { classWord } from "../draw/class-word.js";
import { fill, h } from "../ui/dom.js";

/**
 * The numbers stand at once; the class follows when the diagnosis has come.
 * @param {any} point with a result
 * @param {import("../data/accuracy.js").Measured | null} measured error of its orbit sizes
 * @param {Promise<any>} diagnosis
 * @param {AbortSignal} signal of the view
 */
export function headline(point, measured, diagnosis, signal) {
  const verdict = h("div", { class: "verdict", role: "status" }, h("p", { class: "soft" }, "Judging …"));
  const numbers = headlineNumbers(point.summary).map(({ text, value, place }) =>
    h(
      "div",
      {},
      h("dt", {}, text),
      h("dd", {}, value, place && h("span", { class: "soft small" }, ` ${place}`)),
    ),
  );
  diagnosis
    .then((judged) => fill(verdict, verdictPart(judged)))
    .catch((error) => {
      if (!signal.aborted) fill(verdict, h("p", { class: "soft" }, `Not judged: ${error.message}`));
    });
  return h(
    "section",
    { class: "panel headline", "aria-label": "Judgement" },
    verdict,
    numbers.length > 0 && h("dl", {}, numbers),
    accuracyRow(accuracyOf(point.summary, measured)),
  );
}

/** @param {ReturnType<typeof accuracyOf>} accuracy @returns {HTMLElement | null} null if nothing is known of the error */
function accuracyRow(accuracy) {
  const { estimate, missing, measured, promised, believed, isMet } = accuracy;
  if (estimate === null && !measured && promised === null) return null;
  const term = (/** @type {string} */ text, /** @type {number | null} */ value, place = "", is = "") =>
    h(
      "div",
      { class: believed === is ? "believed" : "" },
      h("dt", {}, text),
      h("dd", {}, sayError(value), place && h("span", { class: "soft small" }, ` ${place}`)),
    );
  const lacking = estimate !== null && missing.length > 0 ? `without ${missing.join(" and ")}` : "";
  return h(
    "div",
    { class: "accuracy", role: "group", "aria-label": "Error of orbit size" },
    h("span", { class: "soft" }, "Error of orbit size"),
    h(
      "dl",
      {},
      term("estimated from this run", estimate, lacking, "estimate"),
      term("measured by verification", measured?.value ?? null, placeOf(measured), "measured"),
      term("promised", promised),
    ),
    errorBar(accuracy),
    h("strong", { class: isMet === null ? "" : isMet ? "kept" : "wrong" }, advice(accuracy)),
  );
}

/** Errors on one scale from zero: the believed one as a bar, the other as a dot, the promise as a line. @param {ReturnType<typeof accuracyOf>} accuracy */
function errorBar({ estimate, measured, promised, believed, isMet }) {
  const own = measured && Math.abs(measured.value);
  const most = 1.1 * Math.max(estimate ?? 0, own ?? 0, promised ?? 0);
  if (!most) return null;
  const place = (/** @type {number} */ value) => `${((100 * value) / most).toFixed(1)}%`;
  const bar = believed === "measured" ? own : estimate;
  const other = believed === "measured" ? estimate : own;
  return h(
    "span",
    { class: "errors", "aria-hidden": "true" },
    bar !== null &&
      h("i", {
        class: `bar ${isMet === null ? "" : isMet ? "met" : "beyond"}`,
        style: `width:${place(bar)}`,
      }),
    other !== null && h("i", { class: "dot", style: `left:${place(other)}` }),
    promised !== null && h("i", { class: "promise", style: `left:${place(promised)}` }),
  );
}

/** @param {{findings: import("../data/judgement.js").Finding[], class: string, sentence: string}} judged */
function verdictPart({ class: name, sentence, findings: [, ...others] }) {
  const items = others.map((finding) => h("li", {}, classWord(finding.class), ` ${finding.sentence}`));
  return [
    h("p", {}, classWord(name), ` ${sentence}`),
    items.length > 0 &&
      h(
        "details",
        {},
        h("summary", {}, `${items.length} further ${items.length === 1 ? "finding" : "findings"}`),
        h("ul", {}, items),
      ),
  ];
}
