// Every rank visits the faces of its share of the balls, in the presence of all that overlap them:
// a ball's derivatives depend on these alone. Balls that the arcs cannot measure go to the first
// rank with those around them, which measures them by one triangulation, as one process does.
#include "distributed/together/gradients_together.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <span>
#include <utility>

#include "core/errors.hpp"
#include "core/workspace.hpp"
#include "distributed/shares/share_suspects.hpp"
#include "distributed/shares/sphere_shares.hpp"
#include "measures/arcs/arcs.hpp"
#include "measures/arcs/ball_gradient.hpp"
#include "measures/complex_faces.hpp"
#include "measures/measured_spheres.hpp"
#include "spheres/kept_cell_lists.hpp"

namespace vdwmesh {
namespace {

// The first and the second as in union_together(), with a row of derivatives for each near sphere;
// the third is what the first rank gathers and returns for each.
constexpr std::uint64_t kGradientBytesPerNear = 400, kGradientBytesPerSphere = 40,
                        kGradientBytesOfResult = 140;

struct NumberedGradient {
  SphereId id;  // in the whole set
  BallGradient gradient;
};

// What one rank finds out.
struct RankGradients {
  std::vector<NumberedGradient> found;
  ShareSuspects suspects;
  std::uint64_t kinks = 0;
};

void check_memory_of_gradients(const Ranks& ranks, const SphereSet& spheres,
                               const SphereShare& share, std::uint64_t limit) {
  const auto on_host = static_cast<std::uint64_t>(ranks.count_on_host());
  const std::uint64_t bytes = kGradientBytesPerSphere * spheres.size() / on_host +
                              kGradientBytesPerNear * share.near.spheres.size() +
                              (ranks.is_first() ? kGradientBytesOfResult * spheres.size() : 0);
  if (bytes <= limit) return;
  throw LimitExceeded(
      fmt::format("derivatives by {} spheres need {} MiB of memory, {} MiB are allowed to a rank: "
                  "--memory-limit {}M would do",
                  spheres.size(), bytes >> 20, limit >> 20, (bytes >> 20) + 1));
}

// Stores the gradient of each ball that is visited as gradients[id].
void store_in(std::span<BallGradient> gradients, FaceVisitor& visitor) {
  visitor.visit = [gradients](SphereId id, const Sphere& ball, double area,
                              std::span<const SharedFace> faces) {
    const arcs::BallWeights one{1, 1};
    gradients[id] = ball_gradient(ball, area, faces, one, [one](SphereId) { return one; });
  };
}

RankGradients differentiate_share(const SphereShare& share, Monitor* monitor) {
  RankGradients part;
  if (share.own.empty()) return part;
  const auto& ids = share.near.ids;
  const SphereSet near = SphereSet::view(share.near.spheres);
  const MeasuredSpheres own(near.size(), share.own);
  std::vector<BallGradient> gradients(near.size());
  FaceVisitor visitor;
  store_in(gradients, visitor);
  ArcMeasures arcs;
  Workspace workspace;
  arc_measures(arcs, near, {.measured = own, .monitor = monitor, .faces = &visitor}, workspace);
  part.kinks = visitor.kinks;
  for (const SphereId i : share.own) {
    if (!std::ranges::binary_search(arcs.suspect, i)) part.found.push_back({ids[i], gradients[i]});
  }
  if (!arcs.suspect.empty())
    part.suspects = suspects_of(share.near, arcs.suspect, ball_list(near, workspace));
  return part;
}

GradientsTogether result_of(RankGradients all, std::size_t spheres) {
  GradientsTogether result;
  result.gradients.resize(spheres);
  for (const auto& [id, gradient] : all.found) result.gradients[id] = gradient;
  FaceVisitor visitor;
  if (!all.suspects.ids.empty()) {
    store_in(result.gradients, visitor);
    std::vector<SphereMeasures> measures(spheres);
    visit_by_triangulation(all.suspects.ids, std::move(all.suspects.near), measures, visitor);
  }
  result.kink_spheres = all.kinks + visitor.kinks;
  require_finite_derivatives(std::ranges::all_of(result.gradients, is_finite));
  return result;
}

}  // namespace

GradientsTogether gradients_together(const Ranks& ranks, const SphereSet& spheres,
                                     std::uint64_t memory_limit, Monitor* monitor) {
  ranks.together([&] {
    if (spheres.empty()) throw InvalidInput("the union of an empty set of spheres is not defined");
  });
  const SphereShare share = share_of_spheres(ranks, spheres);
  RankGradients part;
  ranks.together([&] {
    check_memory_of_gradients(ranks, spheres, share, memory_limit);
    part = differentiate_share(share, monitor);
  });
  part.found = ranks.collect(std::span<const NumberedGradient>(part.found));
  part.suspects = collect_suspects(ranks, part.suspects);
  part.kinks = ranks.sum(part.kinks);
  GradientsTogether result;
  ranks.together([&] {
    if (ranks.is_first()) result = result_of(std::move(part), spheres.size());
  });
  return result;
}

}  // namespace vdwmesh
