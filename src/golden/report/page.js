"use strict";
// What the page does. All that it shows stands in the element `data`: see `Report` in `src/golden/report/mod.rs`.
(() => {
  /** How long each picture is shown while blinking (ms): two changes a second, well below what may harm. */
  const BLINK = 500;
  /** Zooms that buttons and keys stop at: device pixels for each pixel of the picture. */
  const STOPS = [1 / 8, 1 / 4, 1 / 2, 1, 2, 3, 4, 6, 8, 12, 16];
  const LARGEST = STOPS.at(-1);
  /** From here on pixels are shown as squares. */
  const SQUARES = 2;
  /** The zoom doubles after so much turning of the wheel (px). */
  const DOUBLING = 240;
  /** A wheel that was scrolling the page goes on scrolling it for so long (ms). */
  const STILL_SCROLLING = 250;
  /** So near to the divider it is taken hold of (px). */
  const GRIP = 24;
  /** A picture takes at most this part of the window's height. */
  const TALLEST = 0.74;
  /** When three views stand beside each other, and how far apart (px), as in `page.css`. */
  const WIDE = "(min-width: 720px)";
  const GAP = 16;
  const MODES = ["side", "slider", "blink"];
  const VIEWS = {
    side: [["expected"], ["difference"], ["actual"]],
    slider: [["actual", "expected"]],
    blink: [["expected", "actual"]],
  };
  const TITLES = { expected: "Expected", difference: "Difference", actual: "Actual" };

  const report = JSON.parse(document.getElementById("data").textContent);
  const sheets = report.pictures;
  const failures = sheets.filter((sheet) => !sheet.passes).length;
  const the = (id) => document.getElementById(id);
  const reduced = matchMedia("(prefers-reduced-motion: reduce)");
  const state = {
    at: 0,
    mode: "side",
    only: false,
    divider: 50,
    shown: "expected",
    blinks: !reduced.matches,
    // Device pixels for each pixel of the picture; `null`: as large as fits.
    zoom: null,
    // What is in the middle of the views, in pixels of the picture.
    x: 0,
    y: 0,
  };

  /** An element with properties and children; classes, attributes and data by `class`, and names with a dash. */
  function make(name, properties = {}, ...children) {
    const element = document.createElement(name);
    for (const [key, value] of Object.entries(properties)) {
      if (key === "class" || key === "role" || key.includes("-")) element.setAttribute(key, value);
      else element[key] = value;
    }
    element.append(...children);
    return element;
  }

  const clamp = (value, least, most) => Math.min(Math.max(value, least), most);
  const grouped = (count) => String(count).replace(/\B(?=(\d{3})+$)/g, "\u202f");
  const plural = (count, word) => `${grouped(count)} ${word}${count === 1 ? "" : "s"}`;

  const PREFIXES = [
    [1, "m"],
    [1e-3, "mm"],
    [1e-6, "µm"],
    [1e-9, "nm"],
    [1e-12, "pm"],
  ];
  /** A length (m) with few digits and a fitting unit. */
  function length(metres, digits = 2) {
    const found = PREFIXES.find(([size]) => metres >= size * 0.9999);
    if (!found || metres >= 1e4) return `${metres.toExponential(digits - 1)} m`;
    const scaled = metres / found[0];
    return `${scaled >= 100 ? Math.round(scaled) : Number(scaled.toPrecision(digits))} ${found[1]}`;
  }

  const clock = (seconds) =>
    seconds < 0.9995 ? `${Math.round(seconds * 1e4) / 10} ms` : `${Math.round(seconds * 1e3) / 1e3} s`;

  // The strip: what happened over the whole sequence.

  /** Where something happened: frames if the sequence has any, else pictures one after the other. */
  const framed =
    report.courses.some((course) => course.frames.length > 0) || sheets.every((sheet) => sheet.frame !== null);
  const stations = (() => {
    const found = new Map();
    const station = (key, time) => {
      if (!found.has(key)) found.set(key, { key, time, moments: [], sheets: [] });
      return found.get(key);
    };
    report.courses.forEach((course, run) => {
      for (const moment of course.frames) station(moment.frame, moment.time).moments[run] = moment;
    });
    sheets.forEach((sheet, index) => {
      if (!framed) station(index + 1, sheet.time).sheets.push(index);
      else if (sheet.frame !== null) station(sheet.frame, sheet.time).sheets.push(index);
    });
    return [...found.values()].sort((one, other) => one.key - other.key);
  })();
  const elsewhere = framed ? sheets.filter((sheet) => sheet.frame === null).length : 0;
  const stationOf = (index) => stations.findIndex((station) => station.sheets.includes(index));

  /** How a moment is shown: the same, short of what can be known, known, or moved nobody knows how far. */
  function kind(moment, precision) {
    if (!moment.moved) return "same";
    if (moment.displacement === null) return "unknown";
    return moment.displacement <= precision ? "below" : "known";
  }

  function told(moment, precision) {
    const node = moment.node === null ? "" : ` (node ${moment.node})`;
    switch (kind(moment, precision)) {
      case "same":
        return "same state";
      case "unknown":
        return "moved, nobody knows how far";
      case "below":
        return precision > 0 ? `moved by less than ${length(precision)}` : "another state, no node displaced";
      default:
        return `moved by ${length(moment.displacement)}${node}`;
    }
  }

  function pixels(sheet) {
    if (sheet.visible === null) return `picture: ${sheet.verdict}`;
    const most = sheet.allowed === null ? "" : `, ${grouped(sheet.allowed)} may`;
    return `${plural(sheet.visible, "pixel")} differ${sheet.visible === 1 ? "s" : ""}${most}`;
  }

  function reading(station) {
    const parts = [`${framed ? "Frame" : "Picture"} ${station.key}`];
    if (station.time !== null && station.time !== undefined) parts[0] += ` at ${clock(station.time)}`;
    report.courses.forEach((course, run) => {
      const moment = station.moments[run];
      parts.push(`${course.run}: ${moment ? told(moment, course.precision) : "no such frame"}`);
    });
    for (const index of station.sheets) parts.push(pixels(sheets[index]));
    if (station.sheets.length === 0) parts.push("no picture");
    return parts.join("  ·  ");
  }

  function summary() {
    const parts = report.courses.map((course) => {
      const moved = course.frames.filter((moment) => moment.moved);
      if (moved.length === 0)
        return `${course.run}: the same states in all of ${plural(course.frames.length, "frame")}.`;
      const known = moved.filter((moment) => kind(moment, course.precision) === "known");
      const most = known.reduce(
        (most, moment) => (most && most.displacement >= moment.displacement ? most : moment),
        null,
      );
      const far = most ? `; most at frame ${most.frame}: ${length(most.displacement)}` : "";
      const all = plural(course.frames.length, "frame");
      return `${course.run}: ${moved.length} of ${all} moved, first at frame ${moved[0].frame}${far}.`;
    });
    return parts.join(" ");
  }

  let pointed = null; // The station that is pointed at, by pointer or keys.
  let placed = []; // Where the stations are in the drawing of the strip,
  let scaling = 1; // and how large its unit is (px).
  let marks = null; // What moves in the strip.

  /** Displacements of all runs on a logarithmic scale; lanes for what has no place on it. Returns where they end. */
  function drawDisplacements({ draw, hairline, tick, rowName, place, cell, stride, wide }, top) {
    const short = (name) => (name.length > 14 ? `${name.slice(0, 13)}…` : name);
    const key = (run, x, y) => {
      draw("line", { x1: x, x2: x + 30, y1: y, y2: y, class: `run run-${(run % 4) + 1}` });
      draw("text", { x: x + 40, y: y + 5 }, short(report.courses[run].run));
    };
    if (!wide) {
      top += 16;
      draw("text", { x: 0, y: top, class: "row-name" }, "Displacement");
      report.courses.forEach((_, run) => key(run, 164 * (run % 2), (top += run % 2 ? 0 : 24) - 5));
      top += 18;
    } else rowName(top, "Displacement", "largest of a node");
    const kinds = new Set();
    const known = [];
    report.courses.forEach((course) =>
      course.frames.forEach((moment) => {
        const its = kind(moment, course.precision);
        kinds.add(its);
        if (its === "known") known.push(moment.displacement);
      }),
    );
    const keys = top + 62;
    let y = top + 8;
    const lanes = { unknown: y };
    if (kinds.has("unknown")) {
      tick(y, "unknown");
      y += 22;
    }
    let scale = null;
    if (known.length > 0) {
      const lowest = Math.floor(Math.log10(known.reduce((a, b) => Math.min(a, b))) + 1e-9);
      const highest = Math.max(Math.ceil(Math.log10(known.reduce((a, b) => Math.max(a, b))) - 1e-9), lowest + 1);
      const room = clamp((highest - lowest) * 30, 96, 150);
      const start = y;
      scale = (metres) => start + (room * (highest - Math.log10(metres))) / (highest - lowest);
      const each = Math.ceil(((highest - lowest) * 22) / room);
      for (let power = highest; power >= lowest; power -= each) {
        hairline(scale(10 ** power));
        tick(scale(10 ** power), length(10 ** power, 1));
      }
      y = start + room + 22;
    }
    if (kinds.has("below")) {
      const precisions = new Set(report.courses.map((course) => course.precision));
      const precision = report.courses[0].precision;
      tick(y, precisions.size > 1 ? "below" : precision > 0 ? `< ${length(precision, 1)}` : "0 m");
      hairline(y);
      lanes.below = y;
      y += 22;
    }
    tick(y, "same");
    lanes.same = y;
    const level = (moment, precision) => {
      const its = kind(moment, precision);
      return its === "known" ? scale(moment.displacement) : lanes[its];
    };
    // What moved is filled, from the axis to the furthest of all runs; where nobody knows how far, there is no telling.
    let area = "";
    let anywhere = "";
    stations.forEach((station, index) => {
      let highest = lanes.same;
      let unknown = false;
      report.courses.forEach((course, run) => {
        const moment = station.moments[run];
        if (!moment || !moment.moved) return;
        highest = Math.min(highest, level(moment, course.precision));
        unknown ||= kind(moment, course.precision) === "unknown";
      });
      const x = placed[index];
      if (unknown) anywhere += `M${x - cell / 2} ${lanes.same}V${lanes.unknown}h${cell}V${lanes.same}Z`;
      else if (highest < lanes.same) area += `M${x - cell / 2} ${lanes.same}V${highest}h${cell}V${lanes.same}Z`;
    });
    draw("path", { d: area, class: "alarm-area" });
    hairline(lanes.same, "axis");
    draw("path", { d: anywhere, class: "anywhere" });
    report.courses.forEach((course, run) => {
      const colour = `run-${(run % 4) + 1}`;
      let line = "";
      let before = null;
      const dots = [];
      course.frames.forEach((moment, index) => {
        const its = kind(moment, course.precision);
        const [x, height] = [place(moment.frame), level(moment, course.precision)];
        const joined = before && before.its === its && moment.frame - before.frame <= stride;
        line += `${joined ? "L" : "M"}${x.toFixed(2)} ${height.toFixed(2)}`;
        const next = course.frames[index + 1];
        const goes = next && kind(next, course.precision) === its && next.frame - moment.frame <= stride;
        const alone = !joined && !goes;
        if ((cell >= 9 && its !== "same") || alone) dots.push([x, height, its]);
        before = { its, frame: moment.frame };
      });
      draw("path", { d: line, class: `run ${colour}` });
      for (const [cx, cy, its] of dots) {
        draw("circle", {
          cx,
          cy,
          r: its === "same" ? 1.5 : 3,
          class: `dot ${colour}${its === "known" ? "" : " hollow"}`,
        });
      }
      if (wide) key(run, 0, keys + 24 * run);
    });
    return Math.max(y, wide ? keys + 24 * report.courses.length : 0) + 30;
  }

  /** Pixels of each picture beside how many may differ, and a mark for each picture. Returns where the axis lies. */
  function drawPixels({ draw, hairline, tick, rowName, left, right, wide }, top) {
    if (!wide) top += 34;
    rowName(top, "Pixels", "that differ");
    const tall = 66;
    const most = sheets.reduce((most, sheet) => Math.max(most, sheet.visible ?? 0, sheet.allowed ?? 0), 1);
    const powers = Math.ceil(Math.log10(most + 1) - 1e-9);
    const base = top + tall;
    const rise = (count) => (tall * Math.log10(count + 1)) / powers;
    const eachPower = powers > 3 ? 2 : 1;
    for (let power = eachPower; power <= powers; power += eachPower) {
      hairline(base - rise(10 ** power - 1));
      tick(base - rise(10 ** power - 1), grouped(10 ** power));
    }
    tick(base, "0");
    hairline(base, "axis");
    const places = placed.filter((_, index) => stations[index].sheets.length > 0);
    const gap = places.slice(1).reduce((least, x, index) => Math.min(least, x - places[index]), 20);
    const bar = gap < 6 ? gap : Math.min(gap * 0.7, 10);
    const square = clamp(gap < 4 ? gap : gap * 0.7, 1.5, 10);
    const shapes = {
      "quiet-area": "",
      "alarm-area": "",
      "quiet-top": "",
      "alarm-top": "",
      quiet: "",
      alarm: "",
      slash: "",
      limit: "",
      incomparable: "",
    };
    stations.forEach((station, index) =>
      station.sheets.forEach((number) => {
        const sheet = sheets[number];
        const x = placed[index];
        if (sheet.visible > 0) {
          const colour = sheet.visible > (sheet.allowed ?? 0) ? "alarm" : "quiet";
          shapes[`${colour}-area`] += `M${x - bar / 2} ${base}v${-rise(sheet.visible)}h${bar}V${base}Z`;
          shapes[`${colour}-top`] += `M${x - bar / 2} ${base - rise(sheet.visible)}h${bar}`;
        }
        if (sheet.visible === null && !sheet.passes) shapes.incomparable += `M${x - 4} ${base - 14}l8 8m0 -8l-8 8`;
        if (sheet.allowed > 0) {
          const [from, to] = [Math.max(x - gap / 2, left), Math.min(x + gap / 2, right)];
          shapes.limit += `M${from} ${base - rise(sheet.allowed)}H${to}`;
        }
        const [x0, y0] = [x - square / 2, base + 10];
        const mark = square >= 6 ? 10 : sheet.passes ? 4 : 8; // Too small for its sign, what failed is taller.
        shapes[sheet.passes ? "quiet" : "alarm"] += `M${x0} ${y0}h${square}v${mark}h${-square}Z`;
        if (!sheet.passes && square >= 6) shapes.slash += `M${x0} ${y0 + mark}l${square} ${-mark}`;
      }),
    );
    for (const [name, d] of Object.entries(shapes)) draw("path", { d, class: name });

    if (wide && sheets.some((sheet) => sheet.allowed > 0)) {
      draw("line", { x1: 0, x2: 30, y1: top + 52, y2: top + 52, class: "limit" });
      draw("text", { x: 40, y: top + 57 }, "allowed");
    }
    return base;
  }

  /** Numbers of frames below an axis. Returns where they stand. */
  function drawAxis({ draw, place, left, right, first, span }, base) {
    const foot = base + 42;
    const digits = String(stations.at(-1).key).length * 9 + 24;
    const rough = (span * digits) / Math.max(right - left, 1);
    const ten = 10 ** Math.floor(Math.log10(Math.max(rough, 1)));
    const step = Math.max(1, [1, 2, 5, 10].map((part) => part * ten).find((each) => each >= rough) ?? 1);
    for (let key = Math.ceil(first / step) * step; key <= first + span; key += step) {
      draw("text", { x: place(key), y: foot, class: "middle" }, String(key));
    }
    draw("text", { x: left - 10, y: foot, class: "end" }, framed ? "frame" : "picture");
    return foot;
  }

  function drawStrip() {
    const strip = the("strip");
    if (strip.clientWidth === 0 || stations.length === 0) return;
    const unit = parseFloat(getComputedStyle(strip).fontSize) / 14; // All is drawn for letters of 14 px.
    const width = strip.clientWidth / unit;
    const { namespaceURI } = document.querySelector("svg");
    const svg = document.createElementNS(namespaceURI, "svg");
    svg.setAttribute("aria-hidden", "true");
    const draw = (name, attributes, text) => {
      const element = document.createElementNS(namespaceURI, name);
      for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
      if (text !== undefined) element.textContent = text;
      svg.append(element);
      return element;
    };
    const wide = width >= 720;
    const left = wide ? 208 : 78; // What is left of the rows: names, if there is room, and ticks.
    const right = width - 14;
    const first = stations[0].key;
    const span = stations.at(-1).key - first;
    const paced = stations.filter((station) => report.courses.length === 0 || station.moments.length > 0);
    const paces = paced.slice(1).map((station, index) => station.key - paced[index].key);
    const stride = paces.reduce((least, pace) => Math.min(least, pace), Math.max(span, 1));
    const cell = (right - left) / (span / stride + 1);
    const place = (key) => left + ((key - first) / stride + 0.5) * cell;
    placed = stations.map((station) => place(station.key));
    scaling = unit;
    const hairline = (y, kind = "hairline") => draw("line", { x1: left, x2: right, y1: y, y2: y, class: kind });
    const tick = (y, words) => draw("text", { x: left - 10, y: y + 5, class: "end" }, words);
    const rowName = (y, words, unit) => {
      draw("text", { x: 0, y: wide ? y + 14 : y - 16, class: "row-name" }, words);
      if (wide) draw("text", { x: 0, y: y + 34 }, unit);
    };
    const chart = { draw, hairline, tick, rowName, place, left, right, cell, stride, wide, first, span };
    const base = drawPixels(chart, report.courses.length > 0 ? drawDisplacements(chart, 30) : 30);
    const foot = drawAxis(chart, base);
    marks = {
      pointed: draw("line", { y1: 20, y2: base + 24, class: "pointed" }),
      present: draw("line", { y1: 20, y2: base + 24, class: "present" }),
      ring: draw("rect", { y: 0.5, height: 20, rx: 10, class: "ring" }),
      number: draw("text", { y: 15.5, class: "ring-text middle" }),
      left,
      right,
    };
    svg.setAttribute("viewBox", `0 0 ${width} ${foot + 8}`);
    strip.replaceChildren(svg);
    markStrip();
  }

  /** Marks the present picture and what is pointed at, and tells its numbers. */
  function markStrip() {
    if (!marks) return;
    const present = stationOf(state.at);
    const at = (line, index) => {
      line.setAttribute("visibility", index === null || index < 0 ? "hidden" : "visible");
      for (const name of ["x1", "x2"]) line.setAttribute(name, placed[index] ?? 0);
    };
    at(marks.present, present);
    at(marks.pointed, pointed === present ? null : pointed);
    const words = present < 0 ? "" : String(stations[present].key);
    const width = Math.max(20, words.length * 9 + 12);
    for (const mark of [marks.ring, marks.number]) mark.setAttribute("visibility", present < 0 ? "hidden" : "visible");
    const middle = clamp(placed[present] ?? 0, marks.left + width / 2 - 10, marks.right - width / 2 + 10);
    marks.ring.setAttribute("x", middle - width / 2);
    marks.ring.setAttribute("width", width);
    marks.number.setAttribute("x", middle);
    marks.number.textContent = words;
    const told = pointed ?? (present < 0 ? 0 : present);
    const strip = the("strip");
    strip.setAttribute("aria-valuemin", stations[0].key);
    strip.setAttribute("aria-valuemax", stations.at(-1).key);
    strip.setAttribute("aria-valuenow", stations[told].key);
    strip.setAttribute("aria-valuetext", reading(stations[told]));
    the("reading").textContent = reading(stations[told]);
  }

  function nearestStation(event) {
    const x = (event.clientX - the("strip").getBoundingClientRect().left) / scaling;
    return placed.reduce((best, place, index) => (Math.abs(place - x) < Math.abs(placed[best] - x) ? index : best), 0);
  }

  /** Chooses the picture that is nearest to a station. */
  function choose(index) {
    const far = (station) => Math.abs(station.key - stations[index].key);
    const withPictures = stations.filter((station) => station.sheets.length > 0);
    if (withPictures.length === 0) return;
    go(withPictures.reduce((best, station) => (far(station) < far(best) ? station : best)).sheets[0]);
  }

  function tabulate() {
    const head = [
      framed ? "Frame" : "Picture",
      "Time",
      ...report.courses.map((course) => course.run),
      "Picture",
      "Pixels",
    ];
    const rows = stations.map((station) => {
      const names = station.sheets.map((index) => sheets[index].name).join(", ");
      const runs = report.courses.map((course, run) =>
        station.moments[run] ? told(station.moments[run], course.precision) : "–",
      );
      const counts = station.sheets.map((index) => pixels(sheets[index])).join(", ");
      const time = station.time === null || station.time === undefined ? "–" : clock(station.time);
      return [station.key, time, ...runs, names || "–", counts || "–"];
    });
    const row = (cells, name) => make("tr", {}, ...cells.map((cell) => make(name, {}, String(cell))));
    return make(
      "table",
      {},
      make("thead", {}, row(head, "th")),
      make("tbody", {}, ...rows.map((cells) => row(cells, "td"))),
    );
  }

  // The viewer.

  let layers = []; // What is shown: {pane, side, box, image}.
  let timer = null;
  const divider = the("divider"); // Stands below the picture while there is something to divide.
  divider.hidden = false;
  divider.remove();

  /** Why there is nothing to see on a side. */
  function absent(sheet, side) {
    if (side === "difference") {
      if (sheet.verdict === "identical") return "no difference: every pixel is equal";
      if (["missing", "extra", "unreadable"].includes(sheet.verdict)) return "nothing to compare";
      if (sheet.visible === null && sheet.expected !== null && sheet.actual !== null)
        return "no difference can be drawn: sizes or opacities are not alike";
      return "not embedded in this report";
    }
    if (sheet.verdict === "missing") return side === "actual" ? "missing" : "not embedded in this report";
    if (sheet.verdict === "extra")
      return side === "expected" ? "missing: nothing like it was expected" : "not embedded in this report";
    const other = sheet[side === "expected" ? "actual" : "expected"];
    if (sheet.verdict === "unreadable" && other !== null) return "unreadable";
    return sheet.verdict === "unreadable"
      ? "unreadable, or not embedded in this report"
      : "not embedded in this report";
  }

  function buildStage() {
    layers = [];
    const panes = VIEWS[state.mode].map((sides) => {
      const view = make("div", { class: "view" });
      const caption = make("figcaption");
      if (sides.length === 1) caption.append(make("strong", {}, TITLES[sides[0]]), make("span", { class: "size" }));
      else if (state.mode === "slider")
        caption.append(make("strong", {}, TITLES.expected), make("strong", {}, TITLES.actual));
      else caption.append(...sides.map((side) => make("b", { "data-side": side }, TITLES[side])));
      for (const side of sides) {
        const box = make("div", { class: "layer", "data-side": side });
        view.append(box);
        layers.push({ view, caption, side, box, image: null });
      }
      if (state.mode === "slider") view.append(make("div", { class: "bar" }));
      listen(view);
      return make("figure", {}, caption, view);
    });
    the("stage").className = state.mode;
    if (state.mode === "slider") panes[0].append(divider);
    the("stage").replaceChildren(...panes);
    fillStage();
  }

  function fillStage() {
    const sheet = sheets[state.at];
    const differs = sheet.difference !== null && sheet.verdict !== "identical";
    the("difference-key").hidden = state.mode !== "side" || !differs;
    for (const layer of layers) {
      const source = sheet[layer.side];
      const size = layer.caption.querySelector(".size");
      if (size) size.textContent = "";
      layer.image = null;
      if (source === null) {
        layer.box.replaceChildren(make("p", {}, make("span", {}, absent(sheet, layer.side))));
        continue;
      }
      const image = make("img", { alt: `${TITLES[layer.side]}: ${sheet.name}`, draggable: false, decoding: "sync" });
      image.addEventListener("load", () => {
        // Another picture may have been chosen meanwhile.
        if (layer.image !== image) return;
        if (size) size.textContent = `${image.naturalWidth} × ${image.naturalHeight}`;
        layout();
      });
      image.addEventListener("error", () => {
        if (layer.image === image)
          layer.box.replaceChildren(make("p", {}, make("span", {}, "this picture cannot be shown")));
      });
      image.src = source;
      layer.image = image;
      layer.box.replaceChildren(image);
    }
    layout();
  }

  /** Width and height that hold all that is shown (px of the pictures). */
  function extent() {
    const shown = layers.map((layer) => layer.image).filter((image) => image && image.naturalWidth > 0);
    if (shown.length === 0) return sheets[state.at].size ?? [640, 360];
    return [
      Math.max(...shown.map((image) => image.naturalWidth)),
      Math.max(...shown.map((image) => image.naturalHeight)),
    ];
  }

  /** The zoom at which a picture fits: enlarged so that pixels are squares, by a whole number. */
  function fitting() {
    const [width, height] = extent();
    const columns = state.mode === "side" && matchMedia(WIDE).matches ? 3 : 1;
    const room = (the("stage").clientWidth - (columns - 1) * GAP) / columns;
    const most = Math.max(160, innerHeight * TALLEST);
    const scale = Math.min(room / width, most / height) * devicePixelRatio;
    return scale > SQUARES ? Math.floor(scale) : scale;
  }

  function layout() {
    if (layers.length === 0) return;
    const [width, height] = extent();
    const fit = fitting();
    const ratio = devicePixelRatio;
    const pane = [(width * fit) / ratio, (height * fit) / ratio];
    const zoom = state.zoom ?? fit;
    const scale = zoom / ratio;
    const within = (place, size, room) =>
      size * scale <= room + 0.5 ? size / 2 : clamp(place, room / scale / 2, size - room / scale / 2);
    state.x = within(state.zoom === null ? width / 2 : state.x, width, pane[0]);
    state.y = within(state.zoom === null ? height / 2 : state.y, height, pane[1]);
    for (const { view, caption, side, box, image } of layers) {
      if (state.mode !== "side") caption.parentElement.style.maxWidth = `${pane[0]}px`;
      view.style.width = `${pane[0]}px`;
      view.style.height = `${pane[1]}px`;
      view.classList.toggle("zoomed", zoom > fit + 1e-6);
      box.classList.toggle("pixelated", zoom > SQUARES);
      if (image) {
        image.style.width = `${image.naturalWidth * scale}px`;
        image.style.height = `${image.naturalHeight * scale}px`;
        // On whole pixels of the device, so that one to one is not smeared.
        const onDevice = (shift) => Math.round(shift * ratio) / ratio;
        const [x, y] = [onDevice(pane[0] / 2 - state.x * scale), onDevice(pane[1] / 2 - state.y * scale)];
        image.style.transform = `translate(${x}px, ${y}px)`;
      }
      if (state.mode === "slider" && side === "expected") box.style.clipPath = `inset(0 ${100 - state.divider}% 0 0)`;
      if (state.mode === "blink") box.style.visibility = side === state.shown ? "visible" : "hidden";
    }
    const bar = the("stage").querySelector(".bar");
    if (bar) bar.style.left = `${state.divider}%`;
    divider.value = state.divider;
    const percent = `${Number((zoom * 100).toPrecision(3))} %`;
    the("scale").textContent = percent;
    the("fit").setAttribute("aria-pressed", String(state.zoom === null));
    the("exact").setAttribute("aria-pressed", String(zoom === 1));
    the("smaller").disabled = zoom <= Math.min(fit, 1) + 1e-6;
    the("larger").disabled = zoom >= Math.max(fit, LARGEST) - 1e-6;
  }

  /** Sets the zoom so that what is at a place of the views (px from their middle) stays there. */
  function zoomTo(zoom, [x, y] = [0, 0]) {
    const fit = fitting();
    const before = state.zoom ?? fit;
    const after = clamp(zoom, Math.min(fit, 1), Math.max(fit, LARGEST));
    const change = devicePixelRatio / before - devicePixelRatio / after;
    state.zoom = Math.abs(after - fit) < 1e-3 * fit ? null : after;
    state.x += x * change;
    state.y += y * change;
    layout();
  }

  function zoomBy(direction) {
    const fit = fitting();
    const zoom = state.zoom ?? fit;
    const stops = [...STOPS, fit].sort((a, b) => a - b);
    const next =
      direction > 0 ? stops.find((stop) => stop > zoom * 1.001) : stops.findLast((stop) => stop < zoom / 1.001);
    if (next !== undefined) zoomTo(next);
  }

  function pan(x, y) {
    const scale = (state.zoom ?? fitting()) / devicePixelRatio;
    state.x += x / scale;
    state.y += y / scale;
    layout();
  }

  function slide(percent) {
    state.divider = clamp(percent, 0, 100);
    layout();
  }

  let scrolled = -Infinity;
  addEventListener(
    "scroll",
    () => {
      scrolled = performance.now();
    },
    { passive: true },
  );

  function listen(view) {
    let last = null;
    let slides = false;
    const across = (event) => {
      const box = view.getBoundingClientRect();
      return (100 * (event.clientX - box.left)) / box.width;
    };
    view.addEventListener("pointerdown", (event) => {
      if (event.button !== 0) return;
      const zoomed = view.classList.contains("zoomed");
      const away = (Math.abs(across(event) - state.divider) / 100) * view.clientWidth;
      slides = state.mode === "slider" && (!zoomed || away <= GRIP);
      if (!slides && !zoomed) return;
      view.setPointerCapture(event.pointerId);
      last = [event.clientX, event.clientY];
      view.classList.toggle("dragged", !slides);
      if (slides) slide(across(event));
    });
    view.addEventListener("pointermove", (event) => {
      if (!last) return;
      if (slides) slide(across(event));
      else pan(last[0] - event.clientX, last[1] - event.clientY);
      last = [event.clientX, event.clientY];
    });
    const release = () => {
      last = null;
      view.classList.remove("dragged");
    };
    view.addEventListener("pointerup", release);
    view.addEventListener("pointercancel", release);
    // Nothing is selected on the way, and what was selected is not dragged instead.
    view.addEventListener("mousedown", (event) => event.preventDefault());
    view.addEventListener("dragstart", (event) => event.preventDefault());
    view.addEventListener(
      "wheel",
      (event) => {
        const [zoom, fit] = [state.zoom ?? fitting(), fitting()];
        const leaves = event.deltaY > 0 && zoom <= Math.min(fit, 1) + 1e-6;
        if (event.deltaY === 0 || leaves || performance.now() - scrolled < STILL_SCROLLING) return;
        event.preventDefault();
        const box = view.getBoundingClientRect();
        const turned = event.deltaMode === WheelEvent.DOM_DELTA_PIXEL ? event.deltaY : event.deltaY * 40;
        let next = zoom * 2 ** (-turned / DOUBLING);
        if ((zoom - fit) * (next - fit) < 0) next = fit; // The way back leads through what fits.
        zoomTo(next, [event.clientX - box.left - box.width / 2, event.clientY - box.top - box.height / 2]);
      },
      { passive: false },
    );
  }

  function setMode(mode) {
    if (mode === "blink" && state.mode !== "blink") [state.shown, state.blinks] = ["expected", !reduced.matches];
    state.mode = mode;
    for (const button of the("modes").children)
      button.setAttribute("aria-pressed", String(button.dataset.mode === mode));
    the("blinking").hidden = mode !== "blink";
    buildStage();
    blink(mode === "blink" && state.blinks);
    remember();
  }

  /** Starts or stops blinking. */
  function blink(goes) {
    clearInterval(timer);
    timer = goes ? setInterval(swap, BLINK) : null;
    the("run").textContent = goes ? "Stop" : "Start";
    markShown();
  }

  function swap() {
    state.shown = state.shown === "expected" ? "actual" : "expected";
    layout();
    markShown();
  }

  function markShown() {
    for (const word of document.querySelectorAll("figcaption b")) {
      word.classList.toggle("shown", word.dataset.side === state.shown);
    }
  }

  /** The other picture, by hand. */
  function swapByHand() {
    state.blinks = false;
    blink(false);
    swap();
    announce(`${TITLES[state.shown]} is shown`);
  }

  function startOrStop() {
    state.blinks = timer === null;
    blink(state.blinks);
  }

  // The list.

  const isShown = (index) => !state.only || !sheets[index].passes;

  function buildList() {
    const items = sheets.map((sheet, index) => {
      const label = make("span", { class: "label", title: sheet.name }, sheet.name);
      const item = make(
        "li",
        { id: `picture-${index}`, role: "option", class: sheet.passes ? "passed" : "failed" },
        make("span", { class: "square" }),
        label,
      );
      if (sheet.passes) item.setAttribute("aria-label", `${sheet.name}, ${sheet.verdict}`);
      else item.append(make("span", { class: "short" }, sheet.verdict.replace("same state, ", "")));
      item.addEventListener("click", () => go(index));
      return item;
    });
    the("list").replaceChildren(...items);
  }

  function filter(only) {
    state.only = only && failures > 0;
    the("only").setAttribute("aria-pressed", String(state.only));
    [...the("list").children].forEach((item, index) => {
      item.hidden = !isShown(index);
    });
    if (!isShown(state.at)) step(1, isShown) || step(-1, isShown);
    else go(state.at);
  }

  /** Goes to the next picture, in a direction, of which something holds; says whether there is one. */
  function step(direction, holds) {
    for (let index = state.at + direction; index >= 0 && index < sheets.length; index += direction) {
      if (holds(index)) return go(index) || true;
    }
    return false;
  }

  const hasFailed = (index) => !sheets[index].passes;
  const any = (direction, holds) => sheets.some((_, index) => (index - state.at) * direction > 0 && holds(index));

  function go(index) {
    state.at = index;
    pointed = null;
    const sheet = sheets[index];
    the("name").textContent = sheet.name;
    const facts = sheets.length > 1 ? [`${grouped(index + 1)} of ${grouped(sheets.length)}`] : [];
    if (sheet.frame !== null) facts.push(`frame ${sheet.frame}`);
    if (sheet.time !== null) facts.push(clock(sheet.time));
    if (sheet.size) facts.push(`${sheet.size[0]} × ${sheet.size[1]}`);
    the("facts").textContent = facts.join("  ·  ");
    the("words").className = sheet.passes ? "passed" : "failed";
    the("words").replaceChildren(
      make("span", { class: "square", role: "img", "aria-label": sheet.passes ? "passed" : "failed" }),
      make("span", {}, sheet.words),
    );
    the("previous").disabled = !any(-1, isShown);
    the("next").disabled = !any(1, isShown);
    the("previous-failure").disabled = !any(-1, hasFailed);
    the("next-failure").disabled = !any(1, hasFailed);
    const list = the("list");
    list.querySelector("[aria-selected=true]")?.setAttribute("aria-selected", "false");
    const item = list.children[index];
    item.setAttribute("aria-selected", "true");
    list.setAttribute("aria-activedescendant", item.id);
    const [above, below] = [
      item.offsetTop - list.offsetTop - list.scrollTop,
      item.offsetTop + item.offsetHeight - list.offsetTop - list.scrollTop,
    ];
    if (above < 0 || below > list.clientHeight) list.scrollTop += above - list.clientHeight / 2;
    fillStage();
    markStrip();
    announce(`${sheet.name}: ${sheet.words}`);
    remember();
  }

  let announcing = null;
  function announce(words) {
    clearTimeout(announcing);
    announcing = setTimeout(() => {
      the("announced").textContent = words;
    }, 300);
  }

  // The address leads to a picture and a way to look at it.

  let remembering = null;
  function remember() {
    clearTimeout(remembering); // Browsers refuse many changes at once.
    remembering = setTimeout(() => {
      const hash = `#picture=${encodeURIComponent(sheets[state.at].name)}&mode=${state.mode}`;
      if (location.hash !== hash) history.replaceState(null, "", hash);
    }, 150);
  }

  function recall() {
    const wanted = new URLSearchParams(location.hash.slice(1).replaceAll("+", "%2B"));
    const index = sheets.findIndex((sheet) => sheet.name === wanted.get("picture"));
    return { index, mode: MODES.find((mode) => mode === wanted.get("mode")) };
  }

  // Keys.

  function isTyped(event) {
    const target = event.target;
    if (target.matches("input") && /^(Arrow|Page|Home|End)/.test(event.key)) return true;
    if (event.key !== " ") return false;
    // A space presses buttons; on the one that chose blinking it goes on to the other picture.
    return target.matches("summary, button") && !(state.mode === "blink" && target.dataset.mode === "blink");
  }

  const KEYS = {
    ArrowLeft: () => step(-1, isShown),
    ArrowRight: () => step(1, isShown),
    "[": () => step(-1, hasFailed),
    "]": () => step(1, hasFailed),
    f: () => filter(!state.only),
    1: () => setMode("side"),
    2: () => setMode("slider"),
    3: () => setMode("blink"),
    v: () => setMode(MODES[(MODES.indexOf(state.mode) + 1) % MODES.length]),
    b: () => (state.mode === "blink" ? startOrStop() : setMode("blink")),
    " ": () => (state.mode === "blink" ? swapByHand() : false),
    "+": () => zoomBy(1),
    "=": () => zoomBy(1),
    "-": () => zoomBy(-1),
    "−": () => zoomBy(-1),
    0: () => zoomTo(fitting()),
    z: () => zoomTo(state.zoom === 1 ? fitting() : 1),
    w: () => pan(0, -60),
    a: () => pan(-60, 0),
    s: () => pan(0, 60),
    d: () => pan(60, 0),
    "?": () => the("keys").showModal(),
  };

  document.addEventListener("keydown", (event) => {
    const combined = (event.ctrlKey || event.altKey || event.metaKey) && !event.getModifierState("AltGraph");
    if (event.defaultPrevented || combined || the("keys").open || isTyped(event)) return;
    // A command wider than its box is read by arrows.
    if (event.target.id === "command" && event.key.startsWith("Arrow")) return;
    const key =
      event.shiftKey && event.key === "ArrowLeft"
        ? "["
        : event.shiftKey && event.key === "ArrowRight"
          ? "]"
          : event.key;
    const action = Object.hasOwn(KEYS, key) ? KEYS[key] : KEYS[key.toLowerCase()];
    if (sheets.length === 0 && key !== "?") return;
    if (action && action() !== false) event.preventDefault();
  });

  the("strip").addEventListener("keydown", (event) => {
    if (event.shiftKey) return;
    const present = stationOf(state.at);
    const at = pointed ?? (present < 0 ? 0 : present);
    const leap = Math.max(1, Math.round(stations.length / 10));
    const moves = {
      ArrowLeft: -1,
      ArrowDown: -1,
      ArrowRight: 1,
      ArrowUp: 1,
      PageUp: leap,
      PageDown: -leap,
      Home: -Infinity,
      End: Infinity,
    };
    if (event.key in moves) {
      const next = clamp(at + moves[event.key], 0, stations.length - 1);
      if (stations[next].sheets.length > 0) go(stations[next].sheets[0]);
      pointed = next;
      markStrip();
    } else if (event.key === "Enter" || event.key === " ") choose(at);
    else return;
    event.preventDefault();
  });

  the("list").addEventListener("keydown", (event) => {
    const items = [...the("list").children].filter((item) => !item.hidden);
    const at = items.indexOf(the("list").children[state.at]);
    const columns = items.findIndex((item) => item.offsetTop > items[0].offsetTop);
    const row = columns < 0 ? items.length : columns;
    const moves = {
      ArrowUp: -row,
      ArrowDown: row,
      Home: -Infinity,
      End: Infinity,
      PageUp: -8 * row,
      PageDown: 8 * row,
    };
    if (!(event.key in moves)) return;
    event.preventDefault();
    const to = at + moves[event.key];
    if (Math.abs(moves[event.key]) === row && (to < 0 || to >= items.length)) return;
    go([...the("list").children].indexOf(items[clamp(to, 0, items.length - 1)]));
  });

  // What is pressed and pointed at.

  const strip = the("strip");
  strip.addEventListener("pointerdown", (event) => event.preventDefault());
  strip.addEventListener("mousedown", (event) => event.preventDefault()); // Arrows go on choosing pictures.
  strip.addEventListener("click", (event) => choose(nearestStation(event)));
  strip.addEventListener("pointermove", (event) => {
    pointed = nearestStation(event);
    markStrip();
  });
  strip.addEventListener("pointerleave", () => {
    pointed = null;
    markStrip();
  });
  strip.addEventListener("blur", () => {
    pointed = null;
    markStrip();
  });
  const onClick = (id, action) => the(id).addEventListener("click", action);
  for (const button of the("modes").children) button.addEventListener("click", () => setMode(button.dataset.mode));
  onClick("previous", KEYS.ArrowLeft);
  onClick("next", KEYS.ArrowRight);
  onClick("previous-failure", KEYS["["]);
  onClick("next-failure", KEYS["]"]);
  onClick("only", KEYS.f);
  onClick("run", startOrStop);
  onClick("swap", swapByHand);
  onClick("smaller", KEYS["-"]);
  onClick("larger", KEYS["+"]);
  onClick("fit", KEYS[0]);
  onClick("exact", () => zoomTo(1));
  onClick("help", KEYS["?"]);
  divider.addEventListener("input", () => slide(Number(divider.value)));
  the("numbers").addEventListener("toggle", () => {
    const box = the("numbers").querySelector("div");
    if (box.childElementCount === 0) box.append(tabulate());
  });
  reduced.addEventListener("change", () => {
    state.blinks = !reduced.matches;
    blink(state.mode === "blink" && state.blinks);
  });

  const copy = the("copy");
  if (copy) {
    copy.hidden = false;
    copy.addEventListener("click", async () => {
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
      }, 2000);
    });
  }

  // The beginning.

  if (sheets.length > 0 || stations.length > 0) document.querySelector("main").hidden = false;
  the("viewer").hidden = sheets.length === 0;
  the("pictures").hidden = sheets.length < 2;
  the("sequence").hidden = stations.length < 2;
  the("summary").textContent = summary();
  for (const id of ["only", "failures"]) the(id).hidden = failures === 0;
  the("around").hidden = sheets.length < 2;
  the("aside").hidden = elsewhere === 0;
  the("aside").textContent =
    `${plural(elsewhere, "picture")} without a frame ${elsewhere === 1 ? "is" : "are"} not shown here.`;
  the("count").textContent =
    failures === 0
      ? `${plural(sheets.length, "picture")}, all as expected`
      : `${grouped(failures)} of ${plural(sheets.length, "picture")} failed`;
  if (sheets.length > 0) {
    buildList();
    const wanted = recall();
    const firstFailure = Math.max(
      sheets.findIndex((sheet) => !sheet.passes),
      0,
    );
    state.at = wanted.index >= 0 ? wanted.index : firstFailure;
    setMode(wanted.mode ?? "side");
    go(state.at);
    addEventListener("hashchange", () => {
      const { index, mode } = recall();
      if (mode && mode !== state.mode) setMode(mode);
      if (index >= 0 && index !== state.at) go(index);
    });
  }
  new ResizeObserver(drawStrip).observe(strip);
  addEventListener("resize", layout);
})();
