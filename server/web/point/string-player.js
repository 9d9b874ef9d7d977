// Strings moving in their holes, played from snapshots on one clock: the string of a point, or several side by side.

import { streamFrames, valueAt } from "../data/snapshots.js";
import { magnified, MAGNIFICATIONS, meansOf, suitedMagnification } from "../data/mean-motion.js";
import { kindsOf, partsOf } from "../data/string-parts.js";
import { say, shown, unit } from "../data/units.js";
import { nodeFrames } from "../data/well-frames.js";
import { scaleParts, scaleWords } from "../draw/colour-scale.js";
import { SharedView } from "../draw/shared-view.js";
import { KEYS } from "../draw/string-scene.js";
import { choice, fill, h } from "../ui/dom.js";
import { attend } from "../ui/notices.js";
import { BEYOND } from "./contacts.js";
import { colourName, EXAGGERATIONS, PlayerChoices, SPEEDS } from "./player-choices.js";
import { coloursOf } from "./string-colours.js";
import { saveStrings } from "./string-file.js";

/** @typedef {import("../data/snapshots.js").Frames} Frames */
/** @typedef {import("./player-choices.js").Strings} Strings */

/**
 * One string with its picture; `isWhole` is true once all snapshots of the window have arrived.
 * @typedef {Strings[number] & {geometry: ReturnType<typeof nodeFrames>, kinds: import("../data/string-parts.js").Kind[], motion: Frames | null, isWhole: boolean, means: import("../data/mean-motion.js").Means | null, colours: import("./string-colours.js").Colours, scene: import("../draw/string-scene.js").StringScene}} Actor
 */

/** Time of the last snapshot [s]. @param {Frames} motion */
function lastTime({ first, count, interval }) {
  return first + (count - 1) * interval;
}

/** Words of a magnification. @param {number} factor */
function timesMore(factor) {
  return factor === 1 ? "no more" : `${factor} times more`;
}

export class StringPlayer {
  #choices;
  /** @type {Actor[]} */
  #actors;
  #onLoad;
  #keep;
  #signal;
  #cursor;
  #view;
  #controls = h("div", { class: "controls" });
  #wrong = h("p", { class: "wrong", role: "alert" });
  #legend = h("div", { class: "scale" });
  #caption = h("figcaption", {});
  #play = h("button", { class: "main", onclick: () => this.#setPlaying(!this.#isPlaying) }, "Play");
  #clock = h("output", { class: "number" });
  #arrival = h("span", { class: "small soft", role: "status" });
  #slider = h("input", {
    type: "range",
    "aria-label": "Time",
    min: 0,
    max: 1,
    step: "any",
    value: 0,
    style: "flex:1;min-width:8rem",
    oninput: () => this.#cursor.move(Number(this.#slider.value)),
  });
  #isPlaying = false;
  #time = 0;
  /** Time of the cursor, until its snapshots have arrived [s]. @type {number | null} */
  #awaited = null;
  /** Time of the last frame that was played [ms]. */
  #last = 0;
  #generation = 0;

  /**
   * @param {Strings} strings
   * @param {(actors: Actor[], span: {from: number, to: number}) => Promise<unknown>} onLoad called once the snapshots of a window are loaded
   */
  constructor(strings, onLoad) {
    const { query, keep, time, signal } = strings[0].context;
    this.#choices = new PlayerChoices(strings);
    this.#onLoad = onLoad;
    this.#keep = keep;
    this.#signal = signal;
    this.#cursor = time;
    const geometries = strings.map(({ statics }) => nodeFrames(statics));
    // Several strings are seen from one place: that of the first one's section.
    this.#view = new SharedView(geometries[0].axis, { query, keep, signal });
    this.#actors = strings.map((one, order) => ({
      ...one,
      geometry: geometries[order],
      kinds: kindsOf(partsOf(one.context.point.scenario.string), one.statics.measured_depth),
      motion: null,
      isWhole: false,
      means: null,
      colours: { value: () => 0, range: [0, 1] },
      scene: this.#view.scene(
        `The string moving in its hole${one.heading && `, ${one.heading}`}; arrow keys turn it, + and - change its size, space plays`,
      ),
    }));
    signal.addEventListener("abort", () => this.#setPlaying(false), { once: true });
    time.follow((moved) => this.#follow(moved), signal);
    this.element = h(
      "div",
      {},
      this.#controls,
      this.#wrong,
      h(
        "div",
        { class: "panel" },
        h("div", { class: strings.length > 1 ? "half" : "" }, this.#panels()),
        h("div", { class: "controls player" }, this.#play, this.#slider, this.#clock, this.#arrival),
        this.#legend,
        this.#caption,
      ),
    );
  }

  #panels() {
    return this.#actors.map(({ scene, heading }) => {
      scene.element.setAttribute("aria-keyshortcuts", `Space ${KEYS}`);
      scene.element.addEventListener("keydown", (event) => {
        if (event.key !== " ") return;
        event.preventDefault();
        this.#setPlaying(!this.#isPlaying);
      });
      return h("figure", {}, heading && h("h2", {}, heading), scene.element);
    });
  }

  /** Window of time that is played [s]. */
  get span() {
    return this.#choices.span;
  }

  get #moving() {
    return this.#actors.flatMap(({ motion }) => (motion ? [motion] : []));
  }

  get #first() {
    return Math.min(...this.#moving.map((motion) => motion.first));
  }

  /** Time up to which the strings can be shown: all of them while snapshots are still to come, else the longest [s]. */
  get #end() {
    const arriving = this.#actors.flatMap(({ motion, isWhole }) => (motion && !isWhole ? [motion] : []));
    if (arriving.length) return Math.min(...arriving.map(lastTime));
    return Math.max(...this.#moving.map(lastTime));
  }

  get #isArriving() {
    return this.#actors.some(({ motion, isWhole }) => motion && !isWhole);
  }

  #drawControls() {
    const { offered, colour, factor, magnification, isStriped, speed, depths, span } = this.#choices;
    const set =
      (/** @type {string} */ name, /** @type {() => void} */ then) => (/** @type {string} */ value) => {
        this.#keep({ [name]: value });
        then();
      };
    const show = () => this.#show();
    const load = () => attend(this.load(), this.#signal);
    const speedName = (/** @type {string} */ text) =>
      text === "1"
        ? "as it happens"
        : Number(text) > 1
          ? `${text} times`
          : `1/${Math.round(1 / Number(text))}`;
    fill(
      this.#controls,
      choice(
        "Colour",
        offered.map(([name]) => [name, colourName(name)]),
        colour[0],
        set("colour", () => attend(this.#recolour(), this.#signal)),
      ),
      choice(
        "Distance from the axis",
        EXAGGERATIONS.map((text) => [text, text === "1" ? "to scale" : `${text} times`]),
        String(factor),
        set("exaggerate", show),
      ),
      choice(
        "Motion about the mean",
        [
          ["", `as it suits${this.#moving.length ? `, ${timesMore(this.#magnification)}` : ""}`],
          ...MAGNIFICATIONS.map((step) => /** @type {[string, string]} */ ([String(step), timesMore(step)])),
        ],
        String(magnification ?? ""),
        set("motion", show),
      ),
      this.#choices.has("theta_z") && this.#stripeTick(isStriped),
      choice(
        "Speed",
        SPEEDS.map((text) => [text, speedName(text)]),
        String(speed),
        set("speed", () => {}),
      ),
      this.#entry("From depth", "top", depths.from, "measured_depth", show),
      this.#entry("to depth", "bottom", depths.to, "measured_depth", show),
      this.#entry("From", "from", span.from, "time", load),
      this.#entry("to", "to", span.to, "time", load),
      this.#view.buttons(),
      h(
        "button",
        { onclick: () => this.#save("png"), "aria-label": "Save the string as PNG" },
        "Save as PNG",
      ),
      h(
        "button",
        { onclick: () => this.#save("svg"), "aria-label": "Save the string as SVG" },
        "Save as SVG",
      ),
    );
  }

  /** @param {boolean} isStriped */
  #stripeTick(isStriped) {
    const box = h("input", {
      type: "checkbox",
      checked: isStriped,
      onchange: () => {
        this.#keep({ stripe: box.checked ? null : "no" });
        attend(this.load(), this.#signal);
      },
    });
    return h("label", { class: "tick" }, box, "Stripe");
  }

  /** Factor by which the motion about the mean is multiplied, one for all strings. */
  get #magnification() {
    const suited = this.#actors.flatMap(({ means, statics }) =>
      means ? [suitedMagnification(means.reach, statics.clearance)] : [],
    );
    return this.#choices.magnification ?? Math.min(...suited);
  }

  /** A field for a number of the link. @param {string} text @param {string} name @param {number} value @param {string} quantity @param {() => void} then */
  #entry(text, name, value, quantity, then) {
    const { symbol, size } = unit(quantity);
    const entered = () => {
      this.#keep({ [name]: box.value === "" ? null : String(Number(box.value) * size) });
      then();
    };
    const box = h("input", {
      type: "number",
      step: "any",
      value: Number((value / size).toFixed(3)),
      style: "width:7rem",
      onchange: entered,
    });
    return h("label", { class: "field" }, h("span", {}, `${text} [${symbol}]`), box);
  }

  /** Loads the snapshots of the window that the link has. */
  async load() {
    const mine = ++this.#generation;
    const { span } = this.#choices;
    this.#wrong.textContent = "";
    this.#drawControls();
    this.#setPlaying(false);
    this.#awaited = this.#cursor.time;
    /** @type {(Frames | undefined)[]} */
    const arrived = this.#actors.map(() => undefined);
    let painted = Promise.resolve();
    const take = (
      /** @type {number} */ order,
      /** @type {Frames} */ motion,
      /** @type {boolean} */ isWhole,
    ) => {
      if (mine !== this.#generation) return;
      arrived[order] = motion;
      this.#actors[order].isWhole = isWhole;
      if (arrived.includes(undefined)) return;
      painted = painted.then(() => this.#take(/** @type {Frames[]} */ (arrived)));
      // A failure is met below.
      painted.catch(() => {});
    };
    this.#actors.forEach((actor) => Object.assign(actor, { motion: null, isWhole: false }));
    await Promise.all(
      this.#actors.map(({ context, there }, order) =>
        streamFrames(context, this.#streamed, span, there, (motion, isWhole) => take(order, motion, isWhole)),
      ),
    );
    await painted;
    if (mine !== this.#generation || this.#moving.length < this.#actors.length) return;
    this.#drawControls();
    await this.#onLoad(this.#actors, this.span);
  }

  /** Quantities that the picture needs, the one of the colours among them. */
  get #streamed() {
    const { isStriped, colour } = this.#choices;
    const [name, source] = colour;
    return [
      ...new Set([
        "u",
        "v",
        ...(this.#choices.has("normal_force") ? ["normal_force"] : []),
        ...(isStriped ? ["theta_z"] : []),
        ...(source === "snapshots" ? [name] : []),
      ]),
    ];
  }

  /** Shows snapshots that have arrived of all strings, on longer clocks each time. @param {Frames[]} arrived */
  async #take(arrived) {
    const still = this.#actors.find(({ isWhole }, order) => arrived[order].count < 2 && isWhole);
    if (still) {
      this.#wrong.textContent = `There are no two snapshots${still.heading && ` of ${still.heading}`} in this window; the next are ${say("time", still.there.interval)} apart.`;
      return;
    }
    const isFirst = !this.#moving.length;
    this.#actors.forEach((actor, order) => {
      // A colour that was chosen meanwhile has the snapshots of the whole window.
      actor.motion = { ...arrived[order], columns: { ...actor.motion?.columns, ...arrived[order].columns } };
      actor.means = meansOf(arrived[order]);
    });
    if (isFirst) this.#drawControls();
    this.#slider.min = String(this.#first);
    this.#slider.max = String(this.#end);
    fill(this.#arrival, this.#isArriving && `up to ${say("time", this.span.to)} on the way`);
    const colouring = this.#recolour();
    const isReached = this.#awaited !== null && (this.#awaited <= this.#end || !this.#isArriving);
    if (isReached) this.#go(/** @type {number} */ (this.#awaited));
    else if (isFirst) this.#go(this.#first);
    else this.#go(this.#time);
    if (isReached) this.#awaited = null;
    await colouring;
  }

  async #recolour() {
    if (!this.#moving.length) return;
    const mine = this.#generation;
    const { colour } = this.#choices;
    const found = await Promise.all(
      this.#actors.map((actor) => coloursOf(actor, colour, { span: this.span, now: () => this.#time })),
    );
    if (mine !== this.#generation || colour[0] !== this.#choices.colour[0]) return;
    /** @type {[number, number]} */
    const range = [
      Math.min(...found.map((one) => one.range[0])),
      Math.max(...found.map((one) => one.range[1])),
    ];
    this.#actors.forEach((actor, order) => (actor.colours = { ...found[order], range }));
    this.#show();
  }

  /** Name of the colours with the ends of their scale, and the time, in words. */
  #words() {
    const [name] = this.#choices.colour;
    const scale = scaleWords(name, colourName(name), this.#actors[0].colours.range);
    return { ...scale, time: this.#clock.textContent ?? "" };
  }

  #drawLegend() {
    const { factor, colour, isStriped } = this.#choices;
    const magnification = this.#magnification;
    fill(this.#legend, scaleParts(this.#words()));
    const counts = this.#actors.map(({ motion, there, heading }) => {
      if (!motion) return "";
      const all =
        motion.interval > 1.5 * there.interval
          ? `, every ${Math.round(motion.interval / there.interval)}th of them`
          : "";
      return `${heading && `${heading}: `}${motion.count} snapshots, ${say("time", motion.interval)} apart${all}`;
    });
    fill(
      this.#caption,
      `${counts.join("; ")}; between them the motion is drawn straight. The grey line is the string at rest, the dashed one the axis of the hole, with marks of measured depth next to it. Tool joints, collars and stabilizers are wider than pipe; the cone is the bit. Rings show the positions at which the string touches the wall. Distances from the axis are drawn ${factor === 1 ? "to scale" : `${factor} times as large`}${magnification === 1 ? "" : `, and the motion about the mean position ${magnification} times more, so that it can pass the rings`}.${isStriped ? " The stripe is painted along the string; the dial shows the turn of its deep end (thick) and of its top (thin)." : ""}${colour[0] === "normal_force" ? ` Dots touch the wall. ${BEYOND}` : ""} Drag to turn, with Shift to shift, scroll to zoom.`,
    );
  }

  /** Shows the strings by the choices of the link. */
  #show() {
    const {
      depths: { from, to },
      factor,
    } = this.#choices;
    const magnification = this.#magnification;
    for (const { motion, means, statics, scene, geometry, colours, kinds, context } of this.#actors) {
      if (!motion || !means) continue;
      const depth = statics.measured_depth;
      const upper = Math.max(
        0,
        depth.findLastIndex((/** @type {number} */ value) => value <= from),
      );
      const lower = depth.findIndex((/** @type {number} */ value) => value >= to);
      scene.show({
        frames: geometry,
        kinds,
        clearance: statics.clearance,
        depth: { values: shown("measured_depth", depth).map(Number), symbol: unit("measured_depth").symbol },
        stretch: [
          Math.min(upper, depth.length - 2),
          lower < 0 ? depth.length - 1 : Math.max(lower, upper + 1),
        ],
        factor,
        place: (node) => {
          const now = /** @type {[number, number]} */ (
            ["u", "v"].map((name) => valueAt(motion, name, node, this.#time))
          );
          return magnified(means, node, now, magnification);
        },
        turn:
          motion.columns.theta_z && this.#turn(motion, context.point.scenario.operation.rotation_speed_rpm),
        rest: (node) => [statics.u[node], statics.v[node]],
        ...colours,
      });
    }
    this.#drawLegend();
  }

  /**
   * Turn of the string at a node: that of the drive, and the twist.
   * @param {Frames} motion with theta_z
   * @param {number} speed of the drive [rpm]
   * @returns {(node: number) => number} [rad]
   */
  #turn(motion, speed) {
    return (node) => (speed * Math.PI * this.#time) / 30 + valueAt(motion, "theta_z", node, this.#time);
  }

  /** Stops at the time of the cursor when something else has moved it. @param {number | null} time [s] */
  #follow(time) {
    if (time === null || time === this.#time) return;
    this.#setPlaying(false);
    this.#awaited = this.#moving.length && (time <= this.#end || !this.#isArriving) ? null : time;
    this.#go(time);
  }

  /** Takes the cursor along. @param {number} time [s] */
  #lead(time) {
    this.#go(time);
    this.#cursor.move(this.#time);
  }

  /** @param {number} to [s] */
  #go(to) {
    if (!this.#moving.length) return;
    this.#time = Math.max(this.#first, Math.min(this.#end, to));
    this.#slider.value = String(this.#time);
    this.#slider.setAttribute("aria-valuetext", say("time", this.#time));
    this.#clock.textContent = `${this.#time.toFixed(2)} s`;
    for (const { scene } of this.#actors) scene.paint();
  }

  /** @param {boolean} will */
  #setPlaying(will) {
    if (will === this.#isPlaying || (will && !this.#moving.length)) return;
    this.#isPlaying = will;
    this.#play.textContent = will ? "Pause" : "Play";
    if (!will) return;
    this.#awaited = null;
    if (this.#time >= this.#end - 1e-9 && !this.#isArriving) this.#time = this.#first;
    this.#last = performance.now();
    requestAnimationFrame((now) => this.#step(now));
  }

  /** @param {number} now */
  #step(now) {
    if (!this.#isPlaying || this.#signal.aborted) return;
    const next = this.#time + ((now - this.#last) / 1000) * this.#choices.speed;
    this.#last = now;
    this.#lead(next);
    // What has arrived may end before the window does.
    if (next >= this.#end && !this.#isArriving) this.#setPlaying(false);
    else requestAnimationFrame((later) => this.#step(later));
  }

  /** @param {"png" | "svg"} format */
  #save(format) {
    const words = this.#words();
    saveStrings(`string-in-motion-${words.time.replace(/[^\d.]+/g, "")}-s`, format, this.#actors, words);
  }
}
