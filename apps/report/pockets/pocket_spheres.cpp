#include "report/pockets/pocket_spheres.hpp"

#include <fmt/format.h>

namespace vdwmesh::apps {

std::vector<SphereGroup> spheres_of(const PocketReport& report) {
  std::vector<SphereGroup> groups;
  for (const PocketRow& p : report.pockets) {
    SphereGroup& group = groups.emplace_back();
    group.kind = kind_name(p.kind), group.number = p.rank;
    group.figure = fmt::format("{} Å³", p.volume);
    for (const Sphere& s : p.alpha_spheres) group.spheres.push_back({s.center, s.radius + p.probe});
  }
  return groups;
}

std::vector<SphereGroup> spheres_of(const ScanReport& report) {
  std::vector<SphereGroup> groups;
  for (const ScanRow& p : report.places) {
    groups.push_back({"place", p.rank, fmt::format("{} Å", p.radius), {{p.center, p.radius}}});
  }
  return groups;
}

std::vector<SphereGroup> spheres_of(const WayReport& report) {
  SphereGroup group{"way", 1, fmt::format("narrowest {} Å", report.bottleneck), {}};
  for (const WayRow& p : report.points) group.spheres.push_back({p.center, p.radius});
  return {group};
}

}  // namespace vdwmesh::apps
