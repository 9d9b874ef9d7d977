// Rows of a table as CSV (RFC 4180).

/**
 * @param {string[]} names of the columns
 * @param {import("./sweep-table.js").Values[]} columns
 * @param {number[]} rows places of the rows in the columns, in their order
 * @returns {string} values in the service's units; a gap is empty
 */
export function csvOf(names, columns, rows) {
  const lines = rows.map((row) => columns.map((column) => cell(column[row])));
  return [names.map(cell), ...lines].map((line) => `${line.join(",")}\r\n`).join("");
}

/** @param {number | string | null | undefined} value */
function cell(value) {
  const text = String(value ?? "");
  return /[",\r\n]/.test(text) ? `"${text.replaceAll('"', '""')}"` : text;
}
