// The mode shape in motion, and its controls.

const PERIOD = 1600; // ms
const LARGEST = 0.15; // of the model's size
const VIEWS = { iso: [0.55, 0.42], x: [-Math.PI / 2, 0], y: [0, Math.PI / 2], z: [0, 0] };

/**
 * Starts the figure of a mode shape; gives nothing where there is none to show. `label` has the words for a mode by its
 * name, `choose` is called where the reader selects another mode.
 */
function startShape(label, choose) {
  if (!data.surface || !Object.keys(data.shapes).length) return null;
  byId("shape").hidden = false;
  let viewer;
  try {
    viewer = new Viewer(byId("view"), data.surface);
  } catch (error) {
    byId("shape-note").textContent = `No picture: ${error.message}.`;
    byId("shape").classList.add("empty");
    return null;
  }
  const motion = new Motion(viewer);
  startControls(viewer, motion);
  startTurning(viewer, motion);
  paintScale(document.querySelector("#legend canvas"));
  const select = byId("shape-mode");
  select.addEventListener("change", () => choose(select.value));
  motion.play(!matchMedia("(prefers-reduced-motion: reduce)").matches);
  return {
    viewer,
    /** The modes that can be selected, by their names. */
    offer(names) {
      select.replaceChildren(...names.map((name) => make("option", { value: name }, label(name))));
    },
    /** Shows a shape that the page has. */
    show(name) {
      byId("shape-title").textContent = `Mode shape at ${label(name)}`;
      byId("shape-note").textContent = "";
      select.value = name;
      viewer.setShape(data.shapes[name]);
      byId("legend-top").textContent = viewer.full < 0.995 ? `\u2265 ${viewer.full.toFixed(2)}` : "1";
      motion.redraw();
    },
  };
}

/** Draws again when something has changed, and all the time while the shape moves in sight. */
class Motion {
  constructor(viewer) {
    Object.assign(this, { viewer, isPlaying: false, isSeen: true, isAsked: false, last: null });
    new IntersectionObserver(([entry]) => {
      this.isSeen = entry.isIntersecting;
      this.redraw();
    }).observe(viewer.canvas);
    new ResizeObserver(() => this.redraw()).observe(viewer.canvas);
    addEventListener("beforeprint", () => this.viewer.draw());
  }

  play(isPlaying) {
    this.isPlaying = isPlaying;
    this.last = null;
    byId("play").textContent = isPlaying ? "Pause" : "Play";
    byId("play").setAttribute("aria-pressed", isPlaying);
    this.redraw();
  }

  redraw() {
    if (this.isAsked) return;
    this.isAsked = true;
    requestAnimationFrame((now) => this.frame(now));
  }

  frame(now) {
    this.isAsked = false;
    if (this.isPlaying && this.last !== null)
      this.viewer.phase = (this.viewer.phase + (2 * Math.PI * (now - this.last)) / PERIOD) % (2 * Math.PI);
    this.last = now;
    this.viewer.draw();
    if (this.isPlaying && this.isSeen) this.redraw();
    else this.last = null;
  }
}

function startControls(viewer, motion) {
  byId("play").addEventListener("click", () => motion.play(!motion.isPlaying));
  const amplitude = byId("amplitude");
  const setAmplitude = () => {
    viewer.amplitude = (LARGEST * amplitude.value) / 100;
    motion.redraw();
  };
  amplitude.addEventListener("input", setAmplitude);
  setAmplitude();
  byId("colouring").addEventListener("change", (event) => {
    viewer.bySize = event.target.value === "size";
    byId("legend").hidden = !viewer.bySize;
    motion.redraw();
  });
  document.querySelectorAll("[data-view]").forEach((button) =>
    button.addEventListener("click", () => {
      [viewer.yaw, viewer.pitch] = VIEWS[button.dataset.view];
      Object.assign(viewer, { pan: [0, 0], zoom: 1 });
      motion.redraw();
    }),
  );
  data.surface.parts.forEach(([name], i) => {
    const box = make("input", { type: "checkbox" });
    box.checked = true;
    box.addEventListener("change", () => {
      viewer.shown[i] = box.checked;
      motion.redraw();
    });
    const swatch = make("span", { class: "swatch" });
    swatch.style.background = PARTS[i % PARTS.length];
    byId("parts").append(make("label", {}, box, " ", swatch, ` ${name}`));
  });
}

/** Turning, shifting and zooming by pointer, wheel and keys. */
function startTurning(viewer, motion) {
  const { canvas } = viewer;
  const turnBy = (dx, dy) => {
    viewer.yaw += dx;
    viewer.pitch = Math.min(Math.max(viewer.pitch + dy, -Math.PI / 2), Math.PI / 2);
    motion.redraw();
  };
  const zoomBy = (factor) => {
    viewer.zoom = Math.min(Math.max(viewer.zoom * factor, 0.3), 20);
    motion.redraw();
  };
  canvas.addEventListener("pointerdown", (event) => canvas.setPointerCapture(event.pointerId));
  canvas.addEventListener("contextmenu", (event) => event.preventDefault());
  canvas.addEventListener("pointermove", (event) => {
    if (!canvas.hasPointerCapture(event.pointerId)) return;
    if (event.shiftKey || event.buttons === 2) {
      const step = 2 / canvas.clientHeight / viewer.zoom;
      viewer.pan = [viewer.pan[0] + step * event.movementX, viewer.pan[1] - step * event.movementY];
      motion.redraw();
    } else turnBy(0.008 * event.movementX, 0.008 * event.movementY);
  });
  // The page scrolls over the picture unless the reader has turned to it.
  canvas.addEventListener(
    "wheel",
    (event) => {
      if (document.activeElement !== canvas && !event.ctrlKey) return;
      event.preventDefault();
      zoomBy(Math.exp(-0.0015 * event.deltaY));
    },
    { passive: false },
  );
  const keys = {
    ArrowLeft: () => turnBy(-0.1, 0),
    ArrowRight: () => turnBy(0.1, 0),
    ArrowUp: () => turnBy(0, -0.1),
    ArrowDown: () => turnBy(0, 0.1),
    "+": () => zoomBy(1.15),
    "=": () => zoomBy(1.15),
    "-": () => zoomBy(1 / 1.15),
    " ": () => motion.play(!motion.isPlaying),
  };
  canvas.addEventListener("keydown", (event) => {
    if (!keys[event.key]) return;
    event.preventDefault();
    keys[event.key]();
  });
}
