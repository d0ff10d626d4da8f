// LowProbes: sorts the low probes into cells.
#include "excluded/probes/low_probes.hpp"

#include <tbb/parallel_sort.h>

#include <algorithm>
#include <tuple>

namespace vdwmesh::excluded {

LowProbes::LowProbes(const AccessibleSurface& surface, std::span<const std::uint8_t> included)
    : surface_(surface), width_(2 * surface.probe_radius) {
  for (std::uint32_t i = 0; i < surface.probes.size(); ++i) {
    const Probe& p = surface.probes[i];
    if (!p.low || !included[p.component]) continue;
    list_.push_back(i);
    entries_.push_back({cell_of(p.center), i});
  }
  tbb::parallel_sort(entries_.begin(), entries_.end(),
                     [](const ListedProbe& a, const ListedProbe& b) {
                       return std::tie(a.cell, a.probe) < std::tie(b.cell, b.probe);
                     });
}

LowProbes::Cell LowProbes::cell_of(const Vec3d& point) const {
  return {std::floor(point.z / width_), std::floor(point.y / width_), std::floor(point.x / width_)};
}

const LowProbes::ListedProbe* LowProbes::first_from(const Cell& cell) const {
  const auto found =
      std::lower_bound(entries_.begin(), entries_.end(), cell,
                       [](const ListedProbe& e, const Cell& c) { return e.cell < c; });
  return entries_.data() + (found - entries_.begin());
}

}  // namespace vdwmesh::excluded
