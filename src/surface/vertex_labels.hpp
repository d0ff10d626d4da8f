// VertexLabels: for each vertex of a mesh, the spheres that the vertex lies on.
#pragma once

#include <array>
#include <cassert>
#include <cstddef>
#include <cstdint>

#include "core/buffer.hpp"
#include "spheres/sphere_set.hpp"

namespace vdwmesh {

// One label: the ids of the spheres that a vertex lies on, then kNoSphere for unused elements. A
// vertex inside a patch lies on one sphere, a vertex on the circle of two spheres on two, and a
// vertex at a corner on three. The first id is called the atom of the vertex. In crease-exact
// meshes the ids of two or three spheres are in ascending order.
using VertexSpheres = std::array<SphereId, 3>;

inline constexpr VertexSpheres on_sphere(SphereId id) { return {id, kNoSphere, kNoSphere}; }

// The second and third sphere of a label.
using OtherSpheres = std::array<SphereId, 2>;
inline constexpr OtherSpheres kNoOthers = {kNoSphere, kNoSphere};

// How many sphere ids the arrays can store for each vertex. Marching cubes stores one id, the atom;
// meshes of a field that is given as samples on a grid, without spheres, store none.
enum class LabelWidth : std::uint8_t { none, one, three };

// Bytes of one label in arrays of this width.
constexpr std::uint64_t label_bytes(LabelWidth width) {
  return (width == LabelWidth::none ? 0 : sizeof(SphereId)) +
         (width == LabelWidth::three ? sizeof(OtherSpheres) : 0);
}

// The labels of all vertices.
struct VertexLabels {
  Buffer<SphereId> atoms;       // empty, or one per vertex
  Buffer<OtherSpheres> others;  // one per vertex, or empty if no label names more than the atom

  std::size_t size() const { return atoms.size(); }
  bool empty() const { return atoms.empty(); }
  LabelWidth width() const {
    if (empty()) return LabelWidth::none;
    return others.empty() ? LabelWidth::one : LabelWidth::three;
  }
  VertexSpheres operator[](std::size_t v) const {
    const OtherSpheres more = others.empty() ? kNoOthers : others[v];
    return {atoms[v], more[0], more[1]};
  }

  // Sets the label of vertex v. Precondition: the width of the arrays is enough for the label.
  void set(std::size_t v, const VertexSpheres& label) {
    assert(!others.empty() || label == on_sphere(label[0]));
    atoms[v] = label[0];
    if (!others.empty()) others[v] = {label[1], label[2]};
  }

  // Resizes the arrays to `size` labels of this width. New labels are uninitialised, and the caller
  // must write them. Their pages are prepared for writing (expect_writing() in large_pages.hpp).
  void resize(std::size_t size, LabelWidth width);
  // Replaces all labels by `size` copies of one label.
  void assign(std::size_t size, const VertexSpheres& label);
  // Appends a label; widens the arrays if the label names more than the atom.
  void push_back(const VertexSpheres& label);
  // Makes the arrays wide enough for three spheres per vertex. An empty container stays as it is.
  void widen();
  // Frees the array `others` if no label names more than the atom.
  void narrow();

  // Compares the labels; the widths of the arrays do not matter.
  friend bool operator==(const VertexLabels& a, const VertexLabels& b);
};

}  // namespace vdwmesh
