// The labels of vertices in two arrays, so that labels of one sphere take 4 bytes instead of 12.
//
// Most meshes name only the atom of each vertex. The array `others`, with the second and third
// sphere, is allocated at the first label that needs it (push_back(), widen()), and narrow() frees
// it if no label needs it. Two containers are equal if their labels are, whether or not one of
// them stores unused second and third spheres.
#include "surface/vertex_labels.hpp"

#include "core/large_pages.hpp"

namespace vdwmesh {
namespace {

OtherSpheres others_of(const VertexSpheres& label) { return {label[1], label[2]}; }

bool has_none(const Buffer<OtherSpheres>& others) {
  // kNoSphere has all bits set, so the conjunction keeps all bits only if every id is kNoSphere.
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
  if (has_none(others)) others = {};
}

bool operator==(const VertexLabels& a, const VertexLabels& b) {
  if (a.atoms != b.atoms) return false;
  if (a.width() == b.width()) return a.others == b.others;
  return has_none(a.others) && has_none(b.others);
}

}  // namespace vdwmesh
