"use strict";
// The tables of a study.

function formatPercent(value) {
  if (value === null || value === undefined) return "–";
  const percent = 100 * value;
  const decimals = Math.abs(percent) >= 1 ? 2 : Math.abs(percent) >= 0.01 ? 3 : 5;
  return (percent > 0 ? "+" : percent < 0 ? "−" : "") + Math.abs(percent).toFixed(decimals) + " %";
}

function formatSigned(value) {
  if (value === null || value === undefined) return "–";
  return (value > 0 ? "+" : value < 0 ? "−" : "") + Math.abs(value).toLocaleString("en-US");
}

function formatDifference(value) {
  return value === 0 ? "equal" : formatSigned(value);
}

// The exact figures of the surface that the meshes approximate.
function exactFigures(input) {
  if (!input.excluded) return input.exact;
  const { area, volume, euler_characteristic, cavities, shells } = input.excluded.complete;
  const genus = shells.reduce((sum, shell) => sum + shell.genus, 0);
  return { area, volume, euler_characteristic, components: shells.length - cavities, tunnels: genus, voids: cavities, hidden_atoms: null };
}

function drawMoleculeTable(element, input) {
  const exact = exactFigures(input);
  drawTable(element, [
    { title: "file", text: (i) => i.name, align: "text" },
    { title: "atoms", text: (i) => formatNumber(i.input.atoms_used) },
    { title: "radii", text: (i) => i.input.radius_set, align: "text" },
    { title: "probe, Å", text: (i) => formatNumber(i.input.probe) },
    { title: "exact area, Å²", text: () => formatFixed(exact.area, 3) },
    { title: "exact volume, Å³", text: () => formatFixed(exact.volume, 3) },
    { title: "Euler characteristic χ", text: () => formatNumber(exact.euler_characteristic) },
    { title: "components", text: () => formatNumber(exact.components) },
    { title: "tunnels", text: () => formatNumber(exact.tunnels) },
    { title: "voids", text: () => formatNumber(exact.voids) },
    { title: "hidden atoms", text: () => formatNumber(exact.hidden_atoms) },
  ], [input]);
}

// The mesh that is shown, the exact figures beside it, and the difference.
function drawSceneTable(element, input, run) {
  if (!run) return element.replaceChildren();
  const { mesh, comparison } = run, exact = exactFigures(input);
  const tunnels = (m) => m.tunnels ?? m.genus;
  const difference = (a, b) => a === null || b === null || a === undefined || b === undefined ? null : a - b;
  const row = (title, value, how) => ({ title, mesh: value(mesh), exact: value(exact), how });
  drawTable(element, [
    { title: "", text: (r) => r.title, align: "text" },
    { title: "this mesh", text: (r) => r.how ? formatFixed(r.mesh, 3) : formatNumber(r.mesh) },
    { title: "exact", text: (r) => r.how ? formatFixed(r.exact, 3) : formatNumber(r.exact) },
    { title: "mesh − exact", text: (r) => r.how ? r.how : formatDifference(difference(r.mesh, r.exact)) },
  ], [
    row("Area, Å²", (m) => m.area, formatPercent(comparison.area_relative_error)),
    row("Volume, Å³", (m) => m.volume, formatPercent(comparison.volume_relative_error)),
    row("Components", (m) => m.components), row("Tunnels", tunnels), row("Voids", (m) => m.voids),
    row("Euler characteristic χ", (m) => m.euler_characteristic),
  ]);
}

function drawOrdersTable(element, input) {
  const order = (name) => (s) => formatFixed(s.by_resolution[name]?.order ?? null, 2);
  drawTable(element, [
    { title: "mesh", text: wayLabel, align: "text" },
    { title: "backend", text: (s) => s.backend, align: "text" },
    { title: "runs", text: (s) => formatNumber(s.runs.length) },
    { title: "area", text: order("area_error") },
    { title: "volume", text: order("volume_error") },
    { title: "mesh → surface rms", text: order("mesh_to_surface_rms") },
    { title: "surface → mesh rms", text: order("surface_to_mesh_rms") },
    { title: "Hausdorff", text: order("hausdorff") },
    { title: "extrapolated area, own order", text: (s) => formatFixed(s.area_extrapolated?.order ?? null, 2) },
    { title: "from exact", text: (s) => formatPercent(s.area_extrapolated_relative_error) },
    { title: "extrapolated volume, own order", text: (s) => formatFixed(s.volume_extrapolated?.order ?? null, 2) },
    { title: "from exact", text: (s) => formatPercent(s.volume_extrapolated_relative_error) },
  ], input.series);
}

function drawRunsTable(element, input) {
  const comparison = (name) => (r) => r.comparison[name];
  const distance = (side, name) => (r) => r.comparison.distances?.[side][name] ?? null;
  const megabytes = (bytes) => bytes === null ? null : bytes / 1e6;
  drawTable(element, [
    { title: "mesh", text: (r) => wayLabel(r.parameters), align: "text" },
    { title: "Å", text: (r) => formatNumber(r.parameters.resolution) },
    { title: "backend", text: (r) => r.parameters.backend, align: "text" },
    { title: "triangles", text: (r) => formatNumber(r.mesh.triangles) },
    { title: "area, Å²", text: (r) => formatFixed(r.mesh.area, 1) },
    { title: "area error", text: (r) => formatPercent(comparison("area_relative_error")(r)) },
    { title: "volume, Å³", text: (r) => formatFixed(r.mesh.volume, 1) },
    { title: "volume error", text: (r) => formatPercent(comparison("volume_relative_error")(r)) },
    { title: "Δχ", text: (r) => formatSigned(comparison("euler_characteristic_difference")(r)) },
    { title: "self-int.", text: (r) => formatNumber(r.mesh.self_intersections) },
    { title: "angle min", text: (r) => formatNumber(r.mesh.min_angle_deg.min, 2) },
    { title: "1 %", text: (r) => formatNumber(r.mesh.min_angle_deg.p01, 2) },
    { title: "median °", text: (r) => formatNumber(r.mesh.min_angle_deg.median, 3) },
    { title: "mesh → surface rms, Å", text: (r) => formatNumber(distance("mesh_to_surface", "rms")(r), 3) },
    { title: "surface → mesh rms, Å", text: (r) => formatNumber(distance("surface_to_mesh", "rms")(r), 3) },
    { title: "Hausdorff ≥, Å", text: (r) => formatNumber(r.comparison.distances?.hausdorff_lower_bound ?? null, 3) },
    { title: "mesh, s", text: (r) => formatNumber(r.timing.mesh, 3) },
    { title: "mesh, MB", text: (r) => formatNumber(megabytes(r.memory.mesh), 3) },
    { title: "peak, MB", text: (r) => formatNumber(megabytes(r.memory.peak), 3) },
  ], input.runs);
}

function drawWarnings(element, input) {
  element.replaceChildren(...input.warnings.map((warning) => {
    const line = document.createElement("p");
    line.className = "error";
    line.textContent = `Warning: ${warning}`;
    return line;
  }));
}

function drawRefused(element, input) {
  if (input.refused.length === 0) return element.replaceChildren();
  drawTable(element, [
    { title: "refused", text: (r) => `${wayLabel(r.parameters)}, ${r.parameters.resolution} Å`, align: "text" },
    { title: "why", text: (r) => r.reason, align: "text" },
  ], input.refused);
}
