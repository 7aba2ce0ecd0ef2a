// The page of a comparison that goes on: follows the events of the server, and shows each later version of the report in place.
(() => {
  const element = (id) => document.getElementById(id);
  const token = new URLSearchParams(location.search).get("token") ?? "";
  const address = (path) => `${path}?${new URLSearchParams({ token })}`;

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

  function describe() {
    if (!status) return;
    const { doing, share, remaining, is_stopping, closing, version } = status;
    const isOver = closing !== null;
    const stopping = version > 0 ? "Ends after this checkpoint" : "Ends after the first checkpoint";
    element("doing").textContent = isOver ? "Done" : is_stopping ? stopping : doing;
    const isTimed = !isOver && !isLost && remaining !== null;
    element("remaining").textContent = isTimed ? `about ${duration(Math.max(remaining - (performance.now() - came) / 1000, 0))} left` : "";
    element("share").value = isOver ? 1 : share;
    const words = isLost ? "The comparison is not to be reached; it may be over. This page tries again." : closing ?? "";
    // A change is read aloud.
    if (element("closing").textContent !== words) element("closing").textContent = words;
    element("end").hidden = isOver;
    element("end").disabled = is_stopping || isLost;
  }

  // Versions of the report.

  // What is replaced by its later state, by its id. The viewer of pictures is made anew and keeps what is shown in it.
  const PARTS = ["conclusions", "about", "methods", "measures", "plots", "provenance"];
  // The latest version that was taken from the server, and the page of one that is waiting to be shown.
  let taken = Number(element("live").dataset.version);
  let later = null;
  let isBusy = false;

  async function take() {
    if (isBusy || !status || status.version <= taken) return;
    // The first report is a page of its own.
    if (!window.pt) return location.reload();
    isBusy = true;
    let text = null;
    try {
      const answer = await fetch(address("/"));
      if (answer.ok) text = await answer.text();
    } catch {
      // The next event tries again.
    }
    isBusy = false;
    if (text === null) return;
    later = new DOMParser().parseFromString(text, "text/html");
    taken = Number(later.getElementById("live").dataset.version);
    show();
    // A version that came meanwhile: after the last event no other one asks for it.
    take();
  }

  // Whoever drags, reads the help or a command, or has selected text is not disturbed, and sees it after that.
  const isHeld = () => document.querySelector("#viewer:active, dialog[open], details[open]") !== null || !getSelection().isCollapsed;

  function show() {
    if (!later || isHeld()) return;
    const page = later;
    later = null;
    const before = window.pt.close();
    const focusable = () => [...document.querySelectorAll("#viewer button, #viewer select, #viewer input, #viewer [tabindex]")];
    const focus = focusable().indexOf(document.activeElement);
    for (const id of PARTS) element(id).replaceWith(page.getElementById(id));
    // The viewer itself stays, as it may fill the screen.
    element("viewer").replaceChildren(...page.getElementById("viewer").childNodes);
    window.pt = viewer(JSON.parse(page.getElementById("pictures").textContent), before);
    if (focus >= 0) focusable()[focus]?.focus({ preventScroll: true });
  }

  setInterval(() => {
    describe();
    show();
  }, 1000);

  const events = new EventSource(address("events"));
  events.onmessage = ({ data }) => {
    [status, came, isLost] = [JSON.parse(data), performance.now(), false];
    describe();
    take();
    if (status.closing !== null) events.close();
  };
  events.onerror = () => {
    isLost = true;
    describe();
  };

  element("end").addEventListener("click", () => fetch(address("stop"), { method: "POST" }).catch(() => {}));
})();
