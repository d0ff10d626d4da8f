"use strict";
// Puts the page together.

const metrics = [
  { title: "Area error", fit: "area_error", axis: "relative error",
    value: (r) => r.comparison.area_relative_error },
  { title: "Volume error", fit: "volume_error", axis: "relative error",
    value: (r) => r.comparison.volume_relative_error },
  { title: "Distance, mesh to surface", fit: "mesh_to_surface_rms", axis: "rms, Å",
    value: (r) => r.comparison.distances?.mesh_to_surface.rms ?? null },
  { title: "Distance, surface to mesh", fit: "surface_to_mesh_rms", axis: "rms, Å",
    value: (r) => r.comparison.distances?.surface_to_mesh.rms ?? null },
  // A topology may be right: 0 has its place on this axis.
  { title: "Topology", fit: null, axis: "|Δχ|", yScale: { type: "symlog", constant: 1 },
    value: (r) => r.comparison.euler_characteristic_difference },
];
const sizes = [
  { name: "spacing", title: "spacing or edge length, Å", format: "~g", fits: "by_resolution",
    value: (r) => r.parameters.resolution },
  { name: "triangles", title: "triangles", format: "~s", fits: "by_triangles", value: (r) => r.mesh.triangles },
];

const state = { study: null, scenes: [], read: new Map(), viewer: null };

function currentInput() {
  return state.study.inputs[Number(byId("molecule").value)];
}

function fillSelect(select, labels) {
  select.replaceChildren(...labels.map(([value, label]) => new Option(label, value)));
}

function pointOf(run, x, y, series) {
  const p = run.parameters;
  return { x, y, series, level: p.subdivide, dash: p.project, color: colorKey(p),
    tip: { mesh: wayLabel(p), "spacing, Å": p.resolution, triangles: run.mesh.triangles, value: y } };
}

// The points of one plot and, at the fine end of each line, its order.
function plotData(input, metric, size) {
  const points = [], ends = [];
  for (const series of input.series.filter(isShown)) {
    const runs = series.runs.map((i) => input.runs[i]);
    const line = [];
    for (const run of runs) {
      const value = metric.value(run);
      const drawable = value !== null && (value !== 0 || metric.yScale);
      if (drawable) line.push(pointOf(run, size.value(run), Math.abs(value), seriesId(series)));
    }
    points.push(...line);
    const fit = metric.fit ? series[size.fits][metric.fit] : null;
    if (fit && line.length > 1) {
      // Runs are sorted by resolution, the finest first; the right-hand end has the free room.
      const end = size.name === "spacing" ? line[line.length - 1] : line[0];
      ends.push({ ...end, label: `p = ${formatFixed(fit.order, 2)}` });
    }
  }
  return { points, ends };
}

function isShown(series) {
  return [...document.querySelectorAll("#filters input")].every((box) =>
    box.checked || String(filterKey(series, box.name)) !== box.value);
}

// The crease-exact meshes stand beside the fields.
function filterKey(series, name) {
  return name === "field" ? colorKey(series) : series[name];
}

function drawFilters() {
  const groups = [["field", "Mesh", (v) => v === "exact" ? "crease-exact" : fieldNames[v]],
    ["project", "Projection", (v) => ({ none: "none", field: "field", vdw: "union" })[v]],
    ["subdivide", "Subdivisions", (v) => v], ["backend", "Backend", (v) => v]];
  const element = byId("filters");
  element.replaceChildren();
  for (const [name, title, label] of groups) {
    const values = [...new Set(currentInput().series.map((s) => filterKey(s, name)))];
    if (values.length < 2) continue;
    const group = document.createElement("fieldset");
    const legend = document.createElement("legend");
    legend.textContent = title;
    group.appendChild(legend);
    for (const value of values) {
      const box = Object.assign(document.createElement("input"),
        { type: "checkbox", name, value: String(value), checked: true });
      box.addEventListener("change", drawConvergence);
      const text = document.createElement("label");
      text.append(box, " " + label(value));
      group.appendChild(text);
    }
    element.appendChild(group);
  }
}

async function drawAll(element, makers) {
  element.replaceChildren();
  for (const specFor of makers) await draw(element, specFor);
}

async function drawConvergence() {
  const input = currentInput();
  const specs = [];
  for (const metric of metrics) {
    for (const size of sizes) {
      const { points, ends } = plotData(input, metric, size);
      if (points.length === 0) continue;
      specs.push((width) => lineChart({ title: `${metric.title} against ${size.name}`, xTitle: size.title,
        xFormat: size.format, yTitle: metric.axis, points, ends, yScale: metric.yScale, width }));
    }
  }
  drawLegend(byId("legend"), input.series);
  await drawAll(byId("convergence"), specs);
}

function binsOf(histogram, series) {
  const total = histogram.counts.reduce((a, b) => a + b, histogram.below + histogram.above);
  const { lower, upper, counts, scale } = histogram;
  const edge = (i) => scale === "logarithmic" ? lower * (upper / lower) ** (i / counts.length)
    : lower + (upper - lower) * i / counts.length;
  return counts.map((count, i) => ({ series, from: edge(i), to: edge(i + 1),
    share: 100 * count / total }));
}

// Meshes of one field, projection and resolution, level by level.
function qualityGroups(input) {
  const groups = new Map();
  const add = (key, run) => groups.set(key, [...(groups.get(key) ?? []), run]);
  const label = (p, project) => {
    const onto = { none: "", field: ", projected onto the field", vdw: ", projected onto the union" };
    return `${fieldLabel(p)}, ${p.resolution} Å${onto[project]}, ${p.backend}`;
  };
  const projections = (p) => [...new Set(input.runs.map((r) => r.parameters)
    .filter((q) => q.field === p.field && q.mesher === p.mesher && q.backend === p.backend &&
      q.subdivide > 0).map((q) => q.project))];
  for (const run of input.runs) {
    const p = run.parameters;
    const shared = p.subdivide === 0 ? projections(p) : [];
    for (const project of shared.length > 0 ? shared : [p.project]) add(label(p, project), run);
  }
  return groups;
}

async function drawQuality() {
  const runs = qualityGroups(currentInput()).get(byId("quality-choice").value) ?? [];
  const named = (n) => n === 1 ? "1 subdivision" : `${n} subdivisions`;
  const levels = runs.map((r) => [r, named(r.parameters.subdivide)]);
  const kinds = [["min_angle_deg", "Smallest angle of each triangle", "degrees"],
    ["aspect_ratio", "Aspect ratio (circumradius / 2 inradius)", "1 is equilateral"],
    ["edge_length", "Edge length", "Å"]];
  await drawAll(byId("quality"), kinds.map(([key, title, xTitle]) => (width) => histogramChart({ title, xTitle, width,
    scale: runs[0].histograms[key].scale,
    bins: levels.flatMap(([run, series]) => binsOf(run.histograms[key], series)) })));
}

async function drawCosts() {
  const input = currentInput();
  const costs = [["Time to the mesh", "s", (r) => r.timing.mesh],
    ["Largest memory of the process", "MB", (r) => r.memory.peak === null ? null : r.memory.peak / 1e6]];
  const specs = [];
  for (const [title, unit, value] of costs) {
    const points = [];
    for (const series of input.series) {
      for (const run of series.runs.map((i) => input.runs[i])) {
        if (!value(run)) continue;
        points.push(pointOf(run, run.mesh.triangles, value(run), seriesId(series)));
      }
    }
    if (points.length === 0) continue;
    specs.push((width) =>
      lineChart({ title, xTitle: "triangles", xFormat: "~s", yTitle: unit, points, ends: [], width }));
  }
  await drawAll(byId("costs"), specs);
}

function sceneRun(number) {
  const key = (p) => `${seriesId(p)} ${p.resolution}`;
  const wanted = key(state.scenes[number].parameters);
  return currentInput().runs.find((r) => key(r.parameters) === wanted);
}

async function drawScene() {
  const number = byId("scene").value;
  if (number === "") return;
  drawSceneTable(byId("scene-table"), currentInput(), sceneRun(number));
  if (!state.viewer) return;
  if (!state.read.has(number)) state.read.set(number, await readScene(number, state.scenes[number]));
  state.viewer.show(state.read.get(number), byId("coloring").value, byId("edges").checked);
}

// A browser without WebGL still gets everything else.
function makeViewer() {
  try {
    state.viewer = new MeshViewer(byId("view"), byId("colorbar"));
  } catch (error) {
    const text = document.createElement("p");
    text.className = "error";
    text.textContent = "The 3D view needs WebGL: " + error.message;
    byId("view").replaceChildren(text);
  }
}

async function drawPlots() {
  await drawConvergence();
  await drawQuality();
  await drawCosts();
}

async function drawMolecule() {
  const input = currentInput();
  drawMoleculeTable(byId("molecule-table"), input);
  drawWarnings(byId("molecule-warnings"), input);
  drawOrdersTable(byId("orders"), input);
  drawRunsTable(byId("runs"), input);
  drawRefused(byId("refused"), input);
  const own = [...state.scenes.entries()].filter(([, s]) => s.input === Number(byId("molecule").value));
  byId("view-section").hidden = own.length === 0;
  fillSelect(byId("scene"), own.map(([number, s]) => [number,
    `${wayLabel(s.parameters)}, ${s.parameters.resolution} Å: ${formatNumber(s.triangles)} triangles`]));
  fillSelect(byId("quality-choice"), [...qualityGroups(input).keys()].map((k) => [k, k]));
  drawFilters();
  await drawScene();
  await drawPlots();
  document.body.dataset.drawn = byId("molecule").value;
}

function summaryText(study) {
  const runs = study.inputs.reduce((sum, input) => sum + input.runs.length, 0);
  const machines = study.backends.map((b) => b.device ? `${b.used} (${b.device})`
    : `${b.used}, ${b.threads} threads`);
  return `vdwmesh ${study.version}: ${runs} meshes of ${study.inputs.length} ` +
    `${study.inputs.length === 1 ? "molecule" : "molecules"}, made on ${machines.join(" and ")}`;
}

// Plots are made for the width of the window; after it was turned or widened they are made anew.
function redrawWhenResized() {
  let drawn = window.innerWidth, timer = null;
  window.addEventListener("resize", () => {
    clearTimeout(timer);
    timer = setTimeout(async () => {
      if (window.innerWidth === drawn) return;
      drawn = window.innerWidth;
      await drawPlots();
    }, 200);
  });
}

async function start() {
  state.study = await unpackJson("study");
  state.scenes = await unpackJson("scenes");
  byId("summary").textContent = summaryText(state.study);
  fillSelect(byId("molecule"), state.study.inputs.map((input, i) => [i, input.name]));
  byId("molecule-choice").hidden = state.study.inputs.length < 2;
  makeViewer();
  byId("molecule").addEventListener("change", drawMolecule);
  byId("scene").addEventListener("change", drawScene);
  byId("coloring").addEventListener("change", drawScene);
  byId("edges").addEventListener("change", drawScene);
  byId("quality-choice").addEventListener("change", drawQuality);
  redrawWhenResized();
  await drawMolecule();
}

start().catch((error) => {
  byId("error").textContent = "The page could not be drawn: " + error.message;
  byId("error").hidden = false;
  throw error;
});
