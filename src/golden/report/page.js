// The viewer of pictures and their list. Everything shown is in the element `data`: see `Report` in `mod.rs`.
(() => {
  const BLINK = 500; // How long each picture is shown while blinking (ms): slow enough to be harmless.
  const STOPS = [1 / 8, 1 / 4, 1 / 2, 1, 2, 3, 4, 6, 8, 12, 16]; // Zooms (device pixels for each pixel of the picture).
  const SQUARES = 2; // Above this zoom pixels are shown as squares.
  const DOUBLING = 240; // Movement of the wheel that doubles the zoom (px).
  const TALLEST = 0.74; // Greatest height of a picture as a part of the window's.
  const STEP = 60; // How far a key moves a picture (px).
  const QUIET = 300; // After so long without a change (ms), it is announced and put into the address.
  const MODES = ["side", "slider", "blink"];
  const TITLES = { expected: "Expected", difference: "Difference", actual: "Actual" };

  const report = JSON.parse(the("data").textContent);
  const { pictures } = report;
  const failures = pictures.filter(({ passes }) => !passes).length;
  const [stage, divider, list] = [the("stage"), the("divider"), the("list")];
  const reduced = matchMedia("(prefers-reduced-motion: reduce)");

  let at = 0; // The index of the picture shown.
  let onlyFailed = false;
  let mode = "side";
  let timer = null; // Of the blinking, while it runs.
  let zoom = null; // Device pixels for each pixel of the picture; `null`: as large as fits.
  let centre = [0, 0]; // What is in the middle of the views, in pixels of the picture.

  // The viewer: three figures side by side or over each other (`page.css`).

  /** Why a side has no picture. */
  function absent({ verdict, expected, actual }, side) {
    if (verdict === "missing" && side === "actual") return "missing";
    if (verdict === "extra" && side === "expected") return "missing: nothing like it was expected";
    if (side === "difference") {
      if (verdict === "identical") return "no difference: every pixel is equal";
      if (["missing", "extra", "unreadable"].includes(verdict)) return "nothing to compare";
      if (expected && actual) return "no difference can be drawn: sizes or channels differ";
    }
    return verdict === "unreadable" ? "unreadable, or not embedded in this report" : "not embedded in this report";
  }

  function fillStage() {
    const picture = pictures[at];
    for (const [side, title] of Object.entries(TITLES)) {
      const [view, size] = ["view", "size"].map((part) => stage.querySelector(`.${side} .${part}`));
      const words = document.createElement("p");
      words.textContent = picture[side] === null ? absent(picture, side) : "this picture cannot be shown";
      size.textContent = "";
      view.replaceChildren(words);
      if (picture[side] === null) continue;
      const image = new Image();
      image.alt = `${title}: ${picture.name}`;
      image.decoding = "sync"; // Otherwise the view is blank between two pictures.
      image.addEventListener("load", () => {
        size.textContent = image.isConnected ? `${image.naturalWidth} × ${image.naturalHeight}` : size.textContent;
        layout();
      });
      image.addEventListener("error", () => image.replaceWith(words));
      image.src = picture[side];
      view.replaceChildren(image);
    }
    const distances = the("distances");
    distances.querySelector("img")?.remove();
    distances.hidden = picture.distances === null;
    if (picture.distances !== null) {
      const map = new Image();
      map.alt = `Distance of each node from its expected place: ${picture.name}`;
      map.src = picture.distances;
      distances.append(map);
    }
    the("difference-key").hidden = picture.difference === null || picture.verdict === "identical";
    layout();
  }

  /** Width and height that hold all three pictures (px of the pictures). */
  function extent() {
    const images = [...stage.querySelectorAll("img")].filter(({ naturalWidth }) => naturalWidth > 0);
    if (images.length === 0) return pictures[at].size ?? [640, 360];
    return ["naturalWidth", "naturalHeight"].map((side) => Math.max(...images.map((image) => image[side])));
  }

  /** The zoom at which a picture fits; a whole number if its pixels are shown as squares. */
  function fitting() {
    const [width, height] = extent();
    const room = mode === "side" ? stage.querySelector("figure").clientWidth : the("viewer").clientWidth;
    const scale = Math.min(room / width, Math.max(160, innerHeight * TALLEST) / height) * devicePixelRatio;
    return scale > SQUARES ? Math.floor(scale) : scale;
  }

  function layout() {
    const [size, fit] = [extent(), fitting()];
    const shown = zoom ?? fit;
    // A picture larger than its view covers all of it, and a smaller one stands in its middle.
    centre = size.map((side, axis) => {
      const half = (side * fit) / shown / 2;
      return shown <= fit ? side / 2 : clamp(centre[axis], half, side - half);
    });
    // On whole pixels of the device, so that one to one is not blurred.
    const [x, y] = size.map((side, axis) => Math.round((side * fit) / 2 - centre[axis] * shown) / devicePixelRatio);
    const styles = {
      "--width": `${(size[0] * fit) / devicePixelRatio}px`,
      "--height": `${(size[1] * fit) / devicePixelRatio}px`,
      "--place": `translate(${x}px, ${y}px) scale(${shown / devicePixelRatio})`,
      "--divider": `${divider.value}%`,
    };
    for (const [name, value] of Object.entries(styles)) the("viewer").style.setProperty(name, value);
    stage.classList.toggle("zoomed", shown > fit);
    stage.classList.toggle("pixelated", shown > SQUARES);
    the("scale").textContent = `${Number((shown * 100).toPrecision(3))} %`;
    the("fit").setAttribute("aria-pressed", zoom === null);
    the("exact").setAttribute("aria-pressed", shown === 1);
    the("smaller").disabled = shown <= Math.min(fit, 1);
    the("larger").disabled = shown >= Math.max(fit, STOPS.at(-1));
  }

  /** Sets the zoom; what is at a place of the views (px from their middle) stays there. */
  function zoomTo(wanted, place = [0, 0]) {
    const fit = fitting();
    const after = clamp(wanted, Math.min(fit, 1), Math.max(fit, STOPS.at(-1)));
    const change = devicePixelRatio / (zoom ?? fit) - devicePixelRatio / after;
    centre = centre.map((middle, axis) => middle + place[axis] * change);
    zoom = after === fit ? null : after;
    layout();
  }

  function zoomBy(direction) {
    const fit = fitting();
    const stops = [...STOPS, fit].sort((a, b) => direction * (a - b));
    zoomTo(stops.find((stop) => direction * (stop - (zoom ?? fit)) > 0) ?? stops.at(-1));
  }

  function pan(x, y) {
    const scale = (zoom ?? fitting()) / devicePixelRatio;
    centre = [centre[0] + x / scale, centre[1] + y / scale];
    layout();
  }

  let drag = null; // The last place of a pointer that drags, and whether it drags the divider.
  function dragTo({ clientX: x, clientY: y }) {
    const { left, width } = stage.getBoundingClientRect();
    if (drag.slides) divider.value = (100 * (x - left)) / width;
    else pan(drag.x - x, drag.y - y);
    layout();
    Object.assign(drag, { x, y });
  }
  stage.addEventListener("pointerdown", (event) => {
    const isZoomed = stage.classList.contains("zoomed");
    const slides = mode === "slider" && (!isZoomed || event.target.id === "bar");
    if (event.button !== 0 || !event.target.closest(".view, #bar") || !(slides || isZoomed)) return;
    event.preventDefault();
    stage.setPointerCapture(event.pointerId);
    drag = { slides, x: event.clientX, y: event.clientY };
    dragTo(event);
  });
  stage.addEventListener("pointermove", (event) => drag && dragTo(event));
  stage.addEventListener("lostpointercapture", () => {
    drag = null;
  });
  // Two fingers on a touchpad give the same events as the wheel with Ctrl.
  const onWheel = (event) => {
    if (!event.ctrlKey || !event.target.closest(".view, #bar")) return;
    event.preventDefault();
    const view = event.target.closest(".view") ?? stage.querySelector(".view");
    const { left, top, width, height } = view.getBoundingClientRect();
    const place = [event.clientX - left - width / 2, event.clientY - top - height / 2];
    zoomTo((zoom ?? fitting()) * 2 ** (-event.deltaY / DOUBLING), place);
  };
  stage.addEventListener("wheel", onWheel, { passive: false });

  function setMode(wanted) {
    mode = wanted;
    for (const button of the("modes").children) button.setAttribute("aria-pressed", button.dataset.mode === mode);
    Object.assign(stage.dataset, { mode, shown: "expected" });
    the("blinking").hidden = mode !== "blink";
    divider.hidden = mode !== "slider";
    blink(mode === "blink" && !reduced.matches);
    layout();
    settle();
  }

  function blink(runs) {
    clearInterval(timer);
    timer = runs ? setInterval(swap, BLINK) : null;
    the("run").textContent = runs ? "Stop" : "Start";
  }

  function swap() {
    stage.dataset.shown = stage.dataset.shown === "expected" ? "actual" : "expected";
  }

  function swapByHand() {
    blink(false);
    swap();
    settle(`${TITLES[stage.dataset.shown]} is shown`);
  }

  // The list.

  const isListed = ({ passes }) => !onlyFailed || !passes;
  const hasFailed = ({ passes }) => !passes;

  function filter(only) {
    onlyFailed = only && failures > 0;
    the("only").setAttribute("aria-pressed", onlyFailed);
    const listed = pictures.map((_, index) => index).filter((index) => isListed(pictures[index]));
    const option = (index) => {
      const { name, passes, verdict } = pictures[index];
      const words = passes ? `✓ ${name}` : `✕ ${name}  ·  ${verdict.replace("same state, ", "")}`;
      return Object.assign(new Option(words, index), { className: passes ? "" : "failed" });
    };
    list.replaceChildren(...listed.map(option));
    go(listed.find((index) => index >= at) ?? listed.at(-1));
  }

  /** The index of the next picture in a direction for which a condition holds, if there is one. */
  function next(direction, holds) {
    let index = at + direction;
    while (index in pictures && !holds(pictures[index])) index += direction;
    return index in pictures ? index : null;
  }

  const step = (direction, holds) => go(next(direction, holds) ?? at);

  function go(index) {
    at = index;
    const { name, frame, time, size, passes, words } = pictures[at];
    const facts = [
      pictures.length > 1 && `${grouped(at + 1)} of ${grouped(pictures.length)}`,
      frame !== null && `frame ${frame}`,
      time !== null && clock(time),
      size && size.join(" × "),
    ];
    the("name").textContent = name;
    the("facts").textContent = facts.filter(Boolean).join("  ·  ");
    the("words").className = passes ? "" : "failed";
    the("words").textContent = `${passes ? "✓" : "✕"} ${words}`;
    the("previous").disabled = next(-1, isListed) === null;
    the("next").disabled = next(1, isListed) === null;
    the("previous-failure").disabled = next(-1, hasFailed) === null;
    the("next-failure").disabled = next(1, hasFailed) === null;
    list.value = at;
    markInStrip(at);
    fillStage();
    settle(`${name}: ${words}`);
  }

  // The address leads to a picture and a mode.

  let [settling, announced] = [null, ""];
  /** Announces words to screen readers and updates the address, once nothing else changes: a held key changes much. */
  function settle(words = announced) {
    announced = words;
    clearTimeout(settling);
    settling = setTimeout(() => {
      if (the("announced").textContent !== words) the("announced").textContent = words;
      const hash = `#picture=${encodeURIComponent(pictures[at]?.name)}&mode=${mode}`;
      if (pictures.length > 0 && location.hash !== hash) history.replaceState(null, "", hash);
    }, QUIET);
  }

  function recall() {
    const wanted = new URLSearchParams(location.hash.slice(1).replaceAll("+", "%2B"));
    const index = pictures.findIndex(({ name }) => name === wanted.get("picture"));
    if (MODES.includes(wanted.get("mode"))) setMode(wanted.get("mode"));
    if (index >= 0) go(index);
  }

  // Keys; a button does what the key in its `data-key` does.

  const KEYS = {
    ArrowLeft: () => step(-1, isListed),
    ArrowRight: () => step(1, isListed),
    "[": () => step(-1, hasFailed),
    "]": () => step(1, hasFailed),
    f: () => filter(!onlyFailed),
    1: () => setMode("side"),
    2: () => setMode("slider"),
    3: () => setMode("blink"),
    v: () => setMode(MODES[(MODES.indexOf(mode) + 1) % MODES.length]),
    b: () => (mode === "blink" ? blink(timer === null) : setMode("blink")),
    " ": () => (mode === "blink" ? swapByHand() : false),
    "+": () => zoomBy(1),
    "=": () => zoomBy(1),
    "-": () => zoomBy(-1),
    "−": () => zoomBy(-1),
    0: () => zoomTo(fitting()),
    z: () => zoomTo(zoom === 1 ? fitting() : 1),
    w: () => pan(0, -STEP),
    a: () => pan(-STEP, 0),
    s: () => pan(0, STEP),
    d: () => pan(STEP, 0),
    "?": () => the("keys").showModal(),
  };

  /** Whether the element with the focus uses a key itself. */
  function isTaken({ key, target }) {
    if (/^(ArrowUp|ArrowDown|Page|Home|End)/.test(key)) return target.matches("input, select, #command");
    if (key.startsWith("Arrow")) return target.matches("input, #command");
    // Space presses buttons; on the one that chose blinking it goes on to the other picture.
    return key === " " && target.matches("summary, button") && !(mode === "blink" && target.dataset.mode === mode);
  }

  document.addEventListener("keydown", (event) => {
    const isCommand = (event.ctrlKey || event.altKey || event.metaKey) && !event.getModifierState("AltGraph");
    if (isCommand || the("keys").open || isTaken(event)) return;
    const key = (event.shiftKey && { ArrowLeft: "[", ArrowRight: "]" }[event.key]) || event.key;
    const action = Object.hasOwn(KEYS, key) ? KEYS[key] : KEYS[key.toLowerCase()];
    if (pictures.length === 0 && key !== "?") return;
    if (action && action() !== false) event.preventDefault();
  });
  document.addEventListener("click", ({ target }) => KEYS[target.closest("[data-key]")?.dataset.key]?.());

  the("copy")?.toggleAttribute("hidden", false);
  the("copy")?.addEventListener("click", async ({ target: button }) => {
    const copied = navigator.clipboard?.writeText(the("command").textContent) ?? Promise.reject();
    // A page from a file may not be allowed to copy.
    const select = () => getSelection().selectAllChildren(the("command"));
    button.textContent = await copied.then(() => "Copied", () => (select(), "Selected"));
    settle(button.textContent);
    setTimeout(() => {
      button.textContent = "Copy";
    }, 2000);
  });

  const markInStrip = showSequence(report, go);
  document.querySelector("main").hidden = pictures.length === 0 && the("sequence").hidden;
  the("viewer").hidden = pictures.length === 0;
  for (const id of ["pictures", "around"]) the(id).hidden = pictures.length < 2;
  for (const id of ["only", "failures"]) the(id).hidden = failures === 0;
  const outcome = failures === 0 ? ", all as expected" : `, ${grouped(failures)} failed`;
  the("count").textContent = plural(pictures.length, "picture") + outcome;
  if (pictures.length === 0) return;
  list.size = clamp(pictures.length, 2, 12);
  setMode(mode);
  at = report.first;
  filter(false);
  recall();
  addEventListener("hashchange", recall);
  addEventListener("resize", layout);
  divider.addEventListener("input", layout);
  list.addEventListener("change", () => go(Number(list.value)));
  reduced.addEventListener("change", () => reduced.matches && blink(false));
})();
