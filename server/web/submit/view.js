// A new sweep: what it varies, and beside it what the service says it would become.

import { connection, get, Problem, send } from "../data/api.js";
import { choice, debounced, fill, h } from "../ui/dom.js";
import { bodyLines, python, shell, snippets } from "../ui/snippets.js";
import { attend } from "../ui/notices.js";
import { canvas, draw, LINES } from "../draw/plots.js";
import { go, held, hold, keep, link } from "../ui/router.js";
import { scenarioForm } from "./scenario-form.js";
import { MAY_NOT, maySubmit } from "../ui/session.js";
import { settings } from "../data/settings.js";
import { NoSurvey } from "../data/survey.js";
import { surveyField } from "./survey-field.js";
import {
  bytes,
  duration,
  label,
  meaning,
  number,
  pathNames,
  servedUnit,
  shown,
  title,
} from "../data/units.js";

/** Characters of a request that a link may hold; a longer one is held beside it. */
const LINKED = 4000;
/** What the link says in the place of such a request. */
const HELD = "held";
const SURVEY = "well.survey";
/** Short names of parameters. @type {Record<string, string>} */
const ALIASES = { flow_rate: "mud.flow_rate", mud_density: "mud.density" };
/** Members of a request that the form has fields for, and its owner, who is the one who submits it; others are carried over as they are. */
const FIELDS = [
  "name",
  "owner",
  "tags",
  "preset",
  "scenario",
  "set",
  "outputs",
  "design",
  "axes",
  "samples",
  "seed",
  "verify",
];
/** The choice that keeps what the request that the form begins with says of histories in part, for which there are no fields. */
const PART = "part";
const DRAWN = ["latin_hypercube", "sobol"];

/** @type {import("../ui/router.js").View} */
export async function show(main, route, signal) {
  const { scenarios } = await get("/v1/scenarios", {}, signal);
  const { start, isGoneOn } = await begun(route.query, signal);
  /** @type {{name: string, values: string}[]} */
  const axes = Object.entries(
    start.axes ??
      (isGoneOn
        ? {}
        : { flow_rate: { values: [0.01, 0.04, 0.06] }, mud_density: { from: 1200, to: 2100, count: 4 } }),
  ).map(([name, axis]) => ({ name, values: written(axis) }));
  /** @type {{name: string, values: string}[]} */
  const changes = Object.entries(start.set ?? {})
    .filter(([name, value]) => !(name === "accuracy" && typeof value === "string") && name !== SURVEY)
    .map(([name, value]) => ({ name, values: JSON.stringify(value) }));
  const form = {
    preset: start.preset ?? (start.scenario ? "" : "paper-200m-damped"),
    scenario: start.scenario ? JSON.stringify(start.scenario, null, 2) : "",
    accuracy: typeof start.set?.accuracy === "string" ? start.set.accuracy : "",
    design: start.design ?? "grid",
    outputs: typeof start.outputs === "string" ? start.outputs : start.outputs ? PART : "",
  };

  const carried = isGoneOn
    ? Object.fromEntries(Object.entries(start).filter(([name]) => !FIELDS.includes(name)))
    : {};

  let isSent = false;
  /** Numbers the plans, so that an older one is dropped. */
  let generation = 0;
  const rested = debounced(() => void plan(), 400, signal);
  /** What is submitted is what was planned: a plan that is under way is of what was there before. */
  function changed() {
    generation += 1;
    submit.disabled = true;
    rested();
  }
  const box = (/** @type {string} */ value, /** @type {Record<string, any>} */ attributes = {}) =>
    h("input", { value, oninput: changed, ...attributes });
  const name = box(start.name ?? "", { maxlength: 200 });
  const tags = box((start.tags ?? []).join(", "), { placeholder: "separated by commas" });
  const samples = box(String(start.samples ?? 64), { type: "number", min: 1 });
  const seed = box(String(start.seed ?? 0), { type: "number", min: 0 });
  const verify = box(start.verify ? String(start.verify) : "", { placeholder: "such as 0.05 or 10" });
  const scenario = h("textarea", {
    class: "code",
    "aria-label": "Scenario as JSON",
    spellcheck: "false",
    oninput: changed,
    value: form.scenario,
  });
  const file = h("input", {
    type: "file",
    accept: ".toml,.json",
    "aria-label": "Scenario file",
    onchange: () => attend(take(), signal),
  });
  const field = (
    /** @type {string} */ text,
    /** @type {HTMLElement} */ element,
    /** @type {string} */ pointer,
  ) => h("label", { class: "field", "data-pointer": pointer }, h("span", {}, text), element);

  const fields = scenarioForm(
    {
      get: (path) => {
        const row = changes.find((entry) => entry.name === path);
        return row && read(row.values);
      },
      set: (path, value) => {
        const at = changes.findIndex((entry) => entry.name === path);
        if (value === undefined) {
          if (at >= 0) changes.splice(at, 1);
        } else if (at >= 0) changes[at].values = JSON.stringify(value);
        else changes.push({ name: path, values: JSON.stringify(value) });
        drawRows(changesPart, changes, "set");
        changed();
      },
    },
    signal,
  );
  const survey = surveyField(start.set?.[SURVEY], changed);
  const axesPart = h("div", {});
  const changesPart = h("div", {});
  const sourcePart = h("div", { "data-pointer": "/scenario" });
  const drawnPart = h("div", { class: "controls" });
  const beside = h("p", { class: "small soft", role: "status" });
  const general = h("p", { class: "wrong", role: "alert" });
  const planned = h("div", {});
  const previewed = h("div", { class: "controls" });
  const preview = canvas("Preview of the points", "preview");
  const pointsPart = h(
    "section",
    { class: "panel", "aria-label": "Preview", hidden: true },
    h("h2", {}, "Points"),
    previewed,
    h("figure", {}, preview),
  );
  const submit = h("button", { class: "main", type: "submit", disabled: true }, "Submit");
  const paths = h(
    "datalist",
    { id: "paths" },
    ["flow_rate", "mud_density", ...pathNames()].map((entry) => h("option", { value: entry }, label(entry))),
  );

  /** @param {HTMLElement} place @param {{name: string, values: string}[]} rows @param {string} kind */
  function drawRows(place, rows, kind) {
    const isAxis = kind === "axes";
    fill(
      place,
      rows.map((row, index) => {
        const hint = h("span", { class: "small soft" });
        const say = () =>
          fill(
            hint,
            [
              label(row.name) !== row.name.replaceAll("_", " ") && label(row.name),
              servedUnit(row.name) && `in ${servedUnit(row.name)}`,
            ]
              .filter(Boolean)
              .join(", "),
          );
        const path = h("input", {
          value: row.name,
          list: "paths",
          "aria-label": isAxis ? "Parameter" : "Field",
          size: 26,
          oninput: () => {
            row.name = path.value.trim();
            name();
            say();
            changed();
          },
        });
        const values = h("input", {
          value: row.values,
          "aria-label": isAxis ? "Values" : "Value",
          size: 22,
          placeholder: isAxis ? "0.01, 0.02 or 0.01:0.06:6" : "value",
          oninput: () => {
            row.values = values.value;
            changed();
          },
        });
        const remove = h(
          "button",
          {
            type: "button",
            onclick: () => {
              rows.splice(index, 1);
              drawRows(place, rows, kind);
              changed();
            },
          },
          "✕",
        );
        const line = h(
          "div",
          { class: "controls", style: "margin-bottom:.35rem" },
          path,
          values,
          remove,
          hint,
        );
        const name = () => {
          line.dataset.pointer = `/${kind}/${row.name}`;
          remove.setAttribute("aria-label", `Remove ${row.name}`);
          path.title = meaning(row.name);
        };
        name();
        say();
        return line;
      }),
      h(
        "button",
        {
          type: "button",
          onclick: () => {
            rows.push({ name: "", values: "" });
            drawRows(place, rows, kind);
          },
        },
        isAxis ? "Add a parameter" : "Add a change",
      ),
    );
  }

  function drawSource() {
    const options = [
      /** @type {[string, string]} */ (["", "— my own, from a file or pasted as JSON"]),
      ...scenarios.map(
        (/** @type {any} */ entry) => /** @type {[string, string]} */ ([entry.name, entry.name]),
      ),
    ];
    fill(
      sourcePart,
      choice("Scenario", options, form.preset, (value) => attend(choose(value), signal)),
      h(
        "p",
        { class: "small soft" },
        scenarios.find((/** @type {any} */ entry) => entry.name === form.preset)?.description ??
          "A scenario file's JSON; its fields are in SI units.",
      ),
      field("A scenario file, TOML or JSON", file, "/file"),
      !form.preset && scenario,
    );
    attend(drawFields(), signal);
  }

  /** @param {string} preset none for a scenario of one's own, which begins as the one that was chosen before */
  async function choose(preset) {
    if (!preset && !scenario.value && form.preset)
      scenario.value = JSON.stringify(
        (await get(`/v1/scenarios/${encodeURIComponent(form.preset)}`, {}, signal)).scenario,
        null,
        2,
      );
    form.preset = preset;
    drawSource();
    changed();
  }

  /** Takes the scenario of the file that is chosen. */
  async function take() {
    const chosen = file.files?.[0];
    if (!chosen) return;
    const format = chosen.name.toLowerCase().endsWith(".json") ? "json" : "toml";
    let asked;
    try {
      asked = await send("POST", "/v1/scenarios", { format, text: await chosen.text() }, signal);
    } catch (error) {
      if (!(error instanceof Problem)) throw error;
      mark(
        (error.errors.length ? error.errors : [{ detail: error.message }]).map(({ detail }) => ({
          pointer: "/file",
          detail,
        })),
      );
      return;
    }
    changes.splice(
      0,
      changes.length,
      ...Object.entries(asked.set ?? {}).map(([name, value]) => ({ name, values: JSON.stringify(value) })),
    );
    drawRows(changesPart, changes, "set");
    // What the file sets is not varied too.
    const varied = axes.filter(({ name }) => !((ALIASES[name] ?? name) in (asked.set ?? {})));
    axes.splice(0, axes.length, ...varied);
    drawRows(axesPart, axes, "axes");
    if (asked.scenario) scenario.value = JSON.stringify(asked.scenario, null, 2);
    await choose(asked.preset ?? "");
  }

  /** Of the scenario whose fields are shown, what it was made from. */
  let fieldsOf = "";
  async function drawFields() {
    const source = form.preset || scenario.value;
    if (source === fieldsOf) return;
    fieldsOf = source;
    if (form.preset) {
      const answer = await get(`/v1/scenarios/${encodeURIComponent(form.preset)}`, {}, signal);
      if (source === fieldsOf) fields.show(answer.scenario);
    } else {
      fields.show(object(source));
    }
  }

  function drawDrawn() {
    const isDrawn = DRAWN.includes(form.design);
    fill(
      drawnPart,
      choice(
        "Design",
        [
          ["grid", "grid: all combinations"],
          ["zip", "zip: values side by side"],
          ["latin_hypercube", "Latin hypercube"],
          ["sobol", "Sobol sequence"],
        ],
        form.design,
        (value) => {
          form.design = value;
          drawDrawn();
          changed();
        },
      ),
      isDrawn && [field("Points", samples, "/samples"), field("Seed", seed, "/seed")],
    );
  }

  /** The request that the form stands for; throws where a text cannot be read. */
  function request() {
    /** @type {any} */
    const body = { ...carried };
    if (form.design !== "list") delete body.points;
    if (name.value.trim()) body.name = name.value.trim();
    if (form.preset) body.preset = form.preset;
    else body.scenario = parsed(scenario.value, "/scenario");
    const set = Object.fromEntries(changes.filter((row) => row.name).map((row) => [row.name, changeOf(row)]));
    if (form.accuracy) set.accuracy = form.accuracy;
    const stations = pasted(survey.read);
    if (stations) set[SURVEY] = stations;
    if (Object.keys(set).length) body.set = set;
    const isDrawn = DRAWN.includes(form.design);
    const used = axes.filter((row) => row.name);
    if (used.length)
      body.axes = Object.fromEntries(used.map((row) => [row.name, span(row.values, row.name, isDrawn)]));
    if (form.design !== "grid") body.design = form.design;
    if (isDrawn) Object.assign(body, { samples: Number(samples.value), seed: Number(seed.value) });
    const words = tags.value
      .split(",")
      .map((word) => word.trim())
      .filter(Boolean);
    if (words.length) body.tags = words;
    if (form.outputs) body.outputs = form.outputs === PART ? start.outputs : form.outputs;
    if (verify.value.trim()) body.verify = Number(verify.value);
    return body;
  }

  /** @param {{pointer?: string, detail: string}[]} problems */
  function mark(problems) {
    for (const old of form_.querySelectorAll(".wrong[data-problem]")) old.remove();
    for (const old of form_.querySelectorAll("[aria-invalid]")) old.removeAttribute("aria-invalid");
    const places = /** @type {HTMLElement[]} */ ([...form_.querySelectorAll("[data-pointer]")]);
    const rest = [];
    for (const problem of problems) {
      const at = problem.pointer ?? "";
      const place = places
        .filter((entry) => at === entry.dataset.pointer || at.startsWith(`${entry.dataset.pointer}/`))
        .sort((a, b) => (b.dataset.pointer?.length ?? 0) - (a.dataset.pointer?.length ?? 0))[0];
      if (!place) {
        rest.push(problem.pointer ? `${problem.pointer}: ${problem.detail}` : problem.detail);
        continue;
      }
      place.querySelector("input, select, textarea")?.setAttribute("aria-invalid", "true");
      place.append(
        h(
          "span",
          { class: "wrong", "data-problem": true },
          at === place.dataset.pointer
            ? problem.detail
            : `${at.slice((place.dataset.pointer ?? "").length + 1)}: ${problem.detail}`,
        ),
      );
    }
    general.textContent = rest.join(" ");
  }

  async function plan() {
    const mine = ++generation;
    taken.dispatchEvent(new Event("redraw"));
    submit.disabled = true;
    attend(drawFields(), signal);
    try {
      const body = request();
      const text = JSON.stringify(body);
      const isLinked = text.length <= LINKED;
      keep({ from: null, preset: null, request: isLinked ? text : null, [HELD]: isLinked ? null : "tab" });
      hold(isLinked ? null : text);
      beside.textContent = isLinked
        ? ""
        : `This request is too long for the link of this page, which alone does not hold it. This tab keeps it: it is here again where the page is loaded anew, and after going back or forward. To pass it on, take its lines below.`;
      const answer = await send("POST", "/v1/sweeps?dry_run=true", body, signal);
      if (mine !== generation) return;
      mark(answer.warnings ?? []);
      fill(planned, ...plannedPart(answer));
      submit.disabled = isSent || !maySubmit();
      submit.title = maySubmit() ? "" : MAY_NOT;
      submit.textContent = `Submit ${answer.total} ${answer.total === 1 ? "point" : "points"}`;
      await drawPreview(answer.points);
    } catch (error) {
      if (signal.aborted || mine !== generation) return;
      if (error instanceof Problem) mark(error.errors.length ? error.errors : [{ detail: error.message }]);
      else if (error instanceof Unreadable) mark([{ pointer: error.pointer, detail: error.message }]);
      else general.textContent = error instanceof Error ? error.message : String(error);
      const isRefused = error instanceof Unreadable || (error instanceof Problem && error.status < 500);
      fill(
        planned,
        h(
          "p",
          { class: "soft" },
          isRefused
            ? "The plan appears here once the request can be read."
            : "The plan appears here once the server answers.",
        ),
      );
      pointsPart.hidden = true;
    }
  }

  /** The parameters over which points are shown, where they are chosen. */
  const over = { x: "", y: "" };
  /** @param {any[]} points */
  async function drawPreview(points) {
    const names = Object.keys(points[0]?.parameters ?? {});
    pointsPart.hidden = names.length === 0;
    const x = names.includes(over.x) ? over.x : names[0];
    const others = names.filter((entry) => entry !== x);
    const y = others.includes(over.y) ? over.y : others[0];
    const pick = (/** @type {"x" | "y"} */ side, /** @type {string} */ text, /** @type {string[]} */ from) =>
      choice(
        text,
        from.map((entry) => [entry, label(entry)]),
        side === "x" ? x : y,
        (value) => {
          over[side] = value;
          attend(drawPreview(points), signal);
        },
      );
    fill(previewed, names.length > 2 && [pick("x", "Across", names), pick("y", "Up", others)]);
    if (!names.length) return;
    const values = (/** @type {string} */ of) =>
      shown(
        of,
        points.map((point) => point.parameters[of]),
      );
    await draw(
      preview,
      [
        {
          type: points.length > 3000 ? "scattergl" : "scatter",
          mode: "markers",
          x: values(x),
          y: y ? values(y) : points.map(() => 0),
          marker: { color: LINES[0], size: points.length > 500 ? 4 : 8 },
          hoverinfo: y ? "x+y" : "x",
        },
      ],
      {
        xaxis: { title: title(x), quantity: x },
        yaxis: y ? { title: title(y), quantity: y } : { visible: false },
      },
      signal,
    );
  }

  const taken = snippets(() => {
    try {
      return requestLines(request());
    } catch {
      return { curl: "# The request cannot be read yet." };
    }
  });

  // What is typed stays: the plan alone is made again, in the units and colours that now hold.
  settings.addEventListener(
    "change",
    () => {
      survey.say();
      changed();
    },
    { signal },
  );
  connection.addEventListener("found", changed, { signal });

  const form_ = h(
    "form",
    {
      novalidate: true,
      onsubmit: async (/** @type {Event} */ event) => {
        event.preventDefault();
        submit.disabled = true;
        isSent = true;
        try {
          const sweep = await send("POST", "/v1/sweeps", request());
          go(link(["sweeps", sweep.id]));
        } catch (error) {
          mark(
            error instanceof Problem && error.errors.length
              ? error.errors
              : [{ detail: error instanceof Error ? error.message : String(error) }],
          );
          isSent = false;
          submit.disabled = false;
        }
      },
    },
    h(
      "section",
      { class: "panel", "aria-label": "Scenario" },
      sourcePart,
      h(
        "div",
        { class: "controls" },
        choice(
          "Accuracy",
          [
            ["", "the scenario's"],
            ["draft", "draft"],
            ["standard", "standard"],
            ["reference", "reference"],
          ],
          form.accuracy,
          (value) => {
            form.accuracy = value;
            changed();
          },
        ),
        choice(
          "Kept of each point",
          [
            ["", "the scenario's"],
            ["full", "everything, with histories"],
            ["spectra", "spectra, no histories"],
            ["summary", "its row of the table only"],
            ...(start.outputs && typeof start.outputs === "object"
              ? [
                  /** @type {[string, string]} */ ([
                    PART,
                    `histories in part: ${JSON.stringify(start.outputs)}`,
                  ]),
                ]
              : []),
          ],
          form.outputs,
          (value) => {
            form.outputs = value;
            changed();
          },
        ),
      ),
      h("h2", {}, "Changes to the scenario"),
      changesPart,
      fields.element,
      survey.element,
    ),
    h(
      "section",
      { class: "panel", "aria-label": "Parameters", "data-pointer": "/axes" },
      h("h2", {}, "What is varied"),
      h(
        "p",
        { class: "small soft" },
        "Values separated by commas, or from:to:count, with :log for logarithmic spacing. Drawn designs take from:to.",
      ),
      drawnPart,
      axesPart,
    ),
    h(
      "section",
      { class: "panel", "aria-label": "Name" },
      h(
        "div",
        { class: "controls" },
        field("Name", name, "/name"),
        field("Tags", tags, "/tags"),
        field("Verify a sample", verify, "/verify"),
      ),
      general,
      beside,
      submit,
    ),
    paths,
  );
  drawRows(axesPart, axes, "axes");
  drawRows(changesPart, changes, "set");
  drawSource();
  drawDrawn();
  fill(
    main,
    h("div", { class: "head" }, h("h1", {}, "New sweep")),
    route.query.has(HELD) &&
      !isGoneOn &&
      h(
        "p",
        { class: "wrong", role: "status" },
        "The request of this link was too long for it; only the tab in which it was made keeps it.",
      ),
    h(
      "div",
      { class: "half" },
      form_,
      h(
        "aside",
        { "aria-label": "What it would become" },
        h(
          "section",
          { class: "panel", "aria-label": "Plan", "aria-live": "polite" },
          h("h2", {}, "What it would become"),
          planned,
        ),
        pointsPart,
      ),
    ),
    taken,
  );
  void plan();
  return "New sweep";
}

/**
 * The request that the form begins with: that of the link, of another sweep, or none; and whether it goes on with this, instead of one that
 * it proposes.
 * @param {URLSearchParams} query
 * @param {AbortSignal} signal
 * @returns {Promise<{start: any, isGoneOn: boolean}>}
 */
async function begun(query, signal) {
  const from = query.get("from");
  if (from) {
    const { request } = await get(`/v1/sweeps/${encodeURIComponent(from)}`, {}, signal);
    return { start: { ...request, tags: request?.tags ?? [] }, isGoneOn: true };
  }
  const request = query.get("request") ?? (query.has(HELD) ? held() : null);
  return {
    start: { ...(query.has("preset") ? { preset: query.get("preset") } : {}), ...object(request ?? "") },
    isGoneOn: request !== null,
  };
}

/** A text of the form that cannot be read. */
class Unreadable extends Error {
  /** @param {string} pointer @param {string} text */
  constructor(pointer, text) {
    super(text);
    this.pointer = pointer;
  }
}

/** @param {string} text @param {string} pointer */
function parsed(text, pointer) {
  try {
    return JSON.parse(text);
  } catch (error) {
    throw new Unreadable(pointer, `This is not JSON: ${error instanceof Error ? error.message : ""}`);
  }
}

/** @param {string} text @returns {any} the object that it is the JSON of, or null */
function object(text) {
  try {
    const value = JSON.parse(text);
    return typeof value === "object" && !Array.isArray(value) ? value : null;
  } catch {
    return null;
  }
}

/** @template T @param {() => T} survey */
function pasted(survey) {
  try {
    return survey();
  } catch (error) {
    throw error instanceof NoSurvey ? new Unreadable(`/set/${SURVEY}`, error.message) : error;
  }
}

/** What a change sets its field to. @param {{name: string, values: string}} row */
function changeOf({ name, values }) {
  if (values.trim() === "") throw new Unreadable(`/set/${name}`, "A value is missing");
  return read(values);
}

/** A value of the scenario: JSON, or else a word. @param {string} text */
function read(text) {
  try {
    return JSON.parse(text);
  } catch {
    return text;
  }
}

/**
 * @param {string} text such as `0.01, 0.02` or `0.01:0.06:6:log`
 * @param {string} name
 * @param {boolean} isDrawn whether the design draws the values
 */
export function span(text, name, isDrawn) {
  const pointer = `/axes/${name}`;
  const numbers = (/** @type {string[]} */ words) =>
    words.map((word) => {
      const value = Number(word);
      if (word.trim() === "" || Number.isNaN(value))
        throw new Unreadable(pointer, `${word.trim() || "An empty value"} is not a number`);
      return value;
    });
  if (!text.includes(":")) return { values: numbers(text.split(",")) };
  const parts = text.split(":").map((part) => part.trim());
  const scale = parts.at(-1) === "log" ? { scale: "log" } : {};
  const [from, to, count] = numbers("scale" in scale ? parts.slice(0, -1) : parts);
  if (to === undefined) throw new Unreadable(pointer, "A range is written from:to:count");
  if (count === undefined && !isDrawn) throw new Unreadable(pointer, "A range needs a count: from:to:count");
  return count === undefined ? { from, to, ...scale } : { from, to, count, ...scale };
}

/** An axis of a request as the form writes it. @param {any} axis */
export function written(axis) {
  if (axis.values) return axis.values.join(", ");
  return [axis.from, axis.to, axis.count, axis.scale === "log" ? "log" : undefined]
    .filter((part) => part !== undefined)
    .join(":");
}

/** @param {any} answer of a dry run */
function plannedPart(answer) {
  const row = (/** @type {string} */ name, /** @type {any} */ value) => [
    h("dt", {}, name),
    h("dd", {}, value),
  ];
  const { plan } = answer;
  const accuracies = (plan?.accuracies ?? []).map((/** @type {any} */ one, /** @type {number} */ index) => {
    const known = index === 0 ? answer.known : answer.known_at?.[one.name];
    const time = (/** @type {number} */ points) => (points ? duration(one.cpu_time * points) : "none");
    return h(
      "tr",
      {},
      h("td", {}, one.name, index === 0 && h("span", { class: "soft" }, " (chosen)")),
      h("td", { class: "number" }, String(one.elements)),
      h("td", { class: "number" }, duration(one.step)),
      h("td", { class: "number" }, one.cpu_time ? duration(one.cpu_time) : "–"),
      h("td", { class: "number" }, known ?? "not looked up"),
      h(
        "td",
        { class: "number" },
        one.cpu_time ? `${known === undefined ? "at most " : ""}${time(answer.total - (known ?? 0))}` : "–",
      ),
    );
  });
  const footprint = plan?.footprint ?? {};
  const growing = plan?.undamped_torsion?.growing_modes;
  return [
    h(
      "dl",
      { class: "facts" },
      row("Points", String(answer.total)),
      row("Known already", `${answer.known}, not computed again`),
      answer.verification &&
        row(
          "Verified",
          `${answer.verification.total}, ${answer.verification.known} of the reference runs known already`,
        ),
      row(
        "Time",
        answer.known === answer.total
          ? "none: all results are there"
          : answer.wall_time !== undefined && answer.wall_time !== null
            ? `about ${duration(answer.wall_time)} on the workers there are`
            : answer.cpu_time
              ? `${duration(answer.cpu_time)} of processor time; no worker is there now`
              : "not known",
      ),
      row(
        "Storage",
        answer.table_bytes ? `about ${bytes(answer.table_bytes)} before compression` : "nothing further",
      ),
      plan &&
        row(
          "Tables of a point",
          `about ${bytes(footprint.table_bytes)} before compression${footprint.snapshot_bytes ? `, of that ${bytes(footprint.snapshot_bytes)} of snapshots` : ""}`,
        ),
      plan && row("String", `${plan.elements} elements, ${number(plan.simulated_time)} s simulated`),
    ),
    accuracies.length
      ? h(
          "div",
          { class: "scroll", tabindex: "0", role: "region", "aria-label": "Times at each accuracy" },
          h(
            "table",
            {},
            h(
              "thead",
              {},
              h(
                "tr",
                {},
                h("th", {}, "Accuracy"),
                h("th", { class: "number" }, "Elements"),
                h("th", { class: "number" }, "Longest step"),
                h("th", { class: "number" }, "A point"),
                h("th", { class: "number" }, "Known points"),
                h("th", { class: "number" }, "To compute, on one core"),
              ),
            ),
            h("tbody", {}, accuracies),
          ),
        )
      : null,
    (plan?.warnings ?? []).map((/** @type {string} */ warning) => h("p", { class: "wrong" }, warning)),
    growing
      ? h(
          "p",
          { class: "small soft" },
          `${growing} torsional ${growing === 1 ? "mode grows" : "modes grow"}, up to ${number(plan.undamped_torsion.highest_hz, 3)} Hz. Torque on bit is constant: stick-slip at the bit is not judged.`,
        )
      : null,
  ];
}

/** The same request for other programs. @param {any} body @returns {import("../ui/snippets.js").Lines} */
function requestLines(body) {
  const server = location.origin;
  const { preset, scenario, set, axes = {}, design, samples, seed, ...rest } = body;
  const axisLine = (/** @type {any} */ axis) =>
    axis.values
      ? python(axis.values)
      : axis.count
        ? `Range(${axis.from}, ${axis.to}, ${axis.count}${axis.scale ? ', scale="log"' : ""})`
        : `Range(${axis.from}, ${axis.to}${axis.scale ? ', scale="log"' : ""})`;
  const arguments_ = [
    preset ? JSON.stringify(preset) : 'scenario=json.load(open("scenario.json"))',
    set && `set=${python(set)}`,
    Object.keys(axes).length &&
      `axes={${Object.entries(axes)
        .map(([name, axis]) => `${JSON.stringify(name)}: ${axisLine(axis)}`)
        .join(", ")}}`,
    ...Object.entries(rest).map(([name, value]) => `${name}=${python(value)}`),
  ].filter(Boolean);
  if (design)
    arguments_.push(`design="${design}"`, ...(samples ? [`samples=${samples}`, `seed=${seed}`] : []));
  const options = [
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
  return {
    ...bodyLines("/v1/sweeps", body),
    python: `${scenario ? "import json\n\n" : ""}from drillsweep import Client, Range\n\nsweep = Client("${server}").submit(\n    ${arguments_.join(",\n    ")},\n)\nsweep.wait()`,
    cli: `drillsweep submit ${preset ?? "scenario.json"} ${options.join(" \\\n    ")} --server ${server}`,
  };
}
