"use strict";
// Charts of a sequence of frames, over a slider that chooses one; and how numbers are written.

const the = (id) => document.getElementById(id);
const clamp = (value, least, most) => Math.min(Math.max(value, least), most);
const grouped = (count) => String(count).replace(/\B(?=(\d{3})+$)/g, "\u202f");
const plural = (count, word) => `${grouped(count)} ${word}${count === 1 ? "" : "s"}`;
const clock = (seconds) =>
  seconds < 0.9995 ? `${Math.round(seconds * 1e4) / 10} ms` : `${Math.round(seconds * 1e3) / 1e3} s`;

/** A length (m) with an SI prefix. */
function metres(length, digits = 2) {
  const step = clamp(Math.ceil(-Math.log10(length * 1.0001) / 3), 0, 4);
  return `${Number((length * 1000 ** step).toPrecision(digits))} ${["m", "mm", "µm", "nm", "pm"][step]}`;
}

/** Room for tick labels at the left, height of a chart, height of a line of text (px). */
const [GUTTER, TALL, LINE] = [84, 110, 22];

/** Draws the sequence. `choose` is called with the index of a chosen picture; returns a function that marks one. */
function showSequence({ runs, pictures }, choose) {
  const [strip, svg] = [the("strip"), the("charts")];
  let cell = 1; // Width of a frame in the charts (px).

  // Pictures without frame numbers are counted from 1.
  const hasFrames = runs.some(({ moments }) => moments.length > 0) || pictures.every(({ frame }) => frame !== null);
  const noun = hasFrames ? "Frame" : "Picture";
  const byKey = {}; // Objects keep integer keys in rising order.
  const column = (key, time) => (byKey[key] ??= { key, time, moments: [], pictures: [] });
  runs.forEach(({ moments, precision }, run) => {
    for (const moment of moments) column(moment.frame, moment.time).moments[run] = state(moment, precision);
  });
  pictures.forEach(({ frame, time }, index) => {
    const key = hasFrames ? frame : index + 1;
    if (key !== null) column(key, time).pictures.push(index);
  });
  const columns = Object.values(byKey);

  /** The lane of a state in the chart, and the state in words. */
  function state({ moved, displacement }, precision) {
    if (!moved) return { lane: "same", words: "same state" };
    if (!displacement) return { lane: "unknown", words: "moved, distance unknown" };
    const { distance, node, of_shape: left } = displacement;
    if (distance > precision) {
      const fitted = left <= precision ? "nothing" : metres(left);
      const words = `moved by ${metres(distance)} (node ${node}), after the best rigid fit by ${fitted}`;
      return { power: Math.log10(distance), words };
    }
    const words = precision > 0 ? `moved by less than ${metres(precision)}` : "another state, no node displaced";
    return { lane: "below", words };
  }

  function pixelsInWords({ name, verdict, visible, allowed }) {
    if (visible === null) return `${name}: ${verdict}`;
    const limit = allowed === null ? "" : `, ${grouped(allowed)} may`;
    return `${name}: ${plural(visible, "pixel")} differ${visible === 1 ? "s" : ""}${limit}`;
  }

  /** A column in words: its frame and time, its pictures, and the state of each run. */
  function inWords({ key, time, moments, pictures: shown }) {
    const when = typeof time === "number" ? ` at ${clock(time)}` : "";
    const pixels = shown.map((index) => pixelsInWords(pictures[index])).join(", ") || "no picture";
    return [`${noun} ${key}${when}`, pixels, ...runs.map((_, run) => moments[run]?.words ?? "no such frame")];
  }

  function addTable() {
    const table = document.createElement("table");
    const heads = [noun, "Pictures", ...runs.map(({ run }) => run)];
    [heads, ...columns.map(inWords)].forEach((texts, index) => {
      const row = table.insertRow();
      for (const text of texts) row.appendChild(document.createElement(index === 0 ? "th" : "td")).textContent = text;
    });
    the("numbers").querySelector("div").append(table);
  }

  function draw(name, attributes, text = "") {
    const element = document.createElementNS(svg.namespaceURI, name);
    for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
    element.textContent = text;
    svg.append(element);
  }

  function tick(y, text, kind = "hairline") {
    draw("line", { x1: GUTTER, x2: "100%", y1: y, y2: y, class: kind });
    draw("text", { x: GUTTER - 10, y: y + 5, class: "end" }, text);
  }

  function drawCharts() {
    cell = (svg.clientWidth - GUTTER) / columns.length;
    if (columns.length === 0 || cell <= 0) return;
    svg.replaceChildren();
    let y = LINE;
    if (runs.length > 0) y = drawDisplacements(y) + 2 * LINE;
    if (pictures.length > 0) y = drawPixels(y) + LINE;
    const room = String(columns.at(-1).key).length * 9 + 24;
    const every = [1, 2, 5, 10, 20, 50, 100, 200, 500, 1000].find((count) => count * cell >= room) ?? columns.length;
    for (let at = 0; at < columns.length; at += every)
      draw("text", { x: GUTTER + (at + 0.5) * cell, y: y + LINE, class: "middle" }, columns[at].key);
    draw("text", { x: GUTTER - 10, y: y + LINE, class: "end" }, noun.toLowerCase());
    svg.setAttribute("height", y + 1.5 * LINE);
    const lengths = { "--tall": y, "--gutter": GUTTER, "--cell": cell };
    for (const [name, length] of Object.entries(lengths)) the("sequence").style.setProperty(name, `${length}px`);
  }

  /** Displacements on a logarithmic scale, with lanes for states that have no place on it. Returns the lower end. */
  function drawDisplacements(top) {
    draw("text", { x: 0, y: top - 6, class: "row-name" }, "Largest displacement of a node");
    const states = columns.flatMap(({ moments }) => moments.filter(Boolean));
    const powers = states.flatMap(({ power }) => power ?? []);
    const lanes = {};
    let y = top + LINE / 2;
    const addLane = (lane, text, kind) => {
      if (lane !== "same" && !states.some((state) => state.lane === lane)) return;
      tick(y, text, kind);
      lanes[lane] = y;
      y += LINE;
    };
    addLane("unknown", "unknown");
    let scale = null;
    if (powers.length > 0) {
      const lowest = Math.floor(powers.reduce((a, b) => Math.min(a, b)) + 1e-9);
      const highest = Math.max(Math.ceil(powers.reduce((a, b) => Math.max(a, b)) - 1e-9), lowest + 1);
      const start = y;
      scale = (power) => start + (TALL * (highest - power)) / (highest - lowest);
      const step = Math.ceil(((highest - lowest) * LINE) / TALL);
      for (let power = highest; power >= lowest; power -= step) tick(scale(power), metres(10 ** power, 1));
      y += TALL + LINE;
    }
    const precisions = new Set(runs.map(({ precision }) => precision));
    const [precision] = precisions;
    addLane("below", precisions.size > 1 ? "below" : precision > 0 ? `< ${metres(precision, 1)}` : "0 m");
    addLane("same", "same", "axis");
    const base = lanes.same;
    let area = ""; // One path for all runs, so that it does not grow darker where they overlap.
    const lines = runs.map((_, run) => {
      let line = "";
      columns.forEach(({ moments }, at) => {
        if (!moments[run]) return;
        const { lane, power } = moments[run];
        const [x, y] = [GUTTER + at * cell, lanes[lane] ?? scale(power)];
        line += `${columns[at - 1]?.moments[run] ? "V" : `M${x} `}${y}h${cell}`;
        if (lane !== "same") area += `M${x} ${base}V${y}h${cell}V${base}Z`;
      });
      return line;
    });
    draw("path", { d: area, class: "alarm-area" });
    lines.forEach((d, run) => draw("path", { d, class: look(run) }));
    return base;
  }

  /** Pixels of each picture, how many may differ, and a mark below each picture. Returns the lower end. */
  function drawPixels(top) {
    draw("text", { x: 0, y: top - 6, class: "row-name" }, "Pixels that differ");
    const most = pictures.reduce((most, { visible, allowed }) => Math.max(most, visible ?? 0, allowed ?? 0), 1);
    const powers = Math.ceil(Math.log10(most + 1) - 1e-9);
    const base = top + TALL;
    const height = (count) => ((TALL - LINE / 2) * Math.log10(count + 1)) / powers;
    const step = powers > 3 ? 2 : 1;
    for (let power = step; power <= powers; power += step) tick(base - height(10 ** power - 1), grouped(10 ** power));
    tick(base, "0", "axis");
    const width = clamp(cell * 0.7, 2, 10);
    columns.forEach(({ pictures: shown }, at) => {
      const x = GUTTER + (at + 0.5) * cell - width / 2;
      const bar = (y, height, kind) => draw("rect", { x, y, width, height, class: kind });
      for (const { visible, allowed, passes } of shown.map((index) => pictures[index])) {
        if (visible > 0) bar(base - height(visible), height(visible), visible > (allowed ?? 0) ? "alarm" : "quiet");
        if (allowed > 0) draw("path", { d: `M${x - 4} ${base - height(allowed)}h${width + 8}`, class: "limit" });
        // The mark of a failure is also taller, for readers who do not see its colour.
        bar(base + 6, passes ? 4 : 12, passes ? "quiet" : "alarm");
      }
    });
    return base;
  }

  /** The colours and dashes of runs are those of pictures, which have as many. */
  const look = (run) => `run run-${(run % 64) + 1}`;

  /** Writes out the column below the pointer, or else the chosen one. */
  function point(at = null) {
    const column = columns[at ?? strip.value];
    if (!column) return;
    the("pointed").hidden = at === null;
    the("pointed").style.left = `${GUTTER + (at + 0.5) * cell}px`;
    const [when, pixels, ...states] = inWords(column);
    the("reading").textContent = `${when}  ·  ${pixels}`;
    const ofRuns = runs.map(({ run }, at) => `${run}: ${states[at]}`);
    ofRuns.forEach((words, run) => {
      the("runs").children[run].lastChild.textContent = words;
    });
    strip.setAttribute("aria-valuetext", [when, ...ofRuns, pixels].join("  ·  "));
  }

  /** Chooses the picture nearest to the slider. */
  function chooseNearest() {
    const distance = ({ key }) => Math.abs(key - columns[strip.value].key);
    const [nearest] = columns.filter(({ pictures }) => pictures.length > 0).sort((a, b) => distance(a) - distance(b));
    if (nearest) choose(nearest.pictures[0]);
  }

  strip.addEventListener("input", () => {
    const { pictures } = columns[strip.value];
    if (pictures.length > 0) choose(pictures[0]);
    else point();
  });
  strip.addEventListener("click", () => {
    chooseNearest();
    strip.blur(); // Arrow keys go on choosing pictures.
  });
  strip.addEventListener("keydown", ({ key }) => key === "Enter" && chooseNearest());
  strip.addEventListener("pointermove", ({ clientX }) => {
    const at = Math.floor((clientX - strip.getBoundingClientRect().left) / cell);
    point(clamp(at, 0, columns.length - 1));
  });
  strip.addEventListener("pointerleave", () => point());
  the("numbers").addEventListener("toggle", addTable, { once: true });

  the("sequence").hidden = columns.length < 2;
  strip.max = columns.length - 1;
  const left = hasFrames ? pictures.filter(({ frame }) => frame === null).length : 0;
  the("aside").hidden = left === 0;
  the("aside").textContent = `Not shown here: ${plural(left, "picture")} without a frame number.`;
  runs.forEach((_, run) => {
    const sample = `<svg aria-hidden="true"><line x2="40" y1="4" y2="4" class="${look(run)}" /></svg>`;
    the("runs").appendChild(document.createElement("li")).innerHTML = `${sample}<span></span>`;
  });
  point();
  new ResizeObserver(() => requestAnimationFrame(drawCharts)).observe(svg);

  return (picture) => {
    const at = columns.findIndex(({ pictures }) => pictures.includes(picture));
    if (at >= 0) strip.value = at;
    point();
  };
}
