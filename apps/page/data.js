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

// Positions in Å about the middle of the mesh's box, the vertices of its triangles, and where the bytes
// behind them begin.
function readMesh(bytes, { vertices, triangles, lower, upper }) {
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
  return { points, corners, offset: offset + 12 * triangles };
}
