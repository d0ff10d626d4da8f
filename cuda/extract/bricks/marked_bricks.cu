// A stream compaction of the keys of all bricks, which are not stored but computed.
#include <thrust/iterator/counting_iterator.h>
#include <thrust/iterator/transform_iterator.h>

#include <cub/device/device_select.cuh>

#include "cuda/extract/bricks/marked_bricks.cuh"
#include "cuda/memory/cub_calls.cuh"

namespace vdwmesh {
namespace {

std::int64_t total_of(const std::int32_t (&bricks)[3]) {
  return std::int64_t{bricks[0]} * bricks[1] * bricks[2];
}

}  // namespace

KeyList keys_of_marks(const std::uint8_t* marks, const std::int32_t (&bricks)[3],
                      std::uint64_t most_marked, const Stream& stream) {
  KeyList result;
  result.keys = DeviceArray<std::uint64_t>(most_marked, stream.get());
  const DeviceArray<std::uint64_t> count(1, stream.get());
  // Of the brick with a number as brick_number() gives it.
  const std::int32_t width = bricks[0], height = bricks[1];
  const auto key_of = [width, height] __host__ __device__(std::int64_t i) {
    return brick_key({static_cast<std::int32_t>(i % width),
                      static_cast<std::int32_t>(i / width % height),
                      static_cast<std::int32_t>(i / width / height)});
  };
  const auto all =
      thrust::make_transform_iterator(thrust::make_counting_iterator(std::int64_t{0}), key_of);
  run_cub("select", stream.get(), [&](void* scratch, std::size_t& bytes) {
    return cub::DeviceSelect::Flagged(scratch, bytes, all, marks, result.keys.data(), count.data(),
                                      total_of(bricks), stream.get());
  });
  result.count = fetch(count.data(), stream);
  return result;
}

}  // namespace vdwmesh
