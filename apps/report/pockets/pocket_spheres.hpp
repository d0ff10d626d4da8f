// The spheres of pockets as files for molecular viewers.
#pragma once

#include <string>

#include "report/pockets/pocket_report.hpp"
#include "report/sphere_file.hpp"

namespace vdwmesh::apps {

// Pocket::alpha_spheres of all pockets, each with the radius of the largest probe that its balls
// let in (the atoms are smaller by the probe than the balls), as spheres_text(): groups are the
// pockets, by rank. Throws as that does.
std::string pocket_spheres(const PocketReport& report, SphereFormat format);

}  // namespace vdwmesh::apps
