// The lines that read what a view of a sweep shows, of as many sweeps as it compares.

import { tableLines } from "../ui/snippets.js";

/**
 * @typedef {object} Shown
 * @property {string} id of a sweep
 * @property {string} path of its table
 * @property {string[]} fields the columns that are shown; none for all
 */

/**
 * @param {Shown[]} sweeps the sweep, and what it is compared with
 * @returns {import("../ui/snippets.js").Lines}
 */
export function sweepLines(sweeps) {
  const name = (/** @type {string} */ word, /** @type {number} */ index) => (index ? `other_${word}` : word);
  const made = sweeps.map(({ path, fields }) => tableLines(path, { fields: fields.join(",") }));
  const python = sweeps.map(({ id, fields }, index) => {
    const list = fields.length ? `[[${fields.map((field) => JSON.stringify(field)).join(", ")}]]` : "";
    return `${name("sweep", index)} = client.sweep("${id}")\n${name("table", index)} = ${name("sweep", index)}.table().to_pandas()${list}\nprint(${name("table", index)})`;
  });
  return {
    curl: made.map(({ curl }) => curl).join("\n"),
    python: `from drillsweep import Client\n\nclient = Client("${location.origin}")\n${python.join("\n")}`,
    // The options are the same for each table.
    matlab: made
      .map(({ matlab = "" }, index) =>
        index
          ? matlab
              .split("\n")
              .slice(1)
              .join("\n")
              .replace(/^table/, "other_table")
          : matlab,
      )
      .join("\n"),
    cli: sweeps
      .map(
        ({ id }, index) =>
          `drillsweep fetch ${id} --server ${location.origin} --output ${name("results", index)}`,
      )
      .join("\n"),
  };
}
