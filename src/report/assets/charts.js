// Interaction with the figures: values under the pointer, a mode chosen by click or keys, the chosen mode marked.

const NEAR = 14; // pixels

function startCharts() {
  for (const svg of document.querySelectorAll(".plot svg")) {
    const marks = [...svg.querySelectorAll("circle[data-mode]")];
    if (!marks.length) continue;
    svg.addEventListener("pointermove", (event) => {
      const mark = nearest(svg, marks, event);
      if (mark) tip.show(event, tipText(modeOf(mark.dataset.mode)));
      else tip.hide();
    });
    svg.addEventListener("pointerleave", () => tip.hide());
    svg.addEventListener("click", (event) => {
      const mark = nearest(svg, marks, event);
      if (mark) choice.set(mark.dataset.mode);
    });
    if (data.instabilities.some((one) => one.modes.length)) {
      svg.setAttribute("tabindex", "0");
      svg.addEventListener("keydown", chooseByKey);
    }
  }
  choice.onChange(markChosen);
}

/** The mark nearest to the pointer, unstable ones first where several are near. */
function nearest(svg, marks, event) {
  const box = svg.getBoundingClientRect();
  const scale = svg.viewBox.baseVal.width / box.width;
  const [x, y] = [(event.clientX - box.left) * scale, (event.clientY - box.top) * scale];
  let best = null;
  let least = NEAR * scale;
  for (const mark of marks) {
    const reach = Math.hypot(mark.cx.baseVal.value - x, mark.cy.baseVal.value - y) - 0.5 * mark.r.baseVal.value;
    if (reach < least) [best, least] = [mark, reach];
  }
  return best;
}

function tipText(mode) {
  const lines = [
    `${mode.frequency.toFixed(1)} Hz, mode ${mode.number} at \u03bc = ${mode.friction}`,
    `growth rate ${signed(mode.growth, 2)} /s${mode.unstable ? ": unstable" : ""}`,
    `damping ratio ${percent(mode.damping, 3)}`,
  ];
  if (mode.branch !== null) lines.push(`branch ${mode.branch + 1}`);
  return lines.join("\n");
}

/** Left and right choose another value of mu, up and down another instability. */
function chooseByKey(event) {
  const lists = data.instabilities.map((one) => one.modes).filter((modes) => modes.length);
  let row = lists.findIndex((modes) => modes.includes(choice.name));
  let column = row < 0 ? 0 : lists[row].indexOf(choice.name);
  row = Math.max(row, 0);
  const step = { ArrowLeft: [0, -1], ArrowRight: [0, 1], ArrowUp: [-1, 0], ArrowDown: [1, 0] }[event.key];
  if (!step) return;
  event.preventDefault();
  const friction = modeOf(lists[row][column]).friction;
  column += step[1];
  if (step[0]) {
    row = (row + step[0] + lists.length) % lists.length;
    const away = (name) => Math.abs(modeOf(name).friction - friction);
    column = lists[row].reduce((best, name, i) => (away(name) < away(lists[row][best]) ? i : best), 0);
  }
  choice.set(lists[row][Math.min(Math.max(column, 0), lists[row].length - 1)]);
}

function markChosen(name) {
  const mode = modeOf(name);
  document.querySelectorAll(".plot .picked").forEach((mark) => mark.classList.remove("picked"));
  document.querySelectorAll(`.plot [data-mode="${name}"]`).forEach((mark) => mark.classList.add("picked"));
  if (mode.branch !== null) {
    document.querySelectorAll(`.plot [data-branch="${mode.branch}"]`).forEach((line) => line.classList.add("picked"));
  }
  byId("chosen").textContent = `Chosen: ${modeLabel(mode)}`;
}
