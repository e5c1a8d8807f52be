// The shapes of the report: the chosen mode's, and a picture for each instability.

function startShapes() {
  const label = (name) => `${modeOf(name).frequency.toFixed(1)} Hz, \u03bc = ${modeOf(name).friction}`;
  const shape = startShape(label, (name) => choice.set(name));
  if (!shape) return;
  fillPictures(shape.viewer);
  const all = data.asked.flatMap((value) => data.values[value].modes.map((_, mode) => `${value}-${mode}`));
  const names = all.filter((name) => data.shapes[name]);
  shape.offer(names);
  const worst = data.instabilities[0]?.worst;
  shape.show(names.includes(worst) ? worst : names[0]);
  choice.onChange((name) => {
    if (data.shapes[name]) shape.show(name);
    else byId("shape-note").textContent = `(the results have no shape of the chosen mode, ${label(name)})`;
  });
}

/** A picture of each instability for its card. */
function fillPictures(viewer) {
  document.querySelectorAll(".instability").forEach((card, i) => {
    const packed = data.shapes[data.instabilities[i].worst];
    if (!packed) return;
    const image = card.querySelector("img");
    image.src = viewer.picture(packed, 520, 340);
    image.alt = `Mode shape: ${modeLabel(modeOf(data.instabilities[i].worst))}`;
    image.hidden = false;
  });
}
