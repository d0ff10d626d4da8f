// What the filter of facet_pair.hpp leaves, decided by CGAL's exact predicates.
#pragma once

#include "analysis/facet_pair.hpp"

namespace vdwmesh {

// Whether the triangle has area 0.
bool is_flat_exactly(const Facet& f);

// Whether two facets intersect beyond the vertices that `m` says they share. Precondition: both
// have an area.
bool intersect_exactly(const Facet& a, const Facet& b, const Matching& m);

}  // namespace vdwmesh
