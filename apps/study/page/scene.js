"use strict";
// The meshes of a study, and what they are called.

// A mesh with what its colours show.
async function readScene(number, description) {
  const bytes = await unpack("scene-" + number);
  const { vertices, triangles } = description;
  let { points, corners, offset } = readMesh(bytes, description);
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
