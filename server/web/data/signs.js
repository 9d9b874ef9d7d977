// Sign rules of quantities, for the captions of pictures that show them.

/** Names of signed quantities, and their rules. @type {[RegExp, string][]} */
const RULES = [
  [/(^|_)tension(_|$)/, "Tension is positive, compression negative."],
  [/(^|_)torque(_(?!on_bit)|$)/, "Torque is negative if it opposes clockwise rotation."],
  [/whirl_speed/, "Whirl speed is positive forward, negative backward."],
  [/(rotation|bit)_speed_min/, "Rotation speed is negative backward."],
];
/** Energies and ranges have no such sign. */
const UNSIGNED = /^work_|_range$|^operation\./;

/**
 * Sign rules of some quantities, each once.
 * @param {(string | undefined)[]} names
 * @returns {string} sentences; empty if no quantity is signed
 */
export function signRules(names) {
  const signed = names.filter((name) => name !== undefined && !UNSIGNED.test(name));
  return RULES.filter(([pattern]) => signed.some((name) => pattern.test(String(name))))
    .map(([, rule]) => rule)
    .join(" ");
}
