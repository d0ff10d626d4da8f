// Which arcs of the accessible surface are without length, so that their corners are one probe.
#pragma once

#include <span>
#include <vector>

#include "excluded/probes/accessible_surface.hpp"

namespace vdwmesh::excluded {

// Sets `dropped` of all arcs shorter than `no_length` (see kNoLength). `exposed` has the corners of
// each arc; circles and angles of the arcs are known.
void drop_short_arcs(const AccessibleSurface& surface, std::span<const ExposedArc> exposed,
                     double no_length, std::vector<RolledArc>& arcs);

}  // namespace vdwmesh::excluded
