// Positions of nodes and their frames in space: north, east and down from the top of the string.

/** @typedef {[north: number, east: number, down: number]} Vector */

/**
 * Place of each node on the axis of the hole, and the two directions across it in which u and v are counted.
 * @param {any} statics columns of the table
 * @returns {{axis: Vector[], u: Vector[], v: Vector[], tangent: Vector[]}}
 */
export function nodeFrames(statics) {
  const { north, east, true_vertical_depth: down, low_side_angle: angle } = statics;
  const count = north.length;
  /** @type {Vector[]} */
  const axis = north.map((/** @type {number} */ value, /** @type {number} */ node) => [
    value,
    east[node],
    down[node],
  ]);
  /** @type {{axis: Vector[], u: Vector[], v: Vector[], tangent: Vector[]}} */
  const frames = { axis, u: [], v: [], tangent: [] };
  for (let node = 0; node < count; node += 1) {
    const [before, after] = [axis[Math.max(0, node - 1)], axis[Math.min(count - 1, node + 1)]];
    const tangent = unitVector([after[0] - before[0], after[1] - before[1], after[2] - before[2]]);
    // The low side is what gravity leaves across the hole; a vertical hole has none, and north takes its place.
    /** @type {Vector} */
    const gravity = [-tangent[2] * tangent[0], -tangent[2] * tangent[1], 1 - tangent[2] * tangent[2]];
    const low = Math.hypot(...gravity) > 1e-6 ? unitVector(gravity) : /** @type {Vector} */ ([1, 0, 0]);
    const side = cross(tangent, low);
    const [cosine, sine] = [Math.cos(angle[node]), Math.sin(angle[node])];
    frames.tangent.push(tangent);
    frames.u.push(sum(low, cosine, side, -sine));
    frames.v.push(sum(low, sine, side, cosine));
  }
  return frames;
}

/**
 * A quantity at the nodes: of elements, the mean of both that a node joins.
 * @param {any} columns
 * @param {string} name
 * @param {number} nodes
 * @returns {(number | null)[]}
 */
export function onNodes(columns, name, nodes) {
  const values = columns[name];
  if (values.length === nodes) return values;
  return Array.from({ length: nodes }, (_, node) => {
    const [above, below] = [
      values[Math.max(0, node - 1)] ?? null,
      values[Math.min(values.length - 1, node)] ?? null,
    ];
    return above === null || below === null ? (above ?? below) : (above + below) / 2;
  });
}

/** @param {Vector} a @param {number} of @param {Vector} b @param {number} and @returns {Vector} */
function sum(a, of, b, and) {
  return [of * a[0] + and * b[0], of * a[1] + and * b[1], of * a[2] + and * b[2]];
}

/** @param {Vector} a @param {Vector} b @returns {Vector} */
function cross(a, b) {
  return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
}

/** @param {Vector} vector @returns {Vector} */
function unitVector(vector) {
  const length = Math.hypot(...vector) || 1;
  return [vector[0] / length, vector[1] / length, vector[2] / length];
}
