// Lists of overlapping balls, selections and sorts of DeviceExecutor.
//
// A warp lists the balls that overlap one ball: it visits the cells near it, first to count them,
// then to write them down. Low probes are sorted into cells as balls are; their lists are brought
// back to the order in which they were given.
#include <algorithm>

#include "cuda/excluded/device_executor.cuh"
#include "measures/arcs/arc_cap.hpp"

namespace vdwmesh::excluded::elements {
namespace {

using measure::BatchCellsView;

// A warp for each ball of the list. Balls are named by their list places, or, if `by_id` is set, by
// their indices in the batch. Counts of balls without exposed area, if `measures` says so, are 0.
// With `other`, writes the lists instead of counting.
__global__ void list_overlaps(BatchCellsView list, const SphereMeasures* measures, bool by_id,
                              std::uint64_t* first, std::uint32_t* other, std::uint32_t* owner) {
  const std::uint64_t i = thread_index() / kWarp;
  if (i >= list.size) return;
  const auto place = static_cast<ListPlace>(i);
  const unsigned lane = threadIdx.x % kWarp;
  const auto name_of = [&](ListPlace at) { return by_id ? list.id[at] : to_index(at); };
  const std::uint32_t self = name_of(place);
  if (measures != nullptr && measures[i].area == 0) {
    if (lane == 0 && other == nullptr) first[self] = 0;
    return;
  }
  const Sphere ball = list.spheres[place];
  const std::uint64_t begin = other != nullptr ? first[self] : 0;
  std::uint64_t found = 0;
  measure::visit_near(list, ball, measure::set_at(list, place), [&](ListPlace k, bool here) {
    bool near = false;
    if (here && k != place) {
      const Sphere s = list.spheres[k];
      const Vec3d to = s.center - ball.center;
      const double sum = ball.radius + s.radius;
      near = arcs::inner(to, to) < sum * sum;
    }
    const unsigned hits = __ballot_sync(kAllLanes, near);
    if (near && other != nullptr) {
      const std::uint64_t at = begin + found + bits_below(hits, lane);
      other[at] = name_of(k);
      owner[at] = self;
    }
    found += static_cast<std::uint64_t>(__popc(hits));
    return false;
  });
  if (lane == 0 && other == nullptr) first[self] = found;
}

OverlapLists<DeviceExecutor> overlaps_of(const DeviceExecutor& x, const BatchCellsView& list,
                                         const SphereMeasures* measures, bool by_id,
                                         const Stream& stream) {
  OverlapLists<DeviceExecutor> out;
  out.first = x.zeros<std::uint64_t>(list.size + std::size_t{1});
  const LaunchShape shape = over(kWarp * std::uint64_t{list.size}, 128);
  launch("list_overlaps", list_overlaps, shape, stream, list, measures, by_id, out.first.data(),
         nullptr, nullptr);
  out.entries = x.scan(out.first);
  out.other = x.make<std::uint32_t>(out.entries);
  out.owner = x.make<std::uint32_t>(out.entries);
  launch("list_overlaps", list_overlaps, shape, stream, list, measures, by_id, out.first.data(),
         out.other.data(), out.owner.data());
  return out;
}

}  // namespace

DeviceArray<std::uint32_t> DeviceExecutor::select(const DeviceArray<std::uint8_t>& flags,
                                                  std::uint64_t count) const {
  DeviceArray<std::uint32_t> found(count, stream_);
  const DeviceArray<std::uint32_t> size = zeros<std::uint32_t>(1);
  if (count == 0) return found;
  run_cub("elements", stream_, [&](void* scratch, std::size_t& bytes) {
    return cub::DeviceSelect::Flagged(scratch, bytes, thrust::counting_iterator<std::uint32_t>(0),
                                      flags.data(), found.data(), size.data(),
                                      static_cast<std::int64_t>(count), stream_.get());
  });
  return copy_of(found.data(), fetch(size.data(), stream_), stream_.get());
}

void DeviceExecutor::sort(DeviceArray<std::uint32_t>& keys, DeviceArray<std::uint32_t>& values,
                          std::uint64_t end) const {
  if (keys.size() == 0) return;
  DeviceArray<std::uint32_t> sorted_keys(keys.size(), stream_), sorted(keys.size(), stream_);
  const int bits = std::bit_width(end);
  run_cub("elements", stream_, [&](void* scratch, std::size_t& bytes) {
    return cub::DeviceRadixSort::SortPairs(
        scratch, bytes, keys.data(), sorted_keys.data(), values.data(), sorted.data(),
        static_cast<std::int64_t>(keys.size()), 0, bits, stream_.get());
  });
  keys = std::move(sorted_keys);
  values = std::move(sorted);
}

OverlapLists<DeviceExecutor> DeviceExecutor::overlaps(const BatchCellsView& list,
                                                      const SphereMeasures* measures) const {
  return overlaps_of(*this, list, measures, false, stream_);
}

OverlapLists<DeviceExecutor> DeviceExecutor::overlaps(const DeviceArray<Sphere>& balls,
                                                      const DeviceArray<std::uint32_t>& set,
                                                      std::size_t sets) const {
  // Sets stand one after another, in the order of their numbers; those without a probe are left
  // out.
  std::vector<std::uint32_t> offsets{0};
  const auto size = static_cast<std::uint32_t>(balls.size());
  if (sets > 1) {
    const std::vector<std::uint32_t> of = download(set.data(), set.size());
    for (std::uint32_t i = 1; i < size; ++i) {
      if (of[i] != of[i - 1]) offsets.push_back(i);
    }
  }
  offsets.push_back(size);
  const DeviceArray<std::uint32_t> uploaded = upload(offsets);
  const measure::BatchCells cells(
      {balls.data(), size, uploaded.data(), static_cast<std::uint32_t>(offsets.size() - 1)},
      stream_);
  OverlapLists<DeviceExecutor> lists = overlaps_of(*this, cells.view(), nullptr, true, stream_);
  stream_.wait();
  return lists;
}

}  // namespace vdwmesh::excluded::elements
