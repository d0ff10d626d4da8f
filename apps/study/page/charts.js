"use strict";
// Vega specifications.

const vega = (() => {
  const util = vdwmeshRequire("vega-util");
  const dataflow = vdwmeshRequire("vega-dataflow");
  // What the package `vega` itself does: make the transforms known.
  util.extend(dataflow.transforms, vdwmeshRequire("vega-transforms"),
    vdwmeshRequire("vega-view-transforms"), vdwmeshRequire("vega-encode"),
    vdwmeshRequire("vega-label"));
  return { View: vdwmeshRequire("vega-view").View, parse: vdwmeshRequire("vega-parser").parse,
    scheme: vdwmeshRequire("vega-scale").scheme };
})();

// Okabe and Ito's colours, which people with colour-blindness can tell apart.
const seriesStyle = {
  fields: ["vdw", "blinn", "soft", "inverse-squared", "exact"],
  colors: ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00"],
  projections: ["none", "field", "vdw"],
  dashes: [[1, 0], [7, 3], [2, 2]],
  shapes: ["circle", "square", "triangle-up", "diamond", "cross"],
};

function colorKey(parameters) {
  return parameters.mesher === "exact" ? "exact" : parameters.field;
}

// The spec is made for the width that its place on the page has.
async function draw(element, specFor) {
  const holder = document.createElement("div");
  element.appendChild(holder);
  const spec = specFor(holder.clientWidth - kFrameMargins);
  const view = new vega.View(vega.parse(spec), { renderer: "svg", container: holder, hover: true });
  await view.runAsync();
  holder.dataset.drawn = spec.title.text;
  return view;
}

const kFrameMargins = 72;  // px beside a plot: its scale, the title of the scale, and the padding

function axis(orient, scale, title, options) {
  return { orient, scale, title, grid: true, gridColor: "#e6e9ec", domainColor: "#8b949e",
    tickColor: "#8b949e", labelColor: "#1b1f24", titleColor: "#1b1f24", titleFontWeight: "normal",
    labelFontSize: 11, titleFontSize: 12, titlePadding: 6, ...options };
}

function frame(title, spec) {
  return { width: 300, height: 230, padding: 4, autosize: { type: "pad", contains: "padding" },
    background: "white", title: { text: title, anchor: "start", fontSize: 13 }, ...spec };
}

const kLabelHeight = 13, kLabelColumn = 88;  // px of the names at the ends of lines

// Where the labels of a column stand, given where they would like to: as near as they can without one
// touching another. Labels that would touch form a block around the middle of their wishes.
function spreadLabels(wishes, height) {
  const order = wishes.map((y, i) => [y, i]).sort((a, b) => a[0] - b[0] || a[1] - b[1]);
  const blocks = [];  // of labels: how many, and where the first stands
  for (const [y] of order) {
    let block = { count: 1, sum: y };
    const top = (b) => Math.min(Math.max(b.sum / b.count - (b.count - 1) * kLabelHeight / 2, 6),
      height - 6 - (b.count - 1) * kLabelHeight);
    block.top = top(block);
    while (blocks.length > 0) {
      const above = blocks[blocks.length - 1];
      if (above.top + above.count * kLabelHeight <= block.top) break;
      blocks.pop();
      block = { count: above.count + block.count, sum: above.sum + block.sum };
      block.top = top(block);
    }
    blocks.push(block);
  }
  const places = blocks.flatMap((b) => Array.from({ length: b.count }, (_, k) => b.top + k * kLabelHeight));
  const result = [];
  order.forEach(([, i], place) => { result[i] = places[place]; });
  return result;
}

// Pixels of a value on a vertical axis; symlog as Vega has it.
function verticalScale(points, yScale, height) {
  const flat = yScale ? (y) => Math.log1p(y / yScale.constant) : Math.log;
  const values = points.map((p) => flat(p.y));
  const low = Math.min(...values), high = Math.max(...values);
  const room = 10;
  return (y) => high === low ? height / 2
    : height - room - (flat(y) - low) / (high - low) * (height - 2 * room);
}

// Points have x, y, series, color, dash, level and tip; ends have those and a label. The labels stand in a
// column on the right, each behind a piece of its line, so that no two touch and none lies on a line.
function lineChart({ title, xTitle, yTitle, xFormat, points, ends, yScale, width }) {
  const logarithmic = { type: "log", nice: false, zero: false };
  const color = { scale: "color", field: "color" };
  const dash = { scale: "dash", field: "dash" };
  const shape = { scale: "shape", field: "level" };
  const place = { x: { scale: "x", field: "x" }, y: { scale: "y", field: "y" } };
  const height = Math.max(230, (ends.length + 1) * kLabelHeight);
  const toPixel = verticalScale(points, yScale, height);
  const rows = spreadLabels(ends.map((end) => toPixel(end.y)), height);
  const labels = ends.map((end, i) => ({ ...end, row: rows[i] }));
  const column = ends.length > 0 ? kLabelColumn : 0;
  const inColumn = (dx) => ({ signal: `width - ${column - dx}` });
  const row = { field: "row" };
  return frame(title, { width: Math.min(width, 440), height,
    data: [{ name: "points", values: points }, { name: "labels", values: labels }],
    scales: [
      { name: "x", ...logarithmic, domain: { data: "points", field: "x" },
        range: [14, { signal: `width - ${column + 14}` }] },
      { name: "y", ...logarithmic, ...yScale, domain: { data: "points", field: "y" },
        range: "height", padding: 10 },
      { name: "color", type: "ordinal", domain: seriesStyle.fields, range: seriesStyle.colors },
      { name: "shape", type: "ordinal", domain: [0, 1, 2, 3, 4], range: seriesStyle.shapes },
      { name: "dash", type: "ordinal", domain: seriesStyle.projections, range: seriesStyle.dashes },
    ],
    axes: [
      axis("bottom", "x", xTitle, { format: xFormat, tickCount: Math.min(6, width / 60), labelOverlap: "greedy",
        labelSeparation: 6 }),
      axis("left", "y", yTitle,
        { tickCount: 6, labelOverlap: "greedy", labelSeparation: 5, ...(yScale ? {} : { format: "~g" }) }),
    ],
    marks: [
      { type: "rule", from: { data: "labels" },
        encode: { update: { x: place.x, y: place.y, x2: inColumn(4), y2: row, stroke: color,
          strokeWidth: { value: 0.6 }, strokeOpacity: { value: 0.45 } } } },
      { type: "group", from: { facet: { name: "line", data: "points", groupby: "series" } },
        marks: [{ type: "line", from: { data: "line" }, sort: { field: "x" },
          encode: { update: { ...place, stroke: color, strokeWidth: { value: 1.6 }, strokeDash: dash } } }] },
      { type: "symbol", name: "symbols", from: { data: "points" },
        encode: { update: { ...place, shape, fill: color, stroke: { value: "white" }, strokeWidth: { value: 0.6 },
          size: { value: 46 }, tooltip: { field: "tip" } } } },
      { type: "rect", encode: { update: { x: inColumn(4), x2: { signal: "width + 1" }, y: { value: -1 },
        height: { signal: column > 0 ? "height + 2" : "0" }, fill: { value: "white" } } } },
      { type: "rule", from: { data: "labels" },
        encode: { update: { x: inColumn(6), x2: inColumn(32), y: row, stroke: color, strokeWidth: { value: 1.6 },
          strokeDash: dash } } },
      { type: "symbol", from: { data: "labels" }, name: "label-symbols",
        encode: { update: { x: inColumn(19), y: row, shape, fill: color, size: { value: 30 } } } },
      { type: "text", from: { data: "labels" },
        encode: { update: { x: inColumn(36), y: row, baseline: { value: "middle" }, fontSize: { value: 11 },
          fill: { value: "#1b1f24" }, text: { field: "label" } } } },
    ],
  });
}

// Series of bins: each value has series, level, from, to, share.
function histogramChart({ title, xTitle, bins, scale, width }) {
  return frame(title, { width: Math.min(width, 300),
    data: [{ name: "bins", values: bins }],
    scales: [
      { name: "x", type: scale === "logarithmic" ? "log" : "linear", nice: false, zero: false,
        domain: { fields: [{ data: "bins", field: "from" }, { data: "bins", field: "to" }] },
        range: "width" },
      { name: "y", type: "linear", zero: true, nice: true, domain: { data: "bins", field: "share" },
        range: "height" },
      { name: "color", type: "ordinal", range: { scheme: "viridis", extent: [0.05, 0.85] },
        domain: { data: "bins", field: "series" } },
    ],
    axes: [axis("bottom", "x", xTitle, { tickCount: 6, labelOverlap: "greedy",
      ...(scale === "logarithmic" ? { format: "~g" } : {}) }),
      axis("left", "y", "share, %", { tickCount: 5 })],
    legends: [{ fill: "color", orient: "bottom", direction: "horizontal", symbolType: "square",
      labelFontSize: 11 }],
    marks: [{ type: "group", from: { facet: { name: "line", data: "bins", groupby: "series" } },
      marks: [{ type: "area", from: { data: "line" },
        encode: { update: { x: { scale: "x", field: "from" }, y: { scale: "y", field: "share" },
          y2: { scale: "y", value: 0 }, interpolate: { value: "step-after" },
          fill: { scale: "color", field: "series" }, fillOpacity: { value: 0.16 },
          stroke: { scale: "color", field: "series" }, strokeWidth: { value: 1.5 } } } }] }],
  });
}

function drawLegend(element, series) {
  const has = (test) => series.some(test);
  const entries = [];
  const line = (color, dash) =>
    `<line x1="0" y1="7" x2="28" y2="7" stroke="${color}" stroke-width="2" stroke-dasharray="${dash}"/>`;
  seriesStyle.fields.forEach((key, i) => {
    if (has((s) => colorKey(s) === key)) {
      entries.push([line(seriesStyle.colors[i], ""), key === "exact" ? "crease-exact" : fieldNames[key]]);
    }
  });
  const targets = ["as extracted, or not projected", "projected onto the field",
    "projected onto the union"];
  seriesStyle.projections.forEach((key, i) => {
    if (has((s) => s.project === key)) {
      const dash = i === 0 ? "" : seriesStyle.dashes[i].join(" ");
      entries.push([line("#57606a", dash), targets[i]]);
    }
  });
  const shapes = ['<circle cx="14" cy="7" r="4"/>', '<rect x="10" y="3" width="8" height="8"/>',
    '<path d="M14 2 L19 11 L9 11 Z"/>', '<path d="M14 1 L19 7 L14 13 L9 7 Z"/>',
    '<path d="M12 2h4v3h3v4h-3v3h-4v-3h-3v-4h3z"/>'];
  const levels = ["not subdivided", "1 subdivision", "2 subdivisions", "3 subdivisions",
    "4 subdivisions"];
  levels.forEach((label, level) => {
    if (has((s) => s.subdivide === level)) entries.push([shapes[level], label]);
  });
  element.innerHTML = entries.map(([mark, label]) =>
    `<span><svg width="28" height="14" fill="#57606a">${mark}</svg>${label}</span>`).join("");
}
