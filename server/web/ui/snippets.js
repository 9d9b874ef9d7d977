// Snippets of code that reproduce a view: curl, Python, MATLAB and the command line.

import { fill, h } from "./dom.js";
import { session } from "./session.js";

/**
 * @typedef {object} Lines
 * @property {string} [curl]
 * @property {string} [python]
 * @property {string} [matlab]
 * @property {string} [cli]
 */

/** @type {[keyof Lines, string][]} */
const LANGUAGES = [
  ["curl", "curl"],
  ["python", "Python"],
  ["matlab", "MATLAB"],
  ["cli", "Command line"],
];

/**
 * @param {() => Lines} make called when the lines are opened, so that they follow the view
 * @param {string} [about] what they are for
 */
export function snippets(make, about = "Lines that made this view") {
  const body = h("div", {});
  const draw = () => {
    const made = make();
    const shown = LANGUAGES.flatMap(([key, name]) =>
      made[key] ? [h("h2", {}, name), snippet(made[key] ?? "", name)] : [],
    );
    fill(body, shown.length ? shown : h("p", { class: "soft" }, "This view shows no data."));
  };
  const details = h(
    "details",
    { class: "lines", ontoggle: () => details.open && draw() },
    h("summary", {}, `${about}: curl, Python, MATLAB`),
    body,
  );
  details.addEventListener("redraw", () => details.open && draw());
  return details;
}

/** @param {string} text @param {string} name */
function snippet(text, name) {
  const copy = h(
    "button",
    {
      "aria-label": `Copy the lines for ${name}`,
      onclick: async () => {
        await navigator.clipboard.writeText(text);
        copy.textContent = "Copied";
        setTimeout(() => (copy.textContent = "Copy"), 1500);
      },
    },
    "Copy",
  );
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
  if (typeof value === "object")
    return `{${Object.entries(value)
      .map(([name, entry]) => `${JSON.stringify(name)}: ${python(entry)}`)
      .join(", ")}}`;
  return JSON.stringify(value);
}

/**
 * A request behind a view.
 * @typedef {object} Asked
 * @property {string} path from `/v1`
 * @property {Record<string, any>} [query] what is absent or empty is left out
 * @property {string} [name] of the variable or file that takes the answer; needed where a view has several
 * @property {boolean} [isDocument] whether the answer is a document and no table
 */

/**
 * Lines that read a table of the service and show what the view shows.
 * @param {string} path of the table, from `/v1`
 * @param {Record<string, any>} query
 * @param {string} [pythonLines] with the client, in place of those that only read
 * @returns {Lines}
 */
export function tableLines(path, query, pythonLines) {
  return requestLines([{ path, query }], pythonLines);
}

/**
 * Lines that read everything that a view shows: one answer goes to the standard output, several to a file each.
 * @param {Asked[]} asked
 * @param {string} [pythonLines] with the client
 * @returns {Lines}
 */
export function requestLines(asked, pythonLines) {
  const curl = asked.map((one) => {
    const text = new URLSearchParams(pairsOf(one).map(([name, value]) => [name, String(value)])).toString();
    const file = asked.length > 1 ? ` -o ${one.name}.${one.isDocument ? "json" : "csv"}` : "";
    return `curl -fsS ${curlToken()}${shell(`${location.origin}${one.path}${text && `?${text.replaceAll("%2C", ",")}`}`)}${file}`;
  });
  const kinds = [...new Set(asked.map(optionsOf))];
  const options = kinds.map(
    (kind) =>
      `${kind} = weboptions(ContentType="${kind === "csv" ? "table" : "json"}", Timeout=90${matlabToken()});`,
  );
  const reads = asked.map((one) => {
    const arguments_ = pairsOf(one)
      .map(
        ([name, value]) =>
          `, "${name}", ${typeof value === "number" ? value : `"${String(value).replaceAll('"', '""')}"`}`,
      )
      .join("");
    return `${one.name ?? "table"} = webread("${location.origin}${one.path}"${arguments_}, ${optionsOf(one)});`;
  });
  return { curl: curl.join("\n"), python: pythonLines, matlab: [...options, ...reads].join("\n") };
}

/**
 * Lines that send a request with a body, whose answer is a sweep.
 * @param {string} path from `/v1`
 * @param {any} body
 * @returns {{curl: string, matlab: string}}
 */
export function bodyLines(path, body) {
  const text = JSON.stringify(body);
  return {
    // The refusal of a body is printed, too.
    curl: `curl -sS --fail-with-body ${curlToken()}${location.origin}${path} -H 'Content-Type: application/json' -d ${shell(text)}`,
    matlab: `json = weboptions(MediaType="application/json", ContentType="json", Timeout=90${matlabToken()});\nsweep = webwrite("${location.origin}${path}", '${text.replaceAll("'", "''")}', json);`,
  };
}

/** Header with the token, for curl. */
function curlToken() {
  return session().tokens_required ? '-H "Authorization: Bearer $DRILLSWEEP_TOKEN" ' : "";
}

/** The same among MATLAB's options. */
function matlabToken() {
  return session().tokens_required
    ? ', HeaderFields=["Authorization", "Bearer " + getenv("DRILLSWEEP_TOKEN")]'
    : "";
}

/** @param {Asked} one @returns {[string, any][]} */
function pairsOf({ query = {}, isDocument }) {
  const given = Object.entries(query).filter(
    ([, value]) => value !== null && value !== undefined && value !== "",
  );
  return isDocument ? given : [...given, ["format", "csv"]];
}

/** Name of the options of a request in MATLAB's lines. @param {Asked} one */
function optionsOf({ isDocument }) {
  return isDocument ? "json" : "csv";
}

/**
 * Arguments of the Python client for a recorded node and a window.
 * @param {Record<string, any>} which `node`, or `depth` and `nearest`
 * @param {{from: number, to: number} | null} [window] [s]
 */
export function pythonNode(which, window) {
  const node = which.node !== undefined ? `node=${which.node}` : `depth=${which.depth}, nearest=True`;
  return window ? `${node}, time=(${window.from}, ${window.to})` : node;
}
