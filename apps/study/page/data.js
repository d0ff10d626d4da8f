"use strict";
// What the program wrote into the page.

async function unpack(id) {
  const text = document.getElementById(id).textContent;
  const packed = Uint8Array.from(atob(text), (c) => c.charCodeAt(0));
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("deflate"));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

async function unpackJson(id) {
  return JSON.parse(new TextDecoder().decode(await unpack(id)));
}

// Numbers were written as byte planes of differences, low bytes first.
function readPlanes(bytes, offset, count, width) {
  const values = width === 2 ? new Uint16Array(count) : new Uint32Array(count);
  let last = 0;
  for (let i = 0; i < count; ++i) {
    let difference = 0;
    for (let plane = 0; plane < width; ++plane) {
      difference |= bytes[offset + plane * count + i] << (8 * plane);
    }
    values[i] = last + difference;
    last = values[i];
  }
  return values;
}

// Triangles that share no vertex, so that each has a colour of its own, with smooth normals.
async function readScene(number, description) {
  const bytes = await unpack("scene-" + number);
  const { vertices, triangles, lower, upper } = description;
  const points = new Float32Array(3 * vertices);
  let offset = 0;
  for (let axis = 0; axis < 3; ++axis) {
    const steps = readPlanes(bytes, offset, vertices, 2);
    offset += 2 * vertices;
    const scale = (upper[axis] - lower[axis]) / 65535;
    const middle = (upper[axis] - lower[axis]) / 2;
    for (let v = 0; v < vertices; ++v) points[3 * v + axis] = steps[v] * scale - middle;
  }
  const corners = readPlanes(bytes, offset, 3 * triangles, 4);
  offset += 12 * triangles;
  const elements = bytes.subarray(offset, (offset += vertices));
  const distances = bytes.subarray(offset, (offset += triangles));
  const angles = bytes.subarray(offset, (offset += triangles));
  return { description, points, corners, elements, distances, angles };
}

function relative(a, b) {
  return a === null || b === null ? null : (a - b) / b;
}

const fieldNames = { vdw: "union of spheres", blinn: "Blinn", soft: "soft object",
  "inverse-squared": "inverse squared" };

function fieldLabel(parameters) {
  return parameters.mesher === "exact" ? "crease-exact" : fieldNames[parameters.field];
}

function wayLabel(parameters) {
  const level = parameters.subdivide;
  if (level === 0) return fieldLabel(parameters);
  const target = { vdw: "onto the union", field: "onto the field", none: "not projected" };
  return `${fieldLabel(parameters)}, ${level} × subdivided, ${target[parameters.project]}`;
}

function seriesId(parameters) {
  return [parameters.mesher, parameters.field, parameters.project, parameters.subdivide,
    parameters.backend].join(" ");
}
