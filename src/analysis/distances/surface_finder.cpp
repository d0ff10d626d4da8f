// SurfaceFinder: distances from many points to the exposed surface.
//
// Points are taken in groups of eight, which vector instructions measure together. One search of
// the tree with the box of a group visits all balls that may have the least gap for one of its
// points, and each of them is measured from all eight. Consecutive points are mostly near each
// other, so a group visits hardly more balls than a single point. If it visits too many, its
// points are far apart, and each is searched by itself. The results are the same (see
// surface_search.hpp).
//
// Where only the largest distance matters, most points are passed over, because a patch that was
// nearest to a point before them proves that they cannot raise it (RecentPatches).
#include <algorithm>
#include <array>
#include <cmath>

#include "analysis/distances/box_tree_lanes.hpp"
#include "analysis/distances/exposed_surface.hpp"
#include "core/lanes/lane_masks.hpp"
#include "core/lanes/multiversion.hpp"
#include "spheres/box.hpp"

namespace vdwmesh {
namespace {

constexpr std::size_t kGroup = 8;  // points
// Balls that a group may visit. Molecules need about ten; singly, eight points need about forty.
constexpr int kMostVisits = 48;

// The points of a group, and for each the least gap so far and the patch that has it.
class Group {
 public:
  // A group of fewer points is filled up with the last one.
  explicit Group(std::span<const Vec3d> points) {
    for (std::size_t i = 0; i < kGroup; ++i) {
      const Vec3d& p = points[std::min(i, points.size() - 1)];
      x_[i] = p.x, y_[i] = p.y, z_[i] = p.z;
      include(box_, p);
    }
    center_ = 0.5 * (box_.lower + box_.upper);
    const Vec3d half = 0.5 * (box_.upper - box_.lower);
    radius_ = std::sqrt(arcs::inner(half, half)) * (1 + kSquareMargin);
    gap_.fill(std::numeric_limits<double>::infinity());
  }

  // Finds the least gaps. `hint` is the patch that is measured first. Returns false if that takes
  // too many visits.
  bool find(const PatchTreeView& surface, std::uint32_t hint) {
    measure(surface.balls[hint], hint);
    double most = largest_gap();
    double bound = bound_of_gap(most);
    int visits = 0;
    const auto visit = [&](std::uint32_t i, double& least) {
      const Sphere& ball = surface.balls[i];
      // No gap of the ball is below `most` if its gap at the centre is not below most + radius_.
      const Vec3d to = center_ - ball.center;
      const double reach = ball.radius + most + radius_;
      if (!(reach > 0) || arcs::inner(to, to) > reach * reach * (1 + kSquareMargin)) return;
      measure(ball, i);
      most = largest_gap();
      least = ++visits > kMostVisits ? -1 : bound_of_gap(most);
    };
    visit_nearest<NearEight>(surface.tree, surface.tree.query(box_.lower, box_.upper), bound,
                             visit);
    return visits <= kMostVisits;
  }

  LeastGap operator[](std::size_t i) const {
    return {gap_[i], static_cast<std::uint32_t>(patch_[i])};
  }

 private:
  void measure(const Sphere& ball, std::uint32_t patch) {
    const auto owner = static_cast<std::int64_t>(patch);
    for (std::size_t i = 0; i < kGroup; ++i) {
      const double x = x_[i] - ball.center.x, y = y_[i] - ball.center.y, z = z_[i] - ball.center.z;
      const double gap = std::sqrt(x * x + y * y + z * z) - ball.radius;
      const bool nearer = gap < gap_[i];
      gap_[i] = nearer ? gap : gap_[i];
      patch_[i] = nearer ? owner : patch_[i];
    }
  }
  double largest_gap() const {
    std::array<double, kGroup> most = gap_;
    for (std::size_t half = kGroup / 2; half > 0; half /= 2)
      for (std::size_t i = 0; i < half; ++i) most[i] = std::max(most[i], most[i + half]);
    return most[0];
  }

  alignas(32) std::array<double, kGroup> x_, y_, z_, gap_;
  std::array<std::int64_t, kGroup> patch_{};
  Box box_ = empty_box();
  Vec3d center_;
  double radius_;  // Å, of a ball around center_ that contains all points
};

// The patches that were nearest to points before, the latest first.
//
// Let g be the gap of a patch's ball for a point p, and f the foot of p on that ball. If f is
// exposed, it is an exposed point at the distance |g| of p, so p is no farther from the surface. As
// computed, the distance of p is max(|s|, d), s the least gap and d the distance to the nearest
// patch, or s alone (surface_search.hpp):
//  - s >= 0: then g >= s, because s is the least of all gaps, each computed by the same operations.
//  - s < 0: d <= |g|, since has_exposed_foot() agrees: the limit here is below its own by 5e-11,
//    far more than the roundings of the two sides. |s| exceeds |g| by no more than the depth of f
//    in the ball of least gap: a ball of radius |s| around p lies in that ball. In every cover f is
//    at most 5e-11 (in the cosine) beyond the border, which on the sphere is an angle of at most
//    √1e-10, for cos(φ - a) - cos φ >= 1 - cos a. A point of the sphere outside the cap is thus
//    within 1e-5 radii of f, so the depth of f is at most that. (A cap that is not listed lies in a
//    listed one.)
// Twice that bound is the margin, and more than the rounding of a gap in the world of the tree.
//
// A patch without exposed points settles nothing: no cover contains the centre of its ball, which
// has no direction.
class RecentPatches {
 public:
  explicit RecentPatches(const PatchTreeView& surface)
      : surface_(surface), rounding_(1e-14 / surface.tree.scale) {}

  void add(std::uint32_t patch) {
    std::size_t at = 0;
    while (at + 1 < recent_.size() && recent_[at] != patch) ++at;
    for (; at > 0; --at) recent_[at] = recent_[at - 1];
    recent_[0] = patch;
  }
  std::uint32_t latest() const { return recent_[0]; }

  // A mask of the eight points that may be farther from the surface than `largest` (Å).
  std::uint32_t open(const std::array<double, kGroup>& x, const std::array<double, kGroup>& y,
                     const std::array<double, kGroup>& z, double largest) {
    std::uint32_t left = (1u << kGroup) - 1;
    for (std::size_t k = 0; k < recent_.size() && left != 0; ++k) {
      const std::uint32_t patch = recent_[k];
      const std::uint32_t still = left & ~settled(surface_.patches[patch], x, y, z, largest);
      if (still != left) add(patch);
      left = still;
    }
    return left;
  }

 private:
  std::uint32_t settled(const Patch& patch, const std::array<double, kGroup>& x,
                        const std::array<double, kGroup>& y, const std::array<double, kGroup>& z,
                        double largest) const {
    if (patch.cover_count > 0 && patch.circles == 0) return 0;
    constexpr double kDepth = 2e-5;  // radii
    const Sphere& ball = patch.ball;
    const double most = largest - kDepth * ball.radius - rounding_;
    alignas(32) std::array<double, kGroup> u, v, w, length;
    for (std::size_t i = 0; i < kGroup; ++i) {
      u[i] = x[i] - ball.center.x, v[i] = y[i] - ball.center.y, w[i] = z[i] - ball.center.z;
      length[i] = std::sqrt(u[i] * u[i] + v[i] * v[i] + w[i] * w[i]);
    }
    std::uint32_t mask = 0;
    for (std::size_t first = 0; first < kGroup; first += kLanes) {
      const Lanes of_ball = lanes_at(&length[first]);
      LaneBits yes = magnitude_of(of_ball - all_lanes(ball.radius)) <= all_lanes(most);
      if (bits_of(yes) == 0) continue;
      const Lanes along[3] = {lanes_at(&u[first]), lanes_at(&v[first]), lanes_at(&w[first])};
      for (std::uint32_t c = 0; c < patch.cover_count; ++c) {
        const arcs::Cap& cap = patch.covers[c].cap;
        const double limit = cap.cosine + 0.5 * kExposureTolerance;
        const Lanes inner = cap.axis.x * along[0] + cap.axis.y * along[1] + cap.axis.z * along[2];
        yes &= inner <= limit * of_ball;
      }
      mask |= bits_of(yes) << first;
    }
    return mask;
  }

  const PatchTreeView& surface_;
  double rounding_;  // Å
  std::array<std::uint32_t, 4> recent_{};
};

// Measures the points that are still open, eight together.
double measure_open(const PatchTreeView& surface, std::span<const Vec3d> points, double largest,
                    RecentPatches& recent) {
  Group group(points);
  const bool together = group.find(surface, recent.latest());
  for (std::size_t i = 0; i < points.size(); ++i) {
    const LeastGap nearest =
        together ? group[i] : find_least_gap<NearEight>(surface, points[i], recent.latest());
    largest = std::max(largest, std::abs(signed_distance<NearEight>(surface, points[i], nearest)));
    recent.add(nearest.patch);
  }
  return largest;
}

VDWMESH_MULTIVERSION double raise_all(const PatchTreeView& surface, std::span<const Vec3d> points,
                                      double largest) {
  RecentPatches recent(surface);
  std::array<Vec3d, kGroup> waiting;
  std::size_t count = 0;
  for (std::size_t first = 0; first < points.size(); first += kGroup) {
    const std::size_t here = std::min(kGroup, points.size() - first);
    alignas(32) std::array<double, kGroup> x, y, z;
    for (std::size_t i = 0; i < kGroup; ++i) {
      const Vec3d& p = points[first + std::min(i, here - 1)];
      x[i] = p.x, y[i] = p.y, z[i] = p.z;
    }
    std::uint32_t open = recent.open(x, y, z, largest) & ((1u << here) - 1);
    for (; open != 0; open &= open - 1) {
      waiting[count++] = points[first + static_cast<std::size_t>(lowest_bit(open))];
      if (count < kGroup) continue;
      largest = measure_open(surface, waiting, largest, recent);
      count = 0;
    }
  }
  if (count == 0) return largest;
  return measure_open(surface, std::span(waiting).first(count), largest, recent);
}

// Calls visit(i, nearest) for each point with its ball of least gap.
template <class Visit>
[[gnu::always_inline]] inline void visit_gaps(const PatchTreeView& surface,
                                              std::span<const Vec3d> points, const Visit& visit) {
  std::uint32_t hint = 0;
  for (std::size_t first = 0; first < points.size(); first += kGroup) {
    const auto some = points.subspan(first, std::min(kGroup, points.size() - first));
    Group group(some);
    const bool together = group.find(surface, hint);
    for (std::size_t i = 0; i < some.size(); ++i) {
      const LeastGap nearest =
          together ? group[i] : find_least_gap<NearEight>(surface, some[i], hint);
      visit(first + i, nearest);
      hint = nearest.patch;
    }
  }
}

VDWMESH_MULTIVERSION void find_all(const PatchTreeView& surface, std::span<const Vec3d> points,
                                   double* found) {
  visit_gaps(surface, points, [&](std::size_t i, const LeastGap& nearest) {
    found[i] = signed_distance<NearEight>(surface, points[i], nearest);
  });
}

VDWMESH_MULTIVERSION void find_all_gaps(const PatchTreeView& surface, std::span<const Vec3d> points,
                                        LeastGap* found) {
  visit_gaps(surface, points, [&](std::size_t i, const LeastGap& nearest) { found[i] = nearest; });
}

}  // namespace

SurfaceFinder::SurfaceFinder(const ExposedSurface& surface, const Box& world)
    : tree_(static_cast<std::uint32_t>(surface.searched().size()), world,
            [&](std::uint32_t i) { return box_of(surface.searched()[i].ball); }),
      view_{surface.searched().data(), nullptr, tree_.view()} {
  balls_.reserve(surface.searched().size());
  for (const Patch& patch : surface.searched()) balls_.push_back(patch.ball);
  view_.balls = balls_.data();
}

void SurfaceFinder::find(std::span<const Vec3d> points, double* found) const {
  find_all(view_, points, found);
}

double SurfaceFinder::largest_distance(std::span<const Vec3d> points, double largest) const {
  return raise_all(view_, points, largest);
}

void SurfaceFinder::find_gaps(std::span<const Vec3d> points, LeastGap* found) const {
  find_all_gaps(view_, points, found);
}

}  // namespace vdwmesh
