// The string in its hole, seen from where the reader turns it: a picture that is drawn anew in each frame.

import { h } from "../ui/dom.js";
import { colourOf } from "./picture/colours.js";
import { inks } from "./plots.js";
import { seenFrom } from "./viewpoint.js";

/** @typedef {import("../data/well-frames.js").Vector} Vector */

/** Corners of a ring of the hole, and rings along the stretch that is shown. */
const [CORNERS, RINGS] = [28, 36];
/** Steps of the view for a key or a turn of the wheel. */
const [TURN, NEARER] = [0.08, 1.15];
/** Marks of depth along the stretch that is shown, about, and pixels between two at least. */
const [MARKS, BETWEEN] = [6, 16];
/** Width of the string by its part, and length of the bit's cone [pixels]. @type {Record<import("../data/string-parts.js").Kind, number>} */
const WIDTHS = { drillpipe: 3.5, tool_joint: 7, collar: 5.5, stabilizer: 10, bit: 10 };
const CONE = 9;
/** Radius of a dot. */
const DOT = 4.5;
/** Greatest distance of the pointer from a node that is read [pixels]. */
const NEAR = 14;

/**
 * A string in its hole, as it is drawn.
 * @typedef {object} Scene
 * @property {{axis: Vector[], u: Vector[], v: Vector[]}} frames
 * @property {number[]} clearance of each node [m]
 * @property {{values: number[], symbol: string}} depth measured depth of each node, as it is shown
 * @property {[number, number]} stretch first and last node that are shown
 * @property {number} factor by which the distance from the axis is multiplied
 * @property {(node: number) => [number, number]} place u and v of a node [m]
 * @property {((node: number) => [number, number]) | null} rest u and v of a node at rest [m]
 * @property {(node: number) => number | null} value that colours it; a node without one has the colour of text
 * @property {string} [colour] of all of the string, in place of its values
 * @property {[number, number]} range of the colours
 * @property {(node: number) => number} [turn] of the string at a node [rad], which a stripe along it and a dial show
 * @property {(node: number) => boolean} [isMarked] whether a node has a dot
 * @property {import("../data/string-parts.js").Kind[]} kinds part of the string at each element
 * @property {Scene[]} [fits] scenes in pictures of the same size that are drawn to the scale at which each of them fits
 */

/** @typedef {import("./viewpoint.js").View} View */
/** @typedef {import("./picture/svg-pen.js").Pen} Pen */
/** @typedef {(place: Vector) => number[]} Project */

/** Keys of a picture. */
export const KEYS = "ArrowLeft ArrowRight ArrowUp ArrowDown + - Home";

/** A picture that is turned by dragging or the arrow keys, and brought nearer by the wheel or + and -. */
export class StringScene {
  #view;
  #usual;
  #onView;
  #screen;
  /** @type {Scene | undefined} */
  #scene;
  #isDue = false;
  #drawn = 0;
  /** Last place of the pointer while it is held. @type {{x: number, y: number} | null} */
  #held = null;

  /**
   * @param {string} name
   * @param {View} view from where the string is seen, which changes when the reader turns it
   * @param {View} usual view that Home takes back
   * @param {() => void} onView called when the reader has turned it
   * @param {AbortSignal} signal
   */
  constructor(name, view, usual, onView, signal) {
    this.#view = view;
    this.#usual = usual;
    this.#onView = onView;
    this.element = h("canvas", {
      class: "scene",
      role: "application",
      tabindex: "0",
      "aria-label": name,
      "aria-keyshortcuts": KEYS,
    });
    this.#screen = /** @type {CanvasRenderingContext2D} */ (this.element.getContext("2d"));
    const observer = new ResizeObserver(() => this.turned());
    observer.observe(this.element);
    signal.addEventListener("abort", () => observer.disconnect(), { once: true });
    this.#listen();
  }

  /** @param {Scene} scene */
  show(scene) {
    this.#scene = scene;
    this.turned();
  }

  /** Draws anew in the next frame. */
  turned() {
    if (this.#isDue) return;
    this.#isDue = true;
    requestAnimationFrame(() => {
      this.#isDue = false;
      this.paint();
    });
  }

  /** Draws at once, in the frame of a caller. */
  paint() {
    const canvas = this.element;
    const [width, height] = [canvas.clientWidth, canvas.clientHeight];
    if (!this.#scene || !width || !height) return;
    const scale = devicePixelRatio || 1;
    if (canvas.width !== Math.round(width * scale) || canvas.height !== Math.round(height * scale)) {
      canvas.width = Math.round(width * scale);
      canvas.height = Math.round(height * scale);
    }
    this.#screen.setTransform(scale, 0, 0, scale, 0, 0);
    this.#screen.clearRect(0, 0, width, height);
    drawAll(this.#screen, this.#scene, this.#view, width, height);
    this.#drawn += 1;
    canvas.dataset.drawn = String(this.#drawn);
  }

  /**
   * Reports the node next to the pointer, while nothing is dragged.
   * @param {(node: number | null) => void} read
   */
  onNode(read) {
    this.element.addEventListener("pointermove", ({ offsetX, offsetY }) => {
      if (!this.#held) read(this.#nodeAt(offsetX, offsetY));
    });
    this.element.addEventListener("pointerleave", () => read(null));
  }

  /** @param {number} x @param {number} y */
  #nodeAt(x, y) {
    if (!this.#scene) return null;
    const { clientWidth, clientHeight } = this.element;
    const project = projection(this.#scene, this.#view, clientWidth, clientHeight);
    const [first] = this.#scene.stretch;
    let [best, least] = [/** @type {number | null} */ (null), NEAR];
    placesOf(this.#scene, this.#scene.place, project).forEach(([right, down], index) => {
      const apart = Math.hypot(right - x, down - y);
      if (apart < least) [best, least] = [first + index, apart];
    });
    return best;
  }

  /** Draws with another pen, as a file has it. @param {Pen} pen */
  drawWith(pen) {
    if (this.#scene)
      drawAll(pen, this.#scene, this.#view, this.element.clientWidth, this.element.clientHeight);
  }

  #listen() {
    const canvas = this.element;
    canvas.addEventListener("pointerdown", (event) => {
      this.#held = { x: event.clientX, y: event.clientY };
      canvas.setPointerCapture(event.pointerId);
    });
    canvas.addEventListener("pointermove", (event) => this.#drag(event));
    for (const end of ["pointerup", "pointercancel"]) canvas.addEventListener(end, () => (this.#held = null));
    canvas.addEventListener(
      "wheel",
      (event) => {
        event.preventDefault();
        this.#view.size *= event.deltaY < 0 ? NEARER : 1 / NEARER;
        this.#changed();
      },
      { passive: false },
    );
    canvas.addEventListener("keydown", (event) => this.#press(event));
  }

  /** @param {PointerEvent} event */
  #drag(event) {
    if (!this.#held) return;
    const [x, y] = [event.clientX - this.#held.x, event.clientY - this.#held.y];
    this.#held = { x: event.clientX, y: event.clientY };
    if (event.shiftKey) {
      this.#view.right += x / this.element.clientWidth;
      this.#view.down += y / this.element.clientHeight;
    } else this.#turn(-x * 0.008, y * 0.008);
    this.#changed();
  }

  /** @param {KeyboardEvent} event */
  #press(event) {
    const view = this.#view;
    /** @type {Record<string, () => void>} */
    const keys = {
      ArrowLeft: () => this.#turn(TURN, 0),
      ArrowRight: () => this.#turn(-TURN, 0),
      ArrowUp: () => this.#turn(0, TURN),
      ArrowDown: () => this.#turn(0, -TURN),
      "+": () => (view.size *= NEARER),
      "-": () => (view.size /= NEARER),
      Home: () => Object.assign(view, this.#usual),
    };
    if (!keys[event.key]) return;
    event.preventDefault();
    keys[event.key]();
    this.#changed();
  }

  /** @param {number} azimuth @param {number} elevation */
  #turn(azimuth, elevation) {
    this.#view.azimuth += azimuth;
    this.#view.elevation = Math.max(-Math.PI / 2, Math.min(Math.PI / 2, this.#view.elevation + elevation));
  }

  #changed() {
    this.turned();
    this.#onView();
  }
}

/** @param {Pen} pen @param {Scene} scene @param {View} view @param {number} width @param {number} height */
function drawAll(pen, scene, view, width, height) {
  const project = projection(scene, view, width, height);
  drawHole(pen, scene, project);
  drawDepths(pen, scene, project);
  if (scene.rest) drawLine(pen, scene, scene.rest, project);
  drawString(pen, scene, project);
  if (scene.turn) drawDial(pen, scene.stretch.map(scene.turn), width);
  drawCompass(pen, view, height);
}

/**
 * Projection from space to the picture: without perspective, and with all of the shown part in it.
 * Scenes that are to fit together have one scale.
 * @param {Scene} scene @param {View} view @param {number} width @param {number} height
 * @returns {Project}
 */
function projection(scene, view, width, height) {
  const seen = seenFrom(view);
  const [left, right, top, bottom] = boundsOf(scene, seen);
  const sizes = (scene.fits ?? [scene]).map((one) => {
    const [from, to, upper, lower] = boundsOf(one, seen);
    return Math.min(width / (to - from || 1), height / (lower - upper || 1));
  });
  const size = 0.92 * view.size * Math.min(...sizes);
  const [x0, y0] = [(left + right) / 2, (top + bottom) / 2];
  return (place) => {
    const [x, y] = seen(place);
    return [width * (0.5 + view.right) + size * (x - x0), height * (0.5 + view.down) + size * (y - y0)];
  };
}

/**
 * Bounds of the shown part of a hole as it is seen: left, right, top and bottom [m].
 * @param {Scene} scene @param {(place: Vector) => [number, number]} seen
 */
function boundsOf({ frames, stretch: [first, last], clearance, factor }, seen) {
  const bounds = [Infinity, -Infinity, Infinity, -Infinity];
  for (let node = first; node <= last; node += 1) {
    const [x, y] = seen(frames.axis[node]);
    const room = factor * clearance[node];
    bounds[0] = Math.min(bounds[0], x - room);
    bounds[1] = Math.max(bounds[1], x + room);
    bounds[2] = Math.min(bounds[2], y - room);
    bounds[3] = Math.max(bounds[3], y + room);
  }
  return bounds;
}

/**
 * Places of the shown nodes in the picture.
 * @param {Scene} scene @param {(node: number) => [number, number]} place @param {Project} project
 */
function placesOf({ frames, stretch: [first, last], factor }, place, project) {
  return Array.from({ length: last - first + 1 }, (_, index) => {
    const [u, v] = place(first + index);
    return project(offset(frames, first + index, factor * u, factor * v));
  });
}

/** Corners of a ring of the hole about a node, in space. @param {Scene} scene @param {number} node @returns {Vector[]} */
function ringOf({ frames, clearance, factor }, node) {
  const radius = factor * clearance[node];
  return Array.from({ length: CORNERS + 1 }, (_, corner) => {
    const angle = (2 * Math.PI * corner) / CORNERS;
    return offset(frames, node, radius * Math.cos(angle), radius * Math.sin(angle));
  });
}

/** @param {Pen} pen @param {Scene} scene @param {Project} project */
function drawHole(pen, scene, project) {
  const {
    frames,
    stretch: [first, last],
  } = scene;
  const { soft, line } = inks();
  pen.lineWidth = 1;
  pen.strokeStyle = line;
  const step = Math.max(1, Math.round((last - first) / RINGS));
  for (let node = first; node <= last; node += step) {
    const ring = ringOf(scene, node);
    path(pen, 0, CORNERS, (corner) => project(ring[corner]));
  }
  pen.strokeStyle = soft;
  pen.setLineDash([6, 5]);
  path(pen, first, last, (node) => project(frames.axis[node]));
  pen.setLineDash([]);
}

/** Draws marks of depth next to the hole. @param {Pen} pen @param {Scene} scene @param {Project} project */
function drawDepths(pen, scene, project) {
  const {
    stretch: [first, last],
    depth: { values, symbol },
  } = scene;
  const { soft, text } = inks();
  const step = niceStep((values[last] - values[first]) / MARKS);
  pen.lineWidth = 1.2;
  pen.font = "12px system-ui, sans-serif";
  pen.textBaseline = "middle";
  /** @type {number[] | undefined} */
  let before;
  let node = first;
  for (
    let mark = Math.ceil(values[first] / step - 1e-9);
    mark * step <= values[last] * (1 + 1e-9);
    mark += 1
  ) {
    while (node < last - 1 && values[node + 1] < mark * step) node += 1;
    const part = (mark * step - values[node]) / (values[node + 1] - values[node] || 1);
    const {
      at,
      side: [x, y],
    } = besideHole(scene, node, part, project);
    const [start, end, words] = [at(1), at(8), at(12)];
    if (before && Math.hypot(words[0] - before[0], words[1] - before[1]) < BETWEEN) continue;
    before = words;
    pen.strokeStyle = soft;
    pen.beginPath();
    pen.moveTo(start[0], start[1]);
    pen.lineTo(end[0], end[1]);
    pen.stroke();
    pen.fillStyle = text;
    pen.textAlign = x > 0.4 ? "left" : "center";
    pen.fillText(
      `${Number((mark * step).toPrecision(6))} ${symbol}`,
      words[0],
      words[1] + (x > 0.4 ? 0 : 6 * Math.sign(y)),
    );
  }
}

/**
 * Places next to the hole in the picture, between a node and the next one below.
 * @param {Scene} scene
 * @param {number} node
 * @param {number} part of the way to the next node
 * @param {Project} project
 * @returns {{at: (beyond: number) => number[], side: number[]}} places so many pixels beyond the wall, and their direction from the axis
 */
function besideHole(scene, node, part, project) {
  const [from, to] = [project(scene.frames.axis[node]), project(scene.frames.axis[node + 1])];
  const along = [to[0] - from[0], to[1] - from[1]];
  const length = Math.hypot(along[0], along[1]);
  // To the right of the hole; of one that is seen from its end, level.
  const sign = length > 0.5 ? Math.sign(-along[1] || 1) : 1;
  const [x, y] = length > 0.5 ? [(-sign * along[1]) / length, (sign * along[0]) / length] : [1, 0];
  const ring = ringOf(scene, node).map(project);
  const room = Math.max(...ring.map(([right, down]) => (right - from[0]) * x + (down - from[1]) * y));
  return {
    at: (beyond) => [
      from[0] + part * along[0] + x * (room + beyond),
      from[1] + part * along[1] + y * (room + beyond),
    ],
    side: [x, y],
  };
}

/** @param {Pen} pen @param {Scene} scene @param {(node: number) => [number, number]} place @param {Project} project */
function drawLine(pen, scene, place, project) {
  pen.lineWidth = 1.5;
  pen.strokeStyle = inks().soft;
  const places = placesOf(scene, place, project);
  path(pen, 0, places.length - 1, (index) => places[index]);
}

/** @param {Pen} pen @param {Scene} scene @param {Project} project */
function drawString(pen, scene, project) {
  const {
    frames,
    stretch: [first, last],
    place,
    isMarked,
    kinds,
  } = scene;
  const places = placesOf(scene, place, project);
  const strokes = (/** @type {number} */ wider, /** @type {(node: number) => string} */ colour) => {
    for (let index = 1; index < places.length; index += 1) {
      const node = first + index;
      pen.lineWidth = WIDTHS[kinds[node - 1]] + wider;
      pen.strokeStyle = colour(node);
      path(pen, index - 1, index, (at) => places[at]);
    }
  };
  pen.lineCap = "round";
  // Whatever its colour, it stands out from the ground of either theme.
  const ink = inks().soft;
  strokes(2.5, () => ink);
  strokes(0, (node) => paintOf(scene, node));
  pen.lineCap = "butt";
  if (scene.turn) drawStripe(pen, scene, scene.turn, places);
  if (last === frames.axis.length - 1) drawBit(pen, places, paintOf(scene, last));
  places.forEach((at, index) => isMarked?.(first + index) && drawDot(pen, at, paintOf(scene, first + index)));
}

/** Draws a stripe that is painted along the string, where it faces the reader. @param {Pen} pen @param {Scene} scene @param {(node: number) => number} turn @param {number[][]} places */
function drawStripe(pen, { stretch: [first], kinds }, turn, places) {
  pen.lineWidth = 1.5;
  pen.strokeStyle = inks().panel;
  for (let index = 1; index < places.length; index += 1) {
    const angle = turn(first + index);
    if (Math.cos(angle) <= 0) continue;
    const [[x0, y0], [x1, y1]] = [places[index - 1], places[index]];
    const aside =
      (0.4 * WIDTHS[kinds[first + index - 1]] * Math.sin(angle)) / (Math.hypot(x1 - x0, y1 - y0) || 1);
    const ends = [
      [x0 - aside * (y1 - y0), y0 + aside * (x1 - x0)],
      [x1 - aside * (y1 - y0), y1 + aside * (x1 - x0)],
    ];
    path(pen, 0, 1, (end) => ends[end]);
  }
}

/** Radius of the dial, and its distance from the corner [pixels]. */
const [DIAL, ASIDE] = [20, 34];

/** Draws the turn of the upper and of the lower end as hands of a dial. @param {Pen} pen @param {number[]} turns [rad] @param {number} width */
function drawDial(pen, [upper, lower], width) {
  const { text, soft } = inks();
  const [x, y] = [width - ASIDE, ASIDE];
  pen.lineWidth = 1;
  pen.strokeStyle = soft;
  pen.beginPath();
  pen.arc(x, y, DIAL, 0, 2 * Math.PI);
  pen.stroke();
  const hands = [
    { turn: upper, thick: 1.5, ink: soft },
    { turn: lower, thick: 3.5, ink: text },
  ];
  for (const { turn, thick, ink } of hands) {
    [pen.lineWidth, pen.strokeStyle] = [thick, ink];
    const tip = [x + DIAL * Math.sin(turn), y - DIAL * Math.cos(turn)];
    path(pen, 0, 1, (end) => (end ? tip : [x, y]));
  }
}

/** Colour of the string at a node. @param {Scene} scene @param {number} node */
function paintOf({ value, range, colour }, node) {
  if (colour) return colour;
  const own = value(node);
  return own === null ? inks().text : colourOf(own, range);
}

/** Draws the bit as a cone at the end of the string. @param {Pen} pen @param {number[][]} places @param {string} colour */
function drawBit(pen, places, colour) {
  const [[x0, y0], [x1, y1]] = places.slice(-2);
  const length = Math.hypot(x1 - x0, y1 - y0);
  if (!length) return;
  const [along, across] = [(x1 - x0) / length, (y1 - y0) / length];
  const half = WIDTHS.bit / 2;
  pen.beginPath();
  pen.moveTo(x1 - half * across, y1 + half * along);
  pen.lineTo(x1 + half * across, y1 - half * along);
  pen.lineTo(x1 + CONE * along, y1 + CONE * across);
  pen.lineTo(x1 - half * across, y1 + half * along);
  pen.fillStyle = colour;
  pen.fill();
  pen.lineWidth = 1;
  pen.strokeStyle = inks().text;
  pen.stroke();
}

/** @param {Pen} pen @param {number[]} place @param {string} colour */
function drawDot(pen, [x, y], colour) {
  pen.lineWidth = 1;
  pen.strokeStyle = inks().panel;
  pen.fillStyle = colour;
  pen.beginPath();
  pen.arc(x, y, DOT, 0, 2 * Math.PI);
  pen.fill();
  pen.stroke();
}

/** Draws a line through places. @param {Pen} pen @param {number} first @param {number} last @param {(index: number) => number[]} at */
function path(pen, first, last, at) {
  pen.beginPath();
  for (let index = first; index <= last; index += 1) {
    const [x, y] = at(index);
    if (index > first) pen.lineTo(x, y);
    else pen.moveTo(x, y);
  }
  pen.stroke();
}

/** Least length of a direction in the corner, as a part of the whole. */
const SHORTEST = 0.5;

/** Draws north, east and down in a corner. @param {Pen} pen @param {View} view @param {number} height */
function drawCompass(pen, view, height) {
  const { text, soft } = inks();
  const seen = seenFrom(view);
  const [x, y, length] = [46, height - 46, 26];
  pen.lineWidth = 1.5;
  pen.font = "12px system-ui, sans-serif";
  pen.textAlign = "center";
  pen.textBaseline = "middle";
  /** @type {[string, Vector][]} */
  const directions = [
    ["N", [1, 0, 0]],
    ["E", [0, 1, 0]],
    ["down", [0, 0, 1]],
  ];
  for (const [name, direction] of directions) {
    const [right, lower] = seen(direction);
    // What points at the reader or away has no place.
    if (Math.hypot(right, lower) < SHORTEST) continue;
    pen.strokeStyle = soft;
    pen.fillStyle = text;
    pen.beginPath();
    pen.moveTo(x, y);
    pen.lineTo(x + length * right, y + length * lower);
    pen.stroke();
    pen.fillText(name, x + 1.4 * length * right, y + 1.4 * length * lower);
  }
}

/**
 * The step of 1, 2 or 5 times a power of ten that is nearest above another.
 * @param {number} least
 */
function niceStep(least) {
  const power = 10 ** Math.floor(Math.log10(least));
  return power * /** @type {number} */ ([1, 2, 5, 10].find((digit) => digit * power >= least * (1 - 1e-9)));
}

/**
 * A place next to the axis.
 * @param {{axis: Vector[], u: Vector[], v: Vector[]}} frames @param {number} node @param {number} u @param {number} v
 * @returns {Vector}
 */
function offset(frames, node, u, v) {
  const [axis, along, across] = [frames.axis[node], frames.u[node], frames.v[node]];
  return [
    axis[0] + u * along[0] + v * across[0],
    axis[1] + u * along[1] + v * across[1],
    axis[2] + u * along[2] + v * across[2],
  ];
}
