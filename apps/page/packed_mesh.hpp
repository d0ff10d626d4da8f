// Meshes as bytes of a page. Numbers of one place value stand together, each less the one before
// it, because the page is packed, and differences of neighbours pack better than the numbers.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "report/json_text.hpp"
#include "spheres/box.hpp"
#include "surface/indexed_mesh.hpp"

namespace vdwmesh::apps {

// Appends the low bytes of all values, then the next ones, and so on: equal high bytes stand
// together and pack well. Each value is less the one before it, modulo its width.
template <class T>
void append_planes(const std::vector<T>& values, std::string& bytes) {
  for (std::size_t plane = 0; plane < sizeof(T); ++plane) {
    T last = 0;
    for (const T value : values) {
      bytes += static_cast<char>(static_cast<T>(value - last) >> (8 * plane) & 0xff);
      last = value;
    }
  }
}

// Appends the positions of the vertices, in 16 bits of their box for each axis, and the vertices of
// the triangles, in 32 bits. Returns the box, Å.
Box append_mesh(const IndexedMesh& mesh, std::string& bytes);

// Writes what the page needs to read these bytes: "vertices", "triangles", "lower" and "upper".
void describe_packed(JsonText& json, const IndexedMesh& mesh, const Box& box);

}  // namespace vdwmesh::apps
