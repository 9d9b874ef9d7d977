// Parts of the string by depth: pipe, tool joints, collars, stabilizers and the bit.

/** Kinds of parts from the slimmest. @typedef {"drillpipe" | "tool_joint" | "collar" | "stabilizer" | "bit"} Kind */
/** A part between two measured depths [m]. @typedef {{kind: Kind, from: number, to: number}} Part */

/**
 * The parts of a scenario's sections, from the top.
 * @param {{kind: Kind, count?: number, length: number, tool_joint?: {length: number} | null}[]} sections
 * @returns {Part[]}
 */
export function partsOf(sections) {
  /** @type {Part[]} */
  const parts = [];
  let depth = 0;
  const add = (/** @type {Kind} */ kind, /** @type {number} */ length) => {
    parts.push({ kind, from: depth, to: depth + length });
    depth += length;
  };
  for (const { kind, count = 1, length, tool_joint } of sections) {
    const joint = tool_joint?.length ?? 0;
    for (let piece = 0; piece < count; piece += 1) {
      if (joint) add("tool_joint", joint);
      add(kind, length - 2 * joint);
      if (joint) add("tool_joint", joint);
    }
  }
  return parts;
}

/**
 * Name of the component at a measured depth [m], of the upper one at a boundary; empty without a name.
 * @param {{name?: string, count?: number, length: number}[]} sections
 * @param {number} depth
 */
export function componentAt(sections, depth) {
  let bottom = 0;
  const found = sections.find(({ count = 1, length }) => {
    bottom += count * length;
    return depth <= bottom + SAME_DEPTH;
  });
  return found?.name ?? "";
}

/** Difference of depths that rounding makes [m]. */
const SAME_DEPTH = 1e-6;

/**
 * Kind of the part at each element, between a node and the next one below.
 * @param {Part[]} parts
 * @param {number[]} depths of the nodes, rising [m]
 * @returns {Kind[]} one fewer than nodes
 */
export function kindsOf(parts, depths) {
  let part = 0;
  return depths.slice(1).map((depth, node) => {
    const middle = (depths[node] + depth) / 2;
    while (part < parts.length - 1 && parts[part].to < middle) part += 1;
    return parts[part]?.kind ?? "drillpipe";
  });
}
