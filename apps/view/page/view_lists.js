"use strict";
// Figures in words, and the lists of pockets and interfaces.

function countText(count, one) {
  return `${formatNumber(count)} ${count === 1 ? one : one + "s"}`;
}

// Nothing for atoms without a chain, which the program calls "(no chain)".
function chainText(name) {
  return name.endsWith("(no chain)") ? "" : `chain ${name}`;
}

function residueText(s, residue) {
  const { name, number, chain } = s.residues;
  const parts = [name[residue] && `${name[residue]} ${number[residue]}`, chainText(s.chains[chain[residue]])];
  return parts.filter(Boolean).join(", ") || `residue ${residue + 1}`;
}

function atomText(s, atom) {
  const { name, element, residue, serial, area } = s.atoms;
  const symbol = s.elements[element[atom]].element;
  const what = name[atom] ? `${name[atom]} of ${residueText(s, residue[atom])}` : `Atom ${atom + 1}`;
  const which = name[atom] ? `, atom ${serial[atom]}` : "";
  return `${what}${symbol && symbol !== name[atom] ? ` (${symbol})` : ""}${which}: ${formatFixed(area[atom], 2)} Å² exposed` +
    (name[atom] ? `, ${formatFixed(s.residues.area[residue[atom]], 2)} Å² of the residue` : "");
}

function surfaceText(s) {
  if (s.excluded) return `the solvent-excluded surface of a probe of ${formatNumber(s.excluded.probe)} Å`;
  if (s.input.probe) return `the boundary of the atoms grown by a probe of ${formatNumber(s.input.probe)} Å` +
    (s.input.probe > 0 ? " (accessible surface)" : "");
  return "the van der Waals surface, the boundary of the atoms";
}

function atomsText(s) {
  const { input } = s;
  const left = Object.entries(input.skipped).filter(([, n]) => n > 0)
    .map(([why, n]) => `${formatNumber(n)} ${why.replaceAll("_", " ")}`);
  return `${countText(input.atoms_used, "atom")} of ${s.name}` +
    ` in ${countText(s.residues.name.length, "residue")} and ${countText(s.chains.length, "chain")}; radii: ${input.radius_set}.` +
    (left.length > 0 ? ` Left out: ${left.join(", ")}.` : "") + ` Shown is ${surfaceText(s)}.`;
}

// Names and texts of the exact figures.
function figureRows(s) {
  const rows = [], add = (title, value, decimals) => {
    if (value !== null && value !== undefined) rows.push({ title, text: decimals ? formatFixed(value, decimals) : formatNumber(value) });
  };
  const exact = s.excluded ? s.excluded.complete : s.exact;
  add("Exposed area, Å²", exact.area, 3);
  add("Volume, Å³", exact.volume, 3);
  if (s.excluded) {
    add("Contact area, Å²", exact.contact_area, 3);
    add("Saddle area, Å²", exact.saddle_area, 3);
    add("Concave area, Å²", exact.concave_area, 3);
    add("Accessible area, Å²", exact.accessible_area, 3);
    add("Cavities", exact.cavities);
  } else {
    add("Polar area, Å²", exact.polar_area, 3);
    add("Apolar area, Å²", exact.apolar_area, 3);
    add("Components", exact.components);
    add("Tunnels", exact.tunnels);
    add("Voids of this surface", exact.voids);
    add("Area of the voids, Å²", exact.voids ? exact.void_area : null);
    add("Volume of the voids, Å³", exact.voids ? exact.void_volume : null);
    add("Atoms without exposed area", exact.hidden_atoms);
  }
  add("Euler characteristic χ", exact.euler_characteristic);
  return rows;
}

function drawFigures(s) {
  byId("name").textContent = s.name;
  const kinds = ["pocket", "channel", "void"].map((kind) => [s.pockets.filter((p) => p.kind === kind).length, kind]);
  const found = kinds.filter(([n]) => n > 0).map(([n, kind]) => countText(n, kind));
  const exact = s.excluded ? s.excluded.complete : s.exact;
  byId("summary").textContent = [`${countText(s.input.atoms_used, "atom")}, ${formatFixed(exact.area, 1)} Å² exposed, ` +
    `${formatFixed(exact.volume, 1)} Å³`, found.join(", ") || "no pockets",
    s.interfaces ? countText(s.interfaces.length, "interface") : "", `vdwmesh ${s.version}`].filter(Boolean).join(" · ");
  byId("atoms-text").textContent = atomsText(s);
  drawTable(byId("figures"), [{ title: "of the surface shown", text: (r) => r.title, align: "text" },
    { title: "exact", text: (r) => r.text }], figureRows(s));
  const remark = (kind, text) => Object.assign(document.createElement("p"),
    { className: kind === "Warning" ? "error" : "note", textContent: `${kind}: ${text}` });
  byId("remarks").replaceChildren(...s.warnings.map((w) => remark("Warning", w)), ...s.notes.map((n) => remark("Note", n)));
}

// A table whose rows are chosen by their first cell, which is a button, or by a click anywhere.
function drawList(element, columns, rows, choose) {
  drawTable(element, columns, rows);
  [...element.querySelectorAll("tbody tr")].forEach((line, i) => {
    const cell = line.cells[0], button = document.createElement("button");
    button.type = "button";
    button.textContent = cell.textContent;
    button.setAttribute("aria-pressed", "false");
    cell.replaceChildren(button);
    line.addEventListener("click", () => choose(i));
  });
}

function markRow(element, chosen) {
  [...element.querySelectorAll("tbody tr")].forEach((line, i) => {
    line.classList.toggle("chosen", i === chosen);
    line.querySelector("button").setAttribute("aria-pressed", String(i === chosen));
  });
}

function drawPockets(s, choose) {
  byId("pocket-note").textContent = `Places for the centre of a probe of ${formatNumber(s.pocket_probe)} Å ` +
    "that are wider than every way out (discrete flow). Choose one to go there.";
  if (s.pockets.length === 0) {
    byId("pockets").textContent = "There are none.";
    byId("pockets").classList.remove("list");
    return;
  }
  drawList(byId("pockets"), [
    { title: "", text: (p) => `${p.rank}`, align: "text" },
    { title: "kind", text: (p) => p.kind, align: "text" },
    { title: "volume, Å³", text: (p) => formatFixed(p.volume, 2) },
    { title: "area, Å²", text: (p) => formatFixed(p.area, 2) },
    { title: "mouths", text: (p) => formatNumber(p.mouths) },
    { title: "residues", text: (p) => formatNumber(liningResidues(s, p).length) },
  ], s.pockets, choose);
}

function liningResidues(s, pocket) {
  return [...new Set(pocket.lining_atoms.map((atom) => s.atoms.residue[atom]))];
}

// Text, and a button for each residue.
function drawDetail(element, lines, residues, s, chooseResidue) {
  element.hidden = false;
  element.replaceChildren(...lines.map((line) => Object.assign(document.createElement("p"), { textContent: line })));
  const list = document.createElement("div");
  list.className = "residues";
  for (const residue of residues) {
    const button = Object.assign(document.createElement("button"), { type: "button", textContent: residueText(s, residue) });
    button.addEventListener("click", () => chooseResidue(residue));
    list.append(button);
  }
  element.append(list);
}

function drawPocketDetail(s, p, chooseResidue) {
  const mouths = p.mouth_table.map((m) => `${formatFixed(m.area, 2)} Å²`);
  const residues = liningResidues(s, p);
  drawDetail(byId("pocket-detail"), [
    `${p.kind[0].toUpperCase()}${p.kind.slice(1)} ${p.rank}: ${formatFixed(p.volume, 3)} Å³, ${formatFixed(p.area, 3)} Å². ` +
      (mouths.length > 0 ? `${countText(mouths.length, "mouth")} of ${mouths.join(", ")}. ` : "No way out. ") +
      (p.depth_probe === null ? "" : `A ball of ${formatFixed(p.depth_probe, 2)} Å fits at its widest place.`),
    `Lined by ${countText(p.lining_atoms.length, "atom")} of ${countText(residues.length, "residue")}:`], residues, s, chooseResidue);
}

function drawInterfaces(s, choose) {
  byId("interface-section").hidden = !s.interfaces;
  if (!s.interfaces) return;
  byId("interface-note").textContent = `What chains bury of each other's accessible surface, with a probe of ` +
    `${formatNumber(s.pocket_probe)} Å. Choose one to see its atoms.`;
  if (s.interfaces.length === 0) {
    byId("interfaces").textContent = "No two chains touch.";
    byId("interfaces").classList.remove("list");
    return;
  }
  drawList(byId("interfaces"), [
    { title: "chains", text: (i) => `${i.a} – ${i.b}`, align: "text" },
    { title: "buried, Å²", text: (i) => formatFixed(i.buried_area, 2) },
    { title: "contact, Å²", text: (i) => formatFixed(i.contact_area, 2) },
    { title: "residues", text: (i) => `${i.side_a.residues} + ${i.side_b.residues}` },
  ], s.interfaces, choose);
}

function drawInterfaceDetail(s, i, chooseResidue) {
  const residues = [...new Set([...i.buried_atoms_a, ...i.buried_atoms_b].map((atom) => s.atoms.residue[atom]))];
  drawDetail(byId("interface-detail"), [
    `${i.a} loses ${formatFixed(i.buried_a, 3)} Å² to ${i.b}, and ${i.b} ${formatFixed(i.buried_b, 3)} Å² to ${i.a}: ` +
      `${formatFixed(i.buried_area, 3)} Å² are buried.` + (i.buried_polar === null || i.buried_polar === undefined ? ""
      : ` Polar ${formatFixed(i.buried_polar, 1)} Å², apolar ${formatFixed(i.buried_apolar, 1)} Å².`),
    `${countText(i.buried_atoms_a.length + i.buried_atoms_b.length, "atom")} of ${countText(residues.length, "residue")}:`],
  residues, s, chooseResidue);
}
