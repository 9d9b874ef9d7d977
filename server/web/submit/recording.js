// What a new sweep records: nodes, windows of statistics and of spectra, and snapshots of the string in motion.

import { settings } from "../data/settings.js";
import { bytes, inputUnit } from "../data/units.js";
import { choice, fill, h } from "../ui/dom.js";
import { button, group, isChangedIn, numberBox } from "./fields.js";
import { changedField } from "./members.js";
import { read } from "./values.js";

/** Fields of the scenario that this part shows. */
const [NODES, WINDOWS, SNAPSHOTS] = ["recording.nodes", "recording.spectrum_windows", "recording.snapshots"];
/** Window of the statistics: a fixed one, `settled`, or none for the last third of the run. */
const ORBIT_WINDOW = "recording.orbit_window";
/** Rate of snapshots that is proposed [Hz]. */
const PROPOSED_HZ = 25;
/** Size of a node in a snapshot before compression: time and number in eight bytes each, seven quantities in four. */
const NODE_BYTES = 8 + 8 + 7 * 4;

/** Ways to choose the window of the statistics. @type {[string, string][]} */
const WAYS = [
  ["last", "the last third of the run"],
  ["settled", "settled: the run ends once the statistics agree"],
  ["fixed", "fixed"],
];

/** @typedef {{node: number} | {depth: number} | {above_bit: number}} Node */
/** @typedef {{from: number, to: number}} Window */

/**
 * True of a change that this part of the form can show.
 * @param {import("./rows.js").Row} row
 */
export function isRecording({ name, values }) {
  const value = read(values);
  const isList = (/** @type {(one: any) => boolean} */ fits) => Array.isArray(value) && value.every(fits);
  if (name === NODES)
    return isList((one) =>
      [one?.depth, one?.node, one?.above_bit].some((place) => typeof place === "number"),
    );
  if (name === WINDOWS)
    return value === null || isList((one) => typeof one?.from === "number" && typeof one?.to === "number");
  if (name === ORBIT_WINDOW) return wayOf(value) !== undefined;
  return name === SNAPSHOTS && (value === null || typeof value?.rate_hz === "number");
}

/** Way in which the window of the statistics is chosen; undefined for a value that is none. @param {any} window */
export function wayOf(window) {
  if (window === null || window === undefined) return "last";
  if (window === "settled") return "settled";
  return typeof window.from === "number" && typeof window.to === "number" ? "fixed" : undefined;
}

/**
 * Memory of the snapshots of a point before compression, if they are not planned yet.
 * @param {{elements: number, simulated_time: number}} plan
 */
export function snapshotBytes({ elements, simulated_time }) {
  return PROPOSED_HZ * simulated_time * (elements + 1) * NODE_BYTES;
}

/** Fields of what is recorded, as lists; changes go to the rows of the form. */
export class Recording {
  #changes;
  /** @type {any} */
  #scenario = null;
  /** Size of the snapshots of a point, in words. */
  #size = h("span", {});
  #lists = h("div", {});
  #motion = h("div", { "data-pointer": `/set/${SNAPSHOTS}` });
  element = h(
    "div",
    {},
    this.#motion,
    h("details", {}, h("summary", {}, "Recorded nodes, windows of statistics and spectra"), this.#lists),
  );

  /** @param {import("./rows.js").Rows} changes @param {AbortSignal} signal of the view */
  constructor(changes, signal) {
    this.#changes = changes;
    settings.addEventListener("change", () => this.draw(), { signal });
    this.draw();
  }

  /** Shows what a scenario records; `null` stands for one that cannot be read. @param {any} scenario */
  show(scenario) {
    this.#scenario = scenario;
    this.draw();
  }

  /** Shows the size of snapshots. @param {any} plan of a dry run */
  plan(plan) {
    const size = plan && (plan.footprint?.snapshot_bytes || snapshotBytes(plan));
    this.#size.textContent = size ? ` (about ${bytes(size)} a point, before compression)` : "";
  }

  /** @param {string} name */
  #value(name) {
    const changed = this.#changes.get(name);
    return changed === undefined ? this.#scenario?.recording?.[name.slice("recording.".length)] : changed;
  }

  /** Changes a field, and shows it. @param {string} name @param {unknown} value */
  #set(name, value) {
    this.#changes.set(name, value);
    this.draw();
  }

  draw() {
    if (!this.#scenario) {
      fill(this.#motion);
      fill(this.#lists, h("p", { class: "small soft" }, "They appear here once the scenario can be read."));
      return;
    }
    fill(this.#motion, this.#snapshots());
    fill(
      this.#lists,
      this.#part("Nodes", NODES, this.#nodes()),
      this.#part("Window of the statistics", ORBIT_WINDOW, this.#orbitWindow()),
      this.#part("Windows of spectra", WINDOWS, this.#windows()),
    );
  }

  /** @param {string} heading @param {string} name @param {HTMLElement[]} lines */
  #part(heading, name, lines) {
    const edited = {
      isChanged: (/** @type {string} */ path) => isChangedIn(this.#changes, path),
      set: (/** @type {string} */ path, /** @type {undefined} */ value) => {
        this.#changes.put(path, value);
        this.draw();
      },
    };
    return group(heading, name, edited, lines);
  }

  /**
   * A number in the reader's unit.
   * @param {string} label
   * @param {string} name of the quantity
   * @param {number | undefined} value served
   * @param {(value: number) => void} set
   */
  #number(label, name, value, set) {
    return numberBox(label, name, value, (entered) => entered !== undefined && set(entered));
  }

  #nodes() {
    /** @type {Node[]} */
    const nodes = this.#value(NODES) ?? [];
    const put = (/** @type {number} */ at, /** @type {Node} */ node) =>
      this.#set(
        NODES,
        nodes.map((one, index) => (index === at ? node : one)),
      );
    const lines = nodes.map((node, at) => {
      const [[way, value]] = /** @type {[string, number][]} */ (Object.entries(node));
      const nodeBy = (/** @type {string} */ chosen, /** @type {number} */ place) =>
        /** @type {Node} */ ({ [chosen]: chosen === "node" ? Math.round(place) : place });
      const { symbol } = inputUnit("measured_depth");
      const ways = [
        ["depth", `at depth [${symbol}]`],
        ["above_bit", `above the bit [${symbol}]`],
        ["node", "by number"],
      ];
      const kind = h(
        "select",
        {
          "aria-label": `Kind of node ${at + 1}`,
          onchange: () => put(at, nodeBy(kind.value, value)),
        },
        ways.map(([name, text]) => h("option", { value: name, selected: name === way }, text)),
      );
      const box = this.#number(
        `Node ${at + 1}`,
        way === "node" ? "node" : "measured_depth",
        value,
        (entered) => put(at, nodeBy(way, entered)),
      );
      const remove = () =>
        this.#set(
          NODES,
          nodes.filter((_, index) => index !== at),
        );
      return h("div", { class: "line" }, kind, box, button("✕", remove, `Remove node ${at + 1}`));
    });
    const deepest = Math.max(0, ...nodes.map((node) => ("depth" in node ? node.depth : 0)));
    return [...lines, button("Add a node", () => this.#set(NODES, [...nodes, { depth: deepest }]))];
  }

  /** Simulated time as it is changed [s]. */
  get #duration() {
    return Number(this.#changes.get("duration") ?? this.#scenario.duration);
  }

  /** Window of the statistics as it is changed; a fixed one of the scenario does not hold for another duration. */
  get #statistics() {
    const isOther =
      this.#changes.get(ORBIT_WINDOW) === undefined && this.#changes.get("duration") !== undefined;
    const given = changedField(this.#changes, ORBIT_WINDOW, this.#scenario.recording.orbit_window);
    return isOther && wayOf(given) === "fixed" && !this.#changes.within(ORBIT_WINDOW).length ? null : given;
  }

  #orbitWindow() {
    const window = this.#statistics;
    const way = wayOf(window) ?? "last";
    const duration = this.#duration;
    const fixed = { from: Number((duration / 2).toPrecision(6)), to: duration };
    const choose = (/** @type {string} */ chosen) =>
      this.#put(ORBIT_WINDOW, chosen === "fixed" ? fixed : chosen === "settled" ? "settled" : null);
    const ways = choice("Window", WAYS, way, choose);
    if (way === "settled")
      return [
        ways,
        h(
          "p",
          { class: "small soft" },
          `It runs in blocks of 10 s, for ${duration} s at most, the scenario's duration; usual 300 s.`,
        ),
      ];
    if (way === "last") return [ways];
    const end = (/** @type {"from" | "to"} */ name) =>
      this.#number(`Statistics ${name} [s]`, "time", window[name], (value) =>
        this.#put(ORBIT_WINDOW, { ...window, [name]: value }),
      );
    return [ways, h("div", { class: "line" }, end("from"), " to ", end("to"), " s")];
  }

  /** Changes a field in whole, and shows it. @param {string} name @param {unknown} value */
  #put(name, value) {
    const given = this.#scenario.recording[name.slice("recording.".length)] ?? null;
    const isGiven =
      JSON.stringify(value) === JSON.stringify(given) && this.#changes.get("duration") === undefined;
    this.#changes.put(name, isGiven ? undefined : value);
    this.draw();
  }

  #windows() {
    const isOther = this.#changes.get(WINDOWS) === undefined && this.#changes.get("duration") !== undefined;
    /** @type {Window[] | null} */
    const given = (isOther ? null : this.#value(WINDOWS)) ?? null;
    const windows = given ?? [];
    const lines = windows.map((window, at) => {
      const end = (/** @type {"from" | "to"} */ name) =>
        this.#number(`Window ${at + 1} ${name} [s]`, "time", window[name], (value) =>
          this.#set(
            WINDOWS,
            windows.map((one, index) => (index === at ? { ...one, [name]: value } : one)),
          ),
        );
      const remove = () =>
        this.#set(
          WINDOWS,
          windows.filter((_, index) => index !== at),
        );
      return h(
        "div",
        { class: "line" },
        end("from"),
        " to ",
        end("to"),
        " s ",
        button("✕", remove, `Remove window ${at + 1}`),
      );
    });
    const text = given
      ? "No spectra."
      : "The window of the statistics, or the last sixth of a run of fixed duration.";
    const last = this.#duration;
    const next = { from: Number((last / 2).toPrecision(6)), to: last };
    return [
      ...(windows.length ? lines : [h("p", { class: "small soft" }, text)]),
      button("Add a window", () => this.#set(WINDOWS, [...windows, next])),
    ];
  }

  #snapshots() {
    const snapshots = this.#value(SNAPSHOTS);
    const recorded = Number(this.#changes.get("recording.rate_hz") ?? this.#scenario.recording.rate_hz);
    // A whole part of the recording rate.
    const proposed = Number((recorded / Math.max(1, Math.round(recorded / PROPOSED_HZ))).toFixed(6));
    const box = h("input", {
      type: "checkbox",
      checked: Boolean(snapshots),
      onchange: () =>
        this.#set(
          SNAPSHOTS,
          box.checked ? { rate_hz: proposed } : this.#scenario.recording.snapshots ? null : undefined,
        ),
    });
    const tick = h("label", { class: "tick" }, box, "Keep the string in motion", this.#size);
    if (!snapshots) return [tick];
    const { window } = snapshots;
    const put = (/** @type {any} */ change) => this.#set(SNAPSHOTS, { ...snapshots, ...change });
    const end = (/** @type {"from" | "to"} */ name, /** @type {number} */ usual) =>
      this.#number(`Snapshots ${name} [s]`, "time", window?.[name] ?? usual, (value) =>
        put({ window: { from: window?.from ?? 0, to: window?.to ?? usual, [name]: value } }),
      );
    const duration = this.#duration;
    return [
      tick,
      h(
        "div",
        { class: "line" },
        this.#number("Snapshots a second", "recording.snapshots.rate_hz", snapshots.rate_hz, (value) =>
          put({ rate_hz: value }),
        ),
        " a second, from ",
        end("from", 0),
        " to ",
        end("to", duration),
        " s",
      ),
    ];
  }
}
