// arc_measures(): every sphere by itself, in parallel.
//
// For each sphere, visit_caps() finds the overlapping balls with a cell list and collects their
// caps. The kernel (arc_kernel.hpp) measures the unit ball that the caps cut. If its workspace for
// kMostFaces faces is too small, measure_by_sectors() does it instead. The results are scaled by
// the radius and stored by sphere id, so they do not depend on the number of threads. A "list
// place" is the index of a sphere in the cell list, where spheres near in space stand near each
// other.
#include "arrangement/arcs/arcs.hpp"

#include <tbb/enumerable_thread_specific.h>

#include <algorithm>
#include <limits>
#include <optional>

#include "arrangement/arcs/arc_sectors.hpp"
#include "arrangement/arcs/ball_caps.hpp"
#include "core/errors.hpp"
#include "core/fixed_blocks.hpp"
#include "core/sum.hpp"
#include "spheres/kept_cell_lists.hpp"

namespace vdwmesh {
namespace {

constexpr std::size_t kSpheresPerBlock = 256;  // consecutive in list order

// The kernel handles a ball in one piece if cutting it makes at most this many faces, counting
// those that later caps remove. The power cell of an atom has far fewer. The kernel's time grows
// with the square of the number, and is still short for this one.
constexpr std::size_t kMostFaces = 512;

// Memory of one thread.
struct ThreadSpace {
  std::vector<arcs::Cap> caps;
  arcs::CellSpace space;
};

// What a caller's Workspace keeps from one call to the next, beside the result's own memory.
struct ArcSpace {
  tbb::enumerable_thread_specific<ThreadSpace> threads;
  std::vector<std::uint8_t> is_doubtful;  // by sphere id
  std::vector<std::uint32_t> places;      // list places of the measured spheres, ascending
};

// Returns the measures of the sphere at list place `place`, in Å² and Å³, with the doubts about
// them.
arcs::BallMeasures measure_sphere(const CellListView& list, std::uint32_t place,
                                  ThreadSpace& work) {
  work.caps.clear();
  const auto take = [&](const arcs::Cap& cap, std::uint32_t) { work.caps.push_back(cap); };
  if (!arcs::visit_caps(list, place, take)) return {0, 0, 0};
  const auto count = static_cast<std::uint32_t>(work.caps.size());
  arcs::BallMeasures unit =
      arcs::measure_ball(work.caps.data(), count, work.space.reserve(work.caps.size(), kMostFaces));
  // The workspace has room for all caps, so an overflow means too many faces or edges.
  if (unit.doubts & arcs::kOverflow) unit = arcs::measure_by_sectors(work.caps);
  const double r = list.spheres[place].radius;
  unit.area *= r * r;
  unit.volume *= r * r * r;
  return unit;
}

}  // namespace

SphereMeasures total_measures(const std::vector<SphereMeasures>& per_sphere,
                              const MeasuredSpheres& measured) {
  WideSum area, volume;
  for (std::size_t i = 0; i < per_sphere.size(); ++i) {
    if (!measured.contains(static_cast<SphereId>(i))) continue;
    area.add(per_sphere[i].area);
    volume.add(per_sphere[i].volume);
  }
  return {area.value(), volume.value()};
}

SphereMeasures total_measures(const std::vector<SphereMeasures>& per_sphere) {
  return total_measures(per_sphere, MeasuredSpheres(per_sphere.size(), std::nullopt));
}

ArcMeasures arc_measures(const SphereSet& spheres, Monitor* monitor) {
  ArcMeasures result{};
  Workspace workspace;
  arc_measures(result, spheres, MeasuredSpheres(spheres.size(), std::nullopt), monitor, workspace);
  return result;
}

void arc_measures(ArcMeasures& result, const SphereSet& spheres, const MeasuredSpheres& measured,
                  Monitor* monitor, Workspace& workspace) {
  if (spheres.empty()) throw InvalidInput("no spheres: their union has no area or volume");
  const CellListView list = ball_list(spheres, workspace);
  auto& [threads, is_doubtful, places] = workspace.get<ArcSpace>();
  constexpr double kNotMeasured = std::numeric_limits<double>::quiet_NaN();
  result.per_sphere.assign(spheres.size(), {kNotMeasured, kNotMeasured});
  is_doubtful.assign(spheres.size(), 0);
  places.clear();
  for (std::uint32_t place = 0; place < list.size; ++place) {
    if (measured.contains(list.id[place])) places.push_back(place);
  }

  begin_stage(monitor, "exact union (arcs)", block_count(places.size(), kSpheresPerBlock));
  // Blocks run in list order: spheres that are near in space find the same list cells in the cache.
  const auto measure = [&](std::size_t, std::size_t first, std::size_t end) {
    ThreadSpace& work = threads.local();
    for (std::size_t i = first; i < end; ++i) {
      const SphereId id = list.id[places[i]];
      const arcs::BallMeasures m = measure_sphere(list, places[i], work);
      result.per_sphere[id] = {m.area, m.volume};
      is_doubtful[id] = m.doubts != 0;
    }
  };
  for_each_block(places.size(), kSpheresPerBlock, measure, monitor);

  result.suspect.clear();
  for (std::size_t i = 0; i < is_doubtful.size(); ++i) {
    if (is_doubtful[i]) result.suspect.push_back(static_cast<SphereId>(i));
  }
  const SphereMeasures total = total_measures(result.per_sphere, measured);
  result.area = total.area;
  result.volume = total.volume;
}

}  // namespace vdwmesh
