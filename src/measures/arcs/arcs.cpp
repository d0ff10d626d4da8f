// arc_measures(): every sphere by itself, in parallel.
//
// For each sphere, BallCaps finds the overlapping balls with a cell list and makes their caps, and
// CutBall measures the unit ball that the caps cut. The results are scaled by the radius and stored
// by sphere id, so they do not depend on the number of threads. A "list place" is the index of a
// sphere in the cell list, where spheres near in space stand near each other.
#include "measures/arcs/arcs.hpp"

#include <tbb/enumerable_thread_specific.h>

#include <algorithm>
#include <limits>
#include <optional>
#include <span>

#include "core/buffer.hpp"
#include "core/errors.hpp"
#include "core/fixed_blocks.hpp"
#include "core/lanes/multiversion.hpp"
#include "core/workspace.hpp"
#include "measures/arcs/ball_caps.hpp"
#include "measures/arcs/cell_faces.hpp"
#include "measures/arcs/cut_ball.hpp"
#include "spheres/kept_cell_lists.hpp"

namespace vdwmesh {
namespace {

constexpr std::size_t kSpheresPerBlock = 256;  // consecutive in list order

void add(CountSums& sums, const arcs::BallMeasures& m) {
  sums.euler_characteristic += m.euler_characteristic;
  sums.corners += m.corners;
  sums.hidden += m.corners == 0 && m.area == 0;
  sums.doubtful += m.doubts != 0;
}

// Memory of one thread.
struct ArcThread {
  CountSums sums;
  arcs::BallCaps caps;
  arcs::CutBall ball;
  arcs::CellFaces faces;
};

// What a caller's Workspace keeps from one call to the next, beside the result's own memory.
struct ArcSpace {
  tbb::enumerable_thread_specific<ArcThread> threads;
  Buffer<std::uint8_t> is_doubtful;  // by sphere id
  Buffer<ListPlace> places;          // of the measured spheres, ascending
};

// One run over the spheres of a list.
struct ArcRun {
  const CellListView& list;
  ArcMeasures& result;
  std::uint8_t* is_doubtful;  // by sphere id
  DisjointSets* connected;    // by sphere id: joins balls that overlap; null if nobody asks
  FaceVisitor* faces;         // null if nobody asks
};

// Joins the ball with those that overlap it. If a ball buries it, joining these two is enough,
// because the burying ball overlaps all that this one overlaps.
void join_neighbors(const ArcRun& run, ListPlace place, const arcs::BallCaps& caps,
                    bool is_buried) {
  const ByListPlace<SphereId> id = run.list.id;
  if (is_buried) run.connected->join(id[place], id[caps.buried_by()]);
  for (const ListPlace other : caps.neighbors()) run.connected->join(id[place], id[other]);
}

// Whether the derivatives of a ball may have a kink (UnionGradients::kink_spheres).
bool has_kink(const CellListView& list, ListPlace place, const arcs::BallCaps& caps,
              bool is_buried) {
  if (!is_buried) return caps.is_nearly_tangent();
  const Sphere &ball = list.spheres[place], &other = list.spheres[caps.buried_by()];
  return ball.center == other.center && ball.radius == other.radius;
}

// Returns the measures of the sphere at a list place, in Å² and Å³, with the doubts about
// them.
arcs::BallMeasures measure_sphere(const ArcRun& run, ListPlace place, ArcThread& work) {
  const bool is_buried = !work.caps.find(run.list, place);
  if (run.connected != nullptr) join_neighbors(run, place, work.caps, is_buried);
  if (run.faces != nullptr && has_kink(run.list, place, work.caps, is_buried))
    run.faces->kinks.fetch_add(1, std::memory_order_relaxed);
  if (is_buried) {
    ++work.sums.hidden;
    return {};
  }
  arcs::BallMeasures m = work.ball.measure(work.caps.caps());
  if (work.caps.is_nearly_tangent()) m.doubts |= arcs::kNearlyTangent;
  add(work.sums, m);  // before an area in Å² may underflow
  const double r = run.list.spheres[place].radius;
  m.area *= r * r;
  m.volume *= r * r * r;
  if (run.faces != nullptr && (m.doubts & ~arcs::kOnlyCountsInDoubt) == 0) {
    run.faces->visit(run.list.id[place], run.list.spheres[place], m.area,
                     work.faces.read(run.list, place, work.caps, work.ball));
  }
  return m;
}

// Measures the spheres at the given list places.
VDWMESH_MULTIVERSION void measure_spheres(const ArcRun& run, std::span<const ListPlace> places,
                                          ArcThread& work) {
  for (const ListPlace place : places) {
    const SphereId id = run.list.id[place];
    const arcs::BallMeasures m = measure_sphere(run, place, work);
    run.result.per_sphere[id] = {m.area, m.volume};
    run.is_doubtful[id] = (m.doubts & ~arcs::kOnlyCountsInDoubt) != 0;
  }
}

// Fills `places` with the list places of the measured spheres, and the results of all others.
void find_places(const CellListView& list, const MeasuredSpheres& measured, ArcMeasures& result,
                 Buffer<std::uint8_t>& is_doubtful, Buffer<ListPlace>& places) {
  constexpr double kNotMeasured = std::numeric_limits<double>::quiet_NaN();
  places.resize(list.size);
  const auto is_measured = [&](std::size_t place) {
    const SphereId id = list.id[static_cast<ListPlace>(place)];
    if (measured.contains(id)) return true;
    result.per_sphere[id] = {kNotMeasured, kNotMeasured};
    is_doubtful[id] = 0;
    return false;
  };
  places.resize(number_all(list.size, is_measured, [&](std::size_t place, std::uint32_t number) {
    places[number] = static_cast<ListPlace>(place);
  }));
}

}  // namespace

// The Euler characteristic of the boundary is faces - edges + vertices. The patches add up to
// `euler_characteristic`. A patch has as many arcs as corners; two patches share each arc and three
// share each corner, so there are corners / 2 arcs and corners / 3 corners in all.
std::optional<UnionCounts> counts_of(const CountSums& sums, std::uint64_t components) {
  if (sums.doubtful > 0 || sums.corners % 6 != 0) return std::nullopt;
  const auto corners = static_cast<std::int64_t>(sums.corners);
  return UnionCounts{components, sums.euler_characteristic - corners / 2 + corners / 3,
                     sums.hidden};
}

ArcMeasures arc_measures(const SphereSet& spheres, Monitor* monitor) {
  ArcMeasures result{};
  Workspace workspace;
  const MeasuredSpheres all(spheres.size(), std::nullopt);
  arc_measures(result, spheres, {.measured = all, .monitor = monitor}, workspace);
  return result;
}

void arc_measures(ArcMeasures& result, const SphereSet& spheres, const ArcRequest& request,
                  Workspace& workspace) {
  if (spheres.empty()) throw InvalidInput("no spheres: their union has no area or volume");
  const CellListView list = ball_list(spheres, workspace);
  auto& [threads, is_doubtful, places] = workspace.get<ArcSpace>();
  result.per_sphere.resize(spheres.size());
  is_doubtful.resize(spheres.size());
  find_places(list, request.measured, result, is_doubtful, places);

  if (request.topology == TopologyRequest::none)
    result.connected.reset();
  else
    result.connected.emplace(spheres.size());
  for (ArcThread& space : threads) space.sums = {};
  const ArcRun run{list, result, is_doubtful.data(),
                   result.connected ? &*result.connected : nullptr, request.faces};

  begin_stage(request.monitor, "exact union (arcs)", block_count(places.size(), kSpheresPerBlock));
  // Blocks run in list order: spheres that are near in space find the same list cells in the cache.
  const auto measure = [&](std::size_t, std::size_t first, std::size_t end) {
    measure_spheres(run, std::span(places).subspan(first, end - first), threads.local());
  };
  for_each_block(places.size(), kSpheresPerBlock, measure, request.monitor);

  result.sums = {};
  for (const ArcThread& space : threads) result.sums.add(space.sums);
  result.suspect =
      collect<SphereId>(is_doubtful.size(), [&](std::size_t i, std::vector<SphereId>& suspect) {
        if (is_doubtful[i]) suspect.push_back(static_cast<SphereId>(i));
      });
}

}  // namespace vdwmesh
