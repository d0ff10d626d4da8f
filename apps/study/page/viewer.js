"use strict";
// The mesh in 3D.

const coolWarm = [[59, 76, 192], [124, 159, 249], [192, 212, 245], [221, 221, 221], [242, 203, 183],
  [238, 132, 104], [180, 4, 38]];

function colorRamp(stops) {
  return (t) => {
    const place = Math.min(Math.max(t, 0), 1) * (stops.length - 1);
    const low = Math.min(Math.floor(place), stops.length - 2);
    return stops[low].map((c, i) => c + (place - low) * (stops[low + 1][i] - c));
  };
}

function schemeRamp(name) {
  const interpolate = vega.scheme(name);
  const stops = [];
  for (let i = 0; i <= 32; ++i) {
    const color = new THREE.Color(interpolate(i / 32));
    stops.push([255 * color.r, 255 * color.g, 255 * color.b]);
  }
  return colorRamp(stops);
}

// Triangles of their own corners: positions, smooth normals, and a place for colours.
function buildGeometry(scene) {
  const { points, corners } = scene;
  const shared = new THREE.BufferGeometry();
  shared.setAttribute("position", new THREE.BufferAttribute(points, 3));
  shared.setIndex(new THREE.BufferAttribute(corners, 1));
  shared.computeVertexNormals();
  const geometry = shared.toNonIndexed();
  geometry.setAttribute("color",
    new THREE.BufferAttribute(new Uint8Array(3 * corners.length), 3, true));
  geometry.computeBoundingSphere();
  return geometry;
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

class Viewer {
  constructor(element, colorbar) {
    this.colorbar = colorbar;
    this.element = element;
    this.renderer = new THREE.WebGLRenderer({ antialias: true });
    this.renderer.setPixelRatio(window.devicePixelRatio);
    element.appendChild(this.renderer.domElement);
    this.world = new THREE.Scene();
    this.world.background = new THREE.Color(0xffffff);
    this.camera = new THREE.PerspectiveCamera(30, 1, 0.1, 10000);
    this.world.add(new THREE.HemisphereLight(0xffffff, 0x8a8f98, 0.62));
    const lamp = new THREE.DirectionalLight(0xffffff, 0.5);
    lamp.position.set(-0.4, 0.7, 1);
    this.camera.add(lamp);
    this.world.add(this.camera);
    this.material = new THREE.MeshLambertMaterial({ vertexColors: THREE.VertexColors });
    this.controls = new THREE.OrbitControls(this.camera, this.renderer.domElement);
    this.controls.addEventListener("change", () => this.render());
    this.listenToKeys(this.renderer.domElement);
    window.addEventListener("resize", () => this.resize());
  }

  // What the mouse does, for the keyboard.
  listenToKeys(canvas) {
    canvas.tabIndex = 0;
    canvas.setAttribute("role", "img");
    canvas.setAttribute("aria-label", "The mesh in 3D. Arrow keys turn it, plus and minus zoom, 0 goes back.");
    const step = Math.PI / 18;
    const moves = { ArrowLeft: [step, 0, 1], ArrowRight: [-step, 0, 1], ArrowUp: [0, step, 1], ArrowDown: [0, -step, 1],
      "+": [0, 0, 1 / 1.2], "=": [0, 0, 1 / 1.2], "-": [0, 0, 1.2] };
    canvas.addEventListener("keydown", (event) => {
      if (event.ctrlKey || event.metaKey || event.altKey || !this.geometry) return;
      if (event.key === "0") this.place();
      else if (moves[event.key]) this.move(...moves[event.key]);
      else return;
      event.preventDefault();
      this.render();
    });
  }

  // Turns the camera around its target, by angles in radians, and changes its distance by a factor.
  move(turn, tilt, factor) {
    const { target } = this.controls;
    const place = new THREE.Spherical().setFromVector3(this.camera.position.clone().sub(target));
    place.theta -= turn;
    place.phi = Math.min(Math.max(place.phi - tilt, 0.01), Math.PI - 0.01);
    place.radius *= factor;
    this.camera.position.setFromSpherical(place).add(target);
    this.controls.update();
  }

  show(scene, coloring, edges) {
    if (this.scene !== scene) {
      this.clear();
      this.scene = scene;
      this.geometry = buildGeometry(scene);
      this.mesh = new THREE.Mesh(this.geometry, this.material);
      this.world.add(this.mesh);
      this.place();
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

  clear() {
    for (const part of [this.mesh, this.lines]) {
      if (!part) continue;
      this.world.remove(part);
      part.geometry.dispose();
    }
    this.lines = null;
  }

  place() {
    const radius = this.geometry.boundingSphere.radius;
    const { clientWidth, clientHeight } = this.element;
    const narrow = Math.min(clientWidth / clientHeight, 1);  // a view that is higher than wide shows less
    const distance = 0.98 * radius / Math.sin(Math.PI * this.camera.fov / 360) / narrow;
    this.camera.position.set(0, 0, distance);
    this.camera.near = distance / 100;
    this.camera.far = 10 * distance;
    this.controls.target.set(0, 0, 0);
    this.controls.update();
  }

  resize() {
    const { clientWidth, clientHeight } = this.element;
    this.renderer.setSize(clientWidth, clientHeight);
    this.camera.aspect = clientWidth / clientHeight;
    this.camera.updateProjectionMatrix();
    this.render();
  }

  render() {
    this.renderer.render(this.world, this.camera);
  }
}
