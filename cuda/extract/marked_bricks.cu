// A stream compaction of the keys of all bricks, which are not stored but computed. For a padded
// list the host does not wait for their number.
#include <thrust/iterator/counting_iterator.h>
#include <thrust/iterator/transform_iterator.h>

#include <cub/device/device_select.cuh>

#include "cuda/extract/marked_bricks.cuh"
#include "cuda/memory/cub_calls.cuh"
#include "cuda/memory/quick_fetch.cuh"

namespace vdwmesh {
namespace {

// The key of the brick with a number as brick_number() gives it.
struct KeyOfBrick {
  std::int32_t width, height;

  __host__ __device__ std::uint64_t operator()(std::int64_t i) const {
    return brick_key({static_cast<std::int32_t>(i % width),
                      static_cast<std::int32_t>(i / width % height),
                      static_cast<std::int32_t>(i / width / height)});
  }
};

std::uint64_t total_of(const std::int32_t (&bricks)[3]) {
  return static_cast<std::uint64_t>(bricks[0]) * static_cast<std::uint64_t>(bricks[1]) *
         static_cast<std::uint64_t>(bricks[2]);
}

// Writes the keys of the marked bricks to `keys`, and to `count` how many there are.
void select_keys(const std::uint8_t* marks, const std::int32_t (&bricks)[3], std::uint64_t* keys,
                 std::uint64_t* count, cudaStream_t stream) {
  const auto all = thrust::make_transform_iterator(thrust::make_counting_iterator(std::int64_t{0}),
                                                   KeyOfBrick{bricks[0], bricks[1]});
  run_cub("select", stream, [&](void* scratch, std::size_t& bytes) {
    return cub::DeviceSelect::Flagged(scratch, bytes, all, marks, keys, count,
                                      static_cast<std::int64_t>(total_of(bricks)), stream);
  });
}

}  // namespace

KeyList keys_of_marks(const std::uint8_t* marks, const std::int32_t (&bricks)[3],
                      std::uint64_t most_marked, const Stream& stream) {
  KeyList result;
  result.keys = DeviceArray<std::uint64_t>(most_marked, stream.get());
  const DeviceArray<std::uint64_t> count(1, stream.get());
  select_keys(marks, bricks, result.keys.data(), count.data(), stream.get());
  result.count = fetch_by_kernel(count.data(), stream);
  return result;
}

KeyList padded_keys_of_marks(const std::uint8_t* marks, const std::int32_t (&bricks)[3],
                             const Stream& stream) {
  KeyList result;
  result.count = total_of(bricks);
  result.padded = true;
  result.keys = DeviceArray<std::uint64_t>(result.count, stream.get());
  // A key of which all bits are set is kNoBrickKey.
  check_cuda(cudaMemsetAsync(result.keys.data(), 0xff, result.keys.bytes(), stream.get()), "keys");
  // The selection has to write its number somewhere; nobody reads it.
  const DeviceArray<std::uint64_t> count(1, stream.get());
  select_keys(marks, bricks, result.keys.data(), count.data(), stream.get());
  return result;
}

}  // namespace vdwmesh
