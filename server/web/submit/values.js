// Texts of the form as values of a request, and back.

/** A text of the form that cannot be read. */
export class Unreadable extends Error {
  /** @param {string} pointer @param {string} text */
  constructor(pointer, text) {
    super(text);
    this.pointer = pointer;
  }
}

/** @param {string} text @param {string} pointer */
export function parsed(text, pointer) {
  try {
    return JSON.parse(text);
  } catch (error) {
    throw new Unreadable(pointer, `This is not JSON: ${error instanceof Error ? error.message : ""}`);
  }
}

/** Object of a JSON text; `null` for any other text. @param {string} text @returns {any} */
export function object(text) {
  try {
    const value = JSON.parse(text);
    return typeof value === "object" && !Array.isArray(value) ? value : null;
  } catch {
    return null;
  }
}

/** Value that a row sets its field to. @param {{name: string, values: string}} row */
export function changeOf({ name, values }) {
  if (values.trim() === "") throw new Unreadable(`/set/${name}`, "A value is missing");
  return read(values);
}

/** A value of the scenario: JSON, or else a word. @param {string} text */
export function read(text) {
  try {
    return JSON.parse(text);
  } catch {
    return text;
  }
}

/**
 * Values of an axis, as a request gives them.
 * @param {string} text such as `0.01, 0.02` or `0.01:0.06:6:log`
 * @param {string} name
 * @param {boolean} isDrawn whether the design draws the values
 */
export function span(text, name, isDrawn) {
  const pointer = `/axes/${name}`;
  const numbers = (/** @type {string[]} */ words) =>
    words.map((word) => {
      const value = Number(word);
      if (word.trim() === "" || Number.isNaN(value))
        throw new Unreadable(pointer, `${word.trim() || "An empty value"} is not a number`);
      return value;
    });
  if (!text.includes(":")) return { values: numbers(text.split(",")) };
  const parts = text.split(":").map((part) => part.trim());
  const scale = parts.at(-1) === "log" ? { scale: "log" } : {};
  const [from, to, count] = numbers("scale" in scale ? parts.slice(0, -1) : parts);
  if (to === undefined) throw new Unreadable(pointer, "A range is written from:to:count");
  if (count === undefined && !isDrawn) throw new Unreadable(pointer, "A range needs a count: from:to:count");
  return count === undefined ? { from, to, ...scale } : { from, to, count, ...scale };
}

/** An axis of a request as the form writes it. @param {any} axis */
export function written(axis) {
  if (axis.values) return axis.values.join(", ");
  return [axis.from, axis.to, axis.count, axis.scale === "log" ? "log" : undefined]
    .filter((part) => part !== undefined)
    .join(":");
}
