// The circles that bound a concave patch, in any number type: those of its caps, and the great
// circles of its sides. For the library's own use.
#pragma once

#include <array>
#include <vector>

#include "excluded/patches/cap_arrangement.hpp"
#include "excluded/patches/concave_patch.hpp"
#include "excluded/probes/wide_probes.hpp"

namespace vdwmesh::excluded {

// By Newton's method from the root in double, with an error of some 2^-330 of it: the library's own
// takes 30 times as long.
template <>
WideFloat root_of(const WideFloat& x);

template <class T>
struct SideCircle {
  Vector<T> inward;               // as PatchSide
  std::array<Vector<T>, 2> cusp;  // of a spindle
};

// In the order of the patch's caps and sides.
template <class T>
struct PatchCircles {
  std::vector<CapCircle<T>> caps;
  std::vector<SideCircle<T>> sides;
};

PatchCircles<double> circles_in_double(const ConcavePatch& patch);

// Computes the circles from the balls of the atoms, and writes them, rounded, to the patch. To
// break ties, the probes' radii are made slightly different, by their numbers. If another probe is
// in the same place, the patch is marked as not certified.
PatchCircles<WideFloat> circles_in_wide(const AccessibleSurface& surface, ConcavePatch& patch);

}  // namespace vdwmesh::excluded
