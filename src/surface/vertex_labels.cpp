// The labels of vertices in two arrays, so that labels of one sphere take 4 bytes instead of 12.
//
// Most meshes name only the atom of each vertex, the first sphere of its label. The array `others`,
// with the second and third sphere of every label, is allocated at the first label that needs it
// (push_back(), widen()), and narrow() frees it if no label needs it. Two containers are equal if
// their labels are, whether or not one of them stores unused second and third spheres.
#include "surface/vertex_labels.hpp"

#include "core/large_pages.hpp"

namespace vdwmesh {
namespace {

OtherSpheres others_of(const VertexSpheres& label) { return {label[1], label[2]}; }

// Returns whether every id in the array is kNoSphere; true for an empty array.
bool has_none(const Buffer<OtherSpheres>& others) {
  // kNoSphere has all bits set, so the bitwise "and" of all ids is kNoSphere only if every id is.
  SphereId bits = kNoSphere;
  for (const auto& [second, third] : others) bits &= second & third;
  return bits == kNoSphere;
}

}  // namespace

void VertexLabels::resize(std::size_t size, LabelWidth width) {
  resize_untouched(atoms, width == LabelWidth::none ? 0 : size);
  resize_untouched(others, width == LabelWidth::three ? size : 0);
}

void VertexLabels::assign(std::size_t size, const VertexSpheres& label) {
  atoms.assign(size, label[0]);
  others.clear();
  if (others_of(label) != kNoOthers) others.assign(size, others_of(label));
}

void VertexLabels::push_back(const VertexSpheres& label) {
  // The width of an empty container is `none` even after widen(), so has_others is tested as well.
  const bool has_others = others_of(label) != kNoOthers;
  if (has_others) widen();
  const bool is_wide = has_others || width() == LabelWidth::three;
  atoms.push_back(label[0]);
  if (is_wide) others.push_back(others_of(label));
}

void VertexLabels::widen() {
  if (others.empty()) others.assign(atoms.size(), kNoOthers);
}

void VertexLabels::narrow() {
  // `= {}` would leave it its memory.
  if (has_none(others)) others = Buffer<OtherSpheres>();
}

// If the widths differ, one of the two arrays `others` is empty and stands for unused spheres only;
// the labels are equal if the other array has none but unused spheres.
bool operator==(const VertexLabels& a, const VertexLabels& b) {
  if (a.atoms != b.atoms) return false;
  if (a.width() == b.width()) return a.others == b.others;
  return has_none(a.others) && has_none(b.others);
}

}  // namespace vdwmesh
