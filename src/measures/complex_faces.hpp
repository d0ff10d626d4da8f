// The faces that balls share, from their triangulation: for balls that the arcs cannot measure. For
// the library's own use.
#pragma once

#include <span>
#include <vector>

#include "measures/arcs/shared_face.hpp"
#include "measures/exact_union.hpp"
#include "measures/reference_measures.hpp"

namespace vdwmesh {

// Shows the wanted balls, which stand in any order, and their faces to the visitor, one by one, and
// stores their measures as per_sphere[id]. `near`: as of set_reference_measures().
void visit_by_triangulation(std::span<const SphereId> wanted, std::vector<NumberedBall> near,
                            std::span<SphereMeasures> per_sphere, FaceVisitor& visitor);

}  // namespace vdwmesh
