// A study of many parameters: growth over a parameter, a map of two, and modes and shapes of a chosen point.

const AREA = { left: 66, top: 14, width: 480, height: 330 };

/** An element of a figure. */
function draw(parent, tag, attributes, ...children) {
  const element = document.createElementNS("http://www.w3.org/2000/svg", tag);
  for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, value);
  element.append(...children);
  parent.append(element);
  return element;
}

/** A linear axis over values with a margin: its place in pixels for a value, and round numbers. */
function axis(values, [from, to]) {
  const [low, high] = [Math.min(...values), Math.max(...values)];
  const margin = 0.04 * (high - low) || 0.5 * Math.max(Math.abs(low), 0.1);
  const [first, last] = [low - margin, high + margin];
  const at = (value) => from + ((to - from) * (value - first)) / (last - first);
  return { at, ticks: roundNumbers(first, last, Math.abs(to - from) / 70) };
}

/** An empty figure with two axes. */
function panel(container, title, x, y, names) {
  const { left, top, width, height } = AREA;
  const svg = draw(document.createDocumentFragment(), "svg", {
    viewBox: "0 0 560 400",
    role: "img",
    "aria-label": title,
    "font-size": 13,
    tabindex: 0,
  });
  for (const tick of x.ticks) {
    draw(svg, "line", {
      x1: x.at(tick.value),
      x2: x.at(tick.value),
      y1: top,
      y2: top + height,
      class: "grid",
      stroke: "#e3e6ea",
    });
    draw(svg, "text", { x: x.at(tick.value), y: top + height + 18, "text-anchor": "middle" }, tick.text);
  }
  for (const tick of y.ticks) {
    draw(svg, "line", {
      x1: left,
      x2: left + width,
      y1: y.at(tick.value),
      y2: y.at(tick.value),
      class: "grid",
      stroke: "#e3e6ea",
    });
    draw(svg, "text", { x: left - 6, y: y.at(tick.value) + 4.5, "text-anchor": "end" }, tick.text);
  }
  draw(svg, "text", { x: left + width / 2, y: top + height + 42, "text-anchor": "middle" }, names[0]);
  const [tx, ty] = [14, top + height / 2];
  draw(svg, "text", { x: tx, y: ty, "text-anchor": "middle", transform: `rotate(-90 ${tx} ${ty})` }, names[1]);
  svg.addEventListener("keydown", chooseNextPoint);
  container.replaceChildren(svg);
  return svg;
}

const largestGrowth = Math.max(...data.points.map((point) => point.growth ?? 0), 0);

/** From light to dark orange with the growth rate. */
function growthColour(growth) {
  const share = largestGrowth > 0 ? Math.min(Math.max(growth / largestGrowth, 0), 1) : 0;
  const ends = [
    [253, 190, 120],
    [150, 20, 10],
  ];
  return `rgb(${ends[0].map((c, k) => Math.round(c + share * (ends[1][k] - c))).join(",")})`;
}

const pointLabel = (point, i) =>
  [
    i ? `point ${i}` : "nominal point",
    ...data.parameters.map((name, k) => `${name} = ${Number(point.values[k].toPrecision(5))}`),
    `largest growth rate ${signed(point.growth, 2)} /s at ${point.frequency.toFixed(1)} Hz`,
  ].join("\n");

/** The mark of a point. */
function mark(svg, i, x, y) {
  const point = data.points[i];
  const attributes = point.unstable
    ? { fill: growthColour(point.growth), stroke: "#5b2008", "stroke-width": 0.6 }
    : { fill: "#ffffff", "fill-opacity": 0.2, stroke: "#0072b2", "stroke-width": 1.4 };
  const circle = draw(svg, "circle", { cx: x, cy: y, r: 5, "data-point": i, ...attributes });
  if (i === 0)
    draw(svg, "path", {
      d: `M${x - 9} ${y}H${x + 9}M${x} ${y - 9}V${y + 9}`,
      class: "ink",
      stroke: "#333333",
      "stroke-width": 1.5,
      "pointer-events": "none",
    });
  circle.addEventListener("pointermove", (event) => tip.show(event, pointLabel(point, i)));
  circle.addEventListener("pointerleave", () => tip.hide());
  circle.addEventListener("click", () => choice.set(i));
}

/** The points with modes, those with small growth first, so that large growth lies on top. */
function solvedPoints() {
  const solved = data.points.map((_, i) => i).filter((i) => data.points[i].growth !== null);
  return solved.sort((a, b) => data.points[a].growth - data.points[b].growth);
}

/** The axis of the values that these points have of a parameter. */
function parameterAxis(points, parameter, range) {
  return axis(
    points.map((n) => data.points[n].values[parameter]),
    range,
  );
}

function drawScatter() {
  const i = Number(byId("scatter-x").value);
  const solved = solvedPoints();
  if (!solved.length) return;
  const { left, top, width, height } = AREA;
  const x = parameterAxis(solved, i, [left, left + width]);
  // Rounding does not fill the figure.
  const y = axis([-0.05, 0.05, ...solved.map((n) => data.points[n].growth)], [top + height, top]);
  const svg = panel(byId("scatter"), "Largest growth rate over a parameter", x, y, [
    data.parameters[i],
    "largest growth rate, 1/s",
  ]);
  draw(svg, "line", {
    x1: left,
    x2: left + width,
    y1: y.at(0),
    y2: y.at(0),
    stroke: "#9aa0a6",
    "stroke-dasharray": "4 3",
  });
  solved.forEach((n) => mark(svg, n, x.at(data.points[n].values[i]), y.at(data.points[n].growth)));
  markPoint(choice.name);
}

function drawMap() {
  if (!byId("map")) return;
  const [i, j] = ["map-x", "map-y"].map((id) => Number(byId(id).value));
  const solved = solvedPoints();
  if (!solved.length) return;
  const { left, top, width, height } = AREA;
  const x = parameterAxis(solved, i, [left, left + width]);
  const y = parameterAxis(solved, j, [top + height, top]);
  const svg = panel(byId("map"), "Stability over two parameters", x, y, [data.parameters[i], data.parameters[j]]);
  const hopf = i !== j ? data.hopf.points.map(({ values }) => [x.at(values[i]), y.at(values[j])]) : [];
  if (hopf.length) {
    for (const ends of data.hopf.lines) {
      const [[x1, y1], [x2, y2]] = ends.map((n) => hopf[n]);
      draw(svg, "line", { x1, y1, x2, y2, class: "ink zero", stroke: "#333333", "stroke-width": 2 });
    }
  } else if (data.grid && i !== j) {
    const rates = data.points.slice(1).map((point) => (point.growth === null ? null : verdictRate(point)));
    for (const ends of zeroLines(data.grid, rates)) {
      const [[x1, y1], [x2, y2]] = ends.map((values) => [x.at(values[i]), y.at(values[j])]);
      draw(svg, "line", { x1, y1, x2, y2, class: "ink zero", stroke: "#333333", "stroke-width": 2 });
    }
  }
  solved.forEach((n) => mark(svg, n, x.at(data.points[n].values[i]), y.at(data.points[n].values[j])));
  drawHopf(svg, hopf);
  markPoint(choice.name);
}

/** Squares around Hopf points, on top: points that have led there lie below. */
function drawHopf(svg, places) {
  places.forEach(([px, py], n) => {
    const at = { x: px - 7, y: py - 7, width: 14, height: 14 };
    const look = { fill: "none", stroke: "#333333", "stroke-width": 2, "pointer-events": "stroke" };
    const square = draw(svg, "rect", { ...at, ...look, class: "hopf" });
    const { nominal, values, frequency_hz } = data.hopf.points[n];
    const mode = nominal === null ? "" : `, nominal mode ${nominal}`;
    const numbers = values.map((value, k) => `${data.parameters[k]} = ${Number(value.toPrecision(5))}`);
    const label = [`Hopf point at ${frequency_hz.toFixed(1)} Hz${mode}`, ...numbers].join("\n");
    square.addEventListener("pointermove", (event) => tip.show(event, label));
    square.addEventListener("pointerleave", () => tip.hide());
  });
}

/** The growth rate with the sign of the verdict: rounding about 0 is no boundary. */
function verdictRate(point) {
  const least = 1e-3 * largestGrowth || 1;
  return point.unstable ? Math.max(point.growth, least) : Math.min(point.growth, -least);
}

/** The left and right arrow choose the point before and after. */
function chooseNextPoint(event) {
  const step = { ArrowLeft: -1, ArrowRight: 1 }[event.key];
  if (!step) return;
  event.preventDefault();
  const n = data.points.length;
  choice.set(((choice.name ?? 0) + step + n) % n);
}

function markPoint(i) {
  document.querySelectorAll("#points circle.picked").forEach((circle) => circle.classList.remove("picked"));
  document.querySelectorAll(`#points circle[data-point="${i}"]`).forEach((circle) => circle.classList.add("picked"));
}

/** The name of a mode among the shapes. */
const shapeName = (i, [number]) => `${i}-${number}`;

/** The words for a mode by the name of its shape. */
function shapeLabel(name) {
  const [i, number] = name.split("-").map(Number);
  const [, frequency, growth] = data.points[i].modes.find((mode) => mode[0] === number);
  const at = i ? `point ${i}` : "the nominal point";
  return `${frequency.toFixed(1)} Hz, ${signed(growth, 1)} /s, mode ${number} of ${at}`;
}

/** Shows the mode of a point that grows fastest, of those whose shapes the page has. */
function showShape(i) {
  if (!shape) return;
  const growing = data.points[i].modes.toSorted((a, b) => b[2] - a[2]);
  const names = growing.map((mode) => shapeName(i, mode)).filter((name) => data.shapes[name]);
  byId("shape").classList.toggle("empty", !names.length);
  if (names.length) {
    shape.offer(names);
    shape.show(names[0]);
    return;
  }
  const hasFailed = data.points[i].failure !== null;
  byId("shape-title").textContent = "";
  byId("shape-note").textContent = hasFailed
    ? `Point ${i} has failed: it has no mode shapes.`
    : `This page has no mode shape of point ${i}; results.h5 has.`;
}

/** The number of a mode, as a button where the page has its shape. */
function modeNumber(i, mode) {
  const name = shapeName(i, mode);
  if (!shape || !data.shapes[name]) return mode[0];
  const button = make("button", { type: "button", "data-shape": name, title: "Show its shape" }, mode[0]);
  button.addEventListener("click", () => shape.show(name));
  return button;
}

/** The table of a point's modes. */
function modesOf(i) {
  const head = make("tr");
  ["mode", "frequency, Hz", "growth rate, 1/s", "nominal mode"].forEach((name) =>
    head.append(make("th", { scope: "col" }, name)),
  );
  const rows = data.points[i].modes.map((mode) => {
    const [, frequency, growth, unstable, nominal, doubtful] = mode;
    const link = nominal === null ? "\u2013" : `${nominal}${doubtful ? " ?" : ""}`;
    const cells = [modeNumber(i, mode), frequency.toFixed(2), signed(growth, 3), link];
    return make("tr", { class: unstable ? "unstable" : "" }, ...cells.map((cell) => make("td", {}, cell)));
  });
  const table = make("table", {}, make("thead", {}, head), make("tbody", {}, ...rows));
  return make("div", { class: "scroll", tabindex: "0", role: "region", "aria-label": "Modes of the point" }, table);
}

function showPoint(i) {
  const point = data.points[i];
  const list = make("dl");
  data.parameters.forEach((name, k) =>
    list.append(make("dt", {}, name), make("dd", {}, Number(point.values[k].toPrecision(8)))),
  );
  const body = point.failure === null ? modesOf(i) : make("p", {}, `Failed: ${point.failure}`);
  byId("point").replaceChildren(make("h3", {}, i ? `Point ${i}` : "Nominal point"), list, body);
  markPoint(i);
  showShape(i);
}

for (const id of ["scatter-x", "map-x", "map-y"]) {
  byId(id)?.addEventListener("change", id === "scatter-x" ? drawScatter : drawMap);
}
document.querySelectorAll("button[data-point]").forEach((button) => {
  button.addEventListener("click", () => {
    choice.set(Number(button.dataset.point));
    byId("point").scrollIntoView({ block: "nearest" });
  });
});
const shape = startShape(shapeLabel, (name) => shape.show(name));
choice.onChange(showPoint);
drawScatter();
drawMap();
choice.set(
  data.points.reduce(
    (best, point, i) => ((point.growth ?? -Infinity) > (data.points[best].growth ?? -Infinity) ? i : best),
    0,
  ),
);
