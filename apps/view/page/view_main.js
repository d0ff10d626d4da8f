"use strict";
// Puts the page together: what is chosen, and who shows it.

const state = { structure: null, viewer: null, plots: [], chosen: {} };

async function readStructure() {
  const s = await unpackJson("structure");
  const bytes = await unpack("mesh"), { mesh } = s;
  const { points, corners, offset } = readMesh(bytes, mesh);
  Object.assign(s, { points, corners, triangleAtoms: readPlanes(bytes, offset, mesh.triangles, 4) });
  if (mesh.has_kinds) s.kinds = bytes.subarray(offset + 4 * mesh.triangles);
  // Places about the middle of the mesh, as its points.
  const middle = [0, 1, 2].map((axis) => (mesh.lower[axis] + mesh.upper[axis]) / 2);
  ["x", "y", "z"].forEach((axis, k) => { s.atoms[axis] = Float64Array.from(s.atoms[axis], (v) => v - middle[k]); });
  for (const p of s.pockets) p.spheres = p.spheres.map((v, i) => i % 4 < 3 ? v - middle[i % 4] : v);
  s.pocketOfAtom = new Int32Array(s.atoms.x.length).fill(-1);
  [...s.pockets].reverse().forEach((p) => p.lining_atoms.forEach((atom) => { s.pocketOfAtom[atom] = p.rank - 1; }));
  s.broadArea = quantile(s.residues.area, 0.95);
  return s;
}

function pointOf(atom) {
  const { x, y, z } = state.structure.atoms;
  return new THREE.Vector3(x[atom], y[atom], z[atom]);
}

function atomsOf(residue) {
  const found = [];
  state.structure.atoms.residue.forEach((r, atom) => r === residue && found.push(atom));
  return found;
}

function showTip(text, event) {
  const tip = byId("tip");
  tip.hidden = !text;
  if (!text) return;
  tip.textContent = text;
  tip.style.left = `${Math.min(event.clientX + 14, window.innerWidth - tip.offsetWidth - 6)}px`;
  tip.style.top = `${event.clientY + tip.offsetHeight + 24 > window.innerHeight ? event.clientY - tip.offsetHeight - 10 : event.clientY + 16}px`;
}

const roomColor = [240, 136, 62];

// What the colours of the choice mean, or else those of the coloring.
function legendEntries() {
  const s = state.structure, { pocket, interface: pair } = state.chosen;
  if (pocket !== undefined) return [["atoms that line it", seriesColors[0]], ["room for the probe", roomColor]];
  if (pair !== undefined) {
    const { a, b } = s.interfaces[pair];
    return [[`${a}, buried by ${b}`, seriesColors[0]], [`${b}, buried by ${a}`, seriesColors[1]]];
  }
  return colorings[byId("coloring").value].legend(s);
}

function drawLegend() {
  const entries = legendEntries(), legend = byId("legend");
  const swatch = (color) => {
    const element = document.createElement("span");
    element.className = "swatch";
    element.style.background = `rgb(${color.map(Math.round).join(",")})`;
    return element;
  };
  if (entries.ramp) {
    const ramp = document.createElement("span"), stops = [0, 0.25, 0.5, 0.75, 1].map((t) => `rgb(${entries.ramp(t).map(Math.round)})`);
    ramp.className = "ramp";
    ramp.style.background = `linear-gradient(to right, ${stops.join(",")})`;
    const line = document.createElement("span");
    line.append(entries.from, ramp, entries.to);
    return legend.replaceChildren(line);
  }
  const most = 14;
  legend.replaceChildren(...entries.slice(0, most).map(([name, color]) => {
    const entry = document.createElement("span");
    entry.append(swatch(color), name);
    return entry;
  }), ...(entries.length > most ? [`and ${entries.length - most} more`] : []));
}

// Colours of the atoms that are chosen, and the spheres that show them.
function shownOf({ pocket, interface: pair, residue }) {
  const s = state.structure, highlights = new Map(), spheres = [];
  const sphereOf = (atom, color) => [s.atoms.x[atom], s.atoms.y[atom], s.atoms.z[atom], s.atoms.radius[atom], color];
  if (pocket !== undefined) {
    const p = s.pockets[pocket];
    for (const atom of p.lining_atoms) highlights.set(atom, seriesColors[0]);
    for (let i = 0; i < p.spheres.length; i += 4) spheres.push([...p.spheres.slice(i, i + 4), roomColor]);
  }
  if (pair !== undefined) {
    const { buried_atoms_a: a, buried_atoms_b: b } = s.interfaces[pair];
    for (const [atoms, color] of [[a, seriesColors[0]], [b, seriesColors[1]]]) {
      for (const atom of atoms) highlights.set(atom, color), spheres.push(sphereOf(atom, color));
    }
  }
  if (residue !== undefined) for (const atom of atomsOf(residue)) highlights.set(atom, roomColor);
  return { highlights, spheres };
}

function showChosen() {
  const { chosen, viewer } = state;
  if (viewer) {
    const { highlights, spheres } = shownOf(chosen);
    viewer.color(byId("coloring").value, highlights);
    viewer.showSpheres(spheres);
    drawLegend();
  }
  markRow(byId("pockets"), chosen.pocket ?? -1);
  markRow(byId("interfaces"), chosen.interface ?? -1);
  if (chosen.pocket === undefined && !chosen.within) byId("pocket-detail").hidden = true;
  if (chosen.interface === undefined && !chosen.within) byId("interface-detail").hidden = true;
  for (const plot of state.plots) plot.show(chosen.residue ?? -1);
  byId("clear").disabled = Object.keys(chosen).length === 0;
}

function fly(points) {
  if (state.viewer && points.length > 0) state.viewer.flyTo(points);
}

function choosePocket(number) {
  const p = state.structure.pockets[number], points = [];
  state.chosen = { pocket: number };
  showChosen();
  drawPocketDetail(state.structure, p, (residue) => chooseResidue(residue, true, true));
  byId("picked").textContent = `${p.kind[0].toUpperCase()}${p.kind.slice(1)} ${p.rank}, ${formatFixed(p.volume, 2)} Å³`;
  for (let i = 0; i < p.spheres.length; i += 4) points.push(new THREE.Vector3(...p.spheres.slice(i, i + 3)));
  fly(points.length > 0 ? points : p.lining_atoms.map(pointOf));
}

function chooseInterface(number) {
  const pair = state.structure.interfaces[number];
  state.chosen = { interface: number };
  showChosen();
  drawInterfaceDetail(state.structure, pair, (residue) => chooseResidue(residue, true, true));
  byId("picked").textContent = `Interface ${pair.a} – ${pair.b}, ${formatFixed(pair.buried_area, 2)} Å² buried`;
  fly([...pair.buried_atoms_a, ...pair.buried_atoms_b].map(pointOf));
}

// `within`: from the residues of a list, which stay.
function chooseResidue(residue, flies, within) {
  const s = state.structure;
  state.chosen = { residue, ...(within ? { within } : {}) };
  showChosen();
  byId("picked").textContent = `${residueText(s, residue)}: ${formatFixed(s.residues.area[residue], 2)} Å² exposed`;
  if (flies) fly(atomsOf(residue).map(pointOf));
}

function clearChosen() {
  state.chosen = {};
  byId("picked").textContent = "";
  showChosen();
}

// The atom under the mouse, once for each picture; a click, which is no drag, chooses its residue.
function listenToMouse(viewer) {
  const canvas = viewer.renderer.domElement;
  let waiting = null, pressed = null;
  canvas.addEventListener("pointermove", (event) => {
    if (event.pointerType === "touch") return;
    if (event.buttons !== 0) return showTip("");
    if (!waiting) requestAnimationFrame(() => {
      const atom = viewer.atomAt(waiting.clientX, waiting.clientY);
      showTip(atom < 0 ? "" : atomText(state.structure, atom), waiting);
      waiting = null;
    });
    waiting = event;
  });
  canvas.addEventListener("pointerleave", () => showTip(""));
  canvas.addEventListener("pointerdown", (event) => { pressed = event; });
  canvas.addEventListener("pointerup", (event) => {
    if (!pressed || event.button !== 0 || Math.hypot(event.clientX - pressed.clientX, event.clientY - pressed.clientY) > 5) return;
    const atom = viewer.atomAt(event.clientX, event.clientY);
    if (atom < 0) return clearChosen();
    chooseResidue(state.structure.atoms.residue[atom], false);
    byId("picked").textContent = atomText(state.structure, atom);
  });
}

// A browser without WebGL still gets everything else.
function makeViewer() {
  try {
    state.viewer = new StructureViewer(byId("view"), state.structure);
    listenToMouse(state.viewer);
  } catch (error) {
    const text = Object.assign(document.createElement("p"),
      { className: "error", textContent: "The 3D view needs WebGL: " + error.message });
    byId("view").replaceChildren(text);
    byId("view").classList.add("missing");
    byId("controls").hidden = true;
  }
}

// Plots are made for the width of the window.
function redrawWhenResized() {
  let drawn = window.innerWidth, timer = null;
  window.addEventListener("resize", () => {
    clearTimeout(timer);
    timer = setTimeout(() => {
      if (window.innerWidth === drawn) return;
      drawn = window.innerWidth;
      state.plots = drawPlots(state.structure, chooseResidue);
      showChosen();
    }, 200);
  });
}

async function start() {
  const s = state.structure = await readStructure();
  const usable = Object.entries(colorings).filter(([key]) => (key !== "kind" || s.kinds) && (key !== "pocket" || s.pockets.length > 0) &&
    (key !== "chain" || s.chains.length > 1) && (!["residue", "area"].includes(key) || s.residues.name.length > 1));
  byId("coloring").replaceChildren(...usable.map(([key, { title }]) => new Option(title, key)));
  if (s.chains.length > 1) byId("coloring").value = "chain";
  drawFigures(s);
  drawPockets(s, choosePocket);
  drawInterfaces(s, chooseInterface);
  state.plots = drawPlots(s, chooseResidue);
  makeViewer();
  byId("coloring").addEventListener("change", showChosen);
  byId("whole").addEventListener("click", () => state.viewer.place());
  byId("clear").addEventListener("click", clearChosen);
  document.addEventListener("keydown", (event) => event.key === "Escape" && clearChosen());
  redrawWhenResized();
  showChosen();
  document.body.dataset.drawn = "yes";
}

start().catch((error) => {
  byId("error").textContent = "The page could not be drawn: " + error.message;
  byId("error").hidden = false;
  throw error;
});
