// Spheres of pockets, places and ways, for sphere_file().
#pragma once

#include <vector>

#include "report/pockets/pocket_report.hpp"
#include "report/pockets/scan_report.hpp"
#include "report/sphere_file.hpp"

namespace vdwmesh::apps {

// Pocket::alpha_spheres of each pocket, with the radius of the largest probe that its balls let in:
// the atoms are smaller by the probe than the balls.
std::vector<SphereGroup> spheres_of(const PocketReport& report);
// The largest probe at each place, and at each point of a way.
std::vector<SphereGroup> spheres_of(const ScanReport& report);
std::vector<SphereGroup> spheres_of(const WayReport& report);

}  // namespace vdwmesh::apps
