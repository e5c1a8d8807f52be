// The equilibrium's checks at one value of mu.

function startChecks() {
  if (!data.asked.length) return;
  const select = byId("check-friction");
  fillFrictions(select, worstAsked());
  select.addEventListener("change", () => fillChecks(Number(select.value)));
  fillChecks(Number(select.value));
}

function fillChecks(at) {
  const value = data.values[data.asked[at]];
  const heads = [
    "contact pair",
    "open",
    "stick",
    "slip",
    "normal force, N",
    "tangential force, N",
    "closed area, cm\u00b2",
    "peak pressure, MPa",
  ];
  const rows = value.contact.map((row) => {
    const cells = [
      row.open,
      row.stick,
      row.slip,
      row.normal_force_n.toFixed(1),
      row.tangential_force_n.toFixed(1),
      (1e4 * row.closed_area_m2).toFixed(2),
      (1e-6 * row.peak_pressure_pa).toFixed(2),
    ];
    return make("tr", {}, make("td", { class: "left" }, row.pair), ...cells.map((cell) => make("td", {}, cell)));
  });
  const steps = value.steps.map(({ label, converged, iterations }) => {
    const { relative_residual: residual } = iterations[iterations.length - 1];
    return make(
      "tr",
      { class: converged ? "" : "unstable" },
      make("td", { class: "left" }, label),
      make("td", {}, iterations.length - 1),
      make("td", {}, residual === null ? "\u2013" : residual.toExponential(1).replace("-", "\u2212")),
      make("td", {}, converged ? "yes" : "no"),
    );
  });
  const table = (names, body) =>
    make(
      "div",
      { class: "over" },
      make(
        "table",
        {},
        make(
          "thead",
          {},
          make("tr", {}, ...names.map((name, i) => make("th", { scope: "col", class: i ? "" : "left" }, name))),
        ),
        make("tbody", {}, ...body),
      ),
    );
  byId("check-body").replaceChildren(
    make("h3", {}, `Equilibrium at \u03bc = ${value.friction}: contact pairs`),
    table(heads, rows),
    make("h3", {}, "Balance"),
    make("ul", {}, ...value.checks.map((line) => make("li", {}, line))),
    make("h3", {}, "Convergence"),
    table(["Newton solution", "iterations", "relative residual", "converged"], steps),
  );
}
