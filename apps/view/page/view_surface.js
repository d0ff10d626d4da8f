"use strict";
// The surface of the structure in 3D: its colours, the atom under the mouse, and flights to places.

// Okabe and Ito's colours, which people with colour-blindness can tell apart; then hues in turn.
const seriesColors = [[86, 180, 233], [230, 159, 0], [0, 158, 115], [204, 121, 167], [240, 228, 66], [0, 114, 178],
  [213, 94, 0]];
// Of PatchKind, in its order; the colours are those of render (apps/steps/picture.cpp).
const kindColors = [[140, 191, 230], [242, 191, 77], [204, 120, 166]];
const kindNames = ["contact (on an atom)", "saddle (between two atoms)", "concave (between three)"];
const plainColor = [204, 204, 199], fadedColor = [150, 156, 163];
const viridis = colorRamp([[68, 1, 84], [59, 82, 139], [33, 145, 140], [94, 201, 98], [253, 231, 37]]);

const residueClasses = [
  ["hydrophobic", [225, 170, 80], "ALA VAL LEU ILE MET PHE TRP PRO GLY"],
  ["polar", [110, 190, 120], "SER THR CYS TYR ASN GLN"],
  ["acidic", [214, 75, 75], "ASP GLU"],
  ["basic", [80, 120, 220], "LYS ARG HIS"],
  ["nucleotide", [150, 110, 200], "A C G U I DA DC DG DT DU DI"],
  ["other", [160, 160, 160], ""],
];

function seriesColor(i) {
  if (i < seriesColors.length) return seriesColors[i];
  const color = new THREE.Color().setHSL((i * 0.618034) % 1, 0.5, 0.6);
  return [255 * color.r, 255 * color.g, 255 * color.b];
}

function classOf(name) {
  const found = residueClasses.findIndex(([, , names]) => names.split(" ").includes(name));
  return name && found >= 0 ? found : residueClasses.length - 1;
}

function quantile(values, share) {
  const sorted = Float64Array.from(values).sort();
  return sorted[Math.floor(share * (sorted.length - 1))] || 1;
}

// What colours may show: a colour for each atom, or, of patches, each triangle, and the entries of the legend.
const colorings = {
  element: { title: "element",
    atom: (s, i) => s.elements[s.atoms.element[i]].color,
    legend: (s) => s.elements.map((e) => [e.element, e.color]) },
  chain: { title: "chain",
    atom: (s, i) => seriesColor(s.residues.chain[s.atoms.residue[i]]),
    legend: (s) => s.chains.map((name, i) => [name, seriesColor(i)]) },
  residue: { title: "residue",
    atom: (s, i) => residueClasses[classOf(s.residues.name[s.atoms.residue[i]])][1],
    legend: (s) => [...new Set(s.residues.name.map(classOf))].sort().map((c) => residueClasses[c].slice(0, 2)) },
  area: { title: "exposed area of the residue",
    atom: (s, i) => viridis(s.residues.area[s.atoms.residue[i]] / s.broadArea),
    legend: (s) => ({ ramp: viridis, from: "0", to: `≥ ${formatNumber(s.broadArea, 3)} Å²` }) },
  pocket: { title: "pocket",
    atom: (s, i) => s.pocketOfAtom[i] >= 0 ? seriesColor(s.pocketOfAtom[i]) : plainColor,
    legend: (s) => s.pockets.map((p, i) => [`${p.rank}`, seriesColor(i)]) },
  kind: { title: "kind of patch", triangle: (s, t) => kindColors[s.kinds[t]],
    legend: () => kindNames.map((name, i) => [name, kindColors[i]]) },
  plain: { title: "plain", atom: () => plainColor, legend: () => [] },
};

function mixed(a, b, share) {
  return a.map((x, i) => x + share * (b[i] - x));
}

// Low spheres, one mesh: [x, y, z, radius, color].
function buildSpheres(spheres) {
  const model = new THREE.IcosahedronBufferGeometry(1, spheres.length > 2000 ? 1 : 2).getAttribute("position");
  const count = model.count, corners = spheres.length * count;
  const positions = new Float32Array(3 * corners), normals = new Float32Array(3 * corners);
  const colors = new Uint8Array(3 * corners);
  spheres.forEach(([x, y, z, radius, color], s) => {
    for (let v = 0; v < count; ++v) {
      const at = 3 * (s * count + v);
      for (let axis = 0; axis < 3; ++axis) {
        const n = model.array[3 * v + axis];
        normals[at + axis] = n;
        positions[at + axis] = [x, y, z][axis] + radius * n;
        colors[at + axis] = color[axis];
      }
    }
  });
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute("position", new THREE.BufferAttribute(positions, 3));
  geometry.setAttribute("normal", new THREE.BufferAttribute(normals, 3));
  geometry.setAttribute("color", new THREE.BufferAttribute(colors, 3, true));
  return geometry;
}

class StructureViewer extends Viewer {
  constructor(element, structure) {
    super(element, "The surface in 3D. Arrow keys turn it, plus and minus zoom, 0 shows all of it, Escape clears the selection.");
    this.structure = structure;
    const geometry = buildGeometry(structure);
    if (structure.mesh.follows_creases) this.takeNormalsOfSpheres(geometry);
    this.showGeometry(geometry);
    // Drawn before the surface when that is translucent, so that only its front is seen.
    this.front = new THREE.Mesh(geometry, new THREE.MeshBasicMaterial({ colorWrite: false, transparent: true }));
    this.front.renderOrder = 1;
    this.front.visible = false;
    this.world.add(this.front);
    this.mesh.renderOrder = 2;
    this.raycaster = new THREE.Raycaster();
    const scheme = window.matchMedia("(prefers-color-scheme: dark)");
    const follow = () => this.takeBackground();
    scheme.addEventListener("change", follow);
    follow();
  }

  takeBackground() {
    this.world.background.set(getComputedStyle(this.element).backgroundColor);
    this.render();
  }

  // Light changes abruptly at creases: each triangle has the normals of its atom's sphere.
  takeNormalsOfSpheres(geometry) {
    const { atoms, triangleAtoms } = this.structure;
    const p = geometry.getAttribute("position").array, n = geometry.getAttribute("normal").array;
    for (let i = 0; i < p.length; i += 3) {
      const atom = triangleAtoms[Math.floor(i / 9)];
      const x = p[i] - atoms.x[atom], y = p[i + 1] - atoms.y[atom], z = p[i + 2] - atoms.z[atom];
      const length = Math.hypot(x, y, z) || 1;
      n[i] = x / length;
      n[i + 1] = y / length;
      n[i + 2] = z / length;
    }
  }

  // `highlights`: atom -> colour. Where there are any, the other atoms fade.
  color(coloring, highlights) {
    const { structure } = this, { triangleAtoms } = structure;
    const { atom, triangle } = colorings[coloring];
    const colors = this.geometry.getAttribute("color");
    const shown = (color) => highlights.size > 0 ? mixed(color, fadedColor, 0.55) : color;
    const ofAtoms = Array.from(structure.atoms.x, (_, i) => highlights.get(i) ?? (atom ? shown(atom(structure, i)) : null));
    for (let t = 0; t < triangleAtoms.length; ++t) {
      const color = ofAtoms[triangleAtoms[t]] ?? shown(triangle(structure, t));
      for (let corner = 0; corner < 3; ++corner) colors.array.set(color, 9 * t + 3 * corner);
    }
    colors.needsUpdate = true;
    this.render();
  }

  // Spheres inside a surface through which they are seen; none: the surface alone.
  showSpheres(spheres) {
    this.remove(this.spheres);
    this.spheres = null;
    const isOpen = spheres.length > 0;
    this.front.visible = isOpen;
    Object.assign(this.material, { transparent: isOpen, opacity: isOpen ? 0.32 : 1 });
    this.material.needsUpdate = true;
    if (isOpen) {
      const material = new THREE.MeshLambertMaterial({ vertexColors: THREE.VertexColors });
      this.spheres = new THREE.Mesh(buildSpheres(spheres), material);
      this.world.add(this.spheres);
    }
    this.render();
  }

  // The atom whose part of the surface is at this place of the window; -1: none.
  atomAt(clientX, clientY) {
    const box = this.renderer.domElement.getBoundingClientRect();
    const place = { x: 2 * (clientX - box.left) / box.width - 1, y: 1 - 2 * (clientY - box.top) / box.height };
    this.raycaster.setFromCamera(place, this.camera);
    const [hit] = this.raycaster.intersectObject(this.mesh);
    return hit ? this.structure.triangleAtoms[hit.faceIndex] : -1;
  }

  // Moves the camera so that it looks at the points, from outside the structure.
  flyTo(points) {
    const target = new THREE.Vector3();
    for (const p of points) target.add(p);
    target.divideScalar(points.length || 1);
    const reach = Math.max(4, ...points.map((p) => p.distanceTo(target)));
    const outward = target.length() > 1 ? target.clone().normalize() : this.camera.position.clone().normalize();
    const near = 2.2 * reach / Math.sin(Math.PI * this.camera.fov / 360) / Math.min(this.camera.aspect, 1);
    const distance = Math.max(near, 1.3 * this.geometry.boundingSphere.radius - target.length());  // stays outside
    this.glide(target, target.clone().addScaledVector(outward, distance));
  }

  // From here to there in half a second, around the structure and not through it.
  glide(target, position) {
    cancelAnimationFrame(this.gliding);
    const still = window.matchMedia("(prefers-reduced-motion: reduce)").matches;
    const from = this.camera.position.clone(), fromTarget = this.controls.target.clone(), begin = performance.now();
    const step = (now) => {
      const t = still ? 1 : Math.min(Math.max(now - begin, 0) / 500, 1), s = t * t * (3 - 2 * t);
      const length = (1 - s) * from.length() + s * position.length();
      this.controls.target.lerpVectors(fromTarget, target, s);
      this.camera.position.lerpVectors(from, position, s).setLength(t === 1 ? position.length() : length);
      this.controls.update();
      this.render();
      if (t < 1) this.gliding = requestAnimationFrame(step);
      this.element.dataset.gliding = t < 1 ? "yes" : "no";
    };
    step(begin);
  }

  place() {
    cancelAnimationFrame(this.gliding);
    super.place();
    this.resize();
  }
}
