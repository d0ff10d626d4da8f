// The boundary of a concave patch: the parts of its circles that no cap covers.
#pragma once

#include "excluded/patches/concave_patch.hpp"
#include "excluded/patches/patch_circles.hpp"

namespace vdwmesh::excluded {

// Finds the segments of a patch whose sides and caps are known. Returns the smallest margin of its
// decisions: how far circles have to move on the unit sphere to turn one of them around.
template <class T>
double find_segments(ConcavePatch& patch, const PatchCircles<T>& circles);

extern template double find_segments(ConcavePatch& patch, const PatchCircles<double>& circles);
extern template double find_segments(ConcavePatch& patch, const PatchCircles<WideFloat>& circles);

}  // namespace vdwmesh::excluded
