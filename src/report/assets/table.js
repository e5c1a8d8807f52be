// The table of modes: sorted by a click on a heading, filtered by what is typed under it.

const COLUMNS = [
  { name: "\u03bc", of: (mode) => mode.friction, text: (x) => String(x) },
  { name: "mode", of: (mode) => mode.number, text: (x) => String(x) },
  { name: "frequency, Hz", of: (mode) => mode.frequency, text: (x) => x.toFixed(2) },
  { name: "growth rate, 1/s", of: (mode) => mode.growth, text: (x) => signed(x, 2) },
  { name: "damping ratio, %", of: (mode) => 100 * mode.damping, text: (x) => fixed(x, 4) },
  { name: "backward error", of: (mode) => mode.error, text: (x) => x.toExponential(1).replaceAll("-", "\u2212") },
  { name: "branch", of: (mode) => (mode.branch ?? NaN) + 1, text: (x) => (Number.isNaN(x) ? "\u2013" : String(x)) },
  { name: "unstable", of: (mode) => Number(mode.unstable), text: (x) => (x ? "yes" : "no") },
];
const SHOWN = 1000;

const modeTable = { sort: 2, isDown: false, filters: COLUMNS.map(() => null), rows: [] };

function startTable() {
  const heads = make("tr");
  const filters = make("tr");
  COLUMNS.forEach((column, i) => {
    const button = make("button", { type: "button" }, column.name);
    button.addEventListener("click", () => {
      modeTable.isDown = modeTable.sort === i && !modeTable.isDown;
      modeTable.sort = i;
      fillTable();
    });
    heads.append(make("th", { scope: "col" }, button));
    const cell = make("th");
    if (!["\u03bc", "unstable"].includes(column.name)) cell.append(filterInput(column, i));
    filters.append(cell);
  });
  document.querySelector("#mode-table thead").append(heads, filters);
  const select = byId("mode-friction");
  select.append(make("option", { value: "" }, "all"));
  fillFrictions(select, String(worstAsked()));
  select.addEventListener("change", fillTable);
  byId("mode-unstable").addEventListener("change", fillTable);
  byId("mode-clear").addEventListener("click", clearFilters);
  choice.onChange(pickRow);
  fillTable();
}

function filterInput(column, i) {
  const input = make("input", { type: "text", "aria-label": `filter ${column.name}`, placeholder: "filter" });
  input.addEventListener("input", () => {
    const filter = parsedFilter(input.value);
    input.setAttribute("aria-invalid", filter === undefined);
    modeTable.filters[i] = filter ?? null;
    fillTable();
  });
  return input;
}

function clearFilters() {
  document.querySelectorAll("#mode-table th input").forEach((input) => {
    input.value = "";
  });
  modeTable.filters.fill(null);
  byId("mode-friction").value = "";
  byId("mode-unstable").checked = false;
  fillTable();
}

function filteredModes() {
  const friction = byId("mode-friction").value;
  const onlyUnstable = byId("mode-unstable").checked;
  const values = friction === "" ? data.asked : [data.asked[Number(friction)]];
  const all = values.flatMap((value) => data.values[value].modes.map((_, mode) => modeOf(`${value}-${mode}`)));
  const passes = (mode) => COLUMNS.every((column, i) => !modeTable.filters[i] || modeTable.filters[i](column.of(mode)));
  return all.filter((mode) => (!onlyUnstable || mode.unstable) && passes(mode));
}

function fillTable() {
  const { sort, isDown } = modeTable;
  const key = COLUMNS[sort].of;
  const rank = (x) => (Number.isNaN(x) ? Infinity : x);
  const modes = filteredModes().sort((a, b) => (isDown ? -1 : 1) * (rank(key(a)) - rank(key(b)) || 0));
  document.querySelectorAll("#mode-table thead tr:first-child th").forEach((head, i) => {
    if (i === sort) head.setAttribute("aria-sort", isDown ? "descending" : "ascending");
    else head.removeAttribute("aria-sort");
  });
  const cells = (mode) => COLUMNS.map((column) => make("td", {}, column.text(column.of(mode))));
  const rows = modes.slice(0, SHOWN).map((mode) => {
    const row = make(
      "tr",
      { "data-name": mode.name, tabindex: "0", class: mode.unstable ? "unstable" : "" },
      ...cells(mode),
    );
    row.addEventListener("click", () => choice.set(mode.name));
    row.addEventListener("keydown", (event) => {
      if (event.key === "Enter") choice.set(mode.name);
    });
    return row;
  });
  document.querySelector("#mode-table tbody").replaceChildren(...rows);
  const cut = modes.length > SHOWN ? `, the first ${SHOWN} shown` : "";
  byId("mode-count").textContent = `${modes.length} mode${modes.length === 1 ? "" : "s"}${cut}`;
  pickRow(choice.name);
}

function pickRow(name) {
  document
    .querySelectorAll("#mode-table tbody tr")
    .forEach((row) => row.classList.toggle("picked", row.dataset.name === name));
}
