// What the page does, but for its charts: those are in `strip.js`, which stands before this.
// All that is shown stands in the element `data`: see `Report` in `src/golden/report/mod.rs`.
(() => {
  /** How long each picture is shown while blinking (ms): two changes a second, well below what may harm. */
  const BLINK = 500;
  /** Zooms that buttons and keys stop at: device pixels for each pixel of the picture. */
  const STOPS = [1 / 8, 1 / 4, 1 / 2, 1, 2, 3, 4, 6, 8, 12, 16];
  /** From here on pixels are shown as squares. */
  const SQUARES = 2;
  /** The zoom doubles after so much turning of the wheel (px). */
  const DOUBLING = 240;
  /** A picture takes at most this part of the window's height. */
  const TALLEST = 0.74;
  /** How far a key moves a picture (px). */
  const STEP = 60;
  /** Words are told to screen readers once nothing follows for this time (ms): not for every picture that a held key passes. */
  const QUIET = 300;
  /** The button of the command says for this time (ms) what it has done. */
  const DONE = 2000;
  const MODES = ["side", "slider", "blink"];
  const TITLES = { expected: "Expected", difference: "Difference", actual: "Actual" };

  const report = JSON.parse(document.getElementById("data").textContent);
  const sheets = report.pictures;
  const failures = sheets.filter((sheet) => !sheet.passes).length;
  const [stage, divider, list] = [the("stage"), the("divider"), the("list")];
  const reduced = matchMedia("(prefers-reduced-motion: reduce)");

  let announcing = null;
  /** Tells those who do not see the page. */
  function announce(words) {
    clearTimeout(announcing);
    announcing = setTimeout(() => {
      the("announced").textContent = words;
    }, QUIET);
  }

  // The viewer: three figures, which stand side by side or lie over each other (`page.css`).

  let mode = "side";
  let timer = null; // Of the blinking, while it goes on.
  let zoom = null; // Device pixels for each pixel of the picture; `null`: as large as fits.
  let centre = [0, 0]; // What is in the middle of the views, in pixels of the picture.
  let at = 0; // The present picture.

  /** Why there is nothing to see on a side. */
  function absent(sheet, side) {
    const { verdict, expected, actual } = sheet;
    if (verdict === "missing" && side === "actual") return "missing";
    if (verdict === "extra" && side === "expected") return "missing: nothing like it was expected";
    if (side === "difference") {
      if (verdict === "identical") return "no difference: every pixel is equal";
      if (["missing", "extra", "unreadable"].includes(verdict)) return "nothing to compare";
      if (expected && actual) return "no difference can be drawn: sizes or opacities are not alike";
    }
    return verdict === "unreadable" ? "unreadable, or not embedded in this report" : "not embedded in this report";
  }

  function fillStage() {
    const sheet = sheets[at];
    for (const [side, title] of Object.entries(TITLES)) {
      const [view, size] = ["view", "size"].map((part) => stage.querySelector(`.${side} .${part}`));
      size.textContent = "";
      const words = document.createElement("p");
      words.textContent = sheet[side] === null ? absent(sheet, side) : "this picture cannot be shown";
      if (sheet[side] === null) {
        view.replaceChildren(words);
        continue;
      }
      const image = new Image();
      image.alt = `${title}: ${sheet.name}`;
      image.decoding = "sync"; // No blank between two pictures.
      image.addEventListener("load", () => {
        if (!image.isConnected) return; // Another picture has been chosen meanwhile.
        size.textContent = `${image.naturalWidth} × ${image.naturalHeight}`;
        layout();
      });
      image.addEventListener("error", () => image.replaceWith(words));
      image.src = sheet[side];
      view.replaceChildren(image);
    }
    the("difference-key").hidden = sheet.difference === null || sheet.verdict === "identical";
    layout();
  }

  /** Width and height that hold all three pictures (px of the pictures). */
  function extent() {
    const images = [...stage.querySelectorAll("img")].filter((image) => image.naturalWidth > 0);
    if (images.length === 0) return sheets[at].size ?? [640, 360];
    const largest = (side) => Math.max(...images.map((image) => image[side]));
    return [largest("naturalWidth"), largest("naturalHeight")];
  }

  /** The zoom at which a picture fits: enlarged so that pixels are squares, by a whole number. */
  function fitting() {
    const [width, height] = extent();
    const room = mode === "side" ? stage.querySelector("figure").clientWidth : the("viewer").clientWidth;
    const most = Math.max(160, innerHeight * TALLEST);
    const scale = Math.min(room / width, most / height) * devicePixelRatio;
    return scale > SQUARES ? Math.floor(scale) : scale;
  }

  function layout() {
    if (sheets.length === 0) return;
    const size = extent();
    const fit = fitting();
    const shown = zoom ?? fit;
    const scale = shown / devicePixelRatio;
    // A picture that is larger than its view covers all of it, and a smaller one stands in its middle.
    centre = size.map((side, axis) => {
      const half = (side * fit) / shown / 2;
      return shown <= fit ? side / 2 : clamp(centre[axis], half, side - half);
    });
    // On whole pixels of the device, so that one to one is not smeared.
    const [x, y] = size.map((side, axis) => Math.round((side * fit) / 2 - centre[axis] * shown) / devicePixelRatio);
    const { style } = the("viewer");
    style.setProperty("--width", `${(size[0] * fit) / devicePixelRatio}px`);
    style.setProperty("--height", `${(size[1] * fit) / devicePixelRatio}px`);
    style.setProperty("--place", `translate(${x}px, ${y}px) scale(${scale})`);
    style.setProperty("--divider", `${divider.value}%`);
    stage.classList.toggle("zoomed", shown > fit);
    stage.classList.toggle("pixelated", shown > SQUARES);
    the("scale").textContent = `${Number((shown * 100).toPrecision(3))} %`;
    the("fit").setAttribute("aria-pressed", String(zoom === null));
    the("exact").setAttribute("aria-pressed", String(shown === 1));
    the("smaller").disabled = shown <= Math.min(fit, 1);
    the("larger").disabled = shown >= Math.max(fit, STOPS.at(-1));
  }

  /** Sets the zoom so that what is at a place of the views (px from their middle) stays there. */
  function zoomTo(wanted, place = [0, 0]) {
    const fit = fitting();
    const before = zoom ?? fit;
    const after = clamp(wanted, Math.min(fit, 1), Math.max(fit, STOPS.at(-1)));
    const change = devicePixelRatio / before - devicePixelRatio / after;
    centre = centre.map((middle, axis) => middle + place[axis] * change);
    zoom = after === fit ? null : after;
    layout();
  }

  function zoomBy(direction) {
    const fit = fitting();
    const stops = [...STOPS, fit].sort((a, b) => direction * (a - b));
    const next = stops.find((stop) => direction * (stop - (zoom ?? fit)) > 0);
    if (next !== undefined) zoomTo(next);
  }

  function pan(x, y) {
    const scale = (zoom ?? fitting()) / devicePixelRatio;
    centre = [centre[0] + x / scale, centre[1] + y / scale];
    layout();
  }

  let drag = null; // What a pointer drags, the divider or the pictures, and where it is.
  function moveTo({ clientX: x, clientY: y }) {
    if (drag.slides) {
      const box = stage.getBoundingClientRect();
      divider.value = (100 * (x - box.left)) / box.width;
      layout();
    } else pan(drag.x - x, drag.y - y);
    [drag.x, drag.y] = [x, y];
  }
  stage.addEventListener("pointerdown", (event) => {
    const isZoomed = stage.classList.contains("zoomed");
    const slides = mode === "slider" && (!isZoomed || event.target.id === "bar");
    if (event.button !== 0 || !event.target.closest(".view, #bar") || !(slides || isZoomed)) return;
    event.preventDefault();
    stage.setPointerCapture(event.pointerId);
    drag = { slides, x: event.clientX, y: event.clientY };
    moveTo(event);
  });
  stage.addEventListener("pointermove", (event) => drag && moveTo(event));
  stage.addEventListener("lostpointercapture", () => {
    drag = null;
  });
  // A turning wheel scrolls the page; with Ctrl it zooms, as two fingers on a touchpad do, which are told like that.
  stage.addEventListener(
    "wheel",
    (event) => {
      const view = event.target.id === "bar" ? stage.querySelector(".view") : event.target.closest(".view");
      if (!event.ctrlKey || !view) return;
      event.preventDefault();
      const box = view.getBoundingClientRect();
      const place = [event.clientX - box.left - box.width / 2, event.clientY - box.top - box.height / 2];
      zoomTo((zoom ?? fitting()) * 2 ** (-event.deltaY / DOUBLING), place);
    },
    { passive: false },
  );

  function setMode(wanted) {
    mode = wanted;
    for (const button of the("modes").children)
      button.setAttribute("aria-pressed", String(button.dataset.mode === mode));
    stage.dataset.mode = mode;
    stage.dataset.shown = "expected";
    the("blinking").hidden = mode !== "blink";
    divider.hidden = mode !== "slider";
    blink(mode === "blink" && !reduced.matches);
    layout();
    remember();
  }

  /** Starts or stops blinking. */
  function blink(goes) {
    clearInterval(timer);
    timer = goes ? setInterval(swap, BLINK) : null;
    the("run").textContent = goes ? "Stop" : "Start";
  }

  function swap() {
    stage.dataset.shown = stage.dataset.shown === "expected" ? "actual" : "expected";
  }

  /** The other picture, by hand. */
  function swapByHand() {
    blink(false);
    swap();
    announce(`${TITLES[stage.dataset.shown]} is shown`);
  }

  // The list.

  let onlyFailed = false;
  const isShown = (index) => !onlyFailed || !sheets[index].passes;
  const hasFailed = (index) => !sheets[index].passes;

  function buildList() {
    const shown = sheets.map((_, index) => index).filter(isShown);
    list.replaceChildren(
      ...shown.map((index) => {
        const { name, passes, verdict } = sheets[index];
        const words = passes ? `✓ ${name}` : `✕ ${name}  ·  ${verdict.replace("same state, ", "")}`;
        const option = new Option(words, index);
        if (!passes) option.className = "failed";
        return option;
      }),
    );
  }

  function filter(only) {
    onlyFailed = only && failures > 0;
    the("only").setAttribute("aria-pressed", String(onlyFailed));
    buildList();
    if (isShown(at) || !(step(1, isShown) || step(-1, isShown))) go(at);
  }

  /** The next picture, in a direction, of which something holds; `undefined` if there is none. */
  function next(direction, holds) {
    for (let index = at + direction; index in sheets; index += direction) if (holds(index)) return index;
  }

  function step(direction, holds) {
    const index = next(direction, holds);
    if (index !== undefined) go(index);
    return index !== undefined;
  }

  function go(index) {
    at = index;
    const sheet = sheets[at];
    the("name").textContent = sheet.name;
    const facts = sheets.length > 1 ? [`${grouped(at + 1)} of ${grouped(sheets.length)}`] : [];
    if (sheet.frame !== null) facts.push(`frame ${sheet.frame}`);
    if (sheet.time !== null) facts.push(clock(sheet.time));
    if (sheet.size) facts.push(`${sheet.size[0]} × ${sheet.size[1]}`);
    the("facts").textContent = facts.join("  ·  ");
    the("words").className = sheet.passes ? "" : "failed";
    the("words").textContent = `${sheet.passes ? "✓" : "✕"} ${sheet.words}`;
    the("previous").disabled = next(-1, isShown) === undefined;
    the("next").disabled = next(1, isShown) === undefined;
    the("previous-failure").disabled = next(-1, hasFailed) === undefined;
    the("next-failure").disabled = next(1, hasFailed) === undefined;
    list.value = at;
    markInStrip(at);
    fillStage();
    announce(`${sheet.name}: ${sheet.words}`);
    remember();
  }

  // The address leads to a picture and a way to look at it.

  let remembering = null;
  function remember() {
    clearTimeout(remembering); // Browsers refuse many changes at once.
    remembering = setTimeout(() => {
      const hash = `#picture=${encodeURIComponent(sheets[at].name)}&mode=${mode}`;
      if (location.hash !== hash) history.replaceState(null, "", hash);
    }, 150);
  }

  function recall() {
    const wanted = new URLSearchParams(location.hash.slice(1).replaceAll("+", "%2B"));
    const index = sheets.findIndex((sheet) => sheet.name === wanted.get("picture"));
    if (MODES.includes(wanted.get("mode"))) setMode(wanted.get("mode"));
    if (index >= 0) go(index);
  }

  // Keys and buttons.

  const KEYS = {
    ArrowLeft: () => step(-1, isShown),
    ArrowRight: () => step(1, isShown),
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

  /** Whether a key means something to what has the focus. */
  function isTaken({ key, target }) {
    if (/^(ArrowUp|ArrowDown|Page|Home|End)/.test(key)) return target.matches("input, select, #command");
    if (key.startsWith("Arrow")) return target.matches("input, #command");
    // A space presses buttons; on the one that chose blinking it goes on to the other picture.
    return key === " " && target.matches("summary, button") && !(mode === "blink" && target.dataset.mode === mode);
  }

  document.addEventListener("keydown", (event) => {
    const combined = (event.ctrlKey || event.altKey || event.metaKey) && !event.getModifierState("AltGraph");
    if (combined || the("keys").open || isTaken(event)) return;
    const shifted = event.shiftKey && { ArrowLeft: "[", ArrowRight: "]" }[event.key];
    const key = shifted || event.key;
    const action = Object.hasOwn(KEYS, key) ? KEYS[key] : KEYS[key.toLowerCase()];
    if (sheets.length === 0 && key !== "?") return;
    if (action && action() !== false) event.preventDefault();
  });

  const BUTTONS = {
    previous: KEYS.ArrowLeft,
    next: KEYS.ArrowRight,
    "previous-failure": KEYS["["],
    "next-failure": KEYS["]"],
    only: KEYS.f,
    run: KEYS.b,
    swap: KEYS[" "],
    smaller: KEYS["-"],
    larger: KEYS["+"],
    fit: KEYS[0],
    exact: () => zoomTo(1),
    help: KEYS["?"],
  };
  for (const [id, action] of Object.entries(BUTTONS)) the(id).addEventListener("click", action);
  for (const button of the("modes").children) button.addEventListener("click", () => setMode(button.dataset.mode));
  divider.addEventListener("input", layout);
  reduced.addEventListener("change", () => reduced.matches && blink(false));
  list.addEventListener("change", () => go(Number(list.value)));
  const copy = the("copy");
  copy?.toggleAttribute("hidden", false);
  copy?.addEventListener("click", async () => {
    try {
      await navigator.clipboard.writeText(the("command").textContent);
      copy.textContent = "Copied";
    } catch {
      // Pages from files may be refused: then what is selected can be copied by hand.
      getSelection().selectAllChildren(the("command"));
      copy.textContent = "Selected";
    }
    announce(copy.textContent);
    setTimeout(() => {
      copy.textContent = "Copy";
    }, DONE);
  });

  // The beginning.

  const markInStrip = showSequence(report, go);
  document.querySelector("main").hidden = sheets.length === 0 && the("sequence").hidden;
  the("viewer").hidden = sheets.length === 0;
  for (const id of ["pictures", "around"]) the(id).hidden = sheets.length < 2;
  for (const id of ["only", "failures"]) the(id).hidden = failures === 0;
  the("count").textContent =
    failures === 0
      ? `${plural(sheets.length, "picture")}, all as expected`
      : `${grouped(failures)} of ${plural(sheets.length, "picture")} failed`;
  if (sheets.length > 0) {
    list.size = clamp(sheets.length, 2, 12);
    buildList();
    setMode(mode);
    go(report.first);
    recall();
    addEventListener("hashchange", recall);
  }
  addEventListener("resize", layout);
})();
