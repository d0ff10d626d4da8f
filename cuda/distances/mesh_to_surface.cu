// From points to the exposed surface: samples of a mesh's area, the centres of its triangles, its
// vertices, or points of the caller.
//
// One ball settles most points, and the search of all patches for the others takes far longer. If
// both were done at once, every warp would wait for its few points of the second kind. So a first
// kernel searches for the ball of least gap of all points, and a second one takes the points that
// are left, packed together.
//
// The first kernel lists the balls within a reach of the points of a warp, which are near each
// other, and each lane measures them. If a ball has a gap below the reach, the ball of least gap is
// among them, because its box is no farther than its gap. Other points are searched for in the
// tree.
#include <thrust/iterator/counting_iterator.h>

#include <cub/device/device_reduce.cuh>
#include <cub/device/device_select.cuh>
#include <cuda/std/functional>
#include <limits>

#include "cuda/distances/device_area.cuh"
#include "cuda/distances/device_statistics.cuh"
#include "cuda/distances/group_list.cuh"
#include "cuda/distances/measure_distances.cuh"
#include "cuda/distances/warp_search.cuh"
#include "cuda/memory/cub_calls.cuh"
#include "cuda/memory/launch.cuh"
#include "cuda/memory/transfer.cuh"
#include "cuda/memory/warp.cuh"

namespace vdwmesh::distance {
namespace {

constexpr unsigned kThreads = 128;

// What a search may take for granted of points.
struct PointHints {
  double reach;       // Å, above 0: a guess; most points should have a gap below it
  double floor = -1;  // Å²: of a point with a squared distance up to this, 0 may be told instead
};

// What is known of the points of a launch.
struct FoundGaps {
  double* gap;            // Å, and in the end the signed distance; 0 for points that are not there
  std::uint32_t* patch;   // whose ball has the least gap
  std::uint8_t* is_open;  // whether the gap is not the distance yet
};

// The balls of a node of level 0, in shared memory, by their centres and radii.
using LeafBalls = double[BoxNode::kWidth][4];
static_assert(sizeof(Sphere) == 4 * sizeof(double) && BoxNode::kWidth * 4 == kWarp);

// Loads the balls of the children `wanted`, a bit for each, by a lane for each number. Returns the
// patch of the child lane / 4.
__device__ std::uint32_t load_balls(const PatchTreeView& surface, std::uint32_t index,
                                    std::uint32_t wanted, LeafBalls& leaf) {
  const unsigned child = threadIdx.x % kWarp / 4, number = threadIdx.x % 4;
  std::uint32_t patch = 0;
  __syncwarp();  // the leaf before has been read
  if (wanted >> child & 1) {
    patch = surface.tree.order[BoxNode::kWidth * index + child];
    leaf[child][number] = reinterpret_cast<const double*>(surface.balls + patch)[number];
  }
  __syncwarp();
  return patch;
}

// The memory of a warp, shared: 2.4 KB.
struct GapMemory {
  GroupRoom room;
  WarpStack stack;
  LeafBalls leaf;
};

// Lowers `found` to the gap of a ball, as find_least_gap() does.
__device__ void lower(const PatchTreeView& surface, std::uint32_t patch, const Vec3d& p,
                      LeastGap& found) {
  const Sphere ball = surface.balls[patch];
  const Vec3d to = p - ball.center;
  const double square = arcs::inner(to, to), reach = ball.radius + found.gap;
  if (!(reach > 0) || square > reach * reach * (1 + kSquareMargin)) return;
  const double gap = sqrt(square) - ball.radius;
  if (gap < found.gap) found = {gap, patch};
}

// Finds the balls of least gap of the lanes that are `open`, if these gaps are below `reach`, and
// returns the other lanes. A ball whose gap is below the reach has a box so near, so it is listed.
__device__ unsigned find_gaps_within(const PatchTreeView& surface, const Vec3d& p, double reach,
                                     unsigned open, GroupRoom& room, LeastGap& found) {
  const unsigned lane = threadIdx.x % kWarp;
  GroupList list(room);
  const BoxQuery query = surface.tree.query(p);
  const float bound = surface.tree.bound_of(reach * reach);
  found = {reach, 0};
  for_each_range(open, [&](unsigned lanes) {
    const bool taken = lanes >> lane & 1;
    const unsigned count = list.fill(surface.tree, query, taken, bound, 0);
    if (count == GroupList::kTooMany) return false;
    for (unsigned i = 0; taken && i < count; ++i)
      lower(surface, surface.tree.order[list[i]], p, found);
    return true;
  });
  return __ballot_sync(kAllLanes, (open >> lane & 1) && !(found.gap < reach));
}

// Does what find_least_gap() does, for the points of the lanes that are `open` together.
__device__ void find_least_gaps(const PatchTreeView& surface, const Vec3d& p, unsigned open,
                                GapMemory& memory, LeastGap& found) {
  const bool taken = open >> threadIdx.x % kWarp & 1;
  constexpr double kFar = std::numeric_limits<double>::infinity();
  if (taken) found = {kFar, 0};
  double bound = taken ? kFar : -1;
  const auto visit = [&](std::uint32_t index, std::uint32_t near, double& least) {
    std::uint32_t wanted = __reduce_or_sync(kAllLanes, near);
    const std::uint32_t patches = load_balls(surface, index, wanted, memory.leaf);
    for (; wanted != 0; wanted &= wanted - 1) {
      const int child = lowest_bit(wanted);
      const std::uint32_t patch = __shfl_sync(kAllLanes, patches, 4 * child);
      const double(&row)[4] = memory.leaf[child];
      const double gap = gap_of({{row[0], row[1], row[2]}, row[3]}, p);
      if (!(near >> child & 1) || !(gap < found.gap)) continue;
      found = {gap, patch};
      least = bound_of_gap(gap);
    }
  };
  WarpSearch(surface.tree, memory.stack).visit_leaves(surface.tree.query(p), bound, visit);
}

// points(i, p) writes point i to p, or returns false if there is none. A thread for each point of
// [first, first + count); the points of a warp are searched for together. Static shared memory: 2.4
// KB for each warp.
template <class Points>
__global__ void search_gaps(PatchTreeView surface, Points points, std::uint64_t first,
                            std::uint64_t count, double reach, FoundGaps found) {
  __shared__ GapMemory memories[kThreads / kWarp];
  const std::uint64_t i = thread_index();
  if (i / kWarp * kWarp >= count) return;  // the whole warp
  GapMemory& memory = memories[threadIdx.x / kWarp];
  Vec3d p = surface.tree.center;
  const bool is_there = i < count && points(first + i, p);
  LeastGap nearest;
  unsigned open = __ballot_sync(kAllLanes, is_there);
  open = find_gaps_within(surface, p, reach, open, memory.room, nearest);
  if (open != 0) find_least_gaps(surface, p, open, memory, nearest);
  if (i >= count) return;
  found.gap[i] = is_there ? nearest.gap : 0;
  found.patch[i] = nearest.patch;
  found.is_open[i] = is_there && !is_settled(surface, p, nearest);
}

// A thread for each of the points that are open, given by their indices in the launch. The search
// for one ends as soon as a patch is as near as its gap, or near enough not to matter.
template <class Points>
__global__ void search_patches(PatchTreeView surface, Points points, std::uint64_t first,
                               const std::uint32_t* open, std::uint64_t count, double floor,
                               FoundGaps found) {
  const std::uint64_t k = thread_index();
  if (k >= count) return;
  const std::uint32_t i = open[k];
  Vec3d p;
  points(first + i, p);
  const double square = found.gap[i] * found.gap[i];
  const double squared =
      nearest_exposed(surface, p, found.patch[i], square > floor ? square : floor);
  found.gap[i] = squared > floor ? -sqrt(squared) : 0;
}

// A thread for each corner of a triangle. Several threads may write the same value.
__global__ void mark_used(SoupView mesh, std::uint8_t* used) {
  const std::uint64_t i = thread_index();
  if (i < 3 * std::uint64_t{mesh.triangle_count}) used[mesh.vertices[i]] = 1;
}

// Memory for the points of a launch.
class LaunchPoints {
 public:
  LaunchPoints(std::uint64_t count, const Stream& stream)
      : gaps_(count, stream),
        patches_(count, stream),
        open_(count, stream),
        is_open_(count, stream),
        open_count_(1, stream) {}
  FoundGaps found() const { return {gaps_.data(), patches_.data(), is_open_.data()}; }
  const double* distances() const { return gaps_.data(); }

  // Measures the points [first, first + count).
  template <class Points>
  void measure(const PatchTreeView& surface, const Points& points, std::uint64_t first,
               std::uint64_t count, const PointHints& hints, const Stream& stream) const {
    launch("search_gaps", search_gaps<Points>, over(count, kThreads), stream, surface, points,
           first, count, hints.reach, found());
    run_cub("open points", stream, [&](void* scratch, std::size_t& bytes) {
      return cub::DeviceSelect::Flagged(
          scratch, bytes, thrust::make_counting_iterator(std::uint32_t{0}), is_open_.data(),
          open_.data(), open_count_.data(), count, stream.get());
    });
    const std::uint64_t open = fetch(open_count_.data(), stream);
    launch("search_patches", search_patches<Points>, over(open, kThreads), stream, surface, points,
           first, open_.data(), open, hints.floor, found());
  }

 private:
  DeviceArray<double> gaps_;
  DeviceArray<std::uint32_t> patches_, open_;
  DeviceArray<std::uint8_t> is_open_;
  DeviceArray<std::uint64_t> open_count_;
};

// Calls take(first, count, distances) for the points [0, count) after one another, launch by
// launch.
template <class Points, class Take>
void measure_all(const PatchTreeView& surface, const Points& points, std::uint64_t count,
                 const PointHints& hints, Monitor* monitor, const Stream& stream,
                 const Take& take) {
  const LaunchPoints memory(std::min(count, kDistancesPerLaunch), stream);
  for (std::uint64_t first = 0; first < count; first += kDistancesPerLaunch) {
    const std::uint64_t here = std::min(kDistancesPerLaunch, count - first);
    memory.measure(surface, points, first, here, hints, stream);
    take(first, here, memory.distances());
    advance(monitor, 1);
  }
}

std::uint64_t launches(std::uint64_t count) {
  return (count + kDistancesPerLaunch - 1) / kDistancesPerLaunch;
}

// The vertices that are on some triangle.
struct VertexMarks {
  DeviceArray<std::uint8_t> used;
  std::uint64_t count;
};
VertexMarks mark_vertices(const SoupView& mesh, const Stream& stream) {
  DeviceArray<std::uint8_t> used = zeros<std::uint8_t>(mesh.vertex_count, stream);
  launch("mark_used", mark_used, over(3 * std::uint64_t{mesh.triangle_count}, kThreads), stream,
         mesh, used.data());
  const DeviceArray<std::uint64_t> count(1, stream);
  run_cub("count vertices", stream, [&](void* scratch, std::size_t& bytes) {
    return cub::DeviceReduce::Reduce(scratch, bytes, used.data(), count.data(), mesh.vertex_count,
                                     ::cuda::std::plus<std::uint64_t>{}, std::uint64_t{0},
                                     stream.get());
  });
  return {std::move(used), fetch(count.data(), stream)};
}

}  // namespace

DistanceStatistics mesh_to_surface(const SoupView& mesh, const PatchTreeView& surface,
                                   const DistanceOptions& options, const Stream& stream) {
  const DeviceArea area(mesh, stream);
  const AreaStrata strata = plan_mesh_samples(area.total(), options);
  Monitor* const monitor = options.monitor;
  begin_stage(
      monitor, "distances of the mesh (CUDA)",
      launches(strata.samples) + launches(mesh.triangle_count) + launches(mesh.vertex_count));
  DeviceStatistics statistics(stream);
  // A mesh that follows the surface is mostly nearer to it than its triangles are long.
  const double reach = std::sqrt(area.total() / mesh.triangle_count);
  const auto sample = [mesh, area = area.view(), strata] __device__(std::uint64_t i, Vec3d & p) {
    p = area.point_at(mesh, strata.position(i));
    return true;
  };
  measure_all(surface, sample, strata.samples, {.reach = reach}, monitor, stream,
              [&](std::uint64_t, std::uint64_t count, const double* distances) {
                statistics.add(distances, count,
                               EvenBlocks{count, static_cast<std::uint32_t>(kDistancesPerBlock)});
              });
  // Vertices and centres matter if they are farther than all samples. The root of the square of a
  // double is the double, so no distance above `largest` has a square up to the floor.
  const double largest = statistics.largest();
  const PointHints hints{reach, largest * largest};
  const auto add_extremes = [&](std::uint64_t, std::uint64_t count, const double* distances) {
    statistics.add_extremes(distances, count, 0);
  };
  const auto center = [mesh] __device__(std::uint64_t i, Vec3d & p) {
    p = center_of(mesh(static_cast<std::uint32_t>(i)));
    return true;
  };
  measure_all(surface, center, mesh.triangle_count, hints, monitor, stream, add_extremes);
  const VertexMarks vertices = mark_vertices(mesh, stream);
  const auto vertex = [mesh, used = vertices.used.data()] __device__(std::uint64_t i, Vec3d & p) {
    p = mesh.positions[i];
    return used[i] != 0;
  };
  measure_all(surface, vertex, mesh.vertex_count, hints, monitor, stream, add_extremes);
  statistics.add_extremes(nullptr, 0, mesh.triangle_count + vertices.count);
  return statistics.result();
}

void points_to_surface(std::span<const Vec3d> points, const PatchTreeView& surface, double* found,
                       Monitor* monitor, const Stream& stream) {
  const DeviceArray<Vec3d> copy(points.size(), stream);
  upload_parts({{copy.data(), points.data(), copy.bytes()}}, stream);
  begin_stage(monitor, "signed distances (CUDA)", launches(points.size()));
  const auto given = [from = copy.data()] __device__(std::uint64_t i, Vec3d & p) {
    p = from[i];
    return true;
  };
  measure_all(surface, given, points.size(), {.reach = 0.5}, monitor, stream,
              [&](std::uint64_t first, std::uint64_t count, const double* distances) {
                download_parts({{found + first, distances, count * sizeof(double)}}, stream);
              });
}

}  // namespace vdwmesh::distance
