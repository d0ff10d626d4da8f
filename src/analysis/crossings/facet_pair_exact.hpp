// What the filter of facet_pair.hpp leaves, decided by CGAL's exact predicates, and both of them
// together.
#pragma once

#include "analysis/crossings/facet_pair.hpp"

namespace vdwmesh {

// Whether the triangle has area 0.
bool is_flat_exactly(const Facet& f);

// Whether two facets intersect beyond the vertices that `m` says they share. Precondition: both
// have an area.
bool intersect_exactly(const Facet& a, const Facet& b, const Matching& m);

// Whether two facets intersect beyond the vertices that they share by index. Precondition: both
// have an area.
inline bool do_intersect(const Facet& a, const Facet& b) {
  const Matching& m = match(a.vertex, b.vertex);
  const Meeting found = meeting(a, b, m);
  return found == Meeting::unsure ? intersect_exactly(a, b, m) : found == Meeting::intersect;
}

}  // namespace vdwmesh
