// The form for a new sweep, with the plan of its request next to it.

import { connection, get, Problem, send } from "../data/api.js";
import { settings } from "../data/settings.js";
import { NoSurvey } from "../data/survey.js";
import { label, pathNames } from "../data/units.js";
import { choice, debounced, fill, h } from "../ui/dom.js";
import { attend } from "../ui/notices.js";
import { go, held, hold, keep, link } from "../ui/router.js";
import { MAY_NOT, maySubmit } from "../ui/session.js";
import { snippets } from "../ui/snippets.js";
import { Accuracy, accuracyWay } from "./accuracy.js";
import { FieldsPart } from "./fields.js";
import { HOLE, holePart, isHole } from "./hole.js";
import { Kept } from "./kept.js";
import { isMesh, MESH, meshFields } from "./mesh.js";
import { plannedPart } from "./plan.js";
import { Preview } from "./preview.js";
import { field, mark } from "./problems.js";
import { isRecording, Recording } from "./recording.js";
import { Rows } from "./rows.js";
import { isSection } from "./scenario-form.js";
import { submitLines } from "./snippets.js";
import { Source } from "./source.js";
import { surveyField } from "./survey-field.js";
import { isTally, STRING, stringPart } from "./tally.js";
import { changeOf, object, span, Unreadable, written } from "./values.js";

/** Characters of a request that a link may hold; a longer one is held next to it. */
const LINKED = 4000;
/** Member of the link in the place of such a request. */
const HELD = "held";
const SURVEY = "well.survey";
/** Short names of parameters. @type {Record<string, string>} */
const ALIASES = { flow_rate: "mud.flow_rate", mud_density: "mud.density" };
/** Members of a request that the form has fields for, and its owner, who is the person that submits it; others are carried over as they are. */
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
const DRAWN = ["latin_hypercube", "sobol"];
/** Rest of typing before the request is planned. */
const REST_MS = 400;

/** @type {[string, string][]} */
const DESIGNS = [
  ["grid", "grid: all combinations"],
  ["zip", "zip: values side by side"],
  ["latin_hypercube", "Latin hypercube"],
  ["sobol", "Sobol sequence"],
];
/** The request that the form begins with, and whether it is continued in place of a proposal. @typedef {{start: any, isGoneOn: boolean}} Begun */

/** @type {import("../ui/router.js").View} */
export async function show(main, route, signal) {
  const { scenarios } = await get("/v1/scenarios", {}, signal);
  const begun = await begin(route.query, signal);
  const sweep = new NewSweep(scenarios, begun, signal);
  const paths = ["flow_rate", "mud_density", ...pathNames()].map((entry) =>
    h("option", { value: entry }, label(entry)),
  );
  sweep.form.append(h("datalist", { id: "paths" }, paths));
  fill(
    main,
    h("div", { class: "head" }, h("h1", {}, "New sweep")),
    route.query.has(HELD) &&
      !begun.isGoneOn &&
      h(
        "p",
        { class: "wrong", role: "status" },
        "The request of this link was too long for it; only the tab in which it was made keeps it.",
      ),
    h(
      "div",
      { class: "half" },
      sweep.form,
      h(
        "aside",
        { "aria-label": "What it would become" },
        h(
          "section",
          { class: "panel", "aria-label": "Plan", "aria-live": "polite" },
          h("h2", {}, "What it would become"),
          sweep.planned,
        ),
        sweep.preview.element,
      ),
    ),
    sweep.taken,
  );
  void sweep.plan();
  return "New sweep";
}

class NewSweep {
  #carried;
  #signal;
  #name;
  #tags;
  #samples;
  #seed;
  #verify;
  #axes;
  #changes;
  #recording;
  /** Folded parts with fields in whole. */
  #parts;
  #survey;
  #source;
  #design;
  #accuracy;
  #kept;
  #rested;
  #isSent = false;
  /** Numbers the plans, so that an older one is dropped. */
  #generation = 0;
  #drawnPart = h("div", { class: "controls" });
  #beside = h("p", { class: "small soft", role: "status" });
  #general = h("p", { class: "wrong", role: "alert" });
  #submit = h("button", { class: "main", type: "submit", disabled: true }, "Submit");
  planned = h("div", {});
  taken = snippets(() => this.#lines());

  /** @param {any[]} scenarios the presets @param {Begun} begun @param {AbortSignal} signal */
  constructor(scenarios, { start, isGoneOn }, signal) {
    this.#signal = signal;
    this.#carried = isGoneOn
      ? Object.fromEntries(Object.entries(start).filter(([name]) => !FIELDS.includes(name)))
      : {};
    this.#rested = debounced(() => void this.plan(), REST_MS, signal);
    const changed = () => this.#changed();
    const box = (/** @type {string} */ value, /** @type {Record<string, any>} */ attributes = {}) =>
      h("input", { value, oninput: changed, ...attributes });
    this.#name = box(start.name ?? "", { maxlength: 200 });
    this.#tags = box((start.tags ?? []).join(", "), { placeholder: "separated by commas" });
    this.#samples = box(String(start.samples ?? 64), { type: "number", min: 1 });
    this.#seed = box(String(start.seed ?? 0), { type: "number", min: 0 });
    this.#verify = box(start.verify ? String(start.verify) : "", { placeholder: "such as 0.05 or 10" });
    this.#design = start.design ?? "grid";
    const isShown = accuracyWay(start.set?.accuracy) !== undefined;
    this.#accuracy = new Accuracy(isShown ? start.set?.accuracy : undefined, changed);
    this.#kept = new Kept(start.outputs, changed);
    const axes = Object.entries(start.axes ?? (isGoneOn ? {} : preload.PROPOSED.axes));
    this.#axes = new Rows(
      "axes",
      axes.map(([name, axis]) => ({ name, values: written(axis) })),
      changed,
    );
    const set = Object.entries(start.set ?? {}).filter(
      ([name]) => !(name === "accuracy" && isShown) && name !== SURVEY,
    );
    this.#changes = new Rows("set", rowsOf(Object.fromEntries(set)), changed, isElsewhere);
    this.#parts = [
      new FieldsPart("String: tally, gauges, unbalance", STRING, this.#changes, stringPart(signal), signal),
      new FieldsPart("Hole: casings and open hole", [HOLE], this.#changes, holePart(signal), signal),
      new FieldsPart("Mesh", [MESH], this.#changes, meshFields, signal),
    ];
    this.#recording = new Recording(this.#changes, signal);
    this.#survey = surveyField(start.set?.[SURVEY], changed, signal);
    this.preview = new Preview(signal);
    const on = {
      changed,
      refused: (/** @type {import("./problems.js").Found[]} */ problems) => this.#mark(problems),
      took: (/** @type {Record<string, unknown>} */ given) => this.#take(given),
      shown: (/** @type {any} */ scenario) =>
        [this.#recording, ...this.#parts].forEach((part) => part.show(scenario)),
      changes: this.#changes,
    };
    this.#source = new Source(scenarios, start, on, signal);
    this.form = h(
      "form",
      { novalidate: true, onsubmit: (/** @type {Event} */ event) => this.#send(event) },
      this.#scenarioPart(),
      this.#parametersPart(),
      this.#namePart(),
      h("div", { class: "panel submit" }, this.#submit, this.#general),
    );
    this.#drawDesign();
    settings.addEventListener(
      "change",
      () => {
        this.#survey.say();
        this.#axes.convert();
        this.#changes.convert();
        changed();
      },
      { signal },
    );
    connection.addEventListener("found", changed, { signal });
  }

  #scenarioPart() {
    return h(
      "section",
      { class: "panel", "aria-label": "Scenario" },
      this.#source.element,
      h("div", { class: "controls" }, this.#accuracy.element, this.#kept.element),
      h("h2", {}, "Changes to the scenario"),
      this.#changes.element,
      this.#recording.element,
      this.#parts.map(({ element }) => element),
      this.#source.fields,
      this.#survey.element,
    );
  }

  #parametersPart() {
    const help =
      "Values separated by commas, or from:to:count, with :log for logarithmic spacing. Drawn designs take from:to.";
    return h(
      "section",
      { class: "panel", "aria-label": "Parameters", "data-pointer": "/axes" },
      h("h2", {}, "What is varied"),
      h("p", { class: "small soft" }, help),
      this.#drawnPart,
      this.#axes.element,
    );
  }

  #namePart() {
    const controls = h(
      "div",
      { class: "controls" },
      field("Name", this.#name, "/name"),
      field("Tags", this.#tags, "/tags"),
      field("Verify a sample", this.#verify, "/verify"),
    );
    return h("section", { class: "panel", "aria-label": "Name" }, controls, this.#beside);
  }

  get #isDrawn() {
    return DRAWN.includes(this.#design);
  }

  #drawDesign() {
    const design = choice("Design", DESIGNS, this.#design, (value) => {
      this.#design = value;
      this.#drawDesign();
      this.#changed();
    });
    fill(
      this.#drawnPart,
      design,
      this.#isDrawn && [field("Points", this.#samples, "/samples"), field("Seed", this.#seed, "/seed")],
    );
  }

  /** Plans the request once typing rests; only what was planned can be submitted, so that an older plan is void. */
  #changed() {
    this.#generation += 1;
    this.#submit.disabled = true;
    this.#rested();
  }

  /** Takes the changes of a scenario file; parameters that it sets are not varied. @param {Record<string, unknown>} set */
  #take(set) {
    this.#changes.replace(rowsOf(set));
    [this.#recording, ...this.#parts].forEach((part) => part.draw());
    this.#axes.keep(({ name }) => !((ALIASES[name] ?? name) in set));
  }

  /** The request that the form stands for; throws if a text cannot be read. */
  #request() {
    /** @type {any} */
    const body = { ...this.#carried };
    if (this.#design !== "list") delete body.points;
    if (this.#name.value.trim()) body.name = this.#name.value.trim();
    Object.assign(body, this.#source.request);
    const set = Object.fromEntries(this.#changes.named.map((row) => [row.name, changeOf(row)]));
    const accuracy = this.#accuracy.value;
    if (accuracy) set.accuracy = accuracy;
    const stations = pasted(this.#survey.read);
    if (stations) set[SURVEY] = stations;
    if (Object.keys(set).length) body.set = set;
    const used = this.#axes.named;
    if (used.length)
      body.axes = Object.fromEntries(
        used.map((row) => [row.name, span(row.values, row.name, this.#isDrawn)]),
      );
    if (this.#design !== "grid") body.design = this.#design;
    if (this.#isDrawn)
      Object.assign(body, { samples: Number(this.#samples.value), seed: Number(this.#seed.value) });
    const words = this.#tags.value
      .split(",")
      .map((word) => word.trim())
      .filter(Boolean);
    if (words.length) body.tags = words;
    const { outputs } = this.#kept;
    if (outputs) body.outputs = outputs;
    if (this.#verify.value.trim()) body.verify = Number(this.#verify.value);
    return body;
  }

  #lines() {
    try {
      return submitLines(this.#request());
    } catch {
      return { curl: "# The request cannot be read yet." };
    }
  }

  /** @param {import("./problems.js").Found[]} problems */
  #mark(problems) {
    this.#general.textContent = mark(this.form, problems);
  }

  /** Keeps the request in the link, or in the tab if it is too long. @param {any} body */
  #keep(body) {
    const text = JSON.stringify(body);
    const isLinked = text.length <= LINKED;
    keep({ from: null, preset: null, request: isLinked ? text : null, [HELD]: isLinked ? null : "tab" });
    hold(isLinked ? null : text);
    this.#beside.textContent = isLinked
      ? ""
      : "This request is too long for the link of this page. This tab keeps it, when the page is loaded again and when you go back or forward. To share it, copy its lines below.";
  }

  /** Plans the request by a dry run. */
  async plan() {
    const mine = ++this.#generation;
    this.taken.dispatchEvent(new Event("redraw"));
    this.#submit.disabled = true;
    attend(this.#source.drawFields(), this.#signal);
    try {
      const body = this.#request();
      this.#keep(body);
      const answer = await send("POST", "/v1/sweeps?dry_run=true", body, this.#signal);
      if (mine !== this.#generation) return;
      this.#mark(answer.warnings ?? []);
      fill(this.planned, ...plannedPart(answer));
      this.#recording.plan(answer.plan);
      this.#parts.forEach((part) => part.refresh());
      this.#submit.disabled = this.#isSent || !maySubmit();
      this.#submit.title = maySubmit() ? "" : MAY_NOT;
      this.#submit.textContent = `Submit ${answer.total} ${answer.total === 1 ? "point" : "points"}`;
      await this.preview.draw(answer.points);
    } catch (error) {
      if (!this.#signal.aborted && mine === this.#generation) this.#refuse(error);
    }
  }

  /** Shows why there is no plan. @param {unknown} error */
  #refuse(error) {
    if (error instanceof Problem)
      this.#mark(error.errors.length ? error.errors : [{ detail: error.message }]);
    else if (error instanceof Unreadable) this.#mark([{ pointer: error.pointer, detail: error.message }]);
    else this.#general.textContent = error instanceof Error ? error.message : String(error);
    const isRefused = error instanceof Unreadable || (error instanceof Problem && error.status < 500);
    fill(
      this.planned,
      h(
        "p",
        { class: "soft" },
        isRefused
          ? "The plan appears here once the request can be read."
          : "The plan appears here once the server answers.",
      ),
    );
    this.preview.hide();
  }

  /** @param {Event} event */
  async #send(event) {
    event.preventDefault();
    this.#submit.disabled = true;
    this.#isSent = true;
    try {
      const sweep = await send("POST", "/v1/sweeps", this.#request());
      go(link(["sweeps", sweep.id]));
    } catch (error) {
      this.#mark(
        error instanceof Problem && error.errors.length
          ? error.errors
          : [{ detail: error instanceof Error ? error.message : String(error) }],
      );
      this.#isSent = false;
      this.#submit.disabled = false;
    }
  }
}

/** True of changes that parts of the form show in place of rows. @param {import("./rows.js").Row} row */
function isElsewhere(row) {
  return isRecording(row) || isMesh(row) || isTally(row) || isHole(row) || isSection(row);
}

/** Rows of a request's changes. @param {Record<string, unknown>} set @returns {import("./rows.js").Row[]} */
function rowsOf(set) {
  return Object.entries(set).map(([name, value]) => ({ name, values: JSON.stringify(value) }));
}

/**
 * The request that the form begins with: that of the link, of another sweep, or none; and whether it goes on with this, instead of one that
 * it proposes.
 * @param {URLSearchParams} query
 * @param {AbortSignal} signal
 * @returns {Promise<Begun>}
 */
async function begin(query, signal) {
  const from = query.get("from");
  if (from) {
    const sweep = await get(`/v1/sweeps/${encodeURIComponent(from)}`, {}, signal);
    const request = sweep.request ?? (await get(sweep.links.request, {}, signal));
    return { start: { ...request, tags: request?.tags ?? [] }, isGoneOn: true };
  }
  const request = query.get("request") ?? (query.has(HELD) ? held() : null);
  return {
    start: { ...(query.has("preset") ? { preset: query.get("preset") } : {}), ...object(request ?? "") },
    isGoneOn: request !== null,
  };
}

/** @template T @param {() => T} survey */
function pasted(survey) {
  try {
    return survey();
  } catch (error) {
    throw error instanceof NoSurvey ? new Unreadable(`/set/${SURVEY}`, error.message) : error;
  }
}
