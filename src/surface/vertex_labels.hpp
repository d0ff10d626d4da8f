// Which spheres the vertices of a mesh lie on.
#pragma once

#include <array>
#include <cassert>
#include <cstddef>
#include <cstdint>

#include "core/buffer.hpp"
#include "spheres/sphere_set.hpp"

namespace vdwmesh {

// The spheres a vertex lies on, unused places kNoSphere: one on a patch, two on the circle of two
// spheres, three at a corner. The first is the vertex's atom. Crease-exact meshes name two or three
// in ascending order.
using VertexSpheres = std::array<SphereId, 3>;

inline constexpr VertexSpheres on_sphere(SphereId id) { return {id, kNoSphere, kNoSphere}; }

// All but the atom.
using OtherSpheres = std::array<SphereId, 2>;
inline constexpr OtherSpheres kNoOthers = {kNoSphere, kNoSphere};

// How many spheres a label has room for: marching cubes names the atom alone, and nothing where the
// field is given.
enum class LabelWidth : std::uint8_t { none, one, three };

constexpr std::uint64_t label_bytes(LabelWidth width) {
  return (width == LabelWidth::none ? 0 : sizeof(SphereId)) +
         (width == LabelWidth::three ? sizeof(OtherSpheres) : 0);
}

// The labels of all vertices.
struct VertexLabels {
  Buffer<SphereId> atoms;       // empty, or one per vertex
  Buffer<OtherSpheres> others;  // empty where no vertex has any, or one per vertex

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

  // Precondition: there is room for the label.
  void set(std::size_t v, const VertexSpheres& label) {
    assert(!others.empty() || label == on_sphere(label[0]));
    atoms[v] = label[0];
    if (!others.empty()) others[v] = {label[1], label[2]};
  }

  // Makes room for `size` labels of that width. Those added have to be written, and without any
  // before they are expected to be soon, see expect_writing().
  void resize(std::size_t size, LabelWidth width);
  void assign(std::size_t size, const VertexSpheres& label);
  // Makes room for three spheres where the label needs it.
  void push_back(const VertexSpheres& label);
  // Room for three spheres; and for one where no label names more.
  void widen();
  void narrow();

  // Of the labels, whatever their room.
  friend bool operator==(const VertexLabels& a, const VertexLabels& b);
};

}  // namespace vdwmesh
