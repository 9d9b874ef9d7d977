// The order of the page's folders, and imports without circles.

import assert from "node:assert/strict";
import { readdirSync, readFileSync } from "node:fs";
import { dirname, join, posix, relative } from "node:path";
import { test } from "node:test";
import { fileURLToPath } from "node:url";

const ROOT = join(dirname(fileURLToPath(import.meta.url)), "../..");
/** Folders from the bottom up: a module imports modules of its own level or below, and views next to each other import nothing of each other. */
const LEVELS = [
  ["data"],
  ["ui"],
  ["draw/picture"],
  ["draw"],
  ["list", "sweep", "point", "submit"],
  ["compare"],
  ["."],
];
const FOREIGN = ["node_modules", "tests", "vendor"];

/** @returns {string[]} paths of all modules from the page's folder */
function modules(folder = ROOT) {
  return readdirSync(folder, { withFileTypes: true }).flatMap((entry) => {
    const path = join(folder, entry.name);
    if (entry.isDirectory()) return FOREIGN.includes(entry.name) ? [] : modules(path);
    return entry.name.endsWith(".js") && !entry.name.endsWith(".config.js") ? [relative(ROOT, path)] : [];
  });
}

/** Modules that a module imports: statically, when a view needs them, or for their types. */
function importsOf(path) {
  const text = readFileSync(join(ROOT, path), "utf8");
  const named = [...text.matchAll(/(?:\bfrom |\bimport\()"(\.[^"]+)"/g)];
  return [...new Set(named.map(([, target]) => posix.join(dirname(path), target)))];
}

const imports = new Map(modules().map((path) => [path, importsOf(path)]));

test("every import leads to a module", () => {
  assert.ok(imports.size > 60);
  for (const [path, targets] of imports) {
    for (const target of targets) assert.ok(imports.has(target), `${path} imports ${target}`);
  }
});

test("no module imports itself by way of others", () => {
  const left = new Map(imports);
  for (let before = Infinity; left.size < before;) {
    before = left.size;
    for (const [path, targets] of left) if (!targets.some((target) => left.has(target))) left.delete(path);
  }
  assert.deepEqual([...left.keys()], []);
});

test("folders import from folders below them", () => {
  const levelOf = (path) => LEVELS.findIndex((folders) => folders.includes(dirname(path)));
  for (const [path, targets] of imports) {
    assert.notEqual(levelOf(path), -1, `${path} is in no known folder`);
    for (const target of targets) {
      const isBelow = levelOf(target) < levelOf(path);
      assert.ok(isBelow || dirname(target) === dirname(path), `${path} imports ${target}`);
    }
  }
});
