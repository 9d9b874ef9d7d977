// NumPy's archives, written here by the format's own description.

import "./browser.js";
import assert from "node:assert/strict";
import { test } from "node:test";
import { readArrays } from "../../data/npz.js";

/** Header and data of an array (NEP 1, version 1.0). */
function npy(descr, count, data) {
  const text = `{'descr': '${descr}', 'fortran_order': False, 'shape': (${count},), }`;
  const header = Buffer.from(`${text.padEnd(Math.ceil((text.length + 11) / 64) * 64 - 11)}\n`);
  const length = Buffer.alloc(2);
  length.writeUInt16LE(header.length);
  return Buffer.concat([Buffer.from("\x93NUMPY\x01\x00", "latin1"), length, header, data]);
}

const doubles = (...values) => npy("<f8", values.length, Buffer.from(Float64Array.from(values).buffer));
const integers = (...values) =>
  npy("<i8", values.length, Buffer.from(BigInt64Array.from(values.map(BigInt)).buffer));

/** A text as NumPy has it: UTF-32, filled up with zeros. */
function words(text, length = [...text].length) {
  const points = Uint32Array.from({ length }, (_, index) => [...text][index]?.codePointAt(0) ?? 0);
  return npy(`<U${length}`, 1, Buffer.from(points.buffer));
}

/** Local files of an archive, uncompressed; with 64-bit lengths if wanted. */
function archive(files, isLong = false) {
  return Uint8Array.from(
    Buffer.concat(
      Object.entries(files).flatMap(([name, data]) => {
        const head = Buffer.alloc(30);
        head.writeUInt32LE(0x04034b50, 0);
        head.writeUInt32LE(isLong ? 0xffffffff : data.length, 18);
        head.writeUInt32LE(isLong ? 0xffffffff : data.length, 22);
        head.writeUInt16LE(name.length, 26);
        const extra = Buffer.alloc(isLong ? 20 : 0);
        if (isLong) {
          extra.writeUInt16LE(1, 0);
          extra.writeUInt16LE(16, 2);
          extra.writeBigUInt64LE(BigInt(data.length), 4);
          extra.writeBigUInt64LE(BigInt(data.length), 12);
        }
        head.writeUInt16LE(extra.length, 28);
        return [head, Buffer.from(name), extra, data];
      }),
    ),
  ).buffer;
}

const FILES = {
  "time.npy": doubles(0, 0.5, -1e300, NaN),
  "node.npy": integers(1, 49, -7),
  "attributes_json.npy": words('{"snapshots": 3, "label": "C_f · 1 µm 𝛼"}', 60),
  "state.npy": words("done"),
};

for (const isLong of [false, true]) {
  test(`columns and attributes are read from an archive with ${isLong ? "64" : "32"}-bit lengths`, () => {
    const { columns, attributes } = readArrays(archive(FILES, isLong));
    assert.deepEqual(Object.keys(columns), ["time", "node"]);
    assert.deepEqual([...columns.time], [0, 0.5, -Infinity, NaN]);
    assert.deepEqual([...columns.node], [1, 49, -7]);
    assert.deepEqual(attributes, { snapshots: 3, label: "C_f · 1 µm 𝛼" });
  });
}

test("values are in single precision", () => {
  const { columns } = readArrays(archive({ "u.npy": doubles(0.1, 1 / 3) }));
  assert.deepEqual([...columns.u], [Math.fround(0.1), Math.fround(1 / 3)]);
});

test("an empty array and an empty archive are read", () => {
  assert.equal(readArrays(archive({ "u.npy": doubles() })).columns.u.length, 0);
  assert.deepEqual(readArrays(new ArrayBuffer(0)), { columns: {}, attributes: {} });
});

test("the central directory that follows the files is left alone", () => {
  const files = new Uint8Array(archive({ "u.npy": doubles(3) }));
  const rest = Buffer.alloc(60);
  rest.writeUInt32LE(0x02014b50, 0);
  const { columns } = readArrays(Uint8Array.from([...files, ...rest]).buffer);
  assert.deepEqual([...columns.u], [3]);
});
