"use strict";
// What happened over the whole sequence, in charts below a slider; and how numbers are written.

const the = (id) => document.getElementById(id);
const clamp = (value, least, most) => Math.min(Math.max(value, least), most);
const grouped = (count) => String(count).replace(/\B(?=(\d{3})+$)/g, "\u202f");
const plural = (count, word) => `${grouped(count)} ${word}${count === 1 ? "" : "s"}`;
const clock = (seconds) =>
  seconds < 0.9995 ? `${Math.round(seconds * 1e4) / 10} ms` : `${Math.round(seconds * 1e3) / 1e3} s`;

const UNITS = [
  [1, "m"],
  [1e-3, "mm"],
  [1e-6, "µm"],
  [1e-9, "nm"],
  [1e-12, "pm"],
];
/** A length (m) with few digits and a fitting unit. */
function length(metres, digits = 2) {
  const found = UNITS.find(([size]) => metres >= size * 0.9999);
  if (!found || metres >= 1e4) return `${metres.toExponential(digits - 1)} m`;
  const scaled = metres / found[0];
  return `${scaled >= 100 ? Math.round(scaled) : Number(scaled.toPrecision(digits))} ${found[1]}`;
}

/** Shows what happened; `go` is to be called with the index of a picture that is chosen here. */
function showSequence(report, go) {
  const sheets = report.pictures;
  const strip = the("strip");

  /** Where something happened: frames if the sequence has any, else pictures one after the other. */
  const framed =
    report.courses.some((course) => course.moments.length > 0) || sheets.every((sheet) => sheet.frame !== null);
  const stations = (() => {
    const found = new Map();
    const station = (key, time) => {
      if (!found.has(key)) found.set(key, { key, time, moments: [], pictures: [] });
      return found.get(key);
    };
    report.courses.forEach((course, run) => {
      for (const moment of course.moments) station(moment.frame, moment.time).moments[run] = moment;
    });
    sheets.forEach((sheet, index) => {
      if (!framed) station(index + 1, sheet.time).pictures.push(index);
      else if (sheet.frame !== null) station(sheet.frame, sheet.time).pictures.push(index);
    });
    return [...found.values()].sort((one, other) => one.key - other.key);
  })();

  /** How a moment is shown: the same, short of what can be known, known, or moved nobody knows how far. */
  function kind(moment, precision) {
    if (!moment.moved) return "same";
    if (moment.displacement === null) return "unknown";
    return moment.displacement.distance <= precision ? "below" : "known";
  }

  function momentInWords(moment, precision) {
    if (!moment) return "no such frame";
    const words = {
      same: () => "same state",
      unknown: () => "moved, nobody knows how far",
      below: () => (precision > 0 ? `moved by less than ${length(precision)}` : "another state, no node displaced"),
      known: () => {
        const { distance, node, of_shape: left } = moment.displacement;
        const fitted = left <= precision ? "nothing" : length(left);
        return `moved by ${length(distance)} (node ${node}), after the best rigid fit by ${fitted}`;
      },
    };
    return words[kind(moment, precision)]();
  }

  function pixelsInWords(sheet) {
    if (sheet.visible === null) return `picture: ${sheet.verdict}`;
    const most = sheet.allowed === null ? "" : `, ${grouped(sheet.allowed)} may`;
    return `${plural(sheet.visible, "pixel")} differ${sheet.visible === 1 ? "s" : ""}${most}`;
  }

  function stationInWords({ key, time, moments, pictures }) {
    const when = typeof time === "number" ? ` at ${clock(time)}` : "";
    const runs = report.courses.map(({ run, precision }, at) => `${run}: ${momentInWords(moments[at], precision)}`);
    const pixels = pictures.length > 0 ? pictures.map((index) => pixelsInWords(sheets[index])) : ["no picture"];
    return [`${framed ? "Frame" : "Picture"} ${key}${when}`, ...runs, ...pixels].join("  ·  ");
  }

  /** The same numbers as a table. */
  function tabulate() {
    const table = document.createElement("table");
    const row = (kind, texts) => {
      const row = table.insertRow();
      for (const text of texts) row.appendChild(document.createElement(kind)).textContent = text;
    };
    row("th", [framed ? "Frame" : "Picture", "Time", ...report.courses.map(({ run }) => run), "Picture", "Pixels"]);
    for (const { key, time, moments, pictures } of stations) {
      const runs = report.courses.map(({ precision }, at) => momentInWords(moments[at], precision));
      const names = pictures.map((index) => sheets[index].name).join(", ");
      const pixels = pictures.map((index) => pixelsInWords(sheets[index])).join(", ");
      row("td", [key, typeof time === "number" ? clock(time) : "–", ...runs, names || "–", pixels || "–"]);
    }
    return table;
  }

  /** Room for ticks at the left, and how high the rows of the charts and one line of them are (px). */
  const [GUTTER, TALL, LINE] = [84, 110, 22];
  let cell = 1; // The width of a station (px).
  /** How a run is drawn: as in pictures, which have so many looks. */
  const look = (run) => `run run-${(run % 64) + 1}`;

  function draw(svg, name, attributes, text) {
    const element = document.createElementNS(svg.namespaceURI, name);
    for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
    if (text !== undefined) element.textContent = text;
    svg.append(element);
  }

  function drawCharts() {
    const svg = the("charts");
    cell = (svg.clientWidth - GUTTER) / stations.length;
    if (cell <= 0 || stations.length === 0) return;
    svg.replaceChildren();
    let y = LINE;
    if (report.courses.length > 0) y = drawDisplacements(svg, y) + 2 * LINE;
    if (sheets.length > 0) y = drawPixels(svg, y) + LINE;
    // Numbers below, as many as there is room for.
    const room = String(stations.at(-1).key).length * 9 + 24;
    const every = [1, 2, 5, 10, 20, 50, 100, 200, 500, 1000].find((count) => count * cell >= room) ?? stations.length;
    for (let index = 0; index < stations.length; index += every)
      draw(svg, "text", { x: GUTTER + (index + 0.5) * cell, y: y + LINE, class: "middle" }, stations[index].key);
    draw(svg, "text", { x: GUTTER - 10, y: y + LINE, class: "end" }, framed ? "frame" : "picture");
    const { style } = the("sequence");
    style.setProperty("--tall", `${y}px`);
    style.setProperty("--gutter", `${GUTTER}px`);
    style.setProperty("--cell", `${cell}px`);
    svg.setAttribute("height", y + 1.5 * LINE);
    // Room for the longest words, so that nothing moves below the pointer.
    const longest = stations.map(stationInWords).reduce((one, other) => (one.length < other.length ? other : one));
    const reading = the("reading");
    const told = reading.textContent;
    reading.style.minHeight = "";
    reading.textContent = longest;
    reading.style.minHeight = `${reading.offsetHeight}px`;
    reading.textContent = told;
  }

  function tick(svg, y, words, kind = "hairline") {
    draw(svg, "line", { x1: GUTTER, x2: "100%", y1: y, y2: y, class: kind });
    draw(svg, "text", { x: GUTTER - 10, y: y + 5, class: "end" }, words);
  }

  /** Displacements of all runs on a logarithmic scale; lanes for what has no place on it. Returns where they end. */
  function drawDisplacements(svg, top) {
    draw(svg, "text", { x: 0, y: top - 6, class: "row-name" }, "Largest displacement of a node");
    const logarithm = (moment) => Math.log10(moment.displacement.distance);
    const of = (wanted) =>
      report.courses.flatMap(({ moments, precision }) => moments.filter((moment) => kind(moment, precision) === wanted));
    const known = of("known").map(logarithm);
    let y = top + LINE / 2;
    const lanes = {};
    const lane = (kind, words) => {
      tick(svg, y, words);
      lanes[kind] = y;
      y += LINE;
    };
    if (of("unknown").length > 0) lane("unknown", "unknown");
    let scale = null;
    if (known.length > 0) {
      const lowest = Math.floor(known.reduce((a, b) => Math.min(a, b)) + 1e-9);
      const highest = Math.max(Math.ceil(known.reduce((a, b) => Math.max(a, b)) - 1e-9), lowest + 1);
      const start = y;
      scale = (power) => start + (TALL * (highest - power)) / (highest - lowest);
      const each = Math.ceil(((highest - lowest) * LINE) / TALL);
      for (let power = highest; power >= lowest; power -= each) tick(svg, scale(power), length(10 ** power, 1));
      y += TALL + LINE;
    }
    const precision = report.courses[0].precision;
    const isCommon = report.courses.every((course) => course.precision === precision);
    if (of("below").length > 0) lane("below", !isCommon ? "below" : precision > 0 ? `< ${length(precision, 1)}` : "0 m");
    lanes.same = y;
    tick(svg, y, "same", "axis");
    const level = (moment, precision) => {
      const its = kind(moment, precision);
      return its === "known" ? scale(logarithm(moment)) : lanes[its];
    };
    let area = ""; // Of all runs, so that it does not grow darker where they lie over each other.
    const lines = report.courses.map(({ precision }, run) => {
      let [line, before] = ["", false];
      stations.forEach(({ moments }, index) => {
        const moment = moments[run];
        if (moment) {
          const height = level(moment, precision);
          line += `${before ? "V" : `M${GUTTER + index * cell} `}${height}h${cell}`;
          if (moment.moved) area += `M${GUTTER + index * cell} ${y}V${height}h${cell}V${y}Z`;
        }
        before = Boolean(moment);
      });
      return line;
    });
    draw(svg, "path", { d: area, class: "alarm-area" });
    lines.forEach((line, run) => draw(svg, "path", { d: line, class: look(run) }));
    return y;
  }

  /** Pixels of each picture beside how many may differ, and a mark for each picture. Returns where they end. */
  function drawPixels(svg, top) {
    draw(svg, "text", { x: 0, y: top - 6, class: "row-name" }, "Pixels that differ");
    const most = sheets.reduce((most, sheet) => Math.max(most, sheet.visible ?? 0, sheet.allowed ?? 0), 1);
    const powers = Math.ceil(Math.log10(most + 1) - 1e-9);
    const base = top + TALL;
    const height = (count) => ((TALL - LINE / 2) * Math.log10(count + 1)) / powers;
    const each = powers > 3 ? 2 : 1;
    for (let power = each; power <= powers; power += each)
      tick(svg, base - height(10 ** power - 1), grouped(10 ** power));
    tick(svg, base, "0", "axis");
    const bar = clamp(cell * 0.7, 2, 10);
    stations.forEach(({ pictures }, index) => {
      const middle = GUTTER + (index + 0.5) * cell;
      for (const { visible, allowed, passes } of pictures.map((index) => sheets[index])) {
        const x = middle - bar / 2;
        const column = (y, height, kind) => draw(svg, "rect", { x, y, width: bar, height, class: kind });
        const most = allowed ?? 0;
        if (visible > 0) column(base - height(visible), height(visible), visible > most ? "alarm" : "quiet");
        if (most > 0) draw(svg, "path", { d: `M${x - 4} ${base - height(most)}h${bar + 8}`, class: "limit" });
        // The mark of what failed is taller, for those who do not see its colour.
        if (passes) column(base + 6, 4, "quiet");
        else column(base + 6, 12, "alarm");
      }
    });
    return base;
  }

  /** Tells the numbers of a station that is pointed at, or of the present one. */
  function point(index) {
    const told = stations[index ?? strip.value];
    if (!told) return;
    the("pointed").hidden = index === null;
    the("pointed").style.left = `${GUTTER + ((index ?? 0) + 0.5) * cell}px`;
    the("reading").textContent = stationInWords(told);
    strip.setAttribute("aria-valuetext", stationInWords(told));
  }

  /** Chooses the picture that is nearest to the station of the slider. */
  function choose() {
    const far = (station) => Math.abs(station.key - stations[strip.value].key);
    const [nearest] = stations.filter(({ pictures }) => pictures.length > 0).sort((a, b) => far(a) - far(b));
    if (nearest) go(nearest.pictures[0]);
  }

  strip.addEventListener("input", () => {
    const { pictures } = stations[strip.value];
    if (pictures.length > 0) go(pictures[0]);
    else point(null);
  });
  strip.addEventListener("click", () => {
    choose();
    strip.blur(); // Arrows go on choosing pictures.
  });
  strip.addEventListener("pointermove", (event) => {
    const index = Math.floor((event.clientX - strip.getBoundingClientRect().left) / cell);
    point(clamp(index, 0, stations.length - 1));
  });
  strip.addEventListener("pointerleave", () => point(null));

  strip.addEventListener("keydown", (event) => event.key === "Enter" && choose());
  const numbers = the("numbers");
  numbers.addEventListener("toggle", () => numbers.querySelector("div").append(tabulate()), { once: true });

  the("sequence").hidden = stations.length < 2;
  const elsewhere = framed ? sheets.filter((sheet) => sheet.frame === null).length : 0;
  the("aside").hidden = elsewhere === 0;
  the("aside").textContent =
    `${plural(elsewhere, "picture")} without a frame ${elsewhere === 1 ? "is" : "are"} not shown here.`;
  strip.max = stations.length - 1;
  report.courses.forEach(({ run }, index) => {
    const item = the("runs").appendChild(document.createElement("li"));
    const sample = item.appendChild(document.createElementNS(the("charts").namespaceURI, "svg"));
    sample.setAttribute("aria-hidden", "true");
    draw(sample, "line", { x1: 0, x2: 40, y1: 4, y2: 4, class: look(index) });
    item.append(run);
  });
  point(null);
  new ResizeObserver(() => requestAnimationFrame(drawCharts)).observe(the("charts"));

  /** Marks the picture that is shown now. */
  return (picture) => {
    const index = stations.findIndex(({ pictures }) => pictures.includes(picture));
    if (index >= 0) strip.value = index;
    point(null);
  };
}
