// Labels and units of columns and of a scenario's fields.

import { getNeeded } from "./api.js";
import { unitSystem } from "./settings.js";

/**
 * @typedef {object} Entry
 * @property {string} label
 * @property {string} [symbol]
 * @property {string} [meaning]
 * @property {string} [unit] the unit in which it is served
 * @property {{unit: string, size: number}} [shown]
 * @property {{unit: string, size: number}} [field]
 * @property {{word: string, colour: string}[]} [words] of a column of texts that has few, in their order
 */

/** @type {Record<string, Entry>} */
let registry = {};

/** Reads the registry; names are shown as they are until then. */
export async function loadQuantities() {
  registry = await getNeeded("/v1/quantities").catch(() => registry);
}

/** Largest value of a quantity over all nodes of which a summary has it: a column that the page makes. */
const LARGEST = /^largest_(.+)$/;
const VARIANT = /^(spread|ensemble_mean|confidence|reference|bias)_(.+)$/;
/** Ratios that are shown in per cent. */
const PER_CENT = /(^|_)error(_|$)|^relative_spread$|_spread$/;
// A node by its number, by its depth or by its distance above the bit in metres, and a spectrum window: `_49`, `_57_7m`, `_980m_w2`, `_12_5m_above_bit`.
const PLACE = /(?:_(\d+(?:_\d+)?)m(_above_bit)?|_(\d+))?(?:_w(\d+))?$/;

/**
 * Parses a name: a column, with the node, window and variant that its name may carry, or a path of the scenario.
 * @param {string} name
 * @returns {{entry: Entry | undefined, key?: string, depth?: string, height?: string, node?: string, window?: string, variant?: string}}
 */
function parse(name) {
  if (name.includes(".")) return { entry: registry[name.replace(/\[\d+\]/g, "")] };
  if (registry[name]) return { entry: registry[name], key: name };
  const largest = LARGEST.exec(name)?.[1];
  if (largest && registry[largest]) return { entry: registry[largest], key: largest, variant: "largest" };
  const variant = VARIANT.exec(name);
  const rest = variant ? variant[2] : name;
  const place = PLACE.exec(rest);
  const key = rest.replace(PLACE, "");
  return {
    entry: registry[key],
    key,
    variant: variant?.[1],
    [place?.[2] ? "height" : "depth"]: place?.[1]?.replace("_", "."),
    node: place?.[3],
    window: place?.[4],
  };
}

/**
 * Label of a name in pictures, such as `lateral vibration, node 49`.
 * @param {string} name
 */
export function label(name) {
  const { entry, depth, height, node, window, variant } = parse(name);
  if (!entry) return name.replaceAll("_", " ");
  const words = entry.label;
  if (variant === "largest") return `largest ${words} of all recorded nodes`;
  const parts = [variant ? `${variant.replaceAll("_", " ")} of ${words}` : words];
  if (depth) parts[0] += ` at ${depth} m`;
  if (height) parts[0] += ` ${height} m above the bit`;
  if (node) parts.push(`node ${node}`);
  if (window) parts.push(`window ${window}`);
  return parts.join(", ");
}

/**
 * Node that a column is of, as links name it.
 * @param {string} name of a column
 * @returns {string} such as `49`, `57.7m` or `12.5m_above_bit`; empty of a column that is of no node
 */
export function nodeOfColumn(name) {
  const { node, depth, height } = parse(name);
  if (height) return `${height}m_above_bit`;
  return node ?? (depth === undefined ? "" : `${depth}m`);
}

/** Words of a column of texts that has few, in their order. @param {string} name */
export function wordsOfColumn(name) {
  return registry[name]?.words ?? [];
}

/** @param {string} name */
export function meaning(name) {
  const { entry } = parse(name);
  return entry?.meaning ? `${entry.meaning} Column ${name}.` : "";
}

/**
 * The unit in which a name is shown: how it is written, and how many of the served unit one of it is.
 * @param {string} name
 * @returns {{symbol: string, size: number}}
 */
export function unit(name) {
  const { entry, key = "", variant } = parse(name);
  const isRelative = variant === "bias" && entry?.unit !== "Hz";
  if (isRelative || (entry?.unit === "1" && PER_CENT.test(key))) return { symbol: "%", size: 0.01 };
  if (!entry?.unit || entry.unit === "1") return { symbol: "", size: 1 };
  const preferred = unitSystem() === "field" ? entry.field : entry.shown;
  return { symbol: written(preferred?.unit ?? entry.unit), size: preferred?.size ?? 1 };
}

/** Units that have prefixes, each for a thousand. */
const PREFIXED = /^([kMG]?)((?:N|J|W|Pa)(?:·m)?)$/;
const PREFIXES = ["", "k", "M", "G"];
/** Least number that a larger unit shortens. */
const LARGE = 1e4;

/**
 * Unit of a name in which the largest of some values is a short number, such as MJ of many J.
 * @param {string} name
 * @param {(number | null)[]} values as they are served
 * @returns {{symbol: string, size: number}}
 */
export function suitedUnit(name, values) {
  const { symbol, size } = unit(name);
  const found = PREFIXED.exec(symbol);
  const largest = values.reduce(
    (/** @type {number} */ most, value) => Math.max(most, Math.abs(value ?? 0)),
    0,
  );
  if (!found || largest / size < LARGE) return { symbol, size };
  let step = PREFIXES.indexOf(found[1]);
  let factor = 1;
  while (largest / (size * factor) >= 1000 && step < PREFIXES.length - 1)
    [step, factor] = [step + 1, factor * 1000];
  return { symbol: PREFIXES[step] + found[2], size: size * factor };
}

/**
 * @param {string} name
 * @returns {string} the label with its unit in brackets, for an axis
 */
export function title(name) {
  const { symbol } = unit(name);
  return symbol ? `${label(name)} [${symbol}]` : label(name);
}

/**
 * A column in the unit in which it is shown. Gaps stay gaps.
 * @param {string} name
 * @param {(number | null)[]} values
 * @returns {(number | null)[]}
 */
export function shown(name, values) {
  const { size } = unit(name);
  return size === 1 ? values : values.map((value) => (value === null ? null : value / size));
}

/**
 * A value with its unit, in words for people.
 * @param {string} name
 * @param {unknown} value as it is served
 * @param {number} [digits]
 */
export function say(name, value, digits = 4) {
  return sayer(name, digits)(value);
}

/**
 * As `say`, for many values of one name.
 * @param {string} name
 * @param {number} [digits]
 * @returns {(value: unknown) => string}
 */
export function sayer(name, digits = 4) {
  const usual = unit(name);
  return (value) => {
    if (value === null || value === undefined) return "–";
    if (typeof value !== "number") return String(value).replaceAll("_", " ");
    const { symbol, size } = Math.abs(value) < LARGE * usual.size ? usual : suitedUnit(name, [value]);
    const text = number(value / size, digits);
    return symbol ? `${text} ${symbol}` : text;
  };
}

/**
 * Parameters of a point in words.
 * @param {Record<string, number>} values
 * @returns {string} such as `flow rate 0.01 m³/s, mud density 1200 kg/m³`
 */
export function sayParameters(values) {
  return Object.entries(values)
    .map(([name, value]) => `${label(name)} ${say(name, value)}`)
    .join(", ");
}

/** Sign of negative numbers, as wide as a plus. */
export const MINUS = "\u2212";
/** Between thousands: a narrow space at which no line breaks. */
export const THOUSANDS = "\u202f";
/** Numbers from here on are written by powers of ten. */
const HUGE = 1e9;

/**
 * A number in a few significant digits; those of five digits and more before the point have their thousands apart.
 * @param {number} value
 * @param {number} [digits]
 */
export function number(value, digits = 4) {
  const size = Math.abs(value);
  if (Number.isInteger(value) && size < 1e6) return grouped(String(value));
  if (size !== 0 && (size < 1e-3 || size >= HUGE))
    return signed(value.toExponential(digits - 1).replace("e+", "e"));
  return grouped(String(Number(value.toPrecision(digits))));
}

/** A number with the sign that the page writes. @param {string} text */
export function signed(text) {
  return text.replace(/^-/, MINUS);
}

/** @param {string} text of a number without an exponent */
function grouped(text) {
  const [whole, part] = signed(text).split(".");
  if (whole.replace(MINUS, "").length < 5) return signed(text);
  const apart = whole.replace(/\B(?=(\d{3})+$)/g, THOUSANDS);
  return part === undefined ? apart : `${apart}.${part}`;
}

/** @param {number} seconds */
export function duration(seconds) {
  if (seconds < 1) return `${number(1000 * seconds, 2)} ms`;
  if (seconds < 60) return `${number(seconds, 2)} s`;
  const minutes = Math.round(seconds / 60);
  if (minutes < 60) return `${minutes} min`;
  if (minutes < 48 * 60) return `${Math.floor(minutes / 60)} h ${minutes % 60} min`;
  return `${Math.round(minutes / 1440)} days`;
}

/**
 * A moment in the reader's time zone, as ISO 8601 writes it but for the `T`: the browser's own formats take a page tens of milliseconds
 * when it uses them first.
 * @param {string} time RFC 3339
 * @param {"minute" | "second"} [to] the last part
 */
export function moment(time, to = "minute") {
  const date = new Date(time);
  const two = (/** @type {number} */ part) => String(part).padStart(2, "0");
  const day = [date.getFullYear(), date.getMonth() + 1, date.getDate()].map(two).join("-");
  const clock = [date.getHours(), date.getMinutes(), ...(to === "second" ? [date.getSeconds()] : [])]
    .map(two)
    .join(":");
  return `${day} ${clock}`;
}

/** @param {number} count */
export function bytes(count) {
  const units = ["bytes", "kB", "MB", "GB", "TB"];
  const step = count < 1 ? 0 : Math.min(units.length - 1, Math.floor(Math.log10(count) / 3));
  return `${number(count / 1000 ** step, 3)} ${units[step]}`;
}

/** @returns {string[]} the paths of the scenario's fields that the registry knows */
export function pathNames() {
  return Object.keys(registry).filter((name) => name.includes("."));
}

/** @param {string} name @returns {string} the unit in which a name is served and requests give it; empty where it has none */
export function servedUnit(name) {
  const { entry } = parse(name);
  return entry?.unit && entry.unit !== "1" ? written(entry.unit) : "";
}

/**
 * The unit in which numbers of a name are entered: that of the oil field if the reader chose field units, else the served one.
 * @param {string} name
 * @returns {{symbol: string, size: number}}
 */
export function inputUnit(name) {
  const { entry } = parse(name);
  return unitSystem() === "field" && entry?.field
    ? readable(entry.field)
    : { symbol: servedUnit(name), size: 1 };
}

/** All units of a name by their symbols, the served one first; none of a number without a unit. @param {string} name */
export function unitsOf(name) {
  const { entry } = parse(name);
  if (!servedUnit(name)) return [];
  const further = [entry?.shown, entry?.field].flatMap((one) => (one ? [readable(one)] : []));
  return [{ symbol: servedUnit(name), size: 1 }, ...further];
}

/** @param {{unit: string, size: number}} unit */
function readable({ unit: symbol, size }) {
  return { symbol: written(symbol), size };
}

/** @param {string} symbol a unit in the registry's spelling, such as `N s/m2` */
function written(symbol) {
  return symbol
    .replace(/([A-Za-z])2/g, "$1²")
    .replace(/([A-Za-z])3/g, "$1³")
    .replaceAll(" ", "·")
    .replace(/^deg$/, "°");
}
