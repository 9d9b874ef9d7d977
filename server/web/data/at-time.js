// Values of samples over time, between them too.

/**
 * Row of the last sample at or before a time; -1 before the first one.
 * @param {ArrayLike<number>} times rising
 * @param {number} time
 */
export function rowBefore(times, time) {
  let [low, high] = [0, times.length];
  while (low < high) {
    const middle = (low + high) >> 1;
    if (times[middle] <= time) low = middle + 1;
    else high = middle;
  }
  return low - 1;
}

/**
 * Value at a time, on the straight line between two samples, as pictures draw it.
 * @param {ArrayLike<number>} times rising
 * @param {ArrayLike<number | null>} values
 * @param {number} time
 * @returns {number | null} null outside the samples and in gaps
 */
export function valueAtTime(times, values, time) {
  const row = rowBefore(times, time);
  if (row < 0 || row >= times.length) return null;
  const before = values[row];
  if (times[row] === time || before === null) return before;
  const after = row + 1 < times.length ? values[row + 1] : null;
  if (after === null) return null;
  return before + ((after - before) * (time - times[row])) / (times[row + 1] - times[row]);
}
