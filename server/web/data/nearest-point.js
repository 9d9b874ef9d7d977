// The computed point that is nearest to a place in the space of the swept parameters.

/** Range of a parameter, and its scale. @typedef {{name: string, from: number, to: number, isLog: boolean}} Span */

/**
 * Ranges of parameters over the points of a sweep; without those that are not numbers or do not vary.
 * @param {Map<string, (number | string | null)[]>} columns by name
 * @param {Record<string, any>} spans of the request
 * @returns {Span[]}
 */
export function rangesOf(columns, spans) {
  return [...columns].flatMap(([name, values]) => {
    const numbers = values.filter((value) => typeof value === "number");
    const [from, to] = [Math.min(...numbers), Math.max(...numbers)];
    if (!(from < to)) return [];
    return [{ name, from, to, isLog: spans[name]?.scale === "log" && from > 0 }];
  });
}

/** Place of a value in a range, from 0 to 1. @param {Span} span @param {number} value */
export function partOf({ from, to, isLog }, value) {
  return isLog ? Math.log(value / from) / Math.log(to / from) : (value - from) / (to - from);
}

/** Value at a part of a range. @param {Span} span @param {number} part */
export function valueAtPart({ from, to, isLog }, part) {
  return isLog ? from * (to / from) ** part : from + part * (to - from);
}

/**
 * Row of the nearest point, with distances in parts of the ranges; -1 of none.
 * @param {Span[]} spans
 * @param {Map<string, (number | string | null)[]>} columns by name
 * @param {Map<string, number>} place by name
 * @param {(row: number) => boolean} isComputed
 */
export function nearestRow(spans, columns, place, isComputed) {
  const rows = columns.values().next().value?.length ?? 0;
  let [best, least] = [-1, Infinity];
  for (let row = 0; row < rows; row += 1) {
    if (!isComputed(row)) continue;
    let square = 0;
    for (const span of spans) {
      const value = columns.get(span.name)?.[row];
      square +=
        typeof value === "number"
          ? (partOf(span, value) - partOf(span, place.get(span.name) ?? span.from)) ** 2
          : Infinity;
    }
    if (square < least) [best, least] = [row, square];
  }
  return best;
}
