"use strict";
// The page round a shader. Nothing is drawn that does not change the picture: a picture follows a change, and
// pictures follow each other only while time runs.
(() => {
  const element = (id) => document.getElementById(id);
  const canvas = element("picture");
  const params = JSON.parse(element("params").textContent);
  const fragment = element("fragment").textContent;
  const vertex = `#version 300 es
void main() {
    gl_Position = vec4(vec2(gl_VertexID & 1, gl_VertexID >> 1) * 4.0 - 1.0, 0.0, 1.0);
}
`;

  // What the picture is drawn with.
  const values = new Map(params.list.map((param) => [param.name, param.value]));
  const view = { turn: 0, tilt: 0, zoom: 1 };
  const mouse = { x: 0.5, y: 0.5 };
  const clock = { time: 0, runs: !matchMedia("(prefers-reduced-motion: reduce)").matches, last: null };

  // ---- The shader ----

  let gl = null;
  let program = null;
  let places = {};

  /** Compiles without holding the page up, where the browser can. */
  async function build() {
    program = null;
    const made = gl.createProgram();
    const shaders = [[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, fragment]].map(([kind, text]) => {
      const shader = gl.createShader(kind);
      gl.shaderSource(shader, text);
      gl.compileShader(shader);
      gl.attachShader(made, shader);
      return shader;
    });
    gl.linkProgram(made);
    const parallel = gl.getExtension("KHR_parallel_shader_compile");
    while (parallel && !gl.getProgramParameter(made, parallel.COMPLETION_STATUS_KHR)) {
      await new Promise((done) => setTimeout(done, 15));
    }
    if (gl.isContextLost()) return;
    if (!gl.getProgramParameter(made, gl.LINK_STATUS)) {
      const logs = shaders.map((shader) => gl.getShaderInfoLog(shader)).concat(gl.getProgramInfoLog(made));
      throw new Error(logs.filter((log) => log).join("\n") || "the driver does not say why");
    }
    for (const shader of shaders) gl.deleteShader(shader);
    const place = (name) => gl.getUniformLocation(made, name);
    places = { resolution: place("u_resolution"), time: place("u_time"), mouse: place("u_mouse"), orbit: place("u_orbit") };
    places.params = params.list.map((param) => place(param.uniform));
    program = made;
  }

  function draw() {
    if (!program || gl.isContextLost()) return;
    fit();
    gl.viewport(0, 0, canvas.width, canvas.height);
    gl.useProgram(program);
    gl.uniform2f(places.resolution, canvas.width, canvas.height);
    gl.uniform1f(places.time, clock.time);
    gl.uniform2f(places.mouse, mouse.x, mouse.y);
    gl.uniform3f(places.orbit, view.turn, view.tilt, view.zoom);
    params.list.forEach((param, i) => {
      const value = values.get(param.name);
      if (param.kind === "color") gl.uniform3fv(places.params[i], value);
      else if (param.kind === "bool") gl.uniform1i(places.params[i], value ? 1 : 0);
      else gl.uniform1f(places.params[i], value);
    });
    gl.drawArrays(gl.TRIANGLES, 0, 3);
  }

  // ---- The size of the picture, which follows the window and what the device can do ----

  /** Pixels of the picture for each of the screen, along a side. */
  const LEAST = 0.2;
  /** Milliseconds that a picture may take while something moves; below the second, more is tried. */
  const SLOW = 60, FAST = 25;
  /** Milliseconds that a picture may take when everything is at rest. */
  const PATIENCE = 600;
  const quality = { moving: 0.5, still: 0.5, quick: 0, tooSlow: Infinity, tooSlowAt: 0, fixed: null, milliseconds: null };
  let atRest = false;

  function fit() {
    const scale = Math.min(devicePixelRatio || 1, 2) * (atRest ? quality.still : quality.moving);
    const side = (length) => Math.max(1, Math.round(length * scale));
    const [width, height] = quality.fixed || [side(canvas.clientWidth), side(canvas.clientHeight)];
    if (canvas.width !== width) canvas.width = width;
    if (canvas.height !== height) canvas.height = height;
  }

  /** Learns from the time that a picture took at a scale. */
  function learn(milliseconds, scale, now) {
    quality.milliseconds = milliseconds;
    const affordable = (limit) => scale * Math.sqrt(limit / Math.max(milliseconds, 1));
    quality.still = Math.max(LEAST, Math.min(1, affordable(PATIENCE)));
    if (milliseconds > SLOW) {
      quality.quick = 0;
      quality.tooSlow = scale;
      quality.tooSlowAt = now;
      quality.moving = Math.min(quality.moving, Math.max(LEAST, scale * 0.5, affordable(SLOW * 0.7)));
    } else if (milliseconds < FAST && ++quality.quick >= (quality.tooSlow === Infinity ? 3 : 30)) {
      quality.quick = 0;
      const more = Math.min(1, quality.moving * 1.25);
      // What was too slow is tried again after a while: something else may have kept the device busy.
      if (more < quality.tooSlow || now - quality.tooSlowAt > 20000) quality.moving = more;
    }
  }

  // ---- When to draw ----

  let changed = false;
  let scheduled = false;
  let drawing = null;
  let lastChange = 0;

  function change() {
    changed = true;
    atRest = false;
    lastChange = performance.now();
    schedule();
  }

  function schedule() {
    if (!scheduled && program) {
      scheduled = true;
      requestAnimationFrame(tick);
    }
  }

  const runs = () => clock.runs && places.time !== null && program !== null;

  function tick(now) {
    scheduled = false;
    if (!program || gl.isContextLost()) return;
    if (drawing && gl.getSyncParameter(drawing.fence, gl.SYNC_STATUS) !== gl.SIGNALED) {
      // The device is still busy with the picture before this one.
      schedule();
      return;
    }
    if (drawing) {
      gl.deleteSync(drawing.fence);
      if (!quality.fixed) learn(performance.now() - drawing.start, drawing.scale, now);
      drawing = null;
    }
    if (runs()) {
      if (clock.last !== null) clock.time += Math.max(0, now - clock.last) / 1000;
      clock.last = now;
      changed = true;
      atRest = false;
    } else if (!changed && !atRest && !quality.fixed && quality.still > quality.moving && pointers.size === 0) {
      // At rest there is time for a finer picture.
      if (performance.now() - lastChange < 150) return schedule();
      atRest = true;
      changed = true;
    }
    if (changed) {
      changed = false;
      drawing = { start: performance.now(), scale: atRest ? quality.still : quality.moving };
      draw();
      drawing.fence = gl.fenceSync(gl.SYNC_GPU_COMMANDS_COMPLETE, 0);
      gl.flush();
    } else if (atRest || quality.fixed || quality.still <= quality.moving) {
      return;
    }
    schedule();
  }

  // ---- Time ----

  function setRuns(on) {
    clock.runs = on;
    clock.last = null;
    element("pause").textContent = on ? "Pause" : "Play";
    change();
  }

  function restart() {
    clock.time = 0;
    clock.last = null;
    change();
  }

  // A page that nobody sees is not drawn, and its time stands still.
  document.addEventListener("visibilitychange", () => { clock.last = null; });

  // ---- Looking around ----

  const pointers = new Map();

  function turn(right, up) {
    view.turn = (view.turn - right) % (2 * Math.PI);
    view.tilt = Math.min(Math.max(view.tilt + up, params.tilt[0]), params.tilt[1]);
    change();
  }

  function zoom(factor) {
    view.zoom = Math.min(Math.max(view.zoom * factor, 0.02), 50);
    change();
  }

  function resetView() {
    Object.assign(view, { turn: 0, tilt: 0, zoom: 1 });
    change();
  }

  function point(event) {
    const box = canvas.getBoundingClientRect();
    mouse.x = Math.min(Math.max((event.clientX - box.left) / box.width, 0), 1);
    mouse.y = Math.min(Math.max(1 - (event.clientY - box.top) / box.height, 0), 1);
    if (places.mouse) change();
  }

  /** The middle of the pointers that are down, and how far apart two of them are. */
  function grip() {
    const all = [...pointers.values()];
    const x = all.reduce((sum, p) => sum + p.x, 0) / all.length;
    const y = all.reduce((sum, p) => sum + p.y, 0) / all.length;
    return { x, y, span: all.length > 1 ? Math.hypot(all[0].x - all[1].x, all[0].y - all[1].y) : 0 };
  }

  canvas.addEventListener("pointerdown", (event) => {
    if (event.pointerType === "mouse" && event.button !== 0) return;
    canvas.setPointerCapture(event.pointerId);
    pointers.set(event.pointerId, { x: event.clientX, y: event.clientY });
    // A finger does not hover: where it comes down is where it points.
    if (event.pointerType !== "mouse") point(event);
  });
  canvas.addEventListener("pointermove", (event) => {
    const pointer = pointers.get(event.pointerId);
    if (!pointer || !places.orbit) {
      point(event);
      return;
    }
    const before = grip();
    pointer.x = event.clientX;
    pointer.y = event.clientY;
    const after = grip();
    const angle = Math.PI / Math.max(canvas.clientHeight, 1);
    turn((after.x - before.x) * angle, (after.y - before.y) * angle);
    if (before.span > 0 && after.span > 0) zoom(before.span / after.span);
  });
  for (const end of ["pointerup", "pointercancel", "lostpointercapture"]) {
    canvas.addEventListener(end, (event) => {
      if (pointers.delete(event.pointerId)) change();
    });
  }
  canvas.addEventListener("wheel", (event) => {
    if (!places.orbit) return;
    event.preventDefault();
    const pixels = event.deltaY * [1, 16, canvas.clientHeight][event.deltaMode];
    // A pinch on a touch pad comes as a wheel with the control key, in small steps.
    zoom(Math.exp(Math.min(Math.max(pixels, -400), 400) * (event.ctrlKey ? 0.01 : 0.0015)));
  }, { passive: false });
  canvas.addEventListener("dblclick", resetView);

  // ---- Keys and buttons ----

  const steps = {
    ArrowLeft: () => turn(-0.1, 0), ArrowRight: () => turn(0.1, 0),
    ArrowUp: () => turn(0, -0.1), ArrowDown: () => turn(0, 0.1),
    "+": () => zoom(1 / 1.1), "=": () => zoom(1 / 1.1), "-": () => zoom(1.1), Home: resetView,
  };
  const keys = {
    " ": () => setRuns(!clock.runs), r: restart, f: fullScreen,
    h: () => { element("panel").hidden = !element("panel").hidden; },
  };

  addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const target = event.target;
    const key = event.key.length === 1 ? event.key.toLowerCase() : event.key;
    // A button that has the focus is pressed by space, and a slider is moved by the arrows.
    const own = target.closest("button, summary, input[type=checkbox], input[type=color]") && key === " ";
    const action = own ? null : keys[key] || (target.closest("#panel") ? null : steps[key]);
    if (!action) return;
    event.preventDefault();
    action();
  });

  function fullScreen() {
    const done = document.fullscreenElement
      ? document.exitFullscreen()
      : document.documentElement.requestFullscreen?.();
    done?.catch(() => {});
  }

  element("pause").addEventListener("click", () => setRuns(!clock.runs));
  element("restart").addEventListener("click", restart);
  element("reset").addEventListener("click", resetView);
  element("full").addEventListener("click", fullScreen);
  element("defaults").addEventListener("click", () => {
    for (const param of params.list) set(param.name, param.value);
  });

  // ---- Params ----

  const encode = (c) => (c <= 0.0031308 ? 12.92 * c : 1.055 * c ** (1 / 2.4) - 0.055);
  const decode = (c) => (c <= 0.04045 ? c / 12.92 : ((c + 0.055) / 1.055) ** 2.4);
  const hex = (color) => "#" + color.map((c) =>
    Math.round(255 * encode(Math.min(Math.max(c, 0), 1))).toString(16).padStart(2, "0")).join("");
  const unhex = (text) => [1, 3, 5].map((i) => decode(parseInt(text.slice(i, i + 2), 16) / 255));

  const kinds = {
    float: {
      type: "range",
      show: (input, value) => { input.value = value; },
      read: (input) => input.valueAsNumber,
      say: (value) => String(Number(value.toPrecision(4))),
    },
    bool: {
      type: "checkbox",
      show: (input, value) => { input.checked = value; },
      read: (input) => input.checked,
    },
    color: {
      type: "color",
      show: (input, value) => { input.value = hex(value); },
      read: (input) => unhex(input.value),
    },
  };
  const shows = new Map();

  for (const param of params.list) {
    const kind = kinds[param.kind];
    const input = Object.assign(document.createElement("input"), { type: kind.type, id: `param-${param.name}` });
    if (param.kind === "float") {
      const width = param.high - param.low;
      Object.assign(input, { min: param.low, max: param.high, step: width > 0 ? width / 500 : "any" });
    }
    const label = Object.assign(document.createElement("label"), { htmlFor: input.id, textContent: param.name });
    const row = Object.assign(document.createElement("div"), { className: "row" });
    row.append(label);
    const said = kind.say ? row.appendChild(document.createElement("output")) : null;
    said?.setAttribute("for", input.id);
    row.append(input);
    element("form").append(row);
    const say = (value) => { if (said) said.textContent = kind.say(value); };
    shows.set(param.name, (value) => { kind.show(input, value); say(value); });
    input.addEventListener("input", () => {
      values.set(param.name, kind.read(input));
      say(values.get(param.name));
      change();
    });
    shows.get(param.name)(param.value);
  }
  element("form").addEventListener("submit", (event) => event.preventDefault());
  element("sliders").hidden = params.list.length === 0;

  function set(name, value) {
    const show = shows.get(name);
    if (!show) throw new Error(`there is no param ${name}`);
    values.set(name, value);
    show(value);
    change();
  }

  // ---- Beginning, and what may go wrong ----

  function fail(title, text) {
    element("status").hidden = true;
    element("error-title").textContent = title;
    element("error-text").textContent = text;
    element("error").hidden = false;
  }

  let isReady, isNotReady;
  const ready = new Promise((resolve, reject) => { [isReady, isNotReady] = [resolve, reject]; });
  ready.catch(() => {});

  async function begin() {
    element("status").textContent = "Compiling the shader …";
    element("status").hidden = false;
    try {
      await build();
    } catch (error) {
      fail("The graphics driver does not take this shader.", error.message);
      isNotReady(error);
    }
    if (!program) return;
    element("status").hidden = true;
    element("error").hidden = true;
    element("panel").hidden = false;
    for (const id of ["pause", "restart"]) element(id).hidden = places.time === null;
    element("reset").hidden = places.orbit === null;
    element("full").hidden = !document.fullscreenEnabled;
    canvas.classList.toggle("turns", places.orbit !== null);
    setRuns(clock.runs);
    isReady();
  }

  canvas.addEventListener("webglcontextlost", (event) => {
    event.preventDefault();
    program = null;
    drawing = null;
    // It may have been lost because a picture took too long.
    quality.moving = Math.max(LEAST, quality.moving / 2);
    quality.still = quality.moving;
    fail("The graphics device was lost.", "The picture comes back when the browser has it again.");
  });
  canvas.addEventListener("webglcontextrestored", begin);

  function start() {
    gl = canvas.getContext("webgl2", { alpha: false, antialias: false, depth: false, stencil: false, powerPreference: "high-performance" });
    if (!gl) {
      const text = "This browser or its graphics driver does not offer WebGL2, which the picture needs.";
      fail("There is no WebGL2.", text);
      isNotReady(new Error(text));
      return;
    }
    new ResizeObserver(change).observe(canvas);
    begin();
  }

  /** Draws, and gives the picture as RGBA bytes, row by row from the top. */
  function pixels() {
    draw();
    const { width, height } = canvas;
    const row = width * 4;
    const upward = new Uint8Array(row * height);
    gl.readPixels(0, 0, width, height, gl.RGBA, gl.UNSIGNED_BYTE, upward);
    const out = new Uint8Array(upward.length);
    for (let y = 0; y < height; y++) out.set(upward.subarray(y * row, (y + 1) * row), (height - 1 - y) * row);
    return out;
  }

  window.sdfc = {
    ready,
    draw,
    pixels,
    set,
    time: (seconds) => { clock.time = seconds; setRuns(false); },
    size: (width, height) => { quality.fixed = width > 0 && height > 0 ? [width, height] : null; change(); },
    mouse: (x, y) => { Object.assign(mouse, { x, y }); change(); },
    orbit: (turn, tilt, zoom) => { Object.assign(view, { turn, tilt, zoom }); change(); },
    state: () => ({
      time: clock.time, runs: runs(), mouse: { ...mouse }, orbit: { ...view }, params: Object.fromEntries(values),
      width: canvas.width, height: canvas.height, milliseconds: quality.milliseconds, lost: gl?.isContextLost() ?? true,
    }),
  };
  start();
})();
