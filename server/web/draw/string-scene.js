// The string in its hole, seen from where the reader turns it: a picture that is drawn anew in each frame.

import { colourOf } from "./colours.js";
import { h } from "../ui/dom.js";
import { inks } from "./plots.js";

/** @typedef {import("../data/well-frames.js").Vector} Vector */

/** Corners of a ring of the hole, and rings along the stretch that is shown. */
const [CORNERS, RINGS] = [28, 36];
/** How far a key or a turn of the wheel moves the view. */
const [TURN, NEARER] = [0.08, 1.15];
/** Marks of depth along the stretch that is shown, about, and pixels between two at least. */
const [MARKS, BETWEEN] = [6, 16];
/** Radius of a dot. */
const DOT = 4.5;

/**
 * What is drawn.
 * @typedef {object} Scene
 * @property {{axis: Vector[], u: Vector[], v: Vector[]}} frames
 * @property {number[]} clearance of each node [m]
 * @property {{values: number[], symbol: string}} depth measured depth of each node, as it is shown
 * @property {[number, number]} stretch first and last node that are shown
 * @property {number} factor by which the distance from the axis is multiplied
 * @property {(node: number) => [number, number]} place u and v of a node [m]
 * @property {((node: number) => [number, number]) | null} rest u and v of a node at rest [m]
 * @property {(node: number) => number} value that colours it
 * @property {[number, number]} range of the colours
 * @property {(node: number) => boolean} [isMarked] whether a node has a dot
 */

/** From where the string is seen: angles [rad], how near, and the shift as a part of the picture's width and height. */
const USUAL = { azimuth: 0.7, elevation: 0.35, size: 1, right: 0, down: 0 };
/** Digits of these in the link. */
const DIGITS = 4;

/**
 * @param {string} text of the link, as `sayView` makes it
 * @returns {typeof USUAL}
 */
export function readView(text) {
  const numbers = text.split(":").map(Number);
  if (!text || numbers.length !== 5 || !numbers.every(Number.isFinite) || !(numbers[2] > 0))
    return { ...USUAL };
  const [azimuth, elevation, size, right, down] = numbers;
  return { azimuth, elevation: Math.max(-Math.PI / 2, Math.min(Math.PI / 2, elevation)), size, right, down };
}

/**
 * A view as the link holds it; empty of the usual one.
 * @param {typeof USUAL} view
 */
export function sayView(view) {
  const text = [view.azimuth, view.elevation, view.size, view.right, view.down]
    .map((value) => Number(value.toFixed(DIGITS)))
    .join(":");
  return text === Object.values(USUAL).join(":") ? "" : text;
}

/**
 * A picture that is turned by dragging or the arrow keys, and brought nearer by the wheel or + and -.
 * @param {string} name
 * @param {typeof USUAL} view from where the string is seen at first
 * @param {(view: typeof USUAL) => void} onView told when the reader has turned it
 * @param {AbortSignal} signal
 */
export function stringScene(name, view, onView, signal) {
  const canvas = h("canvas", {
    class: "scene",
    role: "application",
    tabindex: "0",
    "aria-label": name,
    "aria-keyshortcuts": "Space ArrowLeft ArrowRight ArrowUp ArrowDown + - Home",
  });
  const screen = /** @type {CanvasRenderingContext2D} */ (canvas.getContext("2d"));
  /** What draws at present. @type {import("./svg-pen.js").Pen} */
  let pen = screen;
  /** @type {Scene | undefined} */
  let scene;
  let isDue = false;
  let drawn = 0;

  function later() {
    if (isDue) return;
    isDue = true;
    requestAnimationFrame(() => {
      isDue = false;
      paint();
    });
  }

  const observer = new ResizeObserver(later);
  observer.observe(canvas);
  signal.addEventListener("abort", () => observer.disconnect(), { once: true });

  /** @type {{x: number, y: number} | null} */
  let held = null;
  canvas.addEventListener("pointerdown", (event) => {
    held = { x: event.clientX, y: event.clientY };
    canvas.setPointerCapture(event.pointerId);
  });
  canvas.addEventListener("pointermove", (event) => {
    if (!held) return;
    const [x, y] = [event.clientX - held.x, event.clientY - held.y];
    held = { x: event.clientX, y: event.clientY };
    if (event.shiftKey) {
      view.right += x / canvas.clientWidth;
      view.down += y / canvas.clientHeight;
    } else turn(-x * 0.008, y * 0.008);
    changed();
  });
  for (const end of ["pointerup", "pointercancel"]) canvas.addEventListener(end, () => (held = null));
  canvas.addEventListener(
    "wheel",
    (event) => {
      event.preventDefault();
      view.size *= event.deltaY < 0 ? NEARER : 1 / NEARER;
      changed();
    },
    { passive: false },
  );
  canvas.addEventListener("keydown", (event) => {
    /** @type {Record<string, () => void>} */
    const keys = {
      ArrowLeft: () => turn(TURN, 0),
      ArrowRight: () => turn(-TURN, 0),
      ArrowUp: () => turn(0, TURN),
      ArrowDown: () => turn(0, -TURN),
      "+": () => (view.size *= NEARER),
      "-": () => (view.size /= NEARER),
      Home: () => Object.assign(view, USUAL),
    };
    if (!keys[event.key]) return;
    event.preventDefault();
    keys[event.key]();
    changed();
  });

  function changed() {
    later();
    onView(view);
  }

  /** @param {number} azimuth @param {number} elevation */
  function turn(azimuth, elevation) {
    view.azimuth += azimuth;
    view.elevation = Math.max(-Math.PI / 2, Math.min(Math.PI / 2, view.elevation + elevation));
  }

  function paint() {
    const [width, height] = [canvas.clientWidth, canvas.clientHeight];
    if (!scene || !width || !height) return;
    const scale = devicePixelRatio || 1;
    if (canvas.width !== Math.round(width * scale) || canvas.height !== Math.round(height * scale)) {
      canvas.width = Math.round(width * scale);
      canvas.height = Math.round(height * scale);
    }
    screen.setTransform(scale, 0, 0, scale, 0, 0);
    screen.clearRect(0, 0, width, height);
    drawAll(scene, width, height);
    drawn += 1;
    canvas.dataset.drawn = String(drawn);
  }

  /** @param {Scene} scene @param {number} width @param {number} height */
  function drawAll(scene, width, height) {
    const project = projection(scene, width, height);
    drawHole(scene, project);
    drawDepths(scene, project);
    if (scene.rest) drawLine(scene, scene.rest, project);
    drawString(scene, project);
    drawCompass(height);
  }

  /**
   * From a place in space to one in the picture: without perspective, all of the stretch in it.
   * @param {Scene} shown @param {number} width @param {number} height
   */
  function projection({ frames, stretch: [first, last], clearance, factor }, width, height) {
    const [cosine, sine] = [Math.cos(view.azimuth), Math.sin(view.azimuth)];
    const [up, flat] = [Math.cos(view.elevation), Math.sin(view.elevation)];
    const seen = (/** @type {Vector} */ [north, east, down]) => {
      const [right, away] = [east * cosine - north * sine, east * sine + north * cosine];
      return [right, down * up - away * flat];
    };
    const bounds = [Infinity, -Infinity, Infinity, -Infinity];
    for (let node = first; node <= last; node += 1) {
      const [x, y] = seen(frames.axis[node]);
      const room = factor * clearance[node];
      bounds[0] = Math.min(bounds[0], x - room);
      bounds[1] = Math.max(bounds[1], x + room);
      bounds[2] = Math.min(bounds[2], y - room);
      bounds[3] = Math.max(bounds[3], y + room);
    }
    const size =
      0.92 *
      view.size *
      Math.min(width / (bounds[1] - bounds[0] || 1), height / (bounds[3] - bounds[2] || 1));
    const [x0, y0] = [(bounds[0] + bounds[1]) / 2, (bounds[2] + bounds[3]) / 2];
    return (/** @type {Vector} */ place) => {
      const [x, y] = seen(place);
      return [width * (0.5 + view.right) + size * (x - x0), height * (0.5 + view.down) + size * (y - y0)];
    };
  }

  /** @param {Scene} shown @param {(place: Vector) => number[]} project */
  function drawHole({ frames, stretch: [first, last], clearance, factor }, project) {
    const { soft, line } = inks();
    pen.lineWidth = 1;
    pen.strokeStyle = line;
    const step = Math.max(1, Math.round((last - first) / RINGS));
    for (let node = first; node <= last; node += step) {
      pen.beginPath();
      for (let corner = 0; corner <= CORNERS; corner += 1) {
        const angle = (2 * Math.PI * corner) / CORNERS;
        const radius = factor * clearance[node];
        const [x, y] = project(offset(frames, node, radius * Math.cos(angle), radius * Math.sin(angle)));
        if (corner) pen.lineTo(x, y);
        else pen.moveTo(x, y);
      }
      pen.stroke();
    }
    pen.strokeStyle = soft;
    pen.setLineDash([6, 5]);
    path(first, last, (node) => project(frames.axis[node]));
    pen.setLineDash([]);
  }

  /** Marks of depth beside the hole. @param {Scene} shown @param {(place: Vector) => number[]} project */
  function drawDepths({ frames, stretch: [first, last], clearance, factor, depth }, project) {
    const { soft, text } = inks();
    const step = niceStep((depth.values[last] - depth.values[first]) / MARKS);
    pen.lineWidth = 1.2;
    pen.font = "12px system-ui, sans-serif";
    pen.textBaseline = "middle";
    /** @type {number[] | undefined} */
    let before;
    let node = first;
    for (
      let mark = Math.ceil(depth.values[first] / step - 1e-9);
      mark * step <= depth.values[last] * (1 + 1e-9);
      mark += 1
    ) {
      while (node < last - 1 && depth.values[node + 1] < mark * step) node += 1;
      const part = (mark * step - depth.values[node]) / (depth.values[node + 1] - depth.values[node] || 1);
      const [from, to] = [project(frames.axis[node]), project(frames.axis[node + 1])];
      const along = [to[0] - from[0], to[1] - from[1]];
      const length = Math.hypot(along[0], along[1]);
      // To the right of the hole; of one that is seen from its end, level.
      const side = length > 0.5 ? Math.sign(-along[1] || 1) : 1;
      const [x, y] = length > 0.5 ? [(-side * along[1]) / length, (side * along[0]) / length] : [1, 0];
      const radius = factor * clearance[node];
      const room = Math.max(
        ...Array.from({ length: CORNERS }, (_, corner) => {
          const angle = (2 * Math.PI * corner) / CORNERS;
          const [right, down] = project(
            offset(frames, node, radius * Math.cos(angle), radius * Math.sin(angle)),
          );
          return (right - from[0]) * x + (down - from[1]) * y;
        }),
      );
      const at = (/** @type {number} */ beyond) => [
        from[0] + part * along[0] + x * (room + beyond),
        from[1] + part * along[1] + y * (room + beyond),
      ];
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
        `${Number((mark * step).toPrecision(6))} ${depth.symbol}`,
        words[0],
        words[1] + (x > 0.4 ? 0 : 6 * Math.sign(y)),
      );
    }
  }

  /** @param {Scene} shown @param {(node: number) => [number, number]} place @param {(place: Vector) => number[]} project */
  function drawLine({ frames, stretch: [first, last], factor }, place, project) {
    pen.lineWidth = 1.5;
    pen.strokeStyle = inks().soft;
    path(first, last, (node) => {
      const [u, v] = place(node);
      return project(offset(frames, node, factor * u, factor * v));
    });
  }

  /** @param {Scene} shown @param {(place: Vector) => number[]} project */
  function drawString({ frames, stretch: [first, last], factor, place, value, range, isMarked }, project) {
    const { panel, text } = inks();
    const at = (/** @type {number} */ node) => {
      const [u, v] = place(node);
      return project(offset(frames, node, factor * u, factor * v));
    };
    // Whatever its colour, it stands out from the ground of either theme.
    pen.lineCap = "round";
    pen.lineWidth = 6.5;
    pen.globalAlpha = 0.35;
    pen.strokeStyle = text;
    path(first, last, at);
    pen.globalAlpha = 1;
    pen.lineWidth = 4;
    /** @type {number[][]} */
    const dots = [];
    let before;
    for (let node = first; node <= last; node += 1) {
      const here = at(node);
      if (before) {
        pen.strokeStyle = colourOf(value(node), range);
        pen.beginPath();
        pen.moveTo(before[0], before[1]);
        pen.lineTo(here[0], here[1]);
        pen.stroke();
      }
      if (isMarked?.(node)) dots.push([here[0], here[1], value(node)]);
      before = here;
    }
    pen.lineCap = "butt";
    pen.lineWidth = 1;
    pen.strokeStyle = panel;
    for (const [x, y, force] of dots) {
      pen.fillStyle = colourOf(force, range);
      pen.beginPath();
      pen.arc(x, y, DOT, 0, 2 * Math.PI);
      pen.fill();
      pen.stroke();
    }
  }

  /** @param {number} first @param {number} last @param {(node: number) => number[]} at */
  function path(first, last, at) {
    pen.beginPath();
    for (let node = first; node <= last; node += 1) {
      const [x, y] = at(node);
      if (node > first) pen.lineTo(x, y);
      else pen.moveTo(x, y);
    }
    pen.stroke();
  }

  /** North, east and down in a corner. @param {number} height */
  function drawCompass(height) {
    const { text, soft } = inks();
    const [cosine, sine, up, flat] = [
      Math.cos(view.azimuth),
      Math.sin(view.azimuth),
      Math.cos(view.elevation),
      Math.sin(view.elevation),
    ];
    const [x, y, length] = [46, height - 46, 26];
    pen.lineWidth = 1.5;
    pen.font = "12px system-ui, sans-serif";
    pen.textAlign = "center";
    pen.textBaseline = "middle";
    for (const [name, right, lower] of /** @type {[string, number, number][]} */ ([
      ["N", -sine, -cosine * flat],
      ["E", cosine, -sine * flat],
      ["down", 0, up],
    ])) {
      pen.strokeStyle = soft;
      pen.fillStyle = text;
      pen.beginPath();
      pen.moveTo(x, y);
      pen.lineTo(x + length * right, y + length * lower);
      pen.stroke();
      pen.fillText(name, x + 1.4 * length * right, y + 1.4 * length * lower);
    }
  }

  return {
    element: canvas,
    /** @param {Scene} next */
    show(next) {
      scene = next;
      later();
    },
    /** Draws at once, in the frame of a caller. */
    paint,
    /** Draws anew, seen from elsewhere. */
    turned: later,
    /**
     * Draws what is shown with another pen, as a file has it.
     * @param {import("./svg-pen.js").Pen} other
     */
    drawWith(other) {
      if (!scene) return;
      pen = other;
      drawAll(scene, canvas.clientWidth, canvas.clientHeight);
      pen = screen;
    },
  };
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
 * A place beside the axis.
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
