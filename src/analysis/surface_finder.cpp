// SurfaceFinder: distances from many points to the exposed surface.
//
// Points are taken in groups of eight, which vector instructions measure together. One search of
// the tree with the box of a group visits all balls that may have the least gap for one of its
// points, and each of them is measured from all eight. Consecutive points are mostly near each
// other, so a group visits hardly more balls than a single point. If it visits too many, its
// points are far apart, and each is searched by itself. The results are the same (see
// surface_search.hpp).
#include <algorithm>
#include <array>
#include <cmath>

#include "analysis/exposed_surface.hpp"
#include "core/multiversion.hpp"
#include "surface/box.hpp"

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
    visit_nearest(surface.tree, surface.tree.query(box_.lower, box_.upper), bound, visit);
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

VDWMESH_MULTIVERSION void find_all(const PatchTreeView& surface, std::span<const Vec3d> points,
                                   double* found) {
  std::uint32_t hint = 0;
  for (std::size_t first = 0; first < points.size(); first += kGroup) {
    const auto some = points.subspan(first, std::min(kGroup, points.size() - first));
    Group group(some);
    const bool together = group.find(surface, hint);
    for (std::size_t i = 0; i < some.size(); ++i) {
      const LeastGap nearest = together ? group[i] : find_least_gap(surface, some[i], hint);
      found[first + i] = signed_distance(surface, some[i], nearest);
      hint = nearest.patch;
    }
  }
}

}  // namespace

SurfaceFinder::SurfaceFinder(const ExposedSurface& surface, const Box& world)
    : tree_(static_cast<std::uint32_t>(surface.patches().size()), world,
            [&](std::uint32_t i) { return box_of(surface.patches()[i].ball); }),
      view_{surface.patches().data(), nullptr, tree_.view()} {
  balls_.reserve(surface.patches().size());
  for (const Patch& patch : surface.patches()) balls_.push_back(patch.ball);
  view_.balls = balls_.data();
}

void SurfaceFinder::find(std::span<const Vec3d> points, double* found) const {
  find_all(view_, points, found);
}

}  // namespace vdwmesh
