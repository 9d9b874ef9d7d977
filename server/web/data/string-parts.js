// Parts of the string by depth: pipe, tool joints, collars, stabilizers and the bit.

/** Kinds of parts from the slimmest. @typedef {"drillpipe" | "tool_joint" | "collar" | "stabilizer" | "bit"} Kind */
/** A part between two measured depths [m]. @typedef {{kind: Kind, from: number, to: number}} Part */

/** @typedef {{name?: string, kind?: Kind, count?: number, length: number, tool_joint?: {length: number} | null}} Section */
/** The string of a scenario: its sections in their order, and the depth of the bit. @typedef {{sections: Section[], order?: string, bit_depth?: number | null}} DrillString */

/**
 * The parts of a string that are in the hole, from the top.
 * @param {DrillString} string
 * @returns {Part[]}
 */
export function partsOf(string) {
  /** @type {Part[]} */
  const parts = [];
  for (const { section, top } of placedSections(string)) {
    let depth = top;
    const add = (/** @type {Kind} */ kind, /** @type {number} */ length) => {
      const to = depth + length;
      if (to > SAME_DEPTH) parts.push({ kind, from: Math.max(depth, 0), to });
      depth = to;
    };
    const { kind = "drillpipe", count = 1, length } = section;
    const joint = section.tool_joint?.length ?? 0;
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
 * @param {DrillString} string
 * @param {number} depth
 */
export function componentAt(string, depth) {
  const found = placedSections(string).find(
    ({ bottom }) => bottom > SAME_DEPTH && depth <= bottom + SAME_DEPTH,
  );
  return found?.section.name ?? "";
}

/**
 * Sections from the top down with their indices and the measured depths of their ends [m]: negative above the hole, NaN from a length on that is
 * no number.
 * @param {DrillString} string
 */
export function placedSections({ sections, order, bit_depth }) {
  const lengthOf = (/** @type {Section} */ { count = 1, length }) =>
    typeof length === "number" ? count * length : NaN;
  const whole = sections.reduce((length, section) => length + lengthOf(section), 0);
  let bottom = bit_depth ? Math.min(bit_depth - whole, 0) : 0;
  const listed = sections.map((section, index) => ({ section, index }));
  return (order === "from_bit" ? listed.toReversed() : listed).map(({ section, index }) => {
    const top = bottom;
    bottom += lengthOf(section);
    return { index, section, top, bottom };
  });
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
