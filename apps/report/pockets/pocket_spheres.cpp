#include "report/pockets/pocket_spheres.hpp"

#include <vector>

namespace vdwmesh::apps {

std::string pocket_spheres(const PocketReport& report, SphereFormat format) {
  std::vector<SphereGroup> groups;
  for (const PocketRow& p : report.pockets) {
    SphereGroup group{std::string(kind_name(p.kind)), p.volume, p.alpha_spheres};
    for (Sphere& s : group.spheres) s.radius += p.probe;
    groups.push_back(std::move(group));
  }
  return spheres_text(groups, "pockets", format);
}

}  // namespace vdwmesh::apps
