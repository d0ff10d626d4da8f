// measure_on_device(): cell lists of the batch, then a warp for each ball, which finds the ball's
// neighbours, cuts its power cell by their radical planes, the nearest first, and measures what the
// unit ball and the cell have in common. With weights it gathers derivatives from the same cell.
//
// A ball for which the memory of the warp is too small is measured again by a kernel with more. A
// ball for which that is too small as well, and one that leaves a doubt, is listed for the host.
#include <cuda_runtime.h>

#include <type_traits>

#include "cuda/measure/batch_cells.cuh"
#include "cuda/measure/cell_gradient.cuh"
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
  // For derivatives too: the ball of each cap and of each face, and the ends of each edge.
  struct GradientSpace : WarpSpace {
    ListPlace cap_ball[kCaps], face_ball[kFaces];
    std::uint32_t ends[48 * kSlots];
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

// What is computed of a ball.
enum class Wanted { measures, gradients };

// What derivatives need; all null for measures alone.
struct GradientRows {
  BallGradient* rows;                // by index in the batch
  const arcs::BallWeights* weights;  // by list place; null: all are 1
  unsigned long long* kinks;         // by set
  MeasureCounts* counts;

  __device__ arcs::BallWeights weights_of(ListPlace place) const {
    return weights != nullptr ? weights[to_index(place)] : arcs::BallWeights{1, 1};
  }
};

// The measurement of one ball by a warp.
template <class SomeRoom, Wanted kWanted>
class WarpBall {
 public:
  static constexpr bool kGradients = kWanted == Wanted::gradients;
  using WarpSpace = std::conditional_t<kGradients, typename SomeRoom::GradientSpace,
                                       typename SomeRoom::WarpSpace>;
  static constexpr int kSlots = SomeRoom::kSlots, kFaces = SomeRoom::kFaces,
                       kCaps = SomeRoom::kCaps, kCorners = SomeRoom::kCorners;

  __device__ __forceinline__ WarpBall(const BatchCellsView& list, ListPlace place, WarpSpace& space,
                                      unsigned lane, const GradientRows& gradients)
      : list_(list),
        place_(place),
        ball_(list.spheres[place]),
        space_(space),
        lane_(lane),
        gradients_(gradients) {}

  // For the unit ball.
  __device__ __forceinline__ UnitMeasures measure() {
    collect();
    if (buried_) return {0, 0, Outcome::good};
    if (near_ > kCaps) return {0, 0, Outcome::too_large};
    make_caps();
    if (buried_) return {0, 0, Outcome::good};
    if (!has_caps_) return {4 * kPi, 4 * kPi / 3, Outcome::good};
    PowerCell<kSlots, kFaces> cell(space_.cell, lane_);
    cut_by_all(cell);
    if (cell.empty()) return {0, 0, Outcome::good};
    if (cell.outcome() != Outcome::good) return {0, 0, cell.outcome()};
    __syncwarp();
    if constexpr (kGradients) {
      return with_gradient(cell);
    } else {
      return CellMeasurement<kSlots, kFaces, kCorners, NoNotes>(cell, space_.measure, lane_, {})
          .measure();
    }
  }

  // Writes the derivatives by the ball. All lanes call it, after a good measurement with the area
  // in Å².
  __device__ __forceinline__ void write_gradient(double area) const {
    const unsigned number = lane_ / 4;
    const double r = ball_.radius;
    const arcs::RadiusRates growth = arcs::radius_rates(r, area, gradients_.weights_of(place_));
    double value = number < 4 ? gradient_ : gradient_ * (r * r);
    if (number == 3) value += growth.area;
    if (number == 7) value += growth.volume;
    if (__any_sync(kAllLanes, !isfinite(value)) && lane_ == 0) {
      atomicAdd(&gradients_.counts->rows_not_finite, 1u);
    }
    auto* const row = reinterpret_cast<double*>(gradients_.rows + list_.id[place_]);
    if (lane_ % 4 == 0) row[number] = value;
  }
  // In some lane, whether the ball may have no derivative (UnionGradients::kink_spheres). Of balls
  // for whose neighbours there is no room, touches from inside are not known.
  __device__ __forceinline__ bool has_kink() const { return has_kink_; }

 private:
  __device__ __forceinline__ UnitMeasures with_gradient(const PowerCell<kSlots, kFaces>& cell) {
    CellMeasurement<kSlots, kFaces, kCorners, GradientNotes> measurement(
        cell, space_.measure, lane_, {space_.ends, space_.cell.terms});
    const UnitMeasures unit = measurement.measure();
    if (unit.outcome != Outcome::good) return unit;
    const auto weighted = [&](ListPlace place) {
      return WeightedBall{list_.spheres[place], gradients_.weights_of(place)};
    };
    CellGradient<kSlots, kFaces, kCorners> gradient(space_.cell, space_.measure, space_.ends,
                                                    lane_);
    gradient.add_faces(
        weighted(place_), cell.face_count(), [&](std::uint32_t f) { return measurement.uses(f); },
        [&](std::uint32_t f) { return weighted(space_.face_ball[f]); });
    gradient.add_edges(measurement.edge_count());
    gradient_ = gradient.share();
    return unit;
  }

  // Lists the balls that overlap this one. Of equal balls the one of the lowest index buries the
  // others; they share a cell, so it has the lowest list place too.
  __device__ __forceinline__ void collect() {
    visit_near(list_, ball_, set_at(list_, place_), [&](ListPlace other, bool here) {
      bool near = false, equal = false;
      if (here && other != place_) {
        const Sphere s = list_.spheres[other];
        const Vec3d to = s.center - ball_.center;
        const double sum = ball_.radius + s.radius, squared = arcs::inner(to, to);
        near = squared < sum * sum;
        equal = s.center == ball_.center && s.radius == ball_.radius;
        if constexpr (kGradients) {
          const double almost = (1 + arcs::kTouching) * sum;
          has_kink_ = has_kink_ || (!near && squared <= almost * almost);
        }
      }
      if (__any_sync(kAllLanes, equal && other < place_)) {
        buried_ = has_kink_ = true;
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
      if constexpr (kGradients) {
        cap.cosine = 2;  // stays if the centres are equal
        space_.cap_ball[i] = space_.near[i];
      }
      const CapKind kind = arcs::make_cap(ball_, list_.spheres[space_.near[i]], cap);
      if constexpr (kGradients) {
        has_kink_ = has_kink_ || fabs(fabs(cap.cosine) - 1) <= arcs::kTouching;
      }
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
    has_kink_ = has_kink_ && !buried_;
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
  __device__ __forceinline__ static bool is_same(const Plane& a, const Plane& b) {
    return a.cosine == b.cosine && a.axis == b.axis;
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
      const std::uint32_t face = cell.cut(space_.caps[least & kIndexMask]);
      if constexpr (kGradients) note_ball(face, least & kIndexMask);
      if (cell.empty() || cell.outcome() != Outcome::good) return;
    }
  }

  // Notes whose plane a face has. Of balls with equal planes, which come one after another, it is
  // the farthest, and of equal balls that of the lowest index: all others are hidden there.
  __device__ __forceinline__ void note_ball(std::uint32_t face, unsigned cap) {
    if (face == PowerCell<kSlots, kFaces>::kNoFace) return;
    if (lane_ == 0) {
      const bool again = last_cap_ != kNoKey && is_same(space_.caps[cap], space_.caps[last_cap_]);
      const ListPlace other = space_.cap_ball[cap];
      if (!again || is_farther(other, space_.face_ball[face])) space_.face_ball[face] = other;
    }
    last_cap_ = cap;
  }
  __device__ __forceinline__ bool is_farther(ListPlace a, ListPlace b) const {
    const Vec3d to_a = list_.spheres[a].center - ball_.center,
                to_b = list_.spheres[b].center - ball_.center;
    const double apart = arcs::inner(to_a, to_a) - arcs::inner(to_b, to_b);
    return apart > 0 || (apart == 0 && list_.id[a] < list_.id[b]);
  }

  const BatchCellsView& list_;
  ListPlace place_;
  Sphere ball_;
  WarpSpace& space_;
  unsigned lane_;
  const GradientRows& gradients_;
  double gradient_ = 0;         // derivative lane / 4 of the ball's power cell
  unsigned last_cap_ = kNoKey;  // the last cap that had a face
  bool has_kink_ = false;
  int near_ = 0;  // balls that overlap this one, also those for which there is no room
  bool buried_ = false, has_caps_ = false;
  unsigned key_[kCaps / 32];
};

template <class SomeRoom, Wanted kWanted>
__device__ __forceinline__ void measure_place(
    const BatchCellsView& list, ListPlace place,
    typename WarpBall<SomeRoom, kWanted>::WarpSpace& space, unsigned lane, SphereMeasures* results,
    const GradientRows& gradients, const Leftovers& too_large, const Leftovers& doubtful) {
  WarpBall<SomeRoom, kWanted> ball(list, place, space, lane, gradients);
  const UnitMeasures unit = ball.measure();
  const double r = list.spheres[place].radius, area = unit.area * (r * r);
  if constexpr (kWanted == Wanted::gradients) {
    if (unit.outcome == Outcome::good) ball.write_gradient(area);
    const bool comes_again =
        unit.outcome == Outcome::too_large && too_large.places != doubtful.places;
    if (__any_sync(kAllLanes, ball.has_kink()) && !comes_again && lane == 0) {
      atomicAdd(&gradients.kinks[set_at(list, place)], 1ull);
    }
  }
  if (lane != 0) return;
  results[list.id[place]] = {area, unit.volume * (r * r * r)};
  if (unit.outcome == Outcome::too_large) too_large.add(place);
  if (unit.outcome == Outcome::doubtful) doubtful.add(place);
}

constexpr unsigned kWarpsPerBlock = 4;
// Limits the registers: 24 warps on a multiprocessor hide more latency than fewer spills would
// save.
constexpr unsigned kBlocksPerMultiprocessor = 6;

template <class SomeRoom, Wanted kWanted>
using SpaceOf = typename WarpBall<SomeRoom, kWanted>::WarpSpace;

// A warp for each ball, 4 warps per thread block. Dynamic shared memory: a SpaceOf<SmallRoom> for
// each warp.
template <Wanted kWanted>
__global__ void __launch_bounds__(32 * kWarpsPerBlock, kBlocksPerMultiprocessor)
    measure_all(BatchCellsView list, SphereMeasures* results, GradientRows gradients,
                Leftovers too_large, Leftovers doubtful) {
  extern __shared__ __align__(16) unsigned char memory[];
  auto* const spaces = reinterpret_cast<SpaceOf<SmallRoom, kWanted>*>(memory);
  const unsigned warp = threadIdx.x / 32;
  const std::uint64_t place = static_cast<std::uint64_t>(blockIdx.x) * kWarpsPerBlock + warp;
  if (place >= list.size) return;
  measure_place<SmallRoom, kWanted>(list, static_cast<ListPlace>(place), spaces[warp],
                                    threadIdx.x % 32, results, gradients, too_large, doubtful);
}

// Thread blocks of one warp take the listed balls in turns, every gridDim.x-th one. Dynamic shared
// memory: a SpaceOf<LargeRoom>. A ball that is too large even for that is left to the host.
template <Wanted kWanted>
__global__ void __launch_bounds__(32)
    measure_large(BatchCellsView list, SphereMeasures* results, GradientRows gradients,
                  Leftovers listed, Leftovers doubtful) {
  extern __shared__ __align__(16) unsigned char memory[];
  auto& space = *reinterpret_cast<SpaceOf<LargeRoom, kWanted>*>(memory);
  for (std::uint32_t i = blockIdx.x; i < *listed.count; i += gridDim.x) {
    measure_place<LargeRoom, kWanted>(list, listed.places[i], space, threadIdx.x, results,
                                      gradients, doubtful, doubtful);
    __syncwarp();
  }
}

// A thread for each list place: the weights of its ball.
__global__ void gather_weights(BatchCellsView list, BatchWeights weights,
                               arcs::BallWeights* by_place, MeasureCounts* counts) {
  const std::uint64_t place = thread_index();
  if (place >= list.size) return;
  const arcs::BallWeights w = weights_at(weights, list.id[static_cast<ListPlace>(place)]);
  by_place[place] = w;
  if (!isfinite(w.area) || !isfinite(w.volume)) atomicAdd(&counts->weights_not_finite, 1u);
}

template <class Kernel>
void allow_shared(Kernel kernel, std::size_t bytes) {
  check_cuda(cudaFuncSetAttribute(kernel, cudaFuncAttributeMaxDynamicSharedMemorySize,
                                  static_cast<int>(bytes)),
             "shared memory");
}

// Starts the kernels.
template <Wanted kWanted>
void measure_places(const DeviceMeasures& result, const GradientRows& gradients,
                    const Stream& stream) {
  const BatchCellsView& list = result.cells.view();
  const DeviceArray<ListPlace> large(list.size, stream);
  MeasureCounts* const counts = result.counts.data();
  const Leftovers doubtful{result.doubtful.data(), &counts->doubtful};
  const Leftovers too_large{large.data(), &counts->large};
  constexpr std::size_t small_bytes = kWarpsPerBlock * sizeof(SpaceOf<SmallRoom, kWanted>);
  allow_shared(measure_all<kWanted>, small_bytes);
  launch("measure_all", measure_all<kWanted>,
         {blocks_for(list.size, kWarpsPerBlock), 32 * kWarpsPerBlock, small_bytes}, stream, list,
         result.per_sphere.data(), gradients, too_large, doubtful);
  constexpr std::size_t large_bytes = sizeof(SpaceOf<LargeRoom, kWanted>);
  allow_shared(measure_large<kWanted>, large_bytes);
  launch("measure_large", measure_large<kWanted>, {264, 32, large_bytes}, stream, list,
         result.per_sphere.data(), gradients, too_large, doubtful);
}

}  // namespace

DeviceMeasures measure_on_device(const DeviceBatch& batch, const Stream& stream,
                                 const BatchWeights* weights) {
  DeviceMeasures result{
      .cells = BatchCells(batch, stream),
      .per_sphere = DeviceArray<SphereMeasures>(batch.size, stream),
      .gradients = DeviceArray<BallGradient>(weights != nullptr ? batch.size : 0, stream),
      .kinks = zeros<std::uint64_t>(weights != nullptr ? batch.sets : 0, stream),
      .doubtful = DeviceArray<ListPlace>(batch.size, stream),
      .counts = zeros<MeasureCounts>(1, stream)};
  if (weights == nullptr) {
    measure_places<Wanted::measures>(result, {}, stream);
    return result;
  }
  const bool all_one = weights->area == nullptr && weights->volume == nullptr;
  const DeviceArray<arcs::BallWeights> by_place(all_one ? 0 : batch.size, stream);
  if (!all_one) {
    launch("gather_weights", gather_weights, over(batch.size, 256), stream, result.cells.view(),
           *weights, by_place.data(), result.counts.data());
  }
  measure_places<Wanted::gradients>(
      result,
      {.rows = result.gradients.data(),
       .weights = by_place.data(),
       .kinks = reinterpret_cast<unsigned long long*>(result.kinks.data()),
       .counts = result.counts.data()},
      stream);
  return result;
}

}  // namespace vdwmesh::measure
