"use strict";
// The image viewer of pages. Pictures are half floats under a power of two; all that is shown is computed from them.
// A page has the controls that it wants: one that is missing is made, and nobody sees it.
//
// before: state of a viewer that this one replaces, as its `close` returned it
function viewer(data, before = {}) {
  const element = (id) => document.getElementById(id) ?? document.createElement("div");
  const [width, height] = data.size;
  const [canvas, stage, handle] = ["canvas", "stage", "handle"].map(element);
  const context = canvas.getContext("2d");

  // Half floats: what each of the 65536 patterns means.
  const HALF = Float32Array.from({ length: 65536 }, (_, bits) => {
    const [sign, exponent, fraction] = [bits & 0x8000 ? -1 : 1, (bits >> 10) & 31, bits & 1023];
    if (exponent === 31) return fraction ? NaN : sign * Infinity;
    return exponent ? sign * (1 + fraction / 1024) * 2 ** (exponent - 15) : sign * fraction * 2 ** -24;
  });

  // A plane of a picture: text in base64, or the patterns themselves.
  function decode(plane) {
    if (!plane) return null;
    if (plane.bits) return { bits: plane.bits, unit: 2 ** plane.exponent };
    const bytes = atob(plane.data);
    const bits = new Uint16Array(bytes.length / 2);
    for (let i = 0; i < bits.length; i++) bits[i] = bytes.charCodeAt(2 * i) | (bytes.charCodeAt(2 * i + 1) << 8);
    return { bits, unit: 2 ** plane.exponent };
  }

  const value = (plane, i) => (plane.values ? plane.values[i] : HALF[plane.bits[i]] * plane.unit);

  // The reference plus a difference in floats of eight bits, which are the upper half of a half float.
  function addDifference(reference, { data: text, exponent }) {
    const bytes = atob(text);
    const unit = 2 ** exponent;
    return { values: Float32Array.from({ length: bytes.length }, (_, i) => value(reference, i) + HALF[bytes.charCodeAt(i) << 8] * unit) };
  }

  // FLIP from its logarithm in bytes.
  const FLIP = Float32Array.from({ length: 256 }, (_, byte) => (byte ? 10 ** (data.decades * (byte / 255 - 1)) : 0));
  const decodeFlip = (text) => text && Float32Array.from(atob(text), (byte) => FLIP[byte.charCodeAt(0)]);

  const view = (planes) => planes && { color: decode(planes.color), error: decode(planes.error), flip: decodeFlip(planes.flip) };
  // Pictures of checkpoints are decoded when they are first seen.
  const lazily = (make) => { let made; return () => (made ??= make()); };
  let reference = decode(data.pictures[0].mean.color);
  const pictures = data.pictures.map((picture) => {
    const mean = view(picture.mean);
    const render = view(picture.render) || mean;
    const early = ({ difference, flip }) => () => ({ color: addDifference(reference, difference), error: null, flip: decodeFlip(flip) });
    const checkpoints = picture.checkpoints.map((one) => ({ ...one, view: one.difference ? lazily(early(one)) : () => render }));
    return { name: picture.name, color: picture.color, views: { mean, render }, checkpoints };
  });

  // A picture alone is compared with nothing, and its error bars are relative to itself.
  const isAlone = pictures.length === 1;
  // A comparison that goes on measures FLIP at its end.
  const hasFlip = pictures.some(({ views }) => views.mean.flip);

  let mean, floor;
  function measure() {
    mean = reference.bits.reduce((sum, _, i) => sum + value(reference, i), 0) / reference.bits.length;
    floor = data.epsilon * mean * mean;
  }
  measure();

  const start = { shown: Math.min(1, pictures.length - 1), other: 0, split: null, view: "render", by: "seconds", stop: Infinity, overlay: "picture", exposure: 0, curve: "sRGB", zoom: null, x: width / 2, y: height / 2 };
  const { budget, ...kept } = before;
  const state = { ...start, probe: [width >> 1, height >> 1], pinned: false, ...kept };

  // Which checkpoint is shown. Times and errors to choose from are apart as neighbouring checkpoints are: a factor of 2 in time, √2 in
  // error. Each method shows the checkpoint that is nearest on a logarithmic scale.

  const all = pictures.flatMap((picture) => picture.checkpoints);
  const STOPS = { seconds: stops(all.map((one) => one.seconds), 2).reverse(), error: stops(all.map((one) => one.error), Math.SQRT2) };

  // Values from the largest down to the smallest, by a factor.
  function stops(values, factor) {
    const known = values.filter((v) => v > 0);
    if (!known.length) return [];
    const [low, high] = [Math.min(...known), Math.max(...known)];
    const count = Math.ceil(Math.log(high / low) / Math.log(factor) - 0.25);
    return Array.from({ length: count + 1 }, (_, i) => high / factor ** i);
  }

  const lastStop = () => Math.max(STOPS[state.by].length - 1, 0);
  const stopIndex = () => Math.min(state.stop, lastStop());
  const wanted = () => STOPS[state.by][stopIndex()];
  // Index of the stop that is nearest to a time or an error.
  function nearest(by, value) {
    const distance = (at) => Math.abs(Math.log(STOPS[by][at] / value));
    return STOPS[by].reduce((best, _, at) => (distance(at) < distance(best) ? at : best), 0);
  }
  if (budget) state.stop = nearest(state.by, budget);

  function chosen(index) {
    const { checkpoints } = pictures[index];
    if (state.view === "mean" || !checkpoints.length) return null;
    // An error below that of the reference is the smallest of all.
    const distance = (one) => Math.abs(Math.log((one[state.by] ?? STOPS.error.at(-1) / Math.SQRT2) / wanted())) || 0;
    return checkpoints.reduce((best, one) => (distance(one) <= distance(best) ? one : best));
  }

  // Says where a picture is far from what was chosen: by more than the gap between checkpoints.
  function remark(one) {
    if (!one) return "";
    const ratio = one[state.by] / wanted();
    if (state.by === "seconds") return ratio > 2 ? "its first picture" : ratio < 0.5 ? "its last picture" : "";
    return ratio > 1.5 ? "gets no closer" : one.error !== null && ratio < 1 / 1.5 ? "its first picture" : "";
  }

  // What a pixel is.

  const viewOf = (index, which = state.view) => (which === "render" && chosen(index)?.view()) || pictures[index].views[which];

  function colors(index, pixel, which) {
    const plane = viewOf(index, which).color;
    return [0, 1, 2].map((c) => value(plane, 3 * pixel + c));
  }

  // √ of the mean over the colours of (x − r)²/(r² + ε): its mean square over the picture is relMSE.
  function error(index, pixel) {
    const plane = viewOf(index).color;
    let sum = 0;
    for (let c = 3 * pixel; c < 3 * pixel + 3; c++) {
      const r = value(reference, c);
      sum += (value(plane, c) - r) ** 2 / (r * r + floor);
    }
    return Math.sqrt(sum / 3);
  }

  const deviation = (index, pixel, which) => {
    const plane = viewOf(index, which).error;
    return plane ? value(plane, pixel) : null;
  };

  // The standard error on the same scale as the error.
  function bar(index, pixel) {
    let sum = 0;
    for (let c = 3 * pixel; c < 3 * pixel + 3; c++) sum += 1 / (value(reference, c) ** 2 + floor);
    return deviation(index, pixel) * Math.sqrt(sum / 3);
  }

  const visible = (index, pixel) => (index ? viewOf(index).flip?.[pixel] ?? null : 0);

  // From numbers to what a screen shows.

  const srgb = (x) => (x <= 0.0031308 ? 12.92 * x : 1.055 * x ** (1 / 2.4) - 0.055);
  const CURVES = {
    sRGB: srgb,
    Filmic: (x) => { const v = Math.min(Math.max(x, 0), 1e9); return srgb((v * (2.51 * v + 0.03)) / (v * (2.43 * v + 0.59) + 0.14)); },
  };

  function toneTable(unit) {
    const gain = unit * 2 ** state.exposure;
    const curve = CURVES[state.curve];
    return Uint8ClampedArray.from(HALF, (half) => { const v = curve(half * gain); return Number.isNaN(v) ? 0 : 255 * v; });
  }

  // Viridis, from 0.1 % to 100 %.
  const VIRIDIS = ["440154", "482878", "3e4989", "31688e", "26828e", "1f9e89", "35b779", "6ece58", "b5de2b", "fde725"].map((hex) => [0, 2, 4].map((i) => parseInt(hex.slice(i, i + 2), 16)));
  function falseColor(relative) {
    const at = Math.min(Math.max((Math.log10(relative) + 3) / 3, 0), 1) * (VIRIDIS.length - 1) || 0;
    const i = Math.min(Math.floor(at), VIRIDIS.length - 2);
    return VIRIDIS[i].map((low, c) => low + (at - i) * (VIRIDIS[i + 1][c] - low));
  }

  const isMissing = (index) => (state.overlay === "bar" && !viewOf(index).error) || (state.overlay === "flip" && index > 0 && !viewOf(index).flip);

  const bitmaps = new Map();
  function bitmap(index) {
    const key = [index, state.view, chosen(index)?.seconds, state.overlay, state.exposure, state.curve].join();
    if (bitmaps.has(key)) return bitmaps.get(key);
    if (bitmaps.size > 3 * pictures.length + 4) bitmaps.clear();
    const surface = Object.assign(document.createElement("canvas"), { width, height });
    const target = surface.getContext("2d");
    const image = target.createImageData(width, height);
    fill(image.data, index);
    target.putImageData(image, 0, 0);
    bitmaps.set(key, surface);
    return surface;
  }

  function fill(out, index) {
    const { color } = viewOf(index);
    if (state.overlay === "picture" && color.values) {
      const gain = 2 ** state.exposure;
      const curve = CURVES[state.curve];
      for (let i = 0, o = 0; i < color.values.length; i += 3, o += 4) {
        for (let c = 0; c < 3; c++) out[o + c] = 255 * (curve(color.values[i + c] * gain) || 0);
        out[o + 3] = 255;
      }
      return;
    }
    if (state.overlay === "picture") {
      const tone = toneTable(color.unit);
      for (let i = 0, o = 0; i < color.bits.length; i += 3, o += 4) {
        out[o] = tone[color.bits[i]];
        out[o + 1] = tone[color.bits[i + 1]];
        out[o + 2] = tone[color.bits[i + 2]];
        out[o + 3] = 255;
      }
      return;
    }
    if (isMissing(index)) return;
    const relative = { error, bar, flip: visible }[state.overlay];
    for (let pixel = 0, o = 0; pixel < width * height; pixel++, o += 4) {
      [out[o], out[o + 1], out[o + 2]] = falseColor(relative(index, pixel));
      out[o + 3] = 255;
    }
  }

  // Where a pixel is. Zoom is in CSS pixels per pixel of the picture, (x, y) is the middle of the stage.

  const fitting = () => Math.min(canvas.clientWidth / width, canvas.clientHeight / height) || 1;
  const zoom = () => state.zoom ?? fitting();
  const toStage = (x, y) => [canvas.clientWidth / 2 + (x - state.x) * zoom(), canvas.clientHeight / 2 + (y - state.y) * zoom()];
  const toPicture = (x, y) => [state.x + (x - canvas.clientWidth / 2) / zoom(), state.y + (y - canvas.clientHeight / 2) / zoom()];
  const clamp = (v, low, high) => Math.min(Math.max(v, low), high);
  const onStage = (event) => { const box = canvas.getBoundingClientRect(); return [event.clientX - box.left, event.clientY - box.top]; };

  let waiting = false;
  function redraw() {
    if (waiting) return;
    waiting = true;
    requestAnimationFrame(() => { waiting = false; draw(); });
  }

  // Makes a canvas as fine as the screen. A picture is drawn on it with so many CSS pixels per pixel.
  function prepare(canvas, context, zoom) {
    const density = window.devicePixelRatio || 1;
    const [w, h] = [canvas.clientWidth, canvas.clientHeight];
    if (canvas.width !== Math.round(w * density) || canvas.height !== Math.round(h * density)) {
      canvas.width = Math.round(w * density);
      canvas.height = Math.round(h * density);
    }
    context.setTransform(density, 0, 0, density, 0, 0);
    context.clearRect(0, 0, w, h);
    context.imageSmoothingEnabled = zoom * density < 1;
    context.imageSmoothingQuality = "high";
    return [w, h];
  }

  // All pictures side by side: each shows the part that the large one shows.
  const crops = [];
  function drawCrops() {
    const scale = (surface) => surface.clientWidth / (canvas.clientWidth || 1);
    crops.forEach(({ surface }, index) => {
      const size = zoom() * scale(surface);
      const target = surface.getContext("2d");
      const [w, h] = prepare(surface, target, size);
      target.drawImage(bitmap(index), w / 2 - state.x * size, h / 2 - state.y * size, width * size, height * size);
    });
  }

  function draw() {
    const [w, h] = prepare(canvas, context, zoom());
    drawCrops();
    const [x, y] = toStage(0, 0);
    const paint = (index, from, to) => {
      context.save();
      context.beginPath();
      context.rect(from, 0, to - from, h);
      context.clip();
      context.drawImage(bitmap(index), x, y, width * zoom(), height * zoom());
      context.restore();
    };
    const edge = state.split === null ? w : state.split * w;
    paint(state.shown, 0, edge);
    if (state.split !== null) paint(state.other, edge, w);
    if (zoom() >= 6 || state.pinned) outline();
  }

  // Around the pixel that is read.
  function outline() {
    const [x, y] = toStage(...state.probe);
    const size = Math.max(zoom(), 7);
    const shift = (zoom() - size) / 2;
    for (const [color, wide] of [["#000", 3], ["#fff", 1]]) {
      context.strokeStyle = color;
      context.lineWidth = wide;
      context.strokeRect(x + shift - 1, y + shift - 1, size + 2, size + 2);
    }
  }

  // Words around the picture.

  const number = (v, digits = 4) => {
    if (!Number.isFinite(v)) return String(v);
    const size = Math.abs(v);
    return size !== 0 && (size < 1e-4 || size >= 9999.5) ? v.toExponential(2) : size >= 10 ** digits - 0.5 ? String(Math.round(v)) : v.toPrecision(digits);
  };
  const perCent = (v) => (v === null ? "–" : `${number(100 * v, 2)} %`);

  function describe() {
    const lack = state.overlay === "flip" ? ": has no FLIP" : ": knows no error bars";
    const title = (index) => pictures[index].name + (isMissing(index) ? lack : "");
    element("left-name").textContent = title(state.shown);
    element("right-name").textContent = title(state.other);
    element("left-facts").textContent = facts(state.shown);
    element("right-facts").textContent = facts(state.other);
    describeStop();
    crops.forEach(({ button, line, note }, index) => {
      line.textContent = facts(index);
      note.textContent = remark(chosen(index));
      button.setAttribute("aria-pressed", index === state.shown);
    });
    const isSplit = state.split !== null;
    for (const id of ["right", "handle"]) element(id).hidden = !isSplit;
    handle.style.left = `${100 * (state.split ?? 0.5)}%`;
    handle.setAttribute("aria-valuenow", Math.round(100 * (state.split ?? 0.5)));
    handle.setAttribute("aria-valuetext", `${pictures[state.shown].name} left, ${pictures[state.other].name} right`);
    const press = (button, on) => button.setAttribute("aria-pressed", on);
    document.querySelectorAll("#names button").forEach((button, i) => press(button, i === state.shown));
    document.querySelectorAll("[data-overlay]").forEach((button) => press(button, button.dataset.overlay === state.overlay));
    document.querySelectorAll("[data-view]").forEach((button) => press(button, button.dataset.view === state.view));
    press(element("split"), isSplit);
    element("other").value = state.other;
    element("exposure").value = `${state.exposure > 0 ? "+" : state.exposure < 0 ? "−" : ""}${Math.abs(state.exposure)} EV`;
    element("curve").textContent = state.curve;
    element("zoom").value = `${Math.round(100 * zoom())} %`;
    element("scale").hidden = state.overlay === "picture";
    const TITLES = { bar: "standard error, relative", error: "error against the reference, relative", flip: "FLIP; 100 %: green against blue" };
    element("scale-title").textContent = TITLES[state.overlay] ?? "";
    element("measure").textContent = state.overlay === "flip" ? "FLIP" : "Error";
    canvas.style.touchAction = zoom() > 1.01 * fitting() ? "none" : "pan-y";
    readout();
  }

  // Samples, seconds and error of the picture that is shown: `64 spp · 0.98 s · 3.1 %`.
  function facts(index) {
    const one = chosen(index);
    if (!one) return index && state.view === "mean" ? "mean of all renders" : "";
    const samples = one.samples === null ? "" : `${one.samples} spp · `;
    return `${samples}${duration(one.seconds)} · ${one.error === null ? "below the reference" : perCent(one.error)}`;
  }

  function duration(seconds) {
    if (seconds < 0.9995) return `${number(1000 * seconds, 2)} ms`;
    if (seconds < 59.95) return `${number(seconds, 2)} s`;
    const [big, unit, small, rest] = seconds < 3599.5 ? [60, "min", 1, "s"] : [3600, "h", 60, "min"];
    const whole = Math.round(seconds / small);
    return `${Math.floor((whole * small) / big)} ${unit} ${String(whole % (big / small)).padStart(2, "0")} ${rest}`;
  }

  // The chosen time or error, also in words for those who do not see the pictures.
  function describeStop() {
    const [slider, value] = [element("stop"), wanted()];
    if (value === undefined) return;
    slider.max = lastStop();
    slider.value = stopIndex();
    const text = state.view === "mean" ? "all samples" : state.by === "seconds" ? duration(value) : perCent(value);
    element("stop-value").value = text;
    slider.setAttribute("aria-label", state.by === "seconds" ? "Time of rendering" : "Relative error");
    const each = pictures.map(({ name }, i) => (chosen(i) ? `${name} ${facts(i)}` : null)).filter(Boolean);
    slider.setAttribute("aria-valuetext", [text, ...each].join("; "));
    document.querySelectorAll("[data-by]").forEach((button) => button.setAttribute("aria-pressed", state.view === "render" && button.dataset.by === state.by));
  }

  function readout() {
    const [x, y] = state.probe;
    element("status").textContent = `Pixel ${x + data.origin[0]}, ${y + data.origin[1]}`;
    const pixel = y * width + x;
    [...element("values").rows].forEach((row, i) => {
      row.classList.toggle("shown", i === state.shown);
      const known = deviation(i, pixel) !== null;
      const against = () => perCent(state.overlay === "flip" ? visible(i, pixel) : error(i, pixel));
      const last = isAlone ? perCent(known ? bar(i, pixel) : null) : i ? against() : "";
      const cells = [...colors(i, pixel).map((v) => number(v)), known ? number(deviation(i, pixel), 2) : "–", last];
      cells.forEach((text, c) => { row.cells[c + 1].textContent = text; });
    });
  }

  function set(change) {
    Object.assign(state, change);
    state.exposure = clamp(state.exposure, -40, 40);
    describe();
    redraw();
  }

  // What one can do.

  const probe = (x, y, pinned) => set({ probe: [clamp(Math.floor(x), 0, width - 1), clamp(Math.floor(y), 0, height - 1)], pinned });
  const show = (index) => index < pictures.length && set({ shown: index });
  const toggle = (name, on, off) => set({ [name]: state[name] === on ? off : on });
  const split = (at) => set({ split: clamp(at, 0, 1) });
  const swap = () => set({ shown: state.other, other: state.shown });
  // One render has checkpoints; the mean of all has none.
  const choose = (by, stop) => set({ by, stop: clamp(stop, 0, STOPS[by].length - 1), view: "render" });
  // The other scale begins where the picture shown is.
  function chooseBy(by) {
    const value = chosen(state.shown)?.[by];
    const isLast = stopIndex() === lastStop() || !(value > 0);
    choose(by, isLast ? Infinity : nearest(by, value));
  }
  const flipCurve = () => toggle("curve", "Filmic", "sRGB");

  function zoomBy(factor, x = canvas.clientWidth / 2, y = canvas.clientHeight / 2) {
    const [px, py] = toPicture(x, y);
    const next = clamp(zoom() * factor, Math.min(fitting(), 1) / 2, 64);
    // What is under the pointer stays there.
    move({ zoom: next, x: px - (x - canvas.clientWidth / 2) / next, y: py - (y - canvas.clientHeight / 2) / next });
  }

  const move = ({ x, y, ...rest }) => set({ x: clamp(x, 0, width), y: clamp(y, 0, height), ...rest });
  const pan = (dx, dy) => move({ x: state.x - dx / zoom(), y: state.y - dy / zoom() });

  // The mean of the reference at middle grey, 18 %, to half a stop.
  const fitExposure = () => set({ exposure: mean > 0 ? Math.round(2 * Math.log2(0.18 / mean)) / 2 : 0 });

  function fullScreen() {
    if (document.fullscreenElement) document.exitFullscreen();
    else element("viewer").requestFullscreen?.().catch(() => {});
  }

  function reset() {
    set({ ...start, shown: state.shown, other: state.other, pinned: false });
  }

  // Mouse and fingers.

  const pointers = new Map();
  let travelled = 0;
  canvas.addEventListener("pointerdown", (event) => {
    canvas.setPointerCapture(event.pointerId);
    pointers.set(event.pointerId, onStage(event));
    if (pointers.size === 1) travelled = 0;
  });
  canvas.addEventListener("pointermove", (event) => {
    const now = onStage(event);
    const before = pointers.get(event.pointerId);
    if (!before) {
      if (event.pointerType === "mouse" && !state.pinned) probe(...toPicture(...now), false);
      return;
    }
    if (pointers.size === 2) {
      const other = [...pointers].find(([id]) => id !== event.pointerId)[1];
      const distance = ([x, y]) => Math.hypot(x - other[0], y - other[1]) || 1;
      zoomBy(distance(now) / distance(before), (now[0] + other[0]) / 2, (now[1] + other[1]) / 2);
      pan((now[0] - before[0]) / 2, (now[1] - before[1]) / 2);
      travelled = Infinity;
    } else {
      travelled += Math.hypot(now[0] - before[0], now[1] - before[1]);
      // A click that trembles is a click.
      if (travelled > 4) pan(now[0] - before[0], now[1] - before[1]);
    }
    pointers.set(event.pointerId, now);
  });
  const lift = (event) => {
    const at = pointers.get(event.pointerId);
    pointers.delete(event.pointerId);
    return at;
  };
  canvas.addEventListener("pointerup", (event) => {
    const at = lift(event);
    if (!at || travelled > 4) return;
    const [x, y] = toPicture(...at).map(Math.floor);
    const again = state.pinned && x === state.probe[0] && y === state.probe[1];
    probe(x, y, !again);
  });
  canvas.addEventListener("pointercancel", lift);
  function onWheel(event, at) {
    event.preventDefault();
    const lines = event.deltaMode === 1 ? 33 : 1;
    zoomBy(Math.exp(-0.002 * clamp(event.deltaY * lines, -400, 400)), ...at);
  }
  canvas.addEventListener("wheel", (event) => onWheel(event, onStage(event)), { passive: false });

  handle.addEventListener("pointerdown", (event) => handle.setPointerCapture(event.pointerId));
  handle.addEventListener("pointermove", (event) => {
    if (handle.hasPointerCapture(event.pointerId)) split(onStage(event)[0] / canvas.clientWidth);
  });

  // Keys.

  const KEYS = {
    e: () => set({ exposure: state.exposure + 0.5 }),
    E: () => set({ exposure: state.exposure - 0.5 }),
    a: fitExposure,
    t: flipCurve,
    x: swap,
    ",": () => STOPS[state.by].length && choose(state.by, stopIndex() - 1),
    ".": () => STOPS[state.by].length && choose(state.by, stopIndex() + 1),
    q: () => all.length && chooseBy(state.by === "seconds" ? "error" : "seconds"),
    p: () => toggle("overlay", "flip", "picture"),
    d: () => toggle("overlay", "error", "picture"),
    b: () => toggle("overlay", "bar", "picture"),
    m: () => toggle("view", "mean", "render"),
    w: () => toggle("split", null, 0.5),
    "[": () => split((state.split ?? 0.5) - 0.02),
    "]": () => split((state.split ?? 0.5) + 0.02),
    "+": () => zoomBy(1.25),
    "=": () => zoomBy(1.25),
    "-": () => zoomBy(0.8),
    f: fullScreen,
    r: reset,
    "?": () => element("help").showModal(),
  };
  if (isAlone) for (const key of "x,.qpdmw[]") delete KEYS[key];
  if (!hasFlip) delete KEYS.p;
  document.querySelectorAll("[data-overlay=flip]").forEach((button) => (button.disabled = !hasFlip));
  const ARROWS = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };

  const listening = new AbortController();
  document.addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey || event.target.closest("select, dialog[open]")) return;
    const arrow = ARROWS[event.key];
    const digit = /^Digit(\d)$/.exec(event.code);
    let act = KEYS[event.key];
    if (/^\d$/.test(event.key)) act = () => show(Number(event.key));
    else if (event.shiftKey && digit && !isAlone) act = () => Number(digit[1]) < pictures.length && set({ other: Number(digit[1]), split: state.split ?? 0.5 });
    else if (arrow && event.target === handle) act = arrow[0] ? () => split(state.split + 0.02 * arrow[0]) : null;
    else if (arrow && event.shiftKey && stage.contains(event.target)) act = () => probe(state.probe[0] + arrow[0], state.probe[1] + arrow[1], true);
    else if (arrow && stage.contains(event.target)) act = () => pan(-60 * arrow[0], -60 * arrow[1]);
    if (!act) return;
    event.preventDefault();
    act();
  }, { signal: listening.signal });

  // Buttons.

  const add = (parent, tag, properties) => parent.appendChild(Object.assign(document.createElement(tag), properties));
  const swatch = (parent, color) => add(parent, "i", { className: color === null ? "swatch" : `swatch f-m${color}` });
  pictures.forEach(({ name, color }, i) => {
    const button = add(element("names"), "button", { onclick: () => show(i) });
    if (i < 10) {
      add(button, "kbd", { textContent: i });
      button.setAttribute("aria-keyshortcuts", i);
    }
    button.append(name);
    add(element("other"), "option", { value: i, textContent: name });
    const row = add(element("values"), "tr", {});
    const head = add(row, "th", { scope: "row" });
    swatch(head, color);
    head.append(name);
    for (let c = 0; c < 5; c++) add(row, "td", {});
    const crop = add(element("crops"), "button", { className: "crop", onclick: () => show(i) });
    const surface = add(crop, "canvas", {});
    surface.setAttribute("aria-hidden", "true");
    const title = add(crop, "b", {});
    swatch(title, color);
    title.append(name);
    crops.push({ button: crop, surface, line: add(crop, "small", {}), note: add(crop, "em", {}) });
    surface.addEventListener("wheel", (event) => {
      // The point under the pointer is the same point of the large picture.
      const box = surface.getBoundingClientRect();
      const scale = canvas.clientWidth / box.width;
      onWheel(event, [(event.clientX - box.left) * scale, (event.clientY - box.top) * scale]);
    }, { passive: false });
  });
  element("budget").hidden = !STOPS.seconds.length;
  element("stop").addEventListener("input", (event) => choose(state.by, Number(event.target.value)));
  document.querySelectorAll("[data-by]").forEach((button) => button.addEventListener("click", () => chooseBy(button.dataset.by)));
  const click = (id, act) => element(id).addEventListener("click", act);
  document.querySelectorAll("[data-copy]").forEach((button) => button.addEventListener("click", () => {
    const code = button.previousElementSibling;
    getSelection().selectAllChildren(code);
    const done = (text) => { button.textContent = text; setTimeout(() => { button.textContent = "Copy"; }, 1500); };
    // Where a browser refuses, the command is selected all the same.
    if (!navigator.clipboard) done("Selected");
    else navigator.clipboard.writeText(code.textContent).then(() => done("Copied"), () => done("Selected"));
  }));
  click("split", KEYS.w);
  click("swap", swap);
  click("darker", KEYS.E);
  click("brighter", KEYS.e);
  click("curve", flipCurve);
  click("out", KEYS["-"]);
  click("in", KEYS["+"]);
  click("reset", reset);
  click("help-button", KEYS["?"]);
  element("other").addEventListener("change", (event) => set({ other: Number(event.target.value) }));
  document.querySelectorAll("[data-overlay]").forEach((button) => button.addEventListener("click", () => set({ overlay: button.dataset.overlay })));
  document.querySelectorAll("[data-view]").forEach((button) => button.addEventListener("click", () => set({ view: button.dataset.view })));
  stage.style.setProperty("--shape", `${width} / ${height}`);
  // The small pictures have the shape of the large one.
  const resized = () => {
    element("crops").style.setProperty("--shape", `${canvas.clientWidth} / ${canvas.clientHeight}`);
    describe();
    redraw();
  };
  const resizing = new ResizeObserver(resized);
  resizing.observe(canvas);
  describe();

  return {
    // Shows a later state of the only picture.
    replace: (planes) => {
      const later = view(planes);
      pictures[0].views = { mean: later, render: later };
      reference = later.color;
      measure();
      bitmaps.clear();
      describe();
      redraw();
    },
    // Ends the viewer, and returns its state for one that replaces it: the time or error that is chosen, as the scale may have other ends then,
    // or none where it is the last one.
    close: () => {
      listening.abort();
      resizing.disconnect();
      return { ...state, stop: Infinity, budget: stopIndex() === lastStop() ? null : wanted() };
    },
    // Reads pixel (x, y) of the whole picture.
    choose: (x, y) => probe(x - data.origin[0], y - data.origin[1], true),
    // Pixel of the whole picture that is read.
    chosen: () => [state.probe[0] + data.origin[0], state.probe[1] + data.origin[1]],
    // For tests and consoles.
    state: () => ({ ...state, zoom: zoom(), stop: stopIndex(), stops: STOPS[state.by], samples: pictures.map((_, i) => chosen(i)?.samples ?? null) }),
    // FLIP of pixel (x, y) of the whole picture, for every picture.
    flip: (x, y) => pictures.map((_, i) => visible(i, (y - data.origin[1]) * width + x - data.origin[0])),
    // Pixel (x, y) of the whole picture: of every picture its colours and standard error.
    read: (x, y, which = state.view) => {
      const pixel = (y - data.origin[1]) * width + x - data.origin[0];
      return pictures.map(({ name }, i) => ({ name, rgb: colors(i, pixel, which), deviation: deviation(i, pixel, which) }));
    },
    // The middle of pixel (x, y) in the window.
    locate: (x, y) => {
      const box = canvas.getBoundingClientRect();
      const [px, py] = toStage(x - data.origin[0] + 0.5, y - data.origin[1] + 0.5);
      return [box.left + px, box.top + py];
    },
  };
}
