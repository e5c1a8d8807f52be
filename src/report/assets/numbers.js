// Functions of numbers alone, without the page: tests/page has their tests.

/** Little-endian numbers packed in base64, as an array of the given type. */
function unpacked(text, Type) {
  const bytes = atob(text);
  const buffer = new Uint8Array(bytes.length);
  for (let i = 0; i < bytes.length; i++) buffer[i] = bytes.charCodeAt(i);
  return new Type(buffer.buffer);
}

/** A number with so many decimals and a true minus sign; what is rounded to zero has no sign. */
const fixed = (x, decimals) => (Number(x.toFixed(decimals)) || 0).toFixed(decimals).replace("-", "\u2212");
const signed = (x, decimals) => (Number(x.toFixed(decimals)) > 0 ? "+" : "") + fixed(x, decimals);
const percent = (x, decimals = 1) => `${fixed(100 * x, decimals)}\u00a0%`;

const VIRIDIS = [
  [68, 1, 84],
  [72, 40, 120],
  [62, 74, 137],
  [49, 104, 142],
  [38, 130, 142],
  [31, 158, 137],
  [53, 183, 121],
  [109, 205, 89],
  [180, 222, 44],
  [253, 231, 37],
];

/** Viridis at x from 0 to 1, as red, green, blue from 0 to 255. */
function viridis(x) {
  const at = Math.min(Math.max(x, 0), 1) * (VIRIDIS.length - 1);
  const i = Math.min(Math.floor(at), VIRIDIS.length - 2);
  return VIRIDIS[i].map((c, k) => Math.round(c + (at - i) * (VIRIDIS[i + 1][k] - c)));
}

/** A test of numbers from "5", "> 5", "<= 5" or "5 - 7"; null where nothing is asked, undefined where it cannot be read. */
function parsedFilter(text) {
  const plain = text.replaceAll("\u2212", "-").trim();
  if (!plain) return null;
  const number = "([-+]?(?:\\d+\\.?\\d*|\\.\\d+)(?:e[-+]?\\d+)?)";
  const bound = plain.match(new RegExp(`^(<=|>=|<|>)\\s*${number}$`, "i"));
  if (bound) {
    const limit = Number(bound[2]);
    return { "<": (x) => x < limit, ">": (x) => x > limit, "<=": (x) => x <= limit, ">=": (x) => x >= limit }[bound[1]];
  }
  const range = plain.match(new RegExp(`^${number}\\s*(?:-|\u2013|to|\\.\\.)\\s*${number}$`, "i"));
  if (range) return (x) => x >= Number(range[1]) && x <= Number(range[2]);
  if (!new RegExp(`^${number}$`, "i").test(plain)) return undefined;
  const wanted = Number(plain);
  const digits = (plain.split(/e/i)[0].split(".")[1] ?? "").length;
  return (x) =>
    Math.abs(x - wanted) <= 0.5 * 10 ** -digits * (plain.match(/e/i) ? 10 ** Number(plain.split(/e/i)[1]) : 1);
}

/** The value at a point of a triangle from its corners' values, by barycentric weights. */
const blend = (weights, values) => weights[0] * values[0] + weights[1] * values[1] + weights[2] * values[2];
/** The value of the nearest corner. */
const corner = (weights, values) => values[weights.indexOf(Math.max(...weights))];

/** Writes the values of a triangle at the pixels inside it. */
function fillTriangle(field, width, nodes, places, values, draw) {
  const [a, b, c] = nodes.map((i) => places[i]);
  const own = nodes.map((i) => values[i]);
  const area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
  if (!area) return;
  const xs = [a[0], b[0], c[0]];
  const ys = [a[1], b[1], c[1]];
  for (let j = Math.floor(Math.min(...ys)); j <= Math.max(...ys); j++) {
    for (let i = Math.floor(Math.min(...xs)); i <= Math.max(...xs); i++) {
      const [x, y] = [i + 0.5, j + 0.5];
      const u = ((b[0] - x) * (c[1] - y) - (b[1] - y) * (c[0] - x)) / area;
      const v = ((c[0] - x) * (a[1] - y) - (c[1] - y) * (a[0] - x)) / area;
      if (u >= -1e-6 && v >= -1e-6 && u + v <= 1 + 1e-6) field[j * width + i] = draw([u, v, 1 - u - v], own);
    }
  }
}

/** About n round numbers between two, with their texts. */
function roundNumbers(from, to, n) {
  const rough = (to - from) / n;
  const power = 10 ** Math.floor(Math.log10(rough));
  const step = [1, 2, 5, 10].map((s) => s * power).find((s) => s >= 0.999 * rough);
  const decimals = Math.max(0, -Math.floor(Math.log10(step) + 1e-9));
  const isLarge = Math.max(Math.abs(from), Math.abs(to)) >= 1e5 || decimals > 5;
  const text = (value) =>
    isLarge ? String(Number(value.toPrecision(6))).replace("-", "\u2212") : fixed(value, decimals);
  const all = [];
  for (let k = Math.ceil(from / step - 1e-9); k * step <= to + 1e-9 * step; k++)
    all.push({ value: k * step, text: text(k * step) });
  return all;
}

/**
 * Where the values on a grid of two parameters are zero: pairs of ends, by linear interpolation along the sides of its
 * cells. The second parameter varies first; null is no value.
 */
function zeroLines([first, second], values) {
  const lines = [];
  const at = (i, j) => values[i * second.length + j];
  const crossing = ([i, j], [k, l]) => {
    const [a, b] = [at(i, j), at(k, l)];
    if (a > 0 === b > 0) return null;
    const t = a / (a - b);
    return [first[i] + t * (first[k] - first[i]), second[j] + t * (second[l] - second[j])];
  };
  for (let i = 0; i + 1 < first.length; i++) {
    for (let j = 0; j + 1 < second.length; j++) {
      const corners = [
        [i, j],
        [i + 1, j],
        [i + 1, j + 1],
        [i, j + 1],
      ];
      if (corners.some(([k, l]) => at(k, l) === null)) continue;
      const ends = corners.map((corner, k) => crossing(corner, corners[(k + 1) % 4])).filter(Boolean);
      for (let k = 0; k + 1 < ends.length; k += 2) lines.push([ends[k], ends[k + 1]]);
    }
  }
  return lines;
}
