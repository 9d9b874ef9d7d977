// Judgement of a point above its views: its class, the finding that decides it, and the numbers that it is judged by.

import { headlineNumbers } from "../data/judgement.js";
import { classWord } from "../draw/class-word.js";
import { fill, h } from "../ui/dom.js";

/**
 * The numbers stand at once; the class follows when the diagnosis has come.
 * @param {any} point with a result
 * @param {Promise<any>} diagnosis
 * @param {AbortSignal} signal of the view
 */
export function headline(point, diagnosis, signal) {
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
