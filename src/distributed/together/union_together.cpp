// union_together(): every rank takes its share of the spheres and all that overlap them. A sphere's
// measures depend on these alone, so they have the bits that one process gives them. Then the ranks
// add up areas and volumes without rounding, the integers from which the counts follow, and the
// number of sets of connected spheres (components_together.hpp). A sphere that the arcs cannot
// measure is a suspect. Suspects are sent to the first rank with the balls around them; it measures
// them by one triangulation, as one process does.
//
// Devices and the CPU differ in the last digits, so either all ranks measure on devices or none.
#include "distributed/together/union_together.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <span>
#include <utility>
#include <vector>

#include "core/errors.hpp"
#include "core/fixed_blocks.hpp"
#include "core/workspace.hpp"
#include "cuda/backend.hpp"
#include "distributed/shares/share_suspects.hpp"
#include "distributed/shares/sphere_shares.hpp"
#include "distributed/together/components_together.hpp"
#include "measures/arcs/arcs.hpp"
#include "measures/exact_sum.hpp"
#include "measures/measured_spheres.hpp"
#include "measures/measures.hpp"
#include "measures/reference_measures.hpp"
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
struct TotalsOfAll {
  ExactSum area, volume;
  CountSums patches;

  void add(const SphereMeasures& m) {
    area.add(m.area);
    volume.add(m.volume);
  }
  void add(const TotalsOfAll& other) {
    area.add(other.area);
    volume.add(other.volume);
    patches.add(other.patches);
  }
};

// What one rank finds out.
struct Part {
  SphereShare share;
  ArcMeasures arcs;                         // of the CPU
  Buffer<SphereMeasures> on_device;         // in the order of the near spheres
  std::span<const SphereMeasures> by_near;  // those of the CPU or of the device
  ShareSuspects suspects;
  TotalsOfAll totals;                    // without the suspects' areas and volumes
  std::vector<MeasuredSphere> measured;  // without the suspects; empty if not asked for
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
  const std::vector<SphereId> wanted = spheres_for_arcs(part.share, measured, options.topology);
  if (wanted.empty()) return;
  const SphereSet near = SphereSet::view(part.share.near.spheres);
  const MeasuredSpheres of_share(near.size(), wanted);
  Workspace workspace;
  arc_measures(part.arcs, near,
               {.measured = of_share, .topology = options.topology, .monitor = options.monitor},
               workspace);
  part.by_near = part.arcs.per_sphere;
  if (!part.arcs.suspect.empty()) {
    part.suspects = suspects_of(part.share.near, part.arcs.suspect, ball_list(near, workspace));
  }
}

// Returns what the device lacks, or an empty text. It measures the near spheres too, which are few.
std::string measure_share_on_device(Part& part) {
  const auto& [spheres, own, owner] = part.share;
  if (own.empty()) return {};
  const SphereSet near = SphereSet::view(spheres.spheres);
  DeviceArcs arcs;
  try {
    arcs = measure_arcs_on_device(near);
  } catch (const DeviceMemoryExceeded& error) {
    return error.what();
  }
  part.on_device = std::move(arcs.per_sphere);
  part.by_near = part.on_device;
  std::vector<SphereId> suspects;
  std::ranges::set_intersection(arcs.suspect, own, std::back_inserter(suspects));
  if (!suspects.empty()) {
    Workspace workspace;
    part.suspects = suspects_of(spheres, suspects, ball_list(near, workspace));
  }
  return {};
}

void add_up(Part& part, const MeasuredSpheres& measured, const UnionTogetherOptions& options) {
  part.totals.patches = part.arcs.sums;
  const auto& [near, own, owner] = part.share;
  if (part.by_near.empty()) return;
  const auto is_counted = [&, &ids = near.ids, &own = own](std::size_t n) {
    const SphereId id = ids[own[n]];
    return measured.contains(id) && !std::ranges::binary_search(part.suspects.ids, id);
  };
  part.totals.add(join_blocks(
      own.size(),
      [&, &own = own](std::size_t first, std::size_t end) {
        TotalsOfAll sums;
        for (std::size_t n = first; n < end; ++n) {
          if (is_counted(n)) sums.add(part.by_near[own[n]]);
        }
        return sums;
      },
      [](TotalsOfAll& sums, const TotalsOfAll& more) { sums.add(more); }));
  if (options.per_sphere != PerSphere::keep) return;
  part.measured = collect<MeasuredSphere>(
      own.size(), [&, &ids = near.ids, &own = own](std::size_t n, auto& found) {
        if (is_counted(n)) found.push_back({ids[own[n]], part.by_near[own[n]]});
      });
}

// CUDA if it may be taken and all ranks have a device. Collective.
Backend common_backend(const Ranks& ranks, Backend requested) {
  bool on_device = false;
  ranks.together([&] {
    on_device = resolve(requested) == Backend::cuda;
    if (on_device) share_devices(static_cast<std::size_t>(ranks.number_on_host()));
  });
  const auto all = static_cast<std::uint64_t>(ranks.count());
  return ranks.sum(std::uint64_t{on_device}) == all ? Backend::cuda : Backend::cpu;
}

// Measures on the devices of all ranks. Returns why the CPU has to instead, or an empty text.
// Throws LimitExceeded, on all ranks, if devices were asked for. Collective.
std::string measure_on_devices(const Ranks& ranks, Part& part,
                               const UnionTogetherOptions& options) {
  begin_stage(options.monitor, "exact union (arcs, CUDA)", 1);
  std::string lack;
  ranks.together([&] { lack = measure_share_on_device(part); });
  lack = ranks.first_text(lack);
  advance(options.monitor, 1);
  if (lack.empty()) return {};
  ranks.together([&] {
    if (options.backend == Backend::cuda) throw LimitExceeded(lack);
    Part anew;
    anew.share = std::move(part.share);
    part = std::move(anew);
  });
  return "measured on the CPU: " + lack;
}

// What the ranks found out, as the first one has it.
struct Gathered {
  ShareSuspects suspects;
  std::vector<MeasuredSphere> measured;
  TotalsOfAll totals;
  std::uint64_t components = 0;
};

template <class T>
std::vector<T> collect(const Ranks& ranks, const std::vector<T>& mine) {
  return ranks.collect(std::span<const T>(mine));
}

Gathered gather(const Ranks& ranks, Part& part, TopologyRequest topology) {
  Gathered all;
  all.suspects = collect_suspects(ranks, part.suspects);
  all.measured = collect(ranks, part.measured);
  for (const TotalsOfAll& totals : ranks.collect(std::span<const TotalsOfAll>(&part.totals, 1))) {
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
  const std::vector<SphereId>& ids = all.suspects.ids;
  if (ids.empty()) return;
  const std::vector<SphereMeasures> measures =
      reference_measures(ids, std::move(all.suspects.near));
  for (std::size_t i = 0; i < measures.size(); ++i) {
    if (!measured.contains(ids[i])) continue;
    all.totals.add(measures[i]);
    all.measured.push_back({ids[i], measures[i]});
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
  result.fallback_spheres = all.suspects.ids.size();
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

UnionTogether union_together(const Ranks& ranks, const SphereSet& spheres,
                             const UnionTogetherOptions& options) {
  Part part;
  std::optional<MeasuredSpheres> measured;
  ranks.together([&] {
    if (spheres.empty()) throw InvalidInput("the union of an empty set of spheres is not defined");
    measured.emplace(spheres.size(), options.measured);
  });
  UnionTogether result{};
  result.backend = common_backend(ranks, options.backend);
  part.share = share_of_spheres(ranks, spheres);
  ranks.together([&] { check_memory(ranks, spheres, part.share, options.memory_limit); });
  if (result.backend == Backend::cuda) {
    result.fallback = measure_on_devices(ranks, part, options);
    if (!result.fallback.empty()) result.backend = Backend::cpu;
  }
  ranks.together([&] {
    if (result.backend == Backend::cpu) measure_share(part, *measured, options);
    add_up(part, *measured, options);
  });
  Gathered all = gather(ranks, part, options.topology);
  ranks.together([&] {
    if (!ranks.is_first()) return;
    static_cast<ExactUnion&>(result) = result_of(std::move(all), spheres, *measured, options);
  });
  return result;
}

}  // namespace vdwmesh
