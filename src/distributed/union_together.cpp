// union_together(): every rank takes its share of the spheres and all that overlap them. A sphere's
// measures depend on these alone, so they have the bits that one process gives them. Then the ranks
// add up areas and volumes without rounding, the integers from which the counts follow, and the
// number of sets of connected spheres (components_together.hpp). A sphere that the arcs cannot
// measure is a suspect. Suspects are sent to the first rank with the balls around them; it measures
// them by one triangulation, as one process does.
#include "distributed/union_together.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>
#include <vector>

#include "arrangement/arcs/arcs.hpp"
#include "arrangement/complex/measures.hpp"
#include "arrangement/exact_sum.hpp"
#include "arrangement/measured_spheres.hpp"
#include "arrangement/reference_measures.hpp"
#include "core/errors.hpp"
#include "distributed/components_together.hpp"
#include "distributed/sphere_shares.hpp"
#include "spheres/kept_cell_lists.hpp"

namespace vdwmesh {
namespace {

// Half as much again as was measured on five million atoms.
constexpr std::uint64_t kBytesPerSphere = 40;       // of the whole set, once on a host
constexpr std::uint64_t kBytesPerNearSphere = 300;  // list, measures, sets; of those near the share

struct MeasuredSphere {
  SphereId id;  // in the whole set
  SphereMeasures measures;
};

// What the ranks add up.
struct Totals {
  ExactSum area, volume;
  PatchSums patches;

  void add(const SphereMeasures& m) {
    area.add(m.area);
    volume.add(m.volume);
  }
  void add(const Totals& other) {
    area.add(other.area);
    volume.add(other.volume);
    patches.add(other.patches);
  }
};

// What one rank finds out.
struct Part {
  SphereShare share;
  ArcMeasures arcs;
  std::vector<SphereId> suspects;           // ids in the whole set
  std::vector<NumberedBall> near_suspects;  // likewise
  Totals totals;                            // without the suspects' areas and volumes
  std::vector<MeasuredSphere> measured;     // without the suspects; empty if not asked for
};

void check_memory(const Ranks& ranks, const SphereSet& spheres, const SphereShare& share,
                  std::uint64_t limit) {
  const auto on_host = static_cast<std::uint64_t>(ranks.count_on_host());
  const std::uint64_t bytes =
      kBytesPerSphere * spheres.size() / on_host + kBytesPerNearSphere * share.near.spheres.size();
  if (bytes <= limit) return;
  throw LimitExceeded(fmt::format(
      "{} spheres of {} need {} MiB of memory, {} MiB are allowed to a rank: more ranks or "
      "--memory-limit {}M would do",
      share.own.size(), spheres.size(), bytes >> 20, limit >> 20, (bytes >> 20) + 1));
}

// The spheres that the arcs are to measure, as indices of the near ones. Counts are of the whole
// union, so all of the share are measured for them.
std::vector<SphereId> spheres_for_arcs(const SphereShare& share, const MeasuredSpheres& measured,
                                       TopologyRequest topology) {
  if (topology != TopologyRequest::none) return share.own;
  std::vector<SphereId> chosen;
  for (const SphereId i : share.own) {
    if (measured.contains(share.near.ids[i])) chosen.push_back(i);
  }
  return chosen;
}

void measure_share(Part& part, const MeasuredSpheres& measured,
                   const UnionTogetherOptions& options) {
  const auto& [near, ids] = part.share.near;
  const std::vector<SphereId> wanted = spheres_for_arcs(part.share, measured, options.topology);
  if (wanted.empty()) return;
  const SphereSet near_set = SphereSet::view(near);
  const MeasuredSpheres of_share(near.size(), wanted);
  Workspace workspace;
  arc_measures(part.arcs, near_set,
               {.measured = of_share, .topology = options.topology, .monitor = options.monitor},
               workspace);
  if (part.arcs.suspect.empty()) return;
  const CellListView& list = ball_list(near_set, workspace);
  part.near_suspects = balls_near(list, near_set, part.arcs.suspect);
  for (NumberedBall& ball : part.near_suspects) ball.id = ids[ball.id];
  for (const SphereId i : part.arcs.suspect) part.suspects.push_back(ids[i]);
}

void add_up(Part& part, const MeasuredSpheres& measured, const UnionTogetherOptions& options) {
  part.totals.patches = part.arcs.sums;
  for (const SphereId i : part.share.own) {
    const SphereId id = part.share.near.ids[i];
    if (!measured.contains(id) || std::ranges::binary_search(part.arcs.suspect, i)) continue;
    part.totals.add(part.arcs.per_sphere[i]);
    if (options.per_sphere == PerSphere::keep) {
      part.measured.push_back({id, part.arcs.per_sphere[i]});
    }
  }
}

// What the ranks found out, as the first one has it.
struct Gathered {
  std::vector<SphereId> suspects;
  std::vector<NumberedBall> near_suspects;
  std::vector<MeasuredSphere> measured;
  Totals totals;
  std::uint64_t components = 0;
};

template <class T>
std::vector<T> collect(const Ranks& ranks, const std::vector<T>& mine) {
  return ranks.collect(std::span<const T>(mine));
}

Gathered gather(const Ranks& ranks, Part& part, TopologyRequest topology) {
  Gathered all;
  all.suspects = collect(ranks, part.suspects);
  all.near_suspects = collect(ranks, part.near_suspects);
  all.measured = collect(ranks, part.measured);
  for (const Totals& totals : ranks.collect(std::span<const Totals>(&part.totals, 1))) {
    all.totals.add(totals);
  }
  if (topology != TopologyRequest::none) {
    all.components = join_components(ranks, part.share,
                                     [&](SphereId i) { return part.arcs.connected->find(i); });
  }
  return all;
}

// Adds the suspects, measured by a triangulation, to those that the arcs measured.
void add_suspects(Gathered& all, const MeasuredSpheres& measured) {
  if (all.suspects.empty()) return;
  const std::vector<SphereMeasures> measures =
      reference_measures(all.suspects, std::move(all.near_suspects));
  for (std::size_t i = 0; i < measures.size(); ++i) {
    if (!measured.contains(all.suspects[i])) continue;
    all.totals.add(measures[i]);
    all.measured.push_back({all.suspects[i], measures[i]});
  }
}

std::vector<SphereMeasures> in_order(const std::vector<MeasuredSphere>& measured,
                                     std::size_t spheres) {
  constexpr double kNotMeasured = std::numeric_limits<double>::quiet_NaN();
  std::vector<SphereMeasures> per_sphere(spheres, {kNotMeasured, kNotMeasured});
  for (const auto& [id, measures] : measured) per_sphere[id] = measures;
  return per_sphere;
}

ExactUnion result_of(Gathered all, const SphereSet& spheres, const MeasuredSpheres& measured,
                     const UnionTogetherOptions& options) {
  add_suspects(all, measured);
  ExactUnion result{};
  result.method = UnionMethod::arcs;
  result.area = all.totals.area.nearest();
  result.volume = all.totals.volume.nearest();
  require_finite({{result.area, result.volume}});
  result.fallback_spheres = all.suspects.size();
  if (options.topology != TopologyRequest::none) {
    result.counts = counts_of(all.totals.patches, all.components);
    result.doubtful_spheres = all.totals.patches.doubtful;
  }
  if (options.per_sphere == PerSphere::keep) {
    result.per_sphere = in_order(all.measured, spheres.size());
  }
  return result;
}

}  // namespace

ExactUnion union_together(const Ranks& ranks, const SphereSet& spheres,
                          const UnionTogetherOptions& options) {
  Part part;
  std::optional<MeasuredSpheres> measured;
  ranks.together([&] {
    if (spheres.empty()) throw InvalidInput("the union of an empty set of spheres is not defined");
    measured.emplace(spheres.size(), options.measured);
  });
  part.share = share_of_spheres(ranks, spheres);
  ranks.together([&] {
    check_memory(ranks, spheres, part.share, options.memory_limit);
    measure_share(part, *measured, options);
    add_up(part, *measured, options);
  });
  Gathered all = gather(ranks, part, options.topology);
  ExactUnion result{};
  ranks.together([&] {
    if (ranks.is_first()) result = result_of(std::move(all), spheres, *measured, options);
  });
  return result;
}

}  // namespace vdwmesh
