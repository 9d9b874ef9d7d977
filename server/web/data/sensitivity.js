// Sensitivities of a result: the parameters' shares of its variance, from the points of a sweep.

/** Values up to which each is a group of its own; more are grouped, unless they repeat. */
const FEW_VALUES = 10;
/**
 * Groups of equal number along a parameter whose values do not repeat, at most, and the points that each has at least: what a result
 * varies within a group is missed, and is little in narrow ones.
 */
const MOST_GROUPS = 40;
const LEAST_IN_GROUP = 6;
/** Parts that are left out in turn. */
const PARTS = 40;
const TWO_SIDED_95 = 1.96;
/** Points from which an index is estimated at least. */
export const LEAST_POINTS = 8;

/**
 * @typedef {object} Share
 * @property {number} first first-order index: the share of the variance that the parameter explains alone
 * @property {[number, number] | null} interval 95 % interval of the first-order index, estimated; null where it is exact on the grid
 * @property {number | null} total total index: with all that it does together with others; null where points are no full grid
 * @property {{value: number, mean: number, error: number, count: number}[]} levels the mean result at the parameter's values, with its standard error
 */

/**
 * First-order indices are ratios of correlation, less what as many groups of unrelated points would show. On a full grid they are
 * the exact decomposition over it.
 * @param {number[][]} parameters a column each
 * @param {number[]} result
 * @returns {Share[]}
 */
export function shares(parameters, result) {
  const groups = parameters.map((column) => grouped(column));
  const isGrid = isFullGrid(groups, result.length);
  const spread = squares(result);
  return groups.map((group, order) => {
    const first = isGrid ? between(group.of, result) / spread : adjusted(group.of, result);
    return {
      first: spread > 0 ? first : 0,
      interval: isGrid || spread === 0 ? null : interval(group.of, result),
      total:
        isGrid && spread > 0
          ? 1 -
            between(
              combined(
                groups.filter((_, other) => other !== order).map((other) => other.of),
                result.length,
              ),
              result,
            ) /
              spread
          : null,
      levels: levels(group, result),
    };
  });
}

/** @param {number[]} column @returns {{of: number[], middles: number[]}} the group of each row, and where the groups are */
function grouped(column) {
  const values = [...new Set(column)].sort((a, b) => a - b);
  if (values.length <= Math.max(FEW_VALUES, Math.sqrt(column.length))) {
    const place = new Map(values.map((value, index) => [value, index]));
    return { of: column.map((value) => place.get(value) ?? 0), middles: values };
  }
  const bins = Math.max(2, Math.min(MOST_GROUPS, Math.floor(column.length / LEAST_IN_GROUP)));
  const order = column.map((_, index) => index).sort((a, b) => column[a] - column[b]);
  const of = Array(column.length).fill(0);
  order.forEach((index, rank) => (of[index] = Math.floor((rank * bins) / column.length)));
  return {
    of,
    middles: Array.from({ length: bins }, (_, bin) => mean(column.filter((__, index) => of[index] === bin))),
  };
}

/** @param {{of: number[], middles: number[]}[]} groups @param {number} rows */
function isFullGrid(groups, rows) {
  const cells = groups.reduce((product, group) => product * group.middles.length, 1);
  return (
    cells === rows &&
    new Set(
      combined(
        groups.map((group) => group.of),
        rows,
      ),
    ).size === rows
  );
}

/** @param {number[][]} parts @param {number} rows */
function combined(parts, rows) {
  /** @type {Map<string, number>} */
  const numbers = new Map();
  return Array.from({ length: rows }, (_, row) => {
    const key = parts.map((part) => part[row]).join(",");
    if (!numbers.has(key)) numbers.set(key, numbers.size);
    return numbers.get(key) ?? 0;
  });
}

/** @param {number[]} values */
function mean(values) {
  return values.reduce((sum, value) => sum + value, 0) / values.length;
}

/** @param {number[]} values */
function squares(values) {
  const middle = mean(values);
  return values.reduce((sum, value) => sum + (value - middle) ** 2, 0);
}

/** Sum of squares of the groups' means. @param {number[]} of @param {number[]} values */
function between(of, values) {
  /** @type {Map<number, {sum: number, count: number}>} */
  const sums = new Map();
  of.forEach((group, row) => {
    const entry = sums.get(group) ?? { sum: 0, count: 0 };
    entry.sum += values[row];
    entry.count += 1;
    sums.set(group, entry);
  });
  const middle = mean(values);
  return [...sums.values()].reduce(
    (sum, entry) => sum + entry.count * (entry.sum / entry.count - middle) ** 2,
    0,
  );
}

/** @param {number[]} of @param {number[]} values */
function adjusted(of, values) {
  const all = squares(values);
  const count = new Set(of).size;
  if (all === 0 || values.length <= count) return 0;
  const within = all - between(of, values);
  return 1 - within / (values.length - count) / (all / (values.length - 1));
}

/**
 * By leaving out one part of the points after the other (jackknife).
 * @param {number[]} of
 * @param {number[]} values
 * @returns {[number, number]}
 */
function interval(of, values) {
  const parts = Math.min(PARTS, values.length);
  const random = generator(1);
  const order = values.map((_, row) => row);
  for (let row = order.length - 1; row > 0; row -= 1) {
    const other = Math.floor(random() * (row + 1));
    [order[row], order[other]] = [order[other], order[row]];
  }
  const found = Array.from({ length: parts }, (_, part) => {
    const rows = order.filter((__, rank) => rank % parts !== part);
    return adjusted(
      rows.map((row) => of[row]),
      rows.map((row) => values[row]),
    );
  });
  const error = Math.sqrt(((parts - 1) / parts) * squares(found));
  const whole = adjusted(of, values);
  return [whole - TWO_SIDED_95 * error, whole + TWO_SIDED_95 * error];
}

/** The same numbers every time, so that a view shown again is the same (mulberry32). @param {number} seed */
function generator(seed) {
  let state = seed;
  return () => {
    state = (state + 0x6d2b79f5) | 0;
    let mixed = Math.imul(state ^ (state >>> 15), 1 | state);
    mixed = (mixed + Math.imul(mixed ^ (mixed >>> 7), 61 | mixed)) ^ mixed;
    return ((mixed ^ (mixed >>> 14)) >>> 0) / 4294967296;
  };
}

/** @param {{of: number[], middles: number[]}} group @param {number[]} result */
function levels(group, result) {
  /** @type {number[][]} */
  const members = group.middles.map(() => []);
  group.of.forEach((level, row) => members[level].push(result[row]));
  return group.middles.map((value, level) => {
    const values = members[level];
    return {
      value,
      mean: mean(values),
      error: values.length > 1 ? Math.sqrt(squares(values) / (values.length - 1) / values.length) : 0,
      count: values.length,
    };
  });
}
