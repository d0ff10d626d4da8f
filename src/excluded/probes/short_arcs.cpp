// drop_short_arcs(): gathers the corners at both ends of short arcs (union-find), and sorts all
// corners into small cells to find clusters that have others next to them.
//
// A gathered probe is placed at one of its corners, so its place is wrong by their distance. To
// probes far away that does not matter. But the plane that bisects it and another probe could have
// any direction if that probe is nearly as near as its own corners. So if clusters are close to
// each other, their corners are not gathered, and wide numbers tell them apart. Only corners that
// are one point to all digits are gathered even then.
#include "excluded/probes/short_arcs.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>

#include "core/disjoint_sets.hpp"
#include "excluded/probes/low_probes.hpp"
#include "excluded/probes/wide_probes.hpp"

namespace vdwmesh::excluded {
namespace {

// An arc of a larger angle is never taken for a point. On a small circle it may be short, but its
// ends have the circle between them.
constexpr double kSmallAngle = 1e-5;
// Clusters nearer than this (scaled) are close: a hundred thousand times kNoLength.
constexpr double kClose = 1e-6;
// Corners nearer than this are one point to all digits that count.
constexpr double kSamePoint = 1e-30;

class CornerClusters {
 public:
  CornerClusters(const AccessibleSurface& surface, std::span<const ExposedArc> exposed,
                 const std::vector<RolledArc>& arcs)
      : surface_(surface),
        cluster_(2 * surface.complex().triangles.size()),
        is_close_(cluster_size(), 0) {
    for (std::size_t i = 0; i < arcs.size(); ++i) {
      if (arcs[i].dropped) cluster_.join(name(exposed[i].start), name(exposed[i].end));
    }
    for (const ExposedArc& arc : exposed) {
      if (arc.start != kNoCorner) cells_[cell_of(place(arc.start))].push_back(name(arc.start));
    }
    for (std::size_t i = 0; i < arcs.size(); ++i) {
      if (!arcs[i].dropped) continue;
      for (const CornerIndex c : {exposed[i].start, exposed[i].end}) {
        if (has_neighbour(c)) is_close_[cluster_.find(name(c))] = 1;
      }
    }
  }

  // Whether the cluster of a corner has another one next to it.
  bool is_close(CornerIndex corner) { return is_close_[cluster_.find(name(corner))] != 0; }

 private:
  using Cell = std::array<double, 3>;

  std::size_t cluster_size() const { return 2 * surface_.complex().triangles.size(); }
  static std::uint32_t name(CornerIndex corner) { return static_cast<std::uint32_t>(corner); }
  Vec3d place(CornerIndex corner) const { return surface_.corner_point(corner); }
  static Cell cell_of(const Vec3d& p) {
    return {std::floor(p.x / kClose), std::floor(p.y / kClose), std::floor(p.z / kClose)};
  }

  bool has_neighbour(CornerIndex corner) {
    const Vec3d at = place(corner);
    const Cell home = cell_of(at);
    const std::uint32_t own = cluster_.find(name(corner));
    bool found = false;
    const auto look_in = [&](const Cell& number) {
      const auto cell = cells_.find(number);
      if (found || cell == cells_.end()) return;
      found = std::any_of(cell->second.begin(), cell->second.end(), [&](std::uint32_t c) {
        return cluster_.find(c) != own && norm(place(c) - at) < kClose;
      });
    };
    visit_cells_beside(home[0], [&](double x) {
      visit_cells_beside(home[1], [&](double y) {
        visit_cells_beside(home[2], [&](double z) { look_in({x, y, z}); });
      });
    });
    return found;
  }

  const AccessibleSurface& surface_;
  DisjointSets cluster_;
  std::vector<std::uint8_t> is_close_;  // by representative
  std::map<Cell, std::vector<std::uint32_t>> cells_;
};

// All probes on the circle of a spindle go through its cusps. Arcs that are not dropped name the
// cusps, so either all arcs of the circle are dropped or none.
void keep_cusps(const AccessibleSurface& surface, std::vector<RolledArc>& arcs) {
  std::vector<std::uint8_t> has_cusps(surface.complex().edges.size(), 0);
  for (const RolledArc& arc : arcs) {
    if (arc.spindle && !arc.dropped) has_cusps[arc.edge] = 1;
  }
  for (RolledArc& arc : arcs) arc.dropped = arc.dropped && has_cusps[arc.edge] == 0;
}

bool is_one_point(const AccessibleSurface& surface, CornerIndex a, CornerIndex b) {
  const WideVector p = wide_corner(surface, a), q = wide_corner(surface, b);
  const WideVector apart{p.x - q.x, p.y - q.y, p.z - q.z};
  return dot(apart, apart) < kSamePoint * kSamePoint;
}

}  // namespace

void drop_short_arcs(const AccessibleSurface& surface, std::span<const ExposedArc> exposed,
                     double no_length, std::vector<RolledArc>& arcs) {
  bool any = false;
  for (std::size_t i = 0; i < arcs.size(); ++i) {
    RolledArc& arc = arcs[i];
    const double length = arc.angle * arc.circle_radius;
    arc.dropped =
        exposed[i].start != kNoCorner && !(length >= no_length) && !(arc.angle >= kSmallAngle);
    any = any || arc.dropped;
  }
  if (!any) return;
  keep_cusps(surface, arcs);
  CornerClusters clusters(surface, exposed, arcs);
  for (std::size_t i = 0; i < arcs.size(); ++i) {
    if (!arcs[i].dropped || !clusters.is_close(exposed[i].start)) continue;
    arcs[i].dropped = is_one_point(surface, exposed[i].start, exposed[i].end);
  }
}

}  // namespace vdwmesh::excluded
