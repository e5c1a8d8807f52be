// The page's functions of numbers. They are a plain script, as in the page.

import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { test } from "node:test";
import vm from "node:vm";

vm.runInThisContext(readFileSync(new URL("../../src/report/assets/numbers.js", import.meta.url), "utf8"));
const {
  unpacked,
  fixed,
  signed,
  percent,
  viridis,
  parsedFilter,
  blend,
  corner,
  fillTriangle,
  roundNumbers,
  zeroLines,
} = vm.runInThisContext(
  "({ unpacked, fixed, signed, percent, viridis, parsedFilter, blend, corner, fillTriangle, roundNumbers, zeroLines })",
);

test("packed numbers are little-endian", () => {
  const packed = Buffer.from([1, 0, 0, 1, 255, 255]).toString("base64");
  assert.deepEqual([...unpacked(packed, Uint16Array)], [1, 256, 65535]);
  assert.deepEqual([...unpacked(packed, Int16Array)], [1, 256, -1]);
});

test("numbers have a true minus sign", () => {
  assert.equal(fixed(-1.25, 1), "\u22121.3");
  assert.deepEqual([signed(2, 1), signed(-2, 1), signed(0, 1)], ["+2.0", "\u22122.0", "0.0"]);
  assert.deepEqual([signed(-0.004, 2), signed(0.004, 2), fixed(-1e-9, 1)], ["0.00", "0.00", "0.0"]);
  assert.equal(percent(-0.012), "\u22121.2\u00a0%");
});

test("the colour scale ends at its ends", () => {
  assert.deepEqual([viridis(-1), viridis(0.5), viridis(2)].map(String), ["68,1,84", "35,144,140", "253,231,37"]);
});

test("a filter is a bound, a range or a number as precise as it is typed", () => {
  const passes = (text, ...numbers) => numbers.filter(parsedFilter(text));
  assert.deepEqual(passes("> 0", -1, 0, 1), [1]);
  assert.deepEqual(passes("<= 1e-3", 1e-4, 1e-3, 1e-2), [1e-4, 1e-3]);
  assert.deepEqual(passes("1000 - 2000", 999, 1000, 2000, 2001), [1000, 2000]);
  assert.deepEqual(passes("\u22122 to -1", -3, -1.5, 1.5), [-1.5]);
  assert.deepEqual(passes("1270", 1269.4, 1269.6, 1270.5), [1269.6, 1270.5]);
  assert.deepEqual(passes("0.3", 0.2, 0.3, 0.36), [0.3]);
  assert.equal(parsedFilter("  "), null);
  assert.equal(parsedFilter("fast"), undefined);
});

test("a triangle is filled inside, by its corners' values", () => {
  const places = [
    [0, 0],
    [4, 0],
    [0, 4],
  ];
  const fill = (draw) => {
    const field = new Float32Array(25).fill(NaN);
    fillTriangle(field, 5, [0, 1, 2], places, [0, 4, 0], draw);
    return field;
  };
  const smooth = fill(blend);
  assert.deepEqual([smooth[0], smooth[2], smooth[5]], [0.5, 2.5, 0.5]);
  assert.ok(Number.isNaN(smooth[24]) && Number.isNaN(smooth[4]));
  assert.deepEqual([fill(corner)[0], fill(corner)[3]], [0, 4]);
});

test("numbers on an axis are round and differ", () => {
  const texts = (from, to) => roundNumbers(from, to, 5).map((tick) => tick.text);
  assert.deepEqual(texts(0.05, 0.8), ["0.2", "0.4", "0.6", "0.8"]);
  assert.deepEqual(texts(-12, 34), ["\u221210", "0", "10", "20", "30"]);
  assert.deepEqual(texts(1.9e13, 2.1e13), [
    "19000000000000",
    "19500000000000",
    "20000000000000",
    "20500000000000",
    "21000000000000",
  ]);
});

test("zero lines lie between values of other signs and leave holes out", () => {
  const grid = [
    [0, 1],
    [0, 2, 4],
  ];
  assert.deepEqual(zeroLines(grid, [-1, -1, -1, 3, 3, 3]).flat(), [
    [0.25, 0],
    [0.25, 2],
    [0.25, 2],
    [0.25, 4],
  ]);
  assert.equal(zeroLines(grid, [-1, -1, null, 3, 3, 3]).length, 1);
  assert.equal(zeroLines(grid, [1, 1, 1, 3, 3, 3]).length, 0);
});
