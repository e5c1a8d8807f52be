// The explanation of a mode, as bars: shares of energy, energy input and dissipation, sensitivities of the growth rate.

function startExplain() {
  document.querySelectorAll(".instability").forEach((card, i) => {
    const one = data.instabilities[i];
    const explainable = one.modes.filter((name) => modeOf(name).explained.length);
    const select = card.querySelector("select");
    if (!explainable.length) {
      select.closest(".controls").hidden = true;
      return;
    }
    explainable.forEach((name) => select.append(make("option", { value: name }, modeOf(name).friction)));
    const show = (name) => {
      select.value = name;
      card.querySelector(".explained").replaceChildren(...explained(modeOf(name)));
    };
    select.addEventListener("change", () => choice.set(select.value));
    choice.onChange((name) => {
      if (explainable.includes(name)) show(name);
    });
    card.querySelector("button").addEventListener("click", () => {
      choice.set(select.value);
      byId("answer").scrollIntoView();
    });
    show(explainable.includes(one.worst) ? one.worst : explainable[explainable.length - 1]);
  });
}

function explained(mode) {
  const sources = mode.explained.map((s) => ({
    ...s,
    kinetic: s.kinetic_share,
    strain: s.strain_share,
    input: s.energy_input_per_s,
    dissipation: s.dissipation_per_s,
  }));
  const energies = sources.filter((s) => Math.max(s.kinetic, Math.abs(s.strain)) > 0.01);
  const powers = sources.filter(
    (s) =>
      Math.max(Math.abs(s.input), Math.abs(s.dissipation)) > 0.01 * Math.max(...sources.map((t) => Math.abs(t.input))),
  );
  return [
    make(
      "h4",
      {},
      `Shares of energy at \u03bc = ${mode.friction}, from 1\u00a0%`,
      key([
        ["a", "kinetic"],
        ["b", "strain"],
      ]),
    ),
    energyBars(energies.sort((a, b) => b.kinetic + b.strain - a.kinetic - a.strain)),
    make(
      "h4",
      {},
      "Energy input and dissipation, 1/s of growth rate",
      key([
        ["input", "input"],
        ["dissipation", "dissipation"],
      ]),
    ),
    powerBars(
      powers.sort((a, b) => Math.abs(b.input + b.dissipation) - Math.abs(a.input + a.dissipation)),
      mode,
    ),
    slopes(sources),
  ];
}

const key = (entries) =>
  make(
    "span",
    { class: "key" },
    ...entries.map(([style, text]) => make("span", {}, make("i", { class: style }), text)),
  );

/** A bar from one place to another, in percent of its track. */
function bar(style, from, to) {
  const piece = make("i", { class: style });
  piece.style.left = `${Math.min(from, to)}%`;
  piece.style.width = `${Math.abs(to - from)}%`;
  return piece;
}

function energyBars(sources) {
  const track = (style, share) => make("div", { class: "track" }, bar(style, 0, 100 * Math.min(Math.max(share, 0), 1)));
  const rows = sources.map((s) =>
    make(
      "tr",
      {},
      make("td", { class: "left" }, s.name),
      make("td", { class: "bar" }, make("div", { class: "twin" }, track("a", s.kinetic), track("b", s.strain))),
      make("td", {}, percent(s.kinetic)),
      make("td", {}, percent(s.strain)),
    ),
  );
  return make("table", { class: "bars" }, make("tbody", {}, ...rows));
}

function powerBars(sources, mode) {
  const most = Math.max(...sources.flatMap((s) => [s.input, s.input + s.dissipation, 0]));
  const least = Math.min(...sources.flatMap((s) => [s.input, s.dissipation, s.input + s.dissipation, 0]));
  const place = (x) => (100 * (x - least)) / (most - least || 1);
  const rows = sources.map((s) => {
    const track = make("div", { class: "track" });
    if (s.input) track.append(bar(s.input > 0 ? "input" : "dissipation", place(0), place(s.input)));
    if (s.dissipation) track.append(bar("dissipation", place(0), place(s.dissipation)));
    const zero = make("i", { class: "zero" });
    zero.style.left = `${place(0)}%`;
    track.append(zero);
    return make(
      "tr",
      {},
      make("td", { class: "left" }, s.name),
      make("td", { class: "bar" }, track),
      make("td", {}, signed(s.input + s.dissipation, 2)),
    );
  });
  const total = make(
    "tr",
    {},
    make("td", { class: "left" }, "sum: growth rate"),
    make("td"),
    make("td", {}, signed(mode.growth, 2)),
  );
  return make("table", { class: "bars" }, make("tbody", {}, ...rows, total));
}

const CHANGES = [
  { of: "friction", by: 0.05, name: "\u03bc +0.05" },
  { of: "damping", by: 0.1, name: "damping +10\u00a0%" },
  { of: "stiffness", by: 0.1, name: "stiffness +10\u00a0%" },
  { of: "mass", by: 0.1, name: "mass +10\u00a0%" },
];

/** The change of the growth rate in 1/s by each change, null where it is unknown. */
const growthChanges = (s) =>
  CHANGES.map(({ of, by }) => (s[`growth_per_${of}`] === null ? null : by * s[`growth_per_${of}`]));

function slopes(sources) {
  const weight = (s) => Math.max(0, ...growthChanges(s).map(Math.abs));
  const most = Math.max(...sources.map(weight));
  if (!most) return make("span");
  const cell = (s) => (growth, i) => {
    if (growth === null) return make("td", {}, "");
    const { of, by } = CHANGES[i];
    const title = `frequency ${signed(by * s[`frequency_per_${of}`], 1)} Hz`;
    return make("td", { title }, Math.abs(growth) < 5e-4 * most ? "0" : signed(growth, 2));
  };
  const worth = sources.filter((s) => weight(s) > 0.03 * most).sort((a, b) => weight(b) - weight(a));
  const rows = worth.map((s) =>
    make("tr", {}, make("td", { class: "left" }, s.name), ...growthChanges(s).map(cell(s))),
  );
  const head = make(
    "tr",
    {},
    make("th", { class: "left" }, "change of"),
    ...CHANGES.map(({ name }) => make("th", {}, name)),
  );
  return make(
    "details",
    { open: "" },
    make("summary", {}, "First-order sensitivities: change of the growth rate, 1/s"),
    make("div", { class: "over" }, make("table", {}, make("thead", {}, head), make("tbody", {}, ...rows))),
  );
}
