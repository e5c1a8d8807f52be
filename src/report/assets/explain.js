// The explanation of a mode, as bars: shares of energy, energy input and dissipation, sensitivities of the growth rate.

function startExplain() {
  document.querySelectorAll(".instability").forEach((card, i) => {
    const one = data.instabilities[i];
    const explainable = one.modes.filter((name) => data.explained[name]);
    const select = card.querySelector("select");
    if (!explainable.length) {
      select.closest(".controls").hidden = true;
      return;
    }
    explainable.forEach((name) => select.append(make("option", { value: name }, modeOf(name).friction)));
    const show = (name) => {
      select.value = name;
      card.querySelector(".explained").replaceChildren(...explained(data.explained[name], modeOf(name)));
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

function explained(sources, mode) {
  const energies = sources.filter((s) => Math.max(s.kinetic, Math.abs(s.strain)) > 0.01);
  const powers = sources.filter(
    (s) => Math.max(Math.abs(s.fed), Math.abs(s.damped)) > 0.01 * Math.max(...sources.map((t) => Math.abs(t.fed))),
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
      powers.sort((a, b) => Math.abs(b.fed + b.damped) - Math.abs(a.fed + a.damped)),
      mode,
    ),
    slopes(sources),
  ];
}

const key = (entries) =>
  make("span", { class: "key" }, ...entries.flatMap(([style, text]) => [make("i", { class: style }), text]));

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
  const most = Math.max(...sources.flatMap((s) => [s.fed, s.fed + s.damped, 0]));
  const least = Math.min(...sources.flatMap((s) => [s.fed, s.damped, s.fed + s.damped, 0]));
  const place = (x) => (100 * (x - least)) / (most - least || 1);
  const rows = sources.map((s) => {
    const track = make("div", { class: "track" });
    if (s.fed) track.append(bar(s.fed > 0 ? "input" : "dissipation", place(0), place(s.fed)));
    if (s.damped) track.append(bar("dissipation", place(0), place(s.damped)));
    const zero = make("i", { class: "zero" });
    zero.style.left = `${place(0)}%`;
    track.append(zero);
    return make(
      "tr",
      {},
      make("td", { class: "left" }, s.name),
      make("td", { class: "bar" }, track),
      make("td", {}, signed(s.fed + s.damped, 2)),
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

const SLOPES = ["\u03bc +0.05", "damping +10\u00a0%", "stiffness +10\u00a0%", "mass +10\u00a0%"];
const AMOUNTS = [0.05, 0.1, 0.1, 0.1];

function slopes(sources) {
  const sensitive = sources.filter((s) => s.slopes.some((slope) => slope));
  if (!sensitive.length) return make("span");
  const most = Math.max(
    ...sensitive.flatMap((s) => s.slopes.map((slope, i) => (slope ? Math.abs(AMOUNTS[i] * slope[0]) : 0))),
  );
  const cell = (slope, i) => {
    if (!slope) return make("td", {}, "");
    const [growth, hertz] = [AMOUNTS[i] * slope[0], (AMOUNTS[i] * slope[1]) / (2 * Math.PI)];
    return make(
      "td",
      { title: `frequency ${signed(hertz, 1)} Hz` },
      Math.abs(growth) < 5e-4 * most ? "0" : signed(growth, 2),
    );
  };
  const weight = (s) => Math.max(...s.slopes.map((slope, i) => (slope ? Math.abs(AMOUNTS[i] * slope[0]) : 0)));
  const worth = sensitive.filter((s) => weight(s) > 0.03 * most).sort((a, b) => weight(b) - weight(a));
  const rows = worth.map((s) => make("tr", {}, make("td", { class: "left" }, s.name), ...s.slopes.map(cell)));
  const head = make(
    "tr",
    {},
    make("th", { class: "left" }, "change of"),
    ...SLOPES.map((name) => make("th", {}, name)),
  );
  return make(
    "details",
    { open: "" },
    make("summary", {}, "First-order sensitivities: change of the growth rate, 1/s"),
    make("div", { class: "over" }, make("table", {}, make("thead", {}, head), make("tbody", {}, ...rows))),
  );
}
