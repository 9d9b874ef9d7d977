// Round numbers along a linear axis.

import { number } from "../data/units.js";

/**
 * Round values between two.
 * @param {number} low
 * @param {number} high
 * @param {number} count of values at most, about
 */
export function roundValues(low, high, count) {
  const rough = (high - low) / count;
  const power = 10 ** Math.floor(Math.log10(rough));
  const step = power * ([1, 2, 5].find((digit) => digit * power >= rough) ?? 10);
  const first = Math.ceil(low / step - 1e-9);
  return Array.from(
    { length: Math.max(0, Math.floor(high / step + 1e-9) - first + 1) },
    (_, index) => (first + index) * step,
  );
}

/** A number at an axis. @param {number} value */
export function tickText(value) {
  return number(Number(value.toPrecision(6)), 6).replace("-", "−");
}
