// The search for the nearest triangles: points are sorted along a curve through space, and a warp
// takes 32 consecutive ones.
//
// Nearly all points are near the mesh, so a warp first looks no farther than a reach: it lists the
// nodes of level 0 within it, and measures the triangles in these whose boxes are near a point.
//  - A triangle found within the reach is the nearest one, because every triangle so near to a
//    point is in a listed node, and its box is near the point.
//  - Points for which none was found are searched for with a longer reach, and in the end without
//    one.
//  - A point that alone has too many nodes within the reach is searched for without one at once:
//    a longer reach has at least these nodes.
// Whatever the reach, the result is thus the least of all triangles' distances, to the last bit.
//
// Few triangles of a node are near the same point. If each lane measured those of its own point,
// most lanes would wait; so pairs of a point and a triangle are written down, and every lane takes
// the next pair, of whichever point.
#include <cub/device/device_radix_sort.cuh>
#include <limits>

#include "analysis/distances/box_tree_build.hpp"
#include "analysis/distances/distances_triangle.hpp"
#include "core/order/hilbert.hpp"
#include "cuda/distances/group_list.cuh"
#include "cuda/distances/measure_distances.cuh"
#include "cuda/distances/warp_search.cuh"
#include "cuda/memory/cub_calls.cuh"
#include "cuda/memory/launch.cuh"
#include "cuda/memory/ordered_bits.cuh"
#include "cuda/memory/warp.cuh"

namespace vdwmesh::distance {
namespace {

constexpr unsigned kThreads = 128;
constexpr int kKeyBits = 30;  // of a place along the curve: 1,024 cells along an axis
// How often a warp looks within a reach, and how much longer each is than the one before.
constexpr int kRounds = 3;
constexpr double kLonger = 4;

// The corners of the triangles of a node of level 0.
struct LeafCorners {
  Vec3d corners[BoxNode::kWidth][3];
};

// The memory of a warp, shared: 4 KB.
struct TriangleMemory {
  GroupRoom room;
  WarpStack stack;
  LeafCorners leaf;
  Vec3d points[kWarp];
  OrderedBits best[kWarp];                      // bits of squared distances, Å²
  std::uint8_t pairs[BoxNode::kWidth * kWarp];  // a child of a node in 3 bits, a lane in 5
};

// Loads the corners of the children `wanted`, a bit for each, by a lane for each corner.
__device__ void load_corners(const SearchedMesh& searched, std::uint32_t index,
                             std::uint32_t wanted, LeafCorners& leaf) {
  const unsigned child = threadIdx.x % kWarp / 3, corner = threadIdx.x % kWarp % 3;
  __syncwarp();  // the leaf before has been read
  if (child < BoxNode::kWidth && (wanted >> child & 1)) {
    const std::uint64_t t = searched.tree.order[BoxNode::kWidth * index + child];
    leaf.corners[child][corner] = searched.mesh.positions[searched.mesh.vertices[3 * t + corner]];
  }
  __syncwarp();
}

// The points of a warp.
class WarpPoints {
 public:
  __device__ WarpPoints(const SearchedMesh& searched, const Vec3d& p, TriangleMemory& memory)
      : searched_(searched),
        memory_(memory),
        list_(memory.room),
        query_(searched.tree.query(p)),
        lane_(threadIdx.x % kWarp) {
    memory_.points[lane_] = p;
  }

  // Searches for the points of the lanes that are `open`, a bit for each, and returns those for
  // which no triangle is nearer than the reach (Å). Lanes with too many nodes within the reach are
  // not returned, but added to `crowded`. For all others squared() is the result.
  __device__ unsigned search_within(double reach, unsigned open, unsigned& crowded) {
    const double limit = reach * reach;
    if (open >> lane_ & 1) set_squared(limit);
    const float bound = searched_.tree.bound_of(limit);
    const unsigned given_up = for_each_range(open, [&](unsigned lanes) {
      const bool taken = lanes >> lane_ & 1;
      const unsigned leaves = list_.fill(searched_.tree, query_, taken, bound, 1);
      if (leaves == GroupList::kTooMany) return false;
      for (unsigned l = 0; l < leaves; ++l) measure_leaf(list_[l], taken);
      return true;
    });
    __syncwarp();
    crowded |= given_up;
    open &= ~given_up;
    return __ballot_sync(kAllLanes, (open >> lane_ & 1) && !(squared() < limit));
  }

  // Searches for the points of the lanes that are `open`, however far the mesh is.
  __device__ void search(unsigned open) {
    double least = open >> lane_ & 1 ? std::numeric_limits<double>::infinity() : -1;
    const auto visit = [&](std::uint32_t index, std::uint32_t near, double& squared) {
      std::uint32_t wanted = __reduce_or_sync(kAllLanes, near);
      load_corners(searched_, index, wanted, memory_.leaf);
      for (; wanted != 0; wanted &= wanted - 1) {
        const int child = lowest_bit(wanted);
        if (!(near >> child & 1)) continue;
        const Vec3d(&t)[3] = memory_.leaf.corners[child];
        const double here = squared_distance_to(memory_.points[lane_], {t[0], t[1], t[2]});
        squared = here < squared ? here : squared;
      }
    };
    WarpSearch(searched_.tree, memory_.stack).visit_leaves(query_, least, visit);
    if (open >> lane_ & 1) set_squared(least);
  }

  // The squared distance of the lane's own point, Å².
  __device__ double squared() const {
    return __longlong_as_double(static_cast<long long>(memory_.best[lane_]));
  }

 private:
  __device__ void set_squared(double squared) {
    memory_.best[lane_] = static_cast<OrderedBits>(__double_as_longlong(squared));
  }

  // Lowers the squared distances of the lanes that are `taken` to those to triangles of a node of
  // level 0. The bits of squares, which are not negative, have the order of the squares.
  __device__ void measure_leaf(std::uint32_t index, bool taken) {
    const float bound = taken ? searched_.tree.bound_of(squared()) : 0;
    const NearLanes lanes(searched_.tree.levels[0][index], query_, bound);
    const std::uint32_t wanted = __reduce_or_sync(kAllLanes, lanes.near);
    if (wanted == 0) return;
    load_corners(searched_, index, wanted, memory_.leaf);
    unsigned count = 0;
#pragma unroll
    for (unsigned c = 0; c < BoxNode::kWidth; ++c) {
      const bool here = lanes.near >> c & 1;
      const unsigned all = __ballot_sync(kAllLanes, here);
      if (here)
        memory_.pairs[count + bits_below(all, lane_)] =
            static_cast<std::uint8_t>(c * kWarp + lane_);
      count += static_cast<unsigned>(count_bits(all));
    }
    __syncwarp();
    for (unsigned k = lane_; k < count; k += kWarp) {
      const unsigned pair = memory_.pairs[k], other = pair % kWarp;
      const Vec3d(&t)[3] = memory_.leaf.corners[pair / kWarp];
      const double here = squared_distance_to(memory_.points[other], {t[0], t[1], t[2]});
      atomicMin(&memory_.best[other], static_cast<OrderedBits>(__double_as_longlong(here)));
    }
    __syncwarp();
  }

  const SearchedMesh& searched_;
  TriangleMemory& memory_;
  GroupList list_;
  BoxQuery query_;
  unsigned lane_;
};

// A thread for each point, in the order of their keys. Static shared memory: 4 KB for each warp.
__global__ void __launch_bounds__(kThreads)
    search_triangles(SearchedMesh searched, double reach, const Vec3d* points,
                     const std::uint32_t* order, std::uint64_t count, double* found) {
  __shared__ TriangleMemory memories[kThreads / kWarp];
  const std::uint64_t k = thread_index();
  if (k / kWarp * kWarp >= count) return;  // the whole warp
  const bool is_there = k < count;
  const std::uint32_t i = order[is_there ? k : count - 1];
  WarpPoints own(searched, points[i], memories[threadIdx.x / kWarp]);
  unsigned open = __ballot_sync(kAllLanes, is_there), crowded = 0;
  for (int round = 0; round < kRounds && open != 0; ++round, reach *= kLonger)
    open = own.search_within(reach, open, crowded);
  if ((open | crowded) != 0) own.search(open | crowded);
  if (is_there) found[i] = sqrt(own.squared());
}

// Writes keys along a curve through the world of the tree, and the indices of the points.
__global__ void make_point_keys(BoxTreeView tree, const Vec3d* points, std::uint64_t count,
                                std::uint32_t* keys, std::uint32_t* indices) {
  const std::uint64_t i = thread_index();
  if (i >= count) return;
  const Vec3d p = scaled(tree, points[i]);
  const auto cell = [](double x) {
    constexpr double kCells = 1 << kHilbertBits;
    const double place = 0.5 * (x + 1) * kCells;
    return static_cast<std::uint32_t>(place < 0 ? 0 : (place < kCells ? place : kCells - 1));
  };
  const std::uint64_t key = hilbert_key(cell(p.x), cell(p.y), cell(p.z));
  keys[i] = static_cast<std::uint32_t>(key >> (3 * kHilbertBits - kKeyBits));
  indices[i] = static_cast<std::uint32_t>(i);
}

// The indices of the points in the order of their keys.
DeviceArray<std::uint32_t> along_curve(const BoxTreeView& tree, const DeviceArray<Vec3d>& points,
                                       const Stream& stream) {
  const std::uint64_t count = points.size();
  const DeviceArray<std::uint32_t> keys(count, stream), sorted(count, stream);
  const DeviceArray<std::uint32_t> indices(count, stream);
  DeviceArray<std::uint32_t> order(count, stream);
  launch("make_point_keys", make_point_keys, over(count, kThreads), stream, tree, points.data(),
         count, keys.data(), indices.data());
  run_cub("sort points", stream, [&](void* scratch, std::size_t& bytes) {
    return cub::DeviceRadixSort::SortPairs(scratch, bytes, keys.data(), sorted.data(),
                                           indices.data(), order.data(), count, 0, kKeyBits,
                                           stream.get());
  });
  return order;
}

}  // namespace

void find_nearest_triangles(const SearchedMesh& searched, const DeviceArray<Vec3d>& points,
                            double reach, double* found, const Stream& stream) {
  const std::uint64_t count = points.size();
  if (count == 0) return;
  const DeviceArray<std::uint32_t> order = along_curve(searched.tree, points, stream);
  launch("search_triangles", search_triangles, over(count, kThreads), stream, searched, reach,
         points.data(), order.data(), count, found);
}

}  // namespace vdwmesh::distance
