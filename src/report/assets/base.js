// The data, and helpers of all other scripts. Text goes to the page as text, never as markup.

const data = JSON.parse(document.getElementById("data").textContent);

const byId = (id) => document.getElementById(id);

/** A new element with attributes and children; a child that is no element becomes text. */
function make(tag, attributes = {}, ...children) {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, value);
  element.append(...children.map((child) => (child instanceof Node ? child : String(child))));
  return element;
}

/** A mode by its name "value-mode". */
function modeOf(name) {
  const [value, mode] = name.split("-").map(Number);
  const row = data.values[value].modes[mode];
  return {
    name,
    value,
    number: row.mode,
    friction: data.values[value].friction,
    frequency: row.frequency_hz,
    growth: row.growth_rate_per_s,
    damping: row.damping_ratio,
    error: row.backward_error,
    unstable: row.unstable,
    branch: data.branch_of[value][mode],
    explained: row.explained,
  };
}

const modeLabel = (mode) =>
  `${mode.frequency.toFixed(1)} Hz at \u03bc = ${mode.friction}: growth rate ${signed(mode.growth, 1)} /s, damping ratio ${percent(mode.damping, 2)}`;

/** The instability that a mode belongs to, or -1. */
const instabilityOf = (name) => data.instabilities.findIndex((one) => one.modes.includes(name));

/** The chosen mode. Its listeners are called at each choice. */
const choice = {
  name: null,
  listeners: [],
  onChange(listener) {
    this.listeners.push(listener);
  },
  set(name) {
    if (name === this.name) return;
    this.name = name;
    this.listeners.forEach((listener) => listener(name));
  },
};

/** Fills a select with the requested values of mu; its values are places among data.asked. */
function fillFrictions(select, chosen) {
  data.asked.forEach((value, i) => select.append(make("option", { value: i }, data.values[value].friction)));
  select.value = chosen;
}

/** The place among data.asked where the strongest mode is, else the last. */
function worstAsked() {
  const last = data.asked.length - 1;
  if (!data.instabilities.length) return last;
  const at = data.asked.indexOf(modeOf(data.instabilities[0].worst).value);
  return at < 0 ? last : at;
}

const PARTS = ["#8fa3b8", "#e69f00", "#56b4e9", "#009e73", "#f0e442", "#0072b2", "#d55e00", "#cc79a7"];
/** Paints the colour scale over a canvas, upwards or to the right. */
function paintScale(canvas) {
  const context = canvas.getContext("2d");
  const isUpright = canvas.height > canvas.width;
  const n = isUpright ? canvas.height : canvas.width;
  for (let i = 0; i < n; i++) {
    context.fillStyle = `rgb(${viridis((i + 0.5) / n).join(",")})`;
    if (isUpright) context.fillRect(0, n - 1 - i, canvas.width, 1);
    else context.fillRect(i, 0, 1, canvas.height);
  }
}

const tip = {
  show(event, text) {
    const box = byId("tip");
    box.textContent = text;
    box.hidden = false;
    const { width, height } = box.getBoundingClientRect();
    box.style.left = `${Math.min(event.clientX + 14, innerWidth - width - 8)}px`;
    box.style.top = `${Math.max(8, event.clientY - height - 10)}px`;
  },
  hide() {
    byId("tip").hidden = true;
  },
};
