// A file of another program, which the service reads into a part of the scenario.

import { Problem, sendFile, Unreachable } from "../data/api.js";
import { sheetNames } from "../data/workbook.js";
import { choice, fill, h } from "../ui/dom.js";
import { attend } from "../ui/notices.js";

/**
 * Meaning of a file, as the service answers it.
 * @typedef {{columns: {quantity: string, column: string, heading: string, unit: string, is_assumed: boolean}[], components?: {row: number, description: string, kind: string, remarks: string[]}[], remarks: string[], problems: {row: number, column: string | null, text: string, problem: string}[]}} Understood
 */

/** Choices that a file may leave open, by the parameter of the request. @typedef {Record<string, {label: string, options: [value: string, text: string][]}>} Choices */

/**
 * A chooser of a file, and of a sheet if it is a workbook of several, with the meaning of the last one below it.
 * @param {"survey" | "tally" | "hole"} part
 * @param {Choices} choices
 * @param {() => Record<string, string>} query further parameters of the request
 * @param {(answer: any) => void} taken is called with the answer to a file that was read
 * @param {AbortSignal} signal of the view
 */
export function importFile(part, choices, query, taken, signal) {
  /** @type {Record<string, string>} */
  const chosen = {};
  /** @type {File | undefined} */
  let file;
  const sheets = h("div", {});
  const report = h("div", { class: "small soft", "aria-live": "polite" });
  const box = h("input", {
    type: "file",
    "aria-label": `File of a ${part}`,
    onchange: () => {
      file = box.files?.[0];
      delete chosen.sheet;
      attend(Promise.all([offerSheets(), load()]), signal);
    },
  });
  const load = async () => {
    if (!file) return;
    try {
      const answer = await sendFile(`/v1/imports/${part}`, { ...query(), ...chosen }, file, signal);
      taken(answer);
      fill(report, ...meaning(answer));
    } catch (error) {
      if (!(error instanceof Problem || error instanceof Unreachable)) throw error;
      fill(report, h("p", { class: "wrong" }, `${file.name}: ${error.message}`));
    }
  };
  const offerSheets = async () => {
    const offered = file;
    const names = offered ? await sheetNames(offered) : [];
    if (offered !== file) return;
    const options = names.map((name) => /** @type {[string, string]} */ ([name, name]));
    const sheet = choice("Sheet", options, names[0] ?? "", (name) => {
      chosen.sheet = name;
      attend(load(), signal);
    });
    fill(sheets, names.length > 1 && sheet);
  };
  const boxes = Object.entries(choices).map(([name, { label, options }]) =>
    choice(label, options, "", (value) => {
      chosen[name] = value;
      attend(load(), signal);
    }),
  );
  return h(
    "div",
    {},
    h("label", { class: "field" }, h("span", {}, "From a file: CSV, Excel, WITSML"), box),
    sheets,
    boxes,
    report,
  );
}

/** @param {Understood} answer */
function meaning({ columns, components = [], remarks, problems }) {
  const told = components
    .filter((component) => component.remarks.length)
    .map(
      ({ row, description, kind, remarks: own }) => `Row ${row}, ${description} (${kind}): ${own.join("; ")}`,
    );
  const cells = problems.map(
    ({ row, column, text, problem }) =>
      `Row ${row}${column ? `, column ${column}` : ""}${text ? `, “${text}”` : ""}: ${problem}`,
  );
  const read = columns.map(
    ({ quantity, column, heading, unit, is_assumed }) =>
      `${quantity.replaceAll("_", " ")}: ${column}, “${heading}”${unit && `, in ${unit}`}${is_assumed ? ", which the file does not give" : ""}`,
  );
  return [list("Understood", read), list("Remarks", [...remarks, ...told]), list("Not used", cells)].flat();
}

/** @param {string} heading @param {string[]} lines */
function list(heading, lines) {
  if (!lines.length) return [];
  return [
    h("p", {}, `${heading}:`),
    h(
      "ul",
      {},
      lines.map((line) => h("li", {}, line)),
    ),
  ];
}
