"use strict";
// A mesh of the study in 3D, and what its colours mean.

const coolWarm = [[59, 76, 192], [124, 159, 249], [192, 212, 245], [221, 221, 221], [242, 203, 183],
  [238, 132, 104], [180, 4, 38]];

function schemeRamp(name) {
  const interpolate = vega.scheme(name);
  const stops = [];
  for (let i = 0; i <= 32; ++i) {
    const color = new THREE.Color(interpolate(i / 32));
    stops.push([255 * color.r, 255 * color.g, 255 * color.b]);
  }
  return colorRamp(stops);
}

function colorGeometry(scene, geometry, coloring) {
  const colors = geometry.getAttribute("color");
  const ramp = coloring === "distance" ? colorRamp(coolWarm) : schemeRamp("viridis");
  const values = coloring === "distance" ? scene.distances : scene.angles;
  const table = [];
  for (let i = 0; i < 256; ++i) table.push(ramp(i / 255));
  const elements = scene.description.elements.map((e) => e.color);
  for (let corner = 0; corner < scene.corners.length; ++corner) {
    const color = coloring === "atom" ? elements[scene.elements[scene.corners[corner]]]
      : table[values[Math.floor(corner / 3)]];
    colors.array.set(color, 3 * corner);
  }
  colors.needsUpdate = true;
  return ramp;
}

function drawColorbar(element, scene, coloring, ramp) {
  element.replaceChildren();
  if (coloring === "atom") {
    for (const { element: symbol, color } of scene.description.elements) {
      const swatch = document.createElement("span");
      swatch.className = "swatch";
      swatch.style.background = `rgb(${color.join(",")})`;
      element.append(swatch, symbol);
    }
    return;
  }
  const canvas = document.createElement("canvas");
  canvas.width = 256;
  canvas.height = 1;
  const context = canvas.getContext("2d");
  for (let i = 0; i < 256; ++i) {
    context.fillStyle = `rgb(${ramp(i / 255).map(Math.round).join(",")})`;
    context.fillRect(i, 0, 1, 1);
  }
  const ticks = document.createElement("div");
  ticks.className = "ticks";
  const range = scene.description.distance_range;
  const labels = coloring === "angle" ? ["0°", "15°", "30°", "45°", "60°"]
    : [`≤ −${range.toPrecision(2)} Å, inside`, "0", `outside, ≥ ${range.toPrecision(2)} Å`];
  for (const label of labels) {
    const tick = document.createElement("span");
    tick.textContent = label;
    ticks.appendChild(tick);
  }
  element.append(canvas, ticks);
}

class MeshViewer extends Viewer {
  constructor(element, colorbar) {
    super(element, "The mesh in 3D. Arrow keys turn it, plus and minus zoom, 0 goes back.");
    this.colorbar = colorbar;
  }

  show(scene, coloring, edges) {
    if (this.scene !== scene) {
      this.remove(this.lines);
      this.lines = null;
      this.scene = scene;
      this.showGeometry(buildGeometry(scene));
    }
    drawColorbar(this.colorbar, scene, coloring, colorGeometry(scene, this.geometry, coloring));
    if (edges && !this.lines) {
      const material = new THREE.LineBasicMaterial({ color: 0x000000, transparent: true, opacity: 0.35 });
      this.lines = new THREE.LineSegments(new THREE.WireframeGeometry(this.geometry), material);
      this.world.add(this.lines);
    }
    if (this.lines) this.lines.visible = edges;
    this.resize();
  }
}
