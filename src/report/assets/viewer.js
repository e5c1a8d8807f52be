// Draws the outer surface, moved by a mode's shape: position + amplitude Re(shape exp(i phase)), in WebGL 2.

const VERTEX = `#version 300 es
in vec3 place, re, im;
uniform vec3 origin, centre;
uniform float size, amplitude, phase, radius, zoom, aspect, full;
uniform vec2 pan;
uniform mat3 turn;
out vec3 eye;
out float moved;
void main() {
  vec3 u = re * cos(phase) - im * sin(phase);
  vec3 q = turn * (origin + size * place + amplitude * u - centre);
  float far = 6.0 * radius, near = 2.0 * radius, lens = 4.4 * zoom * min(1.0, aspect);
  q += vec3(pan * radius, -4.0 * radius);
  eye = q;
  moved = sqrt(dot(re, re) + dot(im, im)) / full;
  gl_Position = vec4(lens * q.x / aspect, lens * q.y, ((far + near) * q.z + 2.0 * far * near) / (near - far), -q.z);
}`;

const FRAGMENT = `#version 300 es
precision highp float;
in vec3 eye;
in float moved;
uniform vec3 scale[10];
uniform vec4 own;
uniform bool isLine, bySize;
out vec4 colour;
void main() {
  if (isLine) { colour = own; return; }
  float at = clamp(moved, 0.0, 1.0) * 9.0;
  int i = min(int(at), 8);
  vec3 base = bySize ? mix(scale[i], scale[i + 1], at - float(i)) : own.rgb;
  vec3 normal = normalize(cross(dFdx(eye), dFdy(eye)));
  vec3 light = normalize(vec3(0.25, 0.4, 1.0));
  colour = vec4(base * (0.45 + 0.62 * abs(dot(normal, light))), 1.0);
}`;

/** This share of the surface's nodes has colours of its own; what moves more, often one corner of a lining, is coloured like the largest of them. */
const COLOURED = 0.98;
/** So many times at most is a shape drawn larger for that. */
const ENLARGED = 2.5;

/** Edges sharper than this are drawn. */
const CREASE = Math.cos((32 * Math.PI) / 180);

class Viewer {
  constructor(canvas, surface) {
    this.canvas = canvas;
    this.gl = canvas.getContext("webgl2", { antialias: true, alpha: true, preserveDrawingBuffer: true });
    if (!this.gl) throw new Error("this browser has no WebGL 2");
    this.surface = surface;
    this.nodes = unpacked(surface.nodes, Uint16Array);
    this.triangles = unpacked(surface.triangles, Uint32Array);
    this.shown = surface.parts.map(() => true);
    Object.assign(this, { bySize: true, amplitude: 0.06, phase: 0, pan: [0, 0], zoom: 1, yaw: 0.55, pitch: 0.42 });
    this.measure();
    this.prepare();
  }

  /** Middle and radius of what is to be seen. */
  measure() {
    const { origin, size } = this.surface;
    const low = [Infinity, Infinity, Infinity];
    const high = [-Infinity, -Infinity, -Infinity];
    this.nodes.forEach((step, i) => {
      const x = origin[i % 3] + (size * step) / 65535;
      low[i % 3] = Math.min(low[i % 3], x);
      high[i % 3] = Math.max(high[i % 3], x);
    });
    this.centre = low.map((x, i) => 0.5 * (x + high[i]));
    this.radius = 0.5 * Math.hypot(...low.map((x, i) => high[i] - x));
  }

  prepare() {
    const gl = this.gl;
    this.program = gl.createProgram();
    for (const [kind, text] of [
      [gl.VERTEX_SHADER, VERTEX],
      [gl.FRAGMENT_SHADER, FRAGMENT],
    ]) {
      const shader = gl.createShader(kind);
      gl.shaderSource(shader, text);
      gl.compileShader(shader);
      if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS)) throw new Error(gl.getShaderInfoLog(shader));
      gl.attachShader(this.program, shader);
    }
    gl.linkProgram(this.program);
    gl.useProgram(this.program);
    this.uniform = (name) => gl.getUniformLocation(this.program, name);
    this.attribute("place", this.nodes, gl.UNSIGNED_SHORT, 6, 0);
    const edges = this.creases();
    this.buffers = [this.triangles, edges].map((indices) => {
      const buffer = gl.createBuffer();
      gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, buffer);
      gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, indices, gl.STATIC_DRAW);
      return buffer;
    });
    gl.enable(gl.DEPTH_TEST);
    gl.enable(gl.BLEND);
    gl.blendFuncSeparate(gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA, gl.ONE, gl.ONE_MINUS_SRC_ALPHA);
    gl.enable(gl.POLYGON_OFFSET_FILL);
    gl.polygonOffset(1, 1);
    gl.uniform3fv(
      this.uniform("scale"),
      VIRIDIS.flat().map((c) => c / 255),
    );
    gl.uniform3fv(this.uniform("origin"), this.surface.origin);
    gl.uniform3fv(this.uniform("centre"), this.centre);
    gl.uniform1f(this.uniform("size"), this.surface.size);
    gl.uniform1f(this.uniform("radius"), this.radius);
  }

  attribute(name, numbers, type, stride, offset) {
    const gl = this.gl;
    const buffer = gl.createBuffer();
    gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
    gl.bufferData(gl.ARRAY_BUFFER, numbers, gl.STATIC_DRAW);
    this.point(name, type, stride, offset);
    return buffer;
  }

  point(name, type, stride, offset) {
    const place = this.gl.getAttribLocation(this.program, name);
    this.gl.enableVertexAttribArray(place);
    this.gl.vertexAttribPointer(place, 3, type, true, stride, offset);
  }

  /** Takes another shape. */
  setShape(packed) {
    const gl = this.gl;
    const parts = unpacked(packed, Int16Array);
    const moved = Float32Array.from(
      { length: parts.length / 6 },
      (_, i) => Math.hypot(...parts.subarray(6 * i, 6 * i + 6)) / 32767,
    ).sort();
    this.full = moved[Math.floor(COLOURED * (moved.length - 1))] || 1;
    if (this.shape) gl.deleteBuffer(this.shape);
    this.shape = this.attribute("re", parts, gl.SHORT, 12, 0);
    this.point("im", gl.SHORT, 12, 6);
  }

  /** Edges at which a part ends or bends, part by part. */
  creases() {
    const { nodes, triangles } = this;
    const all = [];
    this.edgeRanges = this.surface.parts.map(([, first, count]) => {
      const begin = all.length;
      const open = new Map();
      for (let t = first; t < first + count; t++) {
        const corners = [0, 1, 2].map((k) => triangles[3 * t + k]);
        const normal = this.normal(corners);
        for (let k = 0; k < 3; k++) {
          const [a, b] = [corners[k], corners[(k + 1) % 3]];
          const key = Math.min(a, b) * nodes.length + Math.max(a, b);
          const other = open.get(key);
          if (!other) open.set(key, normal);
          else {
            open.delete(key);
            if (normal[0] * other[0] + normal[1] * other[1] + normal[2] * other[2] < CREASE) all.push(a, b);
          }
        }
      }
      for (const key of open.keys()) all.push(Math.floor(key / nodes.length), key % nodes.length);
      return [begin, all.length - begin];
    });
    return new Uint32Array(all);
  }

  normal(corners) {
    const [a, b, c] = corners.map((n) => [0, 1, 2].map((i) => this.nodes[3 * n + i]));
    const [u, v] = [b, c].map((p) => p.map((x, i) => x - a[i]));
    const n = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
    const length = Math.hypot(...n) || 1;
    return n.map((x) => x / length);
  }

  /** Columns of the rotation: first about the vertical, then about the horizontal of the screen. */
  turn() {
    const [cy, sy, cp, sp] = [Math.cos(this.yaw), Math.sin(this.yaw), Math.cos(this.pitch), Math.sin(this.pitch)];
    return [cy, sp * sy, -cp * sy, 0, cp, sp, sy, -sp * cy, cp * cy];
  }

  /** Draws at the canvas's size on screen, or at another. */
  draw(width = this.canvas.clientWidth, height = this.canvas.clientHeight, ratio = Math.min(devicePixelRatio, 2)) {
    const gl = this.gl;
    const [w, h] = [width, height].map((x) => Math.max(1, Math.round(x * ratio)));
    if (this.canvas.width !== w || this.canvas.height !== h) Object.assign(this.canvas, { width: w, height: h });
    gl.viewport(0, 0, w, h);
    gl.clearColor(0, 0, 0, 0);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    gl.uniformMatrix3fv(this.uniform("turn"), false, this.turn());
    gl.uniform2fv(this.uniform("pan"), this.pan);
    const amplitude = this.amplitude * 2 * this.radius * Math.min(1 / this.full, ENLARGED);
    const numbers = { aspect: w / h, zoom: this.zoom, phase: this.phase, amplitude, full: this.full };
    for (const [name, value] of Object.entries(numbers)) gl.uniform1f(this.uniform(name), value);
    gl.uniform1i(this.uniform("bySize"), this.bySize);
    this.drawParts(
      this.buffers[0],
      gl.TRIANGLES,
      (i) => this.surface.parts[i].slice(1).map((n) => 3 * n),
      (i) => rgbOf(PARTS[i % PARTS.length]),
    );
    this.drawParts(
      this.buffers[1],
      gl.LINES,
      (i) => this.edgeRanges[i],
      () => [0.1, 0.12, 0.15, 0.75],
    );
    gl.uniform1f(this.uniform("amplitude"), 0);
    this.drawParts(
      this.buffers[1],
      gl.LINES,
      (i) => this.edgeRanges[i],
      () => [0.3, 0.33, 0.38, 0.25],
    );
  }

  drawParts(buffer, kind, range, colour) {
    const gl = this.gl;
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, buffer);
    gl.uniform1i(this.uniform("isLine"), kind === gl.LINES);
    this.shown.forEach((isShown, i) => {
      const [first, count] = range(i);
      if (!isShown || !count) return;
      gl.uniform4fv(this.uniform("own"), colour(i));
      gl.drawElements(kind, count, gl.UNSIGNED_INT, 4 * first);
    });
  }

  /** A picture of a shape at rest in its largest deflection. */
  picture(packed, width, height) {
    const before = this.phase;
    this.phase = 0;
    this.setShape(packed);
    this.draw(width, height, 1.5);
    const picture = this.canvas.toDataURL("image/png");
    this.phase = before;
    return picture;
  }
}

const rgbOf = (hex) => [1, 3, 5].map((i) => parseInt(hex.slice(i, i + 2), 16) / 255).concat(1);
