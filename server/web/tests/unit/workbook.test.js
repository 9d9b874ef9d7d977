// Archives, written here by the format's description (APPNOTE 6.3).

import "./browser.js";
import assert from "node:assert/strict";
import { test } from "node:test";
import { deflateRawSync } from "node:zlib";
import { fileOf } from "../../data/workbook.js";

/** An archive of texts by name, compressed or not, with a comment at its end. */
function archive(files, isDeflated) {
  const locals = [],
    entries = [];
  let start = 0;
  for (const [name, text] of Object.entries(files)) {
    const data = isDeflated ? deflateRawSync(Buffer.from(text)) : Buffer.from(text);
    const local = Buffer.alloc(30);
    local.writeUInt32LE(0x04034b50, 0);
    local.writeUInt16LE(name.length, 26);
    local.writeUInt16LE(3, 28);
    locals.push(local, Buffer.from(name), Buffer.alloc(3), data);
    const entry = Buffer.alloc(46);
    entry.writeUInt32LE(0x02014b50, 0);
    entry.writeUInt16LE(isDeflated ? 8 : 0, 10);
    entry.writeUInt32LE(data.length, 20);
    entry.writeUInt32LE(Buffer.byteLength(text), 24);
    entry.writeUInt16LE(name.length, 28);
    entry.writeUInt32LE(start, 42);
    entries.push(entry, Buffer.from(name));
    start += 30 + name.length + 3 + data.length;
  }
  const directory = Buffer.concat(entries);
  const end = Buffer.alloc(22);
  end.writeUInt32LE(0x06054b50, 0);
  end.writeUInt32LE(directory.length, 12);
  end.writeUInt32LE(start, 16);
  end.writeUInt16LE(4, 20);
  return new Blob([...locals, directory, end, "note"]);
}

test("a file of an archive is found by its name, compressed or not", async () => {
  const files = { "[Content_Types].xml": "<Types/>", "xl/workbook.xml": '<sheet name="BHA 1"/>'.repeat(50) };
  for (const isDeflated of [false, true]) {
    const made = archive(files, isDeflated);
    assert.equal(await fileOf(made, "xl/workbook.xml"), files["xl/workbook.xml"]);
    assert.equal(await fileOf(made, "xl/other.xml"), null);
  }
});

test("a file that is no archive, or a damaged one, has no files", async () => {
  assert.equal(await fileOf(new Blob(["Length;OD\n1;2\n".repeat(9000)]), "xl/workbook.xml"), null);
  assert.equal(await fileOf(new Blob([]), "xl/workbook.xml"), null);
  const bytes = new Uint8Array(await archive({ "xl/workbook.xml": "<a/>".repeat(99) }, true).arrayBuffer());
  bytes.fill(255, 50, 60);
  assert.equal(await fileOf(new Blob([bytes]), "xl/workbook.xml"), null);
});
