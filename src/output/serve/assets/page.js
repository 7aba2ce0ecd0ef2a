// The page of a running render: follows the events of the server, takes its latest picture, and asks about pixels.
(() => {
  const element = (id) => document.getElementById(id);
  const { title, epsilon } = document.body.dataset;
  const token = new URLSearchParams(location.search).get("token") ?? "";
  const address = (path, parameters) => `${path}?${new URLSearchParams({ ...parameters, token })}`;

  // Words.

  const perCent = (v) => `${Number((100 * v).toPrecision(2))} %`;
  const count = (v) => String(Number(v.toFixed(v < 10 ? 1 : 0)));
  function duration(seconds) {
    if (seconds < 9.95) return `${seconds.toFixed(1)} s`;
    const whole = Math.round(seconds);
    if (whole < 60) return `${whole} s`;
    const [big, unit, small, rest] = whole < 3600 ? [60, "min", 1, "s"] : [3600, "h", 60, "min"];
    const steps = Math.round(seconds / small);
    return `${Math.floor((steps * small) / big)} ${unit} ${String(steps % (big / small)).padStart(2, "0")} ${rest}`;
  }

  // The state, and the time at which it came: between events the clock goes on.
  let status = null;
  let came = 0;
  // Whether the server does not answer.
  let isLost = false;
  // Pixel that was last asked about.
  let asked = null;

  function describe() {
    if (!status) return;
    const { progress, accuracy, worst, picture, closing, is_stopping } = status;
    const isOver = closing !== null;
    const since = isOver ? 0 : (performance.now() - came) / 1000;
    const phase = isOver ? "Rendered" : is_stopping ? "Ending" : "Rendering";
    element("phase").textContent = phase;
    document.title = isOver ? `${title}: done` : `${Math.floor(100 * progress.share)} % ${title}`;
    const left = progress.remaining === null ? "–" : duration(Math.max(progress.remaining - since, 0));
    element("remaining").textContent = isOver ? duration(progress.elapsed) : left;
    element("elapsed").textContent = isOver ? "in all" : `left, ${duration(progress.elapsed + since)} so far`;
    // Samples that the end cut short are not in the picture.
    element("samples").textContent = count(isOver && picture ? picture.samples : progress.samples);
    element("planned").textContent = progress.planned === null || isOver ? "samples per pixel" : `of ${count(progress.planned)} samples per pixel`;
    element("relative-error").textContent = accuracy.error ? perCent(accuracy.error[0]) : "–";
    const bounds = accuracy.error ? ` (${perCent(accuracy.error[1])} to ${perCent(accuracy.error[2])})` : "";
    const after = accuracy.error && !isOver ? ` after ${count(accuracy.samples)} samples` : "";
    element("interval").textContent = `relative error${bounds}${after}`;
    element("share").value = isOver ? 1 : progress.share;
    element("words").textContent = isLost ? "The render is not to be reached; it may be over. This page tries again." : isOver ? closing : accuracy.words;
    element("end").hidden = isOver;
    element("end").disabled = is_stopping || isLost;
    listWorst(worst);
  }
  setInterval(describe, 1000);

  // The list keeps its links, so that a click does not miss them.
  function listWorst(worst) {
    const list = element("worst");
    element("no-worst").hidden = worst.length > 0;
    while (list.children.length > worst.length) list.lastChild.remove();
    while (list.children.length < worst.length) {
      const link = document.createElement("a");
      link.append(document.createElement("span"), document.createElement("span"));
      list.appendChild(document.createElement("li")).appendChild(link);
    }
    worst.forEach(({ pixel, share }, i) => {
      const link = list.children[i].firstChild;
      link.href = `#${pixel}`;
      link.children[0].textContent = `Pixel ${pixel.join(", ")}`;
      link.children[1].textContent = `${perCent(share)} of the noise`;
      if (asked && asked.join() === pixel.join()) link.setAttribute("aria-current", "true");
      else link.removeAttribute("aria-current");
    });
  }

  // Pictures: one at a time, and always the latest.

  let shown = 0;
  let error = null;
  let isBusy = false;
  async function takePicture() {
    if (isBusy || !status.picture || status.picture.number === shown) return;
    isBusy = true;
    try {
      const answer = await fetch(address("picture", { since: shown }));
      if (answer.status === 200) show(await answer.arrayBuffer());
    } catch {
      // The next event tries again.
    }
    isBusy = false;
    if (status.picture.number > shown && status.closing !== null) takePicture();
  }

  function show(buffer) {
    const length = new DataView(buffer).getUint32(0, true);
    const header = JSON.parse(new TextDecoder().decode(new Uint8Array(buffer, 4, length)));
    const pixels = header.size[0] * header.size[1];
    const plane = (known, at, values) => known && { exponent: known.exponent, bits: new Uint16Array(buffer, 4 + length + 2 * at, values) };
    const planes = { color: plane(header.color, 0, 3 * pixels), error: plane(header.error, 3 * pixels, pixels) };
    shown = header.number;
    // Errors are made more seldom than pictures.
    planes.error ??= error;
    error = planes.error;
    if (window.pt) window.pt.replace(planes);
    else {
      element("viewer").hidden = false;
      element("waiting").hidden = true;
      const picture = { name: title, color: null, mean: planes, render: null, checkpoints: [] };
      window.pt = viewer({ size: header.size, origin: header.origin, epsilon: Number(epsilon), decades: 3, pictures: [picture] });
    }
  }

  // Events. The browser connects again by itself.

  const events = new EventSource(address("events"));
  events.onmessage = ({ data }) => {
    [status, came, isLost] = [JSON.parse(data), performance.now(), false];
    describe();
    takePicture();
    if (status.closing !== null) events.close();
  };
  events.onerror = () => {
    isLost = true;
    describe();
  };

  // Pixels.

  async function explain(x, y) {
    asked = [x, y];
    window.pt?.choose(x, y);
    element("explained").hidden = false;
    element("explained-title").textContent = `How pixel ${x}, ${y} came about`;
    const text = element("explanation");
    text.textContent = "Its samples are computed again …";
    describe();
    let found;
    try {
      found = await (await fetch(address("pixel", { x, y }))).text();
    } catch {
      found = "The render is not to be reached.";
    }
    if (asked[0] !== x || asked[1] !== y) return;
    text.textContent = found;
    element("explained").scrollIntoView({ block: "nearest" });
  }
  element("explain").addEventListener("click", () => window.pt && explain(...window.pt.chosen()));
  element("worst").addEventListener("click", (event) => {
    const link = event.target.closest("a");
    if (!link) return;
    event.preventDefault();
    explain(...link.hash.slice(1).split(",").map(Number));
  });

  // The end.

  element("end").addEventListener("click", () => {
    element("confirm").returnValue = "";
    element("confirm").showModal();
  });
  element("confirm").addEventListener("close", () => {
    if (element("confirm").returnValue === "end") fetch(address("stop"), { method: "POST" }).catch(() => {});
  });
})();
