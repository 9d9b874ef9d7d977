// Snippets that submit the request of the form.

import { bodyLines, python, shell } from "../ui/snippets.js";
import { written } from "./values.js";

/** @param {any} body of the request @returns {import("../ui/snippets.js").Lines} */
export function submitLines(body) {
  const { preset, scenario } = body;
  const server = location.origin;
  return {
    ...bodyLines("/v1/sweeps", body),
    python: `${scenario ? "import json\n\n" : ""}from drillsweep import Client, Range\n\nsweep = Client("${server}").submit(\n    ${pythonArguments(body).join(",\n    ")},\n)\nsweep.wait()`,
    cli: `drillsweep submit ${preset ?? "scenario.json"} ${commandOptions(body).join(" \\\n    ")} --server ${server}`,
  };
}

/** @param {any} body */
function pythonArguments(body) {
  const { preset, scenario, set, axes = {}, design, samples, seed, ...rest } = body;
  const given = Object.entries(axes).map(([name, axis]) => `${JSON.stringify(name)}: ${pythonAxis(axis)}`);
  return [
    preset ? JSON.stringify(preset) : 'scenario=json.load(open("scenario.json"))',
    set && `set=${python(set)}`,
    given.length && `axes={${given.join(", ")}}`,
    ...Object.entries(rest).map(([name, value]) => `${name}=${python(value)}`),
    design && `design="${design}"`,
    ...(design && samples ? [`samples=${samples}`, `seed=${seed}`] : []),
  ].filter(Boolean);
}

/** @param {any} axis */
function pythonAxis({ values, from, to, count, scale }) {
  if (values) return python(values);
  return `Range(${[from, to, ...(count ? [count] : []), ...(scale ? ['scale="log"'] : [])].join(", ")})`;
}

/** @param {any} body */
function commandOptions({ set, axes = {}, design, samples, seed, ...rest }) {
  return [
    ...Object.entries(set ?? {}).map(
      ([name, value]) =>
        `--set ${shell(`${name}=${typeof value === "string" ? value : JSON.stringify(value)}`)}`,
    ),
    ...Object.entries(axes).map(
      ([name, axis]) => `--axis ${shell(`${name}=${written(axis).replaceAll(" ", "")}`)}`,
    ),
    ...(design ? [`--design ${design}`] : []),
    ...(samples ? [`--samples ${samples} --seed ${seed}`] : []),
    ...(typeof rest.outputs === "string" ? [`--outputs ${rest.outputs}`] : []),
    ...["verify", "skip", "priority", "cache"].flatMap((name) =>
      rest[name] ? [`--${name} ${rest[name]}`] : [],
    ),
    ...(rest.name ? [`--name ${shell(rest.name)}`] : []),
    ...(rest.tags ?? []).map((/** @type {string} */ tag) => `--tag ${shell(tag)}`),
  ];
}
