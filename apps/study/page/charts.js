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

async function draw(element, spec) {
  const holder = document.createElement("div");
  element.appendChild(holder);
  const view = new vega.View(vega.parse(spec), { renderer: "svg", container: holder, hover: true });
  await view.runAsync();
  holder.dataset.drawn = spec.title.text;
  return view;
}

function axis(orient, scale, title, options) {
  return { orient, scale, title, grid: true, gridColor: "#e6e9ec", domainColor: "#8b949e",
    tickColor: "#8b949e", labelColor: "#1b1f24", titleColor: "#1b1f24", titleFontWeight: "normal",
    labelFontSize: 11, titleFontSize: 12, titlePadding: 6, ...options };
}

function frame(title, spec) {
  return { width: 300, height: 230, padding: 4, autosize: { type: "pad", contains: "padding" },
    background: "white", title: { text: title, anchor: "start", fontSize: 13 }, ...spec };
}

// Points have x, y, series, color, dash, level and tip; ends have x, y, color and label too.
function lineChart({ title, xTitle, yTitle, xFormat, points, ends, yScale }) {
  const logarithmic = { type: "log", nice: false, zero: false };
  const color = { scale: "color", field: "color" };
  const place = { x: { scale: "x", field: "x" }, y: { scale: "y", field: "y" } };
  return frame(title, { width: 440,
    data: [{ name: "points", values: points }, { name: "ends", values: ends }],
    scales: [
      { name: "x", ...logarithmic, domain: { data: "points", field: "x" },
        range: [14, { signal: "width - 70" }] },
      { name: "y", ...logarithmic, ...yScale, domain: { data: "points", field: "y" },
        range: "height", padding: 10 },
      { name: "color", type: "ordinal", domain: seriesStyle.fields, range: seriesStyle.colors },
      { name: "shape", type: "ordinal", domain: [0, 1, 2, 3, 4], range: seriesStyle.shapes },
      { name: "dash", type: "ordinal", domain: seriesStyle.projections, range: seriesStyle.dashes },
    ],
    axes: [
      axis("bottom", "x", xTitle, { format: xFormat, tickCount: 6, labelOverlap: "greedy", labelSeparation: 6 }),
      axis("left", "y", yTitle,
        { tickCount: 6, labelOverlap: "greedy", ...(yScale ? {} : { format: "~g" }) }),
    ],
    marks: [
      { type: "group", from: { facet: { name: "line", data: "points", groupby: "series" } },
        marks: [{ type: "line", from: { data: "line" }, sort: { field: "x" },
          encode: { update: { ...place, stroke: color, strokeWidth: { value: 1.6 },
            strokeDash: { scale: "dash", field: "dash" } } } }] },
      { type: "symbol", name: "symbols", from: { data: "points" },
        encode: { update: { ...place, shape: { scale: "shape", field: "level" }, fill: color,
          stroke: { value: "white" }, strokeWidth: { value: 0.6 }, size: { value: 46 },
          tooltip: { field: "tip" } } } },
      { type: "symbol", name: "end-symbols", from: { data: "ends" },
        encode: { update: { ...place, size: { value: 1 }, opacity: { value: 0 } } } },
      { type: "text", from: { data: "end-symbols" },
        encode: { update: { fill: { field: "datum.fill" }, fontSize: { value: 10 },
          text: { field: "datum.label" } } },
        transform: [{ type: "label", size: { signal: "[width, height]" }, avoidMarks: ["symbols"],
          anchor: ["right", "top-right", "bottom-right", "left", "top-left", "bottom-left"],
          offset: [5] }] },
    ],
  });
}

// Series of bins: each value has series, level, from, to, share.
function histogramChart({ title, xTitle, bins, scale }) {
  return frame(title, {
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
