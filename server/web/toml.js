// Reads TOML 1.0, the notation of scenario files, but for dates, which no scenario has.

/** A text that is no TOML. */
export class NoToml extends Error {}

/** @type {Record<string, string>} */
const ESCAPES = { b: "\b", t: "\t", n: "\n", f: "\f", r: "\r", '"': '"', "\\": "\\" };
const DECIMAL = /^[+-]?(0|[1-9](_?\d)*)(\.\d(_?\d)*)?([eE][+-]?\d(_?\d)*)?$/;
const OTHER_BASES = /^0(x[\da-fA-F](_?[\da-fA-F])*|o[0-7](_?[0-7])*|b[01](_?[01])*)$/;

/** @typedef {Record<string, any>} Table */

/**
 * @param {string} text
 * @returns {Table} what JSON would say of it
 */
export function readToml(text) {
  return new Reader(text.replaceAll("\r\n", "\n")).document();
}

class Reader {
  at = 0;
  /** Tables that a header has named, those that dotted keys have made, and values, to which nothing can be added. @type {WeakSet<object>} */
  #headed = new WeakSet();
  /** @type {WeakSet<object>} */
  #dotted = new WeakSet();
  /** @type {WeakSet<object>} */
  #closed = new WeakSet();

  /** @param {string} text */
  constructor(text) {
    this.text = text;
  }

  document() {
    const root = empty();
    let table = root;
    for (this.#blank(); this.at < this.text.length; this.#blank()) {
      if (this.#takes("[[")) table = this.#header(root, "]]");
      else if (this.#takes("[")) table = this.#header(root, "]");
      else this.#pair(table);
      this.#spaces();
      if (this.text[this.at] === "#") this.#comment();
      if (this.at < this.text.length && this.text[this.at] !== "\n") this.#fail("a line ends after its value");
    }
    return root;
  }

  /** @param {Table} root @param {string} end @returns {Table} the table whose pairs follow */
  #header(root, end) {
    const path = this.#path();
    if (!this.#takes(end)) this.#fail(`${end} is missing`);
    const name = path.pop() ?? "";
    const parent = path.reduce((table, part) => this.#into(table, part, false), root);
    const there = parent[name];
    if (end === "]]") {
      if (there !== undefined && (!Array.isArray(there) || this.#closed.has(there))) this.#fail(`${name} is no list of tables`);
      const table = empty();
      (parent[name] ??= []).push(table);
      return table;
    }
    if (there !== undefined && (!isTable(there) || this.#headed.has(there) || this.#dotted.has(there) || this.#closed.has(there))) this.#fail(`${name} is given twice`);
    const table = (parent[name] ??= empty());
    this.#headed.add(table);
    return table;
  }

  /** @param {Table} table @param {string} name @param {boolean} isDotted @returns {Table} the table of that name, or the last of a list */
  #into(table, name, isDotted) {
    if (table[name] === undefined) {
      table[name] = empty();
      if (isDotted) this.#dotted.add(table[name]);
    }
    const there = table[name];
    const isOpen = typeof there === "object" && !this.#closed.has(there) && (!isDotted || (isTable(there) && !this.#headed.has(there)));
    if (!isOpen) this.#fail(`${name} cannot be added to`);
    return Array.isArray(there) ? there[there.length - 1] : there;
  }

  /** @param {Table} table */
  #pair(table) {
    const path = this.#path();
    if (!this.#takes("=")) this.#fail("= is missing after a key");
    const name = path.pop() ?? "";
    const owner = path.reduce((inner, part) => this.#into(inner, part, true), table);
    if (owner[name] !== undefined) this.#fail(`${name} is given twice`);
    this.#spaces();
    owner[name] = this.#value();
    if (typeof owner[name] === "object") this.#closed.add(owner[name]);
  }

  #path() {
    const parts = [];
    do {
      this.#spaces();
      const quote = this.text[this.at];
      if (quote === '"' || quote === "'") parts.push(this.#string(quote));
      else parts.push(this.#matched(/[\w-]+/y) || this.#fail("a key is missing"));
      this.#spaces();
    } while (this.#takes("."));
    return parts;
  }

  /** @returns {any} */
  #value() {
    const first = this.text[this.at];
    if (first === '"' || first === "'") return this.text.startsWith(first.repeat(3), this.at) ? this.#lines(first) : this.#string(first);
    if (this.#takes("[")) return this.#list();
    if (this.#takes("{")) return this.#inline();
    const word = this.#matched(/[^\s,\]}#]+/y);
    if (word === "true" || word === "false") return word === "true";
    if (OTHER_BASES.test(word)) return Number(word.replaceAll("_", ""));
    // Infinity and what is no number have no place in a scenario, nor in JSON.
    if (DECIMAL.test(word) && Number.isFinite(Number(word.replaceAll("_", "")))) return Number(word.replaceAll("_", ""));
    return this.#fail(word ? `${word.slice(0, 40)} is no value that a scenario has` : "a value is missing");
  }

  #list() {
    const values = [];
    for (this.#blank(); !this.#takes("]"); this.#blank()) {
      values.push(this.#value());
      this.#blank();
      if (!this.#takes(",") && this.text[this.at] !== "]") this.#fail("a list goes on with a comma or ends with ]");
    }
    return values;
  }

  #inline() {
    const table = empty();
    this.#spaces();
    if (this.#takes("}")) return table;
    do {
      this.#pair(table);
      this.#spaces();
    } while (this.#takes(","));
    if (!this.#takes("}")) this.#fail("a table within a line goes on with a comma or ends with }");
    return table;
  }

  /** A string within a line. @param {string} quote */
  #string(quote) {
    this.at += 1;
    let result = "";
    while (!this.#takes(quote)) {
      const sign = this.text[this.at];
      if (sign === undefined || sign === "\n") this.#fail("a string does not end in its line");
      result += this.#sign(quote);
    }
    return result;
  }

  /** A string of several lines. @param {string} quote */
  #lines(quote) {
    const end = quote.repeat(3);
    this.at += 3;
    this.#takes("\n");
    let result = "";
    while (!this.#takes(end)) {
      if (this.at >= this.text.length) this.#fail("a string does not end");
      if (quote === '"' && this.#matched(/\\[ \t]*\n\s*/y)) continue;
      result += this.#sign(quote);
    }
    // Up to two quotes may stand before those that end it.
    while (this.#takes(quote)) result += quote;
    return result;
  }

  /** One sign of a string, with what an escape stands for. @param {string} quote */
  #sign(quote) {
    const sign = this.text[this.at];
    if (/[\0-\x08\x0b-\x1f\x7f]/.test(sign)) this.#fail("a string has a control character");
    this.at += 1;
    if (quote === "'" || sign !== "\\") return sign;
    const code = this.#matched(/u[\da-fA-F]{4}|U[\da-fA-F]{8}/y);
    const point = parseInt(code.slice(1), 16);
    if (code) return point <= 0x10ffff && (point < 0xd800 || point > 0xdfff) ? String.fromCodePoint(point) : this.#fail(`\\${code} is no character`);
    const letter = this.text[this.at];
    this.at += 1;
    return ESCAPES[letter] ?? this.#fail(`\\${letter} is no escape`);
  }

  /** @param {RegExp} sticky @returns {string} what stands here of that kind; empty where nothing does */
  #matched(sticky) {
    sticky.lastIndex = this.at;
    const found = sticky.exec(this.text)?.[0] ?? "";
    this.at += found.length;
    return found;
  }

  /** @param {string} text */
  #takes(text) {
    if (!this.text.startsWith(text, this.at)) return false;
    this.at += text.length;
    return true;
  }

  #spaces() {
    this.#matched(/[ \t]*/y);
  }

  #comment() {
    this.#matched(/#[^\n]*/y);
  }

  /** Passes spaces, ends of lines and comments. */
  #blank() {
    this.#matched(/(?:\s|#[^\n]*)*/y);
  }

  /** @param {string} text @returns {never} */
  #fail(text) {
    throw new NoToml(`Line ${this.text.slice(0, this.at).split("\n").length}: ${text}`);
  }
}

/** @returns {Table} without what objects have of themselves, so that no key is special */
function empty() {
  return Object.create(null);
}

/** @param {unknown} value */
function isTable(value) {
  return typeof value === "object" && value !== null && !Array.isArray(value);
}
