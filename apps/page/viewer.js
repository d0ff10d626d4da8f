"use strict";
// A surface in 3D, which mouse, fingers and keys turn.

// Colours between stops, (r, g, b) from 0 to 255, for numbers from 0 to 1.
function colorRamp(stops) {
  return (t) => {
    const place = Math.min(Math.max(t, 0), 1) * (stops.length - 1);
    const low = Math.min(Math.floor(place), stops.length - 2);
    return stops[low].map((c, i) => c + (place - low) * (stops[low + 1][i] - c));
  };
}

// Triangles of their own corners: positions, smooth normals, and a place for colours.
function buildGeometry({ points, corners }) {
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

class Viewer {
  // `label` is read out to people who do not see it.
  constructor(element, label) {
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
    this.controls.enableKeys = false;  // its arrow keys would move what ours turn
    this.controls.addEventListener("change", () => this.render());
    this.listenToKeys(this.renderer.domElement, label);
    window.addEventListener("resize", () => this.resize());
  }

  // What the mouse does, for the keyboard.
  listenToKeys(canvas, label) {
    canvas.tabIndex = 0;
    canvas.setAttribute("role", "img");
    canvas.setAttribute("aria-label", label);
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

  // Shows this surface in place of the one before, from the front.
  showGeometry(geometry) {
    this.remove(this.mesh);
    this.geometry = geometry;
    this.mesh = new THREE.Mesh(geometry, this.material);
    this.world.add(this.mesh);
    this.place();
  }

  remove(part) {
    if (!part) return;
    this.world.remove(part);
    part.geometry.dispose();
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
