// The lines that made a view, for curl, Python, MATLAB and the command line.

import { fill, h } from "./dom.js";

/**
 * @typedef {object} Lines
 * @property {string} [curl]
 * @property {string} [python]
 * @property {string} [matlab]
 * @property {string} [cli]
 */

/** @type {[keyof Lines, string][]} */
const LANGUAGES = [["curl", "curl"], ["python", "Python"], ["matlab", "MATLAB"], ["cli", "Command line"]];

/**
 * @param {() => Lines} make called when the lines are opened, so that they follow the view
 * @param {string} [about] what they are for
 */
export function lines(make, about = "Lines that made this view") {
  const body = h("div", {});
  const draw = () => {
    const made = make();
    fill(body, LANGUAGES.flatMap(([key, name]) => (made[key] ? [h("h2", {}, name), snippet(made[key] ?? "", name)] : [])));
  };
  const details = h("details", { class: "lines", ontoggle: () => details.open && draw() }, h("summary", {}, `${about}: curl, Python, MATLAB`), body);
  details.addEventListener("redraw", () => details.open && draw());
  return details;
}

/** @param {string} text @param {string} name */
function snippet(text, name) {
  const copy = h("button", { "aria-label": `Copy the lines for ${name}`, onclick: async () => {
    await navigator.clipboard.writeText(text);
    copy.textContent = "Copied";
    setTimeout(() => (copy.textContent = "Copy"), 1500);
  } }, "Copy");
  return h("div", { class: "snippet" }, h("pre", { tabindex: "0" }, text), copy);
}

/** @param {string} text for a POSIX shell */
export function shell(text) {
  return `'${text.replaceAll("'", `'\\''`)}'`;
}

/**
 * @param {unknown} value as Python writes it
 * @returns {string}
 */
export function python(value) {
  if (value === null || value === undefined) return "None";
  if (value === true) return "True";
  if (value === false) return "False";
  if (Array.isArray(value)) return `[${value.map(python).join(", ")}]`;
  if (typeof value === "object") return `{${Object.entries(value).map(([name, entry]) => `${JSON.stringify(name)}: ${python(entry)}`).join(", ")}}`;
  return JSON.stringify(value);
}

/**
 * Lines that read a table of the service and show what the view shows.
 * @param {string} path of the table, from `/v1`
 * @param {Record<string, string | number | null | undefined>} query
 * @param {string} [pythonLines] with the client, in place of those that only read
 * @returns {Lines}
 */
export function tableLines(path, query, pythonLines) {
  const server = location.origin;
  const pairs = Object.entries(query).filter(([, value]) => value !== null && value !== undefined && value !== "");
  const text = new URLSearchParams([...pairs.map(([name, value]) => [name, String(value)]), ["format", "csv"]]).toString();
  const arguments_ = pairs.map(([name, value]) => `, "${name}", ${typeof value === "number" ? value : `"${String(value).replaceAll('"', '""')}"`}`).join("");
  return {
    curl: `curl -s ${shell(`${server}${path}?${text.replaceAll("%2C", ",")}`)}`,
    python: pythonLines,
    matlab: `csv = weboptions(ContentType="table", Timeout=90);   % with tokens: HeaderFields=["Authorization", "Bearer " + getenv("DRILLSWEEP_TOKEN")]\ntable = webread("${server}${path}"${arguments_}, "format", "csv", csv);`,
  };
}
