// Modes of several points paired by likeness: the service has no shapes of modes, but their kinds of motion, the depths of most of their motion, and
// their frequencies.

/**
 * A mode as the service describes it.
 * @typedef {{frequency_hz: number, growth_rate: number, kind: string, lateral_share: number, torsional_share: number, axial_share: number, measured_depth: number, extent: number[]}} Mode
 */

/** Least likeness of a pair. */
const LEAST = 0.2;
/** Logarithm of a ratio of frequencies that lowers the likeness by a factor of e: at first, and once the common shift of a kind is known. */
const [BROAD, NARROW] = [0.3, 0.1];
/** Part of the string's length that does the same as a distance between the depths of largest motion. */
const APART = 0.1;
/** Frequencies below are as good as none [Hz]. */
const STATIC_HZ = 0.01;
/** Pairs of a kind from which its common shift is taken. */
const FEWEST = 3;

/**
 * Rows of modes that are alike, by rising frequency, with one place for each point; null where a point has no such mode.
 * A mode is like at most one of another point. The first point with a mode stands for its row.
 * @param {Mode[][]} points modes of each point
 * @returns {(Mode | null)[][]}
 */
export function pairedModes(points) {
  const length = Math.max(1, ...points.flat().map(({ extent }) => extent[1]));
  /** @type {(Mode | null)[][]} */
  const rows = [];
  points.forEach((modes, order) => {
    const firsts = rows.map((row) => /** @type {Mode} */ (row.find((mode) => mode !== null)));
    const found = pairs(firsts, modes, length);
    rows.forEach((row, index) => row.push(modes[found.get(index) ?? -1] ?? null));
    const taken = new Set(found.values());
    modes.forEach((mode, index) => {
      if (!taken.has(index)) rows.push([.../** @type {null[]} */ (Array(order).fill(null)), mode]);
    });
  });
  const lowest = (/** @type {(Mode | null)[]} */ row) => row.find((mode) => mode !== null)?.frequency_hz ?? 0;
  return rows.sort((a, b) => lowest(a) - lowest(b));
}

/**
 * Pairs of like modes, the most alike first.
 * @param {Mode[]} some
 * @param {Mode[]} others
 * @param {number} length of the string [m]
 * @returns {Map<number, number>} index among the others by index among some
 */
function pairs(some, others, length) {
  const broad = closest(
    some,
    others,
    (one, other) => likeness(one, other, length) * near(one, other, 0, BROAD),
  );
  // What changes all modes of a kind, as a denser mud does, is no reason against a pair.
  const shifts = commonShifts([...broad].map(([one, other]) => [some[one], others[other]]));
  return closest(
    some,
    others,
    (one, other) => likeness(one, other, length) * near(one, other, shifts.get(one.kind) ?? 0, NARROW),
  );
}

/**
 * @param {Mode[]} some
 * @param {Mode[]} others
 * @param {(one: Mode, other: Mode) => number} of likeness of two
 * @returns {Map<number, number>}
 */
function closest(some, others, of) {
  const all = some.flatMap((one, row) =>
    others.map((other, column) => ({ row, column, likeness: of(one, other) })),
  );
  /** @type {Map<number, number>} */
  const found = new Map();
  const taken = new Set();
  for (const { row, column } of all
    .filter(({ likeness: alike }) => alike >= LEAST)
    .sort((a, b) => b.likeness - a.likeness)) {
    if (found.has(row) || taken.has(column)) continue;
    found.set(row, column);
    taken.add(column);
  }
  return found;
}

/**
 * Likeness of two modes whatever their frequencies, from 0 to 1: the common part of their shares in lateral, torsional and axial motion, the
 * common part of the depths with most of their energy, and the nearness of their largest motion.
 * @param {Mode} one
 * @param {Mode} other
 * @param {number} length of the string [m]
 */
export function likeness(one, other, length) {
  const shares =
    Math.min(one.lateral_share, other.lateral_share) +
    Math.min(one.torsional_share, other.torsional_share) +
    Math.min(one.axial_share, other.axial_share);
  const common = Math.min(one.extent[1], other.extent[1]) - Math.max(one.extent[0], other.extent[0]);
  const either = Math.max(one.extent[1], other.extent[1]) - Math.min(one.extent[0], other.extent[0]);
  const depths = either > 0 ? Math.max(0, common) / either : 1;
  const apart = Math.abs(one.measured_depth - other.measured_depth) / (APART * length);
  // The largest motion of a mode with many alike bellies jumps from one to another.
  return shares * depths * (0.5 + 0.5 * Math.exp(-apart));
}

/** @param {Mode} one @param {Mode} other @param {number} shift expected logarithm of the ratio of their frequencies @param {number} wide */
function near(one, other, shift, wide) {
  return Math.exp(-Math.abs(shiftOf(one, other) - shift) / wide);
}

/** Logarithm of the ratio of two frequencies. @param {Mode} one @param {Mode} other */
function shiftOf({ frequency_hz: one }, { frequency_hz: other }) {
  return Math.log(Math.max(other, STATIC_HZ) / Math.max(one, STATIC_HZ));
}

/** Median shift of the pairs of each kind. @param {Mode[][]} found @returns {Map<string, number>} */
function commonShifts(found) {
  /** @type {Map<string, number>} */
  const result = new Map();
  for (const kind of new Set(found.map(([one]) => one.kind))) {
    const shifts = found
      .filter(([one]) => one.kind === kind)
      .map(([one, other]) => shiftOf(one, other))
      .sort((a, b) => a - b);
    if (shifts.length >= FEWEST) result.set(kind, shifts[Math.floor(shifts.length / 2)]);
  }
  return result;
}
