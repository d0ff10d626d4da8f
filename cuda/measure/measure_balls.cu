// measure_on_device(): cell lists of the batch, then a warp for each ball, which finds the ball's
// neighbours, cuts its power cell by their radical planes, the nearest first, and measures what the
// unit ball and the cell have in common.
//
// A ball for which the memory of the warp is too small is measured again by a kernel with more. A
// ball for which that is too small as well, and one that leaves a doubt, is listed for the host.
#include <cuda_runtime.h>

#include "cuda/measure/batch_cells.cuh"
#include "cuda/measure/cell_measures.cuh"
#include "cuda/measure/device_measures.cuh"
#include "cuda/memory/launch.cuh"
#include "measures/arcs/arc_cap.hpp"

namespace vdwmesh::measure {
namespace {

using arcs::Cap;
using arcs::CapKind;

// Room of a warp: vertices in slots of 32, faces, caps, corners.
template <int kSlotCount, int kFaceCount, int kCapCount, int kCornerCount>
struct Room {
  static constexpr int kSlots = kSlotCount, kFaces = kFaceCount, kCaps = kCapCount,
                       kCorners = kCornerCount;
  struct WarpSpace {
    union {
      ListPlace near[kCaps];  // the balls that overlap the ball
      CellSpace<kSlots, kFaces> cell;
    };
    union {
      Plane caps[kCaps];  // while the cell is cut
      MeasureSpace<kSlots, kFaces, kCorners> measure;
    };
  };
};
// A polytope of 64 vertices has 34 faces.
using SmallRoom = Room<2, 36, 128, 64>;
using LargeRoom = Room<8, 136, 1024, 512>;

// Balls that are not measured yet.
struct Leftovers {
  ListPlace* places;
  std::uint32_t* count;

  __device__ void add(ListPlace place) const { places[atomicAdd(count, 1u)] = place; }
};

// The measurement of one ball by a warp.
template <class SomeRoom>
class WarpBall {
 public:
  using WarpSpace = typename SomeRoom::WarpSpace;
  static constexpr int kCaps = SomeRoom::kCaps;

  __device__ __forceinline__ WarpBall(const BatchCellsView& list, ListPlace place, WarpSpace& space,
                                      unsigned lane)
      : list_(list), place_(place), ball_(list.spheres[place]), space_(space), lane_(lane) {}

  // For the unit ball.
  __device__ __forceinline__ UnitMeasures measure() {
    collect();
    if (buried_) return {0, 0, Outcome::good};
    if (near_ > kCaps) return {0, 0, Outcome::too_large};
    make_caps();
    if (buried_) return {0, 0, Outcome::good};
    if (!has_caps_) return {4 * kPi, 4 * kPi / 3, Outcome::good};
    PowerCell<SomeRoom::kSlots, SomeRoom::kFaces> cell(space_.cell, lane_);
    cut_by_all(cell);
    if (cell.empty()) return {0, 0, Outcome::good};
    if (cell.outcome() != Outcome::good) return {0, 0, cell.outcome()};
    __syncwarp();
    CellMeasurement<SomeRoom::kSlots, SomeRoom::kFaces, SomeRoom::kCorners> measurement(
        cell, space_.measure, lane_);
    return measurement.measure();
  }

 private:
  // Lists the balls that overlap this one. Of equal balls the one of the lowest index buries the
  // others; they share a cell, so it has the lowest list place too.
  __device__ __forceinline__ void collect() {
    visit_near(list_, ball_, set_at(list_, place_), [&](ListPlace other, bool here) {
      bool near = false, equal = false;
      if (here && other != place_) {
        const Sphere s = list_.spheres[other];
        const Vec3d to = s.center - ball_.center;
        const double sum = ball_.radius + s.radius;
        near = arcs::inner(to, to) < sum * sum;
        equal = s.center == ball_.center && s.radius == ball_.radius;
      }
      if (__any_sync(kAllLanes, equal && other < place_)) {
        buried_ = true;
        return true;
      }
      near = near && !equal;
      const unsigned found = __ballot_sync(kAllLanes, near);
      const int index = near_ + __popc(found & lanes_before());
      if (near && index < kCaps) space_.near[index] = other;
      near_ += __popc(found);
      return near_ > kCaps;
    });
    __syncwarp();
  }

  // Makes the caps, and for each a key: the upper bits of its cosine, rounded down, and its index.
  // Keys have the order of the cosines, to the bits that they keep.
  static constexpr unsigned kIndexMask = kCaps - 1;
  static_assert((kCaps & kIndexMask) == 0);
  static constexpr unsigned kNoKey = 0xffffffffu;
  __device__ __forceinline__ void make_caps() {
    bool buried = false;
#pragma unroll
    for (int k = 0; k < kCaps / 32; ++k) {
      key_[k] = kNoKey;
      const int i = 32 * k + static_cast<int>(lane_);
      if (i >= near_) continue;
      Cap cap;
      const CapKind kind = arcs::make_cap(ball_, list_.spheres[space_.near[i]], cap);
      buried = buried || kind == CapKind::buries;
      if (kind != CapKind::cuts) continue;
      space_.caps[i] = {cap.axis, cap.cosine};
      const unsigned bits = __float_as_uint(__double2float_rd(cap.cosine));
      const unsigned rising = bits >> 31 ? ~bits : bits | 0x80000000u;
      key_[k] = (rising & ~kIndexMask) | static_cast<unsigned>(i);
    }
    bool cuts = false;
#pragma unroll
    for (int k = 0; k < kCaps / 32; ++k) cuts = cuts || key_[k] != kNoKey;
    has_caps_ = __any_sync(kAllLanes, cuts);
    buried_ = __any_sync(kAllLanes, buried);
    __syncwarp();
  }

  // Not above the cosine of the cap with this key, nor of any cap with a larger one.
  __device__ __forceinline__ static float bound_of(unsigned key) {
    const unsigned rising = key & ~kIndexMask;
    return __uint_as_float(rising >> 31 ? rising & 0x7fffffffu : ~rising);
  }

  // Of the caps whose keys agree with the key but for their indices, the key of the first one by
  // its numbers, in the order of is_before(). Keys alone would tell these apart by their indices,
  // which depend on the cells of the list, and so on balls far away. With this a ball is measured
  // alike, to the last bit, in every set that has all balls that overlap it.
  __device__ __forceinline__ unsigned first_of_equal(unsigned key) const {
    unsigned first = kNoKey;
#pragma unroll
    for (int k = 0; k < kCaps / 32; ++k) {
      unsigned equal = __ballot_sync(kAllLanes, (key_[k] & ~kIndexMask) == (key & ~kIndexMask));
      for (; equal != 0; equal &= equal - 1) {
        const unsigned other = __shfl_sync(kAllLanes, key_[k], __ffs(equal) - 1);
        const bool is_first = first == kNoKey || is_before(space_.caps[other & kIndexMask],
                                                           space_.caps[first & kIndexMask]);
        first = is_first ? other : first;
      }
    }
    return first;
  }
  // Caps that are in neither order are equal.
  __device__ __forceinline__ static bool is_before(const Plane& a, const Plane& b) {
    if (a.cosine != b.cosine) return a.cosine < b.cosine;
    if (a.axis.x != b.axis.x) return a.axis.x < b.axis.x;
    if (a.axis.y != b.axis.y) return a.axis.y < b.axis.y;
    return a.axis.z < b.axis.z;
  }

  // Cuts by the nearest plane that is left, until no plane is near enough to cut.
  template <class Cell>
  __device__ __forceinline__ void cut_by_all(Cell& cell) {
    for (;;) {
      unsigned least = kNoKey;
#pragma unroll
      for (int k = 0; k < kCaps / 32; ++k) least = min(least, key_[k]);
      least = __reduce_min_sync(kAllLanes, least);
      if (least == kNoKey || bound_of(least) > cell.reach()) return;
      least = first_of_equal(least);
#pragma unroll
      for (int k = 0; k < kCaps / 32; ++k) key_[k] = key_[k] == least ? kNoKey : key_[k];
      cell.cut(space_.caps[least & kIndexMask]);
      if (cell.empty() || cell.outcome() != Outcome::good) return;
    }
  }

  const BatchCellsView& list_;
  ListPlace place_;
  Sphere ball_;
  WarpSpace& space_;
  unsigned lane_;
  int near_ = 0;  // balls that overlap this one, also those for which there is no room
  bool buried_ = false, has_caps_ = false;
  unsigned key_[kCaps / 32];
};

template <class SomeRoom>
__device__ __forceinline__ void measure_place(const BatchCellsView& list, ListPlace place,
                                              typename SomeRoom::WarpSpace& space, unsigned lane,
                                              SphereMeasures* results, const Leftovers& too_large,
                                              const Leftovers& doubtful) {
  WarpBall<SomeRoom> ball(list, place, space, lane);
  const UnitMeasures unit = ball.measure();
  if (lane != 0) return;
  const double r = list.spheres[place].radius;
  results[list.id[place]] = {unit.area * (r * r), unit.volume * (r * r * r)};
  if (unit.outcome == Outcome::too_large) too_large.add(place);
  if (unit.outcome == Outcome::doubtful) doubtful.add(place);
}

constexpr unsigned kWarpsPerBlock = 4;
// Limits the registers: 24 warps on a multiprocessor hide more latency than fewer spills would
// save.
constexpr unsigned kBlocksPerMultiprocessor = 6;

// A warp for each ball, 4 warps per thread block. Dynamic shared memory: a SmallRoom::WarpSpace for
// each warp.
__global__ void __launch_bounds__(32 * kWarpsPerBlock, kBlocksPerMultiprocessor)
    measure_all(BatchCellsView list, SphereMeasures* results, Leftovers too_large,
                Leftovers doubtful) {
  extern __shared__ __align__(16) unsigned char memory[];
  auto* const spaces = reinterpret_cast<SmallRoom::WarpSpace*>(memory);
  const unsigned warp = threadIdx.x / 32;
  const std::uint64_t place = static_cast<std::uint64_t>(blockIdx.x) * kWarpsPerBlock + warp;
  if (place >= list.size) return;
  measure_place<SmallRoom>(list, static_cast<ListPlace>(place), spaces[warp], threadIdx.x % 32,
                           results, too_large, doubtful);
}

// Thread blocks of one warp take the listed balls in turns, every gridDim.x-th one. Dynamic shared
// memory: a LargeRoom::WarpSpace. A ball that is too large even for that is left to the host.
__global__ void __launch_bounds__(32) measure_large(BatchCellsView list, SphereMeasures* results,
                                                    Leftovers listed, Leftovers doubtful) {
  extern __shared__ __align__(16) unsigned char memory[];
  auto& space = *reinterpret_cast<LargeRoom::WarpSpace*>(memory);
  for (std::uint32_t i = blockIdx.x; i < *listed.count; i += gridDim.x) {
    measure_place<LargeRoom>(list, listed.places[i], space, threadIdx.x, results, doubtful,
                             doubtful);
    __syncwarp();
  }
}

template <class Kernel>
void allow_shared(Kernel kernel, std::size_t bytes) {
  check_cuda(cudaFuncSetAttribute(kernel, cudaFuncAttributeMaxDynamicSharedMemorySize,
                                  static_cast<int>(bytes)),
             "shared memory");
}

}  // namespace

DeviceMeasures measure_on_device(const DeviceBatch& batch, const Stream& stream) {
  DeviceMeasures result{BatchCells(batch, stream), DeviceArray<SphereMeasures>(batch.size, stream),
                        DeviceArray<ListPlace>(batch.size, stream),
                        zeros<std::uint32_t>(2, stream)};
  const BatchCellsView& list = result.cells.view();
  const DeviceArray<ListPlace> large(batch.size, stream);
  const Leftovers doubtful{result.doubtful.data(), result.counts.data()};
  const Leftovers too_large{large.data(), result.counts.data() + 1};
  constexpr std::size_t small_bytes = kWarpsPerBlock * sizeof(SmallRoom::WarpSpace);
  allow_shared(measure_all, small_bytes);
  launch("measure_all", measure_all,
         {blocks_for(batch.size, kWarpsPerBlock), 32 * kWarpsPerBlock, small_bytes}, stream, list,
         result.per_sphere.data(), too_large, doubtful);
  constexpr std::size_t large_bytes = sizeof(LargeRoom::WarpSpace);
  allow_shared(measure_large, large_bytes);
  launch("measure_large", measure_large, {264, 32, large_bytes}, stream, list,
         result.per_sphere.data(), too_large, doubtful);
  return result;
}

}  // namespace vdwmesh::measure
