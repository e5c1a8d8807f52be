// Contact faces laid flat, coloured by pressure or status.

const STATUS = [
  ["open", [222, 226, 231]],
  ["slip", [230, 159, 0]],
  ["stick", [0, 114, 178]],
];
const MAP_WIDTH = 640;
const MARGIN = 24;

function startPressure() {
  if (!data.faces.length || !data.asked.length) return;
  byId("pressure").hidden = false;
  fillFrictions(byId("pressure-friction"), worstAsked());
  if (!data.faces.some((face) => data.pairs[face.pair].sliding)) byId("pressure-all").checked = true;
  for (const id of ["pressure-friction", "pressure-field", "pressure-all"])
    byId(id).addEventListener("change", drawMaps);
  choice.onChange((name) => {
    const at = data.asked.indexOf(modeOf(name).value);
    if (at >= 0 && byId("pressure-friction").value !== String(at)) {
      byId("pressure-friction").value = at;
      drawMaps();
    }
  });
  data.faces.forEach((face) => {
    face.nodes = unpacked(face.nodes, Float32Array);
    face.triangles = unpacked(face.triangles, Uint32Array);
    face.pressure = face.pressure.map((text) => unpacked(text, Uint16Array));
    face.status = face.status.map((text) => unpacked(text, Int8Array));
  });
  drawMaps();
}

function drawMaps() {
  const at = Number(byId("pressure-friction").value);
  const shown = data.faces.filter((face) => byId("pressure-all").checked || data.pairs[face.pair].sliding);
  const top = scaleTop(shown);
  byId("maps").replaceChildren(...shown.map((face) => map(face, at, top)));
}

/** The end of the colour scale: what 98 % of the closed points of all friction values stay below, so that a few peaks at edges do not hide the rest. */
function scaleTop(faces) {
  const all = faces
    .flatMap((face) => face.pressure.flatMap((packed) => Array.from(packed, (p) => (p * face.peak) / 65535)))
    .filter((p) => p > 0);
  all.sort((a, b) => a - b);
  return all[Math.floor(0.98 * (all.length - 1))] || 1;
}

function map(face, at, top) {
  const isStatus = byId("pressure-field").value === "status";
  const { canvas, field } = painted(
    face,
    (node) => (isStatus ? face.status[at][node] : (face.pressure[at][node] * face.peak) / 65535),
    isStatus,
    top,
  );
  const peak = Math.max(...face.pressure[at]) * (face.peak / 65535);
  const { pair: name, open, stick, slip, normal_force_n: normal } = data.values[data.asked[at]].contact[face.pair];
  canvas.setAttribute("role", "img");
  canvas.setAttribute("aria-label", `${isStatus ? "Contact status" : "Contact pressure"} of ${name}`);
  canvas.addEventListener("pointermove", (event) => {
    const box = canvas.getBoundingClientRect();
    const [i, j] = [event.clientX - box.left, event.clientY - box.top].map((x) =>
      Math.floor((x * canvas.width) / box.width),
    );
    const value = field[j * canvas.width + i];
    if (Number.isNaN(value) || value === undefined) tip.hide();
    else tip.show(event, isStatus ? (STATUS[value]?.[0] ?? "no contact point") : `${(1e-6 * value).toFixed(2)} MPa`);
  });
  canvas.addEventListener("pointerleave", () => tip.hide());
  return make(
    "figure",
    { class: "card" },
    make("figcaption", {}, name),
    make(
      "p",
      { class: "note" },
      `${(normal / 1000).toFixed(2)} kN; peak ${(1e-6 * peak).toFixed(2)} MPa; ${open} open, ${slip} slip, ${stick} stick`,
    ),
    canvas,
    isStatus ? statusKey() : pressureKey(top),
  );
}

function pressureKey(top) {
  const strip = make("canvas", { width: 200, height: 12 });
  paintScale(strip);
  return make("div", { class: "scale" }, "0", strip, `\u2265 ${(1e-6 * top).toPrecision(3)} MPa`);
}

function statusKey() {
  const entries = STATUS.flatMap(([name, rgb]) => {
    const swatch = make("span", { class: "swatch" });
    swatch.style.background = `rgb(${rgb})`;
    return [swatch, ` ${name}  `];
  });
  return make("div", {}, ...entries);
}

/** A canvas with the face, and the value at each pixel (NaN outside). */
function painted(face, valueAt, isStatus, top) {
  const n = face.nodes.length / 2;
  let [left, right, low, high] = [Infinity, -Infinity, Infinity, -Infinity];
  for (let i = 0; i < n; i++) {
    left = Math.min(left, face.nodes[2 * i]);
    right = Math.max(right, face.nodes[2 * i]);
    low = Math.min(low, face.nodes[2 * i + 1]);
    high = Math.max(high, face.nodes[2 * i + 1]);
  }
  const scale = (MAP_WIDTH - 2 * MARGIN) / Math.max(right - left, 0.8 * (high - low), 1e-9);
  const height = Math.ceil((high - low) * scale) + 2 * MARGIN;
  const canvas = make("canvas", { width: MAP_WIDTH, height });
  const across = (MAP_WIDTH - (right - left) * scale) / 2;
  const places = Array.from({ length: n }, (_, i) => [
    across + (face.nodes[2 * i] - left) * scale,
    height - MARGIN - (face.nodes[2 * i + 1] - low) * scale,
  ]);
  const field = new Float32Array(MAP_WIDTH * height).fill(NaN);
  const values = Array.from({ length: n }, (_, i) => valueAt(i));
  const draw = isStatus ? corner : blend;
  for (let t = 0; t < face.triangles.length; t += 3)
    fillTriangle(
      field,
      MAP_WIDTH,
      [0, 1, 2].map((k) => face.triangles[t + k]),
      places,
      values,
      draw,
    );
  if (!face.triangles.length) places.forEach(([x, y], i) => fillDisc(field, MAP_WIDTH, x, y, values[i]));
  const context = canvas.getContext("2d");
  const image = context.createImageData(MAP_WIDTH, height);
  field.forEach((value, i) => {
    if (Number.isNaN(value)) return;
    const rgb = isStatus ? (STATUS[value]?.[1] ?? [255, 255, 255]) : value > 0 ? viridis(value / top) : STATUS[0][1];
    image.data.set([...rgb, 255], 4 * i);
  });
  context.putImageData(image, 0, 0);
  drawAxes(context, face.axes, height, scale);
  return { canvas, field };
}

function fillDisc(field, width, x, y, value) {
  const radius = 7;
  for (let j = -radius; j <= radius; j++) {
    for (let i = -radius; i <= radius; i++) {
      if (i * i + j * j <= radius * radius) field[Math.round(y + j) * width + Math.round(x + i)] = value;
    }
  }
}

/** The directions, and a length in mm. */
function drawAxes(context, [right, up], height, scale) {
  const ink = "#5b6470";
  Object.assign(context, { strokeStyle: ink, fillStyle: ink, lineWidth: 1.5, font: "15px sans-serif" });
  context.beginPath();
  context.moveTo(8, height - 40);
  context.lineTo(8, height - 8);
  context.lineTo(40, height - 8);
  context.stroke();
  context.fillText(up, 4, height - 45);
  context.fillText(right, 44, height - 4);
  const length = [0.1, 0.05, 0.02, 0.01, 0.005, 0.002, 0.001].find((l) => l * scale < 200) ?? 0.0005;
  const end = MAP_WIDTH - 8;
  context.fillRect(end - length * scale, height - 8, length * scale, 3);
  context.fillText(`${1000 * length} mm`, end - length * scale, height - 12);
}
